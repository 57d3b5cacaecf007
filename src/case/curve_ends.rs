//! How far a case's constriction curve may be off, as curves that are walked besides.

use super::Case;
use crate::constrictions::{Curve, inscribed};

/// Another curve that the filter may have.
pub struct OtherCurve {
    /// Which it is, in words.
    pub name: String,
    /// The curve (mm).
    pub curve: Curve,
}

impl Case {
    /// The ends of the range in which the constriction curve is known: of a filter whose finer part was
    /// packed, the constrictions as much coarser as leaving the others out made them finer at most; of a
    /// guess, the densest and the loosest. None for a curve that was given, or measured on the whole.
    pub fn curve_ends(&self) -> Vec<OtherCurve> {
        if self.fixed_network.is_some() {
            return Vec::new();
        }
        let finer_by = self.packed.as_ref().and_then(|packed| packed.part).map_or(0.0, |part| part.finer_by);
        let coarser = 1.0 / (1.0 - finer_by);
        let coarser = (finer_by > 0.0).then(|| {
            let name = format!("constrictions {:.1} % coarser", 100.0 * (coarser - 1.0));
            Some(OtherCurve { name, curve: self.curve.scaled(coarser).ok()? })
        });
        let guess = |density: f64| {
            let name = format!("estimate = {density}");
            Some(OtherCurve { name, curve: inscribed(&self.filter, density).ok()? })
        };
        let given = self.scene.filter.estimate;
        let is_other = |end: &f64| given.is_some_and(|given| given != *end);
        let guesses = [1.0, 0.0].into_iter().filter(is_other).map(guess);
        coarser.into_iter().chain(guesses).flatten().collect()
    }

    /// The same case with another constriction curve: the same base, as much of it.
    pub fn with_curve(&self, curve: Curve) -> Self {
        Self { curve, ..self.clone() }
    }
}
