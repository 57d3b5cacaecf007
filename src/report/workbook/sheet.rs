//! Sheets of a workbook as rows of numbers and words, and the workbook as bytes.
//!
//! The same sheets give the same bytes: nothing of the day or of the machine goes in.

use std::time::{SystemTime, UNIX_EPOCH};

use rust_xlsxwriter::{DocProperties, ExcelDateTime, Format, Workbook, Worksheet, XlsxError};

use crate::report::shell::clean;
use crate::text::shorten;

/// Most characters of a cell, as Excel has them.
const CELL: usize = 32_000;

/// The greatest whole number that a cell holds as it is.
const WHOLE: u64 = 1 << 53;

/// The day that every workbook says it was made on, whatever day that was.
const DAY: (u16, u8, u8) = (2000, 1, 1);

/// Widths of columns (characters).
const WIDTHS: (usize, usize) = (8, 70);

/// What stands in a cell.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum Entry {
    /// Nothing.
    Empty,
    /// Words.
    Words(String),
    /// A number.
    Number(f64),
    /// Yes or no.
    Truth(bool),
}

impl From<&str> for Entry {
    fn from(words: &str) -> Self {
        if words.is_empty() { Self::Empty } else { Self::Words(shorten(&clean(words), CELL)) }
    }
}

impl From<&String> for Entry {
    fn from(words: &String) -> Self {
        words.as_str().into()
    }
}

impl From<String> for Entry {
    fn from(words: String) -> Self {
        words.as_str().into()
    }
}

impl From<f64> for Entry {
    fn from(number: f64) -> Self {
        // A cell holds no other.
        if number.is_finite() { Self::Number(number) } else { Self::Words(number.to_string()) }
    }
}

impl From<u64> for Entry {
    fn from(number: u64) -> Self {
        if number <= WHOLE { Self::Number(number as f64) } else { Self::Words(number.to_string()) }
    }
}

impl From<bool> for Entry {
    fn from(truth: bool) -> Self {
        Self::Truth(truth)
    }
}

impl<T: Into<Entry>> From<Option<T>> for Entry {
    fn from(entry: Option<T>) -> Self {
        entry.map_or(Self::Empty, Into::into)
    }
}

/// A sheet: headings, and rows below them.
pub(super) struct Sheet {
    name: &'static str,
    headings: Vec<&'static str>,
    rows: Vec<Vec<Entry>>,
}

impl Sheet {
    /// An empty sheet with headings, units included.
    pub fn new(name: &'static str, headings: &[&'static str]) -> Self {
        Self { name, headings: headings.to_vec(), rows: Vec::new() }
    }

    /// Adds a row.
    pub fn row(&mut self, row: impl IntoIterator<Item = Entry>) {
        self.rows.push(row.into_iter().collect());
    }

    /// Adds a row of a name, a value and its unit.
    pub fn item(&mut self, name: &str, value: impl Into<Entry>, unit: &str) {
        self.row([name.into(), value.into(), unit.into()]);
    }

    fn write(&self, sheet: &mut Worksheet) -> Result<(), XlsxError> {
        sheet.set_name(self.name)?;
        let (bold, wrapped) = (Format::new().set_bold(), Format::new().set_text_wrap());
        for (column, heading) in (0u16..).zip(&self.headings) {
            sheet.write_with_format(0, column, *heading, &bold)?;
            let words = |row: &Vec<Entry>| match row.get(usize::from(column)) {
                Some(Entry::Words(words)) => words.chars().count(),
                _ => 0,
            };
            let widest = self.rows.iter().map(words).max().unwrap_or(0).max(heading.chars().count());
            sheet.set_column_width(column, (widest + 2).clamp(WIDTHS.0, WIDTHS.1) as f64)?;
        }
        for (line, row) in (1u32..).zip(&self.rows) {
            for (column, entry) in (0u16..).zip(row) {
                match entry {
                    Entry::Empty => continue,
                    Entry::Words(words) => sheet.write_string_with_format(line, column, words, &wrapped)?,
                    Entry::Number(number) => sheet.write_number(line, column, *number)?,
                    Entry::Truth(truth) => sheet.write_boolean(line, column, *truth)?,
                };
            }
        }
        sheet.set_freeze_panes(1, 0)?;
        sheet.set_landscape();
        sheet.set_print_fit_to_pages(1, 0);
        Ok(())
    }
}

/// Whether the clock says a year in which the writer of workbooks takes no time, and panics.
pub(super) fn is_before_1970() -> bool {
    SystemTime::now() < UNIX_EPOCH
}

const NO_THREADS: &str =
    "the system gives no more threads, and a workbook needs one a sheet: allow more (ulimit -u)";

/// Whether the system gives so many threads at once: the writer of workbooks takes one a sheet, or panics.
fn has_threads(count: usize) -> bool {
    let threads: Vec<_> = (0..count).map(|_| std::thread::Builder::new().spawn(std::thread::park)).collect();
    let all = threads.iter().all(Result::is_ok);
    for thread in threads.into_iter().flatten() {
        thread.thread().unpark();
        let _ = thread.join();
    }
    all
}

/// A workbook of these sheets, as bytes.
///
/// # Errors
/// A sheet that no workbook holds, such as one of more than a million rows; a clock before 1970; no threads.
pub(super) fn workbook(title: &str, sheets: &[Sheet]) -> Result<Vec<u8>, XlsxError> {
    if is_before_1970() {
        return Err(XlsxError::ParameterError("no workbook before 1970: set this machine's clock".into()));
    }
    let mut book = Workbook::new();
    let (year, month, day) = DAY;
    let made = ExcelDateTime::from_ymd(year, month, day)?;
    book.set_properties(
        &DocProperties::new().set_title(title).set_author("voidwalk").set_creation_datetime(&made),
    );
    for sheet in sheets {
        sheet.write(book.add_worksheet())?;
    }
    if !has_threads(sheets.len()) {
        return Err(XlsxError::ParameterError(NO_THREADS.into()));
    }
    book.save_to_buffer()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn cells_hold_what_they_can() {
        assert_eq!(Entry::from(f64::NAN), Entry::Words("NaN".into()));
        assert_eq!(Entry::from(u64::MAX), Entry::Words(u64::MAX.to_string()));
        assert_eq!(Entry::from(Some(0.1)), Entry::Number(0.1));
        assert_eq!((Entry::from(None::<f64>), Entry::from("")), (Entry::Empty, Entry::Empty));
        assert_eq!(Entry::from("a\u{202e}b"), Entry::Words("a\u{fffd}b".into()));
    }

    #[test]
    fn the_same_sheets_are_the_same_bytes() {
        let made = || {
            let mut sheet = Sheet::new("One", &["Size (mm)", "Note"]);
            sheet.row([0.1.into(), "=1+1".into()]);
            workbook("a", &[sheet]).unwrap()
        };
        let first = made();
        std::thread::sleep(std::time::Duration::from_millis(2100));
        assert_eq!(first, made());
    }
}
