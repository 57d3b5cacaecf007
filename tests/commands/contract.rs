//! What scripts rely on: how JSON begins, `--fail-on`, and the digest of an outcome.

use crate::judge::{SMALL, soils};
use crate::program::{call, done, refused};
use crate::schemas::{beginning, json_files, keep_to_schema, problems, schema_of};
use serde_json::Value;
use std::collections::BTreeSet;
use std::fs;
use std::path::Path;
use std::process::Output;

fn text(bytes: &[u8]) -> String {
    String::from_utf8_lossy(bytes).into_owned()
}

/// A record keeps to its schema; without any one of the required fields it does not.
fn keeps_to_its_schema(text: &str) {
    keep_to_schema(text, "");
    let (schema, record) = (schema_of(text), serde_json::from_str::<Value>(text).unwrap());
    for field in schema["required"].as_array().unwrap() {
        let mut less = record.clone();
        less.as_object_mut().unwrap().remove(field.as_str().unwrap());
        assert_eq!(problems(&schema, &less), [format!(": {field} is missing")]);
    }
}

#[test]
fn every_json_file_begins_with_its_form_and_the_version() {
    let (_root, at) = soils();
    let plan = "[set]\nreplicates = 2\nnetwork = { nx = 6, ny = 6, nz = 8 }\nrecord = { sensitivity = [] }\n\
        [[factor]]\nname = \"cu\"\nsetting = \"base.cu\"\nvalues = [1.5, 2]\n";
    fs::write(at.join("plan.toml"), plan).unwrap();
    let filter = "[filter]\ncu = 1.5\ndensity = \"loose\"\n[packing]\ngrains = 300\nstiffness_ratio = 0.01\n";
    fs::write(at.join("filter.toml"), filter).unwrap();
    let small = |args: &[&'static str]| [args, &SMALL].concat();
    let commands: [(Vec<&str>, &str); 13] = [
        (small(&["judge", "base.csv", "fine.csv", "--quick", "--json"]), "outcome"),
        (small(&["run", "--set", "replicates=2", "--set", "record.sensitivity=[]", "--json"]), "outcome"),
        (small(&["judge", "base.csv", "fine.csv", "coarse.csv", "--quick", "--json"]), "batch"),
        (small(&["check", "--json"]), "check"),
        (
            small(&["boundary", "base.csv", "--filter", "cu1.5-loose", "--set", "replicates=2", "--json"]),
            "boundary",
        ),
        (vec!["rules", "base.csv", "fine.csv", "--json"], "rules"),
        (vec!["soil", "base.csv", "--json"], "soils"),
        (vec!["init", "--json"], "settings"),
        (vec!["percolation", "--sizes", "4,6", "--realisations", "3", "--json"], "percolation"),
        (vec!["pack", "filter.toml", "--out", "packing", "--json"], "packing"),
        (vec!["constrictions", "packing/grains.csv", "--json"], "constrictions"),
        (vec!["check", "plan.toml", "--json"], "plan-check"),
        (vec!["campaign", "plan.toml"], ""),
    ];
    for (args, form) in commands {
        let output = call(&at, &args);
        assert!(output.status.success(), "{args:?}: {}", text(&output.stderr));
        if !form.is_empty() {
            let expected = (format!("voidwalk-{form}/1"), env!("CARGO_PKG_VERSION").to_owned());
            assert_eq!(beginning(&text(&output.stdout)), expected, "{args:?}");
            keeps_to_its_schema(&text(&output.stdout));
        }
    }
    let texts: Vec<String> = json_files(&at).iter().map(|file| fs::read_to_string(file).unwrap()).collect();
    texts.iter().for_each(|text| keeps_to_its_schema(text));
    let forms: BTreeSet<String> = texts.iter().map(|text| beginning(text).0).collect();
    let expected = ["batch", "boundary", "campaign", "case", "constrictions", "manifest", "outcome"];
    let expected = expected.iter().chain(&["packing", "percolation"]);
    assert_eq!(forms, expected.map(|form| format!("voidwalk-{form}/1")).collect());
    // What is printed is what the file says.
    let printed = call(&at, &["constrictions", "packing/grains.csv", "--overwrite", "--json"]).stdout;
    assert_eq!(fs::read(at.join("voidwalk-constrictions/constrictions.json")).unwrap(), printed);
}

#[test]
fn files_without_a_beginning_or_in_another_form_are_refused() {
    let (_root, at) = soils();
    done(&call(&at, &[&["judge", "base.csv", "fine.csv", "--quick", "--out", "a"][..], &SMALL].concat()));
    let file = at.join("a/outcome.json");
    let whole = fs::read_to_string(&file).unwrap();
    let report = |content: &str| {
        fs::write(&file, content).unwrap();
        ended(&call(&at, &["report", "a"]))
    };
    let mut bare: Value = serde_json::from_str(&whole).unwrap();
    bare.as_object_mut().unwrap().retain(|name, _| !["format", "voidwalk"].contains(&name.as_str()));
    let (code, said) = report(&bare.to_string());
    assert!(code == 2 && said.contains("does not begin with the name and number of its format"), "{said}");
    let version = format!("\"voidwalk\": \"{}\"", env!("CARGO_PKG_VERSION"));
    for number in ["0", "2"] {
        let form = format!("voidwalk-outcome/{number}");
        let other = whole.replace("voidwalk-outcome/1", &form).replace(&version, "\"voidwalk\": \"7.0.0\"");
        let (code, said) = report(&other);
        assert!(code == 2 && said.contains(&format!("{form} of voidwalk 7.0.0")), "{said}");
    }
}

/// Exit code and what is said on stderr.
fn ended(output: &Output) -> (i32, String) {
    (output.status.code().unwrap(), text(&output.stderr))
}

#[test]
fn a_verdict_that_is_not_accepted_ends_with_code_4_and_the_same_output() {
    let (_root, at) = soils();
    let run = |more: &[&str]| {
        let args = ["run", "-q", "--overwrite", "--out", "r", "--set", "replicates=3"];
        call(&at, &[&args[..], &["--set", "record.sensitivity=[]"], &SMALL, more].concat())
    };
    // The built-in base erodes continuously, one at Dc90 is held, and a run alone leaves a verdict open.
    let cases: [(&[&str], &str, [i32; 2]); 3] = [
        (&[], "continuing erosion", [4, 4]),
        (&["--set", "base.d85_at_dc=90"], "no erosion", [0, 0]),
        (&["--set", "runs=1"], "undecided", [4, 4]),
    ];
    for (more, verdict, codes) in cases {
        for (word, code) in ["some", "continuing"].into_iter().zip(codes) {
            let output = run(&[more, &["--fail-on", word, "--json"]].concat());
            let (found, said) = ended(&output);
            assert_eq!(found, code, "{more:?} {word}: {said}");
            let outcome = fs::read_to_string(at.join("r/outcome.json")).unwrap();
            assert_eq!(text(&output.stdout), outcome, "stdout is what it was without --fail-on");
            let record: Value = serde_json::from_str(&outcome).unwrap();
            assert_eq!(record["model"]["class"], verdict);
            let is_named = said.contains("not accepted: ") && said.contains(&format!("--fail-on {word}; "));
            assert_eq!(is_named, code == 4, "{said}");
        }
        assert_eq!(ended(&run(&[more, &["--json"]].concat())).0, 0);
    }
    let wrong = run(&["--fail-on", "none"]);
    refused(&wrong, "some, continuing");
}

#[test]
fn judge_names_the_pairs_that_are_not_accepted() {
    let (_root, at) = soils();
    let judge = ["judge", "base.csv", "coarse.csv", "--quick", "-q", "--out", "a", "--fail-on", "some"];
    let (code, said) = ended(&call(&at, &[&judge[..], &SMALL].concat()));
    assert!(code == 4 && said.contains("not accepted: ") && at.join("a/report.html").is_file(), "{said}");
    // A finished folder is refused, whatever its verdict.
    assert_eq!(ended(&call(&at, &[&judge[..], &SMALL].concat())).0, 2);
    let filters = ["judge", "base.csv", "fine.csv", "coarse.csv", "--quick", "-q", "--out", "c"];
    let (code, said) = ended(&call(&at, &[&filters[..], &["--fail-on", "some"], &SMALL].concat()));
    assert!(code == 4 && said.contains("coarse.csv: "), "{said}");
    assert!(at.join("c/batch.html").is_file());
    for command in ["judge", "run", "resume"] {
        let help = text(&call(&at, &[command, "--help"]).stdout);
        assert!(help.contains("--fail-on <VERDICT>") && help.contains("Undecided counts as bad"), "{help}");
    }
}

#[test]
fn help_and_manual_pages_list_every_exit_code() {
    let root = tempfile::tempdir().unwrap();
    let help = text(&call(root.path(), &["--help"]).stdout);
    assert!(help.contains("Exit codes:\n  0  done\n  1  failed"), "{help}");
    done(&call(root.path(), &["man", "pages"]));
    for page in ["voidwalk", "voidwalk-judge"] {
        let page = fs::read_to_string(root.path().join(format!("pages/{page}.1"))).unwrap();
        let codes = page.split(".SH \"EXIT STATUS\"").nth(1).unwrap_or_else(|| panic!("{page}"));
        for code in ["0", "1", "2", "3", "4"] {
            assert!(codes.contains(&format!(".TP\n\\fB{code}\\fR\n")), "{codes}");
        }
        assert!(!page.contains("Exit codes:"), "they are listed once");
    }
}

/// The outcome of a folder.
fn outcome(folder: &Path) -> Value {
    serde_json::from_slice(&fs::read(folder.join("outcome.json")).unwrap()).unwrap()
}

#[test]
fn a_scene_has_one_digest_on_any_threads_from_any_folder_and_another_with_another_seed() {
    let (_root, at) = soils();
    let judge = ["judge", "base.csv", "fine.csv", "--quick", "-q", "--threads", "1", "--out", "j"];
    done(&call(&at, &[&judge[..], &SMALL].concat()));
    let first = outcome(&at.join("j"));
    // Neither the tables nor the place where it was walked is needed.
    fs::remove_file(at.join("base.csv")).unwrap();
    fs::rename(at.join("j"), at.join("moved")).unwrap();
    let again = |more: &[&str]| {
        let run = ["run", "moved/scene.toml", "-q", "--out", "again", "--overwrite"];
        done(&call(&at, &[&run[..], more].concat()));
        outcome(&at.join("again"))
    };
    let three = again(&["--threads", "3"]);
    assert_eq!(first["digest"], three["digest"]);
    assert_ne!(first["seconds"], three["seconds"]);
    let digest = first["digest"].as_str().unwrap();
    assert!(digest.len() == 32 && digest.chars().all(|c| "0123456789abcdef".contains(c)), "{digest}");
    assert_ne!(first["digest"], again(&["--set", "seed=2"])["digest"]);
}

/// The places of all values of JSON that are neither text nor made of others.
fn places(place: &str, value: &Value, all: &mut Vec<String>) {
    match value {
        Value::Object(fields) => {
            fields.iter().for_each(|(name, value)| places(&format!("{place}/{name}"), value, all));
        }
        Value::Array(items) => {
            items.iter().enumerate().for_each(|(at, item)| places(&format!("{place}/{at}"), item, all));
        }
        Value::String(_) => {}
        Value::Null | Value::Bool(_) | Value::Number(_) => all.push(place.to_owned()),
    }
}

#[test]
fn every_number_of_an_outcome_but_wall_time_changes_its_digest() {
    let (_root, at) = soils();
    let run = ["run", "-q", "--out", "r", "--set", "replicates=2", "--set", "record.sensitivity=[2.0]"];
    done(&call(&at, &[&run[..], &SMALL].concat()));
    let whole = outcome(&at.join("r"));
    let digest = whole["digest"].as_str().unwrap();
    assert_eq!(voidwalk::outcome::record::digest(&whole).unwrap(), digest, "of what is written");
    let mut all = Vec::new();
    places("", &whole, &mut all);
    assert!(all.len() > 200, "{}", all.len());
    for place in all {
        let mut changed = whole.clone();
        let value = changed.pointer_mut(&place).unwrap();
        *value = match (value.as_u64(), value.as_f64()) {
            (Some(number), _) => (number + 1).into(),
            (None, Some(number)) => number.next_up().into(),
            (None, None) => value.as_bool().map_or(0.into(), |is| (!is).into()),
        };
        let is_same = voidwalk::outcome::record::digest(&changed).unwrap() == digest;
        assert_eq!(is_same, place.ends_with("/seconds") || place == "/studies_to_come", "{place}");
    }
}
