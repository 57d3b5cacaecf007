//! Writes the results of a case into a run folder.

use super::RunError;
use super::case_walks::{CaseWalks, Studies};
use super::machine::description;
use super::replicates::{ReplicateResult, said_by_walks};
use crate::case::{Case, INPUT_NAMES, replicate_seed};
use crate::outcome::left_out::LeftOut;
use crate::outcome::record::{
    ConstrictionsRecord, CurveRange, Manifest, Model, Outcome, RunSummary, Statistic, VoidRow, commit, digest,
};
use crate::outcome::table::csv_of;
use crate::outcome::{Recorded, infiltration, leaves_out, recorder, verdict};
use crate::verdict::RunFiles;
use serde::Serialize;
use std::time::SystemTime;
use voidwalk_core::store::format::{Format, from_json};
use voidwalk_core::store::{Folder, StoreError, Together, format, platform};
use voidwalk_core::text::moment;
use voidwalk_core::walk::Shortcut;
use voidwalk_practice::rules::{BaseSoil, RuleInputs};
use voidwalk_practice::{Decision, IfDispersive, Note, dispersion, ordered, rules};

/// Outcome of a walked case with these earlier notes, and the decision of practice on its pair. `studies` is
/// empty if they follow later.
pub(crate) fn outcome(
    case: &Case,
    noted: &[Note],
    walks: &CaseWalks,
    studies: Studies,
    seconds: f64,
) -> (Outcome, Decision) {
    let CaseWalks { replicates: walked, summary, stopping, range, verdict, .. } = walks;
    let inputs = rule_inputs(case, walked);
    let notes = notes_before_results(case, noted, walks);
    let inputs_record = case.record();
    let mut outcome = Outcome {
        headline: None,
        practice: None,
        model: Model {
            class: *verdict,
            eroded_percent: eroded_percent(summary, range.as_ref()),
            replicates: walked.len() as u64,
            network: inputs_record.network.kind,
        },
        notes,
        if_dispersive: None,
        constrictions: ConstrictionsRecord { origin: case.curve_origin() },
        seed: case.scene.walk.seed,
        n_base: case.supply.n_base,
        n_base_eq2: case.supply.n_base_eq2,
        capped: case.supply.capped,
        grains_per_void: case.filter.grains_per_void,
        engine: walked.first().map_or(case.scene.walk.engine, |w| w.engine).name().into(),
        replicates: walked.iter().map(|w| w.replicate.clone()).collect(),
        summary: summary.clone(),
        stopping: stopping.clone(),
        threshold: verdict::THRESHOLD,
        left_out: left_out(case, walked.first().map_or(&[], |walked| &walked.left_out)),
        model_leaves_out: leaves_out(case.modelled()),
        inputs: inputs_record,
        network: case.network_summary(walked.first().and_then(|w| w.replicate.runs.first()?.k0_mm2)),
        ratios: case.ratios(),
        rules: rules::apply(&inputs),
        infiltration: case
            .scene
            .is_lattice_by_area()
            .then(|| infiltration(&case.filter.curve, &case.base.gradation, case.network.layers)),
        curve_range: range.clone(),
        arching: case.arching_record(),
        sensitivity: studies.sensitivity,
        thickness: studies.thickness,
        studies_to_come: false,
        digest: String::new(),
        seconds,
    };
    let range_of_tests_mm = rules::tested_range(&inputs);
    if case.scene.base.dispersive.is_none() {
        outcome.if_dispersive = IfDispersive::of(&RuleInputs { dispersive: true, ..inputs });
    }
    let d15f_mm = Some(outcome.inputs.filter.d15_mm);
    let mut decision = Decision::new(&outcome.rules, outcome.if_dispersive, d15f_mm);
    let mut notes: Vec<Note> = decision.notes().collect();
    // Multiples of D0F are sizes in a study, not in a pair of real soils.
    match case.is_scale_free() {
        true => decision.headline = None,
        false => outcome.practice = decision.record(range_of_tests_mm),
    }
    outcome.headline = decision.headline;
    notes.append(&mut outcome.notes);
    notes.extend(outcome.notes_of_results());
    notes.extend(outcome.if_dispersive.map(dispersion::note));
    outcome.notes = ordered(notes);
    outcome.digest = digest(&outcome).expect("an outcome is JSON");
    (outcome, decision)
}

/// Notes on the verdict, from the walks, the case, the stopping rule and the range of its curve.
fn notes_before_results(case: &Case, noted: &[Note], walks: &CaseWalks) -> Vec<Note> {
    let CaseWalks { replicates: walked, range, verdict, low_level_percent, .. } = walks;
    let of_network = (case.network.layers, case.scene.leaves_openings());
    let mut notes = said_by_walks(*verdict, walked, &case.base_as_walked(), case.increments(), of_network);
    notes.extend(case.unchecked_clogging());
    notes.extend(low_level_percent.map(|level_percent| Note::DecidedBelow95 { level_percent }));
    notes.extend_from_slice(noted);
    notes.extend(range.as_ref().map(|range| match range.agrees() {
        true => Note::CurveRange {},
        false => Note::CurveDecides { of_the_curve: range.verdict.words().into() },
    }));
    notes
}

/// Minimum and maximum mass eroded (%) in each run, over the replicates and the range of the curve.
fn eroded_percent(summary: &[RunSummary], range: Option<&CurveRange>) -> Vec<[f64; 2]> {
    let of_run = |(index, run): (usize, &RunSummary)| {
        let Statistic { mean, low, high, .. } = run.eroded_mass_fraction;
        let ends = range.and_then(|range| range.eroded_mass_fraction.get(index).copied());
        ends.unwrap_or([low.unwrap_or(mean), high.unwrap_or(mean)]).map(|part| 100.0 * part)
    };
    summary.iter().enumerate().map(of_run).collect()
}

/// Writes the files from which a run can be started again: the resolved scene and its input files.
pub(crate) fn write_scene(folder: &Folder, case: &Case) -> Result<(), StoreError> {
    let mut files = Together::in_folder(folder.path());
    for input in &case.inputs {
        files.add(&input.kept_as, &input.bytes)?;
    }
    if !case.inputs.is_empty() {
        let names = serde_json::to_vec_pretty(&case.input_names()).expect("names are text");
        files.add(INPUT_NAMES, &names)?;
    }
    files.add("scene.toml", case.resolved().to_toml().as_bytes())?;
    files.finish()
}

/// Manifest of a run: everything besides its results.
pub fn manifest(case: &Case, threads: u64, started: SystemTime, command: String) -> Manifest {
    Manifest {
        version: env!("CARGO_PKG_VERSION").into(),
        commit: commit(),
        seed: case.scene.walk.seed,
        inputs: case.input_files(),
        threads,
        host: platform::host_name(),
        machine: description(),
        started: moment(started),
        finished: moment(SystemTime::now()),
        command,
    }
}

/// Inputs of the filter rules from a case that has been walked.
fn rule_inputs<'a>(case: &'a Case, walked: &[ReplicateResult]) -> RuleInputs<'a> {
    let first = |w: &ReplicateResult| w.replicate.runs.first()?.largest_eroded_over_d15f;
    let largest: Vec<f64> = walked.iter().filter_map(first).collect();
    RuleInputs {
        filter: &case.filter.gradation,
        filter_is_measured: case.filter_is_measured(),
        base: case.base.as_given(),
        walked_base: &case.base.gradation,
        base_soil: BaseSoil::of(case.base.as_given(), case.is_scale_free()),
        scale_free: case.is_scale_free(),
        filter_curves: Vec::new(),
        dispersive: case.scene.base.dispersive == Some(true),
        joint_mm: case.scene.filter.joint_mm,
        largest_eroded_over_d15f: (!largest.is_empty()).then(|| Statistic::of(&largest).mean),
    }
}

/// Parts of the program that neither the scene nor the first run of the first replicate needs.
pub(super) fn left_out(case: &Case, of_run: &[Shortcut]) -> Vec<LeftOut> {
    case.left_out().into_iter().chain(of_run.iter().copied().map(LeftOut::Walk)).collect()
}

/// Content of the files of a run, except its voids. Errors: the record of its packing cannot be read.
pub(crate) fn files(
    case: &Case,
    (outcome, decision): (Outcome, Decision),
    walked: &[ReplicateResult],
    manifest: Manifest,
) -> Result<RunFiles, RunError> {
    let packing = case.packing_record().map(|input| from_json(&input.bytes)).transpose()?;
    let mut recorded = Recorded::default();
    for walked in walked {
        recorded.append(walked.recorded.clone());
    }
    let (scene, about) = (case.resolved().to_toml(), case.about_page());
    Ok(RunFiles { outcome, decision, manifest, scene, about, packing, recorded })
}

/// Writes the results of a run beside its scene: the CSV files, the outcome, the manifest. Errors: errors of
/// the folder; no file is left half written.
pub(crate) fn write(folder: &Folder, case: &Case, run: &RunFiles) -> Result<(), RunError> {
    // They go first, so that a folder whose files are being replaced is not taken for finished.
    for name in ["manifest.json", "outcome.json"] {
        folder.remove(name)?;
    }
    let recorded = &run.recorded;
    let mut files = Together::in_folder(folder.path());
    files.add("series.csv", &csv_of(&recorded.series))?;
    files.add("layers.csv", &csv_of(&recorded.layers))?;
    files.add("retained.csv", &csv_of(&recorded.retained))?;
    files.add("eroded.csv", &csv_of(&recorded.eroded))?;
    if !recorded.flow.is_empty() {
        files.add("flow.csv", &csv_of(&recorded.flow))?;
    }
    if case.scene.record.voids.is_some() {
        add_voids(&mut files, case, recorded)?;
    }
    files.add("outcome.json", &json(format::OUTCOME, &run.outcome)?)?;
    files.finish()?;
    // The manifest comes last: a folder that holds it is complete.
    folder.write("manifest.json", &json(format::MANIFEST, &run.manifest)?)?;
    Ok(())
}

/// Adds the first replicate's voids and constrictions, and their final states.
fn add_voids(files: &mut Together, case: &Case, recorded: &Recorded) -> Result<(), RunError> {
    let Some(places) = case.places() else { return Ok(()) };
    let network = case.network(replicate_seed(case.scene.walk.seed, 1))?;
    let rows: Vec<VoidRow> = (0u64..)
        .zip(places.point_mm.iter().zip(network.layer_of()))
        .map(|(void, (&[x_mm, y_mm, z_mm], &layer))| VoidRow { void, layer: layer.into(), x_mm, y_mm, z_mm })
        .collect();
    files.add("voids.csv", &csv_of(&rows))?;
    let rows = recorder::constrictions(&network, &places);
    files.add("constrictions_of_network.csv", &csv_of(&rows))?;
    files.add("blocked.csv", &csv_of(&recorded.blocked))?;
    Ok(files.add("retained_by_void.csv", &csv_of(&recorded.voids))?)
}

/// Contents of a JSON file in this format.
pub(crate) fn json(format: Format, record: &impl Serialize) -> Result<Vec<u8>, RunError> {
    let text = format.json(record).map_err(|e| RunError::Format { file: format.file, source: e.into() })?;
    Ok(text.into_bytes())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::outcome::record::Verdict;
    use crate::run::{Callbacks, case_of, walk_case};
    use crate::words;
    use voidwalk_practice::Headline;
    use voidwalk_practice::quantity::SizeUnit;

    /// Outcome for a soil with this percentage of fines and a uniform filter of this D15F.
    fn walked(fines: f64, d15f: f64, set: &[&str]) -> Outcome {
        walked_base(&format!("0.01,0\n0.075,{fines}\n0.3,92\n0.6,100\n"), d15f, set)
    }

    /// Outcome for a soil with these rows and a uniform filter of this D15F.
    fn walked_base(rows: &str, d15f: f64, set: &[&str]) -> Outcome {
        let folder = tempfile::tempdir().unwrap();
        let sheet = folder.path().join("base.csv");
        std::fs::write(&sheet, format!("size_mm,percent_finer\n{rows}")).unwrap();
        let (base, d0) = (format!("base.sieve={}", sheet.display()), format!("filter.d0_mm={}", d15f / 1.13));
        let soils = [&*base, &*d0, "filter.curve=shire2016-cu1.5-loose", "filter.cu=1.5"];
        let small = ["network.nx=6", "network.ny=6", "network.nz=8", "replicates=2", "record.sensitivity=[]"];
        walk_case(&case_of(&[&soils[..], &small, set].concat()), &Callbacks::default()).unwrap()
    }

    fn line(outcome: &Outcome) -> String {
        words::practice_line(&outcome.decision(), SizeUnit::Mm)
    }

    fn next_step(outcome: &Outcome) -> String {
        words::next(outcome, &outcome.decision(), SizeUnit::Mm)
    }

    /// The limit of practice for a silt is 0.7 mm, or 0.5 mm if it is dispersive.
    #[test]
    fn a_d15f_that_is_recommended_is_said_for_a_dispersive_base_too() {
        let coarse = walked(45.0, 1.2, &[]);
        let next = next_step(&coarse);
        let beside = "at most 0.700\u{202f}mm (dispersive base: at most 0.500\u{202f}mm) and at least ";
        assert!(next.contains(beside), "{next}");
        let next = next_step(&walked(45.0, 0.06, &[]));
        let beside = " to 0.700\u{202f}mm (dispersive base: at most 0.500\u{202f}mm)";
        assert!(next.starts_with("take a coarser filter, D15F ") && next.ends_with(beside), "{next}");
        let open = next_step(&walked(25.0, 9.0, &[]));
        assert!(open.contains(" (dispersive base: less than "), "{open}");
        for set in ["base.dispersive=true", "base.dispersive=false"] {
            let outcome = walked(45.0, 1.2, &[set]);
            assert!(outcome.if_dispersive.is_none() && !next_step(&outcome).contains("dispersive"), "{set}");
        }
    }

    #[test]
    fn a_filter_too_coarse_for_a_dispersive_base_is_said_in_the_line_of_practice() {
        let broken = walked(45.0, 0.6, &[]);
        assert_eq!(broken.headline, Some(Headline::MeetsUnlessDispersive));
        assert!(line(&broken).contains("; dispersive base: limit 0.500\u{202f}mm, not kept"));
        assert_eq!(next_step(&broken), "have the base tested for dispersion by a pinhole or crumb test");
        let kept = walked(45.0, 0.45, &[]);
        assert_eq!(kept.headline, Some(Headline::Meets));
        assert!(!next_step(&kept).contains("dispers"), "{}", next_step(&kept));
        assert!(!line(&kept).contains("dispersive"));
    }

    /// With 38 % fines the design limit is 0.860 mm, above the boundary of no erosion; it is lower for a
    /// dispersive base. The finest sieve passes 38 %, so D15B is finer than it: five times that sieve is
    /// enough.
    #[test]
    fn the_next_step_goes_by_design_and_says_what_is_enough_to_drain() {
        let next = |rows: &str| next_step(&walked_base(rows, 9.0, &[]));
        let begin = "take a filter with D15F at most 0.860\u{202f}mm (dispersive base: at most \
                     0.500\u{202f}mm) and at least ";
        let sieved = "0.075,38\n0.15,53.333\n0.3,68.667\n0.6,84\n1.2,89.846\n2.4,95.692\n4,100\n";
        let design = next(&format!("0.01,0\n0.02,13.07\n0.04,26.14\n{sieved}"));
        assert!(design.starts_with(begin), "{design}");
        let pan = next(sieved);
        assert!(pan.starts_with(&format!("{begin}0.375\u{202f}mm; for an existing filter")), "{pan}");
    }

    #[test]
    fn what_eroded_is_recorded_run_by_run() {
        let outcome = walked(45.0, 1.2, &["replicates=3"]);
        let model = &outcome.model;
        assert_eq!((model.replicates, model.eroded_percent.len()), (3, outcome.summary.len()));
        for ([low, high], run) in model.eroded_percent.iter().zip(&outcome.summary) {
            let mean = 100.0 * run.eroded_mass_fraction.mean;
            assert!(low <= &mean && &mean <= high, "{low} {mean} {high}");
        }
    }

    /// A clay with 51 % finer than 0.002 mm and a D85B of 0.01736 mm: 9 D85B is 0.156 mm and 6.4 D85B 0.111
    /// mm, and the design limit is at least 0.2 mm.
    #[test]
    fn the_next_step_goes_down_to_the_floor_of_the_limit_of_design() {
        const CLAY: &str = "0.002,51\n0.006,70\n0.012,79.79\n0.02,87\n0.063,95\n0.63,100\n";
        let most = |rows, d15f, set: &[&str]| {
            let next = next_step(&walked_base(rows, d15f, set));
            next.split("at most ").nth(1).map(|limit| limit.split('\u{202f}').next().unwrap().to_owned())
        };
        assert_eq!(most(CLAY, 2.2, &["base.dispersive=false"]).as_deref(), Some("0.200"));
        assert_eq!(most(CLAY, 2.2, &["base.dispersive=true"]).as_deref(), Some("0.111"));
        // Up to that minimum practice has no objection, and the model is undecided.
        let outcome_at = |d15f| walked_base(CLAY, d15f, &["base.dispersive=false"]);
        let fine = outcome_at(0.18);
        assert_ne!(fine.model.class, Verdict::None);
        assert_eq!(next_step(&fine), "have this pair tested");
        assert_eq!(fine.headline, Some(Headline::Meets));
        let fine = outcome_at(0.08);
        assert_eq!(next_step(&fine), "take a coarser filter, D15F 0.100 to 0.200\u{202f}mm");
        // A fat clay: D85B 0.005 mm; continuing erosion from 9 D95B = 0.072 mm, so no design goes beyond.
        const FAT: &str = "0.001,60\n0.005,85\n0.008,95\n0.02,100\n";
        for d15f in [0.18, 1.8] {
            let outcome = walked_base(FAT, d15f, &["base.dispersive=false"]);
            assert_eq!(outcome.headline, Some(Headline::DoesNotMeet));
            assert_eq!(most(FAT, d15f, &["base.dispersive=false"]).as_deref(), Some("0.0720"));
        }
    }
}
