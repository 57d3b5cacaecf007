//! The base as it is walked: regraded as filter practice does, where the scene asks for that.

use super::error::CaseError;
use crate::gradation::Gradation;
use crate::scene::{BaseGradation, D85, FilterGradation, Regrade, Scene};

/// The base to walk; and as it was given, with the size (mm) that it was regraded on.
pub(super) type Walked = (Gradation, Option<(Gradation, f64)>);

/// The base of a scene as it is to be walked.
///
/// # Errors
/// Regrading is asked for where sizes are multiples of D0F.
pub(super) fn walked(scene: &Scene, base: Gradation) -> Result<Walked, CaseError> {
    if scene.base.regrade != Some(Regrade::Practice) {
        return Ok((base, None));
    }
    let of_unit = matches!(scene.filter.gradation(), FilterGradation::Linear { d0_mm, .. } if d0_mm == 1.0)
        && !matches!(
            scene.base.gradation(),
            BaseGradation::Sieve(..) | BaseGradation::Linear { d85: D85::Mm(_), .. }
        );
    if of_unit {
        let problem = "base.regrade = \"practice\" needs sizes in mm, but these are multiples of D0F: give \
                       base.sieve or base.d85_mm, or leave it out";
        return Err(scene.clash(problem).into());
    }
    let regraded = base.regraded();
    Ok(match regraded.at_mm {
        Some(at) => (regraded.gradation, Some((base, at))),
        None => (base, None),
    })
}
