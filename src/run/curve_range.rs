//! Walks a case at the ends of the range in which its constriction curve is known.

use super::error::RunError;
use super::replicates::{ReplicateContext, ReplicateResult, classed, some_replicates, stopping, summarise};
use crate::case::Case;
use crate::outcome::record::{CurveEnd, CurveRange};

/// Walks as many replicates as were walked with the curve itself at each end of its range, on the same random
/// numbers; `None` where the curve is no range.
///
/// # Errors
/// As [`super::replicates::replicates`].
pub fn curve_range(
    case: &Case,
    walked: &[ReplicateResult],
    context: &ReplicateContext,
) -> Result<Option<CurveRange>, RunError> {
    // The parts before these are the sensitivity study's and the other readings'.
    let parts = (case.sensitivity_factors().len() + case.other_readings.len()) as u64 + 1..;
    let own = case.curve.dc(50.0).unwrap_or(f64::NAN);
    let mut ends = Vec::new();
    for (part, end) in parts.zip(&case.curve_ends) {
        let dc50_factor = end.curve.dc(50.0).unwrap_or(f64::NAN) / own;
        let other = case.with_curve(end.curve.clone());
        // What a user or a cap says of the amount of base holds for every curve.
        let by_grains = case.n_base_eq2 == Some(case.n_base);
        let times = if by_grains { end.times_grains } else { 1.0 };
        let n_base = case.times_base(times);
        let of_end = some_replicates(&other, part, 1..=walked.len() as u64, n_base, context)?;
        ends.push(CurveEnd { curve: end.name.clone(), dc50_factor, walked: classed(&of_end) });
    }
    let (verdict, summaries) = summarise(walked);
    // A verdict that was to be certain is one at the level asked for, here too.
    let verdict = stopping(case, walked).and_then(|stopping| stopping.verdict).unwrap_or(verdict);
    let runs: Vec<_> = summaries.iter().map(|s| s.eroded_mass_fraction).collect();
    Ok(CurveRange::new(verdict, &runs, ends, case.library.is_some()))
}
