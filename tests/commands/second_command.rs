//! A second command on the same folder: what it replaces goes, what is not its own stays, what was cut short is ended.

use std::collections::BTreeMap;
use std::fs;
use std::path::{Path, PathBuf};
use std::time::Duration;

use crate::program::{call, done, refused, voidwalk};

const SMALL: &str = "[network]\nnx = 4\nny = 4\nnz = 5\n[record]\nsensitivity = []\n";
const PACKED: &str = "replicates = 2\n[filter]\ncu = 1.5\ndensity = \"loose\"\n[packing]\ngrains = 150\n\
    stiffness_ratio = 0.01\n[base]\ncu = 1.5\nd85_at_dc = 5\nn_base = 1000\n";
const SHIPPED: &str =
    "replicates = 2\n[filter]\ncurve = \"cu6-friction0.7\"\n[base]\ncu = 1.5\nd85_at_dc = 5\nn_base = 1000\n";
const PACK: &str =
    "[filter]\ncu = 1.5\ndensity = \"loose\"\n[packing]\ngrains = 150\nstiffness_ratio = 0.01\n";

fn with_files(files: &[(&str, &str)]) -> (tempfile::TempDir, PathBuf) {
    let memory = Path::new("/dev/shm");
    let root = if memory.is_dir() { tempfile::tempdir_in(memory) } else { tempfile::tempdir() }.unwrap();
    for (name, text) in files {
        fs::write(root.path().join(name), text).unwrap();
    }
    let path = root.path().to_owned();
    (root, path)
}

/// Every file below a folder with its bytes.
fn files(folder: &Path) -> BTreeMap<PathBuf, Vec<u8>> {
    let (mut all, mut folders) = (BTreeMap::new(), vec![folder.to_owned()]);
    while let Some(at) = folders.pop() {
        for entry in fs::read_dir(at).unwrap() {
            let path = entry.unwrap().path();
            match path.is_dir() {
                true => folders.push(path),
                false => {
                    let bytes = fs::read(&path).unwrap();
                    all.insert(path.strip_prefix(folder).unwrap().to_owned(), bytes);
                }
            }
        }
    }
    all
}

fn names(folder: &Path) -> Vec<PathBuf> {
    files(folder).into_keys().collect()
}

#[test]
fn what_is_replaced_leaves_nothing_but_what_is_not_the_programs_own() {
    let (packed, shipped) = (format!("{PACKED}{SMALL}"), format!("{SHIPPED}{SMALL}"));
    let (_root, at) = with_files(&[("packed.toml", &packed), ("shipped.toml", &shipped)]);
    done(&call(&at, &["run", "packed.toml", "--out", "b", "-q", "--packings", "kept"]));
    for own in ["notes.txt", "figures/mine.svg", "inputs/mine.csv"] {
        fs::write(at.join("b").join(own), "mine").unwrap();
    }
    done(&call(&at, &["run", "shipped.toml", "--out", "b", "-q", "--overwrite"]));
    done(&call(&at, &["run", "shipped.toml", "--out", "clean", "-q"]));
    let mut expected = names(&at.join("clean"));
    expected.extend(["notes.txt", "figures/mine.svg", "inputs/mine.csv"].map(PathBuf::from));
    expected.sort();
    assert_eq!(names(&at.join("b")), expected);
    assert!(!fs::read_to_string(at.join("b/report.html")).unwrap().contains("A slice through the packing"));
    // Nor does a page show a packing that its run was not made with.
    fs::create_dir_all(at.join("clean/inputs")).unwrap();
    let kept = fs::read_dir(at.join("kept")).unwrap().next().unwrap().unwrap().path();
    fs::copy(kept.join("packing.json"), at.join("clean/inputs/packing.json")).unwrap();
    done(&call(&at, &["report", "clean"]));
    assert!(
        !fs::read_to_string(at.join("clean/report.html")).unwrap().contains("A slice through the packing")
    );
}

#[test]
fn constrictions_of_ones_own_grains_are_no_part_of_a_packing() {
    let grains = "# cell_mm = 5, 5, 5\nx_mm,y_mm,z_mm,diameter_mm\n".to_owned()
        + &(0..200u64)
            .map(|i| {
                let at = |by: u64| (i * by % 1009) as f64 / 202.0;
                format!("{},{},{},0.8\n", at(313), at(571), at(797))
            })
            .collect::<String>();
    let (_root, at) = with_files(&[("own.csv", &grains), ("pack.toml", PACK)]);
    done(&call(&at, &["constrictions", "own.csv", "--out", "own"]));
    let before = files(&at.join("own"));
    for more in [&[][..], &["--overwrite"]] {
        let args = [&["pack", "pack.toml", "--out", "own", "-q"][..], more].concat();
        refused(&call(&at, &args), "holds a set of constrictions; name another folder");
    }
    let after = files(&at.join("own"));
    let lasting = |files: &BTreeMap<PathBuf, Vec<u8>>| {
        files
            .iter()
            .filter(|(name, _)| !name.ends_with(".voidwalk.lock"))
            .map(|(n, b)| (n.clone(), b.clone()))
            .collect()
    };
    let (before, after): (Vec<_>, Vec<_>) = (lasting(&before), lasting(&after));
    assert!(before == after);
}

#[test]
fn a_resumed_run_is_saved_as_often_as_it_was_told_first() {
    let scene = "seed = 3\nreplicates = 2\nruns = 1\nengine = \"particles\"\n[filter]\n\
        curve = \"shire2016-cu1.5-loose\"\n[base]\ncu = 1.5\nd85_at_dc = 5\nn_base = 150000\n[network]\nnx = 8\n\
        ny = 8\nnz = 10\n[record]\nsensitivity = []\n";
    let (_root, at) = with_files(&[("s.toml", scene)]);
    // Each start is killed as soon as it has saved anything new, and so the run comes to its end.
    let mut starts = 0;
    loop {
        let args: &[&str] = match starts {
            0 => {
                &["run", "s.toml", "--out", "r", "-q", "--threads", "1", "--checkpoint-every", "40increments"]
            }
            _ => &["resume", "r", "-q", "--threads", "1"],
        };
        let checkpoints = || at.join("r/checkpoint").is_dir().then(|| files(&at.join("r/checkpoint")));
        let before = if starts == 0 { Some(BTreeMap::new()) } else { checkpoints() };
        let mut child = voidwalk(&at, args).spawn().unwrap();
        let code = loop {
            if let Some(status) = child.try_wait().unwrap() {
                break status.code();
            }
            let now = fs::read_dir(at.join("r/checkpoint")).map_or(0, |files| files.count());
            if starts < 3
                && now > 0
                && std::panic::catch_unwind(checkpoints).ok().is_some_and(|now| now != before)
            {
                let _ = child.kill();
                break child.wait().unwrap().code();
            }
            std::thread::sleep(Duration::from_millis(2));
        };
        starts += 1;
        match code {
            None => {}
            Some(0) => break,
            code => panic!("{code:?}"),
        }
    }
    assert!(starts == 4, "{starts} starts: the checkpoints of a resumed run did not come");
    assert!(!at.join("r/.voidwalk.unfinished").exists() && !at.join("r/checkpoint").exists());
}

#[test]
fn a_distribution_of_connectivity_that_check_admits_is_walked() {
    let scene = "seed = 0\nreplicates = 10\nruns = 1\n[filter]\ncurve = \"shire2016-cu1.5-loose\"\n[base]\ncu = 1.5\n\
        d85_at_dc = 5\nn_base = 200\n[network]\nnx = 7\nny = 5\nnz = 9\nconnectivity = { 4 = 50, 8 = 50 }\n[record]\n\
        sensitivity = []\n";
    let (_root, at) = with_files(&[("s.toml", scene)]);
    done(&call(&at, &["check", "s.toml"]));
    done(&call(&at, &["run", "s.toml", "--out", "r", "-q"]));
}

#[test]
fn harmed_checkpoints_of_a_campaigns_case_are_not_passed_over_in_silence() {
    let plan = "[set]\nreplicates = 1\nruns = 1\nengine = \"particles\"\nnetwork = { nx = 5, ny = 5, nz = 8 }\n\
        base = { cu = 1.5, d85_at_dc = 5, n_base = 60000 }\nrecord = { sensitivity = [] }\n[[case]]\nname = \"x\"\n";
    let (_root, at) = with_files(&[("plan.toml", plan)]);
    let args =
        ["campaign", "plan.toml", "--out", "c", "-q", "--checkpoint-every", "1increment", "--threads", "1"];
    let mut child = voidwalk(&at, &args).spawn().unwrap();
    while !at.join("c/cases/x/checkpoint/0-1.1").exists() {
        assert!(child.try_wait().unwrap().is_none(), "it is too short to be killed");
    }
    let _ = child.kill();
    let _ = child.wait();
    for entry in fs::read_dir(at.join("c/cases/x/checkpoint")).unwrap() {
        let path = entry.unwrap().path();
        let mut bytes = fs::read(&path).unwrap();
        // What was being written when it was killed is empty, or no checkpoint yet.
        let Some(last) = bytes.last_mut() else { continue };
        *last ^= 1;
        fs::write(path, bytes).unwrap();
    }
    let again = call(&at, &args);
    done(&again);
    let stderr = String::from_utf8_lossy(&again.stderr);
    assert!(stderr.contains("warning: case x: ") && stderr.contains("walked from its start"), "{stderr}");
}

#[test]
fn two_plans_on_one_folder_never_leave_a_short_ledger_without_a_word() {
    let set = "[set]\nreplicates = 1\nruns = 1\nengine = \"particles\"\nnetwork = { nx = 5, ny = 5, nz = 8 }\n\
        base = { cu = 1.5, d85_at_dc = 5, n_base = 200 }\nrecord = { sensitivity = [] }\n[[case]]\nname = \"x\"\n";
    let plan = format!("{set}[[case]]\nname = \"y\"\nset = {{ \"base.n_base\" = 60000 }}\n");
    let (_root, at) = with_files(&[("plan.toml", &plan), ("x.toml", set)]);
    let args =
        ["campaign", "plan.toml", "--out", "c", "-q", "--checkpoint-every", "1increment", "--threads", "1"];
    done(&call(&at, &[&args[..], &["--case", "x"]].concat()));
    let mut child = voidwalk(&at, &args).spawn().unwrap();
    while !at.join("c/cases/y/checkpoint/0-1.0").exists() {
        assert!(child.try_wait().unwrap().is_none(), "it is too short for another to come between");
    }
    // Another plan has walked its own case of that name meanwhile.
    let line = at.join("c/cases/x/case.json");
    let text = fs::read_to_string(&line).unwrap();
    fs::write(&line, text.replacen("\"fingerprint\": \"", "\"fingerprint\": \"0", 1)).unwrap();
    let output = child.wait_with_output().unwrap();
    let stderr = String::from_utf8_lossy(&output.stderr);
    assert_eq!(output.status.code(), Some(1), "{stderr}");
    assert!(stderr.contains("case x: its results were overwritten by another process"), "{stderr}");
    // A plan with fewer cases says which leave the ledger.
    let narrowed = call(&at, &["campaign", "x.toml", "--out", "c", "-q"]);
    done(&narrowed);
    let stderr = String::from_utf8_lossy(&narrowed.stderr);
    assert!(stderr.contains("1 of its cases are not in this plan") && stderr.contains("(y)"), "{stderr}");
}

/// A run that was killed as soon as it had begun, with its scene and its files.
fn killed_run(at: &Path, args: &[&str]) {
    let mut child = voidwalk(at, args).spawn().unwrap();
    while !at.join("r/checkpoint/0-1.1").exists() {
        assert!(child.try_wait().unwrap().is_none(), "it is too short to be killed");
    }
    let _ = child.kill();
    let _ = child.wait();
}

const WITH_FILES: &str = "seed = 4\nreplicates = 2\nengine = \"particles\"\n[filter]\ncurve = \"shire2016-cu1.5-loose\"\n\
    sieve = \"filter.csv\"\ngrains_per_void = 0.6\n[base]\nsieve = \"base.csv\"\nn_base = 100000\n\
    [network]\nnx = 5\nny = 5\nnz = 8\n[record]\nsensitivity = []\n";

#[test]
fn a_resumed_run_is_the_one_that_was_begun() {
    let (_root, at) = with_files(&[
        ("s.toml", WITH_FILES),
        ("filter.csv", "opening_mm,percent_finer\n4,100\n2,50\n1,0\n"),
        ("base.csv", "opening_mm,percent_finer\n0.4,100\n0.2,50\n0.08,0\n"),
    ]);
    killed_run(&at, &["run", "s.toml", "--out", "r", "-q", "--checkpoint-every", "1increment"]);
    let resume = || call(&at, &["resume", "r", "-q"]);
    // What the user called the files is known, or it is said that it is not.
    let names = fs::read(at.join("r/inputs/names.json")).unwrap();
    fs::write(at.join("r/inputs/names.json"), &names[..names.len() / 2]).unwrap();
    refused(&resume(), "r/inputs/names.json: does not name the files beside it as a run writes it");
    fs::write(at.join("r/inputs/names.json"), names).unwrap();
    // Another base is no part of this run, with its checkpoints or without.
    let base = fs::read(at.join("r/inputs/base-sieve.csv")).unwrap();
    fs::write(at.join("r/inputs/base-sieve.csv"), "opening_mm,percent_finer\n0.4,100\n0.08,0\n").unwrap();
    refused(&resume(), "scene.toml or a file in inputs is not what this run was begun with");
    let before = files(&at.join("r"));
    fs::rename(at.join("r/checkpoint"), at.join("kept")).unwrap();
    refused(&resume(), "scene.toml or a file in inputs is not what this run was begun with");
    fs::remove_dir_all(at.join("r/checkpoint")).ok();
    fs::rename(at.join("kept"), at.join("r/checkpoint")).unwrap();
    assert!(before.keys().eq(files(&at.join("r")).keys()));
    fs::write(at.join("r/inputs/base-sieve.csv"), base).unwrap();
    done(&resume());
}

#[test]
fn a_resumed_run_follows_no_link_to_packings() {
    let scene = format!("{SHIPPED}{SMALL}").replace("n_base = 1000", "n_base = 100000");
    let (_root, at) = with_files(&[("s.toml", &format!("engine = \"particles\"\n{scene}"))]);
    killed_run(&at, &["run", "s.toml", "--out", "r", "-q", "--checkpoint-every", "1increment"]);
    fs::create_dir(at.join("elsewhere")).unwrap();
    std::os::unix::fs::symlink("../elsewhere", at.join("r/packings")).unwrap();
    refused(&call(&at, &["resume", "r", "-q"]), "r/packings: is a symbolic link, which is not followed");
    assert!(names(&at.join("elsewhere")).is_empty());
    fs::remove_file(at.join("r/packings")).unwrap();
    done(&call(&at, &["resume", "r", "-q"]));
}
