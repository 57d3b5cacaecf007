//! Answers as workbooks: numbers as numbers, units in the headings, the same bytes twice.

mod sheet;
mod specification;
mod template;
mod verdict;

use std::path::{Path, PathBuf};

use rust_xlsxwriter::XlsxError;

use super::error::ReportError;
use super::folder::RunFolder;
use sheet::{Sheet, is_before_1970, workbook};
use voidwalk_core::store::write_whole;
use voidwalk_practice::design::Specification;

/// The workbook of a run.
pub(super) const VERDICT: &str = "verdict.xlsx";

/// The workbook of a specification.
const SPECIFICATION: &str = "specification.xlsx";

/// Writes `verdict.xlsx` into `into`, from the files of a finished run folder: the answer, the inputs, every
/// rule with its formula and source, every run, both gradations, and the program that made it.
///
/// # Errors
/// Returns the errors of [`super::write()`].
pub fn write_verdict_workbook(folder: &Path, into: &Path) -> Result<PathBuf, ReportError> {
    let path = into.join(VERDICT);
    write_whole(&path, &verdict_workbook(folder)?)?;
    Ok(path)
}

/// The workbook of a run, as bytes.
///
/// # Errors
/// Returns the errors of [`super::write()`].
pub(super) fn verdict_workbook(folder: &Path) -> Result<Vec<u8>, ReportError> {
    bytes(&folder.join(VERDICT), "voidwalk: verdict", &verdict::sheets(&RunFolder::read(folder)?))
}

/// Writes `specification.xlsx` into a folder: steps, limits, band, products, and the base. With a clock
/// before 1970 there is no workbook.
///
/// # Errors
/// Returns the error of a file that cannot be written.
pub(super) fn write_specification_workbook(
    folder: &Path,
    specification: &Specification,
) -> Result<(), ReportError> {
    if is_before_1970() {
        return Ok(());
    }
    let (path, sheets) = (folder.join(SPECIFICATION), specification::sheets(specification));
    Ok(write_whole(&path, &bytes(&path, "voidwalk: specification of a filter", &sheets)?)?)
}

/// A workbook to fill in, which [`voidwalk_sheets::soils_in_file`] reads: one column per soil, as bytes.
///
/// ```
/// let bytes = voidwalk_app::report::soil_template()?;
/// assert!(bytes.starts_with(b"PK"));
/// # Ok::<(), voidwalk_app::report::ReportError>(())
/// ```
///
/// # Errors
/// A clock before 1970.
pub fn soil_template() -> Result<Vec<u8>, ReportError> {
    bytes(Path::new("template"), "voidwalk: sieve tables", &template::sheets())
}

/// A workbook; `path` names it in errors.
fn bytes(path: &Path, title: &str, sheets: &[Sheet]) -> Result<Vec<u8>, ReportError> {
    let message = |error: XlsxError| error.to_string();
    workbook(title, sheets).map_err(message).map_err(|message| ReportError::Form {
        path: path.to_owned(),
        line: 0,
        message,
    })
}
