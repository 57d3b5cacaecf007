//! Engines `counts` and `particles` are two ways to the same law: whole runs over replicates.

use bitvec::vec::BitVec;
use voidwalk::constrictions::find;
use voidwalk::gradation::{Gradation, SizeSampler};
use voidwalk::network::Network;
use voidwalk::walk::{Engine, RunPlan, SizeClasses, State, Walk, WalkControl};

const REPLICATES: u64 = 28;
const N_BASE: u64 = 120_000;

/// Names of the figures that are compared, in order, and for each run the most that four standard errors of the mean difference
/// may be, as a share of the mean: what the test can see.
const FIGURES: [(&str, [f64; 2]); 10] = [
    ("eroded mass", [0.04, 0.06]),
    ("eroded number", [0.035, 0.06]),
    ("largest eroded", [0.02, 0.01]),
    ("retained in voids", [0.03, 0.02]),
    ("retained in constrictions", [0.02, 0.07]),
    ("blocked", [0.015, 0.01]),
    ("blocked in the first three layers", [0.02, 0.015]),
    ("moves", [0.03, 0.02]),
    ("increments", [0.04, 0.04]),
    ("retained number finer than the median class", [0.004, 0.005]),
];

fn figures(network: &Network, state: &State, n: u64) -> [f64; FIGURES.len()] {
    let t = &state.tally;
    let top = (0..network.voids() as u32).filter(|&v| network.layer_of()[v as usize] < 3);
    let blocked = top.flat_map(|v| network.exits(v)).filter(|&c| state.blocked[c]).count();
    let finer: u64 = state.retained_sizes.number[..4].iter().sum();
    [
        t.eroded_mass / t.inserted_mass,
        t.eroded as f64 / n as f64,
        f64::from(t.largest_eroded),
        t.retained_in_voids as f64 / n as f64,
        t.retained_in_constrictions as f64 / n as f64,
        t.blocked as f64,
        blocked as f64,
        t.particle_moves as f64 / n as f64,
        state.increment as f64,
        finer as f64 / state.retained_sizes.number.iter().sum::<u64>() as f64,
    ]
}

/// First and second run of each engine on the networks of 28 replicates, paired by network; bound 4 on twenty t
/// scores (27 degrees of freedom: a false alarm in 0.9 % of seeds, and these are fixed). The table above states, and the
/// test checks, what difference of the means would show. Differences in the shape of a scatter would not show here; the test on
/// one shared history looks at those.
#[test]
fn replicates_of_both_engines_have_the_same_means() {
    let curve = find("shire2016-cu1.5-loose").unwrap().curve().unwrap();
    let base = Gradation::linear_from_dx(85.0, curve.dc(15.0).unwrap(), 1.8).unwrap();
    let sampler = SizeSampler::new(&base, 1.0).unwrap();
    let mut difference = vec![[[0.0; FIGURES.len()]; 2]; REPLICATES as usize];
    let mut mean = [[0.0; FIGURES.len()]; 2];
    for replicate in 0..REPLICATES {
        let network = Network::cubic([12, 12, 20], &curve, 1.0, replicate).unwrap();
        for (engine, sign) in [(Engine::Counts, 1.0), (Engine::Particles, -1.0)] {
            let mut blocked: BitVec = BitVec::repeat(false, network.constrictions());
            for run in 1..=2 {
                let seed = 1000 + replicate;
                let plan = RunPlan::new(engine, &network, &sampler, &blocked, N_BASE / 100);
                assert_eq!(plan.engine(), engine);
                let supply = plan.supply(sampler.clone(), N_BASE, 100, seed, run);
                let classes = SizeClasses::logarithmic(sampler.smallest(), sampler.largest(), 16);
                let mut state = State::new(&network, &supply, classes, blocked, seed, run);
                Walk::new(&network, &supply, &state).run(&mut state, &mut |_| WalkControl::Continue).unwrap();
                for (f, value) in figures(&network, &state, N_BASE).into_iter().enumerate() {
                    difference[replicate as usize][run as usize - 1][f] += sign * value;
                    mean[run as usize - 1][f] += value / (2 * REPLICATES) as f64;
                }
                blocked = state.blocked;
            }
        }
    }
    let n = REPLICATES as f64;
    for run in 0..2 {
        for (f, (name, visible)) in FIGURES.into_iter().enumerate() {
            let of = |r: &[[f64; FIGURES.len()]; 2]| r[run][f];
            let average: f64 = difference.iter().map(of).sum::<f64>() / n;
            let square: f64 = difference.iter().map(|r| (of(r) - average).powi(2)).sum();
            let error = (square / (n - 1.0) / n).sqrt();
            println!(
                "run {} {name}: mean {:.5}, difference {average:.2e}, t {:.2}, visible {:.4}",
                run + 1,
                mean[run][f],
                average / error,
                4.0 * error / mean[run][f]
            );
            assert!(average.abs() <= 4.0 * error, "run {}: {name}", run + 1);
            assert!(4.0 * error <= visible[run] * mean[run][f], "run {}: {name}: weak", run + 1);
        }
    }
}
