//! Check of the commas in the numbers of a table: decimal signs, or signs of thousands.

use super::content::percentage;
use super::extent::Extent;
use super::grid::Grid;
use super::heading::{Retained, Role};
use super::layout::{Layout, SoilColumn};
use super::size::Unit;
use voidwalk_core::gradation::TableError;
use voidwalk_core::gradation::{Comma, comma};

/// Refuses a table whose numbers have points and commas, and one in which every comma may separate thousands.
pub(super) fn check(
    grid: &Grid,
    layout: &Layout,
    extent: &Extent,
    column: &SoilColumn,
    notes: &mut Vec<String>,
) -> Result<(), TableError> {
    refuse_points_of_thousands(grid, layout, extent, column)?;
    let (mut point, mut other, mut decimal, mut either) = (None, None, false, None);
    for row in extent.rows(grid, layout) {
        let at = extent.column_of_size(layout, row);
        for c in [at, column.column] {
            let cell = row.cell(c);
            // `1,254.6` has both: one of them separates thousands.
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
            grid.row_label(point)
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

/// Refuses `1.100` among whole masses of hundreds of grams: the point may separate thousands.
fn refuse_points_of_thousands(
    grid: &Grid,
    layout: &Layout,
    extent: &Extent,
    column: &SoilColumn,
) -> Result<(), TableError> {
    const LEAST: f64 = 100.0;
    if !matches!(column.role, Role::Retained(Retained { percent: false, .. })) {
        return Ok(());
    }
    let may_be_thousands = |cell: &str| {
        let (whole, rest) = cell.split_once('.').unwrap_or_default();
        let is_digits = |text: &str| text.bytes().all(|b| b.is_ascii_digit());
        (1..=3).contains(&whole.len())
            && !whole.starts_with('0')
            && rest.len() == 3
            && is_digits(whole)
            && is_digits(rest)
    };
    let (mut first, mut largest) = (None, 0.0f64);
    for row in extent.rows(grid, layout) {
        let cell = row.cell(column.column);
        match percentage(cell) {
            Some(_) if may_be_thousands(cell) => first = first.or(Some((row.line, cell))),
            Some(mass) if mass.fract() != 0.0 => return Ok(()),
            Some(mass) => largest = largest.max(mass),
            None => {}
        }
    }
    match first.filter(|_| largest >= LEAST) {
        Some((line, cell)) => {
            let allowed = format!(
                "{cell} or {}, as a number: here the point may be a decimal sign or separate thousands",
                cell.replace('.', "")
            );
            Err(grid.refused(line, column.column, "number", cell, allowed))
        }
        None => Ok(()),
    }
}
