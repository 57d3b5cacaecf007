//! Water through networks, and particles that it carries, against exact and independent answers.

use bitvec::vec::BitVec;
use voidwalk::constrictions::{Curve, CurveUnit};
use voidwalk::gradation::{Gradation, SizeSampler};
use voidwalk::network::{ExitRule, Flow, Link, LinkEnd, LinkedVoids, Network};
use voidwalk::outcome::{RunId, RunMetrics};
use voidwalk::walk::{
    Engine, FlowRecord, FlowSolution, RunPlan, Sampling, SizeClasses, State, Supply, Walk, WalkControl,
};

const OUTSIDE: LinkEnd = LinkEnd::Outside;

/// A constriction that nothing in these tests is too coarse for.
fn link(from: LinkEnd, to: LinkEnd, conductance: f64) -> Link {
    Link { from, to, diameter: 10.0, conductance, rise: 1.0 }
}

fn linked(voids: u32, links: &[Link]) -> Network {
    let layer = (0..voids).collect();
    let voids = LinkedVoids { layer, unit_mm: 1.0, rule: ExitRule::Flux, ..LinkedVoids::default() };
    Network::linked(voids, links).unwrap()
}

fn open(network: &Network) -> BitVec {
    BitVec::repeat(false, network.constrictions())
}

fn conductance(network: &Network) -> f64 {
    Flow::new(network).solve(network, &open(network)).unwrap().conductance
}

/// A lattice without directions, with diameters drawn evenly between two.
fn lattice(shape: [u32; 3], [low, high]: [f64; 2], exponent: f64, seed: u64) -> Network {
    let curve = Curve::from_points(&[(0.0, low), (100.0, high)], CurveUnit::Mm).unwrap();
    let directed = Network::cubic(shape, &curve, 1.0, seed).unwrap();
    directed.undirected_lattice(ExitRule::Flux, 0.0, exponent).unwrap()
}

#[test]
fn resistors_add_up() {
    use LinkEnd::Void;
    let series =
        linked(2, &[link(OUTSIDE, Void(0), 1.0), link(Void(0), Void(1), 2.0), link(Void(1), OUTSIDE, 4.0)]);
    assert!((conductance(&series) - 1.0 / 1.75).abs() < 1e-10);
    let parallel = [link(OUTSIDE, Void(0), 6.0), link(Void(0), OUTSIDE, 1.0), link(Void(0), OUTSIDE, 2.0)];
    assert!((conductance(&linked(1, &parallel)) - 2.0).abs() < 1e-10);
    // Wheatstone's bridge, 1 and 2 above, 3 and 4 below, 5 across: from the two equations by hand,
    // 9 a - 5 b = 1 and 11 b - 5 a = 2, so a = 21 / 74, b = 23 / 74, and Q = (1 - a) + 2 (1 - b) = 155 / 74.
    let bridge = linked(
        2,
        &[
            link(OUTSIDE, Void(0), 1.0),
            link(OUTSIDE, Void(1), 2.0),
            link(Void(0), OUTSIDE, 3.0),
            link(Void(1), OUTSIDE, 4.0),
            link(Void(0), Void(1), 5.0),
        ],
    );
    let mut flow = Flow::new(&bridge);
    let found = flow.solve(&bridge, &open(&bridge)).unwrap().conductance;
    assert!((found - 155.0 / 74.0).abs() < 1e-9, "{found}");
    assert!(
        (flow.pressure()[0] - 21.0 / 74.0).abs() < 1e-9 && (flow.pressure()[1] - 23.0 / 74.0).abs() < 1e-9
    );
}

/// A unit of conductance changes no digit, however large or small: squares of such numbers are none. What the
/// unit is worked out from are even powers of two; `scripts/checks/same_bits.py` holds the digits of packings.
#[test]
fn the_unit_of_conductance_is_free() {
    use LinkEnd::Void;
    let of = |unit: f64| {
        let links = [(OUTSIDE, Void(0), 1.0), (Void(0), Void(1), 2.0), (Void(1), OUTSIDE, 5.0)];
        let network = linked(2, &links.map(|(from, to, g)| link(from, to, g * unit)));
        let mut flow = Flow::new(&network);
        let found = flow.solve(&network, &open(&network)).unwrap().conductance;
        (found / unit, flow.pressure().to_vec())
    };
    assert!((of(1.0).0 - 1.0 / 1.7).abs() < 1e-10);
    assert_eq!(of(2f64.powi(900)), of(1.0));
    assert_eq!(of(2f64.powi(-900)), of(1.0));
}

/// Where inlets conduct so well that rounding hides the fall of pressure in them, what passes is known all the same,
/// and every void leads on.
#[test]
fn a_flow_that_rounding_hides_is_found_by_elimination() {
    use LinkEnd::Void;
    for inlet in [1e6, 1e8, 1e15, 1e20, 1e200, 1e300] {
        let links = [(OUTSIDE, Void(0), inlet), (Void(0), Void(1), 1.0), (Void(1), OUTSIDE, 1.0)];
        let mut network = linked(2, &links.map(|(from, to, g)| link(from, to, g)));
        let mut flow = Flow::new(&network);
        let found = flow.solve(&network, &open(&network)).unwrap().conductance;
        assert!((found - 1.0 / (2.0 + 1.0 / inlet)).abs() < 1e-6, "{inlet}: {found}");
        flow.direct(&mut network);
        for void in 0..network.voids() as u32 {
            let weights: f64 = network.exits(void).map(|c| network.exit_weight(c)).sum();
            assert!((weights - found).abs() < 1e-6, "{inlet}, void {void}: {weights}");
        }
    }
}

/// Throats side by side and one behind the other, of any contrast.
#[test]
fn throats_of_any_contrast_are_solved() {
    use LinkEnd::Void;
    for contrast in [1e12, 1e14, 1e30] {
        let narrow = 1.0 / contrast;
        let beside =
            [link(OUTSIDE, Void(0), 1.0), link(Void(0), OUTSIDE, 1.0), link(Void(0), OUTSIDE, narrow)];
        assert!((conductance(&linked(1, &beside)) / 0.5 - 1.0).abs() < 1e-6, "{contrast}");
        let behind =
            [link(OUTSIDE, Void(0), 1.0), link(Void(0), Void(1), narrow), link(Void(1), OUTSIDE, 1.0)];
        assert!((conductance(&linked(2, &behind)) / narrow - 1.0).abs() < 1e-6, "{contrast}");
    }
}

/// A way in that carries enough to count, behind which water parts so that neither way does: the wider one leads on,
/// and the void retains nothing.
#[test]
fn a_void_that_water_enters_leads_on() {
    use LinkEnd::Void;
    let links = [
        (OUTSIDE, Void(0), 1.0),
        (Void(0), OUTSIDE, 1.0),
        (OUTSIDE, Void(1), 4e-9),
        (Void(1), Void(2), 1.0),
        (Void(1), Void(3), 2.0),
        (Void(2), OUTSIDE, 1.0),
        (Void(3), OUTSIDE, 1.0),
    ];
    let mut network = linked(4, &links.map(|(from, to, g)| link(from, to, g)));
    let mut flow = Flow::new(&network);
    flow.solve(&network, &open(&network)).unwrap();
    flow.direct(&mut network);
    let ways = |void: u32| network.exits(void).filter(|&c| network.exit_weight(c) > 0.0).collect::<Vec<_>>();
    let of_one = ways(1);
    assert_eq!(of_one.iter().map(|&c| network.targets()[c]).collect::<Vec<_>>(), [3]);
    assert!((flow.flux(of_one[0]) / (4e-9 * 4.0 / 7.0) - 1.0).abs() < 0.1);
    assert_eq!((ways(2).len(), ways(3).len()), (1, 1));
}

/// Inlets that leak through what blocks them: no particle gets in, and what seeps is known all the same.
#[test]
fn a_leak_is_no_open_way() {
    use LinkEnd::Void;
    let links = [(OUTSIDE, Void(0), 1.0), (Void(0), Void(1), 1.0), (Void(1), OUTSIDE, 1.0)];
    for rho in [1e-3, 1e-9, 1e-14] {
        let voids = LinkedVoids {
            layer: vec![0, 1],
            unit_mm: 1.0,
            rule: ExitRule::Flux,
            rho,
            ..LinkedVoids::default()
        };
        let network = Network::linked(voids, &links.map(|(from, to, g)| link(from, to, g))).unwrap();
        let (mut blocked, mut flow) = (open(&network), Flow::new(&network));
        flow.solve(&network, &blocked).unwrap();
        let inlet = network.exits(network.reservoir().unwrap()).start;
        network.set_blocked(&mut blocked, inlet, true);
        let found = flow.solve(&network, &blocked).unwrap().conductance;
        assert!((found - 1.0 / (1.0 / rho + 2.0)).abs() < 1e-6, "{rho}: {found}");
    }
}

/// What flows in flows out, pressures lie between those outside, and the work of the pressure is dissipated.
#[test]
fn water_is_kept_and_its_work_dissipated() {
    let network = lattice([9, 7, 15], [0.1, 0.4], 4.0, 3);
    let mut blocked = open(&network);
    (0..network.constrictions()).step_by(7).for_each(|c| blocked.set(c, true));
    for c in 0..network.constrictions() {
        if blocked[c]
            && let Some(twin) = network.twin(c)
        {
            blocked.set(twin, true);
        }
    }
    let mut flow = Flow::new(&network);
    let through = flow.solve(&network, &blocked).unwrap().conductance;
    assert!(flow.pressure().iter().all(|p| (-1e-9..=1.0 + 1e-9).contains(p)));
    let (mut out, mut work) = (0.0, 0.0);
    for void in 0..network.voids() as u32 {
        for c in network.exits(void) {
            let to = network.targets()[c];
            let beyond = if to == voidwalk::network::END { 0.0 } else { flow.pressure()[to as usize] };
            let fall = flow.pressure()[void as usize] - beyond;
            if to == voidwalk::network::END {
                out += flow.flux(c);
            }
            // Each constriction once.
            if network.twin(c).is_none_or(|twin| c < twin) {
                work += flow.flux(c) * fall;
            }
        }
    }
    assert!(
        (out / through - 1.0).abs() < 1e-9 && (work / through - 1.0).abs() < 1e-9,
        "{out} {work} {through}"
    );
}

/// Walks `n` particles of one size, and gives the state, the flow and the network at the end.
fn walk(
    network: &Network,
    size: f64,
    n: u64,
    engine: Engine,
    seed: u64,
) -> (State, Option<FlowRecord>, Network) {
    let sampler = SizeSampler::new(&Gradation::single(size).unwrap(), 1.0).unwrap();
    let classes = SizeClasses::logarithmic(size as f32, size as f32, 1);
    let plan = RunPlan::new(engine, network, &sampler, &open(network), n / 20).sampled(Sampling::Independent);
    let supply: Supply = plan.supply(sampler, n, 20, seed, 1);
    let mut state = State::new(network, &supply, classes, open(network), seed, 1);
    let mut walk = Walk::new(network, &supply, &state);
    walk.run(&mut state, &mut |_| WalkControl::Continue).unwrap();
    let (end, flow, _) = walk.end(&state).unwrap();
    (state, flow, end.into_owned())
}

fn id() -> RunId {
    RunId { replicate: 1, run: 1, d15f_mm: 1.0, pan_fraction: 0.0 }
}

/// Where all constrictions are equal water flows straight down, and so does every particle.
#[test]
fn particles_fall_straight_through_an_even_lattice() {
    for engine in [Engine::Particles, Engine::Counts, Engine::Expected] {
        let network = lattice([6, 5, 13], [0.3, 0.3], 4.0, 1);
        let (state, flow, end) = walk(&network, 0.1, 40_000, engine, 5);
        let run = RunMetrics::new(&end, &state, flow.as_ref(), id(), 0.0).run;
        assert_eq!((run.eroded, run.particle_moves), (40_000, 40_000 * 13), "{engine:?}");
        assert_eq!(run.k_over_k0, Some(1.0));
        // A third of the constrictions carries water.
        assert!((run.backbone_fraction - 1.0 / 3.0).abs() < 1e-12);
    }
}

/// Passive particles follow the water: the mean number of moves is the sum of all fluxes over that through the
/// whole. With 2e5 particles and a spread below 10 moves the mean is known to 0.02; the test would miss a bias
/// below 0.1 moves.
#[test]
fn passive_particles_move_as_water_does() {
    let network = lattice([8, 8, 20], [0.1, 0.4], 4.0, 11);
    let mut flow = Flow::new(&network);
    let through = flow.solve(&network, &open(&network)).unwrap().conductance;
    let reservoir = network.reservoir().unwrap();
    let inner = (0..network.voids() as u32).filter(|&void| void != reservoir);
    let all: f64 = inner
        .flat_map(|void| network.exits(void).map(move |c| (void, c)))
        .map(|(_, c)| flow.flux(c).max(0.0))
        .sum();
    for engine in [Engine::Particles, Engine::Counts] {
        let n = 200_000;
        let (state, record, end) = walk(&network, 0.05, n, engine, 7);
        let run = RunMetrics::new(&end, &state, record.as_ref(), id(), 0.0).run;
        assert_eq!(run.eroded, n);
        let mean = run.particle_moves as f64 / n as f64;
        assert!((mean - all / through).abs() < 0.1, "{engine:?}: {mean} against {}", all / through);
    }
}

/// Equal conductances of which a few are missing at random: 1 - 1.5 f by effective medium theory, exact to first
/// order in f (Kirkpatrick 1973, doi:10.1103/RevModPhys.45.574). Above a share of 0.7512 missing nothing leads
/// through. Seeds are fixed; with 27,000 constrictions the scatter is below 0.01.
#[test]
fn missing_bonds_lower_permeability_as_effective_medium_says() {
    let network = lattice([30, 30, 30], [0.3, 0.3], 4.0, 1);
    let of = |share: f64| {
        let mut word = 88_172_645_463_325_252u64;
        let mut blocked = open(&network);
        for c in 0..network.constrictions() {
            if !network.counts(c) {
                continue;
            }
            word ^= word << 13;
            word ^= word >> 7;
            word ^= word << 17;
            if (word >> 11) as f64 / 9_007_199_254_740_992.0 < share {
                blocked.set(c, true);
                if let Some(twin) = network.twin(c) {
                    blocked.set(twin, true);
                }
            }
        }
        Flow::new(&network).solve(&network, &blocked).unwrap().conductance
    };
    let clean = of(0.0);
    for share in [0.02, 0.05, 0.1] {
        let expected = 1.0 - 1.5 * share;
        assert!((of(share) / clean - expected).abs() < 0.012, "{share}: {} {expected}", of(share) / clean);
    }
    assert_eq!(of(0.9), 0.0);
    assert!(of(0.65) > 0.0);
}

/// Conductances in proportion to the square and to the fourth power of a size spread evenly over a factor of 4:
/// the medium's m is the root of the mean of (g - m) / (g + 2 m), within 2 %.
#[test]
fn spread_conductances_act_as_their_effective_medium() {
    for exponent in [2.0, 4.0] {
        let [low, high] = [0.1f64, 0.4];
        let g = |k: u32| libm::pow(low + (high - low) * (f64::from(k) + 0.5) / 10_000.0, exponent);
        let (mut below, mut above) = (g(0), g(9_999));
        for _ in 0..60 {
            let m = 0.5 * (below + above);
            let mean: f64 = (0..10_000).map(|k| (g(k) - m) / (g(k) + 2.0 * m)).sum();
            if mean > 0.0 { below = m } else { above = m }
        }
        let (n, nz) = (24u32, 48u32);
        let found = conductance(&lattice([n, n, nz], [low, high], exponent, 4));
        let mean = (0..10_000).map(g).sum::<f64>() / 10_000.0;
        // In series with the ways in.
        let layers = f64::from(nz) / below + 1.0 / mean;
        let medium = found * layers / f64::from(n * n);
        assert!((medium - 1.0).abs() < 0.02, "{exponent}: {medium}");
    }
}

/// Particles coarser than every constriction close all ways in; a run in which nothing can flow ends.
#[test]
fn a_filter_that_clogs_wholly_ends_its_run() {
    use LinkEnd::Void;
    let narrow = |from, to| Link { from, to, diameter: 0.1, conductance: 1.0, rise: 1.0 };
    let network = linked(2, &[narrow(OUTSIDE, Void(0)), narrow(Void(0), Void(1)), narrow(Void(1), OUTSIDE)]);
    for engine in [Engine::Particles, Engine::Counts] {
        let (state, flow, end) = walk(&network, 0.2, 1000, engine, 1);
        let run = RunMetrics::new(&end, &state, flow.as_ref(), id(), 0.0).run;
        assert_eq!((run.eroded, run.blocked, run.k_over_k0), (0, 1, Some(0.0)), "{engine:?}");
        // What is not in yet stays at the face.
        assert_eq!(run.retained_in_constrictions + run.retained_in_voids, 1000);
        assert_eq!(state.retained_in_voids[2] + state.retained_in_constrictions[2], 1000);
    }
}

/// Threads, engines that follow one history, and the instructions change no bit.
#[test]
fn counts_and_particles_share_one_history_of_blocking() {
    let network = lattice([6, 6, 12], [0.1, 0.3], 4.0, 2);
    let sampler = SizeSampler::new(&Gradation::linear_from_d0(0.05, 2.2).unwrap(), 1.0).unwrap();
    let classes = || SizeClasses::logarithmic(sampler.smallest(), sampler.largest(), 16);
    let run = |engine: Engine, threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| {
            let plan = RunPlan::new(engine, &network, &sampler, &open(&network), 200_000 / 20);
            let supply = plan.supply(sampler.clone(), 200_000, 20, 9, 1);
            let mut state = State::new(&network, &supply, classes(), open(&network), 9, 1);
            let mut walk = Walk::new(&network, &supply, &state);
            walk.run(&mut state, &mut |_| WalkControl::Continue).unwrap();
            let (_, flow, _) = walk.end(&state).unwrap();
            (state, flow.unwrap())
        })
    };
    for engine in [Engine::Particles, Engine::Counts, Engine::Expected] {
        let (one, flow) = run(engine, 1);
        let solutions = &flow.solutions;
        assert!(one.tally.blocked > 20 && solutions.len() > 3, "{engine:?}");
        assert!(solutions.is_sorted_by(|a, b| b.k_over_k0 <= a.k_over_k0 + 1e-9), "{solutions:?}");
        // What had closed before each is more than the tolerance, or ten increments have gone by, but at the end.
        let is_late = |pair: &[FlowSolution]| pair[1].increment >= pair[0].increment + 10;
        let last = solutions.len() - 2;
        let due = |(at, pair): (usize, &[FlowSolution])| {
            at == last || pair[1].closed >= network.flow_tolerance() || is_late(pair)
        };
        assert!(solutions.windows(2).enumerate().all(due), "{solutions:?}");
        for threads in [2, 3, 8] {
            let (other, other_flow) = run(engine, threads);
            assert_eq!((other.tally, &other.history), (one.tally, &one.history), "{engine:?} {threads}");
            assert_eq!(other.retained_in_voids, one.retained_in_voids);
            assert_eq!(other_flow, flow);
        }
    }
}

#[test]
fn networks_that_nothing_can_pass_are_refused_by_name() {
    use LinkEnd::Void;
    let of = |links: &[Link]| {
        let voids =
            LinkedVoids { layer: vec![0, 0], unit_mm: 1.0, rule: ExitRule::Flux, ..LinkedVoids::default() };
        Network::linked(voids, links).unwrap_err().to_string()
    };
    let (into, on, out) =
        (link(OUTSIDE, Void(0), 1.0), link(Void(0), Void(1), 1.0), link(Void(1), OUTSIDE, 1.0));
    assert!(of(&[on, out]).contains("no inlet"));
    assert!(of(&[into, on]).contains("no outlet"));
    assert!(of(&[into, out]).contains("no open way"));
    assert!(of(&[into, Link { conductance: 0.0, ..on }, out]).contains("no open way"));
    assert!(of(&[into, Link { diameter: 0.0, ..on }, out]).contains("no open way"));
    assert!(of(&[into, Link { conductance: f64::NAN, ..on }, out]).contains("conductance NaN"));
    assert!(of(&[into, Link { diameter: f32::NAN, ..on }, out]).contains("diameter NaN"));
    assert!(of(&[into, Link { to: Void(2), ..on }, out]).contains("leads to void 2, but there are 2"));
}
