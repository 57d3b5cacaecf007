//! The library's walk on the scene of `benches/baseline`, timed as the plain walks there time themselves.
//!
//! `cargo bench --bench compare_walk -- N SCENE SEED UNTIL THREADS ISA` prints one line of name and value
//! pairs: the pairs of `benches/baseline/README.md` (processor time of all threads, per attempted move), and
//! wall times (`wall_step_all`, `wall_step_after`).

use std::sync::OnceLock;
use std::time::Instant;

use voidwalk::constrictions;
use voidwalk::gradation::{Gradation, SizeSampler};
use voidwalk::network::Network;
use voidwalk::walk::{Isa, SizeClasses, State, Supply, Walk, WalkControl};

const INCREMENTS: u64 = 100;

/// Wall and processor time, in seconds; the latter of all threads, to within a tick of the scheduler.
fn now() -> [f64; 2] {
    static START: OnceLock<Instant> = OnceLock::new();
    let tasks = std::fs::read_dir("/proc/self/task").expect("Linux");
    let spent = tasks.filter_map(|task| {
        let text = std::fs::read_to_string(task.ok()?.path().join("schedstat")).ok()?;
        text.split(' ').next()?.parse::<f64>().ok()
    });
    [START.get_or_init(Instant::now).elapsed().as_secs_f64(), spent.sum::<f64>() * 1e-9]
}

fn main() {
    let arguments: Vec<String> = std::env::args().skip(1).filter(|a| a != "--bench").collect();
    let [n, scene, seed, until, threads, isa] = &arguments[..] else {
        eprintln!("usage: compare_walk N graded|passive SEED UNTIL THREADS portable|avx2|avx512");
        std::process::exit(2);
    };
    let number = |text: &str| text.parse::<u64>().expect("a whole number");
    let (n, seed, until, threads) = (number(n), number(seed), number(until), number(threads) as usize);
    let isa = Isa::ALL.into_iter().find(|i| i.name() == isa).expect("portable, avx2 or avx512");
    let pool = voidwalk::walk::threads(threads, true).expect("threads");
    pool.install(|| run(n, scene, seed, until, isa));
}

fn run(n: u64, scene: &str, seed: u64, until: u64, isa: Isa) {
    let curve = constrictions::find("shire2016-cu1.5-loose").unwrap().curve().unwrap();
    let network = Network::cubic([40, 40, 60], &curve, 1.0, seed).unwrap();
    let base = match scene {
        "passive" => Gradation::linear_from_d0(0.16 / (4.5 * 4.5), 4.5),
        _ => Gradation::linear_from_dx(85.0, curve.dc(5.0).unwrap(), 4.5),
    };
    let sampler = SizeSampler::new(&base.unwrap(), 1.0).unwrap();
    let classes = SizeClasses::logarithmic(sampler.smallest(), sampler.largest(), 64);
    let supply = Supply::new(sampler, n, INCREMENTS);
    let open = bitvec::vec::BitVec::repeat(false, network.constrictions());
    let mut state = State::new(&network, &supply, classes, open, seed, 1);
    let mut walk = Walk::new(&network, &supply, &state).with_isa(isa);

    let (mut steps, mut steps_after, mut moving) = (0, 0, 0);
    let begin = now();
    let mut inserted = begin;
    let outcome = walk.run(&mut state, &mut |state: &State| {
        let t = state.increment;
        let attempts = moving + supply.inserted(t) - supply.inserted(t - 1);
        moving = state.tally.moving;
        steps += attempts;
        if t > INCREMENTS {
            steps_after += attempts;
        } else if t == INCREMENTS {
            inserted = now();
        }
        if t == until { WalkControl::Stop } else { WalkControl::Continue }
    });
    let end = now();
    assert!(outcome.is_ok() || state.increment == until);
    let per = |from: [f64; 2], steps: u64| [0, 1].map(|k| (end[k] - from[k]) / steps as f64 * 1e9);
    let ([wall_all, all], [wall_after, after]) = (per(begin, steps), per(inserted, steps_after));
    let tally = state.tally;
    println!(
        "steps {steps} ns_step_all {all:.4} steps_after {steps_after} ns_step_after {after:.4} eroded {} blocked {} \
         eroded_mass {:.6} wall_step_all {wall_all:.4} wall_step_after {wall_after:.4}",
        tally.eroded, tally.blocked, tally.eroded_mass,
    );
}
