//! Values that a pointer shows: an unseen spot with a title on points of each named line.

use super::figure::Figure;
use super::marks::Mark;
use super::path::simplify;
use super::place::Rect;
use super::svg::{Svg, escape, short};
use crate::report::quantity::significant;

/// Spots on a line, at most, and the space between two (pixels).
const SPOTS: usize = 24;
const APART: f64 = 14.0;

/// Title that a pointer shows at a point.
pub(super) fn title(figure: &Figure, label: Option<&str>, (x, y): (f64, f64)) -> String {
    let name = label.map_or(String::new(), |label| format!("{}: ", label.replace('\n', " ")));
    // An axis of rows has no label: its value is a place. The text after a label's first clause describes the
    // marks along the axis, not a value.
    let value = |label: &str, value: f64| match label.split([';', '\n']).next().unwrap_or_default() {
        "" => String::new(),
        label => format!("{label} {}", significant(value)),
    };
    let values = [value(&figure.x.label, x), value(&figure.y.label, y)];
    let values: Vec<&str> = values.iter().map(String::as_str).filter(|text| !text.is_empty()).collect();
    format!("<title>{}</title>", escape(&format!("{name}{}", values.join("; "))))
}

/// Draws the spots, each mark's in a group of its class; `at` gives the pixel of a point.
pub(super) fn draw(
    svg: &mut Svg,
    figure: &Figure,
    classes: &[String],
    area: &Rect,
    at: impl Fn((f64, f64)) -> Option<(f64, f64)>,
) {
    for (mark, class) in figure.marks.iter().zip(classes) {
        let Mark::Line(line) = mark else { continue };
        let Some(label) = line.label.as_deref() else { continue };
        let inside = |(x, y): &(f64, f64)| {
            (area.left..=area.right).contains(x) && (area.top..=area.bottom).contains(y)
        };
        let drawn = |&point: &(f64, f64)| Some((point, at(point).filter(inside)?));
        let seen: Vec<((f64, f64), (f64, f64))> = line.points.iter().filter_map(drawn).collect();
        let few = simplify(seen.iter().map(|(_, pixel)| *pixel)).len().clamp(2, SPOTS);
        let stride = seen.len().div_ceil(few).max(1);
        let mut last: Option<(f64, f64)> = None;
        svg.raw(&format!("<g{class}>\n"));
        for (point, (x, y)) in seen.into_iter().step_by(stride) {
            if last.is_some_and(|(a, b)| libm::hypot(x - a, y - b) < APART) {
                continue;
            }
            last = Some((x, y));
            svg.raw(&format!(
                "<circle cx=\"{}\" cy=\"{}\" r=\"7\" fill=\"none\" pointer-events=\"all\">{}</circle>\n",
                short(x),
                short(y),
                title(figure, Some(label), point)
            ));
        }
        svg.raw("</g>\n");
    }
}

#[cfg(test)]
mod tests {
    use super::super::{Axis, BLUE, Line, Point, Shape, Size};
    use super::*;

    /// The words are the first line of the axis label.
    #[test]
    fn a_pointer_shows_the_place_of_a_mark() {
        let x = Axis::log("Times the grains; below, grains per void", 0.5, 2.0);
        let mut figure = Figure::new("title", "what", "", x, Axis::linear("Eroded (%)", 0.0, 100.0));
        let line = Line::new(vec![(1.0, 20.0), (2.0, 60.0)], BLUE);
        figure.add(line.label("first"));
        figure.add(Point::new(1.0, 20.0, BLUE, Shape::Circle));
        let drawn = figure.inline("one", Size::Wide);
        for values in ["Times the grains 1.00; Eroded (%) 20.0", "Times the grains 2.00; Eroded (%) 60.0"] {
            assert!(drawn.contains(&format!("<title>first: {values}</title>")), "{values}: {drawn}");
        }
        assert!(drawn.contains("<title>Times the grains 1.00; Eroded (%) 20.0</title>"), "{drawn}");
    }
}
