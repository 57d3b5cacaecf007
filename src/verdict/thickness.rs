//! How the verdict moves with the thickness of the filter.

use super::entry::Finding;
use super::finding as found;
use crate::outcome::record::{Classed, CurveRange, OfThickness, Outcome, Statistic, Verdict};

/// How the verdict moves with the thickness of the filter; `None` without another thickness.
pub fn finding(outcome: &Outcome) -> Option<Finding> {
    of_rows(&outcome.thickness, outcome.class_of_curve(), outcome.points_are())
}

impl Outcome {
    /// The class that the other points of a study are compared with: by the curve itself, where the verdict
    /// is that of an end of its range.
    pub fn class_of_curve(&self) -> Verdict {
        let decided =
            |range: &&CurveRange| self.verdict != Verdict::Undecided && range.whole() == self.verdict;
        let range = self.curve_range.as_ref().filter(decided);
        range.map_or(self.verdict, |range| range.verdict)
    }

    /// Whether a row has as many times the base particles of the scene itself as it is thick.
    pub fn has_its_base(&self, row: &OfThickness) -> bool {
        own(&self.thickness).is_none_or(|own| row.has_its_base(own))
    }
}

/// The row of the scene itself.
fn own(rows: &[OfThickness]) -> Option<&OfThickness> {
    rows.iter().find(|row| row.factor == 1.0)
}

/// Of a thickness that was not walked with as many times the base.
const OTHER_BASE: &str = ", not as many times the base";

/// What the rows say beside a verdict: whether it stays, and how much erodes where it does not; `None`
/// without another thickness. What is undecided neither stays nor moves.
fn of_rows(rows: &[OfThickness], verdict: Verdict, points: Option<&str>) -> Option<Finding> {
    let others: Vec<&OfThickness> = rows.iter().filter(|row| row.factor != 1.0).collect();
    if others.is_empty() {
        return None;
    }
    let own = own(rows)?;
    let stays = others.iter().all(|row| row.walked.verdict == verdict);
    let of_row = |row: &&OfThickness| {
        let held = if row.has_its_base(own) { "" } else { OTHER_BASE };
        format!("{} times as thick{held}: {}", times(row.factor), walked_in_words(&row.walked))
    };
    let each: Vec<String> = others.iter().map(of_row).collect();
    let each = each.join("; ");
    Some(match (verdict, stays) {
        (Verdict::Undecided, _) => {
            let points = points.map_or(String::new(), |points| format!(", {points}"));
            found::open_with_thickness(&points, &each)
        }
        (_, true) => {
            let held = if others.iter().all(|row| row.has_its_base(own)) { "" } else { OTHER_BASE };
            let reach = reach(others.iter().map(|row| row.factor));
            found::stays_with_thickness(&format!("{reach} times as thick{held}"))
        }
        (_, false) => found::moves_with_thickness(&each),
    })
}

/// From the least to the greatest of some multiples.
pub(super) fn reach(factors: impl Iterator<Item = f64> + Clone) -> String {
    let (least, greatest) =
        (factors.clone().fold(f64::INFINITY, f64::min), factors.fold(f64::NEG_INFINITY, f64::max));
    if least == greatest { times(least) } else { format!("{} to {}", times(least), times(greatest)) }
}

/// A multiple, without digits that say nothing.
pub(super) fn times(factor: f64) -> String {
    let times = format!("{factor:.3}");
    times.trim_end_matches('0').trim_end_matches('.').to_owned()
}

/// The class of other walks, and what eroded in them.
pub(super) fn walked_in_words(walked: &Classed) -> String {
    let eroded: Vec<String> = walked.runs.iter().map(|s| percent(s, walked.stopped_when_clear)).collect();
    let replicates = if walked.replicates == 1 { "replicate" } else { "replicates" };
    let (class, count) = (walked.verdict.words(), walked.replicates);
    format!("{class}, {} eroded in {count} {replicates}", eroded.join(" then "))
}

/// The eroded mass; of a point that stopped early its interval, as one replicate has no digits to show.
fn percent(eroded: &Statistic, stopped: bool) -> String {
    match (eroded.low, eroded.high) {
        (Some(low), Some(high)) if stopped => format!("{:.0} to {:.0} %", 100.0 * low, 100.0 * high),
        _ => format!("{:.2} %", 100.0 * eroded.mean),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn sentence(rows: &[OfThickness], verdict: Verdict, points: Option<&str>) -> Option<String> {
        of_rows(rows, verdict, points).map(|finding| finding.sentence())
    }

    fn row(factor: f64, verdict: Verdict, mean: f64) -> OfThickness {
        let runs = vec![Statistic { mean, sd: None, low: None, high: None }];
        let layers = (60.0 * factor) as u64;
        OfThickness {
            factor,
            layers,
            thickness_mm: None,
            n_base: (100.0 * factor) as u64,
            walked: Classed { replicates: 1, stopped_when_clear: false, verdict, runs },
        }
    }

    #[test]
    fn a_sentence_says_whether_the_verdict_moves() {
        let own = row(1.0, Verdict::Some, 0.12);
        assert_eq!(sentence(std::slice::from_ref(&own), Verdict::Some, None), None);
        let stays = sentence(&[own.clone(), row(2.0, Verdict::Some, 0.1)], Verdict::Some, None).unwrap();
        assert_eq!(stays, "The verdict does not change with thickness (2 times as thick).");
        let rows = [row(0.5, Verdict::Some, 0.2), own, row(2.5, Verdict::None, 0.04)];
        let moves = sentence(&rows, Verdict::Some, None).unwrap();
        assert!(
            moves
                .starts_with("The verdict changes with thickness (0.5 times as thick: some erosion, 20.00 %")
        );
        assert!(moves.ends_with("2.5 times as thick: no erosion, 4.00 % eroded in 1 replicate)."), "{moves}");
        let held = OfThickness { n_base: 100, ..row(2.0, Verdict::Some, 0.1) };
        let held = sentence(&[row(1.0, Verdict::Some, 0.12), held], Verdict::Some, None).unwrap();
        assert!(held.ends_with("(2 times as thick, not as many times the base)."), "{held}");
        // Twice the copies of a packing have not quite twice its layers.
        let copies = |factor, n_base, mm| OfThickness {
            n_base,
            thickness_mm: Some(mm),
            ..row(factor, Verdict::Some, 0.1)
        };
        assert!(copies(1.9, 2000, 20.0).has_its_base(&copies(1.0, 1000, 10.0)));
        assert!(!copies(1.9, 1000, 20.0).has_its_base(&copies(1.0, 1000, 10.0)));
        let mut clear = row(2.0, Verdict::Continuing, 0.59);
        clear.walked.stopped_when_clear = true;
        clear.walked.runs = vec![Statistic { mean: 0.59, sd: None, low: Some(0.386), high: Some(0.797) }];
        let rows = [row(1.0, Verdict::Some, 0.6), row(0.5, Verdict::Some, 0.7), clear];
        let said = sentence(&rows, Verdict::Some, None).unwrap();
        assert!(said.contains("continuing erosion, 39 to 80 % eroded in 1 replicate"), "{said}");
    }

    /// Neither "stays" nor "moves" stands under a verdict that is undecided.
    #[test]
    fn what_is_undecided_neither_stays_nor_moves() {
        let rows = [0.5, 1.0, 2.0].map(|factor| row(factor, Verdict::None, 0.05));
        for (points, said) in [
            (Some("by the curve itself"), "at other thicknesses, by the curve itself (0.5 times"),
            (None, "at other thicknesses (0.5 times as thick: no erosion"),
        ] {
            let said = format!("The verdict is undecided; {said}");
            let found = sentence(&rows, Verdict::Undecided, points).unwrap();
            assert!(found.starts_with(&said), "{found}");
        }
    }
}
