//! Arches where their numbers are known exactly: one constriction, two side by side, three in a row, a fork.
//!
//! One particle is inserted an increment, so that an arch is one particle. Bounds are five standard errors: a
//! probability that is off by 5 % of its value is found in the first two cases, by 10 % in the others.

use std::sync::Arc;

use bitvec::vec::BitVec;
use voidwalk::gradation::{Gradation, SizeSampler};
use voidwalk::network::Network;
use voidwalk::walk::{ArchSize, Arching, ByVoid, CHUNK, Law, SizeClasses, State, Supply, Tally, Walk};

/// Walks `n` particles of size 1, in so many increments, by a law at a concentration of 0.2.
fn walk(network: &str, law: &str, n: u64, increments: u64, seed: u64) -> Tally {
    walk_by(network, &arching(law), n, increments, seed)
}

/// The table of a law, which takes longer than a walk: made once for many walks.
fn arching(law: &str) -> Arc<Arching> {
    Arc::new(Arching::new(Law::named(law).unwrap(), 0.2))
}

fn walk_by(network: &str, law: &Arc<Arching>, n: u64, increments: u64, seed: u64) -> Tally {
    let network = Network::from_csv(network.as_bytes(), "network.csv", 1.0).unwrap();
    let sampler = SizeSampler::new(&Gradation::single(1.0).unwrap(), 1.0).unwrap();
    let supply = Supply::new(sampler, n, increments).arching_by(Some(Arc::clone(law)));
    let open: BitVec = BitVec::repeat(false, network.constrictions());
    let mut state = State::new(&network, &supply, SizeClasses::logarithmic(0.5, 2.0, 4), open, seed, 1);
    let mut walk = Walk::new(&network, &supply, &state);
    while !state.finished {
        walk.increment(&mut state).unwrap();
    }
    let tally = state.tally;
    let held = tally.retained_in_constrictions + tally.retained_in_voids + tally.trapped;
    assert_eq!(tally.inserted, tally.eroded + held);
    assert_eq!(tally.retained_in_constrictions, tally.retained_in_arches);
    assert!((tally.arched_mass - tally.retained_in_arches as f64).abs() < 1e-9);
    tally
}

const SEEDS: u64 = 4000;

/// How many pass, seed by seed, where they come one by one.
fn passed(network: &str, law: &str) -> Vec<f64> {
    let law = arching(law);
    (1..=SEEDS).map(|seed| walk_by(network, &law, 120, 120, seed).eroded as f64).collect()
}

fn mean(values: impl Iterator<Item = f64> + Clone) -> f64 {
    let count = values.clone().count() as f64;
    values.sum::<f64>() / count
}

fn variance(values: &[f64]) -> f64 {
    let of = mean(values.iter().copied());
    mean(values.iter().map(|v| (v - of).powi(2)))
}

/// A mean within five standard errors of what it is to be.
fn is_near(values: &[f64], wanted: f64) {
    let found = mean(values.iter().copied());
    let error = (variance(values) / values.len() as f64).sqrt();
    assert!((found - wanted).abs() < 5.0 * error, "{found} and not {wanted}, give or take {error}");
}

fn probability(law: &str, ratio: f64) -> f64 {
    Law::named(law).unwrap().probability(ratio, 0.2)
}

/// The number that passes one constriction is geometric: mean, variance and the first five probabilities.
fn passes_a_geometric_number(law: &str) {
    for ratio in [1.5, 2.0] {
        let found = passed(&format!("from,to,diameter_mm\nstart,0,\n0,end,{ratio}\n"), law);
        let p = probability(law, ratio);
        let q = 1.0 - p;
        is_near(&found, q / p);
        // Of a geometric number the fourth central moment is q (p^2 + 9 q) / p^4.
        let wanted = q / p / p;
        let fourth = q * (p * p + 9.0 * q) / p.powi(4);
        let error = ((fourth - wanted * wanted) / SEEDS as f64).sqrt();
        let of = variance(&found);
        assert!((of - wanted).abs() < 5.0 * error, "{law} {ratio}: {of} and not {wanted}");
        for k in 0..5 {
            let share = mean(found.iter().map(|&n| f64::from(n == f64::from(k))));
            let wanted = q.powi(k) * p;
            let error = (wanted * (1.0 - wanted) / SEEDS as f64).sqrt();
            assert!((share - wanted).abs() < 5.0 * error, "{law} {ratio}, {k}: {share} and not {wanted}");
        }
    }
}

#[test]
fn through_one_constriction_a_geometric_number_passes_by_dense_discharge() {
    passes_a_geometric_number("zuriguel-2005");
}

#[test]
fn through_one_constriction_a_geometric_number_passes_in_suspension() {
    passes_a_geometric_number("marin-2018");
}

/// By `critical-3` the first particle below R = 3 closes it, so that none passes: the same with p = 1.
#[test]
fn through_one_constriction_none_passes_below_the_critical_ratio() {
    for (ratio, passes) in [(1.0, 0), (2.0, 0), (2.9, 0), (3.1, 120)] {
        let network = format!("from,to,diameter_mm\nstart,0,\n0,end,{ratio}\n");
        let law = arching("critical-3");
        for seed in 1..=40 {
            assert_eq!(walk_by(&network, &law, 120, 120, seed).eroded, passes, "{ratio} {seed}");
        }
    }
}

/// The laws whose probability is neither 0 nor 1.
const RANDOM: [&str; 2] = ["zuriguel-2005", "marin-2018"];

/// Of two that are alike, whichever is taken: both close after two geometric numbers.
#[test]
fn through_two_side_by_side_pass_two_geometric_numbers() {
    for law in RANDOM {
        let found = passed("from,to,diameter_mm\nstart,0,\n0,end,2\n0,end,2\n", law);
        let p = probability(law, 2.0);
        is_near(&found, 2.0 * (1.0 - p) / p);
    }
}

/// Of three in a row the first that closes ends it: the least of three geometric numbers.
#[test]
fn through_three_in_a_row_passes_the_least_of_three() {
    for law in RANDOM {
        let found = passed("from,to,diameter_mm\nstart,0,\n0,1,1.5\n1,2,2\n2,end,2.5\n", law);
        let all: f64 = [1.5, 2.0, 2.5].map(|ratio| 1.0 - probability(law, ratio)).iter().product();
        is_near(&found, all / (1.0 - all));
    }
}

/// At a fork into unlike ways each takes its share by area until one closes, then all take the other.
#[test]
fn at_a_fork_the_other_way_takes_all_once_one_is_closed() {
    for law in RANDOM {
        let found = passed("from,to,diameter_mm\nstart,0,\n0,end,1.5\n0,end,2\n", law);
        let share = 1.5f64.powi(2) / (1.5f64.powi(2) + 4.0);
        let [narrow, wide] = [1.5, 2.0].map(|ratio| probability(law, ratio));
        let closes = [share * narrow, (1.0 - share) * wide];
        let any = closes[0] + closes[1];
        let then = (closes[0] * (1.0 - wide) / wide + closes[1] * (1.0 - narrow) / narrow) / any;
        is_near(&found, (1.0 - any) / any + then);
    }
}

/// Where many jam at once, an arch keeps as many as it has: R^2 + 1. The others pass.
#[test]
fn an_arch_keeps_its_particles() {
    for (ratio, particles) in [(1.0, 2), (1.5, 3), (2.0, 5), (2.9, 9)] {
        let network = format!("from,to,diameter_mm\nstart,0,\n0,end,{ratio}\n");
        let tally = walk(&network, "critical-3", 50, 1, 7);
        assert_eq!((tally.retained_in_arches, tally.eroded, tally.arches), (particles, 50 - particles, 1));
        // Fewer than it has all stay, and the constriction is blocked all the same.
        let few = walk(&network, "critical-3", 2, 1, 7);
        assert_eq!((few.retained_in_arches, few.arches, few.blocked), (2, 1, 1));
    }
    let wide = walk("from,to,diameter_mm\nstart,0,\n0,end,3\n", "critical-3", 50, 1, 7);
    assert_eq!((wide.eroded, wide.arches), (50, 0));
}

/// However many come in one increment, in however many chunks, they begin one arch in a constriction, and
/// those beyond it pass: out of the filter, or into the next void.
#[test]
fn one_arch_begins_in_a_constriction_and_an_increment() {
    for n in [16_384, 16_385, 65_000, 200_000] {
        let tally = walk("from,to,diameter_mm\nstart,0,\n0,end,2\n", "critical-3", n, 1, 7);
        assert_eq!((tally.arches, tally.retained_in_arches), (1, 5), "{n}");
        assert_eq!((tally.eroded, tally.particle_moves), (n - 5, n - 5));
        // What passes the first meets the second in the next increment. R = 2.5 has 7.
        let tally = walk("from,to,diameter_mm\nstart,0,\n0,1,2\n1,end,2.5\n", "critical-3", n, 1, 7);
        assert_eq!((tally.arches, tally.retained_in_arches, tally.eroded), (2, 12, n - 12), "{n}");
        assert_eq!(tally.particle_moves, n - 5 + n - 12);
    }
}

/// Sixteen particles on average in front of each of many constrictions in one increment, in one chunk or
/// spread over five: how many jam in one is binomial, five of them stay, and as many constrictions close.
#[test]
fn how_many_are_in_arches_does_not_hang_on_the_chunk() {
    let p = probability("zuriguel-2005", 2.0);
    for chunks in [1, 5] {
        let n = chunks * CHUNK as u64;
        let ways = n / 16;
        let way = |void| format!("start,{void},\n{void},end,2\n");
        let network = format!("from,to,diameter_mm\n{}", (0..ways).map(way).collect::<String>());
        let each = p / ways as f64;
        let (mut jam, mut retained) = ((n as f64 * (-each).ln_1p()).exp(), 0.0);
        let none = jam;
        for k in 0..60u64 {
            retained += jam * k.min(5) as f64;
            jam *= (n - k) as f64 / (k + 1) as f64 * each / (1.0 - each);
        }
        let found: Vec<Tally> = (1..=20).map(|seed| walk(&network, "zuriguel-2005", n, 1, seed)).collect();
        let arches: Vec<f64> = found.iter().map(|tally| tally.arches as f64).collect();
        let inside: Vec<f64> = found.iter().map(|tally| tally.retained_in_arches as f64).collect();
        is_near(&arches, ways as f64 * (1.0 - none));
        is_near(&inside, ways as f64 * retained);
        // Three in a hundred off would be seen.
        assert!(variance(&inside).sqrt() * 5.0 / 20f64.sqrt() < 0.03 * ways as f64 * retained);
    }
}

/// One constriction, in front of which so many particles lie at once in a void of known volume. Each asks the
/// law for the concentration of the others; of those that jam five stay. Of one size every size that may count
/// is the same.
#[test]
fn by_void_the_concentration_is_that_of_the_others() {
    const NETWORK: &str = "from,to,diameter_mm\nstart,0,\n0,end,2\n";
    let law = Law::named("marin-2018").unwrap();
    for size in ArchSize::ALL {
        for (n, void_cube) in [(2u64, 15.0), (6, 40.0), (13, 40.0)] {
            let by_void = Arc::new(Arching::by_void(law, ByVoid { void_cube, size }));
            let found: Vec<f64> =
                (1..=SEEDS).map(|seed| walk_by(NETWORK, &by_void, n, 1, seed).eroded as f64).collect();
            let p = law.probability(2.0, (n - 1) as f64 / void_cube);
            let ways = |k: u64| (0..k).map(|i| (n - i) as f64 / (i + 1) as f64).product::<f64>();
            let jam = |k: u64| ways(k) * p.powi(k as i32) * (1.0 - p).powi((n - k) as i32);
            is_near(&found, n as f64 - (0..=n).map(|k| jam(k) * k.min(5) as f64).sum::<f64>());
            let all = mean(found.iter().map(|&eroded| f64::from(eroded == n as f64)));
            let wanted = jam(0);
            let error = (wanted * (1.0 - wanted) / SEEDS as f64).sqrt();
            assert!((all - wanted).abs() < 5.0 * error, "{n}: {all} and not {wanted}");
        }
        // One by one none has another beside it.
        let by_void = Arc::new(Arching::by_void(law, ByVoid { void_cube: 15.0, size }));
        assert_eq!(walk_by(NETWORK, &by_void, 120, 120, 3).eroded, 120);
    }
}

/// Of mixed sizes each size that may count gives its own probability. Three particles of 1 to 2 come into one
/// void at once; in front of its only exit each asks the law as it is written here, so that all pass with the
/// product of what is left.
#[test]
fn by_void_each_size_asks_for_its_own_ratio() {
    let text = "from,to,diameter_mm\nstart,0,\n0,1,100\n1,end,2.4\n";
    let network = Network::from_csv(text.as_bytes(), "network.csv", 1.0).unwrap();
    let law = Law::named("marin-2018").unwrap();
    let void_cube = 60.0;
    let mut expected = Vec::new();
    for size in ArchSize::ALL {
        let by_void = Arc::new(Arching::by_void(law, ByVoid { void_cube, size }));
        let base = Gradation::linear_from_d0(1.0, 2.0).unwrap();
        let supply = Supply::new(SizeSampler::new(&base, 1.0).unwrap(), 3, 1).arching_by(Some(by_void));
        let (mut found, mut wanted, mut variance) = (0.0, 0.0, 0.0);
        for seed in 1..=4 * SEEDS {
            let open: BitVec = BitVec::repeat(false, network.constrictions());
            let mut state =
                State::new(&network, &supply, SizeClasses::logarithmic(0.5, 4.0, 4), open, seed, 1);
            let mut walk = Walk::new(&network, &supply, &state);
            walk.increment(&mut state).unwrap();
            let sizes: Vec<f64> = state.particles.chunk(0).1.iter().map(|&d| f64::from(d)).collect();
            assert_eq!(sizes.len(), 3);
            let cubes: f64 = sizes.iter().map(|d| d.powi(3)).sum();
            let coarsest = sizes.iter().copied().fold(0.0, f64::max);
            let passes = |&d: &f64| {
                // What does not fit is in no arch.
                if d > 2.4 {
                    return 1.0;
                }
                // Of three the 85 % are reached by the coarsest alone.
                let of = [d, (cubes / 3.0).cbrt(), coarsest][size as usize];
                1.0 - law.probability(f64::from(2.4f32) / of, (cubes - d.powi(3)) / void_cube)
            };
            let all: f64 = sizes.iter().map(passes).product();
            while !state.finished {
                walk.increment(&mut state).unwrap();
            }
            found += f64::from(state.tally.retained_in_arches == 0);
            wanted += all;
            variance += all * (1.0 - all);
        }
        assert!((found - wanted).abs() < 5.0 * variance.sqrt(), "{size:?}: {found} and not {wanted}");
        expected.push(wanted);
        // The mean volume taken for another would be seen; D85 and the own size come to nearly the same here.
        let before = expected.iter().rev().nth(1).copied().unwrap_or(f64::MAX);
        assert!((before - wanted).abs() > 5.0 * variance.sqrt(), "{expected:?}");
    }
}

/// Particles that circle, each alone in its void, would never arch: they are trapped.
#[test]
fn who_circles_alone_is_trapped() {
    let law = Law::named("marin-2018").unwrap();
    let ring = "from,to,diameter_mm\nstart,0,\n0,1,2\n1,0,2\n1,end,0\n";
    let by_void = Arc::new(Arching::by_void(law, ByVoid { void_cube: 40.0, size: ArchSize::Own }));
    let tally = walk_by(ring, &by_void, 1, 1, 3);
    assert_eq!((tally.trapped, tally.eroded), (1, 0));
}
