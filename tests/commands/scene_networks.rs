//! Networks from a file, percolation, connectivity.

use std::fs;
use std::path::Path;

use serde_json::Value;
use voidwalk::run::FolderKind;

use super::program::figures_are_listed;
use super::small_run::{outcome, refused, run_small, voidwalk, without_seconds};

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
    assert!(outcome["notes"].to_string().contains("given_network"));
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
    let outcome =
        serde_json::from_str::<Value>(&fs::read_to_string(out.join("outcome.json")).unwrap()).unwrap();
    let notes = outcome["notes"].to_string();
    assert!(notes.contains("\"trapped\"") && notes.contains("\"trapped_could_turn\""), "{notes}");
    // The kept scene runs again from its own folder.
    let again = root.path().join("again");
    let scene = folder.join("scene.toml");
    assert!(voidwalk(&["run", scene.to_str().unwrap(), "--out", again.to_str().unwrap()]).status.success());
    assert_eq!(fs::read(folder.join("series.csv")).unwrap(), fs::read(again.join("series.csv")).unwrap());
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
