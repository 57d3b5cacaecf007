//! Insertion: which chunks receive this increment's base particles, and where they start.

use super::chunks::{self, ChunkColumns};
use super::fill::fill_diameters;
use super::merge::Events;
use super::sizes::cube;
use super::{CHUNK, Isa, State, Supply};
use crate::network::Network;
use crate::stream::{Key, LANES, Lanes, Purpose, below};

/// Appends this increment's particles to their chunks, in parallel where that pays; `events` keeps their
/// number and mass.
pub(super) fn insert(
    network: &Network,
    supply: &Supply,
    isa: Isa,
    state: &mut State,
    events: &mut Vec<Events>,
) {
    events.resize_with(state.particles.live.len(), Events::default);
    let (before, after) = (supply.inserted(state.increment - 1), supply.inserted(state.increment));
    if before == after {
        return;
    }
    let purpose = Purpose::Insertion;
    let key = Key { seed: state.seed, purpose, run: state.run, increment: state.increment, chunk: 0 };
    let limit = state.passive_limit;
    let receiving = (before as usize) / CHUNK..(after as usize).div_ceil(CHUNK);
    let size = supply.single_size();
    chunks::for_each(&mut state.particles, size, events, receiving, after - before, |columns| {
        let ChunkColumns { chunk, void, diameter, live, events } = columns;
        let begin = chunk * CHUNK as u64;
        events.inserted = (after.min(begin + CHUNK as u64) - before.max(begin)) as u32;
        let (old, new) = (*live as usize, (*live + events.inserted) as usize);
        let key = Key { chunk, ..key };
        append(network, supply, key, isa, limit, &mut void[old..new], &mut diameter[old..new], events);
        *live = new as u32;
    });
}

/// Particles drawn at a time.
const BATCH: usize = 8 * LANES;

/// Draws the particles of one chunk into its columns, and notes their mass and how many are passive.
#[expect(clippy::too_many_arguments, reason = "what it reads, and the columns that it writes")]
fn append(
    network: &Network,
    supply: &Supply,
    key: Key,
    isa: Isa,
    passive_limit: f32,
    void: &mut [u32],
    diameter: &mut [f32],
    events: &mut Events,
) {
    let mut lanes = key.lanes();
    let nodes = network.start();
    let mut mass = 0.0;
    let strata = supply.strata(key.increment);
    let mut place = place_in_increment(supply, key);
    for (void, diameter) in void.chunks_mut(BATCH).zip(diameter.chunks_mut(BATCH)) {
        let mut size_words = [0; BATCH];
        let size_words = &mut size_words[..void.len()];
        match &strata {
            None => draw(&mut lanes, void, size_words, |pair| {
                (nodes[below(pair[0], nodes.len() as u64) as usize], pair[1])
            }),
            Some(strata) => draw(&mut lanes, void, size_words, |pair| {
                place += 1;
                let node = strata.node(place - 1, pair[0], nodes.len() as u64);
                (nodes[node], strata.size_word(place - 1, pair[1]))
            }),
        }
        fill_diameters(isa, supply, size_words, diameter);
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
