//! Writes a page and its figures.

use std::path::{Path, PathBuf};

use super::error::ReportError;
use super::shell::Drawn;
use crate::store::{make_folder, write_whole};

/// The files of a report.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Written {
    /// `report.html`.
    pub page: PathBuf,
    /// `figures/*.svg`, in the order of the page.
    pub figures: Vec<PathBuf>,
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

/// [`write_page()`] for a page of another name.
pub(super) fn write_page_as(
    name: &str,
    folder: &Path,
    figures: &[Drawn],
    page: &str,
) -> Result<Written, ReportError> {
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
