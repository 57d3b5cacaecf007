//! How far each kernel is from what this machine could do: `cargo bench --bench roofline`, one thread.
//!
//! First the machine's limits: what it copies a second by size of what it copies, a random read, multiplications and additions a second.
//! Then the kernels, all of them in each of seven turns. Prints a line of JSON for each, with nanoseconds an item in every turn;
//! `scripts/peers/roofline.py` puts bytes and operations beside them.

use std::hint::black_box;
use std::rc::Rc;
use std::time::{Duration, Instant};

use bitvec::vec::BitVec;
use voidwalk::constrictions::{Constrictions, Curve, DEFAULT_MERGE_OVERLAP, Facets, Triangulation, find};
use voidwalk::gradation::{Gradation, SizeSampler};
use voidwalk::network::{CONDUCTANCE_EXPONENT, ExitRule, Flow, Network};
use voidwalk::packing::{Compression, Settings, draw, random_start};
use voidwalk::walk::{Engine, Isa, RunPlan, SizeClasses, State, Supply, Walk, threads};

const TURNS: usize = 7;

/// Voids of the paper's lattice.
const SHAPE: [u32; 3] = [40, 40, 60];

/// Least time of one measurement of a limit.
const LONG_ENOUGH: Duration = Duration::from_millis(40);

/// A kernel that is measured: its name, the instructions, and what gives time and items of one turn.
type Kernel<'a> = (String, &'static str, Box<dyn FnMut() -> (Duration, u64) + 'a>);

fn main() {
    threads(1, false).expect("a thread").install(all);
}

fn all() {
    for (kib, name) in
        [(16, "first cache"), (512, "second cache"), (12 << 10, "third cache"), (1 << 20, "memory")]
    {
        limit("copy", name, &mut || copy(kib << 10));
    }
    limit("random read", "96,000 words", &mut || gather(96_000));
    limit("random read", "64 MiB", &mut || gather(16 << 20));
    for isa in isas() {
        limit("multiply or add", isa.name(), &mut || multiply_add(isa));
    }
    let curve = find("shire2016-cu1.5-loose").and_then(|shipped| shipped.curve()).expect("it is shipped");
    let network = Network::cubic(SHAPE, &curve, 1.0, 1).expect("a lattice");
    let mut kernels = walks(&network, &curve);
    kernels.extend(others(&curve));
    let mut found: Vec<Vec<f64>> = vec![Vec::new(); kernels.len()];
    for _ in 0..TURNS {
        for ((_, _, kernel), found) in kernels.iter_mut().zip(&mut found) {
            let (time, items) = kernel();
            found.push(time.as_nanos() as f64 / items as f64);
        }
    }
    for ((name, isa, _), found) in kernels.iter().zip(&found) {
        print("kernel", name, isa, found);
    }
}

fn print(kind: &str, name: &str, of: &str, ns: &[f64]) {
    let line = serde_json::json!({"kind": kind, "name": name, "of": of, "ns": ns});
    println!("{line}");
}

fn isas() -> impl Iterator<Item = Isa> {
    Isa::ALL.into_iter().filter(|isa| isa.is_available())
}

/// Repeats what gives its items until that takes long enough, in every turn.
fn limit(name: &str, of: &str, work: &mut dyn FnMut() -> Box<dyn FnMut() -> u64>) {
    let mut work = work();
    work();
    let mut turn = || {
        let (begun, mut items) = (Instant::now(), 0);
        while begun.elapsed() < LONG_ENOUGH {
            items += work();
        }
        begun.elapsed().as_nanos() as f64 / items as f64
    };
    let found: Vec<f64> = (0..TURNS).map(|_| turn()).collect();
    print("limit", name, of, &found);
}

/// Bytes read and written by copying one half of so many bytes onto the other.
fn copy(bytes: usize) -> Box<dyn FnMut() -> u64> {
    let (from, mut to) = (vec![1.0f64; bytes / 16], vec![0.0f64; bytes / 16]);
    Box::new(move || {
        to.copy_from_slice(black_box(&from));
        black_box(&mut to);
        bytes as u64
    })
}

/// Reads of single words in no order, none of which waits for another.
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

/// Multiplications and additions in double precision, each on its own, as the kernels have them.
fn multiply_add(isa: Isa) -> Box<dyn FnMut() -> u64> {
    Box::new(move || match isa {
        // SAFETY: the machine has the instructions, as whoever names them has seen.
        #[cfg(target_arch = "x86_64")]
        Isa::Avx512 => unsafe { sums_avx512() },
        // SAFETY: likewise.
        #[cfg(target_arch = "x86_64")]
        Isa::Avx2 => unsafe { sums_avx2() },
        _ => sums::<16>(),
    })
}

#[inline(always)]
fn sums<const SIDE_BY_SIDE: usize>() -> u64 {
    const ROUNDS: u64 = 4096;
    let (mut a, by, more) = ([1.0f64; SIDE_BY_SIDE], black_box(0.999_999), black_box(1e-6));
    for _ in 0..ROUNDS {
        a.iter_mut().for_each(|a| *a = *a * by + more);
    }
    black_box(a);
    2 * ROUNDS * SIDE_BY_SIDE as u64
}

#[cfg(target_arch = "x86_64")]
#[target_feature(enable = "avx2")]
fn sums_avx2() -> u64 {
    sums::<48>()
}

#[cfg(target_arch = "x86_64")]
#[target_feature(enable = "avx512f,avx512bw,avx512dq,avx512vl")]
fn sums_avx512() -> u64 {
    sums::<128>()
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

    /// A fresh walk, up to where the time is taken.
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
        let (mut spent, mut items) = (Duration::ZERO, 0);
        for _ in self.span[0]..self.span[1] {
            let t = state.increment + 1;
            items += match self.by_void {
                true => self.network.voids() as u64,
                false => state.tally.moving + supply.inserted(t) - supply.inserted(t - 1),
            };
            let begun = Instant::now();
            walk.increment(state).expect("a step");
            spent += begun.elapsed();
        }
        black_box(&state);
        (spent, items)
    }

    /// What times a turn: one by one of a fresh walk; by void of one that goes on as it does, turn by turn.
    fn turn<'a>(self: Rc<Self>, isa: Isa) -> Box<dyn FnMut() -> (Duration, u64) + 'a>
    where
        Self: 'a,
    {
        let supply = self.supply();
        let mut going = self.by_void.then(|| self.begun(&supply, isa));
        Box::new(move || match &mut going {
            Some(state) => self.go_on(&supply, state, isa),
            None => self.go_on(&supply, &mut self.begun(&supply, isa), isa),
        })
    }
}

fn walks<'a>(network: &'a Network, curve: &Curve) -> Vec<Kernel<'a>> {
    let of = |percent, cu, engine, n, increments, span, by_void| Timed {
        network,
        sampler: sampler(curve, percent, cu),
        engine,
        n,
        increments,
        span,
        by_void,
    };
    let all = [
        ("insert and step", of(5.0, 4.5, Engine::Particles, 1 << 20, 1, [0, 1], false)),
        ("step", of(5.0, 4.5, Engine::Particles, 1 << 20, 1, [1, 60], false)),
        ("insert, step and block", of(50.0, 4.5, Engine::Particles, 1 << 17, 1, [0, 1], false)),
        ("counts", of(0.0, 1.2, Engine::Counts, 4_000_000_000, 4000, [200, 220], true)),
        ("expected", of(0.0, 1.2, Engine::Expected, 4_000_000_000, 4000, [200, 220], true)),
    ];
    let mut kernels: Vec<Kernel> = Vec::new();
    for (name, timed) in all {
        let timed = Rc::new(timed);
        kernels.extend(isas().map(|isa| -> Kernel { (name.into(), isa.name(), timed.clone().turn(isa)) }));
    }
    kernels
}

fn timed<T>(items: u64, work: impl FnOnce() -> T) -> (Duration, u64) {
    let begun = Instant::now();
    black_box(work());
    (begun.elapsed(), items)
}

/// Lattice, flow, packing and triangulation: one set of instructions each.
fn others<'a>(curve: &'a Curve) -> Vec<Kernel<'a>> {
    let lattice = move || Network::cubic(SHAPE, curve, 1.0, 1).expect("a lattice");
    let constrictions = lattice().constrictions() as u64;
    let water = lattice().undirected_lattice(ExitRule::Flux, 0.0, CONDUCTANCE_EXPONENT).expect("with flow");
    let open: BitVec = BitVec::repeat(false, water.constrictions());
    let links = water.constrictions() as u64 / 2;
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
