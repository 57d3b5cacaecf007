//! The tables of a precision study.

use maud::{Markup, Render, html};

use super::figures::between_networks;
use crate::outcome::precision::{
    BiasRow, DecisionTier, ExactRow, ExactTier, PackingTier, Precision, SamplingTier, ScalingRow, Slope,
};
use crate::report::numbers::{duration, percent, significant, whole};
use crate::report::table::Table;

/// A table of the study: its first column names the rows.
fn table<'a, T>(rows: impl IntoIterator<Item = &'a T>) -> Table<'a, T> {
    Table::of(rows).class("study")
}

fn points(fraction: f64) -> String {
    significant(100.0 * fraction)
}

/// A difference in percentage points, with its sign.
fn signed(fraction: f64) -> String {
    let sign = if fraction < 0.0 { "−" } else { "+" };
    format!("{sign}{}", significant(100.0 * fraction.abs()))
}

/// A difference from the reference setting, with its interval.
fn difference(is_reference: bool, mean: f64, ends: [Option<f64>; 2], show: impl Fn(f64) -> String) -> String {
    match (is_reference, ends) {
        (true, _) => "reference".to_owned(),
        (_, [Some(low), Some(high)]) => format!("{} ({} to {})", show(mean), show(low), show(high)),
        _ => show(mean),
    }
}

/// A value that may be missing.
fn or_dash<T>(value: Option<T>, show: impl FnOnce(T) -> String) -> String {
    value.map_or_else(|| "–".to_owned(), show)
}

fn holds(holds: bool) -> &'static str {
    if holds { "✓" } else { "FAILED" }
}

/// At the head of the page: what a second buys, by engine.
pub(super) fn merits(study: &Precision) -> Markup {
    let mut rows: Vec<[String; 4]> = Vec::new();
    for (_, row) in study.exact.iter().flat_map(last_of_each_line) {
        rows.push([
            format!("{}, {}", row.quantity, row.engine),
            format!("{:.1e}", row.error),
            significant(row.core_seconds),
            or_dash(row.merit, |merit| format!("{merit:.1e}")),
        ]);
    }
    for line in study.sampling.iter().flat_map(|sampling| &sampling.lines) {
        let merits = line.merit.zip(line.merit_low.zip(line.merit_high));
        rows.push([
            format!("this scene, {}, {}", line.variant, line.networks),
            format!("{:.1e}", line.sd),
            significant(line.core_seconds),
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
                .number("1 / (error² time) (1/s)", |row| row[3].clone()))
            p.small { "Each line at the most particles that were walked; of this scene, one replicate." }
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
    let lines = table(&lines)
        .text("Line", |(slope, _)| format!("{}, {}", slope.quantity, slope.engine))
        .number("Most particles", |(_, row)| format!("{:.0e}", row.particles as f64))
        .number("Error (–)", |(_, row)| format!("{:.2e}", row.error))
        .number("of independent particles", |(_, row)| format!("{:.2e}", row.expected_error))
        .number("Slope", |(slope, _)| or_dash(slope.slope, |s| format!("{s:.3}")))
        .number("Largest |z| of a network", |(slope, _)| {
            slope.largest_z.map_or_else(|| "nothing drawn".into(), |z| format!("{z:.2}"))
        })
        .number("χ² and its degrees", |(_, row)| {
            or_dash(row.chi_squared, |chi| format!("{chi:.0} of {}", row.networks))
        });
    let closed = table(&exact.closed)
        .text("What", |row| row.what.clone())
        .number("Exact", |row| significant(row.exact))
        .number("Found", |row| match row.z {
            Some(_) => format!("{:.4}", row.found),
            None => row.found.to_string(),
        })
        .number("z", |row| row.z.map_or_else(|| "must be equal".into(), |z| format!("{z:+.2}")))
        .number("", |row| holds(row.holds))
        .number("Processor time (s)", |row| significant(row.core_seconds));
    html! {
        ul { @for quantity in &exact.quantities {
            li { b { (quantity.name) } ": " (quantity.words) ", " (percent(quantity.mean)) " on average." }
        } }
        (lines)
        p.small {
            "Largest |z|: of all networks, at every number of particles from which each network expects at \
             least 50 to "
            "leave and 50 to stay."
        }
        h3 { "Integers and closed forms" }
        (closed)
    }
}

pub(super) fn sampling(sampling: &SamplingTier) -> Markup {
    table(&sampling.lines)
        .text("Way of drawing and moving, replicates", |line| format!("{}, {}", line.variant, line.networks))
        .number("Number", |line| line.replicates)
        .number("Eroded mass (%)", |line| points(line.mean))
        .number("less the first line (points ± standard error)", |line| {
            let difference = signed(line.difference);
            or_dash(line.difference_error, |error| format!("{difference} ± {}", points(error)))
        })
        .number("Replicate SD (points)", |line| {
            format!("{} ({} to {})", points(line.sd), points(line.sd_low), points(line.sd_high))
        })
        .number("of which networks", |line| {
            let new = line.networks == "new networks";
            or_dash(between_networks(sampling, line).filter(|_| new), points)
        })
        .number("times the binomial", |line| significant(line.sd / line.binomial))
        .number("Processor time of a replicate (s)", |line| significant(line.core_seconds))
        .render()
}

pub(super) fn bias(rows: &[BiasRow]) -> Markup {
    html! {
        (table(rows)
            .text("Setting", |row| format!("{}: {}", row.factor, row.level))
            .number("Base particles", |row| whole(row.n_base))
            .number("Replicates", |row| {
                format!("{}{}", row.replicates, if row.paired { ", same networks" } else { "" })
            })
            .number("Eroded mass (%)", |row| points(row.value))
            .number("Difference (points, 95 %)", |row| {
                difference(row.reference, row.bias, [row.bias_low, row.bias_high], signed)
            })
            .number("Processor time of a replicate (s)", |row| significant(row.core_seconds)))
        p.small {
            "The twins are a slow walk of their own, on a small part of the network with few base particles, \
             in which each "
            "particle keeps its random numbers; precision and blocking are compared with the twin that \
             decides as the walk "
            "does."
        }
    }
}

pub(super) fn decision(decision: &DecisionTier) -> Markup {
    html! {
        (table(&decision.cases)
            .text("Case", |case| case.name.clone())
            .number("Factor on sizes", |case| significant(case.size_factor))
            .number("Base particles", |case| whole(case.n_base))
            .number("Replicates", |case| case.replicates)
            .number("First run, eroded mass (%, 95 %)", |case| {
                format!("{} ({} to {})", points(case.mean), points(case.low), points(case.high))
            })
            .number("Replicate SD (points)", |case| points(case.sd))
            .number("Class", |case| {
                format!("{}{}", case.class.words(), if case.certain { "" } else { " (inconclusive)" })
            })
            .number("Processor time of a replicate (s)", |case| significant(case.core_seconds)))
        details {
            summary { "Every rule tried" }
            (table(&decision.rows)
                .text("Case", |row| row.case.clone())
                .number("Rule", |row| row.rule.clone())
                .number("Replicates", |row| significant(row.replicates))
                .number("Wrong", |row| percent(row.wrong))
                .number("95 %", |row| format!("{} to {}", percent(row.wrong_low), percent(row.wrong_high)))
                .number("Without a class", |row| percent(row.undecided))
                .number("Processor time (s)", |row| significant(row.core_seconds)))
        }
    }
}

pub(super) fn scaling(rows: &[ScalingRow]) -> Markup {
    let threads = || rows.iter().filter(|row| row.against == "threads");
    html! {
        (table(threads())
            .text("Engine", |row| row.engine.clone())
            .number("Threads of one run", |row| row.threads)
            .number("Base particles", |row| whole(row.n_base))
            .number("Wall time (s)", |row| significant(row.wall_seconds))
            .number("Processor time (s)", |row| significant(row.core_seconds))
            .number("times as fast", |row| {
                let one = threads().find(|one| one.engine == row.engine);
                or_dash(one, |one| format!("{:.2}", one.wall_seconds / row.wall_seconds))
            })
            .number("Eroded mass (%)", |row| format!("{:.6}", 100.0 * row.eroded_mass_fraction)))
        p.small {
            "Counts use several threads only where particles walked one by one are many; replicates side by \
             side use them "
            "all."
        }
    }
}

pub(super) fn packing(tier: &PackingTier) -> Markup {
    html! {
        (table(&tier.packings)
            .text("Setting", |row| match row.factor.as_str() {
                "reference" => format!("friction {}, default settings", row.friction),
                factor => format!("friction {}, {factor} x {}", row.friction, row.at),
            })
            .number("Grains", |row| whole(row.grains))
            .number("At rest", |row| format!("{} of {}", row.settled, row.seeds))
            .number("Void ratio", |row| format!("{:.4}", row.void_ratio))
            .number("Difference (95 %)", |row| {
                let ends = [row.bias_low, row.bias_high];
                difference(row.reference, row.bias, ends, |value| format!("{value:+.4}"))
            })
            .number("Dc5, Dc50 (D0F)", |row| format!("{:.4}, {:.4}", row.dc5, row.dc50))
            .number("Dc50, difference", |row| format!("{:+.2} %", 100.0 * row.dc50_bias))
            .number("Cu of constrictions", |row| format!("{:.3}", row.cu_csd))
            .number("Processor time (s)", |row| significant(row.core_seconds)))
        (table(&tier.triangulations)
            .text("Packing", |row| row.packing.clone())
            .number("Grains", |row| whole(row.grains))
            .number("Tetrahedra", |row| whole(row.tetrahedra))
            .number("Constrictions", |row| whole(row.constrictions))
            .number("Triangulation", |row| duration(row.triangulate_seconds))
            .number("Voids, discs, curve", |row| duration(row.measure_seconds))
            .number("Identities", |row| holds(row.identities_hold)))
    }
}
