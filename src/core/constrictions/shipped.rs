//! Filters shipped with the program: each has a constriction curve, so that no packing is needed.
//!
//! They are in `src/core/data/filters`: one CSV file per filter, and `filters.toml` with their
//! descriptions. A new one needs a file, an entry there and a line in `TEXTS` here.

use super::curve::{Curve, CurveError, nearest};
use std::sync::OnceLock;

const MANIFEST: &str = include_str!("../data/filters/filters.toml");

/// Name and curve of each entry of the manifest.
const TEXTS: [(&str, &str); 9] = [
    ("shire2016-cu1.5-loose", include_str!("../data/filters/shire2016-cu1.5-loose.csv")),
    ("shire2016-cu1.5-dense", include_str!("../data/filters/shire2016-cu1.5-dense.csv")),
    ("shire2016-cu3-loose", include_str!("../data/filters/shire2016-cu3-loose.csv")),
    ("cu1.2-dense", include_str!("../data/filters/cu1.2-dense.csv")),
    ("cu1.5-dense", include_str!("../data/filters/cu1.5-dense.csv")),
    ("cu1.5-loose", include_str!("../data/filters/cu1.5-loose.csv")),
    ("cu3-dense", include_str!("../data/filters/cu3-dense.csv")),
    ("cu3-loose", include_str!("../data/filters/cu3-loose.csv")),
    ("cu6-friction0.7", include_str!("../data/filters/cu6-friction0.7.csv")),
];

/// Facts about a shipped filter; its gradation is linear and scale-free, with D0F = 1.
#[derive(Clone, Debug, PartialEq, serde::Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ShippedFilter {
    /// Name, for use in `filter.curve`.
    pub name: String,
    /// Description in one line.
    pub title: String,
    /// Coefficient of uniformity of the filter's gradation.
    pub cu: f64,
    /// Void ratio of the packing.
    pub void_ratio: f64,
    /// Source of the void ratio.
    pub(crate) void_ratio_source: String,
    /// Number of grains per void of a similar packing, N_p / N_voids.
    pub grains_per_void: f64,
    /// Source of the grains per void.
    pub(crate) grains_per_void_source: String,
    /// Authors to be named.
    pub attribution: String,
    /// Licence of the curve.
    pub licence: String,
    /// The curve as CSV text: `percent_smaller,diameter_over_d0f`.
    #[serde(skip)]
    pub curve_csv: &'static str,
}

#[derive(serde::Deserialize)]
#[serde(deny_unknown_fields)]
struct Manifest {
    filter: Vec<ShippedFilter>,
}

impl ShippedFilter {
    /// Returns the constriction curve, in units of D0F.
    ///
    /// # Errors
    /// Never for a filter from [`shipped`]: a test reads each.
    pub fn curve(&self) -> Result<Curve, CurveError> {
        Curve::from_csv_text(&format!("{}.csv", self.name), self.curve_csv.as_bytes())
    }
}

/// All shipped filters, in the order of their manifest.
///
/// # Panics
/// If the embedded manifest cannot be read; a test reads it.
pub fn shipped() -> &'static [ShippedFilter] {
    static FILTERS: OnceLock<Vec<ShippedFilter>> = OnceLock::new();
    FILTERS.get_or_init(|| {
        let mut filters = toml::from_str::<Manifest>(MANIFEST).expect("filters.toml").filter;
        for filter in &mut filters {
            let text = TEXTS.iter().find(|(name, _)| *name == filter.name);
            filter.curve_csv = text.expect("a curve for each entry of filters.toml").1;
        }
        filters
    })
}

/// Finds the shipped filter named `name`.
///
/// # Errors
/// An unknown name; the error gives the most similar name and all names.
///
/// ```
/// let filter = voidwalk_core::constrictions::find("shire2016-cu1.5-loose")?;
/// assert_eq!(filter.grains_per_void, 0.61);
/// assert!((filter.curve()?.cu() - 1.63).abs() < 0.01);
/// # Ok::<(), voidwalk_core::constrictions::CurveError>(())
/// ```
pub fn find(name: &str) -> Result<&'static ShippedFilter, CurveError> {
    shipped().iter().find(|filter| filter.name == name).ok_or_else(|| {
        let all: Vec<&str> = shipped().iter().map(|filter| filter.name.as_str()).collect();
        let nearest = nearest(name, all.iter().copied()).unwrap_or_default();
        CurveError::UnknownFilter(name.into(), nearest.into(), all.join(", "))
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_shipped_filter_can_be_read() {
        assert_eq!(shipped().len(), TEXTS.len());
        for filter in shipped() {
            let curve = filter.curve().unwrap();
            assert_eq!(curve.unit(), super::super::CurveUnit::D0f);
            assert!(filter.cu >= 1.0 && filter.grains_per_void > 0.0 && filter.void_ratio > 0.0);
            let published = filter.name.starts_with("shire2016");
            let is_cited = filter.curve_csv.contains("CC BY 4.0") && filter.attribution.contains("doi");
            assert_eq!(published, is_cited);
            // Three touching smallest grains leave 0.1547 D0F: nothing can be smaller.
            assert!(curve.smallest() >= 0.1547, "{}", filter.name);
        }
    }

    /// Published curves have the Cu_CSD of Table 2 of the paper, to the two decimals it gives.
    /// Compares the program's own six curves with Table 2: Cu_CSD within 0.04, except for Cu 6 (0.049
    /// too wide, a finding); void ratio within 0.006 without friction, 0.02 with 0.3, 0.03 with 0.7.
    /// Compares them with the published curves: 3 % at Dc5, Dc25, Dc50, 5 % at Dc75.
    #[test]
    fn own_curves_are_near_table_2_and_the_published_ones() {
        for (name, void_ratio, within, cu_csd, cu_within) in [
            ("cu1.2-dense", 0.558, 0.006, 1.48, 0.04),
            ("cu1.5-dense", 0.531, 0.006, 1.52, 0.04),
            ("cu1.5-loose", 0.658, 0.02, 1.63, 0.04),
            ("cu3-dense", 0.382, 0.006, 1.57, 0.04),
            ("cu3-loose", 0.455, 0.02, 1.60, 0.04),
            ("cu6-friction0.7", 0.340, 0.03, 1.57, 0.05),
        ] {
            let filter = find(name).unwrap();
            assert!((filter.void_ratio - void_ratio).abs() <= within, "{name}: {}", filter.void_ratio);
            let curve = filter.curve().unwrap();
            assert!((curve.cu() - cu_csd).abs() <= cu_within, "{name}: {}", curve.cu());
            let Ok(published) = find(&format!("shire2016-{name}")) else { continue };
            let published = published.curve().unwrap();
            assert!((published.cu() - cu_csd).abs() < 0.0101, "{name}: {}", published.cu());
            for (percent, within) in [(5.0, 0.03), (25.0, 0.03), (50.0, 0.03), (75.0, 0.05)] {
                let ratio = curve.dc(percent).unwrap() / published.dc(percent).unwrap();
                assert!((ratio - 1.0).abs() <= within, "{name}, Dc{percent}: {ratio}");
            }
        }
    }

    #[test]
    fn an_unknown_name_is_answered_with_the_nearest() {
        let error = find("shire2016-cu1.5-lose").unwrap_err().to_string();
        assert!(error.contains("nearest is \"shire2016-cu1.5-loose\""), "{error}");
        assert!(find("").is_err());
    }
}
