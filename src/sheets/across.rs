//! Tables on their side: the openings in a row, and below it a row for each soil.

use super::content::{begins_with_words, is_blank, is_data, is_text, is_value, is_words, percentage};
use super::grid::{Grid, GridRow};
use super::heading::{Role, role, unit};
use super::heads::{Head, head, is_broken, is_misspelt, is_of_names};
use super::labels::Labels;
use super::layout::{Layout, ROWS_OF_TITLES, SoilColumn, is_heading, says_soil};
use super::size::{Opening, Unit, opening};
use super::torn;
use voidwalk_core::gradation::percent_is_allowed;
use voidwalk_core::gradation::{TableError, shortened};

/// Fewest openings of a row: fewer bare numbers may be anything, and fewer named openings make no curve.
const LEAST_OPENINGS: usize = 3;
const LEAST_NAMED: usize = 2;
/// Most columns that a note names.
const MOST_NAMED: usize = 6;

/// The openings of a table that lies on its side.
struct Openings {
    columns: Vec<usize>,
    /// Openings as written, without the words around them.
    texts: Vec<String>,
    /// Role of the values if the words around the openings say retained.
    retained: Option<Role>,
    /// True if all openings are numbers without a unit or a word.
    bare: bool,
}

/// Finds the table of a grid that lies on its side, and returns it upright with its layout; `None` without
/// one.
pub(super) fn find(grid: &Grid) -> Result<Option<(Grid, Layout)>, TableError> {
    let upper = &grid.rows[..grid.rows.len().min(ROWS_OF_TITLES)];
    if upper.iter().any(|row| is_heading(row) && says_soil(row) && openings(row).is_none_or(|o| o.bare)) {
        return Ok(None);
    }
    let table = upper.iter().enumerate().find_map(|(at, row)| {
        let openings = openings(row)?;
        let soils = soils(row, &grid.rows[at + 1..], &openings.columns)?;
        Some((at, openings, soils))
    });
    let Some((at, openings, soils)) = table else { return Ok(None) };
    if openings.bare && !are_openings(grid, at, &openings.columns) {
        return match upper.iter().any(is_heading) {
            true => Ok(None),
            false => Err(refused_percents(grid, at, &openings.columns)),
        };
    }
    refuse_second(grid, at, &soils, &openings.columns)?;
    refuse_other_openings(grid, at, &soils, &openings.columns)?;
    refuse_lost(grid, at, &soils, &openings.columns)?;
    Ok(Some(upright(grid, at, &openings, &soils)))
}

/// The openings of a row behind words, rising or falling, and the pan behind them.
fn openings(row: &GridRow) -> Option<Openings> {
    let is_head = |c: usize| head(row.cell(c)).is_some();
    let first = row.filled().find(|&c| is_head(c)).filter(|&first| first > 0)?;
    let mut starts = row.filled().filter(|&c| c >= first && is_head(c) && !is_head(c - 1));
    starts.find_map(|start| openings_from(row, start).filter(|openings| start == first || !openings.bare))
}

/// Openings of a row that begin in this column.
fn openings_from(row: &GridRow, first: usize) -> Option<Openings> {
    let mut heads: Vec<Head> = Vec::new();
    for c in first..row.cells.len() {
        let is_rest = matches!(opening(row.cell(c)), Some((Opening::Below(_), _)));
        let Some(head) = head(row.cell(c)) else { break };
        // Behind openings without words `< 0.075` is the pan.
        if is_rest && heads.last().is_some_and(|last| last.role.is_none()) {
            break;
        }
        heads.push(head);
    }
    let read: Vec<(f64, bool)> = heads
        .iter()
        .filter_map(|head| match opening(&head.text)? {
            (Opening::Mm(size), _) => Some((size, false)),
            (Opening::Bare(size), _) => Some((size, head.role.is_none())),
            _ => None,
        })
        .collect();
    let bare = read.iter().all(|(_, bare)| *bare);
    let one_way = read.windows(2).all(|w| w[0].0 > w[1].0) || read.windows(2).all(|w| w[0].0 < w[1].0);
    let least = if bare { LEAST_OPENINGS } else { LEAST_NAMED };
    if heads.len() < least || !one_way && !mixes_units(&heads) {
        return None;
    }
    let retained = heads.iter().find_map(|head| head.role.filter(|role| *role != Role::Finer));
    let mut texts: Vec<String> = heads.into_iter().map(|head| head.text).collect();
    let is_rest = |c: &usize| matches!(opening(row.cell(*c)), Some((Opening::Pan | Opening::Below(_), _)));
    let end = first + texts.len();
    let rest: Vec<usize> = (end..row.cells.len()).take_while(is_rest).collect();
    texts.extend(rest.iter().map(|&c| row.cell(c).to_owned()));
    Some(Openings { columns: (first..end).chain(rest).collect(), texts, retained, bare })
}

/// True if bare numbers lie beside openings with a unit, so that their order says nothing yet.
fn mixes_units(heads: &[Head]) -> bool {
    let is_bare = |head: &Head| matches!(opening(&head.text), Some((Opening::Bare(_), _)));
    heads.iter().any(|head| head.role.is_some()) && heads.iter().any(is_bare)
}

/// True if a row of bare numbers holds openings, by the words at its left or by its numbers, and is not a row
/// of percents beside the name of a soil.
fn are_openings(grid: &Grid, at: usize, columns: &[usize]) -> bool {
    let row = &grid.rows[at];
    let labels: Vec<&str> = (0..columns[0]).map(|c| row.cell(c)).filter(|cell| !is_blank(cell)).collect();
    if labels.iter().any(|label| role(label) == Role::Size || is_of_names(label)) {
        return true;
    }
    if let Some(above) = text_above(grid, at, columns) {
        let says_size = |row: &GridRow| row.cells.iter().any(|cell| role(cell) == Role::Size);
        return labels.is_empty() && says_size(above);
    }
    let sizes = || columns.iter().filter_map(|&c| percentage(row.cell(c)));
    let (least, most) = (sizes().fold(f64::INFINITY, f64::min), sizes().fold(0.0, f64::max));
    labels.is_empty() || most > 100.0 || most > 1.0 && least < LEAST_PERCENT
}

/// Least value in a row of percents; openings (mm) may be smaller.
const LEAST_PERCENT: f64 = 0.1;

/// The row of words above numbers, such as percents under headings that are not understood.
fn text_above<'a>(grid: &'a Grid, at: usize, columns: &[usize]) -> Option<&'a GridRow> {
    let is_words = |row: &&GridRow| {
        let words = columns.iter().filter(|&&c| !row.cell(c).is_empty() && !is_value(row.cell(c))).count();
        2 * words >= columns.len()
    };
    grid.rows[..at].iter().rev().find(is_words)
}

/// Error for a row of percents beside the name of a soil whose openings nothing names.
fn refused_percents(grid: &Grid, at: usize, columns: &[usize]) -> TableError {
    let row = &grid.rows[at];
    let name = (0..columns[0]).map(|c| row.cell(c)).find(|cell| !is_blank(cell)).unwrap_or_default();
    if let Some(above) = text_above(grid, at, columns) {
        let is_unread = |c: &usize| !above.cell(*c).is_empty() && head(above.cell(*c)).is_none();
        let column = columns.iter().copied().find(is_unread).unwrap_or(columns[0]);
        let allowed = format!(
            "an opening above the percents of \"{}\", such as P#200, Passing 19 mm or 0.075 mm",
            shortened(name)
        );
        return grid.refused(above.line, column, "heading", above.cell(column), allowed);
    }
    let allowed = "Sample or Sieve (mm) beside these numbers if they are openings, or a row of openings \
                   above them if they are percents";
    grid.refused(row.line, 0, "heading", name, allowed)
}

/// True if a column is among these adjacent columns.
fn is_between(columns: &[usize], c: usize) -> bool {
    columns.first().is_some_and(|&first| first <= c) && columns.last().is_some_and(|&last| c <= last)
}

/// Refuses headings beside the openings that name more openings, or seem to.
fn refuse_other_openings(
    grid: &Grid,
    at: usize,
    soils: &[usize],
    columns: &[usize],
) -> Result<(), TableError> {
    let row = &grid.rows[at];
    let is_beside =
        |c: usize| columns.first() == Some(&(c + 1)) || columns.last() == c.checked_sub(1).as_ref();
    let is_percents = |c: usize| {
        let cells = soils.iter().map(|&soil| grid.rows[at + 1 + soil].cell(c)).filter(|cell| !is_blank(cell));
        let mut percents = cells.map(|cell| percentage(cell).is_some_and(percent_is_allowed)).peekable();
        percents.peek().is_some() && percents.all(|is_percent| is_percent)
    };
    let is_other = |c: &usize| {
        let cell = row.cell(*c);
        let is_named = is_broken(cell) || head(cell).is_some_and(|head| head.role.is_some());
        !is_between(columns, *c) && (is_named || is_beside(*c) && is_misspelt(cell) && is_percents(*c))
    };
    match row.filled().find(is_other) {
        Some(c) => {
            let allowed = "an opening, such as P#200, Passing 19 mm or 0.075 mm, beside the other openings";
            Err(grid.refused(row.line, c, "heading", row.cell(c), allowed))
        }
        None => Ok(()),
    }
}

/// Rows below that hold a soil each: words, then percents.
fn soils(heading: &GridRow, below: &[GridRow], openings: &[usize]) -> Option<Vec<usize>> {
    // A number is a name only below a heading of names; below a heading of openings it is an opening.
    let of_names = |c: usize| !heading.cell(c).is_empty() && role(heading.cell(c)) == Role::Other;
    let is_sieve = |cell: &str| opening(cell).is_some_and(|(o, _)| !matches!(o, Opening::Class(..)));
    let is_name = |c: usize, cell: &str| match is_value(cell) || is_sieve(cell) {
        true => of_names(c),
        false => !is_blank(cell),
    };
    let is_size = |c: &usize| role(heading.cell(*c)) == Role::Size && !openings.contains(c);
    let sizes: Vec<usize> = heading.filled().filter(is_size).collect();
    let is_soil = |row: &GridRow| {
        // Each row has its own size, so the headings are names of soils such as p4.
        if sizes.iter().any(|&c| is_value(row.cell(c)) || is_sieve(row.cell(c))) {
            return false;
        }
        let named = (0..openings[0]).any(|c| is_name(c, row.cell(c)));
        let values = openings.iter().filter(|&&c| is_value(row.cell(c))).count();
        let filled = openings.iter().filter(|&&c| !is_blank(row.cell(c))).count();
        named && values >= 2 && 2 * values > filled
    };
    let first = below.iter().position(|row| !is_text(row))?;
    let soils: Vec<usize> = (first..below.len()).take_while(|&r| is_soil(&below[r])).collect();
    (!soils.is_empty()).then_some(soils)
}

/// Refuses rows below the soils that also look like a table, instead of passing over them.
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

/// Refuses rows of soils that cannot be read, openings that would be passed over, and values without an
/// opening.
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
    let is_soil = |row: &GridRow| openings.iter().filter(|&&c| is_value(row.cell(c))).count() > 1;
    let Some(end) = grid.rows.iter().rposition(is_soil) else { return Ok(()) };
    for (index, row) in grid.rows.iter().enumerate().skip(at + 1).filter(|(_, row)| is_text(row)) {
        let is_near = index < end || row.line == grid.rows[end].line + 1;
        let several = || row.filled().find(|&c| torn::holds_several(row.cell(c)));
        let column = several().or_else(|| torn::row_below(row)).filter(|_| is_near);
        if let Some(column) = column {
            return Err(torn::refused(grid, row, column));
        }
    }
    Ok(())
}

fn upright(grid: &Grid, at: usize, openings: &Openings, soils: &[usize]) -> (Grid, Layout) {
    let Openings { columns, texts, retained, .. } = openings;
    let heading = &grid.rows[at];
    let rows_of_soils: Vec<&GridRow> = soils.iter().map(|&soil| &grid.rows[at + 1 + soil]).collect();
    let turned = |(&c, text): (&usize, &String)| GridRow {
        line: c + 1,
        cells: std::iter::once(text.clone())
            .chain(rows_of_soils.iter().map(|row| row.cell(c).to_owned()))
            .collect(),
        text: None,
        open: false,
    };
    let beside = (0..heading.cells.len()).filter(|&c| !is_between(columns, c)).map(|c| heading.cell(c));
    let words_above: Vec<&str> = grid.rows[..at]
        .iter()
        .rev()
        .flat_map(|row| row.cells.iter())
        .map(String::as_str)
        .chain(beside)
        .filter(|cell| cell.contains(char::is_alphabetic) && opening(cell).is_none())
        .collect();
    let stated_unit = |text: &&str| match (role(text), unit(text)) {
        (Role::Other, _) => None,
        (_, Ok(Some(unit))) if unit != Unit::SieveNumber => Some(unit),
        _ => None,
    };
    let stated_retained =
        words_above.iter().map(|text| role(text)).find(|role| matches!(role, Role::Retained(_)));
    let labels = Labels::new(&grid.rows[..=at], &rows_of_soils, columns[0]);
    let soil = |(index, row): (usize, &&GridRow)| {
        let words = (0..columns[0]).map(|c| row.cell(c)).filter(|cell| !cell.is_empty());
        let stated = words.map(role).find(|role| matches!(role, Role::Finer | Role::Retained(_)));
        let role = stated.or(*retained).or(stated_retained).unwrap_or(Role::Other);
        SoilColumn { column: index + 1, heading: labels.names[index].clone(), role, end: None }
    };
    let named = |c: usize| rows_of_soils.iter().any(|row| percentage(row.cell(c)).is_some());
    let last = columns[columns.len() - 1];
    let mut unused: Vec<String> = labels
        .unused
        .iter()
        .copied()
        .chain(last + 1..heading.cells.len().max(last + 1))
        .filter(|&c| named(c))
        .map(|c| format!("{} (\"{}\")", grid.column_label(c), shortened(heading.cell(c))))
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
            grid.row_label(row.line),
            shortened(begins)
        ));
    }
    let layout = Layout {
        size: 0,
        other_size: None,
        unit: words_above.iter().find_map(stated_unit),
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
        rows: columns.iter().zip(texts).map(turned).collect(),
        commented: grid.commented.clone(),
        notes: grid.notes.clone(),
        left: 0,
        across: Some(lines),
        part: None,
    };
    (grid, layout)
}
