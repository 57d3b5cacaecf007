//! Few trials, each made: random bits are compared with probabilities.

use super::draws::Draws;
use crate::stream::DRAWS_PER_BLOCK;

/// Number of `n` uniform 64-bit words that are below each of two thresholds.
///
/// Sixteen bits of each are drawn, and the other 48 where those are equal to a threshold's.
#[inline(always)]
pub(in crate::walk::counts) fn below_both(draws: &mut Draws, n: u64, thresholds: [u64; 2]) -> [u64; 2] {
    let [first, second] = thresholds.map(|t| (t >> 48) as u16);
    let (mut below, mut left) = ([0, 0], n);
    while left > 0 {
        let sixteens: [u16; DRAWS_PER_BLOCK] = bytemuck::cast(draws.block().map(u64::to_le));
        let counted = left.min(DRAWS_PER_BLOCK as u64) as u16;
        let (mut less, mut less_second, mut same) = (0u16, 0u16, 0u16);
        for (j, &draw) in sixteens.iter().enumerate() {
            let draw = u16::from_le(draw);
            let counts = (j as u16) < counted;
            less += u16::from(counts & (draw < first));
            less_second += u16::from(counts & (draw < second));
            same += u16::from(counts & ((draw == first) | (draw == second)));
        }
        below[0] += u64::from(less);
        below[1] += u64::from(less_second);
        if same > 0 {
            complete(draws, &sixteens[..counted as usize], thresholds, &mut below);
        }
        left -= u64::from(counted);
    }
    below
}

/// Adds the words whose sixteen bits are equal to a threshold's, and that are below it.
#[cold]
#[inline(never)]
pub(super) fn complete(draws: &mut Draws, sixteens: &[u16], thresholds: [u64; 2], below: &mut [u64; 2]) {
    let top = |word: u64| (word >> 48) as u16;
    for draw in sixteens.iter().map(|&draw| u16::from_le(draw)) {
        if thresholds.iter().any(|&t| draw == top(t)) {
            let whole = u64::from(draw) << 48 | draws.word() >> 16;
            for (below, &t) in below.iter_mut().zip(&thresholds) {
                *below += u64::from(draw == top(t) && whole < t);
            }
        }
    }
}

/// Compares `n` uniform words with `p`, bit by bit; returns the number below.
pub(super) fn by_bits(draws: &mut Draws, n: u64, p: u64) -> u64 {
    let (mut undecided, mut below, mut bits) = (n, 0, p);
    // Once the rest of `p` is zero, words equal so far are not below.
    while undecided > 0 && bits != 0 {
        let ones = ones_among(draws, undecided);
        let zeros = undecided - ones;
        if bits >> 63 == 1 {
            below += zeros;
            undecided = ones;
        } else {
            undecided = zeros;
        }
        bits <<= 1;
    }
    below
}

/// Ones among `m` random bits, `m > 0`.
fn ones_among(draws: &mut Draws, m: u64) -> u64 {
    let mut ones = 0;
    let mut left = m;
    while left > 64 {
        ones += draws.word().count_ones();
        left -= 64;
    }
    u64::from(ones + (draws.word() >> (64 - left)).count_ones())
}
