//! A recipe worked out: its files read, its number of grains decided, before any work is done.

use super::cut;
use super::error::CaseError;
use super::files::Files;
use super::packing_plan::PackingPlan;
use crate::scene::{FilterGradation, PackingSpec, Scene, SceneError};
use voidwalk_core::gradation::Gradation;

/// Default width of a cell over the largest grain, if the user gives no number of grains ...
const CELLS_WIDTH: f64 = 5.4;
/// ... within these numbers of grains: fewer scatter, more cost a wide gradation hours.
const GRAINS: (usize, usize) = (9_000, 60_000);
/// Grains for the finer part of a filter that cannot be packed whole, at most.
pub(super) const GRAINS_OF_PART: usize = 30_000;
/// Least width of a cell over the largest grain: two, and a margin for the error of a guess.
pub(super) const LEAST_WIDTH: f64 = 2.2;
/// Packing fraction by which the width of a cell is guessed.
const FRACTION: f64 = 0.65;

impl PackingPlan {
    /// Plan of the packing for a scene, if its filter is to be packed and was not measured before.
    ///
    /// # Errors
    /// See [`PackingPlan::new`].
    pub fn of(scene: &Scene) -> Result<Option<Self>, CaseError> {
        let spec = scene.packing_spec()?.filter(|_| scene.filter.measured.is_none());
        spec.as_ref().map(Self::new).transpose()
    }

    /// Reads the specification's files and works out its number of grains.
    ///
    /// # Errors
    /// A file that is refused, a gradation that cannot be packed, a cell narrower than two of the largest
    /// grain.
    pub fn new(recipe: &PackingSpec) -> Result<Self, CaseError> {
        let mut files = Files::default();
        let (gradation, linear) = match &recipe.gradation {
            FilterGradation::Linear { d0_mm, cu } => {
                (Gradation::linear_from_d0(*d0_mm, cu.unwrap_or(1.0))?, true)
            }
            FilterGradation::Sieve(path, d0_mm) => {
                (files.sieve(path, *d0_mm, "filter.sieve", "filter-sieve.csv", &recipe.file)?, false)
            }
        };
        let name = match &recipe.gradation {
            FilterGradation::Linear { cu, .. } => format!("linear, Cu {}", cu.unwrap_or(1.0)),
            FilterGradation::Sieve(path, _) => path.display().to_string(),
        };
        let mut plan = Self {
            name,
            linear,
            part: None,
            aspect: recipe.aspect,
            compression: recipe.compression.clone(),
            merge_overlap: recipe.merge_overlap,
            inputs: files.inputs,
            gradation,
        };
        plan.take_part(recipe)?;
        Ok(plan)
    }

    /// Takes the part that is asked for, or the part that can be packed if the cell of the whole would be too
    /// narrow; and decides on the number of grains.
    fn take_part(&mut self, recipe: &PackingSpec) -> Result<(), CaseError> {
        let (whole, grains) = (self.gradation.clone(), recipe.grains);
        let aspect = self.aspect;
        let width = |gradation: &Gradation, grains| width_by_largest(gradation, grains, aspect);
        let part = match recipe.coarsest {
            Some(percent) if percent < 100.0 => Some(cut::finer_part(&whole, percent).ok_or_else(|| {
                let problem = format!(
                    "packing.coarsest = {percent}: no grains of known size are finer than that percentage"
                );
                SceneError::Clash { file: recipe.file.clone(), problem }
            })?),
            None if width(&whole, grains.unwrap_or_else(|| self.tall(grains_for(&whole)))) < LEAST_WIDTH => {
                let most = grains.unwrap_or(self.tall(GRAINS_OF_PART));
                cut::that_can_be_packed(&whole, |part| width(part, most))
            }
            _ => None,
        };
        let mut usual = grains_for(&whole);
        if let Some((gradation, packed)) = part {
            self.name = format!("{}, its finer {:.1} %", self.name, packed.percent);
            let most = if recipe.coarsest.is_some() { GRAINS.1 } else { GRAINS_OF_PART };
            usual = grains_for(&gradation).min(most);
            (self.gradation, self.part, self.linear) = (gradation, Some(packed), false);
        }
        self.compression.grains = grains.unwrap_or(self.tall(usual));
        let width = width(&self.gradation, self.compression.grains);
        if width >= LEAST_WIDTH {
            return Ok(());
        }
        let grains = self.tall(grains_at_least(&self.gradation));
        let problem = format!(
            "packing.grains = {}: the cell would be about {width:.1} times as wide as the largest grain, at \
             least {LEAST_WIDTH} times is needed; about {grains} grains would do",
            self.compression.grains
        );
        self.compression.grains = grains;
        Err(CaseError::NarrowCell { file: recipe.file.clone(), problem, would_do: Box::new(self.clone()) })
    }

    /// Number of grains of a cell of this one's height, as wide as a cube of this many grains.
    fn tall(&self, grains: usize) -> usize {
        (grains as f64 * self.aspect).round() as usize
    }

    /// Default number of grains of a gradation: enough for a cell 5.4 times as wide as the largest, 9,000 to
    /// 60,000.
    pub fn usual_grains(gradation: &Gradation) -> usize {
        grains_for(gradation)
    }

    /// Width of a tall cell as a multiple of the largest grain, about, and the usual multiple, if it is
    /// narrower than usual because of a given number of grains or the most that the program takes.
    pub fn narrow_and_tall(&self) -> Option<(f64, f64)> {
        let width = width_by_largest(&self.gradation, self.compression.grains, self.aspect);
        (self.aspect > 1.0 && width < 0.99 * CELLS_WIDTH).then_some((width, CELLS_WIDTH))
    }
}

/// Grains that make the cell wide enough.
fn grains_for(gradation: &Gradation) -> usize {
    let wanted = (CELLS_WIDTH / width_by_largest(gradation, 1, 1.0)).powi(3);
    (wanted as usize).clamp(GRAINS.0, GRAINS.1)
}

/// Grains with which the cell is wide enough, and a little more.
fn grains_at_least(gradation: &Gradation) -> usize {
    libm::ceil(((LEAST_WIDTH + 0.1) / width_by_largest(gradation, 1, 1.0)).powi(3)) as usize
}

/// Width of the cell of this many grains, by the largest grain; the cell is `aspect` times as tall.
pub(super) fn width_by_largest(gradation: &Gradation, grains: usize, aspect: f64) -> f64 {
    let largest = gradation.largest_mm();
    let grain_mm3 = 1.0 / gradation.particles_per_unit_volume();
    libm::cbrt(grains as f64 * grain_mm3 / FRACTION / aspect) / largest
}
