//! Insertion: which chunks receive this increment's base particles, and where they start.

use std::ops::Range;

use super::chunks::ChunkColumns;
use super::fill::{Drawing, Drawn};
use super::{CHUNK, Isa, State, Supply};
use crate::network::Network;
use crate::stream::{Key, Purpose};

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
    /// Insertion of the increment that `state` is in.
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
        let drawing = Drawing {
            network: self.network,
            supply: self.supply,
            key: Key { chunk: *chunk, ..self.key },
            before: begin.saturating_sub(self.inserted.start),
            passive_limit: self.passive_limit,
            void: &mut void[old..new],
            diameter: &mut diameter[old..new],
        };
        let Drawn { mass, passive } = drawing.draw(self.isa);
        (events.inserted_mass, events.passive_inserted) = (mass, passive);
    }
}
