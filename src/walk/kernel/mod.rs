//! The step: every moving particle of a chunk attempts one move.
//!
//! A kernel is a pure function of the network, the exits open at the start of the increment, the chunk and
//! its stream; it writes to its own chunk and events only.

#[cfg(target_arch = "x86_64")]
mod avx2;
#[cfg(target_arch = "x86_64")]
mod avx512;
mod fill;
mod general;
mod isa;
mod lattice;
#[cfg(test)]
mod tests;
mod threads;

pub(super) use fill::fill_diameters;
pub use isa::Isa;
pub use threads::threads;

use std::cell::RefCell;

use bitvec::slice::BitSlice;
use rayon::prelude::*;

use super::exits::Form;
use super::insert::insert;
use super::merge::Events;
use super::{CHUNK, ExitTable, Particles, State, Supply};
use crate::network::Network;
use crate::stream::{Key, Purpose};

/// Inserts and moves the particles of all chunks, in parallel where that pays; what happened is in `events`.
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
    let attempts =
        state.tally.moving + supply.inserted(state.increment) - supply.inserted(state.increment - 1);
    let work = |chunk: usize, void: &mut [u32], diameter: &mut [f32], live: &mut u32, events: &mut Events| {
        let key = Key { chunk: chunk as u64, ..key };
        let (old, new) = (*live as usize, *live as usize + events.inserted as usize);
        if new == 0 {
            return;
        }
        if new > old {
            let (void, diameter) = (&mut void[old..new], &mut diameter[old..new]);
            insert(network, supply, key, table.isa(), exits.passive_limit, void, diameter, events);
        }
        events.lend_room(new + 16);
        let kept = step_chunk(&exits, key, &mut void[..new], &mut diameter[..new], events);
        events.moves = (new - events.stopped.len() - events.stranded.len()) as u64;
        events.sum(classes, exits.passive_limit);
        *live = kept as u32;
    };
    let one_size = supply.single_size().filter(|_| state.particles.has_one_size());
    let Particles { void, diameter, live } = &mut state.particles;
    let spread =
        rayon::current_num_threads() > 1 && attempts + EMPTY_CHUNK * live.len() as u64 > WORTH_THREADS;
    if let Some(size) = one_size {
        let work = |chunk: usize, void: &mut [u32], live: &mut u32, events: &mut Events| {
            SIZES.with_borrow_mut(|sizes| {
                sizes.clear();
                sizes.resize(CHUNK, size);
                work(chunk, void, sizes, live, events);
            });
        };
        if spread {
            let chunks = void.par_chunks_mut(CHUNK).zip(live).zip(events).enumerate();
            chunks.for_each(|(chunk, ((void, live), events))| work(chunk, void, live, events));
        } else {
            let chunks = void.chunks_mut(CHUNK).zip(live).zip(events).enumerate();
            chunks.for_each(|(chunk, ((void, live), events))| work(chunk, void, live, events));
        }
    } else if spread {
        let columns = void.par_chunks_mut(CHUNK).zip(diameter.par_chunks_mut(CHUNK));
        let chunks = columns.zip(live).zip(events).enumerate();
        chunks.for_each(|(chunk, (((void, diameter), live), events))| {
            work(chunk, void, diameter, live, events)
        });
    } else {
        let columns = void.chunks_mut(CHUNK).zip(diameter.chunks_mut(CHUNK));
        let chunks = columns.zip(live).zip(events).enumerate();
        chunks.for_each(|(chunk, (((void, diameter), live), events))| {
            work(chunk, void, diameter, live, events)
        });
    }
}

thread_local! {
    /// Diameters of the chunk that a thread is at, where all base particles have one size: a column of them would say
    /// nothing, and be read from memory.
    static SIZES: RefCell<Vec<f32>> = const { RefCell::new(Vec::new()) };
}

/// Attempted moves in an increment above which several threads are faster than one.
const WORTH_THREADS: u64 = 4 * CHUNK as u64;

/// Attempted moves that take as long as a chunk with hardly any.
const EMPTY_CHUNK: u64 = 16;

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
                Isa::Avx512 if lattice::fits_gathers(table) => avx512::step(chunk),
                #[cfg(target_arch = "x86_64")]
                Isa::Avx2 if lattice::fits_gathers(table) => avx2::step(chunk),
                _ => lattice::step(chunk),
            }
        }
        Form::General(table) => general::step(exits.network, table, key, void, diameter, events),
    }
}
