//! What a study that is stopped or killed has found: the tiers that are done, from which the same command
//! continues.
//!
//! They are the checkpoint `study` of the folder ([`crate::store::checkpoint`]): section `found`, a record,
//! under a hash of everything that the study follows from. A tier that was under way is begun again; its
//! numbers follow from seed and budget alone, so they are those of a study that nobody stopped.

use serde::{Deserialize, Serialize};
use xxhash_rust::xxh3::xxh3_128;

use crate::outcome::precision::{NetworkRow, Precision};
use crate::run::callbacks::Callbacks;
use crate::run::error::RunError;
use crate::run::folder::{STUDY, shown};
use crate::store::Folder;
use crate::store::checkpoint::{CheckpointError, Identity, Label, Section, newest, save};

/// The checkpoint; its files are [`STUDY`].
const NAME: &str = "study";

/// What has been found so far.
#[derive(Default, Serialize, Deserialize)]
pub(super) struct Found {
    /// The record, with the tiers that are done.
    pub precision: Precision,
    /// The networks of the tier of exact answers, at the most particles of each line.
    pub networks: Vec<NetworkRow>,
}

/// Keeps what is found in a folder.
pub(super) struct Kept<'a> {
    folder: &'a Folder,
    identity: Identity,
}

impl<'a> Kept<'a> {
    /// In a claimed folder, of the study that these words describe.
    pub fn new(folder: &'a Folder, work: &str) -> Self {
        let scene = format!("{:032x}", xxh3_128(work.as_bytes()));
        Self { folder, identity: Identity { scene, ..Identity::default() } }
    }

    /// What an earlier start of this very study found.
    ///
    /// # Errors
    /// What is there is of another study, or cannot be read.
    pub fn newest(&self, callbacks: &Callbacks) -> Result<Option<Found>, RunError> {
        let refused = |error: CheckpointError| match error.is_unreadable() {
            true => RunError::Checkpoint(error),
            false => RunError::Refused(format!(
                "{}: the unfinished precision study there cannot be continued: {error}; name another folder \
                 or add --overwrite",
                shown(self.folder.path())
            )),
        };
        let (saved, passed_over) = newest(self.folder.path(), NAME, &self.identity).map_err(refused)?;
        for error in passed_over {
            (callbacks.warn)(&format!("{error}; the checkpoint before it was taken"));
        }
        saved.map(|saved| saved.read_record("found").map_err(refused)).transpose()
    }

    /// Keeps what has been found; the checkpoint before stays until this one is whole.
    ///
    /// # Errors
    /// What the folder says.
    pub fn keep(&self, found: &Found) -> Result<(), RunError> {
        let generation = found.precision.spent.len() as u64;
        let label = Label { identity: self.identity.clone(), generation, ..Label::default() };
        let record = serde_json::to_vec(found)?;
        let sections = [Section::new("found", &record)];
        save(self.folder.path(), NAME, &label, &sections).map_err(RunError::Save)
    }

    /// Removes it: the study is whole.
    ///
    /// # Errors
    /// What the folder says.
    pub fn discard(&self) -> Result<(), RunError> {
        Ok(self.folder.remove_all(&STUDY)?)
    }

    /// That the study was stopped with so many of its tiers done.
    pub fn stopped(&self, done: usize, tiers: usize) -> RunError {
        let folder = shown(self.folder.path());
        RunError::Stopped(format!(
            "after {done} of {tiers} tiers, which are kept in {folder}; continue with the same command"
        ))
    }
}
