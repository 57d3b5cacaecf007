//! The step of the expectation on any network: void by void, each into those that its exits lead to.

use super::numbers::{Expected, NOTHING, retain};
use crate::network::Network;
use crate::walk::counts::binomial::as_unit;
use crate::walk::counts::shares::Shares;

/// The shares of the exits, and room for the moves.
pub(super) struct GeneralFlow {
    /// By constriction: the share that takes it, among the particles that have not taken an earlier exit of
    /// its void.
    shares: Vec<f64>,
    /// By void: expected number there after the step; 0 between two steps.
    pub next: Vec<f64>,
}

impl GeneralFlow {
    pub fn new(shares: &Shares, voids: usize) -> Self {
        let shares = shares.probability().iter().map(|&p| as_unit(p)).collect();
        Self { shares, next: vec![0.0; voids] }
    }

    /// Renews the shares of one void.
    pub fn set(&mut self, network: &Network, shares: &Shares, void: u32) {
        let exits = network.exits(void);
        let news = &shares.probability()[exits.clone()];
        self.shares[exits].iter_mut().zip(news).for_each(|(old, &p)| *old = as_unit(p));
    }

    /// Moves the expected numbers in each void.
    pub fn step(
        &mut self,
        network: &Network,
        shares: &Shares,
        expected: &mut Expected,
        holding: &mut Vec<u32>,
    ) {
        let next = &mut self.next;
        let Expected { moving, retained, sums, .. } = expected;
        let targets = network.targets();
        let (mut moves, mut eroded) = (sums.moves, sums.eroded);
        for (void, n) in moving.iter_mut().enumerate() {
            // Most of a thick filter is empty: nothing is written there.
            if *n == 0.0 {
                continue;
            }
            let mut n = std::mem::take(n);
            if n < NOTHING {
                continue;
            }
            if !shares.leads_on(void) {
                match shares.waits(void) {
                    true => next[void] += n,
                    false => retain(void, n, retained, holding),
                }
                continue;
            }
            moves += n;
            let exits = network.exits(void as u32);
            // Behind an exit that takes all nothing is left for those after it.
            for (share, &target) in self.shares[exits.clone()].iter().zip(&targets[exits]) {
                let taken = n * share;
                n -= taken;
                // END is beyond every void.
                match next.get_mut(target as usize) {
                    Some(there) => *there += taken,
                    None => eroded += taken,
                }
            }
        }
        (sums.moves, sums.eroded) = (moves, eroded);
        std::mem::swap(moving, next);
    }
}
