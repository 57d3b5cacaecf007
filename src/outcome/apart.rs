//! A value beside its limit, with as many digits as tell them apart: what exceeds a limit never reads as
//! within it, nor the other way round.

/// Most digits that are tried to tell two numbers apart.
const MOST: i32 = 9;

/// The whole number that a limit is rounded to: a least upwards, a greatest downwards; one that is whole but
/// for what arithmetic leaves stays.
pub fn whole_within(limit: f64, at_least: bool) -> f64 {
    const HAIR: f64 = 1e-9;
    if at_least { (limit * (1.0 - HAIR)).ceil() } else { (limit * (1.0 + HAIR)).floor() }
}

/// A value and its limit with as many digits as tell them apart, and this many at the least; of two that are
/// the same, with as many as give both one text. The limit is never more generous than it is.
pub(crate) fn value_and_limit(value: f64, limit: f64, at_least: bool, digits: i32) -> [String; 2] {
    let pair = |digits| [digits_of(value, digits), digits_within(limit, digits, at_least)];
    let is_order = |[shown, of]: &[String; 2]| match (shown.parse::<f64>(), of.parse::<f64>()) {
        (Ok(shown), Ok(of)) => shown != of && (shown < of) == (value < limit),
        _ => shown != of,
    };
    // A limit that is just reached is kept, and the value reads as it does elsewhere.
    let alike = || (digits..MOST).map(pair).find(|[shown, of]| shown == of);
    let cut = || [value, limit].map(|number| digits_within(number, digits, at_least));
    let apart = (digits..MOST).filter(|_| value != limit).map(pair).find(is_order);
    apart.or_else(alike).unwrap_or_else(cut)
}

/// A number with so many digits that mean something.
pub(crate) fn digits_of(value: f64, digits: i32) -> String {
    if value == 0.0 || !value.is_finite() {
        return value.to_string();
    }
    format!("{value:.*}", decimals_of(value, digits))
}

/// Decimals of a number with so many digits that mean something, as many as are shown at most.
fn decimals_of(value: f64, digits: i32) -> usize {
    places(value, digits).clamp(0, digits + 4) as usize
}

/// The place of the last of so many digits behind the point; none of them is cut off before it.
fn places(value: f64, digits: i32) -> i32 {
    (digits - 1 - libm::floor(libm::log10(value.abs())) as i32).max(0)
}

/// A limit rounded inward to so many digits: a greatest down, a least up.
pub(super) fn within(limit: f64, digits: i32, at_least: bool) -> f64 {
    if limit <= 0.0 || !limit.is_finite() {
        return limit;
    }
    let parts = libm::pow(10.0, f64::from(places(limit, digits)));
    whole_within(limit * parts, at_least) / parts
}

/// The same as a text.
pub(crate) fn digits_within(limit: f64, digits: i32, at_least: bool) -> String {
    let shown = within(limit, digits, at_least);
    // Decimals of the limit itself: what was rounded up to the next power of ten keeps as many of them.
    if shown > 0.0 { format!("{shown:.*}", decimals_of(limit, digits)) } else { digits_of(shown, digits) }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_value_beyond_its_limit_reads_as_beyond_it_and_one_within_as_within() {
        let pair = |value, limit| value_and_limit(value, limit, false, 3);
        assert_eq!(pair(4.0004, 4.0), ["4.0004", "4.0000"]);
        assert_eq!(pair(3.9996, 4.0), ["3.9996", "4.0000"]);
        assert_eq!(pair(3.52, 4.0), ["3.52", "4.00"]);
        // Rounded to the nearest the limit would be 2.86, too.
        assert_eq!(pair(2.8572, 2.857), ["2.86", "2.85"]);
        // Of a limit that is just reached both have the digits with which neither is rounded up.
        assert_eq!(pair(2.8571, 2.8571), ["2.857", "2.857"]);
        assert_eq!(pair(2.8579, 2.8579), ["2.8579", "2.8579"]);
        assert_eq!(pair(20.0 / 7.0 - 1e-9, 20.0 / 7.0 - 1e-9), ["2.857", "2.857"]);
        assert_eq!(pair(2.0 / 3.0, 2.0 / 3.0), ["0.666", "0.666"]);
        assert_eq!(value_and_limit(0.1399, 0.14, true, 3), ["0.1399", "0.1400"]);
        for step in 0..2000 {
            let limit = 0.05 * libm::pow(1.005, f64::from(step % 700));
            for at_least in [false, true] {
                for part in [1e-2, 1e-3, 1e-4, 1e-6] {
                    let values = [limit * (1.0 - part), limit * (1.0 + part)];
                    for value in values {
                        let shown = value_and_limit(value, limit, at_least, 3);
                        let [shown, of] = shown.map(|text| text.parse::<f64>().unwrap());
                        assert!(
                            shown != of && (shown < of) == (value < limit),
                            "{value} {limit}: {shown} {of}"
                        );
                        let hair = limit * 1e-8;
                        assert!(if at_least { of >= limit - hair } else { of <= limit + hair });
                    }
                }
            }
        }
    }
}
