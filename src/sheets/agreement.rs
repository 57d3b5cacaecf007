//! Comparison of two columns of openings.

use super::grid::Grid;
use super::heading::unit;
use super::layout::Headings;
pub(super) use super::size::near;
use super::size::{Opening, Unit, opening};

/// True if columns `a` and `b` name the same openings in every row, and some row has both.
pub(super) fn agree(grid: &Grid, headings: &Headings, a: usize, b: usize) -> bool {
    let unit_of = |c: usize| headings.heads.get(c).and_then(|head| unit(head).ok().flatten());
    let (unit_a, unit_b) = (unit_of(a), unit_of(b));
    let mut both = 0;
    for row in &grid.rows[headings.first..] {
        match (in_mm(row.cell(a), unit_a), in_mm(row.cell(b), unit_b)) {
            (Some(one), Some(other)) if near(one, other) => both += 1,
            (None, None) => {}
            (Some(_), None) | (None, Some(_)) | (Some(_), Some(_)) => return false,
        }
    }
    both > 0
}

/// Opening of a cell in mm, whether or not its heading names a unit.
fn in_mm(cell: &str, unit: Option<Unit>) -> Option<f64> {
    match opening(cell)?.0 {
        Opening::Mm(mm) => Some(mm),
        Opening::Bare(value) => unit.unwrap_or(Unit::Mm).mm(value),
        _ => None,
    }
}
