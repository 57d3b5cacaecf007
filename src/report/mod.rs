//! The report: one page and its figures, from a finished run folder alone.
//!
//! [`write()`] reads what a run left behind (`outcome.json`, `manifest.json`, `scene.toml`, `series.csv`,
//! `layers.csv`, `retained.csv`, `eroded.csv`; see [`crate::outcome::record`]) and runs nothing;
//! [`write_packing()`] does the same for the folder of a packing, [`write_campaign()`] for a campaign's,
//! [`write_percolation()`] for a percolation study's, and [`write_precision()`] for error against run time.
//! They write `figures/*.svg`, each a file of its own, and `report.html`.
//!
//! # Pages of others
//! A program with a page of its own over the same results, as `scripts/paper`, builds it from these:
//! [`files`] reads what lies in a folder, [`figures`] draws, [`numbers`] writes a number as the other pages
//! do, and [`shell`] is the page around it, which [`write_page()`] writes. A figure of ours that others show
//! too is public by itself: [`percolation_spread()`].
//!
//! # What the page may do
//! Nothing but show itself. Its content security policy forbids every script and every fetch and names its
//! one style by hash; figures are SVG elements without a style. Names come from users and are taken for
//! hostile: markup in them is escaped, control characters and those that turn the direction of writing are
//! replaced.
//!
//! # Order
//! An engineer reads the verdict first, with its numbers, and beside it what the model leaves out; then
//! warnings, figures, the rules of practice, tables, and how to make the same again.

mod campaign;
mod connectivity;
mod error;
pub mod figures;
pub mod files;
mod folder;
mod infiltration;
pub mod numbers;
mod packing;
mod page;
mod percolation;
mod precision;
mod rules;
mod run_figures;
pub mod shell;

use std::path::{Path, PathBuf};

pub use campaign::write_campaign;
pub use error::ReportError;
use folder::RunFolder;
pub use packing::write_packing;
pub use percolation::{percolation_spread, write_percolation};
pub use precision::{precision_judgements, write_precision};
use shell::Drawn;

use crate::store::{make_folder, write_whole};

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
        run.packing.as_ref().map(packing::slice),
    ]
    .into_iter()
    .flatten()
    .collect();

    let page = page::page(&run, &verdict, &figures);
    let all: Vec<Drawn> = std::iter::once(verdict).chain(figures).collect();
    write_page(folder, &all, &page)
}

/// Writes the figures as `figures/*.svg`, then the page as `report.html`.
///
/// Each file appears whole or not at all, and an older one of the same name is replaced.
///
/// # Errors
/// [`ReportError::Write`] names the file that cannot be written.
pub fn write_page(folder: &Path, figures: &[Drawn], page: &str) -> Result<Written, ReportError> {
    write_page_as("report.html", folder, figures, page)
}

/// The same for a page of another name.
fn write_page_as(name: &str, folder: &Path, figures: &[Drawn], page: &str) -> Result<Written, ReportError> {
    let drawings = folder.join("figures");
    make_folder(&drawings)?;
    let mut written = Vec::new();
    for drawn in figures {
        let path = drawings.join(format!("{}.svg", drawn.name));
        write_whole(&path, drawn.figure.file().as_bytes())?;
        written.push(path);
    }
    let path = folder.join(name);
    write_whole(&path, page.as_bytes())?;
    Ok(Written { page: path, figures: written })
}
