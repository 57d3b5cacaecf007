//! Frame of a figure: the pixel of a value, its grid, the labels of its axes, and above it the scales of
//! sieves and of soil fractions.

use super::axis::{Axis, Tick};
use super::figure::Figure;
use super::svg::{Rect, Svg, short, simplify, width_of, wrap};

pub(super) const TICK_TEXT: f64 = 13.0;
const LABEL_TEXT: f64 = 14.0;
pub(super) const LINE_HEIGHT: f64 = 17.0;
/// Minimum width and height of the frame (pixels).
const LEAST: f64 = 60.0;

/// Conversion of values to pixels.
pub(super) struct Frame<'a> {
    x: &'a Axis,
    y: &'a Axis,
    pub(super) area: Rect,
}

impl Frame<'_> {
    pub(super) fn x_at(&self, value: f64) -> Option<f64> {
        let share = self.x.position(value)?;
        let share = if self.x.downward { 1.0 - share } else { share };
        Some(self.area.left + share * (self.area.right - self.area.left))
    }

    pub(super) fn y_at(&self, value: f64) -> Option<f64> {
        let share = self.y.position(value)?;
        let share = if self.y.downward { share } else { 1.0 - share };
        Some(self.area.top + share * (self.area.bottom - self.area.top))
    }

    pub(super) fn at(&self, point: (f64, f64)) -> Option<(f64, f64)> {
        Some((self.x_at(point.0)?, self.y_at(point.1)?))
    }

    pub(super) fn path(&self, points: &[(f64, f64)]) -> Vec<(f64, f64)> {
        simplify(points.iter().filter_map(|point| self.at(*point)))
    }

    /// Path clipped to the frame, for finding room: hidden parts need no room.
    pub(super) fn seen(&self, path: &[(f64, f64)]) -> Vec<(f64, f64)> {
        let area = &self.area;
        path.iter().map(|(x, y)| (x.clamp(area.left, area.right), y.clamp(area.top, area.bottom))).collect()
    }
}

/// Makes a frame that is high enough to be seen, whatever the text above and below it: the figure grows.
pub(super) fn roomy(figure: &Figure, width: f64, height: f64, top: f64) -> (Frame<'_>, f64) {
    let first = frame(figure, width, height, top);
    let high = first.area.bottom - first.area.top;
    if high >= LEAST {
        return (first, height);
    }
    // In a higher frame the label beside it breaks into fewer lines, which makes the frame wider; the labels
    // below then need at most fewer lines.
    let height = height + LEAST - high;
    (frame(figure, width, height, top), height)
}

fn frame(figure: &Figure, width: f64, height: f64, top: f64) -> Frame<'_> {
    let widest =
        |axis: &Axis| axis.ticks.iter().map(|tick| width_of(&tick.text, TICK_TEXT)).fold(0.0, f64::max);
    let rows = if figure.x.ticks.iter().any(|tick| !tick.text.is_empty()) { 1.0 } else { 0.0 };
    let right = width - 20.0;
    let y_lines = if figure.y.label.is_empty() {
        0
    } else {
        wrap(&figure.y.label, LABEL_TEXT, height - top - 90.0).len()
    };
    // Text too long for the space beside the frame is cut off at the figure's edge.
    let left = (12.0 + y_lines as f64 * LINE_HEIGHT + widest(&figure.y) + 12.0).min(right - LEAST);
    let x_lines = wrap(&figure.x.label, LABEL_TEXT, right - left).len() as f64;
    let bottom = height - 10.0 - (x_lines + rows) * LINE_HEIGHT - 6.0;
    let top = top + 4.0;
    let side = if figure.square { (right - left).min(bottom - top).max(0.0) } else { f64::INFINITY };
    let (right, bottom) = (right.min(left + side), bottom.min(top + side));
    Frame { x: &figure.x, y: &figure.y, area: Rect { left, top, right, bottom } }
}

pub(super) fn grid(svg: &mut Svg, frame: &Frame<'_>) {
    let Rect { left, top, right, bottom } = frame.area;
    let minor = r##"stroke="#e6e6e6" stroke-width="0.8""##;
    let major = r##"stroke="#bdbdbd" stroke-width="1""##;
    for strong in [false, true] {
        let paint = if strong { major } else { minor };
        let drawn = |tick: &&Tick| (!tick.text.is_empty() && tick.rank == 0) == strong;
        for x in frame.x.ticks.iter().filter(drawn).filter_map(|tick| frame.x_at(tick.at)) {
            svg.line((x, top), (x, bottom), paint);
        }
        for y in frame.y.ticks.iter().filter(drawn).filter_map(|tick| frame.y_at(tick.at)) {
            svg.line((left, y), (right, y), paint);
        }
    }
    for (tick, x) in labelled(frame.x, |tick| {
        frame.x_at(tick.at).map(|x| (x, width_of(&tick.text, TICK_TEXT) / 2.0 + 4.0))
    }) {
        svg.text((x, bottom + 17.0), "middle", &tick.text, "");
    }
    for (tick, y) in labelled(frame.y, |tick| frame.y_at(tick.at).map(|y| (y, LINE_HEIGHT / 2.0))) {
        svg.text((left - 7.0, y + 4.5), "end", &tick.text, "");
    }
}

/// Ticks whose labels fit beside one another, important ones first, each with its position. `room` gives the
/// position of a tick and half the width of its label.
fn labelled(axis: &Axis, room: impl Fn(&Tick) -> Option<(f64, f64)>) -> Vec<(&Tick, f64)> {
    let mut kept: Vec<(&Tick, f64, f64)> = Vec::new();
    let highest = axis.ticks.iter().map(|tick| tick.rank).max().unwrap_or(0);
    for rank in 0..=highest {
        let group: Vec<_> = axis
            .ticks
            .iter()
            .filter(|tick| tick.rank == rank && !tick.text.is_empty())
            .filter_map(|tick| room(tick).map(|(at, half)| (tick, at, half)))
            .collect();
        // The first rank is thinned evenly until it fits; a lower rank is kept or dropped as a whole.
        let fits = |stride: usize| {
            let mut all = kept.clone();
            all.extend(group.iter().step_by(stride));
            all.sort_by(|a, b| a.1.total_cmp(&b.1));
            all.windows(2).all(|pair| pair[1].1 - pair[0].1 >= pair[0].2 + pair[1].2)
        };
        if group.is_empty() {
            continue;
        }
        let most = if kept.is_empty() { group.len() } else { 1 };
        match (1..=most).find(|stride| fits(*stride)) {
            Some(stride) => kept.extend(group.into_iter().step_by(stride)),
            None => break,
        }
    }
    kept.into_iter().map(|(tick, at, _)| (tick, at)).collect()
}

pub(super) fn axis_labels(svg: &mut Svg, frame: &Frame<'_>, height: f64) {
    let Rect { left, top, right, bottom } = frame.area;
    let size = format!("font-size=\"{LABEL_TEXT}\"");
    let lines = wrap(&frame.x.label, LABEL_TEXT, right - left);
    let first = height - 12.0 - (lines.len() as f64 - 1.0) * LINE_HEIGHT;
    for (row, line) in lines.iter().enumerate() {
        svg.text(((left + right) / 2.0, first + row as f64 * LINE_HEIGHT), "middle", line, &size);
    }
    let middle = (top + bottom) / 2.0;
    for (row, line) in wrap(&frame.y.label, LABEL_TEXT, height - top - 90.0).iter().enumerate() {
        let x = 20.0 + row as f64 * LINE_HEIGHT;
        let turned = format!("{size} transform=\"rotate(-90 {} {})\"", short(x), short(middle));
        svg.text((x, middle), "middle", line, &turned);
    }
}

/// Openings (mm, ASTM E11) and names of sieves, the most important first if there is little room.
const SIEVES: [(f64, &str); 11] = [
    (0.075, "200"),
    (4.75, "4"),
    (0.425, "40"),
    (19.0, "¾″"),
    (2.0, "10"),
    (0.15, "100"),
    (75.0, "3″"),
    (9.5, "⅜″"),
    (0.85, "20"),
    (0.25, "60"),
    (37.5, "1½″"),
];

/// Soil fractions by size (mm), as in ASTM D2487.
const PARTS: [(&str, f64, f64); 4] =
    [("fines", 0.0, 0.075), ("sand", 0.075, 4.75), ("gravel", 4.75, 75.0), ("cobbles", 75.0, f64::INFINITY)];

/// Height of the scales above the frame (pixels).
pub(super) const HEIGHT: f64 = 36.0;

const TEXT: f64 = 11.0;

/// Draws the scales of US sieves and of soil fractions above a frame whose x is a size in mm.
pub(super) fn sieves(svg: &mut Svg, frame: &Frame<'_>) {
    let Rect { left, top, right, bottom } = frame.area;
    let at = |size: f64| frame.x_at(size);
    let size = format!("font-size=\"{TEXT}\"");
    let quiet = format!("{size} fill=\"#555555\"");
    let inside = |x: &f64| (left..=right).contains(x);
    let mut kept: Vec<(f64, f64)> = Vec::new();
    for (mm, name) in SIEVES {
        let Some(x) = at(mm).filter(inside) else { continue };
        let half = width_of(name, TEXT) / 2.0 + 3.0;
        if kept.iter().any(|(other, room)| (other - x).abs() < half + room) {
            continue;
        }
        kept.push((x, half));
        svg.line((x, top - 5.0), (x, top), r##"stroke="#1a1a1a" stroke-width="1""##);
        svg.text((x, top - 8.0), "middle", name, &size);
    }
    svg.text((left - 7.0, top - 8.0), "end", "US sieve", &quiet);
    for (name, finest, coarsest) in PARTS {
        for limit in [finest, coarsest] {
            if let Some(x) = at(limit).filter(inside) {
                let paint = r##"stroke="#767676" stroke-width="1" stroke-dasharray="1.5 3.5""##;
                svg.line((x, top - HEIGHT + 6.0), (x, bottom), paint);
            }
        }
        // A fraction that extends beyond the axis ends with it.
        let edges = [finest, coarsest].map(|mm| if mm > 0.0 && mm.is_finite() { at(mm) } else { None });
        let (one, other) = match (edges, at(finest.max(1e-9) * 2.0), at(coarsest.min(1e9) / 2.0)) {
            ([Some(a), Some(b)], ..) => (a, b),
            ([Some(a), None], Some(more), _) => (a, if more > a { right } else { left }),
            ([None, Some(b)], _, Some(less)) => (b, if less > b { right } else { left }),
            _ => continue,
        };
        let (from, to) = (one.min(other).max(left), one.max(other).min(right));
        if to - from > width_of(name, TEXT) + 6.0 {
            svg.text(((from + to) / 2.0, top - 24.0), "middle", name, &quiet);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::{BLUE, Mark, Size};
    use super::*;

    #[test]
    fn crowded_tick_labels_are_thinned_and_the_important_kept() {
        let axis = Axis::log("x", 0.11, 8.5);
        let kept = |half: f64| {
            let ticks = labelled(&axis, |tick| axis.position(tick.at).map(|share| (share * 300.0, half)));
            let mut texts: Vec<_> = ticks.into_iter().map(|(tick, _)| tick.text.clone()).collect();
            texts.sort();
            texts
        };
        assert_eq!(kept(10.0), ["0.1", "0.2", "0.5", "1", "2", "5"]);
        assert_eq!(kept(40.0), ["0.1", "1"]);
    }

    fn x_of(svg: &str, text: &str) -> Option<f64> {
        let (before, _) = svg.split_once(&format!(">{text}</text>"))?;
        let (_, element) = before.rsplit_once("<text x=\"")?;
        element.split('"').next()?.parse().ok()
    }

    fn figure(low: f64, high: f64, coarse_left: bool) -> Figure {
        let x = Axis::log("Size (mm)", low, high);
        let x = if coarse_left { x.downward() } else { x };
        let mut figure = Figure::new("Sieves", "", x, Axis::percent("Finer (%)")).sieves();
        figure.add(Mark::line(vec![(low, 0.0), (high, 100.0)], BLUE).label("soil"));
        figure
    }

    #[test]
    fn sieves_and_parts_stand_over_their_sizes_from_either_side() {
        let order = ["fines", "200", "sand", "4", "gravel", "¾″"];
        for coarse_left in [false, true] {
            for size in [Size::Wide, Size::Narrow] {
                let svg = figure(0.01, 40.0, coarse_left).inline("s", size);
                let mut places: Vec<f64> = order.iter().map(|text| x_of(&svg, text).expect(text)).collect();
                if coarse_left {
                    places.reverse();
                }
                assert!(places.windows(2).all(|pair| pair[0] < pair[1]), "{coarse_left}: {places:?}");
            }
        }
        // A soil of sand alone, and a soil beyond every sieve.
        let sand = figure(0.2, 2.0, false).inline("s", Size::Wide);
        assert_eq!(["sand", "gravel", "fines"].map(|text| x_of(&sand, text).is_some()), [true, false, false]);
        let dust = figure(1e-6, 1e-4, true).inline("s", Size::Wide);
        assert!(x_of(&dust, "fines").is_some() && x_of(&dust, "200").is_none());
    }
}
