//! Tables that lie on their side: the openings in a row, and below it a row for each soil.

use super::content::{begins_with_words, is_blank, is_data, is_text, is_value, is_words, percentage};
use super::grid::{Grid, GridRow};
use super::heading::{Role, role, unit};
use super::layout::{Layout, ROWS_OF_TITLES, SoilColumn, is_heading, says_soil};
use super::size::{Opening, Unit, opening};
use super::torn;
use crate::gradation::error::{TableError, shortened};

/// Fewer openings in a row may be anything.
const LEAST_OPENINGS: usize = 3;
/// Most columns that a note names.
const MOST_NAMED: usize = 6;

/// The table of a grid that lies on its side, upright, and where it is read; nothing where there is none.
pub(super) fn find(grid: &Grid) -> Result<Option<(Grid, Layout)>, TableError> {
    let upper = &grid.rows[..grid.rows.len().min(ROWS_OF_TITLES)];
    if upper.iter().any(|row| is_heading(row) && says_soil(row)) {
        return Ok(None);
    }
    let found = upper.iter().enumerate().find_map(|(at, row)| {
        let openings = openings(row)?;
        let soils = soils(row, &grid.rows[at + 1..], &openings)?;
        Some((at, openings, soils))
    });
    let Some((at, openings, soils)) = found else { return Ok(None) };
    refuse_second(grid, at, &soils, &openings)?;
    refuse_lost(grid, at, &soils, &openings)?;
    Ok(Some(upright(grid, at, &openings, &soils)))
}

/// The columns of a row that holds openings behind words, rising or falling, and the pan behind them.
fn openings(row: &GridRow) -> Option<Vec<usize>> {
    let size = |c: usize| match opening(row.cell(c))?.0 {
        Opening::Mm(size) | Opening::Bare(size) if size > 0.0 && size.is_finite() => Some(size),
        _ => None,
    };
    let first = row.filled().find(|&c| size(c).is_some())?;
    let mut columns: Vec<usize> = (first..row.cells.len()).take_while(|&c| size(c).is_some()).collect();
    let sizes: Vec<f64> = columns.iter().filter_map(|&c| size(c)).collect();
    let one_way = sizes.windows(2).all(|w| w[0] > w[1]) || sizes.windows(2).all(|w| w[0] < w[1]);
    if first == 0 || columns.len() < LEAST_OPENINGS || !one_way {
        return None;
    }
    let is_rest = |c: &usize| matches!(opening(row.cell(*c)), Some((Opening::Pan | Opening::Below(_), _)));
    let end = first + columns.len();
    columns.extend((end..row.cells.len()).take_while(is_rest));
    Some(columns)
}

/// The rows below that hold a soil each: words, then percents.
fn soils(heading: &GridRow, below: &[GridRow], openings: &[usize]) -> Option<Vec<usize>> {
    // A number is a name only below a heading of names: below one of openings it is an opening.
    let of_names = |c: usize| !heading.cell(c).is_empty() && role(heading.cell(c)) == Role::Other;
    let is_name = |c: usize, cell: &str| match is_value(cell) || opening(cell).is_some() {
        true => of_names(c),
        false => !is_blank(cell),
    };
    let is_soil = |row: &GridRow| {
        let named = (0..openings[0]).any(|c| is_name(c, row.cell(c)));
        let values = openings.iter().filter(|&&c| is_value(row.cell(c))).count();
        let filled = openings.iter().filter(|&&c| !is_blank(row.cell(c))).count();
        named && values >= 2 && 2 * values > filled
    };
    let first = below.iter().position(|row| !is_text(row))?;
    let soils: Vec<usize> = (first..below.len()).take_while(|&r| is_soil(&below[r])).collect();
    (!soils.is_empty()).then_some(soils)
}

/// Rows below the soils that look like a table, too, are not passed over.
fn refuse_second(grid: &Grid, at: usize, soils: &[usize], columns: &[usize]) -> Result<(), TableError> {
    let after = at + 1 + soils.last().map_or(0, |last| last + 1);
    let heading = &grid.rows[at];
    let label = |row: &GridRow| row.filled().next().map(|c| row.cell(c).to_lowercase());
    for (index, row) in grid.rows.iter().enumerate().skip(at + 1) {
        let again = openings(row).is_some() && label(row) == label(heading);
        let beyond = index >= after && (is_data(row) && !begins_with_words(row) || openings(row).is_some());
        if again || beyond {
            let column = row.filled().next().unwrap_or(columns[0]);
            let allowed = "one row of openings, and the rows of soils directly below it: keep each table \
                           in a file or a sheet of its own";
            return Err(grid.refused(row.line, column, "row", row.cell(column), allowed));
        }
    }
    Ok(())
}

/// Refuses rows of soils that cannot be read, openings that would be passed over, and values that have none.
fn refuse_lost(grid: &Grid, at: usize, soils: &[usize], openings: &[usize]) -> Result<(), TableError> {
    let (heading, last) = (&grid.rows[at], openings[openings.len() - 1]);
    let refused =
        |row: &GridRow, c: usize, allowed: &str| Err(grid.refused(row.line, c, "row", row.cell(c), allowed));
    let is_opening = |row: &GridRow, c: usize| opening(row.cell(c)).is_some();
    if let Some(above) = grid.rows[..at].iter().find(|row| {
        row.filled().any(|c| !is_opening(row, c) && torn::holds_several(row.cell(c)))
            || openings.iter().filter(|&&c| is_opening(row, c)).count() >= LEAST_OPENINGS
    }) {
        let c = above.filled().next().unwrap_or(0);
        return refused(above, c, "openings in cells of their own, all rising or all falling");
    }
    let rows: Vec<&GridRow> = soils.iter().map(|&soil| &grid.rows[at + 1 + soil]).collect();
    for row in &rows {
        torn::refuse_short(grid, row, "", last)?;
        let is_size = |&c: &usize| role(row.cell(c)) == Role::Size && !is_value(row.cell(c));
        if let Some(c) = (0..openings[0]).find(is_size) {
            return refused(row, c, "one row of openings");
        }
        if let Some(c) =
            (last + 1..row.cells.len()).find(|&c| is_value(row.cell(c)) && heading.cell(c).is_empty())
        {
            return refused(row, c, "an opening above each value");
        }
    }
    if let Some(c) = (last + 1..heading.cells.len()).find(|&c| is_opening(heading, c)) {
        return refused(heading, c, "openings side by side");
    }
    let amid = |row: &&GridRow| is_text(row) && row.filled().any(|c| torn::holds_several(row.cell(c)));
    let is_soil = |row: &GridRow| openings.iter().filter(|&&c| is_value(row.cell(c))).count() > 1;
    let Some(end) = grid.rows.iter().rposition(is_soil) else { return Ok(()) };
    match grid.rows[at + 1..end.max(at + 1)].iter().find(amid) {
        Some(row) => {
            let column = row.filled().find(|&c| torn::holds_several(row.cell(c))).unwrap_or(0);
            Err(torn::refused(grid, row, column))
        }
        None => Ok(()),
    }
}

fn upright(grid: &Grid, at: usize, openings: &[usize], soils: &[usize]) -> (Grid, Layout) {
    let heading = &grid.rows[at];
    let rows_of_soils: Vec<&GridRow> = soils.iter().map(|&soil| &grid.rows[at + 1 + soil]).collect();
    let turned = |&c: &usize| GridRow {
        line: c + 1,
        cells: std::iter::once(heading)
            .chain(rows_of_soils.iter().copied())
            .map(|row| row.cell(c).to_owned())
            .collect(),
        text: None,
        open: false,
    };
    let words_above: Vec<&str> = grid.rows[..at]
        .iter()
        .rev()
        .chain([heading])
        .flat_map(|row| row.cells.iter())
        .map(String::as_str)
        .filter(|cell| cell.contains(char::is_alphabetic) && opening(cell).is_none())
        .collect();
    let said_unit = |text: &&str| match (role(text), unit(text)) {
        (Role::Other, _) => None,
        (_, Ok(Some(unit))) if unit != Unit::SieveNumber => Some(unit),
        _ => None,
    };
    let said_retained =
        words_above.iter().map(|text| role(text)).find(|role| matches!(role, Role::Retained(_)));
    let soil = |(index, row): (usize, &&GridRow)| {
        let labels = || (0..openings[0]).map(|c| row.cell(c)).filter(|cell| !cell.is_empty());
        let own = labels().map(role).find(|role| matches!(role, Role::Finer | Role::Retained(_)));
        let role = own.or(said_retained).unwrap_or(if own.is_some() { Role::Finer } else { Role::Other });
        SoilColumn { column: index + 1, heading: labels().collect::<Vec<_>>().join(" "), role, end: None }
    };
    let named = |c: usize| rows_of_soils.iter().any(|row| percentage(row.cell(c)).is_some());
    let last = openings[openings.len() - 1];
    let mut unused: Vec<String> = (last + 1..heading.cells.len().max(last + 1))
        .filter(|&c| named(c))
        .map(|c| format!("{} (\"{}\")", grid.column_said(c), shortened(heading.cell(c))))
        .collect();
    if unused.len() > MOST_NAMED {
        let more = format!("and {} more", unused.len() - MOST_NAMED);
        unused.splice(MOST_NAMED.., [more]);
    }
    let mut notes = vec!["openings read across: a row for each soil".to_owned()];
    if !unused.is_empty() {
        notes.push(format!("not used: {}", unused.join(", ")));
    }
    let after = at + 1 + soils.last().map_or(0, |last| last + 1);
    if let Some(row) = grid.rows.get(after) {
        let begins = row.filled().find(|&c| is_words(row.cell(c))).map_or("", |c| row.cell(c));
        notes.push(format!(
            "what stands from {} on (\"{}\") was left out",
            grid.said(row.line),
            shortened(begins)
        ));
    }
    let layout = Layout {
        size: 0,
        other_size: None,
        unit: words_above.iter().find_map(said_unit),
        soils: rows_of_soils.iter().enumerate().map(soil).collect(),
        at: 0,
        first: 0,
        headed: true,
        accounted: Vec::new(),
        notes,
    };
    let lines = std::iter::once(heading).chain(rows_of_soils.iter().copied()).map(|row| row.line).collect();
    let grid = Grid {
        file: grid.file.clone(),
        sheet: grid.sheet.clone(),
        delimiter: grid.delimiter,
        rows: openings.iter().map(turned).collect(),
        notes: grid.notes.clone(),
        left: 0,
        across: Some(lines),
        part: None,
    };
    (grid, layout)
}
