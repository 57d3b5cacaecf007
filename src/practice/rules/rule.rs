//! Rule, its inputs and its result, and the base as practice describes it.

use crate::{Note, RuleNote, RuleQuantity, RuleRole, RuleUnit, ValueBound, WithoutFiner};
use voidwalk_core::gradation::{
    BROAD_CU, FEW_FINES, FINES_MM, Gradation, RegradeCause, RegradeReason, Regraded, TIE,
};

/// A rule of practice, an entry of the table [`super::RULES`].
pub struct FilterRule {
    /// Name in `outcome.json` and in `voidwalk rules --json`.
    pub id: &'static str,
    /// Author as sentences cite it; empty if nobody is cited.
    pub(crate) authority: &'static str,
    /// Further authorities whose texts state the rule.
    pub(crate) stated_by: &'static [&'static str],
    pub(crate) says: &'static str,
    pub(crate) role: RuleRole,
    /// Soils that the rule was made for.
    pub(crate) applies_to: &'static str,
    /// Quantity that the rule limits. A rule of retention also limits a design if [`RuleQuantity`] has a
    /// variant for its quantity.
    pub(crate) quantity: &'static RuleQuantity,
    /// Limit in words.
    pub(crate) formula: &'static str,
    /// True if the limit is a minimum, false if it is a maximum.
    pub(crate) at_least: bool,
    /// Unit of value and limit; mm also means multiples of D0F.
    pub(crate) unit: RuleUnit,
    /// Source of the rule.
    pub source: &'static str,
    pub(super) pairing: Pairing,
    pub(super) judge: fn(&RuleInputs) -> Judged,
}

impl FilterRule {
    /// Name for readers: author and statement.
    pub fn name(&self) -> String {
        match self.authority {
            "" => self.says.into(),
            authority => format!("{authority}: {}", self.says),
        }
    }
}

/// Curves that a rule reads if a soil is an envelope of several.
#[derive(Clone, Copy, PartialEq)]
pub(super) enum Pairing {
    /// Every curve of the filter with every curve of the base; the worst pair counts.
    EachPair,
    /// Every curve of the filter; the worst one counts.
    EachFilter,
    /// All curves of the filter at once.
    AllFilters,
}

/// Result of a rule for two soils.
#[derive(Clone, Default)]
pub(super) struct Judged {
    /// True if the rule was made for these soils.
    pub(crate) applies: bool,
    pub(crate) value: Option<f64>,
    /// Side on which the true value lies, if the value is a bound.
    pub(crate) value_bound: Option<ValueBound>,
    pub(crate) limit: Option<f64>,
    /// True if the limit is not known exactly and is at most `limit`.
    pub(crate) limit_at_most: bool,
    /// Result if it does not follow from value and limit.
    pub(crate) met: Option<bool>,
    /// Input missing for a result.
    pub(crate) needs: Option<RuleNote>,
    pub(crate) notes: Vec<RuleNote>,
    /// Remainder of the filter without the largest part that it may lose by this rule.
    pub(crate) without_finer: Option<WithoutFiner>,
    /// True if the rule was not requested; it is not listed.
    pub(crate) is_left_out: bool,
}

impl Judged {
    /// Rule that applies, with its value and limit if known.
    pub(crate) fn of(value: Option<f64>, limit: Option<f64>) -> Self {
        Self { applies: true, value, limit, ..Self::default() }
    }

    /// Marks the limit as an upper bound of the true one.
    pub(crate) fn at_most(self) -> Self {
        Self { limit_at_most: true, ..self }
    }

    /// Marks the value as a bound of the true one.
    pub(crate) fn bound(self, side: ValueBound) -> Self {
        Self { value_bound: Some(side), ..self }
    }

    pub(crate) fn noted(mut self, note: impl Into<Option<RuleNote>>) -> Self {
        self.notes.extend(note.into());
        self
    }

    /// Marks the rule as not made for these soils.
    pub(crate) fn not_for(self, why: RuleNote) -> Self {
        Self { applies: false, notes: vec![why], ..self }
    }

    /// Rule that was not requested.
    pub(crate) fn left_out() -> Self {
        Self { is_left_out: true, ..Self::default() }
    }

    /// Marks the rule as lacking an input.
    pub(crate) fn lacking(self, needs: RuleNote) -> Self {
        Self { needs: Some(needs), ..self }
    }
}

/// Inputs of the rules.
pub struct RuleInputs<'a> {
    /// Gradation of the filter.
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
    /// Largest particle eroded in the first run over D15F, mean over replicates; `None` if nothing eroded
    /// or no walk was made.
    pub largest_eroded_over_d15f: Option<f64>,
}

impl<'a> RuleInputs<'a> {
    /// Inputs for two sieve curves in mm, without a walk.
    pub fn of_soils(base: &'a Gradation, filter: &'a Gradation) -> Self {
        Self::with_soil(base, BaseSoil::of(base, false), filter)
    }

    /// Inputs for a base that was already described.
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

    /// Copies the inputs so that fields can be replaced.
    pub(super) fn same(&self) -> RuleInputs<'_> {
        RuleInputs { filter_curves: self.filter_curves.clone(), base_soil: self.base_soil.clone(), ..*self }
    }

    /// D15 of the filter for a rule that sets its maximum: the coarse end of a flat curve.
    pub(super) fn coarse_d15f(&self) -> Option<f64> {
        self.filter.coarse_d(15.0)
    }

    pub(super) fn d15f(&self) -> Option<f64> {
        self.filter.d(15.0)
    }

    /// Size of the base after regrading, or its upper bound if the size is finer than the finest sieve or
    /// no sieve lies in the part that practice uses.
    pub(crate) fn size_of_base(&self, percent: f64) -> SizeBound {
        let soil = &self.base_soil;
        match (soil.hidden_below_mm, soil.gradation.d(percent)) {
            (Some(most), _) => SizeBound { most, is_known: false },
            (None, Some(size)) => SizeBound { most: size, is_known: true },
            (None, None) => SizeBound { most: soil.gradation.smallest_mm(), is_known: false },
        }
    }

    /// Fines of the base; a base whose sizes have no unit is taken as a sand without fines.
    pub(super) fn fines(&self) -> Fines {
        match (self.scale_free, self.base_soil.fines_percent) {
            (true, _) => Fines::Assumed,
            (_, Some(percent)) => Fines::Percent(percent),
            (_, None) if self.base_soil.category == Some(4) => Fines::Few,
            _ => Fines::Unknown,
        }
    }
}

/// Size of a base, or its upper bound.
pub(crate) struct SizeBound {
    pub(crate) most: f64,
    pub(crate) is_known: bool,
}

/// Knowledge of the fines of a base.
pub(super) enum Fines {
    /// Fines in percent.
    Percent(f64),
    /// Less than 15 %; the exact percent is not known.
    Few,
    /// Sizes have no unit: a sand without fines is assumed.
    Assumed,
    /// The finest sieve is too coarse to give the fines.
    Unknown,
}

/// Margin by which a rule is kept, worst first.
pub(super) fn margin(rule: &FilterRule, judged: &Judged) -> (u8, f64, f64) {
    // A boundary of erosion that tests did not identify excludes less than one that is not reached.
    let is_open = judged.applies || judged.needs.is_some() || rule.role == RuleRole::Continuation;
    let class = match judged.met {
        Some(false) => 0,
        None if is_open => 1,
        Some(true) => 2,
        None => 3,
    };
    let over = match (judged.value, judged.limit) {
        (Some(value), Some(limit)) if rule.at_least => value / limit,
        (Some(value), Some(limit)) => limit / value,
        (Some(value), None) => -value,
        _ => 0.0,
    };
    (class, over, judged.limit.filter(|_| !rule.at_least).unwrap_or(f64::INFINITY))
}

/// Judges one rule; `None` if it was not requested.
pub(super) fn judged(rule: &FilterRule, inputs: &RuleInputs) -> Option<Judged> {
    let judged = (rule.judge)(inputs);
    if judged.is_left_out {
        return None;
    }
    let keeps = |(value, limit): (f64, f64)| {
        if rule.at_least { value >= limit * (1.0 - TIE) } else { value <= limit * (1.0 + TIE) }
    };
    let met = judged.met.or_else(|| judged.value.zip(judged.limit).map(keeps));
    // A broken upper bound of a maximum, or a kept upper bound of a minimum, settles the result.
    let met = met.filter(|met| !judged.limit_at_most || *met == rule.at_least || judged.met.is_some());
    let value_bound = judged.value_bound.filter(|_| judged.value.is_some());
    // A value that is only a bound decides if the bound itself meets or breaks the limit.
    let is_surely = |bound: ValueBound| (bound == ValueBound::AtMost) != rule.at_least;
    let met = met.filter(|met| value_bound.is_none_or(|bound| *met == is_surely(bound)));
    let met = met.filter(|_| judged.applies);
    Some(Judged { value_bound, met, ..judged })
}

/// A base soil as practice describes it.
#[derive(Clone, Debug, PartialEq)]
pub struct BaseSoil {
    /// The soil after regrading, or the soil itself without regrading.
    pub(crate) gradation: Gradation,
    /// Size on which the soil was regraded (mm).
    pub(crate) regraded_at_mm: Option<f64>,
    /// Reason for regrading or not.
    pub(crate) why: RegradeReason,
    /// Size (mm) below which practice uses the soil, if no sieve gives the sizes there; it is their upper
    /// bound.
    pub(crate) hidden_below_mm: Option<f64>,
    /// Percent finer than 0.075 mm after regrading; `None` if the finest sieve is coarser and leaves a tail.
    pub(crate) fines_percent: Option<f64>,
    /// NRCS category after regrading, 1 to 4: more than 85 %, 40 to 85 %, 15 to 40 %, less than 15 %
    /// fines; `None` if the fines are not known closely enough.
    pub(crate) category: Option<u8>,
}

impl BaseSoil {
    /// Describes a base. If sizes are multiples of D0F there is no No. 4 or No. 200 sieve, so the base is
    /// kept as sampled, without a category. Other bases are regraded by [`Gradation::regraded`].
    pub fn of(base: &Gradation, scale_free: bool) -> Self {
        if scale_free {
            return Self {
                gradation: base.clone(),
                regraded_at_mm: None,
                why: RegradeReason { cause: RegradeCause::NoUnit, nothing_passes: false },
                hidden_below_mm: None,
                fines_percent: None,
                category: None,
            };
        }
        Self::regraded(base.regraded())
    }

    /// Describes a base regraded like another of its curves and, for a flat curve, also the other reading.
    pub(super) fn both(base: &Gradation, as_of: &Gradation) -> (Self, Option<Self>) {
        let otherwise = base.regraded_otherwise(as_of).map(Self::regraded);
        (Self::regraded(base.regraded_as(as_of)), otherwise)
    }

    fn regraded(regraded: Regraded) -> Self {
        let Regraded { gradation, at_mm, why, hidden_below_mm } = regraded;
        let (at_most, is_known) = match hidden_below_mm {
            Some(below) => (100.0, below <= FINES_MM),
            None => (
                whole(gradation.percent_finer_by_mass(FINES_MM)),
                gradation.percent_finer_if_known(FINES_MM).is_some(),
            ),
        };
        let fines_percent = is_known.then_some(at_most);
        let category = match fines_percent {
            Some(percent) if percent > 85.0 => Some(1),
            Some(percent) if percent >= 40.0 => Some(2),
            Some(percent) if percent >= FEW_FINES => Some(3),
            Some(_) => Some(4),
            None => (at_most < FEW_FINES).then_some(4),
        };
        Self { gradation, regraded_at_mm: at_mm, why, hidden_below_mm, fines_percent, category }
    }
}

/// Rounds a percent to remove last digits that depend on how its curve was written.
fn whole(percent: f64) -> f64 {
    let whole = percent.round();
    if (percent - whole).abs() <= 100.0 * TIE { whole } else { percent }
}

/// Caution that a base is so broad as sampled that practice uses only its finer part. If D10 is finer
/// than the finest sieve, Cu is greater than with D10 at that sieve.
pub fn broad_base(sampled: &Gradation) -> Option<Note> {
    match sampled.cu() {
        Some(cu) => (cu >= BROAD_CU).then_some(Note::BroadBase { cu }),
        None => {
            let over_cu = sampled.d(60.0)? / sampled.smallest_mm();
            (over_cu >= BROAD_CU).then_some(Note::BroadBaseAtLeast { over_cu })
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn soil(points: &[(f64, f64)]) -> BaseSoil {
        BaseSoil::of(&Gradation::from_lines(points).unwrap(), false)
    }

    /// The till of the first trial: 35 % of the whole is finer than 0.075 mm, 92 % finer than 4.75 mm.
    #[test]
    fn fines_are_those_of_the_regraded_base() {
        let till = soil(&[(0.075, 35.0), (0.425, 60.0), (2.0, 82.0), (4.75, 92.0), (19.0, 100.0)]);
        assert_eq!(till.regraded_at_mm, Some(4.75));
        assert!((till.fines_percent.unwrap() - 35.0 / 0.92).abs() < 1e-9);
        assert_eq!(till.category, Some(3));
        // 12 % of the 80 % that pass No. 4 is 15 %: too many to count as few with certainty.
        let tail = soil(&[(0.3, 12.0), (1.0, 40.0), (4.75, 80.0), (9.5, 100.0)]);
        assert_eq!((tail.fines_percent, tail.category), (None, None));
    }

    #[test]
    fn categories_are_by_fines_after_regrading() {
        for (fines, category) in [(90.0, 1), (85.0, 2), (40.0, 2), (39.9, 3), (15.0, 3), (14.9, 4)] {
            let base = soil(&[(0.001, 0.0), (0.075, fines), (0.5, 100.0)]);
            assert_eq!(base.category, Some(category), "{fines}");
        }
        // A table that ends at 0.075 mm gives its fines; one that ends above gives an upper bound.
        assert_eq!(soil(&[(0.075, 38.0), (0.5, 100.0)]).fines_percent, Some(38.0));
        let few = soil(&[(0.2, 10.0), (0.5, 100.0)]);
        assert_eq!((few.fines_percent, few.category), (None, Some(4)));
        // Gravel alone.
        let broad = soil(&[(5.0, 0.0), (10.0, 10.0), (30.0, 40.0), (60.0, 60.0), (80.0, 100.0)]);
        assert_eq!((broad.regraded_at_mm, broad.category), (None, Some(4)));
    }
}
