//! Stratified insertion: the marginal distribution of each base particle is unchanged, but together they
//! cover sizes and start nodes evenly.
//!
//! # Sizes
//! A run of `T` increments that inserts at most `K` particles in each has `T K` strata of equal probability:
//! `K` groups of `T`, finest first. Within each group every increment has one stratum, and within an
//! increment every particle has a group of its own; so the sizes of an increment are stratified, and so are
//! the sizes of the whole run. Particle `m` of increment `t` takes group `k = P_t(m)` and in it stratum
//! `Q_k(t - 1)`; `P` and `Q` are keyed permutations.
//!
//! # Start nodes
//! The `n` particles of an increment divide the start nodes, in their order, into `n` equal parts, and each
//! takes a place in its part.
//!
//! Group, stratum, place in the stratum and place among the nodes of any one particle are uniform, so its
//! marginal distribution is exactly the one of independent draws; only the joint distribution differs. The
//! order of the particles in an increment plays no part in the walk, so the order of the nodes needs no
//! permutation.

use crate::schema::Leaf;
use crate::stream::{Key, Purpose, Words, below};

/// Sampling of start nodes and sizes of the base particles.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, serde::Serialize, serde::Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Sampling {
    /// Each by itself: the paper's way.
    #[default]
    Independent,
    /// Evenly over sizes and start nodes: the marginal distribution of each particle is unchanged, and
    /// replicates scatter less.
    Stratified,
}

impl Leaf for Sampling {}

impl Sampling {
    /// Every sampling, in the order in which a user is told of them.
    pub const ALL: [Sampling; 2] = [Sampling::Independent, Sampling::Stratified];

    /// Name of the sampling in a scene.
    pub fn name(self) -> &'static str {
        match self {
            Sampling::Independent => "independent",
            Sampling::Stratified => "stratified",
        }
    }
}

/// The strata of a run.
#[derive(Clone, Debug)]
pub(super) struct Strata {
    seed: u64,
    run: u64,
    within_increment: Permutation,
    within_group: Permutation,
    /// Words of a stratum; the first `longer` strata have one more.
    width: u128,
    longer: u64,
}

impl Strata {
    /// Strata of a run that inserts up to `most` particles, at least one, in each of its increments.
    pub fn new(seed: u64, run: u64, most: u64, increments: u64) -> Self {
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

    /// The strata of one increment that inserts `count` particles.
    pub fn increment(&self, increment: u64, count: u64) -> IncrementStrata<'_> {
        let key =
            |increment| Key { seed: self.seed, purpose: Purpose::Strata, run: self.run, increment, chunk: 0 };
        IncrementStrata {
            strata: self,
            increment,
            count,
            groups: key(increment).words(),
            order: key(0).words(),
        }
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
    /// The start node, of `nodes`, that random `word` gives particle `m` of the increment.
    #[inline]
    pub fn node(&self, m: u64, word: u64, nodes: u64) -> usize {
        let place = u128::from(m) * u128::from(nodes) + u128::from(below(word, nodes));
        match u64::try_from(place) {
            Ok(place) => (place / self.count) as usize,
            Err(_) => (place / u128::from(self.count)) as usize,
        }
    }

    /// The word for the sampler that random `word` gives particle `m` of the increment.
    #[inline]
    pub fn size_word(&self, m: u64, word: u64) -> u64 {
        let strata = self.strata;
        let group = strata.within_increment.image(m, self.groups, 0);
        let stratum = group * strata.within_group.size
            + strata.within_group.image(self.increment - 1, self.order, 1 + group);
        let before = u128::from(stratum) * strata.width + u128::from(stratum.min(strata.longer));
        let width = strata.width + u128::from(stratum < strata.longer);
        (before + ((u128::from(word) * width) >> 64)) as u64
    }
}

/// Keyed permutations of `0 .. size`: a shuffle for few elements; for many an alternating Feistel network on
/// the next larger rectangle, walked until it ends inside, and then turned round by a random step. The image
/// of every element is exactly uniform.
#[derive(Clone, Copy, Debug)]
struct Permutation {
    size: u64,
    rows: u64,
    columns: u64,
}

/// Elements up to which a shuffle costs no more.
const SHUFFLED: usize = 16;

/// With 6 rounds pairs of images are not yet evenly spread in small domains; 10 show no difference from
/// random permutations.
const ROUNDS: u64 = 10;

impl Permutation {
    fn new(size: u64) -> Self {
        let rows = size.isqrt().max(1);
        Self { size, rows, columns: size.div_ceil(rows) }
    }

    /// The image of `element` under the permutation that `key` names among those of `words`.
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

    /// Entry `element` of a shuffled list.
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

/// Number of coarse particles among the first `inserted` of a run, given that `coarse_words` of all 2^64
/// words draw coarse ones: the expected number, rounded up or down with one random word for the whole run.
pub(super) fn coarse_until(inserted: u64, coarse_words: u128, word: u64) -> u64 {
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

    /// Images of pairs over 2,000 keys for each: a pair that came up a seventh too often or too rarely would
    /// be seen.
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

    /// Every stratum of the run is taken once where all increments insert as many.
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
        // Few particles for many nodes: no two in one part.
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
