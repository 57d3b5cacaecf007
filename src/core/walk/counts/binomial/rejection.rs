//! Transformed rejection (BTRS; W. Hoermann 1993, doi:10.1080/00949659308811496), for counts too large for
//! anything else: most draws are accepted by a squeeze, the others by [`super::saddle`].

use super::draws::{Draws, as_unit, rarer};
use super::normal::ROUNDER;
use super::saddle::ln_probability;
use crate::stream::unit;

/// Below this mean (of the rarer outcome) rejection does not hold.
pub(super) const LEAST_MEAN: f64 = 10.0;

/// Constants of Hoermann's BTRS: within this of 0, `u` may be accepted by `v` alone.
pub(super) const QUICK_U: f64 = 0.07;

/// BTRS for one pair: `p <= 1/2`, `n p >= 10`.
#[derive(Clone, Copy)]
pub(super) struct Hat {
    pub n: f64,
    pub p: f64,
    q: f64,
    mean: f64,
    sigma: f64,
    a: f64,
    pub b: f64,
}

impl Hat {
    /// Draws the rarer outcome of `n` trials with probability `p`.
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
