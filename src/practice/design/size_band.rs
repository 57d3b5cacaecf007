//! Band of a filter as sizes: its two sides, and its limits at each sieve.

use super::products::size_at;
use crate::rules::{GREATEST_SIZE_MM, MOST_FINES_PERCENT, WIDEST_BAND};
use serde::{Deserialize, Serialize};
use std::fmt;
use std::str::FromStr;
use voidwalk_core::gradation::{FINES_MM, Gradation, ShapeIndex, SoilSplit};
use voidwalk_sheets::us_sieve;

/// Two sides of a band as sizes.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schemas", derive(schemars::JsonSchema))]
pub struct SizeBand {
    /// D5, D15 and D60 of both sides.
    pub sizes: Vec<BandSize>,
    /// Fine side up to its D60: size (mm) and percent finer, ascending. No source was read for the range
    /// above it.
    pub(crate) fine_side: Vec<[f64; 2]>,
    /// Coarse side up to its D60: size (mm) and percent finer, ascending.
    pub coarse_side: Vec<[f64; 2]>,
}

/// Size of both sides of a band at one percent finer.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schemas", derive(schemars::JsonSchema))]
pub struct BandSize {
    /// Percent finer.
    pub percent: f64,
    /// Minimum size (mm), of the fine side.
    pub min_mm: f64,
    /// Maximum size (mm), of the coarse side.
    pub max_mm: f64,
}

/// Limits of a delivery at a sieve. A row of `specification.csv`.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schemas", derive(schemars::JsonSchema))]
pub struct SieveLimit {
    /// Name of the sieve.
    pub sieve: String,
    /// Opening of the sieve (mm).
    pub opening_mm: f64,
    /// Minimum percent finer, of the coarse side: a whole percent within the band, or tenths or
    /// hundredths if no whole percent lies within.
    pub min_percent_finer: f64,
    /// Maximum percent finer, of the fine side, rounded likewise; `None` above its D60.
    pub max_percent_finer: Option<f64>,
}

/// Percents at which sizes of a band are shown.
const SIZES: [f64; 3] = [5.0, 15.0, 60.0];

/// D15/D10 of a straight side with a Cu of 6: 6^(5/50) = 1.196.
pub const D15_OVER_D10: f64 = 1.2;

impl SizeBand {
    /// Minimum D10F (mm), which sets the maximum D90F.
    pub fn least_d10_mm(&self) -> f64 {
        (self.d15_mm()[0] / D15_OVER_D10).min(size_at(&self.fine_side, 10.0))
    }

    /// Builds a band from the control points of its sides: minimum and maximum D15 and D60 (mm).
    ///
    /// Both sides are straight in percent over log size between their points and end at their D60. The
    /// coarse side continues straight down to 0 %. The fine side begins at its D5, a fifth of the coarse
    /// side's but at least 0.075 mm; at most 5 % is finer. `None` if a D60 is not below 75 mm, or if the
    /// coarse side has more than 5 % finer than 0.075 mm.
    pub(crate) fn of(d15: [f64; 2], d60: [f64; 2]) -> Option<Self> {
        let on =
            |side: usize, percent: f64| d15[side] * libm::pow(d60[side] / d15[side], (percent - 15.0) / 45.0);
        if d60.iter().any(|size| *size >= GREATEST_SIZE_MM) {
            return None;
        }
        let coarse_d5 = on(1, MOST_FINES_PERCENT);
        let d5 = (coarse_d5 / WIDEST_BAND).max(FINES_MM);
        // The sides would cross.
        if coarse_d5 < d5 {
            return None;
        }
        let fine_side = vec![[d5, MOST_FINES_PERCENT], [d15[0], 15.0], [d60[0], 60.0]];
        let coarse_side = vec![[on(1, 0.0), 0.0], [d15[1], 15.0], [d60[1], 60.0]];
        let size = |percent: f64| BandSize {
            percent,
            min_mm: size_at(&fine_side, percent),
            max_mm: size_at(&coarse_side, percent),
        };
        Some(Self { sizes: SIZES.map(size).to_vec(), fine_side, coarse_side })
    }

    /// Both sides, the fine one first, continued straight up to 100 % but to at most 75 mm; used only for
    /// their internal stability.
    pub(crate) fn continued(&self) -> [Vec<[f64; 2]>; 2] {
        [&self.fine_side, &self.coarse_side].map(|side| {
            let [d15, d60] = [15.0, 60.0].map(|percent| size_at(side, percent));
            let top = (d60 * libm::pow(d60 / d15, 40.0 / 45.0)).min(GREATEST_SIZE_MM);
            side.iter().copied().chain([[top, 100.0]]).collect()
        })
    }

    /// Fine side as drawn and as limited at the sieves: below its D5 it is level down to 0.075 mm, the
    /// finest sieve of every series, where it ends. Both sides then begin at 0 %.
    pub fn drawn_fine_side(&self) -> Vec<[f64; 2]> {
        let foot = [[FINES_MM, 0.0], [FINES_MM, MOST_FINES_PERCENT]];
        foot.into_iter().chain(self.fine_side.iter().copied()).collect()
    }

    /// D15 (mm) of the fine and of the coarse side.
    pub fn d15_mm(&self) -> [f64; 2] {
        [&self.fine_side, &self.coarse_side].map(|side| size_at(side, 15.0))
    }

    /// Minimum and maximum percent finer than an opening (mm); `None` above the D60 of the side.
    fn percent_finer(&self, opening_mm: f64) -> [Option<f64>; 2] {
        [&self.coarse_side, &self.fine_side].map(|side| {
            let is_drawn = side.last().is_some_and(|top| opening_mm <= top[0]);
            is_drawn.then(|| percent_at(side, opening_mm))
        })
    }

    /// Limits at the sieves of a series, from the coarsest sieve within the D60 of the coarse side down.
    pub(crate) fn limits(&self, series: SieveSeries) -> Vec<SieveLimit> {
        let limit = |&opening_mm: &f64| {
            let [min, max] = self.percent_finer(opening_mm);
            let [min_percent_finer, most] = whole([min?, max.unwrap_or(100.0)]);
            let max_percent_finer = max.map(|_| most);
            Some(SieveLimit {
                sieve: series.name(opening_mm),
                opening_mm,
                min_percent_finer,
                max_percent_finer,
            })
        };
        series.openings().iter().filter_map(limit).collect()
    }
}

/// Whole percents within two limits, tenths if there is no whole percent between them, hundredths if
/// there is no tenth, and the limits themselves if there is no hundredth.
fn whole([min, max]: [f64; 2]) -> [f64; 2] {
    // Absorbs the rounding error of logarithms.
    let hair = 1e-9;
    // Rounding up from below 0 gives -0; adding 0 removes the sign.
    let inward =
        |parts: f64| [((min - hair) * parts).ceil() / parts + 0.0, ((max + hair) * parts).floor() / parts];
    let rounded = [1.0, 10.0, 100.0].map(inward).into_iter().find(|[min, max]| min <= max);
    rounded.unwrap_or([min, max])
}

/// Percent finer than a size (mm); a side keeps the percent of its first point below that point.
fn percent_at(side: &[[f64; 2]], size: f64) -> f64 {
    let below = side.partition_point(|point| point[0] <= size);
    match below.checked_sub(1) {
        None => side[0][1],
        Some(last) if below == side.len() => side[last][1],
        Some(last) => {
            let ([low, a], [high, b]) = (side[last], side[below]);
            a + (b - a) * libm::log(size / low) / libm::log(high / low)
        }
    }
}

/// Series of sieves.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schemas", derive(schemars::JsonSchema))]
#[serde(rename_all = "lowercase")]
pub enum SieveSeries {
    /// US sieves (ASTM E11), named by inches and numbers.
    #[default]
    Us,
    /// Sieves in millimetres, each half the previous one, with 75 mm above them, which no side exceeds,
    /// and 0.075 mm below them, at which fines are limited.
    Iso,
}

const US: [f64; 14] = [75.0, 50.0, 37.5, 25.0, 19.0, 12.5, 9.5, 4.75, 2.36, 1.18, 0.6, 0.3, 0.15, FINES_MM];

const ISO: [f64; 12] = [75.0, 63.0, 31.5, 16.0, 8.0, 4.0, 2.0, 1.0, 0.5, 0.25, 0.125, FINES_MM];

impl SieveSeries {
    /// Openings of the sieves (mm), coarsest first.
    pub fn openings(self) -> &'static [f64] {
        match self {
            Self::Us => &US,
            Self::Iso => &ISO,
        }
    }

    pub(crate) fn name(self, opening_mm: f64) -> String {
        let in_mm = || format!("{opening_mm} mm");
        match self {
            Self::Us => us_sieve(opening_mm).unwrap_or_else(in_mm),
            Self::Iso => in_mm(),
        }
    }
}

impl FromStr for SieveSeries {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        match text.trim().to_lowercase().as_str() {
            "us" => Ok(Self::Us),
            "iso" => Ok(Self::Iso),
            _ => Err("allowed: us (ASTM E11, by inches and numbers) or iso (mm)".into()),
        }
    }
}

impl fmt::Display for SieveSeries {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Us => "us",
            Self::Iso => "iso",
        })
    }
}

/// Maximum D'15/d'85 of a stable soil by Kezdi.
pub(super) const MOST_KEZDI: f64 = 4.0;

/// Minimum H/F of a stable soil by Kenney and Lau.
pub(super) const LEAST_SHAPE: f64 = 1.0;

/// Side of a band as a soil.
pub(super) struct Side {
    /// `fine` or `coarse`.
    pub(crate) name: &'static str,
    pub(crate) kezdi: Option<SoilSplit>,
    pub(crate) kenney_lau: Option<ShapeIndex>,
}

impl Side {
    /// Both sides; an index is `None` for a side of one size. The line drawn below D5 of the fine side
    /// limits the fines and is not part of a gradation.
    pub(crate) fn both(band: &SizeBand) -> [Self; 2] {
        let [fine, coarse] = band.continued();
        [("fine", fine), ("coarse", coarse)].map(|(name, points)| {
            let soil = Gradation::of_rows(&points).ok();
            let kezdi = soil.as_ref().and_then(Gradation::kezdi);
            Self { name, kezdi, kenney_lau: soil.as_ref().and_then(Gradation::kenney_lau) }
        })
    }

    /// Authors of the rules that the side does not keep.
    pub(crate) fn authorities(&self) -> Vec<String> {
        let kezdi = self.kezdi.filter(|index| index.value > MOST_KEZDI).map(|_| "Kézdi".to_owned());
        let shape =
            self.kenney_lau.filter(|index| index.value < LEAST_SHAPE).map(|_| "Kenney and Lau".to_owned());
        kezdi.into_iter().chain(shape).collect()
    }

    pub(crate) fn is_known(&self) -> bool {
        self.kezdi.is_some() && self.kenney_lau.is_some()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn near(value: f64, wanted: f64) -> bool {
        (value / wanted - 1.0).abs() < 1e-9
    }

    /// Band of this D15 with a D60 of five times the maximum, and a fifth of it.
    fn band_from(least: f64, most: f64) -> Option<SizeBand> {
        SizeBand::of([least, most], [most, 5.0 * most])
    }

    /// Band of a base of category 2: D60 of 0.7 to 3.5 mm.
    fn band() -> SizeBand {
        band_from(0.14, 0.7).unwrap()
    }

    #[test]
    fn the_sides_of_a_band_by_hand() {
        let band = band();
        let size = |percent: f64| {
            let size = band.sizes.iter().find(|size| size.percent == percent).unwrap();
            (size.min_mm, size.max_mm)
        };
        assert_eq!((size(15.0), size(60.0)), ((0.14, 0.7), (0.7, 3.5)));
        // Both sides rise by a factor of 5 in 45 %.
        let d5 = size(5.0);
        assert!(near(d5.0, d5.1 / 5.0) && near(d5.1, 0.7 * 5f64.powf(-10.0 / 45.0)), "{d5:?}");
        assert_eq!(band_from(0.1, 0.3).unwrap().sizes[0].min_mm, 0.075);
        let [fine, coarse] = band.continued().map(|side| side[side.len() - 1]);
        assert!(near(fine[0], 0.7 * 5f64.powf(40.0 / 45.0)) && near(coarse[0], 3.5 * 5f64.powf(40.0 / 45.0)));
        assert_eq!([fine[1], coarse[1]], [100.0; 2]);
    }

    #[test]
    fn limits_by_hand_are_whole_percents_within_the_band() {
        let limits = band().limits(SieveSeries::Us);
        for (name, range) in [
            // A side has no limit above its D60, 0.7 and 3.5 mm: ln(2.36/0.7)/ln 5 x 45 + 15 = 48.98.
            ("No. 8", (49.0, None)),
            // ln(0.6/0.14)/ln 5 x 45 + 15 = 55.7 and ln(0.6/0.7)/ln 5 x 45 + 15 = 10.7.
            ("No. 30", (11.0, Some(55.0))),
            ("No. 200", (0.0, Some(5.0))),
        ] {
            let limit = limits.iter().find(|limit| limit.sieve == name).unwrap();
            assert_eq!((limit.min_percent_finer, limit.max_percent_finer), range);
        }
        assert!(limits.iter().all(|limit| limit.min_percent_finer.is_sign_positive()));
        assert_eq!(limits[0].sieve, "No. 8");
        let iso = band().limits(SieveSeries::Iso);
        assert_eq!(iso.last().unwrap().max_percent_finer, Some(5.0));
        assert!(iso.iter().all(|limit| limit.opening_mm <= 3.5));
    }

    #[test]
    fn a_side_that_stands_upright_and_one_beyond_the_greatest_size() {
        // D15 and D60 of the fine side are equal.
        let band = SizeBand::of([0.7, 0.7], [0.7, 3.5]).unwrap();
        assert_eq!(band.percent_finer(0.7)[1], Some(60.0));
        assert!(band.percent_finer(0.69)[1].unwrap() < 15.0);
        assert!(SizeBand::of([4.0, 20.0], [20.0, 100.0]).is_none());
        // The maximum size cuts it off.
        let coarse = SizeBand::of([2.0, 10.0], [10.0, 50.0]).unwrap();
        assert_eq!(coarse.continued()[1].last(), Some(&[75.0, 100.0]));
    }

    #[test]
    fn percents_are_rounded_into_the_band() {
        assert_eq!(whole([4.2, 4.8]), [4.2, 4.8]);
        assert_eq!(whole([4.24, 4.86]), [4.3, 4.8]);
        assert_eq!(whole([4.241, 4.289]), [4.25, 4.28]);
        assert_eq!(whole([4.2411, 4.2419]), [4.2411, 4.2419]);
        assert_eq!(whole([3.2, 9.9]), [4.0, 9.0]);
    }

    /// Both sides begin at 0 %, no row allows more or less than they do, and no sieve has a minimum above
    /// its maximum, down to the maximum D15F at which the coarse side has 5 % finer than 0.075 mm:
    /// 0.075 x 5^(10/45) = 0.1072 mm.
    #[test]
    fn no_sieve_allows_more_than_the_sides_that_are_drawn_and_no_band_is_inside_out() {
        assert_eq!([0.1, 0.107, 0.1073].map(|most| band_from(0.1, most).is_some()), [false, false, true]);
        // D5 of the fine side lies above No. 200 in the first band, and at it in the second.
        let narrow = [(0.14, 0.7), (0.1, 0.3), (0.1, 0.1073), (0.1, 0.12), (0.1, 0.5)];
        for (least, most) in narrow.into_iter().chain([(0.7, 0.7), (2.0, 10.0), (2.9, 14.9)]) {
            let band = band_from(least, most).unwrap();
            assert!(band.sizes.iter().all(|size| size.min_mm <= size.max_mm), "{:?}", band.sizes);
            let fine = band.drawn_fine_side();
            assert_eq!([fine[0][1], band.coarse_side[0][1]], [0.0, 0.0]);
            assert!(fine.windows(2).all(|pair| pair[0][0] <= pair[1][0] && pair[0][1] <= pair[1][1]));
            for limit in [SieveSeries::Us, SieveSeries::Iso].iter().flat_map(|series| band.limits(*series)) {
                let (fewest, many) = (limit.min_percent_finer, limit.max_percent_finer);
                let [min, max] = band.percent_finer(limit.opening_mm);
                assert!(fewest <= many.unwrap_or(100.0) && fewest > min.unwrap() - 1e-6, "{limit:?}");
                assert!(max.is_none_or(|max| many.unwrap_or(100.0) < max + 1e-6), "{limit:?}");
                let [low, high] = [&band.coarse_side, &fine].map(|side| percent_at(side, limit.opening_mm));
                assert!(fewest > low - 1e-6 && many.is_none_or(|many| many <= high + 1e-6), "{limit:?}");
            }
        }
    }

    #[test]
    fn sieves_fall_and_end_where_fines_are_limited() {
        for series in [SieveSeries::Us, SieveSeries::Iso] {
            let openings = series.openings();
            assert!(openings.windows(2).all(|pair| pair[0] > pair[1]), "{series}");
            assert_eq!(openings.last(), Some(&FINES_MM));
            assert_eq!(series.to_string().parse::<SieveSeries>(), Ok(series));
        }
        let names =
            |series: SieveSeries| series.openings().iter().map(|mm| series.name(*mm)).collect::<Vec<_>>();
        assert_eq!(names(SieveSeries::Us)[..3], ["3 in", "2 in", "1 1/2 in"]);
        assert!(names(SieveSeries::Us).iter().all(|name| !name.ends_with("mm")));
        assert_eq!(names(SieveSeries::Iso)[10..], ["0.125 mm", "0.075 mm"]);
        assert!("bs".parse::<SieveSeries>().unwrap_err().contains("allowed: us"));
    }
}
