//! SVG text: elements, numbers, escaping, and the estimated width of a text.

use std::fmt::Write;

use voidwalk_core::text::visible;

/// Generic families only: a figure looks the same as a file and in a page, and fetches nothing.
pub(super) const FONT: &str = "Helvetica, Arial, 'Liberation Sans', 'DejaVu Sans', sans-serif";

/// Placement of a text: in the middle of, before or behind its anchor.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Anchor {
    Start,
    Middle,
    End,
}

impl Anchor {
    fn word(self) -> &'static str {
        match self {
            Anchor::Start => "start",
            Anchor::Middle => "middle",
            Anchor::End => "end",
        }
    }
}

/// Characters as XML can hold them: markup escaped, hidden ones replaced.
pub fn escape(text: &str) -> String {
    let mut out = String::with_capacity(text.len());
    for character in text.chars() {
        match character {
            '&' => out.push_str("&amp;"),
            '<' => out.push_str("&lt;"),
            '>' => out.push_str("&gt;"),
            '"' => out.push_str("&quot;"),
            '\'' => out.push_str("&#39;"),
            other => out.push(visible(other)),
        }
    }
    out
}

/// Width of a text in pixels, on the generous side: the reader's font is not known here.
pub(super) fn width_of(text: &str, size: f64) -> f64 {
    let em: f64 = text
        .chars()
        .map(|c| match c {
            'i' | 'j' | 'l' | 't' | 'f' | 'r' | 'I' | '.' | ',' | ':' | ';' | '\'' | '|' | '!' | '('
            | ')' | ' ' => 0.33,
            'm' | 'w' | 'M' | 'W' | '%' | '@' => 0.9,
            'A'..='Z' => 0.7,
            c if (c as u32) > 0x2e80 => 1.0,
            _ => 0.57,
        })
        .sum();
    em * size
}

/// The text in lines no wider than `width` pixels, broken at spaces.
pub(super) fn wrap(text: &str, size: f64, width: f64) -> Vec<String> {
    let mut lines: Vec<String> = Vec::new();
    for word in text.split_whitespace() {
        match lines.last_mut() {
            Some(line) if width_of(line, size) + width_of(word, size) + width_of(" ", size) <= width => {
                line.push(' ');
                line.push_str(word);
            }
            _ => lines.push(word.to_owned()),
        }
    }
    lines
}

/// A number with at most two decimals and no trailing zeros.
pub(super) fn short(value: f64) -> String {
    let text = format!("{value:.2}");
    let text = text.trim_end_matches('0').trim_end_matches('.');
    if text == "-0" { "0".to_owned() } else { text.to_owned() }
}

/// Elements, one after another. Only presentation attributes are written, never a `style`: a strict content
/// security policy lets them pass.
#[derive(Default)]
pub(super) struct Svg {
    text: String,
}

impl Svg {
    pub(super) fn raw(&mut self, text: &str) {
        self.text.push_str(text);
    }

    pub(super) fn line(&mut self, from: (f64, f64), to: (f64, f64), paint: &str) {
        let (x1, y1, x2, y2) = (short(from.0), short(from.1), short(to.0), short(to.1));
        let _ = writeln!(self.text, r#"<path d="M{x1} {y1}L{x2} {y2}" fill="none" {paint}/>"#);
    }

    pub(super) fn rect(&mut self, left: f64, top: f64, width: f64, height: f64, paint: &str) {
        let (x, y, w, h) = (short(left), short(top), short(width), short(height));
        let _ = writeln!(self.text, r#"<rect x="{x}" y="{y}" width="{w}" height="{h}" {paint}/>"#);
    }

    pub(super) fn circle(&mut self, (x, y): (f64, f64), radius: f64, paint: &str) {
        let (x, y, radius) = (short(x), short(y), short(radius));
        self.raw(&format!("<circle cx=\"{x}\" cy=\"{y}\" r=\"{radius}\" {paint}/>\n"));
    }

    /// A path through the points, closed or not.
    pub(super) fn path(&mut self, points: &[(f64, f64)], closed: bool, paint: &str) {
        let Some((first, rest)) = points.split_first() else { return };
        let _ = write!(self.text, r#"<path d="M{} {}"#, short(first.0), short(first.1));
        for point in rest {
            let _ = write!(self.text, "L{} {}", short(point.0), short(point.1));
        }
        let _ = writeln!(self.text, r#"{}" {paint}/>"#, if closed { "Z" } else { "" });
    }

    /// Text whose baseline passes through `at`; the content is escaped here and nowhere else.
    pub(super) fn text(&mut self, at: (f64, f64), anchor: Anchor, content: &str, extra: &str) {
        let (x, y, anchor, content) = (short(at.0), short(at.1), anchor.word(), escape(content));
        let _ =
            writeln!(self.text, r#"<text x="{x}" y="{y}" text-anchor="{anchor}" {extra}>{content}</text>"#);
    }

    pub(super) fn finish(self) -> String {
        self.text
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn markup_and_control_characters_become_inert() {
        assert_eq!(escape("<script>\"&'\u{0}\u{202e}"), "&lt;script&gt;&quot;&amp;&#39;\u{fffd}\u{fffd}");
        assert_eq!(escape("a\u{61c}b\u{2067}c"), "a\u{fffd}b\u{fffd}c");
        assert_eq!(escape("Sand 0–2 mm, größer"), "Sand 0–2 mm, größer");
    }

    #[test]
    fn numbers_are_short() {
        assert_eq!(short(1.0), "1");
        assert_eq!(short(-0.001), "0");
        assert_eq!(short(100.25), "100.25");
        assert_eq!(short(100.0), "100");
    }

    #[test]
    fn labels_are_wrapped() {
        assert_eq!(wrap("one two three", 10.0, 40.0), ["one two", "three"]);
        assert_eq!(wrap("", 10.0, 40.0), Vec::<String>::new());
    }
}
