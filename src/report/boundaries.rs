//! The boundaries of practice at the row of D15F, as engineers know them from Foster and Fell: short vertical
//! lines on the sheet of gradations.

use super::figures::{Across, BLACK, Colour, Dash, Figure, GREEN, GREY, Line, PURPLE, Rule};
use super::numbers::{SizeUnit, rounded_down};
use crate::outcome::record::{Outcome, RuleQuantity};
use crate::outcome::rules::{DESIGN, TESTS_CONTINUING, TESTS_NO_EROSION};
use crate::verdict::rule_words::without_margin;
use crate::verdict::tested::is_beyond_unclear;

/// Half the height of a line, in percent finer.
const HALF: f64 = 4.0;

/// The rules whose limit is a D15F: what stands beside the line, its colour, and what the caption says of it.
const LIMITS: [(&str, &str, Colour, &str); 3] = [
    (DESIGN, "design", GREY, "design (Sherard and Dunnigan)"),
    (TESTS_NO_EROSION, "NE", GREEN, "no erosion (NE)"),
    (TESTS_CONTINUING, "CE", PURPLE, "continuing erosion (CE)"),
];

/// A boundary: its place in [`LIMITS`], the D15F at which it is, and whether it is that or less.
type Boundary = (usize, f64, bool);

/// The boundaries that are known for these soils.
pub(super) fn boundaries(outcome: &Outcome) -> Vec<Boundary> {
    let limit = |id: &str| {
        let rule = outcome.rules.iter().find(|rule| rule.id == id && rule.applies)?;
        if id == TESTS_CONTINUING && is_beyond_unclear(&outcome.rules) {
            return None;
        }
        let limit = rule
            .limit
            .filter(|limit| rule.quantity == RuleQuantity::D15F && *limit > 0.0 && limit.is_finite())?;
        Some((limit, rule.limit_at_most))
    };
    let boundary = |(place, (id, ..)): (usize, &(&str, _, _, _))| {
        let (limit, at_most) = limit(id)?;
        Some((place, limit, at_most))
    };
    LIMITS.iter().enumerate().filter_map(boundary).collect()
}

/// Draws the row of 15 % and the boundaries at it, whose names stand alone there: the caption names the row.
pub(super) fn draw(figure: &mut Figure, boundaries: &[Boundary]) {
    figure.add(Rule::new(Across::Y, 15.0, BLACK).dash(Dash::Dotted));
    for (place, limit, _) in boundaries {
        let (_, name, colour, _) = LIMITS[*place];
        let line = Line::new(vec![(*limit, 15.0 - HALF), (*limit, 15.0 + HALF)], colour);
        figure.add(line.width(3.0).stays().label(name));
    }
}

/// What the caption says of them; nothing where there are none.
pub(super) fn caption(outcome: &Outcome, boundaries: &[Boundary], unit: SizeUnit) -> String {
    if boundaries.is_empty() {
        return String::new();
    }
    // Design and no erosion are one number, which neither Sherard and Dunnigan nor Foster and Fell give.
    let is_one = without_margin(&outcome.rules).is_some();
    let one = |(place, limit, at_most): &Boundary| {
        let at_most = if *at_most { " or less" } else { "" };
        // As in the table of rules: no more than the limit.
        let size = match unit {
            SizeUnit::D0f => format!("{}\u{202f}D0F", rounded_down(*limit)),
            _ => format!("{}\u{202f}mm{}", rounded_down(*limit), unit.beside_greatest(*limit)),
        };
        let name = match LIMITS[*place] {
            (DESIGN, ..) if is_one => "design and of no erosion (NE) of a dispersive base (Fell et al.)",
            (TESTS_CONTINUING, ..) if is_one => "continuing erosion (CE, Foster and Fell)",
            (.., name) => name,
        };
        format!("{name} {size}{at_most}")
    };
    let is_said = |(place, ..): &&Boundary| is_one && LIMITS[*place].0 == TESTS_NO_EROSION;
    let all: Vec<String> = boundaries.iter().filter(|of| !is_said(of)).map(one).collect();
    let whose = if is_one { "" } else { " (boundaries of erosion: Foster and Fell)" };
    format!(" Short lines at the 15 % row: D15F of {}{whose}.", all.join(", "))
}
