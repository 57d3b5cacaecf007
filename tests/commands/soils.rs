//! Soils as a user meets them: `voidwalk soil`, and a workbook in a scene.

use std::fs;
use std::path::Path;
use std::process::{Command, Output};

use serde_json::Value;

fn voidwalk(args: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_voidwalk")).args(args).output().unwrap()
}

fn soils(name: &str) -> String {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/soils").join(name).display().to_string()
}

fn text(output: &Output) -> String {
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    String::from_utf8_lossy(&output.stdout).into_owned()
}

#[test]
fn a_soil_is_shown_with_its_sizes_and_class() {
    let shown: Value =
        serde_json::from_str(&text(&voidwalk(&["soil", &soils("us_names.csv"), "--json"]))).unwrap();
    let soil = &shown["soils"][0];
    assert_eq!(soil["name"], "us_names");
    assert_eq!(soil["points"].as_array().unwrap().len(), 8);
    assert_eq!(soil["fines_percent"].as_f64(), Some(1.0));
    // Straight in percent against ln(size), between No. 100 (5 %) and No. 50 (18 %).
    let d15 = 0.15 * 2f64.powf(10.0 / 13.0);
    assert!((soil["d15_mm"].as_f64().unwrap() - d15).abs() < 1e-12, "{soil}");
    for name in ["d50_mm", "d85_mm", "d95_mm", "cu", "cc"] {
        assert!(soil[name].is_f64(), "{name}");
    }
    let words = text(&voidwalk(&["soil", &soils("sheets.xlsx")]));
    for part in
        ["Filter A", "Base 1", "D15", "class (ASTM D2487)", "sand with more than 12 % fines: SM or SC"]
    {
        assert!(words.contains(part), "{words}");
    }
    // D5 of a soil whose pan holds more is not known.
    let shown = text(&voidwalk(&["soil", &soils("several.csv#base 1"), "--json"]));
    let shown: Value = serde_json::from_str(&shown).unwrap();
    assert_eq!(shown["soils"].as_array().unwrap().len(), 1);
    assert!(shown["soils"][0]["d15_mm"].is_null() && shown["soils"][0]["cu"].is_null(), "{shown}");
}

/// A figure is written where none is, and nothing where the file is refused.
#[test]
fn the_curves_of_a_file_are_drawn_where_asked() {
    let root = tempfile::tempdir().unwrap();
    let figure = root.path().join("curves.svg");
    let at = figure.to_str().unwrap();
    let refused = voidwalk(&["soil", &soils("gradings_summary.ags"), "--figure", at]);
    assert!(refused.status.code() == Some(2) && !figure.exists());
    let drawn = voidwalk(&["soil", &soils("gradings.ags"), "--figure", at]);
    assert!(drawn.status.success() && String::from_utf8_lossy(&drawn.stdout).contains("curves.svg"));
    let text = std::fs::read_to_string(&figure).unwrap();
    assert!(text.contains(">BH1 1.50 1.50<") && text.contains(">BH2 3.00 3.00<"), "{text}");
    let again = voidwalk(&["soil", &soils("gradings.ags"), "--figure", at]);
    assert!(again.status.code() == Some(2));
    assert!(String::from_utf8_lossy(&again.stderr).contains("exists already"));
}

#[test]
fn a_soil_that_is_not_there_or_not_clear_is_refused() {
    for (file, message) in [
        ("sheets.xlsx#Filter Z", "holds no soil called \"Filter Z\"; it holds Filter A, Base 1"),
        ("bad_value.xlsx", "sheet \"A\", cell B9, percent_finer: \"sixty\""),
        ("bomb.xlsx", "too large"),
    ] {
        let output = voidwalk(&["soil", &soils(file)]);
        let stderr = String::from_utf8_lossy(&output.stderr);
        assert!(output.status.code() == Some(2) && stderr.contains(message), "{file}: {stderr}");
    }
    let set = format!("base.sieve={}", soils("sheets.xlsx"));
    let output = voidwalk(&["check", "--set", &set]);
    let stderr = String::from_utf8_lossy(&output.stderr);
    assert!(stderr.contains("several soils: Filter A, Base 1; name one of them"), "{stderr}");
}

/// A run keeps the workbook under its ending; its own scene names the sheet and gives the same bits.
#[test]
fn a_scene_may_name_a_sheet_and_is_run_again_from_its_folder() {
    let root = tempfile::tempdir().unwrap();
    fs::copy(soils("sheets.xlsx"), root.path().join("site.xlsx")).unwrap();
    let scene = root.path().join("scene.toml");
    fs::write(
        &scene,
        "replicates = 2\nengine = \"particles\"\n[filter]\ncurve = \"cu3-loose\"\nd0_mm = 2.0\n[base]\n\
         sieve = \"site.xlsx#Filter A\"\nd0_mm = 0.05\n[network]\nnx = 6\nny = 6\nnz = 8\n[record]\nsensitivity = []\n",
    )
    .unwrap();
    let run = |scene: &Path, name: &str| {
        let out = root.path().join(name);
        text(&voidwalk(&["run", scene.to_str().unwrap(), "--out", out.to_str().unwrap(), "--quiet"]));
        out
    };
    let first = run(&scene, "first");
    let kept = fs::read(first.join("inputs/base-sieve.xlsx")).unwrap();
    assert_eq!(kept, fs::read(soils("sheets.xlsx")).unwrap());
    let resolved = fs::read_to_string(first.join("scene.toml")).unwrap();
    assert!(resolved.contains("sieve = \"inputs/base-sieve.xlsx#Filter A\""), "{resolved}");
    let outcome = |folder: &Path| fs::read_to_string(folder.join("outcome.json")).unwrap();
    assert!(outcome(&first).contains("site.xlsx#Filter A"), "{}", outcome(&first));
    let again = run(&first.join("scene.toml"), "again");
    let series = |folder: &Path| fs::read(folder.join("series.csv")).unwrap();
    assert_eq!(series(&again), series(&first));
    assert!(outcome(&again).contains("site.xlsx#Filter A"), "{}", outcome(&again));
}
