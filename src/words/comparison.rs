//! What the difference between two cases comes to.

use crate::outcome::comparison::{ComparedPair, Comparison};
use crate::outcome::record::Statistic;

/// A difference in percentage points. No minus before nothing.
fn points(share: f64) -> String {
    let text = format!("{:.2}", 100.0 * share);
    if text == "-0.00" { "0.00".to_owned() } else { text }
}

fn interval(low: f64, high: f64) -> String {
    format!("95 % interval {} to {}", points(low), points(high))
}

/// The difference of a pair in a run, without the last end.
pub fn difference(pair: &ComparedPair) -> String {
    let (one, other) = (&pair.first, &pair.second);
    let run = if pair.run == 1 { "first" } else { "second" };
    let Statistic { mean, low, high, .. } = pair.difference;
    let Some((low, high)) = low.zip(high) else {
        let by = points(mean);
        return format!(
            "{run} run: {one} less {other} is {by} percentage points in the one replicate of both"
        );
    };
    let (more, by, range) = match pair.differ {
        Some(true) if mean > 0.0 => ("more", points(mean), interval(low, high)),
        Some(true) => ("less", points(-mean), interval(-high, -low)),
        _ => {
            let (by, range) = (points(mean), interval(low, high));
            return format!(
                "{run} run: no difference between {one} and {other} is shown; {one} less {other} is {by} \
                 percentage points ({range})"
            );
        }
    };
    format!("{run} run: {one} erodes {by} percentage points {more} than {other} ({range})")
}

/// What no interval of a difference holds, where a case has it.
pub fn not_in_intervals(comparison: &Comparison) -> Option<&'static str> {
    comparison.has_range_of_curve().then_some("how far the constriction curve of a case may be off")
}
