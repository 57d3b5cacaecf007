//! The disc of a facet: the largest that passes between its three grains. Tangent circles and spheres.
//!
//! The disc is the circle tangent to the three grains in the plane of their centres. If further grains cut
//! into it, it is the largest circle tangent to any three of these grains (their sections by that plane)
//! that no other grain cuts: Reboul, Vincens & Cambou, *A computational procedure to assess the
//! distribution of constriction sizes for an assembly of spheres*, doi:10.1016/j.compgeo.2009.09.002. The
//! further grains are the corners of the two tetrahedra at the facet, of their neighbours and of their
//! neighbours' neighbours: on packings of Cu 1.5 and Cu 3 a search one step further cut no further disc.
//!
//! # Tangents
//! Seen from the centre of the smallest grain (radius `r0`), a centre `q` at distance `s = rho + r0`
//! touches grain `k` (centre `d`, radius `r0 + delta`) if `d.q + s delta = (|d|^2 - delta^2) / 2`: linear
//! in `q` and `s`. So `q = A + B s`, and `|q| = s` is a quadratic equation. Differences of squares are
//! computed as products, so that a grain of 1 in a gap between grains of a million keeps its digits.

use super::triangulation::{GrainPoint, Shift, Triangulation, cross, dot, facet, offset};

/// Maximum depth of a cut that counts as a contact, as a fraction of the disc's radius.
const CONTACT: f64 = 1e-9;

/// Maximum number of grains that cut into a disc together; more are not tried.
const MOST_CUTTING: usize = 8;

/// Number of facets from the disc's two tetrahedra within which other grains are searched for.
const RINGS: usize = 2;

/// Opening through which particles may pass a facet, in grid units.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct ConstrictionDisc {
    /// Centre in the stored translate of the requested tetrahedron.
    pub(crate) centre: [f64; 3],
    /// Radius; zero if the grains leave no room.
    pub(crate) radius: f64,
    /// True if another grain cuts into the circle tangent to the three.
    pub(crate) cut: bool,
}

/// The plane of a facet: coordinates along `u` and `v`, and `w` normal to it.
struct Plane {
    origin: GrainPoint,
    axes: [[f64; 3]; 3],
}

impl Plane {
    fn through(facet: &[GrainPoint; 3]) -> Self {
        let unit = |v: [f64; 3]| {
            let length = dot(&v, &v).sqrt();
            v.map(|c| c / length)
        };
        let u = unit(offset(&facet[0], &facet[1]));
        let w = unit(cross(&u, &offset(&facet[0], &facet[2])));
        Self { origin: facet[0], axes: [u, cross(&w, &u), w] }
    }

    fn local(&self, p: &GrainPoint) -> [f64; 3] {
        let d = offset(&self.origin, p);
        self.axes.map(|a| dot(&a, &d))
    }

    /// Circle in which a grain intersects the plane.
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
pub(super) fn disc(t: &Triangulation, tetrahedron: usize, corner: usize) -> ConstrictionDisc {
    let facet = facet(&t.stored(tetrahedron), corner);
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
    // Few discs are cut: search for one cutting grain before listing all.
    let (centre, mut cut) = (plane.global(first.centre), false);
    around(t, tetrahedron, corner, |grain| {
        let d = offset(&centre, grain);
        let reach = grain[3] + first.radius;
        if dot(&d, &d) < reach * reach && !facet.contains(grain) {
            cut |= plane.section(grain).is_some_and(|section| cuts(&first, &section));
        }
    });
    if !cut {
        return place(Some(first), false);
    }
    let mut others = Vec::new();
    around(t, tetrahedron, corner, |grain| {
        others.extend(plane.section(grain).filter(|_| !facet.contains(grain)));
    });
    place(largest(&sections, &others, &first), true)
}

fn cuts(disc: &Tangent<2>, other: &[f64; 3]) -> bool {
    let (x, y) = (other[0] - disc.centre[0], other[1] - disc.centre[1]);
    (x * x + y * y).sqrt() < other[2] + disc.radius * (1.0 - CONTACT)
}

/// Finds the largest circle tangent to three of these grains that no other grain cuts.
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
fn around(t: &Triangulation, tetrahedron: usize, corner: usize, mut visit: impl FnMut(&GrainPoint)) {
    let sides = [Some((tetrahedron, corner, Shift::ZERO)), t.across(tetrahedron, corner)];
    for (u, j, shift) in sides.into_iter().flatten() {
        visit(&t.corner_at(u, j, shift));
        beyond(t, (u, shift, j), RINGS, &mut visit);
    }
}

/// Visits the corners beyond the facets of a tetrahedron, except beyond the facet of entry.
fn beyond(
    t: &Triangulation,
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
            visit(&t.corner_at(u, j, shift));
            beyond(t, (u, shift, j), rings - 1, visit);
        }
    }
}

/// A tangent circle or sphere: its centre and radius.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Tangent<const N: usize> {
    pub(crate) centre: [f64; N],
    pub(crate) radius: f64,
}

/// `(|d|^2 - delta^2) / 2`.
fn half_power<const N: usize>(d: &[f64; N], delta: f64) -> f64 {
    let length = dot(d, d).sqrt();
    0.5 * (length - delta) * (length + delta)
}

/// Solves `|A + B s| = s`: the smaller positive root. This root changes smoothly with the sizes; a
/// larger one, if any, comes from infinity (a sphere with the grains on its other side).
fn distance<const N: usize>(a: &[f64; N], b: &[f64; N]) -> Option<f64> {
    let (square, half, constant) = (dot(b, b) - 1.0, dot(a, b), dot(a, a));
    let discriminant = half * half - square * constant;
    if discriminant < 0.0 {
        return None;
    }
    let root = discriminant.sqrt();
    let s = if half <= 0.0 { constant / (root - half) } else { (-half - root) / square };
    (s.is_finite() && s > 0.0).then_some(s)
}

/// Makes a function that solves `d[k].x = right[k]` for `x`.
pub(super) fn solver(d: &[[f64; 3]; 3]) -> impl Fn([f64; 3]) -> [f64; 3] {
    let normals = [cross(&d[1], &d[2]), cross(&d[2], &d[0]), cross(&d[0], &d[1])];
    let volume = dot(&d[0], &normals[0]);
    move |right| std::array::from_fn(|axis| (0..3).map(|k| right[k] * normals[k][axis]).sum::<f64>() / volume)
}

/// Finds the sphere that touches four grains (centre and radius of each); `None` if there is no room.
pub(super) fn sphere(grains: &[[f64; 4]; 4]) -> Option<Tangent<3>> {
    let first = least(grains.map(|g| g[3]));
    let origin = grains[first];
    let others = [1, 2, 3].map(|k| grains[(first + k) % 4]);
    let d = others.map(|g| offset(&origin, &g));
    let delta = others.map(|g| g[3] - origin[3]);
    let solve = solver(&d);
    let a = solve(std::array::from_fn(|k| half_power(&d[k], delta[k])));
    let b = solve(delta.map(|delta| -delta));
    let s = distance(&a, &b)?;
    let centre = std::array::from_fn(|axis| origin[axis] + (a[axis] + b[axis] * s));
    (s > origin[3]).then_some(Tangent { centre, radius: s - origin[3] })
}

/// Finds the circle that touches three circles (centre and radius of each); `None` if there is no room.
pub(super) fn circle(circles: &[[f64; 3]; 3]) -> Option<Tangent<2>> {
    let first = least(circles.map(|c| c[2]));
    let origin = circles[first];
    let others = [1, 2].map(|k| circles[(first + k) % 3]);
    let d = others.map(|c| [c[0] - origin[0], c[1] - origin[1]]);
    let delta = others.map(|c| c[2] - origin[2]);
    let area = d[0][0] * d[1][1] - d[1][0] * d[0][1];
    let solve = |right: [f64; 2]| -> [f64; 2] {
        [(right[0] * d[1][1] - right[1] * d[0][1]) / area, (right[1] * d[0][0] - right[0] * d[1][0]) / area]
    };
    let a = solve([half_power(&d[0], delta[0]), half_power(&d[1], delta[1])]);
    let b = solve(delta.map(|delta| -delta));
    let s = distance(&a, &b)?;
    let centre = [origin[0] + (a[0] + b[0] * s), origin[1] + (a[1] + b[1] * s)];
    (s > origin[2]).then_some(Tangent { centre, radius: s - origin[2] })
}

fn least<const N: usize>(values: [f64; N]) -> usize {
    (1..N).fold(0, |best, i| if values[i] < values[best] { i } else { best })
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn touching(r: [f64; 3]) -> [[f64; 3]; 3] {
        let (ab, ac, bc) = (r[0] + r[1], r[0] + r[2], r[1] + r[2]);
        let x = (ab * ab + (r[0] - r[1]) * (ac + bc)) / (2.0 * ab);
        // Heron's formula, in a form that keeps the digits of thin triangles.
        let area = (r[0] * r[1] * r[2] * (r[0] + r[1] + r[2])).sqrt();
        [[0.0, 0.0, r[0]], [ab, 0.0, r[1]], [x, 2.0 * area / ab, r[2]]]
    }

    /// Known geometry: three equal grains give 0.154701 of their diameter; radii of wide ratios.
    #[test]
    fn known_discs() {
        for (r, expected) in [
            ([0.5, 0.5, 0.5], 0.154_701 / 2.0),
            ([1.0, 1.0, 10.0], 0.233_052),
            ([1.0, 10.0, 10.0], 0.472_475),
            ([1.0, 1e6, 1e6], 0.997_178),
            ([1e6, 1.0, 1e6], 0.997_178),
            ([1e6, 1e6, 1.0], 0.997_178),
        ] {
            let radius = circle(&touching(r)).unwrap().radius;
            assert!((radius / expected - 1.0).abs() < 3e-6, "{r:?}: {radius}");
        }
    }

    proptest! {
        /// Descartes: 1/r4 = k1 + k2 + k3 + 2 sqrt(k1 k2 + k2 k3 + k3 k1).
        #[test]
        fn touching_circles_obey_descartes(a in -3.0..3.0, b in -3.0..3.0, c in -3.0..3.0) {
            let r = [a, b, c].map(|e: f64| libm::pow(10.0, e));
            let k = r.map(|r| 1.0 / r);
            let pairs = k[0] * k[1] + k[1] * k[2] + k[2] * k[0];
            let expected = 1.0 / (k[0] + k[1] + k[2] + 2.0 * pairs.sqrt());
            let radius = circle(&touching(r)).unwrap().radius;
            prop_assert!((radius / expected - 1.0).abs() < 1e-8, "{r:?}: {radius} {expected}");
        }

        /// A tangent sphere is at its radius from all four grains.
        #[test]
        fn a_tangent_sphere_touches(
            v in prop::collection::vec(0.0..10.0, 12), r in prop::collection::vec(0.1..1.0, 4)) {
            let grains: [[f64; 4]; 4] = std::array::from_fn(|i| [v[3 * i], v[3 * i + 1], v[3 * i + 2], r[i]]);
            if let Some(tangent) = sphere(&grains) && tangent.radius < 1e3 {
                for g in grains {
                    let d = offset(&tangent.centre, &g);
                    let gap = dot(&d, &d).sqrt() - g[3] - tangent.radius;
                    prop_assert!(gap.abs() < 1e-6 * (1.0 + tangent.radius), "{gap}");
                }
            }
        }
    }
}
