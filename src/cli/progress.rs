//! Progress on stderr: a bar on a terminal, plain lines otherwise.

use std::io::IsTerminal;
use std::sync::Mutex;
use std::time::{Duration, Instant};

use indicatif::{ProgressBar, ProgressStyle};

use super::print::{count, to_stderr};
use crate::run::replicates::Event;

/// Plain lines come at most this often.
const BETWEEN_LINES: Duration = Duration::from_secs(5);

/// Shows how far the work is.
pub enum Progress {
    /// Says nothing.
    Quiet,
    /// A bar.
    Bar(ProgressBar),
    /// Lines.
    Lines {
        /// Runs done, runs to walk, and when the last line was printed.
        done: Mutex<(u64, u64, Instant)>,
        /// When the work began.
        begun: Instant,
    },
}

impl Progress {
    /// Progress over `runs` runs.
    pub fn new(quiet: bool, runs: u64) -> Self {
        if quiet {
            return Self::Quiet;
        }
        if std::io::stderr().is_terminal() {
            let bar = ProgressBar::new(runs);
            let style = "{bar:30} {pos}/{len} runs, {elapsed} gone, about {eta} to go  {msg}";
            bar.set_style(
                ProgressStyle::with_template(style).unwrap_or_else(|_| ProgressStyle::default_bar()),
            );
            bar.enable_steady_tick(Duration::from_millis(200));
            return Self::Bar(bar);
        }
        let now = Instant::now();
        Self::Lines { done: Mutex::new((0, runs, now)), begun: now }
    }

    /// Takes an event of the walk.
    pub fn tell(&self, event: Event) {
        match (self, event) {
            (Self::Quiet, _) => {}
            (Self::Bar(bar), Event::Run) => bar.inc(1),
            (Self::Bar(bar), Event::Increment { replicate, run, increment, moving }) => {
                bar.set_message(format!(
                    "replicate {replicate}, run {run}, increment {increment}: {} moving",
                    count(moving)
                ));
            }
            (Self::Bar(bar), Event::More { runs }) => bar.inc_length(runs),
            (Self::Lines { .. }, Event::Increment { .. }) => {}
            (Self::Lines { done, .. }, Event::More { runs }) => {
                if let Ok(mut done) = done.lock() {
                    done.1 += runs;
                }
            }
            (Self::Lines { done, begun }, Event::Run) => {
                let Ok(mut done) = done.lock() else { return };
                done.0 += 1;
                let (walked, runs, last) = *done;
                if walked == runs || last.elapsed() >= BETWEEN_LINES {
                    done.2 = Instant::now();
                    let gone = begun.elapsed().as_secs_f64();
                    let left = gone / walked as f64 * runs.saturating_sub(walked) as f64;
                    to_stderr(&format!(
                        "{walked} of {runs} runs, {gone:.0} s gone, about {left:.0} s to go\n"
                    ));
                }
            }
        }
    }

    /// Clears the bar.
    pub fn finish(&self) {
        if let Self::Bar(bar) = self {
            bar.finish_and_clear();
        }
    }
}
