//! How the passive particles of a void are split over its exits.

use bitvec::slice::BitSlice;

use super::binomial::CERTAIN;
use crate::network::Network;
use crate::walk::exits;

/// By constriction: the probability that a particle which has not taken an earlier exit of its void takes
/// this one, as a 64-bit fraction. The last open exit is certain; closed ones have none.
pub(super) struct Shares {
    probability: Vec<u64>,
    /// By void: whether it has an open exit.
    leads_on: Vec<bool>,
    /// By void: whether its particles wait for one.
    waits: Vec<bool>,
}

impl Shares {
    /// The shares of the constrictions that `blocked` leaves open.
    pub fn new(network: &Network, blocked: &BitSlice) -> Self {
        let mut shares = Self {
            probability: vec![0; network.constrictions()],
            leads_on: vec![false; network.voids()],
            waits: vec![false; network.voids()],
        };
        let mut thresholds = Vec::new();
        for void in 0..network.voids() as u32 {
            shares.set(network, blocked, void, &mut thresholds);
        }
        shares
    }

    /// Renews the shares of one void.
    ///
    /// They follow from the thresholds of the walk one by one, so that both engines give an exit the same
    /// probability to 2^-64.
    pub fn set(&mut self, network: &Network, blocked: &BitSlice, void: u32, thresholds: &mut Vec<u64>) {
        let exits = network.exits(void);
        let last = exits::thresholds(network, blocked, void, thresholds);
        self.leads_on[void as usize] = last.is_some();
        self.waits[void as usize] = last.is_none() && exits::waits(network, void);
        let mut before = 0u64;
        for (e, probability) in self.probability[exits].iter_mut().enumerate() {
            *probability = match last {
                Some(last) if e == last => CERTAIN,
                Some(last) if e < last => {
                    let (width, rest) = (thresholds[e] - before, (1u128 << 64) - u128::from(before));
                    (((u128::from(width) << 64) / rest) as u64).min(CERTAIN - 1)
                }
                _ => 0,
            };
            before = thresholds[e];
        }
    }

    /// Probability of each constriction.
    pub fn probability(&self) -> &[u64] {
        &self.probability
    }

    /// Probabilities of the first two of three exits, and the same two as thresholds for one 64-bit draw: it
    /// picks the first exit below the first threshold, else the second below the second, else the third. They
    /// do not hold beyond an exit that is certain.
    #[inline(always)]
    pub fn of_three(&self, exit: usize) -> (u64, u64, [u64; 2]) {
        let (first, second) = (self.probability[exit], self.probability[exit + 1]);
        let of_rest = second - ((u128::from(second) * u128::from(first)) >> 64) as u64;
        // The sum is a probability and stays below 1, except beside an exit that is certain: what it wraps to
        // there is the threshold that does not hold.
        (first, second, [first, first.wrapping_add(of_rest)])
    }

    /// Whether the particles of a void without open exits stay there until the flow is solved again.
    pub fn waits(&self, void: usize) -> bool {
        self.waits[void]
    }

    /// Whether a void has an open exit.
    #[inline]
    pub fn leads_on(&self, void: usize) -> bool {
        self.leads_on[void]
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use bitvec::vec::BitVec;

    fn of(diameters: [f32; 3], closed: [bool; 3]) -> (Vec<u64>, bool) {
        let network = Network::cubic_from_diameters([1, 1, 1], diameters.to_vec(), 1.0).unwrap();
        let blocked: BitVec = closed.into_iter().collect();
        let shares = Shares::new(&network, &blocked);
        (shares.probability.clone(), shares.leads_on(0))
    }

    #[test]
    fn probabilities_are_conditional_and_the_last_open_exit_is_certain() {
        let (probability, on) = of([1.0, 1.0, f32::sqrt(2.0)], [false; 3]);
        assert!(on && probability[2] == CERTAIN);
        assert!((probability[0] as f64 / 2f64.powi(62) - 1.0).abs() < 1e-6);
        assert!((probability[1] as f64 / 2f64.powi(64) - 1.0 / 3.0).abs() < 1e-6);
        assert_eq!(of([1.0; 3], [false, true, true]).0, [CERTAIN, 0, 0]);
        assert_eq!(of([1.0; 3], [true, false, true]).0, [0, CERTAIN, 0]);
        assert_eq!(of([1.0; 3], [false, true, false]).0[..2], [1 << 63, 0]);
        assert!(!of([1.0; 3], [true; 3]).1);
        assert!(!of([0.0; 3], [false; 3]).1);
    }

    /// Up to the last exit the thresholds are those of the walk one by one, to a unit; what stands beside a
    /// certain exit is not used.
    #[test]
    fn thresholds_of_three_exits_never_wrap_where_they_hold() {
        let sizes = [0.0f32, 1e-12, 1e-3, 0.7, 1.0, 3.0, 1e9, 1e19];
        let all = || sizes.into_iter();
        for d in all().flat_map(|x| all().flat_map(move |y| all().map(move |z| [x, y, z]))) {
            let network = Network::cubic_from_diameters([1, 1, 1], d.to_vec(), 1.0).unwrap();
            let blocked: BitVec = BitVec::repeat(false, 3);
            let (first, second, [to_first, to_second]) = Shares::new(&network, &blocked).of_three(0);
            assert_eq!(to_first, first);
            if first != CERTAIN && second != CERTAIN {
                assert!(to_second >= to_first, "{d:?}");
            }
        }
    }

    /// An exit with 1e24 times the area leaves the others possible.
    #[test]
    fn a_giant_is_not_certain() {
        assert_eq!(of([1e12, 1.0, 1.0], [false; 3]).0[0], CERTAIN - 1);
        assert_eq!(of([1e12, 1.0, 1.0], [true, false, false]).0[1], 1 << 63);
    }
}
