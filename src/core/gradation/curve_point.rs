//! A point of a curve, with names: a gradation and a constriction curve list size and percent in opposite
//! orders.

use serde::Serialize;

/// Relative difference allowed between two ways of writing the numbers of one curve.
pub const TIE: f64 = 1e-9;

/// A point of a gradation or of a constriction curve; in JSON a row of size and percent.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
#[serde(into = "[f64; 2]")]
pub struct CurvePoint {
    /// Diameter of a particle or constriction, in the unit of the curve: mm for a gradation.
    pub size: f64,
    /// Percent finer by mass, or smaller by number.
    pub percent: f64,
}

impl CurvePoint {
    /// Row of a record: size, percent.
    pub fn row(self) -> [f64; 2] {
        [self.size, self.percent]
    }
}

impl From<CurvePoint> for [f64; 2] {
    fn from(point: CurvePoint) -> Self {
        point.row()
    }
}
