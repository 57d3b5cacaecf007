//! What is said of the thickness of the filter: how much of it was walked, and how the verdict moves with it.

use super::amount::is_same_mass;
use super::entry::Finding;
use super::finding as found;
use super::study_points::{Study, at_end, classes, reach, times};
use crate::outcome::numbers::{significant, size_unit};
use crate::outcome::record::{OfThickness, Outcome, Sensitivity};

/// How the verdict moves with the thickness of the filter; `None` without another thickness.
pub fn finding(outcome: &Outcome) -> Option<Finding> {
    let mut study = Study::of(outcome, &outcome.thickness);
    // Nothing is scaled but the same mass.
    study.range = study.range.filter(|_| is_same_mass(outcome));
    Thicknesses { study, amounts: &outcome.sensitivity }.finding()
}

/// How thick the modelled filter is; `None` where its network has no thickness.
pub(super) fn modelled(outcome: &Outcome) -> Option<Finding> {
    let unit = size_unit(outcome.inputs.scale_free);
    let size = |size: f64| format!("{} {unit}", significant(size));
    let thickness = outcome.inputs.network.thickness_mm?;
    Some(found::modelled_thickness(&size(thickness), &outcome.beside_thickness(thickness, size)))
}

impl Outcome {
    /// What stands behind so much of the filter in "The walk models … of the filter", with sizes in these
    /// words: that it is less than the filter's largest grain, where it is.
    pub fn beside_thickness(&self, thickness_mm: f64, size: impl Fn(f64) -> String) -> String {
        let largest = self.inputs.filter.gradation.last().map(|row| row[0]);
        match largest.filter(|grain| *grain > thickness_mm) {
            Some(grain) => format!(", less than its largest grain ({})", size(grain)),
            None => " along the flow".into(),
        }
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

/// How thickness was varied where the amount of base went with it: what moves may be moved by either.
pub const WITH_AMOUNT: &str =
    "Thickness was varied together with the amount of base (the base is a share of the filter)";

/// How it was varied where a cap or a number of the scene holds the base.
pub const OTHER_BASE: &str =
    "Thickness was varied, and the base not in proportion (its particles are fixed or capped)";

/// The thicknesses that were walked, beside a verdict.
struct Thicknesses<'a> {
    study: Study<'a, OfThickness>,
    /// The amounts of base that were walked with the scene's own thickness.
    amounts: &'a [Sensitivity],
}

impl Thicknesses<'_> {
    /// Whether as many times the base alone gives each of the classes.
    fn is_the_amount(&self) -> bool {
        self.study.others().all(|row| {
            let alone = self.amounts.iter().find(|amount| amount.factor == row.factor);
            alone.is_some_and(|amount| amount.walked.verdict == row.walked.verdict)
        })
    }

    /// What the rows say beside the verdict: whether it stays, and which class each has where it does not;
    /// `None` without another thickness. What is undecided neither stays nor moves.
    fn finding(&self) -> Option<Finding> {
        self.study.others().next()?;
        let own = self.study.own()?;
        let is_held = !self.study.others().all(|row| row.has_its_base(own));
        let why = if is_held { OTHER_BASE } else { WITH_AMOUNT };
        let at = |factor: String| format!("at {factor} times the thickness");
        let mut said = classes(&self.study.classed(), |ends, _| at(reach(ends, times)));
        if let Some(points) = self.study.how_classed("other thicknesses") {
            said += &format!(" ({points})");
        }
        let at_ends = if is_held { Vec::new() } else { self.study.scaled() };
        said += &at_end(&at_ends, |factor| at(times(factor)));
        let each = self.study.each("times as thick");
        Some(match (self.study.is_open(), self.study.stays()) {
            (true, _) => found::open_with_thickness(why, &said, &self.study.comma_points(), &each),
            (_, true) => found::stays_with_thickness(why, &said, &each),
            (_, false) => {
                let amount = match !is_held && self.is_the_amount() {
                    true => " The amount of base alone gives the same classes.",
                    false => "",
                };
                found::moves_with_thickness(why, &said, amount, &each)
            }
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::outcome::record::{Classed, CurveEnd, CurveRange, Statistic, Verdict};

    fn walked(verdict: Verdict, mean: f64) -> Classed {
        let runs = vec![Statistic { mean, sd: None, low: None, high: None }];
        Classed { replicates: 1, stopped_when_clear: false, verdict, runs }
    }

    fn row(factor: f64, verdict: Verdict, mean: f64) -> OfThickness {
        OfThickness {
            factor,
            layers: (60.0 * factor) as u64,
            thickness_mm: None,
            n_base: (100.0 * factor) as u64,
            walked: walked(verdict, mean),
        }
    }

    fn study(rows: &[OfThickness], verdict: Verdict) -> Study<'_, OfThickness> {
        Study { rows, verdict, as_others: verdict, points: None, range: None, threshold: 0.075 }
    }

    fn finding(rows: &[OfThickness], amounts: &[Sensitivity], verdict: Verdict) -> Option<Finding> {
        Thicknesses { study: study(rows, verdict), amounts }.finding()
    }

    fn sentence(rows: &[OfThickness], verdict: Verdict) -> Option<String> {
        finding(rows, &[], verdict).map(|finding| finding.sentence())
    }

    #[test]
    fn a_sentence_says_that_the_base_was_varied_too_and_the_class_of_each() {
        let own = row(1.0, Verdict::Some, 0.12);
        assert_eq!(sentence(std::slice::from_ref(&own), Verdict::Some), None);
        let stays = finding(&[own.clone(), row(2.0, Verdict::Some, 0.1)], &[], Verdict::Some).unwrap();
        assert_eq!(stays.id(), "stays_with_thickness");
        assert_eq!(
            stays.sentence(),
            "Thickness was varied together with the amount of base (the base is a share of the filter): some \
             erosion at 1 to 2 times the thickness."
        );
        let rows = [row(0.5, Verdict::Some, 0.2), own, row(2.5, Verdict::None, 0.04)];
        let moves = finding(&rows, &[], Verdict::Some).unwrap();
        let end = ": some erosion at 0.5 to 1 times the thickness, no erosion at 2.5 times the thickness.";
        assert!(moves.id() == "moves_with_thickness" && moves.sentence().ends_with(end), "{moves:?}");
        let each = &moves.record(false).numbers["each"];
        assert!(
            each.as_str().unwrap().ends_with("2.5 times as thick: no erosion, 4.00 % eroded in 1 replicate")
        );
        let held = OfThickness { n_base: 100, ..row(2.0, Verdict::Some, 0.1) };
        let held = sentence(&[row(1.0, Verdict::Some, 0.12), held], Verdict::Some).unwrap();
        assert!(held.starts_with("Thickness was varied, and the base not in proportion"), "{held}");
        // Twice the copies of a packing have not quite twice its layers.
        let copies = |factor, n_base, mm| OfThickness {
            n_base,
            thickness_mm: Some(mm),
            ..row(factor, Verdict::Some, 0.1)
        };
        assert!(copies(1.9, 2000, 20.0).has_its_base(&copies(1.0, 1000, 10.0)));
        assert!(!copies(1.9, 1000, 20.0).has_its_base(&copies(1.0, 1000, 10.0)));
    }

    #[test]
    fn where_the_amount_alone_gives_the_same_classes_that_is_said() {
        let rows =
            [row(0.5, Verdict::Some, 0.1), row(1.0, Verdict::None, 0.05), row(2.0, Verdict::None, 0.02)];
        let amount = |factor, verdict| Sensitivity {
            factor,
            n_base: 100,
            grains_per_void: None,
            mass_ratio: None,
            walked: walked(verdict, 0.05),
        };
        let is_said = |half, twice| {
            let amounts = [amount(0.5, half), amount(2.0, twice)];
            let said = finding(&rows, &amounts, Verdict::None).unwrap().sentence();
            said.ends_with(". The amount of base alone gives the same classes.")
        };
        assert!(is_said(Verdict::Some, Verdict::None) && !is_said(Verdict::None, Verdict::None));
    }

    /// Neither "stays" nor "moves" stands under a verdict that is undecided.
    #[test]
    fn what_is_undecided_neither_stays_nor_moves() {
        let rows = [0.5, 1.0, 2.0].map(|factor| row(factor, Verdict::None, 0.05));
        for (points, end) in
            [(Some("by the curve itself"), " (other thicknesses by the curve itself)"), (None, "")]
        {
            let as_others = Verdict::None;
            let study = Study { as_others, points, ..study(&rows, Verdict::Undecided) };
            let found = Thicknesses { study, amounts: &[] }.finding().unwrap();
            let said = format!(
                "undecided at 1 times the thickness, no erosion at 0.5 times the thickness, no erosion at 2 \
                 times the thickness{end}."
            );
            assert!(found.id() == "open_with_thickness" && found.sentence().ends_with(&said), "{found:?}");
        }
    }

    /// C33 on No. 57 stone: the loose end is at the threshold at half the thickness.
    #[test]
    fn the_end_that_erodes_most_is_scaled_to_the_other_thicknesses() {
        let rows =
            [row(0.5, Verdict::None, 0.051), row(1.0, Verdict::None, 0.0248), row(2.0, Verdict::None, 0.012)];
        let runs = vec![Statistic { mean: 0.0373, sd: None, low: Some(0.0345), high: Some(0.0401) }];
        let loose = CurveEnd {
            curve: "loose".into(),
            dc50_factor: 1.1,
            walked: Classed { runs, ..walked(Verdict::None, 0.0) },
        };
        let range = CurveRange {
            verdict: Verdict::None,
            ends: vec![loose],
            worst_counts: true,
            could_be: None,
            eroded_mass_fraction: Vec::new(),
        };
        let study = Study { range: Some(&range), ..study(&rows, Verdict::None) };
        let said = Thicknesses { study, amounts: &[] }.finding().unwrap().sentence();
        let end = "walked): at the threshold at 0.5 times the thickness (7.1 to 8.2 % eroded).";
        assert!(said.ends_with(end), "{said}");
    }
}
