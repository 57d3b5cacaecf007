//! Figures of a run folder.

use std::collections::{BTreeMap, BTreeSet};

use super::figures::{
    Across, Axis, BLACK, BLUE, Colour, Dash, Figure, GREEN, GREY, Mark, ORANGE, PURPLE, Shape, VERMILLION,
    positive_range, ramp, shorten,
};
use super::folder::RunFolder;
use super::names::{is_named, soil_name};
use super::shell::Drawn;
use super::walks::Walks;
use crate::outcome::record::{LayerRow, SeriesRow, SizeRow, Statistic, Verdict};
use crate::outcome::statistic::{interval, interval_in_percent};
use crate::words::{base_size, capital, grading};
use voidwalk_practice::quantity::{SizeUnit, length, percent, significant, whole};
use voidwalk_practice::rules::{DESIGN, TESTS_CONTINUING, TESTS_NO_EROSION};
use voidwalk_practice::{Decision, RuleQuantity};

/// Maximum number of replicates drawn one by one; of more, only the mean and the first ones are drawn.
const DRAWN: usize = 40;

pub(super) fn run_name(run: u64) -> &'static str {
    if run == 1 { "first run" } else { "second run" }
}

/// Colour, symbol and dashes of a run in every figure.
fn run_look(run: u64) -> (Colour, Shape, Dash) {
    if run == 1 { (BLUE, Shape::Circle, Dash::Solid) } else { (PURPLE, Shape::Square, Dash::Dashed) }
}

pub(super) fn verdict_colour(verdict: Verdict) -> Colour {
    match verdict {
        Verdict::None => GREEN,
        Verdict::Some => ORANGE,
        Verdict::Continuing => VERMILLION,
        Verdict::Undecided => GREY,
    }
}

pub(super) fn size_axis(unit: SizeUnit, sizes: impl Iterator<Item = f64>) -> Axis {
    let (low, high) = positive_range(sizes);
    Axis::log(if unit == SizeUnit::D0f { "Size / D0F (–)" } else { "Size (mm)" }, low, high)
}

/// Upper end of an interval, or the mean if there is none.
fn upper(statistic: &Statistic) -> f64 {
    interval(statistic).map_or(statistic.mean, |(_, high)| high)
}

fn threshold_rule(walks: &Walks, across: Across) -> Mark {
    let limit = walks.threshold;
    Mark::rule(across, limit * 100.0, BLACK)
        .dash(Dash::Dashed)
        .label(&percent(limit).in_digits(3).to_string())
}

/// Axis from 0 that includes these percentages and the threshold, and reaches at least 10 %.
fn eroded_axis(label: &str, walks: &Walks, highest: f64) -> Axis {
    let high = highest.max(walks.threshold * 100.0 * 1.3).min(100.0);
    if high > 60.0 { Axis::percent(label) } else { Axis::linear(label, 0.0, high) }
}

/// Small figure beside the verdict: mean and interval of both runs against the threshold.
pub(super) fn verdict(walks: &Walks) -> Drawn {
    let summary = walks.summary;
    let highest = 100.0 * summary.iter().map(|run| upper(&run.eroded_mass_fraction)).fold(0.0, f64::max);
    let x = eroded_axis("Base eroded, by mass (%)", walks, highest * 1.08);
    let y = Axis::rows(summary.iter().map(|run| capital(run_name(run.run))));
    let height = 84.0 + 48.0 * summary.len() as f64;
    let what = "Mean and 95 % interval of the eroded mass in each run, against the threshold";
    let mut figure =
        Figure::new("Base eroded in each run", what, x, y).sizes((540.0, height), (330.0, height));
    figure.add(threshold_rule(walks, Across::X));
    for run in summary {
        let statistic = &run.eroded_mass_fraction;
        let (colour, shape, _) = run_look(run.run);
        let point = Mark::point(statistic.mean * 100.0, run.run as f64, colour, shape);
        figure.add(
            point.x_interval(interval_in_percent(statistic)).label(&percent(statistic.mean).to_string()),
        );
    }
    Drawn::new("verdict", figure, "")
}

/// Filter, base and constrictions on a semi-logarithmic plot.
pub(super) fn gradations(folder: &RunFolder) -> Drawn {
    let (inputs, decision) = (&folder.outcome.inputs, &folder.decision);
    let (filter, base) = (&inputs.filter, &inputs.base);
    let (limits, unit) = (boundaries(decision), SizeUnit::of(inputs.scale_free, false));
    let sampled = base.as_sampled.as_ref();
    let sampled_rows = sampled.map_or(&[][..], |before| &before.gradation);
    let rows =
        filter.gradation.iter().chain(&filter.constrictions).chain(&base.gradation).chain(sampled_rows);
    let x = size_axis(unit, rows.map(|row| row[0]).chain(limits.iter().map(|(_, limit)| *limit)));
    let x = if folder.about.coarse_left { x.downward() } else { x };
    let y = Axis::percent("Percent finer (%)");
    let d85b = match inputs.base_size() {
        Some(size) => base_size(&size, SizeUnit::Mm),
        None => format!("D85B is {}", length(base.d85_mm, SizeUnit::D0f)),
    };
    let what = format!(
        "Percent finer against size for the filter (by mass), its constrictions (by number) and the base (by \
         mass). D15F is {}, {}.",
        length(filter.d15_mm, unit),
        d85b,
    );
    let mut figure = Figure::new("Gradations and constriction curve", &what, x, y)
        .sizes((720.0, 460.0), (358.0, 400.0))
        .sheet((680.0, 350.0));
    if !inputs.scale_free {
        figure = figure.sieves();
    }
    let name = |kind: &str, name: &str| match is_named(kind, name) {
        true => format!("{kind}:\n{}", shorten(soil_name(name), 24)),
        false => kind.to_owned(),
    };
    draw(&mut figure, &limits);
    // Two curves of the base are named separately; a single curve is as sampled.
    let walked = match (inputs.base_size(), sampled) {
        (Some(size), Some(_)) => format!("base, {}", grading(&size)),
        _ => name("base", &base.name),
    };
    if let Some(before) = sampled {
        let line = Mark::rows(&before.gradation, VERMILLION).width(1.4).dash(Dash::Dashed);
        figure.add(line.label("base as sampled,\nnot walked"));
    }
    figure.add(Mark::rows(&base.gradation, VERMILLION).width(2.6).label(&walked));
    let constrictions = Mark::rows(&filter.constrictions, BLUE).dash(Dash::Dashed);
    figure.add(constrictions.label("constrictions\n(by number)"));
    figure.add(Mark::rows(&filter.gradation, BLACK).width(2.6).label(&name("filter", &filter.name)));
    let mark = |at: f64, percent: f64, colour, shape, text: &str| {
        Mark::point(at, percent, colour, shape).dropped().label(text)
    };
    figure.add(mark(filter.d15_mm, 15.0, BLACK, Shape::Circle, "D15F"));
    figure.add(mark(base.d85_mm, 85.0, VERMILLION, Shape::Square, "D85B"));
    let caption = format!(
        "Gradations by mass, constrictions by number.{}{}",
        caption(decision, &limits),
        if inputs.scale_free { " Sizes are multiples of D0F, the smallest filter grain." } else { "" },
    );
    Drawn::new("gradations", figure, caption)
}

/// Eroded mass in percent after an increment, interpolated linearly between recorded increments, and constant
/// after the last.
fn eroded_at(rows: &[SeriesRow], increment: f64) -> f64 {
    let value = |row: &SeriesRow| row.eroded_mass_fraction * 100.0;
    let after = rows.partition_point(|row| (row.increment as f64) < increment);
    let (x0, y0) =
        if after == 0 { (0.0, 0.0) } else { (rows[after - 1].increment as f64, value(&rows[after - 1])) };
    let Some(next) = rows.get(after) else { return y0 };
    y0 + (value(next) - y0) * (increment - x0) / (next.increment as f64 - x0)
}

/// Eroded mass against increment for each run: thin lines for replicates, a bold line for the mean.
pub(super) fn eroded(walks: &Walks) -> Option<Drawn> {
    let rows = || walks.rows.series.values().flatten();
    let last = rows().map(|row| row.increment).max()?;
    // The point from which every curve stays within a thousandth of its end; the rest of a long tail is left
    // out.
    let settled = walks.rows.series.values().filter_map(|rows| {
        let end = rows.last()?.eroded_mass_fraction;
        rows.iter().find(|row| end - row.eroded_mass_fraction <= 0.001).map(|row| row.increment)
    });
    let settled = settled.max().unwrap_or(last).max((1.0 / walks.inject_share) as u64);
    let shown = if last as f64 > 1.6 * settled as f64 { (settled as f64 * 1.25) as u64 } else { last };
    let highest = 100.0 * rows().map(|row| row.eroded_mass_fraction).fold(0.0, f64::max);
    let x = Axis::linear("Increment (–)", 0.0, shown as f64);
    let y = eroded_axis("Base eroded, by mass (%)", walks, highest * 1.05);
    let what = "Percent of the base mass eroded against increment, for each run";
    let mut figure = Figure::new("Progress of erosion", what, x, y);
    let end = libm::ceil(1.0 / walks.inject_share);
    if end < shown as f64 {
        figure.add(Mark::rule(Across::X, end, GREY).dash(Dash::Dotted).label("all base inserted"));
    }
    figure.add(threshold_rule(walks, Across::Y));
    let replicates = walks.replicates.len();
    let mut bold = Vec::new();
    for run in walks.runs() {
        let (colour, _, dash) = run_look(run);
        let all: Vec<&[SeriesRow]> =
            walks.rows.series.range((run, 0)..=(run, u64::MAX)).map(|(_, rows)| rows.as_slice()).collect();
        if all.is_empty() {
            continue;
        }
        if all.len() > 1 {
            for rows in all.iter().take(DRAWN) {
                let point = |row: &SeriesRow| (row.increment as f64, row.eroded_mass_fraction * 100.0);
                let stay = rows.last().map(|row| (last as f64, point(row).1));
                let curve = [(0.0, 0.0)].into_iter().chain(rows.iter().map(point)).chain(stay).collect();
                figure.add(Mark::line(curve, colour).width(0.8).opacity(0.45));
            }
        }
        let increments: BTreeSet<u64> =
            all.iter().flat_map(|rows| rows.iter().map(|row| row.increment)).collect();
        let increments: Vec<u64> = increments.into_iter().chain([last]).collect();
        // No more points than the eye can distinguish, because the mean takes increments times replicates.
        let stride = increments.len().div_ceil(2000).max(1);
        let mut mean = vec![(0.0, 0.0)];
        for at in increments.iter().step_by(stride).chain(increments.last()).map(|at| *at as f64) {
            mean.push((at, all.iter().map(|rows| eroded_at(rows, at)).sum::<f64>() / all.len() as f64));
        }
        bold.push(Mark::line(mean, colour).width(3.0).dash(dash).label(run_name(run)));
    }
    bold.into_iter().for_each(|line| figure.add(line));
    let mut caption = "Base eroded, in percent of the mass that a run inserts, against increment (an \
                       increment is not a length of time). The second run brings fresh base onto the \
                       constrictions that the first left blocked."
        .to_owned();
    if replicates > 1 {
        let thin = replicates.min(DRAWN);
        let first = if thin < replicates { format!("the first {thin} of ") } else { String::new() };
        caption.push_str(&format!(" Bold: mean; thin: {first}{replicates} replicates."));
    }
    if shown < last {
        let last = whole(last);
        caption.push_str(&format!(" The curves stay level from there to the last increment, {last}."));
    }
    Some(Drawn::new("eroded", figure, caption))
}

/// Blocked constrictions by layer for each run, with depth downward.
pub(super) fn layers(walks: &Walks) -> Option<Drawn> {
    let deepest = walks.rows.layers.values().flatten().map(|row| row.layer).max()?;
    let share = |row: &LayerRow| {
        if row.constrictions == 0 { 0.0 } else { 100.0 * row.blocked as f64 / row.constrictions as f64 }
    };
    let highest = walks.rows.layers.values().flatten().map(share).fold(0.0, f64::max);
    let x_label = "Constrictions blocked (% of the layer’s)";
    let x =
        if highest > 60.0 { Axis::percent(x_label) } else { Axis::linear(x_label, 0.0, highest.max(1.0)) };
    let high = deepest as f64 * 1.02 + f64::from(u8::from(deepest == 0));
    let mut y = Axis::linear("Layer (0 = where the base enters)", 0.0, (deepest as f64).max(1.0))
        .downward()
        .within(-0.02 * deepest as f64, high);
    y.ticks.retain(|tick| tick.at == libm::floor(tick.at));
    let what =
        "Share of the constrictions of each layer that are blocked at the end of each run, depth downward";
    let mut figure = Figure::new("Blocked constrictions by layer", what, x, y)
        .sizes((720.0, 460.0), (358.0, 420.0))
        .names_above();
    let mut bold = Vec::new();
    for run in walks.runs() {
        let (colour, _, dash) = run_look(run);
        let mut by_layer: BTreeMap<u64, Vec<f64>> = BTreeMap::new();
        for rows in walks.rows.layers.range((run, 0)..=(run, u64::MAX)).map(|(_, rows)| rows) {
            for row in rows {
                by_layer.entry(row.layer).or_default().push(share(row));
            }
        }
        let at = |pick: fn(&[f64]) -> f64| {
            by_layer.iter().map(move |(layer, shares)| (pick(shares), *layer as f64))
        };
        let least = at(|shares| shares.iter().copied().fold(f64::MAX, f64::min));
        let most: Vec<_> = at(|shares| shares.iter().copied().fold(0.0, f64::max)).collect();
        if walks.replicates.len() > 1 {
            figure.add(Mark::area(least.chain(most.into_iter().rev()).collect(), colour, 0.22));
        }
        let mean = at(|shares| shares.iter().sum::<f64>() / shares.len() as f64).collect();
        let name = format!("after the {}", run_name(run));
        bold.push(Mark::line(mean, colour).width(2.4).dash(dash).label(&name));
    }
    bold.into_iter().for_each(|line| figure.add(line));
    let mut caption = "Constrictions blocked at the end of each run, by layer; the second run starts with \
                       what the first left blocked."
        .to_owned();
    if walks.replicates.len() > 1 {
        caption.push_str(" Lines: mean of the replicates; shaded: from the least to the most of them.");
    }
    if let Some(thickness) = walks.thickness_mm {
        let depth = length(thickness, walks.unit);
        caption.push_str(&format!(" All layers together are {depth} of filter."));
    }
    Some(Drawn::new("layers", figure, caption))
}

/// Size curves of the particles retained in the first run of the first replicate, after chosen increments,
/// with the curves of the base and the eroded mass.
pub(super) fn retained(walks: &Walks) -> Option<Drawn> {
    const CURVES: usize = 6;
    let (run, replicate) = (1, 1);
    let of_run = (run, replicate, 0)..=(run, replicate, u64::MAX);
    let all: Vec<(u64, &[SizeRow])> = walks
        .rows
        .retained
        .range(of_run.clone())
        .map(|((_, _, increment), rows)| (*increment, rows.as_slice()))
        .collect();
    let gone = walks.rows.eroded.range(of_run).next_back().map(|(_, rows)| rows.as_slice());
    if all.is_empty() && gone.is_none() {
        return None;
    }
    // Chosen so that neighbours differ: evenly spaced in the record, including the first and the last.
    let count = all.len().min(CURVES);
    let chosen: Vec<_> =
        (0..count).map(|i| all[if count > 1 { i * (all.len() - 1) / (count - 1) } else { 0 }]).collect();
    let base = walks.base;
    let drawn = chosen.iter().map(|(_, rows)| *rows).chain(gone).flatten().map(|row| row.diameter_mm);
    let x = size_axis(walks.unit, drawn.chain(base.iter().map(|row| row[0])));
    let y = Axis::percent("Percent finer by mass (%)");
    let what = "Size curves of the base, of what is retained after some increments, and of what is eroded";
    let mut figure = Figure::new("What is retained and what is eroded", what, x, y)
        .names_above()
        .sizes((720.0, 460.0), (358.0, 480.0));
    let curve =
        |rows: &[SizeRow]| rows.iter().map(|row| (row.diameter_mm, row.percent_finer_by_mass)).collect();
    figure.add(Mark::rows(base, VERMILLION).width(2.6).label("base"));
    for (index, (increment, rows)) in chosen.iter().enumerate() {
        let end = if index + 1 == chosen.len() { ", the end" } else { "" };
        let label = format!("retained, increment {}{end}", whole(*increment));
        figure.add(Mark::line(curve(rows), ramp(index, chosen.len())).width(1.8).label(&label));
    }
    if let Some(rows) = gone {
        figure.add(Mark::line(curve(rows), BLACK).dash(Dash::Dashed).label("eroded, the end"));
    }
    let replicate = if walks.replicates.len() > 1 { " of the first replicate" } else { "" };
    let mut caption = format!(
        "What the filter has retained after chosen increments of the first run{replicate}, what has left \
         it, and the base as inserted. Retained curves that move to the left show self-filtering: what \
         coarse particles blocked holds finer ones."
    );
    if gone.is_none() {
        caption.push_str(" Nothing left the filter.");
    }
    if let Some(row) = walks.base.first().filter(|row| row[1] > 0.0) {
        caption.push_str(&format!(
            " The base's curve alone has the {} % of it that is finer than its finest sieve.",
            significant(row[1]).in_digits(3)
        ));
    }
    if all.is_empty() {
        caption.push_str(" Nothing was retained.");
    }
    Some(Drawn::new("retained", figure, caption))
}

/// Half the height of a line, in percent finer.
const HALF: f64 = 4.0;

/// Rule whose limit is a D15F: the name beside its line, its colour, and its words in the caption.
type Limit = (&'static str, &'static str, Colour, &'static str);

const LIMITS: [Limit; 3] = [
    (DESIGN, "design", GREY, "design"),
    (TESTS_NO_EROSION, "NE", GREEN, "no erosion (NE)"),
    (TESTS_CONTINUING, "CE", PURPLE, "continuing erosion (CE)"),
];

/// Known limits for these soils, each with its D15F.
fn boundaries(decision: &Decision) -> Vec<(Limit, f64)> {
    let limit = |id: &str| {
        let rule = decision.applied(id).filter(|rule| rule.quantity == RuleQuantity::D15F)?;
        let is_unclear = id == TESTS_CONTINUING && decision.is_beyond_unclear;
        rule.limit.filter(|limit| !is_unclear && *limit > 0.0 && limit.is_finite())
    };
    LIMITS.into_iter().filter_map(|line| Some((line, limit(line.0)?))).collect()
}

/// Draws the 15 % line and the boundaries at it, with their names; the caption explains the line.
fn draw(figure: &mut Figure, boundaries: &[(Limit, f64)]) {
    figure.add(Mark::rule(Across::Y, 15.0, BLACK).dash(Dash::Dotted));
    for ((_, name, colour, _), limit) in boundaries {
        let line = Mark::line(vec![(*limit, 15.0 - HALF), (*limit, 15.0 + HALF)], *colour);
        figure.add(line.width(3.0).stays().label(name));
    }
}

/// Names of the lines for the caption; empty without lines.
fn caption(decision: &Decision, boundaries: &[(Limit, f64)]) -> String {
    if boundaries.is_empty() {
        return String::new();
    }
    // Design and no erosion have the same limit for a dispersive base.
    let is_one = decision.without_margin().is_some();
    let name = |(line, _): &(Limit, f64)| match line.0 {
        DESIGN if is_one => Some("design and no erosion"),
        TESTS_NO_EROSION if is_one => None,
        _ => Some(line.3),
    };
    let names: Vec<&str> = boundaries.iter().filter_map(name).collect();
    format!(" Short lines: D15F of {}.", names.join(", "))
}
