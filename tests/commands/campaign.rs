//! `voidwalk campaign`: what its folder holds, what is walked again and what not, kills, and processes side by side.

use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Child, Command};
use std::time::Duration;

use serde_json::Value;

use crate::program::{call, done, voidwalk};

const PLAN: &str = "title = \"three by two\"\nseed = 5\n[set]\nreplicates = 2\n\
    network = { nx = 8, ny = 8, nz = 10 }\nrecord = { sensitivity = [], series_every = 0, size_curves = [] }\n\
    [[factor]]\nname = \"cu_b\"\nsetting = \"base.cu\"\nvalues = [1.5, 2, 3]\n\
    [[factor]]\nname = \"filter\"\n[factor.levels]\nloose = { \"filter.curve\" = \"shire2016-cu1.5-loose\" }\n\
    dense = { \"filter.curve\" = \"shire2016-cu1.5-dense\", \"base.dc_curve\" = \"shire2016-cu1.5-loose\" }\n";

fn start(folder: &Path, args: &[&str]) -> Child {
    voidwalk(folder, args).spawn().unwrap()
}

fn with_plan(text: &str) -> (tempfile::TempDir, PathBuf) {
    let root = tempfile::tempdir().unwrap();
    fs::write(root.path().join("plan.toml"), text).unwrap();
    let path = root.path().to_owned();
    (root, path)
}

/// The ledger without where and when.
fn ledger(folder: &Path) -> Vec<Value> {
    let text = fs::read_to_string(folder.join("ledger.jsonl")).unwrap();
    let line = |line: &str| {
        let mut value: Value = serde_json::from_str(line).unwrap();
        value.as_object_mut().unwrap().remove("made");
        value
    };
    text.lines().map(line).collect()
}

fn table(folder: &Path) -> String {
    fs::read_to_string(folder.join("cases.csv")).unwrap()
}

#[test]
fn a_campaign_folder_holds_what_is_promised() {
    let (_root, at) = with_plan(PLAN);
    let output = call(&at, &["campaign", "plan.toml", "--out", "out"]);
    done(&output);
    let lines = ledger(&at.join("out"));
    let names: Vec<&str> = lines.iter().map(|line| line["case"].as_str().unwrap()).collect();
    assert_eq!(names[..3], ["cu_b=1.5,filter=loose", "cu_b=1.5,filter=dense", "cu_b=2,filter=loose"]);
    assert_eq!(lines.len(), 6);
    assert_eq!(table(&at.join("out")).lines().count(), 7);
    let page = fs::read_to_string(at.join("out/report.html")).unwrap();
    assert!(page.contains("three by two") && page.contains("What the model leaves out"));
    // No verdict stands without what makes it doubtful, on any face.
    let (text, table) = (String::from_utf8(output.stdout).unwrap(), table(&at.join("out")));
    assert!(text.contains("it leaves out hydraulics, "), "{text}");
    assert!(table.starts_with("case,cu_b,filter,verdict,rules_not_met,notes,layers,thickness_mm,"));
    for (line, row) in lines.iter().zip(table.lines().skip(1)) {
        let said = |key: &str| line[key].as_str().unwrap();
        let verdict = format!("{}: {}, ", said("case"), said("verdict"));
        assert!(text.contains(&verdict), "{text}");
        assert!(row.contains(&format!(",{},", said("verdict"))), "{row}");
        assert_eq!(line["thickness"]["layers"], 10);
    }
    assert!(text.contains("  modelled filter thickness: 10 layers, ") && text.contains(" grains per void"));
    assert!(page.contains("only 2 replicates") && page.contains("10 layers"));
    for line in &lines {
        let folder = at.join("out").join(line["folder"].as_str().unwrap());
        let outcome: Value = serde_json::from_slice(&fs::read(folder.join("outcome.json")).unwrap()).unwrap();
        assert_eq!(outcome["summary"], line["runs"]);
        assert_eq!(outcome["model"]["class"], line["verdict"]);
        assert!(folder.join("report.html").is_file());
    }
    // A case's own scene gives the same again.
    let folder = at.join("out").join(lines[3]["folder"].as_str().unwrap());
    done(&call(&folder, &["run", "scene.toml", "--out", "../../../again"]));
    let again: Value = serde_json::from_slice(&fs::read(at.join("again/outcome.json")).unwrap()).unwrap();
    assert_eq!(again["summary"], lines[3]["runs"]);
}

/// Cases of one filter walk the same networks, built once for all of them; a case that is walked by itself
/// builds its own.
#[test]
fn cases_that_share_networks_are_walked_to_the_same_bits() {
    let (_root, at) = with_plan(&format!("seeds = \"common\"\n{PLAN}"));
    done(&call(&at, &["campaign", "plan.toml", "--out", "shared"]));
    let together = ledger(&at.join("shared"));
    assert_eq!(together.len(), 6);
    for line in &together {
        let folder = at.join("shared").join(line["folder"].as_str().unwrap());
        let again = call(&folder, &["run", "scene.toml", "--out", "alone"]);
        done(&again);
        let alone: Value =
            serde_json::from_slice(&fs::read(folder.join("alone/outcome.json")).unwrap()).unwrap();
        assert_eq!((&alone["summary"], &alone["model"]["class"]), (&line["runs"], &line["verdict"]));
        assert_eq!(alone["seed"], 5);
    }
    // Common random numbers are not those of seeds of their own.
    fs::write(at.join("plan.toml"), PLAN).unwrap();
    done(&call(&at, &["campaign", "plan.toml", "--out", "own"]));
    let own = ledger(&at.join("own"));
    assert!(own.iter().zip(&together).all(|(own, together)| own["runs"] != together["runs"]));
}

#[test]
fn only_what_has_changed_is_walked_again() {
    let (_root, at) = with_plan(PLAN);
    done(&call(&at, &["campaign", "plan.toml", "--out", "out"]));
    let stamps = || -> Vec<(PathBuf, std::time::SystemTime)> {
        let mut all: Vec<_> = fs::read_dir(at.join("out/cases"))
            .unwrap()
            .map(|entry| entry.unwrap().path())
            .map(|path| (path.clone(), fs::metadata(path.join("case.json")).unwrap().modified().unwrap()))
            .collect();
        all.sort();
        all
    };
    let first = stamps();
    done(&call(&at, &["campaign", "plan.toml", "--out", "out"]));
    assert_eq!(first, stamps(), "nothing has changed");
    // One level more: two cases more, the others stay. One level changed: its cases only.
    fs::write(at.join("plan.toml"), PLAN.replace("[1.5, 2, 3]", "[1.5, 2, 3, 4]")).unwrap();
    done(&call(&at, &["campaign", "plan.toml", "--out", "out"]));
    let second = stamps();
    assert_eq!(second.len(), 8);
    assert!(first.iter().all(|entry| second.contains(entry)));
    let changed = PLAN.replace("cu1.5-dense\", ", "cu1.5-dense\", \"filter.grains_per_void\" = 0.5, ");
    fs::write(at.join("plan.toml"), changed).unwrap();
    done(&call(&at, &["campaign", "plan.toml", "--out", "out"]));
    let third = stamps();
    for (path, stamp) in &second {
        let dense = path.to_string_lossy().contains("filter=dense");
        let four = path.to_string_lossy().contains("cu_b=4");
        let same = third.contains(&(path.clone(), *stamp));
        assert_eq!(same, !dense || four, "{}", path.display());
    }
}

#[test]
fn a_campaign_that_is_killed_again_and_again_gives_the_same_ledger() {
    let (_root, at) = with_plan(PLAN);
    done(&call(&at, &["campaign", "plan.toml", "--out", "whole"]));
    let mut kills = 0;
    for attempt in 0..20u64 {
        let mut child = start(&at, &["campaign", "plan.toml", "--out", "broken", "--threads", "1"]);
        std::thread::sleep(Duration::from_millis(20 + 11 * (attempt % 7)));
        let signal = if attempt % 3 == 0 { "-TERM" } else { "-KILL" };
        let _ = Command::new("kill").args([signal, &child.id().to_string()]).status().unwrap();
        let code = child.wait().unwrap().code();
        assert!(matches!(code, None | Some(0 | 3)), "{code:?}");
        kills += usize::from(code != Some(0));
    }
    assert!(kills >= 1, "no start was cut short");
    done(&call(&at, &["campaign", "plan.toml", "--out", "broken"]));
    assert_eq!(ledger(&at.join("whole")), ledger(&at.join("broken")));
    assert_eq!(table(&at.join("whole")), table(&at.join("broken")));
}

#[test]
fn processes_side_by_side_share_the_cases() {
    let (_root, at) = with_plan(PLAN);
    done(&call(&at, &["campaign", "plan.toml", "--out", "alone"]));
    let children: Vec<Child> =
        (0..3).map(|_| start(&at, &["campaign", "plan.toml", "--out", "shared", "--threads", "1"])).collect();
    for child in children {
        done(&child.wait_with_output().unwrap());
    }
    assert_eq!(ledger(&at.join("alone")), ledger(&at.join("shared")));
}

#[test]
fn one_case_can_be_walked_by_itself() {
    let (_root, at) = with_plan(PLAN);
    let listed = call(&at, &["campaign", "plan.toml", "--list"]);
    let names = String::from_utf8(listed.stdout).unwrap();
    assert_eq!(names.lines().count(), 6);
    for name in names.lines() {
        done(&call(&at, &["campaign", "plan.toml", "--out", "by-one", "--case", name]));
    }
    assert!(!at.join("by-one/ledger.jsonl").exists(), "the ledger is left to a call without --case");
    done(&call(&at, &["campaign", "plan.toml", "--out", "by-one"]));
    done(&call(&at, &["campaign", "plan.toml", "--out", "whole"]));
    assert_eq!(ledger(&at.join("whole")), ledger(&at.join("by-one")));
    let wrong = call(&at, &["campaign", "plan.toml", "--case", "cu_b=1.5,filter=lose"]);
    assert_eq!(wrong.status.code(), Some(2));
    assert!(String::from_utf8_lossy(&wrong.stderr).contains("did you mean `cu_b=1.5,filter=loose`"));
}

#[test]
fn filters_of_a_campaign_are_packed_once() {
    let packed = PLAN
        .replace("\"filter.curve\" = \"shire2016-cu1.5-loose\" }", "filter = { cu = 1.5, density = \"loose\" } }")
        .replace("[set]\n", "[set]\npacking = { grains = 400, stiffness_ratio = 0.01 }\n")
        .replace("dense = { \"filter.curve\" = \"shire2016-cu1.5-dense\", \"base.dc_curve\" = \"shire2016-cu1.5-loose\" }", "dense = { filter = { cu = 1.5, friction = 0.1 }, \"base.dc_curve\" = \"shire2016-cu1.5-loose\" }");
    let (_root, at) = with_plan(&packed);
    done(&call(&at, &["campaign", "plan.toml", "--out", "out"]));
    assert_eq!(fs::read_dir(at.join("out/packings")).unwrap().count(), 2);
    assert_eq!(ledger(&at.join("out")).len(), 6);
    let again = call(&at, &["campaign", "plan.toml", "--out", "out"]);
    done(&again);
    assert!(String::from_utf8_lossy(&again.stderr).contains("6 of 6 cases are done already"));
}

#[test]
fn a_bad_case_refuses_the_plan_before_any_work() {
    for (bad, message) in [
        (PLAN.replace("[1.5, 2, 3]", "[0.5]"), "case cu_b=0.5,filter=loose, base.cu: `0.5` is not allowed"),
        (PLAN.replace("shire2016-cu1.5-dense", "no-such"), "no-such"),
        (PLAN.replace("nx = 8", "nx = 8, nw = 3"), "there is no setting `network.nw`"),
    ] {
        let (_root, at) = with_plan(&bad);
        let output = call(&at, &["campaign", "plan.toml", "--out", "out"]);
        let stderr = String::from_utf8_lossy(&output.stderr);
        assert_eq!(output.status.code(), Some(2), "{stderr}");
        assert!(stderr.contains(message), "{stderr}");
        assert!(!at.join("out").exists());
    }
}

#[test]
fn a_case_that_cannot_be_walked_stops_no_other() {
    let (_root, at) = with_plan(PLAN);
    done(&call(&at, &["campaign", "plan.toml", "--out", "whole"]));
    // Its folder cannot be made.
    fs::create_dir_all(at.join("out/cases")).unwrap();
    fs::write(at.join("out/.voidwalk.lock"), "").unwrap();
    let (name, folder) = ("cu_b=1.5,filter=dense", at.join("out/cases/cu_b=1.5,filter=dense"));
    fs::write(&folder, "a file").unwrap();
    let output = call(&at, &["campaign", "plan.toml", "--out", "out"]);
    let stderr = String::from_utf8_lossy(&output.stderr);
    assert_eq!(output.status.code(), Some(1), "{stderr}");
    assert!(stderr.contains("1 of 6 cases could not be walked; the others are done"), "{stderr}");
    assert!(stderr.contains(&format!("case {name}: ")), "{stderr}");
    let mut whole = ledger(&at.join("whole"));
    whole.retain(|line| line["case"] != name);
    assert_eq!(ledger(&at.join("out")), whole);
    let about: Value = serde_json::from_slice(&fs::read(at.join("out/campaign.json")).unwrap()).unwrap();
    assert_eq!(about["missing"], serde_json::json!([name]));
    let refused = call(&at, &["campaign", "plan.toml", "--out", "out", "--collect"]);
    assert_eq!(refused.status.code(), Some(2));
    assert!(String::from_utf8_lossy(&refused.stderr).contains(&format!("case {name}: could not be walked")));
    // What was in the way is gone: that case alone is walked.
    fs::remove_file(&folder).unwrap();
    let output = call(&at, &["campaign", "plan.toml", "--out", "out"]);
    done(&output);
    assert!(String::from_utf8_lossy(&output.stderr).contains("5 of 6 cases are done already"));
    assert_eq!(ledger(&at.join("out")), ledger(&at.join("whole")));
}

#[test]
fn a_case_that_needs_too_much_memory_stops_no_other() {
    let large = "[[case]]\nname = \"large\"\nset = { \"filter.curve\" = \"shire2016-cu1.5-loose\", \
        network = { nx = 800, ny = 800, nz = 60 } }\n";
    let (_root, at) = with_plan(&format!("{PLAN}{large}"));
    let output = call(&at, &["campaign", "plan.toml", "--out", "out", "--memory", "200MB"]);
    let stderr = String::from_utf8_lossy(&output.stderr);
    assert_eq!(output.status.code(), Some(1), "{stderr}");
    assert!(
        stderr.contains("1 of 7 cases could not be walked") && stderr.contains("case large: "),
        "{stderr}"
    );
    assert_eq!(ledger(&at.join("out")).len(), 6);
}

/// As on a file system whose locks reach one machine only: another process finds a lock that nobody holds.
#[test]
fn without_locks_a_case_may_be_walked_twice_and_is_the_same() {
    let (_root, at) = with_plan(PLAN);
    done(&call(&at, &["campaign", "plan.toml", "--out", "whole"]));
    let args = ["campaign", "plan.toml", "--out", "out", "--threads", "1", "--checkpoint-every", "1ms"];
    let mut children: Vec<Child> = (0..3).map(|_| start(&at, &args)).collect();
    while children.iter_mut().any(|child| child.try_wait().unwrap().is_none()) {
        for entry in fs::read_dir(at.join("out/cases")).into_iter().flatten().flatten() {
            let lock = entry.path().join(".voidwalk.lock");
            if lock.exists() {
                fs::write(entry.path().join("new"), "").unwrap();
                fs::rename(entry.path().join("new"), lock).unwrap();
            }
        }
        std::thread::sleep(Duration::from_millis(1));
    }
    for child in children {
        done(&child.wait_with_output().unwrap());
    }
    assert_eq!(ledger(&at.join("whole")), ledger(&at.join("out")));
    assert_eq!(table(&at.join("whole")), table(&at.join("out")));
}
