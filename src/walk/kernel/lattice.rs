//! The step on the cubic lattice: one table word a void, targets by arithmetic. The portable kernel, and
//! what the vector kernels share with it.
//!
//! It and the AVX2 kernel take a block of particles at a time. They predict where these go, without a branch,
//! and say for which that may be wrong: a draw that equals a threshold as far as the table's word goes, no
//! open exit, coarser than the void's finest open exit may be, leaves. Those few then go the long way
//! ([`LatticeChunk::settle`]), one by one and in order.
//!
//! The halves of a table word hold the two thresholds above other bits ([`Lattice::below`]); beside a draw
//! with ones in place of those bits, a half is no greater exactly where the draw is no less than the
//! threshold, unless the two are equal in the bits that the word has. Every kernel reads the words with
//! classes or those without, whichever suit the chunk ([`reads_classes`]): both lead to the same bits.

use std::ops::Range;

use crate::stream::{DRAWS_PER_BLOCK, LANES, Lanes, draw16};
use crate::walk::exits::{self, CLASS, CLASS_SHIFT, Lattice, OpenExits};
use crate::walk::merge::Events;

/// Particles of a block.
pub(super) const BLOCK: usize = 2 * DRAWS_PER_BLOCK;

/// The draws of a block of particles, as they come.
pub(super) type Draws = [u64; 2 * LANES];

/// What brings a class in its place in a word to that in the bits of a diameter.
pub(super) const CLASS_UP: u32 = CLASS_SHIFT - CLASS.trailing_zeros();

/// Bit of an index of [`Lattice::moves`]: the draw is no less than the first threshold.
pub(super) const PAST_FIRST: u32 = 4;

/// Bit of an index of [`Lattice::moves`]: the draw is no less than the second threshold.
pub(super) const PAST_SECOND: u32 = 8;

/// Particles between one that moves and the one whose columns are asked for then.
const AHEAD: usize = 256;

/// Entries of a column that come from memory together.
#[cfg(target_arch = "x86_64")]
const LINE: usize = 16;

/// Asks for the first particles of a chunk, before anything is read of it.
pub(super) fn fetch_first(void: &[u32], diameter: &[f32]) {
    fetch(void, diameter, 0..AHEAD);
}

/// Asks for a range of particles, of this chunk or those that lie behind it: beside the words of the table,
/// read in no order, the machine does not do so by itself in time.
#[inline(always)]
fn fetch(void: &[u32], diameter: &[f32], range: Range<usize>) {
    #[cfg(target_arch = "x86_64")]
    for at in range.step_by(LINE) {
        use std::arch::x86_64::{_MM_HINT_T0, _mm_prefetch};
        // SAFETY: nothing is read, whatever the address.
        unsafe {
            _mm_prefetch::<_MM_HINT_T0>(void.as_ptr().wrapping_add(at).cast());
            _mm_prefetch::<_MM_HINT_T0>(diameter.as_ptr().wrapping_add(at).cast());
        }
    }
    #[cfg(not(target_arch = "x86_64"))]
    let _ = (void, diameter, range);
}

/// First particles of a chunk, which stand for all of it.
const SAMPLE: usize = 256;

/// Particles of a sample that are not passive, up to which it takes less time to look at each of them than to
/// read classes: at 3 in 100 it takes a third more.
const FEW_COARSE: usize = 1;

/// Whether the particles of a chunk are better off with words that have classes: more than a few are not
/// passive. A question of time alone.
pub(super) fn reads_classes(diameter: &[f32], passive_limit: f32) -> bool {
    let sample = &diameter[..diameter.len().min(SAMPLE)];
    sample.iter().map(|&d| usize::from(d > passive_limit)).sum::<usize>() > FEW_COARSE
}

/// Whether there is a void, and every constriction has a number that a gather can use as an offset.
#[cfg(target_arch = "x86_64")]
pub(super) fn fits_gathers(table: &Lattice) -> bool {
    (1..=i32::MAX as usize).contains(&(3 * table.plain.len()))
}

/// The moving particles of one chunk, and what their step reads and writes.
pub(super) struct LatticeChunk<'a> {
    pub exits: &'a OpenExits<'a>,
    pub table: &'a Lattice,
    /// The stream of this chunk and increment.
    pub lanes: Lanes,
    pub void: &'a mut [u32],
    pub diameter: &'a mut [f32],
    pub events: &'a mut Events,
}

/// Moves the particles of one chunk; returns how many still move.
#[inline(never)]
pub(super) fn step<const CLASSED: bool>(mut chunk: LatticeChunk) -> usize {
    let mut lanes = chunk.lanes.clone();
    let count = chunk.void.len();
    let mut kept = 0;
    for begin in (0..count - count % BLOCK).step_by(BLOCK) {
        chunk.fetch_ahead(begin, BLOCK);
        let draws: Draws = bytemuck::cast(lanes.next_blocks::<2>());
        let mut rare = 0;
        for (part, draws) in draws.as_chunks().0.iter().enumerate() {
            let done = part * PART;
            rare |= predict::<CLASSED>(&mut chunk, begin + done, draws, kept + done) << done;
        }
        let gone = chunk.settle::<CLASSED>(begin, &draws, rare, kept);
        kept = chunk.close_up(kept, gone);
    }
    chunk.step_rest::<CLASSED>(|| lanes.next_block(), kept)
}

/// Particles whose ways are predicted at once: with 8 the compiler makes no vector code of it, and of 32 the
/// registers do not hold the passes.
const PART: usize = 16;

/// A bit for each of them.
static BITS: [u32; PART] = {
    let mut bits = [1; PART];
    let mut j = 0;
    while j < PART {
        bits[j] <<= j;
        j += 1;
    }
    bits
};

/// Predicts where the part of a block of particles from `begin` on goes, and writes it, and their diameters,
/// from `kept` on. Where the prediction may be wrong there is a bit, and the void that the particle is in.
///
/// Passes of arithmetic alone over halves of words and whole words: they compile to vector code.
#[inline]
fn predict<const CLASSED: bool>(
    chunk: &mut LatticeChunk,
    begin: usize,
    draws: &[u64; PART / 4],
    kept: usize,
) -> u64 {
    let (table, words) = (chunk.table, chunk.table.words::<CLASSED>());
    let (from, d): (&[u32; PART], &[f32; PART]) =
        (chunk.void[begin..].first_chunk().unwrap(), chunk.diameter[begin..].first_chunk().unwrap());
    // As a map it takes a third longer.
    let mut word = [0; PART];
    for (word, &from) in word.iter_mut().zip(from) {
        *word = words[from as usize];
    }
    let draws: [u16; PART] = bytemuck::cast(draws.map(u64::to_le));
    let (nx, plane) = (table.moves[4], table.moves[15]);
    let last_layer = (words.len() as u32 - plane) as i32;
    let less = if CLASSED { 5 } else { 0 };
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
        let class = if CLASSED { (word[j] & CLASS) << CLASS_UP } else { 0 };
        let wrong = ones(top_first == first)
            | ones(top_second == second)
            | before_first & !before_second
            | ones(d[j].to_bits() as i32 > (table.finest + class) as i32)
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

/// All bits where `yes`, else none: conditions as arithmetic.
#[inline(always)]
fn ones(yes: bool) -> u32 {
    0u32.wrapping_sub(u32::from(yes))
}

impl LatticeChunk<'_> {
    /// Asks for the columns some way behind the `count` particles from `begin` on.
    #[inline(always)]
    pub fn fetch_ahead(&self, begin: usize, count: usize) {
        fetch(self.void, self.diameter, begin + AHEAD..begin + AHEAD + count);
    }

    /// Takes the particles of the block from `begin` on that have a bit in `rare` the long way; all were
    /// written from `kept` on. Returns a bit for each that is gone from there.
    #[inline]
    pub fn settle<const CLASSED: bool>(
        &mut self,
        begin: usize,
        draws: &Draws,
        mut rare: u64,
        kept: usize,
    ) -> u64 {
        let mut gone = 0;
        while rare != 0 {
            let j = rare.trailing_zeros() as usize;
            rare &= rare - 1;
            let draw = (draws[j / 4] >> (16 * (j % 4))) as u16;
            match self.attempt::<CLASSED>(kept + j, begin + j, draw) {
                Some(to) => self.void[kept + j] = to,
                None => gone |= 1 << j,
            }
        }
        gone
    }

    /// Closes up the block of particles from `kept` on over those that are gone; returns where it ends then.
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

    /// Moves what particles are left after whole blocks, by the blocks of the stream that come next; `kept`
    /// before them still move.
    pub fn step_rest<const CLASSED: bool>(
        &mut self,
        mut next_block: impl FnMut() -> [u64; LANES],
        mut kept: usize,
    ) -> usize {
        let count = self.void.len();
        let mut begin = count - count % BLOCK;
        while begin < count {
            let block = next_block();
            let end = count.min(begin + DRAWS_PER_BLOCK);
            for j in begin..end {
                if let Some(to) = self.attempt::<CLASSED>(j, j, draw16(&block, j - begin)) {
                    self.void[kept] = to;
                    self.diameter[kept] = self.diameter[j];
                    kept += 1;
                }
            }
            begin = end;
        }
        kept
    }

    /// The attempt of the particle at `place` by draw `index` in full: where it is then, if it still moves.
    #[inline]
    fn attempt<const CLASSED: bool>(&mut self, place: usize, index: usize, draw: u16) -> Option<u32> {
        let (from, d) = (self.void[place], self.diameter[place]);
        let word = self.table.words::<CLASSED>()[from as usize];
        let exit = Lattice::pick::<CLASSED>(word, draw).or_else(|| self.undecided(from, index, draw));
        let Some(exit) = exit else {
            self.events.stranded.push((from, d));
            return None;
        };
        if d > self.exits.passive_limit && d > self.exits.network.diameters()[(3 * from + exit) as usize] {
            self.events.stopped.push((3 * from + exit, d));
            return None;
        }
        let to = self.table.target(from, exit, word);
        if to >= self.table.plain.len() as u32 {
            self.events.eroded.push(d);
            return None;
        }
        Some(to)
    }

    /// Exit picked by a draw for which a word with classes may have too few bits; `None` where no exit is
    /// open.
    #[cold]
    pub fn undecided(&self, void: u32, index: usize, draw: u16) -> Option<u32> {
        if let Some(exit) = Lattice::pick::<false>(self.table.plain[void as usize], draw) {
            return Some(exit);
        }
        let mut thresholds = Vec::with_capacity(3);
        let last_open = exits::thresholds(self.exits.network, self.exits.blocked, void, &mut thresholds)?;
        let draw = self.lanes.extension().complete(draw, index as u64);
        Some(thresholds.iter().position(|&t| draw < t).unwrap_or(last_open) as u32)
    }
}

impl Lattice {
    /// Void that exit `exit` of void `from` leads to; past the last void where it leaves.
    #[inline(always)]
    fn target(&self, from: u32, exit: u32, word: u32) -> u32 {
        let index = word & 3 | [0, PAST_FIRST, PAST_FIRST | PAST_SECOND][exit as usize];
        from.wrapping_add(self.moves[index as usize])
    }
}
