//! Reasons why a folder or a file of the program's own cannot be used.

use std::io;
use std::path::PathBuf;

/// Reasons why a folder cannot be used.
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
        /// Its actual kind.
        what: &'static str,
    },
    /// A file that is no lock file has the lock file's name.
    #[error(
        "{path}: is no lock file of voidwalk: another name of some other file, or no file at all; remove it, \
         or name another folder"
    )]
    NotALock {
        /// The path.
        path: PathBuf,
    },
    /// Another process is writing.
    #[error("{path}: another run writes to this folder ({holder})")]
    Held {
        /// The folder.
        path: PathBuf,
        /// Content of the lock file.
        holder: String,
    },
    /// The system refuses.
    #[error("{path}: cannot {action}: {source}")]
    Io {
        /// The file or folder.
        path: PathBuf,
        /// Action that failed.
        action: &'static str,
        /// Error of the system.
        source: io::Error,
    },
}

impl StoreError {
    /// Tells if the user can fix it by naming another folder, before any work is done.
    pub fn is_refusal(&self) -> bool {
        use io::ErrorKind::{InvalidFilename, InvalidInput, NotADirectory, NotFound};
        use io::ErrorKind::{PermissionDenied, ReadOnlyFilesystem};
        // Windows reports the name of a device, such as NUL, as an invalid input.
        let by_name =
            [InvalidFilename, InvalidInput, NotADirectory, NotFound, PermissionDenied, ReadOnlyFilesystem];
        !matches!(self, Self::Io { source, .. } if !by_name.contains(&source.kind()))
    }
}
