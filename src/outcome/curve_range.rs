//! What a verdict is worth where the constriction curve is known within a range only: the same replicates are
//! walked at the range's ends, too.

use super::record::{CurveEnd, CurveRange, Statistic, Verdict};

impl CurveRange {
    /// The range of a verdict of which the curve itself gives `verdict` and `runs`; `None` without ends.
    pub fn new(verdict: Verdict, runs: &[Statistic], ends: Vec<CurveEnd>) -> Option<Self> {
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
        Some(Self { verdict, ends, eroded_mass_fraction })
    }

    /// The class that the whole range supports: undecided where its curves do not agree.
    pub fn whole(&self) -> Verdict {
        if self.agrees() { self.verdict } else { Verdict::Undecided }
    }

    /// Whether the ends have the class of the curve itself.
    pub fn agrees(&self) -> bool {
        self.ends.iter().all(|end| end.walked.verdict == self.verdict)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::outcome::record::Classed;

    fn range(verdict: Verdict, end: Verdict) -> CurveRange {
        let (sd, low, high) = (Some(0.01), |mean: f64| Some(mean - 0.01), |mean: f64| Some(mean + 0.01));
        let of = |mean: f64| Statistic { mean, sd, low: low(mean), high: high(mean) };
        let end = CurveEnd {
            curve: "2 % coarser".into(),
            dc50_factor: 1.02,
            walked: Classed {
                replicates: 5,
                stopped_when_clear: false,
                verdict: end,
                runs: vec![of(0.09), of(0.02)],
            },
        };
        CurveRange::new(verdict, &[of(0.05), of(0.04)], vec![end]).unwrap()
    }

    #[test]
    fn a_range_supports_what_its_curves_agree_on() {
        let agreed = range(Verdict::None, Verdict::None);
        assert_eq!(agreed.whole(), Verdict::None);
        for (found, wanted) in agreed.eroded_mass_fraction.iter().flatten().zip([0.04, 0.10, 0.01, 0.05]) {
            assert!((found - wanted).abs() < 1e-12, "{agreed:?}");
        }
        let open = range(Verdict::None, Verdict::Some);
        assert_eq!(open.whole(), Verdict::Undecided);
        assert_eq!(CurveRange::new(Verdict::None, &[], Vec::new()), None);
    }
}
