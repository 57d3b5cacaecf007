//! A figure: axes, and the marks between them.

use super::axis::Axis;
use super::marks::{Mark, Point};

/// Room for a figure. Text has the same size in both.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Size {
    /// For a page or a file: 720 pixels wide unless the figure says otherwise.
    Wide,
    /// For a telephone: 358 pixels wide unless the figure says otherwise.
    Narrow,
    /// For the first printed sheet, beside a table; as for a page unless the figure says otherwise.
    Sheet,
}

/// Placement of the names of curves.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Naming {
    /// Each name beside its curve; names without room go above the frame.
    Direct,
    /// All names above the frame.
    Above,
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
    pub(super) naming: Naming,
    pub(super) square: bool,
    pub(super) sieves: bool,
    pub(super) wide: (f64, f64),
    pub(super) narrow: (f64, f64),
    pub(super) sheet: Option<(f64, f64)>,
}

impl Figure {
    /// An empty figure. `title` and `description` are for readers who do not see it, `heading` (may be empty)
    /// is drawn above the frame.
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
            sieves: false,
            wide: (720.0, 440.0),
            narrow: (358.0, 380.0),
            sheet: None,
        }
    }

    /// Sets other widths and heights in pixels.
    pub fn sizes(mut self, wide: (f64, f64), narrow: (f64, f64)) -> Figure {
        (self.wide, self.narrow) = (wide, narrow);
        self
    }

    /// Sets width and height in pixels on the first printed sheet, beside a table.
    pub fn sheet(mut self, size: (f64, f64)) -> Figure {
        self.sheet = Some(size);
        self
    }

    /// Tells if it has a size of its own on the first printed sheet.
    pub fn has_sheet(&self) -> bool {
        self.sheet.is_some()
    }

    /// Makes the frame a square, as large as there is room for: equal axes then have equal scales.
    pub fn square(mut self) -> Figure {
        self.square = true;
        self
    }

    /// Adds US sieve numbers and the limits of fines, sand and gravel above the frame: x is a size in mm.
    pub fn sieves(mut self) -> Figure {
        self.sieves = true;
        self
    }

    /// Puts all names above the frame.
    pub fn names_above(mut self) -> Figure {
        self.naming = Naming::Above;
        self
    }

    /// Draws a mark over those that are there.
    pub fn add(&mut self, mark: impl Into<Mark>) {
        self.marks.push(mark.into());
    }

    /// Draws symbols of one kind; the first carries the name of all.
    pub fn add_points(&mut self, name: &str, points: impl IntoIterator<Item = Point>) {
        for (index, point) in points.into_iter().enumerate() {
            self.add(if index == 0 { point.label(name) } else { point });
        }
    }

    /// Tells if it is higher than wide, so that it needs a printed page for itself.
    pub fn is_tall(&self) -> bool {
        self.wide.1 > 1.1 * self.wide.0
    }
}
