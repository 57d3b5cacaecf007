//! What the first particle does on a given network: an exact answer, by a linear solve.
//!
//! A particle of diameter `d` that alone enters a network picks one of the open exits of its void with a
//! probability proportional to area, `p_e = A_e / sum A`. It is stopped where that exit is finer than it, and
//! in a void without open exits. With `t(e)` the void that exit `e` leads to,
//!
//! ```text
//! leaves(v) = sum over exits e that it fits of p_e (1 if e leads out, else leaves(t(e)))
//! moves(v)  = sum over exits e that it fits of p_e (1 + (0 if e leads out, else moves(t(e))))
//! ```
//!
//! The smallest solution of the first is the probability to leave; the second is the mean number of completed
//! moves, infinite where the particle may be trapped in closed loops. Gauss-Seidel sweeps, downstream voids
//! first: on a lattice that is periodic sideways only the rows of a layer wait for each other, so some tens
//! of sweeps do.

use super::{END, Network};

/// Sweeps end when nothing changes by more than this part of itself.
const CONVERGED: f64 = 1e-15;

/// What a single particle can expect, by the void that it starts in.
#[derive(Clone, Debug, PartialEq)]
pub struct FirstPassage {
    /// Probability to leave the filter.
    pub leaves: Vec<f64>,
    /// Mean number of completed moves, the one that leaves included.
    pub moves: Vec<f64>,
}

impl FirstPassage {
    /// Mean of both over the start nodes of the network: a particle starts on each with the same probability.
    pub fn from_start(&self, network: &Network) -> (f64, f64) {
        let mean = |of: &[f64]| {
            let sum: f64 = network.start().iter().map(|&void| of[void as usize]).sum();
            sum / network.start().len() as f64
        };
        (mean(&self.leaves), mean(&self.moves))
    }
}

impl Network {
    /// What a single particle of diameter `d` (in units of [`Network::unit_mm`]) can expect while `closed`
    /// constrictions, and those of size 0, are closed.
    ///
    /// ```
    /// use voidwalk::network::Network;
    /// // One void: it leaves through z by the share of area, or is stopped by the finer x; y leads back.
    /// let network = Network::cubic_from_diameters([1, 1, 1], vec![1.0, 2.0, 2.0], 1.0)?;
    /// let passage = network.first_passage(1.5, |_| false);
    /// assert!((passage.leaves[0] - 0.8).abs() < 1e-12);
    /// // x is closed: nothing stops it, and it leaves after two moves on average.
    /// let passage = network.first_passage(1.5, |c| c == 0);
    /// assert!((passage.leaves[0] - 1.0).abs() < 1e-12 && (passage.moves[0] - 2.0).abs() < 1e-12);
    /// # Ok::<(), voidwalk::network::NetworkError>(())
    /// ```
    pub fn first_passage(&self, d: f32, closed: impl Fn(usize) -> bool) -> FirstPassage {
        let weight = |c: usize| if closed(c) { 0.0 } else { self.exit_weight(c) };
        let mut share = vec![0.0; self.constrictions()];
        let mut ends = vec![false; self.voids()];
        for void in 0..self.voids() as u32 {
            let total: f64 = self.exits(void).map(weight).sum();
            for c in self.exits(void).filter(|&c| weight(c) > 0.0) {
                if self.diameter[c] >= d {
                    share[c] = weight(c) / total;
                }
                // It may leave or be stopped here.
                ends[void as usize] |= self.diameter[c] < d || self.target[c] == END;
            }
            ends[void as usize] |= total == 0.0;
        }
        let circles = self.spread(&share, ends.clone()).into_iter().map(|ends| !ends).collect();
        let unending = self.spread(&share, circles);
        let leaves = self.relax(&share, &vec![false; self.voids()], |out| f64::from(u8::from(out)));
        let moves = self.relax(&share, &unending, |_| 1.0);
        FirstPassage { leaves, moves }
    }

    /// Voids from which one of `marked` can be reached through exits with a share.
    fn spread(&self, share: &[f64], mut marked: Vec<bool>) -> Vec<bool> {
        loop {
            let mut changed = false;
            for void in (0..self.voids()).rev() {
                let leads =
                    |c: usize| share[c] > 0.0 && self.target[c] != END && marked[self.target[c] as usize];
                if !marked[void] && self.exits(void as u32).any(leads) {
                    (marked[void], changed) = (true, true);
                }
            }
            if !changed {
                return marked;
            }
        }
    }

    /// The smallest solution of `x(v) = sum share_e (gain(e leads out) + x(t(e)))`; infinite where
    /// `unending`.
    fn relax(&self, share: &[f64], unending: &[bool], gain: impl Fn(bool) -> f64) -> Vec<f64> {
        let mut x: Vec<f64> = unending.iter().map(|&u| if u { f64::INFINITY } else { 0.0 }).collect();
        loop {
            let mut change = 0f64;
            for void in (0..self.voids()).rev().filter(|&void| !unending[void]) {
                let one = |c: usize| match self.target[c] {
                    _ if share[c] == 0.0 => 0.0,
                    END => share[c] * gain(true),
                    to => share[c] * (gain(false) + x[to as usize]),
                };
                let new: f64 = self.exits(void as u32).map(one).sum();
                if new > 0.0 {
                    change = change.max((new - x[void]).abs() / new);
                }
                x[void] = new;
            }
            if change <= CONVERGED {
                return x;
            }
        }
    }

    /// The network on which a particle that fits everywhere fares as a single particle of diameter `d` does
    /// on this one: constrictions finer than `d` lead into one more void, which has no exit. Particles there
    /// cannot block anything, so each of any number of them is a first particle.
    pub fn as_first_particle_of(&self, d: f32) -> Network {
        let stop = self.voids() as u32;
        let end = self.exit_begin[self.voids()];
        let finer = |c: usize| self.diameter[c] < d && self.diameter[c] > 0.0;
        let target =
            (0..self.constrictions()).map(|c| if finer(c) { stop } else { self.target[c] }).collect();
        let last = self.layer.iter().filter(|&&layer| layer != super::NO_LAYER).max();
        Network {
            exit_begin: self.exit_begin.iter().copied().chain([end]).collect(),
            target,
            layer: self.layer.iter().copied().chain([last.map_or(0, |l| l + 1)]).collect(),
            shape: None,
            ..self.clone()
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// With equal constrictions a third of the moves leads downstream, on a lattice of any width: 3 nz moves.
    #[test]
    fn equal_constrictions_take_three_moves_a_layer() {
        let network = Network::cubic_from_diameters([3, 2, 7], vec![0.5; 126], 1.0).unwrap();
        let (leaves, moves) = network.first_passage(0.5, |_| false).from_start(&network);
        assert!((leaves - 1.0).abs() < 1e-12 && (moves - 21.0).abs() < 1e-9, "{leaves} {moves}");
        assert_eq!(network.first_passage(0.6, |_| false).leaves, vec![0.0; 42]);
    }

    /// x and y lead round, z is closed: it never leaves, and never stops moving.
    #[test]
    fn a_particle_that_circles_never_leaves() {
        let network = Network::cubic_from_diameters([2, 2, 2], vec![1.0; 24], 1.0).unwrap();
        let passage = network.first_passage(0.5, |c| c % 3 == 2 && c >= 12);
        assert_eq!(
            (passage.leaves[0], passage.moves[0], passage.moves[4]),
            (0.0, f64::INFINITY, f64::INFINITY)
        );
        // Where everything is closed it moves no more.
        let stuck = network.first_passage(0.5, |_| true);
        assert_eq!((stuck.leaves[0], stuck.moves[0]), (0.0, 0.0));
    }

    /// The probability to leave of a stopped particle is that of one that fits everywhere on the network made
    /// for it.
    #[test]
    fn the_network_of_a_first_particle_has_its_answer() {
        let diameters: Vec<f32> = (0..3 * 3 * 4 * 5).map(|i| 0.2 + 0.01 * (i * 37 % 61) as f32).collect();
        let network = Network::cubic_from_diameters([3, 4, 5], diameters, 1.0).unwrap();
        let direct = network.first_passage(0.3, |_| false);
        let made = network.as_first_particle_of(0.3);
        let passage = made.first_passage(0.0, |_| false);
        assert!(direct.leaves[0] > 0.0 && direct.leaves[0] < 0.9);
        for void in 0..network.voids() {
            assert!((direct.leaves[void] - passage.leaves[void]).abs() < 1e-12);
        }
        assert_eq!((made.voids(), made.exits(60).len(), made.layers()), (61, 0, 6));
    }
}
