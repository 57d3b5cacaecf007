//! Reasons why a page could not be written.

use std::path::PathBuf;

use thiserror::Error;

use voidwalk_core::store::StoreError;

/// The reason why a report could not be written.
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
        /// The values that would be right.
        allowed: String,
    },
    /// The page or a figure cannot be written.
    #[error(transparent)]
    Write(#[from] StoreError),
}
