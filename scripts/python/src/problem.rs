//! What went wrong, as Python says it: `ValueError` for what is refused, `VoidwalkError` for what fails.

use pyo3::create_exception;
use pyo3::exceptions::{PyException, PyValueError};
use pyo3::prelude::*;
use voidwalk::constrictions::ConstrictionsError;
use voidwalk::network::NetworkError;
use voidwalk::run::{Exit, RunError};
use voidwalk::text::is_hidden;

create_exception!(
    voidwalk,
    VoidwalkError,
    PyException,
    "Work that failed, as the command line reports it with exit code 1: a disk that is full, a packing that does not settle."
);

/// The text of an error, without characters that control a terminal.
fn plain(text: &str) -> String {
    text.chars().map(|c| if c != '\n' && is_hidden(c) { '?' } else { c }).collect()
}

/// What is refused before any work.
pub fn refused(problem: impl std::fmt::Display) -> PyErr {
    PyValueError::new_err(plain(&problem.to_string()))
}

/// What failed.
pub fn failed(problem: impl std::fmt::Display) -> PyErr {
    VoidwalkError::new_err(plain(&problem.to_string()))
}

/// The error of a command, in its own words.
pub fn of_run(error: &RunError) -> PyErr {
    let text = error.advice().map_or_else(|| error.to_string(), |advice| format!("{error}\n{advice}"));
    match error.exit() {
        Exit::Refused => refused(text),
        Exit::Stopped | Exit::Failed | Exit::NotAccepted => failed(text),
    }
}

/// What is wrong with a network: what is given is refused, what cannot be computed fails.
pub fn of_network(error: &NetworkError) -> PyErr {
    match error {
        NetworkError::NarrowWayOut { .. } => failed(error),
        _ => refused(error),
    }
}

/// What is wrong with a packing whose constrictions are wanted.
pub fn of_constrictions(error: &ConstrictionsError) -> RunError {
    RunError::refused(error)
}
