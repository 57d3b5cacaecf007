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
//! The budget is processor time. It decides how many replicates are walked, by the work that a run is counted
//! to be (moves, increments, voids) and never by the clock; so a seed and a budget give the same numbers on
//! every machine and for any number of threads. Only the times differ.
//!
//! # Time
//! Every run is walked by one thread, as many runs side by side as there are threads, and its time is the
//! processor time of that thread; only the scaling over threads walks one run with several.

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

use tables::tables;

use std::ops::RangeInclusive;
use std::path::{Path, PathBuf};
use std::str::FromStr;
use std::time::{Duration, Instant, SystemTime};

use crate::case::Case;
use crate::outcome::precision::{NetworkRow, Precision};
use crate::run::callbacks::{Callbacks, Event};
use crate::run::error::RunError;
use crate::run::folder::{FolderKind, claim};
use crate::run::machine::{Machine, threads};
use crate::run::prepare::{PrepareOptions, prepare_into};
use crate::run::results::json;
use crate::scene::Scene;

/// Processor time that may be asked for (s).
const BUDGET_S: RangeInclusive<f64> = 0.1..=604_800.0;

/// How a precision study is made.
#[derive(Clone, Debug)]
pub struct PrecisionOptions {
    /// Folder for the results.
    pub out: PathBuf,
    /// Whether earlier results there are replaced.
    pub overwrite: bool,
    /// Tiers to measure; all without any.
    pub tiers: Vec<Tier>,
    /// Processor time to spend, all cores together.
    pub budget: Duration,
    /// Threads, memory and the folder of packings.
    pub prepare: PrepareOptions,
}

impl Default for PrecisionOptions {
    fn default() -> Self {
        Self {
            out: "voidwalk-precision".into(),
            overwrite: false,
            tiers: Vec::new(),
            budget: Duration::from_secs(240),
            prepare: PrepareOptions::default(),
        }
    }
}

/// Measures error against run time for a scene, and writes the tables and, last, `precision.json`.
///
/// # Errors
/// A scene that is wrong and a folder that cannot be claimed are refused before any work; then what a
/// packing, a network or a walk brings. A study that is stopped begins anew.
pub fn run(scene: Scene, options: &PrecisionOptions, callbacks: &Callbacks) -> Result<Precision, RunError> {
    if !BUDGET_S.contains(&options.budget.as_secs_f64()) {
        return Err(RunError::refused("budget: allowed: from 100ms to 7days"));
    }
    let here = Path::new(".");
    let pool = threads(options.prepare.threads)?;
    let claim = || claim(&options.out, FolderKind::Precision, options.overwrite);
    let (case, folder) = pool.install(|| prepare_into(scene, &options.prepare, here, claim, callbacks))?;
    let is_wanted = |tier: &Tier| options.tiers.is_empty() || options.tiers.contains(tier);
    let tiers: Vec<Tier> = Tier::ALL.into_iter().filter(is_wanted).collect();
    let study = PrecisionStudy {
        case: &case,
        tiers: &tiers,
        budget_s: options.budget.as_secs_f64(),
        threads: pool.current_num_threads(),
        callbacks,
    };
    let (precision, networks) = study.run()?;
    for (name, content) in tables(&precision, &networks)? {
        folder.write(name, &content)?;
    }
    // The page is made of it.
    folder.write(FolderKind::Precision.record(), &json(FolderKind::Precision.record(), &precision)?)?;
    callbacks.results(FolderKind::Precision, folder.path())?;
    Ok(precision)
}

/// It was asked to stop.
fn stopped() -> RunError {
    RunError::failed("stopped on request; a precision study begins anew")
}

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

/// What is studied.
struct PrecisionStudy<'a> {
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
    fn tell(&self, what: &str) {
        (self.callbacks.on_event)(Event::Studying(what));
    }

    /// Does it all: what `precision.json` holds, and the networks of the tier of exact answers, at the most
    /// particles of each line.
    ///
    /// # Errors
    /// What a network, a walk or a packing says, or that it was stopped.
    fn run(&self) -> Result<(Precision, Vec<NetworkRow>), RunError> {
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
            self.tell(&format!("{}: {}", tier.name(), tier.at()));
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

impl FromStr for Tier {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let named = Self::ALL.into_iter().find(|tier| tier.name() == text);
        let allowed = || Self::ALL.map(Self::name).join(", ");
        named.ok_or_else(|| format!("there is no such tier; allowed: {}", allowed()))
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
