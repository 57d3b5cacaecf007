//! Writes a page and its figures.

use std::path::{Path, PathBuf};

use super::error::ReportError;
use super::shell::Drawn;
use voidwalk_core::store::{Together, make_folder};

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

/// Writes a page under another name, like [`write_page()`].
pub(super) fn write_page_as(
    name: &str,
    folder: &Path,
    figures: &[Drawn],
    page: &str,
) -> Result<Written, ReportError> {
    make_folder(&folder.join("figures"))?;
    let mut files = Together::in_folder(folder);
    let mut written = Vec::new();
    for drawn in figures {
        let name = format!("figures/{}.svg", drawn.name);
        files.add(&name, drawn.figure.file().as_bytes())?;
        written.push(folder.join(name));
    }
    files.add(name, page.as_bytes())?;
    files.finish()?;
    Ok(Written { page: folder.join(name), figures: written })
}
