//! Step on the cubic lattice with AVX-512: sixteen particles at once.
//!
//! The generator stays in four registers; constriction diameters are gathered only for particles that may
//! be coarser than the void's finest open exit. Particles that still move are compacted in a register and
//! stored as whole vectors, since the entries overwritten have been read. Only draws that tie with a
//! threshold are processed one by one.

use super::avx2;
use super::lattice::{BLOCK, CLASS_UP, LatticeChunk, PAST_FIRST, PAST_SECOND, fits_gathers};
use crate::stream::{DRAWS_PER_BLOCK, LANES, Lanes, draw16, next_of_eight};
use crate::walk::Isa;
use crate::walk::arching::{CLASS_OF_ONE, Reach};
use crate::walk::exits::{CLASS, Lattice, Reads};
use std::arch::x86_64::*;

const WIDTH: usize = 16;

/// Moves the particles of one chunk; returns the number still moving.
pub(super) fn step<R: Reads>(chunk: LatticeChunk) -> usize {
    assert!(Isa::Avx512.is_available() && fits_gathers(chunk.table));
    // SAFETY: the machine supports the instructions.
    unsafe { step_vectors::<R>(chunk) }
}

#[target_feature(enable = "avx512f,avx512bw,avx512dq,avx512vl,popcnt")]
fn step_vectors<R: Reads>(mut chunk: LatticeChunk) -> usize {
    let count = chunk.void.len();
    let widths = chunk.exits.widths;
    let words = chunk.table.words::<R>();
    assert_eq!(count, chunk.diameter.len());
    assert_eq!(widths.len(), 3 * words.len());
    let voids = _mm512_set1_epi32(words.len() as i32);
    let below = _mm512_set1_epi32(Lattice::below::<R>() as i32);
    let finest = _mm512_set1_epi32(chunk.table.finest as i32);
    // SAFETY: `moves` has sixteen entries.
    let moves = unsafe { _mm512_loadu_si512(chunk.table.moves.as_ptr().cast()) };
    let zero = _mm512_setzero_si512();
    let halves = [twice(0), twice(WIDTH as i32)];

    let reach = R::JAMS.then(|| load_reach(chunk.reach()));
    let mut state = load_state(&chunk.lanes);
    let mut jam_state = load_state(&chunk.jam_lanes::<R>());
    let mut kept = 0;
    for block in (0..count - count % BLOCK).step_by(DRAWS_PER_BLOCK) {
        chunk.fetch_ahead(block, DRAWS_PER_BLOCK);
        let draws = next_of_eight(&mut state);
        let jam_draws = if R::JAMS { next_of_eight(&mut jam_state) } else { zero };
        for (half, twice) in halves.into_iter().enumerate() {
            let begin = block + WIDTH * half;
            // SAFETY: sixteen entries from `begin` on are within both columns, which are `count` long.
            let (from, d) = unsafe {
                (
                    _mm512_loadu_si512(chunk.void.as_ptr().add(begin).cast()),
                    _mm512_loadu_si512(chunk.diameter.as_ptr().add(begin).cast()),
                )
            };
            let inside = _mm512_cmplt_epu32_mask(from, voids);
            assert!(inside == !0, "a void that the network does not have");
            // SAFETY: sixteen entries, each less than the table's length.
            let word = unsafe { look_up(words, chunk.void.as_ptr().add(begin)) };
            let draw = _mm512_or_si512(_mm512_permutexvar_epi16(twice, draws), below);

            // Upper half of a lane: draw at least the second threshold. Lower half: draw at least the first.
            let past = _mm512_movm_epi16(_mm512_cmpge_epu16_mask(draw, word));
            let tie = _mm512_cmpeq_epu16_mask(_mm512_or_si512(word, below), draw);
            let past_first = _mm512_and_si512(past, _mm512_set1_epi32(PAST_FIRST as i32));
            let past_second =
                _mm512_and_si512(_mm512_srli_epi32::<16>(past), _mm512_set1_epi32(PAST_SECOND as i32));
            let wraps = _mm512_and_si512(word, _mm512_set1_epi32(3));
            let mut index = _mm512_or_si512(_mm512_or_si512(wraps, past_first), past_second);
            if tie != 0 {
                index = decide(&chunk, begin, draws, half, tie, index);
            }
            let mut to = _mm512_add_epi32(from, _mm512_permutexvar_epi32(index, moves));
            // Includes particles without an open exit.
            let out = _mm512_cmpge_epu32_mask(to, voids);
            let mut passes = finest;
            if R::CLASSED {
                let class = _mm512_and_si512(word, _mm512_set1_epi32(CLASS as i32));
                passes = _mm512_add_epi32(finest, _mm512_slli_epi32::<CLASS_UP>(class));
            }
            let mut size = d;
            if let Some(reach) = reach {
                let reach = reach_of(reach, half_of(jam_draws, half));
                size = _mm512_castps_si512(_mm512_mul_ps(_mm512_castsi512_ps(d), reach));
            }
            let coarse = if R::WIDTHS { !0 } else { _mm512_cmpgt_epi32_mask(d, passes) };
            let (mut stopped, mut stranded) = (0, 0);
            if out | coarse != 0 {
                let past = _mm512_and_si512(index, _mm512_set1_epi32((PAST_FIRST | PAST_SECOND) as i32));
                stranded = _mm512_cmpeq_epi32_mask(past, _mm512_set1_epi32(PAST_SECOND as i32));
                let able = coarse & !stranded;
                if able != 0 {
                    let constriction = constriction(from, index);
                    // SAFETY: voids are less than the length of the table (no lane is outside here) and exits
                    // less than 3, so constrictions are less than 3 times that length, the number of widths.
                    let width = unsafe {
                        _mm512_mask_i32gather_epi32::<4>(zero, able, constriction, widths.as_ptr().cast())
                    };
                    stopped = _mm512_mask_cmpgt_epi32_mask(able, d, width);
                    note(&mut chunk.events.stopped, constriction, d, stopped);
                    if R::JAMS {
                        let may = _mm512_mask_cmpgt_epi32_mask(able & !stopped, size, width);
                        if may != 0 {
                            let of_lanes = [constriction, d, jam_draws];
                            stopped |= jammed(&mut chunk, begin, of_lanes, may, out | stopped, kept);
                        }
                    }
                }
                note(&mut chunk.events.stranded, from, d, stranded);
            }
            let gone = out | stopped;
            let mut left = d;
            if gone != 0 {
                note_eroded(&mut chunk.events.eroded, d, out & !(stopped | stranded));
                to = _mm512_maskz_compress_epi32(!gone, to);
                left = _mm512_maskz_compress_epi32(!gone, d);
            }
            // SAFETY: `kept <= begin`, so sixteen entries from `kept` on are within both columns; all up to
            // `begin + 16` have been read.
            unsafe {
                _mm512_storeu_si512(chunk.void.as_mut_ptr().add(kept).cast(), to);
                _mm512_storeu_si512(chunk.diameter.as_mut_ptr().add(kept).cast(), left);
            }
            kept += WIDTH - gone.count_ones() as usize;
        }
    }
    let mut next_of_jams = || if R::JAMS { block_of(next_of_eight(&mut jam_state)) } else { [0; LANES] };
    chunk.step_rest::<R>(|| [block_of(next_of_eight(&mut state)), next_of_jams()], kept)
}

/// Words of the table for sixteen voids, by [`avx2::look_up`].
///
/// # Safety
/// There must be sixteen entries at `voids`, each less than the length of the table.
#[inline]
#[target_feature(enable = "avx512f")]
unsafe fn look_up(table: &[u32], voids: *const u32) -> __m512i {
    // SAFETY: as the caller promises.
    let (low, high) = unsafe { (avx2::look_up(table, voids), avx2::look_up(table, voids.add(WIDTH / 2))) };
    _mm512_inserti64x4::<1>(_mm512_castsi256_si512(low), high)
}

/// Permutation that puts draws `first .. first + 16` of a block into both halves of sixteen lanes.
#[inline]
#[target_feature(enable = "avx512f,avx512bw")]
fn twice(first: i32) -> __m512i {
    let lanes = _mm512_setr_epi32(0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15);
    let draws = _mm512_add_epi32(lanes, _mm512_set1_epi32(first));
    _mm512_or_si512(draws, _mm512_slli_epi32::<16>(draws))
}

/// Resolves the ties in either half of a lane with all bits of the draws; returns `index` with these exits.
#[cold]
#[inline(never)]
#[target_feature(enable = "avx512f")]
fn decide(
    chunk: &LatticeChunk,
    begin: usize,
    draws: __m512i,
    half: usize,
    mut ties: __mmask32,
    index: __m512i,
) -> __m512i {
    let words = block_of(draws);
    let mut indices = [0u32; WIDTH];
    // SAFETY: the array has sixteen entries.
    unsafe { _mm512_storeu_si512(indices.as_mut_ptr().cast(), index) };
    while ties != 0 {
        let j = ties.trailing_zeros() as usize / 2;
        ties &= !(3 << (2 * j));
        let exit = chunk.undecided(chunk.void[begin + j], begin + j, draw16(&words, WIDTH * half + j));
        let past = exit.map_or(PAST_SECOND, |exit| [0, PAST_FIRST, PAST_FIRST | PAST_SECOND][exit as usize]);
        indices[j] = indices[j] & 3 | past;
    }
    // SAFETY: the array has sixteen entries.
    unsafe { _mm512_loadu_si512(indices.as_ptr().cast()) }
}

#[inline]
#[target_feature(enable = "avx512f")]
fn load_reach(reach: &Reach) -> [__m512; 2] {
    let parts = reach.as_chunks::<WIDTH>().0;
    // SAFETY: a part has sixteen entries.
    [0, 1].map(|part| unsafe { _mm512_loadu_ps(parts[part].as_ptr()) })
}

#[inline]
#[target_feature(enable = "avx512f")]
fn half_of(draws: __m512i, half: usize) -> __m256i {
    if half == 0 { _mm512_castsi512_si256(draws) } else { _mm512_extracti64x4_epi64::<1>(draws) }
}

/// Reach of sixteen draws by [`Arching::class_of`](crate::walk::arching::Arching::class_of).
#[inline]
#[target_feature(enable = "avx512f")]
fn reach_of(reach: [__m512; 2], draws: __m256i) -> __m512 {
    let draws = _mm512_cvtepi32_ps(_mm512_cvtepu16_epi32(draws));
    let class = _mm512_srli_epi32::<22>(_mm512_castps_si512(draws));
    let class = _mm512_sub_epi32(class, _mm512_set1_epi32(CLASS_OF_ONE as i32));
    let class = _mm512_max_epi32(class, _mm512_setzero_si512());
    _mm512_permutex2var_ps(reach[0], class, reach[1])
}

/// Lanes that jam, of those that may, tested one by one in order, with the chosen constriction, the size
/// and the block of draws for jamming. `gone` has a bit for each lane that leaves or is stopped for
/// another reason; `kept` particles before this vector still move.
#[inline(never)]
#[target_feature(enable = "avx512f,popcnt")]
fn jammed(
    chunk: &mut LatticeChunk,
    begin: usize,
    [constriction, d, draws]: [__m512i; 3],
    mut may: __mmask16,
    gone: __mmask16,
    kept: usize,
) -> __mmask16 {
    let (mut exits, mut diameters, draws) = ([0u32; WIDTH], [0f32; WIDTH], block_of(draws));
    // SAFETY: both arrays have sixteen entries.
    unsafe {
        _mm512_storeu_si512(exits.as_mut_ptr().cast(), constriction);
        _mm512_storeu_si512(diameters.as_mut_ptr().cast(), d);
    }
    let mut jammed = 0;
    while may != 0 {
        let j = may.trailing_zeros() as usize;
        may &= may - 1;
        let before = (gone | jammed) & ((1 << j) - 1);
        let places = [begin + j, kept + j - before.count_ones() as usize];
        let draw = draw16(&draws, (begin + j) % DRAWS_PER_BLOCK);
        jammed |= u16::from(chunk.jams(exits[j], diameters[j], places, draw)) << j;
    }
    jammed
}

/// Constriction picked by the draw of each lane, from the index of its move.
#[inline]
#[target_feature(enable = "avx512f")]
fn constriction(from: __m512i, index: __m512i) -> __m512i {
    let one = _mm512_set1_epi32(1);
    let first = _mm512_add_epi32(from, _mm512_slli_epi32::<1>(from));
    let past_first = _mm512_test_epi32_mask(index, _mm512_set1_epi32(PAST_FIRST as i32));
    let past_second = _mm512_test_epi32_mask(index, _mm512_set1_epi32(PAST_SECOND as i32));
    let exit = _mm512_mask_add_epi32(first, past_first, first, one);
    _mm512_mask_add_epi32(exit, past_second, exit, one)
}

/// Appends the place and the diameter of some lanes.
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
    // SAFETY: there is room for sixteen; the new length covers only the values of eroded lanes.
    unsafe {
        let end = column.as_mut_ptr().add(column.len());
        _mm512_storeu_si512(end.cast(), _mm512_maskz_compress_epi32(eroded, d));
        column.set_len(column.len() + eroded.count_ones() as usize);
    }
}

/// Generators of a stream, one state word per register.
#[inline]
#[target_feature(enable = "avx512f")]
fn load_state(lanes: &Lanes) -> [__m512i; 4] {
    // SAFETY: each row of the state has eight words.
    lanes.state.each_ref().map(|row| unsafe { _mm512_loadu_si512(row.as_ptr().cast()) })
}

#[inline]
#[target_feature(enable = "avx512f")]
fn block_of(block: __m512i) -> [u64; LANES] {
    let mut words = [0; LANES];
    // SAFETY: the array has eight words.
    unsafe { _mm512_storeu_si512(words.as_mut_ptr().cast(), block) };
    words
}
