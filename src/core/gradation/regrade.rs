//! Regrading: the fraction of a base soil that filter practice considers, cut at a gap or at a sieve.

use super::Gradation;
use super::sieve::{FINES_MM, GRAVEL_MM, TIE, TRACE_PERCENT};
use serde::{Deserialize, Serialize};

/// Percent of fines below which a base has few fines.
pub const FEW_FINES: f64 = 15.0;

/// Minimum Cu of a broadly graded soil: the limit of well-graded sands in ASTM D2487.
pub const BROAD_CU: f64 = 6.0;

/// A base soil regraded by filter practice, or unchanged.
#[derive(Clone, Debug, PartialEq)]
pub struct Regraded {
    /// Soil after regrading, or the unchanged soil.
    pub gradation: Gradation,
    /// Size at which it was regraded (mm); `None` if it was not.
    pub at_mm: Option<f64>,
    /// Reason for regrading, or for not regrading.
    pub why: RegradeReason,
    /// Size below which practice considers the soil, if the sizes there are unknown: `gradation` is then
    /// the whole soil, coarser than the fraction that practice considers.
    pub hidden_below_mm: Option<f64>,
}

/// Reason why practice regrades a base, or leaves it as it is.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schemas", derive(schemars::JsonSchema))]
pub struct RegradeReason {
    /// Property of the soil that decides.
    pub cause: RegradeCause,
    /// True if it should be regraded but is not, because none of its known sizes passes the sieve.
    pub nothing_passes: bool,
}

/// Property of a soil that decides if it is regraded.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schemas", derive(schemars::JsonSchema))]
#[serde(tag = "id", content = "from_mm", rename_all = "snake_case")]
pub enum RegradeCause {
    /// It has a gap that begins at this size (mm).
    Gap(f64),
    /// It has a gap that begins at this size (mm), and the finer fraction would be regraded for its gravel.
    GapAmongGravel(f64),
    /// It has gravel and many fines.
    GravelAndFines,
    /// It has gravel and is broadly graded.
    BroadGravel,
    /// It has gravel, and Cu is not known.
    GravelOfUnknownCu,
    /// It has gravel, few fines, and is not broadly graded.
    NarrowGravel,
    /// It has no gravel.
    NoGravel,
    /// Its sizes have no unit.
    NoUnit,
}

impl Gradation {
    /// Regrades this soil as a base by filter practice; sizes in mm.
    ///
    /// The rules are from the U.S. Army Corps of Engineers' Filter Evaluation manual (chapter Base
    /// Gradation), after Sherard and Dunnigan (1989): a gap-graded soil at its gap; a soil with grains
    /// coarser than No. 4 (4.75 mm) to 100 % passing No. 4, unless it has less than 15 % fines and is
    /// not broadly graded. If the fraction finer than a gap has such grains, and the fines or the
    /// gradation that make the rule apply, it is regraded on No. 4 too: the manual stops at the gap,
    /// which gives a coarser limit. Every percent is divided by the percent passing.
    ///
    /// ```
    /// use voidwalk_core::gradation::Gradation;
    /// let till = Gradation::from_points(&[(0.075, 35.0), (4.75, 92.0), (19.0, 100.0)], None)?;
    /// let regraded = till.regraded();
    /// assert_eq!((regraded.at_mm, regraded.gradation.largest_mm()), (Some(4.75), 4.75));
    /// # Ok::<(), voidwalk_core::gradation::GradationError>(())
    /// ```
    pub fn regraded(&self) -> Regraded {
        self.regraded_as(self)
    }

    /// Regrades this soil at the size that another curve determines.
    pub fn regraded_as(&self, other: &Self) -> Regraded {
        self.regraded_on(other.regrading(other.gap(FINES_MM)))
    }

    /// Regrades this soil with the opposite reading of the other curve's flattest part: as a gap if
    /// [`Gradation::regraded_as`] does not read it as one, and as no gap if it does; `None` if that part
    /// is steep or exactly level.
    pub fn regraded_otherwise(&self, other: &Self) -> Option<Regraded> {
        let flat = other.flattest(FINES_MM)?;
        let is_open = (100.0 * TIE..FLAT_PERCENT - 100.0 * TIE).contains(&flat.within);
        let is_gap = flat.within < GAP_PERCENT;
        is_open.then(|| self.regraded_on(other.regrading(Some(flat).filter(|_| !is_gap))))
    }

    fn regraded_on(&self, (at, cause): (Option<f64>, RegradeCause)) -> Regraded {
        let why = RegradeReason { cause, nothing_passes: false };
        match at.map(|at| self.passing(at)) {
            None => Regraded { gradation: self.clone(), at_mm: None, why, hidden_below_mm: None },
            Some(Some(gradation)) => Regraded { gradation, at_mm: at, why, hidden_below_mm: None },
            Some(None) => {
                let why = RegradeReason { nothing_passes: true, ..why };
                let hidden_below_mm = at.filter(|at| self.percent_finer_by_mass(*at) > 0.0);
                Regraded { gradation: self.clone(), at_mm: None, why, hidden_below_mm }
            }
        }
    }

    /// Size at which practice regrades this base, and the reason.
    fn regrading(&self, gap: Option<Gap>) -> (Option<f64>, RegradeCause) {
        let Some(Gap { from_mm, .. }) = gap else { return self.regrading_for_gravel() };
        let finer = self.passing(from_mm).filter(|_| from_mm > GRAVEL_MM);
        let no_4 = finer.and_then(|finer| finer.regrading_for_gravel().0);
        match no_4.filter(|no_4| self.passing(*no_4).is_some()) {
            Some(no_4) => (Some(no_4), RegradeCause::GapAmongGravel(from_mm)),
            None => (Some(from_mm), RegradeCause::Gap(from_mm)),
        }
    }

    /// Size and reason for a soil without a gap.
    fn regrading_for_gravel(&self) -> (Option<f64>, RegradeCause) {
        if self.largest_mm() <= GRAVEL_MM {
            return (None, RegradeCause::NoGravel);
        }
        // If the finest sieve is coarser, this is an upper bound of the fines.
        let many_fines = self.percent_finer_by_mass(FINES_MM) >= FEW_FINES;
        let cause = match self.is_broad() {
            _ if many_fines => RegradeCause::GravelAndFines,
            Some(false) => return (None, RegradeCause::NarrowGravel),
            Some(true) => RegradeCause::BroadGravel,
            None => RegradeCause::GravelOfUnknownCu,
        };
        (Some(GRAVEL_MM), cause)
    }

    /// Tells if a soil is broadly graded: Cu of at least 6, the limit of well-graded sands in ASTM
    /// D2487, or 4, the limit of gravels; `None` if D10 is not known. The manual also requires Cc of 1
    /// to 3 and leaves the decision to the engineer; a soil of that Cu whose Cc is outside has more of
    /// one size and is no narrower.
    fn is_broad(&self) -> Option<bool> {
        let coarse = 100.0 - self.percent_finer_by_mass(FINES_MM);
        let gravel = 100.0 - self.percent_finer_by_mass(GRAVEL_MM);
        let least_cu = if gravel > coarse / 2.0 { 4.0 } else { 6.0 };
        Some(self.cu()? >= least_cu)
    }
}

/// Percent of the mass between D and 4 D below which sizes are missing.
pub const GAP_PERCENT: f64 = 5.0;

/// Percent of the mass between D and 4 D below which a curve may be gap-graded.
pub(crate) const FLAT_PERCENT: f64 = 2.0 * GAP_PERCENT;

/// Minimum and maximum percent finer at which a gap is searched for.
const GAP_RANGE: [f64; 2] = [10.0, 80.0];

/// Maximum difference of percents that count as equal, however a step of the curve is read.
const SAME_PERCENT: f64 = 10.0 * TRACE_PERCENT;

/// Sizes missing from a soil.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Gap {
    /// Its fine end (mm); its coarse end is at least four times as large.
    pub from_mm: f64,
    /// Percent finer than its fine end.
    pub(crate) percent: f64,
    /// Percent of the mass between its fine end and four times that size.
    pub within: f64,
}

impl Gradation {
    /// Coefficient of curvature, `D_30^2 / (D_10 D_60)`; `None` if D_10 lies in a pan fraction.
    pub fn cc(&self) -> Option<f64> {
        let [d10, d30, d60] = [self.d(10.0)?, self.d(30.0)?, self.d(60.0)?];
        Some(d30 * d30 / (d10 * d60))
    }

    /// Finds the widest gap of the curve from `least_mm` on: less than 5 % of the mass between D and 4
    /// D, with 10 to 80 % finer than D.
    ///
    /// Manuals leave gaps to the eye; these numbers are our own. A straight line on semi-log paper has
    /// less than 5 % in a factor of 4 only if its Cu is above one million.
    pub fn gap(&self, least_mm: f64) -> Option<Gap> {
        self.flattest(least_mm).filter(|gap| gap.within < GAP_PERCENT)
    }

    /// Finds the flattest part of the curve from `least_mm` on: the D with the minimum mass between D
    /// and 4 D, with 10 to 80 % finer than D. `None` if there is no such D.
    pub fn flattest(&self, least_mm: f64) -> Option<Gap> {
        let at = |d: f64| {
            let percent = self.percent_finer_by_mass(d);
            Gap { from_mm: d, percent, within: self.percent_finer_by_mass(4.0 * d) - percent }
        };
        let range = self.smallest_mm().max(least_mm)..=self.largest_mm();
        let [low, high] = [GAP_RANGE[0] - SAME_PERCENT, GAP_RANGE[1] + SAME_PERCENT];
        // On a straight stretch every D has the same mass between D and 4 D: the finest is taken.
        let [first, last] = GAP_RANGE.map(|percent| self.d(percent));
        let ends = [first, last, Some(least_mm)].into_iter().flatten();
        let candidates = self.size_mm.iter().flat_map(|&d| [d, d / 4.0]).chain(ends);
        let flat = candidates.filter(|d| range.contains(d)).map(at);
        let flat: Vec<Gap> = flat.filter(|gap| (low..=high).contains(&gap.percent)).collect();
        let least = flat.iter().map(|gap| gap.within).fold(f64::INFINITY, f64::min);
        let ties = flat.into_iter().filter(|gap| gap.within <= least + SAME_PERCENT);
        ties.min_by(|a, b| a.from_mm.total_cmp(&b.from_mm))
    }

    /// Fraction of this soil that passes a sieve, as a separate soil: every percent is divided by the
    /// percent passing.
    ///
    /// `None` if nothing of known size passes.
    pub fn passing(&self, opening_mm: f64) -> Option<Gradation> {
        if opening_mm >= self.largest_mm() {
            return Some(self.clone());
        }
        let passing = self.percent_finer_by_mass(opening_mm);
        if opening_mm <= self.smallest_mm() || passing <= 0.0 {
            return None;
        }
        // Up to the first size at which all of the passing mass is finer.
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

    fn regraded(rows: &[(f64, f64)]) -> Regraded {
        points(rows).regraded()
    }

    /// The till of the first trial: 92 % finer than 4.75 mm.
    #[test]
    fn a_till_is_regraded_on_no_4_by_hand() {
        let till = regraded(&[(0.075, 35.0), (0.425, 60.0), (2.0, 82.0), (4.75, 92.0), (19.0, 100.0)]);
        assert_eq!(till.at_mm, Some(4.75));
        assert!((till.gradation.percent_finer_by_mass(0.075) - 35.0 / 0.92).abs() < 1e-9);
        // 85 % of 92 % is 78.2 % of the whole: between 0.425 mm (60 %) and 2 mm (82 %).
        let d85 = 0.425 * (2.0f64 / 0.425).powf(18.2 / 22.0);
        assert!((till.gradation.d(85.0).unwrap() - d85).abs() < 1e-9);
    }

    #[test]
    fn each_question_of_the_manual_has_its_answer() {
        // Nothing coarser than No. 4.
        assert_eq!(regraded(&[(0.1, 0.0), (0.5, 60.0), (4.75, 100.0)]).at_mm, None);
        // Coarser, less than 15 % fines, Cu 3.2: unchanged.
        let gravel = regraded(&[(2.0, 0.0), (9.5, 60.0), (19.0, 100.0)]);
        assert!(gravel.at_mm.is_none() && gravel.why.cause == RegradeCause::NarrowGravel);
        // Coarser and broadly graded: Cu 15.0, Cc 1.01.
        let broad = regraded(&[(0.1, 0.0), (0.5, 20.0), (2.0, 45.0), (4.75, 70.0), (19.0, 100.0)]);
        assert!(broad.at_mm.is_some() && broad.why.cause == RegradeCause::BroadGravel, "{:?}", broad.why);
        // A similar sand with more gravel: Cu 20.9, but Cc 0.70.
        let skewed = regraded(&[(0.1, 0.0), (0.42, 20.0), (2.0, 45.0), (4.75, 62.0), (19.0, 100.0)]);
        assert!(skewed.at_mm.is_some() && skewed.why.cause == RegradeCause::BroadGravel, "{:?}", skewed.why);
        // Coarser, and D10 in a pan fraction: conservative.
        let tail = regraded(&[(0.3, 12.0), (1.0, 40.0), (4.75, 80.0), (9.5, 100.0)]);
        assert!(tail.at_mm.is_some() && tail.why.cause == RegradeCause::GravelOfUnknownCu);
        // A gap: the finer fraction.
        let gap = regraded(&[(0.1, 0.0), (0.5, 40.0), (5.0, 40.0), (20.0, 100.0)]);
        assert_eq!((gap.at_mm, gap.gradation.largest_mm()), (Some(0.5), 0.5));
    }

    /// A gap from 12.5 to 50 mm: 65 % is finer, a third of it gravel. With fines its limit is set by the
    /// fraction that passes No. 4; a narrow gravel below a gap is left whole.
    #[test]
    fn a_gap_among_gravel_regrades_on_no_4_too() {
        let till =
            regraded(&[(0.075, 20.0), (0.5, 35.0), (4.75, 43.0), (12.5, 65.0), (50.0, 66.0), (75.0, 100.0)]);
        assert_eq!((till.at_mm, till.why.cause), (Some(4.75), RegradeCause::GapAmongGravel(12.5)));
        assert!((till.gradation.percent_finer_by_mass(0.075) - 100.0 * 20.0 / 43.0).abs() < 1e-9);
        let gravel = regraded(&[(4.0, 0.0), (12.5, 65.0), (50.0, 66.0), (75.0, 100.0)]);
        assert_eq!((gravel.at_mm, gravel.why.cause), (Some(12.5), RegradeCause::Gap(12.5)));
        // Broad, but nothing passes No. 4.
        let coarse = regraded(&[(5.0, 0.0), (10.0, 5.0), (40.0, 70.0), (160.0, 71.0), (200.0, 100.0)]);
        assert_eq!(coarse.at_mm, Some(40.0));
    }

    #[test]
    fn gravel_alone_has_nothing_to_regrade() {
        let soil = regraded(&[(5.0, 0.0), (10.0, 10.0), (25.0, 30.0), (60.0, 60.0), (80.0, 100.0)]);
        assert!(soil.at_mm.is_none() && soil.why.nothing_passes, "{:?}", soil.why);
    }

    #[test]
    fn the_part_that_passes_a_sieve_by_hand() {
        let soil = points(&[(0.1, 0.0), (1.0, 30.0), (4.0, 60.0), (16.0, 100.0)]);
        // On the log scale 2 mm is halfway from 1 to 4 mm: 45 %.
        let passing = soil.passing(2.0).unwrap();
        for (d, percent) in [(0.1, 0.0), (1.0, 30.0 / 0.45), (2.0, 100.0)] {
            assert!((passing.percent_finer_by_mass(d) - percent).abs() < 1e-9, "{d}");
        }
        assert_eq!(soil.passing(16.0), Some(soil.clone()));
        assert_eq!(soil.passing(0.1), None);
        // A sieve in a gap cuts at the end of the finer fraction.
        let gap = points(&[(0.1, 0.0), (0.2, 40.0), (5.0, 40.0), (20.0, 100.0)]);
        assert_eq!(gap.passing(1.0).unwrap(), points(&[(0.1, 0.0), (0.2, 100.0)]));
        // A pan fraction alone has no size.
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
