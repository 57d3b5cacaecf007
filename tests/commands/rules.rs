//! `voidwalk rules`, and tables that cannot be a filter and its base.

use std::fs;
use std::path::Path;
use std::process::{Command, Output};

fn voidwalk(args: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_voidwalk")).args(args).output().unwrap()
}

/// A sieve table as a file.
fn table(folder: &Path, name: &str, rows: &str) -> String {
    let path = folder.join(name);
    fs::write(&path, format!("opening_mm,percent_finer\n{rows}")).unwrap();
    path.display().to_string()
}

/// The names of `voidwalk rules --json`, and its table.
#[test]
fn rules_are_applied_without_a_walk_under_the_names_of_the_contract() {
    let root = tempfile::tempdir().unwrap();
    let sieve = |name: &str, rows: &str| table(root.path(), name, rows);
    let filter = sieve("gravel.csv", "5,0\n6.5,15\n20,100\n");
    let till = sieve("till.csv", "19,100\n4.75,92\n2,82\n0.425,60\n0.075,35\n");
    let output = voidwalk(&["rules", &filter, &till, "--json"]);
    assert!(output.status.success());
    let value: serde_json::Value = serde_json::from_slice(&output.stdout).unwrap();
    let base = &value["base"];
    assert_eq!((base["category"].as_u64(), base["regraded"].as_bool()), (Some(3), Some(true)));
    assert!((base["fines_percent"].as_f64().unwrap() - 35.0 / 0.92).abs() < 1e-9);
    assert!((base["d85_mm"].as_f64().unwrap() - 1.5305).abs() < 1e-3);
    let rules = value["rules"].as_array().unwrap();
    for id in [
        "sherard-dunnigan",
        "foster-fell-no-erosion",
        "foster-fell-excessive",
        "foster-fell-continuing",
        "permeability",
        "terzaghi",
        "kezdi",
        "kenney-lau",
    ] {
        let rule = rules.iter().find(|rule| rule["id"] == id).unwrap_or_else(|| panic!("{id}"));
        for name in ["applies", "value", "limit", "unit", "met", "needs", "source"] {
            assert!(rule.get(name).is_some(), "{id}: {name}");
        }
    }
    let met = |id: &str| rules.iter().find(|rule| rule["id"] == id).unwrap()["met"].clone();
    assert_eq!(met("sherard-dunnigan"), false);
    assert_eq!(met("terzaghi"), serde_json::Value::Null);
    let words = String::from_utf8(voidwalk(&["rules", &filter, &till]).stdout).unwrap();
    assert!(words.contains("NOT MET") && words.contains("category 3, 38.0 % fines"), "{words}");
    // Exchanged files, and micrometres under a header in mm.
    let exchanged = String::from_utf8(voidwalk(&["rules", &till, &filter]).stdout).unwrap();
    assert!(exchanged.contains("are the two files exchanged?"), "{exchanged}");
    let micrometres = sieve("um.csv", "75,0\n318,85\n600,100\n");
    let output = voidwalk(&["rules", &filter, &micrometres]);
    assert!(String::from_utf8(output.stdout).unwrap().contains("micrometres under a header in mm"));
}

/// Exchanged tables and micrometres are recognised before Eq. (2) is blamed.
#[test]
fn tables_that_cannot_be_are_refused_by_what_is_wrong_with_them() {
    let root = tempfile::tempdir().unwrap();
    let sieve = |name: &str, rows: &str| table(root.path(), name, rows);
    let sand = sieve("sand.csv", "1,0\n2,50\n4,100\n");
    let refused_with = |filter: &str, base: &str, said: &str| {
        let (filter, base) = (format!("filter.sieve={filter}"), format!("base.sieve={base}"));
        let out = root.path().join("none");
        let args = ["run", "--out", out.to_str().unwrap(), "--set", &filter, "--set", &base];
        let output = voidwalk(&args);
        let stderr = String::from_utf8_lossy(&output.stderr);
        assert!(output.status.code() == Some(2) && stderr.contains(said), "{stderr}");
        assert!(!out.exists());
    };
    let micrometres = sieve("um.csv", "75,0\n318,85\n600,100\n");
    refused_with(&sand, &micrometres, "are its sizes micrometres under a header in mm");
    // Where Eq. (2) still gives particles it is a warning, said before any work.
    let gravel = sieve("gravel.csv", "20,0\n30,50\n60,100\n");
    let (filter, base) = (format!("filter.sieve={sand}"), format!("base.sieve={gravel}"));
    let output = voidwalk(&["check", "--set", &filter, "--set", &base]);
    assert!(String::from_utf8_lossy(&output.stdout).contains("are the two files exchanged?"));
}
