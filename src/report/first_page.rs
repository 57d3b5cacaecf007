//! The first sheet, which can be handed in by itself: for whom and by whom it is, the answer in four lines
//! and the findings that matter most, the gradations with their sizes, and every rule of practice in short.

use maud::{Markup, html};
use serde::Deserialize;

use super::cover::{LINE, cover, program};
use super::figures::shorten;
use super::folder::RunFolder;
use super::names::soil_name;
use super::numbers::{SizeUnit, whole};
use super::rules::value_and_limit;
use super::shell::{clean, unbroken};
use super::table::Table;
use crate::outcome::record::{AppliedRule, Confidence, Outcome, SheetCover, Verdict};
use crate::outcome::rules::Authority;
use crate::outcome::soil_sizes::sizes_of;
use crate::verdict::by_authority::{ON_ALL_RULES, of_pair, stated_by};
use crate::verdict::left_out::left_out_in_brief;
use crate::verdict::practice::{Standing, standing};
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
    let soil = |name: &str| clean(&shorten(&soil_name(name), LINE));
    html! {
        h1 { "Will this filter hold this soil?" }
        p.names {
            "Base " b { bdi { (soil(&inputs.base.name)) } } " against filter "
            b { bdi { (soil(&inputs.filter.name)) } }
        }
        (about(folder))
    }
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
    let (foremost, more) = outcome.foremost();
    html! {
        @let fails = standing(&outcome.rules) == Standing::Fails;
        section.verdict.(colour(outcome.verdict, outcome.confidence, fails)) {
            p.word { (clean(&capital(&headline))) "." }
            @for (name, said) in &lines { p.practice { b { (name) } ": " (unbroken(said)) "." } }
            @if !foremost.is_empty() {
                ul { @for finding in &foremost { li { (unbroken(&finding.sentence)) } } }
            }
            @if more > 0 { p.small { "and " (more) " more below, under “Other findings”" } }
        }
    }
}

/// The colour of the answer: never green where the model was not checked or practice does not agree, and
/// never that of a filter that holds where practice says that it does not.
pub(super) fn colour(verdict: Verdict, confidence: Confidence, fails: bool) -> &'static str {
    match verdict {
        Verdict::Continuing => "continuing",
        Verdict::Some | Verdict::Undecided if fails => "continuing",
        Verdict::None if fails || confidence != Confidence::Within => "doubted",
        Verdict::None => "none",
        Verdict::Some => "some",
        Verdict::Undecided => "undecided",
    }
}

/// Sizes of both soils as a table, of the base as sampled and as regraded where it is.
pub(super) fn sizes(outcome: &Outcome, unit: SizeUnit) -> Markup {
    let inputs = &outcome.inputs;
    let soil = |rows: &[[f64; 2]]| sizes_of(rows, unit);
    let (filter, base) = (&inputs.filter, &inputs.base);
    let mut soils = vec![("Filter", soil(&filter.gradation))];
    match &base.as_sampled {
        Some(sampled) => {
            soils.extend([("Base, sampled", soil(&sampled.gradation)), ("regraded", soil(&base.gradation))]);
        }
        None => soils.push(("Base", soil(&base.gradation))),
    }
    let rows: Vec<usize> = (0..soils[0].1.len()).collect();
    let mut table = Table::of(&rows).name(unit.name(), |row| soils[0].1[*row].0);
    for (name, sizes) in &soils {
        table = table.number(*name, |row| sizes[*row].1.clone().unwrap_or_else(|| "–".into()));
    }
    html! {
        div.sizes {
            (table)
            p.small { "Group by ASTM D2487, from the sieve curve. –: not known from the sieves." }
        }
    }
}

/// The rules of practice, one a line, and the thickness that was modelled.
pub(super) fn in_short(outcome: &Outcome, unit: SizeUnit, by: Authority) -> Markup {
    let stated = stated_by(&outcome.rules, by);
    let practice: Vec<&AppliedRule> = stated.iter().collect();
    let of_authority = of_pair(&outcome.rules, by, Some(outcome.inputs.filter.d15_mm));
    html! {
        section.short {
            h2 { "Rules of practice, in short" }
            @if practice.is_empty() { p { "No rule was applied." } } @else { (table(&practice, unit)) }
            @if let Some(said) = of_authority { p { b { (clean(&said)) " " (ON_ALL_RULES) } } }
            (thickness(outcome, unit))
            p.small { (clean(&left_out_in_brief(&outcome.model_leaves_out))) " The verdict of the walk is \
                the model’s. It does not replace a filter test or a designer’s judgement." }
        }
    }
}

/// What a rule found, where it was made for these soils.
fn result(rule: &AppliedRule) -> Option<bool> {
    rule.met.filter(|_| rule.applies)
}

fn table(rules: &[&AppliedRule], unit: SizeUnit) -> Markup {
    let table = Table::of(rules)
        .name("Rule", |rule| clean(&rule.name))
        .text("here", |rule| match &value_and_limit(rule, unit)[0] {
            Some(value) => html! { (clean(rule.quantity.name())) " " span.q { "= " (clean(value)) } },
            None => html! { "–" },
        })
        .text("limit", |rule| {
            let [_, limit] = value_and_limit(rule, unit);
            match limit.as_deref().map(clean) {
                Some(limit) if rule.at_least && rule.limit_at_most => {
                    html! { "not known; at most " span.q { (limit) } }
                }
                Some(limit) => html! {
                    span.q { (if rule.at_least { "≥ " } else { "≤ " }) (limit) }
                    @if rule.limit_at_most { " or less" }
                },
                None => html! { "–" },
            }
        })
        .text("", |rule| match (result(rule), rule.applies || !rule.needs.is_empty()) {
            (Some(true), _) => html! { span.keeps { "✓ met" } },
            (Some(false), _) => html! { span.breaks { "✗ not met" } },
            (None, true) if rule.value.is_some() && rule.limit.is_none() && rule.needs.is_empty() => {
                html! { "no limit" }
            }
            (None, true) => html! { "no result" },
            (None, false) => html! { "does not apply" },
        });
    html! { (table) }
}

/// How thick the filter is that was walked.
fn thickness(outcome: &Outcome, unit: SizeUnit) -> Markup {
    let network = &outcome.inputs.network;
    html! {
        @if let Some(thickness) = network.thickness_mm {
            p.thickness {
                "Thickness modelled: " b { (unit.size(thickness)) } " along the flow, "
                (whole(network.layers)) " layers of voids. "
                @if let Some(grain) = larger_grain(outcome, thickness) {
                    "That is less than the largest grain of the filter, " (unit.size(grain)) ". "
                }
                @if let Some(sentence) = thickness_moves(outcome) { (unbroken(&sentence)) }
            }
        }
    }
}

/// The largest grain of the filter, where the filter that was walked is thinner than that.
fn larger_grain(outcome: &Outcome, thickness: f64) -> Option<f64> {
    outcome.inputs.filter.gradation.last().map(|row| row[0]).filter(|grain| *grain > thickness)
}

/// How the verdict moves with the thickness.
fn thickness_moves(outcome: &Outcome) -> Option<String> {
    let ids = ["stays_with_thickness", "moves_with_thickness", "open_with_thickness"];
    ids.into_iter().find_map(|id| outcome.sentence_of(id))
}
