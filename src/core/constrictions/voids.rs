//! Voids: tetrahedra whose inspheres overlap.
//!
//! A tetrahedron's insphere is the sphere tangent to its four grains from between them. Two tetrahedra
//! belong to one void if `overlap = (r1 + r2 - distance) / min(r1, r2) >= merge_overlap`, for neighbours
//! and neighbours' neighbours, transitively. Two kinds have no usable insphere:
//! - wide gradations have tetrahedra without an insphere: they join all four neighbours;
//! - four grains (nearly) on one circle make a flat tetrahedron, whose sphere may lie anywhere on the
//!   axis of that circle. It is a window, not a void: it joins the neighbour with the largest sphere and
//!   never links two.
//!
//! Also here: the region of a packing that is used for statistics, and anomalies of its grains.

use super::discs::{Tangent, sphere};
use super::triangulation::{GrainPoint, Shift, Triangulation, cross, dot, edges, facet, offset, six_volume};
use rayon::prelude::*;
use std::collections::HashSet;

/// A tetrahedron is flat if six times its volume is below this fraction of the product of the three
/// edges at every corner (the sine of its widest solid angle). Lattices jittered by 1e-6 of a grain have
/// 1e-5; no tetrahedron of the disordered packings tested was flat.
const FLAT: f64 = 1e-4;

/// Height above the plane of a facet, as a fraction of the tetrahedron's height, below which a grain
/// counts as in the plane.
const COPLANAR: f64 = 1e-4;

/// Kind of a tetrahedron, with its insphere if it has one, in grid units.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Insphere {
    /// Sphere tangent to its grains, in its stored translate.
    Sphere(Tangent<3>),
    /// No sphere touches all four grains from between them.
    Open,
    /// Four grains on one circle.
    Flat,
}

pub(super) struct Voids {
    /// Void by tetrahedron, numbered in the order of their first tetrahedra.
    pub(super) by_tetrahedron: Vec<u32>,
    /// Translate of each tetrahedron that belongs to the same image of the void as the stored translate
    /// of the void's first tetrahedron.
    pub(super) shift: Vec<Shift>,
    /// True for each void that meets an image of itself, and so extends through the whole periodic cell.
    pub(super) endless: Vec<bool>,
    pub(super) count: usize,
    pub(super) inspheres: Vec<Insphere>,
    pub(super) merge_overlap: f64,
}

impl Voids {
    pub(super) fn merge(t: &Triangulation, merge_overlap: f64) -> Self {
        let inspheres: Vec<Insphere> =
            (0..t.tetrahedra()).into_par_iter().with_min_len(1024).map(|i| insphere(&t.stored(i))).collect();
        let pairs: Vec<(u32, u32, Shift)> = (0..t.tetrahedra())
            .into_par_iter()
            .with_min_len(1024)
            .flat_map_iter(|i| joined(t, &inspheres, merge_overlap, i))
            .collect();
        let mut sets = Sets::new(t.tetrahedra());
        let meets_itself: Vec<u32> =
            pairs.into_iter().filter(|&(a, b, by)| !sets.unite(a, b, by)).map(|(a, _, _)| a).collect();
        let mut number = vec![u32::MAX; t.tetrahedra()];
        let mut count = 0;
        let (by_tetrahedron, shift): (Vec<u32>, Vec<Shift>) = (0..t.tetrahedra() as u32)
            .map(|i| {
                let (root, shift) = sets.root(i);
                let number = &mut number[root as usize];
                if *number == u32::MAX {
                    *number = count;
                    count += 1;
                }
                (*number, shift)
            })
            .unzip();
        let mut endless = vec![false; count as usize];
        meets_itself.iter().for_each(|&i| endless[by_tetrahedron[i as usize] as usize] = true);
        Self { by_tetrahedron, shift, endless, count: count as usize, inspheres, merge_overlap }
    }

    /// Tells if the facet opposite a corner lies on the convex hull of the grain centres of its
    /// tetrahedron's void.
    pub(super) fn on_hull(&self, t: &Triangulation, tetrahedron: usize, corner: usize) -> bool {
        let corners = t.stored(tetrahedron);
        let [a, b, c] = facet(&corners, corner);
        let normal = cross(&offset(&a, &b), &offset(&a, &c));
        let height = |p: &GrainPoint| dot(&offset(&a, p), &normal);
        let inside = height(&corners[corner]);
        let void = self.by_tetrahedron[tetrahedron];
        let mut seen = HashSet::from([tetrahedron]);
        let mut open = vec![(tetrahedron, Shift::ZERO)];
        while let Some((at, shift)) = open.pop() {
            // Grains in the plane of the facet (a square window) count as on the inner side.
            let beyond = |p: &GrainPoint| height(p) * inside.signum() < -COPLANAR * inside.abs();
            if t.at(at, shift).iter().any(beyond) {
                return false;
            }
            for (u, _, further) in (0..4).filter_map(|k| t.across(at, k)) {
                if self.by_tetrahedron[u] == void && seen.insert(u) {
                    open.push((u, shift.plus(further)));
                }
            }
        }
        true
    }
}

fn insphere(corners: &[GrainPoint; 4]) -> Insphere {
    let six = six_volume(&edges(corners, 0));
    let length = |a: usize, b: usize| {
        let edge = offset(&corners[a], &corners[b]);
        dot(&edge, &edge).sqrt()
    };
    let is_flat = (0..4).all(|a| {
        let product: f64 = (0..4).filter(|&b| b != a).map(|b| length(a, b)).product();
        six < FLAT * product
    });
    if is_flat { Insphere::Flat } else { sphere(corners).map_or(Insphere::Open, Insphere::Sphere) }
}

/// Finds the tetrahedra that tetrahedron `i` joins to a void: pairs of `i` and the other, and the
/// translate of the other next to the stored one of `i`.
fn joined(t: &Triangulation, inspheres: &[Insphere], merge_overlap: f64, i: usize) -> Vec<(u32, u32, Shift)> {
    let neighbours = (0..4).filter_map(|k| t.across(i, k).map(|(u, _, shift)| (u, shift)));
    let pair = |(u, shift): (usize, Shift)| (i as u32, u as u32, shift);
    match inspheres[i] {
        Insphere::Open => neighbours.map(pair).collect(),
        Insphere::Flat => {
            let radius = |u: usize| if let Insphere::Sphere(s) = inspheres[u] { s.radius } else { 0.0 };
            neighbours
                .reduce(|best, u| if (radius(u.0), best.0) > (radius(best.0), u.0) { u } else { best })
                .map(pair)
                .into_iter()
                .collect()
        }
        Insphere::Sphere(sphere) => {
            let mut pairs = Vec::new();
            let mut test = |u: usize, shift: Shift| {
                // Each pair is found from both sides.
                if u > i
                    && let Insphere::Sphere(other) = inspheres[u]
                {
                    let by = t.displacement(shift);
                    let d: [f64; 3] =
                        std::array::from_fn(|axis| other.centre[axis] + by[axis] - sphere.centre[axis]);
                    let overlap = sphere.radius + other.radius - dot(&d, &d).sqrt();
                    if overlap >= merge_overlap * sphere.radius.min(other.radius) {
                        pairs.push(pair((u, shift)));
                    }
                }
            };
            for (u, shift) in neighbours {
                test(u, shift);
                for (w, _, further) in (0..4).filter_map(|k| t.across(u, k)) {
                    test(w, shift.plus(further));
                }
            }
            pairs
        }
    }
}

/// Disjoint sets, each identified by its smallest member, whatever the order of the unions. Each member
/// stores the translate that belongs with the stored translate of its set's smallest member.
struct Sets {
    above: Vec<u32>,
    /// Translate of each member that belongs with the stored one of the member above it.
    shift: Vec<Shift>,
}

impl Sets {
    fn new(members: usize) -> Self {
        Self { above: (0..members as u32).collect(), shift: vec![Shift::ZERO; members] }
    }

    /// Returns the smallest member of the set of `i`, and the translate of `i` that belongs with it.
    fn root(&mut self, i: u32) -> (u32, Shift) {
        let mut at = i as usize;
        let mut shift = Shift::ZERO;
        while self.above[at] as usize != at {
            let above = self.above[at] as usize;
            // Halves the path for the next search.
            self.shift[at] = self.shift[at].plus(self.shift[above]);
            self.above[at] = self.above[above];
            shift = shift.plus(self.shift[at]);
            at = self.above[at] as usize;
        }
        (at as u32, shift)
    }

    /// Joins the sets of `a` and `b`, where translate `by` of `b` belongs with the stored one of `a`.
    /// False if they are already in one set by another translate.
    fn unite(&mut self, a: u32, b: u32, by: Shift) -> bool {
        let ((root_a, of_a), (root_b, of_b)) = (self.root(a), self.root(b));
        let between = of_a.plus(by).minus(of_b);
        if root_a == root_b {
            return between == Shift::ZERO;
        }
        let (below, above, shift) = match root_a < root_b {
            true => (root_b, root_a, between),
            false => (root_a, root_b, Shift::ZERO.minus(between)),
        };
        self.above[below as usize] = above;
        self.shift[below as usize] = shift;
        true
    }
}

/// Fraction of a free packing's extent, at either end of each axis, that statistics leave out.
const OUTER_SHARE: f64 = 0.05;

/// Region used for statistics (mm).
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Region {
    Everything,
    Box { low_mm: [f64; 3], high_mm: [f64; 3] },
}

impl Region {
    /// Makes the whole cell, or a free packing without the outer fraction at either end.
    pub(super) fn new(t: &Triangulation) -> Self {
        if t.cell().is_some() {
            return Region::Everything;
        }
        let bound = |share: f64| {
            t.in_mm(std::array::from_fn(|axis| {
                let values = || t.spheres().iter().map(|s| s[axis]);
                let (low, high) =
                    (values().fold(f64::INFINITY, f64::min), values().fold(f64::NEG_INFINITY, f64::max));
                low + share * (high - low)
            }))
        };
        Region::Box { low_mm: bound(OUTER_SHARE), high_mm: bound(1.0 - OUTER_SHARE) }
    }

    pub(super) fn holds(&self, p: &[f64; 3]) -> bool {
        match self {
            Region::Everything => true,
            Region::Box { low_mm, high_mm } => {
                (0..3).all(|axis| low_mm[axis] <= p[axis] && p[axis] <= high_mm[axis])
            }
        }
    }
}

/// Depth within the hull of all centres, as a fraction of the grain's radius, at which a grain counts as
/// surrounded.
const WITHIN: f64 = 0.5;

/// Tells if a grain is surrounded by others; in a periodic cell every grain is.
pub(super) fn is_surrounded(t: &Triangulation) -> bool {
    let planes: Vec<(GrainPoint, [f64; 3])> = (0..t.tetrahedra())
        .flat_map(|i| (0..4).map(move |k| (i, k)))
        .filter(|&(i, k)| t.across(i, k).is_none())
        .map(|(i, k)| {
            let corners = t.stored(i);
            let [a, b, c] = facet(&corners, k);
            let normal = cross(&offset(&a, &b), &offset(&a, &c));
            let length = dot(&normal, &normal).sqrt().copysign(dot(&normal, &offset(&a, &corners[k])));
            (a, normal.map(|n| n / length))
        })
        .collect();
    t.spheres().iter().any(|s| planes.iter().all(|(a, normal)| dot(normal, &offset(a, s)) > WITHIN * s[3]))
}

/// Void ratio of the tetrahedra whose centroid lies in a region, from their volume and the sectors
/// filled by their grains.
pub(super) fn void_ratio_within(t: &Triangulation, region: &Region) -> f64 {
    let (mut whole, mut solid) = (0.0, 0.0);
    for i in 0..t.tetrahedra() {
        let c = t.stored(i);
        let centroid = std::array::from_fn(|axis| 0.25 * (c[0][axis] + c[1][axis] + c[2][axis] + c[3][axis]));
        if !region.holds(&t.inside_mm(centroid)) {
            continue;
        }
        for a in 0..4 {
            let edges = edges(&c, a);
            let six = six_volume(&edges);
            solid += solid_angle(&edges, six) / 3.0 * c[a][3] * c[a][3] * c[a][3];
            if a == 0 {
                whole += six / 6.0;
            }
        }
    }
    (whole - solid) / solid
}

/// Solid angle between three edges from a corner; `six` is six times the volume of their tetrahedron (Van
/// Oosterom & Strackee, doi:10.1109/TBME.1983.325207).
pub(super) fn solid_angle(edges: &[[f64; 3]; 3], six: f64) -> f64 {
    let [l, m, n] = edges.map(|e| dot(&e, &e).sqrt());
    let [e, f, g] = edges;
    let below = l * m * n + dot(e, f) * n + dot(e, g) * m + dot(f, g) * l;
    2.0 * libm::atan2(six, below)
}

/// Distance of two centres, over the smaller diameter, below which they are one grain that occurs twice.
pub(super) const SAME_GRAIN: f64 = 1e-3;

/// Distance of two centres, over the smaller diameter, below which they are probably one grain.
pub(super) const NEAR: f64 = 0.25;

/// Adds to `pairs` the neighbours nearer than this fraction of the smaller diameter.
pub(super) fn nearer(share: f64, t: &Triangulation, mut pairs: Vec<[u32; 2]>) -> Vec<[u32; 2]> {
    for i in 0..t.tetrahedra() {
        let (grains, at) = (t.corners(i), t.stored(i));
        for (a, b) in [(0, 1), (0, 2), (0, 3), (1, 2), (1, 3), (2, 3)] {
            let near = share * 2.0 * at[a][3].min(at[b][3]);
            let apart = offset(&at[a], &at[b]);
            if dot(&apart, &apart) < near * near {
                pairs.push([grains[a].max(grains[b]), grains[a].min(grains[b])]);
            }
        }
    }
    pairs.sort_unstable();
    pairs.dedup();
    pairs
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sets_know_which_translates_go_together() {
        let mut sets = Sets::new(5);
        let by = |x| Shift::new([x, 0, -x]);
        assert!(sets.unite(3, 4, by(1)) && sets.unite(1, 2, by(2)) && sets.unite(4, 2, by(-1)));
        // 1 is the smallest; with it belong 2 at 2, 4 at 2 + 1, and 3 at 3 - 1.
        for (member, shift) in [(1, 0), (2, 2), (4, 3), (3, 2)] {
            assert_eq!(sets.root(member), (1, by(shift)), "{member}");
        }
        assert!(sets.unite(1, 3, by(2)) && !sets.unite(1, 3, by(1)));
        assert_eq!(sets.root(0), (0, Shift::ZERO));
    }
}
