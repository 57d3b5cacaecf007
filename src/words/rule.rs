//! Single rules of practice in words: their results, values beside limits, and how a sentence cites them.

use crate::outcome::quantity::{SizeUnit, Unit, beside_limit};
use crate::outcome::record::{AppliedRule, RuleRole, RuleUnit, ValueBound};
use crate::outcome::rules::PERMEABILITY_LEAST;
use crate::verdict::rule_result::RuleResult;

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
    let unit = match rule.unit {
        RuleUnit::One => Unit::None,
        RuleUnit::Percent => Unit::Percent,
        RuleUnit::D0f => Unit::Size(SizeUnit::D0f),
        RuleUnit::Mm => Unit::Size(unit),
    };
    beside_limit([rule.value, rule.limit], rule.at_least, unit)
}
