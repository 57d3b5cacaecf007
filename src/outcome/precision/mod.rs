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

mod statistics;

pub use statistics::{Interval, SdEstimate, merit, sd_estimate, wilson};

use serde::{Deserialize, Serialize};

use super::record::Verdict;

/// The whole of `precision.json`.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
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
pub struct ExactTier {
    /// Random networks of each line.
    pub networks: u64,
    /// What each quantity is.
    pub quantities: Vec<Quantity>,
    /// One row a quantity, engine and number of particles.
    pub rows: Vec<ExactRow>,
    /// Slope of ln(error) against ln(particles), by quantity and engine.
    pub slopes: Vec<Slope>,
    /// Integers and closed forms.
    pub closed: Vec<ClosedRow>,
}

/// A quantity of the tier of exact answers.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Quantity {
    /// Short name.
    pub name: String,
    /// What it is, in a sentence.
    pub words: String,
    /// Its mean over the networks, exact.
    pub mean: f64,
}

/// Error of an engine with this many particles, over all networks.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct ExactRow {
    /// Name of the quantity.
    pub quantity: String,
    /// The engine.
    pub engine: String,
    /// Particles of each network.
    pub particles: u64,
    /// Networks.
    pub networks: u64,
    /// Root mean square of found less exact.
    pub error: f64,
    /// Lower end of its 95 % interval.
    pub error_low: f64,
    /// Upper end of its 95 % interval.
    pub error_high: f64,
    /// The error that independent particles have: root mean square of `sqrt(p (1 - p) / particles)`.
    pub expected_error: f64,
    /// Mean of found less exact.
    pub bias: f64,
    /// Largest deviation of one network in standard errors; `None` where nothing is drawn.
    pub largest_z: Option<f64>,
    /// Sum of the squares of all deviations, on as many degrees of freedom as there are networks.
    pub chi_squared: Option<f64>,
    /// Processor time of one network, mean, s.
    pub core_seconds: f64,
    /// `1 / (error^2 core_seconds)`; `None` without an error.
    pub merit: Option<f64>,
}

/// How the error of an engine falls with the number of particles.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Slope {
    /// Name of the quantity.
    pub quantity: String,
    /// The engine.
    pub engine: String,
    /// Slope of ln(error) against ln(particles); `None` with fewer than two errors.
    pub slope: Option<f64>,
    /// Smallest error reached.
    pub smallest_error: f64,
    /// Largest deviation of one network, at any number of particles.
    pub largest_z: Option<f64>,
}

/// One network of the tier of exact answers: a row of `exact_networks.csv`.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
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

/// An answer that is known without a solve.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct ClosedRow {
    /// What.
    pub what: String,
    /// The answer.
    pub exact: f64,
    /// What was found.
    pub found: f64,
    /// Difference in standard errors; `None` for integers, which must be equal.
    pub z: Option<f64>,
    /// Whether it is as it must be: equal, or within four standard errors.
    pub holds: bool,
    /// Particles, or networks.
    pub samples: u64,
    /// Processor time, s.
    pub core_seconds: f64,
}

/// The tier of sampling.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
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

/// All replicates of a variant.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct SamplingLine {
    /// How base particles are drawn and moved.
    pub variant: String,
    /// `new networks`, or `one network`.
    pub networks: String,
    /// Replicates.
    pub replicates: u64,
    /// Mean of the eroded mass fraction.
    pub mean: f64,
    /// Mean less that of the first variant, on the same networks: zero but for the scatter, if both have one
    /// expectation.
    pub difference: f64,
    /// Its standard error; `None` for the first variant.
    pub difference_error: Option<f64>,
    /// Standard deviation of one replicate.
    pub sd: f64,
    /// Lower end of the 95 % interval.
    pub sd_low: f64,
    /// Upper end of the 95 % interval.
    pub sd_high: f64,
    /// `sqrt(mean (1 - mean) / N_base)`, what a binomial of all particles would have; for comparison only.
    pub binomial: f64,
    /// Processor time of a replicate, mean, s.
    pub core_seconds: f64,
    /// `1 / (sd^2 core_seconds)`; `None` without scatter.
    pub merit: Option<f64>,
    /// Lower end of its 95 % interval, from that of `sd`.
    pub merit_low: Option<f64>,
    /// Upper end of the 95 % interval.
    pub merit_high: Option<f64>,
}

/// What a setting does to the eroded mass fraction of the first run.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct BiasRow {
    /// What is changed.
    pub factor: String,
    /// To what, in words.
    pub level: String,
    /// The changed setting as a number, where it is one.
    pub at: f64,
    /// Whether this is the setting that the others are compared with.
    pub reference: bool,
    /// Base particles.
    pub n_base: u64,
    /// Replicates.
    pub replicates: u64,
    /// Mean of the eroded mass fraction.
    pub value: f64,
    /// Mean less that of the reference.
    pub bias: f64,
    /// Lower end of its 95 % interval; `None` for the reference.
    pub bias_low: Option<f64>,
    /// Upper end of the 95 % interval.
    pub bias_high: Option<f64>,
    /// Whether both were walked on the same networks with the same random numbers, so that the interval is
    /// that of the differences replicate by replicate.
    pub paired: bool,
    /// Processor time of a replicate, mean, s.
    pub core_seconds: f64,
}

/// The tier of verdicts.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct DecisionTier {
    /// The lattice that it was walked on.
    pub on: String,
    /// The cases.
    pub cases: Vec<DecisionCase>,
    /// One row a case, rule and number of replicates.
    pub rows: Vec<DecisionRow>,
}

/// A case near the threshold.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct DecisionCase {
    /// What it is called.
    pub name: String,
    /// Factor on every size of the scene's base.
    pub size_factor: f64,
    /// Base particles.
    pub n_base: u64,
    /// Replicates of the reference.
    pub replicates: u64,
    /// Eroded mass fraction of the first run, mean over the reference.
    pub mean: f64,
    /// Lower end of the 95 % interval.
    pub low: f64,
    /// Upper end of the 95 % interval.
    pub high: f64,
    /// Standard deviation of a replicate.
    pub sd: f64,
    /// The class, by the means of all replicates.
    pub class: Verdict,
    /// Whether the 95 % interval of the first run lies on one side of 7.5 %.
    pub certain: bool,
    /// Processor time of a replicate, mean, s.
    pub core_seconds: f64,
}

/// How often a rule gives the wrong class.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct DecisionRow {
    /// The case.
    pub case: String,
    /// `fixed`, or `decided at` a confidence level.
    pub rule: String,
    /// Replicates, mean.
    pub replicates: f64,
    /// Share of wrong classes.
    pub wrong: f64,
    /// Lower end of the 95 % interval.
    pub wrong_low: f64,
    /// Upper end of the 95 % interval.
    pub wrong_high: f64,
    /// Share of trials that ended without a class.
    pub undecided: f64,
    /// Processor time, mean, s.
    pub core_seconds: f64,
}

/// Time of a first run.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct ScalingRow {
    /// What is varied: `base particles`, `voids` or `threads`.
    pub against: String,
    /// The engine.
    pub engine: String,
    /// Base particles.
    pub n_base: u64,
    /// Voids.
    pub voids: u64,
    /// Threads.
    pub threads: u64,
    /// Wall time, s.
    pub wall_seconds: f64,
    /// Processor time, s.
    pub core_seconds: f64,
    /// Increments.
    pub increments: u64,
    /// Completed moves.
    pub particle_moves: u64,
    /// Eroded mass over inserted mass.
    pub eroded_mass_fraction: f64,
}

/// The tier of packings.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct PackingTier {
    /// One row a friction and setting.
    pub packings: Vec<PackingRow>,
    /// One row a packing triangulated.
    pub triangulations: Vec<TriangulationRow>,
}

/// A packing's void ratio and constriction curve under a setting, over some seeds.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct PackingRow {
    /// Friction while it is compressed.
    pub friction: f64,
    /// What is changed: `stiffness`, `rate`, `grains` or `time step`.
    pub factor: String,
    /// To what, as a multiple of the default; grains as a number.
    pub at: f64,
    /// Whether this is the setting that the others are compared with.
    pub reference: bool,
    /// Grains.
    pub grains: u64,
    /// Packings.
    pub seeds: u64,
    /// Packings that came to rest at their pressure.
    pub settled: u64,
    /// Volume of voids over volume of grains, mean.
    pub void_ratio: f64,
    /// Standard deviation of one packing.
    pub void_ratio_sd: Option<f64>,
    /// Void ratio less that of the reference.
    pub bias: f64,
    /// Lower end of the 95 % interval.
    pub bias_low: Option<f64>,
    /// Upper end of the 95 % interval.
    pub bias_high: Option<f64>,
    /// Dc5 over the smallest grain, mean.
    pub dc5: f64,
    /// Dc50 over the smallest grain, mean.
    pub dc50: f64,
    /// Relative difference of Dc50 from the reference.
    pub dc50_bias: f64,
    /// Dc60 / Dc10 of the constrictions, mean.
    pub cu_csd: f64,
    /// Processor time of a packing, mean, s.
    pub core_seconds: f64,
}

/// Time of a triangulation, and whether its identities hold.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct TriangulationRow {
    /// Where the grains are.
    pub packing: String,
    /// Grains.
    pub grains: u64,
    /// Tetrahedra.
    pub tetrahedra: u64,
    /// Constrictions.
    pub constrictions: u64,
    /// Processor time of the triangulation, s.
    pub triangulate_seconds: f64,
    /// Processor time of voids, discs and curve, s.
    pub measure_seconds: f64,
    /// Every facet shared by two, positive volumes that sum to the cell, local regularity, Euler's relation.
    pub identities_hold: bool,
}
