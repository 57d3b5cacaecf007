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

pub use study::{PrecisionError, Study, Tier};
pub use tables::tables;

use std::time::{Instant, SystemTime};

use crate::outcome::precision::{NetworkRow, Precision};
use crate::run::machine::Machine;

impl Study<'_> {
    /// Runs every tier: what `precision.json` holds, and the networks of the tier of exact answers, at the
    /// most particles of each line.
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
