//! Results of walks on given networks, without a scene: their verdict, base and network.

use serde::{Deserialize, Serialize};

use super::record::{BaseRecord, LeftOut, ModelLimit, Replicate, RunSummary, Verdict};
use voidwalk_practice::Note;

/// The results of [`crate::run::walk_networks`]; the names are those of `outcome.json` where both have them.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "cli", derive(schemars::JsonSchema))]
pub struct NetworkWalkRecord {
    /// The class that the replicates together support.
    pub verdict: Verdict,
    /// What else to know, in the order of every face.
    pub notes: Vec<Note>,
    /// The user's seed.
    pub seed: u64,
    /// Base particles inserted in each run.
    pub n_base: u64,
    /// Those that Eq. (2) gives, where the filter and its grains per void are known.
    pub n_base_eq2: Option<u64>,
    /// Filter grains per void, where they are known.
    pub grains_per_void: Option<f64>,
    /// Mass of the base over that of the filter, of Eq. (2).
    pub mass_ratio: f64,
    /// Equal parts in which they were inserted.
    pub increments: u64,
    /// Name of the engine that walked.
    pub engine: String,
    /// One per replicate, in order.
    pub replicates: Vec<Replicate>,
    /// One per run, in order: statistics over the replicates.
    pub summary: Vec<RunSummary>,
    /// Eroded mass fraction that divides the classes: 0.075.
    pub threshold: f64,
    /// Parts of the program that this walk did not need.
    pub left_out: Vec<LeftOut>,
    /// What the model does not contain.
    pub model_leaves_out: Vec<ModelLimit>,
    /// The base.
    pub base: BaseRecord,
    /// 15 % of the filter finer by mass (mm), where the filter is known.
    pub d15f_mm: Option<f64>,
    /// What was walked through.
    pub network: GivenNetwork,
    /// Version of the program.
    pub version: String,
}

/// Networks that were given; where there are several, the numbers are those of the first.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "cli", derive(schemars::JsonSchema))]
pub struct GivenNetwork {
    /// Networks that the replicates took in turn.
    pub networks: u64,
    /// How particles chose among the exits of a void.
    pub exit: String,
    /// Voids.
    pub voids: u64,
    /// Constrictions, each counted once.
    pub constrictions: u64,
    /// Layers of voids.
    pub layers: u64,
    /// Rows of (diameter, percent smaller by number) of its open constrictions, diameters ascending (mm).
    pub diameters: Vec<[f64; 2]>,
}
