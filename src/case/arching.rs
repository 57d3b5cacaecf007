//! How the base of a case arches, and what blocked constrictions are to it.

use std::sync::Arc;

use libm::cbrt;

use super::{Case, CaseError};
use crate::outcome::Modelled;
use crate::outcome::record::Note;
use crate::outcome::record::{ArchingByVoidRecord, ArchingRecord};
use crate::walk::{Arching, ByVoid, Concentration, DENSEST};

impl Case {
    /// The law of its arches, with as many base particles as these; `None` where particles do not arch.
    pub fn arching(&self, n_base: u64) -> Option<Arc<Arching>> {
        let law = self.scene.law()?;
        if self.scene.concentration_is_by_void() {
            return Some(Arc::new(Arching::by_void(law, self.by_void()?)));
        }
        let concentration = if law.of_concentration { self.concentration(n_base)? } else { DENSEST };
        Some(Arc::new(Arching::new(law, concentration)))
    }

    /// How densely so many base particles arrive: the volume of those of an increment by that of the voids of
    /// the first layer, unless the scene says it. A particle makes one move an increment, so that those of an
    /// increment are in one layer together.
    fn concentration(&self, n_base: u64) -> Option<f64> {
        if let Some(Concentration::Stated(stated)) = self.scene.exits.concentration {
            return Some(stated);
        }
        let times = n_base as f64 / self.supply.n_base as f64;
        let of_base = self.supply.mass_ratio? * times / self.increments() as f64;
        Some((of_base * self.network.layers as f64 / self.void_ratio()?).min(DENSEST))
    }

    /// How the concentration of each void of the lattice follows from the particles in it. The voids have
    /// equal volumes: that of the grains of one void by the void ratio. The base plays no part.
    fn by_void(&self) -> Option<ByVoid> {
        let filter = &self.filter;
        let of_grain = filter.gradation.mean_cube_between(0.0, f64::INFINITY)? / filter.unit_mm.powi(3);
        let void_cube = filter.grains_per_void? * of_grain * self.void_ratio()?;
        Some(ByVoid { void_cube, size: self.scene.exits.arch_size.unwrap_or_default() })
    }

    /// Volume of the voids of the filter by that of its grains, where it is known.
    pub(super) fn void_ratio(&self) -> Option<f64> {
        match (&self.filter.packed, &self.filter.library) {
            (Some(packed), _) => packed.void_ratio,
            (None, Some(library)) => library.part.is_none().then_some(library.found.void_ratio),
            (None, None) => self.shipped_curve().map(|shipped| shipped.void_ratio),
        }
    }

    /// What is written of its arches.
    pub fn arching_record(&self) -> Option<ArchingRecord> {
        let law = self.scene.law()?;
        let by_void = self.by_void().filter(|_| self.scene.concentration_is_by_void());
        let stated =
            self.concentration(self.supply.n_base).filter(|_| law.of_concentration && by_void.is_none());
        Some(ArchingRecord {
            law: law.name.into(),
            source: law.source.into(),
            basis: law.basis.into(),
            range_of_ratio: [1.0, law.widest],
            concentration: stated,
            by_void: by_void.map(|of| ArchingByVoidRecord {
                void_mm: cbrt(of.void_cube) * self.filter.unit_mm,
                size: of.size.name().into(),
            }),
        })
    }

    /// What its walks contain that others leave out.
    pub fn modelled(&self) -> Modelled {
        Modelled {
            flow: self.scene.exit_rule().needs_flow(),
            arches: self.scene.law().is_some(),
            openings: self.scene.leaves_openings(),
        }
    }

    /// What arches and openings, which no test has checked, say against a verdict.
    pub fn unchecked_clogging(&self) -> impl Iterator<Item = Note> {
        let arches = self.scene.law().map(|law| Note::Arches { law: law.name.into() });
        arches.into_iter().chain(self.scene.leaves_openings().then_some(Note::Openings {}))
    }

    /// Refuses a law that asks how densely the base arrives where nothing says so, and openings beside
    /// particles of unknown size.
    ///
    /// # Errors
    /// The setting that is missing.
    pub(super) fn check_clogging(&self) -> Result<(), CaseError> {
        let scene = &self.scene;
        if scene.leaves_openings() && self.base.as_given().pan_fraction() > 0.0 {
            let problem = "walk.blocked = \"open\" needs the sizes of the whole base, as openings may stop a \
                           particle of any size: add base.d0_mm, or finer sieves down to 0 %";
            return Err(scene.clash(problem).into());
        }
        let needs = scene.law().is_some_and(|law| law.of_concentration);
        match needs && self.concentration(self.supply.n_base).is_none() {
            true => {
                let problem = "walk.concentration is needed, as a number: how densely the base arrives \
                               follows from the filter's void ratio and the mass of the base, which are not \
                               known here";
                Err(scene.clash(problem).into())
            }
            false => Ok(()),
        }
    }
}
