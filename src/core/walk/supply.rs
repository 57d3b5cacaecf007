//! Base particles that a run inserts: their number in each increment, and their sizes.

use std::sync::Arc;

use super::Arching;
use super::counts::{Passive, coarse_share};
use super::strata::{self, IncrementStrata, Strata};
use crate::gradation::{SizeGuide, SizeSampler};
use crate::stream::{Key, Purpose};

/// The base particles of a run.
///
/// Inserted in equal parts over a whole number of increments, such that exactly all of them are in
/// after the last: `floor(n t / k)` after increment `t` of `k`.
#[derive(Clone, Debug)]
pub struct Supply {
    sampler: SizeSampler,
    /// Lowest random word handed to the sampler: 0 for the whole base, larger for its coarse part.
    first_word: u64,
    /// Place where the sampler looks for the words from that one on.
    guide: SizeGuide,
    /// Particles inserted one by one up to and including each increment; entry `t - 1` is increment `t`.
    inserted: Vec<u64>,
    /// The particles that are kept as counts.
    passive: PassiveSupply,
    /// Strata that start nodes and sizes are spread over, if they are not independent.
    strata: Option<Strata>,
    /// Law by which its particles arch, if they do.
    arching: Option<Arc<Arching>>,
    /// True if constrictions that its particles block leave openings.
    leaves_openings: bool,
}

/// The passive particles of a run that are not walked one by one.
#[derive(Clone, Debug, Default)]
struct PassiveSupply {
    /// Particles inserted up to and including each increment; empty if there are no such particles.
    inserted: Vec<u64>,
    /// The sampler gives passive particles for words below this.
    words: u128,
    /// True if their expectation is enough.
    expected: bool,
}

impl Supply {
    /// `n` particles of the whole base, in `increments` equal parts.
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

    /// This supply with particles that arch by this law.
    pub fn arching_by(self, arching: Option<Arc<Arching>>) -> Self {
        Self { arching, ..self }
    }

    /// This supply, where blocked constrictions leave openings (module `openings`) or are closed.
    pub fn leaving_openings(self, leaves_openings: bool) -> Self {
        Self { leaves_openings, ..self }
    }

    /// Tells if constrictions that its particles block leave openings.
    pub fn leaves_openings(&self) -> bool {
        self.leaves_openings
    }

    /// Law by which its particles arch; `None` if they do not.
    pub fn arching(&self) -> Option<&Arching> {
        self.arching.as_deref()
    }

    /// Size up to which its particles are passive where this is the finest open constriction.
    pub(super) fn passive_limit(&self, finest: f32) -> f32 {
        if self.leaves_openings {
            return 0.0;
        }
        self.arching().map_or(finest, |arching| arching.passive_limit(finest))
    }

    /// This supply with start nodes and sizes spread evenly (module `strata`), for run `run` of `seed`. To be
    /// called before a passive part is taken out.
    pub fn stratified(self, seed: u64, run: u64) -> Self {
        let share = |t| self.inserted(t) - self.inserted(t - 1);
        let most = (1..=self.increments()).map(share).max().unwrap_or(0);
        let strata = Strata::new(seed, run, most.max(1), self.increments().max(1));
        Self { strata: Some(strata), ..self }
    }

    /// This supply with the particles drawn by words below `passive_words` kept as counts, or as an
    /// expectation. Their number in each increment's share is drawn for run `run` of `seed`.
    pub fn with_passive_part(self, passive_words: u128, expected: bool, seed: u64, run: u64) -> Self {
        let increments = 1..=self.increments();
        let share = |t| self.inserted(t) - self.inserted(t - 1);
        let coarse: Vec<u64> = match &self.strata {
            None => increments.map(|t| coarse_share(share(t), passive_words, seed, run, t)).collect(),
            Some(_) => {
                let key = Key { seed, purpose: Purpose::CoarseShare, run, increment: 0, chunk: 0 };
                let word = key.words().at(0);
                let until = |t| strata::coarse_until(self.inserted(t), (1 << 64) - passive_words, word);
                increments.map(|t| until(t) - until(t - 1)).collect()
            }
        };
        let parts = Self::coarse_part(self.sampler.clone(), passive_words as u64, &coarse);
        let inserted = self.inserted.iter().zip(&parts.inserted).map(|(all, coarse)| all - coarse).collect();
        let passive = PassiveSupply { inserted, words: passive_words, expected };
        let parts = Self { passive, arching: self.arching, leaves_openings: self.leaves_openings, ..parts };
        match self.strata {
            None => parts,
            Some(_) => parts.stratified(seed, run),
        }
    }

    /// Only sizes that the sampler gives for words from `first_word` on, `shares[t - 1]` of them in
    /// increment `t`.
    pub fn coarse_part(sampler: SizeSampler, first_word: u64, shares: &[u64]) -> Self {
        let running = shares.iter().scan(0, |sum, &share| {
            *sum += share;
            Some(*sum)
        });
        let (inserted, guide) = (running.collect(), sampler.guide_from(first_word));
        Self { guide, first_word, inserted, ..Self::new(sampler, 0, 1) }
    }

    /// Number of increments after which everything is inserted.
    pub fn increments(&self) -> u64 {
        self.inserted.len() as u64
    }

    /// Base particles inserted one by one up to and including increment `increment`.
    pub fn inserted(&self, increment: u64) -> u64 {
        running(&self.inserted, increment)
    }

    /// Passive base particles inserted as counts up to and including increment `increment`.
    pub fn passive_inserted(&self, increment: u64) -> u64 {
        running(&self.passive.inserted, increment)
    }

    /// The sampler gives particles that are kept as counts for words below this.
    pub fn passive_words(&self) -> u128 {
        self.passive.words
    }

    /// The passive particles before the first increment on a network of `voids` voids.
    pub(super) fn no_passive_yet(&self, voids: usize) -> Passive {
        match &self.passive {
            part if part.inserted.is_empty() => Passive::OneByOne,
            part => Passive::none_yet(voids, part.expected),
        }
    }

    /// The strata of the particles inserted one by one in increment `increment`, where there are any.
    pub(super) fn strata(&self, increment: u64) -> Option<IncrementStrata<'_>> {
        let count = self.inserted(increment) - self.inserted(increment - 1);
        self.strata.as_ref().map(|strata| strata.increment(increment, count))
    }

    /// Tells if start nodes are spread evenly.
    pub fn is_stratified(&self) -> bool {
        self.strata.is_some()
    }

    /// Sizes of the base.
    pub fn sampler(&self) -> &SizeSampler {
        &self.sampler
    }

    /// The diameter of every base particle, where they have one size.
    pub fn single_size(&self) -> Option<f32> {
        let size = self.sampler.smallest();
        (size == self.sampler.largest()).then_some(size)
    }

    /// All base particles of the run that are walked one by one.
    pub fn total(&self) -> u64 {
        self.inserted(self.increments())
    }

    /// Diameter of the base particle that `word` draws.
    #[inline]
    pub fn diameter(&self, word: u64) -> f32 {
        self.sampler.diameter(self.word(word))
    }

    /// [`Supply::diameter`] of every word; the words are used up.
    ///
    /// # Panics
    /// If the slices differ in length.
    #[inline(always)]
    pub fn fill(&self, words: &mut [u64], out: &mut [f32]) {
        if self.first_word != 0 {
            words.iter_mut().for_each(|word| *word = self.word(*word));
        }
        self.sampler.fill_guided(&self.guide, words, out);
    }

    /// The sampler's word for a random word.
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

fn running(sums: &[u64], increment: u64) -> u64 {
    match (increment, sums.len()) {
        (0, _) | (_, 0) => 0,
        (t, increments) => sums[(t as usize).min(increments) - 1],
    }
}
