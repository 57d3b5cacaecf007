//! The disc of a facet: the largest that passes between its three grains.
//!
//! The disc is the circle tangent to the three grains in the plane of their centres. If further grains cut
//! into it, it is the largest circle through any three of the grains concerned (their sections by that plane)
//! that none of the others cuts: Reboul, Vincens & Cambou, *A computational procedure to assess the
//! distribution of constriction sizes for an assembly of spheres*, doi:10.1016/j.compgeo.2009.09.002. The
//! others are the corners of the two tetrahedra at the facet, of their neighbours and of their neighbours'
//! neighbours: on packings of Cu 1.5 and Cu 3 a search one step further cut no further disc.

use super::tangent::{Tangent, circle, cross};
use super::triangulation::{GrainPoint, Positions, Shift, Triangulation};

/// Cuts shallower than this part of the disc's radius are contacts.
const CONTACT: f64 = 1e-9;

/// Grains that may cut into a disc at the same time; more are not tried.
const MOST_CUTTING: usize = 8;

/// Number of facets to search for other grains, from the disc's two tetrahedra.
const RINGS: usize = 2;

/// Opening through which grains may pass a facet, in grid units.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct ConstrictionDisc {
    /// Centre in the stored translate of the requested tetrahedron.
    pub(super) centre: [f64; 3],
    /// Radius; zero if the grains leave no room.
    pub(super) radius: f64,
    /// True if a further grain cuts into the circle tangent to the three.
    pub(super) cut: bool,
}

/// The plane of a facet: coordinates along `u`, `v`, and `w` above it.
struct Plane {
    origin: GrainPoint,
    axes: [[f64; 3]; 3],
}

impl Plane {
    fn through(facet: &[GrainPoint; 3]) -> Self {
        let along = |k: usize| -> [f64; 3] { std::array::from_fn(|axis| facet[k][axis] - facet[0][axis]) };
        let unit = |v: [f64; 3]| {
            let length = (v[0] * v[0] + v[1] * v[1] + v[2] * v[2]).sqrt();
            v.map(|c| c / length)
        };
        let u = unit(along(1));
        let w = unit(cross(&u, &along(2)));
        Self { origin: facet[0], axes: [u, cross(&w, &u), w] }
    }

    fn local(&self, p: &GrainPoint) -> [f64; 3] {
        let d: [f64; 3] = std::array::from_fn(|axis| p[axis] - self.origin[axis]);
        self.axes.map(|a| a[0] * d[0] + a[1] * d[1] + a[2] * d[2])
    }

    /// Circle in which a grain meets the plane.
    fn section(&self, p: &GrainPoint) -> Option<[f64; 3]> {
        let [u, v, w] = self.local(p);
        let square = (p[3] - w) * (p[3] + w);
        (square > 0.0).then(|| [u, v, square.sqrt()])
    }

    fn global(&self, c: [f64; 2]) -> [f64; 3] {
        std::array::from_fn(|axis| {
            self.origin[axis] + (self.axes[0][axis] * c[0] + self.axes[1][axis] * c[1])
        })
    }
}

/// Finds the disc of the facet opposite a corner of a tetrahedron.
pub(super) fn disc(
    t: &Triangulation,
    positions: &Positions<'_>,
    tetrahedron: usize,
    corner: usize,
) -> ConstrictionDisc {
    let corners = t.at(positions, tetrahedron, Shift::ZERO);
    let facet = [1, 2, 3].map(|k| corners[(corner + k) % 4]);
    let plane = Plane::through(&facet);
    let sections = facet.map(|g| {
        let [u, v, _] = plane.local(&g);
        [u, v, g[3]]
    });
    let place = |circle: Option<Tangent<2>>, cut: bool| match circle {
        Some(Tangent { centre, radius }) => ConstrictionDisc { centre: plane.global(centre), radius, cut },
        None => ConstrictionDisc { centre: [facet[0][0], facet[0][1], facet[0][2]], radius: 0.0, cut },
    };
    let Some(first) = circle(&sections) else { return place(None, false) };
    // Few discs are cut: look for one cutting grain before listing all.
    let (centre, mut cut) = (plane.global(first.centre), false);
    around(t, positions, tetrahedron, corner, |grain| {
        let d: [f64; 3] = std::array::from_fn(|axis| grain[axis] - centre[axis]);
        let reach = grain[3] + first.radius;
        if d[0] * d[0] + d[1] * d[1] + d[2] * d[2] < reach * reach && !facet.contains(grain) {
            cut |= plane.section(grain).is_some_and(|section| cuts(&first, &section));
        }
    });
    if !cut {
        return place(Some(first), false);
    }
    let mut others = Vec::new();
    around(t, positions, tetrahedron, corner, |grain| {
        if !facet.contains(grain)
            && let Some(section) = plane.section(grain)
        {
            others.push(section);
        }
    });
    place(largest(&sections, &others, &first), true)
}

/// Tells if a circle reaches into a tangent one.
fn cuts(disc: &Tangent<2>, other: &[f64; 3]) -> bool {
    let (x, y) = (other[0] - disc.centre[0], other[1] - disc.centre[1]);
    (x * x + y * y).sqrt() < other[2] + disc.radius * (1.0 - CONTACT)
}

/// Finds the largest circle through three of the grains concerned that no other grain cuts.
fn largest(facet: &[[f64; 3]; 3], others: &[[f64; 3]], first: &Tangent<2>) -> Option<Tangent<2>> {
    let mut concerned = facet.to_vec();
    concerned.extend(others.iter().filter(|other| cuts(first, other)).take(MOST_CUTTING));
    let mut best: Option<Tangent<2>> = None;
    for a in 0..concerned.len() {
        for b in a + 1..concerned.len() {
            for c in b + 1..concerned.len() {
                let Some(disc) = circle(&[concerned[a], concerned[b], concerned[c]]) else { continue };
                if best.is_none_or(|best| disc.radius > best.radius)
                    && !facet.iter().chain(others).any(|other| cuts(&disc, other))
                {
                    best = Some(disc);
                }
            }
        }
    }
    best
}

/// Visits the corners of the tetrahedra within [`RINGS`] of a facet, in its tetrahedron's translate.
fn around(
    t: &Triangulation,
    positions: &Positions<'_>,
    tetrahedron: usize,
    corner: usize,
    mut visit: impl FnMut(&GrainPoint),
) {
    visit(&t.corner_at(positions, tetrahedron, corner, Shift::ZERO));
    beyond(t, positions, (tetrahedron, Shift::ZERO, corner), RINGS, &mut visit);
    if let Some((u, j, shift)) = t.across(tetrahedron, corner) {
        visit(&t.corner_at(positions, u, j, shift));
        beyond(t, positions, (u, shift, j), RINGS, &mut visit);
    }
}

/// Corners beyond the facets of a tetrahedron, except the facet of entry.
fn beyond(
    t: &Triangulation,
    positions: &Positions<'_>,
    (tetrahedron, translate, entered): (usize, Shift, usize),
    rings: usize,
    visit: &mut impl FnMut(&GrainPoint),
) {
    if rings == 0 {
        return;
    }
    for i in (0..4).filter(|&i| i != entered) {
        if let Some((u, j, shift)) = t.across(tetrahedron, i) {
            let shift = translate.plus(shift);
            visit(&t.corner_at(positions, u, j, shift));
            beyond(t, positions, (u, shift, j), rings - 1, visit);
        }
    }
}
