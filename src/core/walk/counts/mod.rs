//! Passive particles as counts per void (engines `counts` and `expected`).
//!
//! A base particle no coarser than any constriction that is open when its run starts is *passive*: it can
//! block nothing, voids have no capacity, so it influences nobody. The coarser ones are walked one by one as
//! ever; how many of an increment's share they are is binomial, with the sampler's exact word limit for its
//! probability. The passive ones move beside them as one count a void: in each increment the share is put on
//! the start nodes (multinomial), and each void's count is split over the exits that were open when the
//! increment began (conditional binomials). Which passive particle is which is never known, nor asked. This
//! is the distribution of the walk one by one, not an approximation of it.
//!
//! # Streams
//! Increment `t` of run `r` draws the number of coarse particles from (seed, coarse share, `r`, `t`, 0), the
//! start nodes of the passive ones from (seed, passive, `r`, `t`, 2^64 - 1), the splits of block `b` of voids
//! from (seed, passive, `r`, `t`, `b`), and sizes of the passive particles that came to rest from (seed,
//! passive size, `r`, `t`, 0). Threads appear nowhere in this.
//!
//! # Expected
//! Engine `expected` walks the same coarse particles and moves the expectation of the passive ones given that
//! history: the same figures without the scatter of the passive ones. Whole numbers are rounded from running
//! sums. Its run ends when less than half a particle that is not trapped is expected to move.

mod binomial;
mod expected;
mod flow;
mod passive;
mod shares;
mod sizes;

pub use expected::{Counted, Expected, ExpectedSums};
pub use passive::Passive;
pub(super) use sizes::coarse_share;

use super::exits::VoidExits;
use super::openings::Ways;
use super::{Isa, State, Supply};
use crate::network::{END, Network};
use crate::stream::{Key, Purpose};
use binomial::Draws;
use expected::ExpectedFlow;
use flow::Flow;
pub(super) use shares::Shares;
use sizes::PassiveSizes;

/// Voids to move expectations in, and particles to move one by one, from which both take so long that an idle
/// thread is worth waking.
const WORTH_A_THREAD: usize = 1 << 14;

/// The machinery of the passive particles of a run; rebuilt from network and state, and never stored.
pub struct PassiveWalk<'a> {
    sizes: PassiveSizes<'a>,
    shares: Shares,
    mover: Mover,
    trap: Option<Trap>,
}

enum Mover {
    Counts(Flow),
    Expected(ExpectedFlow),
}

/// Voids that lead to an end or to a void without open exits: passive particles elsewhere are trapped.
struct Trap {
    /// Number of blocked constrictions that this holds for.
    blocked: u64,
    leads_out: Vec<bool>,
    /// True if all voids do.
    none: bool,
}

impl<'a> PassiveWalk<'a> {
    /// Prepares to move the passive particles of `state`, by the shares of its open exits if they are known;
    /// `None` if all are walked one by one.
    pub fn new(network: &Network, supply: &'a Supply, state: &State, known: Option<Shares>) -> Option<Self> {
        let shares = || known.unwrap_or_else(|| Shares::new(network, Ways::Unblocked(&state.blocked)));
        let (shares, mover) = match &state.passive {
            Passive::OneByOne => return None,
            Passive::Counts(moving) => (shares(), Mover::Counts(Flow::new(network, moving))),
            Passive::Expected(expected) => {
                let shares = shares();
                let flow = ExpectedFlow::new(network, &shares, expected);
                (shares, Mover::Expected(flow))
            }
        };
        Some(Self {
            sizes: PassiveSizes::new(supply.sampler(), supply.passive_words(), &state.classes),
            shares,
            mover,
            trap: None,
        })
    }

    /// The shares of the exits that are open now.
    pub fn into_shares(self) -> Shares {
        self.shares
    }

    /// Uses the instructions of `isa`, to the same bits.
    pub fn set_isa(&mut self, isa: Isa) {
        match &mut self.mover {
            Mover::Counts(flow) => flow.set_isa(isa),
            Mover::Expected(flow) => flow.set_isa(isa),
        }
    }

    /// Inserts this increment's passive particles.
    pub fn insert(&mut self, network: &Network, supply: &Supply, state: &mut State) {
        let inserted =
            supply.passive_inserted(state.increment) - supply.passive_inserted(state.increment - 1);
        let tally = &mut state.tally;
        tally.inserted += inserted;
        tally.passive_inserted += inserted;
        tally.inserted_mass += self.sizes.mass(inserted);
        tally.moving += inserted;
        let key = passive_key(state);
        match (&mut self.mover, &mut state.passive) {
            (Mover::Counts(flow), Passive::Counts(moving)) => {
                flow.insert(network, inserted, supply.is_stratified(), key, moving);
            }
            (_, Passive::Expected(expected)) => expected.insert(network, inserted),
            _ => unreachable!("the mover was made for this state"),
        }
    }

    /// Moves all particles, and counts their fates.
    pub fn step(&mut self, network: &Network, state: &mut State) {
        let (key, tally) = (passive_key(state), &mut state.tally);
        match (&mut self.mover, &mut state.passive) {
            (Mover::Counts(flow), Passive::Counts(moving)) => {
                let before = flow.moving();
                let moved = flow.step(network, &self.shares, key, moving);
                // Counted afresh, so that the check of the tally means something.
                tally.moving = tally.moving - before + flow.moving();
                tally.particle_moves = tally.particle_moves.saturating_add(moved.moves);
                self.count(moved.eroded, &moved.stranded, state);
            }
            (Mover::Expected(flow), Passive::Expected(expected)) => {
                flow.step(network, &self.shares, expected);
                self.count_expected(None, state);
            }
            _ => unreachable!("the mover was made for this state"),
        }
    }

    /// [`Self::step`] after `one_by_one`, which neither reads nor changes passive particles: beside it where
    /// both take long enough for two threads.
    pub fn step_beside(
        &mut self,
        network: &Network,
        state: &mut State,
        one_by_one: impl FnOnce(&mut State) + Send,
    ) {
        let moving: u64 = state.particles.live.iter().map(|&live| u64::from(live)).sum();
        let is_long = network.voids() >= WORTH_A_THREAD && moving >= WORTH_A_THREAD as u64;
        match (&mut self.mover, &mut state.passive) {
            (Mover::Expected(flow), passive @ Passive::Expected(_))
                if is_long && rayon::current_num_threads() > 1 =>
            {
                let mut apart = std::mem::replace(passive, Passive::OneByOne);
                let shares = &self.shares;
                let step = || match &mut apart {
                    Passive::Expected(expected) => flow.step(network, shares, expected),
                    _ => unreachable!("it was taken from the state"),
                };
                rayon::join(|| one_by_one(state), step);
                state.passive = apart;
                self.count_expected(None, state);
            }
            _ => {
                one_by_one(state);
                self.step(network, state);
            }
        }
    }

    /// Adds the particles that left and those that stay in voids to the tally, with drawn sizes.
    fn count(&self, eroded: u64, stranded: &[(u32, u64)], state: &mut State) {
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
            if let Some(cubes) = state.retained_cubes.get_mut(void as usize) {
                *cubes += self.sizes.mass(n);
            }
        }
    }

    /// Adds the rounded expectation to the tally; `trapped` as in [`Expected::count`].
    fn count_expected(&self, trapped: Option<f64>, state: &mut State) {
        let (Mover::Expected(flow), Passive::Expected(expected)) = (&self.mover, &mut state.passive) else {
            return;
        };
        let [before, now] =
            expected.count((flow.holding(), flow.rests()), trapped, &mut state.retained_in_voids);
        let [retained, retained_now] = [before, now].map(|counted| counted.at_rest - counted.eroded);
        let tally = &mut state.tally;
        tally.particle_moves = tally.particle_moves.saturating_add(now.moves - before.moves);
        // The earlier count is taken off first: the sums may come near 2^64.
        tally.eroded = tally.eroded - before.eroded + now.eroded;
        tally.passive_eroded = now.eroded;
        tally.eroded_mass += self.sizes.mass(now.eroded) - self.sizes.mass(before.eroded);
        tally.retained_in_voids = tally.retained_in_voids - retained + retained_now;
        tally.moving = tally.moving + before.at_rest - now.at_rest;
        self.sizes.expect(before.eroded, now.eroded, &mut state.eroded_sizes);
        self.sizes.expect(retained, retained_now, &mut state.retained_sizes);
        let largest = self.sizes.median_largest(now.eroded).unwrap_or(0.0);
        tally.largest_eroded = tally.largest_eroded.max(largest);
    }

    /// Renews a void with exits that have closed, or lead elsewhere.
    pub fn set(&mut self, network: &Network, of_void: VoidExits) {
        self.shares.set(network, of_void);
        if let Mover::Expected(flow) = &mut self.mover {
            flow.set(network, &self.shares, of_void.void);
        }
    }

    /// Forgets the trap once exits lead elsewhere: who is trapped is not known any more.
    pub fn forget_trap(&mut self) {
        self.trap = None;
    }

    /// Tells if every moving passive particle is trapped; to be asked when everything is inserted and nothing
    /// can block any more.
    pub fn all_trapped(&mut self, network: &Network, state: &mut State) -> bool {
        let trapped = match &state.passive {
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
                if expected.surely_moves(&trap.leads_out) {
                    return false;
                }
                let (mut free, mut trapped) = (0.0, 0.0);
                for (&n, &out) in expected.moving.iter().zip(&trap.leads_out) {
                    if out { free += n } else { trapped += n }
                }
                (free < 0.5).then_some(trapped)
            }
        };
        if trapped.is_some() {
            self.count_expected(trapped, state);
        }
        trapped.is_some()
    }
}

/// The stream of the passive particles in this increment.
fn passive_key(state: &State) -> Key {
    let purpose = Purpose::Passive;
    Key { seed: state.seed, purpose, run: state.run, increment: state.increment, chunk: 0 }
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

/// Voids from which open constrictions lead to an end, or to a void without open constrictions.
fn leads_out(network: &Network, open: impl Fn(usize) -> bool) -> Vec<bool> {
    let ends = |void: &u32| {
        let mut exits = network.exits(*void).filter(|&c| open(c)).peekable();
        exits.peek().is_none() || exits.any(|c| network.targets()[c] == END)
    };
    network.leading_to((0..network.voids() as u32).filter(ends).collect(), open)
}

#[cfg(test)]
mod tests;
