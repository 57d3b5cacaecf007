//! The verdict where the constriction curve is known only within a range: the same replicates are walked at
//! the range's ends, too.
//!
//! If the ends of a guess differ, the verdict is undecided. The ends of a filter from the library are the
//! coarsest and the finest constrictions that it may have, loose or dense: the worst class is its verdict,
//! which errs on the safe side. A walk with an open class that could be worse leaves the verdict undecided.

use super::record::{CurveEnd, CurveRange, Statistic, Verdict};
use super::verdict::THRESHOLD;

impl CurveRange {
    /// The range of a verdict whose own curve gives `verdict` and `runs`; `None` without ends.
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

    /// The class that the whole range supports.
    pub fn whole(&self) -> Verdict {
        match self.agrees() {
            true => self.verdict,
            false if self.worst_counts => self.worst(),
            false => Verdict::Undecided,
        }
    }

    /// The worst class of the range; undecided if a walk with an open class could be of a worse one.
    fn worst(&self) -> Verdict {
        let all = || self.ends.iter().map(|end| end.walked.verdict).chain([self.verdict]);
        let decided = [Verdict::Continuing, Verdict::Some, Verdict::None];
        let worst = decided.into_iter().find(|class| all().any(|verdict| verdict == *class));
        let is_open = all().any(|verdict| verdict == Verdict::Undecided);
        match worst {
            Some(Verdict::Continuing) => Verdict::Continuing,
            Some(worst) if !is_open || worst == self.could_be() => worst,
            _ => Verdict::Undecided,
        }
    }

    /// The worst class that the intervals of the whole range allow.
    fn could_be(&self) -> Verdict {
        if let Some(worst) = self.could_be {
            return worst;
        }
        let above =
            |run: usize| self.eroded_mass_fraction.get(run).is_none_or(|[_, high]| *high >= THRESHOLD);
        match (above(0), above(1)) {
            (false, _) => Verdict::None,
            (true, false) => Verdict::Some,
            (true, true) => Verdict::Continuing,
        }
    }

    /// Tells if the range leaves the class open that the curve itself gives.
    pub fn leaves_open(&self) -> bool {
        self.whole() == Verdict::Undecided && self.verdict != Verdict::Undecided
    }

    /// Tells if the ends have the class of the curve itself.
    pub fn agrees(&self) -> bool {
        self.ends.iter().all(|end| end.walked.verdict == self.verdict)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::outcome::record::Classed;

    fn range(verdict: Verdict, end: Verdict) -> CurveRange {
        range_with(verdict, &[(1.02, end)], false)
    }

    fn range_with(verdict: Verdict, ends: &[(f64, Verdict)], worst_counts: bool) -> CurveRange {
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
        let agreed = range(Verdict::None, Verdict::None);
        assert_eq!(agreed.whole(), Verdict::None);
        for (actual, wanted) in agreed.eroded_mass_fraction.iter().flatten().zip([0.04, 0.10, 0.01, 0.05]) {
            assert!((actual - wanted).abs() < 1e-12, "{agreed:?}");
        }
        let open = range(Verdict::None, Verdict::Some);
        assert_eq!(open.whole(), Verdict::Undecided);
        assert_eq!(CurveRange::new(Verdict::None, &[], Vec::new(), false, None), None);
    }

    #[test]
    fn of_a_filter_from_the_library_the_worst_class_counts() {
        use Verdict::{Continuing, None, Some, Undecided};
        let whole = |curve, coarse, fine| range_with(curve, &[(1.03, coarse), (0.8, fine)], true).whole();
        assert_eq!(whole(None, None, None), None);
        assert_eq!(whole(Some, Some, None), Some);
        assert_eq!(whole(None, Some, None), Some);
        assert_eq!(whole(Some, Continuing, None), Continuing);
        // Up to 10 % erode in the first run and 5 % in the second: the open class is some erosion at most.
        assert_eq!(whole(Undecided, Some, Undecided), Some);
        assert_eq!(whole(None, None, Undecided), Undecided);
        assert_eq!(whole(None, Undecided, None), Undecided);
        assert_eq!(whole(Continuing, Undecided, None), Continuing);
        // At another level other intervals determine the open classes.
        let mut range = range_with(Undecided, &[(1.03, Some), (0.8, Undecided)], true);
        for (worst, expected) in [(Some, Some), (Continuing, Undecided)] {
            range.could_be = std::option::Option::Some(worst);
            assert_eq!(range.whole(), expected);
        }
    }
}
