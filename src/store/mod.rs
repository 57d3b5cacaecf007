//! Where things are kept: the run folder, its checkpoints, and the columns of a simulation.

pub mod checkpoint;
mod column;
mod folder;

pub use column::{Column, Placement};
pub use folder::{Folder, LOCK_FILE, StoreError, make_folder, write_whole};
