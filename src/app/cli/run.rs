//! Commands `voidwalk run`, `resume` and `judge`: walks of a scene, of two sieve tables, or of many samples
//! and filters.

use std::ffi::OsString;
use std::fmt::Write;
use std::path::Path;
use std::sync::OnceLock;

use super::args::{JudgeArgs, ResumeArgs, RunArgs, TableArgs};
use super::exit::{JudgedAnswer, accept};
use super::options::{AcceptArgs, ResultArgs, SettingArgs, WalkArgs};
use super::print::{answer, counted, plain, shown, to_stdout};
use super::progress::{CaseProgress, followed};
use super::rules::{aligned, in_notes, of_filter};
use crate::cases::{self, BatchPlan, BatchWalks, CaseOptions, CasePart};
use crate::run::{self, FinishedRun, PrepareOptions, RunError, RunOptions};
use crate::scene::{LibraryDensity, Scene, TableOptions};
use crate::verdict::{WalkedBatch, WalkedRow, counts_as};
use crate::words::batch::{self, walked_columns, walks};
use crate::words::first_lines;
use crate::words::left_out::{NOT_COVERED, left_out_line};
use voidwalk_core::store::format;
use voidwalk_core::text::shell_word;
use voidwalk_practice::BatchRow;
use voidwalk_practice::quantity::SizeUnit;

#[cfg(feature = "xlsx")]
use crate::report::write_verdict_workbook;
#[cfg(feature = "xlsx")]
use crate::run::FolderKind;
#[cfg(feature = "xlsx")]
use crate::run::folder::claim;

pub(crate) fn run(args: &RunArgs) -> Result<(), RunError> {
    let (scene, set, quiet) = (args.scene.scene()?, &args.scene.set, args.results.walk.quiet);
    let options = args.results.options(set);
    let run = followed(quiet, |callbacks| run::walk_scene(scene, &options, callbacks))?;
    args.results.finish(&run, set.json)
}

impl AcceptArgs {
    /// Ends a command by the verdict of its run.
    fn judged(&self, run: &FinishedRun) -> Result<(), RunError> {
        let (model, practice) = (run.outcome.model.class, counts_as(&run.decision));
        accept(self.fail_on, [("", Ok(JudgedAnswer { model, practice }))])
    }
}

impl ResultArgs {
    pub(crate) fn options(&self, set: &SettingArgs) -> RunOptions {
        RunOptions {
            out: self.out.clone(),
            overwrite: self.overwrite,
            prepare: set.prepare(self.walk.threads),
            checkpoint_interval: self.walk.checkpoint_every,
            command: command_line(),
        }
    }

    /// Prints the results of a run, writes its workbook if requested, and ends by its verdict.
    pub(crate) fn finish(&self, run: &FinishedRun, as_json: bool) -> Result<(), RunError> {
        answer((as_json, self.walk.quiet), format::OUTCOME, &run.outcome, || summary(run))?;
        #[cfg(feature = "xlsx")]
        if self.xlsx {
            let claimed = claim(&run.folder, FolderKind::Run, true)?;
            write_verdict_workbook(claimed.path(), claimed.path()).map_err(RunError::failed)?;
        }
        self.accept.judged(run)
    }
}

pub(crate) fn resume(args: &ResumeArgs) -> Result<(), RunError> {
    let (walk, packings) = (&args.walk, args.folder.join("packings"));
    let options = RunOptions {
        prepare: PrepareOptions { packings, memory: args.memory, threads: walk.threads },
        checkpoint_interval: walk.checkpoint_every,
        command: command_line(),
        ..RunOptions::default()
    };
    let run = followed(walk.quiet, |callbacks| run::resume(&args.folder, &options, callbacks))?;
    answer((args.json, walk.quiet), format::OUTCOME, &run.outcome, || summary(&run))?;
    args.accept.judged(&run)
}

/// Command line in words, even if it is not UTF-8.
pub(crate) fn command_line() -> String {
    let words = START.get().map_or(&[][..], |start| &start.words);
    words.iter().map(|word| shell_word(&word.to_string_lossy())).collect::<Vec<_>>().join(" ")
}

/// Maximum number of important notes whose subjects the last line names.
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

impl TableArgs {
    pub(crate) fn options(&self) -> TableOptions {
        TableOptions {
            density: self.density,
            pack: self.pack,
            quick: self.quick,
            as_sampled: self.as_sampled,
            as_given: self.as_given,
            changes: self.set.settings.assignments.clone(),
        }
    }
}

pub(crate) fn judge(args: &JudgeArgs) -> Result<(), RunError> {
    let filter = match &args.filters[..] {
        [filter] if !args.each => filter,
        _ => return judge_each(args),
    };
    let (tables, quiet) = (&args.tables, args.results.walk.quiet);
    let scene = Scene::of_tables(&args.base, filter, &tables.options())?;
    let options = args.results.options(&tables.set);
    let run = followed(quiet, |callbacks| run::walk_scene(scene, &options, callbacks))?;
    if !tables.set.json && !quiet {
        to_stdout(&format!("base {}, filter {}\n", shown(&args.base), shown(filter)));
    }
    args.results.finish(&run, tables.set.json)
}

const OUT: &str = "voidwalk-batch";

fn judge_each(args: &JudgeArgs) -> Result<(), RunError> {
    let (tables, results) = (&args.tables, &args.results);
    #[cfg(feature = "xlsx")]
    if results.xlsx {
        return Err(RunError::refused("--xlsx goes with one filter"));
    }
    let quiet = results.walk.quiet;
    let out = results.out.as_deref().unwrap_or(Path::new(OUT));
    let options = campaign_options(out, &tables.set, &results.walk);
    let walks = match (args.each, args.governing, tables.quick) {
        (false, ..) => BatchWalks::OneBase,
        (true, true, _) => BatchWalks::GoverningAlone,
        (true, false, true) => BatchWalks::FirstLook,
        (true, false, false) => BatchWalks::GoverningInFull,
    };
    let plan = BatchPlan::new(&args.base, &args.filters, &tables.options(), walks, &options)?;
    let earlier = if results.overwrite { None } else { cases::batch::found(&plan, &options)? };
    let batch = match earlier {
        Some(earlier) => earlier,
        None => {
            let progress = CaseProgress::new(quiet, false);
            progress.followed(|callbacks| cases::batch::run(&plan, &options, results.overwrite, callbacks))?
        }
    };
    answer((tables.set.json, quiet), format::BATCH, &batch, || {
        batch_words(&batch, &plan.first_scene().map_or(String::new(), constrictions), out)
            + &of_earlier_cover(plan.with_other_cover(out))
    })?;
    let name = |row: &WalkedRow| format!("{} in {}", row.rules.sample, row.rules.filter);
    let names: Vec<String> = batch.rows.iter().map(name).collect();
    // The class of a pair that could not be walked is unknown; other pairs were left out on purpose.
    let is_asked = |row: &WalkedRow| !args.governing || row.governs.is_some() || row.rules.is_refused;
    let asked = batch.rows.iter().zip(&names).filter(|(row, _)| row.walk.is_some() || is_asked(row));
    let pairs = asked.map(|(row, name)| {
        let answer =
            row.walk.as_ref().map(|walk| JudgedAnswer { model: walk.verdict, practice: walk.by_practice });
        (name.as_str(), answer.ok_or(row.not_walked.as_str()))
    });
    accept(results.accept.fail_on, pairs)
}

/// Source of the constrictions of a scene's filter.
fn constrictions(scene: &Scene) -> String {
    let filter = &scene.filter;
    if let Some(friction) = filter.friction {
        return format!("The filter's grains are packed, with friction {friction}.");
    }
    if let Some(density) = filter.density {
        return format!("The filter's grains are packed: {}.", density.name());
    }
    if let Some(density) = filter.library {
        let density = match density {
            LibraryDensity::Unknown => "loose and dense are both walked",
            density => density.name(),
        };
        return format!(
            "The filter's constrictions are those of packings of filters like it: {density}. Where the \
             library holds none like it, they are guessed."
        );
    }
    match (&filter.estimate, &filter.curve) {
        (Some(estimate), _) => format!(
            "The filter's constrictions are guessed from its gradation at {estimate}, and at both ends of \
             the range from 0 (loose) to 1 (dense): how densely it lies was not given."
        ),
        (None, Some(_)) => "The filter's constrictions are those of filter.curve.".into(),
        (None, None) => "The constrictions are those of the network that was given.".into(),
    }
}

fn campaign_options(out: &Path, set: &SettingArgs, walk: &WalkArgs) -> CaseOptions {
    CaseOptions {
        out: out.to_owned(),
        part: CasePart::All,
        packings: Some(set.packings.clone()),
        memory: set.memory,
        threads: walk.threads,
        checkpoint_interval: walk.checkpoint_every.unwrap_or_default(),
        command: command_line(),
    }
}

/// Line with the number of walks kept with the cover of an earlier call; empty for 0.
fn of_earlier_cover(walks: usize) -> String {
    match walks {
        0 => String::new(),
        1 => "1 walk was kept from an earlier call; its own page has the cover of that call\n".into(),
        _ => format!(
            "{walks} walks were kept from an earlier call; their own pages have the cover of that call\n"
        ),
    }
}

fn batch_words(batch: &WalkedBatch, constrictions: &str, out: &Path) -> String {
    let unit = SizeUnit::of(false, batch.inches);
    let mut text = aligned(walked_columns(unit), &batch.rows) + &in_notes(&batch.notes);
    if batch.has_one_base() {
        text.push('\n');
        for row in &batch.rows {
            let _ = writeln!(text, "{}", plain(&format!("{}: {}", row.rules.filter, batch::answer(row))));
        }
    }
    let rules: Vec<BatchRow> = batch.rows.iter().map(|row| row.rules.clone()).collect();
    for filter in &batch.filters {
        // Writing to a string cannot fail.
        let _ = write!(text, "\n{}", of_filter(&rules, filter, batch.inches));
        for line in walks(batch, &filter.name, unit) {
            let _ = writeln!(text, "  {}", plain(&line));
        }
        for row in batch.governing(&filter.name).iter().filter(|_| !batch.has_one_base()) {
            let line = format!("{}: {}", row.rules.sample, batch::answer(row));
            let _ = writeln!(text, "  {}", plain(&line));
        }
    }
    if batch.rows.iter().any(|row| row.rules.is_refused) {
        let _ = writeln!(text, "\n--as-given walks pairs that look exchanged");
    }
    let _ = writeln!(text, "\n{}", plain(constrictions));
    let _ = writeln!(text, "{}", left_out_line(&batch.model_leaves_out));
    let _ = writeln!(text, "table: {}", shown(&out.join("batch.csv")));
    let _ = writeln!(text, "report: {}", shown(&out.join("batch.html")));
    text
}

/// Start of the program.
#[derive(Clone, Debug)]
pub struct Start {
    /// Words of the command line, starting with the program's name.
    pub words: Vec<OsString>,
    /// Command that starts the program again in a job script: a path and further words; `None` means this
    /// executable.
    pub again: Option<Vec<String>>,
}

/// Start of this process, once it is known.
pub(crate) static START: OnceLock<Start> = OnceLock::new();
