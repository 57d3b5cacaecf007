//! Runs a scene: packs its filter, walks its replicates, keeps checkpoints, writes what came of it.

pub mod allocation;
pub mod checkpoints;
pub mod cost;
pub mod machine;
pub mod pack;
pub mod replicates;
pub mod results;
