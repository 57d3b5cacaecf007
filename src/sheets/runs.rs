//! Text of a cell whose parts differ in format: a footnote's raised number and struck-out text are no digits
//! of the number beside them.

use std::mem::take;

/// Appearance of a part.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord)]
pub(super) enum Kind {
    #[default]
    Plain,
    Raised,
    Struck,
}

/// Text so far, and the part that may still go on.
#[derive(Default)]
pub(super) struct Runs {
    text: String,
    part: String,
    kind: Kind,
    format: String,
}

impl Runs {
    /// Appends characters in a format.
    pub(super) fn push(&mut self, more: &str, kind: Kind, format: &str) {
        if (self.kind, self.format.as_str()) != (kind, format) {
            self.close();
            (self.kind, self.format) = (kind, format.to_owned());
        }
        self.part.push_str(more);
    }

    /// Returns the whole text and starts anew.
    pub(super) fn text(&mut self) -> String {
        self.close();
        take(self).text
    }

    fn close(&mut self) {
        let part = take(&mut self.part);
        let last = self.text.chars().next_back();
        let follows_digit = last.is_some_and(|c| c.is_ascii_digit());
        let is_mark = part.contains(char::is_alphanumeric) && !last.is_some_and(char::is_alphabetic);
        self.text += &match self.kind {
            _ if part.trim().is_empty() => part,
            Kind::Struck => format!("[struck out: {}]", part.trim()),
            Kind::Raised if is_mark => format!(" ({})", part.trim()),
            // Digits of two formats may be two numbers.
            _ if follows_digit && part.starts_with(|c: char| c.is_ascii_digit()) => format!("[{part}]"),
            _ => part,
        };
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::content::percentage;

    fn text(parts: &[(&str, Kind, &str)]) -> String {
        let mut runs = Runs::default();
        parts.iter().for_each(|(more, kind, format)| runs.push(more, *kind, format));
        runs.text()
    }

    #[test]
    fn raised_struck_and_glued_digits_are_not_those_of_the_number_beside_them() {
        let plain = |text| (text, Kind::Plain, "");
        assert_eq!(percentage(&text(&[plain("95"), ("1", Kind::Raised, "")])), Some(95.0));
        assert_eq!(percentage(&text(&[plain("95"), ("a", Kind::Raised, "")])), Some(95.0));
        assert_eq!(percentage(&text(&[plain("9"), plain("5"), plain(".5")])), Some(95.5));
        for parts in [
            [("1", Kind::Raised, ""), plain("95")],
            [("97", Kind::Struck, ""), plain("95")],
            [plain("95"), ("7", Kind::Struck, "")],
            [plain("95"), ("1", Kind::Plain, "small")],
            [("", Kind::Plain, ""), ("95", Kind::Struck, "")],
        ] {
            assert_eq!(percentage(&text(&parts)), None, "{parts:?}");
        }
        assert_eq!(text(&[plain("cm"), ("3", Kind::Raised, "")]), "cm3");
    }
}
