//! `design --each`: how coarse a filter may be for each of many samples; inches.

use std::fs;
use std::path::Path;
use std::process::Output;

use serde_json::Value;
use voidwalk::run::FolderKind;

use crate::judge::SMALL;
use crate::program::{call, done, figures_are_listed, refused};
use crate::sheet::inches_within;

/// Three sands.
const SAMPLES: &str = "Sieve (mm),Core,Shell,Till\n10,100,100,100\n1,100,100,100\n0.5,100,80,60\n\
    0.25,40,20,10\n0.1,0,0,0\n";

fn site() -> tempfile::TempDir {
    let root = tempfile::tempdir().unwrap();
    fs::write(root.path().join("samples.csv"), SAMPLES).unwrap();
    fs::write(root.path().join("other.csv"), SAMPLES.replace("80,60", "85,60")).unwrap();
    root
}

fn words<'a>(samples: &'a str, out: &'a str) -> Vec<&'a str> {
    vec!["design", samples, "--each", "--out", out]
}

fn designed(at: &Path, words: &[&str]) -> Output {
    let output = call(at, words);
    done(&output);
    output
}

fn record(folder: &Path) -> Value {
    serde_json::from_slice(&fs::read(folder.join("designs.json")).unwrap()).unwrap()
}

fn tables(folder: &Path) -> [Vec<u8>; 3] {
    ["designs.csv", "designs.json", "designs.html"].map(|name| fs::read(folder.join(name)).unwrap())
}

#[test]
fn a_row_is_the_design_of_that_sample_and_the_strictest_governs() {
    let root = site();
    let at = root.path();
    let said = String::from_utf8(designed(at, &words("samples.csv", "d")).stdout).unwrap();
    let all = record(&at.join("d"));
    let rows = all["rows"].as_array().unwrap();
    assert_eq!(rows.len(), 3);
    for row in rows {
        let sample = row["sample"].as_str().unwrap();
        designed(at, &["design", &format!("samples.csv#{sample}"), "--out", sample]);
        let own = fs::read(at.join(sample).join("specification.json")).unwrap();
        let own: Value = serde_json::from_slice(&own).unwrap();
        for name in ["d15f_max_mm", "d15f_min_mm"] {
            assert_eq!(row[name], own[name], "{sample}");
        }
    }
    let least = rows.iter().min_by(|a, b| {
        let of = |row: &Value| row["d15f_max_mm"].as_f64().unwrap();
        of(a).total_cmp(&of(b))
    });
    let least = least.unwrap();
    assert_eq!(least["governs"], 1);
    let governing = format!("Governing sample {}: D15F up to ", least["sample"].as_str().unwrap());
    let page = fs::read_to_string(at.join("d/designs.html")).unwrap();
    assert!(said.contains(&governing) && page.contains(&governing), "{governing}: {said}");
    assert!(!page.contains("Model (research)") && !at.join("d/samples").exists());
    figures_are_listed(FolderKind::Designs, &at.join("d"));
    let before = tables(&at.join("d"));
    refused(&call(at, &words("samples.csv", "d")), "holds a set of designs already");
    assert_eq!(tables(&at.join("d")), before);
    // The page is made again from the record alone.
    fs::remove_file(at.join("d/designs.html")).unwrap();
    designed(at, &["report", "d"]);
    assert_eq!(tables(&at.join("d")), before);
    // Other samples in its place.
    designed(at, &[&words("other.csv", "d")[..], &["--overwrite"]].concat());
    assert_ne!(tables(&at.join("d"))[0], before[0]);
}

#[test]
fn a_folder_of_sheets_is_taken() {
    let root = site();
    let at = root.path();
    fs::create_dir(at.join("sheets")).unwrap();
    fs::rename(at.join("samples.csv"), at.join("sheets/one.csv")).unwrap();
    fs::write(
        at.join("sheets/two.csv"),
        "mm,percent finer\n2,100\n0.6,92\n0.2,80\n0.075,60\n0.02,45\n0.006,30\n0.002,15\n",
    )
    .unwrap();
    let said = designed(at, &["design", "sheets", "--each"]).stdout;
    let said = String::from_utf8(said).unwrap();
    let all = record(&at.join("voidwalk-designs"));
    let rows = all["rows"].as_array().unwrap();
    let names: Vec<&str> = rows.iter().map(|row| row["sample"].as_str().unwrap()).collect();
    assert_eq!(names, ["one/Core", "one/Shell", "one/Till", "two"]);
    assert!(said.contains("Governing sample two: D15F up to 0.700 mm (practice: "), "{said}");
    // The limits are those of the specification of each.
    designed(at, &["design", "sheets/two.csv", "--out", "s"]);
    let steps: Value = serde_json::from_slice(&fs::read(at.join("s/specification.json")).unwrap()).unwrap();
    assert_eq!(rows[3]["d15f_max_mm"], steps["d15f_max_mm"]);
    assert_eq!(rows[3]["d15f_min_mm"], steps["d15f_min_mm"]);
}

#[test]
fn samples_of_several_files_and_folders_are_rows_of_one_table() {
    let root = site();
    let at = root.path();
    fs::create_dir(at.join("sheets")).unwrap();
    fs::copy(at.join("other.csv"), at.join("sheets/more.csv")).unwrap();
    let of = |files: &[&str], out: &str| {
        designed(at, &[&["design"], files, &["--each", "--out", out]].concat());
        record(&at.join(out))
    };
    let all = of(&["samples.csv", "other.csv#Till", "sheets"], "all");
    let rows = all["rows"].as_array().unwrap();
    let names: Vec<&str> = rows.iter().map(|row| row["sample"].as_str().unwrap()).collect();
    // Till of two files is told apart by them.
    assert_eq!(
        names,
        ["Core", "Shell", "samples: Till", "other: Till", "more/Core", "more/Shell", "more/Till"]
    );
    assert_eq!(all["samples"], "samples, other: Till, sheets");
    let files: Vec<&str> =
        all["inputs"].as_array().unwrap().iter().map(|of| of["name"].as_str().unwrap()).collect();
    assert_eq!(files, ["samples.csv", "other.csv", "sheets/more.csv"]);
    // A row does not depend on its neighbours.
    let alone = of(&["samples.csv"], "alone");
    for (row, own) in rows.iter().zip(alone["rows"].as_array().unwrap()) {
        assert_eq!((&row["d15f_max_mm"], &row["path"]), (&own["d15f_max_mm"], &own["path"]));
    }
    let twice = call(at, &["design", "sheets", "sheets/more.csv#Core", "--each", "--out", "twice"]);
    refused(&twice, "sheets/more.csv#Core is named twice");
    assert!(!at.join("twice").exists());
}

#[test]
fn what_cannot_be_done_is_refused_before_anything_is_written() {
    let root = site();
    let at = root.path();
    let walked = call(at, &["design", "samples.csv", "--each", "--filter", "nowhere.csv", "--out", "d"]);
    refused(&walked, "--filter");
    let set = call(at, &["design", "samples.csv", "--each", "--set", "replicates=2", "--out", "d"]);
    refused(&set, "a specification walks nothing");
    refused(&call(at, &["design", "gone.csv", "--each"]), "gone.csv");
    assert!(!at.join("d").exists() && !at.join("voidwalk-designs").exists());
}

/// That no maximum D15F has more inches than mm, and no least fewer.
fn assert_inches_lie_within(page: &str) {
    let mut found = inches_within(page);
    let page = &page.replace("\u{202f}mm (", " mm (");
    let bands = page.match_indices("D15F from ").chain(page.match_indices("lie between "));
    for (at, words) in bands {
        let rest = &page[at + words.len()..];
        let Some((mm, rest)) = rest.split_once(" mm (") else { continue };
        let Some((inches, _)) = rest.split_once("\u{202f}in") else { continue };
        let ends = |text: &str| -> Option<Vec<f64>> {
            text.split([' '])
                .filter(|word| !["to", "and"].contains(word))
                .map(|word| word.parse().ok())
                .collect()
        };
        let (Some(mm), Some(inches)) = (ends(mm), ends(inches)) else { continue };
        assert!(
            inches[0] * 25.4 * (1.0 + 1e-9) >= mm[0] && inches[1] * 25.4 <= mm[1] * (1.0 + 1e-9),
            "{mm:?}"
        );
        found += 1;
    }
    assert!(found > 0, "{page}");
}

#[test]
fn inches_stand_beside_mm_where_they_are_asked_for() {
    let root = site();
    let at = root.path();
    let steps = ["design", "samples.csv#Core", "--units", "us", "--out", "s"];
    let said = String::from_utf8(designed(at, &steps).stdout).unwrap();
    let page = fs::read_to_string(at.join("s/specification.html")).unwrap();
    assert!(said.contains(" in)"), "{said}");
    assert_inches_lie_within(&page);
    // The table of the band has the inches of the headline.
    let answer = page.split("D15F from ").nth(1).unwrap().split("\u{202f}in), Cu").next().unwrap();
    let (mm, inches) = answer.split_once("\u{202f}mm (").unwrap();
    for (mm, inches) in mm.split(" to ").zip(inches.split(" to ")) {
        assert!(page.contains(&format!("{mm} ({inches}\u{202f}in)")), "{answer}");
    }
    assert!(
        page.contains("in), Cu from 2 to 6, by practice.")
            && !page.contains("<title>Specification of a filter (")
    );
    let csv = fs::read_to_string(at.join("s/specification.csv")).unwrap();
    assert!(csv.contains("No. 200") && !csv.contains("in)"), "{csv}");
    // Boundaries of the model have them, too, and their page that is made again is the same.
    let walk = [
        "boundary",
        "samples.csv#Core",
        "--filter",
        "cu1.5-loose",
        "--set",
        "about.units='us'",
        "--out",
        "w",
    ];
    let walk = [&walk[..], &SMALL, &["--set", "replicates=1"]].concat();
    designed(at, &walk);
    let page = fs::read_to_string(at.join("w/boundary.html")).unwrap();
    assert!(page.matches("in)").count() > 1);
    designed(at, &["report", "w"]);
    assert_eq!(fs::read_to_string(at.join("w/boundary.html")).unwrap(), page);
    let metric = ["design", "samples.csv#Core", "--out", "m"];
    assert!(!String::from_utf8(designed(at, &metric).stdout).unwrap().contains("in)"));
    let twice = ["design", "samples.csv#Core", "--units", "us", "--set", "about.units=us"];
    refused(&call(at, &twice), "say the same thing twice");
}

/// Two gravels whose filters would have to be coarser than 75 mm.
const GRAVELS: &str = "mm,T1,T2\n37.5,100,100\n19,80,95\n9.5,60,75\n4.75,40,50\n2,10,20\n1,0,0\n";

#[test]
fn samples_without_a_band_of_their_own_are_named_and_not_served() {
    let root = site();
    let at = root.path();
    fs::write(at.join("gr.csv"), GRAVELS).unwrap();
    let said = designed(at, &["design", "gr.csv", "--each", "--units", "us", "--out", "g"]).stdout;
    let said = String::from_utf8(said).unwrap();
    let page = fs::read_to_string(at.join("g/designs.html")).unwrap();
    let all = record(&at.join("g"));
    for row in all["rows"].as_array().unwrap() {
        let name = row["sample"].as_str().unwrap();
        designed(at, &["design", &format!("gr.csv#{name}"), "--out", name]);
        let own = fs::read(at.join(name).join("specification.json")).unwrap();
        let own: Value = serde_json::from_slice(&own).unwrap();
        assert!(own["no_band"].is_object() && row["no_band"] == own["no_band"], "{row}");
        assert!(page.contains(&format!("No band for {name}: ")));
    }
    assert!(said.contains("No filter is known that serves all 2 samples") && !said.contains("A filter for"));
    assert!(all["inches"] == true && said.contains(" in)") && page.contains("\u{202f}in)"), "{said}");
    // Of one whose maximum D15F is not known practice says no more than the most.
    fs::write(at.join("mix.csv"), "mm,Coarse,Cut\n4,100,100\n2,90,90\n1,60,60\n0.5,20,45\n0.25,0,30\n")
        .unwrap();
    designed(at, &["design", "mix.csv", "--each", "--out", "m"]);
    let page = fs::read_to_string(at.join("m/designs.html")).unwrap();
    assert!(page.contains("May govern, as no maximum D15F is known: Cut: "));
}
