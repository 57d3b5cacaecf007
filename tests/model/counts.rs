//! Whole runs of engine `counts`: exact answers, book-keeping, and the same bits however it is run.

use bitvec::vec::BitVec;
use voidwalk::gradation::{Gradation, SizeSampler};
use voidwalk::network::{ExitRule, Network};
use voidwalk::walk::{
    Engine, Isa, Passive, RunPlan, Shortcut, SizeClasses, State, Supply, Tally, Walk, WalkControl,
};

fn sampler(d0: f64, cu: f64) -> SizeSampler {
    let base = if cu == 1.0 { Gradation::single(d0) } else { Gradation::linear_from_d0(d0, cu) };
    SizeSampler::new(&base.unwrap(), 1.0).unwrap()
}

fn open(network: &Network) -> BitVec {
    BitVec::repeat(false, network.constrictions())
}

fn lattice(shape: [u32; 3], diameter: impl Fn(usize) -> f32) -> Network {
    let count = 3 * shape.iter().product::<u32>() as usize;
    Network::cubic_from_diameters(shape, (0..count).map(diameter).collect(), 1.0).unwrap()
}

/// Diameters between 1 and 2, as if at random.
fn scattered(c: usize) -> f32 {
    1.0 + (c as u64).wrapping_mul(0x9e37_79b9_7f4a_7c15).wrapping_shr(40) as f32 / (1u32 << 24) as f32
}

fn graph(rows: &str) -> Network {
    Network::from_csv(format!("from,to,diameter_mm\n{rows}").as_bytes(), "graph.csv", 1.0).unwrap()
}

/// Walks to the end, and checks after every increment what must add up.
fn walk(network: &Network, supply: &Supply, blocked: BitVec, seed: u64, run: u64) -> (State, Vec<Tally>) {
    let classes = SizeClasses::logarithmic(supply.sampler().smallest(), supply.sampler().largest(), 20);
    let mut state = State::new(network, supply, classes, blocked, seed, run);
    let mut series = Vec::new();
    Walk::new(network, supply, &state)
        .run(&mut state, &mut |state| {
            let (t, tally) = (state.increment, &state.tally);
            assert_eq!(tally.inserted, supply.inserted(t) + supply.passive_inserted(t));
            let sum = |column: &[u64]| column.iter().sum::<u64>();
            assert_eq!(sum(&state.retained_in_voids), tally.retained_in_voids);
            assert_eq!(sum(&state.retained_in_constrictions), tally.retained_in_constrictions);
            assert_eq!(sum(&state.eroded_sizes.number), tally.eroded);
            let retained = tally.retained_in_voids + tally.retained_in_constrictions;
            assert_eq!(sum(&state.retained_sizes.number), retained);
            assert!(tally.eroded == 0 || tally.largest_eroded >= supply.sampler().smallest());
            if let Passive::Counts(moving) = &state.passive {
                let coarse: u64 = state.particles.live.iter().map(|&n| u64::from(n)).sum();
                assert_eq!(tally.moving + tally.trapped, sum(moving) + coarse);
            }
            series.push(*tally);
            WalkControl::Continue
        })
        .unwrap();
    assert!(state.finished && state.tally.moving == 0);
    (state, series)
}

fn whole_run(
    network: &Network,
    base: &SizeSampler,
    n: u64,
    k: u64,
    seed: u64,
    engine: Engine,
) -> (State, Vec<Tally>) {
    let plan = RunPlan::new(engine, network, base, &open(network), n / k);
    walk(network, &plan.supply(base.clone(), n, k, seed, 1), open(network), seed, 1)
}

/// Everything that a run leaves behind.
fn assert_same(a: &State, b: &State) {
    assert_eq!((a.tally, a.increment, &a.history), (b.tally, b.increment, &b.history));
    assert_eq!(
        (&a.retained_in_voids, &a.retained_in_constrictions),
        (&b.retained_in_voids, &b.retained_in_constrictions)
    );
    assert_eq!((&a.retained_sizes, &a.eroded_sizes), (&b.retained_sizes, &b.eroded_sizes));
    assert_eq!((&a.passive, &a.blocked), (&b.passive, &b.blocked));
}

/// Passive particles leave `nz` equal layers after 3 nz moves on average, with variance 6 nz: each move is downstream with
/// probability 1/3. With 1e10 particles both are sharp to 1e-3; a wrong exit probability of 1e-5 would show.
#[test]
fn moves_of_passive_particles_have_their_exact_moments() {
    for (shape, seed) in [([3, 4, 20], 1), ([1, 1, 7], 2), ([40, 40, 5], 3)] {
        let network = lattice(shape, |_| 1.0);
        let n = 10_000_000_000;
        let (state, series) = whole_run(&network, &sampler(0.2, 2.0), n, 1, seed, Engine::Counts);
        assert!(state.history.is_empty() && state.tally.eroded == n);
        let (mut before, mut mean, mut square) = (0, 0.0, 0.0);
        for (i, tally) in series.iter().enumerate() {
            let (t, share) = ((i + 1) as f64, (tally.eroded - before) as f64 / n as f64);
            mean += share * t;
            square += share * t * t;
            before = tally.eroded;
        }
        let nz = f64::from(shape[2]);
        let variance = square - mean * mean;
        assert!((mean - 3.0 * nz).abs() < 4.5 * (6.0 * nz / n as f64).sqrt(), "{mean}");
        // The fourth moment of a sum of geometric waits is near that of a normal: 3, at most 3 + 9 / nz.
        assert!(
            (variance / (6.0 * nz) - 1.0).abs() < 4.5 * ((2.0 + 9.0 / nz) / n as f64).sqrt(),
            "{variance}"
        );
        assert_eq!(state.tally.particle_moves as f64 / n as f64, mean_moves(&series, n));
    }
}

/// Moves of particles that all started in increment 1 and all eroded.
fn mean_moves(series: &[Tally], n: u64) -> f64 {
    let mut moves = 0;
    for (i, tally) in series.iter().enumerate() {
        moves += (i as u64 + 1) * (tally.eroded - if i == 0 { 0 } else { series[i - 1].eroded });
    }
    moves as f64 / n as f64
}

/// One void that leads to itself twice and out once: eroded in increment t with probability w (1 - w)^(t - 1), for any
/// areas. Twelve increments at 4.5 standard deviations each; at 1e12 particles a relative fault of 1e-5 shows.
#[test]
fn one_void_erodes_geometrically() {
    for (i, diameters) in
        [[1.0f32, 1.0, 1.0], [3.0, 1.0, 2.0], [1.0, 2.0, 0.25], [0.0, 1.0, 1.5]].into_iter().enumerate()
    {
        let network = lattice([1, 1, 1], |c| diameters[c]);
        let area: Vec<f64> = diameters.iter().map(|&d| f64::from(d) * f64::from(d)).collect();
        let out = area[2] / area.iter().sum::<f64>();
        let n = 1_000_000_000_000;
        let (_, series) = whole_run(&network, &sampler(0.01, 3.0), n, 1, i as u64, Engine::Counts);
        let mut left = n as f64;
        for (t, tally) in series.iter().enumerate().take(12) {
            let eroded = tally.eroded as f64 - (n as f64 - left);
            let sigma = (left * out * (1.0 - out)).sqrt();
            assert!((eroded - left * out).abs() < 4.5 * sigma + 1.0, "{diameters:?} increment {}", t + 1);
            left -= eroded;
        }
    }
}

/// Very few and very many particles, and more of them than particle_moves can hold: all accounted for.
#[test]
fn any_number_of_particles_is_accounted_for() {
    let network = lattice([3, 3, 4], scattered);
    for n in [1, 2, 99, 100, 101, 12_345, 1_000_000_000_000, 1 << 53, 1_000_000_000_000_000_001] {
        // All passive: the coarse part of a graded base would not fit the memory at 1e18.
        let (state, series) = whole_run(&network, &sampler(0.2, 2.0), n, 100, 5, Engine::Auto);
        assert_eq!(state.tally.eroded, n);
        assert_eq!(state.tally.passive_eroded, n);
        for (i, tally) in series.iter().enumerate() {
            let t = (i as u128 + 1).min(100);
            assert_eq!(u128::from(tally.inserted), u128::from(n) * t / 100);
        }
        assert!((state.tally.eroded_mass / state.tally.inserted_mass - 1.0).abs() < 1e-12);
    }
    // About one in 1e9 is coarse, and blocks.
    let base = sampler(0.001, 45.0);
    let limit = base.word_limit(network.finest()) as f64 / 2f64.powi(64);
    assert!(limit < 1.0 && (1.0 - limit) * 1e12 < 1e6, "{limit}");
    let (state, _) = whole_run(&network, &base, 1_000_000_000_000, 100, 6, Engine::Counts);
    assert!(state.tally.inserted == 1_000_000_000_000 && state.tally.blocked > 0);
}

/// A graded base that blocks much of a small lattice.
fn blocking_scene() -> (Network, SizeSampler) {
    (lattice([11, 13, 30], scattered), sampler(0.15, 4.0))
}

/// Two runs on one thread, and the same to the bit on 2, 3 and 5.
fn threads_agree(engine: Engine, network: &Network, base: &SizeSampler, n_base: u64) -> [State; 2] {
    let on = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| {
            let supply = |run, blocked: &BitVec| {
                RunPlan::new(engine, network, base, blocked, n_base / 50).supply(
                    base.clone(),
                    n_base,
                    50,
                    9,
                    run,
                )
            };
            let (first, _) = walk(network, &supply(1, &open(network)), open(network), 9, 1);
            let blocked = first.blocked.clone();
            let (second, _) = walk(network, &supply(2, &blocked), blocked, 9, 2);
            [first, second]
        })
    };
    let alone = on(1);
    for threads in [2, 3, 5] {
        for (one, many) in alone.iter().zip(&on(threads)) {
            assert_same(one, many);
        }
    }
    alone
}

/// With enough voids for several blocks.
#[test]
fn threads_change_no_bit() {
    let (network, base) = blocking_scene();
    for engine in [Engine::Counts, Engine::Expected] {
        let [first, second] = threads_agree(engine, &network, &base, 3_000_000).map(|run| run.tally);
        assert!(first.retained_in_voids > 0 && second.blocked > first.blocked);
    }
}

/// With enough voids and particles that the expectation moves beside those that are walked one by one: such a
/// supply seals this network in its first run, so that nothing is left for the second to block.
#[test]
fn threads_change_no_bit_where_the_expectation_moves_beside_particles() {
    let (network, base) = (lattice([32, 32, 20], scattered), sampler(0.5, 1.5));
    // Each of 50 increments inserts more than 16,384 that may block.
    let passive = base.word_limit(network.finest()) as f64 / 2f64.powi(64);
    let many = (2.0 * 16_384.0 * 50.0 / (1.0 - passive)) as u64;
    assert!(network.voids() > 16_384 && passive > 0.05 && many < 50_000_000, "{passive} {many}");
    let [first, _] = threads_agree(Engine::Expected, &network, &base, many);
    assert!(first.tally.blocked > 0 && first.tally.eroded > 0);
}

/// A whole run with each instruction set that this machine has: where every void has three exits, where voids have two,
/// three or four, and by flow, where they have six.
#[test]
fn instructions_change_no_bit() {
    let ((three, coarse), fine) = (blocking_scene(), sampler(0.15, 3.0));
    let mut rows: String = (0..50).map(|void| format!("start,{void},\n")).collect();
    for (void, exit) in (0..700).flat_map(|void| (0..2 + void % 3).map(move |exit| (void, exit))) {
        let to = void + 40 + 7 * exit;
        let to = if to < 700 { to.to_string() } else { "end".to_owned() };
        rows += &format!("{void},{to},{}\n", scattered(4 * void + exit));
    }
    let by_flow = three.undirected_lattice(ExitRule::Flux, 0.1, 4.0).unwrap();
    for (network, base) in [(three, coarse), (graph(&rows), fine.clone()), (by_flow, fine)] {
        let plan = RunPlan::new(Engine::Counts, &network, &base, &open(&network), 600_000);
        let supply = plan.supply(base.clone(), 30_000_000, 50, 12, 1);
        let with = |isa: Isa| {
            let classes = SizeClasses::logarithmic(base.smallest(), base.largest(), 20);
            let mut state = State::new(&network, &supply, classes, open(&network), 12, 1);
            let mut walk = Walk::new(&network, &supply, &state).with_isa(isa);
            walk.run(&mut state, &mut |_| WalkControl::Continue).unwrap();
            state
        };
        let portable = with(Isa::Portable);
        let Tally { eroded, blocked, .. } = portable.tally;
        assert!(eroded > 100_000 && blocked > 100, "{eroded} {blocked}");
        let available = Isa::ALL.into_iter().filter(|isa| isa.is_available());
        available.for_each(|isa| assert_same(&portable, &with(isa)));
    }
}

/// The state alone is enough to go on from.
#[test]
fn a_walk_rebuilt_from_its_state_ends_the_same() {
    let (network, base) = blocking_scene();
    for engine in [Engine::Counts, Engine::Expected] {
        let plan = RunPlan::new(engine, &network, &base, &open(&network), 25_000);
        let supply = plan.supply(base.clone(), 1_000_000, 40, 3, 1);
        let (unbroken, _) = walk(&network, &supply, open(&network), 3, 1);
        let classes = SizeClasses::logarithmic(base.smallest(), base.largest(), 20);
        let mut state = State::new(&network, &supply, classes, open(&network), 3, 1);
        while !state.finished {
            let mut walk = Walk::new(&network, &supply, &state);
            for _ in 0..7 {
                if !state.finished {
                    walk.increment(&mut state).unwrap();
                }
            }
        }
        assert_same(&unbroken, &state);
    }
}

/// What is left out changes nothing: no count where nothing is passive, no particle where everything is.
#[test]
fn the_full_path_gives_what_the_plan_leaves_out() {
    let network = lattice([5, 5, 8], scattered);
    let coarse = sampler(1.2, 1.4);
    let plan = RunPlan::new(Engine::Auto, &network, &coarse, &open(&network), 2_000);
    assert_eq!((plan.engine(), plan.left_out().len()), (Engine::Particles, 1));
    let short = walk(&network, &plan.supply(coarse.clone(), 40_000, 20, 8, 1), open(&network), 8, 1).0;
    let full = Supply::new(coarse.clone(), 40_000, 20).with_passive_part(0, false, 8, 1);
    let mut full = walk(&network, &full, open(&network), 8, 1).0;
    assert!(short.tally.blocked > 100);
    assert_eq!(std::mem::replace(&mut full.passive, Passive::OneByOne), Passive::Counts(vec![0; 200]));
    assert_same(&short, &full);

    let fine = sampler(0.2, 2.0);
    let plan = RunPlan::new(Engine::Auto, &network, &fine, &open(&network), 2_000);
    assert_eq!((plan.engine(), plan.left_out().len()), (Engine::Counts, 1));
    let supply = plan.supply(fine.clone(), 40_000, 20, 8, 1);
    assert_eq!(supply.total(), 0);
    let counts = walk(&network, &supply, open(&network), 8, 1).0;
    let particles = walk(&network, &Supply::new(fine, 40_000, 20), open(&network), 8, 1).0;
    for state in [&counts, &particles] {
        assert_eq!(
            (state.tally.eroded, state.tally.passive_inserted, state.tally.blocked),
            (40_000, 40_000, 0)
        );
    }
}

/// So few particles that each is walked by itself: the same bits as if that had been asked for, and the plan says so.
#[test]
fn few_particles_are_walked_one_by_one() {
    let network = lattice([5, 5, 8], scattered);
    let base = sampler(0.5, 1.8);
    let plan = |share| RunPlan::new(Engine::Auto, &network, &base, &open(&network), share);
    // From 6.5 passive ones a start node on, whatever the number of the others.
    let least = (1..).find(|&share| plan(share).engine() == Engine::Counts).unwrap();
    let (few, enough) = (plan(least - 1), plan(least));
    assert_eq!((few.engine(), enough.engine()), (Engine::Particles, Engine::Counts));
    assert!(few.left_out().contains(&Shortcut::FewPassive(162, 25)), "{:?}", few.left_out());
    assert!(!enough.left_out().iter().any(|part| matches!(part, Shortcut::FewPassive(..))));
    for wanted in [Engine::Counts, Engine::Expected] {
        assert_eq!(RunPlan::new(wanted, &network, &base, &open(&network), 1).engine(), wanted);
    }
    let chosen = whole_run(&network, &base, 100 * (least - 1), 100, 5, Engine::Auto).0;
    let asked = whole_run(&network, &base, 100 * (least - 1), 100, 5, Engine::Particles).0;
    assert!(chosen.tally.blocked > 100 && chosen.passive == Passive::OneByOne);
    assert_same(&chosen, &asked);
}

/// Nothing open from the start: everything stays where it starts, whatever its size.
#[test]
fn nothing_leaves_closed_voids() {
    let network = lattice([3, 2, 2], |_| 0.0);
    for engine in [Engine::Auto, Engine::Expected, Engine::Particles] {
        let (state, _) = whole_run(&network, &sampler(0.5, 3.0), 6_000, 10, 4, engine);
        assert_eq!((state.tally.retained_in_voids, state.tally.particle_moves), (6_000, 0));
        assert_eq!(state.retained_in_voids[..6].iter().sum::<u64>(), 6_000);
        assert_eq!(state.increment, 10);
    }
    let plan = RunPlan::new(Engine::Auto, &network, &sampler(0.5, 3.0), &open(&network), 600);
    assert_eq!(plan.left_out()[0], Shortcut::NothingOpen);
}

/// Rings without a way out: runs end, and end where those of particles one by one do.
#[test]
fn passive_particles_are_trapped_like_any_other() {
    let ring = graph("start,0,\n0,1,1\n1,0,2\n");
    let sideways = lattice([3, 4, 2], |c| if c % 3 == 2 { 0.0 } else { 1.0 });
    for network in [&ring, &sideways] {
        let one_by_one = whole_run(network, &sampler(0.5, 1.2), 5_000, 10, 2, Engine::Particles).0;
        for engine in [Engine::Counts, Engine::Expected] {
            let state = whole_run(network, &sampler(0.5, 1.2), 5_000, 10, 2, engine).0;
            assert_eq!((state.tally.trapped, state.increment), (5_000, 10));
            assert_eq!(state.tally.particle_moves, one_by_one.tally.particle_moves);
            assert_eq!(one_by_one.tally.trapped, 5_000);
        }
    }
    // Void 0 leads out or into the ring; the shares are the areas'.
    let fork = graph("start,0,\n0,end,1\n0,1,2\n1,2,1\n2,1,1\n");
    let n = 1_000_000_000_000u64;
    let state = whole_run(&fork, &sampler(0.5, 1.2), n, 100, 3, Engine::Counts).0;
    assert_eq!((state.increment, state.tally.trapped + state.tally.eroded), (100, n));
    assert!((state.tally.eroded as f64 - 0.2 * n as f64).abs() < 4.5 * (0.16 * n as f64).sqrt());
    let state = whole_run(&fork, &sampler(0.5, 1.2), n, 100, 3, Engine::Expected).0;
    assert_eq!((state.tally.eroded, state.tally.trapped), (n / 5, n - n / 5));
    // Behind a void without exits nobody is trapped.
    let dead_end = graph("start,0,\n0,1,1\n1,0,1\n1,2,1\n2,0,0\n");
    for engine in [Engine::Counts, Engine::Expected] {
        let state = whole_run(&dead_end, &sampler(0.5, 1.2), n, 100, 3, engine).0;
        assert_eq!((state.tally.trapped, state.retained_in_voids[2]), (0, n));
    }
}

/// Coarse particles circle in a ring while passive ones still leave another: the run goes on until those are gone, and every
/// particle that has not left attempts, and makes, a move in every increment.
#[test]
fn a_run_ends_when_both_parts_have() {
    // Void 3 cannot be reached; its exit makes sizes above 1 coarse. Void 2 is left with probability 1/5.
    let network = graph("start,0,\n0,1,3\n0,2,3\n1,1,3\n2,2,6\n2,end,3\n3,end,1\n");
    let base = sampler(0.1, 4.4);
    for engine in [Engine::Particles, Engine::Counts] {
        let (state, series) = whole_run(&network, &base, 1_000_000, 10, 7, engine);
        assert!(state.history.is_empty() && state.tally.eroded + state.tally.trapped == 1_000_000);
        assert!((state.tally.trapped as f64 - 5e5).abs() < 4.0 * 500.0);
        let (mut moves, mut eroded) = (0, 0);
        for tally in &series {
            moves += tally.inserted - eroded;
            eroded = tally.eroded;
            assert_eq!(tally.particle_moves, moves);
        }
        // The last of 5e5 leaves after about ln(5e5) / ln(5/4) = 59 increments; the last of 500 coarse ones after 28.
        assert!((45..100).contains(&state.increment), "{}", state.increment);
    }
}

/// The expectation against one draw on the same history: the same seed walks the same coarse particles. Eroded and retained
/// passive particles are within 4 standard deviations (variance at most the mean); a fault of 0.2 % would show.
#[test]
fn the_expectation_is_what_counts_scatter_about() {
    let (network, base) = blocking_scene();
    for seed in 1..=4 {
        let (drawn, drawn_series) = whole_run(&network, &base, 20_000_000, 50, seed, Engine::Counts);
        let (expected, series) = whole_run(&network, &base, 20_000_000, 50, seed, Engine::Expected);
        assert_eq!(drawn.history, expected.history);
        assert_eq!(drawn.tally.inserted_mass, expected.tally.inserted_mass);
        let near = |a: u64, b: u64| (a as f64 - b as f64).abs() < 4.0 * (b as f64 + 4.0).sqrt() + 1.0;
        for (a, b) in drawn_series.iter().zip(&series) {
            assert!(near(a.eroded, b.eroded) && near(a.retained_in_voids, b.retained_in_voids));
        }
        assert!(drawn.tally.eroded > 100_000 && drawn.tally.retained_in_voids > 100_000);
        let mass = (drawn.tally.eroded_mass / expected.tally.eroded_mass - 1.0).abs();
        assert!(mass < 0.01, "{mass}");
        assert!((drawn.increment as f64 / expected.increment as f64 - 1.0).abs() < 0.3);
    }
}
