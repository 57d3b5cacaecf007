//! The application: the functions that every face of the program calls, the command line like any other.
//!
//! - [`walk_scene`] and [`resume`] walk a scene into a folder, [`walk_case`] walks a case in memory,
//!   [`walk_networks`] networks from elsewhere.
//! - [`pack`](pack::pack) packs a filter, [`measure_constrictions`] measures a packing from elsewhere.
//! - [`check`](check::check) forecasts a run, by the one model of `cost`.
//! - [`Callbacks`] follow the work and stop it, [`RunError`] gives the reason of an early end,
//!   [`folder::claim`] guards every folder, and `unfinished` marks those with unfinished work.
//!
//! A case is [prepared](prepare::prepare), its `replicates` are walked under `checkpoints`, and
//! [`results`] are written. Pages are no part of it: they are made from the files that are written here.

pub(crate) mod allocation;
pub(crate) mod at_once;
pub(crate) mod callbacks;
pub(crate) mod case_walks;
mod check;
pub(crate) mod checkpoints;
pub(crate) mod constrictions;
pub(crate) mod cost;
mod curve_range;
pub(crate) mod erosion;
pub mod error;
mod examples;
pub mod folder;
pub mod machine;
mod network_answer;
mod network_record;
mod network_walk;
pub(crate) mod pack;
mod packing_record;
mod pilot;
pub(crate) mod planned;
pub(crate) mod prepare;
pub(crate) mod replicates;
pub mod results;
pub(crate) mod shared_networks;
pub(crate) mod studies;
pub(crate) mod summary;
pub(crate) mod unfinished;
pub(crate) mod walk;

pub use callbacks::{Callbacks, Event};
pub use check::{Check, PackingCheck, check};
pub use checkpoints::CheckpointInterval;
pub use constrictions::{ConstrictionsOptions, measure_constrictions};
pub use error::{Exit, RunError};
pub use examples::{EXAMPLE_FILES, ExampleFile, write_examples};
pub use folder::FolderKind;
pub use network_walk::{GivenFilter, NetworkOutcome, NetworkWalk, WalkedNetwork, walk_networks};
pub use pack::{FinishedPacking, PackOptions, pack};
pub use prepare::{PrepareOptions, prepare, write_built_in, write_new};
pub use walk::{FinishedRun, RunOptions, resume, walk_case, walk_case_recorded, walk_scene};
