//! Where things are kept: the run folder, its checkpoints, and the columns of a simulation.

pub mod checkpoint;
mod column;
pub mod disk;
mod folder;
pub mod format;
mod npz;
pub(crate) mod platform;
mod together;

pub use column::{Column, Placement};
pub use disk::{open_regular, read_regular};
pub use folder::{
    Folder, LOCK_FILE, StoreError, files_in, make_folder, read_whole, remove_folder, write_whole,
};
pub use npz::{Array, Npz, Numbers, npz};
pub use together::Together;
