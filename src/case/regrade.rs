//! The base as it is walked: regraded as filter practice does, where the scene asks for that.

use super::{Case, CaseError};
use crate::gradation::{GRAVEL_MM, Gradation};
use crate::scene::{BaseGradation, D85, FilterGradation, Regrade, Scene};

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

    /// Which way the model errs on a base that is broadly graded and walked as it is.
    pub(super) fn errs_unsafe(&self) -> Option<String> {
        if self.regraded_from.is_some() || self.is_scale_free() {
            return None;
        }
        let regraded = self.base.regraded();
        let why = match (regraded.at_mm, self.base.cu().filter(|cu| *cu >= BROAD_CU)) {
            (Some(at), _) => format!(
                "practice regrades it on {at:.3} mm ({}), and it is walked as it is, so that a few coarse \
                 grains block for all the rest. base.regrade = \"practice\" walks the part that practice \
                 looks at",
                regraded.why
            ),
            (None, Some(cu)) => {
                format!("it is broadly graded (Cu {cu:.1}), and a few coarse grains block for all the rest")
            }
            (None, None) => return None,
        };
        Some(format!("the model errs on the unsafe side for this base; {why}"))
    }

    /// What is said of a base that is walked regraded, or that was to be.
    pub(super) fn regrading(&self) -> Option<String> {
        match (&self.regraded_from, self.scene.base.regrade) {
            (Some((given, at)), _) => Some(format!(
                "the base is walked as practice regrades it: the {:.1} % of it that are finer than {at:.3} \
                 mm",
                given.percent_finer_by_mass(*at)
            )),
            // Of a base without gravel nobody expects it.
            (None, Some(Regrade::Practice)) if self.base.largest_mm() > GRAVEL_MM => {
                Some(format!("practice does not regrade this base: {}", self.base.regraded().why))
            }
            _ => None,
        }
    }
}
