//! The section on filter rules of a report page.

use std::borrow::Cow;

use maud::{Markup, html};

use super::quantity::{SizeUnit, length};
use super::shell::clean;
use super::table::Table;
use crate::words::left_out::NOT_COVERED;
use crate::words::rule::{LIMITS_ROUNDED, columns, value};
use crate::words::rule_note::rule_notes;
use voidwalk_practice::Decision;
use voidwalk_practice::{AppliedRule, RuleRole};

/// Every rule with its value, limit, result, source and origin.
pub(super) fn rules(decision: &Decision, unit: SizeUnit) -> Markup {
    let listed = decision.listed();
    let ([practice, walk], sources) = (of_practice_and_walk(&listed), distinct_sources(&listed));
    html! {
        h2 { "All rules" }
        @if decision.rules.is_empty() { p { "No rule was applied." } } @else {
            p.small { (LIMITS_ROUNDED) " " (NOT_COVERED) " In brackets: sources, below." }
            (numbered(&practice, unit, &sources))
            @if !walk.is_empty() {
                div.screen {
                    h3 { "Comparisons of the walk with tests and with the paper" }
                    p.small { "They show whether the walk agrees with both. No filter fails by them." }
                    (numbered(&walk, unit, &sources))
                }
            }
        }
    }
}

/// Rules as a table in which numbers represent the sources.
fn numbered(rules: &[&AppliedRule], unit: SizeUnit, sources: &[&str]) -> Markup {
    table_with(rules, unit, |rule| match sources.iter().position(|source| *source == rule.source) {
        Some(place) => html! { " [" (place + 1) "]" },
        None => html! {},
    })
}

/// The sources of all rules, by their numbers in the table.
pub(super) fn sources(decision: &Decision) -> Markup {
    let listed = decision.listed();
    let sources = distinct_sources(&listed);
    let is_of_walk = |source: &str| {
        let citing = decision.rules.iter().filter(|rule| rule.source == source);
        citing.clone().count() > 0 && citing.into_iter().all(|rule| rule.role == RuleRole::Walk)
    };
    html! {
        @if !sources.is_empty() {
            h2 { "Sources" }
            ol.sources {
                @for source in &sources {
                    // Comparisons of the walk stay on the screen.
                    li.screen[is_of_walk(source)] { (clean(source)) }
                }
            }
        }
    }
}

/// The rules of practice, and those that check the walk.
fn of_practice_and_walk<'a>(rules: &'a [Cow<AppliedRule>]) -> [Vec<&'a AppliedRule>; 2] {
    let (walk, practice) = rules.iter().map(AsRef::as_ref).partition(|rule| rule.role == RuleRole::Walk);
    [practice, walk]
}

/// Each source once, those of practice first.
fn distinct_sources<'a>(rules: &'a [Cow<AppliedRule>]) -> Vec<&'a str> {
    let mut sources: Vec<&str> = Vec::new();
    for rule in of_practice_and_walk(rules).into_iter().flatten() {
        if !rule.source.is_empty() && !sources.contains(&&*rule.source) {
            sources.push(&rule.source);
        }
    }
    sources
}

/// Rules as a table, with `source` as text behind the name of each.
fn table_with(rules: &[&AppliedRule], unit: SizeUnit, source: impl Fn(&AppliedRule) -> Markup) -> Markup {
    let columns = columns(unit).only(&["rule", "authority", "value", "limit", "result"]);
    let value = |rule: &AppliedRule| value(rule, unit).unwrap_or_else(|| "–".into());
    let table = Table::of(rules.iter().copied(), columns)
        .class("rules")
        .showing("rule", |rule| {
            html! {
                (clean(&rule.name)) (source(rule))
                @if !rule.applies_to.is_empty() { br; span.small { "For " (clean(&rule.applies_to)) "." } }
                @if let Some(left) = rule.without_finer.filter(|_| rule.is_broken()) {
                    br; span.small {
                        "Without its finest " (format!("{:.1}", left.percent)) " % its D15F is "
                        (length(left.d15f, unit)) "."
                    }
                }
                @for notes in [&rule.notes, &rule.needs] {
                    @if !notes.is_empty() { br; span.small { b { (clean(&rule_notes(notes, unit))) } } }
                }
            }
        })
        .showing("value", |rule| html! { (clean(rule.quantity.name())) " " br; (clean(&value(rule))) });
    html! { (table) }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::words::rule::value_and_limit;
    use voidwalk_core::gradation::Gradation;
    use voidwalk_practice::PairRules;
    use voidwalk_practice::rules::{DESIGN, TERZAGHI};

    fn rule(id: &str, value: f64, limit: f64) -> AppliedRule {
        let soil = |d15, size| Gradation::linear_from_dx(d15, size, 1.5).unwrap();
        let rules = PairRules::of(&soil(85.0, 0.2), &soil(15.0, 0.8)).rules;
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
        let broken = [rule(TERZAGHI, 4.0003, 4.0)];
        let decision = Decision::new(&broken, None, None);
        let listed = decision.listed();
        let page = table_with(&[&listed[0]], SizeUnit::Mm, |_| html! {}).into_string();
        assert!(page.contains("= 4.0003") && page.contains("≤ 4<") && page.contains("✗ not met"), "{page}");
        // 0.70003 mm and 0.7 mm are 0.027561 and 0.027559 inches.
        let texts = shown(&rule(DESIGN, 0.70003, 0.7), SizeUnit::MmAndInches);
        assert_eq!(texts[0], "0.70003\u{202f}mm (0.0276\u{202f}in)");
        assert_eq!(texts[1], "0.70000\u{202f}mm (0.0275\u{202f}in)");
        let within = shown(&rule(DESIGN, 0.699, 0.7), SizeUnit::MmAndInches);
        assert_eq!(within, ["0.699\u{202f}mm (0.02752\u{202f}in)", "0.700\u{202f}mm (0.02755\u{202f}in)"]);
    }
}
