//! The chunks of the particles, one after another or over threads: no result depends on which.

use std::cell::RefCell;
use std::iter;

use super::merge::Events;
use super::{CHUNK, Particles};

/// Columns of one chunk: its part of every column, `CHUNK` entries or fewer, and its events.
pub(super) struct ChunkColumns<'a> {
    pub chunk: u64,
    pub void: &'a mut [u32],
    pub diameter: &'a mut [f32],
    /// Moving particles, at the front of the columns.
    pub live: &'a mut u32,
    pub events: &'a mut Events,
}

/// Particles to move above which several threads are faster than one.
const WORTH_THREADS: u64 = 4 * CHUNK as u64;

thread_local! {
    /// Diameters of the chunk that a thread is at, where all base particles have one size: a column of them
    /// would say nothing, and be read from memory.
    static SIZES: RefCell<Vec<f32>> = const { RefCell::new(Vec::new()) };
}

/// Does `work` on all chunks, which costs as much as moving `effort` particles once. `single_size`: size of
/// all base particles, if they have one. Threads begin with the chunks from `receiving` on, which take
/// longest where particles are inserted: the others fill the time that is left.
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
    let all = Neighbours { first: 0, void, diameter, live, events, one_size };
    if rayon::current_num_threads() > 1 && effort > WORTH_THREADS {
        let (before, receiving) = all.split_at(receiving);
        rayon::join(|| receiving.spread(&work), || before.spread(&work));
    } else {
        all.in_order(&work);
    }
}

/// The columns of chunks that are neighbours.
struct Neighbours<'a> {
    /// The first of them.
    first: usize,
    void: &'a mut [u32],
    /// Unused if all base particles have one size.
    diameter: &'a mut [f32],
    live: &'a mut [u32],
    events: &'a mut [Events],
    one_size: Option<f32>,
}

impl Neighbours<'_> {
    /// Columns of the chunks before `chunk`, and of the others.
    fn split_at(self, chunk: usize) -> (Self, Self) {
        let Self { first, void, diameter, live, events, one_size } = self;
        let (chunk, entry) = (chunk.min(live.len()), chunk * CHUNK);
        let (void, void_after) = void.split_at_mut(entry.min(void.len()));
        let (diameter, diameter_after) = diameter.split_at_mut(entry.min(diameter.len()));
        let (live, live_after) = live.split_at_mut(chunk);
        let (events, events_after) = events.split_at_mut(chunk);
        let before = Self { first, void, diameter, live, events, one_size };
        let after = Self {
            first: first + chunk,
            void: void_after,
            diameter: diameter_after,
            live: live_after,
            events: events_after,
            one_size,
        };
        (before, after)
    }

    /// Spreads the work over threads, which halve the rest until it is one chunk.
    fn spread(self, work: &(impl Fn(ChunkColumns) + Sync)) {
        let chunks = self.live.len();
        if chunks <= 1 {
            return self.in_order(work);
        }
        let (front, back) = self.split_at(chunks / 2);
        rayon::join(|| front.spread(work), || back.spread(work));
    }

    fn in_order(self, work: &impl Fn(ChunkColumns)) {
        let Self { first, void, diameter, live, events, one_size } = self;
        let sizes = diameter.chunks_mut(CHUNK).chain(iter::repeat_with(|| &mut [][..]));
        let columns = void.chunks_mut(CHUNK).zip(sizes).zip(live).zip(events);
        for (chunk, (((void, diameter), live), events)) in (first as u64..).zip(columns) {
            match one_size {
                None => work(ChunkColumns { chunk, void, diameter, live, events }),
                Some(size) => SIZES.with_borrow_mut(|diameter| {
                    diameter.clear();
                    diameter.resize(CHUNK, size);
                    work(ChunkColumns { chunk, void, diameter, live, events });
                }),
            }
        }
    }
}
