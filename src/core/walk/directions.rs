//! Directions of constrictions set by water: solutions of the flow, and when it is solved again.
//!
//! The flow is solved before the first increment, at the beginning of an increment once the constrictions
//! closed since the last solution carried more of it than a tolerance ([`Network::with_flow_tolerance`]), or
//! ten increments after the last solution if any has closed, which limits the waiting of particles, and at
//! the end. If blocked constrictions leave openings, a constriction counts by the fraction of its
//! conductance that it has lost. Directions do not change between solutions, and a particle waits in its
//! void if all exits have been blocked since the last one. The times of solution follow only from the
//! history of changes, so a walk that continues from a checkpoint repeats them, to the same bits.

use bitvec::slice::BitSlice;
use bitvec::vec::BitVec;

use super::State;
use super::openings::{CONDUCTS, Narrowing, Openings, part_kept};
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
    clean: f64,
    /// Last increment before the last solution.
    solved_at: u64,
    /// Number of blockings or narrowings in this run until then.
    changes_then: usize,
    /// Widths of exits at that time, if blocked constrictions leave openings.
    widths_then: Vec<f32>,
    rule: ExitRule,
}

type Passable<'a> = (&'a BitSlice, Option<&'a Openings>);

/// Constrictions at an earlier time of a run.
struct Past<'a> {
    state: &'a State,
    blocked: BitVec,
    openings: Option<Openings>,
}

impl<'a> Past<'a> {
    fn begin(network: &Network, state: &'a State) -> Self {
        let mut past = Self { state, blocked: state.blocked.clone(), openings: state.openings.clone() };
        (0..state.changes()).rev().for_each(|at| past.set(network, at, false));
        past
    }

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
            widths_then: Vec::new(),
            rule: network.exit_rule(),
        };
        let mut past = Past::begin(network, state);
        directions.solve(network, state, past.passable(), 0, 0)?;
        directions.flow.direct(network);
        // Exits blocked since the last solution keep their direction until the next.
        let mut so_far = 0;
        for increment in 1..=state.increment {
            while so_far < state.changes() && past.increment(so_far) < increment {
                past.set(network, so_far, true);
                so_far += 1;
            }
            if directions.is_due(network, state, increment, so_far) {
                directions.solve(network, state, past.passable(), increment - 1, so_far)?;
                directions.flow.direct(network);
            }
        }
        Ok(directions)
    }

    /// Widths in the last solution of the flow, if the weights of exits are its fluxes.
    pub(crate) fn weighed(&self) -> Option<&[f32]> {
        (self.rule == ExitRule::Flux).then_some(&self.widths_then)
    }

    /// Tells if the flow must be solved at the beginning of an increment, after this many changes of this
    /// run.
    fn is_due(&self, network: &Network, state: &State, increment: u64, changes: usize) -> bool {
        let is_late = increment > self.solved_at + INCREMENTS;
        let is_carried = || self.closed(network, state, changes) >= network.flow_tolerance();
        changes > self.changes_then && (is_late || is_carried())
    }

    /// Flow that has been closed since the last solution, up to this many changes of this run, divided by
    /// the inflow.
    fn closed(&self, network: &Network, state: &State, changes: usize) -> f64 {
        (self.changes_then..changes).fold(0.0, |sum, at| sum + self.carried(network, state, at))
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
        let (changes, passable) = (state.changes(), (&*state.blocked, state.openings.as_ref()));
        let is_due = self.is_due(network, state, state.increment, changes);
        if is_due {
            self.solve(network, state, passable, state.increment - 1, changes)?;
            self.flow.direct(network);
        }
        Ok(is_due)
    }

    /// Solves the flow at the end of a run and sets the directions of the network.
    pub(crate) fn end(mut self, network: &mut Network, state: &State) -> Result<FlowRecord, FlowError> {
        let (changes, passable) = (state.changes(), (&*state.blocked, state.openings.as_ref()));
        if changes > self.changes_then {
            self.solve(network, state, passable, state.increment, changes)?;
        }
        self.flow.direct(network);
        Ok(self.record)
    }

    fn solve(
        &mut self,
        network: &Network,
        state: &State,
        passable: Passable,
        increment: u64,
        changes: usize,
    ) -> Result<(), FlowError> {
        let closed = self.closed(network, state, changes);
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
        self.record.solutions.push(FlowSolution { increment, k_over_k0: part, closed });
        (self.solved_at, self.changes_then) = (increment, changes);
        Ok(())
    }
}
