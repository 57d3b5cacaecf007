//! Inverse cube roots, in operations that give the same bits on every machine.

/// Top half of the bits of the start value at x = 1, in units of the exponent's lowest bit / 2^20.
///
/// The bits of a positive f64 are nearly a logarithm, so `MAGIC - bits / 3` starts the iteration.
/// The constant balances the largest `1 - x z^3` on both sides.
const MAGIC: u64 = 0x553e_f0ff;

/// `x^(-1/3)` for a positive normal `x`, within 2 units in the last place.
#[inline(always)]
pub(crate) fn inverse_cube_root(x: f64) -> f64 {
    inverse_cube_roots(&[x])[0]
}

/// Applies [`inverse_cube_root`] to each number.
///
/// Two steps of fourth order for `z^-3 = x`: with `e = 1 - x z^3`,
/// `z (1 - e)^(-1/3) = z (1 + e/3 + 2 e^2/9 + 14 e^3/81 + ...)`. Only additions and multiplications of f64,
/// in this order: no library call, no fused operation, and no branch, so that the loops become vector code.
/// Each step takes two short loops over all numbers: one root after another would make the machine wait for
/// each operation's result before the next.
#[inline(always)]
pub(super) fn inverse_cube_roots<const N: usize>(x: &[f64; N]) -> [f64; N] {
    let (mut z, mut e) = ([0.0; N], [0.0; N]);
    for (z, x) in z.iter_mut().zip(x) {
        let third = ((x.to_bits() >> 32) * 0x5555_5556) >> 32;
        *z = f64::from_bits((MAGIC - third) << 32);
    }
    for _ in 0..2 {
        for ((e, z), x) in e.iter_mut().zip(&z).zip(x) {
            *e = 1.0 - x * (z * z * z);
        }
        for (z, e) in z.iter_mut().zip(&e) {
            let series = e * (1.0 / 3.0 + e * (2.0 / 9.0 + e * (14.0 / 81.0)));
            *z += *z * series;
        }
    }
    z
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::stream::{Key, Purpose};
    use rand::Rng;

    /// Distance from the true root in units of the last place, by the residual `x z^3 - 1` computed
    /// with the error terms that rounding loses.
    fn error_ulp(x: f64) -> f64 {
        let (z, near) = (inverse_cube_root(x), 1.0 / libm::cbrt(x));
        // `near` is good to about one unit; one exact-residual Newton step makes it a reference.
        let residual = |z: f64| {
            let square = z * z;
            let lost_square = libm::fma(z, z, -square);
            let cube = square * z;
            let lost_cube = libm::fma(square, z, -cube) + lost_square * z;
            libm::fma(x, cube, -1.0) + x * lost_cube
        };
        let correction = -residual(near) / 3.0 * near;
        let ulp = f64::from_bits(near.to_bits() + 1) - near;
        ((z - near) - correction).abs() / ulp
    }

    /// Checks every exponent that sizes can produce, and beyond: 2e6 random mantissas and the edges.
    #[test]
    fn is_within_two_units_in_the_last_place() {
        let mut generator =
            Key { seed: 1, purpose: Purpose::Packing, run: 0, increment: 0, chunk: 0 }.generator();
        let mut worst: f64 = 0.0;
        for exponent in 1..2046u64 {
            for mantissa in [0, 1, (1 << 52) - 1, 1 << 51] {
                worst = worst.max(error_ulp(f64::from_bits((exponent << 52) | mantissa)));
            }
        }
        // The error depends on the mantissa and the exponent modulo 3 only.
        for i in 0..2_000_000u64 {
            let exponent = 1020 + i % 6;
            worst = worst.max(error_ulp(f64::from_bits((exponent << 52) | (generator.next_u64() >> 12))));
        }
        assert!(worst <= 2.0, "{worst}");
        assert!(worst > 0.4, "the reference must see rounding: {worst}");
    }

    #[test]
    fn known_roots() {
        for (x, root) in [(1.0, 1.0), (8.0, 0.5), (0.125, 2.0), (1e-72, 1e24), (1e72, 1e-24)] {
            let computed = inverse_cube_root(x);
            assert!((computed / root - 1.0f64).abs() < 1e-15, "{x} {computed}");
        }
    }
}
