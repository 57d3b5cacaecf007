//! The jobs that an earlier server left in its folder.

use std::path::Path;

use serde_json::Value;

use super::job::{Job, JobState, has_scene, how_to_continue};
use super::work::{Work, of_run};
use crate::outcome::record::Outcome;
use crate::run::FolderKind;
use crate::serve::batches::of_batch;
use crate::serve::job_file::JobFile;
use crate::verdict::WalkedBatch;
use voidwalk_core::store::format::from_json;
use voidwalk_core::store::read_whole;

/// The last number of a job.
pub const LAST: usize = 999_999;

/// The number of a job's folder.
fn number(name: &str) -> Option<usize> {
    let (kind, id) = name.split_once('-')?;
    let id = id.parse().ok().filter(|id| (1..=LAST).contains(id))?;
    // No second folder has the same number by `+1` or `01`.
    (name == format!("{kind}-{id}") && kind.bytes().all(|b| b.is_ascii_lowercase())).then_some(id)
}

/// The newest of them, at most `most`, the oldest first.
pub fn earlier(root: &Path, most: usize) -> Vec<Job> {
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

/// True if a folder holds nothing but marks of the program: a job that was never accepted.
fn holds_nothing(folder: &Path) -> bool {
    let entries = std::fs::read_dir(folder);
    entries.is_ok_and(|mut entries| {
        entries.all(|entry| entry.is_ok_and(|entry| entry.file_name().as_encoded_bytes().starts_with(b".")))
    })
}

/// A job that an earlier server left; `None` if the folder of this name holds no job.
fn earlier_job(id: usize, name: String, root: &Path) -> Option<Job> {
    let path = root.join(&name);
    let file = JobFile::read(&path);
    let is_ours = ["run-", "batch-"].iter().any(|kind| name.starts_with(kind));
    if file.is_none() && (!is_ours || holds_nothing(&path)) {
        return None;
    }
    let record = |kind: FolderKind| read_whole(&path.join(kind.record())).ok();
    let done = match FolderKind::of(&path).filter(|kind| kind.is_finished(&path).unwrap_or(false)) {
        Some(FolderKind::Run) => record(FolderKind::Run)
            .and_then(|bytes| from_json::<Outcome>(&bytes).ok())
            .map(|outcome| of_run(&outcome, &outcome.decision())),
        // Without its page it is not whole, and the same call writes it.
        Some(FolderKind::Batch) if path.join("batch.html").is_file() => record(FolderKind::Batch)
            .and_then(|bytes| from_json::<WalkedBatch>(&bytes).ok())
            .map(|batch| of_batch(&batch)),
        Some(FolderKind::Batch) | None => None,
        Some(kind) => record(kind).and_then(|bytes| from_json(&bytes).ok()),
    };
    let ended = file.as_ref().and_then(|file| file.ended.clone());
    let title =
        file.as_ref().map_or_else(|| format!("{name}, of an earlier start"), |file| file.title.clone());
    let work = match &file {
        Some(_) => Work::Kept,
        None if has_scene(&path) => Work::Resume,
        None => Work::Nothing,
    };
    let mut job = Job::new(id, title, name, work, JobState::Stopped);
    job.asked = file.map_or(Value::Null, |file| file.asked);
    (job.state, job.message, job.result) = match (done, ended) {
        (Some(result), _) => (JobState::Done, String::new(), result),
        (None, Some((state, message))) if state == JobState::Refused.words() => {
            (JobState::Refused, message, Value::Null)
        }
        (None, Some((_, message))) => (JobState::Failed, message, Value::Null),
        (None, None) if matches!(job.work, Work::Nothing) => {
            let message = "the server ended before this was done, and what was asked is not known";
            (JobState::Stopped, message.into(), Value::Null)
        }
        (None, None) => (JobState::Stopped, how_to_continue(&path), Value::Null),
    };
    Some(job)
}
