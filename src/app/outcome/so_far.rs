//! Interim result of a run that is under way, from its complete replicates.

use std::collections::BTreeMap;

use super::record::{Statistic, Verdict};
use super::verdict::{below_by_interval, classify};

/// Runs of replicates as they come, in any order.
#[derive(Clone, Debug, Default)]
pub struct SoFar {
    /// Mass eroded, and true if it is below the threshold, by run and replicate.
    walked: BTreeMap<u64, BTreeMap<u64, (f64, bool)>>,
}

/// A look at the complete replicates. It is not a verdict: more replicates follow, and an interval that is
/// looked at repeatedly lies on the wrong side more often than its level states.
#[derive(Clone, Debug, PartialEq)]
pub struct FirstLook {
    /// Number of complete replicates.
    pub replicates: usize,
    /// The class that their intervals support; undecided if they support none.
    pub class: Verdict,
    /// Eroded mass fraction, one per run.
    pub eroded: Vec<Statistic>,
}

impl SoFar {
    /// Takes a run of a replicate, both counted from 1.
    pub fn add(&mut self, replicate: u64, run: u64, eroded_mass_fraction: f64, below_threshold: bool) {
        self.walked.entry(run).or_default().insert(replicate, (eroded_mass_fraction, below_threshold));
    }

    /// The replicates that have `runs` runs; `None` until one replicate is complete.
    pub fn look(&self, runs: u64) -> Option<FirstLook> {
        let whole = |replicate: &&u64| {
            (1..=runs)
                .all(|run| self.walked.get(&run).is_some_and(|replicates| replicates.contains_key(replicate)))
        };
        let replicates: Vec<u64> = self.walked.get(&1)?.keys().filter(whole).copied().collect();
        if replicates.is_empty() {
            return None;
        }
        let (mut below, mut eroded) = (Vec::new(), Vec::new());
        for run in 1..=runs {
            let results = &self.walked[&run];
            let (values, is_below): (Vec<f64>, Vec<bool>) = replicates.iter().map(|r| results[r]).unzip();
            let statistic = Statistic::of_fraction(&values);
            below.push(below_by_interval(&statistic, &is_below));
            eroded.push(statistic);
        }
        let class = classify(below.first().copied().flatten(), below.get(1).copied().flatten());
        Some(FirstLook { replicates: replicates.len(), class, eroded })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

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
        // Far apart, they support no class.
        so_far.add(3, 1, 0.0, true);
        so_far.add(3, 2, 0.9, false);
        assert_eq!(so_far.look(2).unwrap().class, Verdict::Undecided);
    }
}
