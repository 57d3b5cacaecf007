//! Start of the program: as itself, or as a library inside another, such as Python.

use std::ffi::OsString;
use std::sync::OnceLock;

/// Start of the program.
#[derive(Clone, Debug)]
pub struct Start {
    /// The words of the command line, the program's name first.
    pub words: Vec<OsString>,
    /// Command that starts the program again in a job script: a path and words after it. If `None`, this
    /// executable.
    pub again: Option<Vec<String>>,
}

/// Start of this process, once it is known.
pub static START: OnceLock<Start> = OnceLock::new();
