//! Search for a lattice with a given distribution of connectivity.
//!
//! - Every void has six possible exits: the lattice's +x, +y, +z and the three face diagonals +x+y, +x+z,
//!   +y+z. No move leads upstream, and the only cycles are the lattice's own, around a periodic side within
//!   one layer. No diagonal leaves the last layer.
//! - One possible exit of one void is drawn at a time, uniformly: deleted if present, otherwise created.
//!   The proposal is accepted if it reduces the *distance* from the target distribution: the sum over k of
//!   | voids with connectivity up to k, minus the target |. After as many proposals in a row without progress
//!   as there are possible exits, proposals that leave the distance unchanged are accepted too, until one
//!   reduces it. A search that is still stuck restarts from another state; after [`MOST_PROPOSALS`]
//!   proposals it is completed along chains.
//! - A void never loses its last entrance (the inlet of a start node counts) and keeps two exits, or one
//!   if connectivities below 4 are wanted. Table 3 suggests two: a void that one particle can close
//!   retains so much that voids of connectivity 4 would hold three times as much each as voids of
//!   connectivity 5, but in the paper they hold about the same (397 and 444; see `results/paper.md`).
//! - A remaining distance is accepted if every count is within [`TOLERANCE_PERCENT`] of all voids, or one
//!   void, of its target; otherwise the distribution is refused.

use rand::Rng;

use super::{END, NetworkError};
use crate::stream::{Key, Purpose, below};

/// Allowed error of the percentage of each connectivity (percent of all voids).
const TOLERANCE_PERCENT: f64 = 0.05;

pub(super) const SLOTS: usize = 6;

/// Step of each possible exit along x, y and z.
pub(super) const STEPS: [[u32; 3]; SLOTS] =
    [[1, 0, 0], [0, 1, 0], [0, 0, 1], [1, 1, 0], [1, 0, 1], [0, 1, 1]];

/// Maximum connectivity: six exits and six entrances.
pub(super) const MOST: usize = 2 * SLOTS;

/// Number of exits that every void keeps if no connectivity below [`FEW`] is wanted; otherwise one.
const KEPT_EXITS: u32 = 2;

/// Minimum connectivity that leaves room for [`KEPT_EXITS`].
const FEW: u32 = 4;

/// Proposals without progress per possible exit after which the first search is given up.
const PATIENCE: u64 = 60;

/// Proposals without progress per possible exit after which a restarted search is given up.
const PATIENCE_AGAIN: u64 = 6;

/// Minimum number of proposals without progress before any search is given up.
const LEAST_PATIENCE: u64 = 100_000;

/// Maximum number of restarts of a stuck search.
const SHAKES: u32 = 60;

/// Maximum number of proposals in all searches together (at most a second); chains do the rest.
const MOST_PROPOSALS: u64 = 10_000_000;

/// During a restart, one in this many proposals that increase the distance is accepted.
const WORSE_IN: u64 = 4;

/// Exits of all voids during the search.
pub(super) struct PossibleExits {
    shape: [u32; 3],
    /// Exits by void: bit s is set if possible exit s is present.
    pub(super) present: Vec<u8>,
    /// Number of entrances of each void, including its inlet.
    entrances: Vec<u8>,
    kept_exits: u32,
    /// Number of voids with connectivity up to k minus the target, for each k.
    surplus: [i64; MOST + 1],
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

    /// Records that the connectivity of a void rises (`more`) or falls by one from `k`; returns the change
    /// of distance (negative if nearer).
    fn count_change(&mut self, k: usize, more: bool) -> i64 {
        // Rise: one void fewer has up to k. Fall: one void more has up to k - 1.
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

    /// Tells if an exit can be deleted without taking a required exit or entrance from a void.
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

    fn distance(&self) -> i64 {
        self.surplus.iter().map(|s| s.abs()).sum()
    }

    /// Draws a proposal and carries it out if it is possible and `accepts` its change of distance, which is
    /// returned then.
    fn propose<R: Rng>(&mut self, draws: &mut R, accepts: impl Fn(i64, &mut R) -> bool) -> Option<i64> {
        let possible = SLOTS as u64 * self.present.len() as u64;
        let drawn = below(draws.next_u64(), possible);
        let (void, slot) = ((drawn / SLOTS as u64) as u32, (drawn % SLOTS as u64) as usize);
        let target = self.target(void, slot)?;
        let more = self.present[void as usize] >> slot & 1 == 0;
        if !more && !self.spare(void, target) {
            return None;
        }
        let change = self.toggle(void, slot, target, more);
        if !accepts(change, draws) {
            self.toggle(void, slot, target, !more);
            return None;
        }
        Some(change)
    }

    /// Accepts proposals that reduce the distance, and after many without progress also those that leave
    /// it unchanged, until the target distribution is reached or patience runs out.
    fn search(&mut self, draws: &mut impl Rng, patience: u64) {
        let possible = SLOTS as u64 * self.present.len() as u64;
        let mut distance = self.distance();
        let mut without_progress = 0;
        let most = patience * possible + LEAST_PATIENCE;
        while distance > 0 && without_progress < most && self.proposals_left > 0 {
            self.proposals_left -= 1;
            without_progress += 1;
            let worst = i64::from(without_progress > possible);
            if let Some(change @ ..0) = self.propose(draws, |change, _| change < worst) {
                distance += change;
                without_progress = 0;
            }
        }
    }

    /// Accepts proposals for a while, but only one in [`WORSE_IN`] of those that increase the distance, to
    /// free a stuck search.
    fn shake(&mut self, draws: &mut impl Rng) {
        for _ in 0..SLOTS * self.present.len() {
            self.propose(draws, |change, draws| change <= 0 || below(draws.next_u64(), WORSE_IN) == 0);
        }
    }

    /// Refuses counts that are too far from their targets.
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
                "a distribution (percent of voids by connectivity) that can be reached by adding diagonals \
                 and deleting constrictions; \
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
    /// Exit through which the chain came here, and index of the previous void among those reached.
    by: Option<(Exit, usize)>,
}

impl PossibleExits {
    /// Changes chains of exits, alternately created and deleted, while that reduces the distance. Only the
    /// two ends of a chain change their connectivity, so distant voids are corrected together. Starting
    /// voids are taken in random order.
    fn change_along_chains(&mut self, draws: &mut impl Rng) {
        let mut starts: Vec<u32> = (0..self.present.len() as u32).collect();
        for last in (1..starts.len()).rev() {
            starts.swap(last, below(draws.next_u64(), last as u64 + 1) as usize);
        }
        let mut seen = vec![false; 2 * starts.len()];
        loop {
            // States that led nowhere from one start are skipped for the others in this pass.
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

    /// Tells if one exit or entrance more (or less, if not `more`) of this void reduces the distance.
    fn wants(&self, void: u32, more: bool) -> bool {
        let k = self.connectivity(void);
        if more { k < MOST && self.surplus[k] > 0 } else { k > 0 && self.surplus[k - 1] < 0 }
    }

    /// Changes the shortest chain from this void to another that needs a change, or to an exit out of the
    /// last layer; returns `false` if no such chain exists.
    fn change_chain(&mut self, start: u32, more: bool, seen: &mut [bool]) -> bool {
        let k = self.connectivity(start);
        // The other end is judged with this end already changed.
        self.count_change(k, more);
        let (reached, chain) = self.chain(start, more, seen);
        self.count_change(if more { k + 1 } else { k - 1 }, !more);
        let is_changed = chain.is_some_and(|chain| self.change(&chain));
        if is_changed {
            reached.iter().for_each(|at| seen[place(at.void, at.more)] = false);
        }
        is_changed
    }

    /// Finds the voids visited, and the chain: exits to create (`true`) or delete (`false`).
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

    /// Possible exits and entrances of a void, each with the void at its other end.
    fn exits_and_entrances(&self, void: u32) -> impl Iterator<Item = (Exit, u32)> {
        (0..SLOTS).flat_map(move |slot| {
            let exit = self.target(void, slot).map(|target| ((void, slot, target), target));
            let entrance = self.source(void, slot).map(|source| ((source, slot, void), source));
            exit.into_iter().chain(entrance)
        })
    }

    /// Void whose possible exit `slot` leads here; `None` upstream of the first layer.
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

    /// Changes all exits of a chain or none: a chain that passes a void twice may not be possible.
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
