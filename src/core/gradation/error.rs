//! What can be wrong with a gradation or with a table of two columns.

use std::fmt;

use crate::store::in_mb;
use crate::text::{is_hidden, quoted};

/// Where in an input something stands.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Position {
    /// File as the user named it, or what the points were called.
    pub file: String,
    /// Line, counted from 1 (point, counted from 1, where there is no file).
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

/// The name of a column of a sheet: A, B, ... Z, AA.
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

/// A table of two columns that cannot be used.
#[derive(Debug, thiserror::Error)]
pub enum TableError {
    /// The file cannot be opened or read.
    #[error("{file}: cannot be read: {source}")]
    Read {
        /// File as the user named it.
        file: String,
        /// What the system said.
        source: std::io::Error,
    },
    /// A folder where a file is wanted.
    #[error("{file} is a folder; allowed: a CSV file of two columns")]
    Folder {
        /// Folder as the user named it.
        file: String,
    },
    /// A folder without a table.
    #[error("{folder} has no table in it; allowed: files of .{endings}")]
    NoTables {
        /// Folder as the user named it.
        folder: String,
        /// Endings of the files that are looked for.
        endings: String,
    },
    /// More bytes than any such table has.
    #[error("{file} is larger than {}; allowed: a CSV file of two columns up to that size", in_mb(*.limit))]
    TooLarge {
        /// File as the user named it.
        file: String,
        /// Largest file that is read.
        limit: u64,
    },
    /// Bytes that are no UTF-8 text.
    #[error("{file}, line {line}: byte 0x{byte:02X} is not UTF-8 text; allowed: a CSV file saved as UTF-8")]
    Encoding {
        /// File as the user named it.
        file: String,
        /// Line, counted from 1.
        line: usize,
        /// The first byte that does not belong.
        byte: u8,
    },
    /// A file of another kind.
    #[error("{file} is {is}; allowed: a table as CSV, .xlsx, .ods or AGS4")]
    Format {
        /// File as the user named it.
        file: String,
        /// What it is.
        is: String,
    },
    /// A workbook that is refused as a whole.
    #[error("{file}: this workbook cannot be read: {why}; allowed: .xlsx or .ods, small and without macros")]
    Workbook {
        /// File as the user named it.
        file: String,
        /// What is wrong.
        why: String,
    },
    /// Several soils, and none of them named.
    #[error("{file} holds several soils: {soils}; name one of them, as in {}",
            quoted(&format!("{file}#{first}")))]
    SeveralSoils {
        /// File as the user named it.
        file: String,
        /// Their names.
        soils: String,
        /// The first of them.
        first: String,
    },
    /// No soil of the name that is asked for.
    #[error("{file} holds no soil called \"{name}\"; it holds {soils}")]
    NoSuchSoil {
        /// File as the user named it.
        file: String,
        /// The name asked for.
        name: String,
        /// The names there are.
        soils: String,
    },
    /// No row of numbers.
    #[error("{file} has no row of numbers{}; allowed: at least one row of two numbers",
            if *.header { " below its header" } else { "" })]
    NoRows {
        /// File as the user named it.
        file: String,
        /// There is a header.
        header: bool,
    },
    /// A row that has not two fields.
    #[error("{file}, line {line}: {found} field(s) in \"{value}\"; allowed: {allowed}")]
    Fields {
        /// File as the user named it.
        file: String,
        /// Line, counted from 1.
        line: usize,
        /// Number of fields found.
        found: usize,
        /// The row, shortened.
        value: String,
        /// What is allowed there.
        allowed: &'static str,
    },
    /// A header that names the wrong columns.
    #[error("{file}, line {line}, header: \"{value}\" is not allowed; allowed: {allowed}")]
    Header {
        /// File as the user named it.
        file: String,
        /// Line, counted from 1.
        line: usize,
        /// The header, shortened.
        value: String,
        /// What is allowed there.
        allowed: String,
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
}

impl TableError {
    /// The same for a table whose rows were counted from 1: `place` gives the line and the column of a row's
    /// opening or percent, `said` what the row is called.
    pub fn placed(
        self,
        place: impl Fn(usize, bool) -> (usize, Option<u32>),
        said: impl Fn(usize) -> String,
    ) -> TableError {
        let TableError::Value { mut at, value, allowed } = self else { return self };
        (at.line, at.column) = place(at.line, at.field.starts_with("percent"));
        let mut parts = allowed.split("line ");
        let mut renamed = parts.next().unwrap_or_default().to_owned();
        for part in parts {
            let digits = part.find(|c: char| !c.is_ascii_digit()).unwrap_or(part.len());
            match part[..digits].parse() {
                Ok(row) => renamed.push_str(&format!("{}{}", said(row), &part[digits..])),
                Err(_) => renamed.push_str(&format!("line {part}")),
            }
        }
        TableError::Value { at, value, allowed: renamed }
    }
}

/// A gradation, or a number of base particles, that cannot be.
#[derive(Debug, thiserror::Error)]
pub enum GradationError {
    /// The table of a sieve curve.
    #[error(transparent)]
    Table(#[from] TableError),
    /// A number that is not in a table.
    #[error(transparent)]
    Number(#[from] NumberError),
}

/// A number that is not allowed.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[error("{name} = {value:?} is not allowed; allowed: {allowed}")]
pub struct NumberError {
    /// What the number is.
    pub name: &'static str,
    /// The number.
    pub value: f64,
    /// What is allowed.
    pub allowed: String,
}

impl NumberError {
    pub(crate) fn new(name: &'static str, value: f64, allowed: impl Into<String>) -> NumberError {
        NumberError { name, value, allowed: allowed.into() }
    }

    /// Refuses a `value` that is not positive and finite.
    pub(crate) fn unless_positive(name: &'static str, value: f64) -> Result<(), NumberError> {
        match value > 0.0 && value.is_finite() {
            true => Ok(()),
            false => Err(NumberError::new(name, value, "a positive finite number")),
        }
    }
}

/// `text` short enough, and free of hidden characters, for a message on one line.
pub fn shortened(text: &str) -> String {
    const LONGEST: usize = 60;
    let mut out: String = text.chars().take(LONGEST).flat_map(shown).collect();
    if text.chars().nth(LONGEST).is_some() {
        out.push_str("...");
    }
    out
}

/// A hidden character as its escape, anything else as it is.
fn shown(c: char) -> Box<dyn Iterator<Item = char>> {
    if is_hidden(c) { Box::new(c.escape_default()) } else { Box::new(std::iter::once(c)) }
}
