//! One first run of any engine on a lattice of any shape, timed: the growth of the cost with particles, voids
//! and threads.
//!
//! `cargo bench --bench scale_walk -- ENGINE N NX NY NZ THREADS ISA [CU]` prints one line of name and value
//! pairs. The filter is the loose Cu 1.5 one, the base linear with D85B = Dc5 and Cu 4.5 unless CU says
//! otherwise. `cpu` is the processor time of all threads, which are pinned unless the environment says PIN=0;
//! both times are of the run alone, without the network. `scripts/studies/scale_walk.sh` collects such lines
//! in a table, and `-- draw TABLE.csv FIGURES` draws it.

use std::sync::OnceLock;
use std::time::Instant;

use voidwalk::constrictions;
use voidwalk::gradation::{Gradation, SizeSampler};
use voidwalk::network::Network;
use voidwalk::report::figures::{Axis, BLUE, Colour, Dash, Figure, GREEN, Mark, Shape, VERMILLION};
use voidwalk::walk::{Engine, Isa, RunPlan, SizeClasses, State, Walk, WalkControl};

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
    if let [draw, table, prefix] = &arguments[..]
        && draw == "draw"
    {
        return figures(table, prefix);
    }
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
    let plan = RunPlan::new(engine, &network, &sampler, &open, n / 100);
    let classes = SizeClasses::logarithmic(sampler.smallest(), sampler.largest(), 64);
    let supply = plan.supply(sampler, n, 100, SEED, 1);
    let mut state = State::new(&network, &supply, classes, open, SEED, 1);
    let mut walk = Walk::new(&network, &supply, &state).with_isa(isa);
    walk.run(&mut state, &mut |_| WalkControl::Continue).expect("a whole run");
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

/// A row of the table: how often each combination was run does not matter, the quickest counts.
struct Measured {
    engine: String,
    n: f64,
    shape: [u32; 3],
    cu: String,
    threads: u32,
    cpu: f64,
}

fn measured(table: &str) -> Vec<Measured> {
    let text = std::fs::read_to_string(table).expect("the table");
    let row = |line: &str| {
        let cells: Vec<&str> = line.split(',').collect();
        let whole = |cell: usize| cells[cell].parse().expect("a whole number");
        Measured {
            engine: cells[0].into(),
            n: cells[1].parse().expect("a number"),
            shape: [whole(2), whole(3), whole(4)],
            cu: cells[5].into(),
            threads: whole(6),
            cpu: cells[9].parse().expect("a number"),
        }
    };
    text.lines().skip(1).map(row).collect()
}

/// Quickest runs by `x`, in its order.
fn series(
    rows: &[Measured],
    keep: impl Fn(&Measured) -> bool,
    x: impl Fn(&Measured) -> f64,
) -> Vec<(f64, f64)> {
    let mut points: Vec<(f64, f64)> =
        rows.iter().filter(|row| keep(row)).map(|row| (x(row), row.cpu)).collect();
    points.sort_by(|a, b| a.0.total_cmp(&b.0).then(a.1.total_cmp(&b.1)));
    points.dedup_by_key(|point| point.0);
    points
}

fn add(figure: &mut Figure, name: &str, points: Vec<(f64, f64)>, colour: Colour, dash: Dash) {
    points.iter().for_each(|&(x, y)| figure.add(Mark::point(x, y, colour, Shape::Circle)));
    figure.add(Mark::line(points, colour).dash(dash).label(name));
}

fn figures(table: &str, prefix: &str) {
    let rows = measured(table);
    let seconds = |least| Axis::log("Processor time of a first run (s)", least, 200.0);
    let on_paper = |row: &Measured| row.shape == [40, 40, 60] && row.threads == 1;
    let mut figure = Figure::new(
        "Cost against the number of base particles",
        "Processor time of a first run on 40 x 40 x 60 voids, one thread, by engine",
        Axis::log("Base particles", 1e5, 1e12),
        seconds(0.01),
    );
    for (name, engine, cu, colour, dash) in [
        ("particles", "particles", "4.5", VERMILLION, Dash::Solid),
        ("counts, Cu 4.5", "counts", "4.5", BLUE, Dash::Solid),
        ("counts, Cu 24", "counts", "24", BLUE, Dash::Dashed),
        ("expected, Cu 4.5", "expected", "4.5", GREEN, Dash::Dotted),
    ] {
        let keep = |row: &Measured| on_paper(row) && row.engine == engine && row.cu == cu;
        add(&mut figure, name, series(&rows, keep, |row| row.n), colour, dash);
    }
    std::fs::write(format!("{prefix}-particles.svg"), figure.names_above().file()).expect("a figure");

    let voids = |row: &Measured| row.shape.map(f64::from).iter().product::<f64>();
    let mut figure = Figure::new(
        "Cost against the number of voids",
        "Processor time of a first run on cubes of 10 to 160 voids a side, one thread",
        Axis::log("Voids", 1e3, 4.1e6),
        seconds(0.002),
    );
    for (name, engine, colour) in
        [("counts, 2083 particles a void", "counts", BLUE), ("particles, 2e6", "particles", VERMILLION)]
    {
        let keep = |row: &Measured| row.engine == engine && row.shape[0] == row.shape[2] && row.threads == 1;
        add(&mut figure, name, series(&rows, keep, voids), colour, Dash::Solid);
    }
    std::fs::write(format!("{prefix}-voids.svg"), figure.names_above().file()).expect("a figure");
}
