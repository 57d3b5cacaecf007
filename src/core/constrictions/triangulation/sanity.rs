//! Direct checks of identities that hold for every triangulation.

use super::mesh::{Mesh, NONE, Shift, grain, image};
use super::predicates::in_conflict;
use super::{Triangulation, six_cells, six_volumes};
use std::collections::HashSet;

/// An identity of triangulations that is violated.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum SanityError {
    /// Two tetrahedra disagree about the facet they share, or a facet has no partner.
    #[error("facet {1} of tetrahedron {0} is not shared by exactly two")]
    Facet(usize, usize),
    /// A tetrahedron without volume, or inverted.
    #[error("tetrahedron {0} is not positively oriented")]
    Orientation(usize),
    /// Volumes that do not add up to the cell: the difference over its volume.
    #[error("volumes differ from the cell by {0:e} of it")]
    Volume(f64),
    /// A corner across a facet that should have removed the tetrahedron.
    #[error("across facet {1} of tetrahedron {0} lies a grain inside its power sphere")]
    Irregular(usize, usize),
    /// A violation of Euler's relation; expected are 0 on the torus and 1 in space.
    #[error(
        "{vertices} vertices - {edges} edges + {facets} facets - {tetrahedra} tetrahedra is not {expected}"
    )]
    Euler { vertices: usize, edges: usize, facets: usize, tetrahedra: usize, expected: i64 },
}

impl Triangulation {
    /// Checks every identity: facets shared by exactly two, all tetrahedra positive, volumes adding up
    /// to the cell (exactly, on the grid), local regularity at every facet, and V - E + F - T = 0 (1 for
    /// a free packing). Together they prove that this is the regular triangulation.
    ///
    /// # Errors
    /// The first identity that is violated.
    pub fn sanity_check(&self) -> Result<(), SanityError> {
        let mesh = &self.mesh;
        let mut hull = 0;
        for tetrahedron in 0..self.tetrahedra() {
            for facet in 0..4 {
                let is_hull = mesh.neighbours[tetrahedron][facet] == NONE;
                hull += usize::from(is_hull);
                let is_whole =
                    if is_hull { self.cell().is_none() } else { same_facet(mesh, tetrahedron, facet) };
                if !is_whole {
                    return Err(SanityError::Facet(tetrahedron, facet));
                }
            }
        }
        let sum = six_volumes(mesh, &self.points).map_err(SanityError::Orientation)?;
        if let Some(cell) = self.cell().filter(|&cell| sum != six_cells(cell)) {
            let whole = 6.0 * cell[0] * cell[1] * cell[2];
            return Err(SanityError::Volume(sum.to_f64() / whole - 1.0));
        }
        self.regularity()?;
        let vertices = self.grains() - self.hidden().len();
        let facets = (4 * self.tetrahedra() - hull) / 2 + hull;
        let (edges, tetrahedra) = (edges(mesh), self.tetrahedra());
        let expected = i64::from(self.cell().is_none());
        if vertices as i64 - edges as i64 + facets as i64 - tetrahedra as i64 != expected {
            return Err(SanityError::Euler { vertices, edges, facets, tetrahedra, expected });
        }
        Ok(())
    }

    fn regularity(&self) -> Result<(), SanityError> {
        for tetrahedron in 0..self.tetrahedra() {
            let (corners, grains) = (self.stored(tetrahedron), self.corners(tetrahedron));
            for facet in 0..4 {
                let Some((u, j, shift)) = self.across(tetrahedron, facet) else { continue };
                let id = |i: usize| if i == 4 { self.corners(u)[j] } else { grains[i] };
                if in_conflict(&corners, &self.corner_at(u, j, shift), |a, b| id(a).cmp(&id(b))) {
                    return Err(SanityError::Irregular(tetrahedron, facet));
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
    let facet = |t: usize, opposite: usize, by: Shift| {
        let mut corners: Vec<(u32, Shift)> = (0..4)
            .filter(|&k| k != opposite)
            .map(|k| (grain(mesh.corners[t][k]), image(mesh.corners[t][k]).plus(by)))
            .collect();
        corners.sort_unstable();
        corners
    };
    mesh.is_paired(t, i) && facet(t, i, Shift::ZERO) == facet(u, j, mesh.shifts[t][i])
}

/// Number of edges, counting each class of translates once.
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

/// Compares the triangulation with brute force in exact arithmetic, with itself, and with lattices.
#[cfg(test)]
mod tests {
    use super::*;
    use crate::constrictions::TriangulationError;
    use crate::packing::uniform;
    use crate::packing::{Cell, Packing};
    use num_bigint::{BigInt, Sign};
    use std::collections::BTreeSet;

    /// Makes random grains, with any overlap, with diameters between two sizes.
    fn random(grains: usize, cell: Cell, extent: [f64; 3], sizes: [f64; 2], chunk: u64) -> Packing {
        let mut u = uniform(20_261_121, chunk);
        let mut column =
            |low: f64, high: f64| -> Vec<f64> { (0..grains).map(|_| low + (high - low) * u()).collect() };
        let [x, y, z] = extent.map(|length| column(0.0, length));
        Packing { cell, x, y, z, diameter: column(sizes[0], sizes[1]) }
    }

    fn determinant(m: &[Vec<BigInt>]) -> BigInt {
        if m.is_empty() {
            return BigInt::from(1);
        }
        let mut sum = BigInt::ZERO;
        for (column, factor) in m[0].iter().enumerate() {
            let minor: Vec<Vec<BigInt>> = m[1..]
                .iter()
                .map(|row| {
                    row.iter().enumerate().filter(|(c, _)| *c != column).map(|(_, v)| v.clone()).collect()
                })
                .collect();
            let term = factor * determinant(&minor);
            if column % 2 == 0 { sum += term } else { sum -= term }
        }
        sum
    }

    fn ranks(points: &[[i64; 4]]) -> Vec<usize> {
        let mut order: Vec<usize> = (0..points.len()).collect();
        order.sort_by_key(|&i| (points[i][0], points[i][1], points[i][2], i));
        let mut rank = vec![0; points.len()];
        order.into_iter().enumerate().for_each(|(place, i)| rank[i] = place);
        rank
    }

    fn height(point: &[i64; 4]) -> BigInt {
        let [x, y, z, r] = point.map(BigInt::from);
        &x * &x + &y * &y + &z * &z - &r * &r
    }

    /// Finds all tetrahedra whose lifted plane has every other lifted point above it, according to `above`.
    fn brute_force(
        points: &[[i64; 4]],
        mut above: impl FnMut([usize; 4], usize) -> Option<bool>,
    ) -> BTreeSet<[u32; 4]> {
        let n = points.len();
        let mut regular = BTreeSet::new();
        for a in 0..n {
            for b in a + 1..n {
                for c in b + 1..n {
                    for d in c + 1..n {
                        let four = [a, b, c, d];
                        if (0..n).all(|e| four.contains(&e) || above(four, e) == Some(true)) {
                            regular.insert(four.map(|i| i as u32));
                        }
                    }
                }
            }
        }
        regular
    }

    /// Raises heights by actual powers of two in lexicographic order instead of symbols, and writes out
    /// the determinant of the five lifted points.
    fn literal(points: &[[i64; 4]]) -> BTreeSet<[u32; 4]> {
        const STEP: usize = 400;
        let (rank, n) = (ranks(points), points.len());
        let lifted: Vec<Vec<BigInt>> = (0..n)
            .map(|i| {
                let [x, y, z, _] = points[i].map(BigInt::from);
                let raised = (height(&points[i]) << (STEP * n)) + (BigInt::from(1) << (STEP * rank[i]));
                vec![x, y, z, BigInt::from(1), raised]
            })
            .collect();
        brute_force(points, |four, e| {
            let flat: Vec<Vec<BigInt>> = four.iter().map(|&i| lifted[i][..4].to_vec()).collect();
            let rows: Vec<Vec<BigInt>> = four.iter().chain([&e]).map(|&i| lifted[i].clone()).collect();
            let orientation = determinant(&flat).sign();
            (orientation != Sign::NoSign).then(|| determinant(&rows).sign() == orientation)
        })
    }

    /// Evaluates that determinant as a polynomial in the raises: the coefficient of height `i` is a volume.
    fn polynomial(points: &[[i64; 4]]) -> BTreeSet<[u32; 4]> {
        let rank = ranks(points);
        let heights: Vec<BigInt> = points.iter().map(height).collect();
        let volume = |i: [usize; 4]| -> i128 {
            let d = |k: usize, axis: usize| i128::from(points[i[k]][axis] - points[i[0]][axis]);
            let minor = |j: usize, k: usize| d(j, 1) * d(k, 2) - d(k, 1) * d(j, 2);
            d(1, 0) * minor(2, 3) - d(2, 0) * minor(1, 3) + d(3, 0) * minor(1, 2)
        };
        brute_force(points, |four, e| {
            let whole = volume(four).signum();
            // Barycentric weights of e, times the volume, and -1 for e itself: zero if the plane through the
            // four passes through e, negative if e lies above it.
            let mut terms: Vec<(usize, i128)> = (0..4)
                .map(|k| {
                    let mut replaced = four;
                    replaced[k] = e;
                    (four[k], whole * volume(replaced))
                })
                .collect();
            terms.push((e, -whole * volume(four)));
            let main: BigInt = terms.iter().map(|&(i, factor)| &heights[i] * BigInt::from(factor)).sum();
            terms.sort_by_key(|&(i, _)| std::cmp::Reverse(rank[i]));
            let raised = terms.iter().map(|&(_, factor)| factor).find(|&factor| factor != 0);
            (whole != 0).then(|| match main.sign() {
                Sign::NoSign => raised < Some(0),
                sign => sign == Sign::Minus,
            })
        })
    }

    /// Tetrahedra as sorted grains; translates of the same four grains are counted separately.
    fn tetrahedra(t: &Triangulation) -> Vec<[u32; 4]> {
        let mut all: Vec<[u32; 4]> = (0..t.tetrahedra())
            .map(|i| {
                let mut corners = t.corners(i);
                corners.sort_unstable();
                corners
            })
            .collect();
        all.sort_unstable();
        all
    }

    fn integers(points: &[[i64; 4]]) -> Packing {
        let grains = points.iter().map(|p| p.map(|v| v as f64)).map(|[x, y, z, r]| [x, y, z, 2.0 * r]);
        Packing::from_grains(Cell::Free, grains)
    }

    /// Ten thousand sets of five to eight grains: a third on a grid of 4 x 4 x 4 (only ties, duplicates
    /// among them), a third on a grid of 32, a third with 40 bits.
    #[test]
    fn small_sets_agree_with_brute_force() {
        let mut flat = 0;
        for set in 0..10_000u64 {
            let mut u = uniform(20_261_121, set);
            let grains = 5 + (set % 4) as usize;
            let (range, radius) = [(4, 2), (32, 12), (1 << 40, 1 << 38)][(set % 3) as usize];
            let points: Vec<[i64; 4]> = (0..grains)
                .map(|_| {
                    let mut below = |n: u64| (u() * n as f64) as i64;
                    [below(range), below(range), below(range), 1 + below(radius)]
                })
                .collect();
            match Triangulation::new(&integers(&points)) {
                Ok(t) => {
                    assert_eq!(t.sanity_check(), Ok(()), "set {set}: {points:?}");
                    let actual = tetrahedra(&t);
                    let expected: Vec<_> = polynomial(&points).into_iter().collect();
                    assert_eq!(actual, expected, "set {set}: {points:?}");
                    if set % 101 == 0 {
                        assert!(literal(&points).into_iter().eq(expected), "set {set}: {points:?}");
                    }
                }
                Err(TriangulationError::Coplanar { .. }) => {
                    assert!(polynomial(&points).is_empty());
                    flat += 1;
                }
                Err(other) => panic!("{other}"),
            }
        }
        assert!(flat < 500);
    }

    #[test]
    fn random_periodic_packings_are_sane() {
        for (chunk, (grains, extent, sizes)) in [
            (4, [10.0, 10.0, 10.0], [0.1, 1.0]),
            (5, [1.0, 2.0, 1.5], [0.1, 0.5]),
            (20, [10.0, 10.0, 10.0], [0.1, 5.0]),
            (100, [10.0, 3.0, 5.0], [0.1, 1.5]),
            (700, [10.0, 10.0, 10.0], [0.5, 1.0]),
            (3_000, [10.0, 10.0, 10.0], [0.01, 0.6]),
            (3_000, [10.0, 10.0, 10.0], [0.01, 5.0]),
        ]
        .into_iter()
        .enumerate()
        {
            let packing = random(grains, Cell::Periodic(extent), extent, sizes, chunk as u64);
            let t = Triangulation::new(&packing).unwrap_or_else(|error| panic!("{grains} grains: {error}"));
            assert_eq!(t.sanity_check(), Ok(()), "{grains} grains");
        }
    }

    /// The torus and the images give the same tetrahedra, ties included.
    #[test]
    fn the_torus_agrees_with_images() {
        let centre = |i: usize| [i, i / 12, i / 144].map(|i| (i % 12) as f64);
        let grains = (0..1728).map(centre).map(|[x, y, z]| [x, y, z, 1.0]);
        let cubic = Packing::from_grains(Cell::Periodic([12.0; 3]), grains);
        let loose = random(1_500, Cell::Periodic([8.0; 3]), [8.0; 3], [0.2, 1.0], 7);
        for packing in [cubic, loose] {
            let by_images = Triangulation::with_samples(&packing, &[]).unwrap();
            for sample in [100, 300] {
                let on_torus = Triangulation::with_samples(&packing, &[sample]).unwrap();
                assert_eq!(tetrahedra(&on_torus), tetrahedra(&by_images));
                assert_eq!(on_torus.sanity_check(), Ok(()));
            }
        }
    }

    #[test]
    fn hidden_grains_and_duplicates_are_named() {
        let mut packing = random(300, Cell::Periodic([5.0; 3]), [5.0; 3], [0.4, 0.5], 9);
        let grain = [packing.x[17], packing.y[17], packing.z[17]];
        for (dx, diameter) in [(0.0, packing.diameter[17]), (0.01, 0.1), (0.0, 0.2)] {
            packing.x.push(grain[0] + dx);
            packing.y.push(grain[1]);
            packing.z.push(grain[2]);
            packing.diameter.push(diameter);
        }
        let t = Triangulation::new(&packing).unwrap();
        assert_eq!(t.sanity_check(), Ok(()));
        // Either of two equal grains may remain.
        let gone = if t.hidden().contains(&17) { 17 } else { 300 };
        for hidden in [gone, 301, 302] {
            assert!(t.hidden().contains(&hidden), "{:?}", t.hidden());
        }
        assert_eq!(t.duplicates(), [[gone, 317 - gone], [302, 317 - gone]]);
    }

    #[test]
    fn what_has_no_triangulation_is_refused() {
        let cell = Cell::Periodic([5.0; 3]);
        let good = random(50, cell, [5.0; 3], [0.4, 0.5], 10);
        let refused = |change: &dyn Fn(&mut Packing)| {
            let mut packing = good.clone();
            change(&mut packing);
            Triangulation::new(&packing).unwrap_err().to_string()
        };
        let message = refused(&|p| p.cell = Cell::Periodic([5.0, 0.9, 5.0]));
        assert!(message.contains("0.9 mm along y") && message.contains("twice"), "{message}");
        assert!(refused(&|p| p.cell = Cell::Periodic([5.0, f64::NAN, 5.0])).contains("along y"));
        assert!(refused(&|p| p.x[3] = f64::INFINITY).contains("grain 3: x = inf"));
        assert!(refused(&|p| p.diameter[7] = -1.0).contains("grain 7: diameter = -1"));
        assert!(refused(&|p| p.y.truncate(9)).contains("column y has 9 rows"));
        let few = |p: &mut Packing| *p = integers(&[[0, 0, 0, 1]; 3]);
        assert!(refused(&few).contains("at least 4"));
        let flat = |p: &mut Packing| (p.cell, p.z) = (Cell::Free, vec![1.25; 50]);
        assert!(refused(&flat).contains("one plane"));
    }

    /// A triangulation broken on purpose fails the check.
    #[test]
    fn a_broken_triangulation_is_noticed() {
        let packing = random(200, Cell::Periodic([5.0; 3]), [5.0; 3], [0.4, 0.5], 11);
        let good = Triangulation::new(&packing).unwrap();
        let mut turned = good.clone();
        turned.mesh.corners[5].swap(0, 1);
        turned.mesh.neighbours[5].swap(0, 1);
        assert!(turned.sanity_check().is_err());
        let mut lost = good.clone();
        lost.mesh.neighbours[8][2] = 0;
        assert_eq!(lost.sanity_check(), Err(SanityError::Facet(8, 2)));
        let mut heavy = good.clone();
        heavy.points.at[3][3] *= 40.0;
        assert!(matches!(heavy.sanity_check(), Err(SanityError::Irregular { .. })));
    }
}
