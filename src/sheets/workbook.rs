//! Conversion of a workbook to its sheets.

use super::grid::Grid;
use super::zipped::{Zipped, unreadable};
use super::{ods, xlsx};
use voidwalk_core::gradation::TableError;

/// True if a file is a zip, like workbooks.
pub(super) fn is_zip(bytes: &[u8]) -> bool {
    bytes.starts_with(b"PK\x03\x04") || bytes.starts_with(b"PK\x05\x06")
}

/// Sheets that are not empty.
pub(super) fn sheets(file: &str, bytes: &[u8]) -> Result<Vec<Grid>, TableError> {
    let mut zipped = Zipped::open(file, bytes)?;
    let sheets = if zipped.has("xl/workbook.xml") {
        xlsx::sheets(file, &mut zipped)?
    } else if zipped.has("content.xml") {
        ods::sheets(file, &mut zipped)?
    } else {
        return Err(unreadable(file, "it is a zip, but no workbook (.xlsx or .ods)"));
    };
    Ok(sheets.into_iter().filter(|sheet| !sheet.rows.is_empty()).collect())
}
