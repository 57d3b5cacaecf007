//! Text to rows of cells.

use std::rc::Rc;

use super::grid::{Grid, GridRow, Line};
use super::heading::{Role, role, unit};
use super::size::{Said, Unit, opening, us_sieve_number};
use crate::gradation::table::number;

/// A quoted cell may go on over this many lines.
const LINES_OF_A_CELL: usize = 6;

/// The separators that a text may have, the likeliest first: `sep=` in its first line, or else the first of
/// semicolon, tab and comma in the first line that has any; then the others.
pub(super) fn separators(text: &str) -> Vec<char> {
    if let Some(sign) = stated_separator(text) {
        return vec![sign];
    }
    const ALL: [char; 3] = [';', '\t', ','];
    let named = names_are_sieves(text);
    let lines = text.lines().filter(|line| !line.trim_start().starts_with('#') || named && names_sieve(line));
    let found = lines.filter_map(|line| ALL.into_iter().find(|&c| line.contains(c))).next().unwrap_or(',');
    let others = ALL.into_iter().filter(|&c| c != found && text.contains(c));
    std::iter::once(found).chain(others).collect()
}

/// What Excel writes above a table to say what separates its columns: `sep=;`.
fn stated_separator(text: &str) -> Option<char> {
    let first = text.lines().next()?.trim().trim_matches('"').to_lowercase();
    let sign = first.strip_prefix("sep=")?;
    if sign.is_empty() { Some('\t') } else { sign.chars().next() }
}

/// The rows of `text` with this separator.
pub(super) fn grid(file: &str, text: &str, delimiter: char) -> Grid {
    let mut grid = Grid { file: file.into(), delimiter, ..Grid::default() };
    let lines: Vec<&str> = text.lines().collect();
    let named = names_are_sieves(text);
    let mut comments = 0;
    let mut at = usize::from(stated_separator(text).is_some());
    while at < lines.len() {
        let line = at + 1;
        let mut content = lines[at].to_owned();
        at += 1;
        if content.trim_start().starts_with('#') && !(named && names_sieve(&content)) {
            comments += usize::from(names_sieve(&content));
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
    if comments > 0 {
        grid.notes.push(format!(
            "{comments} line(s) that begin with # and a number were taken as comments, as other openings are \
             numbers without a unit"
        ));
    }
    grid
}

/// Whether lines like `#200,12` are rows of a table: they are where other rows begin with sieves in inches,
/// and where none begins with a bare number, of which such a line could be one that is commented out.
fn names_are_sieves(text: &str) -> bool {
    let mut bare = false;
    for line in text.lines().map(str::trim).filter(|line| !line.starts_with('#')) {
        let quoted = line.starts_with('"');
        let first = line.trim_start_matches('"').split([',', ';', '\t']).next().unwrap_or_default();
        let first = first.split(if quoted { "\"\"" } else { "\t" }).next().unwrap_or_default();
        let first = first.trim_end_matches('"').trim();
        let is_fraction = first.contains('/') && opening(first).is_some();
        if is_fraction || opening(first).is_some_and(|(_, said)| said > Said::WithUnit) {
            return true;
        }
        if role(first) == Role::Size && unit(first) == Ok(Some(Unit::Inch)) {
            return true;
        }
        bare |= number(first).is_some();
    }
    !bare
}

/// `#200,12`: a US sieve and a number.
fn names_sieve(line: &str) -> bool {
    let Some(rest) = line.trim_start().strip_prefix('#') else { return false };
    let digits: String = rest.trim_start().chars().take_while(char::is_ascii_digit).collect();
    let after = rest.trim_start()[digits.len()..].trim_start();
    us_sieve_number(&digits).is_some()
        && after.starts_with([',', ';', '\t', '"'])
        && after.contains(|c: char| c.is_ascii_digit())
}

fn is_open(line: &str, delimiter: char) -> bool {
    split(line, delimiter).1
}

/// The cells of one line, trimmed and without their quotes, empty ones at its end left out; and whether a
/// quote is left open. A quote counts at the beginning of a cell only: elsewhere it is inches.
pub(super) fn split(line: &str, delimiter: char) -> (Vec<String>, bool) {
    let (mut cells, open) = all_cells(line, delimiter);
    cells.truncate(filled(&cells));
    (cells, open)
}

/// The number of cells up to the last that holds anything.
fn filled(cells: &[String]) -> usize {
    cells.iter().rposition(|cell| !cell.is_empty()).map_or(0, |last| last + 1)
}

/// The cells of one line, empty ones at its end among them; and whether a quote is left open.
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
