//! The specification of a filter for a base: the steps that lead to it, its band, and standard products
//! beside it.
//!
//! `verdict` makes it from the rules of practice, with its words.

use serde::{Deserialize, Serialize};

use super::finding::DesignFinding;
use super::products::{PRODUCTS, Product};
use super::sieves::SieveSeries;
pub use super::size_band::{BandSize, SieveLimit, SizeBand};
use crate::outcome::numbers::{SizeUnit, rounded_down, rounded_up, significant};
use crate::outcome::record::{IfDispersive, InputFile, SheetCover};

/// The whole of `specification.json`.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
pub struct Specification {
    /// Version of voidwalk.
    pub version: String,
    /// The commit that it was built from; `None` where that is not known.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub commit: Option<String>,
    /// Name of the base.
    pub base: String,
    /// Whether it was said to be dispersive.
    pub dispersive: bool,
    /// The sieves at which the limits are stated.
    pub sieves: SieveSeries,
    /// What its sheet says of itself; nothing as a part of a design.
    #[serde(default, skip_serializing_if = "SheetCover::is_unset")]
    pub cover: SheetCover,
    /// Whether inches stand beside mm on its page.
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub inches: bool,
    /// Every file that was read; empty as a part of a design, which has them itself.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub inputs: Vec<InputFile>,
    /// The curves of the base, in the order of the file.
    pub curves: Vec<SpecifiedCurve>,
    /// What a reader must know of the base itself, each of its curve where there are several, and of a side
    /// of the band that is not stable.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub findings: Vec<DesignFinding>,
    /// Every step, with its numbers.
    pub steps: Vec<SpecificationStep>,
    /// Minimum D15F (mm) that drains the base; `None` where it is not known.
    pub d15f_min_mm: Option<f64>,
    /// Whether the true least is not known, and is at most that.
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub d15f_min_at_most: bool,
    /// Whether the band lies at the finer end of what is allowed, and not at the coarser.
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub finer: bool,
    /// Maximum D15F (mm) that is allowed; `None` where it is not known.
    pub d15f_max_mm: Option<f64>,
    /// What practice allows if the base is dispersive; `None` where somebody has said whether it is, and
    /// where it has few fines.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub if_dispersive: Option<IfDispersive>,
    /// The band; `None` where there is none.
    pub band: Option<SizeBand>,
    /// Why there is no band.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub no_band: Option<String>,
    /// Percent finer at each sieve, the coarsest first; empty without a band.
    pub limits: Vec<SieveLimit>,
    /// Standard products beside it; empty where neither limit of D15F is known.
    pub products: Vec<ProductMargin>,
}

/// A curve of the base, and the limits of D15F that follow from it.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
pub struct SpecifiedCurve {
    /// Its name.
    pub curve: String,
    /// Size (mm) and percent finer by mass, as sampled.
    pub gradation: Vec<[f64; 2]>,
    /// The same after regrading; empty where it is not regraded.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub regraded: Vec<[f64; 2]>,
    /// D15 (mm) before regrading; `None` where it is finer than the finest sieve.
    pub d15_mm: Option<f64>,
    /// The size on which it was regraded (mm).
    pub regraded_at_mm: Option<f64>,
    /// D85 (mm) after regrading.
    pub d85_mm: Option<f64>,
    /// Percent finer than 0.075 mm after regrading.
    pub fines_percent: Option<f64>,
    /// Category of NRCS, 1 to 4.
    pub category: Option<u8>,
    /// Maximum D15F (mm) that retains it; `None` where it is not known.
    pub d15f_max_mm: Option<f64>,
    /// The rule that sets it.
    pub d15f_max_rule: String,
    /// Whether that maximum has no margin: tests showed no erosion up to it and no further, or erosion below
    /// it.
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub without_margin: bool,
    /// Minimum D15F (mm) that drains it.
    pub d15f_min_mm: Option<f64>,
}

/// A step of the procedure.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
pub struct SpecificationStep {
    /// Its number, from 1.
    pub step: u64,
    /// What is done.
    pub does: String,
    /// The formula, in words; empty where nothing is worked out.
    pub formula: String,
    /// Its numbers.
    pub values: Vec<StepValue>,
    /// What else a reader must know; may be empty.
    pub note: String,
    /// Where formula and numbers were read; empty where nothing is worked out.
    pub source: String,
}

/// The size of a band by which a table of the maximum D90F is entered. It is rounded down: a finer D10F
/// allows no coarser D90F.
pub const ENTERED_BY: &str = "minimum D10F";

/// A number of a step.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
pub struct StepValue {
    /// What it is, as `maximum D15F`.
    pub name: String,
    /// The number; `None` where it is not known.
    pub value: Option<f64>,
    /// Its unit: `mm`, `%`; empty for a ratio or a count.
    pub unit: String,
}

impl StepValue {
    /// The number with its unit, a minimum rounded up, a maximum and [`ENTERED_BY`] rounded down; `None`
    /// where it is not known.
    pub fn words(&self) -> Option<String> {
        self.words_in(SizeUnit::Mm)
    }

    /// The same, with inches behind a size where they are shown.
    pub fn words_in(&self, unit: SizeUnit) -> Option<String> {
        let value = self.value?;
        let (number, beside) = match (self.unit.as_str(), self.name.split(' ').next()) {
            ("mm", _) if self.name == ENTERED_BY => (rounded_down(value), unit.beside_greatest(value)),
            ("mm", Some("minimum")) => (rounded_up(value), unit.beside_least(value)),
            ("mm", Some("maximum")) => (rounded_down(value), unit.beside_greatest(value)),
            ("mm", _) => (significant(value), unit.beside(value)),
            ("", _) if value.fract() == 0.0 && value < 100.0 => (format!("{value:.0}"), String::new()),
            _ => (significant(value), String::new()),
        };
        Some(format!("{number} {}", self.unit).trim_end().to_owned() + &beside)
    }
}

/// A standard product beside a specification. A row of `specification_products.csv`.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
pub struct ProductMargin {
    /// Its name.
    pub product: String,
    /// D15 (mm) of its fine side.
    pub d15_fine_mm: f64,
    /// D15 (mm) of its coarse side.
    pub d15_coarse_mm: f64,
    /// D15 of its fine side over the least that drains: at least 1 where it drains. `None` where it is not
    /// known whether it drains.
    pub drains_by: Option<f64>,
    /// The maximum D15F over D15 of its coarse side: at least 1 where it holds.
    pub holds_by: Option<f64>,
    /// What its two sides do not keep of the other requirements: Cu, width of the band, fines, greatest size;
    /// empty where they keep all.
    pub not_kept: String,
    /// Where its limits were read.
    pub source: String,
}

impl ProductMargin {
    /// Whether both its sides keep every requirement; `None` where a limit of D15F that is not known decides.
    pub fn fits(&self) -> Option<bool> {
        let kept = [self.drains_by, self.holds_by].map(|margin| margin.map(|margin| margin >= 1.0));
        if kept.contains(&Some(false)) || !self.not_kept.is_empty() {
            Some(false)
        } else {
            kept.into_iter().collect::<Option<Vec<_>>>().map(|_| true)
        }
    }

    /// The smaller of its two margins.
    fn margin(&self) -> f64 {
        self.drains_by.unwrap_or(f64::INFINITY).min(self.holds_by.unwrap_or(f64::INFINITY))
    }
}

impl Specification {
    /// The product whose D15 comes closest to both limits, where none fits.
    pub fn nearest_product(&self) -> Option<&ProductMargin> {
        let none_fits = self.products.iter().all(|of| of.fits() == Some(false));
        let all = self.products.iter().filter(|_| none_fits && self.d15f_max_mm.is_some());
        all.max_by(|a, b| a.margin().total_cmp(&b.margin()))
    }

    /// What set the maximum D15F: the name of a rule, or the walk; `None` where it is not known.
    pub fn set_by(&self) -> Option<&str> {
        let greatest = self.d15f_max_mm?;
        let limits = self.curves.iter().filter_map(|curve| Some((curve, curve.d15f_max_mm?)));
        let (curve, limit) = limits.min_by(|a, b| a.1.total_cmp(&b.1))?;
        Some(if greatest < limit { "the walk" } else { &curve.d15f_max_rule })
    }
}

/// A number of `specification_steps.csv`.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct StepRow {
    /// Number of the step.
    pub step: u64,
    /// What is done.
    pub does: String,
    /// What the number is; empty where the step has none.
    pub quantity: String,
    /// The number.
    pub value: Option<f64>,
    /// Its unit.
    pub unit: String,
    /// The formula.
    pub formula: String,
    /// What else a reader must know.
    pub note: String,
    /// Where formula and numbers were read.
    pub source: String,
}

impl SpecificationStep {
    /// Its numbers as rows; one without a number where it has none.
    pub fn rows(&self) -> Vec<StepRow> {
        let row = |value: Option<&StepValue>| StepRow {
            step: self.step,
            does: self.does.clone(),
            quantity: value.map_or_else(String::new, |value| value.name.clone()),
            value: value.and_then(|value| value.value),
            unit: value.map_or_else(String::new, |value| value.unit.clone()),
            formula: self.formula.clone(),
            note: self.note.clone(),
            source: self.source.clone(),
        };
        match self.values.is_empty() {
            true => vec![row(None)],
            false => self.values.iter().map(|value| row(Some(value))).collect(),
        }
    }
}

/// Every standard product beside the minimum D15F (mm) with the least that it is for certain, and the
/// greatest.
pub fn margins((d15f_min, certain): (Option<f64>, f64), d15f_max: Option<f64>) -> Vec<ProductMargin> {
    if d15f_min.is_none() && d15f_max.is_none() {
        return Vec::new();
    }
    let one = |product: &Product| {
        let [fine, coarse] = product.d15_mm();
        ProductMargin {
            product: product.name.into(),
            d15_fine_mm: fine,
            d15_coarse_mm: coarse,
            // The true margin may be any greater.
            drains_by: d15f_min.map(|least| fine / least).filter(|margin| *margin >= 1.0 || fine < certain),
            holds_by: d15f_max.map(|greatest| greatest / coarse),
            not_kept: product.not_kept().join("; "),
            source: product.source.into(),
        }
    };
    PRODUCTS.iter().map(one).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn near(found: f64, wanted: f64) -> bool {
        (found / wanted - 1.0).abs() < 1e-9
    }

    #[test]
    fn a_minimum_is_rounded_up_and_a_maximum_down() {
        let of =
            |name: &str, value, unit: &str| StepValue { name: name.into(), value, unit: unit.into() }.words();
        assert_eq!(of("minimum D15F", Some(0.11661), "mm").unwrap(), "0.117 mm");
        // As the sentence has it that asks for D90F.
        assert_eq!(of(ENTERED_BY, Some(0.19158), "mm").unwrap(), "0.191 mm");
        assert_eq!(of("maximum D10F", Some(0.58389), "mm").unwrap(), "0.583 mm");
        assert_eq!(of("maximum D15F / minimum D15F, as found", Some(6.999), "").unwrap(), "7.00");
        assert_eq!(of("category", Some(2.0), "").unwrap(), "2");
        assert_eq!(of("minimum D15F", None, "mm"), None);
    }

    #[test]
    fn products_have_their_margins_also_where_none_fits() {
        let sand = &margins((Some(0.1), 0.1), Some(0.7))[0];
        // D15 0.178 to 0.424 mm (see `products`).
        assert!(
            near(sand.drains_by.unwrap(), 1.5 * 2f64.powf(0.25)) && sand.fits() == Some(true),
            "{sand:?}"
        );
        assert!(near(sand.holds_by.unwrap(), 0.7 / (0.3 * 2f64.sqrt())));
        let none = margins((Some(0.5), 0.5), Some(0.6));
        assert!(none.iter().all(|of| of.fits() == Some(false)));
        // What drains may or may not hold where the maximum D15F is not known.
        let open = margins((Some(0.2), 0.2), None);
        assert_eq!((open[0].fits(), open[2].fits()), (Some(false), None));
        assert!(margins((None, 0.0), None).is_empty());
        // Whether it drains is not known where the least is one at most.
        let till = &margins((Some(0.375), 0.0), Some(0.7))[0];
        assert_eq!((till.drains_by, till.fits()), (None, None));
        assert_eq!(margins((Some(0.375), 0.0), Some(0.3))[0].fits(), Some(false));
    }
}
