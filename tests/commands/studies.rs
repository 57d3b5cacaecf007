//! Studies that stop when they are clear, and the messages of a run under way.

use std::fs;
use std::path::Path;
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};

use serde_json::Value;
use voidwalk::run::{Callbacks, Event, Exit, RunOptions, resume, walk_scene};
use voidwalk::scene::Scene;

use crate::program::{call, done};

/// Continuing erosion far from the threshold, so that a replicate of a point is clear.
const SCENE: &str = "replicates = 8\nseed = 5\n[filter]\ncurve = \"cu1.5-loose\"\n[base]\ncu = 1.5\nd85_at_dc = 5\n\
    [network]\nnx = 10\nny = 10\nnz = 12\n[record]\nsensitivity = [0.5, 2.0]\n";

fn outcome(folder: &Path) -> Value {
    let mut outcome: Value = serde_json::from_slice(&fs::read(folder.join("outcome.json")).unwrap()).unwrap();
    let whole = outcome.as_object_mut().unwrap();
    whole.remove("seconds");
    for replicate in whole["replicates"].as_array_mut().unwrap() {
        for run in replicate["runs"].as_array_mut().unwrap() {
            run.as_object_mut().unwrap().remove("seconds");
        }
    }
    outcome
}

fn run(root: &Path, out: &str, more: &[&str]) -> Value {
    done(&call(root, &[&["run", "s.toml", "--out", out], more].concat()));
    outcome(&root.join(out))
}

#[test]
fn a_point_that_is_clear_stops() {
    let root = tempfile::tempdir().unwrap();
    fs::write(root.path().join("s.toml"), SCENE).unwrap();
    let whole = run(root.path(), "o", &["--threads", "2"]);
    assert_eq!(whole["model"]["class"], "continuing erosion");
    let rows = [&whole["sensitivity"], &whole["thickness"]].map(|rows| rows.as_array().unwrap().clone());
    for row in rows.iter().flatten() {
        let own = row["factor"] == 1.0;
        let (stopped, replicates) = if own { (None, 8) } else { (Some(true), 1) };
        assert_eq!(
            (row["stopped_when_clear"].as_bool(), row["replicates"].as_u64()),
            (stopped, Some(replicates))
        );
        assert_eq!(row["verdict"], "continuing erosion");
        assert!(row["runs"][0]["low"].as_f64() < row["runs"][0]["high"].as_f64());
    }
    // One replicate of a point is the first of the scene with so much base, and the interval is a wide one.
    let n_base = rows[0][2]["n_base"].to_string();
    let same = format!("base.n_base={n_base}");
    let alone = run(root.path(), "alone", &["--set", &same, "--set", "record.sensitivity=[]"]);
    for index in 0..2 {
        let (row, summary) = (&rows[0][2]["runs"][index], &alone["summary"][index]["eroded_mass_fraction"]);
        assert_eq!(row["mean"], alone["replicates"][0]["runs"][index]["eroded_mass_fraction"]);
        let width = |of: &Value| of["high"].as_f64().unwrap() - of["low"].as_f64().unwrap();
        assert!(width(row) > 2.0 * width(summary), "{row} {summary}");
    }
    // On one thread the same.
    assert_eq!(run(root.path(), "one", &["--threads", "1"]), whole);
}

/// A scene of few replicates says nothing of its scatter, and a base close to the threshold is not clear.
#[test]
fn a_point_that_is_not_clear_is_walked_in_full() {
    let root = tempfile::tempdir().unwrap();
    for (text, wanted) in [
        (SCENE.replace("replicates = 8", "replicates = 4"), 3),
        (SCENE.replace("d85_at_dc = 5", "d85_at_dc = 38"), 3),
        (SCENE.replace("sensitivity = ", "sensitivity_replicates = 1\nsensitivity = "), 1),
    ] {
        fs::write(root.path().join("s.toml"), text).unwrap();
        let found = run(root.path(), "o", &["--overwrite"]);
        for row in found["sensitivity"].as_array().unwrap().iter().filter(|row| row["factor"] != 1.0) {
            assert_eq!(
                (row["replicates"].as_u64(), row.get("stopped_when_clear")),
                (Some(wanted), None),
                "{row}"
            );
        }
    }
}

#[test]
fn studies_that_are_interrupted_end_as_if_they_were_not() {
    let root = tempfile::tempdir().unwrap();
    fs::write(root.path().join("s.toml"), SCENE).unwrap();
    let whole = run(root.path(), "whole", &[]);
    let scene = || Scene::read(&root.path().join("s.toml"), &[]).unwrap();
    let folder = root.path().join("broken");
    // Stopped as soon as the verdict stands, then in each of two further starts after some runs of the studies.
    let (stop, starts, studied) = (AtomicBool::new(false), AtomicUsize::new(0), AtomicUsize::new(0));
    let told = |event: Event| {
        let start = starts.load(Ordering::Relaxed);
        match event {
            Event::VerdictStands { outcome, .. } => {
                assert!(outcome.sensitivity.is_empty() && outcome.thickness.is_empty());
                studied.store(1, Ordering::Relaxed);
                stop.store(start == 0, Ordering::Relaxed);
            }
            Event::RunDone if studied.load(Ordering::Relaxed) > 0 => {
                // Threads say so side by side: whoever is late takes nothing back.
                let enough = studied.fetch_add(1, Ordering::Relaxed) >= 2 * start;
                stop.fetch_or(enough, Ordering::Relaxed);
            }
            _ => {}
        }
    };
    let callbacks = Callbacks { on_event: &told, stop: &stop, ..Callbacks::default() };
    let options = RunOptions { out: Some(folder.clone()), ..RunOptions::default() };
    let first = walk_scene(scene(), &options, &callbacks).err().unwrap();
    assert_eq!(first.exit(), Exit::Stopped, "{first}");
    assert!(folder.join("outcome.json").is_file(), "the verdict stands before the studies");
    for start in 1..=2 {
        starts.store(start, Ordering::Relaxed);
        studied.store(0, Ordering::Relaxed);
        stop.store(false, Ordering::Relaxed);
        let error = resume(&folder, &RunOptions::default(), &callbacks).err().unwrap();
        assert_eq!(error.exit(), Exit::Stopped, "{error}");
    }
    resume(&folder, &RunOptions::default(), &Callbacks::default()).unwrap();
    assert_eq!(outcome(&folder), whole);
}

#[test]
fn the_first_replicates_are_said_as_not_final_and_then_the_verdict() {
    let root = tempfile::tempdir().unwrap();
    fs::write(root.path().join("s.toml"), SCENE).unwrap();
    let said = call(root.path(), &["run", "s.toml", "--out", "o", "--threads", "1"]);
    done(&said);
    let said = String::from_utf8(said.stderr).unwrap();
    let at = |words: &str| said.find(words).unwrap_or_else(|| panic!("{words:?} is not in {said:?}"));
    assert!(at("after 2 of 8 replicates, not yet final: ") < at("\nModel (research): "), "{said}");
}

/// The scene itself has one class on its page, whatever leaves it undecided.
#[test]
fn the_scene_among_its_variations_has_the_verdict_of_its_page() {
    let root = tempfile::tempdir().unwrap();
    let scene = |filter: &str, ratio: f64| {
        format!(
            "replicates = 3\nseed = 5\n[filter]\n{filter}\n[base]\ncu = 1.5\nd15f_over_d85b = {ratio}\n\
             [network]\nnx = 8\nny = 8\nnz = 10\n[record]\nsensitivity = [2.0]\n"
        )
    };
    let level = ["--decide-percent", "99.999", "--set", "stop.most_replicates=10", "--set", "replicates=5"];
    let of_level = scene("curve = \"cu1.5-loose\"", 3.2);
    let of_curve = scene("cu = 1.5\nestimate = 0.5", 3.8);
    let cases: [(&str, &[&str], &str); 2] = [
        (&of_level, &level, "Inconclusive: these replicates do not separate"),
        (&of_curve, &[], "Inconclusive: the constriction curve is known within a range"),
    ];
    for (text, more, why) in cases {
        fs::write(root.path().join("s.toml"), text).unwrap();
        done(&call(root.path(), &[&["run", "s.toml", "--overwrite", "--out", "u"], more].concat()));
        let whole = outcome(&root.path().join("u"));
        assert_eq!(whole["model"]["class"], "undecided", "{why}");
        for study in ["sensitivity", "thickness"] {
            let rows = whole[study].as_array().unwrap();
            let own = rows.iter().find(|row| row["factor"] == 1.0).unwrap();
            assert_eq!(own["verdict"], "undecided", "{study}, {why}");
        }
        let page = fs::read_to_string(root.path().join("u/report.html")).unwrap();
        assert!(page.contains(why), "{page}");
    }
}
