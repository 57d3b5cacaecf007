//! Grain centres on an integer grid, and the tetrahedra between them, in space or on the torus.
//!
//! # Grid
//! `x + L` rounds, and a rounded image no longer lies on exactly the grain's sphere: facets then fail to
//! pair across the boundary of a lattice. So centres, radii and cell lengths are first rounded to
//! multiples of a power of two, 2^-50 of the largest length (a grain of a thousandth of the cell moves
//! by at most 1e-12 of its size; centres that are already such multiples do not move). Every coordinate,
//! every image up to seven cells away and every difference of two is then an integer that an f64 holds
//! exactly, and every predicate has one exact answer, the same for all images. A factor of two on all
//! lengths scales the grid too, and so changes no bit.
//!
//! # Tetrahedra
//! Tetrahedron `t` is entry `t` of each column. Its corners are stored in one of its periodic
//! translates; a walk that crosses facets keeps track of the shift, in cells, of its present translate
//! from the stored one. Without a cell all shifts are zero.

use crate::packing::{Cell, Packing};

/// Centre x, y, z and radius in grid units: integers, exact in f64.
pub(crate) type GrainPoint = [f64; 4];

#[inline(always)]
pub(crate) fn offset(from: &[f64], to: &[f64]) -> [f64; 3] {
    [to[0] - from[0], to[1] - from[1], to[2] - from[2]]
}

#[inline(always)]
pub(crate) fn dot<const N: usize>(a: &[f64; N], b: &[f64; N]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

#[inline(always)]
pub(crate) fn cross(a: &[f64; 3], b: &[f64; 3]) -> [f64; 3] {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}

pub(crate) fn facet(corners: &[GrainPoint; 4], corner: usize) -> [GrainPoint; 3] {
    [1, 2, 3].map(|k| corners[(corner + k) % 4])
}

pub(crate) fn edges(corners: &[GrainPoint; 4], corner: usize) -> [[f64; 3]; 3] {
    facet(corners, corner).map(|other| offset(&corners[corner], &other))
}

/// Six times the volume spanned by three edges.
pub(crate) fn six_volume([e, f, g]: &[[f64; 3]; 3]) -> f64 {
    dot(e, &cross(f, g)).abs()
}

/// Maximum number of grains that a [`Corner`] can name.
pub(super) const MOST_GRAINS: usize = (1 << GRAIN_BITS) - 1;

/// Thickness of grains that lie in one plane, over the largest diameter.
const FLAT: f64 = 1e-6;

/// Number of bits of the largest length in grid units.
const BITS: i32 = 50;

/// The grains of a packing on the grid.
#[derive(Clone, Debug)]
pub(super) struct Points {
    /// Centre, wrapped into the cell, and radius by grain.
    pub(super) at: Vec<GrainPoint>,
    /// Cell lengths in grid units; `None` for free boundaries.
    pub(super) cell: Option<[f64; 3]>,
    /// Displacement by one cell along each axis; zero for free boundaries.
    period: [f64; 3],
    /// Displacement for each value of a corner's six image bits.
    images: [[f64; 3]; 64],
    /// Length of a grid unit (mm), a power of two.
    pub(super) unit_mm: f64,
    /// Origin subtracted from the coordinates before rounding (mm).
    pub(super) origin_mm: [f64; 3],
}

impl Points {
    pub(super) fn new(packing: &Packing) -> Result<Self, TriangulationError> {
        let columns = [&packing.x, &packing.y, &packing.z];
        let (grains, largest_mm) = check(packing)?;
        let (origin_mm, extent_mm) = match packing.cell {
            Cell::Periodic(lengths) => ([0.0; 3], lengths.iter().fold(0.0, |a: f64, &b| a.max(b))),
            Cell::Free => {
                let low = columns.map(|c| c.iter().fold(f64::INFINITY, |a, &b| a.min(b)));
                let high = columns.map(|c| c.iter().fold(f64::NEG_INFINITY, |a, &b| a.max(b)));
                (low, (0..3).fold(largest_mm, |a, axis| a.max(high[axis] - low[axis])))
            }
        };
        let exponent = libm::frexp(extent_mm).1 - BITS;
        if !extent_mm.is_finite() || !(-900..900).contains(&exponent) {
            return Err(TriangulationError::Extent(extent_mm));
        }
        let (unit_mm, scale) = (libm::ldexp(1.0, exponent), libm::ldexp(1.0, -exponent));
        let cell = match packing.cell {
            Cell::Periodic(lengths) => Some(lengths.map(|length| libm::rint(length * scale))),
            Cell::Free => None,
        };
        let place = |axis: usize, value: f64| match (packing.cell, cell) {
            (Cell::Periodic(lengths), Some(cell)) => wrapped(value, lengths[axis], scale, cell[axis]),
            _ => libm::rint((value - origin_mm[axis]) * scale),
        };
        let at = (0..grains).map(|i| {
            let [x, y, z] = [0, 1, 2].map(|axis| place(axis, columns[axis][i]));
            [x, y, z, libm::rint(0.5 * packing.diameter[i] * scale)]
        });
        Ok(Self { unit_mm, origin_mm, ..Self::of(at.collect(), cell) })
    }

    pub(super) fn of(at: Vec<GrainPoint>, cell: Option<[f64; 3]>) -> Self {
        let period = cell.unwrap_or([0.0; 3]);
        let along = |bits: usize, axis: usize| ((bits >> (2 * axis)) & 3) as f64 * period[axis];
        let images = std::array::from_fn(|bits| std::array::from_fn(|axis| along(bits, axis)));
        Self { at, cell, period, images, unit_mm: 1.0, origin_mm: [0.0; 3] }
    }

    /// Displacement by whole cells, exact.
    #[inline(always)]
    pub(super) fn displacement(&self, shift: Shift) -> [f64; 3] {
        let [x, y, z] = shift.cells();
        [f64::from(x) * self.period[0], f64::from(y) * self.period[1], f64::from(z) * self.period[2]]
    }

    /// Position of a corner in the translate `shift`.
    #[inline(always)]
    pub(super) fn corner(&self, corner: Corner, shift: Shift) -> GrainPoint {
        let (at, by) = (&self.at[grain(corner) as usize], self.displacement(shift));
        let image = &self.images[(corner >> GRAIN_BITS) as usize];
        [at[0] + (image[0] + by[0]), at[1] + (image[1] + by[1]), at[2] + (image[2] + by[2]), at[3]]
    }

    /// Corners of a tetrahedron in the translate `shift`.
    #[inline(always)]
    pub(super) fn corners<const PERIODIC: bool>(
        &self,
        corners: &[Corner; 4],
        shift: Shift,
    ) -> [GrainPoint; 4] {
        // Written out, because the map of an array is not reliably unrolled.
        let [a, b, c, d] = *corners;
        let point = |c: Corner| match PERIODIC {
            true => self.corner(c, shift),
            false => self.at[grain(c) as usize],
        };
        [point(a), point(b), point(c), point(d)]
    }

    pub(super) fn is_flat(&self) -> bool {
        let from = self.at[0];
        let offsets: Vec<[f64; 3]> = self.at.iter().map(|p| offset(&from, p)).collect();
        let square = |v: &[f64; 3]| dot(v, v);
        let longest = |all: &mut dyn Iterator<Item = [f64; 3]>| {
            all.max_by(|a, b| square(a).total_cmp(&square(b))).unwrap_or_default()
        };
        let along = longest(&mut offsets.iter().copied());
        let normal = longest(&mut offsets.iter().map(|offset| cross(&along, offset)));
        let flat = FLAT * 2.0 * self.at.iter().map(|p| p[3]).fold(0.0, f64::max);
        let heights = || offsets.iter().map(|v| dot(v, &normal));
        let thickness = heights().fold(0.0, f64::max) - heights().fold(0.0, f64::min);
        square(&normal).sqrt() <= flat * square(&along).sqrt() || thickness <= flat * square(&normal).sqrt()
    }
}

/// Converts `value` to grid units and wraps it into `0 .. cell`.
fn wrapped(value: f64, length: f64, scale: f64, cell: f64) -> f64 {
    let inside = libm::rint((value - libm::floor(value / length) * length) * scale);
    if inside >= cell {
        inside - cell
    } else if inside < 0.0 {
        inside + cell
    } else {
        inside
    }
}

/// Checks that a packing can be triangulated; returns its number of grains and largest diameter.
fn check(packing: &Packing) -> Result<(usize, f64), TriangulationError> {
    let grains = packing.diameter.len();
    let columns = [("x", &packing.x), ("y", &packing.y), ("z", &packing.z)];
    for (name, column) in columns {
        if column.len() != grains {
            return Err(TriangulationError::Columns(name, column.len(), grains));
        }
        if let Some(grain) = column.iter().position(|value| !value.is_finite()) {
            return Err(TriangulationError::Centre(grain, name, column[grain]));
        }
    }
    if let Some(grain) = packing.diameter.iter().position(|d| !(d.is_finite() && *d > 0.0)) {
        return Err(TriangulationError::Diameter(grain, packing.diameter[grain]));
    }
    if grains < 4 {
        return Err(TriangulationError::TooFew(grains));
    }
    if grains > MOST_GRAINS {
        return Err(TriangulationError::TooMany(grains));
    }
    let largest_mm = packing.diameter.iter().fold(0.0, |a: f64, &b| a.max(b));
    if let Cell::Periodic(lengths) = packing.cell {
        for (axis, length_mm) in ["x", "y", "z"].into_iter().zip(lengths) {
            // This form refuses NaN as well.
            if !(length_mm.is_finite() && length_mm >= 2.0 * largest_mm) {
                return Err(TriangulationError::Narrow(length_mm, axis, largest_mm));
            }
        }
    }
    Ok((grains, largest_mm))
}

/// Reasons why a packing has no triangulation.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum TriangulationError {
    /// Fewer than four grains.
    #[error("{0} grains: a triangulation needs at least 4")]
    TooFew(usize),
    /// More grains than a corner can name.
    #[error("{0} grains: at most 67108863 can be triangulated")]
    TooMany(usize),
    /// Columns of different lengths: a column, its rows, and those of the diameters.
    #[error("column {0} has {1} rows, but there are {2} diameters")]
    Columns(&'static str, usize, usize),
    /// A coordinate that is not finite: the grain, from 0; the column; the value.
    #[error("grain {0}: {1} = {2} mm, but a centre must be finite")]
    Centre(usize, &'static str, f64),
    /// A diameter that is not a size.
    #[error("grain {0}: diameter = {1} mm, but it must be finite and above 0")]
    Diameter(usize, f64),
    /// Lengths (mm) so large or so small that their products exceed the range of f64.
    #[error("the largest length is {0} mm, but it must lie between 1e-250 and 1e250")]
    Extent(f64),
    /// A cell in which a grain meets its own image: its length (mm), along an axis, and the largest diameter.
    #[error("the cell is {0} mm along {1}, but it must be at least twice the largest grain ({2} mm)")]
    Narrow(f64, &'static str, f64),
    /// Free grains whose centres lie in one plane.
    #[error("the centres of all {0} grains lie in one plane: there is nothing to triangulate")]
    Coplanar(usize),
    /// A periodic packing so empty that its tetrahedra extend across several cells.
    #[error(
        "{0} grains are too few to fill this periodic cell: tetrahedra reach across several images of it"
    )]
    Sparse(usize),
}

/// Whole cells along x, y, z: one signed byte each, x lowest.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub(crate) struct Shift(pub(super) u32);

impl Shift {
    pub(crate) const ZERO: Self = Self(0);

    pub(crate) fn new(cells: [i32; 3]) -> Self {
        Self(cells.iter().rev().fold(0, |word, &c| (word << 8) | (c as u32 & 0xff)))
    }

    #[inline(always)]
    pub(crate) fn cells(self) -> [i32; 3] {
        [self.0 as i8, (self.0 >> 8) as i8, (self.0 >> 16) as i8].map(i32::from)
    }

    /// Adds bytewise, without carry from one axis to the next.
    #[inline(always)]
    pub(crate) fn plus(self, other: Self) -> Self {
        const LOW: u32 = 0x7f7f_7f7f;
        Self(((self.0 & LOW) + (other.0 & LOW)) ^ ((self.0 ^ other.0) & !LOW))
    }

    #[inline(always)]
    pub(crate) fn minus(self, other: Self) -> Self {
        const HIGH: u32 = 0x8080_8080;
        Self(((self.0 | HIGH) - (other.0 & !HIGH)) ^ ((self.0 ^ !other.0) & HIGH))
    }
}

/// A corner: the grain in the low 26 bits, and above them the shift of its image in cells (0 .. 3 along
/// each axis, two bits each, x lowest).
pub(super) type Corner = u32;

const GRAIN_BITS: u32 = 26;

/// The corner at infinity of the tetrahedra that close a free triangulation.
pub(super) const INFINITE: Corner = MOST_GRAINS as u32;

/// No neighbour; no tetrahedron.
pub(super) const NONE: u32 = u32::MAX;

#[inline(always)]
pub(super) fn grain(corner: Corner) -> u32 {
    corner & MOST_GRAINS as u32
}

#[inline(always)]
pub(super) fn image(corner: Corner) -> Shift {
    let bits = corner >> GRAIN_BITS;
    Shift((bits & 3) | ((bits & 12) << 6) | ((bits & 48) << 12))
}

/// Makes the corner of a grain shifted by 0 .. 3 cells along each axis; `None` for other shifts.
pub(super) fn corner(grain: u32, image: Shift) -> Option<Corner> {
    let [x, y, z] = image.cells();
    let fits = |c: i32| (0..4).contains(&c);
    (fits(x) && fits(y) && fits(z))
        .then_some(grain | (x as u32 | (y as u32) << 2 | (z as u32) << 4) << GRAIN_BITS)
}

/// Tetrahedra and their adjacency.
#[derive(Clone, Debug, Default)]
pub(super) struct Mesh {
    /// Corners by tetrahedron, positively oriented. A dead slot has [`NONE`] first.
    pub(super) corners: Vec<[Corner; 4]>,
    /// Neighbour across the facet opposite corner `i`: `4 * neighbour + its corner opposite that facet`.
    pub(super) neighbours: Vec<[u32; 4]>,
    /// Shift of the neighbour's stored translate, across the facet opposite corner `i`.
    pub(super) shifts: Vec<[Shift; 4]>,
}

impl Mesh {
    pub(super) fn push(&mut self, corners: [Corner; 4]) -> u32 {
        self.corners.push(corners);
        self.neighbours.push([NONE; 4]);
        self.shifts.push([Shift::ZERO; 4]);
        (self.corners.len() - 1) as u32
    }

    /// Links two facets; the second tetrahedron is shifted by `shift` as seen from the first.
    #[inline(always)]
    pub(super) fn link(&mut self, (t, i): (u32, usize), (u, j): (u32, usize), shift: Shift) {
        self.neighbours[t as usize][i] = 4 * u + j as u32;
        self.shifts[t as usize][i] = shift;
        self.neighbours[u as usize][j] = 4 * t + i as u32;
        self.shifts[u as usize][j] = Shift::ZERO.minus(shift);
    }

    /// Tells if a facet is linked to exactly one other, which is linked back.
    pub(super) fn is_paired(&self, t: usize, i: usize) -> bool {
        let across = self.neighbours[t][i];
        let (u, j) = ((across / 4) as usize, (across % 4) as usize);
        across != NONE
            && self.neighbours[u][j] == (4 * t + i) as u32
            && self.shifts[u][j] == Shift::ZERO.minus(self.shifts[t][i])
    }

    /// Index of the corner at infinity, if any.
    #[inline(always)]
    pub(super) fn infinite_corner(&self, t: u32) -> Option<usize> {
        self.corners[t as usize].iter().position(|&c| c == INFINITE)
    }

    /// Removes dead and infinite tetrahedra; facets towards infinity get [`NONE`].
    pub(super) fn compact(mut self) -> Self {
        let mut renumber = vec![NONE; self.corners.len()];
        let mut kept = 0;
        for (t, new) in renumber.iter_mut().enumerate() {
            if self.corners[t][0] != NONE && self.infinite_corner(t as u32).is_none() {
                *new = kept as u32;
                self.corners[kept] = self.corners[t];
                self.neighbours[kept] = self.neighbours[t];
                self.shifts[kept] = self.shifts[t];
                kept += 1;
            }
        }
        self.corners.truncate(kept);
        self.neighbours.truncate(kept);
        self.shifts.truncate(kept);
        for neighbour in self.neighbours.iter_mut().flatten() {
            let new = renumber[(*neighbour / 4) as usize];
            *neighbour = if new == NONE { NONE } else { 4 * new + *neighbour % 4 };
        }
        self
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn shifts_add_without_carry() {
        for a in -3..=3 {
            for b in -3..=3 {
                let (p, q) = (Shift::new([a, b, -a]), Shift::new([b, -a, a]));
                assert_eq!(p.plus(q).cells(), [a + b, b - a, 0]);
                assert_eq!(p.minus(q).cells(), [a - b, b + a, -2 * a]);
            }
        }
    }

    #[test]
    fn a_corner_keeps_its_grain_and_image() {
        for cells in [[0, 0, 0], [1, 0, 3], [3, 2, 1]] {
            let packed = corner(12_345, Shift::new(cells)).unwrap();
            assert_eq!((grain(packed), image(packed).cells()), (12_345, cells));
        }
        assert_eq!(corner(0, Shift::new([4, 0, 0])), None);
        assert_eq!(corner(0, Shift::new([0, -1, 0])), None);
    }
}
