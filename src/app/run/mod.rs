//! Application layer: the functions that every interface calls, including the command line.
//!
//! - [`walk_scene`] and [`resume`] walk a scene into a folder, [`walk_case`] walks a case in memory,
//!   [`walk_networks`] walks networks from elsewhere.
//! - `pack` packs a filter, `measure_constrictions` measures a packing from elsewhere.
//! - `check` forecasts a run by the cost model of `cost`.
//! - [`Callbacks`] follow the work and stop it, [`RunError`] gives the reason for an early end, and
//!   [`folder::claim`] guards every folder.
//!
//! A case is [prepared](prepare::prepare), its `replicates` are walked under `checkpoints`, and [`results`]
//! are written. Pages are made elsewhere, from the files that are written here.

pub(crate) mod callbacks;
pub(crate) mod case_walks;
pub(crate) mod checkpoints;
pub(crate) mod cost;
pub(crate) mod error;
pub mod folder;
pub mod machine;
mod network_record;
mod network_walk;
pub(crate) mod pack;
pub(crate) mod prepare;
pub(crate) mod replicates;
pub mod results;
pub(crate) mod shared_networks;
pub(crate) mod walk;

pub use callbacks::Callbacks;
pub use callbacks::Event;
pub use checkpoints::CheckpointInterval;
pub use error::Exit;
pub use error::RunError;
pub use folder::FolderKind;
pub use network_walk::{GivenFilter, NetworkWalk, walk_networks};
pub(crate) use pack::{ConstrictionsOptions, FinishedPacking, PackOptions, measure_constrictions, pack};
pub use prepare::check;
pub(crate) use prepare::{Check, PackingCheck};
pub(crate) use prepare::{EXAMPLE_FILES, write_examples};
pub use prepare::{PrepareOptions, prepare};
pub(crate) use prepare::{write_built_in, write_new};
pub(crate) use walk::FinishedRun;
pub use walk::walk_case_recorded;
pub use walk::{RunOptions, resume, walk_case, walk_scene};

/// The case of the built-in scene with these settings.
#[cfg(test)]
pub(crate) fn case_of(settings: &[&str]) -> crate::case::Case {
    let settings: Vec<String> = settings.iter().map(ToString::to_string).collect();
    crate::case::Case::new(crate::scene::Scene::built_in(&settings).unwrap()).unwrap()
}
