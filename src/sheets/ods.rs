//! Sheets of OpenDocument: `content.xml`.

use super::grid::Grid;
use super::workbook::{
    Budget, Cells, Kind, Runs, Xml, Zipped, around, as_shown, attribute, characters, number, tidy, too_large,
    unreadable,
};
use quick_xml::events::{BytesStart, Event};
use std::collections::{HashMap, HashSet};
use voidwalk_core::gradation::TableError;

/// Maximum number of repetitions of a filled cell or row.
const MOST_REPEATS: usize = 1000;

/// Text of the sheets, and the kinds of text by style.
struct Content<'a> {
    xml: Xml<'a>,
    kinds: HashMap<String, Kind>,
}

pub(super) fn sheets(file: &str, zipped: &mut Zipped) -> Result<Vec<Grid>, TableError> {
    let text = zipped.text("content.xml")?;
    let xml = Xml::new(file, &text, "its content.xml is broken");
    let mut content = Content { xml, kinds: HashMap::new() };
    let (mut sheets, mut budget) = (Vec::new(), Budget::new());
    // Styles come before the sheets; a hidden style hides the sheets that use it.
    let (mut hidden, mut style) = (HashSet::new(), String::new());
    loop {
        match content.xml.next()? {
            Event::Start(e) => match e.name().as_ref() {
                "style:style" => style = attribute(&e, "style:name").unwrap_or_default(),
                "style:table-properties" if attribute(&e, "table:display").is_some_and(|d| d == "false") => {
                    hidden.insert(style.clone());
                }
                "style:text-properties" => {
                    content.kinds.extend(kind_of(&e).map(|kind| (style.clone(), kind)));
                }
                "table:table" => {
                    let is_hidden = attribute(&e, "table:style-name").is_some_and(|s| hidden.contains(&s));
                    let name = attribute(&e, "table:name").unwrap_or_default();
                    sheets.push(content.sheet(&name, is_hidden, &mut budget)?);
                }
                _ => {}
            },
            Event::Eof => return Ok(sheets),
            _ => {}
        }
    }
}

/// Kind of the text with these properties; `None` for ordinary text.
fn kind_of(properties: &BytesStart) -> Option<Kind> {
    let has = |name: &str| attribute(properties, name).is_some_and(|value| value != "none");
    let position = attribute(properties, "style:text-position").unwrap_or_default();
    if has("style:text-line-through-style") || has("style:text-line-through-type") {
        return Some(Kind::Struck);
    }
    let is_raised = position.starts_with("super") || position.starts_with(|c| ('1'..='9').contains(&c));
    is_raised.then_some(Kind::Raised)
}

fn repeats(element: &BytesStart, name: &str) -> usize {
    number(element, name).unwrap_or(1).max(1)
}

/// Converts a fraction to the percents that the sheet displays.
fn percents(value: &str) -> Option<String> {
    let percent = value.parse::<f64>().ok()? * 100.0;
    Some(format!("{}%", (percent * 1e9).round() / 1e9))
}

impl Content<'_> {
    fn sheet(&mut self, name: &str, hidden: bool, budget: &mut Budget) -> Result<Grid, TableError> {
        let file = self.xml.file;
        let mut cells = Cells::new(file, name, budget);
        let (mut row, mut columns) = (0usize, 0usize);
        let is_collapsed = |e: &BytesStart| {
            attribute(e, "table:visibility").is_some_and(|visibility| visibility != "visible")
        };
        loop {
            match self.xml.next()? {
                Event::Start(e) if e.name().as_ref() == "table:table-column" => {
                    let end = columns.saturating_add(repeats(&e, "table:number-columns-repeated"));
                    if is_collapsed(&e) {
                        cells.hide_columns(columns..end);
                    }
                    columns = end;
                }
                Event::Start(e) if e.name().as_ref() == "table:table-row" => {
                    let times = repeats(&e, "table:number-rows-repeated");
                    let collapsed = is_collapsed(&e);
                    let filled = self.row()?;
                    if !filled.is_empty() && times > MOST_REPEATS {
                        return Err(too_large(file, &format!("a row that is repeated {times} times")));
                    }
                    let kept = if filled.is_empty() { 0 } else { times };
                    for again in 0..kept {
                        if collapsed {
                            cells.hide_row(row.saturating_add(again));
                        }
                        for (column, text) in &filled {
                            cells.put(row.saturating_add(again), *column, text)?;
                        }
                    }
                    row = row.saturating_add(times);
                }
                Event::End(e) if e.name().as_ref() == "table:table" => return Ok(cells.done(hidden)),
                Event::Eof => return Err(self.xml.broken()),
                _ => {}
            }
        }
    }

    /// The filled cells of a row, with their columns.
    fn row(&mut self) -> Result<Vec<(usize, String)>, TableError> {
        let file = self.xml.file;
        let mut filled = Vec::new();
        let mut column = 0usize;
        loop {
            match self.xml.next()? {
                Event::Start(e)
                    if ["table:table-cell", "table:covered-table-cell"].contains(&e.name().as_ref()) =>
                {
                    let times = repeats(&e, "table:number-columns-repeated");
                    let end = e.name().as_ref().to_owned();
                    let kind = attribute(&e, "office:value-type").unwrap_or_default();
                    let value = attribute(&e, "office:value");
                    let formula = attribute(&e, "table:formula").is_some();
                    let is_error = attribute(&e, "calcext:value-type").is_some_and(|kind| kind == "error");
                    let shown = self.paragraphs(&end)?;
                    // The stored value of a failed formula is 0.
                    let failed = is_error || shown.starts_with('#') || shown.starts_with("Err:");
                    let text = match (kind.as_str(), value) {
                        ("percentage" | "float" | "currency", Some(_)) if failed => shown,
                        ("percentage", Some(value)) => percents(&value).unwrap_or(value),
                        ("float", Some(value)) => {
                            let (before, after) = around(&shown);
                            as_shown(before, &value, after)
                        }
                        ("currency", Some(value)) => value,
                        ("date" | "time", _) => format!("{shown} (a date)"),
                        ("", _) if formula && shown.is_empty() => "a formula without its value".to_owned(),
                        _ => shown,
                    };
                    let text = tidy(&text);
                    if !text.is_empty() {
                        if times > MOST_REPEATS {
                            return Err(too_large(file, &format!("a cell that is repeated {times} times")));
                        }
                        filled.extend((0..times).map(|again| (column.saturating_add(again), text.clone())));
                        if filled.len() > 4 * MOST_REPEATS {
                            return Err(too_large(file, "a row of more than 4000 cells"));
                        }
                    }
                    column = column.saturating_add(times);
                }
                Event::End(e) if e.name().as_ref() == "table:table-row" => return Ok(filled),
                Event::Eof => return Err(self.xml.broken()),
                _ => {}
            }
        }
    }

    /// The text of a cell, without its comments.
    fn paragraphs(&mut self, end: &str) -> Result<String, TableError> {
        const SPACES: [&str; 4] = ["text:p", "text:s", "text:tab", "text:line-break"];
        let (mut runs, mut spans) = (Runs::default(), Vec::new());
        let mut within_comment = 0u32;
        loop {
            let event = self.xml.next()?;
            match &event {
                Event::Start(e) if e.name().as_ref() == "office:annotation" => within_comment += 1,
                Event::End(e) if e.name().as_ref() == "office:annotation" => {
                    within_comment = within_comment.saturating_sub(1);
                }
                Event::Start(e) if e.name().as_ref() == "text:span" => {
                    spans.push(attribute(e, "text:style-name").unwrap_or_default());
                }
                Event::End(e) if e.name().as_ref() == "text:span" => drop(spans.pop()),
                Event::Start(e) if e.name().as_ref() == "table:table" => {
                    return Err(unreadable(self.xml.file, "a cell contains a table"));
                }
                Event::Start(e) if SPACES.contains(&e.name().as_ref()) => runs.push(" ", Kind::Plain, ""),
                Event::End(e) if e.name().as_ref() == end => return Ok(runs.text().trim().to_owned()),
                Event::Eof => return Err(self.xml.broken()),
                _ => {
                    if let Some(more) = characters(&event).filter(|_| within_comment == 0) {
                        let kind = spans.iter().filter_map(|style| self.kinds.get(style)).max();
                        runs.push(&more, kind.copied().unwrap_or(Kind::Plain), &spans.join(" "));
                    }
                }
            }
        }
    }
}
