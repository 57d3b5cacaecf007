//! The step on the cubic lattice: one table word a void, targets by arithmetic. The portable kernel, and
//! what the vector kernels share with it.
//!
//! The fifteen top bits of a sixteen-bit draw stand beside the thresholds in a word as `draw << 16`, with
//! ones below: that is no less than the word exactly where they are no less than the first threshold, and no
//! less than the word shifted by fifteen where they are no less than the second. Where fifteen bits equal a
//! threshold, the particle goes the long way ([`LatticeChunk::attempt`]).

use crate::stream::{DRAWS_PER_BLOCK, LANES, Lanes, draw16};
use crate::walk::exits::{self, Lattice, OpenExits};
use crate::walk::merge::Events;

/// Ones below the bits of the first threshold in a word of [`Lattice::entry`].
pub(super) const BELOW_FIRST: u32 = (1 << 17) - 1;

/// Shift that brings the second threshold where the first one is.
pub(super) const SECOND: u32 = 15;

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
///
/// Whole blocks in three passes: table words one by one, then arithmetic alone, which compiles to vector
/// code, then what few particles leave.
#[inline(never)]
pub(super) fn step(mut chunk: LatticeChunk) -> usize {
    let mut lanes = chunk.lanes.clone();
    let count = chunk.void.len();
    let mut kept = 0;
    for begin in (0..count).step_by(DRAWS_PER_BLOCK) {
        let block = lanes.next_block();
        let end = begin + DRAWS_PER_BLOCK;
        let whole = (chunk.void.get(begin..end), chunk.diameter.get(begin..end));
        kept = match whole {
            (Some(from), Some(diameter)) => {
                let (from, diameter) = (from.try_into().unwrap(), diameter.try_into().unwrap());
                let (to, rare) = predict(chunk.exits, chunk.table, from, diameter, &block);
                chunk.commit(begin, &block, &to, rare, kept)
            }
            _ => chunk.step_block(begin, count, &block, kept),
        };
    }
    kept
}

/// Predicts where a block of particles goes if nothing rare happens, and a bit for each particle for which it
/// may: a tie, no open exit, not passive, leaves.
#[inline]
fn predict(
    exits: &OpenExits,
    table: &Lattice,
    from: &[u32; DRAWS_PER_BLOCK],
    diameter: &[f32; DRAWS_PER_BLOCK],
    block: &[u64; LANES],
) -> ([u32; DRAWS_PER_BLOCK], u32) {
    let entry: [u32; DRAWS_PER_BLOCK] = std::array::from_fn(|j| table.entry[from[j] as usize]);
    let draws: [u16; DRAWS_PER_BLOCK] = bytemuck::cast(block.map(u64::to_le));
    let (nx, plane) = (table.moves[4], table.moves[15]);
    let last_layer = (table.entry.len() as u32 - plane) as i32;
    let mut to = [0; DRAWS_PER_BLOCK];
    let mut rare = [0; DRAWS_PER_BLOCK];
    for j in 0..DRAWS_PER_BLOCK {
        let top = i32::from(u16::from_le(draws[j]) >> 1);
        let (first, second) = ((entry[j] >> 17) as i32, (entry[j] >> 2 & 0x7fff) as i32);
        let (wraps_x, wraps_y) = (0u32.wrapping_sub(entry[j] & 1), 0u32.wrapping_sub(entry[j] >> 1 & 1));
        let (before_first, before_second) = (ones(top < first), ones(top < second));
        let sideways = 1u32.wrapping_sub(wraps_x & nx);
        let across = nx.wrapping_sub(wraps_y & plane);
        let by = before_first & sideways | !before_first & across;
        let by = before_second & by | !before_second & plane;
        to[j] = from[j].wrapping_add(by);
        rare[j] = ones(top == first)
            | ones(top == second)
            | before_first & !before_second
            | ones(diameter[j] > exits.passive_limit)
            | !before_second & ones(from[j] as i32 >= last_layer);
    }
    if rare.iter().fold(0, |any, &one| any | one) == 0 {
        return (to, 0);
    }
    (to, rare.iter().enumerate().fold(0, |bits, (j, &one)| bits | one & 1 << j))
}

/// All bits where `yes`, else none: conditions as arithmetic.
#[inline(always)]
fn ones(yes: bool) -> u32 {
    0u32.wrapping_sub(u32::from(yes))
}

impl LatticeChunk<'_> {
    /// Writes what [`predict`] says, and takes the rare particles the long way.
    #[inline]
    fn commit(
        &mut self,
        begin: usize,
        block: &[u64; LANES],
        to: &[u32; DRAWS_PER_BLOCK],
        mut rare: u32,
        mut kept: usize,
    ) -> usize {
        if rare == 0 {
            let end = begin + DRAWS_PER_BLOCK;
            self.void[kept..kept + DRAWS_PER_BLOCK].copy_from_slice(to);
            self.diameter.copy_within(begin..end, kept);
            return kept + DRAWS_PER_BLOCK;
        }
        let mut done = 0;
        loop {
            let until = (rare.trailing_zeros() as usize).min(DRAWS_PER_BLOCK);
            for (j, &to) in to.iter().enumerate().take(until).skip(done) {
                self.void[kept + j - done] = to;
                self.diameter[kept + j - done] = self.diameter[begin + j];
            }
            kept += until - done;
            if until == DRAWS_PER_BLOCK {
                return kept;
            }
            kept = self.attempt(begin + until, draw16(block, until), kept);
            rare &= rare - 1;
            done = until + 1;
        }
    }

    /// Moves particles `begin .. end`, which take the first draws of `block`; `kept` before them still
    /// move.
    pub fn step_block(&mut self, begin: usize, end: usize, block: &[u64; LANES], mut kept: usize) -> usize {
        let voids = self.table.entry.len() as u32;
        let limit = self.exits.passive_limit;
        for j in begin..end {
            let (from, d) = (self.void[j], self.diameter[j]);
            let entry = self.table.entry[from as usize];
            let draw = draw16(block, j - begin);
            let top = u32::from(draw) << 16 | BELOW_FIRST;
            let second = entry << SECOND;
            let (past_first, past_second) = (top >= entry, top >= second);
            let tie = (top ^ entry).min(top ^ second) <= BELOW_FIRST;
            let past = u32::from(past_first) * PAST_FIRST + u32::from(past_second) * PAST_SECOND;
            let index = (entry & 3) + past;
            let to = from.wrapping_add(self.table.moves[index as usize & 15]);
            if tie | (past_second & !past_first) | (d > limit) | (to >= voids) {
                kept = self.attempt(j, draw, kept);
            } else {
                self.void[kept] = to;
                self.diameter[kept] = d;
                kept += 1;
            }
        }
        kept
    }

    /// The attempt of particle `j` in full; `kept` before it still move.
    pub fn attempt(&mut self, j: usize, draw: u16, kept: usize) -> usize {
        let (from, d) = (self.void[j], self.diameter[j]);
        let entry = self.table.entry[from as usize];
        let (first, second, top) = (entry >> 17, entry >> 2 & 0x7fff, u32::from(draw >> 1));
        if first > second {
            self.events.stranded.push((from, d));
            return kept;
        }
        let exit = if top == first || top == second {
            undecided(self.exits, from, self.lanes.extension().complete(draw, j as u64))
        } else {
            u32::from(top >= first) + u32::from(top >= second)
        };
        if d > self.exits.passive_limit && d > self.exits.network.diameters()[(3 * from + exit) as usize] {
            self.events.stopped.push((3 * from + exit, d));
            return kept;
        }
        let to = self.table.target(from, exit, entry);
        if to >= self.table.entry.len() as u32 {
            self.events.eroded.push(d);
            return kept;
        }
        self.void[kept] = to;
        self.diameter[kept] = d;
        kept + 1
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

/// Exit picked by a draw whose fifteen top bits equal a threshold's, in a void with an open exit.
#[cold]
fn undecided(exits: &OpenExits, void: u32, draw: u64) -> u32 {
    let mut thresholds = Vec::with_capacity(3);
    let last_open = exits::thresholds(exits.network, exits.blocked, void, &mut thresholds);
    let last_open = last_open.expect("thresholds in order say that an exit is open");
    thresholds.iter().position(|&t| draw < t).unwrap_or(last_open) as u32
}
