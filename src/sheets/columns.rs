//! What the columns of a table hold, from one passage over its cells.

use super::content::{is_blank, is_text, is_value, range};
use super::grid::GridRow;
use voidwalk_core::gradation::number;

/// Facts of each column.
pub(super) struct Columns {
    /// Any of its cells is a number, bare of signs.
    pub(super) with_numbers: Vec<bool>,
    /// Any is a percentage or a range.
    pub(super) with_values: Vec<bool>,
    /// Any is a range such as `95-100`.
    pub(super) with_ranges: Vec<bool>,
    /// More are values than anything else, but for rows of text: one that is none is refused with its cell.
    pub(super) mostly_values: Vec<bool>,
}

impl Columns {
    /// Of `rows`, of which a table has `width` columns.
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
