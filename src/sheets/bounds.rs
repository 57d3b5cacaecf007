//! A second column of openings: the same sieves in another unit, or the other bounds of classes.

use std::collections::HashSet;

use super::agreement::near;
use super::extent::Extent;
use super::grid::{Grid, GridRow};
use super::heading::{Role, role, unit};
use super::layout::{Layout, head};
use super::size::{Opening, Unit, opening};
use voidwalk_core::gradation::FIELDS;
use voidwalk_core::gradation::{TableError, shortened};

/// Fewest shared bounds: fewer under a heading that does not mention openings may be by chance.
const LEAST_SHIFTED: usize = 2;

/// The openings of a row in two columns.
struct Pair {
    line: usize,
    mm: f64,
    second: f64,
}

/// Reads the bounds of classes as the openings of their lower sieves, and refuses a second column of openings
/// that is neither these nor the same sieves in another unit.
pub(super) fn settle(grid: &mut Grid, layout: &mut Layout) -> Result<(), TableError> {
    if grid.across.is_some() {
        return Ok(());
    }
    let extent = Extent::of(grid, layout)?;
    let rows: Vec<&GridRow> = extent.rows(grid, layout).collect();
    let width = rows.iter().map(|row| row.cells.len()).max().unwrap_or(0);
    let mut bounds = None;
    for column in (0..width).filter(|&c| c != layout.size) {
        let heading = heading(grid, layout, column);
        let is_soil = layout.soils.iter().any(|soil| soil.column == column);
        let says_size = !is_soil && (role(&heading) == Role::Size || layout.other_size == Some(column));
        let (Some(first), Some(second)) = (unit_of(&heading_of_size(grid, layout)), unit_of(&heading)) else {
            continue;
        };
        if says_size && is_same(&rows, layout.size, column, first, second) {
            layout.accounted.push(column);
            continue;
        }
        let pairs = pairs(&rows, layout.size, column, first, second);
        let (neighbours, shifted) = shifted(&pairs);
        let least = if says_size { 1 } else { LEAST_SHIFTED + usize::from(is_soil) };
        let is_monotone = pairs.len() > 1
            && (pairs.is_sorted_by(|a, b| a.second > b.second)
                || pairs.is_sorted_by(|a, b| a.second < b.second));
        let follow = shifted >= least && 2 * shifted > neighbours && (says_size || is_monotone);
        if follow && shifted == neighbours && says_size && bounds.is_none() {
            bounds = Some((column, pairs[0].second < pairs[0].mm));
        } else if follow || says_size && !is_count(&rows, column, second) && (is_monotone || pairs.len() == 1)
        {
            return Err(refused(grid, &rows, column, &pairs));
        } else if says_size && !pairs.is_empty() {
            layout.accounted.push(column);
            layout.notes.push(format!(
                "not used: {} (\"{}\")",
                grid.column_label(column),
                shortened(&heading)
            ));
            layout.other_size = layout.other_size.filter(|&other| other != column);
        }
    }
    match bounds {
        Some((second, is_lower)) => read_classes(grid, layout, &extent, second, is_lower),
        None => Ok(()),
    }
}

fn heading(grid: &Grid, layout: &Layout, column: usize) -> String {
    let rows = if layout.headed { &grid.rows[layout.at..layout.first] } else { &[] };
    head(rows, column)
}

fn heading_of_size(grid: &Grid, layout: &Layout) -> String {
    heading(grid, layout, layout.size)
}

/// The unit of a heading, `Some(None)` if it names no unit; `None` if the heading is not understood.
fn unit_of(heading: &str) -> Option<Option<Unit>> {
    unit(heading).ok()
}

fn in_mm(cell: &str, unit: Option<Unit>) -> Option<f64> {
    let mm = match opening(cell)?.0 {
        Opening::Mm(mm) => mm,
        Opening::Bare(value) => unit.unwrap_or(Unit::Mm).mm(value)?,
        _ => return None,
    };
    (mm > 0.0 && mm.is_finite()).then_some(mm)
}

/// True if two columns hold the same openings in every row, each in its own unit.
fn is_same(rows: &[&GridRow], size: usize, column: usize, first: Option<Unit>, second: Option<Unit>) -> bool {
    const UNITS: [Unit; 6] = [Unit::Mm, Unit::Inch, Unit::SieveNumber, Unit::Micrometre, Unit::Cm, Unit::Phi];
    let all = |cell: &str, unit: Option<Unit>| -> Vec<f64> {
        match unit {
            Some(unit) if unit != Unit::SieveNumber => in_mm(cell, Some(unit)).into_iter().collect(),
            _ => UNITS.iter().filter_map(|&unit| in_mm(cell, Some(unit))).collect(),
        }
    };
    rows.iter().all(|row| {
        let (one, other) = (all(row.cell(size), first), all(row.cell(column), second));
        one.is_empty() || other.is_empty() || one.iter().any(|&a| other.iter().any(|&b| near(a, b)))
    })
}

fn pairs(
    rows: &[&GridRow],
    size: usize,
    column: usize,
    first: Option<Unit>,
    second: Option<Unit>,
) -> Vec<Pair> {
    let pair = |row: &&GridRow| {
        let mm = in_mm(row.cell(size), first)?;
        Some(Pair { line: row.line, mm, second: in_mm(row.cell(column), second.or(first))? })
    };
    rows.iter().filter_map(pair).collect()
}

/// Number of neighbours, and number of them that share a bound: the second of one row is the first of the
/// next, or the reverse.
fn shifted(pairs: &[Pair]) -> (usize, usize) {
    let is_shared = |a: f64, b: f64| (a - b).abs() <= 1e-3 * a;
    let count =
        |shared: &dyn Fn(&Pair, &Pair) -> bool| pairs.windows(2).filter(|w| shared(&w[0], &w[1])).count();
    let down = count(&|a, b| is_shared(a.second, b.mm));
    let up = count(&|a, b| is_shared(a.mm, b.second));
    (pairs.len().saturating_sub(1), down.max(up))
}

/// True if a column numbers its sieves from 1 on.
fn is_count(rows: &[&GridRow], column: usize, unit: Option<Unit>) -> bool {
    let values: Vec<f64> = rows
        .iter()
        .filter_map(|row| match opening(row.cell(column))?.0 {
            Opening::Bare(value) => Some(value),
            _ => None,
        })
        .collect();
    matches!(unit, None | Some(Unit::SieveNumber))
        && values.first() == Some(&1.0)
        && values.windows(2).all(|w| w[1] == w[0] + 1.0)
}

fn refused(grid: &Grid, rows: &[&GridRow], column: usize, pairs: &[Pair]) -> TableError {
    let differs = pairs.iter().find(|pair| !near(pair.mm, pair.second)).or(pairs.first());
    let line = differs.map_or(0, |pair| pair.line);
    let cell = rows.iter().find(|row| row.line == line).map_or("", |row| row.cell(column));
    let allowed = "one column of openings; or two, as Upper (mm) and Lower (mm), that are the bounds of \
                   classes which follow each other, or the same sieves in two units";
    grid.refused(line, column, FIELDS[0], cell, allowed)
}

/// Turns classes into a table of sieves: the mass in a class stays on its lower sieve, and all mass passes
/// the upper bound of the coarsest class.
fn read_classes(
    grid: &mut Grid,
    layout: &mut Layout,
    extent: &Extent,
    second: usize,
    is_lower: bool,
) -> Result<(), TableError> {
    let (upper, lower) = if is_lower { (layout.size, second) } else { (second, layout.size) };
    let names = [upper, lower].map(|c| grid.column_label(c));
    if let Some(soil) = layout.soils.iter().find(|soil| !matches!(soil.role, Role::Retained(_))) {
        let allowed = format!(
            "`retained` in the heading of what is in each class, as {} and {} are bounds of classes; \
             percents finer go with one column of openings",
            names[0], names[1]
        );
        return Err(grid.refused_heading(grid.rows[layout.at].line, &soil.heading, &allowed));
    }
    let units = [upper, lower].map(|c| unit_of(&heading(grid, layout, c)).flatten());
    let unit = units[0].or(units[1]);
    if units[1].is_some_and(|lower| unit != Some(lower)) {
        let allowed = "the unit of the other bounds of the classes";
        return Err(grid.refused_heading(grid.rows[layout.at].line, &heading(grid, layout, lower), allowed));
    }
    let lines: Vec<usize> = extent.rows(grid, layout).map(|row| row.line).collect();
    let (Some(&first), Some(&last)) = (lines.first(), lines.last()) else { return Ok(()) };
    let in_table: HashSet<usize> = lines.into_iter().collect();
    let upper_mm = |row: &GridRow| in_mm(row.cell(upper), unit).unwrap_or(0.0);
    let rows = grid.rows.iter().enumerate().filter(|(_, row)| in_table.contains(&row.line));
    let Some((index, top)) = rows.max_by(|a, b| upper_mm(a.1).total_cmp(&upper_mm(b.1))) else {
        return Ok(());
    };
    let (mut top, falls) = (top.clone(), top.line == first);
    let (finest, at) = if falls { (last, index) } else { (first, index + 1) };
    top.cells.resize(top.cells.len().max(lower + 1), String::new());
    top.cells.swap(upper, lower);
    top.cells[upper].clear();
    layout.soils.iter().for_each(|soil| top.cells[soil.column] = "0".into());
    for row in grid.rows.iter_mut().filter(|row| in_table.contains(&row.line)) {
        if row.cell(lower).is_empty() && row.line == finest && upper_mm(row) > 0.0 {
            row.cells[lower] = "Pan".into();
        }
        if opening(row.cell(lower)).is_some() {
            row.cells[upper].clear();
        }
    }
    grid.rows.insert(at, top);
    (layout.size, layout.other_size, layout.unit) = (lower, None, unit);
    layout.notes.push(format!("{} and {} read as the bounds of classes", names[0], names[1]));
    Ok(())
}
