//! Do intervals hold what they promise? A thousand cells of replicates, each with a known answer.

use bitvec::vec::BitVec;
use rayon::prelude::*;
use voidwalk::constrictions::find;
use voidwalk::gradation::{Gradation, SizeSampler};
use voidwalk::network::Network;
use voidwalk::outcome::record::Statistic;
use voidwalk::walk::{Engine, RunPlan, SizeClasses, State, Walk, WalkControl};

/// Replicates of a cell, as many as a scene has by default.
const REPLICATES: u64 = 10;

const CELLS: u64 = 1000;

/// Chosen before the first look at a result, and not since.
const SEED: u64 = 20_161_121;

/// Eroded mass over inserted mass of one first run.
fn eroded(
    network: &Network,
    sampler: &SizeSampler,
    n: u64,
    increments: u64,
    engine: Engine,
    seed: u64,
) -> f64 {
    let open: BitVec = BitVec::repeat(false, network.constrictions());
    let plan = RunPlan::new(engine, network, sampler, &open, n / increments);
    let supply = plan.supply(sampler.clone(), n, increments, seed, 1);
    let classes = SizeClasses::logarithmic(sampler.smallest(), sampler.largest(), 4);
    let mut state = State::new(network, &supply, classes, open, seed, 1);
    Walk::new(network, &supply, &state).run(&mut state, &mut |_| WalkControl::Continue).unwrap();
    state.tally.eroded_mass / state.tally.inserted_mass
}

/// The chance that a particle which passes every open constriction leaves, over uniform start nodes. A void without an open exit keeps
/// what enters it.
fn leaves(network: &Network) -> f64 {
    network.first_passage(0.1, |_| false).unwrap().at_start(network).0
}

fn covers(values: &[f64], answer: f64) -> bool {
    let statistic = Statistic::of(values);
    statistic.low.unwrap() <= answer && answer <= statistic.high.unwrap()
}

fn assert_nominal(covered: usize, what: &str) {
    let share = covered as f64 / CELLS as f64;
    println!("{what}: {covered} of {CELLS} intervals cover");
    // Nominal 95 %: the standard error of the share is 0.7 %, so the limits are 3.3 of them away.
    assert!((0.927..=0.973).contains(&share), "{what}: {covered} of {CELLS} intervals cover");
}

/// Cells with an exact answer: random lattices in which a third of the constrictions are closed from the start, so that some voids
/// keep what enters them, and base particles that pass all others; by both engines in turn. A true coverage below about
/// 92 or above 98 % would be seen in more than four of five trials.
#[test]
fn intervals_cover_the_linear_solve_on_a_thousand_networks() {
    let sampler = SizeSampler::new(&Gradation::linear_from_d0(0.01, 1.3).unwrap(), 1.0).unwrap();
    let cells: Vec<(u64, Network, f64)> = (0..)
        .map(|cell| (cell, lattice_with_closed_constrictions(SEED ^ cell)))
        .map(|(cell, network)| (cell, leaves(&network), network))
        .filter(|(_, answer, _)| (0.05..0.95).contains(answer))
        .map(|(cell, answer, network)| (cell, network, answer))
        .take(CELLS as usize)
        .collect();
    let covered = cells.par_iter().filter(|(cell, network, answer)| {
        let engine = [Engine::Particles, Engine::Counts][(cell % 2) as usize];
        let values: Vec<f64> = (0..REPLICATES)
            .map(|k| eroded(network, &sampler, 3000, 3, engine, SEED + 1000 * cell + k))
            .collect();
        covers(&values, *answer)
    });
    assert_nominal(covered.count(), "passive particles against the linear solve");
}

fn lattice_with_closed_constrictions(mut draw: u64) -> Network {
    let mut next = || {
        draw = draw.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        draw >> 33
    };
    let mut diameter = || if next() % 3 == 0 { 0.0 } else { 0.5 + (next() % 1000) as f32 / 500.0 };
    let diameters: Vec<f32> = (0..3 * 48).map(|_| diameter()).collect();
    Network::cubic_from_diameters([4, 4, 3], diameters, 1.0).unwrap()
}

/// Cells as users have them: new networks, blocking, a graded base. The answer is the mean of all 10,000 replicates, whose own error
/// is a hundredth of the variance of a cell's mean. The replicates are skewed, as real ones are.
#[test]
fn intervals_cover_the_mean_where_constrictions_block() {
    let curve = find("shire2016-cu1.5-loose").unwrap().curve().unwrap();
    let base = Gradation::linear_from_dx(85.0, curve.dc(15.0).unwrap(), 1.5).unwrap();
    let sampler = SizeSampler::new(&base, 1.0).unwrap();
    let values: Vec<f64> = (0..CELLS * REPLICATES)
        .into_par_iter()
        .map(|k| {
            let network = Network::cubic([6, 6, 8], &curve, 1.0, SEED + k).unwrap();
            eroded(&network, &sampler, 1500, 10, Engine::Particles, SEED + k)
        })
        .collect();
    let answer = values.iter().sum::<f64>() / values.len() as f64;
    println!("mean {answer:.4}");
    let covered = values.chunks(REPLICATES as usize).filter(|cell| covers(cell, answer));
    assert_nominal(covered.count(), "blocking networks");
}
