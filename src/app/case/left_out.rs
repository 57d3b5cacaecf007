//! Parts of a scene that a case does not need.

use super::Case;
use crate::outcome::left_out::LeftOut;

impl Case {
    /// Parts of the program that this scene does not need.
    pub fn left_out(&self) -> Vec<LeftOut> {
        let filter = &self.filter;
        let mut left_out = vec![match &self.network.fixed {
            Some(fixed) if fixed.packing.is_some() => LeftOut::Lattice,
            Some(_) => LeftOut::BeforeNetwork,
            None if filter.packed.is_some() => LeftOut::GivenCurve,
            None if filter.library.is_some() => LeftOut::PackingByLibrary,
            None if filter.guessed_density.is_some() => LeftOut::PackingByGuess,
            None => LeftOut::PackingByCurve,
        }];
        if let Some(other) = filter.packed.as_ref().and_then(|packed| packed.same_shape.as_ref()) {
            left_out.push(LeftOut::PackingOfShape(other.folder.clone(), other.factor));
        }
        if self.scene.walk.runs == 1 {
            left_out.push(LeftOut::SecondRun);
        }
        left_out.extend(self.sensitivity_not_walked());
        for factor in self.thickness_factors() {
            if let Err(error) = self.of_thickness(factor) {
                left_out.push(LeftOut::ThicknessRefused(factor, error.to_string()));
            }
        }
        left_out.extend(self.thickness_not_walked());
        left_out
    }
}
