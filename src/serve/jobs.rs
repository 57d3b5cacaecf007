//! What the page has asked for: one job is walked at a time, the others wait.
//!
//! A job is a call of the library into a folder of its own, which is that of a run, a comparison or a design
//! as of the command line. What it was asked for is kept there before any work (`job_file.rs`), so that a
//! later server on the same folder can do it. A kind of job more is a variant of [`Work`], what it does in
//! `JobQueue::work`, and how its request is read (`Routes::planned`).

#[cfg(test)]
mod tests;

use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Condvar, Mutex, MutexGuard, PoisonError};

use serde_json::{Value, json};

use super::designs::{KeptDesign, of_design};
use super::job_file::JobFile;
use super::live::Live;
use crate::campaign::CampaignCallbacks;
use crate::outcome::design::Design;
use crate::outcome::record::Outcome;
use crate::run::callbacks::Callbacks;
use crate::run::checkpoints::CheckpointInterval;
use crate::run::error::{AnyError, Exit};
use crate::run::{self, FolderKind, PrepareOptions, RunError, RunOptions};
use crate::scene::Scene;
use crate::store::read_whole;
use crate::study::compare::{self, CompareOptions, ComparePlan};
use crate::study::design;

/// Most jobs that wait.
const WAITING: usize = 20;

/// Most jobs that are listed; of more, those that ended first are left out. Their folders stay.
const LISTED: usize = 200;

/// The last number of a job.
const LAST: usize = 999_999;

/// What is done with results that are whole.
pub type OnResults = fn(FolderKind, &Path) -> Result<(), AnyError>;

/// What a job does.
#[derive(Clone)]
pub enum Work {
    /// Walks a scene.
    Judge(Box<Scene>),
    /// Walks several cases.
    Compare(ComparePlan),
    /// Finds how coarse a filter may be; the networks that are done in its folder are kept.
    Design(KeptDesign),
    /// What its folder keeps: it is planned again when the job continues.
    Kept,
    /// Continues a run whose folder does not keep what was asked.
    Resume,
    /// Nothing: nobody knows what was asked.
    Nothing,
}

impl Work {
    fn name(&self) -> &'static str {
        match self {
            Self::Compare(_) => "compare",
            Self::Design(_) => "design",
            _ => "run",
        }
    }
}

/// How far a job is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum State {
    Waiting,
    Running,
    Stopped,
    Done,
    Refused,
    Failed,
}

impl State {
    fn words(self) -> &'static str {
        match self {
            Self::Waiting => "waiting",
            Self::Running => "running",
            Self::Stopped => "stopped",
            Self::Done => "done",
            Self::Refused => "refused",
            Self::Failed => "failed",
        }
    }
}

struct Job {
    id: usize,
    title: String,
    /// The two sheets that it was asked for, as the page names them.
    asked: Value,
    /// Name of its folder inside the server's.
    folder: String,
    work: Work,
    state: State,
    message: String,
    result: Value,
    live: Arc<Mutex<Live>>,
    stop: Arc<AtomicBool>,
}

/// All jobs of a server.
pub struct JobQueue {
    root: PathBuf,
    prepare: PrepareOptions,
    command: String,
    on_results: OnResults,
    all: Mutex<Vec<Job>>,
    wake: Condvar,
    /// Nothing more is begun.
    ends: AtomicBool,
}

impl JobQueue {
    /// The jobs in `root`: those of an earlier server there, and none else yet.
    pub fn new(root: &Path, prepare: PrepareOptions, command: String, on_results: OnResults) -> Self {
        let all = Mutex::new(earlier(root));
        let (wake, ends) = (Condvar::new(), AtomicBool::new(false));
        Self { root: root.to_owned(), prepare, command, on_results, all, wake, ends }
    }

    fn locked(&self) -> MutexGuard<'_, Vec<Job>> {
        self.all.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Whether one job more may wait.
    fn has_room(&self, all: &[Job]) -> Result<(), String> {
        if self.ends.load(Ordering::Relaxed) {
            return Err("the server ends".into());
        }
        match all.iter().filter(|job| job.state == State::Waiting).count() >= WAITING {
            true => Err(format!("{WAITING} jobs wait already; stop some first")),
            false => Ok(()),
        }
    }

    /// Adds a job, keeps what it was asked for in its folder, and gives its number.
    ///
    /// # Errors
    /// Too many wait, which is a refusal; its folder cannot be written.
    pub fn add(&self, file: JobFile, work: Work) -> Result<usize, RunError> {
        let mut all = self.locked();
        self.has_room(&all).map_err(RunError::Refused)?;
        let first = all.iter().map(|job| job.id).max().unwrap_or(0) + 1;
        let path = |id: &usize| self.root.join(format!("{}-{id}", work.name()));
        let is_free = |id: &usize| path(id).symlink_metadata().is_err();
        let id = (first..=LAST).find(is_free);
        let id = id.ok_or_else(|| RunError::Refused("this folder is full: start on another".into()))?;
        file.write(&path(&id)).map_err(|error| RunError::failed(error.to_string()))?;
        let folder = format!("{}-{id}", work.name());
        let JobFile { title, asked, .. } = file;
        all.push(Job { asked, ..Job::new(id, title, folder, work, State::Waiting) });
        shorten(&mut all);
        self.wake.notify_all();
        Ok(id)
    }

    /// Stops a job, or takes it out of those that wait.
    ///
    /// # Errors
    /// There is none of this number that could be stopped.
    pub fn stop(&self, id: usize) -> Result<(), String> {
        let mut all = self.locked();
        let job = all.iter_mut().find(|job| job.id == id).ok_or("there is no such job")?;
        match job.state {
            State::Running => job.stop.store(true, Ordering::Relaxed),
            State::Waiting => {
                (job.state, job.message) = (State::Stopped, "stopped before it began".into());
            }
            _ => return Err("this job is not under way".into()),
        }
        Ok(())
    }

    /// What a job that can continue was asked for; `None` where that is to resume the run in its folder.
    ///
    /// # Errors
    /// There is none of this number that could continue.
    pub fn kept(&self, id: usize) -> Result<Option<JobFile>, String> {
        let all = self.locked();
        let job = all.iter().find(|job| job.id == id).ok_or("there is no such job")?;
        match (job.can_continue(), &job.work) {
            (false, _) => Err("this job cannot continue".into()),
            (true, Work::Resume) => Ok(None),
            (true, _) => {
                let file = JobFile::read(&self.root.join(&job.folder));
                file.map(Some).ok_or_else(|| "what this job was asked for is lost; ask again".into())
            }
        }
    }

    /// Lets a job that was stopped continue, with its work planned anew.
    ///
    /// # Errors
    /// There is none of this number that could continue; too many wait.
    pub fn resume(&self, id: usize, work: Work) -> Result<(), String> {
        let mut all = self.locked();
        self.has_room(&all)?;
        let job = all.iter_mut().find(|job| job.id == id).ok_or("there is no such job")?;
        if !job.can_continue() {
            return Err("this job cannot continue".into());
        }
        (job.work, job.state, job.message) = (work, State::Waiting, String::new());
        job.stop.store(false, Ordering::Relaxed);
        *job.live.lock().unwrap_or_else(PoisonError::into_inner) = Live::default();
        self.wake.notify_all();
        Ok(())
    }

    /// Stops everything, and lets nothing more begin; gives the numbers of what was under way or waited.
    pub fn stop_all(&self) -> Vec<usize> {
        let mut all = self.locked();
        self.ends.store(true, Ordering::Relaxed);
        let open = all.iter_mut().filter(|job| matches!(job.state, State::Waiting | State::Running));
        open.map(|job| {
            match job.state {
                State::Waiting => job.state = State::Stopped,
                _ => job.stop.store(true, Ordering::Relaxed),
            }
            job.id
        })
        .collect()
    }

    /// What became of these jobs, now that nothing is walked any more.
    ///
    /// # Errors
    /// One failed, with its message; else some are not done.
    pub fn ended(&self, ids: &[usize]) -> Result<(), RunError> {
        let all = self.locked();
        let of = |state: State| all.iter().filter(move |job| ids.contains(&job.id) && job.state == state);
        let path = |job: &Job| self.root.join(&job.folder).display().to_string();
        if let Some(failed) = of(State::Failed).next() {
            return Err(RunError::failed(format!("{}: {}", path(failed), failed.message)));
        }
        let stopped: Vec<String> = of(State::Stopped).map(path).collect();
        match stopped.is_empty() {
            true => Ok(()),
            false => Err(RunError::Stopped(format!(
                "not done, and what is done of it is saved: {}; `voidwalk serve --out {}` lists it, and \
                 Continue on its page goes on",
                stopped.join(", "),
                self.root.display()
            ))),
        }
    }

    /// The folder of a job, by its name.
    pub fn folder(&self, name: &str) -> Option<PathBuf> {
        self.locked().iter().any(|job| job.folder == name).then(|| self.root.join(name))
    }

    /// All jobs, the newest first; messages pass through `said`.
    pub fn snapshot(&self, said: impl Fn(&str) -> String) -> Value {
        let all = self.locked();
        all.iter().rev().map(|job| job.snapshot(&all, &self.root, &said)).collect()
    }

    /// Walks one job after another, until `over`.
    pub fn work_until(&self, over: &AtomicBool) {
        while !over.load(Ordering::Relaxed) {
            let Some(next) = self.next() else { continue };
            let (id, folder, work, live, stop) = next;
            let walked = catch_unwind(AssertUnwindSafe(|| self.work(&folder, &work, &live, &stop)));
            let walked = walked.unwrap_or_else(|_| Err(RunError::failed("a fault of the program")));
            let (state, message, result) = match walked {
                Ok(result) => (State::Done, String::new(), result),
                Err(error) => match error.exit() {
                    // A design says how much of it is kept.
                    Exit::Stopped if matches!(work, Work::Design(_)) => {
                        (State::Stopped, error.to_string(), Value::Null)
                    }
                    Exit::Stopped => (State::Stopped, how_to_continue(&folder), Value::Null),
                    exit => {
                        let state = if exit == Exit::Refused { State::Refused } else { State::Failed };
                        let advice = error.advice().map_or(String::new(), |advice| format!("\n{advice}"));
                        (state, format!("{error}{advice}"), Value::Null)
                    }
                },
            };
            let ended = matches!(state, State::Refused | State::Failed);
            let file = JobFile::read(&folder);
            if let Some(file) = file.clone().filter(|_| ended) {
                // Where this cannot be written, the next server has it continue, which it can.
                let ended = Some((state.words().to_owned(), message.clone()));
                let _ = JobFile { ended, ..file }.write(&folder);
            }
            let mut all = self.locked();
            let Some(job) = all.iter_mut().find(|job| job.id == id) else { continue };
            (job.state, job.message, job.result) = (state, message, result);
            // A scene is large, and needed no more.
            if file.is_some() {
                job.work = Work::Kept;
            }
        }
    }

    /// The job that has waited longest, now running; waits a little for one.
    #[allow(clippy::type_complexity)]
    fn next(&self) -> Option<(usize, PathBuf, Work, Arc<Mutex<Live>>, Arc<AtomicBool>)> {
        let mut all = self.locked();
        if !all.iter().any(|job| job.state == State::Waiting) {
            let patience = std::time::Duration::from_millis(200);
            all = self.wake.wait_timeout(all, patience).unwrap_or_else(PoisonError::into_inner).0;
        }
        let job = all.iter_mut().find(|job| job.state == State::Waiting)?;
        job.state = State::Running;
        let folder = self.root.join(&job.folder);
        Some((job.id, folder, job.work.clone(), Arc::clone(&job.live), Arc::clone(&job.stop)))
    }

    /// Does a job, and gives what the page shows of its result.
    fn work(
        &self,
        folder: &Path,
        work: &Work,
        live: &Mutex<Live>,
        stop: &AtomicBool,
    ) -> Result<Value, RunError> {
        let live = || live.lock().unwrap_or_else(PoisonError::into_inner);
        let callbacks = Callbacks {
            on_event: &|event| {
                // An increment changes nothing that is shown, and there are many.
                if !matches!(event, run::Event::Increment { .. }) {
                    live().tell(event);
                }
            },
            stop,
            warn: &|warning| live().warn(warning),
            on_results: &|kind, folder| (self.on_results)(kind, folder),
        };
        let options = RunOptions {
            out: Some(folder.to_owned()),
            overwrite: false,
            prepare: self.prepare.clone(),
            checkpoint_interval: Some(often()),
            command: self.command.clone(),
        };
        match work {
            Work::Judge(scene) => {
                run::walk_scene((**scene).clone(), &options, &callbacks).map(|run| of_run(&run.outcome))
            }
            Work::Resume => run::resume(folder, &options, &callbacks).map(|run| of_run(&run.outcome)),
            Work::Compare(plan) => {
                let options = CompareOptions {
                    out: folder.to_owned(),
                    overwrite: false,
                    packings: self.prepare.packings.clone(),
                    memory: self.prepare.memory,
                    threads: self.prepare.threads,
                    checkpoint_interval: often(),
                    command: self.command.clone(),
                };
                let callbacks = CampaignCallbacks {
                    run: callbacks,
                    on_cases: &|all, done| live().cases(all, done),
                    on_case: &|case, event| live().tell_case(case, event),
                };
                Ok(serde_json::to_value(compare::run(plan, &options, &callbacks)?)?)
            }
            Work::Design(kept) => {
                let options = kept.options(&self.root, folder, &self.prepare)?;
                Ok(of_design(&design::run(&options, &callbacks)?)?)
            }
            Work::Kept | Work::Nothing => Ok(Value::Null),
        }
    }
}

/// A server that is killed loses no more than this.
fn often() -> CheckpointInterval {
    "1min".parse().unwrap_or_default()
}

impl Job {
    fn new(id: usize, title: String, folder: String, work: Work, state: State) -> Self {
        let (live, stop) = (Arc::default(), Arc::default());
        let (message, result, asked) = (String::new(), Value::Null, Value::Null);
        Self { id, title, asked, folder, work, state, message, result, live, stop }
    }

    fn can_continue(&self) -> bool {
        self.state == State::Stopped && !matches!(self.work, Work::Nothing)
    }

    fn snapshot(&self, all: &[Job], root: &Path, said: &impl Fn(&str) -> String) -> Value {
        let waits = |job: &&Job| job.state == State::Waiting && job.id < self.id;
        let page = ["report.html", "compare.html", "design.html"]
            .into_iter()
            .find(|page| self.state == State::Done && root.join(&self.folder).join(page).is_file());
        let mut kinds = ["compare", "design"].into_iter();
        let kind = kinds.find(|kind| self.folder.starts_with(kind)).unwrap_or("judge");
        let (runs, replicates) = match &self.work {
            Work::Judge(scene) => (scene.walk.runs, Some(scene.walk.replicates)),
            _ => (2, None),
        };
        let mut live = self.live.lock().unwrap_or_else(PoisonError::into_inner).clone();
        live.warnings.iter_mut().for_each(|warning| *warning = said(warning));
        json!({
            "id": self.id,
            "kind": kind,
            "title": said(&self.title),
            "asked": self.asked,
            "folder": self.folder,
            "path": root.join(&self.folder).display().to_string(),
            "state": self.state.words(),
            "stopping": self.state == State::Running && self.stop.load(Ordering::Relaxed),
            "can_continue": self.can_continue(),
            "before": all.iter().filter(waits).count(),
            "message": said(&self.message),
            "page": page.map(|page| format!("files/{}/{page}", self.folder)),
            "replicates": replicates,
            "live": live.snapshot(runs),
            "result": all_said(&self.result, said),
        })
    }
}

/// A result whose every text has passed through `said`.
fn all_said(value: &Value, said: &impl Fn(&str) -> String) -> Value {
    match value {
        Value::String(text) => Value::String(said(text)),
        Value::Array(all) => all.iter().map(|one| all_said(one, said)).collect(),
        Value::Object(all) => all.iter().map(|(key, one)| (key.clone(), all_said(one, said))).collect(),
        other => other.clone(),
    }
}

/// What the page shows of an outcome.
fn of_run(outcome: &Outcome) -> Value {
    json!({
        "headline": outcome.headline(),
        "verdict": outcome.verdict.words(),
        "confidence": outcome.confidence.words(),
        "reasons": outcome.reasons,
        "beside": outcome.beside_the_verdict(),
        "replicates": outcome.replicates.len(),
        "runs": outcome.summary.iter().map(|run| run.eroded_mass_fraction).collect::<Vec<_>>(),
        "range": outcome.curve_range.as_ref().map(|range| range.eroded_mass_fraction.clone()),
    })
}

/// How a job goes on that was stopped.
fn how_to_continue(folder: &Path) -> String {
    let resume = match folder.join("scene.toml").is_file() {
        true => format!(", or `voidwalk resume {}`,", folder.display()),
        false => String::new(),
    };
    format!("what is done is saved; Continue{resume} goes on from it")
}

/// Leaves out the jobs that ended first, where there are too many.
fn shorten(all: &mut Vec<Job>) {
    let mut more = all.len().saturating_sub(LISTED);
    all.retain(|job| {
        let stays = more == 0 || matches!(job.state, State::Waiting | State::Running);
        more -= usize::from(!stays);
        stays
    });
}

/// The number of a job's folder.
fn number(name: &str) -> Option<usize> {
    let (kind, id) = name.split_once('-')?;
    let id = id.parse().ok().filter(|id| (1..=LAST).contains(id))?;
    // No second folder has the same number by `+1` or `01`.
    (name == format!("{kind}-{id}") && kind.bytes().all(|b| b.is_ascii_lowercase())).then_some(id)
}

/// The jobs that an earlier server left in its folder.
fn earlier(root: &Path) -> Vec<Job> {
    let entries = std::fs::read_dir(root).into_iter().flatten().flatten();
    let folders = entries.filter(|entry| entry.file_type().is_ok_and(|kind| kind.is_dir()));
    let names = folders.filter_map(|entry| entry.file_name().into_string().ok());
    let mut names: Vec<(usize, String)> = names.filter_map(|name| Some((number(&name)?, name))).collect();
    names.sort();
    let jobs = names.into_iter().rev().filter_map(|(id, name)| earlier_job(id, name, root));
    let mut jobs: Vec<Job> = jobs.take(LISTED).collect();
    jobs.reverse();
    jobs.dedup_by_key(|job| job.id);
    jobs
}

/// A job that an earlier server left; `None` where a folder of this name is none.
fn earlier_job(id: usize, name: String, root: &Path) -> Option<Job> {
    let path = root.join(&name);
    let file = JobFile::read(&path);
    if file.is_none() && !["run-", "compare-", "design-"].iter().any(|kind| name.starts_with(kind)) {
        return None;
    }
    let record = |kind: FolderKind| read_whole(&path.join(kind.record())).ok();
    let done = match FolderKind::of(&path).filter(|kind| kind.is_finished(&path).unwrap_or(false)) {
        Some(FolderKind::Run) => record(FolderKind::Run)
            .and_then(|bytes| serde_json::from_slice::<Outcome>(&bytes).ok())
            .map(|outcome| of_run(&outcome)),
        // Without its page it is not whole, and the same call writes it.
        Some(FolderKind::Design) if path.join("design.html").is_file() => record(FolderKind::Design)
            .and_then(|bytes| serde_json::from_slice::<Design>(&bytes).ok())
            .and_then(|design| of_design(&design).ok()),
        Some(FolderKind::Design) | None => None,
        Some(kind) => record(kind).and_then(|bytes| serde_json::from_slice(&bytes).ok()),
    };
    let ended = file.as_ref().and_then(|file| file.ended.clone());
    let title =
        file.as_ref().map_or_else(|| format!("{name}, of an earlier start"), |file| file.title.clone());
    let work = match &file {
        Some(_) => Work::Kept,
        None if path.join("scene.toml").is_file() => Work::Resume,
        None => Work::Nothing,
    };
    let mut job = Job::new(id, title, name, work, State::Stopped);
    job.asked = file.map_or(Value::Null, |file| file.asked);
    (job.state, job.message, job.result) = match (done, ended) {
        (Some(result), _) => (State::Done, String::new(), result),
        (None, Some((state, message))) if state == State::Refused.words() => {
            (State::Refused, message, Value::Null)
        }
        (None, Some((_, message))) => (State::Failed, message, Value::Null),
        (None, None) if matches!(job.work, Work::Nothing) => {
            let message = "the server ended before this was done, and what was asked is not known";
            (State::Stopped, message.into(), Value::Null)
        }
        (None, None) => (State::Stopped, how_to_continue(&path), Value::Null),
    };
    Some(job)
}
