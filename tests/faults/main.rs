//! Faults of the disk: every call fails, is the last before a kill, or loses its power, in a run, its resume, a packing and a
//! campaign. Afterwards the work goes on and must give the bytes of the unbroken work.
//!
//! `cargo test` tries a fixed part of all calls; `VOIDWALK_FAULTS=all cargo test --release --test faults` all of them.
//! This program has a `main` of its own because it starts itself again: with the variable [`disk::VARIABLE`] it is voidwalk on
//! a disk that fails, so nothing of this is in the program that users have.

mod disk;
mod kills;
mod power;

use std::collections::BTreeMap;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, ExitCode, Output};
use std::sync::atomic::{AtomicUsize, Ordering};

use disk::{Noted, VARIABLE};
use power::{Model, Unsynced};
use serde_json::Value;
use voidwalk::store::checkpoint::{Checkpoint, newest};

fn main() -> ExitCode {
    if let Ok(words) = std::env::var(VARIABLE) {
        if let Some(disk) = disk::from_words(&words) {
            voidwalk::store::disk::replace_disk(disk);
        }
        return voidwalk::cli::main();
    }
    // The longest first.
    let tests: [(&str, fn()); 7] = [
        ("what_is_killed_at_any_change_of_a_name_becomes_what_unbroken_work_is", kills::at_every_name),
        ("a_run_outlives_the_failure_of_every_call", || each_failure(&RUN)),
        ("a_resume_outlives_the_failure_of_every_call", || each_failure(&RESUME)),
        ("a_mapped_run_outlives_the_failure_of_every_call", || each_failure(&MAPPED)),
        ("a_packing_outlives_the_failure_of_every_call", || each_failure(&PACKING)),
        ("a_campaign_outlives_the_failure_of_every_call", || each_failure(&CAMPAIGN)),
        ("a_power_cut_at_any_sync_loses_nothing_that_was_synced", power_cuts),
    ];
    let wanted: Vec<String> = std::env::args().skip(1).filter(|word| !word.starts_with('-')).collect();
    let is_wanted = |name: &str| wanted.is_empty() || wanted.iter().any(|word| name.contains(word.as_str()));
    // Two at a time: their work has one thread and waits for the disk.
    let next = AtomicUsize::new(0);
    let take = || tests.get(next.fetch_add(1, Ordering::Relaxed));
    std::thread::scope(|scope| {
        for _ in 0..2 {
            scope.spawn(|| {
                while let Some((name, test)) = take() {
                    if is_wanted(name) {
                        test();
                        println!("test {name} ... ok");
                    }
                }
            });
        }
    });
    ExitCode::SUCCESS
}

/// Work that a folder is filled by.
struct Work {
    name: &'static str,
    /// Files that are there before.
    files: &'static [(&'static str, &'static str)],
    command: &'static [&'static str],
    /// Folder of the results.
    out: &'static str,
    /// A call of the command that is the last before a kill, by its share of all calls; what follows is the work.
    killed_at: Option<f64>,
    /// Commands that were done in the folder before.
    before: &'static [&'static [&'static str]],
    /// Of how many calls one is tried, unless all are.
    one_in: usize,
}

const SCENE: &str = "seed = 3\nreplicates = 2\nengine = \"particles\"\n[filter]\ncurve = \"shire2016-cu1.5-loose\"\n[base]\ncu = 1.5\n\
    d85_at_dc = 5\nn_base = 2000\n[network]\nnx = 4\nny = 4\nnz = 5\n[record]\nsensitivity = [2.0]\nsensitivity_replicates = 1\n";
const FILTER: &str =
    "[filter]\ncu = 1.5\ndensity = \"loose\"\n[packing]\ngrains = 150\nstiffness_ratio = 0.01\n";
const PLAN: &str = "title = \"two\"\nseed = 5\n[set]\nreplicates = 2\nnetwork = { nx = 4, ny = 4, nz = 5 }\n\
    base = { n_base = 2000 }\nengine = \"particles\"\nrecord = { sensitivity = [] }\n\
    [[factor]]\nname = \"cu_b\"\nsetting = \"base.cu\"\nvalues = [1.5, 3]\n";

const RUN: Work = Work {
    name: "run",
    files: &[("scene.toml", SCENE)],
    command: &[
        "run",
        "scene.toml",
        "--out",
        "r",
        "--threads",
        "1",
        "-q",
        "--checkpoint-every",
        "70increments",
    ],
    out: "r",
    killed_at: None,
    before: &[],
    one_in: 19,
};
const RESUME: Work = Work { name: "resume", killed_at: Some(0.3), one_in: 23, ..RUN };
/// The same with the particles in mapped files.
const MAPPED: Work = Work {
    name: "mapped run",
    command: &[
        "run",
        "scene.toml",
        "--out",
        "r",
        "--threads",
        "1",
        "-q",
        "--checkpoint-every",
        "70increments",
        "--memory",
        "100kB",
    ],
    one_in: 43,
    ..RUN
};
const PACKING: Work = Work {
    name: "packing",
    files: &[("filter.toml", FILTER)],
    command: &["pack", "filter.toml", "--out", "p", "--threads", "1", "-q", "--checkpoint-every", "50ms"],
    out: "p",
    one_in: 25,
    ..RUN
};
const CAMPAIGN: Work = Work {
    name: "campaign",
    files: &[("plan.toml", PLAN)],
    command: &[
        "campaign",
        "plan.toml",
        "--out",
        "c",
        "--threads",
        "1",
        "-q",
        "--checkpoint-every",
        "100increments",
    ],
    out: "c",
    one_in: 31,
    ..RUN
};

/// What of a record differs between two times that the same work is done.
const TIMES: [&str; 8] = ["seconds", "made", "threads", "host", "machine", "started", "finished", "command"];

/// Input or output error, disk full, interrupted.
const ERRNOS: [(i32, &str); 3] = [(5, "EIO"), (28, "ENOSPC"), (4, "EINTR")];

fn is_all() -> bool {
    std::env::var("VOIDWALK_FAULTS").is_ok_and(|value| value == "all")
}

/// A folder of its own, in memory where that is possible: thousands of syncs are quick there.
fn room() -> tempfile::TempDir {
    let memory = Path::new("/dev/shm");
    if memory.is_dir() { tempfile::tempdir_in(memory).unwrap() } else { tempfile::tempdir().unwrap() }
}

/// Starts this program as voidwalk, on the disk that these words describe or on the real one.
fn call(at: &Path, args: &[&str], words: Option<&str>) -> Output {
    let mut command = Command::new(std::env::current_exe().unwrap());
    command.current_dir(at).args(args).env(VARIABLE, words.unwrap_or("real")).output().unwrap()
}

fn stderr(output: &Output) -> String {
    String::from_utf8_lossy(&output.stderr).into_owned()
}

impl Work {
    /// A new folder with the work about to begin: nothing done, or what a killed process has left.
    fn ready(&self) -> tempfile::TempDir {
        let root = room();
        for (name, text) in self.files {
            fs::write(root.path().join(name), text).unwrap();
        }
        for command in self.before {
            let output = call(root.path(), command, None);
            assert!(output.status.success(), "{}", stderr(&output));
        }
        if let Some(share) = self.killed_at {
            let number = (share * self.noted(root.path()).len() as f64) as usize;
            fs::remove_dir_all(root.path().join(self.out)).unwrap();
            let killed = call(root.path(), self.command, Some(&format!("kill {number}")));
            assert_eq!(killed.status.code(), None, "{}", stderr(&killed));
            assert!(!checkpoints(root.path()).is_empty(), "it was killed before its first checkpoint");
        }
        root
    }

    /// The calls of the whole command, which is run.
    fn noted(&self, at: &Path) -> Vec<Noted> {
        let file = at.join("notes");
        let output = call(at, self.command, Some(&format!("note {}", file.display())));
        assert!(output.status.success(), "{}", stderr(&output));
        let notes = disk::notes(&file);
        fs::remove_file(file).unwrap();
        notes
    }

    /// Goes on until the work is whole, as a user would.
    fn go_on(&self, at: &Path) {
        let out = self.out;
        let resumes = self.command[0] == "run" && at.join(out).join("scene.toml").exists();
        let output = match resumes {
            true => call(at, &["resume", out, "-q", "--threads", "1"], None),
            false => call(at, self.command, None),
        };
        match output.status.code() {
            Some(0) => {}
            // All of it was there, the page too.
            Some(2)
                if stderr(&output).contains("finished") || stderr(&output).contains("holds a packing") => {}
            code => panic!("{code:?}: {}", stderr(&output)),
        }
    }
}

/// Every file of a finished folder without what a clock or a process number says.
fn lasting(folder: &Path) -> BTreeMap<PathBuf, String> {
    fn strip(value: &mut Value) {
        match value {
            Value::Object(map) => {
                TIMES.iter().for_each(|name| drop(map.remove(*name)));
                map.values_mut().for_each(strip);
            }
            Value::Array(items) => items.iter_mut().for_each(strip),
            _ => {}
        }
    }
    let mut all = BTreeMap::new();
    let mut folders = vec![folder.to_owned()];
    while let Some(at) = folders.pop() {
        for entry in fs::read_dir(at).unwrap() {
            let path = entry.unwrap().path();
            if path.is_dir() {
                folders.push(path);
                continue;
            }
            let text = String::from_utf8_lossy(&fs::read(&path).unwrap()).into_owned();
            let name = path.strip_prefix(folder).unwrap().to_owned();
            let text = match name.file_name().unwrap().to_str().unwrap() {
                ".voidwalk.lock" | "report.html" => String::new(),
                json if json.ends_with(".json") || json.ends_with(".jsonl") => {
                    let values = serde_json::Deserializer::from_str(&text).into_iter::<Value>();
                    let mut values: Vec<Value> = values.map(Result::unwrap).collect();
                    values.iter_mut().for_each(strip);
                    format!("{values:?}")
                }
                _ => text,
            };
            all.insert(name, text);
        }
    }
    all
}

/// Files of checkpoints below a folder, their names without the slot, and the folder that each lies in.
fn checkpoints(at: &Path) -> Vec<(PathBuf, String)> {
    let (mut found, mut folders) = (Vec::new(), vec![at.to_owned()]);
    while let Some(folder) = folders.pop() {
        for entry in fs::read_dir(&folder).unwrap() {
            let path = entry.unwrap().path();
            if path.is_dir() {
                folders.push(path);
            } else if path.extension().is_some_and(|slot| slot == "0" || slot == "1") {
                found.push((folder.clone(), path.file_stem().unwrap().to_str().unwrap().into()));
            }
        }
    }
    found.sort();
    found.dedup();
    found
}

/// The generation of the newest checkpoint of each name; every slot must be whole.
fn generations(at: &Path) -> BTreeMap<(PathBuf, String), u64> {
    let mut all = BTreeMap::new();
    for (folder, name) in checkpoints(at) {
        let slots = [0, 1].map(|slot| Checkpoint::open(&folder.join(format!("{name}.{slot}"))).unwrap());
        let identity = slots.into_iter().flatten().next().unwrap().label.identity;
        let (saved, passed_over) = newest(&folder, &name, &identity).unwrap();
        assert!(passed_over.is_empty(), "{passed_over:?}");
        all.insert((folder.strip_prefix(at).unwrap().to_owned(), name), saved.unwrap().label.generation);
    }
    all
}

fn copy(from: &Path, to: &Path) {
    for entry in fs::read_dir(from).unwrap() {
        let entry = entry.unwrap();
        let to = to.join(entry.file_name());
        if entry.path().is_dir() {
            fs::create_dir(&to).unwrap();
            copy(&entry.path(), &to);
        } else {
            fs::copy(entry.path(), to).unwrap();
        }
    }
}

/// Fails every call in turn, with every error, before it does its work and after.
fn each_failure(work: &Work) {
    let ready = work.ready();
    let whole = room();
    copy(ready.path(), whole.path());
    let calls = work.noted(whole.path());
    let expected = lasting(&whole.path().join(work.out));
    let before = generations(ready.path());
    assert!(calls.iter().filter(|call| call.kind == "sync").count() > 10, "{} calls", calls.len());
    let (mut tried, mut ended, mut harmless) = (0, 0, 0);
    for (errno, name) in ERRNOS {
        for way in ["fail", "late"] {
            if way == "late" && errno != 5 {
                continue;
            }
            let step = if is_all() { 1 } else { work.one_in };
            for number in (1 + tried % step..=calls.len()).step_by(step) {
                let call_of = calls.get(number - 1);
                let words = format!("{way} {number} {errno}");
                let root = room();
                copy(ready.path(), root.path());
                let output = call(root.path(), work.command, Some(&words));
                let what = format!("{}: {words} ({call_of:.0?}): {}", work.name, stderr(&output));
                tried += 1;
                match output.status.code() {
                    Some(0) => {
                        // An interrupted call is made again; a look that fails may not matter.
                        harmless += 1;
                        assert_eq!(lasting(&root.path().join(work.out)), expected, "{what}");
                        continue;
                    }
                    Some(1) if name != "EINTR" => {
                        ended += 1;
                        assert!(stderr(&output).lines().any(|line| line.starts_with("error: ")), "{what}");
                        assert!(stderr(&output).trim().len() > 20, "{what}");
                    }
                    _ => panic!("{what}"),
                }
                // What was on the disk before is still there, whole.
                let after = generations(root.path());
                if !root.path().join(work.out).join("manifest.json").exists() {
                    for (name, generation) in &before {
                        assert!(
                            after.get(name).is_some_and(|now| now >= generation),
                            "{what}: {name:?} is lost"
                        );
                    }
                }
                work.go_on(root.path());
                let found = lasting(&root.path().join(work.out));
                assert_eq!(found.keys().collect::<Vec<_>>(), expected.keys().collect::<Vec<_>>(), "{what}");
                assert!(found == expected, "{what}: other results");
            }
        }
    }
    println!(
        "  {}: {} calls, {tried} failures: {ended} ended with an error and went on, {harmless} changed nothing; 0 other results",
        work.name,
        calls.len()
    );
}

/// Cuts the power after every sync of a file or folder, and just before.
fn power_cuts() {
    for work in [&RUN, &PACKING, &CAMPAIGN] {
        let ready = work.ready();
        let whole = room();
        copy(ready.path(), whole.path());
        let calls = work.noted(whole.path());
        let expected = lasting(&whole.path().join(work.out));
        let syncs: Vec<usize> =
            (0..calls.len()).filter(|&at| ["sync", "names"].contains(&calls[at].kind.as_str())).collect();
        let (mut cuts, mut cases) = (0, 0);
        for (index, &sync) in syncs.iter().enumerate() {
            for after in [sync, sync + 1] {
                let luck = (2 * index + after - sync) as u64;
                let all = [
                    Unsynced::Dropped,
                    Unsynced::NamesOnly,
                    Unsynced::Garbled,
                    Unsynced::Kept,
                    Unsynced::ByLuck(luck),
                ];
                for (kind, unsynced) in all.into_iter().enumerate() {
                    cases += 1;
                    let ours = luck as usize * all.len() + kind;
                    if !is_all() && !ours.is_multiple_of(2 * work.one_in) {
                        continue;
                    }
                    let root = room();
                    copy(ready.path(), root.path());
                    Model::after(&calls[..after]).write(root.path(), unsynced);
                    cuts += 1;
                    // What was written before its name was given is whole, and so is every checkpoint.
                    generations(root.path());
                    work.go_on(root.path());
                    let found = lasting(&root.path().join(work.out));
                    let what = format!("{}: {unsynced:?} after call {after}", work.name);
                    assert_eq!(
                        found.keys().collect::<Vec<_>>(),
                        expected.keys().collect::<Vec<_>>(),
                        "{what}"
                    );
                    assert!(found == expected, "{what}: other results");
                }
            }
        }
        println!(
            "  {}: {} syncs, {cuts} of {cases} power cuts tried; 0 other results",
            work.name,
            syncs.len()
        );
    }
}
