//! Figures: axes, lines, areas, points and rules, drawn as SVG.
//!
//! A [`Figure`] says what is shown; [`Figure::file`] and [`Figure::inline`] draw it. It is written for what
//! a geotechnical engineer expects (semi-logarithmic paper with its minor lines, depth downward, a name beside
//! each curve) and for pages that forbid everything but themselves: only presentation attributes, no script, no style
//! element, no font or image from elsewhere. Colours are those of Okabe and Ito, which colour-blind readers tell apart,
//! and never the only difference between two curves: dashes, widths and symbols differ as well.
//!
//! ```
//! use voidwalk::report::figures::{Axis, BLUE, Figure, Line, Size};
//! let mut figure = Figure::new("Base soil", "Percent finer by mass against size", "",
//!     Axis::log("Size (mm)", 0.1, 2.0), Axis::percent("Percent finer by mass (%)"));
//! figure.add(Line::new(vec![(0.1, 0.0), (2.0, 100.0)], BLUE).label("base"));
//! assert!(figure.file().contains(">base</text>"));
//! assert!(figure.inline("base", Size::Narrow).starts_with("<svg"));
//! ```

mod axis;
mod draw;
mod path;
mod place;
mod svg;

pub use axis::{Axis, Scale, Tick};
pub use svg::{escape, shorten, visible};

/// A colour for lines, and a darker one for text that names them on white.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Colour {
    /// For lines, areas and symbols.
    pub line: &'static str,
    /// For text, with a contrast of at least 4.5 on white.
    pub text: &'static str,
}

/// Black.
pub const BLACK: Colour = Colour { line: "#000000", text: "#000000" };
/// Blue of Okabe and Ito.
pub const BLUE: Colour = Colour { line: "#0072B2", text: "#00598C" };
/// Bluish green of Okabe and Ito.
pub const GREEN: Colour = Colour { line: "#009E73", text: "#00684C" };
/// Orange of Okabe and Ito.
pub const ORANGE: Colour = Colour { line: "#E69F00", text: "#855C00" };
/// Vermillion of Okabe and Ito.
pub const VERMILLION: Colour = Colour { line: "#D55E00", text: "#A34700" };
/// Reddish purple of Okabe and Ito.
pub const PURPLE: Colour = Colour { line: "#CC79A7", text: "#8E3F6C" };
/// Grey, for what stands behind.
pub const GREY: Colour = Colour { line: "#767676", text: "#555555" };

/// A ramp from light to dark blue, for curves in an order.
pub fn ramp(index: usize, count: usize) -> Colour {
    const BLUES: [Colour; 6] = [
        Colour { line: "#8CC5E3", text: "#1F6F9C" },
        Colour { line: "#5BA7D1", text: "#1F6F9C" },
        Colour { line: "#2E86BC", text: "#1B6799" },
        Colour { line: "#11679E", text: "#11679E" },
        Colour { line: "#0A4B77", text: "#0A4B77" },
        Colour { line: "#052D49", text: "#052D49" },
    ];
    if count < 2 {
        return BLUES[3];
    }
    BLUES[(index * (BLUES.len() - 1) / (count - 1)).min(BLUES.len() - 1)]
}

/// Room for a figure. Text has the same size in both.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Size {
    /// For a page or a file: 720 pixels wide unless the figure says otherwise.
    Wide,
    /// For a telephone: 358 pixels wide unless the figure says otherwise.
    Narrow,
}

/// How a line is broken.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Dash {
    /// Not at all.
    Solid,
    /// In dashes.
    Dashed,
    /// In dots.
    Dotted,
}

/// A line through points.
#[derive(Clone, Debug, PartialEq)]
pub struct Line {
    points: Vec<(f64, f64)>,
    colour: Colour,
    width: f64,
    dash: Dash,
    opacity: f64,
    label: Option<String>,
}

impl Line {
    /// A solid line, 2 pixels wide.
    pub fn new(points: Vec<(f64, f64)>, colour: Colour) -> Line {
        Line { points, colour, width: 2.0, dash: Dash::Solid, opacity: 1.0, label: None }
    }

    /// Another width in pixels.
    pub fn width(mut self, width: f64) -> Line {
        self.width = width;
        self
    }

    /// Broken.
    pub fn dash(mut self, dash: Dash) -> Line {
        self.dash = dash;
        self
    }

    /// See-through: 1 is opaque.
    pub fn opacity(mut self, opacity: f64) -> Line {
        self.opacity = opacity;
        self
    }

    /// With a name.
    pub fn label(mut self, label: &str) -> Line {
        self.label = Some(label.to_owned());
        self
    }
}

/// A filled area.
#[derive(Clone, Debug, PartialEq)]
pub struct Area {
    outline: Vec<(f64, f64)>,
    colour: Colour,
    opacity: f64,
    label: Option<String>,
}

impl Area {
    /// The area inside an outline.
    pub fn new(outline: Vec<(f64, f64)>, colour: Colour, opacity: f64) -> Area {
        Area { outline, colour, opacity, label: None }
    }

    /// With a name, at its upper edge.
    pub fn label(mut self, label: &str) -> Area {
        self.label = Some(label.to_owned());
        self
    }
}

/// The form of a symbol.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Shape {
    /// A circle.
    Circle,
    /// A square.
    Square,
    /// A square on its corner.
    Diamond,
    /// A triangle.
    Triangle,
}

/// A symbol, with error bars and a name if wanted.
#[derive(Clone, Debug, PartialEq)]
pub struct Point {
    at: (f64, f64),
    colour: Colour,
    shape: Shape,
    filled: bool,
    x_interval: Option<(f64, f64)>,
    y_interval: Option<(f64, f64)>,
    drop: bool,
    label: Option<String>,
}

impl Point {
    /// A filled symbol.
    pub fn new(x: f64, y: f64, colour: Colour, shape: Shape) -> Point {
        let (x_interval, y_interval) = (None, None);
        Point { at: (x, y), colour, shape, filled: true, x_interval, y_interval, drop: false, label: None }
    }

    /// Hollow.
    pub fn hollow(mut self) -> Point {
        self.filled = false;
        self
    }

    /// With a bar along x from low to high.
    pub fn x_interval(mut self, interval: Option<(f64, f64)>) -> Point {
        self.x_interval = interval;
        self
    }

    /// With a bar along y from low to high.
    pub fn y_interval(mut self, interval: Option<(f64, f64)>) -> Point {
        self.y_interval = interval;
        self
    }

    /// With a dotted line down to the x axis, where its value is read.
    pub fn dropped(mut self) -> Point {
        self.drop = true;
        self
    }

    /// With a name.
    pub fn label(mut self, label: &str) -> Point {
        self.label = Some(label.to_owned());
        self
    }
}

/// Across which axis a [`Rule`] stands.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Across {
    /// At one x, vertical.
    X,
    /// At one y, horizontal.
    Y,
}

/// A straight line at one value, from edge to edge.
#[derive(Clone, Debug, PartialEq)]
pub struct Rule {
    across: Across,
    at: f64,
    colour: Colour,
    dash: Dash,
    label: Option<String>,
}

impl Rule {
    /// A solid line.
    pub fn new(across: Across, at: f64, colour: Colour) -> Rule {
        Rule { across, at, colour, dash: Dash::Solid, label: None }
    }

    /// Broken.
    pub fn dash(mut self, dash: Dash) -> Rule {
        self.dash = dash;
        self
    }

    /// With a name.
    pub fn label(mut self, label: &str) -> Rule {
        self.label = Some(label.to_owned());
        self
    }
}

/// A circle to scale; its diameter is a length on the x axis.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Disc {
    centre: (f64, f64),
    diameter: f64,
    colour: Colour,
}

impl Disc {
    /// A filled circle.
    pub fn new(centre: (f64, f64), diameter: f64, colour: Colour) -> Disc {
        Disc { centre, diameter, colour }
    }
}

/// Anything that is drawn between the axes.
#[derive(Clone, Debug, PartialEq)]
pub enum Mark {
    /// See [`Line`].
    Line(Line),
    /// See [`Area`].
    Area(Area),
    /// See [`Point`].
    Point(Point),
    /// See [`Rule`].
    Rule(Rule),
    /// See [`Disc`].
    Disc(Disc),
}

impl From<Disc> for Mark {
    fn from(disc: Disc) -> Mark {
        Mark::Disc(disc)
    }
}

impl From<Line> for Mark {
    fn from(line: Line) -> Mark {
        Mark::Line(line)
    }
}

impl From<Area> for Mark {
    fn from(area: Area) -> Mark {
        Mark::Area(area)
    }
}

impl From<Point> for Mark {
    fn from(point: Point) -> Mark {
        Mark::Point(point)
    }
}

impl From<Rule> for Mark {
    fn from(rule: Rule) -> Mark {
        Mark::Rule(rule)
    }
}

/// How curves get their names.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Naming {
    /// Each beside its curve; names that find no room go above the frame.
    Direct,
    /// All above the frame.
    Above,
}

/// Axes and what stands between them.
#[derive(Clone, Debug, PartialEq)]
pub struct Figure {
    title: String,
    description: String,
    heading: String,
    x: Axis,
    y: Axis,
    marks: Vec<Mark>,
    naming: Naming,
    square: bool,
    wide: (f64, f64),
    narrow: (f64, f64),
}

impl Figure {
    /// An empty figure. `title` and `description` are for readers who do not see it, `heading` (may be empty) is drawn
    /// above the frame.
    pub fn new(title: &str, description: &str, heading: &str, x: Axis, y: Axis) -> Figure {
        Figure {
            title: title.to_owned(),
            description: description.to_owned(),
            heading: heading.to_owned(),
            x,
            y,
            marks: Vec::new(),
            naming: Naming::Direct,
            square: false,
            wide: (720.0, 440.0),
            narrow: (358.0, 380.0),
        }
    }

    /// Other widths and heights in pixels.
    pub fn sizes(mut self, wide: (f64, f64), narrow: (f64, f64)) -> Figure {
        (self.wide, self.narrow) = (wide, narrow);
        self
    }

    /// A square frame, as large as there is room for: equal axes then have equal scales.
    pub fn square(mut self) -> Figure {
        self.square = true;
        self
    }

    /// All names above the frame.
    pub fn names_above(mut self) -> Figure {
        self.naming = Naming::Above;
        self
    }

    /// Draws something over what is there.
    pub fn add(&mut self, mark: impl Into<Mark>) {
        self.marks.push(mark.into());
    }

    /// Its title.
    pub fn title(&self) -> &str {
        &self.title
    }

    /// A file of its own.
    pub fn file(&self) -> String {
        let body = draw::draw(self, Size::Wide, "figure", r#" xmlns="http://www.w3.org/2000/svg""#);
        format!("<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n{body}")
    }

    /// An element of a page; `id` must be unlike that of any other element there.
    pub fn inline(&self, id: &str, size: Size) -> String {
        draw::draw(self, size, id, "")
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn figure() -> Figure {
        let x = Axis::log("Size (mm)", 0.1, 10.0);
        let mut figure = Figure::new("A <b>", "of \"two\" & more", "", x, Axis::percent("Finer (%)"));
        figure.add(
            Line::new(vec![(0.1, 0.0), (1.0, 50.0), (10.0, 100.0)], BLUE).label("<script>alert(1)</script>"),
        );
        figure.add(Point::new(1.0, 50.0, BLACK, Shape::Circle).dropped().label("D50 = 1 mm"));
        figure.add(Rule::new(Across::Y, 85.0, GREY).dash(Dash::Dashed).label("85 %"));
        figure.add(Area::new(vec![(0.1, 0.0), (1.0, 10.0), (1.0, 0.0)], GREEN, 0.2));
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
        figure.add(Line::new(vec![(0.0, 1.0), (f64::NAN, 2.0)], GREEN).label("nowhere"));
        figure.add(Point::new(-1.0, 5.0, GREEN, Shape::Square));
        let text = figure.file();
        assert!(!text.contains("NaN") && !text.contains("inf"));
    }

    #[test]
    fn a_hundred_thousand_points_become_few() {
        let points =
            (0..100_000).map(|i| (f64::from(i), 50.0 + 50.0 * libm::sin(f64::from(i) * 1e-4))).collect();
        let mut figure = Figure::new("", "", "", Axis::linear("x", 0.0, 1e5), Axis::percent("y"));
        figure.add(Line::new(points, BLUE));
        assert!(figure.file().len() < 20_000);
    }

    #[test]
    fn curves_in_an_order_get_darker() {
        assert_eq!(ramp(0, 2).line, "#8CC5E3");
        assert_eq!(ramp(1, 2).line, "#052D49");
        assert_eq!(ramp(0, 1).line, "#11679E");
    }
}
