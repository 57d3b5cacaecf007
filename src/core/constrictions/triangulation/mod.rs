//! The periodic regular (power, weighted Delaunay) triangulation of a packing.

//!
//! Its layers: [`points`] (grain centres on an integer grid, so that images are exact), [`predicates`] (exact
//! answers, ties broken), [`mesh`] (tetrahedra and their adjacency), [`insertion`] (grain after grain, in the
//! order of [`order`]), [`images`] (the first triangulation of the torus), [`sanity`] (checks of the result).

mod error;
mod images;
mod insertion;
mod mesh;
mod order;
mod points;
mod predicates;
mod sanity;
#[cfg(test)]
mod tests;
mod wide;

pub use error::TriangulationError;
pub use sanity::SanityError;

use crate::packing::Packing;
use insertion::Builder;
use mesh::{Mesh, NONE, grain, image};
pub(super) use mesh::{Positions, Shift};
pub(super) use points::GrainPoint;
use points::Points;

/// Sizes of the first sample of grains on the torus; if cavities wrap around the cell, the next size is
/// tried.
const SAMPLES: [usize; 3] = [128, 1_024, 8_192];

/// Tetrahedra of grain centres weighted by the square of their radii.
///
/// On a periodic packing every tetrahedron represents all its translates: the triangulation covers the torus,
/// and its corners name a grain and the shift of that grain's image in cells. On a free packing it fills the
/// convex hull of the centres.
///
/// ```
/// use voidwalk_core::constrictions::Triangulation;
/// use voidwalk_core::packing::{Cell, Packing};
/// // Simple cubic: 3 x 3 x 3 touching grains of 1 mm.
/// let along = |stride: usize| (0..27).map(|i| (i / stride % 3) as f64).collect();
/// let packing = Packing {
///     cell: Cell::Periodic([3.0; 3]),
///     x: along(1), y: along(3), z: along(9),
///     diameter: vec![1.0; 27],
/// };
/// let triangulation = Triangulation::new(&packing)?;
/// assert!(triangulation.hidden().is_empty());
/// assert!(triangulation.sanity_check().is_ok());
/// # Ok::<(), voidwalk_core::constrictions::TriangulationError>(())
/// ```
#[derive(Clone)]
pub struct Triangulation {
    points: Points,
    mesh: Mesh,
    hidden: Vec<u32>,
    duplicates: Vec<[u32; 2]>,
}

impl std::fmt::Debug for Triangulation {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Triangulation")
            .field("grains", &self.grains())
            .field("tetrahedra", &self.tetrahedra())
            .field("hidden", &self.hidden)
            .field("duplicates", &self.duplicates)
            .finish_non_exhaustive()
    }
}

impl Triangulation {
    /// Triangulates a packing.
    ///
    /// # Errors
    /// Fewer than four grains; an invalid centre or diameter; a periodic cell narrower than two of the
    /// largest grain, or so empty that tetrahedra reach across it; free grains in one plane.
    pub fn new(packing: &Packing) -> Result<Self, TriangulationError> {
        Self::with_samples(packing, &SAMPLES)
    }

    /// Triangulates like [`Triangulation::new`], with the sizes of the first samples to try.
    pub(super) fn with_samples(packing: &Packing, samples: &[usize]) -> Result<Self, TriangulationError> {
        let points = Points::new(packing)?;
        let mesh = match points.cell {
            None => free(&points),
            Some(cell) => periodic(&points, cell, samples),
        }?;
        let mut seen = vec![false; points.at.len()];
        for &corner in mesh.corners.iter().flatten() {
            seen[grain(corner) as usize] = true;
        }
        let hidden: Vec<u32> = (0..).zip(&seen).filter(|(_, seen)| !**seen).map(|(i, _)| i).collect();
        let duplicates = duplicates(&points.at, &hidden);
        Ok(Self { points, mesh, hidden, duplicates })
    }

    /// Number of tetrahedra.
    pub fn tetrahedra(&self) -> usize {
        self.mesh.corners.len()
    }

    /// Number of grains, hidden ones included.
    pub fn grains(&self) -> usize {
        self.points.at.len()
    }

    /// Tells if the triangulation has a periodic cell.
    pub fn is_periodic(&self) -> bool {
        self.points.cell.is_some()
    }

    /// Grains at the four corners of a tetrahedron, positively oriented.
    pub fn corners(&self, tetrahedron: usize) -> [u32; 4] {
        self.mesh.corners[tetrahedron].map(grain)
    }

    /// Shift of the image of each corner, in cells along x, y, z.
    pub fn images(&self, tetrahedron: usize) -> [[i32; 3]; 4] {
        self.mesh.corners[tetrahedron].map(|corner| image(corner).cells())
    }

    /// Tetrahedron across the facet opposite a corner; `None` on the hull of a free packing.
    pub fn neighbour(&self, tetrahedron: usize, corner: usize) -> Option<usize> {
        let across = self.mesh.neighbours[tetrahedron][corner];
        (across != NONE).then_some((across / 4) as usize)
    }

    /// Grains that are no corner, ascending: each lies inside others (by power distance).
    pub fn hidden(&self) -> &[u32] {
        &self.hidden
    }

    /// Pairs of a hidden grain and another with the same centre.
    pub fn duplicates(&self) -> &[[u32; 2]] {
        &self.duplicates
    }

    /// Length of a grid unit (mm), a power of two.
    pub(super) fn unit_mm(&self) -> f64 {
        self.points.unit_mm
    }

    /// Origin of the grid (mm).
    pub(super) fn origin_mm(&self) -> [f64; 3] {
        self.points.origin_mm
    }

    /// Cell lengths in grid units; `None` for free boundaries.
    pub(super) fn cell(&self) -> Option<[f64; 3]> {
        self.points.cell
    }

    /// Centre and radius by grain, in grid units.
    pub(super) fn spheres(&self) -> &[GrainPoint] {
        &self.points.at
    }

    /// Tetrahedron across a facet, its corner opposite that facet, and the shift of its stored translate as
    /// seen from this one's.
    #[inline]
    pub(super) fn across(&self, tetrahedron: usize, corner: usize) -> Option<(usize, usize, Shift)> {
        let across = self.mesh.neighbours[tetrahedron][corner];
        let shift = self.mesh.shifts[tetrahedron][corner];
        (across != NONE).then_some(((across / 4) as usize, (across % 4) as usize, shift))
    }

    /// Positions of the corners, in grid units.
    pub(super) fn positions(&self) -> Positions<'_> {
        Positions::new(&self.points)
    }

    /// One corner of a stored tetrahedron in the translate `shift`, in grid units.
    #[inline]
    pub(super) fn corner_at(
        &self,
        positions: &Positions<'_>,
        tetrahedron: usize,
        i: usize,
        shift: Shift,
    ) -> GrainPoint {
        positions.corner(self.mesh.corners[tetrahedron][i], shift)
    }

    /// Corners of a stored tetrahedron in the translate `shift`, in grid units.
    pub(super) fn at(&self, positions: &Positions<'_>, tetrahedron: usize, shift: Shift) -> [GrainPoint; 4] {
        positions.corners::<true>(&self.mesh.corners[tetrahedron], shift)
    }
}

fn free(points: &Points) -> Result<Mesh, TriangulationError> {
    let flat = TriangulationError::Coplanar { grains: points.at.len() };
    if points.is_flat() {
        return Err(flat);
    }
    let identity: Vec<u32> = (0..points.at.len() as u32).collect();
    let mut order = images::free_order(&points.at);
    let mut builder = Builder::first(Positions::new(points), &identity, &mut order).ok_or(flat)?;
    for &p in &order[4..] {
        // A cavity in space meets no image of itself.
        let _ = builder.insert::<false>(p);
    }
    let mut mesh = builder.mesh;
    mesh.compact();
    Ok(mesh)
}

fn periodic(points: &Points, cell: [f64; 3], samples: &[usize]) -> Result<Mesh, TriangulationError> {
    let grains = points.at.len();
    let identity: Vec<u32> = (0..grains as u32).collect();
    let extent = cell.iter().fold(1.0, |a: f64, &b| a.max(b));
    let sorted = order::sorted(&points.at, [0.0; 3], extent);
    for &size in samples {
        let stride = grains / size;
        if stride < 2 {
            break;
        }
        let order = order::levels(&sorted, stride);
        let (sample, rest) = order.split_at(grains.div_ceil(stride));
        let Some(mesh) = images::triangulate(points, cell, sample) else { continue };
        let mut builder = Builder::new(mesh, Positions::new(points), &identity);
        if rest.iter().all(|&p| builder.insert::<true>(p).is_ok()) {
            let mut mesh = builder.mesh;
            mesh.compact();
            return Ok(mesh);
        }
    }
    images::triangulate(points, cell, &sorted).ok_or(TriangulationError::Sparse { grains })
}

/// Pairs of a hidden grain and another with the same centre.
fn duplicates(at: &[GrainPoint], hidden: &[u32]) -> Vec<[u32; 2]> {
    if hidden.is_empty() {
        return Vec::new();
    }
    let place = |i: u32| -> [i64; 3] { std::array::from_fn(|axis| at[i as usize][axis] as i64) };
    let mut sorted: Vec<u32> = (0..at.len() as u32).collect();
    sorted.sort_unstable_by_key(|&i| (place(i), hidden.binary_search(&i).is_ok(), i));
    let mut pairs: Vec<[u32; 2]> = sorted
        .chunk_by(|&i, &j| place(i) == place(j))
        .flat_map(|same| same[1..].iter().map(|&other| [other, same[0]]))
        .collect();
    pairs.sort_unstable();
    pairs
}
