//! Particle-steps, insertions and blockings a second: `cargo bench --bench walk`.
//!
//! Throughput counts particle-steps (attempted moves) for `step`, inserted particles for `insert`, blocked
//! constrictions for `merge`, and constrictions for `network`. Goals on one core, against the plain walk timed in
//! the same hour (`scripts/peers/compare_walk.py`): 15 times with AVX-512, 5 times portable.

use std::hint::black_box;
use std::time::{Duration, Instant};

use bitvec::vec::BitVec;
use criterion::{BenchmarkId, Criterion, Throughput, criterion_group, criterion_main};
use voidwalk::constrictions::{self, Curve};
use voidwalk::gradation::{Gradation, SizeSampler};
use voidwalk::network::Network;
use voidwalk::walk::{Isa, SizeClasses, State, Supply, Walk, threads};

fn curve() -> Curve {
    constrictions::find("shire2016-cu1.5-loose").unwrap().curve().unwrap()
}

fn network() -> Network {
    Network::cubic([40, 40, 60], &curve(), 1.0, 1).unwrap()
}

/// `n` particles of a base with Cu 4.5 and D85 = Dc`percent`, inserted over `increments`.
fn supply(percent: f64, n: u64, increments: u64) -> Supply {
    let base = Gradation::linear_from_dx(85.0, curve().dc(percent).unwrap(), 4.5).unwrap();
    Supply::new(SizeSampler::new(&base, 1.0).unwrap(), n, increments)
}

fn state(network: &Network, supply: &Supply) -> State {
    let sampler = supply.sampler();
    let classes = SizeClasses::logarithmic(sampler.smallest(), sampler.largest(), 64);
    State::new(network, supply, classes, BitVec::repeat(false, network.constrictions()), 1, 1)
}

/// Increments `from + 1 ..= to` of fresh walks, timed alone: time and attempted moves of `times` such.
fn increments(network: &Network, supply: &Supply, isa: Isa, span: [u64; 2], times: u64) -> (Duration, u64) {
    let (mut spent, mut steps) = (Duration::ZERO, 0);
    for _ in 0..times {
        let mut state = state(network, supply);
        let mut walk = Walk::new(network, supply, &state).with_isa(isa);
        for _ in 0..span[0] {
            walk.increment(&mut state).unwrap();
        }
        for t in span[0] + 1..=span[1] {
            steps += state.tally.moving + supply.inserted(t) - supply.inserted(t - 1);
            let begin = Instant::now();
            walk.increment(&mut state).unwrap();
            spent += begin.elapsed();
        }
        black_box(&state);
    }
    (spent, steps)
}

/// Steps without insertion, insertion with one step, and an increment that blocks a great deal.
fn walk(c: &mut Criterion) {
    let network = network();
    let pool = threads(1, false).unwrap();
    for (name, percent, n, span) in [
        ("step", 5.0, 1 << 20, [1, 60]),
        ("insert_and_step", 5.0, 1 << 20, [0, 1]),
        ("merge", 50.0, 1 << 17, [0, 1]),
    ] {
        let supply = supply(percent, n, 1);
        let mut group = c.benchmark_group(name);
        group.sample_size(10).measurement_time(Duration::from_secs(3));
        let (_, steps) = increments(&network, &supply, Isa::chosen(), span, 1);
        group.throughput(Throughput::Elements(steps));
        for isa in Isa::ALL.into_iter().filter(|isa| isa.is_available()) {
            group.bench_function(BenchmarkId::from_parameter(isa.name()), |bencher| {
                bencher
                    .iter_custom(|times| pool.install(|| increments(&network, &supply, isa, span, times).0));
            });
        }
    }
}

fn build(c: &mut Criterion) {
    let pool = threads(1, false).unwrap();
    let curve = curve();
    let mut group = c.benchmark_group("network");
    group.sample_size(10).throughput(Throughput::Elements(3 * 40 * 40 * 60));
    group.bench_function("cubic", |bencher| {
        bencher.iter(|| pool.install(|| Network::cubic([40, 40, 60], black_box(&curve), 1.0, 1).unwrap()));
    });
    let (network, supply) = (network(), supply(5.0, 1, 1));
    let state = state(&network, &supply);
    group.bench_function("exit_table", |bencher| {
        bencher.iter(|| Walk::new(black_box(&network), &supply, &state));
    });
}

criterion_group!(benches, walk, build);
criterion_main!(benches);
