//! Figures of what moves the verdict: the number of base particles, the thickness of the filter.

use super::figures::{Across, Area, Axis, Figure, Line, Point, Tick};
use super::folder::RunFolder;
use super::numbers::{interval_in_percent, known, percent, significant, size, trimmed, whole};
use super::run_figures::{eroded_axis, run_look, run_name, threshold_rule, upper, verdict_colour};
use super::shell::Drawn;
use super::walks::Walks;
use crate::outcome::record::{Classed, OfThickness, Outcome};
use crate::verdict::thickness::{OTHER_BASE, WITH_AMOUNT};

/// What is said where points of a study stopped early.
pub(super) const STOPPED_WHEN_CLEAR: &str = "A point stops after one or two replicates if its erosion \
    clearly continues, as it does at ×1. Its interval then takes twice the scatter of the replicates of ×1, \
    or its own if that is wider, because so few replicates do not show theirs.";

/// What is said where not every thickness has its base.
pub(super) fn held() -> String {
    format!(
        "{OTHER_BASE}. A thicker filter is then offered too little base, and seems to hold better than it \
         would."
    )
}

/// What is said of the classes of a study where the verdict is undecided and its other points know nothing of
/// what leaves it so.
pub(super) fn classes_of_points(outcome: &Outcome) -> Option<String> {
    let points = outcome.points_are()?;
    Some(format!("×1 has the verdict of this page; the other points are classed {points}."))
}

/// One of several filters or bases that differ in one thing: how many times that of this scene.
struct Varied<'a> {
    factor: f64,
    /// What stands below the factor on the axis.
    below: String,
    walked: &'a Classed,
}

/// Eroded mass against the number of base particles, and the class that each number gives.
pub(super) fn sensitivity(folder: &RunFolder) -> Option<Drawn> {
    let cases = folder.outcome.sensitivity.iter().filter(|case| case.factor > 0.0);
    let cases = cases.map(|case| Varied {
        factor: case.factor,
        below: known(case.grains_per_void, significant),
        walked: &case.walked,
    });
    let titles = [
        "How the verdict moves with the number of base particles",
        "Percent of the base mass eroded in each run against multiples of the number of base particles; the \
         colour behind is the verdict",
        "Times the base particles of this run; below, grains per void",
    ];
    let cases: Vec<Varied> = cases.collect();
    let behind = behind(&folder.outcome, &cases);
    let figure = varied_by(&folder.walks(), cases, titles)?;
    let caption = format!(
        "How the verdict moves with the number of base particles. It is proportional to the grains per void \
         and to the mass ratio, so this axis covers both: ×2 is twice the grains \
         per void or twice the mass ratio. ×1 is this run: {} grains per void, mass ratio {}. Bars: 95 % \
         intervals. {behind}",
        known(folder.outcome.grains_per_void, significant),
        known(folder.outcome.inputs.mass_ratio, percent),
    );
    Some(Drawn::new("sensitivity", figure, caption))
}

/// Eroded mass against the thickness of the filter, with which the base varies, and the class of each.
pub(super) fn thickness(folder: &RunFolder) -> Option<Drawn> {
    let scale_free = folder.outcome.inputs.scale_free;
    let of_row = |row: &'_ OfThickness| known(row.thickness_mm, |thickness| size(thickness, scale_free));
    let rows = folder.outcome.thickness.iter().filter(|row| row.factor > 0.0);
    let rows = rows.map(|row| Varied { factor: row.factor, below: of_row(row), walked: &row.walked });
    let titles = [
        "How the verdict moves with thickness and amount of base together",
        "Percent of the base mass eroded in each run against multiples of the filter's thickness; the \
         colour behind is the verdict",
        "Times the thickness of this filter; below, the thickness modelled",
    ];
    let rows: Vec<Varied> = rows.collect();
    let behind = behind(&folder.outcome, &rows);
    let figure = varied_by(&folder.walks(), rows, titles)?;
    let outcome = &folder.outcome;
    let varied = match outcome.thickness.iter().all(|row| outcome.has_its_base(row)) {
        true => format!("{WITH_AMOUNT}."),
        false => held(),
    };
    let caption = format!(
        "{varied} ×1 is this filter, {} layers of voids. Bars: 95 % intervals. {behind}",
        whole(folder.outcome.inputs.network.layers),
    );
    Some(Drawn::new("thickness", figure, caption))
}

/// How many replicates stand behind each point, and of what its class is, in words.
fn behind(outcome: &Outcome, cases: &[Varied]) -> String {
    let each = cases.iter().map(|case| format!("×{} {}", trimmed(case.factor), case.walked.replicates));
    let each = each.collect::<Vec<_>>().join(", ");
    let stopped = cases.iter().any(|case| case.walked.stopped_when_clear);
    let mut said = format!("Replicates: {each}.");
    if stopped {
        said += &format!(" {STOPPED_WHEN_CLEAR}");
    }
    if let Some(classes) = classes_of_points(outcome) {
        said += &format!(" {classes}");
    }
    said
}

/// Eroded mass against multiples of one thing, with title, description and name of the axis; `None` without
/// cases.
fn varied_by(walks: &Walks, mut cases: Vec<Varied>, titles: [&str; 3]) -> Option<Figure> {
    let [title, what, axis] = titles;
    cases.sort_by(|a, b| a.factor.total_cmp(&b.factor));
    let (least, most) = (cases.first()?.factor, cases.last()?.factor);
    let ticks = cases.iter().map(|case| {
        let mut tick = Tick::new(case.factor, &[&format!("×{}", trimmed(case.factor)), &case.below]);
        tick.rank = u8::from(case.factor != 1.0);
        tick
    });
    let x = Axis::log(axis, least, most).with_ticks(ticks.collect()).within(least / 1.25, most * 1.25);
    let highest = 100.0 * cases.iter().flat_map(|case| &case.walked.runs).map(upper).fold(0.0, f64::max);
    let y = eroded_axis("Base eroded, by mass (%)", walks, (highest * 1.3).min(100.0));
    let mut figure = Figure::new(title, what, "", x, y);
    let edge = |left: f64, right: f64| libm::sqrt(left * right);
    let mut left = least / 1.25;
    for same in cases.chunk_by(|a, b| a.walked.verdict == b.walked.verdict) {
        let (Some(first), Some(last)) = (same.first(), same.last()) else { continue };
        let next = cases.iter().find(|case| case.factor > last.factor);
        let right = next.map_or(most * 1.25, |next| edge(last.factor, next.factor));
        let outline = vec![(left, 0.0), (left, 100.0), (right, 100.0), (right, 0.0)];
        let area = Area::new(outline, verdict_colour(first.walked.verdict), 0.2);
        figure.add(area.label(&first.walked.verdict.words().replace(' ', "\n")));
        left = right;
    }
    figure.add(threshold_rule(walks, Across::Y));
    for run in walks.runs() {
        let (colour, shape, dash) = run_look(run);
        // the runs stand a little apart, so that their bars do not overlap
        let apart = if run == 1 { 0.985 } else { 1.015 };
        let found =
            || cases.iter().filter_map(|case| Some((case.factor, case.walked.runs.get(run as usize - 1)?)));
        let means = found().map(|(factor, statistic)| (factor * apart, statistic.mean * 100.0)).collect();
        let factors = found().map(|(factor, _)| factor).collect();
        figure.add(Line::new(means, colour).true_x(factors).dash(dash).label(run_name(run)));
        for (factor, statistic) in found() {
            let point = Point::new(factor * apart, statistic.mean * 100.0, colour, shape).true_x(factor);
            figure.add(point.y_interval(interval_in_percent(statistic)));
        }
    }
    Some(figure)
}
