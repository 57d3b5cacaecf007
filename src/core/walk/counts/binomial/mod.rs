//! Exact binomial draws: the same bits on every machine, for any count and any probability.
//!
//! A probability is a 64-bit fraction `p / 2^64`; [`CERTAIN`] stands for 1. The methods share the range:
//!
//! - *Trials*, for few of them: sixteen random bits each are compared with `p`, more where they are equal.
//! - *Quantiles*, for a variance from 6 and up to 2^32 trials: one random word is turned into the number of
//!   successes.
//! - *Bits*, for more trials with few successes: uniform words are compared with `p` bit by bit, all at
//!   once. At each bit of `p` a random bit decides about half of the trials that are still open, so `n`
//!   trials cost some `2 n` random bits.
//! - *Inversion*, for large counts of rare events: probabilities are summed from 0 up.
//! - *Transformed rejection*, for what is left: a mean from 10 of huge counts.
//!
//! Beyond [`LARGEST`] trials, where f64 would lose whole numbers, a draw is the sum of draws.
//!
//! [`fill`] draws for many pairs at once, in loops over eight lanes that the compiler turns into vector
//! instructions. Only `+ - * /`, `sqrt` and the `libm` crate touch a float, so the instruction set changes no
//! bit.

mod draws;
mod few;
mod normal;
mod quantile;
mod rejection;
mod saddle;
mod trials;

use crate::stream::{LANES, unit};
pub(super) use draws::{CERTAIN, Draws, as_unit};
use draws::{rarer, turned};
#[cfg(target_arch = "x86_64")]
pub(super) use few::{Avx2, Avx512};
pub(super) use few::{FewTrials, Portable};
use rejection::{Hat, LEAST_MEAN};
use trials::{below_both, by_bits};

/// Most trials of a single draw by rejection or inversion.
const LARGEST: u64 = 1 << 50;

/// Up to this many trials, each is made, whatever the probability.
pub(super) const FEW: u64 = 64;

/// Up to this many trials, bits are compared where the variance is small.
const FEW_RARE: u64 = 2048;

/// Number of `n` trials with probability `p` that succeed.
pub(super) fn one(draws: &mut Draws, n: u64, p: u64) -> u64 {
    if p == CERTAIN {
        n
    } else if n <= FEW {
        below_both(draws, n, [p, p])[0]
    } else if quantile::holds(n, p) {
        let word = draws.word();
        quantile::draw(draws.normal, n, p, word)
    } else {
        by_other(draws, n, p)
    }
}

/// Draws into `k` the number of `n[i]` trials with probability `p[i]` that succeed, for every `i`.
///
/// # Panics
/// If the slices differ in length.
#[inline(always)]
pub(super) fn fill(draws: &mut Draws, n: &[u64], p: &[u64], k: &mut [u64]) {
    assert!(n.len() == k.len() && p.len() == k.len());
    let eights = n.chunks_exact(LANES).zip(p.chunks_exact(LANES)).zip(k.chunks_exact_mut(LANES));
    for ((n, p), k) in eights {
        k.copy_from_slice(&eight(draws, LANES, n.try_into().unwrap(), p.try_into().unwrap()));
    }
    let done = k.len() / LANES * LANES;
    let left = k.len() - done;
    if left > 0 {
        let (mut last_n, mut last_p) = ([0; LANES], [0; LANES]);
        last_n[..left].copy_from_slice(&n[done..]);
        last_p[..left].copy_from_slice(&p[done..]);
        k[done..].copy_from_slice(&eight(draws, left, last_n, last_p)[..left]);
    }
}

/// Eight draws; the first `used` count.
#[inline(always)]
fn eight(draws: &mut Draws, used: usize, n: [u64; LANES], p: [u64; LANES]) -> [u64; LANES] {
    let words = draws.block();
    let (mut k, mut open) = quantile::draw_eight(draws.normal, n, p, words);
    open &= (1 << used) - 1;
    while open != 0 {
        let l = open.trailing_zeros() as usize;
        k[l] = match quantile::holds(n[l], p[l]) {
            true => quantile::decide(n[l], p[l], words[l]),
            false => one(draws, n[l], p[l]),
        };
        open &= open - 1;
    }
    k
}

/// A draw that is neither by trials nor by quantiles.
#[cold]
fn by_other(draws: &mut Draws, n: u64, p: u64) -> u64 {
    if n <= FEW_RARE {
        by_bits(draws, n, p)
    } else if n > LARGEST {
        let (mut left, mut sum) = (n, 0);
        while left > 0 {
            let part = left.min(LARGEST);
            sum += one(draws, part, p);
            left -= part;
        }
        sum
    } else if n as f64 * as_unit(rarer(p)) >= LEAST_MEAN {
        turned(n, p, Hat::new(n, p).draw(draws))
    } else {
        turned(n, p, by_inversion(draws, n, as_unit(rarer(p))))
    }
}

/// Sums probabilities from 0 up until they exceed a uniform draw.
fn by_inversion(draws: &mut Draws, n: u64, p: f64) -> u64 {
    let (odds, none) = (p / (1.0 - p), libm::exp(n as f64 * libm::log1p(-p)));
    // No mean below 10 gets here but with a probability far below 2^-53.
    const BEYOND: u64 = 200;
    loop {
        let (mut left, mut probability) = (unit(draws.word()), none);
        for k in 0..=n.min(BEYOND) {
            if left <= probability {
                return k;
            }
            left -= probability;
            probability *= (n - k) as f64 / (k + 1) as f64 * odds;
        }
    }
}

#[cfg(test)]
mod tests;
