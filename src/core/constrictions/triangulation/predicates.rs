//! The two exact predicates of a regular triangulation.
//!
//! For a tetrahedron with corners 0..3 of positive orientation and a point `p`, [`facets`] gives for each
//! corner the orientation of the tetrahedron with that corner replaced by `p` (is `p` beyond the facet
//! opposite it?), and [`in_conflict`] tells if `p` lies closer, by power distance, than the corners allow:
//! with heights `h = |x|^2 - r^2`, if `p` lies below the plane through the four lifted corners.
//!
//! Both are determinants of differences, which are exact on the grid ([`super::points`]). They are evaluated
//! in f64 with a bound on the rounding error that follows from the sizes of the differences; if the bound
//! does not decide, in integers of 320 bits.
//!
//! # Ties
//! Five centres on one sphere (every lattice) are separated by raising each height by a symbolic
//! amount, the more the later the centre comes in lexicographic order of x, y, z (Edelsbrunner &
//! Mücke, *Simulation of simplicity*, doi:10.1145/77635.77639; Devillers & Teillaud, *Perturbations
//! for Delaunay and weighted Delaunay 3D triangulations*, doi:10.1016/j.comgeo.2010.09.010). The order
//! of two points is the same for all their images, so facets pair across the boundary of the cell,
//! and since only heights are moved no flat tetrahedron ever arises.

use super::points::GrainPoint;
use super::wide::Wide;
use std::cmp::Ordering;

/// Half an ulp of 1.
const U: f64 = f64::EPSILON / 2.0;

/// A 3 x 3 minor errs by at most 28 U times the product of the largest differences per axis:
/// 4 for a 2 x 2 minor, hence 8 for each of three products, 10 for their sum. 32 covers the bound's
/// own rounding.
const MINOR_BOUND: f64 = 32.0 * U;

/// Four products of a height (relative error 4 U of its terms) and a minor (28 U on a value of at most
/// 6), and their sum: 4 (24 + 28 + 6) + 54 = 286; 320 covers the bound's own rounding.
const POWER_BOUND: f64 = 320.0 * U;

/// Differences corner - p.
#[inline(always)]
fn differences(corners: &[GrainPoint; 4], p: &GrainPoint) -> [[f64; 3]; 4] {
    [row(&corners[0], p), row(&corners[1], p), row(&corners[2], p), row(&corners[3], p)]
}

/// The four 3 x 3 minors, signed: six times the volume of the tetrahedron with corner `i` replaced.
#[inline(always)]
fn minors(d: &[[f64; 3]; 4]) -> [f64; 4] {
    let pair = |i: usize, j: usize| d[i][0] * d[j][1] - d[j][0] * d[i][1];
    let (m01, m02, m03) = (pair(0, 1), pair(0, 2), pair(0, 3));
    let (m12, m13, m23) = (pair(1, 2), pair(1, 3), pair(2, 3));
    let [z0, z1, z2, z3] = [d[0][2], d[1][2], d[2][2], d[3][2]];
    [
        z1 * m23 - z2 * m13 + z3 * m12,
        z2 * m03 - z0 * m23 - z3 * m02,
        z0 * m13 - z1 * m03 + z3 * m01,
        z1 * m02 - z0 * m12 - z2 * m01,
    ]
}

/// Product over the axes of the largest difference.
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
    let (m01, m02, m03) = (pair(0, 1), pair(0, 2), pair(0, 3));
    let (m12, m13, m23) = (pair(1, 2), pair(1, 3), pair(2, 3));
    let [z0, z1, z2, z3] = [n[0][2], n[1][2], n[2][2], n[3][2]].map(Wide::from);
    [
        z1 * m23 - z2 * m13 + z3 * m12,
        z2 * m03 - z0 * m23 - z3 * m02,
        z0 * m13 - z1 * m03 + z3 * m01,
        z1 * m02 - z0 * m12 - z2 * m01,
    ]
}

/// Finds the facet that a walk towards `p` should cross: the opposite corner of a facet that `p` lies
/// strictly beyond, or `None` if the closed tetrahedron holds `p`.
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

/// Orientation of four points: positive, negative, or zero in one plane.
pub(super) fn orientation(corners: &[GrainPoint; 4]) -> i32 {
    let p = corners[0];
    let d = [[1.0; 3], row(&corners[1], &p), row(&corners[2], &p), row(&corners[3], &p)];
    // The first difference enters the other three minors only.
    let (volume, bound) = (minors(&d)[0], MINOR_BOUND * magnitude(&d));
    if volume.abs() > bound { if volume > 0.0 { 1 } else { -1 } } else { exact_minors(&d)[0].sign() }
}

/// Six times the signed volume of four points, exactly.
pub(super) fn volume(corners: &[GrainPoint; 4]) -> Wide {
    let p = corners[0];
    exact_minors(&[[0.0; 3], row(&corners[1], &p), row(&corners[2], &p), row(&corners[3], &p)])[0]
}

#[inline(always)]
fn row(a: &GrainPoint, p: &GrainPoint) -> [f64; 3] {
    [a[0] - p[0], a[1] - p[1], a[2] - p[2]]
}

/// Tells if `p` removes the positively oriented tetrahedron. `order` compares corners (0..3) and `p` (4) if
/// their centres and so their heights are the same.
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
        let square = d[i][0] * d[i][0] + d[i][1] * d[i][1] + d[i][2] * d[i][2];
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
