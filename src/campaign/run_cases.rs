//! Walks the cases of a plan that are not done, each in a folder of its own, by as many processes as are at it.
//!
//! A case is claimed by the lock of its folder, which dies with its owner, and is done when the folder holds `case.json` with
//! the case's fingerprint. Nothing else is shared: what a process that is killed has not kept in checkpoints is lost, and
//! whoever comes next goes on from those.
//!
//! A case that cannot be walked stops no other: its folder says why in `problem.txt`, and the caller is told at the end.
//!
//! Where the locks of a shared folder reach one machine only, two processes may walk one case at the same time. Both write
//! the same bits, file by file under their final names, so that costs time and nothing else.

use std::collections::{BTreeMap, BTreeSet};
use std::io::ErrorKind;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::{Path, PathBuf};
use std::sync::Mutex;
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};
use std::time::{Duration, Instant, SystemTime};

use super::plan::PlannedCase;
use crate::case::Case;
use crate::outcome::ledger::{LedgerLine, Made};
use crate::run::checkpoints::{self, CheckpointInterval, Checkpoints};
use crate::run::machine::Machine;
use crate::run::replicates::{self, RunError, Watch};
use crate::run::results::{self, ResultError};
use crate::store::{Folder, StoreError, make_folder, read_whole};
use crate::walk::WalkError;

/// A finished case.
const LINE: &str = "case.json";

/// Folder of the cases, inside the campaign's.
const CASES: &str = "cases";

/// Why a case could not be walked, where it was tried last.
const PROBLEM: &str = "problem.txt";

/// How often a process looks whether others are done: at first, and after some waiting.
const LOOK: (Duration, Duration) = (Duration::from_millis(300), Duration::from_secs(10));

/// How often results that could not be written are tried again.
const TRIES: u32 = 3;

/// A case of a plan, worked out.
pub struct PreparedCase<'a> {
    /// The case as planned.
    pub planned: &'a PlannedCase,
    /// The same with its files read.
    pub case: Case,
    /// Fingerprint of everything that its results follow from.
    pub fingerprint: String,
}

impl<'a> PreparedCase<'a> {
    /// A case with its fingerprint.
    pub fn new(planned: &'a PlannedCase, case: Case) -> Self {
        let fingerprint = case.fingerprint();
        Self { planned, case, fingerprint }
    }

    /// Folder of the results, inside the campaign's.
    pub fn folder(&self) -> PathBuf {
        Path::new(CASES).join(self.planned.folder_name())
    }

    /// The finished case, if these very results are there.
    pub fn line(&self, out: &Path) -> Option<LedgerLine> {
        self.read_line(out).ok().flatten()
    }

    /// The same; a file that is there and cannot be read is no case that is not done.
    ///
    /// # Errors
    /// What the system says.
    pub fn read_line(&self, out: &Path) -> Result<Option<LedgerLine>, StoreError> {
        let path = out.join(self.folder()).join(LINE);
        let bytes = match read_whole(&path) {
            Ok(bytes) => bytes,
            Err(error) if matches!(error.kind(), ErrorKind::NotFound | ErrorKind::NotADirectory) => {
                return Ok(None);
            }
            Err(source) => return Err(StoreError::Io { path, action: "read", source }),
        };
        let line: Option<LedgerLine> = serde_json::from_slice(&bytes).ok();
        Ok(line.filter(|line| line.fingerprint == self.fingerprint && line.case == self.planned.name))
    }
}

/// Why a case is not done.
#[derive(Debug, thiserror::Error)]
pub enum CaseProblem {
    /// It could not be walked.
    #[error(transparent)]
    Run(#[from] RunError),
    /// Its results could not be written.
    #[error(transparent)]
    Results(#[from] ResultError),
    /// Its folder.
    #[error(transparent)]
    Store(#[from] StoreError),
    /// What the caller does with a finished case failed.
    #[error("{0}")]
    Finish(String),
    /// Results that were written are gone.
    #[error(
        "its results were overwritten by another process; is another plan, or this one changed, at work on the folder?"
    )]
    Lost,
    /// The program went wrong.
    #[error("a fault of the program: {0}")]
    Fault(String),
}

/// A case that is not done, and why.
#[derive(Debug)]
pub struct Failed {
    /// The case.
    pub case: String,
    /// What went wrong.
    pub problem: String,
}

/// Why a campaign ended early.
#[derive(Debug, thiserror::Error)]
pub enum CampaignError {
    /// The folder of the cases.
    #[error(transparent)]
    Store(#[from] StoreError),
    /// No threads to be had.
    #[error(transparent)]
    Threads(#[from] rayon::ThreadPoolBuildError),
    /// Stopped on request; what is done is kept.
    #[error("stopped")]
    Stopped,
}

/// What a process says of a case.
#[derive(Clone, Copy, Debug)]
pub enum CaseEvent<'a> {
    /// It begins to walk it, or goes on from its checkpoints.
    Begun {
        /// Whether there are checkpoints.
        resumes: bool,
    },
    /// It is done.
    Done(&'a LedgerLine),
    /// It cannot be walked.
    Failed(&'a str),
    /// Another process is at it, and this one waits.
    Waiting,
}

/// Watches a campaign, and can stop it.
pub struct CampaignCallbacks<'a> {
    /// Told of every case that this process begins, has finished or waits for.
    pub tell: &'a (dyn Fn(&str, CaseEvent) + Sync),
    /// Called with the folder of a case whose results are written, before it counts as done.
    pub finish: &'a (dyn Fn(&Path) -> Result<(), String> + Sync),
    /// Set to stop after the current increments.
    pub stop: &'a AtomicBool,
    /// How often a case that is being walked is kept.
    pub keep_every: CheckpointInterval,
    /// Job and task of a cluster.
    pub job: Option<String>,
    /// The command line.
    pub command: String,
}

/// Walks every case that is not done, and waits for those that other processes are at; gives those that cannot be walked.
///
/// # Errors
/// What concerns all cases; those that are done stay done.
pub fn run_cases(
    cases: &[PreparedCase],
    out: &Path,
    threads: usize,
    overseer: &CampaignCallbacks,
) -> Result<Vec<Failed>, CampaignError> {
    make_folder(&out.join(CASES))?;
    let (done, mut open): (Vec<&PreparedCase>, Vec<&PreparedCase>) =
        cases.iter().partition(|case| case.line(out).is_some());
    for case in done {
        // A process that was killed as soon as the case was done left them.
        checkpoints::discard(&out.join(case.folder()))?;
    }
    let tally = Tally::default();
    let mut look = LOOK.0;
    while !open.is_empty() {
        let (before, told) = (open.len(), tally.waited());
        pass(&open, out, threads, overseer, &tally)?;
        // A case that this process has finished and that is not there any more was overwritten: by another plan, or by a
        // plan that was changed meanwhile.
        open.retain(|case| case.line(out).is_none());
        let lost = open.iter().filter(|case| tally.has_finished(&case.planned.name));
        lost.for_each(|case| tally.fail(overseer, &case.planned.name, &CaseProblem::Lost));
        open.retain(|case| !tally.has_failed(&case.planned.name));
        if overseer.stop.load(Ordering::Relaxed) && !open.is_empty() {
            return Err(CampaignError::Stopped);
        }
        if tally.waited() > told && open.len() == before {
            let until = Instant::now() + look;
            while Instant::now() < until && !overseer.stop.load(Ordering::Relaxed) {
                std::thread::sleep(LOOK.0);
            }
            look = (look * 2).min(LOOK.1);
        } else {
            look = LOOK.0;
        }
    }
    Ok(tally.failed.into_inner().unwrap_or_default())
}

/// What this process has done so far.
#[derive(Default)]
struct Tally {
    finished: Mutex<BTreeSet<String>>,
    failed: Mutex<Vec<Failed>>,
    waiting: Mutex<BTreeSet<String>>,
    waits: AtomicUsize,
    tries: Mutex<BTreeMap<String, u32>>,
}

impl Tally {
    fn has_finished(&self, name: &str) -> bool {
        self.finished.lock().is_ok_and(|names| names.contains(name))
    }

    fn has_failed(&self, name: &str) -> bool {
        self.failed.lock().is_ok_and(|all| all.iter().any(|failed| failed.case == name))
    }

    fn waited(&self) -> usize {
        self.waits.load(Ordering::Relaxed)
    }

    fn fail(&self, overseer: &CampaignCallbacks, name: &str, problem: &CaseProblem) {
        let problem = problem.to_string();
        (overseer.tell)(name, CaseEvent::Failed(&problem));
        if let Ok(mut failed) = self.failed.lock() {
            failed.push(Failed { case: name.to_owned(), problem });
        }
    }

    /// Whether results that could not be written may be tried again: where locks reach one machine only, another process may have
    /// been replacing the same files. What was walked is not walked again.
    fn may_try_again(&self, name: &str) -> bool {
        self.waits.fetch_add(1, Ordering::Relaxed);
        let Ok(mut tries) = self.tries.lock() else { return false };
        let tries = tries.entry(name.to_owned()).or_default();
        *tries += 1;
        *tries <= TRIES
    }

    /// Another process is at the case; said once.
    fn wait(&self, overseer: &CampaignCallbacks, name: &str) {
        self.waits.fetch_add(1, Ordering::Relaxed);
        if self.waiting.lock().is_ok_and(|mut names| names.insert(name.to_owned())) {
            (overseer.tell)(name, CaseEvent::Waiting);
        }
    }
}

/// Tries each case once.
fn pass(
    open: &[&PreparedCase],
    out: &Path,
    threads: usize,
    overseer: &CampaignCallbacks,
    tally: &Tally,
) -> Result<(), CampaignError> {
    let next = AtomicUsize::new(0);
    let side_by_side = side_by_side(open, threads);
    let share = (threads / side_by_side).max(1);
    let work = || -> Result<(), CampaignError> {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(share).build()?;
        while !overseer.stop.load(Ordering::Relaxed) {
            let Some(case) = open.get(next.fetch_add(1, Ordering::Relaxed)) else { return Ok(()) };
            let name = &case.planned.name;
            // A fault in one case is no fault of the others.
            let walked = catch_unwind(AssertUnwindSafe(|| pool.install(|| one(case, out, share, overseer))));
            match walked.unwrap_or_else(|panic| Err(CaseProblem::Fault(message(&*panic)))) {
                Err(CaseProblem::Store(StoreError::Held { .. })) => tally.wait(overseer, name),
                Err(CaseProblem::Results(_) | CaseProblem::Finish(_) | CaseProblem::Store(_))
                    if tally.may_try_again(name) => {}
                Err(problem) => tally.fail(overseer, name, &problem),
                Ok(true) => drop(tally.finished.lock().map(|mut names| names.insert(name.clone()))),
                Ok(false) => {}
            }
        }
        Ok(())
    };
    std::thread::scope(|scope| {
        let workers: Vec<_> = (0..side_by_side).map(|_| scope.spawn(work)).collect();
        workers.into_iter().try_for_each(|worker| worker.join().unwrap_or(Ok(())))
    })
}

/// What a panic says.
fn message(panic: &(dyn std::any::Any + Send)) -> String {
    let text = panic.downcast_ref::<String>().map(String::as_str);
    text.or(panic.downcast_ref::<&str>().copied()).unwrap_or("it does not say which").to_owned()
}

/// Cases walked at the same time: as many as there are threads that one case's replicates would leave idle.
fn side_by_side(open: &[&PreparedCase], threads: usize) -> usize {
    let fewest = open.iter().map(|ready| ready.case.scene.walk.replicates).min().unwrap_or(1).max(1) as usize;
    let wanted = threads.div_ceil(fewest).clamp(1, open.len().max(1));
    let largest = open.iter().map(|ready| ready.case.peak_bytes(threads as u64)).max().unwrap_or(0);
    let allowed = open.iter().map(|ready| ready.case.memory).min().unwrap_or(u64::MAX);
    let room = allowed.min(Machine::here().available / 2) / largest.max(1);
    wanted.min(usize::try_from(room).unwrap_or(usize::MAX).max(1))
}

/// Claims one case and walks it into its folder; says whether it was this process that finished it.
fn one(
    ready: &PreparedCase,
    out: &Path,
    threads: usize,
    overseer: &CampaignCallbacks,
) -> Result<bool, CaseProblem> {
    let folder = Folder::open(&out.join(ready.folder()))?;
    // Opening the list of its files asks a server anew, which an open of one file that was missing before may not.
    drop(std::fs::read_dir(folder.path()));
    folder.remove(PROBLEM)?;
    // Another process may have finished it since the list was made.
    if ready.line(out).is_some() {
        return Ok(false);
    }
    match walk(ready, out, &folder, threads, overseer) {
        // Where locks reach one machine only, another may have finished it and taken the checkpoints away.
        Err(_) if ready.line(out).is_some() => {
            checkpoints::discard(folder.path())?;
            Ok(false)
        }
        Err(problem) => {
            // What cannot be written here is told all the same.
            let _ = folder.write(PROBLEM, format!("{problem}\n").as_bytes());
            Err(problem)
        }
        walked => walked,
    }
}

fn walk(
    ready: &PreparedCase,
    out: &Path,
    folder: &Folder,
    threads: usize,
    overseer: &CampaignCallbacks,
) -> Result<bool, CaseProblem> {
    let name = &ready.planned.name;
    let resumes = Checkpoints::is_in(folder.path())?;
    (overseer.tell)(name, CaseEvent::Begun { resumes });
    let (begun, started) = (Instant::now(), SystemTime::now());
    let keeper = Checkpoints::new(folder, &ready.fingerprint, overseer.keep_every)?;
    let watch = Watch { tell: &|_| {}, stop: overseer.stop, keeper: Some(&keeper) };
    let walked = replicates::replicates(&ready.case, &watch)
        .and_then(|walked| Ok((replicates::sensitivity(&ready.case, &watch)?, walked)));
    let (sensitivity, walked) = match walked {
        Err(RunError::Walk(WalkError::Stopped { .. })) => {
            keeper.flush()?;
            return Ok(false);
        }
        // Checkpoints of what the case was before the plan was changed, or corrupt ones: it is walked from its start.
        Err(RunError::Checkpoint(error)) if !error.is_unreadable() => {
            keeper.clear()?;
            return Ok(false);
        }
        other => other?,
    };
    if ready.line(out).is_some() {
        keeper.clear()?;
        return Ok(false);
    }
    let seconds = begun.elapsed().as_secs_f64();
    let outcome = results::outcome(&ready.case, &walked, sensitivity, seconds);
    let manifest = results::manifest(&ready.case, threads as u64, started, overseer.command.clone());
    folder.remove(LINE)?;
    results::write(folder, &ready.case, &outcome, &walked, &manifest)?;
    (overseer.finish)(folder.path()).map_err(CaseProblem::Finish)?;
    let made = Made {
        host: manifest.host,
        threads: threads as u64,
        job: overseer.job.clone(),
        started: manifest.started,
        seconds,
    };
    let place = ready.folder().display().to_string();
    let line = LedgerLine::new(name, &ready.planned.levels, place, ready.fingerprint.clone(), &outcome, made);
    let text = results::json(LINE, &line)?;
    folder.write(LINE, &text)?;
    keeper.clear()?;
    (overseer.tell)(name, CaseEvent::Done(&line));
    Ok(true)
}

/// What is known of a case that is not done.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum State {
    /// Nobody has begun it.
    NotBegun,
    /// A process is at it.
    Walking(String),
    /// It was stopped or killed; the next start goes on from its checkpoints.
    Kept,
    /// It could not be walked.
    Failed(String),
}

impl State {
    /// Looks into the case's folder.
    pub fn of(ready: &PreparedCase, out: &Path) -> Self {
        let path = out.join(ready.folder());
        if path.symlink_metadata().is_err() {
            return Self::NotBegun;
        }
        match Folder::open(&path) {
            Err(StoreError::Held { holder, .. }) => Self::Walking(holder),
            Err(other) => Self::Failed(other.to_string()),
            Ok(folder) => match folder.read(PROBLEM) {
                Ok(Some(text)) => Self::Failed(String::from_utf8_lossy(&text).trim_end().to_owned()),
                _ => match Checkpoints::is_in(folder.path()) {
                    Ok(true) => Self::Kept,
                    Ok(false) => Self::NotBegun,
                    Err(error) => Self::Failed(error.to_string()),
                },
            },
        }
    }
}
