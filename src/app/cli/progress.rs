//! Follows packings and walks on stderr: a bar on a terminal, plain lines otherwise; and stops them on a
//! signal.

use std::io::IsTerminal;
use std::sync::atomic::AtomicBool;
use std::sync::{Arc, Mutex};
use std::time::{Duration, Instant};

use indicatif::{ProgressBar, ProgressStyle};

use super::print::{plain, shown, to_stderr};
use super::report::page;
use crate::case::PackingPlan;
use crate::outcome::so_far::SoFar;
use crate::run::{Callbacks, Event, RunError};
use crate::words::{first_lines, sentence, so_far};
use voidwalk_core::packing::{CompressionProgress, Stage};
use voidwalk_core::store::platform::signals::{end_at_once, stop_on_request};
use voidwalk_practice::quantity::whole;

/// Plain lines come at most this often.
const BETWEEN_LINES: Duration = Duration::from_secs(5);

/// Does some work that is followed on stderr, stopped by signals, and whose results get their pages.
pub fn followed<T>(quiet: bool, work: impl FnOnce(&Callbacks) -> Result<T, RunError>) -> Result<T, RunError> {
    let stop = stop_on_signals()?;
    end_at_once();
    let display = Display::new(quiet);
    let done = work(&Callbacks {
        on_event: &|event| display.tell(event),
        stop: &stop,
        warn: &|warning| display.warn(warning),
        on_results: unfollowed().on_results,
    });
    display.end();
    done
}

/// Callbacks of short work: its results get their pages, and a signal ends it like any program.
pub fn unfollowed() -> Callbacks<'static> {
    Callbacks {
        warn: &|warning| to_stderr(&format!("warning: {}\n", plain(warning))),
        on_results: &|kind, folder, run| Ok(page(kind, folder, run).map(drop)?),
        ..Callbacks::default()
    }
}

/// A flag that the first request to end sets.
///
/// # Errors
/// Errors of the system.
pub fn stop_on_signals() -> Result<Arc<AtomicBool>, RunError> {
    stop_on_request().map_err(RunError::failed)
}

/// A bar of this length on a terminal, and no bar elsewhere.
pub fn bar_on_terminal(length: u64, style: &str) -> Option<ProgressBar> {
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

/// Looks at the replicates so far come at most this often as plain lines.
const BETWEEN_LOOKS: Duration = Duration::from_secs(1);

/// Display of the work.
struct Display {
    quiet: bool,
    begun: Instant,
    shown: Mutex<Option<Shown>>,
}

/// A packing or walk that is under way.
struct Shown {
    bar: Option<ProgressBar>,
    begun: Instant,
    last: Instant,
    work: Work,
}

/// Runs that take longer than this report their progress.
const BETWEEN_INCREMENTS: Duration = Duration::from_secs(30);

enum Work {
    /// Steps that it usually takes, and that were done when this start of the program began.
    Packing {
        usual: u64,
        first: Option<u64>,
    },
    Walk(Walk),
}

/// Finished runs, number of runs, and results of the replicates so far.
#[derive(Default)]
struct Walk {
    done: u64,
    runs: u64,
    so_far: SoFar,
    /// Replicates that the verdict is to have, and runs of each.
    needs: [u64; 2],
    /// True if the verdict also waits for other readings of the inputs.
    readings: bool,
    /// Replicates at the last look, and the time of the last line.
    looked_at: usize,
    last_line: Option<Instant>,
}

impl Walk {
    /// A look that has not been reported yet, if two or more replicates are finished and others are to come.
    fn new_look(&mut self) -> Option<String> {
        let [replicates, runs] = self.needs;
        let look = self.so_far.look(runs)?;
        let is_new = look.replicates > self.looked_at && (look.replicates as u64) < replicates;
        let mut words = so_far(&look, replicates).filter(|_| is_new)?;
        self.looked_at = look.replicates;
        if self.readings {
            words += "; by one of several readings of the inputs";
        }
        Some(words)
    }
}

impl Display {
    fn new(quiet: bool) -> Self {
        Self { quiet, begun: Instant::now(), shown: Mutex::new(None) }
    }

    fn tell(&self, event: Event) {
        if self.quiet {
            return;
        }
        match event {
            Event::PackingElsewhere { folder, holder } => {
                to_stderr(&format!("waiting for the packing in {} ({})\n", shown(folder), plain(holder)));
            }
            Event::PackingBegun(plan) => {
                to_stderr(&packing_begun(plan));
                self.begin(0, "{spinner} {msg}", Work::Packing { usual: plan.usual_steps(), first: None });
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

    fn warn(&self, warning: &str) {
        self.line(&format!("warning: {}\n", plain(warning)));
    }

    /// Prints a line, above the bar if there is one.
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
            (Work::Packing { usual, first }, Event::Packing(progress)) => {
                let here = progress.steps - *first.get_or_insert(progress.steps);
                if let Some(bar) = &self.bar {
                    bar.set_message(packing_line(progress, *usual, here, seconds));
                } else if self.last.elapsed() >= BETWEEN_LINES {
                    self.last = Instant::now();
                    to_stderr(&(packing_line(progress, *usual, here, seconds) + "\n"));
                }
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
            (Work::Walk(walk), Event::Increment { replicate, run, increment, moving }) => {
                if walk.looked_at > 0 {
                    // The bar shows the results of the replicates.
                } else if let Some(bar) = &self.bar {
                    bar.set_message(increment_line(replicate, run, increment, moving));
                } else if self.last.elapsed() >= BETWEEN_INCREMENTS {
                    self.last = Instant::now();
                    to_stderr(&(increment_line(replicate, run, increment, moving) + "\n"));
                }
            }
            (Work::Walk(walk), Event::MoreRuns { runs: more }) => {
                walk.runs += more;
                self.bar.iter().for_each(|bar| bar.inc_length(more));
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

fn increment_line(replicate: u64, run: u64, increment: u64, moving: u64) -> String {
    format!("replicate {replicate}, run {run}, increment {}: {} moving", whole(increment), whole(moving))
}

fn packing_begun(plan: &PackingPlan) -> String {
    format!(
        "packing {} grains ({}), friction {}: about {} steps\n",
        whole(plan.compression.grains as u64),
        plain(&plan.name),
        plan.compression.friction,
        whole(plan.usual_steps())
    )
}

/// Progress of a packing, with `here` of its steps done by this start of the program.
fn packing_line(progress: &CompressionProgress, usual: u64, here: u64, seconds: f64) -> String {
    let stage = match progress.stage {
        Stage::Squeeze => "squeeze",
        Stage::Compress => "compress",
        Stage::Settle => "settle with the final friction",
        Stage::Done => "done",
    };
    let left = match usual.checked_sub(progress.steps) {
        Some(steps) if here > 0 => {
            format!("about {:.0} s to go if it is like others", steps as f64 * seconds / here as f64)
        }
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
