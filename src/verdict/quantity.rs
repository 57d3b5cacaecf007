//! Numbers of findings, each with its unit, and how a sentence shows them.

use serde_json::Value as Json;

use crate::outcome::digits::count;

/// A number or text of a finding.
#[derive(Clone, Debug, PartialEq)]
pub enum FindingValue {
    /// Of 100.
    Percent(f64),
    /// A length (mm).
    Mm(f64),
    /// A difference of two percents, which may be small: with three decimals.
    Points(f64),
    /// A number without unit.
    Ratio(f64),
    /// A number without unit that is the least of what it may be: shown rounded down.
    LeastRatio(f64),
    /// So many.
    Count(u64),
    /// Anything else.
    Text(String),
}

impl FindingValue {
    /// How its name ends in a record.
    pub fn suffix(&self) -> &'static str {
        match self {
            Self::Percent(_) => "_percent",
            Self::Mm(_) => "_mm",
            Self::Points(_) => "_pp",
            Self::Ratio(_) | Self::LeastRatio(_) | Self::Count(_) | Self::Text(_) => "",
        }
    }

    /// As it stands in a record; `null` where it is no number.
    pub fn json(&self) -> Json {
        match self {
            Self::Percent(value)
            | Self::Points(value)
            | Self::Mm(value)
            | Self::Ratio(value)
            | Self::LeastRatio(value) => (*value).into(),
            Self::Count(count) => (*count).into(),
            Self::Text(text) => text.as_str().into(),
        }
    }

    /// As it stands in a sentence; a count with what is counted, as `replicate` or `copy|copies`.
    pub fn shown(&self, noun: Option<&str>) -> String {
        match self {
            Self::Percent(value) => number(*value) + " %",
            Self::Mm(value) => number(*value) + " mm",
            Self::Points(value) if value.abs() < 1e6 => format!("{value:.3} percentage points"),
            Self::Points(value) => number(*value) + " percentage points",
            Self::Ratio(value) => number(*value),
            Self::LeastRatio(value) => number(down(*value)),
            Self::Count(n) => {
                let Some(noun) = noun else { return count(*n) };
                let (one, many) = noun.split_once('|').unwrap_or((noun, ""));
                match (*n, many) {
                    (1, _) => format!("1 {one}"),
                    (_, "") => format!("{} {one}s", count(*n)),
                    (_, many) => format!("{} {many}", count(*n)),
                }
            }
            // One line, whatever a name holds; a blank before it sets it off from the word before.
            Self::Text(text) => {
                let blank = if text.starts_with(' ') { " " } else { "" };
                blank.to_owned() + &text.split_whitespace().collect::<Vec<_>>().join(" ")
            }
        }
    }
}

/// Three significant digits, rounded down.
fn down(value: f64) -> f64 {
    let scale = 10f64.powi(2 - value.abs().log10().floor() as i32);
    // What has no more digits stays what it is.
    let rounded = (value * scale * (1.0 + 1e-12)).floor() / scale;
    if rounded.is_finite() { rounded } else { value }
}

/// Three significant digits, or all before the point, without zeros at the end.
fn number(value: f64) -> String {
    if value == 0.0 {
        return "0".into();
    }
    if !value.is_finite() {
        return "an unknown number of".into();
    }
    if !(1e-4..1e7).contains(&value.abs()) {
        return format!("{value:.1e}");
    }
    let decimals = (2 - value.abs().log10().floor() as i32).max(0) as usize;
    let text = format!("{value:.decimals$}");
    match text.contains('.') {
        true => text.trim_end_matches('0').trim_end_matches('.').to_owned(),
        false => text,
    }
}

/// A number with so many decimals.
pub(super) fn fixed(value: f64, decimals: usize) -> String {
    match value.abs() {
        size if size < 1e7 => format!("{value:.decimals$}"),
        _ => given(value),
    }
}

/// A number as it was given.
pub(super) fn given(value: f64) -> String {
    match value.abs() {
        0.0 => "0".into(),
        size if (1e-12..1e16).contains(&size) => value.to_string(),
        size if size.is_finite() => format!("{value:e}"),
        _ => "an unknown number of".into(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_have_three_digits_and_their_unit() {
        // The least of what it may be is not rounded up.
        assert_eq!(FindingValue::LeastRatio(8.7655).shown(None), "8.76");
        assert_eq!(FindingValue::LeastRatio(100.0).shown(None), "100");
        assert_eq!(FindingValue::LeastRatio(0.3).shown(None), "0.3");
        assert_eq!(FindingValue::LeastRatio(1234.9).shown(None), "1230");
        let shown = |value: FindingValue| value.shown(None);
        assert_eq!(shown(FindingValue::Percent(35.24)), "35.2 %");
        assert_eq!(shown(FindingValue::Percent(7.5)), "7.5 %");
        assert_eq!(shown(FindingValue::Percent(100.0)), "100 %");
        assert_eq!(shown(FindingValue::Mm(0.075)), "0.075 mm");
        assert_eq!(shown(FindingValue::Mm(1234.6)), "1235 mm");
        assert_eq!(shown(FindingValue::Mm(1e-9)), "1.0e-9 mm");
        assert_eq!(shown(FindingValue::Ratio(0.0)), "0");
        assert_eq!(FindingValue::Count(1).shown(Some("copy|copies")), "1 copy");
        assert_eq!(FindingValue::Count(1200).shown(Some("copy|copies")), "1 200 copies");
        assert_eq!(FindingValue::Count(2).shown(Some("replicate")), "2 replicates");
        assert_eq!(shown(FindingValue::Text(" a\n b".into())), " a b");
        assert_eq!(shown(FindingValue::Text("\na b ".into())), "a b");
    }
}
