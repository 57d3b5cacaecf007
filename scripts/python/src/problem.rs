//! Problems as Python errors: `ValueError` for refused input, `VoidwalkError` for failed work.

use pyo3::create_exception;
use pyo3::exceptions::{PyException, PyValueError};
use pyo3::prelude::*;
use voidwalk::network::NetworkError;
use voidwalk::run::{Exit, RunError};
use voidwalk::text::is_hidden;

create_exception!(
    voidwalk,
    VoidwalkError,
    PyException,
    "Work that failed, as the command line reports it with exit code 1: a disk that is full, a packing that does not settle."
);

/// Options of the command line that take no value.
const SWITCHES: [&str; 6] = ["as-given", "as-sampled", "pack", "overwrite", "quick", "dispersive"];

/// The text of an error with the names of Python, without characters that control a terminal.
fn plain(text: &str) -> String {
    let text: String = text.chars().map(|c| if c != '\n' && is_hidden(c) { '?' } else { c }).collect();
    in_python(&text)
}

/// Python's names in the place of the command line's: `settings` for `--set`, `as_given=True` for `--as-given`.
fn in_python(text: &str) -> String {
    let text = text.replace("the same command", "the same call").replace("`voidwalk ", "`voidwalk.");
    let (mut message, mut rest) = (String::with_capacity(text.len()), text.as_str());
    while let Some(at) = rest.find("--") {
        let (before, option) = (&rest[..at], &rest[at + 2..]);
        let is_name = |c: char| c.is_ascii_lowercase() || c == '-';
        let name = &option[..option.find(|c| !is_name(c)).unwrap_or(option.len())];
        let begins_word = before.chars().last().is_none_or(|c| c.is_whitespace() || "`(".contains(c));
        message += before;
        match name {
            _ if !begins_word || !name.starts_with(|c: char| c.is_ascii_lowercase()) => {
                message = message + "--" + name;
            }
            "set" => message += "settings",
            _ if SWITCHES.contains(&name) => message = message + &name.replace('-', "_") + "=True",
            _ => message += &name.replace('-', "_"),
        }
        rest = &option[name.len()..];
    }
    message + rest
}

/// Error of input that is refused before any work.
pub fn refused(problem: impl std::fmt::Display) -> PyErr {
    PyValueError::new_err(plain(&problem.to_string()))
}

/// Error of failed work.
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

/// Error of a network: bad input is refused, an impossible computation fails.
pub fn of_network(error: &NetworkError) -> PyErr {
    match error {
        NetworkError::NarrowWayOut { .. } => failed(error),
        _ => refused(error),
    }
}
