//! Direct checks of the identities of every triangulation.

use super::Triangulation;
use super::images;
use super::mesh::{Mesh, NONE, Shift, grain, image};
use super::predicates::{in_conflict, volume};
use super::wide::Wide;
use std::collections::HashSet;
use thiserror::Error;

/// An identity of triangulations that does not hold.
#[derive(Clone, Debug, Error, PartialEq)]
pub enum SanityError {
    /// Two tetrahedra disagree about the facet they share, or a facet has no partner.
    #[error("facet {facet} of tetrahedron {tetrahedron} is not shared by exactly two")]
    Facet {
        /// Index of the tetrahedron.
        tetrahedron: usize,
        /// Corner opposite the facet.
        facet: usize,
    },
    /// A tetrahedron without volume, or turned inside out.
    #[error("tetrahedron {tetrahedron} is not positively oriented")]
    Orientation {
        /// Index of the tetrahedron.
        tetrahedron: usize,
    },
    /// Volumes that do not add up to the cell.
    #[error("volumes differ from the cell by {relative_error:e} of it")]
    Volume {
        /// Difference over the volume of the cell.
        relative_error: f64,
    },
    /// A corner across a facet that should have removed the tetrahedron.
    #[error("across facet {facet} of tetrahedron {tetrahedron} lies a grain inside its power sphere")]
    Irregular {
        /// Index of the tetrahedron.
        tetrahedron: usize,
        /// Corner opposite the facet.
        facet: usize,
    },
    /// A violation of Euler's relation.
    #[error(
        "{vertices} vertices - {edges} edges + {facets} facets - {tetrahedra} tetrahedra is not {expected}"
    )]
    Euler {
        /// Grains that are corners.
        vertices: usize,
        /// Edges.
        edges: usize,
        /// Facets.
        facets: usize,
        /// Tetrahedra.
        tetrahedra: usize,
        /// 0 on the torus, 1 in space.
        expected: i64,
    },
}

impl Triangulation {
    /// Checks every identity: facets shared by exactly two, all tetrahedra positive, volumes adding up
    /// to the cell (exactly, on the grid), local regularity at every facet, and V - E + F - T = 0 (1
    /// for a free packing). Together they prove that this is the regular triangulation.
    ///
    /// # Errors
    /// The first identity that does not hold.
    pub fn sanity_check(&self) -> Result<(), SanityError> {
        let mesh = &self.mesh;
        let mut hull = 0;
        for tetrahedron in 0..self.tetrahedra() {
            for facet in 0..4 {
                let broken = Err(SanityError::Facet { tetrahedron, facet });
                if mesh.neighbours[tetrahedron][facet] == NONE {
                    hull += 1;
                    if self.is_periodic() {
                        return broken;
                    }
                } else if !same_facet(mesh, tetrahedron, facet) {
                    return broken;
                }
            }
        }
        self.volumes()?;
        self.regularity()?;
        let vertices = self.grains() - self.hidden().len();
        let facets = (4 * self.tetrahedra() - hull) / 2 + hull;
        let (edges, tetrahedra) = (edges(mesh), self.tetrahedra());
        let expected = i64::from(!self.is_periodic());
        if vertices as i64 - edges as i64 + facets as i64 - tetrahedra as i64 != expected {
            return Err(SanityError::Euler { vertices, edges, facets, tetrahedra, expected });
        }
        Ok(())
    }

    fn volumes(&self) -> Result<(), SanityError> {
        let positions = self.positions();
        let mut sum = Wide::ZERO;
        for tetrahedron in 0..self.tetrahedra() {
            let six = volume(&self.at(&positions, tetrahedron, Shift::ZERO));
            if six.sign() <= 0 {
                return Err(SanityError::Orientation { tetrahedron });
            }
            sum = sum + six;
        }
        if let Some(cell) = self.points.cell
            && !images::fills(&self.mesh, &self.points, cell)
        {
            let whole = 6.0 * cell[0] * cell[1] * cell[2];
            return Err(SanityError::Volume { relative_error: sum.to_f64() / whole - 1.0 });
        }
        Ok(())
    }

    fn regularity(&self) -> Result<(), SanityError> {
        let positions = self.positions();
        for tetrahedron in 0..self.tetrahedra() {
            let corners = self.at(&positions, tetrahedron, Shift::ZERO);
            let grains = self.corners(tetrahedron);
            for facet in 0..4 {
                let across = self.mesh.neighbours[tetrahedron][facet];
                if across == NONE {
                    continue;
                }
                let (u, j) = ((across / 4) as usize, (across % 4) as usize);
                let p = self.at(&positions, u, self.mesh.shifts[tetrahedron][facet])[j];
                let id = |i: usize| if i == 4 { self.corners(u)[j] } else { grains[i] };
                if in_conflict(&corners, &p, |a, b| id(a).cmp(&id(b))) {
                    return Err(SanityError::Irregular { tetrahedron, facet });
                }
            }
        }
        Ok(())
    }
}

/// Tells if a facet and its linked facet have the same three corners, seen from both sides.
fn same_facet(mesh: &Mesh, t: usize, i: usize) -> bool {
    let across = mesh.neighbours[t][i];
    let (u, j) = ((across / 4) as usize, (across % 4) as usize);
    let shift = mesh.shifts[t][i];
    if mesh.neighbours[u][j] != (4 * t + i) as u32 || mesh.shifts[u][j] != Shift::ZERO.minus(shift) {
        return false;
    }
    let facet = |t: usize, opposite: usize, by: Shift| {
        let mut corners: Vec<(u32, Shift)> = (0..4)
            .filter(|&k| k != opposite)
            .map(|k| (grain(mesh.corners[t][k]), image(mesh.corners[t][k]).plus(by)))
            .collect();
        corners.sort_unstable();
        corners
    };
    facet(t, i, Shift::ZERO) == facet(u, j, shift)
}

/// Number of edges, each class of translates once.
fn edges(mesh: &Mesh) -> usize {
    let mut seen = HashSet::new();
    for corners in &mesh.corners {
        for a in 0..4 {
            for b in 0..a {
                let ends = [corners[a], corners[b]].map(|c| (grain(c), image(c)));
                let [(g, first), (h, second)] = ends;
                let forward = (g, h, second.minus(first));
                let backward = (h, g, first.minus(second));
                seen.insert(forward.min(backward));
            }
        }
    }
    seen.len()
}
