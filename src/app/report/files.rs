//! Readers of the files in a folder of results: JSON, JSON lines and CSV, into the types of
//! [`crate::outcome`], which the writer of the file used too. Every error has the file and line.

use std::path::Path;

use serde::de::DeserializeOwned;

use super::error::ReportError;
use voidwalk_core::store::format::from_json;
use voidwalk_core::store::read_whole;

/// Reads a file of text.
pub(super) fn text(path: &Path) -> Result<String, ReportError> {
    let not_text = |_| std::io::Error::new(std::io::ErrorKind::InvalidData, "is not UTF-8 text");
    let read = read_whole(path).and_then(|bytes| String::from_utf8(bytes).map_err(not_text));
    read.map_err(|source| ReportError::Read { path: path.to_owned(), source })
}

/// Reads a file of JSON.
///
/// # Errors
/// [`ReportError`] names the file, and the line if its form is wrong.
pub fn json<T: DeserializeOwned>(path: &Path) -> Result<T, ReportError> {
    from_json(text(path)?.as_bytes()).map_err(|error| form(path, &error))
}

/// Reads JSON like [`json()`] from a text, which `path` names in errors; it need not begin as a file does.
///
/// # Errors
/// Returns the errors of [`json()`].
pub fn json_of<T: DeserializeOwned>(path: &Path, text: &str) -> Result<T, ReportError> {
    serde_json::from_str(text).map_err(|error| form(path, &error))
}

fn form(path: &Path, error: &serde_json::Error) -> ReportError {
    ReportError::Form { path: path.to_owned(), line: error.line().max(1) as u64, message: error.to_string() }
}

/// Reads the lines of a file of JSON lines, as `ledger.jsonl`.
///
/// # Errors
/// [`ReportError`] names the file and the line.
pub fn lines<T: DeserializeOwned>(path: &Path) -> Result<Vec<T>, ReportError> {
    lines_of(path, &text(path)?)
}

/// Reads [`lines()`] of a file with this text.
pub(super) fn lines_of<T: DeserializeOwned>(path: &Path, text: &str) -> Result<Vec<T>, ReportError> {
    let one = |(index, line): (usize, &str)| {
        serde_json::from_str(line).map_err(|error| ReportError::Form {
            path: path.to_owned(),
            line: index as u64 + 1,
            message: error.to_string(),
        })
    };
    text.lines().enumerate().map(one).collect()
}

/// Reads the rows of a CSV file, each with its line; columns are found by their names in the first line of
/// the file.
///
/// # Errors
/// [`ReportError`] names the file, the line and the column.
pub fn rows<T: DeserializeOwned>(path: &Path) -> Result<Vec<(u64, T)>, ReportError> {
    let content = text(path)?;
    let mut reader = csv::Reader::from_reader(content.as_bytes());
    let form = |line, error: csv::Error| {
        let message = match error.kind() {
            csv::ErrorKind::Deserialize { err, .. } => match err.field() {
                Some(field) => format!("column {}: {}", field + 1, err.kind()),
                None => err.kind().to_string(),
            },
            _ => error.to_string(),
        };
        ReportError::Form { path: path.to_owned(), line, message }
    };
    let headers = reader.headers().map_err(|error| form(1, error))?.clone();
    let mut rows = Vec::new();
    let mut record = csv::StringRecord::new();
    loop {
        let line = reader.position().line();
        match reader.read_record(&mut record) {
            Ok(false) => return Ok(rows),
            Ok(true) => {
                let row = record.deserialize(Some(&headers)).map_err(|error| form(line, error))?;
                rows.push((line, row));
            }
            Err(error) => return Err(form(line, error)),
        }
    }
}
