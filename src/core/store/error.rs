//! Why a folder or a file of the program's own cannot be used.

use std::io;
use std::path::PathBuf;

/// Why a folder cannot be used.
#[derive(Debug, thiserror::Error)]
pub enum StoreError {
    /// The folder holds other things.
    #[error("{path}: this folder is not empty and was not made by voidwalk; name an empty or new one")]
    NotOurs {
        /// The folder.
        path: PathBuf,
    },
    /// The path is there, but is no folder of its own.
    #[error("{path}: is {what}; name a folder that is empty or new")]
    NotAFolder {
        /// The path.
        path: PathBuf,
        /// What it is instead.
        what: &'static str,
    },
    /// Under the name of the lock file there is something else.
    #[error(
        "{path}: is no lock file of voidwalk: another name of some other file, or no file at all; remove it, \
         or name another folder"
    )]
    NotALock {
        /// The path.
        path: PathBuf,
    },
    /// Somebody else is writing.
    #[error("{path}: another run writes to this folder ({holder})")]
    Held {
        /// The folder.
        path: PathBuf,
        /// What the lock file says.
        holder: String,
    },
    /// The system refuses.
    #[error("{path}: cannot {action}: {source}")]
    Io {
        /// The file or folder.
        path: PathBuf,
        /// What was tried.
        action: &'static str,
        /// What the system says.
        source: io::Error,
    },
}

impl StoreError {
    /// Whether the user can fix it by naming another folder, before any work is done.
    pub fn is_refusal(&self) -> bool {
        use io::ErrorKind::{InvalidFilename, InvalidInput, NotADirectory, NotFound};
        use io::ErrorKind::{PermissionDenied, ReadOnlyFilesystem};
        // Windows calls the name of a device, as NUL, an input that is invalid.
        let by_name =
            [InvalidFilename, InvalidInput, NotADirectory, NotFound, PermissionDenied, ReadOnlyFilesystem];
        !matches!(self, Self::Io { source, .. } if !by_name.contains(&source.kind()))
    }
}
