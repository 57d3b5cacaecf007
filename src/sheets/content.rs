//! Content of one cell (a percentage, a range, a date, words, nothing) and of a row of such cells.

use super::grid::GridRow;
use super::marks::{unmarked, with_thousands};
use super::size::{Form, Opening, opening};
use voidwalk_core::gradation::number;

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

/// The least and the most that a specification allows, as in `95-100`, `95 to 100 %`.
pub(super) fn range(cell: &str) -> Option<(f64, f64)> {
    const SIGNS: [&str; 7] = ["-", "–", "—", " to ", " bis ", " à ", " a "];
    let ends = SIGNS.iter().find_map(|sign| cell.split_once(sign));
    let (least, most) = ends.and_then(|(a, b)| Some((percentage(a.trim())?, percentage(b.trim())?)))?;
    (least >= 0.0 && least <= most && most.is_finite()).then_some((least, most))
}

/// A percentage, or a range of them.
pub(super) fn is_value(cell: &str) -> bool {
    percentage(cell).is_some() || range(cell).is_some()
}

/// True if a cell says that it holds no value.
pub(super) fn is_blank(cell: &str) -> bool {
    ["", "-", "–", "—", "n/a", "n.a.", "na", "N/A", "n.d.", "nd"].contains(&cell)
}

/// True for a date: spreadsheets turn `3/8` into one, and a date cell of a workbook ends in a mark of its
/// own.
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

/// `Dry mass (g)`, `D10`, `Cu`: words at the beginning of a row below a table, rather than an opening with a
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

/// True for an opening in one cell and a value in another, without words before them.
pub(super) fn is_data(row: &GridRow) -> bool {
    let is_size = |cell: &str| {
        matches!(opening(cell), Some((Opening::Mm(_) | Opening::Bare(_) | Opening::Class(..), _)))
    };
    let mut sizes = row.filled().filter(|&c| is_size(row.cell(c)));
    let (Some(first), more) = (sizes.next(), sizes.next().is_some()) else { return false };
    row.filled().any(|c| (more || c != first) && is_value(row.cell(c)))
}

/// True for numbers behind words, as in `Depth (m) | 3.5 | 4.5`, which may lie above a table or below it.
pub(super) fn begins_with_words(row: &GridRow) -> bool {
    row.filled().next().is_some_and(|c| is_words(row.cell(c)))
}

/// True if a row holds neither numbers nor openings nor dates.
pub(super) fn is_text(row: &GridRow) -> bool {
    row.filled().all(|c| {
        let cell = row.cell(c);
        let is_opening = opening(cell).is_some_and(|(opening, _)| !matches!(opening, Opening::Class(..)));
        !is_value(cell) && !is_opening && !cell.ends_with("(a date)")
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn words_are_told_from_openings_with_a_slip_of_the_pen() {
        for words in
            ["Dry mass (g)", "D10", "Cu", "Notes:", "LL", "w (%)", "Fineness modulus", "Gs", "No data"]
        {
            assert!(is_words(words), "{words}");
        }
        for other in [
            "O.075", "l9", "x1.18", "4.75*", "9.500,00", "No. 4", "No 4a", "US 199", "04-Mar", "Mar-04", "",
            "-", "Pan", "'9.5",
        ] {
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
