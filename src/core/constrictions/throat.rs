//! The water around a facet, and its conductance.
//!
//! After Chareyre, Cortis, Catalano & Barthelemy (2012), *Pore-scale modeling of viscous flow and induced
//! forces in dense sphere packings*, doi:10.1007/s11242-011-9915-6. A throat is the bipyramid of a facet and
//! the power centres on either side of it. Its hydraulic radius is the volume of water in it over the surface
//! of grains in it, `R_h = phi / gamma`, and it conducts
//!
//! ```text
//! g = A_f R_h^2 / (2 mu L)
//! ```
//! with `A_f` the part of the facet outside the grains and `L` the path between the two voids. Volumes and
//! solid angles have a sign: a power centre on the far side of a facet subtracts. So the sums over all facets
//! are exactly the volume of the voids and the surface of the grains.

use super::tangent::cross;
use super::triangulation::GrainPoint;

/// Water and grains in the bipyramid of a facet, in grid units.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Throat {
    /// Volume of water.
    pub(super) volume: f64,
    /// Surface of grains.
    pub(super) surface: f64,
    /// Area of the facet outside its grains.
    pub(super) area: f64,
}

impl Throat {
    /// Makes the throat of the facet between two tetrahedra from its grains, the corner opposite it on this
    /// side, and the power centres of both sides.
    pub(super) fn new(facet: &[GrainPoint; 3], inside: &GrainPoint, centres: [&[f64; 3]; 2]) -> Self {
        let [first, second] = centres;
        let here = half(facet, inside, first);
        // The far side's inside is this side's outside.
        let there = half(facet, inside, second);
        Self { volume: here.0 - there.0, surface: here.1 - there.1, area: open_area(facet) }
    }

    /// Conductance times viscosity over a path of `length`; zero if the bipyramid holds no water or no grain.
    pub(super) fn conductance(&self, length: f64) -> f64 {
        if self.volume <= 0.0 || self.surface <= 0.0 {
            return 0.0;
        }
        let radius = self.volume / self.surface;
        self.area * radius * radius / (2.0 * length)
    }
}

/// Volume of water and surface of grains between a facet and a point, positive if the point is on the side of
/// `inside`.
fn half(facet: &[GrainPoint; 3], inside: &GrainPoint, apex: &[f64; 3]) -> (f64, f64) {
    let from = |p: &GrainPoint, q: &[f64]| -> [f64; 3] { std::array::from_fn(|axis| q[axis] - p[axis]) };
    let (e, f) = (from(&facet[0], &facet[1]), from(&facet[0], &facet[2]));
    let normal = cross(&e, &f);
    let six = dot(&normal, &from(&facet[0], apex));
    let sign = six.signum() * dot(&normal, &from(&facet[0], inside)).signum();
    let (mut volume, mut surface) = (six.abs() / 6.0, 0.0);
    for k in 0..3 {
        let grain = &facet[k];
        let edges = [&facet[(k + 1) % 3][..], &facet[(k + 2) % 3][..], &apex[..]].map(|q| from(grain, q));
        let angle = solid_angle(&edges, six.abs());
        let square = grain[3] * grain[3];
        volume -= angle * square * grain[3] / 3.0;
        surface += angle * square;
    }
    (sign * volume, sign * surface)
}

/// Solid angle between three edges from a corner; `six` is six times the volume of their tetrahedron (Van
/// Oosterom & Strackee, doi:10.1109/TBME.1983.325207).
pub(super) fn solid_angle(edges: &[[f64; 3]; 3], six: f64) -> f64 {
    let [l, m, n] = edges.map(|e| dot(&e, &e).sqrt());
    let [e, f, g] = edges;
    let below = l * m * n + dot(e, f) * n + dot(e, g) * m + dot(f, g) * l;
    2.0 * libm::atan2(six, below)
}

/// Area of a facet less the sectors of its three grains, each up to the opposite edge.
fn open_area(facet: &[GrainPoint; 3]) -> f64 {
    let edge =
        |a: usize, b: usize| -> [f64; 3] { std::array::from_fn(|axis| facet[b][axis] - facet[a][axis]) };
    let normal = cross(&edge(0, 1), &edge(0, 2));
    let area = 0.5 * dot(&normal, &normal).sqrt();
    let covered: f64 = (0..3)
        .map(|k| {
            let (b, c) = ((k + 1) % 3, (k + 2) % 3);
            let opposite = edge(b, c);
            let along = dot(&opposite, &opposite).sqrt();
            let height = 2.0 * area / along;
            // Angles of the two edges at this grain, from the perpendicular onto the opposite edge.
            let angle = |to: usize| libm::atan2(dot(&edge(k, to), &opposite) / along, height);
            sector(facet[k][3], height, angle(b), angle(c))
        })
        .sum();
    (area - covered).max(0.0)
}

/// Area of a circle's sector between two angles from the perpendicular onto a line, up to that line.
fn sector(radius: f64, height: f64, from: f64, to: f64) -> f64 {
    let reach = if radius > height { libm::acos(height / radius) } else { 0.0 };
    let (cut_from, cut_to) = (from.clamp(-reach, reach), to.clamp(-reach, reach));
    let round = (to - from) - (cut_to - cut_from);
    0.5 * radius * radius * round + 0.5 * height * height * (libm::tan(cut_to) - libm::tan(cut_from))
}

/// Point of equal power to the four grains of a tetrahedron; not finite if they lie in a plane.
pub(super) fn power_centre(corners: &[GrainPoint; 4]) -> [f64; 3] {
    let origin = corners[0];
    let others = [corners[1], corners[2], corners[3]];
    let d = others.map(|g| [g[0] - origin[0], g[1] - origin[1], g[2] - origin[2]]);
    let right: [f64; 3] = std::array::from_fn(|k| {
        let delta = others[k][3] - origin[3];
        0.5 * (dot(&d[k], &d[k]) - delta * (others[k][3] + origin[3]))
    });
    let normals = [cross(&d[1], &d[2]), cross(&d[2], &d[0]), cross(&d[0], &d[1])];
    let volume = dot(&d[0], &normals[0]);
    std::array::from_fn(|axis| {
        origin[axis] + (0..3).map(|k| right[k] * normals[k][axis]).sum::<f64>() / volume
    })
}

fn dot(a: &[f64], b: &[f64]) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_equilateral_facet_loses_half_a_circle() {
        let h = 3f64.sqrt() / 2.0;
        let facet = [[0.0, 0.0, 0.0, 0.5], [1.0, 0.0, 0.0, 0.5], [0.5, h, 0.0, 0.5]];
        let half_circle = std::f64::consts::PI / 8.0;
        assert!((open_area(&facet) - (0.5 * h - half_circle)).abs() < 1e-15);
    }

    /// A grain that reaches beyond the opposite edge covers no more of the facet than the facet has.
    #[test]
    fn a_sector_ends_at_the_opposite_edge() {
        let long = |r| sector(r, 1.0, -0.4, 0.7);
        let triangle = 0.5 * (libm::tan(0.7) + libm::tan(0.4));
        assert!((long(10.0) - triangle).abs() < 1e-15);
        assert!((long(1.0) - 0.5 * 1.1).abs() < 1e-15);
        // Between the two: by quadrature.
        let steps = 100_000;
        let sum: f64 = (0..steps)
            .map(|k| {
                let angle = -0.4 + 1.1 * (f64::from(k) + 0.5) / f64::from(steps);
                let reach = 1.1f64.min(1.0 / libm::cos(angle));
                0.5 * reach * reach * 1.1 / f64::from(steps)
            })
            .sum();
        assert!((long(1.1) - sum).abs() < 1e-9);
        // The perpendicular may fall outside.
        assert!((sector(0.5, 1.0, 0.3, 0.9) - 0.5 * 0.25 * 0.6).abs() < 1e-15);
    }

    #[test]
    fn a_power_centre_has_one_power() {
        let corners =
            [[0.0, 0.0, 0.0, 0.3], [1.0, 0.1, 0.0, 0.5], [0.2, 1.0, 0.3, 0.1], [0.4, 0.3, 1.2, 0.6]];
        let centre = power_centre(&corners);
        let power = corners.map(|c| {
            let d: [f64; 3] = std::array::from_fn(|axis| centre[axis] - c[axis]);
            dot(&d, &d) - c[3] * c[3]
        });
        assert!(power.iter().all(|p| (p - power[0]).abs() < 1e-12), "{power:?}");
    }
}
