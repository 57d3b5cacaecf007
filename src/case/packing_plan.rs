//! A recipe worked out: its files read, its number of grains decided, before any work is done.

use super::{CaseError, Files, Input, cut};
use crate::gradation::Gradation;
use crate::outcome::packing::PackedPart;
use crate::packing::{self, Settings as Compression};
use crate::scene::{FilterGradation, PackingSpec, Scene, SceneError};

/// A cell is made this many times as wide as the largest grain, where the user does not say how many grains
/// ...
const CELLS_WIDTH: f64 = 5.4;
/// ... within these numbers of grains: fewer scatter, more cost a wide gradation hours.
const GRAINS: (usize, usize) = (9_000, 60_000);
/// Grains for the finer part of a filter that cannot be packed whole, at most.
const GRAINS_OF_PART: usize = 30_000;
/// A cell is at least this many times as wide as the largest grain: twice, and some for what a guess is off.
const LEAST_WIDTH: f64 = 2.2;
/// Packing fraction by which the width of a cell is guessed.
const FRACTION: f64 = 0.65;

/// Two gradations have one shape where their sizes, scaled, are as near as this ...
const SAME_SIZE: f64 = 1e-3;
/// ... and their percentages as near as this.
const SAME_PERCENT: f64 = 1e-2;

/// Part of the definition of a packing: another number gives other grains from the same recipe.
const PROTOCOL: u32 = 2;
/// The same of gradations so wide that their most crowded grains are moved as heavier ones.
const WIDE_PROTOCOL: u32 = 3;

/// What is to be packed.
#[derive(Clone, Debug)]
pub struct PackingPlan {
    /// The gradation that is packed: the filter's, or its finer part's.
    pub gradation: Gradation,
    /// The gradation in words.
    pub name: String,
    /// Whether it is linear.
    pub linear: bool,
    /// What part of the filter it is, where the whole is not packed.
    pub part: Option<PackedPart>,
    /// Height of the cell by its width.
    pub aspect: f64,
    /// How it is compressed.
    pub compression: Compression,
    /// Overlap of two inscribed spheres from which their tetrahedra are one void.
    pub merge_overlap: f64,
    /// Files that were read.
    pub inputs: Vec<Input>,
}

impl PackingPlan {
    /// What is to be packed for a scene, where its filter is to be packed and was not measured before.
    ///
    /// # Errors
    /// As [`PackingPlan::new`].
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
                (files.sieve(path, *d0_mm, "filter.sieve", "filter-sieve.csv")?, false)
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
            inputs: files.0,
            gradation,
        };
        plan.take_part(recipe)?;
        Ok(plan)
    }

    /// Takes the part that is asked for, or, where the cell of the whole would be too narrow, the part that
    /// can be packed; and decides on the number of grains.
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

    /// Grains of a cell as wide as a cube of so many, as tall as this one.
    fn tall(&self, grains: usize) -> usize {
        (grains as f64 * self.aspect).round() as usize
    }

    /// Grains that are packed of a gradation where nobody says how many: enough for a cell 5.4 times as wide
    /// as the largest, 9,000 to 60,000.
    pub fn usual_grains(gradation: &Gradation) -> usize {
        grains_for(gradation)
    }

    /// Fingerprint of everything that the grains follow from.
    pub fn fingerprint(&self) -> String {
        self.fingerprint_of(&self.gradation.points())
    }

    /// The same of a gradation with these points, compressed likewise.
    pub(super) fn fingerprint_of(&self, points: &[(f64, f64)]) -> String {
        let protocol = if packing::is_wide(&self.gradation) { WIDE_PROTOCOL } else { PROTOCOL };
        let mut text = format!("{protocol} {points:?} {:?}", self.compression);
        if self.aspect != 1.0 {
            text += &format!(" {:?} times as tall", self.aspect);
        }
        format!("{:016x}", xxhash_rust::xxh3::xxh3_64(text.as_bytes()))
    }

    /// The factor that takes a gradation with these points to the plan's: `None` where one factor does not
    /// take every size to within a thousandth of its own.
    pub(super) fn scale_from(&self, points: &[(f64, f64)]) -> Option<f64> {
        let own = self.gradation.points();
        let (coarsest, its) = (own.last()?, points.last()?);
        let factor = coarsest.0 / its.0;
        let fits = |(own, other): (&(f64, f64), &(f64, f64))| {
            (factor * other.0 / own.0 - 1.0).abs() < SAME_SIZE && (other.1 - own.1).abs() < SAME_PERCENT
        };
        (own.len() == points.len() && own.iter().zip(points).all(fits)).then_some(factor)
    }

    /// Whether one packing, scaled, does for both plans.
    pub fn has_shape_of(&self, other: &Self) -> bool {
        let points = other.gradation.points();
        self.scale_from(&points).is_some() && self.fingerprint_of(&points) == other.fingerprint()
    }

    /// How many times as wide as the largest grain a tall cell is about, and how many times is usual, where
    /// it is narrower than that, by a number of grains that was given or by the most that the program takes.
    pub fn narrow_and_tall(&self) -> Option<(f64, f64)> {
        let width = width_by_largest(&self.gradation, self.compression.grains, self.aspect);
        (self.aspect > 1.0 && width < 0.99 * CELLS_WIDTH).then_some((width, CELLS_WIDTH))
    }

    /// Name of the folder in which the packing is kept among others.
    pub fn folder_name(&self) -> String {
        let cu = self.gradation.cu().map_or("graded".to_string(), |cu| format!("cu{:.3}", cu));
        let cu = cu.trim_end_matches('0').trim_end_matches('.');
        format!("{cu}-friction{}-{}", self.compression.friction, &self.fingerprint()[..8])
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
fn width_by_largest(gradation: &Gradation, grains: usize, aspect: f64) -> f64 {
    let largest = gradation.largest_mm();
    let grain_mm3 = 1.0 / gradation.particles_per_unit_volume();
    libm::cbrt(grains as f64 * grain_mm3 / FRACTION / aspect) / largest
}

#[cfg(test)]
mod tests {
    use super::*;

    fn plan(cu: f64, grains: usize) -> PackingPlan {
        let text = format!(
            "[filter]\ncu = {cu}\ndensity = \"loose\"\n[base]\ncu = 1.5\nd15f_over_d85b = 4\n\
             [packing]\ngrains = {grains}\ncoarsest = 100\n"
        );
        PackingPlan::of(&Scene::parse(text.as_bytes(), "s.toml", &[]).unwrap()).unwrap().unwrap()
    }

    #[test]
    fn the_fingerprint_names_the_protocol() {
        let of = |cu: f64, grains: usize| {
            let plan = plan(cu, grains);
            let points = plan.gradation.points();
            let text = |protocol: u32| format!("{protocol} {points:?} {:?}", plan.compression);
            let [earlier, wide] = [2, 3]
                .map(|protocol| format!("{:016x}", xxhash_rust::xxh3::xxh3_64(text(protocol).as_bytes())));
            (plan.fingerprint() == earlier, plan.fingerprint() == wide)
        };
        assert_eq!(of(3.0, 20_000), (true, false));
        assert_eq!(of(4.4, 20_000), (true, false));
        // 4.5^2 is 20.25, whether or not so few grains reach it.
        assert_eq!(of(4.5, 20_000), (false, true));
        assert_eq!(of(6.0, 60_000), (false, true));
    }
}
