//! Reads a finished run folder, and refuses what does not fit together.

use std::collections::BTreeMap;
use std::path::Path;

use super::error::ReportError;
use super::files::{json, rows, text};
use crate::outcome::packing::PackingRecord;
use crate::outcome::record::{LayerRow, Manifest, Outcome, Sensitivity, SeriesRow, SizeRow};

/// Everything that a finished run folder says.
pub(super) struct RunFolder {
    pub outcome: Outcome,
    pub manifest: Manifest,
    /// The packing of the filter, if the program made it.
    pub packing: Option<PackingRecord>,
    /// `scene.toml`, verbatim.
    pub scene: String,
    /// By (run, replicate); rows in the order of the file.
    pub series: BTreeMap<(u64, u64), Vec<SeriesRow>>,
    /// By (run, replicate).
    pub layers: BTreeMap<(u64, u64), Vec<LayerRow>>,
    /// By (run, replicate, increment).
    pub retained: BTreeMap<(u64, u64, u64), Vec<SizeRow>>,
    /// By (run, replicate, increment).
    pub eroded: BTreeMap<(u64, u64, u64), Vec<SizeRow>>,
}

impl RunFolder {
    pub(super) fn read(folder: &Path) -> Result<RunFolder, ReportError> {
        let mut outcome: Outcome = json(&folder.join("outcome.json"))?;
        check_outcome(&folder.join("outcome.json"), &outcome)?;
        stand_among_its_variations(&mut outcome);
        let runs = outcome.summary.len() as u64;
        let known = |path: &Path, line: u64, replicate: u64, run: u64| {
            let replicates = outcome.replicates.len() as u64;
            if (1..=replicates).contains(&replicate) && (1..=runs).contains(&run) {
                return Ok(());
            }
            let message = format!(
                "replicate {replicate}, run {run}: outcome.json holds replicates 1 to {replicates} and runs \
                 1 to {runs}"
            );
            Err(ReportError::Form { path: path.to_owned(), line, message })
        };

        let path = folder.join("series.csv");
        let mut series: BTreeMap<_, Vec<SeriesRow>> = BTreeMap::new();
        for (line, row) in rows::<SeriesRow>(&path)? {
            known(&path, line, row.replicate, row.run)?;
            in_range(&path, line, "eroded_mass_fraction", row.eroded_mass_fraction, 1.0)?;
            let rows = series.entry((row.run, row.replicate)).or_default();
            if let Some(last) = rows.last().map(|last| last.increment)
                && row.increment <= last
            {
                let message =
                    format!("increment is {}, allowed: more than {last}, the one before", row.increment);
                return Err(ReportError::Form { path, line, message });
            }
            rows.push(row);
        }
        let path = folder.join("layers.csv");
        let mut layers: BTreeMap<_, Vec<LayerRow>> = BTreeMap::new();
        for (line, row) in rows::<LayerRow>(&path)? {
            known(&path, line, row.replicate, row.run)?;
            if row.blocked > row.constrictions {
                let message = format!(
                    "blocked is {}, allowed: at most constrictions, {}",
                    row.blocked, row.constrictions
                );
                return Err(ReportError::Form { path, line, message });
            }
            layers.entry((row.run, row.replicate)).or_default().push(row);
        }
        let curves = |name: &str| {
            let path = folder.join(name);
            let mut curves: BTreeMap<_, Vec<SizeRow>> = BTreeMap::new();
            for (line, row) in rows::<SizeRow>(&path)? {
                known(&path, line, row.replicate, row.run)?;
                in_range(&path, line, "diameter_mm", row.diameter_mm, f64::MAX)?;
                in_range(&path, line, "percent_finer_by_mass", row.percent_finer_by_mass, 100.0)?;
                in_range(&path, line, "percent_finer_by_number", row.percent_finer_by_number, 100.0)?;
                curves.entry((row.run, row.replicate, row.increment)).or_default().push(row);
            }
            Ok::<_, ReportError>(curves)
        };
        let (retained, eroded) = (curves("retained.csv")?, curves("eroded.csv")?);
        let manifest: Manifest = json(&folder.join("manifest.json"))?;
        let scene = text(&folder.join("scene.toml"))?;
        let packing = packing(&folder.join("inputs/packing.json"), &manifest)?;
        Ok(RunFolder { packing, outcome, manifest, scene, series, layers, retained, eroded })
    }

    /// Run numbers, ascending.
    pub(super) fn runs(&self) -> impl Iterator<Item = u64> + use<> {
        1..=self.outcome.summary.len() as u64
    }
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

/// The outcome itself is the case of factor 1; it is shown among the others when it was not walked a second
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
        replicates: outcome.replicates.len() as u64,
        verdict: outcome.verdict,
        runs: outcome.summary.iter().map(|run| run.eroded_mass_fraction).collect(),
    };
    outcome.sensitivity.push(itself);
    outcome.sensitivity.sort_by(|a, b| a.factor.total_cmp(&b.factor));
}

/// Refuses what is not between 0 and `most` (Rust reads "nan" and "inf" as numbers).
fn in_range(path: &Path, line: u64, field: &str, value: f64, most: f64) -> Result<(), ReportError> {
    if value >= 0.0 && value <= most * (1.0 + 1e-9) {
        return Ok(());
    }
    let allowed =
        if most == f64::MAX { "a finite number, not negative".to_owned() } else { format!("0 to {most}") };
    let message = format!("{field} is {value}, allowed: {allowed}");
    Err(ReportError::Form { path: path.to_owned(), line, message })
}

fn check_outcome(path: &Path, outcome: &Outcome) -> Result<(), ReportError> {
    let refuse = |field: &str, value: String, allowed: &str| {
        let (field, allowed) = (field.to_owned(), allowed.to_owned());
        Err(ReportError::Value { path: path.to_owned(), field, value, allowed })
    };
    if outcome.replicates.is_empty() {
        return refuse("replicates", "empty".to_owned(), "one or more");
    }
    let runs = outcome.summary.len();
    if !(1..=2).contains(&runs) {
        return refuse("summary", format!("{runs} runs"), "one or two runs");
    }
    for (index, summary) in outcome.summary.iter().enumerate() {
        if summary.run != index as u64 + 1 {
            return refuse("summary[].run", summary.run.to_string(), "1, then 2");
        }
        let mean = summary.eroded_mass_fraction.mean;
        if !(0.0..=1.0 + 1e-9).contains(&mean) {
            return refuse("summary[].eroded_mass_fraction.mean", mean.to_string(), "0 to 1");
        }
    }
    for (index, replicate) in outcome.replicates.iter().enumerate() {
        let field = format!("replicates[{index}].runs");
        if replicate.runs.len() != runs {
            return refuse(&field, format!("{} runs", replicate.runs.len()), "as many as summary has");
        }
    }
    if !(outcome.threshold > 0.0 && outcome.threshold < 1.0) {
        return refuse("threshold", outcome.threshold.to_string(), "between 0 and 1");
    }
    let curves = [
        ("inputs.filter.gradation", &outcome.inputs.filter.gradation),
        ("inputs.filter.constrictions", &outcome.inputs.filter.constrictions),
        ("inputs.base.gradation", &outcome.inputs.base.gradation),
    ];
    for (field, curve) in curves {
        if curve.is_empty() {
            return refuse(field, "empty".to_owned(), "one row or more");
        }
        for [size, percent] in curve {
            if !(*size >= 0.0 && size.is_finite() && (0.0..=100.0 + 1e-9).contains(percent)) {
                return refuse(
                    field,
                    format!("[{size}, {percent}]"),
                    "a size not negative, a percentage of 0 to 100",
                );
            }
        }
    }
    Ok(())
}
