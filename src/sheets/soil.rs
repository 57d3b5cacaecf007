//! A soil as given in a file: its table, and the assumptions made when reading it.

use super::grid::Place;
use serde::Serialize;
use voidwalk_core::gradation::{
    CurvePoint, FINES_MM, GRAVEL_MM, Gradation, GradationError, Row, from_rows, letters,
};

/// A soil as given in a file.
#[derive(Clone, Debug)]
pub struct Soil {
    pub(super) name: String,
    pub(super) file: String,
    pub(super) rows: Vec<Row>,
    /// Places of the opening and the percent of each row.
    pub(super) places: Vec<[Place; 2]>,
    /// True for a table in a sheet, false for one in a text.
    pub(super) in_sheet: bool,
    /// True for a table across, with a column per sieve.
    pub(super) across: bool,
    pub(super) notes: Vec<String>,
}

impl Soil {
    /// Name from the sheet or the column; empty if there is none.
    pub fn name(&self) -> &str {
        &self.name
    }

    /// Assumptions, in words.
    pub fn notes(&self) -> &[String] {
        &self.notes
    }

    /// Sieve curve; `d0_mm` is the smallest size of a pan fraction.
    ///
    /// # Errors
    /// A table that is not a sieve curve, with the errors of [`read_gradation`](crate::read_gradation).
    pub fn gradation(&self, d0_mm: Option<f64>) -> Result<Gradation, GradationError> {
        // Counts rows from 1: lines of the file repeat in parts that are side by side.
        let counted = |(index, row): (usize, &Row)| Row { line: index + 1, ..*row };
        let rows = self.rows.iter().enumerate().map(counted).collect();
        let place = |row: usize, percent: bool| {
            let place = self.places[row - 1][usize::from(percent)];
            (place.line, self.in_sheet.then_some(place.column as u32))
        };
        from_rows(&self.file, rows, d0_mm).map_err(|error| match error {
            GradationError::Table(error) => error.placed(place, |row| self.row_label(row)).into(),
            error => error,
        })
    }

    fn row_label(&self, row: usize) -> String {
        let Place { line, column } = self.places[row - 1][1];
        let letters = letters(column as u32);
        let is_split = || self.places.iter().any(|places| places[1].column != column);
        match (self.across, self.in_sheet) {
            (true, true) => format!("column {letters}"),
            (true, false) => format!("column {}", column + 1),
            (false, true) if is_split() => format!("cell {letters}{line}"),
            (false, true) => format!("row {line}"),
            (false, false) => format!("line {line}"),
        }
    }
}

/// A soil as read from a file, and values from its curve.
#[derive(Clone, Debug, Serialize)]
#[cfg_attr(feature = "schemas", derive(schemars::JsonSchema))]
pub struct SoilSummary {
    /// Name of its sheet or column, or of the file.
    pub name: String,
    /// Opening (mm) and percent finer by mass; sizes rise.
    #[cfg_attr(feature = "schemas", schemars(with = "Vec<[f64; 2]>"))]
    pub points: Vec<CurvePoint>,
    /// D5 (mm); this and the others are `None` if they lie below the finest opening.
    pub d5_mm: Option<f64>,
    /// D10 (mm).
    pub d10_mm: Option<f64>,
    /// D15 (mm).
    pub d15_mm: Option<f64>,
    /// D30 (mm).
    pub d30_mm: Option<f64>,
    /// D50 (mm).
    pub d50_mm: Option<f64>,
    /// D60 (mm).
    pub d60_mm: Option<f64>,
    /// D85 (mm).
    pub d85_mm: Option<f64>,
    /// D90 (mm).
    pub d90_mm: Option<f64>,
    /// D95 (mm).
    pub d95_mm: Option<f64>,
    /// D100 (mm).
    pub d100_mm: Option<f64>,
    /// D60 / D10.
    pub cu: Option<f64>,
    /// D30^2 / (D60 D10).
    pub cc: Option<f64>,
    /// Percent finer than 0.075 mm.
    pub fines_percent: Option<f64>,
    /// Percent coarser than 4.75 mm.
    pub gravel_percent: Option<f64>,
    /// Group of ASTM D2487, as far as a sieve curve determines it.
    pub class: Option<String>,
    /// Assumptions made when it was read.
    pub notes: Vec<String>,
}

impl SoilSummary {
    /// Summarises `soil`; `d0_mm` is the smallest size of a pan fraction.
    ///
    /// # Errors
    /// A table that is not a sieve curve.
    pub fn of(soil: &Soil, d0_mm: Option<f64>) -> Result<SoilSummary, GradationError> {
        let curve = soil.gradation(d0_mm)?;
        let d = |percent| curve.d(percent);
        let fines_percent = curve.percent_finer_if_known(FINES_MM);
        let gravel_percent = curve.percent_finer_if_known(GRAVEL_MM).map(|percent| 100.0 - percent);
        Ok(SoilSummary {
            name: soil.name().to_owned(),
            points: curve.points(),
            d5_mm: d(5.0),
            d10_mm: d(10.0),
            d15_mm: d(15.0),
            d30_mm: d(30.0),
            d50_mm: d(50.0),
            d60_mm: d(60.0),
            d85_mm: d(85.0),
            d90_mm: d(90.0),
            d95_mm: d(95.0),
            d100_mm: d(100.0),
            cu: curve.cu(),
            cc: curve.cc(),
            fines_percent,
            gravel_percent,
            class: curve.group_in_words(),
            notes: soil.notes().to_vec(),
        })
    }
}
