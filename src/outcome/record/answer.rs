//! What replicates say together: their class, their mean, and why no more of them were walked.

use serde::{Deserialize, Serialize};

/// The paper's three classes, after Foster and Fell, and a fourth for what these replicates leave open.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize, Deserialize)]
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

/// What a rule that adds replicates until they are enough arrived at.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
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
    pub sentence: Option<String>,
}

/// A mean, and with two or more replicates its standard deviation and interval.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
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
