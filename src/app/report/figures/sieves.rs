//! Scales above the frame of a figure of sizes in mm: fines, sand and gravel, and US sieve numbers.

use super::place::Rect;
use super::svg::{Anchor, Svg, width_of};

/// Openings (mm, ASTM E11) and names of sieves, in the order in which they are kept if there is little room.
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

/// Parts of a soil by size (mm), as ASTM D2487 divides them.
const PARTS: [(&str, f64, f64); 4] =
    [("fines", 0.0, 0.075), ("sand", 0.075, 4.75), ("gravel", 4.75, 75.0), ("cobbles", 75.0, f64::INFINITY)];

/// Height of the scales above the frame (pixels).
pub(super) const HEIGHT: f64 = 36.0;

const TEXT: f64 = 11.0;

/// Draws the scales above a frame; `at` gives the pixel of a size.
pub(super) fn draw(svg: &mut Svg, area: &Rect, at: impl Fn(f64) -> Option<f64>) {
    let Rect { left, top, right, bottom } = *area;
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
        svg.text((x, top - 8.0), Anchor::Middle, name, &size);
    }
    svg.text((left - 7.0, top - 8.0), Anchor::End, "US sieve", &quiet);
    for (name, finest, coarsest) in PARTS {
        for limit in [finest, coarsest] {
            if let Some(x) = at(limit).filter(inside) {
                let paint = r##"stroke="#767676" stroke-width="1" stroke-dasharray="1.5 3.5""##;
                svg.line((x, top - HEIGHT + 6.0), (x, bottom), paint);
            }
        }
        // Beyond an end of the axis a part reaches to that end.
        let edges = [finest, coarsest].map(|mm| if mm > 0.0 && mm.is_finite() { at(mm) } else { None });
        let (one, other) = match (edges, at(finest.max(1e-9) * 2.0), at(coarsest.min(1e9) / 2.0)) {
            ([Some(a), Some(b)], ..) => (a, b),
            ([Some(a), None], Some(more), _) => (a, if more > a { right } else { left }),
            ([None, Some(b)], _, Some(less)) => (b, if less > b { right } else { left }),
            _ => continue,
        };
        let (from, to) = (one.min(other).max(left), one.max(other).min(right));
        if to - from > width_of(name, TEXT) + 6.0 {
            svg.text(((from + to) / 2.0, top - 24.0), Anchor::Middle, name, &quiet);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::{Axis, BLUE, Figure, Line, Size};

    /// Place of a text along x.
    fn x_of(svg: &str, text: &str) -> Option<f64> {
        let (before, _) = svg.split_once(&format!(">{text}</text>"))?;
        let (_, element) = before.rsplit_once("<text x=\"")?;
        element.split('"').next()?.parse().ok()
    }

    fn figure(low: f64, high: f64, coarse_left: bool) -> Figure {
        let x = Axis::log("Size (mm)", low, high);
        let x = if coarse_left { x.downward() } else { x };
        let mut figure = Figure::new("Sieves", "", "", x, Axis::percent("Finer (%)")).sieves();
        figure.add(Line::new(vec![(low, 0.0), (high, 100.0)], BLUE).label("soil"));
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
        // A soil of sand alone, and one beyond every sieve.
        let sand = figure(0.2, 2.0, false).inline("s", Size::Wide);
        assert!(
            x_of(&sand, "sand").is_some()
                && x_of(&sand, "gravel").is_none()
                && x_of(&sand, "fines").is_none()
        );
        let dust = figure(1e-6, 1e-4, true).inline("s", Size::Wide);
        assert!(x_of(&dust, "fines").is_some() && x_of(&dust, "200").is_none());
    }

    #[test]
    fn a_pointer_is_told_the_values_of_points_and_named_lines() {
        let wide = figure(0.01, 40.0, false).inline("s", Size::Wide);
        assert!(wide.contains("<title>soil: Size (mm) 0.0100; Finer (%) 0</title>"), "{wide}");
        assert!(wide.contains("Finer (%) 100</title>"));
        assert!(!figure(0.01, 40.0, false).inline("s", Size::Narrow).contains("soil: Size"));
    }
}
