//! `voidwalk reproduce`: a finished run walked again, and every number compared.

use std::fmt::Write;

use super::args::ReproduceArgs;
use super::print::{count, json, plain, to_stdout};
use super::progress::followed;
use super::run::command_line;
use crate::run::{self, PrepareOptions, Reproduced, RunError, RunOptions};
use crate::store::format;

/// Walks the run of a folder again.
pub fn reproduce(args: &ReproduceArgs) -> Result<(), RunError> {
    let options = RunOptions {
        prepare: PrepareOptions { memory: args.memory, threads: args.threads, ..PrepareOptions::default() },
        command: command_line(),
        ..RunOptions::default()
    };
    let found = followed(args.quiet, |callbacks| run::reproduce(&args.folder, &options, callbacks))?;
    if args.json {
        to_stdout(&json(format::REPRODUCED, &found)?);
    } else if !args.quiet {
        to_stdout(&words(&found));
    }
    match found.same {
        true => Ok(()),
        false => Err(RunError::failed(format!(
            "not the same: {} of {} values differ",
            count(found.different),
            count(found.values)
        ))),
    }
}

fn words(found: &Reproduced) -> String {
    let mut text = String::new();
    // Writing to a string cannot fail.
    let mut line = |said: String| {
        let _ = writeln!(text, "{}", plain(&said));
    };
    if found.same {
        line(format!("The same: {} values in {} files.", count(found.values), found.files.len()));
    } else {
        line("Not the same (in the folder; walked now):".into());
    }
    for of in &found.differences {
        let place = if of.place.is_empty() { String::new() } else { format!(", {}", of.place) };
        line(format!("  {}{place}: {}; {}", of.file, of.kept, of.again));
    }
    let more = found.different.saturating_sub(found.differences.len() as u64);
    if more > 0 {
        line(format!("  and {} more", count(more)));
    }
    if found.made_by != found.again_by {
        line(format!("Made by voidwalk {}, walked now by {}.", found.made_by, found.again_by));
    }
    text
}
