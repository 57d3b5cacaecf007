//! Walks a case with filters of other thicknesses.

use super::error::RunError;
use super::replicates::{ReplicateContext, ReplicateResult, some_replicates, summarise};
use crate::case::Case;
use crate::outcome::record::OfThickness;

/// How the verdict moves with the thickness of the filter, on the random numbers of the first replicates: a
/// lattice's first layers are those of the case itself. The case itself is among the rows; no rows where the
/// study is left out.
///
/// # Errors
/// As [`super::replicates::replicates`].
pub fn thicknesses(
    case: &Case,
    walked: &[ReplicateResult],
    context: &ReplicateContext,
) -> Result<Vec<OfThickness>, RunError> {
    let each = case.scene.record.sensitivity_replicates;
    let mut rows = Vec::new();
    for (factor, part) in case.thickness_factors().into_iter().zip(first_part(case)..) {
        // What cannot be is said among what is left out.
        let Ok(other) = case.of_thickness(factor) else { continue };
        let of_other = some_replicates(&other, part, 1..=each, other.n_base, context)?;
        rows.push(row(&other, case, &of_other));
    }
    if !rows.is_empty() {
        rows.push(row(case, case, walked));
        rows.sort_by_key(|row| row.layers);
    }
    Ok(rows)
}

/// The parts before are those of the study of the number of base particles, of the other reading, and of the
/// ends of the curve's range.
fn first_part(case: &Case) -> u64 {
    (case.sensitivity_factors().len() + 2 + case.curve_ends().len()) as u64
}

fn row(of: &Case, case: &Case, walked: &[ReplicateResult]) -> OfThickness {
    let (verdict, summaries) = summarise(walked);
    OfThickness {
        factor: of.counts[3] as f64 / case.counts[3] as f64,
        layers: of.counts[3],
        thickness_mm: of.thickness(),
        n_base: of.n_base,
        replicates: walked.len() as u64,
        verdict,
        runs: summaries.iter().map(|s| s.eroded_mass_fraction).collect(),
    }
}
