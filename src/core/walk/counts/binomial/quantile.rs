//! Binomial draws by inversion: one random word per draw, and an exact result for every word.
//!
//! The draw for a uniform `t` is the smallest `k` whose distribution function `F(k)` exceeds `t`. The
//! second-order Cornish-Fisher expansion (E. A. Cornish and R. A. Fisher 1938, doi:10.2307/1400905), with
//! the variance reduced by 1/12 for integers, gives the point where `F` crosses `t` to within
//! [`Row::margin`], which is more than twice its error; the tests check this for all that [`holds`] admits.
//! If the crossing is farther than the margin from the middle between two integers, the nearer integer is
//! the draw. Otherwise, in one draw of a hundred or a thousand, `F` itself decides. So the draw depends only
//! on `F`, not on the expansion. Before `F`, only `+ - * /` and `sqrt` are used, which round the same
//! everywhere.

use crate::stream::LANES;
use std::sync::OnceLock;

/// Minimum variance for which the margin is valid.
const LEAST_VARIANCE: f64 = 6.0;

/// Maximum number of trials, so that `F`, a sum over some standard deviations, stays short.
pub(super) const MOST_TRIALS: u64 = 1 << 32;

const TWO_TO_MINUS_53: f64 = f64::EPSILON / 2.0;

/// Tells if `n` trials with probability `p` can be drawn here.
#[inline(always)]
pub(super) fn holds(n: u64, p: u64) -> bool {
    let row = Row::new(n, p);
    row.holds & (n <= MOST_TRIALS) & (p != CERTAIN)
}

#[inline(always)]
pub(super) fn draw(normal: &Normal, n: u64, p: u64, word: u64) -> u64 {
    let (rare, sure) = propose(normal, n, p, word);
    if sure { turned(n, p, rare) } else { decide(n, p, word) }
}

/// Makes eight draws, with a bit for each that is uncertain: `F` has to decide, or it cannot be drawn here.
///
/// Everything is passed by value: for columns that might overlap, the compiler would not vectorise the draws.
#[inline(always)]
pub(super) fn draw_eight(
    normal: &Normal,
    n: [u64; LANES],
    p: [u64; LANES],
    words: [u64; LANES],
) -> ([u64; LANES], u32) {
    let (mut k, mut open) = ([0; LANES], [0u64; LANES]);
    for l in 0..LANES {
        let (rare, sure) = propose(normal, n[l], p[l], words[l]);
        k[l] = turned(n[l], p[l], rare);
        open[l] = u64::from(!(sure & (n[l] <= MOST_TRIALS) & (p[l] != CERTAIN))) << l;
    }
    (k, open.iter().fold(0, |all, one| all | one) as u32)
}

/// Tail of a word, between 0 and 1/2; true if it is the upper one.
#[inline(always)]
fn tail(word: u64) -> (f64, bool) {
    let upper = word >> 63 == 1;
    let folded = word ^ 0u64.wrapping_sub(word >> 63);
    // 52 bits as a float between 2^52 and 2^53, minus 2^52.
    let whole = f64::from_bits(folded >> 11 | ROUNDER.to_bits()) - ROUNDER;
    ((whole + 0.5) * TWO_TO_MINUS_53, upper)
}

/// Proposed number of the rarer outcome; true if it is certain.
#[inline(always)]
fn propose(normal: &Normal, n: u64, p: u64, word: u64) -> (u64, bool) {
    let row = Row::new(n, p);
    let (t, upper) = tail(word);
    let z = normal.quantile(t.max(FAR));
    let at = row.crossing(if upper { z } else { -z });
    let at = at.max(0.0).min(row.n);
    let k = (at + ROUNDER).to_bits() & MANTISSA;
    let off = at - (f64::from_bits(k | ROUNDER.to_bits()) - ROUNDER);
    (k, row.holds & (t >= FAR) & (off.abs() + row.margin(z) < 0.5))
}

/// Constants of one binomial distribution of the rarer outcome.
#[derive(Clone, Copy)]
struct Row {
    n: f64,
    mean: f64,
    /// Variance minus 1/12: its inverse, its root, and the inverse of the root.
    inverse: f64,
    root: f64,
    inverse_root: f64,
    skew: f64,
    kurtosis: f64,
    holds: bool,
}

impl Row {
    #[inline(always)]
    fn new(n: u64, p: u64) -> Self {
        // Signed conversion is a single instruction; 2^63 - 1 rounds to 2^63.
        let rare = rarer(p) - (rarer(p) >> 63);
        let (n, p) = (n as i64 as f64, rare as i64 as f64 * TWO_TO_MINUS_64);
        let mean = n * p;
        let variance = mean * (1.0 - p);
        let holds = variance >= LEAST_VARIANCE;
        let square = variance.max(LEAST_VARIANCE) - 1.0 / 12.0;
        let (root, inverse) = (square.sqrt(), 1.0 / square);
        let ratio = variance * inverse;
        Self {
            n,
            mean,
            inverse,
            root,
            inverse_root: root * inverse,
            skew: (1.0 - 2.0 * p) * ratio,
            kurtosis: (1.0 - 6.0 * p * (1.0 - p)) * ratio + inverse * (1.0 / 120.0),
            holds,
        }
    }

    /// Approximate point where the distribution function crosses the normal distribution function at `z`,
    /// on a scale where outcome `k` begins at `k - 1/2`.
    #[inline(always)]
    fn crossing(&self, z: f64) -> f64 {
        let zz = z * z;
        let first = self.skew * (1.0 / 6.0) * (zz - 1.0);
        let fourth = self.kurtosis * (1.0 / 24.0) * (zz - 3.0);
        let third = self.skew * self.skew * (1.0 / 36.0) * (2.0 * zz - 5.0);
        self.mean + (self.root * z + (first + self.inverse_root * z * (fourth - third)))
    }

    /// Bound of more than twice the error of the crossing at `z`: of the expansion, the table and rounding.
    #[inline(always)]
    fn margin(&self, z: f64) -> f64 {
        const TABLE: f64 = 1.0 / (1 << 29) as f64;
        const ROUNDING: f64 = 1.0 / (1u64 << 50) as f64;
        let zz = z * z;
        (0.04 + 0.0012 * zz * zz * zz) * self.inverse + (self.root * TABLE + self.mean * ROUNDING)
    }
}

/// Draws by the distribution function itself.
#[cold]
#[inline(never)]
pub(super) fn decide(n: u64, p: u64, word: u64) -> u64 {
    let (t, upper) = tail(word);
    let (rare, common) = (as_unit(rarer(p)), as_unit(rarer(p).wrapping_neg()));
    // The upper tail of one outcome is the lower tail of the other.
    let k = match upper {
        false => least_beyond(t, n as f64, rare, common),
        true => n as f64 - least_beyond(t, n as f64, common, rare),
    };
    turned(n, p, k as u64)
}

/// Smallest `k` whose distribution function exceeds `t <= 1/2`, for `n` trials with probability `p = 1 - q`.
fn least_beyond(t: f64, n: f64, p: f64, q: f64) -> f64 {
    let mean = n * p;
    let z = Normal::table().quantile(t.max(FAR));
    let mut k = (mean - z * (mean * q).sqrt()).round().clamp(0.0, n);
    let mut pmf = libm::exp(ln_probability(n, p, q, k));
    let mut below = distribution(n, p, q, k, pmf);
    // Up to a value that exceeds `t`, then down to the smallest.
    while below <= t && k < n {
        pmf *= (n - k) / (k + 1.0) * (p / q);
        k += 1.0;
        below += pmf;
    }
    while k > 0.0 && below - pmf > t {
        below -= pmf;
        pmf *= k / (n - k + 1.0) * (q / p);
        k -= 1.0;
    }
    k
}

/// Probability of at most `k`, summed downwards from `pmf`, the probability of `k`.
fn distribution(n: f64, p: f64, q: f64, k: f64, pmf: f64) -> f64 {
    let odds = q / p;
    let (mut sum, mut term, mut at) = (pmf, pmf, k);
    while at > 0.0 {
        term *= at / (n - at + 1.0) * odds;
        sum += term;
        if term < sum * 1e-18 {
            break;
        }
        at -= 1.0;
    }
    sum
}

/// 2^52; adding it rounds a smaller float to an integer.
pub(super) const ROUNDER: f64 = 4_503_599_627_370_496.0;
const MANTISSA: u64 = (1 << 52) - 1;

const ONE: u64 = 1023 << 52;

/// Binary logarithm of the number of cells of the quantile table per halving of the tail.
const CELL_BITS: u32 = 5;

/// Number of halvings of the tail covered by the table, from 1/2 on.
const HALVINGS: u64 = 14;

/// Smallest tail of the table, 4 standard deviations out.
const FAR: f64 = 1.0 / 32768.0;

/// Index of the first cell among all floats.
const FIRST_CELL: u64 = (1023 - 1 - HALVINGS) << CELL_BITS;

/// Number of cells, including some that are never used: an index cut to nine bits needs no check.
const CELLS: usize = 512;

/// Cubic polynomials for the normal quantile (distance from the mean) by cells of the tail; the variable
/// runs from 0 to 1 over a cell.
pub(super) struct Normal {
    cells: [[f64; 4]; CELLS],
}

impl Normal {
    pub(crate) fn table() -> &'static Self {
        static TABLE: OnceLock<Box<Normal>> = OnceLock::new();
        TABLE.get_or_init(|| Box::new(Self::new()))
    }

    fn new() -> Self {
        let mut cells = [[0.0; 4]; CELLS];
        for (cell, polynomial) in cells.iter_mut().enumerate().take((HALVINGS as usize) << CELL_BITS) {
            let begin = f64::from_bits((cell as u64 + FIRST_CELL) << (52 - CELL_BITS));
            let end = f64::from_bits((cell as u64 + 1 + FIRST_CELL) << (52 - CELL_BITS));
            *polynomial = cubic(|x| beyond(begin + (end - begin) * x));
        }
        Self { cells }
    }

    /// Distance from the mean at which the tail `t` begins, for `t` from [`FAR`] to 1/2.
    #[inline(always)]
    pub(super) fn quantile(&self, t: f64) -> f64 {
        let bits = t.to_bits();
        let cell = ((bits >> (52 - CELL_BITS)) - FIRST_CELL) as usize % CELLS;
        let along = f64::from_bits((bits << CELL_BITS) & MANTISSA | ONE) - 1.0;
        let [a, b, c, d] = self.cells[cell];
        a + along * (b + along * (c + along * d))
    }
}

/// Cubic through four values of `f` between 0 and 1, at the Chebyshev nodes, which minimise its error.
fn cubic(f: impl Fn(f64) -> f64) -> [f64; 4] {
    let x = [
        -0.923_879_532_511_286_7,
        -0.382_683_432_365_089_8,
        0.382_683_432_365_089_8,
        0.923_879_532_511_286_7,
    ]
    .map(|node| 0.5 + 0.5 * node);
    let y = x.map(f);
    // Divided differences.
    let slope = |a: f64, b: f64, i: usize, j: usize| (b - a) / (x[j] - x[i]);
    let first: [f64; 3] = std::array::from_fn(|i| slope(y[i], y[i + 1], i, i + 1));
    let second: [f64; 2] = std::array::from_fn(|i| slope(first[i], first[i + 1], i, i + 2));
    let third = slope(second[0], second[1], 0, 3);
    let products = [x[0] * x[1], x[0] * x[2] + x[1] * x[2], x[0] * x[1] * x[2]];
    [
        y[0] - first[0] * x[0] + second[0] * products[0] - third * products[2],
        first[0] - second[0] * (x[0] + x[1]) + third * (products[0] + products[1]),
        second[0] - third * (x[0] + x[1] + x[2]),
        third,
    ]
}

fn density(z: f64) -> f64 {
    0.398_942_280_401_432_7 * libm::exp(-0.5 * z * z)
}

/// Distance at which the tail `t <= 1/2` of the normal distribution begins, by Newton's method.
pub(super) fn beyond(t: f64) -> f64 {
    let mut z = 0.0;
    loop {
        // Starts left on a convex function: every step goes right, until rounding ends the iteration.
        let step = (0.5 * libm::erfc(z * std::f64::consts::FRAC_1_SQRT_2) - t) / density(z);
        if step <= 1e-15 * z {
            return z;
        }
        z += step;
    }
}

const HALF_LN_TWO_PI: f64 = 0.918_938_533_204_672_8;

/// `ln k! - ((k + 1/2) ln k - k + ln(2 pi) / 2)`, the error of Stirling's formula; `k` is an integer and
/// at least 1.
fn stirling_error(k: f64) -> f64 {
    if k < 16.0 {
        return libm::lgamma(k + 1.0) - ((k + 0.5) * libm::log(k) - k + HALF_LN_TWO_PI);
    }
    let kk = k * k;
    let tail = 1.0 / 1188.0 / kk;
    (1.0 / 12.0 - (1.0 / 360.0 - (1.0 / 1260.0 - (1.0 / 1680.0 - tail) / kk) / kk) / kk) / k
}

/// Value of `x ln(x / m) + m - x` without cancellation near `x = m`.
fn deviance(x: f64, m: f64) -> f64 {
    let difference = x - m;
    if difference.abs() >= 0.1 * (x + m) {
        return x * libm::log(x / m) + m - x;
    }
    let v = difference / (x + m);
    let mut sum = difference * v;
    let mut power = 2.0 * x * v;
    let mut odd = 1.0;
    loop {
        power *= v * v;
        odd += 2.0;
        let next = sum + power / odd;
        if next == sum {
            return sum;
        }
        sum = next;
    }
}

/// Logarithm of `P(k)` for `n` trials with probability `p`; `q = 1 - p` is passed to full precision. `n`
/// and `k` are integers, `0 <= k <= n` and `0 < p < 1`. By the saddle-point expansion (C. Loader 2000,
/// *Fast and accurate computation of binomial probabilities*): cancelling terms are never formed, so the
/// relative error is about 1e-15 for any `n`.
pub(super) fn ln_probability(n: f64, p: f64, q: f64, k: f64) -> f64 {
    if k == 0.0 {
        return n * libm::log1p(-p);
    }
    if k == n {
        return n * libm::log1p(-q);
    }
    let rest = n - k;
    let errors = stirling_error(n) - stirling_error(k) - stirling_error(rest);
    let exponent = errors - deviance(k, n * p) - deviance(rest, n * q);
    exponent - HALF_LN_TWO_PI - 0.5 * libm::log(k / n * rest)
}

pub(in crate::walk::counts) const CERTAIN: u64 = u64::MAX;

const TWO_TO_MINUS_64: f64 = 1.0 / 18_446_744_073_709_551_616.0;

/// Number of successes, if the rarer outcome was drawn `drawn` times.
#[inline(always)]
pub(super) fn turned(n: u64, p: u64, drawn: u64) -> u64 {
    if p > 1 << 63 { n.wrapping_sub(drawn) } else { drawn }
}

/// Probability of the rarer outcome.
#[inline(always)]
pub(super) fn rarer(p: u64) -> u64 {
    p.min(p.wrapping_neg())
}

/// Fraction of 2^64 as a float; 1 for [`CERTAIN`].
#[inline(always)]
pub(in crate::walk::counts) fn as_unit(p: u64) -> f64 {
    p as f64 * TWO_TO_MINUS_64
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Values of `F(k)` and `1 - F(k)` for all `k` within 4.5 standard deviations, summed from both ends.
    fn distribution_by_sums(n: u64, p: f64, q: f64) -> Vec<(f64, f64, f64)> {
        let (mean, sigma) = (n as f64 * p, (n as f64 * p * q).sqrt());
        let (low, high) =
            ((mean - 12.0 * sigma).max(0.0).floor(), (mean + 14.0 * sigma + 20.0).min(n as f64).floor());
        let count = (high - low) as usize + 1;
        let pmf: Vec<f64> =
            (0..count).map(|i| libm::exp(ln_probability(n as f64, p, q, low + i as f64))).collect();
        let mut above = vec![0.0; count + 1];
        for i in (0..count).rev() {
            above[i] = above[i + 1] + pmf[i];
        }
        let mut below = 0.0;
        let rows = (0..count).map(|i| {
            below += pmf[i];
            (low + i as f64, below, above[i + 1])
        });
        rows.filter(|(k, ..)| (k - mean).abs() < 4.5 * sigma).collect()
    }

    fn rows() -> Vec<(u64, f64)> {
        let probabilities = [0.5, 0.45, 0.4, 0.35, 0.3, 0.25, 0.2, 0.15, 0.1, 0.05, 0.02, 0.005, 5e-4, 1e-6];
        let variances = [1.0, 1.03, 1.1, 1.3, 1.7, 2.5, 5.0, 15.0, 100.0, 1000.0].map(|f| f * LEAST_VARIANCE);
        let row = |p: f64, v: f64| ((v / (p * (1.0 - p))).ceil() as u64, p);
        probabilities.into_iter().flat_map(|p| variances.map(|v| row(p, v))).collect()
    }

    /// At every jump of the distribution function the error of the expansion is less than half of the
    /// margin, and the expansion rises in between. Checked for 140 distributions from the minimum variance
    /// on, to 4.1 standard deviations; the error falls faster with variance than the margin.
    #[test]
    fn the_expansion_keeps_to_half_of_its_margin() {
        let mut jumps = 0;
        for (n, p) in rows() {
            let row = Row::new(n, (p * 18_446_744_073_709_551_616.0) as u64);
            assert!(row.holds);
            for (k, below, above) in distribution_by_sums(n, p, 1.0 - p) {
                let z = if below < 0.5 { -beyond(below) } else { beyond(above) };
                if z.abs() < 4.1 {
                    jumps += 1;
                    let off = (row.crossing(z) - (k + 0.5)).abs();
                    assert!(off < 0.5 * row.margin(z), "n {n} p {p} k {k} z {z}: {off} {}", row.margin(z));
                }
            }
            let rises = |i: i32| row.crossing(f64::from(i + 1) / 100.0) > row.crossing(f64::from(i) / 100.0);
            assert!((-420..420).all(rises), "n {n} p {p}");
        }
        assert!(jumps > 10_000, "{jumps}");
    }

    /// Fast and slow draws agree for every word tested, and both are the smallest `k` beyond it.
    #[test]
    fn the_fast_draw_is_the_exact_one() {
        let normal = Normal::table();
        let (mut fast, mut all) = (0u64, 0u64);
        for (n, p) in rows().into_iter().filter(|&(n, p)| n as f64 * p < 1e4) {
            let sums = distribution_by_sums(n, p, 1.0 - p);
            for p_word in [p, 1.0 - p].map(|p| (p * 18_446_744_073_709_551_616.0) as u64) {
                for i in 0..400u64 {
                    let word = (i << 55 | i << 46 | 0x2aaa_aaaa_aaaa) ^ (i & 1) << 63;
                    let (rare, sure) = propose(normal, n, p_word, word);
                    let exact = decide(n, p_word, word);
                    all += 1;
                    if sure {
                        fast += 1;
                        assert_eq!(turned(n, p_word, rare), exact, "n {n} p {p} word {word:x}");
                    }
                    let (t, upper) = tail(word);
                    let least =
                        sums.iter().find(|(_, below, above)| if upper { *above < t } else { *below > t });
                    let near = (1e-5..0.5).contains(&t).then_some(least).flatten();
                    if let Some(&(k, ..)) = near {
                        assert_eq!(turned(n, p_word, k as u64), exact, "n {n} p {p} word {word:x}");
                    }
                }
            }
        }
        assert!(fast * 100 > all * 97 && fast < all, "{fast} of {all}");
    }

    /// Extreme words give draws within the number of trials.
    #[test]
    fn the_last_words_are_draws_too() {
        for (n, p) in
            [(24, 1 << 63), (30, 1 << 62), (1000, 1 << 57), (MOST_TRIALS, 1 << 40), (MOST_TRIALS, 1 << 63)]
        {
            let ends =
                [0, u64::MAX, 1 << 63, (1 << 63) - 1, 1 << 40].map(|word| draw(Normal::table(), n, p, word));
            assert!(ends.iter().all(|&k| k <= n) && ends[0] <= ends[4] && ends[4] < ends[3] + 1);
            assert!(ends[3] <= ends[2] && ends[2] < ends[1]);
        }
    }

    /// The table agrees with Newton's method, at the ends of every cell and between, to less than half of
    /// what the margin allows.
    #[test]
    fn the_table_is_the_normal_quantile() {
        let normal = Normal::table();
        let mut worst = 0f64;
        for i in 0..(HALVINGS << CELL_BITS) * 8 {
            let t = f64::from_bits((FIRST_CELL << (52 - CELL_BITS)) + (i << (49 - CELL_BITS)) + 12345);
            worst = worst.max((normal.quantile(t) - beyond(t)).abs());
        }
        assert!(worst < 0.5 / (1u64 << 29) as f64, "{worst:e}");
        assert!((beyond(0.5)).abs() < 1e-15 && (beyond(0.158_655_253_931_457_05) - 1.0).abs() < 1e-14);
        assert!((beyond(FAR) - 4.008).abs() < 1e-2);
    }

    /// Compares with products formed term by term, which have about `k` rounding errors.
    #[test]
    fn small_cases_are_products() {
        for (n, p) in [(1u64, 0.3), (7, 0.5), (40, 0.01), (300, 0.37), (1000, 0.499)] {
            let mut sum = 0.0;
            let mut ln = n as f64 * libm::log1p(-p);
            for k in 0..=n {
                let logarithm = ln_probability(n as f64, p, 1.0 - p, k as f64);
                assert!((logarithm - ln).abs() < 1e-9, "{n} {p} {k}: {logarithm} {ln}");
                sum += libm::exp(logarithm);
                ln += libm::log((n - k).max(1) as f64 / (k + 1) as f64 * p / (1.0 - p));
            }
            assert!((sum - 1.0).abs() < 1e-13, "{n} {p}: {sum}");
        }
    }

    /// Adjacent probabilities of huge `n` keep their exact ratio, which a difference of `ln n!` would lose.
    #[test]
    fn neighbours_of_huge_counts_keep_their_ratio() {
        for n in [1e6f64, 1e9, 1e12, 1e15] {
            let (p, q) = (0.25, 0.75);
            let k = n / 4.0 + (n * p * q).sqrt().floor();
            let ratio = ln_probability(n, p, q, k + 1.0) - ln_probability(n, p, q, k);
            let expected = libm::log1p(((n - k) * p - (k + 1.0) * q) / ((k + 1.0) * q));
            assert!((ratio - expected).abs() < 1e-13 + 1e-6 * expected.abs(), "{n}: {ratio} {expected}");
        }
    }
}
