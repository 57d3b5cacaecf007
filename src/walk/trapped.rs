//! Trapped particles, found exactly.
//!
//! A moving particle is trapped when, through open constrictions that it fits, it can reach no end, no
//! open constriction finer than it (that would stop it) and no void without open exits. When every
//! moving particle is trapped nothing can change any more, so the run ends there, not at a limit of steps.
//!
//! One particle that is not trapped is enough to go on, so the search is cheap while a run is alive.

use std::collections::HashSet;

use super::State;
use crate::network::{END, Network};

/// A search that remembers where the last particle that is not trapped was found.
pub(super) struct Search {
    /// Mark of the voids seen by the search that set it.
    seen: Vec<u32>,
    mark: u32,
    stack: Vec<u32>,
    hint: usize,
}

impl Search {
    pub fn new(network: &Network) -> Self {
        Self { seen: vec![0; network.voids()], mark: 0, stack: Vec::new(), hint: 0 }
    }

    /// Whether every moving particle is trapped.
    pub fn all_trapped(&mut self, network: &Network, state: &State) -> bool {
        let chunks = state.particles.live.len();
        let mut known = HashSet::new();
        for chunk in (self.hint..chunks).chain(0..self.hint) {
            let (void, diameter) = state.particles.chunk(chunk);
            for (&void, &diameter) in void.iter().zip(diameter) {
                // Passive particles fit everywhere: what holds for one holds for all.
                let size = if diameter <= state.passive_limit { 0.0 } else { diameter };
                if known.contains(&(void, size.to_bits())) {
                    continue;
                }
                if !self.is_trapped(network, state, void, size) {
                    self.hint = chunk;
                    return false;
                }
                known.insert((void, size.to_bits()));
            }
        }
        true
    }

    fn is_trapped(&mut self, network: &Network, state: &State, void: u32, diameter: f32) -> bool {
        self.mark = self.mark.checked_add(1).unwrap_or_else(|| {
            self.seen.fill(0);
            1
        });
        self.stack.clear();
        self.stack.push(void);
        self.seen[void as usize] = self.mark;
        while let Some(void) = self.stack.pop() {
            let mut open_exits = 0;
            for exit in network.exits(void).filter(|&c| !state.is_closed(network, c)) {
                open_exits += 1;
                let target = network.targets()[exit];
                if network.diameters()[exit] < diameter || target == END {
                    return false;
                }
                if self.seen[target as usize] != self.mark {
                    self.seen[target as usize] = self.mark;
                    self.stack.push(target);
                }
            }
            if open_exits == 0 {
                return false;
            }
        }
        true
    }
}
