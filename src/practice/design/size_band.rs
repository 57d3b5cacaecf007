//! The band of a filter as sizes: its two sides, and its limits sieve by sieve.

use serde::{Deserialize, Serialize};

use super::products::size_at;
use super::sieves::SieveSeries;
use crate::rules::{GREATEST_SIZE_MM, MOST_FINES_PERCENT, WIDEST_BAND};
use voidwalk_core::gradation::FINES_MM;

/// The two sides of a band as sizes.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schemas", derive(schemars::JsonSchema))]
pub struct SizeBand {
    /// D5, D15 and D60 of both sides.
    pub sizes: Vec<BandSize>,
    /// The fine side up to its D60: size (mm) and percent finer, rising. No text was read for what lies
    /// above.
    pub fine_side: Vec<[f64; 2]>,
    /// The coarse side, likewise.
    pub coarse_side: Vec<[f64; 2]>,
}

/// A size of both sides of a band.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schemas", derive(schemars::JsonSchema))]
pub struct BandSize {
    /// Percent finer.
    pub percent: f64,
    /// Least size (mm), of the fine side.
    pub min_mm: f64,
    /// Greatest size (mm), of the coarse side.
    pub max_mm: f64,
}

/// What a delivery may have finer than a sieve. A row of `specification.csv`.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schemas", derive(schemars::JsonSchema))]
pub struct SieveLimit {
    /// Name of the sieve.
    pub sieve: String,
    /// Its opening (mm).
    pub opening_mm: f64,
    /// Least percent finer, of the coarse side: a whole percent within the band; tenths or hundredths where
    /// no whole percent lies within.
    pub min_percent_finer: f64,
    /// Greatest percent finer, of the fine side, likewise; `None` above its D60.
    pub max_percent_finer: Option<f64>,
}

/// Percents at which the sizes of a band are shown.
const SIZES: [f64; 3] = [5.0, 15.0, 60.0];

/// D15/D10 of a side that is straight on the form and has a Cu of 6: 6^(5/50) = 1.196.
pub const D15_OVER_D10: f64 = 1.2;

impl SizeBand {
    /// The minimum D10F (mm), which sets the maximum D90F.
    pub fn least_d10_mm(&self) -> f64 {
        (self.d15_mm()[0] / D15_OVER_D10).min(self.least_size(10.0))
    }

    /// Band from the control points of its sides: least and maximum D15 and D60 (mm).
    ///
    /// Both sides are straight in percent over log size between their points, and end at their D60. The
    /// coarse side goes on straight down to 0 %. The fine side begins at its D5, a fifth of the coarse side's
    /// but not less than 0.075 mm; at most 5 % are finer. `None` if a D60 is not below 75 mm, or if the
    /// coarse side has more than 5 % finer than 0.075 mm.
    pub fn of(d15: [f64; 2], d60: [f64; 2]) -> Option<Self> {
        let on =
            |side: usize, percent: f64| d15[side] * libm::pow(d60[side] / d15[side], (percent - 15.0) / 45.0);
        if d60.iter().any(|size| *size >= GREATEST_SIZE_MM) {
            return None;
        }
        let coarse_d5 = on(1, MOST_FINES_PERCENT);
        let d5 = (coarse_d5 / WIDEST_BAND).max(FINES_MM);
        // The band would be inside out.
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

    /// Both sides, the fine one first, continued straight up to 100 %, but to no more than 75 mm: for their
    /// internal stability alone.
    pub fn continued(&self) -> [Vec<[f64; 2]>; 2] {
        [&self.fine_side, &self.coarse_side].map(|side| {
            let [d15, d60] = [15.0, 60.0].map(|percent| size_at(side, percent));
            let top = (d60 * libm::pow(d60 / d15, 40.0 / 45.0)).min(GREATEST_SIZE_MM);
            side.iter().copied().chain([[top, 100.0]]).collect()
        })
    }

    /// The fine side as drawn and as limited at the sieves: below its D5 it runs level down to 0.075 mm, the
    /// finest sieve of every series, where it ends. Both sides then begin at 0 %.
    pub fn drawn_fine_side(&self) -> Vec<[f64; 2]> {
        let foot = [[FINES_MM, 0.0], [FINES_MM, MOST_FINES_PERCENT]];
        foot.into_iter().chain(self.fine_side.iter().copied()).collect()
    }

    /// The size (mm) at which the fine side has this percent finer; the end of the side if it does not reach
    /// the percent.
    pub fn least_size(&self, percent: f64) -> f64 {
        size_at(&self.fine_side, percent)
    }

    /// D15 (mm) of the fine and of the coarse side.
    pub fn d15_mm(&self) -> [f64; 2] {
        [&self.fine_side, &self.coarse_side].map(|side| size_at(side, 15.0))
    }

    /// Least and greatest percent finer than an opening (mm); `None` above the D60 of the side.
    pub fn percent_finer(&self, opening_mm: f64) -> [Option<f64>; 2] {
        [&self.coarse_side, &self.fine_side].map(|side| {
            let is_drawn = side.last().is_some_and(|top| opening_mm <= top[0]);
            is_drawn.then(|| percent_at(side, opening_mm))
        })
    }

    /// Limits at the sieves of a series, from the coarsest sieve within the D60 of the coarse side down.
    pub fn limits(&self, series: SieveSeries) -> Vec<SieveLimit> {
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

/// Whole percents within two limits; tenths if no whole percent lies between them, hundredths if no tenth
/// does, and the limits themselves if no hundredth does.
fn whole([min, max]: [f64; 2]) -> [f64; 2] {
    // Logarithms leave a rounding error, which is not a percent.
    let hair = 1e-9;
    // Rounding up from below 0 gives -0, to which 0 is added.
    let inward =
        |parts: f64| [((min - hair) * parts).ceil() / parts + 0.0, ((max + hair) * parts).floor() / parts];
    let rounded = [1.0, 10.0, 100.0].map(inward).into_iter().find(|[min, max]| min <= max);
    rounded.unwrap_or([min, max])
}

/// Percent finer than a size (mm); below its first point a side keeps the percent of that point.
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

#[cfg(test)]
mod tests {
    use super::*;

    fn near(value: f64, wanted: f64) -> bool {
        (value / wanted - 1.0).abs() < 1e-9
    }

    /// D15 0.14 to 0.7 mm, as for a base of category 2: D60 to 5 x 0.7 = 3.5 mm, and a fifth of it.
    fn band() -> SizeBand {
        SizeBand::of([0.14, 0.7], [0.7, 3.5]).unwrap()
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
        let fine = SizeBand::of([0.1, 0.3], [0.3, 1.5]).unwrap();
        assert_eq!(fine.sizes[0].min_mm, 0.075);
        let [fine, coarse] = band.continued().map(|side| side[side.len() - 1]);
        assert!(near(fine[0], 0.7 * 5f64.powf(40.0 / 45.0)) && near(coarse[0], 3.5 * 5f64.powf(40.0 / 45.0)));
        assert_eq!([fine[1], coarse[1]], [100.0; 2]);
    }

    #[test]
    fn limits_by_hand_are_whole_percents_within_the_band() {
        let limits = band().limits(SieveSeries::Us);
        let limits_at = |name: &str| {
            let limit = limits.iter().find(|limit| limit.sieve == name).unwrap();
            (limit.min_percent_finer, limit.max_percent_finer)
        };
        // ln(0.6/0.14)/ln 5 x 45 + 15 = 55.7 and ln(0.6/0.7)/ln 5 x 45 + 15 = 10.7.
        assert_eq!(limits_at("No. 30"), (11.0, Some(55.0)));
        assert_eq!(limits_at("No. 200"), (0.0, Some(5.0)));
        // Above the D60 of a side, 0.7 and 3.5 mm, it has no limit: ln(2.36/0.7)/ln 5 x 45 + 15 = 48.98.
        assert_eq!(limits_at("No. 8"), (49.0, None));
        assert!(limits.iter().all(|limit| limit.min_percent_finer.is_sign_positive()));
        assert_eq!(limits[0].sieve, "No. 8");
        let iso = band().limits(SieveSeries::Iso);
        assert_eq!(iso.last().unwrap().max_percent_finer, Some(5.0));
        assert!(iso.iter().all(|limit| limit.opening_mm <= 3.5));
    }

    /// Both sides begin at 0 %, and no row allows more or less than they do.
    #[test]
    fn no_sieve_allows_more_than_the_sides_that_are_drawn() {
        // D5 of the fine side lies above No. 200, and at it.
        for band in [band(), SizeBand::of([0.1, 0.3], [0.3, 1.5]).unwrap()] {
            let fine = band.drawn_fine_side();
            assert_eq!([fine[0][1], band.coarse_side[0][1]], [0.0, 0.0]);
            assert!(fine.windows(2).all(|pair| pair[0][0] <= pair[1][0] && pair[0][1] <= pair[1][1]));
            for series in [SieveSeries::Us, SieveSeries::Iso] {
                assert_eq!(series.openings().last(), Some(&FINES_MM));
                for limit in band.limits(series) {
                    let [least, most] =
                        [&band.coarse_side, &fine].map(|side| percent_at(side, limit.opening_mm));
                    assert!(limit.max_percent_finer.is_none_or(|percent| percent <= most + 1e-6));
                    assert!(limit.min_percent_finer > least - 1e-6);
                }
            }
        }
    }

    #[test]
    fn a_side_that_stands_upright_and_one_beyond_the_greatest_size() {
        // D15 and D60 of the fine side are one size.
        let band = SizeBand::of([0.7, 0.7], [0.7, 3.5]).unwrap();
        assert_eq!(band.percent_finer(0.7)[1], Some(60.0));
        assert!(band.percent_finer(0.69)[1].unwrap() < 15.0);
        assert!(SizeBand::of([4.0, 20.0], [20.0, 100.0]).is_none());
        // The greatest size cuts it off.
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

    /// No sieve has a least above its greatest, down to the maximum D15F at which the coarse side has 5 %
    /// finer than 0.075 mm: 0.075 x 5^(10/45) = 0.1072 mm.
    #[test]
    fn no_band_is_inside_out() {
        let band_from = |least: f64, most: f64| SizeBand::of([least, most], [most, 5.0 * most]);
        assert!(
            band_from(0.1, 0.1).is_none()
                && band_from(0.1, 0.107).is_none()
                && band_from(0.1, 0.1073).is_some()
        );
        for (least, most) in [(0.1, 0.1073), (0.1, 0.12), (0.1, 0.5), (0.7, 0.7), (2.0, 10.0), (2.9, 14.9)] {
            let band = band_from(least, most).unwrap();
            for series in [SieveSeries::Us, SieveSeries::Iso] {
                for limit in band.limits(series) {
                    let most_finer = limit.max_percent_finer.unwrap_or(100.0);
                    assert!(limit.min_percent_finer <= most_finer, "{most}: {limit:?}");
                    let [min, max] = band.percent_finer(limit.opening_mm);
                    assert!(limit.min_percent_finer > min.unwrap() - 1e-6);
                    assert!(max.is_none_or(|max| most_finer < max + 1e-6));
                }
            }
            assert!(band.sizes.iter().all(|size| size.min_mm <= size.max_mm), "{:?}", band.sizes);
        }
    }
}
