//! Rows that a mistake has run together in one cell, or cut short.

use super::content::{is_text, is_value, is_words};
use super::grid::{Grid, GridRow};
use super::size::{Opening, opening};
use voidwalk_core::gradation::FIELDS;
use voidwalk_core::gradation::{TableError, shortened};

/// A cell without the values at its end, and their number, read as if other separators were spaces.
fn parted(cell: &str) -> [(String, usize); 2] {
    let signs: &[char] = &[';', '\t', '|', '"'];
    let spaced = cell.replace(signs, " ");
    [spaced.clone(), spaced.replace(',', " ")].map(|text| {
        let mut words: Vec<&str> = text.split_whitespace().filter(|word| *word != "%").collect();
        let all = words.len();
        while words.last().is_some_and(|word| is_value(word)) {
            words.pop();
        }
        (words.join(" "), all - words.len())
    })
}

/// True if a cell holds an opening and values, behind another separator or in quotes around the whole row.
pub(super) fn is_whole_row(cell: &str) -> bool {
    parted(cell).iter().any(|(rest, values)| match rest.is_empty() {
        true => *values > 1,
        false => *values > 0 && opening(rest).is_some(),
    })
}

/// True if a cell ends in several values or holds several openings: a row of a table on its side.
pub(super) fn holds_several(cell: &str) -> bool {
    let spaced = cell.replace("  ", ";");
    let parts = spaced.split([';', '\t', '|', '"', ',']).map(str::trim);
    parted(cell).iter().any(|(_, values)| *values > 1)
        || parts.filter(|part| opening(part).is_some()).count() > 2
}

/// Words of a cell, split at any sign and without units; a date, a reference or a standard is one word.
fn split_words(cell: &str) -> Vec<String> {
    const UNITS: [&str; 6] = ["%", "g", "mm", "um", "µm", "cm"];
    const SIGNS: [char; 8] = [';', ',', '|', ':', '/', '=', '"', '\''];
    let mut words: Vec<String> = Vec::new();
    for word in cell.split_whitespace() {
        match is_date_or_standard(word) {
            true => words.push("date".into()),
            false => words.extend(word.split(SIGNS).filter(|part| !part.is_empty()).map(str::to_owned)),
        }
    }
    words.retain(|word| !UNITS.contains(&word.as_str()));
    words
}

/// `12/03/2024`, `123/45`, `1377-2:1990`.
fn is_date_or_standard(word: &str) -> bool {
    let word = word.trim_matches(|c: char| !c.is_alphanumeric());
    let parts: Vec<&str> = word.split('/').collect();
    let numbers: Vec<u32> = parts.iter().filter_map(|part| part.parse().ok()).collect();
    let is_day = |day: u32, month: u32| (1..=31).contains(&day) && (1..=12).contains(&month);
    let is_date = match (&numbers[..], parts.len()) {
        (&[_, _], 2) => true,
        (&[_, b, c], 3) if parts[0].len() == 4 => is_day(c, b),
        (&[a, b, _], 3) => matches!(parts[2].len(), 2 | 4) && (is_day(a, b) || is_day(b, a)),
        _ => false,
    };
    let is_number = |text: &str| text.len() > 2 && text.bytes().all(|b| b.is_ascii_digit() || b == b'-');
    is_date
        || word.split_once(':').is_some_and(|(standard, year)| {
            is_number(standard) && year.len() == 4 && year.parse::<u32>().is_ok()
        })
}

/// True if two numbers follow each other in a cell: an opening and a value, with or without a name.
fn holds_pair(cell: &str) -> bool {
    let words = split_words(cell);
    let is_number = |word: &String| is_value(word) || opening(word).is_some();
    words.windows(2).any(|pair| pair.iter().all(is_number))
}

/// The cell of a row of text that may be a row of numbers, amid a table or at its end.
pub(super) fn whole_row(row: &GridRow, amid: bool) -> Option<usize> {
    let ends_in_number = |cell: &str| split_words(cell).last().is_some_and(|word| is_value(word));
    let holds_number = |cell: &str| {
        let is_number = || !is_words(cell) || ends_in_number(cell) || holds_pair(cell);
        cell.contains(|c: char| c.is_ascii_digit()) && is_number()
    };
    let is_it = |cell: &str| is_whole_row(cell) || amid && holds_number(cell);
    let alone = row.filled().take(2).count() == 1;
    (is_text(row) && (alone || !amid)).then(|| row.filled().find(|&c| is_it(row.cell(c)))).flatten()
}

/// The only cell of a row of text that may be a row of numbers, directly below a table.
pub(super) fn row_below(row: &GridRow) -> Option<usize> {
    let only = row.filled().next().filter(|_| row.filled().count() == 1 && is_text(row))?;
    holds_pair(row.cell(only)).then_some(only)
}

/// Error for such a row.
pub(super) fn refused(grid: &Grid, row: &GridRow, column: usize) -> TableError {
    let allowed = "a row of the table, its openings and percents parted as in the other rows and not quoted \
                   as a whole";
    grid.refused(row.line, column, FIELDS[0], row.cell(column), allowed)
}

/// Refuses a row of a text that ends before the column `last`: any of its values may be the missing one. The
/// pan and the sum have fewer.
pub(super) fn refuse_short(grid: &Grid, row: &GridRow, size: &str, last: usize) -> Result<(), TableError> {
    let Some(line) = &row.text else { return Ok(()) };
    if line.cells > grid.left + last
        || matches!(opening(size), Some((Opening::Pan | Opening::Total | Opening::Below(_), _)))
    {
        return Ok(());
    }
    Err(TableError::Fields {
        file: grid.place(),
        line: row.line,
        found: line.cells,
        value: shortened(&line.text),
        allowed: "as many as the other rows have, with an empty one where nothing was measured",
    })
}
