//! The program as a user meets it: exit codes, messages, and what a run folder holds.

use std::fs;
use std::path::Path;
use std::process::{Command, Output, Stdio};

use serde_json::Value;
use voidwalk::run::FolderKind;

use super::program::figures_are_listed;

/// A run of seconds: a small network, few replicates.
const SMALL: [&str; 5] =
    ["network.nx=8", "network.ny=8", "network.nz=10", "replicates=3", "record.sensitivity=[2.0]"];

fn voidwalk(args: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_voidwalk")).args(args).output().unwrap()
}

fn run_small(out: &Path, more: &[&str]) -> Output {
    let out = out.to_str().unwrap();
    let mut args = vec!["run", "--out", out];
    for set in SMALL {
        args.extend(["--set", set]);
    }
    args.extend(more);
    voidwalk(&args)
}

fn outcome(folder: &Path) -> Value {
    serde_json::from_str(&fs::read_to_string(folder.join("outcome.json")).unwrap()).unwrap()
}

/// The outcome without what a clock says.
fn without_seconds(mut value: Value) -> Value {
    fn strip(value: &mut Value) {
        match value {
            Value::Object(map) => {
                map.remove("seconds");
                map.values_mut().for_each(strip);
            }
            Value::Array(items) => items.iter_mut().for_each(strip),
            _ => {}
        }
    }
    strip(&mut value);
    value
}

fn refused(output: &Output, messages: &[&str]) {
    let stderr = String::from_utf8_lossy(&output.stderr);
    assert_eq!(output.status.code(), Some(2), "{stderr}");
    for message in messages {
        assert!(stderr.contains(message), "{stderr:?} lacks {message:?}");
    }
}

#[test]
fn a_run_folder_holds_what_is_promised() {
    let root = tempfile::tempdir().unwrap();
    let folder = root.path().join("run");
    let output = run_small(&folder, &[]);
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    let stdout = String::from_utf8_lossy(&output.stdout);
    assert!(
        stdout.starts_with("Verdict: ") && stdout.contains("The model leaves out: hydraulics"),
        "{stdout}"
    );
    let outcome = outcome(&folder);
    for key in [
        "verdict",
        "seed",
        "n_base",
        "n_base_eq2",
        "capped",
        "grains_per_void",
        "engine",
        "replicates",
        "summary",
    ] {
        assert!(!outcome[key].is_null(), "{key}");
    }
    let replicates = outcome["replicates"].as_array().unwrap();
    assert_eq!(replicates.len(), 3);
    for replicate in replicates {
        let runs = replicate["runs"].as_array().unwrap();
        assert_eq!(runs.len(), 2);
        for run in runs {
            for key in [
                "eroded_mass_fraction",
                "eroded_number_fraction",
                "largest_eroded_mm",
                "largest_eroded_over_d15f",
                "blocked",
                "blocked_fraction",
                "blocked_first_three_layers_fraction",
                "backbone_fraction",
                "inserted",
                "eroded",
                "retained_in_constrictions",
                "retained_in_voids",
                "trapped",
                "increments",
                "particle_moves",
                "seconds",
            ] {
                assert!(run.get(key).is_some(), "{key}");
            }
            let n = |key: &str| run[key].as_u64().unwrap();
            assert_eq!(n("inserted"), outcome["n_base"].as_u64().unwrap());
            assert_eq!(
                n("inserted"),
                n("eroded") + n("retained_in_constrictions") + n("retained_in_voids") + n("trapped")
            );
        }
        assert!(runs[1]["blocked"].as_u64() >= runs[0]["blocked"].as_u64());
    }
    for run in outcome["summary"].as_array().unwrap() {
        let eroded = &run["eroded_mass_fraction"];
        assert!(
            eroded["low"].as_f64() <= eroded["mean"].as_f64()
                && eroded["mean"].as_f64() <= eroded["high"].as_f64()
        );
    }
    let header =
        |file: &str| fs::read_to_string(folder.join(file)).unwrap().lines().next().unwrap().to_string();
    assert_eq!(
        header("series.csv"),
        "replicate,run,increment,inserted,moving,eroded,retained_in_constrictions,retained_in_voids,trapped,blocked,eroded_mass_fraction"
    );
    assert_eq!(
        header("layers.csv"),
        "replicate,run,layer,constrictions,blocked,retained_in_constrictions,retained_in_voids"
    );
    for file in ["retained.csv", "eroded.csv"] {
        assert_eq!(
            header(file),
            "replicate,run,increment,diameter_mm,percent_finer_by_mass,percent_finer_by_number"
        );
    }
    let page = fs::read_to_string(folder.join("report.html")).unwrap();
    assert!(page.contains("Content-Security-Policy") && page.contains("hydraulics"));
    assert!(fs::read_dir(folder.join("figures")).unwrap().count() >= 5);
    for key in ["version", "seed", "inputs", "threads", "host", "started", "finished"] {
        let manifest: Value =
            serde_json::from_str(&fs::read_to_string(folder.join("manifest.json")).unwrap()).unwrap();
        assert!(!manifest[key].is_null(), "{key}");
    }
}

#[test]
fn the_same_seed_gives_the_same_bits_for_any_threads_and_from_the_resolved_scene() {
    let root = tempfile::tempdir().unwrap();
    let first = root.path().join("a");
    assert!(run_small(&first, &["--threads", "1", "--seed", "5"]).status.success());
    let scene = first.join("scene.toml");
    for (name, threads) in [("b", "2"), ("c", "3"), ("d", "8")] {
        let folder = root.path().join(name);
        let args = ["run", scene.to_str().unwrap(), "--threads", threads, "--out", folder.to_str().unwrap()];
        let output = voidwalk(&args);
        assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
        for file in ["series.csv", "layers.csv", "retained.csv", "eroded.csv", "scene.toml"] {
            assert!(fs::read(first.join(file)).unwrap() == fs::read(folder.join(file)).unwrap(), "{file}");
        }
        assert_eq!(without_seconds(outcome(&first)), without_seconds(outcome(&folder)));
    }
    // One replicate's results do not depend on how many there are.
    let fewer = root.path().join("e");
    assert!(run_small(&fewer, &["--seed", "5", "--set", "replicates=2"]).status.success());
    let (three, two) = (without_seconds(outcome(&first)), without_seconds(outcome(&fewer)));
    assert_eq!(three["replicates"][1], two["replicates"][1]);
    let other_seed = root.path().join("f");
    assert!(run_small(&other_seed, &["--seed", "6"]).status.success());
    assert_ne!(
        without_seconds(outcome(&first))["replicates"],
        without_seconds(outcome(&other_seed))["replicates"]
    );
}

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
        (root.path().to_str().unwrap(), "seed=1", &["must be a regular file"]),
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

/// No second run, no sensitivity, no series and no early size curves: what is left is what the whole gives, and both `check` and
/// the outcome say what is left out.
#[test]
fn what_is_left_out_changes_nothing_else() {
    let root = tempfile::tempdir().unwrap();
    let (whole, part) = (root.path().join("whole"), root.path().join("part"));
    assert!(run_small(&whole, &[]).status.success());
    let sets = ["runs=1", "record.sensitivity=[]", "record.series_every=0", "record.size_curves=[]"];
    let less: Vec<&str> = sets.iter().flat_map(|set| ["--set", set]).collect();
    assert!(run_small(&part, &less).status.success());
    let (whole_outcome, part_outcome) = (without_seconds(outcome(&whole)), without_seconds(outcome(&part)));
    for replicate in 0..3 {
        let [a, b] = [&whole_outcome, &part_outcome].map(|outcome| &outcome["replicates"][replicate]);
        assert_eq!((&a["seed"], &a["runs"][0]), (&b["seed"], &b["runs"][0]));
        assert!(a["runs"][1].is_object() && b["runs"][1].is_null());
    }
    // The rows that are kept are rows of the whole.
    for file in ["series.csv", "retained.csv", "eroded.csv", "layers.csv"] {
        let [rows, fewer] = [&whole, &part].map(|folder| fs::read_to_string(folder.join(file)).unwrap());
        let rows: std::collections::HashSet<&str> = rows.lines().collect();
        assert!(fewer.lines().count() > 3 && fewer.lines().all(|row| rows.contains(row)), "{file}");
    }
    let mut args = vec!["check", "--json"];
    SMALL.iter().for_each(|set| args.extend(["--set", set]));
    let checked: Value = serde_json::from_slice(&voidwalk(&[&args[..], &less[..]].concat()).stdout).unwrap();
    assert_eq!(checked["left_out"], part_outcome["left_out"]);
    let sentences = checked["left_out"].to_string();
    assert!(sentences.contains("the second run") && sentences.contains("so few that walking"), "{sentences}");
}

/// Replicates are added until the verdict is certain or the error small; where that cannot be, it says what it would take.
#[test]
fn a_run_goes_on_until_its_rule_is_met_or_says_what_it_would_take() {
    let root = tempfile::tempdir().unwrap();
    let folder = |name: &str| root.path().join(name);
    // Coarser constrictions than the base anywhere: clear after the first look.
    let clear = ["--set", "base.d85_at_dc=0", "--decide", "99.9%"];
    assert!(run_small(&folder("clear"), &clear).status.success());
    let clear = outcome(&folder("clear"));
    assert_eq!(
        (&clear["stopping"]["met"], clear["replicates"].as_array().unwrap().len()),
        (&Value::from(true), 8)
    );
    assert_eq!(clear["verdict"], clear["stopping"]["verdict"]);

    let target = ["--set", "record.sensitivity=[]", "--target-error", "1.5pp", "--threads"];
    for threads in ["1", "3"] {
        assert!(run_small(&folder(threads), &[&target[..], &[threads]].concat()).status.success());
    }
    let close = outcome(&folder("1"));
    assert_eq!(without_seconds(close.clone()), without_seconds(outcome(&folder("3"))));
    let count = close["replicates"].as_array().unwrap().len();
    assert!(close["stopping"]["met"] == true && count > 8, "{}", close["stopping"]);
    assert!(close["stopping"]["half_width_pp"].as_f64().unwrap() <= 1.5);
    // The folder's own scene says the same again.
    let scene = folder("1").join("scene.toml");
    let again = folder("again");
    assert!(voidwalk(&["run", scene.to_str().unwrap(), "--out", again.to_str().unwrap()]).status.success());
    assert_eq!(without_seconds(close), without_seconds(outcome(&again)));

    let hopeless = ["--target-error", "0.01pp", "--set", "stop.most_replicates=10"];
    let output = run_small(&folder("hopeless"), &hopeless);
    let text = String::from_utf8_lossy(&output.stdout).into_owned();
    assert!(
        output.status.success() && text.contains("was not reached") && text.contains("would do"),
        "{text}"
    );
    for (flag, value) in [("--target-error", "0.1"), ("--decide", "99.9"), ("--decide", "many%")] {
        refused(&voidwalk(&["run", flag, value]), &["with its unit"]);
    }
    refused(&voidwalk(&["run", "--decide", "100%"]), &["from 50% to 99.999%"]);
}

/// Particles that do not fit the memory that is allowed live in files: `check` says so, and the run gives the same results.
#[test]
fn little_memory_changes_no_result() {
    let root = tempfile::tempdir().unwrap();
    let (plenty, little) = (root.path().join("plenty"), root.path().join("little"));
    let many = ["--set", "engine=particles", "--set", "base.n_base=200000", "--set", "replicates=2"];
    assert!(run_small(&plenty, &many).status.success());
    let output = run_small(&little, &[&many[..], &["--memory", "1MB"]].concat());
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    assert_eq!(without_seconds(outcome(&plenty)), without_seconds(outcome(&little)));
    assert_eq!(fs::read(plenty.join("series.csv")).unwrap(), fs::read(little.join("series.csv")).unwrap());

    let mut args = vec!["check", "--memory", "1MB"];
    SMALL.iter().for_each(|set| args.extend(["--set", set]));
    let output = voidwalk(&[&args[..], &many[..]].concat());
    let text = String::from_utf8_lossy(&output.stdout).into_owned();
    assert!(output.status.success() && text.contains("in files in the run folder"), "{text}");
    // Not even the network fits; no size.
    refused(&voidwalk(&["check", "--memory", "20kB"]), &["available"]);
    assert_eq!(voidwalk(&["check", "--memory", "much"]).status.code(), Some(2));
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
fn init_writes_a_scene_that_check_understands() {
    let root = tempfile::tempdir().unwrap();
    let path = root.path().join("scene.toml");
    assert!(voidwalk(&["init", path.to_str().unwrap()]).status.success());
    refused(&voidwalk(&["init", path.to_str().unwrap()]), &["is there already"]);
    let plan = root.path().join("plan.toml");
    assert!(voidwalk(&["init", "--plan", plan.to_str().unwrap()]).status.success());
    refused(&voidwalk(&["init", "--plan", plan.to_str().unwrap()]), &["is there already"]);
    let output = voidwalk(&["init", "--plan"]);
    assert_eq!(fs::read(&plan).unwrap(), output.stdout);
    let output = voidwalk(&["campaign", plan.to_str().unwrap(), "--list"]);
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    let said = String::from_utf8(output.stdout).unwrap();
    assert!(said.contains("cu_b=3,filter=dense"), "{said}");
    let output = voidwalk(&["check", path.to_str().unwrap(), "--json"]);
    let check: Value = serde_json::from_slice(&output.stdout).unwrap();
    let n_base = check["n_base"].as_u64().unwrap();
    assert_eq!(check["grains_per_void"], 0.61);
    // With 2.5 grains per void Eq. (2) asks for 2.5 / 0.61 as many, and a cap says that it bit.
    let set = [
        "check",
        path.to_str().unwrap(),
        "--json",
        "--set",
        "filter.grains_per_void=2.5",
        "--set",
        "base.cap=5e6",
    ];
    let capped: Value = serde_json::from_slice(&voidwalk(&set).stdout).unwrap();
    assert!((capped["n_base_eq2"].as_f64().unwrap() / n_base as f64 / (2.5 / 0.61) - 1.0).abs() < 1e-6);
    assert_eq!((&capped["n_base"], &capped["capped"]), (&5_000_000.into(), &true.into()));
    assert!(capped["warnings"][0].as_str().unwrap().contains("cap"));
    let words = String::from_utf8(voidwalk(&["check", path.to_str().unwrap()]).stdout).unwrap();
    assert!(words.contains("base particles") && words.contains("memory") && words.contains("left out"));
}

#[test]
fn a_network_from_a_file_is_walked_and_kept() {
    let root = tempfile::tempdir().unwrap();
    let network = root.path().join("net.csv");
    fs::write(&network, "from,to,diameter_mm\nstart,0,\n0,1,0.5\n0,2,0.2\n1,end,0.5\n2,end,0.3\n").unwrap();
    let folder = root.path().join("run");
    let set = format!("network.file={}", network.display());
    let args = [
        "run",
        "--out",
        folder.to_str().unwrap(),
        "--set",
        &set,
        "--set",
        "base.single_mm=0.25",
        "--set",
        "base.n_base=1000",
    ];
    let output = voidwalk(&args);
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    assert!(folder.join("inputs/network.csv").is_file());
    let outcome = outcome(&folder);
    assert_eq!(outcome["inputs"]["network"]["kind"], "file");
    let run = &outcome["replicates"][0]["runs"][0];
    // Void 0 has one exit finer than the particles; everything else leaves.
    assert_eq!(run["blocked"], 1);
    assert_eq!(run["eroded"].as_u64().unwrap() + run["retained_in_constrictions"].as_u64().unwrap(), 1000);
    // Its five ways are nobody's filter.
    assert_ne!(outcome["confidence"], "within checked range");
    assert!(outcome["reasons"].to_string().contains("The network was given, with 3 voids"));
    // One that nothing leaves holds everything.
    for rows in ["start,0,\n0,1,2\n1,0,2\n2,end,3\n2,0,1", "start,0,\n0,1,2", "start,0,\n0,end,0"] {
        let network = root.path().join("noway.csv");
        fs::write(&network, format!("from,to,diameter_mm\n{rows}\n")).unwrap();
        let set = format!("network.file={}", network.display());
        let args = ["check", "--set", &set, "--set", "base.single_mm=0.25", "--set", "base.n_base=10"];
        refused(&voidwalk(&args), &["noway.csv: no open way leads from a start node"]);
    }
    // A ring with ways out so narrow that hardly anything leaves.
    let ring = root.path().join("ring.csv");
    let rows = "start,0,\n0,1,2\n1,2,2\n2,0,2\n0,end,0.05\n";
    fs::write(&ring, format!("from,to,diameter_mm\n{rows}")).unwrap();
    let set = format!("network.file={}", ring.display());
    let base = ["--set", "base.single_mm=0.25", "--set", "base.n_base=1000", "--set", "replicates=2"];
    let out = root.path().join("ring");
    let args = [&["run", "--out", out.to_str().unwrap(), "--set", &set][..], &base].concat();
    assert!(voidwalk(&args).status.success());
    let page = fs::read_to_string(out.join("report.html")).unwrap();
    assert!(page.contains("particles trapped in closed loops; they count as retained."), "no word of them");
    assert!(page.contains("Particles trapped in closed loops could change the class. They are"));
    // The kept scene runs again from its own folder.
    let again = root.path().join("again");
    let scene = folder.join("scene.toml");
    assert!(voidwalk(&["run", scene.to_str().unwrap(), "--out", again.to_str().unwrap()]).status.success());
    assert_eq!(fs::read(folder.join("series.csv")).unwrap(), fs::read(again.join("series.csv")).unwrap());
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
fn init_lists_for_programs_every_setting_that_it_writes() {
    let output = voidwalk(&["init", "--json"]);
    let reference: Value = serde_json::from_slice(&output.stdout).unwrap();
    let sections = reference["sections"].as_array().unwrap();
    let settings: Vec<&Value> = sections.iter().flat_map(|s| s["settings"].as_array().unwrap()).collect();
    let text = String::from_utf8(voidwalk(&["init"]).stdout).unwrap();
    let written = |line: &&str| !line.starts_with("# ") && line.contains(" = ");
    assert_eq!(text.lines().filter(written).count(), settings.len());
    let named = |name: &str| *settings.iter().find(|s| s["name"] == name).unwrap();
    let cu = named("base.cu");
    assert_eq!(
        (&cu["type"], &cu["default"], &cu["built_in"]),
        (&"float".into(), &Value::Null, &"1.5".into())
    );
    let groups = reference["exclusive"].as_array().unwrap();
    assert!(groups.iter().any(|group| group["alternatives"][1]["by"] == serde_json::json!(["base.sieve"])));
    refused(&voidwalk(&["init", "--json", "s.toml"]), &["cannot be used with"]);
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

/// A cubic lattice of touching grains: one void a grain, three constrictions of 0.414214 D.
#[test]
fn constrictions_of_a_packing_become_a_curve_for_a_scene() {
    let root = tempfile::tempdir().unwrap();
    let packing = root.path().join("sc.csv");
    let mut text = String::from("# cell_mm = 5, 5, 5\nx_mm,y_mm,z_mm,diameter_mm\n");
    for grain in 0..125 {
        text.push_str(&format!("{},{},{},1\n", grain % 5, grain / 5 % 5, grain / 25));
    }
    fs::write(&packing, text).unwrap();
    let out = root.path().join("out");
    let args = ["constrictions", packing.to_str().unwrap(), "--json", "--out", out.to_str().unwrap()];
    let output = voidwalk(&args);
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    let json: Value = serde_json::from_slice(&output.stdout).unwrap();
    assert_eq!(
        (&json["grains"], &json["voids"], &json["constrictions"]),
        (&125.into(), &125.into(), &375.into())
    );
    assert!((json["dc_mm"]["50"].as_f64().unwrap() - 0.414214).abs() < 1e-6);
    for file in ["constrictions.csv", "constrictions.json", "constrictions.vtp", "grains.vtp"] {
        assert!(out.join(file).is_file(), "{file}");
    }
    refused(&voidwalk(&args), &["--overwrite"]);
    let curve = format!("filter.curve={}", out.join("constrictions.csv").display());
    let check =
        ["check", "--json", "--set", &curve, "--set", "filter.cu=1", "--set", "filter.grains_per_void=1"];
    assert!(voidwalk(&check).status.success());
    fs::write(&packing, "x_mm,y_mm,z_mm,diameter_mm\n0,0,0,nan\n").unwrap();
    refused(&voidwalk(&["constrictions", packing.to_str().unwrap()]), &["sc.csv"]);
}

/// Inputs that a first reader of this program found to slip through.
#[test]
fn what_once_slipped_through_is_refused() {
    let root = tempfile::tempdir().unwrap();
    let out = root.path().join("out");
    for (more, message) in [
        (vec!["--set", "base.sieve=/dev/null"], "must be a regular file"),
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
    assert!(json["warnings"][0].as_str().unwrap().contains("constrictions of another filter"));
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

/// A small study: the folder, the numbers, the same bits for any number of threads, and what is refused.
#[test]
fn a_percolation_study_fills_a_folder() {
    let root = tempfile::tempdir().unwrap();
    let out = root.path().join("study");
    let on = |threads: &str, out: &Path| {
        let out = out.to_str().unwrap();
        voidwalk(&[
            "percolation",
            "--sizes",
            "4,6,5x5x9,8,12",
            "--realisations",
            "50",
            "--threads",
            threads,
            "--out",
            out,
        ])
    };
    let output = on("1", &out);
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    let words = String::from_utf8_lossy(&output.stdout);
    assert!(words.contains("95 % interval") && words.contains("many starts"), "{words}");
    let study: Value =
        serde_json::from_str(&fs::read_to_string(out.join("percolation.json")).unwrap()).unwrap();
    let mean = |i: usize| study["sizes"][i]["threshold"]["mean"].as_f64().unwrap();
    assert!((0.25..0.35).contains(&mean(0)) && mean(3) > mean(0) && mean(3) < 0.38222);
    assert_eq!(study["boxes"][0]["shape"], serde_json::json!([5, 5, 9]));
    assert!(
        words.contains("5x5x9") && fs::read_to_string(out.join("report.html")).unwrap().contains("5 × 5 × 9")
    );
    for file in ["report.html", "figures/percolation-sd.svg", "figures/percolation-threshold.svg"] {
        assert!(!fs::read_to_string(out.join(file)).unwrap().contains("NaN"), "{file}");
    }
    figures_are_listed(FolderKind::Percolation, &out);
    refused(&on("1", &out), &["--overwrite"]);
    let other = root.path().join("other");
    assert!(on("3", &other).status.success());
    let csv = |folder: &Path| fs::read_to_string(folder.join("percolation.csv")).unwrap();
    assert_eq!(csv(&out), csv(&other));
    // Boxes alone leave nothing to draw against size.
    let boxes = root.path().join("boxes");
    let alone = ["percolation", "--sizes", "4x4x6", "--realisations", "5", "--quiet", "--out"];
    let said = voidwalk(&[&alone[..], &[boxes.to_str().unwrap()]].concat());
    assert!(said.status.success() && said.stdout.is_empty() && said.stderr.is_empty());
    assert!(fs::read_to_string(boxes.join("report.html")).unwrap().contains("4 × 4 × 6"));
    assert!(!boxes.join("figures/percolation-sd.svg").exists());
    let none = root.path().join("none");
    let too_large = ["percolation", "--sizes", "10,2000", "--out", none.to_str().unwrap()];
    refused(&voidwalk(&too_large), &["2000 x 2000 x 2000"]);
    for wrong in ["0", "4x4", "4x0x4", "4x4x4x4", "-4", "4,,5"] {
        refused(&voidwalk(&["percolation", "--sizes", wrong]), &["--sizes", "40x40x60"]);
    }
    assert!(!none.exists());
}

/// A network that is not uniform is walked, reported by connectivity, and comes again from its own folder bit for bit.
#[test]
fn connectivity_is_spread_and_reported() {
    let root = tempfile::tempdir().unwrap();
    for (name, set) in
        [("a", "network.connectivity=table3"), ("b", "network.connectivity={3=1,5=34,6=30,7=35}")]
    {
        let out = root.path().join(name);
        assert!(run_small(&out, &["--set", set, "--quiet"]).status.success());
        let value = outcome(&out);
        let rows = value["replicates"][0]["runs"][0]["by_connectivity"].as_array().unwrap().clone();
        let sum = |field: &str| rows.iter().map(|row| row[field].as_u64().unwrap()).sum::<u64>();
        let run = &value["replicates"][0]["runs"][0];
        assert_eq!(sum("voids"), 640);
        assert_eq!(sum("blocked"), run["blocked"].as_u64().unwrap());
        assert_eq!(sum("retained_in_constrictions"), run["retained_in_constrictions"].as_u64().unwrap());
        assert_eq!(sum("retained_in_voids"), run["retained_in_voids"].as_u64().unwrap());
        let wanted: &[u64] = if name == "a" { &[4, 5, 6, 7, 8] } else { &[3, 5, 6, 7] };
        assert_eq!(rows.iter().map(|r| r["connectivity"].as_u64().unwrap()).collect::<Vec<_>>(), wanted);
        assert!(fs::read_to_string(out.join("report.html")).unwrap().contains("By connectivity of the void"));
        let again = root.path().join(format!("{name}-again"));
        let scene = out.join("scene.toml");
        let args =
            ["run", scene.to_str().unwrap(), "--out", again.to_str().unwrap(), "--quiet", "--threads", "1"];
        assert!(voidwalk(&args).status.success());
        assert_eq!(without_seconds(outcome(&again)), without_seconds(value));
    }
    let none = root.path().join("none");
    refused(&run_small(&none, &["--set", "network.connectivity={12=100}"]), &["the nearest found was"]);
    refused(
        &run_small(&none, &["--set", "network.connectivity=table4"]),
        &["--set, network.connectivity", "table3"],
    );
    assert!(!none.exists());
}

/// With sieve curves in mm every rule that the program knows has a result or says why not.
#[test]
fn filter_rules_and_equation_one_stand_in_the_outcome() {
    let root = tempfile::tempdir().unwrap();
    let sieve = |name: &str, rows: &str| {
        let path = root.path().join(name);
        fs::write(&path, format!("opening_mm,percent_finer\n{rows}")).unwrap();
        path.display().to_string()
    };
    let filter = format!("filter.sieve={}", sieve("filter.csv", "2,0\n3,40\n4.5,100\n"));
    let base = format!("base.sieve={}", sieve("base.csv", "0.05,0\n0.075,20\n0.4,85\n0.6,100\n"));
    let out = root.path().join("out");
    let more = ["--set", &filter, "--set", &base, "--set", "base.n_base=100000"];
    let output = run_small(&out, &more);
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    let value = outcome(&out);
    let rule = |name: &str| {
        let rules = value["rules"].as_array().unwrap();
        rules.iter().find(|r| r["name"].as_str().unwrap().starts_with(name)).unwrap().clone()
    };
    assert_eq!(rule("Kézdi")["met"], true);
    assert_eq!(rule("Kenney and Lau")["met"], true);
    // 20 % fines: 1.6 ((35 - 20)/20 (4 x 0.4 - 0.7) + 0.7) = 2.2 mm; and (40 - 20)/25 (4 x 0.4 - 0.7) + 0.7
    // = 1.42 mm.
    let limit = |name: &str| rule(name)["limit"].as_f64().unwrap();
    assert!((limit("Foster and Fell: no") - 2.2).abs() < 1e-9);
    assert!((limit("Sherard") - 1.42).abs() < 1e-9);
    assert_ne!(value["confidence"], "within checked range");
    let reasons: Vec<&str> =
        value["reasons"].as_array().unwrap().iter().map(|reason| reason.as_str().unwrap()).collect();
    assert!(reasons.iter().any(|reason| reason.contains("The base has 20 % fines")), "{reasons:?}");
    let stdout = String::from_utf8(output.stdout).unwrap();
    assert!(stdout.contains(" in the model\nPractice: not met: ") && stdout.contains(reasons[0]), "{stdout}");
    let found = &value["infiltration"];
    assert_eq!(found["layers"], 10);
    let run = &value["replicates"][0]["runs"][0];
    let (alone, walked) =
        (found["eroded_without_blocking"].as_f64().unwrap(), run["eroded_mass_fraction"].as_f64().unwrap());
    assert!(alone > walked - 0.05 && alone <= 1.0, "{alone} {walked}");
    // The built-in scene has a linear filter: its shape is an assumption, not a measurement.
    let linear = root.path().join("linear");
    assert!(run_small(&linear, &["--quiet"]).status.success());
    let text = fs::read_to_string(linear.join("outcome.json")).unwrap();
    assert_eq!(text.matches("needs the filter's sieve curve").count(), 8);
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
    let commands: [(&str, &[&str]); 7] = [
        ("run", &["run"]),
        ("packing", &["pack", "filter.toml"]),
        ("campaign", &["campaign", "plan.toml"]),
        ("percolation study", &["percolation", "--sizes", "4", "--realisations", "2"]),
        ("precision study", &["precision"]),
        ("design", &["design"]),
        ("set of constrictions", &["constrictions", "grains.csv"]),
    ];
    let marks = [
        ("run", "outcome.json"),
        ("run", "checkpoint"),
        ("packing", "packing.json"),
        ("packing", "compression.0"),
        ("campaign", "cases"),
        ("percolation study", "percolation.json"),
        ("precision study", "precision.json"),
        ("design", "design.json"),
        ("design", "networks.1"),
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

/// The packing's time stands beside that of the walks.
#[test]
fn check_says_what_packing_and_walks_take() {
    let root = tempfile::tempdir().unwrap();
    let scene = root.path().join("scene.toml");
    fs::write(&scene, "[filter]\ncu = 1.5\nfriction = 0.7\n[base]\ncu = 1.5\nd85_at_dc = 5\n").unwrap();
    let packings = root.path().join("none");
    let args = ["check", scene.to_str().unwrap(), "--packings", packings.to_str().unwrap()];
    let words = String::from_utf8(voidwalk(&args).stdout).unwrap();
    let line = |name: &str| words.lines().find(|line| line.starts_with(name)).unwrap().to_owned();
    assert!(line("time to pack").contains("some 21 600 steps"), "{words}");
    assert!(line("time to walk").contains("of one core"), "{words}");
    let output = voidwalk(&[&args[..], &["--json"]].concat());
    let json: Value = serde_json::from_slice(&output.stdout).unwrap();
    let packing = &json["packing"];
    assert_eq!((&packing["steps"], &packing["is_made"]), (&21_600.into(), &false.into()));
    // How long depends on the machine.
    assert!(packing["core_seconds"].as_f64().unwrap() > 0.0 && json["core_seconds"].as_f64().unwrap() > 0.0);
}
