//! Erosion against D15F: what every network eroded, the three zones, and the limits of practice on one axis.

use crate::outcome::design::band::{SetBy, limits, open_retention, retention};
use crate::outcome::design::{Boundary, Design, DesignRow, Specification, WalkRow, drawn_of_networks};
use crate::outcome::record::AppliedRule;
use crate::outcome::rules::{
    DESIGN, PAPER_CONTINUING, PAPER_NO_EROSION, PERMEABILITY, PERMEABILITY_LEAST, TERZAGHI, TESTS_CONTINUING,
    TESTS_NO_EROSION,
};
use crate::report::figures::{
    Across, Area, Axis, BLACK, BLUE, Colour, Dash, Figure, GREEN, GREY, Line, ORANGE, PURPLE, Rule,
    VERMILLION,
};
use crate::report::numbers::SizeUnit;
use crate::report::shell::Drawn;

/// Where the band to specify is drawn (percent of the base eroded).
const BAR: f64 = 1.5;

/// Names of rules beside their lines.
const NAMES: [(&str, &str); 8] = [
    (PERMEABILITY, "drains"),
    (PERMEABILITY_LEAST, "drains (EM 1110-2-1901)"),
    (DESIGN, "design"),
    (TERZAGHI, "Terzaghi"),
    (PAPER_NO_EROSION, "paper, no erosion"),
    (TESTS_NO_EROSION, "NE"),
    (PAPER_CONTINUING, "paper, continuing"),
    (TESTS_CONTINUING, "CE"),
];

/// The figure, of the row that the answer is of: that which holds least. Where none is known to hold, of the
/// first that has a boundary or was walked at all.
pub(super) fn erosion(design: &Design, walks: &[WalkRow]) -> Option<Drawn> {
    let is_of =
        |row: &DesignRow, walk: &&WalkRow| walk.density == row.searched() && walk.thickness == row.thickness;
    let has_walks = |row: &&DesignRow| walks.iter().any(|walk| is_of(row, &walk));
    let with_boundary = |row: &&DesignRow| row.no_erosion.is_some();
    let rows = || design.boundaries.iter().filter(has_walks);
    let least = design.least_held().map(|(row, _)| row).filter(has_walks);
    let row = least.or_else(|| rows().find(with_boundary)).or_else(|| rows().next())?;
    let walks: Vec<&WalkRow> = walks.iter().filter(|walk| is_of(row, walk)).collect();
    // In mm where the base has a size and stays as it is.
    let (d85, axis, unit) = match design.base.d85_mm.filter(|_| !design.inverse) {
        Some(d85) => (d85, "D15F (mm)", "mm"),
        None => (1.0, "D15F/D85B (–)", ""),
    };
    let limits = of_rules(design, d85);
    let shown = walks.iter().map(|walk| walk.d15f_over_d85b * d85).chain(limits.iter().map(|of| of.1));
    let shown: Vec<f64> = shown.filter(|at| *at > 0.0 && at.is_finite()).collect();
    let low = shown.iter().copied().fold(f64::INFINITY, f64::min);
    let high = shown.iter().copied().fold(0.0, f64::max);
    if low > high {
        return None;
    }
    let x = Axis::log(axis, low, if high > low { high } else { 2.0 * low });
    let ends = (x.low, x.high);
    let what = "Percent of the base eroded against D15F in both runs of every network, with the zones of no, \
                some and continuing erosion and the limits of practice";
    let mut figure =
        Figure::new("Erosion against D15F", what, "", x, Axis::percent("Base eroded, by mass (%)"))
            .sizes((760.0, 340.0), (358.0, 420.0));
    let practice = Allowed::of(design, d85);
    zones(&mut figure, row, d85, &practice, ends);
    for (rule, at) in &limits {
        let name = NAMES.iter().find(|(id, _)| *id == rule.id).map_or(rule.name.as_str(), |(_, name)| *name);
        let at_most = if rule.limit_at_most { ", at most" } else { "" };
        figure.add(
            Rule::new(Across::X, *at, if rule.at_least { BLACK } else { GREY })
                .dash(Dash::Dotted)
                .label(&format!("{name}{at_most}")),
        );
    }
    figure.add(Rule::new(Across::Y, 100.0 * design.threshold, BLACK).dash(Dash::Dashed).label("7.5 %"));
    draw_runs(&mut figure, &walks, d85);
    let specified = design.specification.as_ref().filter(|_| !unit.is_empty());
    if let Some(band) = specified.and_then(|of| of.band.as_ref()) {
        let [least, greatest] = band.d15_mm();
        let bar = Line::new(vec![(least, BAR), (greatest, BAR)], BLACK).width(6.0).stays();
        figure.add(bar.label("band to specify"));
    }
    let of_base = design.base.size().map_or(String::new(), |base| format!(" {}.", base.words()));
    let blend = match design.replicates {
        1 => String::new(),
        networks => format!(" The colours blend over the {} of the networks.", drawn_of_networks(networks)),
    };
    let mut caption = format!(
        "Base eroded against D15F: {}, {}. Each thin line is a network: blue its first run, purple its \
         second where it was walked. {}; orange: some erosion; red: continuing erosion.{blend}{of_base}",
        row.name(),
        row.thickness,
        practice.words()
    );
    if design.boundaries.len() > 1 {
        if least.is_some() {
            caption += " Of all that were searched this one holds least.";
        }
        caption += " The other densities and thicknesses are in the table.";
    }
    if let Some(band) = specified.and_then(Specification::band_in_words) {
        caption += &format!(" Thick bar: the band to specify, {band}.");
    }
    // As in the tables: no more than a greatest, and no less than a least.
    let shown = SizeUnit::of(unit.is_empty(), design.inches);
    let within = |rule: &AppliedRule, at: f64| {
        let at_most = if rule.limit_at_most { "at most " } else { "" };
        format!("{at_most}{}", shown.limit(at, unit, rule.at_least))
    };
    let lines: Vec<String> =
        limits.iter().map(|(rule, at)| format!("{} {}", rule.name, within(rule, *at).trim_end())).collect();
    if !lines.is_empty() {
        caption += &format!(" Dotted: {}.", lines.join("; "));
    }
    Some(Drawn::new("design", figure, caption))
}

/// How far practice allows what the walk holds.
enum Allowed {
    /// As far as the walk holds: no limit of practice is known, as sizes have no unit, or it is no stricter.
    All,
    /// Up to this place on the figure's axis.
    UpTo(f64),
    /// Practice allows nothing that was searched.
    Nothing,
    /// Of the limit of practice only the most is known, which allows nothing.
    NotKnown,
}

impl Allowed {
    fn of(design: &Design, d85: f64) -> Self {
        let answer = design.answer();
        match (answer.d15f_over_d85b, design.least_held()) {
            // A rule that a finer base breaks, or none as its limit is not known.
            (None, Some(_)) if design.inverse && answer.rule.is_some() => Self::Nothing,
            (None, Some(_)) if design.inverse => Self::NotKnown,
            (Some(ratio), _) if design.inverse && answer.set_by == SetBy::Practice => Self::UpTo(ratio * d85),
            _ if design.inverse => Self::All,
            _ => match retention(&design.rules, design.rules_at * d85) {
                _ if open_retention(&design.rules).is_some() => Self::NotKnown,
                Some((_, limit)) => Self::UpTo(limit),
                None => Self::All,
            },
        }
    }

    /// What green and grey mean.
    fn words(&self) -> &'static str {
        match self {
            Self::NotKnown => {
                "Grey: no erosion in the model. Nothing is green, because only an upper bound of the limit \
                 of practice is known"
            }
            _ => "Green: no erosion, as far as practice allows it; grey: no erosion beyond that",
        }
    }
}

/// Limits of D15F on the figure's axis.
fn of_rules(design: &Design, d85: f64) -> Vec<(&AppliedRule, f64)> {
    // Rules are in the unit of the design, which the inverse has another of.
    if design.inverse {
        return Vec::new();
    }
    limits(&design.rules, design.rules_at * d85)
}

/// The zones, as wide as the figure is.
///
/// What the walk alone holds beyond practice is no zone of no erosion.
fn zones(figure: &mut Figure, row: &DesignRow, d85: f64, practice: &Allowed, (left, right): (f64, f64)) {
    let of = |boundary: &Boundary| {
        let at = |ratio: f64| (ratio * d85).clamp(left, right);
        // Where no ratio is known that nearly all networks hold, some erosion begins at the left.
        [at(boundary.cautious().unwrap_or(0.0)), at(boundary.high.unwrap_or(boundary.median))]
    };
    // What holds all that was searched is green as far as that.
    let [from, to] = match (&row.no_erosion, row.holds_to) {
        (Some(first), _) => of(first),
        (None, Some(ratio)) => [right, (ratio * d85).clamp(left, right)],
        (None, None) => return,
    };
    let continuing = row.continuing.as_ref().map(of);
    let mut zone = |low: f64, high: f64, colour: Colour, opacity: f64, name: &str| {
        if high > low {
            let area = Area::new(vec![(low, 0.0), (high, 0.0), (high, 100.0), (low, 100.0)], colour, opacity);
            figure.add(if name.is_empty() { area } else { area.label(name) });
        }
    };
    let (allowed, beyond) = match practice {
        Allowed::All => (to, ""),
        Allowed::UpTo(limit) => (limit.clamp(left, to), "beyond practice"),
        Allowed::Nothing => (left, "beyond practice"),
        Allowed::NotKnown => (left, "practice not known"),
    };
    zone(left, allowed, GREEN, 0.10, "no erosion");
    zone(allowed, to, GREY, 0.12, beyond);
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
