//! Trapped particles, found exactly.
//!
//! A moving particle is trapped when, through open constrictions that it fits, it can reach no end, no
//! open constriction finer than it or so fine that it may arch there (either would stop it), and no void
//! without open exits. When every moving particle is trapped nothing can change any more, so the run ends
//! there, not at a limit of steps.
//!
//! One particle that is not trapped is enough to go on. The way out that was found for it is remembered
//! while nothing closes, so that a run that waits for one particle costs next to nothing.

use std::collections::HashSet;

use super::{Arching, State};
use crate::network::{END, Network};

/// A search that remembers the last way out.
pub(super) struct Search {
    /// Mark of the voids seen by the search that set it.
    seen: Vec<u32>,
    mark: u32,
    /// Void from which a seen void was reached.
    came_from: Vec<u32>,
    stack: Vec<u32>,
    /// Voids on ways out that hold for `known`.
    way_out: Vec<bool>,
    /// Number of blocked or narrowed constrictions and particle size that `way_out` holds for.
    known: Option<(usize, u32)>,
    /// Chunk in which the last particle that is not trapped was found.
    hint: usize,
    /// Ratio of a constriction to the finest particle that it may stop.
    stops_from: f64,
}

impl Search {
    pub fn new(network: &Network, arching: Option<&Arching>) -> Self {
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

    /// Tells if every moving particle is trapped.
    pub fn all_trapped(&mut self, network: &Network, state: &State) -> bool {
        let chunks = state.particles.live.len();
        let mut trapped = HashSet::new();
        // The last that were inserted come first: trapped ones stay, and lie in front.
        let hint = self.hint.min(chunks.saturating_sub(1));
        for chunk in (0..chunks.min(hint + 1)).rev().chain((hint + 1..chunks).rev()) {
            let (void, diameter) = state.particles.chunk(chunk);
            for (&void, &diameter) in void.iter().zip(diameter).rev() {
                // Passive particles fit everywhere: an answer for one holds for all.
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

    /// Depth first, downstream exits before sideways ones.
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
                self.remember(start, void);
                return false;
            }
        }
        true
    }

    /// Marks the way from `start` to `last` as a way out.
    fn remember(&mut self, start: u32, last: u32) {
        let mut void = last;
        self.way_out[void as usize] = true;
        while void != start {
            void = self.came_from[void as usize];
            self.way_out[void as usize] = true;
        }
    }
}
