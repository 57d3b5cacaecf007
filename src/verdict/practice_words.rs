//! The line of practice, which stands below every answer.

use super::practice::{DRAINAGE_UNKNOWN, Standing, broken, headline, standing};
use super::rule_words::{
    against, credit, first_clause, has_no_margin, met_of, tests_are_stricter, without_margin,
};
use super::tested::{is_beyond_tests, is_beyond_unclear, tested, tested_in_brief};
use super::washout::washout;
use crate::outcome::record::{AppliedRule, Headline, IfDispersive, Outcome, RuleRole, TestedClass};
use crate::outcome::rules::{DESIGN, PERMEABILITY, TESTS_CONTINUING, TESTS_NO_EROSION, authority};

impl Outcome {
    /// What practice says of the pair, in a line.
    pub fn practice_in_words(&self) -> String {
        practice_line(&self.rules, self.if_dispersive, Some(self.inputs.filter.d15_mm))
    }

    /// The limit of a dispersive base that the filter breaks, where nobody has said whether the base is one;
    /// `None` where it breaks none, or is too coarse in any case.
    pub(crate) fn beyond_if_dispersive(&self) -> Option<String> {
        self.if_dispersive?.beyond_in_words(&self.rules, Some(self.inputs.filter.d15_mm))
    }

    /// That rules which are met were judged for one curve of each soil alone; nothing of envelopes.
    pub fn judged_alone(&self) -> Option<&'static str> {
        let is_envelope = self.findings.iter().any(|finding| finding.id == "envelope");
        (standing(&self.rules) == Standing::Met && !is_envelope).then_some(
            "Judged for these two gradations alone. The coarsest filter and the finest base that the works \
             allow must keep the limit, too; that was not checked here.",
        )
    }
}

/// What practice says of a pair, in a line: the headline, D15F beside the limit of design, the class of
/// tests, and every other rule that is not kept; with the limit that a filter of this D15F (mm) breaks if
/// the base is dispersive.
pub(super) fn practice_line(
    rules: &[AppliedRule],
    if_dispersive: Option<IfDispersive>,
    d15f_mm: Option<f64>,
) -> String {
    let dispersive = if_dispersive.and_then(|limit| limit.beyond_in_words(rules, d15f_mm));
    let Some(headline) = headline(rules, dispersive.is_some()) else {
        return "the limit of design was not applied".into();
    };
    let design = rules.iter().find(|rule| rule.id == DESIGN && rule.applies);
    let mut clauses: Vec<String> = design.map(|rule| of_design(rule, rules)).into_iter().collect();
    clauses.extend(of_other_retention(rules, design));
    clauses.extend(of_tests(rules));
    clauses.extend(washout(rules).map(|washout| washout.without_finer()));
    clauses.extend(besides(rules, headline).into_iter().map(str::to_owned));
    clauses.extend(dispersive);
    format!("{}: {}", headline.words(), clauses.join("; "))
}

/// D15F beside the limit of design.
fn of_design(rule: &AppliedRule, rules: &[AppliedRule]) -> String {
    let [value, limit] = against(rule, 3);
    let at_most = if rule.limit_at_most { "at most " } else { "" };
    let d15f = match standing(rules) {
        Standing::Open(between) => between,
        _ => format!("D15F {value}"),
    };
    let limit = match rule.limit {
        Some(_) => format!("limit {at_most}{limit} ({})", credit(rule)),
        None => "limit not known".to_owned(),
    };
    let needs = match (rule.met, rule.needs.of_sieves_between()) {
        (None, None) if !rule.needs.is_empty() => format!(" ({})", first_clause(&rule.needs.to_string())),
        _ => String::new(),
    };
    let margin = if has_no_margin(rules) { ", without a margin" } else { "" };
    format!("{d15f}, {limit}{margin}{needs}")
}

/// Other rules of retention that are not kept, where the limit of design has no result.
fn of_other_retention(rules: &[AppliedRule], design: Option<&AppliedRule>) -> Vec<String> {
    let is_open = design.is_none_or(|design| design.met.is_none());
    let others = broken(rules, RuleRole::Retention).into_iter();
    let others = others.filter(|rule| is_open && ![DESIGN, TESTS_NO_EROSION].contains(&&*rule.id));
    let words = |rule: &AppliedRule| {
        let [value, limit] = against(rule, 3);
        format!("{} {value}, limit {limit} ({})", rule.quantity, authority(rule))
    };
    others.map(words).collect()
}

/// The class of such pairs in tests, with the boundary beyond which the filter lies.
fn of_tests(rules: &[AppliedRule]) -> Option<String> {
    // Within the one limit of a dispersive base tests have no other.
    if without_margin(rules).is_some_and(|rule| rule.met == Some(true)) {
        return None;
    }
    let boundary = |id: &str| {
        let rule = rules.iter().find(|rule| rule.id == id && rule.applies && rule.limit.is_some())?;
        let at_most = if rule.limit_at_most { "at most " } else { "" };
        Some(format!("{at_most}{}", against(rule, 3)[1]))
    };
    let class = match tested(rules) {
        TestedClass::None => "criterion of no erosion met",
        TestedClass::Unknown if !is_beyond_tests(rules) => return None,
        _ => tested_in_brief(rules),
    };
    let beyond = match tested(rules) {
        TestedClass::Continuing => {
            let unclear = if is_beyond_unclear(rules) { ", a boundary that tests leave unclear" } else { "" };
            boundary(TESTS_CONTINUING).map(|limit| format!(" (beyond {limit}{unclear})"))
        }
        _ if tests_are_stricter(rules).is_some() || met_of(rules, DESIGN) == Some(false) => {
            boundary(TESTS_NO_EROSION).map(|limit| format!(" (no erosion up to {limit})"))
        }
        _ => None,
    };
    Some(format!("Foster and Fell: {class}{}", beyond.unwrap_or_default()))
}

/// What other rules say of the filter that the headline does not.
fn besides(rules: &[AppliedRule], headline: Headline) -> Vec<&'static str> {
    let breaks = |role| !broken(rules, role).is_empty();
    let loses = [Headline::MayLoseFiner, Headline::TooCoarseWithoutFiner].contains(&headline);
    let drains = breaks(RuleRole::Drainage);
    let is_unknown = |rule: &AppliedRule| rule.id == PERMEABILITY && rule.applies && rule.met.is_none();
    let all = [
        (breaks(RuleRole::Stability) && !loses, "may lose its finer part"),
        (drains && headline != Headline::MayNotDrain, "may not drain"),
        (breaks(RuleRole::Placing) && headline != Headline::MaySegregate, "may segregate"),
        (!drains && rules.iter().any(is_unknown), DRAINAGE_UNKNOWN),
    ];
    all.into_iter().filter(|(holds, _)| *holds).map(|(_, words)| words).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::gradation::Gradation;
    use crate::outcome::record::PracticeClass;
    use crate::verdict::practice::record;
    use crate::verdict::washout::tests::{GRAVEL_0_32, REGRADED_TILL, SAND_OF_1_MM, STEPPED};
    use crate::verdict::{PairOptions, PairRules};

    fn rules(filter: &[(f64, f64)], base: &[(f64, f64)], dispersive: bool) -> Vec<AppliedRule> {
        let one = |points| vec![("soil".to_owned(), Gradation::from_lines(points).unwrap())];
        let options = PairOptions { dispersive, ..PairOptions::default() };
        PairRules::of_envelopes(&one(base), &one(filter), options).rules
    }

    const SAND: [(f64, f64); 2] = [(0.2, 0.0), (0.6, 100.0)];
    const TILL: [(f64, f64); 5] = [(0.075, 35.0), (0.425, 60.0), (2.0, 82.0), (4.75, 92.0), (19.0, 100.0)];
    const GAP: [(f64, f64); 4] = [(0.3, 0.0), (0.36, 15.0), (2.4, 15.0), (6.0, 100.0)];

    #[test]
    fn every_standing_has_its_headline() {
        let halved = GAP.map(|(size, percent)| (0.5 * size, percent));
        let coarse = STEPPED.map(|(size, percent)| (2.2 * size, percent));
        for (filter, base, expected) in [
            (&[(1.0, 0.0), (3.0, 100.0)][..], &SAND[..], Headline::Meets),
            (&SAND, &SAND, Headline::MayNotDrain),
            (&[(2.5, 0.0), (5.0, 100.0)], &SAND, Headline::BeyondDesign),
            (&[(8.0, 0.0), (16.0, 100.0)], &SAND, Headline::DoesNotMeet),
            (&[(5.0, 0.0), (6.5, 15.0), (20.0, 100.0)], &TILL, Headline::DoesNotMeet),
            (&GAP, &SAND, Headline::TooCoarseWithoutFiner),
            (&GRAVEL_0_32, &REGRADED_TILL, Headline::TooCoarseWithoutFiner),
            // Beyond the limit of design as placed, and beyond that of tests without the finer part.
            (&coarse, &SAND_OF_1_MM, Headline::TooCoarseWithoutFiner),
            (&halved, &SAND, Headline::MayLoseFiner),
            (&[(1.0, 0.0), (3.0, 100.0)], &[(0.3, 25.0), (1.0, 100.0)], Headline::TestMissing),
        ] {
            let rules = rules(filter, base, false);
            assert_eq!(headline(&rules, false), Some(expected));
            assert_eq!(record(&rules, None).unwrap().class, expected.class());
            let line = practice_line(&rules, None, None);
            assert!(line.starts_with(expected.words()) && line.split(' ').count() < 60, "{line}");
        }
        assert_eq!(headline(&[], false), None);
    }

    #[test]
    fn every_headline_is_written_by_its_words() {
        for headline in Headline::ALL {
            assert_eq!(serde_json::to_value(headline).unwrap(), headline.words());
        }
    }

    /// 45 % fines: 0.7 mm, and 0.5 mm if they are dispersive.
    #[test]
    fn a_filter_that_a_dispersive_base_would_break_meets_practice_on_that_condition() {
        let base = [(0.01, 0.0), (0.075, 45.0), (0.3, 92.0), (0.6, 100.0)];
        let filter = |d15f: f64| [(0.9 * d15f, 0.0), (d15f, 15.0), (2.0 * d15f, 100.0)];
        for (d15f, breaks) in [(0.61, true), (0.45, false)] {
            let one = |points: &[(f64, f64)]| vec![("s".to_owned(), Gradation::from_lines(points).unwrap())];
            let pair = PairRules::of_envelopes(&one(&base), &one(&filter(d15f)), PairOptions::default());
            let limit = pair.if_dispersive.unwrap();
            assert_eq!((limit.d15f_max_mm, limit.is_broken_by(d15f)), (0.5, breaks));
            let words = Headline::MeetsUnlessDispersive.words();
            assert_eq!(pair.practice.starts_with(words), breaks, "{}", pair.practice);
        }
        assert_eq!(headline(&rules(&filter(0.61), &base, true), false), Some(Headline::DoesNotMeet));
    }

    #[test]
    fn a_limit_of_which_only_the_most_is_known_is_recorded_as_that() {
        let silty = [(0.01, 0.0), (0.075, 22.0), (0.3, 85.0), (0.6, 100.0)];
        // (40 - 22)/25 (4 x 0.3 - 0.7) + 0.7 = 1.06.
        let practice = record(&rules(&[(3.0, 0.0), (6.0, 100.0)], &silty, true), None).unwrap();
        assert_eq!((practice.class, practice.limit_at_most), (PracticeClass::DoesNotMeet, true));
        assert!((practice.limit_mm.unwrap() - 1.06).abs() < 1e-9);
        assert_eq!(record(&[], None), None);
    }

    #[test]
    fn a_d15f_between_distant_sieves_is_recorded_with_both() {
        let filter = Gradation::from_points(&[(0.3, 10.0), (38.0, 100.0)], None).unwrap();
        let rules = PairRules::of(&Gradation::from_lines(&SAND).unwrap(), &filter).rules;
        assert_eq!(headline(&rules, false), Some(Headline::SievesMissing));
        assert_eq!(record(&rules, None).unwrap().d15f_mm, Some([0.3, 38.0]));
        assert!(practice_line(&rules, None, None).contains("D15F lies between 0.3 and 38 mm"));
    }
}
