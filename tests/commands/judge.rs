//! `judge`: two sieve tables in, a run folder out, as of the scene that says the same.

use std::fs;
use std::path::PathBuf;

use serde_json::Value;

use crate::program::{call, done, refused};

pub const BASE: &str = "size_mm,percent\n0.08,0\n0.15,40\n0.2,70\n0.3,100\n";
pub const FINE: &str = "size_mm,percent\n0.5,0\n0.7,30\n1.0,70\n1.5,100\n";
pub const COARSE: &str = "size_mm,percent\n1.0,0\n1.5,30\n2.0,70\n3.0,100\n";

/// Settings of a network that is walked at once.
pub const SMALL: [&str; 6] = ["--set", "network.nx=6", "--set", "network.ny=6", "--set", "network.nz=8"];

pub fn soils() -> (tempfile::TempDir, PathBuf) {
    let root = tempfile::tempdir().unwrap();
    for (name, text) in [("base.csv", BASE), ("fine.csv", FINE), ("coarse.csv", COARSE)] {
        fs::write(root.path().join(name), text).unwrap();
    }
    let path = root.path().to_owned();
    (root, path)
}

fn json(path: PathBuf) -> Value {
    serde_json::from_slice(&fs::read(path).unwrap()).unwrap()
}

#[test]
fn two_tables_are_judged_as_the_scene_that_says_the_same() {
    let (_root, at) = soils();
    let said = call(&at, &[&["judge", "base.csv", "fine.csv", "--quick", "--out", "a"][..], &SMALL].concat());
    done(&said);
    let text = String::from_utf8(said.stdout).unwrap();
    assert!(text.contains("Practice: ") && text.contains("Model (research): "), "{text}");
    assert!(text.lines().count() <= 12 && text.split_whitespace().count() <= 120, "{text}");
    for file in ["outcome.json", "report.html", "manifest.json", "scene.toml", "inputs/base-sieve.csv"] {
        assert!(at.join("a").join(file).is_file(), "{file}");
    }
    // The scene beside the results walks to the same numbers.
    done(&call(&at, &["run", "a/scene.toml", "--out", "b", "-q"]));
    let [a, b] = ["a", "b"].map(|folder| json(at.join(folder).join("outcome.json")));
    assert_eq!(a["summary"], b["summary"]);
    assert_eq!(a["curve_range"], b["curve_range"]);
    assert_eq!(a["replicates"].as_array().unwrap().len(), 5);
    assert_eq!(
        (&a["constrictions"]["origin"], &a["practice"]["tests"]),
        (&"library".into(), &"no erosion".into())
    );
}

/// A sand without fines; dispersive soils had other tests.
#[test]
fn the_range_in_which_tests_eroded_stands_under_practice() {
    let (_root, at) = soils();
    let judge = |more: &[&str]| {
        let words = ["judge", "base.csv", "fine.csv", "--quick", "--overwrite", "--out", "a", "-q"];
        done(&call(&at, &[&words[..], &SMALL, more].concat()));
        (json(at.join("a/outcome.json")), fs::read_to_string(at.join("a/report.html")).unwrap())
    };
    let said = "In tests of such bases erosion began at D15F ";
    let (outcome, page) = judge(&[]);
    let number = |value: &Value| value.as_f64().unwrap();
    let range = &outcome["practice"]["range_of_tests_mm"];
    let d85b = number(&outcome["inputs"]["base"]["d85_mm"]);
    for (end, times) in [(0, 6.8), (1, 10.0)] {
        assert!((number(&range[end]) / d85b - times).abs() < 1e-9, "{range}");
    }
    assert!(page.contains(said));
    let (dispersive, page) = judge(&["--dispersive"]);
    assert!(dispersive["practice"]["range_of_tests_mm"].is_null() && !page.contains(said));
}

/// A silt on filters that hold it, of which one would not if it were dispersive.
#[test]
fn what_nobody_said_of_dispersion_stands_where_no_erosion_is_said() {
    let root = tempfile::tempdir().unwrap();
    let at = root.path();
    let silt = "size_mm,percent_finer\n0.01,0\n0.075,45\n0.3,92\n0.6,100\n";
    fs::write(at.join("silt.csv"), silt).unwrap();
    for (name, d) in [("finer", 0.4), ("coarser", 0.55)] {
        let rows = format!("{d},0\n{},15\n{},100\n", 1.08 * d, 1.65 * d);
        fs::write(at.join(format!("{name}.csv")), format!("size_mm,percent_finer\n{rows}")).unwrap();
    }
    let judge = |filter: &str, more: &[&str]| {
        let words = ["judge", "silt.csv", filter, "--quick", "--overwrite", "--out", "a"];
        let narrow = ["--set", "network.nx=10", "--set", "network.ny=10"];
        let said = call(at, &[&words[..], &narrow, more].concat());
        done(&said);
        let text = String::from_utf8(said.stdout).unwrap();
        let next = text.lines().find(|line| line.starts_with("Next: ")).unwrap().to_owned();
        let outcome = json(at.join("a/outcome.json"));
        assert_eq!(outcome["model"]["class"], "no erosion", "{text}");
        let of = outcome["notes"]
            .as_array()
            .unwrap()
            .iter()
            .position(|finding| finding["id"].as_str().unwrap().starts_with("dispers"));
        let found = of.map(|at| (at, outcome["notes"][at]["id"].as_str().unwrap().to_owned()));
        (next, found, outcome)
    };
    let (next, found, outcome) = judge("coarser.csv", &[]);
    // Before all that only limits what was checked.
    assert_eq!(found, Some((0, "dispersion_not_known".into())), "{outcome}");
    let is_empty = |study: &str| outcome[study].as_array().is_none_or(Vec::is_empty);
    assert!(is_empty("sensitivity") && is_empty("thickness"), "{outcome}");
    let test = "have the base tested for dispersion by a pinhole or crumb test";
    assert_eq!(next, format!("Next: {test}"));
    let (next, found, _) = judge("finer.csv", &[]);
    assert_eq!(found.unwrap().1, "dispersion_not_known");
    // It holds whatever the test says.
    assert!(!next.contains("dispersion by"), "{next}");
    for known in [&["--set", "base.dispersive=false"][..], &["--dispersive"]] {
        let (next, found, outcome) = judge("finer.csv", known);
        assert!(!next.contains("dispersion by"), "{next}");
        assert!(found.is_none_or(|(_, id)| id == "dispersive_base"), "{outcome}");
    }
}

/// Where its curve is no guess and the pair a good one, a first look is all that there is to doubt.
#[test]
fn a_first_look_says_so_beside_the_verdict() {
    let (_root, at) = soils();
    let scene = "[base]\ncu = 1.5\nd85_at_dc = 40\n";
    fs::write(at.join("good.toml"), format!("replicates = 5\n[filter]\ncurve = \"cu1.5-loose\"\n{scene}"))
        .unwrap();
    // As narrow as a lattice may be without a doubt.
    let wide = ["--set", "network.nx=10", "--set", "network.ny=10", "--set", "network.nz=8"];
    let run = |more: &[&str]| {
        let said = call(
            &at,
            &[&["run", "good.toml", "--json", "--overwrite", "--out", "a"][..], &wide, more].concat(),
        );
        done(&said);
        serde_json::from_slice::<Value>(&said.stdout).unwrap()
    };
    let ids = |more: &[&str]| -> Vec<String> {
        let found = run(more)["notes"].as_array().unwrap().clone();
        found.iter().map(|finding| finding["id"].as_str().unwrap().into()).collect()
    };
    let has = |more: &[&str], id: &str| ids(more).iter().any(|found| found == id);
    assert!(!has(&[], "few_replicates") && !has(&[], "one_replicate"));
    assert!(has(&["--set", "replicates=4"], "few_replicates"));
    // A rule that may add none is no better.
    let most = ["--set", "stop.most_replicates=2", "--decide-percent", "50", "--set", "replicates=2"];
    assert!(has(&most, "few_replicates"));
    assert!(has(&["--set", "replicates=1"], "one_replicate"));
    let judged =
        call(&at, &[&["judge", "base.csv", "fine.csv", "--quick", "--out", "b"][..], &SMALL].concat());
    done(&judged);
    let text = String::from_utf8(judged.stdout).unwrap();
    assert!(text.contains("report: b/report.html; ") && text.contains(" notes: "), "{text}");
}

/// The till of the first trial on its gravel: six times the limit of design. Whatever the class, the second line
/// and the box of the verdict say so, and a worse soil does not take it back.
#[test]
fn a_broken_rule_of_retention_stands_in_the_first_lines_of_every_verdict() {
    let (_root, at) = soils();
    fs::write(at.join("till.csv"), "size_mm,percent\n0.075,22\n0.425,60\n2,82\n4.75,92\n19,100\n").unwrap();
    fs::write(at.join("gravel.csv"), "size_mm,percent\n5,0\n6.5,15\n20,100\n").unwrap();
    for (ratio, dispersive) in [("0.5", false), ("0.05", false), ("0.5", true)] {
        let set = format!("base.mass_ratio={ratio}");
        let words =
            ["judge", "till.csv", "gravel.csv", "--quick", "--overwrite", "--out", "a", "--set", &set];
        let worse: &[&str] = if dispersive { &["--dispersive"] } else { &[] };
        let said = call(&at, &[&words[..], &SMALL, worse].concat());
        done(&said);
        let text = String::from_utf8(said.stdout).unwrap();
        assert!(text.lines().count() <= 12, "{text}");
        let lines: Vec<&str> = text.lines().skip_while(|line| !line.starts_with("Practice: ")).collect();
        assert!(lines[0].starts_with("Practice: does not meet practice: D15F 6.50 mm, limit "), "{text}");
        // (40 - 22/0.92)/25 (4 x 1.530 - 0.7) + 0.7, with D85B of what passes No. 4. Of a dispersive base with
        // so many fines no text gives the limit itself.
        assert_eq!(lines[0].contains("limit not known, at most 4.18 mm"), dispersive, "{text}");
        assert!(
            lines[1].starts_with("Model (research): ") && lines[2].starts_with("Next: take a "),
            "{text}"
        );
        let outcome = json(at.join("a/outcome.json"));
        assert_eq!(outcome["headline"], "does not meet practice");
        let practice = &outcome["practice"];
        assert_eq!(practice["class"], "does not meet");
        assert_eq!(practice["d15f_mm"], serde_json::json!([6.5, 6.5]));
        assert!((practice["limit_mm"].as_f64().unwrap() - 4.18).abs() < 0.01, "{practice}");
        // A number and its unit are kept together.
        let page = fs::read_to_string(at.join("a/report.html")).unwrap().replace('\u{202f}', " ");
        let place = |what: &str| page.find(what).unwrap_or_else(|| panic!("{what}"));
        let practice = place("<b>Practice</b>: does not meet practice: D15F 6.50 mm");
        assert!(place("section class=\"verdict continuing") < practice);
        assert!(practice < place("<b>Model (research)</b>: "));
        assert!(place("<b>Model (research)</b>: ") < place("<b>Next</b>: "));
        assert!(!page.contains("<section class=\"verdict none"));
    }
}

/// Silt, and a filter whose D15F of 0.6 mm lies between the limits: 0.5 mm where the base is dispersive, 0.7 mm.
#[test]
fn a_dispersive_base_and_an_open_joint_reach_the_verdict() {
    let (_root, at) = soils();
    fs::write(at.join("silt.csv"), "size_mm,percent\n0.01,0\n0.05,40\n0.075,55\n0.2,85\n0.3,100\n").unwrap();
    fs::write(at.join("sand.csv"), "size_mm,percent\n0.5,0\n0.6,15\n1.0,70\n1.5,100\n").unwrap();
    let judge = |more: &[&str]| {
        let words = ["judge", "silt.csv", "sand.csv", "--quick", "--json", "--overwrite", "--out", "a"];
        // With more the class is the worst there is, of which nothing on the unsafe side is a doubt.
        let few = ["--set", "replicates=4"];
        let said = call(&at, &[&words[..], &SMALL, &few, more].concat());
        done(&said);
        serde_json::from_slice::<Value>(&said.stdout).unwrap()
    };
    let rule = |outcome: &Value, id: &str| {
        let rules = outcome["rules"].as_array().unwrap();
        rules.iter().find(|rule| rule["id"] == id).cloned().unwrap_or_default()
    };
    let plain = judge(&[]);
    let design = rule(&plain, "sherard-dunnigan");
    assert_eq!((&design["limit"], &design["met"]), (&0.7.into(), &true.into()));
    assert!(rule(&plain, "constricted-exit").is_null());
    let told = judge(&["--dispersive", "--joint-mm", "2"]);
    let design = rule(&told, "sherard-dunnigan");
    assert_eq!((&design["limit"], &design["met"]), (&0.5.into(), &false.into()));
    assert!(rule(&told, "constricted-exit")["value"].as_f64().unwrap() > 50.0);
    assert_eq!(
        (&told["summary"], &told["n_base"]),
        (&plain["summary"], &plain["n_base"]),
        "the walk is the same"
    );
    let found = told["notes"].to_string();
    for id in ["dispersive_base", "open_joint"] {
        assert!(found.contains(id), "{found}");
    }
    // The scene beside the results says it again, and a word that is neither is refused.
    let scene = fs::read_to_string(at.join("a/scene.toml")).unwrap();
    assert!(scene.contains("dispersive = true") && scene.contains("joint_mm = 2.0"), "{scene}");
    let wrong = ["judge", "silt.csv", "sand.csv", "--set", "base.dispersive=perhaps"];
    refused(&call(&at, &wrong), "true or false");
}

#[test]
fn a_density_packs_the_filter() {
    let (_root, at) = soils();
    let words = [
        "judge",
        "base.csv",
        "coarse.csv",
        "--density",
        "medium",
        "--pack",
        "--quick",
        "--json",
        "--out",
        "a",
    ];
    let small = ["--set", "packing.grains=150", "--set", "packing.stiffness_ratio=0.01"];
    let said = call(&at, &[&words[..], &SMALL, &small].concat());
    done(&said);
    let outcome: Value = serde_json::from_slice(&said.stdout).unwrap();
    assert_eq!(outcome["replicates"].as_array().unwrap().len(), 5);
    let scene = fs::read_to_string(at.join("a/scene.toml")).unwrap();
    assert!(scene.contains("density = \"intermediate\"") && scene.contains("inputs/filter-curve.csv"));
    assert!(at.join("voidwalk-packings").is_dir());
}

#[test]
fn what_is_wrong_is_refused_before_anything_is_written() {
    let (_root, at) = soils();
    let judge = |more: &[&str]| call(&at, &[&["judge", "base.csv"][..], more].concat());
    refused(&judge(&["fine.csv", "--density", "0.45"]), "write loose, medium (or intermediate) or dense");
    refused(&judge(&["no.csv"]), "no.csv");
    refused(&judge(&["fine.csv", "--set", "base.uc=3"]), "did you mean `base.cu`");
    refused(&judge(&["fine.csv", "--density", "loose", "--set", "filter.estimate=1"]), "keep one");
    // Else the answer for one soil would stand under the name of another.
    let other = "would put another soil in the place of the base, base.csv";
    refused(&judge(&["fine.csv", "--set", "base.sieve=\"coarse.csv\""]), other);
    fs::write(at.join("bad.csv"), "size_mm,percent\n0.1,10\n0.2,5\n").unwrap();
    refused(&judge(&["bad.csv"]), "bad.csv");
    assert_eq!(fs::read_dir(&at).unwrap().count(), 4, "nothing was written");
    done(&call(
        &at,
        &[&["judge", "base.csv", "fine.csv", "--quick", "--out", "a", "-q"][..], &SMALL].concat(),
    ));
    refused(&judge(&["fine.csv", "--out", "a"]), "holds a run already");
}

/// A kill while the earlier results go would lose what the run is begun from.
#[test]
fn what_a_run_is_begun_from_is_not_cleared_with_the_earlier_results() {
    let (_root, at) = soils();
    let first = ["judge", "base.csv", "fine.csv", "--quick", "--out", "a"];
    done(&call(&at, &[&first[..], &SMALL].concat()));
    let before = fs::read(at.join("a/outcome.json")).unwrap();
    let again: [&[&str]; 3] = [
        &["run", "a/scene.toml", "--out", "a", "--overwrite", "--seed", "9"],
        &["run", "a/scene.toml", "--out", "./a/../a", "--overwrite"],
        &["judge", "a/inputs/base-sieve.csv", "fine.csv", "--out", "a", "--overwrite"],
    ];
    for words in again {
        refused(&call(&at, words), "a kill would lose it; name another folder by --out");
        assert_eq!(fs::read(at.join("a/outcome.json")).unwrap(), before, "{words:?}");
    }
    // What stands elsewhere in the folder is nobody's to clear.
    fs::copy(at.join("base.csv"), at.join("a/mine.csv")).unwrap();
    let words = ["judge", "a/mine.csv", "fine.csv", "--quick", "--out", "a", "--overwrite"];
    done(&call(&at, &[&words[..], &SMALL].concat()));
    assert!(at.join("a/mine.csv").is_file());
}
