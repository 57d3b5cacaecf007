//! Sizes between two sieves that are far apart, where the distribution of the mass is unknown.

use super::curve_point::TIE;
use super::{FINES_MM, GRAVEL_MM, Gradation};

/// Greatest ratio of two neighbouring sieves between which practice reads a straight line. The openings of
/// 12.5 and 4.75 mm (2.63) are neighbours among the sieves that ASTM D448 asks for of a No. 57 stone.
pub const USUAL_STEP: f64 = 2.65;

/// Ratio of two neighbouring sieves above which a rule has no result if its answer depends on the sizes
/// between them.
pub const WIDE_STEP: f64 = 4.0;

/// Mass (%) that remains spread over a step that is not wide when the rest of its mass is at one of its
/// sieves.
pub(super) const TRACE_PERCENT: f64 = 1e-6;

/// Relative distance from a sieve of mass that counts as being at it, and relative distance of mass beside a
/// size at which a rule counts fines or gravel.
const NEXT: f64 = 1e-12;
const BESIDE: f64 = 1e-6;

/// Parts of a wide step, equal in ln(size); the bounds between them are its single sizes.
const FILLINGS: i32 = 6;

/// Two neighbouring sieves with a ratio above [`USUAL_STEP`] and mass between them.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Step {
    /// The finer sieve (mm).
    pub from_mm: f64,
    /// The coarser sieve (mm).
    pub to_mm: f64,
    segment: usize,
}

impl Step {
    /// Tells if the ratio of the sieves is above [`WIDE_STEP`].
    pub fn is_wide(self) -> bool {
        self.to_mm > self.from_mm * WIDE_STEP * (1.0 + TIE)
    }

    /// Ratio of the two sieves.
    pub fn ratio(self) -> f64 {
        self.to_mm / self.from_mm
    }

    /// Tells if a size lies strictly between the two sieves.
    pub fn holds(self, size_mm: f64) -> bool {
        size_mm > self.from_mm * (1.0 + TIE) && size_mm < self.to_mm * (1.0 - TIE)
    }

    /// Tells if a size lies between the two sieves, or on one of them.
    pub fn encloses(self, size_mm: f64) -> bool {
        (self.from_mm * (1.0 - TIE)..=self.to_mm * (1.0 + TIE)).contains(&size_mm)
    }
}

impl Gradation {
    /// Finds the steps between sieves that are wider than practice interpolates over, the finest first. A
    /// stated straight line has none.
    ///
    /// ```
    /// use voidwalk_core::gradation::Gradation;
    /// let sparse = Gradation::from_points(&[(0.3, 12.0), (38.0, 100.0)], None)?;
    /// assert_eq!((sparse.open_steps()[0].from_mm, sparse.open_steps()[0].to_mm), (0.3, 38.0));
    /// assert!(Gradation::linear_from_d0(0.3, 10.0)?.open_steps().is_empty());
    /// # Ok::<(), voidwalk_core::gradation::GradationError>(())
    /// ```
    pub fn open_steps(&self) -> Vec<Step> {
        let step = |i: usize| Step { from_mm: self.size_mm[i], to_mm: self.size_mm[i + 1], segment: i };
        let is_open = |i: &usize| {
            self.percent[i + 1] > self.percent[*i]
                && self.size_mm[i + 1] > self.size_mm[*i] * USUAL_STEP * (1.0 + TIE)
        };
        (self.lines..self.log_ratio.len()).filter(is_open).map(step).collect()
    }

    /// Fills the curve's own steps with these points between their sieves: size (mm) and percent finer,
    /// rising.
    pub fn filled(&self, steps: &[(Step, Vec<(f64, f64)>)]) -> Gradation {
        let (mut size_mm, mut percent) = (self.size_mm.clone(), self.percent.clone());
        for (step, points) in steps.iter().rev() {
            let at = step.segment + 1;
            size_mm.splice(at..at, points.iter().map(|point| point.0));
            percent.splice(at..at, points.iter().map(|point| point.1));
        }
        Gradation::new(size_mm, percent)
    }

    /// Points that place the mass of a step at one of its sieves.
    pub fn mass_at(&self, step: &Step, end: End) -> Vec<(f64, f64)> {
        let [low, high] = self.percents(step);
        // The sieves of a step that is not wide keep their own percents: a trace of mass marks each.
        let trace = if step.is_wide() { 0.0 } else { TRACE_PERCENT.min((high - low) / 3.0) };
        match end {
            End::Fine => vec![(step.from_mm * (1.0 + NEXT), high - trace)],
            End::Coarse => vec![(step.to_mm * (1.0 - NEXT), low + trace)],
        }
    }

    /// Points that place the mass of a wide step inside it, in case neither of its ends is the worst: at
    /// single sizes, and in two parts with a gap between them.
    pub fn fillings(&self, step: &Step) -> Vec<Vec<(f64, f64)>> {
        let [low, high] = self.percents(step);
        let within =
            (1..FILLINGS).map(|i| step.from_mm * libm::pow(step.ratio(), f64::from(i) / f64::from(FILLINGS)));
        let beside = |size: f64| [size * (1.0 - 2.0 * BESIDE), size * (1.0 + BESIDE)];
        let sizes = [FINES_MM, GRAVEL_MM].into_iter().flat_map(beside).chain(within);
        // A gap covers a factor of four.
        let sizes = sizes.chain([step.from_mm * 3.9, step.to_mm / 3.9]);
        let at_once = sizes.filter(|size| step.holds(*size) && step.holds(size * (1.0 + BESIDE)));
        let at_once = at_once.map(|size| vec![(size, low), (size * (1.0 + NEXT), high)]);
        let parts = [0.1, 0.25, 0.5, 0.75].map(|part| low + part * (high - low));
        let parts = parts.into_iter().chain([10.0, 20.0, 30.0, 80.0]);
        let parts = parts.filter(|percent| low < *percent && *percent < high);
        let ends = [step.from_mm * (1.0 + NEXT), step.to_mm * (1.0 - NEXT)];
        at_once.chain(parts.map(|percent| ends.map(|end| (end, percent)).to_vec())).collect()
    }

    /// Percent finer than each of the two sieves of a step.
    fn percents(&self, step: &Step) -> [f64; 2] {
        [self.percent[step.segment], self.percent[step.segment + 1]]
    }

    /// D_x as the largest size (mm) that no more than `percent` of the mass is finer than; [`Gradation::d`]
    /// gives the smallest: they differ where the curve is flat at this percent.
    pub fn coarse_d(&self, percent: f64) -> Option<f64> {
        let above = self.percent.partition_point(|&p| p <= percent + 100.0 * TIE);
        match above.checked_sub(1).map(|i| (self.percent[i], self.size_mm[i])) {
            Some((p, d)) if (p - percent).abs() <= 100.0 * TIE => Some(d),
            _ => self.d(percent),
        }
    }
}

/// Place of a step's mass at one of its two sieves.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum End {
    /// At the finer sieve.
    Fine,
    /// At the coarser sieve.
    Coarse,
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_step_of_common_sieves_is_no_open_one() {
        let stone = [(2.36, 1.0), (4.75, 5.0), (12.5, 42.5), (25.0, 97.5), (37.5, 100.0)];
        assert!(Gradation::from_points(&stone, None).unwrap().open_steps().is_empty());
        let four = Gradation::from_points(&[(0.075, 0.0), (0.3, 50.0), (1.3, 100.0)], None).unwrap();
        assert_eq!(four.open_steps().iter().map(|step| step.is_wide()).collect::<Vec<_>>(), [false, true]);
        // No sieve is missing between the finest sieve and a size that the user states.
        let stated = Gradation::from_points(&[(0.3, 12.0), (0.6, 100.0)], Some(0.01)).unwrap();
        assert!(stated.open_steps().is_empty());
    }

    #[test]
    fn mass_stands_at_either_end_of_a_step() {
        let sparse = Gradation::from_points(&[(0.3, 12.0), (38.0, 60.0), (75.0, 100.0)], None).unwrap();
        let steps = sparse.open_steps();
        for (end, d15, finer) in [(End::Fine, 0.3, 60.0), (End::Coarse, 38.0, 12.0)] {
            let curve = sparse.filled(&[(steps[0], sparse.mass_at(&steps[0], end))]);
            assert!((curve.d(15.0).unwrap() / d15 - 1.0).abs() < 1e-11);
            assert!((curve.percent_finer_by_mass(5.0) - finer).abs() < 1e-5);
            assert_eq!(curve.percent_finer_by_mass(0.3), 12.0);
            assert_eq!(curve.d(80.0), sparse.d(80.0));
            assert_eq!(curve.d(12.0), Some(0.3));
            assert!((curve.coarse_d(60.0).unwrap() / 38.0 - 1.0).abs() < 1e-11);
        }
    }

    #[test]
    fn a_flat_curve_has_two_sizes_of_its_percent() {
        let flat = Gradation::from_points(&[(0.6, 0.0), (1.18, 15.0), (2.36, 15.0), (4.75, 100.0)], None);
        let flat = flat.unwrap();
        assert_eq!((flat.d(15.0), flat.coarse_d(15.0)), (Some(1.18), Some(2.36)));
        assert_eq!(flat.d(40.0), flat.coarse_d(40.0));
    }
}
