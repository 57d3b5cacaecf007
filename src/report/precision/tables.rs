//! The tables of a precision study.

use maud::{Markup, html};

use super::figures::between_networks;
use crate::outcome::precision::{
    BiasRow, DecisionTier, ExactRow, ExactTier, PackingTier, Precision, SamplingTier, ScalingRow,
};
use crate::report::numbers::{duration, percent, significant, whole};

/// A table of texts, the first column left, the others right.
fn table(head: &[&str], rows: Vec<Vec<String>>) -> Markup {
    html! {
        div.scroll { table.study {
            thead { tr { @for (i, cell) in head.iter().enumerate() {
                @if i == 0 { th { (cell) } } @else { th.n { (cell) } }
            } } }
            tbody { @for row in &rows { tr { @for (i, cell) in row.iter().enumerate() {
                @if i == 0 { td { (cell) } } @else { td.n { (cell) } }
            } } } }
        } }
    }
}

fn points(fraction: f64) -> String {
    significant(100.0 * fraction)
}

/// A difference in percentage points, with its sign.
fn signed(fraction: f64) -> String {
    let sign = if fraction < 0.0 { "−" } else { "+" };
    format!("{sign}{}", significant(100.0 * fraction.abs()))
}

/// At the head of the page: what a second buys, by engine.
pub(super) fn merits(study: &Precision) -> Markup {
    let mut rows = Vec::new();
    if let Some(exact) = &study.exact {
        for row in last_of_each_line(exact) {
            rows.push(vec![
                format!("{}, {}", row.quantity, row.engine),
                format!("{:.1e}", row.error),
                significant(row.core_seconds),
                row.merit.map_or_else(|| "–".into(), |merit| format!("{merit:.1e}")),
            ]);
        }
    }
    if let Some(sampling) = &study.sampling {
        for line in &sampling.lines {
            let interval = match (line.merit, line.merit_low, line.merit_high) {
                (Some(merit), Some(low), Some(high)) => format!("{merit:.1e} ({low:.1e} to {high:.1e})"),
                _ => "–".into(),
            };
            rows.push(vec![
                format!("this scene, {}, {}", line.variant, line.networks),
                format!("{:.1e}", line.sd),
                significant(line.core_seconds),
                interval,
            ]);
        }
    }
    if rows.is_empty() {
        return html! {};
    }
    html! {
        h3 { "Figures of merit" }
        (table(&["Quantity and engine", "Error (–)", "Processor time (s)", "1 / (error² time) (1/s)"], rows))
        p.small { "Each line at the most particles that were walked; of this scene, one replicate." }
    }
}

fn last_of_each_line(exact: &ExactTier) -> Vec<&ExactRow> {
    let of = |slope: &&crate::outcome::precision::Slope| {
        exact.rows.iter().rfind(|row| row.quantity == slope.quantity && row.engine == slope.engine)
    };
    exact.slopes.iter().filter_map(|slope| of(&slope)).collect()
}

pub(super) fn exact(exact: &ExactTier) -> Markup {
    let rows = exact.slopes.iter().zip(last_of_each_line(exact)).map(|(slope, row)| {
        vec![
            format!("{}, {}", slope.quantity, slope.engine),
            format!("{:.0e}", row.particles as f64),
            format!("{:.2e}", row.error),
            format!("{:.2e}", row.expected_error),
            slope.slope.map_or_else(|| "–".into(), |s| format!("{s:.3}")),
            slope.largest_z.map_or_else(|| "nothing drawn".into(), |z| format!("{z:.2}")),
            row.chi_squared.map_or_else(|| "–".into(), |chi| format!("{chi:.0} of {}", row.networks)),
        ]
    });
    let closed = exact.closed.iter().map(|row| {
        vec![
            row.what.clone(),
            significant(row.exact),
            if row.z.is_some() { format!("{:.4}", row.found) } else { format!("{}", row.found) },
            row.z.map_or_else(|| "must be equal".into(), |z| format!("{z:+.2}")),
            if row.holds { "✓".into() } else { "BROKEN".into() },
            significant(row.core_seconds),
        ]
    });
    html! {
        ul { @for quantity in &exact.quantities {
            li { b { (quantity.name) } ": " (quantity.words) ", " (percent(quantity.mean)) " on average." }
        } }
        (table(
            &["Line", "Most particles", "Error (–)", "of independent particles", "Slope", "Largest |z| of a network", "χ² and its degrees"],
            rows.collect(),
        ))
        p.small { "Largest |z|: of all networks, at every number of particles from which each network expects at least 50 to leave and 50 to stay." }
        h3 { "Integers and closed forms" }
        (table(&["What", "Exact", "Found", "z", "", "Processor time (s)"], closed.collect()))
    }
}

pub(super) fn sampling(sampling: &SamplingTier) -> Markup {
    let rows = sampling.lines.iter().map(|line| {
        let first = line.difference_error.is_none();
        vec![
            format!("{}, {}", line.variant, line.networks),
            line.replicates.to_string(),
            points(line.mean),
            if first {
                "–".into()
            } else {
                format!("{} ± {}", signed(line.difference), points(line.difference_error.unwrap_or(0.0)))
            },
            format!("{} ({} to {})", points(line.sd), points(line.sd_low), points(line.sd_high)),
            match line.networks.as_str() {
                "new networks" => between_networks(sampling, line).map_or_else(|| "–".into(), points),
                _ => "–".into(),
            },
            significant(line.sd / line.binomial),
            significant(line.core_seconds),
        ]
    });
    html! {
        (table(
            &[
                "Way of drawing and moving, replicates", "Number", "Eroded mass (%)", "less the first line (points ± standard error)", "Standard deviation of a replicate (points)",
                "of which networks", "times the binomial", "Processor time of a replicate (s)",
            ],
            rows.collect(),
        ))
    }
}

pub(super) fn bias(rows: &[BiasRow]) -> Markup {
    let rows = rows.iter().map(|row| {
        let interval = match (row.reference, row.bias_low, row.bias_high) {
            (true, ..) => "reference".to_owned(),
            (_, Some(low), Some(high)) => {
                format!("{} ({} to {})", signed(row.bias), signed(low), signed(high))
            }
            _ => signed(row.bias),
        };
        vec![
            format!("{}: {}", row.factor, row.level),
            whole(row.n_base),
            format!("{}{}", row.replicates, if row.paired { ", same networks" } else { "" }),
            points(row.value),
            interval,
            significant(row.core_seconds),
        ]
    });
    html! {
        (table(
            &["Setting", "Base particles", "Replicates", "Eroded mass (%)", "Difference (points, 95 %)", "Processor time of a replicate (s)"],
            rows.collect(),
        ))
        p.small {
            "The twins are a slow walk of their own, on a small part of the network with few base particles, in which each particle keeps its random numbers; precision and blocking are held \
             against the twin that decides as the walk does."
        }
    }
}

pub(super) fn decision(decision: &DecisionTier) -> Markup {
    let cases = decision.cases.iter().map(|case| {
        vec![
            case.name.clone(),
            significant(case.size_factor),
            whole(case.n_base),
            case.replicates.to_string(),
            format!("{} ({} to {})", points(case.mean), points(case.low), points(case.high)),
            points(case.sd),
            format!("{}{}", case.class.words(), if case.certain { "" } else { " (not certain)" }),
            significant(case.core_seconds),
        ]
    });
    let rows = decision.rows.iter().map(|row| {
        vec![
            row.case.clone(),
            row.rule.clone(),
            significant(row.replicates),
            percent(row.wrong),
            format!("{} to {}", percent(row.wrong_low), percent(row.wrong_high)),
            percent(row.undecided),
            significant(row.core_seconds),
        ]
    });
    html! {
        (table(
            &["Case", "Factor on sizes", "Base particles", "Replicates", "First run, eroded mass (%, 95 %)", "Standard deviation (points)", "Class", "Processor time of a replicate (s)"],
            cases.collect(),
        ))
        details {
            summary { "Every rule tried" }
            (table(
                &["Case", "Rule", "Replicates", "Wrong", "95 %", "Without a class", "Processor time (s)"],
                rows.collect(),
            ))
        }
    }
}

pub(super) fn scaling(rows: &[ScalingRow]) -> Markup {
    let threads = rows.iter().filter(|row| row.against == "threads").map(|row| {
        let one = rows.iter().find(|one| one.against == "threads" && one.engine == row.engine);
        vec![
            row.engine.clone(),
            row.threads.to_string(),
            whole(row.n_base),
            significant(row.wall_seconds),
            significant(row.core_seconds),
            one.map_or_else(|| "–".into(), |one| format!("{:.2}", one.wall_seconds / row.wall_seconds)),
            format!("{:.6}", 100.0 * row.eroded_mass_fraction),
        ]
    });
    html! {
        (table(
            &["Engine", "Threads of one run", "Base particles", "Wall time (s)", "Processor time (s)", "times as fast", "Eroded mass (%)"],
            threads.collect(),
        ))
        p.small { "Counts use several threads only where particles walked one by one are many; replicates side by side use them all." }
    }
}

pub(super) fn packing(tier: &PackingTier) -> Markup {
    let packings = tier.packings.iter().map(|row| {
        let interval = match (row.reference, row.bias_low, row.bias_high) {
            (true, ..) => "reference".to_owned(),
            (_, Some(low), Some(high)) => format!("{:+.4} ({low:+.4} to {high:+.4})", row.bias),
            _ => format!("{:+.4}", row.bias),
        };
        vec![
            match row.factor.as_str() {
                "reference" => format!("friction {}, default settings", row.friction),
                factor => format!("friction {}, {factor} x {}", row.friction, row.at),
            },
            whole(row.grains),
            format!("{} of {}", row.settled, row.seeds),
            format!("{:.4}", row.void_ratio),
            interval,
            format!("{:.4}, {:.4}", row.dc5, row.dc50),
            format!("{:+.2} %", 100.0 * row.dc50_bias),
            format!("{:.3}", row.cu_csd),
            significant(row.core_seconds),
        ]
    });
    let triangulations = tier.triangulations.iter().map(|row| {
        vec![
            row.packing.clone(),
            whole(row.grains),
            whole(row.tetrahedra),
            whole(row.constrictions),
            duration(row.triangulate_seconds),
            duration(row.measure_seconds),
            if row.identities_hold { "✓".into() } else { "BROKEN".into() },
        ]
    });
    html! {
        (table(
            &["Setting", "Grains", "Settled", "Void ratio", "Difference (95 %)", "Dc5, Dc50 (D0F)", "Dc50, difference", "Cu of constrictions", "Processor time (s)"],
            packings.collect(),
        ))
        (table(
            &["Packing", "Grains", "Tetrahedra", "Constrictions", "Triangulation", "Voids, discs, curve", "Identities"],
            triangulations.collect(),
        ))
    }
}
