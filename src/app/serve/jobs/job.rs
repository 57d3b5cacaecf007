//! One job of the page: its request, its state, and its description for the page.

use std::path::Path;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Mutex, PoisonError};

use serde_json::{Value, json};

use super::work::Work;
use crate::serve::live::Live;
use voidwalk_core::text::shell_word;

/// State of a job.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum JobState {
    Waiting,
    Running,
    Stopped,
    Done,
    Refused,
    Failed,
}

impl JobState {
    /// In one word.
    pub fn words(self) -> &'static str {
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

/// One job.
pub struct Job {
    /// Its number.
    pub id: usize,
    /// Title of its card.
    pub title: String,
    /// The two sheets that it was asked for, as the page names them.
    pub asked: Value,
    /// Name of its folder inside the server's.
    pub folder: String,
    /// Work of the job.
    pub work: Work,
    /// State of the job.
    pub state: JobState,
    /// Why it ended without a result.
    pub message: String,
    /// JSON of its result for the page.
    pub result: Value,
    /// Progress while it is walked.
    pub live: Arc<Mutex<Live>>,
    /// Set to stop it.
    pub stop: Arc<AtomicBool>,
}

impl Job {
    /// One that nothing was done of.
    pub fn new(id: usize, title: String, folder: String, work: Work, state: JobState) -> Self {
        let (live, stop) = (Arc::default(), Arc::default());
        let (message, result, asked) = (String::new(), Value::Null, Value::Null);
        Self { id, title, asked, folder, work, state, message, result, live, stop }
    }

    /// True if it waits and its work is known.
    pub fn can_begin(&self) -> bool {
        self.state == JobState::Waiting && !matches!(self.work, Work::Nothing)
    }

    /// True if it can continue: if it ended early in a folder that the command line would resume. A request
    /// that was refused before any work would be refused again.
    pub fn can_continue(&self, root: &Path) -> bool {
        let ended_early = match self.state {
            JobState::Stopped | JobState::Failed => true,
            JobState::Refused => has_scene(&root.join(&self.folder)),
            JobState::Waiting | JobState::Running | JobState::Done => false,
        };
        ended_early && !matches!(self.work, Work::Nothing)
    }

    /// JSON of the job for the page; messages pass through `named`.
    pub fn snapshot(&self, all: &[Job], root: &Path, named: &impl Fn(&str) -> String) -> Value {
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
            "state": self.state.words(),
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

/// A result whose every text has passed through `named`.
fn all_said(value: &Value, named: &impl Fn(&str) -> String) -> Value {
    match value {
        Value::String(text) => Value::String(named(text)),
        Value::Array(all) => all.iter().map(|one| all_said(one, named)).collect(),
        Value::Object(all) => all.iter().map(|(key, one)| (key.clone(), all_said(one, named))).collect(),
        other => other.clone(),
    }
}

/// True if a folder holds the scene of a run that has begun, which the command line resumes.
pub fn has_scene(folder: &Path) -> bool {
    folder.join("scene.toml").is_file()
}

/// Hint for continuing a job that was stopped.
pub fn how_to_continue(folder: &Path) -> String {
    let resume = match has_scene(folder) {
        true => format!(", or `voidwalk resume {}`,", shell_word(&folder.display().to_string())),
        false => String::new(),
    };
    format!("what is done is saved; Continue{resume} goes on from it")
}
