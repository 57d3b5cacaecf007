//! Follows packings and walks on stderr: a bar on a terminal, plain lines otherwise; and stops them on a
//! signal.

use std::io::IsTerminal;
use std::sync::atomic::AtomicBool;
use std::sync::{Arc, Mutex};
use std::time::{Duration, Instant};

use indicatif::{ProgressBar, ProgressStyle};

use super::print::{count, plain, shown, to_stderr};
use super::report::page;
use crate::case::PackingPlan;
use crate::packing::{CompressionProgress, Stage};
use crate::run::{Callbacks, Event, RunError};
use crate::store::platform::signals::stop_on_request;

/// Plain lines come at most this often.
const BETWEEN_LINES: Duration = Duration::from_secs(5);

/// Does some work that is followed on stderr, stopped by signals, and whose results get their pages.
pub fn followed<T>(quiet: bool, work: impl FnOnce(&Callbacks) -> Result<T, RunError>) -> Result<T, RunError> {
    let stop = stop_on_signals()?;
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

/// What short work is told: its results get their pages, and a signal ends it as it ends any program.
pub fn unfollowed() -> Callbacks<'static> {
    Callbacks {
        warn: &|warning| to_stderr(&format!("warning: {}\n", plain(warning))),
        on_results: &|kind, folder| Ok(page(kind, folder).map(drop)?),
        ..Callbacks::default()
    }
}

/// A flag that the first request to end sets.
///
/// # Errors
/// What the system says.
pub fn stop_on_signals() -> Result<Arc<AtomicBool>, RunError> {
    stop_on_request().map_err(RunError::failed)
}

/// A bar of this length on a terminal; none elsewhere.
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

/// What is shown of the work.
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
    of: Work,
}

/// Where runs take longer than this, it is said how far one is.
const BETWEEN_INCREMENTS: Duration = Duration::from_secs(30);

enum Work {
    /// Steps that it usually takes, and that were done when this start of the program began.
    Packing { usual: u64, first: Option<u64> },
    /// Runs done, of how many.
    Walk { done: u64, runs: u64 },
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
                self.begin(runs, style, Work::Walk { done: 0, runs });
            }
            Event::Studying(what) => {
                to_stderr(&format!("{:6.1} s  {}\n", self.begun.elapsed().as_secs_f64(), plain(what)));
            }
            Event::RunWalked { .. } => {}
            Event::Packing(_) | Event::Increment { .. } | Event::RunDone | Event::MoreRuns { .. } => {
                if let Some(shown) = self.shown.lock().ok().as_mut().and_then(|shown| shown.as_mut()) {
                    shown.tell(event);
                }
            }
        }
    }

    fn warn(&self, warning: &str) {
        let text = format!("warning: {}\n", plain(warning));
        let shown = self.shown.lock().ok();
        match shown.as_ref().and_then(|shown| shown.as_ref()?.bar.as_ref()) {
            Some(bar) => bar.suspend(|| to_stderr(&text)),
            None => to_stderr(&text),
        }
    }

    fn begin(&self, length: u64, style: &str, of: Work) {
        let now = Instant::now();
        if let Ok(mut shown) = self.shown.lock() {
            *shown = Some(Shown { bar: bar_on_terminal(length, style), begun: now, last: now, of });
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
        match (&mut self.of, event) {
            (Work::Packing { usual, first }, Event::Packing(progress)) => {
                let here = progress.steps - *first.get_or_insert(progress.steps);
                if let Some(bar) = &self.bar {
                    bar.set_message(packing_line(progress, *usual, here, seconds));
                } else if self.last.elapsed() >= BETWEEN_LINES {
                    self.last = Instant::now();
                    to_stderr(&(packing_line(progress, *usual, here, seconds) + "\n"));
                }
            }
            (Work::Walk { .. }, Event::Increment { replicate, run, increment, moving }) => {
                if let Some(bar) = &self.bar {
                    bar.set_message(increment_line(replicate, run, increment, moving));
                } else if self.last.elapsed() >= BETWEEN_INCREMENTS {
                    self.last = Instant::now();
                    to_stderr(&(increment_line(replicate, run, increment, moving) + "\n"));
                }
            }
            (Work::Walk { runs, .. }, Event::MoreRuns { runs: more }) => {
                *runs += more;
                self.bar.iter().for_each(|bar| bar.inc_length(more));
            }
            (Work::Walk { done, runs }, Event::RunDone) => {
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
    format!("replicate {replicate}, run {run}, increment {}: {} moving", count(increment), count(moving))
}

fn packing_begun(plan: &PackingPlan) -> String {
    format!(
        "packing {} grains ({}), friction {}: about {} steps\n",
        count(plan.compression.grains as u64),
        plain(&plan.name),
        plan.compression.friction,
        count(plan.usual_steps())
    )
}

/// How far a packing is, `here` of its steps done by this start of the program.
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
        count(progress.steps),
        progress.void_ratio,
        progress.pressure,
        progress.coordination,
        progress.unbalanced,
    )
}
