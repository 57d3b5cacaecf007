//! Role of a column that its heading does not determine and its rows decide: classes, percents that rise
//! towards the finer sieves, and a second column of openings (the same in another unit, or the bounds of
//! classes).

use super::extent::{Extent, Reading};
use super::grid::{Grid, GridRow};
use super::heading::{Retained, Role, role, says_cumulative, says_finer, unit};
use super::layout::{Headings, Layout, head};
use super::size::{Entry, Form, Opening, Unit, near, opening};
use voidwalk_core::gradation::{FIELDS, TableError, shortened};

/// Determines the role of a column. Classes among its rows, with bounds in mm, become the sieves below
/// them.
pub(super) fn settle(reading: &mut Reading, entries: &mut Vec<Entry>) -> Result<Role, TableError> {
    match entries.iter().find(|entry| matches!(entry.opening, Opening::Class(..))) {
        Some(class) => {
            let role = of_classes(reading, class)?;
            as_sieves(reading, entries)?;
            Ok(role)
        }
        None if rises_in_known_sizes(reading, entries) => {
            let note = "cumulative percents that rise towards the finer sizes read as retained";
            reading.notes.push(note.into());
            Ok(Role::Retained(Retained { percent: true, cumulative: Some(true) }))
        }
        None => Ok(reading.column.role),
    }
}

/// A class contains the mass retained between two sieves.
fn of_classes(reading: &mut Reading, class: &Entry) -> Result<Role, TableError> {
    let column = reading.column;
    if class.form == Form::Plain && reading.layout.unit.is_none() {
        let allowed = "classes with their unit, in the heading as Fraction (mm) or in each cell";
        return Err(reading.refused_size(class, allowed));
    }
    if let Role::Retained(_) = column.role {
        return Ok(column.role);
    }
    if says_finer(&column.heading) || says_cumulative(&column.heading) {
        let allowed = "percents of each class, as their openings are the bounds of classes, or one opening \
                       in each row";
        return Err(reading.grid.refused(class.line, column.column, "heading", &column.heading, allowed));
    }
    let class = &class.text;
    reading.notes.push(format!("percents of classes such as {class} read as retained on the finer sieve"));
    Ok(Role::Retained(Retained { percent: true, cumulative: Some(false) }))
}

/// Replaces each class by its lower sieve, and adds above the coarsest class the sieve that all passes.
fn as_sieves(reading: &Reading, entries: &mut Vec<Entry>) -> Result<(), TableError> {
    let bounds = |entry: &Entry| match entry.opening {
        Opening::Class(upper, lower) => Some((upper, lower)),
        Opening::Below(upper) => Some((upper, 0.0)),
        _ => None,
    };
    if let Some(entry) = entries.iter().find(|entry| matches!(entry.opening, Opening::Mm(_))) {
        let allowed = "the bounds of a class in each row, as the other rows have";
        return Err(reading.refused_size(entry, allowed));
    }
    let mut order: Vec<usize> = (0..entries.len()).filter(|&at| bounds(&entries[at]).is_some()).collect();
    let lower = |at: usize| bounds(&entries[at]).map_or(0.0, |(_, lower)| lower);
    order.sort_by(|&a, &b| lower(b).total_cmp(&lower(a)));
    for pair in order.windows(2) {
        let (above, below) = (lower(pair[0]), bounds(&entries[pair[1]]).map_or(0.0, |(upper, _)| upper));
        if (above - below).abs() > 1e-9 * above {
            let allowed = "classes that follow each other, with one bound in common";
            return Err(reading.refused_size(&entries[pair[1]], allowed));
        }
    }
    let Some(&coarsest) = order.first() else { return Ok(()) };
    let top = bounds(&entries[coarsest]).map(|(upper, _)| upper).filter(|upper| upper.is_finite());
    for entry in entries.iter_mut() {
        if let Opening::Class(_, lower) = entry.opening {
            entry.opening = if lower > 0.0 { Opening::Mm(lower) } else { Opening::Pan };
        }
    }
    if let Some(upper) = top {
        let of_class = &entries[coarsest];
        let (opening, text) = (Opening::Mm(upper), of_class.text.clone());
        let all = Entry { opening, text, value: 0.0, ..*of_class };
        let descends = order.windows(2).all(|pair| pair[0] < pair[1]);
        entries.insert(if descends { coarsest } else { coarsest + 1 }, all);
    }
    Ok(())
}

/// True if percents headed only as cumulative are retained: their sizes, whose unit is given, fall while
/// they rise.
fn rises_in_known_sizes(&Reading { layout, column, .. }: &Reading, entries: &[Entry]) -> bool {
    let is_known =
        |entry: &Entry| layout.unit.map_or(entry.form != Form::Plain, |unit| unit != Unit::SieveNumber);
    if column.role != Role::Finer || !says_cumulative(&column.heading) || says_finer(&column.heading) {
        return false;
    }
    let mut sizes: Vec<(f64, f64)> = Vec::new();
    for entry in entries {
        match entry.opening {
            Opening::Mm(size) if is_known(entry) => sizes.push((size, entry.value)),
            Opening::Mm(_) => return false,
            _ => {}
        }
    }
    sizes.sort_by(|a, b| b.0.total_cmp(&a.0));
    let ends = (sizes.first().map(|row| row.1), sizes.last().map(|row| row.1));
    sizes.windows(2).all(|w| w[0].1 <= w[1].1) && ends.0 < ends.1
}

/// Minimum number of shared bounds: fewer may be a coincidence if the heading does not mention openings.
const LEAST_SHIFTED: usize = 2;

struct Pair {
    line: usize,
    mm: f64,
    second: f64,
}

/// Reads the bounds of classes as the openings of their lower sieves, and refuses a second column of
/// openings that is neither this nor the same sieves in another unit.
pub(super) fn settle_bounds(grid: &mut Grid, layout: &mut Layout) -> Result<(), TableError> {
    if grid.across.is_some() {
        return Ok(());
    }
    let lines: Vec<usize> = Extent::of(grid, layout)?.rows().map(|row| row.line).collect();
    let is_in_table = |row: &&GridRow| lines.binary_search(&row.line).is_ok();
    let rows: Vec<&GridRow> = grid.rows.iter().filter(is_in_table).collect();
    let width = rows.iter().map(|row| row.cells.len()).max().unwrap_or(0);
    let unit_of_size = unit(&heading(grid, layout, layout.size));
    let mut bounds = None;
    for column in (0..width).filter(|&c| c != layout.size) {
        let heading = heading(grid, layout, column);
        let is_soil = layout.soils.iter().any(|soil| soil.column == column);
        let says_size = !is_soil && (role(&heading) == Role::Size || layout.other_size == Some(column));
        let (Ok(first), Ok(second)) = (unit_of_size, unit(&heading)) else { continue };
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
            let (place, heading) = (grid.column_label(column), shortened(&heading));
            layout.notes.push(format!("not used: {place} (\"{heading}\")"));
            layout.other_size = layout.other_size.filter(|&other| other != column);
        }
    }
    match bounds {
        Some((second, is_lower)) => read_classes(grid, layout, &lines, second, is_lower),
        None => Ok(()),
    }
}

fn heading(grid: &Grid, layout: &Layout, column: usize) -> String {
    let rows = if layout.headed { &grid.rows[layout.at..layout.first] } else { &[] };
    head(rows, column)
}

/// Opening of a cell in mm, if the cell is a size.
fn in_mm(cell: &str, unit: Option<Unit>) -> Option<f64> {
    any_in_mm(cell, unit).filter(|mm| *mm > 0.0 && mm.is_finite())
}

/// True if two columns contain the same openings in every row, each in its own unit.
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

/// Number of neighbouring rows, and number of them that share a bound: the second bound of one row is
/// the first of the next, or the reverse.
fn shifted(pairs: &[Pair]) -> (usize, usize) {
    let is_shared = |a: f64, b: f64| (a - b).abs() <= 1e-3 * a;
    let count =
        |shared: &dyn Fn(&Pair, &Pair) -> bool| pairs.windows(2).filter(|w| shared(&w[0], &w[1])).count();
    let down = count(&|a, b| is_shared(a.second, b.mm));
    let up = count(&|a, b| is_shared(a.mm, b.second));
    (pairs.len().saturating_sub(1), down.max(up))
}

/// True if a column numbers its sieves starting at 1.
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

/// Turns classes into a table of sieves: the mass in a class is on its lower sieve, and all mass passes
/// the upper bound of the coarsest class.
fn read_classes(
    grid: &mut Grid,
    layout: &mut Layout,
    lines: &[usize],
    second: usize,
    is_lower: bool,
) -> Result<(), TableError> {
    let (upper, lower) = if is_lower { (layout.size, second) } else { (second, layout.size) };
    let [name, other] = [upper, lower].map(|c| grid.column_label(c));
    if let Some(soil) = layout.soils.iter().find(|soil| !matches!(soil.role, Role::Retained(_))) {
        let allowed = format!(
            "`retained` in the heading of what is in each class, as {name} and {other} are bounds of \
             classes; percents finer go with one column of openings"
        );
        return Err(grid.refused_heading(grid.rows[layout.at].line, &soil.heading, &allowed));
    }
    let units = [upper, lower].map(|c| unit(&heading(grid, layout, c)).ok().flatten());
    let unit = units[0].or(units[1]);
    if units[1].is_some_and(|lower| unit != Some(lower)) {
        let allowed = "the unit of the other bounds of the classes";
        return Err(grid.refused_heading(grid.rows[layout.at].line, &heading(grid, layout, lower), allowed));
    }
    let (Some(&first), Some(&last)) = (lines.first(), lines.last()) else { return Ok(()) };
    let is_in_table = |row: &GridRow| lines.binary_search(&row.line).is_ok();
    let upper_mm = |row: &GridRow| in_mm(row.cell(upper), unit).unwrap_or(0.0);
    let rows = grid.rows.iter().enumerate().filter(|(_, row)| is_in_table(row));
    let Some((index, top)) = rows.max_by(|a, b| upper_mm(a.1).total_cmp(&upper_mm(b.1))) else {
        return Ok(());
    };
    let (mut top, falls) = (top.clone(), top.line == first);
    let (finest, at) = if falls { (last, index) } else { (first, index + 1) };
    top.cells.resize(top.cells.len().max(lower + 1), String::new());
    top.cells.swap(upper, lower);
    top.cells[upper].clear();
    layout.soils.iter().for_each(|soil| top.cells[soil.column] = "0".into());
    for row in grid.rows.iter_mut().filter(|row| is_in_table(row)) {
        if row.cell(lower).is_empty() && row.line == finest && upper_mm(row) > 0.0 {
            row.cells[lower] = "Pan".into();
        }
        if opening(row.cell(lower)).is_some() {
            row.cells[upper].clear();
        }
    }
    grid.rows.insert(at, top);
    (layout.size, layout.other_size, layout.unit) = (lower, None, unit);
    layout.notes.push(format!("{name} and {other} read as the bounds of classes"));
    Ok(())
}

/// True if columns `a` and `b` name the same openings in every row, and some row has both.
pub(super) fn agree(grid: &Grid, headings: &Headings, a: usize, b: usize) -> bool {
    let unit_of = |c: usize| headings.heads.get(c).and_then(|head| unit(head).ok().flatten());
    let (unit_a, unit_b) = (unit_of(a), unit_of(b));
    let mut both = 0;
    for row in &grid.rows[headings.first..] {
        match (any_in_mm(row.cell(a), unit_a), any_in_mm(row.cell(b), unit_b)) {
            (Some(one), Some(other)) if near(one, other) => both += 1,
            (None, None) => {}
            _ => return false,
        }
    }
    both > 0
}

/// Opening of a cell in mm, even if its heading names no unit.
fn any_in_mm(cell: &str, unit: Option<Unit>) -> Option<f64> {
    match opening(cell)?.0 {
        Opening::Mm(mm) => Some(mm),
        Opening::Bare(value) => unit.unwrap_or(Unit::Mm).mm(value),
        _ => None,
    }
}
