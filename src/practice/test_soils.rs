//! Soils for tests, here and in the program.

use voidwalk_core::Gradation;

/// Curve through these points: size (mm) and percent finer.
pub(crate) fn curve(points: &[(f64, f64)]) -> Gradation {
    Gradation::from_lines(points).unwrap()
}

/// Soil with one curve through these points.
pub(crate) fn soil(points: &[(f64, f64)]) -> Vec<(String, Gradation)> {
    vec![("soil".to_owned(), curve(points))]
}

/// Uniform filter with this D15F (mm).
pub(crate) fn filter(d15f: f64) -> Vec<(String, Gradation)> {
    soil(&[(0.9 * d15f, 0.0), (d15f, 15.0), (2.0 * d15f, 100.0)])
}

pub(crate) const SAND: [(f64, f64); 2] = [(0.2, 0.0), (0.6, 100.0)];

pub(crate) const CORE: [(f64, f64); 3] = [(0.002, 0.0), (0.075, 60.0), (2.0, 100.0)];

/// A clay with a D85B of 0.05 mm and 90 % fines, and a clean sand with a D85B of 0.5 mm.
pub(crate) const DESIGN_CLAY: [(f64, f64); 5] =
    [(0.001, 0.0), (0.02, 60.0), (0.05, 85.0), (0.075, 90.0), (0.3, 100.0)];
pub(crate) const DESIGN_SAND: [(f64, f64); 4] = [(0.1, 0.0), (0.2, 15.0), (0.5, 85.0), (1.0, 100.0)];

/// The till of the first trial: 35 % finer than 0.075 mm, 92 % finer than 4.75 mm.
pub(crate) const TILL: [(f64, f64); 5] =
    [(0.075, 35.0), (0.425, 60.0), (2.0, 82.0), (4.75, 92.0), (19.0, 100.0)];

/// A fat clay with a D85B of 0.0185 mm.
pub(crate) const CLAY: [(f64, f64); 6] =
    [(0.002, 52.0), (0.005, 66.0), (0.01, 77.0), (0.02, 86.0), (0.04, 93.0), (0.425, 100.0)];

/// A soil with 37 % fines and a D85B of 1.40 mm.
pub(crate) const SILTY: [(f64, f64); 6] =
    [(0.005, 13.0), (0.075, 37.0), (0.25, 60.0), (0.85, 78.0), (2.0, 90.0), (4.75, 100.0)];

/// A till with 28 % fines (37.8 % regraded on No. 4): limits 1.26 mm (design) and 0.700 mm (no erosion).
pub(crate) const REGRADED_TILL: [(f64, f64); 9] = [
    (0.075, 28.0),
    (0.15, 37.0),
    (0.425, 48.0),
    (0.85, 55.0),
    (2.0, 64.0),
    (4.75, 74.0),
    (9.5, 82.0),
    (19.0, 89.0),
    (37.5, 100.0),
];

/// A gravel of 0 to 32 mm that is not internally stable by three of four criteria.
pub(crate) const GRAVEL_0_32: [(f64, f64); 11] = [
    (0.075, 2.0),
    (0.125, 4.0),
    (0.25, 8.0),
    (0.5, 13.0),
    (1.0, 20.0),
    (2.0, 27.0),
    (4.0, 36.0),
    (8.0, 48.0),
    (16.0, 70.0),
    (31.5, 95.0),
    (37.5, 100.0),
];

/// Li and Fannin's index is worst at F = 4 %, where a step in the curve leaves little to be lost. At
/// 14 %, where it is 0.993, much more is lost, and the D15F of the remainder exceeds 4.00 and 7.00 mm.
pub(crate) const STEPPED: [(f64, f64); 8] =
    [(0.1, 0.0), (0.2, 4.0), (0.8, 4.0), (1.0, 4.5), (2.0, 14.0), (8.0, 27.9), (16.0, 60.0), (32.0, 100.0)];

pub(crate) const SAND_OF_1_MM: [(f64, f64); 4] = [(0.2, 0.0), (0.5, 40.0), (1.0, 85.0), (2.0, 100.0)];
