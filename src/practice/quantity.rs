//! Numbers as text: a quantity has a value, a unit and a role, and every face shows it alike.
//!
//! ```
//! use voidwalk_practice::quantity::{SizeUnit, duration, greatest_length, percent, whole};
//! assert_eq!(percent(0.0666).to_string(), "6.66\u{202f}%");
//! assert_eq!(whole(96_000).to_string(), "96\u{202f}000");
//! assert_eq!(duration(600.0).to_string(), "10.0\u{202f}min");
//! // A limit is rounded to its safe side, in mm and in inches.
//! let most = greatest_length(0.7, SizeUnit::MmAndInches);
//! assert_eq!(most.to_string(), "0.700\u{202f}mm (0.0275\u{202f}in)");
//! ```

use std::fmt;

/// Narrow no-break space: it groups thousands and precedes units. A terminal shows a plain space.
pub const THIN: char = '\u{202f}';

const INCH_MM: f64 = 25.4;

/// Unit of sizes on a sheet.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum SizeUnit {
    /// Multiples of D0F, for cases without a scale.
    D0f,
    /// mm.
    Mm,
    /// mm, followed by inches.
    MmAndInches,
}

impl SizeUnit {
    /// Unit of a scene without a scale, or of a sheet with or without US customary units.
    pub fn of(scale_free: bool, us: bool) -> Self {
        match (scale_free, us) {
            (true, _) => Self::D0f,
            (false, false) => Self::Mm,
            (false, true) => Self::MmAndInches,
        }
    }

    /// Name of the unit after a number.
    pub fn short(self) -> &'static str {
        if self == Self::D0f { "D0F" } else { "mm" }
    }

    /// Name of the unit at the head of a table.
    pub fn name(self) -> &'static str {
        if self == Self::MmAndInches { "mm (in)" } else { self.short() }
    }
}

/// The unit of a number.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Unit {
    /// A ratio or a factor.
    None,
    /// A size.
    Size(SizeUnit),
    /// Percent.
    Percent,
    /// A count of things.
    Count,
    /// Seconds, shown in the unit that fits.
    Seconds,
}

/// Role of a number: a limit is rounded to the safe side.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum NumberRole {
    /// A value.
    Value,
    /// Minimum allowed value, rounded up.
    Least,
    /// Maximum allowed value, rounded down.
    Greatest,
}

impl NumberRole {
    /// Role of a limit.
    pub fn of_limit(at_least: bool) -> Self {
        if at_least { Self::Least } else { Self::Greatest }
    }
}

/// Number of digits shown.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Digits {
    /// Three significant digits; for a percentage one decimal, or two below 10 %.
    Usual,
    /// At most this many significant digits, without trailing zeros.
    Few(u8),
    /// This many decimals.
    Decimals(u8),
    /// Digits of the number as given.
    Given,
}

/// A number with its unit and its role; `Display` renders its text.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Quantity {
    /// The number; percentages are in percent.
    pub(crate) value: f64,
    pub(crate) unit: Unit,
    pub(crate) role: NumberRole,
    digits: Digits,
}

/// Number without a unit: three significant digits, without an exponent between 0.0001 and a million.
pub fn significant(value: f64) -> Quantity {
    Quantity { value, unit: Unit::None, role: NumberRole::Value, digits: Digits::Usual }
}

/// Number without a unit, with its digits as given.
pub fn given(value: f64) -> Quantity {
    Quantity { digits: Digits::Given, ..significant(value) }
}

/// A fraction as a percentage.
pub fn percent(fraction: f64) -> Quantity {
    Quantity { value: 100.0 * fraction, unit: Unit::Percent, ..significant(0.0) }
}

/// Whole number with its thousands grouped.
pub fn whole(number: u64) -> Quantity {
    Quantity { value: number as f64, unit: Unit::Count, ..significant(0.0) }
}

/// Time in seconds.
pub fn duration(seconds: f64) -> Quantity {
    Quantity { unit: Unit::Seconds, ..significant(seconds) }
}

/// Size in a unit.
pub fn length(value: f64, unit: SizeUnit) -> Quantity {
    Quantity { unit: Unit::Size(unit), ..significant(value) }
}

/// Minimum allowed size.
pub fn least_length(value: f64, unit: SizeUnit) -> Quantity {
    length(value, unit).role(NumberRole::Least)
}

/// Maximum allowed size.
pub fn greatest_length(value: f64, unit: SizeUnit) -> Quantity {
    length(value, unit).role(NumberRole::Greatest)
}

impl Quantity {
    /// Sets the role.
    pub fn role(self, role: NumberRole) -> Self {
        Self { role, ..self }
    }

    /// Sets the unit.
    pub fn in_unit(self, unit: Unit) -> Self {
        Self { unit, ..self }
    }

    /// Shows at most this many significant digits, without trailing zeros.
    pub fn in_digits(self, digits: u8) -> Self {
        Self { digits: Digits::Few(digits), ..self }
    }

    /// Shows this many decimals.
    pub fn decimals(self, decimals: u8) -> Self {
        Self { digits: Digits::Decimals(decimals), ..self }
    }

    /// Range from this number to another in the same unit.
    pub fn to(self, high: Self) -> Span {
        Span { low: self, high }
    }

    /// Digits without the unit.
    pub fn number(self) -> String {
        let Self { value, unit, role, digits } = self;
        match (unit, role, digits) {
            (Unit::Count, ..) => grouped(value),
            (Unit::Seconds, ..) => seconds(value).0,
            (_, NumberRole::Value, Digits::Few(digits)) => few_digits(value, digits),
            (_, role, Digits::Few(digits)) => {
                few_digits(within(value, i32::from(digits), role == NumberRole::Least), digits)
            }
            (_, _, Digits::Decimals(decimals)) => fixed(value, usize::from(decimals)),
            (_, _, Digits::Given) => as_given(value),
            (Unit::Percent, NumberRole::Value, Digits::Usual) => percent_digits(value),
            (_, NumberRole::Value, Digits::Usual) => three_digits(value),
            (_, role, Digits::Usual) => three_digits(within(value, 3, role == NumberRole::Least)),
        }
    }

    /// Digits, with inches if the unit shows them, but without the unit's name: for a table cell whose
    /// head names the unit.
    pub fn in_cell(self) -> String {
        self.number() + &self.inches_text()
    }

    /// Size for a table cell whose head names both units, with at most three digits.
    pub(crate) fn in_both_units(self) -> String {
        let few = self.in_digits(3);
        match self.unit {
            Unit::Size(SizeUnit::MmAndInches) => {
                format!("{} ({})", few.number(), few_digits(self.value / INCH_MM, 3))
            }
            _ => few.number(),
        }
    }

    /// Number as its text shows it: inches follow from the mm beside them wherever both appear.
    fn shown(self) -> f64 {
        self.number().parse().unwrap_or(self.value)
    }

    /// Digits of the inches, if the unit shows them; for a limit, no more generous than the mm shown.
    fn inches(self) -> Option<String> {
        (self.unit == Unit::Size(SizeUnit::MmAndInches)).then(|| {
            let mm = if self.role == NumberRole::Value { self.value } else { self.shown() };
            significant(mm / INCH_MM).role(self.role).number()
        })
    }

    fn inches_text(self) -> String {
        self.inches().map_or_else(String::new, |inches| bracket(&inches))
    }

    fn unit_text(self) -> String {
        match self.unit {
            Unit::None | Unit::Count => String::new(),
            Unit::Size(unit) => format!("{THIN}{}", unit.short()),
            Unit::Percent => format!("{THIN}%"),
            Unit::Seconds => format!("{THIN}{}", seconds(self.value).1),
        }
    }
}

impl fmt::Display for Quantity {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.pad(&format!("{}{}{}", self.number(), self.unit_text(), self.inches_text()))
    }
}

/// Range between two numbers of the same unit: both numbers with the unit once, or one number if they
/// read alike.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Span {
    pub(crate) low: Quantity,
    pub(crate) high: Quantity,
}

impl Span {
    /// Digits, with inches if the unit shows them, but without the name of the unit.
    pub fn in_cell(self) -> String {
        self.text("")
    }

    fn text(self, unit: &str) -> String {
        let inches = self.low.inches().zip(self.high.inches());
        let inches = inches.map_or_else(String::new, |(low, high)| bracket(&joined(low, high)));
        format!("{}{unit}{inches}", joined(self.low.number(), self.high.number()))
    }
}

impl fmt::Display for Span {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.pad(&self.text(&self.high.unit_text()))
    }
}

fn joined(low: String, high: String) -> String {
    if low == high { high } else { format!("{low} to {high}") }
}

fn bracket(inches: &str) -> String {
    format!(" ({inches}{THIN}in)")
}

/// Minimum and maximum size in mm, each rounded to its safe side.
pub fn limits(least: f64, greatest: f64, unit: SizeUnit) -> Span {
    least_length(least, unit).to(greatest_length(greatest, unit))
}

/// Range of sizes in mm in which tests located a boundary, with ends rounded outward.
pub fn range_of_tests(low: f64, high: f64, unit: SizeUnit) -> Span {
    greatest_length(low, unit).to(least_length(high, unit))
}

/// A value and its limit, if known, with enough digits to tell them apart: a value beyond a limit never
/// reads as within it, nor the reverse. The limit is never shown more generous than it is. A ratio has no
/// trailing zeros: 4.00 times D85B is shown as 4.
pub fn beside_limit(numbers: [Option<f64>; 2], at_least: bool, unit: Unit) -> [Option<String>; 2] {
    both_beside(numbers, at_least, unit, Quantity::unit_text)
}

/// Does the same as [`beside_limit`] for table cells whose head names the unit.
pub fn beside_limit_in_cells(numbers: [Option<f64>; 2], at_least: bool, unit: Unit) -> [Option<String>; 2] {
    both_beside(numbers, at_least, unit, |_| String::new())
}

fn both_beside(
    numbers: [Option<f64>; 2],
    at_least: bool,
    unit: Unit,
    named: impl Fn(Quantity) -> String,
) -> [Option<String>; 2] {
    let [value, limit] = numbers.map(|number| number.map(|number| significant(number).in_unit(unit)));
    let limit = limit.map(|limit| limit.role(NumberRole::of_limit(at_least)));
    let (Some(value), Some(limit)) = (value, limit) else {
        let alone = |number: Quantity| {
            let digits = match number.role {
                NumberRole::Value => digits_of(number.value, DIGITS),
                _ => digits_within(number.value, DIGITS, at_least),
            };
            without_zeros(&digits, unit).to_owned() + &named(number) + &number.inches_text()
        };
        return [value.map(alone), limit.map(alone)];
    };
    let texts = apart(value.value, limit.value, at_least);
    let both = [(&texts[0], value), (&texts[1], limit)];
    let [of_value, of_limit] = both.map(|(text, number)| text.parse().unwrap_or(number.value) / INCH_MM);
    let inches = match unit {
        Unit::Size(SizeUnit::MmAndInches) => {
            apart(of_value, of_limit, at_least).map(|inches| bracket(&inches))
        }
        _ => Default::default(),
    };
    let [of_value, of_limit] =
        both.map(|(text, number)| without_zeros(text, unit).to_owned() + &named(number));
    [Some(of_value + &inches[0]), Some(of_limit + &inches[1])]
}

/// Digits of a value and a limit, unless more are needed to tell them apart.
const DIGITS: i32 = 3;

/// Maximum number of digits tried to tell two numbers apart.
const MOST_DIGITS: i32 = 9;

/// Removes trailing zeros from a number, unless it is a size.
fn without_zeros(number: &str, unit: Unit) -> &str {
    match unit {
        Unit::None | Unit::Percent if number.contains('.') => {
            number.trim_end_matches('0').trim_end_matches('.')
        }
        _ => number,
    }
}

/// Rounds a limit to a whole number: a minimum up, a maximum down. A limit that is whole except for a
/// rounding error keeps its value.
fn whole_within(limit: f64, at_least: bool) -> f64 {
    const HAIR: f64 = 1e-9;
    if at_least { (limit * (1.0 - HAIR)).ceil() } else { (limit * (1.0 + HAIR)).floor() }
}

/// A value and its limit with enough digits to tell them apart; two equal numbers get enough digits to
/// read the same.
fn apart(value: f64, limit: f64, at_least: bool) -> [String; 2] {
    let pair = |digits| [digits_of(value, digits), digits_within(limit, digits, at_least)];
    let is_order =
        |[shown, limit_shown]: &[String; 2]| match (shown.parse::<f64>(), limit_shown.parse::<f64>()) {
            (Ok(shown), Ok(limit_shown)) => shown != limit_shown && (shown < limit_shown) == (value < limit),
            _ => shown != limit_shown,
        };
    // A limit that is just reached is kept, and the value reads as elsewhere.
    let alike = || (DIGITS..MOST_DIGITS).map(pair).find(|[shown, limit_shown]| shown == limit_shown);
    let cut = || [value, limit].map(|number| digits_within(number, DIGITS, at_least));
    let apart = (DIGITS..MOST_DIGITS).filter(|_| value != limit).map(pair).find(is_order);
    apart.or_else(alike).unwrap_or_else(cut)
}

/// Number with this many significant digits, without an exponent.
fn digits_of(value: f64, digits: i32) -> String {
    if value == 0.0 || !value.is_finite() {
        return value.to_string();
    }
    format!("{value:.*}", decimals_of(value, digits))
}

/// Decimals of a number with this many significant digits, up to the maximum shown.
fn decimals_of(value: f64, digits: i32) -> usize {
    places(value, digits).clamp(0, digits + 4) as usize
}

/// Decimal place of the last of this many significant digits; digits before the point are kept.
fn places(value: f64, digits: i32) -> i32 {
    (digits - 1 - libm::floor(libm::log10(value.abs())) as i32).max(0)
}

/// Rounds a limit inward to this many digits: a maximum down, a minimum up.
fn within(limit: f64, digits: i32, at_least: bool) -> f64 {
    if limit <= 0.0 || !limit.is_finite() {
        return limit;
    }
    let parts = libm::pow(10.0, f64::from(places(limit, digits)));
    whole_within(limit * parts, at_least) / parts
}

fn digits_within(limit: f64, digits: i32, at_least: bool) -> String {
    let shown = within(limit, digits, at_least);
    // Decimals are those of the unrounded limit: rounding up to a power of ten does not change them.
    if shown > 0.0 { format!("{shown:.*}", decimals_of(limit, digits)) } else { digits_of(shown, digits) }
}

/// Three significant digits, without an exponent between 0.0001 and a million.
fn three_digits(value: f64) -> String {
    if value == 0.0 {
        return "0".to_owned();
    }
    let magnitude = libm::floor(libm::log10(value.abs()));
    if !magnitude.is_finite() {
        return if value.is_nan() { "unknown".to_owned() } else { "unlimited".to_owned() };
    }
    if !(-4.0..6.0).contains(&magnitude) {
        return format!("{value:.2e}");
    }
    let rounded = |magnitude: f64| format!("{value:.*}", (2.0 - magnitude).max(0.0) as usize);
    let text = rounded(magnitude);
    // Rounding gives 9.999 one digit more before the point.
    let size = text.parse().map_or(magnitude, |shown: f64| libm::floor(libm::log10(shown.abs())));
    if size > magnitude { rounded(size) } else { text }
}

fn few_digits(value: f64, digits: u8) -> String {
    if !(1e-4..1e6).contains(&value.abs()) {
        return three_digits(value);
    }
    let scale = libm::pow(10.0, f64::from(digits) - 1.0 - libm::floor(libm::log10(value.abs())));
    ((value * scale).round() / scale).to_string()
}

fn fixed(value: f64, decimals: usize) -> String {
    if value.abs() < 1e7 { format!("{value:.decimals$}") } else { as_given(value) }
}

fn as_given(value: f64) -> String {
    match value.abs() {
        0.0 => "0".into(),
        size if (1e-12..1e16).contains(&size) => value.to_string(),
        size if size.is_finite() => format!("{value:e}"),
        _ => "an unknown number of".into(),
    }
}

/// One decimal, two below 10. Values too small to show, and values too close to 100, are marked by `<`
/// and `>`.
fn percent_digits(percent: f64) -> String {
    match percent.abs() {
        0.0 => "0.0".into(),
        least if least < 0.005 => "<0.01".into(),
        below_ten if below_ten < 9.995 => format!("{percent:.2}"),
        nearly_all if (99.95..100.0).contains(&nearly_all) => ">99.9".into(),
        _ => format!("{percent:.1}"),
    }
}

/// Thousands are grouped from five digits on.
fn grouped(value: f64) -> String {
    let digits = format!("{value:.0}");
    if digits.len() < 5 {
        return digits;
    }
    let mut out = String::new();
    for (index, digit) in digits.chars().enumerate() {
        if index > 0 && (digits.len() - index).is_multiple_of(3) {
            out.push(THIN);
        }
        out.push(digit);
    }
    out
}

fn seconds(seconds: f64) -> (String, &'static str) {
    if seconds < 100.0 {
        (three_digits(seconds), "s")
    } else if seconds < 6000.0 {
        (format!("{:.1}", seconds / 60.0), "min")
    } else {
        (format!("{:.1}", seconds / 3600.0), "h")
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn texts<const N: usize>(quantities: [Quantity; N]) -> [String; N] {
        quantities.map(|quantity| quantity.to_string().replace(THIN, " "))
    }

    #[test]
    fn digits_are_sensible() {
        let shown = texts([1.0, 0.16044, 12.345, 1234.5, 0.000_012, 2e9, 0.0, 9.999].map(significant));
        assert_eq!(shown, ["1.00", "0.160", "12.3", "1234", "1.20e-5", "2.00e9", "0", "10.0"]);
        assert_eq!(significant(f64::INFINITY).to_string(), "unlimited");
        let few = [19.05, 0.075, 0.6, 4.0, 25.896, 100.0, 1e-7].map(|value| significant(value).in_digits(3));
        assert_eq!(texts(few), ["19.1", "0.075", "0.6", "4", "25.9", "100", "1.00e-7"]);
        assert_eq!(significant(19.05).in_digits(4).to_string(), "19.05");
        assert_eq!(texts([9313, 96_000, 200_000_000].map(whole)), ["9313", "96 000", "200 000 000"]);
        assert_eq!(texts([12.34, 600.0, 7200.0].map(duration)), ["12.3 s", "10.0 min", "2.0 h"]);
    }

    #[test]
    fn limits_are_rounded_inward() {
        let rounded = |role| move |limit: f64| significant(limit).role(role);
        let down = texts([0.7, 0.2859, 12.39, 0.07, 0.0].map(rounded(NumberRole::Greatest)));
        assert_eq!(down, ["0.700", "0.285", "12.3", "0.0700", "0"]);
        let up = texts([0.14, 0.2851, 0.9999, 12.31].map(rounded(NumberRole::Least)));
        assert_eq!(up, ["0.140", "0.286", "1.00", "12.4"]);
        // A table and a sentence beside it show the same limit.
        for step in 0..4000 {
            let limit = 0.001 * libm::pow(1.003, f64::from(step));
            for at_least in [false, true] {
                let shown = significant(limit).role(NumberRole::of_limit(at_least)).number();
                let alone = digits_within(limit, 3, at_least);
                assert_eq!(shown.parse::<f64>().unwrap(), alone.parse::<f64>().unwrap(), "{limit}");
            }
        }
    }

    #[test]
    fn inches_of_a_limit_lie_within_it_and_within_the_mm_beside_them() {
        let unit = SizeUnit::MmAndInches;
        let steps = (1..4000).map(|step| 0.01 * libm::pow(1.003, f64::from(step)));
        for limit in steps.chain([0.7, 0.14, 1.6812, 2.9970, 25.4, 0.701]) {
            for (role, sign) in [(NumberRole::Greatest, 1.0), (NumberRole::Least, -1.0)] {
                let size = length(limit, unit).role(role);
                let inches = size.inches().unwrap().parse::<f64>().unwrap() * INCH_MM;
                let hair = 1e-8 * limit;
                assert!(sign * (inches - size.shown()) <= hair && sign * (inches - limit) <= hair, "{size}");
                // Rounding the mm shown again gives the same text.
                assert_eq!(length(size.shown(), unit).role(role).to_string(), size.to_string());
            }
        }
        assert_eq!(greatest_length(0.7, unit).in_cell(), "0.700 (0.0275\u{202f}in)");
        assert_eq!(least_length(0.14, unit).in_cell(), "0.140 (0.00552\u{202f}in)");
        assert_eq!(limits(0.14, 0.7, SizeUnit::Mm).to_string(), "0.140 to 0.700\u{202f}mm");
        assert_eq!(limits(0.14, 0.7, unit).in_cell(), "0.140 to 0.700 (0.00552 to 0.0275\u{202f}in)");
        assert_eq!(length(0.82, SizeUnit::D0f).to_string(), "0.820\u{202f}D0F");
    }

    #[test]
    fn a_percentage_never_rounds_to_nothing_or_to_all() {
        let shown = [0.0, 0.000_01, 0.004_2, 0.0751, 0.099_99, 0.4312, 0.999_9, 1.0].map(percent);
        let expected = ["0.0 %", "<0.01 %", "0.42 %", "7.51 %", "10.0 %", "43.1 %", ">99.9 %", "100.0 %"];
        assert_eq!(texts(shown), expected);
    }

    #[test]
    fn a_value_beyond_its_limit_reads_as_beyond_it_and_one_within_as_within() {
        let pair = |value, limit| apart(value, limit, false);
        assert_eq!(pair(4.0004, 4.0), ["4.0004", "4.0000"]);
        assert_eq!(pair(3.9996, 4.0), ["3.9996", "4.0000"]);
        assert_eq!(pair(3.52, 4.0), ["3.52", "4.00"]);
        // Rounded to nearest, the limit would also be 2.86.
        assert_eq!(pair(2.8572, 2.857), ["2.86", "2.85"]);
        // If a limit is just reached, both numbers have enough digits that neither is rounded up.
        assert_eq!(pair(2.8571, 2.8571), ["2.857", "2.857"]);
        assert_eq!(pair(2.8579, 2.8579), ["2.8579", "2.8579"]);
        assert_eq!(pair(20.0 / 7.0 - 1e-9, 20.0 / 7.0 - 1e-9), ["2.857", "2.857"]);
        assert_eq!(pair(2.0 / 3.0, 2.0 / 3.0), ["0.666", "0.666"]);
        assert_eq!(apart(0.1399, 0.14, true), ["0.1399", "0.1400"]);
        for step in 0..2000 {
            let limit = 0.05 * libm::pow(1.005, f64::from(step % 700));
            for at_least in [false, true] {
                for part in [1e-2, 1e-3, 1e-4, 1e-6, -1e-2, -1e-3, -1e-4, -1e-6] {
                    let value = limit * (1.0 + part);
                    let [shown, most] =
                        apart(value, limit, at_least).map(|text| text.parse::<f64>().unwrap());
                    let is_order = shown != most && (shown < most) == (value < limit);
                    assert!(is_order, "{value} {limit}: {shown} {most}");
                    let hair = limit * 1e-8;
                    assert!(if at_least { most >= limit - hair } else { most <= limit + hair });
                }
            }
        }
        let ratio = beside_limit([Some(3.9), Some(4.0)], false, Unit::None);
        assert_eq!(ratio.map(Option::unwrap), ["3.9", "4"]);
    }
}
