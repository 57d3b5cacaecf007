//! `voidwalk boundary`: what its folder holds, what is refused, and how it is stopped and goes on.

use std::fs;
use std::path::Path;
use std::time::{Duration, Instant};

use serde_json::Value;
use voidwalk::run::FolderKind;

use crate::program::{call, done, figures_are_listed, refused, voidwalk};

const BASE: &str = "opening_mm,percent_finer\n0.063,0\n0.125,20\n0.25,75\n0.5,100\n";

/// A lattice that takes moments, and few networks.
const SMALL: [&str; 8] = [
    "--set",
    "network.nx=8",
    "--set",
    "network.ny=8",
    "--set",
    "replicates=2",
    "--set",
    "filter.grains_per_void=0.6",
];

fn with_base() -> tempfile::TempDir {
    let root = tempfile::tempdir().unwrap();
    fs::write(root.path().join("base.csv"), BASE).unwrap();
    root
}

fn boundary(folder: &Path, args: &[&str]) -> std::process::Output {
    call(folder, &[&["boundary"], args, &SMALL[..]].concat())
}

fn json(folder: &Path) -> Value {
    serde_json::from_slice(&fs::read(folder.join("boundary.json")).unwrap()).unwrap()
}

#[test]
fn boundaries_fill_a_folder_and_say_it_all() {
    let root = with_base();
    let args = ["base.csv", "--filter", "cu1.5-loose", "--thickness", "12layers,15mm", "--json", "-q"];
    let output = boundary(root.path(), &args);
    done(&output);
    let out = root.path().join("voidwalk-boundary");
    assert_eq!(
        String::from_utf8(output.stdout).unwrap(),
        fs::read_to_string(out.join("boundary.json")).unwrap()
    );
    let found = json(&out);
    let rows = found["boundaries"].as_array().unwrap();
    assert_eq!(rows.len(), 2);
    for row in rows {
        assert_eq!(row["density"], "loose");
        for boundary in ["no_erosion", "continuing"].map(|name| &row[name]) {
            let of = |value: &Value, name: &str| value[name].as_f64().unwrap();
            let [low, median, high] = ["low", "median", "high"].map(|name| of(boundary, name));
            assert!(0.5 < low && low <= median && median <= high && high < 20.0, "{row}");
            // D85B of the base: between 0.25 and 0.5 mm, straight in percent over log size.
            let d85b = 0.25 * 2f64.powf(0.4);
            let mm = of(&boundary["d15f_mm"], "median");
            assert!((mm / (median * d85b) - 1.0).abs() < 1e-9, "{row}");
        }
        assert!(row["no_erosion"]["median"].as_f64() <= row["continuing"]["median"].as_f64());
    }
    assert_eq!((rows[0]["layers"].as_u64(), rows[1]["thickness_mm"].as_f64()), (Some(12), Some(15.0)));
    let header = "density,thickness,network,d15f_over_d85b,eroded_first,eroded_second,d85b_of\n";
    let csv = fs::read_to_string(out.join("boundary.csv")).unwrap();
    assert!(csv.starts_with(header) && csv.lines().count() > 30, "{csv}");
    figures_are_listed(FolderKind::Boundary, &out);
    let page = fs::read_to_string(out.join("boundary.html")).unwrap();
    for words in ["The model leaves out: ", "Content-Security-Policy"] {
        assert!(page.contains(words), "{words}");
    }
    // What practice says of the base is no part of it.
    assert!(!page.contains("ASTM C33") && !page.contains("by practice"), "{page}");
    // The page comes of the files alone.
    fs::remove_file(out.join("boundary.html")).unwrap();
    done(&call(root.path(), &["report", "voidwalk-boundary"]));
    assert_eq!(fs::read_to_string(out.join("boundary.html")).unwrap(), page);
    // A second one is refused, or replaces it.
    refused(&boundary(root.path(), &["base.csv"]), "holds a study of boundaries already");
    let again = ["base.csv", "--overwrite", "--thickness", "8layers"];
    let output = boundary(root.path(), &again);
    done(&output);
    assert_eq!(json(&out)["boundaries"].as_array().unwrap().len(), 1);
    let said = String::from_utf8(output.stdout).unwrap();
    for words in [
        "no erosion up to D15F",
        "continuing erosion from",
        "\nModel (research): nearly all networks hold D15F/D85B ",
        "The model is no proof",
    ] {
        assert!(said.contains(words), "{said}");
    }
}

#[test]
fn a_base_that_was_not_checked_never_looks_reassuring() {
    let root = tempfile::tempdir().unwrap();
    let clay = "opening_mm,percent_finer\n0.001,0\n0.02,60\n0.075,90\n0.3,100\n";
    fs::write(root.path().join("clay.csv"), clay).unwrap();
    let output = boundary(root.path(), &["clay.csv", "--thickness", "8layers"]);
    done(&output);
    let out = root.path().join("voidwalk-boundary");
    let found = json(&out);
    let findings = found["notes"].as_array().unwrap();
    let fines = findings.iter().find(|one| one["id"] == "cohesive_fines").unwrap();
    assert_eq!(fines["numbers"]["fines_percent"], 90.0);
    let page = fs::read_to_string(out.join("boundary.html")).unwrap();
    assert!(!page.contains("class=\"verdict ") && page.contains("Other notes"));
}

#[test]
fn what_is_wrong_is_refused_with_what_is_allowed() {
    let root = with_base();
    let cases: [(&[&str], &str); 8] = [
        (&["nowhere.csv"], "nowhere.csv"),
        (&["base.csv", "--thickness", "0"], "or a length above 0"),
        (&["base.csv", "--density", "2", "--filter", "3"], "dense, medium (or intermediate) or loose"),
        (&["base.csv", "--density", "friction=20", "--filter", "3"], "a number from 0 to 10"),
        (&["base.csv", "--density", "dense", "--filter", "cu3-loose"], "constrictions are"),
        (&["base.csv", "--filter", "0.5"], "from 1 to 1000"),
        (&["--thickness", "500mm"], "needs a base in mm"),
        (&["base.csv", "--thickness", "1,5m"], "a decimal point, not a comma: 1.5m"),
    ];
    for (args, words) in cases {
        refused(&boundary(root.path(), args), words);
        assert!(!root.path().join("voidwalk-boundary").exists(), "{args:?}");
    }
    fs::create_dir(root.path().join("theirs")).unwrap();
    fs::write(root.path().join("theirs/thesis.txt"), "words").unwrap();
    refused(&boundary(root.path(), &["base.csv", "--out", "theirs"]), "theirs");
}

#[cfg(unix)]
#[test]
fn a_search_that_is_interrupted_ends_soon_and_goes_on_with_the_same_bits() {
    let root = with_base();
    let args = |out: &'static str| {
        let many = ["--set", "replicates=6", "--thickness", "8layers", "--threads", "1", "--out", out];
        [&["boundary", "base.csv"], &many[..], &SMALL[..4]].concat()
    };
    done(&call(root.path(), &args("whole")));
    let child = voidwalk(root.path(), &args("cut")).spawn().unwrap();
    // Until the first network is kept.
    let begun = Instant::now();
    while !root.path().join("cut/networks.0").exists() && begun.elapsed() < Duration::from_secs(120) {
        std::thread::sleep(Duration::from_millis(5));
    }
    let stopped = Instant::now();
    let pid = child.id().to_string();
    assert!(std::process::Command::new("kill").args(["-INT", &pid]).status().unwrap().success());
    let output = child.wait_with_output().unwrap();
    let said = String::from_utf8_lossy(&output.stderr).into_owned();
    assert_eq!(output.status.code(), Some(3), "{said}");
    assert!(
        stopped.elapsed() < Duration::from_secs(2) && said.contains("continue with the same command"),
        "{said}"
    );
    assert!(!root.path().join("cut/boundary.json").exists());
    let output = call(root.path(), &args("cut"));
    done(&output);
    assert!(String::from_utf8_lossy(&output.stderr).contains("networks are done already"));
    let of = |out: &str| {
        let mut all = json(&root.path().join(out));
        all["seconds"] = Value::Null;
        (all, fs::read(root.path().join(out).join("boundary.csv")).unwrap())
    };
    assert!(of("whole") == of("cut"), "other bits");
}
