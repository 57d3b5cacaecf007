//! The section on Eq. (1) of a report page.

use maud::{Markup, Render, html};

use super::run_figures::run_name;
use super::table::Table;
use crate::outcome::record::{Infiltration, InfiltrationSize, Outcome, Run};
use crate::outcome::table::{Columns, TableCell};
use voidwalk_practice::quantity::{SizeUnit, length, percent, whole};

/// Eq. (1) for single particles, the result of the walk, and their difference.
pub(super) fn infiltration(outcome: &Outcome, unit: SizeUnit) -> Markup {
    html! {
        h2 { "Infiltration depth without blocking" }
        @match &outcome.infiltration {
            None => p {
                "Not given: the closed form holds for a regular cubic lattice whose exits are chosen by \
                 area, and this network is another."
            },
            Some(result) => details {
                summary { "Eq. (1) for single particles, beside the walk" }
                p {
                    "How far a single particle gets in the clean filter: with a confidence P of \
                     95 % (or 99 %) it does not pass more than n = ln(1 − P) / ln(P(F)) layers, where P(F) \
                     is its chance to move one layer downstream in the directed lattice that is walked. \
                     Nothing is blocked here."
                }
                (sizes(result, unit))
                (beside_the_walk(result, outcome, unit))
            },
        }
    }
}

fn sizes(result: &Infiltration, unit: SizeUnit) -> Markup {
    let layers = |layers: Option<f64>| layers.map_or("no end".shown(), TableCell::shown);
    let columns = Columns::default()
        .name("particle", "Particle", |row: &InfiltrationSize| row.name.clone())
        .number("diameter_mm", "Size", |row| length(row.diameter_mm, unit))
        .number("downstream", "Chance to move one layer on", |row| format!("{:.4}", row.downstream))
        .number("layers_95", "Layers, 95 %", |row| layers(row.layers_95))
        .number("layers_99", "Layers, 99 %", |row| layers(row.layers_99))
        .number("through", format!("Passes all {}", whole(result.layers)), |row| percent(row.through));
    Table::of(&result.sizes, columns).render()
}

fn beside_the_walk(result: &Infiltration, outcome: &Outcome, unit: SizeUnit) -> Markup {
    // Mean over the replicates that have the quantity.
    let mean = |run: u64, quantity: fn(&Run) -> Option<f64>, show: &dyn Fn(f64) -> String| {
        let runs = outcome.replicates.iter().flat_map(|r| &r.runs).filter(|r| r.run == run);
        let values: Vec<f64> = runs.filter_map(quantity).collect();
        match values.len() {
            0 => "none".to_owned(),
            n => show(values.iter().sum::<f64>() / n as f64),
        }
    };
    let in_unit = |d| length(d, unit).to_string();
    let layer = |layer| format!("{layer:.1}");
    let eroded = |run: usize| outcome.summary.get(run).map(|s| s.eroded_mass_fraction.mean);
    html! {
        ul {
            li {
                "By the closed form particles up to "
                (length(result.coarsest_through_mm, unit))
                " pass all layers with a probability of 5 % or more. The largest that left in the walk: "
                @for (index, run) in outcome.summary.iter().enumerate() {
                    @if index > 0 { ", " }
                    (mean(run.run, |r| r.largest_eroded_mm, &in_unit))
                    " (" (run_name(run.run)) ")"
                }
                ", mean over the replicates. Among many particles a few get farther than that."
            }
            li {
                "Layers with retained particles, counted from 0: "
                @for (index, run) in outcome.summary.iter().enumerate() {
                    @if index > 0 { "; " }
                    "down to " (mean(run.run, |r| Some(r.deepest_retained_layer? as f64), &layer))
                    ", 95 % of them down to " (mean(run.run, |r| Some(r.retained_95_layer? as f64), &layer))
                    " (" (run_name(run.run)) ")"
                }
                ", means over the replicates."
            }
            @if let Some(first) = eroded(0) { li {
                "If nothing were ever blocked, " b { (percent(result.eroded_without_blocking)) }
                " of the base’s mass would leave; in the walk " b { (percent(first)) }
                " left in the first run"
                @if let Some(second) = eroded(1) { " and " b { (percent(second)) } " in the second" }
                ". "
                (what_blocking_does(result.eroded_without_blocking - first))
            } }
        }
    }
}

/// Meaning of the difference between the mass that Eq. (1) lets through and the mass that left.
fn what_blocking_does(held: f64) -> &'static str {
    if held > 0.01 {
        "The difference is due to blocking: coarser particles close constrictions, and finer ones that would \
         pass a clean filter stay behind them."
    } else if held < -0.01 {
        "More left than a clean filter lets pass: a constriction that stops one particle is closed to the \
         next, which then takes a coarser exit."
    } else {
        "Blocking changes little here: what a clean filter lets pass leaves."
    }
}
