//! A soil as given in a file: its table, and the assumptions made in reading it.

use super::grid::{Grid, Place};
use voidwalk_core::gradation::Row;
use voidwalk_core::gradation::{Gradation, from_rows};
use voidwalk_core::gradation::{GradationError, letters};

/// A soil as given in a file.
#[derive(Clone, Debug)]
pub struct Soil {
    pub(super) name: String,
    pub(super) file: String,
    pub(super) rows: Vec<Row>,
    /// Places of the opening and the percent of each row.
    pub(super) places: Vec<[Place; 2]>,
    pub(super) kind: Kind,
    pub(super) notes: Vec<String>,
}

/// Arrangement of a soil's table in its file.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Kind {
    /// In lines of a text.
    Lines,
    /// In rows of a sheet.
    Rows,
    /// Across, with a column for each sieve, in a sheet or a text.
    Across { sheet: bool },
}

impl Kind {
    /// Arrangement of the tables of a grid.
    pub(super) fn of(grid: &Grid) -> Kind {
        match (&grid.across, &grid.sheet) {
            (Some(_), sheet) => Kind::Across { sheet: sheet.is_some() },
            (None, Some(_)) => Kind::Rows,
            (None, None) => Kind::Lines,
        }
    }
}

impl Soil {
    /// Name given by the sheet or the column; empty without one.
    pub fn name(&self) -> &str {
        &self.name
    }

    /// Assumptions, in words.
    pub fn notes(&self) -> &[String] {
        &self.notes
    }

    /// Sieve curve; `d0_mm` is the size at which an open finest tail ends.
    ///
    /// # Errors
    /// A table that is not a sieve curve, with the errors of [`read_gradation`](crate::read_gradation).
    pub fn gradation(&self, d0_mm: Option<f64>) -> Result<Gradation, GradationError> {
        // Counts rows from 1: lines of the file repeat in parts that lie side by side.
        let counted = |(index, row): (usize, &Row)| Row { line: index + 1, ..*row };
        let rows = self.rows.iter().enumerate().map(counted).collect();
        let in_sheet = matches!(self.kind, Kind::Rows | Kind::Across { sheet: true });
        let place = |row: usize, percent: bool| {
            let place = self.places[row - 1][usize::from(percent)];
            (place.line, in_sheet.then_some(place.column as u32))
        };
        from_rows(&self.file, rows, d0_mm).map_err(|error| match error {
            GradationError::Table(error) => error.placed(place, |row| self.row_label(row)).into(),
            error => error,
        })
    }

    /// Name of a row, counted from 1.
    fn row_label(&self, row: usize) -> String {
        let Place { line, column } = self.places[row - 1][1];
        match self.kind {
            Kind::Lines => format!("line {line}"),
            Kind::Rows if self.places.iter().any(|places| places[1].column != column) => {
                format!("cell {}{line}", letters(column as u32))
            }
            Kind::Rows => format!("row {line}"),
            Kind::Across { sheet: true } => format!("column {}", letters(column as u32)),
            Kind::Across { sheet: false } => format!("column {}", column + 1),
        }
    }
}
