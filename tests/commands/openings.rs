//! Openings beside particles as a user meets them: what is walked, written and said, and what is refused.

use std::fs;
use std::path::Path;

use serde_json::Value;

use crate::judge::{SMALL, soils};
use crate::program::{call, done, refused};

const SCENE: &str = "replicates = 2\nseed = 5\n[filter]\ncurve = \"cu1.5-loose\"\n[base]\ncu = 3\n\
    d15f_over_d85b = 5\nn_base = 20000\n[network]\nnx = 8\nny = 8\nnz = 10\n[record]\nsensitivity = []\n";

fn walked(at: &Path, name: &str, more: &[&str]) -> Value {
    let words = ["run", "s.toml", "--overwrite", "--out", name];
    done(&call(at, &[&words[..], more].concat()));
    serde_json::from_slice(&fs::read(at.join(name).join("outcome.json")).unwrap()).unwrap()
}

fn run(outcome: &Value, run: usize, of: &str) -> f64 {
    outcome["replicates"][0]["runs"][run][of].as_f64().unwrap()
}

#[test]
fn openings_are_walked_and_said() {
    let root = tempfile::tempdir().unwrap();
    let at = root.path();
    fs::write(at.join("s.toml"), SCENE).unwrap();
    let unsaid = walked(at, "unsaid", &[]);
    let closed = walked(at, "closed", &["--set", "walk.blocked=closed"]);
    assert_eq!(unsaid["summary"], closed["summary"]);
    assert!(closed["model_leaves_out"].to_string().contains("partial_clogging"));
    let open = walked(at, "open", &["--set", "walk.blocked=open"]);
    assert!(!open["model_leaves_out"].to_string().contains("partial_clogging"));
    assert!(open["left_out"].to_string().contains("openings"), "{}", open["left_out"]);
    let notes = open["notes"].as_array().unwrap();
    assert!(notes.iter().any(|note| note["id"] == "openings"), "{notes:?}");
    for at in [0, 1] {
        let all = ["eroded", "retained_in_constrictions", "retained_in_voids", "trapped"];
        assert_eq!(all.map(|of| run(&open, at, of)).iter().sum::<f64>(), run(&open, at, "inserted"));
    }
    // The first increments differ in nothing but what is chosen beside a particle; then openings stop more.
    assert!(run(&closed, 0, "retained_in_voids") > 0.0);
    assert_eq!(run(&open, 0, "retained_in_voids"), 0.0);
    assert!(run(&open, 0, "retained_in_constrictions") > run(&closed, 0, "retained_in_constrictions"));
    let threads = walked(at, "threads", &["--set", "walk.blocked=open", "--threads", "3"]);
    assert_eq!(threads["summary"], open["summary"]);
    // With water, and with arches.
    let flux = ["--set", "walk.blocked=open", "--set", "walk.exit=flux"];
    let [sealed, flowing] =
        [&flux[2..], &flux[..]].map(|more| run(&walked(at, "flux", more), 1, "k_over_k0"));
    assert!(flowing > sealed, "{flowing} {sealed}");
    let law = ["--set", "walk.arching=marin-2018", "--set", "walk.concentration=0.1"];
    let arches = walked(at, "arches", &[&flux[..2], &law].concat());
    assert!(run(&arches, 0, "arches") > 0.0);
}

fn json(path: &Path) -> Value {
    serde_json::from_slice(&fs::read(path).unwrap()).unwrap()
}

/// However the value is quoted.
#[test]
fn a_table_of_filters_says_what_openings_change() {
    let (_root, at) = soils();
    let table = |blocked: &str| {
        let files = ["base.csv", "fine.csv", "coarse.csv", "--set", blocked];
        let said =
            call(&at, &[&["judge", "--quick", "--overwrite", "--out", "c"][..], &SMALL, &files].concat());
        done(&said);
        (String::from_utf8(said.stdout).unwrap(), json(&at.join("c/batch.json")))
    };
    let (text, closed) = table("walk.blocked='closed'");
    assert!(closed["model_leaves_out"].to_string().contains("partial_clogging"), "{closed}");
    assert!(text.contains("it leaves out hydraulics, gradient, bridging, "), "{text}");
    let (_, open) = table("walk.blocked='open'");
    assert!(!open["model_leaves_out"].to_string().contains("partial_clogging"));
    for row in open["rows"].as_array().unwrap() {
        let outcome = json(&at.join("c").join(row["walk"]["folder"].as_str().unwrap()).join("outcome.json"));
        assert!(outcome["notes"].to_string().contains("openings"), "{row}");
    }
}

#[test]
fn boundaries_with_openings_say_so() {
    let (_root, at) = soils();
    let words = ["boundary", "base.csv", "--filter", "cu1.5-loose", "--thickness", "8layers", "--out", "d"];
    let few = ["--set", "replicates=2", "--set", "filter.grains_per_void=0.6"];
    let open = ["--set", "walk.blocked='open'", "--set", "base.n_base=20000"];
    done(&call(&at, &[&words[..], &SMALL[..4], &few, &open].concat()));
    let all = json(&at.join("d/boundary.json"));
    assert_eq!(all["engine"], "auto");
    assert!(!all["model_leaves_out"].to_string().contains("partial_clogging"));
    assert!(all["model_leaves_out"].to_string().contains("bridging"));
    let found = all["notes"].to_string();
    assert!(found.contains("\"openings\""), "{found}");
}

#[test]
fn what_openings_cannot_be_with_is_refused() {
    let root = tempfile::tempdir().unwrap();
    let at = root.path();
    fs::write(at.join("s.toml"), SCENE).unwrap();
    fs::write(at.join("b.csv"), "mm,percent\n2,100\n1,60\n0.5,20\n").unwrap();
    let refusal = |command: &str, more: &[&str], says: &str| {
        let said = call(at, &[&[command, "s.toml", "--out", "r"][..], more].concat());
        refused(&said, says);
        assert!(!at.join("r").exists());
    };
    let open = ["--set", "walk.blocked=open"];
    let with = |more: &'static str| [&open[..], &["--set", more]].concat();
    refusal("run", &["--set", "walk.blocked=half"], "\"closed\" or \"open\"");
    refusal("run", &with("engine=counts"), "\"particles\" or \"auto\"");
    refusal("run", &with("engine=expected"), "\"particles\" or \"auto\"");
    refusal("run", &[&with("walk.rho=0.1")[..], &["--set", "walk.exit=flux"]].concat(), "walk.rho");
    let exponent = [&with("walk.conductance_exponent=3")[..], &["--set", "walk.exit=flux"]].concat();
    refusal("run", &exponent, "walk.conductance_exponent says nothing where walk.blocked is");
    refusal("run", &with("base.sieve=b.csv"), "needs the sizes of the whole base");
}
