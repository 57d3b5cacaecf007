//! Position of the openings in a grid with one table, and the columns with one soil each.

use super::content::{
    Column, begins_with_words, columns, is_data, is_short_opening, is_text, is_value, percentage, whole_row,
};
use super::grid::{Grid, GridRow, joined};
use super::heading::{Role, is_weighing, role, says_sample, unit, words};
use super::size::{Unit, goes_one_way, opening, positive_size};
use voidwalk_core::gradation::{TableError, shortened};

pub(super) const ROWS_OF_TITLES: usize = 60;
/// Maximum number of unused columns named in a note.
pub(super) const MOST_NAMED: usize = 6;

/// Allowed headings of openings, in words.
const UNITS: &str = "openings in mm (opening_mm), or in cm, um, inches or phi";

/// Maximum number of cells of a table, filled or empty.
const MOST_PLACES: usize = 40_000_000;

#[derive(Debug, Default)]
pub(super) struct Layout {
    pub(super) size: usize,
    /// Another column of openings or their names, for rows without an opening in the first.
    pub(super) other_size: Option<usize>,
    /// Unit given by the heading for openings without one.
    pub(super) unit: Option<Unit>,
    pub(super) soils: Vec<SoilColumn>,
    /// Index of the row of headings.
    pub(super) at: usize,
    /// Index of the first row below the headings.
    pub(super) first: usize,
    pub(super) headed: bool,
    /// Other columns, whose numbers agree with those read or are named in a note.
    pub(super) accounted: Vec<usize>,
    pub(super) notes: Vec<String>,
}

/// A column with a soil, or with one end of a specification.
#[derive(Clone, Debug)]
pub(super) struct SoilColumn {
    pub(super) column: usize,
    pub(super) heading: String,
    pub(super) role: Role,
    /// End of ranges such as `95-100` that is read.
    pub(super) end: Option<End>,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum End {
    Least,
    Most,
}

/// True for a row of headings: one of them names openings, and no cell is a number.
pub(super) fn is_heading(row: &GridRow) -> bool {
    row.filled().take(2).count() == 2
        && row.filled().all(|c| !is_value(row.cell(c)) && !is_short_opening(row.cell(c)))
        && row.filled().any(|c| role(row.cell(c)) == Role::Size)
}

pub(super) fn says_soil(row: &GridRow) -> bool {
    row.filled().any(|c| !matches!(role(row.cell(c)), Role::Size | Role::Other))
}

/// True for a repetition of a table's headings, as before the rows of a hydrometer.
pub(super) fn repeats_headings(row: &GridRow, layout: &Layout) -> bool {
    is_text(row)
        && role(row.cell(layout.size)) == Role::Size
        && unit(row.cell(layout.size)) == Ok(layout.unit)
        && layout.soils.iter().all(|soil| role(row.cell(soil.column)) == soil.role)
}

pub(super) struct Headings {
    /// Index of the row of headings.
    pub(super) at: usize,
    /// Index of the first row below the headings and their additional cells.
    pub(super) first: usize,
    pub(super) heads: Vec<String>,
    pub(super) roles: Vec<Role>,
}

/// Finds the headings of the first table of a grid, and the index of the first row of its numbers.
pub(super) fn headings(grid: &Grid) -> (Option<Headings>, Option<usize>) {
    let rows = &grid.rows;
    let upper = &rows[..rows.len().min(ROWS_OF_TITLES)];
    let above = |data: Option<usize>| {
        let above = &upper[..data.unwrap_or(upper.len())];
        let headings = above.iter().rposition(|row| is_heading(row) && says_soil(row));
        headings.or_else(|| above.iter().rposition(is_heading))
    };
    // Numbers after words may be a depth above the table.
    let plain = upper.iter().position(|row| is_data(row) && !begins_with_words(row));
    let any = upper.iter().position(is_data);
    let (at, data) = match above(plain) {
        Some(at) => (Some(at), plain.or(any.filter(|&row| row > at))),
        None => (above(any), any),
    };
    let Some(at) = at else { return (None, any) };
    // Rows below the headings may contain units or the names of soils.
    let sizes: Vec<usize> = rows[at].filled().filter(|&c| role(rows[at].cell(c)) == Role::Size).collect();
    let belongs = |row: &&GridRow| {
        is_text(row)
            && sizes.iter().all(|&c| belongs_to_heading(row.cell(c)))
            && whole_row(row, true).is_none()
    };
    let below = data.map_or(0, |data| data - at - 1);
    let below = rows[at + 1..].iter().take_while(belongs).take(below).count();
    let samples =
        rows[..at].iter().rev().find(|row| row.filled().next().is_some_and(|c| says_sample(row.cell(c))));
    let wide = rows[at..=at + below].iter().chain(samples);
    let width = wide.map(|row| row.cells.len()).max().unwrap_or(0);
    let heads = (0..width).map(|c| head(&rows[at..=at + below], c)).collect();
    let (heads, roles) = spread(&rows[at..=at + below], samples, heads);
    (Some(Headings { at, first: at + 1 + below, heads, roles }), data)
}

/// True if a cell below the heading of openings belongs to it, such as a unit; `4..75` does not.
fn belongs_to_heading(cell: &str) -> bool {
    !cell.contains(|c: char| c.is_ascii_digit()) || cell.starts_with(char::is_alphabetic)
}

pub(super) fn find(grid: &Grid) -> Result<Layout, TableError> {
    match headings(grid) {
        (Some(headings), _) => with_headings(grid, headings),
        (None, data) => without_headings(grid, data),
    }
}

pub(super) fn head(rows: &[GridRow], column: usize) -> String {
    let cells: Vec<&str> = rows.iter().map(|row| row.cell(column)).filter(|cell| !cell.is_empty()).collect();
    cells.join(" ")
}

fn with_headings(grid: &Grid, headings: Headings) -> Result<Layout, TableError> {
    let Headings { at, first, heads, roles } = headings;
    let rows = &grid.rows[first..];
    let line = grid.rows[at].line;
    if is_constriction_curve(&heads) {
        let header = heads.join(&grid.delimiter.to_string());
        let allowed = "opening_mm and percent_finer; this is the header of a constriction curve, which goes \
                       to filter.curve (--set filter.curve=FILE)";
        return Err(grid.refused_heading(line, &header, allowed));
    }
    if rows.is_empty() {
        return Err(TableError::NoRows { file: grid.place(), header: true });
    }
    let too_wide = |row: &&GridRow| row.cells.len() > heads.len() && !is_text(row) && !begins_with_words(row);
    if let Some(row) = rows.iter().find(too_wide).filter(|_| grid.sheet.is_none()) {
        return Err(fields(grid, row));
    }
    let columns = columns(rows, heads.len());
    let sizes = sizes(&heads, &roles, &columns);
    let Some(&size) = sizes.first() else {
        return Err(TableError::NoRows { file: grid.place(), header: true });
    };
    let unit = unit(&heads[size]).map_err(|()| grid.refused_heading(line, &heads[size], UNITS))?;
    let other_size = sizes.get(1).copied();
    let mut layout = Layout { size, other_size, unit, at, first, headed: true, ..Layout::default() };
    let values = value_columns(&roles, &columns);
    if values.is_empty() {
        return match rows.iter().find(|row| row.filled().count() != 2) {
            Some(row) if grid.sheet.is_none() => Err(fields(grid, row)),
            _ if heads.len() == 2 => {
                let column = usize::from(size == 0);
                let heading = heads[column].clone();
                layout.soils.push(SoilColumn { column, heading, role: Role::Finer, end: None });
                Ok(layout)
            }
            _ => Err(TableError::NoRows { file: grid.place(), header: true }),
        };
    }
    if let Some(&c) = values.iter().find(|&&c| roles[c] == Role::Other && is_weighing(&heads[c])) {
        let allowed = "the mass retained on each sieve: subtract what the empty sieve weighs from what it \
                       weighs with the soil";
        return Err(grid.refused_heading(line, &heads[c], allowed));
    }
    // A specification counts as two soils.
    if rows.len().saturating_mul(2 * values.len()) > MOST_PLACES {
        let is = format!("a table of {} rows for {} soils, most of it empty", rows.len(), values.len());
        return Err(TableError::Format { file: grid.place(), is });
    }
    for pair in values.windows(2) {
        refuse_unnamed_openings(grid, &heads, &columns, first, [pair[0], pair[1]])?;
    }
    for &column in &values {
        let (heading, role) = (heads[column].clone(), roles[column]);
        if role == Role::Finer && words(&heading).iter().any(|word| word == "number") {
            return Err(grid.refused_heading(line, &heading, "percent finer by mass (percent_finer)"));
        }
        let soil = SoilColumn { column, heading, role, end: None };
        if columns[column].with_ranges && !matches!(role, Role::Retained(_)) {
            for (end, word) in [(End::Least, "min"), (End::Most, "max")] {
                let heading = format!("{} {word}", soil.heading).trim().to_owned();
                layout.soils.push(SoilColumn { heading, end: Some(end), ..soil.clone() });
            }
        } else {
            layout.soils.push(soil);
        }
    }
    let is_used = |c: &usize| values.binary_search(c).is_ok() || sizes.contains(c);
    layout.accounted =
        (0..columns.len()).filter(|&c| columns[c].with_values).filter(|c| !is_used(c)).collect();
    let name = |&c: &usize| match heads.get(c).map(String::as_str).unwrap_or_default() {
        "" => format!("{} (no heading)", grid.column_label(c)),
        head => format!("{} (\"{}\")", grid.column_label(c), shortened(head)),
    };
    if !layout.accounted.is_empty() {
        let names = joined(layout.accounted.iter().map(name).collect(), MOST_NAMED);
        layout.notes.push(format!("not used: {names}"));
    }
    Ok(layout)
}

/// Columns of openings or their names; the one to be read comes first.
fn sizes(heads: &[String], roles: &[Role], columns: &[Column]) -> Vec<usize> {
    let mut sizes: Vec<usize> = (0..heads.len()).filter(|&c| roles[c] == Role::Size).collect();
    let rank = |c: usize| match unit(&heads[c]) {
        Ok(Some(Unit::Mm)) => 0,
        Ok(Some(Unit::Micrometre | Unit::Cm | Unit::Phi)) => 1,
        Ok(Some(Unit::Inch)) => 2,
        Ok(None) if columns[c].with_numbers => 3,
        _ => 4,
    };
    sizes.sort_by_key(|&c| rank(c));
    sizes
}

/// Columns that are read as soils: percents finer, or else retained values, or else the other numbers.
fn value_columns(roles: &[Role], columns: &[Column]) -> Vec<usize> {
    let with_values = |wanted: &dyn Fn(usize) -> bool| -> Vec<usize> {
        (0..roles.len()).filter(|&c| columns[c].with_values && wanted(c)).collect()
    };
    let retained = |percent: bool, cumulative: bool| {
        with_values(&|c| match roles[c] {
            Role::Retained(r) => r.percent == percent && (r.cumulative == Some(true)) == cumulative,
            _ => false,
        })
    };
    [
        with_values(&|c| roles[c] == Role::Finer),
        retained(true, true),
        retained(true, false),
        retained(false, true),
        retained(false, false),
        with_values(&|c| roles[c] == Role::Other && columns[c].balance > 0),
    ]
    .into_iter()
    .find(|columns| !columns.is_empty())
    .unwrap_or_default()
}

/// Refuses numbers between two columns of percents that only rise or only fall: they may be the openings
/// of the second column.
fn refuse_unnamed_openings(
    grid: &Grid,
    heads: &[String],
    columns: &[Column],
    first: usize,
    [left, right]: [usize; 2],
) -> Result<(), TableError> {
    let Some(column) = (left + 1..right).rev().find(|&c| columns[c].with_values) else { return Ok(()) };
    let rows = grid.rows[first..].iter().filter(|row| is_value(row.cell(right)));
    let sizes: Vec<f64> = rows.filter_map(|row| positive_size(row.cell(column))).collect();
    if role(&heads[column]) != Role::Other || sizes.len() < 2 || !goes_one_way(&sizes) {
        return Ok(());
    }
    let allowed = "a heading that says what these numbers are: openings (such as Sieve (mm)) for the \
                   percents to their right, or percents (% passing) of a soil";
    let line = grid.rows[first.saturating_sub(1)].line;
    Err(grid.refused(line, column, "heading", &heads[column], allowed))
}

/// True if a table has the header of a constriction curve: percents by number of constrictions.
fn is_constriction_curve(heads: &[String]) -> bool {
    let named = |name: &str| heads.iter().any(|head| words(head).join("_") == name);
    let is_diameter = named("diameter_mm") || named("diameter_over_d0f");
    heads.len() == 2 && named("percent_smaller") && is_diameter
}

/// Spreads a heading that is merged over several columns, and so is in the first of them, if the rows
/// below or a row of samples above name each column.
fn spread(rows: &[GridRow], samples: Option<&GridRow>, mut heads: Vec<String>) -> (Vec<String>, Vec<Role>) {
    let mut roles: Vec<Role> = heads.iter().map(|name| role(name)).collect();
    let (top, below) = (&rows[0], &rows[1..]);
    for column in 1..heads.len() {
        let before = roles[column - 1];
        if !top.cell(column).is_empty() || roles[column] != Role::Other || !before.has_values() {
            continue;
        }
        let in_both = |row: &GridRow| !row.cell(column).is_empty() && !row.cell(column - 1).is_empty();
        if below.iter().any(in_both) {
            roles[column] = before;
            for named in [column - 1, column] {
                heads[named] = head(below, named);
            }
        } else if samples.is_some_and(in_both) && heads[column].is_empty() {
            roles[column] = before;
            heads[column] = heads[column - 1].clone();
        }
    }
    for column in 1..heads.len() {
        if is_sample_d(&heads, &roles, column) {
            roles[column] = Role::Other;
        }
    }
    (heads, roles)
}

/// True if a `D` is the name of a sample: after the openings, and beside a `C` or an `E`.
fn is_sample_d(heads: &[String], roles: &[Role], column: usize) -> bool {
    let is = |at: usize, name: &str| {
        heads.get(at).is_some_and(|head| head.trim().eq_ignore_ascii_case(name)) && roles[at] != Role::Size
    };
    let openings = |at: usize| roles[at] == Role::Size && !heads[at].trim().eq_ignore_ascii_case("d");
    heads[column].trim().eq_ignore_ascii_case("d")
        && (0..column).any(openings)
        && (is(column - 1, "c") || is(column + 1, "e"))
}

/// Layout of a table without a row that names the openings: it begins with the first row of numbers, and
/// the positions of the columns decide the rest.
fn without_headings(grid: &Grid, data: Option<usize>) -> Result<Layout, TableError> {
    let begins = |row: &GridRow| {
        row.filled().any(|c| is_value(row.cell(c)) || is_short_opening(row.cell(c)))
            || whole_row(row, false).is_some()
    };
    let start = grid.rows.iter().position(begins);
    let start = match (start, data) {
        // Titles contain numbers too; a title can be mistaken for a broken row only if it has two cells.
        (Some(start), Some(data))
            if grid.rows[start..data].iter().all(|row| {
                row.filled().count() == 1
                    && percentage(row.cell(0)).is_none()
                    && whole_row(row, false).is_none()
            }) =>
        {
            data
        }
        (Some(start), _) => start,
        (None, _) => {
            let header = grid.rows.last().is_some_and(|row| row.filled().count() == 2);
            return Err(match grid.rows.iter().find(|row| row.filled().count() != 2) {
                Some(row) if grid.sheet.is_none() => fields(grid, row),
                _ => TableError::NoRows { file: grid.place(), header },
            });
        }
    };
    let rows = &grid.rows[start..];
    let headings = grid.rows[..start].last().filter(|row| row.filled().count() >= 2);
    let heads: Vec<String> = headings.map(|row| row.cells.clone()).unwrap_or_default();
    let head = |c: usize| heads.get(c).cloned().unwrap_or_default();
    let first_row = data.map_or(&rows[0], |data| &grid.rows[data]);
    let columns: Vec<usize> = first_row.filled().collect();
    let (size, other, value) = match columns[..] {
        [a, b] => {
            let percent = role(&head(a)) == Role::Finer && role(&head(b)) != Role::Finer;
            if percent { (b, None, a) } else { (a, None, b) }
        }
        [a, b, c] if percentage(first_row.cell(a)).is_none() && opening(first_row.cell(a)).is_some() => {
            (b, Some(a), c)
        }
        _ => return Err(fields(grid, first_row)),
    };
    let most = columns.len();
    if let Some(row) = rows
        .iter()
        .find(|row| row.cells.len() > most.max(heads.len()) && grid.sheet.is_none() && !is_text(row))
    {
        return Err(fields(grid, row));
    }
    let stated = role(&head(value));
    let role = if matches!(stated, Role::Retained(_)) { stated } else { Role::Finer };
    let unit = unit(&head(size))
        .map_err(|()| grid.refused_heading(grid.rows[start - 1].line, &head(size), UNITS))?;
    let soils = vec![SoilColumn { column: value, heading: head(value), role, end: None }];
    let (headed, at) = (headings.is_some(), start.saturating_sub(1));
    Ok(Layout { size, other_size: other, unit, soils, at, first: start, headed, ..Layout::default() })
}

/// Makes the error for a row whose number of cells differs from the table's number of columns.
pub(super) fn fields(grid: &Grid, row: &GridRow) -> TableError {
    let count = row.cells.len();
    let allowed = if count > 2 && grid.delimiter == ',' {
        "two columns (with decimal commas, a semicolon or a tab between them)"
    } else {
        "two columns, with a comma, a semicolon or a tab between them"
    };
    let separator = if grid.sheet.is_some() { " | ".to_owned() } else { grid.delimiter.to_string() };
    let value = match &row.text {
        Some(line) => shortened(&line.text),
        None => shortened(&row.cells.join(&separator)),
    };
    TableError::Fields { file: grid.place(), line: row.line, found: count, value, allowed }
}
