//! Error against run time: how much accuracy a second buys, tier by tier.
//!
//! | tier | question | error |
//! |---|---|---|
//! | `exact` | does each engine give what is known exactly? | against a linear solve and closed forms |
//! | `sampling` | what does a second of the scene buy? | standard deviation over replicates |
//! | `bias` | what does a setting do to the answer? | difference from the reference setting |
//! | `decision` | how often is the class wrong? | against a long reference |
//! | `scaling` | what does a larger problem cost? | none: time alone |
//! | `packing` | what do settings do to packings? | difference from the reference setting |
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
mod comparison;
mod decision;
mod exact;
mod first_run;
mod networks;
mod packing;
mod sampling;
mod scaling;
mod study;
mod tables;
mod twin;
mod work;

use super::kept::{self, Kept};
pub use study::{PrecisionStudy, Tier};
use tables::tables;

use std::ops::RangeInclusive;
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant, SystemTime};

use serde::{Deserialize, Serialize};

use crate::outcome::precision::{NetworkRow, Precision};
use crate::run::callbacks::Callbacks;
use crate::run::error::{Exit, RunError};
use crate::run::folder::{FolderKind, claim};
use crate::run::machine::{Machine, threads};
use crate::run::prepare::{PrepareOptions, prepare_into};
use crate::scene::Scene;
use crate::text::moment;

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
/// packing, a network or a walk brings. After a stop or a kill the same command continues with the tier that
/// was under way.
pub fn run(scene: Scene, options: &PrecisionOptions, callbacks: &Callbacks) -> Result<Precision, RunError> {
    if !BUDGET_S.contains(&options.budget.as_secs_f64()) {
        return Err(RunError::refused("budget: allowed: from 100ms to 7days"));
    }
    if scene.leaves_openings() {
        let problem = "walk.blocked: allowed: \"closed\"; engines and exact answers are compared where \
                       blocked constrictions are closed";
        return Err(RunError::refused(problem));
    }
    if scene.law().is_some() {
        let problem = "walk.arching: allowed: none; engines and exact answers are compared without arches";
        return Err(RunError::refused(problem));
    }
    let here = Path::new(".");
    let pool = threads(options.prepare.threads)?;
    let claim = || claim(&options.out, FolderKind::Precision, options.overwrite);
    let (case, folder) = pool.install(|| prepare_into(scene, &options.prepare, here, claim, callbacks))?;
    let is_wanted = |tier: &Tier| options.tiers.is_empty() || options.tiers.contains(tier);
    let tiers: Vec<Tier> = Tier::ALL.into_iter().filter(is_wanted).collect();
    let kind = FolderKind::Precision;
    let work = format!("{} {tiers:?} {:?}", case.fingerprint(), options.budget);
    let study = PrecisionStudy {
        case: &case,
        tiers: &tiers,
        budget_s: options.budget.as_secs_f64(),
        threads: pool.current_num_threads(),
        callbacks,
    };
    kept::study((&folder, kind, options.overwrite), work, callbacks, |kept, found| {
        let Found { precision, networks } = study.run(kept, found)?;
        for (name, content) in tables(&precision, &networks) {
            folder.write(name, &content)?;
        }
        Ok(precision)
    })
}

/// What has been found so far. Its numbers follow from seed and budget alone.
#[derive(Default, Serialize, Deserialize)]
struct Found {
    /// The record, with the tiers that are done.
    precision: Precision,
    /// The networks of the tier of exact answers, at the most particles of each line.
    networks: Vec<NetworkRow>,
}

impl PrecisionStudy<'_> {
    /// Runs every tier that was not done before, and keeps each as soon as it is done.
    ///
    /// # Errors
    /// A network, a walk or a packing that fails, or that it was stopped.
    fn run(&self, kept: &Kept, found: Option<Found>) -> Result<Found, RunError> {
        let begun = Instant::now();
        let mut found = found.unwrap_or_else(|| self.begun());
        let seconds_before = found.precision.seconds;
        let whole: f64 = self.tiers.iter().map(|tier| tier.about().2).sum();
        // Each tier that is done has its line there, in this order.
        let done = found.precision.spent.len();
        for (number, &tier) in self.tiers.iter().enumerate().skip(done) {
            let (name, measures, part) = tier.about();
            self.tell(&format!("{name}: {measures}"));
            let before = work::all_threads();
            self.measure(tier, self.budget_s * part / whole, &mut found).map_err(|error| {
                match error.exit() {
                    Exit::Stopped => kept.stopped(number, self.tiers.len()),
                    _ => error,
                }
            })?;
            found.precision.spent.push((name.into(), work::all_threads() - before));
            found.precision.seconds = seconds_before + begun.elapsed().as_secs_f64();
            kept.keep(found.precision.spent.len(), &found)?;
        }
        Ok(found)
    }

    /// A study of which no tier is done.
    fn begun(&self) -> Found {
        let record = self.case.record();
        let precision = Precision {
            version: env!("CARGO_PKG_VERSION").into(),
            commit: option_env!("VOIDWALK_COMMIT").map(String::from),
            machine: Machine::here().description,
            started: moment(SystemTime::now()),
            seed: self.case.scene.walk.seed,
            budget_s: self.budget_s,
            scene: format!(
                "filter: {}, {}; base: {}; {}",
                record.filter.name, record.filter.curve_name, record.base.name, record.network.name
            ),
            n_base: self.case.n_base,
            voids: self.case.counts[0],
            ..Precision::default()
        };
        Found { precision, networks: Vec::new() }
    }

    fn measure(&self, tier: Tier, budget_s: f64, found: &mut Found) -> Result<(), RunError> {
        let precision = &mut found.precision;
        match tier {
            Tier::Exact => {
                let (exact, rows) = exact::tier(self, budget_s)?;
                (precision.exact, found.networks) = (Some(exact), rows);
            }
            Tier::Sampling => precision.sampling = Some(sampling::tier(self, budget_s)?),
            Tier::Bias => precision.bias = Some(bias::tier(self, budget_s)?),
            Tier::Decision => precision.decision = decision::tier(self, budget_s)?,
            Tier::Scaling => precision.scaling = Some(scaling::tier(self, budget_s)?),
            Tier::Packing => precision.packing = Some(packing::tier(self, budget_s)?),
        }
        Ok(())
    }
}
