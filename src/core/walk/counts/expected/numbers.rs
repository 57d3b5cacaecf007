//! The expected numbers of passive particles, and the whole numbers that the tally has of them.

use crate::network::Network;

/// Below this many particles a void counts as empty.
pub(super) const NOTHING: f64 = 1e-30;

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

/// Sums over the voids of the expected passive particles, over the run so far.
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
    pub(in crate::walk::counts) fn new(voids: usize) -> Self {
        Self {
            moving: vec![0.0; voids],
            retained: vec![0.0; voids],
            counted_retained: vec![0; voids],
            sums: ExpectedSums::default(),
        }
    }

    /// Puts `count` particles on the start nodes, the same number on each.
    pub(in crate::walk::counts) fn insert(&mut self, network: &Network, count: u64) {
        self.sums.inserted += count;
        let part = count as f64 / network.start().len() as f64;
        network.start().iter().for_each(|&void| self.moving[void as usize] += part);
    }

    /// Tells if more than a whole particle is expected to move in voids that lead out: seen from the last
    /// voids on, where the last particles are, so that few voids have to be looked at.
    pub(in crate::walk::counts) fn surely_moves(&self, leads_out: &[bool]) -> bool {
        let free = self.moving.iter().zip(leads_out).rev().filter(|(_, leads_out)| **leads_out);
        let mut sum = 0.0;
        free.map(|(n, _)| n).any(|n| {
            sum += n;
            sum > 1.0
        })
    }

    /// Renews the whole numbers that the state counts, and returns those before and after. `holding` are the
    /// voids that retain something, ascending, with their sum. With `trapped`, the particles that move beside
    /// this many trapped ones are less than half a particle, and are counted at rest.
    pub(in crate::walk::counts) fn count(
        &mut self,
        (holding, stranded): (&[u32], f64),
        trapped: Option<f64>,
        retained_in_voids: &mut [u64],
    ) -> [Counted; 2] {
        // No sum is negative, and `floor` is a call where the machine may lack an instruction for it.
        let whole = |x: f64| ((x + 0.5) as u64).min(self.sums.inserted);
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
                let (before, now) = (self.counted_retained[void], upto - last);
                if now != before {
                    retained_in_voids[void] = retained_in_voids[void] - before + now;
                    self.counted_retained[void] = now;
                }
                last = upto;
            }
            // The remainder of rounding goes to the last void that retains something.
            if let Some(&void) = holding.last() {
                retained_in_voids[void as usize] += at_rest - last;
                self.counted_retained[void as usize] += at_rest - last;
            }
        }
        let moves = (self.sums.moves + 0.5) as u64;
        let counted = Counted { moves, eroded, at_rest };
        [std::mem::replace(&mut self.sums.counted, counted), counted]
    }
}

/// Adds `n` particles at rest in a void, which is added to `holding` if they are the first.
pub(super) fn retain(void: usize, n: f64, retained: &mut [f64], holding: &mut Vec<u32>) {
    if retained[void] == 0.0 {
        holding.push(void as u32);
    }
    retained[void] += n;
}
