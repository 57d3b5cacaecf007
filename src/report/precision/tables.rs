//! The tables of a precision study.

use maud::{Markup, Render, html};

use super::figures::between_networks;
use crate::outcome::precision::{
    BiasRow, ClosedRow, DecisionCase, DecisionRow, DecisionTier, ExactRow, ExactTier, PackingRow,
    PackingTier, Precision, SamplingLine, SamplingTier, ScalingRow, Slope, TriangulationRow,
};
use crate::report::quantity::{percent, significant};
use crate::report::table::Table;

/// A table of the study: its first column names the rows.
fn table<'a, T>(rows: impl IntoIterator<Item = &'a T>) -> Table<'a, T> {
    Table::of(rows).class("study")
}

/// A value that may be missing.
fn or_dash<T>(value: Option<T>, show: impl FnOnce(T) -> String) -> String {
    value.map_or_else(|| "–".to_owned(), show)
}

/// At the head of the page: what a second buys, by engine.
pub(super) fn merits(study: &Precision) -> Markup {
    let mut rows: Vec<[String; 4]> = Vec::new();
    for (_, row) in study.exact.iter().flat_map(last_of_each_line) {
        rows.push([
            format!("{}, {}", row.quantity, row.engine),
            format!("{:.1e}", row.error),
            significant(row.core_seconds).to_string(),
            or_dash(row.merit, |merit| format!("{merit:.1e}")),
        ]);
    }
    for line in study.sampling.iter().flat_map(|sampling| &sampling.lines) {
        let merits = line.merit.zip(line.merit_low.zip(line.merit_high));
        rows.push([
            format!("this scene, {}, {}", line.variant, line.networks),
            format!("{:.1e}", line.sd),
            significant(line.core_seconds).to_string(),
            or_dash(merits, |(merit, (low, high))| format!("{merit:.1e} ({low:.1e} to {high:.1e})")),
        ]);
    }
    html! {
        @if !rows.is_empty() {
            h3 { "Figures of merit" }
            (table(&rows)
                .text("Quantity and engine", |row| row[0].clone())
                .number("Error (–)", |row| row[1].clone())
                .number("Processor time (s)", |row| row[2].clone())
                .number("Figure of merit (1/s)", |row| row[3].clone()))
            p.small { "Each line is for the largest number of particles walked; lines of this scene are \
                       for one replicate." }
        }
    }
}

/// Each line with its row of the most particles.
fn last_of_each_line(exact: &ExactTier) -> Vec<(&Slope, &ExactRow)> {
    let of = |slope: &&Slope| {
        exact.rows.iter().rfind(|row| row.quantity == slope.quantity && row.engine == slope.engine)
    };
    exact.slopes.iter().filter_map(|slope| Some((slope, of(&slope)?))).collect()
}

pub(super) fn exact(exact: &ExactTier) -> Markup {
    let lines = last_of_each_line(exact);
    html! {
        ul { @for quantity in &exact.quantities {
            li { b { (quantity.name) } ": " (quantity.words) ", " (percent(quantity.mean)) " on average." }
        } }
        (table(&lines)
            .columns(ExactRow::columns(), |(_, row)| row)
            .columns(Slope::columns(), |(slope, _)| slope))
        p.small {
            "The largest |z| covers all networks and all numbers of particles at which a network expects at \
             least 50 particles to leave and 50 to stay."
        }
        h3 { "Integers and closed forms" }
        (table(&exact.closed).columns(ClosedRow::columns(), |row| row))
    }
}

pub(super) fn sampling(sampling: &SamplingTier) -> Markup {
    table(&sampling.lines)
        .columns(SamplingLine::columns(), |line| line)
        .number("SD between networks (points)", |line| {
            let new = line.networks == "new networks";
            let between = between_networks(sampling, line).filter(|_| new);
            or_dash(between, |sd| significant(100.0 * sd).to_string())
        })
        .render()
}

pub(super) fn bias(rows: &[BiasRow]) -> Markup {
    html! {
        (table(rows).columns(BiasRow::columns(), |row| row))
        p.small {
            "The twin is a second, slow implementation of the walk. It covers a small part of the network \
             with few base particles, and each particle keeps its own random numbers. Precision and blocking \
             are compared with the twin that follows the rules of the walk."
        }
    }
}

pub(super) fn decision(decision: &DecisionTier) -> Markup {
    html! {
        (table(&decision.cases).columns(DecisionCase::columns(), |case| case))
        details {
            summary { "Every rule tried" }
            (table(&decision.rows).columns(DecisionRow::columns(), |row| row))
        }
    }
}

pub(super) fn scaling(rows: &[ScalingRow]) -> Markup {
    let threads = || rows.iter().filter(|row| row.against == "threads");
    let speed_up = |row: &ScalingRow| {
        let one = threads().find(|one| one.engine == row.engine);
        or_dash(one, |one| format!("{:.2}", one.wall_seconds / row.wall_seconds))
    };
    html! {
        (table(threads())
            .columns(ScalingRow::columns(), |row| row)
            .number("Speed-up over one thread (–)", speed_up))
        p.small {
            "Counts use several threads only if many particles are walked one by one. Replicates that run \
             side by side use all threads."
        }
    }
}

pub(super) fn packing(tier: &PackingTier) -> Markup {
    html! {
        (table(&tier.packings).columns(PackingRow::columns(), |row| row))
        (table(&tier.triangulations).columns(TriangulationRow::columns(), |row| row))
    }
}
