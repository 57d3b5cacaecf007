//! Mean, standard deviation and interval over replicates.

use super::record::Statistic;
use super::student;
use voidwalk_practice::quantity::{Span, percent};

impl Statistic {
    /// Mean, sample standard deviation and 95 % interval of the mean (Student's t) of independent values.
    ///
    /// One value has neither a standard deviation nor an interval. For values between 0 and 1 see
    /// [`Statistic::of_fraction`].
    ///
    /// # Panics
    /// Panics if there is no value.
    ///
    /// ```
    /// use voidwalk_app::outcome::record::Statistic;
    /// let eroded = Statistic::of(&[0.10, 0.12, 0.14]);
    /// assert!((eroded.mean - 0.12).abs() < 1e-12 && (eroded.sd.unwrap() - 0.02).abs() < 1e-12);
    /// // Student's t with 2 degrees of freedom: 0.12 -+ 4.303 * 0.02 / sqrt(3).
    /// assert!((eroded.low.unwrap() - 0.0703).abs() < 1e-4 && (eroded.high.unwrap() - 0.1697).abs() < 1e-4);
    /// assert_eq!(Statistic::of(&[0.1]).sd, None);
    /// ```
    pub fn of(values: &[f64]) -> Self {
        Self::with_error(values, 0.05)
    }

    /// Mean, sample standard deviation and the interval of the mean at confidence level `1 - error`.
    ///
    /// # Panics
    /// Panics if there is no value, or if `error` does not lie between 0 and 1.
    pub fn with_error(values: &[f64], error: f64) -> Self {
        assert!(!values.is_empty(), "a mean of nothing");
        let n = values.len() as f64;
        let mean = values.iter().sum::<f64>() / n;
        if values.len() == 1 {
            return Self { mean, sd: None, low: None, high: None };
        }
        let squares: f64 = values.iter().map(|v| (v - mean) * (v - mean)).sum();
        let sd = (squares / (n - 1.0)).sqrt();
        let half = student::two_sided(values.len() as u64 - 1, error) * sd / n.sqrt();
        Self { mean, sd: Some(sd), low: Some(mean - half), high: Some(mean + half) }
    }

    /// [`Statistic::of`] for a quantity that lies between 0 and 1: the 95 % interval is cut to that range.
    ///
    /// # Panics
    /// Panics if there is no value.
    pub fn of_fraction(values: &[f64]) -> Self {
        let whole = Self::of(values);
        Self { low: whole.low.map(|l| l.max(0.0)), high: whole.high.map(|h| h.min(1.0)), ..whole }
    }
}

/// The 95 % interval of a fraction, limited to 0 and 1, if there is one.
pub fn interval(statistic: &Statistic) -> Option<(f64, f64)> {
    Some((statistic.low?.clamp(0.0, 1.0), statistic.high?.clamp(0.0, 1.0)))
}

/// The 95 % interval of a fraction, in percent.
pub fn interval_in_percent(statistic: &Statistic) -> Option<(f64, f64)> {
    interval(statistic).map(|(low, high)| (100.0 * low, 100.0 * high))
}

/// The 95 % interval of a fraction, in percent, as text.
pub fn percent_interval(statistic: &Statistic) -> Option<Span> {
    interval(statistic).map(|(low, high)| percent(low).to(percent(high)))
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
}
