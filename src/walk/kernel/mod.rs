//! The step: every moving particle of a chunk attempts one move.
//!
//! A kernel is a pure function of the network, the exits open at the start of the increment, the chunk and
//! its stream; it writes to its own chunk and events only.

#[cfg(target_arch = "x86_64")]
mod avx2;
#[cfg(target_arch = "x86_64")]
mod avx512;
mod general;
mod isa;
mod lattice;
mod threads;

pub use isa::Isa;
pub use threads::threads;

use bitvec::slice::BitSlice;
use rayon::prelude::*;

use super::exits::Form;
use super::insert::insert;
use super::merge::Events;
use super::{CHUNK, ExitTable, State, Supply};
use crate::network::Network;
use crate::stream::{Key, Purpose};

/// Inserts and moves the particles of all chunks, in parallel; what happened is in `events`.
pub(super) fn step(
    network: &Network,
    table: &ExitTable,
    supply: &Supply,
    state: &mut State,
    events: &mut [Events],
) {
    let key = Key {
        seed: state.seed,
        purpose: Purpose::Step,
        run: state.run,
        increment: state.increment,
        chunk: 0,
    };
    let exits = OpenExits { network, table, blocked: &state.blocked, passive_limit: state.passive_limit };
    let classes = &state.classes;
    let columns =
        state.particles.void.par_chunks_mut(CHUNK).zip(state.particles.diameter.par_chunks_mut(CHUNK));
    let chunks = columns.zip(&mut state.particles.live).zip(events).enumerate();
    chunks.for_each(|(chunk, (((void, diameter), live), events))| {
        let key = Key { chunk: chunk as u64, ..key };
        let (old, new) = (*live as usize, *live as usize + events.inserted as usize);
        if new == 0 {
            return;
        }
        if new > old {
            let diameter = &mut diameter[old..new];
            events.inserted_mass = insert(network, supply, key, &mut void[old..new], diameter);
            events.passive_inserted = diameter.iter().filter(|&&d| d <= exits.passive_limit).count() as u32;
        }
        let kept = step_chunk(&exits, key, &mut void[..new], &mut diameter[..new], events);
        events.moves = (new - events.stopped.len() - events.stranded.len()) as u64;
        events.sum(classes, exits.passive_limit);
        *live = kept as u32;
    });
}

/// What a kernel reads: the network and its exits open at the start of the increment.
struct OpenExits<'a> {
    network: &'a Network,
    table: &'a ExitTable,
    blocked: &'a BitSlice<u64>,
    passive_limit: f32,
}

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
            let chunk = lattice::Chunk { exits, table, lanes: key.lanes(), void, diameter, events };
            match exits.table.isa() {
                #[cfg(target_arch = "x86_64")]
                Isa::Avx512 if avx512::suits(table) => avx512::step(chunk),
                #[cfg(target_arch = "x86_64")]
                Isa::Avx2 if avx2::suits(table) => avx2::step(chunk),
                _ => lattice::step(chunk),
            }
        }
        Form::General(table) => general::step(exits.network, table, key, void, diameter, events),
    }
}
