//! Student's t.

use std::f64::consts::{FRAC_2_PI, FRAC_PI_2};

/// The `t` beyond which at most `error` of Student's distribution lies, both tails together: the factor of a
/// two-sided interval at level `1 - error`.
///
/// Uses the finite sums of Abramowitz and Stegun 26.7.3 and 26.7.4, solved for the angle `atan(t /
/// sqrt(degrees))`. Good to about 1e-13 / `error`, relative.
///
/// # Panics
/// Panics without a degree of freedom, or if `error` does not lie between 0 and 1.
pub fn two_sided(degrees: u64, error: f64) -> f64 {
    assert!(degrees > 0 && error > 0.0 && error < 1.0, "{degrees} degrees of freedom, error {error}");
    // The false position (Illinois): the excess falls from 1 - error to -error as the angle rises.
    let (mut low, mut high) = ((0.0, 1.0 - error), (FRAC_PI_2, -error));
    let (mut before, mut was_below) = (0.0, None);
    let mut tries = 0;
    loop {
        tries += 1;
        let angle = (low.0 * high.1 - high.0 * low.1) / (high.1 - low.1);
        let excess = 1.0 - within(degrees, angle) - error;
        if excess == 0.0 || (angle - before).abs() <= 4e-16 * angle || tries == 100 {
            return (degrees as f64).sqrt() * libm::tan(angle);
        }
        let is_below = excess > 0.0;
        let again = if was_below == Some(is_below) { 0.5 } else { 1.0 };
        if is_below {
            (low, high.1) = ((angle, excess), again * high.1);
        } else {
            (high, low.1) = ((angle, excess), again * low.1);
        }
        (before, was_below) = (angle, Some(is_below));
    }
}

/// The share of Student's distribution between `-t` and `t`, with `t = sqrt(degrees) tan(angle)`.
fn within(degrees: u64, angle: f64) -> f64 {
    let (sine, cosine) = (libm::sin(angle), libm::cos(angle));
    let odd = degrees % 2 == 1;
    // Terms cos^k, each from the one before: k = 1, 3, .. or 0, 2, ..
    let (mut term, mut k) = if odd { (cosine, 2) } else { (1.0, 1) };
    let mut sum = if degrees == 1 { 0.0 } else { term };
    while k + 1 < degrees {
        term *= k as f64 / (k + 1) as f64 * cosine * cosine;
        sum += term;
        k += 2;
    }
    if odd { FRAC_2_PI * (angle + sine * sum) } else { sine * sum }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn points_are_those_of_the_tables() {
        let tables = [
            (1, 0.05, 12.706_204_736),
            (2, 0.05, 4.302_652_730),
            (3, 0.01, 5.840_909_310),
            (9, 0.05, 2.262_157_163),
            (10, 0.001, 4.586_893_859),
            (30, 0.05, 2.042_272_456),
            (60, 0.05, 2.000_297_822),
            (120, 0.001, 3.373_453_763),
            (1000, 0.05, 1.962_339_081),
            (100_000, 0.05, 1.959_987_7),
        ];
        for (degrees, error, t) in tables {
            let actual = two_sided(degrees, error);
            assert!((actual / t - 1.0).abs() < 2e-8, "{degrees}, {error}: {actual}, expected {t}");
        }
    }

    /// With one degree of freedom the tail beyond t is nearly 2 / (pi t).
    #[test]
    fn small_errors_are_far_out() {
        assert!((two_sided(1, 1e-9) / (FRAC_2_PI * 1e9) - 1.0).abs() < 1e-5);
        assert!(two_sided(9, 1e-6) > two_sided(9, 1e-5));
    }
}
