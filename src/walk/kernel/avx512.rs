//! The step on the cubic lattice with AVX-512: sixteen particles at once.
//!
//! The generator stays in four registers; the words of sixteen voids are gathered; constriction
//! diameters are gathered for particles alone that may be coarser than the void's finest open exit. Particles
//! that still move are brought together in a register and stored as whole vectors: what lies behind them has
//! been read. Only draws that tie with a threshold are looked at one by one.

use std::arch::x86_64::*;

use super::lattice::{BELOW, BLOCK, CLASS_UP, LatticeChunk, PAST_FIRST, PAST_SECOND, fits_gathers};
use crate::stream::{DRAWS_PER_BLOCK, LANES, Lanes, draw16};
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
    let diameters = chunk.exits.network.diameters();
    let table = &chunk.table.entry[..];
    assert_eq!(count, chunk.diameter.len());
    assert_eq!(diameters.len(), 3 * table.len());
    let voids = _mm512_set1_epi32(table.len() as i32);
    let below = _mm512_set1_epi32(BELOW as i32);
    let finest = _mm512_set1_epi32(chunk.table.finest as i32);
    // SAFETY: `moves` has sixteen entries.
    let moves = unsafe { _mm512_loadu_si512(chunk.table.moves.as_ptr().cast()) };

    let mut state = load_state(&chunk.lanes);
    let mut draws = _mm512_setzero_si512();
    let mut kept = 0;
    let whole = count - count % BLOCK;
    for begin in (0..whole).step_by(WIDTH) {
        draws = match begin % DRAWS_PER_BLOCK {
            0 => next_block(&mut state),
            _ => _mm512_shuffle_i64x2::<0b1110>(draws, draws),
        };
        // SAFETY: sixteen entries from `begin` on are within both columns, which are `count` long.
        let (from, d) = unsafe {
            (
                _mm512_loadu_si512(chunk.void.as_ptr().add(begin).cast()),
                _mm512_loadu_si512(chunk.diameter.as_ptr().add(begin).cast()),
            )
        };
        let inside = _mm512_cmplt_epu32_mask(from, voids);
        let zero = _mm512_setzero_si512();
        // SAFETY: the lanes read are those whose void is less than the table's length, which fits an i32.
        let entry = unsafe { _mm512_mask_i32gather_epi32::<4>(zero, inside, from, table.as_ptr().cast()) };
        let draw = _mm512_cvtepu16_epi32(_mm512_castsi512_si256(draws));
        let draw = _mm512_or_si512(_mm512_or_si512(draw, _mm512_slli_epi32::<16>(draw)), below);

        // Where the upper halves are equal there is a tie.
        let mut past_second = _mm512_cmpge_epu32_mask(draw, entry);
        let mut past_first =
            _mm512_cmpge_epu32_mask(_mm512_slli_epi32::<16>(draw), _mm512_slli_epi32::<16>(entry));
        let differ = _mm512_andnot_si512(below, _mm512_xor_si512(entry, draw));
        let low = _mm512_set1_epi32(0xffff);
        let tie = _mm512_cmple_epu32_mask(differ, low) | _mm512_testn_epi32_mask(differ, low);
        if tie | !inside != 0 {
            assert!(inside == !0, "a void that the network does not have");
            [past_first, past_second] = decide(&chunk, begin, draws, tie, [past_first, past_second]);
        }
        let mut index = _mm512_and_si512(entry, _mm512_set1_epi32(3));
        index = _mm512_mask_or_epi32(index, past_first, index, _mm512_set1_epi32(PAST_FIRST as i32));
        index = _mm512_mask_or_epi32(index, past_second, index, _mm512_set1_epi32(PAST_SECOND as i32));
        let to = _mm512_add_epi32(from, _mm512_permutexvar_epi32(index, moves));
        let out = _mm512_cmpge_epu32_mask(to, voids);
        let class = _mm512_and_si512(entry, _mm512_set1_epi32(CLASS as i32));
        let coarse =
            _mm512_cmpgt_epi32_mask(d, _mm512_add_epi32(finest, _mm512_slli_epi32::<CLASS_UP>(class)));
        // The first threshold is above the second only where every exit is closed.
        let stranded = past_second & !past_first;
        let mut stays = 0;
        if coarse | stranded != 0 {
            let able = coarse & !stranded;
            let constriction = constriction(from, past_first, past_second);
            // SAFETY: voids are less than the table's length (no lane is outside here) and exits less than 3,
            // so that constrictions are less than 3 times it, the number of diameters.
            let width = unsafe {
                _mm512_mask_i32gather_epi32::<4>(zero, able, constriction, diameters.as_ptr().cast())
            };
            let stopped = _mm512_mask_cmpgt_epi32_mask(able, d, width);
            note(&mut chunk.events.stopped, constriction, d, stopped);
            note(&mut chunk.events.stranded, from, d, stranded);
            stays = stranded | stopped;
        }
        let gone = out | stays;
        let (mut to, mut d) = (to, d);
        if gone != 0 {
            note_eroded(&mut chunk.events.eroded, d, out & !stays);
            to = _mm512_maskz_compress_epi32(!gone, to);
            d = _mm512_maskz_compress_epi32(!gone, d);
        }
        // SAFETY: `kept <= begin`, so sixteen entries from `kept` on are within both columns; all up to
        // `begin + 16` have been read.
        unsafe {
            _mm512_storeu_si512(chunk.void.as_mut_ptr().add(kept).cast(), to);
            _mm512_storeu_si512(chunk.diameter.as_mut_ptr().add(kept).cast(), d);
        }
        kept += WIDTH - gone.count_ones() as usize;
    }
    chunk.step_rest(|| block_of(next_block(&mut state)), kept)
}

/// Which thresholds the draws of the lanes in `ties` are past, by all bits of the draws; the other lanes as
/// they are.
#[cold]
#[inline(never)]
#[target_feature(enable = "avx512f")]
fn decide(
    chunk: &LatticeChunk,
    begin: usize,
    draws: __m512i,
    mut ties: __mmask16,
    [mut first, mut second]: [__mmask16; 2],
) -> [__mmask16; 2] {
    let words = block_of(draws);
    while ties != 0 {
        let j = ties.trailing_zeros() as usize;
        ties &= ties - 1;
        let exit = chunk.undecided(chunk.void[begin + j], begin + j, draw16(&words, j));
        // No open exit: past the second and not the first.
        let (past_first, past_second) = (matches!(exit, Some(1 | 2)), matches!(exit, None | Some(2)));
        first = first & !(1 << j) | u16::from(past_first) << j;
        second = second & !(1 << j) | u16::from(past_second) << j;
    }
    [first, second]
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

/// Appends place and diameter of some lanes.
#[inline]
#[target_feature(enable = "avx512f")]
fn note(column: &mut Vec<(u32, f32)>, place: __m512i, d: __m512i, lanes: __mmask16) {
    if lanes == 0 {
        return;
    }
    let (mut places, mut diameters) = ([0u32; WIDTH], [0f32; WIDTH]);
    // SAFETY: both arrays have sixteen entries.
    unsafe {
        _mm512_storeu_si512(places.as_mut_ptr().cast(), _mm512_maskz_compress_epi32(lanes, place));
        _mm512_storeu_si512(diameters.as_mut_ptr().cast(), _mm512_maskz_compress_epi32(lanes, d));
    }
    let pairs = places.into_iter().zip(diameters);
    column.extend(pairs.take(lanes.count_ones() as usize));
}

#[inline]
#[target_feature(enable = "avx512f,popcnt")]
fn note_eroded(column: &mut Vec<f32>, d: __m512i, eroded: __mmask16) {
    column.reserve(WIDTH);
    // SAFETY: there is room for sixteen, of which the first as many as lanes eroded are values.
    unsafe {
        let end = column.as_mut_ptr().add(column.len());
        _mm512_storeu_si512(end.cast(), _mm512_maskz_compress_epi32(eroded, d));
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
fn block_of(block: __m512i) -> [u64; LANES] {
    let mut words = [0; LANES];
    // SAFETY: eight words.
    unsafe { _mm512_storeu_si512(words.as_mut_ptr().cast(), block) };
    words
}
