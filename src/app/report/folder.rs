//! Reads a finished run folder, and refuses contents that do not fit together.

use std::path::Path;

use super::about::about_page;
use super::error::ReportError;
use super::files::{json, text};
use super::quantity::SizeUnit;
use super::walks::{RowSource, RunRows, Walks, check_curve, check_results};
use crate::outcome::packing::PackingRecord;
use crate::outcome::record::{Classed, Manifest, Outcome, Sensitivity};
use crate::verdict::RunFiles;
use voidwalk_practice::AboutPage;
use voidwalk_practice::Decision;

/// Contents of a finished run folder.
pub(super) struct RunFolder {
    pub outcome: Outcome,
    /// The decision of practice on its pair.
    pub decision: Decision,
    pub manifest: Manifest,
    /// The packing of the filter, if the program made it.
    pub packing: Option<PackingRecord>,
    /// `scene.toml`, verbatim.
    pub scene: String,
    /// Its settings of the page.
    pub about: AboutPage,
    /// The rows of its CSV files.
    pub rows: RunRows,
}

impl RunFolder {
    pub(super) fn read(folder: &Path) -> Result<RunFolder, ReportError> {
        let path = folder.join(OUTCOME);
        let outcome = checked(&path, json(&path)?)?;
        let rows = rows_of(&outcome, folder, RowSource::Folder(folder))?;
        let manifest: Manifest = json(&folder.join(MANIFEST))?;
        let path = folder.join(SCENE);
        let scene = text(&path)?;
        let about = about_page(&path, &scene, &outcome)?;
        let packing = packing(&folder.join(PACKING), &manifest)?;
        let decision = outcome.decision();
        Ok(RunFolder { packing, outcome, decision, manifest, scene, about, rows })
    }

    /// Makes the folder of a run whose files have this content; errors name a file of `folder`.
    pub(super) fn of(folder: &Path, files: RunFiles) -> Result<RunFolder, ReportError> {
        let RunFiles { outcome, decision, manifest, scene, about, packing, recorded } = files;
        let outcome = checked(&folder.join(OUTCOME), outcome)?;
        let rows = rows_of(&outcome, folder, RowSource::Memory(recorded))?;
        Ok(RunFolder { packing, outcome, decision, manifest, scene, about, rows })
    }

    /// Results and rows for its figures and tables of walks.
    pub(super) fn walks(&self) -> Walks<'_> {
        walks(&self.outcome, &self.rows)
    }
}

/// Results and rows of an outcome for figures and tables of walks.
pub(super) fn walks<'a>(outcome: &'a Outcome, rows: &'a RunRows) -> Walks<'a> {
    Walks {
        verdict: outcome.model.class,
        summary: &outcome.summary,
        replicates: &outcome.replicates,
        threshold: outcome.threshold,
        inject_share: outcome.inputs.inject_share,
        base: &outcome.inputs.base.gradation,
        unit: SizeUnit::of(outcome.inputs.scale_free, false),
        d15f_mm: Some(outcome.inputs.filter.d15_mm),
        thickness_mm: outcome.inputs.network.thickness_mm,
        rows,
    }
}

const OUTCOME: &str = "outcome.json";
const MANIFEST: &str = "manifest.json";
const SCENE: &str = "scene.toml";
const PACKING: &str = "inputs/packing.json";

fn rows_of(outcome: &Outcome, folder: &Path, source: RowSource) -> Result<RunRows, ReportError> {
    RunRows::read(folder, source, outcome.replicates.len(), outcome.summary.len())
}

/// The outcome as it is shown; `path` names it in errors.
pub(super) fn checked(path: &Path, mut outcome: Outcome) -> Result<Outcome, ReportError> {
    check_results(path, &outcome.replicates, &outcome.summary, outcome.threshold)?;
    let inputs = &outcome.inputs;
    check_curve(path, "inputs.filter.gradation", &inputs.filter.gradation)?;
    check_curve(path, "inputs.filter.constrictions", &inputs.filter.constrictions)?;
    check_curve(path, "inputs.base.gradation", &inputs.base.gradation)?;
    stand_among_its_variations(&mut outcome);
    Ok(outcome)
}

/// The packing of the filter, if this run was made with that very file.
fn packing(path: &Path, manifest: &Manifest) -> Result<Option<PackingRecord>, ReportError> {
    if !path.is_file() {
        return Ok(None);
    }
    let sum = format!("{:016x}", xxhash_rust::xxh3::xxh3_64(text(path)?.as_bytes()));
    match manifest.inputs.iter().any(|input| input.xxh3 == sum) {
        true => Ok(Some(json(path)?)),
        false => Ok(None),
    }
}

/// The outcome itself is the case of factor 1; it is shown among the others unless it was walked a second
/// time.
fn stand_among_its_variations(outcome: &mut Outcome) {
    if outcome.sensitivity.is_empty() || outcome.sensitivity.iter().any(|case| case.factor == 1.0) {
        return;
    }
    let itself = Sensitivity {
        factor: 1.0,
        n_base: outcome.n_base,
        grains_per_void: outcome.grains_per_void,
        mass_ratio: outcome.inputs.mass_ratio,
        walked: Classed {
            replicates: outcome.replicates.len() as u64,
            stopped_when_clear: false,
            verdict: outcome.model.class,
            runs: outcome.summary.iter().map(|run| run.eroded_mass_fraction).collect(),
        },
    };
    outcome.sensitivity.push(itself);
    outcome.sensitivity.sort_by(|a, b| a.factor.total_cmp(&b.factor));
}
