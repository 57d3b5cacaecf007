//! Rows of cells: the common form of all kinds of file, before soils are searched for.

use std::ops::Range;
use std::rc::Rc;
use voidwalk_core::gradation::{Position, TableError, letters, shortened};
use voidwalk_core::text::plain;

/// Cells as text, with their places in the file.
#[derive(Debug, Default)]
pub(super) struct Grid {
    pub(super) file: String,
    pub(super) sheet: Option<String>,
    pub(super) delimiter: char,
    /// Rows that are not empty.
    pub(super) rows: Vec<GridRow>,
    /// Rows of numbers that are commented out: their lines and texts.
    pub(super) commented: Vec<(usize, String)>,
    pub(super) notes: Vec<String>,
    /// Number of columns of the file to the left of this grid, if it is a part of one.
    pub(super) left: usize,
    /// For a grid whose rows are columns of the file: the line of the file for each column.
    pub(super) across: Option<Vec<usize>>,
    /// Name of the columns if a text file holds several tables side by side.
    pub(super) part: Option<String>,
}

/// Place of a cell in the file: its line, counted from 1, and its column, counted from 0.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Place {
    pub(super) line: usize,
    pub(super) column: usize,
}

#[derive(Debug)]
pub(super) struct Line {
    pub(super) text: String,
    /// Number of cells, including empty ones at the end.
    pub(super) cells: usize,
}

#[derive(Clone, Debug)]
pub(super) struct GridRow {
    /// Line of a text file or row of a sheet, counted from 1.
    pub(super) line: usize,
    /// Cells, trimmed, without empty ones at the end.
    pub(super) cells: Vec<String>,
    pub(super) text: Option<Rc<Line>>,
    /// True if a quote in the row is not closed.
    pub(super) open: bool,
}

impl GridRow {
    /// Returns the cell in this column; an empty text beyond the last cell.
    pub(super) fn cell(&self, column: usize) -> &str {
        self.cells.get(column).map_or("", String::as_str)
    }

    /// Lists the columns that are not empty.
    pub(super) fn filled(&self) -> impl Iterator<Item = usize> + '_ {
        (0..self.cells.len()).filter(|&column| !self.cells[column].is_empty())
    }
}

impl Grid {
    /// Returns the place in the file of the cell in this row and column of the grid.
    pub(super) fn place_of(&self, line: usize, column: usize) -> Place {
        match &self.across {
            Some(lines) => {
                Place { line: *lines.get(column).or(lines.first()).unwrap_or(&1), column: line - 1 }
            }
            None => Place { line, column: self.left + column },
        }
    }

    /// Name of a row of this grid: `line 3`, `row 3` of a sheet, `column D` if rows are columns.
    pub(super) fn row_label(&self, line: usize) -> String {
        format!("{} {}", self.row_word(), self.row_name(line))
    }

    pub(super) fn row_word(&self) -> &'static str {
        match (&self.across, &self.sheet) {
            (Some(_), _) => "column",
            (None, Some(_)) => "row",
            (None, None) => "line",
        }
    }

    /// Number of a row, or its letter if it is a column of a sheet.
    pub(super) fn row_name(&self, line: usize) -> String {
        match self.across.is_some() && self.sheet.is_some() {
            true => letters(line as u32 - 1),
            false => line.to_string(),
        }
    }

    /// Name of a column of this grid: `column D` of a sheet, `column 4` of a text.
    pub(super) fn column_label(&self, column: usize) -> String {
        let column = self.left + column;
        let name = if self.sheet.is_some() { letters(column as u32) } else { (column + 1).to_string() };
        format!("column {name}")
    }

    pub(super) fn width(&self) -> usize {
        self.rows.iter().map(|row| row.cells.len()).max().unwrap_or(0)
    }

    /// Makes a part of the same file from these rows.
    pub(super) fn with_rows(&self, rows: Vec<GridRow>) -> Grid {
        let (file, sheet, part) = (self.file.clone(), self.sheet.clone(), self.part.clone());
        let (commented, notes) = (self.commented.clone(), self.notes.clone());
        let (delimiter, left) = (self.delimiter, self.left);
        Grid { file, sheet, delimiter, rows, commented, notes, left, across: None, part }
    }

    /// Splits the grid into these adjacent ranges of columns; each part omits the rows that are empty in
    /// it.
    pub(super) fn columns(&self, ranges: &[Range<usize>]) -> Vec<Grid> {
        let part = |range: &Range<usize>| {
            let left = self.left + range.start;
            let name = || format!("columns {} to {}", left + 1, self.left + range.end);
            Grid { left, part: self.sheet.is_none().then(name), ..self.with_rows(Vec::new()) }
        };
        let mut parts: Vec<Grid> = ranges.iter().map(part).collect();
        // Each row is visited once, whatever the number of parts.
        for row in &self.rows {
            for (range, part) in ranges.iter().zip(&mut parts) {
                if range.start >= row.cells.len() {
                    break;
                }
                let cells = trimmed(row.cells[range.start..range.end.min(row.cells.len())].to_vec());
                if !cells.is_empty() {
                    let text = row.text.clone();
                    part.rows.push(GridRow { line: row.line, cells, text, open: row.open });
                }
            }
        }
        parts
    }

    /// Makes the error for a cell whose `value` is refused as a value of `field`.
    pub(super) fn refused(
        &self,
        line: usize,
        column: usize,
        field: &'static str,
        value: &str,
        allowed: impl Into<String>,
    ) -> TableError {
        let Place { line, column } = self.place_of(line, column);
        let column = self.sheet.as_ref().map(|_| column as u32);
        let at = Position { file: self.place(), line, field, column };
        TableError::Value { at, value: shortened(value), allowed: allowed.into() }
    }

    pub(super) fn refused_heading(&self, line: usize, value: &str, allowed: &str) -> TableError {
        let (file, value) = (self.place(), shortened(value));
        TableError::Header { file, line, value, allowed: allowed.into() }
    }

    /// The file, and the sheet if the file has sheets.
    pub(super) fn place(&self) -> String {
        match (&self.sheet, &self.part) {
            (Some(sheet), _) => format!("{}, sheet \"{}\"", self.file, shortened(sheet)),
            (None, Some(part)) => format!("{}, {part}", self.file),
            (None, None) => self.file.clone(),
        }
    }
}

/// Drops the empty cells at the end of a row.
pub(super) fn trimmed(mut cells: Vec<String>) -> Vec<String> {
    cells.truncate(cells.iter().rposition(|cell| !cell.is_empty()).map_or(0, |last| last + 1));
    cells
}

/// `line 5`, `rows 5, 7, 8`, `lines 5, 7 and 12 more`.
pub(super) fn listed<T>(word: &str, all: &[T], name: impl Fn(&T) -> String) -> String {
    const MOST: usize = 8;
    let shown = all.iter().take(MOST).map(name).collect::<Vec<String>>().join(", ");
    match all.len() {
        1 => format!("{word} {shown}"),
        n if n > MOST => format!("{word}s {shown} and {} more", n - MOST),
        _ => format!("{word}s {shown}"),
    }
}

/// Joins names; if there are more than `most`, only the first ones.
pub(super) fn joined(mut names: Vec<String>, most: usize) -> String {
    if names.len() > most {
        let more = format!("and {} more", names.len() - most);
        names.splice(most.., [more]);
    }
    names.join(", ")
}

/// Names of soils, shortened; if there are many, only the first ones.
pub(super) fn names_listed<T: AsRef<str>>(names: &[T]) -> String {
    joined(names.iter().map(|name| shortened(&plain(name.as_ref()))).collect(), 12)
}
