//! Storage: the run folder, its checkpoints, and the columns of a simulation.
//!
//! A [`StoreError`] without further explanation is an error of the system, with the path of the file.

pub mod checkpoint;
mod column;
pub mod disk;
mod folder;
pub mod format;
mod npz;
pub mod platform;
mod whole;

pub use column::{Column, Placement};
pub(crate) use disk::in_mb;
pub use disk::{open_regular, read_regular, read_whole};
pub use folder::{Folder, folder_name, is_device};
pub use npz::{Array, Npz, Numbers, npz};
pub use whole::{StoreError, Together, files_in, make_folder, remove_folder, write_whole};
