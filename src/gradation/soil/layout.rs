//! Where in a grid the table is: which column holds the openings, which ones a soil each.

use super::grid::{Grid, GridRow};
use super::heading::{Role, role, unit, words};
use super::size::{Opening, Said, Unit, opening};
use crate::gradation::error::{TableError, shortened};
use crate::gradation::table::number;

/// Titles may take this many rows.
const ROWS_OF_TITLES: usize = 60;

/// Where the table is.
#[derive(Debug)]
pub(super) struct Layout {
    /// Column of the openings.
    pub(super) size: usize,
    /// Another column with openings or their names, for rows where the first is empty.
    pub(super) other_size: Option<usize>,
    /// Unit of the openings that have none of their own, where the heading says.
    pub(super) unit: Option<Unit>,
    /// The columns that hold a soil each.
    pub(super) soils: Vec<SoilColumn>,
    /// Index of the first row below the headings.
    pub(super) first: usize,
    /// There are headings.
    pub(super) headed: bool,
}

/// A column that holds a soil.
#[derive(Clone, Debug)]
pub(super) struct SoilColumn {
    pub(super) column: usize,
    pub(super) heading: String,
    pub(super) role: Role,
}

/// A percentage as laboratories write it: `97`, `97 %`, `97,0%`.
pub(super) fn percentage(cell: &str) -> Option<f64> {
    number(cell.strip_suffix('%').unwrap_or(cell).trim())
}

/// Whether a cell says that there is no value.
pub(super) fn is_blank(cell: &str) -> bool {
    ["", "-", "–", "—", "n/a", "n.a.", "na", "N/A", "n.d.", "nd"].contains(&cell)
}

fn is_numeric(cell: &str) -> bool {
    percentage(cell).is_some()
}

/// An opening in one cell and a number in another.
fn is_data(row: &GridRow) -> bool {
    let is_size = |cell: &str| matches!(opening(cell), Some((Opening::Mm(_) | Opening::Bare(_), _)));
    let sizes: Vec<usize> = row.filled().filter(|&c| is_size(row.cell(c))).collect();
    row.filled().any(|c| is_numeric(row.cell(c)) && sizes.iter().any(|&s| s != c))
}

/// A row of headings: one of them that of openings, none of them a number.
fn is_heading(row: &GridRow) -> bool {
    row.filled().count() >= 2
        && row.filled().all(|c| !is_numeric(row.cell(c)) && !is_short_opening(row.cell(c)))
        && row.filled().any(|c| role(row.cell(c)) == Role::Size)
}

/// `No. 4`: an opening, not the heading of a column.
fn is_short_opening(cell: &str) -> bool {
    matches!(opening(cell), Some((Opening::Mm(_), Said::UsNumber | Said::Inches)))
}

/// Whether a heading says that its column holds a soil.
fn says_soil(row: &GridRow) -> bool {
    row.filled().any(|c| !matches!(role(row.cell(c)), Role::Size | Role::Other))
}

/// Whether a row within the table repeats its headings, or is a line of text.
pub(super) fn is_text(row: &GridRow) -> bool {
    row.filled().all(|c| !is_numeric(row.cell(c)) && opening(row.cell(c)).is_none())
}

/// A table's headings again, as above the rows of a hydrometer.
pub(super) fn repeats_headings(row: &GridRow, layout: &Layout) -> bool {
    is_text(row)
        && role(row.cell(layout.size)) == Role::Size
        && unit(row.cell(layout.size)) == Ok(layout.unit)
        && layout.soils.iter().all(|soil| role(row.cell(soil.column)) == soil.role)
}

/// Finds the table.
pub(super) fn find(grid: &Grid) -> Result<Layout, TableError> {
    let rows = &grid.rows;
    if let Some(row) = rows.iter().find(|row| row.open) {
        return Err(fields(grid, row));
    }
    let data = rows.iter().take(ROWS_OF_TITLES).position(is_data);
    let above = &rows[..data.unwrap_or(rows.len().min(ROWS_OF_TITLES))];
    let headings = above.iter().rposition(|row| is_heading(row) && says_soil(row));
    let headings = headings.or_else(|| above.iter().rposition(is_heading));
    let Some(at) = headings else { return without_headings(grid, data) };
    // Units, or the names of soils, may stand in rows below the headings.
    let texts = rows[at + 1..].iter().take_while(|row| is_text(row));
    let below = match data {
        Some(data) => data - at - 1,
        None => 0,
    };
    let below = texts.take(below).count();
    let width = rows[at..=at + below].iter().map(|row| row.cells.len()).max().unwrap_or(0);
    let heads: Vec<String> = (0..width).map(|c| head(&rows[at..=at + below], c)).collect();
    with_headings(grid, at, at + 1 + below, heads)
}

/// What stands above a column.
fn head(rows: &[GridRow], column: usize) -> String {
    let cells: Vec<&str> = rows.iter().map(|row| row.cell(column)).filter(|cell| !cell.is_empty()).collect();
    cells.join(" ")
}

fn with_headings(grid: &Grid, at: usize, first: usize, heads: Vec<String>) -> Result<Layout, TableError> {
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
    let too_wide =
        |row: &&GridRow| grid.sheet.is_none() && row.filled().any(|c| c >= heads.len()) && !is_text(row);
    if let Some(row) = rows.iter().find(too_wide) {
        return Err(fields(grid, row));
    }
    let (heads, roles) = spread(grid, at, first, heads);
    let of_role = |wanted: Role| (0..heads.len()).filter(|&c| roles[c] == wanted).collect::<Vec<_>>();
    let sizes: Vec<usize> = {
        let mut sizes = of_role(Role::Size);
        let bare = |c: usize| rows.iter().filter(|row| number(row.cell(c)).is_some()).count();
        let rank = |c: usize| match unit(&heads[c]) {
            Ok(Some(Unit::Mm)) => 0,
            Ok(Some(Unit::Micrometre | Unit::Cm | Unit::Phi)) => 1,
            Ok(Some(Unit::Inch)) => 2,
            Ok(None) if bare(c) > 0 => 3,
            _ => 4,
        };
        sizes.sort_by_key(|&c| rank(c));
        sizes
    };
    let Some(&size) = sizes.first() else {
        return Err(TableError::NoRows { file: grid.place(), header: true });
    };
    let unit = unit(&heads[size]).map_err(|()| {
        grid.refused_heading(line, &heads[size], "openings in mm (opening_mm), or in cm, um, inches or phi")
    })?;
    let holds_numbers = |c: &usize| rows.iter().any(|row| is_numeric(row.cell(*c)));
    let finer: Vec<usize> = of_role(Role::Finer).into_iter().filter(holds_numbers).collect();
    let by = |percent: bool, cumulative: bool| -> Vec<usize> {
        let wanted = |c: &usize| match roles[*c] {
            Role::Retained(r) => r.percent == percent && (r.cumulative == Some(true)) == cumulative,
            _ => false,
        };
        (0..heads.len()).filter(wanted).filter(holds_numbers).collect()
    };
    let others = || -> Vec<usize> {
        let all_numbers = |c: &usize| {
            rows.iter().all(|row| is_blank(row.cell(*c)) || is_numeric(row.cell(*c)) || is_text(row))
        };
        of_role(Role::Other).into_iter().filter(holds_numbers).filter(all_numbers).collect()
    };
    let columns = [finer, by(true, true), by(true, false), by(false, true), by(false, false), others()]
        .into_iter()
        .find(|columns| !columns.is_empty());
    let Some(columns) = columns else {
        return match rows.iter().find(|row| row.filled().count() != 2) {
            Some(row) if grid.sheet.is_none() => Err(fields(grid, row)),
            _ if heads.len() == 2 => {
                Ok(Layout { size, other_size: None, unit, soils: vec![], first, headed: true }
                    .with_one(&heads))
            }
            _ => Err(TableError::NoRows { file: grid.place(), header: true }),
        };
    };
    let soils = columns
        .into_iter()
        .map(|column| SoilColumn { column, heading: heads[column].clone(), role: roles[column] })
        .collect::<Vec<_>>();
    for soil in &soils {
        let words = words(&soil.heading);
        if soil.role == Role::Finer && words.iter().any(|word| word == "number") {
            return Err(grid.refused_heading(line, &soil.heading, "percent finer by mass (percent_finer)"));
        }
    }
    let other_size = sizes.get(1).copied();
    Ok(Layout { size, other_size, unit, soils, first, headed: true })
}

/// Whether a table has the header of a constriction curve: percents by number of constrictions, not by mass.
fn is_constriction_curve(heads: &[String]) -> bool {
    let named = |name: &str| heads.iter().any(|head| words(head).join("_") == name);
    let is_diameter = named("diameter_mm") || named("diameter_over_d0f");
    heads.len() == 2 && named("percent_smaller") && is_diameter
}

/// A heading that is merged over several columns stands in the first of them; the rows below name each.
fn spread(grid: &Grid, at: usize, first: usize, mut heads: Vec<String>) -> (Vec<String>, Vec<Role>) {
    let mut roles: Vec<Role> = heads.iter().map(|name| role(name)).collect();
    let (top, below) = (&grid.rows[at], &grid.rows[at + 1..first]);
    for column in 1..heads.len() {
        let before = roles[column - 1];
        let is_merged = top.cell(column).is_empty()
            && roles[column] == Role::Other
            && matches!(before, Role::Finer | Role::Retained(_))
            && below.iter().any(|row| !row.cell(column).is_empty() && !row.cell(column - 1).is_empty());
        if is_merged {
            roles[column] = before;
            for named in [column - 1, column] {
                heads[named] = head(below, named);
            }
        }
    }
    (heads, roles)
}

impl Layout {
    /// With the column that is not that of the openings as its only soil.
    fn with_one(mut self, heads: &[String]) -> Layout {
        let column = usize::from(self.size == 0);
        self.soils.push(SoilColumn { column, heading: heads[column].clone(), role: Role::Finer });
        self
    }
}

/// No row names the openings: the first row of numbers begins the table, by place.
fn without_headings(grid: &Grid, data: Option<usize>) -> Result<Layout, TableError> {
    let begins =
        |row: &GridRow| row.filled().any(|c| is_numeric(row.cell(c)) || is_short_opening(row.cell(c)));
    let start = grid.rows.iter().position(begins);
    let start = match (start, data) {
        // Titles hold numbers too; but a title looks like a row that is broken only where it has two cells.
        (Some(start), Some(data))
            if grid.rows[start..data]
                .iter()
                .all(|row| row.filled().count() == 1 && !is_numeric(row.cell(0))) =>
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
        [a, b, c] if !is_numeric(first_row.cell(a)) && opening(first_row.cell(a)).is_some() => {
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
    let said = role(&head(value));
    let role = if matches!(said, Role::Retained(_)) { said } else { Role::Finer };
    let unit = unit(&head(size)).map_err(|()| {
        grid.refused_heading(
            grid.rows[start - 1].line,
            &head(size),
            "openings in mm (opening_mm), or in cm, um, inches or phi",
        )
    })?;
    let soils = vec![SoilColumn { column: value, heading: head(value), role }];
    Ok(Layout { size, other_size: other, unit, soils, first: start, headed: headings.is_some() })
}

/// A row with another number of cells than the table has columns.
pub(super) fn fields(grid: &Grid, row: &GridRow) -> TableError {
    let found = row.cells.len();
    let allowed = if found > 2 && grid.delimiter == ',' {
        "two columns (with decimal commas, a semicolon or a tab between them)"
    } else {
        "two columns, with a comma, a semicolon or a tab between them"
    };
    let separator = if grid.sheet.is_some() { " | ".to_owned() } else { grid.delimiter.to_string() };
    let value = shortened(row.text.as_deref().unwrap_or(&row.cells.join(&separator)));
    TableError::Fields { file: grid.place(), line: row.line, found, value, allowed }
}
