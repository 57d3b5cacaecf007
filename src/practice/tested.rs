//! Class of a pair by the boundaries that Foster and Fell saw in tests.
//!
//! No text that was read gives their boundary of excessive erosion, so a pair beyond the boundary of no
//! erosion has at least some erosion, and is never read as having no more.

use super::rule_result::met_of;
use crate::rules::{TESTS_CONTINUING, TESTS_NO_EROSION};
use crate::{AppliedRule, RuleNote, TestedClass};

/// The class by the boundaries of Foster and Fell.
pub(super) fn tested(rules: &[AppliedRule]) -> TestedClass {
    let met = |id| met_of(rules, id);
    match (met(TESTS_NO_EROSION), met(TESTS_CONTINUING)) {
        (_, Some(false)) => TestedClass::Continuing,
        (Some(true), _) => TestedClass::None,
        (Some(false), Some(true)) => TestedClass::Some,
        _ => TestedClass::Unknown,
    }
}

/// True if a filter is coarser than any for which tests of Foster and Fell found no erosion.
pub(super) fn is_beyond_tests(rules: &[AppliedRule]) -> bool {
    met_of(rules, TESTS_NO_EROSION) == Some(false)
}

/// True if the filter lies beyond 9 D95B of a base for which tests identified no clear boundary.
pub(super) fn is_beyond_unclear(rules: &[AppliedRule]) -> bool {
    let is_unclear = |rule: &&AppliedRule| rule.notes.contains(&RuleNote::BeyondUnclearBoundary);
    rules.iter().any(|rule| rule.id == TESTS_CONTINUING && is_unclear(&rule))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::PairRules;
    use voidwalk_core::gradation::Gradation;

    const SAND: [(f64, f64); 2] = [(0.2, 0.0), (0.6, 100.0)];
    const TILL: [(f64, f64); 5] = [(0.075, 35.0), (0.425, 60.0), (2.0, 82.0), (4.75, 92.0), (19.0, 100.0)];

    /// The rules of a base and a filter of this D15.
    fn rules(base: &[(f64, f64)], d15f: f64) -> Vec<AppliedRule> {
        let soil = |points: &[(f64, f64)]| Gradation::from_lines(points).unwrap();
        PairRules::of(&soil(base), &soil(&[(0.9 * d15f, 0.0), (d15f, 15.0), (2.0 * d15f, 100.0)])).rules
    }

    /// Excessive erosion damages a dam: unjudged erosion is never reported as less. 7 D85B and 9 D95B of this
    /// sand are 3.56 and 5.11 mm; with 38 % fines and a D95B of 2.6 mm tests identified no boundary of
    /// continuing erosion.
    #[test]
    fn beyond_no_erosion_worse_erosion_is_never_left_out() {
        for (base, d15f, class, excluded) in [
            (&SAND[..], 3.0, TestedClass::None, true),
            (&SAND, 3.7, TestedClass::Some, false),
            (&SAND, 5.0, TestedClass::Some, false),
            (&SAND, 6.0, TestedClass::Continuing, true),
            (&TILL, 6.5, TestedClass::Unknown, false),
            (&TILL, 40.0, TestedClass::Continuing, true),
        ] {
            let rules = rules(base, d15f);
            assert_eq!(tested(&rules), class, "{d15f}");
            let is_worse_open = match class {
                TestedClass::Unknown => is_beyond_tests(&rules),
                class => class == TestedClass::Some,
            };
            assert_eq!(is_worse_open, !excluded, "{d15f}");
            assert_eq!(is_beyond_unclear(&rules), d15f == 40.0);
        }
    }
}
