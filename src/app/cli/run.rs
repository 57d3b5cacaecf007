//! Commands `voidwalk run`, `resume` and `judge`: walks of a scene, of two sieve tables, or of many samples
//! and filters.

use std::collections::HashSet;
use std::ffi::OsString;
use std::path::Path;
use std::sync::OnceLock;

use super::args::{JudgeArgs, ResumeArgs, RunArgs, TableArgs};
use super::exit::{JudgedAnswer, accept};
use super::options::{AcceptArgs, ResultArgs, SettingArgs};
use super::print::{answer, counted, plain, shown, to_stdout};
use super::progress::{followed, followed_cases};
use super::rules::{aligned, in_notes, of_filter};
use crate::cases::{self, BatchPlan, BatchWalks, CaseOptions};
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

fn summary(run: &FinishedRun) -> String {
    let FinishedRun { outcome, decision, .. } = run;
    let mut text = String::new();
    let mut line = |s: String| text.extend([&s, "\n"]);
    for (first, text) in first_lines(outcome, decision, run.unit) {
        line(format!("{}: {}", first.name(), plain(&text)));
    }
    line(left_out_line(&outcome.model_leaves_out));
    if decision.headline.is_some() {
        line(NOT_COVERED.into());
    }
    let page = shown(&run.folder.join("report.html"));
    let mut seen = HashSet::new();
    let labels = outcome.notes.iter().map(|note| note.entry().label);
    let labels: Vec<&str> = labels.filter(|label| seen.insert(*label)).collect();
    let notes = counted(outcome.notes.len() as u64, "note", "notes");
    let (first, others) = labels.split_at(labels.len().min(LABELS));
    line(match (first, others.len()) {
        ([], _) => format!("report: {page}"),
        (_, 0) => format!("report: {page}; {notes}: {}", first.join(", ")),
        (_, others) => format!("report: {page}; {notes}: {} and {others} more", first.join(", ")),
    });
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
    let prepare = tables.set.prepare(results.walk.threads);
    let options = CaseOptions {
        checkpoint_interval: results.walk.checkpoint_every.unwrap_or_default(),
        ..CaseOptions::of(out.to_owned(), prepare, command_line())
    };
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
        None => followed_cases(quiet, false, |callbacks| {
            cases::batch::run(&plan, &options, results.overwrite, callbacks)
        })?,
    };
    answer((tables.set.json, quiet), format::BATCH, &batch, || {
        let constrictions = plan.scene().map_or(String::new(), constrictions);
        batch_words(&batch, &constrictions, out) + &of_earlier_cover(plan.with_other_cover(out))
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

/// Line with the number of walks kept with the cover of an earlier call; empty for 0.
fn of_earlier_cover(walks: usize) -> String {
    let (kept, own) = match walks {
        0 => return String::new(),
        1 => ("walk was", "its own page has"),
        _ => ("walks were", "their own pages have"),
    };
    format!("{walks} {kept} kept from an earlier call; {own} the cover of that call\n")
}

fn batch_words(batch: &WalkedBatch, constrictions: &str, out: &Path) -> String {
    let unit = SizeUnit::of(false, batch.inches);
    let mut text = aligned(walked_columns(unit), &batch.rows) + &in_notes(&batch.notes);
    let mut line = |s: &str| text += &(plain(s) + "\n");
    if batch.has_one_base() {
        line("");
        batch.rows.iter().for_each(|row| line(&format!("{}: {}", row.rules.filter, batch::answer(row))));
    }
    let rules: Vec<BatchRow> = batch.rows.iter().map(|row| row.rules.clone()).collect();
    for filter in &batch.filters {
        line("");
        of_filter(&rules, filter, batch.inches).lines().for_each(&mut line);
        walks(batch, &filter.name, unit).iter().for_each(|walk| line(&format!("  {walk}")));
        for row in batch.governing(&filter.name).iter().filter(|_| !batch.has_one_base()) {
            line(&format!("  {}: {}", row.rules.sample, batch::answer(row)));
        }
    }
    if batch.rows.iter().any(|row| row.rules.is_refused) {
        line("");
        line("--as-given walks pairs that look exchanged");
    }
    line("");
    line(constrictions);
    line(&left_out_line(&batch.model_leaves_out));
    line(&format!("table: {}", shown(&out.join("batch.csv"))));
    line(&format!("report: {}", shown(&out.join("batch.html"))));
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

pub(crate) static START: OnceLock<Start> = OnceLock::new();
