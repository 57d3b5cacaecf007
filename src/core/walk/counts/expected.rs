//! Expectation of the passive particles given the history of blocking: one f64 per void, no random draws.
//!
//! Sums run on one thread in an order fixed by the network, so they are the same everywhere. Integers for
//! the tally are rounded from running sums, so that they add up.

use super::binomial::as_unit;
use super::passive::{Expected, NOTHING, retain};
use super::shares::Shares;
use crate::network::Network;
use crate::walk::Isa;

/// Data for moving expectations; rebuilt from network and expectation, never stored.
pub(super) struct ExpectedFlow {
    by_network: ByNetwork,
    /// Voids that retain particles, in ascending order.
    pub(crate) holding: Vec<u32>,
    pub(crate) rests: f64,
}

enum ByNetwork {
    General(GeneralFlow),
    Lattice(LatticeFlow),
}

impl ExpectedFlow {
    pub(crate) fn new(network: &Network, shares: &Shares, expected: &Expected) -> Self {
        let holding = expected.retained.iter().enumerate().filter(|(_, n)| **n > 0.0);
        let holding: Vec<u32> = holding.map(|(void, _)| void as u32).collect();
        Self {
            by_network: match network.shape().filter(|_| !network.exit_rule().needs_flow()) {
                Some(shape) => ByNetwork::Lattice(LatticeFlow::new(shape, shares)),
                None => ByNetwork::General(GeneralFlow::new(shares, expected.moving.len())),
            },
            rests: resting(&holding, expected),
            holding,
        }
    }

    pub(crate) fn set_isa(&mut self, isa: Isa) {
        if let ByNetwork::Lattice(flow) = &mut self.by_network {
            flow.isa = isa;
        }
    }

    pub(crate) fn set(&mut self, network: &Network, shares: &Shares, void: u32) {
        match &mut self.by_network {
            ByNetwork::General(flow) => flow.set(network, shares, void),
            ByNetwork::Lattice(flow) => flow.set(shares, void),
        }
    }

    pub(crate) fn step(&mut self, network: &Network, shares: &Shares, expected: &mut Expected) {
        let (known, eroded) = (self.holding.len(), expected.sums.eroded);
        match &mut self.by_network {
            ByNetwork::General(flow) => flow.step(network, shares, expected, &mut self.holding),
            ByNetwork::Lattice(flow) => flow.step(expected, &mut self.holding),
        }
        if self.holding.len() > known {
            // Two ascending sequences: the voids known before, and the new ones.
            self.holding.sort();
        }
        self.rests = resting(&self.holding, expected);
        if matches!(self.by_network, ByNetwork::Lattice(_)) {
            // All particles inserted that had been neither eroded nor retained.
            expected.sums.moves += (expected.sums.inserted as f64 - eroded - self.rests).max(0.0);
        }
    }
}

fn resting(holding: &[u32], expected: &Expected) -> f64 {
    holding.iter().map(|&void| expected.retained[void as usize]).sum()
}

/// Step on any network: each void in turn sends particles to its downstream voids.
struct GeneralFlow {
    /// Fraction, by constriction, of the particles that take it, of those that have not taken an earlier
    /// exit of the void.
    shares: Vec<f64>,
    /// Expected number in each void after the step; 0 between steps.
    pub(crate) next: Vec<f64>,
}

impl GeneralFlow {
    pub(crate) fn new(shares: &Shares, voids: usize) -> Self {
        let shares = shares.probability().iter().map(|&p| as_unit(p)).collect();
        Self { shares, next: vec![0.0; voids] }
    }

    pub(crate) fn set(&mut self, network: &Network, shares: &Shares, void: u32) {
        let exits = network.exits(void);
        let news = &shares.probability()[exits.clone()];
        self.shares[exits].iter_mut().zip(news).for_each(|(old, &p)| *old = as_unit(p));
    }

    pub(crate) fn step(
        &mut self,
        network: &Network,
        shares: &Shares,
        expected: &mut Expected,
        holding: &mut Vec<u32>,
    ) {
        let next = &mut self.next;
        let Expected { moving, retained, sums, .. } = expected;
        let targets = network.targets();
        let (mut moves, mut eroded) = (sums.moves, sums.eroded);
        for (void, n) in moving.iter_mut().enumerate() {
            // Most voids of a thick filter are empty: nothing is written for them.
            if *n == 0.0 {
                continue;
            }
            let mut n = std::mem::take(n);
            if n < NOTHING {
                continue;
            }
            if !shares.leads_on(void) {
                match shares.waits(void) {
                    true => next[void] += n,
                    false => retain(void, n, retained, holding),
                }
                continue;
            }
            moves += n;
            let exits = network.exits(void as u32);
            // After an exit that takes all, nothing is left for later exits.
            for (share, &target) in self.shares[exits.clone()].iter().zip(&targets[exits]) {
                let taken = n * share;
                n -= taken;
                // END is larger than any void.
                match next.get_mut(target as usize) {
                    Some(there) => *there += taken,
                    None => eroded += taken,
                }
            }
        }
        (sums.moves, sums.eroded) = (moves, eroded);
        std::mem::swap(moving, next);
    }
}

/// Step on the cubic lattice, in place, by layers and rows: each void receives from the three voids that
/// lead to it. A row needs its own outflow along x and only two buffers, which stay in the first-level
/// cache: the outflow of the previous row along y and of the layer above along z.
struct LatticeFlow {
    across: [usize; 2],
    /// Fraction of each void that takes the first exit, and fraction of the rest that takes the second.
    shares: [Vec<f64>; 2],
    dead_ends: Vec<u32>,
    /// Outflow of the previous row along y, by void of a row.
    along_y: Vec<f64>,
    /// Outflow along z of the layer above, later of the layer itself, by void of a layer.
    along_z: Vec<f64>,
    pub(crate) isa: Isa,
}

impl LatticeFlow {
    pub(crate) fn new(shape: [u32; 3], shares: &Shares) -> Self {
        let across = [shape[0] as usize, shape[1] as usize];
        let (of_void, _) = shares.probability().as_chunks::<3>();
        let voids = of_void.len();
        let share = |exit: usize| of_void.iter().map(|of_void| as_unit(of_void[exit])).collect();
        Self {
            across,
            shares: [share(0), share(1)],
            dead_ends: (0..voids).filter(|&void| !shares.leads_on(void)).map(|void| void as u32).collect(),
            along_y: vec![0.0; across[0]],
            along_z: vec![0.0; across[0] * across[1]],
            isa: Isa::chosen(),
        }
    }

    pub(crate) fn set(&mut self, shares: &Shares, void: u32) {
        if !shares.leads_on(void as usize)
            && let Err(place) = self.dead_ends.binary_search(&void)
        {
            self.dead_ends.insert(place, void);
        }
        for (exit, of_exit) in self.shares.iter_mut().enumerate() {
            of_exit[void as usize] = as_unit(shares.probability()[3 * void as usize + exit]);
        }
    }

    pub(crate) fn step(&mut self, expected: &mut Expected, holding: &mut Vec<u32>) {
        let Expected { moving, retained, sums, .. } = expected;
        for void in self.dead_ends.iter().map(|&void| void as usize) {
            let n = std::mem::take(&mut moving[void]);
            if n >= NOTHING {
                retain(void, n, retained, holding);
            }
        }
        assert!(self.isa.is_available());
        match self.isa {
            // SAFETY: the machine supports the instructions.
            #[cfg(target_arch = "x86_64")]
            Isa::Avx512 => unsafe { vector::with_avx512(self, moving) },
            // SAFETY: the machine supports the instructions.
            #[cfg(target_arch = "x86_64")]
            Isa::Avx2 => unsafe { vector::with_avx2(self, moving) },
            _ => self.layers(moving, |row| row.step()),
        };
        if !is_nothing(&self.along_z) {
            self.along_z.iter().for_each(|n| sums.eroded += n);
        }
    }

    /// Moves layer by layer; at the end `along_z` holds the outflow of the last layer.
    #[inline(always)]
    fn layers(&mut self, moving: &mut [f64], mut step: impl FnMut(Row)) {
        let [nx, ny] = self.across;
        let Self { shares: [first, second], along_y, along_z, .. } = self;
        let plane = nx * ny;
        along_z.fill(0.0);
        let mut nothing_above = true;
        let shares = first.chunks_exact(plane).zip(second.chunks_exact(plane));
        for (here, (first, second)) in moving.chunks_exact_mut(plane).zip(shares) {
            let nothing_here = is_nothing(here);
            if nothing_here && nothing_above {
                // Its outflow is 0, like the outflow of the layer above.
                continue;
            }
            nothing_above = nothing_here;
            // The last row leads to the first.
            let last = plane - nx..plane;
            let of_last = here[last.clone()].iter().zip(&first[last.clone()]).zip(&second[last]);
            for (y, ((&n, first), second)) in along_y.iter_mut().zip(of_last) {
                *y = leave(n, first, second)[1];
            }
            let shares = first.chunks_exact(nx).zip(second.chunks_exact(nx));
            let rows = here.chunks_exact_mut(nx).zip(shares).zip(along_z.chunks_exact_mut(nx));
            for (row, ((here, (first, second)), along_z)) in rows.enumerate() {
                step(Row { is_first: row == 0, here, first, second, along_y: &mut *along_y, along_z });
            }
        }
    }
}

/// Row of a layer; all slices have its length.
struct Row<'a> {
    /// True for the first row of a layer, whose previous row is the last, with later voids.
    is_first: bool,
    here: &'a mut [f64],
    first: &'a [f64],
    second: &'a [f64],
    /// Outflow along y of the previous row, later of the row itself.
    along_y: &'a mut [f64],
    /// Outflow along z of the layer above, later of the row itself.
    along_z: &'a mut [f64],
}

impl Row<'_> {
    /// Outflow along x of the last void, which leads to the first.
    #[inline(always)]
    fn round(&self) -> f64 {
        let last = self.here.len() - 1;
        leave(self.here[last], &self.first[last], &self.second[last])[0]
    }

    #[inline(always)]
    fn step(mut self) {
        let along_x = self.round();
        self.step_from(0, along_x);
    }

    /// Moves the expectation in the voids from `begin` on, with this outflow along x of the previous void.
    #[inline(always)]
    fn step_from(&mut self, begin: usize, mut along_x: f64) {
        let is_first = self.is_first;
        let shares = self.first[begin..].iter().zip(&self.second[begin..]);
        let buffers = self.along_y[begin..].iter_mut().zip(&mut self.along_z[begin..]);
        for ((here, (first, second)), (y, z)) in self.here[begin..].iter_mut().zip(shares).zip(buffers) {
            let [leaves_x, leaves_y, leaves_z] = leave(*here, first, second);
            *here = arrive(is_first, [*z, along_x, *y], |a, b| a + b);
            (along_x, *y, *z) = (leaves_x, leaves_y, leaves_z);
        }
    }
}

/// Outflow of a void along x, y and z. The last open exit is certain: the rest goes along z.
#[inline(always)]
fn leave(here: f64, first: &f64, second: &f64) -> [f64; 3] {
    // NaN counts as 0, as in the vector code.
    let n = if here >= NOTHING { here } else { 0.0 };
    let along_x = n * first;
    let along_y = (n - along_x) * second;
    [along_x, along_y, n - along_x - along_y]
}

/// Adds the arrivals in a void along z, x and y: from above, then in the order of their source voids, as
/// on any network except for a single row.
#[inline(always)]
fn arrive<T>(is_first: bool, [z, x, y]: [T; 3], add: impl Fn(T, T) -> T) -> T {
    if is_first { add(add(z, x), y) } else { add(add(z, y), x) }
}

/// Tells if nothing is expected in any of these voids; branch-free over many at a time.
#[inline(always)]
fn is_nothing(voids: &[f64]) -> bool {
    voids.chunks(64).all(|voids| voids.iter().fold(0, |bits, n| bits | n.to_bits()) == 0)
}

/// Vector code for rows. The outflow of a void along x reaches the next void by a shift in registers:
/// storing and reloading it one place further on would wait for the cache.
#[cfg(target_arch = "x86_64")]
mod vector {
    use std::arch::x86_64::*;

    use super::{LatticeFlow, NOTHING, Row, arrive};

    #[target_feature(enable = "avx512f,avx512bw,avx512dq,avx512vl,popcnt")]
    pub(super) fn with_avx512(flow: &mut LatticeFlow, moving: &mut [f64]) {
        flow.layers(moving, |row| match row.is_first {
            true => by_eight::<true>(row),
            false => by_eight::<false>(row),
        });
    }

    #[target_feature(enable = "avx2,popcnt")]
    pub(super) fn with_avx2(flow: &mut LatticeFlow, moving: &mut [f64]) {
        flow.layers(moving, |mut row| {
            let round = row.round();
            let (done, along_x) = match row.is_first {
                true => by_four::<true>(&mut row, 0, round),
                false => by_four::<false>(&mut row, 0, round),
            };
            row.step_from(done, along_x);
        });
    }

    /// Moves a row, eight voids at a time, then four, then one.
    #[target_feature(enable = "avx512f,avx512bw,avx512dq,avx512vl,popcnt")]
    #[inline]
    fn by_eight<const FIRST: bool>(mut row: Row) {
        const LANES: usize = 8;
        let along_x = row.round();
        let nothing = _mm512_set1_pd(NOTHING);
        let mut before = _mm512_set1_pd(along_x);
        let whole = row.here.len() / LANES * LANES;
        let Row { here, first, second, along_y, along_z, .. } = &mut row;
        let parts = here[..whole].as_chunks_mut::<LANES>().0.iter_mut();
        let shares = first[..whole].as_chunks::<LANES>().0.iter().zip(second[..whole].as_chunks::<LANES>().0);
        let buffers = along_y[..whole].as_chunks_mut::<LANES>().0.iter_mut();
        let buffers = buffers.zip(along_z[..whole].as_chunks_mut::<LANES>().0);
        for ((here, (first, second)), (y, z)) in parts.zip(shares).zip(buffers) {
            // SAFETY: each has eight numbers.
            unsafe {
                let n = _mm512_loadu_pd(here.as_ptr());
                let n = _mm512_maskz_mov_pd(_mm512_cmp_pd_mask::<_CMP_GE_OQ>(n, nothing), n);
                let x = _mm512_mul_pd(n, _mm512_loadu_pd(first.as_ptr()));
                let left = _mm512_sub_pd(n, x);
                let leaves_y = _mm512_mul_pd(left, _mm512_loadu_pd(second.as_ptr()));
                let shifted = _mm512_alignr_epi64::<7>(_mm512_castpd_si512(x), _mm512_castpd_si512(before));
                let from =
                    [_mm512_loadu_pd(z.as_ptr()), _mm512_castsi512_pd(shifted), _mm512_loadu_pd(y.as_ptr())];
                let sum = arrive(FIRST, from, |a, b| _mm512_add_pd(a, b));
                _mm512_storeu_pd(here.as_mut_ptr(), sum);
                _mm512_storeu_pd(y.as_mut_ptr(), leaves_y);
                _mm512_storeu_pd(z.as_mut_ptr(), _mm512_sub_pd(left, leaves_y));
                before = x;
            }
        }
        if whole < row.here.len() {
            let mut lanes = [0.0; LANES];
            // SAFETY: the array has eight numbers.
            unsafe { _mm512_storeu_pd(lanes.as_mut_ptr(), before) };
            let (done, along_x) = by_four::<FIRST>(&mut row, whole, lanes[LANES - 1]);
            row.step_from(done, along_x);
        }
    }

    /// Moves four voids of a row at a time, from one on, with this outflow along x of the previous void;
    /// returns the void reached and its predecessor's outflow along x.
    #[target_feature(enable = "avx2,popcnt")]
    #[inline]
    fn by_four<const FIRST: bool>(row: &mut Row, begin: usize, along_x: f64) -> (usize, f64) {
        const LANES: usize = 4;
        let nothing = _mm256_set1_pd(NOTHING);
        let mut before = _mm256_set1_pd(along_x);
        let Row { here, first, second, along_y, along_z, .. } = row;
        let whole = begin..begin + (here.len() - begin) / LANES * LANES;
        let parts = here[whole.clone()].as_chunks_mut::<LANES>().0.iter_mut();
        let shares = first[whole.clone()].as_chunks::<LANES>().0.iter();
        let shares = shares.zip(second[whole.clone()].as_chunks::<LANES>().0);
        let buffers = along_y[whole.clone()].as_chunks_mut::<LANES>().0.iter_mut();
        let buffers = buffers.zip(along_z[whole.clone()].as_chunks_mut::<LANES>().0);
        for ((here, (first, second)), (y, z)) in parts.zip(shares).zip(buffers) {
            // SAFETY: each has four numbers.
            unsafe {
                let n = _mm256_loadu_pd(here.as_ptr());
                let n = _mm256_and_pd(_mm256_cmp_pd::<_CMP_GE_OQ>(n, nothing), n);
                let x = _mm256_mul_pd(n, _mm256_loadu_pd(first.as_ptr()));
                let left = _mm256_sub_pd(n, x);
                let leaves_y = _mm256_mul_pd(left, _mm256_loadu_pd(second.as_ptr()));
                // Upper half of the previous vector and lower half of this one; then a shift by one place.
                let halves = _mm256_permute2f128_pd::<0x21>(before, x);
                let shifted = _mm256_shuffle_pd::<0b0101>(halves, x);
                let from = [_mm256_loadu_pd(z.as_ptr()), shifted, _mm256_loadu_pd(y.as_ptr())];
                let sum = arrive(FIRST, from, |a, b| _mm256_add_pd(a, b));
                _mm256_storeu_pd(here.as_mut_ptr(), sum);
                _mm256_storeu_pd(y.as_mut_ptr(), leaves_y);
                _mm256_storeu_pd(z.as_mut_ptr(), _mm256_sub_pd(left, leaves_y));
                before = x;
            }
        }
        let mut lanes = [0.0; LANES];
        // SAFETY: the array has four numbers.
        unsafe { _mm256_storeu_pd(lanes.as_mut_ptr(), before) };
        (whole.end, lanes[LANES - 1])
    }
}

#[cfg(test)]
mod tests {
    use bitvec::vec::BitVec;

    use super::*;
    use crate::walk::exits;
    use crate::walk::openings::Ways;

    fn lattice(shape: [u32; 3]) -> Network {
        let count = Network::lattice_constrictions(shape).unwrap();
        let diameter = (0..count).map(|c| 0.3 + ((c * 7919) % 1009) as f32 / 1009.0).collect();
        Network::cubic_from_diameters(shape, diameter, 1.0).unwrap()
    }

    /// Walks by one of the two steps while more and more constrictions close; returns the expectation
    /// after every increment and the voids that retain particles.
    fn walked(network: &Network, is_general: bool, isa: Isa) -> Vec<(Expected, Vec<u32>)> {
        let mut blocked: BitVec = BitVec::repeat(false, network.constrictions());
        let mut shares = Shares::new(network, Ways::Unblocked(&blocked));
        let mut expected = Expected::new(network.voids());
        let mut flow = ExpectedFlow::new(network, &shares, &expected);
        assert!(matches!(flow.by_network, ByNetwork::Lattice(_)));
        if is_general {
            flow.by_network = ByNetwork::General(GeneralFlow::new(&shares, network.voids()));
        }
        flow.set_isa(isa);
        let mut all = Vec::new();
        for increment in 0..40 {
            if increment < 20 {
                expected.insert(network, 1000 + increment);
            }
            flow.step(network, &shares, &mut expected);
            if let ByNetwork::General(flow) = &flow.by_network {
                // The step adds to these numbers.
                assert!(flow.next.iter().all(|&n| n == 0.0));
            }
            all.push((expected.clone(), flow.holding.clone()));
            for c in (increment as usize..network.constrictions()).step_by(29) {
                blocked.set(c, true);
                let void = (c / 3) as u32;
                exits::of_each(network, Ways::Unblocked(&blocked), [void], |exits| {
                    shares.set(network, exits)
                });
                flow.set(network, &shares, void);
            }
        }
        all
    }

    /// Rows and single voids give the same bits with any instruction set, for whole vectors and remainders of
    /// eight and four; sums over all voids agree to rounding. A lattice with a single row along y may add
    /// three numbers in a different order.
    #[test]
    fn both_steps_move_the_same() {
        let shapes = [
            [[5, 4, 6], [8, 3, 5], [17, 2, 4], [29, 3, 4], [9, 10, 3], [1, 5, 4], [2, 2, 1], [13, 7, 6]],
            [[16, 2, 3], [7, 3, 2], [3, 3, 1], [6, 1, 4], [1, 1, 5], [4, 1, 4], [12, 1, 3], [31, 1, 4]],
        ];
        for (at, shape) in shapes.concat().into_iter().enumerate() {
            let network = lattice(shape);
            let one_by_one = walked(&network, true, Isa::Portable);
            let portable = walked(&network, false, Isa::Portable);
            for isa in Isa::ALL.into_iter().filter(|isa| isa.is_available()) {
                assert_eq!(walked(&network, false, isa), portable, "{shape:?} {isa:?}");
            }
            for ((a, held_a), (b, held_b)) in one_by_one.iter().zip(&portable) {
                if shape[1] == 1 {
                    let pairs = a.moving.iter().zip(&b.moving);
                    pairs.for_each(|(a, b)| assert!((a - b).abs() <= 1e-12 * a, "{shape:?}: {a} {b}"));
                    continue;
                }
                assert_eq!((&a.moving, &a.retained, held_a), (&b.moving, &b.retained, held_b), "{shape:?}");
                assert_eq!(a.sums.eroded.to_bits(), b.sums.eroded.to_bits());
                assert!((a.sums.moves / b.sums.moves - 1.0).abs() < 1e-14);
            }
            let (last, held) = one_by_one.last().unwrap();
            // The other lattices are small.
            assert!(at > 6 || held.len() > 1 || shape[2] == 1, "{shape:?}: nothing came to rest");
            let left = last.moving.iter().chain(&last.retained).sum::<f64>() + last.sums.eroded;
            assert!((left / last.sums.inserted as f64 - 1.0).abs() < 1e-12);
        }
    }

    /// Expectations are never NaN; if one were, all instruction sets would treat it alike.
    #[test]
    fn what_is_no_number_leaves_no_void_on_any_instruction_set() {
        let network = lattice([13, 2, 3]);
        let blocked: BitVec = BitVec::repeat(false, network.constrictions());
        let shares = Shares::new(&network, Ways::Unblocked(&blocked));
        for isa in Isa::ALL.into_iter().filter(|isa| isa.is_available()) {
            let mut expected = Expected::new(network.voids());
            let mut flow = ExpectedFlow::new(&network, &shares, &expected);
            flow.set_isa(isa);
            expected.moving[..26].fill(f64::NAN);
            flow.step(&network, &shares, &mut expected);
            assert!(expected.moving.iter().all(|n| *n == 0.0), "{isa:?}");
        }
    }
}
