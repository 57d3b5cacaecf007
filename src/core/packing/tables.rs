//! Packings as text: CSV, dumps of LAMMPS and LIGGGHTS, Yade's `export.text`, MercuryDPM's `.data`.
//!
//! # CSV
//! One column each for x, y, z and the diameter or the radius, by name. A comment above the header,
//! `# cell_mm = Lx, Ly, Lz`, gives a periodic cell with a corner at the origin, `# cell = none` free
//! boundaries; without one the cell is not given. The header names the columns in any order, with their unit
//! at the end (`x_mm`, `Diameter (m)`) or without one, in which case the unit is not given; other columns are
//! ignored. ParaView's names of coordinates (`Points:0`, `coordinates_0`) are accepted. Comma, semicolon or
//! tab between columns; a byte order mark, CRLF, blank lines and further `#` comments are allowed.
//!
//! # Dumps
//! The last frame with atoms is read. A dump has the columns `x y z` (or `xu`, `xs`, `xsu` and so on),
//! `radius` or `diameter`, and optionally `id`, which then gives the order. Boundaries `pp pp pp` give a
//! periodic cell, moved to the origin; boundaries without any `p` are free, and others are too if the user
//! says so. `ITEM: UNITS` (LAMMPS writes it after `dump_modify ID units yes`, LIGGGHTS does not) gives the
//! unit of length: `si`, `cgs`, `micro` and `nano` have one, `lj` has none, and the others are for atoms.
//!
//! # Yade and MercuryDPM
//! Yade writes a first line `#format x_y_z_r` (more columns may follow, such as `matId`), possibly a
//! comment, and one row per sphere. MercuryDPM writes frames: a line with the number of particles, the
//! time and the bounds `xmin ymin zmin xmax ymax zmax`, then that many rows of at least 14 numbers:
//! position, velocity, radius, rotation, angular velocity and one more. The last frame with grains is
//! read. Neither program gives its unit of length or tells if its boundaries are periodic.

use super::Cell;
use super::fields::{
    FileCell, FileGrains, Kind, LengthUnit, Line, NAMES, Problem, ReadingNote, bounds, ended, grain, number,
    numbered, refused,
};
use crate::gradation::shortened;

/// Accepted names of a coordinate, in lower case without unit; `@` represents x, y or z, `#` 0, 1 or 2.
const COORDINATE: [&str; 9] = [
    "@",
    "points:#",
    "points_#",
    "coordinates:#",
    "coordinates_#",
    "position:#",
    "position_@",
    "pos_@",
    "@ coord",
];

/// Accepted names of a column of diameters, and of a column of radii.
pub(super) const DIAMETER: &[&str] = &["diameter", "diam"];
pub(super) const RADIUS: &[&str] = &["radius", "radii", "r"];

/// Relative difference allowed between a diameter and twice the radius in the same row: both are rounded.
const SAME_SIZE: f64 = 0.01;

/// A name in a header, and the unit at its end, if any.
pub(super) struct Named {
    pub(crate) name: String,
    pub(crate) unit: Option<LengthUnit>,
}

impl Named {
    /// Parses a name such as `X_mm`, `"Diameter (m)"` or `Points:0`.
    pub(crate) fn of(text: &str) -> Self {
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

/// Indices of the four columns, their unit, and the factor that turns the last into a diameter.
struct Header {
    places: [usize; 4],
    unit: Option<LengthUnit>,
    factor: f64,
    /// Columns of radii beside the diameters, and the factor that turns each into a diameter in its unit.
    radii: Vec<(usize, f64)>,
}

impl Header {
    /// Reads a header; `None` if the line is not the header of a packing.
    fn read((line, text): Line<'_>, delimiter: char) -> Result<Option<Self>, Problem> {
        let names: Vec<Named> = text.split(delimiter).map(Named::of).collect();
        // x, y, z, diameter, radius.
        let is_called = |column: usize, name: &str| match column {
            3 => DIAMETER.contains(&name),
            4 => RADIUS.contains(&name),
            axis => {
                let (letter, number) = (NAMES[axis], axis.to_string());
                COORDINATE.iter().any(|form| form.replace('@', letter).replace('#', &number) == name)
            }
        };
        let all: [Vec<usize>; 5] = std::array::from_fn(|column| {
            (0..names.len()).filter(|&at| is_called(column, &names[at].name)).collect()
        });
        if all.iter().all(Vec::is_empty) {
            return Ok(None);
        }
        let (size, factor) = if all[3].is_empty() { (4, 2.0) } else { (3, 1.0) };
        let mut places = [0; 4];
        for (slot, (column, name)) in
            places.iter_mut().zip([(0, "x"), (1, "y"), (2, "z"), (size, "diameter or radius")])
        {
            let [place] = all[column][..] else {
                let count = all[column].len();
                let allowed = format!(
                    "one column each for x, y, z and the diameter or radius, with their unit, as x_mm, \
                     y_mm, z_mm and diameter_mm ({count} for {name} found)"
                );
                return Err(refused(line, "header", text, allowed));
            };
            *slot = place;
        }
        let unit = names[places[0]].unit;
        if places.iter().any(|&place| names[place].unit != unit) {
            let allowed = "the same unit at the end of all four names, as x_mm, y_mm, z_mm and diameter_mm";
            return Err(refused(line, "header", text, allowed));
        }
        // `r` may be a colour here.
        let beside = all[4].iter().filter(|&&at| size == 3 && names[at].name != "r");
        let factor_of = |&at: &usize| {
            let units = names[at].unit.zip(unit).map_or(1.0, |(radius, all)| radius.mm() / all.mm());
            (at, 2.0 * units)
        };
        let radii = beside.map(factor_of).collect();
        Ok(Some(Self { places, unit, factor, radii }))
    }
}

pub(super) fn csv(text: &str) -> Result<FileGrains, Problem> {
    let lines = numbered(text);
    if lines.clone().next().is_none() {
        return Err(ended(0, CELL_LINES));
    }
    let mut cell = FileCell::Unsaid;
    for comment in lines.clone().take_while(|(_, line)| line.trim_start().starts_with('#')) {
        match said_of_cell(comment)? {
            FileCell::Unsaid => {}
            said if matches!(cell, FileCell::Unsaid) => cell = said,
            _ => return Err(refused(comment.0, "cell", comment.1, "one line of the cell")),
        }
    }
    let mut rows = lines.filter(|(_, line)| !line.trim_start().starts_with('#'));
    let Some((header_line, header)) = rows.next() else {
        return Err(ended(1, "the header x_mm,y_mm,z_mm,diameter_mm"));
    };
    let delimiter = [',', ';', '\t'].into_iter().max_by_key(|&d| header.matches(d).count()).unwrap_or(',');
    let Some(Header { places, unit, factor, radii }) = Header::read((header_line, header), delimiter)? else {
        let looks_like = format!("line {header_line} is \"{}\"", shortened(header.trim()));
        return Err(Problem::Unknown(looks_like));
    };
    let width = header.split(delimiter).count();
    let mut grains = Vec::new();
    for (line, row) in rows {
        let fields: Vec<&str> = row.split(delimiter).collect();
        if let Some(missing) = places.iter().position(|&place| place >= fields.len()) {
            let allowed = format!("{width} fields, as in the header");
            return Err(refused(line, NAMES[missing], row, allowed));
        }
        let read = grain(line, &fields, places, factor)?;
        for &(at, factor) in &radii {
            let text = fields.get(at).copied().unwrap_or_default().trim();
            let is_other = |radius: f64| (factor * radius - read[3]).abs() > SAME_SIZE * read[3];
            if text.parse().is_ok_and(is_other) {
                let allowed = "half the diameter in the same row; leave out the column that is wrong";
                return Err(refused(line, "radius", text, allowed));
            }
        }
        grains.push(read);
    }
    if grains.is_empty() {
        return Err(ended(header_line, "at least one grain"));
    }
    // If the columns name no unit, they have that of the cell's line.
    let unit = unit.or(matches!(cell, FileCell::Known(Cell::Periodic(_))).then_some(LengthUnit::Mm));
    if matches!(cell, FileCell::Known(Cell::Periodic(_))) && unit != Some(LengthUnit::Mm) {
        let allowed = "columns in mm, as the cell above them";
        return Err(refused(header_line, "header", header, allowed));
    }
    Ok(FileGrains { grains, unit, cell, line: header_line, note: None })
}

const CELL_LINES: &str = "a line \"# cell_mm = Lx, Ly, Lz\" or \"# cell = none\"";

/// Reads the cell from a comment; most comments give none.
fn said_of_cell((line, text): Line<'_>) -> Result<FileCell, Problem> {
    let Some((key, value)) = text.trim().strip_prefix('#').and_then(|rest| rest.split_once('=')) else {
        return Ok(FileCell::Unsaid);
    };
    let wrong = || refused(line, "cell", text, CELL_LINES);
    // Spreadsheets pad the line with delimiters.
    let value = value.trim().trim_end_matches([',', ';', '\t', ' ']);
    match (key.trim().to_lowercase().as_str(), value) {
        ("cell" | "cell_mm", none) if none.eq_ignore_ascii_case("none") => Ok(FileCell::Known(Cell::Free)),
        ("cell_mm", lengths) => {
            let lengths: Vec<&str> = lengths.split([',', ';', '\t']).collect();
            let [x, y, z] = lengths[..] else { return Err(wrong()) };
            let length = |text| number(line, "cell_mm", text, Kind::Positive);
            Ok(FileCell::Known(Cell::Periodic([length(x)?, length(y)?, length(z)?])))
        }
        (key, _) if key.starts_with("cell") => Err(wrong()),
        _ => Ok(FileCell::Unsaid),
    }
}

/// LAMMPS unit systems that have a unit of length.
const UNITS: [(&str, LengthUnit); 4] =
    [("si", LengthUnit::M), ("cgs", LengthUnit::Cm), ("micro", LengthUnit::Um), ("nano", LengthUnit::Nm)];

/// Unit system in which a length has no unit.
const REDUCED: &str = "lj";

/// Reads the units of a dump, given once or before every frame: the name, and its unit of length.
fn unit(text: &str, given: Option<LengthUnit>) -> Result<Option<(&'static str, LengthUnit)>, Problem> {
    let mut named: Option<(&str, LengthUnit)> = None;
    for (at, item) in text.match_indices("ITEM: UNITS") {
        let line = 2 + text[..at].matches('\n').count();
        let name = text[at + item.len()..].lines().nth(1).map_or("", str::trim);
        let unit = match (UNITS.into_iter().find(|unit| unit.0 == name), given) {
            (Some(unit), _) => unit,
            (None, Some(given)) if name == REDUCED => (REDUCED, given),
            (None, _) => {
                let allowed = "si, cgs, micro or nano; with lj, --unit (network.unit in a scene) says what a \
                               length of 1 is; the others are of atoms";
                return Err(refused(line, "units", name, allowed));
            }
        };
        if named.is_some_and(|before| before.0 != unit.0) {
            return Err(refused(line, "units", name, "the same units in every frame"));
        }
        named = Some(unit);
    }
    Ok(named)
}

/// Reads the last frame; `given` is the user's unit.
pub(super) fn dump(text: &str, given: Option<LengthUnit>) -> Result<FileGrains, Problem> {
    let unit = unit(text, given)?;
    let frames = text.matches(FRAME).count();
    // Only the last frame with atoms is parsed: a long run costs no more than its end.
    let (mut start, mut end) = (text.rfind(FRAME).unwrap_or(0), text.len());
    while is_empty(&text[start..end])
        && let Some(before) = text[..start].rfind(FRAME)
    {
        (start, end) = (before, start);
    }
    let lacking = (end < text.len()).then_some("atoms");
    let text = &text[..end];
    let time = ("timestep", shortened(text[start..].lines().nth(1).map_or("", str::trim)));
    let note = (frames > 1).then_some(ReadingNote::Frame { frames, lacking, time });
    let before = text[..start].matches('\n').count();
    let mut lines = text[start..].lines().enumerate().map(|(i, line)| (before + i + 1, line));
    let (mut atoms, mut bounds, mut last) = (None, None, before);
    while let Some((line, item)) = lines.next() {
        last = line;
        let Some(item) = item.trim().strip_prefix("ITEM:").map(str::trim) else {
            if item.trim().is_empty() {
                continue;
            }
            return Err(refused(line, "section", item, "a line that starts with ITEM:"));
        };
        if item == "NUMBER OF ATOMS" {
            let (line, value) = lines.next().ok_or_else(|| ended(last, "the number of atoms"))?;
            let count = value.trim().parse::<u64>().ok().filter(|&n| n > 0);
            let wrong = || refused(line, "number of atoms", value, "a whole number from 1");
            atoms = Some(count.ok_or_else(wrong)?);
        } else if let Some(kinds) = item.strip_prefix("BOX BOUNDS") {
            let mut box_lines = [(0, ""); 3];
            for slot in &mut box_lines {
                *slot = lines.next().ok_or_else(|| ended(last, "three lines of box bounds"))?;
                last = slot.0;
            }
            bounds = Some(box_bounds((line, kinds), box_lines)?);
        } else if let Some(columns) = item.strip_prefix("ATOMS") {
            let first = |what: &str| refused(line, "section", item, format!("ITEM: {what} first"));
            let atoms = atoms.ok_or_else(|| first("NUMBER OF ATOMS"))?;
            let (periodic, bounds) = bounds.ok_or_else(|| first("BOX BOUNDS"))?;
            let grains = atom_rows((line, columns), atoms, (periodic, bounds), lines)?;
            let cell = match periodic {
                Some(true) => FileCell::Known(Cell::Periodic(bounds.map(|[low, high]| high - low))),
                Some(false) => FileCell::Known(Cell::Free),
                None => FileCell::Mixed,
            };
            let unit = unit.map(|(_, unit)| unit);
            return Ok(FileGrains { grains, unit, cell, line, note });
        } else {
            // TIMESTEP, TIME, UNITS: one line, already read or not needed.
            lines.next();
        }
    }
    Err(ended(last, "ITEM: ATOMS"))
}

const FRAME: &str = "ITEM: TIMESTEP";

/// Tells if a frame declares no atoms.
fn is_empty(frame: &str) -> bool {
    let number = frame.split_once("ITEM: NUMBER OF ATOMS").and_then(|(_, rest)| rest.lines().nth(1));
    number.is_some_and(|number| number.trim() == "0")
}

/// Periodicity of the box (`None` if it is periodic along some axes only), and its bounds.
type Bounds = (Option<bool>, [[f64; 2]; 3]);

fn box_bounds((line, kinds): Line<'_>, lines: [Line<'_>; 3]) -> Result<Bounds, Problem> {
    let words: Vec<&str> = kinds.split_whitespace().collect();
    if words.contains(&"xy") || words.contains(&"abc") {
        return Err(refused(line, "box bounds", kinds, "a box with right angles"));
    }
    let [_, _, _] = words[..] else {
        let allowed = "three boundaries, as pp pp pp (a periodic cell) or ff ff ff (free)";
        return Err(refused(line, "box bounds", kinds.trim(), allowed));
    };
    let periodic = match words.iter().filter(|&&kind| kind == "pp").count() {
        3 => Some(true),
        0 if words.iter().all(|kind| !kind.contains('p')) => Some(false),
        _ => None,
    };
    let mut ends = [[0.0; 2]; 3];
    for (slot, (line, text)) in ends.iter_mut().zip(lines) {
        let values: Vec<&str> = text.split_whitespace().collect();
        let [low, high] = values[..] else {
            return Err(refused(line, "box bounds", text, "two numbers, low and high"));
        };
        *slot = bounds(line, "box bounds", [low, high], text)?;
    }
    Ok((periodic, ends))
}

fn atom_rows<'a>(
    (header_line, header): Line<'_>,
    atoms: u64,
    (periodic, bounds): Bounds,
    lines: impl Iterator<Item = Line<'a>>,
) -> Result<Vec<[f64; 4]>, Problem> {
    let names: Vec<&str> = header.split_whitespace().collect();
    let place = |name: &str| names.iter().position(|&n| n == name);
    let missing = |what: &str| refused(header_line, "columns", header.trim(), what);
    // Column of each coordinate, and true for fractions of the box.
    let mut coordinates = [(0, false); 3];
    for (slot, axis) in coordinates.iter_mut().zip(NAMES) {
        let forms = [("", false), ("u", false), ("s", true), ("su", true)];
        let form = forms.iter().find_map(|(end, scaled)| Some((place(&format!("{axis}{end}"))?, *scaled)));
        *slot = form.ok_or_else(|| missing("columns x, y and z (or xu, xs, xsu and so on)"))?;
    }
    let (size, factor) = match (place("diameter"), place("radius")) {
        (Some(diameter), _) => (diameter, 1.0),
        (None, Some(radius)) => (radius, 2.0),
        (None, None) => return Err(missing("a column called diameter or radius")),
    };
    let (id, mut grains) = (place("id"), Vec::new());
    let mut last = header_line;
    for (line, row) in lines {
        if row.trim().is_empty() {
            continue;
        }
        last = line;
        if grains.len() as u64 == atoms {
            let allowed = format!("{atoms} rows, the number of atoms, and then the end of the file");
            return Err(refused(line, "atoms", row, allowed));
        }
        let fields: Vec<&str> = row.split_whitespace().collect();
        if fields.len() != names.len() {
            return Err(refused(line, "atoms", row, format!("{} fields", names.len())));
        }
        let mut grain = [0.0; 4];
        for (axis, (place, is_scaled)) in coordinates.into_iter().enumerate() {
            let [low, high] = bounds[axis];
            let value = number(line, NAMES[axis], fields[place], Kind::Finite)?;
            let value = if is_scaled { low + value * (high - low) } else { value };
            grain[axis] = if periodic == Some(true) { value - low } else { value };
        }
        grain[3] = factor * number(line, "diameter", fields[size], Kind::Positive)?;
        let order = match id {
            Some(place) => fields[place]
                .parse::<u64>()
                .map_err(|_| refused(line, "id", fields[place], "a whole number"))?,
            None => grains.len() as u64,
        };
        grains.push((order, line, grain));
    }
    if (grains.len() as u64) < atoms {
        let expected = format!("{atoms} rows of atoms, {} found", grains.len());
        return Err(ended(last, expected));
    }
    grains.sort_by_key(|&(order, line, _)| (order, line));
    if let Some(pair) = grains.windows(2).find(|pair| pair[0].0 == pair[1].0) {
        let allowed = format!("every id once (it is also on line {})", pair[0].1);
        return Err(refused(pair[1].1, "id", &pair[1].0.to_string(), allowed));
    }
    Ok(grains.into_iter().map(|(_, _, grain)| grain).collect())
}

/// Number of values in a MercuryDPM header: in three dimensions, and in two.
const HEADERS: [usize; 2] = [8, 6];
/// Number of values in a MercuryDPM row, and the index of the radius.
const ROW: (usize, usize) = (14, 6);

pub(super) fn yade(text: &str) -> Result<FileGrains, Problem> {
    let mut lines = numbered(text).map(|(i, line)| (i, line.trim()));
    let Some((line, first)) = lines.next() else { return Err(ended(0, "a line #format x_y_z_r")) };
    let names: Vec<&str> = first.trim_start_matches("#format").trim().split('_').collect();
    let place = |name: &str| names.iter().position(|named| *named == name);
    let (Some(x), Some(y), Some(z), Some(r)) = (place("x"), place("y"), place("z"), place("r")) else {
        let allowed = "x, y, z and r among the columns, as #format x_y_z_r";
        return Err(refused(line, "format", first, allowed));
    };
    let mut grains = Vec::new();
    for (line, row) in lines.filter(|(_, line)| !line.starts_with('#')) {
        let fields: Vec<&str> = row.split_whitespace().collect();
        // The last column may be a vector or a list of several words.
        if fields.len() < names.len() {
            return Err(refused(line, "row", row, format!("{} fields, as in line 1", names.len())));
        }
        grains.push(grain(line, &fields, [x, y, z, r], 2.0)?);
    }
    if grains.is_empty() {
        return Err(ended(line, "at least one sphere"));
    }
    Ok(FileGrains { grains, unit: None, cell: FileCell::Unsaid, line, note: None })
}

/// Tells if a text begins like a frame of MercuryDPM: with numbers only.
pub(super) fn is_mercury(text: &str) -> bool {
    let line = text.lines().map(str::trim).find(|line| !line.is_empty() && !line.starts_with('#'));
    line.is_some_and(|line| {
        let words: Vec<&str> = line.split_whitespace().collect();
        HEADERS.contains(&words.len())
            && words[0].parse::<u64>().is_ok()
            && words.iter().all(|word| word.parse::<f64>().is_ok())
    })
}

pub(super) fn mercury(text: &str) -> Result<FileGrains, Problem> {
    let mut lines =
        numbered(text).map(|(i, line)| (i, line.trim())).filter(|(_, line)| !line.starts_with('#'));
    let (mut frames, mut frame, mut last, mut is_last) = (0, None, 0, true);
    while let Some((line, header)) = lines.next() {
        let words: Vec<&str> = header.split_whitespace().collect();
        if words.len() == HEADERS[1] {
            let allowed = "three dimensions: N time xmin ymin zmin xmax ymax zmax";
            return Err(refused(line, "frame", header, allowed));
        }
        let count = words[0].parse::<usize>().ok().filter(|_| words.len() == HEADERS[0]);
        let allowed = "N time xmin ymin zmin xmax ymax zmax";
        let count = count.ok_or_else(|| refused(line, "frame", header, allowed))?;
        let mut ends = [[0.0; 2]; 3];
        for (axis, slot) in ends.iter_mut().enumerate() {
            *slot = bounds(line, "bounds", [words[2 + axis], words[5 + axis]], header)?;
        }
        let rows: Vec<(usize, &str)> = lines.by_ref().take(count).collect();
        if rows.len() < count {
            let expected = format!("{count} rows of particles, {} found", rows.len());
            return Err(ended(line + rows.len(), expected));
        }
        frames += 1;
        // The first frame is empty if a simulation fills a box, the last if it empties one.
        (last, is_last) = (line, count > 0);
        if count > 0 {
            frame = Some((line, words[1], ends, rows));
        }
    }
    let Some((line, time, ends, rows)) = frame else {
        return Err(ended(last, "a frame with at least one particle"));
    };
    let mut grains = Vec::with_capacity(rows.len());
    for (line, row) in rows {
        let fields: Vec<&str> = row.split_whitespace().collect();
        if fields.len() < ROW.0 {
            let allowed = format!(
                "at least {} numbers: position, velocity, radius, rotation, angular velocity, one more",
                ROW.0
            );
            return Err(refused(line, "particle", row, allowed));
        }
        grains.push(grain(line, &fields, [0, 1, 2, ROW.1], 2.0)?);
    }
    let (lacking, time) = ((!is_last).then_some("grains"), ("time", shortened(time)));
    let note = (frames > 1).then_some(ReadingNote::Frame { frames, lacking, time });
    Ok(FileGrains { grains, unit: None, cell: FileCell::Bounds(ends), line, note })
}
