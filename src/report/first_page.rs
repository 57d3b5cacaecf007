//! What the first page says besides verdict and warnings, so that it can be handed in by itself: for whom and
//! by whom it is, the rules of practice in short, the thickness that was modelled.

use maud::{Markup, html};
use serde::Deserialize;

use super::figures::shorten;
use super::folder::RunFolder;
use super::names::soil_name;
use super::numbers::{in_digits, significant, size, whole};
use super::shell::clean;
use super::table::Table;
use crate::outcome::record::{AppliedRule, Outcome, RuleRole};

/// Characters of a text of the user's that are shown.
const LINE: usize = 120;

/// What the scene says of the page, and nothing else of it: a scene of another version has a page too.
#[derive(Default, Deserialize)]
struct Said {
    #[serde(default)]
    about: About,
}

#[derive(Default, Deserialize)]
#[serde(default)]
struct About {
    project: Option<String>,
    client: Option<String>,
    author: Option<String>,
    coarse_left: bool,
}

/// Whether gradations are drawn with coarse sizes on the left.
pub(super) fn coarse_left(folder: &RunFolder) -> bool {
    toml::from_str::<Said>(&folder.scene).unwrap_or_default().about.coarse_left
}

/// The two soils, and what belongs to a sheet that is handed in.
pub(super) fn header(folder: &RunFolder) -> Markup {
    let inputs = &folder.outcome.inputs;
    let soil = |name: &str| clean(&shorten(soil_name(name), LINE));
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
    let program = match manifest.commit.as_deref() {
        Some(commit) => format!("voidwalk {} ({})", manifest.version, shorten(commit, 12)),
        None => format!("voidwalk {}", manifest.version),
    };
    let facts = [
        ("Project", said.project),
        ("Client", said.client),
        ("Author", said.author),
        ("Date", manifest.finished.split('T').next().map(String::from)),
        ("Program", Some(program)),
        ("Seed", Some(folder.outcome.seed.to_string())),
    ];
    html! {
        dl.about { @for (name, value) in facts { @if let Some(value) = value {
            div { dt { (name) } " " dd { bdi { (clean(&shorten(&value, LINE))) } } }
        } } }
    }
}

/// The rules of practice that have a result, one a line, and the thickness that was modelled.
pub(super) fn in_short(outcome: &Outcome) -> Markup {
    let practice = || outcome.rules.iter().filter(|rule| rule.role != RuleRole::Walk);
    let judged: Vec<&AppliedRule> = practice().filter(|rule| result(rule).is_some()).collect();
    let without = practice().count() - judged.len();
    html! {
        section.short {
            h2 { "Rules of practice, in short" }
            @if judged.is_empty() { p { "No rule has a result for these soils." } } @else { (table(&judged)) }
            @if without > 0 && !judged.is_empty() {
                p.small {
                    (without) @if without == 1 { " more rule has" } @else { " more rules have" }
                    " no result here; all are below, with what they are for and where they are published."
                }
            }
            (thickness(outcome))
        }
    }
}

/// What a rule found, where it was made for these soils.
fn result(rule: &AppliedRule) -> Option<bool> {
    rule.met.filter(|_| rule.applies)
}

fn table(rules: &[&AppliedRule]) -> Markup {
    let table = Table::of(rules)
        .name("Rule", |rule| clean(&rule.name))
        .number("here", |rule| {
            let value = rule.value.map_or_else(|| "–".to_owned(), significant);
            html! { (clean(rule.quantity.name())) br; (value) }
        })
        .number("limit", |rule| {
            let sign = if rule.at_least { "≥" } else { "≤" };
            let limit = |limit: f64| format!("{sign} {} {}", in_digits(limit, 3), rule.unit);
            let limit = clean(rule.limit.map_or_else(|| "–".to_owned(), limit).trim_end());
            html! { (limit) @if rule.limit_at_most { " at most" } }
        })
        .text("", |rule| match result(rule) {
            Some(true) => html! { span.keeps { "✓ met" } },
            _ => html! { span.breaks { "✗ not met" } },
        });
    html! { (table) }
}

/// How thick the filter is that was walked.
fn thickness(outcome: &Outcome) -> Markup {
    let network = &outcome.inputs.network;
    html! {
        @if let Some(thickness) = network.thickness_mm {
            p.thickness {
                "Thickness modelled: " b { (size(thickness, outcome.inputs.scale_free)) } " along the flow, "
                (whole(network.layers)) " layers of voids. "
                @if let Some(sentence) = thickness_moves(outcome) { (clean(&sentence)) }
            }
        }
    }
}

/// How the verdict moves with the thickness.
fn thickness_moves(outcome: &Outcome) -> Option<String> {
    let ids = ["stays_with_thickness", "moves_with_thickness", "open_with_thickness"];
    ids.into_iter().find_map(|id| outcome.sentence_of(id))
}
