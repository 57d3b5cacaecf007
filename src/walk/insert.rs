//! Insertion: which chunks receive this increment's base particles, and where they start.

use std::ops::Range;

use super::chunks::ChunkColumns;
use super::fill::fill_diameters;
use super::merge::Events;
use super::sizes::cube;
use super::{CHUNK, Isa, State, Supply};
use crate::network::Network;
use crate::stream::{Key, LANES, Lanes, Purpose, below};

/// Particles drawn at a time.
const BATCH: usize = 8 * LANES;

/// This increment's share of the base, which each chunk appends to its own columns.
pub(super) struct Insertion<'a> {
    network: &'a Network,
    supply: &'a Supply,
    isa: Isa,
    passive_limit: f32,
    /// The stream, but for the chunk.
    key: Key,
    /// Base particles inserted before and after this increment.
    inserted: Range<u64>,
}

impl<'a> Insertion<'a> {
    /// Of the increment that `state` is in.
    pub fn new(network: &'a Network, supply: &'a Supply, isa: Isa, state: &State) -> Self {
        let (increment, purpose) = (state.increment, Purpose::Insertion);
        Self {
            network,
            supply,
            isa,
            passive_limit: state.passive_limit,
            key: Key { seed: state.seed, purpose, run: state.run, increment, chunk: 0 },
            inserted: supply.inserted(increment - 1)..supply.inserted(increment),
        }
    }

    /// Base particles inserted in this increment.
    pub fn share(&self) -> u64 {
        self.inserted.end - self.inserted.start
    }

    /// The first chunk that receives any, or would if there were any.
    pub fn first_chunk(&self) -> usize {
        self.inserted.start as usize / CHUNK
    }

    /// Appends the particles of a chunk to its columns; its events keep their number and mass.
    pub fn append(&self, columns: &mut ChunkColumns) {
        let ChunkColumns { chunk, void, diameter, live, events } = columns;
        let begin = *chunk * CHUNK as u64;
        let (first, end) = (self.inserted.start.max(begin), self.inserted.end.min(begin + CHUNK as u64));
        if first >= end {
            return;
        }
        events.inserted = (end - first) as u32;
        let (old, new) = (**live as usize, (**live + events.inserted) as usize);
        **live = new as u32;
        self.draw(Key { chunk: *chunk, ..self.key }, &mut void[old..new], &mut diameter[old..new], events);
    }

    /// Draws the particles of one chunk into its columns, and notes their mass and how many are passive.
    fn draw(&self, key: Key, void: &mut [u32], diameter: &mut [f32], events: &mut Events) {
        let (supply, nodes) = (self.supply, self.network.start());
        let mut lanes = key.lanes();
        let mut mass = 0.0;
        let strata = supply.strata(key.increment);
        // How many particles the increment inserts before those of this chunk.
        let mut place = (key.chunk * CHUNK as u64).saturating_sub(self.inserted.start);
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
            fill_diameters(self.isa, supply, size_words, diameter);
            mass = diameter.iter().fold(mass, |mass, &d| mass + cube(d));
            events.passive_inserted +=
                diameter.iter().map(|&d| u32::from(d <= self.passive_limit)).sum::<u32>();
        }
        events.inserted_mass = mass;
    }
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
        let [words] = lanes.next_blocks();
        for ((void, size_word), pair) in void.iter_mut().zip(size_words).zip(words.chunks_exact(2)) {
            (*void, *size_word) = of([pair[0], pair[1]]);
        }
    }
}
