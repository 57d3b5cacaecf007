//! The mark of a folder whose work has begun and is not whole yet, its page included.
//!
//! It is written before the first file of the work and removed after the last, so a folder that holds it is
//! not finished, whatever else it holds. It describes the work, so that the same command continues it, and
//! holds the options of a run that change no result.

use serde::de::DeserializeOwned;
use serde::{Deserialize, Serialize};

use voidwalk_core::store::format::from_json;
use voidwalk_core::store::{Folder, StoreError};

/// The file.
pub const FILE: &str = ".voidwalk.unfinished";

/// Mark of unfinished work in a folder.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct Unfinished {
    /// Kind of the folder, as a user calls it.
    pub kind: String,
    /// Fingerprint of everything that the results follow from.
    pub work: String,
    /// Interval between saves of a run, as it was given.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub checkpoint_every: Option<String>,
}

impl Unfinished {
    /// Reads the mark in a folder; `None` if no work is under way, and an empty mark if the file is corrupt.
    ///
    /// # Errors
    /// Errors of the system.
    pub fn read(folder: &Folder) -> Result<Option<Self>, StoreError> {
        let bytes = folder.read(FILE)?;
        Ok(bytes.map(|bytes| serde_json::from_slice(&bytes).unwrap_or_default()))
    }

    /// The record of this very work, if everything except its page was written.
    ///
    /// # Errors
    /// Errors of the system.
    pub fn whole<T: DeserializeOwned>(&self, folder: &Folder, record: &str) -> Result<Option<T>, StoreError> {
        if Self::read(folder)?.as_ref() != Some(self) {
            return Ok(None);
        }
        Ok(folder.read(record)?.and_then(|bytes| from_json(&bytes).ok()))
    }

    /// Marks a folder, unless it has this mark already.
    ///
    /// # Errors
    /// Errors of the system.
    pub fn begin(&self, folder: &Folder) -> Result<(), StoreError> {
        if Self::read(folder)?.as_ref() == Some(self) {
            return Ok(());
        }
        folder.write(FILE, &serde_json::to_vec(self).expect("words"))
    }
}

/// Removes the mark: the work is finished.
///
/// # Errors
/// Errors of the system.
pub fn end(folder: &Folder) -> Result<(), StoreError> {
    folder.remove(FILE)
}
