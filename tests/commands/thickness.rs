//! Filters of other thicknesses: the same walks as those of a scene of that thickness.

use std::fs;
use std::path::Path;

use serde_json::Value;

use crate::program::{call, done, refused};

const SCENE: &str = "replicates = 3\nseed = 5\n[filter]\ncurve = \"cu1.5-loose\"\n[base]\ncu = 2\nd15f_over_d85b = 5\n\
    [network]\nnx = 8\nny = 8\nnz = 12\n[record]\nsensitivity = []\n";

fn outcome(folder: &Path) -> Value {
    serde_json::from_slice(&fs::read(folder.join("outcome.json")).unwrap()).unwrap()
}

#[test]
fn a_row_is_what_a_scene_of_that_thickness_gives() {
    let root = tempfile::tempdir().unwrap();
    fs::write(root.path().join("s.toml"), SCENE).unwrap();
    let ran = call(root.path(), &["run", "s.toml", "--out", "o", "--set", "record.thickness=[0.5, 2, 1.01]"]);
    done(&ran);
    done(&call(root.path(), &["run", "s.toml", "--out", "thick", "--set", "network.nz=24"]));
    done(&call(root.path(), &["run", "s.toml", "--out", "thin", "--set", "network.nz=6"]));
    let rows = outcome(&root.path().join("o"))["thickness"].as_array().unwrap().clone();
    // A hundredth more is no layer more.
    assert_eq!(rows.len(), 3);
    for (row, folder, layers) in [(&rows[0], "thin", 6), (&rows[1], "o", 12), (&rows[2], "thick", 24)] {
        let whole = outcome(&root.path().join(folder));
        assert_eq!(row["layers"], layers);
        assert_eq!(
            (&row["n_base"], &row["verdict"]),
            (&whole["n_base"], &whole["model"]["class"]),
            "{folder}"
        );
        for run in 0..2 {
            assert_eq!(row["runs"][run], whole["summary"][run]["eroded_mass_fraction"], "{folder}");
        }
        assert_eq!(row["thickness_mm"], whole["inputs"]["network"]["thickness_mm"]);
    }
    let has_table = |folder: &str| {
        let page = fs::read_to_string(root.path().join(folder).join("report.html")).unwrap();
        page.contains("<summary>Amount of base and thickness")
    };
    assert!(has_table("o") && !has_table("thick"));
}

#[test]
fn half_and_twice_come_with_the_study_of_the_base_and_nothing_else() {
    let root = tempfile::tempdir().unwrap();
    fs::write(root.path().join("s.toml"), SCENE.replace("sensitivity = []", "sensitivity = [2.0]")).unwrap();
    done(&call(
        root.path(),
        &["run", "s.toml", "--out", "o", "--set", "base.n_base=3000", "--set", "replicates=1"],
    ));
    let layers: Vec<u64> = outcome(&root.path().join("o"))["thickness"]
        .as_array()
        .unwrap()
        .iter()
        .map(|row| row["layers"].as_u64().unwrap())
        .collect();
    assert_eq!(layers, [6, 12, 24]);
    refused(
        &call(root.path(), &["check", "s.toml", "--set", "record.thickness=[0]"]),
        "a list of numbers above 0",
    );
}
