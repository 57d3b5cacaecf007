//! Whether the commas in the numbers of a table are decimal signs.

use super::content::percentage;
use super::extent::Extent;
use super::grid::Grid;
use super::heading::Role;
use super::layout::{Layout, SoilColumn};
use super::size::Unit;
use crate::gradation::comma::{Comma, comma};
use crate::gradation::error::TableError;

/// Refuses a table whose numbers have points and commas, and one in which every comma may be that of
/// thousands.
pub(super) fn check(
    grid: &Grid,
    layout: &Layout,
    extent: &Extent,
    column: &SoilColumn,
    notes: &mut Vec<String>,
) -> Result<(), TableError> {
    let (mut point, mut other, mut decimal, mut either) = (None, None, false, None);
    for row in extent.rows(grid, layout) {
        let at = extent.column_of_size(layout, row);
        for c in [at, column.column] {
            let cell = row.cell(c);
            // `1,254.6` has both: one of them parts thousands.
            let is_number = percentage(cell).is_some() && !(cell.contains('.') && cell.contains(','));
            if is_number && cell.contains('.') {
                point = point.or(Some(row.line));
            }
            if is_number && cell.contains(',') {
                other = other.or(Some((row.line, cell)));
            }
            // No percentage is a thousand.
            let is_percent = c != at && !matches!(column.role, Role::Retained(_));
            match comma(cell) {
                Some(Comma::Decimal) => decimal = true,
                Some(Comma::Either) if is_percent => decimal = true,
                Some(Comma::Either) => either = either.or(Some((row.line, c, cell))),
                None => {}
            }
        }
    }
    if let (Some(point), Some((line, value)), None) = (point, other, &grid.sheet) {
        let allowed = format!(
            "one decimal sign in the whole file ({} has a decimal point), no thousands separators",
            grid.said(point)
        );
        return Err(grid.refused(line, layout.size, "number", value, allowed));
    }
    let Some((line, c, cell)) = either else { return Ok(()) };
    let is_usual =
        !decimal && (grid.sheet.is_some() || grid.delimiter == ',' || layout.unit == Some(Unit::Micrometre));
    if is_usual {
        let (as_decimal, as_thousands) = (cell.replace(',', "."), cell.replace(',', ""));
        let allowed = format!(
            "{as_decimal} or {as_thousands}: here the comma may be a decimal sign or separate thousands"
        );
        return Err(grid.refused(line, c, "number", cell, allowed));
    }
    notes.push(format!("commas within numbers, as in {cell}, read as decimal signs"));
    Ok(())
}
