//! Step on the cubic lattice: one table word per void, targets by arithmetic. This is the portable kernel,
//! with the parts that the vector kernels share.
//!
//! It and the AVX2 kernel process a block of particles at a time. They predict the moves without branches
//! and mark those that may be wrong: the draw equals a threshold in the bits of the table word, no exit is
//! open, the particle may be coarser than its exit, or it leaves. Those few then take the slow path
//! ([`LatticeChunk::settle`]), one by one and in order.
//!
//! The halves of a table word hold the two thresholds above other bits ([`Lattice::below`]). Compared with
//! a draw that has ones in place of those bits, a half is no greater if and only if the draw is at least
//! the threshold, unless the two are equal in the bits of the word.
//!
//! If a particle may jam, its size is first multiplied by the reach of its draw ([`Arching::reach`]): a
//! particle then no finer than the width of its exit takes the slow path, where the law decides.

use crate::stream::{DRAWS_PER_BLOCK, LANES, Lanes, draw16};
use crate::walk::arching::{Arching, Reach};
use crate::walk::chunks::{Events, Jam};
use crate::walk::exits;
use crate::walk::exits::{CLASS, CLASS_SHIFT, Lattice, OpenExits, Plain, Reads};
use std::ops::Range;

pub(super) const BLOCK: usize = 2 * DRAWS_PER_BLOCK;

pub(super) type Draws = [u64; 2 * LANES];

/// Shift of a class from its place in a word to its place in the bits of a diameter.
pub(super) const CLASS_UP: u32 = CLASS_SHIFT - CLASS.trailing_zeros();

/// Bit of an index of [`Lattice::moves`]: the draw is at least the first threshold.
pub(super) const PAST_FIRST: u32 = 4;

/// Bit of an index of [`Lattice::moves`]: the draw is at least the second threshold.
pub(super) const PAST_SECOND: u32 = 8;

/// Number of particles by which columns are prefetched ahead.
pub(super) const AHEAD: usize = 256;

const LINE: usize = 16;

/// Prefetches a range of particles, of this chunk or the next ones: with random reads of table words in
/// between, the processor does not prefetch them in time.
#[inline(always)]
pub(super) fn fetch_range(void: &[u32], diameter: &[f32], range: Range<usize>) {
    for at in range.step_by(LINE) {
        fetch(void, at);
        fetch(diameter, at);
    }
}

/// Number of first particles of a chunk that represent all of it.
const SAMPLE: usize = 256;

/// Maximum number of non-passive particles in a sample for which the slow path is faster than reading
/// classes; at 3 in 100 it takes a third longer.
const FEW_COARSE: usize = 1;

/// Tells if words with classes are faster for a chunk: more than a few of its particles are not passive.
/// Results do not depend on it.
pub(super) fn reads_classes(diameter: &[f32], passive_limit: f32) -> bool {
    let sample = &diameter[..diameter.len().min(SAMPLE)];
    sample.iter().map(|&d| usize::from(d > passive_limit)).sum::<usize>() > FEW_COARSE
}

/// Tells if there is a void, and every constriction number can be the offset of a gather.
#[cfg(target_arch = "x86_64")]
pub(super) fn fits_gathers(table: &Lattice) -> bool {
    (1..=i32::MAX as usize).contains(&(3 * table.plain.len()))
}

/// Moving particles of one chunk, and the columns that their step reads and writes.
pub(super) struct LatticeChunk<'a> {
    pub(crate) exits: &'a OpenExits<'a>,
    pub(crate) table: &'a Lattice,
    pub(crate) lanes: Lanes,
    /// Law of arching and its stream, if particles arch.
    pub(crate) jams: Option<(&'a Arching, Lanes)>,
    pub(crate) void: &'a mut [u32],
    pub(crate) diameter: &'a mut [f32],
    pub(crate) events: &'a mut Events,
}

/// Moves the particles of one chunk; returns the number still moving.
#[inline(never)]
pub(super) fn step<R: Reads>(mut chunk: LatticeChunk) -> usize {
    let mut lanes = chunk.lanes.clone();
    let mut jam_lanes = chunk.jam_lanes::<R>();
    let count = chunk.void.len();
    let mut kept = 0;
    for begin in (0..count - count % BLOCK).step_by(BLOCK) {
        chunk.fetch_ahead(begin, BLOCK);
        let draws: Draws = bytemuck::cast(lanes.next_blocks::<2>());
        let jam_draws: Draws =
            if R::JAMS { bytemuck::cast(jam_lanes.next_blocks::<2>()) } else { [0; 2 * LANES] };
        let mut rare = 0;
        let parts = draws.as_chunks().0.iter().zip(jam_draws.as_chunks().0);
        for (part, (draws, jam_draws)) in parts.enumerate() {
            let done = part * PART;
            rare |= predict::<R>(&mut chunk, begin + done, [draws, jam_draws], kept + done) << done;
        }
        let gone = chunk.settle::<R>(begin, [&draws, &jam_draws], rare, kept);
        kept = chunk.close_up(kept, gone);
    }
    chunk.step_rest::<R>(
        || [lanes.next_block(), if R::JAMS { jam_lanes.next_block() } else { [0; LANES] }],
        kept,
    )
}

/// Number of particles predicted at once: with 8 the compiler does not vectorise, and 32 do not fit in the
/// registers.
const PART: usize = 16;

static BITS: [u32; PART] = {
    let mut bits = [1; PART];
    let mut j = 0;
    while j < PART {
        bits[j] <<= j;
        j += 1;
    }
    bits
};

/// Predicts the moves of part of a block of particles from `begin` on; writes voids and diameters from
/// `kept` on. A particle whose prediction may be wrong gets a bit and keeps its void.
///
/// It consists of arithmetic passes over halves of words and whole words, which compile to vector code.
#[inline]
fn predict<R: Reads>(
    chunk: &mut LatticeChunk,
    begin: usize,
    [draws, jam_draws]: [&[u64; PART / 4]; 2],
    kept: usize,
) -> u64 {
    let (table, words) = (chunk.table, chunk.table.words::<R>());
    let (from, d): (&[u32; PART], &[f32; PART]) =
        (chunk.void[begin..].first_chunk().unwrap(), chunk.diameter[begin..].first_chunk().unwrap());
    // One check for all, as single checks take as long as the reads. Signed numbers compare in vector code.
    let signed = |void: u32| (void ^ 1 << 31) as i32;
    let end = signed(u32::try_from(words.len()).unwrap_or(u32::MAX));
    let outside = from.iter().fold(0, |outside, &from| outside | ones(signed(from) >= end));
    assert!(outside == 0, "a void beyond the lattice");
    // `map` takes a third longer.
    let mut word = [0; PART];
    for (word, &from) in word.iter_mut().zip(from) {
        // SAFETY: every void has a word, as asserted.
        *word = unsafe { *words.get_unchecked(from as usize) };
    }
    let draws: [u16; PART] = bytemuck::cast(draws.map(u64::to_le));
    // Effective size of each particle, and width of its chosen exit.
    let (mut size, mut width) = (*d, [f32::INFINITY; PART]);
    if R::JAMS {
        let jam_draws: [u16; PART] = bytemuck::cast(jam_draws.map(u64::to_le));
        let reach = chunk.reach();
        for (size, draw) in size.iter_mut().zip(jam_draws) {
            *size *= reach[Arching::class_of(u16::from_le(draw)) % reach.len()];
        }
    }
    if R::WIDTHS {
        for j in 0..PART {
            let draw = u16::from_le(draws[j]);
            let past_first = u32::from(draw >> 2 >= (word[j] >> 2 & 0x3fff) as u16);
            let past_second = u32::from(draw >= (word[j] >> 16) as u16);
            width[j] = chunk.exits.widths[(3 * from[j] + past_second + (past_first | past_second)) as usize];
        }
    }
    let (nx, plane) = (table.moves[4], table.moves[15]);
    let last_layer = (words.len() as u32 - plane) as i32;
    let less = if R::CLASSED { 5 } else { 0 };
    let (mut rare, mut to) = (0, [0; PART]);
    for j in 0..PART {
        let draw = u32::from(u16::from_le(draws[j]));
        let (top_first, top_second) = ((draw >> 2) as i32, (draw >> less) as i32);
        let (first, second) = ((word[j] >> 2 & 0x3fff) as i32, (word[j] >> (16 + less)) as i32);
        let (wraps_x, wraps_y) = (0u32.wrapping_sub(word[j] & 1), 0u32.wrapping_sub(word[j] >> 1 & 1));
        let (before_first, before_second) = (ones(top_first < first), ones(top_second < second));
        let sideways = 1u32.wrapping_sub(wraps_x & nx);
        let across = nx.wrapping_sub(wraps_y & plane);
        let by = before_first & sideways | !before_first & across;
        let by = before_second & by | !before_second & plane;
        let class = if R::CLASSED { (word[j] & CLASS) << CLASS_UP } else { 0 };
        let wrong = ones(top_first == first)
            | ones(top_second == second)
            | before_first & !before_second
            | if R::WIDTHS {
                ones(size[j] > width[j])
            } else {
                ones(d[j].to_bits() as i32 > (table.finest + class) as i32)
            }
            | !before_second & ones(from[j] as i32 >= last_layer);
        rare |= wrong & BITS[j];
        to[j] = from[j].wrapping_add(by & !wrong);
    }
    chunk.void[kept..kept + PART].copy_from_slice(&to);
    if kept < begin {
        chunk.diameter.copy_within(begin..begin + PART, kept);
    }
    u64::from(rare)
}

/// All bits if `yes`, otherwise 0, for conditions as arithmetic.
#[inline(always)]
fn ones(yes: bool) -> u32 {
    0u32.wrapping_sub(u32::from(yes))
}

impl<'a> LatticeChunk<'a> {
    /// Prefetches the columns some way ahead of the `count` particles from `begin` on.
    #[inline(always)]
    pub(crate) fn fetch_ahead(&self, begin: usize, count: usize) {
        fetch_range(self.void, self.diameter, begin + AHEAD..begin + AHEAD + count);
    }

    /// Sends the particles of the block from `begin` on with a bit in `rare` through the slow path, by the
    /// draws of both streams; all were written from `kept` on. Returns a bit for each that is gone.
    #[inline]
    pub(crate) fn settle<R: Reads>(
        &mut self,
        begin: usize,
        draws: [&Draws; 2],
        mut rare: u64,
        kept: usize,
    ) -> u64 {
        let mut gone = 0u64;
        while rare != 0 {
            let j = rare.trailing_zeros() as usize;
            rare &= rare - 1;
            let draws = draws.map(|draws| (draws[j / 4] >> (16 * (j % 4))) as u16);
            let rank = kept + j - gone.count_ones() as usize;
            match self.attempt::<R>(kept + j, begin + j, draws, rank) {
                Some(to) => self.void[kept + j] = to,
                None => gone |= 1 << j,
            }
        }
        gone
    }

    /// Compacts the block of particles from `kept` on, removing those that are gone; returns its new end.
    #[inline]
    fn close_up(&mut self, kept: usize, mut gone: u64) -> usize {
        let (mut done, mut end) = (kept, kept);
        while done < kept + BLOCK {
            let next = (kept + gone.trailing_zeros() as usize).min(kept + BLOCK);
            gone &= gone.wrapping_sub(1);
            if done != end {
                self.void.copy_within(done..next, end);
                self.diameter.copy_within(done..next, end);
            }
            end += next - done;
            done = next + 1;
        }
        end
    }

    /// Moves the particles left after whole blocks, by the next blocks of both streams; `kept` particles
    /// before them still move.
    pub(crate) fn step_rest<R: Reads>(
        &mut self,
        mut next_blocks: impl FnMut() -> [[u64; LANES]; 2],
        mut kept: usize,
    ) -> usize {
        let count = self.void.len();
        let mut begin = count - count % BLOCK;
        while begin < count {
            let blocks = next_blocks();
            let end = count.min(begin + DRAWS_PER_BLOCK);
            for j in begin..end {
                let draws = blocks.each_ref().map(|block| draw16(block, j - begin));
                if let Some(to) = self.attempt::<R>(j, j, draws, kept) {
                    self.void[kept] = to;
                    self.diameter[kept] = self.diameter[j];
                    kept += 1;
                }
            }
            begin = end;
        }
        kept
    }

    /// Attempts the move of the particle at `place` by all bits of draw `index` of both streams; returns
    /// its new void, if it still moves. `rank` particles before it still move.
    #[inline]
    fn attempt<R: Reads>(
        &mut self,
        place: usize,
        index: usize,
        [draw, jam_draw]: [u16; 2],
        rank: usize,
    ) -> Option<u32> {
        let (from, d) = (self.void[place], self.diameter[place]);
        let word = self.table.words::<R>()[from as usize];
        let exit = Lattice::pick::<R>(word, draw).or_else(|| self.undecided(from, index, draw));
        let Some(exit) = exit else {
            self.events.stranded.push((from, d));
            return None;
        };
        let constriction = 3 * from + exit;
        if d > self.exits.passive_limit && d > self.exits.widths[constriction as usize] {
            self.events.stopped.push((constriction, d));
            return None;
        }
        if R::JAMS && self.jams(constriction, d, [index, rank], jam_draw) {
            return None;
        }
        let to = self.table.target(from, exit, word);
        if to >= self.table.plain.len() as u32 {
            self.events.eroded.push(d);
            return None;
        }
        Some(to)
    }

    /// Tells if a particle that fits jams in a constriction by draw `index`; records a jam with `rank`,
    /// the number of particles before it that still move.
    pub(crate) fn jams(&mut self, exit: u32, diameter: f32, [index, rank]: [usize; 2], draw: u16) -> bool {
        let Some((arching, lanes)) = &self.jams else { return false };
        let word = lanes.extension().complete(draw, index as u64);
        let width = self.exits.widths[exit as usize];
        let particles = arching.jams(width, diameter, word);
        let jam = particles.map(|particles| Jam { rank: rank as u32, exit, diameter, particles });
        self.events.jams.extend(jam);
        jam.is_some()
    }

    pub(crate) fn jam_lanes<R: Reads>(&self) -> Lanes {
        let jams = self.jams.as_ref().filter(|_| R::JAMS);
        jams.map_or_else(|| self.lanes.clone(), |(_, lanes)| lanes.clone())
    }

    pub(crate) fn reach(&self) -> &'a Reach {
        self.jams.as_ref().expect("particles jam").0.reach()
    }

    /// Exit picked by a draw if a word with classes may have too few bits; `None` if no exit is open.
    #[cold]
    pub(crate) fn undecided(&self, void: u32, index: usize, draw: u16) -> Option<u32> {
        let word = self.table.plain[void as usize];
        // Thresholds of open exits rise.
        if word & 0xfffc > word >> 16 {
            return None;
        }
        if let Some(exit) = Lattice::pick::<Plain>(word, draw) {
            return Some(exit);
        }
        let mut thresholds = Vec::with_capacity(3);
        let last_open = exits::thresholds(self.exits.network, self.exits.ways, void, &mut thresholds)?;
        let draw = self.lanes.extension().complete(draw, index as u64);
        Some(thresholds.iter().position(|&t| draw < t).unwrap_or(last_open) as u32)
    }
}

impl Lattice {
    /// Target of exit `exit` of void `from`; past the last void if the exit leaves the filter.
    #[inline(always)]
    fn target(&self, from: u32, exit: u32, word: u32) -> u32 {
        let index = word & 3 | [0, PAST_FIRST, PAST_FIRST | PAST_SECOND][exit as usize];
        from.wrapping_add(self.moves[index as usize])
    }
}

/// Prefetches an entry of a column, or of the memory after it.
#[inline(always)]
pub(super) fn fetch<T>(column: &[T], at: usize) {
    #[cfg(target_arch = "x86_64")]
    {
        use std::arch::x86_64::{_MM_HINT_T0, _mm_prefetch};
        // SAFETY: nothing is read at any address.
        unsafe { _mm_prefetch::<_MM_HINT_T0>(column.as_ptr().wrapping_add(at).cast()) };
    }
    #[cfg(not(target_arch = "x86_64"))]
    let _ = (column, at);
}
