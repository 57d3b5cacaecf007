//! Grain centres on an integer grid, so that a periodic image is exact.
//!
//! `x + L` rounds, and a rounded image no longer lies on exactly the grain's sphere: facets then fail to pair
//! across the boundary of a lattice. So centres, radii and cell lengths are first rounded to multiples of one
//! power of two, 2^-50 of the largest length (a grain of a thousandth of the cell moves by 1e-12 of its size
//! at most; centres that are already such multiples do not move). From there on every coordinate, every image
//! up to seven cells away and every difference of two is an integer held exactly by an f64, every predicate
//! has one exact answer, and that answer is the same for all images. A factor of two on all lengths changes
//! the grid with them, hence no bit.

use super::super::tangent::cross;
use super::error::TriangulationError;
use crate::packing::{Cell, Packing};

/// Centre x, y, z and radius in grid units: integers, exact in f64.
pub(in crate::constrictions) type GrainPoint = [f64; 4];

/// Thickness of grains that lie in one plane, over the largest diameter.
const FLAT: f64 = 1e-6;

/// Bits of the largest length in grid units.
const BITS: i32 = 50;

/// Largest number of grains that a corner can name ([`super::mesh`]).
pub(super) const MOST_GRAINS: usize = (1 << 26) - 1;

/// The grains of a packing on the grid.
#[derive(Clone, Debug)]
pub(super) struct Points {
    /// Centre, wrapped into the cell, and radius by grain.
    pub(super) at: Vec<GrainPoint>,
    /// Cell lengths in grid units; `None` for free boundaries.
    pub(super) cell: Option<[f64; 3]>,
    /// Length of a grid unit (mm), a power of two.
    pub(super) unit_mm: f64,
    /// Origin that was subtracted from the coordinates before rounding (mm).
    pub(super) origin_mm: [f64; 3],
}

impl Points {
    /// Checks a packing and puts it on the grid.
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
            return Err(TriangulationError::Extent { extent_mm });
        }
        let (unit_mm, scale) = (libm::ldexp(1.0, exponent), libm::ldexp(1.0, -exponent));
        let cell = match packing.cell {
            Cell::Periodic(lengths) => Some(lengths.map(|length| libm::rint(length * scale))),
            Cell::Free => None,
        };
        let mut at = vec![[0.0; 4]; grains];
        for (axis, column) in columns.into_iter().enumerate() {
            for (point, &value) in at.iter_mut().zip(column) {
                point[axis] = match packing.cell {
                    Cell::Periodic(lengths) => {
                        wrapped(value, lengths[axis], scale, cell.map_or(0.0, |cell| cell[axis]))
                    }
                    Cell::Free => libm::rint((value - origin_mm[axis]) * scale),
                };
            }
        }
        for (point, &diameter) in at.iter_mut().zip(&packing.diameter) {
            point[3] = libm::rint(0.5 * diameter * scale);
        }
        Ok(Self { at, cell, unit_mm, origin_mm })
    }

    /// Tells if the centres lie in one plane, or on one line.
    pub(super) fn is_flat(&self) -> bool {
        let from = self.at[0];
        let offsets: Vec<[f64; 3]> =
            self.at.iter().map(|p| std::array::from_fn(|axis| p[axis] - from[axis])).collect();
        let square = |v: &[f64; 3]| v.iter().map(|x| x * x).sum::<f64>();
        let longest = |all: &mut dyn Iterator<Item = [f64; 3]>| {
            all.max_by(|a, b| square(a).total_cmp(&square(b))).unwrap_or_default()
        };
        let along = longest(&mut offsets.iter().copied());
        let normal = longest(&mut offsets.iter().map(|offset| cross(&along, offset)));
        let flat = FLAT * 2.0 * self.at.iter().map(|p| p[3]).fold(0.0, f64::max);
        let height = |v: &[f64; 3]| (0..3).map(|axis| v[axis] * normal[axis]).sum::<f64>();
        let heights = || offsets.iter().map(height);
        let thickness = heights().fold(0.0, f64::max) - heights().fold(0.0, f64::min);
        square(&normal).sqrt() <= flat * square(&along).sqrt() || thickness <= flat * square(&normal).sqrt()
    }
}

/// Converts `value` to grid units, brought into `0 .. cell`.
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

/// Number of grains and largest diameter of a packing that can be triangulated.
fn check(packing: &Packing) -> Result<(usize, f64), TriangulationError> {
    let grains = packing.diameter.len();
    let columns = [("x", &packing.x), ("y", &packing.y), ("z", &packing.z)];
    for (name, column) in columns {
        if column.len() != grains {
            return Err(TriangulationError::Columns { column: name, rows: column.len(), grains });
        }
        if let Some(grain) = column.iter().position(|value| !value.is_finite()) {
            return Err(TriangulationError::Centre { grain, column: name, value: column[grain] });
        }
    }
    if let Some(grain) = packing.diameter.iter().position(|d| !(d.is_finite() && *d > 0.0)) {
        return Err(TriangulationError::Diameter { grain, value: packing.diameter[grain] });
    }
    if grains < 4 {
        return Err(TriangulationError::TooFew { grains });
    }
    if grains > MOST_GRAINS {
        return Err(TriangulationError::TooMany { grains });
    }
    let largest_mm = packing.diameter.iter().fold(0.0, |a: f64, &b| a.max(b));
    if let Cell::Periodic(lengths) = packing.cell {
        for (axis, length_mm) in ["x", "y", "z"].into_iter().zip(lengths) {
            // This form refuses NaN as well.
            if !(length_mm.is_finite() && length_mm >= 2.0 * largest_mm) {
                return Err(TriangulationError::Narrow { axis, length_mm, largest_mm });
            }
        }
    }
    Ok((grains, largest_mm))
}
