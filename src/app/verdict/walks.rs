//! Notes on a walk: on soils and network before it, on doubts about the walk, and on the results of a run.

use crate::outcome::packing::{FLOATING_PERCENT, PackedPart};
use crate::outcome::record::{Outcome, Replicate, Run, ShortOf, Stopping, Verdict};
use crate::outcome::verdict::{THRESHOLD, UndecidedBy};
use voidwalk_core::gradation::{BROAD_CU, FEW_FINES, FINES_MM, Gradation};
use voidwalk_practice::Note;
use voidwalk_practice::rules::broad_base;

/// Number of replicates below which a note states their number: their scatter is hardly known.
const FEW_REPLICATES: u64 = 5;

/// Ranges of Cu, of filter and base, in which the model was checked.
const FILTER_CU: [f64; 2] = [1.2, 6.0];
const BASE_CU: [f64; 2] = [1.2, 4.5];

/// Minimum width of a lattice (voids); a narrower one has few parallel paths. On one pair of soils one
/// void across eroded 3.3 %, forty 13.3 %.
const FEWEST_ACROSS: u32 = 10;

/// Base, filter and network of a walk to come.
#[derive(Clone)]
pub(crate) struct PlannedWalk<'a> {
    pub(crate) base: &'a Gradation,
    /// Base as stated, if it is walked regraded.
    pub(crate) regraded_from: Option<&'a Gradation>,
    /// Finest constriction (mm): a pan fraction of the base that may be coarser counts as finer.
    pub(crate) finest_constriction_mm: f64,
    pub(crate) filter: Option<&'a Gradation>,
    /// True for a sieve curve of the filter, false for an assumed straight line.
    pub(crate) filter_is_measured: bool,
    pub(crate) scale_free: bool,
    pub(crate) given_voids: Option<u64>,
    pub(crate) lattice: Option<[u32; 3]>,
    pub(crate) layers: u64,
    pub(crate) flows: bool,
    /// Number of increments in which the base is inserted.
    pub(crate) increments: u64,
    pub(crate) replicates: u64,
}

impl PlannedWalk<'_> {
    /// Notes on inputs that are unchecked or unknown, in no order.
    pub(crate) fn notes(&self) -> Vec<Note> {
        let notes = [
            self.fines(),
            self.broad_base(),
            self.filter.and_then(|filter| not_as_uniform("filter", filter.cu(), FILTER_CU)),
            self.cu_of_base(),
            self.unstable_base(),
            self.pan(),
            self.filter.is_none().then_some(Note::NoFilter {}),
            self.gap(),
            self.given_voids.map(|voids| Note::GivenNetwork { voids }),
            self.narrow_lattice(),
            self.all_on_its_way(),
            self.few_replicates(),
        ];
        notes.into_iter().flatten().collect()
    }

    /// Notes fines of the base that may be cohesive or are unknown.
    fn fines(&self) -> Option<Note> {
        let fines = self.base.percent_finer_by_mass(FINES_MM);
        if self.scale_free || fines <= FEW_FINES {
            return None;
        }
        let sieve = self.base.smallest_mm();
        Some(match sieve <= FINES_MM || self.base.pan_fraction() == 0.0 {
            true => Note::CohesiveFines { fines_percent: fines },
            false => Note::FinesNotSieved { fines_percent: fines, sieve_mm: sieve },
        })
    }

    /// Notes a broadly graded base, walked as regraded by practice or as sampled.
    fn broad_base(&self) -> Option<Note> {
        if self.scale_free {
            return None;
        }
        if let Some(sampled) = self.regraded_from {
            return broad_base(sampled);
        }
        let regraded = self.base.regraded();
        match regraded.at_mm {
            Some(sieve_mm) => Some(Note::NotRegraded { sieve_mm }),
            None => self.base.cu().filter(|cu| *cu >= BROAD_CU).map(|cu| Note::BroadlyGraded { cu }),
        }
    }

    /// Notes a Cu that is a lower bound: if D10 is finer than the finest sieve, it is not extrapolated.
    /// The true Cu exceeds the value with D10 at that sieve by an unknown amount.
    fn cu_of_base(&self) -> Option<Note> {
        let ([low, high], sieve) = (BASE_CU, self.base.smallest_mm());
        match (self.base.cu(), self.base.d(60.0)) {
            (None, Some(d60)) => {
                Some(Note::CuAtLeast { soil: "base".into(), over_cu: d60 / sieve, d10_mm: sieve, low, high })
            }
            (cu, _) => not_as_uniform("base", cu, BASE_CU),
        }
    }

    /// Notes a base whose coarser part does not hold its finer part.
    fn unstable_base(&self) -> Option<Note> {
        let stated = self.regraded_from.unwrap_or(self.base);
        let index = stated.known_kenney_lau().filter(|index| index.value < 1.0 && !self.scale_free)?;
        Some(Note::UnstableBase { index: index.value, finer_percent: index.percent })
    }

    fn pan(&self) -> Option<Note> {
        let percent = Some(100.0 * self.base.pan_fraction()).filter(|percent| *percent > 0.0)?;
        let (sieve, finest) = (self.base.smallest_mm(), self.finest_constriction_mm);
        Some(match sieve > finest {
            true => {
                Note::PanCountsAsPassing { finest_percent: percent, sieve_mm: sieve, constriction_mm: finest }
            }
            false => Note::PanPassive { finest_percent: percent },
        })
    }

    fn gap(&self) -> Option<Note> {
        let gap = self.filter.filter(|_| self.filter_is_measured)?.gap(0.0)?;
        Some(Note::GapGraded { within_percent: gap.within, from_mm: gap.from_mm })
    }

    fn narrow_lattice(&self) -> Option<Note> {
        let [nx, ny, _] = self.lattice?;
        (nx.min(ny) < FEWEST_ACROSS).then(|| Note::NarrowLattice { nx: nx.into(), ny: ny.into() })
    }

    /// Notes a base that, with water, is inserted completely before any of it can pass the filter.
    ///
    /// A particle makes one move per increment and needs as many as there are layers. Particles on their
    /// way when the water stops count as retained; here this is the whole base.
    fn all_on_its_way(&self) -> Option<Note> {
        let is_late = self.flows && self.increments <= self.layers;
        is_late.then_some(Note::AllOnItsWay { increments: self.increments, layers: self.layers })
    }

    fn few_replicates(&self) -> Option<Note> {
        match self.replicates {
            1 => Some(Note::OneReplicate {}),
            few if few < FEW_REPLICATES => Some(Note::FewReplicates { replicates: few }),
            _ => None,
        }
    }
}

/// Notes a soil that is more or less uniform than the soils for which the model was checked.
fn not_as_uniform(soil: &str, cu: Option<f64>, [low, high]: [f64; 2]) -> Option<Note> {
    let soil = soil.to_owned();
    match cu {
        Some(cu) if (low - 1e-9..=high + 1e-9).contains(&cu) => None,
        Some(cu) => Some(Note::CuUnchecked { soil, cu, low, high }),
        None => Some(Note::CuUnknown { soil, low, high }),
    }
}

/// Fraction of the clean filter's permeability below which it is treated as zero and shown as 0.0 %.
const CLOGGED: f64 = 5e-4;

pub(crate) struct Walked<'a> {
    pub(crate) replicates: Vec<&'a Replicate>,
    /// Replicate, run and increment after which water was first found not to flow; in order.
    pub(crate) clogged: Vec<[u64; 3]>,
    pub(crate) base: &'a Gradation,
    /// Fraction of the base inserted in each increment.
    pub(crate) share: f64,
    pub(crate) layers: u64,
    /// True if blocked constrictions leave openings.
    pub(crate) openings: bool,
}

/// True if this fraction of the clean filter's permeability is treated as zero. With openings little
/// passes, but water flows.
pub(crate) fn is_clogged(k_over_k0: f64, openings: bool) -> bool {
    k_over_k0 <= if openings { 0.0 } else { CLOGGED }
}

/// Notes reasons in the walk to distrust a class that does not erode continually.
pub(crate) fn notes(verdict: Verdict, walked: &Walked) -> Vec<Note> {
    // The first run separates "no erosion" from the other classes, the second "some" from "continuing".
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
    /// From then on nothing moves: all particles on their way, at least those of the last increments, as
    /// many as there are layers, count as retained.
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

    /// Upper bound of the mass fraction of this number fraction of the particles: that of the coarsest.
    fn mass_of(&self, share: f64) -> f64 {
        let coarser_than = self.base.d_by_number(100.0 * (1.0 - share));
        let mass = coarser_than.map_or(1.0, |d| 1.0 - self.base.percent_finer_by_mass(d) / 100.0);
        mass.clamp(share, 1.0)
    }

    fn more_in_the_second(&self) -> Option<Note> {
        let eroded: Vec<f64> = self.of_run(2).map(|run| run.eroded_mass_fraction).collect();
        let mean = eroded.iter().sum::<f64>() / eroded.len().max(1) as f64;
        (mean >= THRESHOLD).then_some(Note::SecondRunErodes { eroded_percent: 100.0 * mean })
    }
}

/// Fraction of its volume above which a void holds more than any packing of particles.
const ROOM: f64 = 0.6;

impl Outcome {
    /// Notes on the results: a target that was not reached, classes that the replicates leave open,
    /// trapped particles, and effects of water and full voids.
    pub fn notes_of_results(&self) -> Vec<Note> {
        let trapped: u64 = self.replicates.iter().flat_map(|r| &r.runs).map(|r| r.trapped).sum();
        [
            self.stopping.as_ref().and_then(short_of),
            self.replicates_leave_open(),
            (trapped > 0).then_some(Note::Trapped { particles: trapped }),
            self.second_run_may_erode(),
            self.thinner_than_grain(),
            self.not_studied(),
            self.permeability(),
            self.overfull(),
        ]
        .into_iter()
        .flatten()
        .collect()
    }

    /// Notes why the replicates do not separate the classes, unless another note does.
    fn replicates_leave_open(&self) -> Option<Note> {
        // A target error that was met says nothing about the class.
        let is_told = |stopping: &Stopping| stopping.short_of.is_some() || stopping.decide_percent.is_some();
        if self.stopping.as_ref().is_some_and(is_told) {
            return None;
        }
        match self.undecided_by()? {
            UndecidedBy::Curve => None,
            UndecidedBy::SecondRun => Some(Note::SecondRunMissing {}),
            UndecidedBy::Replicates => Some(Note::ReplicatesLeaveOpen {}),
        }
    }

    fn second_run_may_erode(&self) -> Option<Note> {
        let mean = self.summary.get(1)?.eroded_mass_fraction.mean;
        let [_, most_percent] = *self.model.eroded_percent.get(1)?;
        let may = mean < THRESHOLD && most_percent >= 100.0 * THRESHOLD;
        (self.model.class == Verdict::None && may).then_some(Note::SecondRunMayErode { most_percent })
    }

    fn thinner_than_grain(&self) -> Option<Note> {
        let modelled_mm = self.inputs.network.thickness_mm?;
        let [grain_mm, _] = *self.inputs.filter.gradation.last()?;
        (grain_mm > modelled_mm).then_some(Note::ThinnerThanGrain { modelled_mm, grain_mm })
    }

    /// Notes that no other amount of base and no other thickness was walked.
    fn not_studied(&self) -> Option<Note> {
        let is_studied = self.studies_to_come || !(self.sensitivity.is_empty() && self.thickness.is_empty());
        (self.practice.is_some() && !is_studied).then_some(Note::NotStudied {})
    }

    /// Notes the remaining fraction of the permeability at the end: a mean over the replicates; `None`
    /// without water.
    fn permeability(&self) -> Option<Note> {
        let last = self.summary.len().checked_sub(1)?;
        let left_percent = 100.0 * self.mean_of(last, |run| run.k_over_k0)?;
        Some(Note::Permeability { run: last as u64 + 1, left_percent })
    }

    /// Notes that a void holds more than it has room for; `None` if no void does or volumes are unknown.
    fn overfull(&self) -> Option<Note> {
        let runs = || self.replicates.iter().flat_map(|replicate| &replicate.runs);
        let share = 100.0 * runs().filter_map(|run| run.overfull_fraction).reduce(f64::max)?;
        let fullest = runs().filter_map(|run| run.fullness_max).reduce(f64::max);
        match fullest.filter(|&fullest| fullest > ROOM) {
            Some(fullest) => Some(Note::Overfull { fullest, voids_percent: share }),
            None => (share > 0.0).then_some(Note::NoRoom { voids_percent: share }),
        }
    }

    /// Mean of a quantity of one run over the replicates that have it.
    fn mean_of(&self, run: usize, quantity: impl Fn(&Run) -> Option<f64>) -> Option<f64> {
        let values: Vec<f64> = self.replicates.iter().filter_map(|r| quantity(r.runs.get(run)?)).collect();
        (!values.is_empty()).then(|| values.iter().sum::<f64>() / values.len() as f64)
    }
}

/// Note on a filter of which this part was packed.
pub(crate) fn packed_part(part: &PackedPart) -> Note {
    let PackedPart { percent: part_percent, largest_mm, finer_by, sizes_missing_above, .. } = *part;
    let finer_percent = 100.0 * finer_by;
    match (sizes_missing_above, part_percent >= FLOATING_PERCENT) {
        (_, false) => Note::LoosePartPacked { part_percent, largest_mm, finer_percent },
        (true, true) => Note::FloatingPartPacked { part_percent, largest_mm, finer_percent },
        (false, true) => Note::PartPacked { part_percent, largest_mm, finer_percent },
    }
}

/// Notes why the replicates miss the requested target.
fn short_of(stopping: &Stopping) -> Option<Note> {
    Some(match stopping.short_of? {
        ShortOf::SecondRun => Note::SecondRunMissing {},
        ShortOf::Decision { run, distance_pp, .. } => {
            let level_percent = stopping.decide_percent.unwrap_or(0.0);
            Note::LevelMissed { level_percent, run, distance_pp }
        }
        ShortOf::Target { half_width_pp, replicates, needed } => {
            let target_pp = stopping.target_error_pp.unwrap_or(0.0);
            Note::TargetMissed { target_pp, half_width_pp, replicates, needed }
        }
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::test_soils::curve;

    /// Eroded mass fraction, trapped particles and permeability of a run.
    type OneRun = (f64, u64, Option<f64>);

    fn replicate(runs: &[OneRun]) -> Replicate {
        let run = |(number, &(eroded, trapped, k)): (u64, &OneRun)| {
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

    fn doubts(verdict: Verdict, runs: &[OneRun], clogged: &[[u64; 3]]) -> Vec<Note> {
        with_openings(verdict, runs, clogged, false)
    }

    fn with_openings(verdict: Verdict, runs: &[OneRun], clogged: &[[u64; 3]], openings: bool) -> Vec<Note> {
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

    /// Openings always let some water pass.
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

    /// Plan without findings, and the finding from each change of it.
    #[test]
    fn each_finding_follows_from_its_own_change_alone() {
        let sand = curve(&[(0.2, 0.0), (0.6, 100.0)]);
        let filter = curve(&[(1.0, 0.0), (3.0, 100.0)]);
        let silt = curve(&[(0.05, 0.0), (0.075, 40.0), (0.15, 100.0)]);
        let hidden = curve(&[(0.3, 25.0), (1.0, 100.0)]);
        let till = curve(&[(0.1, 0.0), (2.0, 40.0), (19.0, 100.0)]);
        let broad = curve(&[(0.1, 0.0), (0.2, 12.0), (1.4, 60.0), (4.0, 100.0)]);
        let gap = curve(&[(1.0, 0.0), (1.2, 15.0), (8.0, 15.0), (20.0, 100.0)]);
        let plan = PlannedWalk {
            base: &sand,
            regraded_from: None,
            finest_constriction_mm: 0.4,
            filter: Some(&filter),
            filter_is_measured: true,
            scale_free: false,
            given_voids: None,
            lattice: Some([10, 10, 12]),
            layers: 12,
            flows: false,
            increments: 12,
            replicates: 5,
        };
        let ids = |plan: &PlannedWalk| plan.notes().iter().map(Note::id).collect::<Vec<_>>();
        let notes_after = |change: &dyn Fn(&mut PlannedWalk)| {
            let mut changed = plan.clone();
            change(&mut changed);
            ids(&changed)
        };
        assert_eq!(ids(&plan), [""; 0]);
        // Each pair of soils has its findings in mm and in multiples of D0F.
        let of_hidden = ["fines_not_sieved", "cu_at_least", "pan_passive"];
        for (base, in_mm, free) in [
            (&silt, &["cohesive_fines"][..], &[][..]),
            (&hidden, &of_hidden, &of_hidden[1..]),
            (&till, &["not_regraded", "cu_unchecked", "unstable_base"], &["cu_unchecked"]),
            (&broad, &["broadly_graded", "cu_unchecked"], &["cu_unchecked"]),
        ] {
            let plan = PlannedWalk { base, ..plan.clone() };
            assert_eq!(ids(&plan), in_mm);
            assert_eq!(ids(&PlannedWalk { scale_free: true, ..plan }), free);
        }
        let regraded = PlannedWalk { base: &till, regraded_from: Some(&till), ..plan.clone() };
        assert_eq!(ids(&regraded), ["broad_base", "cu_unchecked", "unstable_base"]);
        let gap_graded = PlannedWalk { filter: Some(&gap), ..plan.clone() };
        assert_eq!(ids(&gap_graded), ["cu_unchecked", "gap_graded"]);
        assert_eq!(ids(&PlannedWalk { filter_is_measured: false, ..gap_graded }), ["cu_unchecked"]);
        assert_eq!(notes_after(&|plan| plan.filter = None), ["no_filter"]);
        let wide = Gradation::linear_from_dx(85.0, 0.4, 4.6).unwrap();
        assert_eq!(ids(&PlannedWalk { base: &wide, scale_free: true, ..plan.clone() }), ["cu_unchecked"]);
        let mostly_hidden = curve(&[(0.3, 65.0), (1.0, 100.0)]);
        let hidden_plan = PlannedWalk { base: &mostly_hidden, ..plan.clone() };
        assert!(ids(&hidden_plan).contains(&"cu_unknown".to_owned()));
        // 14 % finer than 0.002 mm, D60 of 0.2 mm.
        let clayey = curve(&[(0.002, 14.0), (0.2, 60.0), (0.4, 100.0)]);
        let open = PlannedWalk { base: &clayey, ..plan.clone() }.notes();
        let is_least = |note: &Note| {
            matches!(*note, Note::CuAtLeast { over_cu, d10_mm, .. }
                if (over_cu - 100.0).abs() < 1e-9 && d10_mm == 0.002)
        };
        assert!(open.iter().any(is_least), "{open:?}");
        // A Cu above 3 may be above 4.5.
        let narrow = curve(&[(0.1, 14.0), (0.3, 60.0), (0.4, 100.0)]);
        let within = PlannedWalk { base: &narrow, ..plan.clone() };
        assert!(ids(&within).contains(&"cu_at_least".to_owned()), "{:?}", ids(&within));
        assert_eq!(notes_after(&|plan| plan.given_voids = Some(7)), ["given_network"]);
        assert_eq!(notes_after(&|plan| plan.lattice = Some([9, 10, 12])), ["narrow_lattice"]);
        assert_eq!(notes_after(&|plan| plan.flows = true), ["all_on_its_way"]);
        assert_eq!(notes_after(&|plan| (plan.flows, plan.increments) = (true, 13)), [""; 0]);
        assert_eq!(notes_after(&|plan| plan.replicates = 4), ["few_replicates"]);
        assert_eq!(notes_after(&|plan| plan.replicates = 1), ["one_replicate"]);
        let fine = PlannedWalk { base: &hidden, finest_constriction_mm: 0.2, ..plan.clone() };
        assert_eq!(ids(&fine), ["fines_not_sieved", "cu_at_least", "pan_counts_as_passing"]);
    }
}
