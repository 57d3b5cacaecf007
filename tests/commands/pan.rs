//! A base whose finest sieve is coarser than the finest constriction: what is finer is walked as passive.

use std::fs;
use std::path::Path;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};

use serde_json::Value;
use voidwalk::run::{Callbacks, CheckpointInterval, Event, Exit, RunOptions, resume, walk_scene};
use voidwalk::scene::Scene;

use crate::program::{call, done};

/// A filter sand, and bases of which the finest sieve passes `pan` percent.
fn files(folder: &Path, pan: u32) {
    let table = |name: &str, rows: &str| {
        fs::write(folder.join(name), format!("opening_mm,percent_finer\n{rows}")).unwrap();
    };
    table("sand.csv", "1.18,100\n0.6,45\n0.425,15\n0.25,0\n");
    table("base.csv", &format!("0.3,100\n0.2,85\n0.15,{pan}\n"));
    fs::write(
        folder.join("scene.toml"),
        "replicates = 3\n[filter]\nsieve = \"sand.csv\"\nestimate = 0.5\ngrains_per_void = 0.6\n[base]\nsieve = \
         \"base.csv\"\n[network]\nnx = 8\nny = 8\nnz = 10\n[record]\nsensitivity = [0.5]\nsensitivity_replicates = 2\n",
    )
    .unwrap();
}

fn outcome(folder: &Path) -> Value {
    let mut value: Value = serde_json::from_slice(&fs::read(folder.join("outcome.json")).unwrap()).unwrap();
    // Times are no results.
    value["seconds"].take();
    for replicate in value["replicates"].as_array_mut().unwrap() {
        replicate["runs"].as_array_mut().unwrap().iter_mut().for_each(|run| drop(run["seconds"].take()));
    }
    value
}

/// The part below the finest sieve is walked finer than every constriction, and erodes more than any size
/// that a user gives for it.
#[test]
fn a_pan_fraction_that_may_block_is_walked_as_passive() {
    let root = tempfile::tempdir().unwrap();
    files(root.path(), 30);
    let check = call(root.path(), &["check", "scene.toml"]);
    done(&check);
    // Three replicates and two studied ones, three at either end of what is a guess, two of either other
    // thickness, two runs each.
    let text = String::from_utf8_lossy(&check.stdout).into_owned();
    assert!(text.contains("30 runs"), "{text}");
    let walked = |more: &[&str], out: &str| {
        done(&call(root.path(), &[&["run", "scene.toml", "--out", out], more].concat()));
        outcome(&root.path().join(out))
    };
    let eroded = |of: &Value| of["summary"][0]["eroded_mass_fraction"]["mean"].as_f64().unwrap();
    let note = |of: &Value| {
        let all = of["notes"].as_array().unwrap();
        all.iter().find(|finding| finding["id"] == "pan_counts_as_passing").cloned()
    };
    let passive = walked(&[], "passive");
    let found = note(&passive).expect("a note of the finest part");
    let number = |name: &str| found["numbers"][name].as_f64().unwrap();
    assert!(
        (number("finest_percent") - 30.0).abs() < 1e-9 && (number("sieve_mm") - 0.15).abs() < 1e-9,
        "{found}"
    );
    assert!(number("constriction_mm") < 0.15, "{found}");
    assert!(eroded(&passive) > 0.1, "{passive}");
    for end in ["0.01", "0.05", "0.149"] {
        let ended = walked(&["--set", &format!("base.d0_mm={end}")], end);
        assert!(note(&ended).is_none() && eroded(&ended) < eroded(&passive), "{end}");
    }
    fs::write(root.path().join("base.csv"), "opening_mm,percent_finer\n0.3,100\n0.2,85\n0.15,30\n0.04,5\n")
        .unwrap();
    assert!(note(&walked(&[], "fine")).is_none());
}

/// 12 % finer than the finest sieve, so that D10 is not known, and D60 is.
#[test]
fn cu_of_an_open_tail_is_more_than_that_of_its_sieves() {
    let root = tempfile::tempdir().unwrap();
    let warnings = |finest: &str, d85: &str| {
        files(root.path(), 12);
        let base = format!("opening_mm,percent_finer\n0.3,100\n{d85},85\n{finest},12\n");
        fs::write(root.path().join("base.csv"), base).unwrap();
        let check = call(root.path(), &["check", "scene.toml", "--json"]);
        done(&check);
        let value: Value = serde_json::from_slice(&check.stdout).unwrap();
        value["notes"].to_string()
    };
    for (finest, d85, cu) in [("0.04", "0.2", "2.88"), ("0.14", "0.19", "1.22"), ("0.02", "0.2", "4.54")] {
        let text = warnings(finest, d85);
        assert!(text.contains("cu_at_least") && text.contains(&format!("\"over_cu\":{cu}")), "{text}");
        assert_eq!(text.contains("pan_counts_as_passing"), finest == "0.14", "{text}");
    }
}

#[test]
fn a_base_with_a_pan_fraction_is_continued_with_the_same_bits() {
    let root = tempfile::tempdir().unwrap();
    files(root.path(), 20);
    let scene = || Scene::read(&root.path().join("scene.toml"), &[]).unwrap();
    let whole = RunOptions { out: Some(root.path().join("whole")), ..RunOptions::default() };
    walk_scene(scene(), &whole, &Callbacks::default()).unwrap();
    let whole = outcome(&root.path().join("whole"));
    // Six runs of the scene, then its ends and studies: stopped in each.
    for runs in [1, 7, 13, 19] {
        let out = root.path().join(format!("stopped{runs}"));
        let options = RunOptions {
            out: Some(out.clone()),
            checkpoint_interval: Some(CheckpointInterval::Increments(7)),
            ..RunOptions::default()
        };
        let (stop, seen) = (AtomicBool::new(false), AtomicU64::new(0));
        let on_event = |event: Event| {
            if matches!(event, Event::RunDone) && seen.fetch_add(1, Ordering::Relaxed) + 1 >= runs {
                stop.store(true, Ordering::Relaxed);
            }
        };
        let stopping = Callbacks { on_event: &on_event, stop: &stop, ..Callbacks::default() };
        let stopped = walk_scene(scene(), &options, &stopping).err().expect("it was stopped");
        assert_eq!(stopped.exit(), Exit::Stopped, "{stopped}");
        resume(&out, &options, &Callbacks::default()).unwrap();
        assert_eq!(outcome(&out), whole, "stopped after {runs} runs");
    }
    // The run's own scene gives it again.
    let again = RunOptions { out: Some(root.path().join("again")), ..RunOptions::default() };
    let kept = Scene::read(&root.path().join("whole/scene.toml"), &[]).unwrap();
    walk_scene(kept, &again, &Callbacks::default()).unwrap();
    assert_eq!(outcome(&root.path().join("again")), whole);
}
