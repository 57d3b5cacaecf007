//! Walks the cases of a plan that are not done, each in a folder of its own, by as many processes as are at it.
//!
//! A case is claimed by the lock of its folder, which dies with its owner, and is done when the folder holds `case.json` with
//! the case's fingerprint. Nothing else is shared: a process that is killed loses the case it was at, and whoever comes
//! next walks that one again.

use std::collections::BTreeSet;
use std::path::{Path, PathBuf};
use std::sync::Mutex;
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};
use std::time::{Duration, Instant, SystemTime};

use super::case::Case;
use super::keeper::Keeper;
use super::machine::Machine;
use super::plan::PlannedCase;
use super::results::{self, ResultError};
use super::walks::{self, RunError, Watch};
use crate::outcome::ledger::{LedgerLine, Made};
use crate::store::{Folder, StoreError, make_folder};
use crate::walk::WalkError;

/// A finished case.
const LINE: &str = "case.json";

/// Folder of the cases, inside the campaign's.
const CASES: &str = "cases";

/// How often a process looks whether others are done.
const LOOK: Duration = Duration::from_millis(300);

/// A case of a plan, worked out.
pub struct Ready<'a> {
    /// The case as planned.
    pub planned: &'a PlannedCase,
    /// The same with its files read.
    pub case: Case,
    /// Fingerprint of everything that its results follow from.
    pub fingerprint: String,
}

impl<'a> Ready<'a> {
    /// A case with its fingerprint.
    pub fn new(planned: &'a PlannedCase, case: Case) -> Self {
        let fingerprint = results::fingerprint(&case);
        Self { planned, case, fingerprint }
    }

    /// Folder of the results, inside the campaign's.
    pub fn folder(&self) -> PathBuf {
        Path::new(CASES).join(self.planned.folder_name())
    }

    /// The finished case, if these very results are there.
    pub fn line(&self, out: &Path) -> Option<LedgerLine> {
        let bytes = std::fs::read(out.join(self.folder()).join(LINE)).ok()?;
        let line: LedgerLine = serde_json::from_slice(&bytes).ok()?;
        (line.fingerprint == self.fingerprint && line.case == self.planned.name).then_some(line)
    }
}

/// Why a campaign ended early.
#[derive(Debug, thiserror::Error)]
pub enum ConductError {
    /// A case could not be walked.
    #[error("case {case}: {source}")]
    Run {
        /// The case.
        case: String,
        /// What went wrong.
        source: Box<RunError>,
    },
    /// A case's results could not be written.
    #[error("case {case}: {source}")]
    Results {
        /// The case.
        case: String,
        /// What went wrong.
        source: Box<ResultError>,
    },
    /// A case's folder.
    #[error(transparent)]
    Store(#[from] StoreError),
    /// No threads to be had.
    #[error(transparent)]
    Threads(#[from] rayon::ThreadPoolBuildError),
    /// What the caller does with a finished case failed.
    #[error("case {case}: {problem}")]
    Finish {
        /// The case.
        case: String,
        /// What went wrong.
        problem: String,
    },
    /// Results that were written are gone.
    #[error(
        "case {case}: its results were overwritten by another process; is another plan, or this one changed, at work on the folder?"
    )]
    Lost {
        /// The case.
        case: String,
    },
    /// Stopped on request; what is done is kept.
    #[error("stopped")]
    Stopped,
}

/// Watches a campaign, and can stop it.
pub struct Overseer<'a> {
    /// Told of every case that this process begins (`None`) or has finished.
    pub tell: &'a (dyn Fn(&str, Option<&LedgerLine>) + Sync),
    /// Called with the folder of a case whose results are written, before it counts as done.
    pub finish: &'a (dyn Fn(&Path) -> Result<(), String> + Sync),
    /// Set to stop after the current increments.
    pub stop: &'a AtomicBool,
    /// How often a case that is being walked is kept.
    pub keep_every: Duration,
    /// Job and task of a cluster.
    pub job: Option<String>,
    /// The command line.
    pub command: String,
}

/// Walks every case that is not done, and waits for those that other processes are at.
///
/// # Errors
/// The first that goes wrong; cases that are done stay done.
pub fn conduct(cases: &[Ready], out: &Path, threads: usize, overseer: &Overseer) -> Result<(), ConductError> {
    make_folder(&out.join(CASES))?;
    let mut open: Vec<&Ready> = cases.iter().filter(|case| case.line(out).is_none()).collect();
    let finished = Mutex::new(BTreeSet::new());
    while !open.is_empty() {
        let busy = pass(&open, out, threads, overseer, &finished)?;
        if overseer.stop.load(Ordering::Relaxed) {
            return Err(ConductError::Stopped);
        }
        open.retain(|case| case.line(out).is_none());
        // A case that this process has finished and that is not there any more was overwritten: by another plan, or by a
        // plan that was changed meanwhile.
        let ours = finished.lock().map(|names| names.clone()).unwrap_or_default();
        if let Some(lost) = open.iter().find(|case| ours.contains(&case.planned.name)) {
            return Err(ConductError::Lost { case: lost.planned.name.clone() });
        }
        if busy && !open.is_empty() {
            std::thread::sleep(LOOK);
        }
    }
    Ok(())
}

/// Tries each case once; says whether others were at some.
fn pass(
    open: &[&Ready],
    out: &Path,
    threads: usize,
    overseer: &Overseer,
    finished: &Mutex<BTreeSet<String>>,
) -> Result<bool, ConductError> {
    let (next, busy) = (AtomicUsize::new(0), AtomicBool::new(false));
    let failed: Mutex<Option<ConductError>> = Mutex::new(None);
    let side_by_side = side_by_side(open, threads);
    let share = (threads / side_by_side).max(1);
    let work = || -> Result<(), ConductError> {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(share).build()?;
        let has_failed = || failed.lock().is_ok_and(|f| f.is_some());
        while !overseer.stop.load(Ordering::Relaxed) && !has_failed() {
            let Some(case) = open.get(next.fetch_add(1, Ordering::Relaxed)) else { return Ok(()) };
            match pool.install(|| one(case, out, share, overseer)) {
                Err(ConductError::Store(StoreError::Held { .. })) => busy.store(true, Ordering::Relaxed),
                Ok(true) => {
                    if let Ok(mut names) = finished.lock() {
                        names.insert(case.planned.name.clone());
                    }
                }
                other => drop(other?),
            }
        }
        Ok(())
    };
    std::thread::scope(|scope| {
        for _ in 0..side_by_side {
            scope.spawn(|| {
                if let Err(error) = work()
                    && let Ok(mut failed) = failed.lock()
                {
                    failed.get_or_insert(error);
                }
            });
        }
    });
    match failed.into_inner() {
        Ok(Some(error)) => Err(error),
        _ => Ok(busy.into_inner()),
    }
}

/// Cases walked at the same time: as many as there are threads that one case's replicates would leave idle.
fn side_by_side(open: &[&Ready], threads: usize) -> usize {
    let fewest = open.iter().map(|ready| ready.case.scene.replicates).min().unwrap_or(1).max(1) as usize;
    let wanted = threads.div_ceil(fewest).clamp(1, open.len().max(1));
    let largest = open.iter().map(|ready| ready.case.peak_bytes(threads as u64)).max().unwrap_or(0);
    let room = Machine::here().available / 2 / largest.max(1);
    wanted.min(usize::try_from(room).unwrap_or(usize::MAX).max(1))
}

/// Walks one case into its folder; says whether it was this process that finished it.
fn one(ready: &Ready, out: &Path, threads: usize, overseer: &Overseer) -> Result<bool, ConductError> {
    let folder = Folder::open(&out.join(ready.folder()))?;
    // Another process may have finished it since the list was made.
    if ready.line(out).is_some() {
        return Ok(false);
    }
    let name = &ready.planned.name;
    (overseer.tell)(name, None);
    let (begun, started) = (Instant::now(), SystemTime::now());
    let failed = |source: ResultError| ConductError::Results { case: name.clone(), source: source.into() };
    let keeper = Keeper::new(&folder, &ready.fingerprint, overseer.keep_every)?;
    let watch = Watch { tell: &|_| {}, stop: overseer.stop, keeper: Some(&keeper) };
    let walked = walks::replicates(&ready.case, &watch)
        .and_then(|walked| Ok((walks::sensitivity(&ready.case, &watch)?, walked)));
    let (sensitivity, walked) = match walked {
        Err(RunError::Walk(WalkError::Stopped { .. })) => {
            keeper.flush()?;
            return Ok(false);
        }
        // Checkpoints of what the case was before the plan was changed, or harmed ones: it is walked from its start.
        Err(RunError::Harmed(_)) => {
            keeper.clear()?;
            return Ok(false);
        }
        Err(source) => return Err(ConductError::Run { case: name.clone(), source: source.into() }),
        Ok(both) => both,
    };
    let seconds = begun.elapsed().as_secs_f64();
    let outcome = results::outcome(&ready.case, &walked, sensitivity, seconds);
    let manifest = results::manifest(&ready.case, threads as u64, started, overseer.command.clone());
    folder.remove(LINE)?;
    results::write(&folder, &ready.case, &outcome, &walked, &manifest).map_err(failed)?;
    (overseer.finish)(folder.path())
        .map_err(|problem| ConductError::Finish { case: name.clone(), problem })?;
    let made = Made {
        host: manifest.host,
        threads: threads as u64,
        job: overseer.job.clone(),
        started: manifest.started,
        seconds,
    };
    let place = ready.folder().display().to_string();
    let line = LedgerLine::new(name, &ready.planned.levels, place, ready.fingerprint.clone(), &outcome, made);
    let text = results::json(LINE, &line).map_err(failed)?;
    folder.write(LINE, &text)?;
    keeper.clear()?;
    (overseer.tell)(name, Some(&line));
    Ok(true)
}
