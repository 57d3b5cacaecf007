//! Judgement of one rule for two soils: its result, and its margin.

use super::rule::{FilterRule, Judged, RuleInputs};
use crate::applied::{RuleRole, ValueBound};
use voidwalk_core::gradation::TIE;

/// Margin by which a rule is kept, the worst first.
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

/// Judges one rule; `None` if nobody asked for it.
pub(super) fn judged(rule: &FilterRule, inputs: &RuleInputs) -> Option<Judged> {
    let judged = (rule.judge)(inputs);
    if judged.is_left_out {
        return None;
    }
    let keeps = |(value, limit): (f64, f64)| match rule.at_least {
        true => value >= limit * (1.0 - TIE),
        false => value <= limit * (1.0 + TIE),
    };
    let met = judged.met.or_else(|| judged.value.zip(judged.limit).map(keeps));
    // A limit that can only be less is certainly broken, or certainly kept if it is the least allowed.
    let met = met.filter(|met| !judged.limit_at_most || *met == rule.at_least || judged.met.is_some());
    let value_bound = judged.value_bound.filter(|_| judged.value.is_some());
    // A value that is only a bound decides if the bound itself meets or breaks the limit.
    let is_surely = |bound: ValueBound| (bound == ValueBound::AtMost) != rule.at_least;
    let met = met.filter(|met| value_bound.is_none_or(|bound| *met == is_surely(bound)));
    let met = met.filter(|_| judged.applies);
    Some(Judged { value_bound, met, ..judged })
}
