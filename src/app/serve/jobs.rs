//! Jobs requested by the page: one is walked at a time, the others wait.
//!
//! A job is a call of the library into its own folder, the same folder of a run or batch as from the command
//! line. The request is stored there before any work ([`JobFile`]), so that a later server on the same folder
//! can do it.

use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};
use std::sync::{Arc, Condvar, Mutex, MutexGuard, PoisonError};

use serde_json::Value;

use super::job::{
    Job, JobFile, JobState, LAST, OnResults, Work, WorkContext, earlier, has_scene, how_to_continue,
};
use super::live::Live;
use crate::run::error::Exit;
use crate::run::{PrepareOptions, RunError};
use voidwalk_core::store::remove_folder;
use voidwalk_core::text::shell_word;

const WAITING: usize = 20;

/// Maximum number of jobs listed; the earliest finished are dropped, but their folders stay.
const LISTED: usize = 200;

pub(crate) struct JobQueue {
    context: WorkContext,
    all: Mutex<Vec<Job>>,
    last: AtomicUsize,
    wake: Condvar,
    ends: AtomicBool,
}

impl JobQueue {
    /// Jobs of an earlier server in `root`, and no others yet.
    pub(crate) fn new(root: &Path, prepare: PrepareOptions, command: String, on_results: OnResults) -> Self {
        let all = earlier(root, LISTED);
        let last = AtomicUsize::new(all.iter().map(|job| job.id).max().unwrap_or(0));
        let context = WorkContext { root: root.to_owned(), prepare, command, on_results };
        let (all, ends) = (Mutex::new(all), AtomicBool::new(false));
        Self { context, all, last, wake: Condvar::new(), ends }
    }

    fn locked(&self) -> MutexGuard<'_, Vec<Job>> {
        self.all.lock().unwrap_or_else(PoisonError::into_inner)
    }

    fn has_room(&self, all: &[Job]) -> Result<(), String> {
        if self.ends.load(Ordering::Relaxed) {
            return Err("the server ends".into());
        }
        match all.iter().filter(|job| job.state == JobState::Waiting).count() >= WAITING {
            true => Err(format!("{WAITING} jobs wait already; stop some first")),
            false => Ok(()),
        }
    }

    /// Adds a job, stores its request in its folder, and returns its number; refuses if too many wait.
    pub(crate) fn add(&self, file: JobFile, work: Work) -> Result<usize, RunError> {
        let has_room = |all: &[Job]| self.has_room(all).map_err(RunError::Refused);
        has_room(&self.locked())?;
        let path = |id: &usize| self.context.root.join(format!("{}-{id}", work.name()));
        let is_free = |id: &usize| path(id).symlink_metadata().is_err();
        let numbers = std::iter::repeat_with(|| self.last.fetch_add(1, Ordering::Relaxed) + 1);
        let id = numbers.take_while(|id| *id <= LAST).find(is_free);
        let id = id.ok_or_else(|| RunError::Refused("this folder is full: start on another".into()))?;
        let written = file.write(&path(&id)).map_err(|error| RunError::failed(error.to_string()));
        let mut all = self.locked();
        // Meanwhile other jobs may have been added, or the server stopped.
        if let Err(error) = written.and_then(|()| has_room(&all)) {
            drop(all);
            // The folder was new, so its contents belong to this job, which does not start.
            let _ = remove_folder(&path(&id));
            let _ = self.last.compare_exchange(id, id - 1, Ordering::Relaxed, Ordering::Relaxed);
            return Err(error);
        }
        let folder = format!("{}-{id}", work.name());
        let JobFile { title, asked, .. } = file;
        let at = all.partition_point(|job| job.id < id);
        all.insert(at, Job { asked, ..Job::new(id, title, folder, work, JobState::Waiting) });
        shorten(&mut all);
        self.wake.notify_all();
        Ok(id)
    }

    pub(crate) fn stop(&self, id: usize) -> Result<(), String> {
        let mut all = self.locked();
        let job = all.iter_mut().find(|job| job.id == id).ok_or("there is no such job")?;
        match job.state {
            JobState::Running => job.stop.store(true, Ordering::Relaxed),
            JobState::Waiting => {
                (job.state, job.message) = (JobState::Stopped, "stopped before it began".into());
            }
            _ => return Err("this job is not under way".into()),
        }
        Ok(())
    }

    /// Stored request of a job that can continue; `None` if the run in its folder is to be resumed.
    pub(crate) fn kept(&self, id: usize) -> Result<Option<JobFile>, String> {
        let folder = {
            let mut all = self.locked();
            let job = self.that_continues(&mut all, id)?;
            if matches!(job.work, Work::Resume) {
                return Ok(None);
            }
            self.context.root.join(&job.folder)
        };
        match JobFile::read(&folder) {
            None if !has_scene(&folder) => Err("the request of this job is lost; ask again".into()),
            file => Ok(file),
        }
    }

    fn that_continues<'a>(&self, all: &'a mut [Job], id: usize) -> Result<&'a mut Job, String> {
        let job = all.iter_mut().find(|job| job.id == id).ok_or("there is no such job")?;
        if job.can_continue(&self.context.root) { Ok(job) } else { Err("this job cannot continue".into()) }
    }

    /// True if a job's folder holds the scene of a run that has begun, which can be resumed.
    pub(crate) fn has_scene(&self, id: usize) -> bool {
        self.locked().iter().any(|job| job.id == id && has_scene(&self.context.root.join(&job.folder)))
    }

    /// Continues a job that was stopped or has failed, with its work planned again.
    pub(crate) fn resume(&self, id: usize, work: Work) -> Result<(), String> {
        let folder = {
            let mut all = self.locked();
            self.has_room(&all)?;
            let job = self.that_continues(&mut all, id)?;
            // It begins when its work is set.
            (job.work, job.state, job.message) = (Work::Nothing, JobState::Waiting, String::new());
            job.stop.store(false, Ordering::Relaxed);
            *job.live.lock().unwrap_or_else(PoisonError::into_inner) = Live::default();
            self.context.root.join(&job.folder)
        };
        // Its recorded end no longer applies.
        if let Some(file) = JobFile::read(&folder).filter(|file| file.ended.is_some()) {
            let _ = JobFile { ended: None, ..file }.write(&folder);
        }
        let mut all = self.locked();
        all.iter_mut().find(|job| job.id == id).ok_or("there is no such job")?.work = work;
        self.wake.notify_all();
        Ok(())
    }

    /// Stops all jobs and starts no more; returns the numbers of jobs that were running or waiting.
    pub(crate) fn stop_all(&self) -> Vec<usize> {
        let mut all = self.locked();
        self.ends.store(true, Ordering::Relaxed);
        let open = all.iter_mut().filter(|job| matches!(job.state, JobState::Waiting | JobState::Running));
        open.map(|job| {
            match job.state {
                JobState::Waiting => job.state = JobState::Stopped,
                _ => job.stop.store(true, Ordering::Relaxed),
            }
            job.id
        })
        .collect()
    }

    /// Result of these jobs once nothing is walked any more: an error if one failed, else if one is not done.
    pub(crate) fn ended(&self, ids: &[usize]) -> Result<(), RunError> {
        let all = self.locked();
        let in_state =
            |state: JobState| all.iter().filter(move |job| ids.contains(&job.id) && job.state == state);
        let path = |job: &Job| self.context.root.join(&job.folder).display().to_string();
        if let Some(failed) = in_state(JobState::Failed).next() {
            return Err(RunError::failed(format!("{}: {}", path(failed), failed.message)));
        }
        let stopped: Vec<String> = in_state(JobState::Stopped).map(path).collect();
        match stopped.is_empty() {
            true => Ok(()),
            false => Err(RunError::Stopped(format!(
                "not done, with all finished work saved: {}; `voidwalk serve --out {}` lists it, and \
                 Continue on its page goes on",
                stopped.join(", "),
                shell_word(&self.context.root.display().to_string())
            ))),
        }
    }

    pub(crate) fn folder(&self, name: &str) -> Option<PathBuf> {
        self.locked().iter().any(|job| job.folder == name).then(|| self.context.root.join(name))
    }

    pub(crate) fn snapshot(&self, named: impl Fn(&str) -> String) -> Value {
        let all = self.locked();
        all.iter().rev().map(|job| job.snapshot(&all, &self.context.root, &named)).collect()
    }

    pub(crate) fn work_until(&self, over: &AtomicBool) {
        while !over.load(Ordering::Relaxed) {
            let Some(next) = self.next() else { continue };
            let (id, folder, work, live, stop) = next;
            let walked = catch_unwind(AssertUnwindSafe(|| self.context.work(&folder, &work, &live, &stop)));
            let walked = walked.unwrap_or_else(|_| Err(RunError::failed("a fault of the program")));
            let (state, message, result) = match walked {
                Ok(result) => (JobState::Done, String::new(), result),
                Err(error) if error.exit() == Exit::Stopped => {
                    (JobState::Stopped, how_to_continue(&folder), Value::Null)
                }
                Err(error) => {
                    let is_refused = error.exit() == Exit::Refused;
                    let state = if is_refused { JobState::Refused } else { JobState::Failed };
                    let advice = error.advice().map_or(String::new(), |advice| format!("\n{advice}"));
                    (state, format!("{error}{advice}"), Value::Null)
                }
            };
            let ended = matches!(state, JobState::Refused | JobState::Failed);
            let file = JobFile::read(&folder);
            if let Some(file) = file.clone().filter(|_| ended) {
                // If this cannot be written, the next server offers to continue the job, which does no harm.
                let ended = Some((state, message.clone()));
                let _ = JobFile { ended, ..file }.write(&folder);
            }
            let mut all = self.locked();
            let Some(job) = all.iter_mut().find(|job| job.id == id) else { continue };
            if state == JobState::Done {
                job.live.lock().unwrap_or_else(PoisonError::into_inner).end_batch();
            }
            (job.state, job.message, job.result) = (state, message, result);
            // A scene is large, and no longer needed.
            if file.is_some() {
                job.work = Work::Kept;
            }
        }
    }

    /// Starts the job that has waited longest and returns it; waits briefly if there is none.
    #[allow(clippy::type_complexity)]
    fn next(&self) -> Option<(usize, PathBuf, Work, Arc<Mutex<Live>>, Arc<AtomicBool>)> {
        let mut all = self.locked();
        if !all.iter().any(Job::can_begin) {
            let patience = std::time::Duration::from_millis(200);
            all = self.wake.wait_timeout(all, patience).unwrap_or_else(PoisonError::into_inner).0;
        }
        let job = all.iter_mut().find(|job| job.can_begin())?;
        job.state = JobState::Running;
        let folder = self.context.root.join(&job.folder);
        Some((job.id, folder, job.work.clone(), Arc::clone(&job.live), Arc::clone(&job.stop)))
    }
}

fn shorten(all: &mut Vec<Job>) {
    let mut more = all.len().saturating_sub(LISTED);
    all.retain(|job| {
        let stays = more == 0 || matches!(job.state, JobState::Waiting | JobState::Running);
        more -= usize::from(!stays);
        stays
    });
}

#[cfg(test)]
mod tests {
    use super::*;
    use serde_json::json;

    fn queue(root: &Path) -> JobQueue {
        JobQueue::new(root, PrepareOptions::default(), String::new(), |_, _, _| Ok(()))
    }

    fn file() -> JobFile {
        let (title, asked) = ("a job".into(), json!({ "base": "1" }));
        JobFile { kind: "judge".into(), title, asked, request: json!({}), ended: None }
    }

    fn set(queue: &JobQueue, id: usize, state: JobState) {
        let mut all = queue.locked();
        let job = all.iter_mut().find(|job| job.id == id).unwrap();
        (job.state, job.message) = (state, format!("it is {state:?}"));
    }

    fn write_end(folder: &Path, state: JobState) {
        let ended = Some((state, "why".to_owned()));
        JobFile { ended, ..file() }.write(folder).unwrap();
    }

    #[test]
    fn how_a_server_ends_is_how_what_was_under_way_ended() {
        let root = tempfile::tempdir().unwrap();
        let queue = queue(root.path());
        let ids = [(); 4].map(|()| queue.add(file(), Work::Kept).unwrap());
        // The first is being walked, the second was already stopped, the others wait.
        set(&queue, ids[0], JobState::Running);
        set(&queue, ids[1], JobState::Stopped);
        let open = queue.stop_all();
        assert_eq!(open, [ids[0], ids[2], ids[3]]);
        assert!(queue.add(file(), Work::Kept).is_err() && queue.resume(ids[1], Work::Kept).is_err());
        set(&queue, ids[0], JobState::Done);
        let error = queue.ended(&open).unwrap_err();
        assert_eq!(error.exit(), Exit::Stopped);
        assert!(error.to_string().contains("run-3") && !error.to_string().contains("run-1"), "{error}");
        set(&queue, ids[0], JobState::Failed);
        let error = queue.ended(&open).unwrap_err();
        assert_eq!(error.exit(), Exit::Failed);
        assert!(error.to_string().ends_with("run-1: it is Failed"), "{error}");
        for state in [JobState::Done, JobState::Refused, JobState::Stopped] {
            set(&queue, ids[0], state);
            assert_eq!(queue.ended(&ids[..1]).is_ok(), state != JobState::Stopped, "{state:?}");
        }
    }

    #[test]
    fn no_more_wait_than_may_however_they_came() {
        let root = tempfile::tempdir().unwrap();
        let queue = queue(root.path());
        let first = queue.add(file(), Work::Kept).unwrap();
        queue.stop(first).unwrap();
        (0..WAITING).for_each(|_| assert!(queue.add(file(), Work::Kept).is_ok()));
        assert_eq!(queue.add(file(), Work::Kept).unwrap_err().exit(), Exit::Refused);
        assert!(queue.resume(first, Work::Kept).unwrap_err().contains("jobs wait already"));
    }

    #[test]
    fn jobs_that_come_at_once_are_numbered_and_listed_in_order() {
        let root = tempfile::tempdir().unwrap();
        let queue = queue(root.path());
        std::thread::scope(|scope| {
            (0..WAITING).for_each(|_| {
                scope.spawn(|| queue.add(file(), Work::Kept).unwrap());
            });
        });
        let ids: Vec<usize> = queue.locked().iter().map(|job| job.id).collect();
        assert_eq!(ids, (1..=WAITING).collect::<Vec<_>>());
        // A request that cannot be stored makes no job, and the next job takes its number.
        queue.stop(1).unwrap();
        let large = JobFile { request: "x".repeat(5 << 20).into(), ..file() };
        assert!(queue.add(large, Work::Kept).is_err() && !root.path().join("run-21").exists());
        assert_eq!(queue.add(file(), Work::Kept).unwrap(), 21);
    }

    #[test]
    fn every_job_of_an_earlier_server_is_listed_and_no_number_is_too_large() {
        let root = tempfile::tempdir().unwrap();
        let before = queue(root.path());
        let ids = [(); 3].map(|()| before.add(file(), Work::Kept).unwrap());
        for (id, state) in [(ids[1], JobState::Refused), (ids[2], JobState::Failed)] {
            write_end(&root.path().join(format!("run-{id}")), state);
        }
        let wrong = ["run-18446744073709551615", "run-99999999", "run-+9", "run-09", "run-x", "a-2"];
        for folder in wrong.into_iter().chain(["sheets-1000", "batch-7"]) {
            std::fs::create_dir(root.path().join(folder)).unwrap();
        }
        // The request of one job is unknown; another job, which left only the mark, was never accepted.
        std::fs::write(root.path().join("batch-7/cases.jsonl"), "").unwrap();
        std::fs::create_dir(root.path().join("run-5")).unwrap();
        std::fs::write(root.path().join("run-5/.voidwalk.lock"), "").unwrap();
        #[cfg(unix)]
        std::os::unix::fs::symlink("/tmp", root.path().join("run-8")).unwrap();
        let queue = queue(root.path());
        let told = queue.snapshot(str::to_owned);
        let states =
            |key: &str| told.as_array().unwrap().iter().map(|job| job[key].clone()).collect::<Vec<_>>();
        assert_eq!(states("id"), [7, 3, 2, 1]);
        assert_eq!(states("state"), ["stopped", "failed", "refused", "stopped"]);
        assert_eq!(states("can_continue"), [false, true, false, true]);
        assert_eq!((&told[1]["message"], &told[3]["title"]), (&json!("why"), &json!("a job")));
        assert_eq!(queue.kept(1), Ok(Some(file())));
        assert!(queue.kept(7).is_err() && queue.kept(2).is_err());
        // 9 is the next free number: 8 is taken by a link.
        assert_eq!(queue.add(file(), Work::Kept).unwrap(), 9);
    }

    #[test]
    fn of_very_many_jobs_the_first_to_end_are_left_out() {
        let job = |id| Job::new(id, String::new(), format!("run-{id}"), Work::Kept, JobState::Stopped);
        let mut all: Vec<Job> = (1..=LISTED + 3).map(job).collect();
        all[0].state = JobState::Running;
        all[2].state = JobState::Waiting;
        shorten(&mut all);
        let ids: Vec<usize> = all.iter().map(|job| job.id).collect();
        assert_eq!((all.len(), &ids[..3]), (LISTED, &[1, 3, 6][..]));
    }

    /// A job that a full disk ended can continue once there is room: the page resumes a folder whenever the
    /// command line does, on this server and the next.
    #[test]
    fn what_has_failed_can_continue() {
        let root = tempfile::tempdir().unwrap();
        let before = queue(root.path());
        let ids = [(); 3].map(|()| before.add(file(), Work::Kept).unwrap());
        let folder = |id: usize| root.path().join(format!("run-{id}"));
        for (id, state) in ids.into_iter().zip([JobState::Failed, JobState::Refused, JobState::Refused]) {
            set(&before, id, state);
            write_end(&folder(id), state);
        }
        std::fs::write(folder(ids[1]).join("scene.toml"), "").unwrap();
        let after = queue(root.path());
        for queue in [&before, &after] {
            let can = ids.map(|id| queue.kept(id).is_ok());
            assert_eq!(can, [true, true, false], "the last was refused before it began");
        }
        // The request is lost, but the scene is not.
        std::fs::write(folder(ids[1]).join("job.json"), "{").unwrap();
        assert_eq!(after.kept(ids[1]), Ok(None));
        // While it continues, no message reports a failure.
        after.resume(ids[0], Work::Kept).unwrap();
        assert_eq!(JobFile::read(&folder(ids[0])).unwrap().ended, None);
        assert!(after.resume(ids[0], Work::Kept).is_err(), "it waits already");
    }
}
