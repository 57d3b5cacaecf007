//! Reads two-column tables of size and percent: sieve curves and constriction curves.
//!
//! Accepted: comma, semicolon or tab between the columns; decimal commas if the comma does not separate
//! columns (or the number is quoted); a byte order mark; CRLF; blank lines; `#` comments; one header
//! row; quotes; empty fields at the end of a row, as written by spreadsheets. The first row is the
//! header if no field in it is a number.

use super::error::{NumberError, TableError, shortened};
use crate::store::read_regular;
use std::path::Path;

/// Minimum and maximum size in an input (mm).
const SIZE_MIN_MM: f64 = 1e-12;
const SIZE_MAX_MM: f64 = 1e12;

/// Maximum size of a file (bytes).
pub const FILE_LIMIT_BYTES: u64 = 16 << 20;

/// One row of a table: its line and its two numbers.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Row {
    /// Line of the file, counted from 1.
    pub line: usize,
    /// Size, in the table's unit.
    pub size: f64,
    /// Percent finer or smaller.
    pub percent: f64,
}

impl Row {
    /// Makes a row from the numbers of its size and percent; `text` gives their texts for a refusal.
    ///
    /// # Errors
    /// A text that is not a number, or a number that is not allowed.
    fn checked(
        file: &str,
        line: usize,
        fields: [&'static str; 2],
        text: impl Fn(usize) -> String,
        [size, percent]: [Option<f64>; 2],
    ) -> Result<Row, TableError> {
        let refused = |at: usize, allowed| TableError::refused(file, line, fields[at], text(at), allowed);
        let size = size.filter(|&v| size_is_allowed(v)).ok_or_else(|| refused(0, allowed_size()))?;
        let percent = percent.filter(|&v| percent_is_allowed(v));
        let percent = percent.ok_or_else(|| refused(1, allowed_percent()))?;
        // Minus zero is zero.
        Ok(Row { line, size, percent: percent + 0.0 })
    }

    /// Makes rows from a list instead of a file.
    ///
    /// # Errors
    /// A number that is not allowed; the line is its number in the list.
    pub(crate) fn listed(
        points: impl Iterator<Item = (f64, f64)>,
        fields: [&'static str; 2],
    ) -> Result<Vec<Row>, TableError> {
        let row = |(line, (size, percent)): (usize, (f64, f64))| {
            let text = |at: usize| [size, percent][at].to_string();
            Row::checked("points", line, fields, text, [Some(size), Some(percent)])
        };
        (1..).zip(points).map(row).collect()
    }
}

#[derive(Debug)]
pub(crate) struct Table {
    pub(crate) file: String,
    /// Line and the two fields of the header.
    pub(crate) header: Option<(usize, [String; 2])>,
    rows: Vec<(usize, [String; 2])>,
}

impl Table {
    pub(crate) fn open(path: &Path) -> Result<Table, TableError> {
        Table::parse(&path.display().to_string(), &bytes_of(path)?)
    }

    /// Reads the table in `bytes`, named `file` in messages.
    pub(crate) fn parse(file: &str, bytes: &[u8]) -> Result<Table, TableError> {
        let file = file.to_string();
        if bytes.len() as u64 > FILE_LIMIT_BYTES {
            return Err(TableError::TooLarge { file, limit: FILE_LIMIT_BYTES });
        }
        let text = match std::str::from_utf8(bytes) {
            Ok(text) => text.strip_prefix('\u{feff}').unwrap_or(text),
            Err(error) => {
                let good = error.valid_up_to();
                let line = 1 + bytes[..good].iter().filter(|&&b| b == b'\n').count();
                return Err(TableError::Encoding { file, line, byte: bytes[good] });
            }
        };
        let lines = || {
            text.lines()
                .enumerate()
                .map(|(i, line)| (i + 1, line))
                .filter(|(_, line)| !line.trim().is_empty() && !line.trim_start().starts_with('#'))
        };
        let delimiter = delimiter(lines().map(|(_, line)| line));
        let mut table = Table { file, header: None, rows: Vec::new() };
        let mut first = true;
        for (line, content) in lines() {
            let fields = split(content, delimiter);
            if fields.is_empty() {
                continue;
            }
            let heading = std::mem::take(&mut first) && fields.iter().all(|f| number(f).is_none());
            let count = fields.len();
            let Ok(fields) = <[String; 2]>::try_from(fields) else {
                let allowed = if count > 2 && delimiter == ',' {
                    "two columns (with decimal commas, a semicolon or a tab between them)"
                } else {
                    "two columns, with a comma, a semicolon or a tab between them"
                };
                let (file, value) = (table.file, shortened(content.trim()));
                return Err(TableError::Fields { file, line, found: count, value, allowed });
            };
            if heading && fields.iter().all(|f| !f.is_empty()) {
                table.header = Some((line, fields));
            } else {
                table.rows.push((line, fields));
            }
        }
        if table.rows.is_empty() {
            return Err(TableError::NoRows { header: table.header.is_some(), file: table.file });
        }
        table.check_decimal_signs(delimiter)?;
        Ok(table)
    }

    /// Refuses ambiguous commas: a file with both `.` and `,` inside numbers has thousands separators or
    /// a mistake; one with commas between its columns may have them in `"1,180"`.
    fn check_decimal_signs(&self, delimiter: char) -> Result<(), TableError> {
        let first = |is_such: &dyn Fn(&str) -> bool| {
            self.rows.iter().find_map(|(line, fields)| {
                let field = fields.iter().find(|field| number(field).is_some() && is_such(field));
                field.map(|field| (*line, field))
            })
        };
        let first_comma = |wanted: Comma| first(&|field| comma(field) == Some(wanted));
        if delimiter == ','
            && first_comma(Comma::Decimal).is_none()
            && let Some((line, value)) = first_comma(Comma::Either)
        {
            let (as_decimal, as_thousands) = (value.replace(',', "."), value.replace(',', ""));
            let allowed = format!(
                "{as_decimal} or {as_thousands}: here the comma may be a decimal sign or separate thousands"
            );
            return Err(TableError::refused(&self.file, line, "number", shortened(value), allowed));
        }
        let with = |sign: char| first(&|field| field.contains(sign));
        match (with('.'), with(',')) {
            (Some((dot_line, _)), Some((line, value))) => {
                let allowed = format!(
                    "one decimal sign in the whole file (line {dot_line} has a decimal point), no \
                     thousands separators"
                );
                Err(TableError::refused(&self.file, line, "number", shortened(value), allowed))
            }
            _ => Ok(()),
        }
    }

    pub(crate) fn first_line(&self) -> usize {
        self.rows.first().map_or(1, |(line, _)| *line)
    }

    /// Reads the rows as numbers, with the size in column `size_column` and the percent in the other.
    pub(crate) fn rows(&self, size_column: usize, names: [&'static str; 2]) -> Result<Vec<Row>, TableError> {
        let row = |(line, fields): &(usize, [String; 2])| {
            let cells = [size_column, 1 - size_column].map(|column| &fields[column]);
            let numbers = cells.map(|cell| number(cell));
            Row::checked(&self.file, *line, names, |at| shortened(cells[at]), numbers)
        };
        self.rows.iter().map(row).collect()
    }
}

/// Reads the bytes of a file, up to the maximum size of a table.
pub fn bytes_of(path: &Path) -> Result<Vec<u8>, TableError> {
    let file = path.display().to_string();
    let read = |source| TableError::Read { file: file.clone(), source };
    if std::fs::metadata(path).map_err(read)?.is_dir() {
        return Err(TableError::Folder { file });
    }
    match read_regular(path, FILE_LIMIT_BYTES).map_err(read)? {
        Some(bytes) => Ok(bytes),
        None if std::fs::metadata(path).is_ok_and(|meta| !meta.is_file()) => {
            Err(read(std::io::Error::other("is not a regular file")))
        }
        None => Err(TableError::TooLarge { file, limit: FILE_LIMIT_BYTES }),
    }
}

pub(crate) fn check_size(name: &'static str, value: f64) -> Result<(), NumberError> {
    NumberError::unless(size_is_allowed(value), name, value, allowed_size)
}

pub(super) fn check_percent(name: &'static str, value: f64) -> Result<(), NumberError> {
    NumberError::unless(percent_is_allowed(value), name, value, allowed_percent)
}

/// Tells if a size is allowed.
pub fn size_is_allowed(size: f64) -> bool {
    (SIZE_MIN_MM..=SIZE_MAX_MM).contains(&size)
}

/// Tells if a percentage is allowed.
pub fn percent_is_allowed(percent: f64) -> bool {
    (0.0..=100.0).contains(&percent)
}

/// Allowed sizes, in words.
pub fn allowed_size() -> String {
    format!("a number from {SIZE_MIN_MM:e} to {SIZE_MAX_MM:e}")
}

/// Allowed percentages, in words.
pub fn allowed_percent() -> String {
    "a number from 0 to 100".into()
}

/// Rule for the sizes of a table from one row to the next.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Direction {
    /// No equal sizes.
    Strict,
    /// Allows equal sizes: a vertical step of the curve.
    Steps,
}

/// Returns `rows` with rising sizes, after checking that sizes only rise or only fall, that percent
/// never falls as size rises, and that the coarsest size has 100 %.
pub(crate) fn rising(
    file: &str,
    mut rows: Vec<Row>,
    fields: [&'static str; 2],
    direction: Direction,
) -> Result<Vec<Row>, TableError> {
    let refused =
        |line, field, value: f64, allowed: String| TableError::refused(file, line, field, value, allowed);
    let [size_field, percent_field] = fields;
    let descending = match &rows[..] {
        [first, .., last] if first.size != last.size => first.size > last.size,
        [first, .., last] => first.percent > last.percent,
        _ => false,
    };
    for w in rows.windows(2) {
        let (last, next) = (w[0], w[1]);
        if last.size == next.size && direction == Direction::Strict {
            let allowed = format!("every size once (it is also in line {})", last.line);
            return Err(refused(next.line, size_field, next.size, allowed));
        }
        if (descending && last.size < next.size) || (!descending && last.size > next.size) {
            let (side, order) = if descending { ("less", "descending") } else { ("more", "ascending") };
            let allowed = format!("{side} than the {} of line {} (sizes all {order})", last.size, last.line);
            return Err(refused(next.line, size_field, next.size, allowed));
        }
        if (descending && last.percent < next.percent) || (!descending && last.percent > next.percent) {
            let bound = if descending { "at most" } else { "at least" };
            let allowed = format!(
                "{bound} the {} of line {} (percent cannot fall as size rises)",
                last.percent, last.line
            );
            return Err(refused(next.line, percent_field, next.percent, allowed));
        }
    }
    if descending {
        rows.reverse();
    }
    match rows.last() {
        Some(top) if top.percent != 100.0 => {
            Err(refused(top.line, percent_field, top.percent, "100 at the coarsest size".into()))
        }
        Some(_) => Ok(rows),
        None => Err(TableError::NoRows { file: file.to_string(), header: false }),
    }
}

/// Finds the separator of the columns: the first of semicolon, tab and comma in the first line with one.
fn delimiter<'a>(lines: impl Iterator<Item = &'a str>) -> char {
    lines.filter_map(|line| [';', '\t', ','].into_iter().find(|&c| line.contains(c))).next().unwrap_or(',')
}

/// Splits a line into fields, trimmed and without quotes; empty ones at the end are left out.
fn split(line: &str, delimiter: char) -> Vec<String> {
    let mut fields = vec![String::new()];
    let mut quoted = false;
    for c in line.chars() {
        match c {
            '"' => quoted = !quoted,
            c if c == delimiter && !quoted => fields.push(String::new()),
            c => {
                if let Some(field) = fields.last_mut() {
                    field.push(c);
                }
            }
        }
    }
    fields.iter_mut().for_each(|field| *field = field.trim().to_string());
    while fields.last().is_some_and(String::is_empty) {
        fields.pop();
    }
    fields
}

/// Reads a field as a number: all that Rust reads (so also `nan`, `inf` and `1e400`, which the caller
/// refuses), with a decimal comma allowed in place of the point.
pub fn number(field: &str) -> Option<f64> {
    // An exponent has a sign, as in spreadsheets: any other letter e is a typing error.
    if field.split_once(['e', 'E']).is_some_and(|(_, power)| !power.starts_with(['+', '-'])) {
        return None;
    }
    match (field.matches(',').count(), field.contains('.')) {
        (0, _) => field.parse().ok(),
        (1, false) => field.replace(',', ".").parse().ok(),
        _ => None,
    }
}

/// Meaning of the comma in a number.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Comma {
    /// A decimal sign.
    Decimal,
    /// A decimal sign, or one between thousands, as in `1,180`.
    Either,
}

/// Tells the meaning of the only comma in a number, such as `1,180 um`.
pub fn comma(text: &str) -> Option<Comma> {
    let at = text.find(',')?;
    let before = text[..at].bytes().rev().take_while(u8::is_ascii_digit).count();
    let after = text[at + 1..].bytes().take_while(u8::is_ascii_digit).count();
    let first = text.as_bytes()[at - before];
    let ends = text[at + 1 + after..].starts_with([',', '.']);
    match (before, after) {
        _ if ends || text[at + 1..].contains(',') => None,
        (0, _) | (_, 0) => None,
        (1..=3, 3) if first != b'0' => Some(Comma::Either),
        _ => Some(Comma::Decimal),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn three_digits_behind_a_comma_may_be_thousands() {
        for text in ["1,180", "100,000", "1,180 um", "1,000%"] {
            assert_eq!(comma(text), Some(Comma::Either), "{text}");
        }
        for text in ["0,180", "1,18", "1180,000", "97,5 %", "4,75 mm"] {
            assert_eq!(comma(text), Some(Comma::Decimal), "{text}");
        }
        for text in ["1180", "1,", ",5", "No. 4, fine", "1,000,000", "Dam, north"] {
            assert_eq!(comma(text), None, "{text}");
        }
    }
}
