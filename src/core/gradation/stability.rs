//! Tests if a soil retains its own fines, from the shape of its sieve curve.
//!
//! - Kenney and Lau (1985, 1986): F is the mass finer than D, H the mass between D and 4 D. If H is less
//!   than F, the coarse fraction does not retain the fine one. Only the part of a curve that can be loose
//!   counts: F up to 20 % if Cu > 3, up to 30 % otherwise. The limit of 1986 is H / F = 1 (1985: 1.3).
//! - Kezdi (1979): the curve is split in two; Terzaghi's ratio of the coarser fraction over the finer,
//!   D'15 / d'85, must not exceed 4. Whatever the split, 15 % of the whole mass lie between the two
//!   sizes: in the terms of Kenney and Lau, H must be at least 15 %. Splits near the ends are
//!   meaningless: below F = 15 % the limit of Kenney and Lau is the better one (Li and Fannin), and the
//!   grains of a small coarser fraction float in the finer one and do not filter it. Only splits with
//!   d'85 at F = 15 % to 55 % are judged; the second limit is ours.
//! - Li and Fannin (2008): both together. H / F must be at least 1 for F up to 15 %, and H at least 15 %
//!   from there to the F of Kenney and Lau; so the minimum of H / min(F, 15 %) must be at least 1.
//!
//! Definitions and limits are from the technical manual of the U.S. Army Corps of Engineers' Internal
//! Instability Toolbox (Risk Management Center, RMC-CPD-2023-10, "Modified Kenney and Lau method"),
//! which follows Li and Fannin (2008).
//!
//! Both indices have their extremes at points of the curve, or where the other end of their window is at
//! one, so they are found exactly. A pan fraction is left out: its effect is not known.

use super::Gradation;
use super::sieve::TIE;

/// Maximum Cu of a narrowly graded soil.
const NARROW_CU: f64 = 3.0;

/// Percent finer below which grains of a widely graded soil may be loose.
pub const WIDE_LOOSE_PERCENT: f64 = 20.0;

/// Percent finer than d'85 over which Kezdi's ratio is judged.
pub const KEZDI_RANGE: [f64; 2] = [15.0, 55.0];

/// Percent of the mass between d'85 and D'15; also the F from which Kezdi's limit is the better one.
const BETWEEN: f64 = 15.0;

/// An extreme of a shape index.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ShapeIndex {
    /// Its value.
    pub value: f64,
    /// Percent finer at the extreme: F of Kenney and Lau.
    pub percent: f64,
    /// Maximum percent finer, in the examined range, at which the index is below 1: this percentage of
    /// the soil may be lost. `None` if the index is nowhere below 1.
    pub lost_percent: Option<f64>,
}

/// A split of a soil in two, with Terzaghi's ratio of the coarser fraction over the finer.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SoilSplit {
    /// D'15 / d'85.
    pub value: f64,
    /// Percent of the soil that is finer than the split.
    pub percent: f64,
    /// D'15 (mm): 15 % of the coarser fraction alone is finer.
    pub coarse_d15_mm: f64,
    /// d'85 (mm): 85 % of the finer fraction alone is finer.
    pub fine_d85_mm: f64,
}

impl Gradation {
    /// Maximum percent finer examined by Kenney and Lau: 20 if Cu > 3, 30 otherwise; `None` without Cu.
    pub fn loose_percent(&self) -> Option<f64> {
        Some(if self.cu()? > NARROW_CU { WIDE_LOOSE_PERCENT } else { 30.0 })
    }

    /// Index of Kenney and Lau: the minimum of H / F over F up to [`Gradation::loose_percent`].
    ///
    /// `None` for a single size, or if D_10 lies in a pan fraction or the pan fraction reaches beyond F.
    ///
    /// ```
    /// use voidwalk_core::gradation::Gradation;
    /// // 20 % of fines, then a gap of a factor 10: nothing between D and 4 D at F = 20 %.
    /// let gap = Gradation::from_points(&[(0.1, 0.0), (0.2, 20.0), (2.0, 20.0), (20.0, 100.0)], None)?;
    /// assert_eq!(gap.kenney_lau().unwrap().value, 0.0);
    /// # Ok::<(), voidwalk_core::gradation::GradationError>(())
    /// ```
    pub fn kenney_lau(&self) -> Option<ShapeIndex> {
        self.least_of_next(self.loose_percent()?, |finer| finer)
    }

    /// Index of Kenney and Lau over the part of the curve shown by sieves: if D10 lies in a pan fraction
    /// but Cu is certainly above 3, from there up to F = 20 %. An index below 1 is a failure, whatever
    /// the pan contains.
    pub fn known_kenney_lau(&self) -> Option<ShapeIndex> {
        let is_wide = self.d(60.0)? > NARROW_CU * self.smallest_mm();
        let limit = self.loose_percent().or(is_wide.then_some(WIDE_LOOSE_PERCENT))?;
        self.least_of_next(limit, |finer| finer)
    }

    /// Index of Li and Fannin: the minimum of H / min(F, 15 %) over F up to [`Gradation::loose_percent`].
    ///
    /// `None` as for [`Gradation::kenney_lau`].
    ///
    /// ```
    /// use voidwalk_core::gradation::Gradation;
    /// // At F = 20 % only 17 % lie between D and 4 D: less than F, but more than 15 %.
    /// let broad = Gradation::linear_from_d0(0.1, 60.0)?;
    /// assert!(broad.kenney_lau().unwrap().value < 1.0 && broad.li_fannin().unwrap().value > 1.0);
    /// # Ok::<(), voidwalk_core::gradation::GradationError>(())
    /// ```
    pub fn li_fannin(&self) -> Option<ShapeIndex> {
        self.least_of_next(self.loose_percent()?, |finer| finer.min(BETWEEN))
    }

    /// Minimum of H / `over(F)` for F up to `limit` (%).
    fn least_of_next(&self, limit: f64, over: impl Fn(f64) -> f64) -> Option<ShapeIndex> {
        let last = self.coarse_d(limit)?;
        let between = self.coarse_d(BETWEEN);
        let candidates = self.size_mm.iter().flat_map(|&d| [d, d / 4.0]).chain([last]).chain(between);
        let index = |d: f64| {
            let finer = self.percent_finer_by_mass(d);
            let next = self.percent_finer_by_mass(4.0 * d) - finer;
            let divisor = over(finer);
            (finer > 0.0 && finer <= limit * (1.0 + 1e-9)).then_some((next / divisor, finer))
        };
        let sizes: Vec<f64> = candidates.filter(|d| (self.smallest_mm()..=last).contains(d)).collect();
        let indices: Vec<(f64, f64)> = sizes.iter().filter_map(|&d| index(d)).collect();
        let least = indices.iter().map(|(value, _)| *value).reduce(f64::min)?;
        let ties = indices.into_iter().filter(|(value, _)| *value <= least + TIE);
        let (value, percent) = ties.max_by(|a, b| a.1.total_cmp(&b.1))?;
        let is_lost = |d: f64| index(d).is_some_and(|(value, _)| value < 1.0 - TIE);
        let lost_percent = greatest(&sizes, is_lost).map(|d| self.percent_finer_by_mass(d));
        Some(ShapeIndex { value, percent, lost_percent })
    }

    /// Kezdi's split: the maximum D'15 / d'85 over splits with d'85 within [`KEZDI_RANGE`].
    ///
    /// `None` for a single size, or if a pan fraction hides the whole range.
    pub fn kezdi(&self) -> Option<SoilSplit> {
        let splits: Vec<SoilSplit> =
            self.splits(KEZDI_RANGE[1]).filter_map(|finer| self.split(finer)).collect();
        let most = splits.iter().map(|split| split.value).reduce(f64::max)?;
        let ties = splits.into_iter().filter(|split| split.value >= most * (1.0 - TIE));
        ties.max_by(|a, b| a.percent.total_cmp(&b.percent))
    }

    /// Coarsest split, at up to `most_percent`, with a D'15 / d'85 above this limit; `None` if there is
    /// no such split.
    pub fn greatest_split_above(&self, limit: f64, most_percent: f64) -> Option<SoilSplit> {
        let splits: Vec<f64> = self.splits(0.85 * most_percent).collect();
        let is_above = |finer: f64| self.split(finer).is_some_and(|split| split.value > limit * (1.0 + TIE));
        self.split(greatest(&splits, is_above)?)
    }

    /// Percents finer than d'85 at which the ratio may be extreme, in any order, up to `high`.
    fn splits(&self, high: f64) -> impl Iterator<Item = f64> {
        let low = KEZDI_RANGE[0].max(self.percent[0]);
        let candidates = self.percent.iter().flat_map(|&p| [p, p - BETWEEN]).chain([low, high]);
        let is_split = self.size_mm.len() > 1;
        candidates.filter(move |finer| is_split && (low..=high).contains(finer))
    }

    /// Split with d'85 at the percent `finer`: the split is at `finer` / 0.85, and D'15 at 15 % more of
    /// the whole mass.
    fn split(&self, finer: f64) -> Option<SoilSplit> {
        let (coarse, fine) = (self.coarse_d(finer + BETWEEN)?, self.d(finer)?);
        let percent = finer / 0.85;
        Some(SoilSplit { value: coarse / fine, percent, coarse_d15_mm: coarse, fine_d85_mm: fine })
    }
}

/// Largest place at which a condition holds that changes at most once between neighbours of `places`.
fn greatest(places: &[f64], holds: impl Fn(f64) -> bool) -> Option<f64> {
    let last = places.iter().copied().filter(|&at| holds(at)).max_by(f64::total_cmp)?;
    let next = places.iter().copied().filter(|&at| at > last).min_by(f64::total_cmp);
    let (mut low, mut high) = (last, next.unwrap_or(last));
    for _ in 0..60 {
        let middle = 0.5 * (low + high);
        if holds(middle) { low = middle } else { high = middle }
    }
    Some(low)
}

/// Burenkova's two conditional factors of uniformity of a soil.
///
/// - Burenkova (1993): a soil without cohesion, with grains of up to 100 mm and a Cu of up to 200,
///   retains its fines if `0.76 lg h'' + 1 < h' < 1.86 lg h'' + 1`.
/// - Wan and Fell (2004, 2008): logistic regression of tests on broadly graded and gap-graded soils
///   gives the probability that a soil loses its fines, `1 / (1 + exp(-Z))`:
///   `Z = 3.875 lg h'' - 3.591 h' + 2.436` for sand and gravel with up to 10 % of non-plastic fines,
///   `Z = 2.378 lg h'' - 3.648 h' + 3.701` for silt, sand and gravel.
///
/// Source: the manual named above, chapters "Burenkova Method" and "Modified Burenkova Method". One
/// stored version prints D10 in the equation of h'' and D15 in its list of symbols; the published page,
/// its text and the chapter on Wan and Fell have D15.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct UniformityFactors {
    /// `h' = D90 / D60`: steepness of the coarse fraction.
    pub coarse: f64,
    /// `h'' = D90 / D15`: distance from the fine to the coarse fraction.
    pub whole: f64,
}

impl UniformityFactors {
    /// Bounds of `h'` between which Burenkova's soils retained their fines.
    pub fn stable(&self) -> [f64; 2] {
        let lg = libm::log10(self.whole);
        [0.76 * lg + 1.0, 1.86 * lg + 1.0]
    }

    /// Wan and Fell's probability (0 to 1) that the soil loses its fines, by the equation for sand and
    /// gravel with few fines or the one for silt, sand and gravel.
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
    pub fn uniformity_factors(&self) -> Option<UniformityFactors> {
        let [d15, d60, d90] = [self.d(15.0)?, self.d(60.0)?, self.d(90.0)?];
        Some(UniformityFactors { coarse: d90 / d60, whole: d90 / d15 })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn points(points: &[(f64, f64)]) -> Gradation {
        Gradation::from_points(points, None).unwrap()
    }

    /// On a straight line on semi-log paper the mass between D and 4 D is the same everywhere, 50 ln 4 /
    /// ln Cu percent, so H / F is smallest at the largest F; and 15 % of the mass always spans Cu^0.3.
    #[test]
    fn straight_curves_by_hand() {
        for (cu, limit) in [(3.0, 30.0), (8.0, 20.0), (60.0, 20.0)] {
            let g = Gradation::linear_from_d0(0.1, cu).unwrap();
            let h = (50.0 * libm::log(4.0) / libm::log(cu)).min(100.0 - limit);
            let kenney_lau = g.kenney_lau().unwrap();
            assert!((kenney_lau.value - h / limit).abs() < 1e-9, "{cu} {kenney_lau:?}");
            assert!((kenney_lau.percent - limit).abs() < 1e-9);
            assert!((g.kezdi().unwrap().value - libm::pow(cu, 0.3)).abs() < 1e-9, "{cu}");
        }
    }

    /// A size at F = 20 % that is read as slightly more than 20 % finer is still examined.
    #[test]
    fn the_end_of_the_loose_part_is_looked_at_whatever_its_last_digit() {
        let mut beyond = 0;
        for n in 1..400 {
            let soil = points(&[(0.1, 0.0), (2.0 + 0.01 * f64::from(n), 40.0), (19.0, 100.0)]);
            let d20 = soil.d(20.0).unwrap();
            let finer = soil.percent_finer_by_mass(d20);
            beyond += usize::from(finer > 20.0);
            let at_end = (soil.percent_finer_by_mass(4.0 * d20) - finer) / finer;
            assert!(soil.kenney_lau().unwrap().value <= at_end, "{n}");
        }
        assert!(beyond > 10, "{beyond}");
    }

    /// A gap from 0.2 to 2 mm at 25 %: F = 25 % is outside the loose part of a widely graded soil, but
    /// Kezdi's split there has d'85 at 21.25 % and D'15 at 36.25 %.
    #[test]
    fn a_gap_by_hand() {
        let gap = points(&[(0.1, 0.0), (0.2, 25.0), (2.0, 25.0), (20.0, 100.0)]);
        let fine = 0.1 * libm::pow(2.0, 21.25 / 25.0);
        let coarse = 2.0 * libm::pow(10.0, 11.25 / 75.0);
        assert!(gap.kezdi().unwrap().value >= coarse / fine - 1e-12);
        // The widest window of 15 % begins in the gap and ends at D(40): D(40) over D(25); or it begins at
        // the first judged F: D(30) over D(15).
        let d_40 = 2.0 * libm::pow(10.0, 15.0 / 75.0);
        let (d_15, d_30) = (0.1 * libm::pow(2.0, 0.6), 2.0 * libm::pow(10.0, 5.0 / 75.0));
        let widest = (d_40 / 0.2).max(d_30 / d_15);
        assert!((gap.kezdi().unwrap().value - widest).abs() < 1e-9);
        // At F = 20 %, D = 0.1 * 2^0.8, 4 D lies in the gap: H = 5 %.
        assert!((gap.kenney_lau().unwrap().value - 0.25).abs() < 1e-9);
    }

    /// The extremes equal those of a fine scan of the curve.
    #[test]
    fn extremes_are_those_of_a_scan() {
        let start = [(0.05, 0.0), (0.2, 8.0), (0.5, 11.0), (2.0, 30.0)];
        let g = points(&[&start[..], &[(5.0, 34.0), (9.0, 80.0), (40.0, 100.0)]].concat());
        let limit = g.loose_percent().unwrap();
        let (mut least, mut most) = (f64::MAX, 0f64);
        for i in 1..=20_000 {
            let percent = f64::from(i) / 20_000.0 * limit;
            let d = g.d(percent).unwrap();
            least = least.min((g.percent_finer_by_mass(4.0 * d) - percent) / percent);
            let finer = 15.0 + f64::from(i) / 20_000.0 * 40.0;
            most = most.max(g.d(finer + 15.0).unwrap() / g.d(finer).unwrap());
        }
        let (kenney_lau, kezdi) = (g.kenney_lau().unwrap().value, g.kezdi().unwrap().value);
        assert!(kenney_lau <= least && least - kenney_lau < 1e-3 * least, "{kenney_lau} {least}");
        assert!(kezdi >= most * (1.0 - 1e-12) && kezdi - most < 1e-3 * most, "{kezdi} {most}");
    }

    /// A filter with 0.5 % of fines, and the middle of the limits of ASTM C33 fine aggregate: D'15 / d'85
    /// is above 4 where almost nothing is finer or almost nothing coarser, yet both retain their fines.
    #[test]
    fn ends_of_a_curve_raise_no_alarm() {
        let clean = points(&[(0.075, 0.5), (0.3, 2.0), (0.6, 10.0), (1.2, 40.0), (4.0, 100.0)]);
        let sizes = [0.075, 0.15, 0.3, 0.6, 1.18, 2.36, 4.75, 9.5];
        let percents = [1.5, 5.0, 17.5, 37.5, 67.5, 90.0, 97.5, 100.0];
        let c33 = points(&sizes.into_iter().zip(percents).collect::<Vec<_>>());
        assert!(clean.d(15.5).unwrap() / clean.d(0.5).unwrap() > 4.0);
        assert!(c33.d(100.0).unwrap() / c33.d(85.0).unwrap() > 4.0);
        for soil in [clean, c33] {
            assert!(soil.kezdi().unwrap().value < 4.0);
            assert!(soil.kenney_lau().unwrap().value > 1.0 && soil.li_fannin().unwrap().value > 1.0);
        }
        // The gap-graded filter of 40 % fine sand under gravel stays unstable.
        let gap = points(&[(0.1, 0.0), (0.5, 40.0), (5.0, 40.0), (20.0, 100.0)]);
        assert!(gap.kezdi().unwrap().value > 10.0);
    }

    /// ASTM C33 sand, split at 17.65 %: 85 % of the finer fraction is 15 % of the whole, and 15 % of the
    /// coarser fraction plus all of the finer is 30 %. Each fraction is computed separately here, as 100 %.
    #[test]
    fn a_split_is_that_of_both_parts_by_themselves() {
        let sizes = [0.15, 0.3, 0.6, 1.18, 2.36, 4.75, 9.5];
        let percents = [6.0, 20.0, 42.5, 67.5, 90.0, 97.5, 100.0];
        let sand = points(&sizes.into_iter().zip(percents).collect::<Vec<_>>());
        let split = sand.kezdi().unwrap();
        assert!((split.percent - 15.0 / 0.85).abs() < 1e-9, "{split:?}");
        // D15 = 0.15 x 2^(9/14), D30 = 0.3 x 2^(10/22.5).
        let (fine, coarse) = (0.15 * libm::pow(2.0, 9.0 / 14.0), 0.3 * libm::pow(2.0, 10.0 / 22.5));
        assert!((split.fine_d85_mm - fine).abs() < 1e-9 && (split.coarse_d15_mm - coarse).abs() < 1e-9);
        assert!((split.value - 1.743).abs() < 1e-3 && split.value == split.coarse_d15_mm / split.fine_d85_mm);
        let at = sand.d(split.percent).unwrap();
        let (share, rows) = (split.percent, || sizes.into_iter().zip(percents));
        let finer = rows().filter(|row| row.0 < at).map(|(size, percent)| (size, 100.0 * percent / share));
        let finer = points(&finer.chain([(at, 100.0)]).collect::<Vec<_>>());
        assert!((finer.d(85.0).unwrap() - fine).abs() < 1e-9);
        let coarser = rows().filter(|row| row.0 > at);
        let coarser = coarser.map(|(size, percent)| (size, 100.0 * (percent - share) / (100.0 - share)));
        let coarser = points(&[(at, 0.0)].into_iter().chain(coarser).collect::<Vec<_>>());
        assert!((coarser.d(15.0).unwrap() - coarse).abs() < 1e-9);
    }

    #[test]
    fn what_a_tail_hides_is_not_guessed() {
        let tail = points(&[(0.1, 35.0), (1.0, 60.0), (10.0, 100.0)]);
        assert_eq!(tail.kenney_lau(), None);
        assert_eq!(tail.known_kenney_lau(), None);
        // 14 % below the finest sieve, 46 % straight over the next two decades: H is smallest at F = 20 %.
        let clayey = points(&[(0.002, 14.0), (0.2, 60.0), (0.4, 100.0)]);
        let known = clayey.known_kenney_lau().unwrap();
        let h = 46.0 * libm::log(4.0) / libm::log(100.0);
        assert!(clayey.kenney_lau().is_none() && (known.value - h / 20.0).abs() < 1e-9, "{known:?}");
        assert!((known.percent - 20.0).abs() < 1e-9);
        assert!(tail.kezdi().is_some());
        assert_eq!(Gradation::single(1.0).unwrap().kezdi(), None);
        assert_eq!(Gradation::single(1.0).unwrap().kenney_lau(), None);
    }

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

    /// A straight line on semi-log paper has h' = Cu^0.6 and h'' = Cu^1.5: such filters are stable at a
    /// usual Cu.
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
