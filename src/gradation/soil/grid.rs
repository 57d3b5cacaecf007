//! Rows of cells: what every kind of file is brought to before its soils are looked for.

use crate::gradation::error::{Position, TableError, shortened};

/// Cells as text, and where they stand.
#[derive(Debug, Default)]
pub(super) struct Grid {
    /// File as the user named it.
    pub(super) file: String,
    /// Sheet of a workbook.
    pub(super) sheet: Option<String>,
    /// What separated the cells, in a text file.
    pub(super) delimiter: char,
    /// Rows that hold anything.
    pub(super) rows: Vec<GridRow>,
    /// What was assumed so far.
    pub(super) notes: Vec<String>,
}

/// A row of cells.
#[derive(Debug)]
pub(super) struct GridRow {
    /// Line of a text file, row of a sheet, counted from 1.
    pub(super) line: usize,
    /// Its cells, trimmed; empty ones at its end are left out.
    pub(super) cells: Vec<String>,
    /// The line itself, of a text file.
    pub(super) text: Option<String>,
    /// A quote is left open in it.
    pub(super) open: bool,
}

impl GridRow {
    /// The cell in this column, empty where there is none.
    pub(super) fn cell(&self, column: usize) -> &str {
        self.cells.get(column).map_or("", String::as_str)
    }

    /// Columns that hold anything.
    pub(super) fn filled(&self) -> impl Iterator<Item = usize> + '_ {
        (0..self.cells.len()).filter(|&column| !self.cells[column].is_empty())
    }
}

impl Grid {
    /// A cell whose `value` is refused as that of `field`.
    pub(super) fn refused(
        &self,
        line: usize,
        column: usize,
        field: &'static str,
        value: &str,
        allowed: impl Into<String>,
    ) -> TableError {
        let column = self.sheet.as_ref().map(|_| column as u32);
        let at = Position { file: self.place(), line, field, column };
        TableError::Value { at, value: shortened(value), allowed: allowed.into() }
    }

    /// A heading that is refused.
    pub(super) fn refused_heading(&self, line: usize, value: &str, allowed: &str) -> TableError {
        let (file, value) = (self.place(), shortened(value));
        TableError::Header { file, line, value, allowed: allowed.into() }
    }

    /// The file, and the sheet where there is one.
    pub(super) fn place(&self) -> String {
        match &self.sheet {
            Some(sheet) => format!("{}, sheet \"{}\"", self.file, shortened(sheet)),
            None => self.file.clone(),
        }
    }
}
