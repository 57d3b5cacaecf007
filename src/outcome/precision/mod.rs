//! How much accuracy a second buys: what `precision.json` holds, and the statistics of a work-precision
//! diagram.
//!
//! # Error, time, figure of merit
//! An error is a standard deviation over replicates (new walks, and where it says so new networks), never one
//! worked out from the number of particles: all particles of a run share one network and what they block, so
//! a binomial error is several times too small. Time is processor time, all cores together. The figure of
//! merit is `1 / (error^2 time)`: it does not change with the number of replicates, and two settings compare
//! by its ratio.
//!
//! # Intervals
//! 95 %. Of a mean: Student's t over replicates. Of a standard deviation: chi squared with as many degrees of
//! freedom as there are independent groups less one. Of a share of wrong verdicts: Wilson's.

mod rows;
mod statistics;

pub use rows::{
    BiasRow, ClosedRow, DecisionCase, DecisionRow, ExactRow, PackingRow, SamplingLine, ScalingRow, Slope,
    TriangulationRow,
};
pub use statistics::{Interval, SdEstimate, merit, sd_estimate, wilson};

use serde::{Deserialize, Serialize};

/// The whole of `precision.json`.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
pub struct Precision {
    /// Version of voidwalk.
    pub version: String,
    /// Its commit, where known.
    pub commit: Option<String>,
    /// System, processor and memory.
    pub machine: String,
    /// When it was started (UTC).
    pub started: String,
    /// The user's seed.
    pub seed: u64,
    /// Processor time asked for, s.
    pub budget_s: f64,
    /// The scene, in a line.
    pub scene: String,
    /// Base particles of a run.
    pub n_base: u64,
    /// Voids of its network.
    pub voids: u64,
    /// Each engine against exact answers.
    pub exact: Option<ExactTier>,
    /// Error of the scene's eroded mass against time.
    pub sampling: Option<SamplingTier>,
    /// What settings do to the scene's eroded mass.
    pub bias: Option<Vec<BiasRow>>,
    /// Wrong verdicts against time.
    pub decision: Option<DecisionTier>,
    /// Time against the size of the problem.
    pub scaling: Option<Vec<ScalingRow>>,
    /// Packings and triangulations.
    pub packing: Option<PackingTier>,
    /// Processor time by tier, s.
    pub spent: Vec<(String, f64)>,
    /// Wall time, s.
    pub seconds: f64,
}

/// The tier of exact answers.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
pub struct ExactTier {
    /// Random networks of each line.
    pub networks: u64,
    /// What each quantity is.
    pub quantities: Vec<MeasuredQuantity>,
    /// One row a quantity, engine and number of particles.
    pub rows: Vec<ExactRow>,
    /// Slope of ln(error) against ln(particles), by quantity and engine.
    pub slopes: Vec<Slope>,
    /// Integers and closed forms.
    pub closed: Vec<ClosedRow>,
}

/// A quantity of the tier of exact answers.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
pub struct MeasuredQuantity {
    /// Short name.
    pub name: String,
    /// What it is, in a sentence.
    pub words: String,
    /// Its mean over the networks, exact.
    pub mean: f64,
}

/// One network of the tier of exact answers: a row of `exact_networks.csv`.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
pub struct NetworkRow {
    /// Name of the quantity.
    pub quantity: String,
    /// The engine.
    pub engine: String,
    /// Particles.
    pub particles: u64,
    /// Network, counted from 1.
    pub network: u64,
    /// By the linear solve.
    pub exact: f64,
    /// By the walk.
    pub found: f64,
    /// Difference in standard errors; `None` where nothing is drawn.
    pub z: Option<f64>,
}

/// The tier of sampling.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
pub struct SamplingTier {
    /// The lattice that it was walked on.
    pub on: String,
    /// One row a variant, kind of replicate and group size.
    pub rows: Vec<SamplingRow>,
    /// One line a variant and kind of replicate.
    pub lines: Vec<SamplingLine>,
}

/// Error of a mean over `group` replicates.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
pub struct SamplingRow {
    /// How base particles are drawn and moved.
    pub variant: String,
    /// `new networks`, or `one network`.
    pub networks: String,
    /// Replicates averaged.
    pub group: u64,
    /// Independent groups of them.
    pub groups: u64,
    /// Standard deviation of the groups' means of the eroded mass fraction.
    pub error: f64,
    /// Lower end of the 95 % interval.
    pub error_low: f64,
    /// Upper end of the 95 % interval.
    pub error_high: f64,
    /// Processor time of a group, mean, s.
    pub core_seconds: f64,
}

/// The tier of verdicts.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
pub struct DecisionTier {
    /// The lattice that it was walked on.
    pub on: String,
    /// The cases.
    pub cases: Vec<DecisionCase>,
    /// One row a case, rule and number of replicates.
    pub rows: Vec<DecisionRow>,
}

/// The tier of packings.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
pub struct PackingTier {
    /// One row a friction and setting.
    pub packings: Vec<PackingRow>,
    /// One row a packing triangulated.
    pub triangulations: Vec<TriangulationRow>,
}
