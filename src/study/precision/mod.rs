//! Error against run time: how much accuracy a second buys, tier by tier.
//!
//! | tier | question | error |
//! |---|---|---|
//! | `exact` | does each engine give what is known exactly? | against a linear solve, integers, closed forms |
//! | `sampling` | what does a second of the scene buy? | standard deviation over replicates |
//! | `bias` | what does a setting do to the answer? | difference from the reference setting |
//! | `decision` | how often is the class wrong? | against a long reference |
//! | `scaling` | what does a larger problem cost? | none: time alone |
//! | `packing` | what do settings do to packings, and what does a triangulation cost? | difference from the reference setting |
//!
//! # Budget and determinism
//! The budget is processor time. It decides how many replicates are walked, by the work that a run is counted to be (moves,
//! increments, voids) and never by the clock; so a seed and a budget give the same numbers on every machine and for any
//! number of threads. Only the times differ.
//!
//! # Time
//! Every run is walked by one thread, as many runs side by side as there are threads, and its time is the processor time of
//! that thread; only the scaling over threads walks one run with several.

mod bias;
mod changes;
mod closed_forms;
mod comparison;
mod decision;
mod exact;
mod first_run;
mod networks;
mod packing;
mod sampling;
mod scaling;
mod tables;
mod twin;
mod work;

pub use tables::tables;

use std::sync::atomic::AtomicBool;
use std::time::{Instant, SystemTime};

use crate::case::{Case, CaseError};
use crate::constrictions::{ConstrictionsError, CurveError, TriangulationError};
use crate::gradation::GradationError;
use crate::network::NetworkError;
use crate::outcome::precision::{NetworkRow, Precision};
use crate::packing::PackingError;
use crate::run::machine::Machine;
use crate::walk::WalkError;

/// Part of a precision study.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Tier {
    /// Against exact answers.
    Exact,
    /// Error of the scene's eroded mass.
    Sampling,
    /// What settings do to it.
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
    fn about(self) -> (&'static str, &'static str, f64) {
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

/// What is studied.
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

impl Study<'_> {
    /// Runs every tier: what `precision.json` holds, and the networks of the tier of exact answers, at the most particles of
    /// each line.
    ///
    /// # Errors
    /// A network, a walk or a packing that fails, or [`PrecisionError::Stopped`].
    pub fn run(&self) -> Result<(Precision, Vec<NetworkRow>), PrecisionError> {
        let (begun, started) = (Instant::now(), SystemTime::now());
        let record = self.case.record();
        let mut precision = Precision {
            version: env!("CARGO_PKG_VERSION").into(),
            commit: option_env!("VOIDWALK_COMMIT").map(String::from),
            machine: Machine::here().description,
            started: humantime::format_rfc3339_seconds(started).to_string(),
            seed: self.case.scene.seed,
            budget_s: self.budget_s,
            scene: format!(
                "filter: {}, {}; base: {}; {}",
                record.filter.name, record.filter.curve_name, record.base.name, record.network.name
            ),
            n_base: self.case.n_base,
            voids: self.case.counts[0],
            ..Precision::default()
        };
        let whole: f64 = self.tiers.iter().map(|tier| tier.about().2).sum();
        let mut networks = Vec::new();
        for &tier in self.tiers {
            let (name, measures, part) = tier.about();
            (self.tell)(&format!("{name}: {measures}"));
            let before = work::all_threads();
            let budget_s = self.budget_s * part / whole;
            match tier {
                Tier::Exact => {
                    let (exact, rows) = exact::tier(self, budget_s)?;
                    (precision.exact, networks) = (Some(exact), rows);
                }
                Tier::Sampling => precision.sampling = Some(sampling::tier(self, budget_s)?),
                Tier::Bias => precision.bias = Some(bias::tier(self, budget_s)?),
                Tier::Decision => precision.decision = decision::tier(self, budget_s)?,
                Tier::Scaling => precision.scaling = Some(scaling::tier(self, budget_s)?),
                Tier::Packing => precision.packing = Some(packing::tier(self, budget_s)?),
            }
            precision.spent.push((name.into(), work::all_threads() - before));
        }
        precision.seconds = begun.elapsed().as_secs_f64();
        Ok((precision, networks))
    }
}
