//! The command line: the only place that prints.
//!
//! Exit codes: 0 done, 1 failed, 2 refused (before any work, nothing written), 3 stopped but resumable.

mod args;
mod campaign;
mod check;
mod constrictions;
mod pack;
mod percolation;
mod precision;
mod print;
mod progress;
mod run;
mod signals;

use std::process::ExitCode;

use clap::Parser;

use args::{Arguments, Command};

/// Something that ends the program with a message and an exit code.
pub(crate) struct Exit {
    code: u8,
    message: String,
}

impl Exit {
    /// The input is refused: before any work, nothing written.
    pub fn refused(error: impl std::fmt::Display) -> Self {
        Self { code: 2, message: error.to_string() }
    }

    /// Stopped on request; the same command goes on.
    pub fn stopped(message: impl std::fmt::Display) -> Self {
        Self { code: 3, message: message.to_string() }
    }

    /// The work failed.
    pub fn failed(error: impl std::fmt::Display) -> Self {
        Self { code: 1, message: error.to_string() }
    }
}

/// Runs the program with the arguments of this process.
pub fn main() -> ExitCode {
    let result = match Arguments::parse().command {
        Command::Run(args) => run::run(&args),
        Command::Resume(args) => run::resume(&args),
        Command::Check(args) => check::check(&args),
        Command::Init { path } => check::init(path.as_deref()),
        Command::Campaign(args) => campaign::campaign(&args),
        Command::Pack(args) => pack::pack(&args),
        Command::Constrictions(args) => constrictions::constrictions(&args),
        Command::Percolation(args) => percolation::percolation(&args),
        Command::Precision(args) => precision::precision(&args),
        Command::Report { folder } => run::report(&folder),
    };
    match result {
        Ok(()) => ExitCode::SUCCESS,
        Err(ending) => {
            let kind = match ending.code {
                2 => "refused",
                3 => "stopped",
                _ => "error",
            };
            // Messages name files and values that may hold anything.
            let lines: Vec<String> = ending.message.lines().map(print::plain).collect();
            print::to_stderr(&format!("{kind}: {}\n", lines.join("\n")));
            ExitCode::from(ending.code)
        }
    }
}
