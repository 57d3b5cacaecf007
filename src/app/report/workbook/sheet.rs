//! Sheets of a workbook as rows of numbers and words, and the workbook as bytes.
//!
//! Equal sheets give equal bytes: nothing of the day or of the machine is included.

use std::time::{SystemTime, UNIX_EPOCH};

use rust_xlsxwriter::{DocProperties, ExcelDateTime, Format, Workbook, Worksheet, XlsxError};

use crate::outcome::table::{CellValue, Columns, TableCell};
use crate::report::shell::clean;
use voidwalk_core::text::shorten;

/// Most characters of a cell that Excel allows.
const CELL: usize = 32_000;

/// The greatest whole number that a cell holds exactly.
const WHOLE: u64 = 1 << 53;

/// The creation day of every workbook, on any day.
const DAY: (u16, u8, u8) = (2000, 1, 1);

/// Widths of columns (characters).
const WIDTHS: (usize, usize) = (8, 70);

/// A sheet: headings, and rows below them.
pub(super) struct Sheet {
    name: &'static str,
    headings: Vec<String>,
    rows: Vec<Vec<CellValue>>,
}

impl Sheet {
    /// A sheet of rows with these columns.
    pub fn of<'r, T: 'r>(
        name: &'static str,
        columns: &Columns<T>,
        rows: impl IntoIterator<Item = &'r T>,
    ) -> Self {
        let rows = rows.into_iter().map(|row| columns.values(row).map(held).collect()).collect();
        Self { name, headings: columns.headings(), rows }
    }

    /// An empty sheet of items.
    pub fn items(name: &'static str) -> Self {
        Self { name, headings: ["Item", "Value", "Unit"].map(String::from).to_vec(), rows: Vec::new() }
    }

    /// Adds an item with its value and unit.
    pub fn item(&mut self, name: &str, value: impl TableCell, unit: &str) {
        self.rows.push([name.value(), value.value(), unit.value()].map(held).to_vec());
    }

    fn write(&self, sheet: &mut Worksheet) -> Result<(), XlsxError> {
        sheet.set_name(self.name)?;
        let (bold, wrapped) = (Format::new().set_bold(), Format::new().set_text_wrap());
        for (column, heading) in (0u16..).zip(&self.headings) {
            sheet.write_with_format(0, column, heading, &bold)?;
            let words = |row: &Vec<CellValue>| match row.get(usize::from(column)) {
                Some(CellValue::Words(words)) => words.chars().count(),
                _ => 0,
            };
            let widest = self.rows.iter().map(words).max().unwrap_or(0).max(heading.chars().count());
            sheet.set_column_width(column, (widest + 2).clamp(WIDTHS.0, WIDTHS.1) as f64)?;
        }
        for (line, row) in (1u32..).zip(&self.rows) {
            for (column, value) in (0u16..).zip(row) {
                match value {
                    CellValue::Empty => continue,
                    CellValue::Words(words) => {
                        sheet.write_string_with_format(line, column, words, &wrapped)?
                    }
                    CellValue::Number(number) => sheet.write_number(line, column, *number)?,
                    CellValue::Count(count) => sheet.write_number(line, column, *count as f64)?,
                    CellValue::Truth(truth) => sheet.write_boolean(line, column, *truth)?,
                };
            }
        }
        sheet.set_freeze_panes(1, 0)?;
        sheet.set_landscape();
        sheet.set_print_fit_to_pages(1, 0);
        Ok(())
    }
}

/// A value as a cell holds it: words without hidden characters, and numbers that no cell holds as words.
fn held(value: CellValue) -> CellValue {
    match value {
        CellValue::Words(words) if words.is_empty() => CellValue::Empty,
        CellValue::Words(words) => CellValue::Words(shorten(&clean(&words), CELL)),
        CellValue::Number(number) if !number.is_finite() => CellValue::Words(number.to_string()),
        CellValue::Count(count) if count > WHOLE => CellValue::Words(count.to_string()),
        value => value,
    }
}

/// Tells if the clock shows a year that makes the writer of workbooks panic.
pub(super) fn is_before_1970() -> bool {
    SystemTime::now() < UNIX_EPOCH
}

const NO_THREADS: &str =
    "the system gives no more threads, and a workbook needs one a sheet: allow more (ulimit -u)";

/// Tells if the system can start this number of threads at once: the writer of workbooks takes one per sheet,
/// or panics.
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
        assert_eq!(held(f64::NAN.value()), CellValue::Words("NaN".into()));
        assert_eq!(held(u64::MAX.value()), CellValue::Words(u64::MAX.to_string()));
        assert_eq!(held(Some(0.1).value()), CellValue::Number(0.1));
        assert_eq!([None::<f64>.value(), "".value()].map(held), [CellValue::Empty, CellValue::Empty]);
        assert_eq!(held("a\u{202e}b".value()), CellValue::Words("a\u{fffd}b".into()));
    }

    #[test]
    fn the_same_sheets_are_the_same_bytes() {
        let made = || {
            let columns = Columns::default().column("Size (mm)", |row: &(f64, &str)| row.0);
            let columns = columns.column("Note", |row| row.1.to_owned());
            workbook("a", &[Sheet::of("One", &columns, &[(0.1, "=1+1")])]).unwrap()
        };
        let first = made();
        std::thread::sleep(std::time::Duration::from_millis(2100));
        assert_eq!(first, made());
    }
}
