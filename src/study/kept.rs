//! What a study that is stopped or killed has found, from which the same command continues.
//!
//! It is a checkpoint of the folder ([`crate::store::checkpoint`]): section `found`, a record, under a hash
//! of everything that the study follows from. What was under way is begun again; what it says follows from
//! its seed alone, so the whole is that of a study that nobody stopped.

use serde::Serialize;
use serde::de::DeserializeOwned;
use xxhash_rust::xxh3::xxh3_128;

use crate::run::callbacks::Callbacks;
use crate::run::error::RunError;
use crate::run::folder::shown;
use crate::store::Folder;
use crate::store::checkpoint::{CheckpointError, Identity, Label, Section, newest, save};

/// What a kind of study keeps, and the words for it.
pub(super) struct KeptKind {
    /// The checkpoint.
    pub name: &'static str,
    /// Its files.
    pub files: [&'static str; 2],
    /// The study.
    pub study: &'static str,
    /// What it does one after the other, and keeps when done.
    pub parts: &'static str,
}

/// Keeps what is found in a folder.
pub(super) struct Kept<'a> {
    kind: &'static KeptKind,
    folder: &'a Folder,
    identity: Identity,
}

impl<'a> Kept<'a> {
    /// In a claimed folder, of the study that these words describe.
    pub fn new(kind: &'static KeptKind, folder: &'a Folder, work: &str) -> Self {
        let scene = format!("{:032x}", xxh3_128(work.as_bytes()));
        Self { kind, folder, identity: Identity { scene, ..Identity::default() } }
    }

    /// What an earlier start of this very study found.
    ///
    /// # Errors
    /// What is there is of another study, or cannot be read.
    pub fn newest<T: DeserializeOwned>(&self, callbacks: &Callbacks) -> Result<Option<T>, RunError> {
        let refused = |error: CheckpointError| match error.is_unreadable() {
            true => RunError::Checkpoint(error),
            false => RunError::Refused(format!(
                "{}: the unfinished {} there cannot be continued: {error}; name another folder or add \
                 --overwrite",
                shown(self.folder.path()),
                self.kind.study
            )),
        };
        let (saved, passed_over) =
            newest(self.folder.path(), self.kind.name, &self.identity).map_err(refused)?;
        for error in passed_over {
            (callbacks.warn)(&format!("{error}; the checkpoint before it was taken"));
        }
        saved.map(|saved| saved.read_record("found").map_err(refused)).transpose()
    }

    /// Keeps what has been found, so many parts; the checkpoint before stays until this one is whole.
    ///
    /// # Errors
    /// What the folder says.
    pub fn keep(&self, parts: usize, found: &impl Serialize) -> Result<(), RunError> {
        let label = Label { identity: self.identity.clone(), generation: parts as u64, ..Label::default() };
        let record = serde_json::to_vec(found)?;
        let sections = [Section::new("found", &record)];
        save(self.folder.path(), self.kind.name, &label, &sections).map_err(RunError::Save)
    }

    /// Removes it: the study is whole.
    ///
    /// # Errors
    /// What the folder says.
    pub fn discard(&self) -> Result<(), RunError> {
        Ok(self.folder.remove_all(&self.kind.files)?)
    }

    /// That the study was stopped with so many of its parts done.
    pub fn stopped(&self, done: usize, all: usize) -> RunError {
        let (folder, parts) = (shown(self.folder.path()), self.kind.parts);
        RunError::Stopped(format!(
            "after {done} of {all} {parts}, which are kept in {folder}; continue with the same command"
        ))
    }
}
