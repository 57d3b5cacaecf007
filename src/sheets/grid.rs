//! Rows of cells: what every kind of file is brought to before its soils are looked for.

use std::ops::Range;
use std::rc::Rc;

use voidwalk_core::gradation::{Position, TableError, letters, shortened};

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
    /// Rows of numbers that are commented out: their lines and texts.
    pub(super) commented: Vec<(usize, String)>,
    /// What was assumed so far.
    pub(super) notes: Vec<String>,
    /// Columns of the file to the left of this grid, where it is a part of one.
    pub(super) left: usize,
    /// Where the rows of this grid are columns of the file: the line of the file that each column is.
    pub(super) across: Option<Vec<usize>>,
    /// Which columns of a text file these are, where it holds several tables side by side.
    pub(super) part: Option<String>,
}

/// Where a cell stands in the file: its line, counted from 1, and its column, counted from 0.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Place {
    pub(super) line: usize,
    pub(super) column: usize,
}

/// A line of a text file.
#[derive(Debug)]
pub(super) struct Line {
    pub(super) text: String,
    /// The number of its cells, empty ones at its end among them.
    pub(super) cells: usize,
}

/// A row of cells.
#[derive(Clone, Debug)]
pub(super) struct GridRow {
    /// Line of a text file, row of a sheet, counted from 1.
    pub(super) line: usize,
    /// Its cells, trimmed; empty ones at its end are left out.
    pub(super) cells: Vec<String>,
    /// The line itself, of a text file.
    pub(super) text: Option<Rc<Line>>,
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
    /// Where the cell in this row and column of the grid stands in the file.
    pub(super) fn place_of(&self, line: usize, column: usize) -> Place {
        match &self.across {
            Some(lines) => {
                let line_of_file = lines.get(column).or(lines.first());
                Place { line: line_of_file.copied().unwrap_or(1), column: line - 1 }
            }
            None => Place { line, column: self.left + column },
        }
    }

    /// What a row of this grid is called: `line 3`, `row 3` of a sheet, `column D` where rows are columns.
    pub(super) fn said(&self, line: usize) -> String {
        format!("{} {}", self.row_word(), self.row_name(line))
    }

    /// `line`, `row` or `column`.
    pub(super) fn row_word(&self) -> &'static str {
        match (&self.across, &self.sheet) {
            (Some(_), _) => "column",
            (None, Some(_)) => "row",
            (None, None) => "line",
        }
    }

    /// A row's number, or its letter where it is a column of a sheet.
    pub(super) fn row_name(&self, line: usize) -> String {
        match self.across.is_some() && self.sheet.is_some() {
            true => letters(line as u32 - 1),
            false => line.to_string(),
        }
    }

    /// What a column of this grid is called: `column D` of a sheet, `column 4` of a text.
    pub(super) fn column_said(&self, column: usize) -> String {
        match &self.sheet {
            Some(_) => format!("column {}", letters((self.left + column) as u32)),
            None => format!("column {}", self.left + column + 1),
        }
    }

    /// The parts of the grid in these columns, which follow each other; rows that are empty there are left
    /// out.
    pub(super) fn columns(&self, ranges: &[Range<usize>]) -> Vec<Grid> {
        let like = |range: &Range<usize>| Grid {
            file: self.file.clone(),
            sheet: self.sheet.clone(),
            delimiter: self.delimiter,
            rows: Vec::new(),
            commented: self.commented.clone(),
            notes: self.notes.clone(),
            left: self.left + range.start,
            across: None,
            part: match &self.sheet {
                Some(_) => None,
                None => Some(format!("columns {} to {}", self.left + range.start + 1, self.left + range.end)),
            },
        };
        let mut parts: Vec<Grid> = ranges.iter().map(like).collect();
        // Each row is gone through once, however many parts there are.
        for row in &self.rows {
            for (range, part) in ranges.iter().zip(&mut parts) {
                if range.start >= row.cells.len() {
                    break;
                }
                let mut cells = row.cells[range.start..range.end.min(row.cells.len())].to_vec();
                cells.truncate(cells.iter().rposition(|cell| !cell.is_empty()).map_or(0, |last| last + 1));
                if !cells.is_empty() {
                    let text = row.text.clone();
                    part.rows.push(GridRow { line: row.line, cells, text, open: row.open });
                }
            }
        }
        parts
    }

    /// The part of the grid in these rows.
    pub(super) fn band(&self, range: Range<usize>) -> Grid {
        Grid {
            file: self.file.clone(),
            sheet: self.sheet.clone(),
            delimiter: self.delimiter,
            rows: self.rows[range].to_vec(),
            commented: self.commented.clone(),
            notes: self.notes.clone(),
            left: self.left,
            across: None,
            part: self.part.clone(),
        }
    }

    /// A cell whose `value` is refused as that of `field`.
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

    /// A heading that is refused.
    pub(super) fn refused_heading(&self, line: usize, value: &str, allowed: &str) -> TableError {
        let (file, value) = (self.place(), shortened(value));
        TableError::Header { file, line, value, allowed: allowed.into() }
    }

    /// The file, and the sheet where there is one.
    pub(super) fn place(&self) -> String {
        match (&self.sheet, &self.part) {
            (Some(sheet), _) => format!("{}, sheet \"{}\"", self.file, shortened(sheet)),
            (None, Some(part)) => format!("{}, {part}", self.file),
            (None, None) => self.file.clone(),
        }
    }
}
