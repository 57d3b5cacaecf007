//! Filters too broad to be packed whole, filters of one shape in several sizes, and guesses: what is packed,
//! what is said, and what of it is in the verdict.

use std::fs;
use std::path::{Path, PathBuf};

use serde_json::Value;

use crate::program::{call, done, refused};

/// 40 % between 1 and 1.5 mm, nothing up to 60 mm: the whole would need hundreds of thousands of grains.
const GAP: &str = "opening_mm,percent_finer\n80,100\n60,40\n1.5,40\n1,0\n";

const SMALL: &str = "[network]\nnx = 6\nny = 6\nnz = 8\n[record]\nsensitivity = []\n";

const FEW: &str = "[packing]\ngrains = 600\nstiffness_ratio = 0.01\n";

fn with_scene(filter: &str) -> (tempfile::TempDir, PathBuf) {
    let root = tempfile::tempdir().unwrap();
    let path = root.path().to_owned();
    fs::write(path.join("gap.csv"), GAP).unwrap();
    let base = "[base]\nsingle_mm = 0.25\nmass_ratio = 0.01\n";
    fs::write(path.join("s.toml"), format!("replicates = 2\n{filter}{base}{SMALL}")).unwrap();
    (root, path)
}

fn read(file: &Path) -> Value {
    serde_json::from_slice(&fs::read(file).unwrap()).unwrap()
}

fn has(outcome: &Value, id: &str) -> bool {
    outcome["notes"].as_array().unwrap().iter().any(|note| note["id"] == id)
}

#[test]
fn of_a_broad_filter_the_finer_part_is_packed_and_its_error_is_in_the_verdict() {
    let (_root, at) = with_scene(&format!("[filter]\nsieve = \"gap.csv\"\ndensity = \"loose\"\n{FEW}"));
    let check = call(&at, &["check", "s.toml"]);
    done(&check);
    let said = "Only the finer 40 % (up to 1.5 mm) was packed";
    assert!(String::from_utf8_lossy(&check.stdout).contains(said));
    let run = call(&at, &["run", "s.toml", "--out", "r1"]);
    done(&run);
    assert!(String::from_utf8_lossy(&run.stderr).contains(said));
    let outcome = read(&at.join("r1/outcome.json"));
    assert!(has(&outcome, "floating_part_packed"), "{}", outcome["notes"]);
    // By hand: shares of mass by ln(b/a) times 1/a - 1/b.
    let surface = |mass: f64, a: f64, b: f64| mass / (b / a).ln() * (1.0 / a - 1.0 / b);
    let (fine, coarse) = (surface(0.4, 1.0, 1.5), surface(0.6, 60.0, 80.0));
    let range = &outcome["curve_range"];
    let factor = range["ends"][0]["dc50_factor"].as_f64().unwrap();
    assert!((1.0 - 1.0 / factor - 0.6 * coarse / (fine + coarse)).abs() < 1e-9, "{range}");
    // Wider constrictions were walked, and the range holds what came of them.
    let first = outcome["summary"][0]["eroded_mass_fraction"]["mean"].as_f64().unwrap();
    let wider = range["ends"][0]["runs"][0]["mean"].as_f64().unwrap();
    let [low, high] = [0, 1].map(|end| range["eroded_mass_fraction"][0][end].as_f64().unwrap());
    assert!(first != wider && low <= first.min(wider) && first.max(wider) <= high, "{first} {wider} {range}");
    // The void ratio of a part is not the filter's.
    assert!(outcome["inputs"]["filter"]["void_ratio"].is_null());
    // The resolved scene needs no packing, and gives and says the same.
    done(&call(&at.join("r1"), &["run", "scene.toml", "--out", "../r2"]));
    let again = read(&at.join("r2/outcome.json"));
    for key in ["summary", "notes", "model", "digest"] {
        assert_eq!(outcome[key], again[key], "{key}");
    }
    assert_eq!(outcome["curve_range"], again["curve_range"]);
}

#[test]
fn what_is_packed_can_be_said_and_what_cannot_be_is_refused_with_its_time() {
    let (_root, at) = with_scene(&format!("[filter]\ncu = 2\ndensity = \"loose\"\n{FEW}coarsest = 50\n"));
    let check = call(&at, &["check", "s.toml", "--json"]);
    done(&check);
    let check: serde_json::Value = serde_json::from_slice(&check.stdout).unwrap();
    let part = |note: &serde_json::Value| note["id"].as_str().unwrap().ends_with("part_packed");
    let note = check["notes"].as_array().unwrap().iter().find(|note| part(note)).unwrap();
    assert_eq!(
        (&note["numbers"]["part_percent"], &note["numbers"]["largest_mm"]),
        (&50.0.into(), &2.0.into())
    );
    let wide = ["pack", "s.toml", "--set", "filter.cu=30", "--set", "packing.coarsest=100", "--out", "p"];
    let output = call(&at, &wide);
    refused(&output, "grains would do, in about");
    refused(&output, "packing.coarsest = 90");
    refused(&output, "filter.library");
    assert!(!at.join("p").exists());
}

#[test]
fn a_campaign_whose_filters_have_one_shape_packs_once() {
    let root = tempfile::tempdir().unwrap();
    let at = root.path();
    let plan = format!(
        "[set]\nreplicates = 2\nfilter.cu = 1.5\nfilter.density = \"loose\"\n\
         packing = {{ grains = 300, stiffness_ratio = 0.01 }}\nbase = {{ cu = 1.5, d85_at_dc = 5 }}\n\
         network = {{ nx = 6, ny = 6, nz = 8 }}\nrecord = {{ sensitivity = [] }}\n\
         [[factor]]\nname = \"d0\"\nsetting = \"filter.d0_mm\"\nvalues = [2, {}, 5]\n",
        2.0 * 1.7
    );
    fs::write(at.join("plan.toml"), plan).unwrap();
    done(&call(at, &["campaign", "plan.toml", "--out", "out"]));
    assert_eq!(fs::read_dir(at.join("out/packings")).unwrap().count(), 1);
    let of = |d0: &str, file: &str| at.join(format!("out/cases/d0={d0}")).join(file);
    let curve = |d0: &str| -> Vec<f64> {
        let text = fs::read_to_string(of(d0, "inputs/filter-curve.csv")).unwrap();
        text.lines().skip(1).map(|line| line.rsplit(',').next().unwrap().parse().unwrap()).collect()
    };
    let (first, third) = (curve("2"), curve("5"));
    assert_eq!(first.len(), third.len());
    assert!(first.iter().zip(&third).all(|(a, b)| (b / a / 2.5 - 1.0).abs() < 1e-6), "{first:?} {third:?}");
    let said = read(&of("5", "outcome.json"))["left_out"].to_string();
    assert!(said.contains("packing_of_shape") && said.contains("2.5"), "{said}");
    let record = read(&of("5", "inputs/packing.json"));
    assert_eq!(record["same_shape"]["factor"], 2.5);
    assert_eq!(record["gradation"][0][0], 5.0);
    // Another seed, or another shape, is another packing.
    for other in ["packing.seed=2", "filter.cu=1.6"] {
        let plan = fs::read_to_string(at.join("plan.toml")).unwrap();
        let (name, value) = other.split_once('=').unwrap();
        let single = plan.split("[[factor]]").next().unwrap().replace("filter.cu = 1.5\n", "");
        let more = if name == "filter.cu" { String::new() } else { "filter.cu = 1.5\n".to_owned() };
        let single = single.replace("[set]\n", &format!("[set]\n{more}"));
        let factor = format!("[[factor]]\nname = \"v\"\nsetting = \"{name}\"\nvalues = [{value}]\n");
        fs::write(at.join("other.toml"), single + &factor).unwrap();
        let before = fs::read_dir(at.join("out/packings")).unwrap().count();
        done(&call(at, &["campaign", "other.toml", "--out", "other", "--packings", "out/packings"]));
        assert_eq!(fs::read_dir(at.join("out/packings")).unwrap().count(), before + 1, "{other}");
    }
}

#[test]
fn a_guess_needs_no_grains_per_void_and_its_verdict_is_a_range() {
    let (_root, at) = with_scene("[filter]\ncu = 1.5\nestimate = 0.5\n");
    done(&call(&at, &["run", "s.toml", "--out", "r1"]));
    let outcome = read(&at.join("r1/outcome.json"));
    assert_eq!(outcome["grains_per_void"], 0.6);
    assert!(has(&outcome, "guessed_grains"));
    let ends = outcome["curve_range"]["ends"].as_array().unwrap();
    let names: Vec<&str> = ends.iter().map(|end| end["curve"].as_str().unwrap()).collect();
    assert_eq!(names, ["densest guess", "loosest guess"]);
    // A base of 0.25 mm is held by the densest guess and passes the loosest.
    assert_eq!(ends[1]["verdict"], "continuing erosion");
    assert_ne!(ends[0]["verdict"], ends[1]["verdict"]);
    assert_eq!(outcome["model"]["class"], "undecided");
    // A number that is given is kept without a word.
    let given = ["run", "s.toml", "--set", "filter.grains_per_void=0.6", "--out", "r2"];
    done(&call(&at, &given));
    let with = read(&at.join("r2/outcome.json"));
    assert_eq!(outcome["summary"], with["summary"]);
    assert!(!has(&with, "guessed_grains"));
    // And a run's own scene says the same again.
    done(&call(&at.join("r1"), &["run", "scene.toml", "--out", "../r3"]));
    assert_eq!(outcome["notes"], read(&at.join("r3/outcome.json"))["notes"]);
}
