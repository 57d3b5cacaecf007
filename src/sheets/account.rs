//! The account of a table's numbers: each is read, named as left out, or the table is refused.

use std::collections::HashSet;

use super::content::{is_blank, is_value};
use super::extent::Extent;
use super::grid::{Grid, GridRow};
use super::layout::Layout;
use super::size::{Opening, opening};
use super::table::Soil;
use voidwalk_core::gradation::FIELDS;
use voidwalk_core::gradation::TableError;

/// Refuses a table that holds a number found in no curve and named by no note.
pub(super) fn refuse_lost(
    grid: &Grid,
    layout: &Layout,
    extent: &Extent,
    soils: &[Result<Soil, TableError>],
) -> Result<(), TableError> {
    let lost = |line: usize, column: usize, cell: &str| {
        let allowed = "numbers that are read, or stand in a column of their own beside the table";
        Err(grid.refused(line, column, FIELDS[1], cell, allowed))
    };
    let is_rest = |row: &GridRow| {
        let size = opening(row.cell(extent.column_of_size(layout, row)));
        matches!(size, Some((Opening::Pan | Opening::Total | Opening::Below(_), _)))
            || matches!(size, Some((Opening::Class(_, 0.0), _)))
            || matches!(size, Some((Opening::Bare(0.0) | Opening::Mm(0.0), _)))
    };
    let mut read: HashSet<usize> = HashSet::new();
    for (column, soil) in layout.soils.iter().zip(soils) {
        // A refused soil carries its own reason.
        let Ok(soil) = soil else { return Ok(()) };
        let lines: HashSet<usize> = soil.rows.iter().map(|row| row.line).collect();
        for row in extent.rows(grid, layout).filter(|row| !lines.contains(&row.line)) {
            let cell = row.cell(column.column);
            if is_value(cell) && !is_rest(row) {
                return lost(row.line, column.column, cell);
            }
        }
        read.extend(lines);
    }
    let is_read = |row: &GridRow, c: usize| {
        let is_size = Some(c) == layout.other_size || c == layout.size;
        let is_skipped = || layout.soils.iter().all(|soil| is_blank(row.cell(soil.column)));
        layout.accounted.contains(&c)
            || layout.soils.iter().any(|soil| soil.column == c)
            || is_size && (read.contains(&row.line) || is_rest(row) || is_skipped())
    };
    for row in extent.rows(grid, layout) {
        if let Some(c) = row.filled().find(|&c| is_value(row.cell(c)) && !is_read(row, c)) {
            return lost(row.line, c, row.cell(c));
        }
    }
    Ok(())
}
