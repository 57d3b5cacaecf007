//! Joint answer of the replicates: their class, their mean, and the reason why no more were walked.

use serde::{Deserialize, Serialize};

use super::inputs::NetworkKind;

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
