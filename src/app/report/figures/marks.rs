//! Marks that are drawn between the axes of a figure.

use super::colour::Colour;

/// Dashes of a line.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Dash {
    /// Unbroken.
    Solid,
    /// Broken into dashes.
    Dashed,
    /// Broken into dots.
    Dotted,
}

/// A line through points.
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
    /// A solid line, 2 pixels wide.
    pub fn new(points: Vec<(f64, f64)>, colour: Colour) -> Line {
        let (width, dash, opacity) = (2.0, Dash::Solid, 1.0);
        Line { points, colour, width, dash, opacity, stays: false, label: None }
    }

    /// A solid line through rows as records hold them: x, y.
    pub fn of_rows(rows: &[[f64; 2]], colour: Colour) -> Line {
        Line::new(rows.iter().map(|&[x, y]| (x, y)).collect(), colour)
    }

    /// Sets the width in pixels.
    pub fn width(mut self, width: f64) -> Line {
        self.width = width;
        self
    }

    /// Sets the dashes.
    pub fn dash(mut self, dash: Dash) -> Line {
        self.dash = dash;
        self
    }

    /// Sets the opacity: 1 is opaque.
    pub fn opacity(mut self, opacity: f64) -> Line {
        self.opacity = opacity;
        self
    }

    /// Marks the line as a limit, which no reader of a page can hide.
    pub fn stays(mut self) -> Line {
        self.stays = true;
        self
    }

    /// Sets the name.
    pub fn label(mut self, label: &str) -> Line {
        self.label = Some(label.to_owned());
        self
    }
}

/// A filled area.
#[derive(Clone, Debug, PartialEq)]
pub struct Area {
    pub(super) outline: Vec<(f64, f64)>,
    pub(super) colour: Colour,
    pub(super) opacity: f64,
    pub(super) label: Option<String>,
}

impl Area {
    /// The area inside an outline.
    pub fn new(outline: Vec<(f64, f64)>, colour: Colour, opacity: f64) -> Area {
        Area { outline, colour, opacity, label: None }
    }

    /// Sets the name, at the upper edge.
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
    /// A filled symbol.
    pub fn new(x: f64, y: f64, colour: Colour, shape: Shape) -> Point {
        let (x_interval, y_interval) = (None, None);
        Point { at: (x, y), colour, shape, filled: true, x_interval, y_interval, drop: false, label: None }
    }

    /// Makes the symbol hollow.
    pub fn hollow(mut self) -> Point {
        self.filled = false;
        self
    }

    /// Adds a bar along x from low to high.
    pub fn x_interval(mut self, interval: Option<(f64, f64)>) -> Point {
        self.x_interval = interval;
        self
    }

    /// Adds a bar along y from low to high.
    pub fn y_interval(mut self, interval: Option<(f64, f64)>) -> Point {
        self.y_interval = interval;
        self
    }

    /// Adds a dotted line down to the x axis, where its value is read.
    pub fn dropped(mut self) -> Point {
        self.drop = true;
        self
    }

    /// Sets the name.
    pub fn label(mut self, label: &str) -> Point {
        self.label = Some(label.to_owned());
        self
    }
}

/// The axis that a [`Rule`] crosses.
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
    pub(super) across: Across,
    pub(super) at: f64,
    pub(super) colour: Colour,
    pub(super) dash: Dash,
    pub(super) label: Option<String>,
}

impl Rule {
    /// A solid line.
    pub fn new(across: Across, at: f64, colour: Colour) -> Rule {
        Rule { across, at, colour, dash: Dash::Solid, label: None }
    }

    /// Sets the dashes.
    pub fn dash(mut self, dash: Dash) -> Rule {
        self.dash = dash;
        self
    }

    /// Sets the name.
    pub fn label(mut self, label: &str) -> Rule {
        self.label = Some(label.to_owned());
        self
    }
}

/// A circle to scale; its diameter is a length on the x axis.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Disc {
    pub(super) centre: (f64, f64),
    pub(super) diameter: f64,
    pub(super) colour: Colour,
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
