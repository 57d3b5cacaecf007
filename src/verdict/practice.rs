//! What the rules of filter practice say of a pair: findings where they speak against its class, and a line
//! that stands below every verdict, whatever it is.

use super::entry::Finding;
use super::finding;
use super::rule_words::{against, listed, met_of, size};
use super::tested::{is_beyond_tests, of_tests, tested, tested_words};
use crate::outcome::comparison::ComparedStanding;
use crate::outcome::record::{
    AppliedRule, LimitOfDesign, Outcome, Practice, RuleQuantity, RuleRole, TestedClass, Verdict,
};
use crate::outcome::rules::{
    DESIGN, PAPER_NO_EROSION, PERMEABILITY, TESTS_CONTINUING, TESTS_NO_EROSION, authority,
};

/// Said where the rule of drainage has no result.
pub(super) const DRAINAGE_UNKNOWN: &str = "drainage not known";

/// The rules of a role that were made for these soils and are not kept.
pub(super) fn broken(rules: &[AppliedRule], role: RuleRole) -> Vec<&AppliedRule> {
    rules.iter().filter(|rule| rule.is_broken() && rule.role == role).collect()
}

/// What rules that are not kept say of a class. What several authors say alike is one finding, and rules of
/// retention that agree with the class say nothing: the line of practice has them.
pub fn findings(verdict: Verdict, rules: &[AppliedRule]) -> Vec<Finding> {
    let each = [RuleRole::Retention, RuleRole::Continuation].into_iter().flat_map(|role| broken(rules, role));
    let mut all: Vec<Finding> = each.map(of_rule).filter(|of| of.is_against(verdict)).collect();
    let list = |rules: &[&AppliedRule], one: fn(&AppliedRule) -> String| {
        listed(&rules.iter().map(|rule| one(rule)).collect::<Vec<_>>())
    };
    let unstable = broken(rules, RuleRole::Stability);
    if !unstable.is_empty() {
        all.push(finding::loses_fines(&list(&unstable, |rule| {
            let [value, limit] = against(rule, 3);
            format!("{} ({} {value}, limit {limit})", authority(rule), rule.quantity)
        })));
    }
    all.extend(drainage(rules));
    let placing = broken(rules, RuleRole::Placing);
    if !placing.is_empty() {
        all.push(finding::may_segregate(&list(&placing, asked)));
    }
    all.extend(stricter(verdict, rules));
    all
}

fn of_rule(rule: &AppliedRule) -> Finding {
    let [value, limit] = against(rule, 3);
    let limit = limit + if rule.limit_at_most { " at most" } else { "" };
    match (rule.id.as_str(), rule.role) {
        (DESIGN, _) => finding::limit_of_design(&limit, &value),
        (TESTS_NO_EROSION, _) => finding::tests_no_erosion(&limit, &value),
        (TESTS_CONTINUING, _) => finding::tests_continuing(&limit, &value),
        (_, RuleRole::Continuation) => {
            finding::rule_of_continuation(rule.quantity.name(), &limit, &value, authority(rule))
        }
        _ => finding::rule_of_retention(rule.quantity.name(), &limit, &value, authority(rule)),
    }
}

/// A quantity, and what practice asks for.
fn asked(rule: &AppliedRule) -> String {
    let [value, limit] = against(rule, 3);
    let allowed = if rule.at_least { "at least" } else { "up to" };
    format!("{} is {value}, and practice asks for {allowed} {limit}", rule.quantity)
}

fn drainage(rules: &[AppliedRule]) -> Vec<Finding> {
    let too_fine = too_fine(rules).map(|[value, asked]| finding::too_fine_to_drain(&value, &asked));
    too_fine.into_iter().chain(too_many_fines(rules).map(|fines| finding::fines_of_filter(&fines))).collect()
}

/// Rules of drainage that are not kept: of D15F, and of anything else.
fn undrained(rules: &[AppliedRule]) -> (Vec<&AppliedRule>, Vec<&AppliedRule>) {
    let all = broken(rules, RuleRole::Drainage).into_iter();
    all.partition(|rule| rule.quantity == RuleQuantity::D15F)
}

/// D15F of a filter that is too fine to drain, and what practice asks for.
fn too_fine(rules: &[AppliedRule]) -> Option<[String; 2]> {
    let (of_size, _) = undrained(rules);
    let [value, limit] = against(of_size.first()?, 3);
    let least = of_size.get(1).map_or(String::new(), |least| {
        format!(", and EM 1110-2-1901 for {} at the least", against(least, 3)[1])
    });
    Some([value, format!("USBR and NRCS ask for {limit} or more{least}")])
}

/// What practice asks of the fines of a filter that has too many to drain.
fn too_many_fines(rules: &[AppliedRule]) -> Option<String> {
    let (_, of_fines) = undrained(rules);
    let all: Vec<String> = of_fines.into_iter().map(asked).collect();
    (!all.is_empty()).then(|| listed(&all))
}

/// Whether the walk is stricter than tests for this pair: they found no erosion where it has some.
fn stricter(verdict: Verdict, rules: &[AppliedRule]) -> Option<Finding> {
    let find = |id: &str| rules.iter().find(|rule| rule.id == id && rule.applies);
    let tests = find(TESTS_NO_EROSION).filter(|rule| rule.met == Some(true))?;
    let ratio = find(PAPER_NO_EROSION).filter(|rule| rule.met == Some(false))?;
    matches!(verdict, Verdict::Some | Verdict::Continuing).then(|| {
        let [value, holds] = [ratio.value, ratio.limit].map(|number| size(number, ""));
        finding::stricter_than_tests(&value, &size(tests.limit, &tests.unit), &holds)
    })
}

/// The limit of design of a pair, for programs; `None` where its rule is not among them.
pub fn record(rules: &[AppliedRule]) -> Option<Practice> {
    let rule = rules.iter().find(|rule| rule.id == DESIGN)?;
    Some(Practice {
        design: LimitOfDesign {
            rule: rule.id.clone(),
            limit_mm: rule.limit,
            limit_at_most: rule.limit_at_most,
            value_mm: rule.value,
            met: rule.met,
        },
        foster_fell: tested(rules),
    })
}

/// Where a filter stands by practice, the worst first.
#[derive(Clone, Debug, PartialEq)]
pub enum Standing {
    /// A rule of retention or of coarser filters is not kept, and no test held either.
    Fails,
    /// The limit of design is not kept, but such a filter is within the boundary of no erosion of tests.
    NoMargin,
    /// It keeps the limits, but may lose its own fines.
    Unstable,
    /// The limit of design has no result: what is missing.
    Unknown(String),
    /// The limit of design is kept.
    Met,
    /// No rule of design was applied.
    NoRules,
}

impl Standing {
    /// The same as a record keeps it.
    pub fn recorded(&self) -> ComparedStanding {
        match self {
            Self::Fails => ComparedStanding::Fails,
            Self::NoMargin => ComparedStanding::NoMargin,
            Self::Unstable => ComparedStanding::Unstable,
            Self::Unknown(_) => ComparedStanding::Unknown,
            Self::Met => ComparedStanding::Met,
            Self::NoRules => ComparedStanding::NoRules,
        }
    }
}

/// Where the filter of a pair stands.
pub fn standing(rules: &[AppliedRule]) -> Standing {
    let Some(design) = rules.iter().find(|rule| rule.id == DESIGN && rule.applies) else {
        return Standing::NoRules;
    };
    let mut retention = broken(rules, RuleRole::Retention);
    if met_of(rules, TESTS_NO_EROSION) == Some(true) {
        // Terzaghi's ratio is the limit of design of a sand.
        retention.clear();
    }
    let fails = !retention.is_empty() || !broken(rules, RuleRole::Continuation).is_empty();
    match design.met {
        _ if fails => Standing::Fails,
        Some(false) => Standing::NoMargin,
        _ if !broken(rules, RuleRole::Stability).is_empty() => Standing::Unstable,
        Some(true) => Standing::Met,
        None => {
            let needs = first_clause(&design.needs.to_string());
            Standing::Unknown(needs.strip_prefix("needs ").map_or("the limit of design", |of| of).to_owned())
        }
    }
}

impl Outcome {
    /// What practice says of the pair, in a line.
    pub fn practice_in_words(&self) -> String {
        practice_in_words(&self.rules)
    }

    /// Where walk, rules and tests disagree for this pair, and which way each errs.
    pub fn compared_with_tests(&self) -> String {
        compared_with_tests(self.verdict, &self.rules, self.errs_unsafely())
    }
}

fn compared_with_tests(verdict: Verdict, rules: &[AppliedRule], errs_unsafely: bool) -> String {
    let said = tested_words(rules);
    let tests = match tested(rules) {
        TestedClass::None => Some((0, said)),
        TestedClass::Some | TestedClass::Excessive => Some((1, said)),
        TestedClass::Continuing => Some((2, said)),
        // At least some erosion.
        TestedClass::Unknown if is_beyond_tests(rules) => Some((1, said)),
        TestedClass::Unknown => None,
    };
    let walked = severity(verdict);
    let mut text = format!("The walk says “{}”. ", verdict.words());
    text += &match tests {
        // What is beyond the boundary of no erosion is said in words of this program.
        Some((1, class)) => format!("By the boundaries of Foster and Fell the pair has {class}. "),
        Some((_, class)) => format!("The boundaries that Foster and Fell saw in tests say “{class}”. "),
        None => "The boundaries that Foster and Fell saw in tests give no class for this pair. ".into(),
    };
    text += match met_of(rules, DESIGN) {
        Some(true) => "The limit of design (Sherard and Dunnigan) is met. ",
        Some(false) => "The limit of design (Sherard and Dunnigan) is not met. ",
        None => "The limit of design (Sherard and Dunnigan) gives no result. ",
    };
    text += match walked.zip(tests.map(|(class, _)| class)) {
        _ if tested(rules) == TestedClass::Unknown && walked != Some(0) => "",
        Some((walked, tests)) if walked > tests => {
            "The walk is stricter than the tests here: for uniform sands it errs on the safe side. "
        }
        Some((walked, tests)) if walked < tests => {
            "The walk is more favourable than the tests here, which is on the unsafe side: rely on the \
                 tests. "
        }
        Some((1, _)) => {
            "Whether they agree is not known: neither the walk nor the rules here tell some from \
                 excessive erosion. "
        }
        Some(_) => "Walk and tests agree here. ",
        None => "",
    };
    text += "Which way each errs: for clean sands tests put the end of no erosion at a D15F/D85B of 6.8 \
                 to 10, the limits of Terzaghi and of design at 4, with a margin, and this network near 5. \
                 For uniform sands the model is therefore stricter than tests. ";
    if errs_unsafely {
        text += "For this pair it errs on the unsafe side. ";
    }
    text += "It ignores the cohesion of fines. (Tests: Foster and Fell, as given by Fell et al., \
             Geotechnical Engineering of Dams, Table 9.2.)";
    text
}

/// What practice says of a pair, in a line: whether the limit of design is kept, the class that tests of
/// Foster and Fell give it, and whether the filter is stable and drains.
pub fn practice_in_words(rules: &[AppliedRule]) -> String {
    let find = |id: &str| rules.iter().find(|rule| rule.id == id && rule.applies);
    let (design, retention) = (find(DESIGN), broken(rules, RuleRole::Retention));
    let mut said = Vec::new();
    let beyond_tests = retention.iter().find(|rule| rule.id == TESTS_NO_EROSION);
    said.push(match design {
        Some(rule) => match beyond_tests.filter(|_| rule.met == Some(true)) {
            Some(tests) => {
                let [value, limit] = against(tests, 3);
                format!(
                    "D15F {value} is more than the {limit} up to which tests saw no erosion (Foster and \
                     Fell), though within the {} that Sherard and Dunnigan allow (design)",
                    against(rule, 3)[1]
                )
            }
            None => of_design(rule),
        },
        None => "the limit of design was not applied".into(),
    });
    said.extend(of_tests(rules));
    for rule in retention.iter().filter(|rule| ![DESIGN, TESTS_NO_EROSION].contains(&&*rule.id)) {
        // What the limit of design says already in millimetres is no second fault.
        if design.is_none_or(|design| design.met.is_none()) {
            let [value, limit] = against(rule, 3);
            said.push(format!("{} {value} is more than {limit} ({})", rule.quantity, authority(rule)));
        }
    }
    let also = [
        (RuleRole::Stability, "may lose its finer part"),
        (RuleRole::Drainage, "may not drain"),
        (RuleRole::Placing, "may segregate"),
    ];
    let also = also.into_iter().filter(|(role, _)| !broken(rules, *role).is_empty());
    let also: Vec<String> = also.map(|(_, what)| what.to_owned()).collect();
    if !also.is_empty() {
        said.push(format!("the filter {}", listed(&also)));
    }
    let drainage = find(PERMEABILITY).filter(|rule| rule.met.is_none());
    if drainage.is_some() && broken(rules, RuleRole::Drainage).is_empty() {
        said.push(DRAINAGE_UNKNOWN.into());
    }
    let result = match design.and_then(|rule| rule.met) {
        _ if !retention.is_empty() => "not met",
        Some(_) => "met",
        None => "no result",
    };
    format!("{result}: {}", said.join("; "))
}

fn of_design(rule: &AppliedRule) -> String {
    let [value, limit] = against(rule, 3);
    let at_most = if rule.limit_at_most { " at most" } else { "" };
    match (rule.met, rule.limit) {
        (Some(true), _) => {
            format!("D15F {value} is within the {limit} that Sherard and Dunnigan allow (design)")
        }
        (Some(false), _) => {
            format!("D15F {value} is more than the {limit}{at_most} that Sherard and Dunnigan allow (design)")
        }
        (None, Some(_)) => format!(
            "the limit of Sherard and Dunnigan (design) is {limit}{at_most}, D15F {value}: {}",
            first_clause(&rule.needs.to_string())
        ),
        (None, None) => format!(
            "the limit of Sherard and Dunnigan (design) is not known, D15F {value}: {}",
            first_clause(&rule.needs.to_string())
        ),
    }
}

fn first_clause(needs: &str) -> String {
    needs.split([':', ';']).next().unwrap_or_default().to_owned()
}

/// 0 no erosion, 1 some, 2 continuing; `None` where it is undecided.
pub(super) fn severity(verdict: Verdict) -> Option<u8> {
    match verdict {
        Verdict::None => Some(0),
        Verdict::Some => Some(1),
        Verdict::Continuing => Some(2),
        Verdict::Undecided => None,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::gradation::Gradation;
    use crate::verdict::{PairOptions, PairRules};

    fn of(filter: &[(f64, f64)], base: &[(f64, f64)], dispersive: bool) -> Vec<AppliedRule> {
        let one = |points| vec![("soil".to_owned(), Gradation::from_points(points, None).unwrap())];
        let options = PairOptions { dispersive, ..PairOptions::default() };
        PairRules::of_envelopes(&one(base), &one(filter), options).rules
    }

    fn said(filter: &[(f64, f64)], base: &[(f64, f64)]) -> String {
        practice_in_words(&of(filter, base, false))
    }

    const SAND: [(f64, f64); 2] = [(0.2, 0.0), (0.6, 100.0)];
    const TILL: [(f64, f64); 5] = [(0.075, 35.0), (0.425, 60.0), (2.0, 82.0), (4.75, 92.0), (19.0, 100.0)];
    const GRAVEL: [(f64, f64); 3] = [(5.0, 0.0), (6.5, 15.0), (20.0, 100.0)];

    #[test]
    fn the_limit_of_design_and_the_class_of_tests_stand_in_one_line() {
        let till = said(&GRAVEL, &TILL);
        let begin = "not met: D15F 6.50 mm is more than the 1.12 mm that Sherard and Dunnigan allow \
                     (design); Foster and Fell: at least some erosion (no erosion up to 0.700 mm); ";
        assert!(till.starts_with(begin), "{till}");
        let between = said(&[(3.7, 0.0), (8.0, 100.0)], &SAND);
        assert!(between.contains("Fell: at least some erosion; excessive erosion is not excluded, as its "));
        assert_eq!(
            said(&[(1.0, 0.0), (3.0, 100.0)], &SAND),
            "met: D15F 1.18 mm is within the 2.03 mm that Sherard and Dunnigan allow (design); Foster and \
             Fell: no erosion (up to 3.56 mm)"
        );
        let coarse = said(&[(8.0, 0.0), (16.0, 100.0)], &SAND);
        assert!(coarse.contains("; Foster and Fell: continuing erosion (beyond 5."), "{coarse}");
        // Between the limit of design and the boundary that tests saw.
        let between = said(&[(2.5, 0.0), (5.0, 100.0)], &SAND);
        assert!(between.starts_with("not met: ") && between.contains("Fell: no erosion (up to"), "{between}");
    }

    /// Between the boundaries of no and of continuing erosion neither side tells some from excessive erosion,
    /// and no words of this program stand as a quotation.
    #[test]
    fn whether_walk_and_tests_agree_between_the_boundaries_is_not_known() {
        let between = of(&[(3.7, 0.0), (8.0, 100.0)], &SAND, false);
        let some = compared_with_tests(Verdict::Some, &between, false);
        assert!(
            some.contains(
                "“some erosion”. By the boundaries of Foster and Fell the pair has at least some erosion; \
                 excessive erosion is not excluded, as its boundary is not worked out here. The limit"
            ),
            "{some}"
        );
        assert!(some.contains("Whether they agree is not known: ") && !some.contains("agree here"), "{some}");
        assert!(!some.contains("“at least"), "{some}");
        let held = compared_with_tests(Verdict::None, &between, false);
        assert!(held.contains("more favourable than the tests here"), "{held}");
        assert!(
            compared_with_tests(Verdict::Continuing, &between, false)
                .contains("stricter than the tests here")
        );
        let good = of(&[(1.0, 0.0), (3.0, 100.0)], &SAND, false);
        let good = compared_with_tests(Verdict::None, &good, false);
        assert!(good.contains("in tests say “no erosion”. ") && good.contains("agree here"), "{good}");
    }

    #[test]
    fn stability_and_drainage_are_said() {
        let too_fine = said(&SAND, &SAND);
        assert!(
            too_fine.starts_with("met: ") && too_fine.ends_with("; the filter may not drain"),
            "{too_fine}"
        );
        let gap = [(0.3, 0.0), (0.36, 15.0), (2.4, 15.0), (6.0, 100.0)];
        let unstable = said(&gap, &SAND);
        assert!(unstable.contains("; the filter may lose its finer part, may not drain"), "{unstable}");
    }

    #[test]
    fn what_is_not_known_is_said_with_the_most_that_it_can_be() {
        // A sand whose fines nobody sieved, and a dispersive one.
        let hidden = said(&[(1.0, 0.0), (3.0, 100.0)], &[(0.3, 25.0), (1.0, 100.0)]);
        assert!(hidden.starts_with("no result: the limit of Sherard and Dunnigan (design) is "), "{hidden}");
        assert!(hidden.contains(" mm at most, D15F 1.18 mm: needs finer sieves of the base"), "{hidden}");
        let silty = [(0.01, 0.0), (0.075, 22.0), (0.3, 85.0), (0.6, 100.0)];
        let fine = practice_in_words(&of(&[(0.5, 0.0), (1.0, 100.0)], &silty, true));
        assert!(fine.starts_with("no result: ") && fine.contains(": needs a test of this soil"), "{fine}");
        let all = of(&[(3.0, 0.0), (6.0, 100.0)], &silty, true);
        let coarse = practice_in_words(&all);
        // (40 - 22)/25 (4 x 0.3 - 0.7) + 0.7 = 1.06.
        assert!(
            coarse.starts_with("not met: D15F 3.33 mm is more than the 1.06 mm at most that"),
            "{coarse}"
        );
        let design = record(&all).unwrap().design;
        assert_eq!((design.rule.as_str(), design.met, design.limit_at_most), (DESIGN, Some(false), true));
        assert_eq!(record(&[]), None);
    }
}
