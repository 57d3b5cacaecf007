//! Scenes and folders that are refused, and names that do no harm.

use std::fs;
use std::process::{Command, Stdio};

use serde_json::Value;

use super::small_run::{SMALL, refused, run_small, voidwalk};

#[test]
fn bad_scenes_are_refused_and_leave_nothing() {
    let root = tempfile::tempdir().unwrap();
    let out = root.path().join("out");
    let file = |name: &str, text: &str| {
        let path = root.path().join(name);
        fs::write(&path, text).unwrap();
        path.to_str().unwrap().to_string()
    };
    let typo = file("typo.toml", "[filter]\ncurve = \"shire2016-cu1.5-loose\"\n[base]\nd85_at_cd = 5\n");
    let unit = file("unit.toml", "[filter]\ncurve = \"shire2016-cu1.5-loose\"\n[base]\nd85_cm = 5\ncu = 3\n");
    let sieve = file("s.csv", "opening_mm,percent_finer\n0.1,0\n0.2,nan\n");
    let fine = file("fine.toml", "[filter]\ncurve = \"shire2016-cu1.5-loose\"\n[base]\nsieve = \"s.csv\"\n");
    let _ = sieve;
    for (scene, set, messages) in [
        (typo.as_str(), "seed=1", &["typo.toml, line 4", "`base.d85_at_cd`", "`base.d85_at_dc`"][..]),
        (unit.as_str(), "seed=1", &["unit.toml, line 4", "did you mean `base.d85_mm`"]),
        (fine.as_str(), "seed=1", &["s.csv", "3", "nan"]),
        (root.path().to_str().unwrap(), "seed=1", &[": is a folder; allowed: a file of at most 1 MB"]),
        ("/no/such/scene.toml", "seed=1", &["/no/such/scene.toml"]),
        ("", "base.n_base=0", &["--set, base.n_base: `0` is not allowed", "whole number from 1"]),
        ("", "base.mass_ratio=1e-12", &["less than half a base particle"]),
        ("", "filter.curve=shire2016-cu15-loose", &["nearest is \"shire2016-cu1.5-loose\""]),
        ("", "network.nx=1e9", &["every length must be at least 1"]),
        ("", "base.n_base=1e12", &["1000000000000 base particles walked one by one", "available"]),
        ("", "network.file=/no/such.csv", &["/no/such.csv"]),
    ] {
        let mut args = vec!["run"];
        if !scene.is_empty() {
            args.push(scene);
        }
        args.extend(["--out", out.to_str().unwrap(), "--set", set, "--set", "engine=particles"]);
        refused(&voidwalk(&args), messages);
        assert!(!out.exists(), "{set}: something was written");
    }
}

#[test]
fn folders_that_are_not_ours_or_finished_are_left_alone() {
    let root = tempfile::tempdir().unwrap();
    fs::write(root.path().join("thesis.txt"), "years").unwrap();
    refused(&run_small(root.path(), &[]), &["was not made by voidwalk"]);
    let folder = root.path().join("run");
    assert!(run_small(&folder, &["--quiet"]).status.success());
    let before = fs::read(folder.join("outcome.json")).unwrap();
    refused(&run_small(&folder, &["--seed", "9"]), &["--overwrite"]);
    assert_eq!(fs::read(folder.join("outcome.json")).unwrap(), before);
    assert!(run_small(&folder, &["--seed", "9", "--overwrite"]).status.success());
    assert_ne!(fs::read(folder.join("outcome.json")).unwrap(), before);
    refused(&voidwalk(&["report", root.path().to_str().unwrap()]), &["holds no outcome.json"]);
}

#[test]
fn hostile_names_are_inert() {
    let root = tempfile::tempdir().unwrap();
    let name = "<script>alert(1)<_script>\u{1b}[31m.csv";
    fs::write(root.path().join(name), "opening_mm,percent_finer\n0.1,0\n0.25,100\n").unwrap();
    let folder = root.path().join("run");
    let set = format!("base.sieve={}", root.path().join(name).display());
    let output = run_small(&folder, &["--set", &set]);
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    let page = fs::read_to_string(folder.join("report.html")).unwrap();
    assert!(!page.contains("<script>") && page.contains("&lt;script&gt;"));
    assert!(!String::from_utf8_lossy(&output.stdout).contains('\u{1b}'));
}

#[test]
fn a_closed_pipe_is_no_panic() {
    for args in [&["init"][..], &["check"]] {
        let mut child = Command::new(env!("CARGO_BIN_EXE_voidwalk"))
            .args(args)
            .stdout(Stdio::piped())
            .stderr(Stdio::piped())
            .spawn()
            .unwrap();
        drop(child.stdout.take());
        let output = child.wait_with_output().unwrap();
        assert!(output.status.success());
        assert!(!String::from_utf8_lossy(&output.stderr).contains("panicked"));
    }
}

/// Inputs that a first reader of this program found to slip through.
#[test]
fn what_once_slipped_through_is_refused() {
    let root = tempfile::tempdir().unwrap();
    let out = root.path().join("out");
    for (more, message) in [
        (
            vec!["--set", "base.sieve=/dev/null"],
            "is a pipe, a device or a socket; allowed: a regular file of at most 16 MB",
        ),
        (vec!["--set", "inject_share=1e-12"], "whole number of equal parts"),
        (
            vec![
                "--set",
                "network.nx=1e9",
                "--set",
                "network.ny=1",
                "--set",
                "network.nz=1",
                "--set",
                "base.n_base=10",
            ],
            "available",
        ),
    ] {
        let mut args = vec!["run", "--out", out.to_str().unwrap()];
        args.extend(more);
        refused(&voidwalk(&args), &[message]);
        assert!(!out.exists());
    }
    // A network in mm does not become scale-free, and grains per void that nobody gave are not invented.
    let network = root.path().join("net.csv");
    fs::write(&network, "from,to,diameter_mm\nstart,0,\n0,end,2\n").unwrap();
    let set = format!("network.file={}", network.display());
    let check = ["check", "--json", "--set", &set, "--set", "base.single_mm=1", "--set", "base.n_base=10"];
    let json: Value = serde_json::from_slice(&voidwalk(&check).stdout).unwrap();
    assert_eq!((&json["inputs"]["scale_free"], &json["grains_per_void"]), (&false.into(), &Value::Null));
    // Another filter's curve is said to be one.
    let json: Value =
        serde_json::from_slice(&voidwalk(&["check", "--json", "--set", "filter.cu=3"]).stdout).unwrap();
    assert!(json["notes"][0]["id"] == "other_curve");
}

/// Without --out the first free folder is taken; one that a stopped run left empty is free.
#[test]
fn unnamed_runs_do_not_overwrite_each_other() {
    let root = tempfile::tempdir().unwrap();
    fs::create_dir(root.path().join("voidwalk-run-2")).unwrap();
    fs::write(root.path().join("voidwalk-run-2/.voidwalk.lock"), "").unwrap();
    for (expected, missing) in [("voidwalk-run", "voidwalk-run-2"), ("voidwalk-run-2", "voidwalk-run-3")] {
        let mut command = Command::new(env!("CARGO_BIN_EXE_voidwalk"));
        command.current_dir(root.path()).args(["run", "--quiet"]);
        for set in SMALL {
            command.args(["--set", set]);
        }
        assert!(command.status().unwrap().success());
        assert!(root.path().join(expected).join("outcome.json").is_file());
        assert!(!root.path().join(missing).join("outcome.json").exists());
    }
}

/// Each command that writes a folder leaves those of the others alone, finished or not, with --overwrite and without.
#[test]
fn no_command_writes_into_a_folder_of_another_kind() {
    let root = tempfile::tempdir().unwrap();
    let at = root.path();
    let write = |name: &str, text: &str| fs::write(at.join(name), text).unwrap();
    write("filter.toml", "[filter]\ncu = 1.5\ndensity = \"loose\"\n[packing]\ngrains = 600\n");
    write("plan.toml", "[[case]]\nname = \"one\"\n");
    let mut grains = String::from("# cell_mm = 3, 3, 3\nx_mm,y_mm,z_mm,diameter_mm\n");
    for i in 0..27 {
        // Not quite a lattice.
        grains += &format!("{}.5{},{}.5{},{}.5,0.9\n", i % 3, 37 * i % 11, i / 3 % 3, 17 * i % 7, i / 9);
    }
    write("grains.csv", &grains);
    let commands: [(&str, &[&str]); 6] = [
        ("run", &["run"]),
        ("packing", &["pack", "filter.toml"]),
        ("campaign", &["campaign", "plan.toml"]),
        ("percolation study", &["percolation", "--sizes", "4", "--realisations", "2"]),
        ("study of boundaries", &["boundary"]),
        ("set of constrictions", &["constrictions", "grains.csv"]),
    ];
    let marks = [
        ("run", "outcome.json"),
        ("run", "checkpoint"),
        ("packing", "packing.json"),
        ("packing", "compression.0"),
        ("campaign", "cases"),
        ("percolation study", "percolation.json"),
        ("study of boundaries", "boundary.json"),
        ("study of boundaries", "networks.1"),
        ("set of constrictions", "constrictions.json"),
    ];
    for (held, mark) in marks {
        let folder = at.join(format!("with {mark}"));
        fs::create_dir(&folder).unwrap();
        fs::write(folder.join(".voidwalk.lock"), "").unwrap();
        fs::write(folder.join(mark), "theirs").unwrap();
        for (kind, command) in commands {
            if kind == held || (kind == "packing" && held == "set of constrictions") {
                continue;
            }
            for overwrite in [false, true].iter().filter(|overwrite| kind != "campaign" || !**overwrite) {
                let mut args = command.to_vec();
                args.extend(["--out", folder.to_str().unwrap()]);
                args.extend(overwrite.then_some("--overwrite"));
                let output = Command::new(env!("CARGO_BIN_EXE_voidwalk"))
                    .current_dir(at)
                    .args(&args)
                    .output()
                    .unwrap();
                refused(&output, &[&format!("holds a {held}; name another folder")]);
            }
        }
        assert_eq!(fs::read_to_string(folder.join(mark)).unwrap(), "theirs");
        assert_eq!(fs::read_dir(&folder).unwrap().count(), 2, "something was written beside {mark}");
    }
}
