//! One case among others in the pages of campaigns and batches: its class with a link, and figures of all
//! cases.

use std::path::Path;

use maud::{Markup, html};

use super::figures::{Across, Axis, BLACK, BLUE, Colour, Dash, Figure, Mark, PURPLE, Shape, shorten};
use super::run_figures::{run_name, verdict_colour};
use crate::outcome::record::{Statistic, Verdict};
use crate::outcome::statistic::interval_in_percent;
use voidwalk_core::text::is_plain_part;

/// Symbols of the classes, in the order of [`Verdict::ALL`].
const SHAPES: [Shape; 4] = [Shape::Circle, Shape::Diamond, Shape::Square, Shape::Triangle];

/// Case in a figure: x is a ratio, y a value with its interval.
pub(super) struct AtRatio {
    pub(crate) ratio: f64,
    pub(crate) class: Verdict,
    pub(crate) value: f64,
    pub(crate) interval: Option<(f64, f64)>,
    /// True if the case has no erosion, but practice contradicts that.
    pub(crate) is_against: bool,
    /// True if the ratio is only a lower bound.
    pub(crate) is_bound: bool,
}

/// Figure with one symbol per case, by class, over rules; `words` are its title and description.
pub(super) fn against_ratio(
    [title, what]: [&str; 2],
    (x, y): (Axis, Axis),
    rules: Vec<Mark>,
    cases: &[AtRatio],
) -> Figure {
    let mut figure = Figure::new(title, what, x, y).names_above();
    rules.into_iter().for_each(|rule| figure.add(rule));
    for (class, shape) in Verdict::ALL.into_iter().zip(SHAPES) {
        let point = |case: &AtRatio, colour: Colour| {
            let point = Mark::point(case.ratio, case.value, colour, shape).y_interval(case.interval);
            if case.is_bound { point.hollow() } else { point }
        };
        // Green for "no erosion" would mean that the filter is good.
        let is_doubted = |case: &AtRatio| class == Verdict::None && case.is_against;
        let of_class = || cases.iter().filter(|case| case.class == class);
        let plain = of_class().filter(|case| !is_doubted(case));
        figure.add_points(class.words(), plain.map(|case| point(case, verdict_colour(class))));
        let doubted = of_class().filter(|case| is_doubted(case));
        let words = format!("{}, against practice", class.words());
        figure.add_points(&words, doubted.map(|case| point(case, BLACK)));
    }
    figure
}

/// Class, with a link to the case's own page if it exists; only pages inside the folder of all cases are
/// linked.
pub(super) fn class(verdict: Verdict, folder: &Path, case: &str) -> Markup {
    let (words, page) = (verdict.words(), format!("{case}/report.html"));
    let is_there = page.split('/').all(is_plain_part) && folder.join(&page).is_file();
    html! { @if is_there { a href=(page) { b { (words) } } } @else { b { (words) } } }
}

/// First and second run of each case, one row per case.
pub(super) fn both_runs(cases: &[(&str, [Option<&Statistic>; 2])], threshold: f64, height: f64) -> Figure {
    let y = Axis::rows(cases.iter().map(|(name, _)| shorten(name, 34)));
    let x = Axis::percent("Base eroded, by mass (%)");
    let what =
        "Percent of the base mass eroded in the first and second run of each case, with 95 % intervals";
    let mut figure = Figure::new("Both runs of each case", what, x, y)
        .sizes((720.0, height), (358.0, height))
        .names_above();
    let limit = 100.0 * threshold;
    figure.add(Mark::rule(Across::X, limit, BLACK).dash(Dash::Dashed).label(&format!("{limit} %")));
    for (run, colour, shape) in [(0, BLUE, Shape::Circle), (1, PURPLE, Shape::Square)] {
        let points = (1..).zip(cases).filter_map(|(row, (_, runs)): (u32, _)| {
            let statistic = runs[run]?;
            let point = Mark::point(100.0 * statistic.mean, f64::from(row), colour, shape);
            Some(point.x_interval(interval_in_percent(statistic)))
        });
        figure.add_points(run_name(run as u64 + 1), points);
    }
    figure
}
