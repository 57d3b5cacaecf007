//! Arches where their numbers are known exactly: one constriction, two side by side, three in a row, a fork.
//!
//! One particle is inserted an increment, so that an arch is one particle. Bounds are five standard errors: a
//! probability that is off by 5 % of its value is found in the first two cases, by 10 % in the others.

use std::sync::Arc;

use bitvec::vec::BitVec;
use voidwalk::gradation::{Gradation, SizeSampler};
use voidwalk::network::Network;
use voidwalk::walk::{ArchSize, Arching, ByVoid, Law, SizeClasses, State, Supply, Tally, Walk};

/// Walks `n` particles of size 1, in so many increments, by a law at a concentration of 0.2.
fn walk(network: &str, law: &str, n: u64, increments: u64, seed: u64) -> Tally {
    walk_by(network, Arching::new(Law::named(law).unwrap(), 0.2), n, increments, seed)
}

fn walk_by(network: &str, law: Arching, n: u64, increments: u64, seed: u64) -> Tally {
    let network = Network::from_csv(network.as_bytes(), "network.csv", 1.0).unwrap();
    let sampler = SizeSampler::new(&Gradation::single(1.0).unwrap(), 1.0).unwrap();
    let supply = Supply::new(sampler, n, increments).arching_by(Some(Arc::new(law)));
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
    (1..=SEEDS).map(|seed| walk(network, law, 120, 120, seed).eroded as f64).collect()
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
#[test]
fn through_one_constriction_a_geometric_number_passes() {
    for (law, ratio) in [("zuriguel-2005", 1.5), ("zuriguel-2005", 2.0), ("marin-2018", 2.0)] {
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

/// Of two that are alike, whichever is taken: both close after two geometric numbers.
#[test]
fn through_two_side_by_side_pass_two_geometric_numbers() {
    let found = passed("from,to,diameter_mm\nstart,0,\n0,end,2\n0,end,2\n", "zuriguel-2005");
    let p = probability("zuriguel-2005", 2.0);
    is_near(&found, 2.0 * (1.0 - p) / p);
}

/// Of three in a row the first that closes ends it: the least of three geometric numbers.
#[test]
fn through_three_in_a_row_passes_the_least_of_three() {
    let found = passed("from,to,diameter_mm\nstart,0,\n0,1,1.5\n1,2,2\n2,end,2.5\n", "zuriguel-2005");
    let all: f64 = [1.5, 2.0, 2.5].map(|ratio| 1.0 - probability("zuriguel-2005", ratio)).iter().product();
    is_near(&found, all / (1.0 - all));
}

/// At a fork into unlike ways each takes its share by area until one closes, then all take the other.
#[test]
fn at_a_fork_the_other_way_takes_all_once_one_is_closed() {
    let found = passed("from,to,diameter_mm\nstart,0,\n0,end,1.5\n0,end,2\n", "zuriguel-2005");
    let share = 1.5f64.powi(2) / (1.5f64.powi(2) + 4.0);
    let [narrow, wide] = [1.5, 2.0].map(|ratio| probability("zuriguel-2005", ratio));
    let closes = [share * narrow, (1.0 - share) * wide];
    let any = closes[0] + closes[1];
    let then = (closes[0] * (1.0 - wide) / wide + closes[1] * (1.0 - narrow) / narrow) / any;
    is_near(&found, (1.0 - any) / any + then);
}

/// Where many come at once, an arch keeps as many as it has: R^2 + 1. The others have passed.
#[test]
fn an_arch_keeps_its_particles() {
    for (ratio, particles) in [(1.0, 2), (1.5, 3), (2.0, 5), (2.9, 9)] {
        let network = format!("from,to,diameter_mm\nstart,0,\n0,end,{ratio}\n");
        let tally = walk(&network, "critical-3", 50, 1, 7);
        assert_eq!((tally.retained_in_arches, tally.eroded, tally.arches), (particles, 50 - particles, 1));
        // Fewer than it needs all stay.
        assert_eq!(walk(&network, "critical-3", 2, 1, 7).retained_in_arches, 2);
    }
    let wide = walk("from,to,diameter_mm\nstart,0,\n0,end,3\n", "critical-3", 50, 1, 7);
    assert_eq!((wide.eroded, wide.arches), (50, 0));
}

/// Each chunk of 16,384 particles begins an arch of its own, in one increment and through one constriction: of
/// more chunks more is retained. This is what is done, not what grains do.
#[test]
fn each_chunk_begins_an_arch_of_its_own() {
    let one = "from,to,diameter_mm\nstart,0,\n0,end,2\n";
    for (n, arches) in [(16_384, 1), (16_385, 2), (65_000, 4), (200_000, 13)] {
        let tally = walk(one, "critical-3", n, 1, 7);
        // The last chunk has one particle in the second case.
        let retained = if n == 16_385 { 6 } else { 5 * arches };
        assert_eq!((tally.arches, tally.retained_in_arches), (arches, retained), "{n}");
        assert_eq!(tally.eroded, n - retained);
    }
}

/// One constriction, in front of which so many particles lie at once in a void of known volume. Each asks the
/// law for the concentration of the others; the first that starts an arch keeps four of those after it.
#[test]
fn by_void_the_concentration_is_that_of_the_others() {
    const NETWORK: &str = "from,to,diameter_mm\nstart,0,\n0,end,2\n";
    let law = Law::named("marin-2018").unwrap();
    for size in ArchSize::ALL {
        let by_void = || Arching::by_void(law, ByVoid { void_cube: 40.0, size });
        for n in [2u64, 6, 13] {
            let found: Vec<f64> =
                (1..=SEEDS).map(|seed| walk_by(NETWORK, by_void(), n, 1, seed).eroded as f64).collect();
            let p = law.probability(2.0, (n - 1) as f64 / 40.0);
            let before = |k: u64| (1.0 - p).powi(k as i32);
            let stays = |k: u64| (n - k).min(5) as f64;
            is_near(&found, n as f64 - (0..n).map(|k| before(k) * p * stays(k)).sum::<f64>());
            let all = mean(found.iter().map(|&eroded| f64::from(eroded == n as f64)));
            let wanted = before(n);
            let error = (wanted * (1.0 - wanted) / SEEDS as f64).sqrt();
            assert!((all - wanted).abs() < 5.0 * error, "{n}: {all} and not {wanted}");
        }
        // One by one none has another beside it.
        assert_eq!(walk_by(NETWORK, by_void(), 120, 120, 3).eroded, 120);
    }
}

/// Particles that circle, each alone in its void, would never arch: they are trapped.
#[test]
fn who_circles_alone_is_trapped() {
    let law = Law::named("marin-2018").unwrap();
    let ring = "from,to,diameter_mm\nstart,0,\n0,1,2\n1,0,2\n1,end,0\n";
    let by_void = Arching::by_void(law, ByVoid { void_cube: 40.0, size: ArchSize::Own });
    let tally = walk_by(ring, by_void, 1, 1, 3);
    assert_eq!((tally.trapped, tally.eroded), (1, 0));
}
