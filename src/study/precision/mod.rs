//! Error against run time: how much accuracy a second buys, tier by tier.
//!
//! | tier | question | error |
//! |---|---|---|
//! | `exact` | does each engine give what is known exactly? | against a linear solve, integers, closed forms |
//! | `sampling` | what does a second of the scene buy? | standard deviation over replicates |
//! | `bias` | what does a setting do to the answer? | difference from the reference setting |
//! | `decision` | how often is the class wrong? | against a long reference |
//! | `scaling` | what does a larger problem cost? | none: time alone |
//! | `packing` | the same for packings and triangulations | difference from the reference setting |
//!
//! # Budget and determinism
//! The budget is processor time. It decides how many replicates are walked, by the work that a run is counted to be (moves,
//! increments, voids) and never by the clock; so a seed and a budget give the same numbers on every machine and for any
//! number of threads. Only the times differ.
//!
//! # Time
//! Every run is walked by one thread, as many runs side by side as there are threads, and its time is the processor time of that
//! thread; only the scaling over threads walks one run with several.

mod bias;
mod changes;
mod closed_forms;
mod decision;
mod exact;
mod first_run;
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

    /// The word for it.
    pub fn name(self) -> &'static str {
        match self {
            Tier::Exact => "exact",
            Tier::Sampling => "sampling",
            Tier::Bias => "bias",
            Tier::Decision => "decision",
            Tier::Scaling => "scaling",
            Tier::Packing => "packing",
        }
    }

    /// Its part of the budget, before those that are not wanted are left out.
    fn part(self) -> f64 {
        match self {
            Tier::Exact => 0.25,
            Tier::Sampling => 0.2,
            Tier::Bias => 0.22,
            Tier::Decision => 0.14,
            Tier::Scaling => 0.08,
            Tier::Packing => 0.11,
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
    /// Is told what it is at.
    pub tell: &'a (dyn Fn(&str) + Sync),
    /// Set to stop.
    pub stop: &'a AtomicBool,
}

impl Study<'_> {
    /// Does it all: what `precision.json` holds, and the networks of the tier of exact answers, at the most particles of each
    /// line.
    ///
    /// # Errors
    /// What a network, a walk or a packing says, or that it was stopped.
    pub fn run(&self) -> Result<(Precision, Vec<NetworkRow>), PrecisionError> {
        let (begun, started) = (Instant::now(), SystemTime::now());
        let record = self.case.record();
        let mut precision = Precision {
            version: env!("CARGO_PKG_VERSION").into(),
            commit: option_env!("VOIDWALK_COMMIT").map(String::from),
            machine: Machine::here().description,
            started: humantime::format_rfc3339_seconds(started).to_string(),
            seed: self.case.scene.walk.seed,
            budget_s: self.budget_s,
            scene: format!(
                "filter: {}, {}; base: {}; {}",
                record.filter.name, record.filter.curve_name, record.base.name, record.network.name
            ),
            n_base: self.case.n_base,
            voids: self.case.counts[0],
            exact: None,
            sampling: None,
            bias: None,
            decision: None,
            scaling: None,
            packing: None,
            spent: Vec::new(),
            seconds: 0.0,
        };
        let whole: f64 = self.tiers.iter().map(|tier| tier.part()).sum();
        let mut networks = Vec::new();
        for &tier in self.tiers {
            (self.tell)(&format!("{}: {}", tier.name(), tier.at()));
            let before = work::all_threads();
            let budget_s = self.budget_s * tier.part() / whole;
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
            precision.spent.push((tier.name().into(), work::all_threads() - before));
        }
        precision.seconds = begun.elapsed().as_secs_f64();
        Ok((precision, networks))
    }
}

impl Tier {
    /// What it is at, in words.
    fn at(self) -> &'static str {
        match self {
            Tier::Exact => "every engine against the linear solve and closed forms",
            Tier::Sampling => "the scatter of the scene's eroded mass, by engine",
            Tier::Bias => "settings against the reference setting",
            Tier::Decision => "wrong classes near 7.5 %",
            Tier::Scaling => "time against base particles, voids and threads",
            Tier::Packing => "packings and triangulations",
        }
    }
}
