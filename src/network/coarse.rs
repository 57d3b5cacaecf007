//! A coarse picture of a system of pressures: one unknown for each part of the voids.
//!
//! What is slow to converge is what is smooth: a pressure that is wrong by layers. Where parts are layers,
//! the small system of their mean pressures takes that away at once (a two-level method with the layers as
//! aggregates), so that the number of rounds no longer grows with the thickness of the filter.

/// A system of at most so many parts.
pub(super) const MOST_PARTS: usize = 128;

/// The small system, factored: L L^T, the lower triangle row by row.
pub(super) struct Coarse {
    /// Part by row of the large system.
    part: Vec<u32>,
    parts: usize,
    factor: Vec<f64>,
}

impl Coarse {
    /// Of rows that belong to these parts; `entries` calls back with row, other row and entry of the large
    /// system, the diagonal included.
    pub(super) fn new(part: Vec<u32>, entries: impl Fn(&mut dyn FnMut(usize, usize, f64))) -> Self {
        let parts = part.iter().max().map_or(0, |&part| part as usize + 1);
        let mut a = vec![0.0; parts * parts];
        entries(&mut |i, j, entry| a[part[i] as usize * parts + part[j] as usize] += entry);
        for i in 0..parts {
            for j in 0..=i {
                let dot: f64 = (0..j).map(|k| a[i * parts + k] * a[j * parts + k]).sum();
                let rest = a[i * parts + j] - dot;
                a[i * parts + j] = if i != j {
                    if a[j * parts + j] > 0.0 { rest / a[j * parts + j] } else { 0.0 }
                } else if rest > 1e-12 * a[i * parts + i] {
                    rest.sqrt()
                } else {
                    // A part without a row, or that hangs together with nothing.
                    0.0
                };
            }
        }
        Self { part, parts, factor: a }
    }

    /// Adds the solution for the sums of `residual` over the parts.
    pub(super) fn add(&self, residual: &[f64], out: &mut [f64]) {
        let n = self.parts;
        let mut x = vec![0.0; n];
        self.part.iter().zip(residual).for_each(|(&part, r)| x[part as usize] += r);
        let pivot = |i: usize| self.factor[i * n + i];
        for i in 0..n {
            let known: f64 = (0..i).map(|k| self.factor[i * n + k] * x[k]).sum();
            x[i] = if pivot(i) > 0.0 { (x[i] - known) / pivot(i) } else { 0.0 };
        }
        for i in (0..n).rev() {
            let known: f64 = (i + 1..n).map(|k| self.factor[k * n + i] * x[k]).sum();
            x[i] = if pivot(i) > 0.0 { (x[i] - known) / pivot(i) } else { 0.0 };
        }
        self.part.iter().zip(out).for_each(|(&part, out)| *out += x[part as usize]);
    }
}
