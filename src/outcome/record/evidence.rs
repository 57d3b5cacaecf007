//! What a verdict rests on beside its walk: the walk's boundary by that of tests, for soils of its kind.

use serde::{Deserialize, Serialize};

/// The evidence for a pair.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
pub struct Evidence {
    /// Group of soils by fines after regrading and by D85B/D50B, and of filters by Cu.
    pub group: String,
    /// Soils that the ratio rests on: those of which the walk has a boundary.
    pub soils: u64,
    /// Soils of the group of which the walk erodes in every filter; they have no ratio.
    #[serde(default)]
    pub soils_without_boundary: u64,
    /// Median over these soils of the walk's D15F of no erosion by the centre of the range of tests.
    pub ratio_median: f64,
    /// The ratio below which 5 % of the soils lie.
    pub ratio_low: f64,
    /// The ratio below which 95 % of the soils lie.
    pub ratio_high: f64,
    /// Whether there are at least 30 soils, nine in ten lie within a factor of 2 of the median, that is at
    /// most 1, 95 % do not lie beyond the range of tests, and all this holds with any tenth of the soils left
    /// out.
    pub narrow: bool,
    /// The range in which tests of soils with such fines had their boundary, as D15F (mm).
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub range_of_tests_mm: Option<[f64; 2]>,
    /// D15F from which the walk erodes this base (mm); beyond it or below it where `bound` says so; `None`
    /// where the group is not narrow, and it was not looked for.
    pub boundary_d15f_mm: Option<f64>,
    /// The probability that a test of this pair would show no erosion, by the walk; `None` where the group
    /// is not narrow.
    pub probability_no_erosion: Option<f64>,
    /// The same by the range of tests alone: the part of it that lies beyond the filter's D15F, taken as
    /// uniform in its logarithm.
    pub probability_by_tests: Option<f64>,
    /// Where the walk's boundary was not found: on which side of its number, and of the probability, it lies.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub bound: Option<Bound>,
}

/// A number that is known to be at least, or at most, so much.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
#[serde(rename_all = "snake_case")]
pub enum Bound {
    /// It is at least this.
    AtLeast,
    /// It is at most this.
    AtMost,
}
