//! Standard products, each checked on both sides against the requirements of a filter.
//!
//! The list holds only products whose limits could be read in a public source.

use serde::{Deserialize, Serialize};

use crate::rules::{GREATEST_SIZE_MM, MOST_CU, MOST_FINES_PERCENT, WIDEST_BAND};
use voidwalk_core::gradation::FINES_MM;

/// Requirement of a band, other than on D15F, that a product does not keep.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schemas", derive(schemars::JsonSchema))]
#[serde(tag = "id", rename_all = "snake_case")]
pub enum NotKept {
    /// Cu of the fine side.
    CuOfFineSide {
        /// Value of Cu.
        cu: f64,
    },
    /// Cu of the coarse side.
    CuOfCoarseSide {
        /// Value of Cu.
        cu: f64,
    },
    /// The sides are too far apart.
    Width {
        /// Maximum ratio of coarse to fine side at the same percent finer.
        ratio: f64,
    },
    /// The product may have too many fines.
    Fines {
        /// Maximum percent finer than 0.075 mm.
        percent: f64,
    },
    /// The product may have grains that are too coarse.
    GreatestSize,
}

/// Minimum Cu of a specified filter.
pub const LEAST_CU: f64 = 2.0;

/// Product with the limits of its standard.
pub(super) struct Product {
    pub(super) name: &'static str,
    /// Sieve (mm), minimum and maximum percent finer; ascending.
    limits: &'static [(f64, f64, f64)],
    pub(super) source: &'static str,
}

pub(super) const PRODUCTS: [Product; 5] = [
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

/// True if the source of a product says that its limits are to be checked against the standard, since
/// they were not read in a text of a named body.
pub fn is_to_be_checked(source: &str) -> bool {
    source.ends_with("limits to be checked against the standard")
}

/// Size (mm) at which a side has this percent finer, straight in percent over log size; the end of the
/// side if it does not reach the percent. Points are size (mm) and percent finer, ascending.
pub(super) fn size_at(side: &[[f64; 2]], percent: f64) -> f64 {
    let above = side.iter().position(|point| point[1] >= percent).unwrap_or(side.len() - 1);
    let [high, b] = side[above];
    let Some(below) = above.checked_sub(1) else { return high };
    let [low, a] = side[below];
    if percent >= b { high } else { low * libm::exp((percent - a) / (b - a) * libm::log(high / low)) }
}

impl Product {
    /// Fine and coarse side: size (mm) and percent finer.
    fn sides(&self) -> [Vec<[f64; 2]>; 2] {
        let fine = self.limits.iter().map(|(mm, _, most)| [*mm, *most]);
        let coarse = self.limits.iter().map(|(mm, least, _)| [*mm, *least]);
        [fine.collect(), coarse.collect()]
    }

    /// D15 (mm) of the fine and the coarse side.
    pub(crate) fn d15_mm(&self) -> [f64; 2] {
        self.sides().map(|side| size_at(&side, 15.0))
    }

    /// Requirements of a band, other than on D15F, that the two sides do not keep; a delivery may lie
    /// anywhere between them.
    pub(crate) fn not_kept(&self) -> Vec<NotKept> {
        let sides = self.sides();
        let mut not_kept = Vec::new();
        let of_sides: [fn(f64) -> NotKept; 2] =
            [|cu| NotKept::CuOfFineSide { cu }, |cu| NotKept::CuOfCoarseSide { cu }];
        for (of_side, side) in of_sides.into_iter().zip(&sides) {
            let cu = size_at(side, 60.0) / size_at(side, 10.0);
            not_kept.extend((!(LEAST_CU..=MOST_CU).contains(&cu)).then(|| of_side(cu)));
        }
        let from_5_to_60 = sides.iter().flatten().map(|row| row[1]).chain([5.0, 60.0]);
        let ratio = |percent: f64| size_at(&sides[1], percent) / size_at(&sides[0], percent);
        let wide =
            from_5_to_60.filter(|percent| (5.0..=60.0).contains(percent)).map(ratio).fold(0.0, f64::max);
        not_kept.extend((wide > WIDEST_BAND).then_some(NotKept::Width { ratio: wide }));
        let at_no_200 = self.limits.iter().rposition(|(mm, ..)| *mm <= FINES_MM).unwrap_or(0);
        let (_, _, percent) = self.limits[at_no_200];
        not_kept.extend((percent > MOST_FINES_PERCENT).then_some(NotKept::Fines { percent }));
        let is_too_coarse = self.limits.last().is_some_and(|(mm, ..)| *mm > GREATEST_SIZE_MM);
        not_kept.extend(is_too_coarse.then_some(NotKept::GreatestSize));
        not_kept
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn limits_rise_and_end_at_all() {
        for product in &PRODUCTS {
            let Product { name, limits, .. } = product;
            assert!(limits.is_sorted_by(|a, b| a.0 < b.0 && a.1 <= b.1 && a.2 <= b.2), "{name}");
            assert!(limits.iter().all(|(_, least, most)| least <= most), "{name}");
            assert_eq!(limits.last().unwrap().1, 100.0, "{name}");
        }
    }

    /// An engineer cannot sign for "a specification" or for what "others cite".
    #[test]
    fn a_source_names_a_body_and_a_document_or_asks_for_the_standard() {
        for product in &PRODUCTS {
            let bodies = ["Colorado DOT, table", "Iowa DOT, Matls. IM"];
            let is_signed = bodies.iter().any(|body| product.source.starts_with(body));
            assert!(is_signed || is_to_be_checked(product.source), "{}", product.name);
        }
        let checked = PRODUCTS.iter().filter(|product| is_to_be_checked(product.source));
        let names: Vec<&str> = checked.map(|product| product.name).collect();
        assert_eq!(names, ["ASTM C33 fine aggregate", "ASTM C33/D448 No. 78 stone"]);
    }

    #[test]
    fn sides_of_products_by_hand() {
        let near = |value: f64, wanted: f64| (value / wanted - 1.0).abs() < 1e-9;
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
}
