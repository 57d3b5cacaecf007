//! Answer of the replicates: their class, their mean, the reason for their number, and the answers of the
//! case with one thing changed.

use super::inputs::NetworkKind;
use serde::{Deserialize, Serialize};

/// Classes of the paper, after Foster and Fell, and a fourth class for an open result.
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
    /// The threshold is reached in the first run, not in the second.
    #[serde(rename = "some erosion")]
    Some,
    /// The threshold is reached in both runs.
    #[serde(rename = "continuing erosion")]
    Continuing,
    /// An interval straddles the threshold, or a run that would decide is missing.
    #[serde(rename = "undecided")]
    Undecided,
}

impl Verdict {
    /// Every class, in the order of `replicate_verdicts`.
    pub const ALL: [Verdict; 4] = [Verdict::None, Verdict::Some, Verdict::Continuing, Verdict::Undecided];

    /// Name in `outcome.json` and in every table.
    pub fn words(self) -> &'static str {
        match self {
            Verdict::None => "no erosion",
            Verdict::Some => "some erosion",
            Verdict::Continuing => "continuing erosion",
            Verdict::Undecided => "undecided",
        }
    }
}

/// Joint result of the walks.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "cli", derive(schemars::JsonSchema))]
pub struct Model {
    /// Class supported by all replicates together.
    pub class: Verdict,
    /// Minimum and maximum eroded mass (%) of each run: the 95 % interval of the mean over the
    /// replicates, or the range of the constriction curve; the mean twice for one replicate.
    pub eroded_percent: Vec<[f64; 2]>,
    /// Number of replicates.
    pub replicates: u64,
    /// Network that was walked.
    pub network: NetworkKind,
}

/// Result of a rule that adds replicates until there are enough.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "cli", derive(schemars::JsonSchema))]
pub struct Stopping {
    /// Target half width of the 95 % interval of the eroded mass, in every run (percentage points of the
    /// base).
    pub target_error_pp: Option<f64>,
    /// Confidence level of the verdict (%), corrected for repeated looks, if one was requested.
    pub decide_percent: Option<f64>,
    /// Maximum number of replicates.
    pub most: u64,
    /// Number of looks at the replicates.
    pub looks: u64,
    /// True if the request was met.
    pub met: bool,
    /// Verdict at that confidence level, if one was requested.
    pub verdict: Option<Verdict>,
    /// Largest half width of the 95 % intervals (percentage points of the base); `None` for one replicate.
    pub half_width_pp: Option<f64>,
    /// Reason why the request was not met.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub short_of: Option<ShortOf>,
}

/// Reason why replicates do not meet a request.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "cli", derive(schemars::JsonSchema))]
#[serde(rename_all = "snake_case")]
pub enum ShortOf {
    /// The first run alone does not separate two classes.
    SecondRun,
    /// The class is open.
    Decision {
        /// Run that leaves it open.
        run: u64,
        /// Mean of the run (%).
        mean_percent: f64,
        /// Distance of the mean from the threshold (percentage points).
        distance_pp: f64,
        /// Standard deviation of the replicates (percentage points).
        sd_pp: f64,
        /// Approximate number of replicates that would decide; `None` if none would.
        needed: Option<u64>,
    },
    /// The interval is too wide.
    Target {
        /// Half width of the interval (percentage points).
        half_width_pp: f64,
        /// Number of replicates.
        replicates: u64,
        /// Approximate number of replicates needed.
        needed: u64,
    },
}

/// Mean, and for two or more replicates its standard deviation and interval.
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

/// Replicates of a case with one thing changed, and their class.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "cli", derive(schemars::JsonSchema))]
pub struct Classed {
    /// Number of replicates walked.
    pub replicates: u64,
    /// True if the result was clear before all replicates of a study were walked. The intervals then use
    /// twice the scatter of the scene's own replicates, or the point's own if that is wider
    /// (`crate::outcome::early_stop`).
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub stopped_when_clear: bool,
    /// Class of these replicates.
    pub verdict: Verdict,
    /// Eroded mass fraction, one per run.
    pub runs: Vec<Statistic>,
}

/// Outcome with another number of base particles.
///
/// `N_base` contains grains per void and mass ratio only as a product (Eq. 2), so one factor covers both.
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
    /// Result of the walk.
    #[serde(flatten)]
    pub walked: Classed,
}

/// Outcome with another thickness of the filter.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "cli", derive(schemars::JsonSchema))]
pub struct OfThickness {
    /// Multiple of the outcome's own thickness.
    pub factor: f64,
    /// Layers of voids along the flow.
    pub layers: u64,
    /// Modelled thickness (mm, or multiples of D0F); `None` if a layer has no thickness.
    pub thickness_mm: Option<f64>,
    /// Base particles inserted in each run.
    pub n_base: u64,
    /// Result of the walk.
    #[serde(flatten)]
    pub walked: Classed,
}

/// Walks at the ends of the range of a constriction curve.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "cli", derive(schemars::JsonSchema))]
pub struct CurveRange {
    /// Class by the curve itself.
    pub(crate) verdict: Verdict,
    /// Other curves of the range: its ends.
    pub(crate) ends: Vec<CurveEnd>,
    /// True if the worst class of the range is the verdict, as for a filter walked both loose and dense;
    /// otherwise ends that differ leave it undecided.
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub(crate) worst_counts: bool,
    /// Worst class that the walks of the range allow at the confidence level of the verdict, if one was
    /// requested; otherwise it follows from the 95 % intervals.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub(crate) could_be: Option<Verdict>,
    /// Minimum and maximum eroded mass fraction over the whole range, one pair for each run: the ends of
    /// the 95 % intervals, or the means of a single replicate.
    pub(crate) eroded_mass_fraction: Vec<[f64; 2]>,
}

/// Replicates walked with another constriction curve; all other inputs and all random numbers are equal.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "cli", derive(schemars::JsonSchema))]
pub struct CurveEnd {
    /// Name of the curve, in words.
    pub curve: String,
    /// Its median constriction over that of the curve itself.
    pub dc50_factor: f64,
    /// Result of the walk.
    #[serde(flatten)]
    pub walked: Classed,
}
