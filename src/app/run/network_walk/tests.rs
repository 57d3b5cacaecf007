//! Walks of networks that are given: beside those of a scene, by hand, refused, and their notes.

use super::*;
use crate::case::Case;
use crate::outcome::record::ModelLimit;
use crate::run::{Exit, case_of, walk_case};
use std::collections::BTreeSet;
use std::fs;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering::Relaxed};
use voidwalk_core::constrictions::find;
use voidwalk_core::network::{ExitRule, NetworkColumns};

fn lattice(shape: [u32; 3]) -> Arc<Network> {
    let curve = find("cu1.5-loose").unwrap().curve().unwrap().in_mm(1.0).unwrap();
    Arc::new(Network::cubic(shape, &curve, 1.0, 5).unwrap())
}

/// Constrictions from void 0 to an outlet, walked with water.
fn columns<'a>(conns: &'a [[i64; 2]], diameter_mm: &'a [f64], outlets: &'a [u32]) -> NetworkColumns<'a> {
    let voids = 1 + *conns.as_flattened().iter().max().unwrap() as usize;
    let (inlets, rule, rho, unit_mm) = (&[0], ExitRule::Flux, 0.0, 1.0);
    NetworkColumns { voids, conns, diameter_mm, conductance: None, inlets, outlets, rule, rho, unit_mm }
}

fn walk(network: &Arc<Network>, plan: &NetworkWalk) -> NetworkOutcome {
    walk_networks(&[Arc::clone(network)], plan, &Callbacks::default()).unwrap()
}

fn one_size(mm: f64, replicates: u64) -> NetworkWalk {
    NetworkWalk { replicates, ..NetworkWalk::new(Gradation::single(mm).unwrap(), 1000) }
}

/// Walks of the soils of a case.
fn plan_of(case: &Case) -> NetworkWalk {
    let filter = GivenFilter {
        gradation: case.filter.gradation.clone(),
        is_measured: case.filter_is_measured(),
        grains_per_void: case.filter.grains_per_void,
    };
    NetworkWalk {
        increments: case.increments(),
        filter: Some(filter),
        ..NetworkWalk::new(case.base.gradation.clone(), case.supply.n_base)
    }
}

/// Covers engines that record and engines that count, both runs, and every figure but the time.
#[test]
fn a_network_is_walked_as_the_scene_that_names_it_walks_it() {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("net.csv");
    let mut text = Vec::new();
    let network = lattice([6, 6, 8]);
    network.write_csv(&mut text).unwrap();
    std::fs::write(&file, text).unwrap();
    for engine in ["particles", "counts", "expected"] {
        let case = case_of(&[
            "seed=9",
            "replicates=3",
            &format!("engine={engine}"),
            "filter.cu=1.5",
            &format!("network.file={}", file.display()),
            "base.cu=3",
            "base.d85_mm=0.25",
            "base.n_base=30000",
            "record.sensitivity=[]",
        ]);
        let runs = AtomicU64::new(0);
        let on_event = |event: Event| {
            runs.fetch_add(u64::from(matches!(event, Event::RunDone)), Relaxed);
        };
        let callbacks = Callbacks { on_event: &on_event, ..Callbacks::default() };
        let mut expected = walk_case(&case, &callbacks).unwrap();
        assert_eq!(runs.into_inner(), 6);
        let plan = NetworkWalk {
            seed: 9,
            replicates: 3,
            engine: Engine::ALL.into_iter().find(|e| e.name() == engine).unwrap(),
            ..plan_of(&case)
        };
        let mut outcome = walk(&network, &plan);
        assert_eq!((outcome.verdict, &outcome.summary), (expected.model.class, &expected.summary));
        for (walked, expected) in outcome.replicates.iter_mut().zip(&mut expected.replicates) {
            let replicate = &mut walked.result.replicate;
            let runs = replicate.runs.iter_mut().chain(&mut expected.runs);
            runs.for_each(|run| run.seconds = 0.0);
            assert_eq!(replicate, expected);
            let at_end = walked.blocked.iter().map(|blocked| blocked.count_ones() as u64);
            assert!(at_end.eq(expected.runs.iter().map(|run| run.blocked)));
        }
    }
}

#[test]
fn an_undirected_network_is_walked_both_ways() {
    // A ring of four voids, inlet at void 0 and outlet at void 2: one side lets nothing through.
    let ring = columns(&[[0, 1], [2, 1], [0, 3], [3, 2]], &[1.0, 1.0, 0.4, 0.4], &[2]);
    let ring = NetworkColumns { conductance: Some(&[1.0; 4]), ..ring };
    let (network, exit) = Network::from_columns(&ring).unwrap();
    let outcome = walk(&Arc::new(network), &one_size(0.5, 4));
    for walked in &outcome.replicates {
        // One particle blocks the narrow side: all others take the wide side, at the end of the ring.
        let at_end: Vec<bool> = exit.iter().map(|&exit| walked.blocked[1][exit as usize]).collect();
        assert_eq!(at_end, [false, false, true, false]);
        let run = &walked.result.replicate.runs[1];
        assert_eq!((run.eroded, run.retained_in_constrictions, run.blocked), (1000, 0, 1));
    }
}

#[test]
fn what_cannot_be_walked_is_refused_and_a_stop_is_heard() {
    let networks = [lattice([6, 6, 8])];
    let refused = |plan: NetworkWalk, message: &str| {
        let error = walk_networks(&networks, &plan, &Callbacks::default()).err().unwrap();
        assert!(error.exit() == Exit::Refused && error.to_string().contains(message), "{error}");
    };
    let plan = NetworkWalk::new(Gradation::linear_from_d0(0.1, 1.5).unwrap(), 10_000);
    let message = "runs = 3 is not allowed; a whole number from 1 to 2";
    refused(NetworkWalk { runs: 3, ..plan.clone() }, message);
    refused(NetworkWalk { n_base: 0, ..plan.clone() }, "n_base = 0");
    let huge = NetworkWalk { n_base: 1 << 60, engine: Engine::Particles, ..plan.clone() };
    refused(huge, "of memory, but");
    let tail = Gradation::from_lines(&[(0.3, 20.0), (0.4, 100.0)]).unwrap();
    refused(NetworkWalk { base: tail, ..plan.clone() }, "may not be passive");
    let stop = AtomicBool::new(true);
    let callbacks = Callbacks { stop: &stop, ..Callbacks::default() };
    let error = walk_networks(&networks, &plan, &callbacks).err().unwrap();
    assert_eq!(error.exit(), Exit::Stopped);
}

/// Two constrictions are passed both ways and one is closed from the start; each is counted once.
#[test]
fn a_record_says_what_was_walked_through() {
    let columns = columns(&[[0, 1], [1, 2], [0, 2]], &[0.5, 0.25, 0.0], &[2]);
    let columns = NetworkColumns { unit_mm: 0.5, ..columns };
    let network = Arc::new(Network::from_columns(&columns).unwrap().0);
    let plan = one_size(0.1, 2);
    let outcome = walk(&network, &plan);
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
    let network = lattice([10, 10, 12]);
    let filter = filter.map(|gradation| GivenFilter { gradation, is_measured: true, grains_per_void });
    let base = Gradation::linear_from_dx(85.0, 0.25, 1.5).unwrap();
    let mut plan = NetworkWalk { replicates: 6, filter, ..NetworkWalk::new(base, 1) };
    let eq2 = plan.eq2(&network, 0.05).unwrap();
    plan.n_base = n_base.or(eq2).unwrap();
    (plan.n_base, walk(&network, &plan).notes(&plan, &network, 1))
}

/// Numbers that fall short of Eq. (2), exceed it or cannot be compared with it are doubts; the number of
/// Eq. (2) is not.
#[test]
fn a_number_of_particles_that_is_not_that_of_equation_two_is_a_doubt() {
    let filter = || Gradation::linear_from_d0(1.0, 1.5).ok();
    let has = |notes: &[Note], id: &str| notes.iter().any(|note| note.id() == id);
    let (n, of_eq2) = number_and_notes(None, filter(), Some(0.6));
    let doubts = ["few_particles", "more_particles", "amount_unknown"];
    assert!(n > 1000 && !doubts.iter().any(|id| has(&of_eq2, id)));
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
    let columns = columns(&[[0, 1]], &[0.1], &[1]);
    let network = Arc::new(Network::from_columns(&columns).unwrap().0);
    let plan = one_size(0.2, 2);
    let notes = walk(&network, &plan).notes(&plan, &network, 1);
    assert!(notes.iter().any(|note| note.id() == "clogged"), "{notes:?}");
}

/// Notes that only a scene has: on its files, and on a filter's pan fraction, which matters if Eq. (2)
/// gives the base.
const OF_A_SCENE: [&str; 2] = ["read_as", "pan_of_filter"];

/// Notes on a scene, and on a walk of its soils on its network without it; the list above is left out.
fn of_both(case: &Case, network: &Network) -> [BTreeSet<(String, String)>; 2] {
    let plan = plan_of(case);
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
        let case = case_of(&[&own[..], &small, &["inject_share=0.1", "replicates=2"]].concat());
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
