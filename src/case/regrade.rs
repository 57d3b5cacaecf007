//! The base as it is walked: regraded as filter practice does, where the scene asks for that.

use super::{Case, CaseError};
use crate::gradation::{GRAVEL_MM, Gradation};
use crate::scene::{BaseGradation, D85, FilterGradation, Regrade, Scene};
use crate::verdict::{Finding, finding};

/// Cu from which a base counts as broadly graded: that of well-graded sands by ASTM D2487.
const BROAD_CU: f64 = 6.0;

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

impl Case {
    /// The base as it was given, before any regrading.
    pub fn base_as_given(&self) -> &Gradation {
        self.regraded_from.as_ref().map_or(&self.base, |(given, _)| given)
    }

    /// A base that is broadly graded and walked as it is.
    pub(super) fn broad_base(&self) -> Option<Finding> {
        if self.regraded_from.is_some() || self.is_scale_free() {
            return None;
        }
        let regraded = self.base.regraded();
        match (regraded.at_mm, self.base.cu().filter(|cu| *cu >= BROAD_CU)) {
            (Some(at), _) => Some(finding::not_regraded(at, &regraded.why)),
            (None, cu) => cu.map(finding::broadly_graded),
        }
    }

    /// A base that is walked regraded, or that was to be.
    pub(super) fn regrading(&self) -> Option<Finding> {
        match (&self.regraded_from, self.scene.base.regrade) {
            (Some((given, at)), _) => Some(finding::regraded(given.percent_finer_by_mass(*at), *at)),
            // Of a base without gravel nobody expects it.
            (None, Some(Regrade::Practice)) if self.base.largest_mm() > GRAVEL_MM => {
                Some(finding::regrading_not_needed(&self.base.regraded().why))
            }
            _ => None,
        }
    }
}
