//! Arches as a user meets them: what is walked, written and said, and what is refused.

use std::fs;
use std::path::Path;

use serde_json::Value;
use voidwalk::walk::{LAWS, Law};

use crate::program::{call, done, refused};

const SCENE: &str = "replicates = 2\nseed = 5\n[filter]\ncurve = \"cu1.5-loose\"\n[base]\ncu = 1.5\nd15f_over_d85b = 7\n\
    [network]\nnx = 10\nny = 10\nnz = 12\n[record]\nsensitivity = []\n";

fn walked(at: &Path, name: &str, more: &[&str]) -> Value {
    let words = ["run", "s.toml", "--overwrite", "--out", name];
    done(&call(at, &[&words[..], more].concat()));
    serde_json::from_slice(&fs::read(at.join(name).join("outcome.json")).unwrap()).unwrap()
}

fn eroded(outcome: &Value, run: usize) -> f64 {
    outcome["summary"][run]["eroded_mass_fraction"]["mean"].as_f64().unwrap()
}

#[test]
fn a_law_holds_what_sieving_lets_pass_and_is_said() {
    let root = tempfile::tempdir().unwrap();
    let at = root.path();
    fs::write(at.join("s.toml"), SCENE).unwrap();
    let sieving = walked(at, "none", &["--set", "walk.arching=none"]);
    assert!(sieving.get("arching").is_none() && sieving["replicates"][0]["runs"][0].get("arches").is_none());
    let brief = sieving["model_leaves_out"].to_string();
    assert!(brief.contains("bridging"), "{brief}");
    // Finer than every constriction by far: nothing is held without arches.
    assert!(eroded(&sieving, 0) > 0.9, "{}", eroded(&sieving, 0));
    for law in ["zuriguel-2005", "critical-3"] {
        let arching = walked(at, law, &["--set", &format!("walk.arching={law}")]);
        assert!(eroded(&arching, 0) < 0.5 * eroded(&sieving, 0), "{law}");
        let said = &arching["arching"];
        assert_eq!(said["law"], law);
        assert_eq!(said["source"], Law::named(law).unwrap().source);
        assert_eq!(said["range_of_ratio"], serde_json::json!([1.0, Law::named(law).unwrap().widest]));
        let run = &arching["replicates"][0]["runs"][0];
        let [arches, inside, all] =
            ["arches", "retained_in_arches", "retained_in_constrictions"].map(|of| run[of].as_u64().unwrap());
        assert!(0 < arches && arches < inside && inside <= all, "{run}");
        let sum: u64 = ["eroded", "retained_in_constrictions", "retained_in_voids", "trapped"]
            .iter()
            .map(|of| run[of].as_u64().unwrap())
            .sum();
        assert_eq!(sum, run["inserted"].as_u64().unwrap());
        assert!(!arching["model_leaves_out"].to_string().contains("bridging"));
        let notes = arching["notes"].as_array().unwrap();
        assert!(notes.iter().any(|note| note["id"] == "arches"), "{notes:?}");
        // One thread or three, and every engine that walks the same particles.
        let threads = walked(at, "threads", &["--set", &format!("walk.arching={law}"), "--threads", "3"]);
        assert_eq!(threads["summary"], arching["summary"]);
    }
}

#[test]
fn every_law_is_named_for_programs() {
    let root = tempfile::tempdir().unwrap();
    let output = call(root.path(), &["init", "--json"]);
    done(&output);
    let reference: Value = serde_json::from_slice(&output.stdout).unwrap();
    let sections = reference["sections"].as_array().unwrap();
    let mut settings = sections.iter().flat_map(|section| section["settings"].as_array().unwrap());
    let arching = settings.find(|setting| setting["name"] == "walk.arching").unwrap();
    let allowed = arching["allowed"].as_str().unwrap();
    for law in ["none"].into_iter().chain(LAWS.iter().map(|law| law.name)) {
        assert!(allowed.contains(&format!("\"{law}\"")), "{law}: {allowed}");
    }
}

/// `boundary` searches with the law, takes a coarser filter for it, and says so.
#[test]
fn boundaries_take_the_law() {
    let root = tempfile::tempdir().unwrap();
    let at = root.path();
    fs::write(at.join("base.csv"), "opening_mm,percent_finer\n0.063,0\n0.125,20\n0.25,75\n0.5,100\n")
        .unwrap();
    let search = |law: &str| {
        let law = format!("walk.arching={law}");
        let words =
            ["boundary", "base.csv", "--filter", "cu1.5-loose", "--thickness", "12layers", "-q", "--json"];
        let settings = ["network.nx=8", "network.ny=8", "replicates=2", &law];
        let set = settings.iter().flat_map(|setting| ["--set", setting]);
        let output = call(at, &words.into_iter().chain(set).chain(["--overwrite"]).collect::<Vec<_>>());
        done(&output);
        serde_json::from_slice::<Value>(&output.stdout).unwrap()
    };
    let [sieving, arching] = ["none", "critical-3"].map(search);
    let boundary = |of: &Value| of["boundaries"][0]["no_erosion"]["median"].as_f64();
    assert!(boundary(&arching).unwrap() > 1.5 * boundary(&sieving).unwrap(), "{:?}", boundary(&arching));
    assert!(sieving["model_leaves_out"].to_string().contains("bridging"));
    assert!(!arching["model_leaves_out"].to_string().contains("bridging"));
    let notes = arching["notes"].as_array().unwrap();
    assert!(notes.iter().any(|note| note["id"] == "arches"), "{notes:?}");
}

/// A base three times as fine is held by arches as sieving holds one three times as coarse.
#[test]
fn a_critical_ratio_is_sieving_with_larger_particles() {
    let root = tempfile::tempdir().unwrap();
    let at = root.path();
    fs::write(at.join("s.toml"), SCENE).unwrap();
    // As many particles in both, at 3.5 and at 10.5 D85B.
    let of = |ratio: &str, law: &str| {
        let [ratio, law] = [format!("base.d15f_over_d85b={ratio}"), format!("walk.arching={law}")];
        walked(at, "a", &["--set", &ratio, "--set", &law, "--set", "base.n_base=300000"])
    };
    let (fine, coarse) = (eroded(&of("10.5", "critical-3"), 0), eroded(&of("3.5", "none"), 0));
    assert!(fine < 0.075 && coarse < 0.075, "{fine} {coarse}");
    let (fine, coarse) = (eroded(&of("18", "critical-3"), 0), eroded(&of("6", "none"), 0));
    assert!(fine > 0.3 && coarse > 0.3, "{fine} {coarse}");
}

#[test]
fn what_cannot_be_is_refused() {
    let root = tempfile::tempdir().unwrap();
    let at = root.path();
    fs::write(at.join("s.toml"), SCENE).unwrap();
    let refusal = |more: &[&str], says: &str| {
        refused(&call(at, &[&["run", "s.toml", "--out", "r"][..], more].concat()), says);
        assert!(!at.join("r").exists());
    };
    refusal(&["--set", "walk.arching=zuriguel"], "\"zuriguel-2005\"");
    refusal(&["--set", "walk.concentration=0.1"], "walk.concentration");
    refusal(
        &["--set", "walk.arching=zuriguel-2005", "--set", "walk.concentration=0.1"],
        "walk.concentration",
    );
    for wrong in ["0", "-0.1", "0.65", "by-void"] {
        let set = format!("walk.concentration={wrong}");
        refusal(&["--set", "walk.arching=marin-2018", "--set", &set], "a number above 0 and up to 0.64");
    }
    refusal(&["--set", "walk.arching=marin-2018", "--set", "walk.concentration=2%"], "as a fraction");
}

/// A law that depends on the concentration says what is missing, wherever the law is named, before any work.
#[test]
fn a_law_without_its_concentration_is_refused() {
    let root = tempfile::tempdir().unwrap();
    let at = root.path();
    fs::write(at.join("s.toml"), SCENE).unwrap();
    fs::write(at.join("l.toml"), format!("{SCENE}[walk]\narching = \"marin-2018\"\n")).unwrap();
    let says = "walk.concentration is missing: \"marin-2018\" depends on the solids fraction of the \
                suspension that enters the filter (volume of particles by volume of suspension), a number \
                above 0 and up to 0.64\n";
    for command in ["run", "check"] {
        let law = ["--set", "walk.arching=marin-2018"];
        refused(&call(at, &[&[command, "s.toml"][..], &law].concat()), &format!("refused: s.toml: {says}"));
        refused(&call(at, &[command, "l.toml"]), &format!("refused: l.toml: {says}"));
    }
    assert_eq!(fs::read_dir(at).unwrap().count(), 2);
    let outcome = walked(at, "r", &["--set", "walk.arching=marin-2018", "--set", "walk.concentration=0.05"]);
    assert_eq!(outcome["arching"]["concentration"], 0.05);
    // A law of dense flow has none.
    let outcome = walked(at, "r", &["--set", "walk.arching=critical-3"]);
    assert!(outcome["arching"]["concentration"].is_null());
}
