//! Intervals of standard deviations and of shares.

/// A 95 % interval.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Interval {
    /// Lower end.
    pub low: f64,
    /// Upper end.
    pub high: f64,
}

/// A standard deviation and its interval.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SdEstimate {
    /// Standard deviation.
    pub sd: f64,
    /// Its 95 % interval.
    pub interval: Interval,
}

/// The 97.5 % point of the normal distribution.
const Z: f64 = 1.959_963_984_540_054;

/// Chi squared over its degrees of freedom at the normal point `z` (Wilson and Hilferty; its lower points are
/// up to 8 % low at 4 degrees, 1 % at 10, so that intervals are somewhat wide).
fn chi_squared_over(degrees: f64, z: f64) -> f64 {
    let a = 2.0 / (9.0 * degrees);
    let root = 1.0 - a + z * a.sqrt();
    // Below: where the approximation has no root left.
    (root * root * root).max(1e-3)
}

/// The standard deviation of independent normal values, with the 95 % interval of chi squared; about
/// `known_mean` where it is given, about the mean of the values otherwise.
///
/// # Panics
/// With fewer than two values, one where the mean is known.
pub fn sd_estimate(values: &[f64], known_mean: Option<f64>) -> SdEstimate {
    let n = values.len() as f64;
    let degrees = if known_mean.is_some() { n } else { n - 1.0 };
    assert!(degrees >= 1.0, "a standard deviation of one value");
    let mean = known_mean.unwrap_or_else(|| values.iter().sum::<f64>() / n);
    let squares: f64 = values.iter().map(|v| (v - mean) * (v - mean)).sum();
    let sd = (squares / degrees).sqrt();
    let bound = |z: f64| sd / chi_squared_over(degrees, z).sqrt();
    SdEstimate { sd, interval: Interval { low: bound(Z), high: bound(-Z) } }
}

/// The figure of merit, `1 / (error^2 time)`; `None` without an error or a time.
pub fn merit(error: f64, core_seconds: f64) -> Option<f64> {
    let merit = 1.0 / (error * error * core_seconds);
    merit.is_finite().then_some(merit)
}

/// Wilson's 95 % interval of a share seen in `trials`.
pub fn wilson(share: f64, trials: f64) -> Interval {
    let z2 = Z * Z / trials;
    let centre = (share + 0.5 * z2) / (1.0 + z2);
    let half = Z * (share * (1.0 - share) / trials + 0.25 * z2 / trials).sqrt() / (1.0 + z2);
    Interval { low: (centre - half).max(0.0), high: (centre + half).min(1.0) }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Chi squared of the tables: 2.5 % and 97.5 % points of 4, 10 and 30 degrees.
    #[test]
    fn chi_squared_points_are_those_of_the_tables() {
        for (degrees, low, high, error) in
            [(4.0, 0.484, 11.143, 0.08), (10.0, 3.247, 20.483, 0.01), (30.0, 16.791, 46.979, 0.01)]
        {
            let lower = chi_squared_over(degrees, -Z) * degrees / low - 1.0;
            assert!((-error..0.01).contains(&lower), "{degrees}: {lower}");
            assert!((chi_squared_over(degrees, Z) * degrees / high - 1.0).abs() < 0.01, "{degrees}");
        }
    }

    #[test]
    fn a_standard_deviation_by_hand() {
        let of = sd_estimate(&[1.0, 2.0, 3.0, 4.0, 5.0], None);
        assert!((of.sd - 2.5f64.sqrt()).abs() < 1e-12);
        assert!((of.interval.low - of.sd / (11.143f64 / 4.0).sqrt()).abs() < 0.01);
        assert!((sd_estimate(&[3.0, 4.0], Some(0.0)).sd - 12.5f64.sqrt()).abs() < 1e-12);
    }

    /// Wilson's interval of 0 of 10 and of 5 of 10.
    #[test]
    fn a_share_has_the_interval_of_wilson() {
        let none = wilson(0.0, 10.0);
        assert!(none.low == 0.0 && (none.high - 0.2775).abs() < 1e-3, "{none:?}");
        let half = wilson(0.5, 10.0);
        assert!((half.low - 0.2366).abs() < 1e-3 && (half.high - 0.7634).abs() < 1e-3, "{half:?}");
    }
}
