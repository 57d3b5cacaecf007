//! Many samples against filters: what practice says of each pair, and beside it what its walk says.

use serde::{Deserialize, Serialize};

use super::batch::{BatchRow, columns};
use super::batch_table::BatchFilter;
use super::practice::counts_as;
use crate::outcome::BaseSize;
use crate::outcome::numbers::SizeUnit;
use crate::outcome::record::{
    Headline, IfDispersive, ModelLimit, Outcome, Ratios, SheetCover, Statistic, Verdict, commit,
};
use crate::outcome::table::{Columns, TableCell};
use crate::outcome::verdict::THRESHOLD;

/// Columns of the table that a terminal and a page show; all are in the file.
const SHOWN: [&str; 11] = [
    "sample",
    "filter",
    "group",
    "d85b_mm",
    "limit_mm",
    "result",
    "governs",
    "walked",
    "class",
    "first_eroded_mass_percent",
    "note",
];

/// The whole of `batch.json`.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
pub struct WalkedBatch {
    /// Version of the program.
    pub version: String,
    /// The commit that it was built from; `None` where that is not known.
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
    /// What the sheet says of itself.
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
    /// The answer of practice; `None` without two sieve curves in mm.
    pub headline: Option<Headline>,
    /// The class that its replicates together support.
    pub verdict: Verdict,
    /// The class as which practice counts; `None` without a rule.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub by_practice: Option<Verdict>,
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
}

impl SampleWalk {
    /// Of the outcome in this folder.
    pub fn of(outcome: &Outcome, folder: String, in_full: bool) -> Self {
        let range = outcome.curve_range.as_ref();
        Self {
            folder,
            in_full,
            headline: outcome.headline,
            verdict: outcome.model.class,
            by_practice: counts_as(&outcome.rules),
            replicates: outcome.replicates.len() as u64,
            ratios: outcome.ratios,
            base: outcome.inputs.base_size(),
            runs: outcome.summary.iter().map(|run| run.eroded_mass_fraction).collect(),
            curve_range: range.map_or_else(Vec::new, |range| range.eroded_mass_fraction.clone()),
            if_dispersive: outcome.if_dispersive,
        }
    }

    /// How it was walked, in words.
    pub fn depth(&self) -> &'static str {
        if self.in_full { "in full" } else { "first look" }
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
            .column("replicates", move |row| walk(row).map(|walk| walk.replicates))
            .digits("d15f_over_d85b", 4, move |row| walk(row).map(|walk| walk.ratios.d15f_over_d85b))
            .eroded(|row, run| {
                let walk = row.walk.as_ref();
                let range = walk.and_then(|walk| walk.curve_range.get(run).copied());
                (walk.and_then(|walk| walk.runs.get(run).copied()), range)
            })
            .column("not_walked", |row: &Self| row.not_walked.clone())
            .column("folder", move |row| walk(row).map(|walk| walk.folder));
        columns(unit).of_part(|row: &Self| &row.rules).and(of_walk).only(&SHOWN)
    }
}
