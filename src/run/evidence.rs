//! What soils of the base's kind say of the walk's boundary, where a case is walked as those of the study
//! were.

use super::error::RunError;
use super::margin::margin;
use super::replicates::{ReplicateContext, ReplicateResult};
use crate::case::Case;
use crate::outcome::record::{Evidence, Margin};
use crate::outcome::rules::BaseSoil;
use crate::verdict::evidence::{LAYERS, MASS_RATIO};

/// The base of a case as practice describes it, where the case is walked as those of the study were: sizes
/// with a unit, the base regraded as practice does, constrictions of its own filter that are no guess, on the
/// usual lattice, with as much base, without arches and openings. Tests of dispersive soils and of joints had
/// other boundaries.
fn studied(case: &Case) -> Option<BaseSoil> {
    let scene = &case.scene;
    let has_tests = scene.base.dispersive != Some(true) && scene.filter.joint_mm.is_none();
    let is_lattice = scene.is_lattice_by_area() && case.counts[3] == LAYERS;
    let is_sieving = scene.law().is_none() && !scene.leaves_openings();
    let has_curve = case.library.is_some() || case.packed.is_some();
    let has_amount = case.mass_ratio.is_some_and(|ratio| (ratio / MASS_RATIO - 1.0).abs() < 0.01);
    if case.is_scale_free() || !has_tests || !is_lattice || !is_sieving || !has_curve || !has_amount {
        return None;
    }
    let soil = BaseSoil::of(case.base_as_given(), false);
    (soil.regraded_at_mm == case.regraded_from.as_ref().map(|(_, at)| *at)).then_some(soil)
}

/// Walks the margin of a case, of which this is the first replicate, where it is asked for; `None` too where
/// nothing could be said of it: the walk's boundary of soils of its kind is no measure of that of tests where
/// their ratio scatters.
///
/// # Errors
/// As [`super::replicates::replicates_and`].
pub fn walked(
    case: &Case,
    own: &ReplicateResult,
    context: &ReplicateContext,
) -> Result<Option<Margin>, RunError> {
    walks_margin(case).then(|| margin(case, own, context)).transpose()
}

/// Whether the margin of a case is walked.
pub fn walks_margin(case: &Case) -> bool {
    evidence(case, None).is_some_and(|evidence| evidence.narrow)
}

/// The evidence for a case, with its margin where that was walked; `None` where none was asked for.
pub fn evidence(case: &Case, margin: Option<&Margin>) -> Option<Evidence> {
    of_kind(case, margin).filter(|_| case.scene.record.margin == Some(true))
}

/// What soils of its kind say of a case, whether anybody asked for it or not.
pub fn of_kind(case: &Case, margin: Option<&Margin>) -> Option<Evidence> {
    Evidence::of(&studied(case)?, case.filter.d(15.0)?, case.filter.cu(), margin)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::Scene;

    fn is_studied(set: &[&str]) -> bool {
        let of_study = ["filter.library=loose", "filter.cu=1.5", "filter.d0_mm=1", "base.d85_mm=0.3"];
        let small = ["network.nx=6", "network.ny=6"];
        let all: Vec<String> = of_study.iter().chain(&small).chain(set).map(ToString::to_string).collect();
        studied(&Case::new(Scene::built_in(&all).unwrap()).unwrap()).is_some()
    }

    /// The study walked neither arches nor openings.
    #[test]
    fn evidence_is_of_sieving_alone() {
        assert!(is_studied(&[]) && is_studied(&["walk.blocked=closed", "walk.arching=none"]));
        assert!(!is_studied(&["walk.arching=zuriguel-2005"]));
        assert!(!is_studied(&["walk.blocked=open"]));
        assert!(!is_studied(&["network.nz=30"]));
    }
}
