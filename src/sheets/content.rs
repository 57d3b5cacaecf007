//! Content of a cell (a percentage, a range, a date, words, nothing), of a row and of a column of such
//! cells. Rows that a mistake has merged into one cell or cut short.

use super::grid::{Grid, GridRow};
use super::size::{Form, Opening, opening, unmarked, with_thousands};
use voidwalk_core::gradation::{FIELDS, TableError, number, shortened};

/// A percentage as laboratories write it: `97`, `97 %`, `97,0%`, `22.7 (1)`; or a mass, such as `1,254.6`.
pub(super) fn percentage(cell: &str) -> Option<f64> {
    let read = |cell: &str| {
        let plain = cell.strip_suffix('%').unwrap_or(cell).trim();
        number(plain).or_else(|| with_thousands(plain))
    };
    read(cell).or_else(|| read(unmarked(cell)))
}

/// Upper bound of a percent, as in `<1`, `< 0.5 %`.
pub(super) fn bound(cell: &str) -> Option<f64> {
    percentage(cell.strip_prefix(['<', '≤'])?.trim())
}

/// The minimum and the maximum allowed by a specification, as in `95-100`, `95 to 100 %`.
pub(super) fn range(cell: &str) -> Option<(f64, f64)> {
    const SIGNS: [&str; 7] = ["-", "–", "—", " to ", " bis ", " à ", " a "];
    let ends = SIGNS.iter().find_map(|sign| cell.split_once(sign));
    let (least, most) = ends.and_then(|(a, b)| Some((percentage(a.trim())?, percentage(b.trim())?)))?;
    (least >= 0.0 && least <= most && most.is_finite()).then_some((least, most))
}

pub(super) fn is_value(cell: &str) -> bool {
    percentage(cell).is_some() || range(cell).is_some()
}

/// True if a cell states that it has no value.
pub(super) fn is_blank(cell: &str) -> bool {
    ["", "-", "–", "—", "n/a", "n.a.", "na", "N/A", "n.d.", "nd"].contains(&cell)
}

/// True for a date: spreadsheets turn `3/8` into one, and a date cell of a workbook ends in a special
/// mark.
pub(super) fn is_date(cell: &str) -> bool {
    const MONTHS: [&str; 12] =
        ["jan", "feb", "mar", "apr", "may", "jun", "jul", "aug", "sep", "oct", "nov", "dec"];
    let small = cell.to_lowercase();
    let parts: Vec<&str> =
        small.split(|c: char| !c.is_alphanumeric()).filter(|part| !part.is_empty()).collect();
    let is_number = |part: &&str| part.bytes().all(|b| b.is_ascii_digit());
    let is_month = |part: &&str| part.is_ascii() && part.len() >= 3 && MONTHS.contains(&&part[..3]);
    small.ends_with("(a date)")
        || (2..=3).contains(&parts.len())
            && parts.iter().any(is_month)
            && parts.iter().all(|part| is_number(part) || is_month(part))
}

/// `Dry mass (g)`, `D10`, `Cu`: words at the beginning of a row below a table, not an opening with a
/// typing error.
pub(super) fn is_words(cell: &str) -> bool {
    const OF_SIEVES: [&str; 14] = [
        "no", "nr", "nº", "n°", "num", "number", "us", "astm", "bs", "sieve", "mesh", "standard", "std",
        "size",
    ];
    let small = cell.to_lowercase();
    if !small.starts_with(char::is_alphabetic) || opening(cell).is_some() || is_date(cell) {
        return false;
    }
    let first: String = small.chars().take_while(|c| c.is_alphabetic()).collect();
    // `D10`, `P80` name sizes of a curve; another letter before a number is a typing error.
    if first.chars().count() == 1 && !["d", "p"].contains(&&*first) && number(&small[first.len()..]).is_some()
    {
        return false;
    }
    let rest = small[first.len()..].trim_start_matches(|c: char| !c.is_alphanumeric());
    !(OF_SIEVES.contains(&first.as_str()) && rest.starts_with(|c: char| c.is_ascii_digit()))
        && cell.contains(|c: char| c.is_alphabetic())
}

/// `No. 4`: an opening, not the heading of a column.
pub(super) fn is_short_opening(cell: &str) -> bool {
    matches!(opening(cell), Some((Opening::Mm(_), Form::UsNumber | Form::Inches)))
}

/// True for an opening in one cell and a value in another, with no words before them.
pub(super) fn is_data(row: &GridRow) -> bool {
    let is_size = |cell: &str| {
        matches!(opening(cell), Some((Opening::Mm(_) | Opening::Bare(_) | Opening::Class(..), _)))
    };
    let mut sizes = row.filled().filter(|&c| is_size(row.cell(c)));
    let (Some(first), more) = (sizes.next(), sizes.next().is_some()) else { return false };
    row.filled().any(|c| (more || c != first) && is_value(row.cell(c)))
}

/// True for numbers after words, as in `Depth (m) | 3.5 | 4.5`, which may be above a table or below it.
pub(super) fn begins_with_words(row: &GridRow) -> bool {
    row.filled().next().is_some_and(|c| is_words(row.cell(c)))
}

/// True if a row contains neither numbers nor openings nor dates.
pub(super) fn is_text(row: &GridRow) -> bool {
    row.filled().all(|c| {
        let cell = row.cell(c);
        let is_opening = opening(cell).is_some_and(|(opening, _)| !matches!(opening, Opening::Class(..)));
        !is_value(cell) && !is_opening && !cell.ends_with("(a date)")
    })
}

/// Properties of a column.
#[derive(Clone, Default)]
pub(super) struct Column {
    /// True if any cell is a number without signs.
    pub(super) with_numbers: bool,
    pub(super) with_values: bool,
    pub(super) with_ranges: bool,
    /// Values minus other cells, without rows of text. Above 0, a cell without a value is refused by name.
    pub(super) balance: i64,
}

/// Properties of each column of some rows, at least `width` columns.
pub(super) fn columns(rows: &[GridRow], width: usize) -> Vec<Column> {
    let width = rows.iter().map(|row| row.cells.len()).max().unwrap_or(0).max(width);
    let mut columns = vec![Column::default(); width];
    for row in rows {
        let is_text = is_text(row);
        for c in row.filled() {
            let (cell, column) = (row.cell(c), &mut columns[c]);
            let is_value = is_value(cell);
            column.with_numbers |= number(cell).is_some();
            column.with_values |= is_value;
            column.with_ranges |= range(cell).is_some();
            column.balance += if is_value { 1 } else { -i64::from(!is_text && !is_blank(cell)) };
        }
    }
    columns
}

/// Splits the values off the end of a cell and counts them, as if other separators were spaces.
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

/// True if a cell contains an opening and values, with another separator or in quotes around the whole row.
fn is_whole_row(cell: &str) -> bool {
    parted(cell).iter().any(|(rest, values)| match rest.is_empty() {
        true => *values > 1,
        false => *values > 0 && opening(rest).is_some(),
    })
}

/// True if a cell ends in several values or contains several openings: a row of a table on its side.
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

/// Finds the cell of a row of text that may be a row of numbers, inside a table or at its end.
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

/// Finds the only cell of a row of text that may be a row of numbers, directly below a table.
pub(super) fn row_below(row: &GridRow) -> Option<usize> {
    let only = row.filled().next().filter(|_| row.filled().count() == 1 && is_text(row))?;
    holds_pair(row.cell(only)).then_some(only)
}

pub(super) fn refused_row(grid: &Grid, row: &GridRow, column: usize) -> TableError {
    let allowed = "a row of the table, its openings and percents split as in the other rows and not quoted \
                   as a whole";
    grid.refused(row.line, column, FIELDS[0], row.cell(column), allowed)
}

/// Refuses a row of a text that ends before the column `last`: any of its values may be missing. The pan
/// and the sum may have fewer.
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn words_are_told_from_openings_with_a_slip_of_the_pen() {
        for words in "Dry mass (g)|D10|Cu|Notes:|LL|w (%)|Fineness modulus|Gs|No data".split('|') {
            assert!(is_words(words), "{words}");
        }
        for other in "O.075|l9|x1.18|4.75*|9.500,00|No. 4|No 4a|US 199|04-Mar|Mar-04||-|Pan|'9.5".split('|') {
            assert!(!is_words(other), "{other}");
        }
    }

    #[test]
    fn ranges_are_read() {
        assert_eq!(range("95-100"), Some((95.0, 100.0)));
        assert_eq!(range("95 to 100 %"), Some((95.0, 100.0)));
        assert_eq!(range("2,5 – 10"), Some((2.5, 10.0)));
        for other in ["-5", "100-95", "5", "2-", "a-b"] {
            assert_eq!(range(other), None, "{other}");
        }
    }
}
