//! AGS4, the exchange format of ground investigations. Its group GRAT has one row per opening; its group
//! GRAG summarises a grading (percents of gravel, sand, silt and clay, Cu) and has no curve.

use super::grid::{Grid, GridRow, listed};
use super::heading::{Role, unit};
use super::layout::{Layout, SoilColumn};
use super::size::Unit;
use super::text::all_cells;
use std::collections::{BTreeSet, HashMap};
use voidwalk_core::gradation::{TableError, number, shortened};

/// Columns of size and percent of a group, and the unit of its sizes.
type Written = ([usize; 2], Option<Unit>);

/// Headings that distinguish specimens.
const KEYS: [&str; 7] = ["LOCA_ID", "SAMP_TOP", "SAMP_REF", "SAMP_TYPE", "SAMP_ID", "SPEC_REF", "SPEC_DPTH"];

/// True if a text is AGS4, in its own form or as saved by a spreadsheet; `group` may also be a column
/// heading in other files.
pub(super) fn is_ags(text: &str) -> bool {
    let kind =
        |line: &str| line.split(',').next().unwrap_or_default().trim_matches([' ', '"']).to_uppercase();
    let text = text.trim_start();
    text.lines().next().is_some_and(|line| line.contains(',') && kind(line) == "GROUP")
        && text.lines().any(|line| ["HEADING", "DATA"].contains(&kind(line).as_str()))
}

pub(super) fn is_ags_sheet(grid: &Grid) -> bool {
    let any = |kind: &str| grid.rows.iter().any(|row| row.cell(0) == kind);
    any("HEADING") && any("DATA")
}

/// Soils of the group GRAT: each with its name, its rows and their layout.
pub(super) fn soils(file: &str, text: &str) -> Result<Vec<(String, Grid, Layout)>, TableError> {
    let rows = text.lines().enumerate().map(|(index, content)| {
        let (cells, open) = all_cells(content, ',');
        (index + 1, cells, open)
    });
    soils_of_rows(file, None, rows)
}

/// Soils of a sheet whose name is its group, or that names the group in a row.
pub(super) fn soils_of_sheet(grid: &Grid) -> Result<Vec<(String, Grid, Layout)>, TableError> {
    let named = |name: &str| vec!["GROUP".to_owned(), name.trim().to_uppercase()];
    let group = grid.sheet.iter().map(|name| (0, named(name), false));
    let rows = grid.rows.iter().map(|row| {
        let cells = (0..grid.width()).map(|c| row.cell(c).to_owned());
        (row.line, cells.collect(), false)
    });
    soils_of_rows(&grid.file, grid.sheet.as_deref(), group.chain(rows))
}

fn soils_of_rows(
    file: &str,
    sheet: Option<&str>,
    rows: impl Iterator<Item = (usize, Vec<String>, bool)>,
) -> Result<Vec<(String, Grid, Layout)>, TableError> {
    let empty = || {
        let (file, sheet) = (file.to_owned(), sheet.map(str::to_owned));
        Grid { file, sheet, delimiter: ',', ..Grid::default() }
    };
    let refused = |line: usize, value: &str, allowed: &str| TableError::Header {
        file: empty().place(),
        line,
        value: value.into(),
        allowed: allowed.into(),
    };
    let (mut group, mut headings, mut of_grat, mut size_unit) = (String::new(), Vec::new(), 0, None);
    let mut soils: Vec<(String, Grid, BTreeSet<String>, Written)> = Vec::new();
    let mut places: HashMap<String, usize> = HashMap::new();
    let mut summary = None;
    for (line, cells, open) in rows {
        let Some(kind) = cells.first().filter(|_| cells.iter().any(|cell| !cell.is_empty())) else {
            continue;
        };
        if kind == "GROUP" {
            group = cells.get(1).cloned().unwrap_or_default();
            headings.clear();
            size_unit = None;
        }
        if group == "GRAG" && kind == "DATA" {
            summary = summary.or(Some(line));
        }
        if group != "GRAT" {
            match kind.as_str() {
                "HEADING" => headings.clone_from(&cells),
                // The row may belong to GRAT, with another group inserted within it.
                "DATA" if cells.len() != headings.len() && cells.len() == of_grat => {
                    let allowed = format!("a row of {group} with a cell for each of its headings");
                    return Err(refused(line, &shortened(&cells.join(",")), &allowed));
                }
                _ => {}
            }
            continue;
        }
        let place = |name: &str| headings.iter().position(|heading| heading == name);
        let cell = |name: &str| place(name).and_then(|at| cells.get(at)).map_or("", String::as_str);
        match kind.as_str() {
            "HEADING" => {
                headings.clone_from(&cells);
                of_grat = cells.len();
            }
            "UNIT" => {
                size_unit = match cell("GRAT_SIZE") {
                    "" => None,
                    given => match unit(given) {
                        Ok(Some(unit)) => Some(unit),
                        _ => return Err(refused(line, given, "a unit of GRAT_SIZE: mm")),
                    },
                };
                let percent = cell("GRAT_PERP");
                if !["", "%"].contains(&percent) {
                    return Err(refused(line, percent, "the unit of GRAT_PERP: %"));
                }
            }
            "DATA" if cells.len() != headings.len() || open => {
                let allowed = "a row of GRAT with a cell for each of its headings";
                return Err(refused(line, &shortened(&cells.join(",")), allowed));
            }
            "DATA" => {
                for name in ["GRAT_SIZE", "GRAT_PERP"] {
                    if place(name).is_none() {
                        return Err(refused(line, "GRAT", &format!("a group GRAT with the heading {name}")));
                    }
                }
                let keys: Vec<&str> =
                    KEYS.iter().map(|key| cell(key)).filter(|key| !key.is_empty()).collect();
                let name = keys.join(" ");
                let row = GridRow { line, cells: cells.clone(), text: None, open: false };
                let at = *places.entry(name.clone()).or_insert(soils.len());
                let columns = ["GRAT_SIZE", "GRAT_PERP"].map(|name| place(name).unwrap_or(0));
                if at == soils.len() {
                    soils.push((name, empty(), BTreeSet::new(), (columns, size_unit)));
                }
                let (_, grid, types, written) = &mut soils[at];
                if *written != (columns, size_unit) {
                    let allowed = "sizes and percents of this specimen in the unit and the columns of its \
                                   first rows";
                    return Err(refused(line, &shortened(&cells.join(",")), allowed));
                }
                grid.rows.push(row);
                types.extend(Some(cell("GRAT_TYPE").to_owned()).filter(|kind| !kind.is_empty()));
            }
            "GROUP" | "TYPE" => {}
            _ => return Err(refused(line, &shortened(kind), "GROUP, HEADING, UNIT, TYPE or DATA")),
        }
    }
    if let Some(line) = summary.filter(|_| soils.is_empty()) {
        let allowed = "a group GRAT with a row for each opening: GRAG only summarises a grading, and its \
                       percents of gravel, sand, silt and clay are not a sieve curve";
        return Err(refused(line, "GRAG", allowed));
    }
    if soils.is_empty() {
        let is = "AGS4 without a row in its group GRAT (gradings)".into();
        return Err(TableError::Format { file: empty().place(), is });
    }
    let soils = soils.into_iter().map(|(name, mut grid, types, (columns, unit))| {
        in_order(&mut grid, columns);
        if types.len() > 1 {
            let types = shortened(&types.into_iter().take(8).collect::<Vec<_>>().join(", "));
            grid.notes.push(format!("the tests of several kinds (GRAT_TYPE {types}) read as one curve"));
        }
        if summary.is_some() {
            let note = "the group GRAG, which summarises gradings, was ignored: sizes are from GRAT";
            grid.notes.push(note.into());
        }
        let soil = SoilColumn { column: columns[1], heading: name.clone(), role: Role::Finer, end: None };
        // The headings of AGS4 define the other columns.
        let accounted = (0..grid.width()).collect();
        let (size, soils) = (columns[0], vec![soil]);
        let layout = Layout { size, unit, soils, headed: true, accounted, ..Layout::default() };
        (name, grid, layout)
    });
    Ok(soils.collect())
}

/// Sorts the rows by size: sieves and hydrometer may follow each other in any order. Repeated rows are
/// dropped.
fn in_order(grid: &mut Grid, columns: [usize; 2]) {
    let size = |row: &GridRow| number(row.cell(columns[0])).unwrap_or(f64::INFINITY);
    grid.rows.sort_by(|a, b| size(b).total_cmp(&size(a)));
    let mut twice = Vec::new();
    grid.rows.dedup_by(|next, kept| {
        let same = columns.iter().all(|&c| next.cell(c) == kept.cell(c));
        twice.extend(same.then(|| next.line.to_string()));
        same
    });
    if !twice.is_empty() {
        let lines = listed("line", &twice, String::clone);
        grid.notes.push(format!("{lines} left out, the same as a row before"));
    }
}
