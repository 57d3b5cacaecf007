//! The step of the expectation on the cubic lattice: layer by layer, each void from the three that lead
//! there, so that many rows are moved at once.

use super::numbers::{Expected, NOTHING, retain};
use crate::walk::Isa;
use crate::walk::counts::binomial::as_unit;
use crate::walk::counts::shares::Shares;

/// Voids that are moved at once, in whole rows: what leaves them stays in the first cache, and short rows
/// make long loops.
const AT_ONCE: usize = 1024;

/// The shares of the lattice's exits, and room for a layer.
pub(super) struct LatticeFlow {
    /// Voids along x and y.
    across: [usize; 2],
    /// By void: the share that takes the first exit, and of the others the share that takes the second.
    shares: [Vec<f64>; 2],
    /// Voids without an open exit, ascending.
    dead_ends: Vec<u32>,
    /// By void of the rows that are moved at once: what arrives in it along x, and along y. Behind them a
    /// place for what leaves the last void along x, and a row for what leaves the last row along y.
    arriving: [Vec<f64>; 2],
    /// By void of a layer: what leaves the layer above it along z, and what leaves it.
    along_z: [Vec<f64>; 2],
    /// Instructions that it uses.
    pub isa: Isa,
}

impl LatticeFlow {
    pub fn new(shape: [u32; 3], shares: &Shares) -> Self {
        let across = [shape[0] as usize, shape[1] as usize];
        let rows = rows_at_once(across) * across[0];
        let layer = || vec![0.0; across[0] * across[1]];
        let (of_void, _) = shares.probability().as_chunks::<3>();
        let voids = of_void.len();
        let of = |exit: usize| of_void.iter().map(|of_void| as_unit(of_void[exit])).collect();
        Self {
            across,
            shares: [of(0), of(1)],
            dead_ends: (0..voids).filter(|&void| !shares.leads_on(void)).map(|void| void as u32).collect(),
            arriving: [vec![0.0; rows + 1], vec![0.0; rows + across[0]]],
            along_z: [layer(), layer()],
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
        match self.isa {
            // SAFETY: the machine has the instructions.
            #[cfg(target_arch = "x86_64")]
            Isa::Avx512 => unsafe { with_avx512(self, moving, next) },
            // SAFETY: the machine has the instructions.
            #[cfg(target_arch = "x86_64")]
            Isa::Avx2 => unsafe { with_avx2(self, moving, next) },
            _ => self.layers(moving, next),
        };
        self.along_z[0].iter().for_each(|n| sums.eroded += n);
    }

    /// Moves layer by layer, and some rows at once; what leaves the last layer is first in `along_z` then.
    #[inline(always)]
    fn layers(&mut self, moving: &[f64], next: &mut [f64]) {
        let [nx, ny] = self.across;
        let at_once = rows_at_once(self.across) * nx;
        let Self { shares: [first, second], arriving: [x, y], along_z: [above, below], .. } = self;
        let plane = nx * ny;
        above.fill(0.0);
        let mut nothing_above = true;
        let shares = first.chunks_exact(plane).zip(second.chunks_exact(plane));
        let layers = moving.chunks_exact(plane).zip(next.chunks_exact_mut(plane)).zip(shares);
        for ((here, next), (first, second)) in layers {
            let nothing_here = here.chunks(64).all(is_nothing);
            if nothing_here && nothing_above {
                next.fill(0.0);
                continue;
            }
            nothing_above = nothing_here;
            // The last row leads to the first.
            let last = plane - nx..plane;
            let leaving = (&mut x[1..][..nx], &mut y[..nx], &mut below[last.clone()]);
            leave(&here[last.clone()], [&first[last.clone()], &second[last]], leaving);
            for begin in (0..plane).step_by(at_once) {
                let voids = begin..plane.min(begin + at_once);
                let n = voids.len();
                let leaving = (&mut x[1..][..n], &mut y[nx..][..n], &mut below[voids.clone()]);
                leave(&here[voids.clone()], [&first[voids.clone()], &second[voids.clone()]], leaving);
                // The last void of each row leads to its first.
                for row in (0..n).step_by(nx) {
                    x[row] = x[row + nx];
                }
                let (next, above) = (&mut next[voids.clone()], &above[voids]);
                let by_y = if begin == 0 { nx } else { 0 };
                arrive(&mut next[..by_y], &above[..by_y], [&x[..by_y], &y[..by_y]]);
                arrive(&mut next[by_y..], &above[by_y..], [&y[by_y..n], &x[by_y..n]]);
                y.copy_within(n..n + nx, 0);
            }
            std::mem::swap(above, below);
        }
    }
}

/// Rows of a layer that are moved at once.
fn rows_at_once([nx, ny]: [usize; 2]) -> usize {
    (AT_ONCE / nx).clamp(1, ny)
}

#[cfg(target_arch = "x86_64")]
#[target_feature(enable = "avx512f,avx512bw,avx512dq,avx512vl,popcnt")]
fn with_avx512(flow: &mut LatticeFlow, moving: &[f64], next: &mut [f64]) {
    flow.layers(moving, next);
}

#[cfg(target_arch = "x86_64")]
#[target_feature(enable = "avx2,popcnt")]
fn with_avx2(flow: &mut LatticeFlow, moving: &[f64], next: &mut [f64]) {
    flow.layers(moving, next);
}

/// What is expected in a void, where that is anything.
#[inline(always)]
fn some(n: f64) -> f64 {
    if n < NOTHING { 0.0 } else { n }
}

/// Whether nothing is expected in any of these voids, without a branch for each.
#[inline(always)]
fn is_nothing(voids: &[f64]) -> bool {
    voids.iter().fold(0, |bits, n| bits | n.to_bits()) == 0
}

/// What leaves voids along x, along y and along z. The last open exit is certain: along z goes what is left.
#[inline(always)]
fn leave(here: &[f64], [first, second]: [&[f64]; 2], (x, y, z): (&mut [f64], &mut [f64], &mut [f64])) {
    let shares = first.iter().zip(second);
    let leaving = x.iter_mut().zip(y).zip(z);
    for ((&n, (first, second)), ((x, y), z)) in here.iter().zip(shares).zip(leaving) {
        let n = some(n);
        let along_x = n * first;
        let along_y = (n - along_x) * second;
        (*x, *y, *z) = (along_x, along_y, n - along_x - along_y);
    }
}

/// Adds up what arrives in voids: from above, and then along x and y in the order of the voids that it comes
/// from, as on any network, but for a single row.
#[inline(always)]
fn arrive(voids: &mut [f64], above: &[f64], [first, second]: [&[f64]; 2]) {
    for ((to, above), (first, second)) in voids.iter_mut().zip(above).zip(first.iter().zip(second)) {
        *to = above + first + second;
    }
}
