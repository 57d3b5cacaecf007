//! Standard products: which of them keep what a filter is asked for with both their own sides. Their own
//! shapes are not walked.
//!
//! Only products whose limits could be read in a public source are here.

use serde::{Deserialize, Serialize};

use super::band::Band;
use crate::gradation::FINES_MM;
use crate::outcome::numbers::significant;
use crate::outcome::rules::{GREATEST_SIZE_MM, MOST_CU, MOST_FINES_PERCENT, WIDEST_BAND};

/// Least Cu of a filter that is specified.
pub const LEAST_CU: f64 = 2.0;

/// A product as its standard limits it.
pub struct Product {
    /// Its name.
    pub name: &'static str,
    /// Sieve (mm), least and greatest percent finer; rising.
    pub limits: &'static [(f64, f64, f64)],
    /// Where its limits were read.
    pub source: &'static str,
}

/// Products that are sold by name.
pub const PRODUCTS: [Product; 5] = [
    Product {
        name: "ASTM C33 fine aggregate",
        limits: &[
            (0.075, 0.0, 3.0),
            (0.15, 0.0, 10.0),
            (0.3, 5.0, 30.0),
            (0.6, 25.0, 60.0),
            (1.18, 50.0, 85.0),
            (2.36, 80.0, 100.0),
            (4.75, 95.0, 100.0),
            (9.5, 100.0, 100.0),
        ],
        source: "ASTM C33, table 1: limits to be checked against the standard",
    },
    Product {
        name: "ASTM C33/D448 No. 8 stone",
        limits: &[
            (1.18, 0.0, 5.0),
            (2.36, 0.0, 10.0),
            (4.75, 10.0, 30.0),
            (9.5, 85.0, 100.0),
            (12.5, 100.0, 100.0),
        ],
        source: "Colorado DOT, table 703-1, from AASHTO M 43",
    },
    Product {
        name: "ASTM C33/D448 No. 78 stone",
        limits: &[
            (1.18, 0.0, 5.0),
            (2.36, 0.0, 10.0),
            (4.75, 5.0, 25.0),
            (9.5, 40.0, 75.0),
            (12.5, 90.0, 100.0),
            (19.0, 100.0, 100.0),
        ],
        source: "AASHTO M 43: limits to be checked against the standard",
    },
    Product {
        name: "ASTM C33/D448 No. 67 stone",
        limits: &[
            (2.36, 0.0, 5.0),
            (4.75, 0.0, 10.0),
            (9.5, 20.0, 55.0),
            (19.0, 90.0, 100.0),
            (25.0, 100.0, 100.0),
        ],
        source: "Iowa DOT, Matls. IM 209, appendix D (April 2017), gradation No. 5 (67), which sets \
                 limits at these sieves and one of its own at 0.075 mm",
    },
    Product {
        name: "ASTM C33/D448 No. 57 stone",
        limits: &[
            (2.36, 0.0, 5.0),
            (4.75, 0.0, 10.0),
            (12.5, 25.0, 60.0),
            (25.0, 95.0, 100.0),
            (37.5, 100.0, 100.0),
        ],
        source: "Iowa DOT, Matls. IM 209, appendix D (April 2017), gradation No. 3 (57), which sets \
                 limits at these sieves and one of its own at 0.075 mm",
    },
];

/// How the source of a product ends whose limits were read in no text of a named body.
const TO_BE_CHECKED: &str = "limits to be checked against the standard";

/// That the limits of some products are to be checked, from the name and the source of each; `None` where
/// none are.
pub fn to_be_checked<'a>(products: impl Iterator<Item = (&'a str, &'a str)>) -> Option<String> {
    let named: Vec<&str> =
        products.filter(|(_, source)| source.ends_with(TO_BE_CHECKED)).map(|(name, _)| name).collect();
    (!named.is_empty()).then(|| format!("Limits to be checked against the standard: {}.", named.join(", ")))
}

/// A product beside a band.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
pub struct Fit {
    /// Its name.
    pub name: String,
    /// D15 (mm) of its fine and of its coarse side.
    pub d15_mm: [f64; 2],
    /// Whether its fine side drains.
    pub drains: bool,
    /// Whether its fine side drains only if the base's D15 is finer than its sieves tell.
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub may_drain: bool,
    /// Whether its coarse side is within what both walk and practice allow.
    pub holds: bool,
    /// Whether its coarse side keeps the strictest rule of retention; `None` where there is none.
    pub practice: Option<bool>,
    /// Where its limits were read.
    pub source: String,
}

impl Fit {
    /// Whether the D15 of both its sides lies within the band and practice does not speak against it. D15
    /// lies between sieves and is interpolated: a delivery within the limits may have another.
    pub fn fits(&self) -> bool {
        self.drains && self.holds && self.practice != Some(false)
    }

    /// Whether it fits if it drains, which is not known.
    pub fn may_fit(&self) -> bool {
        self.may_drain && self.holds && self.practice != Some(false)
    }
}

/// The size (mm) at which a side has this percent finer, straight in percent over log size; its end where it
/// does not reach it. Points are size (mm) and percent finer, rising.
pub(super) fn size_at(side: &[[f64; 2]], percent: f64) -> f64 {
    let above = side.iter().position(|point| point[1] >= percent).unwrap_or(side.len() - 1);
    let [high, b] = side[above];
    let Some(below) = above.checked_sub(1) else { return high };
    let [low, a] = side[below];
    if percent >= b { high } else { low * libm::exp((percent - a) / (b - a) * libm::log(high / low)) }
}

impl Product {
    /// D15 (mm) of its fine and of its coarse side.
    pub fn d15_mm(&self) -> [f64; 2] {
        let side = |percent: fn(&(f64, f64, f64)) -> f64| {
            let points: Vec<[f64; 2]> = self.limits.iter().map(|row| [row.0, percent(row)]).collect();
            size_at(&points, 15.0)
        };
        [side(|row| row.2), side(|row| row.1)]
    }

    /// What its two sides do not keep of what a band is asked for beside D15F; a delivery may lie anywhere
    /// between them.
    pub fn not_kept(&self) -> Vec<String> {
        let sides: [Vec<[f64; 2]>; 2] = [
            self.limits.iter().map(|row| [row.0, row.2]).collect(),
            self.limits.iter().map(|row| [row.0, row.1]).collect(),
        ];
        let mut said = Vec::new();
        for (name, side) in ["fine", "coarse"].into_iter().zip(&sides) {
            let cu = size_at(side, 60.0) / size_at(side, 10.0);
            if !(LEAST_CU..=MOST_CU).contains(&cu) {
                let cu = significant(cu);
                said.push(format!("Cu of its {name} side is {cu}, and {LEAST_CU} to {MOST_CU} is asked for"));
            }
        }
        let from_5_to_60 = sides.iter().flatten().map(|row| row[1]).chain([5.0, 60.0]);
        let ratio = |percent: f64| size_at(&sides[1], percent) / size_at(&sides[0], percent);
        let wide = from_5_to_60.filter(|of| (5.0..=60.0).contains(of)).map(ratio).fold(0.0, f64::max);
        if wide > WIDEST_BAND {
            said.push(format!(
                "its sides are {} to 1 apart, and at most {WIDEST_BAND} is allowed",
                significant(wide)
            ));
        }
        let at_no_200 = self.limits.iter().rev().find(|row| row.0 <= FINES_MM).or(self.limits.first());
        if let Some((_, _, fines)) = at_no_200.filter(|row| row.2 > MOST_FINES_PERCENT) {
            said.push(format!("up to {fines} % may be finer than {FINES_MM} mm"));
        }
        if self.limits.last().is_some_and(|row| row.0 > GREATEST_SIZE_MM) {
            said.push(format!("grains may be coarser than {GREATEST_SIZE_MM} mm"));
        }
        said
    }
}

/// Every product beside a band in mm.
pub fn fits(band: &Band) -> Vec<Fit> {
    let one = |product: &Product| {
        let [fine, coarse] = product.d15_mm();
        Fit {
            name: product.name.into(),
            d15_mm: [fine, coarse],
            drains: fine >= band.least,
            may_drain: band.least_at_most && fine < band.least,
            holds: coarse <= band.greatest,
            practice: band.practice.map(|practice| coarse <= practice),
            source: product.source.into(),
        }
    };
    PRODUCTS.iter().map(one).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::outcome::design::band::SetBy;

    #[test]
    fn limits_rise_and_end_at_all() {
        for product in &PRODUCTS {
            let rising = |side: fn(&(f64, f64, f64)) -> f64| {
                product.limits.windows(2).all(|w| w[0].0 < w[1].0 && side(&w[0]) <= side(&w[1]))
            };
            assert!(rising(|row| row.1) && rising(|row| row.2), "{}", product.name);
            assert!(product.limits.iter().all(|row| row.1 <= row.2), "{}", product.name);
            assert_eq!(product.limits.last().unwrap().1, 100.0);
        }
    }

    /// Nobody can sign for "a specification" or for what "others cite".
    #[test]
    fn a_source_names_a_body_and_a_document_or_asks_for_the_standard() {
        for product in &PRODUCTS {
            let is_signed = ["Colorado DOT, table", "Iowa DOT, Matls. IM"]
                .iter()
                .any(|body| product.source.starts_with(body));
            assert!(is_signed || product.source.ends_with(TO_BE_CHECKED), "{}", product.name);
        }
        let said = to_be_checked(PRODUCTS.iter().map(|of| (of.name, of.source))).unwrap();
        assert_eq!(
            said,
            "Limits to be checked against the standard: ASTM C33 fine aggregate, ASTM C33/D448 No. 78 stone."
        );
        assert_eq!(to_be_checked(PRODUCTS[3..].iter().map(|of| (of.name, of.source))), None);
    }

    #[test]
    fn sides_of_products_by_hand() {
        let near = |found: f64, wanted: f64| (found / wanted - 1.0).abs() < 1e-9;
        let [fine, coarse] = PRODUCTS[0].d15_mm();
        // 10 to 30 % between 0.15 and 0.3 mm, 5 to 25 % between 0.3 and 0.6 mm.
        assert!(near(fine, 0.15 * libm::pow(2.0, 0.25)) && near(coarse, 0.3 * libm::pow(2.0, 0.5)));
        // 10 to 30 % between 2.36 and 4.75 mm, 10 to 85 % between 4.75 and 9.5 mm.
        let [fine, coarse] = PRODUCTS[1].d15_mm();
        assert!(near(fine, 2.36 * libm::pow(4.75 / 2.36, 0.25)));
        assert!(near(coarse, 4.75 * libm::pow(2.0, 5.0 / 75.0)));
        let [fine, coarse] = PRODUCTS[4].d15_mm();
        let step = 12.5 / 4.75;
        assert!(near(fine, 4.75 * libm::pow(step, 0.1)) && near(coarse, 4.75 * libm::pow(step, 0.6)));
    }

    #[test]
    fn a_product_fits_where_both_its_sides_do() {
        let band = |least, greatest| Band {
            least,
            least_at_most: false,
            greatest,
            set_by: SetBy::Walk,
            practice: Some(0.4),
            practice_rule: String::new(),
            practice_rule_id: None,
            unit: "mm".into(),
            is_empty: false,
            said: String::new(),
        };
        let sand = |least, greatest| fits(&band(least, greatest)).remove(0);
        // Practice allows 0.4 mm.
        assert!(sand(0.17, 0.4).drains && !sand(0.17, 0.4).holds && !sand(0.17, 0.4).fits());
        let allowed = Band { practice: Some(0.43), ..band(0.17, 0.43) };
        assert!(fits(&allowed)[0].fits() && fits(&Band { practice: None, ..allowed })[0].fits());
        assert!(!sand(0.18, 0.43).drains && !sand(0.17, 0.42).holds);
        // A least that is one at most neither drains nor refuses what is finer.
        let open = fits(&Band { least_at_most: true, practice: Some(0.7), ..band(0.375, 0.7) }).remove(0);
        assert!(!open.drains && open.may_drain && open.may_fit() && !open.fits(), "{open:?}");
        let coarse = fits(&Band { least_at_most: true, ..band(0.375, 0.3) }).remove(0);
        assert!(coarse.may_drain && !coarse.may_fit() && !coarse.fits(), "{coarse:?}");
        let wide = Band { practice: Some(1.0), ..band(0.1, 1.0) };
        assert_eq!(fits(&wide).iter().filter(|fit| fit.fits()).count(), 1);
    }
}
