//! Notes on soils and network before they are walked, with a scene or without one.

use voidwalk_core::gradation::{BROAD_CU, FEW_FINES, FINES_MM, Gradation};
use voidwalk_practice::Note;
use voidwalk_practice::base_cautions::broad_base;

/// With fewer replicates than these a note states their number: their scatter is hardly known.
const FEW_REPLICATES: u64 = 5;

/// Ranges of Cu, of filter and base, in which the model was checked.
const FILTER_CU: [f64; 2] = [1.2, 6.0];
const BASE_CU: [f64; 2] = [1.2, 4.5];

/// A lattice narrower than this many voids has few parallel paths: on one pair of soils one void across
/// eroded 3.3 %, forty 13.3 %.
const FEWEST_ACROSS: u32 = 10;

/// A base, a filter and a network that are to be walked.
#[derive(Clone)]
pub struct PlannedWalk<'a> {
    /// The base, as it is walked.
    pub base: &'a Gradation,
    /// The base as it was stated, if it is walked regraded.
    pub regraded_from: Option<&'a Gradation>,
    /// The finest constriction (mm): a pan fraction of the base that may be coarser counts as finer.
    pub finest_constriction_mm: f64,
    /// The filter, if it is known.
    pub filter: Option<&'a Gradation>,
    /// True if the filter's gradation is a sieve curve, and not an assumed straight line.
    pub filter_is_measured: bool,
    /// True if sizes are multiples of D0F.
    pub scale_free: bool,
    /// Voids of a network that was given, not built.
    pub given_voids: Option<u64>,
    /// Voids along each axis of a lattice.
    pub lattice: Option<[u32; 3]>,
    /// Layers of voids.
    pub layers: u64,
    /// True if water flows.
    pub flows: bool,
    /// Increments in which the base is inserted.
    pub increments: u64,
    /// Replicates.
    pub replicates: u64,
}

impl PlannedWalk<'_> {
    /// Notes on unchecked and unknown things, in no order.
    pub fn notes(&self) -> Vec<Note> {
        let notes = [
            self.fines(),
            self.broad_base(),
            self.cu_of_filter(),
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

    /// Notes fines of the base that may be cohesive, or that are unknown.
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

    /// Notes a broadly graded base, walked as practice cuts it or as it is.
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

    fn cu_of_filter(&self) -> Option<Note> {
        not_as_uniform("filter", self.filter?.cu(), FILTER_CU)
    }

    /// Notes a Cu that is a lower bound: if D10 is finer than the finest sieve, its size is not extrapolated.
    /// Cu is greater than if all of that part were as coarse as that sieve, by an unknown amount.
    fn cu_of_base(&self) -> Option<Note> {
        let ([low, high], sieve) = (BASE_CU, self.base.smallest_mm());
        match (self.base.cu(), self.base.d(60.0)) {
            (None, Some(d60)) => {
                Some(Note::CuAtLeast { soil: "base".into(), over_cu: d60 / sieve, d10_mm: sieve, low, high })
            }
            (cu, _) => not_as_uniform("base", cu, BASE_CU),
        }
    }

    /// Notes a base whose coarser part does not hold its own finer part.
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

    /// Notes a base that is, with water, inserted completely before any of it can be through.
    ///
    /// A particle makes one move per increment, and needs as many as there are layers. Particles on their way
    /// when the water stops count as retained; here this is the whole base.
    fn all_on_its_way(&self) -> Option<Note> {
        let is_late = self.flows && self.increments <= self.layers;
        is_late.then_some(Note::AllOnItsWay { increments: self.increments, layers: self.layers })
    }

    /// Notes that the replicates reveal little of their own scatter.
    fn few_replicates(&self) -> Option<Note> {
        match self.replicates {
            1 => Some(Note::OneReplicate {}),
            few if few < FEW_REPLICATES => Some(Note::FewReplicates { replicates: few }),
            _ => None,
        }
    }
}

fn is_within(cu: f64, [low, high]: [f64; 2]) -> bool {
    (low - 1e-9..=high + 1e-9).contains(&cu)
}

/// Notes a soil that is more or less uniform than the soils for which the model was checked.
fn not_as_uniform(soil: &str, cu: Option<f64>, [low, high]: [f64; 2]) -> Option<Note> {
    let soil = soil.to_owned();
    match cu {
        Some(cu) if is_within(cu, [low, high]) => None,
        Some(cu) => Some(Note::CuUnchecked { soil, cu, low, high }),
        None => Some(Note::CuUnknown { soil, low, high }),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn soil(points: &[(f64, f64)]) -> Gradation {
        Gradation::from_lines(points).unwrap()
    }

    /// A plan without findings, and the finding of each change of it.
    #[test]
    fn each_finding_follows_from_its_own_change_alone() {
        let sand = soil(&[(0.2, 0.0), (0.6, 100.0)]);
        let filter = soil(&[(1.0, 0.0), (3.0, 100.0)]);
        let silt = soil(&[(0.05, 0.0), (0.075, 40.0), (0.15, 100.0)]);
        let hidden = soil(&[(0.3, 25.0), (1.0, 100.0)]);
        let till = soil(&[(0.1, 0.0), (2.0, 40.0), (19.0, 100.0)]);
        let broad = soil(&[(0.1, 0.0), (0.2, 12.0), (1.4, 60.0), (4.0, 100.0)]);
        let gap = soil(&[(1.0, 0.0), (1.2, 15.0), (8.0, 15.0), (20.0, 100.0)]);
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
        // Each pair of soils with its findings in mm, and in multiples of D0F.
        for (base, in_mm, free) in [
            (&silt, vec!["cohesive_fines"], vec![]),
            (
                &hidden,
                vec!["fines_not_sieved", "cu_at_least", "pan_passive"],
                vec!["cu_at_least", "pan_passive"],
            ),
            (&till, vec!["not_regraded", "cu_unchecked", "unstable_base"], vec!["cu_unchecked"]),
            (&broad, vec!["broadly_graded", "cu_unchecked"], vec!["cu_unchecked"]),
        ] {
            let plan = PlannedWalk { base, ..plan.clone() };
            assert_eq!(ids(&plan), in_mm);
            assert_eq!(ids(&PlannedWalk { scale_free: true, ..plan }), free);
        }
        assert_eq!(
            ids(&PlannedWalk { base: &till, regraded_from: Some(&till), ..plan.clone() }),
            ["broad_base", "cu_unchecked", "unstable_base"]
        );
        let gap_graded = PlannedWalk { filter: Some(&gap), ..plan.clone() };
        assert_eq!(ids(&gap_graded), ["cu_unchecked", "gap_graded"]);
        assert_eq!(ids(&PlannedWalk { filter_is_measured: false, ..gap_graded }), ["cu_unchecked"]);
        assert_eq!(notes_after(&|plan| plan.filter = None), ["no_filter"]);
        let wide = Gradation::linear_from_dx(85.0, 0.4, 4.6).unwrap();
        assert_eq!(ids(&PlannedWalk { base: &wide, scale_free: true, ..plan.clone() }), ["cu_unchecked"]);
        let mostly_hidden = soil(&[(0.3, 65.0), (1.0, 100.0)]);
        assert!(
            ids(&PlannedWalk { base: &mostly_hidden, ..plan.clone() }).contains(&"cu_unknown".to_owned())
        );
        // 14 % finer than 0.002 mm, D60 0.2 mm.
        let clayey = soil(&[(0.002, 14.0), (0.2, 60.0), (0.4, 100.0)]);
        let open = PlannedWalk { base: &clayey, ..plan.clone() };
        let least = open.notes().into_iter().find_map(|note| match note {
            Note::CuAtLeast { over_cu, d10_mm, .. } => Some([over_cu, d10_mm]),
            _ => None,
        });
        assert!(least.is_some_and(|[cu, d10]| (cu - 100.0).abs() < 1e-9 && d10 == 0.002), "{least:?}");
        // A Cu of more than 3 may be beyond 4.5.
        let narrow = soil(&[(0.1, 14.0), (0.3, 60.0), (0.4, 100.0)]);
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
