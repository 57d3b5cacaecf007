//! First sheet, which can be handed in by itself: cover, answer, sizes, and the rules that decide or are not
//! met. Below it are all rules with their sources.

use super::folder::RunFolder;
use super::names::{is_named, titled};
use super::shell::{clean, cover, program, unbroken};
use super::table::{SizedSoil, Table, of_few};
use crate::outcome::record::Outcome;
use crate::words::left_out::{NOT_COVERED, left_out_line};
use crate::words::rule::{
    LIMITS_ROUNDED, limit_begins, limit_ends, rule_notes, value, value_and_limit, value_begins,
};
use crate::words::{FirstLine, first_lines, grading, judged_alone, rule};
use maud::{Markup, html};
use std::borrow::Cow;
use voidwalk_practice::quantity::{SizeUnit, length, range_of_tests};
use voidwalk_practice::rule_result::{RuleResult, result_of};
use voidwalk_practice::rules::{DESIGN, PERMEABILITY, TESTS_CONTINUING, TESTS_NO_EROSION};
use voidwalk_practice::{AppliedRule, Decision, Headline, PracticeClass, RuleRole};

/// Header with the two soils and the cover of the sheet.
pub(super) fn header(folder: &RunFolder) -> Markup {
    let inputs = &folder.outcome.inputs;
    let (base, filter) = (titled("Base", &inputs.base.name), titled("filter", &inputs.filter.name));
    let regraded = inputs.base.regraded_at_mm.map(|_| grading(&inputs.base.size()));
    let manifest = &folder.manifest;
    let program = program(&manifest.version, manifest.commit.as_deref());
    let day = manifest.finished.split('T').next().map(String::from);
    let is_shown = is_named("Base", &inputs.base.name) || is_named("filter", &inputs.filter.name);
    html! {
        h1 { (QUESTION) }
        @if is_shown || regraded.is_some() {
            p.names { (base) @if let Some(words) = regraded { " (" (words) ")" } " against " (filter) }
        }
        (cover(&folder.about.cover.clone().dated(day), &program, Some(folder.outcome.seed)))
    }
}

pub(super) const QUESTION: &str = "Will this filter hold this soil?";

/// Answer: the lines of practice and model, and the number of notes.
pub(super) fn answer(outcome: &Outcome, decision: &Decision, unit: SizeUnit) -> Markup {
    let notes = outcome.notes.len();
    html! {
        section.verdict.(colour_of(decision.headline)) {
            @for (line, words) in first_lines(outcome, decision, unit) {
                p.practice { b { (line.name()) } ": " (unbroken(&words)) "." }
                @if line == FirstLine::Practice && let Some(alone) = judged_alone(outcome, decision) {
                    p.counted { (alone) }
                }
            }
            @match notes {
                0 => {}
                1 => p.small { "1 note below." }
                _ => p.small { (notes) " notes below." }
            }
        }
    }
}

/// Colour of an answer, by practice; neutral without practice.
pub(crate) fn colour_of(headline: Option<Headline>) -> &'static str {
    let Some(headline) = headline else { return "neutral" };
    match (headline, headline.class()) {
        (Headline::Meets, _) => "none",
        (Headline::BeyondDesign, _) => "some",
        (_, PracticeClass::DoesNotMeet) => "continuing",
        (_, PracticeClass::Meets | PracticeClass::NotKnown) => "doubted",
    }
}

/// Sizes of both soils as a table: the base as sampled and, if it is regraded, as regraded.
pub(super) fn sizes(outcome: &Outcome, unit: SizeUnit) -> Markup {
    let (filter, base) = (&outcome.inputs.filter, &outcome.inputs.base);
    let filter: SizedSoil = ("Filter".into(), &filter.gradation);
    match &base.as_sampled {
        Some(sampled) => {
            let sampled: SizedSoil = ("Base, sampled".into(), &sampled.gradation);
            of_few(&[filter, sampled, ("regraded".into(), &base.gradation)], unit)
        }
        None => of_few(&[filter, ("Base".into(), &base.gradation)], unit),
    }
}

/// Rules of practice that decide or are not met, and the number of the others.
pub(super) fn in_short(outcome: &Outcome, decision: &Decision, unit: SizeUnit) -> Markup {
    let listed = decision.listed();
    let rules = listed.iter().map(AsRef::as_ref);
    let mut practice: Vec<&AppliedRule> = rules.filter(|rule| rule.role != RuleRole::Walk).collect();
    practice.sort_by_key(|rule| place(rule));
    let mut roles: Vec<RuleRole> = Vec::new();
    let (shown, others): (Vec<&AppliedRule>, Vec<&AppliedRule>) = practice.into_iter().partition(|rule| {
        // The first of several broken rules of one kind is enough here.
        let is_first = !roles.contains(&rule.role);
        if result_of(rule) == RuleResult::NotMet {
            roles.push(rule.role);
        }
        place(rule) < NOT_MET || place(rule) == NOT_MET && is_first
    });
    let is_empty = shown.is_empty() && others.is_empty();
    let range = outcome.practice.as_ref().and_then(|practice| practice.range_of_tests_mm);
    html! {
        section.short {
            h2 { "Rules of practice, in short" }
            @if is_empty { p { "No rule was applied." } }
            @if !shown.is_empty() { (table(&shown, unit)) }
            @if !others.is_empty() {
                p.others {
                    "Others: "
                    @for (at, (count, result)) in counts(&others).into_iter().enumerate() {
                        @if at > 0 { ", " }
                        @match result {
                            RuleResult::NotMet => span.breaks { "✗ " (count) " " (rule::result(result)) },
                            RuleResult::NoResult => b { (count) " " (rule::result(result)) },
                            RuleResult::DoesNotApply if count > 1 => { (count) " do not apply" }
                            _ => { (count) " " (rule::result(result)) }
                        }
                    }
                    ". See “All rules”."
                }
            }
            @if let Some([low, high]) = range {
                p {
                    "In tests of such bases erosion began at D15F " (range_of_tests(low, high, unit))
                    " (Fell et al., Table 9.2)."
                }
            }
            p.small { (left_out_line(&outcome.model_leaves_out)) }
        }
    }
}

/// Numbers of these rules by result, starting with those not met.
fn counts(rules: &[&AppliedRule]) -> Vec<(usize, RuleResult)> {
    let with = [RuleResult::NotMet, RuleResult::Met, RuleResult::NotReached, RuleResult::ExcessiveNotJudged];
    let count = |result: RuleResult| rules.iter().filter(|rule| result_of(rule) == result).count();
    let counts = with.into_iter().chain(RuleResult::WITHOUT).map(|result| (count(result), result));
    counts.filter(|(count, _)| *count > 0).collect()
}

/// Rules that decide if a filter retains and drains a base, in reading order.
const DECIDING: [&str; 4] = [DESIGN, TESTS_NO_EROSION, TESTS_CONTINUING, PERMEABILITY];

/// Position of other rules that are not met.
const NOT_MET: usize = DECIDING.len();

/// Position of a rule: first the deciding rules, then those that are not met, then the others.
fn place(rule: &AppliedRule) -> usize {
    let deciding = DECIDING.iter().position(|id| *id == rule.id).filter(|_| rule.applies);
    match (deciding, result_of(rule)) {
        (Some(place), _) => place,
        (None, RuleResult::NotMet) => NOT_MET,
        (None, _) => NOT_MET + 1,
    }
}

fn purpose(rule: &AppliedRule) -> &'static str {
    match (rule.id.as_str(), rule.role) {
        (DESIGN, _) => "Design",
        (TESTS_NO_EROSION, _) => "No erosion",
        (_, RuleRole::Retention) => "Retention",
        (_, RuleRole::Continuation) => "Continuing erosion",
        (_, RuleRole::Drainage) => "Drainage",
        (_, RuleRole::Placing) => "Placing",
        (_, RuleRole::Stability) => "Stability",
        (_, RuleRole::Walk) => "Walk",
    }
}

/// Quantity of a rule without soil and split sizes, which “All rules” gives.
fn quantity_in_brief(rule: &AppliedRule) -> &str {
    let name = rule.quantity.name();
    name.split([',', '(']).next().and_then(|name| name.split(" of the filter").next()).unwrap_or(name)
}

fn table(rules: &[&AppliedRule], unit: SizeUnit) -> Markup {
    let columns = rule::columns(unit).only(&["rule", "quantity", "value", "limit", "authority", "result"]);
    let table = Table::new(rules.iter().copied(), columns)
        .showing("quantity", |rule| html! { (clean(quantity_in_brief(rule))) })
        .showing("authority", |rule| html! { (clean(rule.authorities().first().unwrap_or(&"–"))) })
        .showing("rule", |rule| match DECIDING.contains(&rule.id.as_str()) {
            true => html! { b { (purpose(rule)) } },
            false => html! { (purpose(rule)) },
        })
        .showing("value", |rule| match &value_and_limit(rule, unit)[0] {
            Some(value) if rule.value_bound.is_none() => html! { span.q { (clean(value)) } },
            Some(value) => html! { (value_begins(rule)) " " span.q { (clean(value)) } },
            None => html! { "–" },
        })
        .showing("limit", |rule| {
            let [_, limit] = value_and_limit(rule, unit);
            // The name of the row contains the boundary.
            let begins = match rule.role {
                RuleRole::Continuation => "beyond",
                _ => limit_begins(rule),
            };
            match limit.as_deref().map(clean) {
                Some(limit) if rule.at_least && rule.limit_at_most => html! {
                    span.q { (begins) } " " span.q { (limit) (limit_ends(rule)) }
                },
                Some(limit) => html! { span.q { (begins) " " (limit) } (limit_ends(rule)) },
                None => html! { "–" },
            }
        });
    html! { (table) }
}

/// Every rule with its value, limit, result, source and origin.
pub(super) fn rules(decision: &Decision, unit: SizeUnit) -> Markup {
    let listed = decision.listed();
    let ([practice, walk], sources) = (of_practice_and_walk(&listed), distinct_sources(&listed));
    html! {
        h2 { "All rules" }
        @if decision.rules.is_empty() { p { "No rule was applied." } } @else {
            p.small { (LIMITS_ROUNDED) " " (NOT_COVERED) " In brackets: sources, below." }
            (table_of_all(&practice, unit, &sources))
            @if !walk.is_empty() {
                div.screen {
                    h3 { "Comparisons of the walk with tests and with the paper" }
                    p.small { "They show whether the walk agrees with both. No filter fails by them." }
                    (table_of_all(&walk, unit, &sources))
                }
            }
        }
    }
}

/// Sources of all rules, by their numbers in the table.
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
                    // Sources of comparisons with the walk appear on screen only.
                    li.screen[is_of_walk(source)] { (clean(source)) }
                }
            }
        }
    }
}

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

/// Table of rules, with numbers for the sources.
fn table_of_all(rules: &[&AppliedRule], unit: SizeUnit, sources: &[&str]) -> Markup {
    let number = |rule: &AppliedRule| sources.iter().position(|source| *source == rule.source);
    let columns = rule::columns(unit).only(&["rule", "authority", "value", "limit", "result"]);
    let value = |rule: &AppliedRule| value(rule, unit).unwrap_or_else(|| "–".into());
    let table = Table::new(rules.iter().copied(), columns)
        .class("rules")
        .showing("rule", |rule| {
            html! {
                (clean(&rule.name)) @if let Some(place) = number(rule) { " [" (place + 1) "]" }
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
    use voidwalk_core::gradation::Gradation;
    use voidwalk_practice::PairRules;
    use voidwalk_practice::rules::TERZAGHI;

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
        let page = table_of_all(&[&listed[0]], SizeUnit::Mm, &[]).into_string();
        assert!(page.contains("= 4.0003") && page.contains("≤ 4<") && page.contains("✗ not met"), "{page}");
        // 0.70003 mm and 0.7 mm are 0.027561 and 0.027559 in.
        let texts = shown(&rule(DESIGN, 0.70003, 0.7), SizeUnit::MmAndInches);
        assert_eq!(texts[0], "0.70003\u{202f}mm (0.0276\u{202f}in)");
        assert_eq!(texts[1], "0.70000\u{202f}mm (0.0275\u{202f}in)");
        let within = shown(&rule(DESIGN, 0.699, 0.7), SizeUnit::MmAndInches);
        assert_eq!(within, ["0.699\u{202f}mm (0.02752\u{202f}in)", "0.700\u{202f}mm (0.02755\u{202f}in)"]);
    }
}
