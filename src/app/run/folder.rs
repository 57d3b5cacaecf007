//! The folder that a command writes to: claimed by one rule for all commands, cleared, and marked while its
//! work is unfinished.

use std::path::{Path, PathBuf};

use serde::de::DeserializeOwned;
use serde::{Deserialize, Serialize};

use super::RunError;
use super::checkpoints::Checkpoints;
use crate::case::{GRAINS, INPUT_FILES, RECORD};
use voidwalk_core::store::format::{self, Format, from_json};
use voidwalk_core::store::{Folder, StoreError};
use voidwalk_core::text::plain;

/// Checkpoint files of an unfinished compression.
pub(super) const STATES: [&str; 2] = ["compression.0", "compression.1"];
/// Checkpoint files of an unfinished search of boundaries.
pub(crate) const NETWORKS: [&str; 2] = ["networks.0", "networks.1"];
/// Checkpoint files of an unfinished percolation study.
pub(crate) const LATTICES: [&str; 2] = ["lattices.0", "lattices.1"];
/// File that marks unfinished work.
pub(super) const MARK: &str = ".voidwalk.unfinished";

/// Files that `voidwalk export` writes into the folder `export`.
const EXPORTED: [&str; 6] =
    ["arrays.npz", "layers.vtu", "grains.vtu", "voids.pvd", "constrictions.pvd", "verdict.xlsx"];

/// Prefixes of the numbered files, one for each moment of a walk, that it writes as well.
const EXPORTED_MOMENTS: [&str; 2] = ["voids_", "constrictions_"];

/// Kind of the contents of a folder.
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
    /// Many samples against filters.
    Batch,
    /// Boundaries of the model.
    Boundary,
    /// Specifications for many samples.
    Designs,
    /// The specification of a filter by practice alone.
    Specification,
    /// Sheets and jobs of a page on this machine.
    Serve,
    /// Constrictions of a packing from elsewhere.
    Constrictions,
}

impl FolderKind {
    /// Every kind. A packing comes before constrictions because its folder holds constrictions, too.
    pub(crate) const ALL: [Self; 10] = [
        Self::Run,
        Self::Packing,
        Self::Campaign,
        Self::Percolation,
        Self::Batch,
        Self::Boundary,
        Self::Designs,
        Self::Specification,
        Self::Serve,
        Self::Constrictions,
    ];

    /// Name for users.
    pub(crate) fn name(self) -> &'static str {
        match self {
            Self::Run => "run",
            Self::Packing => "packing",
            Self::Campaign => "campaign",
            Self::Percolation => "percolation study",
            Self::Batch => "batch",
            Self::Boundary => "study of boundaries",
            Self::Designs => "set of designs",
            Self::Specification => "specification",
            Self::Serve => "page's sheets and jobs",
            Self::Constrictions => "set of constrictions",
        }
    }

    /// Format of its record.
    pub(crate) fn format(self) -> Format {
        match self {
            Self::Run => format::OUTCOME,
            Self::Packing => format::PACKING,
            Self::Campaign => format::CAMPAIGN,
            Self::Percolation => format::PERCOLATION,
            Self::Batch => format::BATCH,
            Self::Boundary => format::BOUNDARY,
            Self::Designs => format::DESIGNS,
            Self::Specification => format::SPECIFICATION,
            Self::Serve => format::SERVE,
            Self::Constrictions => format::CONSTRICTIONS,
        }
    }

    /// Record of a finished folder, from which its page is made.
    pub(crate) fn record(self) -> &'static str {
        self.format().file
    }

    /// True if its record has a page.
    pub fn has_page(self) -> bool {
        !matches!(self, Self::Constrictions | Self::Serve)
    }

    /// True if it holds cases that are continued one by one, each in a folder of its own.
    pub(crate) fn has_cases(self) -> bool {
        self == Self::Batch
    }

    /// Other files that mark such a folder, finished or not.
    fn marks(self) -> &'static [&'static str] {
        match self {
            Self::Run => &["scene.toml", "series.csv", super::checkpoints::FOLDER],
            Self::Packing => &STATES,
            Self::Campaign => &["cases"],
            Self::Percolation => &LATTICES,
            Self::Batch => &["pairs"],
            Self::Boundary => &NETWORKS,
            // Older versions wrote no record.
            Self::Serve => &["sheets"],
            _ => &[],
        }
    }

    /// Files of such a folder, in the order of their removal: removing the first makes the folder unfinished.
    fn files(self) -> &'static [&'static str] {
        match self {
            Self::Run => &[
                "scene.toml",
                "manifest.json",
                "outcome.json",
                "report.html",
                "verdict.xlsx",
                "series.csv",
                "layers.csv",
                "flow.csv",
                "retained.csv",
                "eroded.csv",
                "voids.csv",
                "constrictions_of_network.csv",
                "blocked.csv",
                "retained_by_void.csv",
            ],
            Self::Packing => &[
                RECORD,
                "report.html",
                GRAINS,
                "grains.vtp",
                "constrictions.csv",
                "constrictions.json",
                "constrictions.vtp",
                STATES[0],
                STATES[1],
            ],
            Self::Campaign | Self::Serve => &[],
            Self::Percolation => {
                &["percolation.json", "report.html", "percolation.csv", LATTICES[0], LATTICES[1]]
            }
            // Its cases stay, like everything in a campaign.
            Self::Batch => &["batch.json", "batch.html", "batch.csv"],
            Self::Boundary => &["boundary.json", "boundary.html", "boundary.csv", NETWORKS[0], NETWORKS[1]],
            Self::Designs => &["designs.json", "designs.html", "designs.csv"],
            Self::Specification => &[
                "specification.json",
                "specification.html",
                "specification.csv",
                "specification_steps.csv",
                "specification_products.csv",
                "specification.xlsx",
            ],
            Self::Constrictions => {
                &["constrictions.json", "constrictions.csv", "constrictions.vtp", "graph.csv", "grains.vtp"]
            }
        }
    }

    /// Figures of its page, in `figures`; those of a campaign stay, like everything it holds.
    pub fn figures(self) -> &'static [&'static str] {
        match self {
            Self::Run => &["verdict", "gradations", "eroded", "layers", "retained", "slice"],
            Self::Packing => &["curves", "slice", "connectivity"],
            Self::Percolation => &["percolation-sd", "percolation-threshold"],
            Self::Batch => &["batch-curves", "batch-limits", "batch-eroded"],
            Self::Boundary => &["boundary"],
            Self::Designs => &["designs"],
            Self::Specification => &["specification"],
            Self::Campaign | Self::Serve | Self::Constrictions => &[],
        }
    }

    /// The kind of finished work that a folder holds, if any.
    pub fn of(folder: &Path) -> Option<Self> {
        Self::ALL.into_iter().find(|kind| folder.join(kind.record()).is_file())
    }

    /// True if the work in a folder is finished, its page included; the work of a campaign or a server can
    /// always be extended.
    pub(crate) fn is_finished(self, folder: &Path) -> Result<bool, RunError> {
        let has = |name: &str| folder.join(name).symlink_metadata().is_ok();
        Ok(!has(MARK)
            && match self {
                // With checkpoints, its studies are still to come.
                Self::Run => has("scene.toml") && has("manifest.json") && !Checkpoints::is_in(folder)?,
                // With a state beside it, the process that wrote the record was killed before all was done.
                Self::Packing => has(RECORD) && !STATES.iter().any(|state| has(state)),
                Self::Campaign | Self::Serve => false,
                other => has(other.record()),
            })
    }
}

/// Claims a folder for work of this kind: makes it if it is missing, and locks it. The folder of a campaign
/// may be shared.
///
/// # Errors
/// The folder is not the program's own, or another process holds it. It holds work of another kind or,
/// without `overwrite`, finished work of this kind. Nothing in it was changed then.
pub fn claim(path: &Path, kind: FolderKind, overwrite: bool) -> Result<Folder, RunError> {
    let folder = match kind {
        FolderKind::Campaign => Folder::open_shared(path).map_err(no_locks)?,
        _ => Folder::open(path).map_err(RunError::Claim)?,
    };
    let refuse = |problem: String| Err(refused(path, problem));
    // The mark of unfinished work names its kind; if the mark is corrupt, the files tell the kind.
    let begun = Unfinished::read(&folder)?.map(|begun| begun.kind);
    let of_begun = |other: &FolderKind| begun.as_deref() == Some(other.name());
    if let Some(other) = FolderKind::ALL.into_iter().find(|other| *other != kind && of_begun(other)) {
        return refuse(format!("holds a {}; name another folder", other.name()));
    }
    // Constrictions of a packing belong to it; those of a user's own grains are separate work.
    let packed = folder.has(RECORD) || STATES.iter().any(|state| folder.has(state));
    let packed = kind == FolderKind::Packing && (packed || of_begun(&kind));
    let is_part = |other| packed && other == FolderKind::Constrictions;
    for other in FolderKind::ALL.into_iter().filter(|other| *other != kind && !is_part(*other)) {
        if folder.has(other.record()) || other.marks().iter().any(|mark| folder.has(mark)) {
            return refuse(format!("holds a {}; name another folder", other.name()));
        }
    }
    if !overwrite && kind.is_finished(folder.path())? {
        return refuse(format!("holds a {} already; name another folder or add --overwrite", kind.name()));
    }
    Ok(folder)
}

/// Removes the files of earlier work of this kind from a claimed folder, except the checkpoints of a run,
/// before other work writes its first file. The first removal makes the folder unfinished; files that the
/// program does not recognise as its own stay.
pub(crate) fn clear(folder: &Folder, kind: FolderKind) -> Result<(), StoreError> {
    let files = kind.files();
    if kind == FolderKind::Packing && folder.has(RECORD) {
        // Otherwise, without the record, its constrictions would be taken for those of a user's own grains.
        Unfinished::new(kind, String::new()).begin(folder)?;
    }
    folder.remove_all(&files[..files.len().min(1)])?;
    clear_results(folder, kind)?;
    if kind == FolderKind::Run {
        folder.remove_all_in("inputs", &INPUT_FILES)?;
    }
    folder.remove_all(&[MARK])
}

/// Clears a claimed folder, and marks it as unfinished work of this kind.
pub(crate) fn begin(folder: &Folder, kind: FolderKind) -> Result<(), StoreError> {
    clear(folder, kind)?;
    Unfinished::new(kind, String::new()).begin(folder)
}

/// Clears a claimed folder like [`clear`], except the scene of a run and its input files.
pub(super) fn clear_but_scene(folder: &Folder) -> Result<(), StoreError> {
    clear_results(folder, FolderKind::Run)?;
    folder.remove_all(&[MARK])
}

fn clear_results(folder: &Folder, kind: FolderKind) -> Result<(), StoreError> {
    let files: Vec<&str> = kind.files().iter().copied().filter(|name| *name != "scene.toml").collect();
    folder.remove_all(&files)?;
    // Pictures were made from the drawings by other tools, such as `scripts/browser/figures_to_png.py`.
    let both = |name: &&str| ["svg", "png"].map(|ending| format!("{name}.{ending}"));
    let figures: Vec<String> = kind.figures().iter().flat_map(both).collect();
    folder.remove_all_in("figures", &figures)?;
    folder.remove_all_in("export", &exported(folder.path()))
}

/// Refuses input files that [`clear`] would remove before the work has read them: if the process were killed
/// in between, they would be lost.
pub(super) fn outlive_clear(folder: &Folder, kind: FolderKind, files: &[PathBuf]) -> Result<(), RunError> {
    let Ok(real) = folder.path().canonicalize() else { return Ok(()) };
    let goes = |name: &Path| match (name.parent(), name.file_name().and_then(|name| name.to_str())) {
        (Some(parent), Some(name)) if parent == Path::new("") => kind.files().contains(&name),
        (Some(parent), Some(name)) => parent == Path::new("inputs") && INPUT_FILES.contains(&name),
        _ => false,
    };
    let is_cleared =
        |file: &&PathBuf| file.canonicalize().is_ok_and(|file| file.strip_prefix(&real).is_ok_and(&goes));
    match files.iter().find(is_cleared) {
        Some(file) => Err(RunError::Refused(format!(
            "{}: lies in {}, and is removed before new results are written: a kill would lose it; name \
             another folder by --out",
            shown(file),
            shown(folder.path())
        ))),
        None => Ok(()),
    }
}

/// Names of the files that `voidwalk export` may have written in a folder.
fn exported(folder: &Path) -> Vec<String> {
    let is_moment = |name: &str| {
        let number = EXPORTED_MOMENTS.iter().find_map(|begin| name.strip_prefix(begin)?.strip_suffix(".vtu"));
        number.is_some_and(|number| !number.is_empty() && number.bytes().all(|b| b.is_ascii_digit()))
    };
    let inside = std::fs::read_dir(folder.join("export")).into_iter().flatten().flatten();
    let moments = inside.filter_map(|entry| entry.file_name().into_string().ok()).filter(|n| is_moment(n));
    EXPORTED.iter().map(ToString::to_string).chain(moments).collect()
}

/// Claims the first of `NAME`, `NAME-2`, ... that is new or was left without results by an earlier run.
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

/// Refuses a folder of packings that is a link from one of the program's own folders to a place elsewhere,
/// which would then be written to.
pub(crate) fn own_packings(packings: &Path) -> Result<(), RunError> {
    match packings.symlink_metadata() {
        Ok(meta) if meta.is_symlink() => Err(refused(
            packings,
            "is a symbolic link, which is not followed; put the folder itself there, or remove the link",
        )),
        _ => Ok(()),
    }
}

/// Message on a file system without locks, on which cases cannot be claimed.
fn no_locks(error: StoreError) -> RunError {
    match &error {
        StoreError::Io { action: "lock the folder", .. } => RunError::refused(format!(
            "{error}: this file system has no locks, by which cases are claimed; name a folder on another one"
        )),
        _ => RunError::Claim(error),
    }
}

/// Refusal of a path.
pub(crate) fn refused(path: &Path, problem: impl std::fmt::Display) -> RunError {
    RunError::Refused(format!("{}: {problem}", shown(path)))
}

/// Path on one line.
pub(crate) fn shown(path: &Path) -> String {
    plain(&path.display().to_string())
}

/// Mark of a folder with unfinished work, including work that lacks only its page.
///
/// It is written before the first file of the work and removed after the last, so a folder that holds it is
/// unfinished, whatever else it holds. It identifies the work, so that the same command continues it, and
/// holds the options of a run that change no result.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub(crate) struct Unfinished {
    /// Name of the folder's kind for users.
    pub(crate) kind: String,
    /// Fingerprint of everything that determines the results.
    pub(crate) work: String,
    /// Interval between saves of a run, as it was given.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub(crate) checkpoint_every: Option<String>,
}

impl Unfinished {
    /// Mark of this work; empty if only its kind is known.
    pub(crate) fn new(kind: FolderKind, work: String) -> Self {
        Self { kind: kind.name().into(), work, checkpoint_every: None }
    }

    /// Reads the mark in a folder; `None` without work under way, an empty mark if the file is corrupt.
    pub(crate) fn read(folder: &Folder) -> Result<Option<Self>, StoreError> {
        let bytes = folder.read(MARK)?;
        Ok(bytes.map(|bytes| serde_json::from_slice(&bytes).unwrap_or_default()))
    }

    /// Record of this very work, if everything but its page has been written.
    pub(crate) fn whole<T: DeserializeOwned>(
        &self,
        folder: &Folder,
        record: &str,
    ) -> Result<Option<T>, StoreError> {
        if Self::read(folder)?.as_ref() != Some(self) {
            return Ok(None);
        }
        Ok(folder.read(record)?.and_then(|bytes| from_json(&bytes).ok()))
    }

    /// Marks a folder, unless it has this mark already.
    pub(crate) fn begin(&self, folder: &Folder) -> Result<(), StoreError> {
        if Self::read(folder)?.as_ref() == Some(self) {
            return Ok(());
        }
        folder.write(MARK, &serde_json::to_vec(self).expect("words"))
    }

    /// Removes the mark: the work is finished.
    pub(crate) fn end(folder: &Folder) -> Result<(), StoreError> {
        folder.remove(MARK)
    }
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
                for overwrite in [false, true].into_iter().filter(|_| kind != held) {
                    let error = claim(&path, kind, overwrite).unwrap_err();
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
            if kind == FolderKind::Run {
                folder.write("scene.toml", b"").unwrap();
            }
            drop(folder);
            assert_eq!(FolderKind::of(&path), Some(kind));
            assert!(claim(&path, kind, true).is_ok());
            match (kind, claim(&path, kind, false)) {
                (FolderKind::Campaign | FolderKind::Serve, claimed) => assert!(claimed.is_ok()),
                (_, claimed) => {
                    let message =
                        format!("holds a {} already; name another folder or add --overwrite", kind.name());
                    assert!(claimed.unwrap_err().to_string().ends_with(&message));
                }
            }
        }
    }
}
