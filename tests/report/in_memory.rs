//! Pages of what was walked in memory.

use std::fs;
use std::path::Path;
use std::sync::Arc;

use voidwalk::constrictions::find;
use voidwalk::outcome::Recorded;
use voidwalk::outcome::record::Outcome;
use voidwalk::report::files::{json_of, rows};
use voidwalk::report::{self, about_page, network_walk_brief, network_walk_page, run_brief, run_page};
use voidwalk::run::{Callbacks, NetworkWalk, walk_networks};
use voidwalk::verdict::RunFiles;
use voidwalk::{Gradation, Network};

use crate::folder::Plan;
use crate::words;

fn recorded(folder: &Path) -> Recorded {
    fn of<T: serde::de::DeserializeOwned>(folder: &Path, name: &str) -> Vec<T> {
        rows(&folder.join(name)).unwrap().into_iter().map(|(_, row)| row).collect()
    }
    Recorded {
        series: of(folder, "series.csv"),
        layers: of(folder, "layers.csv"),
        retained: of(folder, "retained.csv"),
        eroded: of(folder, "eroded.csv"),
        ..Recorded::default()
    }
}

#[test]
fn a_run_in_memory_has_the_page_of_its_folder() {
    let folder = tempfile::tempdir().unwrap();
    Plan::usual().write(folder.path());
    let text = |name: &str| fs::read_to_string(folder.path().join(name)).unwrap();
    let (outcome, manifest, scene) = (text("outcome.json"), text("manifest.json"), text("scene.toml"));
    let parsed: Outcome = json_of(Path::new("outcome.json"), &outcome).unwrap();
    let texts = |recorded| RunFiles {
        decision: parsed.decision(),
        outcome: parsed.clone(),
        about: about_page(Path::new("scene.toml"), &scene, &parsed).unwrap(),
        manifest: json_of(Path::new("manifest.json"), &manifest).unwrap(),
        scene: scene.clone(),
        packing: None,
        recorded,
    };
    let page = run_page(texts(recorded(folder.path()))).unwrap();
    report::write(folder.path()).unwrap();
    assert_eq!(page, text("report.html"));

    let mut wrong = recorded(folder.path());
    wrong.series[1].replicate = 77;
    let error = run_page(texts(wrong)).unwrap_err().to_string();
    assert!(error.contains("series.csv:3") && error.contains("replicate 77"), "{error}");

    let brief = run_brief(&outcome).unwrap();
    for part in ["95 % interval", "constrictions blocked", "10 replicates", "The model leaves out"] {
        assert!(words(&brief).contains(part), "{part}: {brief}");
    }
    assert!(brief.contains("<img") && words(&page).contains("10 replicates"));
    assert!(words(&brief).contains("Model (research): "), "{brief}");
    assert!(run_brief("{}").unwrap_err().to_string().contains("outcome.json"));
}

#[test]
fn walks_on_a_given_network_have_a_page() {
    let curve = find("cu1.5-loose").unwrap().curve().unwrap().in_mm(1.0).unwrap();
    let network = Arc::new(Network::cubic([8, 8, 12], &curve, 1.0, 7).unwrap());
    let base = Gradation::linear_from_dx(85.0, 0.2, 1.5).unwrap();
    let plan = NetworkWalk { replicates: 3, ..NetworkWalk::new(base, 20_000) };
    let outcome = walk_networks(&[Arc::clone(&network)], &plan, &Callbacks::default()).unwrap();
    let record = serde_json::to_string(&outcome.record(&plan, &network, 1)).unwrap();
    let mut all = Recorded::default();
    outcome.replicates.into_iter().for_each(|walked| all.append(walked.result.recorded));

    let page = network_walk_page(&record, all.clone()).unwrap();
    let said = words(&page);
    for part in [
        outcome.verdict.words(),
        "What the model leaves out",
        "3 replicates, each a new walk on the same network",
        "The filter was not given, so no rule of practice was applied.",
        "20 000, as given",
        "Blocked constrictions by layer",
        "Progress of erosion",
        "Largest particle eroded in any replicate",
        "Each replicate (3)",
        "768, 2304, 12",
    ] {
        assert!(said.to_lowercase().contains(&part.to_lowercase()), "{part}: {said}");
    }
    assert!(!page.contains("<script") && page.contains("Content-Security-Policy"));

    let brief = network_walk_brief(&record).unwrap();
    assert!(!brief.contains("<script") && words(&brief).contains("95 % interval"));

    // The doubt of the page stands beside the verdict in brief too, and both mean the class in the same words.
    let (brief, at) = (words(&brief), words(&brief).find("In the model the filter ").unwrap());
    for doubt in [
        "The filter was not given, so no rule of practice was applied.",
        "Whether 20 000 base particles are enough is not known",
        "All replicates walk one network",
    ] {
        assert!(brief.contains(doubt) && said.contains(doubt), "{doubt}: {brief}");
    }
    let meaning = brief[at..].split(": ").next().unwrap();
    assert!(said.contains(meaning), "{meaning}: {said}");

    let broken = record.replacen("\"increments\":100", "\"increments\":0", 1);
    assert!(network_walk_page(&broken, all.clone()).unwrap_err().to_string().contains("increments"));
    all.layers[0].blocked = u64::MAX;
    assert!(network_walk_page(&record, all).unwrap_err().to_string().contains("blocked is"));
}
