//! Measures the constrictions of a packing from elsewhere and writes them into a folder.

use std::path::{Path, PathBuf};

use super::callbacks::Callbacks;
use super::error::RunError;
use super::folder::{FolderKind, claim, clear, shown};
use super::unfinished::{self, Unfinished};
use crate::constrictions::{Constrictions, DEFAULT_MERGE_OVERLAP, Summary};
use crate::packing::Packing;

/// How constrictions are measured.
#[derive(Clone, Debug)]
pub struct ConstrictionsOptions {
    /// Overlap of two inscribed spheres from which their tetrahedra are one void.
    pub merge_overlap: f64,
    /// Folder for the results.
    pub out: PathBuf,
    /// Whether earlier results there are replaced.
    pub overwrite: bool,
}

impl Default for ConstrictionsOptions {
    fn default() -> Self {
        Self { merge_overlap: DEFAULT_MERGE_OVERLAP, out: "voidwalk-constrictions".into(), overwrite: false }
    }
}

/// Measures the constrictions of the grains in a file and writes `grains.vtp`, `constrictions.csv`,
/// `constrictions.vtp` and, last, `constrictions.json`; gives what that file says.
///
/// # Errors
/// Grains that are refused, a folder that cannot be claimed or written.
pub fn measure_constrictions(
    packing: &Path,
    options: &ConstrictionsOptions,
    callbacks: &Callbacks,
) -> Result<Summary, RunError> {
    let file = shown(packing);
    let (packing, notes) = Packing::read_with_notes(packing)?;
    let found = Constrictions::measure(&packing, options.merge_overlap)
        .map_err(|error| RunError::Refused(format!("{file}: {error}")))?;
    // Those near the outside of grains without a cell are no part of the curve.
    let whole =
        |summary: &Summary| summary.grains_per_void.is_finite() && summary.mean_connectivity.is_finite();
    let summary = found.summary().ok().filter(whole).ok_or_else(|| {
        RunError::Refused(format!(
            "{file}: {} grains are too few: no constriction lies between two voids inside the packing. At \
             least 5 grains that do not lie in one plane are needed for one, some thousands for a curve",
            packing.diameter.len()
        ))
    })?;
    notes.iter().for_each(|note| (callbacks.warn)(note));
    let folder = claim(&options.out, FolderKind::Constrictions, options.overwrite)?;
    clear(&folder, FolderKind::Constrictions)?;
    let mark = Unfinished { kind: FolderKind::Constrictions.name().into(), ..Unfinished::default() };
    mark.begin(&folder)?;
    folder.write("grains.vtp", packing.to_vtp().as_bytes())?;
    for (name, text) in found.files()? {
        folder.write(name, text.as_bytes())?;
    }
    unfinished::end(&folder)?;
    Ok(summary)
}
