//! What is said of a base of which nobody has said whether it is dispersive.
//!
//! A sieve table does not tell it, tests of dispersive soils had other boundaries, and practice has other
//! limits for them. Only a class that trusts the filter needs the statement.

use super::entry::Finding;
use super::finding;
use super::practice::{against, broken};
use crate::gradation::FEW_FINES;
use crate::outcome::design::band::{open_retention, retention};
use crate::outcome::numbers::rounded_down;
use crate::outcome::record::{AppliedRule, IfDispersive, RuleQuantity, RuleRole, Verdict};

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
            true => Some(format!(
                "if the base is dispersive, which is not stated, the limit is not known, and {limit} mm or \
                 less"
            )),
            false if self.d15f_max_mm < d15f_mm => {
                Some(format!("{limit} mm if the base is dispersive, which is not stated"))
            }
            false => None,
        }
    }

    /// The limit in words.
    pub fn words(&self) -> String {
        let limit = rounded_down(self.d15f_max_mm);
        match self.at_most {
            true => format!("a limit of D15F that is not known, and {limit} mm or less"),
            false => format!("D15F up to {limit} mm"),
        }
    }

    /// What practice says then of a filter of this D15F (mm), where that is known.
    pub fn of_filter(&self, d15f_mm: f64) -> String {
        let limit = rounded_down(self.d15f_max_mm);
        match (self.is_broken_by(d15f_mm), self.at_most) {
            (true, _) => format!("practice allows a D15F of {limit} mm, which is not met"),
            (false, false) => format!("practice allows a D15F of {limit} mm, which is met"),
            (false, true) => format!("the limit is not known, and is a D15F of {limit} mm or less"),
        }
    }

    /// Whether a filter of this D15F (mm) is known to be too coarse for it.
    pub fn is_broken_by(&self, d15f_mm: f64) -> bool {
        d15f_mm > self.d15f_max_mm * (1.0 + 1e-9)
    }
}

/// What is said of a base with so many percent of fines: `rules` are those of the pair, `if_dispersive` those
/// that it has if its base is dispersive. `None` where it has few fines, or the walk erodes.
pub fn finding(
    verdict: Verdict,
    fines_percent: Option<f64>,
    rules: &[AppliedRule],
    if_dispersive: &[AppliedRule],
) -> Option<Finding> {
    let erodes = matches!(verdict, Verdict::Some | Verdict::Continuing);
    if erodes || fines_percent? < FEW_FINES {
        return None;
    }
    let is_broken = |of: &AppliedRule| rules.iter().any(|rule| rule.id == of.id && rule.is_broken());
    let more = broken(if_dispersive, RuleRole::Retention).into_iter().filter(|rule| !is_broken(rule));
    if let Some(rule) = strictest(more) {
        let [value, limit] = against(rule, 3);
        return Some(finding::dispersive_would_not_hold(&limit, &value));
    }
    let limits = || {
        let of_retention = |rule: &&AppliedRule| rule.applies && rule.role == RuleRole::Retention;
        let all = if_dispersive.iter().filter(of_retention);
        all.filter(|rule| rule.quantity == RuleQuantity::D15F && rule.limit.is_some())
    };
    let known = strictest(limits().filter(|rule| !rule.limit_at_most));
    let limit = known.or_else(|| strictest(limits()))?;
    let (before, after) = match known.map(|rule| rule.met) {
        Some(Some(true)) => ("practice allows a D15F of", ", which is met"),
        Some(_) => ("practice allows a D15F of", ""),
        None => ("no source that was read gives the limit: it is a D15F of", " or less"),
    };
    Some(finding::dispersion_not_known(before, &against(limit, 3)[1], after))
}

/// The rule with the least limit.
fn strictest<'a>(rules: impl Iterator<Item = &'a AppliedRule>) -> Option<&'a AppliedRule> {
    rules.min_by(|a, b| a.limit.unwrap_or(f64::NAN).total_cmp(&b.limit.unwrap_or(f64::NAN)))
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
        let found = finding(verdict, pair.base.fines_percent, &pair.rules, &of(true).rules);
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
            assert!(sentence.contains("allows a D15F of 0.500 mm, which is met"), "{sentence}");
        }
    }

    #[test]
    fn with_fewer_fines_no_limit_is_known_and_sands_and_erosion_need_no_statement() {
        let (found, label) = said(Verdict::None, 25.0, 0.6);
        let (id, sentence) = found.unwrap();
        assert_eq!((id, label), ("dispersion_not_known", Confidence::Within));
        assert!(sentence.contains("no source that was read gives the limit: it is a D15F of "), "{sentence}");
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
