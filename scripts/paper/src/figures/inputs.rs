//! The figures of what goes into the campaign and of single walks: Figs. 6 to 10, 13 and 18.

use std::collections::BTreeMap;

use super::scatter::{Group, Plot, across, scatter};
use crate::study::Study;
use voidwalk::outcome::record::{FilterRecord, SeriesRow, Statistic};
use voidwalk::report::figures::{
    Across, Axis, BLACK, BLUE, Colour, Dash, Figure, GREEN, GREY, Line, ORANGE, PURPLE, Shape, VERMILLION,
    ramp,
};
use voidwalk::report::percolation_spread;
use voidwalk::report::shell::Drawn;

pub fn fig_6(study: &Study) -> Vec<Drawn> {
    study
        .percolation
        .iter()
        .map(|percolation| Drawn { name: "fig6", ..percolation_spread(percolation) })
        .collect()
}

/// The six filters of Table 2, and the published curve of each where there is one.
fn filters(study: &Study) -> Vec<(&FilterRecord, Option<&FilterRecord>, &'static str, Colour, Dash)> {
    let named = [
        ("cu1.2-dense", "Cu 1.2", GREEN, Dash::Solid),
        ("cu1.5-loose", "Cu 1.5, loose", BLUE, Dash::Solid),
        ("cu1.5-dense", "Cu 1.5, dense", BLUE, Dash::Dashed),
        ("cu3-loose", "Cu 3, loose", VERMILLION, Dash::Solid),
        ("cu3-dense", "Cu 3, dense", VERMILLION, Dash::Dashed),
        ("cu6-friction0.7", "Cu 6", PURPLE, Dash::Solid),
    ];
    let found = |(name, label, colour, dash)| {
        let own = study.filter("paper", name).or_else(|| study.filter("kenney", name))?;
        Some((own, study.filter("paper-published", name), label, colour, dash))
    };
    named.into_iter().filter_map(found).collect()
}

pub fn fig_7(study: &Study) -> Vec<Drawn> {
    let filters = filters(study);
    if filters.is_empty() {
        return Vec::new();
    }
    let curve =
        |rows: &[[f64; 2]], unit: f64| rows.iter().map(|row| (row[0] / unit, row[1])).collect::<Vec<_>>();
    let y = || Axis::percent("Percent finer (%)");
    let a = "Fig. 7(a): gradations of the filters, by mass";
    let x = Axis::log("Size / D0F (–)", 1.0, 36.0);
    let mut gradations = Figure::new(a, a, "", x, y()).names_above();
    for (own, _, label, colour, dash) in &filters {
        let rows = curve(&own.gradation, own.d0_mm);
        gradations.add(Line::new(rows, *colour).dash(*dash).label(label));
    }
    let constrictions = |title: &str, x: Axis, unit: fn(&FilterRecord) -> f64| {
        let mut figure = Figure::new(title, title, "", x, y()).names_above();
        let mut named = false;
        for (own, published, label, colour, dash) in &filters {
            figure.add(Line::new(curve(&own.constrictions, unit(own)), *colour).dash(*dash).label(label));
            if let Some(published) = published {
                let rows = curve(&published.constrictions, unit(published));
                let line = Line::new(rows, BLACK).width(1.2).dash(Dash::Dotted);
                figure.add(if named { line } else { line.label("published") });
                named = true;
            }
        }
        figure
    };
    let b = "Fig. 7(b): constrictions over D0F, by number";
    let c = "Fig. 7(c): constrictions over D15F, by number";
    let over_d0f = constrictions(b, Axis::log("Constriction / D0F (–)", 0.15, 1.5), |filter| filter.d0_mm);
    let over_d15f =
        constrictions(c, Axis::log("Constriction / D15F (–)", 0.05, 1.0), |filter| filter.d15_mm);
    let caption = "Own packings; dotted: published curves (Shire and O’Sullivan 2016).";
    vec![
        Drawn { name: "fig7a", caption: String::new(), figure: gradations },
        Drawn { name: "fig7b", caption: caption.into(), figure: over_d0f },
        Drawn { name: "fig7c", caption: caption.into(), figure: over_d15f },
    ]
}

/// Figs. 8 to 10: largest eroded particle and proportion eroded against the size of a uniform base.
fn kenney(
    study: &Study,
    filter: &str,
    names: [(&'static str, &'static str); 2],
    model: f64,
    test: f64,
) -> Vec<Drawn> {
    let cases: Vec<_> = study.cases("kenney").into_iter().filter(|c| c.level("filter") == filter).collect();
    let group = |label: &str, hollow: bool, points: Vec<(f64, Statistic)>| {
        let (label, colour, shape) = (label.to_string(), BLUE, Shape::Circle);
        Group { label, colour, shape, hollow, joined: true, points }
    };
    let plot = |(name, title), y, percent| Plot {
        name,
        title,
        caption: "Base with Cu 1.2; it ends at 1.2 D50B, and where that erodes, the filter says no more."
            .into(),
        x: "D50B / D0F (–)",
        y,
        percent,
        reach: (0.1, 0.4),
    };
    let largest = |own: bool| {
        let cases = cases.iter().filter(move |case| case.erodes_its_largest(1) == own);
        cases.filter_map(|case| Some((case.d50b_over_d0f()?, case.largest_over_d0f(1)?))).collect()
    };
    let by_filter = group("voidwalk", false, largest(false));
    let by_base = group("voidwalk, the base’s own largest", true, largest(true));
    let eroded = cases.iter().filter_map(|case| Some((case.d50b_over_d0f()?, case.eroded(1)?)));
    let mut rules = vec![across(Across::Y, test, &format!("{test}: tests of Kenney et al."))];
    if model != test {
        rules.push(across(Across::Y, model, &format!("{model}: the paper’s model")));
    }
    let drawn = [
        scatter(plot(names[0], "Largest eroded / D0F (–)", false), rules, vec![by_filter, by_base]),
        scatter(
            plot(names[1], "Base eroded, by mass (%)", true),
            Vec::new(),
            vec![group("voidwalk", false, eroded.collect())],
        ),
    ];
    drawn.into_iter().flatten().collect()
}

pub fn fig_8(study: &Study) -> Vec<Drawn> {
    let names = [("fig8a", "Fig. 8(a): filter with Cu 1.2"), ("fig8b", "Fig. 8(b): filter with Cu 1.2")];
    kenney(study, "cu1.2-dense", names, 0.18, 0.18)
}

pub fn fig_9(study: &Study) -> Vec<Drawn> {
    let names = [("fig9a", "Fig. 9(a): filter with Cu 3"), ("fig9b", "Fig. 9(b): filter with Cu 3")];
    kenney(study, "cu3-loose", names, 0.30, 0.25)
}

pub fn fig_10(study: &Study) -> Vec<Drawn> {
    let names = [("fig10a", "Fig. 10(a): filter with Cu 6"), ("fig10b", "Fig. 10(b): filter with Cu 6")];
    kenney(study, "cu6-friction0.7", names, 0.34, 0.26)
}

/// Mean over the replicates of what has eroded by each increment, percent; a walk that has ended stays where
/// it is.
fn mean_progress(rows: &[SeriesRow], run: u64) -> Vec<(f64, f64)> {
    let mut walks: BTreeMap<u64, Vec<(u64, f64)>> = BTreeMap::new();
    for row in rows.iter().filter(|row| row.run == run) {
        walks.entry(row.replicate).or_default().push((row.increment, row.eroded_mass_fraction));
    }
    let last = rows.iter().filter(|row| row.run == run).map(|row| row.increment).max().unwrap_or(0);
    let at = |increment: u64| {
        let of = |walk: &Vec<(u64, f64)>| {
            walk[..walk.partition_point(|row| row.0 <= increment)].last().map_or(0.0, |r| r.1)
        };
        100.0 * walks.values().map(of).sum::<f64>() / walks.len().max(1) as f64
    };
    (0..=last).map(|increment| (increment as f64, at(increment))).collect()
}

pub fn fig_13(study: &Study) -> Vec<Drawn> {
    if study.series.is_empty() {
        return Vec::new();
    }
    let look = |name: &str| match name {
        "fig13-continuing" => ("continuing: dense Cu 3, base Cu 1.5, Dc5", VERMILLION),
        "fig13-some" => ("some: dense Cu 1.5, base Cu 3, Dc5", ORANGE),
        _ => ("none: loose Cu 1.5, base Cu 1.5, Dc50", GREEN),
    };
    let title = "Fig. 13: progress of erosion";
    let last = study.series.iter().flat_map(|(_, rows)| rows).map(|row| row.increment).max().unwrap_or(1);
    let x = Axis::linear("Increment of the run (–)", 0.0, last as f64);
    let mut figure =
        Figure::new(title, title, "", x, Axis::percent("Base eroded, by mass (%)")).names_above();
    for (name, rows) in &study.series {
        let (label, colour) = look(name);
        for (run, dash, run_name) in [(1, Dash::Solid, "first run"), (2, Dash::Dashed, "second run")] {
            figure.add(
                Line::new(mean_progress(rows, run), colour).dash(dash).label(&format!("{label}, {run_name}")),
            );
        }
    }
    let caption = "Means over the replicates, of the mass that the run inserts in all.".into();
    vec![Drawn { name: "fig13", caption, figure }]
}

pub fn fig_18(study: &Study) -> Vec<Drawn> {
    let mut curves: BTreeMap<u64, Vec<(f64, f64)>> = BTreeMap::new();
    for row in study.retained.iter().filter(|row| row.replicate == 1 && row.run == 1) {
        curves.entry(row.increment).or_default().push((row.diameter_mm, row.percent_finer_by_mass));
    }
    let sizes = || curves.values().flatten().map(|point| point.0);
    let (Some(low), Some(high)) = (sizes().reduce(f64::min), sizes().reduce(f64::max)) else {
        return Vec::new();
    };
    let title = "Fig. 18: gradation of the retained particles";
    let x = Axis::log("Size / D0F (–)", low, high);
    let mut figure =
        Figure::new(title, title, "", x, Axis::percent("Percent finer by mass (%)")).names_above();
    if let Some(case) = study.named("progress", "fig18") {
        let base = case.outcome.inputs.base.gradation.iter().map(|row| (row[0], row[1])).collect();
        figure.add(Line::new(base, GREY).dash(Dash::Dotted).label("base"));
    }
    let count = curves.len();
    for (index, (increment, curve)) in curves.into_iter().enumerate() {
        figure.add(Line::new(curve, ramp(index, count)).label(&format!("increment {increment}")));
    }
    let caption = "Loose filter with Cu 1.5, base with Cu 3 at Dc5, first run, first replicate.".into();
    vec![Drawn { name: "fig18", caption, figure }]
}
