//! Voids: tetrahedra whose inspheres overlap.
//!
//! A tetrahedron's insphere is the sphere tangent to its four grains from between them. Two tetrahedra belong
//! to one void when `overlap = (r1 + r2 - distance) / min(r1, r2) >= merge_overlap`, for neighbours and
//! neighbours' neighbours, transitively. Two kinds have no such sphere to go by:
//! - wide gradings have tetrahedra without one: they join all four neighbours;
//! - four grains (nearly) on one circle make a flat tetrahedron, whose sphere may lie anywhere on the
//!   axis of that circle. It is a window, not a void: it joins the neighbour with the largest sphere
//!   and never links two.

use super::tangent::{Tangent, cross, sphere};
use super::triangulation::{GrainPoint, Positions, Shift, Triangulation};
use rayon::prelude::*;
use std::collections::HashSet;

/// A tetrahedron is flat when six times its volume is below this part of the product of the three
/// edges at every corner (the sine of its widest solid angle). Lattices jittered by 1e-6 of a grain
/// have 1e-5; no tetrahedron of the disordered packings tried was flat.
const FLAT: f64 = 1e-4;

/// A grain beyond the plane of a facet by less than this part of the tetrahedron's height is in it.
const COPLANAR: f64 = 1e-4;

/// What a tetrahedron encloses, in grid units.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Insphere {
    /// The sphere tangent to its grains, in its stored translate.
    Sphere(Tangent<3>),
    /// No sphere touches all four from between them.
    Open,
    /// Four grains on one circle.
    Flat,
}

/// The void of each tetrahedron.
pub(super) struct Voids {
    /// Void by tetrahedron, numbered by their first tetrahedra.
    pub(super) of: Vec<u32>,
    /// Number of voids.
    pub(super) count: usize,
    /// Insphere by tetrahedron.
    pub(super) inspheres: Vec<Insphere>,
}

impl Voids {
    pub(super) fn merge(t: &Triangulation, positions: &Positions<'_>, merge_overlap: f64) -> Self {
        let inspheres: Vec<Insphere> = (0..t.tetrahedra())
            .into_par_iter()
            .with_min_len(1024)
            .map(|i| insphere(&t.at(positions, i, Shift::ZERO)))
            .collect();
        let pairs: Vec<[u32; 2]> = (0..t.tetrahedra())
            .into_par_iter()
            .with_min_len(1024)
            .flat_map_iter(|i| joined(t, positions, &inspheres, merge_overlap, i))
            .collect();
        let mut sets = Sets((0..t.tetrahedra() as u32).collect());
        for [a, b] in pairs {
            sets.unite(a, b);
        }
        let mut number = vec![u32::MAX; t.tetrahedra()];
        let mut count = 0;
        let of = (0..t.tetrahedra() as u32)
            .map(|i| {
                let root = sets.root(i) as usize;
                if number[root] == u32::MAX {
                    number[root] = count;
                    count += 1;
                }
                number[root]
            })
            .collect();
        Self { of, count: count as usize, inspheres }
    }
}

impl Voids {
    /// Whether the facet opposite a corner lies on the convex hull of the grain centres of its
    /// tetrahedron's void.
    pub(super) fn on_hull(
        &self,
        t: &Triangulation,
        positions: &Positions<'_>,
        tetrahedron: usize,
        corner: usize,
    ) -> bool {
        let own = t.at(positions, tetrahedron, Shift::ZERO);
        let [a, b, c] = [1, 2, 3].map(|k| own[(corner + k) % 4]);
        let from_a = |p: &GrainPoint| -> [f64; 3] { std::array::from_fn(|axis| p[axis] - a[axis]) };
        let normal = cross(&from_a(&b), &from_a(&c));
        let height = |p: &GrainPoint| {
            let d = from_a(p);
            d[0] * normal[0] + d[1] * normal[1] + d[2] * normal[2]
        };
        let inside = height(&own[corner]);
        let void = self.of[tetrahedron];
        let mut seen = HashSet::from([tetrahedron]);
        let mut open = vec![(tetrahedron, Shift::ZERO)];
        while let Some((at, shift)) = open.pop() {
            // Grains in the plane of the facet (a square window) count as on its side.
            let beyond = |p: &GrainPoint| height(p) * inside.signum() < -COPLANAR * inside.abs();
            if t.at(positions, at, shift).iter().any(beyond) {
                return false;
            }
            for (u, _, further) in (0..4).filter_map(|k| t.across(at, k)) {
                if self.of[u] == void && seen.insert(u) {
                    open.push((u, shift.plus(further)));
                }
            }
        }
        true
    }
}

fn insphere(corners: &[GrainPoint; 4]) -> Insphere {
    if is_flat(corners) {
        return Insphere::Flat;
    }
    sphere(corners).map_or(Insphere::Open, Insphere::Sphere)
}

fn is_flat(corners: &[GrainPoint; 4]) -> bool {
    let edge =
        |a: usize, b: usize| -> [f64; 3] { std::array::from_fn(|axis| corners[b][axis] - corners[a][axis]) };
    let length = |a: usize, b: usize| {
        let e = edge(a, b);
        (e[0] * e[0] + e[1] * e[1] + e[2] * e[2]).sqrt()
    };
    let normal = cross(&edge(0, 2), &edge(0, 3));
    let e = edge(0, 1);
    let six = (e[0] * normal[0] + e[1] * normal[1] + e[2] * normal[2]).abs();
    (0..4).all(|a| {
        let product: f64 = (0..4).filter(|&b| b != a).map(|b| length(a, b)).product();
        six < FLAT * product
    })
}

/// The tetrahedra that tetrahedron `i` shares its void with, by what can be seen from it.
fn joined(
    t: &Triangulation,
    positions: &Positions<'_>,
    inspheres: &[Insphere],
    merge_overlap: f64,
    i: usize,
) -> Vec<[u32; 2]> {
    let neighbours = (0..4).filter_map(|k| t.across(i, k).map(|(u, _, shift)| (u, shift)));
    let pair = |u: usize| [i as u32, u as u32];
    match inspheres[i] {
        Insphere::Open => neighbours.map(|(u, _)| pair(u)).collect(),
        Insphere::Flat => {
            let radius = |u: usize| if let Insphere::Sphere(s) = inspheres[u] { s.radius } else { 0.0 };
            neighbours
                .map(|(u, _)| u)
                .reduce(|best, u| if (radius(u), best) > (radius(best), u) { u } else { best })
                .map(pair)
                .into_iter()
                .collect()
        }
        Insphere::Sphere(own) => {
            let mut found = Vec::new();
            let mut test = |u: usize, shift: Shift| {
                // Each pair is seen from both sides.
                if u > i
                    && let Insphere::Sphere(other) = inspheres[u]
                {
                    let by = positions.displacement(shift);
                    let d: [f64; 3] =
                        std::array::from_fn(|axis| other.centre[axis] + by[axis] - own.centre[axis]);
                    let distance = (d[0] * d[0] + d[1] * d[1] + d[2] * d[2]).sqrt();
                    let overlap = own.radius + other.radius - distance;
                    if overlap >= merge_overlap * own.radius.min(other.radius) {
                        found.push(pair(u));
                    }
                }
            };
            for (u, shift) in neighbours {
                test(u, shift);
                for (w, _, further) in (0..4).filter_map(|k| t.across(u, k)) {
                    test(w, shift.plus(further));
                }
            }
            found
        }
    }
}

/// Disjoint sets; each is known by its smallest member, whatever the order of the unions.
struct Sets(Vec<u32>);

impl Sets {
    fn root(&mut self, mut i: u32) -> u32 {
        while self.0[i as usize] != i {
            let above = self.0[self.0[i as usize] as usize];
            self.0[i as usize] = above;
            i = above;
        }
        i
    }

    fn unite(&mut self, a: u32, b: u32) {
        let (a, b) = (self.root(a), self.root(b));
        self.0[a.max(b) as usize] = a.min(b);
    }
}
