//! Shows the progress of packings, walks and campaigns on stderr: a bar on a terminal, plain lines otherwise.
//! Stops them on a signal, and writes the pages of their results.

use super::print::{plain, shown, to_stderr};
use crate::cases::{CaseCallbacks, CaseEvent};
use crate::outcome::verdict::SoFar;
use crate::report;
use crate::report::ReportError;
use crate::run::{Callbacks, Event, FolderKind, RunError};
use crate::verdict::RunFiles;
use crate::words::{first_lines, sentence, so_far};
use indicatif::{ProgressBar, ProgressStyle};
use std::io::IsTerminal;
use std::path::{Path, PathBuf};
use std::sync::{Mutex, OnceLock};
use std::time::{Duration, Instant};
use voidwalk_core::packing::{CompressionProgress, Stage};
use voidwalk_core::store::platform::process::{end_at_once, stop_on_request};
use voidwalk_practice::quantity::whole;

const BETWEEN_LINES: Duration = Duration::from_secs(5);

/// Runs work that is shown on stderr and stopped by signals, and writes the pages of its results.
pub(crate) fn followed<T>(
    quiet: bool,
    work: impl FnOnce(&Callbacks) -> Result<T, RunError>,
) -> Result<T, RunError> {
    let stop = stop_on_request().map_err(RunError::failed)?;
    end_at_once();
    let display = Display { quiet, begun: Instant::now(), shown: Mutex::new(None) };
    let done = work(&Callbacks {
        on_event: &|event| display.tell(event),
        stop: &stop,
        warn: &|warning| display.line(&format!("warning: {}\n", plain(warning))),
        on_results: unfollowed().on_results,
    });
    display.end();
    done
}

/// Callbacks of short work: its results get their pages, and a signal ends it as it ends any program.
pub(crate) fn unfollowed() -> Callbacks<'static> {
    Callbacks {
        warn: &|warning| to_stderr(&format!("warning: {}\n", plain(warning))),
        on_results: &|kind, folder, run| Ok(page(kind, folder, run).map(drop)?),
        ..Callbacks::default()
    }
}

/// Writes the page of finished results, for a run from the content of its files if available. A set of
/// constrictions has no page, nor has a server's folder.
pub fn page(kind: FolderKind, folder: &Path, run: Option<RunFiles>) -> Result<PathBuf, ReportError> {
    let written = match kind {
        FolderKind::Run => match run {
            Some(files) => report::write_walked(folder, files),
            None => report::write(folder),
        },
        FolderKind::Packing => report::write_packing(folder),
        FolderKind::Campaign => report::write_campaign(folder),
        FolderKind::Percolation => report::write_percolation(folder),
        FolderKind::Batch => report::write_batch(folder),
        FolderKind::Boundary => report::write_boundary(folder),
        FolderKind::Designs => report::write_designs(folder),
        FolderKind::Specification => report::write_specification(folder),
        FolderKind::Constrictions | FolderKind::Serve => return Ok(folder.to_owned()),
    };
    written.map(|written| written.page)
}

fn bar_on_terminal(length: u64, style: &str) -> Option<ProgressBar> {
    if !std::io::stderr().is_terminal() {
        return None;
    }
    let bar = if length > 0 { ProgressBar::new(length) } else { ProgressBar::new_spinner() };
    if let Ok(style) = ProgressStyle::with_template(style) {
        bar.set_style(style);
    }
    bar.enable_steady_tick(Duration::from_millis(200));
    Some(bar)
}

const BETWEEN_LOOKS: Duration = Duration::from_secs(1);

struct Display {
    quiet: bool,
    begun: Instant,
    shown: Mutex<Option<Shown>>,
}

struct Shown {
    bar: Option<ProgressBar>,
    begun: Instant,
    last: Instant,
    work: Work,
}

/// Minimum time without a finished run before its increments are reported.
const BETWEEN_INCREMENTS: Duration = Duration::from_secs(30);

enum Work {
    /// Usual number of steps, and number of steps done before this start of the program.
    Packing(u64, Option<u64>),
    Walk(Walk),
}

#[derive(Default)]
struct Walk {
    done: u64,
    runs: u64,
    so_far: SoFar,
    /// Number of replicates that the verdict needs, and runs of each.
    needs: [u64; 2],
    /// True if the verdict also waits for other readings of the inputs.
    readings: bool,
    /// Number of replicates at the last report, and the time of the last line.
    looked_at: usize,
    last_line: Option<Instant>,
}

impl Walk {
    /// New report on the replicates, if two or more are finished and others are to come.
    fn new_look(&mut self) -> Option<String> {
        let [replicates, runs] = self.needs;
        let look = self.so_far.look(runs)?;
        let is_new = look.replicates > self.looked_at && (look.replicates as u64) < replicates;
        let words = so_far(&look, replicates).filter(|_| is_new)?;
        self.looked_at = look.replicates;
        let one = if self.readings { "; by one of several readings of the inputs" } else { "" };
        Some(words + one)
    }
}

impl Display {
    fn tell(&self, event: Event) {
        if self.quiet {
            return;
        }
        match event {
            Event::PackingElsewhere { folder, holder } => {
                to_stderr(&format!("waiting for the packing in {} ({})\n", shown(folder), plain(holder)));
            }
            Event::PackingBegun(plan) => {
                to_stderr(&format!(
                    "packing {} grains ({}), friction {}: about {} steps\n",
                    whole(plan.compression.grains as u64),
                    plain(&plan.name),
                    plan.compression.friction,
                    whole(plan.usual_steps())
                ));
                self.begin(0, "{spinner} {msg}", Work::Packing(plan.usual_steps(), None));
            }
            Event::PackingEnded => self.end(),
            Event::WalkBegun { runs } => {
                let style = "{bar:30} {pos}/{len} runs, {elapsed} gone, about {eta} to go  {msg}";
                self.begin(runs, style, Work::Walk(Walk { runs, ..Walk::default() }));
            }
            Event::Studying(what) => {
                to_stderr(&format!("{:6.1} s  {}\n", self.begun.elapsed().as_secs_f64(), plain(what)));
            }
            Event::Noted { notes, unit } => {
                notes.iter().for_each(|note| self.line(&format!("note: {}\n", plain(&sentence(note, unit)))));
            }
            Event::VerdictStands { outcome, decision, unit } => {
                for (line, words) in first_lines(outcome, decision, unit) {
                    self.line(&format!("{}: {}\n", line.name(), plain(&words)));
                }
            }
            Event::Packing(_)
            | Event::Increment { .. }
            | Event::RunDone
            | Event::RunWalked { .. }
            | Event::VerdictNeeds { .. }
            | Event::MoreRuns { .. } => {
                if let Some(shown) = self.shown.lock().ok().as_mut().and_then(|shown| shown.as_mut()) {
                    shown.tell(event);
                }
            }
        }
    }

    fn line(&self, text: &str) {
        let shown = self.shown.lock().ok();
        match shown.as_ref().and_then(|shown| shown.as_ref()?.bar.as_ref()) {
            Some(bar) => bar.suspend(|| to_stderr(text)),
            None => to_stderr(text),
        }
    }

    fn begin(&self, length: u64, style: &str, work: Work) {
        let now = Instant::now();
        if let Ok(mut shown) = self.shown.lock() {
            *shown = Some(Shown { bar: bar_on_terminal(length, style), begun: now, last: now, work });
        }
    }

    fn end(&self) {
        let shown = self.shown.lock().ok().and_then(|mut shown| shown.take());
        if let Some(bar) = shown.and_then(|shown| shown.bar) {
            bar.finish_and_clear();
        }
    }
}

impl Shown {
    fn tell(&mut self, event: Event) {
        let seconds = self.begun.elapsed().as_secs_f64();
        match (&mut self.work, event) {
            (Work::Packing(usual, first), Event::Packing(progress)) => {
                let here = progress.steps - *first.get_or_insert(progress.steps);
                let (bar, last) = (self.bar.as_ref(), &mut self.last);
                show(bar, last, BETWEEN_LINES, || packing_line(progress, *usual, here, seconds));
            }
            (Work::Walk(walk), Event::VerdictNeeds { replicates, runs, readings }) => {
                walk.needs = [replicates, runs];
                walk.readings = readings;
            }
            (
                Work::Walk(walk),
                Event::RunWalked { replicate, run, eroded_mass_fraction, below_threshold },
            ) => {
                walk.so_far.add(replicate, run, eroded_mass_fraction, below_threshold);
                let Some(words) = walk.new_look() else { return };
                if let Some(bar) = &self.bar {
                    bar.set_message(words);
                } else if walk.last_line.is_none_or(|last_line| last_line.elapsed() >= BETWEEN_LOOKS) {
                    walk.last_line = Some(Instant::now());
                    to_stderr(&(words + "\n"));
                }
            }
            // Results of replicates, once there are any, take the place of increments in the bar.
            (Work::Walk(walk), Event::Increment { replicate, run, increment, moving })
                if walk.looked_at == 0 =>
            {
                show(self.bar.as_ref(), &mut self.last, BETWEEN_INCREMENTS, || {
                    let (increment, moving) = (whole(increment), whole(moving));
                    format!("replicate {replicate}, run {run}, increment {increment}: {moving} moving")
                });
            }
            (Work::Walk(walk), Event::MoreRuns { runs: more }) => {
                walk.runs += more;
                if let Some(bar) = &self.bar {
                    bar.inc_length(more);
                }
            }
            (Work::Walk(Walk { done, runs, .. }), Event::RunDone) => {
                *done += 1;
                if let Some(bar) = &self.bar {
                    bar.inc(1);
                } else if done == runs || self.last.elapsed() >= BETWEEN_LINES {
                    self.last = Instant::now();
                    let left = seconds / *done as f64 * runs.saturating_sub(*done) as f64;
                    to_stderr(&format!(
                        "{done} of {runs} runs, {seconds:.0} s gone, about {left:.0} s to go\n"
                    ));
                }
            }
            _ => {}
        }
    }
}

/// Shows a message beside the bar; without a bar prints it, if the last line is at least this old.
fn show(bar: Option<&ProgressBar>, last: &mut Instant, between: Duration, message: impl FnOnce() -> String) {
    if let Some(bar) = bar {
        bar.set_message(message());
    } else if last.elapsed() >= between {
        *last = Instant::now();
        to_stderr(&(message() + "\n"));
    }
}

/// Progress of a packing; `here` of its steps were done since this start of the program.
fn packing_line(progress: &CompressionProgress, usual: u64, here: u64, seconds: f64) -> String {
    let stage = match progress.stage {
        Stage::Squeeze => "squeeze",
        Stage::Compress => "compress",
        Stage::Settle => "settle with the final friction",
        Stage::Done => "done",
    };
    let to_go = |steps: u64| steps as f64 * seconds / here as f64;
    let left = match usual.checked_sub(progress.steps) {
        Some(steps) if here > 0 => format!("about {:.0} s to go if it is typical", to_go(steps)),
        Some(_) => "time to go not known yet".to_string(),
        None => "longer than most".to_string(),
    };
    format!(
        "{stage}: {} steps, void ratio {:.4}, pressure {:.3} of the target, coordination {:.2}, \
         unbalanced {:.3}, {seconds:.0} s gone, {left}",
        whole(progress.steps),
        progress.void_ratio,
        progress.pressure,
        progress.coordination,
        progress.unbalanced,
    )
}

/// Minimum time between plain lines outside a cluster's job.
const BETWEEN_CASES: Duration = Duration::from_secs(2);

/// Time without a message after which the progress of a case is reported.
const BETWEEN_RUNS: Duration = Duration::from_secs(5);

/// Runs cases that are shown on stderr; with `every_event`, each of their events gets a line, as in the log
/// of a job.
pub(crate) fn followed_cases<T>(
    quiet: bool,
    every_event: bool,
    work: impl FnOnce(&CaseCallbacks) -> Result<T, RunError>,
) -> Result<T, RunError> {
    // It is known once the cases are counted.
    let shown: OnceLock<CaseDisplay> = OnceLock::new();
    followed(quiet, |run| {
        let done = work(&CaseCallbacks {
            run: *run,
            on_cases: &|total, done| {
                if !quiet {
                    let _ = shown.set(CaseDisplay::new(total, done, every_event));
                }
            },
            on_case: &|case, event| {
                if let Some(shown) = shown.get() {
                    shown.tell(case, event);
                }
            },
        });
        if let Some(bar) = shown.get().and_then(|shown| shown.bar.as_ref()) {
            bar.finish_and_clear();
        }
        done
    })
}

struct CaseDisplay {
    bar: Option<ProgressBar>,
    every_event: bool,
    lines: Mutex<Lines>,
}

/// Number of cases done when this process began, number done now, and number in all.
struct Lines {
    first: usize,
    done: usize,
    total: usize,
    begun: Instant,
    last: Instant,
}

impl CaseDisplay {
    fn new(total: usize, done: usize, every_event: bool) -> Self {
        if done > 0 {
            to_stderr(&format!("{done} of {total} cases are done already\n"));
        }
        let style = "{bar:30} {pos}/{len} cases, {elapsed} gone, about {eta} to go  {msg}";
        let bar = bar_on_terminal(total as u64, style);
        if let Some(bar) = &bar {
            bar.set_position(done as u64);
            bar.reset_eta();
        }
        let now = Instant::now();
        let lines = Lines { first: done, done, total, begun: now, last: now };
        Self { bar, every_event, lines: Mutex::new(lines) }
    }

    fn tell(&self, case: &str, event: CaseEvent) {
        let case = plain(case);
        match (&self.bar, event) {
            (Some(bar), CaseEvent::Begun { .. }) => bar.set_message(case),
            (Some(bar), CaseEvent::Waiting) => bar.set_message(format!("waiting for {case}")),
            (Some(bar), CaseEvent::Walked { done, runs }) => {
                bar.set_message(format!("{case}: {done} of {runs} runs"));
            }
            (Some(bar), CaseEvent::Done(_)) => bar.inc(1),
            (bar, CaseEvent::Failed(problem)) => {
                let tell = || to_stderr(&format!("failed: {case}: {}\n", plain(problem)));
                bar.as_ref().map_or_else(tell, |bar| bar.suspend(tell));
            }
            (None, CaseEvent::Begun { resumes }) if self.every_event => {
                to_stderr(&format!("{}: {case}\n", if resumes { "continues" } else { "begins" }));
            }
            (None, CaseEvent::Waiting) if self.every_event => {
                to_stderr(&format!("waits: {case}: another process works on it\n"));
            }
            (None, CaseEvent::Walked { done, runs }) if !self.every_event => {
                let Ok(mut lines) = self.lines.lock() else { return };
                if lines.last.elapsed() >= BETWEEN_RUNS {
                    lines.last = Instant::now();
                    to_stderr(&format!("{case}: {done} of {runs} runs\n"));
                }
            }
            (None, CaseEvent::Done(line)) => {
                let Ok(mut lines) = self.lines.lock() else { return };
                lines.done += 1;
                if !self.every_event && lines.done < lines.total && lines.last.elapsed() < BETWEEN_CASES {
                    return;
                }
                lines.last = Instant::now();
                let gone = lines.begun.elapsed().as_secs_f64();
                let to_go = lines.total.saturating_sub(lines.done);
                let left = gone / (lines.done - lines.first) as f64 * to_go as f64;
                to_stderr(&format!(
                    "{} of {} cases, {gone:.0} s gone, about {left:.0} s to go; {case}: {}\n",
                    lines.done,
                    lines.total,
                    line.verdict.words()
                ));
            }
            _ => {}
        }
    }
}
