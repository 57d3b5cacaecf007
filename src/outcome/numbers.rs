//! Numbers as a reader wants them: sensible digits, grouped thousands, units.
//!
//! ```
//! use voidwalk::outcome::numbers::{duration, significant, whole};
//! assert_eq!([significant(0.16044), significant(2e9)], ["0.160", "2.00e9"]);
//! assert_eq!([whole(9313), whole(96_000)], ["9313", "96\u{202f}000"]);
//! assert_eq!([duration(12.34), duration(600.0)], ["12.3\u{202f}s", "10.0\u{202f}min"]);
//! ```

pub use super::apart::whole_within;
use super::apart::{value_and_limit, within};
use super::record::Statistic;

/// A narrow space that no line breaks at: it groups thousands and stands before units.
const THIN: char = '\u{202f}';

/// A value, or that it is not given.
pub fn known<T>(value: Option<T>, words: impl FnOnce(T) -> String) -> String {
    value.map_or_else(|| "not given".to_owned(), words)
}

/// Three significant digits, without an exponent between 0.0001 and a million.
pub fn significant(value: f64) -> String {
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
    // 9.999 has one digit more before the point once it is rounded.
    let size = text.parse().map_or(magnitude, |shown: f64| libm::floor(libm::log10(shown.abs())));
    if size > magnitude { rounded(size) } else { text }
}

/// The same without zeros behind the last digit that is not zero.
pub fn trimmed_significant(value: f64) -> String {
    let text = significant(value);
    if text.contains('.') && !text.contains('e') {
        text.trim_end_matches('0').trim_end_matches('.').to_owned()
    } else {
        text
    }
}

/// A number with this many decimals.
pub(crate) fn fixed(value: f64, decimals: usize) -> String {
    if value.abs() < 1e7 { format!("{value:.decimals$}") } else { given(value) }
}

/// A number as it was given.
pub(crate) fn given(value: f64) -> String {
    match value.abs() {
        0.0 => "0".into(),
        size if (1e-12..1e16).contains(&size) => value.to_string(),
        size if size.is_finite() => format!("{value:e}"),
        _ => "an unknown number of".into(),
    }
}

/// A greatest value: three significant digits, rounded down.
pub fn rounded_down(value: f64) -> String {
    significant(within(value, 3, false))
}

/// A least value: three significant digits, rounded up.
pub fn rounded_up(value: f64) -> String {
    significant(within(value, 3, true))
}

/// A whole number with its thousands apart.
pub fn whole(value: u64) -> String {
    let digits = value.to_string();
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

/// The digits of a percentage: one decimal, two below one percent and near the 7.5 % that divides the
/// classes; what is there but rounds to nothing says so.
fn percent_digits(fraction: f64) -> String {
    let percent = fraction * 100.0;
    if percent > 0.0 && percent < 0.005 {
        "<0.01".to_owned()
    } else if (0.005..0.995).contains(&percent) || (7.0..8.0).contains(&percent) {
        format!("{percent:.2}")
    } else if (99.95..100.0).contains(&percent) {
        ">99.9".to_owned()
    } else {
        format!("{percent:.1}")
    }
}

/// A fraction as a percentage.
pub fn percent(fraction: f64) -> String {
    format!("{}{THIN}%", percent_digits(fraction))
}

/// The threshold between the classes as a percentage, no digit more than it has.
pub fn threshold(fraction: f64) -> String {
    format!("{}{THIN}%", trimmed(fraction * 100.0))
}

/// The 95 % interval of a fraction, where there is one; one number where both ends read alike.
pub fn percent_interval(statistic: &Statistic) -> Option<String> {
    let (low, high) = interval(statistic)?;
    Some(match (percent_digits(low), percent_digits(high)) {
        (low, high) if low == high => format!("{low}{THIN}%"),
        (low, high) => format!("{low} to {high}{THIN}%"),
    })
}

/// The interval of a fraction, kept within 0 and 1.
pub fn interval(statistic: &Statistic) -> Option<(f64, f64)> {
    Some((statistic.low?.clamp(0.0, 1.0), statistic.high?.clamp(0.0, 1.0)))
}

/// The interval of a fraction in percent, kept within 0 and 100.
pub fn interval_in_percent(statistic: &Statistic) -> Option<(f64, f64)> {
    interval(statistic).map(|(low, high)| (100.0 * low, 100.0 * high))
}

/// A factor or a limit with no digit more than it needs.
pub fn trimmed(factor: f64) -> String {
    let text = format!("{factor:.3}");
    text.trim_end_matches('0').trim_end_matches('.').to_owned()
}

/// A number with at most this many digits that mean something, and no zeros at the end.
pub fn in_digits(value: f64, digits: u8) -> String {
    if !(1e-4..1e6).contains(&value) {
        return significant(value);
    }
    let scale = libm::pow(10.0, f64::from(digits) - 1.0 - libm::floor(libm::log10(value)));
    format!("{}", (value * scale).round() / scale)
}

/// A size with its unit: mm, or multiples of D0F when nothing has a scale.
pub fn size(value: f64, scale_free: bool) -> String {
    format!("{}{THIN}{}", significant(value), size_unit(scale_free))
}

/// The unit of sizes.
pub fn size_unit(scale_free: bool) -> &'static str {
    if scale_free { "D0F" } else { "mm" }
}

/// What sizes on a sheet are shown in.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum SizeUnit {
    /// Multiples of D0F, where nothing has a scale.
    D0f,
    /// mm.
    Mm,
    /// mm, and inches behind them.
    MmAndInches,
}

impl SizeUnit {
    /// The unit of a scene without a scale, or of a sheet with or without US customary units.
    pub fn of(scale_free: bool, us: bool) -> Self {
        match (scale_free, us) {
            (true, _) => Self::D0f,
            (false, false) => Self::Mm,
            (false, true) => Self::MmAndInches,
        }
    }

    /// Its name at the head of a table.
    pub fn name(self) -> &'static str {
        match self {
            Self::D0f | Self::Mm => size_unit(self == Self::D0f),
            Self::MmAndInches => "mm (in)",
        }
    }

    /// A size with at most three digits that mean something; in inches, too, where those are shown.
    pub fn digits(self, value: f64) -> String {
        let shown = in_digits(value, 3);
        match self {
            Self::D0f | Self::Mm => shown,
            Self::MmAndInches => format!("{shown} ({})", in_digits(value / INCH_MM, 3)),
        }
    }

    /// A size with its unit, and in inches, too, where those are shown.
    pub fn size(self, value: f64) -> String {
        size(value, self == Self::D0f) + &self.beside(value)
    }

    /// What stands behind a size in mm: inches, where those are shown.
    pub fn beside(self, mm: f64) -> String {
        self.bracket(significant(mm / INCH_MM))
    }

    /// What stands behind a greatest size, of which [`rounded_down`] shows the mm: inches of no more than
    /// those mm.
    pub fn beside_greatest(self, mm: f64) -> String {
        self.bracket(rounded_down(shown(&rounded_down(mm), mm) / INCH_MM))
    }

    /// What stands behind a least size, of which [`rounded_up`] shows the mm: inches of no less than those
    /// mm.
    pub fn beside_least(self, mm: f64) -> String {
        self.bracket(rounded_up(shown(&rounded_up(mm), mm) / INCH_MM))
    }

    /// What stands behind a size and its limit, a least or a greatest, both in mm: inches that are as far
    /// apart, and those of the limit within it.
    pub(crate) fn beside_both(self, mm: f64, limit: f64, at_least: bool) -> [String; 2] {
        value_and_limit(mm / INCH_MM, limit / INCH_MM, at_least, 3).map(|inches| self.bracket(inches))
    }

    /// A size in mm and the greatest that it may be, as far as they are known, each with this name of the
    /// unit: with as many digits as tell them apart, and inches that follow from those mm.
    pub(crate) fn within(self, [mm, limit]: [Option<f64>; 2], name: &str) -> [Option<String>; 2] {
        let (Some(size), Some(most)) = (mm, limit) else {
            let alone = mm.map(|mm| format!("{}{name}{}", significant(mm), self.beside(mm)));
            let limit = limit.map(|mm| format!("{}{name}{}", rounded_down(mm), self.beside_greatest(mm)));
            return [alone, limit];
        };
        let texts = value_and_limit(size, most, false, 3);
        let [size, most] = [shown(&texts[0], size), shown(&texts[1], most)];
        let mut both = texts.into_iter().zip(self.beside_both(size, most, false));
        std::array::from_fn(|_| both.next().map(|(mm, inches)| format!("{mm}{name}{inches}")))
    }

    /// A least and a greatest size in mm, each rounded to its safe side.
    pub fn limits(self, least: f64, most: f64) -> String {
        let [low, high] = [rounded_up(least), rounded_down(most)];
        let [shown_low, shown_high] = [shown(&low, least), shown(&high, most)];
        let inches = format!("{} to {}", rounded_up(shown_low / INCH_MM), rounded_down(shown_high / INCH_MM));
        format!("{low} to {high} {}{}", size_unit(self == Self::D0f), self.bracket(inches))
    }

    /// A range of sizes in mm that tests left, with ends rounded outward.
    pub fn range_of_tests(self, low: f64, high: f64) -> String {
        let inches = format!("{} to {}", rounded_down(low / INCH_MM), rounded_up(high / INCH_MM));
        let unit = size_unit(self == Self::D0f);
        format!("{} to {} {unit}{}", rounded_down(low), rounded_up(high), self.bracket(inches))
    }

    /// What stands behind a range of sizes in mm, where inches are shown.
    pub fn beside_range(self, from: f64, to: f64) -> String {
        self.bracket(format!("{} to {}", significant(from / INCH_MM), significant(to / INCH_MM)))
    }

    /// A size without its unit, and its inches.
    pub fn short(self, mm: f64) -> String {
        significant(mm) + &self.beside(mm)
    }

    /// A greatest size without its unit, and its inches.
    pub fn greatest(self, mm: f64) -> String {
        rounded_down(mm) + &self.beside_greatest(mm)
    }

    /// A least size without its unit, and its inches.
    pub fn least(self, mm: f64) -> String {
        rounded_up(mm) + &self.beside_least(mm)
    }

    /// A limit with its unit, a least or a greatest, and its inches.
    pub fn limit(self, value: f64, at_least: bool) -> String {
        let name = size_unit(self == Self::D0f);
        match at_least {
            true => format!("{} {name}{}", rounded_up(value), self.beside_least(value)),
            false => format!("{} {name}{}", rounded_down(value), self.beside_greatest(value)),
        }
    }

    fn bracket(self, inches: String) -> String {
        match self {
            Self::D0f | Self::Mm => String::new(),
            Self::MmAndInches => format!(" ({inches}{THIN}in)"),
        }
    }
}

/// A number as its text has it, so that inches follow from the mm beside them, wherever both stand.
fn shown(text: &str, value: f64) -> f64 {
    text.parse().unwrap_or(value)
}

/// Millimetres of an inch.
const INCH_MM: f64 = 25.4;

/// A time in seconds, in the unit that fits.
pub fn duration(seconds: f64) -> String {
    if seconds < 100.0 {
        format!("{}{THIN}s", significant(seconds))
    } else if seconds < 6000.0 {
        format!("{:.1}{THIN}min", seconds / 60.0)
    } else {
        format!("{:.1}{THIN}h", seconds / 3600.0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::outcome::apart::digits_within;

    #[test]
    fn digits_are_sensible() {
        let texts: Vec<String> = [1.0, 0.16044, 12.345, 1234.5, 0.000_012, 2e9, 0.0].map(significant).into();
        assert_eq!(texts, ["1.00", "0.160", "12.3", "1234", "1.20e-5", "2.00e9", "0"]);
        assert_eq!(significant(f64::INFINITY), "unlimited");
    }

    #[test]
    fn limits_are_rounded_inward() {
        let down = [0.7, 0.2859, 12.39, 0.07, 0.0].map(rounded_down);
        assert_eq!(down, ["0.700", "0.285", "12.3", "0.0700", "0"]);
        assert_eq!([0.14, 0.2851, 0.9999, 12.31].map(rounded_up), ["0.140", "0.286", "1.00", "12.4"]);
        // A table and a sentence beside it have one limit.
        for step in 0..4000 {
            let limit = 0.001 * libm::pow(1.003, f64::from(step));
            let both = [rounded_down(limit), rounded_up(limit)].map(|text| text.parse::<f64>().unwrap());
            let digits = [false, true].map(|at_least| digits_within(limit, 3, at_least));
            assert_eq!(digits.map(|text| text.parse::<f64>().unwrap()), both, "{limit}");
        }
    }

    #[test]
    fn inches_of_a_limit_lie_within_it_and_within_the_mm_beside_them() {
        let unit = SizeUnit::MmAndInches;
        let mm_of = |beside: &str| {
            let inches = beside.trim_start_matches(" (").split(THIN).next().unwrap();
            inches.parse::<f64>().unwrap() * INCH_MM
        };
        let limits = (1..4000).map(|step| 0.01 * libm::pow(1.003, f64::from(step)));
        for limit in limits.chain([0.7, 0.14, 1.6812, 2.9970, 25.4, 0.701]) {
            let [down, up] = [rounded_down(limit), rounded_up(limit)].map(|mm| mm.parse::<f64>().unwrap());
            let [most, least] = [unit.beside_greatest(limit), unit.beside_least(limit)];
            let (hair, [below, above]) = (1.0 + 1e-8, [&most, &least].map(|said| mm_of(said)));
            assert!(below <= down * hair && below <= limit * hair, "{limit}{most}");
            assert!(above * hair >= up && above * hair >= limit, "{limit}{least}");
            // The same again, of the mm as they are shown.
            assert_eq!([unit.beside_greatest(down), unit.beside_least(up)], [most, least]);
        }
        assert_eq!(unit.greatest(0.7), "0.700 (0.0275\u{202f}in)");
        assert_eq!(unit.least(0.14), "0.140 (0.00552\u{202f}in)");
        assert_eq!(SizeUnit::Mm.greatest(0.7), "0.700");
        assert_eq!(unit.limit(0.7, false), "0.700 mm (0.0275\u{202f}in)");
    }

    #[test]
    fn digits_end_where_they_mean_nothing() {
        let texts = [19.05, 0.075, 0.6, 4.0, 25.896, 100.0, 1e-7].map(|value| in_digits(value, 3));
        assert_eq!(texts, ["19.1", "0.075", "0.6", "4", "25.9", "100", "1.00e-7"]);
        assert_eq!(in_digits(19.05, 4), "19.05");
    }

    #[test]
    fn thousands_stand_apart() {
        assert_eq!(whole(9313), "9313");
        assert_eq!(whole(96_000), "96\u{202f}000");
        assert_eq!(whole(200_000_000), "200\u{202f}000\u{202f}000");
    }

    #[test]
    fn a_percentage_never_rounds_to_nothing_or_to_all() {
        let texts: Vec<String> = [0.0, 0.000_01, 0.004_2, 0.0751, 0.4312, 0.999_9, 1.0].map(percent).into();
        let bare: Vec<&str> = texts.iter().map(|text| text.trim_end_matches("\u{202f}%")).collect();
        assert_eq!(bare, ["0.0", "<0.01", "0.42", "7.51", "43.1", ">99.9", "100.0"]);
    }

    #[test]
    fn an_interval_stays_between_nothing_and_all() {
        let statistic = Statistic { mean: 0.01, sd: Some(0.02), low: Some(-0.004), high: Some(0.024) };
        assert_eq!(percent_interval(&statistic).unwrap(), "0.0 to 2.4\u{202f}%");
        assert_eq!(percent_interval(&Statistic { low: None, ..statistic }), None);
        let nothing = Statistic { mean: 1e-5, sd: None, low: Some(5e-6), high: Some(2e-5) };
        assert_eq!(percent_interval(&nothing).unwrap(), "<0.01\u{202f}%");
    }

    #[test]
    fn times_have_a_unit_that_fits() {
        assert_eq!(duration(12.34), "12.3\u{202f}s");
        assert_eq!(duration(600.0), "10.0\u{202f}min");
        assert_eq!(duration(7200.0), "2.0\u{202f}h");
    }
}
