//! The command line inside the module: one library, loaded by Python or by a shell.

use std::ffi::OsString;
use std::panic::catch_unwind;

use pyo3::prelude::*;
use voidwalk::cli::{Start, main_with};

/// The exit code of a program of Rust that panicked.
const PANICKED: u8 = 101;

/// Runs the command line, once a process, and returns its exit code. The first of `words` is the program's name, and
/// `again` starts the program from a job script.
#[pyfunction]
pub fn command(py: Python<'_>, words: Vec<OsString>, again: Vec<String>) -> u8 {
    py.detach(|| catch_unwind(|| main_with(Start { words, again: Some(again) })).unwrap_or(PANICKED))
}
