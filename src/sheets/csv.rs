//! Text to rows of cells.

use std::rc::Rc;

use super::content::{is_blank, is_value};
use super::grid::{Grid, GridRow, Line};
use super::lines::listed;
use super::size::{opening, us_sieve_number};

/// A quoted cell may go on over this many lines.
const LINES_OF_A_CELL: usize = 6;

/// Separators that a text may have, the likeliest first: `sep=` in its first line, or else the first of
/// semicolon, tab and comma in the first line that has any; then the others.
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

/// Separator that Excel states above a table, as in `sep=;`.
fn stated_separator(text: &str) -> Option<char> {
    let first = text.lines().next()?.trim().trim_matches('"').to_lowercase();
    let sign = first.strip_prefix("sep=")?;
    if sign.is_empty() { Some('\t') } else { sign.chars().next() }
}

/// The rows of `text` with this separator.
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
            let is_row = match marked(&content, delimiter) {
                Some(Marked::Numbers) => true,
                Some(Marked::Number) => is_amid(),
                _ => false,
            };
            if is_row {
                comments.push(line);
                grid.commented.push((line, content.trim().to_owned()));
            }
            continue;
        }
        // A quoted heading may hold line breaks.
        let ends = (0..LINES_OF_A_CELL).map(|k| at + k).take_while(|&end| end < lines.len());
        if is_open(&content, delimiter)
            && let Some(end) = ends.into_iter().find(|&end| {
                let joined = lines[at - 1..=end].join(" ");
                !is_open(&joined, delimiter)
            })
        {
            content = lines[at - 1..=end].join(" ");
            at = end + 1;
        }
        let (mut cells, open) = all_cells(&content, delimiter);
        let written = cells.len();
        cells.truncate(filled(&cells));
        if !cells.is_empty() {
            let text = Line { text: content.trim().to_owned(), cells: written };
            grid.rows.push(GridRow { line, cells, text: Some(Rc::new(text)), open });
        }
    }
    if !comments.is_empty() {
        grid.notes.push(format!(
            "{} with # and a number that is no US sieve taken as comments",
            listed("line", &comments, usize::to_string)
        ));
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
    /// A number beside words: amid a table, a row that is commented out.
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

/// True if a line is outside any table.
fn is_comment(line: &str) -> bool {
    marked(line, ',').is_some_and(|marked| marked != Marked::Sieve)
}

fn is_open(line: &str, delimiter: char) -> bool {
    split(line, delimiter).1
}

/// Cells of one line, trimmed, without their quotes and without empty cells at the end; and true if a quote
/// is left open. A quote counts only at the beginning of a cell: elsewhere it means inches.
pub(super) fn split(line: &str, delimiter: char) -> (Vec<String>, bool) {
    let (mut cells, open) = all_cells(line, delimiter);
    cells.truncate(filled(&cells));
    (cells, open)
}

/// The number of cells up to the last that holds anything.
fn filled(cells: &[String]) -> usize {
    cells.iter().rposition(|cell| !cell.is_empty()).map_or(0, |last| last + 1)
}

/// Cells of one line, with empty cells at the end; and true if a quote is left open.
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
    for cell in &mut cells {
        *cell = cell.trim().to_string();
    }
    (cells, quoted)
}
