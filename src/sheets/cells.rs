//! The cells of a sheet while it is read, within bounds.

use std::collections::HashSet;
use std::ops::Range;

use super::grid::{Grid, GridRow};
use super::lines::listed;
use super::zipped::{too_large, unreadable};
use voidwalk_core::gradation::{TableError, letters};

/// Most columns and rows that are kept; a sheet of soils has some tens.
const MOST_COLUMNS: usize = 500;
const MOST_ROWS: usize = 20_000;
/// Most places for cells, and most characters, of a whole workbook.
const MOST_PLACES: usize = 500_000;
const MOST_CHARACTERS: usize = 4_000_000;
/// Longest text of a cell that is kept.
const LONGEST: usize = 200;

/// Places and characters that the sheets of a workbook may still take.
pub(super) struct Budget {
    places: usize,
    characters: usize,
}

impl Budget {
    /// Budget of a whole workbook.
    pub(super) fn new() -> Budget {
        Budget { places: MOST_PLACES, characters: MOST_CHARACTERS }
    }
}

/// The text of a cell on one line, shortened.
pub(super) fn tidy(text: &str) -> String {
    let mut tidy = String::new();
    for word in text.split_whitespace() {
        if tidy.len() >= LONGEST {
            break;
        }
        if !tidy.is_empty() {
            tidy.push(' ');
        }
        tidy.extend(word.chars().take(LONGEST));
    }
    tidy
}

/// The cells of a sheet.
pub(super) struct Cells<'a> {
    grid: Grid,
    budget: &'a mut Budget,
    hidden_rows: Vec<usize>,
    hidden_columns: Vec<Range<usize>>,
}

impl<'a> Cells<'a> {
    /// An empty sheet.
    pub(super) fn new(file: &str, sheet: &str, budget: &'a mut Budget) -> Cells<'a> {
        let grid = Grid { file: file.into(), sheet: Some(sheet.into()), delimiter: ',', ..Grid::default() };
        Cells { grid, budget, hidden_rows: Vec::new(), hidden_columns: Vec::new() }
    }

    /// Takes a cell behind all that came before; row and column are counted from 0.
    pub(super) fn put(&mut self, row: usize, column: usize, text: &str) -> Result<(), TableError> {
        let text = tidy(text);
        if text.is_empty() {
            return Ok(());
        }
        let file = &self.grid.file;
        if row >= MOST_ROWS || column >= MOST_COLUMNS {
            let how = format!("cells beyond {MOST_ROWS} rows or {MOST_COLUMNS} columns");
            return Err(too_large(file, &how));
        }
        let line = row + 1;
        match self.grid.rows.last() {
            Some(last) if last.line == line => {}
            Some(last) if last.line > line => return Err(unreadable(file, "its rows are not in order")),
            _ => self.grid.rows.push(GridRow { line, cells: Vec::new(), text: None, open: false }),
        }
        let Some(last) = self.grid.rows.last_mut() else { return Ok(()) };
        let more = (column + 1).saturating_sub(last.cells.len());
        let left = (self.budget.places.checked_sub(more), self.budget.characters.checked_sub(text.len()));
        let (Some(places), Some(characters)) = left else {
            return Err(too_large(file, "too many cells"));
        };
        *self.budget = Budget { places, characters };
        if !last.cell(column).is_empty() {
            let name = format!("{}{line}", letters(column as u32));
            return Err(unreadable(file, &format!("its cell {name} stands in it twice")));
        }
        if more > 0 {
            last.cells.resize(column + 1, String::new());
        }
        last.cells[column] = text;
        Ok(())
    }

    /// Marks a row as hidden, counted from 0.
    pub(super) fn hide_row(&mut self, row: usize) {
        if row < MOST_ROWS {
            self.hidden_rows.push(row + 1);
        }
    }

    /// Marks columns as hidden, counted from 0.
    pub(super) fn hide_columns(&mut self, columns: Range<usize>) {
        if self.hidden_columns.len() < MOST_COLUMNS {
            self.hidden_columns.push(columns);
        }
    }

    /// Returns all cells as a grid, with a note of those hidden from a reader of the sheet.
    pub(super) fn done(mut self, hidden: bool) -> Grid {
        let grid = &mut self.grid;
        if hidden {
            grid.notes.push("its sheet is hidden in the workbook".into());
        }
        let filled: HashSet<usize> = grid.rows.iter().map(|row| row.line).collect();
        let rows: Vec<String> =
            self.hidden_rows.iter().filter(|row| filled.contains(row)).map(usize::to_string).collect();
        if !rows.is_empty() {
            grid.notes
                .push(format!("{} of the sheet, though hidden, read", listed("row", &rows, String::clone)));
        }
        let width = grid.rows.iter().map(|row| row.cells.len()).max().unwrap_or(0);
        let mut is_filled = vec![false; width];
        grid.rows.iter().flat_map(GridRow::filled).for_each(|c| is_filled[c] = true);
        let is_hidden = |c: &usize| self.hidden_columns.iter().any(|columns| columns.contains(c));
        let columns: Vec<String> =
            (0..width).filter(|&c| is_filled[c]).filter(is_hidden).map(|c| letters(c as u32)).collect();
        if !columns.is_empty() {
            grid.notes.push(format!(
                "{} of the sheet, though hidden, read",
                listed("column", &columns, String::clone)
            ));
        }
        self.grid
    }
}
