//! The section on filter rules of a report page.

use maud::{Markup, html};

use super::numbers::significant;
use super::run_figures::trimmed;
use super::shell::clean;
use crate::outcome::record::{AppliedRule, Outcome};

/// Every rule with its value, limit, result, source and what it was made for.
pub(super) fn rules(outcome: &Outcome) -> Markup {
    html! {
        h2 { "Filter rules beside the verdict" }
        @if outcome.rules.is_empty() { p { "No rule was applied." } } @else {
            p {
                "Empirical rules on the same two curves. They draw their lines by experience with tests; the verdict above "
                "is “" (outcome.verdict.words()) "”. Where they differ, neither is proof."
            }
            table.rules {
                thead { tr { th { "Rule, what it is for, source" } th.n { "Here" } th.n { "Limit" } th { "" } } }
                tbody { @for rule in &outcome.rules { (row(rule)) } }
            }
        }
    }
}

fn row(rule: &AppliedRule) -> Markup {
    let sign = if rule.at_least { "≥" } else { "≤" };
    html! {
        tr {
            th {
                (clean(&rule.name))
                @if !rule.applies_to.is_empty() { br; span.small { "For " (clean(&rule.applies_to)) "." } }
                @if !rule.note.is_empty() { br; span.small { b { (clean(&rule.note)) } } }
                br; span.small { (clean(&rule.source)) }
            }
            td.n { (clean(&rule.quantity)) " " br; @match rule.value { Some(value) => { "= " (significant(value)) }, None => "–" } }
            td.n { @match rule.limit { Some(limit) => { (sign) " " (trimmed(limit)) }, None => "–" } }
            td { @match rule.meets {
                Some(true) => span.keeps { "✓ met" },
                Some(false) => span.breaks { "✗ not met" },
                None => "no result",
            } }
        }
    }
}
