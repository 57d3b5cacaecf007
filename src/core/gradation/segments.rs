//! Counts the particles of a segment of a sieve curve.
//!
//! Within a segment from size `a` to `b = a e^L` that holds the fraction `m` of the mass, one mm3 of solid
//! holds `integral of 6 / (pi D^3) dm` = `2 m / (pi a^3) * (1 - e^(-3 L)) / L` particles, and the number
//! finer than `D` is linear in `D^-3`.

use std::f64::consts::PI;

/// `(1 - e^(-3 l)) / l`, with its limit at 0.
fn shape(l: f64) -> f64 {
    if l > 0.0 { -libm::expm1(-3.0 * l) / l } else { 3.0 }
}

/// Particles per mm3 of solid in a segment from `a` over the log ratio `l`, with mass fraction `m`.
pub(super) fn count(a: f64, l: f64, m: f64) -> f64 {
    2.0 * m / (PI * (a * a * a)) * shape(l)
}

/// Particles finer than each point, per mm3 of solid.
pub(super) fn cumulative(size_mm: &[f64], percent: &[f64], log_ratio: &[f64]) -> Vec<f64> {
    if let [d] = size_mm {
        return vec![6.0 / (PI * (d * d * d))];
    }
    let mut total = 0.0;
    let mut number = vec![0.0];
    for (i, &l) in log_ratio.iter().enumerate() {
        total += count(size_mm[i], l, (percent[i + 1] - percent[i]) / 100.0);
        number.push(total);
    }
    number
}
