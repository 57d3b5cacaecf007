//! Exact binomial draws: the same bits on every machine, for any count and any probability.
//!
//! A probability is a 64-bit fraction `p / 2^64`; [`CERTAIN`] stands for 1. Four methods share the range:
//!
//! - *Trials*, for few of them: sixteen random bits each are compared with `p`, more where they are equal.
//! - *Bits*, for more trials with few successes: uniform words are compared with `p` bit by bit, all at
//!   once. At each bit of `p` a random bit decides about half of the trials that are still open, so `n`
//!   trials cost some `2 n` random bits.
//! - *Transformed rejection* (BTRS; W. Hoermann 1993, doi:10.1080/00949659308811496), where `n min(p, 1 - p)` is at
//!   least 10: most draws are accepted by a squeeze without a logarithm; nearly all others by a series
//!   with a proven margin; what lies within the margin by [`super::saddle`].
//! - *Inversion*, for large counts of rare events.
//!
//! Beyond [`LARGEST`] trials, where f64 would lose whole numbers, a draw is the sum of draws.
//!
//! [`fill`] draws for many pairs at once: the first proposal of every large pair is made in loops over
//! eight lanes that the compiler turns into vector instructions. Only `+ - * /`, `sqrt` and the `libm`
//! crate touch a float, so the instruction set changes no bit.

use super::saddle::ln_probability;
use crate::stream::{DRAWS_PER_BLOCK, Key, LANES, Lanes, unit};

/// The probability 1.
pub(super) const CERTAIN: u64 = u64::MAX;

/// Most trials of a single draw by rejection or inversion.
const LARGEST: u64 = 1 << 50;

/// Below this mean (of the rarer outcome) rejection does not hold.
const LEAST_MEAN: f64 = 10.0;

/// Up to this many trials, each is made, whatever the probability.
const FEW: u64 = 96;

/// Up to this many trials, bits are compared where the mean is small.
const FEW_RARE: u64 = 2048;

const TWO_TO_MINUS_64: f64 = 1.0 / 18_446_744_073_709_551_616.0;

/// 2^52: adding it rounds a smaller float to a whole number.
const ROUNDER: f64 = 4_503_599_627_370_496.0;
const MANTISSA: u64 = (1 << 52) - 1;

/// The random words of one stream, one after another or a block at a time.
pub(super) struct Draws {
    lanes: Lanes,
    block: [u64; LANES],
    used: usize,
}

impl Draws {
    pub fn new(key: Key) -> Self {
        Self { lanes: key.lanes(), block: [0; LANES], used: LANES }
    }

    #[inline(always)]
    pub fn word(&mut self) -> u64 {
        if self.used == LANES {
            self.block = self.lanes.next_block();
            self.used = 0;
        }
        self.used += 1;
        self.block[self.used - 1]
    }

    /// A fresh block; words left of the current one stay for [`Draws::word`].
    #[inline(always)]
    fn block(&mut self) -> [u64; LANES] {
        self.lanes.next_block()
    }
}

/// How many of `n` trials with probability `p` succeed.
#[inline]
pub(super) fn one(draws: &mut Draws, n: u64, p: u64) -> u64 {
    if !rejection_holds(n, p) {
        return by_other(draws, n, p);
    }
    turned(n, p, Hat::of(n, p).draw(draws))
}

/// Room for [`fill`].
#[derive(Default)]
pub(super) struct Scratch {
    /// Pairs that are drawn by rejection, and those whose last proposal was turned down.
    large: Vec<u32>,
    /// Pairs that are drawn otherwise.
    other: Vec<u32>,
    /// Pairs whose proposal the squeeze left open, with its `u` and `v`.
    undecided: Vec<(u32, f64, f64)>,
}

impl Scratch {
    fn room_for(&mut self, pairs: usize) {
        // Whole eights, so that the last of them can be read like the others.
        let pairs = pairs.next_multiple_of(LANES);
        self.large.resize(self.large.len().max(pairs), 0);
        self.other.resize(self.other.len().max(pairs), 0);
        self.undecided.resize(self.undecided.len().max(pairs), (0, 0.0, 0.5));
    }
}

/// How many of `n[i]` trials with probability `p[i]` succeed, for every `i`, into `k`.
#[inline(always)]
pub(super) fn fill(draws: &mut Draws, n: &[u64], p: &[u64], k: &mut [u64], scratch: &mut Scratch) {
    let (n, p) = (&n[..k.len()], &p[..k.len()]);
    scratch.room_for(k.len());
    let Scratch { large, other, undecided } = scratch;
    // Written always, kept where it is wanted: which pairs are large cannot be predicted.
    let (mut larges, mut others) = (0, 0);
    for i in 0..k.len() {
        let is_large = rejection_holds(n[i], p[i]);
        (large[larges], other[others]) = (i as u32, i as u32);
        larges += usize::from(is_large);
        others += usize::from(!is_large);
    }
    for &i in &other[..others] {
        let i = i as usize;
        k[i] = by_other(draws, n[i], p[i]);
    }
    while larges > FEW_LEFT {
        let left = propose_all(draws, n, p, k, &large[..larges], undecided);
        larges = judge_all(n, p, k, &undecided[..left], large);
    }
    for &i in &large[..larges] {
        let i = i as usize;
        k[i] = turned(n[i], p[i], Hat::of(n[i], p[i]).draw(draws));
    }
}

/// With so few pairs left, eight at once do not pay.
const FEW_LEFT: usize = 2;

/// Proposes for every pair in `large`, eight at a time; those that the squeeze leaves open go to `undecided`, and are counted.
#[inline(always)]
fn propose_all(
    draws: &mut Draws,
    n: &[u64],
    p: &[u64],
    k: &mut [u64],
    large: &[u32],
    undecided: &mut [(u32, f64, f64)],
) -> usize {
    let mut left = 0;
    for eight in large.chunks(LANES) {
        let (mut trials, mut chance) = ([1u64; LANES], [1u64 << 63; LANES]);
        for (lane, &i) in eight.iter().enumerate() {
            (trials[lane], chance[lane]) = (n[i as usize], p[i as usize]);
        }
        let (u, v) = (centred(draws.block()), units(draws.block()));
        let (found, accepted) = propose(&trials, &chance, &u, &v);
        for (lane, &i) in eight.iter().enumerate() {
            k[i as usize] = found[lane];
            undecided[left] = (i, u[lane], v[lane]);
            left += usize::from(!accepted[lane]);
        }
    }
    left
}

/// Decides on proposals that the squeeze left open; the pairs that have to propose again go to `again`, and are counted.
#[inline(always)]
fn judge_all(n: &[u64], p: &[u64], k: &mut [u64], undecided: &[(u32, f64, f64)], again: &mut [u32]) -> usize {
    let mut left = 0;
    for eight in undecided.chunks(LANES) {
        let mut hats = [Hat::new(1e3, 0.5, 0.5); LANES];
        let mut found = [0.0; LANES];
        let mut verdict = [Verdict::Open; LANES];
        for (lane, &(i, ..)) in eight.iter().enumerate() {
            hats[lane].n = n[i as usize] as i64 as f64;
            hats[lane].p = as_unit(rarer(p[i as usize]));
            hats[lane].q = as_unit(rarer(p[i as usize]).wrapping_neg());
        }
        let (mut u, mut v) = ([0.0; LANES], [0.5; LANES]);
        for (lane, &(_, its_u, its_v)) in eight.iter().enumerate() {
            (u[lane], v[lane]) = (its_u, its_v);
        }
        for l in 0..LANES {
            hats[l] = Hat::new(hats[l].n, hats[l].p, hats[l].q);
            (found[l], verdict[l]) = hats[l].verdict(u[l], v[l]);
        }
        for (lane, &(i, u, v)) in eight.iter().enumerate() {
            let accepted = match verdict[lane] {
                Verdict::Accepted => true,
                Verdict::TurnedDown => false,
                Verdict::Open => hats[lane].accepts_exactly(found[lane], v * hats[lane].scale(u)),
            };
            let i = i as usize;
            if accepted {
                k[i] = turned(n[i], p[i], found[lane] as i64 as u64);
            }
            again[left] = i as u32;
            left += usize::from(!accepted);
        }
    }
    left
}

/// `drawn` is of the rarer outcome.
#[inline(always)]
fn turned(n: u64, p: u64, drawn: u64) -> u64 {
    if p > 1 << 63 { n - drawn } else { drawn }
}

/// Whether a draw is by rejection.
#[inline(always)]
fn rejection_holds(n: u64, p: u64) -> bool {
    // A signed conversion is one instruction; beyond LARGEST it does not matter.
    (n > FEW) & (n <= LARGEST) & (n as i64 as f64 * as_unit(rarer(p)) >= LEAST_MEAN) & (p != CERTAIN)
}

/// The probability of the rarer outcome.
#[inline(always)]
fn rarer(p: u64) -> u64 {
    p.min(p.wrapping_neg())
}

#[inline(always)]
fn as_unit(p: u64) -> f64 {
    p as f64 * TWO_TO_MINUS_64
}

/// A draw that is not by rejection.
#[inline(always)]
fn by_other(draws: &mut Draws, n: u64, p: u64) -> u64 {
    if p == CERTAIN {
        n
    } else if n <= FEW {
        by_trials(draws, n, p)
    } else if n <= FEW_RARE {
        by_bits(draws, n, p)
    } else {
        by_inversion_in_parts(draws, n, p)
    }
}

#[cold]
fn by_inversion_in_parts(draws: &mut Draws, n: u64, p: u64) -> u64 {
    if n > LARGEST {
        let (mut left, mut sum) = (n, 0);
        while left > 0 {
            let part = left.min(LARGEST);
            sum += one(draws, part, p);
            left -= part;
        }
        return sum;
    }
    turned(n, p, by_inversion(draws, n, as_unit(rarer(p))))
}

/// Sixteen-bit draws in a block.
const DRAWS: u64 = DRAWS_PER_BLOCK as u64;

/// Compares sixteen bits of each trial with `p`, and 48 more of those that are equal.
#[inline(always)]
fn by_trials(draws: &mut Draws, n: u64, p: u64) -> u64 {
    let (top, low) = ((p >> 48) as u16, p << 16 >> 16);
    let (mut below, mut equal, mut left) = (0, 0, n);
    while left > 0 {
        let sixteens: [u16; DRAWS_PER_BLOCK] = bytemuck::cast(draws.block().map(u64::to_le));
        let counted = left.min(DRAWS) as u16;
        let (mut less, mut same) = (0u16, 0u16);
        for (j, &draw) in sixteens.iter().enumerate() {
            let counts = (j as u16) < counted;
            less += u16::from(counts & (draw < top));
            same += u16::from(counts & (draw == top));
        }
        below += u64::from(less);
        equal += u64::from(same);
        left -= u64::from(counted);
    }
    (0..equal).for_each(|_| below += u64::from(draws.word() >> 16 < low));
    below
}

/// Compares `n` uniform words with `p`, bit by bit: how many are below.
#[inline]
fn by_bits(draws: &mut Draws, n: u64, p: u64) -> u64 {
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
#[inline(always)]
fn ones_among(draws: &mut Draws, m: u64) -> u64 {
    let mut ones = 0;
    let mut left = m;
    while left > 64 {
        ones += draws.word().count_ones();
        left -= 64;
    }
    u64::from(ones + (draws.word() >> (64 - left)).count_ones())
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

/// [`unit`] of every word.
#[inline(always)]
fn units(words: [u64; LANES]) -> [f64; LANES] {
    const ONE: u64 = 0x3ff0_0000_0000_0000;
    words.map(|w| (f64::from_bits(w >> 12 | ONE) - 1.0) + f64::EPSILON / 2.0)
}

/// Uniform between -1/2 and 1/2.
#[inline(always)]
fn centred(words: [u64; LANES]) -> [f64; LANES] {
    units(words).map(|u| u - 0.5)
}

/// Constants of Hoermann's BTRS: within this of 0, `u` may be accepted by `v` alone.
const QUICK_U: f64 = 0.07;

/// First proposals of eight draws, and which of them the squeeze accepts.
#[inline(always)]
fn propose(
    n: &[u64; LANES],
    p: &[u64; LANES],
    u: &[f64; LANES],
    v: &[f64; LANES],
) -> ([u64; LANES], [bool; LANES]) {
    let (mut k, mut accepted) = ([0; LANES], [false; LANES]);
    for l in 0..LANES {
        let rare = rarer(p[l]);
        let (trials, chance) = (n[l] as i64 as f64, as_unit(rare));
        let mean = trials * chance;
        let sigma = (mean * (1.0 - chance)).sqrt();
        let b = width(sigma);
        let us = 0.5 - u[l].abs();
        let at = (2.0 * tail(b, chance) / us + b) * u[l] + mean;
        // Rounds `at`, which is `floor(at + 1/2)` but for ties.
        let found = (at + ROUNDER).to_bits() & MANTISSA;
        k[l] = if rare == p[l] { found } else { n[l].wrapping_sub(found) };
        accepted[l] = (us >= QUICK_U) & (v[l] * b <= 0.92 * b - 4.2);
    }
    (k, accepted)
}

/// `b` of BTRS.
#[inline(always)]
fn width(sigma: f64) -> f64 {
    1.15 + 2.53 * sigma
}

/// `a` of BTRS.
#[inline(always)]
fn tail(b: f64, p: f64) -> f64 {
    -0.0873 + 0.0248 * b + 0.01 * p
}

/// BTRS for one pair: `p <= 1/2`, `n p >= 10`.
#[derive(Clone, Copy)]
struct Hat {
    n: f64,
    p: f64,
    q: f64,
    mean: f64,
    sigma: f64,
    a: f64,
    b: f64,
}

/// What the series says of a proposal.
#[derive(Clone, Copy, PartialEq)]
enum Verdict {
    Accepted,
    TurnedDown,
    /// Within the margin, or where the series does not hold.
    Open,
}

/// How far the series of [`Hat::near`] may be off, relatively.
const MARGIN: f64 = 4e-3;

impl Hat {
    /// Draws the rarer outcome of `n` trials with probability `p`.
    fn of(n: u64, p: u64) -> Self {
        Self::new(n as i64 as f64, as_unit(rarer(p)), as_unit(rarer(p).wrapping_neg()))
    }

    #[inline(always)]
    fn new(n: f64, p: f64, q: f64) -> Self {
        let mean = n * p;
        let sigma = (mean * (1.0 - p)).sqrt();
        let b = width(sigma);
        Self { n, p, q, mean, sigma, a: tail(b, p), b }
    }

    fn draw(&self, draws: &mut Draws) -> u64 {
        loop {
            let (u, v) = (unit(draws.word()) - 0.5, unit(draws.word()));
            let (k, verdict) = self.verdict(u, v);
            let open = || self.accepts_exactly(k, v * self.scale(u));
            if verdict == Verdict::Accepted || (verdict == Verdict::Open && open()) {
                return k as i64 as u64;
            }
        }
    }

    #[inline(always)]
    fn propose(&self, u: f64) -> f64 {
        let us = 0.5 - u.abs();
        (2.0 * self.a / us + self.b) * u + self.mean
    }

    /// What `v` is multiplied by before it is compared with the probability of the proposal over that of the mode.
    #[inline(always)]
    fn scale(&self, u: f64) -> f64 {
        let us = 0.5 - u.abs();
        let square = us * us;
        (2.83 * self.b + 5.1) * self.sigma * square / (self.b * (self.a + self.b * square))
    }

    /// What `u` proposes, and whether `v` accepts it.
    #[inline(always)]
    fn verdict(&self, u: f64, v: f64) -> (f64, Verdict) {
        let at = self.propose(u);
        let in_range = (at >= -0.5) & (at < self.n + 0.5);
        // `floor(at + 1/2)` but for ties; out of range it does not matter.
        let at = if in_range { at } else { self.mean };
        let k = whole(at.max(0.0));
        let level = v * self.scale(u);
        let (ratio, holds) = self.near(k);
        let quick = (0.5 - u.abs() >= QUICK_U) & (v * self.b <= 0.92 * self.b - 4.2);
        let accepted = quick | (holds & (level <= ratio * (1.0 - MARGIN)));
        let turned_down = !in_range | (!quick & holds & (level >= ratio * (1.0 + MARGIN)));
        let verdict = match (turned_down, accepted) {
            (true, _) => Verdict::TurnedDown,
            (false, true) => Verdict::Accepted,
            (false, false) => Verdict::Open,
        };
        (k, verdict)
    }

    #[cold]
    fn accepts_exactly(&self, k: f64, level: f64) -> bool {
        libm::log(level) <= self.ln_ratio(k)
    }

    /// The likeliest outcome, or another as likely.
    #[inline(always)]
    fn mode(&self) -> f64 {
        whole((self.n + 1.0) * self.p - 0.5)
    }

    fn ln_ratio(&self, k: f64) -> f64 {
        ln_probability(self.n, self.p, self.q, k) - ln_probability(self.n, self.p, self.q, self.mode())
    }

    /// The probability of `k` over that of the mode, to within less than `MARGIN / 2` where short series give it, and
    /// whether they do: the terms of [`super::saddle`], cut off.
    #[inline(always)]
    fn near(&self, k: f64) -> (f64, bool) {
        let (mean, other) = (self.mean, self.n * self.q);
        let x = k - mean;
        // One division for two reciprocals, here and below.
        let both = 1.0 / (mean * other);
        let (m1, m2) = (other * both, mean * both);
        let (d1, d2) = (x * m1, -x * m2);
        let over = 1.0 / ((2.0 + d1) * (2.0 + d2));
        let (v1, v2) = (d1 * (2.0 + d2) * over, d2 * (2.0 + d1) * over);
        // Since p <= 1/2, v1 is the larger of the two in size.
        let square = v1 * v1;
        let fourth = square * square;
        let holds = (square <= 1.0 / 9.0) & (k * square * fourth * fourth <= 2e-3);
        let odd = |v: f64| {
            let vv = v * v;
            v * vv * (1.0 / 3.0 + vv * (1.0 / 5.0 + vv * (1.0 / 7.0 + vv * (1.0 / 9.0))))
        };
        let exponent = x * (v1 - v2) + 2.0 * (k * odd(v1) + (self.n - k) * odd(v2));
        let shrink = 1.0 / ((1.0 + d1) * (1.0 + d2));
        // Stirling's errors of k and n - k less those of the mode cancel but for this.
        let stirling = (m1 * d1 * (1.0 + d2) + m2 * d2 * (1.0 + d1)) * shrink;
        let y = self.mode() - mean;
        let (e1, e2) = (y * m1, -y * m2);
        let of_mode = -0.5 * y * (e1 - e2) + y * (e1 * e1 - e2 * e2) / 6.0 - 0.5 * (e1 + e2)
            + 0.25 * (e1 * e1 + e2 * e2);
        (shrink.sqrt() * near_exp(stirling / 12.0 - exponent - of_mode), holds)
    }
}

/// The nearest whole number, for 0 or more and below 2^51.
#[inline(always)]
fn whole(x: f64) -> f64 {
    (x + ROUNDER) - ROUNDER
}

/// `e^x` to about 3e-6 for `x` below 700: enough for a margin, in few operations that vectors have.
#[inline(always)]
fn near_exp(x: f64) -> f64 {
    // 1.5 * 2^52 rounds negative numbers too.
    const ROUND: f64 = 1.5 * ROUNDER;
    let shifted = x.max(-600.0) * std::f64::consts::LOG2_E + ROUND;
    let f = x.max(-600.0) - (shifted - ROUND) * std::f64::consts::LN_2;
    let series = 1.0 + f * (1.0 + f * (0.5 + f * (1.0 / 6.0 + f * (1.0 / 24.0 + f * (1.0 / 120.0)))));
    series * f64::from_bits((shifted.to_bits() << 52).wrapping_add(1023 << 52))
}

#[cfg(test)]
mod tests;
