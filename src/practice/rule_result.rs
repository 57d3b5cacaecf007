//! Results of single rules of practice, and their authors.

use crate::rules::{
    DESIGN, DESIGN_FLOOR_MM, PERMEABILITY, PERMEABILITY_LEAST, TESTS_CONTINUING, TESTS_NO_EROSION, authority,
};
use crate::{AppliedRule, RuleNote, RuleRole};
use std::borrow::Cow;

/// Result of a rule of practice, determined only here and shown by faces.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum RuleResult {
    /// The limit is kept.
    Met,
    /// The limit is not kept.
    NotMet,
    /// A boundary of continuing erosion is not reached, which alone is not favourable.
    NotReached,
    /// A boundary of continuing erosion is not reached, and erosion may be excessive.
    ExcessiveNotJudged,
    /// The number of the rule is no limit for these soils.
    NotALimit,
    /// The rule states no limit.
    NoLimit,
    /// An input of the rule is not known.
    NoResult,
    /// The rule was not made for these soils.
    DoesNotApply,
}

impl RuleResult {
    /// Results of rules that are neither kept nor broken, in reading order.
    pub const WITHOUT: [Self; 4] = [Self::NotALimit, Self::NoLimit, Self::NoResult, Self::DoesNotApply];
}

/// The result of a rule.
pub fn result_of(rule: &AppliedRule) -> RuleResult {
    match rule.met.filter(|_| rule.applies) {
        Some(true) if rule.role == RuleRole::Continuation => {
            let is_open = rule.notes.contains(&RuleNote::ExcessiveNotJudged);
            if is_open { RuleResult::ExcessiveNotJudged } else { RuleResult::NotReached }
        }
        Some(true) => RuleResult::Met,
        Some(false) => RuleResult::NotMet,
        None if !rule.applies && rule.notes.contains(&RuleNote::NoClearBoundary) => RuleResult::NotALimit,
        None if !rule.applies && rule.needs.is_empty() => RuleResult::DoesNotApply,
        None if rule.limit.is_none() && rule.needs.is_empty() => RuleResult::NoLimit,
        None => RuleResult::NoResult,
    }
}

/// True if the limit is for a dispersive base, for which Fell et al. give a single number: design has no
/// separate limit and therefore no margin.
fn is_of_dispersive(rule: &AppliedRule) -> bool {
    [DESIGN, TESTS_NO_EROSION].contains(&rule.id.as_str())
        && rule.applies
        && rule.notes.contains(&RuleNote::Dispersive)
        && !rule.limit_at_most
        && rule.limit != Some(DESIGN_FLOOR_MM)
}

/// Limit of design of a dispersive base, if the boundary of no erosion is the same number.
pub(super) fn without_margin(rules: &[AppliedRule]) -> Option<&AppliedRule> {
    let find = |id: &str| rules.iter().find(|rule| rule.id == id && is_of_dispersive(rule));
    let (design, tests) = (find(DESIGN)?, find(TESTS_NO_EROSION)?);
    (design.limit == tests.limit).then_some(design)
}

/// True if the limit of design has no margin: it is not below the boundary of no erosion, which is the
/// lower end of the range in which erosion began in tests or lies within that range.
pub(super) fn has_no_margin(rules: &[AppliedRule]) -> bool {
    let limit = |id: &str| {
        let rule = rules.iter().find(|rule| rule.id == id && rule.applies && !rule.limit_at_most)?;
        rule.limit
    };
    limit(DESIGN).zip(limit(TESTS_NO_EROSION)).is_some_and(|(design, tests)| design >= tests * (1.0 - 1e-9))
}

/// Source of a rule's limit as cited in a sentence.
pub fn credit(rule: &AppliedRule) -> &str {
    // One number for both design and no erosion.
    if is_of_dispersive(rule) { "Fell et al., Table 9.2, note b" } else { authority(rule) }
}

/// Citation of a rule of retention: its author, and which of the author's rules it is.
pub(super) fn cited_rule(rule: &AppliedRule) -> String {
    let kind = match rule.id.as_str() {
        DESIGN => "limit of design",
        TESTS_NO_EROSION => "boundary of no erosion",
        TESTS_CONTINUING => "boundary of continuing erosion",
        _ => "rule",
    };
    match authority(rule) {
        name if *name == rule.name => name.into(),
        _ if is_of_dispersive(rule) => "the limit of Fell et al. for dispersive bases".into(),
        authority => format!("{authority}'s {kind}"),
    }
}

/// True if a rule that was made for these soils is kept; `None` without a result.
pub(super) fn met_of(rules: &[AppliedRule], id: &str) -> Option<bool> {
    rules.iter().find(|rule| rule.id == id && rule.applies)?.met
}

/// Rules as a sheet lists them. Two rules of drainage with the same limit, their floor, are listed once.
/// The limit of a dispersive base, one number for both design and no erosion, appears once under its own
/// name.
pub(super) fn listed(rules: &[AppliedRule]) -> Vec<Cow<'_, AppliedRule>> {
    let repeats = |rule: &&AppliedRule| {
        let is_listed = |other: &AppliedRule| {
            other.id == PERMEABILITY && other.limit.is_some() && other.limit == rule.limit
        };
        rule.id == PERMEABILITY_LEAST && !rule.limit_at_most && rules.iter().any(is_listed)
    };
    let is_one = without_margin(rules).is_some();
    let once = rules.iter().filter(|rule| !(repeats(rule) || is_one && rule.id == TESTS_NO_EROSION));
    once.map(|rule| match is_one && rule.id == DESIGN {
        true => Cow::Owned(of_dispersive(rule)),
        false => Cow::Borrowed(rule),
    })
    .collect()
}

/// Limit of design of a dispersive base, under the name of its authors.
fn of_dispersive(design: &AppliedRule) -> AppliedRule {
    AppliedRule {
        name: "Fell et al.: no erosion of a highly dispersive base (taken for design, too, without a margin)"
            .into(),
        authority: "Fell et al.".into(),
        source: "Fell, MacGregor, Stapledon & Bell, Geotechnical Engineering of Dams, Table 9.2, note (b)"
            .into(),
        applies_to: "highly dispersive bases: the lower boundary of no erosion, without a margin of safety; \
                     this program takes it for design, too"
            .into(),
        ..design.clone()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::rules::range_of_tests;
    use crate::test_soils::{SAND, TILL, curve, soil};
    use crate::{PairOptions, PairRules};
    use voidwalk_core::Gradation;

    fn rules(base: &[(f64, f64)], d15f: f64) -> Vec<AppliedRule> {
        PairRules::of(&curve(base), &Gradation::linear_from_dx(15.0, d15f, 1.5).unwrap()).rules
    }

    /// Fell et al., Table 9.2: below 15 % fines tests begin at 6.8 D85B and design ends at 4; from 40 to
    /// 85 % both have 0.7 mm; above 85 % both have 9 D85B, and tests begin at 6.4.
    #[test]
    fn a_limit_has_no_margin_where_design_is_not_below_the_tests() {
        for percent in [5.0, 25.0, 34.0, 34.9, 36.0, 38.0, 60.0, 90.0] {
            let base = [(0.001, 0.0), (0.075, percent), (2.0, 100.0)];
            let all = rules(&base, 0.3);
            assert_eq!(has_no_margin(&all), percent >= 34.0, "{percent} % fines");
            // The limit of design is at or above the lower end of the range of tests.
            let design = all.iter().find(|rule| rule.id == DESIGN).and_then(|rule| rule.limit).unwrap();
            let [low, _] = range_of_tests(percent, curve(&base).d(85.0).unwrap());
            assert_eq!(has_no_margin(&all), design >= low * (1.0 - 1e-9), "{percent} % fines");
        }
        // Without known fines, only the maximum possible limits are known.
        assert!(!has_no_margin(&rules(&[(0.2, 30.0), (0.5, 85.0), (1.0, 100.0)], 0.3)));
    }

    /// A run folder that is read back has the same results.
    #[test]
    fn a_boundary_that_is_not_reached_is_never_met() {
        for (base, d15f, result) in [
            (&SAND[..], 3.0, RuleResult::NotReached),
            (&SAND, 4.0, RuleResult::ExcessiveNotJudged),
            (&SAND, 6.0, RuleResult::NotMet),
            (&TILL, 6.5, RuleResult::NotALimit),
        ] {
            let rule = rules(base, d15f).into_iter().find(|rule| rule.id == TESTS_CONTINUING).unwrap();
            let read: AppliedRule = serde_json::from_str(&serde_json::to_string(&rule).unwrap()).unwrap();
            assert_eq!([result_of(&rule), result_of(&read)], [result; 2], "{rule:?}");
        }
        let drains = rules(&SAND, 3.0).into_iter().find(|rule| rule.id == PERMEABILITY).unwrap();
        assert_eq!(result_of(&drains), RuleResult::Met);
    }

    /// For a clay both rules of drainage give the floor; for a sand they give 5 and 3 times D15B.
    #[test]
    fn a_limit_of_drainage_is_listed_once() {
        let filter = curve(&[(0.5, 0.0), (2.0, 100.0)]);
        let clay = [(0.002, 51.0), (0.02, 87.0), (0.63, 100.0)];
        for (base, count) in [(&clay[..], 1), (&[(0.1, 0.0), (0.4, 100.0)], 2)] {
            let pair = PairRules::of(&curve(base), &filter);
            let listed = listed(&pair.rules);
            assert_eq!(listed.iter().filter(|rule| rule.id.starts_with(PERMEABILITY)).count(), count);
            assert!(pair.rules.iter().any(|rule| rule.id == PERMEABILITY_LEAST));
        }
    }

    #[test]
    fn the_limit_of_a_dispersive_base_has_its_own_authors() {
        let base = soil(&[(0.01, 0.0), (0.075, 60.0), (0.3, 92.0), (0.6, 100.0)]);
        for (dispersive, author) in [(false, "Sherard and Dunnigan"), (true, "Fell et al.")] {
            let options = PairOptions { dispersive, ..PairOptions::default() };
            let rules = PairRules::of_envelopes(&base, &soil(&[(0.3, 0.0), (2.0, 100.0)]), options).rules;
            let rows = listed(&rules);
            let design = rows.iter().find(|rule| rule.id == DESIGN).unwrap();
            assert_eq!(design.authorities(), [author, "NRCS", "USBR", "USACE"]);
        }
    }
}
