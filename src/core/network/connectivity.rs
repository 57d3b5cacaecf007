//! Lattices with a given distribution of void connectivity (paper, section 6, Table 3 and Fig. 20).
//!
//! The *connectivity* of a void is the number of its entrances and exits. On the cubic lattice it is 6 for
//! every void: the inlet of a start node counts as an entrance, the way out of the last layer as an exit. The
//! paper keeps the mean of 6 but spreads it over 4 to 8: "constrictions were created between diagonally
//! neighbouring voids, or deleted until the connectivity distribution shown in Table 3 was reached". It does
//! not say in which order, or which diagonals. Decided here:
//!
//! - Every void has six possible exits: the lattice's +x, +y, +z and the three face diagonals +x+y, +x+z,
//!   +y+z. All lead in positive directions, so the network stays directed: no move leads upstream, and the
//!   only cycles are those of the lattice, around a periodic side within one layer. A diagonal that would
//!   leave the last layer does not exist.
//! - One possible exit of one void is drawn at a time, uniformly. If it is there, deleting it is proposed,
//!   otherwise creating it. The proposal is taken when it brings the distribution nearer to the wanted one;
//!   *near* is the sum over k of | voids with connectivity up to k, less those wanted |. It ends when that
//!   sum is 0. So hardly more constrictions are changed than must be. Where as many proposals as there are
//!   possible exits brought nothing nearer, those that leave it as near are taken too, until one does.
//!   A search that is stuck all the same is begun again from elsewhere: for a while some of what leads
//!   farther away is taken. Otherwise one replicate would have a network and another none.
//! - A search that has not ended after [`MOST_PROPOSALS`] is completed along chains ([`chains`]).
//! - A void never loses its last entrance (the inlet of a start node is one), and keeps two exits; one where
//!   connectivities below 4 are wanted. The paper's Table 3 speaks for two: a void that one particle can
//!   close retains so much that those of connectivity 4 would hold three times as much each as those of 5,
//!   while the paper has them alike (397 and 444; see `results/paper.md`).
//! - The wanted numbers of voids are the percentages rounded by largest remainder. A sum that stays above 0
//!   (parity, or a distribution that no such network has) is accepted when every number is within
//!   [`TOLERANCE_PERCENT`] of all voids, or one void, of what is wanted; otherwise the distribution is
//!   refused.
//!
//! Constrictions that are kept have the diameters that the cubic lattice has for the same seed; diagonals are
//! further independent draws from the same curve. Layers are those of the lattice: voids with the same z.

mod chains;

use rand::Rng;

use super::{END, Network, NetworkError};
use crate::constrictions::Curve;
use crate::stream::{Key, Purpose, below};

/// Table 3 of the paper: connectivity, and percent of the voids.
pub const TABLE_3: [(u32, f64); 5] = [(4, 3.5), (5, 22.8), (6, 47.6), (7, 22.6), (8, 3.5)];

/// Allowed error of the share of a connectivity (percent of all voids).
pub const TOLERANCE_PERCENT: f64 = 0.05;

/// Possible exits of a void.
const SLOTS: usize = 6;

/// Step of each possible exit along x, y and z.
const STEPS: [[u32; 3]; SLOTS] = [[1, 0, 0], [0, 1, 0], [0, 0, 1], [1, 1, 0], [1, 0, 1], [0, 1, 1]];

/// The largest connectivity: six exits and six entrances.
const MOST: usize = 2 * SLOTS;

/// Exits that every void keeps, where no connectivity below [`FEW`] is wanted; one otherwise.
const KEPT_EXITS: u32 = 2;

/// The least connectivity that leaves room for [`KEPT_EXITS`].
const FEW: u32 = 4;

/// Proposals without progress, for each possible exit, after which a first search is given up.
const PATIENCE: u64 = 60;

/// Likewise for a search that begins again from elsewhere.
const PATIENCE_AGAIN: u64 = 6;

/// Proposals without progress that every search makes at least.
const LEAST_PATIENCE: u64 = 100_000;

/// Number of times that a stuck search begins again from elsewhere.
const SHAKES: u32 = 60;

/// Proposals of all searches together, a second or less; the rest is changed along chains.
const MOST_PROPOSALS: u64 = 10_000_000;

/// One in this many proposals that lead farther away is taken when a search begins elsewhere.
const WORSE_IN: u64 = 4;

/// First block of the stream that diagonals draw their diameters from; those of the lattice begin at 0.
const FIRST_DIAGONAL_BLOCK: u64 = 1 << 32;

/// A distribution of connectivity: percent of the voids by connectivity.
#[derive(Clone, Debug, PartialEq)]
pub struct Connectivity {
    /// Rising connectivity, each with its percent; they sum to 100.
    percent: Vec<(u32, f64)>,
}

impl Connectivity {
    /// The distribution of Table 3.
    pub fn table_3() -> Self {
        Self { percent: TABLE_3.to_vec() }
    }

    /// A distribution from pairs of connectivity and percent of the voids, in any order.
    ///
    /// # Errors
    /// A connectivity outside 2 to 12 or given twice, a percentage that is negative or not finite, or
    /// percentages that do not sum to 100 within 0.5; the sum is then made exact.
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
        // A distribution that was made exact before stays as it is, bit for bit.
        if (sum - 100.0).abs() > 1e-9 {
            percent.iter_mut().for_each(|(_, share)| *share *= 100.0 / sum);
        }
        percent.retain(|(_, share)| *share > 0.0);
        Ok(Self { percent })
    }

    /// Connectivity and percent of the voids, rising.
    pub fn percent(&self) -> &[(u32, f64)] {
        &self.percent
    }

    /// Voids by connectivity, summing to `voids`: rounded down, then up where the remainder is largest.
    fn voids(&self, voids: u64) -> [i64; MOST + 1] {
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
    /// A lattice of this shape whose voids have this distribution of connectivity; diameters as in
    /// [`Network::cubic`].
    ///
    /// # Errors
    /// Those of [`Network::cubic`], and a distribution that no such network has.
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
        exits.change_to(connectivity, seed)?;
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

    /// Connectivity of each void: its entrances and exits; that it is a start node counts as an entrance.
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

/// Exits of the voids while they are changed.
struct PossibleExits {
    shape: [u32; 3],
    /// By void: bit s is set if possible exit s is there.
    present: Vec<u8>,
    /// Entrances of each void, its inlet included.
    entrances: Vec<u8>,
    /// Exits that a void keeps.
    kept_exits: u32,
    /// For each k: voids with connectivity up to k, less those wanted.
    surplus: [i64; MOST + 1],
    /// Proposals that may still be made.
    proposals_left: u64,
}

impl PossibleExits {
    fn cubic(shape: [u32; 3]) -> Self {
        let voids = shape.iter().map(|&n| n as usize).product();
        Self {
            shape,
            present: vec![0b111; voids],
            entrances: vec![3; voids],
            kept_exits: KEPT_EXITS,
            surplus: [0; MOST + 1],
            proposals_left: MOST_PROPOSALS,
        }
    }

    /// Void that a possible exit leads to; `None` for a diagonal out of the last layer.
    fn target(&self, void: u32, slot: usize) -> Option<u32> {
        let [nx, ny, nz] = self.shape;
        let (x, y, z) = (void % nx, void / nx % ny, void / (nx * ny));
        let [dx, dy, dz] = STEPS[slot];
        if z + dz == nz {
            return (slot == 2).then_some(END);
        }
        let x = if x + dx == nx { 0 } else { x + dx };
        let y = if y + dy == ny { 0 } else { y + dy };
        Some(x + nx * (y + ny * (z + dz)))
    }

    fn connectivity(&self, void: u32) -> usize {
        (self.present[void as usize].count_ones() + u32::from(self.entrances[void as usize])) as usize
    }

    /// Counts that a void's connectivity goes from `k` to one more, or one less; returns the change of
    /// distance (negative if nearer).
    fn count_change(&mut self, k: usize, more: bool) -> i64 {
        // One more: the voids up to k are one fewer. One less: those up to k - 1 are one more.
        let (at, by) = if more { (k, -1) } else { (k - 1, 1) };
        let before = self.surplus[at].abs();
        self.surplus[at] += by;
        self.surplus[at].abs() - before
    }

    /// Creates or deletes a possible exit.
    fn toggle(&mut self, void: u32, slot: usize, target: u32, more: bool) -> i64 {
        let mut change = self.count_change(self.connectivity(void), more);
        self.present[void as usize] ^= 1 << slot;
        if target != END {
            change += self.count_change(self.connectivity(target), more);
            let entrances = &mut self.entrances[target as usize];
            *entrances = if more { *entrances + 1 } else { *entrances - 1 };
        }
        change
    }

    /// Tells if an exit can be deleted while each void keeps the exits and the entrance that it must have.
    fn spare(&self, void: u32, target: u32) -> bool {
        self.present[void as usize].count_ones() > self.kept_exits
            && (target == END || self.entrances[target as usize] > 1)
    }

    fn change_to(&mut self, wanted: &Connectivity, seed: u64) -> Result<(), NetworkError> {
        let voids = self.present.len() as u64;
        let counts = wanted.voids(voids);
        if counts[..FEW as usize].iter().any(|&count| count > 0) {
            self.kept_exits = 1;
        }
        let mut sum = 0;
        for (k, count) in counts.iter().enumerate() {
            sum += count;
            self.surplus[k] = if k >= 6 { voids as i64 } else { 0 } - sum;
        }
        let mut draws =
            Key { seed, purpose: Purpose::Connectivity, run: 0, increment: 0, chunk: 0 }.generator();
        self.search(&mut draws, PATIENCE);
        for _ in 0..SHAKES {
            if self.check(&counts).is_ok() || self.proposals_left == 0 {
                break;
            }
            self.shake(&mut draws);
            self.search(&mut draws, PATIENCE_AGAIN);
        }
        if self.check(&counts).is_err() {
            self.change_along_chains(&mut draws);
        }
        self.check(&counts)
    }

    /// Distance of the distribution from the wanted one.
    fn distance(&self) -> i64 {
        self.surplus.iter().map(|s| s.abs()).sum()
    }

    /// Draws a proposal and carries it out; returns how much farther it leads, and the change that undoes it.
    /// `None` if it cannot be made.
    fn propose(&mut self, draws: &mut impl Rng) -> Option<(i64, (u32, usize, u32, bool))> {
        let possible = SLOTS as u64 * self.present.len() as u64;
        let drawn = below(draws.next_u64(), possible);
        let (void, slot) = ((drawn / SLOTS as u64) as u32, (drawn % SLOTS as u64) as usize);
        let target = self.target(void, slot)?;
        let more = self.present[void as usize] >> slot & 1 == 0;
        if !more && !self.spare(void, target) {
            return None;
        }
        Some((self.toggle(void, slot, target, more), (void, slot, target, !more)))
    }

    /// Takes proposals that lead nearer, and after long without one those that lead as near, until the wanted
    /// distribution is reached or patience ends.
    fn search(&mut self, draws: &mut impl Rng, patience: u64) {
        let possible = SLOTS as u64 * self.present.len() as u64;
        let mut distance = self.distance();
        let mut without_progress = 0;
        let most = patience * possible + LEAST_PATIENCE;
        while distance > 0 && without_progress < most && self.proposals_left > 0 {
            self.proposals_left -= 1;
            without_progress += 1;
            let Some((change, (void, slot, target, back))) = self.propose(draws) else { continue };
            if change < 0 {
                distance += change;
                without_progress = 0;
            } else if change > 0 || without_progress <= possible {
                self.toggle(void, slot, target, back);
            }
        }
    }

    /// Takes all proposals for a while, but only one in [`WORSE_IN`] of those that lead farther away, so that
    /// a stuck search begins elsewhere.
    fn shake(&mut self, draws: &mut impl Rng) {
        for _ in 0..SLOTS * self.present.len() {
            let Some((change, (void, slot, target, back))) = self.propose(draws) else { continue };
            if change > 0 && below(draws.next_u64(), WORSE_IN) > 0 {
                self.toggle(void, slot, target, back);
            }
        }
    }

    /// Refuses numbers of voids that are too far from those wanted.
    fn check(&self, counts: &[i64; MOST + 1]) -> Result<(), NetworkError> {
        let voids = self.present.len() as f64;
        let off = |k: usize| self.surplus[k] - if k == 0 { 0 } else { self.surplus[k - 1] };
        let tolerance = (TOLERANCE_PERCENT / 100.0 * voids).max(1.0);
        if (0..=MOST).all(|k| off(k).abs() as f64 <= tolerance) {
            return Ok(());
        }
        let list = |count: &dyn Fn(usize) -> i64| {
            let percent = |k: usize| format!("{k} = {:.2}", 100.0 * count(k) as f64 / voids);
            (0..=MOST).filter(|&k| count(k) != 0).map(percent).collect::<Vec<_>>().join(", ")
        };
        Err(NetworkError::Connectivity {
            value: list(&|k| counts[k]),
            allowed: format!(
                "a distribution (percent of voids by connectivity) that adding diagonals and deleting \
                 constrictions reaches; \
                 the nearest found was {}",
                list(&|k| counts[k] + off(k))
            ),
        })
    }
}

#[cfg(test)]
mod tests;
