//! Chains of exits that are created and deleted by turns: only the two ends of a chain change their
//! connectivity, so that voids far from each other are mended together. A random search finds such pairs only
//! after very many proposals.

use rand::Rng;

use super::{END, MOST, PossibleExits, SLOTS, STEPS};
use crate::stream::below;

/// A possible exit: void, slot and target.
type Exit = (u32, usize, u32);

/// A void that a chain has come to.
struct Reached {
    void: u32,
    /// True if the next exit of the chain is created, false if it is deleted.
    more: bool,
    /// The exit by which the chain came here, and the place of the void before among those reached.
    by: Option<(Exit, usize)>,
}

impl PossibleExits {
    /// Changes exits along chains as long as that leads nearer. The voids that begin them are drawn.
    pub(super) fn change_along_chains(&mut self, draws: &mut impl Rng) {
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
