//! `voidwalk check` and `voidwalk init`, and how a scene is found.

use std::fmt::Write;
use std::path::Path;

use super::Exit;
use super::args::SceneArgs;
use super::print::{count, plain, to_stdout};
use crate::campaign::cluster::scripts::duration;
use crate::case::{Case, ResourceLimits};
use crate::case::{PackedFilter, PackingPlan};
use crate::constrictions::shipped;
use crate::run::machine::Machine;
use crate::run::replicates::{left_out_of_first_run, runs_to_walk};
use crate::scene::Scene;
use crate::store::Placement;

/// The scene that the arguments name, with their settings applied.
pub fn scene(args: &SceneArgs) -> Result<Scene, Exit> {
    let mut settings = args.settings.clone();
    settings.extend(args.seed.map(|seed| format!("seed={seed}")));
    settings.extend(args.target_error.map(|pp| format!("stop.target_error_pp={pp:?}")));
    settings.extend(args.decide.map(|percent| format!("stop.decide_percent={percent:?}")));
    let scene = match &args.scene {
        Some(path) => Scene::read(path, &settings),
        None => Scene::built_in(&settings),
    };
    scene.map_err(Exit::refused)
}

/// Says what a run would do.
pub fn check(args: &SceneArgs) -> Result<(), Exit> {
    let scene = scene(args)?;
    let (packed, packing) = match PackingPlan::of(&scene).map_err(Exit::refused)? {
        None => (None, None),
        Some(order) => {
            let (filter, sentence) = look_for_packing(&order, &args.packings)?;
            (Some(filter), Some(sentence))
        }
    };
    let mut case = Case::with_packed(scene, packed).map_err(Exit::refused)?;
    let room = ResourceLimits::new(args.memory, Machine::here().available, Path::new("."));
    let placed = case.place(&room, cores(), Path::new("."));
    let left_out = match &placed {
        Ok(()) => [case.left_out(), left_out_of_first_run(&case).map_err(Exit::refused)?].concat(),
        Err(_) => case.left_out(),
    };
    to_stdout(&if args.json { json(&case, &left_out, packing)? } else { words(&case, &left_out, packing) });
    placed.map_err(Exit::refused)
}

/// The packing where it is kept, or a guess at it; and what is to be said of it.
fn look_for_packing(order: &PackingPlan, packings: &Path) -> Result<(PackedFilter, String), Exit> {
    let grains = count(order.compression.grains as u64);
    let folder = packings.join(order.folder_name());
    if let Some(filter) = super::pack::read(&folder, order)? {
        return Ok((filter, format!("{grains} grains, made already: {}", folder.display())));
    }
    let guess = PackedFilter::placeholder(order).map_err(Exit::refused)?;
    let sentence = format!(
        "{grains} grains, still to be made, in {}; until then constrictions and grains per void are guesses",
        folder.display()
    );
    Ok((guess, sentence))
}

/// Worker threads of a run that does not say how many.
fn cores() -> u64 {
    std::thread::available_parallelism().map_or(1, |n| n.get() as u64)
}

/// Writes the built-in scene.
pub fn init(path: Option<&Path>) -> Result<(), Exit> {
    let Some(path) = path else {
        to_stdout(&Scene::init_text());
        return Ok(());
    };
    if path.symlink_metadata().is_ok() {
        let problem = format!("{}: is there already; name a file that is not", path.display());
        return Err(Exit::refused(plain(&problem)));
    }
    crate::store::write_whole(path, Scene::init_text().as_bytes()).map_err(super::run::refused_or_failed)?;
    to_stdout(&format!("{}\n", plain(&path.display().to_string())));
    Ok(())
}

fn json(case: &Case, left_out: &[String], packing: Option<String>) -> Result<String, Exit> {
    let value = serde_json::json!({
        "n_base": case.n_base,
        "n_base_eq2": case.n_base_eq2,
        "capped": case.capped,
        "grains_per_void": case.grains_per_void,
        "mass_ratio": case.mass_ratio,
        "one_by_one": case.one_by_one(case.n_base),
        "runs_to_walk": runs_to_walk(case),
        "bytes": case.bytes(case.n_base),
        "bytes_allowed": case.memory,
        "core_seconds": case.core_seconds(),
        "particles_on_disk": case.placement != Placement::Memory,
        "ratios": case.ratios(),
        "packing": packing,
        "inputs": case.record(),
        "left_out": left_out,
        "warnings": case.warnings(),
    });
    Ok(format!("{}\n", serde_json::to_string_pretty(&value).map_err(Exit::failed)?))
}

fn words(case: &Case, left_out: &[String], packing: Option<String>) -> String {
    let inputs = case.record();
    let ratios = case.ratios();
    let unit = if inputs.scale_free { "D0F" } else { "mm" };
    let mut text = String::new();
    // Writing to a string cannot fail.
    let mut line = |name: &str, value: String| {
        let _ = writeln!(text, "{name:<22}{}", plain(&value));
    };
    let filter = &inputs.filter;
    line("filter", format!("{}, curve {}", filter.name, filter.curve_name));
    line(
        "  sizes",
        format!("D0 {:.4}, D15 {:.4}, D85 {:.4} {unit}", filter.d0_mm, filter.d15_mm, filter.d85_mm),
    );
    line(
        "  constrictions",
        format!(
            "Dc0 {:.4}, Cu_CSD {:.3}, to {:.4} {unit}",
            case.curve.smallest(),
            filter.cu_csd,
            case.curve.largest()
        ),
    );
    if let Some(packing) = packing {
        line("  packing", packing);
    }
    let base = &inputs.base;
    line("base", base.name.clone());
    line(
        "  sizes",
        format!(
            "D0 {:.4}, D85 {:.4}, D95 {:.4}, D100 {:.4} {unit}",
            base.d0_mm, base.d85_mm, base.d95_mm, base.d100_mm
        ),
    );
    line("ratios", format!("D15F/D85B {:.3}, D15F/D95B {:.3}", ratios.d15f_over_d85b, ratios.d15f_over_d95b));
    let rounded = |grains: f64| (grains * 1e4).round() / 1e4;
    let given = |value: Option<f64>| value.map_or("not given".to_string(), |v| format!("{v}"));
    line("grains per void", format!("{} (N_p / N_voids of Eq. 2)", given(case.grains_per_void.map(rounded))));
    line("mass ratio", format!("{} (base over filter)", given(case.mass_ratio)));
    line(
        "base particles",
        format!(
            "{} a run{}",
            count(case.n_base),
            match case.capped {
                true => format!(", capped from {} by Eq. (2)", count(case.n_base_eq2.unwrap_or(0))),
                false => String::new(),
            }
        ),
    );
    line(
        "  one by one",
        match case.one_by_one(case.n_base) {
            all if all == case.n_base => "all".into(),
            some => format!("at most about {}; the others are passive and kept as counts", count(some)),
        },
    );
    let network = &inputs.network;
    line(
        "network",
        format!(
            "{}: {} voids, {} constrictions, {} start nodes",
            network.name,
            count(network.voids),
            count(network.constrictions),
            count(network.start_nodes)
        ),
    );
    line(
        "to walk",
        format!("{} runs, at most {} increments of insertion each", runs_to_walk(case), case.increments()),
    );
    line("memory", case.memory_in_words());
    line("time", format!("about {} of one core, a rough guess", duration(case.core_seconds())));
    for part in left_out {
        line("left out", part.clone());
    }
    for warning in case.warnings() {
        line("warning", warning);
    }
    let names: Vec<&str> = shipped().iter().map(|s| s.name.as_str()).collect();
    line("shipped curves", names.join(", "));
    text
}
