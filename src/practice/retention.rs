//! Limits of D15F by which a filter retains its base, as placed and without the finer part that it may lose.
//!
//! A filter that is not internally stable is judged twice, as placed and after washout of its finer part
//! (U.S. Army Corps of Engineers, Filter Evaluation manual, RMC-CPD-2023-04, chapter Filter Gradation).
//! One failed criterion among several published ones only raises doubt. Li and Fannin's criterion takes
//! the milder of Kenney and Lau's and Kezdi's at every size. Practice is not met if the remainder breaks
//! a limit of retention and Li and Fannin's criterion is not met, or if that criterion has no result, one
//! of the other two is not met and neither is met.

use crate::rule_result::met_of;
use crate::rules::{DESIGN, KENNEY_LAU, KEZDI, LI_FANNIN, TESTS_CONTINUING, TESTS_NO_EROSION};
use crate::{AppliedRule, RuleNote, RuleQuantity, RuleRole, RuleUnit, WithoutFiner};
use voidwalk_core::gradation::{TIE, WIDE_LOOSE_PERCENT};

/// Rules by which a filter retains its base. Practice uses the limit of design. The boundary of no
/// erosion, proposed by one author from tests, counts only if design is not known, and for dispersive
/// bases, for which that author's limit is the recommended one.
pub(super) fn retaining(rules: &[AppliedRule]) -> impl Iterator<Item = &AppliedRule> {
    let design = rules.iter().find(|rule| rule.id == DESIGN && rule.applies);
    let is_known = design.is_some_and(|rule| rule.limit.is_some() && !rule.limit_at_most);
    let is_dispersive = design.is_some_and(|rule| rule.notes.contains(&RuleNote::Dispersive));
    let counts = move |tests: &AppliedRule| is_dispersive || !(is_known || tests.limit_at_most);
    let retains = move |rule: &&AppliedRule| rule.role == RuleRole::Retention;
    rules.iter().filter(retains).filter(move |rule| rule.id != TESTS_NO_EROSION || counts(rule))
}

/// Rule of retention that was made for a base and has only an upper bound as its limit, so that the
/// strictest limit of the base is unknown.
pub(super) fn open_retention(rules: &[AppliedRule]) -> Option<&AppliedRule> {
    retaining(rules).find(|rule| rule.applies && rule.limit_at_most)
}

/// Strictest rule by which a filter retains a base, with its limit of D15F. The true limit may be lower
/// if any limit of retention is only an upper bound.
pub fn retention(rules: &[AppliedRule], d15f: f64) -> Option<(&AppliedRule, f64)> {
    // Among limits that differ only by rounding the first counts, which is the limit of design.
    let stricter = |least: f64, limit: f64| limit < least * (1.0 - TIE);
    retaining_limits(rules, d15f).reduce(|least, next| if stricter(least.1, next.1) { next } else { least })
}

/// Limits of D15F by which a filter retains its base, including the boundary of continuing erosion, which
/// no design exceeds.
fn retaining_limits(rules: &[AppliedRule], d15f: f64) -> impl Iterator<Item = (&AppliedRule, f64)> {
    let d15f = judged_d15f(rules, d15f);
    let continues = rules.iter().filter(|rule| rule.role == RuleRole::Continuation && !rule.limit_at_most);
    retaining(rules).chain(continues).filter_map(move |rule| limit(rule, d15f))
}

/// D15F by which the filter was judged: the unsafe end if its curve is flat or its sieves are widely spaced.
fn judged_d15f(rules: &[AppliedRule], d15f: f64) -> f64 {
    let design = rules.iter().find(|rule| rule.id == DESIGN && rule.applies);
    design.and_then(|rule| rule.value).unwrap_or(d15f)
}

/// Limit of D15F that a rule sets for a base it was made for, in the unit of the rules.
///
/// `d15f` is the D15F of the judged filter. A limit on a ratio to a size of the base (Terzaghi) becomes
/// `d15f` times the limit over the value. Only the rule knows if this size is that of the base as walked
/// or as regraded by practice.
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

/// A filter beyond a limit of retention after losing the finer part that it may lose.
#[derive(Clone, Debug, PartialEq)]
pub struct Washout {
    /// Remainder of the filter.
    pub left: WithoutFiner,
    /// Criterion by which the largest part is lost.
    pub by: AppliedRule,
    /// Lowest limit of retention.
    pub least: f64,
    /// Unit of sizes.
    pub unit: RuleUnit,
    /// True if the remainder is also beyond the tests' boundary of continuing erosion.
    pub continues: bool,
}

/// Checks if the remainder of an internally unstable filter is beyond a limit of retention. Among several
/// parts the part at Kezdi's split comes first, unless it exceeds the maximum that can lie loose.
pub(super) fn washout(rules: &[AppliedRule]) -> Option<Washout> {
    let unstable = unstable(rules);
    let d15f = rules.iter().find(|rule| rule.id == DESIGN).and_then(|rule| rule.value);
    let d15f = d15f.unwrap_or(1.0);
    let least = retention(rules, d15f).map_or(f64::INFINITY, |(_, limit)| limit);
    let (by, left) = lost(&unstable, least)?;
    let boundary = rules.iter().find(|rule| rule.id == TESTS_CONTINUING && rule.applies);
    Some(Washout {
        continues: boundary.and_then(|rule| rule.limit).is_some_and(|limit| is_beyond(&left, limit)),
        left,
        by: by.clone(),
        least,
        unit: rules.iter().find(|rule| rule.id == DESIGN).map_or(RuleUnit::Mm, |rule| rule.unit),
    })
}

/// Remainder of an internally unstable filter, if it is beyond a limit of D15F.
pub(super) fn lost_beyond(rules: &[AppliedRule], limit: f64) -> Option<WithoutFiner> {
    lost(&unstable(rules), limit).map(|(_, left)| left)
}

fn lost<'r>(unstable: &[&'r AppliedRule], limit: f64) -> Option<(&'r AppliedRule, WithoutFiner)> {
    let parts = unstable.iter().filter_map(|rule| Some((*rule, rule.without_finer?)));
    let beyond = parts.filter(|(_, left)| is_beyond(left, limit));
    beyond.min_by_key(|(_, left)| left.percent > WIDE_LOOSE_PERCENT * (1.0 + 1e-9))
}

fn is_beyond(left: &WithoutFiner, limit: f64) -> bool {
    left.d15f > limit * (1.0 + 1e-9)
}

/// Criteria of internal stability that are not met, if they make a filter unstable.
fn unstable(rules: &[AppliedRule]) -> Vec<&AppliedRule> {
    let is_unstable = |rule: &&AppliedRule| rule.is_broken() && rule.role == RuleRole::Stability;
    let unstable: Vec<&AppliedRule> = rules.iter().filter(is_unstable).collect();
    let is_unstable = match met_of(rules, LI_FANNIN) {
        Some(met) => !met,
        None => {
            let both = [KEZDI, KENNEY_LAU].map(|id| met_of(rules, id));
            both.contains(&Some(false)) && !both.contains(&Some(true))
        }
    };
    if is_unstable { unstable } else { Vec::new() }
}

impl Washout {
    /// True if the analysis stopped at the maximum that can lie loose, so that more may be lost.
    pub fn is_capped(&self) -> bool {
        self.left.percent >= WIDE_LOOSE_PERCENT * (1.0 - 1e-9)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::test_soils::{GRAVEL_0_32, REGRADED_TILL, SAND, SAND_OF_1_MM, STEPPED, curve};
    use crate::{PairRules, ValueBound};
    use voidwalk_core::gradation::Gradation;

    fn rules(filter: &[(f64, f64)], base: &[(f64, f64)]) -> Vec<AppliedRule> {
        PairRules::of(&curve(base), &curve(filter)).rules
    }

    /// The same gravel with a fifth of its sizes retains the base without its finer part, too.
    #[test]
    fn a_filter_that_is_too_coarse_without_its_finer_part_is_found_with_both_limits() {
        let finer = rules(&GRAVEL_0_32.map(|(size, percent)| (0.2 * size, percent)), &REGRADED_TILL);
        assert!(met_of(&finer, LI_FANNIN) == Some(false) && washout(&finer).is_none());
        let rules = rules(&GRAVEL_0_32, &REGRADED_TILL);
        let washed = washout(&rules).unwrap();
        assert!((washed.left.percent - 19.4).abs() < 0.05 && (washed.left.d15f - 2.83).abs() < 0.01);
        assert_eq!((washed.by.id.as_str(), washed.continues), (KEZDI, false));
        // A folder that is read back gives the same remainder.
        let read: Vec<AppliedRule> = serde_json::from_str(&serde_json::to_string(&rules).unwrap()).unwrap();
        assert_eq!(washout(&read).unwrap().left, washed.left);
    }

    /// Without a fifth of its mass, a gap-graded filter is also beyond the boundary of continuing erosion.
    #[test]
    fn the_boundary_of_continuing_erosion_is_said_where_what_is_left_is_beyond_it() {
        let gap = [(0.3, 0.0), (0.36, 15.0), (5.0, 15.0), (12.0, 100.0)];
        assert!(washout(&rules(&gap, &SAND)).unwrap().continues);
    }

    #[test]
    fn the_greatest_part_that_may_be_lost_counts_and_not_where_the_index_is_worst() {
        let rules = rules(&STEPPED, &SAND_OF_1_MM);
        let rule = rules.iter().find(|rule| rule.id == LI_FANNIN).unwrap();
        assert!(rule.value == Some(0.0), "{rule:?}");
        let left = rule.without_finer.unwrap();
        // H is below F up to slightly more than 14 %.
        assert!((14.0..14.6).contains(&left.percent) && (7.2..7.6).contains(&left.d15f), "{left:?}");
        assert!(washout(&rules).is_some());
    }

    /// If sieves end at 14 % finer, Li and Fannin's and Kenney and Lau's indices may be lower than
    /// computed. If neither has a result, only Kezdi's counts.
    #[test]
    fn an_index_above_a_pan_is_no_veto() {
        let filter = [(2.36, 14.0), (2.6, 15.3), (16.0, 32.0), (20.0, 80.0), (31.5, 100.0)];
        let rules = rules(&filter, &[(0.3, 0.0), (0.6, 50.0), (1.2, 100.0)]);
        let applied = |id: &str| rules.iter().find(|rule| rule.id == id).unwrap();
        for id in [LI_FANNIN, KENNEY_LAU] {
            let rule = applied(id);
            assert!(rule.met != Some(true), "{rule:?}");
            assert!(rule.value.is_none() || rule.value_bound == Some(ValueBound::AtMost), "{rule:?}");
        }
        assert_eq!(applied(KEZDI).met, Some(false), "{:?}", applied(KEZDI));
        assert!(washout(&rules).is_some());
    }

    /// A straight line of Cu 60 is not stable by Kenney and Lau alone.
    #[test]
    fn one_of_several_criteria_is_a_doubt_alone() {
        let broad = Gradation::linear_from_d0(0.1, 60.0).unwrap();
        let rules = PairRules::of(&curve(&[(0.05, 0.0), (0.2, 100.0)]), &broad).rules;
        let unstable = rules.iter().filter(|rule| rule.is_broken() && rule.role == RuleRole::Stability);
        assert!(unstable.count() > 0 && met_of(&rules, LI_FANNIN) == Some(true));
        assert!(washout(&rules).is_none());
    }

    const D15F: f64 = 1.6;

    fn rules_of(base: &Gradation) -> Vec<AppliedRule> {
        PairRules::of(base, &Gradation::linear_from_dx(15.0, D15F, 1.5).unwrap()).rules
    }

    fn limit_of(rules: &[AppliedRule], id: &str) -> Option<f64> {
        let rule = rules.iter().find(|rule| rule.id == id)?;
        limit(rule, judged_d15f(rules, D15F)).map(|(_, limit)| limit)
    }

    /// Terzaghi's limit on a ratio may be less than Sherard and Dunnigan's on a size by the last digit.
    #[test]
    fn the_limit_of_a_ratio_is_one_of_a_size_and_design_counts_where_they_differ_by_rounding() {
        let mut all = rules_of(&Gradation::linear_from_dx(85.0, 0.4, 3.0).unwrap());
        for (id, limit) in [("terzaghi", 1.6), (TESTS_NO_EROSION, 2.8), ("paper-no-erosion", 2.0)] {
            assert!((limit_of(&all, id).unwrap() - limit).abs() < 1e-9, "{id}");
        }
        assert_eq!(limit_of(&all, "filter-uniformity"), None);
        let place = all.iter().position(|rule| rule.id == "terzaghi").unwrap();
        let of_design = limit_of(&all, DESIGN).unwrap();
        for (factor, id) in [(1.0 - 1e-15, DESIGN), (1.0 + 1e-15, DESIGN), (0.99, "terzaghi")] {
            all[place].limit = Some(of_design * factor);
            all[place].value = Some(D15F);
            assert_eq!(retention(&all, D15F).unwrap().0.id, id, "{factor}");
        }
    }

    /// Practice takes four times the D85B of the part to which it regrades the base. This is much less
    /// than the whole base's D85B for a gap-graded base and for one with gravel.
    #[test]
    fn the_limit_of_a_ratio_is_of_the_base_that_its_rule_reads() {
        let gap = [(0.1, 0.0), (0.2, 20.0), (0.5, 50.0), (4.0, 55.0), (9.5, 80.0), (19.0, 100.0)];
        let gravel = [(0.2, 0.0), (0.5, 10.0), (2.0, 30.0), (4.75, 58.0), (19.0, 100.0)];
        for points in [&gap[..], &gravel] {
            let base = curve(points);
            let regraded = base.regraded();
            let (whole, part) = (base.d(85.0).unwrap(), regraded.gradation.d(85.0).unwrap());
            assert!(regraded.at_mm.is_some() && whole > 2.0 * part, "{whole} {part}");
            let all = rules_of(&base);
            assert!((limit_of(&all, "terzaghi").unwrap() / (4.0 * part) - 1.0).abs() < 1e-9);
            // The model's limit is for the base as walked.
            assert!((limit_of(&all, "paper-no-erosion").unwrap() / (5.0 * whole) - 1.0).abs() < 1e-9);
            let (_, practice) = retention(&all, D15F).unwrap();
            assert!(practice <= 4.0 * part * (1.0 + 1e-9), "{practice}");
        }
    }
}
