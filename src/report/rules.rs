//! The section on filter rules of a report page.

use maud::{Markup, html};

use super::numbers::{significant, trimmed};
use super::shell::clean;
use super::table::Table;
use crate::outcome::record::Outcome;

/// Every rule with its value, limit, result, source and what it was made for.
pub(super) fn rules(outcome: &Outcome) -> Markup {
    let table = Table::of(&outcome.rules)
        .class("rules")
        .name("Rule, what it is for, source", |rule| {
            html! {
                (clean(&rule.name))
                @if !rule.applies_to.is_empty() { br; span.small { "For " (clean(&rule.applies_to)) "." } }
                @if !rule.note.is_empty() { br; span.small { b { (clean(&rule.note)) } } }
                br; span.small { (clean(&rule.source)) }
            }
        })
        .number("Here", |rule| {
            let value =
                rule.value.map_or_else(|| "–".to_owned(), |value| format!("= {}", significant(value)));
            html! { (clean(&rule.quantity)) " " br; (value) }
        })
        .number("Limit", |rule| {
            let sign = if rule.at_least { "≥" } else { "≤" };
            rule.limit.map_or_else(|| "–".to_owned(), |limit| format!("{sign} {}", trimmed(limit)))
        })
        .text("", |rule| match rule.met {
            Some(true) => html! { span.keeps { "✓ met" } },
            Some(false) => html! { span.breaks { "✗ not met" } },
            None => html! { "no result" },
        });
    html! {
        h2 { "Filter rules beside the verdict" }
        @if outcome.rules.is_empty() { p { "No rule was applied." } } @else {
            p {
                "Empirical rules on the same two curves. They draw their lines by experience with tests; the \
                 verdict above "
                "is “" (outcome.verdict.words()) "”. Where they differ, neither is proof."
            }
            (table)
        }
    }
}
