//! The two exact predicates of a regular triangulation.
//!
//! For a tetrahedron with corners 0..3 of positive orientation and a point `p`, [`facets`] gives for each
//! corner the orientation of the tetrahedron with that corner replaced by `p` (tells if `p` is beyond the
//! opposite facet), and [`in_conflict`] tells if `p` is closer, by power distance, than the corners allow:
//! with heights `h = |x|^2 - r^2`, if `p` lies below the plane through the four lifted corners.
//!
//! Both are determinants of differences, which are exact on the grid ([`super::mesh`]). They are
//! evaluated in f64, with a bound on the rounding error computed from the sizes of the differences; if
//! the bound does not decide, in integers of 320 bits: a determinant is an integer below 2^272.
//!
//! # Ties
//! Five centres on one sphere (as in every lattice) are separated by raising each height by a symbolic
//! amount, which is larger the later the centre comes in lexicographic order of x, y, z (Edelsbrunner &
//! Mücke, *Simulation of simplicity*, doi:10.1145/77635.77639; Devillers & Teillaud, *Perturbations for
//! Delaunay and weighted Delaunay 3D triangulations*, doi:10.1016/j.comgeo.2010.09.010). The order of
//! two points is the same for all their images, so facets pair across the boundary of the cell. Since
//! only heights change, no flat tetrahedron ever arises.

use super::mesh::{GrainPoint, dot, offset};
use std::cmp::Ordering;
use std::ops::{Add, Mul, Neg, Sub};

/// Half an ulp of 1.
const U: f64 = f64::EPSILON / 2.0;

/// A 3 x 3 minor has an error of at most 28 U times the product of the largest differences per axis: 4
/// for a 2 x 2 minor, hence 8 for each of three products, 10 for their sum. 32 covers the bound's own
/// rounding.
const MINOR_BOUND: f64 = 32.0 * U;

/// Four products of a height (relative error 4 U of its terms) and a minor (28 U on a value of at most
/// 6), and their sum: 4 (24 + 28 + 6) + 54 = 286; 320 covers the bound's own rounding.
const POWER_BOUND: f64 = 320.0 * U;

#[inline(always)]
fn differences(corners: &[GrainPoint; 4], p: &GrainPoint) -> [[f64; 3]; 4] {
    [offset(p, &corners[0]), offset(p, &corners[1]), offset(p, &corners[2]), offset(p, &corners[3])]
}

/// The four 3 x 3 minors, signed, from the 2 x 2 minors of x and y and from z: six times the volume of the
/// tetrahedron with corner `i` replaced.
#[inline(always)]
fn minors_of<T: Copy + Add<Output = T> + Sub<Output = T> + Mul<Output = T>>(
    pair: impl Fn(usize, usize) -> T,
    [z0, z1, z2, z3]: [T; 4],
) -> [T; 4] {
    let (m01, m02, m03) = (pair(0, 1), pair(0, 2), pair(0, 3));
    let (m12, m13, m23) = (pair(1, 2), pair(1, 3), pair(2, 3));
    [
        z1 * m23 - z2 * m13 + z3 * m12,
        z2 * m03 - z0 * m23 - z3 * m02,
        z0 * m13 - z1 * m03 + z3 * m01,
        z1 * m02 - z0 * m12 - z2 * m01,
    ]
}

#[inline(always)]
fn minors(d: &[[f64; 3]; 4]) -> [f64; 4] {
    minors_of(|i, j| d[i][0] * d[j][1] - d[j][0] * d[i][1], [d[0][2], d[1][2], d[2][2], d[3][2]])
}

#[inline(always)]
fn magnitude(d: &[[f64; 3]; 4]) -> f64 {
    let largest =
        |axis: usize| d[0][axis].abs().max(d[1][axis].abs()).max(d[2][axis].abs().max(d[3][axis].abs()));
    largest(0) * largest(1) * largest(2)
}

#[inline(never)]
#[cold]
fn exact_minors(d: &[[f64; 3]; 4]) -> [Wide; 4] {
    // Differences are integers below 2^53, their 2 x 2 minors below 2^107.
    let n = d.map(|row| row.map(|value| value as i128));
    let pair = |i: usize, j: usize| Wide::from(n[i][0] * n[j][1] - n[j][0] * n[i][1]);
    minors_of(pair, [n[0][2], n[1][2], n[2][2], n[3][2]].map(Wide::from))
}

/// Finds the facet that a walk towards `p` should cross: returns the corner opposite a facet with `p`
/// strictly beyond it, or `None` if the closed tetrahedron contains `p`.
#[inline]
pub(super) fn facets(corners: &[GrainPoint; 4], p: &GrainPoint) -> Option<usize> {
    let d = differences(corners, p);
    let volume = minors(&d);
    let mut least = 0;
    for i in 1..4 {
        if volume[i] < volume[least] {
            least = i;
        }
    }
    let bound = MINOR_BOUND * magnitude(&d);
    if volume[least] < -bound {
        Some(least)
    } else if volume[least] > bound {
        None
    } else {
        exact_minors(&d).iter().position(|volume| volume.sign() < 0)
    }
}

/// Orientation of four points: positive, negative, or zero if they lie in one plane.
pub(super) fn orientation(corners: &[GrainPoint; 4]) -> i32 {
    // The first difference, which is zero, enters only the other three minors.
    let mut d = differences(corners, &corners[0]);
    d[0] = [1.0; 3];
    let (volume, bound) = (minors(&d)[0], MINOR_BOUND * magnitude(&d));
    if volume.abs() > bound { if volume > 0.0 { 1 } else { -1 } } else { exact_minors(&d)[0].sign() }
}

/// Six times the signed volume of four points, exactly.
pub(super) fn volume(corners: &[GrainPoint; 4]) -> Wide {
    exact_minors(&differences(corners, &corners[0]))[0]
}

/// Tells if `p` removes the positively oriented tetrahedron. `order` compares corners (0..3) and `p` (4)
/// whose centres, and so heights, are the same.
#[inline]
pub(super) fn in_conflict(
    corners: &[GrainPoint; 4],
    p: &GrainPoint,
    tie: impl Fn(usize, usize) -> Ordering,
) -> bool {
    let d = differences(corners, p);
    let volume = minors(&d);
    let mut sum = 0.0;
    let mut scale = 0.0f64;
    for i in 0..4 {
        let square = dot(&d[i], &d[i]);
        let weight = (corners[i][3] - p[3]) * (corners[i][3] + p[3]);
        sum += (square - weight) * volume[i];
        scale = scale.max(square + weight.abs());
    }
    let bound = POWER_BOUND * magnitude(&d) * scale;
    if sum > bound {
        true
    } else if sum < -bound {
        false
    } else {
        exact_conflict(corners, p, &d, tie)
    }
}

#[inline(never)]
#[cold]
fn exact_conflict(
    corners: &[GrainPoint; 4],
    p: &GrainPoint,
    d: &[[f64; 3]; 4],
    tie: impl Fn(usize, usize) -> Ordering,
) -> bool {
    let volume = exact_minors(d);
    let mut sum = Wide::ZERO;
    for i in 0..4 {
        let n = d[i].map(|value| value as i128);
        let (r, s) = (corners[i][3] as i128, p[3] as i128);
        let height = n[0] * n[0] + n[1] * n[1] + n[2] * n[2] - (r - s) * (r + s);
        sum = sum + Wide::from(height) * volume[i];
    }
    match sum.sign() {
        0 => perturbed_conflict(corners, p, &volume, tie),
        sign => sign > 0,
    }
}

/// Decides for five points on one sphere by the sign of the largest perturbation whose factor is not zero.
/// Raising corner `i` raises the plane at `p` by the barycentric coordinate of `p`; raising `p` lifts it out.
fn perturbed_conflict(
    corners: &[GrainPoint; 4],
    p: &GrainPoint,
    volume: &[Wide; 4],
    tie: impl Fn(usize, usize) -> Ordering,
) -> bool {
    let at = |i: usize| if i == 4 { p } else { &corners[i] };
    let mut order = [0, 1, 2, 3, 4];
    order.sort_unstable_by(|&i, &j| {
        let (a, b) = (at(i), at(j));
        let by = |axis: usize| b[axis].partial_cmp(&a[axis]).unwrap_or(Ordering::Equal);
        by(0).then_with(|| by(1)).then_with(|| by(2)).then_with(|| tie(j, i))
    });
    for i in order {
        if i == 4 {
            return false;
        }
        if volume[i].sign() != 0 {
            return volume[i].sign() > 0;
        }
    }
    false
}

const LIMBS: usize = 5;

/// A signed integer of 320 bits, least significant limb first.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Wide([u64; LIMBS]);

impl Wide {
    pub(super) const ZERO: Self = Self([0; LIMBS]);

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
