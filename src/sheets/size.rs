//! A cell that names an opening: a number, a number with its unit, a US sieve, the pan.

use super::languages::{PAN, TOTAL, Words};
use voidwalk_core::gradation::number;
use voidwalk_core::schema::length::fraction;

/// US sieves by number, and their openings in mm (ASTM E11).
const BY_NUMBER: [(&str, f64); 34] = [
    ("3 1/2", 5.6),
    ("3.5", 5.6),
    ("4", 4.75),
    ("5", 4.0),
    ("6", 3.35),
    ("7", 2.8),
    ("8", 2.36),
    ("10", 2.0),
    ("12", 1.7),
    ("14", 1.4),
    ("16", 1.18),
    ("18", 1.0),
    ("20", 0.85),
    ("25", 0.71),
    ("30", 0.6),
    ("35", 0.5),
    ("40", 0.425),
    ("45", 0.355),
    ("50", 0.3),
    ("60", 0.25),
    ("70", 0.212),
    ("80", 0.18),
    ("100", 0.15),
    ("120", 0.125),
    ("140", 0.106),
    ("170", 0.09),
    ("200", 0.075),
    ("230", 0.063),
    ("270", 0.053),
    ("325", 0.045),
    ("400", 0.038),
    ("450", 0.032),
    ("500", 0.025),
    ("635", 0.02),
];

/// US sieves by inches, and their openings in mm (ASTM E11).
const BY_INCHES: [(f64, f64); 19] = [
    (5.0, 125.0),
    (4.0, 100.0),
    (3.5, 90.0),
    (3.0, 75.0),
    (2.5, 63.0),
    (2.0, 50.0),
    (1.75, 45.0),
    (1.5, 37.5),
    (1.25, 31.5),
    (1.0, 25.0),
    (0.875, 22.4),
    (0.75, 19.0),
    (0.625, 16.0),
    (0.5, 12.5),
    (0.4375, 11.2),
    (0.375, 9.5),
    (0.3125, 8.0),
    (0.25, 6.3),
    (12.0, 300.0),
];

/// Unit of numbers without one.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Unit {
    Mm,
    Cm,
    Micrometre,
    Inch,
    Phi,
    SieveNumber,
}

/// Meaning of a cell with an opening.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Opening {
    /// An opening in mm.
    Mm(f64),
    /// A number in the column's unit.
    Bare(f64),
    /// Finer than this opening (mm), as in `< 0.075`: the pan below it, or the fraction that passes it.
    Below(f64),
    /// Between two openings, as in `9.5-4.75`: the larger, infinite for `> 9.5`, and the smaller.
    Class(f64, f64),
    /// Mass that passed the finest sieve.
    Pan,
    Total,
}

/// A row of the table, not yet in percent finer.
pub(super) struct Entry {
    pub(super) line: usize,
    pub(super) column: usize,
    pub(super) opening: Opening,
    pub(super) text: String,
    pub(super) form: Form,
    pub(super) value: f64,
}

/// Form in which an opening was written, beyond its number.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(super) enum Form {
    Plain,
    /// A number with a unit that is not inches.
    WithUnit,
    UsNumber,
    Inches,
}

/// True if a text names mass washed out of a sample before sieving.
pub(super) fn is_washed(text: &str) -> bool {
    static NAMES: Words =
        Words::of("fines washed out|washed out|loss by washing|loss on washing|lost by washing|washing loss");
    let small = text.to_lowercase();
    let name = small.trim_end_matches([' ', ':', '.']);
    NAMES.has(name.strip_suffix("(g)").unwrap_or(name).trim())
}

/// `Total`, `Total dry mass before washing`.
fn is_sum(text: &str) -> bool {
    const MORE: [&str; 8] = ["mass", "weight", "dry", "sample", "of", "soil", "before", "washing"];
    let mut words = text.split_whitespace();
    ["total", "totals", "sum"].contains(&words.next().unwrap_or_default())
        && words.all(|word| MORE.contains(&word))
}

/// Reads the opening named by a cell; `None` for anything else.
pub(super) fn opening(text: &str) -> Option<(Opening, Form)> {
    if let Some(value) = number(text) {
        return Some((Opening::Bare(value), Form::Plain));
    }
    let text = text.to_lowercase().replace('\u{a0}', " ");
    let text = text.trim();
    let (before, within) = text.split_once('(').unwrap_or((text, ""));
    let is_unit = |word: &str| ["g", "kg", "gr", "grams"].contains(&word.trim_matches([')', ' ']));
    let plain = if within.contains('%') || is_unit(within) { text } else { before };
    let plain = plain.trim_end_matches([' ', ':', '.', ',']);
    static ENGLISH: Words = Words::of("pan|the pan|bottom|receiver|rest|tray|base pan");
    if ENGLISH.has(plain.trim_start_matches("bottom ")) || PAN.has(plain) || is_washed(text) {
        return Some((Opening::Pan, Form::Plain));
    }
    if is_sum(plain) || TOTAL.has(plain) {
        return Some((Opening::Total, Form::Plain));
    }
    if let Some(rest) =
        ["<", "≤", "pass ", "passing ", "finer than ", "minus "].iter().find_map(|p| text.strip_prefix(p))
    {
        return match opening(rest.trim())? {
            (Opening::Mm(mm) | Opening::Bare(mm), form) => Some((Opening::Below(mm), form)),
            _ => None,
        };
    }
    let minus = text.strip_prefix('-').and_then(us).filter(|(_, form)| *form == Form::UsNumber);
    if let Some((Opening::Mm(mm), form)) = minus {
        return Some((Opening::Below(mm), form));
    }
    let read = metric(text).map(|mm| (Opening::Mm(mm), Form::WithUnit)).or_else(|| us(text));
    read.or_else(|| class(text)).or_else(|| {
        let bare = unmarked(text);
        if bare == text { None } else { opening(bare) }
    })
}

/// Size named by a cell, in mm or in the column's unit, if it is above 0.
pub(super) fn positive_size(cell: &str) -> Option<f64> {
    match opening(cell)?.0 {
        Opening::Mm(size) | Opening::Bare(size) if size > 0.0 => Some(size),
        _ => None,
    }
}

/// Particles between two sieves: `9.5-4.75`, `4.75 to 2 mm`, `-No. 4 +No. 10`, `> 19`.
fn class(text: &str) -> Option<(Opening, Form)> {
    let sieve = |text: &str| match opening(text.trim())? {
        (Opening::Mm(size) | Opening::Bare(size), form) if size >= 0.0 => Some((size, form)),
        _ => None,
    };
    if let Some(rest) = [">=", ">", "≥", "coarser than "].iter().find_map(|sign| text.strip_prefix(sign)) {
        return sieve(rest).map(|(lower, form)| (Opening::Class(f64::INFINITY, lower), form));
    }
    let passed = text.strip_prefix('-').and_then(|rest| rest.split_once('+'));
    let ends = passed.or_else(|| {
        const SIGNS: [&str; 7] = ["-", "–", "—", "~", " to ", " bis ", " à "];
        SIGNS.iter().find_map(|sign| text.split_once(sign))
    });
    let (first, second) = ends?;
    let (lower, form) = sieve(second)?;
    // The unit may appear only once, at the end.
    let unit = second.trim_start_matches(|c: char| !c.is_alphabetic());
    let with_unit = || if form > Form::Plain { sieve(&format!("{first} {unit}")) } else { None };
    let is_bare = |form: Form| form == Form::Plain;
    let (upper, _) = sieve(first).filter(|(_, other)| is_bare(*other) == is_bare(form)).or_else(with_unit)?;
    (upper != lower).then_some((Opening::Class(upper.max(lower), upper.min(lower)), form))
}

/// Relative difference below which openings of old and new standards are equal, such as 4.76 and 4.75 mm.
const NEAR: f64 = 0.07;

/// True if two openings (mm) belong to one sieve.
pub(super) fn near(one: f64, other: f64) -> bool {
    (one - other).abs() <= NEAR * one.max(other)
}

pub(super) fn goes_one_way(sizes: &[f64]) -> bool {
    sizes.is_sorted_by(|a, b| a > b) || sizes.is_sorted_by(|a, b| a < b)
}

/// Maximum length in bytes of another name of a sieve, such as `US Standard Sieve No. 4`.
const LONGEST_NAME: usize = 32;

/// `9.5 mm`, also within `No. 4 (4.75 mm)`, if both names belong to one sieve; `75 um`.
fn metric(text: &str) -> Option<f64> {
    const UNITS: [(&str, f64); 14] = [
        ("mm", 1.0),
        ("мм", 1.0),
        ("мкм", 1e3),
        ("millimet", 1.0),
        ("um", 1e3),
        ("µm", 1e3),
        ("μm", 1e3),
        ("micron", 1e3),
        ("micromet", 1e3),
        ("mikrom", 1e3),
        ("mym", 1e3),
        ("µ", 1e3),
        ("μ", 1e3),
        ("cm", 0.1),
    ];
    UNITS.iter().find_map(|(unit, per_mm)| {
        let (before, after) = text.split_once(unit)?;
        let digits_from = before.trim_end().rfind(|c: char| !(c.is_ascii_digit() || ".,".contains(c)));
        let from = digits_from.map_or(0, |at| at + before[at..].chars().next().map_or(1, char::len_utf8));
        let lead = before[..from].trim();
        let good_lead = lead.is_empty() || lead.ends_with('(') || lead.ends_with('=') || lead.ends_with('/');
        let rest = after.trim_start_matches(|c: char| c.is_alphabetic()).trim();
        let good_rest = rest.is_empty() || rest == ")" || rest.starts_with('(') || rest == "sieve";
        if !good_lead || !good_rest {
            return None;
        }
        let mm = number(before[from..].trim())? / per_mm;
        let others = [lead, rest].map(|other| other.trim_matches(['(', ')', '=', '/', ' ']));
        let disagrees = |other: &str| {
            other.len() > LONGEST_NAME
                || matches!(opening(other), Some((Opening::Mm(named), _)) if !near(named, mm))
        };
        (!others.into_iter().any(disagrees)).then_some(mm)
    })
}

/// `No. 4`, `#200`, `200 mesh`, `3/8"`, `1 1/2 in`.
fn us(text: &str) -> Option<(Opening, Form)> {
    let (mut text, mut is_us) = (text, false);
    for lead in ["u.s. ", "us ", "uss ", "u.s.", "astm ", "sieve ", "standard ", "std ", "std. ", "sieve "] {
        let rest = text.strip_prefix(lead).map(str::trim);
        is_us |= rest.is_some() && lead.starts_with('u');
        text = rest.unwrap_or(text);
    }
    for end in ["sieve", "(us)", "(u.s.)"] {
        let rest = text.strip_suffix(end).map(str::trim);
        is_us |= rest.is_some() && end.starts_with('(');
        text = rest.unwrap_or(text);
    }
    const LEADS: [&str; 12] =
        ["no.", "no ", "no", "nº", "n°", "№", "nr.", "nr ", "num.", "number ", "#", "mesh "];
    let alone = us_sieve_number(text).filter(|_| is_us);
    let led = || LEADS.iter().find_map(|lead| us_sieve_number(text.strip_prefix(lead)?.trim()));
    let ended = || ["mesh", "#"].iter().find_map(|end| us_sieve_number(text.strip_suffix(end)?.trim()));
    if let Some(mm) = alone.or_else(led).or_else(ended) {
        return Some((Opening::Mm(mm), Form::UsNumber));
    }
    const MARKS: [&str; 13] =
        ["\"", "''", "″", "”", "“", "’’", "inches", "inch", "in.", "in", "zoll", "pouces", "-in."];
    let marked =
        MARKS.iter().find_map(|mark| text.strip_suffix(mark)).map(|rest| rest.trim_end_matches('-').trim());
    let inches = match marked {
        Some(rest) => inches_of(rest)?,
        None if text.contains(['/', '½', '¼', '¾', '⅜', '⅝', '⅞', '⅛']) => inches_of(text)?,
        None => return None,
    };
    Some((Opening::Mm(of_inches(inches)), Form::Inches))
}

/// Inches as decimals or a fraction; `11/2` may mean 1 1/2 without its space.
fn inches_of(text: &str) -> Option<f64> {
    let is_run_together = text.split_once('/').is_some_and(|(above, _)| {
        let above = above.trim_start_matches(['-', ' ']);
        above.len() > 1 && above.bytes().all(|b| b.is_ascii_digit())
    });
    fraction(text, number).filter(|&inches| !is_run_together || inches < 1.0)
}

/// Name of the US sieve with this opening (mm), by ASTM E11: `No. 4`, `3/8 in`; `None` if there is none.
///
/// ```
/// use voidwalk_sheets::us_sieve;
/// assert_eq!([4.75, 9.5, 37.5].map(|mm| us_sieve(mm).unwrap()), ["No. 4", "3/8 in", "1 1/2 in"]);
/// assert_eq!(us_sieve(4.0001), None);
/// ```
pub fn us_sieve(mm: f64) -> Option<String> {
    let is_it = |opening: f64| (opening - mm).abs() < 1e-9 * mm;
    if let Some((name, _)) = BY_NUMBER.iter().find(|(_, opening)| is_it(*opening)) {
        return Some(format!("No. {name}"));
    }
    let (inches, _) = BY_INCHES.iter().find(|(_, opening)| is_it(*opening))?;
    let (whole, mut above, mut below) = (inches.floor(), inches.fract() * 16.0, 16.0);
    while above > 0.0 && above % 2.0 == 0.0 {
        (above, below) = (above / 2.0, below / 2.0);
    }
    Some(match (whole > 0.0, above > 0.0) {
        (true, true) => format!("{whole} {above}/{below} in"),
        (true, false) => format!("{whole} in"),
        (false, _) => format!("{above}/{below} in"),
    })
}

/// Opening (mm) of the US sieve with this number.
pub(super) fn us_sieve_number(text: &str) -> Option<f64> {
    BY_NUMBER.iter().find(|(name, _)| *name == text).map(|(_, mm)| *mm)
}

/// Opening (mm) of a sieve named by inches: the standard opening if the series has one.
fn of_inches(inches: f64) -> f64 {
    let standard = BY_INCHES.iter().find(|(named, _)| (named - inches).abs() < 1e-9);
    standard.map_or(inches * 25.4, |(_, mm)| *mm)
}

/// True if an opening (mm) given in inches is that of a US sieve.
pub(super) fn is_us_sieve_of_inches(mm: f64) -> bool {
    BY_INCHES.iter().any(|(_, opening)| *opening == mm)
}

impl Unit {
    /// Converts a number without a unit to a size in mm.
    pub(super) fn mm(self, value: f64) -> Option<f64> {
        match self {
            Unit::Mm => Some(value),
            Unit::Cm => Some(value * 10.0),
            Unit::Micrometre => Some(value / 1e3),
            Unit::Inch => Some(of_inches(value)),
            Unit::Phi => Some(libm::exp2(-value)),
            Unit::SieveNumber => us_sieve_number(&value.to_string()),
        }
    }
}

/// Reads a number with one sign for thousands and another for decimals: `1,254.6`, `1.254,6`.
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

/// Removes a footnote mark from the end of a cell: `0.075*`, `22.7 (1)`, `11.3 (a)`.
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
    fn openings_are_read_as_laboratories_write_them() {
        for (mm, texts) in [
            (4.75, "No. 4|No. 4 (4.75 mm)|4.75 mm (No. 4)|US 4"),
            (4.76, "No. 4 (4.76 mm)"),
            (0.42, "No. 40 (0.42 mm)"),
            (0.425, "no 40|425 um (0.425 mm)|US Standard Sieve 40"),
            (0.25, "US No. 60"),
            (0.075, "No.200|#200|200 mesh|75 µm|75um|US Sieve No. 200|USS #200"),
            (0.075, "Sieve 200 (US)|No. 200*|0.075 mm (1)"),
            (0.063, "63 microns"),
            (2.0, "# 10"),
            (75.0, "3\""),
            (37.5, "1 1/2\"|1-1/2 in.|1½\""),
            (19.0, "¾ in|3/4 in. (19.0 mm)"),
            (9.5, "3/8|3/8 inch|3/8-in.|0.375\"|9.5 mm|9,5mm"),
            (152.39999999999998, "6 in"),
            (20.0, "2 cm"),
        ] {
            for text in texts.split('|') {
                assert_eq!(opening(text).map(|(opening, _)| opening), Some(Opening::Mm(mm)), "{text}");
            }
        }
        assert_eq!(opening("0,5"), Some((Opening::Bare(0.5), Form::Plain)));
        for pan in ["Pan", "Pan (dry)", "bottom pan", "Receptáculo", "Siebpfanne:", "底盘", "受け皿"] {
            assert_eq!(opening(pan), Some((Opening::Pan, Form::Plain)), "{pan}");
        }
        assert_eq!(opening("0.075*"), Some((Opening::Bare(0.075), Form::Plain)));
        assert_eq!(opening("-#200"), Some((Opening::Below(0.075), Form::UsNumber)));
        for (class, bounds, form) in [
            ("9.5-4.75", (9.5, 4.75), Form::Plain),
            ("9.5 - 4.75 mm", (9.5, 4.75), Form::WithUnit),
            ("3/4 in - 3/8 in", (19.0, 9.5), Form::Inches),
            ("-3/8 in +No. 4", (9.5, 4.75), Form::UsNumber),
            ("> 9.5", (f64::INFINITY, 9.5), Form::Plain),
        ] {
            assert_eq!(opening(class), Some((Opening::Class(bounds.0, bounds.1), form)), "{class}");
        }
        assert_eq!(opening("< 0.075 mm"), Some((Opening::Below(0.075), Form::WithUnit)));
        let all = "Rest (%)|US 199|2026-03-14|BH-1|No. 3|#|project no. 4|mm|sixty|3/0\"|8-Mar|1 3/2\"|\
            x9.5 mm|No. 40 (0.245 mm)|No. 30 (0.06 mm)|0.6 mm (No. 40)|3/8 in (19 mm)|\
            425 um (0.245 mm)|";
        for text in all.split('|') {
            assert_eq!(opening(text), None, "{text}");
        }
        for (inches, mm) in BY_INCHES {
            let name = us_sieve(mm).unwrap();
            assert_eq!(opening(&name), Some((Opening::Mm(mm), Form::Inches)), "{name}: {inches}");
        }
        for (_, mm) in BY_NUMBER {
            assert_eq!(opening(&us_sieve(mm).unwrap()), Some((Opening::Mm(mm), Form::UsNumber)), "{mm}");
        }
        assert_eq!(us_sieve(7.0), None);
        assert_eq!(Unit::Phi.mm(-2.0), Some(4.0));
        assert_eq!(Unit::SieveNumber.mm(200.0), Some(0.075));
        assert_eq!(Unit::SieveNumber.mm(4.75), None);
    }

    #[test]
    fn thousands_and_footnotes_are_told_from_numbers() {
        let read = ["1,254.6", "1.254,6", "12,345,678.9"].map(with_thousands);
        assert_eq!(read, [1254.6, 1254.6, 12345678.9].map(Some));
        for other in ["1,254", "1254.6", "0,254.6", "1,25.6", "1,254.", "1.2,3"] {
            assert_eq!(with_thousands(other), None, "{other}");
        }
        let bare = ["0.075*", "22.7 (1)", "11.3(a)**", "5 (No. 4)", "(1)"].map(unmarked);
        assert_eq!(bare, ["0.075", "22.7", "11.3", "5 (No. 4)", "(1)"]);
    }
}
