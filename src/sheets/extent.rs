//! Rows of the table below the headings, without remarks, repeated headings and laboratory notes below
//! it. Checks that each of its numbers is read and that its commas have one meaning.

use super::content::{is_blank, is_text, is_value, is_words, percentage, refused_row, row_below, whole_row};
use super::grid::{Grid, GridRow, listed};
use super::heading::{Retained, Role};
use super::layout::{Layout, SoilColumn, repeats_headings};
use super::size::{Entry, Opening, Unit, opening};
use super::soil::Soil;
use std::collections::HashSet;
use voidwalk_core::gradation::{Comma, FIELDS, TableError, comma, shortened};

/// A row below a table: `Dry mass (g) | 500`.
pub(super) struct Below {
    pub(super) line: usize,
    pub(super) column: usize,
    pub(super) words: String,
    /// First number after the words, and its column.
    pub(super) value: Option<(usize, f64)>,
}

/// A table of a grid: its layout, its rows and the rows below it.
pub(super) struct Extent<'a> {
    pub(super) grid: &'a Grid,
    pub(super) layout: &'a Layout,
    table: Vec<&'a GridRow>,
    /// Rows below the table, which are ignored.
    pub(super) below: Vec<Below>,
    pub(super) notes: Vec<String>,
    /// First column of a soil.
    first_value: usize,
}

/// A column of a table that is read as a soil, and the notes on it.
pub(super) struct Reading<'a> {
    pub(super) extent: &'a Extent<'a>,
    pub(super) grid: &'a Grid,
    pub(super) layout: &'a Layout,
    pub(super) column: &'a SoilColumn,
    pub(super) notes: Vec<String>,
}

impl Reading<'_> {
    pub(super) fn refused_size(&self, entry: &Entry, allowed: impl Into<String>) -> TableError {
        self.grid.refused(entry.line, entry.column, FIELDS[0], &entry.text, allowed)
    }

    pub(super) fn refused_value(&self, line: usize, value: f64, allowed: impl Into<String>) -> TableError {
        self.grid.refused(line, self.column.column, FIELDS[1], &value.to_string(), allowed)
    }
}

impl<'a> Extent<'a> {
    /// Determines the rows of the table in a grid.
    pub(super) fn of(grid: &'a Grid, layout: &'a Layout) -> Result<Extent<'a>, TableError> {
        const MOST_BELOW: usize = 4;
        let rows = &grid.rows[layout.first..];
        let first_value = layout.soils.iter().map(|soil| soil.column).min().unwrap_or(0);
        let (table, below, notes) = (Vec::new(), Vec::new(), Vec::new());
        let mut extent = Extent { grid, layout, table, below, notes, first_value };
        let end = extent.end(rows);
        let last =
            rows[..end].iter().rposition(|row| row.filled().any(|c| is_value(row.cell(c)))).unwrap_or(0);
        let mut remarks = Vec::new();
        for (index, row) in rows[..end].iter().enumerate() {
            let is_next = || index > last && row.line == rows[last].line + 1;
            let below = || is_next().then(|| row_below(row)).flatten();
            if let Some(column) = whole_row(row, index < last).or_else(below) {
                return Err(refused_row(grid, row, column));
            }
            if repeats_headings(row, layout) {
                continue;
            }
            if is_text(row) && (row.filled().count() == 1 || index > last) {
                remarks.push(row.line);
            } else {
                extent.table.push(row);
            }
        }
        for row in &rows[end..] {
            let Some(column) = extent.column_of_words(row) else { continue };
            let value =
                row.filled().filter(|&c| c > column).find_map(|c| Some((c, percentage(row.cell(c))?)));
            let words = shortened(row.cell(column));
            extent.below.push(Below { line: row.line, column, words, value });
        }
        let name = |line: &usize| grid.row_name(*line);
        if !remarks.is_empty() {
            let taken = if remarks.len() == 1 { "a remark" } else { "remarks" };
            let rows = listed(grid.row_word(), &remarks, name);
            extent.notes.push(format!("{rows} taken as {taken} and left out"));
        }
        if let (Some(first), Some(last)) = (rows[end..].first(), rows.last()) {
            let text = |below: &Below| match below.value {
                Some((_, value)) => format!("\"{}\" {value}", below.words),
                None => format!("\"{}\"", below.words),
            };
            let mut words: Vec<String> = extent.below.iter().take(MOST_BELOW).map(text).collect();
            if extent.below.len() > MOST_BELOW {
                words.push("...".into());
            }
            let lines = match first.line == last.line {
                true => grid.row_label(first.line),
                false => format!("{}s {} to {}", grid.row_word(), name(&first.line), name(&last.line)),
            };
            let left = if rows.len() == end + 1 { "was" } else { "were" };
            extent.notes.push(format!("{lines} below the table ({}) {left} left out", words.join(", ")));
        }
        Ok(extent)
    }

    pub(super) fn rows(&self) -> impl Iterator<Item = &'a GridRow> {
        self.table.iter().copied()
    }

    /// Reads the opening of a row.
    pub(super) fn opening(&self, row: &GridRow) -> Option<Opening> {
        opening(row.cell(self.column_of_size(row))).map(|(opening, _)| opening)
    }

    /// Finds the column with the opening of a row.
    pub(super) fn column_of_size(&self, row: &GridRow) -> usize {
        let layout = self.layout;
        let other = layout.other_size.filter(|&c| !row.cell(c).is_empty());
        match is_blank(row.cell(layout.size)) {
            // If there are words in another column, the row is refused at that column.
            true => other.or(self.column_of_words(row)).unwrap_or(layout.size),
            false => layout.size,
        }
    }

    /// Index of the end of the table: the first row of words below its numbers. If the numbers below
    /// continue those above, the table goes on, so that a row with a percent is refused.
    fn end(&self, rows: &[GridRow]) -> usize {
        let is_data = |row: &GridRow| {
            let column = self.column_of_size(row);
            opening(row.cell(column)).is_some() && row.filled().any(|c| c != column && is_value(row.cell(c)))
        };
        let ends = (rows.iter().position(is_data), rows.iter().rposition(is_data));
        let (Some(begun), Some(last)) = ends else { return rows.len() };
        let ends = |&at: &usize| {
            let row = &rows[at];
            let ends = || match at > last {
                true => !is_text(row),
                false => !repeats_headings(row, self.layout) && !self.continues(&rows[..at], &rows[at + 1..]),
            };
            self.column_of_words(row).is_some() && ends()
        };
        (begun..rows.len()).find(ends).unwrap_or(rows.len())
    }

    /// True if any of the rows `below` may continue those `above`: it has a size beyond the last one,
    /// and its percent finer goes in the same direction.
    fn continues(&self, above: &[GridRow], below: &[GridRow]) -> bool {
        let Some(soil) = self.layout.soils.first() else { return true };
        let numbers = |row: &GridRow| match self.opening(row)? {
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

    /// Finds the column of the words that begin a row in place of an opening.
    fn column_of_words(&self, row: &GridRow) -> Option<usize> {
        let layout = self.layout;
        let sizes = [Some(layout.size), layout.other_size];
        let of_size = |c: usize| sizes.contains(&Some(c));
        let is_free = |c: usize| is_blank(row.cell(c)) || is_words(row.cell(c));
        if !sizes.into_iter().flatten().all(is_free) {
            return None;
        }
        let before = self.first_value.max(layout.size + 1);
        row.filled().take_while(|&c| c < before || of_size(c)).find(|&c| is_words(row.cell(c)))
    }
}

/// Refuses a table with a number that is in no curve and in no note.
pub(super) fn refuse_lost(extent: &Extent, soils: &[Result<Soil, TableError>]) -> Result<(), TableError> {
    let (grid, layout) = (extent.grid, extent.layout);
    let lost = |line: usize, column: usize, cell: &str| {
        let allowed = "numbers that are read, or are in a column of their own beside the table";
        Err(grid.refused(line, column, FIELDS[1], cell, allowed))
    };
    let is_rest = |row: &GridRow| {
        use Opening::{Bare, Below, Class, Mm, Pan, Total};
        let size = extent.opening(row);
        matches!(size, Some(Pan | Total | Below(_) | Class(_, 0.0) | Bare(0.0) | Mm(0.0)))
    };
    let mut read: HashSet<usize> = HashSet::new();
    for (column, soil) in layout.soils.iter().zip(soils) {
        // A refused soil has its own reason.
        let Ok(soil) = soil else { return Ok(()) };
        let lines: HashSet<usize> = soil.rows.iter().map(|row| row.line).collect();
        for row in extent.rows().filter(|row| !lines.contains(&row.line)) {
            let cell = row.cell(column.column);
            if is_value(cell) && !is_rest(row) {
                return lost(row.line, column.column, cell);
            }
        }
        read.extend(lines);
    }
    let is_read = |row: &GridRow, c: usize| {
        let is_size = Some(c) == layout.other_size || c == layout.size;
        let is_skipped = || layout.soils.iter().all(|soil| is_blank(row.cell(soil.column)));
        layout.accounted.contains(&c)
            || layout.soils.iter().any(|soil| soil.column == c)
            || is_size && (read.contains(&row.line) || is_rest(row) || is_skipped())
    };
    for row in extent.rows() {
        if let Some(c) = row.filled().find(|&c| is_value(row.cell(c)) && !is_read(row, c)) {
            return lost(row.line, c, row.cell(c));
        }
    }
    Ok(())
}

/// Refuses a table whose numbers contain points and commas, or in which every comma may separate
/// thousands.
pub(super) fn check_commas(reading: &mut Reading) -> Result<(), TableError> {
    refuse_points_of_thousands(reading)?;
    let &mut Reading { extent, grid, layout, column, .. } = reading;
    let (mut point, mut other, mut decimal, mut either) = (None, None, false, None);
    for row in extent.rows() {
        let at = extent.column_of_size(row);
        for c in [at, column.column] {
            let cell = row.cell(c);
            // `1,254.6` has both: one of them separates thousands.
            let is_number = percentage(cell).is_some() && !(cell.contains('.') && cell.contains(','));
            if is_number && cell.contains('.') {
                point = point.or(Some(row.line));
            }
            if is_number && cell.contains(',') {
                other = other.or(Some((row.line, cell)));
            }
            // No percentage reaches a thousand.
            let is_percent = c != at && !matches!(column.role, Role::Retained(_));
            match comma(cell) {
                Some(Comma::Decimal) => decimal = true,
                Some(Comma::Either) if is_percent => decimal = true,
                Some(Comma::Either) => either = either.or(Some((row.line, c, cell))),
                None => {}
            }
        }
    }
    if let (Some(point), Some((line, value)), None) = (point, other, &grid.sheet) {
        let allowed = format!(
            "one decimal sign in the whole file ({} has a decimal point), no thousands separators",
            grid.row_label(point)
        );
        return Err(grid.refused(line, layout.size, "number", value, allowed));
    }
    let Some((line, c, cell)) = either else { return Ok(()) };
    let is_usual =
        !decimal && (grid.sheet.is_some() || grid.delimiter == ',' || layout.unit == Some(Unit::Micrometre));
    if is_usual {
        let (as_decimal, as_thousands) = (cell.replace(',', "."), cell.replace(',', ""));
        let allowed = format!(
            "{as_decimal} or {as_thousands}: here the comma may be a decimal sign or separate thousands"
        );
        return Err(grid.refused(line, c, "number", cell, allowed));
    }
    reading.notes.push(format!("commas within numbers, as in {cell}, read as decimal signs"));
    Ok(())
}

/// Refuses `1.100` among whole masses of hundreds of grams: its point may separate thousands.
fn refuse_points_of_thousands(&Reading { extent, grid, column, .. }: &Reading) -> Result<(), TableError> {
    const LEAST: f64 = 100.0;
    if !matches!(column.role, Role::Retained(Retained { percent: false, .. })) {
        return Ok(());
    }
    let may_be_thousands = |cell: &str| {
        let (whole, rest) = cell.split_once('.').unwrap_or_default();
        let is_digits = |text: &str| text.bytes().all(|b| b.is_ascii_digit());
        (1..=3).contains(&whole.len())
            && !whole.starts_with('0')
            && rest.len() == 3
            && is_digits(whole)
            && is_digits(rest)
    };
    let (mut first, mut largest) = (None, 0.0f64);
    for row in extent.rows() {
        let cell = row.cell(column.column);
        match percentage(cell) {
            Some(_) if may_be_thousands(cell) => first = first.or(Some((row.line, cell))),
            Some(mass) if mass.fract() != 0.0 => return Ok(()),
            Some(mass) => largest = largest.max(mass),
            None => {}
        }
    }
    match first.filter(|_| largest >= LEAST) {
        Some((line, cell)) => {
            let allowed = format!(
                "{cell} or {}, as a number: here the point may be a decimal sign or separate thousands",
                cell.replace('.', "")
            );
            Err(grid.refused(line, column.column, "number", cell, allowed))
        }
        None => Ok(()),
    }
}
