//! A soil as it stands in a file: its table, and what was assumed to read it.

use crate::gradation::error::GradationError;
use crate::gradation::sieve::{Gradation, from_rows};
use crate::gradation::table::Row;

/// A soil as it stands in a file.
#[derive(Clone, Debug)]
pub struct Soil {
    pub(super) name: String,
    pub(super) file: String,
    pub(super) rows: Vec<Row>,
    pub(super) notes: Vec<String>,
    /// Columns of a sheet: openings, percents.
    pub(super) columns: Option<[u32; 2]>,
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
    /// A table that is no sieve curve, as [`Gradation::from_sieve_csv`] says.
    pub fn gradation(&self, d0_mm: Option<f64>) -> Result<Gradation, GradationError> {
        from_rows(&self.file, self.rows.clone(), d0_mm).map_err(|error| match (error, self.columns) {
            (GradationError::Table(error), Some(columns)) => error.in_sheet(columns).into(),
            (error, _) => error,
        })
    }
}
