//! Walk: base particles move from void to void until each is eroded or retained.
//!
//! # An increment (the paper's Fig. 3)
//! 1. *Insert* this increment's share of the base, each particle on a start node drawn uniformly.
//! 2. *Step*: every moving particle picks one of its void's exits that was open when the increment
//!    began, with probability proportional to diameter squared (Fig. 4). A particle no coarser than
//!    the constriction moves through it; a coarser one is retained, and blocks that constriction
//!    from the next increment on. A particle in a void without open exits is retained in the void.
//! 3. *Merge*: the constrictions blocked in this increment close. All choices use the exits open at the
//!    start of the increment, so the order of the particles does not matter.
//! 4. *Tally*: counts are integers and their sum is checked; masses are sums of diameter cubed, added in
//!    chunk order.
//!
//! # Chunks and streams
//! Base particle `i` of a run, counted in order of insertion, belongs to chunk `i / CHUNK` throughout. A
//! chunk keeps its moving particles contiguous, in order of insertion: gaps of those that leave are
//! closed, newly inserted ones are appended. In increment `t` the `j`-th moving particle of chunk `c`
//! takes sixteen-bit draw `j` of the stream (seed, step, run, `t`, `c`), extended to 64 bits if sixteen do
//! not decide; the `k`-th particle inserted into the chunk in that increment takes words `2 k` (start
//! node) and `2 k + 1` (diameter) of (seed, insertion, run, `t`, `c`). None of this depends on threads, so
//! results are the same to the bit for any number of them, and a walk can continue from its columns alone.
//!
//! Start nodes and sizes are drawn independently, as in the paper, or spread evenly
//! ([`Sampling::Stratified`]): the marginal distribution of each particle is the same, and replicates
//! scatter less.
//!
//! # Exit choice
//! With `c_e` the sum of open areas up to exit `e` and `c` the total, the exit chosen is the first whose
//! `floor(2^64 c_e / c)` exceeds the 64-bit draw, otherwise the last open exit. The probability of a
//! closed exit is exactly 0.
//!
//! # Clogging
//! If the scene names a law of arching, a particle that fits may jam (module `arching`). Particles that jam
//! in one constriction in one increment form one arch: step 3 keeps as many as the arch holds (module
//! `chunks`) and lets the others pass. If the scene asks for it, a blocked constriction leaves openings
//! (module `openings`) that finer particles pass and that stop coarser ones; step 3 then narrows them.
//!
//! # The end
//! A run ends when nothing moves, or when every moving particle is *trapped*: x and y are periodic, so a
//! particle can move in closed loops for ever.
//!
//! # Engines
//! Passive particles may be followed as one count per void instead ([`RunPlan`], module `counts`): each
//! increment then also inserts and splits counts, with the same open exits, before the merge.
//! [`Engine::Auto`] uses counts unless particles are few. It decides by numbers, never by timing, so a seed
//! gives the same bits everywhere.
//!
//! # Memory
//! Particle columns take 8 bytes per particle. [`State::placed`] puts them into mapped files if they do
//! not fit in memory; the bits are the same.

mod arching;
mod chunks;
mod counts;
mod directions;
mod engine;
mod exits;
mod insert;
mod kernel;
mod openings;
pub mod reference;
mod retention;
mod saved;
mod state;
mod supply;
mod tally;

pub use arching::{Arching, DENSEST, LAWS, Law, LawName};
pub(crate) use counts::ExpectedSums;
pub use counts::{Expected, Passive};
pub use directions::{FlowRecord, FlowSolution};
pub use engine::{Engine, Finest, Isa, RunPlan, Shortcut, threads};
use exits::ExitTable;
pub(crate) use openings::Openings;
pub use openings::{BlockedAs, Clogged, Narrowing, residual_opening};
pub use retention::Retention;
pub use saved::{SavedState, from_words};
pub(crate) use state::Particles;
pub use state::{Blocking, CHUNK, State};
pub use supply::{Sampling, Supply};
pub use tally::{SizeClasses, SizeCounts, Tally, WalkError};

use std::borrow::Cow;
use std::collections::HashSet;
use std::sync::Arc;

use bitvec::slice::BitSlice;
use bitvec::vec::BitVec;

use crate::network::{END, FlowError, Network};
use chunks::Events;
use directions::Directions;
use openings::Ways;

/// Decision after an increment.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum WalkControl {
    /// Continue the walk.
    Continue,
    /// Stop the walk.
    Stop,
}

/// Callback after each increment, for recording, progress and requests to stop.
type Observer<'a> = dyn FnMut(&State) -> WalkControl + Send + 'a;

/// Run in progress: data rebuilt from network and state, never stored.
pub struct Walk<'a> {
    /// Owned copy if water sets the directions of constrictions.
    network: Cow<'a, Network>,
    /// Network as given, if its exits must outlive the walk.
    kept: Option<&'a Arc<Network>>,
    directions: Option<Directions>,
    /// Reason why the flow is unknown.
    no_flow: Option<FlowError>,
    supply: &'a Supply,
    table: ExitTable,
    events: Vec<Events>,
    trap: Search,
    /// True if every particle walked one by one is trapped, or there are none.
    all_caught: bool,
    passive: Option<counts::PassiveWalk<'a>>,
}

/// Exit tables that depend only on the blocked set: computed once for the first runs of many walks, or
/// passed from a run to the next. They keep their network alive, so that no other reuses its address.
#[derive(Clone)]
pub struct PlainExits {
    network: Arc<Network>,
    blocked: BitVec,
    table: ExitTable,
    /// Shares of passive particles by exit, if there are passive particles.
    shares: Option<counts::Shares>,
}

type WalkEnd<'a> = (Cow<'a, Network>, Option<FlowRecord>, Option<PlainExits>);

impl PlainExits {
    /// Exits of this network with nothing blocked.
    pub fn unblocked(network: &Arc<Network>) -> Self {
        let blocked = BitVec::repeat(false, network.constrictions());
        let (table, shares) = Self::work_out(network, &blocked, true);
        Self { network: network.clone(), blocked, table, shares }
    }

    /// Computes the exits left open by `blocked`, with or without the shares of passive particles.
    fn work_out(
        network: &Network,
        blocked: &BitSlice,
        with_shares: bool,
    ) -> (ExitTable, Option<counts::Shares>) {
        let (ways, voids) = (Ways::Unblocked(blocked), 0..network.voids() as u32);
        let finest = network.shape().map(|_| network.finest_open(|c| blocked[c]));
        let mut table = ExitTable::empty(network, finest);
        let mut shares = with_shares.then(|| counts::Shares::empty(network));
        exits::of_each(network, ways, voids, |of_void| {
            table.set(network, ways, of_void);
            if let Some(shares) = &mut shares {
                shares.set(network, of_void);
            }
        });
        (table, shares)
    }

    fn again(self) -> (ExitTable, Option<counts::Shares>) {
        let Self { network, blocked, mut table, shares } = self;
        if blocked.any() {
            table.class_anew(&network, &blocked);
        }
        (table, shares)
    }
}

impl<'a> Walk<'a> {
    /// Prepares a walk that continues from `state`.
    pub fn new(network: &'a Network, supply: &'a Supply, state: &State) -> Self {
        Self::prepare(network, supply, state, None)
    }

    /// Prepares like [`Walk::new`], with known exits. They are recomputed if they belong to another
    /// network or state, or if paths depend on more than the blocked set.
    pub fn with_exits(
        network: &'a Arc<Network>,
        supply: &'a Supply,
        state: &State,
        known: Option<Cow<PlainExits>>,
    ) -> Self {
        let known = known.filter(|k| Arc::ptr_eq(&k.network, network) && k.blocked == state.blocked);
        Self { kept: Some(network), ..Self::prepare(network, supply, state, known) }
    }

    fn prepare(
        network: &'a Network,
        supply: &'a Supply,
        state: &State,
        known: Option<Cow<PlainExits>>,
    ) -> Self {
        let mut network = Cow::Borrowed(network);
        let (mut directions, mut no_flow) = (None, None);
        if network.exit_rule().needs_flow() {
            match Directions::new(network.to_mut(), state) {
                Ok(solved) => directions = Some(solved),
                Err(error) => no_flow = Some(error),
            }
        }
        let ways = state.ways(directions.as_ref().and_then(Directions::weighed));
        let (table, shares) = match (supply.arching(), &state.openings) {
            (None, None) => match known.filter(|_| !network.exit_rule().needs_flow()) {
                Some(known) => known.into_owned().again(),
                None => {
                    let with_shares = !matches!(state.passive, Passive::OneByOne);
                    PlainExits::work_out(&network, &state.blocked, with_shares)
                }
            },
            _ => (ExitTable::by_widths(&network, ways), None),
        };
        let trap = Search::new(&network, supply.arching());
        let passive = counts::PassiveWalk::new(&network, supply, state, shares);
        Self {
            network,
            kept: None,
            directions,
            no_flow,
            supply,
            table,
            events: Vec::new(),
            trap,
            all_caught: false,
            passive,
        }
    }

    /// Ends the walk; returns the network with its final directions, the decline of permeability if water
    /// sets them, and for a walk by [`Walk::with_exits`] the exits with which the next run may begin.
    ///
    /// # Errors
    /// [`WalkError::Flow`].
    pub fn end(self, state: &State) -> Result<WalkEnd<'a>, WalkError> {
        let Self { mut network, kept, directions, no_flow, supply, table, passive, .. } = self;
        let error = |source| WalkError::Flow { increment: state.increment, source };
        if let Some(source) = no_flow {
            return Err(error(source));
        }
        let end = |directions: Directions| directions.end(network.to_mut(), state).map_err(error);
        let record = directions.map(end).transpose()?;
        let is_plain = !network.exit_rule().needs_flow() && state.openings.is_none();
        let kept = kept.filter(|_| is_plain && supply.arching().is_none());
        let exits = kept.map(|network| PlainExits {
            network: network.clone(),
            blocked: state.blocked.clone(),
            table,
            shares: passive.map(|passive| passive.shares),
        });
        Ok((network, record, exits))
    }

    /// Uses the instructions of `isa`, with the same results to the bit: for tests and measurements.
    ///
    /// # Panics
    /// If this machine does not support them.
    pub fn with_isa(mut self, isa: Isa) -> Self {
        assert!(isa.is_available(), "{isa:?} is not available on this machine");
        self.table.isa = isa;
        if let Some(passive) = &mut self.passive {
            passive.set_isa(isa);
        }
        self
    }

    /// Performs one increment, as in the paper's Fig. 3.
    ///
    /// # Errors
    /// [`WalkError::NotConserved`] if particles are lost or created; [`WalkError::Flow`].
    pub fn increment(&mut self, state: &mut State) -> Result<(), WalkError> {
        state.increment += 1;
        self.direct(state).map_err(|source| WalkError::Flow { increment: state.increment, source })?;
        self.insert_and_step(state);
        self.merge(state);
        self.tally(state)
    }

    fn direct(&mut self, state: &State) -> Result<(), FlowError> {
        if let Some(error) = self.no_flow.take() {
            return Err(error);
        }
        let Some(directions) = &mut self.directions else { return Ok(()) };
        if directions.renew(self.network.to_mut(), state)? {
            let Self { network, table, passive, directions, .. } = self;
            let ways = state.ways(directions.as_ref().and_then(Directions::weighed));
            let renew_passive = || {
                let Some(passive) = passive else { return };
                let voids = 0..network.voids() as u32;
                exits::of_each(network, ways, voids, |exits| passive.set(network, exits));
                passive.forget_trap();
            };
            rayon::join(|| table.renew(network, ways), renew_passive);
            self.trap = Search::new(&self.network, self.supply.arching());
            self.all_caught = false;
        }
        Ok(())
    }

    fn insert_and_step(&mut self, state: &mut State) {
        let Self { network, table, supply, events, passive, .. } = self;
        let mut one_by_one = |state: &mut State| kernel::step(network, table, supply, state, events);
        match passive {
            Some(passive) => {
                passive.insert(network, supply, state);
                passive.step(network, state, one_by_one);
            }
            None => one_by_one(state),
        }
    }

    /// Adds the events to the state; blocked constrictions close or are narrowed.
    fn merge(&mut self, state: &mut State) {
        let Self { network, table, events, passive, directions, .. } = self;
        let closed = chunks::merge(network, events, &table.upstream, state);
        let both = closed.iter().flat_map(|&c| [Some(c as usize), network.twin(c as usize)]);
        let voids: Vec<u32> = both.flatten().map(|c| table.upstream[c]).collect();
        let ways = state.ways(directions.as_ref().and_then(Directions::weighed));
        exits::of_each(network, ways, voids, |of_void| {
            table.set(network, ways, of_void);
            if let Some(passive) = passive {
                passive.set(network, of_void);
            }
        });
    }

    /// Determines if the run has ended, and checks that all inserted particles are accounted for.
    fn tally(&mut self, state: &mut State) -> Result<(), WalkError> {
        let inserting = state.increment < self.supply.increments();
        if !inserting && state.tally.moving > 0 && self.all_trapped(state) {
            state.tally.trapped += std::mem::take(&mut state.tally.moving);
        }
        state.finished = !inserting && state.tally.moving == 0;
        state.tally.check(state.increment)
    }

    /// Tells if every moving particle is trapped. Once all particles walked one by one are trapped,
    /// nothing can be blocked any more, so they stay trapped.
    fn all_trapped(&mut self, state: &mut State) -> bool {
        self.all_caught = self.all_caught || self.trap.all_trapped(&self.network, state);
        self.all_caught
            && self.passive.as_mut().is_none_or(|passive| passive.all_trapped(&self.network, state))
    }

    /// Performs increments until the run ends or `observe` stops it.
    ///
    /// # Errors
    /// Errors of [`Walk::increment`], and [`WalkError::Stopped`].
    pub fn run(&mut self, state: &mut State, observe: &mut Observer) -> Result<(), WalkError> {
        while !state.finished {
            self.increment(state)?;
            if observe(state) == WalkControl::Stop && !state.finished {
                return Err(WalkError::Stopped { increment: state.increment });
            }
        }
        Ok(())
    }
}

/// Search for a particle that is not trapped, which remembers the last way out.
///
/// A moving particle is trapped if, through open constrictions that it fits, it can reach neither the end,
/// nor a void without open exits, nor an open constriction that may stop it (finer than it, or so fine
/// that it may arch there). When all are trapped nothing can change, and the run ends. One that is not
/// trapped is enough to continue; its way out stays valid until a constriction closes, so that runs that
/// wait for it cost little.
struct Search {
    /// Number of the last search that saw each void.
    seen: Vec<u32>,
    mark: u32,
    /// Void from which a seen void was reached.
    came_from: Vec<u32>,
    stack: Vec<u32>,
    /// Voids on ways out that are valid for `known`.
    way_out: Vec<bool>,
    /// Number of blocked or narrowed constrictions and particle size for which `way_out` is valid.
    known: Option<(usize, u32)>,
    /// Chunk of the last particle found that is not trapped.
    hint: usize,
    /// Ratio of the size of a constriction to the finest particle that it may stop.
    stops_from: f64,
}

impl Search {
    pub(crate) fn new(network: &Network, arching: Option<&Arching>) -> Self {
        let voids = network.voids();
        Self {
            seen: vec![0; voids],
            mark: 0,
            came_from: vec![0; voids],
            stack: Vec::new(),
            way_out: vec![false; voids],
            known: None,
            hint: usize::MAX,
            stops_from: arching.map_or(1.0, Arching::stops_to),
        }
    }

    pub(crate) fn all_trapped(&mut self, network: &Network, state: &State) -> bool {
        let chunks = state.particles.live.len();
        let mut trapped = HashSet::new();
        // Starts with the last inserted particles: trapped ones remain and are at the front.
        let hint = self.hint.min(chunks.saturating_sub(1));
        for chunk in (0..chunks.min(hint + 1)).rev().chain((hint + 1..chunks).rev()) {
            let (void, diameter) = state.particles.chunk(chunk);
            for (&void, &diameter) in void.iter().zip(diameter).rev() {
                // Passive particles fit everywhere: the answer for one is valid for all.
                let size = if diameter <= state.passive_limit { 0.0 } else { diameter };
                if trapped.contains(&(void, size.to_bits())) {
                    continue;
                }
                if !self.is_trapped(network, state, void, size) {
                    self.hint = chunk;
                    return false;
                }
                trapped.insert((void, size.to_bits()));
            }
        }
        true
    }

    /// Searches depth first, downstream exits before sideways ones.
    fn is_trapped(&mut self, network: &Network, state: &State, start: u32, diameter: f32) -> bool {
        let key = Some((state.changes(), diameter.to_bits()));
        if self.known != key {
            self.way_out.fill(false);
            self.known = key;
        }
        self.mark = self.mark.checked_add(1).unwrap_or_else(|| {
            self.seen.fill(0);
            1
        });
        self.stack.clear();
        self.stack.push(start);
        self.seen[start as usize] = self.mark;
        while let Some(void) = self.stack.pop() {
            let mut closed = true;
            let mut leads_out = self.way_out[void as usize];
            for exit in network.exits(void).filter(|&c| !state.is_closed(network, c)) {
                closed = false;
                let target = network.targets()[exit];
                let stops = f64::from(state.width(network, exit)) < self.stops_from * f64::from(diameter);
                if stops || target == END {
                    leads_out = true;
                    break;
                }
                if self.seen[target as usize] != self.mark {
                    self.seen[target as usize] = self.mark;
                    self.came_from[target as usize] = void;
                    self.stack.push(target);
                }
            }
            if closed || leads_out {
                // The path from the start is a way out.
                let back = |&void: &u32| (void != start).then(|| self.came_from[void as usize]);
                std::iter::successors(Some(void), back).for_each(|void| self.way_out[void as usize] = true);
                return false;
            }
        }
        true
    }
}
