//! Walks the unfinished cases of a plan, each in a folder of its own, by any number of processes.
//!
//! A case is claimed by the lock of its folder, which ends with its owner. It is done when the folder holds
//! `case.json` with the case's fingerprint. Nothing else is shared: if a process is killed, the work since
//! its last checkpoint is lost, and the next process continues from there.
//!
//! A case that cannot be walked stops no other: `problem.txt` in its folder gives the reason, and the caller
//! is told at the end.
//!
//! If locks of a shared folder do not work across machines, two processes may walk one case at the same time.
//! Both write the same bits, file by file under their final names, so only time is lost.

use std::collections::{BTreeMap, BTreeSet};
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::Path;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::{Mutex, MutexGuard, PoisonError};
use std::time::{Duration, Instant, SystemTime};

use super::prepared::{CASES, FailedCase, LINE, PROBLEM, PreparedCase};
use crate::case::Case;
use crate::outcome::ledger::{LedgerLine, Made};
use crate::run::callbacks::{Callbacks, Event};
use crate::run::case_walks::{CaseWalks, Studies};
use crate::run::checkpoints::{self, CheckpointInterval, Checkpoints};
use crate::run::folder::{FolderKind, clear, shown};
use crate::run::machine::{CasesAtOnce, on_each};
use crate::run::replicates::{self, ReplicateContext};
use crate::run::shared_networks::SharedNetworks;
use crate::run::{Exit, RunError, results};
use voidwalk_core::store::{Folder, StoreError, format, make_folder};

pub(super) const LOST: &str = "its results were overwritten by another process; is another plan, or this \
    one changed, at work on the folder?";

/// Interval between checks for finished cases of other processes: at first, and after some waiting.
const LOOK: (Duration, Duration) = (Duration::from_millis(300), Duration::from_secs(10));

/// Time in which another process may replace the files of a case with identical ones.
const REPLACING: Duration = Duration::from_secs(5);

const TRIES: u32 = 3;

/// Event of a case in a process.
#[derive(Clone, Copy, Debug)]
pub enum CaseEvent<'a> {
    /// This process begins the case, or continues it from its checkpoints.
    Begun {
        /// True if it continues from checkpoints.
        resumes: bool,
    },
    /// A run of the case is done.
    Walked {
        /// Number of runs done.
        done: u64,
        /// Runs to walk, as far as is known.
        runs: u64,
    },
    /// The case is done.
    Done(&'a LedgerLine),
    /// The case cannot be walked.
    Failed(&'a str),
    /// Another process works on the case, and this one waits.
    Waiting,
}

/// Callbacks by which a caller follows a campaign and stops it.
#[derive(Clone, Copy)]
pub struct CaseCallbacks<'a> {
    /// Follow packings, stop the campaign and receive finished results; walks of single cases are reported to
    /// `on_case`.
    pub run: Callbacks<'a>,
    /// Receives, before the first walk, the number of cases and the number of those already done.
    pub on_cases: &'a (dyn Fn(usize, usize) + Sync),
    /// Receives events of every case that this process begins, walks, finishes or waits for.
    pub on_case: &'a (dyn Fn(&str, CaseEvent) + Sync),
}

impl Default for CaseCallbacks<'_> {
    fn default() -> Self {
        Self { run: Callbacks::default(), on_cases: &|_, _| {}, on_case: &|_, _| {} }
    }
}

pub(super) struct CaseRunner<'a> {
    pub(crate) out: &'a Path,
    pub(crate) threads: usize,
    pub(crate) callbacks: &'a CaseCallbacks<'a>,
    pub(crate) checkpoint_interval: CheckpointInterval,
    pub(crate) networks: Option<SharedNetworks>,
    pub(crate) job: Option<String>,
    /// Command in a case's `manifest.json` that started it.
    pub(crate) command: String,
}

impl CaseRunner<'_> {
    /// Walks every unfinished case, and waits for those of other processes; returns those that cannot be
    /// walked. Fails only for reasons that concern all cases; finished ones stay finished.
    pub(crate) fn run(&self, cases: &[PreparedCase]) -> Result<Vec<FailedCase>, RunError> {
        make_folder(&self.out.join(CASES))?;
        let (done, mut open): (Vec<&PreparedCase>, Vec<&PreparedCase>) =
            cases.iter().partition(|case| self.is_done(case));
        for case in done {
            // They are left over if a process was killed as soon as the case was done.
            checkpoints::discard(&self.out.join(case.folder()))?;
        }
        let tally = Tally::default();
        let mut look = LOOK.0;
        while !open.is_empty() {
            let (before, told) = (open.len(), tally.locked().waits);
            self.pass(&open, &tally)?;
            // A case that this process finished and that has disappeared was overwritten, by another plan or
            // by a plan that was changed meanwhile.
            open.retain(|case| !self.is_done(case));
            for case in &open {
                let name = &case.planned.name;
                if tally.locked().finished.contains(name) && self.is_lost(case) {
                    tally.fail(self.callbacks, name, LOST.into());
                }
            }
            let has_failed = |name: &str| tally.locked().failed.iter().any(|failed| failed.case == name);
            open.retain(|case| !has_failed(&case.planned.name) && !self.is_done(case));
            if self.is_stopped() && !open.is_empty() {
                return Err(RunError::Stopped(format!(
                    "progress saved; continue with the same command on {}",
                    shown(self.out)
                )));
            }
            if tally.locked().waits > told && open.len() == before {
                let until = Instant::now() + look;
                while Instant::now() < until && !self.is_stopped() {
                    std::thread::sleep(LOOK.0);
                }
                look = (look * 2).min(LOOK.1);
            } else {
                look = LOOK.0;
            }
        }
        Ok(std::mem::take(&mut tally.locked().failed))
    }

    /// True if a finished case stays missing: without locks across machines, another process may just be
    /// replacing its files with identical ones.
    pub(super) fn is_lost(&self, case: &PreparedCase) -> bool {
        let until = Instant::now() + REPLACING;
        while !self.is_done(case) {
            if Instant::now() >= until {
                return true;
            }
            std::thread::sleep(LOOK.0);
        }
        false
    }

    fn is_done(&self, case: &PreparedCase) -> bool {
        case.line(self.out).is_some()
    }

    fn is_stopped(&self) -> bool {
        self.callbacks.run.is_stopped()
    }

    fn warn(&self, name: &str, problem: &str) {
        (self.callbacks.run.warn)(&format!("case {name}: {problem}"));
    }

    fn pass(&self, open: &[&PreparedCase], tally: &Tally) -> Result<(), RunError> {
        let next = AtomicUsize::new(0);
        // One pool serves all cases: if one leaves a thread idle, another has work for it. A thread blocked
        // in rayon may meanwhile start another whole case: never hold a mutex, wait for a file lock or borrow
        // a thread's local data across a rayon call.
        let pool = rayon::ThreadPoolBuilder::new().num_threads(self.threads).build()?;
        let work = || -> Result<(), RunError> {
            while !self.is_stopped() {
                let Some(case) = open.get(next.fetch_add(1, Ordering::Relaxed)) else { return Ok(()) };
                let name = &case.planned.name;
                // A fault in one case must not stop the others.
                let walked = catch_unwind(AssertUnwindSafe(|| pool.install(|| self.one(case))));
                match walked.unwrap_or_else(|panic| Err(fault(&*panic))) {
                    Err(RunError::Store(StoreError::Held { .. })) => tally.wait(self.callbacks, name),
                    Err(problem) if problem.is_of_files() && tally.may_try_again(name) => {}
                    Err(problem) => tally.fail(self.callbacks, name, problem.to_string()),
                    Ok(true) => drop(tally.locked().finished.insert(name.clone())),
                    Ok(false) => {}
                }
            }
            Ok(())
        };
        let cases: Vec<&Case> = open.iter().map(|prepared| &prepared.case).collect();
        let at_once = CasesAtOnce::here(&cases, self.threads as u64).cases;
        on_each(at_once as usize, work)
    }

    /// Claims one case and walks it into its folder; returns true if this process finished it.
    fn one(&self, case: &PreparedCase) -> Result<bool, RunError> {
        let folder = Folder::open(&self.out.join(case.folder()))?;
        // Listing the folder makes the network client ask the server again; opening a file that was missing
        // before may not.
        drop(std::fs::read_dir(folder.path()));
        folder.remove(PROBLEM)?;
        // Another process may have finished it since the list was made.
        if self.is_done(case) {
            return Ok(false);
        }
        match self.walk(case, &folder) {
            // Without locks across machines, another process may have finished it and removed the
            // checkpoints.
            Err(_) if self.is_done(case) => {
                checkpoints::discard(folder.path())?;
                Ok(false)
            }
            Err(problem) => {
                // A problem that cannot be written here is still reported.
                let _ = folder.write(PROBLEM, format!("{problem}\n").as_bytes());
                Err(problem)
            }
            walked => walked,
        }
    }

    /// Walks one case into its folder, on the threads that it is called on.
    fn walk(&self, prepared: &PreparedCase, folder: &Folder) -> Result<bool, RunError> {
        let (name, case) = (&prepared.planned.name, &prepared.case);
        replicates::have_networks(case, &self.callbacks.run)?;
        let resumes = Checkpoints::is_in(folder.path())?;
        (self.callbacks.on_case)(name, CaseEvent::Begun { resumes });
        let (begun, started) = (Instant::now(), SystemTime::now());
        let checkpoints = Checkpoints::new(folder, &prepared.fingerprint, self.checkpoint_interval)?;
        let runs = Mutex::new([0, replicates::runs_to_walk(case)]);
        let count = |event: Event| {
            let Ok(mut runs) = runs.lock() else { return };
            match event {
                Event::RunDone => runs[0] += 1,
                Event::MoreRuns { runs: more } => runs[1] += more,
                _ => return,
            }
            let [done, runs] = *runs;
            (self.callbacks.on_case)(name, CaseEvent::Walked { done, runs });
        };
        let stop = self.callbacks.run.stop;
        let counting = Callbacks { on_event: &count, stop, ..Callbacks::default() };
        let (callbacks, networks) = (&counting, self.networks.as_ref());
        let context = ReplicateContext { callbacks, checkpoints: Some(&checkpoints), networks };
        let walked = CaseWalks::walk(case, &context)
            .and_then(|walks| Ok((Studies::walk(case, &walks, &context)?, walks)));
        for problem in checkpoints.passed_over() {
            self.warn(name, &format!("{problem}; the checkpoint before it was used"));
        }
        let (studies, walks) = match walked {
            Err(error) if error.exit() == Exit::Stopped => {
                checkpoints.flush()?;
                return Ok(false);
            }
            // The checkpoint is corrupt, or from before a change of the plan: walk from the start.
            Err(error @ RunError::Checkpoint(_)) if error.exit() == Exit::Refused => {
                self.warn(name, &format!("{error}; the case is walked from its start"));
                checkpoints.clear()?;
                return Ok(false);
            }
            other => other?,
        };
        if self.is_done(prepared) {
            checkpoints.clear()?;
            return Ok(false);
        }
        let seconds = begun.elapsed().as_secs_f64();
        let threads = rayon::current_num_threads() as u64;
        let answer = results::outcome(case, &case.notes(), &walks, studies, seconds);
        let manifest = results::manifest(case, threads, started, self.command.clone());
        let (host, started, job) = (manifest.host.clone(), manifest.started.clone(), self.job.clone());
        let made = Made { host, threads, job, started, seconds };
        let place = prepared.folder().display().to_string();
        let fingerprint = prepared.fingerprint.clone();
        let line = LedgerLine::new(name, &prepared.planned.levels, place, fingerprint, &answer.0, made);
        let files = results::files(case, answer, &walks.replicates, manifest)?;
        folder.remove(LINE)?;
        // These may be results from before the plan was changed. Another process that walks this very case
        // has written this very scene, and its files stay.
        if folder.read("scene.toml")?.as_deref() != Some(files.scene.as_bytes()) {
            clear(folder, FolderKind::Run)?;
        }
        results::write_scene(folder, case)?;
        results::write(folder, case, &files)?;
        self.callbacks.run.results(FolderKind::Run, folder.path(), Some(files))?;
        folder.write(LINE, &results::json(format::CASE, &line)?)?;
        checkpoints.clear()?;
        (self.callbacks.on_case)(name, CaseEvent::Done(&line));
        Ok(true)
    }
}

fn fault(panic: &(dyn std::any::Any + Send)) -> RunError {
    let text = panic.downcast_ref::<String>().map(String::as_str);
    let text = text.or(panic.downcast_ref::<&str>().copied()).unwrap_or("it does not say which");
    RunError::failed(format!("a fault of the program: {text}"))
}

#[derive(Default)]
struct Tally(Mutex<Counts>);

#[derive(Default)]
struct Counts {
    finished: BTreeSet<String>,
    failed: Vec<FailedCase>,
    waiting: BTreeSet<String>,
    waits: usize,
    tries: BTreeMap<String, u32>,
}

impl Tally {
    fn locked(&self) -> MutexGuard<'_, Counts> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner)
    }

    fn fail(&self, callbacks: &CaseCallbacks, name: &str, problem: String) {
        (callbacks.on_case)(name, CaseEvent::Failed(&problem));
        self.locked().failed.push(FailedCase { case: name.to_owned(), problem });
    }

    /// True if results may be written again: without locks across machines, another process may have been
    /// replacing the same files. Finished walks are not repeated.
    fn may_try_again(&self, name: &str) -> bool {
        let mut counts = self.locked();
        counts.waits += 1;
        let tries = counts.tries.entry(name.to_owned()).or_default();
        *tries += 1;
        *tries <= TRIES
    }

    /// Reports once that another process works on the case.
    fn wait(&self, callbacks: &CaseCallbacks, name: &str) {
        let mut counts = self.locked();
        counts.waits += 1;
        let is_first = counts.waiting.insert(name.to_owned());
        drop(counts);
        if is_first {
            (callbacks.on_case)(name, CaseEvent::Waiting);
        }
    }
}
