//! Pages and verdicts of walks, by the library's reports.

use std::path::{Path, PathBuf};

use pyo3::prelude::*;
use pyo3::types::PyDict;
use voidwalk::cli::page;
use voidwalk::outcome::record::Outcome;
use voidwalk::report::files::json_of;
use voidwalk::report::{self as reports, ReportError};
use voidwalk::run::folder::claim;
use voidwalk::run::{FolderKind, RunError};
use voidwalk::verdict::RunFiles;

use crate::problem::{of_run, refused};
use crate::tables::to_recorded;

/// Writes the page of a finished folder again.
#[pyfunction]
pub fn report(py: Python<'_>, folder: PathBuf) -> PyResult<PathBuf> {
    let write = |folder: &Path| {
        let Some(kind) = FolderKind::of(folder).filter(|kind| kind.has_page()) else {
            let problem = "holds no finished run, packing, campaign or study";
            return Err(RunError::Refused(format!("{}: {problem}", folder.display())));
        };
        let claimed = claim(folder, kind, true)?;
        page(kind, claimed.path(), None).map_err(RunError::failed)
    };
    py.detach(|| write(&folder)).map_err(|error| of_run(&error))
}

/// A page as text; changes of a user in a result are refused if they do not fit together.
fn text(py: Python<'_>, page: impl FnOnce() -> Result<String, ReportError> + Send) -> PyResult<String> {
    py.detach(page).map_err(refused)
}

/// The page of a run in memory, from the contents of its files.
#[pyfunction]
pub fn run_page(
    py: Python<'_>,
    outcome: &str,
    texts: (String, String, Option<String>),
    tables: &Bound<'_, PyDict>,
) -> PyResult<String> {
    let (recorded, (manifest, scene, packing)) = (to_recorded(tables)?, texts);
    text(py, || {
        let packing = packing.map(|text| json_of(Path::new("inputs/packing.json"), &text)).transpose()?;
        let outcome: Outcome = json_of(Path::new("outcome.json"), outcome)?;
        let manifest = json_of(Path::new("manifest.json"), &manifest)?;
        let about = reports::about_page(Path::new("scene.toml"), &scene, &outcome)?;
        let decision = outcome.decision();
        reports::run_page(RunFiles { outcome, decision, manifest, scene, about, packing, recorded })
    })
}

/// The verdict of a run as a piece of a page.
#[pyfunction]
pub fn run_brief(py: Python<'_>, outcome: &str) -> PyResult<String> {
    text(py, || reports::run_brief(outcome))
}

/// The page of walks on networks.
#[pyfunction]
pub fn walk_page(py: Python<'_>, record: &str, tables: &Bound<'_, PyDict>) -> PyResult<String> {
    let recorded = to_recorded(tables)?;
    text(py, || reports::network_walk_page(record, recorded))
}

/// The verdict of walks on networks as a piece of a page.
#[pyfunction]
pub fn walk_brief(py: Python<'_>, record: &str) -> PyResult<String> {
    text(py, || reports::network_walk_brief(record))
}
