//! The step: every moving particle of a chunk attempts one move, those inserted in this increment included.
//!
//! A kernel is a pure function of the network, the exits open at the start of the increment, the chunk and
//! its stream; it writes to its own chunk and events only.

#[cfg(target_arch = "x86_64")]
mod avx2;
#[cfg(target_arch = "x86_64")]
mod avx512;
mod fetch;
mod general;
mod lattice;
#[cfg(test)]
mod tests;

use super::Isa;
use super::chunks::{self, ChunkColumns};
use super::exits::{Form, OpenExits};
use super::insert::Insertion;
use super::merge::Events;
use super::openings::{Ways, Weighed};
use super::reads::{Classed, Jamming, Plain, Reads, Widths};
use super::{ExitTable, State, Supply};
use crate::network::Network;
use crate::stream::{Key, Lanes, Purpose};
use general::Jams;
use lattice::LatticeChunk;

/// Inserts this increment's particles and moves those of all chunks, in parallel where that pays; the results
/// are in `events`.
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
    let exits = OpenExits {
        network,
        table,
        ways: match &state.openings {
            None => Ways::Unblocked(&state.blocked),
            // No lattice table exists where water sets the weights, and only such a table asks for them.
            Some(openings) => Ways::Openings(&openings.widths, Weighed::Whole),
        },
        widths: state.openings.as_ref().map_or(network.diameters(), |openings| &openings.widths),
        passive_limit: state.passive_limit,
        arching: supply.arching(),
    };
    let classes = &state.classes;
    chunks::for_each(&mut state.particles, size, events, receiving, effort, |mut columns| {
        insertion.append(&mut columns);
        let ChunkColumns { chunk, void, diameter, live, events } = columns;
        let moving = *live as usize;
        if moving == 0 {
            return;
        }
        let key = Key { chunk, ..key };
        events.lend_buffer(moving + 16);
        let kept = step_chunk(&exits, key, &mut void[..moving], &mut diameter[..moving], events);
        let stayed = events.stopped.len() + events.stranded.len() + events.jams.len();
        events.moves = (moving - stayed) as u64 - events.waiting;
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
            let reads = (table.by_widths(), lattice::reads_classes(diameter, exits.passive_limit));
            let jams = exits.arching.map(|arching| (arching, jam_lanes(key)));
            let jams_any = jams.is_some();
            let chunk = LatticeChunk { exits, table, lanes: key.lanes(), jams, void, diameter, events };
            match reads {
                (true, _) if jams_any => step_lattice::<Jamming>(chunk, isa),
                (true, _) => step_lattice::<Widths>(chunk, isa),
                (false, true) => step_lattice::<Classed>(chunk, isa),
                (false, false) => step_lattice::<Plain>(chunk, isa),
            }
        }
        Form::General(table) => {
            let jams = exits.arching.map(|arching| Jams::new(arching, jam_lanes(key)));
            general::step(exits.network, table, jams, key, void, diameter, events)
        }
    }
}

/// Stream by which the particles of a chunk jam.
fn jam_lanes(key: Key) -> Lanes {
    Key { purpose: Purpose::Arching, ..key }.lanes()
}

/// The step on a lattice, by the data that it reads of each void.
fn step_lattice<R: Reads>(chunk: LatticeChunk, isa: Isa) -> usize {
    match isa {
        #[cfg(target_arch = "x86_64")]
        Isa::Avx512 if lattice::fits_gathers(chunk.table) => avx512::step::<R>(chunk),
        #[cfg(target_arch = "x86_64")]
        Isa::Avx2 if lattice::fits_gathers(chunk.table) => avx2::step::<R>(chunk),
        _ => lattice::step::<R>(chunk),
    }
}
