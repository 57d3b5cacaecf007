//! Results so far of a stopped or killed study, from which the same command continues.
//!
//! They form a checkpoint in the folder ([`voidwalk_core::store::checkpoint`]): section `found`, a record,
//! under a hash of all inputs of the study. Parts under way are started again; their results follow from the
//! seed alone, so the whole equals an uninterrupted study. A batch keeps no such file: its cases are run
//! folders, which are continued one by one.
//!
//! The date on a sheet is the day of the last walk behind it, or the day of its making without walks.

use std::path::{Path, PathBuf};
use std::time::SystemTime;

use serde::Serialize;
use serde::de::DeserializeOwned;
use xxhash_rust::xxh3::xxh3_128;

use crate::outcome::record::Manifest;
use crate::run::RunError;
use crate::run::callbacks::Callbacks;
use crate::run::folder::{FolderKind, LATTICES, NETWORKS, Unfinished, clear, refused, shown};
use crate::run::results::json;
use voidwalk_core::store::checkpoint::{CheckpointError, Identity, Label, Section, newest, save};
use voidwalk_core::store::format::from_json;
use voidwalk_core::store::{Folder, read_whole};
use voidwalk_core::text::moment;

pub(crate) fn hash_of(work: &str) -> String {
    format!("{:032x}", xxh3_128(work.as_bytes()))
}

/// Makes a study of this kind, identified by `work`, in its claimed folder. Continues from the results of an
/// earlier start; if a study without cases lacks only its page, its record is read instead. `study` writes
/// its tables; then its record and its page are written, and the checkpoint is removed. Errors: the folder
/// holds another study; errors of the study and of the folder.
pub(crate) fn study<F: DeserializeOwned, R: Serialize + DeserializeOwned>(
    (folder, kind, overwrite): (&Folder, FolderKind, bool),
    work: String,
    callbacks: &Callbacks,
    study: impl FnOnce(&Kept, Option<F>) -> Result<R, RunError>,
) -> Result<R, RunError> {
    let mark = Unfinished::new(kind, work);
    let kept = Kept::new(kind, folder, &mark.work);
    // The cases of a batch are checked again, because each has files of its own.
    let whole = mark.whole(folder, kind.record())?.filter(|_| !overwrite && !kind.has_cases());
    let record = match whole {
        Some(record) => record,
        None => {
            // Files to be replaced belong to other work; a stopped start of this very work is continued.
            let begun = Unfinished::read(folder)?;
            let is_begun = begun.as_ref() == Some(&mark);
            let earlier = match overwrite {
                true if is_begun => kept.newest(callbacks).ok().flatten(),
                true => None,
                false => kept.newest(callbacks)?,
            };
            let has_cases = kind.has_cases();
            // A corrupt mark gives no information.
            if has_cases && !overwrite && !is_begun && begun.is_some_and(|begun| !begun.work.is_empty()) {
                let problem = format!(
                    "holds another {} that is unfinished, or was begun by another version of voidwalk; \
                     continue that one with its own command, name another folder or add --overwrite",
                    kind.name()
                );
                return Err(refused(folder.path(), problem));
            }
            // A study that is continued always has its mark.
            if earlier.is_none() && !(has_cases && is_begun) {
                clear(folder, kind)?;
            }
            mark.begin(folder)?;
            let record = study(&kept, earlier)?;
            // The page is made from the record.
            folder.write(kind.record(), &json(kind.format(), &record)?)?;
            record
        }
    };
    callbacks.results(kind, folder.path(), None)?;
    folder.remove_all(kept.files)?;
    Unfinished::end(folder)?;
    Ok(record)
}

pub(crate) fn record<R: DeserializeOwned>(folder: &Path, kind: FolderKind) -> Result<R, RunError> {
    let path = folder.join(kind.record());
    let failed = |error: &dyn std::fmt::Display| RunError::failed(format!("{}: {error}", shown(&path)));
    let bytes = read_whole(&path).map_err(|error| failed(&error))?;
    from_json(&bytes).map_err(|error| failed(&error))
}

pub(crate) struct Kept<'a> {
    kind: FolderKind,
    folder: &'a Folder,
    identity: Identity,
    /// Name of the checkpoint, and of the parts of the study, which are done and kept one after another.
    name: &'static str,
    files: &'static [&'static str],
}

impl<'a> Kept<'a> {
    fn new(kind: FolderKind, folder: &'a Folder, work: &str) -> Self {
        let scene = hash_of(work);
        let (name, files) = match kind {
            FolderKind::Percolation => ("lattices", &LATTICES),
            _ => ("networks", &NETWORKS),
        };
        Self { kind, folder, identity: Identity { scene, ..Identity::default() }, name, files }
    }

    /// Results of an earlier start of this very study. Errors: a file of another study, or one that cannot be
    /// read.
    fn newest<T: DeserializeOwned>(&self, callbacks: &Callbacks) -> Result<Option<T>, RunError> {
        let unusable = |error: CheckpointError| {
            if error.is_unreadable() {
                return RunError::Checkpoint(error);
            }
            let (kind, instead) = (self.kind.name(), "name another folder or add --overwrite");
            let problem = format!("the unfinished {kind} there cannot be continued: {error}; {instead}");
            refused(self.folder.path(), problem)
        };
        let (saved, passed_over) = newest(self.folder.path(), self.name, &self.identity).map_err(unusable)?;
        for error in passed_over {
            (callbacks.warn)(&format!("{error}; the checkpoint before it was used"));
        }
        saved.map(|saved| saved.read_record("found").map_err(unusable)).transpose()
    }

    /// Keeps the results of this many parts; the previous checkpoint stays until this one is complete.
    pub(crate) fn keep(&self, parts: usize, results: &impl Serialize) -> Result<(), RunError> {
        let label = Label { identity: self.identity.clone(), generation: parts as u64, ..Label::default() };
        let record = serde_json::to_vec(results)?;
        let sections = [Section::new("found", &record)];
        save(self.folder.path(), self.name, &label, &sections).map_err(RunError::Save)
    }

    pub(crate) fn stopped(&self, done: usize, all: usize) -> RunError {
        let (folder, parts) = (shown(self.folder.path()), self.name);
        RunError::Stopped(format!(
            "after {done} of {all} {parts}, which are kept in {folder}; continue with the same command"
        ))
    }
}

/// Today's date, as in `2026-11-25`.
pub(crate) fn today() -> Option<String> {
    day(&moment(SystemTime::now()))
}

/// Last day on which one of these cases was finished; `None` if no folder has a date.
pub(super) fn last_day(cases: impl IntoIterator<Item = PathBuf>) -> Option<String> {
    let finished = |case: PathBuf| {
        let bytes = read_whole(&case.join("manifest.json")).ok()?;
        day(&from_json::<Manifest>(&bytes).ok()?.finished)
    };
    // Dates in this form sort as text.
    cases.into_iter().filter_map(finished).max()
}

fn day(moment: &str) -> Option<String> {
    moment.split('T').next().filter(|day| !day.is_empty()).map(str::to_owned)
}

#[cfg(test)]
mod tests {
    use super::*;
    use voidwalk_core::store::format::MANIFEST;

    #[test]
    fn the_last_day_of_several_cases_counts_and_a_folder_without_one_says_nothing() {
        let at = tempfile::tempdir().unwrap();
        let manifest = |finished: &str| Manifest {
            version: "1".into(),
            commit: None,
            seed: 1,
            inputs: Vec::new(),
            threads: 1,
            host: String::new(),
            machine: String::new(),
            started: String::new(),
            finished: finished.into(),
            command: String::new(),
        };
        let case = |name: &str, finished: &str| {
            let folder = at.path().join(name);
            std::fs::create_dir(&folder).unwrap();
            std::fs::write(folder.join("manifest.json"), MANIFEST.json(&manifest(finished)).unwrap())
                .unwrap();
            folder
        };
        let cases =
            [case("a", "2026-11-25T23:59:59Z"), case("b", "2026-11-26T00:00:01Z"), at.path().join("c")];
        assert_eq!(last_day([cases[2].clone()]), None);
        assert_eq!(last_day(cases).as_deref(), Some("2026-11-26"));
        assert_eq!(today().map(|day| day.len()), Some(10));
    }
}
