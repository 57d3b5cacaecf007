//! `compare`: cases side by side, on the same random numbers.

use std::fs;
use std::os::unix::fs::MetadataExt;
use std::path::Path;

use serde_json::Value;
use voidwalk::run::FolderKind;

use crate::judge::{COARSE, SMALL, soils};
use crate::program::{call, done, figures_are_listed, refused, voidwalk};

fn compare(at: &Path, more: &[&str]) -> std::process::Output {
    call(at, &[&["compare", "--quick", "--out", "c"][..], &SMALL, more].concat())
}

fn json(path: &Path) -> Value {
    serde_json::from_slice(&fs::read(path).unwrap()).unwrap()
}

#[test]
fn filters_are_compared_on_the_same_random_numbers() {
    let (_root, at) = soils();
    // The same table under another name, and one that would be markup.
    fs::write(at.join("a<b>.csv"), COARSE).unwrap();
    let named = ["--base", "base.csv", "fine.csv", "coarse.csv", "a<b>.csv"];
    let said = compare(&at, &named);
    done(&said);
    let text = String::from_utf8(said.stdout).unwrap();
    assert!(text.contains("fine erodes") && text.contains("less than coarse"), "{text}");
    assert!(text.contains("Not in these intervals: how far the constriction curve"), "{text}");
    assert!(text.contains("first run over the range of the constriction curve: "), "{text}");
    let record = json(&at.join("c/compare.json"));
    let pairs = record["pairs"].as_array().unwrap();
    assert_eq!(pairs.len(), 6);
    let [fine, same] = [&pairs[0], &pairs[4]];
    assert_eq!(
        (&fine["first"], &fine["second"], &fine["differ"]),
        (&"fine".into(), &"coarse".into(), &true.into())
    );
    assert_eq!((&same["first"], &same["second"]), (&"coarse".into(), &"a<b>".into()));
    // Replicate by replicate the same: nothing of chance is left.
    assert_eq!((&same["difference"]["mean"], &same["difference"]["sd"]), (&0.0.into(), &0.0.into()));
    let page = fs::read_to_string(at.join("c/compare.html")).unwrap();
    assert!(!page.contains("filter.density") && page.contains("The model leaves out: "));
    assert!(!page.contains("a<b>") && page.contains("a&lt;b&gt;"));
    assert!(page.contains("href=\"walks/cases/fine/report.html\""), "each case has its page");
    figures_are_listed(FolderKind::Comparison, &at.join("c"));
    done(&call(&at, &["report", "c"]));
    done(&call(&at, &["report", "c/walks/cases/fine"]));
    refused(&compare(&at, &["--base", "base.csv", "fine.csv", "coarse.csv"]), "holds a comparison already");
    refused(&call(&at, &["judge", "base.csv", "fine.csv", "--out", "c"]), "holds a comparison; name another");
}

/// A case that is done stays as it is, to the very file.
#[test]
fn what_was_cut_short_continues_and_keeps_what_is_done() {
    let (_root, at) = soils();
    let files = ["--base", "base.csv", "fine.csv", "coarse.csv"];
    done(&compare(&at, &files));
    let number =
        |case: &str| fs::metadata(at.join("c/walks/cases").join(case).join("outcome.json")).unwrap().ino();
    let (kept, whole) = (number("fine"), json(&at.join("c/compare.json")));
    // As a kill leaves it before the second case is done.
    fs::remove_file(at.join("c/compare.json")).unwrap();
    fs::remove_dir_all(at.join("c/walks/cases/coarse")).unwrap();
    done(&compare(&at, &files));
    assert_eq!((number("fine"), json(&at.join("c/compare.json"))), (kept, whole));
    done(&compare(&at, &["--overwrite", "--base", "base.csv", "coarse.csv", "fine.csv"]));
    assert_eq!(number("fine"), kept);
}

#[test]
fn bases_and_scenes_are_compared_too() {
    let (_root, at) = soils();
    fs::write(at.join("other.csv"), "size_mm,percent\n0.1,0\n0.2,40\n0.3,100\n").unwrap();
    done(&compare(&at, &["--filter", "fine.csv", "base.csv", "other.csv", "-q"]));
    assert_eq!(json(&at.join("c/compare.json"))["of"], "bases");
    for (name, seed) in [("a.toml", 5), ("b.toml", 6)] {
        let scene = format!(
            "seed = {seed}\nreplicates = 3\n[filter]\ncurve = \"cu3-loose\"\n\
            [base]\ncu = {seed}\nd85_at_dc = 5\n"
        );
        fs::write(at.join(name), scene).unwrap();
    }
    let scenes = [&["compare", "a.toml", "b.toml", "--quick", "--out", "s", "--json"][..], &SMALL].concat();
    let said = call(&at, &scenes);
    done(&said);
    assert!(String::from_utf8_lossy(&said.stderr).contains("all are walked with seed 5"));
    let record: Value = serde_json::from_slice(&said.stdout).unwrap();
    assert_eq!((&record["seed"], record["cases"].as_array().unwrap().len()), (&5.into(), 2));
}

/// What `run` prints beside a verdict stands beside it here too; one replicate is within no checked range.
#[test]
fn what_stands_beside_a_verdict_stands_beside_it_here() {
    let (_root, at) = soils();
    for (name, dc) in [("a", 40), ("b", 45)] {
        let base = format!("[base]\ncu = 1.5\nd85_at_dc = {dc}\n");
        fs::write(
            at.join(format!("{name}.toml")),
            format!("[filter]\nd0_mm = 2\ncurve = \"cu1.5-loose\"\n{base}"),
        )
        .unwrap();
    }
    let compare = |replicates: &str| {
        let words = ["compare", "a.toml", "b.toml", "--overwrite", "--out", "c", "--set", replicates];
        // As wide as none is in doubt for.
        let wide = ["--set", "network.nx=10", "--set", "network.ny=10"];
        let said = call(&at, &[&words[..], &SMALL, &wide].concat());
        done(&said);
        let page = fs::read_to_string(at.join("c/compare.html")).unwrap();
        (String::from_utf8(said.stdout).unwrap(), page, json(&at.join("c/compare.json")))
    };
    let (text, page, record) = compare("replicates=5");
    assert!(page.contains("Thickness"), "{text}");
    for face in [&text, &page] {
        assert!(face.contains("meets the rules checked: D15F"), "{face}");
    }
    assert_eq!(record["cases"][1]["headline"], "meets the rules checked");
    let (_, _, record) = compare("replicates=1");
    assert!(record["cases"][0]["notes"].to_string().contains("one_replicate"));
}

#[test]
fn what_is_wrong_with_one_case_is_refused_before_any_is_walked() {
    let (_root, at) = soils();
    refused(&compare(&at, &["--base", "base.csv", "fine.csv"]), "compare 2 to 6");
    refused(&compare(&at, &["--base", "base.csv", "fine.csv", "fine.csv"]), "fine.csv is named twice");
    refused(&compare(&at, &["--base", "base.csv", "fine.csv", "no.csv"]), "case no: no.csv");
    refused(
        &compare(&at, &["--base", "base.csv", "--filter", "fine.csv", "coarse.csv"]),
        "cannot be used with",
    );
    let set = ["--base", "base.csv", "fine.csv", "coarse.csv", "--set", "filter.sieve=coarse.csv"];
    refused(&compare(&at, &set), "would put another soil in the place of the filter, fine.csv");
    refused(&compare(&at, &["--base", "base.csv", "fine.csv", "./fine.csv"]), "./fine.csv is named twice");
    assert!(!at.join("c").exists());
}

/// What is refused, for whatever reason, changes nothing that is there.
#[test]
fn a_comparison_that_cannot_be_walked_leaves_the_earlier_one() {
    let (_root, at) = soils();
    let files = ["--base", "base.csv", "fine.csv", "coarse.csv"];
    done(&compare(&at, &files));
    let names = ["compare.json", "compare.html", "compare.csv", "compare_pairs.csv"];
    let all = || names.map(|name| fs::read(at.join("c").join(name)).unwrap());
    let before = all();
    refused(&compare(&at, &[&files[..], &["--overwrite", "--memory", "10KB"]].concat()), "case fine: ");
    assert!(before == all());
    let new = call(&at, &[&["compare", "--out", "new", "--memory", "10KB"][..], &files].concat());
    refused(&new, "case fine: ");
    assert!(!at.join("new").exists());
}

/// Two comparisons do not take each other's folder without being told to.
#[test]
fn an_unfinished_comparison_is_gone_on_with_by_itself_alone() {
    let (_root, at) = soils();
    let files = ["--base", "base.csv", "fine.csv", "coarse.csv"];
    let long = [&files[..], &["--set", "replicates=40", "--threads", "1"]].concat();
    let words = [&["compare", "--quick", "--out", "c"][..], &SMALL, &long].concat();
    let mut child = voidwalk(&at, &words).spawn().unwrap();
    let mark = at.join("c/.voidwalk.unfinished");
    while !mark.exists() {
        assert!(child.try_wait().unwrap().is_none(), "it ended before it was killed");
        std::thread::sleep(std::time::Duration::from_millis(1));
    }
    child.kill().unwrap();
    child.wait().unwrap();
    let begun = fs::read(&mark).unwrap();
    refused(
        &compare(&at, &["--base", "base.csv", "coarse.csv", "fine.csv"]),
        "another comparison that is unfinished",
    );
    assert_eq!(fs::read(&mark).unwrap(), begun);
    done(&compare(&at, &long));
    assert!(!mark.exists() && at.join("c/compare.html").is_file());
}

/// README: grains per void and thickness are printed with every verdict, and what the model leaves out.
#[test]
fn what_the_model_leaves_out_is_that_of_the_cases() {
    let (_root, at) = soils();
    for (name, exit) in [("dry", "area"), ("wet", "flux"), ("wetter", "flux")] {
        let scene = format!(
            "replicates = 2\n[filter]\ncurve = \"cu1.5-loose\"\n[base]\ncu = 1.5\nd85_at_dc = 40\n\
            [walk]\nexit = \"{exit}\"\n[record]\nsensitivity = []\n"
        );
        fs::write(at.join(format!("{name}.toml")), scene).unwrap();
    }
    let compare = |files: &[&str]| {
        let said = call(&at, &[&["compare", "--overwrite", "--out", "c"], &SMALL[..], files].concat());
        done(&said);
        let page = fs::read_to_string(at.join("c/compare.html")).unwrap();
        (String::from_utf8(said.stdout).unwrap(), page, json(&at.join("c/compare.json")))
    };
    let (text, page, record) = compare(&["wet.toml", "wetter.toml"]);
    assert!(text.contains("it leaves out gradient, bridging"), "{text}");
    assert!(text.contains(" grains per void") && page.contains("Grains per void"), "{text}");
    assert!(record["cases"][0]["grains_per_void"].as_f64().is_some());
    let left_out = record["model_leaves_out"].to_string();
    assert!(left_out.contains("gradient") && !left_out.contains("hydraulics"), "{left_out}");
    assert!(!page.contains("no flow") && page.contains("direction and the shares of slow flow"), "{page}");
    let table = fs::read_to_string(at.join("c/compare.csv")).unwrap();
    assert!(table.lines().next().unwrap().contains("grains_per_void,thickness_mm,folder"), "{table}");
    // Of both kinds, each is said.
    let (text, page, _) = compare(&["wet.toml", "dry.toml"]);
    assert!(text.contains("it leaves out hydraulics, gradient, "), "{text}");
    assert!(page.contains("slow flow") && page.contains("hydraulics, in the other cases"), "{page}");
}
