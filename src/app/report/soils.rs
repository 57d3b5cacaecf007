//! The sieve curves of soils, as one figure.

use super::figures::{Axis, BLACK, BLUE, Dash, Figure, GREEN, GREY, Line, ORANGE, PURPLE, VERMILLION};
use super::figures::{positive_range, shorten};
use crate::outcome::CurvePoint;

/// Percent finer by mass against size (mm) for each soil: its name and its points, as an SVG file; with
/// coarse sizes on the left if requested, as in the United States.
pub fn soils_figure<'a>(
    soils: impl IntoIterator<Item = (&'a str, &'a [CurvePoint])>,
    coarse_left: bool,
) -> String {
    let soils: Vec<(&str, &[CurvePoint])> = soils.into_iter().collect();
    let (low, high) =
        positive_range(soils.iter().flat_map(|(_, points)| points.iter().map(|point| point.size)));
    // One size alone still gets a range.
    let high = if high > low { high } else { 2.0 * low };
    let names: Vec<String> = soils.iter().map(|(name, _)| shorten(name, 40)).collect();
    let what = format!("Percent finer by mass against size for {}", names.join(", "));
    let (x, y) = (Axis::log("Size (mm)", low, high), Axis::percent("Percent finer by mass (%)"));
    let x = if coarse_left { x.downward() } else { x };
    let mut figure = Figure::new("Sieve curves", &what, "", x, y).sieves();
    let colours = [BLACK, VERMILLION, BLUE, GREEN, PURPLE, ORANGE, GREY];
    let dashes = [Dash::Solid, Dash::Dashed];
    for (index, ((_, points), name)) in soils.iter().zip(&names).enumerate() {
        let dash = dashes[index / colours.len() % dashes.len()];
        let points = points.iter().map(|point| (point.size, point.percent)).collect();
        let line = Line::new(points, colours[index % colours.len()]);
        figure.add(line.dash(dash).label(name));
    }
    figure.file()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_soil_has_its_curve_and_its_name() {
        let point = |(size, percent)| CurvePoint { size, percent };
        let [fine, coarse] =
            [[(0.1, 0.0), (1.0, 100.0)], [(1.0, 10.0), (20.0, 100.0)]].map(|curve| curve.map(point));
        let text = soils_figure([("fine <side>", &fine[..]), ("coarse", &coarse[..])], false);
        assert!(text.starts_with("<?xml") || text.starts_with("<svg"), "{}", &text[..40]);
        assert!(text.contains(">fine &lt;side&gt;<") && text.contains(">coarse<"));
        // One size.
        assert!(soils_figure([("one", &[point((2.0, 100.0))][..])], false).contains("</svg>"));
    }
}
