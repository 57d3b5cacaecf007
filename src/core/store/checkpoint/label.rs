//! Subject and progress of a checkpoint.

use std::fmt;

/// Subject of a checkpoint: a checkpoint of anything else is refused, even of another walk of the same scene.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Identity {
    /// Fingerprint of the scene, or of the plan of a packing; at most 32 characters.
    pub scene: String,
    /// 0: the walks of the scene itself; from 1: the walks of the sensitivity study.
    pub part: u64,
    /// Replicate, counted from 1.
    pub replicate: u64,
    /// Seed of the replicate.
    pub seed: u64,
    /// Base particles of each run.
    pub n_base: u64,
}

impl fmt::Display for Identity {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { part, replicate, seed, n_base, .. } = self;
        write!(f, "replicate {replicate} of part {part}, seed {seed}, {n_base} base particles")
    }
}

/// Subject and progress of a checkpoint.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Label {
    /// Subject of the checkpoint.
    pub identity: Identity,
    /// Fingerprint of the network.
    pub network: u64,
    /// Run, counted from 1.
    pub run: u64,
    /// Last whole increment.
    pub increment: u64,
    /// Number of the checkpoint under its name, counted from 1.
    pub generation: u64,
}
