//! What a precision study is given: a scene, its tiers, a budget.

use std::str::FromStr;

use crate::case::Case;
use crate::run::callbacks::{Callbacks, Event};
use crate::run::error::RunError;

/// A part of a precision study, as the table of [the module](super) lists them.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Tier {
    /// Against exact answers.
    Exact,
    /// Error of the scene's eroded mass.
    Sampling,
    /// What settings do to the scene's eroded mass.
    Bias,
    /// Wrong classes.
    Decision,
    /// Time against size.
    Scaling,
    /// Packings and triangulations.
    Packing,
}

impl Tier {
    /// Every tier, in the order of the page.
    pub const ALL: [Tier; 6] =
        [Tier::Exact, Tier::Sampling, Tier::Bias, Tier::Decision, Tier::Scaling, Tier::Packing];

    /// Its name on the command line and in `precision.json`.
    pub fn name(self) -> &'static str {
        self.about().0
    }

    /// Its name, what it measures, and its part of the budget before those that are not wanted are left out.
    pub(super) fn about(self) -> (&'static str, &'static str, f64) {
        match self {
            Tier::Exact => ("exact", "every engine against the linear solve and closed forms", 0.25),
            Tier::Sampling => ("sampling", "the scatter of the scene's eroded mass, by engine", 0.2),
            Tier::Bias => ("bias", "settings against the reference setting", 0.22),
            Tier::Decision => ("decision", "wrong classes near 7.5 %", 0.14),
            Tier::Scaling => ("scaling", "time against base particles, voids and threads", 0.08),
            Tier::Packing => ("packing", "packings and triangulations", 0.11),
        }
    }
}

impl FromStr for Tier {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let named = Self::ALL.into_iter().find(|tier| tier.name() == text);
        let allowed = || Self::ALL.map(Self::name).join(", ");
        named.ok_or_else(|| format!("there is no such tier; allowed: {}", allowed()))
    }
}

/// What is studied, and how much of it.
pub struct PrecisionStudy<'a> {
    /// The scene.
    pub case: &'a Case,
    /// Tiers, each once.
    pub tiers: &'a [Tier],
    /// Processor time to spend on all of them (s).
    pub budget_s: f64,
    /// Runs side by side.
    pub threads: usize,
    /// Who follows it, and stops it.
    pub callbacks: &'a Callbacks<'a>,
}

impl PrecisionStudy<'_> {
    /// Says what it is at.
    pub(super) fn tell(&self, what: &str) {
        (self.callbacks.on_event)(Event::Studying(what));
    }
}

/// It was asked to stop.
pub(super) fn stopped() -> RunError {
    RunError::Stopped("stopped on request".into())
}
