//! Specification of a filter for a base: its steps, its band, and standard products beside it.

use super::products::{NotKept, PRODUCTS, Product};
use super::size_band::SieveSeries;
use crate::Note;
use serde::{Deserialize, Serialize};

pub use super::size_band::SizeBand;
pub(crate) use super::size_band::{BandSize, SieveLimit};
use crate::{IfDispersive, InputFile, RuleNote, SheetCover};
use voidwalk_core::gradation::RegradeReason;

/// Contents of `specification.json`.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schemas", derive(schemars::JsonSchema))]
pub struct Specification {
    /// Version of voidwalk.
    pub version: String,
    /// Commit that the program was built from; `None` if it is not known.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub commit: Option<String>,
    /// Name of the base.
    pub base: String,
    /// True if the base was stated to be dispersive.
    pub dispersive: bool,
    /// Sieves at which the limits are stated.
    pub sieves: SieveSeries,
    /// Cover of the sheet.
    #[serde(default, skip_serializing_if = "SheetCover::is_unset")]
    pub cover: SheetCover,
    /// True if the page shows inches beside mm.
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub inches: bool,
    /// Files that were read.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub inputs: Vec<InputFile>,
    /// Curves of the base, in the order of the file.
    pub curves: Vec<SpecifiedCurve>,
    /// Notes on the base, with the curve's name if there are several, and on sides of the band that are
    /// not internally stable.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub notes: Vec<RowNote>,
    /// Steps in order, with their numbers.
    pub steps: Vec<SpecificationStep>,
    /// Minimum D15F (mm) that drains the base; `None` if it is not known.
    pub d15f_min_mm: Option<f64>,
    /// True if the minimum is not known exactly and is at most `d15f_min_mm`.
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub d15f_min_at_most: bool,
    /// True if the band lies at the finer end of the allowed sizes, false if at the coarser end.
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub finer: bool,
    /// Maximum allowed D15F (mm); `None` if it is not known.
    pub d15f_max_mm: Option<f64>,
    /// Limit of practice if the base is dispersive; `None` if dispersion is stated or the base has few
    /// fines.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub if_dispersive: Option<IfDispersive>,
    /// Band of the filter; `None` if there is none.
    pub band: Option<SizeBand>,
    /// Reason why there is no band.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub no_band: Option<NoBand>,
    /// Percent finer at each sieve, coarsest first; empty without a band.
    pub limits: Vec<SieveLimit>,
    /// Standard products; empty if neither limit of D15F is known.
    pub products: Vec<ProductMargin>,
}

/// Curve of the base with its limits of D15F.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schemas", derive(schemars::JsonSchema))]
pub struct SpecifiedCurve {
    /// Name of the curve.
    pub curve: String,
    /// Size (mm) and percent finer by mass, as sampled.
    pub gradation: Vec<[f64; 2]>,
    /// Size (mm) and percent finer by mass after regrading; empty if it is not regraded.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub regraded: Vec<[f64; 2]>,
    /// D15 (mm) before regrading; `None` if it is finer than the finest sieve.
    pub(crate) d15_mm: Option<f64>,
    /// Size on which the curve was regraded (mm).
    pub(crate) regraded_at_mm: Option<f64>,
    /// D85 (mm) after regrading.
    pub d85_mm: Option<f64>,
    /// Percent finer than 0.075 mm after regrading.
    pub fines_percent: Option<f64>,
    /// NRCS category, 1 to 4.
    pub(crate) category: Option<u8>,
    /// Maximum D15F (mm) that retains the curve; `None` if it is not known.
    pub(crate) d15f_max_mm: Option<f64>,
    /// Rule that sets the maximum.
    pub d15f_max_rule: String,
    /// True if the maximum has no margin: tests showed erosion below it, or no erosion only up to it.
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub without_margin: bool,
    /// Minimum D15F (mm) that drains the curve.
    pub(crate) d15f_min_mm: Option<f64>,
}

/// Step of the procedure.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schemas", derive(schemars::JsonSchema))]
pub struct SpecificationStep {
    /// Number of the step, from 1.
    pub step: u64,
    /// Name of the step.
    pub does: StepName,
    /// Formula; empty if nothing is calculated.
    pub formula: String,
    /// Numbers of the step.
    pub values: Vec<StepValue>,
    /// Notes on the step.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub notes: Vec<StepNote>,
    /// Source of formula and numbers; empty if nothing is calculated.
    pub source: String,
}

/// Name of a step of the procedure.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schemas", derive(schemars::JsonSchema))]
#[serde(rename_all = "snake_case")]
pub enum StepName {
    /// Plot the gradation of the base.
    Plot,
    /// Find gravel and gaps in the base.
    FindGravel,
    /// Regrade the base.
    Regrade,
    /// Determine the category of the base.
    Place,
    /// Find the maximum D15F that retains the base.
    Retain,
    /// Find the minimum D15F that drains the base.
    Drain,
    /// Keep the band narrow at 15 % finer.
    Narrow,
    /// Keep both sides uniform.
    KeepUniform,
    /// Limit the fines and the maximum size.
    LimitEnds,
    /// Keep the filter from segregating.
    KeepFromSegregating,
    /// Draw both sides of the band.
    Draw,
    /// Check both sides for internal stability.
    CheckStability,
}

/// Note on a step.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schemas", derive(schemars::JsonSchema))]
#[serde(tag = "id", rename_all = "snake_case")]
pub enum StepNote {
    /// Curves of the base.
    Curves {
        /// Number of curves.
        curves: u64,
    },
    /// Gravel and gaps in a curve.
    Gravel {
        /// Name of the curve, if there are several.
        curve: Option<String>,
        /// Reason for regrading or not.
        why: RegradeReason,
        /// Size (mm) from which a factor of 4 in size holds the least mass, and that mass (%); `None` if
        /// the sieves do not give it.
        flattest: Option<[f64; 2]>,
    },
    /// No curve is regraded.
    NotRegraded,
    /// Rule and curve that set a limit.
    SetBy {
        /// Name of the rule; `None` if the step has only one.
        rule: Option<String>,
        /// Name of the curve; `None` if there is only one.
        curve: Option<String>,
    },
    /// The limit of a curve is not known.
    LimitNotKnown {
        /// Missing inputs.
        needs: Vec<RuleNote>,
    },
    /// D15B is finer than the finest sieve, so the minimum D15F is at most the one given.
    DrainageAtMost,
    /// Notes of the rule.
    OfRule {
        /// Its notes.
        notes: Vec<RuleNote>,
    },
    /// The minimum D15F was raised.
    Raised,
    /// The maximum D15F was lowered.
    Lowered,
    /// Internal stability of a side of the band.
    Stability {
        /// `fine` or `coarse`.
        side: String,
        /// True if both indices are known.
        is_known: bool,
        /// Authors of the rules that are not kept.
        not_kept: Vec<String>,
    },
}

/// Size of a band used to enter the table of the maximum D90F. It is rounded down: a finer D10F allows no
/// coarser D90F.
pub const ENTERED_BY: &str = "minimum D10F";

/// Number of a step.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schemas", derive(schemars::JsonSchema))]
pub struct StepValue {
    /// Name of the number, such as `maximum D15F`.
    pub name: String,
    /// Value of the number; `None` if it is not known.
    pub value: Option<f64>,
    /// Unit: `mm` or `%`; empty for a ratio or a count.
    pub unit: String,
}

impl StepValue {
    /// True for a minimum, false for a maximum and for [`ENTERED_BY`], `None` for any other value.
    pub fn role(&self) -> Option<bool> {
        match self.name.split(' ').next() {
            _ if self.name == ENTERED_BY => Some(false),
            Some("minimum") => Some(true),
            Some("maximum") => Some(false),
            _ => None,
        }
    }
}

/// Reason why there is no band.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schemas", derive(schemars::JsonSchema))]
#[serde(tag = "id", rename_all = "snake_case")]
pub enum NoBand {
    /// Only an upper bound of the minimum D15F is known, and it exceeds the maximum.
    DrainageNotKnown {
        /// Upper bound of the minimum (mm).
        most_drains_mm: f64,
        /// The maximum (mm).
        most_mm: f64,
    },
    /// The minimum D15F is above the maximum.
    NoneDrainsAndRetains {
        /// The minimum (mm).
        least_mm: f64,
        /// The maximum (mm).
        most_mm: f64,
    },
    /// The coarse side would have too many fines.
    TooManyFines,
    /// The maximum D60F exceeds the maximum size.
    TooCoarse {
        /// The maximum D60F (mm).
        most_d60f_mm: f64,
    },
    /// The maximum D15F of a curve is not known.
    LimitNotKnown {
        /// The curve of the base.
        curve: String,
        /// Missing inputs.
        needs: Vec<RuleNote>,
    },
    /// No rule of retention covers the base.
    NoRule,
}

/// Standard product compared with a specification. A row of `specification_products.csv`.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schemas", derive(schemars::JsonSchema))]
pub struct ProductMargin {
    /// Name of the product.
    pub product: String,
    /// D15 (mm) of the fine side.
    pub d15_fine_mm: f64,
    /// D15 (mm) of the coarse side.
    pub d15_coarse_mm: f64,
    /// D15 of the fine side over the minimum D15F: at least 1 if it drains. `None` if it is not known if
    /// it drains.
    pub drains_by: Option<f64>,
    /// Maximum D15F over D15 of the coarse side: at least 1 if it holds the base.
    pub holds_by: Option<f64>,
    /// Other requirements that the two sides do not keep: Cu, width of the band, fines, maximum size;
    /// empty if they keep all.
    pub not_kept: Vec<NotKept>,
    /// Source of its limits.
    pub source: String,
}

impl ProductMargin {
    /// True if both sides keep every requirement; `None` if an unknown limit of D15F decides.
    pub fn fits(&self) -> Option<bool> {
        let kept = [self.drains_by, self.holds_by].map(|margin| margin.map(|margin| margin >= 1.0));
        if kept.contains(&Some(false)) || !self.not_kept.is_empty() {
            Some(false)
        } else {
            kept.into_iter().collect::<Option<Vec<_>>>().map(|_| true)
        }
    }

    fn margin(&self) -> f64 {
        self.drains_by.unwrap_or(f64::INFINITY).min(self.holds_by.unwrap_or(f64::INFINITY))
    }
}

impl Specification {
    /// Product whose D15 comes closest to both limits, if no product fits.
    pub fn nearest_product(&self) -> Option<&ProductMargin> {
        let none_fits = self.products.iter().all(|product| product.fits() == Some(false));
        let all = self.products.iter().filter(|_| none_fits && self.d15f_max_mm.is_some());
        all.max_by(|a, b| a.margin().total_cmp(&b.margin()))
    }

    /// Curve that sets the maximum D15F, and this D15F (mm); `None` if it is not known.
    pub fn strictest(&self) -> Option<(&SpecifiedCurve, f64)> {
        self.d15f_max_mm?;
        let limits = self.curves.iter().filter_map(|curve| Some((curve, curve.d15f_max_mm?)));
        limits.min_by(|a, b| a.1.total_cmp(&b.1))
    }

    /// Author of the rule that sets the maximum D15F; `None` if it is not known.
    pub fn set_by(&self) -> Option<&str> {
        self.strictest().map(|(curve, _)| &*curve.d15f_max_rule)
    }
}

/// Compares every standard product with the minimum D15F (mm), its certain lower bound, and the maximum.
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
            // The true margin may be arbitrarily larger.
            drains_by: d15f_min.map(|least| fine / least).filter(|margin| *margin >= 1.0 || fine < certain),
            holds_by: d15f_max.map(|greatest| greatest / coarse),
            not_kept: product.not_kept(),
            source: product.source.into(),
        }
    };
    PRODUCTS.iter().map(one).collect()
}

/// Note on a row of boundaries or on a curve of the base of a specification.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schemas", derive(schemars::JsonSchema))]
pub struct RowNote {
    /// Row or curve that the note concerns, in words; `None` if it concerns all.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub row: Option<String>,
    /// Text of the note.
    #[serde(flatten)]
    pub note: Note,
}

#[cfg(test)]
mod tests {
    use super::*;

    fn near(value: f64, wanted: f64) -> bool {
        (value / wanted - 1.0).abs() < 1e-9
    }

    #[test]
    fn products_have_their_margins_also_where_none_fits() {
        let sand = &margins((Some(0.1), 0.1), Some(0.7))[0];
        // D15 of 0.178 to 0.424 mm (see `products`).
        assert!(
            near(sand.drains_by.unwrap(), 1.5 * 2f64.powf(0.25)) && sand.fits() == Some(true),
            "{sand:?}"
        );
        assert!(near(sand.holds_by.unwrap(), 0.7 / (0.3 * 2f64.sqrt())));
        let none = margins((Some(0.5), 0.5), Some(0.6));
        assert!(none.iter().all(|product| product.fits() == Some(false)));
        // A product that drains may or may not hold if the maximum D15F is not known.
        let open = margins((Some(0.2), 0.2), None);
        assert_eq!((open[0].fits(), open[2].fits()), (Some(false), None));
        assert!(margins((None, 0.0), None).is_empty());
        // Drainage is not known if only an upper bound of the minimum is known.
        let till = &margins((Some(0.375), 0.0), Some(0.7))[0];
        assert_eq!((till.drains_by, till.fits()), (None, None));
        assert_eq!(margins((Some(0.375), 0.0), Some(0.3))[0].fits(), Some(false));
    }
}
