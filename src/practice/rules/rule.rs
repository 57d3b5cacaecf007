//! What a rule is, and what it reads.

use super::base::BaseSoil;
use crate::{RuleNote, RuleQuantity, RuleRole, RuleUnit, ValueBound, WithoutFiner};
use voidwalk_core::gradation::Gradation;

/// A rule of practice, as it stands in the table of [`super::RULES`].
pub struct FilterRule {
    /// Its name in `outcome.json` and in `voidwalk rules --json`.
    pub id: &'static str,
    /// Whose rule it is, as sentences cite it; empty where nobody is cited.
    pub authority: &'static str,
    /// Authorities whose texts state it besides.
    pub stated_by: &'static [&'static str],
    /// What it says.
    pub says: &'static str,
    /// What it is a rule of.
    pub role: RuleRole,
    /// What it was made for.
    pub applies_to: &'static str,
    /// What it limits. A rule of retention also limits a design where [`RuleQuantity`] has a case for it.
    pub quantity: RuleQuantity,
    /// Its limit in words.
    pub formula: &'static str,
    /// Whether the limit is the least that it allows, and not the most.
    pub at_least: bool,
    /// The unit of value and limit; sizes in mm stand for multiples of D0F, too.
    pub unit: RuleUnit,
    /// Where it is published.
    pub source: &'static str,
    /// Which curves it reads where a soil has several.
    pub pairing: Pairing,
    /// Works it out.
    pub judge: fn(&RuleInputs) -> Judged,
}

impl FilterRule {
    /// Its name for a reader: whose it is, and what it says.
    pub fn name(&self) -> String {
        match self.authority {
            "" => self.says.into(),
            authority => format!("{authority}: {}", self.says),
        }
    }
}

/// Which curves a rule reads where a soil is an envelope of several.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Pairing {
    /// Every curve of the filter with every curve of the base; the worst pair counts.
    EachPair,
    /// Every curve of the filter; the worst of them counts.
    EachFilter,
    /// All curves of the filter at once.
    AllFilters,
}

/// What a rule finds for two soils.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Judged {
    /// Whether the rule was made for these soils.
    pub applies: bool,
    /// Its value here.
    pub value: Option<f64>,
    /// Which side of the value the true one lies on, where the value is a bound.
    pub value_bound: Option<ValueBound>,
    /// Its limit here.
    pub limit: Option<f64>,
    /// Whether the true limit is not known, and is at most `limit`.
    pub limit_at_most: bool,
    /// The result where it does not follow from value and limit.
    pub met: Option<bool>,
    /// What is missing for a result.
    pub needs: Option<RuleNote>,
    /// What else a reader must know.
    pub notes: Vec<RuleNote>,
    /// What is left of the filter without the greatest part that it may lose by this rule.
    pub without_finer: Option<WithoutFiner>,
    /// Whether nobody asked for it: it is not listed.
    pub is_left_out: bool,
}

impl Judged {
    /// A rule that applies, with its value and limit where they are known.
    pub fn of(value: Option<f64>, limit: Option<f64>) -> Self {
        Self { applies: true, value, limit, ..Self::default() }
    }

    /// The same where the limit is only the most that the true one can be.
    pub fn at_most(self) -> Self {
        Self { limit_at_most: true, ..self }
    }

    /// The same where the value is only a bound of the true one.
    pub fn bound(self, side: ValueBound) -> Self {
        Self { value_bound: Some(side), ..self }
    }

    /// The same with one more note, if there is one.
    pub fn noted(mut self, note: impl Into<Option<RuleNote>>) -> Self {
        self.notes.extend(note.into());
        self
    }

    /// The same for a rule that was not made for these soils.
    pub fn not_for(self, why: RuleNote) -> Self {
        Self { applies: false, notes: vec![why], ..self }
    }

    /// A rule that nobody asked for.
    pub fn left_out() -> Self {
        Self { is_left_out: true, ..Self::default() }
    }

    /// The same for a rule that lacks an input.
    pub fn lacking(self, needs: RuleNote) -> Self {
        Self { needs: Some(needs), ..self }
    }
}

/// What the rules read.
pub struct RuleInputs<'a> {
    /// The filter.
    pub filter: &'a Gradation,
    /// Whether the filter's curve is a sieve curve, and not a straight line that was assumed.
    pub filter_is_measured: bool,
    /// The base as it is.
    pub base: &'a Gradation,
    /// The base as it is walked.
    pub walked_base: &'a Gradation,
    /// The base as practice describes it.
    pub base_soil: BaseSoil,
    /// Whether sizes are multiples of D0F and not mm.
    pub scale_free: bool,
    /// Every curve of the filter, where it is an envelope of several; empty otherwise.
    pub filter_curves: Vec<&'a Gradation>,
    /// Whether the base is a dispersive clay or silt.
    pub dispersive: bool,
    /// Width of an open joint at the exit (mm), where one is asked about.
    pub joint_mm: Option<f64>,
    /// Largest particle eroded in the first run over D15F, mean over replicates; `None` where nothing eroded,
    /// or nothing was walked.
    pub largest_eroded_over_d15f: Option<f64>,
}

impl<'a> RuleInputs<'a> {
    /// Two sieve curves in mm, without a walk.
    pub fn of_soils(base: &'a Gradation, filter: &'a Gradation) -> Self {
        Self::with_soil(base, BaseSoil::of(base, false), filter)
    }

    /// The same of a base that was described already.
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

    /// The same inputs, to be changed.
    pub(super) fn same(&self) -> RuleInputs<'_> {
        RuleInputs { filter_curves: self.filter_curves.clone(), base_soil: self.base_soil.clone(), ..*self }
    }

    /// D15 of the filter for a rule that it may not exceed: where the curve is flat, its coarse end.
    pub fn coarse_d15f(&self) -> Option<f64> {
        self.filter.coarse_d(15.0)
    }

    /// D15 of the filter.
    pub fn d15f(&self) -> Option<f64> {
        self.filter.d(15.0)
    }

    /// A size of the base after regrading; where it lies in the finest tail, or what practice looks at does,
    /// the most that it can be.
    pub fn size_of_base(&self, percent: f64) -> SizeBound {
        let soil = &self.base_soil;
        match (soil.hidden_below_mm, soil.gradation.d(percent)) {
            (Some(most), _) => SizeBound { most, is_known: false },
            (None, Some(size)) => SizeBound { most: size, is_known: true },
            (None, None) => SizeBound { most: soil.gradation.smallest_mm(), is_known: false },
        }
    }

    /// The category of the base; sizes without a unit are those of a sand without fines.
    pub fn fines(&self) -> Fines {
        match (self.scale_free, self.base_soil.fines_percent) {
            (true, _) => Fines::Assumed,
            (_, Some(percent)) => Fines::Percent(percent),
            (_, None) if self.base_soil.category == Some(4) => Fines::Few,
            _ => Fines::Unknown,
        }
    }
}

/// A size of a base, or the most that it can be.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SizeBound {
    /// The size, or the most that it can be.
    pub most: f64,
    /// Whether it is that size.
    pub is_known: bool,
}

/// What is known of the fines of a base.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Fines {
    /// Their share (%).
    Percent(f64),
    /// Less than 15 %, however much exactly.
    Few,
    /// Sizes have no unit: a sand without fines is assumed.
    Assumed,
    /// Not known: the finest sieve is too coarse.
    Unknown,
}
