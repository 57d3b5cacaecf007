//! The periodic regular (power, weighted Delaunay) triangulation of a packing.
//!
//! Its layers: [`mesh`] (grain centres on an integer grid, so that images are exact; tetrahedra and their
//! adjacency), [`predicates`] (exact answers, ties broken), [`insertion`] (one grain after another, coarse
//! to fine), the first triangulation of the torus (here), [`sanity`] (checks of the result).
//!
//! # The torus
//! A few grains are first triangulated in space, with their images within a margin around the cell; one
//! tetrahedron of each class of translates is kept. If every facet then meets exactly one other and the
//! volumes add up to the cell (both exact), this is a triangulation of the torus. Tetrahedra that meet
//! on the torus met in the free triangulation, so it is locally regular everywhere, hence the regular
//! one. If not, the margin was too narrow. The other grains are inserted on the torus.

mod insertion;
mod mesh;
mod predicates;
mod sanity;

pub use mesh::TriangulationError;

pub(super) use mesh::{GrainPoint, Shift, cross, dot, edges, facet, offset, six_volume};

use crate::packing::Packing;
use insertion::{Builder, free_order, levels, sorted, stored};
use mesh::{MOST_GRAINS, Mesh, NONE, Points, grain, image};
use predicates::{Wide, volume};
use std::collections::HashMap;

/// Sizes of the first sample of grains on the torus; if cavities wrap around the cell, the next size is
/// tried.
const SAMPLES: [usize; 3] = [128, 1_024, 8_192];

/// Tetrahedra of grain centres, weighted by the squared radii.
///
/// For a periodic packing every tetrahedron represents all its translates: the triangulation covers the
/// torus, and its corners name a grain and the shift of that grain's image in cells. For a free packing
/// it fills the convex hull of the centres.
#[derive(Clone, Debug)]
pub struct Triangulation {
    points: Points,
    mesh: Mesh,
    hidden: Vec<u32>,
    duplicates: Vec<[u32; 2]>,
}

impl Triangulation {
    /// Triangulates a packing.
    ///
    /// # Errors
    /// Fewer than four grains; an invalid centre or diameter; a periodic cell narrower than two of the
    /// largest grain, or so empty that tetrahedra extend across it; free grains in one plane.
    pub fn new(packing: &Packing) -> Result<Self, TriangulationError> {
        Self::with_samples(packing, &SAMPLES)
    }

    /// Triangulates like [`Triangulation::new`], with the sizes of the first samples to be tried.
    fn with_samples(packing: &Packing, samples: &[usize]) -> Result<Self, TriangulationError> {
        let points = Points::new(packing)?;
        let grains = points.at.len();
        let identity: Vec<u32> = (0..grains as u32).collect();
        let mesh = match points.cell {
            None => Some(&points)
                .filter(|points| !points.is_flat())
                .and_then(|points| free(points, &identity))
                .ok_or(TriangulationError::Coplanar(grains))?,
            Some(cell) => {
                periodic(&points, cell, samples, &identity).ok_or(TriangulationError::Sparse(grains))?
            }
        };
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

    /// Number of grains, including hidden ones.
    pub(crate) fn grains(&self) -> usize {
        self.points.at.len()
    }

    /// Grains at the four corners of a tetrahedron, positively oriented.
    pub fn corners(&self, tetrahedron: usize) -> [u32; 4] {
        self.mesh.corners[tetrahedron].map(grain)
    }

    /// Shift of the image of each corner, in cells along x, y, z.
    pub fn images(&self, tetrahedron: usize) -> [[i32; 3]; 4] {
        self.mesh.corners[tetrahedron].map(|corner| image(corner).cells())
    }

    /// Grains that are not a corner, ascending: each lies inside others (by power distance).
    pub(crate) fn hidden(&self) -> &[u32] {
        &self.hidden
    }

    /// Centre and radius of the grains that are not hidden, in grid units.
    pub(super) fn visible(&self) -> impl Iterator<Item = &GrainPoint> {
        let all = self.points.at.iter().zip(0u32..);
        all.filter(|(_, grain)| self.hidden.binary_search(grain).is_err()).map(|(sphere, _)| sphere)
    }

    /// Radius of the smallest grain, in grid units.
    pub(super) fn least_radius(&self) -> f64 {
        self.points.at.iter().map(|s| s[3]).fold(f64::INFINITY, f64::min)
    }

    /// Pairs of a hidden grain and another with the same centre.
    pub(crate) fn duplicates(&self) -> &[[u32; 2]] {
        &self.duplicates
    }

    pub(super) fn unit_mm(&self) -> f64 {
        self.points.unit_mm
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

    pub(super) fn displacement(&self, shift: Shift) -> [f64; 3] {
        self.points.displacement(shift)
    }

    pub(super) fn in_mm(&self, p: [f64; 3]) -> [f64; 3] {
        std::array::from_fn(|axis| p[axis] * self.points.unit_mm + self.points.origin_mm[axis])
    }

    pub(super) fn inside_mm(&self, p: [f64; 3]) -> [f64; 3] {
        self.in_mm(match self.points.cell {
            Some(cell) => {
                std::array::from_fn(|axis| p[axis] - libm::floor(p[axis] / cell[axis]) * cell[axis])
            }
            None => p,
        })
    }

    /// Distance of the nearest images of two points, in mm.
    pub(super) fn distance_mm(&self, a: &[f64; 3], b: &[f64; 3]) -> f64 {
        let d: [f64; 3] = std::array::from_fn(|axis| {
            let d = (a[axis] - b[axis]).abs();
            let cell = self.points.cell;
            cell.map_or(d, |cell| d.min((cell[axis] * self.points.unit_mm - d).abs()))
        });
        dot(&d, &d).sqrt()
    }

    /// One corner of a stored tetrahedron in the translate `shift`, in grid units.
    #[inline]
    pub(super) fn corner_at(&self, tetrahedron: usize, i: usize, shift: Shift) -> GrainPoint {
        self.points.corner(self.mesh.corners[tetrahedron][i], shift)
    }

    /// Corners of a stored tetrahedron in the translate `shift`, in grid units.
    pub(super) fn at(&self, tetrahedron: usize, shift: Shift) -> [GrainPoint; 4] {
        self.points.corners::<true>(&self.mesh.corners[tetrahedron], shift)
    }

    pub(super) fn stored(&self, tetrahedron: usize) -> [GrainPoint; 4] {
        self.at(tetrahedron, Shift::ZERO)
    }
}

/// Triangulates in space; `identity` gives the grain of each point. `None` if all lie in one plane.
fn free(points: &Points, identity: &[u32]) -> Option<Mesh> {
    let mut order = free_order(&points.at);
    let mut builder = Builder::first(points, identity, &mut order)?;
    for &p in &order[4..] {
        // In space no cavity meets an image of itself.
        let _ = builder.insert::<false>(p);
    }
    Some(builder.mesh.compact())
}

fn periodic(points: &Points, cell: [f64; 3], samples: &[usize], identity: &[u32]) -> Option<Mesh> {
    let grains = points.at.len();
    let extent = cell.iter().fold(1.0, |a: f64, &b| a.max(b));
    let sorted = sorted(&points.at, [0.0; 3], extent);
    for &size in samples {
        let stride = grains / size;
        if stride < 2 {
            break;
        }
        let order = levels(&sorted, stride);
        let (sample, rest) = order.split_at(grains.div_ceil(stride));
        let Some(mesh) = of_images(points, cell, sample) else { continue };
        let mut builder = Builder::new(mesh, points, identity);
        if rest.iter().all(|&p| builder.insert::<true>(p).is_ok()) {
            return Some(builder.mesh.compact());
        }
    }
    of_images(points, cell, &sorted)
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

/// Margins to try, in cells.
const MARGINS: [f64; 4] = [0.5, 1.0, 2.0, 3.0];

/// Maximum number of images for which a wider margin is tried.
const MOST_IMAGES: usize = 20_000_000;

/// A class of translates: its corners relative to the smallest of them, ascending.
type Class = [(u32, Shift); 4];

/// Finds the periodic mesh of the grains in `sample`; `None` if they are too few to fill the cell.
fn of_images(points: &Points, cell: [f64; 3], sample: &[u32]) -> Option<Mesh> {
    MARGINS.into_iter().find_map(|margin| {
        let reach = libm::ceil(margin) as i32;
        let (mut at, mut images) = (Vec::new(), Images::default());
        for &grain in sample {
            for z in -reach..=reach {
                for y in -reach..=reach {
                    for x in -reach..=reach {
                        let (mut p, shift) = (points.at[grain as usize], [x, y, z]);
                        (0..3).for_each(|axis| p[axis] += f64::from(shift[axis]) * cell[axis]);
                        let within = |axis: usize| {
                            p[axis] >= -margin * cell[axis] && p[axis] <= (1.0 + margin) * cell[axis]
                        };
                        if (0..3).all(within) {
                            at.push(p);
                            images.grain.push(grain);
                            images.shift.push(Shift::new(shift));
                        }
                    }
                }
            }
            if at.len() > MOST_IMAGES.min(MOST_GRAINS) {
                return None;
            }
        }
        images.fold(&free(&Points::of(at, None), &images.grain)?, points, cell)
    })
}

#[derive(Default)]
struct Images {
    grain: Vec<u32>,
    shift: Vec<Shift>,
}

impl Images {
    fn corners(&self, mesh: &Mesh, t: u32) -> [(u32, Shift); 4] {
        mesh.corners[t as usize].map(|c| (self.grain[grain(c) as usize], self.shift[grain(c) as usize]))
    }

    /// Keeps one tetrahedron of each class, linked on the torus.
    fn fold(&self, mesh: &Mesh, points: &Points, cell: [f64; 3]) -> Option<Mesh> {
        let mut folded = Mesh::default();
        // Origin of each kept tetrahedron, and the shift from its stored translate.
        let (mut origin, mut least) = (Vec::new(), Vec::new());
        let mut kept: HashMap<Class, u32> = HashMap::new();
        for t in 0..mesh.corners.len() as u32 {
            let corners = self.corners(mesh, t);
            let (class, anchor) = class(&corners);
            if anchor == Shift::ZERO {
                let (stored, shift) = stored(&corners.map(|c| c.0), &corners.map(|c| c.1))?;
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
        let is_paired = (0..origin.len()).all(|t| (0..4).all(|i| folded.is_paired(t, i)));
        (is_paired && six_volumes(&folded, points) == Ok(six_cells(cell))).then_some(folded)
    }
}

/// Returns the class of a tetrahedron, and the shift of its reference corner.
fn class(corners: &[(u32, Shift); 4]) -> (Class, Shift) {
    let mut class = *corners;
    class.sort_unstable_by_key(|&(grain, shift)| (grain, shift.cells()));
    let anchor = class[0].1;
    (class.map(|(grain, shift)| (grain, shift.minus(anchor))), anchor)
}

/// Six times the sum of all volumes, exactly, or the first tetrahedron without positive volume.
fn six_volumes(mesh: &Mesh, points: &Points) -> Result<Wide, usize> {
    let mut sum = Wide::ZERO;
    for (t, corners) in mesh.corners.iter().enumerate() {
        let six = volume(&points.corners::<true>(corners, Shift::ZERO));
        if six.sign() <= 0 {
            return Err(t);
        }
        sum = sum + six;
    }
    Ok(sum)
}

fn six_cells(cell: [f64; 3]) -> Wide {
    let [x, y, z] = cell.map(|length| Wide::from(length as i128));
    Wide::from(6) * x * y * z
}
