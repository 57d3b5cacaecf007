//! The base of a case: as it is given, and as it is walked: regraded as filter practice does, where the scene
//! asks for that.

use super::error::CaseError;
use super::files::Files;
use super::filter::CaseFilter;
use crate::gradation::Gradation;
use crate::scene::{BaseGradation, D85, FilterGradation, Regrade, Scene};
use crate::verdict::Mistake;

/// A base, worked out.
#[derive(Clone, Debug)]
pub struct CaseBase {
    /// Its gradation, as it is walked.
    pub gradation: Gradation,
    /// The base as it was given, and the size (mm) that it was regraded on, where it is walked regraded.
    pub regraded_from: Option<(Gradation, f64)>,
}

impl CaseBase {
    /// The base that a scene states, beside this filter.
    ///
    /// # Errors
    /// A file that is refused; regrading is asked for where sizes are multiples of D0F.
    pub(super) fn read(scene: &Scene, filter: &CaseFilter, files: &mut Files) -> Result<Self, CaseError> {
        let given = given(scene, filter, files)?;
        if scene.base.regrade != Some(Regrade::Practice) {
            return Ok(Self { gradation: given, regraded_from: None });
        }
        let is_of_d0f = match scene.base.gradation() {
            BaseGradation::Sieve(..) | BaseGradation::Linear { d85: D85::Mm(_), .. } => false,
            _ => matches!(scene.filter.gradation(), FilterGradation::Linear { d0_mm, .. } if d0_mm == 1.0),
        };
        if is_of_d0f {
            let problem = "base.regrade = \"practice\" needs sizes in mm, but these are multiples of D0F: \
                           give base.sieve or base.d85_mm, or leave it out";
            return Err(scene.clash(problem).into());
        }
        let regraded = given.regraded();
        Ok(match regraded.at_mm {
            Some(at) => Self { gradation: regraded.gradation, regraded_from: Some((given, at)) },
            None => Self { gradation: given, regraded_from: None },
        })
    }

    /// Its gradation as it was given, before any regrading.
    pub fn as_given(&self) -> &Gradation {
        self.regraded_from.as_ref().map_or(&self.gradation, |(given, _)| given)
    }

    /// What is wrong with its table: a sieve table alone can be in another unit, or the filter's. Tables that
    /// a user named are looked at before ([`crate::scene::refuse_exchanged`]).
    pub(super) fn mistake(&self, scene: &Scene, filter: &CaseFilter) -> Option<Mistake> {
        match scene.base.gradation() {
            BaseGradation::Sieve(..) => Mistake::find(self.as_given(), &filter.gradation, false),
            _ => None,
        }
    }
}

fn given(scene: &Scene, filter: &CaseFilter, files: &mut Files) -> Result<Gradation, CaseError> {
    let (cu, d85_mm) = match &scene.base.gradation() {
        BaseGradation::Sieve(path, d0_mm) => {
            return files.sieve(path, *d0_mm, "base.sieve", "base-sieve.csv", &scene.name);
        }
        BaseGradation::Single(size) => return Ok(Gradation::single(*size)?),
        BaseGradation::Linear { cu, d85: D85::Mm(mm) } => (*cu, *mm),
        BaseGradation::Linear { cu, d85: D85::Ratio(ratio) } => {
            let d15f = filter.gradation.d(15.0);
            (*cu, d15f.ok_or_else(|| scene.clash("the filter's D15 is not known"))? / ratio)
        }
        BaseGradation::Linear { cu, d85: D85::AtDc(percent, other) } => {
            let other = match other {
                Some(source) => {
                    let (other, _) =
                        files.curve(source, "base.dc_curve", "base-dc-curve.csv", &scene.name)?;
                    Some(other.in_mm(filter.unit_mm)?)
                }
                None => None,
            };
            let curve = other.as_ref().unwrap_or(&filter.curve);
            (*cu, curve.dc(*percent).ok_or_else(|| scene.clash("base.d85_at_dc is not on the curve"))?)
        }
    };
    Ok(Gradation::linear_from_dx(85.0, d85_mm, cu)?)
}
