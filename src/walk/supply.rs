//! What a run inserts: how many base particles in each increment, and of what sizes.

use crate::gradation::SizeSampler;

/// The base particles of a run.
///
/// Inserted in equal parts over a whole number of increments, such that exactly all of them are in
/// after the last: `floor(n t / k)` after increment `t` of `k`.
#[derive(Clone, Debug)]
pub struct Supply {
    sampler: SizeSampler,
    /// Lowest random word handed to the sampler: 0 for the whole base, larger for its coarse part.
    first_word: u64,
    /// Particles inserted up to and including each increment; entry `t - 1` is increment `t`.
    inserted: Vec<u64>,
}

impl Supply {
    /// `n` particles of the whole base, in `increments` equal parts.
    pub fn new(sampler: SizeSampler, n: u64, increments: u64) -> Self {
        let part = |t: u64| (u128::from(n) * u128::from(t) / u128::from(increments)) as u64;
        Self { sampler, first_word: 0, inserted: (1..=increments).map(part).collect() }
    }

    /// Only sizes that the sampler gives for words from `first_word` on, `shares[t - 1]` of them in
    /// increment `t`.
    pub fn coarse_part(sampler: SizeSampler, first_word: u64, shares: &[u64]) -> Self {
        let running = shares.iter().scan(0, |sum, &share| {
            *sum += share;
            Some(*sum)
        });
        Self { sampler, first_word, inserted: running.collect() }
    }

    /// Number of increments after which everything is inserted.
    pub fn increments(&self) -> u64 {
        self.inserted.len() as u64
    }

    /// Base particles inserted up to and including increment `increment`.
    pub fn inserted(&self, increment: u64) -> u64 {
        match increment {
            0 => 0,
            t => self.inserted[(t as usize).min(self.inserted.len()) - 1],
        }
    }

    /// All base particles of the run.
    pub fn total(&self) -> u64 {
        self.inserted(self.increments())
    }

    /// Diameter of the base particle that `word` draws.
    #[inline]
    pub fn diameter(&self, word: u64) -> f32 {
        match self.first_word {
            0 => self.sampler.diameter(word),
            first => {
                let width = u128::from(u64::MAX - first) + 1;
                self.sampler.diameter(first + ((u128::from(word) * width) >> 64) as u64)
            }
        }
    }
}
