//! Single rules of practice in words: their results, values beside limits, and how a sentence cites them.

use crate::outcome::apart::{self, digits_of, digits_within};
use crate::outcome::numbers::SizeUnit;
use crate::outcome::record::{AppliedRule, RuleRole, ValueBound};
use crate::outcome::rules::PERMEABILITY_LEAST;
use crate::verdict::rule_result::RuleResult;

/// Digits of a value and a limit, where more are not needed to tell them apart.
const DIGITS: i32 = 3;

/// Stands once where limits are listed: a reader finds the digits that are not shown a little larger.
pub const LIMITS_ROUNDED: &str = "Limits are rounded to the safe side.";

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
        // The least follows from a size in the base's finest part, and what is enough for it is known.
        (_, true, true) if rule.id == PERMEABILITY_LEAST => "≥ 3 D15B;",
        (_, true, true) => "≥ 5 D15B;",
        (_, true, false) => "≥",
        (_, false, _) => "≤",
    }
}

/// The words behind a limit that is not known itself.
pub fn limit_ends(rule: &AppliedRule) -> &'static str {
    match (rule.limit_at_most, rule.at_least) {
        (true, true) => " is enough",
        (true, false) => " or less",
        (false, _) => "",
    }
}

/// The words before a value: a bound of it, where sieves tell no more.
pub fn value_begins(rule: &AppliedRule) -> &'static str {
    match rule.value_bound {
        None => "=",
        Some(ValueBound::AtMost) => "at most",
        Some(ValueBound::AtLeast) => "at least",
    }
}

/// Value and limit of a rule with their unit, as far as they are known, and in inches, too, where those are
/// shown: with as many digits as tell the two apart, so that what exceeds its limit never reads as within it.
pub fn value_and_limit(rule: &AppliedRule, unit: SizeUnit) -> [Option<String>; 2] {
    let numbers = match (rule.value, rule.limit) {
        (Some(value), Some(limit)) => apart::value_and_limit(value, limit, rule.at_least, DIGITS).map(Some),
        (value, limit) => [
            value.map(|value| digits_of(value, DIGITS)),
            limit.map(|limit| digits_within(limit, DIGITS, rule.at_least)),
        ],
    };
    let inches = inches_of(rule, &numbers, unit);
    let mut both = numbers.into_iter().zip(inches).map(|(number, inches)| {
        let number = number?;
        // The digits of a length say how closely it was worked out; 4.00 times D85B is four times.
        let is_ratio = rule.unit.is_empty() || rule.unit == "%";
        let number = if is_ratio { without_zeros(&number) } else { &number };
        Some(format!("{number} {}", rule.unit).trim_end().to_owned() + &inches)
    });
    std::array::from_fn(|_| both.next().flatten())
}

/// Inches behind both, from the mm beside them and as far apart as those, where they are shown.
fn inches_of(rule: &AppliedRule, numbers: &[Option<String>; 2], unit: SizeUnit) -> [String; 2] {
    if rule.unit != "mm" {
        return Default::default();
    }
    let [value, limit] = [0, 1].map(|at| numbers[at].as_ref().and_then(|mm| mm.parse::<f64>().ok()));
    match (value, limit) {
        (Some(value), Some(limit)) => unit.beside_both(value, limit, rule.at_least),
        (Some(value), None) => [unit.beside(value), String::new()],
        (None, Some(limit)) if rule.at_least => [String::new(), unit.beside_least(limit)],
        (None, Some(limit)) => [String::new(), unit.beside_greatest(limit)],
        (None, None) => Default::default(),
    }
}

/// A number without zeros at its end.
fn without_zeros(number: &str) -> &str {
    if number.contains('.') { number.trim_end_matches('0').trim_end_matches('.') } else { number }
}
