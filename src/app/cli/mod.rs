//! Command line: it parses arguments, calls the library and prints, which nothing else does. `EXIT_CODES`
//! (`exit.rs`) lists all its exit codes.

mod args;
mod campaign;
mod check;
mod exit;
mod help;
mod init;
mod mistakes;
mod options;
mod pack;
mod print;
mod progress;
mod report;
mod rules;
mod run;
mod shell;
mod soil;
mod study;

use crate::run::{Exit, RunError};
use args::{Arguments, Command};
use clap::FromArgMatches;
use std::ffi::OsString;
use std::process::ExitCode;

pub use init::schema;
pub use progress::page;
use run::START;
pub use run::Start;

/// System's error number for a missing file, the same on Unix and Windows.
const NO_FILE: i32 = 2;

/// Reads the arguments; otherwise prints the mistake and a command to type instead, or the text requested by
/// `--help`.
fn arguments(words: &[OsString]) -> Result<Arguments, u8> {
    if words.len() < 2 {
        print::to_stderr(help::FIRST_WORDS);
        return Err(Exit::Refused.code());
    }
    let command = help::command();
    let read = command.clone().try_get_matches_from(words);
    read.and_then(|matches| Arguments::from_arg_matches(&matches)).map_err(|error| {
        let error = mistakes::explained(error, &command, words);
        if error.use_stderr() {
            let _ = error.print();
        } else {
            print::by_stdout(|| error.print());
        }
        u8::try_from(error.exit_code()).unwrap_or(Exit::Refused.code())
    })
}

/// Runs the program with the arguments of this process.
pub fn main() -> ExitCode {
    ExitCode::from(main_with(Start { words: std::env::args_os().collect(), again: None }))
}

/// Runs the program, once per process, and returns its exit code; for programs that use the command line as a
/// library.
pub fn main_with(start: Start) -> u8 {
    voidwalk_core::store::platform::process::outlive_large_files();
    voidwalk_core::store::platform::process::keep_memory();
    let words = &START.get_or_init(|| start).words;
    let code = match arguments(words) {
        Ok(arguments) => told(command(arguments), words),
        Err(code) => code,
    };
    match print::whole_stdout() {
        Err(lost) if [0, Exit::NotAccepted.code()].contains(&code) => told(Err(lost), words),
        _ => code,
    }
}

fn command(arguments: Arguments) -> Result<(), RunError> {
    match arguments.command {
        Command::Run(args) => run::run(&args),
        Command::Judge(args) => run::judge(&args),
        #[cfg(feature = "serve")]
        Command::Serve(args) => report::serve(&args),
        Command::Resume(args) => run::resume(&args),
        Command::Soil(args) => soil::soil(&args),
        Command::Check(args) => check::check(&args),
        Command::Init { path, plan, json, schema } => init::init(path.as_deref(), plan, json, schema),
        Command::Examples { folder } => init::examples(&folder),
        Command::Design(args) => study::design(&args),
        Command::Boundary(args) => study::boundary(&args),
        Command::Campaign(args) => campaign::campaign(&args),
        Command::Pack(args) => pack::pack(&args),
        Command::Constrictions(args) => pack::constrictions(&args),
        Command::Rules(args) => rules::rules(&args),
        Command::Percolation(args) => study::percolation(&args),
        Command::Report { folder } => report::report(&folder),
        Command::Export { folder } => report::export(&folder),
        Command::Completions { shell } => {
            shell::completions(shell);
            Ok(())
        }
        Command::Man { folder } => shell::man(&folder),
    }
}

fn told(done: Result<(), RunError>, words: &[OsString]) -> u8 {
    let Err(error) = done else { return 0 };
    let exit = error.exit();
    let kind = match exit {
        Exit::Refused => "refused",
        Exit::Stopped => "stopped",
        Exit::Failed => "error",
        Exit::NotAccepted => "not accepted",
    };
    // Messages name files and values, which may contain any characters.
    let mut text = error.to_string();
    let meant = match exit {
        Exit::Refused => {
            let no_file = std::io::Error::from_raw_os_error(NO_FILE).to_string();
            mistakes::instead_of_files(words, text.contains(&no_file))
        }
        _ => None,
    };
    for more in error.advice().map(String::from).into_iter().chain(meant) {
        text = format!("{text}\n{more}");
    }
    let lines: Vec<String> = text.lines().map(print::plain).collect();
    print::to_stderr(&format!("{kind}: {}\n", lines.join("\n")));
    exit.code()
}
