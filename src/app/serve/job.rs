//! Job of the page: its state, its work (a call of the library into its own folder), its description for the
//! page, the request stored in its folder, and the jobs that an earlier server left.

use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Mutex, PoisonError};

use serde::{Deserialize, Serialize};
use serde_json::{Value, json};

use super::batches::of_batch;
use super::live::Live;
use crate::cases::{BatchPlan, CaseCallbacks, CaseEvent, CaseOptions, batch};
use crate::outcome::record::Outcome;
use crate::report::colour_of;
use crate::run::error::AnyError;
use crate::run::{
    self, Callbacks, CheckpointInterval, FinishedRun, FolderKind, PrepareOptions, RunError, RunOptions,
};
use crate::scene::Scene;
use crate::verdict::{RunFiles, WalkedBatch};
use crate::words::{first_lines, sentence};
use voidwalk_core::store::format::from_json;
use voidwalk_core::store::{Folder, read_regular, read_whole};
use voidwalk_core::text::shell_word;
use voidwalk_practice::Decision;
use voidwalk_practice::quantity::SizeUnit;

#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub(crate) enum JobState {
    Waiting,
    Running,
    Stopped,
    Done,
    Refused,
    /// Also an unknown word in `job.json`.
    #[serde(other)]
    Failed,
}

pub(crate) struct Job {
    pub(crate) id: usize,
    pub(crate) title: String,
    /// Sheets of the request, as the page names them.
    pub(crate) asked: Value,
    /// Name of its folder inside the server's folder.
    pub(crate) folder: String,
    pub(crate) work: Work,
    pub(crate) state: JobState,
    pub(crate) message: String,
    pub(crate) result: Value,
    pub(crate) live: Arc<Mutex<Live>>,
    pub(crate) stop: Arc<AtomicBool>,
}

impl Job {
    pub(crate) fn new(id: usize, title: String, folder: String, work: Work, state: JobState) -> Self {
        let (live, stop) = (Arc::default(), Arc::default());
        let (message, result, asked) = (String::new(), Value::Null, Value::Null);
        Self { id, title, asked, folder, work, state, message, result, live, stop }
    }

    pub(crate) fn can_begin(&self) -> bool {
        self.state == JobState::Waiting && !matches!(self.work, Work::Nothing)
    }

    /// True if it can continue, because it ended early in a folder that the command line would resume. A
    /// request refused before any work would be refused again.
    pub(crate) fn can_continue(&self, root: &Path) -> bool {
        let ended_early = match self.state {
            JobState::Stopped | JobState::Failed => true,
            JobState::Refused => has_scene(&root.join(&self.folder)),
            JobState::Waiting | JobState::Running | JobState::Done => false,
        };
        ended_early && !matches!(self.work, Work::Nothing)
    }

    /// JSON of the job for the page; messages pass through `named`.
    pub(crate) fn snapshot(&self, all: &[Job], root: &Path, named: &impl Fn(&str) -> String) -> Value {
        let waits = |job: &&Job| job.state == JobState::Waiting && job.id < self.id;
        let page = ["report.html", "batch.html"]
            .into_iter()
            .find(|page| self.state == JobState::Done && root.join(&self.folder).join(page).is_file());
        let kind = if self.folder.starts_with("batch") { "batch" } else { "judge" };
        let (runs, replicates) = match &self.work {
            Work::Judge(scene) => (scene.walk.runs, Some(scene.walk.replicates)),
            _ => (2, None),
        };
        let live = self.live.lock().unwrap_or_else(PoisonError::into_inner).clone();
        json!({
            "id": self.id,
            "kind": kind,
            "title": named(&self.title),
            "asked": self.asked,
            "folder": self.folder,
            "path": root.join(&self.folder).display().to_string(),
            "state": self.state,
            "stopping": self.state == JobState::Running && self.stop.load(Ordering::Relaxed),
            "can_continue": self.can_continue(root),
            "before": all.iter().filter(waits).count(),
            "message": named(&self.message),
            "page": page.map(|page| format!("files/{}/{page}", self.folder)),
            "replicates": replicates,
            "live": all_said(&live.snapshot(runs), named),
            "result": all_said(&self.result, named),
        })
    }
}

fn all_said(value: &Value, named: &impl Fn(&str) -> String) -> Value {
    match value {
        Value::String(text) => Value::String(named(text)),
        Value::Array(all) => all.iter().map(|one| all_said(one, named)).collect(),
        Value::Object(all) => all.iter().map(|(key, one)| (key.clone(), all_said(one, named))).collect(),
        other => other.clone(),
    }
}

/// True if a folder holds the scene of a run that has begun, which the command line can resume.
pub(crate) fn has_scene(folder: &Path) -> bool {
    folder.join("scene.toml").is_file()
}

pub(crate) fn how_to_continue(folder: &Path) -> String {
    let command = || format!(", or `voidwalk resume {}`,", shell_word(&folder.display().to_string()));
    let resume = if has_scene(folder) { command() } else { String::new() };
    format!("what is done is saved; Continue{resume} goes on from it")
}

pub(crate) type OnResults = fn(FolderKind, &Path, Option<RunFiles>) -> Result<(), AnyError>;

#[derive(Clone)]
pub(crate) enum Work {
    Judge(Box<Scene>),
    Batch(Box<BatchPlan>),
    /// Work described by its folder, which is planned again when the job continues.
    Kept,
    /// Continues a run whose folder holds no request.
    Resume,
    /// No work: the request is unknown.
    Nothing,
}

impl Work {
    pub(crate) fn name(&self) -> &'static str {
        match self {
            Self::Batch(_) => "batch",
            _ => "run",
        }
    }
}

pub(crate) struct WorkContext {
    pub(crate) root: PathBuf,
    pub(crate) prepare: PrepareOptions,
    /// Command that started it, for its folder.
    pub(crate) command: String,
    pub(crate) on_results: OnResults,
}

impl WorkContext {
    pub(crate) fn work(
        &self,
        folder: &Path,
        work: &Work,
        live: &Mutex<Live>,
        stop: &AtomicBool,
    ) -> Result<Value, RunError> {
        let live = || live.lock().unwrap_or_else(PoisonError::into_inner);
        let callbacks = Callbacks {
            on_event: &|event| {
                // Increments are many, and change nothing that is shown.
                if !matches!(event, run::Event::Increment { .. }) {
                    live().tell(event);
                }
            },
            stop,
            warn: &|warning| live().warn(warning),
            on_results: &self.on_results,
        };
        let options = RunOptions {
            out: Some(folder.to_owned()),
            overwrite: false,
            prepare: self.prepare.clone(),
            checkpoint_interval: Some(often()),
            command: self.command.clone(),
        };
        let shown = |run: FinishedRun| Ok(of_run(&run.outcome, &run.decision));
        match work {
            Work::Judge(scene) => shown(run::walk_scene((**scene).clone(), &options, &callbacks)?),
            Work::Resume => shown(run::resume(folder, &options, &callbacks)?),
            Work::Batch(plan) => {
                // Outcomes are read first, so that the page does not have to wait.
                let rows = plan.so_far(folder);
                live().batch = Some((rows, plan.shows_inches()));
                let options = of_cases(folder, &self.prepare, &self.command);
                let callbacks = CaseCallbacks {
                    run: callbacks,
                    on_cases: &|all, done| live().cases = [done, all],
                    on_case: &|case, event| {
                        if let CaseEvent::Done(line) = event
                            && let Some((at, row)) = plan.walked_row(folder, line)
                        {
                            live().walked_pair(at, row);
                        }
                        live().tell_case(case, event);
                    },
                };
                Ok(of_batch(&batch::run(plan, &options, false, &callbacks)?))
            }
            Work::Kept | Work::Nothing => Ok(Value::Null),
        }
    }
}

pub(crate) fn of_cases(folder: &Path, prepare: &PrepareOptions, command: &str) -> CaseOptions {
    let options = CaseOptions::of(folder.to_owned(), prepare.clone(), command.to_owned());
    CaseOptions { checkpoint_interval: often(), ..options }
}

/// Interval between saves: the maximum loss if a server is killed.
fn often() -> CheckpointInterval {
    "1min".parse().unwrap_or_default()
}

fn of_run(outcome: &Outcome, decision: &Decision) -> Value {
    let unit = SizeUnit::of(outcome.inputs.scale_free, false);
    let lines = first_lines(outcome, decision, unit);
    json!({
        "lines": lines.iter().map(|(line, words)| (line.name(), words)).collect::<Vec<_>>(),
        "model": outcome.model.class.words(),
        "colour": colour_of(outcome.headline),
        "notes": outcome.notes.iter().map(|note| sentence(note, unit)).collect::<Vec<_>>(),
        "replicates": outcome.replicates.len(),
        "runs": outcome.summary.iter().map(|run| run.eroded_mass_fraction).collect::<Vec<_>>(),
    })
}

pub(crate) const LAST: usize = 999_999;

fn number(name: &str) -> Option<usize> {
    let (kind, id) = name.split_once('-')?;
    let id = id.parse().ok().filter(|id| (1..=LAST).contains(id))?;
    // A folder such as `run-+1` or `run-01` must not have the same number.
    (name == format!("{kind}-{id}") && kind.bytes().all(|b| b.is_ascii_lowercase())).then_some(id)
}

/// The `most` newest jobs that an earlier server left, oldest first.
pub(crate) fn earlier(root: &Path, most: usize) -> Vec<Job> {
    let entries = std::fs::read_dir(root).into_iter().flatten().flatten();
    let folders = entries.filter(|entry| entry.file_type().is_ok_and(|kind| kind.is_dir()));
    let names = folders.filter_map(|entry| entry.file_name().into_string().ok());
    let mut names: Vec<(usize, String)> = names.filter_map(|name| Some((number(&name)?, name))).collect();
    names.sort();
    let jobs = names.into_iter().rev().filter_map(|(id, name)| earlier_job(id, name, root));
    let mut jobs: Vec<Job> = jobs.take(most).collect();
    jobs.reverse();
    jobs.dedup_by_key(|job| job.id);
    jobs
}

/// True if a folder holds only marks of the program, because its job was never accepted.
fn holds_nothing(folder: &Path) -> bool {
    let is_mark = |entry: &std::fs::DirEntry| entry.file_name().as_encoded_bytes().starts_with(b".");
    std::fs::read_dir(folder).is_ok_and(|mut all| all.all(|entry| entry.as_ref().is_ok_and(is_mark)))
}

/// Job that an earlier server left; `None` if the folder of this name holds no job.
fn earlier_job(id: usize, name: String, root: &Path) -> Option<Job> {
    let path = root.join(&name);
    let file = JobFile::read(&path);
    let is_ours = ["run-", "batch-"].iter().any(|kind| name.starts_with(kind));
    if file.is_none() && (!is_ours || holds_nothing(&path)) {
        return None;
    }
    let kind = FolderKind::of(&path).filter(|kind| kind.is_finished(&path).unwrap_or(false));
    let done = kind.and_then(|kind| {
        let bytes = read_whole(&path.join(kind.record())).ok()?;
        match kind {
            FolderKind::Run => {
                let outcome: Outcome = from_json(&bytes).ok()?;
                Some(of_run(&outcome, &outcome.decision()))
            }
            // Without its page it is unfinished, and the same call writes the page.
            FolderKind::Batch if !path.join("batch.html").is_file() => None,
            FolderKind::Batch => from_json::<WalkedBatch>(&bytes).ok().map(|batch| of_batch(&batch)),
            _ => from_json(&bytes).ok(),
        }
    });
    let ended = file.as_ref().and_then(|file| file.ended.clone());
    let title =
        file.as_ref().map_or_else(|| format!("{name}, from an earlier start"), |file| file.title.clone());
    let work = match &file {
        Some(_) => Work::Kept,
        None if has_scene(&path) => Work::Resume,
        None => Work::Nothing,
    };
    let mut job = Job::new(id, title, name, work, JobState::Stopped);
    job.asked = file.map_or(Value::Null, |file| file.asked);
    (job.state, job.message) = match ended {
        _ if done.is_some() => (JobState::Done, String::new()),
        Some((JobState::Refused, message)) => (JobState::Refused, message),
        Some((_, message)) => (JobState::Failed, message),
        None if matches!(job.work, Work::Nothing) => {
            let message = "the server ended before this was done, and its request is not known";
            (JobState::Stopped, message.into())
        }
        None => (JobState::Stopped, how_to_continue(&path)),
    };
    job.result = done.unwrap_or_default();
    Some(job)
}

const FILE: &str = "job.json";

const LARGEST: u64 = 4 << 20;

/// Request of a job, and its end if it cannot continue.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct JobFile {
    pub(crate) kind: String,
    pub(crate) title: String,
    pub(crate) asked: Value,
    pub(crate) request: Value,
    /// Refused or failed, with the message.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub(crate) ended: Option<(JobState, String)>,
}

impl JobFile {
    /// Stores this in the job's folder, which is made if missing. Fails for a link, for a folder that is not
    /// the program's own or is in use, and for a request that is too large.
    pub(crate) fn write(&self, folder: &Path) -> Result<(), RunError> {
        let bytes = serde_json::to_vec_pretty(self)?;
        if bytes.len() as u64 > LARGEST {
            return Err(RunError::Refused(format!("the request is larger than {} MB", LARGEST >> 20)));
        }
        // Its lock marks the folder as the program's own, so that the job may use it.
        Ok(Folder::open(folder)?.write(FILE, &bytes)?)
    }

    /// Reads the file in a job's folder; `None` in other folders.
    pub(crate) fn read(folder: &Path) -> Option<Self> {
        let bytes = read_regular(&folder.join(FILE), LARGEST).ok()??;
        serde_json::from_slice(&bytes).ok()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_was_asked_is_kept_in_a_folder_that_the_work_may_take() {
        let root = tempfile::tempdir().unwrap();
        let folder = root.path().join("run-1");
        let mut file = JobFile {
            kind: "judge".into(),
            title: "base on filter".into(),
            asked: json!({ "base": "1" }),
            request: json!({ "base": "1", "changes": ["a=1"] }),
            ended: None,
        };
        assert_eq!(JobFile::read(&folder), None);
        file.write(&folder).unwrap();
        assert_eq!(JobFile::read(&folder).as_ref(), Some(&file));
        assert!(crate::run::folder::claim(&folder, FolderKind::Run, false).is_ok());
        file.ended = Some((JobState::Failed, "the disk is full".into()));
        file.write(&folder).unwrap();
        assert_eq!(JobFile::read(&folder).as_ref(), Some(&file));
        // A word of another version.
        let path = folder.join(FILE);
        let text = std::fs::read_to_string(&path).unwrap();
        std::fs::write(&path, text.replace("\"failed\"", "\"lost\"")).unwrap();
        assert_eq!(JobFile::read(&folder).as_ref(), Some(&file));
        file.request = "x".repeat(5 << 20).into();
        assert!(file.write(&root.path().join("run-2")).unwrap_err().to_string().contains("larger than 4 MB"));
        assert!(!root.path().join("run-2").exists());
        std::fs::write(folder.join("job.json"), "{").unwrap();
        assert_eq!(JobFile::read(&folder), None);
    }
}
