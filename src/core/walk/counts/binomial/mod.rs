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
mod quantile;

use crate::stream::{LANES, unit};
#[cfg(target_arch = "x86_64")]
pub(super) use draws::{Avx2, Avx512};
pub(super) use draws::{Draws, FewTrials, Portable};
use draws::{below_both, by_bits};
pub(super) use quantile::{CERTAIN, as_unit};
use quantile::{ROUNDER, ln_probability, rarer, turned};

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

/// Below this mean (of the rarer outcome) rejection does not hold.
const LEAST_MEAN: f64 = 10.0;

/// Constants of Hoermann's BTRS: within this of 0, `u` may be accepted by `v` alone.
const QUICK_U: f64 = 0.07;

/// Transformed rejection for one pair with `p <= 1/2`, `n p >= 10` (BTRS; W. Hoermann 1993,
/// doi:10.1080/00949659308811496), for counts too large for anything else: most draws are accepted by a
/// squeeze, the others by their exact probability.
#[derive(Clone, Copy)]
struct Hat {
    pub n: f64,
    pub p: f64,
    q: f64,
    mean: f64,
    sigma: f64,
    a: f64,
    pub b: f64,
}

impl Hat {
    pub fn new(n: u64, p: u64) -> Self {
        let (n, p, q) = (n as f64, as_unit(rarer(p)), as_unit(rarer(p).wrapping_neg()));
        let mean = n * p;
        let sigma = (mean * q).sqrt();
        let b = 1.15 + 2.53 * sigma;
        Self { n, p, q, mean, sigma, a: -0.0873 + 0.0248 * b + 0.01 * p, b }
    }

    pub fn draw(&self, draws: &mut Draws) -> u64 {
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

    pub fn propose(&self, u: f64) -> f64 {
        let us = 0.5 - u.abs();
        (2.0 * self.a / us + self.b) * u + self.mean
    }

    /// Factor of `v` before it is compared with the probability of the proposal over the probability of the
    /// mode.
    pub fn scale(&self, u: f64) -> f64 {
        let us = 0.5 - u.abs();
        let square = us * us;
        (2.83 * self.b + 5.1) * self.sigma * square / (self.b * (self.a + self.b * square))
    }

    /// Logarithm of the probability of `k` over the probability of the mode.
    pub fn ln_ratio(&self, k: f64) -> f64 {
        // The likeliest outcome, or another as likely.
        let mode = whole((self.n + 1.0) * self.p - 0.5);
        ln_probability(self.n, self.p, self.q, k) - ln_probability(self.n, self.p, self.q, mode)
    }
}

/// The nearest whole number, for 0 or more and below 2^51: `floor(x + 1/2)` but for ties.
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

    /// `p` as a 64-bit fraction.
    fn fraction(p: f64) -> u64 {
        (p * 18_446_744_073_709_551_616.0) as u64
    }

    /// Chi-square over its degrees of freedom, as a z score (Wilson and Hilferty).
    fn z_of_chi_square(square: f64, freedom: f64) -> f64 {
        let part = 2.0 / (9.0 * freedom);
        (libm::cbrt(square / freedom) - (1.0 - part)) / part.sqrt()
    }

    /// About this many cells a test; the more, the finer a fault that shows and the weaker it shows.
    const CELLS: f64 = 24.0;

    /// Draws from Binomial(n, p) against its exact probabilities in cells about a quarter of a standard
    /// deviation wide.
    ///
    /// Above a million trials a cell's probability is summed over `k` in steps, which the density is smooth
    /// enough for.
    fn z_score(n: u64, p: u64, sample: &[u64]) -> f64 {
        let (probability, q) = (as_unit(p), as_unit(p.wrapping_neg()));
        let mean = n as f64 * probability;
        let sigma = (mean * q).sqrt();
        let width = ((6.0 * sigma / CELLS).ceil() as u64).max(1);
        let low = ((mean - 3.0 * sigma).max(0.0)) as u64;
        let cells = ((6.0 * sigma / width as f64).ceil() as usize).max(1);
        // Cell 0 is all below `low`, the last all above.
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
                // The middle of the span, or the mean of the two middle ones.
                expected[c + 1] += span as f64 * 0.5 * (pmf(at + (span - 1) / 2) + pmf(at + span / 2));
                at += span;
            }
        }
        // Below: sums down from `low` until nothing is left to add; above is the rest.
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
        // Neighbouring cells join until each expects eight draws.
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

    /// Pairs that use every method, the switches between them, and counts past 1e12.
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

    /// Both ways to draw. 70 tests, bound 4 on each: a false alarm in 0.2 % of seeds, and this seed is fixed.
    /// With 20,000 draws a shift of 4 % of a standard deviation, or 4 % in its size, would show; less would
    /// not.
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

    /// The test above sees one success too many, a wrong n by one, and a probability off by a little.
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
        // A trial too few moves the mean by p, which 20,000 draws show up to n of about 50.
        assert!(caught(7, 0.4, &|w, n, p| one(w, n - 1, p)));
        assert!(caught(33, 0.7, &|w, n, p| one(w, n - 1, p)));
        // One too many is 3 % of a standard deviation for n = 3750: half of one in each draw's rounding is
        // not seen, this is.
        assert!(caught(500, 0.3, &|w, n, p| one(w, n, p) + 1));
        assert!(caught(1_000_000_000_000, 0.3, &|w, n, p| one(w, n, p - (1 << 45))));
    }

    /// Impossible and certain outcomes never depend on a draw.
    #[test]
    fn never_and_always_are_exact() {
        let mut words = draws(2000);
        for n in [0, 1, 31, FEW, FEW + 1, 5_000, 1_000_000_000_000, LARGEST + 1] {
            assert_eq!((one(&mut words, n, 0), one(&mut words, n, CERTAIN)), (0, n));
        }
        let mut k = [7; 3];
        fill(&mut words, &[0, 9, 9_000_000], &[1 << 63, 0, CERTAIN], &mut k);
        assert_eq!(k, [0, 0, 9_000_000]);
        // The smallest and the largest probability that are neither.
        assert_eq!(one(&mut words, 1_000_000, 1), 0);
        assert_eq!(one(&mut words, 1_000_000, CERTAIN - 1), 1_000_000);
    }

    /// BTRS is exact only if the squeeze lies below, and 1 above, what the exact test accepts: for every `u`
    /// the largest acceptable `v` is at least the squeeze's where that is used, and at most 1. Scanned at
    /// 4,000 values of `u` for each of some 60 pairs.
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

    /// Both counts of one call against the joint distribution of three outcomes, ties of sixteen bits
    /// included: the thresholds share their top sixteen bits in two cases. Each of the three numbers, and so
    /// their dependence, is binomial. Bound 4 on 12 tests; what shows is as above.
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
                // The few outcomes that are possible here may all be missing in 2,000 draws of some 32 words.
                if n as f64 * as_unit(probability) > 1.0 && n as f64 * as_unit(probability) < n as f64 - 1.0 {
                    let z = z_score(n, probability, &sample);
                    assert!(z < 4.0, "{n} {first} {second}, part {part}: {z}");
                }
            }
            if i == 3 {
                assert!(drawn.iter().all(|&[a, _]| a == 0));
            }
        }
        // Where sixteen bits are equal to both thresholds', the same word is compared with both.
        let mut words = draws(4100);
        let (first, second) = (tied, tied + (1 << 47));
        let (mut between, mut below, mut runs) = (0, 0, 0.0);
        for _ in 0..2_000 {
            let [a, b] = below_both(&mut words, 4096, [first, second]);
            below += a;
            between += b - a;
            runs += 4096.0;
        }
        // Expected: 125 between, and their standard deviation 11.2.
        let expected = runs * as_unit(second - first);
        assert!((between as f64 - expected).abs() < 4.0 * expected.sqrt(), "{between} {expected}");
        let sigma = (runs * as_unit(first) * (1.0 - as_unit(first))).sqrt();
        assert!((below as f64 - runs * as_unit(first)).abs() < 4.0 * sigma);
    }

    /// With the instructions of every machine that this one can be: the same counts void after void, ties of
    /// sixteen bits among them, and the same stream afterwards.
    #[test]
    fn few_trials_are_the_same_with_any_instructions() {
        /// # Safety
        /// The machine has the instructions of `F`.
        unsafe fn drawn<F: FewTrials>() -> Vec<u64> {
            let (mut words, mut draws, mut all) = (draws(4200), draws(4300), Vec::new());
            // SAFETY: as promised.
            let mut few = unsafe { F::begin(&draws) };
            for void in 0..20_000 {
                // Every number of trials, and thresholds; every seventh pair of these shares its top sixteen
                // bits.
                let (n, first) = (void % (FEW + 1), words.word());
                let second = if void % 7 == 0 { first | 0xffff } else { words.word() };
                let thresholds = [first.min(second), first.max(second)];
                let tops = thresholds.map(|t| (t >> 48) as u16);
                all.extend(few.below_both(&mut draws, n, tops, || thresholds));
            }
            few.end(&mut draws);
            all.extend((0..100).map(|_| draws.word()));
            // A tie at each place of a block, the first and the last among them: counted, and just not.
            for place in 0..DRAWS_PER_BLOCK {
                for n in [place, place + 1, DRAWS_PER_BLOCK] {
                    let mut draws = self::draws(4400);
                    let top = draw16(&self::draws(4400).block(), place);
                    let tie = u64::from(top) << 48 | 1 << 40;
                    // SAFETY: as promised.
                    let mut few = unsafe { F::begin(&draws) };
                    all.extend(few.below_both(&mut draws, n as u64, [top; 2], || [tie, tie | 1 << 47]));
                    few.end(&mut draws);
                    all.push(draws.word());
                }
            }
            all
        }
        // SAFETY: it has what every machine has.
        let wanted = unsafe { drawn::<Portable>() };
        #[cfg(target_arch = "x86_64")]
        {
            use crate::walk::Isa;
            // SAFETY: each is called where the machine has it.
            let results = [
                Isa::Avx2.is_available().then(|| unsafe { drawn::<Avx2>() }),
                Isa::Avx512.is_available().then(|| unsafe { drawn::<Avx512>() }),
            ];
            assert!(results.iter().flatten().all(|result| *result == wanted));
        }
        // Some 20,000 x 32 draws, each equal to either threshold's top with 2^-15. Two numbers a void, 100
        // words after them, three numbers for each tie.
        assert_eq!(wanted.len(), 40_100 + 3 * 3 * DRAWS_PER_BLOCK);
    }

    /// Draws are part of the meaning of a seed: these may not change unnoticed.
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
