use serde_json::json;

use super::*;

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
    (job.state, job.message) = (state, format!("it is {}", state.words()));
}

#[test]
fn how_a_server_ends_is_how_what_was_under_way_ended() {
    let root = tempfile::tempdir().unwrap();
    let queue = queue(root.path());
    let ids = [(); 4].map(|()| queue.add(file(), Work::Kept).unwrap());
    // The first is walked, the second was stopped before, the others wait.
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
    assert!(error.exit() == Exit::Failed && error.to_string().ends_with("run-1: it is failed"), "{error}");
    for (state, ends_well) in [(JobState::Done, true), (JobState::Refused, true), (JobState::Stopped, false)]
    {
        set(&queue, ids[0], state);
        assert_eq!(queue.ended(&ids[..1]).is_ok(), ends_well, "{state:?}");
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
    // A request that cannot be kept makes no job, and the next job takes its number.
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
        let ended = Some((state.words().to_owned(), "why".to_owned()));
        JobFile { ended, ..file() }.write(&root.path().join(format!("run-{id}"))).unwrap();
    }
    for folder in [
        "run-18446744073709551615",
        "run-99999999",
        "run-+9",
        "run-09",
        "run-x",
        "a-2",
        "sheets-1000",
        "batch-7",
    ] {
        std::fs::create_dir(root.path().join(folder)).unwrap();
    }
    // The request of one job is unknown; another, which left only the mark, was never accepted.
    std::fs::write(root.path().join("batch-7/cases.jsonl"), "").unwrap();
    std::fs::create_dir(root.path().join("run-5")).unwrap();
    std::fs::write(root.path().join("run-5/.voidwalk.lock"), "").unwrap();
    #[cfg(unix)]
    std::os::unix::fs::symlink("/tmp", root.path().join("run-8")).unwrap();
    let queue = queue(root.path());
    let told = queue.snapshot(str::to_owned);
    let told: Vec<_> = told.as_array().unwrap().iter().collect();
    let states = |key: &str| told.iter().map(|job| job[key].clone()).collect::<Vec<_>>();
    assert_eq!(states("id"), [7, 3, 2, 1]);
    assert_eq!(states("state"), ["stopped", "failed", "refused", "stopped"]);
    assert_eq!(states("can_continue"), [false, true, false, true]);
    assert_eq!((&told[1]["message"], &told[3]["title"]), (&json!("why"), &json!("a job")));
    assert_eq!(queue.kept(1), Ok(Some(file())));
    assert!(queue.kept(7).is_err() && queue.kept(2).is_err());
    // The next number is free: under 8 there is a link.
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

/// A job that a full disk ended continues once there is room: if the command line resumes a folder, so does
/// the page, on this server and the next.
#[test]
fn what_has_failed_can_continue() {
    let root = tempfile::tempdir().unwrap();
    let before = queue(root.path());
    let ids = [(); 3].map(|()| before.add(file(), Work::Kept).unwrap());
    let folder = |id: usize| root.path().join(format!("run-{id}"));
    for (id, state) in ids.into_iter().zip([JobState::Failed, JobState::Refused, JobState::Refused]) {
        set(&before, id, state);
        let ended = Some((state.words().to_owned(), "the disk is full".to_owned()));
        JobFile { ended, ..file() }.write(&folder(id)).unwrap();
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
