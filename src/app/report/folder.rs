//! Reads a finished run folder, and refuses inconsistent contents.

use std::path::Path;

use serde::Deserialize;
use serde::de::DeserializeOwned;

use super::figures::shorten;
use super::files::{ReportError, json, malformed, text};
use super::shell::LINE;
use super::walks::{RunRows, Walks, check_curve, check_results};
use crate::outcome::packing::PackingRecord;
use crate::outcome::record::{Classed, Manifest, Outcome, Sensitivity};
use crate::verdict::RunFiles;
use voidwalk_practice::quantity::SizeUnit;
use voidwalk_practice::{AboutPage, Decision};

pub(super) struct RunFolder {
    pub(crate) outcome: Outcome,
    /// Decision of practice on its pair.
    pub(crate) decision: Decision,
    pub(crate) manifest: Manifest,
    /// The packing of the filter, if the program made it.
    pub(crate) packing: Option<PackingRecord>,
    /// `scene.toml`, verbatim.
    pub(crate) scene: String,
    pub(crate) about: AboutPage,
    pub(crate) rows: RunRows,
}

impl RunFolder {
    pub(super) fn read(folder: &Path) -> Result<RunFolder, ReportError> {
        let path = folder.join(OUTCOME);
        let outcome = checked(&path, json(&path)?)?;
        let rows = RunRows::read(folder, None, &outcome.replicates, &outcome.summary)?;
        let manifest: Manifest = json(&folder.join("manifest.json"))?;
        let path = folder.join("scene.toml");
        let scene = text(&path)?;
        let about = about_page(&path, &scene, &outcome)?;
        let packing = packing(&folder.join("inputs/packing.json"), &manifest)?;
        let decision = outcome.decision();
        Ok(RunFolder { packing, outcome, decision, manifest, scene, about, rows })
    }

    /// Makes the folder of a run from the content of its files; errors name a file of `folder`.
    pub(super) fn from_files(folder: &Path, files: RunFiles) -> Result<RunFolder, ReportError> {
        let RunFiles { outcome, decision, manifest, scene, about, packing, recorded } = files;
        let outcome = checked(&folder.join(OUTCOME), outcome)?;
        let rows = RunRows::read(folder, Some(recorded), &outcome.replicates, &outcome.summary)?;
        Ok(RunFolder { packing, outcome, decision, manifest, scene, about, rows })
    }

    pub(super) fn walks(&self) -> Walks<'_> {
        walks(&self.outcome, &self.rows)
    }
}

/// Results and rows of an outcome, for figures and tables of walks.
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

/// Outcome as it is shown; `path` names it in errors.
pub(super) fn checked(path: &Path, mut outcome: Outcome) -> Result<Outcome, ReportError> {
    check_results(path, &outcome.replicates, &outcome.summary, outcome.threshold)?;
    let inputs = &outcome.inputs;
    check_curve(path, "inputs.filter.gradation", &inputs.filter.gradation)?;
    check_curve(path, "inputs.filter.constrictions", &inputs.filter.constrictions)?;
    check_curve(path, "inputs.base.gradation", &inputs.base.gradation)?;
    stand_among_its_variations(&mut outcome);
    Ok(outcome)
}

/// Packing of the filter, if this run was made with that very file.
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

/// Adds the outcome itself, which has factor 1, to its variations, unless it was walked a second time.
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

#[derive(Default, Deserialize)]
#[serde(default)]
struct ShownSizes {
    coarse_left: bool,
    units: Option<SheetUnits>,
}

/// Units as a scene names them: pages use no scene.
#[derive(Deserialize, PartialEq)]
#[serde(rename_all = "lowercase")]
enum SheetUnits {
    Metric,
    Us,
}

/// Page settings in the text of a run's scene; `path` names the text in errors. A value that cannot be read
/// is an error with its line: a page without it may go to a client.
pub fn about_page(path: &Path, scene: &str, outcome: &Outcome) -> Result<AboutPage, ReportError> {
    let (cover, sizes): (_, ShownSizes) = (about(path, scene)?, about(path, scene)?);
    let unit = SizeUnit::of(outcome.inputs.scale_free, sizes.units == Some(SheetUnits::Us));
    Ok(AboutPage { cover, coarse_left: sizes.coarse_left, unit })
}

/// Settings of one kind in the table `about`; the rest of the scene is not read. Each kind is read
/// separately, because an error within a flattened struct would have no line.
fn about<T: Default + DeserializeOwned>(path: &Path, scene: &str) -> Result<T, ReportError> {
    #[derive(Deserialize)]
    struct Scene<T> {
        #[serde(default)]
        about: T,
    }
    toml::from_str(scene).map(|scene: Scene<T>| scene.about).map_err(|error| {
        let before = scene.bytes().take(error.span().map_or(0, |span| span.start));
        let line = before.filter(|byte| *byte == b'\n').count();
        let text = shorten(scene.lines().nth(line).unwrap_or_default().trim(), LINE);
        let message = format!("`{text}`: {}", error.message());
        malformed(path, line as u64 + 1, message)
    })
}
