//! The step of the expectation on the cubic lattice: layer by layer, each void from the three that lead
//! there, so that whole rows are moved at once.

use super::numbers::{Expected, NOTHING, retain};
use crate::walk::Isa;
use crate::walk::counts::binomial::as_unit;
use crate::walk::counts::shares::Shares;

/// Columns in which moves are summed: part of the definition of their sum, whatever the instructions.
const LANES: usize = 8;

/// The shares of the lattice's exits, and room for a layer.
pub(super) struct LatticeFlow {
    /// Voids along x and y.
    across: [usize; 2],
    /// By void: the share that takes the first exit, and of the others the share that takes the second.
    shares: [Vec<f64>; 2],
    /// Voids without an open exit, ascending.
    dead_ends: Vec<u32>,
    /// By void of a row: what leaves it along x, along y, and along y from the row before.
    rows: [Vec<f64>; 3],
    /// By void of a layer: what leaves the layer above it along z; of a row that is done, what leaves it.
    above: Vec<f64>,
    /// Instructions that it uses.
    pub isa: Isa,
}

impl LatticeFlow {
    pub fn new(shape: [u32; 3], shares: &Shares) -> Self {
        let across = [shape[0] as usize, shape[1] as usize];
        let row = || vec![0.0; across[0]];
        let voids = shares.probability().len() / 3;
        let of = |exit: usize| shares.probability()[exit..].iter().step_by(3).map(|&p| as_unit(p)).collect();
        Self {
            across,
            shares: [of(0), of(1)],
            dead_ends: (0..voids).filter(|&void| !shares.leads_on(void)).map(|void| void as u32).collect(),
            rows: [row(), row(), row()],
            above: vec![0.0; across[0] * across[1]],
            isa: Isa::chosen(),
        }
    }

    /// The shares of one void are others now.
    pub fn set(&mut self, shares: &Shares, void: u32) {
        if !shares.leads_on(void as usize)
            && let Err(place) = self.dead_ends.binary_search(&void)
        {
            self.dead_ends.insert(place, void);
        }
        for (exit, of_exit) in self.shares.iter_mut().enumerate() {
            of_exit[void as usize] = as_unit(shares.probability()[3 * void as usize + exit]);
        }
    }

    /// Moves what is expected in each void into `next`, whatever that held.
    pub fn step(&mut self, expected: &mut Expected, (next, holding): (&mut [f64], &mut Vec<u32>)) {
        let Expected { moving, retained, sums, .. } = expected;
        for void in self.dead_ends.iter().map(|&void| void as usize) {
            let n = std::mem::take(&mut moving[void]);
            if n >= NOTHING {
                retain(void, n, retained, holding);
            }
        }
        assert!(self.isa.is_available());
        sums.moves += match self.isa {
            // SAFETY: the machine has the instructions.
            #[cfg(target_arch = "x86_64")]
            Isa::Avx512 => unsafe { with_avx512(self, moving, next) },
            // SAFETY: the machine has the instructions.
            #[cfg(target_arch = "x86_64")]
            Isa::Avx2 => unsafe { with_avx2(self, moving, next) },
            _ => self.layers(moving, next),
        };
        self.above.iter().for_each(|n| sums.eroded += n);
    }

    /// Moves layer by layer, and row by row; what leaves the last layer is in `above` then. Returns how many
    /// moved.
    #[inline(always)]
    fn layers(&mut self, moving: &[f64], next: &mut [f64]) -> f64 {
        let [nx, ny] = self.across;
        let Self { shares: [first, second], rows: [x, y, y_before], above, .. } = self;
        let plane = nx * ny;
        let mut lanes = [0.0; LANES];
        above.fill(0.0);
        let mut nothing_above = true;
        let shares = first.chunks_exact(plane).zip(second.chunks_exact(plane));
        let layers = moving.chunks_exact(plane).zip(next.chunks_exact_mut(plane)).zip(shares);
        for ((here, next), (first, second)) in layers {
            let nothing_here = here.iter().all(|&n| n == 0.0);
            if nothing_here && nothing_above {
                next.fill(0.0);
                continue;
            }
            nothing_above = nothing_here;
            let last = plane - nx..plane;
            leave(&here[last.clone()], [&first[last.clone()], &second[last]], [x, y_before]);
            for row in 0..ny {
                let voids = row * nx..(row + 1) * nx;
                let here = &here[voids.clone()];
                lanes = summed(here, lanes);
                leave(here, [&first[voids.clone()], &second[voids.clone()]], [x, y]);
                let (next, above) = (&mut next[voids.clone()], &mut above[voids]);
                arrive(next, above, (x, y_before), row == 0);
                for (((above, &n), x), y) in above.iter_mut().zip(here).zip(x.iter()).zip(y.iter()) {
                    *above = some(n) - x - y;
                }
                std::mem::swap(y, y_before);
            }
        }
        lanes.iter().sum()
    }
}

#[cfg(target_arch = "x86_64")]
#[target_feature(enable = "avx512f,avx512bw,avx512dq,avx512vl,popcnt")]
fn with_avx512(flow: &mut LatticeFlow, moving: &[f64], next: &mut [f64]) -> f64 {
    flow.layers(moving, next)
}

#[cfg(target_arch = "x86_64")]
#[target_feature(enable = "avx2,popcnt")]
fn with_avx2(flow: &mut LatticeFlow, moving: &[f64], next: &mut [f64]) -> f64 {
    flow.layers(moving, next)
}

/// What is expected in a void, where that is anything.
#[inline(always)]
fn some(n: f64) -> f64 {
    if n < NOTHING { 0.0 } else { n }
}

/// Adds a row to sums in columns.
#[inline(always)]
fn summed(row: &[f64], mut lanes: [f64; LANES]) -> [f64; LANES] {
    let (whole, rest) = row.as_chunks::<LANES>();
    for some in whole {
        lanes = std::array::from_fn(|lane| lanes[lane] + some[lane]);
    }
    rest.iter().zip(&mut lanes).for_each(|(n, lane)| *lane += n);
    lanes
}

/// What leaves a row's voids along x and y. The last open exit is certain: along z goes what is left.
#[inline(always)]
fn leave(here: &[f64], [first, second]: [&[f64]; 2], [x, y]: [&mut [f64]; 2]) {
    let shares = first.iter().zip(second);
    for ((&n, (first, second)), (x, y)) in here.iter().zip(shares).zip(x.iter_mut().zip(y)) {
        let n = some(n);
        *x = n * first;
        *y = (n - *x) * second;
    }
}

/// Adds up what arrives in a row: from above, from the row before, and from the void before, the last void of
/// the row before the first. In the order of the voids that it comes from, as on any network,
/// but for a single row.
#[inline(always)]
fn arrive(row: &mut [f64], above: &[f64], (x, y): (&[f64], &[f64]), is_first: bool) {
    let sum = |above: f64, x: f64, y: f64| if is_first { above + x + y } else { above + y + x };
    let last = row.len() - 1;
    row[0] = sum(above[0], x[last], y[0]);
    let behind = x[..last].iter().zip(&y[1..]);
    for ((to, above), (x, y)) in row[1..].iter_mut().zip(&above[1..]).zip(behind) {
        *to = sum(*above, *x, *y);
    }
}
