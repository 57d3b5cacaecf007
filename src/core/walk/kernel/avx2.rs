//! Step on the cubic lattice with AVX2: eight particles at once.
//!
//! Both thresholds of a void are compared with the draw in one instruction, as halves of the table's word.

use super::lattice::{BLOCK, CLASS_UP, Draws, LatticeChunk, PAST_FIRST, fits_gathers};
use crate::stream::{LANES, Lanes, next_of_four};
use crate::walk::Isa;
use crate::walk::arching::{CLASS_OF_ONE, Reach};
use crate::walk::exits::{CLASS, Lattice, Reads};
use std::arch::x86_64::*;

const WIDTH: usize = 8;

/// Moves the particles of one chunk; returns the number still moving.
pub(super) fn step<R: Reads>(chunk: LatticeChunk) -> usize {
    assert!(Isa::Avx2.is_available() && fits_gathers(chunk.table));
    // SAFETY: the machine supports the instructions.
    unsafe { step_vectors::<R>(chunk) }
}

#[target_feature(enable = "avx2,popcnt")]
fn step_vectors<R: Reads>(mut chunk: LatticeChunk) -> usize {
    let count = chunk.void.len();
    let mut state = load_state(&chunk.lanes);
    let mut jam_state = load_state(&chunk.jam_lanes::<R>());
    let mut kept = 0;
    for begin in (0..count - count % BLOCK).step_by(BLOCK) {
        chunk.fetch_ahead(begin, BLOCK);
        let draws = bytemuck::cast([next_block(&mut state), next_block(&mut state)]);
        let jam_draws = match R::JAMS {
            true => bytemuck::cast([next_block(&mut jam_state), next_block(&mut jam_state)]),
            false => [0; 2 * LANES],
        };
        let draws = [&draws, &jam_draws];
        let rare = predict::<R>(&mut chunk, begin, draws, kept);
        let gone = if rare == 0 { 0 } else { chunk.settle::<R>(begin, draws, rare, kept) };
        kept = if gone == 0 { kept + BLOCK } else { close_up(&mut chunk, kept, gone) };
    }
    let mut next_of_jams = || if R::JAMS { next_block(&mut jam_state) } else { [0; LANES] };
    chunk.step_rest::<R>(|| [next_block(&mut state), next_of_jams()], kept)
}

/// Works like the portable `predict` of [`super::lattice`].
#[inline]
#[target_feature(enable = "avx2,popcnt")]
fn predict<R: Reads>(
    chunk: &mut LatticeChunk,
    begin: usize,
    [draws, jam_draws]: [&Draws; 2],
    kept: usize,
) -> u64 {
    assert!(kept <= begin && begin + BLOCK <= chunk.void.len() && begin + BLOCK <= chunk.diameter.len());
    let (table, words) = (chunk.table, chunk.table.words::<R>());
    let last = _mm256_set1_epi32(words.len() as i32 - 1);
    let below = _mm256_set1_epi32(Lattice::below::<R>() as i32);
    let finest = _mm256_set1_epi32(table.finest as i32);
    let downstream = _mm256_castsi256_ps(_mm256_set1_epi32(table.moves[15] as i32));
    // The first eight entries of `moves` belong to the first two exits.
    // SAFETY: `moves` has sixteen entries.
    let moves = unsafe { _mm256_loadu_si256(table.moves.as_ptr().cast()) };
    // Copies each draw into both halves of its word.
    let (low, high) = (_mm_set_epi64x(0x0706_0706_0504_0504, 0x0302_0302_0100_0100), 0x0808_0808_0808_0808);
    let twice = _mm256_set_m128i(_mm_add_epi8(low, _mm_set1_epi64x(high)), low);
    let zero = _mm256_setzero_si256();
    let widths = chunk.exits.widths;
    assert_eq!(widths.len(), 3 * words.len());
    let reach = R::JAMS.then(|| load_reach(chunk.reach()));
    let (void, diameter) = (chunk.void.as_mut_ptr(), chunk.diameter.as_mut_ptr());
    let mut greatest = zero;
    for group in 0..BLOCK / WIDTH {
        // SAFETY: eight entries are within the column, as asserted.
        let from = unsafe { _mm256_loadu_si256(void.add(begin + WIDTH * group).cast()) };
        greatest = _mm256_max_epu32(greatest, from);
    }
    let inside = _mm256_cmpeq_epi32(_mm256_min_epu32(greatest, last), greatest);
    assert!(_mm256_movemask_epi8(inside) == -1, "a void that the network does not have");
    let mut rare = 0;
    let draws = draws.as_chunks::<2>().0.iter().zip(jam_draws.as_chunks::<2>().0);
    for (group, (draw, jam_draw)) in draws.enumerate() {
        let (at, place) = (begin + WIDTH * group, kept + WIDTH * group);
        // SAFETY: eight entries from `at` on are within both columns, as asserted, and the voids are
        // within the table: entries written since the check lie before `at`.
        let (from, d, word) = unsafe {
            (
                _mm256_loadu_si256(void.add(at).cast()),
                _mm256_loadu_si256(diameter.add(at).cast()),
                look_up(words, void.add(at)),
            )
        };
        // SAFETY: two words are sixteen bytes.
        let draw = unsafe { _mm_loadu_si128(draw.as_ptr().cast()) };
        let draw = _mm256_or_si256(_mm256_shuffle_epi8(_mm256_broadcastsi128_si256(draw), twice), below);

        // Upper half: draw at least the second threshold. Lower half: draw at least the first.
        let past = _mm256_cmpeq_epi16(_mm256_subs_epu16(word, draw), zero);
        let tie = _mm256_cmpeq_epi16(_mm256_or_si256(word, below), draw);
        let sideways = _mm256_or_si256(
            _mm256_and_si256(word, _mm256_set1_epi32(3)),
            _mm256_and_si256(past, _mm256_set1_epi32(PAST_FIRST as i32)),
        );
        let by = _mm256_castsi256_ps(_mm256_permutevar8x32_epi32(moves, sideways));
        let by = _mm256_castps_si256(_mm256_blendv_ps(by, downstream, _mm256_castsi256_ps(past)));
        let to = _mm256_add_epi32(from, by);

        // The sign is set if the particle leaves (neither reaches 2^31), no exit is open, either half
        // ties, or it may be too coarse.
        let out = _mm256_cmpgt_epi32(to, last);
        let closed = _mm256_andnot_si256(_mm256_slli_epi32::<16>(past), past);
        let tie = _mm256_or_si256(tie, _mm256_slli_epi32::<16>(tie));
        let mut passes = finest;
        if R::CLASSED {
            let class = _mm256_and_si256(word, _mm256_set1_epi32(CLASS as i32));
            passes = _mm256_add_epi32(finest, _mm256_slli_epi32::<{ CLASS_UP as i32 }>(class));
        }
        let coarse = if R::WIDTHS {
            // Position of the exit: the second if past the first threshold only, the third if past the
            // second.
            let past_second = _mm256_srli_epi32::<31>(past);
            let past_either = _mm256_or_si256(_mm256_and_si256(past, _mm256_set1_epi32(1)), past_second);
            let first = _mm256_add_epi32(from, _mm256_slli_epi32::<1>(from));
            let exit = _mm256_add_epi32(first, _mm256_add_epi32(past_second, past_either));
            // SAFETY: voids are within the table, and exits less than 3, so that constrictions are less than
            // 3 times its length, the number of widths.
            let width = unsafe { _mm256_i32gather_ps::<4>(widths.as_ptr(), exit) };
            let mut size = _mm256_castsi256_ps(d);
            if let Some(reach) = reach {
                // SAFETY: two words are sixteen bytes.
                let draw = unsafe { _mm_loadu_si128(jam_draw.as_ptr().cast()) };
                size = _mm256_mul_ps(size, reach_of(reach, draw));
            }
            _mm256_castps_si256(_mm256_cmp_ps::<_CMP_GT_OQ>(size, width))
        } else {
            _mm256_cmpgt_epi32(d, passes)
        };
        let long_way = _mm256_or_si256(_mm256_or_si256(out, closed), _mm256_or_si256(tie, coarse));
        let long_way = _mm256_castsi256_ps(long_way);
        rare = (rare | u64::from(_mm256_movemask_ps(long_way) as u32)).rotate_right(WIDTH as u32);
        let to = _mm256_blendv_ps(_mm256_castsi256_ps(to), _mm256_castsi256_ps(from), long_way);
        // SAFETY: `place <= at`, so eight entries from there on are within both columns; those up to
        // `at + 8` have been read.
        unsafe {
            _mm256_storeu_ps(void.add(place).cast(), to);
            _mm256_storeu_si256(diameter.add(place).cast(), d);
        }
    }
    rare
}

#[inline]
#[target_feature(enable = "avx2")]
fn load_reach(reach: &Reach) -> [__m256; 4] {
    let parts = reach.as_chunks::<WIDTH>().0;
    // SAFETY: a part has eight entries.
    [0, 1, 2, 3].map(|part| unsafe { _mm256_loadu_ps(parts[part].as_ptr()) })
}

/// Reach of eight draws by [`Arching::class_of`](crate::walk::arching::Arching::class_of): its lower three
/// bits are a place in a register, its upper two bits select the register.
#[inline]
#[target_feature(enable = "avx2")]
fn reach_of(reach: [__m256; 4], draws: __m128i) -> __m256 {
    let draws = _mm256_cvtepi32_ps(_mm256_cvtepu16_epi32(draws));
    let class = _mm256_srli_epi32::<22>(_mm256_castps_si256(draws));
    let class = _mm256_sub_epi32(class, _mm256_set1_epi32(CLASS_OF_ONE as i32));
    let class = _mm256_max_epi32(class, _mm256_setzero_si256());
    let [a, b, c, d] = reach.map(|part| _mm256_permutevar8x32_ps(part, class));
    let (fourth, half) = (_mm256_slli_epi32::<28>(class), _mm256_slli_epi32::<27>(class));
    let lower = _mm256_blendv_ps(a, b, _mm256_castsi256_ps(fourth));
    let upper = _mm256_blendv_ps(c, d, _mm256_castsi256_ps(fourth));
    _mm256_blendv_ps(lower, upper, _mm256_castsi256_ps(half))
}

/// Words of the table for eight voids, by eight loads, which are faster than a gather.
///
/// The voids are also loaded one by one, as extracting them from a vector register is slower. The volatile
/// read keeps the compiler from doing that.
///
/// # Safety
/// There must be eight entries at `voids`, each less than the length of the table.
#[inline]
#[target_feature(enable = "avx2")]
pub(super) unsafe fn look_up(table: &[u32], voids: *const u32) -> __m256i {
    // SAFETY: as the caller promises.
    let word = |j: usize| unsafe { *table.get_unchecked(voids.add(j).read_volatile() as usize) as i32 };
    _mm256_setr_epi32(word(0), word(1), word(2), word(3), word(4), word(5), word(6), word(7))
}

/// Lanes that stay, in order, then any others, by mask of the lanes that are gone.
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

/// Compacts the block of particles from `kept` on, removing those that are gone; returns its new end.
#[inline]
#[target_feature(enable = "avx2,popcnt")]
fn close_up(chunk: &mut LatticeChunk, kept: usize, gone: u64) -> usize {
    assert!(kept + BLOCK <= chunk.void.len() && kept + BLOCK <= chunk.diameter.len());
    let (void, diameter) = (chunk.void.as_mut_ptr(), chunk.diameter.as_mut_ptr());
    let mut end = kept;
    for group in 0..BLOCK / WIDTH {
        let (at, gone) = (kept + WIDTH * group, (gone >> (WIDTH * group)) as u8);
        // SAFETY: a row of the table has eight entries. `at + 8` and `end + 8` are within both columns, since
        // `end <= at`; and overwritten entries have been read.
        unsafe {
            let order = _mm256_loadu_si256(STAYING[usize::from(gone)].as_ptr().cast());
            let (place, d) =
                (_mm256_loadu_si256(void.add(at).cast()), _mm256_loadu_si256(diameter.add(at).cast()));
            _mm256_storeu_si256(void.add(end).cast(), _mm256_permutevar8x32_epi32(place, order));
            _mm256_storeu_si256(diameter.add(end).cast(), _mm256_permutevar8x32_epi32(d, order));
        }
        end += WIDTH - gone.count_ones() as usize;
    }
    end
}

/// Generators of a stream, four per register, with one state word per row.
type State = [[__m256i; 2]; 4];

#[inline]
#[target_feature(enable = "avx2")]
fn load_state(lanes: &Lanes) -> State {
    lanes.state.each_ref().map(|row| {
        let halves = row.as_chunks::<4>().0;
        // SAFETY: a half of a row has four words.
        [0, 1].map(|half| unsafe { _mm256_loadu_si256(halves[half].as_ptr().cast()) })
    })
}

/// Works like [`Lanes::next_block`], in registers.
#[inline]
#[target_feature(enable = "avx2")]
fn next_block(state: &mut State) -> [u64; LANES] {
    let mut words = [0; LANES];
    for (half, words) in words.as_chunks_mut::<4>().0.iter_mut().enumerate() {
        let mut next = state.each_ref().map(|row| row[half]);
        let out = next_of_four(&mut next);
        for (row, word) in state.iter_mut().zip(next) {
            row[half] = word;
        }
        // SAFETY: the array has four words.
        unsafe { _mm256_storeu_si256(words.as_mut_ptr().cast(), out) };
    }
    words
}
