//! Lengths in a user's input: a number in mm or with its unit, metric or US.
//!
//! An inch is 25.4 mm and a foot 304.8 mm. The name of a sieve is not a length: `3/8 in` in a sieve
//! table is the nominal opening of ASTM E11, 9.5 mm; `3/8in` as a length is 9.525 mm.

/// Allowed lengths, in the words of the errors.
pub const LENGTHS: &str = "a length above 0, in mm or with its unit, as 24in, 2ft, 3/8in, 500mm, 0.5m or 5cm";

/// Units of length, and the size of each in mm as a numerator and a denominator, so that 3/8 in is
/// exactly the nearest number to 9.525 mm.
pub(super) const UNITS: [(&str, [f64; 2]); 14] = [
    ("mm", [1.0, 1.0]),
    ("cm", [10.0, 1.0]),
    ("m", [1000.0, 1.0]),
    ("um", [1.0, 1000.0]),
    ("µm", [1.0, 1000.0]),
    ("μm", [1.0, 1000.0]),
    ("nm", [1.0, 1e6]),
    ("in", [254.0, 10.0]),
    ("inch", [254.0, 10.0]),
    ("inches", [254.0, 10.0]),
    ("\"", [254.0, 10.0]),
    ("ft", [3048.0, 10.0]),
    ("feet", [3048.0, 10.0]),
    ("foot", [3048.0, 10.0]),
];

/// Reads a length as a size (mm), above 0 and finite.
///
/// ```
/// use voidwalk_core::schema::length::millimetres;
/// assert_eq!(["500", "500mm", "24in", "3/8 in", "1-1/2in"].map(millimetres), [
///     Some(500.0), Some(500.0), Some(609.6), Some(9.525), Some(38.1)
/// ]);
/// assert_eq!(["24 apples", "-3mm", "0"].map(millimetres), [None; 3]);
/// ```
pub fn millimetres(text: &str) -> Option<f64> {
    let text = text.trim().to_lowercase();
    let of_unit = |(unit, [above, below]): &(&str, [f64; 2])| {
        Some(quantity(text.strip_suffix(unit)?.trim())? * above / below)
    };
    let mm = text.parse().ok().or_else(|| UNITS.iter().find_map(of_unit))?;
    (f64::is_finite(mm) && mm > 0.0).then_some(mm)
}

/// Reads `0.5`, `3/8` or `1 1/2`.
fn quantity(text: &str) -> Option<f64> {
    let plain = |text: &str| text.parse().ok();
    plain(text).or_else(|| if text.starts_with('-') { None } else { fraction(text, plain) })
}

/// Reads `3/8`, `1 1/2`, `1-1/2`, `1½`; anything else is a decimal number.
pub fn fraction(text: &str, decimal: impl Fn(&str) -> Option<f64>) -> Option<f64> {
    let mut plain = text.replace('-', " ");
    for (sign, words) in [
        ('½', " 1/2"),
        ('¼', " 1/4"),
        ('¾', " 3/4"),
        ('⅛', " 1/8"),
        ('⅜', " 3/8"),
        ('⅝', " 5/8"),
        ('⅞', " 7/8"),
    ] {
        plain = plain.replace(sign, words);
    }
    plain = plain.replace('⁄', "/");
    let parts: Vec<&str> = plain.split_whitespace().collect();
    let whole = |text: &str| text.parse::<u32>().ok().filter(|n| *n <= 1000).map(f64::from);
    let broken = |text: &str| {
        let (above, below) = text.split_once('/')?;
        let (above, below) = (whole(above)?, whole(below)?);
        (above > 0.0 && below > 0.0).then_some(above / below)
    };
    match parts[..] {
        [one] => broken(one).or_else(|| decimal(one)),
        [first, second] => Some(whole(first)? + broken(second).filter(|part| *part < 1.0)?),
        _ => None,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lengths_are_read_in_every_unit() {
        for (mm, texts) in [
            (500.0, "500| 5e2 |500mm|0.5m|50 cm"),
            (0.075, "75um|75 μm|75 µm"),
            (609.6, "24in|24 inches|24\"|2ft|2 feet"),
            (304.8, "1FT"),
            (9.525, "3/8in|3/8\""),
            (38.1, "1 1/2 in|1½in"),
            (150.0, "1.5e-1m"),
        ] {
            for text in texts.split('|') {
                assert_eq!(millimetres(text), Some(mm), "{text}");
            }
        }
    }

    #[test]
    fn what_is_no_length_above_0_is_refused() {
        let all = "|mm|in|0|0in|-3mm|-3/8in|nan|nanmm|inf|infm|1e400|1e308ft|3/0in|24 apples|1,5mm|2ft 6in|\
            5%|60layers|1 3/2in";
        for text in all.split('|') {
            assert_eq!(millimetres(text), None, "{text}");
        }
    }
}
