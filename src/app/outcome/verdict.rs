//! Verdict: the paper's three classes, by mass eroded in the first and the second run.
//!
//! | first run | second run | verdict |
//! |---|---|---|
//! | < 7.5 % | | no erosion |
//! | >= 7.5 % | < 7.5 % | some erosion |
//! | >= 7.5 % | >= 7.5 % | continuing erosion |
//!
//! With replicates, a run is above or below the threshold if the whole 95 % interval of its mean is. The
//! verdict is *undecided* if an interval straddles the threshold, or if a second run that would decide is
//! missing.

use super::record::{CurveEnd, CurveRange, Outcome, RunSummary, Statistic, Verdict};
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;

/// Eroded mass fraction that divides the classes (paper, section 6).
pub(crate) const THRESHOLD: f64 = 0.075;

/// True for a run below the threshold, false for one above; `None` if open.
pub(crate) type BelowThreshold = Option<bool>;

/// Classifies two runs; the second may be missing.
pub(crate) fn classify(first: BelowThreshold, second: BelowThreshold) -> Verdict {
    match (first, second) {
        (Some(true), _) => Verdict::None,
        (Some(false), Some(true)) => Verdict::Some,
        (Some(false), Some(false)) => Verdict::Continuing,
        _ => Verdict::Undecided,
    }
}

/// Class by the sides of one or two runs.
pub(super) fn class_of(below: &[BelowThreshold]) -> Verdict {
    classify(below.first().copied().flatten(), below.get(1).copied().flatten())
}

/// True if less than 7.5 % eroded, by exact comparison: `eroded * 40 < inserted * 3`.
pub(crate) fn below_by_mass(eroded: f64, inserted: f64) -> bool {
    eroded * 40.0 < inserted * 3.0
}

/// True if less than 7.5 % eroded, for particles of one size: exact, on integers.
pub(crate) fn below_by_count(eroded: u64, inserted: u64) -> bool {
    u128::from(eroded) * 40 < u128::from(inserted) * 3
}

/// Side of the mean over replicates: the side of its whole interval. For a single replicate, or for
/// replicates of equal value, their exact side `is_below` decides, so that rounding of a mean decides
/// nothing.
pub(crate) fn below_by_interval(statistic: &Statistic, is_below: &[bool]) -> BelowThreshold {
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

/// Cause that leaves a verdict undecided.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "cli", derive(schemars::JsonSchema))]
pub enum UndecidedBy {
    /// The ends of the constriction curve's range give another class than the curve itself.
    #[serde(rename = "constriction curve")]
    Curve,
    /// A second run, which was not requested, would tell the classes apart.
    #[serde(rename = "second run")]
    SecondRun,
    /// The replicates do not separate the classes.
    #[serde(rename = "replicates")]
    Replicates,
}

impl UndecidedBy {
    /// Every cause.
    pub(crate) const ALL: [Self; 3] = [Self::Curve, Self::SecondRun, Self::Replicates];
}

impl Outcome {
    /// Cause that leaves the verdict undecided; `None` if it is decided.
    pub(crate) fn undecided_by(&self) -> Option<UndecidedBy> {
        if self.model.class != Verdict::Undecided {
            return None;
        }
        let erodes = |run: &RunSummary| {
            let eroded = &run.eroded_mass_fraction;
            eroded.low.unwrap_or(eroded.mean) >= self.threshold
        };
        let leaves_open =
            |range: &CurveRange| range.whole() == Verdict::Undecided && range.verdict != Verdict::Undecided;
        Some(if self.curve_range.as_ref().is_some_and(leaves_open) {
            UndecidedBy::Curve
        } else if self.summary.len() == 1 && self.summary.iter().all(erodes) {
            UndecidedBy::SecondRun
        } else {
            UndecidedBy::Replicates
        })
    }
}

/// Verdict of replicates that are also walked at the ends of the range of the curve.
///
/// If the ends of a guess differ, the verdict is undecided. The ends of a filter from the library are its
/// coarsest and finest possible constrictions, loose or dense: the worst class is its verdict, which is
/// on the safe side. A walk with an open class that could be worse leaves the verdict undecided.
impl CurveRange {
    /// Builds the range of a verdict whose own curve gives `verdict` and `runs`; `None` without ends.
    pub fn new(
        verdict: Verdict,
        runs: &[Statistic],
        ends: Vec<CurveEnd>,
        worst_counts: bool,
        could_be: Option<Verdict>,
    ) -> Option<Self> {
        if ends.is_empty() {
            return None;
        }
        let of_run = |run: usize| {
            let all =
                ends.iter().map(|end| &end.walked.runs).filter_map(|runs| runs.get(run)).chain([&runs[run]]);
            all.fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], s| {
                [low.min(s.low.unwrap_or(s.mean)), high.max(s.high.unwrap_or(s.mean))]
            })
        };
        let eroded_mass_fraction = (0..runs.len()).map(of_run).collect();
        Some(Self { verdict, ends, worst_counts, could_be, eroded_mass_fraction })
    }

    /// Class that the whole range supports.
    pub(crate) fn whole(&self) -> Verdict {
        match self.agrees() {
            true => self.verdict,
            false if self.worst_counts => self.worst(),
            false => Verdict::Undecided,
        }
    }

    /// Worst class of the range; undecided if a walk with an open class could be worse.
    fn worst(&self) -> Verdict {
        let all = || self.ends.iter().map(|end| end.walked.verdict).chain([self.verdict]);
        let decided = [Verdict::Continuing, Verdict::Some, Verdict::None];
        let worst = decided.into_iter().find(|class| all().any(|verdict| verdict == *class));
        let is_open = all().any(|verdict| verdict == Verdict::Undecided);
        let above =
            |run: usize| self.eroded_mass_fraction.get(run).is_none_or(|[_, high]| *high >= THRESHOLD);
        // Worst class that the intervals of the whole range allow.
        let could_be = self.could_be.unwrap_or_else(|| classify(Some(!above(0)), Some(!above(1))));
        match worst {
            Some(Verdict::Continuing) => Verdict::Continuing,
            Some(worst) if !is_open || worst == could_be => worst,
            _ => Verdict::Undecided,
        }
    }

    /// True if the ends have the class of the curve itself.
    pub(crate) fn agrees(&self) -> bool {
        self.ends.iter().all(|end| end.walked.verdict == self.verdict)
    }
}

/// Runs of replicates received so far, in any order.
#[derive(Clone, Debug, Default)]
pub(crate) struct SoFar {
    /// Eroded mass, and true if it is below the threshold, by replicate and run.
    walked: BTreeMap<u64, BTreeMap<u64, (f64, bool)>>,
}

/// Look at the complete replicates. It is not a verdict: more replicates follow, and an interval that is
/// looked at repeatedly lies on the wrong side more often than its level states.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct FirstLook {
    /// Number of complete replicates.
    pub(crate) replicates: usize,
    /// Class that their intervals support; undecided if they support none.
    pub(crate) class: Verdict,
    /// Eroded mass fraction, one per run.
    pub(crate) eroded: Vec<Statistic>,
}

impl SoFar {
    /// Adds a run of a replicate, both counted from 1.
    pub(crate) fn add(&mut self, replicate: u64, run: u64, eroded_mass_fraction: f64, below_threshold: bool) {
        self.walked.entry(replicate).or_default().insert(run, (eroded_mass_fraction, below_threshold));
    }

    /// Looks at the replicates that have `runs` runs; `None` until one is complete.
    pub(crate) fn look(&self, runs: u64) -> Option<FirstLook> {
        let is_whole = |walked: &&BTreeMap<u64, (f64, bool)>| (1..=runs).all(|run| walked.contains_key(&run));
        let whole: Vec<_> = self.walked.values().filter(is_whole).collect();
        if whole.is_empty() {
            return None;
        }
        let (mut below, mut eroded) = (Vec::new(), Vec::new());
        for run in 1..=runs {
            let (values, is_below): (Vec<f64>, Vec<bool>) = whole.iter().map(|walked| walked[&run]).unzip();
            let statistic = Statistic::of_fraction(&values);
            below.push(below_by_interval(&statistic, &is_below));
            eroded.push(statistic);
        }
        Some(FirstLook { replicates: whole.len(), class: class_of(&below), eroded })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::outcome::record::Classed;

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

    fn range(verdict: Verdict, ends: &[(f64, Verdict)], worst_counts: bool) -> CurveRange {
        let (sd, low, high) = (Some(0.01), |mean: f64| Some(mean - 0.01), |mean: f64| Some(mean + 0.01));
        let statistic = |mean: f64| Statistic { mean, sd, low: low(mean), high: high(mean) };
        let end = |&(dc50_factor, verdict): &(f64, Verdict)| {
            let runs = vec![statistic(0.09), statistic(0.02)];
            let walked = Classed { replicates: 5, stopped_when_clear: false, verdict, runs };
            CurveEnd { curve: format!("times {dc50_factor}"), dc50_factor, walked }
        };
        let ends = ends.iter().map(end).collect();
        CurveRange::new(verdict, &[statistic(0.05), statistic(0.04)], ends, worst_counts, None).unwrap()
    }

    #[test]
    fn a_range_supports_what_its_curves_agree_on() {
        let agreed = range(Verdict::None, &[(1.02, Verdict::None)], false);
        assert_eq!(agreed.whole(), Verdict::None);
        for (actual, wanted) in agreed.eroded_mass_fraction.iter().flatten().zip([0.04, 0.10, 0.01, 0.05]) {
            assert!((actual - wanted).abs() < 1e-12, "{agreed:?}");
        }
        let open = range(Verdict::None, &[(1.02, Verdict::Some)], false);
        assert_eq!(open.whole(), Verdict::Undecided);
        assert_eq!(CurveRange::new(Verdict::None, &[], Vec::new(), false, None), None);
    }

    #[test]
    fn of_a_filter_from_the_library_the_worst_class_counts() {
        use Verdict::{Continuing, None, Some, Undecided};
        let whole = |curve, coarse, fine| range(curve, &[(1.03, coarse), (0.8, fine)], true).whole();
        assert_eq!(whole(None, None, None), None);
        assert_eq!(whole(Some, Some, None), Some);
        assert_eq!(whole(None, Some, None), Some);
        assert_eq!(whole(Some, Continuing, None), Continuing);
        // At most 10 % and 5 % erode in the two runs: the open class is some erosion at worst.
        assert_eq!(whole(Undecided, Some, Undecided), Some);
        assert_eq!(whole(None, None, Undecided), Undecided);
        assert_eq!(whole(None, Undecided, None), Undecided);
        assert_eq!(whole(Continuing, Undecided, None), Continuing);
        // At another level other intervals determine the open classes.
        let mut range = range(Undecided, &[(1.03, Some), (0.8, Undecided)], true);
        for (worst, expected) in [(Some, Some), (Continuing, Undecided)] {
            range.could_be = std::option::Option::Some(worst);
            assert_eq!(range.whole(), expected);
        }
    }

    #[test]
    fn only_whole_replicates_count() {
        let mut so_far = SoFar::default();
        assert_eq!(so_far.look(2), None);
        so_far.add(2, 1, 0.5, false);
        assert_eq!(so_far.look(2), None, "half a replicate");
        so_far.add(2, 2, 0.01, true);
        so_far.add(1, 1, 0.52, false);
        let one = so_far.look(2).unwrap();
        assert_eq!((one.replicates, one.class), (1, Verdict::Some));
        so_far.add(1, 2, 0.011, true);
        let two = so_far.look(2).unwrap();
        assert_eq!((two.replicates, two.class), (2, Verdict::Some));
        // Values far apart support no class.
        so_far.add(3, 1, 0.0, true);
        so_far.add(3, 2, 0.9, false);
        assert_eq!(so_far.look(2).unwrap().class, Verdict::Undecided);
    }
}
