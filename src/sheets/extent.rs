//! Rows of the table below the headings, without its remarks, repeated headings and notes of the laboratory
//! below it.

use super::content::{is_blank, is_text, is_value, is_words, percentage};
use super::grid::{Grid, GridRow};
use super::heading::Role;
use super::layout::{Layout, repeats_headings};
use super::lines::listed;
use super::size::{Opening, opening};
use super::torn;
use voidwalk_core::gradation::{TableError, shortened};

/// A row below a table: `Dry mass (g) | 500`.
pub(super) struct Below {
    pub(super) line: usize,
    /// Column of the words.
    pub(super) column: usize,
    pub(super) words: String,
    /// The first number behind the words, and its column.
    pub(super) value: Option<(usize, f64)>,
}

/// The rows of a table.
pub(super) struct Extent {
    /// Indices of the rows, counted from the first below the headings.
    table: Vec<usize>,
    /// Rows below the table, which are left out.
    pub(super) below: Vec<Below>,
    /// Notes on the rows that were left out.
    pub(super) notes: Vec<String>,
    /// The first column that holds a soil.
    first_value: usize,
}

impl Extent {
    /// Determines the rows of the table in a grid.
    ///
    /// # Errors
    /// A row, amid the others or as the last, that cannot be read as one.
    pub(super) fn of(grid: &Grid, layout: &Layout) -> Result<Extent, TableError> {
        let rows = &grid.rows[layout.first..];
        let first_value = layout.soils.iter().map(|soil| soil.column).min().unwrap_or(0);
        let mut extent = Extent { table: Vec::new(), below: Vec::new(), notes: Vec::new(), first_value };
        let end = extent.end(rows, layout);
        let last =
            rows[..end].iter().rposition(|row| row.filled().any(|c| is_value(row.cell(c)))).unwrap_or(0);
        let mut remarks = Vec::new();
        for (index, row) in rows[..end].iter().enumerate() {
            let is_next = || index > last && row.line == rows[last].line + 1;
            let below = || is_next().then(|| torn::row_below(row)).flatten();
            if let Some(column) = torn::whole_row(row, index < last).or_else(below) {
                return Err(torn::refused(grid, row, column));
            }
            match () {
                () if repeats_headings(row, layout) => {}
                () if is_text(row) && (row.filled().count() == 1 || index > last) => remarks.push(row.line),
                () => extent.table.push(index),
            }
        }
        for row in &rows[end..] {
            let Some(column) = extent.column_of_words(layout, row) else { continue };
            let value =
                row.filled().filter(|&c| c > column).find_map(|c| Some((c, percentage(row.cell(c))?)));
            let words = shortened(row.cell(column));
            extent.below.push(Below { line: row.line, column, words, value });
        }
        if !remarks.is_empty() {
            let taken = if remarks.len() == 1 { "a remark" } else { "remarks" };
            extent.notes.push(format!(
                "{} taken as {taken} and left out",
                listed(grid.row_word(), &remarks, |&line| grid.row_name(line))
            ));
        }
        extent.notes.extend(extent.note_below(grid, &rows[end..]));
        Ok(extent)
    }

    /// Rows of the table.
    pub(super) fn rows<'a>(&'a self, grid: &'a Grid, layout: &Layout) -> impl Iterator<Item = &'a GridRow> {
        let first = layout.first;
        self.table.iter().map(move |index| &grid.rows[first + index])
    }

    /// The column that holds the opening of a row.
    pub(super) fn column_of_size(&self, layout: &Layout, row: &GridRow) -> usize {
        let other = layout.other_size.filter(|&c| !row.cell(c).is_empty());
        match is_blank(row.cell(layout.size)) {
            // With words in another column, the row is refused at that column.
            true => other.or(self.column_of_words(layout, row)).unwrap_or(layout.size),
            false => layout.size,
        }
    }

    /// Index at which the table ends: the first row of words below its numbers, unless the numbers below it
    /// continue those above, so that a row with a percent is refused.
    fn end(&self, rows: &[GridRow], layout: &Layout) -> usize {
        let is_data = |row: &GridRow| {
            let column = self.column_of_size(layout, row);
            opening(row.cell(column)).is_some() && row.filled().any(|c| c != column && is_value(row.cell(c)))
        };
        let Some(begun) = rows.iter().position(is_data) else { return rows.len() };
        let Some(last) = rows.iter().rposition(is_data) else { return rows.len() };
        let ends = |&at: &usize| {
            let row = &rows[at];
            let has_words = self.column_of_words(layout, row).is_some();
            has_words
                && match at > last {
                    true => !is_text(row),
                    false => {
                        !repeats_headings(row, layout)
                            && !self.continues(&rows[..at], &rows[at + 1..], layout)
                    }
                }
        };
        (begun..rows.len()).find(ends).unwrap_or(rows.len())
    }

    /// True if any of the rows `below` may continue those `above`: a size beyond the last of them, and a
    /// percent finer that goes in the same direction.
    fn continues(&self, above: &[GridRow], below: &[GridRow], layout: &Layout) -> bool {
        let Some(soil) = layout.soils.first() else { return true };
        let numbers = |row: &GridRow| match opening(row.cell(self.column_of_size(layout, row)))?.0 {
            Opening::Mm(size) | Opening::Bare(size) | Opening::Below(size) | Opening::Class(_, size) => {
                Some((size, percentage(row.cell(soil.column))))
            }
            Opening::Pan | Opening::Total => None,
        };
        let mut numbers_above = above.iter().filter_map(numbers);
        let Some(first) = numbers_above.next() else { return true };
        let last = numbers_above.next_back().unwrap_or(first);
        if first.0 == last.0 {
            return true;
        }
        let falls = first.0 > last.0;
        let is_beyond = |next: f64, last: f64| if falls { next <= last } else { next >= last };
        let is_finer = !matches!(soil.role, Role::Retained(_));
        below.iter().filter_map(numbers).any(|(size, value)| {
            let value = value.zip(last.1).filter(|_| is_finer);
            is_beyond(size, last.0) && value.is_none_or(|(next, last)| is_beyond(next, last))
        })
    }

    /// The column of the words with which a row begins in place of an opening.
    fn column_of_words(&self, layout: &Layout, row: &GridRow) -> Option<usize> {
        let sizes = [Some(layout.size), layout.other_size];
        let of_size = |c: usize| sizes.contains(&Some(c));
        let is_free = |c: usize| is_blank(row.cell(c)) || is_words(row.cell(c));
        if !sizes.into_iter().flatten().all(is_free) {
            return None;
        }
        let before = self.first_value.max(layout.size + 1);
        row.filled().take_while(|&c| c < before || of_size(c)).find(|&c| is_words(row.cell(c)))
    }

    fn note_below(&self, grid: &Grid, rows: &[GridRow]) -> Option<String> {
        const MOST: usize = 4;
        let (first, last) = (rows.first()?, rows.last()?);
        let text = |below: &Below| match below.value {
            Some((_, value)) => format!("\"{}\" {value}", below.words),
            None => format!("\"{}\"", below.words),
        };
        let mut named: Vec<String> = self.below.iter().take(MOST).map(text).collect();
        if self.below.len() > MOST {
            named.push("...".into());
        }
        let word = grid.row_word();
        let lines = match first.line == last.line {
            true => format!("{word} {}", grid.row_name(first.line)),
            false => format!("{word}s {} to {}", grid.row_name(first.line), grid.row_name(last.line)),
        };
        let left = if rows.len() == 1 { "was" } else { "were" };
        Some(format!("{lines} below the table ({}) {left} left out", named.join(", ")))
    }
}
