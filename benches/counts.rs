//! Whole first runs of engines `counts` and `expected` on the paper's lattice, and of `particles` beside
//! them.
//!
//! `cargo bench --bench counts`; on one core with `RAYON_NUM_THREADS=1`. The base is the one of Fig. 13 with
//! Cu 4.5, D85B = Dc5 of the loose Cu 1.5 filter; for 1e12 particles it is graded so widely (Cu 24, same
//! D85B) that its number of coarse particles is about the number in 2e8 of it. Throughput is in moves that
//! particles complete. Goals, on one core: 2e8 in 0.5 s with AVX-512; 1e9 within 1.3 times that, 1e12 within
//! 2 times; less than 100 MB resident, which is printed at the end.

use std::time::Duration;

use bitvec::vec::BitVec;
use criterion::{Criterion, Throughput};
use voidwalk::constrictions::find;
use voidwalk::gradation::{Gradation, SizeSampler};
use voidwalk::network::Network;
use voidwalk::walk::{Engine, RunPlan, SizeClasses, State, Walk, WalkControl};

struct Scene {
    network: Network,
    sampler: SizeSampler,
}

impl Scene {
    fn new(cu: f64) -> Self {
        let curve = find("shire2016-cu1.5-loose").unwrap().curve().unwrap();
        let base = Gradation::linear_from_dx(85.0, curve.dc(5.0).unwrap(), cu).unwrap();
        let network = Network::cubic([40, 40, 60], &curve, 1.0, 1).unwrap();
        Self { network, sampler: SizeSampler::new(&base, 1.0).unwrap() }
    }

    /// The end of the run, and how many particles were walked one by one.
    fn first_run(&self, engine: Engine, n: u64) -> (State, u64) {
        let open = BitVec::repeat(false, self.network.constrictions());
        let plan = RunPlan::new(engine, &self.network, &self.sampler, &open, n / 100);
        let supply = plan.supply(self.sampler.clone(), n, 100, 1, 1);
        let classes = SizeClasses::logarithmic(self.sampler.smallest(), self.sampler.largest(), 64);
        let mut state = State::new(&self.network, &supply, classes, open, 1, 1);
        Walk::new(&self.network, &supply, &state).run(&mut state, &mut |_| WalkControl::Continue).unwrap();
        (state, supply.total())
    }
}

fn main() {
    let mut criterion = Criterion::default().configure_from_args();
    let mut group = criterion.benchmark_group("first run");
    group.sample_size(10).warm_up_time(Duration::from_millis(100));
    let (graded, wide) = (Scene::new(4.5), Scene::new(24.0));
    for (name, scene, engine, n) in [
        ("counts 2e8", &graded, Engine::Counts, 200_000_000),
        ("counts 1e9", &graded, Engine::Counts, 1_000_000_000),
        ("counts 1e12, wider base", &wide, Engine::Counts, 1_000_000_000_000),
        ("expected 2e8", &graded, Engine::Expected, 200_000_000),
        ("particles 1e6", &graded, Engine::Particles, 1_000_000),
    ] {
        let (state, one_by_one) = scene.first_run(engine, n);
        group.throughput(Throughput::Elements(state.tally.particle_moves));
        group.bench_function(name, |bencher| bencher.iter(|| scene.first_run(engine, n)));
        let (increments, moves) = (state.increment, state.tally.particle_moves);
        println!("{name}: {one_by_one} one by one, {increments} increments, {moves} moves");
    }
    group.finish();
    criterion.final_summary();
    let status = std::fs::read_to_string("/proc/self/status").unwrap_or_default();
    status.lines().filter(|line| line.starts_with("VmHWM")).for_each(|line| println!("{line}"));
}
