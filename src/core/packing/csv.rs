//! Packings as CSV: a column each for x, y, z and the diameter or the radius, by their names.
//!
//! A comment above the header, `# cell_mm = Lx, Ly, Lz`, gives a periodic cell with its corner at the origin,
//! `# cell = none` free boundaries; a file without one leaves the cell open. The header names the columns in
//! any order, with their unit at the end (`x_mm`, `Diameter (m)`), or without one, which leaves it open;
//! further columns are passed over. ParaView's names of coordinates (`Points:0`, `coordinates_0`) are known.
//! Comma, semicolon or tab between columns; a byte order mark, CRLF, blank lines and further `#` comments are
//! allowed.

use super::fields::{ImportError, Kind, Line, number, refused};
use super::found::{FileCell, FileGrains, grain, in_columns};
use super::grains::Cell;
use super::unit::LengthUnit;

/// Accepted names of the columns, without a unit and in lower case: x, y, z, diameter, radius.
const CALLED: [&[&str]; 5] = [
    &[
        "x",
        "points:0",
        "points_0",
        "coordinates:0",
        "coordinates_0",
        "position:0",
        "position_x",
        "pos_x",
        "x coord",
    ],
    &[
        "y",
        "points:1",
        "points_1",
        "coordinates:1",
        "coordinates_1",
        "position:1",
        "position_y",
        "pos_y",
        "y coord",
    ],
    &[
        "z",
        "points:2",
        "points_2",
        "coordinates:2",
        "coordinates_2",
        "position:2",
        "position_z",
        "pos_z",
        "z coord",
    ],
    DIAMETER,
    RADIUS,
];

/// Accepted names of a column of diameters.
pub(super) const DIAMETER: &[&str] = &["diameter", "diam"];

/// Accepted names of a column of radii.
pub(super) const RADIUS: &[&str] = &["radius", "radii", "r"];

/// Relative difference allowed between a diameter and twice the radius beside it: both are rounded.
const SAME_SIZE: f64 = 0.01;

/// A name in a header, and the unit at its end.
pub(super) struct Named {
    pub name: String,
    pub unit: Option<LengthUnit>,
}

impl Named {
    /// Parses a name such as `X_mm`, `"Diameter (m)"` or `Points:0`.
    pub fn of(text: &str) -> Self {
        let text = text.trim().trim_matches('"').trim().to_lowercase();
        for unit in LengthUnit::ALL {
            let name = unit.name();
            for end in [format!("_{name}"), format!("({name})"), format!("[{name}]")] {
                if let Some(before) = text.strip_suffix(&end) {
                    return Self { name: before.trim().to_owned(), unit: Some(unit) };
                }
            }
        }
        Self { name: text, unit: None }
    }
}

/// Places of the four columns, their unit, and the factor that makes the last a diameter.
struct Header {
    places: [usize; 4],
    unit: Option<LengthUnit>,
    factor: f64,
    /// Columns of radii beside the diameters, and the factor that makes them diameters in their unit.
    radii: Vec<(usize, f64)>,
}

impl Header {
    /// Reads a header; `None` if the line is no header of a packing.
    fn read(file: &str, (line, text): Line<'_>, delimiter: char) -> Result<Option<Self>, ImportError> {
        let names: Vec<Named> = text.split(delimiter).map(Named::of).collect();
        let called = |which: usize| -> Vec<usize> {
            let is =
                |(at, named): (usize, &Named)| CALLED[which].contains(&named.name.as_str()).then_some(at);
            names.iter().enumerate().filter_map(is).collect()
        };
        let all: [Vec<usize>; 5] = std::array::from_fn(called);
        if all.iter().all(Vec::is_empty) {
            return Ok(None);
        }
        let (size, factor) = if all[3].is_empty() { (4, 2.0) } else { (3, 1.0) };
        let mut places = [0; 4];
        for (slot, (which, name)) in
            places.iter_mut().zip([(0, "x"), (1, "y"), (2, "z"), (size, "diameter or radius")])
        {
            let [place] = all[which][..] else {
                let count = all[which].len();
                let allowed = format!(
                    "one column each for x, y, z and the diameter or radius, with their unit, as x_mm, \
                     y_mm, z_mm and diameter_mm ({count} for {name} found)"
                );
                return Err(refused(file, line, "header", text, allowed));
            };
            *slot = place;
        }
        let unit = names[places[0]].unit;
        if places.iter().any(|&place| names[place].unit != unit) {
            let allowed = "the same unit at the end of all four names, as x_mm, y_mm, z_mm and diameter_mm";
            return Err(refused(file, line, "header", text, allowed));
        }
        // `r` may be a colour there.
        let beside = all[4].iter().filter(|&&at| size == 3 && names[at].name != "r");
        let factor_of = |&at: &usize| {
            let units = names[at].unit.zip(unit).map_or(1.0, |(radius, all)| radius.mm() / all.mm());
            (at, 2.0 * units)
        };
        let radii = beside.map(factor_of).collect();
        Ok(Some(Self { places, unit, factor, radii }))
    }
}

pub(super) fn csv(file: &str, text: &str) -> Result<FileGrains, ImportError> {
    let ended = |line: usize, expected: &str| ImportError::Truncated {
        file: file.into(),
        line,
        expected: expected.into(),
    };
    let lines = text.lines().enumerate().map(|(i, line)| (i + 1, line)).filter(|(_, l)| !l.trim().is_empty());
    if lines.clone().next().is_none() {
        return Err(ended(0, CELL_LINES));
    }
    let mut cell = FileCell::Unsaid;
    for comment in lines.clone().take_while(|(_, line)| line.trim_start().starts_with('#')) {
        match said_of_cell(file, comment)? {
            FileCell::Unsaid => {}
            said if matches!(cell, FileCell::Unsaid) => cell = said,
            _ => return Err(refused(file, comment.0, "cell", comment.1, "one line of the cell")),
        }
    }
    let mut rows = lines.filter(|(_, line)| !line.trim_start().starts_with('#'));
    let Some((header_line, header)) = rows.next() else {
        return Err(ended(1, "the header x_mm,y_mm,z_mm,diameter_mm"));
    };
    let delimiter = [',', ';', '\t'].into_iter().max_by_key(|&d| header.matches(d).count()).unwrap_or(',');
    let Some(Header { places, unit, factor, radii }) = Header::read(file, (header_line, header), delimiter)?
    else {
        return Err(ImportError::Unknown {
            file: file.into(),
            looks_like: format!("line {header_line} is \"{}\"", crate::gradation::shortened(header.trim())),
        });
    };
    let width = header.split(delimiter).count();
    let (mut grains, mut last) = (Vec::new(), header_line);
    for (line, row) in rows {
        last = line;
        let fields: Vec<&str> = row.split(delimiter).collect();
        if let Some(missing) = places.iter().position(|&place| place >= fields.len()) {
            let allowed = format!("{width} fields, as in the header");
            return Err(refused(file, line, super::found::NAMES[missing], row, allowed));
        }
        let read = grain(file, line, &fields, places, factor)?;
        for &(at, factor) in &radii {
            let text = fields.get(at).copied().unwrap_or_default().trim();
            let is_other = |radius: f64| (factor * radius - read[3]).abs() > SAME_SIZE * read[3];
            if text.parse().is_ok_and(is_other) {
                let allowed = "half the diameter in the same row; leave out the column that is wrong";
                return Err(refused(file, line, "radius", text, allowed));
            }
        }
        grains.push(read);
    }
    if grains.is_empty() {
        return Err(ended(last, "at least one grain"));
    }
    // The line of the cell gives the unit of the columns too if they name none.
    let unit = unit.or(matches!(cell, FileCell::Known(Cell::Periodic(_))).then_some(LengthUnit::Mm));
    if matches!(cell, FileCell::Known(Cell::Periodic(_))) && unit != Some(LengthUnit::Mm) {
        let allowed = "columns in mm, as the cell above them";
        return Err(refused(file, header_line, "header", header, allowed));
    }
    Ok(FileGrains { columns: in_columns(&grains), unit, cell, line: header_line, notes: Vec::new() })
}

const CELL_LINES: &str = "a line \"# cell_mm = Lx, Ly, Lz\" or \"# cell = none\"";

/// Reads the cell from a comment; most comments do not give one.
fn said_of_cell(file: &str, (line, text): Line<'_>) -> Result<FileCell, ImportError> {
    let Some((key, value)) = text.trim().strip_prefix('#').and_then(|rest| rest.split_once('=')) else {
        return Ok(FileCell::Unsaid);
    };
    let wrong = || refused(file, line, "cell", text, CELL_LINES);
    // A spreadsheet fills the line up with delimiters.
    let value = value.trim().trim_end_matches([',', ';', '\t', ' ']);
    match (key.trim().to_lowercase().as_str(), value) {
        ("cell" | "cell_mm", none) if none.eq_ignore_ascii_case("none") => Ok(FileCell::Known(Cell::Free)),
        ("cell_mm", lengths) => {
            let lengths: Vec<&str> = lengths.split([',', ';', '\t']).collect();
            let [x, y, z] = lengths[..] else { return Err(wrong()) };
            let length = |text| number(file, line, "cell_mm", text, Kind::Positive);
            Ok(FileCell::Known(Cell::Periodic([length(x)?, length(y)?, length(z)?])))
        }
        (key, _) if key.starts_with("cell") => Err(wrong()),
        _ => Ok(FileCell::Unsaid),
    }
}
