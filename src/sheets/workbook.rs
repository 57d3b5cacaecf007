//! Code shared by both kinds of workbook: files in a zip and cells, read within bounds; cell texts in
//! several formats; and number formats that write text around a number, such as the unit in `0" µm"`.

use super::grid::{Grid, GridRow, listed};
use quick_xml::Reader;
use quick_xml::events::{BytesStart, Event};
use std::collections::HashSet;
use std::io::{Cursor, Read};
use std::mem::take;
use std::ops::Range;
use std::str::FromStr;
use voidwalk_core::gradation::{TableError, letters};
use zip::ZipArchive;

/// Maximum unpacked size of all parts of a workbook (bytes).
const UNPACKED_LIMIT: u64 = 64 << 20;
/// Maximum size of a part that is read into memory (bytes).
const PART_LIMIT: u64 = 24 << 20;
const PARTS_LIMIT: usize = 2000;

pub(super) struct Zipped<'a> {
    file: String,
    archive: ZipArchive<Cursor<&'a [u8]>>,
    names: Vec<String>,
}

impl<'a> Zipped<'a> {
    /// Opens a zip; refuses one that unpacks to more than a workbook of soils.
    pub(super) fn open(file: &str, bytes: &'a [u8]) -> Result<Zipped<'a>, TableError> {
        let broken = |_| unreadable(file, "its zip cannot be read");
        let mut archive = ZipArchive::new(Cursor::new(bytes)).map_err(broken)?;
        if archive.len() > PARTS_LIMIT {
            return Err(too_large(file, &format!("{} parts", archive.len())));
        }
        let (mut names, mut unpacked) = (Vec::new(), 0u64);
        for index in 0..archive.len() {
            let part = archive.by_index_raw(index).map_err(broken)?;
            if part.encrypted() {
                return Err(unreadable(file, "it has a password"));
            }
            unpacked = unpacked.saturating_add(part.size());
            if unpacked > UNPACKED_LIMIT {
                return Err(too_large(file, &format!("more than {} MB unpacked", UNPACKED_LIMIT >> 20)));
            }
            names.push(part.name().map_err(broken)?.into_owned());
        }
        let zipped = Zipped { file: file.into(), archive, names };
        if zipped.names.iter().any(|name| name.to_lowercase().ends_with("vbaproject.bin")) {
            return Err(unreadable(file, "it holds macros: save it as .xlsx, without them"));
        }
        Ok(zipped)
    }

    pub(super) fn has(&self, name: &str) -> bool {
        self.names.iter().any(|part| part == name)
    }

    /// Reads the text of a part that may be missing.
    pub(super) fn text_if_any(&mut self, name: &str) -> Result<String, TableError> {
        if self.has(name) { self.text(name) } else { Ok(String::new()) }
    }

    /// Reads the text of a part. The limit applies to the unpacked bytes, whatever size the zip declares.
    pub(super) fn text(&mut self, name: &str) -> Result<String, TableError> {
        let file = self.file.clone();
        let part = self.archive.by_name(name);
        let part = part.map_err(|_| unreadable(&file, &format!("its part {name} cannot be read")))?;
        let mut bytes = Vec::new();
        let read = part.take(PART_LIMIT + 1).read_to_end(&mut bytes);
        read.map_err(|_| unreadable(&file, &format!("its part {name} cannot be unpacked")))?;
        if bytes.len() as u64 > PART_LIMIT {
            return Err(too_large(&file, &format!("{name} is more than {} MB", PART_LIMIT >> 20)));
        }
        String::from_utf8(bytes).map_err(|_| unreadable(&file, &format!("its part {name} is not UTF-8")))
    }
}

pub(super) fn unreadable(file: &str, why: &str) -> TableError {
    TableError::Workbook { file: file.into(), why: why.into() }
}

/// Makes the error for a workbook that is larger than any workbook of soils.
pub(super) fn too_large(file: &str, how: &str) -> TableError {
    unreadable(file, &format!("it is too large ({how}); keep the sheet with the soils alone"))
}

/// Reader of a part's XML; an empty element has a start and an end.
pub(super) struct Xml<'a> {
    reader: Reader<&'a [u8]>,
    pub(super) file: &'a str,
    broken: &'static str,
}

impl<'a> Xml<'a> {
    /// Starts to read; `broken` describes text that is not XML.
    pub(super) fn new(file: &'a str, text: &'a str, broken: &'static str) -> Xml<'a> {
        let mut reader = Reader::from_str(text);
        reader.config_mut().expand_empty_elements = true;
        Xml { reader, file, broken }
    }

    pub(super) fn next(&mut self) -> Result<Event<'a>, TableError> {
        self.reader.read_event().map_err(|_| self.broken())
    }

    pub(super) fn broken(&self) -> TableError {
        unreadable(self.file, self.broken)
    }
}

pub(super) fn number<T: FromStr>(element: &BytesStart, name: &str) -> Option<T> {
    attribute(element, name)?.parse().ok()
}

pub(super) fn attribute(element: &BytesStart, name: &str) -> Option<String> {
    let attribute = element
        .attributes()
        .with_checks(false)
        .flatten()
        .find(|a| a.key.as_ref() == name || !name.contains(':') && a.key.local_name().as_ref() == name)?;
    let value = quick_xml::escape::unescape(&attribute.value).ok()?;
    Some(value.into_owned())
}

/// Returns the characters represented by an event within an element.
pub(super) fn characters(event: &Event) -> Option<String> {
    match event {
        Event::Text(text) => Some((**text).to_owned()),
        Event::CData(text) => Some((**text).to_owned()),
        Event::GeneralRef(reference) => {
            let written = format!("&{};", &**reference);
            // Keeps an unknown entity as written: without it `8&b;1` would be 81.
            let known = quick_xml::escape::unescape(&written).map(std::borrow::Cow::into_owned);
            Some(known.unwrap_or(written))
        }
        _ => None,
    }
}

/// Maximum number of columns and of rows that are kept; a sheet of soils has some tens.
const MOST_COLUMNS: usize = 500;
const MOST_ROWS: usize = 20_000;
/// Maximum number of cells and of characters in a whole workbook.
const MOST_PLACES: usize = 500_000;
const MOST_CHARACTERS: usize = 4_000_000;
/// Maximum length of a cell's text that is kept.
const LONGEST: usize = 200;

/// Cells and characters that the sheets of a workbook may still use.
pub(super) struct Budget {
    places: usize,
    characters: usize,
}

impl Budget {
    pub(super) fn new() -> Budget {
        Budget { places: MOST_PLACES, characters: MOST_CHARACTERS }
    }
}

/// Puts the text of a cell on one line, shortened.
pub(super) fn tidy(text: &str) -> String {
    let mut tidy = String::new();
    for word in text.split_whitespace() {
        if tidy.len() >= LONGEST {
            break;
        }
        if !tidy.is_empty() {
            tidy.push(' ');
        }
        tidy.extend(word.chars().take(LONGEST));
    }
    tidy
}

pub(super) struct Cells<'a> {
    grid: Grid,
    budget: &'a mut Budget,
    hidden_rows: Vec<usize>,
    hidden_columns: Vec<Range<usize>>,
}

impl<'a> Cells<'a> {
    pub(super) fn new(file: &str, sheet: &str, budget: &'a mut Budget) -> Cells<'a> {
        let grid = Grid { file: file.into(), sheet: Some(sheet.into()), delimiter: ',', ..Grid::default() };
        Cells { grid, budget, hidden_rows: Vec::new(), hidden_columns: Vec::new() }
    }

    /// Adds a cell after all previous ones; row and column are counted from 0.
    pub(super) fn put(&mut self, row: usize, column: usize, text: &str) -> Result<(), TableError> {
        let text = tidy(text);
        if text.is_empty() {
            return Ok(());
        }
        let file = &self.grid.file;
        if row >= MOST_ROWS || column >= MOST_COLUMNS {
            let how = format!("cells beyond {MOST_ROWS} rows or {MOST_COLUMNS} columns");
            return Err(too_large(file, &how));
        }
        let line = row + 1;
        match self.grid.rows.last() {
            Some(last) if last.line == line => {}
            Some(last) if last.line > line => return Err(unreadable(file, "its rows are not in order")),
            _ => self.grid.rows.push(GridRow { line, cells: Vec::new(), text: None, open: false }),
        }
        let Some(last) = self.grid.rows.last_mut() else { return Ok(()) };
        let more = (column + 1).saturating_sub(last.cells.len());
        let left = (self.budget.places.checked_sub(more), self.budget.characters.checked_sub(text.len()));
        let (Some(places), Some(characters)) = left else {
            return Err(too_large(file, "too many cells"));
        };
        *self.budget = Budget { places, characters };
        if !last.cell(column).is_empty() {
            let name = format!("{}{line}", letters(column as u32));
            return Err(unreadable(file, &format!("its cell {name} occurs twice")));
        }
        if more > 0 {
            last.cells.resize(column + 1, String::new());
        }
        last.cells[column] = text;
        Ok(())
    }

    /// Marks a row as hidden, counted from 0.
    pub(super) fn hide_row(&mut self, row: usize) {
        if row < MOST_ROWS {
            self.hidden_rows.push(row + 1);
        }
    }

    /// Marks columns as hidden, counted from 0.
    pub(super) fn hide_columns(&mut self, columns: Range<usize>) {
        if self.hidden_columns.len() < MOST_COLUMNS {
            self.hidden_columns.push(columns);
        }
    }

    /// Returns all cells as a grid, with a note about those hidden in the sheet.
    pub(super) fn done(mut self, hidden: bool) -> Grid {
        let grid = &mut self.grid;
        if hidden {
            grid.notes.push("its sheet is hidden in the workbook".into());
        }
        let filled: HashSet<usize> = grid.rows.iter().map(|row| row.line).collect();
        let rows: Vec<String> =
            self.hidden_rows.iter().filter(|row| filled.contains(row)).map(usize::to_string).collect();
        let width = grid.width();
        let mut is_filled = vec![false; width];
        grid.rows.iter().flat_map(GridRow::filled).for_each(|c| is_filled[c] = true);
        let is_hidden = |c: &usize| self.hidden_columns.iter().any(|columns| columns.contains(c));
        let columns: Vec<String> =
            (0..width).filter(|&c| is_filled[c]).filter(is_hidden).map(|c| letters(c as u32)).collect();
        for (word, all) in [("row", rows), ("column", columns)].iter().filter(|(_, all)| !all.is_empty()) {
            let places = listed(word, all, String::clone);
            grid.notes.push(format!("{places} of the sheet, though hidden, read"));
        }
        self.grid
    }
}

#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord)]
pub(super) enum Kind {
    #[default]
    Plain,
    Raised,
    Struck,
}

/// Text so far, and the part that may still continue.
#[derive(Default)]
pub(super) struct Runs {
    text: String,
    part: String,
    kind: Kind,
    format: String,
}

impl Runs {
    pub(super) fn push(&mut self, more: &str, kind: Kind, format: &str) {
        if (self.kind, self.format.as_str()) != (kind, format) {
            self.close();
            (self.kind, self.format) = (kind, format.to_owned());
        }
        self.part.push_str(more);
    }

    pub(super) fn text(&mut self) -> String {
        self.close();
        take(self).text
    }

    fn close(&mut self) {
        let part = take(&mut self.part);
        let last = self.text.chars().next_back();
        let follows_digit = last.is_some_and(|c| c.is_ascii_digit());
        let is_mark = part.contains(char::is_alphanumeric) && !last.is_some_and(char::is_alphabetic);
        self.text += &match self.kind {
            _ if part.trim().is_empty() => part,
            Kind::Struck => format!("[struck out: {}]", part.trim()),
            Kind::Raised if is_mark => format!(" ({})", part.trim()),
            // Digits in two formats may be two numbers.
            _ if follows_digit && part.starts_with(|c: char| c.is_ascii_digit()) => format!("[{part}]"),
            _ => part,
        };
    }
}

/// A number with the text around it, which may be its unit or a sign such as `<`; grams and percents are
/// omitted.
pub(super) fn as_shown(before: &str, number: &str, after: &str) -> String {
    const USUAL: [&str; 11] = ["", "g", "gr", "gm", "gms", "gram", "grams", "gramm", "kg", "%", "pct"];
    let after = match after.trim().trim_end_matches('.').to_lowercase() {
        usual if USUAL.contains(&usual.as_str()) => "",
        _ => after,
    };
    format!("{before}{number}{after}").trim().to_owned()
}

/// Text before the first digit of a displayed number, and after the last.
pub(super) fn around(shown: &str) -> (&str, &str) {
    let is_digit = |c: char| c.is_ascii_digit();
    match (shown.find(is_digit), shown.rfind(is_digit)) {
        (Some(first), Some(last)) => (
            shown[..first].trim_end_matches(['-', '+', '\u{2212}', '.', ',', '(']),
            shown[last + 1..].trim_start_matches(['.', ',', ')']),
        ),
        _ => ("", ""),
    }
}

/// Text that a format's code writes before and after a positive number, and the rest of the code without
/// quoted text, colours and spaces as wide as a character.
pub(super) fn parts_of(code: &str) -> (String, String, String) {
    let (mut before, mut after, mut plain) = (String::new(), String::new(), String::new());
    let (mut chars, mut quoted, mut is_first) = (code.chars(), false, true);
    while let Some(c) = chars.next() {
        let mut literal = None;
        match c {
            '"' => quoted = !quoted,
            ' ' | '<' | '>' => literal = Some(c),
            c if quoted => literal = Some(c),
            '\\' => literal = chars.next(),
            // A space as wide as a character, or a character that fills the cell.
            '_' | '*' => drop(chars.next()),
            '[' => chars.by_ref().take_while(|&c| c != ']').for_each(drop),
            c => {
                is_first &= c != ';';
                plain.push(c);
            }
        }
        if let Some(c) = literal.filter(|_| is_first) {
            if plain.is_empty() { before.push(c) } else { after.push(c) }
        }
    }
    (before, after, plain)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::content::percentage;

    #[test]
    fn raised_struck_and_glued_digits_are_not_those_of_the_number_beside_them() {
        let text = |parts: &[(&str, Kind)]| {
            let mut runs = Runs::default();
            parts.iter().for_each(|(more, kind)| runs.push(more, *kind, ""));
            runs.text()
        };
        let (plain, raised, struck) = (Kind::Plain, Kind::Raised, Kind::Struck);
        assert_eq!(percentage(&text(&[("95", plain), ("a", raised)])), Some(95.0));
        assert_eq!(percentage(&text(&[("9", plain), ("5", plain), (".5", plain)])), Some(95.5));
        for parts in
            [[("1", raised), ("95", plain)], [("97", struck), ("95", plain)], [("", plain), ("95", struck)]]
        {
            assert_eq!(percentage(&text(&parts)), None, "{parts:?}");
        }
        assert_eq!(text(&[("cm", plain), ("3", raised)]), "cm3");
    }

    #[test]
    fn units_in_formats_are_kept() {
        for (code, shown) in [
            ("\"No. \"0", "No. 425"),
            ("0.0\" g\"", "425"),
            ("0.0_D_M", "425"),
            ("0;-0\" in\"", "425"),
            ("#,##0.0\"%\"", "425"),
        ] {
            let (before, after, _) = parts_of(code);
            assert_eq!(as_shown(&before, "425", &after), shown, "{code}");
        }
        assert_eq!([around("1.180,5 µm"), around("-5")], [("", " µm"), ("", "")]);
    }
}
