//! The expectation of the passive particles given the history of blocking: one f64 a void, no draw.
//!
//! Sums run over the voids in order, on one thread, so they are the same everywhere. Whole numbers for the
//! tally are rounded from running sums, so that they add up.

use super::binomial::CERTAIN;
use super::shares::Shares;
use crate::network::{END, Network};

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

    /// Every particle attempts one move.
    pub(super) fn step(&mut self, network: &Network, shares: &Shares, next: &mut [f64]) {
        for void in 0..self.moving.len() {
            let mut n = std::mem::take(&mut self.moving[void]);
            if n < NOTHING {
                continue;
            }
            if !shares.leads_on(void) {
                match shares.waits(void) {
                    true => next[void] += n,
                    false => self.retained[void] += n,
                }
                continue;
            }
            self.sums.moves += n;
            for exit in network.exits(void as u32) {
                let probability = shares.probability()[exit];
                let taken =
                    if probability == CERTAIN { n } else { n * (probability as f64 * TWO_TO_MINUS_64) };
                n -= taken;
                match network.targets()[exit] {
                    END => self.sums.eroded += taken,
                    target => next[target as usize] += taken,
                }
                if probability == CERTAIN {
                    break;
                }
            }
        }
        self.moving.swap_with_slice(next);
    }

    /// Renews the whole numbers that the state counts, and gives those before and after. With `trapped`, what
    /// moves beside so many trapped particles is less than half a particle, and is counted as come to rest.
    pub(super) fn count(&mut self, trapped: Option<f64>, retained_in_voids: &mut [u64]) -> [Counted; 2] {
        let stranded: f64 = self.retained.iter().sum();
        let whole = |x: f64| ((x + 0.5).floor() as u64).min(self.sums.inserted);
        let mut at_rest = whole(self.sums.eroded + stranded);
        let mut eroded = whole(self.sums.eroded);
        if let Some(trapped) = trapped {
            at_rest = self.sums.inserted - whole(trapped);
            eroded = if stranded == 0.0 { at_rest } else { eroded.min(at_rest) };
        }
        let (mut sum, mut last) = (self.sums.eroded, eroded);
        if stranded > 0.0 {
            for (void, n) in self.retained.iter().enumerate().filter(|(_, n)| **n > 0.0) {
                sum += n;
                let upto = whole(sum).clamp(last, at_rest);
                retained_in_voids[void] =
                    retained_in_voids[void] - self.counted_retained[void] + (upto - last);
                self.counted_retained[void] = upto - last;
                last = upto;
            }
            // What rounding left over, to the last void that retains something.
            if let Some(void) = self.retained.iter().rposition(|&n| n > 0.0) {
                retained_in_voids[void] += at_rest - last;
                self.counted_retained[void] += at_rest - last;
            }
        }
        let moves = (self.sums.moves + 0.5).floor() as u64;
        let counted = Counted { moves, eroded, at_rest };
        [std::mem::replace(&mut self.sums.counted, counted), counted]
    }
}
