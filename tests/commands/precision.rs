//! `voidwalk precision`: what its folder holds, that the exact tier is exact, that nothing but times depends on threads, and
//! what is refused.

use std::collections::BTreeMap;
use std::fs;
use std::path::Path;

use voidwalk::run::FolderKind;

use super::program::{call, done, figures_are_listed};

/// A narrow scene, so that a replicate takes milliseconds.
const SMALL: [&str; 6] = ["--set", "network.nx=8", "--set", "network.ny=8", "--set", "network.nz=10"];

fn refused(folder: &Path, args: &[&str], message: &str) {
    let output = call(folder, args);
    let stderr = String::from_utf8_lossy(&output.stderr);
    assert_eq!(output.status.code(), Some(2), "{args:?}: {stderr}");
    assert!(stderr.contains(message), "{args:?}: {stderr}");
}

/// Rows of a CSV file by column name.
fn rows(folder: &Path, name: &str) -> Vec<BTreeMap<String, String>> {
    let mut reader = csv::Reader::from_path(folder.join(name)).unwrap();
    reader.deserialize().map(|row| row.unwrap()).collect()
}

fn number(row: &BTreeMap<String, String>, column: &str) -> f64 {
    row[column].parse().unwrap_or_else(|_| panic!("{column} of {row:?}"))
}

/// 128 networks a line. At the fixed seed; over seeds one in a few hundred would have a deviation above four standard errors on
/// some network.
#[test]
fn every_engine_meets_the_exact_answers() {
    let root = tempfile::tempdir().unwrap();
    let args = [&["precision", "--tier", "exact", "--budget", "6s", "--out", "out"], &SMALL[..]].concat();
    done(&call(root.path(), &args));
    let out = root.path().join("out");
    let slopes = rows(&out, "exact_slopes.csv");
    let engines: Vec<&str> = slopes.iter().map(|row| row["engine"].as_str()).collect();
    assert_eq!(
        engines,
        ["particles", "counts", "expected", "one at a time", "particles", "counts", "expected"]
    );
    for row in &slopes {
        let slope = number(row, "slope");
        if row["engine"] == "expected" {
            // Nothing is drawn: rounding to whole numbers, as 1 / particles.
            assert!((-1.1..-0.9).contains(&slope), "{row:?}");
            assert!(row["largest_z"].is_empty());
        } else {
            assert!((-0.6..-0.4).contains(&slope), "{row:?}");
        }
    }
    let networks = rows(&out, "exact_networks.csv");
    assert_eq!(networks.len(), 7 * 128);
    let z: Vec<f64> =
        networks.iter().filter(|row| !row["z"].is_empty()).map(|row| number(row, "z")).collect();
    assert!(
        z.len() > 400 && z.iter().all(|z| z.abs() < 4.0),
        "{:?}",
        z.iter().fold(0.0, |m: f64, z| m.max(z.abs()))
    );
    for row in rows(&out, "exact.csv").iter().filter(|row| row["engine"] != "expected") {
        // 128 deviations: a ratio of 1 +- 0.06.
        let ratio = number(row, "error") / number(row, "expected_error");
        assert!((0.7..1.35).contains(&ratio), "{row:?}");
    }
    let closed = rows(&out, "exact_closed.csv");
    assert!(closed.len() >= 8 && closed.iter().all(|row| row["holds"] == "true"), "{closed:?}");
}

/// Every table but for its times and what is worked out from them.
fn without_times(folder: &Path) -> BTreeMap<String, Vec<BTreeMap<String, String>>> {
    let mut tables = BTreeMap::new();
    for entry in fs::read_dir(folder).unwrap() {
        let name = entry.unwrap().file_name().into_string().unwrap();
        if name.ends_with(".csv") {
            let mut table = rows(folder, &name);
            for row in &mut table {
                row.retain(|column, _| !column.contains("seconds") && !column.contains("merit"));
            }
            tables.insert(name, table);
        }
    }
    tables
}

#[test]
fn threads_change_nothing_but_times_and_the_page_shows_every_tier() {
    let root = tempfile::tempdir().unwrap();
    let run = |threads: &str, out: &str| {
        let args = [
            &["precision", "--budget", "2s", "--threads", threads, "--out", out, "--tier"],
            &TIERS[..],
            &SMALL,
        ]
        .concat();
        let output = call(root.path(), &args);
        done(&output);
        String::from_utf8(output.stderr).unwrap()
    };
    const TIERS: [&str; 4] = ["sampling", "bias", "decision", "scaling"];
    let told = run("1", "one");
    run("2", "two");
    assert!(TIERS.iter().all(|tier| told.contains(&format!("  {tier}: "))), "{told}");
    let (one, two) = (root.path().join("one"), root.path().join("two"));
    figures_are_listed(FolderKind::Precision, &one);
    let tables = without_times(&one);
    assert_eq!(tables, without_times(&two));
    let names: Vec<&str> = tables.keys().map(String::as_str).collect();
    assert_eq!(
        names,
        [
            "bias.csv",
            "decision.csv",
            "decision_cases.csv",
            "sampling.csv",
            "sampling_merit.csv",
            "scaling.csv"
        ]
    );

    // All ways of drawing have one law: the same networks, four standard errors.
    for line in tables["sampling_merit.csv"].iter().filter(|line| !line["difference_error"].is_empty()) {
        let (off, error) = (number(line, "difference"), number(line, "difference_error"));
        assert!(error > 0.0 && off.abs() <= 4.0 * error, "{line:?}");
        // All particles share a network: a binomial of them is too small by far.
        assert!(
            line["networks"] == "one network" || number(line, "sd") > 4.0 * number(line, "binomial"),
            "{line:?}"
        );
    }
    let factors: Vec<&str> = tables["bias.csv"].iter().map(|row| row["factor"].as_str()).collect();
    for factor in [
        "reference",
        "base particles",
        "cross-section",
        "length",
        "injection",
        "constriction sampling",
        "precision",
        "blocking",
    ] {
        assert!(factors.contains(&factor), "{factor}: {factors:?}");
    }
    let columns: Vec<&String> = tables["bias.csv"][0].keys().collect();
    assert_eq!(
        columns,
        [
            "at",
            "bias",
            "bias_high",
            "bias_low",
            "factor",
            "level",
            "n_base",
            "paired",
            "reference",
            "replicates",
            "value"
        ]
    );

    let page = fs::read_to_string(one.join("precision.html")).unwrap();
    for heading in [
        "Scatter of this scene",
        "What settings do to the answer",
        "Wrong verdicts",
        "What a larger problem costs",
    ] {
        assert!(page.contains(heading), "{heading}");
    }
    assert!(
        !page.contains("<script") && page.contains("slope −1/2") && !page.contains("Against exact answers")
    );
    assert!(one.join("figures/sampling-new-networks.svg").is_file());

    // The page is made of precision.json alone.
    fs::remove_file(one.join("precision.html")).unwrap();
    done(&call(root.path(), &["report", "one"]));
    assert_eq!(fs::read_to_string(one.join("precision.html")).unwrap(), page);

    refused(root.path(), &["precision", "--out", "one"], "holds a precision study already");
    refused(root.path(), &["run", "--out", "one"], "holds a precision study");
}

#[test]
fn packings_settle_and_triangulations_keep_their_identities() {
    let root = tempfile::tempdir().unwrap();
    done(&call(
        root.path(),
        &["precision", "--tier", "packing", "--budget", "1s", "--out", "out", "--quiet"],
    ));
    let packings = rows(&root.path().join("out"), "packing.csv");
    assert_eq!(packings.len(), 10);
    for row in &packings {
        assert!((0.5..0.8).contains(&number(row, "void_ratio")), "{row:?}");
        assert_eq!(row["settled"], row["seeds"], "{row:?}");
    }
    let triangulations = rows(&root.path().join("out"), "triangulation.csv");
    assert!(triangulations.len() >= 5 && triangulations.iter().all(|row| row["identities_hold"] == "true"));
}

#[test]
fn what_cannot_be_is_refused_before_any_work() {
    let root = tempfile::tempdir().unwrap();
    for (args, message) in [
        (
            vec!["--tier", "speed"],
            "there is no such tier; allowed: exact, sampling, bias, decision, scaling, packing",
        ),
        (vec!["--budget", "0s"], "from 100ms to 7days"),
        (vec!["--budget", "soon"], "write a time as"),
        (vec!["--threads", "0"], "--threads"),
        (vec!["missing.toml"], "missing.toml"),
        (vec!["--set", "base.cu=0.5"], "base.cu"),
        (vec!["--set", "network.nx=1e10"], "network.nx"),
        (vec!["--set", "walk.arching=zuriguel-2005"], "walk.arching: allowed: none"),
        (vec!["--set", "walk.blocked=open"], "walk.blocked: allowed: \"closed\""),
    ] {
        refused(root.path(), &[&["precision"], &args[..]].concat(), message);
    }
    assert!(!root.path().join("voidwalk-precision").exists());
    fs::create_dir(root.path().join("other")).unwrap();
    fs::write(root.path().join("other/notes.txt"), "mine").unwrap();
    refused(root.path(), &["precision", "--out", "other"], "not made by voidwalk");
    fs::create_dir(root.path().join("run")).unwrap();
    for name in ["outcome.json", "manifest.json"] {
        fs::write(root.path().join("run").join(name), "{}").unwrap();
    }
    refused(root.path(), &["precision", "--out", "run"], "holds a run; name another folder");
}
