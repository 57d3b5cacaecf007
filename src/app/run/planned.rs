//! Number of replicates and runs that are walked, as far as it is known before.

use crate::case::Case;
use crate::outcome::early_stop::{FEWEST_OF_RANGE, FEWEST_OWN, clear, looks};
use crate::outcome::stopping::ReplicateValues;
use crate::outcome::verdict::{THRESHOLD, classify};

/// Number of runs that are walked for a case: its own, and those of the ends of its curve's range and of its
/// studies, as far as it is known before.
pub fn runs_to_walk(case: &Case) -> u64 {
    let first = first_replicates(case);
    let of_ends = replicates_of_end(first) * case.filter.curve_ends.len() as u64;
    let points = (case.sensitivity_factors().len() + case.thickness_factors().len()) as u64;
    case.scene.walk.runs * (first + of_ends + points * replicates_at_least(case))
}

/// Replicates of a case as far as it is known before it is walked.
pub(super) fn first_replicates(case: &Case) -> u64 {
    let (rule, replicates) = (&case.scene.stop, case.scene.walk.replicates);
    if rule.is_set() { rule.replicates_at(replicates, 1) } else { replicates }
}

/// Least number of replicates of an end of the curve's range, for this many of the case.
pub(super) fn replicates_of_end(of_case: u64) -> u64 {
    if of_case >= FEWEST_OF_RANGE as u64 { 1 } else { of_case }
}

/// Replicates of each point that are walked at the least, as far as it is known before the case is walked.
pub(super) fn replicates_at_least(case: &Case) -> u64 {
    let most = case.scene.record.sensitivity_replicates;
    if first_replicates(case) >= FEWEST_OWN as u64 { most.min(1) } else { most }
}

/// Scatter of replicates over their mean before any walk: the value of the built-in scene.
const LIKELY_SCATTER: f64 = 0.05;

/// Replicates of a point that are likely to be walked, given the eroded mass of each run in a replicate of
/// the case and in one of the point; all of them if it is not known.
pub(super) fn likely_replicates(case: &Case, eroded: Option<(&[f64], &[f64])>) -> u64 {
    let most = case.scene.record.sensitivity_replicates;
    let Some((of_case, point)) = eroded else { return most };
    let several = |values: &[f64], replicates: u64| -> Vec<ReplicateValues> {
        let about = |&value: &f64| {
            let sign = |k: u64| if k.is_multiple_of(2) { -LIKELY_SCATTER } else { LIKELY_SCATTER };
            (0..replicates).map(|k| value * (1.0 + sign(k))).map(|v| (v, v < THRESHOLD)).collect()
        };
        values.iter().map(about).collect()
    };
    let below = |run: usize| of_case.get(run).map(|&eroded| eroded < THRESHOLD);
    let class = classify(below(0), below(1));
    let replicates = first_replicates(case);
    let of_case = several(of_case, replicates);
    let is_clear = |&look: &u64| clear(&of_case, class, &several(point, look)).is_some();
    let looks = looks(class, replicates as usize, most);
    looks.into_iter().find(is_clear).map_or(most, |look| look.min(most))
}
