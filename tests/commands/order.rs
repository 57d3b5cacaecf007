//! One order of two soils, the base and then the filter; and a base that is walked as practice regrades it.

use std::fs;
use std::path::PathBuf;

use serde_json::Value;

use crate::judge::{SMALL, soils};
use crate::program::{call, done, refused};

/// 92 % finer than 4.75 mm, 35 % than 0.075 mm.
const TILL: &str = "size_mm,percent\n19,100\n4.75,92\n2,82\n0.425,60\n0.075,35\n0.02,0\n";
const SAND: &str = "size_mm,percent\n0.3,0\n0.45,15\n0.9,60\n2,100\n";

fn till_and_sand() -> (tempfile::TempDir, PathBuf) {
    let (root, at) = soils();
    fs::write(at.join("till.csv"), TILL).unwrap();
    fs::write(at.join("sand.csv"), SAND).unwrap();
    (root, at)
}

fn json(path: PathBuf) -> Value {
    serde_json::from_slice(&fs::read(path).unwrap()).unwrap()
}

#[test]
fn exchanged_files_are_refused_in_the_same_words_by_every_command_and_nothing_is_written() {
    let (_root, at) = till_and_sand();
    let words: [&[&str]; 3] = [
        &["rules", "sand.csv", "till.csv"],
        &["judge", "sand.csv", "till.csv", "--out", "x"],
        &["boundary", "sand.csv", "--filter", "till.csv", "--out", "x"],
    ];
    for words in words {
        let said = call(&at, words);
        for message in [
            "base sand.csv, filter till.csv: the base is coarser than the filter",
            "are the two files exchanged?",
            "The base is named first, then the filter: exchange the two",
            "--as-given",
        ] {
            refused(&said, message);
        }
        assert!(!at.join("x").exists() && said.stdout.is_empty(), "{words:?}");
    }
    // In their own order they are taken, and exchanged where it is said that they are as given.
    done(&call(&at, &["rules", "till.csv", "sand.csv"]));
    done(&call(&at, &["rules", "sand.csv", "till.csv", "--as-given"]));
}

#[test]
fn a_base_in_a_table_is_walked_regraded_and_every_d85b_says_which_it_is() {
    let (_root, at) = till_and_sand();
    let few = ["--quick", "--set", "base.n_base=2000"];
    let judge = |more: &[&str]| {
        let words = [&["judge", "till.csv", "sand.csv", "--overwrite", "--out", "a"][..], &SMALL, &few, more];
        let said = call(&at, &words.concat());
        done(&said);
        let figure = fs::read_to_string(at.join("a/figures/gradations.svg")).unwrap();
        let page = fs::read_to_string(at.join("a/report.html")).unwrap().replace('\u{202f}', " ");
        (String::from_utf8(said.stdout).unwrap(), json(at.join("a/outcome.json")), figure, page)
    };
    let label = "D85B 1.53 mm, regraded on 4.75 mm (as sampled 2.59 mm)";
    let (_, outcome, figure, page) = judge(&[]);
    let base = &outcome["inputs"]["base"];
    assert_eq!((base["regraded_at_mm"].as_f64(), base["d100_mm"].as_f64()), (Some(4.75), Some(4.75)));
    assert_eq!(base["as_sampled"]["d100_mm"], 19.0);
    assert!((base["as_sampled"]["d85_mm"].as_f64().unwrap() - 2.592).abs() < 1e-2, "{base}");
    assert!(figure.contains("base as sampled,") && figure.contains("base, regraded on 4.75 mm"), "{figure}");
    assert!(page.contains(label) && page.contains("as sampled (not walked)"), "{page}");
    let (_, outcome, figure, page) = judge(&["--as-sampled"]);
    assert!(page.contains("D85B 2.59 mm as sampled") && !page.contains("regraded on 4.75 mm ("), "{page}");
    assert!(outcome["inputs"]["base"].get("as_sampled").is_none() && !figure.contains("not walked"));
    // What a setting says goes before that, and both are one too many.
    let (.., page) = judge(&["--set", "base.regrade=no"]);
    assert!(page.contains("D85B 2.59 mm as sampled"), "{page}");
    let words = ["judge", "till.csv", "sand.csv", "--as-sampled", "--set", "base.regrade=practice"];
    refused(&call(&at, &words), "say the same thing twice");
    // A table of several filters does the same.
    let words = ["judge", "till.csv", "sand.csv", "fine.csv", "--out", "c"];
    done(&call(&at, &[&words[..], &SMALL, &few].concat()));
    let batch = json(at.join("c/batch.json"));
    for row in batch["rows"].as_array().unwrap() {
        assert_eq!(row["walk"]["base"]["regraded_at_mm"], 4.75, "{row}");
    }
}

/// The till of the third trial, with a hydrometer part.
#[test]
fn boundaries_say_which_d85b_they_are_of() {
    let (_root, at) = till_and_sand();
    let till = "size_mm,percent\n19,100\n9.5,96\n4.75,92\n2,82\n0.85,69.845756\n0.425,60\n0.25,52.352301\n0.15,44.990009\n0.075,35\n0.06,0\n";
    fs::write(at.join("till.csv"), till).unwrap();
    let small = ["--set", "network.nx=3", "--set", "network.ny=3", "--set", "replicates=2"];
    let words = ["boundary", "till.csv", "--filter", "cu1.5-loose", "--thickness", "60layers"];
    let said = call(&at, &[&words[..], &small].concat());
    done(&said);
    let found = json(at.join("voidwalk-boundary/boundary.json"));
    assert_eq!(found["base"]["regraded_at_mm"], 4.75);
    let text = String::from_utf8(said.stdout).unwrap();
    let lines: Vec<&str> = text.lines().collect();
    let model = lines.iter().position(|line| line.starts_with("Model (research): ")).unwrap();
    assert_eq!(lines[model + 1], "  D85B 1.53 mm, regraded on 4.75 mm (as sampled 2.59 mm)");
    let csv = fs::read_to_string(at.join("voidwalk-boundary/boundary.csv")).unwrap();
    assert!(csv.lines().next().unwrap().ends_with(",eroded_second,d85b_of"), "{csv}");
    assert!(csv.lines().skip(1).all(|line| line.ends_with(",regraded on 4.75 mm")), "{csv}");
    let words = ["boundary", "till.csv", "--as-sampled", "--set", "base.regrade=practice"];
    refused(&call(&at, &words), "say the same thing twice");
}
