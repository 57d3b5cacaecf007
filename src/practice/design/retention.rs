//! Limits of D15F by which the rules of practice retain a base.

use crate::rules::{DESIGN, TESTS_NO_EROSION};
use crate::{AppliedRule, RuleNote, RuleQuantity, RuleRole};
use voidwalk_core::gradation::TIE;

/// D15F by which the filter was judged: the unsafe end if its curve is flat or its sieves lie far apart.
fn judged_d15f(rules: &[AppliedRule], d15f: f64) -> f64 {
    let design = rules.iter().find(|rule| rule.id == DESIGN && rule.applies);
    design.and_then(|rule| rule.value).unwrap_or(d15f)
}

/// The limit of D15F that a rule sets for a base it was made for, in the unit of the rules.
///
/// `d15f` is the D15F of the judged filter. A limit on a ratio to a size of the base (Terzaghi) becomes
/// `d15f` times the limit over the value. Only the rule knows this size, of the base as it is walked or as
/// practice regrades it.
fn limit(rule: &AppliedRule, d15f: f64) -> Option<(&AppliedRule, f64)> {
    let limit = rule.limit.filter(|limit| rule.applies && *limit > 0.0 && limit.is_finite())?;
    match rule.quantity {
        RuleQuantity::D15F => Some((rule, limit)),
        RuleQuantity::D15FOverD85B | RuleQuantity::D15FOverD95B => {
            let value = rule.value.filter(|value| *value > 0.0 && value.is_finite())?;
            Some((rule, limit * d15f / value))
        }
        RuleQuantity::Named(_) => None,
    }
}

/// The rules by which a filter retains its base. Practice goes by the limit of design. The boundary of no
/// erosion that one author proposed from tests counts only if design is not known, and for dispersive bases,
/// for which that author's limit is the recommended one.
pub fn retaining(rules: &[AppliedRule]) -> impl Iterator<Item = &AppliedRule> {
    let design = rules.iter().find(|rule| rule.id == DESIGN && rule.applies);
    let is_known = design.is_some_and(|rule| rule.limit.is_some() && !rule.limit_at_most);
    let is_dispersive = design.is_some_and(|rule| rule.notes.contains(&RuleNote::Dispersive));
    let counts = move |tests: &AppliedRule| is_dispersive || !(is_known || tests.limit_at_most);
    let retains = move |rule: &&AppliedRule| rule.role == RuleRole::Retention;
    rules.iter().filter(retains).filter(move |rule| rule.id != TESTS_NO_EROSION || counts(rule))
}

/// A rule of retention that was made for a base and whose limit is only known to be at most a number, which
/// leaves the strictest limit of the base unknown.
pub fn open_retention(rules: &[AppliedRule]) -> Option<&AppliedRule> {
    retaining(rules).find(|rule| rule.applies && rule.limit_at_most)
}

/// Limits of D15F by which a filter retains its base. They include the size beyond which tests saw continuing
/// erosion, since no design goes beyond it.
pub fn retaining_limits(rules: &[AppliedRule], d15f: f64) -> impl Iterator<Item = (&AppliedRule, f64)> {
    let d15f = judged_d15f(rules, d15f);
    let continues = rules.iter().filter(|rule| rule.role == RuleRole::Continuation && !rule.limit_at_most);
    retaining(rules).chain(continues).filter_map(move |rule| limit(rule, d15f))
}

/// The strictest rule by which a filter retains a base, with its limit of D15F; the true limit may be lower
/// if [`open_retention`] returns a rule.
pub fn retention(rules: &[AppliedRule], d15f: f64) -> Option<(&AppliedRule, f64)> {
    // Among limits that differ by rounding alone the first counts, which is the limit of design.
    let stricter = |least: f64, limit: f64| limit < least * (1.0 - TIE);
    retaining_limits(rules, d15f).reduce(|least, next| if stricter(least.1, next.1) { next } else { least })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::PairRules;
    use voidwalk_core::gradation::Gradation;

    /// D15F of the judged filter.
    const D15F: f64 = 1.6;

    fn rules_of(base: &Gradation) -> Vec<AppliedRule> {
        let filter = Gradation::linear_from_dx(15.0, D15F, 1.5).unwrap();
        PairRules::of(base, &filter).rules
    }

    fn rules(base_cu: f64) -> Vec<AppliedRule> {
        rules_of(&Gradation::linear_from_dx(85.0, 0.4, base_cu).unwrap())
    }

    fn limit_of(rules: &[AppliedRule], id: &str) -> Option<f64> {
        let rule = rules.iter().find(|rule| rule.id == id)?;
        limit(rule, judged_d15f(rules, D15F)).map(|(_, limit)| limit)
    }

    #[test]
    fn the_limit_of_a_ratio_is_one_of_a_size() {
        let all = rules(3.0);
        assert!((limit_of(&all, "terzaghi").unwrap() - 1.6).abs() < 1e-9);
        assert!((limit_of(&all, "foster-fell-no-erosion").unwrap() - 2.8).abs() < 1e-9);
        assert!((limit_of(&all, "paper-no-erosion").unwrap() - 2.0).abs() < 1e-9);
        assert_eq!(limit_of(&all, "filter-uniformity"), None);
    }

    /// Terzaghi's limit of a ratio may be less than Sherard and Dunnigan's of a size by the last digit.
    #[test]
    fn limits_that_differ_by_rounding_are_those_of_design() {
        let mut all = rules(3.0);
        let place = all.iter().position(|rule| rule.id == "terzaghi").unwrap();
        let of_design = limit_of(&all, DESIGN).unwrap();
        for (factor, id) in [(1.0 - 1e-15, DESIGN), (1.0 + 1e-15, DESIGN), (0.99, "terzaghi")] {
            all[place].limit = Some(of_design * factor);
            all[place].value = Some(D15F);
            assert_eq!(retention(&all, D15F).unwrap().0.id, id, "{factor}");
        }
    }

    /// Practice takes four times the D85B of the part to which it regrades the base: much less than of the
    /// whole for a gap-graded base, and for one with gravel.
    #[test]
    fn the_limit_of_a_ratio_is_of_the_base_that_its_rule_reads() {
        let gap = [(0.1, 0.0), (0.2, 20.0), (0.5, 50.0), (4.0, 55.0), (9.5, 80.0), (19.0, 100.0)];
        let gravel = [(0.2, 0.0), (0.5, 10.0), (2.0, 30.0), (4.75, 58.0), (19.0, 100.0)];
        for points in [&gap[..], &gravel] {
            let base = Gradation::from_lines(points).unwrap();
            let regraded = base.regraded();
            let (whole, part) = (base.d(85.0).unwrap(), regraded.gradation.d(85.0).unwrap());
            assert!(regraded.at_mm.is_some() && whole > 2.0 * part, "{whole} {part}");
            let all = rules_of(&base);
            assert!((limit_of(&all, "terzaghi").unwrap() / (4.0 * part) - 1.0).abs() < 1e-9);
            // The model's limit is for the base as it is walked.
            assert!((limit_of(&all, "paper-no-erosion").unwrap() / (5.0 * whole) - 1.0).abs() < 1e-9);
            let (_, practice) = retention(&all, D15F).unwrap();
            assert!(practice <= 4.0 * part * (1.0 + 1e-9), "{practice}");
        }
    }
}
