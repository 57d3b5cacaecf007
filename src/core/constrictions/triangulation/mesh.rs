//! Topology: tetrahedra as columns, in space or on the torus.
//!
//! Tetrahedron `t` is entry `t` of each column. Its corners are stored in one of its periodic translates; a
//! walk that crosses a facet carries along the shift, in cells, of its present translate from the stored one.
//! Without a cell all shifts are zero.

use super::points::{GrainPoint, MOST_GRAINS, Points};

/// Whole cells along x, y, z: one signed byte each, x lowest.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub(in crate::constrictions) struct Shift(pub(super) u32);

impl Shift {
    pub(in crate::constrictions) const ZERO: Self = Self(0);

    pub(in crate::constrictions) fn new(cells: [i32; 3]) -> Self {
        Self(cells.iter().rev().fold(0, |word, &c| (word << 8) | (c as u32 & 0xff)))
    }

    #[inline(always)]
    pub(in crate::constrictions) fn cells(self) -> [i32; 3] {
        [self.0 as i8, (self.0 >> 8) as i8, (self.0 >> 16) as i8].map(i32::from)
    }

    /// Adds bytewise, without carries from one axis into the next.
    #[inline(always)]
    pub(in crate::constrictions) fn plus(self, other: Self) -> Self {
        const LOW: u32 = 0x7f7f_7f7f;
        Self(((self.0 & LOW) + (other.0 & LOW)) ^ ((self.0 ^ other.0) & !LOW))
    }

    #[inline(always)]
    pub(in crate::constrictions) fn minus(self, other: Self) -> Self {
        const HIGH: u32 = 0x8080_8080;
        Self(((self.0 | HIGH) - (other.0 & !HIGH)) ^ ((self.0 ^ !other.0) & HIGH))
    }
}

/// A corner: the grain in the low 26 bits, above them the shift of its image in cells (0 .. 3 along each
/// axis, two bits each, x lowest).
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

/// Shift of a corner's image.
#[inline(always)]
pub(super) fn image(corner: Corner) -> Shift {
    let bits = corner >> GRAIN_BITS;
    Shift((bits & 3) | ((bits & 12) << 6) | ((bits & 48) << 12))
}

/// Makes the corner of a grain shifted by 0 .. 3 cells along each axis; `None` outside that range.
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
    /// Adds a tetrahedron without neighbours.
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

    /// Index of the corner at infinity, if any.
    #[inline(always)]
    pub(super) fn infinite_corner(&self, t: u32) -> Option<usize> {
        self.corners[t as usize].iter().position(|&c| c == INFINITE)
    }

    /// Drops dead and infinite tetrahedra; facets towards infinity get [`NONE`].
    pub(super) fn compact(&mut self) {
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
    }
}

/// Positions of the corners.
#[derive(Clone, Debug)]
pub(in crate::constrictions) struct Positions<'a> {
    pub(super) at: &'a [GrainPoint],
    cell: [f64; 3],
    /// Displacement by the six image bits of a corner.
    images: [GrainPoint; 64],
}

impl<'a> Positions<'a> {
    pub(super) fn new(points: &'a Points) -> Self {
        let cell = points.cell.unwrap_or([0.0; 3]);
        let images = std::array::from_fn(|bits| {
            let along = |axis: usize| ((bits >> (2 * axis)) & 3) as f64 * cell[axis];
            [along(0), along(1), along(2), 0.0]
        });
        Self { at: &points.at, cell, images }
    }

    /// Displacement by whole cells, exact.
    #[inline(always)]
    pub(in crate::constrictions) fn displacement(&self, shift: Shift) -> [f64; 3] {
        let [x, y, z] = shift.cells();
        [f64::from(x) * self.cell[0], f64::from(y) * self.cell[1], f64::from(z) * self.cell[2]]
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
        // Written out: the map of an array is not reliably unrolled.
        let [a, b, c, d] = *corners;
        if PERIODIC {
            let point = |c: Corner| self.corner(c, shift);
            [point(a), point(b), point(c), point(d)]
        } else {
            let point = |c: Corner| self.at[grain(c) as usize];
            [point(a), point(b), point(c), point(d)]
        }
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
