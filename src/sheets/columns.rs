//! Facts about the columns of a table, from one pass over its cells.

use super::content::{is_blank, is_text, is_value, range};
use super::grid::GridRow;
use voidwalk_core::gradation::number;

/// Facts of each column.
pub(super) struct Columns {
    /// True if any cell is a number, bare of signs.
    pub(super) with_numbers: Vec<bool>,
    /// True if any cell is a percentage or a range.
    pub(super) with_values: Vec<bool>,
    /// True if any cell is a range such as `95-100`.
    pub(super) with_ranges: Vec<bool>,
    /// True if values outnumber other cells, rows of text apart: a cell that is no value is then refused by
    /// name.
    pub(super) mostly_values: Vec<bool>,
}

impl Columns {
    /// Reads the facts from `rows` of a table with `width` columns.
    pub(super) fn of(rows: &[GridRow], width: usize) -> Columns {
        let width = rows.iter().map(|row| row.cells.len()).max().unwrap_or(0).max(width);
        let mut columns = Columns {
            with_numbers: vec![false; width],
            with_values: vec![false; width],
            with_ranges: vec![false; width],
            mostly_values: Vec::new(),
        };
        let mut balance = vec![0i64; width];
        for row in rows {
            let is_text = is_text(row);
            for c in row.filled() {
                let cell = row.cell(c);
                let is_value = is_value(cell);
                columns.with_numbers[c] |= number(cell).is_some();
                columns.with_values[c] |= is_value;
                columns.with_ranges[c] |= range(cell).is_some();
                balance[c] += match is_value {
                    true => 1,
                    false => -i64::from(!is_text && !is_blank(cell)),
                };
            }
        }
        columns.mostly_values = balance.into_iter().map(|more| more > 0).collect();
        columns
    }
}
