//! The report: one page and its figures, from a finished run folder alone.
//!
//! [`write()`] reads what a run left behind (`outcome.json`, `manifest.json`, `scene.toml`, `series.csv`, `layers.csv`,
//! `retained.csv`, `eroded.csv`; see [`crate::outcome::record`]) and runs nothing. It writes `figures/*.svg`, each a
//! file of its own, and `report.html`.
//!
//! # What the page may do
//! Nothing but show itself. Its content security policy forbids every script and every fetch and names its one style by
//! hash; figures are SVG elements without a style. Names come from users and are taken for hostile: markup in them is
//! escaped, control characters and those that turn the direction of writing are replaced.
//!
//! # Order
//! An engineer reads the verdict first, with its numbers, and beside it what the model leaves out; then warnings,
//! figures, the rules of practice, tables, and how to make the same again.

pub mod figures;
mod folder;
mod numbers;
mod page;
mod run_figures;

use std::fs;
use std::io::Write as _;
use std::path::{Path, PathBuf};

pub use folder::ReportError;
use folder::RunFolder;
use run_figures::Drawn;

/// What [`write()`] wrote.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Written {
    /// `report.html`.
    pub page: PathBuf,
    /// `figures/*.svg`, in the order of the page.
    pub figures: Vec<PathBuf>,
}

/// Writes `report.html` and `figures/*.svg` into a finished run folder.
///
/// Each file appears whole or not at all, and an older one of the same name is replaced.
///
/// # Errors
/// [`ReportError`] names the file, and where there is one the line and field, that is missing, malformed or
/// contradicts another. Nothing is written then.
pub fn write(folder: &Path) -> Result<Written, ReportError> {
    let run = RunFolder::read(folder)?;
    let verdict = run_figures::verdict(&run);
    let figures: Vec<Drawn> = [
        Some(run_figures::gradations(&run)),
        run_figures::eroded(&run),
        run_figures::layers(&run),
        run_figures::retained(&run),
        run_figures::sensitivity(&run),
    ]
    .into_iter()
    .flatten()
    .collect();

    let drawings = folder.join("figures");
    fs::create_dir_all(&drawings).map_err(|source| ReportError::Write { path: drawings.clone(), source })?;
    let mut written = Vec::new();
    for drawn in std::iter::once(&verdict).chain(&figures) {
        let path = drawings.join(format!("{}.svg", drawn.name));
        put(&path, &drawn.figure.file())?;
        written.push(path);
    }
    let page = folder.join("report.html");
    put(&page, &page::page(&run, &verdict, &figures))?;
    Ok(Written { page, figures: written })
}

/// Writes beside the target, syncs, renames: a reader sees the old file or the new one.
fn put(path: &Path, content: &str) -> Result<(), ReportError> {
    let wrap = |source| ReportError::Write { path: path.to_owned(), source };
    let folder = path.parent().unwrap_or(Path::new("."));
    let mut builder = tempfile::Builder::new();
    #[cfg(unix)]
    {
        // a report is made to be shared: the user's umask decides, not the private mode of temporary files
        use std::os::unix::fs::PermissionsExt as _;
        builder.permissions(fs::Permissions::from_mode(0o666));
    }
    let mut file = builder.prefix(".report-").tempfile_in(folder).map_err(wrap)?;
    file.write_all(content.as_bytes()).map_err(wrap)?;
    file.as_file().sync_all().map_err(wrap)?;
    file.persist(path).map_err(|error| wrap(error.error))?;
    Ok(())
}
