//! Names of the tables of a file, from titles above them and from a row of samples above their headings.
//! Joins a separate table with the part of a curve below the finest sieve.

use super::blocks::Block;
use super::content::{is_data, is_value};
use super::grid::{GridRow, Place, names_listed};
use super::heading::{Role, role, says_of_fines, says_sample, says_sedimentation, words};
use super::languages::Words;
use super::layout::End;
use super::soil::Soil;
use std::collections::HashMap;
use std::path::Path;
use voidwalk_core::gradation::{FIELDS, Row, TableError};
use voidwalk_core::text::plain;

/// Refuses to count soils whose names say that they are not samples, such as the mean of others.
pub(super) fn refuse_unless_samples<'a>(
    file: &Path,
    names: impl Iterator<Item = &'a str>,
    is_none: fn(&str) -> bool,
    kind: &str,
) -> Result<(), TableError> {
    let (none, samples): (Vec<&str>, Vec<&str>) = names.partition(|name| is_none(name));
    if none.is_empty() || none.len() + samples.len() < 2 {
        return Ok(());
    }
    let first = plain(samples.first().unwrap_or(&none[0]));
    let beside = if samples.is_empty() { String::new() } else { format!("{}, and ", names_listed(&samples)) };
    let soils = format!("{beside}{kind}, which are not samples: {}", names_listed(&none));
    Err(TableError::SeveralSoils { file: file.display().to_string(), soils, first })
}

/// Beginnings of lines above a table that do not name a soil.
static NO_NAME: Words =
    Words::of("date|datum|project|projekt|projet|client|depth|tiefe|tested|laboratory|lab|job|astm|page");

fn title_in(row: &GridRow) -> Option<&str> {
    let cells: Vec<&str> = row.filled().take(3).map(|c| row.cell(c)).collect();
    match cells[..] {
        [one] => {
            let of_one = words(one);
            let is_name = role(one) == Role::Other
                && !is_value(one)
                && of_one.first().is_some_and(|word| !NO_NAME.has(word));
            is_name.then_some(one)
        }
        [label, value] if says_sample(label) => Some(value),
        _ => None,
    }
}

/// Titles of the tables, in order; an empty text for a table without one.
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
    // With several tables side by side, a row that names only one table is a title of the sheet.
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

/// Names the columns of a table from a row of samples above its headings.
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

/// Names of soils in a row of headings or directly above it, each in the first of the columns over which
/// it is merged.
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

/// Maximum coarsest size (mm) of a table that seems to come from a hydrometer.
const HYDROMETER_MM: f64 = 0.08;

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

fn ends(soil: &Soil) -> Option<[(f64, f64); 2]> {
    let by_size = |a: &&Row, b: &&Row| a.size.total_cmp(&b.size);
    let (top, low) = (soil.rows.iter().max_by(by_size)?, soil.rows.iter().min_by(by_size)?);
    Some([(top.size, top.percent), (low.size, low.percent)])
}

/// Joins each table that continues an earlier one to that table; the others are unchanged.
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

/// Finds the earlier table that this one may continue: the one above it, or else the last one to its left.
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

/// True if a table continues an earlier one; an error if it says or seems so but does not.
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
        let last = above.first().and_then(|soil| ends(soil));
        let rows = below.first().map_or(&[][..], |soil| &soil.rows[..]);
        let row = rows.iter().max_by(|a, b| a.size.total_cmp(&b.size));
        let (Some([_, last]), Some(row)) = (last, row) else { return Ok(false) };
        let allowed = format!(
            "sizes below {} mm and percents of the whole soil, at most {}, as this table continues the \
             sieves; a soil of its own goes to a file or sheet of its own",
            last.0, last.1
        );
        let (column, percent) = (layout.soils[0].column, row.percent.to_string());
        return Err(table.block.grid.refused(row.line, column, FIELDS[1], &percent, allowed));
    }
    Ok(goes_on)
}

fn join(sieves: &mut Read, table: Read) {
    for (upper, lower) in sieves.soils.iter_mut().zip(table.soils) {
        let (Ok(upper), Ok(mut lower)) = (upper.as_mut(), lower) else { continue };
        let falls = |soil: &Soil| {
            let ends = soil.rows.first().zip(soil.rows.last());
            ends.is_none_or(|(first, last)| first.size >= last.size)
        };
        let descends = falls(upper);
        if falls(&lower) != descends && lower.rows.len() > 1 {
            lower.rows.reverse();
            lower.places.reverse();
        }
        // The finest sieve may be in both.
        let row = if descends { lower.rows.first() } else { lower.rows.last() };
        if row.is_some_and(|row| upper.rows.iter().any(|u| u.size == row.size)) {
            let at = if descends { 0 } else { lower.rows.len() - 1 };
            lower.rows.remove(at);
            lower.places.remove(at);
        }
        let line = |place: Option<&[Place; 2]>| place.map_or(table.block.line(), |place| place[1].line);
        let (first, last) = (line(lower.places.first()), line(lower.places.last()));
        let grid = &table.block.grid;
        let (word, column) = (grid.row_word(), grid.column_label(table.block.layout.soils[0].column));
        let (from, to) = (grid.row_name(first.min(last)), grid.row_name(first.max(last)));
        let note = format!("{word}s {from} to {to} of {column} continue the sieves below the finest of them");
        let new: Vec<String> = lower.notes.into_iter().filter(|note| !upper.notes.contains(note)).collect();
        upper.notes.extend(new);
        upper.notes.push(note);
        let at = if descends { upper.rows.len() } else { 0 };
        upper.rows.splice(at..at, lower.rows);
        upper.places.splice(at..at, lower.places);
    }
}
