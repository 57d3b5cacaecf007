//! Passive particles as counts per void (engines `counts` and `expected`).
//!
//! A base particle no coarser than any constriction open at the start of the run is *passive*: it cannot
//! block anything, and voids have no capacity, so it affects no other particle. Coarser particles are
//! walked one by one as usual; their number in an increment is binomial, with the exact word limit of the
//! sampler as its probability. In each increment new passive particles are put on the start nodes
//! (multinomial), and the count of each void is split over the exits open at the start of the increment
//! (conditional binomials). The distribution equals that of the walk one by one, without approximation.
//!
//! # Streams
//! Increment `t` of run `r` draws the number of coarse particles from (seed, coarse share, `r`, `t`, 0),
//! the start nodes of the passive ones from (seed, passive, `r`, `t`, 2^64 - 1), the splits of block `b`
//! of voids from (seed, passive, `r`, `t`, `b`), and sizes of the passive particles eroded or retained
//! from (seed, passive size, `r`, `t`, 0).
//!
//! # Expected
//! Engine `expected` walks the same coarse particles and moves the expectation of the passive ones, given
//! that history. Integers are rounded from running sums. A run ends when the expected number of moving
//! particles that are not trapped is below 0.5.

mod binomial;
mod expected;
mod flow;
mod passive;
mod shares;

pub use passive::Expected;
pub(crate) use passive::ExpectedSums;
pub use passive::Passive;
pub(super) use passive::coarse_share;

use super::exits::VoidExits;
use super::openings::Ways;
use super::{Isa, State, Supply};
use crate::network::{END, Network};
use crate::stream::Purpose;
use binomial::Draws;
use expected::ExpectedFlow;
use flow::Flow;
use passive::PassiveSizes;
pub(super) use shares::Shares;

/// Number of voids with expectations, and of particles walked one by one, above which a second thread is
/// worth waking.
const WORTH_A_THREAD: usize = 1 << 14;

/// Data for moving the passive particles of a run; rebuilt from network and state, never stored.
pub(crate) struct PassiveWalk<'a> {
    sizes: PassiveSizes<'a>,
    pub(super) shares: Shares,
    mover: Mover,
    trap: Option<Trap>,
}

enum Mover {
    Counts(Flow),
    Expected(ExpectedFlow),
}

/// Voids that lead to the end or to a void without open exits; passive particles elsewhere are trapped.
struct Trap {
    /// Number of blocked constrictions for which this is valid.
    blocked: u64,
    leads_out: Vec<bool>,
}

impl<'a> PassiveWalk<'a> {
    /// Prepares to move the passive particles of `state`, with `known` shares of its open exits if given;
    /// `None` if all are walked one by one.
    pub(crate) fn new(
        network: &Network,
        supply: &'a Supply,
        state: &State,
        known: Option<Shares>,
    ) -> Option<Self> {
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

    pub(crate) fn set_isa(&mut self, isa: Isa) {
        match &mut self.mover {
            Mover::Counts(flow) => flow.isa = isa,
            Mover::Expected(flow) => flow.set_isa(isa),
        }
    }

    pub(crate) fn insert(&mut self, network: &Network, supply: &Supply, state: &mut State) {
        let inserted =
            supply.passive_inserted(state.increment) - supply.passive_inserted(state.increment - 1);
        let tally = &mut state.tally;
        tally.inserted += inserted;
        tally.passive_inserted += inserted;
        tally.inserted_mass += self.sizes.mass(inserted);
        tally.moving += inserted;
        let key = state.key(Purpose::Passive);
        match (&mut self.mover, &mut state.passive) {
            (Mover::Counts(flow), Passive::Counts(moving)) => {
                flow.insert(network, inserted, supply.is_stratified(), key, moving);
            }
            (_, Passive::Expected(expected)) => expected.insert(network, inserted),
            _ => unreachable!("the mover was made for this state"),
        }
    }

    /// Performs `one_by_one`, which neither reads nor changes passive particles, and moves these: in
    /// parallel if both take long enough.
    pub(crate) fn step(
        &mut self,
        network: &Network,
        state: &mut State,
        one_by_one: impl FnOnce(&mut State) + Send,
    ) {
        const OTHER: &str = "the mover was made for this state";
        let moving: u64 = state.particles.live.iter().map(|&live| u64::from(live)).sum();
        let is_long = network.voids() >= WORTH_A_THREAD && moving >= WORTH_A_THREAD as u64;
        let shares = &self.shares;
        match &mut self.mover {
            Mover::Counts(flow) => {
                one_by_one(state);
                let key = state.key(Purpose::Passive);
                let Passive::Counts(moving) = &mut state.passive else { unreachable!("{OTHER}") };
                let before = flow.moving;
                let moved = flow.step(network, shares, key, moving);
                // Counted afresh, so that the check of the tally is meaningful.
                let tally = &mut state.tally;
                tally.moving = tally.moving - before + flow.moving;
                tally.particle_moves = tally.particle_moves.saturating_add(moved.moves);
                self.count(moved.eroded, &moved.stranded, state);
            }
            Mover::Expected(flow) => {
                let mut apart = std::mem::replace(&mut state.passive, Passive::OneByOne);
                let Passive::Expected(expected) = &mut apart else { unreachable!("{OTHER}") };
                let mut step = || flow.step(network, shares, expected);
                if is_long && rayon::current_num_threads() > 1 {
                    rayon::join(|| one_by_one(state), step);
                } else {
                    one_by_one(state);
                    step();
                }
                state.passive = apart;
                self.count_expected(None, state);
            }
        }
    }

    /// Adds the particles that left or were retained in voids to the tally, with drawn sizes.
    fn count(&self, eroded: u64, stranded: &[(u32, u64)], state: &mut State) {
        let retained: u64 = stranded.iter().map(|&(_, n)| n).sum();
        if eroded == 0 && retained == 0 {
            return;
        }
        let mut draws = Draws::new(state.key(Purpose::PassiveSize));
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
            state.retain_cubes(void as usize, self.sizes.mass(n));
        }
    }

    /// Adds the rounded expectation to the tally; `trapped` as in [`Expected::count`].
    fn count_expected(&self, trapped: Option<f64>, state: &mut State) {
        let (Mover::Expected(flow), Passive::Expected(expected)) = (&self.mover, &mut state.passive) else {
            return;
        };
        let [before, now] =
            expected.count((&flow.holding, flow.rests), trapped, &mut state.retained_in_voids);
        let [retained, retained_now] = [before, now].map(|counted| counted.at_rest - counted.eroded);
        let tally = &mut state.tally;
        tally.particle_moves = tally.particle_moves.saturating_add(now.moves - before.moves);
        // The earlier count is subtracted first, as the sums may come near 2^64.
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

    pub(crate) fn set(&mut self, network: &Network, of_void: VoidExits) {
        self.shares.set(network, of_void);
        if let Mover::Expected(flow) = &mut self.mover {
            flow.set(network, &self.shares, of_void.void);
        }
    }

    pub(crate) fn forget_trap(&mut self) {
        self.trap = None;
    }

    /// Tells if every moving passive particle is trapped; called once everything is inserted and nothing
    /// can be blocked any more.
    pub(crate) fn all_trapped(&mut self, network: &Network, state: &mut State) -> bool {
        let trapped = match &state.passive {
            Passive::OneByOne => return true,
            Passive::Counts(moving) => {
                let Mover::Counts(flow) = &self.mover else { return false };
                if flow.moving == 0 {
                    return true;
                }
                let trap = Trap::renew(&mut self.trap, network, state);
                // Starts with the last voids, where the last particles are.
                return moving.iter().zip(&trap.leads_out).rev().all(|(&n, &out)| n == 0 || !out);
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

impl Trap {
    /// Returns the trap for the current open constrictions; none reopens, so the number of blocked ones
    /// identifies it.
    fn renew<'t>(known: &'t mut Option<Self>, network: &Network, state: &State) -> &'t Self {
        let blocked = state.tally.blocked;
        known.take_if(|trap| trap.blocked != blocked);
        known.get_or_insert_with(|| Self {
            blocked,
            leads_out: leads_out(network, |c| !state.is_closed(network, c)),
        })
    }
}

/// Voids from which open constrictions lead to the end or to a void without open constrictions.
fn leads_out(network: &Network, open: impl Fn(usize) -> bool) -> Vec<bool> {
    let ends = |void: &u32| {
        let mut exits = network.exits(*void).filter(|&c| open(c)).peekable();
        exits.peek().is_none() || exits.any(|c| network.targets()[c] == END)
    };
    network.leading_to((0..network.voids() as u32).filter(ends).collect(), open)
}

#[cfg(test)]
mod tests {
    use bitvec::vec::BitVec;

    use super::*;
    use crate::gradation::{Gradation, SizeSampler};
    use crate::stream::Key;
    use crate::walk::{Blocking, SizeClasses, Walk, WalkControl, exits};

    struct Flowed {
        eroded: Vec<f64>,
        /// Number moving in each void after increment [`LOOKED_AT`].
        moving: Vec<f64>,
        retained: Vec<f64>,
    }

    /// Increment after the last insertion, with many particles still moving.
    const LOOKED_AT: usize = 70;

    /// Expectation as the model is stated: areas of the exits open at the start of the increment, computed
    /// afresh for every void.
    fn expectation(network: &Network, history: &[Blocking], inserted: &[u64], increments: usize) -> Flowed {
        let mut closed = vec![false; network.constrictions()];
        let mut moving = vec![0.0; network.voids()];
        let mut flowed = Flowed {
            eroded: vec![0.0; increments],
            moving: Vec::new(),
            retained: vec![0.0; network.voids()],
        };
        for t in 1..=increments {
            for b in history.iter().filter(|b| b.increment + 1 == t as u64) {
                closed[b.constriction as usize] = true;
            }
            for &void in network.start() {
                let share = inserted.get(t - 1).copied().unwrap_or(0);
                moving[void as usize] += share as f64 / network.start().len() as f64;
            }
            let mut next = vec![0.0; network.voids()];
            for (void, &here) in moving.iter().enumerate() {
                let area = |c: usize| if closed[c] { 0.0 } else { f64::from(network.diameters()[c]).powi(2) };
                let exits = network.exits(void as u32);
                let total: f64 = exits.clone().map(area).sum();
                if total == 0.0 {
                    flowed.retained[void] += here;
                    continue;
                }
                for c in exits {
                    let n = here * area(c) / total;
                    match network.targets()[c] {
                        END => flowed.eroded[t - 1] += n,
                        target => next[target as usize] += n,
                    }
                }
            }
            moving = next;
            if t == LOOKED_AT {
                flowed.moving = moving.clone();
            }
        }
        flowed
    }

    /// Chi-square, as a z score, of counts against expectations of independent particles, each unlikely to
    /// be in any one cell.
    fn z_score(observed: &[u64], expected: &[f64]) -> f64 {
        let (mut square, mut cells, mut e, mut f) = (0.0, 0.0, 0.0, 0.0);
        for (&observed, &expected) in observed.iter().zip(expected) {
            e += expected;
            f += observed as f64;
            if e >= 20.0 {
                square += (f - e) * (f - e) / e;
                cells += 1.0;
                (e, f) = (0.0, 0.0);
            }
        }
        assert!(cells > 30.0, "{cells}");
        let part = 2.0 / (9.0 * cells);
        (libm::cbrt(square / cells) - (1.0 - part)) / f64::sqrt(part)
    }

    fn differences(sums: &[u64]) -> Vec<u64> {
        sums.iter().scan(0, |before, &sum| Some(sum - std::mem::replace(before, sum))).collect()
    }

    /// Compares passive particles of a walk one by one, and counts moved through the blocking history of
    /// that walk, with its expectation: eroded by increment, moving by void, and for counts retained by
    /// void. Bound 4 on seven z scores. With 1.5e6 particles an error of 1 % in a total is detected, and a
    /// scatter of about 10 % over the voids; an error of 20 % in one void is not.
    #[test]
    fn both_engines_follow_one_history() {
        let count = 3 * 12 * 12 * 20;
        let mut words =
            Draws::new(Key { seed: 3, purpose: Purpose::Network, run: 0, increment: 0, chunk: 0 });
        let diameters = (0..count).map(|_| 1.0 + (words.word() >> 40) as f32 / (1 << 24) as f32).collect();
        let network = Network::cubic_from_diameters([12, 12, 20], diameters, 1.0).unwrap();
        let base = Gradation::linear_from_d0(0.25, 2.7).unwrap();
        let sampler = SizeSampler::new(&base, 1.0).unwrap();
        let classes = SizeClasses::logarithmic(sampler.smallest(), sampler.largest(), 16);
        let open = BitVec::repeat(false, network.constrictions());

        let supply = Supply::new(sampler.clone(), 1_500_000, 60);
        let mut walked = State::new(&network, &supply, classes.clone(), open.clone(), 21, 1);
        let (mut inserted, mut eroded) = (Vec::new(), Vec::new());
        let mut moving = vec![0; network.voids()];
        let mut observe = |state: &State| {
            inserted.push(state.tally.passive_inserted);
            eroded.push(state.tally.passive_eroded);
            if state.increment == LOOKED_AT as u64 {
                for (voids, sizes) in
                    (0..state.particles.live.len()).map(|chunk| state.particles.chunk(chunk))
                {
                    let passive = voids.iter().zip(sizes).filter(|&(_, &d)| d <= state.passive_limit);
                    passive.for_each(|(&void, _)| moving[void as usize] += 1);
                }
            }
            WalkControl::Continue
        };
        Walk::new(&network, &supply, &walked).run(&mut walked, &mut observe).unwrap();
        let increments = eroded.len();
        let flowed = expectation(&network, &walked.history, &differences(&inserted), increments);
        let judge = |eroded: &[u64], moving: &[u64], flowed: &Flowed| {
            let total: f64 = flowed.eroded.iter().sum();
            let all = total + flowed.retained.iter().sum::<f64>();
            let sum: u64 = eroded.iter().sum();
            let z = [
                z_score(eroded, &flowed.eroded),
                z_score(moving, &flowed.moving),
                (sum as f64 - total) / (total * (1.0 - total / all)).sqrt(),
            ];
            assert!(z.iter().all(|z| z.abs() < 4.0), "{z:?}");
            // The tests have enough data.
            assert!(total > 5e4 && all - total > 5e4 && walked.history.len() > 500, "{total} {all}");
        };
        judge(&differences(&eroded), &moving, &flowed);

        let limit = sampler.word_limit(walked.passive_limit);
        let supply = Supply::new(sampler, 1_500_000, 60).with_passive_part(limit, false, 22, 1);
        let mut state = State::new(&network, &supply, classes, open, 22, 1);
        let mut passive = PassiveWalk::new(&network, &supply, &state, None).unwrap();
        let (mut inserted, mut eroded) = (Vec::new(), Vec::new());
        let upstream = network.upstream();
        for t in 1..=increments as u64 {
            state.increment = t;
            passive.insert(&network, &supply, &mut state);
            passive.step(&network, &mut state, |_| ());
            inserted.push(state.tally.passive_inserted);
            eroded.push(state.tally.passive_eroded);
            if let (LOOKED_AT, Passive::Counts(counts)) = (t as usize, &state.passive) {
                moving.clone_from(counts);
            }
            let closing = walked.history.iter().filter(|b| b.increment == t).map(|b| b.constriction);
            closing.clone().for_each(|c| state.blocked.set(c as usize, true));
            let voids = closing.map(|c| upstream[c as usize]);
            exits::of_each(&network, Ways::Unblocked(&state.blocked), voids, |exits| {
                passive.set(&network, exits)
            });
        }
        let flowed = expectation(&network, &walked.history, &differences(&inserted), increments);
        judge(&differences(&eroded), &moving, &flowed);
        // No coarse particles are walked here, so all retained particles are passive.
        let z = z_score(&state.retained_in_voids, &flowed.retained);
        assert!(z.abs() < 4.0, "{z}");

        // The expectation of the engine equals the slow one, to rounding.
        let mut expected = Expected::new(network.voids());
        let open = BitVec::<usize>::repeat(false, network.constrictions());
        let mut shares = Shares::new(&network, Ways::Unblocked(&open));
        let mut blocked: BitVec = BitVec::repeat(false, network.constrictions());
        let mut flow = ExpectedFlow::new(&network, &shares, &expected);
        for (t, n) in differences(&inserted).into_iter().enumerate() {
            expected.insert(&network, n);
            flow.step(&network, &shares, &mut expected);
            for b in walked.history.iter().filter(|b| b.increment == t as u64 + 1) {
                blocked.set(b.constriction as usize, true);
                let void = upstream[b.constriction as usize];
                exits::of_each(&network, Ways::Unblocked(&blocked), [void], |exits| {
                    shares.set(&network, exits)
                });
                flow.set(&network, &shares, void);
            }
        }
        let total: f64 = flowed.eroded.iter().sum();
        assert!((expected.sums.eroded / total - 1.0).abs() < 1e-9);
        for (a, b) in expected.retained.iter().zip(&flowed.retained) {
            assert!((a - b).abs() < 1e-9 * b + 1e-9);
        }
    }

    /// The largest possible count is exact to the last particle, and no intermediate sum is larger.
    #[test]
    fn the_most_particles_that_can_be_are_conserved() {
        let network = Network::cubic_from_diameters([3, 3, 4], vec![1.0; 108], 1.0).unwrap();
        let sampler = SizeSampler::new(&Gradation::linear_from_d0(0.2, 1.5).unwrap(), 1.0).unwrap();
        let classes = SizeClasses::logarithmic(sampler.smallest(), sampler.largest(), 4);
        for expected in [false, true] {
            let supply = Supply::new(sampler.clone(), u64::MAX, 4).with_passive_part(1 << 64, expected, 5, 1);
            let open = BitVec::repeat(false, network.constrictions());
            let mut state = State::new(&network, &supply, classes.clone(), open, 5, 1);
            Walk::new(&network, &supply, &state).run(&mut state, &mut |_| WalkControl::Continue).unwrap();
            assert_eq!((state.tally.inserted, state.tally.eroded), (u64::MAX, u64::MAX), "{expected}");
        }
    }
}
