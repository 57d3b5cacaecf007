//! The base of a case as it was given, and the readings of its pan fraction.

use super::Case;
use super::pan::taken_as;
use super::supply::WalkedBase;
use crate::gradation::Gradation;
use crate::outcome::record::PanSize;

impl Case {
    /// The base as it was given, before any regrading.
    pub fn base_as_given(&self) -> &Gradation {
        self.regraded_from.as_ref().map_or(&self.base, |(given, _)| given)
    }

    /// The same case with another reading of its base, of which no other number or thickness is studied.
    pub(super) fn read_as(&self, walked: WalkedBase) -> Self {
        let mut scene = self.scene.clone();
        scene.record.sensitivity.clear();
        scene.record.thickness = Some(Vec::new());
        Self {
            pan_size: walked.pan_size,
            n_base_eq2: walked.n_base_eq2(),
            sampler: walked.sampler,
            n_base: walked.n_base.n_base,
            capped: walked.n_base.capped,
            mass_ratio: walked.mass_ratio,
            scene,
            ..self.clone()
        }
    }

    /// The case itself and its other readings, where it has several.
    pub fn readings(&self) -> impl Iterator<Item = &Case> {
        std::iter::once(self).chain(&self.other_readings)
    }

    /// The readings between which all others lie; the case itself where it has one.
    pub fn bounds(&self) -> impl Iterator<Item = &Case> {
        self.readings().filter(|case| case.pan_size != Some(PanSize::Continued))
    }

    /// Share of the base's mass that is passive and counted by mass only.
    pub fn pan_by_mass_only(&self) -> f64 {
        if self.pan_size.is_some() { 0.0 } else { self.base.pan_fraction() }
    }

    /// The base with either end of the sizes that its pan fraction may have, the finest first, as they are
    /// walked: what is passive is of no other size to a walk. `None` without a pan fraction.
    pub(super) fn tail_as(&self) -> Option<[Gradation; 2]> {
        if self.base.pan_fraction() == 0.0 {
            return None;
        }
        let read = |size| taken_as(&self.base, size, self.finest_mm).ok();
        let coarse = read(PanSize::FinestSieve)?;
        let fine = if self.pan_size.is_some() { read(PanSize::Passive)? } else { coarse.clone() };
        Some([fine, coarse])
    }
}
