//! What a sheet says where it lists the rules of one authority alone: its limit, and what is left out.

use super::practice::{against, tested, tested_words};
use crate::outcome::design::band::retention;
use crate::outcome::record::{AppliedRule, RuleQuantity, RuleRole};
use crate::outcome::rules::{Authority, TESTS_CONTINUING, authority, is_stated_by};

/// The rules of practice that one authority states, in their order; those of the walk are none of them.
pub fn stated_by(rules: &[AppliedRule], by: Authority) -> Vec<AppliedRule> {
    rules.iter().filter(|rule| rule.role != RuleRole::Walk && is_stated_by(rule, by)).cloned().collect()
}

/// What stands behind [`of_pair`] where there is a walk.
pub const ON_ALL_RULES: &str = "The verdict rests on all rules.";

/// The strictest limit of D15F that one authority has for this pair, and what it leaves out; `None` for all
/// authorities, which leave nothing out.
pub fn of_pair(rules: &[AppliedRule], by: Authority, d15f: Option<f64>) -> Option<String> {
    if by == Authority::All {
        return None;
    }
    let governing = match governing(&stated_by(rules, by), d15f) {
        Some((rule, value)) => format!("{value} ({})", authority(&rule)),
        None => "no limit of D15F for this base".into(),
    };
    Some(format!("{}: {governing}. {}", by.name(), left_out(rules, by)))
}

/// The strictest limit of D15F that one authority has for a base, in the unit of a design whose rules were
/// read at one D15F; and that the answer rests on all rules.
pub fn of_design(rules: &[AppliedRule], by: Authority, unit: &str) -> Option<String> {
    if by == Authority::All {
        return None;
    }
    let stated = stated_by(rules, by);
    let d15f = rules.iter().find(|rule| rule.quantity == RuleQuantity::D15F).and_then(|rule| rule.value);
    let governing = match d15f.and_then(|d15f| retention(&stated, d15f)) {
        Some((rule, limit)) => {
            let at_most = if rule.limit_at_most { " at most" } else { "" };
            format!("D15F up to {limit:.3} {unit}{at_most} ({})", authority(rule))
        }
        None => "no limit of D15F for this base".into(),
    };
    Some(format!("{}: {governing}. {} The answer rests on all rules.", by.name(), left_out(rules, by)))
}

/// The rule with the strictest limit, and value and limit in words.
fn governing(stated: &[AppliedRule], d15f: Option<f64>) -> Option<(AppliedRule, String)> {
    let (rule, _) = retention(stated, d15f?)?;
    let [value, limit] = against(rule, 3);
    let quantity = &rule.quantity;
    let at_most = if rule.limit_at_most { " at most" } else { "" };
    let said = match rule.met {
        Some(true) => format!("met: {quantity} {value} is within {limit}"),
        Some(false) => format!("not met: {quantity} {value} is more than {limit}{at_most}"),
        None => format!("no result: {quantity} {value}, limit {limit}{at_most}"),
    };
    Some((rule.clone(), said))
}

/// How many rules are left out, the class of tests where that is one of them, and which are not met.
fn left_out(rules: &[AppliedRule], by: Authority) -> String {
    let left: Vec<&AppliedRule> =
        rules.iter().filter(|rule| rule.role != RuleRole::Walk && !is_stated_by(rule, by)).collect();
    let classes = match left.iter().any(|rule| rule.id == TESTS_CONTINUING) {
        true => format!(", with Foster and Fell's classes ({})", tested_words(tested(rules))),
        false => String::new(),
    };
    let broken: Vec<&str> =
        left.iter().filter(|rule| rule.is_broken()).map(|rule| rule.name.as_str()).collect();
    let broken = match broken[..] {
        [] => "none of them is broken".to_owned(),
        _ => format!("not met among them: {}", broken.join("; ")),
    };
    format!("Left out: {} rules of others{classes}; {broken}.", left.len())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Gradation;
    use crate::verdict::PairRules;

    fn pair(filter_scale: f64) -> PairRules {
        let base = Gradation::from_points(&[(0.08, 0.0), (0.3, 100.0)], None).unwrap();
        let sizes = [(0.5 * filter_scale, 0.0), (2.0 * filter_scale, 100.0)];
        PairRules::of(&base, &Gradation::from_points(&sizes, None).unwrap())
    }

    #[test]
    fn an_authority_has_its_own_limit_and_says_what_it_leaves_out() {
        let coarse = pair(2.5);
        let said = |by| of_pair(&coarse.rules, by, coarse.filter.d15_mm);
        assert_eq!(said(Authority::All), None);
        let nrcs = said(Authority::Nrcs).unwrap();
        assert!(nrcs.starts_with("NRCS: not met: D15F 1.54 mm is more than 0.98"), "{nrcs}");
        assert!(nrcs.contains("with Foster and Fell's classes (no erosion); not met among them: Terzaghi"));
        let tests = said(Authority::FosterFell).unwrap();
        assert!(tests.starts_with("Foster and Fell: met: D15F 1.54 mm is within 1.7"), "{tests}");
        assert!(tests.contains("not met among them: Sherard and Dunnigan: the filter retains"), "{tests}");
        assert!(!tests.contains("classes"), "{tests}");
    }

    /// Whatever is not listed and not met is named.
    #[test]
    fn no_broken_rule_is_lost() {
        for scale in [0.1, 0.5, 1.0, 2.0, 4.0, 10.0] {
            let pair = pair(scale);
            for by in Authority::ALL {
                let listed = stated_by(&pair.rules, by);
                let said = of_pair(&pair.rules, by, pair.filter.d15_mm).unwrap_or_default();
                for rule in pair.rules.iter().filter(|rule| rule.is_broken()) {
                    let is_listed = listed.iter().any(|of| of.id == rule.id);
                    assert!(is_listed || said.contains(&rule.name), "{by:?} at {scale}: {}", rule.name);
                }
            }
        }
    }
}
