//! How the verdict moves with the amount of base.

use super::entry::Finding;
use super::finding as found;
use super::practice::severity;
use super::thickness::{reach, times, walked_in_words};
use crate::outcome::record::{Outcome, Sensitivity, Verdict};

/// How the verdict moves with the amount of base; `None` without another amount.
pub fn finding(outcome: &Outcome) -> Option<Finding> {
    let classes = [outcome.verdict, outcome.class_of_curve()];
    of_rows(&outcome.sensitivity, classes, outcome.points_are())
}

/// What the rows say beside a verdict, and beside the class of the curve with which they were walked. A class
/// worse than the verdict speaks against it. What is undecided neither stays nor moves.
fn of_rows(rows: &[Sensitivity], [verdict, of_curve]: [Verdict; 2], points: Option<&str>) -> Option<Finding> {
    let others: Vec<&Sensitivity> = rows.iter().filter(|row| row.factor != 1.0).collect();
    if others.is_empty() {
        return None;
    }
    let of_row = |row: &&Sensitivity| {
        format!("{} times the base: {}", times(row.factor), walked_in_words(&row.walked))
    };
    let each = others.iter().map(of_row).collect::<Vec<_>>().join("; ");
    let Some(own) = severity(verdict) else {
        let points = points.map_or(String::new(), |points| format!(", {points}"));
        return Some(found::open_with_amount(&points, &each));
    };
    let graded = others.iter().filter_map(|row| Some((severity(row.walked.verdict)?, *row)));
    // Of equal classes the amount that is nearest to the one that was asked for.
    let away = |row: &Sensitivity| (row.factor - 1.0).abs();
    let worst = graded.max_by(|a, b| a.0.cmp(&b.0).then(away(b.1).total_cmp(&away(a.1))));
    Some(match worst.filter(|(class, _)| *class > own) {
        Some((_, row)) => found::worse_with_amount(&times(row.factor), row.walked.verdict.words(), &each),
        None if others.iter().all(|row| row.walked.verdict == of_curve) => {
            let reach = reach(others.iter().map(|row| row.factor));
            found::stays_with_amount(&format!("{reach} times the base"))
        }
        None => found::moves_with_amount(&each),
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::outcome::record::{Classed, Statistic};

    fn row(factor: f64, verdict: Verdict, mean: f64) -> Sensitivity {
        let runs = vec![Statistic { mean, sd: None, low: None, high: None }];
        let walked = Classed { replicates: 1, stopped_when_clear: false, verdict, runs };
        Sensitivity { factor, n_base: 100, grains_per_void: None, mass_ratio: None, walked }
    }

    fn of(rows: &[Sensitivity], verdict: Verdict) -> Finding {
        of_rows(rows, [verdict; 2], Some("by the curve itself")).unwrap()
    }

    #[test]
    fn a_worse_class_with_less_base_speaks_against_the_verdict() {
        assert_eq!(of_rows(&[row(1.0, Verdict::None, 0.02)], [Verdict::None; 2], None), None);
        let rows =
            [row(0.25, Verdict::Some, 0.09), row(1.0, Verdict::None, 0.02), row(4.0, Verdict::None, 0.01)];
        let worse = of(&rows, Verdict::None);
        assert!(worse.id() == "worse_with_amount" && worse.is_against(Verdict::None));
        assert_eq!(
            worse.sentence(),
            "The class depends on the amount of base: with 0.25 times the base some erosion. All amounts: \
             0.25 times the base: some erosion, 9.00 % eroded in 1 replicate; 4 times the base: no erosion, \
             1.00 % eroded in 1 replicate."
        );
        let stays = of(&[row(0.25, Verdict::None, 0.02), row(4.0, Verdict::None, 0.02)], Verdict::None);
        assert!(stays.id() == "stays_with_amount" && !stays.is_against(Verdict::None));
        assert!(stays.sentence().ends_with(" (0.25 to 4 times the base)."), "{}", stays.sentence());
        // A better class moves the verdict, and is no doubt of it.
        let moves = of(&rows, Verdict::Some);
        assert!(moves.id() == "moves_with_amount" && !moves.is_against(Verdict::Some));
        let open = of(&rows, Verdict::Undecided).sentence();
        assert!(
            open.starts_with("The verdict is undecided; with other amounts of base, by the curve"),
            "{open}"
        );
    }
}
