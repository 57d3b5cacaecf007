//! Base of a case: as given, as walked (regraded by filter practice if the scene requests it), and its
//! particles in the walk.

use super::error::CaseError;
use super::files::Files;
use super::filter::CaseFilter;
use crate::scene::{Amount, BaseGradation, D85, FilterGradation, Regrade, Scene, SceneError};
use voidwalk_core::gradation::{BaseSupply, Gradation, GradationError, SizeSampler, base_particles};
use voidwalk_practice::{Mistake, MistakeKind, Refusal};

/// Base with its derived values.
#[derive(Clone, Debug)]
pub struct CaseBase {
    /// Gradation as walked.
    pub gradation: Gradation,
    /// Base as given, and the size (mm) on which it was regraded, if it is walked regraded.
    pub(crate) regraded_from: Option<(Gradation, f64)>,
}

impl CaseBase {
    /// Reads the base that a scene states, with this filter. Errors: a file is refused, or regrading is
    /// requested for sizes that are multiples of D0F.
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

    /// Gradation as given, before any regrading.
    pub(crate) fn as_given(&self) -> &Gradation {
        self.regraded_from.as_ref().map_or(&self.gradation, |(given, _)| given)
    }

    /// Mistake that two soils suggest without being refused for it. A sieve table is refused if its sizes
    /// must be in another unit; a guarded pair also if it must be exchanged.
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
                Err(SceneError::Clash { file, problem: Refusal(&mistake, "--as-given").to_string() }.into())
            }
            (Some(mistake), Some(_), _) if mistake.kind == MistakeKind::Unit => {
                Err(scene.clash(mistake.to_string()).into())
            }
            (mistake, ..) => Ok(mistake),
        }
    }
}

fn given(scene: &Scene, filter: &CaseFilter, files: &mut Files) -> Result<Gradation, CaseError> {
    let (cu, d85_mm) = match &scene.base.gradation() {
        BaseGradation::Sieve(path, d0_mm) => {
            return files.sieve(path, *d0_mm, "base.sieve", &scene.name);
        }
        BaseGradation::Single(size) => return Ok(Gradation::single(*size)?),
        BaseGradation::Linear { cu, d85: D85::Mm(mm) } => (*cu, *mm),
        BaseGradation::Linear { cu, d85: D85::Ratio(ratio) } => {
            let d15f = filter.gradation.d(15.0);
            (*cu, d15f.ok_or_else(|| scene.clash("the filter's D15 is not known"))? / ratio)
        }
        BaseGradation::Linear { cu, d85: D85::AtDc(percent, other) } => {
            let curve = match other {
                Some(source) => {
                    &files.curve(source, "base.dc_curve", &scene.name)?.0.in_mm(filter.unit_mm)?
                }
                None => &filter.curve,
            };
            (*cu, curve.dc(*percent).ok_or_else(|| scene.clash("base.d85_at_dc is not on the curve"))?)
        }
    };
    Ok(Gradation::linear_from_dx(85.0, d85_mm, cu)?)
}

/// Mass ratio of Eq. (2) if the scene gives a number of particles: the paper's 5 %.
pub(crate) const PAPER_MASS_RATIO: f64 = 0.05;

/// Particles of a base in the walk.
#[derive(Clone)]
pub struct CaseSupply {
    /// True if the base's pan fraction is walked as particles just finer than every constriction, false
    /// if it is counted by mass only.
    pub(crate) pan_is_walked: bool,
    /// Sampler of particle sizes, in units of the reference length.
    pub(crate) sampler: SizeSampler,
    /// Number of base particles in a run, by Eq. (2) or as given.
    pub n_base: u64,
    /// Number of base particles by Eq. (2); `None` if the grains per void are not given.
    pub n_base_eq2: Option<u64>,
    /// True if a cap made `n_base` smaller than by Eq. (2).
    pub(crate) capped: bool,
    /// Mass of base over mass of filter for `n_base` particles; `None` if the grains per void are not given.
    pub(crate) mass_ratio: Option<f64>,
}

impl CaseSupply {
    /// Particles of a base for this filter, on a network of `voids`: a pan fraction that may not be
    /// passive is walked as passive particles. A filter that `is_packed` can no longer be refused.
    pub(super) fn new(
        scene: &Scene,
        filter: &CaseFilter,
        voids: u64,
        base: &Gradation,
        is_packed: bool,
    ) -> Result<Self, CaseError> {
        let pan_is_walked = may_block(base, filter.finest_mm);
        let taken = match pan_is_walked {
            true => &as_passive(base, filter.finest_mm, scene)?,
            false => base,
        };
        // A number given by the user counts particles of known size; the mass stays the same. A cap
        // limits the work, to which passive particles add little.
        let more = taken.particles_per_unit_volume() / base.particles_per_unit_volume();
        let times = |n: u64| match n as f64 * more {
            _ if more == 1.0 => Ok(n),
            product if product < 9e18 => Ok((product.round() as u64).max(1)),
            _ => Err(scene.clash(
                "the base's pan fraction, as fine as the finest constriction, has more particles than can be \
                 counted: give base.d0_mm or a finer sieve",
            )),
        };
        let (gradation, grains) = (&filter.gradation, filter.grains_per_void);
        let by_eq2 = |ratio, grains, cap| base_particles(ratio, grains, voids, taken, gradation, cap);
        let (sampler, n_base, n_base_eq2, capped, mass_ratio) = match scene.base.amount() {
            Amount::Number(n) => {
                let n_base = times(n)?;
                let sampler = SizeSampler::new(taken, filter.unit_mm)?;
                let eq2 = grains.map(|grains| by_eq2(PAPER_MASS_RATIO, grains, None)).transpose()?;
                let per_grain = taken.particles_per_unit_volume() / gradation.particles_per_unit_volume();
                let mass_ratio = grains.map(|grains| n_base as f64 / (grains * voids as f64 * per_grain));
                (sampler, n_base, eq2.map(|supply| supply.n_base_eq2), false, mass_ratio)
            }
            Amount::MassRatio(ratio, cap) => {
                let cap = cap.map(times).transpose()?;
                let Some(grains) = grains else {
                    let problem =
                        "filter.grains_per_void is missing (Eq. 2): only the shipped curves know theirs";
                    return Err(scene.clash(problem).into());
                };
                let BaseSupply { mut n_base, n_base_eq2, capped } = by_eq2(ratio, grains, cap)?;
                if n_base == 0 && is_packed {
                    // The guessed grains per void gave barely one.
                    n_base = 1;
                }
                if n_base == 0 {
                    let problem = "Eq. (2) gives less than half a base particle: a larger network, mass \
                                   ratio or grains per void is needed";
                    return Err(scene.clash(problem).into());
                }
                let ratio = if capped { ratio * n_base as f64 / n_base_eq2 as f64 } else { ratio };
                let sampler = SizeSampler::new(taken, filter.unit_mm)?;
                (sampler, n_base, Some(n_base_eq2), capped, Some(ratio))
            }
        };
        Ok(Self { pan_is_walked, sampler, n_base, n_base_eq2, capped, mass_ratio })
    }
}

/// Factor by which passive particles are finer than the finest size that is stopped, and range of their
/// sizes: a passive particle is never stopped by a constriction, so its size has no other effect.
const FINER: f64 = 0.99;

/// True if a pan fraction may hold particles that are not passive, because the finest sieve is coarser than
/// the finest constriction. All of it is then walked as passive particles of the same mass, just finer than
/// every constriction and every size that arches in one: of all possible sizes these erode most.
fn may_block(base: &Gradation, finest_mm: f64) -> bool {
    base.pan_fraction() > 0.0 && base.smallest_mm() > finest_mm
}

/// Base with all of its pan fraction just finer than the finest size that a constriction stops.
pub(super) fn as_passive(
    base: &Gradation,
    finest_mm: f64,
    scene: &Scene,
) -> Result<Gradation, GradationError> {
    let mut points: Vec<_> = base.points().iter().map(|point| (point.size, point.percent)).collect();
    let passive = FINER * finest_mm / scene.law().map_or(1.0, |law| law.widest);
    points.splice(0..0, [(FINER * passive, 0.0), (passive, points[0].1)]);
    Gradation::from_points(&points, None)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::case::Case;
    use crate::scene::{Scene, TableOptions};
    use std::path::Path;
    use voidwalk_core::gradation::SizeSampler;

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

    #[test]
    fn a_passive_pan_fraction_keeps_its_mass_and_is_finer_than_every_constriction() {
        let base = Gradation::from_lines(&[(0.075, 35.0), (0.5, 80.0), (2.0, 100.0)]).unwrap();
        assert!(!may_block(&base, 0.075) && may_block(&base, 0.0749));
        let passive = as_passive(&base, 0.04, &Scene::built_in(&[]).unwrap()).unwrap();
        assert_eq!(passive.pan_fraction(), 0.0);
        for percent in [36.0, 80.0, 99.0] {
            assert_eq!(passive.d(percent), base.d(percent));
        }
        for size in [0.075, 0.0399] {
            assert!((passive.percent_finer_by_mass(size) - 35.0).abs() < 1e-12, "{size}");
        }
        assert!(SizeSampler::new(&passive, 1.0).unwrap().smallest() > 0.039);
    }
}
