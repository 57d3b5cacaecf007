//! What a walk itself says against its verdict: a filter that clogged, particles that circle, a second run
//! that erodes more than the first.

use super::entry::Finding;
use super::finding;
use crate::gradation::Gradation;
use crate::outcome::digits::percent_span;
use crate::outcome::record::{Replicate, Run, Verdict};
use crate::outcome::verdict::THRESHOLD;

/// Less than this part of the clean filter's permeability is none: 0.0 % where it is shown.
const CLOGGED: f64 = 5e-4;

/// A walk as its doubts see it.
pub struct Walked<'a> {
    /// Its replicates.
    pub replicates: Vec<&'a Replicate>,
    /// Replicate, run and increment after which water was first found to flow no more; in order.
    pub clogged: Vec<[u64; 3]>,
    /// The base.
    pub base: &'a Gradation,
    /// Part of the base that an increment inserts.
    pub share: f64,
    /// Layers of the network.
    pub layers: u64,
    /// Whether blocked constrictions leave openings.
    pub openings: bool,
}

/// Whether so small a part of the clean filter's permeability is none at all. What openings let pass is
/// little, but water flows.
pub fn is_clogged(k_over_k0: f64, openings: bool) -> bool {
    k_over_k0 <= if openings { 0.0 } else { CLOGGED }
}

/// Why a class that does not erode for ever cannot be relied on, for what happened in its walk.
pub fn findings(verdict: Verdict, walked: &Walked) -> Vec<Finding> {
    // The first run tells "no erosion" from the others, the second "some" from "continuing".
    let run = match verdict {
        Verdict::None => 1,
        Verdict::Some | Verdict::Undecided => 2.min(walked.runs()),
        Verdict::Continuing => return Vec::new(),
    };
    let more = if verdict == Verdict::None { walked.more_in_the_second() } else { None };
    [walked.clogging(run), walked.trapping(run), more].into_iter().flatten().collect()
}

impl Walked<'_> {
    fn runs(&self) -> u64 {
        self.replicates.first().map_or(1, |replicate| replicate.runs.len() as u64)
    }

    fn of_run(&self, number: u64) -> impl Iterator<Item = &Run> {
        self.replicates.iter().flat_map(|of| &of.runs).filter(move |run| run.run == number)
    }

    /// That no water flowed any more at the end of the run that decides.
    ///
    /// From then on nothing moves: all that is on its way, at least what the last increments inserted, as
    /// many as there are layers, counts as retained.
    fn clogging(&self, run: u64) -> Option<Finding> {
        let all = self.of_run(run).count();
        let is_none = |k_over_k0| is_clogged(k_over_k0, self.openings);
        let clogged = self.of_run(run).filter(|run| run.k_over_k0.is_some_and(is_none)).count();
        if clogged == 0 {
            return None;
        }
        let which = if run == 1 { "first" } else { "second" };
        let of = if all == 1 { String::new() } else { format!(" in {clogged} of {all} replicates") };
        let inserted = |increment: u64| (increment as f64 * self.share).min(1.0);
        // The second run goes on with what the first left.
        let from_start = run == 2 && self.clogged.iter().any(|found| found[1] == 2 && found[2] == 0);
        if from_start {
            return Some(finding::clogged_before(&of, self.share / 10.0));
        }
        let after: Vec<f64> =
            self.clogged.iter().filter(|found| found[1] == run).map(|found| inserted(found[2])).collect();
        let least = after.iter().copied().fold(f64::INFINITY, f64::min);
        let most = after.iter().copied().fold(0.0, f64::max);
        let after = match least {
            _ if after.is_empty() => String::new(),
            least => format!(", after {} of the base", percent_span([least, most])),
        };
        let on_its_way = inserted(self.layers).min(least);
        Some(finding::clogged(which, &of, &after, 100.0 * on_its_way, self.share / 10.0))
    }

    /// That the particles trapped could turn the class if they were not retained.
    fn trapping(&self, run: u64) -> Option<Finding> {
        let could_leave = |run: &&Run| {
            let share = run.trapped as f64 / run.inserted.max(1) as f64;
            run.trapped > 0 && (run.eroded_mass_fraction + self.mass_of(share)).max(share) >= THRESHOLD
        };
        let worst = self.of_run(run).filter(could_leave).max_by_key(|run| run.trapped)?;
        let share = worst.trapped as f64 / worst.inserted.max(1) as f64;
        let mass = 100.0 * self.mass_of(share);
        Some(finding::trapped_could_turn(worst.trapped, worst.inserted, mass))
    }

    /// The most mass that such a share of the particles, by number, can have: that of the coarsest.
    fn mass_of(&self, share: f64) -> f64 {
        let coarser_than = self.base.d_by_number(100.0 * (1.0 - share));
        let mass = coarser_than.map_or(1.0, |d| 1.0 - self.base.percent_finer_by_mass(d) / 100.0);
        mass.clamp(share, 1.0)
    }

    /// That the second run erodes what the first did not.
    fn more_in_the_second(&self) -> Option<Finding> {
        let eroded: Vec<f64> = self.of_run(2).map(|run| run.eroded_mass_fraction).collect();
        let mean = eroded.iter().sum::<f64>() / eroded.len().max(1) as f64;
        (mean >= THRESHOLD).then(|| finding::second_run_erodes(100.0 * mean, 100.0 * THRESHOLD))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn replicate(of: &[(f64, u64, Option<f64>)]) -> Replicate {
        let run = |(number, &(eroded, trapped, k)): (u64, &(f64, u64, Option<f64>))| {
            serde_json::json!({
                "run": number, "eroded_mass_fraction": eroded, "eroded_number_fraction": eroded,
                "largest_eroded_mm": null, "largest_eroded_over_d15f": null, "blocked": 0,
                "blocked_fraction": 0.0, "blocked_first_three_layers_fraction": 0.0,
                "backbone_fraction": 0.0, "inserted": 10000, "eroded": 0, "retained_in_constrictions": 0,
                "retained_in_voids": 0, "trapped": trapped, "retained_per_void": 0.0, "increments": 100,
                "particle_moves": 0, "k_over_k0": k, "seconds": 0.0
            })
        };
        let runs: Vec<_> = (1..).zip(of).map(run).collect();
        let replicate = serde_json::json!({ "seed": 1, "verdict": "no erosion", "runs": runs });
        serde_json::from_value(replicate).unwrap()
    }

    fn of(verdict: Verdict, runs: &[(f64, u64, Option<f64>)], clogged: &[[u64; 3]]) -> Vec<String> {
        with_openings(verdict, runs, clogged, false)
    }

    fn with_openings(
        verdict: Verdict,
        runs: &[(f64, u64, Option<f64>)],
        clogged: &[[u64; 3]],
        openings: bool,
    ) -> Vec<String> {
        let (base, replicate) = (Gradation::linear_from_d0(0.1, 3.0).unwrap(), replicate(runs));
        let (replicates, clogged) = (vec![&replicate], clogged.to_vec());
        let walked = Walked { replicates, clogged, base: &base, share: 0.01, layers: 30, openings };
        findings(verdict, &walked).iter().map(Finding::with_to_do).collect()
    }

    #[test]
    fn a_filter_that_clogs_before_its_base_is_through_is_a_doubt() {
        let closed = [(0.021, 0, Some(0.0)), (0.0, 0, Some(0.0))];
        let found = of(Verdict::None, &closed, &[[1, 1, 41], [1, 2, 0]]);
        assert_eq!(found.len(), 1);
        let begin =
            "The filter clogged wholly in the first run, after 41.0 % of the base. No water flows then";
        assert!(found[0].starts_with(begin) && found[0].contains("at least 30 % of the base"), "{found:?}");
        assert!(found[0].ends_with("Try inject_share = 0.001."), "{found:?}");
        let found = of(Verdict::Some, &closed, &[[1, 1, 41], [1, 2, 0]]);
        assert!(found[0].starts_with("No water flows in the second run, as the filter clogged"), "{found:?}");
        // Less than has been inserted cannot be on its way.
        let found = of(Verdict::None, &closed, &[[1, 1, 10], [1, 2, 0]]);
        assert!(found[0].contains("its way, at least 10 % of"), "{found:?}");
        let found = of(Verdict::None, &closed, &[[1, 1, 24], [2, 1, 32], [1, 2, 0]]);
        assert!(
            found[0].contains("24.0 % to 32.0 % of the base")
                && found[0].contains("its way, at least 24 % of")
        );
        assert_eq!(of(Verdict::Continuing, &closed, &[[1, 1, 41]]), Vec::<String>::new());
        for open in [Some(0.01), None] {
            assert_eq!(of(Verdict::None, &[(0.02, 0, open), (0.0, 0, open)], &[]), Vec::<String>::new());
        }
    }

    /// Where openings are left a little water always flows.
    #[test]
    fn what_openings_still_let_pass_is_not_clogged() {
        let clogs = |k: f64, openings: bool| {
            let runs = [(0.02, 0, Some(k)), (0.0, 0, Some(k))];
            !with_openings(Verdict::None, &runs, &[], openings).is_empty()
        };
        assert_eq!([clogs(1e-4, false), clogs(1e-4, true), clogs(0.0, true)], [true, false, true]);
    }

    #[test]
    fn trapped_particles_that_could_turn_the_class_are_a_doubt() {
        let found = of(Verdict::None, &[(0.0, 9985, None), (0.0, 0, None)], &[]);
        assert!(found[0].contains("They are 9 985 of 10 000 particles of a run"), "{found:?}");
        // A few, but perhaps the coarsest.
        assert_eq!(of(Verdict::None, &[(0.06, 30, None)], &[]).len(), 1);
        assert_eq!(of(Verdict::None, &[(0.0, 1, None)], &[]), Vec::<String>::new());
    }

    #[test]
    fn no_erosion_whose_second_run_erodes_is_a_doubt() {
        let found = of(Verdict::None, &[(0.07, 0, None), (0.2, 0, None)], &[]);
        assert!(found[0].starts_with("The second run erodes 20 % of its base, more than 7.5 %"), "{found:?}");
        assert_eq!(of(Verdict::None, &[(0.05, 0, None), (0.07, 0, None)], &[]), Vec::<String>::new());
    }
}
