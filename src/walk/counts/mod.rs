//! Passive particles as counts per void (engines `counts` and `expected`).
//!
//! A base particle no coarser than any constriction that is open when its run starts is *passive*: it can block
//! nothing, voids have no capacity, so it influences nobody. The coarser ones are walked one by one as ever;
//! how many of an increment's share they are is binomial, with the sampler's exact word limit for its
//! probability. The passive ones move beside them as one count a void: in each increment the share is put
//! on the start nodes (multinomial), and each void's count parts over the exits that were open when the
//! increment began (conditional binomials). Which passive particle is which is never known, nor asked.
//! This is the law of the walk one by one, not an approximation of it.
//!
//! # Streams
//! Increment `t` of run `r` draws the number of coarse particles from (seed, coarse share, `r`, `t`, 0), the start
//! nodes of the passive ones from (seed, passive, `r`, `t`, 2^64 - 1), the partings of block `b` of voids from (seed,
//! passive, `r`, `t`, `b`), and sizes of the passive particles that came to rest from (seed, passive size, `r`, `t`, 0).
//! Threads appear nowhere in this.
//!
//! # Expected
//! Engine `expected` walks the same coarse particles and moves the expectation of the passive ones given that history: the
//! same figures without the scatter of the passive ones. Whole numbers are rounded from running sums. Its run ends
//! when less than half a particle that is not trapped is expected to move.

mod binomial;
mod expected;
mod flow;
mod shares;
mod sizes;

pub use expected::Expected;

use super::{Isa, State, Supply};
use crate::network::{END, Network};
use crate::stream::{Key, Purpose};
use binomial::{Draws, one};
use flow::Flow;
use shares::Shares;
use sizes::PassiveSizes;

/// Moving passive particles, where they are not walked one by one.
#[derive(Clone, Debug, PartialEq)]
pub enum Passive {
    /// Among the particles, like any other.
    OneByOne,
    /// How many move, by void.
    Counts(Vec<u64>),
    /// How many are expected to move, by void.
    Expected(Box<Expected>),
}

impl Passive {
    /// None yet, on a network of `voids` voids.
    pub(super) fn none_yet(voids: usize, expected: bool) -> Self {
        match expected {
            true => Passive::Expected(Box::new(Expected::new(voids))),
            false => Passive::Counts(vec![0; voids]),
        }
    }
}

impl Passive {
    /// A number for each kind, for a checkpoint.
    pub(super) fn kind(&self) -> u64 {
        match self {
            Passive::OneByOne => 0,
            Passive::Counts(_) => 1,
            Passive::Expected(_) => 2,
        }
    }

    /// The counts, where there are any.
    pub(super) fn counts(&self) -> &[u64] {
        match self {
            Passive::Counts(moving) => moving,
            _ => &[],
        }
    }

    /// The expectation as words, where there is one.
    pub(super) fn expected_words(&self) -> Vec<u64> {
        match self {
            Passive::Expected(expected) => expected.words(),
            _ => Vec::new(),
        }
    }
}

/// How many of an increment's `share` of base particles are coarse, given that `passive_words` of the sampler's
/// words draw passive ones.
pub(super) fn coarse_share(share: u64, passive_words: u128, seed: u64, run: u64, increment: u64) -> u64 {
    let all = 1u128 << 64;
    let key = Key { seed, purpose: Purpose::CoarseShare, run, increment, chunk: 0 };
    one(&mut Draws::new(key), share, sizes::fraction(all - passive_words, all))
}

/// The machinery of the passive particles of a run; rebuilt from network and state, and never stored.
pub struct PassiveWalk<'a> {
    sizes: PassiveSizes<'a>,
    shares: Shares,
    mover: Mover,
    trap: Option<Trap>,
    /// Room for thresholds.
    thresholds: Vec<u64>,
}

enum Mover {
    Counts(Flow),
    /// Room for the expectation after the step.
    Expected(Vec<f64>),
}

/// Voids that lead to an end or to a void without open exits: passive particles elsewhere are trapped.
struct Trap {
    /// Number of blocked constrictions that this holds for.
    blocked: u64,
    leads_out: Vec<bool>,
    /// Whether all of them do.
    none: bool,
}

impl<'a> PassiveWalk<'a> {
    /// Prepares to move the passive particles of `state`; `None` where there are none but one by one.
    pub fn new(network: &Network, supply: &'a Supply, state: &State) -> Option<Self> {
        let mover = match &state.passive {
            Passive::OneByOne => return None,
            Passive::Counts(moving) => Mover::Counts(Flow::new(network, moving)),
            Passive::Expected(_) => Mover::Expected(vec![0.0; network.voids()]),
        };
        Some(Self {
            sizes: PassiveSizes::new(supply.sampler(), supply.passive_words(), &state.classes),
            shares: Shares::new(network, &state.blocked),
            mover,
            trap: None,
            thresholds: Vec::new(),
        })
    }

    /// The same with the instructions of `isa`, to the same bits.
    pub fn set_isa(&mut self, isa: Isa) {
        if let Mover::Counts(flow) = &mut self.mover {
            flow.set_isa(isa);
        }
    }

    /// Inserts this increment's passive particles, moves all, and books what became of them.
    pub fn increment(&mut self, network: &Network, supply: &Supply, state: &mut State) {
        let inserted =
            supply.passive_inserted(state.increment) - supply.passive_inserted(state.increment - 1);
        let tally = &mut state.tally;
        tally.inserted += inserted;
        tally.passive_inserted += inserted;
        tally.inserted_mass += self.sizes.mass(inserted);
        tally.moving += inserted;
        match (&mut self.mover, &mut state.passive) {
            (Mover::Counts(flow), Passive::Counts(moving)) => {
                let purpose = Purpose::Passive;
                let key =
                    Key { seed: state.seed, purpose, run: state.run, increment: state.increment, chunk: 0 };
                flow.insert(network, inserted, supply.is_stratified(), key, moving);
                let before: u64 = flow.moving() + inserted;
                let moved = flow.step(network, &self.shares, key, moving);
                // Counted afresh, so that the check of the tally means something.
                tally.moving = tally.moving - before + flow.moving();
                tally.particle_moves = tally.particle_moves.saturating_add(moved.moves);
                self.book(moved.eroded, &moved.stranded, state);
            }
            (Mover::Expected(next), Passive::Expected(expected)) => {
                expected.insert(network, inserted);
                expected.step(network, &self.shares, next);
                self.book_expected(None, state);
            }
            _ => unreachable!("the mover was made for this state"),
        }
    }

    /// Books what left and what stays in voids, with drawn sizes.
    fn book(&self, eroded: u64, stranded: &[(u32, u64)], state: &mut State) {
        let retained: u64 = stranded.iter().map(|&(_, n)| n).sum();
        if eroded == 0 && retained == 0 {
            return;
        }
        let purpose = Purpose::PassiveSize;
        let key = Key { seed: state.seed, purpose, run: state.run, increment: state.increment, chunk: 0 };
        let mut draws = Draws::new(key);
        let largest = self.sizes.draw(eroded, &mut draws, &mut state.eroded_sizes);
        self.sizes.draw(retained, &mut draws, &mut state.retained_sizes);
        let tally = &mut state.tally;
        tally.eroded += eroded;
        tally.passive_eroded += eroded;
        tally.eroded_mass += self.sizes.mass(eroded);
        tally.largest_eroded = tally.largest_eroded.max(largest.unwrap_or(0.0));
        tally.retained_in_voids += retained;
        for &(void, n) in stranded {
            state.retained_in_voids[void as usize] += n;
        }
    }

    /// Books the rounded expectation; `settled` as in [`Expected::book`].
    fn book_expected(&self, settled: Option<f64>, state: &mut State) {
        let Passive::Expected(expected) = &mut state.passive else { return };
        let booked = expected.book(settled, &mut state.retained_in_voids);
        let ([moves, eroded, at_rest], [moves_now, eroded_now, at_rest_now]) = (booked.before, booked.after);
        let (retained, retained_now) = (at_rest - eroded, at_rest_now - eroded_now);
        let tally = &mut state.tally;
        tally.particle_moves = tally.particle_moves.saturating_add(moves_now - moves);
        tally.eroded = tally.eroded + eroded_now - eroded;
        tally.passive_eroded = eroded_now;
        tally.eroded_mass += self.sizes.mass(eroded_now) - self.sizes.mass(eroded);
        tally.retained_in_voids = tally.retained_in_voids + retained_now - retained;
        tally.moving = tally.moving + at_rest - at_rest_now;
        self.sizes.expect(eroded, eroded_now, &mut state.eroded_sizes);
        self.sizes.expect(retained, retained_now, &mut state.retained_sizes);
        let largest = self.sizes.median_largest(eroded_now).unwrap_or(0.0);
        tally.largest_eroded = tally.largest_eroded.max(largest);
    }

    /// Constrictions of these voids have closed.
    pub fn refresh(&mut self, network: &Network, state: &State, voids: impl Iterator<Item = u32>) {
        for void in voids {
            self.shares.set(network, &state.blocked, void, &mut self.thresholds);
        }
    }

    /// Whether every moving passive particle is trapped; to be asked when everything is inserted and nothing can
    /// block any more.
    pub fn all_trapped(&mut self, network: &Network, state: &mut State) -> bool {
        let settled = match &state.passive {
            Passive::OneByOne => return true,
            Passive::Counts(moving) => {
                let Mover::Counts(flow) = &self.mover else { return false };
                if flow.moving() == 0 {
                    return true;
                }
                let trap = Trap::renew(&mut self.trap, network, state);
                return !trap.none && moving.iter().zip(&trap.leads_out).all(|(&n, &out)| n == 0 || !out);
            }
            Passive::Expected(expected) => {
                let trap = Trap::renew(&mut self.trap, network, state);
                let (mut free, mut trapped) = (0.0, 0.0);
                for (&n, &out) in expected.moving.iter().zip(&trap.leads_out) {
                    if out { free += n } else { trapped += n }
                }
                (free < 0.5).then_some(trapped)
            }
        };
        if settled.is_some() {
            self.book_expected(settled, state);
        }
        settled.is_some()
    }
}

impl Trap {
    /// The trap of the constrictions that are open now; nothing opens again, so their number names it.
    fn renew<'t>(known: &'t mut Option<Self>, network: &Network, state: &State) -> &'t Self {
        let blocked = state.tally.blocked;
        known.take_if(|trap| trap.blocked != blocked);
        known.get_or_insert_with(|| {
            let leads_out = leads_out(network, |c| !state.is_closed(network, c));
            let none = leads_out.iter().all(|&out| out);
            Self { blocked, leads_out, none }
        })
    }
}

/// Voids from which open constrictions lead to an end, or to a void that has none.
fn leads_out(network: &Network, open: impl Fn(usize) -> bool) -> Vec<bool> {
    let ends = |void: &u32| {
        let mut exits = network.exits(*void).filter(|&c| open(c)).peekable();
        exits.peek().is_none() || exits.any(|c| network.targets()[c] == END)
    };
    let (begin, entrances) = network.entrances();
    let upstream = network.upstream();
    let mut stack: Vec<u32> = (0..network.voids() as u32).filter(ends).collect();
    let mut leads = vec![false; network.voids()];
    stack.iter().for_each(|&void| leads[void as usize] = true);
    while let Some(void) = stack.pop() {
        for &entrance in &entrances[begin[void as usize] as usize..begin[void as usize + 1] as usize] {
            let above = upstream[entrance as usize];
            if open(entrance as usize) && !leads[above as usize] {
                leads[above as usize] = true;
                stack.push(above);
            }
        }
    }
    leads
}

#[cfg(test)]
mod tests;
