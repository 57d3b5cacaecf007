//! Depth reached by a single particle, unaffected by its own blocking. In each void it picks an open exit
//! with a probability proportional to area, and is stopped if that exit is finer than the particle.
//!
//! On a clean cubic lattice with independent constrictions (Eq. (1) of the paper, [`Passage`])
//!
//! ```text
//! q = E[ area of exits finer than d / area of all three ]     stopped in this attempt
//! s = (1 - q) / (1 + 2 q)                                   P(F): moves one layer downstream
//! n = ln(1 - confidence) / ln(s)                            Eq. (1): layers that it does not pass
//! ```
//!
//! s follows from q: a third of the successful moves lead downstream. Eq. (1) of the paper refers to
//! Schuler's network, whose voids have five exits. It assumes that a void is never visited twice, as on
//! lattices too wide for a particle to go round.
//!
//! On a given network ([`FirstPassage`]), with `t(e)` the void that exit `e` leads to and `p_e` the
//! fraction of its weight,
//!
//! ```text
//! leaves(v) = sum over exits e that it fits of p_e (1 if e leads out, else leaves(t(e)))
//! moves(v)  = sum over exits e that it fits of p_e (1 + (0 if e leads out, else moves(t(e))))
//! ```
//!
//! The smallest solution of the first is the probability of leaving; the second is infinite if the particle
//! may be trapped in closed loops. Both are solved by Gauss-Seidel sweeps, downstream voids first.

use super::{END, Network, NetworkError};
use crate::constrictions::Curve;

/// Number of parts of the curve for the first of three exits.
const PARTS: usize = 512;

/// Number of parts of the curve for the other two exits.
const OTHERS: usize = 64;

/// Probability that a particle passes a layer of the cubic lattice with this curve, by particle size.
///
/// ```
/// use voidwalk_core::constrictions::{Curve, CurveUnit};
/// use voidwalk_core::network::Passage;
/// // Half of the constrictions of size 1, half of size 2; a particle in between.
/// let curve = Curve::from_points(&[(0.0, 1.0), (50.0, 1.0), (50.0, 2.0), (100.0, 2.0)], CurveUnit::D0f)?;
/// let q = (1.0 + 3.0 * 2.0 / 6.0 + 3.0 * 1.0 / 9.0) / 8.0;
/// let passage = Passage::new(&curve);
/// assert!((passage.stopped(1.5) - q).abs() < 1e-12);
/// assert!((passage.downstream(1.5) - (1.0 - q) / (1.0 + 2.0 * q)).abs() < 1e-12);
/// # Ok::<(), voidwalk_core::constrictions::CurveError>(())
/// ```
#[derive(Clone, Debug)]
pub struct Passage<'a> {
    curve: &'a Curve,
    /// Three times the integral, over the finest i / PARTS of the curve, of the fraction of area of such
    /// an exit.
    stopped: Vec<f64>,
}

impl<'a> Passage<'a> {
    /// Integrates over three independent exits drawn from the curve, each at the midpoints of equal parts.
    pub fn new(curve: &'a Curve) -> Self {
        let area = |part: usize, parts: usize| {
            let diameter = curve.quantile((part as f64 + 0.5) / parts as f64);
            diameter * diameter
        };
        let others: Vec<f64> = (0..OTHERS).map(|part| area(part, OTHERS)).collect();
        let pairs: Vec<f64> = others.iter().flat_map(|a| others.iter().map(move |b| a + b)).collect();
        let mut stopped = vec![0.0];
        let mut sum = 0.0;
        for part in 0..PARTS {
            let first = area(part, PARTS);
            let share = pairs.iter().map(|pair| first / (first + pair)).sum::<f64>() / pairs.len() as f64;
            sum += 3.0 * share / PARTS as f64;
            stopped.push(sum);
        }
        // The three fractions sum to 1; errors of rounding and of the coarser parts are scaled away.
        stopped.iter_mut().for_each(|s| *s /= sum);
        Self { curve, stopped }
    }

    /// Probability q that a particle of diameter `d`, in the curve's unit, is stopped in an attempt.
    pub fn stopped(&self, d: f64) -> f64 {
        // A particle passes a constriction of equal size.
        let finer = self.curve.percent_smaller(d * (1.0 - 1e-12)) / 100.0 * PARTS as f64;
        let part = (finer as usize).min(PARTS - 1);
        let (low, high) = (self.stopped[part], self.stopped[part + 1]);
        (low + (finer - part as f64) * (high - low)).clamp(0.0, 1.0)
    }

    /// Probability s, or P(F), that the particle moves one layer downstream.
    pub fn downstream(&self, d: f64) -> f64 {
        let q = self.stopped(d);
        (1.0 - q) / (1.0 + 2.0 * q)
    }

    /// Number of layers that the particle does not pass with this confidence (0 to 1), by Eq. (1); `None`
    /// if nothing can stop it.
    pub fn layers(&self, d: f64, confidence: f64) -> Option<f64> {
        let s = self.downstream(d);
        (s < 1.0).then(|| if s > 0.0 { libm::log(1.0 - confidence) / libm::log(s) } else { 0.0 })
    }

    /// Probability that the particle leaves a lattice of this many layers: `s ^ layers`.
    pub fn through(&self, d: f64, layers: u64) -> f64 {
        libm::pow(self.downstream(d), layers as f64)
    }

    /// Diameter at which [`Passage::layers`] equals `layers` at this confidence; coarser particles do not
    /// get as far.
    pub fn coarsest_through(&self, layers: u64, confidence: f64) -> f64 {
        let (mut low, mut high) = (self.curve.smallest(), self.curve.largest());
        for _ in 0..100 {
            let middle = 0.5 * (low + high);
            if self.through(middle, layers) >= 1.0 - confidence { low = middle } else { high = middle }
        }
        low
    }
}

/// Relative change below which sweeps stop.
const CONVERGED: f64 = 1e-15;

/// Maximum number of constriction visits (seconds). A loop that is left once in `n` moves takes about `30
/// n` sweeps.
const MOST_LOOKS: usize = 1 << 30;

/// Minimum number of sweeps before giving up, on the largest network.
const LEAST_SWEEPS: usize = 1 << 12;

/// Expectations for a single particle, by starting void.
#[derive(Clone, Debug, PartialEq)]
pub struct FirstPassage {
    /// Probability of leaving the filter.
    pub leaves: Vec<f64>,
    /// Mean number of completed moves, including the one that leaves.
    pub moves: Vec<f64>,
}

impl FirstPassage {
    /// Mean of both over the start nodes, each being equally probable.
    pub fn at_start(&self, network: &Network) -> (f64, f64) {
        let mean = |values: &[f64]| {
            let sum: f64 = network.start().iter().map(|&void| values[void as usize]).sum();
            sum / network.start().len() as f64
        };
        (mean(&self.leaves), mean(&self.moves))
    }
}

impl Network {
    /// Expectations for a single particle of diameter `d` (in units of [`Network::unit_mm`]), with
    /// `closed` constrictions and those of size 0 closed.
    ///
    /// ```
    /// use voidwalk_core::network::Network;
    /// // One void: the particle leaves through z, or is stopped by the finer x; y leads back.
    /// let network = Network::cubic_from_diameters([1, 1, 1], vec![1.0, 2.0, 2.0], 1.0)?;
    /// let passage = network.first_passage(1.5, |_| false)?;
    /// assert!((passage.leaves[0] - 0.8).abs() < 1e-12);
    /// // x is closed: nothing stops the particle, and it leaves after two moves on average.
    /// let passage = network.first_passage(1.5, |c| c == 0)?;
    /// assert!((passage.leaves[0] - 1.0).abs() < 1e-12 && (passage.moves[0] - 2.0).abs() < 1e-12);
    /// # Ok::<(), voidwalk_core::network::NetworkError>(())
    /// ```
    ///
    /// # Errors
    /// Loops with so narrow a way out that the solution would take too long.
    pub fn first_passage(
        &self,
        d: f32,
        closed: impl Fn(usize) -> bool,
    ) -> Result<FirstPassage, NetworkError> {
        let weight = |c: usize| if closed(c) { 0.0 } else { self.exit_weight(c) };
        let (share, mut ends) = self.shares(weight, d);
        self.upstream_of(&share, &mut ends);
        // Voids in closed loops, and all voids that may lead there.
        let mut unending: Vec<bool> = ends.iter().map(|ends| !ends).collect();
        self.upstream_of(&share, &mut unending);
        let most = (MOST_LOOKS / self.constrictions().max(1)).max(LEAST_SWEEPS);
        let leaves = self.relax(&share, &vec![false; self.voids()], [1.0, 0.0], most)?;
        let moves = self.relax(&share, &unending, [1.0; 2], most)?;
        Ok(FirstPassage { leaves, moves })
    }

    /// Fraction of the weight of its void for each exit that a particle of this size fits; and by void,
    /// true if such a particle may leave or be stopped there.
    fn shares(&self, weight: impl Fn(usize) -> f64, d: f32) -> (Vec<f64>, Vec<bool>) {
        let mut share = vec![0.0; self.constrictions()];
        let mut ends = vec![false; self.voids()];
        for void in 0..self.voids() as u32 {
            let total: f64 = self.exits(void).map(&weight).sum();
            for c in self.exits(void).filter(|&c| weight(c) > 0.0) {
                if self.diameter[c] >= d {
                    share[c] = weight(c) / total;
                }
                ends[void as usize] |= self.diameter[c] < d || self.target[c] == END;
            }
            ends[void as usize] |= total == 0.0;
        }
        (share, ends)
    }

    /// Marks the voids from which a marked one can be reached through exits with a positive share. Returns
    /// all marked voids, each after the next void on its shortest path.
    fn upstream_of(&self, share: &[f64], marked: &mut [bool]) -> Vec<u32> {
        let (begin, entrances) = self.entrances();
        let upstream = self.upstream();
        let mut marked_voids: Vec<u32> =
            (0..self.voids() as u32).filter(|&void| marked[void as usize]).collect();
        let mut next = 0;
        while let Some(&void) = marked_voids.get(next) {
            next += 1;
            for &entrance in &entrances[begin[void as usize] as usize..begin[void as usize + 1] as usize] {
                let above = upstream[entrance as usize];
                if share[entrance as usize] > 0.0 && !marked[above as usize] {
                    marked[above as usize] = true;
                    marked_voids.push(above);
                }
            }
        }
        marked_voids
    }

    /// Approximate number of moves of a particle that fits everywhere, until it leaves, reaches a void
    /// without an open exit, or is trapped in closed loops; infinite if it overflows. Visits about `most`
    /// constrictions, then extrapolates from the changes.
    pub fn moves_to_an_end(&self, most: u64) -> f64 {
        let area = |c: usize| f64::from(self.diameter[c]) * f64::from(self.diameter[c]);
        let (share, mut ends) = self.shares(area, 0.0);
        let order = self.upstream_of(&share, &mut ends);
        let mut moves = vec![0.0; self.voids()];
        // Means after each round; once the increments have a constant ratio, the rest of the sum is known.
        let mut means = vec![0.0];
        // Results take a few rounds to spread from layer to layer.
        let least = 4 * self.layers() + 100;
        let most = usize::try_from(most / self.constrictions().max(1) as u64).unwrap_or(usize::MAX);
        let most = most.min(1 << 20).max(least);
        loop {
            for &void in &order {
                moves[void as usize] = self.mean_over_exits(void, &share, [1.0; 2], &moves);
            }
            let sum: f64 = self.start.iter().map(|&void| moves[void as usize]).sum();
            means.push(sum / self.start.len() as f64);
            let (last, half) = (means.len() - 1, means.len() / 2);
            let grown = means[last] - means[last - 1];
            if grown <= 1e-9 * means[last] {
                return means[last];
            }
            if last == most {
                let before = means[half] - means[half - 1];
                let part = libm::pow(grown / before, 1.0 / (last - half) as f64);
                return if part < 1.0 { means[last] + grown * part / (1.0 - part) } else { f64::INFINITY };
            }
        }
    }

    /// Sum over the exits of a void of `share_e (gain + x(t(e)))`, with one gain for exits that lead out,
    /// where `x` is 0, and another for the others.
    fn mean_over_exits(&self, void: u32, share: &[f64], [out, on]: [f64; 2], x: &[f64]) -> f64 {
        let one = |c: usize| match self.target[c] {
            _ if share[c] == 0.0 => 0.0,
            END => share[c] * out,
            to => share[c] * (on + x[to as usize]),
        };
        self.exits(void).map(one).sum()
    }

    /// Finds, in at most this many sweeps, the smallest solution of
    /// `x(v) = sum share_e (gain_e + x(t(e)))`; infinite where `unending`.
    fn relax(
        &self,
        share: &[f64],
        unending: &[bool],
        gain: [f64; 2],
        most: usize,
    ) -> Result<Vec<f64>, NetworkError> {
        let mut x: Vec<f64> = unending.iter().map(|&u| if u { f64::INFINITY } else { 0.0 }).collect();
        for _ in 0..most {
            let mut change = 0f64;
            for void in (0..self.voids()).rev().filter(|&void| !unending[void]) {
                let new = self.mean_over_exits(void as u32, share, gain, &x);
                if new > 0.0 {
                    change = change.max((new - x[void]).abs() / new);
                }
                x[void] = new;
            }
            if change <= CONVERGED {
                return Ok(x);
            }
        }
        Err(NetworkError::NarrowWayOut { sweeps: most })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::constrictions::find;

    #[test]
    fn one_size_of_constriction_stops_all_or_none() {
        let curve = Curve::from_points(&[(100.0, 0.25)], crate::constrictions::CurveUnit::D0f).unwrap();
        let passage = Passage::new(&curve);
        assert_eq!((passage.stopped(0.25), passage.downstream(0.25)), (0.0, 1.0));
        assert_eq!((passage.stopped(0.26), passage.downstream(0.26)), (1.0, 0.0));
        assert_eq!((passage.layers(0.25, 0.95), passage.layers(0.26, 0.95)), (None, Some(0.0)));
    }

    #[test]
    fn equation_one_by_hand() {
        let curve = find("shire2016-cu1.5-loose").unwrap().curve().unwrap();
        let passage = Passage::new(&curve);
        let d = curve.dc(10.0).unwrap();
        let (s, n) = (passage.downstream(d), passage.layers(d, 0.95).unwrap());
        assert!((libm::pow(s, n) - 0.05).abs() < 1e-12);
        assert!(passage.layers(d, 0.99).unwrap() > n);
        let coarsest = passage.coarsest_through(60, 0.95);
        assert!((passage.layers(coarsest, 0.95).unwrap() - 60.0).abs() < 1e-6);
        assert!(passage.stopped(curve.smallest()) == 0.0 && passage.stopped(2.0 * curve.largest()) == 1.0);
    }

    /// Compares with the mean over the 96,000 voids of a network: standard error of q at most 0.3 /
    /// sqrt(96,000) = 0.001.
    #[test]
    fn q_is_the_mean_over_the_voids_of_a_network() {
        let curve = find("shire2016-cu1.5-loose").unwrap().curve().unwrap();
        let (passage, network) =
            (Passage::new(&curve), Network::cubic([40, 40, 60], &curve, 1.0, 4).unwrap());
        for percent in [1.0, 5.0, 20.0, 50.0, 80.0, 99.0] {
            let d = curve.dc(percent).unwrap();
            let mean = (0..network.voids() as u32)
                .map(|void| {
                    let area =
                        |c: usize| f64::from(network.diameters()[c]) * f64::from(network.diameters()[c]);
                    let all: f64 = network.exits(void).map(area).sum();
                    let finer = network.exits(void).filter(|&c| f64::from(network.diameters()[c]) < d);
                    finer.map(area).sum::<f64>() / all
                })
                .sum::<f64>()
                / network.voids() as f64;
            assert!((passage.stopped(d) - mean).abs() < 0.003, "Dc{percent}: {} {mean}", passage.stopped(d));
        }
    }

    /// With equal constrictions a third of the moves lead downstream, on a lattice of any width: 3 nz moves.
    #[test]
    fn equal_constrictions_take_three_moves_a_layer() {
        let network = Network::cubic_from_diameters([3, 2, 7], vec![0.5; 126], 1.0).unwrap();
        let (leaves, moves) = network.first_passage(0.5, |_| false).unwrap().at_start(&network);
        assert!((leaves - 1.0).abs() < 1e-12 && (moves - 21.0).abs() < 1e-9, "{leaves} {moves}");
        assert_eq!(network.first_passage(0.6, |_| false).unwrap().leaves, vec![0.0; 42]);
    }

    /// x and y lead round, z is closed: the particle never leaves and never stops moving.
    #[test]
    fn a_particle_that_circles_never_leaves() {
        let network = Network::cubic_from_diameters([2, 2, 2], vec![1.0; 24], 1.0).unwrap();
        let passage = network.first_passage(0.5, |c| c % 3 == 2 && c >= 12).unwrap();
        let both = [passage.leaves[0], passage.moves[0], passage.moves[4]];
        assert_eq!(both, [0.0, f64::INFINITY, f64::INFINITY]);
        // Once everything is closed it no longer moves.
        let stuck = network.first_passage(0.5, |_| true).unwrap();
        assert_eq!((stuck.leaves[0], stuck.moves[0]), (0.0, 0.0));
    }

    /// A loop that is left once in 10^12 moves would be swept for days; a loop that is left once in 10,000
    /// is solved.
    #[test]
    fn an_answer_that_takes_too_long_is_given_up_in_words() {
        let passage = |narrow: f64| {
            let text = format!("from,to,diameter_mm\nstart,0,\n0,0,1\n0,end,{narrow}\n");
            let network = Network::from_csv(text.as_bytes(), "n.csv", 1.0).unwrap();
            network.first_passage(0.0, |_| false).map(|passage| passage.at_start(&network))
        };
        let (leaves, moves) = passage(0.01).unwrap();
        assert!((leaves - 1.0).abs() < 1e-9 && (moves / 10_001.0 - 1.0).abs() < 1e-6, "{leaves} {moves}");
        // With as few sweeps as on a large network, to keep the test short.
        let text = "from,to,diameter_mm\nstart,0,\n0,0,1\n0,end,0.000001\n";
        let network = Network::from_csv(text.as_bytes(), "n.csv", 1.0).unwrap();
        let error = network.relax(&[1.0, 1e-12], &[false], [1.0; 2], 1000).unwrap_err().to_string();
        assert!(error.contains("after 1000 sweeps") && error.contains("way out"), "{error}");
    }

    /// Loops of one and of many voids whose way out is taken once in 10^6 and in 10^12 moves; and ordinary
    /// lattices, closed loops and dead ends, which take few.
    #[test]
    fn narrow_ways_out_are_known_without_going_them() {
        let moves =
            |text: &str| Network::from_csv(text.as_bytes(), "n.csv", 1.0).unwrap().moves_to_an_end(1 << 22);
        let head = "from,to,diameter_mm\nstart,0,\n";
        let about = |moves: f64, wanted: f64| (moves / wanted - 1.0).abs() < 0.02;
        assert!(about(moves(&format!("{head}0,0,1\n0,end,0.001\n")), 1e6));
        assert!(moves(&format!("{head}0,0,1000\n0,end,0.001\n")) > 1e11);
        assert!(about(moves(&format!("{head}0,1,1\n1,2,1\n2,0,1\n2,end,0.001\n")), 3e6));
        // The way out is in a void that is seldom visited and easily left.
        assert!(about(moves(&format!("{head}0,1,1\n1,0,1\n1,2,0.001\n2,0,1\n2,end,1\n")), 4e6));
        assert!(moves(&format!("{head}0,1,1\n1,0,1\n")) == 0.0);
        assert!(moves(&format!("{head}0,1,1\n0,end,1\n1,1,1\n")) <= 1.0);
        assert!(moves(&format!("{head}0,1,1\n1,2,1\n2,2,0\n")) == 2.0);
        let lattice = Network::cubic_from_diameters([5, 4, 40], vec![0.5; 2400], 1.0).unwrap();
        assert!(about(lattice.moves_to_an_end(1 << 22), 120.0));
        let few = lattice.moves_to_an_end(0);
        assert!(about(few, 120.0), "{few}");
    }
}
