//! Meanings of a comma within a number.

/// Meaning of the comma in a number.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Comma {
    /// A decimal sign.
    Decimal,
    /// A decimal sign, or one between thousands, as in `1,180`.
    Either,
}

/// Reads the only comma of the number in a text, such as `1,180 um`.
pub fn comma(text: &str) -> Option<Comma> {
    let at = text.find(',')?;
    let before = text[..at].bytes().rev().take_while(u8::is_ascii_digit).count();
    let after = text[at + 1..].bytes().take_while(u8::is_ascii_digit).count();
    let first = text.as_bytes()[at - before];
    let ends = text[at + 1 + after..].starts_with([',', '.']);
    match (before, after) {
        _ if ends || text[at + 1..].contains(',') => None,
        (0, _) | (_, 0) => None,
        (1..=3, 3) if first != b'0' => Some(Comma::Either),
        _ => Some(Comma::Decimal),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn three_digits_behind_a_comma_may_be_thousands() {
        for text in ["1,180", "100,000", "1,180 um", "1,000%"] {
            assert_eq!(comma(text), Some(Comma::Either), "{text}");
        }
        for text in ["0,180", "1,18", "1180,000", "97,5 %", "4,75 mm"] {
            assert_eq!(comma(text), Some(Comma::Decimal), "{text}");
        }
        for text in ["1180", "1,", ",5", "No. 4, fine", "1,000,000", "Dam, north"] {
            assert_eq!(comma(text), None, "{text}");
        }
    }
}
