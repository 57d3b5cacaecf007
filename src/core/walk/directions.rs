//! Directions of constrictions set by water: solutions of the flow, and when it is solved again.
//!
//! The flow is solved before the first increment, and again at the beginning of an increment once the
//! constrictions closed since the last solution carried more of it than a tolerance. The criterion is the
//! sum over them of flux divided by inflow: the mean number of them that a particle meets on its way
//! ([`Network::with_flow_tolerance`]). If blocked constrictions leave openings, a constriction counts by
//! the fraction of its conductance that it has lost. If any constriction has closed, the flow is solved
//! after at most ten increments, which limits the waiting of particles, and once more at the end.
//! Directions do not change between solutions, and a particle waits in its void if all exits have been
//! blocked since the last one. The times of solution follow only from the history of changes, so a walk
//! that continues from a checkpoint repeats the earlier solutions in the same order, to the same bits.

use bitvec::slice::BitSlice;
use bitvec::vec::BitVec;

use super::State;
use super::openings::{CONDUCTS, Narrowing, Openings, Weighed, part_kept};
use crate::network::{ExitRule, Flow, FlowError, Network};

/// Number of increments after which the flow is solved again, if any constriction has closed since.
const INCREMENTS: u64 = 10;

/// Decline of permeability in a run.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct FlowRecord {
    /// Permeability of the clean filter (mm2), if the lengths of the network are known.
    pub k0_mm2: Option<f64>,
    /// All solutions of the flow.
    pub solutions: Vec<FlowSolution>,
}

/// Solution of the flow.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FlowSolution {
    /// Number of completed increments.
    pub increment: u64,
    /// Permeability divided by that of the clean filter.
    pub k_over_k0: f64,
    /// Sum of the fluxes, as fractions of the inflow, of the constrictions that have closed since the
    /// previous solution.
    pub closed: f64,
}

pub(super) struct Directions {
    flow: Flow,
    record: FlowRecord,
    /// Flow through the clean filter.
    clean: f64,
    /// Last increment before the last solution.
    solved_at: u64,
    /// Number of blockings or narrowings in this run until then.
    changes_then: usize,
    /// Number of changes since, and the flow that they carried, divided by the inflow.
    since: (usize, f64),
    /// Widths of exits at that time, if blocked constrictions leave openings.
    widths_then: Vec<f32>,
    rule: ExitRule,
}

/// Blocked constrictions, and the openings if any are left.
type Passable<'a> = (&'a BitSlice, Option<&'a Openings>);

/// Constrictions at an earlier time of a run.
struct Past<'a> {
    state: &'a State,
    blocked: BitVec,
    openings: Option<Openings>,
}

impl<'a> Past<'a> {
    /// Creates the constrictions at the start of the run.
    fn begin(network: &Network, state: &'a State) -> Self {
        let mut past = Self { state, blocked: state.blocked.clone(), openings: state.openings.clone() };
        (0..state.changes()).rev().for_each(|at| past.set(network, at, false));
        past
    }

    /// Makes or reverts a change of the run.
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
    /// Computes the directions for the history of `state` and sets them in the network.
    pub(crate) fn new(network: &mut Network, state: &State) -> Result<Self, FlowError> {
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
        // Exits blocked since the last solution keep their direction until the next.
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

    /// Widths to which the weights of exits refer, if blocked constrictions leave openings.
    pub(crate) fn weighed(&self) -> Weighed<'_> {
        match self.rule {
            ExitRule::Flux => Weighed::Solved(&self.widths_then, CONDUCTS),
            _ => Weighed::Whole,
        }
    }

    /// Tells if the flow must be solved at the beginning of an increment, after this many changes of this
    /// run.
    fn is_due(&mut self, network: &Network, state: &State, increment: u64, changes: usize) -> bool {
        self.count(network, state, changes);
        let is_late = increment > self.solved_at + INCREMENTS;
        changes > self.changes_then && (is_late || self.since.1 >= network.flow_tolerance())
    }

    /// Counts the closures since the last solution, up to this many changes of this run.
    fn count(&mut self, network: &Network, state: &State, changes: usize) {
        let (counted, mut carried) = self.since;
        for at in self.changes_then + counted..changes {
            carried += self.carried(network, state, at);
        }
        self.since = (changes - self.changes_then, carried);
    }

    /// Fraction of the inflow that no longer passes a constriction after a change of the run.
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

    /// Solves the flow and sets the directions of the network, if due in the increment that `state`
    /// begins; returns true if it did.
    pub(crate) fn renew(&mut self, network: &mut Network, state: &State) -> Result<bool, FlowError> {
        let changes = state.changes();
        let is_due = self.is_due(network, state, state.increment, changes);
        if is_due {
            self.solve(network, (&state.blocked, state.openings.as_ref()), state.increment - 1, changes)?;
            self.flow.direct(network);
        }
        Ok(is_due)
    }

    /// Solves the flow at the end of a run and sets the directions of the network.
    pub(crate) fn end(mut self, network: &mut Network, state: &State) -> Result<FlowRecord, FlowError> {
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
