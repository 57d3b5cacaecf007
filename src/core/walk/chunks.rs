//! Chunks of particles, processed in sequence or by threads with the same result, and the merge of their
//! events.

use super::tally::cube;
use super::{CHUNK, Particles, SizeClasses, SizeCounts, State, Tally};
use crate::network::{END, Network};
use rayon::prelude::*;
use std::cell::RefCell;
use std::collections::HashMap;
use std::iter;

/// Columns of one chunk: at most `CHUNK` entries of every column, and its events.
pub(super) struct ChunkColumns<'a> {
    pub(crate) chunk: u64,
    pub(crate) void: &'a mut [u32],
    pub(crate) diameter: &'a mut [f32],
    /// Number of moving particles, which are at the front of the columns.
    pub(crate) live: &'a mut u32,
    pub(crate) events: &'a mut Events,
}

/// Number of moving particles above which several threads are faster than one.
const WORTH_THREADS: u64 = 4 * CHUNK as u64;

thread_local! {
    /// Diameters of the current chunk of a thread if all base particles have one size, instead of a column
    /// in memory.
    static SIZES: RefCell<Vec<f32>> = const { RefCell::new(Vec::new()) };
}

/// Does `work` on all chunks, at the cost of moving `effort` particles once. `single_size`: size of all
/// base particles, if they have one. Threads begin with the chunks from `receiving` on, which take longest
/// when particles are inserted; the others fill the remaining time.
pub(super) fn for_each(
    particles: &mut Particles,
    single_size: Option<f32>,
    events: &mut [Events],
    receiving: usize,
    effort: u64,
    work: impl Fn(ChunkColumns) + Sync,
) {
    let one_size = single_size.filter(|_| particles.has_one_size());
    let Particles { void, diameter, live } = particles;
    let sizes = diameter.chunks_mut(CHUNK).chain(iter::repeat_with(|| &mut [][..]));
    let columns = (0..).zip(void.chunks_mut(CHUNK)).zip(sizes).zip(live).zip(events);
    let columns = columns.map(|((((chunk, void), diameter), live), events)| ChunkColumns {
        chunk,
        void,
        diameter,
        live,
        events,
    });
    let work = |columns: ChunkColumns| match one_size {
        None => work(columns),
        Some(size) => SIZES.with_borrow_mut(|diameter| {
            diameter.clear();
            diameter.resize(CHUNK, size);
            work(ChunkColumns { diameter, ..columns });
        }),
    };
    if rayon::current_num_threads() > 1 && effort > WORTH_THREADS {
        let mut before: Vec<ChunkColumns> = columns.collect();
        let receiving = before.split_off(receiving.min(before.len()));
        let spread = |part: Vec<ChunkColumns>| part.into_par_iter().with_max_len(1).for_each(work);
        rayon::join(|| spread(receiving), || spread(before));
    } else {
        columns.for_each(work);
    }
}

thread_local! {
    /// Buffer for the eroded particles of the current chunk of a thread.
    static ERODED: RefCell<Vec<f32>> = const { RefCell::new(Vec::new()) };
}

#[derive(Default)]
pub(super) struct Events {
    /// Sums over the increment; those of the particles that moved once the chunk is done.
    pub(crate) tally: Tally,
    /// Diameters of the particles that left, in particle order; summed and dropped once the chunk is done.
    pub(crate) eroded: Vec<f32>,
    /// Constriction and diameter of the particles that were stopped, in particle order.
    pub(crate) stopped: Vec<(u32, f32)>,
    /// Particles that jammed, in particle order; not included in the stopped or moving ones.
    pub(crate) jams: Vec<Jam>,
    /// Void and diameter of the particles without an open exit, in particle order.
    pub(crate) stranded: Vec<(u32, f32)>,
    /// Number of particles that wait until the flow is solved again.
    pub(crate) waiting: u64,
    sizes: Option<[SizeCounts; 2]>,
}

impl Events {
    /// Clears the last increment but keeps the memory.
    pub(crate) fn clear(&mut self) {
        (self.tally, self.waiting) = (Tally::default(), 0);
        self.stopped.clear();
        self.stranded.clear();
    }

    /// Takes this thread's buffer, with room for `count` eroded particles.
    pub(crate) fn lend_buffer(&mut self, count: usize) {
        self.eroded = ERODED.take();
        self.eroded.clear();
        self.eroded.reserve(count);
    }

    /// Sums over the chunk and returns the buffer; called on the thread that processed the chunk.
    pub(crate) fn sum(&mut self, classes: &SizeClasses, passive_limit: f32) {
        let tally = &mut self.tally;
        tally.eroded = self.eroded.len() as u64;
        tally.retained_in_constrictions = self.stopped.len() as u64;
        tally.retained_in_voids = self.stranded.len() as u64;
        tally.passive_eroded = self.eroded.iter().map(|&d| u64::from(d <= passive_limit)).sum();
        tally.eroded_mass = self.eroded.iter().map(|&d| cube(d)).sum();
        tally.largest_eroded = self.eroded.iter().fold(0.0, |most, &d| if d > most { d } else { most });
        if !self.is_quiet() {
            let new = || [SizeCounts::new(classes), SizeCounts::new(classes)];
            let [eroded, retained] = self.sizes.get_or_insert_with(new);
            eroded.clear();
            self.eroded.iter().for_each(|&d| eroded.add(classes, d));
            retained.clear();
            self.stopped.iter().chain(&self.stranded).for_each(|&(_, d)| retained.add(classes, d));
        }
        ERODED.set(std::mem::take(&mut self.eroded));
    }

    fn is_quiet(&self) -> bool {
        self.tally.eroded == 0 && self.stopped.is_empty() && self.stranded.is_empty()
    }
}

/// Adds the events of all chunks to the state; returns the constrictions that have just closed or been
/// narrowed, in ascending order, each by one of its exits.
///
/// Counts are added and blocked constrictions combined by OR, in any order. Masses are added in particle
/// order within a chunk, and in chunk order over chunks.
pub(super) fn merge(
    network: &Network,
    events: &mut [Events],
    upstream: &[u32],
    state: &mut State,
) -> Vec<u32> {
    let (narrowed_before, blocked_before) = (state.changes(), state.history.len());
    for events in events.iter_mut() {
        state.tally.add(&events.tally);
        if !events.is_quiet() {
            if let Some([eroded, retained]) = &events.sizes {
                state.eroded_sizes.merge(eroded);
                state.retained_sizes.merge(retained);
            }
            for &(constriction, diameter) in &events.stopped {
                state.stop(network, upstream, constriction as usize, diameter);
            }
            for &(void, diameter) in &events.stranded {
                state.retained_in_voids[void as usize] += 1;
                state.retain_cubes(void as usize, cube(diameter));
            }
        }
        events.clear();
    }
    settle(network, events.iter_mut().map(|events| &mut events.jams), upstream, state);
    let closed = &mut state.history[blocked_before..];
    closed.sort_unstable_by_key(|blocking| blocking.constriction);
    state.tally.blocked += closed.len() as u64;
    match &mut state.openings {
        Some(openings) => openings.end_increment(state.increment, narrowed_before),
        None => closed.iter().map(|blocking| blocking.constriction).collect(),
    }
}

#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Jam {
    /// Number of moving particles before it in its chunk.
    pub(crate) rank: u32,
    pub(crate) exit: u32,
    pub(crate) diameter: f32,
    /// Number of particles in the arch that it starts.
    pub(crate) particles: u32,
}

/// Keeps the arches of an increment and releases the other jammed particles; consumes the jams of all chunks.
///
/// The first particle that jammed in a constriction, in the order of insertion, sets the number in the
/// arch. The others move to the next void or leave the filter, and keep their place in that order.
fn settle<'a>(
    network: &Network,
    jams: impl Iterator<Item = &'a mut Vec<Jam>>,
    upstream: &[u32],
    state: &mut State,
) {
    // Room left in the arch, by constriction.
    let mut room = HashMap::new();
    let mut released = Vec::new();
    for (chunk, jams) in jams.enumerate().filter(|(_, jams)| !jams.is_empty()) {
        for jam in jams.drain(..) {
            let exit = jam.exit as usize;
            let room = room.entry(network.either_way(exit)).or_insert_with(|| {
                state.tally.arches += 1;
                jam.particles
            });
            if *room > 0 {
                *room -= 1;
                keep(network, jam, upstream, state);
            } else if let Some(void) = release(network, jam, state) {
                released.push((jam.rank as usize, void, jam.diameter));
            }
        }
        state.particles.put_back(chunk, &released);
        released.clear();
    }
}

fn keep(network: &Network, jam: Jam, upstream: &[u32], state: &mut State) {
    let tally = &mut state.tally;
    tally.moving -= 1;
    tally.retained_in_constrictions += 1;
    tally.retained_in_arches += 1;
    tally.arched_mass += cube(jam.diameter);
    state.retained_sizes.add(&state.classes, jam.diameter);
    state.stop(network, upstream, jam.exit as usize, jam.diameter);
}

/// Lets a particle pass; returns its new void, or `None` if it has left the filter.
fn release(network: &Network, jam: Jam, state: &mut State) -> Option<u32> {
    let tally = &mut state.tally;
    tally.particle_moves = tally.particle_moves.saturating_add(1);
    let target = network.targets()[jam.exit as usize];
    if target != END {
        return Some(target);
    }
    tally.moving -= 1;
    tally.eroded += 1;
    tally.eroded_mass += cube(jam.diameter);
    tally.largest_eroded = tally.largest_eroded.max(jam.diameter);
    state.eroded_sizes.add(&state.classes, jam.diameter);
    None
}
