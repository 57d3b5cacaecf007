//! A recipe worked out: its files read, its number of grains decided, before any work is done.

use super::{CaseError, Files, Input};
use crate::gradation::Gradation;
use crate::packing::Settings as Compression;
use crate::scene::{FilterGradation, PackingSpec, Scene, SceneError};

/// A cell is made this many times as wide as the largest grain, where the user does not say how many grains
/// ...
const CELLS_WIDTH: f64 = 5.4;
/// ... within these numbers of grains: fewer scatter, more cost a wide gradation hours.
const GRAINS: (usize, usize) = (9_000, 60_000);
/// Packing fraction by which the width of a cell is guessed.
const FRACTION: f64 = 0.65;

/// Part of the definition of a packing: another number gives other grains from the same recipe.
const PROTOCOL: u32 = 2;

/// What is to be packed.
#[derive(Clone, Debug)]
pub struct PackingPlan {
    /// The filter's gradation.
    pub gradation: Gradation,
    /// The gradation in words.
    pub name: String,
    /// Whether it is linear.
    pub linear: bool,
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
        let mut compression = recipe.compression.clone();
        compression.grains = recipe.grains.unwrap_or_else(|| grains_for(&gradation));
        let width = width_by_largest(&gradation, compression.grains);
        if width < 2.2 {
            let problem = format!(
                "packing.grains = {}: the cell would be about {width:.1} times as wide as the largest \
                 grain, at least 2.2 times is needed; about {} grains would do",
                compression.grains,
                (compression.grains as f64 * (2.3 / width).powi(3)).ceil()
            );
            return Err(SceneError::Clash { file: recipe.file.clone(), problem }.into());
        }
        Ok(Self {
            gradation,
            name,
            linear,
            compression,
            merge_overlap: recipe.merge_overlap,
            inputs: files.0,
        })
    }

    /// Fingerprint of everything that the grains follow from.
    pub fn fingerprint(&self) -> String {
        let text = format!("{PROTOCOL} {:?} {:?}", self.gradation.points(), self.compression);
        format!("{:016x}", xxhash_rust::xxh3::xxh3_64(text.as_bytes()))
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
    let wanted = (CELLS_WIDTH / width_by_largest(gradation, 1)).powi(3);
    (wanted as usize).clamp(GRAINS.0, GRAINS.1)
}

/// Width of the cell of this many grains, by the largest grain.
fn width_by_largest(gradation: &Gradation, grains: usize) -> f64 {
    let largest = gradation.largest_mm();
    let grain_mm3 = 1.0 / gradation.particles_per_unit_volume();
    libm::cbrt(grains as f64 * grain_mm3 / FRACTION) / largest
}
