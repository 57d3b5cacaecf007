//! The particles that a base is walked as: their sizes, and how many there are.

use super::error::CaseError;
use super::filter::CaseFilter;
use super::pan;
use crate::scene::{Amount, Scene};
use voidwalk_core::gradation::{BaseSupply, Gradation, SizeSampler, base_particles};

/// The mass ratio for Eq. (2) if the scene gives a number of particles: the paper's 5 %.
pub const PAPER_MASS_RATIO: f64 = 0.05;

/// The particles that a base is walked as.
#[derive(Clone)]
pub struct CaseSupply {
    /// The base's pan fraction is walked as particles just finer than every constriction, not counted by mass
    /// only.
    pub pan_is_walked: bool,
    /// Draws their sizes, in units of the reference length.
    pub sampler: SizeSampler,
    /// Base particles of a run, by Eq. (2) or as given.
    pub n_base: u64,
    /// Base particles by Eq. (2); `None` if the grains per void are not given.
    pub n_base_eq2: Option<u64>,
    /// True if a cap made `n_base` smaller than Eq. (2).
    pub capped: bool,
    /// Mass of base over mass of filter for `n_base` particles; `None` if the grains per void are not given.
    pub mass_ratio: Option<f64>,
}

/// The filter against which a base is walked.
pub(super) struct Against<'a> {
    pub scene: &'a Scene,
    pub filter: &'a CaseFilter,
    pub voids: u64,
    /// True if the filter has been packed, so that the case can no longer be refused.
    pub is_packed: bool,
}

impl Against<'_> {
    /// The particles of a base: a pan fraction that need not be passive is walked as passive particles.
    pub fn supply(&self, base: &Gradation) -> Result<CaseSupply, CaseError> {
        let pan_is_walked = pan::may_block(base, self.filter.finest_mm);
        let taken = match pan_is_walked {
            true => &pan::as_passive(base, self.filter.finest_mm, self.scene)?,
            false => base,
        };
        // A number that the user gives counts particles whose sizes are known; the mass stays the same. A cap
        // limits the work, to which passive particles add little.
        let more = taken.particles_per_unit_volume() / base.particles_per_unit_volume();
        let (ratio, cap) = match self.scene.base.amount() {
            Amount::MassRatio(ratio, Some(cap)) => (ratio, Some(self.times(cap, more)?)),
            Amount::MassRatio(ratio, None) => (ratio, None),
            Amount::Number(n) => return self.number(taken, pan_is_walked, self.times(n, more)?),
        };
        let Some(grains) = self.filter.grains_per_void else {
            let problem = "filter.grains_per_void is missing (Eq. 2): only the shipped curves know theirs";
            return Err(self.scene.clash(problem).into());
        };
        let BaseSupply { mut n_base, n_base_eq2, capped } =
            base_particles(ratio, grains, self.voids, taken, &self.filter.gradation, cap)?;
        if n_base == 0 && self.is_packed {
            // The grains per void that were guessed gave one, just so.
            n_base = 1;
        }
        if n_base == 0 {
            let problem = "Eq. (2) gives less than half a base particle: a larger network, mass ratio or \
                           grains per void is needed";
            return Err(self.scene.clash(problem).into());
        }
        let sampler = SizeSampler::new(taken, self.filter.unit_mm)?;
        let mass_ratio = Some(if capped { ratio * n_base as f64 / n_base_eq2 as f64 } else { ratio });
        let n_base_eq2 = Some(n_base_eq2);
        Ok(CaseSupply { pan_is_walked, sampler, n_base, n_base_eq2, capped, mass_ratio })
    }

    /// Supply of a base whose number of particles the user gives.
    fn number(&self, taken: &Gradation, pan_is_walked: bool, n_base: u64) -> Result<CaseSupply, CaseError> {
        let sampler = SizeSampler::new(taken, self.filter.unit_mm)?;
        let (mut n_base_eq2, mut mass_ratio) = (None, None);
        if let Some(grains) = self.filter.grains_per_void {
            let filter = &self.filter.gradation;
            let per_grain = taken.particles_per_unit_volume() / filter.particles_per_unit_volume();
            let supply = base_particles(PAPER_MASS_RATIO, grains, self.voids, taken, filter, None)?;
            n_base_eq2 = Some(supply.n_base_eq2);
            mass_ratio = Some(n_base as f64 / (grains * self.voids as f64 * per_grain));
        }
        Ok(CaseSupply { pan_is_walked, sampler, n_base, n_base_eq2, capped: false, mass_ratio })
    }

    /// A number of particles times `more`.
    fn times(&self, n: u64, more: f64) -> Result<u64, CaseError> {
        let product = n as f64 * more;
        match more {
            1.0 => Ok(n),
            _ if product < 9e18 => Ok((product.round() as u64).max(1)),
            _ => {
                let problem = "the base's pan fraction, as fine as the finest constriction, has more \
                               particles than can be counted: give base.d0_mm or a finer sieve";
                Err(self.scene.clash(problem).into())
            }
        }
    }
}
