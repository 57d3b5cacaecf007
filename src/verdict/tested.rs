//! The class of a pair by the boundaries that Foster and Fell saw in tests.
//!
//! No text that was read gives their boundary of excessive erosion, so what lies beyond that of no erosion is
//! at least some erosion, and never read as no more than that.

use super::rule_words::{against, met_of};
use crate::outcome::record::{AppliedRule, RuleNote, TestedClass};
use crate::outcome::rules::{TESTS_CONTINUING, TESTS_NO_EROSION};

/// Said where a filter lies between the boundaries of no and of continuing erosion.
const BETWEEN: &str = "at least some erosion; excessive erosion is not excluded, as its boundary is not \
                       worked out here";

/// Said where it lies beyond that of no erosion, and no other is known.
const BEYOND: &str = "at least some erosion";

/// Said of a base for which tests identified no boundary of continuing erosion.
const UNCLEAR: &str = "tests identified no boundary for 15 to 85 % fines and D95B above 2 mm (Fell et al., \
                       section 9.3.2)";

/// The class by the boundaries of Foster and Fell.
pub fn tested(rules: &[AppliedRule]) -> TestedClass {
    let met = |id| met_of(rules, id);
    match (met(TESTS_NO_EROSION), met(TESTS_CONTINUING)) {
        (_, Some(false)) => TestedClass::Continuing,
        (Some(true), _) => TestedClass::None,
        (Some(false), Some(true)) => TestedClass::Some,
        _ => TestedClass::Unknown,
    }
}

/// The class in words: beyond the boundary of no erosion a base has erosion, also where tests identified no
/// boundary of the classes beyond.
pub fn tested_words(rules: &[AppliedRule]) -> &'static str {
    match tested(rules) {
        TestedClass::None => "no erosion",
        TestedClass::Some => BETWEEN,
        TestedClass::Excessive => "excessive erosion",
        TestedClass::Continuing => "continuing erosion",
        TestedClass::Unknown if is_beyond_tests(rules) => BEYOND,
        TestedClass::Unknown => "class not known",
    }
}

/// The same for the cell of a table.
pub fn tested_in_brief(rules: &[AppliedRule]) -> &'static str {
    match tested(rules) {
        TestedClass::Some => "at least some erosion, excessive not excluded",
        TestedClass::Unknown if is_beyond_tests(rules) => "at least some erosion, worse not excluded",
        _ => tested_words(rules),
    }
}

/// Whether a filter is coarser than any for which tests of Foster and Fell found no erosion.
pub fn is_beyond_tests(rules: &[AppliedRule]) -> bool {
    met_of(rules, TESTS_NO_EROSION) == Some(false)
}

/// Whether the filter lies beyond 9 D95B of a base for which tests identified no clear boundary.
pub fn is_beyond_unclear(rules: &[AppliedRule]) -> bool {
    says_of_continuing(rules, RuleNote::BeyondUnclearBoundary)
}

fn says_of_continuing(rules: &[AppliedRule], note: RuleNote) -> bool {
    rules.iter().any(|rule| rule.id == TESTS_CONTINUING && rule.note.says(note))
}

/// The class that tests give the pair, with the boundaries between which it lies.
pub fn of_tests(rules: &[AppliedRule]) -> Option<String> {
    let limit = |id: &str| {
        let rule = rules.iter().find(|rule| rule.id == id && rule.applies)?;
        rule.limit?;
        Some(format!("{}{}", against(rule, 3)[1], if rule.limit_at_most { " at most" } else { "" }))
    };
    let up_to = limit(TESTS_NO_EROSION);
    let said = tested_words(rules);
    let no_erosion = up_to.as_ref().map(|of| format!("no erosion up to {of}"));
    let continuing = limit(TESTS_CONTINUING);
    let from = continuing.as_ref().map(|of| format!("continuing erosion beyond {of}"));
    let class = match tested(rules) {
        TestedClass::None => format!("criterion of no erosion met (up to {})", up_to?),
        TestedClass::Continuing if is_beyond_unclear(rules) => {
            format!("{said} (beyond {}, though {UNCLEAR})", continuing?)
        }
        TestedClass::Continuing => format!("{said} (beyond {})", continuing?),
        TestedClass::Excessive => format!("{said} ({})", from?),
        TestedClass::Some => format!("{said} ({}, {})", no_erosion?, from?),
        TestedClass::Unknown if is_beyond_tests(rules) => {
            let is_unclear = says_of_continuing(rules, RuleNote::NoClearBoundary);
            let why = if is_unclear { format!(", of which {UNCLEAR}") } else { String::new() };
            let from = from.map_or_else(String::new, |from| format!(", {from}"));
            let known = format!("{}{from}", no_erosion?);
            format!("{said} ({known}); excessive erosion is not excluded, nor is continuing erosion{why}")
        }
        TestedClass::Unknown => format!("{said} ({})", no_erosion.or(from)?),
    };
    Some(format!("Foster and Fell: {class}"))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::gradation::Gradation;
    use crate::verdict::PairRules;

    const SAND: [(f64, f64); 2] = [(0.2, 0.0), (0.6, 100.0)];
    const TILL: [(f64, f64); 5] = [(0.075, 35.0), (0.425, 60.0), (2.0, 82.0), (4.75, 92.0), (19.0, 100.0)];

    /// The rules of a base and a filter of this D15.
    fn rules(base: &[(f64, f64)], d15f: f64) -> Vec<AppliedRule> {
        let soil = |points: &[(f64, f64)]| Gradation::from_lines(points).unwrap();
        PairRules::of(&soil(base), &soil(&[(0.9 * d15f, 0.0), (d15f, 15.0), (2.0 * d15f, 100.0)])).rules
    }

    /// Excessive erosion damages a dam: what is not judged is never passed off as less.
    #[test]
    fn beyond_no_erosion_excessive_erosion_is_never_left_out() {
        // 7 D85B and 9 D95B of this sand are 3.56 and 5.11 mm.
        let between = rules(&SAND, 4.0);
        assert_eq!(tested(&between), TestedClass::Some);
        let said = of_tests(&between).unwrap();
        assert_eq!(
            said,
            "Foster and Fell: at least some erosion; excessive erosion is not excluded, as its boundary is \
             not worked out here (no erosion up to 3.56 mm, continuing erosion beyond 5.11 mm)"
        );
        assert_eq!(tested_in_brief(&between), "at least some erosion, excessive not excluded");
        for d15f in [3.7, 5.0] {
            assert!(of_tests(&rules(&SAND, d15f)).unwrap().contains("excessive erosion is not excluded"));
        }
        assert_eq!(
            of_tests(&rules(&SAND, 3.0)).unwrap(),
            "Foster and Fell: criterion of no erosion met (up to 3.56 mm)"
        );
        let beyond = of_tests(&rules(&SAND, 6.0)).unwrap();
        assert_eq!(beyond, "Foster and Fell: continuing erosion (beyond 5.11 mm)");
    }

    /// With 38 % fines and a D95B of 2.6 mm tests identified no boundary of continuing erosion.
    #[test]
    fn a_base_without_a_boundary_of_continuing_erosion_says_whose_word_that_is_and_for_which_soils() {
        let till = rules(&TILL, 6.5);
        assert_eq!(tested(&till), TestedClass::Unknown);
        assert_eq!(
            of_tests(&till).unwrap(),
            "Foster and Fell: at least some erosion (no erosion up to 0.700 mm); excessive erosion is not \
             excluded, nor is continuing erosion, of which tests identified no boundary for 15 to 85 % fines \
             and D95B above 2 mm (Fell et al., section 9.3.2)"
        );
        assert_eq!(tested_in_brief(&till), "at least some erosion, worse not excluded");
        let far = of_tests(&rules(&TILL, 40.0)).unwrap();
        assert!(far.contains("continuing erosion (beyond ") && far.contains(", though tests identified no"));
        // A clay whose table ends at No. 200: D95B is at most that sieve.
        let clay = rules(&[(0.075, 97.0), (2.0, 100.0)], 0.6);
        let open = of_tests(&clay).unwrap();
        assert!(open.starts_with("Foster and Fell: class not known (no erosion up to 0.675 mm at most"));
    }
}
