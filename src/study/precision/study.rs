//! What a precision study is given: a scene, its parts, a budget; and why it can end early.

use std::sync::atomic::AtomicBool;

use crate::case::{Case, CaseError};
use crate::constrictions::{ConstrictionsError, CurveError, TriangulationError};
use crate::gradation::GradationError;
use crate::network::NetworkError;
use crate::packing::PackingError;
use crate::walk::WalkError;

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

/// Why a study ended early.
#[derive(Debug, thiserror::Error)]
pub enum PrecisionError {
    /// The scene.
    #[error(transparent)]
    Case(#[from] CaseError),
    /// A gradation.
    #[error(transparent)]
    Gradation(#[from] GradationError),
    /// A network.
    #[error(transparent)]
    Network(#[from] NetworkError),
    /// A walk.
    #[error(transparent)]
    Walk(#[from] WalkError),
    /// A packing.
    #[error(transparent)]
    Packing(#[from] PackingError),
    /// A triangulation.
    #[error(transparent)]
    Triangulation(#[from] TriangulationError),
    /// A packing's constrictions.
    #[error(transparent)]
    Constrictions(#[from] ConstrictionsError),
    /// A constriction curve.
    #[error(transparent)]
    Curve(#[from] CurveError),
    /// Threads cannot be had.
    #[error("cannot start a thread: {0}")]
    Threads(#[from] rayon::ThreadPoolBuildError),
    /// It was asked to stop.
    #[error("stopped on request; a precision study begins anew")]
    Stopped,
}

/// What is studied, and how much of it.
pub struct Study<'a> {
    /// The scene.
    pub case: &'a Case,
    /// Tiers, each once.
    pub tiers: &'a [Tier],
    /// Processor time to spend on all of them (s).
    pub budget_s: f64,
    /// Runs side by side.
    pub threads: usize,
    /// Called with a line of text where a piece of work begins.
    pub tell: &'a (dyn Fn(&str) + Sync),
    /// Set to stop.
    pub stop: &'a AtomicBool,
}
