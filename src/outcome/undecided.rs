//! What leaves a verdict undecided, and so what would decide it.

use serde::{Deserialize, Serialize};

use super::record::{Outcome, RunSummary, Stopping, Verdict};

/// What leaves a verdict undecided.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum UndecidedBy {
    /// The two readings of the base's finest part give different classes.
    #[serde(rename = "pan fraction")]
    Pan,
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
    /// All of them.
    pub const ALL: [Self; 4] = [Self::Pan, Self::Curve, Self::SecondRun, Self::Replicates];

    /// Why, in a sentence without its end.
    pub fn words(self) -> &'static str {
        match self {
            Self::Pan => {
                "the finest part of the base, whose sizes the sieves do not tell, decides between the classes"
            }
            Self::Curve => {
                "the constriction curve is known within a range only, and its ends do not give one class"
            }
            Self::SecondRun => {
                "some and continuing erosion differ by the second run, and only a first was asked for"
            }
            Self::Replicates => "the replicates do not separate the classes; more replicates may decide it",
        }
    }
}

impl Outcome {
    /// What leaves the verdict undecided; `None` where it is decided.
    pub fn undecided_by(&self) -> Option<UndecidedBy> {
        if self.verdict != Verdict::Undecided {
            return None;
        }
        let erodes = |run: &RunSummary| {
            let eroded = &run.eroded_mass_fraction;
            eroded.low.unwrap_or(eroded.mean) >= self.threshold
        };
        Some(if self.pan_bounds.as_ref().is_some_and(|bounds| bounds.differ()) {
            UndecidedBy::Pan
        } else if self.curve_range.as_ref().is_some_and(|range| range.whole() != range.verdict) {
            UndecidedBy::Curve
        } else if self.summary.len() == 1 && self.summary.iter().all(erodes) {
            UndecidedBy::SecondRun
        } else {
            UndecidedBy::Replicates
        })
    }

    /// How the other points of a study are classed, where their classes know nothing of what leaves the
    /// verdict undecided.
    pub fn points_are(&self) -> Option<&'static str> {
        let level = self.stopping.as_ref().and_then(|stopping| stopping.decide_percent);
        match self.undecided_by()? {
            UndecidedBy::Pan => Some("with the base's finest part finer than every constriction"),
            UndecidedBy::Curve => Some("by the curve itself"),
            UndecidedBy::SecondRun | UndecidedBy::Replicates => level.map(|_| "by their 95 % intervals"),
        }
    }

    /// What to do where the replicates leave the class open and nothing is said of them already.
    pub fn what_would_decide(&self) -> Option<&'static str> {
        // A target error that was met says nothing of the class.
        let said = |stopping: &Stopping| stopping.sentence.is_some() || stopping.decide_percent.is_some();
        if self.stopping.as_ref().is_some_and(said) {
            return None;
        }
        match self.undecided_by()? {
            UndecidedBy::Pan | UndecidedBy::Curve => None,
            UndecidedBy::SecondRun => Some("two runs tell some from continuing erosion (runs = 2)"),
            UndecidedBy::Replicates => {
                Some("more replicates may decide it: --decide 99% adds them until the class is that certain")
            }
        }
    }
}
