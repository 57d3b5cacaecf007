//! The chunks of the particles, one after another or over threads: nothing that a chunk does depends on
//! which.

use std::cell::RefCell;
use std::ops::Range;

use rayon::prelude::*;

use super::merge::Events;
use super::{CHUNK, Particles};

/// What belongs to one chunk: its part of every column, `CHUNK` entries or fewer, and its events.
pub(super) struct ChunkColumns<'a> {
    pub chunk: u64,
    pub void: &'a mut [u32],
    pub diameter: &'a mut [f32],
    /// Moving particles, at the front of the columns.
    pub live: &'a mut u32,
    pub events: &'a mut Events,
}

/// Particles to work on above which several threads are faster than one.
const WORTH_THREADS: u64 = 4 * CHUNK as u64;

thread_local! {
    /// Diameters of the chunk that a thread is at, where all base particles have one size: a column of them
    /// would say nothing, and be read from memory.
    static SIZES: RefCell<Vec<f32>> = const { RefCell::new(Vec::new()) };
}

/// Does `work` on the chunks of `range`, which are `effort` particles to work on. `single_size`: that of all
/// base particles, where they have one.
pub(super) fn for_each(
    particles: &mut Particles,
    single_size: Option<f32>,
    events: &mut [Events],
    range: Range<usize>,
    effort: u64,
    work: impl Fn(ChunkColumns) + Sync,
) {
    let spread = rayon::current_num_threads() > 1 && effort > WORTH_THREADS;
    let one_size = single_size.filter(|_| particles.has_one_size());
    let (first, entries) = (range.start, range.start * CHUNK..range.end * CHUNK);
    let Particles { void, diameter, live } = particles;
    let (void, live, events) = (&mut void[entries.clone()], &mut live[range.clone()], &mut events[range]);
    let place = |chunk: usize| (first + chunk) as u64;
    if let Some(size) = one_size {
        let work = |(chunk, ((void, live), events)): (usize, ((&mut [u32], &mut u32), &mut Events))| {
            SIZES.with_borrow_mut(|diameter| {
                diameter.clear();
                diameter.resize(CHUNK, size);
                work(ChunkColumns { chunk: place(chunk), void, diameter, live, events });
            });
        };
        match spread {
            true => void.par_chunks_mut(CHUNK).zip(live).zip(events).enumerate().for_each(work),
            false => void.chunks_mut(CHUNK).zip(live).zip(events).enumerate().for_each(work),
        }
    } else {
        type Columns<'a> = (((&'a mut [u32], &'a mut [f32]), &'a mut u32), &'a mut Events);
        let work = |(chunk, (((void, diameter), live), events)): (usize, Columns)| {
            work(ChunkColumns { chunk: place(chunk), void, diameter, live, events });
        };
        let diameter = &mut diameter[entries];
        if spread {
            let columns = void.par_chunks_mut(CHUNK).zip(diameter.par_chunks_mut(CHUNK));
            columns.zip(live).zip(events).enumerate().for_each(work);
        } else {
            let columns = void.chunks_mut(CHUNK).zip(diameter.chunks_mut(CHUNK));
            columns.zip(live).zip(events).enumerate().for_each(work);
        }
    }
}
