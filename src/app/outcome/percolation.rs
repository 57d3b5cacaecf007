//! Study of the percolation threshold against the size of the lattice (paper, Fig. 6): contents of
//! `percolation.json`, and combination of thresholds.
//!
//! # Finite size
//! Two finite-size relations are fitted to the mean threshold p(L) of an L x L x L lattice, by weighted least
//! squares:
//!
//! - *One length*: `p(L) = p - a L^(-1/nu)`, with the exponent of the correlation length along the flow.
//! - *Many starts*: the start layer holds of order `(L / xi_across)^2` independent starts, and each
//!   survives L layers with a probability proportional to `exp(-L / xi_along)`; so `L / xi_along` grows
//!   with the logarithm of their number. With `d = p - p(L)`, `xi_along = d^(-nu)` and `xi_across =
//!   d^(-nu / z)`: `L d^nu = b + c ln(L d^(nu / z))`. The threshold is the p with the smallest sum of
//!   squares; its interval is the range in which the sum is at most 1 above the smallest.
//!
//! The exponents are those of directed percolation in 2 + 1 dimensions, as on this lattice (two across
//! the flow, one along it): `nu` = 1.295(6) (Hinrichsen, Adv. Phys. 49, 815, 2000) and `z` = 1.766.
//! (1.105 is the value in 3 + 1 dimensions.)

use super::record::Statistic;
use super::statistic::{Straight, log_log_slope};
use serde::{Deserialize, Serialize};

/// Threshold of the infinite lattice: directed bond percolation on the simple cubic lattice.
const INFINITE_LATTICE: f64 = 0.38222;

/// Exponent of the correlation length along the flow, directed percolation in 2 + 1 dimensions (Hinrichsen
/// 2000).
pub(crate) const NU_PARALLEL: f64 = 1.295;

/// Ratio of the exponents along and across the flow, directed percolation in 2 + 1 dimensions.
pub(crate) const Z: f64 = 1.766;

/// Contents of `percolation.json`.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "cli", derive(schemars::JsonSchema))]
pub struct PercolationStudy {
    /// Version of voidwalk.
    pub(crate) version: String,
    /// Seed given by the user.
    pub(crate) seed: u64,
    /// Number of realisations of each size.
    pub(crate) realisations: u64,
    /// Thresholds of each size, ascending.
    pub(crate) sizes: Vec<SizeThreshold>,
    /// Thresholds of each lattice that is not a cube, in order of its lengths; no relation is fitted to them.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub(crate) boxes: Vec<BoxThreshold>,
    /// Relation of one length; `None` with fewer than two sizes or realisations.
    pub(crate) one_length: Option<OneLength>,
    /// Relation of many starts; `None` with fewer than four sizes, or if no threshold fits.
    pub(crate) many_starts: Option<ManyStarts>,
    /// Slope of ln(standard deviation) against ln(size); `None` as for `one_length`.
    pub(crate) sd_exponent: Option<f64>,
    /// Threshold of the infinite lattice, [`INFINITE_LATTICE`].
    pub(crate) infinite_lattice: f64,
    /// Wall time, s.
    pub(crate) seconds: f64,
}

/// Threshold of one size.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "cli", derive(schemars::JsonSchema))]
pub(crate) struct SizeThreshold {
    /// Number of voids along each side.
    pub(crate) size: u64,
    /// Fraction of constrictions that are open at the threshold.
    pub(crate) threshold: Statistic,
    /// Standard error of the standard deviation, for normal thresholds: sd / sqrt(2 (n - 1)).
    pub(crate) sd_error: Option<f64>,
}

/// Threshold of a lattice that is not a cube.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "cli", derive(schemars::JsonSchema))]
pub(crate) struct BoxThreshold {
    /// Number of voids along x and y, and number of layers.
    pub(crate) shape: [u32; 3],
    /// Fraction of constrictions that are open at the threshold.
    pub(crate) threshold: Statistic,
    /// Standard error of the standard deviation, as for a size.
    pub(crate) sd_error: Option<f64>,
}

/// Fit of `p(L) = threshold - amplitude L^(-1 / NU_PARALLEL)`.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "cli", derive(schemars::JsonSchema))]
pub(crate) struct OneLength {
    /// Threshold of the infinite lattice.
    pub(crate) threshold: f64,
    /// Standard error of the threshold, if the relation holds.
    pub(crate) threshold_error: f64,
    /// Amplitude.
    pub(crate) amplitude: f64,
    /// Sum of squared deviations, each divided by its standard error.
    pub(crate) chi_squared: f64,
    /// Degrees of freedom.
    pub(crate) degrees: u64,
}

/// Fit of `L d^nu = offset + slope ln(L d^(nu / z))`, `d = threshold - p(L)`.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "cli", derive(schemars::JsonSchema))]
pub(crate) struct ManyStarts {
    /// Threshold of the infinite lattice.
    pub(crate) threshold: f64,
    /// Lower end of the threshold's 68 % interval.
    pub(crate) threshold_low: f64,
    /// Upper end of the threshold's 68 % interval.
    pub(crate) threshold_high: f64,
    /// Offset.
    pub(crate) offset: f64,
    /// Slope.
    pub(crate) slope: f64,
    /// Sum of squared deviations, each divided by its standard error.
    pub(crate) chi_squared: f64,
    /// Degrees of freedom.
    pub(crate) degrees: u64,
}

impl PercolationStudy {
    /// Combines the thresholds of each lattice: `(voids along x and y, and layers; one threshold for each
    /// realisation)`, cubes by ascending size.
    pub(crate) fn new(seed: u64, thresholds: &[([u32; 3], Vec<f64>)], seconds: f64) -> Self {
        let (mut sizes, mut boxes) = (Vec::new(), Vec::new());
        for (shape, all) in thresholds {
            let threshold = Statistic::of_fraction(all);
            let sd_error = threshold.sd.map(|sd| sd / (2.0 * (all.len() as f64 - 1.0)).sqrt());
            match is_cube(*shape) {
                true => sizes.push(SizeThreshold { size: u64::from(shape[0]), threshold, sd_error }),
                false => boxes.push(BoxThreshold { shape: *shape, threshold, sd_error }),
            }
        }
        let realisations = thresholds.first().map_or(0, |(_, all)| all.len() as u64);
        let points: Vec<Point> = sizes.iter().filter_map(|s| Point::new(s, realisations)).collect();
        let enough = points.len() >= 2;
        Self {
            version: env!("CARGO_PKG_VERSION").into(),
            seed,
            realisations,
            one_length: enough.then(|| one_length(&points)),
            many_starts: if points.len() >= 4 { many_starts(&points) } else { None },
            sd_exponent: enough.then(|| log_log_slope(points.iter().map(|p| (p.size, p.sd)))),
            sizes,
            boxes,
            infinite_lattice: INFINITE_LATTICE,
            seconds,
        }
    }

    /// All lattices, cubes first: name, threshold, and standard error of the standard deviation.
    pub(crate) fn lattices(&self) -> impl Iterator<Item = (String, &Statistic, Option<f64>)> {
        let cubes = self.sizes.iter().map(|cube| (cube.size.to_string(), &cube.threshold, cube.sd_error));
        let boxes = self.boxes.iter();
        cubes.chain(boxes.map(|other| (lattice_name(other.shape), &other.threshold, other.sd_error)))
    }
}

/// Name of a lattice by its lengths, such as 40 or 40x40x60.
pub(crate) fn lattice_name(shape: [u32; 3]) -> String {
    let lengths = if is_cube(shape) { &shape[..1] } else { &shape };
    lengths.iter().map(u32::to_string).collect::<Vec<_>>().join("x")
}

/// True if a lattice has the same length along x, y and z.
pub(crate) fn is_cube(shape: [u32; 3]) -> bool {
    shape == [shape[0]; 3]
}

/// Data point of a fit: one size.
struct Point {
    size: f64,
    mean: f64,
    sd: f64,
    /// Standard error of the mean.
    error: f64,
}

impl Point {
    /// Returns `None` without scatter, as the weight would be undefined.
    fn new(size: &SizeThreshold, realisations: u64) -> Option<Self> {
        let sd = size.threshold.sd.filter(|sd| *sd > 0.0)?;
        let error = sd / (realisations as f64).sqrt();
        Some(Self { size: size.size as f64, mean: size.threshold.mean, sd, error })
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

/// Straight line of many starts for a given threshold above every mean.
fn starts_at(points: &[Point], threshold: f64) -> Straight {
    let row = |p: &Point| {
        let d = threshold - p.mean;
        let y = p.size * libm::pow(d, NU_PARALLEL);
        (libm::log(p.size * libm::pow(d, NU_PARALLEL / Z)), y, NU_PARALLEL * y / d * p.error)
    };
    Straight::through(&points.iter().map(row).collect::<Vec<_>>())
}

/// Tries every threshold above the means in steps of 1e-5; `None` if the best is the last or the first tried.
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

    /// Thresholds with these means, all with one small standard deviation.
    fn around(mean: impl Fn(f64) -> f64) -> Vec<([u32; 3], Vec<f64>)> {
        let thresholds = |size: u32| {
            let (mean, off) = (mean(f64::from(size)), 0.01 / f64::from(size));
            ([size; 3], vec![mean - off, mean, mean + off])
        };
        [10, 20, 40, 80, 160].map(thresholds).to_vec()
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
        // By bisection: L d^nu = 0.2 + 0.13 ln(L d^(nu / z)). Below the lower bound the logarithm dominates.
        // bound.
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

    /// A box has separate thresholds and changes no relation.
    #[test]
    fn a_box_is_told_beside_the_sizes() {
        let cubes = around(|size| 0.38 - 0.3 * libm::pow(size, -1.0 / NU_PARALLEL));
        let with_box = [cubes.clone(), vec![([40, 40, 60], vec![0.3, 0.4, 0.5])]].concat();
        let (alone, beside) =
            (PercolationStudy::new(1, &cubes, 0.0), PercolationStudy::new(1, &with_box, 0.0));
        let fitted = |study: &PercolationStudy| (study.one_length, study.many_starts, study.sd_exponent);
        assert_eq!((&alone.sizes, fitted(&alone)), (&beside.sizes, fitted(&beside)));
        assert_eq!((beside.boxes.len(), beside.boxes[0].shape), (1, [40, 40, 60]));
        assert!((beside.boxes[0].threshold.mean - 0.4).abs() < 1e-12);
        assert!((beside.boxes[0].sd_error.unwrap() - 0.05).abs() < 1e-12, "0.1 / sqrt(2 (3 - 1))");
        // An older file, or one with cubes alone, does not mention boxes.
        let text = serde_json::to_string(&alone).unwrap();
        assert!(!text.contains("boxes") && serde_json::from_str::<PercolationStudy>(&text).unwrap() == alone);
    }

    #[test]
    fn what_cannot_be_fitted_is_not() {
        let all = around(|size| 0.38 - 1.0 / size);
        let one = PercolationStudy::new(1, &all[..1], 0.0);
        assert!(one.one_length.is_none() && one.many_starts.is_none() && one.sizes[0].sd_error.is_some());
        assert!(PercolationStudy::new(1, &all[..3], 0.0).many_starts.is_none());
        let single = PercolationStudy::new(1, &[([10; 3], vec![0.3]), ([20; 3], vec![0.34])], 0.0);
        assert!(single.one_length.is_none() && single.sizes[0].threshold.sd.is_none());
    }
}
