//! The base of a case, as given and as walked: regraded by filter practice, if the scene asks for it.

use super::error::CaseError;
use super::files::Files;
use super::filter::CaseFilter;
use crate::scene::{BaseGradation, D85, FilterGradation, Regrade, Scene, SceneError};
use voidwalk_core::gradation::Gradation;
use voidwalk_practice::{Mistake, MistakeKind};

/// A base, worked out.
#[derive(Clone, Debug)]
pub struct CaseBase {
    /// Its gradation, as it is walked.
    pub gradation: Gradation,
    /// The base as it was given, and the size (mm) on which it was regraded, if it is walked regraded.
    pub regraded_from: Option<(Gradation, f64)>,
}

impl CaseBase {
    /// The base that a scene states, beside this filter.
    ///
    /// # Errors
    /// A file that is refused; a request to regrade sizes that are multiples of D0F.
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

    /// The mistake that two soils look like and are not refused for. A sieve table is refused whose sizes
    /// must be in another unit; of a pair that is guarded also one that must be exchanged.
    ///
    /// # Errors
    /// The two are refused.
    pub(super) fn mistake(
        &self,
        scene: &Scene,
        filter: &Gradation,
        scale_free: bool,
    ) -> Result<Option<Mistake>, CaseError> {
        let mistake = Mistake::find(self.as_given(), filter, scale_free);
        match (mistake, &scene.base.sieve, &scene.filter.sieve) {
            (Some(mistake), Some(base), Some(filter)) if scene.is_guarded && mistake.is_refused() => {
                let file = format!("base {}, filter {}", base.display(), filter.display());
                Err(SceneError::Clash { file, problem: mistake.refusal() }.into())
            }
            (Some(mistake), Some(_), _) if mistake.kind == MistakeKind::Unit => {
                Err(scene.clash(mistake.sentence).into())
            }
            (mistake, ..) => Ok(mistake),
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

#[cfg(test)]
mod tests {
    use std::path::Path;

    use crate::case::Case;
    use crate::scene::{Scene, TableOptions};

    #[test]
    fn two_tables_that_are_exchanged_are_refused_unless_they_are_as_given() {
        let root = tempfile::tempdir().unwrap();
        let table = |name: &str, rows: &str| {
            let path = root.path().join(name);
            std::fs::write(&path, format!("size_mm,percent\n{rows}")).unwrap();
            path
        };
        let base = table("base.csv", "0.1,0\n0.3,100\n");
        let filter = table("filter.csv", "0.5,0\n2,100\n");
        let mistake = |base: &Path, filter: &Path, as_given| {
            let changes = vec!["base.n_base=1000".to_owned()];
            let options = TableOptions { as_given, changes, ..TableOptions::default() };
            let case = Case::new(Scene::of_tables(base, filter, &options).unwrap());
            case.map(|case| case.mistake.map(|note| note.id())).map_err(|error| error.to_string())
        };
        assert_eq!(mistake(&base, &filter, false), Ok(None));
        assert_eq!(mistake(&filter, &base, true), Ok(Some("files_exchanged".into())));
        let message = mistake(&filter, &base, false).unwrap_err();
        for words in ["filter.csv, filter ", "are the two files exchanged?", "exchange the two", "--as-given"]
        {
            assert!(message.contains(words), "{message}");
        }
    }
}
