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
    pub(super) x: Axis,
    pub(super) y: Axis,
    pub(super) marks: Vec<Mark>,
    /// True if all names are above the frame; otherwise each is beside its curve if there is room.
    pub(super) names_above: bool,
    pub(super) square: bool,
    pub(super) sieves: bool,
    pub(super) wide: (f64, f64),
    pub(super) narrow: (f64, f64),
    pub(crate) sheet: Option<(f64, f64)>,
}

impl Figure {
    /// Empty figure. `title` and `description` are for readers who cannot see it.
    pub fn new(title: &str, description: &str, x: Axis, y: Axis) -> Figure {
        Figure {
            title: title.to_owned(),
            description: description.to_owned(),
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
    pub fn add(&mut self, mark: Mark) {
        self.marks.push(mark);
    }

    /// Draws symbols of one kind; the first carries the name of all.
    pub(crate) fn add_points(&mut self, name: &str, points: impl IntoIterator<Item = Mark>) {
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

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Shape {
    Circle,
    Square,
    Diamond,
    Triangle,
}

/// Axis that a rule crosses.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Across {
    /// At one x, vertical.
    X,
    /// At one y, horizontal.
    Y,
}

/// Mark between the axes. Its drawing ignores properties that its form does not have.
#[derive(Clone, Debug, PartialEq)]
pub struct Mark {
    pub(super) form: Form,
    pub(super) colour: Colour,
    pub(super) label: Option<String>,
    /// Width of a line (pixels).
    pub(super) width: f64,
    pub(super) dash: Dash,
    /// Opacity of a line or an area: 1 is opaque.
    pub(super) opacity: f64,
    /// True for a line that is a limit, which a reader of a page cannot hide.
    pub(super) stays: bool,
    pub(super) filled: bool,
    /// Bars of a point, from low to high.
    pub(super) x_interval: Option<(f64, f64)>,
    pub(super) y_interval: Option<(f64, f64)>,
    /// True for a point with a dotted line down to the x axis, where its value can be read.
    pub(super) drop: bool,
}

#[derive(Clone, Debug, PartialEq)]
pub(super) enum Form {
    Line(Vec<(f64, f64)>),
    /// Area with this outline.
    Area(Vec<(f64, f64)>),
    Point((f64, f64), Shape),
    /// Straight line at one value, from edge to edge.
    Rule(Across, f64),
    /// Circle to scale at its centre; its diameter is a length on the x axis.
    Disc((f64, f64), f64),
}

impl Mark {
    fn new(form: Form, colour: Colour) -> Mark {
        Mark {
            form,
            colour,
            label: None,
            width: 2.0,
            dash: Dash::Solid,
            opacity: 1.0,
            stays: false,
            filled: true,
            x_interval: None,
            y_interval: None,
            drop: false,
        }
    }

    /// Solid line through points, 2 pixels wide.
    pub fn line(points: Vec<(f64, f64)>, colour: Colour) -> Mark {
        Mark::new(Form::Line(points), colour)
    }

    /// Line through rows of records: x, y.
    pub(crate) fn rows(rows: &[[f64; 2]], colour: Colour) -> Mark {
        Mark::line(rows.iter().map(|&[x, y]| (x, y)).collect(), colour)
    }

    pub(crate) fn area(outline: Vec<(f64, f64)>, colour: Colour, opacity: f64) -> Mark {
        Mark::new(Form::Area(outline), colour).opacity(opacity)
    }

    pub fn point(x: f64, y: f64, colour: Colour, shape: Shape) -> Mark {
        Mark::new(Form::Point((x, y), shape), colour)
    }

    pub(crate) fn rule(across: Across, at: f64, colour: Colour) -> Mark {
        Mark::new(Form::Rule(across, at), colour).width(1.5)
    }

    pub(crate) fn disc(centre: (f64, f64), diameter: f64, colour: Colour) -> Mark {
        Mark::new(Form::Disc(centre, diameter), colour)
    }

    /// Sets the name, which an area has at its upper edge.
    pub fn label(self, label: &str) -> Mark {
        Mark { label: Some(label.to_owned()), ..self }
    }

    pub(crate) fn width(self, width: f64) -> Mark {
        Mark { width, ..self }
    }

    pub fn dash(self, dash: Dash) -> Mark {
        Mark { dash, ..self }
    }

    pub(crate) fn opacity(self, opacity: f64) -> Mark {
        Mark { opacity, ..self }
    }

    pub(crate) fn stays(self) -> Mark {
        Mark { stays: true, ..self }
    }

    pub(crate) fn hollow(self) -> Mark {
        Mark { filled: false, ..self }
    }

    pub(crate) fn x_interval(self, x_interval: Option<(f64, f64)>) -> Mark {
        Mark { x_interval, ..self }
    }

    pub(crate) fn y_interval(self, y_interval: Option<(f64, f64)>) -> Mark {
        Mark { y_interval, ..self }
    }

    pub(crate) fn dropped(self) -> Mark {
        Mark { drop: true, ..self }
    }
}

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
