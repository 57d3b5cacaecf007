//! Writes what came of a case into a run folder.

use std::fmt::Write;
use std::time::SystemTime;

use serde::Serialize;

use super::error::RunError;
use super::machine::Machine;
use super::replicates::{ReplicateResult, as_it_is, stopping, summarise};
use crate::case::Case;
use crate::network::Connectivity;
use crate::outcome::record::{Manifest, Outcome, Sensitivity, Statistic};
use crate::outcome::rules::RuleInputs;
use crate::outcome::{MODEL_LEAVES_OUT, Recorded, infiltration, rules, verdict};
use crate::scene::{Amount, BaseGradation, CurveSource, D85, FilterGradation, NetworkSource};
use crate::store::{Folder, StoreError};

/// The outcome of a case that has been walked.
pub fn outcome(
    case: &Case,
    walked: &[ReplicateResult],
    mut sensitivity: Vec<Sensitivity>,
    seconds: f64,
) -> Outcome {
    let (verdict, summary) = summarise(walked);
    let stopping = stopping(case, walked);
    // A verdict that was to be certain is one at the level asked for.
    let verdict = stopping.as_ref().and_then(|stopping| stopping.verdict).unwrap_or(verdict);
    if !sensitivity.is_empty() {
        sensitivity.push(as_it_is(case, walked));
        sensitivity.sort_by(|a, b| a.factor.total_cmp(&b.factor));
    }
    let ratios = case.ratios();
    Outcome {
        verdict,
        seed: case.scene.seed,
        n_base: case.n_base,
        n_base_eq2: case.n_base_eq2,
        capped: case.capped,
        grains_per_void: case.grains_per_void,
        engine: walked.first().map_or(case.scene.engine, |w| w.engine).name().into(),
        replicates: walked.iter().map(|w| w.replicate.clone()).collect(),
        summary,
        stopping,
        threshold: verdict::THRESHOLD,
        warnings: case.warnings(),
        left_out: left_out(case, walked),
        model_leaves_out: MODEL_LEAVES_OUT.map(String::from).to_vec(),
        inputs: case.record(),
        ratios,
        rules: rules::beside_the_verdict(&rule_inputs(case, walked)),
        infiltration: match case.scene.network {
            NetworkSource::Cubic(_) => Some(infiltration(&case.curve, &case.base, case.counts[3])),
            _ => None,
        },
        sensitivity,
        seconds,
    }
}

/// Part of the fingerprint of every case: raised whenever the program gives other results for the same scene.
const PROTOCOL: u32 = 1;

/// Fingerprint of everything that the results of a case follow from: the resolved scene and its files.
pub fn fingerprint(case: &Case) -> String {
    let mut text = format!("{PROTOCOL}\n{}", resolved(case)).into_bytes();
    text.extend_from_slice(case.shipped.map_or("", |shipped| shipped.curve_csv).as_bytes());
    for input in case.inputs.iter().filter(|input| input.setting != "filter.density") {
        text.extend_from_slice(input.setting.as_bytes());
        text.extend_from_slice(&input.bytes);
    }
    format!("{:032x}", xxhash_rust::xxh3::xxh3_128(&text))
}

/// Writes what a run can be started again from: the resolved scene and its input files.
///
/// # Errors
/// What the folder says.
pub fn write_scene(folder: &Folder, case: &Case) -> Result<(), StoreError> {
    for input in &case.inputs {
        folder.write(&input.kept_as, &input.bytes)?;
    }
    folder.write("scene.toml", resolved(case).as_bytes())
}

/// What is said of a run besides its results.
pub fn manifest(case: &Case, threads: u64, started: SystemTime, command: String) -> Manifest {
    let machine = Machine::here();
    Manifest {
        version: env!("CARGO_PKG_VERSION").into(),
        commit: option_env!("VOIDWALK_COMMIT").map(String::from),
        seed: case.scene.seed,
        inputs: case.input_files(),
        threads,
        host: machine.host,
        machine: machine.description,
        started: humantime::format_rfc3339_seconds(started).to_string(),
        finished: humantime::format_rfc3339_seconds(SystemTime::now()).to_string(),
        command,
    }
}

/// What the filter rules read of a case that has been walked.
fn rule_inputs<'a>(case: &'a Case, walked: &[ReplicateResult]) -> RuleInputs<'a> {
    let first = |w: &ReplicateResult| w.replicate.runs.first()?.largest_eroded_over_d15f;
    let largest: Vec<f64> = walked.iter().filter_map(first).collect();
    RuleInputs {
        ratios: case.ratios(),
        filter_sieve: match case.scene.filter {
            FilterGradation::Sieve(..) => Some(&case.filter),
            FilterGradation::Linear { .. } => None,
        },
        base_mm: (!case.is_scale_free()).then_some(&case.base),
        largest_eroded_over_d15f: (!largest.is_empty()).then(|| Statistic::of(&largest).mean),
    }
}

/// What the scene did not need, and what the first replicate's first run did not.
fn left_out(case: &Case, walked: &[ReplicateResult]) -> Vec<String> {
    let of_run = walked.first().map(|w| w.left_out.clone()).unwrap_or_default();
    [case.left_out(), of_run].concat()
}

/// Writes a run folder: the resolved scene and its input files, the outcome, the manifest, the CSV files.
///
/// # Errors
/// What the folder says; no file is half written.
pub fn write(
    folder: &Folder,
    case: &Case,
    outcome: &Outcome,
    walked: &[ReplicateResult],
    manifest: &Manifest,
) -> Result<(), RunError> {
    // First, so that a folder is not taken for whole while its files are being replaced.
    for name in ["manifest.json", "outcome.json"] {
        folder.remove(name)?;
    }
    write_scene(folder, case)?;
    let mut recorded = Recorded::default();
    for walked in walked {
        recorded.append(walked.recorded.clone());
    }
    folder.write("series.csv", &csv("series.csv", SERIES, &recorded.series)?)?;
    folder.write("layers.csv", &csv("layers.csv", LAYERS, &recorded.layers)?)?;
    folder.write("retained.csv", &csv("retained.csv", SIZES, &recorded.retained)?)?;
    folder.write("eroded.csv", &csv("eroded.csv", SIZES, &recorded.eroded)?)?;
    folder.write("outcome.json", &json("outcome.json", outcome)?)?;
    // Last, so that a folder with a manifest is whole.
    folder.write("manifest.json", &json("manifest.json", manifest)?)?;
    Ok(())
}

const SERIES: &str = "replicate,run,increment,inserted,moving,eroded,retained_in_constrictions,\
    retained_in_voids,trapped,blocked,eroded_mass_fraction";
const LAYERS: &str = "replicate,run,layer,constrictions,blocked,retained_in_constrictions,retained_in_voids";
const SIZES: &str = "replicate,run,increment,diameter_mm,percent_finer_by_mass,percent_finer_by_number";

/// A value as indented JSON with a newline at its end.
///
/// # Errors
/// What cannot be put into words.
pub fn json(file: &'static str, value: &impl Serialize) -> Result<Vec<u8>, RunError> {
    let mut bytes =
        serde_json::to_vec_pretty(value).map_err(|e| RunError::Format { file, source: e.into() })?;
    bytes.push(b'\n');
    Ok(bytes)
}

/// The rows under their header, which is there even without rows.
fn csv(file: &'static str, header: &str, rows: &[impl Serialize]) -> Result<Vec<u8>, RunError> {
    let mut bytes = format!("{header}\n").into_bytes();
    let mut writer = csv::WriterBuilder::new().has_headers(false).from_writer(&mut bytes);
    for row in rows {
        writer.serialize(row).map_err(|e| RunError::Format { file, source: e.into() })?;
    }
    writer.flush().map_err(|e| RunError::Format { file, source: e.into() })?;
    drop(writer);
    Ok(bytes)
}

/// The scene with every setting given: run again from the run folder, it gives the same bits.
pub fn resolved(case: &Case) -> String {
    let scene = &case.scene;
    let kept = |setting: &str| {
        let input = case.inputs.iter().find(|i| i.setting == setting);
        quoted(input.map_or("", |i| &i.kept_as))
    };
    let named = |source: &CurveSource, setting: &str| match source {
        CurveSource::Shipped(name) => quoted(name),
        CurveSource::File(_) => kept(setting),
    };
    let mut text = String::new();
    let mut line = |name: &str, value: String| {
        // Writing to a string cannot fail.
        let _ = match value.is_empty() {
            true => writeln!(text, "\n[{name}]"),
            false => writeln!(text, "{name} = {value}"),
        };
    };
    line("seed", scene.seed.to_string());
    line("engine", quoted(scene.engine.name()));
    line("runs", scene.runs.to_string());
    line("replicates", scene.replicates.to_string());
    line("inject_share", number(scene.inject_share));
    line("sampling", quoted(scene.sampling.name()));
    if scene.stop.is_set() {
        line("stop", String::new());
        if let Some(pp) = scene.stop.target_error_pp {
            line("target_error_pp", number(pp));
        }
        if let Some(percent) = scene.stop.decide_percent {
            line("decide_percent", number(percent));
        }
        line("most_replicates", scene.stop.most.to_string());
    }
    line("filter", String::new());
    if let Some(density) = scene.estimate {
        line("estimate", number(density));
    } else if case.packed.is_some() {
        line("curve", kept("filter.curve"));
    } else if let Some(source) = &scene.curve {
        line("curve", named(source, "filter.curve"));
    }
    match &scene.filter {
        FilterGradation::Linear { d0_mm, cu } => {
            line("d0_mm", number(*d0_mm));
            if let Some(cu) = cu.or(case.shipped.map(|s| s.cu)) {
                line("cu", number(cu));
            }
        }
        FilterGradation::Sieve(_, d0_mm) => {
            line("sieve", kept("filter.sieve"));
            if let Some(d0_mm) = d0_mm {
                line("d0_mm", number(*d0_mm));
            }
        }
    }
    if let Some(grains) = case.grains_per_void {
        line("grains_per_void", number(grains));
    }
    line("base", String::new());
    match &scene.base {
        BaseGradation::Sieve(_, d0_mm) => {
            line("sieve", kept("base.sieve"));
            if let Some(d0_mm) = d0_mm {
                line("d0_mm", number(*d0_mm));
            }
        }
        BaseGradation::Single(size) => line("single_mm", number(*size)),
        BaseGradation::Linear { cu, d85 } => {
            line("cu", number(*cu));
            match d85 {
                D85::Mm(mm) => line("d85_mm", number(*mm)),
                D85::Ratio(ratio) => line("d15f_over_d85b", number(*ratio)),
                D85::AtDc(percent, source) => {
                    line("d85_at_dc", number(*percent));
                    if let Some(source) = source {
                        line("dc_curve", named(source, "base.dc_curve"));
                    }
                }
            }
        }
    }
    match scene.amount {
        Amount::Number(n) => line("n_base", n.to_string()),
        Amount::MassRatio(ratio, cap) => {
            line("mass_ratio", number(ratio));
            if let Some(cap) = cap {
                line("cap", cap.to_string());
            }
        }
    }
    line("network", String::new());
    if let Some([nx, ny, nz]) = scene.network.shape() {
        line("nx", nx.to_string());
        line("ny", ny.to_string());
        line("nz", nz.to_string());
    }
    match &scene.network {
        NetworkSource::Cubic(_) => {}
        NetworkSource::Connected(_, wanted) if *wanted == Connectivity::table_3() => {
            line("connectivity", quoted("table3"));
        }
        NetworkSource::Connected(_, wanted) => {
            let shares: Vec<String> =
                wanted.percent().iter().map(|(k, share)| format!("{k} = {}", number(*share))).collect();
            line("connectivity", format!("{{ {} }}", shares.join(", ")));
        }
        NetworkSource::File(_) => line("file", kept("network.file")),
    }
    line("record", String::new());
    line("series_every", scene.wanted.series_every.to_string());
    line("size_curves", format!("{:?}", scene.wanted.size_curves));
    line("size_classes", scene.wanted.size_classes.to_string());
    line("sensitivity", format!("{:?}", scene.sensitivity.0));
    line("sensitivity_replicates", scene.sensitivity.1.to_string());
    text
}

/// A TOML string.
fn quoted(text: &str) -> String {
    toml::Value::String(text.into()).to_string()
}

/// A number that reads back to the same bits.
fn number(value: f64) -> String {
    format!("{value:?}")
}
