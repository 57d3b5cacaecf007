//! Walks of one case: the functions that every interface calls, including the command line.
//!
//! A scene is [prepared](prepare::prepare) into a case, its replicates are walked under checkpoints, and
//! [`results`] are written, from which pages are made elsewhere. [`Callbacks`] follow the work and stop it,
//! [`RunError`] gives the reason for an early end, and [`folder::claim`] guards every folder.

pub(crate) mod callbacks;
pub(crate) mod case_walks;
pub(crate) mod checkpoints;
pub(crate) mod cost;
pub(crate) mod error;
pub mod folder;
pub mod machine;
mod network_walk;
pub(crate) mod pack;
pub(crate) mod prepare;
pub(crate) mod replicates;
pub mod results;
pub(crate) mod shared_networks;
pub(crate) mod walk;

pub use callbacks::{Callbacks, Event};
pub use checkpoints::CheckpointInterval;
pub use error::{Exit, RunError};
pub use folder::FolderKind;
pub use network_walk::{GivenFilter, NetworkWalk, walk_networks};
pub(crate) use pack::{ConstrictionsOptions, FinishedPacking, PackOptions, measure_constrictions, pack};
pub(crate) use prepare::{Check, EXAMPLE_FILES, PackingCheck, write_examples, write_new};
pub use prepare::{PrepareOptions, check, prepare};
pub(crate) use walk::FinishedRun;
pub use walk::{RunOptions, resume, walk_case, walk_case_recorded, walk_scene};

/// The case of the built-in scene with these settings.
#[cfg(test)]
pub(crate) fn case_of(settings: &[&str]) -> crate::case::Case {
    crate::case::Case::built_in(settings).unwrap()
}
