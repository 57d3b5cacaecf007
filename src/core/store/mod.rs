//! Storage: the run folder, its checkpoints, and the columns of a simulation.

pub mod checkpoint;
mod column;
pub mod disk;
mod error;
mod folder;
pub mod format;
mod inside;
mod names;
mod npz;
pub mod platform;
mod whole;

pub use column::{Column, Placement};
pub use disk::{in_mb, open_regular, read_regular, why_not_read};
pub use error::StoreError;
pub use folder::{Folder, LOCK_FILE};
pub use inside::{files_in, make_folder, remove_folder};
pub use names::{folder_name, is_device};
pub use npz::{Array, Npz, Numbers, npz};
pub use whole::{Together, read_whole, write_whole};
