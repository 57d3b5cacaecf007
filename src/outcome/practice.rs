//! What filter practice says of a pair, in a line that stands below every verdict, whatever it is.

use super::record::{AppliedRule, LimitOfDesign, Outcome, Practice, RuleRole, Verdict};
use super::rule_words::{against, listed, said_of_all, whose};

/// The rule of design.
const DESIGN: &str = "sherard-dunnigan";

impl Practice {
    /// From the rules that were applied; `None` where the rule of design is not among them.
    pub fn of(rules: &[AppliedRule]) -> Option<Self> {
        let rule = rules.iter().find(|rule| rule.id == DESIGN)?;
        Some(Self {
            design: LimitOfDesign {
                rule: rule.id.clone(),
                limit_mm: rule.limit,
                limit_at_most: rule.limit_at_most,
                value_mm: rule.value,
                met: rule.met,
            },
        })
    }
}

impl Outcome {
    /// What practice says of the pair, in a line.
    pub fn practice_in_words(&self) -> String {
        practice_in_words(&self.rules, self.verdict)
    }
}

/// What practice says of a pair, in a line: whether its rules of retention are kept, what tests saw, whether
/// the filter is stable and drains, and whether the verdict agrees.
pub fn practice_in_words(rules: &[AppliedRule], verdict: Verdict) -> String {
    let find = |id: &str| rules.iter().find(|rule| rule.id == id && rule.applies);
    let broken = |role: RuleRole| -> Vec<&AppliedRule> {
        rules.iter().filter(|rule| rule.is_broken() && rule.role == role).collect()
    };
    let (design, retention) = (find(DESIGN), broken(RuleRole::Retention));
    let mut said = Vec::new();
    said.push(match design {
        Some(rule) => of_design(rule),
        None => "the limit of design was not applied".into(),
    });
    let no_erosion = find("foster-fell-no-erosion");
    said.extend(of_tests(no_erosion, find("foster-fell-continuing")));
    for rule in retention.iter().filter(|rule| ![DESIGN, "foster-fell-no-erosion"].contains(&&*rule.id)) {
        // What the limit of design says already in millimetres is no second fault.
        if design.is_none_or(|design| design.met.is_none()) {
            let [value, limit] = against(rule, 3);
            said.push(format!("{} {value} is more than {limit} ({})", rule.quantity, whose(rule)));
        }
    }
    let unstable: Vec<String> =
        broken(RuleRole::Stability).into_iter().map(|rule| whose(rule).to_owned()).collect();
    if !unstable.is_empty() {
        said.push(format!("the filter may lose its own fines ({})", listed(&unstable)));
    }
    if let Some(drains) = said_of_all(RuleRole::Drainage, &broken(RuleRole::Drainage)) {
        let clause = drains.strip_suffix("; that says nothing of retention").unwrap_or(&drains);
        said.push(clause.to_owned());
    }
    said.extend(agreement(rules, verdict).map(String::from));
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
            first_clause(&rule.needs)
        ),
        (None, None) => format!(
            "the limit of Sherard and Dunnigan (design) is not known, D15F {value}: {}",
            first_clause(&rule.needs)
        ),
    }
}

fn first_clause(needs: &str) -> &str {
    needs.split([':', ';']).next().unwrap_or_default()
}

/// What tests saw.
fn of_tests(none: Option<&AppliedRule>, continuing: Option<&AppliedRule>) -> Option<String> {
    let limit = |rule: &AppliedRule| {
        rule.limit
            .map(|_| format!("{}{}", against(rule, 3)[1], if rule.limit_at_most { " at most" } else { "" }))
    };
    if let Some(rule) = continuing.filter(|rule| rule.met == Some(false)) {
        return Some(format!("tests found continuing erosion beyond {} (Foster and Fell)", limit(rule)?));
    }
    let none = none?;
    let up_to = limit(none)?;
    Some(match (none.met, continuing.and_then(limit)) {
        (Some(false), Some(beyond)) => format!(
            "tests found no erosion up to {up_to} only, and continuing erosion beyond {beyond} (Foster and \
             Fell)"
        ),
        (Some(false), None) => format!("tests found no erosion up to {up_to} only (Foster and Fell)"),
        _ => format!("tests found no erosion up to {up_to} (Foster and Fell)"),
    })
}

/// Whether the verdict agrees with practice.
///
/// Tests tell the three classes apart; where they do not tell, the limit of design tells a filter that holds
/// from one that may not.
fn agreement(rules: &[AppliedRule], verdict: Verdict) -> Option<&'static str> {
    const STRICTER: &str = "the walk is stricter";
    const MILDER: &str = "the walk is more favourable: rely on practice";
    const AGREE: &str = "practice and walk agree on retention";
    let met = |id: &str| rules.iter().find(|rule| rule.id == id && rule.applies)?.met;
    let retained = !rules.iter().any(|rule| rule.is_broken() && rule.role == RuleRole::Retention);
    let (none, continuing) = (met("foster-fell-no-erosion"), met("foster-fell-continuing"));
    let is_known = met(DESIGN).is_some() || none.is_some() || continuing == Some(false);
    // 0 no erosion, 1 some or excessive, 2 continuing.
    let walked = match verdict {
        Verdict::None => 0,
        Verdict::Some => 1,
        Verdict::Continuing => 2,
        Verdict::Undecided => return None,
    };
    if !is_known {
        return None;
    }
    Some(match (walked, none, continuing) {
        (2, _, Some(false)) => AGREE,
        (_, _, Some(false)) => MILDER,
        (0, ..) if retained => AGREE,
        (0, ..) => MILDER,
        (_, Some(true), _) => STRICTER,
        (1, Some(false), _) => AGREE,
        // Between the boundaries tests saw some or excessive erosion, and the walk knows no excessive class.
        (_, Some(false), _) => "practice and walk agree that it does not hold",
        _ if retained => STRICTER,
        _ => "practice and walk agree that it does not hold",
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::gradation::Gradation;
    use crate::outcome::{PairOptions, PairRules};

    fn of(filter: &[(f64, f64)], base: &[(f64, f64)], dispersive: bool) -> Vec<AppliedRule> {
        let one = |points| vec![("soil".to_owned(), Gradation::from_points(points, None).unwrap())];
        let options = PairOptions { dispersive, ..PairOptions::default() };
        PairRules::of_envelopes(&one(base), &one(filter), options).rules
    }

    fn said(filter: &[(f64, f64)], base: &[(f64, f64)], verdict: Verdict) -> String {
        practice_in_words(&of(filter, base, false), verdict)
    }

    const SAND: [(f64, f64); 2] = [(0.2, 0.0), (0.6, 100.0)];
    const TILL: [(f64, f64); 5] = [(0.075, 35.0), (0.425, 60.0), (2.0, 82.0), (4.75, 92.0), (19.0, 100.0)];
    const GRAVEL: [(f64, f64); 3] = [(5.0, 0.0), (6.5, 15.0), (20.0, 100.0)];

    /// A broken rule of retention is said of every verdict, undecided and continuing too.
    #[test]
    fn a_broken_rule_is_said_of_every_verdict() {
        let begin = "not met: D15F 6.50 mm is more than the 1.12 mm that Sherard and Dunnigan allow \
                     (design); tests found no erosion up to 0.700 mm only, and continuing erosion beyond ";
        for (verdict, end) in [
            (Verdict::None, "; the walk is more favourable: rely on practice"),
            (Verdict::Some, "; practice and walk agree on retention"),
            (Verdict::Continuing, "; practice and walk agree that it does not hold"),
            (Verdict::Undecided, " (Foster and Fell)"),
        ] {
            let said = said(&GRAVEL, &TILL, verdict);
            assert!(said.starts_with(begin) && said.ends_with(end), "{said}");
        }
    }

    #[test]
    fn agreement_and_disagreement_are_said() {
        let met = "met: D15F 1.18 mm is within the 2.04 mm that Sherard and Dunnigan allow (design); tests \
                   found no erosion up to 3.56 mm (Foster and Fell); ";
        for (verdict, end) in [
            (Verdict::None, "practice and walk agree on retention"),
            (Verdict::Some, "the walk is stricter"),
            (Verdict::Continuing, "the walk is stricter"),
        ] {
            assert_eq!(said(&[(1.0, 0.0), (3.0, 100.0)], &SAND, verdict), format!("{met}{end}"));
        }
        for (verdict, end) in [
            (Verdict::Continuing, "practice and walk agree on retention"),
            (Verdict::Some, "the walk is more favourable: rely on practice"),
            (Verdict::None, "the walk is more favourable: rely on practice"),
        ] {
            let said = said(&[(8.0, 0.0), (16.0, 100.0)], &SAND, verdict);
            assert!(
                said.contains("tests found continuing erosion beyond 5.") && said.ends_with(end),
                "{said}"
            );
        }
        // Between the limit of design and the boundary that tests saw.
        let said = said(&[(2.5, 0.0), (5.0, 100.0)], &SAND, Verdict::None);
        assert!(said.starts_with("not met: ") && said.ends_with("rely on practice"), "{said}");
    }

    #[test]
    fn stability_and_drainage_are_said() {
        let too_fine = said(&SAND, &SAND, Verdict::None);
        let drains = "; the filter may be too fine to drain the base; D15F ";
        assert!(too_fine.starts_with("met: ") && too_fine.contains(drains), "{too_fine}");
        let gap = [(0.3, 0.0), (0.36, 15.0), (2.4, 15.0), (6.0, 100.0)];
        let unstable = said(&gap, &SAND, Verdict::None);
        assert!(unstable.contains("; the filter may lose its own fines (Kézdi (1979), "), "{unstable}");
    }

    #[test]
    fn what_is_not_known_is_said_with_the_most_that_it_can_be() {
        // A sand whose fines nobody sieved, and a dispersive one.
        let hidden = said(&[(1.0, 0.0), (3.0, 100.0)], &[(0.3, 25.0), (1.0, 100.0)], Verdict::Undecided);
        assert!(hidden.starts_with("no result: the limit of Sherard and Dunnigan (design) is "), "{hidden}");
        assert!(hidden.contains(" mm at most, D15F 1.18 mm: needs finer sieves of the base"), "{hidden}");
        let silty = [(0.01, 0.0), (0.075, 22.0), (0.3, 85.0), (0.6, 100.0)];
        let fine = practice_in_words(&of(&[(0.5, 0.0), (1.0, 100.0)], &silty, true), Verdict::None);
        assert!(fine.starts_with("no result: ") && fine.contains(": needs a test of this soil"), "{fine}");
        let all = of(&[(3.0, 0.0), (6.0, 100.0)], &silty, true);
        let coarse = practice_in_words(&all, Verdict::None);
        // (40 - 22)/25 (4 x 0.3 - 0.7) + 0.7 = 1.06.
        assert!(
            coarse.starts_with("not met: D15F 3.33 mm is more than the 1.06 mm at most that"),
            "{coarse}"
        );
        let design = Practice::of(&all).unwrap().design;
        assert_eq!((design.rule.as_str(), design.met, design.limit_at_most), (DESIGN, Some(false), true));
        assert_eq!(Practice::of(&[]), None);
    }
}
