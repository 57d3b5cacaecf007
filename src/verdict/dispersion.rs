//! What is said of a base of which nobody has said whether it is dispersive.
//!
//! A sieve table does not tell it, tests of dispersive soils had other boundaries, and practice has other
//! limits for them. Only a class that trusts the filter needs the statement.

use super::entry::Finding;
use super::finding;
use crate::gradation::FEW_FINES;
use crate::outcome::apart::value_and_limit;
use crate::outcome::design::band::{open_retention, retention};
use crate::outcome::numbers::rounded_down;
use crate::outcome::record::{AppliedRule, IfDispersive, Verdict};

/// Said of fines for which no text gives the limit of a dispersive soil.
const NO_LIMIT: &str = "no source that was read gives a limit for its fines";

impl IfDispersive {
    /// Of a base with so many percent of fines: `if_dispersive` are the rules that it has if it is
    /// dispersive, `d15f` is that of the filter that they judge. `None` where it has few fines, or they are
    /// not known.
    pub fn of(fines_percent: Option<f64>, if_dispersive: &[AppliedRule], d15f: f64) -> Option<Self> {
        if fines_percent? < FEW_FINES {
            return None;
        }
        let (_, d15f_max_mm) = retention(if_dispersive, d15f)?;
        Some(Self { d15f_max_mm, at_most: open_retention(if_dispersive).is_some() })
    }

    /// What stands behind a D15F (mm) that is recommended; `None` where it holds for a dispersive base too.
    pub fn beside(&self, d15f_mm: f64) -> Option<String> {
        let limit = rounded_down(self.d15f_max_mm);
        match self.at_most {
            true => Some(format!("if the base is dispersive, which is not stated, {}", self.open())),
            false if self.d15f_max_mm < d15f_mm => {
                Some(format!("{limit} mm if the base is dispersive, which is not stated"))
            }
            false => None,
        }
    }

    /// What is known of a limit that no text gives.
    fn open(&self) -> String {
        let limit = rounded_down(self.d15f_max_mm);
        format!("{NO_LIMIT}: it is at most {limit} mm, and the pair is to be tested")
    }

    /// The limit in words.
    pub fn words(&self) -> String {
        match self.at_most {
            true => self.open(),
            false => format!("D15F up to {} mm", rounded_down(self.d15f_max_mm)),
        }
    }

    /// What practice says then of a filter of this D15F (mm), where that is known.
    pub fn of_filter(&self, d15f_mm: Option<f64>) -> String {
        let limit = rounded_down(self.d15f_max_mm);
        match (d15f_mm.map(|d15f| self.is_broken_by(d15f)), self.at_most) {
            (Some(true), _) => format!("practice allows a D15F of {limit} mm, which is not met"),
            (_, true) => self.open(),
            (Some(false), false) => format!("practice allows a D15F of {limit} mm, which is met"),
            (None, false) => format!("practice allows a D15F of {limit} mm"),
        }
    }

    /// Whether a filter of this D15F (mm) is known to be too coarse for it.
    pub fn is_broken_by(&self, d15f_mm: f64) -> bool {
        d15f_mm > self.d15f_max_mm * (1.0 + 1e-9)
    }
}

/// What is said beside a verdict of a base of which nobody has said whether it is dispersive, and of its
/// filter of this D15F (mm); `rules` are those of the pair. `None` where the walk erodes.
pub fn finding(
    verdict: Verdict,
    d15f_mm: Option<f64>,
    rules: &[AppliedRule],
    if_dispersive: IfDispersive,
) -> Option<Finding> {
    if matches!(verdict, Verdict::Some | Verdict::Continuing) {
        return None;
    }
    // What does not hold anyway would not hold the more.
    let is_kept = |d15f: &f64| retention(rules, *d15f).is_none_or(|(_, limit)| *d15f <= limit);
    let newly = d15f_mm.filter(|d15f| if_dispersive.is_broken_by(*d15f)).filter(is_kept);
    Some(match newly {
        Some(d15f) => {
            let [value, limit] = value_and_limit(d15f, if_dispersive.d15f_max_mm, false, 3);
            finding::dispersive_would_not_hold(&format!("{limit} mm"), &format!("{value} mm"))
        }
        None => finding::dispersion_not_known(&if_dispersive.of_filter(d15f_mm)),
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::gradation::Gradation;
    use crate::outcome::record::Confidence;
    use crate::verdict::{PairOptions, PairRules, judge};

    /// Id, sentence and label of a verdict on a soil with so many percent of fines and a filter of this D15.
    fn said(verdict: Verdict, fines: f64, d15f: f64) -> (Option<(&'static str, String)>, Confidence) {
        let soil = |points: &[(f64, f64)]| Gradation::from_points(points, None).unwrap();
        let base = soil(&[(0.01, 0.0), (0.075, fines), (0.3, 92.0), (0.6, 100.0)]);
        let filter = soil(&[(0.9 * d15f, 0.0), (d15f, 15.0), (2.0 * d15f, 100.0)]);
        let of = |dispersive| {
            let options = PairOptions { dispersive, ..PairOptions::default() };
            let one = |curve: &Gradation| vec![("s".to_owned(), curve.clone())];
            PairRules::of_envelopes(&one(&base), &one(&filter), options)
        };
        let pair = of(false);
        let if_dispersive = IfDispersive::of(pair.base.fines_percent, &of(true).rules, d15f);
        let found = if_dispersive.and_then(|of| finding(verdict, Some(d15f), &pair.rules, of));
        let label = judge(verdict, &pair.rules, found.clone().into_iter().collect()).confidence;
        (found.map(|found| (found.id(), found.sentence())), label)
    }

    /// Practice has 0.7 mm for such soils, 0.5 mm where they are dispersive.
    #[test]
    fn no_erosion_is_within_only_where_a_dispersive_base_would_be_held_too() {
        for fines in [36.0, 45.0, 80.0] {
            let (found, label) = said(Verdict::None, fines, 0.6);
            let (id, sentence) = found.unwrap();
            assert_eq!((id, label), ("dispersive_would_not_hold", Confidence::Outside));
            assert!(sentence.contains("allows a D15F of 0.500 mm, and this is 0.600 mm"), "{sentence}");
            let (found, label) = said(Verdict::None, fines, 0.45);
            let (id, sentence) = found.unwrap();
            assert_eq!((id, label), ("dispersion_not_known", Confidence::Within));
            // With less than 40 % the limit of design of such a soil was read nowhere, and may be less.
            let then = match fines < 40.0 {
                true => "fines: it is at most 0.500 mm, and the pair is to be tested",
                false => "allows a D15F of 0.500 mm, which is met",
            };
            assert!(sentence.contains(then), "{sentence}");
        }
    }

    /// What page 1 says next and what the finding says is one decision.
    #[test]
    fn the_finding_and_the_next_step_say_the_same() {
        for (d15f_max_mm, at_most) in [(0.5, false), (0.5, true)] {
            let of = IfDispersive { d15f_max_mm, at_most };
            for d15f in [Some(0.4), Some(0.5), None] {
                let found = finding(Verdict::None, d15f, &[], of).unwrap();
                let said = found.sentence();
                assert!(said.contains(&format!("If it is, {}. ", of.of_filter(d15f))), "{said}");
            }
            let found = finding(Verdict::None, Some(0.6), &[], of).unwrap();
            assert_eq!(found.id(), "dispersive_would_not_hold");
            assert!(of.of_filter(Some(0.6)).ends_with("0.500 mm, which is not met"));
        }
        let open = IfDispersive { d15f_max_mm: 0.5, at_most: true };
        assert_eq!(
            open.beside(0.4).unwrap(),
            "if the base is dispersive, which is not stated, no source that was read gives a limit for its \
             fines: it is at most 0.500 mm, and the pair is to be tested"
        );
    }

    #[test]
    fn with_fewer_fines_no_limit_is_known_and_sands_and_erosion_need_no_statement() {
        let (found, label) = said(Verdict::None, 25.0, 0.6);
        let (id, sentence) = found.unwrap();
        assert_eq!((id, label), ("dispersion_not_known", Confidence::Within));
        assert!(
            sentence.contains("If it is, no source that was read gives a limit for its fines: it is at ")
        );
        assert_eq!(said(Verdict::None, 10.0, 0.6).0, None);
        for erodes in [Verdict::Some, Verdict::Continuing] {
            assert_eq!(said(erodes, 45.0, 0.6).0, None);
        }
        assert_eq!(said(Verdict::Undecided, 45.0, 0.6).0.unwrap().0, "dispersive_would_not_hold");
        // What does not hold anyway would not hold the more.
        let (found, label) = said(Verdict::None, 45.0, 0.9);
        assert_eq!((found.unwrap().0, label), ("dispersion_not_known", Confidence::Contradicted));
    }
}
