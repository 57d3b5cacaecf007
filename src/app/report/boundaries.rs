//! The boundaries of practice at the row of D15F, as engineers know them from Foster and Fell: short vertical
//! lines on the sheet of gradations.

use super::figures::{Across, BLACK, Colour, Dash, Figure, GREEN, GREY, Line, PURPLE, Rule};
use voidwalk_practice::Decision;
use voidwalk_practice::RuleQuantity;
use voidwalk_practice::rules::{DESIGN, TESTS_CONTINUING, TESTS_NO_EROSION};

/// Half the height of a line, in percent finer.
const HALF: f64 = 4.0;

/// The rules whose limit is a D15F: the name beside the line, its colour, and its words in the caption.
const LIMITS: [(&str, &str, Colour, &str); 3] = [
    (DESIGN, "design", GREY, "design"),
    (TESTS_NO_EROSION, "NE", GREEN, "no erosion (NE)"),
    (TESTS_CONTINUING, "CE", PURPLE, "continuing erosion (CE)"),
];

/// A boundary: its index in [`LIMITS`], and its D15F.
type Boundary = (usize, f64);

/// The boundaries that are known for these soils.
pub(super) fn boundaries(decision: &Decision) -> Vec<Boundary> {
    let limit = |id: &str| {
        let rule = decision.applied(id).filter(|rule| rule.quantity == RuleQuantity::D15F)?;
        let is_unclear = id == TESTS_CONTINUING && decision.is_beyond_unclear;
        rule.limit.filter(|limit| !is_unclear && *limit > 0.0 && limit.is_finite())
    };
    let boundary = |(place, (id, ..)): (usize, &(&str, _, _, _))| Some((place, limit(id)?));
    LIMITS.iter().enumerate().filter_map(boundary).collect()
}

/// Draws the row of 15 % and the boundaries at it, which are named there; the caption names the row.
pub(super) fn draw(figure: &mut Figure, boundaries: &[Boundary]) {
    figure.add(Rule::new(Across::Y, 15.0, BLACK).dash(Dash::Dotted));
    for (place, limit) in boundaries {
        let (_, name, colour, _) = LIMITS[*place];
        let line = Line::new(vec![(*limit, 15.0 - HALF), (*limit, 15.0 + HALF)], colour);
        figure.add(line.width(3.0).stays().label(name));
    }
}

/// The names of the lines, for the caption; empty without lines.
pub(super) fn caption(decision: &Decision, boundaries: &[Boundary]) -> String {
    if boundaries.is_empty() {
        return String::new();
    }
    // Design and no erosion have the same limit for a dispersive base.
    let is_one = decision.without_margin().is_some();
    let name = |(place, ..): &Boundary| match LIMITS[*place] {
        (DESIGN, ..) if is_one => "design and no erosion",
        (.., name) => name,
    };
    let repeats = |(place, ..): &&Boundary| is_one && LIMITS[*place].0 == TESTS_NO_EROSION;
    let names: Vec<&str> = boundaries.iter().filter(|line| !repeats(line)).map(name).collect();
    format!(" Short lines: D15F of {}.", names.join(", "))
}
