//! Readers of the files in a folder of results: JSON, JSON lines and CSV, into the types of
//! [`crate::outcome`] with which they were written. Errors give file and line.

use std::path::{Path, PathBuf};

use serde::de::DeserializeOwned;
use thiserror::Error;

use voidwalk_core::store::format::from_json;
use voidwalk_core::store::{StoreError, read_whole};

pub(super) fn text(path: &Path) -> Result<String, ReportError> {
    let not_text = |_| std::io::Error::new(std::io::ErrorKind::InvalidData, "is not UTF-8 text");
    let read = read_whole(path).and_then(|bytes| String::from_utf8(bytes).map_err(not_text));
    read.map_err(|source| ReportError::Read { path: path.to_owned(), source })
}

pub(crate) fn json<T: DeserializeOwned>(path: &Path) -> Result<T, ReportError> {
    from_json(text(path)?.as_bytes()).map_err(|error| form(path, &error))
}

/// Reads JSON like `json()`, but from a text without the file's beginning; `path` names it in errors.
pub fn json_of<T: DeserializeOwned>(path: &Path, text: &str) -> Result<T, ReportError> {
    serde_json::from_slice(text.as_bytes()).map_err(|error| form(path, &error))
}

fn form(path: &Path, error: &serde_json::Error) -> ReportError {
    malformed(path, error.line().max(1) as u64, error.to_string())
}

pub(super) fn malformed(path: &Path, line: u64, message: String) -> ReportError {
    ReportError::Form { path: path.to_owned(), line, message }
}

/// Reads JSON lines, such as those of `ledger.jsonl`; `path` names them in errors.
pub(super) fn lines<T: DeserializeOwned>(path: &Path, text: &str) -> Result<Vec<T>, ReportError> {
    let one = |(index, line): (usize, &str)| {
        serde_json::from_slice(line.as_bytes())
            .map_err(|error| malformed(path, index as u64 + 1, error.to_string()))
    };
    text.lines().enumerate().map(one).collect()
}

/// Reads the rows of a CSV file, each with its line number. Columns are found by their names in the first
/// line of the file. Errors name the column, too.
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
        malformed(path, line, message)
    };
    reader.headers().map_err(|error| form(1, error))?;
    let (mut records, mut rows) = (reader.deserialize(), Vec::new());
    loop {
        let line = records.reader().position().line();
        match records.next() {
            Some(row) => rows.push((line, row.map_err(|error| form(line, error))?)),
            None => return Ok(rows),
        }
    }
}

pub(super) fn refused(path: &Path, field: &str, value: String, allowed: &str) -> ReportError {
    let (field, allowed) = (field.to_owned(), allowed.to_owned());
    ReportError::Value { path: path.to_owned(), field, value, allowed }
}

/// Reason why a report could not be written.
#[derive(Debug, Error)]
pub enum ReportError {
    /// A file of the run folder is missing or cannot be read.
    #[error(
        "{path}: cannot be read: {source} (a finished run folder holds outcome.json, manifest.json, \
         scene.toml, series.csv, layers.csv, retained.csv and eroded.csv)",
        path = path.display()
    )]
    Read {
        /// The file.
        path: PathBuf,
        /// Message of the system.
        source: std::io::Error,
    },
    /// A file does not have the form that it must have.
    #[error("{path}:{line}: {message}", path = path.display())]
    Form {
        /// The file.
        path: PathBuf,
        /// Line, from 1.
        line: u64,
        /// The fault, with the field if known.
        message: String,
    },
    /// A value that is impossible, or two files that contradict each other.
    #[error("{path}: {field} is {value}, allowed: {allowed}", path = path.display())]
    Value {
        /// The file.
        path: PathBuf,
        /// The field.
        field: String,
        /// Its value.
        value: String,
        /// Allowed values.
        allowed: String,
    },
    /// The page or a figure cannot be written.
    #[error(transparent)]
    Write(#[from] StoreError),
}
