//! A table, described once: each column is its name and how its cell is taken from a row.
//!
//! Rows that are written as they are need no description but their type: [`csv_of()`]. Of others each column
//! is named: [`Columns`].
//!
//! ```
//! use voidwalk::outcome::table::Columns;
//! let of = Columns::default().column("case", |row: &(&str, f64)| row.0.to_owned());
//! let of = of.digits("ratio", 2, |row| Some(row.1));
//! assert_eq!(of.csv(&[("=1", 0.125), ("b", 3.0)]), b"case,ratio\n'=1,0.12\nb,3.00\n");
//! ```

use serde::de::value::Error;
use serde::de::{DeserializeOwned, Error as _, Visitor};
use serde::{Deserializer, Serialize, forward_to_deserialize_any};

use super::record::Statistic;

/// Why writing to memory does not fail.
const WRITTEN: &str = "memory takes rows of numbers and names";

/// Rows as CSV, a column a field of their type; the header is there even without rows.
pub fn csv_of<T: Serialize + DeserializeOwned>(rows: &[T]) -> Vec<u8> {
    let mut names: &[&str] = &[];
    // It is stopped at the names, which are all that is wanted.
    let _ = T::deserialize(Names(&mut names));
    let mut writer = csv::WriterBuilder::new().has_headers(false).from_writer(Vec::new());
    writer.write_record(names).expect(WRITTEN);
    rows.iter().for_each(|row| writer.serialize(row).expect(WRITTEN));
    writer.into_inner().expect(WRITTEN)
}

/// Reads the names of a type's fields, and nothing else.
struct Names<'a>(&'a mut &'static [&'static str]);

impl<'de> Deserializer<'de> for Names<'_> {
    type Error = Error;

    fn deserialize_struct<V: Visitor<'de>>(
        self,
        _: &'static str,
        fields: &'static [&'static str],
        _: V,
    ) -> Result<V::Value, Error> {
        *self.0 = fields;
        Err(Error::custom("names alone"))
    }

    fn deserialize_any<V: Visitor<'de>>(self, _: V) -> Result<V::Value, Error> {
        Err(Error::custom("names alone"))
    }

    forward_to_deserialize_any! {
        bool i8 i16 i32 i64 u8 u16 u32 u64 f32 f64 char str string bytes byte_buf option unit unit_struct
        newtype_struct seq tuple tuple_struct map enum identifier ignored_any
    }
}

/// The columns of a table.
pub struct Columns<'a, T>(Vec<Column<'a, T>>);

/// A column: its name, and its cell of a row.
type Column<'a, T> = (String, Box<dyn Fn(&T) -> String + 'a>);

impl<T> Default for Columns<'_, T> {
    fn default() -> Self {
        Self(Vec::new())
    }
}

impl<'a, T> Columns<'a, T> {
    /// With a column of texts and whole numbers.
    pub fn column<C: TableCell>(mut self, name: impl Into<String>, cell: impl Fn(&T) -> C + 'a) -> Self {
        self.0.push((name.into(), Box::new(move |row| cell(row).text())));
        self
    }

    /// With a column of numbers with so many decimals.
    pub fn digits(self, name: &str, decimals: usize, value: impl Fn(&T) -> Option<f64> + 'a) -> Self {
        self.column(name, move |row| value(row).map(|value| format!("{value:.decimals$}")))
    }

    /// With a column of fractions, in percent.
    pub fn percent(self, name: &str, value: impl Fn(&T) -> Option<f64> + 'a) -> Self {
        self.digits(name, 4, move |row| value(row).map(|fraction| 100.0 * fraction))
    }

    /// With the columns of a fraction in percent and the ends of its interval.
    pub fn statistic(self, names: [&str; 3], of: impl Fn(&T) -> Option<Statistic> + Copy + 'a) -> Self {
        self.percent(names[0], move |row| of(row).map(|statistic| statistic.mean))
            .percent(names[1], move |row| of(row)?.low)
            .percent(names[2], move |row| of(row)?.high)
    }

    /// The rows as CSV; no cell of it is a formula.
    pub fn csv<'r>(&self, rows: impl IntoIterator<Item = &'r T>) -> Vec<u8>
    where
        T: 'r,
    {
        let mut writer = csv::Writer::from_writer(Vec::new());
        writer.write_record(self.0.iter().map(|(name, _)| inert(name.clone()))).expect(WRITTEN);
        for row in rows {
            writer.write_record(self.0.iter().map(|(_, cell)| inert(cell(row)))).expect(WRITTEN);
        }
        writer.into_inner().expect(WRITTEN)
    }
}

/// What stands in a cell; nothing where there is no value.
pub trait TableCell {
    /// As text.
    fn text(self) -> String;
}

impl<C: TableCell> TableCell for Option<C> {
    fn text(self) -> String {
        self.map_or(String::new(), C::text)
    }
}

macro_rules! cells {
    ($($kind:ty),*) => {
        $(impl TableCell for $kind {
            fn text(self) -> String {
                self.to_string()
            }
        })*
    };
}

cells!(String, &str, u64, usize, bool, f64);

/// A cell that no spreadsheet takes for a formula.
fn inert(cell: String) -> String {
    let formula = cell.starts_with(['=', '+', '-', '@', '\t', '\r']) && cell.parse::<f64>().is_err();
    if formula { format!("'{cell}") } else { cell }
}

#[cfg(test)]
mod tests {
    use serde::Deserialize;

    use super::*;

    #[test]
    fn a_cell_is_no_formula() {
        let inert = |cell: &str| inert(cell.to_owned());
        assert_eq!(["=1+1", "-3", "@x", "loose"].map(inert), ["'=1+1", "-3", "'@x", "loose"]);
    }

    #[test]
    fn rows_have_the_names_of_their_fields_even_where_there_are_none() {
        #[derive(Serialize, Deserialize)]
        struct Row {
            size: u64,
            threshold: Option<f64>,
        }
        assert_eq!(csv_of::<Row>(&[]), b"size,threshold\n");
        let rows = [Row { size: 3, threshold: None }, Row { size: 4, threshold: Some(1.0) }];
        assert_eq!(csv_of(&rows), b"size,threshold\n3,\n4,1.0\n");
    }
}
