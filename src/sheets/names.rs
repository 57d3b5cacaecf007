//! Names of tables and columns: from the titles above them, and from a row of samples above their headings.

use std::collections::HashMap;

use super::blocks::Block;
use super::content::{is_data, is_value};
use super::grid::GridRow;
use super::heading::{Role, role, says_sample, words};
use super::layout::End;
use super::lines::names_listed;
use voidwalk_core::gradation::TableError;
use voidwalk_core::text::plain;

/// Refuses to count soils whose names say that they are no samples, such as the mean of others.
pub(super) fn ask_about(
    file: &str,
    names: &[&str],
    is_none: fn(&str) -> bool,
    what: &str,
) -> Result<(), TableError> {
    let (none, samples): (Vec<&str>, Vec<&str>) = names.iter().partition(|name| is_none(name));
    if none.is_empty() || names.len() < 2 {
        return Ok(());
    }
    let first = samples.first().or(none.first()).map_or(String::new(), |name| plain(name));
    let quoted = |names: Vec<&str>| names_listed(&names.into_iter().map(str::to_owned).collect::<Vec<_>>());
    let beside = if samples.is_empty() { String::new() } else { format!("{}, and ", quoted(samples)) };
    let soils = format!("{beside}{what}: {}", quoted(none));
    Err(TableError::SeveralSoils { file: file.to_owned(), soils, first })
}

/// Beginnings of lines above a table that name no soil.
const NO_NAME: [&str; 14] = [
    "date",
    "datum",
    "project",
    "projekt",
    "projet",
    "client",
    "depth",
    "tiefe",
    "tested",
    "laboratory",
    "lab",
    "job",
    "astm",
    "page",
];

/// The title that a row above a table gives it.
fn title_in(row: &GridRow) -> Option<&str> {
    let cells: Vec<&str> = row.filled().take(3).map(|c| row.cell(c)).collect();
    match cells[..] {
        [one] => {
            let of_one = words(one);
            let is_name = role(one) == Role::Other
                && !is_value(one)
                && of_one.first().is_some_and(|word| !NO_NAME.contains(&word.as_str()));
            is_name.then_some(one)
        }
        [label, value] if says_sample(label) => Some(value),
        _ => None,
    }
}

/// Titles of the tables, in their order; an empty text for a table without one.
pub(super) fn titles(blocks: &[Block]) -> Vec<String> {
    let mut beside: HashMap<usize, usize> = HashMap::new();
    let mut given: HashMap<(usize, usize), usize> = HashMap::new();
    let of_block = |block: &Block| -> Vec<(usize, String)> {
        let rows = block.grid.rows[..block.layout.at.min(block.grid.rows.len())].iter().rev();
        let rows = rows.take_while(|row| !is_data(row) || title_in(row).is_some());
        rows.filter_map(|row| Some((row.line, title_in(row)?.to_owned()))).collect()
    };
    let candidates: Vec<Vec<(usize, String)>> = blocks.iter().map(of_block).collect();
    for (block, candidates) in blocks.iter().zip(&candidates) {
        *beside.entry(block.line()).or_default() += 1;
        for (line, _) in candidates {
            *given.entry((block.line(), *line)).or_default() += 1;
        }
    }
    // With several tables side by side, a row that names only one is a title of the sheet.
    let title_of = |(block, candidates): (&Block, &Vec<(usize, String)>)| {
        let all = beside[&block.line()];
        let names = |least: usize| {
            candidates
                .iter()
                .find(|(line, _)| given[&(block.line(), *line)] >= least)
                .map(|(_, title)| title.clone())
        };
        names(all).or_else(|| if all > 1 { names(2) } else { None }).unwrap_or_default()
    };
    blocks.iter().zip(&candidates).map(title_of).collect()
}

/// Names the columns of a table by a row of samples above its headings.
pub(super) fn name_columns(block: &mut Block) {
    let layout = &block.layout;
    let columns: Vec<usize> = layout.soils.iter().map(|soil| soil.column).collect();
    if columns.first() == columns.last() {
        return;
    }
    let first = columns[0];
    let mut headings: Vec<&str> = layout.soils.iter().map(|soil| soil.heading.as_str()).collect();
    headings.sort_unstable();
    let same_headings = headings.windows(2).any(|pair| pair[0] == pair[1]);
    let distinct = |row: &&GridRow| {
        let mut cells: Vec<&str> = columns.iter().map(|&c| row.cell(c)).collect();
        cells.dedup();
        cells.sort_unstable();
        let ends = layout.soils.iter().any(|soil| soil.end.is_some());
        cells.iter().all(|cell| !cell.is_empty()) && (ends || cells.windows(2).all(|pair| pair[0] != pair[1]))
    };
    let above = || block.grid.rows[..layout.at.min(block.grid.rows.len())].iter().rev().filter(distinct);
    let merged = merged_names(block, &columns).filter(|_| same_headings);
    let labelled = above().find(|row| (0..first).any(|c| says_sample(row.cell(c))));
    let lettered = |row: &&GridRow| columns.iter().all(|&c| row.cell(c).contains(char::is_alphabetic));
    let row = labelled.or_else(|| above().find(lettered).filter(|_| same_headings));
    let names = row.map(|row| columns.iter().map(|&c| row.cell(c).to_owned()).collect::<Vec<_>>());
    let Some(names) = names.or(merged) else { return };
    for (soil, name) in block.layout.soils.iter_mut().zip(names) {
        soil.heading = match soil.end {
            Some(End::Least) => format!("{name} min"),
            Some(End::Most) => format!("{name} max"),
            None => name,
        };
    }
}

/// Names of soils in a row of the headings, or directly above them, each in the first of the columns over
/// which it is merged.
fn merged_names(block: &Block, columns: &[usize]) -> Option<Vec<String>> {
    let (rows, layout) = (&block.grid.rows, &block.layout);
    let near = layout.at.saturating_sub(1)..layout.first.min(rows.len());
    near.into_iter().find_map(|r| {
        let row = &rows[r];
        let after = |&c: &usize| c > layout.size && Some(c) != layout.other_size;
        let starts: Vec<usize> = row.filled().filter(after).collect();
        let is_name = |&c: &usize| role(row.cell(c)) == Role::Other && !is_value(row.cell(c));
        let all = starts.len() == columns.len() && starts.iter().all(is_name);
        let ends = starts.iter().skip(1).copied().chain([usize::MAX]);
        let is_it = all && starts.iter().zip(columns).zip(ends).all(|((s, c), end)| s <= c && *c < end);
        is_it.then(|| starts.iter().map(|&c| row.cell(c).to_owned()).collect())
    })
}
