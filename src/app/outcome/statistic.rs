//! Mean, standard deviation and interval over replicates; Student's t; straight lines by least squares.

use super::record::Statistic;
use std::f64::consts::{FRAC_2_PI, FRAC_PI_2};
use voidwalk_practice::quantity::{Span, percent};

impl Statistic {
    /// Mean, sample standard deviation and 95 % interval of the mean (Student's t) of independent values.
    ///
    /// One value has neither standard deviation nor interval. For values between 0 and 1 see
    /// `Statistic::of_fraction`.
    ///
    /// # Panics
    /// Panics if there is no value.
    pub fn of(values: &[f64]) -> Self {
        Self::with_error(values, 0.05)
    }

    /// Mean, sample standard deviation and the interval of the mean at confidence level `1 - error`.
    ///
    /// # Panics
    /// Panics if there is no value, or if `error` does not lie between 0 and 1.
    pub(crate) fn with_error(values: &[f64], error: f64) -> Self {
        assert!(!values.is_empty(), "a mean of nothing");
        let n = values.len() as f64;
        let mean = values.iter().sum::<f64>() / n;
        if values.len() == 1 {
            return Self { mean, sd: None, low: None, high: None };
        }
        let squares: f64 = values.iter().map(|v| (v - mean) * (v - mean)).sum();
        let sd = (squares / (n - 1.0)).sqrt();
        let half = two_sided(values.len() as u64 - 1, error) * sd / n.sqrt();
        Self { mean, sd: Some(sd), low: Some(mean - half), high: Some(mean + half) }
    }

    /// Statistic of a quantity between 0 and 1: as [`Statistic::of`], with the interval cut to that range.
    ///
    /// # Panics
    /// Panics if there is no value.
    pub(crate) fn of_fraction(values: &[f64]) -> Self {
        let whole = Self::of(values);
        Self { low: whole.low.map(|l| l.max(0.0)), high: whole.high.map(|h| h.min(1.0)), ..whole }
    }
}

/// The 95 % interval of a fraction, limited to 0 and 1, if there is one.
pub(crate) fn interval(statistic: &Statistic) -> Option<(f64, f64)> {
    Some((statistic.low?.clamp(0.0, 1.0), statistic.high?.clamp(0.0, 1.0)))
}

/// The 95 % interval of a fraction, in percent.
pub(crate) fn interval_in_percent(statistic: &Statistic) -> Option<(f64, f64)> {
    interval(statistic).map(|(low, high)| (100.0 * low, 100.0 * high))
}

/// The 95 % interval of a fraction, in percent, as text.
pub(crate) fn percent_interval(statistic: &Statistic) -> Option<Span> {
    interval(statistic).map(|(low, high)| percent(low).to(percent(high)))
}

/// Value `t` that Student's distribution exceeds with probability `error`, both tails together: the
/// factor of a two-sided interval at level `1 - error`.
///
/// Uses the finite sums of Abramowitz and Stegun 26.7.3 and 26.7.4, solved for the angle `atan(t /
/// sqrt(degrees))`. Relative error about 1e-13 / `error`.
///
/// # Panics
/// Panics without a degree of freedom, or if `error` does not lie between 0 and 1.
pub(crate) fn two_sided(degrees: u64, error: f64) -> f64 {
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

/// Fraction of Student's distribution between `-t` and `t`, with `t = sqrt(degrees) tan(angle)`.
fn within(degrees: u64, angle: f64) -> f64 {
    let (sine, cosine) = (libm::sin(angle), libm::cos(angle));
    let odd = degrees % 2 == 1;
    // Terms cos^k, each from the previous one: k = 1, 3, .. or 0, 2, ..
    let (mut term, mut k) = if odd { (cosine, 2) } else { (1.0, 1) };
    let mut sum = if degrees == 1 { 0.0 } else { term };
    while k + 1 < degrees {
        term *= k as f64 / (k + 1) as f64 * cosine * cosine;
        sum += term;
        k += 2;
    }
    if odd { FRAC_2_PI * (angle + sine * sum) } else { sine * sum }
}

/// Straight line by weighted least squares.
pub(crate) struct Straight {
    pub(crate) offset: f64,
    pub(crate) slope: f64,
    /// Standard error of the offset.
    pub(crate) offset_error: f64,
    /// Sum of squared deviations, each over its standard error.
    pub(crate) chi_squared: f64,
}

impl Straight {
    /// Fits a line through `(x, y, standard error of y)`.
    pub(crate) fn through(rows: &[(f64, f64, f64)]) -> Self {
        let sum = |term: &dyn Fn(f64, f64) -> f64| -> f64 {
            rows.iter().map(|&(x, y, error)| term(x, y) / (error * error)).sum()
        };
        let w = sum(&|_, _| 1.0);
        let (x, y) = (sum(&|x, _| x) / w, sum(&|_, y| y) / w);
        let xx = sum(&|xi, _| (xi - x) * (xi - x));
        let slope = sum(&|xi, yi| (xi - x) * (yi - y)) / xx;
        let offset = y - slope * x;
        let chi_squared = sum(&|xi, yi| (yi - offset - slope * xi) * (yi - offset - slope * xi));
        Self { offset, slope, offset_error: (1.0 / w + x * x / xx).sqrt(), chi_squared }
    }
}

/// Slope of ln(y) against ln(x) through points with positive coordinates and equal weights.
pub(crate) fn log_log_slope(points: impl ExactSizeIterator<Item = (f64, f64)> + Clone) -> f64 {
    let n = points.len() as f64;
    let logs = || points.clone().map(|(x, y)| (libm::log(x), libm::log(y)));
    let (x, y) = (logs().map(|(x, _)| x).sum::<f64>() / n, logs().map(|(_, y)| y).sum::<f64>() / n);
    let xy: f64 = logs().map(|(xi, yi)| (xi - x) * (yi - y)).sum();
    xy / logs().map(|(xi, _)| (xi - x) * (xi - x)).sum::<f64>()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_interval_by_hand() {
        let s = Statistic::of(&[1.0, 2.0, 3.0]);
        assert_eq!((s.mean, s.sd), (2.0, Some(1.0)));
        assert!((s.high.unwrap() - (2.0 + 4.302_652_730 / 3f64.sqrt())).abs() < 1e-9);
        assert_eq!(Statistic::of(&[5.0]).sd, None);
        assert_eq!(Statistic::of_fraction(&[0.0, 0.1]).low, Some(0.0));
    }

    /// 4,000 samples of ten normal values: a nominal 95 % interval covers 95 +- 1 %. A true coverage
    /// between about 94 % and 96 % would pass.
    #[test]
    fn intervals_cover() {
        use rand::Rng;
        use voidwalk_core::stream::{Key, Purpose, unit};
        let mut draws =
            Key { seed: 3, purpose: Purpose::Resampling, run: 0, increment: 0, chunk: 0 }.generator();
        let mut normal = || {
            let (u, v) = (unit(draws.next_u64()), unit(draws.next_u64()));
            (-2.0 * libm::log(u)).sqrt() * libm::cos(std::f64::consts::TAU * v)
        };
        let covered = (0..4000).filter(|_| {
            let s = Statistic::of(&std::array::from_fn::<f64, 10, _>(|_| normal()));
            s.low.unwrap() <= 0.0 && 0.0 <= s.high.unwrap()
        });
        let share = covered.count() as f64 / 4000.0;
        assert!((0.94..0.96).contains(&share), "{share}");
    }

    #[test]
    fn an_interval_stays_between_nothing_and_all() {
        let statistic = Statistic { mean: 0.01, sd: Some(0.02), low: Some(-0.004), high: Some(0.024) };
        assert_eq!(percent_interval(&statistic).unwrap().to_string(), "0.0 to 2.40\u{202f}%");
        assert_eq!(percent_interval(&Statistic { low: None, ..statistic }), None);
        let nothing = Statistic { mean: 1e-5, sd: None, low: Some(5e-6), high: Some(2e-5) };
        assert_eq!(percent_interval(&nothing).unwrap().to_string(), "<0.01\u{202f}%");
    }

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
        // With one degree of freedom the tail beyond t is nearly 2 / (pi t).
        assert!((two_sided(1, 1e-9) / (FRAC_2_PI * 1e9) - 1.0).abs() < 1e-5);
        assert!(two_sided(9, 1e-6) > two_sided(9, 1e-5));
    }
}
