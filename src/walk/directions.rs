//! Which way constrictions lead, where water decides: when the flow is solved again, and what it came to.
//!
//! The flow is solved before the first increment, and at the beginning of an increment when the constrictions
//! blocked since the last time are one in a hundred of all, or when there are any and ten increments have
//! gone by; and once more at the end. In between directions stay as they are, and a particle in a void whose
//! exits have all been blocked since waits where it is. When to solve follows from the history of blocking
//! alone, so a walk that continues from a checkpoint solves again what was solved before, in the same order,
//! to the same bits.

use bitvec::slice::BitSlice;
use bitvec::vec::BitVec;

use super::{Blocking, State};
use crate::network::{Flow, FlowError, Network};

/// The flow is solved again when one in so many constrictions has been blocked since the last time.
const PART_BLOCKED: u64 = 100;

/// The flow is solved again after so many increments in which anything was blocked.
const INCREMENTS: u64 = 10;

/// How the permeability fell in a run.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct FlowRecord {
    /// Permeability of the filter before anything was blocked (mm2), where the network knows its lengths.
    pub k0_mm2: Option<f64>,
    /// Increment, and permeability after it over that of the clean filter, each time that it was solved.
    pub k_over_k0: Vec<(u64, f64)>,
}

/// The directions of a walk.
pub(super) struct Directions {
    flow: Flow,
    record: FlowRecord,
    /// Flow through the clean filter.
    clean: f64,
    /// Last increment before the flow was solved.
    solved_at: u64,
    /// Constrictions blocked in this run until then.
    blocked_then: u64,
}

impl Directions {
    /// Those that `state` has come to, by all that has been blocked until now; the network is given them.
    pub fn new(network: &mut Network, state: &State) -> Result<Self, FlowError> {
        let mut blocked: BitVec = BitVec::repeat(false, network.constrictions());
        let mut flow = Flow::new(network);
        let clean = flow.solve(network, &blocked)?;
        let record = FlowRecord { k0_mm2: clean.k_mm2, k_over_k0: vec![] };
        let clean = clean.conductance;
        let mut directions = Self { flow, record, clean, solved_at: 0, blocked_then: 0 };
        blocked.copy_from_bitslice(&state.blocked);
        let set = |blocked: &mut BitVec, blocking: &Blocking, is| {
            network.set_blocked(blocked, blocking.constriction as usize, is);
        };
        state.history.iter().for_each(|blocking| set(&mut blocked, blocking, false));
        directions.solve(network, &blocked, 0, 0)?;
        // Exits blocked since the flow was solved last lead on once it is solved again.
        let mut history = state.history.iter().peekable();
        let mut so_far = 0;
        for increment in 1..=state.increment {
            while let Some(blocking) = history.next_if(|blocking| blocking.increment < increment) {
                so_far += 1;
                set(&mut blocked, blocking, true);
            }
            if directions.is_due(network, increment, so_far) {
                directions.solve(network, &blocked, increment - 1, so_far)?;
            }
        }
        directions.flow.direct(network);
        Ok(directions)
    }

    /// Whether the flow is to be solved at the beginning of an increment, after so many blockings of this
    /// run.
    fn is_due(&self, network: &Network, increment: u64, blocked: u64) -> bool {
        let since = blocked - self.blocked_then;
        since > 0
            && (since * PART_BLOCKED >= network.passages() as u64 || increment > self.solved_at + INCREMENTS)
    }

    /// Solves the flow where the increment that `state` begins is due for it; whether it did.
    pub fn renew(&mut self, network: &mut Network, state: &State) -> Result<bool, FlowError> {
        let blocked = state.history.len() as u64;
        if !self.is_due(network, state.increment, blocked) {
            return Ok(false);
        }
        self.solve(network, &state.blocked, state.increment - 1, blocked)?;
        self.flow.direct(network);
        Ok(true)
    }

    /// The flow at the end of a run; the network is given its directions.
    pub fn end(mut self, network: &mut Network, state: &State) -> Result<FlowRecord, FlowError> {
        let blocked = state.history.len() as u64;
        if blocked > self.blocked_then {
            self.solve(network, &state.blocked, state.increment, blocked)?;
        }
        self.flow.direct(network);
        Ok(self.record)
    }

    /// Solves the flow after an increment.
    fn solve(
        &mut self,
        network: &Network,
        blocked: &BitSlice,
        increment: u64,
        in_run: u64,
    ) -> Result<(), FlowError> {
        let found = self.flow.solve(network, blocked)?;
        let part = if self.clean > 0.0 { (found.conductance / self.clean).min(1.0) } else { 0.0 };
        self.record.k_over_k0.push((increment, part));
        (self.solved_at, self.blocked_then) = (increment, in_run);
        Ok(())
    }
}
