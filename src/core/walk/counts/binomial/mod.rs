//! Exact binomial draws for any count and probability, with the same bits on every machine.
//!
//! A probability is a 64-bit fraction `p / 2^64`; [`CERTAIN`] is 1. Each method covers part of the range:
//!
//! - *Trials*, for small numbers: sixteen random bits each are compared with `p`, more if they are equal.
//! - *Quantiles*, for a variance of at least 6 and up to 2^32 trials: one random word gives the number of
//!   successes.
//! - *Bits*, for more trials with few successes: uniform words are compared with `p` bit by bit, all at
//!   once, at a cost of about `2 n` random bits for `n` trials.
//! - *Inversion*, for large counts of rare events: probabilities are summed from 0 up.
//! - *Transformed rejection*, for the remaining cases: huge counts with a mean of at least 10.
//!
//! Above [`LARGEST`] trials, where f64 cannot hold every integer, a draw is the sum of several draws.
//!
//! Floats are only processed by `+ - * /`, `sqrt` and the `libm` crate, so the bits do not depend on the
//! instruction set.

mod draws;
mod quantile;

use crate::stream::{LANES, unit};
#[cfg(target_arch = "x86_64")]
pub(super) use draws::{Avx2, Avx512};
pub(super) use draws::{Draws, FewTrials, Portable};
use draws::{below_both, by_bits};
pub(super) use quantile::{CERTAIN, as_unit};
use quantile::{ROUNDER, ln_probability, rarer, turned};

/// Maximum number of trials of a single draw by rejection or inversion.
const LARGEST: u64 = 1 << 50;

/// Number of trials up to which each trial is made, for any probability.
pub(super) const FEW: u64 = 64;

/// Number of trials up to which bits are compared if the variance is small.
const FEW_RARE: u64 = 2048;

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

/// Draws into `k[i]` the number of successes in `n[i]` trials with probability `p[i]`, for every `i`.
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

/// Makes eight draws; only the first `used` are needed.
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

/// Draws by summing probabilities from 0 up until they exceed a uniform draw.
fn by_inversion(draws: &mut Draws, n: u64, p: f64) -> u64 {
    let (odds, none) = (p / (1.0 - p), libm::exp(n as f64 * libm::log1p(-p)));
    // Means below 10 exceed this only with a probability far below 2^-53.
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

/// Minimum mean (of the rarer outcome) for which rejection is valid.
const LEAST_MEAN: f64 = 10.0;

/// Constant of Hoermann's BTRS: if `u` is within this distance of 0, `v` alone may accept it.
const QUICK_U: f64 = 0.07;

/// Transformed rejection for one pair with `p <= 1/2`, `n p >= 10` (BTRS; W. Hoermann 1993,
/// doi:10.1080/00949659308811496), for counts too large for the other methods. A squeeze accepts most
/// draws; the exact probability decides the others.
#[derive(Clone, Copy)]
struct Hat {
    pub(crate) n: f64,
    pub(crate) p: f64,
    q: f64,
    mean: f64,
    sigma: f64,
    a: f64,
    pub(crate) b: f64,
}

impl Hat {
    pub(crate) fn new(n: u64, p: u64) -> Self {
        let (n, p, q) = (n as f64, as_unit(rarer(p)), as_unit(rarer(p).wrapping_neg()));
        let mean = n * p;
        let sigma = (mean * q).sqrt();
        let b = 1.15 + 2.53 * sigma;
        Self { n, p, q, mean, sigma, a: -0.0873 + 0.0248 * b + 0.01 * p, b }
    }

    pub(crate) fn draw(&self, draws: &mut Draws) -> u64 {
        loop {
            let (u, v) = (unit(draws.word()) - 0.5, unit(draws.word()));
            let at = self.propose(u);
            if !(at >= -0.5 && at < self.n + 0.5) {
                continue;
            }
            let k = whole(at.max(0.0)).min(self.n);
            let quick = 0.5 - u.abs() >= QUICK_U && v <= 0.92 - 4.2 / self.b;
            if quick || libm::log(v * self.scale(u)) <= self.ln_ratio(k) {
                return k as u64;
            }
        }
    }

    pub(crate) fn propose(&self, u: f64) -> f64 {
        let us = 0.5 - u.abs();
        (2.0 * self.a / us + self.b) * u + self.mean
    }

    /// Factor for `v` before it is compared with the probability of the proposal divided by that of the mode.
    pub(crate) fn scale(&self, u: f64) -> f64 {
        let us = 0.5 - u.abs();
        let square = us * us;
        (2.83 * self.b + 5.1) * self.sigma * square / (self.b * (self.a + self.b * square))
    }

    /// Logarithm of the probability of `k` divided by that of the mode.
    fn ln_ratio(&self, k: f64) -> f64 {
        // Most likely outcome, or an equally likely one.
        let mode = whole((self.n + 1.0) * self.p - 0.5);
        ln_probability(self.n, self.p, self.q, k) - ln_probability(self.n, self.p, self.q, mode)
    }
}

/// Nearest integer for values from 0 to below 2^51: `floor(x + 1/2)` except for ties.
fn whole(x: f64) -> f64 {
    (x + ROUNDER) - ROUNDER
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::stream::{DRAWS_PER_BLOCK, Key, Purpose, draw16};

    fn draws(chunk: u64) -> Draws {
        Draws::new(Key { seed: 2024, purpose: Purpose::Passive, run: 9, increment: 1, chunk })
    }

    /// Probability `p` as a 64-bit fraction.
    fn fraction(p: f64) -> u64 {
        (p * 18_446_744_073_709_551_616.0) as u64
    }

    /// Chi-square with its degrees of freedom as a z score (Wilson and Hilferty).
    fn z_of_chi_square(square: f64, freedom: f64) -> f64 {
        let part = 2.0 / (9.0 * freedom);
        (libm::cbrt(square / freedom) - (1.0 - part)) / part.sqrt()
    }

    /// Approximate number of cells per test; more cells resolve finer errors with less power.
    const CELLS: f64 = 24.0;

    /// Compares draws from Binomial(n, p) with exact probabilities in cells about a quarter of a standard
    /// deviation wide.
    ///
    /// Above a million trials the probability of a cell is summed over `k` in steps, as the density is
    /// smooth enough.
    fn z_score(n: u64, p: u64, sample: &[u64]) -> f64 {
        let (probability, q) = (as_unit(p), as_unit(p.wrapping_neg()));
        let mean = n as f64 * probability;
        let sigma = (mean * q).sqrt();
        let width = ((6.0 * sigma / CELLS).ceil() as u64).max(1);
        let low = ((mean - 3.0 * sigma).max(0.0)) as u64;
        let cells = ((6.0 * sigma / width as f64).ceil() as usize).max(1);
        // Cell 0 holds all values below `low`, the last cell all above.
        let cell = |k: u64| if k < low { 0 } else { 1 + ((k - low) / width).min(cells as u64) as usize };
        let mut expected = vec![0.0; cells + 2];
        let pmf = |k: u64| libm::exp(ln_probability(n as f64, probability, q, k as f64));
        for c in 0..cells {
            let begin = low + c as u64 * width;
            let end = (begin + width).min(n + 1);
            let step = (width / 400).max(1);
            let mut at = begin;
            while at < end {
                let span = step.min(end - at);
                // Middle value of the span, or the mean of the two middle values.
                expected[c + 1] += span as f64 * 0.5 * (pmf(at + (span - 1) / 2) + pmf(at + span / 2));
                at += span;
            }
        }
        // Cell 0: sums down from `low` until the terms vanish; the last cell is the rest.
        if low > 0 {
            let step = ((sigma / 400.0) as u64).max(1);
            let mut at = low;
            while at > 0 && mean - at as f64 <= 12.0 * sigma {
                let span = step.min(at);
                expected[0] += span as f64 * 0.5 * (pmf(at - 1 - (span - 1) / 2) + pmf(at - 1 - span / 2));
                at -= span;
            }
        }
        expected[cells + 1] = 1.0 - expected.iter().sum::<f64>();
        let mut observed = vec![0.0; cells + 2];
        for &k in sample {
            assert!(k <= n);
            observed[cell(k)] += 1.0;
        }
        // Adjacent cells are merged until each expects eight draws.
        let (mut square, mut freedom, mut e, mut f) = (0.0, -1.0, 0.0, 0.0);
        for c in 0..cells + 2 {
            e += expected[c] * sample.len() as f64;
            f += observed[c];
            let left: f64 = expected[c + 1..].iter().sum::<f64>() * sample.len() as f64;
            if (e >= 8.0 && left >= 8.0) || c == cells + 1 {
                square += (f - e) * (f - e) / e;
                freedom += 1.0;
                (e, f) = (0.0, 0.0);
            }
        }
        assert!(freedom >= 1.0, "n {n} p {probability}: one cell only");
        z_of_chi_square(square, freedom)
    }

    const SAMPLE: usize = 20_000;

    /// Pairs for every method, the limits between methods, and counts above 1e12.
    fn pairs() -> Vec<(u64, f64)> {
        vec![
            (1, 0.3),
            (2, 1.0 / 3.0),
            (7, 0.9),
            (31, 0.5),
            (32, 0.25),
            (33, 0.7),
            (FEW, 0.4),
            (FEW + 1, 0.4),
            (FEW, 0.05),
            (FEW + 1, 0.05),
            (FEW + 1, 0.065),
            (FEW + 1, 0.067),
            (150, 0.9),
            (200, 0.0499),
            (200, 0.0501),
            (FEW_RARE, 0.004),
            (FEW_RARE + 1, 0.004),
            (FEW_RARE + 1, 0.0049),
            (FEW_RARE, 0.995),
            (3_750, 1.0 / 3.0),
            (2_500, 0.5),
            (2_501, 0.6),
            (100_000, 0.000_09),
            (100_000, 0.000_11),
            (1_000_000, 0.2),
            (1_000_000_007, 0.01),
            (quantile::MOST_TRIALS, 1.5e-9),
            (quantile::MOST_TRIALS, 0.3),
            (quantile::MOST_TRIALS + 1, 0.3),
            (1_000_000_000_000, 1.0 / 3.0),
            (1_000_000_000_000, 5e-12),
            (1_000_000_000_000, 2e-11),
            (1_000_000_000_000, 1.0 - 5e-12),
            (LARGEST, 0.5),
            (3 * LARGEST + 5, 0.25),
        ]
    }

    /// Tests both functions: 70 tests with bound 4 give a false alarm for 0.2 % of seeds, and this seed is
    /// fixed. With 20,000 draws a shift by 4 % of the standard deviation, or a 4 % error in it, is
    /// detected; smaller errors are not.
    #[test]
    fn draws_follow_the_binomial_distribution() {
        for (i, (n, p)) in pairs().into_iter().enumerate() {
            let p = fraction(p);
            let mut words = draws(2 * i as u64);
            let single: Vec<u64> = (0..SAMPLE).map(|_| one(&mut words, n, p)).collect();
            let mut many = vec![0; SAMPLE];
            fill(&mut draws(2 * i as u64 + 1), &[n; SAMPLE], &[p; SAMPLE], &mut many);
            for sample in [single, many] {
                let z = z_score(n, p, &sample);
                assert!(z < 4.0, "n = {n}, p = {}: z = {z}", as_unit(p));
            }
        }
    }

    /// The test above detects one success too many, an error of one in n, and a small error in the
    /// probability.
    #[test]
    fn planted_faults_are_caught() {
        let mut words = draws(1000);
        let mut caught = |n: u64, p: f64, fault: &dyn Fn(&mut Draws, u64, u64) -> u64| {
            let sample: Vec<u64> = (0..SAMPLE).map(|_| fault(&mut words, n, fraction(p)).min(n)).collect();
            z_score(n, fraction(p), &sample) > 4.0
        };
        for (n, p) in [(7, 0.4), (32, 0.25), (FEW, 0.4), (150, 0.5), (200, 0.03), (FEW_RARE, 0.004)] {
            assert!(!caught(n, p, &one), "{n} {p}");
            assert!(caught(n, p, &|w, n, p| one(w, n, p) + 1), "one too many: {n} {p}");
        }
        // One trial too few shifts the mean by p, which 20,000 draws detect up to n of about 50.
        assert!(caught(7, 0.4, &|w, n, p| one(w, n - 1, p)));
        assert!(caught(33, 0.7, &|w, n, p| one(w, n - 1, p)));
        // One too many would be 3 % of a standard deviation for n = 3750; for n = 500 it is detected.
        assert!(caught(500, 0.3, &|w, n, p| one(w, n, p) + 1));
        assert!(caught(1_000_000_000_000, 0.3, &|w, n, p| one(w, n, p - (1 << 45))));
    }

    /// Impossible and certain outcomes do not depend on draws.
    #[test]
    fn never_and_always_are_exact() {
        let mut words = draws(2000);
        for n in [0, 1, 31, FEW, FEW + 1, 5_000, 1_000_000_000_000, LARGEST + 1] {
            assert_eq!((one(&mut words, n, 0), one(&mut words, n, CERTAIN)), (0, n));
        }
        let mut k = [7; 3];
        fill(&mut words, &[0, 9, 9_000_000], &[1 << 63, 0, CERTAIN], &mut k);
        assert_eq!(k, [0, 0, 9_000_000]);
        // Smallest and largest probability that are neither impossible nor certain.
        assert_eq!(one(&mut words, 1_000_000, 1), 0);
        assert_eq!(one(&mut words, 1_000_000, CERTAIN - 1), 1_000_000);
    }

    /// BTRS is exact only if, for every `u`, the largest acceptable `v` is at least the limit of the
    /// squeeze (if that is used) and at most 1. Scanned at 4,000 values of `u` for each of about 60 pairs.
    #[test]
    fn the_squeeze_lies_inside_and_the_hat_outside() {
        let counts =
            [100, 500, 3_750, 20_000, 1_000_000, 1_000_000_000, quantile::MOST_TRIALS + 1, 1 << 40, LARGEST];
        let probabilities = [0.5, 0.49, 1.0 / 3.0, 0.2, 0.1, 0.05, 1e-3, 1e-5, 1e-9];
        let pairs = counts.into_iter().flat_map(|n| probabilities.map(|p| (n, p)));
        let mut scanned = 0;
        for (n, p) in pairs.filter(|&(n, p)| n as f64 * p >= LEAST_MEAN) {
            let hat = Hat::new(n, fraction(p));
            scanned += 1;
            for i in 0..4000 {
                let u = (f64::from(i) + 0.5) / 4000.0 - 0.5;
                let at = hat.propose(u);
                if !(at >= -0.5 && at < hat.n + 0.5) {
                    continue;
                }
                let k = (at + 0.5).floor().min(hat.n);
                let most = libm::exp(hat.ln_ratio(k)) / hat.scale(u);
                assert!(most <= 1.0 + 1e-9, "n {n} p {p} u {u}: {most}");
                if 0.5 - u.abs() >= QUICK_U {
                    assert!(most >= 0.92 - 4.2 / hat.b, "n {n} p {p} u {u}: {most}");
                }
            }
        }
        assert!(scanned > 50, "{scanned}");
    }

    /// Compares both counts of one call with the joint distribution of three outcomes, including ties of
    /// sixteen bits: the thresholds share their top sixteen bits in two cases. Each of the three numbers
    /// is binomial, which tests their dependence. Bound 4 on 12 tests, with the power given above.
    #[test]
    fn two_thresholds_are_compared_with_the_same_words() {
        let tied = 0x5555_4000_0000_0000;
        for (i, (n, first, second)) in [
            (40, 1 << 62, 3 << 62),
            (FEW, fraction(0.3), fraction(0.35)),
            (31, tied, tied + 0x4000_0000),
            (32, 0, CERTAIN),
        ]
        .into_iter()
        .enumerate()
        {
            let mut words = draws(4000 + i as u64);
            let drawn: Vec<[u64; 2]> =
                (0..SAMPLE).map(|_| below_both(&mut words, n, [first, second])).collect();
            assert!(drawn.iter().all(|&[a, b]| a <= b && b <= n));
            for (part, probability) in [(0, first), (1, second), (2, second - first)] {
                let count = |[a, b]: &[u64; 2]| [*a, *b, b - a][part];
                let sample: Vec<u64> = drawn.iter().map(count).collect();
                // For extreme probabilities, an outcome may be missing from 2,000 draws of about 32 words.
                if n as f64 * as_unit(probability) > 1.0 && n as f64 * as_unit(probability) < n as f64 - 1.0 {
                    let z = z_score(n, probability, &sample);
                    assert!(z < 4.0, "{n} {first} {second}, part {part}: {z}");
                }
            }
            if i == 3 {
                assert!(drawn.iter().all(|&[a, _]| a == 0));
            }
        }
        // If sixteen bits equal those of both thresholds, the same word is compared with both.
        let mut words = draws(4100);
        let (first, second) = (tied, tied + (1 << 47));
        let (mut between, mut below, mut runs) = (0, 0, 0.0);
        for _ in 0..2_000 {
            let [a, b] = below_both(&mut words, 4096, [first, second]);
            below += a;
            between += b - a;
            runs += 4096.0;
        }
        // Expected: 125 between, with a standard deviation of 11.2.
        let expected = runs * as_unit(second - first);
        assert!((between as f64 - expected).abs() < 4.0 * expected.sqrt(), "{between} {expected}");
        let sigma = (runs * as_unit(first) * (1.0 - as_unit(first))).sqrt();
        assert!((below as f64 - runs * as_unit(first)).abs() < 4.0 * sigma);
    }

    /// All instruction sets of this machine give the same counts void after void, including ties of
    /// sixteen bits, and leave the stream in the same state.
    #[test]
    fn few_trials_are_the_same_with_any_instructions() {
        /// # Safety
        /// The machine supports the instructions of `F`.
        unsafe fn drawn<F: FewTrials>() -> Vec<u64> {
            let (mut words, mut draws, mut all) = (draws(4200), draws(4300), Vec::new());
            // SAFETY: as the caller promises.
            let mut few = unsafe { F::load(&draws) };
            for void in 0..20_000 {
                // Every number of trials, with random thresholds; every seventh pair of thresholds shares
                // its top sixteen bits.
                let (n, first) = (void % (FEW + 1), words.word());
                let second = if void % 7 == 0 { first | 0xffff } else { words.word() };
                let thresholds = [first.min(second), first.max(second)];
                let tops = thresholds.map(|t| (t >> 48) as u16);
                all.extend(few.below_both(&mut draws, n, tops, || thresholds));
            }
            few.store(&mut draws);
            all.extend((0..100).map(|_| draws.word()));
            // A tie at each place of a block, including the first and the last: just counted, and just not
            // counted.
            for place in 0..DRAWS_PER_BLOCK {
                for n in [place, place + 1, DRAWS_PER_BLOCK] {
                    let mut draws = self::draws(4400);
                    let top = draw16(&self::draws(4400).block(), place);
                    let tie = u64::from(top) << 48 | 1 << 40;
                    // SAFETY: as the caller promises.
                    let mut few = unsafe { F::load(&draws) };
                    all.extend(few.below_both(&mut draws, n as u64, [top; 2], || [tie, tie | 1 << 47]));
                    few.store(&mut draws);
                    all.push(draws.word());
                }
            }
            all
        }
        // SAFETY: every machine supports these instructions.
        let wanted = unsafe { drawn::<Portable>() };
        #[cfg(target_arch = "x86_64")]
        {
            use crate::walk::Isa;
            // SAFETY: each is called only if the machine supports it.
            let results = [
                Isa::Avx2.is_available().then(|| unsafe { drawn::<Avx2>() }),
                Isa::Avx512.is_available().then(|| unsafe { drawn::<Avx512>() }),
            ];
            assert!(results.iter().flatten().all(|result| *result == wanted));
        }
        // About 20,000 x 32 draws, each equal to the top of either threshold with probability 2^-15. Two
        // numbers per void, then 100 words, then three numbers per tie.
        assert_eq!(wanted.len(), 40_100 + 3 * 3 * DRAWS_PER_BLOCK);
    }

    /// Draws define the meaning of a seed: a change must not go unnoticed.
    #[test]
    fn draws_are_pinned() {
        let mut words = draws(3000);
        let drawn: Vec<u64> = pairs().into_iter().map(|(n, p)| one(&mut words, n, fraction(p))).collect();
        let mut filled = vec![0; drawn.len()];
        let (n, p): (Vec<u64>, Vec<u64>) = pairs().into_iter().map(|(n, p)| (n, fraction(p))).unzip();
        fill(&mut words, &n, &p, &mut filled);
        let hash = |values: &[u64]| xxhash_rust::xxh3::xxh3_64(bytemuck::cast_slice(values));
        assert_eq!([hash(&drawn), hash(&filled)], [8_762_336_313_446_181_167, 11_408_987_432_313_044_541]);
    }
}
