//! Number of particles of a case that are walked one by one: it decides both memory and time.

use super::Case;
use voidwalk_core::walk::Engine;

impl Case {
    /// Base particles of a run of `n_base` that are walked one by one: all, or those that may be coarser than
    /// the finest constriction.
    pub fn one_by_one(&self, n_base: u64) -> u64 {
        if self.takes_each(n_base) {
            return n_base;
        }
        let passive = self.first_word(n_base) as f64 / 18_446_744_073_709_551_616.0;
        (n_base as f64 * (1.0 - passive)).ceil() as u64
    }

    /// True if all of `n_base` particles are walked one by one, whatever their sizes, on a network that has
    /// its finest constriction.
    pub fn takes_each(&self, n_base: u64) -> bool {
        let passive = Engine::passive_share(n_base / self.increments(), self.passive_words());
        self.scene.walk.engine.takes_each(passive, self.network.start_nodes)
    }

    /// The first random word that draws one of those particles.
    pub fn first_word(&self, n_base: u64) -> u128 {
        if self.takes_each(n_base) { 0 } else { self.passive_words() }
    }

    /// Number of the 2^64 words that draw a particle that is passive on the open network.
    fn passive_words(&self) -> u128 {
        if self.scene.leaves_openings() {
            return 0;
        }
        let (filter, fixed) = (&self.filter, self.network.fixed.as_ref());
        let finest = fixed.map_or((filter.finest_mm / filter.unit_mm) as f32, |fixed| fixed.finest);
        self.supply.sampler.word_limit(self.scene.law().map_or(finest, |law| law.passive_limit(finest)))
    }
}
