//! Depth that one particle reaches in a clean cubic lattice: Eq. (1) of the paper.
//!
//! A particle that alone enters a clean network blocks nothing that matters to it. In each void it picks one
//! of three exits with a probability proportional to area; it is stopped where that exit is finer than it.
//! With independent constrictions
//!
//! ```text
//! q = E[ area of exits finer than d / area of all three ]     stopped in this attempt
//! s = (1 - q) / (1 + 2 q)                                   P(F): comes one layer downstream
//! n = ln(1 - confidence) / ln(s)                            Eq. (1): layers that it does not pass
//! ```
//!
//! s follows from q: a third of the moves that succeed lead downstream. Eq. (1) in the paper speaks of
//! Schuler's network, in which a void has five exits; this P(F) holds for the directed lattice that the
//! program walks. It takes every void as new, which holds for lattices wider than a particle's way around
//! them.

use crate::constrictions::Curve;

/// Parts of the curve over which the first of three exits is followed.
const PARTS: usize = 512;

/// Parts for the two others.
const OTHERS: usize = 64;

/// The probability of a particle to pass a layer of the cubic lattice with this curve, by its size.
///
/// ```
/// use voidwalk_core::constrictions::{Curve, CurveUnit};
/// use voidwalk_core::network::Passage;
/// // Half of the constrictions of size 1, half of size 2; a particle in between.
/// let curve = Curve::from_points(&[(0.0, 1.0), (50.0, 1.0), (50.0, 2.0), (100.0, 2.0)], CurveUnit::D0f)?;
/// let q = (1.0 + 3.0 * 2.0 / 6.0 + 3.0 * 1.0 / 9.0) / 8.0;
/// let passage = Passage::new(&curve);
/// assert!((passage.stopped(1.5) - q).abs() < 1e-12);
/// assert!((passage.downstream(1.5) - (1.0 - q) / (1.0 + 2.0 * q)).abs() < 1e-12);
/// # Ok::<(), voidwalk_core::constrictions::CurveError>(())
/// ```
#[derive(Clone, Debug)]
pub struct Passage<'a> {
    curve: &'a Curve,
    /// Three times the integral, over the finest i / PARTS of the curve, of the share of area that such an
    /// exit has.
    stopped: Vec<f64>,
}

impl<'a> Passage<'a> {
    /// Follows three independent exits through the curve, each at the middle of equal parts.
    pub fn new(curve: &'a Curve) -> Self {
        let area = |part: usize, parts: usize| {
            let diameter = curve.quantile((part as f64 + 0.5) / parts as f64);
            diameter * diameter
        };
        let others: Vec<f64> = (0..OTHERS).map(|part| area(part, OTHERS)).collect();
        let pairs: Vec<f64> = others.iter().flat_map(|a| others.iter().map(move |b| a + b)).collect();
        let mut stopped = vec![0.0];
        let mut sum = 0.0;
        for part in 0..PARTS {
            let first = area(part, PARTS);
            let share = pairs.iter().map(|pair| first / (first + pair)).sum::<f64>() / pairs.len() as f64;
            sum += 3.0 * share / PARTS as f64;
            stopped.push(sum);
        }
        // The three shares sum to 1; the difference that rounding and the coarser parts leave is taken out.
        stopped.iter_mut().for_each(|s| *s /= sum);
        Self { curve, stopped }
    }

    /// q: the probability that a particle of diameter `d`, in the curve's unit, is stopped in an attempt.
    pub fn stopped(&self, d: f64) -> f64 {
        // A particle as large as a constriction passes it.
        let finer = self.curve.percent_smaller(d * (1.0 - 1e-12)) / 100.0 * PARTS as f64;
        let part = (finer as usize).min(PARTS - 1);
        let (low, high) = (self.stopped[part], self.stopped[part + 1]);
        (low + (finer - part as f64) * (high - low)).clamp(0.0, 1.0)
    }

    /// s, or P(F): the probability that it comes one layer downstream.
    pub fn downstream(&self, d: f64) -> f64 {
        let q = self.stopped(d);
        (1.0 - q) / (1.0 + 2.0 * q)
    }

    /// Eq. (1): the layers that it does not pass with this confidence (0 to 1); `None` if nothing can stop
    /// it.
    pub fn layers(&self, d: f64, confidence: f64) -> Option<f64> {
        let s = self.downstream(d);
        (s < 1.0).then(|| if s > 0.0 { libm::log(1.0 - confidence) / libm::log(s) } else { 0.0 })
    }

    /// Probability that it leaves a lattice of this many layers: `s ^ layers`.
    pub fn through(&self, d: f64, layers: u64) -> f64 {
        libm::pow(self.downstream(d), layers as f64)
    }

    /// The diameter whose [`Passage::layers`] at this confidence are `layers`: coarser particles come less
    /// far.
    pub fn coarsest_through(&self, layers: u64, confidence: f64) -> f64 {
        let (mut low, mut high) = (self.curve.smallest(), self.curve.largest());
        for _ in 0..100 {
            let middle = 0.5 * (low + high);
            if self.through(middle, layers) >= 1.0 - confidence { low = middle } else { high = middle }
        }
        low
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::constrictions::find;
    use crate::network::Network;

    #[test]
    fn one_size_of_constriction_stops_all_or_none() {
        let curve = Curve::from_points(&[(100.0, 0.25)], crate::constrictions::CurveUnit::D0f).unwrap();
        let passage = Passage::new(&curve);
        assert_eq!((passage.stopped(0.25), passage.downstream(0.25)), (0.0, 1.0));
        assert_eq!((passage.stopped(0.26), passage.downstream(0.26)), (1.0, 0.0));
        assert_eq!((passage.layers(0.25, 0.95), passage.layers(0.26, 0.95)), (None, Some(0.0)));
    }

    #[test]
    fn equation_one_by_hand() {
        let curve = find("shire2016-cu1.5-loose").unwrap().curve().unwrap();
        let passage = Passage::new(&curve);
        let d = curve.dc(10.0).unwrap();
        let (s, n) = (passage.downstream(d), passage.layers(d, 0.95).unwrap());
        assert!((libm::pow(s, n) - 0.05).abs() < 1e-12);
        assert!(passage.layers(d, 0.99).unwrap() > n);
        let coarsest = passage.coarsest_through(60, 0.95);
        assert!((passage.layers(coarsest, 0.95).unwrap() - 60.0).abs() < 1e-6);
        assert!(passage.stopped(curve.smallest()) == 0.0 && passage.stopped(2.0 * curve.largest()) == 1.0);
    }

    /// The mean over the voids of a network: 96,000 voids, standard error of q at most 0.3 / sqrt(96,000) =
    /// 0.001.
    #[test]
    fn q_is_the_mean_over_the_voids_of_a_network() {
        let curve = find("shire2016-cu1.5-loose").unwrap().curve().unwrap();
        let (passage, network) =
            (Passage::new(&curve), Network::cubic([40, 40, 60], &curve, 1.0, 4).unwrap());
        for percent in [1.0, 5.0, 20.0, 50.0, 80.0, 99.0] {
            let d = curve.dc(percent).unwrap();
            let mean = (0..network.voids() as u32)
                .map(|void| {
                    let area =
                        |c: usize| f64::from(network.diameters()[c]) * f64::from(network.diameters()[c]);
                    let all: f64 = network.exits(void).map(area).sum();
                    let finer = network.exits(void).filter(|&c| f64::from(network.diameters()[c]) < d);
                    finer.map(area).sum::<f64>() / all
                })
                .sum::<f64>()
                / network.voids() as f64;
            assert!((passage.stopped(d) - mean).abs() < 0.003, "Dc{percent}: {} {mean}", passage.stopped(d));
        }
    }
}
