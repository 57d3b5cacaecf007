//! How far a case's constriction curve may be off, as curves that are walked besides.

use super::Case;
use super::packed_filter::PackedFilter;
use crate::constrictions::{Curve, inscribed};
use crate::gradation::Gradation;

/// Another curve that the filter may have.
pub struct OtherCurve {
    /// Which it is, in words.
    pub name: String,
    /// The curve (mm).
    pub curve: Curve,
}

/// The ends of the range in which a constriction curve is known: of a filter whose finer part was packed, the
/// constrictions as much coarser as leaving the others out made them finer at most; of a guess, the densest
/// and the loosest. None for a curve that was given, or measured on the whole.
pub(super) fn of(
    curve: &Curve,
    filter: &Gradation,
    packed: Option<&PackedFilter>,
    guessed: Option<f64>,
) -> Vec<OtherCurve> {
    let finer_by = packed.and_then(|packed| packed.part.as_ref()).map_or(0.0, |part| part.finer_by);
    let coarser = 1.0 / (1.0 - finer_by);
    let coarser = (finer_by > 0.0).then(|| {
        let name = format!("constrictions {:.1} % coarser", 100.0 * (coarser - 1.0));
        Some(OtherCurve { name, curve: curve.scaled(coarser).ok()? })
    });
    let guess = |density: f64| {
        let name = format!("estimate = {density}");
        Some(OtherCurve { name, curve: inscribed(filter, density).ok()? })
    };
    let is_other = |end: &f64| guessed.is_some_and(|given| given != *end);
    let guesses = [1.0, 0.0].into_iter().filter(is_other).map(guess);
    coarser.into_iter().chain(guesses).flatten().collect()
}

impl Case {
    /// The other curves that are walked besides the case's own: the ends of the range in which it is known.
    pub fn curve_ends(&self) -> Vec<OtherCurve> {
        if self.fixed_network.is_some() {
            return Vec::new();
        }
        of(&self.curve, &self.filter, self.packed.as_ref(), self.scene.filter.estimate)
    }

    /// The same case with another constriction curve: the same base, as much of it.
    pub fn with_curve(&self, curve: Curve) -> Self {
        let finest_mm = self.finest_mm.min(curve.smallest());
        Self { curve, finest_mm, ..self.clone() }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::outcome::record::PanSize;
    use crate::scene::Scene;

    /// The pan fraction of the first reading blocks nothing at either end of a guess, so that a walk there
    /// follows numbers and asks for no column of billions of particles.
    #[test]
    fn a_passive_pan_fraction_is_passive_at_the_ends_of_a_guess_too() {
        let folder = tempfile::tempdir().unwrap();
        let (base, filter) = (folder.path().join("base.csv"), folder.path().join("filter.csv"));
        std::fs::write(&base, "opening_mm,percent_finer\n19,100\n9.5,76\n4.75,27.2\n2.36,16.4\n").unwrap();
        let sieves = "19,100\n9.5,77.5\n4.75,61.3\n1.18,52\n0.3,15.7\n0.075,8\n0.02,6.5\n";
        std::fs::write(&filter, format!("opening_mm,percent_finer\n{sieves}")).unwrap();
        let path = |name: &str, file: &std::path::Path| format!("{name}.sieve={}", file.display());
        let set = [path("base", &base), path("filter", &filter)].into_iter();
        let set = set.chain(["filter.estimate=0.5", "base.n_base=50", "network.nx=4"].map(String::from));
        let case = Case::new(Scene::built_in(&set.collect::<Vec<_>>()).unwrap()).unwrap();
        assert_eq!(case.pan_size, Some(PanSize::Passive));
        let ends = case.curve_ends();
        assert!(ends.iter().any(|end| end.curve.smallest() < case.curve.smallest()));
        for end in ends {
            assert!(case.sampler.smallest() < (end.curve.smallest() / case.unit_mm) as f32, "{}", end.name);
        }
        assert!(case.bytes(case.n_base, 1) < 10_000_000, "{}", case.bytes(case.n_base, 1));
    }
}
