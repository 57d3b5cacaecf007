//! The step: every moving particle of a chunk attempts one move, those inserted in this increment included.
//!
//! A kernel is a pure function of the network, the exits open at the start of the increment, the chunk and
//! its stream; it writes to its own chunk and events only.

#[cfg(target_arch = "x86_64")]
mod avx2;
#[cfg(target_arch = "x86_64")]
mod avx512;
mod general;
mod lattice;
#[cfg(test)]
mod tests;

use super::Isa;
use super::chunks::{self, ChunkColumns};
use super::crowding::Crowd;
use super::exits::{Form, OpenExits};
use super::insert::Insertion;
use super::merge::Events;
use super::{Arching, ExitTable, State, Supply};
use crate::network::Network;
use crate::stream::{Key, Purpose};
use lattice::LatticeChunk;

/// Inserts this increment's particles and moves those of all chunks, in parallel where that pays; what
/// happened is in `events`.
pub(super) fn step(
    network: &Network,
    table: &ExitTable,
    supply: &Supply,
    state: &mut State,
    events: &mut Vec<Events>,
) {
    events.resize_with(state.particles.live.len(), Events::default);
    let key = Key {
        seed: state.seed,
        purpose: Purpose::Step,
        run: state.run,
        increment: state.increment,
        chunk: 0,
    };
    let insertion = Insertion::new(network, supply, table.isa(), state);
    let moving: u64 = state.particles.live.iter().map(|&live| u64::from(live)).sum();
    let effort = moving + INSERTED * insertion.share() + EMPTY_CHUNK * events.len() as u64;
    let (size, receiving) = (supply.single_size(), insertion.first_chunk());
    // Where arches depend on who is in a void, all are in before any moves.
    let crowd = supply.arching().and_then(Arching::of_void).map(|_| {
        let particles = &mut state.particles;
        chunks::for_each(particles, size, events, receiving, effort, |mut of| insertion.append(&mut of));
        let chunks = (0..particles.live.len()).map(|chunk| particles.chunk(chunk));
        Crowd::of(chunks, state.passive_limit, network.voids())
    });
    let exits = OpenExits {
        network,
        table,
        blocked: &state.blocked,
        passive_limit: state.passive_limit,
        arching: supply.arching(),
        crowd: crowd.as_ref(),
    };
    let classes = &state.classes;
    chunks::for_each(&mut state.particles, size, events, receiving, effort, |mut columns| {
        if crowd.is_none() {
            insertion.append(&mut columns);
        }
        let ChunkColumns { chunk, void, diameter, live, events } = columns;
        let moving = *live as usize;
        if moving == 0 {
            return;
        }
        let key = Key { chunk, ..key };
        events.lend_buffer(moving + 16);
        let kept = step_chunk(&exits, key, &mut void[..moving], &mut diameter[..moving], events);
        events.moves = (moving - events.stopped.len() - events.stranded.len()) as u64 - events.waiting;
        events.sum(classes, exits.passive_limit);
        *live = kept as u32;
    });
}

/// Attempted moves that take as long as a chunk with hardly any.
const EMPTY_CHUNK: u64 = 16;

/// Attempted moves that take as long as inserting a particle and moving it once.
const INSERTED: u64 = 8;

/// Moves the particles of one chunk; those that still move are brought together at the front, in order,
/// and counted.
fn step_chunk(
    exits: &OpenExits,
    key: Key,
    void: &mut [u32],
    diameter: &mut [f32],
    events: &mut Events,
) -> usize {
    match exits.table.form() {
        Form::Lattice(table) => {
            lattice::fetch_first(void, diameter);
            let isa = exits.table.isa();
            let classed = lattice::reads_classes(diameter, exits.passive_limit);
            let chunk = LatticeChunk { exits, table, lanes: key.lanes(), void, diameter, events };
            if classed { step_lattice::<true>(chunk, isa) } else { step_lattice::<false>(chunk, isa) }
        }
        Form::General(table) => {
            let arching = exits.arching.map(|arching| (arching, exits.crowd));
            general::step(exits.network, table, arching, key, void, diameter, events)
        }
    }
}

/// The step on a lattice, by words with classes or without.
fn step_lattice<const CLASSED: bool>(chunk: LatticeChunk, isa: Isa) -> usize {
    match isa {
        #[cfg(target_arch = "x86_64")]
        Isa::Avx512 if lattice::fits_gathers(chunk.table) => avx512::step::<CLASSED>(chunk),
        #[cfg(target_arch = "x86_64")]
        Isa::Avx2 if lattice::fits_gathers(chunk.table) => avx2::step::<CLASSED>(chunk),
        _ => lattice::step::<CLASSED>(chunk),
    }
}
