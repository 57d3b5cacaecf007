//! Integers of 320 bits, which decide the exact predicates.
//!
//! Grain centres lie on an integer grid ([`super::points`]), so a determinant whose sign plain f64 cannot
//! decide is an integer below 2^272 and is computed exactly. Two's complement, wrapping: the product of two
//! numbers whose true product fits is right, whatever happened above bit 320.

use std::ops::{Add, Mul, Neg, Sub};

const LIMBS: usize = 5;

/// A signed integer of 320 bits, least significant limb first.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Wide([u64; LIMBS]);

impl Wide {
    pub(super) const ZERO: Self = Self([0; LIMBS]);

    /// -1, 0 or 1.
    pub(super) fn sign(self) -> i32 {
        if self.0[LIMBS - 1] >> 63 == 1 { -1 } else { i32::from(self != Self::ZERO) }
    }

    /// Nearest f64 to within a few units in the last place (for reports, never for decisions).
    pub(super) fn to_f64(self) -> f64 {
        let magnitude = if self.sign() < 0 { -self } else { self };
        let value =
            magnitude.0.iter().rev().fold(0.0, |sum, &limb| sum * 18_446_744_073_709_551_616.0 + limb as f64);
        if self.sign() < 0 { -value } else { value }
    }
}

impl From<i128> for Wide {
    fn from(value: i128) -> Self {
        let fill = (value >> 127) as u64;
        Self([value as u64, (value >> 64) as u64, fill, fill, fill])
    }
}

impl Add for Wide {
    type Output = Self;
    fn add(self, other: Self) -> Self {
        let mut sum = [0; LIMBS];
        let mut carry = false;
        for (slot, (&a, &b)) in sum.iter_mut().zip(self.0.iter().zip(&other.0)) {
            let (low, first) = a.overflowing_add(b);
            let (low, second) = low.overflowing_add(u64::from(carry));
            *slot = low;
            carry = first || second;
        }
        Self(sum)
    }
}

impl Neg for Wide {
    type Output = Self;
    fn neg(self) -> Self {
        Self(self.0.map(|limb| !limb)) + Self([1, 0, 0, 0, 0])
    }
}

impl Sub for Wide {
    type Output = Self;
    fn sub(self, other: Self) -> Self {
        self + -other
    }
}

impl Mul for Wide {
    type Output = Self;
    fn mul(self, other: Self) -> Self {
        let mut product = [0u64; LIMBS];
        for i in 0..LIMBS {
            let mut carry = 0u128;
            for j in 0..LIMBS - i {
                let term =
                    u128::from(self.0[i]) * u128::from(other.0[j]) + u128::from(product[i + j]) + carry;
                product[i + j] = term as u64;
                carry = term >> 64;
            }
        }
        Self(product)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use num_bigint::BigInt;
    use proptest::prelude::*;

    fn big(value: Wide) -> BigInt {
        let bytes: Vec<u8> = value.0.iter().flat_map(|limb| limb.to_le_bytes()).collect();
        BigInt::from_signed_bytes_le(&bytes)
    }

    proptest! {
        #[test]
        fn agrees_with_a_big_integer(a: i128, b: i128, c in -(1i128 << 60)..1i128 << 60) {
            let (wide, exact) = (Wide::from, |v: i128| BigInt::from(v));
            prop_assert_eq!(big(wide(a) * wide(b) + wide(c)), exact(a) * exact(b) + exact(c));
            prop_assert_eq!(big(wide(a) * wide(b) * wide(c)), exact(a) * exact(b) * exact(c));
            prop_assert_eq!(big(wide(a) - wide(b)), exact(a) - exact(b));
            prop_assert_eq!(wide(a).sign(), a.signum() as i32);
            prop_assert_eq!((wide(a) * wide(b)).sign(), (a.signum() * b.signum()) as i32);
            prop_assert!((wide(a).to_f64() - a as f64).abs() <= 1e-15 * (a as f64).abs());
        }
    }
}
