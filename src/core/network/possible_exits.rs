//! The search for a lattice with a given distribution of connectivity.
//!
//! - Every void has six possible exits: the lattice's +x, +y, +z and the three face diagonals +x+y, +x+z,
//!   +y+z. All lead in positive directions, so no move leads upstream, and the only cycles are those of the
//!   lattice, around a periodic side within one layer. No diagonal leaves the last layer.
//! - One possible exit of one void is drawn at a time, uniformly: deleted if it is there, else created. The
//!   proposal is taken when it brings the distribution nearer to the wanted one; *near* is the sum over k of
//!   | voids with connectivity up to k, less those wanted |. Where as many proposals as there are possible
//!   exits brought nothing nearer, those that leave it as near are taken too, until one does. A search that
//!   is stuck all the same begins again from elsewhere, since otherwise one replicate would have a network
//!   and another none; one that has not ended after [`MOST_PROPOSALS`] is completed along chains.
//! - A void never loses its last entrance (the inlet of a start node is one), and keeps two exits; one where
//!   connectivities below 4 are wanted. Table 3 speaks for two: a void that one particle can close retains so
//!   much that those of connectivity 4 would hold three times as much each as those of 5, while the paper has
//!   them alike (397 and 444; see `results/paper.md`).
//! - A sum that stays above 0 (parity, or a distribution that no such network has) is accepted when every
//!   number is within [`TOLERANCE_PERCENT`] of all voids, or one void, of what is wanted; else the
//!   distribution is refused.

use rand::Rng;

use super::{END, NetworkError};
use crate::stream::{Key, Purpose, below};

/// Allowed error of the share of a connectivity (percent of all voids).
pub const TOLERANCE_PERCENT: f64 = 0.05;

pub(super) const SLOTS: usize = 6;

/// Step of each possible exit along x, y and z.
pub(super) const STEPS: [[u32; 3]; SLOTS] =
    [[1, 0, 0], [0, 1, 0], [0, 0, 1], [1, 1, 0], [1, 0, 1], [0, 1, 1]];

/// The largest connectivity: six exits and six entrances.
pub(super) const MOST: usize = 2 * SLOTS;

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

/// Exits of the voids while they are changed.
pub(super) struct PossibleExits {
    shape: [u32; 3],
    /// By void: bit s is set if possible exit s is there.
    pub(super) present: Vec<u8>,
    /// Entrances of each void, its inlet included.
    entrances: Vec<u8>,
    kept_exits: u32,
    /// For each k: voids with connectivity up to k, less those wanted.
    surplus: [i64; MOST + 1],
    /// Proposals that may still be made.
    proposals_left: u64,
}

impl PossibleExits {
    pub(super) fn cubic(shape: [u32; 3]) -> Self {
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
    pub(super) fn target(&self, void: u32, slot: usize) -> Option<u32> {
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

    pub(super) fn change_to(&mut self, counts: &[i64; MOST + 1], seed: u64) -> Result<(), NetworkError> {
        let voids = self.present.len();
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
            if self.check(counts).is_ok() || self.proposals_left == 0 {
                break;
            }
            self.shake(&mut draws);
            self.search(&mut draws, PATIENCE_AGAIN);
        }
        if self.check(counts).is_err() {
            self.change_along_chains(&mut draws);
        }
        self.check(counts)
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

/// A possible exit: void, slot and target.
type Exit = (u32, usize, u32);

struct Reached {
    void: u32,
    /// True if the next exit of the chain is created, false if it is deleted.
    more: bool,
    /// The exit by which the chain came here, and the place of the void before among those reached.
    by: Option<(Exit, usize)>,
}

impl PossibleExits {
    /// Changes chains of exits, created and deleted by turns, as long as that leads nearer: only the two ends
    /// of a chain change their connectivity, so that voids far from each other are mended together. The voids
    /// that begin them are drawn.
    fn change_along_chains(&mut self, draws: &mut impl Rng) {
        let mut starts: Vec<u32> = (0..self.present.len() as u32).collect();
        for last in (1..starts.len()).rev() {
            starts.swap(last, below(draws.next_u64(), last as u64 + 1) as usize);
        }
        let mut seen = vec![false; 2 * starts.len()];
        loop {
            // If one start leads nowhere, others need not look in this pass.
            seen.fill(false);
            let before = self.distance();
            for &start in &starts {
                for more in [false, true] {
                    while self.wants(start, more) && self.change_chain(start, more, &mut seen) {}
                }
            }
            if self.distance() == before {
                return;
            }
        }
    }

    /// Tells if one exit or entrance more of this void (else one less) leads nearer.
    fn wants(&self, void: u32, more: bool) -> bool {
        let k = self.connectivity(void);
        if more { k < MOST && self.surplus[k] > 0 } else { k > 0 && self.surplus[k - 1] < 0 }
    }

    /// Changes the shortest chain from this void to another that wants to be changed, or to an exit out of
    /// the last layer; returns `false` if no such chain exists.
    fn change_chain(&mut self, start: u32, more: bool, seen: &mut [bool]) -> bool {
        let k = self.connectivity(start);
        // The other end is judged by the numbers still wanted after this one.
        self.count_change(k, more);
        let (reached, chain) = self.chain(start, more, seen);
        self.count_change(if more { k + 1 } else { k - 1 }, !more);
        let is_changed = chain.is_some_and(|chain| self.change(&chain));
        if is_changed {
            reached.iter().for_each(|at| seen[place(at.void, at.more)] = false);
        }
        is_changed
    }

    /// Voids that were looked at, and the chain: exits that are to be created (`true`) or deleted.
    fn chain(&self, start: u32, more: bool, seen: &mut [bool]) -> (Vec<Reached>, Option<Vec<(Exit, bool)>>) {
        let mut reached = vec![Reached { void: start, more, by: None }];
        let mut at = 0;
        while at < reached.len() {
            let Reached { void, more, .. } = reached[at];
            for (exit, other) in self.exits_and_entrances(void) {
                if other == start || !self.can_change(exit, more) {
                    continue;
                }
                if other == END || self.wants(other, more) {
                    let mut chain = vec![(exit, more)];
                    let mut back = at;
                    while let Some((exit, before)) = reached[back].by {
                        chain.push((exit, reached[before].more));
                        back = before;
                    }
                    chain.reverse();
                    return (reached, Some(chain));
                }
                if !std::mem::replace(&mut seen[place(other, !more)], true) {
                    reached.push(Reached { void: other, more: !more, by: Some((exit, at)) });
                }
            }
            at += 1;
        }
        (reached, None)
    }

    /// The possible exits and entrances of a void, and the void at the other end of each.
    fn exits_and_entrances(&self, void: u32) -> impl Iterator<Item = (Exit, u32)> {
        (0..SLOTS).flat_map(move |slot| {
            let exit = self.target(void, slot).map(|target| ((void, slot, target), target));
            let entrance = self.source(void, slot).map(|source| ((source, slot, void), source));
            exit.into_iter().chain(entrance)
        })
    }

    /// Void whose possible exit leads here; `None` before the first layer.
    fn source(&self, void: u32, slot: usize) -> Option<u32> {
        let [nx, ny, nz] = self.shape;
        let (x, y, z) = (void % nx, void / nx % ny, void / (nx * ny));
        let [dx, dy, dz] = STEPS[slot];
        (z >= dz && z < nz).then(|| (x + nx - dx) % nx + nx * ((y + ny - dy) % ny + ny * (z - dz)))
    }

    fn can_change(&self, (void, slot, target): Exit, more: bool) -> bool {
        let is_present = self.present[void as usize] >> slot & 1 == 1;
        is_present != more && (more || self.spare(void, target))
    }

    /// Changes all exits of a chain or leaves all: a chain that passes a void twice may ask for too much of
    /// it.
    fn change(&mut self, chain: &[(Exit, bool)]) -> bool {
        for (changed, &(exit, more)) in chain.iter().enumerate() {
            if !self.can_change(exit, more) {
                for &((void, slot, target), more) in chain[..changed].iter().rev() {
                    self.toggle(void, slot, target, !more);
                }
                return false;
            }
            let (void, slot, target) = exit;
            self.toggle(void, slot, target, more);
        }
        true
    }
}

fn place(void: u32, more: bool) -> usize {
    2 * void as usize + usize::from(more)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::network::{Connectivity, TABLE_3};

    #[test]
    fn a_distribution_that_is_hard_to_draw_is_reached_along_chains() {
        let shape = [40, 40, 60];
        for percent in [vec![(5, 50.0), (7, 50.0)], TABLE_3.to_vec()] {
            let wanted = Connectivity::new(&percent).unwrap();
            let changed = || {
                let mut exits = PossibleExits { proposals_left: 0, ..PossibleExits::cubic(shape) };
                exits.change_to(&wanted.voids(96_000), 1).unwrap();
                exits
            };
            let exits = changed();
            assert_eq!(exits.distance(), 0);
            assert!(exits.present == changed().present);
            for void in 0..96_000 {
                assert!(exits.present[void].count_ones() >= KEPT_EXITS && exits.entrances[void] > 0);
            }
        }
    }

    #[test]
    fn a_search_makes_no_more_proposals_than_it_may() {
        let impossible = Connectivity::new(&[(12, 100.0)]).unwrap();
        let mut exits = PossibleExits { proposals_left: 1000, ..PossibleExits::cubic([6, 6, 6]) };
        assert!(exits.change_to(&impossible.voids(216), 1).is_err());
        assert_eq!(exits.proposals_left, 0);
    }
}
