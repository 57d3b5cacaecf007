//! Names of the soils of a table that lies on its side, by the columns to the left of its openings.

use std::collections::HashMap;

use super::content::{is_blank, is_value};
use super::grid::GridRow;
use super::heading::{says_sample, words};

/// Most further columns used to tell soils of one name apart.
const MOST_MORE: usize = 8;

/// Columns to the left of the openings, read as names.
pub(super) struct Labels {
    /// A name for each soil.
    pub(super) names: Vec<String>,
    /// Columns that appear in no name.
    pub(super) unused: Vec<usize>,
}

impl Labels {
    /// Reads the names of `rows` below `headings`, whose openings begin in column `end`. A name takes the
    /// first column and those whose heading says so; a depth and the others only if names would otherwise be
    /// equal.
    pub(super) fn new(headings: &[GridRow], rows: &[&GridRow], end: usize) -> Labels {
        let head = |c: usize| {
            let near = headings.iter().rev().take(3).map(|row| row.cell(c));
            near.into_iter().find(|cell| !cell.is_empty()).unwrap_or_default()
        };
        let any = |c: usize, is: &dyn Fn(&str) -> bool| rows.iter().any(|row| is(row.cell(c)));
        let filled: Vec<usize> = (0..end).filter(|&c| any(c, &|cell| !is_blank(cell))).collect();
        let is_first = |c: usize| Some(&c) == filled.first();
        let is_text = |c: usize| head(c).is_empty() && !any(c, &is_value);
        let rank = |c: usize| match () {
            () if is_first(c) || says_sample(head(c)) || is_text(c) => 0,
            () if words(head(c)).iter().any(|word| says_depth(word)) => 1,
            () => 2,
        };
        let mut order = filled.clone();
        order.sort_by_key(|&c| rank(c));
        let (always, more) = order.split_at(order.partition_point(|&c| rank(c) == 0));
        let joined = |row: &GridRow, columns: &[usize]| {
            let cells = columns.iter().map(|&c| row.cell(c)).filter(|cell| !is_blank(cell));
            cells.collect::<Vec<_>>().join(" ")
        };
        let mut names: Vec<String> = rows.iter().map(|row| joined(row, always)).collect();
        let mut unused = Vec::new();
        let (more, others) = more.split_at(more.len().min(MOST_MORE));
        for &c in more {
            let mut times: HashMap<String, usize> = HashMap::new();
            names.iter().for_each(|name| *times.entry(name.clone()).or_default() += 1);
            let mut used = false;
            for (name, row) in names.iter_mut().zip(rows) {
                if (times[name] > 1 || name.is_empty()) && !is_blank(row.cell(c)) {
                    *name = format!("{name} {}", row.cell(c)).trim().to_owned();
                    used = true;
                }
            }
            unused.extend((!used).then_some(c));
        }
        unused.extend(others);
        Labels { names, unused }
    }
}

/// True if a word of a heading says that depths lie below it.
pub(super) fn says_depth(word: &str) -> bool {
    ["depth", "tiefe", "profondeur", "profundidad", "prof", "from", "top", "elevation"].contains(&word)
}
