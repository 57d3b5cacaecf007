//! Arches, once the particles of all chunks have attempted their move: which of the jammed particles stay.
//!
//! Particles that jammed in one constriction in one increment are one arch (module `arching`): the first in
//! the order of insertion says how many it has, and those beyond it pass the constriction after all. They are
//! in the void beyond it then, or have left the filter, and keep their place in the order of insertion.

use std::collections::HashMap;

use super::State;
use super::sizes::cube;
use super::state::Moving;
use crate::network::{END, Network};

/// A particle that jammed.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Jam {
    /// Particles of its chunk before it that still move.
    pub rank: u32,
    /// The exit that it chose.
    pub exit: u32,
    /// Its size.
    pub diameter: f32,
    /// Particles of the arch that it begins.
    pub particles: u32,
}

/// Keeps the arches of an increment and lets the others go on; the jams of all chunks are used up.
pub(super) fn settle<'a>(
    network: &Network,
    jams: impl Iterator<Item = &'a mut Vec<Jam>>,
    upstream: &[u32],
    state: &mut State,
) {
    // By constriction: room left in its arch.
    let mut room = HashMap::new();
    let mut released = Vec::new();
    for (chunk, jams) in jams.enumerate().filter(|(_, jams)| !jams.is_empty()) {
        for jam in jams.drain(..) {
            let exit = jam.exit as usize;
            let room = room.entry(network.either_way(exit)).or_insert_with(|| {
                state.tally.arches += 1;
                jam.particles
            });
            if *room > 0 {
                *room -= 1;
                keep(network, jam, upstream, state);
            } else if let Some(void) = release(network, jam, state) {
                released.push(Moving { rank: jam.rank as usize, void, diameter: jam.diameter });
            }
        }
        state.particles.put_back(chunk, &released);
        released.clear();
    }
}

/// Keeps a particle in its arch.
fn keep(network: &Network, jam: Jam, upstream: &[u32], state: &mut State) {
    let tally = &mut state.tally;
    tally.moving -= 1;
    tally.retained_in_constrictions += 1;
    tally.retained_in_arches += 1;
    tally.arched_mass += cube(jam.diameter);
    state.retained_sizes.add(&state.classes, jam.diameter);
    state.stop(network, upstream, jam.exit as usize, jam.diameter);
}

/// Lets a particle pass; returns the void that it is in then, unless it has left the filter.
fn release(network: &Network, jam: Jam, state: &mut State) -> Option<u32> {
    let tally = &mut state.tally;
    tally.particle_moves = tally.particle_moves.saturating_add(1);
    let target = network.targets()[jam.exit as usize];
    if target != END {
        return Some(target);
    }
    tally.moving -= 1;
    tally.eroded += 1;
    tally.eroded_mass += cube(jam.diameter);
    tally.largest_eroded = tally.largest_eroded.max(jam.diameter);
    state.eroded_sizes.add(&state.classes, jam.diameter);
    None
}
