//! Remainder of a filter that is not internally stable, and a check that it still retains its base.
//!
//! Retention of such a filter is judged twice, as placed and after washout of its finer part (U.S. Army Corps
//! of Engineers, Filter Evaluation manual, RMC-CPD-2023-04, chapter Filter Gradation). A single one of
//! several published criteria that is not met is a doubt. Li and Fannin's criterion takes the milder of
//! Kenney and Lau's and Kezdi's at every size. Practice is not met if the remainder breaks a limit of
//! retention and Li and Fannin's criterion is not met, or has no result while one of the other two is not met
//! and neither is met.

use super::rule_result::met_of;
use crate::design::retention::retention;
use crate::rules::{DESIGN, KENNEY_LAU, KEZDI, LI_FANNIN, TESTS_CONTINUING};
use crate::{AppliedRule, RuleRole, RuleUnit, WithoutFiner};
use voidwalk_core::gradation::WIDE_LOOSE_PERCENT;

/// A filter beyond a limit of retention once the finer part that it may lose is gone.
#[derive(Clone, Debug, PartialEq)]
pub struct Washout {
    /// Remainder of the filter.
    pub left: WithoutFiner,
    /// Criterion by which the greatest part fails.
    pub by: AppliedRule,
    /// The least limit of retention.
    pub least: f64,
    /// Unit of sizes.
    pub unit: RuleUnit,
    /// True if the remainder is also beyond the tests' boundary of continuing erosion.
    pub continues: bool,
}

/// Checks a filter that is not internally stable for a remainder beyond a limit of retention. Among several
/// parts the part of Kezdi's split comes first, unless it is more than may lie loose.
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

/// Remainder of a filter that is not internally stable, if it is beyond a limit of D15F.
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
    /// True if the analysis stopped at the part that may lie loose, so that more may be lost.
    pub fn is_capped(&self) -> bool {
        self.left.percent >= WIDE_LOOSE_PERCENT * (1.0 - 1e-9)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::PairRules;
    use crate::ValueBound;
    use crate::test_soils::{GRAVEL_0_32, REGRADED_TILL, SAND_OF_1_MM, STEPPED};
    use voidwalk_core::gradation::Gradation;

    fn rules(filter: &[(f64, f64)], base: &[(f64, f64)]) -> Vec<AppliedRule> {
        let soil = |points| Gradation::from_lines(points).unwrap();
        PairRules::of(&soil(base), &soil(filter)).rules
    }

    #[test]
    fn a_filter_that_is_too_coarse_without_its_finer_part_is_found_with_both_limits() {
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
        let rules = rules(&gap, &[(0.2, 0.0), (0.6, 100.0)]);
        assert!(washout(&rules).unwrap().continues);
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

    /// If sieves end at 14 % finer, Li and Fannin's and Kenney and Lau's index may be less than computed. If
    /// neither has a result, Kezdi's alone judges.
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

    #[test]
    fn what_is_left_of_a_finer_filter_retains_the_base_all_the_same() {
        let finer = GRAVEL_0_32.map(|(size, percent)| (0.2 * size, percent));
        let rules = rules(&finer, &REGRADED_TILL);
        assert_eq!(met_of(&rules, LI_FANNIN), Some(false));
        assert!(washout(&rules).is_none());
    }

    /// A straight line of Cu 60 is not stable by Kenney and Lau alone.
    #[test]
    fn one_of_several_criteria_is_a_doubt_alone() {
        let broad = Gradation::linear_from_d0(0.1, 60.0).unwrap();
        let base = Gradation::from_lines(&[(0.05, 0.0), (0.2, 100.0)]).unwrap();
        let rules = PairRules::of(&base, &broad).rules;
        let unstable = rules.iter().filter(|rule| rule.is_broken() && rule.role == RuleRole::Stability);
        assert!(unstable.count() > 0 && met_of(&rules, LI_FANNIN) == Some(true));
        assert!(washout(&rules).is_none());
    }
}
