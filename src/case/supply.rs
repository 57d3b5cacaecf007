//! The base as it is walked: its sizes, and how many particles of them.

use super::error::CaseError;
use super::pan;
use crate::gradation::{BaseSupply, Gradation, SizeSampler, base_particles};
use crate::scene::{Amount, Scene};

/// The mass ratio that Eq. (2) speaks of where the scene gives a number: the paper's 5 %.
pub const PAPER_MASS_RATIO: f64 = 0.05;

/// The base as it is walked.
pub(super) struct WalkedBase {
    /// Its pan fraction is walked as particles, not counted by mass only.
    pub pan_is_walked: bool,
    /// Draws its sizes.
    pub sampler: SizeSampler,
    /// N_base as walked, N_base by Eq. (2), whether a cap bit.
    pub n_base: BaseSupply,
    /// Whether N_base by Eq. (2) is known.
    pub has_eq2: bool,
    /// The mass ratio that N_base stands for.
    pub mass_ratio: Option<f64>,
}

impl WalkedBase {
    /// N_base by Eq. (2); `None` where the grains per void are not known.
    pub fn n_base_eq2(&self) -> Option<u64> {
        self.has_eq2.then_some(self.n_base.n_base_eq2)
    }
}

/// What a base is walked against.
pub(super) struct Against<'a> {
    pub scene: &'a Scene,
    pub filter: &'a Gradation,
    /// The finest constriction (mm) of every curve that is walked.
    pub finest_mm: f64,
    /// The reference length (mm).
    pub unit_mm: f64,
    pub grains_per_void: Option<f64>,
    pub voids: u64,
    /// Whether the filter has been packed, so that nothing may be refused any more.
    pub is_packed: bool,
}

impl Against<'_> {
    /// The base as it is walked: a pan fraction that need not be passive is walked as passive particles.
    pub fn walked(&self, base: &Gradation) -> Result<WalkedBase, CaseError> {
        let pan_is_walked = pan::may_block(base, self.finest_mm);
        let taken = match pan_is_walked {
            true => &pan::as_passive(base, self.finest_mm, self.scene)?,
            false => base,
        };
        // A number that the user gives is of particles whose sizes are known; the mass stays the same. A cap
        // is there for the work, which passive particles hardly add to.
        let more = taken.particles_per_unit_volume() / base.particles_per_unit_volume();
        let (ratio, cap) = match self.scene.base.amount() {
            Amount::MassRatio(ratio, Some(cap)) => (ratio, Some(self.times(cap, more)?)),
            Amount::MassRatio(ratio, None) => (ratio, None),
            Amount::Number(n) => return self.number(taken, pan_is_walked, self.times(n, more)?),
        };
        let Some(grains) = self.grains_per_void else {
            let problem = "filter.grains_per_void is missing (Eq. 2): only the shipped curves know theirs";
            return Err(self.scene.clash(problem).into());
        };
        let mut n_base = base_particles(ratio, grains, self.voids, taken, self.filter, cap)?;
        if n_base.n_base == 0 && self.is_packed {
            // The grains per void that were guessed gave one, just so.
            n_base.n_base = 1;
        }
        if n_base.n_base == 0 {
            let problem = "Eq. (2) gives less than half a base particle: a larger network, mass ratio or \
                           grains per void is needed";
            return Err(self.scene.clash(problem).into());
        }
        let sampler = SizeSampler::new(taken, self.unit_mm)?;
        let mass_ratio = match n_base.capped {
            true => ratio * n_base.n_base as f64 / n_base.n_base_eq2 as f64,
            false => ratio,
        };
        Ok(WalkedBase { pan_is_walked, sampler, n_base, has_eq2: true, mass_ratio: Some(mass_ratio) })
    }

    /// The base of which the user gives the number of particles.
    fn number(&self, taken: &Gradation, pan_is_walked: bool, n: u64) -> Result<WalkedBase, CaseError> {
        let sampler = SizeSampler::new(taken, self.unit_mm)?;
        let Some(grains) = self.grains_per_void else {
            let n_base = BaseSupply { n_base: n, n_base_eq2: n, capped: false };
            return Ok(WalkedBase { pan_is_walked, sampler, n_base, has_eq2: false, mass_ratio: None });
        };
        let per_grain = taken.particles_per_unit_volume() / self.filter.particles_per_unit_volume();
        let eq2 = base_particles(PAPER_MASS_RATIO, grains, self.voids, taken, self.filter, None)?.n_base_eq2;
        let mass_ratio = n as f64 / (grains * self.voids as f64 * per_grain);
        let n_base = BaseSupply { n_base: n, n_base_eq2: eq2, capped: false };
        Ok(WalkedBase { pan_is_walked, sampler, n_base, has_eq2: true, mass_ratio: Some(mass_ratio) })
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
