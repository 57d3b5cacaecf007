//! `voidwalk pack`, and scenes whose filter is packed: files, refusals, stops and kills, and the whole chain.

use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;
use std::time::Duration;

use voidwalk::run::FolderKind;

use super::program::{call, done, figures_are_listed, refused, voidwalk};

const FILTER: &str =
    "[filter]\ncu = 1.5\ndensity = \"loose\"\n[packing]\ngrains = 600\nstiffness_ratio = 0.01\n";

fn with_filter(text: &str) -> (tempfile::TempDir, PathBuf) {
    let root = tempfile::tempdir().unwrap();
    fs::write(root.path().join("filter.toml"), text).unwrap();
    let path = root.path().to_owned();
    (root, path)
}

#[test]
fn a_packing_folder_holds_what_is_promised() {
    let (_root, at) = with_filter(FILTER);
    done(&call(&at, &["pack", "filter.toml", "--out", "out"]));
    let out = at.join("out");
    for name in [
        "grains.csv",
        "grains.vtp",
        "constrictions.csv",
        "constrictions.json",
        "constrictions.vtp",
        "packing.json",
        "report.html",
        "figures/slice.svg",
    ] {
        assert!(out.join(name).is_file(), "{name}");
    }
    figures_are_listed(FolderKind::Packing, &out);
    assert!(!out.join("compression.0").exists() && !out.join("compression.1").exists());
    let record: serde_json::Value =
        serde_json::from_slice(&fs::read(out.join("packing.json")).unwrap()).unwrap();
    let after = &record["after"];
    assert!((after["pressure_kpa"].as_f64().unwrap() - 50.0).abs() < 0.25);
    assert!((0.55..0.75).contains(&after["void_ratio"].as_f64().unwrap()), "{after}");
    assert_eq!(record["grains"], 600);
    let grains = voidwalk::packing::Packing::read(out.join("grains.csv")).unwrap();
    assert_eq!(grains.x.len(), 600);
    refused(&call(&at, &["pack", "filter.toml", "--out", "out"]), "holds a packing already");
    let before = fs::read(out.join("grains.csv")).unwrap();
    done(&call(&at, &["pack", "filter.toml", "--out", "out", "--overwrite", "--seed", "2"]));
    assert_ne!(before, fs::read(out.join("grains.csv")).unwrap());
}

#[test]
fn the_grains_are_the_same_for_any_threads() {
    let (_root, at) = with_filter(FILTER);
    for threads in ["1", "2", "3"] {
        done(&call(&at, &["pack", "filter.toml", "--out", threads, "--threads", threads]));
    }
    let grains = |n: &str| fs::read(at.join(n).join("grains.csv")).unwrap();
    assert!(grains("1") == grains("2") && grains("1") == grains("3"));
}

/// Files that must not depend on how often the program was started: all but those that tell the time.
fn lasting(folder: &Path) -> Vec<Vec<u8>> {
    ["grains.csv", "grains.vtp", "constrictions.csv", "constrictions.json", "constrictions.vtp"]
        .map(|name| fs::read(folder.join(name)).unwrap())
        .to_vec()
}

#[test]
fn a_packing_goes_on_after_stops_and_kills_with_the_same_bits() {
    let (_root, at) = with_filter(FILTER);
    done(&call(&at, &["pack", "filter.toml", "--out", "whole"]));
    let start = || {
        voidwalk(&at, &["pack", "filter.toml", "--out", "broken", "--checkpoint-every", "1ms"])
            .spawn()
            .unwrap()
    };
    let (mut stops, mut kills, mut furthest) = (0, 0, 0);
    for attempt in 0..1000 {
        let child = start();
        std::thread::sleep(Duration::from_millis(15 + 7 * (attempt % 5)));
        let signal = if attempt % 2 == 0 { "-TERM" } else { "-KILL" };
        let _ = Command::new("kill").args([signal, &child.id().to_string()]).status().unwrap();
        let output = child.wait_with_output().unwrap();
        match output.status.code() {
            Some(0) => break,
            Some(3) => {
                // "stopped: after 4 000 steps of the packing; ..."
                let words = String::from_utf8_lossy(&output.stderr).into_owned();
                let steps = words.split("stopped: after ").nth(1).unwrap().split(" steps").next().unwrap();
                let steps: u64 = steps.replace(' ', "").parse().unwrap();
                assert!(steps > furthest, "it went on from the start: {steps} after {furthest}");
                furthest = steps;
                stops += 1;
            }
            Some(2) => break,
            // A signal that arrives before the program listens for it ends it as a kill does.
            None => kills += 1,
            code => panic!("{code:?}"),
        }
    }
    if !at.join("broken/packing.json").is_file() {
        done(&call(&at, &["pack", "filter.toml", "--out", "broken"]));
    }
    assert!(stops + kills >= 2, "{stops} stops and {kills} kills: the packing is too short to be broken");
    assert_eq!(lasting(&at.join("whole")), lasting(&at.join("broken")));
}

#[test]
fn an_unfinished_packing_of_another_recipe_is_left_alone() {
    let (_root, at) = with_filter(FILTER);
    fs::create_dir(at.join("out")).unwrap();
    done(&call(&at, &["pack", "filter.toml", "--out", "out"]));
    fs::remove_file(at.join("out/packing.json")).unwrap();
    fs::write(at.join("out/compression.1"), b"not a state at all").unwrap();
    refused(&call(&at, &["pack", "filter.toml", "--out", "out"]), "cannot be continued");
    assert_eq!(fs::read(at.join("out/compression.1")).unwrap(), b"not a state at all");
    done(&call(&at, &["pack", "filter.toml", "--out", "out", "--overwrite"]));
    assert!(!at.join("out/compression.1").exists());
}

#[test]
fn a_stopped_packing_does_not_become_that_of_another_gradation() {
    let (_root, at) = with_filter(&FILTER.replace("grains = 600", "grains = 3000"));
    let child = voidwalk(
        &at,
        &["pack", "filter.toml", "--out", "out", "--checkpoint-every", "1ms", "--threads", "1"],
    )
    .spawn()
    .unwrap();
    while !at.join("out/compression.1").exists() {
        std::thread::sleep(Duration::from_millis(2));
    }
    let _ = Command::new("kill").args(["-KILL", &child.id().to_string()]).status().unwrap();
    let output = child.wait_with_output().unwrap();
    if output.status.success() {
        return;
    }
    for (from, to) in [("cu = 1.5", "cu = 1.2"), ("cu = 1.5", "d0_mm = 2.0\ncu = 1.5")] {
        let other = FILTER.replace("grains = 600", "grains = 3000").replace(from, to);
        fs::write(at.join("other.toml"), other).unwrap();
        refused(
            &call(&at, &["pack", "other.toml", "--out", "out"]),
            "is of another scene, or of another version",
        );
    }
}

#[test]
fn grains_that_were_changed_are_not_taken() {
    let (_root, at) = with_filter(&format!(
        "replicates = 1\n{FILTER}[base]\ncu = 1.5\nd85_at_dc = 5\n[network]\nnx = 4\nny = 4\nnz = 4\n[record]\nsensitivity = []\n"
    ));
    done(&call(&at, &["run", "filter.toml", "--out", "r1"]));
    let kept = fs::read_dir(at.join("voidwalk-packings")).unwrap().next().unwrap().unwrap().path();
    let grains = fs::read_to_string(kept.join("grains.csv")).unwrap();
    let fewer: Vec<&str> = grains.lines().take(300).collect();
    fs::write(kept.join("grains.csv"), fewer.join("\n") + "\n").unwrap();
    refused(
        &call(&at, &["run", "filter.toml", "--out", "r2"]),
        "is not the file that this record was written with",
    );
}

#[test]
fn links_inside_a_folder_lead_nowhere() {
    let (_root, at) = with_filter(FILTER);
    fs::write(at.join("precious.txt"), "years of work").unwrap();
    fs::create_dir_all(at.join("out")).unwrap();
    std::os::unix::fs::symlink("../precious.txt", at.join("out/.voidwalk.lock")).unwrap();
    let output = call(&at, &["pack", "filter.toml", "--out", "out"]);
    assert!(matches!(output.status.code(), Some(1 | 2)));
    assert_eq!(fs::read_to_string(at.join("precious.txt")).unwrap(), "years of work");
    fs::create_dir_all(at.join("elsewhere")).unwrap();
    fs::create_dir_all(at.join("two")).unwrap();
    std::os::unix::fs::symlink("../elsewhere", at.join("two/figures")).unwrap();
    fs::write(at.join("two/.voidwalk.lock"), "").unwrap();
    let output = call(&at, &["pack", "filter.toml", "--out", "two"]);
    assert!(!output.status.success());
    assert_eq!(fs::read_dir(at.join("elsewhere")).unwrap().count(), 0);
}

#[test]
fn a_folder_of_another_kind_is_left_alone() {
    let base =
        "[base]\ncu = 1.5\nd85_at_dc = 5\n[network]\nnx = 4\nny = 4\nnz = 4\n[record]\nsensitivity = []\n";
    let (_root, at) = with_filter(&format!("replicates = 1\n{FILTER}{base}"));
    done(&call(&at, &["run", "filter.toml", "--out", "a-run"]));
    figures_are_listed(FolderKind::Run, &at.join("a-run"));
    let before = fs::read(at.join("a-run/report.html")).unwrap();
    refused(&call(&at, &["pack", "filter.toml", "--out", "a-run"]), "holds a run");
    assert_eq!(before, fs::read(at.join("a-run/report.html")).unwrap());
    // The page that was made of values is the one of the files.
    done(&call(&at, &["report", "a-run"]));
    assert_eq!(before, fs::read(at.join("a-run/report.html")).unwrap());
    done(&call(&at, &["pack", "filter.toml", "--out", "a-packing"]));
    refused(&call(&at, &["run", "filter.toml", "--out", "a-packing"]), "holds a packing");
    // Its page can be written again.
    fs::remove_file(at.join("a-packing/report.html")).unwrap();
    done(&call(&at, &["report", "a-packing"]));
    assert!(at.join("a-packing/report.html").is_file());
}

#[test]
fn bad_filters_are_refused_before_any_work() {
    for (text, message) in [
        ("[filter]\ncu = 1.5\n", "filter.density is missing: dense, medium (or intermediate), loose"),
        ("[filter]\ndensity = \"loose\"\n", "filter.cu or filter.sieve is missing"),
        ("[filter]\ncu = 1.5\ndensity = \"lose\"\n", "line 3, filter.density: `lose` is not allowed"),
        ("[filter]\ncu = 1.5\nfriction = -1\n", "line 3, filter.friction: `-1` is not allowed"),
        ("[filter]\ncu = 1.5\nfriction = 0\ndensity = \"dense\"\n", "keep one"),
        ("[filter]\ncu = 1.5\ndensity = \"dense\"\ncurve = \"a.csv\"\n", "keep one"),
        ("[filter]\ncu = 1.5\n[packing]\ngrains = 500\n", "packing.grains goes with"),
        ("[filter]\ncu = 1.5\ndensity = \"dense\"\n[packing]\ngrains = 9\n", "line 5, packing.grains"),
        (
            "[filter]\ncu = 1.5\ndensity = \"dense\"\n[packing]\nrestitution = 1.5\n",
            "line 5, packing.restitution",
        ),
        (
            "[filter]\ncu = 1.5\ndensity = \"dense\"\n[packing]\nstiffness_ratio = 1e-5\n",
            "packing.stiffness_ratio = 0.00001 is not allowed: under the pressure of 50 kPa grains would overlap by",
        ),
        ("[filter]\ncu = 6\ndensity = \"dense\"\n[packing]\ngrains = 500\n", "at least 2.2 times"),
        (
            "[filter]\ncu = 1.5\ndensity = \"dense\"\n[packing]\ngrain = 500\n",
            "did you mean `packing.grains`",
        ),
        ("[filter]\nsieve = \"none.csv\"\ndensity = \"dense\"\n", "none.csv"),
    ] {
        let (_root, at) = with_filter(text);
        refused(&call(&at, &["pack", "filter.toml", "--out", "out"]), message);
        assert!(!at.join("out").exists(), "{text}");
    }
}

#[test]
fn a_scene_with_a_density_packs_once_and_runs_the_whole_chain() {
    let base =
        "[base]\ncu = 1.5\nd85_at_dc = 5\n[network]\nnx = 6\nny = 6\nnz = 8\n[record]\nsensitivity = []\n";
    let (_root, at) = with_filter(&format!("replicates = 2\n{FILTER}{base}"));
    done(&call(&at, &["check", "filter.toml"]));
    assert!(!at.join("voidwalk-packings").exists(), "check makes nothing");
    // What is wrong with the base is said before the filter is packed.
    refused(&call(&at, &["run", "filter.toml", "--set", "base.sieve=none.csv", "--out", "r0"]), "none.csv");
    assert!(!at.join("voidwalk-packings").exists());
    done(&call(&at, &["run", "filter.toml", "--out", "r1"]));
    let kept: Vec<_> = fs::read_dir(at.join("voidwalk-packings")).unwrap().collect();
    assert_eq!(kept.len(), 1);
    let record = kept[0].as_ref().unwrap().path().join("packing.json");
    let first = fs::read(&record).unwrap();
    done(&call(&at, &["run", "filter.toml", "--out", "r2"]));
    assert_eq!(first, fs::read(&record).unwrap(), "the packing is made once");
    // The resolved scene needs no packing, and gives the same.
    done(&call(&at.join("r1"), &["run", "scene.toml", "--out", "../r3"]));
    for name in ["series.csv", "layers.csv", "retained.csv", "eroded.csv", "inputs/filter-curve.csv"] {
        let read = |r: &str| fs::read(at.join(r).join(name)).unwrap();
        assert_eq!(read("r1"), read("r2"), "{name}");
        assert_eq!(read("r1"), read("r3"), "{name}");
    }
    assert!(fs::read_to_string(at.join("r1/outcome.json")).unwrap().contains("measured on its packing"));
}

#[test]
fn a_guess_by_inscribed_circles_walks_without_a_packing_and_says_so() {
    let text = "replicates = 2\n[filter]\ncu = 1.5\nestimate = 0\ngrains_per_void = 0.6\n[base]\ncu = 1.5\nd85_at_dc = 5\n\
        [network]\nnx = 6\nny = 6\nnz = 8\n[record]\nsensitivity = []\n";
    let (_root, at) = with_filter(text);
    let output = call(&at, &["run", "filter.toml", "--out", "r1"]);
    done(&output);
    let outcome = fs::read_to_string(at.join("r1/outcome.json")).unwrap();
    assert!(outcome.contains("\"guessed_constrictions\""), "{outcome}");
    assert!(!at.join("voidwalk-packings").exists());
    done(&call(&at.join("r1"), &["run", "scene.toml", "--out", "../r2"]));
    let read = |r: &str| fs::read(at.join(r).join("series.csv")).unwrap();
    assert_eq!(read("r1"), read("r2"));
    fs::write(at.join("both.toml"), text.replace("nx = 6\nny = 6\nnz = 8", "file = \"n.csv\"")).unwrap();
    let clash = call(&at, &["run", "both.toml", "--out", "r3"]);
    refused(&clash, "keep one");
}

/// A filter as thick as its cell is tall is one copy of it; the page and the record know the height.
#[test]
fn a_tall_cell_takes_the_place_of_copies() {
    let (_root, at) = with_filter(FILTER);
    refused(
        &call(&at, &["pack", "filter.toml", "--set", "packing.aspect=0.5"]),
        "packing.aspect: `0.5` is not allowed",
    );
    let tall = ["--set", "packing.aspect=4", "--set", "packing.grains=1600"];
    done(&call(&at, &[&["pack", "filter.toml", "--out", "tall"][..], &tall].concat()));
    let record: serde_json::Value =
        serde_json::from_slice(&fs::read(at.join("tall/packing.json")).unwrap()).unwrap();
    let [width, height] = ["cell_mm", "height_mm"].map(|name| record[name].as_f64().unwrap());
    assert!((height / width - 4.0).abs() < 1e-9);
    let page = fs::read_to_string(at.join("tall/report.html")).unwrap();
    // Words of the page with their numbers, of three to four digits.
    let number_after = |words: &str| -> f64 {
        let (_, rest) = page.split_once(words).unwrap_or_else(|| panic!("{words}"));
        let from = &rest[rest.find(|c: char| c.is_ascii_digit()).unwrap()..];
        from[..from.find(|c: char| !c.is_ascii_digit() && c != '.').unwrap()].parse().unwrap()
    };
    assert!((number_after("The plane z = ") / (0.5 * height) - 1.0).abs() < 0.01);
    assert!((number_after("Height of the cell") / height - 1.0).abs() < 0.01);
    let scene = "[filter]\ncu = 1.5\n[base]\ncu = 1.5\nd15f_over_d85b = 4\n[network]\nkind = \"graph\"\n\
                 packing = \"tall/grains.csv\"\ncopies = 1\n";
    fs::write(at.join("scene.toml"), scene).unwrap();
    let said = call(&at, &["check", "scene.toml", "--json"]);
    done(&said);
    // A cell that the number of grains makes narrow is said to be so, and one that is wide enough is not.
    let narrow = |grains: &str| {
        let scene = "[filter]\ncu = 1.5\ndensity = \"loose\"\n[base]\ncu = 1.5\nd15f_over_d85b = 4\n";
        fs::write(at.join("packed.toml"), scene).unwrap();
        let said = call(&at, &["check", "packed.toml", "--set", "packing.aspect=4", "--set", grains]);
        done(&said);
        String::from_utf8(said.stdout).unwrap().contains("times as wide as the largest grain")
    };
    assert!(narrow("packing.grains=1600") && !narrow("packing.grains=16000"));
    // Without a number of grains, four times those of a cube.
    let cost = |aspect: &str| {
        let scene = "[filter]\ncu = 1.5\ndensity = \"loose\"\n[base]\ncu = 1.5\nd15f_over_d85b = 4\n";
        fs::write(at.join("packed.toml"), scene).unwrap();
        let said = call(&at, &["check", "packed.toml", "--set", aspect]);
        done(&said);
        String::from_utf8(said.stdout).unwrap()
    };
    assert!(cost("packing.aspect=1").contains(" 9000 "));
    assert!(cost("packing.aspect=4").contains(" 36 000 "));
}
