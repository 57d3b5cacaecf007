//! `judge --each`: many samples against filters, walked, in one table.

use std::fs;
use std::path::{Path, PathBuf};
use std::process::Output;
use std::time::{Duration, SystemTime};

use serde_json::Value;
use voidwalk::run::FolderKind;

use crate::judge::SMALL;
use crate::program::{call, done, figures_are_listed, refused, voidwalk};

const SAMPLES: &str = "Sieve (mm),Core,Shell,Till,Sand,Gravel\n30,100,100,100,100,100\n10,100,100,100,100,0\n\
    1,100,100,100,100,0\n0.5,100,80,60,40,0\n0.25,40,20,10,5,0\n0.1,0,0,0,0,0\n";

/// Samples and two filters; the gravel is coarser than either.
fn site() -> (tempfile::TempDir, PathBuf) {
    let root = tempfile::tempdir().unwrap();
    for (name, text) in [
        ("samples.csv", SAMPLES.to_owned()),
        ("other.csv", SAMPLES.replace("60,40", "70,40")),
        ("fine.csv", "opening_mm,percent_finer\n4,100\n2,50\n1,0\n".into()),
        ("coarse.csv", "opening_mm,percent_finer\n8,100\n4,50\n2,0\n".into()),
        ("band.csv", "opening_mm,a,b\n1,15,0\n2,60,15\n4,100,60\n8,100,100\n".into()),
    ] {
        fs::write(root.path().join(name), text).unwrap();
    }
    let path = root.path().to_owned();
    (root, path)
}

const FEW: [&str; 4] = ["--set", "replicates=2", "--set", "record.sensitivity=[]"];

fn words<'a>(samples: &'a str, filters: &[&'a str], out: &'a str) -> Vec<&'a str> {
    let each = ["--each", "--out", out];
    [&["judge", samples], filters, &each, &SMALL, &FEW].concat()
}

fn judged(at: &Path, words: &[&str]) -> Output {
    let output = call(at, words);
    done(&output);
    output
}

fn record(folder: &Path) -> Value {
    serde_json::from_slice(&fs::read(folder.join("batch.json")).unwrap()).unwrap()
}

/// Everything that a batch says, which no kill changes.
fn tables(folder: &Path) -> [Vec<u8>; 3] {
    ["batch.csv", "batch.json", "batch.html"].map(|name| fs::read(folder.join(name)).unwrap())
}

/// When each pair was walked.
fn moments(folder: &Path) -> Vec<SystemTime> {
    let cases = fs::read_dir(folder.join("pairs/cases")).unwrap();
    let outcomes = cases.map(|case| case.unwrap().path().join("outcome.json"));
    let mut all: Vec<_> = outcomes.map(|file| fs::metadata(file).unwrap().modified().unwrap()).collect();
    all.sort();
    all
}

#[test]
fn a_row_says_what_rules_and_walk_say_of_that_pair_alone() {
    let (_root, at) = site();
    let all = words("samples.csv", &["fine.csv", "coarse.csv"], "b");
    let said = String::from_utf8(judged(&at, &all).stdout).unwrap();
    let batch = record(&at.join("b"));
    let rows = batch["rows"].as_array().unwrap();
    assert_eq!((rows.len(), moments(&at.join("b")).len()), (10, 8));
    assert!(said.contains("fine.csv: of 5 samples 4 met, 0 not met, 1 without a result"), "{said}");
    assert!(said.contains("governing sample Core: D15F up to 1.68 mm"), "{said}");
    assert!(said.contains("nothing applied, as base and filter look exchanged: Gravel"), "{said}");
    assert!(!said.contains("may govern"), "{said}");
    assert!(
        said.contains("  4 walked (3 in full, 1 first look): ") && said.contains("; 1 not walked\n"),
        "{said}"
    );
    assert!(said.contains("not walked; base and filter look exchanged"), "{said}");
    assert!(said.contains("--as-given walks pairs that look exchanged"), "{said}");
    let row = |sample: &str, filter: &str| {
        rows.iter().find(|row| row["sample"] == sample && row["filter"] == filter).unwrap()
    };
    // The three with the least limit are walked in full, the others are a first look, and what looks
    // exchanged is not walked.
    for (sample, governs, in_full) in [("Core", 1, true), ("Shell", 2, true), ("Till", 3, true)] {
        let row = row(sample, "coarse.csv");
        assert_eq!(
            (row["governs"].as_u64(), row["walk"]["in_full"].as_bool()),
            (Some(governs), Some(in_full))
        );
    }
    let sand = row("Sand", "coarse.csv");
    assert_eq!((&sand["governs"], &sand["walk"]["in_full"]), (&Value::Null, &Value::from(false)));
    let gravel = row("Gravel", "fine.csv");
    assert!(gravel["walk"].is_null() && gravel["not_walked"].as_str().unwrap().contains("look exchanged"));
    let one = |sample: &str, quick: &[&str]| -> Value {
        let sheet = format!("samples.csv#{sample}");
        let out = format!("one-{sample}");
        judged(&at, &[&["judge", &sheet, "coarse.csv", "--out", &out][..], &SMALL, &FEW, quick].concat());
        serde_json::from_slice(&fs::read(at.join(out).join("outcome.json")).unwrap()).unwrap()
    };
    for (sample, quick) in [("Shell", &[][..]), ("Sand", &["--quick"])] {
        let (alone, walk) = (one(sample, quick), &row(sample, "coarse.csv")["walk"]);
        assert_eq!((&alone["model"]["class"], &alone["headline"]), (&walk["verdict"], &walk["headline"]));
        let eroded = &alone["summary"][0]["eroded_mass_fraction"];
        assert_eq!(*eroded, walk["runs"][0], "{sample}");
        assert_eq!(alone["curve_range"]["eroded_mass_fraction"], walk["curve_range"]);
        let place = at.join("b").join(walk["folder"].as_str().unwrap());
        assert!(place.join("report.html").is_file());
    }
    // The rules are those of `rules --each`.
    let table = ["rules", "samples.csv", "fine.csv", "coarse.csv", "--each", "--csv", "t.csv"];
    judged(&at, &table);
    let csv = fs::read_to_string(at.join("b/batch.csv")).unwrap();
    for (of_rules, of_batch) in fs::read_to_string(at.join("t.csv")).unwrap().lines().zip(csv.lines()) {
        assert!(of_batch.starts_with(of_rules), "{of_batch}: {of_rules}");
    }
    let page = fs::read_to_string(at.join("b/batch.html")).unwrap();
    assert!(!page.contains("--as-given"), "a word of the command line");
    for words in [
        "not walked",
        "(3 in full, 1 first look)",
        "Governing sample",
        "Class by walk",
        "/report.html\"",
        "D15F of the filter / limit",
    ] {
        assert!(page.contains(words), "{words}");
    }
    figures_are_listed(FolderKind::Batch, &at.join("b"));
    // Again: the same words, and nothing is walked again.
    let before = (tables(&at.join("b")), moments(&at.join("b")));
    assert_eq!(String::from_utf8(judged(&at, &all).stdout).unwrap(), said);
    assert_eq!((tables(&at.join("b")), moments(&at.join("b"))), before);
    // The page is made again from the record alone.
    fs::remove_file(at.join("b/batch.html")).unwrap();
    judged(&at, &["report", "b"]);
    assert_eq!(tables(&at.join("b")), before.0);
}

#[test]
fn killed_at_any_time_and_continued_the_table_is_the_same() {
    let (_root, at) = site();
    let filters = ["fine.csv", "coarse.csv"];
    judged(&at, &words("samples.csv", &filters, "whole"));
    let expected = tables(&at.join("whole"));
    let again = words("samples.csv", &filters, "killed");
    for millis in [30, 250, 700, 1500] {
        let mut process = voidwalk(&at, &again).spawn().unwrap();
        std::thread::sleep(Duration::from_millis(millis));
        // It may have ended by then.
        let _ = process.kill();
        process.wait().unwrap();
    }
    let other = |of: &str| fs::write(at.join("killed/.voidwalk.unfinished"), of).unwrap();
    judged(&at, &again);
    assert!(tables(&at.join("killed")) == expected);
    // Without its record it goes on, and what is walked stays; an unfinished batch of other work is kept.
    let walked = moments(&at.join("killed"));
    fs::remove_file(at.join("killed/batch.json")).unwrap();
    judged(&at, &again);
    assert!(tables(&at.join("killed")) == expected && moments(&at.join("killed")) == walked);
    // Killed when all but the end of its mark was written, and a case harmed since: it is walked again.
    other(&format!("{{\"kind\": \"batch\", \"work\": {}}}", record(&at.join("killed"))["work"]));
    let mut cases: Vec<_> = fs::read_dir(at.join("killed/pairs/cases")).unwrap().flatten().collect();
    cases.sort_by_key(|case| case.file_name());
    let harmed = cases[0].path().join("case.json");
    let whole = fs::read(&harmed).unwrap();
    fs::write(&harmed, &whole[..whole.len() / 2]).unwrap();
    judged(&at, &again);
    assert!(tables(&at.join("killed")) == expected && moments(&at.join("killed")) != walked);
    let fingerprint = |case: &[u8]| serde_json::from_slice::<Value>(case).unwrap()["fingerprint"].clone();
    assert_eq!(fingerprint(&fs::read(&harmed).unwrap()), fingerprint(&whole));
    other("{\"kind\": \"batch\", \"work\": \"other\"}");
    refused(&call(&at, &again), "holds another batch");
}

#[test]
fn other_samples_filters_and_settings_are_refused_and_nothing_changes() {
    let (_root, at) = site();
    let quick = |samples, filters: &[&'static str]| [words(samples, filters, "b"), vec!["--quick"]].concat();
    judged(&at, &quick("samples.csv", &["fine.csv"]));
    let before = (tables(&at.join("b")), moments(&at.join("b")));
    for other in [
        quick("other.csv", &["fine.csv"]),
        quick("samples.csv", &["coarse.csv"]),
        quick("samples.csv", &["fine.csv", "coarse.csv"]),
        [quick("samples.csv", &["fine.csv"]), vec!["--seed", "7"]].concat(),
        words("samples.csv", &["fine.csv"], "b"),
    ] {
        refused(&call(&at, &other), "holds another batch; name another folder");
    }
    assert!((tables(&at.join("b")), moments(&at.join("b"))) == before);
    // No file is written before these are refused.
    for (words, says) in [
        (
            vec!["judge", "samples.csv", "fine.csv", "coarse.csv", "--out", "n"],
            "holds 5 soils; name one of them as FILE#NAME, or add --each",
        ),
        (words("samples.csv", &["fine.csv", "./fine.csv"], "n"), "is named twice"),
        (words("samples.csv#Gravel", &["fine.csv"], "n"), "no pair of a sample and a filter can be walked"),
        (words("samples.csv", &["band.csv"], "n"), "the filter is an envelope"),
        ([words("samples.csv", &["fine.csv"], "n"), vec!["--set", "network.nx=0"]].concat(), "network.nx"),
        (vec!["judge", "samples.csv", "fine.csv", "--governing"], "--each"),
    ] {
        refused(&call(&at, &words), says);
        assert!(!at.join("n").exists(), "{says}");
    }
    // Another one takes the folder where that is asked for.
    judged(&at, &[quick("other.csv", &["fine.csv"]), vec!["--overwrite"]].concat());
    assert!(tables(&at.join("b")) != before.0);
}

/// Each pair is walked as `judge` walks it alone.
#[test]
fn several_filters_of_one_base_make_one_table() {
    let (_root, at) = site();
    fs::write(at.join("a<b>.csv"), "opening_mm,percent_finer\n8,100\n4,50\n2,0\n").unwrap();
    let filters = ["fine.csv", "coarse.csv", "a<b>.csv"];
    let base = "samples.csv#Core";
    let words = [&["judge", base], &filters[..], &["--quick", "--out", "t"], &SMALL].concat();
    let said = String::from_utf8(judged(&at, &words).stdout).unwrap();
    let batch = record(&at.join("t"));
    let rows = batch["rows"].as_array().unwrap();
    assert_eq!((rows.len(), batch["filters"].as_array().unwrap().len()), (3, 3));
    for (row, filter) in rows.iter().zip(filters) {
        let alone = ["judge", base, filter, "--quick", "--overwrite", "--out", "one", "--json"];
        let alone = judged(&at, &[&alone[..], &SMALL].concat());
        let alone: Value = serde_json::from_slice(&alone.stdout).unwrap();
        let walk = &row["walk"];
        assert_eq!((&walk["verdict"], &walk["headline"]), (&alone["model"]["class"], &alone["headline"]));
        assert_eq!(walk["runs"][0], alone["summary"][0]["eroded_mass_fraction"], "{filter}");
        let headline = alone["headline"].as_str().unwrap();
        assert!(said.contains(&format!("{filter}: {headline}; ")), "{said}");
    }
    let page = fs::read_to_string(at.join("t/batch.html")).unwrap();
    assert!(page.contains("Which of these filters hold this base?") && !page.contains("Governing sample"));
    assert!(!page.contains("a<b>") && page.contains("a&lt;b&gt;"), "{page}");
    assert!(at.join("t/figures/batch-curves.svg").is_file());
    let before = (tables(&at.join("t")), moments(&at.join("t")));
    // With --each one soil is a sample as any other.
    let each = ["judge", base, "fine.csv", "--each", "--quick", "--out", "each"];
    judged(&at, &[&each[..], &SMALL].concat());
    let page = fs::read_to_string(at.join("each/batch.html")).unwrap();
    assert!(page.contains("Which samples do these filters hold?") && page.contains("Governing sample"));
    // The same command finds it done, and an envelope as the base is refused.
    judged(&at, &words);
    assert!((tables(&at.join("t")), moments(&at.join("t"))) == before);
    let envelope = ["judge", "samples.csv", "fine.csv", "coarse.csv", "--out", "n"];
    refused(&call(&at, &envelope), "holds 5 soils");
}

#[test]
fn those_that_govern_can_be_walked_alone_and_a_verdict_can_be_refused() {
    let (_root, at) = site();
    let alone =
        [words("samples.csv", &["fine.csv", "band.csv"], "b"), vec!["--governing", "--json"]].concat();
    let batch: Value = serde_json::from_slice(&judged(&at, &alone).stdout).unwrap();
    let rows = batch["rows"].as_array().unwrap();
    let reason = |filter: &str, sample: &str| {
        let row = rows.iter().find(|row| row["filter"] == filter && row["sample"] == sample).unwrap();
        row["not_walked"].as_str().unwrap_or_default().to_owned()
    };
    assert_eq!(moments(&at.join("b")).len(), 3);
    assert_eq!(
        (reason("fine.csv", "Core").as_str(), reason("fine.csv", "Sand").as_str()),
        ("", "does not govern")
    );
    assert!(reason("band.csv", "Core").contains("envelope"));
    let doubt = call(
        &at,
        &[words("samples.csv", &["fine.csv", "band.csv"], "b"), vec!["--governing", "--fail-on", "some"]]
            .concat(),
    );
    assert_eq!(doubt.status.code(), Some(4));
    let said = String::from_utf8_lossy(&doubt.stderr);
    // The envelope was not walked, which is no answer; what does not govern was left out on purpose.
    assert!(said.contains("Core in band.csv: not walked (the filter is an envelope"), "{said}");
    assert!(!said.contains("Sand in fine.csv") && said.contains("Gravel in fine.csv: not walked"), "{said}");
}
