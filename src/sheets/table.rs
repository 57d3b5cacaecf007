//! A soil as it stands in a file: its table, and what was assumed to read it.

use super::grid::{Grid, Place};
use voidwalk_core::gradation::Row;
use voidwalk_core::gradation::{Gradation, from_rows};
use voidwalk_core::gradation::{GradationError, letters};

/// A soil as it stands in a file.
#[derive(Clone, Debug)]
pub struct Soil {
    pub(super) name: String,
    pub(super) file: String,
    pub(super) rows: Vec<Row>,
    /// Where the opening and the percent of each row stand.
    pub(super) places: Vec<[Place; 2]>,
    pub(super) kind: Kind,
    pub(super) notes: Vec<String>,
}

/// How a soil's table stands in its file.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Kind {
    /// In lines of a text.
    Lines,
    /// In rows of a sheet.
    Rows,
    /// Across: a column for each sieve, in a sheet or not.
    Across { sheet: bool },
}

impl Kind {
    /// That of the tables of a grid.
    pub(super) fn of(grid: &Grid) -> Kind {
        match (&grid.across, &grid.sheet) {
            (Some(_), sheet) => Kind::Across { sheet: sheet.is_some() },
            (None, Some(_)) => Kind::Rows,
            (None, None) => Kind::Lines,
        }
    }
}

impl Soil {
    /// What the sheet or the column calls it; empty where nothing does.
    pub fn name(&self) -> &str {
        &self.name
    }

    /// What was assumed, in words.
    pub fn notes(&self) -> &[String] {
        &self.notes
    }

    /// Its sieve curve; `d0_mm` is where an open finest tail ends.
    ///
    /// # Errors
    /// A table that is no sieve curve, as [`read_gradation`] says.
    pub fn gradation(&self, d0_mm: Option<f64>) -> Result<Gradation, GradationError> {
        // Lines are counted anew: of two parts that stand side by side they are the same.
        let counted = |(index, row): (usize, &Row)| Row { line: index + 1, ..*row };
        let rows = self.rows.iter().enumerate().map(counted).collect();
        let in_sheet = matches!(self.kind, Kind::Rows | Kind::Across { sheet: true });
        let place = |row: usize, percent: bool| {
            let place = self.places[row - 1][usize::from(percent)];
            (place.line, in_sheet.then_some(place.column as u32))
        };
        from_rows(&self.file, rows, d0_mm).map_err(|error| match error {
            GradationError::Table(error) => error.placed(place, |row| self.said(row)).into(),
            error => error,
        })
    }

    /// What a row is called, counted from 1.
    fn said(&self, row: usize) -> String {
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
