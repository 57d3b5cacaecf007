//! Directions of constrictions, where water decides: when the flow is solved again, and its solutions.
//!
//! The flow is solved before the first increment, and at the beginning of an increment once the constrictions
//! that have closed since the last time carried more of it than a tolerance: the sum over them of flux over
//! inflow, which is how many of them a particle meets on its way, on average
//! ([`Network::with_flow_tolerance`]). Where blocked constrictions leave openings, a constriction counts by
//! the part of its conductance that it has lost. Where anything has closed it is solved after ten increments
//! at the latest, so that no particle waits longer before ways that have closed, and once more at the end. In
//! between directions stay as they are, and a particle in a void whose exits have all been blocked since
//! waits where it is. When to solve follows from the history of changes alone, so a walk that continues from
//! a checkpoint repeats the earlier solutions and gives directions each time, in the same order, to the same
//! bits.

use bitvec::slice::BitSlice;
use bitvec::vec::BitVec;

use super::State;
use super::openings::{CONDUCTS, Narrowing, Openings, Weighed, part_kept};
use crate::network::{ExitRule, Flow, FlowError, Network};

/// Increments after which the flow is solved again where anything has closed since.
const INCREMENTS: u64 = 10;

/// Fall of the permeability in a run.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct FlowRecord {
    /// Permeability of the filter before anything was blocked (mm2), where the network knows its lengths.
    pub k0_mm2: Option<f64>,
    /// Each time that the flow was solved.
    pub solutions: Vec<FlowSolution>,
}

/// A solution of the flow.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FlowSolution {
    /// Increments that were done.
    pub increment: u64,
    /// Permeability over the permeability of the clean filter.
    pub k_over_k0: f64,
    /// Part of the inflow that went through constrictions which had closed since the solution before, summed
    /// over the filter.
    pub closed: f64,
}

pub(super) struct Directions {
    flow: Flow,
    record: FlowRecord,
    /// Flow through the clean filter.
    clean: f64,
    /// Last increment before the flow was solved.
    solved_at: u64,
    /// Constrictions blocked or narrowed in this run until then.
    changes_then: usize,
    /// Number of changes since, and the flow that they carried, over the inflow.
    since: (usize, f64),
    /// By exit, as wide as it was then, where blocked constrictions leave openings.
    widths_then: Vec<f32>,
    rule: ExitRule,
}

/// Blocked constrictions, and the widths of the exits where openings are left.
type Passable<'a> = (&'a BitSlice, Option<&'a Openings>);

/// Constrictions at an earlier time of the run of a state.
struct Past<'a> {
    state: &'a State,
    blocked: BitVec,
    openings: Option<Openings>,
}

impl<'a> Past<'a> {
    /// State of the constrictions when the run began.
    fn begin(network: &Network, state: &'a State) -> Self {
        let mut past = Self { state, blocked: state.blocked.clone(), openings: state.openings.clone() };
        (0..state.changes()).rev().for_each(|at| past.set(network, at, false));
        past
    }

    /// Makes a change of the run, or takes it back.
    fn set(&mut self, network: &Network, at: usize, is_done: bool) {
        match &mut self.openings {
            Some(openings) => {
                let Narrowing { constriction, before, after, .. } = openings.history[at];
                openings.set(network, constriction as usize, if is_done { after } else { before });
            }
            None => {
                let exit = self.state.history[at].constriction as usize;
                network.set_blocked(&mut self.blocked, exit, is_done);
            }
        }
    }

    fn increment(&self, at: usize) -> u64 {
        match &self.openings {
            Some(openings) => openings.history[at].increment,
            None => self.state.history[at].increment,
        }
    }

    fn passable(&self) -> Passable<'_> {
        (&self.blocked, self.openings.as_ref())
    }
}

impl Directions {
    /// Directions that `state` has come to, by all blocking until now; sets them in the network.
    pub fn new(network: &mut Network, state: &State) -> Result<Self, FlowError> {
        let clean_filter: BitVec = BitVec::repeat(false, network.constrictions());
        let mut flow = Flow::new(network);
        let clean = flow.solve(network, &clean_filter)?;
        let mut directions = Self {
            flow,
            record: FlowRecord { k0_mm2: clean.k_mm2, solutions: vec![] },
            clean: clean.conductance,
            solved_at: 0,
            changes_then: 0,
            since: (0, 0.0),
            widths_then: Vec::new(),
            rule: network.exit_rule(),
        };
        let mut past = Past::begin(network, state);
        directions.solve(network, past.passable(), 0, 0)?;
        directions.flow.direct(network);
        // Exits blocked since the flow was solved last lead on once it is solved again.
        let mut so_far = 0;
        for increment in 1..=state.increment {
            while so_far < state.changes() && past.increment(so_far) < increment {
                past.set(network, so_far, true);
                so_far += 1;
            }
            if directions.is_due(network, state, increment, so_far) {
                directions.solve(network, past.passable(), increment - 1, so_far)?;
                directions.flow.direct(network);
            }
        }
        Ok(directions)
    }

    /// Widths that the weights of exits refer to, where blocked constrictions leave openings.
    pub fn weighed(&self) -> Weighed<'_> {
        match self.rule {
            ExitRule::Flux => Weighed::Solved(&self.widths_then, CONDUCTS),
            _ => Weighed::Whole,
        }
    }

    /// Tells if the flow is to be solved at the beginning of an increment, after this many changes of this
    /// run.
    fn is_due(&mut self, network: &Network, state: &State, increment: u64, changes: usize) -> bool {
        self.count(network, state, changes);
        let is_late = increment > self.solved_at + INCREMENTS;
        changes > self.changes_then && (is_late || self.since.1 >= network.flow_tolerance())
    }

    /// Counts the closures since the flow was solved, up to this many changes of this run.
    fn count(&mut self, network: &Network, state: &State, changes: usize) {
        let (counted, mut carried) = self.since;
        for at in self.changes_then + counted..changes {
            carried += self.carried(network, state, at);
        }
        self.since = (changes - self.changes_then, carried);
    }

    /// The part of the inflow that no longer goes through a constriction after a change of the run.
    fn carried(&self, network: &Network, state: &State, at: usize) -> f64 {
        match &state.openings {
            None => self.flow.share(state.history[at].constriction as usize),
            Some(openings) => {
                let change = &openings.history[at];
                let exit = change.constriction as usize;
                let whole = f64::from(network.diameters()[exit]);
                let [before, after, then] = [change.before, change.after, self.widths_then[exit]]
                    .map(|width| part_kept(f64::from(width) / whole, CONDUCTS));
                let lost = if then > 0.0 { (before - after) / then } else { 0.0 };
                self.flow.share(exit) * lost
            }
        }
    }

    /// Solves the flow if the increment that `state` begins is due for it, and gives the network its
    /// directions; tells if it did.
    pub fn renew(&mut self, network: &mut Network, state: &State) -> Result<bool, FlowError> {
        let changes = state.changes();
        let is_due = self.is_due(network, state, state.increment, changes);
        if is_due {
            self.solve(network, (&state.blocked, state.openings.as_ref()), state.increment - 1, changes)?;
            self.flow.direct(network);
        }
        Ok(is_due)
    }

    /// The flow at the end of a run; the network is given its directions.
    pub fn end(mut self, network: &mut Network, state: &State) -> Result<FlowRecord, FlowError> {
        let changes = state.changes();
        if changes > self.changes_then {
            self.count(network, state, changes);
            self.solve(network, (&state.blocked, state.openings.as_ref()), state.increment, changes)?;
        }
        self.flow.direct(network);
        Ok(self.record)
    }

    fn solve(
        &mut self,
        network: &Network,
        passable: Passable,
        increment: u64,
        changes: usize,
    ) -> Result<(), FlowError> {
        let solution = match passable {
            (blocked, None) => self.flow.solve(network, blocked)?,
            (_, Some(Openings { widths, .. })) => {
                let part = |(&width, &whole): (&f32, &f32)| {
                    if whole > 0.0 { part_kept(f64::from(width) / f64::from(whole), CONDUCTS) } else { 0.0 }
                };
                let parts: Vec<f64> = widths.iter().zip(network.diameters()).map(part).collect();
                self.widths_then.clone_from(widths);
                self.flow.solve_parts(network, &parts)?
            }
        };
        let part = if self.clean > 0.0 { (solution.conductance / self.clean).min(1.0) } else { 0.0 };
        self.record.solutions.push(FlowSolution { increment, k_over_k0: part, closed: self.since.1 });
        (self.solved_at, self.changes_then, self.since) = (increment, changes, (0, 0.0));
        Ok(())
    }
}
