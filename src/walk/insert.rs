//! Insertion: which chunks receive this increment's base particles, and where they start.

use super::merge::Events;
use super::sizes::cube;
use super::{CHUNK, Isa, State, Supply, kernel};
use crate::network::Network;
use crate::stream::{Key, LANES, Lanes, Purpose, below};

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

/// Particles drawn at a time.
const BATCH: usize = 8 * LANES;

/// Appends the particles of one chunk to its columns, and notes their mass and how many are passive.
#[expect(clippy::too_many_arguments, reason = "what it reads, and the columns that it writes")]
pub(super) fn insert(
    network: &Network,
    supply: &Supply,
    key: Key,
    isa: Isa,
    passive_limit: f32,
    void: &mut [u32],
    diameter: &mut [f32],
    events: &mut Events,
) {
    let mut lanes = Key { purpose: Purpose::Insertion, ..key }.lanes();
    let nodes = network.start();
    let mut mass = 0.0;
    let layer = supply.layer(key.increment);
    let mut place = place_in_increment(supply, key);
    for (void, diameter) in void.chunks_mut(BATCH).zip(diameter.chunks_mut(BATCH)) {
        let mut size_words = [0; BATCH];
        let size_words = &mut size_words[..void.len()];
        match &layer {
            None => draw(&mut lanes, void, size_words, |pair| {
                (nodes[below(pair[0], nodes.len() as u64) as usize], pair[1])
            }),
            Some(layer) => draw(&mut lanes, void, size_words, |pair| {
                place += 1;
                let node = layer.node(place - 1, pair[0], nodes.len() as u64);
                (nodes[node], layer.size_word(place - 1, pair[1]))
            }),
        }
        kernel::fill_diameters(isa, supply, size_words, diameter);
        mass = diameter.iter().fold(mass, |mass, &d| mass + cube(d));
        events.passive_inserted += diameter.iter().map(|&d| u32::from(d <= passive_limit)).sum::<u32>();
    }
    events.inserted_mass = mass;
}

/// How many particles the increment inserts before those of this chunk.
fn place_in_increment(supply: &Supply, key: Key) -> u64 {
    (key.chunk * CHUNK as u64).saturating_sub(supply.inserted(key.increment - 1))
}

/// Gives each particle in turn the void and the size word that `of` makes of its two words of the stream.
#[inline(always)]
fn draw(
    lanes: &mut Lanes,
    void: &mut [u32],
    size_words: &mut [u64],
    mut of: impl FnMut([u64; 2]) -> (u32, u64),
) {
    for (void, size_words) in void.chunks_mut(LANES / 2).zip(size_words.chunks_mut(LANES / 2)) {
        let words = lanes.next_block();
        for ((void, size_word), pair) in void.iter_mut().zip(size_words).zip(words.chunks_exact(2)) {
            (*void, *size_word) = of([pair[0], pair[1]]);
        }
    }
}
