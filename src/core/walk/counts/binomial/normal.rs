//! Quantiles of the normal distribution, by a table of cubic polynomials.

use std::sync::OnceLock;

/// 2^52: adding it rounds a smaller float to a whole number.
pub(super) const ROUNDER: f64 = 4_503_599_627_370_496.0;
pub(super) const MANTISSA: u64 = (1 << 52) - 1;

const ONE: u64 = 1023 << 52;

/// Cells of the quantile table in each halving of the tail.
const CELL_BITS: u32 = 5;

/// Halvings of the tail that the table covers, from 1/2 on.
const HALVINGS: u64 = 14;

/// The table begins at this tail, 4 standard deviations out.
pub(super) const FAR: f64 = 1.0 / 32768.0;

/// Place of the first cell among all floats.
const FIRST_CELL: u64 = (1023 - 1 - HALVINGS) << CELL_BITS;

/// Cells, and some beyond them that are never used: an index cut to nine bits needs no check.
const CELLS: usize = 512;

/// Cubic polynomials for the distance from the middle of a normal distribution beyond which a tail lies, by
/// cells of the tail; the variable runs from 0 to 1 over a cell.
pub(super) struct Normal {
    cells: [[f64; 4]; CELLS],
}

impl Normal {
    /// The one table.
    pub fn table() -> &'static Self {
        static TABLE: OnceLock<Box<Normal>> = OnceLock::new();
        TABLE.get_or_init(|| Box::new(Self::new()))
    }

    fn new() -> Self {
        let mut cells = [[0.0; 4]; CELLS];
        for (cell, polynomial) in cells.iter_mut().enumerate().take((HALVINGS as usize) << CELL_BITS) {
            let begin = f64::from_bits((cell as u64 + FIRST_CELL) << (52 - CELL_BITS));
            let end = f64::from_bits((cell as u64 + 1 + FIRST_CELL) << (52 - CELL_BITS));
            *polynomial = cubic(|x| beyond(begin + (end - begin) * x));
        }
        Self { cells }
    }

    /// Where the tail `t` begins, for `t` from [`FAR`] to 1/2.
    #[inline(always)]
    pub(super) fn quantile(&self, t: f64) -> f64 {
        let bits = t.to_bits();
        let cell = ((bits >> (52 - CELL_BITS)) - FIRST_CELL) as usize % CELLS;
        let along = f64::from_bits((bits << CELL_BITS) & MANTISSA | ONE) - 1.0;
        let [a, b, c, d] = self.cells[cell];
        a + along * (b + along * (c + along * d))
    }
}

/// The cubic through four values of `f` between 0 and 1, at the places where its error is least
/// (Chebyshev's).
fn cubic(f: impl Fn(f64) -> f64) -> [f64; 4] {
    let x = [
        -0.923_879_532_511_286_7,
        -0.382_683_432_365_089_8,
        0.382_683_432_365_089_8,
        0.923_879_532_511_286_7,
    ]
    .map(|node| 0.5 + 0.5 * node);
    let y = x.map(f);
    // Divided differences.
    let slope = |a: f64, b: f64, i: usize, j: usize| (b - a) / (x[j] - x[i]);
    let first: [f64; 3] = std::array::from_fn(|i| slope(y[i], y[i + 1], i, i + 1));
    let second: [f64; 2] = std::array::from_fn(|i| slope(first[i], first[i + 1], i, i + 2));
    let third = slope(second[0], second[1], 0, 3);
    let products = [x[0] * x[1], x[0] * x[2] + x[1] * x[2], x[0] * x[1] * x[2]];
    [
        y[0] - first[0] * x[0] + second[0] * products[0] - third * products[2],
        first[0] - second[0] * (x[0] + x[1]) + third * (products[0] + products[1]),
        second[0] - third * (x[0] + x[1] + x[2]),
        third,
    ]
}

/// Density of the normal distribution.
fn density(z: f64) -> f64 {
    0.398_942_280_401_432_7 * libm::exp(-0.5 * z * z)
}

/// Where the tail `t <= 1/2` of the normal distribution begins, by Newton's method.
pub(super) fn beyond(t: f64) -> f64 {
    let mut z = 0.0;
    loop {
        // From the left of a convex function: every step goes right, until rounding ends it.
        let step = (0.5 * libm::erfc(z * std::f64::consts::FRAC_1_SQRT_2) - t) / density(z);
        if step <= 1e-15 * z {
            return z;
        }
        z += step;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The table against Newton's method, at the ends of every cell and between: to less than half of what
    /// the margin allows.
    #[test]
    fn the_table_is_the_normal_quantile() {
        let normal = Normal::table();
        let mut worst = 0f64;
        for i in 0..(HALVINGS << CELL_BITS) * 8 {
            let t = f64::from_bits((FIRST_CELL << (52 - CELL_BITS)) + (i << (49 - CELL_BITS)) + 12345);
            worst = worst.max((normal.quantile(t) - beyond(t)).abs());
        }
        assert!(worst < 0.5 / (1u64 << 29) as f64, "{worst:e}");
        assert!((beyond(0.5)).abs() < 1e-15 && (beyond(0.158_655_253_931_457_05) - 1.0).abs() < 1e-14);
        assert!((beyond(FAR) - 4.008).abs() < 1e-2);
    }
}
