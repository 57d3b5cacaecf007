//! `voidwalk run` and `voidwalk resume`.

use std::fmt::Write;

use super::args::{AcceptArgs, ResultArgs, ResumeArgs, RunArgs, SettingArgs};
use super::exit::{JudgedAnswer, accept};
use super::print::{as_it_is, counted, json, plain, shown, to_stdout};
use super::progress::followed;
use super::start::START;
#[cfg(feature = "xlsx")]
use crate::report::write_verdict_workbook;
#[cfg(feature = "xlsx")]
use crate::run::FolderKind;
#[cfg(feature = "xlsx")]
use crate::run::folder::claim;
use crate::run::{self, FinishedRun, PrepareOptions, RunError, RunOptions};
use crate::words::first_lines;
use crate::words::left_out::{NOT_COVERED, left_out_line};
use voidwalk_core::store::format;
use voidwalk_core::text::shell_word;

/// Walks a scene and writes its folder.
pub fn run(args: &RunArgs) -> Result<(), RunError> {
    let (scene, set, quiet) = (args.scene.scene()?, &args.scene.set, args.results.walk.quiet);
    let options = args.results.options(set);
    let run = followed(quiet, |callbacks| run::walk_scene(scene, &options, callbacks))?;
    args.results.finish(&run, set.json)
}

impl AcceptArgs {
    /// Ends a command by the verdict of its run.
    fn judged(&self, run: &FinishedRun) -> Result<(), RunError> {
        let answer = JudgedAnswer {
            model: run.outcome.model.class,
            practice: crate::verdict::counts_as(&run.decision),
        };
        accept(self.fail_on, [("", answer)])
    }
}

impl ResultArgs {
    /// Options of the run that a command asks for.
    pub fn options(&self, set: &SettingArgs) -> RunOptions {
        RunOptions {
            out: self.out.clone(),
            overwrite: self.overwrite,
            prepare: set.prepare(self.walk.threads),
            checkpoint_interval: self.walk.checkpoint_every,
            command: command_line(),
        }
    }

    /// Prints the results of a run, writes its workbook if it is asked for, and ends by its verdict.
    pub fn finish(&self, run: &FinishedRun, as_json: bool) -> Result<(), RunError> {
        show(run, as_json, self.walk.quiet)?;
        self.workbook(run)?;
        self.accept.judged(run)
    }

    /// Writes the workbook of a finished run, if it is asked for.
    fn workbook(&self, run: &FinishedRun) -> Result<(), RunError> {
        #[cfg(feature = "xlsx")]
        if self.xlsx {
            let claimed = claim(&run.folder, FolderKind::Run, true)?;
            write_verdict_workbook(claimed.path(), claimed.path()).map_err(RunError::failed)?;
        }
        #[cfg(not(feature = "xlsx"))]
        let _ = run;
        Ok(())
    }
}

/// Continues a run that was stopped or killed.
pub fn resume(args: &ResumeArgs) -> Result<(), RunError> {
    let (walk, packings) = (&args.walk, args.folder.join("packings"));
    let options = RunOptions {
        prepare: PrepareOptions { packings, memory: args.memory, threads: walk.threads },
        checkpoint_interval: walk.checkpoint_every,
        command: command_line(),
        ..RunOptions::default()
    };
    let run = followed(walk.quiet, |callbacks| run::resume(&args.folder, &options, callbacks))?;
    show(&run, args.json, walk.quiet)?;
    args.accept.judged(&run)
}

/// The command line in words, whatever bytes it is made of.
pub fn command_line() -> String {
    let words = START.get().map_or(&[][..], |start| &start.words);
    words.iter().map(|word| shell_word(&word.to_string_lossy())).collect::<Vec<_>>().join(" ")
}

/// Prints the results of a run.
fn show(run: &FinishedRun, as_json: bool, quiet: bool) -> Result<(), RunError> {
    if as_json {
        as_it_is(&json(format::OUTCOME, &run.outcome)?);
    } else if !quiet {
        to_stdout(&summary(run));
    }
    Ok(())
}

/// Subjects of notes that the last line names, those that matter most.
const LABELS: usize = 4;

/// Lines that a user wants to read first.
fn summary(run: &FinishedRun) -> String {
    let FinishedRun { outcome, decision, .. } = run;
    let mut text = String::new();
    // Writing to a string cannot fail.
    let mut line = |s: String| {
        let _ = writeln!(text, "{s}");
    };
    for (first, text) in first_lines(outcome, decision, run.unit) {
        line(format!("{}: {}", first.name(), plain(&text)));
    }
    line(left_out_line(&outcome.model_leaves_out));
    if decision.headline.is_some() {
        line(NOT_COVERED.into());
    }
    let page = shown(&run.folder.join("report.html"));
    let mut labels: Vec<&str> = Vec::new();
    for note in &outcome.notes {
        if !labels.contains(&note.entry().label) {
            labels.push(note.entry().label);
        }
    }
    let notes = counted(outcome.notes.len() as u64, "note", "notes");
    let (first, others) = labels.split_at(labels.len().min(LABELS));
    match (first, others.len()) {
        ([], _) => line(format!("report: {page}")),
        (_, 0) => line(format!("report: {page}; {notes}: {}", first.join(", "))),
        (_, others) => line(format!("report: {page}; {notes}: {} and {others} more", first.join(", "))),
    }
    text
}
