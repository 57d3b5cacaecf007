//! A case with one thing changed: base particles, thickness, constriction curve.

use serde::{Deserialize, Serialize};

use super::{Statistic, Verdict};

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
