//! Errors of a gradation or a two-column table.

use std::fmt;

use crate::store::in_mb;
use crate::text::{is_hidden, quoted};

/// Place in an input.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Position {
    /// File as the user named it, or the name of a list of points.
    pub file: String,
    /// Line (or point, if there is no file), counted from 1.
    pub line: usize,
    /// Name of the column.
    pub field: &'static str,
    /// Column of a sheet, counted from 0.
    pub column: Option<u32>,
}

impl fmt::Display for Position {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self.column {
            Some(column) => write!(f, "{}, cell {}{}, {}", self.file, letters(column), self.line, self.field),
            None => write!(f, "{}, line {}, {}", self.file, self.line, self.field),
        }
    }
}

/// Returns the name of a sheet's column: A, B, ... Z, AA.
pub fn letters(column: u32) -> String {
    let mut name = String::new();
    let mut rest = column + 1;
    while rest > 0 {
        rest -= 1;
        name.insert(0, char::from(b'A' + (rest % 26) as u8));
        rest /= 26;
    }
    name
}

/// A two-column table that cannot be used.
///
/// `file` and `folder` are as the user named them, `line` counts from 1, `value` is shortened, `is` describes
/// the kind of the file, and `header` tells if there is one.
#[allow(missing_docs)]
#[derive(Debug, thiserror::Error)]
pub enum TableError {
    /// The file cannot be opened or read.
    #[error("{file}: cannot be read: {source}")]
    Read { file: String, source: std::io::Error },
    /// A folder in place of a file.
    #[error("{file} is a folder; allowed: a CSV file of two columns")]
    Folder { file: String },
    /// A folder without a table.
    #[error("{folder} has no table in it; allowed: files of .{endings}")]
    NoTables { folder: String, endings: String },
    /// A file that is larger than the limit.
    #[error("{file} is larger than {}; allowed: a CSV file of two columns up to that size", in_mb(*.limit))]
    TooLarge { file: String, limit: u64 },
    /// Bytes that are not UTF-8 text.
    #[error("{file}, line {line}: byte 0x{byte:02X} is not UTF-8 text; allowed: a CSV file saved as UTF-8")]
    Encoding { file: String, line: usize, byte: u8 },
    /// A file of another kind.
    #[error("{file} is {is}; allowed: a table as CSV, .xlsx, .ods or AGS4")]
    Format { file: String, is: String },
    /// A refused workbook.
    #[error("{file}: this workbook cannot be read: {why}; allowed: .xlsx or .ods, small and without macros")]
    Workbook { file: String, why: String },
    /// Several soils, and no name to choose one.
    #[error("{file} holds several soils: {soils}; name one of them, as in {}",
            quoted(&format!("{file}#{first}")))]
    SeveralSoils { file: String, soils: String, first: String },
    /// A soil name that is not in the file.
    #[error("{file} holds no soil called \"{name}\"; it holds {soils}")]
    NoSuchSoil { file: String, name: String, soils: String },
    /// A table without a row of numbers.
    #[error("{file} has no row of numbers{}; allowed: at least one row of two numbers",
            if *.header { " below its header" } else { "" })]
    NoRows { file: String, header: bool },
    /// A row without exactly two fields.
    #[error("{file}, line {line}: {found} field(s) in \"{value}\"; allowed: {allowed}")]
    Fields { file: String, line: usize, found: usize, value: String, allowed: &'static str },
    /// A header that names the wrong columns.
    #[error("{file}, line {line}, header: \"{value}\" is not allowed; allowed: {allowed}")]
    Header { file: String, line: usize, value: String, allowed: String },
    /// A value that is not allowed at its place.
    #[error("{at}: \"{value}\" is not allowed; allowed: {allowed}")]
    Value { at: Position, value: String, allowed: String },
}

impl TableError {
    /// Makes the error for a value in a column and a line of a file.
    pub(super) fn refused(
        file: &str,
        line: usize,
        field: &'static str,
        value: impl ToString,
        allowed: impl Into<String>,
    ) -> TableError {
        let at = Position { file: file.into(), line, field, column: None };
        TableError::Value { at, value: value.to_string(), allowed: allowed.into() }
    }

    /// Moves the error to the rows of the original table: `place` gives the line and column of a row's
    /// opening or percent, `row_name` the name of the row; rows count from 1.
    pub fn placed(
        self,
        place: impl Fn(usize, bool) -> (usize, Option<u32>),
        row_name: impl Fn(usize) -> String,
    ) -> TableError {
        let TableError::Value { mut at, value, allowed } = self else { return self };
        (at.line, at.column) = place(at.line, at.field.starts_with("percent"));
        let mut parts = allowed.split("line ");
        let mut renamed = parts.next().unwrap_or_default().to_owned();
        for part in parts {
            let digits = part.find(|c: char| !c.is_ascii_digit()).unwrap_or(part.len());
            match part[..digits].parse() {
                Ok(row) => renamed.push_str(&format!("{}{}", row_name(row), &part[digits..])),
                Err(_) => renamed.push_str(&format!("line {part}")),
            }
        }
        TableError::Value { at, value, allowed: renamed }
    }
}

/// An invalid gradation or number of base particles.
#[derive(Debug, thiserror::Error)]
pub enum GradationError {
    /// The table of a sieve curve.
    #[error(transparent)]
    Table(#[from] TableError),
    /// A number that is not from a table.
    #[error(transparent)]
    Number(#[from] NumberError),
}

/// A number with a value that is not allowed.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[error("{name} = {value:?} is not allowed; allowed: {allowed}")]
pub struct NumberError {
    pub(crate) name: &'static str,
    pub(crate) value: f64,
    pub(crate) allowed: String,
}

impl NumberError {
    pub(crate) fn new(name: &'static str, value: f64, allowed: impl Into<String>) -> NumberError {
        NumberError { name, value, allowed: allowed.into() }
    }

    pub(crate) fn unless(
        is_right: bool,
        name: &'static str,
        value: f64,
        allowed: impl FnOnce() -> String,
    ) -> Result<(), NumberError> {
        if is_right { Ok(()) } else { Err(NumberError::new(name, value, allowed())) }
    }

    pub(crate) fn unless_positive(name: &'static str, value: f64) -> Result<(), NumberError> {
        let is_right = value > 0.0 && value.is_finite();
        NumberError::unless(is_right, name, value, || "a positive finite number".into())
    }
}

/// Shortens `text` and escapes its hidden characters, for a message on one line.
pub fn shortened(text: &str) -> String {
    const LONGEST: usize = 60;
    let mut out = String::new();
    for c in text.chars().take(LONGEST) {
        if is_hidden(c) { out.extend(c.escape_default()) } else { out.push(c) }
    }
    if text.chars().nth(LONGEST).is_some() {
        out.push_str("...");
    }
    out
}
