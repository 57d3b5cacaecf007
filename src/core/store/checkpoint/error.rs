//! Reasons for refusing a checkpoint.

use std::io;
use std::path::{Path, PathBuf};

/// Reasons for refusing a checkpoint. The remedy depends on the command, which names it.
#[derive(Debug, thiserror::Error)]
pub enum CheckpointError {
    /// The content of the file differs from what was written.
    #[error("{}: corrupt: {problem}", file.display())]
    Corrupt {
        /// The file.
        file: PathBuf,
        /// Description of the damage.
        problem: String,
    },
    /// The system fails to read the file, which may be whole.
    #[error(
        "{}: cannot be read: {source}; it is left as it is, and nothing was taken in its place",
        file.display()
    )]
    Unreadable {
        /// The file.
        file: PathBuf,
        /// Error of the system.
        source: io::Error,
    },
    /// The file is of another version of the format.
    #[error(
        "{}: was written by another version of voidwalk (checkpoint format {found}; this one reads \
         {expected}), which can finish it",
        file.display()
    )]
    OtherVersion {
        /// The file.
        file: PathBuf,
        /// Version of the file's format.
        found: u32,
        /// Version that is read.
        expected: u32,
    },
    /// The file was written on a machine of another kind.
    #[error("{}: was written by a machine with another byte order", file.display())]
    OtherByteOrder {
        /// The file.
        file: PathBuf,
    },
    /// The scene, or the plan of the packing, is another one.
    #[error("{}: is of another scene, or of another version of voidwalk", file.display())]
    OtherScene {
        /// The file.
        file: PathBuf,
    },
    /// The scene is the same, but the walk is another one.
    #[error("{}: is of another walk of this scene: {found}; expected: {expected}", file.display())]
    OtherWalk {
        /// The file.
        file: PathBuf,
        /// Walk of the file.
        found: String,
        /// Walk asked for.
        expected: String,
    },
    /// The walk is the same, but the network is another one.
    #[error("{}: is of another network", file.display())]
    OtherNetwork {
        /// The file.
        file: PathBuf,
    },
}

impl CheckpointError {
    /// Tells if the system failed to read the file, which may then be whole.
    pub fn is_unreadable(&self) -> bool {
        matches!(self, Self::Unreadable { .. })
    }

    /// Turns an error of reading into one of the checkpoint: a file that ends too early is corrupt.
    pub(super) fn from_io(file: &Path, source: io::Error) -> Self {
        match source.kind() {
            io::ErrorKind::UnexpectedEof => Self::corrupt(file, "ends early"),
            _ => Self::Unreadable { file: file.to_owned(), source },
        }
    }

    pub(super) fn corrupt(file: &Path, problem: impl Into<String>) -> Self {
        Self::Corrupt { file: file.to_owned(), problem: problem.into() }
    }
}
