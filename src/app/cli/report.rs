//! `voidwalk report`, and the pages of all commands.

use std::path::{Path, PathBuf};

use super::print::{shown, to_stdout};
use crate::report::{self, ReportError};
use crate::run::folder::claim;
use crate::run::{FolderKind, RunError};
use crate::verdict::RunFiles;

/// Writes the report of a finished folder again.
pub fn report(folder: &Path) -> Result<(), RunError> {
    let Some(kind) = FolderKind::of(folder).filter(|kind| kind.has_page()) else {
        let problem = "holds no outcome.json, packing.json, campaign.json, batch.json, percolation.json, \
            boundary.json, designs.json or specification.json; name the folder of a finished run, packing, \
            campaign, batch, study or specification";
        return Err(RunError::Refused(format!("{}: {problem}", shown(folder))));
    };
    let claimed = claim(folder, kind, true)?;
    let page = page(kind, claimed.path(), None).map_err(|error| match error {
        ReportError::Form { .. } => RunError::Refused(error.to_string()),
        _ => RunError::failed(error),
    })?;
    to_stdout(&format!("{}\n", shown(&page)));
    Ok(())
}

/// Writes the page of finished results, of a run from the content of its files if that is at hand; a set of
/// constrictions has no page, nor has a server's folder.
pub fn page(kind: FolderKind, folder: &Path, run: Option<RunFiles>) -> Result<PathBuf, ReportError> {
    let written = match kind {
        FolderKind::Run => match run {
            Some(files) => report::write_walked(folder, files),
            None => report::write(folder),
        },
        FolderKind::Packing => report::write_packing(folder),
        FolderKind::Campaign => report::write_campaign(folder),
        FolderKind::Percolation => report::write_percolation(folder),
        FolderKind::Batch => report::write_batch(folder),
        FolderKind::Boundary => report::write_boundary(folder),
        FolderKind::Designs => report::write_designs(folder),
        FolderKind::Specification => report::write_specification(folder),
        FolderKind::Constrictions | FolderKind::Serve => return Ok(folder.to_owned()),
    };
    written.map(|written| written.page)
}
