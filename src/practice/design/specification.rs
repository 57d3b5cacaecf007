//! The specification of a filter for a base: the steps that lead to it, its band, and standard products
//! beside it.
//!
//! `verdict` makes it from the rules of practice, with its words.

use super::products::{NotKept, PRODUCTS, Product};
use super::size_band::SieveSeries;
use crate::Note;
use serde::{Deserialize, Serialize};

pub use super::size_band::{BandSize, SieveLimit, SizeBand};
use crate::{IfDispersive, InputFile, RuleNote, SheetCover};
use voidwalk_core::gradation::RegradeReason;

/// The whole of `specification.json`.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schemas", derive(schemars::JsonSchema))]
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
    /// What its sheet says of itself.
    #[serde(default, skip_serializing_if = "SheetCover::is_unset")]
    pub cover: SheetCover,
    /// Whether inches stand beside mm on its page.
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub inches: bool,
    /// Every file that was read.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub inputs: Vec<InputFile>,
    /// The curves of the base, in the order of the file.
    pub curves: Vec<SpecifiedCurve>,
    /// What a reader must know of the base itself, each of its curve where there are several, and of a side
    /// of the band that is not stable.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub notes: Vec<RowNote>,
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
    pub no_band: Option<NoBand>,
    /// Percent finer at each sieve, the coarsest first; empty without a band.
    pub limits: Vec<SieveLimit>,
    /// Standard products beside it; empty where neither limit of D15F is known.
    pub products: Vec<ProductMargin>,
}

/// A curve of the base, and the limits of D15F that follow from it.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schemas", derive(schemars::JsonSchema))]
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
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schemas", derive(schemars::JsonSchema))]
pub struct SpecificationStep {
    /// Its number, from 1.
    pub step: u64,
    /// What is done.
    pub does: StepName,
    /// The formula; empty where nothing is worked out.
    pub formula: String,
    /// Its numbers.
    pub values: Vec<StepValue>,
    /// What else to know.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub notes: Vec<StepNote>,
    /// Where formula and numbers were read; empty where nothing is worked out.
    pub source: String,
}

/// A step of the procedure by its name.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schemas", derive(schemars::JsonSchema))]
#[serde(rename_all = "snake_case")]
pub enum StepName {
    /// Plot the gradation of the base.
    #[default]
    Plot,
    /// Find gravel and gaps of the base.
    FindGravel,
    /// Regrade the base.
    Regrade,
    /// Place the base in a category.
    Place,
    /// Find the maximum D15F that retains the base.
    Retain,
    /// Find the minimum D15F that drains the base.
    Drain,
    /// Keep the band narrow at 15 % finer.
    Narrow,
    /// Keep both sides uniform.
    KeepUniform,
    /// Limit the fines and the greatest size.
    LimitEnds,
    /// Keep the filter from segregating.
    KeepFromSegregating,
    /// Draw both sides of the band.
    Draw,
    /// Check both sides for internal stability.
    CheckStability,
}

/// What else to know of a step.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schemas", derive(schemars::JsonSchema))]
#[serde(tag = "id", rename_all = "snake_case")]
pub enum StepNote {
    /// Curves of the base.
    Curves {
        /// How many.
        curves: u64,
    },
    /// Gravel and gaps of a curve.
    Gravel {
        /// Its name, where there are several.
        curve: Option<String>,
        /// Why it is regraded, or not.
        why: RegradeReason,
        /// Size (mm) from which the least mass lies within a factor of 4, and that mass (%); `None` where its
        /// sieves do not tell.
        flattest: Option<[f64; 2]>,
    },
    /// No curve is regraded.
    NotRegraded,
    /// The rule, and of several curves the one, that sets a limit.
    SetBy {
        /// The rule; `None` where the step has one alone.
        rule: Option<String>,
        /// The curve.
        curve: Option<String>,
    },
    /// The limit of a curve is not known.
    LimitNotKnown {
        /// What is missing.
        needs: Vec<RuleNote>,
    },
    /// D15B is finer than the finest sieve, and the minimum D15F at most the one given.
    DrainageAtMost,
    /// What the rule says besides.
    OfRule {
        /// Its notes.
        notes: Vec<RuleNote>,
    },
    /// The minimum D15F is raised.
    Raised,
    /// The maximum D15F is lowered.
    Lowered,
    /// Internal stability of a side.
    Stability {
        /// `fine` or `coarse`.
        side: String,
        /// Whether both indices are known.
        is_known: bool,
        /// Whose rules it does not keep.
        not_kept: Vec<String>,
    },
}

/// Size of a band that enters a table of the maximum D90F. It is rounded down: a finer D10F allows no coarser
/// D90F.
pub const ENTERED_BY: &str = "minimum D10F";

/// A number of a step.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schemas", derive(schemars::JsonSchema))]
pub struct StepValue {
    /// What it is, as `maximum D15F`.
    pub name: String,
    /// The number; `None` where it is not known.
    pub value: Option<f64>,
    /// Its unit: `mm`, `%`; empty for a ratio or a count.
    pub unit: String,
}

impl StepValue {
    /// Side of a limit: `true` for a minimum, `false` for a maximum and for [`ENTERED_BY`]; `None` for any
    /// other value.
    pub fn role(&self) -> Option<bool> {
        match self.name.split(' ').next() {
            _ if self.name == ENTERED_BY => Some(false),
            Some("minimum") => Some(true),
            Some("maximum") => Some(false),
            _ => None,
        }
    }
}

/// Why there is no band.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schemas", derive(schemars::JsonSchema))]
#[serde(tag = "id", rename_all = "snake_case")]
pub enum NoBand {
    /// Of the minimum D15F only the most is known, and it is above the maximum.
    DrainageNotKnown {
        /// The most that the minimum can be (mm).
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
    /// The maximum D60F lies beyond the greatest size.
    TooCoarse {
        /// The maximum D60F (mm).
        most_d60f_mm: f64,
    },
    /// The maximum D15F of a curve is not known.
    LimitNotKnown {
        /// The curve of the base.
        curve: String,
        /// What is missing.
        needs: Vec<RuleNote>,
    },
    /// No rule of retention covers the base.
    NoRule,
}

/// A standard product beside a specification. A row of `specification_products.csv`.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schemas", derive(schemars::JsonSchema))]
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
    pub not_kept: Vec<NotKept>,
    /// Where its limits were read.
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

    /// The smaller of the two margins.
    fn margin(&self) -> f64 {
        self.drains_by.unwrap_or(f64::INFINITY).min(self.holds_by.unwrap_or(f64::INFINITY))
    }
}

impl Specification {
    /// The product whose D15 comes closest to both limits, if no product fits.
    pub fn nearest_product(&self) -> Option<&ProductMargin> {
        let none_fits = self.products.iter().all(|product| product.fits() == Some(false));
        let all = self.products.iter().filter(|_| none_fits && self.d15f_max_mm.is_some());
        all.max_by(|a, b| a.margin().total_cmp(&b.margin()))
    }

    /// The curve that sets the maximum D15F, and this D15F (mm); `None` if it is not known.
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

/// Compares every standard product with the minimum D15F (mm), with the least that it certainly is, and with
/// the maximum.
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
            // The true margin may be greater without limit.
            drains_by: d15f_min.map(|least| fine / least).filter(|margin| *margin >= 1.0 || fine < certain),
            holds_by: d15f_max.map(|greatest| greatest / coarse),
            not_kept: product.not_kept(),
            source: product.source.into(),
        }
    };
    PRODUCTS.iter().map(one).collect()
}

/// A note on a row of boundaries, or on a curve of the base for which a filter is specified.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schemas", derive(schemars::JsonSchema))]
pub struct RowNote {
    /// The row or the curve that it is of, in words; `None` where it is of all.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub row: Option<String>,
    /// The note.
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
        // D15 0.178 to 0.424 mm (see `products`).
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
        // Drainage is not known if the minimum is only known to be at most a number.
        let till = &margins((Some(0.375), 0.0), Some(0.7))[0];
        assert_eq!((till.drains_by, till.fits()), (None, None));
        assert_eq!(margins((Some(0.375), 0.0), Some(0.3))[0].fits(), Some(false));
    }
}
