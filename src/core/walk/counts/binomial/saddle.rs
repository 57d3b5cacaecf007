//! Binomial probabilities to full precision, by the saddle-point expansion.
//!
//! C. Loader (2000), *Fast and accurate computation of binomial probabilities*: the terms that cancel are
//! never formed, so the logarithm is good to about 1e-15 of what matters however large `n` is.

/// Half of `ln(2 pi)`.
const HALF_LN_TWO_PI: f64 = 0.918_938_533_204_672_8;

/// `ln k! - ((k + 1/2) ln k - k + ln(2 pi) / 2)`, the error of Stirling's formula; `k` is whole and at least
/// 1.
fn stirling_error(k: f64) -> f64 {
    if k < 16.0 {
        return libm::lgamma(k + 1.0) - ((k + 0.5) * libm::log(k) - k + HALF_LN_TWO_PI);
    }
    let kk = k * k;
    let tail = 1.0 / 1188.0 / kk;
    (1.0 / 12.0 - (1.0 / 360.0 - (1.0 / 1260.0 - (1.0 / 1680.0 - tail) / kk) / kk) / kk) / k
}

/// `x ln(x / m) + m - x` without cancellation near `x = m`.
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

/// `ln P(k)` of `n` trials with probability `p`, where `q = 1 - p` is handed over to full precision; all of
/// `n`, `k` are whole, `0 <= k <= n` and `0 < p < 1`.
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

#[cfg(test)]
mod tests {
    use super::*;

    /// Against products formed term by term, which lose about `k` roundings.
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

    /// Neighbouring probabilities of huge `n` keep their exact ratio, which a difference of `ln n!` would
    /// lose.
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
