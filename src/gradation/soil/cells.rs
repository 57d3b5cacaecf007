//! The cells of a sheet while it is read, within bounds.

use super::grid::{Grid, GridRow};
use super::zipped::{too_large, unreadable};
use crate::gradation::error::TableError;

/// Most columns and rows of which cells are kept; a sheet of soils has some tens.
const MOST_COLUMNS: usize = 500;
const MOST_ROWS: usize = 20_000;
/// Most places for cells, and most characters, of a whole workbook.
const MOST_PLACES: usize = 500_000;
const MOST_CHARACTERS: usize = 4_000_000;
/// What is kept of the text of a cell.
const LONGEST: usize = 200;

/// What the sheets of a workbook may still take.
pub(super) struct Budget {
    places: usize,
    characters: usize,
}

impl Budget {
    /// That of a workbook.
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
}

impl<'a> Cells<'a> {
    /// No cells.
    pub(super) fn new(file: &str, sheet: &str, budget: &'a mut Budget) -> Cells<'a> {
        let grid = Grid { file: file.into(), sheet: Some(sheet.into()), delimiter: ',', ..Grid::default() };
        Cells { grid, budget }
    }

    /// Takes a cell, which stands after all that came before; row and column are counted from 0.
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
        if more > 0 {
            last.cells.resize(column + 1, String::new());
        }
        last.cells[column] = text;
        Ok(())
    }

    /// All of them.
    pub(super) fn done(self) -> Grid {
        self.grid
    }
}
