//! Shape of a sieve curve in practice, besides its sizes: curvature, a gap, the part that passes a sieve.

use super::Gradation;
use super::between::TRACE_PERCENT;

/// Percent of the mass between D and 4 D below which sizes are missing.
pub const GAP_PERCENT: f64 = 5.0;

/// Percent of the mass between D and 4 D below which a curve may be gap-graded.
pub(crate) const FLAT_PERCENT: f64 = 2.0 * GAP_PERCENT;

/// Least and greatest percent finer at which a gap is searched for.
const GAP_RANGE: [f64; 2] = [10.0, 80.0];

/// Difference below which percents count as equal, however a step of the curve is read.
const SAME_PERCENT: f64 = 10.0 * TRACE_PERCENT;

/// Sizes missing from a soil.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Gap {
    /// Its fine end (mm); its coarse end is four times as large, or more.
    pub from_mm: f64,
    /// Percent finer than its fine end.
    pub percent: f64,
    /// Percent of the mass between its fine end and four times that.
    pub within: f64,
}

impl Gradation {
    /// Coefficient of curvature, `D_30^2 / (D_10 D_60)`; `None` if D_10 lies in a pan fraction.
    pub fn cc(&self) -> Option<f64> {
        let [d10, d30, d60] = [self.d(10.0)?, self.d(30.0)?, self.d(60.0)?];
        Some(d30 * d30 / (d10 * d60))
    }

    /// Finds the widest gap of the curve from `least_mm` on: less than 5 % of the mass between D and 4 D,
    /// with 10 to 80 % finer than D.
    ///
    /// Manuals leave gaps to the eye; these numbers are ours. A straight line on semi-log paper has less than
    /// 5 % in a factor of 4 only if its Cu is above a million.
    pub fn gap(&self, least_mm: f64) -> Option<Gap> {
        self.flattest(least_mm).filter(|gap| gap.within < GAP_PERCENT)
    }

    /// Finds the flattest part of the curve from `least_mm` on: the D with the least mass between D and 4 D,
    /// with 10 to 80 % finer than D. `None` if there is no such D.
    pub fn flattest(&self, least_mm: f64) -> Option<Gap> {
        let at = |d: f64| {
            let percent = self.percent_finer_by_mass(d);
            Gap { from_mm: d, percent, within: self.percent_finer_by_mass(4.0 * d) - percent }
        };
        let range = self.smallest_mm().max(least_mm)..=self.largest_mm();
        let [low, high] = [GAP_RANGE[0] - SAME_PERCENT, GAP_RANGE[1] + SAME_PERCENT];
        // On a straight stretch every D has as much between itself and 4 D: the finest counts.
        let [first, last] = GAP_RANGE.map(|percent| self.d(percent));
        let ends = [first, last, Some(least_mm)].into_iter().flatten();
        let candidates = self.size_mm.iter().flat_map(|&d| [d, d / 4.0]).chain(ends);
        let flat = candidates.filter(|d| range.contains(d)).map(at);
        let flat: Vec<Gap> = flat.filter(|gap| (low..=high).contains(&gap.percent)).collect();
        let least = flat.iter().map(|gap| gap.within).fold(f64::INFINITY, f64::min);
        let ties = flat.into_iter().filter(|gap| gap.within <= least + SAME_PERCENT);
        ties.min_by(|a, b| a.from_mm.total_cmp(&b.from_mm))
    }

    /// Part of this soil that passes a sieve, as a soil of its own: every percent is divided by the percent
    /// passing.
    ///
    /// `None` if nothing of known size passes.
    ///
    /// ```
    /// use voidwalk_core::gradation::Gradation;
    /// let soil = Gradation::from_points(&[(0.075, 10.0), (4.75, 50.0), (19.0, 100.0)], None)?;
    /// let finer = soil.passing(4.75).unwrap();
    /// assert_eq!((finer.percent_finer_by_mass(0.075), finer.largest_mm()), (20.0, 4.75));
    /// # Ok::<(), voidwalk_core::gradation::GradationError>(())
    /// ```
    pub fn passing(&self, opening_mm: f64) -> Option<Gradation> {
        if opening_mm >= self.largest_mm() {
            return Some(self.clone());
        }
        let passing = self.percent_finer_by_mass(opening_mm);
        if opening_mm <= self.smallest_mm() || passing <= 0.0 {
            return None;
        }
        // Up to the first size at which all passing mass is finer.
        let below = self.percent.partition_point(|&p| p < passing);
        let (mut size_mm, mut percent): (Vec<f64>, Vec<f64>) =
            (0..below).map(|i| (self.size_mm[i], self.percent[i] / passing * 100.0)).unzip();
        size_mm.push(self.size_mm[below].min(opening_mm));
        percent.push(100.0);
        (size_mm.len() > 1).then(|| Gradation::sieved(size_mm, percent, self.lines))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn points(points: &[(f64, f64)]) -> Gradation {
        Gradation::from_points(points, None).unwrap()
    }

    #[test]
    fn the_part_that_passes_a_sieve_by_hand() {
        let soil = points(&[(0.1, 0.0), (1.0, 30.0), (4.0, 60.0), (16.0, 100.0)]);
        // 2 mm is half of the way from 1 to 4 mm: 45 %.
        let passing = soil.passing(2.0).unwrap();
        for (d, percent) in [(0.1, 0.0), (1.0, 30.0 / 0.45), (2.0, 100.0)] {
            assert!((passing.percent_finer_by_mass(d) - percent).abs() < 1e-9, "{d}");
        }
        assert_eq!(soil.passing(16.0), Some(soil.clone()));
        assert_eq!(soil.passing(0.1), None);
        // A sieve in a gap cuts where the finer part ends.
        let gap = points(&[(0.1, 0.0), (0.2, 40.0), (5.0, 40.0), (20.0, 100.0)]);
        assert_eq!(gap.passing(1.0).unwrap(), points(&[(0.1, 0.0), (0.2, 100.0)]));
        // A tail alone has no size.
        assert_eq!(points(&[(0.1, 40.0), (5.0, 40.0), (20.0, 100.0)]).passing(1.0), None);
        assert_eq!(Gradation::single(9.5).unwrap().passing(4.75), None);
    }

    #[test]
    fn a_gap_is_found_and_a_broad_curve_has_none() {
        let gap = points(&[(0.1, 0.0), (0.5, 40.0), (5.0, 40.0), (20.0, 100.0)]);
        assert_eq!(gap.gap(0.0), Some(Gap { from_mm: 0.5, percent: 40.0, within: 0.0 }));
        assert_eq!(gap.gap(0.6), Some(Gap { from_mm: 0.6, percent: 40.0, within: 0.0 }));
        for cu in [1.5, 27.0, 1000.0] {
            assert_eq!(Gradation::linear_from_d0(0.1, cu).unwrap().gap(0.0), None, "{cu}");
        }
        assert_eq!(Gradation::single(1.0).unwrap().gap(0.0), None);
        // 12 % of the mass over a factor of 8.33: the flattest factor of 4 begins at 0.6 mm.
        let flat = points(&[(0.1, 0.0), (0.6, 59.0), (5.0, 71.0), (20.0, 100.0)]);
        let within = 12.0 * libm::log(4.0) / libm::log(5.0 / 0.6);
        let flattest = flat.flattest(0.0).unwrap();
        assert!(flat.gap(0.0).is_none() && (flattest.within - within).abs() < 1e-9, "{flattest:?}");
    }

    #[test]
    fn curvature_of_a_straight_line_is_that_of_its_cu() {
        // D_x = D_0 Cu^(x / 50): D_30^2 / (D_10 D_60) = Cu^(60/50 - 70/50).
        let line = Gradation::linear_from_d0(0.1, 32.0).unwrap();
        assert!((line.cc().unwrap() - 0.5).abs() < 1e-12);
    }
}
