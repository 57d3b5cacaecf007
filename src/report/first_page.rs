//! The first sheet, which can be handed in by itself: for whom and by whom it is, the answer in four lines
//! and the findings that matter most, the gradations with their sizes, and every rule of practice in short.

use maud::{Markup, html};
use serde::Deserialize;

use super::cover::{cover, foot, program};
use super::folder::RunFolder;
use super::names::{is_named, titled};
use super::numbers::{SizeUnit, size, whole};
use super::rules::{result, value_and_limit};
use super::shell::{clean, model, unbroken};
use super::sizes::{SizedSoil, of_few};
use super::table::Table;
use crate::outcome::comparison::ComparedStanding;
use crate::outcome::record::{
    AppliedRule, Confidence, FindingRecord, NetworkKind, Outcome, SheetCover, Verdict,
};
use crate::outcome::rules::{Authority, DESIGN, PERMEABILITY, TESTS_NO_EROSION};
use crate::verdict::FOREMOST;
use crate::verdict::beside::NOT_COUNTED;
use crate::verdict::by_authority::{ON_ALL_RULES, of_pair, stated_by};
use crate::verdict::left_out::left_out_in_brief;
use crate::verdict::practice::standing;
use crate::verdict::rule_words::{RuleResult, limit_begins, limit_ends, result_of, value_begins};
use crate::verdict::words::capital;

/// What the scene says of the page, and nothing else of it: a scene of another version has a page too.
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
    authority: Option<String>,
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

/// Whose rules the first sheet lists.
pub(super) fn authority(folder: &RunFolder) -> Authority {
    let said = toml::from_str::<Said>(&folder.scene).unwrap_or_default().about.authority;
    said.as_deref().and_then(Authority::named).unwrap_or_default()
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

/// The answer: four lines, and the findings that matter most.
pub(super) fn answer(outcome: &Outcome) -> Markup {
    let [(_, headline), lines @ ..] = outcome.first_lines();
    let all = findings(outcome);
    let (foremost, more) = all.split_at(all.len().min(FOREMOST));
    html! {
        section.verdict.(colour_of(outcome)) {
            p.word { (clean(&capital(&headline))) "." }
            @for (name, said) in &lines {
                p.practice { b { (name) } ": " (unbroken(said)) "." }
                @if *name == "Practice" && let Some(alone) = outcome.judged_alone() {
                    p.counted { (alone) }
                }
                // Beside the mass that is counted.
                @if let Some(not_counted) = outcome.not_counted().filter(|_| *name == "Walk") {
                    p.counted { (unbroken(&not_counted)) }
                }
            }
            @if !foremost.is_empty() {
                ul { @for finding in foremost { li { (unbroken(&finding.sentence)) } } }
            }
            @if !more.is_empty() {
                p.small { "and " (more.len()) " more below, under “Other findings”" }
            }
        }
    }
}

/// What is said of the thickness below the rules: how much was walked, and whether the verdict moves with it.
const OF_THICKNESS: [&str; 2] = ["modelled_thickness", MOVES_WITH_THICKNESS];
const MOVES_WITH_THICKNESS: &str = "moves_with_thickness";

/// All findings in the order of a reader, but those that stand elsewhere on the first sheet.
pub(super) fn findings(outcome: &Outcome) -> Vec<FindingRecord> {
    let is_elsewhere = |finding: &FindingRecord| {
        let of_thickness = OF_THICKNESS.contains(&finding.id.as_str());
        finding.id == NOT_COUNTED || (of_thickness && outcome.inputs.network.thickness_mm.is_some())
    };
    let all = outcome.ordered().into_iter();
    all.filter(|finding| !is_elsewhere(finding)).collect()
}

/// The colour of the answer to a pair.
pub fn colour_of(outcome: &Outcome) -> &'static str {
    colour(outcome.verdict, outcome.confidence, Some(standing(&outcome.rules).recorded()))
}

/// The colour of the answer: that of a filter that does not hold where practice says so, whatever the walk
/// says, and not where practice is met; never green where the model was not checked or practice does not
/// agree.
pub(super) fn colour(
    verdict: Verdict,
    confidence: Confidence,
    standing: Option<ComparedStanding>,
) -> &'static str {
    match (standing, verdict) {
        (Some(ComparedStanding::Fails), _) => "continuing",
        (Some(ComparedStanding::Met), Verdict::Continuing) => "some",
        (_, Verdict::Continuing) => "continuing",
        (_, Verdict::None) if confidence != Confidence::Within => "doubted",
        (_, Verdict::None) => "none",
        (_, Verdict::Some) => "some",
        (_, Verdict::Undecided) => "undecided",
    }
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
pub(super) fn in_short(outcome: &Outcome, unit: SizeUnit, by: Authority) -> Markup {
    let stated = stated_by(&outcome.rules, by);
    let mut practice: Vec<&AppliedRule> = stated.iter().collect();
    practice.sort_by_key(|rule| place(rule));
    let (shown, others): (Vec<&AppliedRule>, Vec<&AppliedRule>) =
        practice.into_iter().partition(|rule| place(rule) < WITHOUT_RESULT);
    let of_authority = of_pair(&outcome.rules, by, Some(outcome.inputs.filter.d15_mm), outcome.if_dispersive);
    html! {
        section.short {
            h2 { "Rules of practice, in short" }
            @if stated.is_empty() { p { "No rule was applied." } }
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
            @if let Some(said) = of_authority { p { b { (clean(&said)) " " (ON_ALL_RULES) } } }
            (thickness(outcome, unit))
            p.small { (clean(&left_out_in_brief(&outcome.model_leaves_out))) " The verdict of the walk is \
                the model’s. It does not replace a filter test or a designer’s judgement." }
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

/// How thick the filter is that was walked.
fn thickness(outcome: &Outcome, unit: SizeUnit) -> Markup {
    let network = &outcome.inputs.network;
    html! {
        @if let Some(thickness) = network.thickness_mm {
            p.thickness {
                "The walk models " b { (unit.size(thickness)) } " of the filter"
                (outcome.beside_thickness(thickness, |mm| unit.size(mm))) ": "
                (whole(network.layers)) " layers of voids"
                @if network.kind != NetworkKind::Graph {
                    ", each D50F by number, "
                    (size(outcome.inputs.filter.d50_by_number_mm, outcome.inputs.scale_free))
                }
                ". "
                @if let Some(sentence) = outcome.sentence_of(MOVES_WITH_THICKNESS) { (unbroken(&sentence)) }
            }
        }
    }
}
