//! The kernel against the slow reference, particle by particle, on many small networks.

use std::sync::Arc;

use bitvec::vec::BitVec;
use proptest::prelude::*;
use voidwalk::gradation::{Gradation, SizeSampler};
use voidwalk::network::{ExitRule, Link, LinkEnd, LinkedVoids, Network};
use voidwalk::walk::reference::Reference;
use voidwalk::walk::{Arching, CHUNK, Clogged, Engine, LAWS, RunPlan, SizeClasses, State, Supply, Walk};

/// Diameters from a small set, so that ties, closed constrictions and blocking are frequent.
fn diameters(count: usize, palette: &[f32], mut seed: u64) -> Vec<f32> {
    let mut next = || {
        seed = seed.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (seed >> 33) as usize
    };
    (0..count).map(|_| palette[next() % palette.len()]).collect()
}

/// The same voids and constrictions without the shape, so that the general kernel walks them.
fn as_general(network: &Network) -> Network {
    let mut text = Vec::new();
    network.write_csv(&mut text).unwrap();
    let text = text.split(|&b| b == b'\n').skip(1).collect::<Vec<_>>().join(&b'\n');
    Network::from_csv(&text, "general.csv", network.unit_mm()).unwrap()
}

/// A particle beside an exit with 1e24 times the area of the only way out moves for longer than anybody
/// waits: such walks are compared for this long.
const LONG_ENOUGH: u64 = 300;

/// Walks both and compares everything after every increment; returns what is left of the constrictions.
fn compare(network: &Network, supply: &Supply, clogged: Clogged, seed: u64, run: u64) -> Clogged {
    let classes = SizeClasses::logarithmic(0.5, 4.0, 8);
    let mut reference =
        Reference::new(network, supply, clogged.blocked.iter().by_vals().collect(), seed, run);
    if !clogged.widths.is_empty() {
        reference = reference.from_widths(Some(clogged.widths.clone()));
    }
    let mut state = State::new(network, supply, classes, clogged, seed, run);
    let mut walk = Walk::new(network, supply, &state);
    let blocked_before = state.tally.blocked;
    while !reference.finished() && state.increment < LONG_ENOUGH {
        assert!(!state.finished, "the kernel ended early");
        walk.increment(&mut state).unwrap();
        reference.increment();
        let tally = &state.tally;
        if !state.finished {
            let mut moving = reference.moving.iter();
            for chunk in 0..state.particles.live.len() {
                let (voids, sizes) = state.particles.chunk(chunk);
                for (&void, &diameter) in voids.iter().zip(sizes) {
                    let expected = moving.next().expect("as many particles move");
                    assert_eq!(expected.rank as usize / CHUNK, chunk);
                    assert_eq!((void, diameter), (expected.void, expected.diameter));
                }
            }
            assert!(moving.next().is_none(), "as many particles move");
        }
        assert_eq!(tally.moving, reference.moving.len() as u64);
        assert_eq!(tally.eroded, reference.eroded.len() as u64);
        assert_eq!(tally.retained_in_constrictions, reference.stopped.len() as u64);
        assert_eq!((tally.retained_in_arches, tally.arches), (reference.arched, reference.arches));
        assert!((tally.arched_mass - reference.arched_mass).abs() <= 1e-9 * reference.arched_mass);
        assert_eq!(tally.retained_in_voids, reference.stranded.len() as u64);
        assert_eq!(tally.trapped, reference.trapped.len() as u64);
        assert_eq!(tally.particle_moves, reference.particle_moves);
        assert_eq!(tally.blocked, blocked_before + reference.history.len() as u64);
        let history: Vec<_> = state.history.iter().map(|b| (b.increment, b.constriction as usize)).collect();
        assert_eq!(history, reference.history);
        assert!(state.blocked.iter().by_vals().eq(reference.blocked.iter().copied()));
        let openings = state.openings.as_ref();
        assert_eq!(openings.map(|openings| &openings.widths), reference.widths.as_ref());
        assert_eq!(openings.map_or(0, |openings| openings.history.len()), reference.narrowings);
    }
    assert_eq!(state.finished, reference.finished());
    let cube = |d: f32| f64::from(d).powi(3);
    let eroded: f64 = reference.eroded.iter().map(|p| cube(p.diameter)).sum();
    assert!((state.tally.eroded_mass - eroded).abs() <= 1e-9 * eroded);
    let largest = reference.eroded.iter().map(|p| p.diameter).fold(0.0, f32::max);
    assert_eq!(state.tally.largest_eroded, largest);
    let upstream = network.upstream();
    let mut retained = vec![0; network.voids()];
    for (_, exit) in &reference.stopped {
        retained[upstream[*exit] as usize] += 1;
    }
    assert_eq!(state.retained_in_constrictions, retained);
    let mut retained = vec![0; network.voids()];
    for particle in &reference.stranded {
        retained[particle.void as usize] += 1;
    }
    assert_eq!(state.retained_in_voids, retained);
    assert_eq!(state.eroded_sizes.number.iter().sum::<u64>(), state.tally.eroded);
    state.into_clogged()
}

/// No arches in half of the cases, else one of the laws, dense or so thin that wide constrictions never jam.
fn law() -> impl Strategy<Value = Option<Arc<Arching>>> {
    let concentrations = prop::sample::select(vec![0.3, 0.02, 1e-5]);
    (0..2 * LAWS.len(), concentrations)
        .prop_map(|(k, concentration)| Some(Arc::new(Arching::new(LAWS.get(k)?, concentration))))
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(250))]

    /// Both runs, on the lattice and on the same network without its shape; start nodes and sizes independent or stratified.
    #[test]
    fn kernel_and_reference_agree_particle_by_particle(
        shape in [1u32..5, 1u32..5, 1u32..7],
        palette in prop::sample::select(vec![
            vec![1.0f32, 1.5, 2.0],
            vec![0.0, 1.0, 2.0, 3.0],
            vec![0.8, 1.0, 5.0, 5.0],
            vec![1e-6, 1.0, 1e6],
            vec![3.0],
        ]),
        cu in prop::sample::select(vec![1.0f64, 1.5, 3.0]),
        n in 1u64..800,
        increments in 1u64..40,
        evenly: bool,
        law in law(),
        open: bool,
        seed: u64,
    ) {
        let count = 3 * shape.iter().product::<u32>() as usize;
        let network = Network::cubic_from_diameters(shape, diameters(count, &palette, seed), 1.0).unwrap();
        let base = if cu == 1.0 { Gradation::single(1.0) } else { Gradation::linear_from_d0(0.7, cu) };
        let sampler = SizeSampler::new(&base.unwrap(), 1.0).unwrap();
        let supply = |run| {
            let independent = Supply::new(sampler.clone(), n, increments).arching_by(law.clone()).leaving_openings(open);
            if evenly { independent.stratified(seed, run) } else { independent }
        };
        for network in [&network, &as_general(&network)] {
            let blocked = compare(network, &supply(1), Clogged::none(network), seed, 1);
            compare(network, &supply(2), blocked, seed, 2);
        }
    }

    /// Any directed graph, with scattered start nodes, dead ends, self-loops and parallel constrictions.
    #[test]
    fn general_networks_agree_with_the_reference(
        edges in prop::collection::vec((0u32..8, 0u32..9, 0usize..4), 1..30),
        n in 1u64..400,
        law in law(),
        evenly: bool,
        open: bool,
        seed: u64,
    ) {
        let mut text = String::from("from,to,diameter_mm\nstart,5,\nstart,0,\nstart,3,\n");
        for void in 1..8 {
            // Every void is named, so that ids have no gaps.
            text.push_str(&format!("{},{void},0\n", void - 1));
        }
        for (from, to, size) in edges {
            let to = if to == 8 { "end".to_string() } else { to.to_string() };
            text.push_str(&format!("{from},{to},{}\n", [0.5, 1.0, 1.5, 2.5][size]));
        }
        let network = Network::from_csv(text.as_bytes(), "graph.csv", 1.0).unwrap();
        let base = Gradation::linear_from_d0(0.7, 1.6).unwrap();
        let supply = Supply::new(SizeSampler::new(&base, 1.0).unwrap(), n, 10).arching_by(law).leaving_openings(open);
        let supply = if evenly { supply.stratified(seed, 1) } else { supply };
        compare(&network, &supply, Clogged::none(&network), seed, 1);
    }
}

/// Walks both as long as the reference, which knows the particles alone that are not passive, and this walk to
/// its end: those and what they block are compared after every increment, and nothing is lost.
fn compare_coarse(network: &Network, supply: &Supply, n: u64, seed: u64) {
    let clogged = Clogged::none(network);
    let mut reference = Reference::new(network, supply, vec![false; network.constrictions()], seed, 1);
    let mut state = State::new(network, supply, SizeClasses::logarithmic(0.1, 4.0, 8), clogged, seed, 1);
    let mut walk = Walk::new(network, supply, &state);
    while !state.finished && state.increment < LONG_ENOUGH {
        walk.increment(&mut state).unwrap();
        let tally = &state.tally;
        assert!(tally.retained_in_arches <= tally.retained_in_constrictions);
        let held = tally.retained_in_constrictions + tally.retained_in_voids + tally.trapped;
        assert_eq!(tally.inserted, tally.eroded + held + tally.moving);
        if reference.finished() {
            continue;
        }
        reference.increment();
        assert_eq!(tally.retained_in_constrictions, reference.stopped.len() as u64);
        assert_eq!((tally.retained_in_arches, tally.arches), (reference.arched, reference.arches));
        let arched = reference.arched_mass;
        assert!(
            (tally.arched_mass - arched).abs() <= 1e-9 * arched.max(1.0),
            "{} {arched}",
            tally.arched_mass
        );
        let history: Vec<_> = state.history.iter().map(|b| (b.increment, b.constriction as usize)).collect();
        assert_eq!(history, reference.history);
        if state.finished || reference.finished() {
            continue;
        }
        let mut moving = reference.moving.iter();
        for chunk in 0..state.particles.live.len() {
            let (voids, sizes) = state.particles.chunk(chunk);
            for (&void, &diameter) in voids.iter().zip(sizes) {
                let expected = moving.next().expect("as many particles move");
                assert_eq!((void, diameter), (expected.void, expected.diameter));
            }
        }
        assert!(moving.next().is_none(), "as many particles move");
    }
    if state.finished {
        assert_eq!((state.tally.inserted, state.tally.moving), (n, 0));
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(250))]

    /// Engines that keep passive particles as counts or as an expectation: the others, and their arches, are as the
    /// reference says.
    #[test]
    fn arches_beside_passive_particles_agree_with_the_reference(
        shape in [1u32..5, 1u32..5, 1u32..7],
        palette in prop::sample::select(vec![vec![1.0f32, 1.5, 2.0], vec![1.5, 2.0, 3.0], vec![0.8, 1.0, 5.0]]),
        n in 1u64..1000,
        increments in 1u64..40,
        law in law(),
        engine in prop::sample::select(vec![Engine::Counts, Engine::Expected]),
        seed: u64,
    ) {
        let count = 3 * shape.iter().product::<u32>() as usize;
        let network = Network::cubic_from_diameters(shape, diameters(count, &palette, seed), 1.0).unwrap();
        // From too fine for any arch to coarser than some constrictions.
        let sampler = SizeSampler::new(&Gradation::linear_from_d0(0.15, 15.0).unwrap(), 1.0).unwrap();
        for network in [&network, &as_general(&network)] {
            let open = BitVec::repeat(false, network.constrictions());
            let plan = RunPlan::with_clogging(engine, network, &sampler, &open, n, (law.clone(), false));
            prop_assert_eq!(plan.engine(), engine);
            compare_coarse(network, &plan.supply(sampler.clone(), n, increments, seed, 1), n, seed);
        }
    }
}

/// Voids and constrictions without a direction, with parallel ones, dead ends and voids that nothing leads to;
/// `None` where nothing leads through.
fn linked(rule: ExitRule, rho: f64, voids: u32, links: &[(u32, u32, usize, usize)]) -> Option<Network> {
    // The two ends above the voids are outside.
    let end = |at: u32| if at >= voids { LinkEnd::Outside } else { LinkEnd::Void(at) };
    let links: Vec<Link> = links
        .iter()
        .map(|&(from, to, size, flow)| Link {
            from: end(from),
            to: end(to),
            diameter: [0.5, 1.0, 1.5, 2.5][size],
            conductance: [0.0, 1.0, 3.0, 1e-3][flow],
            rise: f64::from(to) - f64::from(from),
        })
        .collect();
    let layer = (0..voids).map(|v| v / 2).collect();
    Network::linked(LinkedVoids { layer, unit_mm: 1.0, rule, rho, ..LinkedVoids::default() }, &links).ok()
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(250))]

    /// Constrictions that can be passed both ways, and water that gives them their direction: both runs, one by
    /// one.
    #[test]
    fn undirected_networks_agree_with_the_reference(
        rule in prop::sample::select(vec![ExitRule::Flux, ExitRule::AreaAlongFlow, ExitRule::Height]),
        rho in prop::sample::select(vec![0.0, 0.1]),
        links in prop::collection::vec((0u32..12, 0u32..12, 0usize..4, 0usize..4), 12..60),
        n in 1u64..600,
        increments in 1u64..20,
        law in law(),
        open: bool,
        seed: u64,
    ) {
        let Some(network) = linked(rule, rho, 10, &links) else { return Ok(()) };
        let base = Gradation::linear_from_d0(0.4, 2.6).unwrap();
        let sampler = SizeSampler::new(&base, 1.0).unwrap();
        let supply = Supply::new(sampler, n, increments).arching_by(law).leaving_openings(open);
        let blocked = compare(&network, &supply, Clogged::none(&network), seed, 1);
        compare(&network, &supply, blocked, seed, 2);
    }
}

/// Most of the random networks lead through, so that the comparison says something.
#[test]
fn most_random_networks_lead_through() {
    let mut seed = 7u64;
    let mut next = |below: u32| {
        seed = seed.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (seed >> 33) as u32 % below
    };
    let links = |next: &mut dyn FnMut(u32) -> u32| {
        (0..40).map(|_| (next(12), next(12), next(4) as usize, next(4) as usize)).collect::<Vec<_>>()
    };
    let through = (0..200).filter(|_| linked(ExitRule::Flux, 0.0, 10, &links(&mut next)).is_some()).count();
    assert!(through > 150, "{through}");
}

/// Several chunks, some of them drained, inserted over chunk borders.
#[test]
fn chunks_are_filled_and_drained_as_the_reference_says() {
    let count = 3 * 4 * 4 * 3;
    let network = Network::cubic_from_diameters([4, 4, 3], diameters(count, &[1.0, 2.0], 5), 1.0).unwrap();
    let base = Gradation::linear_from_d0(0.7, 1.3).unwrap();
    let supply = Supply::new(SizeSampler::new(&base, 1.0).unwrap(), 2 * CHUNK as u64 + 77, 3);
    compare(&network, &supply, Clogged::none(&network), 11, 1);
}

/// Arches of mixed sizes whose particles lie in three chunks: the first of all says how many stay.
#[test]
fn arches_over_several_chunks_are_as_the_reference_says() {
    let count = 3 * 2 * 2 * 3;
    let network = Network::cubic_from_diameters([2, 2, 3], diameters(count, &[2.0, 3.0], 5), 1.0).unwrap();
    let base = Gradation::linear_from_d0(0.7, 2.5).unwrap();
    let law = Arching::new(LAWS.iter().find(|law| law.name == "critical-3").unwrap(), 0.0);
    let supply = Supply::new(SizeSampler::new(&base, 1.0).unwrap(), 2 * CHUNK as u64 + 7_232, 1)
        .arching_by(Some(Arc::new(law)));
    let clogged = compare(&network, &supply, Clogged::none(&network), 11, 1);
    // All of the first layer.
    assert!(clogged.blocked.count_ones() >= 12);
}
