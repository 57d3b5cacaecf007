//! Distance of each kernel from the limits of this machine: `cargo bench --bench roofline`, one thread. Words
//! after `--` name kernels: runs these alone, without the limits, so that a profiler sees one.
//!
//! First the machine's limits: bytes copied a second by size of the copy, a random read, multiplications and
//! additions a second. Then the kernels, all of them in each of seven turns. Prints a line of JSON for each,
//! with nanoseconds of processor time an item in every turn; `results/speed.md` says how far each kernel
//! is from its limit.

use std::hint::black_box;
use std::rc::Rc;
use std::time::{Duration, Instant};

use rustix::time::{ClockId, clock_gettime};

use bitvec::vec::BitVec;
use voidwalk::constrictions::{Constrictions, Curve, DEFAULT_MERGE_OVERLAP, Facets, Triangulation, find};
use voidwalk::gradation::{Gradation, SizeSampler};
use voidwalk::network::{CONDUCTANCE_EXPONENT, ExitRule, Flow, Network};
use voidwalk::packing::{Compression, Settings, draw, random_start};
use voidwalk::stream::{Key, LANES, Purpose};
use voidwalk::walk::{Engine, Isa, RunPlan, SizeClasses, State, Supply, Walk, threads};

const TURNS: usize = 7;

/// Voids of the paper's lattice.
const SHAPE: [u32; 3] = [40, 40, 60];

/// Voids of a lattice whose numbers the second cache holds.
const SMALL: [u32; 3] = [20, 20, 30];

/// Least time of one measurement of a limit.
const LONG_ENOUGH: Duration = Duration::from_millis(40);

/// A kernel to measure: its name, the instructions, and a function that returns time and items of one turn.
type Kernel<'a> = (String, &'static str, Box<dyn FnMut() -> (Duration, u64) + 'a>);

fn main() {
    threads(1, false).expect("a thread").install(all);
}

fn all() {
    let curve = find("shire2016-cu1.5-loose").and_then(|shipped| shipped.curve()).expect("it is shipped");
    let network = Network::cubic(SHAPE, &curve, 1.0, 1).expect("a lattice");
    let small = Network::cubic(SMALL, &curve, 1.0, 1).expect("a lattice");
    let mut kernels = walks([&network, &small], &curve);
    kernels.extend(others(&curve));
    let named: Vec<String> = std::env::args().skip(1).filter(|word| !word.starts_with('-')).collect();
    if named.is_empty() {
        limits();
    } else {
        kernels.retain(|(name, isa, _)| {
            named.iter().any(|word| word == name || *word == format!("{name} {isa}"))
        });
    }
    let mut times: Vec<Vec<f64>> = vec![Vec::new(); kernels.len()];
    for _ in 0..TURNS {
        for ((_, _, kernel), times) in kernels.iter_mut().zip(&mut times) {
            let (time, items) = kernel();
            times.push(time.as_nanos() as f64 / items as f64);
        }
    }
    for ((name, isa, _), times) in kernels.iter().zip(&times) {
        print("kernel", name, isa, times);
    }
}

/// Limits of the machine.
fn limits() {
    for (kib, name) in
        [(16, "first cache"), (512, "second cache"), (12 << 10, "third cache"), (1 << 20, "memory")]
    {
        limit("copy", name, &mut || copy(kib << 10));
    }
    limit("random read", "96,000 words", &mut || gather(96_000));
    limit("random read", "64 MiB", &mut || gather(16 << 20));
    for isa in isas() {
        limit("multiply or add", isa.name(), &mut || operations(isa, Operation::MultiplyOrAdd));
        limit("divide", isa.name(), &mut || operations(isa, Operation::Divide));
        limit("square root", isa.name(), &mut || operations(isa, Operation::Root));
    }
    limit("add in order", "any", &mut in_order);
    limit("random word", "portable", &mut words);
}

fn print(kind: &str, name: &str, isa: &str, ns: &[f64]) {
    let line = serde_json::json!({"kind": kind, "name": name, "of": isa, "ns": ns});
    println!("{line}");
}

fn isas() -> impl Iterator<Item = Isa> {
    Isa::ALL.into_iter().filter(|isa| isa.is_available())
}

/// Processor time of this thread, the only one: without the time of other processes, but with their effect on
/// caches.
fn spent() -> Duration {
    let time = clock_gettime(ClockId::ThreadCPUTime);
    Duration::new(time.tv_sec as u64, time.tv_nsec as u32)
}

/// Repeats a function that returns its number of items until it takes long enough, in every turn.
fn limit(name: &str, isa: &str, work: &mut dyn FnMut() -> Box<dyn FnMut() -> u64>) {
    let mut work = work();
    work();
    let mut turn = || {
        // Until when is looked up on the clock, which takes less time to read.
        let (clock, begun, mut items) = (Instant::now(), spent(), 0);
        while items == 0 || clock.elapsed() < LONG_ENOUGH {
            items += work();
        }
        (spent() - begun).as_nanos() as f64 / items as f64
    };
    let times: Vec<f64> = (0..TURNS).map(|_| turn()).collect();
    print("limit", name, isa, &times);
}

/// Bytes read and written by copying one half of this many bytes onto the other.
fn copy(bytes: usize) -> Box<dyn FnMut() -> u64> {
    let (from, mut to) = (vec![1.0f64; bytes / 16], vec![0.0f64; bytes / 16]);
    Box::new(move || {
        to.copy_from_slice(black_box(&from));
        black_box(&mut to);
        bytes as u64
    })
}

/// Reads of single words in random order, each independent of the others.
fn gather(words: usize) -> Box<dyn FnMut() -> u64> {
    let table: Vec<u32> = (0..words as u32).collect();
    let place = |i: u64| (i.wrapping_mul(0x9e37_79b9_7f4a_7c15) >> 20) % words as u64;
    let places: Vec<u32> = (0..1 << 16).map(|i| place(i) as u32).collect();
    Box::new(move || {
        let sum = black_box(&places).iter().fold(0u32, |sum, &at| sum.wrapping_add(table[at as usize]));
        black_box(sum);
        places.len() as u64
    })
}

/// Operations in double precision, each on its own, as the kernels have them.
#[derive(Clone, Copy)]
enum Operation {
    MultiplyOrAdd,
    Divide,
    Root,
}

fn operations(isa: Isa, operation: Operation) -> Box<dyn FnMut() -> u64> {
    Box::new(move || match isa {
        // SAFETY: the machine has the instructions, as whoever names them has seen.
        #[cfg(target_arch = "x86_64")]
        Isa::Avx512 => unsafe { many_avx512(operation) },
        // SAFETY: likewise.
        #[cfg(target_arch = "x86_64")]
        Isa::Avx2 => unsafe { many_avx2(operation) },
        _ => many::<16>(operation),
    })
}

#[inline(always)]
fn many<const SIDE_BY_SIDE: usize>(operation: Operation) -> u64 {
    const ROUNDS: u64 = 4096;
    let (mut a, by, more) = ([1.0f64; SIDE_BY_SIDE], black_box(0.999_999), black_box(1e-6));
    let rounds = 0..ROUNDS;
    let operations = match operation {
        Operation::MultiplyOrAdd => {
            rounds.for_each(|_| a.iter_mut().for_each(|a| *a = *a * by + more));
            2
        }
        Operation::Divide => {
            rounds.for_each(|_| a.iter_mut().for_each(|a| *a = by / *a));
            1
        }
        // The addend keeps the number from being its own root.
        Operation::Root => {
            rounds.for_each(|_| a.iter_mut().for_each(|a| *a = (*a + by).sqrt()));
            1
        }
    };
    black_box(a);
    operations * ROUNDS * SIDE_BY_SIDE as u64
}

#[cfg(target_arch = "x86_64")]
#[target_feature(enable = "avx2")]
fn many_avx2(operation: Operation) -> u64 {
    many::<48>(operation)
}

#[cfg(target_arch = "x86_64")]
#[target_feature(enable = "avx512f,avx512bw,avx512dq,avx512vl")]
fn many_avx512(operation: Operation) -> u64 {
    many::<128>(operation)
}

/// Additions that each wait for the one before, like sums in a fixed order.
fn in_order() -> Box<dyn FnMut() -> u64> {
    let numbers = vec![1e-6f64; 2048];
    Box::new(move || {
        black_box(black_box(&numbers).iter().sum::<f64>());
        numbers.len() as u64
    })
}

/// Random words of eight generators side by side, in portable code.
fn words() -> Box<dyn FnMut() -> u64> {
    let mut lanes = Key { seed: 1, purpose: Purpose::Step, run: 1, increment: 1, chunk: 0 }.lanes();
    Box::new(move || {
        (0..256).for_each(|_| {
            black_box(lanes.next_blocks::<2>());
        });
        256 * 2 * LANES as u64
    })
}

/// A base of this Cu whose D85 is so fine as `percent` of the constrictions; of 0, finer than half of each.
fn sampler(curve: &Curve, percent: f64, cu: f64) -> SizeSampler {
    let d85 =
        if percent > 0.0 { curve.dc(percent).expect("within the curve") } else { 0.5 * curve.smallest() };
    SizeSampler::new(&Gradation::linear_from_dx(85.0, d85, cu).expect("a base"), 1.0).expect("sizes")
}

/// A walk of `n` particles over `increments`, with increments `from + 1 ..= to` timed alone; items are
/// attempted moves one by one, or voids and increments.
struct Timed<'a> {
    network: &'a Network,
    sampler: SizeSampler,
    engine: Engine,
    n: u64,
    increments: u64,
    span: [u64; 2],
    by_void: bool,
}

impl Timed<'_> {
    fn supply(&self) -> Supply {
        let open = BitVec::repeat(false, self.network.constrictions());
        let plan = RunPlan::new(self.engine, self.network, &self.sampler, &open, self.n / self.increments);
        plan.supply(self.sampler.clone(), self.n, self.increments, 1, 1)
    }

    /// A fresh walk, up to the start of the timing.
    fn begun(&self, supply: &Supply, isa: Isa) -> State {
        let open = BitVec::repeat(false, self.network.constrictions());
        let classes = SizeClasses::logarithmic(self.sampler.smallest(), self.sampler.largest(), 2);
        let mut state = State::new(self.network, supply, classes, open, 1, 1);
        let mut walk = Walk::new(self.network, supply, &state).with_isa(isa);
        (0..self.span[0]).for_each(|_| walk.increment(&mut state).expect("a step"));
        state
    }

    fn go_on(&self, supply: &Supply, state: &mut State, isa: Isa) -> (Duration, u64) {
        let mut walk = Walk::new(self.network, supply, state).with_isa(isa);
        let (mut time, mut items) = (Duration::ZERO, 0);
        for _ in self.span[0]..self.span[1] {
            let t = state.increment + 1;
            items += match self.by_void {
                true => self.network.voids() as u64,
                false => state.tally.moving + supply.inserted(t) - supply.inserted(t - 1),
            };
            let begun = spent();
            walk.increment(state).expect("a step");
            time += spent() - begun;
        }
        black_box(&state);
        (time, items)
    }

    /// Work that is timed in a turn: one by one, of a fresh walk; by void, of one that continues from turn to
    /// turn.
    fn turn<'a>(self: Rc<Self>, isa: Isa) -> Box<dyn FnMut() -> (Duration, u64) + 'a>
    where
        Self: 'a,
    {
        let (supply, mut going) = (self.supply(), None);
        Box::new(move || match self.by_void {
            true => self.go_on(&supply, going.get_or_insert_with(|| self.begun(&supply, isa)), isa),
            false => self.go_on(&supply, &mut self.begun(&supply, isa), isa),
        })
    }
}

fn walks<'a>([network, small]: [&'a Network; 2], curve: &Curve) -> Vec<Kernel<'a>> {
    let on = |network, percent, cu, engine, n, increments, span, by_void| Timed {
        network,
        sampler: sampler(curve, percent, cu),
        engine,
        n,
        increments,
        span,
        by_void,
    };
    let turns = |percent, cu, engine, n, increments, span, by_void| {
        on(network, percent, cu, engine, n, increments, span, by_void)
    };
    let all = [
        ("insert and step", turns(5.0, 4.5, Engine::Particles, 1 << 20, 1, [0, 1], false)),
        ("step", turns(5.0, 4.5, Engine::Particles, 1 << 20, 1, [1, 60], false)),
        ("insert, step and block", turns(50.0, 4.5, Engine::Particles, 1 << 17, 1, [0, 1], false)),
        ("counts", turns(0.0, 1.2, Engine::Counts, 4_000_000_000, 4000, [200, 220], true)),
        ("expected", turns(0.0, 1.2, Engine::Expected, 4_000_000_000, 4000, [200, 220], true)),
        ("expected, small", on(small, 0.0, 1.2, Engine::Expected, 500_000_000, 4000, [200, 220], true)),
    ];
    let mut kernels: Vec<Kernel> = Vec::new();
    for (name, timed) in all {
        let timed = Rc::new(timed);
        kernels.extend(isas().map(|isa| -> Kernel { (name.into(), isa.name(), timed.clone().turn(isa)) }));
    }
    kernels
}

fn timed<T>(items: u64, work: impl FnOnce() -> T) -> (Duration, u64) {
    let begun = spent();
    black_box(work());
    (spent() - begun, items)
}

/// Lattice, flow, packing and triangulation: one set of instructions each.
fn others<'a>(curve: &'a Curve) -> Vec<Kernel<'a>> {
    let lattice = move || Network::cubic(SHAPE, curve, 1.0, 1).expect("a lattice");
    let constrictions = lattice().constrictions() as u64;
    let water = lattice().undirected_lattice(ExitRule::Flux, 0.0, CONDUCTANCE_EXPONENT).expect("with flow");
    let open: BitVec = BitVec::repeat(false, water.constrictions());
    let links = water.constrictions() as u64 / 2;
    let mut flow = Flow::new(&water);
    flow.solve(&water, &open).expect("a flow");
    print("count", "rounds", "flow, from nothing", &[flow.rounds() as f64]);
    let settings = Settings { grains: 1000, ..Settings::default() };
    let gradation = Gradation::linear_from_d0(1.0, 3.0).expect("a filter");
    let start = random_start(&draw(&gradation, settings.grains, 1), &settings).expect("a start");
    let compression =
        move || Compression::new(&start, &settings).expect("a compression").of_gradation(&gradation);
    let mut settled = compression();
    settled.run(|_| true).expect("it settles");
    let packed = settled.packing();
    let grains = packed.diameter.len() as u64;
    let triangulation = Triangulation::new(&packed).expect("a triangulation");
    let triangulated = packed.clone();
    vec![
        ("lattice".into(), "", Box::new(move || timed(constrictions, lattice))),
        (
            "flow, from nothing".into(),
            "",
            Box::new(move || timed(links, || Flow::new(&water).solve(&water, &open).expect("a flow"))),
        ),
        (
            "contacts of grains".into(),
            "",
            Box::new(move || {
                let mut again = compression();
                let (time, _) = timed(0, || again.run(|_| true));
                (time, again.steps() * grains)
            }),
        ),
        (
            "triangulation".into(),
            "",
            Box::new(move || timed(grains, || Triangulation::new(&triangulated).expect("a triangulation"))),
        ),
        (
            "constrictions".into(),
            "",
            Box::new(move || {
                timed(grains, || {
                    Constrictions::from_triangulation(&triangulation, DEFAULT_MERGE_OVERLAP, Facets::All)
                })
            }),
        ),
    ]
}
