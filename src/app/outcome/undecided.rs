//! Causes that leave a verdict undecided.

use serde::{Deserialize, Serialize};

use super::record::{CurveRange, Outcome, RunSummary, Verdict};

/// What leaves a verdict undecided.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "cli", derive(schemars::JsonSchema))]
pub enum UndecidedBy {
    /// The ends of the constriction curve's range give another class than the curve itself.
    #[serde(rename = "constriction curve")]
    Curve,
    /// The second run, which was not asked for, would tell the classes apart.
    #[serde(rename = "second run")]
    SecondRun,
    /// The replicates.
    #[serde(rename = "replicates")]
    Replicates,
}

impl UndecidedBy {
    /// All causes.
    pub const ALL: [Self; 3] = [Self::Curve, Self::SecondRun, Self::Replicates];
}

impl Outcome {
    /// The cause that leaves the verdict undecided; `None` if it is decided.
    pub fn undecided_by(&self) -> Option<UndecidedBy> {
        if self.model.class != Verdict::Undecided {
            return None;
        }
        let erodes = |run: &RunSummary| {
            let eroded = &run.eroded_mass_fraction;
            eroded.low.unwrap_or(eroded.mean) >= self.threshold
        };
        Some(if self.curve_range.as_ref().is_some_and(CurveRange::leaves_open) {
            UndecidedBy::Curve
        } else if self.summary.len() == 1 && self.summary.iter().all(erodes) {
            UndecidedBy::SecondRun
        } else {
            UndecidedBy::Replicates
        })
    }
}
