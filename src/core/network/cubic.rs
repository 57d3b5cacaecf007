//! The directed cubic lattice of the paper (Fig. 2).

use rand::Rng;
use rayon::prelude::*;

use super::{END, Network, NetworkError};
use crate::constrictions::Curve;
use crate::stream::{Key, Purpose};

/// Constrictions drawn from one stream; fixed, so that threads change nothing.
const BLOCK: usize = 1 << 14;

impl Network {
    /// Number of constrictions of a cubic lattice.
    ///
    /// # Errors
    /// A length of 0, or more constrictions than 32 bits can number.
    pub fn lattice_constrictions(shape: [u32; 3]) -> Result<usize, NetworkError> {
        let count = shape.iter().try_fold(3u64, |product, &n| product.checked_mul(u64::from(n)));
        match count {
            Some(count) if count > 0 && count < u64::from(END) => Ok(count as usize),
            _ => Err(NetworkError::Shape { shape }),
        }
    }

    /// The directed cubic lattice: void `x + nx (y + ny z)`, exits +x, +y, +z in that order,
    /// periodic in x and y, start nodes in layer 0, +z of the last layer leaves the filter.
    ///
    /// Constriction diameters are independent draws from `curve`, in its own units, divided by
    /// `unit_mm`.
    ///
    /// ```
    /// use voidwalk_core::constrictions::{Curve, CurveUnit};
    /// use voidwalk_core::network::Network;
    /// let curve = Curve::from_points(&[(0.0, 0.15), (100.0, 0.35)], CurveUnit::Mm)?;
    /// let network = Network::cubic([10, 10, 20], &curve, 1.0, 7)?;
    /// assert_eq!((network.voids(), network.constrictions(), network.layers()), (2000, 6000, 20));
    /// assert_eq!(network.targets()[network.exits(0)], [1, 10, 100]);
    /// assert!(network.diameters().iter().all(|diameter| (0.15..=0.35).contains(diameter)));
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    ///
    /// # Errors
    /// A length of 0, or more constrictions than 32 bits can number.
    pub fn cubic(shape: [u32; 3], curve: &Curve, unit_mm: f64, seed: u64) -> Result<Self, NetworkError> {
        let count = Self::lattice_constrictions(shape)?;
        let diameter = Self::draw_diameters(count, 0, curve, unit_mm, seed);
        Self::cubic_from_diameters(shape, diameter, unit_mm)
    }

    /// `count` independent draws from `curve`, divided by `unit_mm`; the streams of the network's blocks from
    /// `first_block` on.
    pub(super) fn draw_diameters(
        count: usize,
        first_block: u64,
        curve: &Curve,
        unit_mm: f64,
        seed: u64,
    ) -> Vec<f32> {
        let (mut diameter, sizes) = (vec![0f32; count], curve.draws());
        diameter.par_chunks_mut(BLOCK).enumerate().for_each(|(block, diameters)| {
            let chunk = first_block + block as u64;
            let mut draws = Key { seed, purpose: Purpose::Network, run: 0, increment: 0, chunk }.generator();
            sizes.fill(|| draws.next_u64(), diameters, unit_mm);
        });
        diameter
    }

    /// The directed cubic lattice with given diameters, in units of `unit_mm`: exit `e` of void `v`
    /// is entry `3 v + e`.
    ///
    /// # Errors
    /// A length of 0, too many constrictions, the wrong number of diameters, or a diameter that is
    /// negative or not finite.
    pub fn cubic_from_diameters(
        shape: [u32; 3],
        diameter: Vec<f32>,
        unit_mm: f64,
    ) -> Result<Self, NetworkError> {
        let count = Self::lattice_constrictions(shape)?;
        if diameter.len() != count {
            return Err(NetworkError::WrongLength { shape, expected: count, found: diameter.len() });
        }
        if let Some(at) = diameter.iter().position(|d| !(d.is_finite() && *d >= 0.0)) {
            return Err(NetworkError::Diameter { constriction: at, value: diameter[at] });
        }
        let [nx, ny, nz] = shape;
        let voids = (count / 3) as u32;
        let plane = nx * ny;
        let mut target = Vec::with_capacity(count);
        let mut layer = Vec::with_capacity(voids as usize);
        for z in 0..nz {
            layer.resize(layer.len() + plane as usize, z);
            for y in 0..ny {
                let row = plane * z + nx * y;
                for x in 0..nx {
                    let void = row + x;
                    target.extend([
                        if x + 1 == nx { row } else { void + 1 },
                        if y + 1 == ny { void + nx - plane } else { void + nx },
                        if z + 1 == nz { END } else { void + plane },
                    ]);
                }
            }
        }
        Ok(Self {
            exit_begin: (0..=voids).map(|v| 3 * v).collect(),
            target,
            diameter,
            start: (0..plane).collect(),
            layer,
            unit_mm,
            shape: Some(shape),
            undirected: None,
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn exits_wrap_sideways_and_leave_downstream() {
        let network = Network::cubic_from_diameters([2, 3, 2], vec![1.0; 36], 1.0).unwrap();
        assert_eq!(network.targets()[network.exits(0)], [1, 2, 6]);
        assert_eq!(network.targets()[network.exits(5)], [4, 1, 11]);
        assert_eq!(network.targets()[network.exits(11)], [10, 7, END]);
        assert_eq!(network.start(), [0, 1, 2, 3, 4, 5]);
        assert_eq!((network.layers(), network.layer_of()[11]), (2, 1));
    }

    #[test]
    fn a_single_void_leads_to_itself() {
        let network = Network::cubic_from_diameters([1, 1, 1], vec![1.0; 3], 1.0).unwrap();
        assert_eq!(network.targets(), [0, 0, END]);
    }

    #[test]
    fn impossible_shapes_and_diameters_are_refused() {
        for shape in [[0, 1, 1], [1_000_000_000, 1, 2], [u32::MAX; 3]] {
            assert!(matches!(
                Network::cubic_from_diameters(shape, vec![], 1.0),
                Err(NetworkError::Shape { .. })
            ));
        }
        assert!(Network::cubic_from_diameters([1, 1, 1], vec![1.0; 4], 1.0).is_err());
        assert!(Network::cubic_from_diameters([1, 1, 1], vec![1.0, f32::NAN, 1.0], 1.0).is_err());
    }
}
