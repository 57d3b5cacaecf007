//! Packings from files: CSV, and text dumps of LAMMPS.
//!
//! # CSV
//! The first line is `# cell_mm = Lx, Ly, Lz` for a periodic cell with its corner at the origin, or
//! `# cell = none` for free boundaries. Then a header that names `x_mm`, `y_mm`, `z_mm` and
//! `diameter_mm` in any order (further columns are passed over), then a row a grain. Comma, semicolon
//! or tab between columns; a byte order mark, CRLF, blank lines and further `#` comments are fine.
//!
//! # LAMMPS
//! The last frame of a dump with the columns `x y z` (or `xu`, `xs`, `xsu` and so on), `radius` or
//! `diameter`, and `id` where there is one, which then decides the order. Boundaries `pp pp pp` are a
//! periodic cell, moved to the origin; boundaries without any `p` are free. Lengths are taken as mm.

use super::grains::{Cell, Packing};
use crate::gradation::{Position, shortened};
use crate::store::read_regular;
use std::path::Path;

/// Largest packing file that is read, in bytes.
pub const PACKING_FILE_LIMIT_BYTES: u64 = 4 << 30;

/// A packing file that cannot be used.
#[derive(Debug, thiserror::Error)]
pub enum ImportError {
    /// The file cannot be opened or read.
    #[error("{file}: cannot be read: {source}")]
    Read {
        /// File as the user named it.
        file: String,
        /// What the system said.
        source: std::io::Error,
    },
    /// A folder where a file is wanted.
    #[error("{file} is a folder; allowed: a packing as CSV or as a LAMMPS text dump")]
    Folder {
        /// Folder as the user named it.
        file: String,
    },
    /// More bytes than any packing has.
    #[error("{file} is larger than {limit} bytes; allowed: a packing file up to that size")]
    TooLarge {
        /// File as the user named it.
        file: String,
        /// Largest file that is read.
        limit: u64,
    },
    /// Bytes that are no UTF-8 text.
    #[error("{file}, line {line}: byte 0x{byte:02X} is not UTF-8 text; allowed: a text file saved as UTF-8")]
    Encoding {
        /// File as the user named it.
        file: String,
        /// Line, counted from 1.
        line: usize,
        /// The first byte that does not belong.
        byte: u8,
    },
    /// A value that is not allowed where it stands.
    #[error("{at}: \"{value}\" is not allowed; allowed: {allowed}")]
    Value {
        /// Where it stands.
        at: Position,
        /// The value, shortened.
        value: String,
        /// What is allowed there.
        allowed: String,
    },
    /// The file ends before the packing does.
    #[error("{file} ends after line {line}; expected {expected}")]
    Truncated {
        /// File as the user named it.
        file: String,
        /// Its last line.
        line: usize,
        /// What should have followed.
        expected: String,
    },
}

impl Packing {
    /// Reads a packing from a CSV file or a LAMMPS text dump, whichever it is.
    ///
    /// # Errors
    /// A file that cannot be read, is a folder, too large or no text; anything that is not as the
    /// module says, with the line, the field, the value and what is allowed there.
    pub fn read(path: impl AsRef<Path>) -> Result<Packing, ImportError> {
        let path = path.as_ref();
        let file = path.display().to_string();
        let failed = |source| ImportError::Read { file: file.clone(), source };
        if std::fs::metadata(path).map_err(failed)?.is_dir() {
            return Err(ImportError::Folder { file });
        }
        match read_regular(path, PACKING_FILE_LIMIT_BYTES).map_err(failed)? {
            Some(bytes) => Packing::parse(&file, &bytes),
            None if std::fs::metadata(path).is_ok_and(|meta| !meta.is_file()) => {
                Err(failed(std::io::Error::other("is no regular file")))
            }
            None => Err(ImportError::TooLarge { file, limit: PACKING_FILE_LIMIT_BYTES }),
        }
    }

    /// [`Packing::read`] on the content of a file, called `name` in messages.
    ///
    /// ```
    /// use voidwalk::packing::{Cell, Packing};
    /// let text = "# cell_mm = 2, 2, 2\nx_mm,y_mm,z_mm,diameter_mm\n0.5,0.5,0.5,1\n";
    /// let packing = Packing::parse("example", text.as_bytes())?;
    /// assert_eq!((packing.cell, packing.diameter), (Cell::Periodic([2.0; 3]), vec![1.0]));
    /// # Ok::<(), voidwalk::packing::ImportError>(())
    /// ```
    ///
    /// # Errors
    /// As [`Packing::read`].
    pub fn parse(name: &str, content: &[u8]) -> Result<Packing, ImportError> {
        let text = std::str::from_utf8(content).map_err(|error| {
            let good = error.valid_up_to();
            let line = 1 + content[..good].iter().filter(|&&b| b == b'\n').count();
            ImportError::Encoding { file: name.into(), line, byte: content[good] }
        })?;
        let text = text.strip_prefix('\u{feff}').unwrap_or(text);
        if text.trim_start().starts_with("ITEM:") { dump(name, text) } else { csv(name, text) }
    }
}

/// A line of a file and its number, counted from 1.
type Line<'a> = (usize, &'a str);

fn refused(
    file: &str,
    line: usize,
    field: &'static str,
    value: &str,
    allowed: impl Into<String>,
) -> ImportError {
    let at = Position { file: file.into(), line, field, column: None };
    ImportError::Value { at, value: shortened(value), allowed: allowed.into() }
}

/// What a number must be.
#[derive(Clone, Copy, PartialEq)]
enum Kind {
    Finite,
    Positive,
}

fn number(file: &str, line: usize, field: &'static str, text: &str, kind: Kind) -> Result<f64, ImportError> {
    let value = text.trim().trim_matches('"').parse::<f64>().ok().filter(|v| v.is_finite());
    match (value, kind) {
        (Some(value), Kind::Finite) => Ok(value),
        (Some(value), Kind::Positive) if value > 0.0 => Ok(value),
        (_, Kind::Finite) => Err(refused(file, line, field, text.trim(), "a finite number")),
        (_, Kind::Positive) => Err(refused(file, line, field, text.trim(), "a finite number above 0")),
    }
}

const COLUMNS: [&str; 4] = ["x_mm", "y_mm", "z_mm", "diameter_mm"];

fn csv(file: &str, text: &str) -> Result<Packing, ImportError> {
    let ended = |line: usize, expected: &str| ImportError::Truncated {
        file: file.into(),
        line,
        expected: expected.into(),
    };
    let mut lines =
        text.lines().enumerate().map(|(i, line)| (i + 1, line)).filter(|(_, l)| !l.trim().is_empty());
    let cell = match lines.next() {
        Some(first) => cell(file, first)?,
        None => return Err(ended(0, CELL_LINES)),
    };
    let mut last = 1;
    let mut rows = lines.filter(|(_, line)| !line.trim_start().starts_with('#'));
    let Some((header_line, header)) = rows.next() else {
        return Err(ended(last, "the header x_mm,y_mm,z_mm,diameter_mm"));
    };
    let delimiter = [',', ';', '\t'].into_iter().max_by_key(|&d| header.matches(d).count()).unwrap_or(',');
    let names: Vec<String> =
        header.split(delimiter).map(|name| name.trim().trim_matches('"').to_lowercase()).collect();
    let mut places = [0; 4];
    for (place, wanted) in places.iter_mut().zip(COLUMNS) {
        *place = match names.iter().filter(|name| *name == wanted).count() {
            1 => names.iter().position(|name| name == wanted).unwrap_or(0),
            found => {
                let allowed = format!(
                    "one column each called x_mm, y_mm, z_mm and diameter_mm ({found} called {wanted} found)"
                );
                return Err(refused(file, header_line, "header", header, allowed));
            }
        };
    }
    let mut columns = [Vec::new(), Vec::new(), Vec::new(), Vec::new()];
    for (line, row) in rows {
        last = line;
        let fields: Vec<&str> = row.split(delimiter).collect();
        for ((column, &place), name) in columns.iter_mut().zip(&places).zip(COLUMNS) {
            let Some(field) = fields.get(place) else {
                let allowed = format!("{} fields, as in the header", names.len());
                return Err(refused(file, line, name, row, allowed));
            };
            let kind = if name == "diameter_mm" { Kind::Positive } else { Kind::Finite };
            column.push(number(file, line, name, field, kind)?);
        }
    }
    if columns[0].is_empty() {
        return Err(ended(last.max(header_line), "at least one grain"));
    }
    let [x, y, z, diameter] = columns;
    Ok(Packing { cell, x, y, z, diameter })
}

const CELL_LINES: &str = "a first line \"# cell_mm = Lx, Ly, Lz\" or \"# cell = none\"";

fn cell(file: &str, (line, text): Line<'_>) -> Result<Cell, ImportError> {
    let wrong = || refused(file, line, "cell", text, CELL_LINES);
    let (key, value) =
        text.trim().strip_prefix('#').and_then(|rest| rest.split_once('=')).ok_or_else(wrong)?;
    // A spreadsheet fills the line up with delimiters.
    let value = value.trim().trim_end_matches([',', ';', '\t', ' ']);
    match (key.trim().to_lowercase().as_str(), value) {
        ("cell" | "cell_mm", none) if none.eq_ignore_ascii_case("none") => Ok(Cell::Free),
        ("cell_mm", lengths) => {
            let lengths: Vec<&str> = lengths.split([',', ';', '\t']).collect();
            let [x, y, z] = lengths[..] else { return Err(wrong()) };
            let length = |text| number(file, line, "cell_mm", text, Kind::Positive);
            Ok(Cell::Periodic([length(x)?, length(y)?, length(z)?]))
        }
        _ => Err(wrong()),
    }
}

/// How a dump gives a coordinate.
#[derive(Clone, Copy)]
struct Coordinate {
    place: usize,
    /// As a fraction of the box.
    scaled: bool,
}

fn dump(file: &str, text: &str) -> Result<Packing, ImportError> {
    // Only the last frame is parsed, so that a long run costs no more than its end.
    let start = text.rfind("ITEM: TIMESTEP").unwrap_or(0);
    let before = text[..start].matches('\n').count();
    let mut lines = text[start..].lines().enumerate().map(|(i, line)| (before + i + 1, line));
    let (mut atoms, mut bounds, mut last) = (None, None, before);
    let ended = |line: usize, expected: &str| ImportError::Truncated {
        file: file.into(),
        line,
        expected: expected.into(),
    };
    while let Some((line, item)) = lines.next() {
        last = line;
        let Some(item) = item.trim().strip_prefix("ITEM:").map(str::trim) else {
            if item.trim().is_empty() {
                continue;
            }
            return Err(refused(file, line, "section", item, "a line that starts with ITEM:"));
        };
        if item == "NUMBER OF ATOMS" {
            let (line, value) = lines.next().ok_or_else(|| ended(last, "the number of atoms"))?;
            let count = value.trim().parse::<u64>().ok().filter(|&n| n > 0);
            atoms = Some(
                count
                    .ok_or_else(|| refused(file, line, "number of atoms", value, "a whole number from 1"))?,
            );
        } else if let Some(kinds) = item.strip_prefix("BOX BOUNDS") {
            let mut box_lines = [(0, ""); 3];
            for slot in &mut box_lines {
                *slot = lines.next().ok_or_else(|| ended(last, "three lines of box bounds"))?;
                last = slot.0;
            }
            bounds = Some(box_bounds(file, (line, kinds), box_lines)?);
        } else if let Some(columns) = item.strip_prefix("ATOMS") {
            let atoms =
                atoms.ok_or_else(|| refused(file, line, "section", item, "ITEM: NUMBER OF ATOMS first"))?;
            let bounds =
                bounds.ok_or_else(|| refused(file, line, "section", item, "ITEM: BOX BOUNDS first"))?;
            return rows(file, (line, columns), atoms, bounds, lines);
        } else {
            // TIMESTEP, TIME, UNITS: one line that is not needed.
            lines.next();
        }
    }
    Err(ended(last, "ITEM: ATOMS"))
}

/// Whether the box is periodic, and its bounds.
type Bounds = (bool, [[f64; 2]; 3]);

fn box_bounds(file: &str, (line, kinds): Line<'_>, lines: [Line<'_>; 3]) -> Result<Bounds, ImportError> {
    let words: Vec<&str> = kinds.split_whitespace().collect();
    if words.contains(&"xy") || words.contains(&"abc") {
        return Err(refused(file, line, "box bounds", kinds, "a box with right angles"));
    }
    let periodic = words.iter().all(|&kind| kind == "pp");
    if words.len() != 3 || !(periodic || words.iter().all(|kind| !kind.contains('p'))) {
        let allowed = "pp pp pp (a periodic cell), or three boundaries without p (free)";
        return Err(refused(file, line, "box bounds", kinds.trim(), allowed));
    }
    let mut bounds = [[0.0; 2]; 3];
    for (slot, (line, text)) in bounds.iter_mut().zip(lines) {
        let values: Vec<&str> = text.split_whitespace().collect();
        let [low, high] = values[..] else {
            return Err(refused(file, line, "box bounds", text, "two numbers, low and high"));
        };
        let read = |text| number(file, line, "box bounds", text, Kind::Finite);
        *slot = [read(low)?, read(high)?];
        if slot[0] >= slot[1] {
            return Err(refused(file, line, "box bounds", text, "a low bound below the high one"));
        }
    }
    Ok((periodic, bounds))
}

fn rows<'a>(
    file: &str,
    (header_line, header): Line<'_>,
    atoms: u64,
    (periodic, bounds): Bounds,
    lines: impl Iterator<Item = Line<'a>>,
) -> Result<Packing, ImportError> {
    let names: Vec<&str> = header.split_whitespace().collect();
    let place = |name: &str| names.iter().position(|&n| n == name);
    let missing = |what: &str| refused(file, header_line, "columns", header.trim(), what);
    let coordinate = |axis: &str| {
        [("", false), ("u", false), ("s", true), ("su", true)].into_iter().find_map(|(suffix, scaled)| {
            place(&format!("{axis}{suffix}")).map(|place| Coordinate { place, scaled })
        })
    };
    let mut coordinates = [Coordinate { place: 0, scaled: false }; 3];
    for (slot, axis) in coordinates.iter_mut().zip(["x", "y", "z"]) {
        *slot = coordinate(axis).ok_or_else(|| missing("columns x, y and z (or xu, xs, xsu and so on)"))?;
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
            return Err(refused(file, line, "atoms", row, allowed));
        }
        let fields: Vec<&str> = row.split_whitespace().collect();
        if fields.len() != names.len() {
            return Err(refused(file, line, "atoms", row, format!("{} fields", names.len())));
        }
        let mut grain = [0.0; 4];
        for (axis, (slot, at)) in grain.iter_mut().zip(coordinates).enumerate() {
            let [low, high] = bounds[axis];
            let value = number(file, line, ["x", "y", "z"][axis], fields[at.place], Kind::Finite)?;
            let value = if at.scaled { low + value * (high - low) } else { value };
            *slot = if periodic { value - low } else { value };
        }
        grain[3] = factor * number(file, line, "diameter", fields[size], Kind::Positive)?;
        let order = match id {
            Some(place) => fields[place]
                .parse::<u64>()
                .map_err(|_| refused(file, line, "id", fields[place], "a whole number"))?,
            None => grains.len() as u64,
        };
        grains.push((order, line, grain));
    }
    if (grains.len() as u64) < atoms {
        let expected = format!("{atoms} rows of atoms, {} found", grains.len());
        return Err(ImportError::Truncated { file: file.into(), line: last, expected });
    }
    grains.sort_by_key(|&(order, line, _)| (order, line));
    if let Some(pair) = grains.windows(2).find(|pair| pair[0].0 == pair[1].0) {
        let allowed = format!("every id once (it stands on line {} too)", pair[0].1);
        return Err(refused(file, pair[1].1, "id", &pair[1].0.to_string(), allowed));
    }
    let column = |axis: usize| grains.iter().map(|(_, _, grain)| grain[axis]).collect();
    let cell = match periodic {
        true => Cell::Periodic(bounds.map(|[low, high]| high - low)),
        false => Cell::Free,
    };
    Ok(Packing { cell, x: column(0), y: column(1), z: column(2), diameter: column(3) })
}
