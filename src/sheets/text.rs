//! Bytes to text, by the encoding of the file; text to rows of cells.

use super::content::{is_blank, is_value};
use super::grid::{Grid, GridRow, Line, listed, trimmed};
use super::size::{opening, us_sieve_number};
use std::rc::Rc;
use voidwalk_core::gradation::TableError;

/// Decodes `bytes`; also returns the assumed encoding if it is not plain UTF-8.
///
/// UTF-8 and UTF-16 are understood, with or without a byte order mark. Anything else is read as
/// Windows-1252, as saved by spreadsheets in western countries, unless it is not text at all.
pub(super) fn decoded(file: &str, bytes: &[u8]) -> Result<(String, Option<String>), TableError> {
    refuse_other_formats(file, bytes)?;
    if let Some((is_big, skip)) = utf16(bytes) {
        let name = if is_big { "UTF-16BE" } else { "UTF-16LE" };
        let number = if is_big { u16::from_be_bytes } else { u16::from_le_bytes };
        let (units, odd) = bytes[skip..].as_chunks();
        let text: Result<String, _> = char::decode_utf16(units.iter().map(|&unit| number(unit))).collect();
        let Some(text) = text.ok().filter(|text| odd.is_empty() && !text.contains('\0')) else {
            return Err(other(file, format!("{name} that ends or breaks in the middle of a character")));
        };
        return Ok((unified(text), Some(format!("read as {name} text"))));
    }
    let (text, note) = match std::str::from_utf8(bytes) {
        Ok(text) => (text.strip_prefix('\u{feff}').unwrap_or(text).to_owned(), None),
        Err(_) => (windows_1252(bytes), Some("read as Windows-1252 text".to_owned())),
    };
    if let Some(at) = bytes.iter().position(|&b| b == 0) {
        let line = 1 + bytes[..at].iter().filter(|&&b| b == b'\n').count();
        return Err(TableError::Encoding { file: file.into(), line, byte: 0 });
    }
    Ok((unified(text), note))
}

/// Converts line ends. A file without any line feed has the carriage returns of an old Mac.
fn unified(text: String) -> String {
    if text.contains('\n') || !text.contains('\r') { text } else { text.replace('\r', "\n") }
}

/// Windows-1252: Latin-1 except for these characters from 0x80 to 0x9f.
fn windows_1252(bytes: &[u8]) -> String {
    const OTHERS: &str = "€\u{81}‚ƒ„…†‡ˆ‰Š‹Œ\u{8d}Ž\u{8f}\u{90}‘’“”•–—˜™š›œ\u{9d}žŸ";
    let others: Vec<char> = OTHERS.chars().collect();
    let character = |&byte: &u8| others.get(usize::from(byte).wrapping_sub(0x80)).copied();
    bytes.iter().map(|byte| character(byte).unwrap_or(char::from(*byte))).collect()
}

/// Recognises UTF-16 by its mark, or by the zeros in every other byte. Returns true if the high byte
/// comes first, and the length of the mark.
fn utf16(bytes: &[u8]) -> Option<(bool, usize)> {
    let start = &bytes[..bytes.len().min(200) & !1];
    let zeros = |from: usize| start.iter().skip(from).step_by(2).filter(|&&b| b == 0).count();
    let (even, odd, most) = (zeros(0), zeros(1), start.len() * 2 / 5);
    match bytes {
        [0xff, 0xfe, ..] => Some((false, 2)),
        [0xfe, 0xff, ..] => Some((true, 2)),
        _ if start.len() < 8 => None,
        _ if odd > most && even == 0 => Some((false, 0)),
        _ if even > most && odd == 0 => Some((true, 0)),
        _ => None,
    }
}

/// Refuses formats of other programs by their first bytes.
fn refuse_other_formats(file: &str, bytes: &[u8]) -> Result<(), TableError> {
    const KNOWN: [(&[u8], &str); 4] = [
        (&[0xd0, 0xcf, 0x11, 0xe0], "an Excel workbook of the old kind (.xls), or one with a password"),
        (b"%PDF", "a PDF document"),
        (b"{\\rtf", "a text document (.rtf)"),
        (&[0x1f, 0x8b], "compressed (gzip)"),
    ];
    let known = KNOWN.iter().find(|(start, _)| bytes.starts_with(start)).map(|(_, is)| (*is).to_owned());
    let small = file.to_lowercase();
    let named = [".xlsx", ".ods"].iter().find(|ending| small.ends_with(**ending));
    let named = named.map(|ending| format!("not a workbook, though its name ends in {ending}"));
    known.or(named).map_or(Ok(()), |is| Err(other(file, is)))
}

fn other(file: &str, is: String) -> TableError {
    TableError::Format { file: file.into(), is }
}

/// Maximum number of lines in a quoted cell.
const LINES_OF_A_CELL: usize = 6;

/// Possible separators of a text, the most likely first: `sep=` in its first line, or else the first of
/// semicolon, tab and comma in the first line that has one; then the others.
pub(super) fn separators(text: &str) -> Vec<char> {
    if let Some(sign) = stated_separator(text) {
        return vec![sign];
    }
    const ALL: [char; 3] = [';', '\t', ','];
    let lines = text.lines().filter(|line| !is_comment(line));
    let first = lines.filter_map(|line| ALL.into_iter().find(|&c| line.contains(c))).next().unwrap_or(',');
    let others = ALL.into_iter().filter(|&c| c != first && text.contains(c));
    std::iter::once(first).chain(others).collect()
}

/// Separator stated by Excel above a table, as in `sep=;`.
fn stated_separator(text: &str) -> Option<char> {
    let first = text.lines().next()?.trim().trim_matches('"').to_lowercase();
    let sign = first.strip_prefix("sep=")?;
    if sign.is_empty() { Some('\t') } else { sign.chars().next() }
}

pub(super) fn grid(file: &str, text: &str, delimiter: char) -> Grid {
    let mut grid = Grid { file: file.into(), delimiter, ..Grid::default() };
    let lines: Vec<&str> = text.lines().collect();
    let mut comments = Vec::new();
    let mut at = usize::from(stated_separator(text).is_some());
    while at < lines.len() {
        let line = at + 1;
        let mut content = lines[at].to_owned();
        at += 1;
        if is_comment(&content) {
            let is_amid = || grid.rows.iter().any(|row| row.filled().take(2).count() == 2);
            let marked = marked(&content, delimiter);
            if marked == Some(Marked::Numbers) || marked == Some(Marked::Number) && is_amid() {
                comments.push(line);
                grid.commented.push((line, content.trim().to_owned()));
            }
            continue;
        }
        // A quoted heading may contain line breaks.
        let ends = (0..LINES_OF_A_CELL).map(|k| at + k).take_while(|&end| end < lines.len());
        if all_cells(&content, delimiter).1
            && let Some(end) =
                ends.into_iter().find(|&end| !all_cells(&lines[at - 1..=end].join(" "), delimiter).1)
        {
            content = lines[at - 1..=end].join(" ");
            at = end + 1;
        }
        let (cells, open) = all_cells(&content, delimiter);
        let written = cells.len();
        let cells = trimmed(cells);
        if !cells.is_empty() {
            let text = Line { text: content.trim().to_owned(), cells: written };
            grid.rows.push(GridRow { line, cells, text: Some(Rc::new(text)), open });
        }
    }
    if !comments.is_empty() {
        let lines = listed("line", &comments, usize::to_string);
        grid.notes.push(format!("{lines} with # and a number that is no US sieve taken as comments"));
    }
    grid
}

/// A line that begins with `#`.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Marked {
    /// `#200,12`: a US sieve and numbers.
    Sieve,
    /// Another number and numbers, such as a row that is commented out.
    Numbers,
    /// A number with words: inside a table, a row that is commented out.
    Number,
    Comment,
}

/// Kind of a line that begins with `#`, in a text with this separator; `None` for any other line.
fn marked(line: &str, delimiter: char) -> Option<Marked> {
    let rest = line.trim_start().strip_prefix('#')?;
    let mut holds = Marked::Comment;
    for sign in [',', ';', '\t'].into_iter().filter(|&sign| rest.contains(sign)) {
        let cells = all_cells(rest, sign).0;
        let others: Vec<&String> = cells.iter().skip(1).filter(|cell| !is_blank(cell)).collect();
        let values = others.iter().filter(|cell| is_value(cell)).count();
        let is_sieve = us_sieve_number(&cells[0]).is_some() && (values > 0 || others.is_empty());
        let is_opening = opening(&cells[0]).is_some();
        let is_number = values > 0 || sign == delimiter && is_value(&cells[0]);
        holds = match () {
            () if is_sieve => return Some(Marked::Sieve),
            () if is_opening && values > 0 && values == others.len() => Marked::Numbers,
            () if holds == Marked::Comment && is_number && (is_opening || sign == delimiter) => {
                Marked::Number
            }
            () => holds,
        };
    }
    Some(holds)
}

fn is_comment(line: &str) -> bool {
    marked(line, ',').is_some_and(|marked| marked != Marked::Sieve)
}

/// Cells of one line, trimmed and unquoted, including empty cells at the end; true if a quote is not
/// closed. A quote counts only at the beginning of a cell: elsewhere it means inches.
pub(super) fn all_cells(line: &str, delimiter: char) -> (Vec<String>, bool) {
    let mut cells = vec![String::new()];
    let (mut quoted, mut was_quoted) = (false, false);
    let mut chars = line.chars().peekable();
    while let Some(c) = chars.next() {
        let Some(cell) = cells.last_mut() else { break };
        match c {
            '"' if quoted && chars.peek() == Some(&'"') => {
                chars.next();
                cell.push('"');
            }
            '"' if quoted => quoted = false,
            '"' if !was_quoted && cell.trim().is_empty() => (quoted, was_quoted) = (true, true),
            c if c == delimiter && !quoted => {
                was_quoted = false;
                cells.push(String::new());
            }
            c => cell.push(c),
        }
    }
    cells.iter_mut().for_each(|cell| *cell = cell.trim().to_string());
    (cells, quoted)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_file_named_as_a_workbook_is_one_or_refused() {
        let error = |file: &str, bytes: &[u8]| decoded(file, bytes).unwrap_err().to_string();
        for ending in ["xlsx", "XLSX", "ods"] {
            let message = error(&format!("site.{ending}"), b"# voidwalk\n\n4.75,100\n");
            let is = format!("site.{ending} is not a workbook, though its name ends in .");
            assert!(message.starts_with(&is), "{message}");
        }
        assert!(error("site.xlsx", &[0xd0, 0xcf, 0x11, 0xe0]).contains("one with a password"));
        assert!(decoded("site.csv", b"4.75,100\n").is_ok());
    }

    #[test]
    fn windows_1252_has_a_character_for_every_byte() {
        let all: Vec<u8> = (0x7e..=0xff).collect();
        let text = windows_1252(&all);
        assert!(text.starts_with("~\u{7f}€\u{81}‚ƒ") && text.contains("œ\u{9d}žŸ\u{a0}¡"), "{text}");
        assert!(text.ends_with("þÿ") && text.chars().count() == all.len());
    }
}
