//! The step on the cubic lattice with AVX-512: sixteen particles at once.
//!
//! The generator stays in four registers; the words of sixteen voids are gathered.

use std::arch::x86_64::*;

use super::lattice::{BELOW, BLOCK, CLASS_UP, Draws, LatticeChunk, PAST_FIRST, PAST_SECOND, fits_gathers};
use crate::stream::{LANES, Lanes};
use crate::walk::Isa;
use crate::walk::exits::CLASS;

const WIDTH: usize = 16;

/// Moves the particles of one chunk; returns how many still move.
pub(super) fn step(chunk: LatticeChunk) -> usize {
    assert!(Isa::Avx512.is_available() && fits_gathers(chunk.table));
    // SAFETY: the machine has the instructions.
    unsafe { step_vectors(chunk) }
}

#[target_feature(enable = "avx512f,avx512bw,avx512dq,avx512vl,popcnt")]
fn step_vectors(mut chunk: LatticeChunk) -> usize {
    let count = chunk.void.len();
    let mut state = load_state(&chunk.lanes);
    let mut kept = 0;
    for begin in (0..count - count % BLOCK).step_by(BLOCK) {
        let draws = [next_block(&mut state), next_block(&mut state)];
        let rare = predict(&mut chunk, begin, &draws, kept);
        let gone = if rare == 0 { 0 } else { chunk.settle(begin, &words_of(draws), rare, kept) };
        kept = if gone == 0 { kept + BLOCK } else { close_up(&mut chunk, kept, gone) };
    }
    chunk.step_rest(|| block_of(next_block(&mut state)), kept)
}

/// As [`super::lattice`]'s.
#[inline]
#[target_feature(enable = "avx512f,avx512bw,avx512dq,avx512vl,popcnt")]
fn predict(chunk: &mut LatticeChunk, begin: usize, draws: &[__m512i; 2], kept: usize) -> u64 {
    assert!(kept <= begin && begin + BLOCK <= chunk.void.len() && begin + BLOCK <= chunk.diameter.len());
    let table = chunk.table;
    let voids = _mm512_set1_epi32(table.entry.len() as i32);
    let below = _mm512_set1_epi32(BELOW as i32);
    let finest = _mm512_set1_epi32(table.finest as i32);
    // SAFETY: `moves` has sixteen entries.
    let moves = unsafe { _mm512_loadu_si512(table.moves.as_ptr().cast()) };
    let mut inside = !0;
    let mut rare = 0;
    for group in 0..BLOCK / WIDTH {
        let at = begin + WIDTH * group;
        // SAFETY: sixteen entries from `at` on are within both columns, as asserted.
        let (from, d) = unsafe {
            (
                _mm512_loadu_si512(chunk.void.as_ptr().add(at).cast()),
                _mm512_loadu_si512(chunk.diameter.as_ptr().add(at).cast()),
            )
        };
        let within = _mm512_cmplt_epu32_mask(from, voids);
        inside &= within;
        let zero = _mm512_setzero_si512();
        // SAFETY: the lanes read are those whose void is less than the table's length, which fits an i32.
        let entry =
            unsafe { _mm512_mask_i32gather_epi32::<4>(zero, within, from, table.entry.as_ptr().cast()) };
        let draw = match group % 2 {
            0 => _mm512_castsi512_si256(draws[group / 2]),
            _ => _mm512_extracti64x4_epi64::<1>(draws[group / 2]),
        };
        let draw = _mm512_cvtepu16_epi32(draw);
        let upper = _mm512_slli_epi32::<16>(draw);
        let draw = _mm512_or_si512(_mm512_or_si512(draw, upper), below);

        // Where the upper halves are equal there is a tie.
        let past_second = _mm512_cmpge_epu32_mask(draw, entry);
        let past_first =
            _mm512_cmpge_epu32_mask(_mm512_slli_epi32::<16>(draw), _mm512_slli_epi32::<16>(entry));
        let differ = _mm512_andnot_si512(below, _mm512_xor_si512(entry, draw));
        let low = _mm512_set1_epi32(0xffff);
        let tie = _mm512_cmple_epu32_mask(differ, low) | _mm512_testn_epi32_mask(differ, low);
        let mut index = _mm512_and_si512(entry, _mm512_set1_epi32(3));
        index = _mm512_mask_or_epi32(index, past_first, index, _mm512_set1_epi32(PAST_FIRST as i32));
        index = _mm512_mask_or_epi32(index, past_second, index, _mm512_set1_epi32(PAST_SECOND as i32));
        let to = _mm512_add_epi32(from, _mm512_permutexvar_epi32(index, moves));
        let class = _mm512_and_si512(entry, _mm512_set1_epi32(CLASS as i32));
        let passes = _mm512_add_epi32(finest, _mm512_slli_epi32::<CLASS_UP>(class));
        let coarse = _mm512_cmpgt_epi32_mask(d, passes);
        // The first threshold is above the second only where every exit is closed.
        // The first threshold is above the second only where every exit is closed.
        let long_way = _mm512_cmpge_epu32_mask(to, voids) | tie | coarse | past_second & !past_first;
        rare |= u64::from(long_way) << (WIDTH * group);
        let to = _mm512_mask_mov_epi32(to, long_way, from);
        let place = kept + WIDTH * group;
        // SAFETY: `place <= at`, so sixteen entries from there on are within both columns; those up to
        // `at + 16` have been read.
        unsafe {
            _mm512_storeu_si512(chunk.void.as_mut_ptr().add(place).cast(), to);
            _mm512_storeu_si512(chunk.diameter.as_mut_ptr().add(place).cast(), d);
        }
    }
    assert!(inside == !0, "a void that the network does not have");
    rare
}

/// Closes up the block of particles from `kept` on over those that are gone; returns where it ends then.
#[inline]
#[target_feature(enable = "avx512f,popcnt")]
fn close_up(chunk: &mut LatticeChunk, kept: usize, gone: u64) -> usize {
    assert!(kept + BLOCK <= chunk.void.len() && kept + BLOCK <= chunk.diameter.len());
    let (void, diameter) = (chunk.void.as_mut_ptr(), chunk.diameter.as_mut_ptr());
    let mut end = kept;
    for group in 0..BLOCK / WIDTH {
        let (at, stays) = (kept + WIDTH * group, !(gone >> (WIDTH * group)) as __mmask16);
        // SAFETY: `at + 16` and `end + 16` are within both columns, since `end <= at`; and what is written over
        // has been read.
        unsafe {
            let (place, d) =
                (_mm512_loadu_si512(void.add(at).cast()), _mm512_loadu_si512(diameter.add(at).cast()));
            _mm512_storeu_si512(void.add(end).cast(), _mm512_maskz_compress_epi32(stays, place));
            _mm512_storeu_si512(diameter.add(end).cast(), _mm512_maskz_compress_epi32(stays, d));
        }
        end += stays.count_ones() as usize;
    }
    end
}

/// The generators of a stream, one state word by register.
#[inline]
#[target_feature(enable = "avx512f")]
fn load_state(lanes: &Lanes) -> [__m512i; 4] {
    // SAFETY: each row of the state has eight words.
    lanes.state().each_ref().map(|row| unsafe { _mm512_loadu_si512(row.as_ptr().cast()) })
}

/// [`Lanes::next_block`] in registers.
#[inline]
#[target_feature(enable = "avx512f")]
fn next_block(state: &mut [__m512i; 4]) -> __m512i {
    let [s0, s1, s2, s3] = *state;
    let out = _mm512_add_epi64(_mm512_rol_epi64::<23>(_mm512_add_epi64(s0, s3)), s0);
    let t = _mm512_slli_epi64::<17>(s1);
    let s2 = _mm512_xor_si512(s2, s0);
    let s3 = _mm512_xor_si512(s3, s1);
    let s1 = _mm512_xor_si512(s1, s2);
    let s0 = _mm512_xor_si512(s0, s3);
    *state = [s0, s1, _mm512_xor_si512(s2, t), _mm512_rol_epi64::<45>(s3)];
    out
}

/// The words of two blocks of the stream.
#[inline]
#[target_feature(enable = "avx512f")]
fn words_of(blocks: [__m512i; 2]) -> Draws {
    bytemuck::cast(blocks.map(|block| block_of(block)))
}

#[inline]
#[target_feature(enable = "avx512f")]
fn block_of(block: __m512i) -> [u64; LANES] {
    let mut words = [0; LANES];
    // SAFETY: eight words.
    unsafe { _mm512_storeu_si512(words.as_mut_ptr().cast(), block) };
    words
}
