//! Constriction sizes stratified over a lattice.

use rand::Rng;

use super::{Network, NetworkError};
use crate::constrictions::Curve;
use crate::stream::{Key, Purpose, below, unit};

impl Network {
    /// [`Network::cubic`] with stratified sizes: the curve is cut into as many equal parts as there are
    /// constrictions, and each constriction, in an order drawn at random, has one draw from a part of its
    /// own.
    ///
    /// The size of every single constriction has the distribution of the curve, as with independent draws;
    /// together they follow the curve closely, so networks of one curve differ less.
    ///
    /// ```
    /// use voidwalk::constrictions::{Curve, CurveUnit};
    /// use voidwalk::network::Network;
    /// let curve = Curve::from_points(&[(0.0, 1.0), (100.0, 2.0)], CurveUnit::Mm)?;
    /// let network = Network::cubic_stratified([10, 10, 10], &curve, 1.0, 7)?;
    /// // Exactly half of the sizes, not about half, are in the finer half of the curve.
    /// assert_eq!(network.diameters().iter().filter(|d| **d < 1.5).count(), 1500);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    ///
    /// # Errors
    /// As [`Network::cubic`].
    pub fn cubic_stratified(
        shape: [u32; 3],
        curve: &Curve,
        unit_mm: f64,
        seed: u64,
    ) -> Result<Self, NetworkError> {
        let count = Self::lattice_constrictions(shape)?;
        // The blocks of independent draws count from 0: this stream is nobody else's.
        let key = Key { seed, purpose: Purpose::Network, run: 0, increment: 0, chunk: u64::MAX };
        let mut draws = key.generator();
        let mut diameter: Vec<f32> = (0..count)
            .map(|part| {
                let within = (part as f64 + unit(draws.next_u64())) / count as f64;
                (curve.quantile(within) / unit_mm) as f32
            })
            .collect();
        for i in (1..count).rev() {
            diameter.swap(i, below(draws.next_u64(), i as u64 + 1) as usize);
        }
        Self::cubic_from_diameters(shape, diameter, unit_mm)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::constrictions::CurveUnit;

    /// One constriction over 4,000 networks: in the finer quarter with a probability of a quarter (standard
    /// deviation 27; a bias of 3 % of itself would pass), and no closer to its neighbour than at random.
    #[test]
    fn each_constriction_alone_has_the_distribution_of_the_curve() {
        let curve = Curve::from_points(&[(0.0, 1.0), (100.0, 2.0)], CurveUnit::Mm).unwrap();
        let (mut fine, mut both) = (0, 0);
        for seed in 0..4000 {
            let network = Network::cubic_stratified([2, 2, 10], &curve, 1.0, seed).unwrap();
            let [a, b] = [network.diameters()[5] < 1.25, network.diameters()[6] < 1.25];
            fine += i32::from(a);
            both += i32::from(a && b);
        }
        assert!((fine - 1000).abs() < 110, "{fine}");
        // 4000 * 30 / 120 * 29 / 119 = 244, standard deviation 15.
        assert!((both - 244).abs() < 60, "{both}");
    }
}
