//! What campaigns and comparisons show of a case among others: its class with a link, and both runs of all.

use std::path::Path;

use maud::{Markup, html};

use super::figures::{Across, Axis, BLACK, BLUE, Dash, Figure, PURPLE, Point, Rule, Shape, shorten};
use super::numbers::interval_in_percent;
use super::run_figures::run_name;
use crate::outcome::record::{Statistic, Verdict};
use crate::text::is_plain_part;

/// The class, with a link to the case's own page, where there is one: nowhere else than in a folder inside
/// that of all cases.
pub(super) fn class(verdict: Verdict, folder: &Path, case: &str) -> Markup {
    let (words, page) = (verdict.words(), format!("{case}/report.html"));
    let is_there = page.split('/').all(is_plain_part) && folder.join(&page).is_file();
    html! { @if is_there { a href=(page) { b { (words) } } } @else { b { (words) } } }
}

/// First and second run of each case, one row a case.
pub(super) fn both_runs(cases: &[(&str, [Option<&Statistic>; 2])], threshold: f64, height: f64) -> Figure {
    let y = Axis::rows(cases.iter().map(|(name, _)| shorten(name, 34)));
    let x = Axis::percent("Base eroded, by mass (%)");
    let what =
        "Percent of the base mass eroded in the first and second run of each case, with 95 % intervals";
    let mut figure = Figure::new("Both runs of each case", what, "", x, y)
        .sizes((720.0, height), (358.0, height))
        .names_above();
    let limit = 100.0 * threshold;
    figure.add(Rule::new(Across::X, limit, BLACK).dash(Dash::Dashed).label(&format!("{limit} %")));
    for (run, colour, shape) in [(0, BLUE, Shape::Circle), (1, PURPLE, Shape::Square)] {
        let points = (1..).zip(cases).filter_map(|(row, (_, runs)): (u32, _)| {
            let statistic = runs[run]?;
            let point = Point::new(100.0 * statistic.mean, f64::from(row), colour, shape);
            Some(point.x_interval(interval_in_percent(statistic)))
        });
        figure.add_points(run_name(run as u64 + 1), points);
    }
    figure
}
