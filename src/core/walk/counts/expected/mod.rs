//! The expectation of the passive particles given the history of blocking: one f64 a void, no draw.
//!
//! Sums run in an order fixed by the network alone, on one thread, so they are the same everywhere. Whole
//! numbers for the tally are rounded from running sums, so that they add up.

mod general;
mod lattice;
mod numbers;
#[cfg(test)]
mod tests;

use super::shares::Shares;
use crate::network::Network;
use crate::walk::Isa;
use general::GeneralFlow;
use lattice::LatticeFlow;
pub use numbers::{Counted, Expected, ExpectedSums};

/// The machinery that moves expectations; rebuilt from network and expectation, and never stored.
pub(super) struct ExpectedFlow {
    by_network: ByNetwork,
    /// Voids that retain something, ascending.
    holding: Vec<u32>,
    /// Sum that they retain.
    rests: f64,
}

enum ByNetwork {
    General(GeneralFlow),
    Lattice(LatticeFlow),
}

impl ExpectedFlow {
    pub fn new(network: &Network, shares: &Shares, expected: &Expected) -> Self {
        let holding = expected.retained.iter().enumerate().filter(|(_, n)| **n > 0.0);
        let holding: Vec<u32> = holding.map(|(void, _)| void as u32).collect();
        Self {
            by_network: match network.shape().filter(|_| !network.exit_rule().needs_flow()) {
                Some(shape) => ByNetwork::Lattice(LatticeFlow::new(shape, shares)),
                None => ByNetwork::General(GeneralFlow::new(shares, expected.moving.len())),
            },
            rests: resting(&holding, expected),
            holding,
        }
    }

    /// Uses the instructions of `isa`, to the same bits.
    pub fn set_isa(&mut self, isa: Isa) {
        if let ByNetwork::Lattice(flow) = &mut self.by_network {
            flow.isa = isa;
        }
    }

    /// Voids that retain something, ascending.
    pub fn holding(&self) -> &[u32] {
        &self.holding
    }

    /// Sum that these voids retain.
    pub fn rests(&self) -> f64 {
        self.rests
    }

    /// Renews the shares of one void.
    pub fn set(&mut self, network: &Network, shares: &Shares, void: u32) {
        match &mut self.by_network {
            ByNetwork::General(flow) => flow.set(network, shares, void),
            ByNetwork::Lattice(flow) => flow.set(shares, void),
        }
    }

    /// Every particle attempts one move.
    pub fn step(&mut self, network: &Network, shares: &Shares, expected: &mut Expected) {
        let (known, eroded) = (self.holding.len(), expected.sums.eroded);
        match &mut self.by_network {
            ByNetwork::General(flow) => flow.step(network, shares, expected, &mut self.holding),
            ByNetwork::Lattice(flow) => flow.step(expected, &mut self.holding),
        }
        if self.holding.len() > known {
            // Two runs, each rising: the voids known before, and the new ones.
            self.holding.sort();
        }
        self.rests = resting(&self.holding, expected);
        if matches!(self.by_network, ByNetwork::Lattice(_)) {
            // All that was inserted and had neither left nor come to rest.
            expected.sums.moves += (expected.sums.inserted as f64 - eroded - self.rests).max(0.0);
        }
    }
}

/// Sum that these voids retain.
fn resting(holding: &[u32], expected: &Expected) -> f64 {
    holding.iter().map(|&void| expected.retained[void as usize]).sum()
}
