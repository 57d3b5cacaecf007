//! What scripts rely on: how JSON begins, `--fail-on`, and `reproduce`.

use std::collections::BTreeSet;
use std::fs;
use std::path::Path;
use std::process::Output;

use serde_json::Value;

use crate::judge::{SMALL, soils};
use crate::program::{call, done, refused, voidwalk};
use crate::schemas::{beginning, json_files, keep_to_schema, problems, schema_of};

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
    let commands: [(Vec<&str>, &str); 14] = [
        (small(&["judge", "base.csv", "fine.csv", "--quick", "--json"]), "outcome"),
        (small(&["run", "--set", "replicates=2", "--set", "record.sensitivity=[]", "--json"]), "outcome"),
        (
            small(&["compare", "--base", "base.csv", "fine.csv", "coarse.csv", "--quick", "--json"]),
            "comparison",
        ),
        (small(&["check", "--json"]), "check"),
        (
            small(&["design", "base.csv", "--filter", "cu1.5-loose", "--set", "replicates=2", "--json"]),
            "design",
        ),
        (vec!["rules", "base.csv", "fine.csv", "--json"], "rules"),
        (vec!["soil", "base.csv", "--json"], "soils"),
        (vec!["init", "--json"], "settings"),
        (vec!["percolation", "--sizes", "4,6", "--realisations", "3", "--json"], "percolation"),
        (vec!["pack", "filter.toml", "--out", "packing", "--json"], "packing"),
        (vec!["constrictions", "packing/grains.csv", "--json"], "constrictions"),
        (vec!["reproduce", "voidwalk-run", "--json"], "reproduced"),
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
    let expected = ["campaign", "case", "comparison", "constrictions", "design", "manifest", "outcome"];
    let expected = expected.iter().chain(&["packing", "percolation"]);
    assert_eq!(forms, expected.map(|form| format!("voidwalk-{form}/1")).collect());
    // What is printed is what the file says.
    let printed = call(&at, &["constrictions", "packing/grains.csv", "--overwrite", "--json"]).stdout;
    assert_eq!(fs::read(at.join("voidwalk-constrictions/constrictions.json")).unwrap(), printed);
}

#[test]
fn files_without_a_beginning_are_read_and_newer_ones_refused() {
    let (_root, at) = soils();
    done(&call(&at, &[&["judge", "base.csv", "fine.csv", "--quick", "--out", "a"][..], &SMALL].concat()));
    let file = at.join("a/outcome.json");
    let whole = fs::read_to_string(&file).unwrap();
    let page = || fs::read_to_string(at.join("a/report.html")).unwrap();
    let before = page();
    let mut earlier: Value = serde_json::from_str(&whole).unwrap();
    earlier.as_object_mut().unwrap().retain(|name, _| !["format", "voidwalk"].contains(&name.as_str()));
    fs::write(&file, earlier.to_string()).unwrap();
    done(&call(&at, &["report", "a"]));
    assert_eq!(page(), before);
    let version = format!("\"voidwalk\": \"{}\"", env!("CARGO_PKG_VERSION"));
    let newer = whole
        .replace("voidwalk-outcome/1", "voidwalk-outcome/2")
        .replace(&version, "\"voidwalk\": \"7.0.0\"");
    fs::write(&file, newer).unwrap();
    let output = call(&at, &["report", "a"]);
    let said = text(&output.stderr);
    assert!(!output.status.success() && said.contains("voidwalk-outcome/2 of voidwalk 7.0.0"), "{said}");
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
    let cases: [(&[&str], &str, [i32; 3]); 3] = [
        (&[], "continuing erosion", [4, 4, 4]),
        (&["--set", "base.d85_at_dc=90"], "no erosion", [0, 0, 4]),
        (&["--set", "runs=1"], "undecided", [4, 4, 4]),
    ];
    for (more, verdict, codes) in cases {
        for (word, code) in ["some", "continuing", "doubt"].into_iter().zip(codes) {
            let output = run(&[more, &["--fail-on", word, "--json"]].concat());
            let (found, said) = ended(&output);
            assert_eq!(found, code, "{more:?} {word}: {said}");
            let outcome = fs::read_to_string(at.join("r/outcome.json")).unwrap();
            assert_eq!(text(&output.stdout), outcome, "stdout is what it was without --fail-on");
            let record: Value = serde_json::from_str(&outcome).unwrap();
            assert_eq!(record["verdict"], verdict);
            let confidence = record["confidence"].as_str().unwrap();
            let expected = format!("not accepted: {verdict} ({confidence}), with --fail-on {word}; ");
            assert_eq!(said.contains(&expected), code == 4, "{said}");
        }
        assert_eq!(ended(&run(&[more, &["--json"]].concat())).0, 0);
    }
    let wrong = run(&["--fail-on", "none"]);
    refused(&wrong, "some, continuing, doubt");
}

#[test]
fn judge_and_compare_name_the_cases_that_are_not_accepted() {
    let (_root, at) = soils();
    let judge = ["judge", "base.csv", "coarse.csv", "--quick", "-q", "--out", "a", "--fail-on", "doubt"];
    let (code, said) = ended(&call(&at, &[&judge[..], &SMALL].concat()));
    assert!(code == 4 && said.contains("not accepted: ") && at.join("a/report.html").is_file(), "{said}");
    // A finished folder is refused, whatever its verdict.
    assert_eq!(ended(&call(&at, &[&judge[..], &SMALL].concat())).0, 2);
    let compare = ["compare", "--base", "base.csv", "fine.csv", "coarse.csv", "--quick", "-q", "--out", "c"];
    let (code, said) = ended(&call(&at, &[&compare[..], &["--fail-on", "doubt"], &SMALL].concat()));
    assert!(code == 4 && said.contains("fine: ") && said.contains("; coarse: "), "{said}");
    assert!(at.join("c/compare.html").is_file());
    for command in ["judge", "run", "resume", "compare"] {
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

/// The names in a folder.
fn names(folder: &Path) -> BTreeSet<String> {
    fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().file_name().into_string().unwrap()).collect()
}

#[test]
fn runs_are_reproduced_and_every_difference_is_named() {
    let (_root, at) = soils();
    let judge = ["judge", "base.csv", "fine.csv", "--quick", "-q", "--threads", "1", "--out", "j"];
    done(&call(&at, &[&judge[..], &SMALL].concat()));
    let voids =
        ["run", "-q", "--threads", "2", "--set", "replicates=2", "--set", "record.voids=[3]", "--out", "r"];
    done(&call(&at, &[&voids[..], &["--set", "record.sensitivity=[2.0]"], &SMALL].concat()));
    // Neither the tables nor the place where it was walked is needed.
    fs::remove_file(at.join("base.csv")).unwrap();
    fs::rename(at.join("j"), at.join("moved")).unwrap();
    let before = names(&at);
    let files = |folder: &str| -> Vec<(String, Vec<u8>)> {
        let inside = |name: String| Some((name.clone(), fs::read(at.join(folder).join(&name)).ok()?));
        names(&at.join(folder)).into_iter().filter_map(inside).collect()
    };
    let kept = [files("moved"), files("r")];
    for folder in ["moved", "r"] {
        let output = call(&at, &["reproduce", folder, "--threads", "2"]);
        assert_eq!(ended(&output).0, 0, "{}{}", text(&output.stdout), text(&output.stderr));
        let said = text(&output.stdout);
        assert!(said.starts_with("The same: ") && said.contains(" values in "), "{said}");
    }
    assert!([files("moved"), files("r")] == kept, "the folders stay as they are");
    assert_eq!(names(&at), before, "nothing is left beside them");

    // A number of the outcome, a cell, a verdict, an input and a whole file.
    let change = |name: &str, from: &str, to: &str| {
        let file = at.join("r").join(name);
        let text = fs::read_to_string(&file).unwrap();
        assert!(text.contains(from), "{name}: {from}");
        fs::write(&file, text.replacen(from, to, 1)).unwrap();
    };
    let mut outcome: Value = serde_json::from_slice(&fs::read(at.join("r/outcome.json")).unwrap()).unwrap();
    let mean = outcome["summary"][0]["eroded_mass_fraction"]["mean"].as_f64().unwrap();
    outcome["summary"][0]["eroded_mass_fraction"]["mean"] = mean.next_up().into();
    outcome["verdict"] = "no erosion".into();
    outcome["seconds"] = 1e9.into();
    outcome["reasons"][0] = "worded anew".into();
    fs::write(at.join("r/outcome.json"), outcome.to_string()).unwrap();
    change("layers.csv", "\n1,1,", "\n1,9,");
    change("manifest.json", "\"seed\": 1", "\"seed\": 2");
    fs::remove_file(at.join("r/eroded.csv")).unwrap();
    let output = call(&at, &["reproduce", "r", "--json", "-q"]);
    let (code, said) = ended(&output);
    assert!(code == 1 && said.contains("\nerror: not the same: 5 of "), "{said}");
    let found: Value = serde_json::from_slice(&output.stdout).unwrap();
    assert_eq!((&found["same"], &found["different"]), (&false.into(), &5.into()));
    let places: Vec<String> = found["differences"]
        .as_array()
        .unwrap()
        .iter()
        .map(|of| format!("{} {}", of["file"].as_str().unwrap(), of["place"].as_str().unwrap()))
        .collect();
    assert_eq!(
        places,
        [
            "outcome.json verdict",
            "outcome.json summary[0].eroded_mass_fraction.mean",
            "manifest.json seed",
            "eroded.csv ",
            "layers.csv line 2, run",
        ]
    );
    let words = text(&call(&at, &["reproduce", "r"]).stdout);
    assert!(words.contains(&format!("mean: {:?}; {mean:?}\n", mean.next_up())), "{words}");
    assert!(words.contains("eroded.csv: no such file; the file\n"), "{words}");
}

#[test]
fn what_is_no_finished_run_is_not_reproduced() {
    let (_root, at) = soils();
    let reproduce = |folder: &str| call(&at, &["reproduce", folder]);
    refused(&reproduce("nosuch"), "nosuch: holds no outcome.json; name the folder of a finished run");
    refused(&reproduce("."), "holds no outcome.json");
    done(&call(&at, &["percolation", "-q", "--sizes", "4,6", "--realisations", "3", "--out", "p"]));
    refused(&reproduce("p"), "p: holds a percolation study, which is not reproduced");
    let compare = ["compare", "--base", "base.csv", "fine.csv", "coarse.csv", "--quick", "-q", "--out", "c"];
    done(&call(&at, &[&compare[..], &SMALL].concat()));
    refused(&reproduce("c"), "c: holds several cases; name the folder of one of them");
    done(&reproduce("c/walks/cases/fine"));
    fs::write(at.join("c/walks/cases/fine/.voidwalk.unfinished"), "{}").unwrap();
    refused(&reproduce("c/walks/cases/fine"), "this run is not finished; continue it with voidwalk resume");
    let mut stopped = voidwalk(&at, &["reproduce", "c/walks/cases/coarse"]);
    let beside = names(&at.join("c/walks/cases"));
    let stopped = stopped.spawn().unwrap();
    // A signal before it listens ends it; both leave nothing but, at worst, the temporary folder.
    rustix::process::kill_process(rustix::process::Pid::from_child(&stopped), rustix::process::Signal::TERM)
        .unwrap();
    let output = stopped.wait_with_output().unwrap();
    if output.status.code() == Some(3) {
        assert!(text(&output.stderr).contains("nothing of it is kept"), "{}", text(&output.stderr));
        assert_eq!(names(&at.join("c/walks/cases")), beside);
    }
}
