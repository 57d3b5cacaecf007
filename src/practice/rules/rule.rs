//! A rule and its inputs.

use super::base::BaseSoil;
use crate::{RuleNote, RuleQuantity, RuleRole, RuleUnit, ValueBound, WithoutFiner};
use voidwalk_core::gradation::Gradation;

/// A rule of practice, an entry of the table [`super::RULES`].
pub struct FilterRule {
    /// Name in `outcome.json` and in `voidwalk rules --json`.
    pub id: &'static str,
    /// Author as sentences cite it; empty if nobody is cited.
    pub authority: &'static str,
    /// Further authorities whose texts state the rule.
    pub stated_by: &'static [&'static str],
    /// Statement of the rule.
    pub says: &'static str,
    /// Role of the rule.
    pub role: RuleRole,
    /// Soils that the rule was made for.
    pub applies_to: &'static str,
    /// Quantity that the rule limits. A rule of retention also limits a design if [`RuleQuantity`] has a case
    /// for it.
    pub quantity: RuleQuantity,
    /// Limit in words.
    pub formula: &'static str,
    /// True if the limit is the least allowed, false if it is the most.
    pub at_least: bool,
    /// Unit of value and limit; sizes in mm also mean multiples of D0F.
    pub unit: RuleUnit,
    /// Source of the rule.
    pub source: &'static str,
    /// Curves that the rule reads if a soil has several.
    pub pairing: Pairing,
    /// Function that judges the rule.
    pub judge: fn(&RuleInputs) -> Judged,
}

impl FilterRule {
    /// Name for a reader: author and statement.
    pub fn name(&self) -> String {
        match self.authority {
            "" => self.says.into(),
            authority => format!("{authority}: {}", self.says),
        }
    }
}

/// Curves that a rule reads if a soil is an envelope of several.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Pairing {
    /// Every curve of the filter with every curve of the base; the worst pair counts.
    EachPair,
    /// Every curve of the filter; the worst of them counts.
    EachFilter,
    /// All curves of the filter at once.
    AllFilters,
}

/// Result of a rule for two soils.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Judged {
    /// True if the rule was made for these soils.
    pub applies: bool,
    /// Value for these soils.
    pub value: Option<f64>,
    /// Side on which the true value lies, if the value is a bound.
    pub value_bound: Option<ValueBound>,
    /// Limit for these soils.
    pub limit: Option<f64>,
    /// True if the true limit is not known, and is at most `limit`.
    pub limit_at_most: bool,
    /// Result, if it does not follow from value and limit.
    pub met: Option<bool>,
    /// Input that is missing for a result.
    pub needs: Option<RuleNote>,
    /// Notes for a reader.
    pub notes: Vec<RuleNote>,
    /// Remainder of the filter without the greatest part that it may lose by this rule.
    pub without_finer: Option<WithoutFiner>,
    /// True if nobody asked for the rule: it is not listed.
    pub is_left_out: bool,
}

impl Judged {
    /// A rule that applies, with its value and limit if they are known.
    pub fn of(value: Option<f64>, limit: Option<f64>) -> Self {
        Self { applies: true, value, limit, ..Self::default() }
    }

    /// Marks the limit as an upper bound of the true one.
    pub fn at_most(self) -> Self {
        Self { limit_at_most: true, ..self }
    }

    /// Marks the value as a bound of the true one.
    pub fn bound(self, side: ValueBound) -> Self {
        Self { value_bound: Some(side), ..self }
    }

    /// Adds a note, if there is one.
    pub fn noted(mut self, note: impl Into<Option<RuleNote>>) -> Self {
        self.notes.extend(note.into());
        self
    }

    /// Marks the rule as not made for these soils.
    pub fn not_for(self, why: RuleNote) -> Self {
        Self { applies: false, notes: vec![why], ..self }
    }

    /// A rule that nobody asked for.
    pub fn left_out() -> Self {
        Self { is_left_out: true, ..Self::default() }
    }

    /// Marks the rule as lacking an input.
    pub fn lacking(self, needs: RuleNote) -> Self {
        Self { needs: Some(needs), ..self }
    }
}

/// Inputs of the rules.
pub struct RuleInputs<'a> {
    /// The filter.
    pub filter: &'a Gradation,
    /// True for a sieve curve of the filter, false for an assumed straight line.
    pub filter_is_measured: bool,
    /// The base as sampled.
    pub base: &'a Gradation,
    /// The base as walked.
    pub walked_base: &'a Gradation,
    /// The base as practice describes it.
    pub base_soil: BaseSoil,
    /// True if sizes are multiples of D0F instead of mm.
    pub scale_free: bool,
    /// Every curve of the filter if it is an envelope of several; empty otherwise.
    pub filter_curves: Vec<&'a Gradation>,
    /// True if the base is a dispersive clay or silt.
    pub dispersive: bool,
    /// Width of an open joint at the exit (mm), if one is given.
    pub joint_mm: Option<f64>,
    /// Largest particle eroded in the first run over D15F, mean over replicates; `None` if nothing eroded, or
    /// nothing was walked.
    pub largest_eroded_over_d15f: Option<f64>,
}

impl<'a> RuleInputs<'a> {
    /// Inputs of two sieve curves in mm, without a walk.
    pub fn of_soils(base: &'a Gradation, filter: &'a Gradation) -> Self {
        Self::with_soil(base, BaseSoil::of(base, false), filter)
    }

    /// Inputs of a base that has already been described.
    pub(crate) fn with_soil(base: &'a Gradation, base_soil: BaseSoil, filter: &'a Gradation) -> Self {
        Self {
            filter,
            filter_is_measured: true,
            base,
            walked_base: base,
            base_soil,
            scale_free: false,
            filter_curves: Vec::new(),
            dispersive: false,
            joint_mm: None,
            largest_eroded_over_d15f: None,
        }
    }

    /// Copies the inputs, for changes.
    pub(super) fn same(&self) -> RuleInputs<'_> {
        RuleInputs { filter_curves: self.filter_curves.clone(), base_soil: self.base_soil.clone(), ..*self }
    }

    /// D15 of the filter for a rule that it may not exceed: the coarse end of a flat curve.
    pub fn coarse_d15f(&self) -> Option<f64> {
        self.filter.coarse_d(15.0)
    }

    /// D15 of the filter.
    pub fn d15f(&self) -> Option<f64> {
        self.filter.d(15.0)
    }

    /// A size of the base after regrading, or the greatest that it can be if it lies in the finest tail or if
    /// the part that practice looks at does.
    pub fn size_of_base(&self, percent: f64) -> SizeBound {
        let soil = &self.base_soil;
        match (soil.hidden_below_mm, soil.gradation.d(percent)) {
            (Some(most), _) => SizeBound { most, is_known: false },
            (None, Some(size)) => SizeBound { most: size, is_known: true },
            (None, None) => SizeBound { most: soil.gradation.smallest_mm(), is_known: false },
        }
    }

    /// Fines of the base; sizes without a unit belong to a sand without fines.
    pub fn fines(&self) -> Fines {
        match (self.scale_free, self.base_soil.fines_percent) {
            (true, _) => Fines::Assumed,
            (_, Some(percent)) => Fines::Percent(percent),
            (_, None) if self.base_soil.category == Some(4) => Fines::Few,
            _ => Fines::Unknown,
        }
    }
}

/// A size of a base, or the greatest that it can be.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SizeBound {
    /// The size, or the greatest that it can be.
    pub most: f64,
    /// True if the size is known.
    pub is_known: bool,
}

/// Knowledge of the fines of a base.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Fines {
    /// Fines (%).
    Percent(f64),
    /// Less than 15 %, the exact percent being unknown.
    Few,
    /// Sizes have no unit: a sand without fines is assumed.
    Assumed,
    /// Not known: the finest sieve is too coarse.
    Unknown,
}
