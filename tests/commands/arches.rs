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

/// These settings are refused with these words, and nothing is written.
fn refusal_at(at: &Path, more: &[&str], says: &str) {
    refused(&call(at, &[&["run", "s.toml", "--out", "r"][..], more].concat()), says);
    assert!(!at.join("r").exists());
}

#[test]
fn what_cannot_be_is_refused() {
    let root = tempfile::tempdir().unwrap();
    let at = root.path();
    fs::write(at.join("s.toml"), SCENE).unwrap();
    fs::write(at.join("c.csv"), "percent_smaller,diameter_over_d0f\n0,0.15\n50,0.3\n100,0.9\n").unwrap();
    let refusal = |more: &[&str], says: &str| refusal_at(at, more, says);
    refusal(&["--set", "walk.arching=zuriguel"], "\"zuriguel-2005\"");
    refusal(&["--set", "walk.concentration=0.1"], "walk.concentration");
    refusal(
        &["--set", "walk.arching=zuriguel-2005", "--set", "walk.concentration=0.1"],
        "walk.concentration",
    );
    let unknown =
        ["--set", "walk.arching=marin-2018", "--set", "filter.curve=c.csv", "--set", "filter.cu=1.5"];
    refusal(
        &[&unknown[..], &["--set", "filter.grains_per_void=0.6"]].concat(),
        "walk.concentration is needed, as a number",
    );
    let known =
        [&unknown[..], &["--set", "filter.grains_per_void=0.6", "--set", "walk.concentration=0.2"]].concat();
    let outcome = walked(at, "r", &known);
    assert_eq!(outcome["arching"]["concentration"], 0.2);
}

const BY_VOID: [&str; 4] = ["--set", "walk.arching=marin-2018", "--set", "walk.concentration=by-void"];
const SHORT: [&str; 4] = ["--set", "runs=1", "--set", "replicates=1"];

/// What the walk brings into each void: written with the volume of a void, the same for any threads.
#[test]
fn by_void_the_walk_brings_its_own_concentration() {
    let root = tempfile::tempdir().unwrap();
    let at = root.path();
    fs::write(at.join("s.toml"), SCENE).unwrap();
    let of = |name: &str, more: &[&str]| walked(at, name, &[&BY_VOID[..], &SHORT, more].concat());
    let one = of("one", &["--threads", "1"]);
    assert_eq!(one["arching"]["by_void"]["size"], "own");
    assert!(one["arching"]["concentration"].is_null());
    assert!(one["replicates"][0]["runs"][0]["arches"].as_u64().unwrap() > 0);
    for threads in ["2", "3", "7"] {
        assert_eq!(of("more", &["--threads", threads])["summary"], one["summary"], "{threads}");
    }
    let [mean, d85] = ["void-mean", "void-d85"].map(|size| {
        let walked = of(size, &["--set", &format!("walk.arch_size={size}")]);
        assert_eq!(walked["arching"]["by_void"]["size"], size);
        assert_ne!(walked["summary"], one["summary"]);
        walked["summary"].clone()
    });
    assert_ne!(mean, d85);
}

/// A void has the volume of its grains by the void ratio, whatever the base is.
#[test]
fn a_void_is_as_large_as_the_filter_makes_it() {
    let root = tempfile::tempdir().unwrap();
    let at = root.path();
    let table = "size_mm,percent_finer\n0.20,100\n0.15,70\n0.10,40\n0.06,30\n";
    fs::write(at.join("b.csv"), table).unwrap();
    let scene = |filter: &str, base: &str| {
        let scene = format!("[filter]\nd0_mm = 1\n{filter}\n[base]\n{base}\n");
        let rest = "[network]\nnx = 6\nny = 6\nnz = 12\n[record]\nsensitivity = []\n";
        fs::write(at.join("s.toml"), scene + rest).unwrap();
        walked(at, "v", &[&BY_VOID[..], &SHORT].concat())["arching"]["by_void"]["void_mm"].as_f64().unwrap()
    };
    let library = "cu = 1.5\nlibrary = \"loose\"";
    // With 30 % of the base in the pan, with sizes for all of it, and with another base.
    let tailed = scene(library, "sieve = \"b.csv\"");
    assert_eq!(scene(library, "sieve = \"b.csv\"\nd0_mm = 0.05"), tailed);
    assert_eq!(scene(library, "single_mm = 0.1"), tailed);
    // By hand: of a linear filter of Cu 1.5 from 1 mm the mean cube is 6 ln 1.5 / (1 - 1.5^-6) = 2.667; a void
    // has 0.61 grains, and the void ratio is 0.658. (0.61 * 2.667 * 0.658)^(1/3) = 1.0230.
    let shipped = scene("curve = \"shire2016-cu1.5-loose\"", "single_mm = 0.1");
    assert!((shipped - 1.0230).abs() < 1e-4, "{shipped}");
}

#[test]
fn by_void_is_refused_where_it_says_nothing() {
    let root = tempfile::tempdir().unwrap();
    let at = root.path();
    fs::write(at.join("s.toml"), SCENE).unwrap();
    let refusal = |more: &[&str], says: &str| refusal_at(at, more, says);
    refusal(&["--set", "walk.arching=zuriguel-2005", "--set", "walk.concentration=by-void"], "says nothing");
    refusal(&["--set", "walk.arching=marin-2018", "--set", "walk.concentration=by-voids"], "or \"by-void\"");
    refusal(
        &["--set", "walk.arching=marin-2018", "--set", "walk.concentration=0.7"],
        "a part from 0 to 0.64",
    );
    refusal(
        &["--set", "walk.arching=marin-2018", "--set", "walk.arch_size=void-mean"],
        "says nothing unless walk.concentration is \"by-void\"",
    );
    refusal(&[&BY_VOID[..], &["--set", "walk.arch_size=mean"]].concat(), "\"void-mean\"");
    fs::write(at.join("n.csv"), "from,to,diameter_mm\nstart,0,\n0,end,0.2\n").unwrap();
    let other = fs::read_to_string(at.join("s.toml")).unwrap();
    fs::write(at.join("s.toml"), other.replace("nx = 10\nny = 10\nnz = 12\n", "file = \"n.csv\"\n")).unwrap();
    refusal(&[&BY_VOID[..], &["--set", "base.n_base=100"]].concat(), "the voids of a lattice");
}
