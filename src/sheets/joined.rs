//! The part of a curve below the finest sieve, given in a separate table.

use super::blocks::Block;
use super::heading::{Role, says_of_fines, says_sedimentation};
use super::table::Soil;
use voidwalk_core::gradation::FIELDS;
use voidwalk_core::gradation::TableError;

/// A table that ends below this size (mm) is from a hydrometer.
const HYDROMETER_MM: f64 = 0.08;

/// A table and its soils as read.
pub(super) struct Read {
    pub(super) block: Block,
    pub(super) title: String,
    pub(super) soils: Vec<Result<Soil, TableError>>,
}

impl Read {
    fn says_sedimentation(&self) -> bool {
        let (grid, layout) = (&self.block.grid, &self.block.layout);
        let rows = &grid.rows[..layout.first.min(grid.rows.len())];
        says_sedimentation(&self.title)
            || rows.iter().flat_map(|row| &row.cells).any(|cell| says_sedimentation(cell))
    }

    fn curves(&self) -> Option<Vec<&Soil>> {
        self.soils.iter().map(|soil| soil.as_ref().ok()).collect()
    }
}

/// Size and percent of the coarsest and the finest row.
fn ends(soil: &Soil) -> Option<[(f64, f64); 2]> {
    let by_size =
        |a: &&voidwalk_core::gradation::Row, b: &&voidwalk_core::gradation::Row| a.size.total_cmp(&b.size);
    let (top, low) = (soil.rows.iter().max_by(by_size)?, soil.rows.iter().min_by(by_size)?);
    Some([(top.size, top.percent), (low.size, low.percent)])
}

/// Joins each table that continues an earlier one to that table; the others remain as they are.
pub(super) fn joined(tables: Vec<Read>) -> Result<Vec<Read>, TableError> {
    let mut done: Vec<Read> = Vec::new();
    for table in tables {
        match before(&done, &table) {
            Some(at) if continues(&done[at], &table)? => join(&mut done[at], table),
            _ => done.push(table),
        }
    }
    Ok(done)
}

/// The earlier table that this one may continue: the one above it, or else the last to its left.
fn before(done: &[Read], table: &Read) -> Option<usize> {
    // A sheet has few tables side by side, so only the last ones are considered.
    const NEAR: usize = 40;
    let columns = &table.block.columns;
    let near = || done.iter().enumerate().rev().take(NEAR);
    let above = near().find(|(_, other)| {
        let of_other = &other.block.columns;
        of_other.start < columns.end
            && columns.start < of_other.end
            && other.block.line() < table.block.line()
    });
    let left = || {
        let is_left = |(_, other): &(usize, &Read)| other.block.columns.end <= columns.start;
        let same = near().filter(is_left).find(|(_, other)| other.block.line() == table.block.line());
        same.or_else(|| near().find(is_left))
    };
    above.or_else(left).map(|(at, _)| at)
}

/// True if a table continues an earlier one; an error if it says so or seems to, and does not.
fn continues(sieves: &Read, table: &Read) -> Result<bool, TableError> {
    let (Some(above), Some(below)) = (sieves.curves(), table.curves()) else { return Ok(false) };
    let says = table.says_sedimentation() && !sieves.says_sedimentation();
    let is_own = !table.title.is_empty() && table.title != sieves.title && !says_sedimentation(&table.title);
    let layout = &table.block.layout;
    let mut goes_on = above.len() == below.len() && !is_own;
    let mut seems = says;
    for (index, lower) in below.iter().enumerate() {
        let Some(upper) = above.get(index).or(above.first()) else { return Ok(false) };
        let (Some([_, last]), Some([top, _])) = (ends(upper), ends(lower)) else { return Ok(false) };
        let column = &layout.soils[index];
        let of_fines = says_of_fines(&column.heading);
        let same_name = column.role != Role::Other
            || sieves.block.layout.soils.get(index).is_some_and(|soil| soil.heading == column.heading);
        let finer = top.0 < last.0 && top.1 <= last.1 || top == last;
        let whole = top.1 < 100.0 || says;
        goes_on &= finer && whole && !of_fines && same_name && !matches!(column.role, Role::Retained(_));
        seems |=
            top.0 <= HYDROMETER_MM && top.0 <= 1.1 * last.0 && last.1 < 100.0 && (top.1 == 100.0 || of_fines);
    }
    if !goes_on && seems {
        let (Some(first), Some(Some([_, last]))) = (below.first(), above.first().map(|soil| ends(soil)))
        else {
            return Ok(false);
        };
        let Some(index) =
            (0..first.rows.len()).max_by(|&a, &b| first.rows[a].size.total_cmp(&first.rows[b].size))
        else {
            return Ok(false);
        };
        let allowed = format!(
            "sizes below {} mm and percents of the whole soil, at most {}, as this table continues the \
             sieves; a soil of its own goes to a file or sheet of its own",
            last.0, last.1
        );
        let (grid, row) = (&table.block.grid, first.rows[index]);
        return Err(grid.refused(
            row.line,
            layout.soils[0].column,
            FIELDS[1],
            &row.percent.to_string(),
            allowed,
        ));
    }
    Ok(goes_on)
}

fn join(sieves: &mut Read, table: Read) {
    for (upper, lower) in sieves.soils.iter_mut().zip(table.soils) {
        let (Ok(upper), Ok(mut lower)) = (upper.as_mut(), lower) else { continue };
        let falls = |soil: &Soil| match (soil.rows.first(), soil.rows.last()) {
            (Some(first), Some(last)) => first.size >= last.size,
            _ => true,
        };
        let descends = falls(upper);
        if falls(&lower) != descends && lower.rows.len() > 1 {
            lower.rows.reverse();
            lower.places.reverse();
        }
        // The finest sieve may be given in both.
        let shared = |lower: &Soil| {
            let row = if descends { lower.rows.first() } else { lower.rows.last() };
            row.is_some_and(|row| upper.rows.iter().any(|u| u.size == row.size))
        };
        if shared(&lower) {
            let at = if descends { 0 } else { lower.rows.len() - 1 };
            lower.rows.remove(at);
            lower.places.remove(at);
        }
        let (first, last) = match (lower.places.first(), lower.places.last()) {
            (Some(first), Some(last)) => (first[1].line, last[1].line),
            _ => (table.block.line(), table.block.line()),
        };
        let grid = &table.block.grid;
        let note = format!(
            "{}s {} to {} of {} continue the sieves below the finest of them",
            grid.row_word(),
            grid.row_name(first.min(last)),
            grid.row_name(first.max(last)),
            grid.column_label(table.block.layout.soils[0].column),
        );
        let new = lower.notes.iter().filter(|note| !upper.notes.contains(note)).cloned().collect::<Vec<_>>();
        upper.notes.extend(new);
        upper.notes.push(note);
        let at = if descends { upper.rows.len() } else { 0 };
        upper.rows.splice(at..at, lower.rows);
        upper.places.splice(at..at, lower.places);
    }
}
