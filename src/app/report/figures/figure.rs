//! Figure: axes, and the marks between them, in colours that colour-blind readers can distinguish.

use super::axis::Axis;

/// Size of a figure; text is equally large in all sizes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Size {
    /// For a page or a file: 720 pixels wide unless the figure says otherwise.
    Wide,
    /// For a telephone: 358 pixels wide unless the figure says otherwise.
    Narrow,
    /// For the first printed sheet, beside a table; the size of a page unless the figure says otherwise.
    Sheet,
}

/// Axes and the marks between them.
#[derive(Clone, Debug, PartialEq)]
pub struct Figure {
    pub(super) title: String,
    pub(super) description: String,
    pub(super) heading: String,
    pub(super) x: Axis,
    pub(super) y: Axis,
    pub(super) marks: Vec<Mark>,
    /// True if all names are above the frame; otherwise each is beside its curve if there is room.
    pub(super) names_above: bool,
    pub(super) square: bool,
    pub(super) sieves: bool,
    pub(super) wide: (f64, f64),
    pub(super) narrow: (f64, f64),
    pub(super) sheet: Option<(f64, f64)>,
}

impl Figure {
    /// Empty figure. `title` and `description` are for readers who cannot see it; `heading`, which may be
    /// empty, is drawn above the frame.
    pub fn new(title: &str, description: &str, heading: &str, x: Axis, y: Axis) -> Figure {
        Figure {
            title: title.to_owned(),
            description: description.to_owned(),
            heading: heading.to_owned(),
            x,
            y,
            marks: Vec::new(),
            names_above: false,
            square: false,
            sieves: false,
            wide: (720.0, 440.0),
            narrow: (358.0, 380.0),
            sheet: None,
        }
    }

    /// Sets other widths and heights in pixels.
    pub(crate) fn sizes(mut self, wide: (f64, f64), narrow: (f64, f64)) -> Figure {
        (self.wide, self.narrow) = (wide, narrow);
        self
    }

    /// Sets width and height in pixels on the first printed sheet, beside a table.
    pub(crate) fn sheet(mut self, size: (f64, f64)) -> Figure {
        self.sheet = Some(size);
        self
    }

    /// True if it has a size of its own on the first printed sheet.
    pub(crate) fn has_sheet(&self) -> bool {
        self.sheet.is_some()
    }

    /// Makes the frame a square, as large as possible: equal axes then have equal scales.
    pub(crate) fn square(mut self) -> Figure {
        self.square = true;
        self
    }

    /// Adds US sieve numbers and the limits of fines, sand and gravel above the frame: x is a size in mm.
    pub(crate) fn sieves(mut self) -> Figure {
        self.sieves = true;
        self
    }

    pub fn names_above(mut self) -> Figure {
        self.names_above = true;
        self
    }

    /// Draws a mark on top of the existing ones.
    pub fn add(&mut self, mark: impl Into<Mark>) {
        self.marks.push(mark.into());
    }

    /// Draws symbols of one kind; the first carries the name of all.
    pub(crate) fn add_points(&mut self, name: &str, points: impl IntoIterator<Item = Point>) {
        for (index, point) in points.into_iter().enumerate() {
            self.add(if index == 0 { point.label(name) } else { point });
        }
    }

    /// True if it is taller than wide, so that it needs a printed page for itself.
    pub(crate) fn is_tall(&self) -> bool {
        self.wide.1 > 1.1 * self.wide.0
    }
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Dash {
    Solid,
    Dashed,
    Dotted,
}

/// Line through points.
#[derive(Clone, Debug, PartialEq)]
pub struct Line {
    pub(super) points: Vec<(f64, f64)>,
    pub(super) colour: Colour,
    pub(super) width: f64,
    pub(super) dash: Dash,
    pub(super) opacity: f64,
    pub(super) stays: bool,
    pub(super) label: Option<String>,
}

impl Line {
    /// Solid line, 2 pixels wide.
    pub fn new(points: Vec<(f64, f64)>, colour: Colour) -> Line {
        let (width, dash, opacity) = (2.0, Dash::Solid, 1.0);
        Line { points, colour, width, dash, opacity, stays: false, label: None }
    }

    /// Solid line through rows of records: x, y.
    pub(crate) fn of_rows(rows: &[[f64; 2]], colour: Colour) -> Line {
        Line::new(rows.iter().map(|&[x, y]| (x, y)).collect(), colour)
    }

    /// Sets the width in pixels.
    pub(crate) fn width(mut self, width: f64) -> Line {
        self.width = width;
        self
    }

    pub fn dash(mut self, dash: Dash) -> Line {
        self.dash = dash;
        self
    }

    /// Sets the opacity: 1 is opaque.
    pub(crate) fn opacity(mut self, opacity: f64) -> Line {
        self.opacity = opacity;
        self
    }

    /// Marks the line as a limit, which a reader of a page cannot hide.
    pub(crate) fn stays(mut self) -> Line {
        self.stays = true;
        self
    }
}

#[derive(Clone, Debug, PartialEq)]
pub struct Area {
    pub(super) outline: Vec<(f64, f64)>,
    pub(super) colour: Colour,
    pub(super) opacity: f64,
    pub(super) label: Option<String>,
}

impl Area {
    pub(crate) fn new(outline: Vec<(f64, f64)>, colour: Colour, opacity: f64) -> Area {
        Area { outline, colour, opacity, label: None }
    }
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Shape {
    Circle,
    Square,
    Diamond,
    Triangle,
}

/// Symbol with optional error bars and an optional name.
#[derive(Clone, Debug, PartialEq)]
pub struct Point {
    pub(super) at: (f64, f64),
    pub(super) colour: Colour,
    pub(super) shape: Shape,
    pub(super) filled: bool,
    pub(super) x_interval: Option<(f64, f64)>,
    pub(super) y_interval: Option<(f64, f64)>,
    pub(super) drop: bool,
    pub(super) label: Option<String>,
}

impl Point {
    pub fn new(x: f64, y: f64, colour: Colour, shape: Shape) -> Point {
        let (x_interval, y_interval) = (None, None);
        Point { at: (x, y), colour, shape, filled: true, x_interval, y_interval, drop: false, label: None }
    }

    pub(crate) fn hollow(mut self) -> Point {
        self.filled = false;
        self
    }

    /// Adds a bar along x from low to high.
    pub(crate) fn x_interval(mut self, interval: Option<(f64, f64)>) -> Point {
        self.x_interval = interval;
        self
    }

    /// Adds a bar along y from low to high.
    pub(crate) fn y_interval(mut self, interval: Option<(f64, f64)>) -> Point {
        self.y_interval = interval;
        self
    }

    /// Adds a dotted line down to the x axis, where its value can be read.
    pub(crate) fn dropped(mut self) -> Point {
        self.drop = true;
        self
    }
}

/// Axis that a [`Rule`] crosses.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Across {
    /// At one x, vertical.
    X,
    /// At one y, horizontal.
    Y,
}

/// Straight line at one value, from edge to edge.
#[derive(Clone, Debug, PartialEq)]
pub struct Rule {
    pub(super) across: Across,
    pub(super) at: f64,
    pub(super) colour: Colour,
    pub(super) dash: Dash,
    pub(super) label: Option<String>,
}

impl Rule {
    pub(crate) fn new(across: Across, at: f64, colour: Colour) -> Rule {
        Rule { across, at, colour, dash: Dash::Solid, label: None }
    }

    pub(crate) fn dash(mut self, dash: Dash) -> Rule {
        self.dash = dash;
        self
    }
}

/// Circle to scale; its diameter is a length on the x axis.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Disc {
    pub(crate) centre: (f64, f64),
    pub(crate) diameter: f64,
    pub(crate) colour: Colour,
}

/// Mark that is drawn between the axes.
#[derive(Clone, Debug, PartialEq)]
pub enum Mark {
    Line(Line),
    Area(Area),
    Point(Point),
    Rule(Rule),
    Disc(Disc),
}

macro_rules! marks {
    ($($kind:ident),*) => { $(
        impl From<$kind> for Mark {
            fn from(mark: $kind) -> Mark {
                Mark::$kind(mark)
            }
        }
    )* };
}
marks!(Line, Area, Point, Rule, Disc);

macro_rules! labels {
    ($($kind:ident),*) => { $(
        impl $kind {
            /// Sets the name, which an area has at its upper edge.
            pub fn label(mut self, label: &str) -> $kind {
                self.label = Some(label.to_owned());
                self
            }
        }
    )* };
}
labels!(Line, Area, Point, Rule);

/// Colour for lines, and a darker one for text that names them on white.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Colour {
    /// For lines, areas and symbols.
    pub(crate) line: &'static str,
    /// For text, with a contrast of at least 4.5 on white.
    pub(crate) text: &'static str,
}

// Colours by Okabe and Ito.
pub(crate) const BLACK: Colour = Colour { line: "#000000", text: "#000000" };
pub const BLUE: Colour = Colour { line: "#0072B2", text: "#00598C" };
pub const GREEN: Colour = Colour { line: "#009E73", text: "#00684C" };
pub(crate) const ORANGE: Colour = Colour { line: "#E69F00", text: "#855C00" };
pub const VERMILLION: Colour = Colour { line: "#D55E00", text: "#A34700" };
pub(crate) const PURPLE: Colour = Colour { line: "#CC79A7", text: "#8E3F6C" };
pub(crate) const GREY: Colour = Colour { line: "#767676", text: "#555555" };

/// Colour from a ramp of light to dark blue, for ordered curves.
pub(crate) fn ramp(index: usize, count: usize) -> Colour {
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn curves_in_an_order_get_darker() {
        assert_eq!(ramp(0, 2).line, "#8CC5E3");
        assert_eq!(ramp(1, 2).line, "#052D49");
        assert_eq!(ramp(0, 1).line, "#11679E");
    }
}
