//! Signs within or behind a number that are no part of its value: signs of thousands, marks of footnotes.

/// A number in which one sign separates thousands and the other decimals: `1,254.6`, `1.254,6`.
pub(super) fn with_thousands(text: &str) -> Option<f64> {
    let at = text.rfind(['.', ','])?;
    let (whole, decimals) = (&text[..at], &text[at + 1..]);
    let sign = if text[at..].starts_with('.') { ',' } else { '.' };
    let is_digits = |text: &str| !text.is_empty() && text.bytes().all(|b| b.is_ascii_digit());
    let mut groups = whole.split(sign);
    let first =
        groups.next().filter(|first| is_digits(first) && first.len() <= 3 && !first.starts_with('0'))?;
    let rest: Vec<&str> = groups.collect();
    let is_grouped = !rest.is_empty() && rest.iter().all(|group| is_digits(group) && group.len() == 3);
    (is_grouped && is_digits(decimals))
        .then(|| format!("{first}{}.{decimals}", rest.concat()).parse().ok())?
}

/// A cell without the mark of a footnote behind it: `0.075*`, `22.7 (1)`, `11.3 (a)`.
pub(super) fn unmarked(cell: &str) -> &str {
    let bare = cell.trim_end_matches(['*', '†', '‡']).trim_end();
    let is_mark = |mark: &str| mark.len() == 1 && mark.bytes().all(|b| b.is_ascii_alphanumeric());
    match bare.strip_suffix(')').and_then(|rest| rest.rsplit_once('(')) {
        Some((rest, mark)) if is_mark(mark) && !rest.trim().is_empty() => rest.trim_end(),
        _ => bare,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn thousands_and_footnotes_are_told_from_numbers() {
        assert_eq!(
            ["1,254.6", "1.254,6", "12,345,678.9"].map(with_thousands),
            [Some(1254.6), Some(1254.6), Some(12345678.9)]
        );
        assert_eq!(
            ["1,254", "1254.6", "0,254.6", "1,25.6", "1,254.", "1.2,3"].map(with_thousands),
            [None; 6]
        );
        assert_eq!(
            ["0.075*", "22.7 (1)", "11.3(a)**", "5 (No. 4)", "(1)"].map(unmarked),
            ["0.075", "22.7", "11.3", "5 (No. 4)", "(1)"]
        );
    }
}
