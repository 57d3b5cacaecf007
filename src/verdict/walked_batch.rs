//! Many samples against filters: what practice says of each pair, and beside it what its walk says.

use serde::{Deserialize, Serialize};

use super::batch::{BatchRow, columns};
use super::batch_table::BatchFilter;
use super::practice::counts_as;
use super::probability::{is_beyond_range, probabilities};
use super::tested::is_beyond_tests;
use crate::outcome::BaseSize;
use crate::outcome::numbers::SizeUnit;
use crate::outcome::record::{
    Bound, Confidence, IfDispersive, ModelLimit, Outcome, Ratios, SheetCover, Statistic, Verdict, commit,
};
use crate::outcome::table::{Columns, TableCell};
use crate::outcome::verdict::THRESHOLD;

/// Columns of the table that a terminal and a page show; all are in the file.
const SHOWN: [&str; 13] = [
    "sample",
    "filter",
    "group",
    "d85b_mm",
    "limit_mm",
    "result",
    "governs",
    "walked",
    "class",
    "confidence",
    "first_eroded_mass_percent",
    "probability_no_erosion_percent",
    "note",
];

/// The whole of `batch.json`.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
pub struct WalkedBatch {
    /// Version of the program.
    pub version: String,
    /// The commit that it was built from; `None` where that is not known, and in files of earlier versions.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub commit: Option<String>,
    /// Hash of everything that the rows follow from: samples, filters and settings.
    pub work: String,
    /// Seed of every walk.
    pub seed: u64,
    /// The samples, as they were named.
    pub samples: String,
    /// The filters.
    pub filters: Vec<BatchFilter>,
    /// A row for each filter and sample, filter by filter.
    pub rows: Vec<WalkedRow>,
    /// What was assumed of the files, a sentence each.
    pub notes: Vec<String>,
    /// Eroded mass fraction that divides the classes: 0.075.
    pub threshold: f64,
    /// What the sheet says of itself; without a day in files of earlier versions.
    #[serde(default, skip_serializing_if = "SheetCover::is_unset")]
    pub cover: SheetCover,
    /// Whether inches stand beside mm on page and terminal.
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub inches: bool,
    /// What no walk contains.
    pub model_leaves_out: Vec<ModelLimit>,
}

/// One sample and one filter.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
pub struct WalkedRow {
    /// What practice says.
    #[serde(flatten)]
    pub rules: BatchRow,
    /// 1 for the sample that governs the filter by the rules, 2 and 3 for those next to it.
    pub governs: Option<u64>,
    /// What its walk says; `None` where there was none.
    pub walk: Option<SampleWalk>,
    /// Why it was not walked; empty where it was.
    #[serde(default, skip_serializing_if = "String::is_empty")]
    pub not_walked: String,
}

/// What the walk of one sample says.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
pub struct SampleWalk {
    /// Folder of its results, inside the batch's.
    pub folder: String,
    /// Whether it was walked in full; otherwise it was a first look.
    pub in_full: bool,
    /// Whether the filter holds the sample by practice and walk, in a line; empty in earlier records.
    #[serde(default, skip_serializing_if = "String::is_empty")]
    pub headline: String,
    /// The class that its replicates together support.
    pub verdict: Verdict,
    /// The class as which practice counts; `None` without a rule, and in files of earlier versions.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub by_practice: Option<Verdict>,
    /// How far it can be relied on.
    pub confidence: Confidence,
    /// The weightiest reason why no further.
    pub reason: Option<String>,
    /// Replicates.
    pub replicates: u64,
    /// D15F over D85B and D95B.
    pub ratios: Ratios,
    /// D85B, and which base it is of.
    pub base: Option<BaseSize>,
    /// Eroded mass fraction of each run.
    pub runs: Vec<Statistic>,
    /// Least and most eroded over the range of the constriction curve, one pair per run; empty where the
    /// curve is no range.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub curve_range: Vec<[f64; 2]>,
    /// What practice allows if the sample is dispersive; `None` where somebody has said whether it is, and
    /// where it has few fines.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub if_dispersive: Option<IfDispersive>,
    /// The probability that a test would show no erosion, by the walk; `None` where evidence does not say.
    pub probability_no_erosion: Option<f64>,
    /// On which side of that number it lies, where the walk's boundary was not found.
    pub probability_bound: Option<Bound>,
    /// The same probability by the published range of tests alone.
    pub probability_by_tests: Option<f64>,
    /// Whether the filter is beyond the boundary of no erosion that tests saw.
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub beyond_tests: bool,
}

impl SampleWalk {
    /// Of the outcome in this folder.
    pub fn of(outcome: &Outcome, folder: String, in_full: bool) -> Self {
        let evidence = outcome.evidence.as_ref().filter(|_| !outcome.hides_probability());
        let range = outcome.curve_range.as_ref();
        Self {
            folder,
            in_full,
            headline: outcome.headline(),
            verdict: outcome.verdict,
            by_practice: counts_as(&outcome.rules),
            confidence: outcome.confidence,
            reason: outcome.reasons.first().cloned(),
            replicates: outcome.replicates.len() as u64,
            ratios: outcome.ratios,
            base: outcome.inputs.base_size(),
            runs: outcome.summary.iter().map(|run| run.eroded_mass_fraction).collect(),
            curve_range: range.map_or_else(Vec::new, |range| range.eroded_mass_fraction.clone()),
            if_dispersive: outcome.if_dispersive,
            probability_no_erosion: evidence.and_then(|of| of.probability_no_erosion),
            probability_bound: evidence.and_then(|of| of.probability_no_erosion.and(of.bound)),
            probability_by_tests: evidence.and_then(|of| of.probability_by_tests),
            beyond_tests: is_beyond_tests(&outcome.rules),
        }
    }

    /// How it was walked, in words.
    pub fn depth(&self) -> &'static str {
        if self.in_full { "in full" } else { "first look" }
    }

    /// The probability of no erosion in a test, as `88 % by the published range, at least 93 % by the walk`;
    /// `None` where [`Confidence::hides_probability`], and beyond every D15F without erosion in tests.
    pub fn probability_in_words(&self) -> Option<String> {
        if self.confidence.hides_probability() || is_beyond_range(self.probability_by_tests) {
            return None;
        }
        let of_walk = (self.probability_no_erosion, self.probability_bound);
        probabilities(of_walk, self.probability_by_tests, self.beyond_tests)
    }
}

impl WalkedBatch {
    /// A batch of these rows.
    pub fn new(samples: String, filters: Vec<BatchFilter>, rows: Vec<WalkedRow>) -> Self {
        Self {
            version: env!("CARGO_PKG_VERSION").into(),
            commit: commit(),
            work: String::new(),
            seed: 0,
            samples,
            filters,
            rows,
            notes: Vec::new(),
            threshold: THRESHOLD,
            cover: SheetCover::default(),
            inches: false,
            model_leaves_out: Vec::new(),
        }
    }

    /// The rows of a filter.
    pub fn of_filter(&self, filter: &str) -> impl Iterator<Item = &WalkedRow> {
        self.rows.iter().filter(move |row| row.rules.filter == filter)
    }
}

impl WalkedRow {
    fn depth(&self) -> &'static str {
        self.walk.as_ref().map_or("not walked", SampleWalk::depth)
    }

    fn why_not(&self) -> Option<String> {
        self.walk.is_none().then(|| self.not_walked.clone()).filter(|why| !why.is_empty())
    }

    /// The columns of `batch.csv`, and under their headings what a terminal and a page show, sizes in this
    /// unit.
    pub fn columns<'a>(unit: SizeUnit) -> Columns<'a, Self> {
        let walk = |row: &Self| row.walk.clone();
        let of_walk = Columns::default()
            .column("governs", |row: &Self| row.governs)
            .headed("Governs")
            .column("walked", |row: &Self| row.depth())
            .words("Walked", |row: &Self| row.depth().shown().below(row.why_not()))
            .column("class", move |row| walk(row).map(|walk| walk.verdict))
            .headed("Class by walk")
            .confidence(|row| row.walk.as_ref().map(|walk| walk.confidence), |_| None)
            .column("replicates", move |row| walk(row).map(|walk| walk.replicates))
            .digits("d15f_over_d85b", 4, move |row| walk(row).map(|walk| walk.ratios.d15f_over_d85b))
            .eroded(|row, run| {
                let walk = row.walk.as_ref();
                let range = walk.and_then(|walk| walk.curve_range.get(run).copied());
                (walk.and_then(|walk| walk.runs.get(run).copied()), range)
            })
            .percent("probability_no_erosion_percent", move |row| walk(row)?.probability_no_erosion)
            .words("Probability of no erosion in a test", move |row| walk(row)?.probability_in_words())
            .column("probability_bound", move |row| {
                let bound = walk(row)?.probability_bound?;
                Some(if bound == Bound::AtLeast { "at least" } else { "at most" })
            })
            .percent("probability_by_tests_percent", move |row| walk(row)?.probability_by_tests)
            .column("reason", move |row| walk(row)?.reason)
            .column("not_walked", |row: &Self| row.not_walked.clone())
            .column("folder", move |row| walk(row).map(|walk| walk.folder));
        columns(unit).of_part(|row: &Self| &row.rules).and(of_walk).only(&SHOWN)
    }
}
