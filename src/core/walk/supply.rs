//! Base particles inserted in a run: number per increment, sizes and sampling.

use super::Arching;
use super::counts::{Expected, Passive, coarse_share};
use crate::gradation::{SizeGuide, SizeSampler};
use crate::schema::Leaf;
use crate::stream::{Key, Purpose, Words, below};
use std::sync::Arc;

/// Base particles of a run.
///
/// They are inserted in equal parts over `k` increments: `floor(n t / k)` of all `n` by the end of
/// increment `t`.
#[derive(Clone, Debug)]
pub struct Supply {
    sampler: SizeSampler,
    /// Lowest random word passed to the sampler: 0 for the whole base, larger for its coarse part.
    first_word: u64,
    /// Guide of the sampler for words from `first_word` on.
    guide: SizeGuide,
    /// Cumulative number of particles inserted one by one; entry `t - 1` is increment `t`.
    inserted: Vec<u64>,
    passive: PassiveSupply,
    /// Strata of start nodes and sizes, if these are not independent.
    strata: Option<Strata>,
    /// Law of arching, if particles arch.
    arching: Option<Arc<Arching>>,
    /// True if blocked constrictions leave openings.
    leaves_openings: bool,
}

/// Passive particles of a run that are not walked one by one.
#[derive(Clone, Debug, Default)]
struct PassiveSupply {
    /// Cumulative number of particles inserted, by increment; empty if there are none.
    inserted: Vec<u64>,
    /// Words below this value draw passive particles.
    words: u128,
    /// True if only their expectation is computed.
    expected: bool,
}

impl Supply {
    /// Creates a supply of `n` particles of the whole base, in `increments` equal parts.
    pub fn new(sampler: SizeSampler, n: u64, increments: u64) -> Self {
        let part = |t: u64| (u128::from(n) * u128::from(t) / u128::from(increments)) as u64;
        let inserted = (1..=increments).map(part).collect();
        Self {
            guide: sampler.guide_from(0),
            sampler,
            first_word: 0,
            inserted,
            passive: PassiveSupply::default(),
            strata: None,
            arching: None,
            leaves_openings: false,
        }
    }

    /// Sets the law of arching.
    pub fn arching_by(self, arching: Option<Arc<Arching>>) -> Self {
        Self { arching, ..self }
    }

    /// Sets if blocked constrictions leave openings (module `openings`) or are closed.
    pub fn leaving_openings(self, leaves_openings: bool) -> Self {
        Self { leaves_openings, ..self }
    }

    pub(crate) fn leaves_openings(&self) -> bool {
        self.leaves_openings
    }

    /// Law of arching; `None` if particles do not arch.
    pub(crate) fn arching(&self) -> Option<&Arching> {
        self.arching.as_deref()
    }

    /// Spreads start nodes and sizes evenly ([`Sampling::Stratified`]), for run `run` of `seed`. Must be
    /// called before a passive part is separated.
    pub fn stratified(self, seed: u64, run: u64) -> Self {
        let share = |t| self.inserted(t) - self.inserted(t - 1);
        let most = (1..=self.increments()).map(share).max().unwrap_or(0);
        let strata = Strata::new(seed, run, most.max(1), self.increments().max(1));
        Self { strata: Some(strata), ..self }
    }

    /// Keeps the particles drawn by words below `passive_words` as counts, or as an expectation. Their
    /// number in each increment is drawn for run `run` of `seed`.
    pub fn with_passive_part(self, passive_words: u128, expected: bool, seed: u64, run: u64) -> Self {
        let increments = 1..=self.increments();
        let key = |increment| Key { seed, purpose: Purpose::CoarseShare, run, increment, chunk: 0 };
        let coarse: Vec<u64> = match &self.strata {
            None => increments
                .scan(0, |sum, t| {
                    let share = self.inserted(t) - self.inserted(t - 1);
                    *sum += coarse_share(share, passive_words, key(t));
                    Some(*sum)
                })
                .collect(),
            Some(_) => {
                let (coarse_words, word) = ((1 << 64) - passive_words, key(0).words().at(0));
                increments.map(|t| coarse_until(self.inserted(t), coarse_words, word)).collect()
            }
        };
        let inserted = self.inserted.iter().zip(&coarse).map(|(all, coarse)| all - coarse).collect();
        let (is_stratified, first_word) = (self.is_stratified(), passive_words as u64);
        let parts = Self {
            guide: self.sampler.guide_from(first_word),
            first_word,
            inserted: coarse,
            passive: PassiveSupply { inserted, words: passive_words, expected },
            ..self
        };
        if is_stratified { parts.stratified(seed, run) } else { parts }
    }

    pub(crate) fn increments(&self) -> u64 {
        self.inserted.len() as u64
    }

    /// Number of base particles inserted one by one up to and including increment `increment`.
    pub fn inserted(&self, increment: u64) -> u64 {
        running(&self.inserted, increment)
    }

    /// Number of passive base particles inserted as counts up to and including increment `increment`.
    pub fn passive_inserted(&self, increment: u64) -> u64 {
        running(&self.passive.inserted, increment)
    }

    pub(crate) fn passive_words(&self) -> u128 {
        self.passive.words
    }

    /// Passive particles before the first increment, on a network of `voids` voids.
    pub(super) fn no_passive_yet(&self, voids: usize) -> Passive {
        match &self.passive {
            part if part.inserted.is_empty() => Passive::OneByOne,
            part if part.expected => Passive::Expected(Box::new(Expected::new(voids))),
            _ => Passive::Counts(vec![0; voids]),
        }
    }

    /// Strata of the particles inserted one by one in increment `increment`, if the run is stratified.
    pub(super) fn strata(&self, increment: u64) -> Option<IncrementStrata<'_>> {
        let count = self.inserted(increment) - self.inserted(increment - 1);
        self.strata.as_ref().map(|strata| strata.increment(increment, count))
    }

    pub(crate) fn is_stratified(&self) -> bool {
        self.strata.is_some()
    }

    /// Sizes of the base.
    pub fn sampler(&self) -> &SizeSampler {
        &self.sampler
    }

    /// Diameter of all base particles, if they have one size.
    pub(crate) fn single_size(&self) -> Option<f32> {
        let size = self.sampler.smallest();
        (size == self.sampler.largest()).then_some(size)
    }

    /// Number of base particles of the run that are walked one by one.
    pub fn total(&self) -> u64 {
        self.inserted(self.increments())
    }

    #[inline]
    pub(crate) fn diameter(&self, word: u64) -> f32 {
        self.sampler.diameter(self.word(word))
    }

    /// Computes [`Supply::diameter`] of every word; overwrites the words.
    ///
    /// # Panics
    /// If the slices differ in length.
    #[inline(always)]
    pub(crate) fn fill(&self, words: &mut [u64], out: &mut [f32]) {
        if self.first_word != 0 {
            words.iter_mut().for_each(|word| *word = self.word(*word));
        }
        self.sampler.fill_guided(&self.guide, words, out);
    }

    #[inline]
    fn word(&self, word: u64) -> u64 {
        match self.first_word {
            0 => word,
            first => {
                let width = u128::from(u64::MAX - first) + 1;
                first + ((u128::from(word) * width) >> 64) as u64
            }
        }
    }
}

/// Maximum size of passive particles with this law of arching, if this is the finest open constriction; no
/// particle is passive if blocked constrictions leave openings.
pub(super) fn passive_limit(arching: Option<&Arching>, leaves_openings: bool, finest: f32) -> f32 {
    match arching {
        _ if leaves_openings => 0.0,
        arching => arching.map_or(finest, |arching| arching.law.passive_limit(finest)),
    }
}

fn running(sums: &[u64], increment: u64) -> u64 {
    let entries = (increment as usize).min(sums.len());
    entries.checked_sub(1).map_or(0, |last| sums[last])
}

/// Sampling of start nodes and sizes of the base particles.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, serde::Serialize, serde::Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Sampling {
    /// Independent draws, as in the paper.
    #[default]
    Independent,
    /// Draws spread evenly over sizes and start nodes: the marginal distribution of each particle is
    /// unchanged, and replicates scatter less.
    Stratified,
}

impl Leaf for Sampling {}

impl Sampling {
    /// All samplings, in the order shown to users.
    pub const ALL: [Sampling; 2] = [Sampling::Independent, Sampling::Stratified];

    /// Name of the sampling in a scene.
    pub fn name(self) -> &'static str {
        match self {
            Self::Independent => "independent",
            Self::Stratified => "stratified",
        }
    }
}

/// Strata of a stratified run: each particle has the distribution of an independent draw, but together
/// they cover sizes and start nodes evenly.
///
/// A run of `T` increments that inserts at most `K` particles in each has `T K` strata of equal probability:
/// `K` groups of `T`, finest first. Particle `m` of increment `t` takes group `P_t(m)`, and in it stratum
/// `Q_k(t - 1)`; `P` and `Q` are keyed permutations. The `n` particles of an increment divide the start nodes
/// into `n` equal parts, and each takes a place in its part. Nodes need no permutation, as the order of
/// particles does not affect the walk.
#[derive(Clone, Debug)]
struct Strata {
    seed: u64,
    run: u64,
    within_increment: Permutation,
    within_group: Permutation,
    /// Number of words in a stratum; the first `longer` strata have one more.
    width: u128,
    longer: u64,
}

impl Strata {
    /// Creates the strata of a run that inserts at most `most` (at least 1) particles in each increment.
    pub(crate) fn new(seed: u64, run: u64, most: u64, increments: u64) -> Self {
        let strata = u128::from(most) * u128::from(increments);
        let all = 1u128 << 64;
        Self {
            seed,
            run,
            within_increment: Permutation::new(most),
            within_group: Permutation::new(increments),
            width: all / strata,
            longer: (all % strata) as u64,
        }
    }

    pub(crate) fn increment(&self, increment: u64, count: u64) -> IncrementStrata<'_> {
        let Self { seed, run, .. } = *self;
        let words = |increment| Key { seed, purpose: Purpose::Strata, run, increment, chunk: 0 }.words();
        IncrementStrata { strata: self, increment, count, groups: words(increment), order: words(0) }
    }
}

pub(super) struct IncrementStrata<'a> {
    strata: &'a Strata,
    increment: u64,
    count: u64,
    /// Words of the permutation of this increment.
    groups: Words,
    /// Words of the permutations of the groups.
    order: Words,
}

impl IncrementStrata<'_> {
    /// Start node (of `nodes`) of particle `m` of the increment, from random `word`.
    #[inline]
    pub(crate) fn node(&self, m: u64, word: u64, nodes: u64) -> usize {
        let place = u128::from(m) * u128::from(nodes) + u128::from(below(word, nodes));
        match u64::try_from(place) {
            Ok(place) => (place / self.count) as usize,
            Err(_) => (place / u128::from(self.count)) as usize,
        }
    }

    /// Word of the sampler for particle `m` of the increment, from random `word`.
    #[inline]
    pub(crate) fn size_word(&self, m: u64, word: u64) -> u64 {
        let strata = self.strata;
        let group = strata.within_increment.image(m, self.groups, 0);
        let stratum = group * strata.within_group.size
            + strata.within_group.image(self.increment - 1, self.order, 1 + group);
        let before = u128::from(stratum) * strata.width + u128::from(stratum.min(strata.longer));
        let width = strata.width + u128::from(stratum < strata.longer);
        (before + ((u128::from(word) * width) >> 64)) as u64
    }
}

/// Keyed permutations of `0 .. size`: a shuffle for few elements; for many an alternating Feistel network
/// on the next larger rectangle, repeated until the image lies inside, followed by a random rotation. The
/// image of every element is exactly uniform.
#[derive(Clone, Copy, Debug)]
struct Permutation {
    size: u64,
    rows: u64,
    columns: u64,
}

/// Maximum number of elements for which a shuffle is as cheap.
const SHUFFLED: usize = 16;

/// Number of Feistel rounds. With 6, pairs of images are not evenly spread in small domains; 10 show no
/// difference from random permutations.
const ROUNDS: u64 = 10;

impl Permutation {
    fn new(size: u64) -> Self {
        let rows = size.isqrt().max(1);
        Self { size, rows, columns: size.div_ceil(rows) }
    }

    /// Image of `element` under permutation `key` of those of `words`.
    #[inline]
    fn image(&self, element: u64, words: Words, key: u64) -> u64 {
        let base = words.at(key);
        if self.size <= SHUFFLED as u64 {
            return self.shuffled(element, words, base);
        }
        let mut at = element;
        loop {
            let (mut left, mut right) = (at % self.rows, at / self.rows);
            let (mut left_size, mut right_size) = (self.rows, self.columns);
            for round in 0..ROUNDS {
                let word = words.at(base ^ (round << 56) ^ right);
                (left, right) = (right, turn(left, below(word, left_size), left_size));
                (left_size, right_size) = (right_size, left_size);
            }
            at = left + self.rows * right;
            if at < self.size {
                return turn(at, below(words.at(!base), self.size), self.size);
            }
        }
    }

    fn shuffled(&self, element: u64, words: Words, base: u64) -> u64 {
        let mut list: [u64; SHUFFLED] = std::array::from_fn(|k| k as u64);
        for k in 0..=element {
            list.swap(k as usize, (k + below(words.at(base ^ k), self.size - k)) as usize);
        }
        list[element as usize]
    }
}

/// `(at + by) mod size` for two numbers below `size`.
#[inline]
fn turn(at: u64, by: u64, size: u64) -> u64 {
    let sum = at + by;
    if sum >= size { sum - size } else { sum }
}

/// Number of coarse particles among the first `inserted` of a run, if `coarse_words` of all 2^64 words
/// draw coarse ones: the expected number, rounded up or down by one random word for the whole run.
fn coarse_until(inserted: u64, coarse_words: u128, word: u64) -> u64 {
    ((u128::from(inserted) * coarse_words).saturating_add(u128::from(word)) >> 64) as u64
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::collections::BTreeSet;

    fn words(seed: u64) -> Words {
        Key { seed, purpose: Purpose::Strata, run: 1, increment: 1, chunk: 0 }.words()
    }

    #[test]
    fn a_permutation_takes_every_value_once() {
        for size in [1, 2, 3, 4, 5, 7, 10, 99, 100, 101, 1000, 4099] {
            let permutation = Permutation::new(size);
            for key in 0..4 {
                let images: BTreeSet<u64> = (0..size).map(|e| permutation.image(e, words(9), key)).collect();
                assert_eq!((images.len() as u64, images.last()), (size, Some(&(size - 1))), "{size}, {key}");
            }
        }
    }

    /// Images of pairs over 2,000 keys each: a deviation of a seventh in the frequency of a pair would be
    /// detected.
    #[test]
    fn pairs_of_images_are_as_frequent_as_in_random_permutations() {
        for size in [2u64, 3, 5, 17, 20, 25] {
            let (permutation, keys) = (Permutation::new(size), 2_000 * size * size);
            let mut seen = vec![0u64; (size * size) as usize];
            for key in 0..keys {
                let image = |e| permutation.image(e, words(key % 7), key);
                seen[(image(0) * size + image(1)) as usize] += 1;
            }
            let expected = keys as f64 / (size * (size - 1)) as f64;
            let mut chi2 = 0.0;
            for (pair, &count) in seen.iter().enumerate() {
                let same = pair as u64 / size == pair as u64 % size;
                assert!(!same || count == 0);
                let z = (count as f64 - expected) / expected.sqrt();
                assert!(same || z.abs() < 5.5, "size {size}, pair {pair}: {count}, expected {expected}");
                chi2 += if same { 0.0 } else { z * z };
            }
            let degrees = (size * (size - 1)) as f64;
            assert!((chi2 - degrees) / (2.0 * degrees).sqrt() < 5.0, "size {size}: chi2 {chi2}");
        }
    }

    /// Every stratum of the run is taken once if all increments insert the same number.
    #[test]
    fn a_run_takes_every_stratum_once() {
        for (most, increments) in [(1, 1), (1, 100), (3, 7), (40, 25), (257, 4)] {
            let strata = Strata::new(3, 1, most, increments);
            let mut taken = BTreeSet::new();
            for t in 1..=increments {
                let of_increment = strata.increment(t, most);
                for m in 0..most {
                    // Both ends of a stratum.
                    let (low, high) = (of_increment.size_word(m, 0), of_increment.size_word(m, u64::MAX));
                    assert!(low < high || most * increments == 1);
                    taken.insert((low, high));
                }
            }
            let taken: Vec<(u64, u64)> = taken.into_iter().collect();
            assert_eq!(taken.len() as u64, most * increments);
            assert_eq!((taken[0].0, taken[taken.len() - 1].1), (0, u64::MAX));
            assert!(taken.windows(2).all(|w| w[0].1 + 1 == w[1].0), "no gap, no overlap");
        }
    }

    #[test]
    fn start_nodes_differ_by_one_particle_at_most() {
        let strata = Strata::new(5, 1, 1003, 2);
        let many = strata.increment(2, 1003);
        let mut on = [0; 16];
        (0..1003).for_each(|m| on[many.node(m, m.wrapping_mul(0x9e37_79b9_7f4a_7c15), 16)] += 1);
        assert!(on.iter().all(|&n| (62..=64).contains(&n)) && on.iter().sum::<u64>() == 1003, "{on:?}");
        // Few particles on many nodes: no two in one part.
        let few = strata.increment(1, 10);
        let nodes: Vec<usize> = (0..10).map(|m| few.node(m, u64::MAX / 3 * (m % 3), 1000)).collect();
        assert!(nodes.iter().enumerate().all(|(m, &node)| node / 100 == m), "{nodes:?}");
        assert_eq!(strata.increment(1, 4).node(3, u64::MAX, u64::MAX), (u64::MAX - 1) as usize);
    }

    /// One particle's size word over 20,000 seeds: 16 equal classes, chi2 with 15 degrees of freedom (0.0001
    /// point: 44).
    #[test]
    fn one_particle_is_uniform() {
        for (m, t) in [(0, 1), (2, 3), (4, 5)] {
            let mut seen = [0f64; 16];
            for seed in 0..20_000 {
                let strata = Strata::new(seed, 2, 5, 7);
                let word =
                    Key { seed, purpose: Purpose::Insertion, run: 2, increment: t, chunk: 0 }.words().at(m);
                seen[(strata.increment(t, 5).size_word(m, word) >> 60) as usize] += 1.0;
            }
            let chi2: f64 = seen.iter().map(|n| (n - 1250.0) * (n - 1250.0) / 1250.0).sum();
            assert!(chi2 < 44.0, "{chi2}");
        }
    }

    #[test]
    fn coarse_particles_come_evenly() {
        let half = 1u128 << 63;
        assert_eq!([1, 2, 3, 1000].map(|n| coarse_until(n, half, 0)), [0, 1, 1, 500]);
        assert_eq!([1, 2, 3].map(|n| coarse_until(n, half, u64::MAX)), [1, 1, 2]);
        assert_eq!(coarse_until(1 << 60, 1 << 64, u64::MAX), 1 << 60);
        assert_eq!(coarse_until(7, 0, u64::MAX), 0);
    }
}
