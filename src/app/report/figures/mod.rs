//! Figures: axes, lines, areas, points and rules, drawn as SVG.
//!
//! A `Figure` holds the content; `Figure::file` and `Figure::inline` draw it. It follows the habits of
//! geotechnical engineers (semi-logarithmic paper with minor lines, depth downward, a name beside each curve)
//! and suits pages that forbid all content from elsewhere: it has only presentation attributes, no script, no
//! style element, and no external font or image. Colours are by Okabe and Ito, which colour-blind readers can
//! distinguish, and never the only difference between curves: dashes, widths and symbols differ as well.

mod axis;
mod curves;
mod draw;
mod figure;
mod frame;
mod svg;

pub use axis::Axis;
pub(crate) use axis::{Tick, positive_range};
pub(crate) use figure::{Across, BLACK, GREY, ORANGE, PURPLE, Size, ramp};
pub use figure::{BLUE, Colour, Dash, Figure, GREEN, Mark, Shape, VERMILLION};
pub(crate) use voidwalk_core::text::shorten;

#[cfg(test)]
mod tests {
    use super::*;

    fn figure() -> Figure {
        let x = Axis::log("Size (mm)", 0.1, 10.0);
        let mut figure = Figure::new("A <b>", "of \"two\" & more", x, Axis::percent("Finer (%)"));
        figure.add(
            Mark::line(vec![(0.1, 0.0), (1.0, 50.0), (10.0, 100.0)], BLUE).label("<script>alert(1)</script>"),
        );
        figure.add(Mark::point(1.0, 50.0, BLACK, Shape::Circle).dropped().label("D50 = 1 mm"));
        figure.add(Mark::rule(Across::Y, 85.0, GREY).dash(Dash::Dashed).label("85 %"));
        figure.add(Mark::area(vec![(0.1, 0.0), (1.0, 10.0), (1.0, 0.0)], GREEN, 0.2));
        figure
    }

    #[test]
    fn names_are_inert_and_nothing_is_fetched_or_styled() {
        for text in
            [figure().file(), figure().inline("one", Size::Wide), figure().inline("two", Size::Narrow)]
        {
            assert!(text.contains("&lt;script&gt;alert(1)&lt;/script&gt;") && !text.contains("<script"));
            assert!(
                text.contains(">A &lt;b&gt;</title>")
                    && text.contains(">of &quot;two&quot; &amp; more</desc>")
            );
            for forbidden in ["style=", "<style", "href", "src="] {
                assert!(!text.contains(forbidden), "{forbidden}");
            }
            assert_eq!(text.matches("http").count(), usize::from(text.starts_with("<?xml")));
        }
    }

    #[test]
    fn a_page_may_hold_the_same_figure_twice() {
        let text = figure().inline("one", Size::Wide);
        for part in text.split("id=\"").skip(1) {
            assert!(part.starts_with("one"));
        }
    }

    #[test]
    fn what_has_no_place_on_the_axes_leaves_no_trace() {
        let mut figure = figure();
        figure.add(Mark::line(vec![(0.0, 1.0), (f64::NAN, 2.0)], GREEN).label("nowhere"));
        figure.add(Mark::point(-1.0, 5.0, GREEN, Shape::Square));
        let text = figure.file();
        assert!(!text.contains("NaN") && !text.contains("inf"));
    }

    #[test]
    fn a_hundred_thousand_points_become_few() {
        let points =
            (0..100_000).map(|i| (f64::from(i), 50.0 + 50.0 * libm::sin(f64::from(i) * 1e-4))).collect();
        let mut figure = Figure::new("", "", Axis::linear("x", 0.0, 1e5), Axis::percent("y"));
        figure.add(Mark::line(points, BLUE));
        assert!(figure.file().len() < 20_000);
    }

    proptest::proptest! {
        #![proptest_config(proptest::prelude::ProptestConfig::with_cases(60))]
        /// Draws names of any length and number on figures of any size: beside the frame, above it and as
        /// ticks.
        #[test]
        fn no_name_and_no_size_is_too_much(
            names in proptest::collection::vec("(?s).{0,120}", 0..12),
            width in 0.0f64..800.0,
            height in 0.0f64..500.0,
            above in proptest::bool::ANY,
            square in proptest::bool::ANY,
            low in -1e3f64..1e3,
        ) {
            let label = names.join(" ");
            let mut figure =
                Figure::new(&label, "", Axis::linear(&label, 0.0, 9.0), Axis::rows(names.clone()));
            for (row, name) in names.iter().enumerate() {
                let at = row as f64;
                let interval = Some((low, low + 5.0));
                figure.add(Mark::line(vec![(at, low), (at + 1.0, at)], BLUE).label(name));
                let point = Mark::point(at, at, BLACK, Shape::Circle).label(name);
                figure.add(point.x_interval(interval).y_interval(interval));
                figure.add(Mark::rule(Across::X, at, GREY).label(name));
                figure.add(Mark::area(vec![(at, 0.0), (low, at), (at, at)], GREEN, 0.2).label(name));
            }
            let mut figure = figure.sizes((width, height), (width, height));
            if above {
                figure = figure.names_above();
            }
            if square {
                figure = figure.square();
            }
            for text in [figure.file(), figure.inline("n", Size::Narrow)] {
                proptest::prop_assert!(!text.contains("NaN") && !text.contains("inf "));
            }
        }
    }
}
