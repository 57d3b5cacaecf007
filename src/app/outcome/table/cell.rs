//! Cells of a table: the value that a file holds, and the text that a page shows.

use std::fmt::{self, Display, Formatter};

use crate::outcome::record::{Statistic, Verdict};
use crate::outcome::statistic::percent_interval;
use voidwalk_practice::quantity::{Quantity, percent, significant, whole};

/// Content of a cell of a file.
#[derive(Clone, Debug, PartialEq)]
pub enum CellValue {
    /// Nothing.
    Empty,
    /// Words.
    Words(String),
    /// A number.
    Number(f64),
    /// A count.
    Count(u64),
    /// Yes or no.
    Truth(bool),
}

impl Display for CellValue {
    fn fmt(&self, f: &mut Formatter<'_>) -> fmt::Result {
        match self {
            Self::Empty => Ok(()),
            Self::Words(words) => f.write_str(words),
            Self::Number(number) => number.fmt(f),
            Self::Count(count) => count.fmt(f),
            Self::Truth(truth) => truth.fmt(f),
        }
    }
}

/// A cell or a heading of a page.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Shown {
    /// Text of the cell.
    pub text: String,
    /// Smaller lines below the text.
    pub below: Vec<String>,
    /// Emphasis of the text.
    pub emphasis: Option<Emphasis>,
}

/// Emphasis of the text of a cell.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Emphasis {
    /// Colour of a doubt.
    Doubt,
    /// A tick if kept, or a cross if not.
    Kept(bool),
    /// Colour of a run, by its number.
    Run(u64),
    /// No word is broken.
    Whole,
}

impl Shown {
    /// Adds a smaller line at its end, if there is one.
    pub fn below(mut self, line: impl Into<Option<String>>) -> Self {
        self.below.extend(line.into());
        self
    }

    /// Puts the cell into one line.
    pub fn line(self) -> String {
        [&[self.text], &self.below[..]].concat().join("; ")
    }

    /// Emphasises the text, if an emphasis is given.
    pub fn emphasised(self, emphasis: impl Into<Option<Emphasis>>) -> Self {
        Self { emphasis: emphasis.into(), ..self }
    }
}

/// Content of a cell: without a value empty in a file and a dash on a page.
pub trait TableCell {
    /// In a file.
    fn value(self) -> CellValue;

    /// On a page.
    fn shown(self) -> Shown;
}

impl<C: TableCell> TableCell for Option<C> {
    fn value(self) -> CellValue {
        self.map_or(CellValue::Empty, C::value)
    }

    fn shown(self) -> Shown {
        self.map_or_else(|| "–".shown(), C::shown)
    }
}

impl TableCell for Verdict {
    fn value(self) -> CellValue {
        self.words().value()
    }

    fn shown(self) -> Shown {
        self.words().shown()
    }
}

/// A fraction in percent, on a page with its interval below it.
impl TableCell for Statistic {
    fn value(self) -> CellValue {
        in_percent(Some(self.mean)).value()
    }

    fn shown(self) -> Shown {
        percent(self.mean).shown().below(percent_interval(&self).map(|span| span.to_string()))
    }
}

impl TableCell for Quantity {
    fn value(self) -> CellValue {
        self.number().value()
    }

    fn shown(self) -> Shown {
        Shown { text: self.to_string(), ..Shown::default() }
    }
}

impl TableCell for Shown {
    fn value(self) -> CellValue {
        self.text.value()
    }

    fn shown(self) -> Shown {
        self
    }
}

macro_rules! cells {
    ($($kind:ty: $value:expr, $shown:expr;)*) => {
        $(impl TableCell for $kind {
            fn value(self) -> CellValue {
                $value(self)
            }

            fn shown(self) -> Shown {
                Shown { text: $shown(self).to_string(), ..Shown::default() }
            }
        })*
    };
}

cells! {
    String: CellValue::Words, |text| text;
    &String: |text: &String| CellValue::Words(text.clone()), String::clone;
    &str: |text: &str| CellValue::Words(text.to_owned()), str::to_owned;
    bool: CellValue::Truth, |is: bool| if is { "✓" } else { "✗" }.to_owned();
    u64: CellValue::Count, whole;
    usize: |count| CellValue::Count(count as u64), |count| whole(count as u64);
    f64: CellValue::Number, significant;
}

/// A number with this number of decimals; empty without a number.
pub(super) fn fixed(value: Option<f64>, decimals: usize) -> String {
    value.map_or_else(String::new, |value| format!("{value:.decimals$}"))
}

pub(super) fn in_percent(fraction: Option<f64>) -> String {
    fixed(fraction.map(|fraction| 100.0 * fraction), 4)
}
