//! Draws diameters by number, with roots that are bit for bit the same on every machine.

use super::{Gradation, GradationError, NumberError};
use crate::stream::unit;
use std::ops::Range;

const ALL_WORDS: u128 = 1 << 64;

/// Base-2 logarithm of the maximum number of buckets of a guide.
const BUCKET_BITS: u32 = 8;

/// Number of words whose diameters are drawn together.
const AT_ONCE: usize = 64;

/// Mask that keeps 40 bits of the mantissa.
const COARSE: u64 = !0 << 12;

/// A segment of the gradation, in reference units.
///
/// `v` is the number fraction of coarser particles; within a segment `D^-3` is linear in it.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Segment {
    a: f64,
    b: f64,
    /// `v` at `a`.
    v_a: f64,
    /// `v` at `b`.
    v_b: f64,
    /// `b^-3`.
    y_b: f64,
    /// Slope of `D^-3` against `v`.
    slope: f64,
}

impl Segment {
    /// Diameter at `v`, for `v_b <= v <= v_a`.
    ///
    /// It never rises with `v`: every operation is monotone except the root, whose error (2^-51) is
    /// smaller than the step that 40 bits of mantissa leave (2^-41.6). Those 40 bits are 2^16 times
    /// finer than the returned f32.
    #[inline(always)]
    fn diameter(&self, v: f64) -> f32 {
        within(inverse_cube_root(coarse(self.y_at(v))), [self.a, self.b])
    }

    /// `D^-3` at `v`.
    #[inline(always)]
    fn y_at(&self, v: f64) -> f64 {
        self.y_b + (v - self.v_b) * self.slope
    }

    /// Integral of `D^3` over `low <= v <= high`: `ln(y_high / y_low) / slope`.
    fn cubes(&self, low: f64, high: f64) -> f64 {
        let (y, width) = (self.y_at(low), high - low);
        let t = width * self.slope / y;
        if t > 0.0 { width / y * (libm::log1p(t) / t) } else { width / y }
    }
}

/// Computes `y^(-1/3)` from 40 bits of the mantissa of each number, clamped to `least` and `most`.
#[inline(always)]
fn roots_within(
    mut y: [f64; AT_ONCE],
    least: &[f64; AT_ONCE],
    most: &[f64; AT_ONCE],
    out: &mut [f32; AT_ONCE],
) {
    y.iter_mut().for_each(|y| *y = coarse(*y));
    for (((out, d), &a), &b) in out.iter_mut().zip(inverse_cube_roots(&y)).zip(least).zip(most) {
        *out = within(d, [a, b]);
    }
}

#[inline(always)]
fn coarse(y: f64) -> f64 {
    f64::from_bits(y.to_bits() & COARSE)
}

#[inline(always)]
fn within(d: f64, [a, b]: [f64; 2]) -> f32 {
    let d = if d > a { d } else { a };
    (if d < b { d } else { b }) as f32
}

/// Draws diameters of a [`Gradation`] by number: the inverse of its distribution.
///
/// Diameters are in units of a reference length, as f32. A word of 64 random bits gives one diameter,
/// which never falls as the word rises; so a word below a threshold ([`SizeSampler::word_limit`]) gives
/// a particle no coarser than a limit, exactly. A pan fraction is never drawn.
///
/// ```
/// use voidwalk_core::gradation::{Gradation, SizeSampler};
/// let sampler = SizeSampler::new(&Gradation::linear_from_d0(0.1, 3.0)?, 1.0)?;
/// assert_eq!(sampler.diameter(0), 0.1);
/// let limit = 0.155;
/// let threshold = sampler.word_limit(limit);
/// assert!(sampler.diameter((threshold - 1) as u64) <= limit);
/// assert!(sampler.diameter(threshold as u64) > limit);
/// # Ok::<(), voidwalk_core::gradation::GradationError>(())
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct SizeSampler {
    /// Sizes rise from one segment to the next; `v` falls from 1 to 0.
    segments: Vec<Segment>,
    /// Guide to the segments, for all words.
    guide: SizeGuide,
}

/// Guide to the segments for words from a first one on. Words that draw coarse particles are few, and so
/// lie close together.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct SizeGuide {
    first: u64,
    /// Number of low bits to drop from a word's distance to the first; the rest is its bucket.
    shift: u32,
    /// Segment of the smallest word in each bucket.
    segment: Vec<u32>,
}

impl SizeGuide {
    /// Returns a segment no coarser than the word's own, and close to it.
    #[inline(always)]
    fn start(&self, word: u64) -> usize {
        debug_assert!(word >= self.first, "a word below the first of the guide");
        self.segment[((word - self.first) >> self.shift) as usize] as usize
    }
}

impl SizeSampler {
    /// Makes a sampler of `gradation` with diameters in units of `reference_mm`.
    ///
    /// # Errors
    /// A reference length that is not a positive finite number, or that takes a size out of the allowed
    /// range.
    pub fn new(gradation: &Gradation, reference_mm: f64) -> Result<SizeSampler, GradationError> {
        NumberError::unless_positive("reference_mm", reference_mm)?;
        let size: Vec<f64> = gradation.size_mm.iter().map(|d| d / reference_mm).collect();
        if !size.iter().all(|d| (1e-24..=1e24).contains(d)) {
            let allowed = "one that leaves sizes between 1e-24 and 1e24 times itself";
            return Err(NumberError::new("reference_mm", reference_mm, allowed).into());
        }
        let mut segments = Vec::with_capacity(size.len());
        if let [d] = size[..] {
            segments.push(Segment { a: d, b: d, v_a: 1.0, v_b: 0.0, y_b: 1.0 / (d * d * d), slope: 0.0 });
        }
        // Fractions are summed from the coarse end, where they are smallest.
        let mut coarser = vec![0.0; size.len()];
        for i in (0..size.len() - 1).rev() {
            coarser[i] = coarser[i + 1] + (gradation.number[i + 1] - gradation.number[i]);
        }
        let all = coarser[0];
        for i in 0..size.len() - 1 {
            let (a, b, l) = (size[i], size[i + 1], gradation.log_ratio[i]);
            let (v_a, v_b) = (coarser[i] / all, coarser[i + 1] / all);
            if v_a > v_b {
                let slope = -libm::expm1(-3.0 * l) / (a * a * a) / (v_a - v_b);
                segments.push(Segment { a, b, v_a, v_b, y_b: 1.0 / (b * b * b), slope });
            }
        }
        let mut sampler =
            SizeSampler { segments, guide: SizeGuide { first: 0, shift: 0, segment: Vec::new() } };
        sampler.guide = sampler.guide_from(0);
        Ok(sampler)
    }

    /// Makes the guide to the segments for the words from this one on.
    pub(crate) fn guide_from(&self, first: u64) -> SizeGuide {
        let last = u64::MAX - first;
        let shift = (u64::BITS - last.leading_zeros()).saturating_sub(BUCKET_BITS);
        let mut at = 0;
        let of_bucket = |bucket: u64| {
            at = self.segment(at, coarser_share(first + (bucket << shift)));
            at as u32
        };
        SizeGuide { first, shift, segment: (0..=last >> shift).map(of_bucket).collect() }
    }

    /// Finds the segment of `v`, starting from segment `start`. The last one's `v_b` is 0, and no `v` is
    /// below it.
    #[inline(always)]
    fn segment(&self, start: usize, v: f64) -> usize {
        let mut i = start;
        while v < self.segments[i].v_b {
            i += 1;
        }
        i
    }

    /// Returns the diameter, in reference units, that `word` draws.
    #[inline]
    pub fn diameter(&self, word: u64) -> f32 {
        let v = coarser_share(word);
        self.segments[self.segment(self.guide.start(word), v)].diameter(v)
    }

    /// Applies [`SizeSampler::diameter`] to every word, in vector code as wide as the caller's target allows.
    ///
    /// # Panics
    /// If the slices differ in length.
    #[inline(always)]
    pub fn fill(&self, words: &[u64], out: &mut [f32]) {
        self.fill_guided(&self.guide, words, out);
    }

    /// Fills like [`SizeSampler::fill`], with a guide for these words, none below its first.
    ///
    /// # Panics
    /// Panics of [`SizeSampler::fill`]; with debug assertions if a word is below the first of the guide.
    #[inline(always)]
    pub(crate) fn fill_guided(&self, guide: &SizeGuide, words: &[u64], out: &mut [f32]) {
        assert_eq!(words.len(), out.len(), "one diameter per word");
        let (words, last_words) = words.as_chunks();
        let (out, last_out) = out.as_chunks_mut();
        for (words, out) in words.iter().zip(out) {
            self.fill_some(guide, words, out);
        }
        if let Some(&any) = last_words.first() {
            let (mut padded, mut drawn) = ([any; AT_ONCE], [0.0; AT_ONCE]);
            padded[..last_words.len()].copy_from_slice(last_words);
            self.fill_some(guide, &padded, &mut drawn);
            last_out.copy_from_slice(&drawn[..last_words.len()]);
        }
    }

    /// Fills `AT_ONCE` diameters together. The values of each segment are looked up one by one.
    #[inline(always)]
    fn fill_some(&self, guide: &SizeGuide, words: &[u64; AT_ONCE], out: &mut [f32; AT_ONCE]) {
        let mut y = [0.0; AT_ONCE];
        if let [segment] = self.segments[..] {
            for (y, &word) in y.iter_mut().zip(words) {
                *y = segment.y_at(coarser_share(word));
            }
            return roots_within(y, &[segment.a; AT_ONCE], &[segment.b; AT_ONCE], out);
        }
        let (mut least, mut most) = ([0.0; AT_ONCE], [0.0; AT_ONCE]);
        for (at, &word) in words.iter().enumerate() {
            let v = coarser_share(word);
            let segment = &self.segments[self.segment(guide.start(word), v)];
            (y[at], least[at], most[at]) = (segment.y_at(v), segment.a, segment.b);
        }
        roots_within(y, &least, &most, out);
    }

    /// Number of words whose diameter is no coarser than `limit`: `diameter(word) <= limit` if and only
    /// if `word` is below it. 2^64 if all are.
    pub fn word_limit(&self, limit: f32) -> u128 {
        let (mut low, mut high) = (0, ALL_WORDS);
        while low < high {
            let middle = low + (high - low) / 2;
            if self.diameter(middle as u64) <= limit {
                low = middle + 1;
            } else {
                high = middle;
            }
        }
        low
    }

    /// Smallest diameter that is drawn, in reference units.
    pub fn smallest(&self) -> f32 {
        self.diameter(0)
    }

    /// Largest diameter that is drawn, in reference units.
    pub fn largest(&self) -> f32 {
        self.diameter(u64::MAX)
    }

    /// Returns the particles whose words lie in `words`, as a separate distribution.
    ///
    /// # Panics
    /// If the range ends before it starts or beyond 2^64.
    pub fn part(&self, words: Range<u128>) -> SizeRange<'_> {
        assert!(words.start <= words.end && words.end <= ALL_WORDS, "a range of words: {words:?}");
        let share = |words: u128| (words as f64) * (1.0 / ALL_WORDS as f64);
        let (v_fine, v_coarse) = (share(ALL_WORDS - words.start), share(ALL_WORDS - words.end));
        SizeRange { sampler: self, words, v_fine, v_coarse }
    }

    /// Returns all particles.
    pub fn whole(&self) -> SizeRange<'_> {
        self.part(0..ALL_WORDS)
    }
}

/// Fraction by number that is coarser than the diameter of `word`: exactly `1 - unit(word)`, without the
/// cancellation.
#[inline(always)]
fn coarser_share(word: u64) -> f64 {
    unit(!word)
}

/// The particles of a [`SizeSampler`] whose words lie in a range: closed forms, in reference units.
///
/// The range is exact in words; within it sizes count as continuous, before the rounding to f32.
#[derive(Clone, Debug)]
pub struct SizeRange<'a> {
    sampler: &'a SizeSampler,
    words: Range<u128>,
    /// Fraction of all particles coarser than the finest of this range.
    v_fine: f64,
    /// Fraction of all particles coarser than the coarsest of this range.
    v_coarse: f64,
}

impl SizeRange<'_> {
    /// Fraction of all particles in this range, by number.
    pub fn number_fraction(&self) -> f64 {
        ((self.words.end - self.words.start) as f64) * (1.0 / ALL_WORDS as f64)
    }

    /// Mean of the cubed diameter; `None` if the range is empty.
    pub fn mean_cube(&self) -> Option<f64> {
        let one = |s: &Segment| {
            let (low, high) = (s.v_b.max(self.v_coarse), s.v_a.min(self.v_fine));
            if low < high { s.cubes(low, high) } else { 0.0 }
        };
        let (width, all): (f64, f64) = (self.number_fraction(), self.sampler.segments.iter().map(one).sum());
        (width > 0.0).then(|| all / width)
    }

    /// Diameter that `share` (0 to 1) of this range's particles do not exceed; `None` if the range is
    /// empty or `share` is outside 0 to 1.
    pub fn d_by_number(&self, share: f64) -> Option<f64> {
        if self.words.is_empty() || !(0.0..=1.0).contains(&share) {
            return None;
        }
        let v = (self.v_fine - share * (self.v_fine - self.v_coarse)).max(self.v_coarse);
        let segment = self.sampler.segments[self.sampler.segment(0, v)];
        Some((1.0 / libm::cbrt(segment.y_at(v))).clamp(segment.a, segment.b))
    }

    /// Draws the largest diameter among `count` particles of this range; `None` if there are no particles.
    ///
    /// The largest of `n` uniform draws has the distribution of `u^(1/n)`.
    pub fn largest_of(&self, count: u64, word: u64) -> Option<f32> {
        if self.words.is_empty() || count == 0 {
            return None;
        }
        let gap = -libm::expm1(libm::log(unit(word)) / count as f64);
        let width = self.words.end - self.words.start;
        let below = ((gap * width as f64) as u128).min(width - 1);
        Some(self.sampler.diameter((self.words.end - 1 - below) as u64))
    }
}

/// Top half of the bits of the start value at x = 1, in units of the exponent's lowest bit / 2^20.
///
/// The bits of a positive f64 are nearly a logarithm, so `MAGIC - bits / 3` starts the iteration.
/// The constant balances the largest `1 - x z^3` on both sides.
const MAGIC: u64 = 0x553e_f0ff;

/// `x^(-1/3)` for a positive normal `x`, within 2 units in the last place.
#[inline(always)]
fn inverse_cube_root(x: f64) -> f64 {
    inverse_cube_roots(&[x])[0]
}

/// Applies [`inverse_cube_root`] to each number.
///
/// Two steps of fourth order for `z^-3 = x`: with `e = 1 - x z^3`,
/// `z (1 - e)^(-1/3) = z (1 + e/3 + 2 e^2/9 + 14 e^3/81 + ...)`. Only f64 additions and multiplications, in
/// this order: no library call, no fused operation, and no branch, so that the loops become vector code.
/// Each step takes two short loops over all numbers: with one root after another the machine would wait for
/// each result before the next operation.
#[inline(always)]
fn inverse_cube_roots<const N: usize>(x: &[f64; N]) -> [f64; N] {
    let (mut z, mut e) = ([0.0; N], [0.0; N]);
    for (z, x) in z.iter_mut().zip(x) {
        let third = ((x.to_bits() >> 32) * 0x5555_5556) >> 32;
        *z = f64::from_bits((MAGIC - third) << 32);
    }
    for _ in 0..2 {
        for ((e, z), x) in e.iter_mut().zip(&z).zip(x) {
            *e = 1.0 - x * (z * z * z);
        }
        for (z, e) in z.iter_mut().zip(&e) {
            let series = e * (1.0 / 3.0 + e * (2.0 / 9.0 + e * (14.0 / 81.0)));
            *z += *z * series;
        }
    }
    z
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::stream::{Key, Purpose};
    use rand::Rng;

    /// Uses segments with very unequal numbers of particles; the words of the coarse ones lie close together.
    #[test]
    fn a_guide_of_coarse_words_finds_the_same_diameters() {
        let points =
            [(0.01, 0.0), (0.02, 30.0), (0.1, 55.0), (0.11, 56.0), (1.0, 80.0), (3.0, 99.0), (9.0, 100.0)];
        let sampler = SizeSampler::new(&Gradation::from_points(&points, None).unwrap(), 1.0).unwrap();
        let key = Key { seed: 3, purpose: Purpose::Insertion, run: 1, increment: 1, chunk: 0 };
        let mut generator = key.generator();
        let limits = [0.015, 0.1, 0.105, 0.9, 3.0, 8.9].map(|d| sampler.word_limit(d) as u64);
        for first in limits.into_iter().chain([0, 1, 1 << 63, u64::MAX - 255, u64::MAX - 1, u64::MAX]) {
            let guide = sampler.guide_from(first);
            let width = u128::from(u64::MAX - first) + 1;
            let drawn = (0..1000).map(|_| first + ((u128::from(generator.next_u64()) * width) >> 64) as u64);
            let words: Vec<u64> = drawn.chain([first, u64::MAX]).collect();
            let mut filled = vec![0.0; words.len()];
            sampler.fill_guided(&guide, &words, &mut filled);
            assert!(words.iter().zip(&filled).all(|(&word, &d)| sampler.diameter(word) == d), "{first}");
            assert!(guide.segment.len() <= 1 << BUCKET_BITS, "{first}");
            assert!(
                words.iter().all(|&word| { guide.start(word) <= sampler.segment(0, coarser_share(word)) })
            );
        }
    }

    /// Distance from the true root in units of the last place, by the residual `x z^3 - 1` computed
    /// with the error terms that rounding loses.
    fn error_ulp(x: f64) -> f64 {
        let (z, near) = (inverse_cube_root(x), 1.0 / libm::cbrt(x));
        // `near` is good to about one unit; one Newton step with the exact residual makes it a reference.
        let residual = |z: f64| {
            let square = z * z;
            let lost_square = libm::fma(z, z, -square);
            let cube = square * z;
            let lost_cube = libm::fma(square, z, -cube) + lost_square * z;
            libm::fma(x, cube, -1.0) + x * lost_cube
        };
        let correction = -residual(near) / 3.0 * near;
        let ulp = f64::from_bits(near.to_bits() + 1) - near;
        ((z - near) - correction).abs() / ulp
    }

    /// Checks every exponent that sizes can produce, and beyond: 2e6 random mantissas and the edges.
    #[test]
    fn is_within_two_units_in_the_last_place() {
        let mut generator =
            Key { seed: 1, purpose: Purpose::Packing, run: 0, increment: 0, chunk: 0 }.generator();
        let mut worst: f64 = 0.0;
        for exponent in 1..2046u64 {
            for mantissa in [0, 1, (1 << 52) - 1, 1 << 51] {
                worst = worst.max(error_ulp(f64::from_bits((exponent << 52) | mantissa)));
            }
        }
        // The error depends on the mantissa and the exponent modulo 3 only.
        for i in 0..2_000_000u64 {
            let exponent = 1020 + i % 6;
            worst = worst.max(error_ulp(f64::from_bits((exponent << 52) | (generator.next_u64() >> 12))));
        }
        assert!(worst <= 2.0, "{worst}");
        assert!(worst > 0.4, "the reference must see rounding: {worst}");
    }
}
