//! The tables of results of a report page.

use maud::{Markup, html};

use super::quantity::{Quantity, length, percent, significant, whole};
use super::run_figures::run_name;
use super::table::Table;
use super::walks::Walks;
use crate::outcome::record::{Classed, OfThickness, Outcome, Replicate, Run, RunSummary, Verdict};
use crate::outcome::table::{Columns, Emphasis, Shown, TableCell};
use crate::words::capital;

/// Replicates listed one by one; all are in `outcome.json`.
const LISTED: usize = 100;

/// "First run", in the colour of the run.
pub(super) fn run_heading(run: u64) -> Shown {
    capital(run_name(run)).shown().emphasised(Emphasis::Run(run))
}

/// Means over the replicates.
pub(super) fn results(walks: &Walks) -> Markup {
    type Row<'a> = (&'static str, &'a dyn Fn(&RunSummary) -> Shown);
    let eroded = |mm: Option<f64>| mm.map_or("nothing eroded".shown(), |mm| length(mm, walks.unit).shown());
    let largest_ratio = |run: &RunSummary| match &run.largest_eroded_over_d15f {
        Some(statistic) => {
            let ends = statistic.low.zip(statistic.high);
            let ends = ends.map(|(low, high)| significant(low).to(significant(high)).to_string());
            statistic.mean.shown().below(ends)
        }
        None => eroded(None),
    };
    let largest = |run: &RunSummary| {
        let ratio = run.largest_eroded_over_d15f.as_ref();
        eroded(ratio.zip(walks.d15f_mm).map(|(ratio, d15f_mm)| ratio.mean * d15f_mm))
    };
    let largest_of_all = |run: &RunSummary| {
        let of_run = |replicate: &Replicate| replicate.runs.get(run.run as usize - 1)?.largest_eroded_mm;
        eroded(walks.replicates.iter().filter_map(of_run).reduce(f64::max))
    };
    let sd = |run: &RunSummary| run.eroded_mass_fraction.sd.map_or("none".shown(), |sd| percent(sd).shown());
    let of_largest: &[Row] = match walks.d15f_mm {
        Some(_) => {
            &[("Largest particle eroded, over D15F", &largest_ratio), ("Largest particle eroded", &largest)]
        }
        None => &[("Largest particle eroded in any replicate", &largest_of_all)],
    };
    let of_eroded: [Row; 3] = [
        ("Base eroded, by mass", &|run| run.eroded_mass_fraction.shown()),
        ("Its scatter from replicate to replicate (SD)", &sd),
        ("Base eroded, by number", &|run| run.eroded_number_fraction.shown()),
    ];
    let of_network: [Row; 3] = [
        ("Constrictions blocked at the end", &|run| run.blocked_fraction.shown()),
        ("Blocked in the first three layers", &|run| run.blocked_first_three_layers_fraction.shown()),
        ("Constrictions on an open path (backbone)", &|run| run.backbone_fraction.shown()),
    ];
    let rows = of_eroded.iter().chain(of_largest).chain(&of_network);
    let mut columns = Columns::default().name("mean", "Mean, and 95 % interval", |row: &Row| row.0);
    for run in walks.summary {
        let name = format!("run_{}", run.run);
        columns = columns.number(name, run_heading(run.run), move |row| (row.1)(run));
    }
    html! {
        h2 { "Results" }
        (Table::of(rows, columns))
    }
}

/// Each replicate, collapsed.
pub(super) fn replicates(walks: &Walks) -> Markup {
    let unit = walks.unit.short();
    let listed = walks.replicates.len().min(LISTED);
    let rows: Vec<(usize, &Replicate, &Run)> = (1..)
        .zip(walks.replicates.iter().take(LISTED))
        .flat_map(|(number, replicate)| replicate.runs.iter().map(move |run| (number, replicate, run)))
        .collect();
    let columns = Columns::default()
        .name("replicate", "Replicate", |row: &(usize, &Replicate, &Run)| row.0)
        .text("verdict", "Verdict", |(_, replicate, _)| class(replicate.verdict))
        .text("run", "Run", |(.., run)| run.run.to_string().shown().emphasised(Emphasis::Run(run.run)))
        .number("eroded_mass", "Eroded, mass", |(.., run)| percent(run.eroded_mass_fraction))
        .number("eroded_number", "number", |(.., run)| percent(run.eroded_number_fraction))
        .number("largest_eroded", format!("largest ({unit})"), |(.., run)| run.largest_eroded_mm)
        .number("largest_over_d15f", "/ D15F", |(.., run)| run.largest_eroded_over_d15f)
        .number("blocked", "Blocked", |(.., run)| percent(run.blocked_fraction))
        .number("blocked_first_three", "3 layers", |(.., run)| {
            percent(run.blocked_first_three_layers_fraction)
        })
        .number("backbone", "On an open path", |(.., run)| percent(run.backbone_fraction))
        .number("inserted", "Inserted", |(.., run)| particles(run.inserted))
        .number("eroded", "Eroded", |(.., run)| particles(run.eroded))
        .number("in_constrictions", "In constrictions", |(.., run)| particles(run.retained_in_constrictions))
        .number("in_voids", "In voids", |(.., run)| particles(run.retained_in_voids))
        .number("trapped", "Trapped", |(.., run)| particles(run.trapped))
        .number("retained_per_void", "Per void", |(.., run)| run.retained_per_void)
        .number("increments", "Increments", |(.., run)| particles(run.increments))
        .number("moves", "Moves", |(.., run)| particles(run.particle_moves));
    let table =
        Table::of(&rows, columns).class("replicates").showing("replicate", |(number, replicate, _)| {
            html! { (number) span.seed { " (seed " (replicate.seed) ")" } }
        });
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

/// A row of [`varied`]: the case with another amount of base or another thickness.
struct Varied<'a> {
    changed: &'static str,
    factor: f64,
    layers: u64,
    n_base: u64,
    walked: &'a Classed,
}

/// Other amounts of base and other thicknesses, each with its eroded mass and its class.
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
    let mut columns = Columns::default()
        .name("changed", "Changed", |row: &Varied| row.changed)
        .number("factor", "Times", |row| format!("×{}", significant(row.factor).in_digits(4)))
        .number("layers", "Layers of voids", |row| row.layers)
        .number("n_base", "Base particles, N_base", |row| row.n_base)
        .number("replicates", "Replicates", |row| row.walked.replicates.to_string());
    for (at, run) in outcome.summary.iter().enumerate() {
        let eroded = move |row: &Varied| row.walked.runs.get(at).copied();
        columns = columns.number(format!("eroded_{}", run.run), capital(run_name(run.run)), eroded);
    }
    let columns = columns.text("class", "Class", |row| class(row.walked.verdict));
    html! {
        @if outcome.studies_to_come {
            p.small { "Amount of base and thickness: not walked yet; voidwalk resume goes on with them." }
        }
        @if !rows.is_empty() { details {
            summary { "Amount of base and thickness (×1 has the class of this page)" }
            (Table::of(&rows, columns))
        } }
    }
}

/// A class whose words are never broken.
fn class(verdict: Verdict) -> Shown {
    verdict.shown().emphasised(Emphasis::Whole)
}
