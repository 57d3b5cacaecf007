//! Place of a packing in millimetres, and the part of it that statistics are taken over.

use super::tangent::cross;
use super::throat::solid_angle;
use super::triangulation::{Positions, Shift, Triangulation};

/// Share of a free packing's extent, at either end of each axis, that statistics leave out.
const OUTER_SHARE: f64 = 0.05;

/// Part of space that statistics are taken over (mm).
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Region {
    Everything,
    Box { low_mm: [f64; 3], high_mm: [f64; 3] },
}

impl Region {
    pub(super) fn holds(&self, p: &[f64; 3]) -> bool {
        match self {
            Region::Everything => true,
            Region::Box { low_mm, high_mm } => {
                (0..3).all(|axis| low_mm[axis] <= p[axis] && p[axis] <= high_mm[axis])
            }
        }
    }
}

/// Conversion from grid units to millimetres.
pub(super) struct Frame {
    pub(super) unit_mm: f64,
    origin_mm: [f64; 3],
    cell: Option<[f64; 3]>,
}

impl Frame {
    pub(super) fn new(t: &Triangulation) -> Self {
        Self { unit_mm: t.unit_mm(), origin_mm: t.origin_mm(), cell: t.cell() }
    }

    /// A point in mm, inside the cell.
    pub(super) fn inside_mm(&self, p: [f64; 3]) -> [f64; 3] {
        std::array::from_fn(|axis| {
            let inside = match self.cell {
                Some(cell) => p[axis] - libm::floor(p[axis] / cell[axis]) * cell[axis],
                None => p[axis],
            };
            inside * self.unit_mm + self.origin_mm[axis]
        })
    }

    /// Distance of the nearest images of two points.
    pub(super) fn distance_mm(&self, a: &[f64; 3], b: &[f64; 3]) -> f64 {
        let square: f64 = (0..3)
            .map(|axis| {
                let mut d = (a[axis] - b[axis]).abs();
                if let Some(cell) = self.cell {
                    d = d.min((cell[axis] * self.unit_mm - d).abs());
                }
                d * d
            })
            .sum();
        square.sqrt()
    }

    /// Region for statistics: the whole cell, or a free packing without the outer share at either end.
    pub(super) fn region(&self, t: &Triangulation) -> Region {
        if self.cell.is_some() {
            return Region::Everything;
        }
        let bound = |axis: usize, share: f64| {
            let values = || t.spheres().iter().map(|s| s[axis]);
            let (low, high) =
                (values().fold(f64::INFINITY, f64::min), values().fold(f64::NEG_INFINITY, f64::max));
            (low + share * (high - low)) * self.unit_mm + self.origin_mm[axis]
        };
        Region::Box {
            low_mm: std::array::from_fn(|axis| bound(axis, OUTER_SHARE)),
            high_mm: std::array::from_fn(|axis| bound(axis, 1.0 - OUTER_SHARE)),
        }
    }
}

/// Depth within the hull of all centres, as a share of the grain's radius, at which a grain counts as
/// surrounded.
const WITHIN: f64 = 0.5;

/// Tells if a grain has others all around it; in a periodic cell every grain has.
pub(super) fn is_surrounded(t: &Triangulation, positions: &Positions<'_>) -> bool {
    let planes: Vec<([f64; 3], [f64; 3])> = (0..t.tetrahedra())
        .flat_map(|i| (0..4).map(move |k| (i, k)))
        .filter(|&(i, k)| t.across(i, k).is_none())
        .map(|(i, k)| {
            let corners = t.at(positions, i, Shift::ZERO);
            let [a, b, c, inner] = [1, 2, 3, 0]
                .map(|at| -> [f64; 3] { std::array::from_fn(|axis| corners[(k + at) % 4][axis]) });
            let normal = cross(&minus(&b, &a), &minus(&c, &a));
            let length = dot(&normal, &normal).sqrt().copysign(dot(&normal, &minus(&inner, &a)));
            (a, normal.map(|n| n / length))
        })
        .collect();
    t.spheres().iter().any(|s| {
        let centre = [s[0], s[1], s[2]];
        planes.iter().all(|(a, normal)| dot(normal, &minus(&centre, a)) > WITHIN * s[3])
    })
}

fn minus(a: &[f64; 3], b: &[f64; 3]) -> [f64; 3] {
    std::array::from_fn(|axis| a[axis] - b[axis])
}

fn dot(a: &[f64; 3], b: &[f64; 3]) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

/// Void ratio of the tetrahedra whose centroid lies in a region, from their volume and the sectors that their
/// grains fill.
pub(super) fn void_ratio_within(
    t: &Triangulation,
    positions: &Positions<'_>,
    frame: &Frame,
    region: &Region,
) -> f64 {
    let (mut whole, mut solid) = (0.0, 0.0);
    for i in 0..t.tetrahedra() {
        let c = t.at(positions, i, Shift::ZERO);
        let centroid = std::array::from_fn(|axis| 0.25 * (c[0][axis] + c[1][axis] + c[2][axis] + c[3][axis]));
        if !region.holds(&frame.inside_mm(centroid)) {
            continue;
        }
        for a in 0..4 {
            let edges = [1, 2, 3]
                .map(|k| -> [f64; 3] { std::array::from_fn(|axis| c[(a + k) % 4][axis] - c[a][axis]) });
            let normal = cross(&edges[1], &edges[2]);
            let six = (edges[0][0] * normal[0] + edges[0][1] * normal[1] + edges[0][2] * normal[2]).abs();
            solid += solid_angle(&edges, six) / 3.0 * c[a][3] * c[a][3] * c[a][3];
            if a == 0 {
                whole += six / 6.0;
            }
        }
    }
    (whole - solid) / solid
}
