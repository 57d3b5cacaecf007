//! How the program was started: as itself, or as a library inside another, such as Python.

use std::ffi::OsString;
use std::sync::OnceLock;

/// How the program was started.
#[derive(Clone, Debug)]
pub struct Start {
    /// The words of the command line, the program's name first.
    pub words: Vec<OsString>,
    /// What starts the program again, in a job script: a path and words after it. If `None`, this executable.
    pub again: Option<Vec<String>>,
}

/// How this process was started, once it was.
pub static START: OnceLock<Start> = OnceLock::new();
