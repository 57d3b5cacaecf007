//! The section on filter rules of a report page.

use maud::{Markup, html};

use super::numbers::{significant, trimmed};
use super::shell::clean;
use super::table::Table;
use crate::outcome::record::{AppliedRule, Outcome, RuleRole};

/// Every rule with its value, limit, result, source and what it was made for.
pub(super) fn rules(outcome: &Outcome) -> Markup {
    let (walk, practice): (Vec<&AppliedRule>, Vec<&AppliedRule>) =
        outcome.rules.iter().partition(|rule| rule.role == RuleRole::Walk);
    html! {
        h2 { "Filter rules beside the verdict" }
        @if outcome.rules.is_empty() { p { "No rule was applied." } } @else {
            p { (outcome.compared_with_tests()) }
            (table(&practice))
            @if !walk.is_empty() {
                h3 { "Comparisons of the walk with tests and with the paper" }
                p.small { "They show whether the walk agrees with both. No filter fails by them." }
                (table(&walk))
            }
        }
    }
}

/// Rules as a table.
pub(super) fn table(rules: &[&AppliedRule]) -> Markup {
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
            let value = rule
                .value
                .map_or_else(|| "–".to_owned(), |value| format!("= {} {}", significant(value), rule.unit));
            html! { (clean(rule.quantity.name())) " " br; (clean(value.trim_end())) }
        })
        .number("Limit", |rule| {
            let sign = if rule.at_least { "≥" } else { "≤" };
            let limit = |limit: f64| format!("{sign} {} {}", trimmed((limit * 1e4).round() / 1e4), rule.unit);
            let limit = clean(rule.limit.map_or_else(|| "–".to_owned(), limit).trim_end());
            html! { (limit) @if rule.limit_at_most { " at most" } }
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
