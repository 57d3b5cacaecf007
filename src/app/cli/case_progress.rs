//! Messages while a campaign is walked: a bar on a terminal, plain lines elsewhere.

use std::sync::{Mutex, OnceLock};
use std::time::{Duration, Instant};

use indicatif::ProgressBar;

use super::print::{plain, to_stderr};
use super::progress::{bar_on_terminal, followed};
use crate::cases::{CaseCallbacks, CaseEvent};
use crate::run::RunError;

/// Plain lines come at most this often, outside of a cluster's job.
const BETWEEN_LINES: Duration = Duration::from_secs(2);

/// After this long without a message, the progress of a case is reported.
const BETWEEN_RUNS: Duration = Duration::from_secs(5);

/// Progress over cases.
pub struct CaseProgress {
    quiet: bool,
    /// True if every event of a case has a line, as in the log of a job.
    every_event: bool,
    /// Known as soon as the cases are counted.
    shown: OnceLock<(Option<ProgressBar>, Mutex<Lines>)>,
}

/// Cases done, when this process began and now, of how many.
struct Lines {
    first: usize,
    done: usize,
    total: usize,
    begun: Instant,
    last: Instant,
}

impl CaseProgress {
    pub fn new(quiet: bool, every_event: bool) -> Self {
        Self { quiet, every_event, shown: OnceLock::new() }
    }

    /// Follows the work on cases, until it ends.
    ///
    /// # Errors
    /// Errors of the work.
    pub fn followed<R>(
        &self,
        work: impl FnOnce(&CaseCallbacks) -> Result<R, RunError>,
    ) -> Result<R, RunError> {
        followed(self.quiet, |run| {
            let callbacks = CaseCallbacks {
                run: *run,
                on_cases: &|total, done| self.begin(total, done),
                on_case: &|case, event| self.tell(case, event),
            };
            let done = work(&callbacks);
            self.end();
            done
        })
    }

    /// Begins the display with `total` cases, of which `done` are done.
    pub fn begin(&self, total: usize, done: usize) {
        if self.quiet {
            return;
        }
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
        let _ = self.shown.set((bar, Mutex::new(lines)));
    }

    pub fn tell(&self, case: &str, event: CaseEvent) {
        let Some((bar, lines)) = self.shown.get() else { return };
        let case = plain(case);
        match (bar, event) {
            (Some(bar), CaseEvent::Begun { .. }) => bar.set_message(case),
            (Some(bar), CaseEvent::Waiting) => bar.set_message(format!("waiting for {case}")),
            (Some(bar), CaseEvent::Walked { done, runs }) => {
                bar.set_message(format!("{case}: {done} of {runs} runs"));
            }
            (Some(bar), CaseEvent::Done(_)) => bar.inc(1),
            (Some(bar), CaseEvent::Failed(problem)) => {
                bar.suspend(|| to_stderr(&format!("failed: {case}: {}\n", plain(problem))));
            }
            (None, CaseEvent::Failed(problem)) => {
                to_stderr(&format!("failed: {case}: {}\n", plain(problem)));
            }
            (None, CaseEvent::Begun { resumes }) if self.every_event => {
                to_stderr(&format!("{}: {case}\n", if resumes { "continues" } else { "begins" }));
            }
            (None, CaseEvent::Waiting) if self.every_event => {
                to_stderr(&format!("waits: {case}: another process is at it\n"));
            }
            (None, CaseEvent::Walked { done, runs }) if !self.every_event => {
                let Ok(mut lines) = lines.lock() else { return };
                if lines.last.elapsed() >= BETWEEN_RUNS {
                    lines.last = Instant::now();
                    to_stderr(&format!("{case}: {done} of {runs} runs\n"));
                }
            }
            (None, CaseEvent::Begun { .. } | CaseEvent::Waiting | CaseEvent::Walked { .. }) => {}
            (None, CaseEvent::Done(line)) => {
                let Ok(mut lines) = lines.lock() else { return };
                lines.done += 1;
                if !self.every_event && lines.done < lines.total && lines.last.elapsed() < BETWEEN_LINES {
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
        }
    }

    pub fn end(&self) {
        if let Some((Some(bar), _)) = self.shown.get() {
            bar.finish_and_clear();
        }
    }
}
