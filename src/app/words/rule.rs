//! Rules of practice in words: their table, from which every face shows some columns, their results, and
//! values beside limits.

use super::rule_note::rule_notes;
use crate::outcome::table::{Columns, Emphasis, Shown, TableCell};
use voidwalk_practice::quantity::{SizeUnit, Unit, beside_limit};
use voidwalk_practice::rule_result::{RuleResult, result_of};
use voidwalk_practice::rules::PERMEABILITY_LEAST;
use voidwalk_practice::{AppliedRule, RuleRole, RuleUnit, ValueBound};

/// Note beside lists of limits: a reader finds the digits that are not shown a little larger.
pub const LIMITS_ROUNDED: &str = "Limits are rounded to the safe side.";

/// The parts in which rules of practice are listed, with their headings.
pub const PARTS: [(RuleRole, &str); 5] = [
    (RuleRole::Retention, "The filter retains the base"),
    (RuleRole::Continuation, "Coarser filters: where erosion still ends"),
    (RuleRole::Drainage, "The filter drains the base"),
    (RuleRole::Placing, "The filter can be placed"),
    (RuleRole::Stability, "Internal stability of the filter"),
];

/// The columns of rules: the columns of a workbook, and under their headings the columns from which other
/// faces choose, sizes in this unit.
pub fn columns<'a>(unit: SizeUnit) -> Columns<'a, AppliedRule> {
    Columns::default()
        .name("rule", "Rule", |rule: &AppliedRule| rule.name.clone())
        .text("authority", "Authority", |rule| {
            Some(rule.authorities().join(", ")).filter(|names| !names.is_empty())
        })
        .text("quantity", "Quantity", |rule| rule.quantity.name().to_owned())
        .column("value", |rule| rule.value)
        .page_number("Value", move |rule| value(rule, unit))
        .column("The value is", |rule| rule.value_bound.map(value_is))
        .column("limit", |rule| rule.limit)
        .page_number("Limit", move |rule| {
            let is_none = result_of(rule) == RuleResult::NotALimit;
            limit(rule, unit).or(is_none.then(|| result(RuleResult::NotALimit).to_owned()))
        })
        .column("Unit of value and limit", |rule| rule.unit.name())
        .column("The limit is", |rule| rule.limit.map(|_| limit_is(rule)))
        .column("Applies", |rule| rule.applies)
        .text("result", "Result", shown_result)
        // A boundary of continuing erosion that is not reached is no limit that is met.
        .column("Met", |rule| rule.met.filter(|met| rule.role != RuleRole::Continuation || !met))
        .column("Formula", |rule| rule.formula.clone())
        .column("Applies to", |rule| rule.applies_to.clone())
        .column("note", move |rule| notes(rule, unit))
        .headed("Note")
        .page_text("Note, source", move |rule| {
            let texts = [notes(rule, unit), rule.source.clone()];
            texts.into_iter().filter(|text| !text.is_empty()).collect::<Vec<_>>().join(" – ")
        })
        .column("Source", |rule| rule.source.clone())
        .column("Id", |rule| rule.id.clone())
}

/// The value of a rule if sieves give only a bound.
fn value_is(bound: ValueBound) -> &'static str {
    match bound {
        ValueBound::AtMost => "the most that it can be",
        ValueBound::AtLeast => "the least that it can be",
    }
}

/// The kind of a limit that is known.
fn limit_is(rule: &AppliedRule) -> &'static str {
    match (rule.at_least, rule.limit_at_most) {
        _ if rule.role == RuleRole::Continuation => "a boundary: continuing erosion beyond it",
        (true, false) => "the least",
        (true, true) => "enough; the least is not known",
        (false, false) => "the most",
        (false, true) => "the most that it can be",
    }
}

/// Notes of a rule beside its result, and its missing data.
fn notes(rule: &AppliedRule, unit: SizeUnit) -> String {
    rule_notes(&[&rule.notes[..], &rule.needs].concat(), unit)
}

/// The result in a cell; a comparison of the walk with tests lies within them or not.
fn shown_result(rule: &AppliedRule) -> Shown {
    let rule_result = result_of(rule);
    match (rule.role, rule.met) {
        (RuleRole::Walk, Some(true)) => "within".shown(),
        (RuleRole::Walk, Some(false)) => "beyond".shown(),
        _ => {
            let is_decided = [RuleResult::Met, RuleResult::NotMet].contains(&rule_result);
            let emphasis = is_decided.then_some(Emphasis::Kept(rule_result == RuleResult::Met));
            result(rule_result).shown().emphasised(emphasis)
        }
    }
}

/// The value of a rule as `= 0.8`, or as `at most 0.8` if sieves give only a bound.
pub fn value(rule: &AppliedRule, unit: SizeUnit) -> Option<String> {
    let [value, _] = value_and_limit(rule, unit);
    value.map(|value| format!("{} {value}", value_begins(rule)))
}

/// The limit of a rule with the words around it.
pub fn limit(rule: &AppliedRule, unit: SizeUnit) -> Option<String> {
    let [_, limit] = value_and_limit(rule, unit);
    limit.map(|limit| format!("{} {limit}{}", limit_begins(rule), limit_ends(rule)))
}

/// The result of a rule.
pub fn result(result: RuleResult) -> &'static str {
    match result {
        RuleResult::Met => "met",
        RuleResult::NotMet => "not met",
        RuleResult::NotReached => "not reached",
        RuleResult::ExcessiveNotJudged => "not reached; excessive erosion not judged",
        RuleResult::NotALimit => "not a limit",
        RuleResult::NoLimit => "no limit",
        RuleResult::NoResult => "no result",
        RuleResult::DoesNotApply => "does not apply",
    }
}

/// The words before a limit: a least, a most, or a boundary beyond which erosion continues.
pub fn limit_begins(rule: &AppliedRule) -> &'static str {
    match (rule.role, rule.at_least, rule.limit_at_most) {
        (RuleRole::Continuation, ..) => "continuing beyond",
        // The least follows from a size in the base's finest part, and a sufficient value is known.
        (_, true, true) if rule.id == PERMEABILITY_LEAST => "≥ 3 D15B;",
        (_, true, true) => "≥ 5 D15B;",
        (_, true, false) => "≥",
        (_, false, _) => "≤",
    }
}

/// The words behind a limit that is itself unknown.
pub fn limit_ends(rule: &AppliedRule) -> &'static str {
    match (rule.limit_at_most, rule.at_least) {
        (true, true) => " is enough",
        (true, false) => " or less",
        (false, _) => "",
    }
}

/// The words before a value: a bound, if sieves give no more.
pub fn value_begins(rule: &AppliedRule) -> &'static str {
    match rule.value_bound {
        None => "=",
        Some(ValueBound::AtMost) => "at most",
        Some(ValueBound::AtLeast) => "at least",
    }
}

/// Value and limit of a rule with their unit, as far as they are known, and in inches if these are shown:
/// with enough digits to tell the two apart, so that a value beyond its limit never reads as within it.
pub fn value_and_limit(rule: &AppliedRule, unit: SizeUnit) -> [Option<String>; 2] {
    let unit = match rule.unit {
        RuleUnit::One => Unit::None,
        RuleUnit::Percent => Unit::Percent,
        RuleUnit::D0f => Unit::Size(SizeUnit::D0f),
        RuleUnit::Mm => Unit::Size(unit),
    };
    beside_limit([rule.value, rule.limit], rule.at_least, unit)
}
