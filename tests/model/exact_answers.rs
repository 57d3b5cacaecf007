//! The walk against answers that are known exactly.

use bitvec::vec::BitVec;
use voidwalk::constrictions::{Curve, CurveUnit, find};
use voidwalk::gradation::{Gradation, SizeSampler};
use voidwalk::network::{Network, Passage};
use voidwalk::walk::{SizeClasses, State, Supply, Walk, WalkControl};

fn shipped(name: &str) -> Curve {
    find(name).unwrap().curve().unwrap().in_mm(1.0).unwrap()
}

fn one_size(d: f64, n: u64, increments: u64) -> Supply {
    Supply::new(SizeSampler::new(&Gradation::single(d).unwrap(), 1.0).unwrap(), n, increments)
}

/// A finished run on a clean network, and the number eroded in each increment.
fn walk(network: &Network, supply: &Supply, seed: u64) -> (State, Vec<u64>) {
    let clean = BitVec::repeat(false, network.constrictions());
    let classes = SizeClasses::logarithmic(0.1, 1.0, 4);
    let mut state = State::new(network, supply, classes, clean, seed, 1);
    let mut eroded = vec![0];
    Walk::new(network, supply, &state)
        .run(&mut state, &mut |s| {
            eroded.push(s.tally.eroded);
            WalkControl::Continue
        })
        .unwrap();
    (state, eroded.windows(2).map(|w| w[1] - w[0]).collect())
}

fn mean(values: &[f64]) -> f64 {
    values.iter().sum::<f64>() / values.len() as f64
}

/// 20 networks, 4,000 lone particles each: a bias of the chance of passage of 0.5 % of itself would be
/// seen with a power of about one half.
#[test]
fn the_first_particle_passes_a_given_network_as_the_linear_solve_says() {
    let curve = shipped("shire2016-cu1.5-loose");
    let (mut chi2, mut expected_all, mut found_all, mut variance) = (0.0, 0.0, 0.0, 0.0);
    for network_seed in 0..20 {
        let network = Network::cubic([5, 5, 4], &curve, 1.0, network_seed).unwrap();
        let d = curve.dc(10.0).unwrap();
        let (p, _) = network.first_passage(d as f32, |_| false).unwrap().at_start(&network);
        let lone = one_size(d, 1, 1);
        let n = 4000;
        let passed = (0..n).filter(|&s| walk(&network, &lone, 1000 * network_seed + s).0.tally.eroded == 1);
        let (passed, n) = (passed.count() as f64, n as f64);
        let z = (passed - n * p) / (n * p * (1.0 - p)).sqrt();
        assert!(z.abs() < 4.0, "network {network_seed}: {passed} of {n}, expected {}", n * p);
        chi2 += z * z;
        (expected_all, found_all) = (expected_all + n * p, found_all + passed);
        variance += n * p * (1.0 - p);
    }
    assert!(((found_all - expected_all) / f64::sqrt(variance)).abs() < 4.0);
    // 20 degrees of freedom: the 0.0001 point is 52.4.
    assert!(chi2 < 52.4, "{chi2}");
}

/// q = mean over three independent exits of the share of area finer than d; a layer is passed with
/// s = (1 - q) / (1 + 2 q). 20,000 networks: a relative bias of s^6 of about 3 % would be seen.
#[test]
fn a_lone_particle_survives_each_layer_as_the_closed_form_says() {
    let curve = shipped("shire2016-cu1.5-loose");
    let d = curve.dc(15.0).unwrap();
    // Mean over a fine stratified grid of three exits.
    let sizes: Vec<f64> = (0..120).map(|k| curve.quantile((k as f64 + 0.5) / 120.0)).collect();
    let mut q = 0.0;
    for a in &sizes {
        for b in &sizes {
            for c in &sizes {
                let finer = |x: &f64| if *x < d { x * x } else { 0.0 };
                q += (finer(a) + finer(b) + finer(c)) / (a * a + b * b + c * c);
            }
        }
    }
    q /= 120f64.powi(3);
    let p = ((1.0 - q) / (1.0 + 2.0 * q)).powi(6);
    let passage = Passage::new(&curve);
    assert!((passage.stopped(d) - q).abs() < 5e-4 && (passage.through(d, 6) / p - 1.0).abs() < 0.01);
    let lone = one_size(d, 1, 1);
    let n = 20_000;
    let passed = (0..n).filter(|&seed| {
        // Wide enough that few particles meet a void twice.
        let network = Network::cubic([14, 14, 6], &curve, 1.0, seed).unwrap();
        walk(&network, &lone, seed).0.tally.eroded == 1
    });
    let (passed, n) = (passed.count() as f64, n as f64);
    let z = (passed - n * p) / (n * p * (1.0 - p)).sqrt();
    assert!(z.abs() < 4.0, "{passed} of {n}, expected {} (q = {q})", n * p);
}

/// Moves to leave 60 layers: mean 180, variance 360 (sd 18.97). With 200,000 particles on four networks the
/// standard errors are 0.04 and 1.1; the networks themselves scatter a little more.
#[test]
fn passive_particles_take_three_moves_a_layer() {
    let curve = shipped("shire2016-cu1.5-loose");
    let (mut n, mut sum, mut squares, mut particle_moves) = (0.0, 0.0, 0.0, 0);
    for seed in 0..4 {
        let network = Network::cubic([40, 40, 60], &curve, 1.0, seed).unwrap();
        let (state, eroded) = walk(&network, &one_size(0.1, 50_000, 1), seed);
        assert_eq!((state.tally.eroded, state.tally.blocked), (50_000, 0));
        // The same masses added in two orders.
        assert!((state.tally.eroded_mass / state.tally.inserted_mass - 1.0).abs() < 1e-9);
        particle_moves += state.tally.particle_moves;
        for (moves, eroded) in (1..).map(f64::from).zip(eroded) {
            let eroded = eroded as f64;
            n += eroded;
            sum += eroded * moves;
            squares += eroded * moves * moves;
        }
    }
    let (mean, variance) = (sum / n, squares / n - (sum / n) * (sum / n));
    assert!((mean - 180.0).abs() < 0.5, "{mean}");
    assert!((variance.sqrt() - 18.97).abs() < 0.25, "{}", variance.sqrt());
    assert_eq!(particle_moves as f64, sum);
}

/// Narrow lattices take longer, as the linear solve says: about 228 for 1 x 1 x 60 and 189 for 2 x 2 x 60.
#[test]
fn narrow_lattices_take_longer() {
    let curve = shipped("shire2016-cu1.5-loose");
    for (width, expected) in [(1, 228.0), (2, 189.0)] {
        let mut solved = Vec::new();
        for seed in 0..400 {
            let network = Network::cubic([width, width, 60], &curve, 1.0, seed).unwrap();
            solved.push(network.first_passage(0.0, |_| false).unwrap().at_start(&network).1);
            if seed < 10 {
                let (state, _) = walk(&network, &one_size(0.1, 20_000, 1), seed);
                let walked = state.tally.particle_moves as f64 / 20_000.0;
                assert!((walked / solved[seed as usize] - 1.0).abs() < 0.01, "{walked}");
            }
        }
        assert!((mean(&solved) / expected - 1.0).abs() < 0.015, "{}", mean(&solved));
    }
}

/// The blocked set of one size is an exact integer, whatever the seed.
#[test]
fn one_size_blocks_what_a_breadth_first_search_finds() {
    for (name, percent, shape) in [
        ("shire2016-cu1.5-loose", 5.0, [8, 8, 12]),
        ("shire2016-cu3-loose", 25.0, [6, 9, 10]),
        ("shire2016-cu1.5-dense", 40.0, [10, 4, 6]),
    ] {
        let curve = shipped(name);
        let d = curve.dc(percent).unwrap();
        let network = Network::cubic(shape, &curve, 1.0, 7).unwrap();
        let expected = network.blocked_by_one_size(d as f32);
        for seed in 0..4 {
            let (state, _) = walk(&network, &one_size(d, 3_000_000, 100), seed);
            let blocked: Vec<u32> = state.blocked.iter_ones().map(|c| c as u32).collect();
            assert_eq!(blocked, expected, "{name}, seed {seed}");
        }
    }
}

/// The paper's own check: one size Dc1 or Dc1.5 blocks 1 % or 1.5 % of the constrictions, less those that
/// lie where it cannot come.
#[test]
fn dc1_and_dc1_5_block_their_share() {
    let curve = shipped("shire2016-cu1.5-loose");
    let network = Network::cubic([20, 20, 30], &curve, 1.0, 3).unwrap();
    for percent in [1.0, 1.5] {
        let d = curve.dc(percent).unwrap();
        let finer = network.diameters().iter().filter(|&&c| c < d as f32).count();
        let (state, _) = walk(&network, &one_size(d, 2_000_000, 100), 1);
        let share = 100.0 * state.tally.blocked as f64 / network.constrictions() as f64;
        assert_eq!(state.tally.blocked, network.blocked_by_one_size(d as f32).len() as u64);
        assert!(state.tally.blocked as usize > finer * 9 / 10, "{} of {finer}", state.tally.blocked);
        assert!((share - percent).abs() < 0.2 * percent, "{share} % at Dc{percent}");
    }
}

#[test]
fn a_base_coarser_than_every_constriction_blocks_the_first_layer_only() {
    let curve = shipped("shire2016-cu3-loose");
    let network = Network::cubic([7, 9, 5], &curve, 1.0, 1).unwrap();
    let (state, _) = walk(&network, &one_size(2.0, 60_000, 100), 1);
    let tally = state.tally;
    assert_eq!((tally.eroded, tally.blocked, tally.particle_moves), (0, 3 * 7 * 9, 0));
    assert_eq!(tally.retained_in_constrictions + tally.retained_in_voids, 60_000);
    // Nothing moves one attempt after the last insertion.
    assert_eq!(state.increment, 100);
    assert!(state.blocked.iter_ones().all(|c| c < 3 * 7 * 9));
}

fn single_void(diameters: [f32; 3]) -> Network {
    Network::cubic_from_diameters([1, 1, 1], diameters.to_vec(), 1.0).unwrap()
}

/// Only z lets the particle through: it leaves with the share of z. 40,000 seeds: a bias of 0.7 % (points)
/// of the chance would be seen.
#[test]
fn one_void_is_left_with_the_share_of_its_area() {
    let network = single_void([0.5, 0.8, 1.2]);
    let p = 1.44 / (0.25 + 0.64 + 1.44);
    let n = 40_000;
    let eroded = (0..n).filter(|&seed| walk(&network, &one_size(1.0, 1, 1), seed).0.tally.eroded == 1);
    let z = (eroded.count() as f64 - n as f64 * p) / (n as f64 * p * (1.0 - p)).sqrt();
    assert!(z.abs() < 4.0, "{z}");
}

#[test]
fn a_particle_that_circles_for_ever_is_trapped_and_ends_the_run() {
    // z is of size 0: closed from the start, and not counted as blocked.
    let (state, _) = walk(&single_void([2.0, 3.0, 0.0]), &one_size(1.0, 500, 10), 1);
    assert_eq!((state.tally.trapped, state.tally.blocked, state.increment), (500, 0, 10));
    // A coarse particle may circle where x alone fits it; where y would stop it, it blocks y first.
    let (state, _) = walk(&single_void([2.0, 0.5, 0.0]), &one_size(1.0, 500, 10), 1);
    assert_eq!((state.tally.trapped, state.tally.blocked), (500 - state.tally.retained_in_constrictions, 1));
    assert!(state.tally.retained_in_constrictions >= 1);
}

#[test]
fn closed_and_blocked_networks_retain_everything_where_it_starts() {
    let (state, _) = walk(&single_void([0.0; 3]), &one_size(1.0, 77, 10), 1);
    assert_eq!((state.tally.retained_in_voids, state.tally.blocked), (77, 0));
    let network = Network::cubic_from_diameters([3, 3, 2], vec![1.0; 54], 1.0).unwrap();
    let supply = one_size(0.5, 100, 10);
    let classes = SizeClasses::logarithmic(0.5, 0.5, 1);
    let all = BitVec::repeat(true, 54);
    let mut state = State::new(&network, &supply, classes, all, 1, 2);
    Walk::new(&network, &supply, &state).run(&mut state, &mut |_| WalkControl::Continue).unwrap();
    assert_eq!((state.tally.eroded, state.tally.retained_in_voids, state.tally.blocked), (0, 100, 54));
    assert!(state.retained_in_voids[9..].iter().all(|&n| n == 0));
}

/// d == D passes, decided on the numbers as they are stored.
#[test]
fn a_particle_as_coarse_as_the_constriction_passes() {
    let network = single_void([0.3, 0.3, 0.7]);
    for (d, passes) in [(0.7, true), (0.7 * (1.0 + 1e-7), false), (0.7 * (1.0 - 1e-7), true)] {
        let (state, _) = walk(&network, &one_size(d, 10_000, 1), 1);
        assert_eq!(state.tally.eroded > 0, passes, "{d}");
    }
}

#[test]
fn exactly_n_base_are_inserted() {
    let network = Network::cubic_from_diameters([4, 4, 4], vec![1.0; 192], 1.0).unwrap();
    for n in [1, 99, 100, 101, 12_345] {
        let (state, _) = walk(&network, &one_size(0.5, n, 100), 1);
        assert_eq!((state.tally.inserted, state.tally.eroded), (n, n));
    }
}

/// More than a million particles one by one: all that go in come out, and the tally of every increment says so.
#[test]
fn a_million_particles_are_all_accounted_for() {
    let network = Network::cubic_from_diameters([40, 40, 3], vec![1.0; 3 * 4800], 1.0).unwrap();
    let n = 1_234_567;
    let (state, eroded) = walk(&network, &one_size(0.5, n, 100), 3);
    assert_eq!((state.tally.eroded, eroded.iter().sum::<u64>(), state.tally.blocked), (n, n, 0));
}

/// A factor of two on every length changes no bit, and diameters a million times apart neither overflow
/// nor vanish.
#[test]
fn scaling_by_two_changes_no_bit() {
    let curve = Curve::from_points(&[(0.0, 1e-6), (50.0, 1.0), (100.0, 1e6)], CurveUnit::Mm).unwrap();
    let base = Gradation::linear_from_d0(1e-3, 30.0).unwrap();
    let run = |factor: f64| {
        let network = Network::cubic([5, 5, 5], &curve.scaled(factor).unwrap(), factor, 3).unwrap();
        let sampler = SizeSampler::new(&base.scaled(factor).unwrap(), factor).unwrap();
        let (state, eroded) = walk(&network, &Supply::new(sampler, 40_000, 20), 5);
        (state.tally, eroded, state.blocked)
    };
    let reference = run(1.0);
    assert!(reference.0.eroded_mass.is_finite() && reference.0.inserted_mass > 0.0);
    for factor in [2.0, 1.0 / 1024.0] {
        assert_eq!(run(factor), reference);
    }
}

/// Same bits for 1, 2, 3 and 8 threads, on the lattice and on a general network.
#[test]
fn threads_change_no_bit() {
    let curve = shipped("shire2016-cu1.5-loose");
    let lattice = Network::cubic([12, 12, 10], &curve, 1.0, 1).unwrap();
    let mut text = Vec::new();
    lattice.write_csv(&mut text).unwrap();
    let text = text.split(|&b| b == b'\n').skip(1).collect::<Vec<_>>().join(&b'\n');
    let general = Network::from_csv(&text, "general.csv", 1.0).unwrap();
    let base = Gradation::linear_from_dx(85.0, curve.dc(5.0).unwrap(), 3.0).unwrap();
    let supply = Supply::new(SizeSampler::new(&base, 1.0).unwrap(), 200_000, 50);
    let run = |network: &Network, threads| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        let (state, eroded) = pool.install(|| walk(network, &supply, 9));
        (state.tally, eroded, state.history, state.retained_sizes, state.retained_in_constrictions)
    };
    let reference = run(&lattice, 1);
    assert!(reference.0.blocked > 100 && reference.0.eroded > 1000);
    for network in [&lattice, &general] {
        for threads in [1, 2, 3, 8] {
            assert_eq!(run(network, threads), reference, "{threads} threads");
        }
    }
}

/// A hundred thousand layers of one void, and one layer of a million: the walk matches the linear solve.
#[test]
fn very_long_and_very_wide_networks_run() {
    let equal = |shape: [u32; 3]| {
        let count = 3 * shape.iter().map(|&n| n as usize).product::<usize>();
        Network::cubic_from_diameters(shape, vec![1.0; count], 1.0).unwrap()
    };
    // Each layer takes a geometric number of moves with mean 3 and variance 6.
    let long = equal([1, 1, 100_000]);
    let (state, _) = walk(&long, &one_size(0.5, 20, 1), 1);
    let moves = state.tally.particle_moves as f64 / 20.0;
    assert!((moves - 300_000.0).abs() < 4.0 * (600_000.0f64 / 20.0).sqrt(), "{moves}");
    let wide = equal([1000, 1000, 1]);
    let (state, _) = walk(&wide, &one_size(0.5, 100_000, 10), 1);
    let moves = state.tally.particle_moves as f64 / 100_000.0;
    assert!((moves - 3.0).abs() < 4.0 * (6.0f64 / 100_000.0).sqrt(), "{moves}");
    let small = equal([2, 2, 2]);
    let (leaves, moves) = small.first_passage(0.5, |_| false).unwrap().at_start(&small);
    assert!((leaves - 1.0).abs() < 1e-9 && (moves - 6.0).abs() < 1e-9);
}
