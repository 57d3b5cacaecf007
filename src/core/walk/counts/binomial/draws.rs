//! Random words for binomial draws, and small numbers of individual trials.

use super::quantile::Normal;
use crate::stream::{DRAWS_PER_BLOCK, Key, LANES, Lanes};

/// Random words of one stream, one at a time or in blocks.
pub(in crate::walk::counts) struct Draws {
    lanes: Lanes,
    block: [u64; LANES],
    used: usize,
    pub(super) normal: &'static Normal,
}

impl Draws {
    pub(crate) fn new(key: Key) -> Self {
        Self { lanes: key.lanes(), block: [0; LANES], used: LANES, normal: Normal::table() }
    }

    #[inline(always)]
    pub(crate) fn word(&mut self) -> u64 {
        if self.used == LANES {
            self.block = self.lanes.next_block();
            self.used = 0;
        }
        self.used += 1;
        self.block[self.used - 1]
    }

    /// Draws a new block; remaining words of the current one are kept for [`Draws::word`].
    #[inline(always)]
    pub(super) fn block(&mut self) -> [u64; LANES] {
        self.lanes.next_blocks::<1>()[0]
    }
}

/// Number of `n` uniform 64-bit words that are below each of two thresholds.
#[inline(always)]
pub(in crate::walk::counts) fn below_both(draws: &mut Draws, n: u64, thresholds: [u64; 2]) -> [u64; 2] {
    Portable.below_both(draws, n, thresholds.map(|t| (t >> 48) as u16), || thresholds)
}

/// Adds the words below a threshold whose top sixteen bits are equal to it.
#[cold]
#[inline(never)]
fn complete(draws: &mut Draws, sixteens: &[u16], thresholds: [u64; 2], below: &mut [u64; 2]) {
    let top = |word: u64| (word >> 48) as u16;
    for draw in sixteens.iter().map(|&draw| u16::from_le(draw)) {
        if thresholds.iter().any(|&t| draw == top(t)) {
            let whole = u64::from(draw) << 48 | draws.word() >> 16;
            for (below, &t) in below.iter_mut().zip(&thresholds) {
                *below += u64::from(draw == top(t) && whole < t);
            }
        }
    }
}

/// Compares `n` uniform words with `p`, bit by bit; returns the number below.
pub(super) fn by_bits(draws: &mut Draws, n: u64, p: u64) -> u64 {
    let (mut undecided, mut below, mut bits) = (n, 0, p);
    // Once the rest of `p` is 0, words equal so far are not below it.
    while undecided > 0 && bits != 0 {
        let ones = ones_among(draws, undecided);
        let zeros = undecided - ones;
        if bits >> 63 == 1 {
            below += zeros;
            undecided = ones;
        } else {
            undecided = zeros;
        }
        bits <<= 1;
    }
    below
}

fn ones_among(draws: &mut Draws, m: u64) -> u64 {
    let mut ones = 0;
    let mut left = m;
    while left > 64 {
        ones += draws.word().count_ones();
        left -= 64;
    }
    u64::from(ones + (draws.word() >> (64 - left)).count_ones())
}

/// Number of draws of a block below each threshold, and the block itself if a draw equals the top of a
/// threshold.
type Counted = ([u32; 2], Option<[u16; DRAWS_PER_BLOCK]>);

/// Small numbers of trials for successive voids of one stream, with the same bits for any instruction set.
///
/// Vector code keeps the generators in registers from void to void; in memory, each void would wait for the
/// store of the previous one.
pub(in crate::walk::counts) trait FewTrials: Sized {
    /// Loads the current state of the stream's generators.
    ///
    /// # Safety
    /// The machine supports the instructions of this type.
    unsafe fn load(draws: &Draws) -> Self;

    /// Counts the first `counted` draws of the next block that are below each of two thresholds with these
    /// upper sixteen bits.
    ///
    /// # Safety
    /// The machine supports the instructions of this type.
    unsafe fn block(&mut self, draws: &mut Draws, counted: u64, tops: [u16; 2]) -> Counted;

    fn store(&self, draws: &mut Draws);

    /// Counts how many of `n` uniform 64-bit words are below each of two thresholds with upper sixteen
    /// bits `tops`. Sixteen bits of each word are drawn, and the other 48 if those equal the top bits of a
    /// threshold; only then the full thresholds are requested.
    #[inline(always)]
    fn below_both(
        &mut self,
        draws: &mut Draws,
        n: u64,
        tops: [u16; 2],
        thresholds: impl Fn() -> [u64; 2],
    ) -> [u64; 2] {
        let (mut below, mut left) = ([0, 0], n);
        while left > 0 {
            let counted = left.min(DRAWS_PER_BLOCK as u64);
            // SAFETY: the caller of `load` promised the instructions.
            let (less, block) = unsafe { self.block(draws, counted, tops) };
            if let Some(block) = block {
                self.store(draws);
                complete(draws, &block[..counted as usize], thresholds(), &mut below);
                // SAFETY: as above.
                *self = unsafe { Self::load(draws) };
            }
            below = [below[0] + u64::from(less[0]), below[1] + u64::from(less[1])];
            left -= counted;
        }
        below
    }
}

/// Instructions that every machine has; the generators stay in the stream.
pub(in crate::walk::counts) struct Portable;

impl FewTrials for Portable {
    #[inline(always)]
    unsafe fn load(_: &Draws) -> Self {
        Self
    }

    #[inline(always)]
    unsafe fn block(&mut self, draws: &mut Draws, counted: u64, [first, second]: [u16; 2]) -> Counted {
        let sixteens: [u16; DRAWS_PER_BLOCK] = bytemuck::cast(draws.block().map(u64::to_le));
        let (mut less, mut less_second, mut same) = (0u16, 0u16, 0u16);
        for (j, &draw) in sixteens.iter().enumerate() {
            let draw = u16::from_le(draw);
            let counts = (j as u16) < counted as u16;
            less += u16::from(counts & (draw < first));
            less_second += u16::from(counts & (draw < second));
            same += u16::from(counts & ((draw == first) | (draw == second)));
        }
        ([less, less_second].map(u32::from), (same > 0).then_some(sixteens))
    }

    #[inline(always)]
    fn store(&self, _: &mut Draws) {}
}

#[cfg(target_arch = "x86_64")]
pub(in crate::walk::counts) use x86::{Avx2, Avx512};

#[cfg(target_arch = "x86_64")]
mod x86 {
    use std::arch::x86_64::*;

    use super::{Counted, Draws, FewTrials};
    use crate::stream::{DRAWS_PER_BLOCK, next_of_eight, next_of_four};

    pub(in crate::walk::counts) struct Avx512([__m512i; 4]);

    /// State words of the lower and the upper four generators, for AVX2.
    pub(in crate::walk::counts) struct Avx2([[__m256i; 4]; 2]);

    impl FewTrials for Avx512 {
        #[inline(always)]
        unsafe fn load(draws: &Draws) -> Self {
            // SAFETY: each state word has eight lanes; the machine has AVX-512.
            Self(draws.lanes.state.each_ref().map(|row| unsafe { _mm512_loadu_si512(row.as_ptr().cast()) }))
        }

        #[inline]
        #[target_feature(enable = "avx512f,avx512bw,avx512dq,avx512vl,popcnt")]
        unsafe fn block(&mut self, _: &mut Draws, counted: u64, tops: [u16; 2]) -> Counted {
            let block = next_of_eight(&mut self.0);
            let mask = ((1u64 << counted) - 1) as u32;
            let [first, second] = tops.map(|top| _mm512_set1_epi16(top as i16));
            let less = [
                _mm512_mask_cmplt_epu16_mask(mask, block, first).count_ones(),
                _mm512_mask_cmplt_epu16_mask(mask, block, second).count_ones(),
            ];
            let same = _mm512_mask_cmpeq_epu16_mask(mask, block, first)
                | _mm512_mask_cmpeq_epu16_mask(mask, block, second);
            let block = (same != 0).then(|| {
                let mut sixteens = [0; DRAWS_PER_BLOCK];
                // SAFETY: the array is as large as the vector.
                unsafe { _mm512_storeu_si512(sixteens.as_mut_ptr().cast(), block) };
                sixteens
            });
            (less, block)
        }

        #[inline(always)]
        fn store(&self, draws: &mut Draws) {
            for (row, state) in draws.lanes.state.iter_mut().zip(self.0) {
                // SAFETY: each state word has eight lanes; the machine has AVX-512.
                unsafe { _mm512_storeu_si512(row.as_mut_ptr().cast(), state) };
            }
        }
    }

    impl FewTrials for Avx2 {
        #[inline(always)]
        unsafe fn load(draws: &Draws) -> Self {
            let half = |half: usize| {
                // SAFETY: four lanes from `4 half` on are within the eight; the machine has AVX2.
                draws
                    .lanes
                    .state
                    .map(|row| unsafe { _mm256_loadu_si256(row[4 * half..][..4].as_ptr().cast()) })
            };
            Self([half(0), half(1)])
        }

        #[inline]
        #[target_feature(enable = "avx2,popcnt")]
        unsafe fn block(&mut self, _: &mut Draws, counted: u64, tops: [u16; 2]) -> Counted {
            // Unsigned numbers are compared as signed numbers after subtracting 2^15.
            let sign = _mm256_set1_epi16(i16::MIN);
            let counts = MASKS[counted as usize];
            let blocks = [next_of_four(&mut self.0[0]), next_of_four(&mut self.0[1])];
            let [low, high] = [_mm256_xor_si256(blocks[0], sign), _mm256_xor_si256(blocks[1], sign)];
            let (mut less, mut same) = ([0; 2], 0);
            for (less, top) in less.iter_mut().zip(tops) {
                let top = _mm256_set1_epi16((top ^ 0x8000) as i16);
                let below = packed(_mm256_cmpgt_epi16(top, low), _mm256_cmpgt_epi16(top, high));
                *less = (below & counts).count_ones();
                same |= packed(_mm256_cmpeq_epi16(top, low), _mm256_cmpeq_epi16(top, high)) & counts;
            }
            let block = (same != 0).then(|| {
                let mut sixteens = [0; DRAWS_PER_BLOCK];
                for (sixteens, block) in sixteens.chunks_exact_mut(DRAWS_PER_BLOCK / 2).zip(blocks) {
                    // SAFETY: the array is as large as the vector.
                    unsafe { _mm256_storeu_si256(sixteens.as_mut_ptr().cast(), block) };
                }
                sixteens
            });
            (less, block)
        }

        #[inline(always)]
        fn store(&self, draws: &mut Draws) {
            for (at, half) in self.0.iter().enumerate() {
                for (row, state) in draws.lanes.state.iter_mut().zip(half) {
                    // SAFETY: four lanes from `4 at` on are within the eight; the machine has AVX2.
                    unsafe { _mm256_storeu_si256(row[4 * at..][..4].as_mut_ptr().cast(), *state) };
                }
            }
        }
    }

    /// Masks by number of draws counted, with bits in the order given by packing two halves (eight draws
    /// of the lower half, eight of the upper, then the others of each).
    const MASKS: [u32; DRAWS_PER_BLOCK + 1] = {
        let (mut masks, mut n) = ([0; DRAWS_PER_BLOCK + 1], 0);
        while n <= DRAWS_PER_BLOCK {
            let first = ((1u64 << n) - 1) as u32;
            masks[n] = first & 0xff00_00ff | first >> 8 & 0xff00 | first << 8 & 0xff_0000;
            n += 1;
        }
        masks
    };

    /// Sets a bit for each negative 16-bit lane of two halves, in turns of eight from either half.
    #[target_feature(enable = "avx2,popcnt")]
    #[inline]
    fn packed(low: __m256i, high: __m256i) -> u32 {
        _mm256_movemask_epi8(_mm256_packs_epi16(low, high)) as u32
    }
}
