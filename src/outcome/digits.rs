//! Numbers as sentences say them.

/// A count with thin groups: `2 620 000`.
pub fn count(n: u64) -> String {
    let digits = n.to_string();
    let groups: Vec<&str> =
        digits.as_bytes().rchunks(3).rev().map(|g| std::str::from_utf8(g).unwrap_or_default()).collect();
    groups.join(" ")
}

/// A percentage with digits that mean something.
pub fn percent(fraction: f64) -> String {
    let p = 100.0 * fraction;
    if p == 0.0 || p >= 10.0 { format!("{p:.1} %") } else { format!("{p:.2} %") }
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
    }
}
