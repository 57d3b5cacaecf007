//! The verdict: the paper's three classes, by mass eroded in the first and the second run.
//!
//! | first run | second run | verdict |
//! |---|---|---|
//! | < 7.5 % | | no erosion |
//! | >= 7.5 % | < 7.5 % | some erosion |
//! | >= 7.5 % | >= 7.5 % | continuing erosion |
//!
//! With replicates a run lies above or below the threshold if its whole 95 % interval of the mean does; an
//! interval that straddles the threshold, or a missing second run that would decide, makes the verdict
//! *undecided*.

use super::record::{Statistic, Verdict};

/// Eroded mass fraction that divides the classes (paper, section 6).
pub const THRESHOLD: f64 = 0.075;

/// True for a run below the threshold, false for one above; `None` if open.
pub type BelowThreshold = Option<bool>;

/// The class of two runs; the second may be missing.
///
/// ```
/// use voidwalk_app::outcome::record::Verdict;
/// use voidwalk_app::outcome::verdict::{below_by_mass, classify};
/// // 9 % of the base eroded in the first run, 1 % in the second.
/// let [first, second] = [0.09, 0.01].map(|eroded| Some(below_by_mass(eroded, 1.0)));
/// assert_eq!(classify(first, second), Verdict::Some);
/// assert_eq!(classify(first, None), Verdict::Undecided);
/// ```
pub fn classify(first: BelowThreshold, second: BelowThreshold) -> Verdict {
    match (first, second) {
        (Some(true), _) => Verdict::None,
        (Some(false), Some(true)) => Verdict::Some,
        (Some(false), Some(false)) => Verdict::Continuing,
        _ => Verdict::Undecided,
    }
}

/// Tells if less than 7.5 % eroded, by exact comparison: `eroded * 40 < inserted * 3`.
pub fn below_by_mass(eroded: f64, inserted: f64) -> bool {
    eroded * 40.0 < inserted * 3.0
}

/// Tells if less than 7.5 % eroded, for particles of one size: exact, on integers.
pub fn below_by_count(eroded: u64, inserted: u64) -> bool {
    u128::from(eroded) * 40 < u128::from(inserted) * 3
}

/// The side of the mean over replicates: the side of its whole interval. `each` holds the exact side of every
/// replicate; it decides for a single replicate, or if the replicates agree in value, so that the rounding of
/// a mean decides nothing.
pub fn below_by_interval(statistic: &Statistic, is_below: &[bool]) -> BelowThreshold {
    let no_scatter = statistic.sd.is_none_or(|sd| sd < 1e-12);
    if no_scatter && is_below.iter().all(|&below| below == is_below[0]) {
        return is_below.first().copied();
    }
    match (statistic.low, statistic.high) {
        (_, Some(high)) if high < THRESHOLD => Some(true),
        (Some(low), _) if low >= THRESHOLD => Some(false),
        _ => None,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_three_classes_and_the_fourth() {
        assert_eq!(classify(Some(true), None), Verdict::None);
        assert_eq!(classify(Some(true), Some(false)), Verdict::None);
        assert_eq!(classify(Some(false), Some(true)), Verdict::Some);
        assert_eq!(classify(Some(false), Some(false)), Verdict::Continuing);
        assert_eq!(classify(Some(false), None), Verdict::Undecided);
        assert_eq!(classify(None, Some(true)), Verdict::Undecided);
    }

    #[test]
    fn exactly_seven_and_a_half_percent_is_not_less() {
        assert!(!below_by_count(3, 40));
        assert!(below_by_count(2, 40));
        assert!(!below_by_mass(0.3, 4.0));
        assert!(!below_by_count(3 << 60, 40 << 57 << 3));
    }

    #[test]
    fn an_interval_that_straddles_decides_nothing() {
        let s = |low, high| Statistic { mean: 0.07, sd: Some(0.01), low: Some(low), high: Some(high) };
        assert_eq!(below_by_interval(&s(0.01, 0.0749), &[true, false]), Some(true));
        assert_eq!(below_by_interval(&s(0.01, 0.075), &[true, true]), None);
        assert_eq!(below_by_interval(&s(0.075, 0.2), &[true, false]), Some(false));
        assert_eq!(below_by_interval(&Statistic::of(&[0.07]), &[true]), Some(true));
        // Ten times 0.075 has a mean below 0.075.
        let ten = Statistic::of(&[0.075; 10]);
        assert!(ten.mean < THRESHOLD);
        assert_eq!(below_by_interval(&ten, &[false; 10]), Some(false));
    }
}
