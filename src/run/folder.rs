//! Claims the folder that a command writes to, by one rule for all commands.

use std::path::Path;

use super::checkpoints::Checkpoints;
use super::error::RunError;
use crate::case::RECORD;
use crate::schema::is_hidden;
use crate::store::{Folder, StoreError};

/// The files of the checkpoint of a compression that is not finished.
pub(super) const STATES: [&str; 2] = ["compression.0", "compression.1"];

/// What a folder holds.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum FolderKind {
    /// A scene that was walked.
    Run,
    /// A packing of grains with its constrictions.
    Packing,
    /// The cases of a plan.
    Campaign,
    /// A study of the percolation threshold.
    Percolation,
    /// A study of error against run time.
    Precision,
    /// Constrictions of a packing from elsewhere.
    Constrictions,
}

impl FolderKind {
    /// Every kind; a packing holds constrictions of its own and so comes before them.
    pub const ALL: [Self; 6] =
        [Self::Run, Self::Packing, Self::Campaign, Self::Percolation, Self::Precision, Self::Constrictions];

    /// What a user calls it.
    pub fn name(self) -> &'static str {
        match self {
            Self::Run => "run",
            Self::Packing => "packing",
            Self::Campaign => "campaign",
            Self::Percolation => "percolation study",
            Self::Precision => "precision study",
            Self::Constrictions => "set of constrictions",
        }
    }

    /// The file from which its page is made, which a finished folder holds.
    pub fn record(self) -> &'static str {
        match self {
            Self::Run => "outcome.json",
            Self::Packing => RECORD,
            Self::Campaign => "campaign.json",
            Self::Percolation => "percolation.json",
            Self::Precision => "precision.json",
            Self::Constrictions => "constrictions.json",
        }
    }

    /// What else marks such a folder, finished or not.
    fn marks(self) -> &'static [&'static str] {
        match self {
            Self::Run => &["series.csv", super::checkpoints::FOLDER],
            Self::Packing => &STATES,
            Self::Campaign => &["cases"],
            _ => &[],
        }
    }

    /// The kind of finished work that a folder holds, if any.
    pub fn of(folder: &Path) -> Option<Self> {
        Self::ALL.into_iter().find(|kind| folder.join(kind.record()).is_file())
    }

    /// Whether the work in a folder is finished; that of a campaign can always be added to.
    fn is_finished(self, folder: &Folder) -> Result<bool, RunError> {
        Ok(match self {
            // With checkpoints, a study of the sensitivity is still to come.
            Self::Run => folder.has("manifest.json") && !Checkpoints::is_in(folder.path())?,
            // With a state beside it, whoever wrote the record was killed before all was done.
            Self::Packing => folder.has(RECORD) && !STATES.iter().any(|state| folder.has(state)),
            Self::Campaign => false,
            other => folder.has(other.record()),
        })
    }
}

/// Claims a folder for work of this kind: makes it where it is missing, and locks it. That of a campaign may
/// be shared.
///
/// # Errors
/// A folder that is not the program's own, that another process holds, that holds work of another kind or,
/// without `overwrite`, finished work of this kind. Nothing in it was changed then.
pub fn claim(path: &Path, kind: FolderKind, overwrite: bool) -> Result<Folder, RunError> {
    let folder = match kind {
        FolderKind::Campaign => Folder::open_shared(path).map_err(no_locks)?,
        _ => Folder::open(path).map_err(RunError::Claim)?,
    };
    let refuse = |problem: String| Err(RunError::Refused(format!("{}: {problem}", shown(path))));
    // A packing has constrictions of its own, which are no other work.
    let is_part = |other| kind == FolderKind::Packing && other == FolderKind::Constrictions;
    for other in FolderKind::ALL.into_iter().filter(|other| *other != kind && !is_part(*other)) {
        if folder.has(other.record()) || other.marks().iter().any(|mark| folder.has(mark)) {
            return refuse(format!("holds a {}; name another folder", other.name()));
        }
    }
    if !overwrite && kind.is_finished(&folder)? {
        return refuse(format!("holds a {} already; name another folder or add --overwrite", kind.name()));
    }
    Ok(folder)
}

/// Claims the first of `NAME`, `NAME-2`, ... for a run that is new, or that an earlier run left without
/// results.
///
/// # Errors
/// What the system says.
pub(super) fn claim_first_free(name: &str) -> Result<Folder, RunError> {
    let names = std::iter::once(name.to_owned()).chain((2..).map(|n| format!("{name}-{n}")));
    for name in names {
        match claim(Path::new(&name), FolderKind::Run, false) {
            Ok(folder) if folder.has("outcome.json") || Checkpoints::is_in(folder.path())? => {}
            Err(RunError::Refused(_)) => {}
            Err(RunError::Claim(
                StoreError::Held { .. } | StoreError::NotOurs { .. } | StoreError::NotAFolder { .. },
            )) => {}
            other => return other,
        }
    }
    unreachable!("there is no last name")
}

/// A file system without locks, where cases cannot be claimed, in words.
fn no_locks(error: StoreError) -> RunError {
    match &error {
        StoreError::Io { action: "lock the folder", .. } => RunError::refused(format!(
            "{error}: this file system has no locks, by which cases are claimed; name a folder on another one"
        )),
        _ => RunError::Claim(error),
    }
}

/// A path in one line.
pub(crate) fn shown(path: &Path) -> String {
    path.display().to_string().chars().map(|c| if is_hidden(c) { '?' } else { c }).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn work_of_one_kind_never_goes_into_a_folder_of_another() {
        let root = tempfile::tempdir().unwrap();
        for held in FolderKind::ALL {
            let path = root.path().join(held.name());
            claim(&path, held, false).unwrap().write(held.record(), b"{}").unwrap();
            for kind in FolderKind::ALL {
                let own = kind == held;
                let part = kind == FolderKind::Packing && held == FolderKind::Constrictions;
                for overwrite in [false, true] {
                    let claimed = claim(&path, kind, overwrite);
                    if own || part {
                        continue;
                    }
                    let error = claimed.unwrap_err();
                    let message = format!("holds a {}; name another folder", held.name());
                    assert!(error.to_string().ends_with(&message), "{kind:?} into {held:?}: {error}");
                    assert_eq!(error.exit().code(), 2);
                }
            }
        }
    }

    #[test]
    fn finished_work_is_replaced_only_where_that_is_asked_for() {
        let root = tempfile::tempdir().unwrap();
        for kind in FolderKind::ALL {
            let path = root.path().join(kind.name());
            let folder = claim(&path, kind, false).unwrap();
            folder.write(kind.record(), b"{}").unwrap();
            folder.write("manifest.json", b"{}").unwrap();
            drop(folder);
            assert_eq!(FolderKind::of(&path), Some(kind));
            assert!(claim(&path, kind, true).is_ok());
            match (kind, claim(&path, kind, false)) {
                (FolderKind::Campaign, claimed) => assert!(claimed.is_ok()),
                (_, claimed) => {
                    let message =
                        format!("holds a {} already; name another folder or add --overwrite", kind.name());
                    assert!(claimed.unwrap_err().to_string().ends_with(&message));
                }
            }
        }
    }
}
