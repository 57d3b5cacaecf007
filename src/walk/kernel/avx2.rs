//! The step on the cubic lattice with AVX2: eight particles at once, as [`super::avx512`] does sixteen.

use std::arch::x86_64::*;

use super::lattice::{BELOW_FIRST, LatticeChunk, SECOND, fits_gathers};
use crate::stream::{DRAWS_PER_BLOCK, LANES, draw16};
use crate::walk::Isa;

const WIDTH: usize = 8;

/// By mask of the lanes that leave: the lanes that stay, in order, then any.
static STAYING: [[u32; WIDTH]; 1 << WIDTH] = staying();

const fn staying() -> [[u32; WIDTH]; 1 << WIDTH] {
    let mut table = [[0; WIDTH]; 1 << WIDTH];
    let mut gone = 0;
    while gone < 1 << WIDTH {
        let (mut lane, mut kept) = (0, 0);
        while lane < WIDTH {
            if gone >> lane & 1 == 0 {
                table[gone][kept] = lane as u32;
                kept += 1;
            }
            lane += 1;
        }
        gone += 1;
    }
    table
}

/// Moves the particles of one chunk; returns how many still move.
pub(super) fn step(chunk: LatticeChunk) -> usize {
    assert!(Isa::Avx2.is_available() && fits_gathers(chunk.table));
    // SAFETY: the machine has the instructions.
    unsafe { step_vectors(chunk) }
}

#[target_feature(enable = "avx2,popcnt")]
fn step_vectors(mut chunk: LatticeChunk) -> usize {
    let count = chunk.void.len();
    assert_eq!(count, chunk.diameter.len());
    assert_eq!(chunk.exits.network.diameters().len(), 3 * chunk.table.entry.len());
    let mut lanes = chunk.lanes.clone();
    let mut kept = 0;
    for begin in (0..count).step_by(DRAWS_PER_BLOCK) {
        let block = lanes.next_block();
        if begin + DRAWS_PER_BLOCK > count {
            return chunk.step_block(begin, count, &block, kept);
        }
        for (quarter, words) in block.as_chunks::<2>().0.iter().enumerate() {
            kept = step_eight(&mut chunk, begin + WIDTH * quarter, words, kept);
        }
    }
    kept
}

/// Moves particles `begin .. begin + 8` by the eight draws in `words`; `kept <= begin` before them still
/// move.
#[inline]
#[target_feature(enable = "avx2,popcnt")]
fn step_eight(chunk: &mut LatticeChunk, begin: usize, words: &[u64; 2], kept: usize) -> usize {
    assert!(kept <= begin && begin + WIDTH <= chunk.void.len() && begin + WIDTH <= chunk.diameter.len());
    let table = chunk.table;
    let last = _mm256_set1_epi32(table.entry.len() as i32 - 1);
    // SAFETY: eight entries from `begin` on are within both columns, as asserted.
    let (from, d) = unsafe {
        (
            _mm256_loadu_si256(chunk.void.as_ptr().add(begin).cast()),
            _mm256_loadu_ps(chunk.diameter.as_ptr().add(begin)),
        )
    };
    let within = _mm256_min_epu32(from, last);
    let inside = _mm256_cmpeq_epi32(within, from);
    // SAFETY: `within` is less than the table's length, which fits an i32.
    let entry = unsafe { _mm256_i32gather_epi32::<4>(table.entry.as_ptr().cast(), within) };

    // There is no unsigned comparison: `a >= b` where `min(a, b) == b`.
    let below = _mm256_set1_epi32(BELOW_FIRST as i32);
    // SAFETY: two words are sixteen bytes.
    let draws = unsafe { _mm_loadu_si128(words.as_ptr().cast()) };
    let top = _mm256_or_si256(_mm256_slli_epi32::<16>(_mm256_cvtepu16_epi32(draws)), below);
    let second = _mm256_slli_epi32::<{ SECOND as i32 }>(entry);
    let past_first = _mm256_cmpeq_epi32(_mm256_min_epu32(top, entry), entry);
    let past_second = _mm256_cmpeq_epi32(_mm256_min_epu32(top, second), second);
    let nearest = _mm256_min_epu32(_mm256_xor_si256(top, entry), _mm256_xor_si256(top, second));
    let tie = _mm256_cmpeq_epi32(_mm256_srli_epi32::<17>(nearest), _mm256_setzero_si256());
    // The first threshold is above the second only where every exit is closed.
    let closed = _mm256_andnot_si256(past_first, past_second);
    let stranded = bits(closed);
    if bits(tie) | !bits(inside) & 0xff != 0 {
        return step_singly(chunk, begin, words, kept);
    }

    // The first eight entries of `moves`: those of the first two exits.
    // SAFETY: `moves` has sixteen entries.
    let moves = unsafe { _mm256_loadu_si256(table.moves.as_ptr().cast()) };
    let sideways = _mm256_or_si256(
        _mm256_and_si256(entry, _mm256_set1_epi32(3)),
        _mm256_and_si256(past_first, _mm256_set1_epi32(4)),
    );
    let downstream = _mm256_set1_epi32(table.moves[15] as i32);
    let by = _mm256_blendv_epi8(_mm256_permutevar8x32_epi32(moves, sideways), downstream, past_second);
    let to = _mm256_add_epi32(from, by);
    // Neither reaches 2^31.
    let out = bits(_mm256_cmpgt_epi32(to, last));

    let coarse = _mm256_cmp_ps::<_CMP_GT_OQ>(d, _mm256_set1_ps(chunk.exits.passive_limit));
    let mut stays = stranded;
    if stranded != 0 {
        note(&mut chunk.events.stranded, from, d, stranded);
    }
    let able = _mm256_andnot_ps(_mm256_castsi256_ps(closed), coarse);
    if _mm256_movemask_ps(able) != 0 {
        // A true lane is -1.
        let exit = _mm256_add_epi32(past_first, past_second);
        let constriction = _mm256_sub_epi32(_mm256_add_epi32(from, _mm256_slli_epi32::<1>(from)), exit);
        let diameters = chunk.exits.network.diameters();
        // SAFETY: voids are less than the table's length and exits less than 3, so that constrictions are
        // less than 3 times it, the number of diameters.
        let width = unsafe {
            _mm256_mask_i32gather_ps::<4>(_mm256_setzero_ps(), diameters.as_ptr(), constriction, able)
        };
        let coarser = _mm256_and_ps(able, _mm256_cmp_ps::<_CMP_GT_OQ>(d, width));
        let stopped = _mm256_movemask_ps(coarser) as u32;
        if stopped != 0 {
            note(&mut chunk.events.stopped, constriction, d, stopped);
            stays |= stopped;
        }
    }
    let gone = out | stays;
    let (mut to, mut d) = (to, d);
    if gone != 0 {
        note_eroded(chunk, d, out & !stays);
        // SAFETY: a row of the table has eight entries.
        let order = unsafe { _mm256_loadu_si256(STAYING[gone as usize].as_ptr().cast()) };
        to = _mm256_permutevar8x32_epi32(to, order);
        d = _mm256_permutevar8x32_ps(d, order);
    }
    // SAFETY: `kept <= begin`, so eight entries from `kept` on are within both columns.
    unsafe {
        _mm256_storeu_si256(chunk.void.as_mut_ptr().add(kept).cast(), to);
        _mm256_storeu_ps(chunk.diameter.as_mut_ptr().add(kept), d);
    }
    kept + WIDTH - gone.count_ones() as usize
}

/// One bit a lane.
#[inline]
#[target_feature(enable = "avx2")]
fn bits(lanes: __m256i) -> u32 {
    _mm256_movemask_ps(_mm256_castsi256_ps(lanes)) as u32
}

#[cold]
#[inline(never)]
fn step_singly(chunk: &mut LatticeChunk, begin: usize, words: &[u64; 2], mut kept: usize) -> usize {
    let mut block = [0; LANES];
    block[..2].copy_from_slice(words);
    for j in 0..WIDTH {
        kept = chunk.attempt(begin + j, draw16(&block, j), kept);
    }
    kept
}

/// Appends place and diameter of some lanes.
#[inline]
#[target_feature(enable = "avx2")]
fn note(column: &mut Vec<(u32, f32)>, place: __m256i, d: __m256, lanes: u32) {
    let (mut places, mut diameters) = ([0u32; WIDTH], [0f32; WIDTH]);
    // SAFETY: both arrays have eight entries.
    unsafe {
        _mm256_storeu_si256(places.as_mut_ptr().cast(), place);
        _mm256_storeu_ps(diameters.as_mut_ptr(), d);
    }
    let lanes = (0..WIDTH).filter(|lane| lanes >> lane & 1 != 0);
    column.extend(lanes.map(|lane| (places[lane], diameters[lane])));
}

#[inline]
#[target_feature(enable = "avx2")]
fn note_eroded(chunk: &mut LatticeChunk, d: __m256, mut eroded: u32) {
    let mut diameters = [0f32; WIDTH];
    // SAFETY: eight entries.
    unsafe { _mm256_storeu_ps(diameters.as_mut_ptr(), d) };
    while eroded != 0 {
        chunk.events.eroded.push(diameters[eroded.trailing_zeros() as usize % WIDTH]);
        eroded &= eroded - 1;
    }
}
