//! The section on filter rules of a report page.

use maud::{Markup, html};

use super::numbers::SizeUnit;
use super::shell::clean;
use super::table::Table;
use crate::outcome::apart::{self, digits_of, digits_within};
use crate::outcome::record::{AppliedRule, Outcome, RuleRole};
use crate::verdict::listed::listed;
use crate::verdict::rule_words::{
    LIMITS_ROUNDED, RuleResult, limit_begins, limit_ends, result_of, value_begins,
};

/// Digits of a value and a limit, where more are not needed to tell them apart.
const DIGITS: i32 = 3;

/// Every rule with its value, limit, result, source and what it was made for.
pub(super) fn rules(outcome: &Outcome, unit: SizeUnit) -> Markup {
    let listed = listed(&outcome.rules);
    let (walk, practice): (Vec<&AppliedRule>, Vec<&AppliedRule>) =
        listed.iter().partition(|rule| rule.role == RuleRole::Walk);
    html! {
        h2 { "Filter rules beside the verdict" }
        @if outcome.rules.is_empty() { p { "No rule was applied." } } @else {
            p.small { (LIMITS_ROUNDED) }
            (table(&practice, unit))
            @if !walk.is_empty() {
                h3 { "Comparisons of the walk with tests and with the paper" }
                p.small { "They show whether the walk agrees with both. No filter fails by them." }
                (table(&walk, unit))
            }
        }
    }
}

/// Value and limit of a rule with their unit, as far as they are known, and in inches, too, where those are
/// shown: with as many digits as tell the two apart, so that what exceeds its limit never reads as within it.
pub(crate) fn value_and_limit(rule: &AppliedRule, unit: SizeUnit) -> [Option<String>; 2] {
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
        let with_unit = format!("{number}\u{202f}{}", rule.unit);
        Some(with_unit.trim_end().to_owned() + &inches)
    });
    std::array::from_fn(|_| both.next().flatten())
}

/// What stands behind both: inches that follow from the mm beside them, as far apart as those, where they are
/// shown.
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

/// What stands in the place of a limit that is not there.
fn no_limit(rule: &AppliedRule) -> &'static str {
    let is_none = result_of(rule) == RuleResult::NotALimit;
    if is_none { RuleResult::NotALimit.words() } else { "–" }
}

/// What a rule found: a tick where it is kept alone.
pub(super) fn result(rule: &AppliedRule) -> Markup {
    match result_of(rule) {
        of @ RuleResult::Met => html! { span.keeps { "✓ " (of.words()) } },
        of @ RuleResult::NotMet => html! { span.breaks { "✗ " (of.words()) } },
        of => html! { (of.words()) },
    }
}

/// Everybody who states a rule.
pub(super) fn authorities(rule: &AppliedRule) -> Markup {
    match rule.authorities() {
        none if none.is_empty() => html! { "–" },
        named => html! { (clean(&named.join(", "))) },
    }
}

/// Rules as a table.
pub(super) fn table(rules: &[&AppliedRule], unit: SizeUnit) -> Markup {
    let table = Table::of(rules)
        .class("rules")
        .name("Rule, what it is for, source", |rule| {
            html! {
                (clean(&rule.name))
                @if !rule.applies_to.is_empty() { br; span.small { "For " (clean(&rule.applies_to)) "." } }
                @if let Some(left) = rule.without_finer.filter(|_| rule.is_broken()) {
                    br; span.small {
                        "Without its finest " (format!("{:.1}", left.percent)) " % its D15F is "
                        (unit.size(left.d15f)) "."
                    }
                }
                @for text in [&rule.note, &rule.needs] {
                    @if !text.is_empty() { br; span.small { b { (clean(&text.to_string())) } } }
                }
                br; span.small { (clean(&rule.source)) }
            }
        })
        .text("Authority", |rule| authorities(rule))
        .number("Here", |rule| {
            let [value, _] = value_and_limit(rule, unit);
            let value =
                value.map_or_else(|| "–".to_owned(), |value| format!("{} {value}", value_begins(rule)));
            html! { (clean(rule.quantity.name())) " " br; (clean(&value)) }
        })
        .number("Limit", |rule| {
            let [begins, ends] = [limit_begins(rule), limit_ends(rule)];
            let [_, limit] = value_and_limit(rule, unit);
            let limit = limit.map(|limit| format!("{begins} {limit}{ends}"));
            html! { (clean(&limit.unwrap_or_else(|| no_limit(rule).to_owned()))) }
        })
        .text("", |rule| match (rule.role, rule.met) {
            (RuleRole::Walk, Some(true)) => html! { "within" },
            (RuleRole::Walk, Some(false)) => html! { "beyond" },
            _ => result(rule),
        });
    html! { (table) }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::gradation::Gradation;
    use crate::outcome::rules::{DESIGN, TERZAGHI};
    use crate::verdict::PairRules;

    fn rule(id: &str, value: f64, limit: f64) -> AppliedRule {
        let of = |d15, size| Gradation::linear_from_dx(d15, size, 1.5).unwrap();
        let rules = PairRules::of(&of(85.0, 0.2), &of(15.0, 0.8)).rules;
        let rule = rules.into_iter().find(|rule| rule.id == id).unwrap();
        AppliedRule { value: Some(value), limit: Some(limit), met: Some(value <= limit), ..rule }
    }

    fn shown(rule: &AppliedRule, unit: SizeUnit) -> [String; 2] {
        value_and_limit(rule, unit).map(Option::unwrap)
    }

    #[test]
    fn a_value_that_exceeds_its_limit_never_reads_as_within_it() {
        let terzaghi = |value| shown(&rule(TERZAGHI, value, 4.0), SizeUnit::Mm);
        assert_eq!(terzaghi(4.0003), ["4.0003", "4"]);
        assert_eq!(terzaghi(3.9998), ["3.9998", "4"]);
        assert_eq!(terzaghi(3.52), ["3.52", "4"]);
        let page = table(&[&rule(TERZAGHI, 4.0003, 4.0)], SizeUnit::Mm).into_string();
        assert!(page.contains("= 4.0003") && page.contains("≤ 4<") && page.contains("✗ not met"), "{page}");
        // 0.70003 mm and 0.7 mm are 0.027561 and 0.027559 inches.
        let of = shown(&rule(DESIGN, 0.70003, 0.7), SizeUnit::MmAndInches);
        assert_eq!(of[0], "0.70003\u{202f}mm (0.0276\u{202f}in)");
        assert_eq!(of[1], "0.70000\u{202f}mm (0.0275\u{202f}in)");
        let within = shown(&rule(DESIGN, 0.699, 0.7), SizeUnit::MmAndInches);
        assert_eq!(within, ["0.699\u{202f}mm (0.02752\u{202f}in)", "0.700\u{202f}mm (0.02755\u{202f}in)"]);
    }
}
