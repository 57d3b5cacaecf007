//! A base whose finest sieve is coarser than the finest constriction: the readings of what is finer.

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

#[test]
fn a_pan_fraction_that_may_block_has_the_verdict_of_its_likely_reading() {
    let root = tempfile::tempdir().unwrap();
    files(root.path(), 30);
    let check = call(root.path(), &["check", "scene.toml"]);
    done(&check);
    let said = String::from_utf8_lossy(&check.stdout).into_owned();
    assert!(said.contains("continued as in soils with a hydrometer test, finer than every"), "{said}");
    // Three readings of three replicates and two studied ones, three replicates at either end of what is a
    // guess, two of either other thickness, two runs each.
    assert!(said.contains("42 runs"), "{said}");
    let run = call(root.path(), &["run", "scene.toml", "--out", "out"]);
    done(&run);
    let found = outcome(&root.path().join("out"));
    let bounds = &found["pan_bounds"];
    let readings = bounds["readings"].as_array().unwrap();
    let of = |k: usize, key: &str| readings[k][key].clone();
    let taken = [0, 1, 2].map(|k| of(k, "taken_as"));
    assert_eq!(taken, ["continued", "passive", "finest sieve"].map(Value::from));
    let eroded = |k: usize| readings[k]["runs"][0]["mean"].as_f64().unwrap();
    // What is passive leaves; what is of the finest sieve's size is held with the rest.
    assert!(eroded(1) > 0.1 && eroded(2) < 0.075, "{bounds}");
    assert!(eroded(2) < eroded(0) && eroded(0) < eroded(1), "{bounds}");
    assert_eq!(found["summary"][0]["eroded_mass_fraction"]["mean"].as_f64().unwrap(), eroded(0));
    assert_eq!((of(1, "verdict"), of(2, "verdict")), ("some erosion".into(), "no erosion".into()));
    let likely = of(0, "verdict");
    // The ends of the guess may leave it open all the same.
    assert!(found["verdict"] == likely || found["verdict"] == "undecided", "{found}");
    let reasons = found["reasons"].to_string();
    assert!(reasons.contains("The answer depends on the 30 % of the base"), "{reasons}");
    assert_ne!(found["confidence"], "within checked range");
    let said = fs::read_to_string(root.path().join("out/report.html")).unwrap();
    for words in [
        "All readings: continued as in soils with a hydrometer test: ",
        "finer than every constriction: some erosion, ",
        "eroded; all 0.15 mm: no erosion, ",
    ] {
        assert!(said.contains(words), "{said}");
    }
    let page = fs::read_to_string(root.path().join("out/report.html")).unwrap();
    for words in ["The base’s finest part taken as", "all 0.15 mm", "which is the likely one"] {
        assert!(page.contains(words), "{words}");
    }
    // The size where it ends leaves one reading, and so does a finer sieve.
    done(&call(root.path(), &["run", "scene.toml", "--set", "base.d0_mm=0.01", "--out", "one"]));
    assert!(outcome(&root.path().join("one"))["pan_bounds"].is_null());
    fs::write(root.path().join("base.csv"), "opening_mm,percent_finer\n0.3,100\n0.2,85\n0.15,30\n0.04,5\n")
        .unwrap();
    done(&call(root.path(), &["run", "scene.toml", "--out", "fine"]));
    assert!(outcome(&root.path().join("fine"))["pan_bounds"].is_null());

    // Where there is hardly any, all readings give the same.
    files(root.path(), 1);
    let run = call(root.path(), &["run", "scene.toml", "--set", "replicates=6", "--out", "few"]);
    done(&run);
    let found = outcome(&root.path().join("few"));
    assert_eq!(found["pan_bounds"]["readings"][0]["verdict"], found["pan_bounds"]["readings"][1]["verdict"]);
    assert_eq!(found["verdict"], found["pan_bounds"]["readings"][0]["verdict"]);
    // What both agree on is no doubt, and nor is a Cu that both put within the range: D10 is known here.
    let found_of = |against: bool| -> String {
        let all = found["findings"].as_array().unwrap().iter().filter(|of| of["against"] == against);
        all.map(|of| of["sentence"].as_str().unwrap()).collect()
    };
    let (reasons, notes) = (found_of(true), found_of(false));
    let agreed = "with all of it 0.15 mm in size, the verdict is no erosion";
    assert!(notes.contains(agreed) && !reasons.contains(agreed), "{reasons} {notes}");
    assert!(!reasons.contains("finest sieve"), "{reasons}");
}

/// 12 % finer than the finest sieve, so that D10 is not known, and D60 is.
#[test]
fn cu_of_an_open_tail_comes_from_its_two_readings() {
    let root = tempfile::tempdir().unwrap();
    let said = |finest: &str, d85: &str| {
        files(root.path(), 12);
        let base = format!("opening_mm,percent_finer\n0.3,100\n{d85},85\n{finest},12\n");
        fs::write(root.path().join("base.csv"), base).unwrap();
        let words = ["check", "scene.toml", "--json"];
        let check = call(root.path(), &words);
        done(&check);
        let value: Value = serde_json::from_slice(&check.stdout).unwrap();
        value["warnings"].to_string()
    };
    // 0.115 mm over 0.04 mm: finer than every constriction, and passive of whatever size.
    let fine = said("0.04", "0.2");
    assert!(fine.contains("counts by mass only"), "{fine}");
    // How much more than this its Cu is, nothing tells.
    assert!(fine.contains("Cu of the base is more than 2.88 (D10 is finer than 0.04 mm)"), "{fine}");
    // 0.171 mm over 0.14 mm, or over the finest constriction of the densest guess, 0.040 mm: 1.22 to 4.3.
    let coarse = said("0.14", "0.19");
    assert!(
        !coarse.contains("Cu of the base") && coarse.contains("It is walked in three readings"),
        "{coarse}"
    );
    // 0.091 mm over 0.02 mm is more than 4.5 however it is read; a least value is rounded down.
    let broad = said("0.02", "0.2");
    assert!(
        broad.contains("Cu of the base is more than 4.54 (D10 is finer than 0.02 mm), and the model was"),
        "{broad}"
    );
}

#[test]
fn all_readings_are_continued_with_the_same_bits() {
    let root = tempfile::tempdir().unwrap();
    files(root.path(), 20);
    let scene = || Scene::read(&root.path().join("scene.toml"), &[]).unwrap();
    let whole = RunOptions { out: Some(root.path().join("whole")), ..RunOptions::default() };
    walk_scene(scene(), &whole, &Callbacks::default()).unwrap();
    let whole = outcome(&root.path().join("whole"));
    // Six runs of each reading, four of the study: stopped in each.
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

#[test]
fn a_case_of_a_campaign_has_the_class_of_its_run() {
    let root = tempfile::tempdir().unwrap();
    files(root.path(), 30);
    fs::write(
        root.path().join("plan.toml"),
        "[set]\nreplicates = 2\nnetwork = { nx = 6, ny = 6, nz = 10 }\nrecord = { sensitivity = [] }\nfilter = { \
         sieve = \"sand.csv\", estimate = 0.5, grains_per_void = 0.6 }\nbase = { sieve = \"base.csv\" }\n\
         [[case]]\nname = \"x\"\n",
    )
    .unwrap();
    let run = call(root.path(), &["campaign", "plan.toml", "--out", "c", "-q"]);
    done(&run);
    let line: Value =
        serde_json::from_slice(&fs::read(root.path().join("c/cases/x/case.json")).unwrap()).unwrap();
    let outcome = outcome(&root.path().join("c/cases/x"));
    assert_eq!(line["verdict"], outcome["verdict"]);
    assert_eq!(outcome["pan_bounds"]["readings"].as_array().unwrap().len(), 3);
}
