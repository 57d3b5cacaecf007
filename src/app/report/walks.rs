//! Data for the figures and tables of walks, from a scene or on given networks.

use std::collections::BTreeMap;
use std::mem::take;
use std::path::Path;

use serde::de::DeserializeOwned;

use super::files::{ReportError, malformed, refused, rows};
use crate::outcome::Recorded;
use crate::outcome::record::{LayerRow, Replicate, RunSummary, SeriesRow, SizeRow, Verdict};
use voidwalk_practice::quantity::SizeUnit;

/// Results of walks and their rows.
#[derive(Clone, Copy)]
pub(super) struct Walks<'a> {
    pub(crate) verdict: Verdict,
    pub(crate) summary: &'a [RunSummary],
    pub(crate) replicates: &'a [Replicate],
    /// Eroded mass fraction that divides the classes.
    pub(crate) threshold: f64,
    /// Fraction of the base inserted in each increment.
    pub(crate) inject_share: f64,
    /// Gradation of the base: rows of size and percent finer by mass.
    pub(crate) base: &'a [[f64; 2]],
    /// Unit of sizes after the first sheet: mm alone, or D0F.
    pub(crate) unit: SizeUnit,
    /// D15F (mm), if the filter is known.
    pub(crate) d15f_mm: Option<f64>,
    /// Modelled thickness of the filter, if it has one.
    pub(crate) thickness_mm: Option<f64>,
    pub(crate) rows: &'a RunRows,
}

impl Walks<'_> {
    pub(super) fn runs(&self) -> impl Iterator<Item = u64> + use<> {
        1..=self.summary.len() as u64
    }
}

/// Rows of the CSV files of walks, by run first; rows of one key are in the order of the file.
#[derive(Default)]
pub(super) struct RunRows {
    /// Rows by run and replicate.
    pub(crate) series: BTreeMap<(u64, u64), Vec<SeriesRow>>,
    pub(crate) layers: BTreeMap<(u64, u64), Vec<LayerRow>>,
    /// Rows by run, replicate and increment.
    pub(crate) retained: BTreeMap<(u64, u64, u64), Vec<SizeRow>>,
    pub(crate) eroded: BTreeMap<(u64, u64, u64), Vec<SizeRow>>,
}

type Numbered<T> = Vec<(u64, T)>;

/// Rows of a table: those recorded, or else those of its file.
fn numbered<T: DeserializeOwned>(path: &Path, recorded: Option<Vec<T>>) -> Result<Numbered<T>, ReportError> {
    match recorded {
        // Line 1 of a file is its header.
        Some(recorded) => Ok((2..).zip(recorded).collect()),
        None => rows(path),
    }
}

impl RunRows {
    /// Sorts the rows of the expected replicates and runs, which are read from `folder` unless they were
    /// recorded, and refuses rows that do not fit together; errors name a file of `folder`.
    pub(super) fn read(
        folder: &Path,
        mut recorded: Option<Recorded>,
        replicates: &[Replicate],
        summary: &[RunSummary],
    ) -> Result<Self, ReportError> {
        let files = ["series.csv", "layers.csv", "retained.csv", "eroded.csv"];
        let [of_series, of_layers, of_retained, of_eroded] = files.map(|name| folder.join(name));
        let series = numbered(&of_series, recorded.as_mut().map(|all| take(&mut all.series)))?;
        let layers = numbered(&of_layers, recorded.as_mut().map(|all| take(&mut all.layers)))?;
        let retained = numbered(&of_retained, recorded.as_mut().map(|all| take(&mut all.retained)))?;
        let eroded = numbered(&of_eroded, recorded.as_mut().map(|all| take(&mut all.eroded)))?;
        let known = |replicate: u64, run: u64| {
            let (replicates, runs) = (replicates.len() as u64, summary.len() as u64);
            match (1..=replicates).contains(&replicate) && (1..=runs).contains(&run) {
                true => Ok(()),
                false => Err(format!(
                    "replicate {replicate}, run {run}: outcome.json holds replicates 1 to {replicates} and \
                     runs 1 to {runs}"
                )),
            }
        };
        let curves = |path: &Path, rows: Numbered<SizeRow>| {
            let key = |row: &SizeRow| (row.run, row.replicate, row.increment);
            sorted(path, rows, key, |row, _| {
                known(row.replicate, row.run)?;
                in_range("diameter_mm", row.diameter_mm, f64::MAX)?;
                in_range("percent_finer_by_mass", row.percent_finer_by_mass, 100.0)?;
                in_range("percent_finer_by_number", row.percent_finer_by_number, 100.0)
            })
        };
        let key = |row: &SeriesRow| (row.run, row.replicate);
        let series = sorted(&of_series, series, key, |row, last| {
            known(row.replicate, row.run)?;
            in_range("eroded_mass_fraction", row.eroded_mass_fraction, 1.0)?;
            let at = row.increment;
            match last.map(|last| last.increment).filter(|last| at <= *last) {
                Some(last) => Err(format!("increment is {at}, allowed: more than {last}, the one before")),
                None => Ok(()),
            }
        })?;
        let key = |row: &LayerRow| (row.run, row.replicate);
        let layers = sorted(&of_layers, layers, key, |row, _| {
            known(row.replicate, row.run)?;
            let (blocked, all) = (row.blocked, row.constrictions);
            match blocked <= all {
                true => Ok(()),
                false => Err(format!("blocked is {blocked}, allowed: at most constrictions, {all}")),
            }
        })?;
        Ok(Self {
            series,
            layers,
            retained: curves(&of_retained, retained)?,
            eroded: curves(&of_eroded, eroded)?,
        })
    }
}

/// Rows by their key, each checked against the previous row of its key; `path` names their file in errors.
fn sorted<K: Ord, T>(
    path: &Path,
    rows: Numbered<T>,
    key: impl Fn(&T) -> K,
    check: impl Fn(&T, Option<&T>) -> Result<(), String>,
) -> Result<BTreeMap<K, Vec<T>>, ReportError> {
    let mut sorted: BTreeMap<K, Vec<T>> = BTreeMap::new();
    for (line, row) in rows {
        let before = sorted.entry(key(&row)).or_default();
        check(&row, before.last()).map_err(|message| malformed(path, line, message))?;
        before.push(row);
    }
    Ok(sorted)
}

/// Refuses values outside 0 to `most` (Rust reads "nan" and "inf" as numbers).
fn in_range(field: &str, value: f64, most: f64) -> Result<(), String> {
    if value >= 0.0 && value <= most * (1.0 + 1e-9) {
        return Ok(());
    }
    let allowed =
        if most == f64::MAX { "a finite number, not negative".to_owned() } else { format!("0 to {most}") };
    Err(format!("{field} is {value}, allowed: {allowed}"))
}

/// Refuses results that no walk can have.
pub(super) fn check_results(
    path: &Path,
    replicates: &[Replicate],
    summary: &[RunSummary],
    threshold: f64,
) -> Result<(), ReportError> {
    let refuse = |field: &str, value: String, allowed: &str| Err(refused(path, field, value, allowed));
    if replicates.is_empty() {
        return refuse("replicates", "empty".to_owned(), "one or more");
    }
    let runs = summary.len();
    if !(1..=2).contains(&runs) {
        return refuse("summary", format!("{runs} runs"), "one or two runs");
    }
    for (index, summary) in summary.iter().enumerate() {
        if summary.run != index as u64 + 1 {
            return refuse("summary[].run", summary.run.to_string(), "1, then 2");
        }
        let mean = summary.eroded_mass_fraction.mean;
        if !(0.0..=1.0 + 1e-9).contains(&mean) {
            return refuse("summary[].eroded_mass_fraction.mean", mean.to_string(), "0 to 1");
        }
    }
    for (index, replicate) in replicates.iter().enumerate() {
        let field = format!("replicates[{index}].runs");
        if replicate.runs.len() != runs {
            return refuse(&field, format!("{} runs", replicate.runs.len()), "as many as summary has");
        }
    }
    if !(threshold > 0.0 && threshold < 1.0) {
        return refuse("threshold", threshold.to_string(), "between 0 and 1");
    }
    Ok(())
}

/// Refuses a curve of (size, percent) that cannot be drawn.
pub(super) fn check_curve(path: &Path, field: &str, curve: &[[f64; 2]]) -> Result<(), ReportError> {
    if curve.is_empty() {
        return Err(refused(path, field, "empty".to_owned(), "one row or more"));
    }
    for [size, percent] in curve {
        if !(*size >= 0.0 && size.is_finite() && (0.0..=100.0 + 1e-9).contains(percent)) {
            let allowed = "a size not negative, a percentage of 0 to 100";
            return Err(refused(path, field, format!("[{size}, {percent}]"), allowed));
        }
    }
    Ok(())
}
