//! Inches behind lengths in mm, in sentences and on pages that are made.

use super::numbers::SizeUnit;

/// What may stand between a number and its unit.
const SPACES: [char; 3] = [' ', '\u{202f}', '\u{a0}'];

/// What stands between the ends of a range that share one unit.
const BETWEEN: [&str; 2] = [" to ", " and "];

/// What stands before the ends of a band: its first is a least size, its second a greatest.
const OF_BAND: [&str; 3] = ["from ", "between ", "D15F "];

/// What a limit is called before its number; the last of them in its clause counts.
const LIMITS: [(&str, Limit); 24] = [
    ("least", Limit::Least),
    ("minimum", Limit::Least),
    ("down to", Limit::Least),
    ("≥", Limit::Least),
    // The least itself is not known: what it is at most is no less than it.
    ("not known, and at most", Limit::Least),
    ("D15B;", Limit::Least),
    ("not known. It is at most", Limit::Least),
    ("greatest", Limit::Greatest),
    ("maximum", Limit::Greatest),
    ("at most", Limit::Greatest),
    ("D15F less than", Limit::Greatest),
    ("to be less than", Limit::Greatest),
    ("not stated: less than", Limit::Greatest),
    ("up to", Limit::Greatest),
    ("limit of design is", Limit::Greatest),
    ("limit is", Limit::Greatest),
    ("limit of practice is", Limit::Greatest),
    ("(design) is", Limit::Greatest),
    ("within", Limit::Greatest),
    ("more than", Limit::Greatest),
    ("beyond", Limit::Greatest),
    ("below a D15F of", Limit::Greatest),
    ("no erosion lower, at", Limit::Greatest),
    ("limit", Limit::Greatest),
];

/// Ends of clauses; behind a limit the size of the filter is none.
const ENDS: [&str; 5] = ["; ", ". ", ", D15F ", ", and ", ": D15F "];

/// Which limit a length is, so that its inches do not go beyond it.
#[derive(Clone, Copy)]
enum Limit {
    Least,
    Greatest,
}

/// A sentence with inches behind every length in mm; of a range that has one unit, of both ends.
///
/// Inches of a greatest size are rounded down and those of a least size up, from the mm that stand there.
///
/// ```
/// use voidwalk::outcome::with_inches;
/// assert_eq!(with_inches("D15F up to 0.7 mm"), "D15F up to 0.7 mm (0.0275\u{202f}in)");
/// assert_eq!(with_inches("a grain of 0.7 mm"), "a grain of 0.7 mm (0.0276\u{202f}in)");
/// assert_eq!(with_inches("0.25 to 1.1 mm"), "0.25 to 1.1 mm (0.00984 to 0.0433\u{202f}in)");
/// assert_eq!(with_inches("2 mm\u{b2}"), "2 mm\u{b2}");
/// ```
pub fn with_inches(sentence: &str) -> String {
    let (mut out, mut rest) = (String::new(), sentence);
    while let Some(at) = rest.find("mm") {
        let (before, after) = (&rest[..at], &rest[at + 2..]);
        out += &rest[..at + 2];
        rest = after;
        let ends = !after.starts_with(|c: char| c.is_alphanumeric() || "²³_/".contains(c));
        let number = before.strip_suffix(SPACES).filter(|_| ends && !has_inches(after));
        if let Some((number, length)) = number.and_then(|text| Some((text, last_number(text)?))) {
            out += &behind(number, length, after);
        }
    }
    out + rest
}

/// Whether inches stand there already.
fn has_inches(after: &str) -> bool {
    let bracket = after.strip_prefix(" (").and_then(|inner| inner.split_once(')'));
    bracket.is_some_and(|(inner, _)| inner.ends_with("in") && inner.starts_with(|c: char| c.is_ascii_digit()))
}

/// The inches of the length at the end of a text, and of the other end of its range.
fn behind(text: &str, (mm, at): (f64, usize), after: &str) -> String {
    let before = BETWEEN.iter().find_map(|between| text[..at].strip_suffix(between).map(|of| (of, between)));
    let other = before.and_then(|(of, between)| {
        let (low, start) = last_number(of)?;
        // "Of 3 and 5 mm" may be anything.
        let is_range = *between == " to " || of[..start].ends_with("between ");
        let is_band = OF_BAND.iter().any(|before| of[..start].ends_with(before));
        is_range.then_some((low, between, is_band))
    });
    match other {
        Some((low, between, is_band)) => {
            let low = inches(low, is_band.then_some(Limit::Least));
            let low = low.trim_start_matches(" (").split(SPACES).next().unwrap_or_default().to_owned();
            let high = inches(mm, is_band.then_some(Limit::Greatest));
            high.replacen(" (", &format!(" ({low}{between}"), 1)
        }
        None => inches(mm, limit(&text[..at], after)),
    }
}

fn inches(mm: f64, limit: Option<Limit>) -> String {
    let unit = SizeUnit::MmAndInches;
    match limit {
        Some(Limit::Least) => unit.beside_least(mm),
        Some(Limit::Greatest) => unit.beside_greatest(mm),
        None => unit.beside(mm),
    }
}

/// Which limit a number is, by the words around it; `None` where it is none.
fn limit(before: &str, after: &str) -> Option<Limit> {
    let behind = [
        (" or more", Limit::Least),
        (" at the least", Limit::Least),
        (" or less", Limit::Greatest),
        (" at most", Limit::Greatest),
    ];
    if let Some((_, limit)) = behind.into_iter().find(|(words, _)| after.starts_with(words)) {
        return Some(limit);
    }
    let clause = ENDS.iter().filter_map(|end| before.rfind(end)).max().unwrap_or(0);
    let called = |(words, limit): &(&str, Limit)| {
        let at = before.rfind(words)?;
        let end = at + words.len();
        (end > clause).then_some((end, words.len(), *limit))
    };
    LIMITS.iter().filter_map(called).max_by_key(|(end, length, _)| (*end, *length)).map(|(.., limit)| limit)
}

/// The number at the end of a text, and where it begins; thousands may stand apart by a narrow space.
fn last_number(text: &str) -> Option<(f64, usize)> {
    let is_part = |c: char| c.is_ascii_digit() || c == '.' || c == '\u{202f}';
    let start = text.trim_end_matches(is_part).len();
    let number = text[start..].trim_start_matches('\u{202f}');
    let start = text.len() - number.len();
    // Not the number of a name, as of D15.
    let is_alone = !text[..start].ends_with(|c: char| c.is_alphanumeric() || c == '-' || c == '+');
    let value = number.replace('\u{202f}', "").parse().ok().filter(|value| *value > 0.0)?;
    is_alone.then_some((value, start))
}

/// What keeps its words: figures, what no reader sees, and the small print with formulas and sources.
const KEPT: [(&str, &str); 4] =
    [("<svg", "</svg"), ("<style", "</style"), ("<title", "</title"), ("<span class=\"small\"", "</span")];

/// A page with inches behind every length in mm of its words, figures and small print apart.
pub fn page_with_inches(page: &str) -> String {
    let (mut out, mut rest, mut hidden) = (String::new(), page, None);
    while let Some(at) = rest.find('<') {
        let end = rest[at..].find('>').map_or(rest.len(), |end| at + end + 1);
        let (words, tag) = (&rest[..at], &rest[at..end]);
        out += &if hidden.is_some() { words.to_owned() } else { with_inches(words) };
        out += tag;
        hidden = match hidden {
            Some(end) if tag.starts_with(end) => None,
            Some(end) => Some(end),
            None => KEPT.into_iter().find(|(begin, _)| tag.starts_with(begin)).map(|(_, end)| end),
        };
        rest = &rest[end..];
    }
    out + rest
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_length_has_inches_once_and_nothing_else_has() {
        for (text, said) in [
            ("D15F up to 0.700 mm (practice)", "D15F up to 0.700 mm (0.0275\u{202f}in) (practice)"),
            ("25.4\u{202f}mm", "25.4\u{202f}mm (1.00\u{202f}in)"),
            (
                "must lie between 0.14 and 0.7 mm.",
                "must lie between 0.14 and 0.7 mm (0.00552 and 0.0275\u{202f}in).",
            ),
            ("of No. 4 and 0.5 mm", "of No. 4 and 0.5 mm (0.0197\u{202f}in)"),
            ("1\u{202f}270 mm", "1\u{202f}270 mm (50.0\u{202f}in)"),
        ] {
            assert_eq!(with_inches(text), said);
            assert_eq!(with_inches(said), said, "twice");
        }
        for text in ["size (mm)", "D15 mm", "0 mm", "5 mm/s", "1e-5 mm", "summary", ""] {
            assert_eq!(with_inches(text), text);
        }
    }

    /// 0.14 mm are 0.005512 inches, and 0.7 mm 0.02756.
    #[test]
    fn inches_of_limits_are_rounded_inward_and_of_other_lengths_to_the_nearest() {
        let (up, down, low, nearest) = ["0.00552", "0.0275", "0.00551", "0.0276"].into();
        for (text, of_range, inches) in [
            ("D15F from 0.14 to 0.7 mm, the coarse side", up, down),
            ("take a coarser filter, D15F 0.14 to 0.7 mm", up, down),
            ("between 0.14 and 0.7 mm", up, down),
            ("ASTM C33 fine aggregate, D15 0.14 to 0.7 mm: fits", low, nearest),
            ("D15F must be at least 0.14 mm to drain it and at most 0.7 mm to retain it.", up, down),
            ("The least is not known. It is at most 0.14 mm, and D15F must be at most 0.7 mm", up, down),
            ("the minimum that drains is not known, and at most 0.14 mm: D15F up to 0.7 mm", up, down),
            ("≥ 5 D15B; 0.14 mm is enough, D15F is to be less than 0.7 mm", up, down),
            ("the minimum D15F is 0.14 mm, the maximum 0.7 mm", up, down),
            ("D15F 0.14 mm or more; limit of design is 0.7 mm", up, down),
            ("the greatest is not known; D85B 0.14 mm, D95B 0.7 mm", low, nearest),
            ("      minimum D15F of the band: 0.14 mm; maximum D60F: 0.7 mm", up, down),
        ] {
            let said = with_inches(text);
            assert!(said.contains(&format!("({of_range}")), "{said}");
            assert!(said.contains(&format!("{inches}\u{202f}in)")), "{said}");
        }
    }

    #[test]
    fn a_page_keeps_its_figures_and_its_tags() {
        let page = "<title>2 mm</title><p title=\"2 mm\">2 mm</p><svg><text>2 mm</text></svg>\
            <span class=\"small\">A/25 + 0.7 mm</span><td>0.5 mm</td>";
        let said = page_with_inches(page);
        assert!(said.starts_with("<title>2 mm</title><p title=\"2 mm\">2 mm (0.0787\u{202f}in)</p><svg>"));
        assert!(said.ends_with("+ 0.7 mm</span><td>0.5 mm (0.0197\u{202f}in)</td>"), "{said}");
    }
}
