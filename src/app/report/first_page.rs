//! The first sheet, which can be handed in by itself: client and author, the answer in three lines, the
//! gradations with their sizes, and the rules of practice that decide or are not met.

use maud::{Markup, html};

use super::cover::{cover, foot, program};
use super::folder::RunFolder;
use super::names::{is_named, titled};
use super::quantity::{SizeUnit, range_of_tests};
use super::shell::{clean, unbroken};
use super::sizes::{SizedSoil, of_few};
use super::table::Table;
use crate::outcome::record::Outcome;
use crate::words::left_out::left_out_line;
use crate::words::rule::{self, limit_begins, limit_ends, value_and_limit, value_begins};
use crate::words::{FirstLine, first_lines, grading, judged_alone};
use voidwalk_practice::Decision;
use voidwalk_practice::rule_result::{RuleResult, result_of};
use voidwalk_practice::rules::{DESIGN, PERMEABILITY, TESTS_CONTINUING, TESTS_NO_EROSION};
use voidwalk_practice::{AppliedRule, Headline, PracticeClass, RuleRole};

/// The two soils, and the cover of a sheet that is handed in.
pub(super) fn header(folder: &RunFolder) -> Markup {
    let inputs = &folder.outcome.inputs;
    let (base, filter) = (titled("Base", &inputs.base.name), titled("filter", &inputs.filter.name));
    let regraded = inputs.base.regraded_at_mm.map(|_| grading(&inputs.base.size()));
    let is_shown = is_named("Base", &inputs.base.name) || is_named("filter", &inputs.filter.name);
    html! {
        h1 { (QUESTION) }
        @if is_shown || regraded.is_some() {
            p.names { (base) @if let Some(words) = regraded { " (" (words) ")" } " against " (filter) }
        }
        (about(folder))
    }
}

/// Question that the page answers.
pub(super) const QUESTION: &str = "Will this filter hold this soil?";

/// Text at the foot of every printed page.
pub(super) fn foot_of(folder: &RunFolder) -> Option<String> {
    foot(&folder.about.cover)
}

fn about(folder: &RunFolder) -> Markup {
    let manifest = &folder.manifest;
    let program = program(&manifest.version, manifest.commit.as_deref());
    let day = manifest.finished.split('T').next().map(String::from);
    cover(&folder.about.cover.clone().dated(day), &program, Some(folder.outcome.seed))
}

/// The answer: the lines of practice and model, and the number of notes.
pub(super) fn answer(outcome: &Outcome, decision: &Decision, unit: SizeUnit) -> Markup {
    let notes = outcome.notes.len();
    html! {
        section.verdict.(colour(decision.headline)) {
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

/// The colour of an answer, by practice: neutral without it.
pub(super) fn colour(headline: Option<Headline>) -> &'static str {
    let Some(headline) = headline else { return "neutral" };
    match (headline, headline.class()) {
        (Headline::Meets, _) => "none",
        (Headline::BeyondDesign, _) => "some",
        (_, PracticeClass::DoesNotMeet) => "continuing",
        (_, PracticeClass::Meets | PracticeClass::NotKnown) => "doubted",
    }
}

/// The colour of the answer to a pair.
pub fn colour_of(outcome: &Outcome) -> &'static str {
    colour(outcome.headline)
}

/// Sizes of both soils as a table: the base as sampled and, if it is regraded, as regraded.
pub(super) fn sizes(outcome: &Outcome, unit: SizeUnit) -> Markup {
    let (filter, base) = (&outcome.inputs.filter, &outcome.inputs.base);
    let mut soils = vec![SizedSoil::new("Filter", &filter.gradation)];
    match &base.as_sampled {
        Some(sampled) => soils.extend([
            SizedSoil::new("Base, sampled", &sampled.gradation),
            SizedSoil::new("regraded", &base.gradation),
        ]),
        None => soils.push(SizedSoil::new("Base", &base.gradation)),
    }
    of_few(&soils, unit)
}

/// The rules of practice that decide or are not met, and the number of the others.
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

/// Number of these rules by result, those that are not met first.
fn counts(rules: &[&AppliedRule]) -> Vec<(usize, RuleResult)> {
    let with = [RuleResult::NotMet, RuleResult::Met, RuleResult::NotReached, RuleResult::ExcessiveNotJudged];
    let count = |result: RuleResult| rules.iter().filter(|rule| result_of(rule) == result).count();
    let counts = with.into_iter().chain(RuleResult::WITHOUT).map(|result| (count(result), result));
    counts.filter(|(count, _)| *count > 0).collect()
}

/// The rules that decide if a filter retains and drains a base, in reading order.
const DECIDING: [&str; 4] = [DESIGN, TESTS_NO_EROSION, TESTS_CONTINUING, PERMEABILITY];

/// The place of other rules that are not met.
const NOT_MET: usize = DECIDING.len();

/// The place of a rule: deciding rules first, then those that are not met, and then the others.
fn place(rule: &AppliedRule) -> usize {
    let deciding = DECIDING.iter().position(|id| *id == rule.id).filter(|_| rule.applies);
    match (deciding, result_of(rule)) {
        (Some(place), _) => place,
        (None, RuleResult::NotMet) => NOT_MET,
        (None, _) => NOT_MET + 1,
    }
}

/// The purpose of a rule, in a word or two.
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

/// The quantity of a rule without the soil and the splits, which “All rules” names.
fn quantity_in_brief(rule: &AppliedRule) -> &str {
    let name = rule.quantity.name();
    name.split([',', '(']).next().and_then(|name| name.split(" of the filter").next()).unwrap_or(name)
}

fn table(rules: &[&AppliedRule], unit: SizeUnit) -> Markup {
    let columns = rule::columns(unit).only(&["rule", "quantity", "value", "limit", "authority", "result"]);
    let table = Table::of(rules.iter().copied(), columns)
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
