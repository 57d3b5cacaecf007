//! Text that a number format writes before and behind a number, such as the unit in `0" µm"`.

/// A number with the text around it, which may be its unit or a sign such as `<`; grams and percents are left
/// out.
pub(super) fn as_shown(before: &str, number: &str, after: &str) -> String {
    const USUAL: [&str; 11] = ["", "g", "gr", "gm", "gms", "gram", "grams", "gramm", "kg", "%", "pct"];
    let after = match after.trim().trim_end_matches('.').to_lowercase() {
        usual if USUAL.contains(&usual.as_str()) => "",
        _ => after,
    };
    format!("{before}{number}{after}").trim().to_owned()
}

/// Text before the first digit of a number as it is shown, and behind the last.
pub(super) fn around(shown: &str) -> (&str, &str) {
    let is_digit = |c: char| c.is_ascii_digit();
    match (shown.find(is_digit), shown.rfind(is_digit)) {
        (Some(first), Some(last)) => (
            shown[..first].trim_end_matches(['-', '+', '\u{2212}', '.', ',', '(']),
            shown[last + 1..].trim_start_matches(['.', ',', ')']),
        ),
        _ => ("", ""),
    }
}

/// Text that the code of a format writes before a positive number and behind it, and the rest of the code
/// without quoted text, colours and spaces of a character's width.
pub(super) fn parts_of(code: &str) -> (String, String, String) {
    let (mut before, mut after, mut plain) = (String::new(), String::new(), String::new());
    let (mut chars, mut quoted, mut is_first) = (code.chars(), false, true);
    while let Some(c) = chars.next() {
        let literal = match c {
            '"' => {
                quoted = !quoted;
                None
            }
            c if quoted => Some(c),
            '\\' => chars.next(),
            // A space as wide as a character, or a character that fills the cell.
            '_' | '*' => {
                chars.next();
                None
            }
            '[' => {
                chars.by_ref().take_while(|&c| c != ']').for_each(drop);
                None
            }
            ' ' | '<' | '>' => Some(c),
            c => {
                is_first &= c != ';';
                plain.push(c);
                None
            }
        };
        if let Some(c) = literal.filter(|_| is_first) {
            if plain.is_empty() { before.push(c) } else { after.push(c) }
        }
    }
    (before, after, plain)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn units_in_formats_are_kept() {
        let shown = |code: &str| {
            let (before, after, _) = parts_of(code);
            as_shown(&before, "425", &after)
        };
        assert_eq!(
            ["0\" µm\"", "0\\ \\µ\\m", "\"No. \"0", "0.0\" g\"", "0.0_D_M", "0;-0\" in\"", "#,##0.0\"%\""]
                .map(shown),
            ["425 µm", "425 µm", "No. 425", "425", "425", "425", "425"]
        );
        assert_eq!(around("1.180,5 µm"), ("", " µm"));
        assert_eq!(around("-5"), ("", ""));
    }
}
