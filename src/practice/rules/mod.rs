//! Rules of filter practice, applied to the two curves of the walk and shown beside the verdict.
//!
//! Each rule is an entry of [`RULES`]: its purpose, soils, limit and source. A rule that lacks an input
//! names it; a rule that was not made for these soils has no result.

mod all;
mod drainage;
mod open;
mod retention;
mod rule;
mod stability;

#[cfg(test)]
mod tests;

use crate::{AppliedRule, RuleUnit, WithoutFiner};
use open::{OpenFilter, judged_over};
use rule::{Judged, Pairing, margin};
use voidwalk_core::gradation::Gradation;

pub(crate) use all::{CONSTRICTED_EXIT, KENNEY_LAU, KEZDI, LI_FANNIN};
pub use all::{
    DESIGN, FILTER_FINES, FILTER_GREATEST_SIZE, PERMEABILITY, PERMEABILITY_LEAST, RULES, TERZAGHI,
    TESTS_CONTINUING, TESTS_NO_EROSION,
};
pub use drainage::{GREATEST_SIZE_MM, LEAST_D15F_MM, MOST_CU, MOST_FINES_PERCENT, WIDEST_BAND};
pub(crate) use open::{OpenBase, sieved_limit};
pub use retention::{DESIGN_FLOOR_MM, range_of_tests, tested_range};
pub(crate) use rule::FilterRule;
pub use rule::{BaseSoil, RuleInputs, broad_base};

/// Applies all rules to these inputs.
pub fn apply(inputs: &RuleInputs) -> Vec<AppliedRule> {
    let base = OpenBase::of(inputs.base, inputs.scale_free);
    let filter = OpenFilter::of(inputs.filter, inputs.filter_is_measured);
    let applied =
        |rule: &FilterRule| Some(record(rule, inputs.scale_free, judged_over(rule, inputs, &base, &filter)?));
    RULES.iter().filter_map(applied).collect()
}

/// Author of a rule as a sentence cites it; the rule's name if nobody is cited.
pub fn authority(rule: &AppliedRule) -> &str {
    if rule.authority.is_empty() { &rule.name } else { &rule.authority }
}

/// Author without the year of the source, which the table of rules gives.
pub fn authority_in_brief(rule: &AppliedRule) -> &str {
    authority(rule).split(" (").next().unwrap_or_default()
}

/// Curve of a soil with its name.
pub type NamedCurve = (String, Gradation);

/// Applies every rule to one or more curves of a filter and of a base. The curves that keep a rule worst
/// count, and the result names them. Also returns the indices of the filter and of the base that keep the
/// limit of design worst, and this base as practice describes it.
pub(crate) fn apply_and_decide(
    bases: &[NamedCurve],
    filters: &[NamedCurve],
    dispersive: bool,
    joint_mm: Option<f64>,
) -> (Vec<AppliedRule>, [usize; 2], BaseSoil) {
    let mut soils: Vec<BaseSoil> = bases.iter().map(|(_, base)| BaseSoil::of(base, false)).collect();
    let open_bases: Vec<OpenBase> = bases.iter().map(|(_, base)| OpenBase::of(base, false)).collect();
    let open_filters: Vec<OpenFilter> =
        filters.iter().map(|(_, filter)| OpenFilter::of(filter, true)).collect();
    let every: Vec<&Gradation> = filters.iter().map(|(_, curve)| curve).collect();
    let inputs = |filter: usize, base: usize| RuleInputs {
        filter_curves: if filters.len() > 1 { every.clone() } else { Vec::new() },
        dispersive,
        joint_mm,
        ..RuleInputs::with_soil(&bases[base].1, soils[base].clone(), &filters[filter].1)
    };
    let mut worst: Vec<Option<Worst>> = RULES.iter().map(|_| None).collect();
    // Among equal results the finest base is named.
    let d85b = |base: &usize| soils[*base].gradation.d(85.0).unwrap_or(0.0);
    let mut finest_first: Vec<usize> = (0..bases.len()).collect();
    finest_first.sort_by(|a, b| d85b(a).total_cmp(&d85b(b)));
    let places = finest_first.iter().flat_map(|&base| (0..filters.len()).map(move |filter| (filter, base)));
    for (filter, base) in places {
        let inputs = inputs(filter, base);
        for (rule, worst) in RULES.iter().zip(&mut worst) {
            let is_read = match rule.pairing {
                Pairing::EachPair => true,
                Pairing::EachFilter => base == 0,
                Pairing::AllFilters => [filter, base] == [0, 0],
            };
            let over = || judged_over(rule, &inputs, &open_bases[base], &open_filters[filter]);
            if let Some(judged) = is_read.then(over).flatten() {
                Worst::count(worst, rule, judged, [filter, base]);
            }
        }
    }
    let name = |curves: &[NamedCurve], at: usize| match curves.len() {
        1 => String::new(),
        _ => curves[at].0.clone(),
    };
    let decides = RULES.iter().zip(&worst).find(|(rule, _)| rule.id == DESIGN);
    let at = decides.and_then(|(_, worst)| worst.as_ref()).map_or([0, 0], |worst| worst.at);
    let named = |(rule, worst): (&FilterRule, Option<Worst>)| {
        let worst = worst?;
        let [filter, base] = worst.at;
        let applied = record(rule, false, worst.into_judged(rule));
        let [filter_curve, base_curve] = match rule.pairing {
            Pairing::EachPair => [name(filters, filter), name(bases, base)],
            Pairing::EachFilter => [name(filters, filter), String::new()],
            Pairing::AllFilters => Default::default(),
        };
        Some(AppliedRule { filter_curve, base_curve, ..applied })
    };
    (RULES.iter().zip(worst).filter_map(named).collect(), at, soils.swap_remove(at[1]))
}

/// Worst result of a rule among curves.
struct Worst {
    judged: Judged,
    margin: (u8, f64, f64),
    /// Lowest limit of all pairs.
    least: f64,
    /// Coarsest remainder of any curve without its finer part: any curve may be delivered.
    lost: Option<WithoutFiner>,
    /// Indices of filter and base.
    at: [usize; 2],
}

impl Worst {
    /// Counts one more pair; among equal results the first remains.
    fn count(worst: &mut Option<Self>, rule: &FilterRule, judged: Judged, at: [usize; 2]) {
        let margin = margin(rule, &judged);
        let limit = judged.limit.filter(|_| judged.applies).unwrap_or(f64::INFINITY);
        let lost = judged.without_finer.filter(|_| judged.met == Some(false));
        let Some(before) = worst else {
            *worst = Some(Self { judged, margin, least: limit, lost, at });
            return;
        };
        let both = [before.lost, lost].into_iter().flatten();
        before.least = before.least.min(limit);
        before.lost = both.max_by(|a, b| a.d15f.total_cmp(&b.d15f));
        // Among equal results the coarser base, which comes later, must be drained.
        if margin < before.margin
            || rule.at_least && rule.pairing == Pairing::EachPair && margin == before.margin
        {
            (before.judged, before.margin, before.at) = (judged, margin, at);
        }
    }

    /// Result of the envelope by this rule.
    fn into_judged(self, rule: &FilterRule) -> Judged {
        let Self { mut judged, least, lost, .. } = self;
        judged.without_finer = lost.or(judged.without_finer);
        // If one curve leaves the limit open, it is at most another curve's limit.
        let is_lower = judged.limit.is_some_and(|limit| least < limit);
        if judged.applies && judged.met.is_none() && is_lower && !rule.at_least {
            (judged.limit, judged.limit_at_most) = (Some(least), true);
        }
        judged
    }
}

fn record(rule: &FilterRule, scale_free: bool, judged: Judged) -> AppliedRule {
    AppliedRule {
        id: rule.id.into(),
        name: rule.name(),
        authority: rule.authority.into(),
        stated_by: rule.stated_by.iter().map(|name| (*name).into()).collect(),
        role: rule.role,
        applies: judged.applies,
        quantity: rule.quantity.clone(),
        value: judged.value,
        value_bound: judged.value_bound,
        limit: judged.limit,
        unit: match rule.unit {
            RuleUnit::Mm if scale_free => RuleUnit::D0f,
            unit => unit,
        },
        at_least: rule.at_least,
        limit_at_most: judged.limit_at_most,
        met: judged.met,
        needs: judged.needs.into_iter().collect(),
        notes: judged.notes,
        applies_to: rule.applies_to.into(),
        formula: rule.formula.into(),
        source: rule.source.into(),
        without_finer: judged.without_finer,
        filter_curve: String::new(),
        base_curve: String::new(),
    }
}
