//! Rows that a slip has run together in one cell, or cut short.

use super::content::{is_text, is_value, is_words};
use super::grid::{Grid, GridRow};
use super::size::{Opening, opening};
use crate::gradation::error::{TableError, shortened};
use crate::gradation::sieve::FIELDS;

/// A cell without its values at the end, and how many these are: read as if other separators were spaces.
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

/// Whether a cell holds an opening and values: another separator, or quotes around the whole row.
pub(super) fn is_whole_row(cell: &str) -> bool {
    parted(cell).iter().any(|(rest, values)| match rest.is_empty() {
        true => *values > 1,
        false => *values > 0 && opening(rest).is_some(),
    })
}

/// Whether a cell ends in several values or holds several openings: a row of a table on its side.
pub(super) fn holds_several(cell: &str) -> bool {
    let spaced = cell.replace("  ", ";");
    let parts = spaced.split([';', '\t', '|', '"', ',']).map(str::trim);
    parted(cell).iter().any(|(_, values)| *values > 1)
        || parts.filter(|part| opening(part).is_some()).count() > 2
}

/// The cell of a row of text that may be a row of numbers, amid a table or at its end.
pub(super) fn whole_row(row: &GridRow, amid: bool) -> Option<usize> {
    let ends_in_number = |cell: &str| cell.split_whitespace().next_back().is_some_and(is_value);
    let holds_number =
        |cell: &str| cell.contains(|c: char| c.is_ascii_digit()) && (!is_words(cell) || ends_in_number(cell));
    let is_it = |cell: &str| is_whole_row(cell) || amid && holds_number(cell);
    let alone = row.filled().take(2).count() == 1;
    (is_text(row) && (alone || !amid)).then(|| row.filled().find(|&c| is_it(row.cell(c)))).flatten()
}

/// Refuses such a row.
pub(super) fn refused(grid: &Grid, row: &GridRow, column: usize) -> TableError {
    let allowed = "a row of the table, its openings and percents parted as in the other rows and not quoted \
                   as a whole";
    grid.refused(row.line, column, FIELDS[0], row.cell(column), allowed)
}

/// Refuses a row of a text that ends before the column `last`: any of its values may be the one that is not
/// there. The pan and the sum have fewer.
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
