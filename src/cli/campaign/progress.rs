//! What is said while a campaign is walked: a bar on a terminal, plain lines elsewhere.

use std::io::IsTerminal;
use std::path::Path;
use std::sync::Mutex;
use std::time::{Duration, Instant};

use indicatif::{ProgressBar, ProgressStyle};

use crate::campaign::run_cases::{CaseEvent, PreparedCase};
use crate::cli::print::{plain, to_stderr};

/// Plain lines come at most this often, outside of a cluster's job.
const BETWEEN_LINES: Duration = Duration::from_secs(2);

/// Progress over cases.
pub enum Progress {
    Quiet,
    Bar(ProgressBar),
    Lines { total: usize, begun: Instant, done: Mutex<(usize, usize, Instant)>, each: bool },
}

impl Progress {
    /// `each`: a line for everything that happens to a case, as the log of a job should have it.
    pub fn new(quiet: bool, cases: &[PreparedCase], out: &Path, each: bool) -> Self {
        if quiet {
            return Self::Quiet;
        }
        let (total, done) = (cases.len(), cases.iter().filter(|case| case.line(out).is_some()).count());
        if done > 0 {
            to_stderr(&format!("{done} of {total} cases are done already\n"));
        }
        if std::io::stderr().is_terminal() {
            let bar = ProgressBar::new(total as u64);
            let style = "{bar:30} {pos}/{len} cases, {elapsed} gone, about {eta} to go  {msg}";
            bar.set_style(
                ProgressStyle::with_template(style).unwrap_or_else(|_| ProgressStyle::default_bar()),
            );
            bar.set_position(done as u64);
            bar.reset_eta();
            bar.enable_steady_tick(Duration::from_millis(200));
            return Self::Bar(bar);
        }
        let now = Instant::now();
        Self::Lines { total, begun: now, done: Mutex::new((done, done, now)), each }
    }

    pub fn tell(&self, case: &str, news: CaseEvent) {
        let case = plain(case);
        match (self, news) {
            (Self::Quiet, _) => {}
            (Self::Bar(bar), CaseEvent::Begun { .. }) => bar.set_message(case),
            (Self::Bar(bar), CaseEvent::Waiting) => bar.set_message(format!("waiting for {case}")),
            (Self::Bar(bar), CaseEvent::Done(_)) => bar.inc(1),
            (Self::Bar(bar), CaseEvent::Failed(problem)) => {
                bar.suspend(|| to_stderr(&format!("failed: {case}: {}\n", plain(problem))));
            }
            (Self::Lines { .. }, CaseEvent::Failed(problem)) => {
                to_stderr(&format!("failed: {case}: {}\n", plain(problem)));
            }
            (Self::Lines { each, .. }, CaseEvent::Begun { resumes }) => {
                if *each {
                    to_stderr(&format!("{}: {case}\n", if resumes { "goes on" } else { "begins" }));
                }
            }
            (Self::Lines { each, .. }, CaseEvent::Waiting) => {
                if *each {
                    to_stderr(&format!("waits: {case}: another process is at it\n"));
                }
            }
            (Self::Lines { total, begun, done, each }, CaseEvent::Done(line)) => {
                let Ok(mut done) = done.lock() else { return };
                done.1 += 1;
                if !each && done.1 < *total && done.2.elapsed() < BETWEEN_LINES {
                    return;
                }
                done.2 = Instant::now();
                let gone = begun.elapsed().as_secs_f64();
                let left = gone / (done.1 - done.0) as f64 * total.saturating_sub(done.1) as f64;
                to_stderr(&format!(
                    "{} of {total} cases, {gone:.0} s gone, about {left:.0} s to go; {case}: {}\n",
                    done.1,
                    line.verdict.words()
                ));
            }
        }
    }

    pub fn finish(&self) {
        if let Self::Bar(bar) = self {
            bar.finish_and_clear();
        }
    }
}
