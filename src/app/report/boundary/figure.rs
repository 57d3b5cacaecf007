//! Erosion against D15F in the model: the erosion of every network, and the three zones.

use super::words::size_unit;
use crate::outcome::boundary::{Boundaries, Boundary, BoundaryRow, WalkRow};
use crate::report::figures::{
    Across, Area, Axis, BLACK, BLUE, Colour, Dash, Figure, GREY, Line, ORANGE, PURPLE, Rule, VERMILLION,
};
use crate::report::shell::Drawn;
use crate::words::base_size;
use crate::words::boundary::drawn_of_networks;

/// Draws the row that holds least; if no row is known to hold, the first that has a boundary or was walked at
/// all.
pub(super) fn erosion(all: &Boundaries, walks: &[WalkRow]) -> Option<Drawn> {
    let is_of = |row: &BoundaryRow, walk: &&WalkRow| {
        walk.density == row.searched() && walk.thickness == row.thickness
    };
    let has_walks = |row: &&BoundaryRow| walks.iter().any(|walk| is_of(row, &walk));
    let with_boundary = |row: &&BoundaryRow| row.no_erosion.is_some();
    let rows = || all.boundaries.iter().filter(has_walks);
    let least = all.least_held().map(|(row, _)| row).filter(has_walks);
    let row = least.or_else(|| rows().find(with_boundary)).or_else(|| rows().next())?;
    let walks: Vec<&WalkRow> = walks.iter().filter(|walk| is_of(row, walk)).collect();
    // Sizes are in mm if the base has a size.
    let (d85, axis) = match all.base.d85_mm {
        Some(d85) => (d85, "D15F (mm)"),
        None => (1.0, "D15F/D85B (–)"),
    };
    let shown = walks.iter().map(|walk| walk.d15f_over_d85b * d85);
    let shown: Vec<f64> = shown.filter(|at| *at > 0.0 && at.is_finite()).collect();
    let low = shown.iter().copied().fold(f64::INFINITY, f64::min);
    let high = shown.iter().copied().fold(0.0, f64::max);
    if low > high {
        return None;
    }
    let x = Axis::log(axis, low, if high > low { high } else { 2.0 * low });
    let ends = (x.low, x.high);
    let what = "Percent of the base eroded against D15F in both runs of every network, with the zones of no, \
                some and continuing erosion in the model";
    let mut figure =
        Figure::new("Erosion against D15F", what, "", x, Axis::percent("Base eroded, by mass (%)"))
            .sizes((760.0, 340.0), (358.0, 420.0));
    zones(&mut figure, row, d85, ends);
    figure.add(Rule::new(Across::Y, 100.0 * all.threshold, BLACK).dash(Dash::Dashed).label("7.5 %"));
    draw_runs(&mut figure, &walks, d85);
    let of_base =
        all.base.size().map_or(String::new(), |base| format!(" {}.", base_size(&base, size_unit(all))));
    let blend = match all.replicates {
        1 => String::new(),
        networks => format!(" The colours blend over the {} of the networks.", drawn_of_networks(networks)),
    };
    let mut caption = format!(
        "Base eroded against D15F: {}, {}. Each thin line is a network: blue its first run, purple its \
         second where it was walked. In the model, grey: no erosion; orange: some erosion; red: continuing \
         erosion.{blend}{of_base}",
        row.name(),
        row.thickness
    );
    if all.boundaries.len() > 1 {
        if least.is_some() {
            caption += " Of all that were searched this one holds least.";
        }
        caption += " The other densities and thicknesses are in the table.";
    }
    Some(Drawn::new("boundary", figure, caption))
}

/// The zones of the model, over the whole width of the figure. No zone is green, which is a colour of
/// practice.
fn zones(figure: &mut Figure, row: &BoundaryRow, d85: f64, (left, right): (f64, f64)) {
    let edges = |boundary: &Boundary| {
        let at = |ratio: f64| (ratio * d85).clamp(left, right);
        // Some erosion begins at the left edge if no ratio is known that nearly all networks hold.
        [at(boundary.cautious().unwrap_or(0.0)), at(boundary.high.unwrap_or(boundary.median))]
    };
    // A row that holds to the end of the search is drawn to that end.
    let [from, to] = match (&row.no_erosion, row.holds_to) {
        (Some(first), _) => edges(first),
        (None, Some(ratio)) => [right, (ratio * d85).clamp(left, right)],
        (None, None) => return,
    };
    let continuing = row.continuing.as_ref().map(edges);
    let mut zone = |low: f64, high: f64, colour: Colour, opacity: f64, name: &str| {
        if high > low {
            let area = Area::new(vec![(low, 0.0), (high, 0.0), (high, 100.0), (low, 100.0)], colour, opacity);
            figure.add(if name.is_empty() { area } else { area.label(name) });
        }
    };
    zone(left, to, GREY, 0.12, "no erosion");
    if row.no_erosion.is_none() {
        return;
    }
    let [end, most] = continuing.unwrap_or([right, right]);
    zone(from, most, ORANGE, 0.14, if end > 1.05 * to { "some" } else { "" });
    if most < right || continuing.is_some() {
        zone(end, right, VERMILLION, 0.12, "continuing");
    }
}

/// Both runs of every network.
fn draw_runs(figure: &mut Figure, walks: &[&WalkRow], d85: f64) {
    let mut networks: Vec<u64> = walks.iter().map(|walk| walk.network).collect();
    networks.dedup();
    for (index, network) in networks.iter().enumerate() {
        let of_network = || walks.iter().filter(|walk| walk.network == *network);
        let first = of_network().map(|walk| (walk.d15f_over_d85b * d85, 100.0 * walk.eroded_first));
        let second =
            of_network().filter_map(|walk| Some((walk.d15f_over_d85b * d85, 100.0 * walk.eroded_second?)));
        for (points, colour, name) in
            [(first.collect(), BLUE, "first run"), (second.collect::<Vec<_>>(), PURPLE, "second run")]
        {
            if points.is_empty() {
                continue;
            }
            let line = Line::new(points, colour).width(1.2).opacity(0.7);
            figure.add(if index == 0 { line.label(name) } else { line });
        }
    }
}
