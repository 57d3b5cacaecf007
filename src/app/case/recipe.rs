//! Packing plan of a scene before any work is done: reads its files, and chooses the part of the filter
//! and the number of grains.
//!
//! A cell must be wider than two of its largest grains, so a broad gradation requires millions of grains,
//! most of them of the finest sizes. Only its finer part is packed in this case: the constrictions are
//! those between the finer grains, for which coarser grains are walls. The effect of omitting the coarser
//! grains was measured on filters that can be packed whole (`results/packing.md`): all constrictions
//! become finer, from Dc5 to Dc90 by at most 0.6 times the omitted fraction of the grains' surface.

use super::error::CaseError;
use super::files::Files;
use super::packed_filter::PackingPlan;
use crate::outcome::packing::{FLOATING_PERCENT, PackedPart};
use crate::scene::{FilterGradation, PackingSpec, Scene, SceneError};
use voidwalk_core::gradation::Gradation;

/// Default width of a cell over the largest grain, if no number of grains is given ...
const CELLS_WIDTH: f64 = 5.4;
/// ... within these numbers of grains: fewer scatter, and more take hours for a wide gradation.
const GRAINS: (usize, usize) = (9_000, 60_000);
/// Maximum number of grains for the finer part of a filter that cannot be packed whole.
pub(super) const GRAINS_OF_PART: usize = 30_000;
/// Minimum width of a cell over the largest grain: two, with a margin for the error of the estimate.
pub(super) const LEAST_WIDTH: f64 = 2.2;
/// Packing fraction used to estimate the width of a cell.
const FRACTION: f64 = 0.65;

impl PackingPlan {
    /// Plan of the packing for a scene, if its filter is to be packed and was not measured before.
    pub(crate) fn of(scene: &Scene) -> Result<Option<Self>, CaseError> {
        let spec = scene.packing_spec()?.filter(|_| scene.filter.measured.is_none());
        spec.as_ref().map(Self::new).transpose()
    }

    /// Reads the specification's files and determines its number of grains. Errors: a file is refused, the
    /// gradation cannot be packed, or the cell is narrower than two of the largest grain.
    pub(crate) fn new(recipe: &PackingSpec) -> Result<Self, CaseError> {
        let mut files = Files::default();
        let (gradation, linear, name) = match &recipe.gradation {
            FilterGradation::Linear { d0_mm, cu } => {
                let cu = cu.unwrap_or(1.0);
                (Gradation::linear_from_d0(*d0_mm, cu)?, true, format!("linear, Cu {cu}"))
            }
            FilterGradation::Sieve(path, d0_mm) => {
                let gradation = files.sieve(path, *d0_mm, "filter.sieve", &recipe.file)?;
                (gradation, false, path.display().to_string())
            }
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

    /// Takes the requested part, or the part that can be packed if the cell of the whole would be too
    /// narrow, and sets the number of grains.
    fn take_part(&mut self, recipe: &PackingSpec) -> Result<(), CaseError> {
        let (whole, grains) = (self.gradation.clone(), recipe.grains);
        let (aspect, mut usual) = (self.aspect, Self::usual_grains(&self.gradation));
        let width = |gradation: &Gradation, grains| width_by_largest(gradation, grains, aspect);
        let part = match recipe.coarsest {
            Some(percent) if percent < 100.0 => Some(finer_part(&whole, percent).ok_or_else(|| {
                let problem = format!(
                    "packing.coarsest = {percent}: no grains of known size are finer than that percentage"
                );
                SceneError::Clash { file: recipe.file.clone(), problem }
            })?),
            None if width(&whole, grains.unwrap_or_else(|| self.tall(usual))) < LEAST_WIDTH => {
                let most = grains.unwrap_or(self.tall(GRAINS_OF_PART));
                that_can_be_packed(&whole, |part| width(part, most))
            }
            _ => None,
        };
        if let Some((gradation, packed)) = part {
            self.name = format!("{}, its finer {:.1} %", self.name, packed.percent);
            let most = if recipe.coarsest.is_some() { GRAINS.1 } else { GRAINS_OF_PART };
            usual = Self::usual_grains(&gradation).min(most);
            (self.gradation, self.part, self.linear) = (gradation, Some(packed), false);
        }
        self.compression.grains = grains.unwrap_or(self.tall(usual));
        let width = width(&self.gradation, self.compression.grains);
        if width >= LEAST_WIDTH {
            return Ok(());
        }
        // Slightly more grains than make the cell wide enough.
        let of_cube = ((LEAST_WIDTH + 0.1) / width_by_largest(&self.gradation, 1, 1.0)).powi(3);
        let grains = self.tall(libm::ceil(of_cube) as usize);
        let problem = format!(
            "packing.grains = {}: the cell would be about {width:.1} times as wide as the largest grain, at \
             least {LEAST_WIDTH} times is needed; about {grains} grains would do",
            self.compression.grains
        );
        self.compression.grains = grains;
        Err(CaseError::NarrowCell { file: recipe.file.clone(), problem, would_do: Box::new(self.clone()) })
    }

    /// Number of grains of a cell of this height that is as wide as a cube of this many grains.
    fn tall(&self, grains: usize) -> usize {
        (grains as f64 * self.aspect).round() as usize
    }

    /// Default number of grains for a gradation: enough for a cell 5.4 times as wide as the largest
    /// grain, 9,000 to 60,000.
    pub fn usual_grains(gradation: &Gradation) -> usize {
        let wanted = (CELLS_WIDTH / width_by_largest(gradation, 1, 1.0)).powi(3);
        (wanted as usize).clamp(GRAINS.0, GRAINS.1)
    }

    /// Approximate width of a tall cell over its largest grain, and the usual ratio, if the cell is
    /// narrower than usual because of a given number of grains or the program's maximum.
    pub(crate) fn narrow_and_tall(&self) -> Option<(f64, f64)> {
        let width = width_by_largest(&self.gradation, self.compression.grains, self.aspect);
        (self.aspect > 1.0 && width < 0.99 * CELLS_WIDTH).then_some((width, CELLS_WIDTH))
    }
}

/// Width of the cell of this many grains over the largest grain; the cell is `aspect` times as tall.
pub(super) fn width_by_largest(gradation: &Gradation, grains: usize, aspect: f64) -> f64 {
    let largest = gradation.largest_mm();
    let grain_mm3 = 1.0 / gradation.particles_per_unit_volume();
    libm::cbrt(grains as f64 * grain_mm3 / FRACTION / aspect) / largest
}

/// Width of a cell over the largest grain that is packed, if the program chooses it.
const WIDTH_OF_PART: f64 = 2.5;
/// Relative error of the constrictions, which are finer than in the whole, over the omitted surface fraction.
const ERROR_BY_SURFACE: f64 = 0.6;
/// Maximum error of the constrictions of a part that the program chooses.
const LARGEST_ERROR: f64 = 0.05;

/// Finer part of a filter as a separate gradation, with its description.
fn finer_part(whole: &Gradation, percent: f64) -> Option<(Gradation, PackedPart)> {
    let largest_mm = whole.d(percent)?;
    let part = whole.passing(largest_mm)?;
    let surface_left_out = whole.surface_coarser_than(part.largest_mm());
    let packed = PackedPart {
        percent,
        largest_mm: part.largest_mm(),
        surface_left_out,
        finer_by: ERROR_BY_SURFACE * surface_left_out,
        sizes_missing_above: whole.percent_finer_by_mass(1.5 * part.largest_mm()) <= percent + 0.5,
    };
    Some((part, packed))
}

/// Largest finer part for which this many grains give a wide enough cell; `None` if so much is omitted
/// that the result is in doubt.
pub(super) fn that_can_be_packed(
    whole: &Gradation,
    width: impl Fn(&Gradation) -> f64,
) -> Option<(Gradation, PackedPart)> {
    let (mut fits, mut too_wide) = (whole.pan_fraction() * 100.0, 100.0);
    for _ in 0..40 {
        let percent = 0.5 * (fits + too_wide);
        match finer_part(whole, percent) {
            Some((part, _)) if width(&part) < WIDTH_OF_PART => too_wide = percent,
            _ => fits = percent,
        }
    }
    // Rounds the percent down to a tenth.
    let percent = libm::floor(10.0 * fits + 1e-6) / 10.0;
    finer_part(whole, percent)
        .filter(|(_, packed)| packed.finer_by <= LARGEST_ERROR && packed.percent >= FLOATING_PERCENT)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::verdict::walks::packed_part;
    use voidwalk_practice::Note;

    /// ASTM C33 fine aggregate, the middle of its band.
    fn c33() -> Gradation {
        let table = [(0.15, 6.0), (0.3, 20.0), (0.6, 42.5), (1.18, 67.5), (2.36, 90.0), (4.75, 97.5)];
        Gradation::from_lines(&[&table[..], &[(9.5, 100.0)]].concat()).unwrap()
    }

    #[test]
    fn a_part_says_what_it_leaves_out() {
        let (part, packed) = finer_part(&c33(), 90.0).unwrap();
        assert!((part.largest_mm() - 2.36).abs() < 1e-9 && packed.percent == 90.0);
        assert!((part.percent_finer_by_mass(1.18) - 75.0).abs() < 1e-9);
        // By hand: percent / ln(b/a) (1/a - 1/b) for each row.
        assert!((packed.surface_left_out - 0.015855).abs() < 1e-6, "{packed:?}");
        assert!((packed.finer_by - 0.6 * packed.surface_left_out).abs() < 1e-15);
        assert!(!packed.sizes_missing_above);
        let Note::PartPacked { part_percent, largest_mm, .. } = packed_part(&packed) else {
            panic!("{packed:?}")
        };
        assert!((part_percent - 90.0).abs() < 0.05 && (largest_mm - 2.36).abs() < 0.005, "{packed:?}");
        // The whole filter omits nothing.
        let (all, packed) = finer_part(&c33(), 100.0).unwrap();
        assert_eq!((all, packed.surface_left_out), (c33(), 0.0));
    }

    #[test]
    fn what_is_chosen_makes_a_wide_cell_and_no_more() {
        // A cell of 8 mm for any part.
        let width = |part: &Gradation| 8.0 / part.largest_mm();
        let (part, packed) = that_can_be_packed(&c33(), width).unwrap();
        assert!((width(&part) - WIDTH_OF_PART).abs() < 0.02, "{packed:?}");
        // In a gap the part ends with the sizes below it.
        let gap_at = |percent| {
            let table = [(0.2, 0.0), (0.5, percent), (5.0, percent), (10.0, 100.0)];
            Gradation::from_lines(&table).unwrap()
        };
        let gap = gap_at(40.0);
        let (part, packed) = that_can_be_packed(&gap, width).unwrap();
        assert!(part.largest_mm() <= 0.5 && packed.percent > 39.8, "{packed:?}");
        assert!(packed.sizes_missing_above);
        assert!(matches!(packed_part(&packed), Note::FloatingPartPacked { .. }));
        // Too few grains for a representative part, and fines in which the coarse grains do not float.
        assert_eq!(that_can_be_packed(&c33(), |part| 1.0 / part.largest_mm()), None);
        assert_eq!(that_can_be_packed(&gap_at(20.0), width), None);
    }
}
