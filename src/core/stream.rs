//! Random streams: the only place in the program that makes a generator.
//!
//! Every stream is named by a [`Key`]. The same key gives the same numbers on every machine, for any number
//! of threads and after any resume; no generator state is ever stored.
//!
//! # Kinds of stream
//! - [`Key::generator`] is one xoshiro256++ generator, for work that draws numbers one after another
//!   (constriction diameters, start packings, binomials).
//! - [`Key::lanes`] is [`Lanes`]: eight xoshiro256++ generators side by side, for chunked columns.
//!   Its output is a sequence of blocks of eight words; word `w` of the whole stream is word
//!   `w / 8` of generator `w % 8`. Sixteen-bit draw `j` is bits `16 (j % 4) ..` of word `j / 4`.
//! - `Key::words` is `Words`: words by index, for use in any order (permutations).
//!
//! # How a key becomes a state
//! The five key words are hashed by XXH3 to 128 bits `(a, b)`; state word `i` is
//! `mix(a + i G) ^ rotl(mix(b + i H), 32)` with the SplitMix64 finaliser `mix` and two odd
//! constants. Lane `l` takes words `4 l .. 4 l + 4`; [`Key::generator`] is lane 0.
//!
//! ```
//! use voidwalk_core::stream::{Key, Purpose};
//! use rand::Rng;
//! let key = Key { seed: 7, purpose: Purpose::Network, run: 0, increment: 0, chunk: 3 };
//! assert_eq!(key.generator().next_u64(), key.generator().next_u64());
//! ```

use rand::SeedableRng;
use rand_xoshiro::Xoshiro256PlusPlus;

/// Number of generators side by side in [`Lanes`].
pub const LANES: usize = 8;

/// Sixteen-bit draws in one block of [`Lanes`].
pub(crate) const DRAWS_PER_BLOCK: usize = 4 * LANES;

const GOLDEN: u64 = 0x9e37_79b9_7f4a_7c15;
const SILVER: u64 = 0xd1b5_4a32_d192_ed03;
const EXTENSION: u64 = 0x8cb9_2ba7_2f3d_8dd7;

/// Purpose of a stream. Two purposes never share a number, whatever the rest of the key.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[repr(u64)]
pub enum Purpose {
    /// Seeds of replicates, drawn from the user's seed.
    Replicate = 1,
    /// Constriction diameters of a network.
    Network = 2,
    /// Start node and diameter of the base particles that an increment inserts into a chunk.
    Insertion = 3,
    /// Exit choice of the particles of a chunk in an increment.
    Step = 4,
    /// Number of coarse particles of an increment (engine `counts`).
    CoarseShare = 5,
    /// Start nodes and binomial splits of passive particles kept as counts.
    Passive = 6,
    /// Sizes of passive particles kept as counts, drawn on demand.
    PassiveSize = 7,
    /// Grain sizes and start positions of a packing.
    Packing = 8,
    /// Order in which bonds open in a percolation study.
    Percolation = 9,
    /// Changes that give a network a connectivity distribution.
    Connectivity = 10,
    /// Resampling for confidence intervals.
    Resampling = 11,
    /// Permutations of strata (stratified sampling).
    Strata = 12,
    /// Jams of particles.
    Arching = 13,
    /// Circles inscribed between grains, to estimate constrictions.
    Inscribed = 14,
}

/// The full name of a stream.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct Key {
    /// The seed of this replicate.
    pub seed: u64,
    /// Purpose of the stream.
    pub purpose: Purpose,
    /// Run, counted from 1; 0 outside runs.
    pub run: u64,
    /// Increment, counted from 1; 0 outside increments.
    pub increment: u64,
    /// Chunk of particles or block of voids, counted from 0.
    pub chunk: u64,
}

/// SplitMix64's finaliser: a bijection of 64 bits in which every input bit affects every output bit.
#[inline(always)]
const fn mix(mut z: u64) -> u64 {
    z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    z ^ (z >> 31)
}

impl Key {
    /// Makes one xoshiro256++ generator.
    pub fn generator(&self) -> Xoshiro256PlusPlus {
        let words = self.words();
        let state: [u64; 4] = std::array::from_fn(|i| words.of_state(i).to_le());
        Xoshiro256PlusPlus::from_seed(bytemuck::cast(state))
    }

    /// Makes words that can be read in any order.
    #[inline]
    pub(crate) fn words(&self) -> Words {
        let words = [self.seed, self.purpose as u64, self.run, self.increment, self.chunk];
        let hash = xxhash_rust::xxh3::xxh3_128(bytemuck::bytes_of(&words.map(u64::to_le)));
        Words { a: hash as u64, b: (hash >> 64) as u64 }
    }

    /// Makes eight xoshiro256++ generators side by side.
    #[inline]
    pub fn lanes(&self) -> Lanes {
        let words = self.words();
        let row = |word| std::array::from_fn(|lane| words.of_state(4 * lane + word));
        Lanes { state: std::array::from_fn(row), words }
    }
}

/// Eight xoshiro256++ generators side by side: the stream of one chunk in one increment.
#[derive(Clone, Debug)]
pub struct Lanes {
    /// State word, lane.
    pub(crate) state: [[u64; LANES]; 4],
    words: Words,
}

/// Words by index: a hash of the key and the index, so that each costs the same.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Words {
    a: u64,
    b: u64,
}

impl Words {
    /// Word `index`.
    #[inline]
    pub(crate) fn at(&self, index: u64) -> u64 {
        mix(self.a ^ mix(self.b.wrapping_add(index.wrapping_mul(EXTENSION))))
    }

    /// Completes draw `index` of the stream, of which `draw` is the top sixteen bits, to 64 bits. It costs
    /// nothing until it is called, and leaves the stream unchanged.
    #[inline]
    pub(crate) fn complete(&self, draw: u16, index: u64) -> u64 {
        u64::from(draw) << 48 | self.at(index) >> 16
    }

    /// State word `i` of the generators.
    #[inline(always)]
    fn of_state(&self, i: usize) -> u64 {
        let hash = |word: u64, step: u64| mix(word.wrapping_add(step.wrapping_mul(i as u64)));
        hash(self.a, GOLDEN) ^ hash(self.b, SILVER).rotate_left(32)
    }
}

impl Lanes {
    /// Returns the next word of each lane.
    #[inline(always)]
    pub(crate) fn next_block(&mut self) -> [u64; LANES] {
        let [s0, s1, s2, s3] = &mut self.state;
        let mut out = [0u64; LANES];
        for l in 0..LANES {
            out[l] = s0[l].wrapping_add(s3[l]).rotate_left(23).wrapping_add(s0[l]);
            let t = s1[l] << 17;
            s2[l] ^= s0[l];
            s3[l] ^= s1[l];
            s1[l] ^= s2[l];
            s0[l] ^= s3[l];
            s2[l] ^= t;
            s3[l] = s3[l].rotate_left(45);
        }
        out
    }

    /// Returns the next `N` blocks.
    ///
    /// Not inlined, so that the generators stay in memory: no machine has registers for all of them and
    /// for the caller's own values, and their words would be moved to and fro.
    #[inline(never)]
    #[cfg(target_arch = "x86_64")]
    pub fn next_blocks<const N: usize>(&mut self) -> [[u64; LANES]; N] {
        let mut out = [[0; LANES]; N];
        let [s0, s1, s2, s3] = self.state.each_mut().map(|row| row.as_chunks_mut::<2>().0);
        for pair in 0..LANES / 2 {
            let mut state = [s0[pair], s1[pair], s2[pair], s3[pair]];
            for block in &mut out {
                // SAFETY: every x86-64 has SSE2.
                block.as_chunks_mut::<2>().0[pair] = unsafe { next_of_pair(&mut state) };
            }
            [s0[pair], s1[pair], s2[pair], s3[pair]] = state;
        }
        out
    }

    /// Returns the next `N` blocks with AVX2: four generators per register.
    #[cfg(target_arch = "x86_64")]
    #[inline]
    #[target_feature(enable = "avx2")]
    pub(crate) fn next_blocks_avx2<const N: usize>(&mut self, out: &mut [[u64; LANES]; N]) {
        use std::arch::x86_64::{_mm256_loadu_si256, _mm256_storeu_si256};
        let mut halves = self.state.each_mut().map(|row| row.as_chunks_mut::<4>().0);
        for half in 0..LANES / 4 {
            let words = halves.each_mut().map(|row| row[half].as_mut_ptr());
            // SAFETY: a half has four words.
            let mut state = words.map(|words| unsafe { _mm256_loadu_si256(words.cast()) });
            for block in out.iter_mut() {
                let next = next_of_four(&mut state);
                // SAFETY: likewise.
                unsafe { _mm256_storeu_si256(block.as_chunks_mut::<4>().0[half].as_mut_ptr().cast(), next) };
            }
            for (words, state) in words.into_iter().zip(state) {
                // SAFETY: likewise.
                unsafe { _mm256_storeu_si256(words.cast(), state) };
            }
        }
    }

    /// Returns the next `N` blocks.
    #[cfg(not(target_arch = "x86_64"))]
    pub(crate) fn next_blocks<const N: usize>(&mut self) -> [[u64; LANES]; N] {
        std::array::from_fn(|_| self.next_block())
    }

    /// Words that complete the draws of this stream to 64 bits.
    pub(crate) fn extension(&self) -> Words {
        self.words
    }
}

/// Returns the next word of two generators, given their state by word and generator. Uses vector
/// registers; the compiler alone would put each word in a register of its own.
#[cfg(target_arch = "x86_64")]
#[inline]
#[target_feature(enable = "sse2")]
fn next_of_pair(state: &mut [[u64; 2]; 4]) -> [u64; 2] {
    use std::arch::x86_64::*;
    let [s0, s1, s2, s3] = state.map(bytemuck::cast::<[u64; 2], __m128i>);
    let sum = _mm_add_epi64(s0, s3);
    let out = _mm_add_epi64(_mm_or_si128(_mm_slli_epi64::<23>(sum), _mm_srli_epi64::<41>(sum)), s0);
    let t = _mm_slli_epi64::<17>(s1);
    let s2 = _mm_xor_si128(s2, s0);
    let s3 = _mm_xor_si128(s3, s1);
    let (s1, s0, s2) = (_mm_xor_si128(s1, s2), _mm_xor_si128(s0, s3), _mm_xor_si128(s2, t));
    let s3 = _mm_or_si128(_mm_slli_epi64::<45>(s3), _mm_srli_epi64::<19>(s3));
    *state = [s0, s1, s2, s3].map(bytemuck::cast);
    bytemuck::cast(out)
}

/// Returns the next word of four generators, given their state by word.
#[cfg(target_arch = "x86_64")]
#[inline]
#[target_feature(enable = "avx2")]
pub(crate) fn next_of_four(state: &mut [std::arch::x86_64::__m256i; 4]) -> std::arch::x86_64::__m256i {
    use std::arch::x86_64::*;
    let [s0, s1, s2, s3] = *state;
    let sum = _mm256_add_epi64(s0, s3);
    let turned = _mm256_or_si256(_mm256_slli_epi64::<23>(sum), _mm256_srli_epi64::<41>(sum));
    let (t, s2, s3) = (_mm256_slli_epi64::<17>(s1), _mm256_xor_si256(s2, s0), _mm256_xor_si256(s3, s1));
    let (s1, s0_next) = (_mm256_xor_si256(s1, s2), _mm256_xor_si256(s0, s3));
    let s3 = _mm256_or_si256(_mm256_slli_epi64::<45>(s3), _mm256_srli_epi64::<19>(s3));
    *state = [s0_next, s1, _mm256_xor_si256(s2, t), s3];
    _mm256_add_epi64(turned, s0)
}

/// Returns the next word of eight generators, given their state by word.
#[cfg(target_arch = "x86_64")]
#[inline]
#[target_feature(enable = "avx512f")]
pub(crate) fn next_of_eight(state: &mut [std::arch::x86_64::__m512i; 4]) -> std::arch::x86_64::__m512i {
    use std::arch::x86_64::*;
    let [s0, s1, s2, s3] = *state;
    let out = _mm512_add_epi64(_mm512_rol_epi64::<23>(_mm512_add_epi64(s0, s3)), s0);
    let (t, s2, s3) = (_mm512_slli_epi64::<17>(s1), _mm512_xor_si512(s2, s0), _mm512_xor_si512(s3, s1));
    let (s1, s0) = (_mm512_xor_si512(s1, s2), _mm512_xor_si512(s0, s3));
    *state = [s0, s1, _mm512_xor_si512(s2, t), _mm512_rol_epi64::<45>(s3)];
    out
}

/// Sixteen-bit draw `j` of a block, `j < DRAWS_PER_BLOCK`.
#[inline(always)]
pub(crate) fn draw16(block: &[u64; LANES], j: usize) -> u16 {
    (block[j / 4] >> (16 * (j % 4))) as u16
}

/// Maps `word` to `0 .. n`, each value with the same probability to within `n / 2^64`.
#[inline(always)]
pub(crate) fn below(word: u64, n: u64) -> u64 {
    ((u128::from(word) * u128::from(n)) >> 64) as u64
}

/// Maps like [`below`] for fewer than 2^32 values, by products that vector code has.
#[inline(always)]
pub(crate) fn below_32(word: u64, n: u32) -> u32 {
    let (high, low) = (word >> 32, word & u64::from(u32::MAX));
    ((high * u64::from(n) + ((low * u64::from(n)) >> 32)) >> 32) as u32
}

/// Maps `word` to an f64 strictly between 0 and 1 (its upper 52 bits, centred).
#[inline(always)]
pub fn unit(word: u64) -> f64 {
    // Mantissa of a number from 1 to 2, less 1, plus half of the last bit: exact, and many machines have
    // no instruction that converts several 64-bit integers to floats.
    f64::from_bits(1.0f64.to_bits() | (word >> 12)) - (1.0 - f64::EPSILON / 2.0)
}

#[cfg(test)]
mod tests {
    use super::*;
    use rand::Rng;

    fn key(increment: u64, chunk: u64) -> Key {
        Key { seed: 1, purpose: Purpose::Step, run: 1, increment, chunk }
    }

    #[test]
    fn every_lane_is_xoshiro256_plus_plus() {
        let mut lanes = key(9, 2).lanes();
        let single = |l: usize| {
            Xoshiro256PlusPlus::from_seed(bytemuck::cast(lanes.state.map(|words| words[l].to_le())))
        };
        let mut singles: [_; LANES] = std::array::from_fn(single);
        assert_eq!(singles[0], key(9, 2).generator());
        for _ in 0..100 {
            assert_eq!(lanes.next_block(), singles.each_mut().map(|single| single.next_u64()));
        }
    }

    #[test]
    fn blocks_at_once_are_one_after_the_other() {
        let (mut at_once, mut one_by_one) = (key(2, 5).lanes(), key(2, 5).lanes());
        #[cfg(target_arch = "x86_64")]
        let mut by_four = at_once.clone();
        for _ in 0..100 {
            let blocks = [0; 3].map(|_| one_by_one.next_block());
            assert_eq!(at_once.next_blocks::<2>(), blocks[..2]);
            assert_eq!(at_once.next_blocks::<1>(), blocks[2..]);
            assert_eq!(at_once.state, one_by_one.state);
            #[cfg(target_arch = "x86_64")]
            if is_x86_feature_detected!("avx2") {
                let mut drawn = [[0; LANES]; 3];
                // SAFETY: the machine has AVX2.
                unsafe { by_four.next_blocks_avx2(&mut drawn) };
                assert_eq!((drawn, by_four.state), (blocks, one_by_one.state));
            }
        }
    }

    #[test]
    fn a_word_gives_the_same_number_and_the_same_value_below_n_by_every_way() {
        let words =
            [0, 1, 4095, 4096, u64::MAX, u64::MAX - 4095, 1 << 63, (1 << 63) - 1, 1 << 32, 0xffff_ffff];
        let mut draws = key(1, 2).generator();
        for word in words.into_iter().chain((0..100_000).map(|_| draws.next_u64())) {
            assert_eq!(unit(word), ((word >> 12) as f64 + 0.5) * (1.0 / (1u64 << 52) as f64));
            assert!(0.0 < unit(word) && unit(word) < 1.0);
            for n in [1, 2, 3, 1600, 96_000, 1 << 31, u32::MAX] {
                assert_eq!(u64::from(below_32(word, n)), below(word, u64::from(n)), "{word} {n}");
            }
        }
    }

    #[test]
    fn every_part_of_the_key_matters() {
        let base = key(1, 1);
        let mut seen = std::collections::HashSet::from([base.generator().next_u64()]);
        for other in [
            Key { seed: 2, ..base },
            Key { purpose: Purpose::Insertion, ..base },
            Key { run: 2, ..base },
            Key { increment: 2, ..base },
            Key { chunk: 2, ..base },
        ] {
            assert!(seen.insert(other.generator().next_u64()));
        }
    }

    /// Streams of neighbouring keys: the mean of draws has a standard error of 2.3e-4 here; a bias
    /// below about 1e-3 would pass.
    #[test]
    fn draws_of_neighbouring_keys_are_uniform_and_uncorrelated() {
        let (mut sum, mut cross, mut last, n) = (0.0, 0.0, 0.0, 1_600_000);
        for chunk in 0..n / 16 {
            let block = key(1, chunk).lanes().next_block();
            for j in 0..16 {
                let u = f64::from(draw16(&block, j)) / 65536.0 - 0.5;
                sum += u;
                cross += u * last;
                last = u;
            }
        }
        let n = n as f64;
        assert!((sum / n).abs() < 4.0 * (1.0f64 / 12.0 / n).sqrt());
        assert!((cross / n).abs() < 4.0 / 12.0 / n.sqrt());
    }

    #[test]
    fn an_extended_draw_keeps_its_top_bits() {
        let extension = key(1, 1).lanes().extension();
        assert_eq!(extension.complete(0xabcd, 5) >> 48, 0xabcd);
        assert_ne!(extension.complete(0xabcd, 5), extension.complete(0xabcd, 6));
    }

    /// Pins the numbers themselves, so that no upgrade changes them unnoticed.
    #[test]
    fn streams_are_pinned() {
        let block = key(1, 0).lanes().next_block();
        assert_eq!([block[0], block[7]], [12_051_470_993_762_552_868, 8_411_913_508_911_531_535]);
    }
}
