//! The step on the cubic lattice with AVX-512: sixteen particles at once.
//!
//! The generator stays in four registers; the words of sixteen voids are gathered; constriction
//! diameters are gathered for particles that are not passive alone. Particles that still move are
//! brought together in a register and stored as whole vectors: what lies behind them has been read. Sixteen
//! particles among which a draw ties with a threshold go the long way one by one.

use std::arch::x86_64::*;

use super::lattice::{BELOW_FIRST, LatticeChunk, PAST_FIRST, PAST_SECOND, SECOND, fits_gathers};
use crate::stream::{DRAWS_PER_BLOCK, LANES, Lanes, draw16};
use crate::walk::Isa;

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
    let diameters = chunk.exits.network.diameters();
    let table = &chunk.table.entry[..];
    assert_eq!(count, chunk.diameter.len());
    assert_eq!(diameters.len(), 3 * table.len());
    let voids = _mm512_set1_epi32(table.len() as i32);
    let limit = _mm512_set1_ps(chunk.exits.passive_limit);
    let below = _mm512_set1_epi32(BELOW_FIRST as i32);
    // SAFETY: `moves` has sixteen entries.
    let moves = unsafe { _mm512_loadu_si512(chunk.table.moves.as_ptr().cast()) };

    let mut state = load_state(&chunk.lanes);
    let mut draws = _mm512_setzero_si512();
    let mut kept = 0;
    let mut begin = 0;
    while begin + WIDTH <= count {
        draws = match begin % DRAWS_PER_BLOCK {
            0 => next_block(&mut state),
            _ => _mm512_shuffle_i64x2::<0b1110>(draws, draws),
        };
        // SAFETY: sixteen entries from `begin` on are within both columns, which are `count` long.
        let (from, d) = unsafe {
            (
                _mm512_loadu_si512(chunk.void.as_ptr().add(begin).cast()),
                _mm512_loadu_ps(chunk.diameter.as_ptr().add(begin)),
            )
        };
        let inside = _mm512_cmplt_epu32_mask(from, voids);
        let zero = _mm512_setzero_si512();
        // SAFETY: the lanes read are those whose void is less than the table's length, which fits an i32.
        let entry = unsafe { _mm512_mask_i32gather_epi32::<4>(zero, inside, from, table.as_ptr().cast()) };

        let draw = _mm512_cvtepu16_epi32(_mm512_castsi512_si256(draws));
        let top = _mm512_or_si512(_mm512_slli_epi32::<16>(draw), below);
        let second = _mm512_slli_epi32::<SECOND>(entry);
        let past_first = _mm512_cmpge_epu32_mask(top, entry);
        let past_second = _mm512_cmpge_epu32_mask(top, second);
        let nearest = _mm512_min_epu32(_mm512_xor_si512(top, entry), _mm512_xor_si512(top, second));
        let tie = _mm512_cmple_epu32_mask(nearest, below);
        let long_way = tie | !inside;
        // The first threshold is above the second only where every exit is closed.
        let stranded = past_second & !past_first;

        let mut index = _mm512_and_si512(entry, _mm512_set1_epi32(3));
        index = _mm512_mask_or_epi32(index, past_first, index, _mm512_set1_epi32(PAST_FIRST as i32));
        index = _mm512_mask_or_epi32(index, past_second, index, _mm512_set1_epi32(PAST_SECOND as i32));
        let to = _mm512_add_epi32(from, _mm512_permutexvar_epi32(index, moves));
        let out = _mm512_cmpge_epu32_mask(to, voids);
        let coarse = _mm512_cmp_ps_mask::<_CMP_GT_OQ>(d, limit);

        let mut stays = 0;
        if coarse | stranded | long_way != 0 {
            if long_way != 0 {
                kept = step_singly(&mut chunk, begin, draws, kept);
                begin += WIDTH;
                continue;
            }
            stays = stranded;
            let able = coarse & !stranded;
            if able != 0 {
                let constriction = constriction(from, past_first, past_second);
                // SAFETY: voids are less than the table's length (no lane is outside here) and exits less
                // than 3, so that constrictions are less than 3 times it, the number of diameters.
                let width = unsafe {
                    _mm512_mask_i32gather_ps::<4>(_mm512_setzero_ps(), able, constriction, diameters.as_ptr())
                };
                let stopped = _mm512_mask_cmp_ps_mask::<_CMP_GT_OQ>(able, d, width);
                note(&mut chunk.events.stopped, constriction, d, stopped);
                stays |= stopped;
            }
            note(&mut chunk.events.stranded, from, d, stranded);
        }
        let gone = out | stays;
        let (mut to, mut d) = (to, d);
        if gone != 0 {
            note_eroded(&mut chunk.events.eroded, d, out & !stays);
            to = _mm512_maskz_compress_epi32(!gone, to);
            d = _mm512_maskz_compress_ps(!gone, d);
        }
        // SAFETY: `kept <= begin`, so sixteen entries from `kept` on are within both columns; all up to
        // `begin + 16` have been read.
        unsafe {
            _mm512_storeu_si512(chunk.void.as_mut_ptr().add(kept).cast(), to);
            _mm512_storeu_ps(chunk.diameter.as_mut_ptr().add(kept), d);
        }
        kept += WIDTH - gone.count_ones() as usize;
        begin += WIDTH;
    }
    if begin < count {
        let words = match begin % DRAWS_PER_BLOCK {
            0 => words_of(next_block(&mut state)),
            _ => words_of(_mm512_shuffle_i64x2::<0b1110>(draws, draws)),
        };
        kept = chunk.step_block(begin, count, &words, kept);
    }
    kept
}

/// Constriction that each lane's draw picks.
#[inline]
#[target_feature(enable = "avx512f")]
fn constriction(from: __m512i, past_first: __mmask16, past_second: __mmask16) -> __m512i {
    let one = _mm512_set1_epi32(1);
    let first = _mm512_add_epi32(from, _mm512_slli_epi32::<1>(from));
    let exit = _mm512_mask_add_epi32(first, past_first, first, one);
    _mm512_mask_add_epi32(exit, past_second, exit, one)
}

#[cold]
#[inline(never)]
#[target_feature(enable = "avx512f")]
fn step_singly(chunk: &mut LatticeChunk, begin: usize, draws: __m512i, mut kept: usize) -> usize {
    let words = words_of(draws);
    for j in 0..WIDTH {
        kept = chunk.attempt(begin + j, draw16(&words, j), kept);
    }
    kept
}

/// Appends place and diameter of some lanes.
#[inline]
#[target_feature(enable = "avx512f")]
fn note(column: &mut Vec<(u32, f32)>, place: __m512i, d: __m512, lanes: __mmask16) {
    if lanes == 0 {
        return;
    }
    let (mut places, mut diameters) = ([0u32; WIDTH], [0f32; WIDTH]);
    // SAFETY: both arrays have sixteen entries.
    unsafe {
        _mm512_storeu_si512(places.as_mut_ptr().cast(), _mm512_maskz_compress_epi32(lanes, place));
        _mm512_storeu_ps(diameters.as_mut_ptr(), _mm512_maskz_compress_ps(lanes, d));
    }
    let pairs = places.into_iter().zip(diameters);
    column.extend(pairs.take(lanes.count_ones() as usize));
}

#[inline]
#[target_feature(enable = "avx512f,popcnt")]
fn note_eroded(column: &mut Vec<f32>, d: __m512, eroded: __mmask16) {
    column.reserve(WIDTH);
    // SAFETY: there is room for sixteen, of which the first as many as lanes eroded are values.
    unsafe {
        _mm512_storeu_ps(column.as_mut_ptr().add(column.len()), _mm512_maskz_compress_ps(eroded, d));
        column.set_len(column.len() + eroded.count_ones() as usize);
    }
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

#[inline]
#[target_feature(enable = "avx512f")]
fn words_of(block: __m512i) -> [u64; LANES] {
    let mut words = [0; LANES];
    // SAFETY: eight words.
    unsafe { _mm512_storeu_si512(words.as_mut_ptr().cast(), block) };
    words
}
