//! Where things are kept: the run folder, and the columns of a simulation.

mod column;
mod folder;

pub use column::{Column, Placement};
pub use folder::{Folder, LOCK_FILE, StoreError, write_whole};
