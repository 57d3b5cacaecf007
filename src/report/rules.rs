//! The section on filter rules of a report page.

use maud::{Markup, html};

use super::numbers::{SizeUnit, significant, trimmed};
use super::shell::clean;
use super::table::Table;
use crate::outcome::record::{AppliedRule, Outcome, RuleQuantity, RuleRole};
use crate::verdict::practice::digits_within;

/// Every rule with its value, limit, result, source and what it was made for.
pub(super) fn rules(outcome: &Outcome, unit: SizeUnit) -> Markup {
    let (walk, practice): (Vec<&AppliedRule>, Vec<&AppliedRule>) =
        outcome.rules.iter().partition(|rule| rule.role == RuleRole::Walk);
    html! {
        h2 { "Filter rules beside the verdict" }
        @if outcome.rules.is_empty() { p { "No rule was applied." } } @else {
            p { (outcome.compared_with_tests()) }
            (table(&practice, unit))
            @if !walk.is_empty() {
                h3 { "Comparisons of the walk with tests and with the paper" }
                p.small { "They show whether the walk agrees with both. No filter fails by them." }
                (table(&walk, unit))
            }
        }
    }
}

/// What stands behind a value or a limit of a rule: inches, where it is a length and they are shown.
pub(super) fn inches(rule: &AppliedRule, value: f64, unit: SizeUnit) -> String {
    if rule.unit == "mm" { unit.beside(value) } else { String::new() }
}

/// What stands behind a limit of a rule, so that inches do not go beyond it either.
pub(super) fn inches_of_limit(rule: &AppliedRule, limit: f64, unit: SizeUnit) -> String {
    match (rule.unit == "mm", rule.at_least) {
        (true, true) => unit.beside_least(limit),
        (true, false) => unit.beside_greatest(limit),
        (false, _) => String::new(),
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
                @if !rule.speaks_against.is_empty() && rule.role != RuleRole::Walk {
                    br; span.small { "If not met, it speaks against " (clean(&rule.speaks_against)) "." }
                }
                @for text in [&rule.note, &rule.needs] {
                    @if !text.is_empty() { br; span.small { b { (clean(&text.to_string())) } } }
                }
                br; span.small { (clean(&rule.source)) }
            }
        })
        .number("Here", |rule| {
            let value = |value| {
                let shown = format!("= {} {}", significant(value), rule.unit);
                shown.trim_end().to_owned() + &inches(rule, value, unit)
            };
            let value = rule.value.map_or_else(|| "–".to_owned(), value);
            html! { (clean(rule.quantity.name())) " " br; (clean(&value)) }
        })
        .number("Limit", |rule| {
            let sign = if rule.at_least { "≥" } else { "≤" };
            let is_open = rule.at_least && rule.limit_at_most;
            let sign = if is_open { "not known; at most" } else { sign };
            let limit = |limit: f64| {
                let number = match rule.quantity {
                    RuleQuantity::D15F => digits_within(limit, 3, rule.at_least),
                    _ => trimmed((limit * 1e4).round() / 1e4),
                };
                let shown = format!("{sign} {number} {}", rule.unit);
                shown.trim_end().to_owned() + &inches_of_limit(rule, limit, unit)
            };
            let limit = clean(&rule.limit.map_or_else(|| "–".to_owned(), limit));
            html! { (limit) @if rule.limit_at_most && !is_open { " or less" } }
        })
        .text("", |rule| match (rule.role, rule.met) {
            (RuleRole::Walk, Some(true)) => html! { "within" },
            (RuleRole::Walk, Some(false)) => html! { "beyond" },
            (_, Some(true)) => html! { span.keeps { "✓ met" } },
            (_, Some(false)) => html! { span.breaks { "✗ not met" } },
            (_, None) if !rule.applies && rule.needs.is_empty() => html! { "does not apply" },
            (_, None) if rule.value.is_some() && rule.limit.is_none() && rule.needs.is_empty() => {
                html! { "no limit" }
            }
            (_, None) => html! { "no result" },
        });
    html! { (table) }
}
