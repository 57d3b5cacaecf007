//! Constrictions of a filter from the library of packings, and the further curves that are walked because
//! these or a guess may be in error.

use super::recipe::{GRAINS_OF_PART, LEAST_WIDTH, that_can_be_packed, width_by_largest};
use crate::outcome::packing::PackedPart;
use crate::scene::LibraryDensity;
use voidwalk_core::constrictions::{Curve, CurveError, FromLibrary, from_library, inscribed};
use voidwalk_core::gradation::Gradation;

/// Minimum error of the grains per void if only the finer part of a filter was looked up: for C33 sand
/// without its coarsest 4.3 %, they were 12.6 % off (`results/library.md`).
const GRAINS_ERROR_OF_PART: f64 = 0.25;

/// Filter as found in the library.
#[derive(Clone)]
pub(crate) struct LibraryFilter {
    /// Constrictions found; those of the loose filter if its density is unknown.
    pub(crate) found: FromLibrary,
    /// Finer part that was looked up, if the whole is too broad.
    pub(crate) part: Option<PackedPart>,
    /// Ends of the range of its curve.
    pub(crate) ends: Vec<OtherCurve>,
}

impl LibraryFilter {
    /// Looks up a filter; `None` if no filter of the library is similar. Errors: cannot fail for a gradation
    /// with a known size.
    pub(crate) fn find(filter: &Gradation, density: LibraryDensity) -> Result<Option<Self>, CurveError> {
        // Looks up the finer part that would be packed, if the whole could not be.
        let width = |gradation: &Gradation| width_by_largest(gradation, GRAINS_OF_PART, 1.0);
        let (looked_up, part) = match width(filter) < LEAST_WIDTH {
            false => (filter.clone(), None),
            true => match that_can_be_packed(filter, width) {
                Some((finer, part)) => (finer, Some(part)),
                None => return Ok(None),
            },
        };
        let [loose, dense] = match density {
            LibraryDensity::Unknown => [LibraryDensity::Loose, LibraryDensity::Dense],
            known => [known; 2],
        };
        let find = |density: LibraryDensity| -> Result<Option<FromLibrary>, CurveError> {
            let entry = from_library(&looked_up, density.relative())?;
            Ok(entry.map(|entry| match &part {
                Some(_) => {
                    FromLibrary { grains_error: entry.grains_error.max(GRAINS_ERROR_OF_PART), ..entry }
                }
                None => entry,
            }))
        };
        let Some(first) = find(loose)? else { return Ok(None) };
        let at_dense = if loose == dense { Some(first.clone()) } else { find(dense)? };
        // Omitting the coarser grains makes all constrictions finer.
        let finer_by = part.as_ref().map_or(0.0, |part| part.finer_by);
        let coarsest = 1.0 / ((1.0 - first.curve_error) * (1.0 - finer_by));
        let end = |density: LibraryDensity, at_density: Option<&FromLibrary>, factor: f64| {
            let [direction, by] = match factor > 1.0 {
                true => ["coarser", &format!("{:.0}", 100.0 * (factor - 1.0))],
                false => ["finer", &format!("{:.0}", 100.0 * (1.0 - factor))],
            };
            let name = format!("{}, constrictions {by} % {direction}", density.name());
            let at_density = at_density?;
            // With less base a larger fraction erodes, so the coarsest curve has the fewest grains. The
            // fine end offers no more base than the library states, so that it is not sealed by base that
            // may be absent.
            let error = if factor > 1.0 { at_density.grains_error } else { 0.0 };
            let times_grains = at_density.grains_per_void / (1.0 + error) / first.grains_per_void;
            Some(OtherCurve { name, curve: at_density.curve.scaled(factor).ok()?, times_grains })
        };
        let ends =
            [end(loose, Some(&first), coarsest), end(dense, at_dense.as_ref(), 1.0 - first.curve_error)];
        Ok(Some(Self { found: first, part, ends: ends.into_iter().flatten().collect() }))
    }
}

/// Other possible curve of the filter.
#[derive(Clone)]
pub(crate) struct OtherCurve {
    pub(crate) name: String,
    /// Constriction curve (mm).
    pub(crate) curve: Curve,
    /// Grains per void of such a filter over those of the case's own curve; the amount of base is
    /// multiplied by it.
    pub(crate) times_grains: f64,
}

/// Ends of a guess by relative density.
const END_GUESSES: [(f64, &str); 2] = [(1.0, "densest guess"), (0.0, "loosest guess")];

/// Name of the guess at this relative density if it is an end.
pub(crate) fn end_of_guess(relative_density: f64) -> Option<&'static str> {
    END_GUESSES.iter().find(|(density, _)| *density == relative_density).map(|(_, name)| *name)
}

/// Ends of the range of a constriction curve. If only the finer part was packed: its constrictions made
/// coarser by the maximum error of omitting the other grains. For a guess: the densest and the loosest
/// guess. Empty for a curve that was given or measured on the whole filter.
pub(super) fn curve_ends(
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_filter_of_unknown_density_has_loose_and_dense_as_its_ends() {
        let filter = Gradation::linear_from_d0(1.0, 3.0).unwrap();
        let at = |density| LibraryFilter::find(&filter, density).unwrap().unwrap();
        let unknown = at(LibraryDensity::Unknown);
        let dc50 = |curve: &voidwalk_core::constrictions::Curve| curve.dc(50.0).unwrap();
        let [loose, dense] = [at(LibraryDensity::Loose), at(LibraryDensity::Dense)];
        let [coarse, fine] = [&unknown.ends[0], &unknown.ends[1]].map(|end| dc50(&end.curve));
        assert!(coarse > dc50(&loose.found.curve) && fine < dc50(&dense.found.curve));
        assert_eq!(unknown.found, loose.found);
        // A dense filter has fewer grains per void, and is offered less base.
        let [of_loose, of_dense] = [&unknown.ends[0], &unknown.ends[1]].map(|end| end.times_grains);
        let at_dense = dense.found.grains_per_void / loose.found.grains_per_void;
        assert!(at_dense < 0.85, "{at_dense}");
        // The error of grains per void near a shape of the library is 6 %.
        assert!((of_loose * 1.06 - 1.0).abs() < 1e-12 && (of_dense / at_dense - 1.0).abs() < 1e-12);
        assert!(unknown.ends[0].name.starts_with("loose, constrictions"), "{}", unknown.ends[0].name);
    }

    #[test]
    fn of_a_broad_filter_the_finer_part_is_looked_up() {
        // ASTM C33 fine aggregate, the middle of its band.
        let points =
            [(0.15, 6.0), (0.3, 20.0), (0.6, 42.5), (1.18, 67.5), (2.36, 90.0), (4.75, 97.5), (9.5, 100.0)];
        let filter = Gradation::from_lines(&points).unwrap();
        let entry = LibraryFilter::find(&filter, LibraryDensity::Loose).unwrap().unwrap();
        assert!(entry.part.is_some() && entry.found.grains_error == GRAINS_ERROR_OF_PART);
    }
}
