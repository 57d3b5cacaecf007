//! Stratified start nodes and sizes against independent ones: the same law with less scatter, by every engine.

use bitvec::vec::BitVec;
use rayon::prelude::*;
use voidwalk::constrictions::find;
use voidwalk::gradation::{Gradation, SizeSampler};
use voidwalk::network::Network;
use voidwalk::walk::{Engine, RunPlan, Sampling, SizeClasses, State, Walk, WalkControl};

const N_BASE: u64 = 30_000;

/// Eroded mass fraction, share of constrictions blocked, largest eroded (mm of the reference), for both runs.
fn figures(
    network: &Network,
    sampler: &SizeSampler,
    engine: Engine,
    sampling: Sampling,
    seed: u64,
) -> [f64; 6] {
    let mut blocked: BitVec = BitVec::repeat(false, network.constrictions());
    let mut found = [0.0; 6];
    for run in 1..=2u64 {
        let plan = RunPlan::new(engine, network, sampler, &blocked, N_BASE / 100).sampled(sampling);
        let supply = plan.supply(sampler.clone(), N_BASE, 100, seed, run);
        let classes = SizeClasses::logarithmic(sampler.smallest(), sampler.largest(), 16);
        let mut state = State::new(network, &supply, classes, blocked, seed, run);
        Walk::new(network, &supply, &state).run(&mut state, &mut |_| WalkControl::Continue).unwrap();
        let t = &state.tally;
        assert_eq!(t.inserted, N_BASE);
        let at = 3 * (run as usize - 1);
        found[at] = t.eroded_mass / t.inserted_mass;
        found[at + 1] = t.blocked as f64 / network.constrictions() as f64;
        found[at + 2] = f64::from(t.largest_eroded);
        blocked = state.blocked;
    }
    found
}

fn mean_and_error(values: &[f64]) -> (f64, f64) {
    let n = values.len() as f64;
    let mean = values.iter().sum::<f64>() / n;
    let squares: f64 = values.iter().map(|v| (v - mean).powi(2)).sum();
    (mean, (squares / (n - 1.0) / n).sqrt())
}

fn base(cu: f64, percent: f64) -> (voidwalk::constrictions::Curve, SizeSampler) {
    let curve = find("shire2016-cu1.5-loose").unwrap().curve().unwrap();
    let base = Gradation::linear_from_dx(85.0, curve.dc(percent).unwrap(), cu).unwrap();
    (curve, SizeSampler::new(&base, 1.0).unwrap())
}

/// An equivalence test: on the networks of 200 replicates, paired, the difference of the means lies within the limits below with
/// 99.9 % confidence (3.3 standard errors), for both runs and each engine. What it could miss is a difference below that.
#[test]
fn stratified_and_independent_draws_have_the_same_means() {
    let (curve, sampler) = base(3.0, 15.0);
    let replicates = 200;
    let networks: Vec<Network> =
        (0..replicates).map(|k| Network::cubic([12, 12, 15], &curve, 1.0, k).unwrap()).collect();
    for engine in [Engine::Particles, Engine::Counts, Engine::Expected] {
        let differences: Vec<([f64; 6], [f64; 6])> = (0..replicates)
            .into_par_iter()
            .map(|k| {
                let of = |sampling| figures(&networks[k as usize], &sampler, engine, sampling, 500 + k);
                (of(Sampling::Stratified), of(Sampling::Independent))
            })
            .collect();
        for (figure, limit) in LIMITS.into_iter().enumerate() {
            let of = |pair: &([f64; 6], [f64; 6])| pair.0[figure] - pair.1[figure];
            let (difference, error) = mean_and_error(&differences.iter().map(of).collect::<Vec<_>>());
            let (level, _) = mean_and_error(&differences.iter().map(|d| d.1[figure]).collect::<Vec<_>>());
            println!(
                "{engine:?} figure {figure}: {level:.5}, difference {difference:.2e}, error {error:.1e}"
            );
            let within = (difference.abs() + 3.3 * error) / level;
            assert!(within <= limit, "{engine:?}, figure {figure}: {within}");
        }
    }
}

/// What the means of eroded mass, blocked, largest eroded of both runs may differ by, as a share of the mean.
const LIMITS: [f64; 6] = [0.015, 0.035, 0.03, 0.025, 0.025, 0.025];

/// On one network, where only the draws differ: 60 walks each; the ratio of variances is an F of 59 and 59 degrees of freedom, 2.2
/// at 0.1 %. A gain below about 3 would be missed half the time.
#[test]
fn stratified_draws_scatter_less_on_one_network() {
    let (curve, sampler) = base(3.0, 15.0);
    let network = Network::cubic([12, 12, 15], &curve, 1.0, 7).unwrap();
    for engine in [Engine::Particles, Engine::Counts] {
        let variance = |sampling| {
            let walks: Vec<f64> =
                (0..60).map(|seed| figures(&network, &sampler, engine, sampling, seed)[0]).collect();
            mean_and_error(&walks).1.powi(2)
        };
        let gain = variance(Sampling::Independent) / variance(Sampling::Stratified);
        println!("{engine:?}: variance {gain:.1} times smaller");
        assert!(gain > 2.2, "{engine:?}: {gain}");
    }
}
