//! The answer of the replicates: their class, their mean, the reason why no more were walked, and the answers
//! of the case with one thing changed.

use super::inputs::NetworkKind;
use serde::{Deserialize, Serialize};

/// The paper's three classes, after Foster and Fell, and a fourth for what these replicates leave open.
///
/// ```
/// use voidwalk_app::Verdict;
/// assert_eq!(Verdict::ALL.map(Verdict::words)[..2], ["no erosion", "some erosion"]);
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[cfg_attr(feature = "cli", derive(schemars::JsonSchema))]
pub enum Verdict {
    /// Less than the threshold eroded in the first run.
    #[serde(rename = "no erosion")]
    None,
    /// The threshold reached in the first run, not in the second.
    #[serde(rename = "some erosion")]
    Some,
    /// The threshold reached in both runs.
    #[serde(rename = "continuing erosion")]
    Continuing,
    /// An interval straddles the threshold, or a run that would decide is missing.
    #[serde(rename = "undecided")]
    Undecided,
}

impl Verdict {
    /// Every class, in the order of `replicate_verdicts`.
    pub const ALL: [Verdict; 4] = [Verdict::None, Verdict::Some, Verdict::Continuing, Verdict::Undecided];

    /// Its name in `outcome.json` and in every table.
    pub fn words(self) -> &'static str {
        match self {
            Verdict::None => "no erosion",
            Verdict::Some => "some erosion",
            Verdict::Continuing => "continuing erosion",
            Verdict::Undecided => "undecided",
        }
    }
}

/// What the walks say together.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "cli", derive(schemars::JsonSchema))]
pub struct Model {
    /// The class that the replicates together support.
    pub class: Verdict,
    /// Mass eroded (%) of each run, least and most: the 95 % interval of the mean over the replicates, or the
    /// range of the constriction curve; the mean twice with one replicate.
    pub eroded_percent: Vec<[f64; 2]>,
    /// Replicates.
    pub replicates: u64,
    /// The network that was walked.
    pub network: NetworkKind,
}

/// What a rule that adds replicates until they are enough arrived at.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "cli", derive(schemars::JsonSchema))]
pub struct Stopping {
    /// Target half width of the 95 % interval of the eroded mass, in every run (percentage points of the
    /// base).
    pub target_error_pp: Option<f64>,
    /// Confidence level at which the verdict was to be decided (%), corrected for repeated looks.
    pub decide_percent: Option<f64>,
    /// Replicates at which it stops in any case.
    pub most: u64,
    /// How often it looked at the replicates.
    pub looks: u64,
    /// Whether what was asked for is reached.
    pub met: bool,
    /// The verdict at that confidence level, where one was asked for.
    pub verdict: Option<Verdict>,
    /// Widest half of the 95 % intervals of the eroded mass (percentage points); `None` with one replicate.
    pub half_width_pp: Option<f64>,
    /// Why it is not reached.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub short_of: Option<ShortOf>,
}

/// Why replicates do not reach what was asked for.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "cli", derive(schemars::JsonSchema))]
#[serde(rename_all = "snake_case")]
pub enum ShortOf {
    /// The first run alone does not separate two classes.
    SecondRun,
    /// The class is open.
    Decision {
        /// The run that leaves it open.
        run: u64,
        /// Its mean (%).
        mean_percent: f64,
        /// How far that lies from the threshold (percentage points).
        distance_pp: f64,
        /// The scatter of its replicates (percentage points).
        sd_pp: f64,
        /// About how many replicates would decide it; `None` where none will.
        needed: Option<u64>,
    },
    /// The interval is too wide.
    Target {
        /// Half of it (percentage points).
        half_width_pp: f64,
        /// Replicates.
        replicates: u64,
        /// About how many would do.
        needed: u64,
    },
}

/// A mean, and with two or more replicates its standard deviation and interval.
///
/// ```
/// use voidwalk_app::Statistic;
/// let of = Statistic::of(&[0.10, 0.12, 0.14]);
/// assert!(of.low.unwrap() < of.mean && of.mean < of.high.unwrap());
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "cli", derive(schemars::JsonSchema))]
pub struct Statistic {
    /// Mean over the replicates.
    pub mean: f64,
    /// Sample standard deviation.
    pub sd: Option<f64>,
    /// Lower end of the 95 % interval of the mean.
    pub low: Option<f64>,
    /// Upper end of the 95 % interval of the mean.
    pub high: Option<f64>,
}

/// The replicates of a case of which one thing was changed, and their class.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "cli", derive(schemars::JsonSchema))]
pub struct Classed {
    /// How many replicates were walked.
    pub replicates: u64,
    /// Whether it was clear before all replicates of a study were walked: its intervals then take twice the
    /// scatter of the scene's own replicates, or its own where that is wider
    /// (`crate::outcome::early_stop`).
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub stopped_when_clear: bool,
    /// Their class.
    pub verdict: Verdict,
    /// Eroded mass fraction, one per run.
    pub runs: Vec<Statistic>,
}

/// The outcome with another number of base particles.
///
/// `N_base` holds grains per void and mass ratio only as a product (Eq. 2), so one factor answers for both.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "cli", derive(schemars::JsonSchema))]
pub struct Sensitivity {
    /// Multiple of the outcome's own `n_base`.
    pub factor: f64,
    /// Base particles inserted in each run.
    pub n_base: u64,
    /// Grains per void to which this factor corresponds at the scene's mass ratio.
    pub grains_per_void: Option<f64>,
    /// Mass ratio to which this factor corresponds at the scene's grains per void.
    pub mass_ratio: Option<f64>,
    /// What was walked.
    #[serde(flatten)]
    pub walked: Classed,
}

/// The same case with a filter of this thickness.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "cli", derive(schemars::JsonSchema))]
pub struct OfThickness {
    /// Multiple of the outcome's own thickness.
    pub factor: f64,
    /// Layers of voids along the flow.
    pub layers: u64,
    /// Modelled thickness (mm, or D0F as all its sizes); `None` where a layer has none.
    pub thickness_mm: Option<f64>,
    /// Base particles inserted in each run.
    pub n_base: u64,
    /// What was walked.
    #[serde(flatten)]
    pub walked: Classed,
}

/// The walks at the ends of the range of a constriction curve.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "cli", derive(schemars::JsonSchema))]
pub struct CurveRange {
    /// The class by the curve itself.
    pub verdict: Verdict,
    /// The other curves of the range: its ends.
    pub ends: Vec<CurveEnd>,
    /// Whether the worst class of the range is the verdict, as for a filter of which loose and dense are
    /// walked; elsewhere ends that differ leave it undecided.
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub worst_counts: bool,
    /// The worst class that the walks of the range allow, at the confidence level of the verdict, where one
    /// was asked for; without one it follows from the 95 % intervals.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub could_be: Option<Verdict>,
    /// Least and most eroded over the whole range, one pair per run: the ends of the 95 % intervals, or the
    /// means of a single replicate (fraction of the mass).
    pub eroded_mass_fraction: Vec<[f64; 2]>,
}

/// The replicates walked with another constriction curve, all else and all random numbers the same.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "cli", derive(schemars::JsonSchema))]
pub struct CurveEnd {
    /// Which curve it is, in words.
    pub curve: String,
    /// Its median constriction by that of the curve itself.
    pub dc50_factor: f64,
    /// What was walked.
    #[serde(flatten)]
    pub walked: Classed,
}
