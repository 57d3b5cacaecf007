//! Doubts about a verdict from its own walk: a filter that clogged, particles that circle, a second run that
//! erodes more than the first.

use crate::outcome::record::{Replicate, Run, Verdict};
use crate::outcome::verdict::THRESHOLD;
use voidwalk_core::gradation::Gradation;
use voidwalk_practice::Note;

/// A permeability below this part of the clean filter's is treated as zero: it is shown as 0.0 %.
const CLOGGED: f64 = 5e-4;

/// Data of a walk that raise doubts.
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
    /// True if blocked constrictions leave openings.
    pub openings: bool,
}

/// Tells if such a small part of the clean filter's permeability is treated as zero. With openings little
/// passes, but water flows.
pub fn is_clogged(k_over_k0: f64, openings: bool) -> bool {
    k_over_k0 <= if openings { 0.0 } else { CLOGGED }
}

/// Notes the reasons in its walk to distrust a class that does not erode for ever.
pub fn notes(verdict: Verdict, walked: &Walked) -> Vec<Note> {
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
        self.replicates.iter().flat_map(|replicate| &replicate.runs).filter(move |run| run.run == number)
    }

    /// Notes that no water flowed at the end of the run that decides.
    ///
    /// From then on nothing moves: all particles on their way, at least those of the last increments, as many
    /// as there are layers, count as retained.
    fn clogging(&self, run: u64) -> Option<Note> {
        let all = self.of_run(run).count();
        let is_none = |k_over_k0| is_clogged(k_over_k0, self.openings);
        let clogged = self.of_run(run).filter(|run| run.k_over_k0.is_some_and(is_none)).count();
        if clogged == 0 {
            return None;
        }
        let [replicates, walked] = [clogged, all].map(|count| count as u64);
        let smaller_inject_share = self.share / 10.0;
        let inserted = |increment: u64| (increment as f64 * self.share).min(1.0);
        // The second run continues from the state that the first left.
        let from_start = run == 2 && self.clogged.iter().any(|clogged| clogged[1] == 2 && clogged[2] == 0);
        if from_start {
            return Some(Note::CloggedBefore { replicates, walked, smaller_inject_share });
        }
        let after =
            self.clogged.iter().filter(|clogged| clogged[1] == run).map(|clogged| inserted(clogged[2]));
        let over_on_its_way_percent = 100.0 * after.fold(inserted(self.layers), f64::min);
        Some(Note::Clogged { run, replicates, walked, over_on_its_way_percent, smaller_inject_share })
    }

    /// Notes that the trapped particles could change the class if they were not retained.
    fn trapping(&self, run: u64) -> Option<Note> {
        let could_leave = |run: &&Run| {
            let share = run.trapped as f64 / run.inserted.max(1) as f64;
            run.trapped > 0 && (run.eroded_mass_fraction + self.mass_of(share)).max(share) >= THRESHOLD
        };
        let worst = self.of_run(run).filter(could_leave).max_by_key(|run| run.trapped)?;
        let share = worst.trapped as f64 / worst.inserted.max(1) as f64;
        let mass_percent = 100.0 * self.mass_of(share);
        Some(Note::TrappedCouldTurn { trapped: worst.trapped, inserted: worst.inserted, mass_percent })
    }

    /// The greatest mass of such a share of the particles, by number: the mass of the coarsest.
    fn mass_of(&self, share: f64) -> f64 {
        let coarser_than = self.base.d_by_number(100.0 * (1.0 - share));
        let mass = coarser_than.map_or(1.0, |d| 1.0 - self.base.percent_finer_by_mass(d) / 100.0);
        mass.clamp(share, 1.0)
    }

    /// Notes that the second run erodes what the first did not.
    fn more_in_the_second(&self) -> Option<Note> {
        let eroded: Vec<f64> = self.of_run(2).map(|run| run.eroded_mass_fraction).collect();
        let mean = eroded.iter().sum::<f64>() / eroded.len().max(1) as f64;
        (mean >= THRESHOLD).then_some(Note::SecondRunErodes { eroded_percent: 100.0 * mean })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn replicate(runs: &[(f64, u64, Option<f64>)]) -> Replicate {
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
        let runs: Vec<_> = (1..).zip(runs).map(run).collect();
        let replicate = serde_json::json!({ "seed": 1, "verdict": "no erosion", "runs": runs });
        serde_json::from_value(replicate).unwrap()
    }

    fn doubts(verdict: Verdict, runs: &[(f64, u64, Option<f64>)], clogged: &[[u64; 3]]) -> Vec<Note> {
        with_openings(verdict, runs, clogged, false)
    }

    fn with_openings(
        verdict: Verdict,
        runs: &[(f64, u64, Option<f64>)],
        clogged: &[[u64; 3]],
        openings: bool,
    ) -> Vec<Note> {
        let (base, replicate) = (Gradation::linear_from_d0(0.1, 3.0).unwrap(), replicate(runs));
        let (replicates, clogged) = (vec![&replicate], clogged.to_vec());
        let walked = Walked { replicates, clogged, base: &base, share: 0.01, layers: 30, openings };
        notes(verdict, &walked)
    }

    #[test]
    fn a_filter_that_clogs_before_its_base_is_through_is_a_doubt() {
        let closed = [(0.021, 0, Some(0.0)), (0.0, 0, Some(0.0))];
        let over_on_its_way = |clogged: &[[u64; 3]]| match &doubts(Verdict::None, &closed, clogged)[..] {
            [Note::Clogged { run: 1, replicates: 1, walked: 1, over_on_its_way_percent, .. }] => {
                over_on_its_way_percent.round()
            }
            other => panic!("{other:?}"),
        };
        assert_eq!(over_on_its_way(&[[1, 1, 41], [1, 2, 0]]), 30.0);
        // The mass on its way cannot exceed the mass inserted.
        assert_eq!(over_on_its_way(&[[1, 1, 10], [1, 2, 0]]), 10.0);
        assert_eq!(over_on_its_way(&[[1, 1, 24], [2, 1, 32], [1, 2, 0]]), 24.0);
        let before = doubts(Verdict::Some, &closed, &[[1, 1, 41], [1, 2, 0]]);
        assert!(matches!(before[..], [Note::CloggedBefore { .. }]), "{before:?}");
        assert_eq!(doubts(Verdict::Continuing, &closed, &[[1, 1, 41]]), []);
        for open in [Some(0.01), None] {
            assert_eq!(doubts(Verdict::None, &[(0.02, 0, open), (0.0, 0, open)], &[]), []);
        }
    }

    /// Openings always let a little water flow.
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
        let notes = doubts(Verdict::None, &[(0.0, 9985, None), (0.0, 0, None)], &[]);
        assert!(matches!(notes[..], [Note::TrappedCouldTurn { trapped: 9985, inserted: 10_000, .. }]));
        // A few, but perhaps the coarsest.
        assert_eq!(doubts(Verdict::None, &[(0.06, 30, None)], &[]).len(), 1);
        assert_eq!(doubts(Verdict::None, &[(0.0, 1, None)], &[]), []);
    }

    #[test]
    fn no_erosion_whose_second_run_erodes_is_a_doubt() {
        let notes = doubts(Verdict::None, &[(0.07, 0, None), (0.2, 0, None)], &[]);
        assert_eq!(notes, [Note::SecondRunErodes { eroded_percent: 20.0 }]);
        assert_eq!(doubts(Verdict::None, &[(0.05, 0, None), (0.07, 0, None)], &[]), []);
    }
}
