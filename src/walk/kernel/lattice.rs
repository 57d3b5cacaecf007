//! The step on the cubic lattice: one table word a void, targets by arithmetic. The portable kernel, and
//! what the vector kernels share with it.
//!
//! It and the AVX2 kernel take a block of particles at a time. They predict where these go, without a branch,
//! and say for which that may be wrong: a draw that equals a threshold as far as the table's word goes, no
//! open exit, coarser than the void's finest open exit may be, leaves. Those few then go the long way
//! ([`LatticeChunk::settle`]), one by one and in order.
//!
//! The halves of a table word hold the two thresholds above other bits; beside a draw with ones in place of
//! those bits ([`BELOW`]), a half is no greater exactly where the draw is no less than the threshold, unless
//! the two are equal in the bits that the word has.

use crate::stream::{DRAWS_PER_BLOCK, LANES, Lanes, draw16};
use crate::walk::exits::{self, CLASS, CLASS_SHIFT, Lattice, OpenExits};
use crate::walk::merge::Events;

/// Particles of a block.
pub(super) const BLOCK: usize = 2 * DRAWS_PER_BLOCK;

/// The draws of a block of particles, as they come.
pub(super) type Draws = [u64; 2 * LANES];

/// Bits below the thresholds in a word of [`Lattice::entry`]: the second stands in the upper half, the first
/// in the lower.
pub(super) const BELOW: u32 = 0x001f_0003;

/// What brings a class in its place in a word to that in the bits of a diameter.
pub(super) const CLASS_UP: u32 = CLASS_SHIFT - CLASS.trailing_zeros();

/// Bit of an index of [`Lattice::moves`]: the draw is no less than the first threshold.
pub(super) const PAST_FIRST: u32 = 4;

/// Bit of an index of [`Lattice::moves`]: the draw is no less than the second threshold.
pub(super) const PAST_SECOND: u32 = 8;

/// Whether every constriction has a number that a gather can use as an offset.
#[cfg(target_arch = "x86_64")]
pub(super) fn fits_gathers(table: &Lattice) -> bool {
    3 * table.entry.len() <= i32::MAX as usize
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
pub(super) fn step(mut chunk: LatticeChunk) -> usize {
    let mut lanes = chunk.lanes.clone();
    let count = chunk.void.len();
    let mut kept = 0;
    for begin in (0..count - count % BLOCK).step_by(BLOCK) {
        let draws = next_draws(&mut lanes);
        let rare = predict(&mut chunk, begin, &draws, kept);
        let gone = chunk.settle(begin, &draws, rare, kept);
        kept = chunk.close_up(kept, gone);
    }
    chunk.step_rest(|| lanes.next_block(), kept)
}

/// The draws of the next block of particles.
#[inline(always)]
pub(super) fn next_draws(lanes: &mut Lanes) -> Draws {
    bytemuck::cast([lanes.next_block(), lanes.next_block()])
}

/// Predicts where the block of particles from `begin` on goes, and writes it, and their diameters, from
/// `kept` on. Where the prediction may be wrong there is a bit, and the void that the particle is in.
///
/// Passes of arithmetic alone over halves of words and whole words: they compile to vector code.
#[inline]
fn predict(chunk: &mut LatticeChunk, begin: usize, draws: &Draws, kept: usize) -> u64 {
    let table = chunk.table;
    let (from, d): (&[u32; BLOCK], &[f32; BLOCK]) =
        (chunk.void[begin..].first_chunk().unwrap(), chunk.diameter[begin..].first_chunk().unwrap());
    let (from, d) = (*from, *d);
    let entry: [u32; BLOCK] = from.map(|from| table.entry[from as usize]);
    let draws: [u16; BLOCK] = bytemuck::cast(draws.map(u64::to_le));
    let (nx, plane) = (table.moves[4], table.moves[15]);
    let last_layer = (table.entry.len() as u32 - plane) as i32;
    let mut to = [0; BLOCK];
    let mut rare = [0u32; BLOCK];
    for j in 0..BLOCK {
        let draw = u32::from(u16::from_le(draws[j]));
        let (top_first, top_second) = ((draw >> 2) as i32, (draw >> 5) as i32);
        let (first, second) = ((entry[j] >> 2 & 0x3fff) as i32, (entry[j] >> 21) as i32);
        let (wraps_x, wraps_y) = (0u32.wrapping_sub(entry[j] & 1), 0u32.wrapping_sub(entry[j] >> 1 & 1));
        let (before_first, before_second) = (ones(top_first < first), ones(top_second < second));
        let sideways = 1u32.wrapping_sub(wraps_x & nx);
        let across = nx.wrapping_sub(wraps_y & plane);
        let by = before_first & sideways | !before_first & across;
        let by = before_second & by | !before_second & plane;
        let passes = table.finest + ((entry[j] & CLASS) << CLASS_UP);
        rare[j] = ones(top_first == first)
            | ones(top_second == second)
            | before_first & !before_second
            | ones(d[j].to_bits() as i32 > passes as i32)
            | !before_second & ones(from[j] as i32 >= last_layer);
        to[j] = from[j].wrapping_add(by & !rare[j]);
    }
    chunk.void[kept..kept + BLOCK].copy_from_slice(&to);
    chunk.diameter[kept..kept + BLOCK].copy_from_slice(&d);
    if rare.iter().fold(0, |any, &one| any | one) == 0 {
        return 0;
    }
    rare.iter().enumerate().fold(0, |bits, (j, &one)| bits | u64::from(one & 1) << j)
}

/// All bits where `yes`, else none: conditions as arithmetic.
#[inline(always)]
fn ones(yes: bool) -> u32 {
    0u32.wrapping_sub(u32::from(yes))
}

impl LatticeChunk<'_> {
    /// Takes the particles of the block from `begin` on that have a bit in `rare` the long way; all were
    /// written from `kept` on. Returns a bit for each that is gone from there.
    #[inline]
    pub fn settle(&mut self, begin: usize, draws: &Draws, mut rare: u64, kept: usize) -> u64 {
        let mut gone = 0;
        while rare != 0 {
            let j = rare.trailing_zeros() as usize;
            rare &= rare - 1;
            let draw = (draws[j / 4] >> (16 * (j % 4))) as u16;
            match self.attempt(kept + j, begin + j, draw) {
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
    pub fn step_rest(&mut self, mut next_block: impl FnMut() -> [u64; LANES], mut kept: usize) -> usize {
        let count = self.void.len();
        let mut begin = count - count % BLOCK;
        while begin < count {
            let block = next_block();
            let end = count.min(begin + DRAWS_PER_BLOCK);
            for j in begin..end {
                if let Some(to) = self.attempt(j, j, draw16(&block, j - begin)) {
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
    fn attempt(&mut self, place: usize, index: usize, draw: u16) -> Option<u32> {
        let (from, d) = (self.void[place], self.diameter[place]);
        let entry = self.table.entry[from as usize];
        let [first, second] = Lattice::parts(entry);
        let (top_first, top_second) = (u32::from(draw >> 2), u32::from(draw >> 5));
        let exit = if top_first == first || top_second == second || first >> 3 > second {
            match self.undecided(from, index, draw) {
                Some(exit) => exit,
                None => {
                    self.events.stranded.push((from, d));
                    return None;
                }
            }
        } else {
            u32::from(top_first >= first) + u32::from(top_second >= second)
        };
        if d > self.exits.passive_limit && d > self.exits.network.diameters()[(3 * from + exit) as usize] {
            self.events.stopped.push((3 * from + exit, d));
            return None;
        }
        let to = self.table.target(from, exit, entry);
        if to >= self.table.entry.len() as u32 {
            self.events.eroded.push(d);
            return None;
        }
        Some(to)
    }

    /// Exit picked by a draw that equals a threshold in the bits that the table has; `None` where no exit is
    /// open.
    #[cold]
    pub fn undecided(&self, void: u32, index: usize, draw: u16) -> Option<u32> {
        let mut thresholds = Vec::with_capacity(3);
        let last_open = exits::thresholds(self.exits.network, self.exits.blocked, void, &mut thresholds)?;
        let draw = self.lanes.extension().complete(draw, index as u64);
        Some(thresholds.iter().position(|&t| draw < t).unwrap_or(last_open) as u32)
    }
}

impl Lattice {
    /// Void that exit `exit` of void `from` leads to; past the last void where it leaves.
    #[inline(always)]
    fn target(&self, from: u32, exit: u32, entry: u32) -> u32 {
        let index = entry & 3 | [0, PAST_FIRST, PAST_FIRST | PAST_SECOND][exit as usize];
        from.wrapping_add(self.moves[index as usize])
    }
}
