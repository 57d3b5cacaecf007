//! A scene as a user meets it: what a run folder holds, and the same bits from it again.

use std::fs;

use serde_json::Value;

use super::small_run::{SMALL, outcome, refused, run_small, voidwalk, without_seconds};

#[test]
fn a_run_folder_holds_what_is_promised() {
    let root = tempfile::tempdir().unwrap();
    let folder = root.path().join("run");
    let output = run_small(&folder, &[]);
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    let stdout = String::from_utf8_lossy(&output.stdout);
    let starts = stdout.starts_with("Model (research): ");
    assert!(starts && stdout.contains("it leaves out hydraulics"), "{stdout}");
    let outcome = outcome(&folder);
    for key in [
        "model",
        "digest",
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
    // Its sizes are multiples of D0F, for which practice has no answer.
    assert!(outcome.get("headline").is_none() && outcome.get("practice").is_none(), "{outcome}");
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
    assert!(sentences.contains("second_run") && sentences.contains("few_passive"), "{sentences}");
}

/// Replicates are added until the verdict is certain or the error small; where that cannot be, it says what it would take.
#[test]
fn a_run_goes_on_until_its_rule_is_met_or_says_what_it_would_take() {
    let root = tempfile::tempdir().unwrap();
    let folder = |name: &str| root.path().join(name);
    // Coarser constrictions than the base anywhere: clear after the first look.
    let clear = ["--set", "base.d85_at_dc=0", "--decide-percent", "99.9"];
    assert!(run_small(&folder("clear"), &clear).status.success());
    let clear = outcome(&folder("clear"));
    assert_eq!(
        (&clear["stopping"]["met"], clear["replicates"].as_array().unwrap().len()),
        (&Value::from(true), 8)
    );
    assert_eq!(clear["model"]["class"], clear["stopping"]["verdict"]);

    let target = ["--set", "record.sensitivity=[]", "--target-error-pp", "1.5", "--threads"];
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

    let hopeless = ["--target-error-pp", "0.01", "--set", "stop.most_replicates=10"];
    let output = run_small(&folder("hopeless"), &hopeless);
    assert!(output.status.success());
    let found = outcome(&folder("hopeless"))["notes"].to_string();
    assert!(found.contains("target_missed"), "{found}");
    for value in ["100", "many", "99%"] {
        refused(&voidwalk(&["run", "--decide-percent", value]), &["from 50 to 99.999 (%)"]);
    }
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
fn init_writes_a_scene_that_check_understands() {
    let root = tempfile::tempdir().unwrap();
    let path = root.path().join("scene.toml");
    assert!(voidwalk(&["init", path.to_str().unwrap()]).status.success());
    refused(&voidwalk(&["init", path.to_str().unwrap()]), &["exists already"]);
    let plan = root.path().join("plan.toml");
    assert!(voidwalk(&["init", "--plan", plan.to_str().unwrap()]).status.success());
    refused(&voidwalk(&["init", "--plan", plan.to_str().unwrap()]), &["exists already"]);
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
    assert!(capped["notes"][0]["id"] == "capped_base");
    let words = String::from_utf8(voidwalk(&["check", path.to_str().unwrap()]).stdout).unwrap();
    assert!(words.contains("base particles") && words.contains("memory") && words.contains("left out"));
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
    let fines = value["notes"].as_array().unwrap().iter().find(|finding| finding["id"] == "cohesive_fines");
    assert_eq!(fines.unwrap()["numbers"]["fines_percent"], 20.0);
    let stdout = String::from_utf8(output.stdout).unwrap();
    assert!(stdout.contains("Practice: does not meet"), "{stdout}");
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
    assert_eq!(text.matches("\"needs_curve_of_filter").count(), 8);
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
