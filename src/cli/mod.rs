//! The command line: it parses, calls the library and prints, and is the only place that does.
//!
//! Exit codes: 0 done, 1 failed, 2 refused (before any work, nothing written), 3 stopped but resumable.

mod args;
mod campaign;
mod case_progress;
mod check;
mod compare;
mod constrictions;
mod design;
mod init;
mod judge;
mod pack;
mod percolation;
mod precision;
mod print;
mod progress;
mod report;
mod rules;
mod run;
#[cfg(feature = "serve")]
mod serve;
mod soil;

use std::process::ExitCode;

use clap::Parser;

use crate::run::Exit;
use args::{Arguments, Command};

/// Runs the program with the arguments of this process.
pub fn main() -> ExitCode {
    crate::store::platform::signals::outlive_large_files();
    let done = match Arguments::parse().command {
        Command::Run(args) => run::run(&args),
        Command::Judge(args) => judge::judge(&args),
        Command::Compare(args) => compare::compare(&args),
        #[cfg(feature = "serve")]
        Command::Serve(args) => serve::serve(&args),
        Command::Resume(args) => run::resume(&args),
        Command::Soil(args) => soil::soil(&args),
        Command::Check(args) => check::check(&args),
        Command::Init { path } => init::init(path.as_deref()),
        Command::Design(args) => design::design(&args),
        Command::Campaign(args) => campaign::campaign(&args),
        Command::Pack(args) => pack::pack(&args),
        Command::Constrictions(args) => constrictions::constrictions(&args),
        Command::Rules(args) => rules::rules(&args),
        Command::Percolation(args) => percolation::percolation(&args),
        Command::Precision(args) => precision::precision(&args),
        Command::Report { folder } => report::report(&folder),
    };
    let Err(error) = done else { return ExitCode::SUCCESS };
    let exit = error.exit();
    let kind = match exit {
        Exit::Refused => "refused",
        Exit::Stopped => "stopped",
        Exit::Failed => "error",
    };
    // Messages name files and values that may hold anything.
    let text = error.advice().map_or_else(|| error.to_string(), |advice| format!("{error}\n{advice}"));
    let lines: Vec<String> = text.lines().map(print::plain).collect();
    print::to_stderr(&format!("{kind}: {}\n", lines.join("\n")));
    ExitCode::from(exit.code())
}
