//! Numbers as sentences say them.

/// A count with thin groups: `2 620 000`.
pub fn count(n: u64) -> String {
    let digits = n.to_string();
    let groups: Vec<&str> =
        digits.as_bytes().rchunks(3).rev().map(|g| std::str::from_utf8(g).unwrap_or_default()).collect();
    groups.join(" ")
}

/// Below this a share rounds to nothing at two decimals of a percent.
const NOTHING: f64 = 5e-5;

/// A percentage with digits that mean something.
pub fn percent(fraction: f64) -> String {
    let p = 100.0 * fraction;
    let digits = if p == 0.0 || p >= 10.0 { 1 } else { 2 };
    match format!("{p:.digits$} %") {
        nothing if nothing == "0.00 %" => "below 0.005 %".into(),
        said => said,
    }
}

/// From one share to another, as percentages; one of them where they read alike.
pub fn percent_span([low, high]: [f64; 2]) -> String {
    let [least, most] = [low, high].map(percent);
    match low < NOTHING {
        _ if least == most => most,
        true if high < NOTHING => most,
        true => format!("up to {most}"),
        false => format!("{least} to {most}"),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_read_well() {
        assert_eq!(count(2_620_000), "2 620 000");
        assert_eq!(count(12), "12");
        assert_eq!(
            [percent(0.0), percent(0.0666), percent(0.4), percent(1.0)],
            ["0.0 %", "6.66 %", "40.0 %", "100.0 %"]
        );
        assert_eq!([percent(4.9e-5), percent(5.1e-5)], ["below 0.005 %", "0.01 %"]);
    }

    #[test]
    fn a_span_says_no_more_than_its_digits() {
        let spans = [[0.0, 2e-5], [0.0, 0.0], [2e-5, 0.0758], [0.0113, 0.0271], [0.10001, 0.10004]];
        let said = ["below 0.005 %", "0.0 %", "up to 7.58 %", "1.13 % to 2.71 %", "10.0 %"];
        assert_eq!(spans.map(percent_span), said);
    }
}
