//! Answer of a case as facts: practice beside the walks, each with its notes. No walk changes the answer
//! of practice.

pub(crate) mod walks;

pub(crate) use walks::PlannedWalk;

use crate::outcome::packing::PackingRecord;
use crate::outcome::record::{Manifest, ModelLimit, Outcome, Ratios, Statistic, Verdict, commit};
use crate::outcome::verdict::THRESHOLD;
use crate::outcome::{BaseSize, Recorded};
use serde::{Deserialize, Serialize};
use voidwalk_practice::decision::Standing;
use voidwalk_practice::{AboutPage, BatchFilter, BatchRow, Decision, Headline, SheetCover, TestedClass};

/// Contents of the files of a run folder, and derived values for its page.
pub struct RunFiles {
    /// `outcome.json`.
    pub outcome: Outcome,
    /// Decision of practice on the pair.
    pub decision: Decision,
    /// `manifest.json`.
    pub manifest: Manifest,
    /// `scene.toml`.
    pub scene: String,
    /// Page settings of the scene.
    pub about: AboutPage,
    /// `inputs/packing.json`, if the filter was packed.
    pub packing: Option<PackingRecord>,
    /// The rows of the CSV files.
    pub recorded: Recorded,
}

/// Class of practice for comparison with verdicts: the worst that is not excluded; `None` if no rule of
/// design was applied.
pub(crate) fn counts_as(decision: &Decision) -> Option<Verdict> {
    let coarse = match decision.tests {
        TestedClass::Continuing => Verdict::Continuing,
        TestedClass::Unknown if decision.is_beyond_tests => Verdict::Undecided,
        _ => Verdict::Some,
    };
    match decision.standing {
        Standing::NoRules => None,
        Standing::Met => Some(Verdict::None),
        Standing::Unknown(_) | Standing::Open(_) => Some(Verdict::Undecided),
        Standing::NoMargin | Standing::Unstable => Some(Verdict::Some),
        Standing::WashedOut if decision.washout.as_ref().is_some_and(|washout| washout.continues) => {
            Some(Verdict::Continuing)
        }
        Standing::Fails | Standing::WashedOut => Some(coarse),
    }
}

/// Contents of `batch.json`.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "cli", derive(schemars::JsonSchema))]
pub(crate) struct WalkedBatch {
    /// Version of the program.
    pub(crate) version: String,
    /// Commit that the program was built from; `None` if it is not known.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub(crate) commit: Option<String>,
    /// Hash of all inputs of the rows: samples, filters and settings.
    pub(crate) work: String,
    /// Seed of every walk.
    pub(crate) seed: u64,
    /// Samples as named by the user.
    pub(crate) samples: String,
    /// Filters of the batch.
    pub(crate) filters: Vec<BatchFilter>,
    /// Curve of the one base as sampled, rows of (size in mm, percent finer by mass); absent if each soil
    /// is a sample.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub(crate) base: Vec<[f64; 2]>,
    /// One row for each filter and sample, grouped by filter.
    pub(crate) rows: Vec<WalkedRow>,
    /// Assumptions about the files, one sentence each.
    pub(crate) notes: Vec<String>,
    /// Eroded mass fraction that divides the classes: 0.075.
    pub(crate) threshold: f64,
    /// Cover of the sheet.
    #[serde(default, skip_serializing_if = "SheetCover::is_unset")]
    pub(crate) cover: SheetCover,
    /// True if page and terminal show inches beside mm.
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub(crate) inches: bool,
    /// Processes that every walk omits.
    pub(crate) model_leaves_out: Vec<ModelLimit>,
}

/// One sample and one filter.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "cli", derive(schemars::JsonSchema))]
pub(crate) struct WalkedRow {
    /// Answer of practice.
    #[serde(flatten)]
    pub(crate) rules: BatchRow,
    /// Rank by the rules: 1 for the sample that governs the filter, 2 and 3 for the next.
    pub(crate) governs: Option<u64>,
    /// Result of the walk; `None` if there was none.
    pub(crate) walk: Option<SampleWalk>,
    /// Reason why it was not walked; empty if it was.
    #[serde(default, skip_serializing_if = "String::is_empty")]
    pub(crate) not_walked: String,
}

/// Result of the walk of one sample.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "cli", derive(schemars::JsonSchema))]
pub(crate) struct SampleWalk {
    /// Folder of its results, inside the batch's folder.
    pub(crate) folder: String,
    /// True if it was walked in full, false for a first look.
    pub(crate) in_full: bool,
    /// Answer of practice; `None` without two sieve curves in mm.
    pub(crate) headline: Option<Headline>,
    /// Class supported by all replicates together.
    pub(crate) verdict: Verdict,
    /// Class of practice; `None` without a rule.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub(crate) by_practice: Option<Verdict>,
    /// Number of replicates.
    pub(crate) replicates: u64,
    /// D15F over D85B and D95B.
    pub(crate) ratios: Ratios,
    /// D85B, and the base that it belongs to.
    pub(crate) base: Option<BaseSize>,
    /// Eroded mass fraction of each run.
    pub(crate) runs: Vec<Statistic>,
    /// Minimum and maximum eroded mass fraction over the range of the constriction curve, one pair for
    /// each run; empty if the curve has no range.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub(crate) curve_range: Vec<[f64; 2]>,
}

impl SampleWalk {
    /// Takes the results of the outcome in this folder.
    pub(crate) fn of(outcome: &Outcome, folder: String, in_full: bool) -> Self {
        let range = outcome.curve_range.as_ref();
        Self {
            folder,
            in_full,
            headline: outcome.headline,
            verdict: outcome.model.class,
            by_practice: counts_as(&outcome.decision()),
            replicates: outcome.replicates.len() as u64,
            ratios: outcome.ratios,
            base: outcome.inputs.base_size(),
            runs: outcome.summary.iter().map(|run| run.eroded_mass_fraction).collect(),
            curve_range: range.map_or_else(Vec::new, |range| range.eroded_mass_fraction.clone()),
        }
    }
}

impl WalkedBatch {
    /// Builds a batch of these rows.
    pub(crate) fn new(samples: String, filters: Vec<BatchFilter>, rows: Vec<WalkedRow>) -> Self {
        Self {
            version: env!("CARGO_PKG_VERSION").into(),
            commit: commit(),
            samples,
            filters,
            rows,
            threshold: THRESHOLD,
            ..Self::default()
        }
    }

    /// True for one base and several filters instead of samples.
    pub(crate) fn has_one_base(&self) -> bool {
        !self.base.is_empty()
    }

    /// Rows of a filter.
    pub(crate) fn of_filter(&self, filter: &str) -> impl Iterator<Item = &WalkedRow> {
        self.rows.iter().filter(move |row| row.rules.filter == filter)
    }

    /// Samples that govern a filter, strictest first.
    pub(crate) fn governing(&self, filter: &str) -> Vec<&WalkedRow> {
        let mut rows: Vec<&WalkedRow> = self.of_filter(filter).filter(|row| row.governs.is_some()).collect();
        rows.sort_by_key(|row| row.governs);
        rows
    }
}

impl WalkedRow {
    /// True if the walk erodes.
    pub(crate) fn erodes(&self) -> bool {
        let class = self.walk.as_ref().map(|walk| walk.verdict);
        matches!(class, Some(Verdict::Some | Verdict::Continuing))
    }

    /// True if a rule that is met is in doubt: another rule is not kept, or the walk erodes.
    pub(crate) fn is_doubted(&self) -> bool {
        self.is_against_practice() || self.erodes()
    }

    /// True if a rule of retention or of the filter's internal stability is not kept.
    pub(crate) fn is_against_practice(&self) -> bool {
        let breaks = |walk: &SampleWalk| walk.by_practice.is_some_and(|class| class != Verdict::None);
        self.walk.as_ref().is_some_and(breaks) || self.rules.met == Some(false) || self.rules.may_lose_fines
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::test_soils::{filter, soil};
    use voidwalk_practice::{PairOptions, PairRules, PracticeClass};

    #[test]
    fn what_is_accepted_follows_where_the_filter_stands() {
        let sand = soil(&[(0.2, 0.0), (0.6, 100.0)]);
        let hidden = soil(&[(0.3, 25.0), (1.0, 100.0)]);
        let gap = [(0.3, 0.0), (0.36, 15.0), (2.4, 15.0), (6.0, 100.0)];
        let halved = gap.map(|(size, percent)| (0.5 * size, percent));
        for (base, filter, class, counts) in [
            (&sand, filter(1.0), PracticeClass::Meets, Verdict::None),
            (&sand, filter(2.5), PracticeClass::DoesNotMeet, Verdict::Some),
            (&sand, filter(4.0), PracticeClass::DoesNotMeet, Verdict::Some),
            (&sand, filter(6.0), PracticeClass::DoesNotMeet, Verdict::Continuing),
            (&sand, soil(&halved), PracticeClass::NotKnown, Verdict::Some),
            (&hidden, filter(1.0), PracticeClass::NotKnown, Verdict::Undecided),
        ] {
            let pair = PairRules::of_envelopes(base, &filter, PairOptions::default());
            let recorded = pair.practice.as_ref().unwrap().class;
            assert_eq!((recorded, counts_as(&pair.decision())), (class, Some(counts)));
        }
        assert_eq!(counts_as(&Decision::new(&[], None, None)), None);
    }
}
