//! Results of walks on a page: their tables, their comparison with Table 3 and Eq. (1) of the paper, and the
//! parts of the verdict box.

use super::run_figures;
use super::run_figures::run_name;
use super::shell::clean;
use super::table::Table;
use super::walks::Walks;
use crate::outcome::metrics::of_replicates;
use crate::outcome::record::{
    ByConnectivity, Classed, Infiltration, InfiltrationSize, ModelLimit, OfThickness, Outcome, Replicate,
    Run, RunSummary, Verdict,
};
use crate::outcome::statistic::percent_interval;
use crate::outcome::table::{Columns, Emphasis, Shown, TableCell};
use crate::words;
use crate::words::left_out::left_out_in_brief;
use crate::words::{FirstLine, capital, sentence};
use base64::Engine as _;
use base64::prelude::BASE64_STANDARD;
use maud::{Markup, Render, html};
use voidwalk_practice::Note;
use voidwalk_practice::quantity::{Quantity, SizeUnit, length, percent, significant, whole};

/// Maximum number of replicates listed one by one; all are in `outcome.json`.
const LISTED: usize = 100;

fn run_heading(run: u64) -> Shown {
    capital(run_name(run)).shown().emphasised(Emphasis::Run(run))
}

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
        (Table::new(rows, columns))
    }
}

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
        Table::new(&rows, columns).class("replicates").showing("replicate", |(number, replicate, _)| {
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

/// Number of particles that fits its column: three significant digits from ten thousand million upwards.
fn particles(number: u64) -> Quantity {
    if number < 10_000_000_000 { whole(number) } else { significant(number as f64) }
}

/// Row of [`varied`]: the case with another amount of base or another thickness.
struct Varied<'a> {
    changed: &'static str,
    factor: f64,
    layers: u64,
    n_base: u64,
    walked: &'a Classed,
}

/// Table of other amounts of base and other thicknesses, each with its eroded mass and its class.
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
            (Table::new(&rows, columns))
        } }
    }
}

/// Class whose words are never separated by a line break.
fn class(verdict: Verdict) -> Shown {
    verdict.shown().emphasised(Emphasis::Whole)
}

/// Empty if all voids have the same connectivity.
pub(super) fn by_connectivity(walks: &Walks) -> Markup {
    let runs: Vec<(u64, Vec<ByConnectivity>)> = walks
        .runs()
        .map(|run| (run, of_replicates(walks.replicates, run)))
        .filter(|(_, rows)| !rows.is_empty())
        .collect();
    html! {
        @if !runs.is_empty() {
            h2 { "By connectivity of the void" }
            p {
                "A void’s connectivity is the number of its entrances and exits. The network is not \
                 uniform: voids with few "
                "connections close early and then retain whatever enters (Table 3 of the paper). All \
                 replicates together."
            }
            @for (run, rows) in &runs { (of_run(*run, rows)) }
        }
    }
}

fn of_run(run: u64, rows: &[ByConnectivity]) -> Markup {
    let sum = |count: fn(&ByConnectivity) -> u64| rows.iter().map(count).sum::<u64>();
    let retained = sum(|r| r.retained_in_constrictions + r.retained_in_voids);
    let blocked = |blocked: u64, all: u64| percent(blocked as f64 / all.max(1) as f64);
    let columns = Columns::default()
        .number("connectivity", "Connectivity", |row: &ByConnectivity| row.connectivity.to_string())
        .number("voids", "Share of voids", |row| percent(row.voids_fraction))
        .number("retained_per_void", "Retained per void", |row| row.retained_per_void)
        .number("retained", "Share of retained", |row| percent(row.retained_fraction))
        .number("blocked", "Exits blocked", |row| blocked(row.blocked, row.constrictions));
    let all = html! { tr {
        th { "All (" (whole(sum(|r| r.voids))) " voids)" }
        td.n { (percent(1.0)) }
        td.n { (significant(retained as f64 / sum(|r| r.voids) as f64)) }
        td.n { (percent(1.0)) }
        td.n { (blocked(sum(|r| r.blocked), sum(|r| r.constrictions))) }
    } };
    html! {
        h3 { span class={ "run-" (run) } { (run_name(run)) } }
        (Table::new(rows, columns).more(all))
    }
}

/// Eq. (1) for single particles, the result of the walk, and the difference between them.
pub(super) fn infiltration(outcome: &Outcome, unit: SizeUnit) -> Markup {
    html! {
        h2 { "Infiltration depth without blocking" }
        @match &outcome.infiltration {
            None => p {
                "Not given: the closed form holds for a regular cubic lattice whose exits are chosen by \
                 area, and this network is not one."
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
    Table::new(&result.sizes, columns).render()
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

/// Meaning of the difference between the mass that leaves by Eq. (1) and the mass that left in the walk.
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

/// Eroded mass by run, with its interval.
pub(super) fn eroded_table(walks: &Walks) -> Markup {
    Table::new(walks.summary, eroded_columns()).render()
}

fn eroded_columns<'a>() -> Columns<'a, RunSummary> {
    Columns::default()
        .name("run", "Base eroded, by mass", |run: &RunSummary| run_heading(run.run))
        .number("mean", "mean", |run| percent(run.eroded_mass_fraction.mean))
        .number("interval", "95 % interval", |run| {
            percent_interval(&run.eroded_mass_fraction)
                .map_or_else(|| "none".to_owned(), |span| span.to_string())
        })
}

pub(super) fn in_words(walks: &Walks) -> String {
    words::meaning(walks.verdict, walks.summary, walks.threshold)
}

/// Classes of the replicates, counted, with the words for one replicate and for each of several.
fn tally(walks: &Walks, [single, several]: [&str; 2]) -> String {
    let count = walks.replicates.len();
    if count == 1 {
        return format!("1 replicate ({single}).");
    }
    let classes = Verdict::ALL.into_iter().filter_map(|class| {
        let number = walks.replicates.iter().filter(|replicate| replicate.verdict == class).count();
        let share = if number == count { "all".to_owned() } else { number.to_string() };
        (number > 0).then(|| format!("{} in {share}", class.words()))
    });
    let classes = classes.collect::<Vec<_>>().join(", ");
    format!("{count} replicates, each {several}: {classes}.")
}

/// Text on replicates below the table: their number, the threshold, and a warning for a single one.
pub(super) fn replicates_in_words(walks: &Walks, what: [&str; 2]) -> Markup {
    html! {
        p {
            (tally(walks, what)) " Threshold between the classes: "
            (percent(walks.threshold).in_digits(3)) "."
        }
        @if walks.replicates.len() == 1 {
            p {
                b { "One replicate: the scatter is unknown." }
                " Walk more replicates before relying on this."
            }
        }
    }
}

/// Brief verdict for a page of another program, such as a notebook: it needs no style, and the figure is an
/// image, so that several fit on one page. `lines` are those of practice and model, or of the model alone for
/// a network; `replicate` are the words for one replicate, and for each of several.
pub(super) fn brief(
    walks: &Walks,
    lines: &[(FirstLine, String)],
    meaning: &str,
    notes: &[Note],
    replicate: [&str; 2],
    limits: &[ModelLimit],
) -> String {
    let drawn = run_figures::verdict(walks);
    let picture = BASE64_STANDARD.encode(drawn.figure.file());
    let columns = eroded_columns().number("blocked", "constrictions blocked", |run| run.blocked_fraction);
    html! {
        div {
            @for (line, words) in lines { p { b { (line.name()) } ": " (clean(words)) "." } }
            p { (clean(meaning)) }
            ul { @for note in notes { li { (clean(&sentence(note, SizeUnit::Mm))) } } }
            img src={ "data:image/svg+xml;base64," (picture) }
                alt="Mean and 95 % interval of the eroded mass in each run, against the threshold";
            (Table::new(walks.summary, columns))
            (replicates_in_words(walks, replicate))
            p { (clean(&left_out_in_brief(limits))) }
        }
    }
    .into_string()
}
