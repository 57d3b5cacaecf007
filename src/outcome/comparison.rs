//! Several cases side by side: their verdicts, and how much their eroded masses differ.
//!
//! All cases are walked with the same seed, so that replicate *i* of one shares its random numbers with
//! replicate *i* of every other. The difference of two cases is then the mean of the differences of their
//! replicates, with Student's interval over those (a paired t interval; common random numbers): what chance
//! does to both alike is not in it.

use serde::{Deserialize, Serialize};

use super::record::{
    Headline, Model, ModelLimit, Outcome, Practice, Ratios, SheetCover, Statistic, Verdict, commit,
};
use super::{BaseSize, leaves_out_of_all};
use crate::outcome::record::Note;

/// Error of all differences together where it is said that two cases differ.
const ERROR: f64 = 0.05;

/// The whole of `compare.json`.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
pub struct Comparison {
    /// What is compared: `filters`, `bases` or `scenes`.
    pub of: String,
    /// What all cases have in common, as the base of several filters; empty where they are scenes.
    pub common: String,
    /// Seed of every case.
    pub seed: u64,
    /// Version of the program.
    pub version: String,
    /// The commit that it was built from; `None` where that is not known.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub commit: Option<String>,
    /// The cases, in the order in which they were named.
    pub cases: Vec<ComparedCase>,
    /// Every two cases, in that order, for each run that both have.
    pub pairs: Vec<ComparedPair>,
    /// Eroded mass fraction that divides the classes: 0.075.
    pub threshold: f64,
    /// What the sheet says of itself.
    #[serde(default, skip_serializing_if = "SheetCover::is_unset")]
    pub cover: SheetCover,
    /// Whether inches stand beside mm on page and terminal.
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub inches: bool,
    /// What no case contains.
    pub model_leaves_out: Vec<ModelLimit>,
}

/// A case of a comparison.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
pub struct ComparedCase {
    /// Its name.
    pub name: String,
    /// Folder of its results, inside the comparison's.
    pub folder: String,
    /// The class that its replicates together support.
    pub verdict: Verdict,
    /// The rules of practice that were made for these soils and are not kept, by name.
    pub rules_not_kept: Vec<String>,
    /// The class as which practice counts.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub by_practice: Option<Verdict>,
    /// The answer of practice; `None` without two sieve curves in mm.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub headline: Option<Headline>,
    /// What filter practice says of the pair; `None` likewise.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub practice: Option<Practice>,
    /// What the walk says.
    pub model: Model,
    /// What else to know, in the order of every face.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub notes: Vec<Note>,
    /// Replicates.
    pub replicates: u64,
    /// Thickness of the filter along the flow (mm); `None` where the network does not say.
    pub thickness_mm: Option<f64>,
    /// Whether sizes are multiples of D0F instead of mm.
    pub scale_free: bool,
    /// Base particles of each run.
    pub n_base: u64,
    /// Filter grains per void, where given.
    pub grains_per_void: Option<f64>,
    /// D15F over D85B and D95B.
    pub ratios: Ratios,
    /// D85B and which base it is of; `None` without a unit.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub base: Option<BaseSize>,
    /// Eroded mass fraction of each run.
    pub runs: Vec<Statistic>,
    /// Least and most eroded over the range of the constriction curve, one pair per run; empty where the
    /// curve is no range.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub curve_range: Vec<[f64; 2]>,
}

/// How much two cases differ in one run.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
pub struct ComparedPair {
    /// The one.
    pub first: String,
    /// The other.
    pub second: String,
    /// 1 or 2.
    pub run: u64,
    /// Pairs of replicates.
    pub replicates: u64,
    /// Eroded mass fraction of the one less that of the other, with the 95 % interval of this difference.
    pub difference: Statistic,
    /// Interval that holds for all differences of the comparison at once with 95 % (Bonferroni); `None` with
    /// one pair of replicates.
    pub joint: Option<[f64; 2]>,
    /// Whether that interval leaves 0 out; `None` with one pair of replicates.
    pub differ: Option<bool>,
}

impl Comparison {
    /// Compares outcomes, each with its name and its folder.
    pub fn new(of: &str, common: &str, seed: u64, outcomes: &[(String, String, Outcome)]) -> Self {
        let cases = outcomes.iter().map(|(name, folder, outcome)| ComparedCase::new(name, folder, outcome));
        let of_pair = |&(a, b): &(usize, usize)| differences(&outcomes[a].2, &outcomes[b].2);
        let pairs: Vec<(usize, usize)> =
            (0..outcomes.len()).flat_map(|a| (a + 1..outcomes.len()).map(move |b| (a, b))).collect();
        let all: Vec<Vec<Vec<f64>>> = pairs.iter().map(of_pair).collect();
        let count = all.iter().map(Vec::len).sum::<usize>().max(1);
        let mut compared = Vec::new();
        for (&(a, b), runs) in pairs.iter().zip(&all) {
            for (run, values) in (1..).zip(runs) {
                compared.push(ComparedPair::new(&outcomes[a].0, &outcomes[b].0, run, values, count));
            }
        }
        Self {
            of: of.into(),
            common: common.into(),
            seed,
            version: env!("CARGO_PKG_VERSION").into(),
            commit: commit(),
            cases: cases.collect(),
            pairs: compared,
            threshold: super::verdict::THRESHOLD,
            cover: SheetCover::default(),
            inches: false,
            model_leaves_out: leaves_out_of_all(outcomes.iter().map(|(.., outcome)| outcome.modelled())),
        }
    }

    /// Whether a case has a range of its constriction curve, which no interval of a difference holds.
    pub fn has_range_of_curve(&self) -> bool {
        self.cases.iter().any(|case| !case.curve_range.is_empty())
    }
}

/// Differences of the replicates that two outcomes share, for each run that both have.
fn differences(one: &Outcome, other: &Outcome) -> Vec<Vec<f64>> {
    let runs = one.summary.len().min(other.summary.len());
    let shared = || one.replicates.iter().zip(&other.replicates).filter(|(a, b)| a.seed == b.seed);
    let of_run = |run: usize| -> Vec<f64> {
        let eroded = |r: &super::record::Replicate| r.runs.get(run).map(|run| run.eroded_mass_fraction);
        shared().filter_map(|(a, b)| Some(eroded(a)? - eroded(b)?)).collect()
    };
    (0..runs).map(of_run).filter(|values| !values.is_empty()).collect()
}

impl ComparedCase {
    fn new(name: &str, folder: &str, outcome: &Outcome) -> Self {
        let broken = outcome.rules.iter().filter(|rule| rule.is_broken());
        Self {
            name: name.into(),
            folder: folder.into(),
            verdict: outcome.model.class,
            by_practice: None,
            headline: outcome.headline,
            practice: outcome.practice.clone(),
            model: outcome.model.clone(),
            notes: outcome.notes.clone(),
            rules_not_kept: broken.map(|rule| rule.name.clone()).collect(),
            replicates: outcome.replicates.len() as u64,
            thickness_mm: outcome.inputs.network.thickness_mm,
            scale_free: outcome.inputs.scale_free,
            n_base: outcome.n_base,
            grains_per_void: outcome.grains_per_void,
            ratios: outcome.ratios,
            base: outcome.inputs.base_size(),
            runs: outcome.summary.iter().map(|run| run.eroded_mass_fraction).collect(),
            curve_range: outcome
                .curve_range
                .as_ref()
                .map_or_else(Vec::new, |range| range.eroded_mass_fraction.clone()),
        }
    }
}

impl ComparedPair {
    /// The differences `values` of one run, one of `count` that are looked at together.
    fn new(first: &str, second: &str, run: u64, values: &[f64], count: usize) -> Self {
        let joint = Statistic::with_error(values, ERROR / count as f64);
        let joint = joint.low.zip(joint.high).map(|(low, high)| [low, high]);
        Self {
            first: first.into(),
            second: second.into(),
            run,
            replicates: values.len() as u64,
            difference: Statistic::of(values),
            joint,
            differ: joint.map(|[low, high]| low > 0.0 || high < 0.0),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn pair(values: &[f64], count: usize) -> ComparedPair {
        ComparedPair::new("a", "b", 1, values, count)
    }

    /// Three differences by hand: 0.02 -+ 4.303 * 0.01 / sqrt(3).
    #[test]
    fn a_difference_has_the_interval_of_the_paired_t_test() {
        let one = pair(&[0.01, 0.02, 0.03], 1);
        let half = 4.302_652_730 * 0.01 / 3f64.sqrt();
        assert!((one.difference.low.unwrap() - (0.02 - half)).abs() < 1e-9);
        assert_eq!(one.joint, one.difference.low.zip(one.difference.high).map(|(low, high)| [low, high]));
        assert_eq!(one.differ, Some(false));
    }

    /// What would count as different alone does not where thirty differences are looked at.
    #[test]
    fn many_differences_ask_for_more_of_each() {
        let values = [0.010, 0.012, 0.030, 0.032];
        assert_eq!((pair(&values, 1).differ, pair(&values, 30).differ), (Some(true), Some(false)));
        assert_eq!(pair(&values, 1).difference, pair(&values, 30).difference);
        let less = pair(&values.map(|value| -value), 1);
        assert!(less.differ == Some(true) && less.difference.mean < 0.0, "{less:?}");
    }

    #[test]
    fn one_replicate_decides_nothing() {
        let one = pair(&[0.5], 1);
        assert_eq!((one.joint, one.differ), (None, None));
        assert_eq!(pair(&[0.0, 0.0], 1).differ, Some(false));
    }
}
