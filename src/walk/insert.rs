//! Insertion: which chunks receive this increment's base particles, and where they start.

use super::merge::Events;
use super::sizes::cube;
use super::{CHUNK, State, Supply};
use crate::network::Network;
use crate::stream::{Key, LANES, Purpose, below};

/// Notes in `events` how many particles each chunk receives in this increment.
pub(super) fn plan(supply: &Supply, state: &mut State, events: &mut Vec<Events>) {
    events.resize_with(state.particles.live.len(), Events::default);
    let (before, after) = (supply.inserted(state.increment - 1), supply.inserted(state.increment));
    let first = (before as usize) / CHUNK;
    for (chunk, events) in events.iter_mut().enumerate().skip(first) {
        let begin = (chunk * CHUNK) as u64;
        if begin >= after {
            break;
        }
        events.inserted = (after.min(begin + CHUNK as u64) - before.max(begin)) as u32;
    }
}

/// Appends the particles of one chunk to its columns and returns their mass.
pub(super) fn insert(
    network: &Network,
    supply: &Supply,
    key: Key,
    void: &mut [u32],
    diameter: &mut [f32],
) -> f64 {
    let mut lanes = Key { purpose: Purpose::Insertion, ..key }.lanes();
    let nodes = network.start();
    let mut mass = 0.0;
    for (void, diameter) in void.chunks_mut(LANES / 2).zip(diameter.chunks_mut(LANES / 2)) {
        let words = lanes.next_block();
        for ((void, diameter), pair) in void.iter_mut().zip(diameter).zip(words.chunks_exact(2)) {
            *void = nodes[below(pair[0], nodes.len() as u64) as usize];
            *diameter = supply.diameter(pair[1]);
            mass += cube(*diameter);
        }
    }
    mass
}
