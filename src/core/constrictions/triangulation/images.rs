//! The periodic triangulation of a few grains, from a free one of their images.
//!
//! The images within a margin around the cell are triangulated in space; one tetrahedron of each
//! class of translates is kept. If then every facet meets exactly one other and the volumes add up to
//! the cell (both exact), this is a triangulation of the torus; and since tetrahedra that meet on it
//! met in the free one, it is locally regular everywhere, hence the regular one. If not, the margin
//! was too narrow.

use super::insertion::{Builder, normalised};
use super::mesh::{Mesh, NONE, Positions, Shift, grain};
use super::order;
use super::points::{GrainPoint, MOST_GRAINS, Points};
use super::predicates::volume;
use super::wide::Wide;
use std::collections::HashMap;

/// Margins to try, in cells.
const MARGINS: [f64; 4] = [0.5, 1.0, 2.0, 3.0];

/// Beyond this many images a wider margin is not tried.
const MOST_IMAGES: usize = 20_000_000;

/// A class of translates: its corners relative to the least of them, ascending.
type Class = [(u32, Shift); 4];

/// Finds the periodic mesh of the grains in `sample`; `None` if they are too few to fill the cell.
pub(super) fn triangulate(points: &Points, cell: [f64; 3], sample: &[u32]) -> Option<Mesh> {
    MARGINS.into_iter().find_map(|margin| {
        let reach = libm::ceil(margin) as i32;
        let mut images = Images::default();
        for &grain in sample {
            let at = points.at[grain as usize];
            for z in -reach..=reach {
                for y in -reach..=reach {
                    for x in -reach..=reach {
                        images.add(grain, at, [x, y, z], cell, margin);
                    }
                }
            }
            if images.at.len() > MOST_IMAGES.min(MOST_GRAINS) {
                return None;
            }
        }
        images.triangulate(points.unit_mm).and_then(|mesh| images.fold(&mesh, points, cell))
    })
}

/// Images of grains as columns.
#[derive(Default)]
struct Images {
    at: Vec<GrainPoint>,
    grain: Vec<u32>,
    shift: Vec<Shift>,
}

impl Images {
    fn add(&mut self, grain: u32, mut at: GrainPoint, shift: [i32; 3], cell: [f64; 3], margin: f64) {
        for axis in 0..3 {
            at[axis] += f64::from(shift[axis]) * cell[axis];
            if at[axis] < -margin * cell[axis] || at[axis] > (1.0 + margin) * cell[axis] {
                return;
            }
        }
        self.at.push(at);
        self.grain.push(grain);
        self.shift.push(Shift::new(shift));
    }

    /// Free triangulation of all images, compacted.
    fn triangulate(&self, unit_mm: f64) -> Option<Mesh> {
        let points = Points { at: self.at.clone(), cell: None, unit_mm, origin_mm: [0.0; 3] };
        let mut order = free_order(&points.at);
        let mut builder = Builder::first(Positions::new(&points), &self.grain, &mut order)?;
        for &p in &order[4..] {
            builder.insert::<false>(p).ok()?;
        }
        let mut mesh = builder.mesh;
        mesh.compact();
        Some(mesh)
    }

    /// Grain and shift of the corners of a tetrahedron.
    fn corners(&self, mesh: &Mesh, t: u32) -> [(u32, Shift); 4] {
        mesh.corners[t as usize].map(|c| (self.grain[grain(c) as usize], self.shift[grain(c) as usize]))
    }

    /// One tetrahedron of each class, linked on the torus.
    fn fold(&self, mesh: &Mesh, points: &Points, cell: [f64; 3]) -> Option<Mesh> {
        let mut folded = Mesh::default();
        // Origin of each kept tetrahedron, and the shift from its stored translate.
        let (mut origin, mut least) = (Vec::new(), Vec::new());
        let mut kept: HashMap<Class, u32> = HashMap::new();
        for t in 0..mesh.corners.len() as u32 {
            let corners = self.corners(mesh, t);
            let (class, anchor) = class(&corners);
            if anchor == Shift::ZERO {
                let (stored, shift) = normalised(&corners.map(|c| c.0), &corners.map(|c| c.1))?;
                kept.insert(class, folded.push(stored));
                origin.push(t);
                least.push(shift);
            }
        }
        for t in 0..origin.len() {
            for i in 0..4 {
                let across = mesh.neighbours[origin[t] as usize][i];
                if across == NONE {
                    return None;
                }
                let corners = self.corners(mesh, across / 4);
                let (class, anchor) = class(&corners);
                let &u = kept.get(&class)?;
                let (opposite, shift) = corners[(across % 4) as usize];
                let wanted = (opposite, shift.minus(anchor));
                let j = self.corners(mesh, origin[u as usize]).iter().position(|&c| c == wanted)?;
                folded.neighbours[t][i] = 4 * u + j as u32;
                folded.shifts[t][i] = least[u as usize].plus(anchor).minus(least[t]);
            }
        }
        (paired(&folded) && fills(&folded, points, cell)).then_some(folded)
    }
}

/// Class of a tetrahedron, and the shift of its reference corner.
fn class(corners: &[(u32, Shift); 4]) -> (Class, Shift) {
    let mut class = *corners;
    class.sort_unstable_by_key(|&(grain, shift)| (grain, shift.cells()));
    let anchor = class[0].1;
    (class.map(|(grain, shift)| (grain, shift.minus(anchor))), anchor)
}

/// Tells if every facet meets exactly one other, which meets it.
pub(super) fn paired(mesh: &Mesh) -> bool {
    (0..mesh.corners.len()).all(|t| {
        (0..4).all(|i| {
            let across = mesh.neighbours[t][i];
            let (u, j) = ((across / 4) as usize, (across % 4) as usize);
            across != NONE
                && mesh.neighbours[u][j] == (4 * t + i) as u32
                && mesh.shifts[u][j] == Shift::ZERO.minus(mesh.shifts[t][i])
        })
    })
}

/// Tells if all tetrahedra are positive and their volumes add up to the cell, exactly.
pub(super) fn fills(mesh: &Mesh, points: &Points, cell: [f64; 3]) -> bool {
    let positions = Positions::new(points);
    let mut sum = Wide::ZERO;
    for corners in &mesh.corners {
        let six = volume(&positions.corners::<true>(corners, Shift::ZERO));
        if six.sign() <= 0 {
            return false;
        }
        sum = sum + six;
    }
    let [x, y, z] = cell.map(|length| Wide::from(length as i128));
    sum == Wide::from(6) * x * y * z
}

/// Order of insertion for a free triangulation.
pub(super) fn free_order(at: &[GrainPoint]) -> Vec<u32> {
    let bound = |axis: usize, low: bool| {
        let values = at.iter().map(|p| p[axis]);
        if low { values.fold(f64::INFINITY, f64::min) } else { values.fold(f64::NEG_INFINITY, f64::max) }
    };
    let low: [f64; 3] = std::array::from_fn(|axis| bound(axis, true));
    let extent = (0..3).map(|axis| bound(axis, false) - low[axis]).fold(1.0, f64::max);
    order::levels(&order::sorted(at, low, extent), (at.len() / 64).max(1))
}
