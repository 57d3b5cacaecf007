//! The expectation of the passive particles given the history of blocking: one f64 a void, no draw.
//!
//! Sums run over the voids in order, on one thread, so they are the same everywhere. Whole numbers for the
//! book-keeping are rounded from running sums, so that they add up.

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
    /// Eroded.
    pub eroded: f64,
    /// Completed moves.
    pub moves: f64,
    /// Inserted, so far.
    inserted: u64,
    /// Whole numbers that the state already holds: completed moves, eroded, eroded or retained.
    booked: [u64; 3],
    /// By void: whole number retained that the state already holds.
    booked_retained: Vec<u64>,
}

impl Expected {
    pub(super) fn new(voids: usize) -> Self {
        Self {
            moving: vec![0.0; voids],
            retained: vec![0.0; voids],
            eroded: 0.0,
            moves: 0.0,
            inserted: 0,
            booked: [0; 3],
            booked_retained: vec![0; voids],
        }
    }

    /// All of it as words.
    pub(super) fn words(&self) -> Vec<u64> {
        let sums = [self.eroded.to_bits(), self.moves.to_bits(), self.inserted];
        let reals = self.moving.iter().chain(&self.retained).map(|v| v.to_bits());
        sums.into_iter().chain(self.booked).chain(reals).chain(self.booked_retained.iter().copied()).collect()
    }

    /// The same from its words, on a network of `voids` voids; `None` where they cannot be that.
    pub(in crate::walk) fn from_words(voids: usize, words: &[u64]) -> Option<Self> {
        if words.len() != 6 + 3 * voids {
            return None;
        }
        let real = |words: &[u64]| words.iter().map(|&w| f64::from_bits(w)).collect::<Vec<f64>>();
        let (moving, rest) = words[6..].split_at(voids);
        let (retained, booked_retained) = rest.split_at(voids);
        Some(Self {
            moving: real(moving),
            retained: real(retained),
            eroded: f64::from_bits(words[0]),
            moves: f64::from_bits(words[1]),
            inserted: words[2],
            booked: [words[3], words[4], words[5]],
            booked_retained: booked_retained.to_vec(),
        })
    }

    /// Puts `count` particles on the start nodes, the same number on each.
    pub(super) fn insert(&mut self, network: &Network, count: u64) {
        self.inserted += count;
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
                self.retained[void] += n;
                continue;
            }
            self.moves += n;
            for exit in network.exits(void as u32) {
                let chance = shares.chance()[exit];
                let taken = if chance == CERTAIN { n } else { n * (chance as f64 * TWO_TO_MINUS_64) };
                n -= taken;
                match network.targets()[exit] {
                    END => self.eroded += taken,
                    target => next[target as usize] += taken,
                }
                if chance == CERTAIN {
                    break;
                }
            }
        }
        self.moving.swap_with_slice(next);
    }

    /// The whole numbers by which the state's have to change: with `settled`, what still moves is less than half a
    /// particle beside `trapped` ones, and is booked as come to rest.
    pub(super) fn book(&mut self, settled: Option<f64>, retained_in_voids: &mut [u64]) -> Booked {
        let stranded: f64 = self.retained.iter().sum();
        let whole = |x: f64| ((x + 0.5).floor() as u64).min(self.inserted);
        let mut at_rest = whole(self.eroded + stranded);
        let mut eroded = whole(self.eroded);
        if let Some(trapped) = settled {
            at_rest = self.inserted - whole(trapped);
            eroded = if stranded == 0.0 { at_rest } else { eroded.min(at_rest) };
        }
        let (mut sum, mut last) = (self.eroded, eroded);
        if stranded > 0.0 {
            for (void, n) in self.retained.iter().enumerate().filter(|(_, n)| **n > 0.0) {
                sum += n;
                let upto = whole(sum).clamp(last, at_rest);
                retained_in_voids[void] =
                    retained_in_voids[void] + (upto - last) - self.booked_retained[void];
                self.booked_retained[void] = upto - last;
                last = upto;
            }
            // What rounding left over, to the last void that retains something.
            if let Some(void) = self.retained.iter().rposition(|&n| n > 0.0) {
                retained_in_voids[void] += at_rest - last;
                self.booked_retained[void] += at_rest - last;
            }
        }
        let moves = (self.moves + 0.5).floor() as u64;
        let before = std::mem::replace(&mut self.booked, [moves, eroded, at_rest]);
        Booked { before, after: self.booked }
    }
}

/// Whole numbers over the run so far, before and after an increment.
pub(super) struct Booked {
    /// Completed moves, eroded, eroded or retained.
    pub before: [u64; 3],
    /// The same.
    pub after: [u64; 3],
}
