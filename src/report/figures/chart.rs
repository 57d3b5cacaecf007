//! A figure of rows, told by roles: what of a row stands along x and along y, which rows are a series, and
//! how each looks.
//!
//! ```
//! use voidwalk::report::figures::{BLUE, Chart, SeriesLook, Role, Shape};
//! let rows = [("counts", 1.0, 0.5), ("counts", 4.0, 0.25)];
//! let x = Role::log("Processor time (s)", |row: &(&str, f64, f64)| row.1);
//! let y = Role::log("Error (–)", |row: &(&str, f64, f64)| row.2);
//! let chart = Chart::of(&rows, ["Error", "Error against time"], x, y)
//!     .by(|row| [row.0], |_| SeriesLook::line(BLUE, Shape::Circle))
//!     .power((1.0, 0.5), -0.5, "slope −1/2");
//! assert!(chart.figure().file().contains(">counts</text>"));
//! ```

use super::axis::{Axis, positive_range};
use super::colour::{Colour, GREY};
use super::figure::Figure;
use super::marks::{Dash, Line, Mark, Point, Shape};

/// The ends of the interval of a row's value.
type Ends<'a, T> = Box<dyn Fn(&T) -> Option<(f64, f64)> + 'a>;

/// What of a row stands along an axis.
pub struct Role<'a, T> {
    label: String,
    is_log: bool,
    value: Box<dyn Fn(&T) -> f64 + 'a>,
    interval: Ends<'a, T>,
    also: Vec<f64>,
}

impl<'a, T> Role<'a, T> {
    /// A value on a logarithmic axis.
    pub fn log(label: &str, value: impl Fn(&T) -> f64 + 'a) -> Self {
        Self { is_log: true, ..Self::linear(label, value) }
    }

    /// A value on a linear axis.
    pub fn linear(label: &str, value: impl Fn(&T) -> f64 + 'a) -> Self {
        let interval = Box::new(|_: &T| None);
        Self { label: label.to_owned(), is_log: false, value: Box::new(value), interval, also: Vec::new() }
    }

    /// With the ends of its interval, where there is one.
    pub fn interval(self, ends: impl Fn(&T) -> Option<(f64, f64)> + 'a) -> Self {
        Self { interval: Box::new(ends), ..self }
    }

    /// Its axis has room for these values, too.
    pub fn also(mut self, values: impl IntoIterator<Item = f64>) -> Self {
        self.also.extend(values);
        self
    }

    fn axis(&self, rows: &[&T]) -> Axis {
        let values = rows.iter().map(|row| (self.value)(row));
        let ends = rows.iter().filter_map(|row| (self.interval)(row)).flat_map(<[f64; 2]>::from);
        let all = values.chain(ends).chain(self.also.iter().copied());
        let (low, high) = match self.is_log {
            true => positive_range(all),
            false => all.fold((f64::INFINITY, f64::NEG_INFINITY), |(l, h), v| (l.min(v), h.max(v))),
        };
        if self.is_log { Axis::log(&self.label, low, high) } else { Axis::linear(&self.label, low, high) }
    }
}

/// How the symbols of a series look, and the line that joins them.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SeriesLook {
    colour: Colour,
    shape: Shape,
    line: Option<Dash>,
    is_hollow: bool,
}

impl SeriesLook {
    /// Symbols alone.
    pub fn points(colour: Colour, shape: Shape) -> Self {
        Self { colour, shape, line: None, is_hollow: false }
    }

    /// Symbols, joined by a solid line.
    pub fn line(colour: Colour, shape: Shape) -> Self {
        Self { line: Some(Dash::Solid), ..Self::points(colour, shape) }
    }

    /// Joined by a line of this kind.
    pub fn dash(self, dash: Dash) -> Self {
        Self { line: Some(dash), ..self }
    }

    /// With hollow symbols, where they are to be so.
    pub fn hollow(self, is_hollow: bool) -> Self {
        Self { is_hollow, ..self }
    }
}

/// A figure of rows.
pub struct Chart<'a, T> {
    rows: Vec<&'a T>,
    words: [String; 2],
    x: Role<'a, T>,
    y: Role<'a, T>,
    marks: Vec<Mark>,
}

impl<'a, T> Chart<'a, T> {
    /// Rows with a title, a description for readers who do not see the figure, and what stands along each
    /// axis.
    pub fn of(
        rows: impl IntoIterator<Item = &'a T>,
        words: [&str; 2],
        x: Role<'a, T>,
        y: Role<'a, T>,
    ) -> Self {
        Self { rows: rows.into_iter().collect(), words: words.map(String::from), x, y, marks: Vec::new() }
    }

    /// Draws a series of all rows with the same key. The last part of the key is its name, which is written
    /// once; the line looks as the first row does.
    pub fn by<const N: usize>(
        mut self,
        key: impl Fn(&'a T) -> [&'a str; N],
        look: impl Fn(&T) -> SeriesLook,
    ) -> Self {
        let mut series: Vec<([&str; N], Vec<&T>)> = Vec::new();
        for &row in &self.rows {
            match series.iter_mut().find(|(of, _)| *of == key(row)) {
                Some((_, rows)) => rows.push(row),
                None => series.push((key(row), vec![row])),
            }
        }
        let mut named = vec![""];
        for (key, rows) in series {
            let name = key[N - 1];
            let mut label = (!named.contains(&name)).then_some(name);
            named.push(name);
            let SeriesLook { colour, line, .. } = look(rows[0]);
            if let Some(dash) = line {
                let path = rows.iter().map(|row| ((self.x.value)(row), (self.y.value)(row))).collect();
                let line = Line::new(path, colour).width(1.5).dash(dash);
                self.marks.push(label.take().map_or(line.clone(), |name| line.label(name)).into());
            }
            for row in rows {
                let SeriesLook { colour, shape, is_hollow, .. } = look(row);
                let point = Point::new((self.x.value)(row), (self.y.value)(row), colour, shape);
                let point = point.x_interval((self.x.interval)(row)).y_interval((self.y.interval)(row));
                let point = if is_hollow { point.hollow() } else { point };
                self.marks.push(label.take().map_or(point.clone(), |name| point.label(name)).into());
            }
        }
        self
    }

    /// Draws a dashed power law through a point, over the positive values of x.
    pub fn power(self, through: (f64, f64), exponent: f64, name: &str) -> Self {
        self.power_in(GREY, through, exponent, name)
    }

    /// Draws a dashed power law of this colour.
    pub fn power_in(self, colour: Colour, through: (f64, f64), exponent: f64, name: &str) -> Self {
        let (low, high) = positive_range(self.rows.iter().map(|row| (self.x.value)(row)));
        let at = |x: f64| (x, through.1 * libm::pow(x / through.0, exponent));
        self.mark(Line::new(vec![at(low), at(high)], colour).width(1.5).dash(Dash::Dashed).label(name))
    }

    /// Draws something over what is there.
    pub fn mark(mut self, mark: impl Into<Mark>) -> Self {
        self.marks.push(mark.into());
        self
    }

    /// The figure, with axes that have room for every row.
    pub fn figure(self) -> Figure {
        let [title, what] = &self.words;
        let axes = [&self.x, &self.y].map(|role| role.axis(&self.rows));
        let [x, y] = axes;
        let mut figure = Figure::new(title, what, "", x, y);
        self.marks.into_iter().for_each(|mark| figure.add(mark));
        figure
    }
}
