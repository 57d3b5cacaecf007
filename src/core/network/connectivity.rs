//! Lattices with a given distribution of void connectivity (paper, section 6, Table 3 and Fig. 20).
//!
//! The *connectivity* of a void is the number of its entrances and exits, 6 for every void of the cubic
//! lattice. The paper spreads it over 4 to 8: "constrictions were created between diagonally neighbouring
//! voids, or deleted until the connectivity distribution shown in Table 3 was reached". It specifies neither
//! the order nor the diagonals: module `possible_exits` chooses them. Remaining constrictions have the same
//! diameters as in the cubic lattice with the same seed; diagonals are further independent draws from the
//! same curve.

use super::possible_exits::{MOST, PossibleExits, SLOTS};
use super::{END, Network, NetworkError};
use crate::constrictions::Curve;

/// Table 3 of the paper: connectivity, and percent of the voids.
pub(crate) const TABLE_3: [(u32, f64); 5] = [(4, 3.5), (5, 22.8), (6, 47.6), (7, 22.6), (8, 3.5)];

/// First block of the random stream for diameters of diagonals; blocks of the lattice begin at 0.
const FIRST_DIAGONAL_BLOCK: u64 = 1 << 32;

/// Distribution of connectivity: percent of the voids by connectivity.
#[derive(Clone, Debug, PartialEq)]
pub struct Connectivity {
    /// Percent by connectivity, in rising order of connectivity; sums to 100.
    percent: Vec<(u32, f64)>,
}

impl Connectivity {
    /// Distribution of Table 3.
    pub fn table_3() -> Self {
        Self { percent: TABLE_3.to_vec() }
    }

    /// Builds a distribution from pairs of connectivity and percent of the voids, in any order.
    ///
    /// # Errors
    /// A connectivity outside 2 to 12 or given twice, a percentage that is negative or not finite, or a
    /// sum that differs from 100 by more than 0.5. Smaller differences are scaled away.
    pub fn new(percent: &[(u32, f64)]) -> Result<Self, NetworkError> {
        let refused =
            |value: String, allowed: &str| Err(NetworkError::Connectivity { value, allowed: allowed.into() });
        let mut percent = percent.to_vec();
        percent.sort_by_key(|&(k, _)| k);
        for &(k, share) in &percent {
            if !(2..=MOST as u32).contains(&k) {
                return refused(k.to_string(), "a whole number from 2 (one entrance, one exit) to 12");
            }
            if !(share.is_finite() && share >= 0.0) {
                return refused(format!("{k} = {share}"), "a percentage of the voids, not negative");
            }
        }
        if let Some(twice) = percent.windows(2).find(|pair| pair[0].0 == pair[1].0) {
            return refused(twice[0].0.to_string(), "every connectivity once");
        }
        let sum: f64 = percent.iter().map(|(_, share)| share).sum();
        if (sum - 100.0).abs() > 0.5 {
            return refused(format!("a sum of {sum}"), "percentages that sum to 100");
        }
        // A distribution that was scaled before stays the same to the bit.
        if (sum - 100.0).abs() > 1e-9 {
            percent.iter_mut().for_each(|(_, share)| *share *= 100.0 / sum);
        }
        percent.retain(|(_, share)| *share > 0.0);
        Ok(Self { percent })
    }

    /// Connectivity and percent of the voids, in rising order of connectivity.
    pub fn percent(&self) -> &[(u32, f64)] {
        &self.percent
    }

    /// Number of voids by connectivity, summing to `voids`: rounded by largest remainder.
    pub(super) fn voids(&self, voids: u64) -> [i64; MOST + 1] {
        let mut counts = [0; MOST + 1];
        let exact = |share: f64| share / 100.0 * voids as f64;
        for &(k, share) in &self.percent {
            counts[k as usize] = exact(share) as i64;
        }
        let mut order: Vec<&(u32, f64)> = self.percent.iter().collect();
        order.sort_by(|a, b| exact(b.1).fract().total_cmp(&exact(a.1).fract()));
        let missing = voids as i64 - counts.iter().sum::<i64>();
        for &&(k, _) in order.iter().cycle().take(missing.max(0) as usize) {
            counts[k as usize] += 1;
        }
        counts
    }
}

impl Network {
    /// Builds a lattice of this shape whose voids have this distribution of connectivity, with diameters
    /// drawn as in [`Network::cubic`].
    ///
    /// # Errors
    /// Errors of [`Network::cubic`], and a distribution that no such network has.
    ///
    /// ```
    /// use voidwalk_core::constrictions::{Curve, CurveUnit};
    /// use voidwalk_core::network::{Connectivity, Network};
    /// let curve = Curve::from_points(&[(0.0, 0.15), (100.0, 0.35)], CurveUnit::D0f)?;
    /// let network = Network::connected([10, 10, 20], &curve, 1.0, 7, &Connectivity::table_3())?;
    /// let six = network.connectivity().iter().filter(|&&k| k == 6).count();
    /// assert_eq!(six, 952); // 47.6 % of 2,000 voids
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn connected(
        shape: [u32; 3],
        curve: &Curve,
        unit_mm: f64,
        seed: u64,
        connectivity: &Connectivity,
    ) -> Result<Self, NetworkError> {
        let count = Self::lattice_constrictions(shape)?;
        if 2 * count as u64 >= u64::from(END) {
            return Err(NetworkError::Shape { shape });
        }
        let mut exits = PossibleExits::cubic(shape);
        exits.change_to(&connectivity.voids(exits.present.len() as u64), seed)?;
        let on_axes = Self::draw_diameters(count, 0, curve, unit_mm, seed);
        let diagonals = exits.present.iter().map(|bits| (bits >> 3).count_ones() as usize).sum();
        let mut diagonals =
            Self::draw_diameters(diagonals, FIRST_DIAGONAL_BLOCK, curve, unit_mm, seed).into_iter();
        let voids = exits.present.len();
        let mut network = Self {
            exit_begin: Vec::with_capacity(voids + 1),
            target: Vec::with_capacity(count),
            diameter: Vec::with_capacity(count),
            start: (0..shape[0] * shape[1]).collect(),
            layer: (0..voids as u32).map(|v| v / (shape[0] * shape[1])).collect(),
            unit_mm,
            shape: None,
            undirected: None,
        };
        for void in 0..voids {
            network.exit_begin.push(network.target.len() as u32);
            for slot in (0..SLOTS).filter(|slot| exits.present[void] >> slot & 1 == 1) {
                let Some(target) = exits.target(void as u32, slot) else { continue };
                network.target.push(target);
                network.diameter.push(match slot {
                    0..3 => on_axes[3 * void + slot],
                    _ => diagonals.next().unwrap_or_default(),
                });
            }
        }
        network.exit_begin.push(network.target.len() as u32);
        Ok(network)
    }

    /// Connectivity of each void: its entrances and exits. The inlet of a start node counts as an entrance.
    pub fn connectivity(&self) -> Vec<u32> {
        let mut connectivity: Vec<u32> =
            (0..self.voids() as u32).map(|v| self.exits(v).len() as u32).collect();
        for &target in self.target.iter().filter(|&&target| target != END) {
            connectivity[target as usize] += 1;
        }
        for &void in &self.start {
            connectivity[void as usize] += 1;
        }
        connectivity
    }
}

#[cfg(test)]
mod tests {
    use super::super::possible_exits::STEPS;
    use super::*;
    use crate::constrictions::CurveUnit;
    use proptest::prelude::*;

    fn curve() -> Curve {
        Curve::from_points(&[(0.0, 0.15), (100.0, 0.35)], CurveUnit::D0f).unwrap()
    }

    fn connected(shape: [u32; 3], seed: u64, percent: &[(u32, f64)]) -> Result<Network, NetworkError> {
        Network::connected(shape, &curve(), 1.0, seed, &Connectivity::new(percent)?)
    }

    #[test]
    fn table_3_is_met_to_the_void_in_positive_directions() {
        let network = connected([40, 40, 60], 1, &TABLE_3).unwrap();
        check_directed(&network, [40, 40, 60]);
        assert!((0..network.voids() as u32).all(|void| network.exits(void).len() >= 2));
        let mean = network.connectivity().iter().sum::<u32>() as f64 / 96_000.0;
        assert!((mean - 5.998).abs() < 1e-9, "{mean}");
    }

    /// Every step leads to x, y, z or one more, across periodic sides; without steps across a side there
    /// are no cycles, since every step then leads to a larger void number.
    fn check_directed(network: &Network, shape: [u32; 3]) {
        let [nx, ny, nz] = shape;
        let place = |v: u32| [v % nx, v / nx % ny, v / (nx * ny)];
        let upstream = network.upstream();
        for (c, &target) in network.targets().iter().enumerate() {
            let from = place(upstream[c]);
            if target == END {
                assert_eq!(from[2], nz - 1);
                continue;
            }
            let to = place(target);
            let step = [(to[0] + nx - from[0]) % nx, (to[1] + ny - from[1]) % ny, to[2] - from[2]];
            assert!(STEPS.contains(&step), "{from:?} {to:?}");
            let over_seam = to[0] < from[0] || to[1] < from[1];
            assert!(over_seam || target > upstream[c]);
        }
        let (begin, _) = network.entrances();
        for void in 0..network.voids() as u32 {
            let start = void < nx * ny;
            assert_eq!(network.layer_of()[void as usize], place(void)[2]);
            let has_entrance = start || begin[void as usize + 1] > begin[void as usize];
            assert!(!network.exits(void).is_empty() && has_entrance);
        }
        assert_eq!(network.layers(), nz as usize);
    }

    #[test]
    fn kept_constrictions_keep_their_diameters_and_diagonals_follow_the_curve() {
        let shape = [20, 20, 30];
        let cubic = Network::cubic(shape, &curve(), 1.0, 5).unwrap();
        let network = connected(shape, 5, &TABLE_3).unwrap();
        let (mut kept, mut sum, mut diagonals) = (0, 0.0, 0.0);
        for void in 0..network.voids() as u32 {
            for exit in network.exits(void) {
                let (target, d) = (network.targets()[exit], network.diameters()[exit]);
                let on_axis = cubic.exits(void).find(|&c| cubic.targets()[c] == target);
                match on_axis {
                    Some(c) => {
                        assert_eq!(d, cubic.diameters()[c]);
                        kept += 1;
                    }
                    None => {
                        sum += f64::from(d);
                        diagonals += 1.0;
                    }
                }
            }
        }
        // A void that goes from 6 to k takes | k - 6 | changes, and each change serves two voids: the
        // voids lose entrances or exits numbering 29.8 % of all voids, and gain 29.6 %. At least 1,788 of
        // 36,000 constrictions must be deleted and 1,776 diagonals created; the search needs few more.
        let deleted = cubic.constrictions() - kept;
        assert!((1788..1900).contains(&deleted), "{deleted}");
        assert!((1776.0..1900.0).contains(&diagonals), "{diagonals}");
        // Mean of a uniform curve: 0.25, with a standard error of at most 0.0577 / sqrt(1500).
        assert!((sum / diagonals - 0.25).abs() < 5.0 * 0.0577 / f64::sqrt(diagonals));
    }

    #[test]
    fn the_same_seed_gives_the_same_network_on_any_number_of_threads() {
        let on = |threads| {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
            pool.install(|| connected([16, 16, 20], 9, &TABLE_3).unwrap())
        };
        let one = on(1);
        assert_eq!(one, on(3));
        assert_ne!(one, connected([16, 16, 20], 10, &TABLE_3).unwrap());
    }

    #[test]
    fn what_no_such_network_has_is_refused_with_the_nearest() {
        let error = connected([6, 6, 6], 1, &[(12, 100.0)]).unwrap_err().to_string();
        assert!(error.contains("the nearest found was") && error.contains("12 = 100"), "{error}");
        for (percent, message) in [
            (vec![(1, 100.0)], "from 2"),
            (vec![(13, 100.0)], "to 12"),
            (vec![(6, 90.0)], "a sum of 90"),
            (vec![(6, 50.0), (6, 50.0)], "every connectivity once"),
            (vec![(6, -1.0), (5, 101.0)], "not negative"),
            (vec![(6, f64::NAN)], "not negative"),
        ] {
            let error = connected([3, 3, 3], 1, &percent).unwrap_err().to_string();
            assert!(error.contains(message), "{error}");
        }
    }

    #[test]
    fn what_one_seed_reaches_is_reached_by_others() {
        for (shape, percent) in [
            ([7, 5, 9], vec![(4, 50.0), (8, 50.0)]),
            ([4, 4, 5], vec![(4, 50.0), (8, 50.0)]),
            ([5, 5, 8], vec![(3, 20.0), (6, 60.0), (9, 20.0)]),
        ] {
            for seed in 0..20 {
                check_directed(&connected(shape, seed, &percent).unwrap(), shape);
            }
        }
    }

    #[test]
    fn all_six_is_the_cubic_lattice() {
        let shape = [5, 4, 6];
        let network = connected(shape, 2, &[(6, 100.0)]).unwrap();
        let cubic = Network::cubic(shape, &curve(), 1.0, 2).unwrap();
        assert_eq!((network.targets(), network.diameters()), (cubic.targets(), cubic.diameters()));
        assert_eq!(cubic.connectivity(), vec![6; 120]);
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(40))]
        /// Any distribution over 3 to 9 with a mean of 5 to 7 is reached.
        #[test]
        fn distributions_are_met(
            shares in proptest::array::uniform7(0.0f64..1.0), seed: u64,
            shape in [6u32..12, 6u32..12, 6u32..12],
        ) {
            let sum: f64 = shares.iter().sum();
            prop_assume!(sum > 0.5);
            let mean = shares.iter().zip(3..).map(|(s, k)| s / sum * f64::from(k)).sum::<f64>();
            prop_assume!((5.0..=7.0).contains(&mean));
            let percent: Vec<(u32, f64)> = (3..).zip(shares.map(|s| 100.0 * s / sum)).collect();
            let network = connected(shape, seed, &percent).unwrap();
            check_directed(&network, shape);
            let voids = network.voids() as f64;
            let mut counted = [0; MOST + 1];
            network.connectivity().iter().for_each(|&k| counted[k as usize] += 1);
            for (k, share) in percent {
                // Rounding changes a count by at most one, the tolerance by one more.
                prop_assert!((f64::from(counted[k as usize]) - share / 100.0 * voids).abs() <= 2.0);
            }
        }
    }
}
