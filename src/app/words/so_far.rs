//! Interim result of the complete replicates, while others are walked.

use crate::outcome::record::Statistic;
use crate::outcome::so_far::FirstLook;

/// A look in one line, for a verdict with `wanted` replicates; `None` for one replicate, which says nothing
/// about the scatter.
///
/// ```
/// use voidwalk_app::outcome::so_far::SoFar;
/// use voidwalk_app::words::so_far;
/// let mut walked = SoFar::default();
/// for (replicate, eroded) in [(1, 0.31), (2, 0.33), (3, 0.32)] {
///     walked.add(replicate, 1, eroded, false);
/// }
/// let words = walked.look(1).and_then(|look| so_far(&look, 10)).unwrap();
/// assert!(words.starts_with("after 3 of 10 replicates, not yet final: undecided; first run 29.5"));
/// ```
pub fn so_far(look: &FirstLook, wanted: u64) -> Option<String> {
    let interval = |statistic: &Statistic| Some((statistic.low?, statistic.high?));
    let runs = look.eroded.iter().zip(["first run", "second run"]).map(|(statistic, run)| {
        let (low, high) = interval(statistic)?;
        Some(format!("{run} {:.1} to {:.1} %", 100.0 * low, 100.0 * high))
    });
    let runs = runs.collect::<Option<Vec<String>>>()?.join(", ");
    let (replicates, class) = (look.replicates, look.class.words());
    Some(format!(
        "after {replicates} of {wanted} replicates, not yet final: {class}; {runs} of the mass eroded"
    ))
}
