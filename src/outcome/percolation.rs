//! A study of the percolation threshold against the size of the lattice (paper, Fig. 6): what
//! `percolation.json` holds, and how thresholds are put together.
//!
//! # Finite size
//! Two finite-size relations are fitted to the mean threshold p(L) of an L x L x L lattice, by weighted least
//! squares:
//!
//! - *One length*: `p(L) = p - a L^(-1/nu)`, with the exponent of the correlation length along the flow.
//! - *Many starts*: the start layer holds of order `(L / xi_across)^2` independent starts, and each survives
//!   L layers with a probability that falls as `exp(-L / xi_along)`; so `L / xi_along` grows with the
//!   logarithm of their number. With `d = p - p(L)`, `xi_along = d^(-nu)` and `xi_across = d^(-nu / z)`: `L
//!   d^nu = b + c ln(L d^(nu / z))`. The p of the least sum of squares is the threshold; its interval is
//!   where the sum is no more than 1 above that.
//!
//! Exponents are those of directed percolation in 2 + 1 dimensions, which this lattice is (two across the
//! flow, one along it): `nu` = 1.295(6) (Hinrichsen, Adv. Phys. 49, 815, 2000) and `z` = 1.766. (1.105
//! belongs to 3 + 1 dimensions.)

use serde::{Deserialize, Serialize};

use super::least_squares::{Straight, log_log_slope};
use super::record::Statistic;

/// Threshold of the infinite lattice: directed bond percolation on the simple cubic lattice.
pub const INFINITE_LATTICE: f64 = 0.38222;

/// Exponent of the correlation length along the flow, directed percolation in 2 + 1 dimensions (Hinrichsen
/// 2000).
pub const NU_PARALLEL: f64 = 1.295;

/// Ratio of the exponents along and across the flow, directed percolation in 2 + 1 dimensions.
pub const Z: f64 = 1.766;

/// The whole of `percolation.json`.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct PercolationStudy {
    /// Version of voidwalk.
    pub version: String,
    /// The user's seed.
    pub seed: u64,
    /// Realisations of each size.
    pub realisations: u64,
    /// One per size, ascending.
    pub sizes: Vec<SizeThreshold>,
    /// The relation of one length; `None` with fewer than two sizes or realisations.
    pub one_length: Option<OneLength>,
    /// The relation of many starts; `None` with fewer than four sizes, or where no threshold fits.
    pub many_starts: Option<ManyStarts>,
    /// Slope of ln(standard deviation) against ln(size); `None` as for `one_length`.
    pub sd_exponent: Option<f64>,
    /// [`INFINITE_LATTICE`].
    pub infinite_lattice: f64,
    /// Wall time, s.
    pub seconds: f64,
}

/// The thresholds of one size.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct SizeThreshold {
    /// Voids along each side.
    pub size: u64,
    /// Share of constrictions that is open at the threshold.
    pub threshold: Statistic,
    /// Standard error of the standard deviation, for normal thresholds: sd / sqrt(2 (n - 1)).
    pub sd_error: Option<f64>,
}

/// A fit of `p(L) = threshold - amplitude L^(-1 / NU_PARALLEL)`.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct OneLength {
    /// Threshold of the infinite lattice.
    pub threshold: f64,
    /// Its standard error, if the relation holds.
    pub threshold_error: f64,
    /// Amplitude.
    pub amplitude: f64,
    /// Sum of squared deviations, each over its standard error.
    pub chi_squared: f64,
    /// Degrees of freedom.
    pub degrees: u64,
}

/// A fit of `L d^nu = offset + slope ln(L d^(nu / z))`, `d = threshold - p(L)`.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct ManyStarts {
    /// Threshold of the infinite lattice.
    pub threshold: f64,
    /// Lower end of its 68 % interval.
    pub threshold_low: f64,
    /// Upper end of its 68 % interval.
    pub threshold_high: f64,
    /// Offset.
    pub offset: f64,
    /// Slope.
    pub slope: f64,
    /// Sum of squared deviations, each over its standard error.
    pub chi_squared: f64,
    /// Degrees of freedom.
    pub degrees: u64,
}

impl PercolationStudy {
    /// Puts the thresholds of each size together: `(size, one threshold per realisation)`, sizes ascending.
    pub fn new(seed: u64, thresholds: &[(u64, Vec<f64>)], seconds: f64) -> Self {
        let sizes: Vec<SizeThreshold> = thresholds.iter().map(|(size, all)| of_size(*size, all)).collect();
        let points: Vec<Point> = sizes.iter().filter_map(|s| Point::of(s, thresholds)).collect();
        let enough = points.len() >= 2;
        Self {
            version: env!("CARGO_PKG_VERSION").into(),
            seed,
            realisations: thresholds.first().map_or(0, |(_, all)| all.len() as u64),
            one_length: enough.then(|| one_length(&points)),
            many_starts: if points.len() >= 4 { many_starts(&points) } else { None },
            sd_exponent: enough
                .then(|| log_log_slope(&points.iter().map(|p| (p.size, p.sd)).collect::<Vec<_>>())),
            sizes,
            infinite_lattice: INFINITE_LATTICE,
            seconds,
        }
    }
}

fn of_size(size: u64, all: &[f64]) -> SizeThreshold {
    let threshold = Statistic::of_fraction(all);
    let sd_error = threshold.sd.map(|sd| sd / (2.0 * (all.len() as f64 - 1.0)).sqrt());
    SizeThreshold { size, threshold, sd_error }
}

/// What a fit reads of a size.
struct Point {
    size: f64,
    mean: f64,
    sd: f64,
    /// Standard error of the mean.
    error: f64,
}

impl Point {
    /// `None` without spread, which leaves no weight.
    fn of(size: &SizeThreshold, thresholds: &[(u64, Vec<f64>)]) -> Option<Self> {
        let count = thresholds.iter().find(|(s, _)| *s == size.size)?.1.len() as f64;
        let sd = size.threshold.sd.filter(|sd| *sd > 0.0)?;
        Some(Self { size: size.size as f64, mean: size.threshold.mean, sd, error: sd / count.sqrt() })
    }
}

fn one_length(points: &[Point]) -> OneLength {
    let row = |p: &Point| (libm::pow(p.size, -1.0 / NU_PARALLEL), p.mean, p.error);
    let line = Straight::through(&points.iter().map(row).collect::<Vec<_>>());
    OneLength {
        threshold: line.offset,
        threshold_error: line.offset_error,
        amplitude: -line.slope,
        chi_squared: line.chi_squared,
        degrees: points.len() as u64 - 2,
    }
}

/// The straight line of many starts for a given threshold above every mean.
fn starts_at(points: &[Point], threshold: f64) -> Straight {
    let row = |p: &Point| {
        let d = threshold - p.mean;
        let y = p.size * libm::pow(d, NU_PARALLEL);
        (libm::log(p.size * libm::pow(d, NU_PARALLEL / Z)), y, NU_PARALLEL * y / d * p.error)
    };
    Straight::through(&points.iter().map(row).collect::<Vec<_>>())
}

/// Tries every threshold above the means in steps of 1e-5; `None` where the best is the last or the first
/// tried.
fn many_starts(points: &[Point]) -> Option<ManyStarts> {
    const STEPS: u32 = 12_000;
    let highest = points.iter().map(|p| p.mean).fold(0.0, f64::max);
    let tried: Vec<(f64, Straight)> = (10..STEPS)
        .map(|step| highest + f64::from(step) * 1e-5)
        .map(|threshold| (threshold, starts_at(points, threshold)))
        .collect();
    let best = (0..tried.len()).min_by(|&a, &b| tried[a].1.chi_squared.total_cmp(&tried[b].1.chi_squared))?;
    if best == 0 || best + 1 == tried.len() {
        return None;
    }
    let (threshold, line) = &tried[best];
    let near = |(_, other): &&(f64, Straight)| other.chi_squared <= line.chi_squared + 1.0;
    let low = tried[..=best].iter().rev().take_while(near).last()?.0;
    let high = tried[best..].iter().take_while(near).last()?.0;
    Some(ManyStarts {
        threshold: *threshold,
        threshold_low: low,
        threshold_high: high,
        offset: line.offset,
        slope: line.slope,
        chi_squared: line.chi_squared,
        degrees: points.len() as u64 - 3,
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Thresholds with these means, each with the same small spread.
    fn around(mean: impl Fn(f64) -> f64) -> Vec<(u64, Vec<f64>)> {
        let of = |size: u64| {
            let (mean, off) = (mean(size as f64), 0.01 / size as f64);
            (size, vec![mean - off, mean, mean + off])
        };
        [10, 20, 40, 80, 160].map(of).to_vec()
    }

    #[test]
    fn one_length_is_found_again() {
        let exact = around(|size| 0.38 - 0.3 * libm::pow(size, -1.0 / NU_PARALLEL));
        let study = PercolationStudy::new(1, &exact, 0.0);
        let fit = study.one_length.unwrap();
        assert!((fit.threshold - 0.38).abs() < 1e-12 && (fit.amplitude - 0.3).abs() < 1e-10, "{fit:?}");
        assert!(fit.chi_squared < 1e-12 && fit.degrees == 3);
        assert!((study.sd_exponent.unwrap() + 1.0).abs() < 1e-12);
    }

    #[test]
    fn many_starts_are_found_again() {
        // d by bisection from L d^nu = 0.2 + 0.13 ln(L d^(nu / z)); below the lower bound the logarithm
        // rules.
        let d = |size: f64| {
            let off = |d: f64| {
                let starts = libm::log(size * libm::pow(d, NU_PARALLEL / Z));
                size * libm::pow(d, NU_PARALLEL) - 0.2 - 0.13 * starts
            };
            let (mut low, mut high) = (0.5 * libm::pow(0.2 / size, 1.0 / NU_PARALLEL), 0.3);
            for _ in 0..100 {
                let middle = 0.5 * (low + high);
                if off(middle) < 0.0 { low = middle } else { high = middle }
            }
            low
        };
        let study = PercolationStudy::new(1, &around(|size| 0.382 - d(size)), 0.0);
        let fit = study.many_starts.unwrap();
        assert!((fit.threshold - 0.382).abs() < 2e-5 && fit.chi_squared < 0.01, "{fit:?}");
        assert!((fit.slope - 0.13).abs() < 0.002 && (fit.offset - 0.2).abs() < 0.002, "{fit:?}");
        assert!(fit.threshold_low < 0.382 && fit.threshold_high > 0.382 && fit.degrees == 2);
    }

    #[test]
    fn what_cannot_be_fitted_is_not() {
        let all = around(|size| 0.38 - 1.0 / size);
        let one = PercolationStudy::new(1, &all[..1], 0.0);
        assert!(one.one_length.is_none() && one.many_starts.is_none() && one.sizes[0].sd_error.is_some());
        assert!(PercolationStudy::new(1, &all[..3], 0.0).many_starts.is_none());
        let single = PercolationStudy::new(1, &[(10, vec![0.3]), (20, vec![0.34])], 0.0);
        assert!(single.one_length.is_none() && single.sizes[0].threshold.sd.is_none());
    }
}
