//! The tables of results of a report page.

use maud::{Markup, Render, html};

use super::quantity::{Quantity, SizeUnit, Span, length, percent, percent_interval, significant, whole};
use super::run_figures::run_name;
use super::table::Table;
use super::walks::Walks;
use crate::outcome::record::{Classed, OfThickness, Outcome, Replicate, Run, RunSummary, Statistic, Verdict};
use crate::words::capital;

/// Replicates listed one by one; all are in `outcome.json`.
const LISTED: usize = 100;

/// "First run", in the colour of the run.
pub(super) fn run_heading(run: u64) -> Markup {
    html! { span class={ "run-" (run) } { (capital(run_name(run))) } }
}

/// A mean with its interval below it.
fn with_interval(mean: Quantity, interval: Option<Span>) -> Markup {
    html! {
        (mean)
        @if let Some(interval) = interval { br; span.small { (interval) } }
    }
}

/// A fraction in percent, with its interval below it.
pub(super) fn fraction(statistic: &Statistic) -> Markup {
    with_interval(percent(statistic.mean), percent_interval(statistic))
}

/// Means over the replicates.
pub(super) fn results(walks: &Walks) -> Markup {
    type Row<'a> = (&'static str, &'a dyn Fn(&RunSummary) -> Markup);
    let scale_free = walks.scale_free;
    let nothing = || html! { "nothing eroded" };
    let largest_ratio = |run: &RunSummary| match &run.largest_eroded_over_d15f {
        Some(of) => {
            let ends = of.low.zip(of.high);
            let ends = ends.map(|(low, high)| significant(low).to(significant(high)));
            with_interval(significant(of.mean), ends)
        }
        None => nothing(),
    };
    let largest = |run: &RunSummary| match (&run.largest_eroded_over_d15f, walks.d15f_mm) {
        (Some(of), Some(d15f_mm)) => html! { (length(of.mean * d15f_mm, SizeUnit::of(scale_free, false))) },
        _ => nothing(),
    };
    let largest_of_all = |run: &RunSummary| {
        let of_run = |replicate: &Replicate| replicate.runs.get(run.run as usize - 1)?.largest_eroded_mm;
        let largest = walks.replicates.iter().filter_map(of_run).reduce(f64::max);
        largest.map_or_else(nothing, |mm| html! { (length(mm, SizeUnit::of(scale_free, false))) })
    };
    let sd = |run: &RunSummary| {
        let sd = run.eroded_mass_fraction.sd;
        html! { (sd.map_or_else(|| "none".to_owned(), |sd| percent(sd).to_string())) }
    };
    let of_largest: &[Row] = match walks.d15f_mm {
        Some(_) => {
            &[("Largest particle eroded, over D15F", &largest_ratio), ("Largest particle eroded", &largest)]
        }
        None => &[("Largest particle eroded in any replicate", &largest_of_all)],
    };
    let of_eroded: [Row; 3] = [
        ("Base eroded, by mass", &|run| fraction(&run.eroded_mass_fraction)),
        ("Its scatter from replicate to replicate (SD)", &sd),
        ("Base eroded, by number", &|run| fraction(&run.eroded_number_fraction)),
    ];
    let of_network: [Row; 3] = [
        ("Constrictions blocked at the end", &|run| fraction(&run.blocked_fraction)),
        ("Blocked in the first three layers", &|run| fraction(&run.blocked_first_three_layers_fraction)),
        ("Constrictions on an open path (backbone)", &|run| fraction(&run.backbone_fraction)),
    ];
    let rows = of_eroded.iter().chain(of_largest).chain(&of_network);
    let mut table = Table::of(rows).name("Mean, and 95 % interval", |row| row.0);
    for run in walks.summary {
        table = table.number(run_heading(run.run), move |row| (row.1)(run));
    }
    html! {
        h2 { "Results" }
        (table)
    }
}

/// Each replicate, collapsed.
pub(super) fn replicates(walks: &Walks) -> Markup {
    let unit = SizeUnit::of(walks.scale_free, false).short();
    let of_known =
        |value: Option<f64>| value.map_or_else(|| "–".to_owned(), |value| significant(value).to_string());
    let listed = walks.replicates.len().min(LISTED);
    let rows: Vec<(usize, &Replicate, &Run)> = (1..)
        .zip(walks.replicates.iter().take(LISTED))
        .flat_map(|(number, replicate)| replicate.runs.iter().map(move |run| (number, replicate, run)))
        .collect();
    let table = Table::of(&rows)
        .class("replicates")
        .name("Replicate", |(number, replicate, _)| {
            html! { (number) span.seed { " (seed " (replicate.seed) ")" } }
        })
        .text("Verdict", |(_, replicate, _)| class(replicate.verdict))
        .text("Run", |(.., run)| html! { span class={ "run-" (run.run) } { (run.run) } })
        .number("Eroded, mass", |(.., run)| percent(run.eroded_mass_fraction))
        .number("number", |(.., run)| percent(run.eroded_number_fraction))
        .number(format!("largest ({unit})"), |(.., run)| of_known(run.largest_eroded_mm))
        .number("/ D15F", |(.., run)| of_known(run.largest_eroded_over_d15f))
        .number("Blocked", |(.., run)| percent(run.blocked_fraction))
        .number("3 layers", |(.., run)| percent(run.blocked_first_three_layers_fraction))
        .number("On an open path", |(.., run)| percent(run.backbone_fraction))
        .number("Inserted", |(.., run)| particles(run.inserted))
        .number("Eroded", |(.., run)| particles(run.eroded))
        .number("In constrictions", |(.., run)| particles(run.retained_in_constrictions))
        .number("In voids", |(.., run)| particles(run.retained_in_voids))
        .number("Trapped", |(.., run)| particles(run.trapped))
        .number("Per void", |(.., run)| significant(run.retained_per_void))
        .number("Increments", |(.., run)| particles(run.increments))
        .number("Moves", |(.., run)| particles(run.particle_moves));
    html! {
        details {
            summary {
                "Each replicate (" (listed)
                @if listed < walks.replicates.len() { " of " (walks.replicates.len()) } ")"
            }
            (table)
            p.small {
                span.counts {
                    "Inserted, eroded, in constrictions, in voids and trapped count particles; per void is \
                     all retained particles over voids; trapped particles are trapped in closed loops. "
                }
                "On paper seeds, counts of particles, increments and moves are left out; outcome.json holds \
                 them."
            }
        }
    }
}

/// A number of particles that fits its column: from ten thousand million on in three digits.
fn particles(number: u64) -> Quantity {
    if number < 10_000_000_000 { whole(number) } else { significant(number as f64) }
}

/// With a column a run of what eroded in each row.
pub(super) fn eroded<'a, T>(
    table: Table<'a, T>,
    runs: impl IntoIterator<Item: Render>,
    walked: fn(&T) -> &Classed,
) -> Table<'a, T> {
    let of =
        |index: usize| move |row: &T| walked(row).runs.get(index).map_or_else(|| html! { "–" }, fraction);
    runs.into_iter().enumerate().fold(table, |table, (index, run)| table.number(run, of(index)))
}

/// A row of [`varied`]: the case with another amount of base or another thickness.
struct Varied<'a> {
    changed: &'static str,
    factor: f64,
    layers: u64,
    n_base: u64,
    walked: &'a Classed,
}

/// Other amounts of base and other thicknesses, with what eroded of each and its class.
pub(super) fn varied(outcome: &Outcome) -> Markup {
    let layers = outcome.inputs.network.layers;
    let amounts = outcome.sensitivity.iter().map(|row| {
        let (factor, n_base, walked) = (row.factor, row.n_base, &row.walked);
        Varied { changed: "Amount of base", factor, layers, n_base, walked }
    });
    let thicknesses = outcome.thickness.iter().map(|row| {
        let OfThickness { factor, layers, n_base, ref walked, .. } = *row;
        Varied { changed: "Thickness", factor, layers, n_base, walked }
    });
    let rows: Vec<Varied> = amounts.chain(thicknesses).collect();
    let table = Table::of(&rows)
        .name("Changed", |row| row.changed)
        .number("Times", |row| format!("×{}", significant(row.factor).in_digits(4)))
        .number("Layers of voids", |row| whole(row.layers))
        .number("Base particles, N_base", |row| whole(row.n_base))
        .number("Replicates", |row| row.walked.replicates);
    let runs = outcome.summary.iter().map(|run| capital(run_name(run.run)));
    let table = eroded(table, runs, |row| row.walked);
    html! {
        @if outcome.studies_to_come {
            p.small { "Amount of base and thickness: not walked yet; voidwalk resume goes on with them." }
        }
        @if !rows.is_empty() { details {
            summary { "Amount of base and thickness (×1 has the class of this page)" }
            (table.text("Class", |row| class(row.walked.verdict)))
        } }
    }
}

/// A class, of which no word is broken.
fn class(verdict: Verdict) -> Markup {
    html! { span.whole { (verdict.words()) } }
}
