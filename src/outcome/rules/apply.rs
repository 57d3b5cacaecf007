//! Every rule, applied to two soils, or to two envelopes of curves.

use std::cmp::Ordering::Equal;

use super::all::RULES;
use super::authority::Authority;
use super::base::BaseSoil;
use super::rule::{FilterRule, Pairing, RuleInputs, RuleUnit};
use crate::gradation::Gradation;
use crate::outcome::applied::{AppliedRule, ValueBound};
use crate::outcome::rule_note::RuleText;

/// Applies every rule.
pub fn apply(inputs: &RuleInputs) -> Vec<AppliedRule> {
    RULES.iter().filter_map(|rule| applied(rule, inputs)).collect()
}

/// Whose rule it is, as a sentence cites it; its name where nobody is cited.
pub fn authority(rule: &AppliedRule) -> &str {
    // Files of earlier versions have the name alone.
    let listed = || RULES.iter().find(|of| of.id == rule.id).map_or("", |of| of.authority);
    let known = [rule.authority.as_str(), listed()];
    known.into_iter().find(|of| !of.is_empty()).unwrap_or(&rule.name)
}

/// The same without the year of its source, which stands in the table of rules.
pub(crate) fn authority_in_brief(rule: &AppliedRule) -> &str {
    authority(rule).split(" (").next().unwrap_or_default()
}

/// Whether an authority states a rule, by the rule's own entry in [`RULES`]. All authorities together state
/// every rule.
///
/// ```
/// use voidwalk::Gradation;
/// use voidwalk::outcome::rules::{Authority, RuleInputs, apply, is_stated_by};
/// let filter = Gradation::from_points(&[(0.5, 0.0), (2.0, 100.0)], None)?;
/// let base = Gradation::from_points(&[(0.08, 0.0), (0.3, 100.0)], None)?;
/// let rules = apply(&RuleInputs::of_soils(&base, &filter));
/// let find = |id: &str| rules.iter().find(|rule| rule.id == id).unwrap();
/// let is_of_nrcs = |id: &str| is_stated_by(find(id), Authority::Nrcs);
/// assert!(is_of_nrcs("permeability") && !is_of_nrcs("foster-fell-continuing"));
/// # Ok::<(), voidwalk::gradation::GradationError>(())
/// ```
pub fn is_stated_by(rule: &AppliedRule, by: Authority) -> bool {
    let entry = || RULES.iter().find(|of| of.id == rule.id);
    by == Authority::All || entry().is_some_and(|of| of.stated_by.contains(&by))
}

/// A curve of a soil, with its name.
pub type NamedCurve = (String, Gradation);

/// Which curves of a filter and a base are their finest and coarsest.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Sides {
    /// The filter with the minimum D15F.
    pub finest_filter: usize,
    /// The filter with the maximum D15F.
    pub coarsest_filter: usize,
    /// The base with the minimum D85B after regrading.
    pub finest_base: usize,
    /// The base with the maximum D15B before regrading.
    pub coarsest_base: usize,
}

impl Sides {
    /// Of these curves, of which there is at least one each. A size in a finest tail is finer than any.
    pub fn of(bases: &[NamedCurve], filters: &[NamedCurve]) -> Self {
        let sizes = |curves: &[NamedCurve], size: &dyn Fn(&Gradation) -> Option<f64>| -> Vec<f64> {
            curves.iter().map(|(_, curve)| size(curve).unwrap_or(0.0)).collect()
        };
        let d15f = sizes(filters, &|curve| curve.d(15.0));
        let d85b = sizes(bases, &|curve| BaseSoil::of(curve, false).gradation.d(85.0));
        let d15b = sizes(bases, &|curve| curve.d(15.0));
        let least = |sizes: &[f64]| (0..sizes.len()).min_by(|&a, &b| sizes[a].total_cmp(&sizes[b]));
        // The first of equals, as for the least.
        let most = |sizes: &[f64]| (0..sizes.len()).rev().max_by(|&a, &b| sizes[a].total_cmp(&sizes[b]));
        Self {
            finest_filter: least(&d15f).unwrap_or(0),
            coarsest_filter: most(&d15f).unwrap_or(0),
            finest_base: least(&d85b).unwrap_or(0),
            coarsest_base: most(&d15b).unwrap_or(0),
        }
    }
}

/// Applies every rule to the curves of a filter and of a base: each to those that it is for, named by
/// them.
pub fn apply_to_envelopes(
    bases: &[NamedCurve],
    filters: &[NamedCurve],
    dispersive: bool,
    joint_mm: Option<f64>,
) -> Vec<AppliedRule> {
    let sides = Sides::of(bases, filters);
    let every: Vec<&Gradation> = filters.iter().map(|(_, curve)| curve).collect();
    let inputs = |filter: usize, base: usize| RuleInputs {
        filter_curves: if filters.len() > 1 { every.clone() } else { Vec::new() },
        dispersive,
        joint_mm,
        ..RuleInputs::of_soils(&bases[base].1, &filters[filter].1)
    };
    let name = |curves: &[NamedCurve], at: usize| match curves.len() {
        1 => String::new(),
        _ => curves[at].0.clone(),
    };
    let one = |rule: &FilterRule, filter: usize, base: usize| {
        let applied = applied(rule, &inputs(filter, base))?;
        let of_both = rule.pairing != Pairing::EachFilter;
        let base_curve = if of_both { name(bases, base) } else { String::new() };
        Some(AppliedRule { filter_curve: name(filters, filter), base_curve, ..applied })
    };
    let of = |rule: &FilterRule| match rule.pairing {
        Pairing::CoarseFilterFineBase => one(rule, sides.coarsest_filter, sides.finest_base),
        Pairing::FineFilterCoarseBase => one(rule, sides.finest_filter, sides.coarsest_base),
        Pairing::EachFilter => {
            let each = (0..filters.len()).filter_map(|filter| one(rule, filter, sides.finest_base));
            let each: Vec<AppliedRule> = each.collect();
            let left = each.iter().filter(|of| of.is_broken()).filter_map(|of| of.without_finer);
            let coarsest = left.max_by(|a, b| a.d15f.total_cmp(&b.d15f));
            let worst = each.into_iter().min_by(|a, b| margin(a).partial_cmp(&margin(b)).unwrap_or(Equal))?;
            // Any curve of the envelope may be delivered, and be left without its finer part.
            Some(AppliedRule { without_finer: coarsest.or(worst.without_finer), ..worst })
        }
    };
    RULES.iter().filter_map(of).collect()
}

/// How well a rule is kept: the worst first.
fn margin(rule: &AppliedRule) -> (u8, f64) {
    let class = match (rule.met, rule.applies) {
        (Some(false), _) => 0,
        (None, true) => 1,
        (Some(true), _) => 2,
        (None, false) => 3,
    };
    let over = match (rule.value, rule.limit) {
        (Some(value), Some(limit)) if rule.at_least => value / limit,
        (Some(value), Some(limit)) => limit / value,
        (Some(value), None) => -value,
        _ => 0.0,
    };
    (class, over)
}

/// One rule, applied; `None` where nobody asked for it.
fn applied(rule: &FilterRule, inputs: &RuleInputs) -> Option<AppliedRule> {
    let judged = (rule.judge)(inputs);
    if judged.is_left_out {
        return None;
    }
    let keeps = |(value, limit): (f64, f64)| if rule.at_least { value >= limit } else { value <= limit };
    let met = judged.met.or_else(|| judged.value.zip(judged.limit).map(keeps));
    // A limit that can only be less is broken for certain, or kept for certain where it is the least allowed.
    let met = met.filter(|met| !judged.limit_at_most || *met == rule.at_least || judged.met.is_some());
    let value_bound = judged.value_bound.filter(|_| judged.value.is_some());
    // So is one of whose value only a bound is known: met where the bound itself meets it, or broken by it.
    let is_surely = |bound: ValueBound| (bound == ValueBound::AtMost) != rule.at_least;
    let met = met.filter(|met| value_bound.is_none_or(|bound| *met == is_surely(bound)));
    Some(AppliedRule {
        id: rule.id.into(),
        name: rule.name(),
        authority: rule.authority.into(),
        role: rule.role,
        applies: judged.applies,
        quantity: rule.quantity.clone(),
        value: judged.value,
        value_bound,
        limit: judged.limit,
        unit: match rule.unit {
            RuleUnit::Size if inputs.scale_free => "D0F".into(),
            RuleUnit::Size => "mm".into(),
            RuleUnit::One => String::new(),
            RuleUnit::Percent => "%".into(),
        },
        at_least: rule.at_least,
        limit_at_most: judged.limit_at_most,
        met: met.filter(|_| judged.applies),
        needs: RuleText::Of(judged.needs.into_iter().collect()),
        note: RuleText::Of(judged.notes),
        applies_to: rule.applies_to.into(),
        formula: rule.formula.into(),
        source: rule.source.into(),
        without_finer: judged.without_finer,
        speaks_against: rule.role.speaks_against().into(),
        filter_curve: String::new(),
        base_curve: String::new(),
    })
}
