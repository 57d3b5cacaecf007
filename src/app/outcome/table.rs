//! Table described once for its file and for a page: a column has a name in the file, a heading if the
//! page shows it, and one function that takes its cell from a row. A table without a file is described in
//! the same way.
//!
//! [`csv_of()`] writes rows whose fields are the columns of a file. For other rows, [`Columns`] describes
//! each column.

use super::record::{Statistic, Verdict};
use super::statistic::percent_interval;
use serde::Serialize;
use std::fmt::{self, Display, Formatter};
use voidwalk_core::text::all_visible;
use voidwalk_practice::quantity::{Quantity, percent, significant, whole};

/// Reason why writing to memory cannot fail.
const WRITTEN: &str = "memory takes rows of numbers and names";

/// Writes rows as CSV, one column for each field of their type; the header is present even without rows.
pub(crate) fn csv_of<T: Serialize + Default>(rows: &[T]) -> Vec<u8> {
    let fields = serde_json::to_value(T::default()).expect(WRITTEN);
    let mut writer = csv::WriterBuilder::new().has_headers(false).from_writer(Vec::new());
    writer.write_record(fields.as_object().into_iter().flatten().map(|(name, _)| name)).expect(WRITTEN);
    rows.iter().for_each(|row| writer.serialize(row).expect(WRITTEN));
    written(writer)
}

/// Returns a table whose names hold no hidden characters.
fn written(writer: csv::Writer<Vec<u8>>) -> Vec<u8> {
    let text = String::from_utf8(writer.into_inner().expect(WRITTEN)).expect(WRITTEN);
    all_visible(&text).into_bytes()
}

pub(crate) struct Columns<'a, T>(Vec<Column<'a, T>>);

/// Function that takes the cell of a column from a row.
type OfRow<'a, T, C> = Box<dyn Fn(&T) -> C + 'a>;

/// Column of a file and of a page that shows it.
struct Column<'a, T> {
    /// Name in a file.
    name: String,
    cell: OfRow<'a, T, CellValue>,
    /// Heading in a workbook, if neither the page nor the name gives one.
    heading: Option<&'static str>,
    page: Option<PageColumn<'a, T>>,
    /// Position on the page: a column comes before those with a greater number.
    place: i8,
    /// True if a brief page hides the column.
    is_detail: bool,
}

/// Column as a page shows it.
pub(crate) struct PageColumn<'a, T> {
    /// Name of the column in a file.
    pub(crate) name: String,
    /// Quantity of the column with its unit.
    pub(crate) heading: Shown,
    /// Kind of the cells.
    pub(crate) kind: ColumnKind,
    /// Returns the cell of a row.
    pub(crate) cell: OfRow<'a, T, Shown>,
}

/// Kind of the cells of a column.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum ColumnKind {
    Name,
    Text,
    /// Numbers, aligned right.
    Number,
}

impl<T> Default for Columns<'_, T> {
    fn default() -> Self {
        Self(Vec::new())
    }
}

impl<'a, T> Columns<'a, T> {
    /// Adds a column of a file; a page shows it if [`Self::page_number()`] or [`Self::page_text()`] follows.
    pub(crate) fn column<C: TableCell>(
        mut self,
        name: impl Into<String>,
        cell: impl Fn(&T) -> C + 'a,
    ) -> Self {
        let (name, cell) = (name.into(), Box::new(move |row: &T| cell(row).value()));
        self.0.push(Column { name, cell, heading: None, page: None, place: 0, is_detail: false });
        self
    }

    /// Adds a column of numbers of a file, with this number of decimals.
    pub(crate) fn digits(self, name: &str, decimals: usize, value: impl Fn(&T) -> Option<f64> + 'a) -> Self {
        self.column(name, move |row| fixed(value(row), decimals))
    }

    /// Adds a column of fractions in percent of a file.
    pub(crate) fn percent(self, name: &str, value: impl Fn(&T) -> Option<f64> + 'a) -> Self {
        self.column(name, move |row| in_percent(value(row)))
    }

    /// Adds columns of a file for a fraction in percent and its interval; a page shows them as one column.
    pub(crate) fn statistic(
        self,
        [mean, low, high]: [&str; 3],
        value: impl Fn(&T) -> Option<Statistic> + Clone + 'a,
    ) -> Self {
        let [of_mean, of_low] = [value.clone(), value.clone()];
        self.percent(mean, move |row| Some(of_mean(row)?.mean))
            .percent(low, move |row| of_low(row)?.low)
            .percent(high, move |row| value(row)?.high)
    }

    /// Adds a column of row names, which a page shows under this heading.
    pub(crate) fn name<C: TableCell>(
        self,
        name: impl Into<String>,
        heading: impl TableCell,
        cell: impl Fn(&T) -> C + Clone + 'a,
    ) -> Self {
        self.column(name, cell.clone()).shown(ColumnKind::Name, heading, cell)
    }

    pub(crate) fn text<C: TableCell>(
        self,
        name: impl Into<String>,
        heading: impl TableCell,
        cell: impl Fn(&T) -> C + Clone + 'a,
    ) -> Self {
        self.column(name, cell.clone()).page_text(heading, cell)
    }

    pub(crate) fn number<C: TableCell>(
        self,
        name: impl Into<String>,
        heading: impl TableCell,
        cell: impl Fn(&T) -> C + Clone + 'a,
    ) -> Self {
        self.column(name, cell.clone()).page_number(heading, cell)
    }

    /// Shows this number on a page instead of the last column.
    pub(crate) fn page_number<C: TableCell>(
        self,
        heading: impl TableCell,
        cell: impl Fn(&T) -> C + 'a,
    ) -> Self {
        self.shown(ColumnKind::Number, heading, cell)
    }

    /// Shows this text on a page instead of the last column.
    pub(crate) fn page_text<C: TableCell>(
        self,
        heading: impl TableCell,
        cell: impl Fn(&T) -> C + 'a,
    ) -> Self {
        self.shown(ColumnKind::Text, heading, cell)
    }

    fn shown<C: TableCell>(
        mut self,
        kind: ColumnKind,
        heading: impl TableCell,
        cell: impl Fn(&T) -> C + 'a,
    ) -> Self {
        let (heading, cell) = (heading.shown(), Box::new(move |row: &T| cell(row).shown()));
        let last = self.last();
        last.page = Some(PageColumn { name: last.name.clone(), heading, kind, cell });
        self
    }

    /// Sets the heading of the last column in a workbook.
    pub(crate) fn headed(mut self, heading: &'static str) -> Self {
        self.last().heading = Some(heading);
        self
    }

    /// Moves the last column on a page before (below 0) or after (above 0) the others.
    pub(crate) fn place(mut self, place: i8) -> Self {
        self.last().place = place;
        self
    }

    /// Adds columns of the same rows that are described elsewhere.
    pub(crate) fn and(mut self, more: Self) -> Self {
        self.0.extend(more.0);
        self
    }

    /// Marks the last column as a detail.
    pub(crate) fn detail(mut self) -> Self {
        self.last().is_detail = true;
        self
    }

    /// Hides details on a page.
    pub(crate) fn in_brief(mut self) -> Self {
        self.0.iter_mut().filter(|column| column.is_detail).for_each(|column| column.page = None);
        self
    }

    /// Keeps only the columns with these names, in this order.
    ///
    /// # Panics
    /// Panics if there is no column of that name.
    pub(crate) fn only(mut self, names: &[&str]) -> Self {
        let column = |name: &&str| {
            let place = self.0.iter().position(|column| column.name == **name);
            self.0.remove(place.unwrap_or_else(|| panic!("{name} is no column")))
        };
        Self(names.iter().map(column).collect())
    }

    /// Turns columns of a part of a row into columns of the whole row.
    pub(crate) fn of_part<W: 'a>(self, part: impl Fn(&W) -> &T + Copy + 'a) -> Columns<'a, W>
    where
        T: 'a,
    {
        let shown = |PageColumn { name, heading, kind, cell }: PageColumn<'a, T>| {
            let cell: OfRow<'a, W, Shown> = Box::new(move |row| cell(part(row)));
            PageColumn { name, heading, kind, cell }
        };
        let column = |column: Column<'a, T>| {
            let Column { name, cell, heading, page, place, is_detail } = column;
            let cell: OfRow<'a, W, CellValue> = Box::new(move |row| cell(part(row)));
            Column { name, cell, heading, page: page.map(shown), place, is_detail }
        };
        Columns(self.0.into_iter().map(column).collect())
    }

    fn last(&mut self) -> &mut Column<'a, T> {
        self.0.last_mut().expect("a column comes before what is said of it")
    }

    /// Columns that a page shows, in order.
    pub(crate) fn of_page(mut self) -> impl Iterator<Item = PageColumn<'a, T>> {
        self.0.sort_by_key(|column| column.place);
        self.0.into_iter().filter_map(|column| column.page)
    }

    /// Writes the rows as CSV; no cell can be read as a formula.
    pub(crate) fn csv<'r>(&self, rows: impl IntoIterator<Item = &'r T>) -> Vec<u8>
    where
        T: 'r,
    {
        let mut writer = csv::Writer::from_writer(Vec::new());
        writer.write_record(self.0.iter().map(|column| inert(column.name.clone()))).expect(WRITTEN);
        for row in rows {
            let cells = self.values(row).map(|value| inert(value.to_string()));
            writer.write_record(cells).expect(WRITTEN);
        }
        written(writer)
    }

    /// Values of a row in a file.
    pub(crate) fn values(&self, row: &T) -> impl Iterator<Item = CellValue> {
        self.0.iter().map(|column| (column.cell)(row))
    }

    /// Headings in a workbook.
    pub(crate) fn headings(&self) -> Vec<String> {
        let heading = |column: &Column<T>| match (column.heading, &column.page) {
            (Some(heading), _) => heading.to_owned(),
            (None, Some(page)) => page.heading.text.clone(),
            (None, None) => column.name.clone(),
        };
        self.0.iter().map(heading).collect()
    }
}

/// Changes a cell so that no spreadsheet reads it as a formula.
fn inert(cell: String) -> String {
    let formula = cell.starts_with(['=', '+', '-', '@', '\t', '\r']) && cell.parse::<f64>().is_err();
    if formula { format!("'{cell}") } else { cell }
}

/// Content of a cell in a file.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum CellValue {
    Empty,
    Words(String),
    Number(f64),
    Count(u64),
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

/// Cell or heading of a page.
#[derive(Clone, Debug, Default, PartialEq)]
pub(crate) struct Shown {
    pub(crate) text: String,
    /// Smaller lines below the main text.
    pub(crate) below: Vec<String>,
    pub(crate) emphasis: Option<Emphasis>,
}

/// Emphasis of the text of a cell.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Emphasis {
    /// Colour for doubt.
    Doubt,
    /// A tick if kept, or a cross if not.
    Kept(bool),
    /// Colour of a run by its number.
    Run(u64),
    /// Words are not broken across lines.
    Whole,
}

impl Shown {
    /// Adds a smaller line at the end, if there is one.
    pub(crate) fn below(mut self, line: impl Into<Option<String>>) -> Self {
        self.below.extend(line.into());
        self
    }

    /// Joins the cell into one line.
    pub(crate) fn line(self) -> String {
        [&[self.text], &self.below[..]].concat().join("; ")
    }

    /// Emphasises the text if an emphasis is given.
    pub(crate) fn emphasised(self, emphasis: impl Into<Option<Emphasis>>) -> Self {
        Self { emphasis: emphasis.into(), ..self }
    }
}

/// Content of a cell; without a value it is empty in a file and a dash on a page.
pub(crate) trait TableCell {
    /// Content in a file.
    fn value(self) -> CellValue;

    /// Content on a page.
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

/// Fraction in percent, with its interval below it on a page.
impl TableCell for Statistic {
    fn value(self) -> CellValue {
        in_percent(Some(self.mean)).value()
    }

    fn shown(self) -> Shown {
        percent(self.mean).shown().below(percent_interval(&self).map(|span| span.to_string()))
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
    Quantity: |quantity: Quantity| quantity.number().value(), |quantity| quantity;
    Verdict: |class: Verdict| class.words().value(), Verdict::words;
}

/// Number with this number of decimals; empty without a number.
fn fixed(value: Option<f64>, decimals: usize) -> String {
    value.map_or_else(String::new, |value| format!("{value:.decimals$}"))
}

fn in_percent(fraction: Option<f64>) -> String {
    fixed(fraction.map(|fraction| 100.0 * fraction), 4)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn no_name_in_a_table_is_hidden() {
        let columns = Columns::default().column("name", |row: &String| row.clone());
        let table = columns.csv(&["a\u{1b}]0;b\u{7}\u{202e}\u{200b}\u{feff}c".to_owned()]);
        assert_eq!(table, "name\na\u{fffd}]0;b\u{fffd}\u{fffd}\u{fffd}\u{fffd}c\n".as_bytes());
    }

    #[test]
    fn rows_have_the_names_of_their_fields_even_where_there_are_none() {
        #[derive(Default, Serialize)]
        struct Row {
            size: u64,
            threshold: Option<f64>,
        }
        assert_eq!(csv_of::<Row>(&[]), b"size,threshold\n");
        let rows = [Row { size: 3, threshold: None }, Row { size: 4, threshold: Some(1.0) }];
        assert_eq!(csv_of(&rows), b"size,threshold\n3,\n4,1.0\n");
    }

    #[test]
    fn a_value_with_its_interval_is_three_columns_of_a_file_and_one_cell_of_a_page() {
        let columns = Columns::default().statistic(["mass", "low", "high"], |row: &Option<Statistic>| *row);
        let columns = columns.page_number("Eroded", |row| *row);
        let rows = [Some(Statistic { mean: 0.25, sd: None, low: Some(0.2), high: Some(0.3) }), None];
        assert_eq!(columns.csv(&rows), b"mass,low,high\n25.0000,20.0000,30.0000\n,,\n");
        let cell = columns.of_page().next().unwrap().cell;
        let [known, unknown] = rows.map(|row| cell(&row));
        assert_eq!((&*known.text, &*known.below[0]), ("25.0\u{202f}%", "20.0 to 30.0\u{202f}%"));
        assert_eq!(unknown, "–".shown());
    }

    #[test]
    fn columns_of_a_part_stand_beside_those_of_the_whole() {
        let part = Columns::default().number("a", "A", |row: &u64| *row).detail();
        let part = part.number("b", "B", |row| 2 * row);
        let whole = part.of_part(|row: &(u64, bool)| &row.0);
        let whole = whole.and(Columns::default().text("c", "C", |row: &(u64, bool)| row.1));
        assert_eq!(whole.csv(&[(3, true)]), b"a,b,c\n3,6,true\n");
        let shown: Vec<String> = whole.in_brief().of_page().map(|column| column.heading.text).collect();
        assert_eq!(shown, ["B", "C"]);
    }

    #[test]
    fn columns_make_a_file_without_formulas_and_a_page() {
        let columns = Columns::default().name("case", "Case", |row: &(&str, f64)| row.0.to_owned());
        let columns = columns.digits("ratio", 2, |row| Some(row.1)).page_number("D15F/D85B", |row| row.1);
        let rows = ["=1+1", "-3", "@x", "b"].map(|name| (name, 0.125));
        assert_eq!(columns.csv(&rows), b"case,ratio\n'=1+1,0.12\n-3,0.12\n'@x,0.12\nb,0.12\n");
        let shown: Vec<String> = columns.of_page().map(|column| (column.cell)(&("b", 3.0)).text).collect();
        assert_eq!(shown, ["b", "3.00"]);
    }
}
