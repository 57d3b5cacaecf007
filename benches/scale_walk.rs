//! One first run of any engine on a lattice of any shape, timed: how the cost grows with particles, voids and threads.
//!
//! `cargo bench --bench scale_walk -- ENGINE N NX NY NZ THREADS ISA [CU]` prints one line of name and value pairs. The filter is
//! the loose Cu 1.5 one, the base linear with D85B = Dc5 and Cu 4.5 unless CU says otherwise. `cpu` is the processor time of all
//! threads, which are pinned unless the environment says PIN=0; both times are of the run alone, without the network. `scripts/scale_walk.sh` calls it and draws the figures.

use std::sync::OnceLock;
use std::time::Instant;

use voidwalk::constrictions;
use voidwalk::gradation::{Gradation, SizeSampler};
use voidwalk::network::Network;
use voidwalk::walk::{Engine, Isa, Plan, Progress, SizeClasses, State, Walk};

const SEED: u64 = 1;

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
    let [engine, n, nx, ny, nz, threads, isa, rest @ ..] = &arguments[..] else {
        eprintln!("usage: scale_walk ENGINE N NX NY NZ THREADS portable|avx2|avx512 [CU]");
        std::process::exit(2);
    };
    let number = |text: &str| text.parse::<u64>().expect("a whole number");
    let engine = Engine::ALL.into_iter().find(|e| e.name() == engine).expect("an engine");
    let isa = Isa::ALL.into_iter().find(|i| i.name() == isa).expect("portable, avx2 or avx512");
    let shape = [nx, ny, nz].map(|n| number(n) as u32);
    let cu = rest.first().map_or(4.5, |text| text.parse().expect("a number"));
    let pinned = std::env::var_os("PIN").is_none_or(|pin| pin != "0");
    let pool = voidwalk::walk::threads(number(threads) as usize, pinned).expect("threads");
    let n = number(n);
    pool.install(|| run(engine, n, shape, cu, isa));
}

fn run(engine: Engine, n: u64, shape: [u32; 3], cu: f64, isa: Isa) {
    let curve = constrictions::find("shire2016-cu1.5-loose").unwrap().curve().unwrap();
    let network = Network::cubic(shape, &curve, 1.0, SEED).unwrap();
    let base = Gradation::linear_from_dx(85.0, curve.dc(5.0).unwrap(), cu).unwrap();
    let sampler = SizeSampler::new(&base, 1.0).unwrap();
    let open = bitvec::vec::BitVec::repeat(false, network.constrictions());
    let begin = now();
    let plan = Plan::new(engine, &network, &sampler, &open, n / 100);
    let classes = SizeClasses::logarithmic(sampler.smallest(), sampler.largest(), 64);
    let supply = plan.supply(sampler, n, 100, SEED, 1);
    let mut state = State::new(&network, &supply, classes, open, SEED, 1);
    let mut walk = Walk::new(&network, &supply, &state).with_isa(isa);
    walk.run(&mut state, &mut |_| Progress::Continue).expect("a whole run");
    let end = now();
    let status = std::fs::read_to_string("/proc/self/status").unwrap_or_default();
    let peak = status.lines().find_map(|line| line.strip_prefix("VmHWM:")?.trim().strip_suffix(" kB"));
    println!(
        "engine {} wall {:.6} cpu {:.6} increments {} moves {} one_by_one {} eroded {} blocked {} peak_mb {}",
        plan.engine().name(),
        end[0] - begin[0],
        end[1] - begin[1],
        state.increment,
        state.tally.particle_moves,
        supply.total(),
        state.tally.eroded,
        state.tally.blocked,
        peak.map_or(0, |kib| kib.parse::<u64>().unwrap_or(0) / 1024),
    );
}
