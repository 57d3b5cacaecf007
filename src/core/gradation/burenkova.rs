//! Burenkova's two conditional factors of uniformity, and their limits for internal stability.
//!
//! - Burenkova (1993): `h' = D90 / D60` and `h'' = D90 / D15`; a soil without cohesion, with grains of up to
//!   100 mm and a Cu of up to 200, keeps its fines where `0.76 lg h'' + 1 < h' < 1.86 lg h'' + 1`.
//! - Wan and Fell (2004, 2008): logistic regression of tests on broadly graded and gap-graded soils gives the
//!   probability that a soil loses its fines, `1 / (1 + exp(-Z))`: `Z = 3.875 lg h'' - 3.591 h' + 2.436` for
//!   sand and gravel with up to 10 % of fines that are not plastic, `Z = 2.378 lg h'' - 3.648 h' + 3.701` for
//!   silt, sand and gravel.
//!
//! Source: the technical manual of the U.S. Army Corps of Engineers' Internal Instability Toolbox (Risk
//! Management Center, RMC-CPD-2023-10, chapters "Burenkova Method" and "Modified Burenkova Method"). One
//! stored version of the manual prints D10 in the equation of h'' and D15 in its list of symbols; the
//! published page, its text and the chapter on Wan and Fell have D15.

use super::Gradation;

/// Burenkova's factors of a soil.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct UniformityFactors {
    /// `h' = D90 / D60`: steepness of the coarse part.
    pub coarse: f64,
    /// `h'' = D90 / D15`: distance of the fine part below it.
    pub whole: f64,
}

impl UniformityFactors {
    /// Bounds of `h'` between which Burenkova's soils kept their fines.
    pub fn stable(&self) -> [f64; 2] {
        let lg = libm::log10(self.whole);
        [0.76 * lg + 1.0, 1.86 * lg + 1.0]
    }

    /// Wan and Fell's probability (0 to 1) that the soil loses its fines: with the equation for sand and
    /// gravel with few fines, or the one for silt, sand and gravel.
    pub fn probability_of_instability(&self, few_fines: bool) -> f64 {
        let lg = libm::log10(self.whole);
        let z = match few_fines {
            true => 3.875 * lg - 3.591 * self.coarse + 2.436,
            false => 2.378 * lg - 3.648 * self.coarse + 3.701,
        };
        1.0 / (1.0 + libm::exp(-z))
    }
}

impl Gradation {
    /// Burenkova's factors; `None` if D15 lies in a pan fraction.
    ///
    /// ```
    /// use voidwalk_core::gradation::Gradation;
    /// let sand = Gradation::linear_from_d0(0.1, 4.0)?;
    /// let factors = sand.uniformity_factors().unwrap();
    /// let [low, high] = factors.stable();
    /// assert!(low < factors.coarse && factors.coarse < high);
    /// # Ok::<(), voidwalk_core::gradation::GradationError>(())
    /// ```
    pub fn uniformity_factors(&self) -> Option<UniformityFactors> {
        let [d15, d60, d90] = [self.d(15.0)?, self.d(60.0)?, self.d(90.0)?];
        Some(UniformityFactors { coarse: d90 / d60, whole: d90 / d15 })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// By hand for D15 0.1, D60 5, D90 10 mm: h' = 2, h'' = 100, lg h'' = 2; bounds 2.52 and 4.72; Z = 7.75 -
    /// 7.182 + 2.436 = 3.004 and 4.756 - 7.296 + 3.701 = 1.161.
    #[test]
    fn factors_bounds_and_probabilities_by_hand() {
        let points = [(0.05, 0.0), (0.1, 15.0), (5.0, 60.0), (10.0, 90.0), (20.0, 100.0)];
        let factors = Gradation::from_points(&points, None).unwrap().uniformity_factors().unwrap();
        assert!((factors.coarse - 2.0).abs() < 1e-12 && (factors.whole - 100.0).abs() < 1e-9);
        for (computed, by_hand) in [
            (factors.stable()[0], 2.52),
            (factors.stable()[1], 4.72),
            (factors.probability_of_instability(true), 1.0 / (1.0 + (-3.004f64).exp())),
            (factors.probability_of_instability(false), 1.0 / (1.0 + (-1.161f64).exp())),
        ] {
            assert!((computed - by_hand).abs() < 1e-9, "{computed} {by_hand}");
        }
    }

    /// A straight line on semi-log paper has h' = Cu^0.6 and h'' = Cu^1.5: such filters are stable at a usual
    /// Cu.
    #[test]
    fn straight_filters_keep_their_fines() {
        for cu in [1.5, 3.0, 6.0] {
            let factors = Gradation::linear_from_d0(1.0, cu).unwrap().uniformity_factors().unwrap();
            let [low, high] = factors.stable();
            assert!((factors.coarse - cu.powf(0.6)).abs() < 1e-9, "{factors:?}");
            assert!((factors.whole - cu.powf(1.5)).abs() < 1e-9, "{factors:?}");
            assert!(low < factors.coarse && factors.coarse < high, "{cu}");
        }
    }
}
