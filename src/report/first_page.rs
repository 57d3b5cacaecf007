//! The first sheet, which can be handed in by itself: for whom and by whom it is, the answer in four lines
//! and the findings that matter most, the gradations with their sizes, and every rule of practice in short.

use maud::{Markup, html};
use serde::Deserialize;

use super::cover::{cover, foot, program};
use super::folder::RunFolder;
use super::names::{is_named, titled};
use super::numbers::SizeUnit;
use super::rules::{result, value_and_limit};
use super::shell::{clean, model, unbroken};
use super::sizes::{SizedSoil, of_few};
use super::table::Table;
use crate::outcome::record::{AppliedRule, Headline, Outcome, PracticeClass, RuleRole, SheetCover};
use crate::outcome::rules::{DESIGN, PERMEABILITY, TESTS_NO_EROSION};
use crate::verdict::left_out::left_out_in_brief;
use crate::verdict::listed::listed;
use crate::verdict::rule_words::{RuleResult, limit_begins, limit_ends, result_of, value_begins};
use crate::verdict::words::capital;

/// What the scene says of the page, and nothing else of it.
#[derive(Default, Deserialize)]
struct Said {
    #[serde(default)]
    about: About,
}

#[derive(Default, Deserialize)]
#[serde(default)]
struct About {
    #[serde(flatten)]
    cover: SheetCover,
    coarse_left: bool,
    units: Option<String>,
}

/// Whether gradations are drawn with coarse sizes on the left.
pub(super) fn coarse_left(folder: &RunFolder) -> bool {
    toml::from_str::<Said>(&folder.scene).unwrap_or_default().about.coarse_left
}

/// What sizes on the first sheet are shown in.
pub(super) fn units(folder: &RunFolder) -> SizeUnit {
    let said = toml::from_str::<Said>(&folder.scene).unwrap_or_default().about.units;
    SizeUnit::of(folder.outcome.inputs.scale_free, said.as_deref() == Some("us"))
}

/// The two soils, and what belongs to a sheet that is handed in.
pub(super) fn header(folder: &RunFolder) -> Markup {
    let inputs = &folder.outcome.inputs;
    let (base, filter) = (titled("Base", &inputs.base.name), titled("filter", &inputs.filter.name));
    let is_said = base.0 != "Base" || is_named("filter", &inputs.filter.name);
    html! {
        h1 { (QUESTION) }
        @if is_said { p.names { (base) " against " (filter) } }
        (model())
        (about(folder))
    }
}

/// What the page answers.
pub(super) const QUESTION: &str = "Will this filter hold this soil?";

/// What is printed at the foot of every page.
pub(super) fn foot_of(folder: &RunFolder) -> Option<String> {
    foot(&toml::from_str::<Said>(&folder.scene).unwrap_or_default().about.cover)
}

fn about(folder: &RunFolder) -> Markup {
    let said = toml::from_str::<Said>(&folder.scene).unwrap_or_default().about;
    let manifest = &folder.manifest;
    let program = program(&manifest.version, manifest.commit.as_deref());
    let day = manifest.finished.split('T').next().map(String::from);
    cover(&said.cover.dated(day), &program, Some(folder.outcome.seed))
}

/// The answer: the lines of practice and model, and the findings that matter most.
pub(super) fn answer(outcome: &Outcome) -> Markup {
    let (foremost, more) = outcome.foremost();
    html! {
        section.verdict.(colour(outcome.headline)) {
            @for (name, words) in outcome.first_lines() {
                p.practice { b { (name) } ": " (unbroken(&words)) "." }
                @if name == "Practice" && let Some(alone) = outcome.judged_alone() {
                    p.counted { (alone) }
                }
            }
            @if !foremost.is_empty() {
                ul { @for finding in foremost { li { (unbroken(&finding.sentence)) } } }
            }
            @if more > 0 { p.small { "and " (more) " more below, under “Other findings”" } }
        }
    }
}

/// The colour of an answer, which is that of practice: neutral without it.
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

/// Sizes of both soils as a table, of the base as sampled and as regraded where it is.
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

/// The rules of practice, those that decide first, and the thickness that was modelled.
pub(super) fn in_short(outcome: &Outcome, unit: SizeUnit) -> Markup {
    let rules = listed(&outcome.rules);
    let mut practice: Vec<&AppliedRule> = rules.iter().filter(|rule| rule.role != RuleRole::Walk).collect();
    practice.sort_by_key(|rule| place(rule));
    let (shown, others): (Vec<&AppliedRule>, Vec<&AppliedRule>) =
        practice.into_iter().partition(|rule| place(rule) < WITHOUT_RESULT);
    let is_empty = shown.is_empty() && others.is_empty();
    let range = outcome.practice.as_ref().and_then(|practice| practice.range_of_tests_mm);
    html! {
        section.short {
            h2 { "Rules of practice, in short" }
            @if is_empty { p { "No rule was applied." } }
            @if !shown.is_empty() { (table(&shown, unit)) }
            @if !others.is_empty() {
                p.others {
                    @for kind in RuleResult::WITHOUT {
                        @let of_kind = others.iter().filter(|of| result_of(of) == kind);
                        @let names: Vec<&str> = of_kind.map(|of| &*of.name).collect();
                        @if !names.is_empty() {
                            b { (capital(kind.words())) } ": " (clean(&names.join("; "))) ". "
                        }
                    }
                }
            }
            @if let Some([low, high]) = range {
                p {
                    "Tests of bases with such fines began to erode at a D15F of " (unit.greatest(low)) " to "
                    (unit.least(high)) " mm (Fell et al., Table 9.2)."
                }
            }
            p.small { (clean(&left_out_in_brief(&outcome.model_leaves_out))) " The model does not replace \
                a filter test or a designer’s judgement." }
        }
    }
}

/// The rules that decide whether a filter retains and drains a base, in the order of a reader.
const DECIDING: [&str; 3] = [DESIGN, TESTS_NO_EROSION, PERMEABILITY];

/// The place of rules without a result, which stand below the table.
const WITHOUT_RESULT: usize = DECIDING.len() + 2;

/// Where a rule stands: those that decide first, then those that are not met, and then the others.
fn place(rule: &AppliedRule) -> usize {
    let deciding = DECIDING.iter().position(|id| *id == rule.id);
    match (deciding, result_of(rule)) {
        (Some(place), _) => place,
        (None, RuleResult::NotMet) => DECIDING.len(),
        (None, of) if RuleResult::WITHOUT.contains(&of) => WITHOUT_RESULT,
        (None, _) => DECIDING.len() + 1,
    }
}

fn table(rules: &[&AppliedRule], unit: SizeUnit) -> Markup {
    let table = Table::of(rules)
        .name("Rule", |rule| match DECIDING.contains(&rule.id.as_str()) {
            true => html! { b { (clean(&rule.name)) } },
            false => html! { (clean(&rule.name)) },
        })
        .text("here", |rule| match &value_and_limit(rule, unit)[0] {
            Some(value) => html! {
                (clean(rule.quantity.name())) " " span.q { (value_begins(rule)) " " (clean(value)) }
            },
            None => html! { "–" },
        })
        .text("limit", |rule| {
            let [_, limit] = value_and_limit(rule, unit);
            match limit.as_deref().map(clean) {
                Some(limit) if rule.at_least && rule.limit_at_most => html! {
                    span.q { (limit_begins(rule)) } " " span.q { (limit) (limit_ends(rule)) }
                },
                Some(limit) => html! { span.q { (limit_begins(rule)) " " (limit) } (limit_ends(rule)) },
                None => html! { "–" },
            }
        })
        .text("result", |rule| result(rule));
    html! { (table) }
}
