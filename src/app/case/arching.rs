//! Arching of the base of a case, and the effect of blocked constrictions on it.

use std::sync::Arc;

use super::{Case, CaseError};
use crate::outcome::Modelled;
use crate::outcome::record::ArchingRecord;
use voidwalk_core::walk::{Arching, DENSEST};
use voidwalk_practice::Note;

impl Case {
    /// The law of its arches at the concentration that the scene states; `None` if particles do not arch.
    pub fn arching(&self) -> Option<Arc<Arching>> {
        let concentration = self.scene.exits.concentration.unwrap_or(DENSEST);
        self.scene.law().map(|law| Arc::new(Arching::new(law, concentration)))
    }

    /// Record of its arches.
    pub fn arching_record(&self) -> Option<ArchingRecord> {
        let law = self.scene.law()?;
        Some(ArchingRecord {
            law: law.name.into(),
            source: law.source.into(),
            basis: law.basis.into(),
            range_of_ratio: [1.0, law.widest],
            concentration: self.scene.exits.concentration,
        })
    }

    /// Mechanisms in its walks that others leave out.
    pub fn modelled(&self) -> Modelled {
        Modelled {
            flow: self.scene.exit_rule().needs_flow(),
            arches: self.scene.law().is_some(),
            openings: self.scene.leaves_openings(),
        }
    }

    /// Doubts about a verdict from arches and openings, which no test has checked.
    pub fn unchecked_clogging(&self) -> impl Iterator<Item = Note> {
        let arches = self.scene.law().map(|law| Note::Arches { law: law.name.into() });
        arches.into_iter().chain(self.scene.leaves_openings().then_some(Note::Openings {}))
    }

    /// Refuses openings beside particles of unknown size.
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
        Ok(())
    }
}
