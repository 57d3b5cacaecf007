//! Packings from files: CSV, and text dumps of LAMMPS (`dump.rs`).
//!
//! # CSV
//! The first line is `# cell_mm = Lx, Ly, Lz` for a periodic cell with its corner at the origin, or
//! `# cell = none` for free boundaries. Then a header that names `x_mm`, `y_mm`, `z_mm` and
//! `diameter_mm` in any order (further columns are passed over), then a row a grain. Comma, semicolon
//! or tab between columns; a byte order mark, CRLF, blank lines and further `#` comments are fine.

use std::path::Path;

use super::dump::dump;
use super::fields::{ImportError, Kind, Line, number, refused};
use super::grains::{Cell, Packing};
use crate::store::read_regular;

/// Largest packing file that is read, in bytes.
pub const PACKING_FILE_LIMIT_BYTES: u64 = 4 << 30;

impl Packing {
    /// Reads a packing from a CSV file or a LAMMPS text dump, whichever it is.
    ///
    /// # Errors
    /// A file that cannot be read, is a folder, too large or no text; anything that is not as the
    /// module says, with the line, the field, the value and what is allowed there.
    pub fn read(path: impl AsRef<Path>) -> Result<Packing, ImportError> {
        Ok(Self::read_with_notes(path)?.0)
    }

    /// [`Packing::read`], with what a user must know of how it was understood: which frame, which unit.
    ///
    /// # Errors
    /// As [`Packing::read`].
    pub fn read_with_notes(path: impl AsRef<Path>) -> Result<(Packing, Vec<String>), ImportError> {
        let path = path.as_ref();
        let file = path.display().to_string();
        let failed = |source| ImportError::Read { file: file.clone(), source };
        if std::fs::metadata(path).map_err(failed)?.is_dir() {
            return Err(ImportError::Folder { file });
        }
        match read_regular(path, PACKING_FILE_LIMIT_BYTES).map_err(failed)? {
            Some(bytes) => parse(&file, &bytes),
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
        Ok(parse(name, content)?.0)
    }
}

/// A packing, and what a user must know of how it was understood.
fn parse(name: &str, content: &[u8]) -> Result<(Packing, Vec<String>), ImportError> {
    let text = std::str::from_utf8(content).map_err(|error| {
        let good = error.valid_up_to();
        let line = 1 + content[..good].iter().filter(|&&b| b == b'\n').count();
        ImportError::Encoding { file: name.into(), line, byte: content[good] }
    })?;
    let text = text.strip_prefix('\u{feff}').unwrap_or(text);
    match text.trim_start().starts_with("ITEM:") {
        true => dump(name, text),
        false => Ok((csv(name, text)?, Vec::new())),
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
