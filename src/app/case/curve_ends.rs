//! Uncertainty of a case's constriction curve, as further curves that are walked.

use crate::outcome::packing::PackedPart;
use voidwalk_core::constrictions::{Curve, inscribed};
use voidwalk_core::gradation::Gradation;

/// Another curve that the filter may have.
#[derive(Clone)]
pub struct OtherCurve {
    /// Which it is, in words.
    pub name: String,
    /// The curve (mm).
    pub curve: Curve,
    /// Grains per void of such a filter over the grains per void of the case's own curve: the base is
    /// multiplied by it.
    pub times_grains: f64,
}

/// The ends of a guess, by relative density.
const END_GUESSES: [(f64, &str); 2] = [(1.0, "densest guess"), (0.0, "loosest guess")];

/// Name of the guess at this relative density if it is an end.
pub fn end_of_guess(relative_density: f64) -> Option<&'static str> {
    END_GUESSES.iter().find(|(density, _)| *density == relative_density).map(|(_, name)| *name)
}

/// The ends of the range in which a constriction curve is known: for a filter whose finer part was packed,
/// the constrictions made coarser by the greatest error of leaving the others out; for a guess, the densest
/// and the loosest. Empty for a curve that was given, or measured on the whole.
pub(super) fn of(
    curve: &Curve,
    filter: &Gradation,
    part: Option<&PackedPart>,
    guessed: Option<f64>,
) -> Vec<OtherCurve> {
    let finer_by = part.map_or(0.0, |part| part.finer_by);
    let coarser = 1.0 / (1.0 - finer_by);
    let coarser = (finer_by > 0.0).then(|| {
        let name = format!("constrictions {:.1} % coarser", 100.0 * (coarser - 1.0));
        Some(OtherCurve { name, curve: curve.scaled(coarser).ok()?, times_grains: 1.0 })
    });
    let guess = |(density, name): (f64, &str)| {
        let name = name.to_owned();
        Some(OtherCurve { name, curve: inscribed(filter, density).ok()?, times_grains: 1.0 })
    };
    let is_other = |(end, _): &(f64, &str)| guessed.is_some_and(|given| given != *end);
    let guesses = END_GUESSES.into_iter().filter(is_other).map(guess);
    coarser.into_iter().chain(guesses).flatten().collect()
}
