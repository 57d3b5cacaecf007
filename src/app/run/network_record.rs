//! Record of walks on given networks.

use super::network_walk::{NetworkOutcome, NetworkWalk};
use super::replicates::said_by_walks;
use crate::case::{PAPER_MASS_RATIO, base_record};
use crate::outcome::left_out::LeftOut;
use crate::outcome::record::{GivenNetwork, NetworkWalkRecord, Statistic};
use crate::outcome::{Modelled, leaves_out, verdict};
use crate::verdict::PlannedWalk;
use rayon::slice::ParallelSliceMut;
use std::cmp::Ordering;
use voidwalk_core::gradation::Gradation;
use voidwalk_core::network::Network;
use voidwalk_practice::rules::RuleInputs;
use voidwalk_practice::{Decision, Mistake, Note, ordered, rules};

/// Steps of the curve of a network's diameters (percent).
const STEP: usize = 2;

impl NetworkOutcome {
    /// Record of these walks by a plan; `network` is the first of this many networks.
    pub fn record(&self, plan: &NetworkWalk, network: &Network, networks: usize) -> NetworkWalkRecord {
        let first = self.replicates.first().map(|walked| &walked.result);
        NetworkWalkRecord {
            verdict: self.verdict,
            notes: self.notes(plan, network, networks),
            seed: plan.seed,
            n_base: plan.n_base,
            n_base_eq2: plan.eq2(network, plan.mass_ratio).ok().flatten(),
            grains_per_void: plan.filter.as_ref().and_then(|filter| filter.grains_per_void),
            mass_ratio: plan.mass_ratio,
            increments: plan.increments,
            engine: first.map_or(plan.engine, |first| first.engine).name().into(),
            replicates: self.replicates.iter().map(|walked| walked.result.replicate.clone()).collect(),
            summary: self.summary.clone(),
            threshold: verdict::THRESHOLD,
            left_out: first
                .map_or(Vec::new(), |first| first.left_out.iter().copied().map(LeftOut::Walk).collect()),
            model_leaves_out: leaves_out(Modelled {
                flow: network.exit_rule().needs_flow(),
                ..Modelled::default()
            }),
            base: base_record(in_words(&plan.base), &plan.base),
            d15f_mm: plan.d15f_mm(),
            network: given(network, networks),
            version: env!("CARGO_PKG_VERSION").into(),
        }
    }
}

/// Description of a base without a name.
fn in_words(base: &Gradation) -> String {
    match base.cu().filter(|_| base.smallest_mm() < base.largest_mm()) {
        Some(cu) => format!("Cu {}", (cu * 1e3).round() / 1e3),
        None => "one size".into(),
    }
}

fn given(network: &Network, networks: usize) -> GivenNetwork {
    let passages = (0..network.constrictions()).filter(|&c| network.counts(c));
    let mut diameters: Vec<f32> = passages.map(|c| network.diameters()[c]).collect();
    let constrictions = diameters.len() as u64;
    diameters.retain(|&diameter| diameter > 0.0);
    diameters.par_sort_unstable_by(f32::total_cmp);
    // The minimum, the maximum, or the size at this percentile in between.
    let size = |percent: usize| {
        let at = (percent * diameters.len()).div_ceil(100).max(1) - 1;
        Some([f64::from(*diameters.get(at)?) * network.unit_mm(), percent as f64])
    };
    GivenNetwork {
        networks: networks as u64,
        exit: network.exit_rule().name().into(),
        voids: network.filter_voids() as u64,
        constrictions,
        layers: network.layers() as u64,
        diameters: (0..=100).step_by(STEP).filter_map(size).collect(),
    }
}

impl NetworkOutcome {
    /// Notes on the class; `network` is the first of this many networks.
    pub(crate) fn notes(&self, plan: &NetworkWalk, network: &Network, networks: usize) -> Vec<Note> {
        let walked = || self.replicates.iter().map(|walked| &walked.result);
        let layers = network.layers() as u64;
        let mut notes = said_by_walks(self.verdict, walked(), &plan.base, plan.increments, (layers, false));
        notes.extend(plan.notes(network, self.replicates.len() as u64));
        if networks == 1 && self.replicates.len() > 1 {
            notes.push(Note::OneNetwork {});
        }
        let rules = plan.filter.as_ref().map_or(Vec::new(), |filter| {
            let largest: Vec<f64> =
                walked().filter_map(|w| w.replicate.runs.first()?.largest_eroded_over_d15f).collect();
            rules::apply(&RuleInputs {
                filter_is_measured: filter.is_measured,
                largest_eroded_over_d15f: (!largest.is_empty()).then(|| Statistic::of(&largest).mean),
                ..RuleInputs::of_soils(&plan.base, &filter.gradation)
            })
        });
        ordered(Decision::new(&rules, None, None).notes().chain(notes))
    }
}

impl NetworkWalk {
    /// Notes on unchecked or unknown inputs, whatever the result of the walk.
    fn notes(&self, network: &Network, replicates: u64) -> Vec<Note> {
        let filter = self.filter.as_ref();
        let planned = PlannedWalk {
            base: &self.base,
            regraded_from: None,
            finest_constriction_mm: f64::from(network.finest()) * network.unit_mm(),
            filter: filter.map(|filter| &filter.gradation),
            filter_is_measured: filter.is_some_and(|filter| filter.is_measured),
            scale_free: false,
            given_voids: Some(network.filter_voids() as u64),
            lattice: network.shape(),
            layers: network.layers() as u64,
            flows: network.exit_rule().needs_flow(),
            increments: self.increments,
            replicates,
        };
        let mistake = filter.and_then(|filter| Mistake::find(&self.base, &filter.gradation, false));
        let mistake = mistake.map(|mistake| mistake.note);
        planned.notes().into_iter().chain(mistake).chain(self.amount(network)).collect()
    }

    /// Note on a number of base particles that differs from Eq. (2), or cannot be compared with it, if the
    /// class depends on it.
    fn amount(&self, network: &Network) -> Option<Note> {
        let particles = self.n_base;
        let Some(needed) = self.eq2(network, PAPER_MASS_RATIO).ok().flatten() else {
            return Some(Note::AmountUnknown { particles });
        };
        match particles.cmp(&needed) {
            Ordering::Less => Some(Note::FewParticles { particles, needed }),
            Ordering::Equal => None,
            Ordering::Greater => Some(Note::MoreParticles { particles, needed }),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::case::Case;
    use crate::outcome::record::ModelLimit;
    use crate::run::case_of;
    use crate::run::{Callbacks, GivenFilter, walk_networks};
    use std::collections::BTreeSet;
    use std::fs;
    use std::sync::Arc;
    use voidwalk_core::constrictions::find;
    use voidwalk_core::gradation::Gradation;
    use voidwalk_core::network::{ExitRule, NetworkColumns};

    /// Two constrictions are passed both ways and one is closed from the start; each is counted once.
    #[test]
    fn a_record_says_what_was_walked_through() {
        let columns = NetworkColumns {
            voids: 3,
            conns: &[[0, 1], [1, 2], [0, 2]],
            diameter_mm: &[0.5, 0.25, 0.0],
            conductance: None,
            inlets: &[0],
            outlets: &[2],
            rule: ExitRule::Flux,
            rho: 0.0,
            unit_mm: 0.5,
        };
        let network = Arc::new(Network::from_columns(&columns).unwrap().0);
        let plan = NetworkWalk { replicates: 2, ..NetworkWalk::new(Gradation::single(0.1).unwrap(), 1000) };
        let outcome = walk_networks(&[Arc::clone(&network)], &plan, &Callbacks::default()).unwrap();
        let record = outcome.record(&plan, &network, 1);
        let given = &record.network;
        assert_eq!((given.voids, given.constrictions, given.exit.as_str()), (3, 3, "flux"));
        assert_eq!((given.diameters[0], given.diameters[50]), ([0.25, 0.0], [0.5, 100.0]));
        assert!(given.diameters.iter().all(|&[mm, percent]| (mm == 0.25) == (percent <= 50.0)));
        assert_eq!((record.base.name.as_str(), record.base.d85_mm), ("one size", 0.1));
        assert_eq!((record.n_base, record.replicates.len(), record.summary.len()), (1000, 2, 2));
        assert!(record.model_leaves_out.contains(&ModelLimit::Gradient));
        assert_eq!((record.n_base_eq2, record.grains_per_void), (None, None));
        assert!(record.notes.iter().any(|note| note.id() == "amount_unknown"), "{:?}", record.notes);
    }

    fn number_and_notes(
        n_base: Option<u64>,
        filter: Option<Gradation>,
        grains_per_void: Option<f64>,
    ) -> (u64, Vec<Note>) {
        let curve = find("cu1.5-loose").unwrap().curve().unwrap().in_mm(1.0).unwrap();
        let network = Arc::new(Network::cubic([10, 10, 12], &curve, 1.0, 5).unwrap());
        let filter = filter.map(|gradation| GivenFilter { gradation, is_measured: true, grains_per_void });
        let base = Gradation::linear_from_dx(85.0, 0.25, 1.5).unwrap();
        let mut plan = NetworkWalk { replicates: 6, filter, ..NetworkWalk::new(base, 1) };
        let eq2 = plan.eq2(&network, 0.05).unwrap();
        plan.n_base = n_base.or(eq2).unwrap();
        let outcome = walk_networks(&[Arc::clone(&network)], &plan, &Callbacks::default()).unwrap();
        (plan.n_base, outcome.notes(&plan, &network, 1))
    }

    /// Numbers that fall short of Eq. (2), exceed it or cannot be compared with it are doubts; the number of
    /// Eq. (2) is not.
    #[test]
    fn a_number_of_particles_that_is_not_that_of_equation_two_is_a_doubt() {
        let filter = || Gradation::linear_from_d0(1.0, 1.5).ok();
        let has = |notes: &[Note], id: &str| notes.iter().any(|note| note.id() == id);
        let (n, of_eq2) = number_and_notes(None, filter(), Some(0.6));
        assert!(
            n > 1000
                && !["few_particles", "more_particles", "amount_unknown"].iter().any(|id| has(&of_eq2, id))
        );
        assert!(has(&number_and_notes(Some(1000), filter(), Some(0.6)).1, "few_particles"));
        assert!(has(&number_and_notes(Some(n + 1), filter(), Some(0.6)).1, "more_particles"));
        for filter in [None, filter()] {
            assert!(has(&number_and_notes(Some(n), filter, None).1, "amount_unknown"));
        }
        assert!(has(&number_and_notes(Some(n), None, None).1, "no_filter"));
    }

    /// The first particle closes the only constriction.
    #[test]
    fn a_network_that_clogs_is_a_doubt() {
        let columns = NetworkColumns {
            voids: 2,
            conns: &[[0, 1]],
            diameter_mm: &[0.1],
            conductance: None,
            inlets: &[0],
            outlets: &[1],
            rule: ExitRule::Flux,
            rho: 0.0,
            unit_mm: 1.0,
        };
        let network = Arc::new(Network::from_columns(&columns).unwrap().0);
        let plan = NetworkWalk { replicates: 2, ..NetworkWalk::new(Gradation::single(0.2).unwrap(), 1000) };
        let outcome = walk_networks(&[Arc::clone(&network)], &plan, &Callbacks::default()).unwrap();
        let notes = outcome.notes(&plan, &network, 1);
        assert!(notes.iter().any(|note| note.id() == "clogged"), "{notes:?}");
    }

    /// Notes that only a scene has: on its files, and on a filter's pan fraction, which matters if Eq. (2)
    /// gives the base.
    const OF_A_SCENE: [&str; 2] = ["read_as", "pan_of_filter"];

    /// Notes on a scene, and on a walk of its soils on its network without it; the list above is left out.
    fn of_both(case: &Case, network: &Network) -> [BTreeSet<(String, String)>; 2] {
        let filter = GivenFilter {
            gradation: case.filter.gradation.clone(),
            is_measured: case.filter_is_measured(),
            grains_per_void: case.filter.grains_per_void,
        };
        let plan = NetworkWalk {
            increments: case.increments(),
            filter: Some(filter),
            ..NetworkWalk::new(case.base.gradation.clone(), case.supply.n_base)
        };
        let shared = |notes: Vec<Note>, allowed: &[&str]| {
            let shared = notes.into_iter().filter(|note| !allowed.contains(&&*note.id()));
            shared.map(|note| (note.id(), format!("{note:?}"))).collect()
        };
        let of_scene = case.notes();
        let of_network = plan.notes(network, case.scene.walk.replicates);
        [shared(of_scene, &OF_A_SCENE), shared(of_network, &[])]
    }

    /// A narrow lattice, and one with too few increments for any of the base to leave it.
    #[test]
    fn a_lattice_that_is_given_has_the_findings_of_its_scene() {
        for (own, id) in [
            (["network.nx=7", "walk.exit=area"], "narrow_lattice"),
            (["network.nx=10", "walk.exit=flux"], "all_on_its_way"),
        ] {
            let small = ["network.ny=10", "network.nz=10", "filter.d0_mm=2", "base.n_base=100"];
            let rest = ["inject_share=0.1", "replicates=2", "record.sensitivity=[]"];
            let case = case_of(&[&own[..], &small, &rest].concat());
            let [of_scene, mut of_network] = of_both(&case, &case.network(1).unwrap());
            of_network.retain(|(id, _)| id != "given_network");
            assert_eq!(of_scene, of_network);
            let ids: BTreeSet<&str> = of_scene.iter().map(|(id, _)| &**id).collect();
            assert_eq!(ids, [id, "few_particles", "few_replicates"].into());
        }
    }

    /// Percent finer by mass (mm).
    type Points = &'static [(f64, f64)];
    const SAND: Points = &[(0.2, 0.0), (0.6, 100.0)];
    const FILTER: Points = &[(1.0, 0.0), (3.0, 100.0)];
    const GAP: Points = &[(1.0, 0.0), (1.2, 15.0), (8.0, 15.0), (20.0, 100.0)];
    const SILT: Points = &[(0.01, 0.0), (0.075, 40.0), (0.3, 100.0)];
    const BROAD: Points = &[(0.1, 0.0), (0.2, 12.0), (1.4, 60.0), (4.0, 100.0)];
    const NEARLY_BROAD: Points = &[(0.1, 0.0), (0.2, 12.0), (1.0, 60.0), (4.0, 100.0)];
    const GRAVELLY: Points = &[(0.1, 0.0), (2.0, 40.0), (19.0, 100.0)];
    const HIDDEN: Points = &[(0.3, 25.0), (1.0, 100.0)];
    const PASSIVE: Points = &[(0.3, 3.0), (1.0, 100.0)];
    const PAIRS: [(Points, Points); 9] = [
        (SAND, FILTER),
        (SAND, GAP),
        (SILT, FILTER),
        (BROAD, FILTER),
        (NEARLY_BROAD, FILTER),
        (GRAVELLY, FILTER),
        (HIDDEN, FILTER),
        (PASSIVE, FILTER),
        (FILTER, SAND),
    ];

    /// Walks the soils on one network, with a scene and without. Both must report the same notes with equal
    /// numbers, apart from the list above.
    #[test]
    fn a_walk_without_a_scene_finds_what_a_scene_of_the_same_soils_finds() {
        let folder = tempfile::tempdir().unwrap();
        let path = |name: &str| folder.path().join(name);
        let write = |name: &str, points: Points| {
            let rows = points.iter().map(|(mm, percent)| format!("{mm},{percent}\n"));
            fs::write(path(name), rows.fold("size_mm,percent_finer\n".into(), |all: String, row| all + &row))
        };
        let network = "from,to,diameter_mm\nstart,0,\n0,1,0.5\n1,end,0.4\n1,0,0.5\n";
        fs::write(path("network.csv"), network).unwrap();
        let (mut seen, mut pairs) = (BTreeSet::new(), 0);
        for (base, filter) in PAIRS {
            write("base.csv", base).unwrap();
            write("filter.csv", filter).unwrap();
            for replicates in [1, 3, 6] {
                let file = |key: &str, name: &str| format!("{key}={}", path(name).display());
                let case = case_of(&[
                    &file("network.file", "network.csv"),
                    &file("base.sieve", "base.csv"),
                    &file("filter.sieve", "filter.csv"),
                    "base.n_base=1000",
                    &format!("replicates={replicates}"),
                    "record.sensitivity=[]",
                ]);
                let network = &case.network.fixed.as_ref().unwrap().network;
                let [of_scene, of_network] = of_both(&case, network);
                assert_eq!(of_scene, of_network, "{base:?}");
                seen.extend(of_scene.into_iter().map(|(id, _)| id));
                pairs += 1;
            }
        }
        let wanted = [
            "broadly_graded",
            "cohesive_fines",
            "cu_unchecked",
            "few_replicates",
            "gap_graded",
            "given_network",
            "not_regraded",
            "one_replicate",
        ];
        assert!(wanted.iter().all(|id| seen.contains(*id)) && pairs == 27, "{seen:?}");
    }
}
