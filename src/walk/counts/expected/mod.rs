//! The expectation of the passive particles given the history of blocking: one f64 a void, no draw.
//!
//! Sums run in an order that hangs on nothing but the network, on one thread, so they are the same everywhere.
//! Whole numbers for the tally are rounded from running sums, so that they add up.

mod general;
mod lattice;
#[cfg(test)]
mod tests;

use super::shares::Shares;
use crate::network::Network;
use crate::walk::Isa;
use general::GeneralFlow;
use lattice::LatticeFlow;

/// Below this many particles a void counts as empty.
const NOTHING: f64 = 1e-30;

const TWO_TO_MINUS_64: f64 = 1.0 / 18_446_744_073_709_551_616.0;

/// Expected numbers of passive particles.
#[derive(Clone, Debug, PartialEq)]
pub struct Expected {
    /// Moving, by void.
    pub moving: Vec<f64>,
    /// Retained for want of an open exit, by void.
    pub retained: Vec<f64>,
    /// By void: whole number retained that the state already counts.
    pub counted_retained: Vec<u64>,
    /// Sums over the voids.
    pub sums: ExpectedSums,
}

/// Sums over the voids of what is expected of the passive particles, over the run so far.
#[derive(Clone, Copy, Debug, Default, PartialEq, serde::Serialize, serde::Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ExpectedSums {
    /// Eroded.
    pub eroded: f64,
    /// Completed moves.
    pub moves: f64,
    /// Inserted.
    pub inserted: u64,
    /// The whole numbers that the state already counts.
    pub counted: Counted,
}

/// Whole numbers of passive particles over the run so far.
#[derive(Clone, Copy, Debug, Default, PartialEq, serde::Serialize, serde::Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Counted {
    /// Completed moves.
    pub moves: u64,
    /// Eroded.
    pub eroded: u64,
    /// Eroded or retained.
    pub at_rest: u64,
}

impl Expected {
    pub(super) fn new(voids: usize) -> Self {
        Self {
            moving: vec![0.0; voids],
            retained: vec![0.0; voids],
            counted_retained: vec![0; voids],
            sums: ExpectedSums::default(),
        }
    }

    /// Puts `count` particles on the start nodes, the same number on each.
    pub(super) fn insert(&mut self, network: &Network, count: u64) {
        self.sums.inserted += count;
        let each = count as f64 / network.start().len() as f64;
        network.start().iter().for_each(|&void| self.moving[void as usize] += each);
    }

    /// Renews the whole numbers that the state counts, and gives those before and after. `holding` are the
    /// voids that retain something, ascending. With `trapped`, what moves beside so many trapped particles is
    /// less than half a particle, and is counted as come to rest.
    pub(super) fn count(
        &mut self,
        holding: &[u32],
        trapped: Option<f64>,
        retained_in_voids: &mut [u64],
    ) -> [Counted; 2] {
        let stranded: f64 = holding.iter().map(|&void| self.retained[void as usize]).sum();
        let whole = |x: f64| ((x + 0.5).floor() as u64).min(self.sums.inserted);
        let mut at_rest = whole(self.sums.eroded + stranded);
        let mut eroded = whole(self.sums.eroded);
        if let Some(trapped) = trapped {
            at_rest = self.sums.inserted - whole(trapped);
            eroded = if stranded == 0.0 { at_rest } else { eroded.min(at_rest) };
        }
        let (mut sum, mut last) = (self.sums.eroded, eroded);
        if stranded > 0.0 {
            for void in holding.iter().map(|&void| void as usize) {
                sum += self.retained[void];
                let upto = whole(sum).clamp(last, at_rest);
                retained_in_voids[void] =
                    retained_in_voids[void] - self.counted_retained[void] + (upto - last);
                self.counted_retained[void] = upto - last;
                last = upto;
            }
            // What rounding left over, to the last void that retains something.
            if let Some(&void) = holding.last() {
                retained_in_voids[void as usize] += at_rest - last;
                self.counted_retained[void as usize] += at_rest - last;
            }
        }
        let moves = (self.sums.moves + 0.5).floor() as u64;
        let counted = Counted { moves, eroded, at_rest };
        [std::mem::replace(&mut self.sums.counted, counted), counted]
    }
}

/// The machinery that moves expectations; rebuilt from network and expectation, and never stored.
pub(super) struct ExpectedFlow {
    by_network: ByNetwork,
    /// By void: what is expected there after the step.
    next: Vec<f64>,
    /// Voids that retain something, ascending.
    holding: Vec<u32>,
}

enum ByNetwork {
    General(GeneralFlow),
    Lattice(LatticeFlow),
}

impl ExpectedFlow {
    pub fn new(network: &Network, shares: &Shares, expected: &Expected) -> Self {
        let holding = expected.retained.iter().enumerate().filter(|(_, n)| **n > 0.0);
        Self {
            by_network: match network.shape().filter(|_| !network.exit_rule().needs_flow()) {
                Some(shape) => ByNetwork::Lattice(LatticeFlow::new(shape, shares)),
                None => ByNetwork::General(GeneralFlow::new(shares)),
            },
            next: vec![0.0; expected.moving.len()],
            holding: holding.map(|(void, _)| void as u32).collect(),
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

    /// The shares of one void are others now.
    pub fn set(&mut self, network: &Network, shares: &Shares, void: u32) {
        match &mut self.by_network {
            ByNetwork::General(flow) => flow.set(network, shares, void),
            ByNetwork::Lattice(flow) => flow.set(shares, void),
        }
    }

    /// Every particle attempts one move.
    pub fn step(&mut self, network: &Network, shares: &Shares, expected: &mut Expected) {
        let known = self.holding.len();
        let into = (&mut self.next[..], &mut self.holding);
        match &mut self.by_network {
            ByNetwork::General(flow) => flow.step(network, shares, expected, into),
            ByNetwork::Lattice(flow) => flow.step(expected, into),
        }
        if self.holding.len() > known {
            self.holding.sort_unstable();
        }
        std::mem::swap(&mut expected.moving, &mut self.next);
    }
}

/// `n` more come to rest in a void, which is added to `holding` where they are the first.
fn retain(void: usize, n: f64, retained: &mut [f64], holding: &mut Vec<u32>) {
    if retained[void] == 0.0 {
        holding.push(void as u32);
    }
    retained[void] += n;
}

/// A share of 2^64 as a number: of an exit that is certain, 1.
fn share(probability: u64) -> f64 {
    probability as f64 * TWO_TO_MINUS_64
}
