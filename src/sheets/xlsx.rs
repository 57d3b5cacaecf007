//! Sheets of Office Open XML: the workbook's list of sheets, shared strings, number formats, and the sheets.

use super::grid::Grid;
use super::workbook::{
    Budget, Cells, Kind, Runs, Xml, Zipped, as_shown, attribute, characters, number, parts_of, tidy,
    too_large, unreadable,
};
use quick_xml::events::{BytesStart, Event};
use std::collections::HashMap;
use voidwalk_core::gradation::{Position, TableError};

/// Maximum number of shared strings, and of sheets.
const MOST_STRINGS: usize = 200_000;
const MOST_SHEETS: usize = 200;

pub(super) fn sheets(file: &str, zipped: &mut Zipped) -> Result<Vec<Grid>, TableError> {
    let book = zipped.text("xl/workbook.xml")?;
    let mut targets = HashMap::new();
    visit_elements(file, &zipped.text("xl/_rels/workbook.xml.rels")?, "Relationship", |e| {
        let (id, target) = (attribute(e, "Id"), attribute(e, "Target"));
        targets.extend(id.zip(target));
    })?;
    let mut names = Vec::new();
    visit_elements(file, &book, "sheet", |e| {
        let hidden = attribute(e, "state").is_some_and(|state| state != "visible");
        let named = attribute(e, "name").zip(attribute(e, "r:id").or(attribute(e, "id")));
        names.extend(named.map(|(name, id)| (name, id, hidden)));
    })?;
    if names.len() > MOST_SHEETS {
        return Err(too_large(file, &format!("{} sheets", names.len())));
    }
    let strings = shared_strings(file, &zipped.text_if_any("xl/sharedStrings.xml")?)?;
    let styles = styles(file, &zipped.text_if_any("xl/styles.xml")?)?;
    let (mut sheets, mut budget) = (Vec::new(), Budget::new());
    for (name, id, hidden) in names {
        let Some(target) = targets.get(&id) else { continue };
        let path = match target.strip_prefix('/') {
            Some(absolute) => absolute.to_owned(),
            None => format!("xl/{target}"),
        };
        // The sheet of a chart has no cells.
        if path.contains("worksheets/") {
            let context = Context { file, sheet: &name, hidden, strings: &strings, styles: &styles };
            sheets.push(context.sheet(&zipped.text(&path)?, &mut budget)?);
        }
    }
    Ok(sheets)
}

fn xml<'a>(file: &'a str, text: &'a str) -> Xml<'a> {
    Xml::new(file, text, "its XML is broken")
}

fn visit_elements(
    file: &str,
    text: &str,
    name: &str,
    mut visit: impl FnMut(&BytesStart),
) -> Result<(), TableError> {
    let mut xml = xml(file, text);
    loop {
        match xml.next()? {
            Event::Start(e) if e.local_name().as_ref() == name => visit(&e),
            Event::Eof => return Ok(()),
            _ => {}
        }
    }
}

fn shared_strings(file: &str, text: &str) -> Result<Vec<String>, TableError> {
    let mut xml = xml(file, text);
    let (mut strings, mut rich, mut phonetic) = (Vec::new(), Rich::default(), false);
    loop {
        let event = xml.next()?;
        match &event {
            Event::Start(e) if e.local_name().as_ref() == "rPh" => phonetic = true,
            Event::End(e) if e.local_name().as_ref() == "rPh" => phonetic = false,
            Event::End(e) if e.local_name().as_ref() == "si" => {
                // Shortened once: a sheet may use one long text many times.
                strings.push(tidy(&rich.runs.text()));
                if strings.len() > MOST_STRINGS {
                    return Err(too_large(file, &format!("more than {MOST_STRINGS} texts")));
                }
            }
            Event::Eof => return Ok(strings),
            Event::Start(e) => rich.start(e),
            _ if !phonetic => rich.extend(&event),
            _ => {}
        }
    }
}

/// A text of runs in different formats.
#[derive(Default)]
struct Rich {
    runs: Runs,
    kind: Kind,
    format: String,
}

impl Rich {
    /// Takes an element: a run, its text, or one of the properties between them.
    fn start(&mut self, element: &BytesStart) {
        let value = attribute(element, "val").unwrap_or_default();
        match element.local_name().as_ref() {
            "r" | "si" | "is" => (self.kind, self.format) = (Kind::Plain, String::new()),
            "t" => {}
            "strike" if !["0", "false"].contains(&value.as_str()) => self.kind = Kind::Struck,
            "vertAlign" if value == "superscript" => self.kind = self.kind.max(Kind::Raised),
            _ => self.format.push_str(element),
        }
    }

    /// Adds the characters of an event, if it has any.
    fn extend(&mut self, event: &Event) {
        if let Some(more) = characters(event) {
            self.runs.push(&more, self.kind, &self.format);
        }
    }
}

#[derive(Clone, Debug, PartialEq)]
enum Style {
    /// A number format, with the text before and after the number.
    Number(String, String),
    Percent,
    Date,
}

fn styles(file: &str, text: &str) -> Result<Vec<Style>, TableError> {
    let mut formats: HashMap<u32, Style> = HashMap::new();
    visit_elements(file, text, "numFmt", |e| {
        let id = number(e, "numFmtId");
        let code = attribute(e, "formatCode").unwrap_or_default();
        formats.extend(id.map(|id| (id, of_format(&code))));
    })?;
    let mut xml = xml(file, text);
    let (mut within, mut styles) = (false, Vec::new());
    loop {
        match xml.next()? {
            Event::Start(e) if e.local_name().as_ref() == "cellXfs" => within = true,
            Event::End(e) if e.local_name().as_ref() == "cellXfs" => return Ok(styles),
            Event::Start(e) if within && e.local_name().as_ref() == "xf" => {
                styles.push(match number(&e, "numFmtId").unwrap_or(0) {
                    9 | 10 => Style::Percent,
                    14..=22 | 27..=36 | 45..=47 | 50..=58 => Style::Date,
                    id => formats.get(&id).cloned().unwrap_or_else(|| of_format("")),
                });
            }
            Event::Eof => return Ok(styles),
            _ => {}
        }
    }
}

/// Style of a format's code. Quoted text and conditions in brackets do not indicate a date; an elapsed time
/// in brackets (`[h]`) does.
fn of_format(code: &str) -> Style {
    let (before, after, plain) = parts_of(code);
    let plain = plain.to_lowercase().replace("general", "");
    match () {
        () if plain.contains('%') => Style::Percent,
        () if plain.contains(['d', 'y', 'h', 'm', 's']) || counts_time(code) => Style::Date,
        () => Style::Number(before, after),
    }
}

/// True if a format's code has hours, minutes or seconds that continue counting: `[h]`, `[mm]`, `[ss]`.
fn counts_time(code: &str) -> bool {
    let within = code.split('[').skip(1).filter_map(|rest| rest.split_once(']'));
    within.map(|(unit, _)| unit.to_lowercase()).any(|unit| {
        ["h", "m", "s"].iter().any(|letter| !unit.is_empty() && unit.replace(letter, "").is_empty())
    })
}

struct Context<'a> {
    file: &'a str,
    sheet: &'a str,
    hidden: bool,
    strings: &'a [String],
    styles: &'a [Style],
}

impl Context<'_> {
    fn sheet(&self, text: &str, budget: &mut Budget) -> Result<Grid, TableError> {
        let mut xml = xml(self.file, text);
        let mut cells = Cells::new(self.file, self.sheet, budget);
        let (mut row, mut column) = (0usize, 0usize);
        let is_hidden = |e: &BytesStart| attribute(e, "hidden").is_some_and(|h| h == "1" || h == "true");
        let (mut before, mut within) = (None, false);
        loop {
            match xml.next()? {
                Event::Start(e) => match e.local_name().as_ref() {
                    "sheetData" => within = true,
                    "col" if is_hidden(&e) => {
                        if let (Some(first), Some(last)) = (number::<usize>(&e, "min"), number(&e, "max")) {
                            cells.hide_columns(first.saturating_sub(1)..last);
                        }
                    }
                    "row" => {
                        row = number(&e, "r").map_or(row, |r: usize| r.saturating_sub(1));
                        column = 0;
                        if before.replace(row) == Some(row) {
                            let why = format!("its row {} occurs twice in sheet \"{}\"", row + 1, self.sheet);
                            return Err(unreadable(self.file, &why));
                        }
                        if is_hidden(&e) {
                            cells.hide_row(row);
                        }
                    }
                    "c" => {
                        if let Some(place) = attribute(&e, "r").and_then(|place| place_of(&place)) {
                            (row, column) = place;
                        }
                        let text = self.value(&mut xml, &e, row, column)?;
                        cells.put(row, column, &text)?;
                        column += 1;
                    }
                    _ => {}
                },
                Event::End(e) if e.local_name().as_ref() == "sheetData" => within = false,
                Event::End(e) if e.local_name().as_ref() == "row" => row = row.saturating_add(1),
                // A truncated part lacks rows.
                Event::Eof if within => return Err(xml.broken()),
                Event::Eof => return Ok(cells.done(self.hidden)),
                _ => {}
            }
        }
    }

    fn value(
        &self,
        xml: &mut Xml,
        cell: &BytesStart,
        row: usize,
        column: usize,
    ) -> Result<String, TableError> {
        let (mut value, mut inline, mut formula) = (String::new(), Rich::default(), false);
        let mut within = String::new();
        loop {
            let event = xml.next()?;
            match &event {
                Event::Start(e) => {
                    within = e.local_name().as_ref().to_owned();
                    formula |= within == "f";
                    inline.start(e);
                }
                Event::End(e) if e.local_name().as_ref() == "c" => break,
                Event::End(_) => within.clear(),
                Event::Eof => return Err(xml.broken()),
                _ if within == "v" => value.extend(characters(&event)),
                _ if within == "t" => inline.extend(&event),
                _ => {}
            }
        }
        let kind = attribute(cell, "t").unwrap_or_default();
        if formula && value.is_empty() && kind != "str" {
            let at = Position {
                file: format!("{}, sheet \"{}\"", self.file, self.sheet),
                line: row + 1,
                field: "formula",
                column: Some(column as u32),
            };
            let allowed = "a formula with its value: open the workbook in a spreadsheet program and save it";
            return Err(TableError::Value { at, value: String::new(), allowed: allowed.into() });
        }
        Ok(match kind.as_str() {
            "s" => {
                let text = value.parse().ok().and_then(|n: usize| self.strings.get(n)).cloned();
                text.ok_or_else(|| unreadable(self.file, "a cell refers to a missing text"))?
            }
            "inlineStr" => inline.runs.text(),
            "str" | "e" => value,
            "d" => format!("{value} (a date)"),
            "b" => if value == "1" { "TRUE" } else { "FALSE" }.to_owned(),
            _ => self.shown(&value, number(cell, "s").unwrap_or(0)),
        })
    }

    /// Formats a number as the sheet displays it: with its percent sign, or as a date.
    fn shown(&self, value: &str, style: usize) -> String {
        let Ok(number) = value.parse::<f64>() else { return value.to_owned() };
        // Spreadsheets display fifteen digits of a computed number.
        let rounded = format!("{number:.14e}").parse::<f64>().map_or(value.to_owned(), |n| n.to_string());
        match self.styles.get(style) {
            Some(Style::Percent) => format!("{}%", (number * 100.0 * 1e9).round() / 1e9),
            Some(Style::Date) => format!("day {number} (a date)"),
            Some(Style::Number(before, after)) => as_shown(before, &rounded, after),
            None => rounded,
        }
    }
}

/// Row and column of a cell named like `B7`, counted from 0.
fn place_of(name: &str) -> Option<(usize, usize)> {
    let at = name.find(|c: char| c.is_ascii_digit())?;
    let (letters, digits) = name.split_at(at);
    if letters.is_empty() || letters.len() > 3 {
        return None;
    }
    let column = letters.bytes().try_fold(0usize, |sum, b| {
        b.is_ascii_alphabetic().then(|| sum * 26 + usize::from(b.to_ascii_uppercase() - b'A') + 1)
    })?;
    Some((digits.parse::<usize>().ok()?.checked_sub(1)?, column - 1))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn places_and_formats_are_read() {
        assert_eq!(["A1", "B7", "AA10"].map(place_of), [Some((0, 0)), Some((6, 1)), Some((9, 26))]);
        assert_eq!(["7", "A0", "AAAA1", ""].map(place_of), [None; 4]);
        assert_eq!(of_format("0.0%"), Style::Percent);
        for code in ["dd\\-mmm", "m", "m:ss", "[s]", "[hh]:mm", "h AM/PM"] {
            assert_eq!(of_format(code), Style::Date, "{code}");
        }
        let all = "0.00\" mm\"|[Red]0.0;General|[Magenta]0.0|0.00E+00|[>=100]0;0.0|0.0_D_M|0.0\\d|0*d";
        for code in all.split('|') {
            assert!(matches!(of_format(code), Style::Number(..)), "{code}");
        }
    }
}
