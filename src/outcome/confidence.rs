//! How far a verdict can be relied on: what rules of practice say against it, and where the model was not
//! checked.

use super::record::{AppliedRule, Confidence, Outcome, RuleRole, Verdict};

/// How far a verdict can be relied on, and why no further: sentences, the weightiest first; then what else
/// the rules say of the pair.
///
/// `doubts` say where the inputs leave the range in which the model was checked.
///
/// Rules speak against verdicts by their role ([`RuleRole::speaks_against`]): rules of retention against "no
/// erosion", the boundary of continuing erosion against "some erosion" too; a filter that does not hold its
/// own fines is not the filter that was walked. A rule of drainage says nothing of retention, but practice
/// would not build a filter that breaks it: "no erosion" does not stand in green there.
pub fn judge(verdict: Verdict, rules: &[AppliedRule], doubts: Vec<String>) -> (Confidence, Vec<String>) {
    let broken = |role: RuleRole| rules.iter().filter(move |rule| rule.is_broken() && rule.role == role);
    let favourable = match verdict {
        Verdict::None => [true, true],
        Verdict::Some => [false, true],
        Verdict::Continuing | Verdict::Undecided => [false, false],
    };
    let retention = broken(RuleRole::Retention).filter(|_| favourable[0]);
    let continuation = broken(RuleRole::Continuation).filter(|_| favourable[1]);
    let against: Vec<String> = retention.chain(continuation).map(sentence).collect();
    let unstable: Vec<String> = broken(RuleRole::Stability).map(sentence).collect();
    let drainage = broken(RuleRole::Drainage).any(|_| favourable[0]);
    let confidence = match (against.is_empty() && !drainage, unstable.is_empty() && doubts.is_empty()) {
        (false, _) => Confidence::Contradicted,
        (true, false) => Confidence::Outside,
        (true, true) => Confidence::Within,
    };
    let besides = broken(RuleRole::Drainage).map(sentence).chain(stricter(verdict, rules)).collect();
    (confidence, [against, unstable, doubts, besides].concat())
}

/// Whether the walk is stricter than tests for this pair: they found no erosion where it has some.
fn stricter(verdict: Verdict, rules: &[AppliedRule]) -> Option<String> {
    let find = |id: &str| rules.iter().find(|rule| rule.id == id && rule.applies);
    let tests = find("foster-fell-no-erosion").filter(|rule| rule.met == Some(true))?;
    let ratio = find("paper-no-erosion").filter(|rule| rule.met == Some(false))?;
    matches!(verdict, Verdict::Some | Verdict::Continuing).then(|| {
        format!(
            "the walk errs on the safe side for this pair; D15F/D85B is {}, tests found no erosion up to \
             D15F {} (Foster and Fell), and this network retains uniform sands up to a ratio near {}",
            ratio.value.map_or("unknown".into(), short),
            size(tests.limit, &tests.unit),
            ratio.limit.map_or("unknown".into(), short)
        )
    })
}

/// A value with its unit.
fn size(value: Option<f64>, unit: &str) -> String {
    with_unit(value.map_or("unknown".into(), short), unit)
}

fn with_unit(number: String, unit: &str) -> String {
    if unit.is_empty() { number } else { format!("{number} {unit}") }
}

/// A value and its limit, with as many digits as tell them apart.
fn against(rule: &AppliedRule) -> [String; 2] {
    let (Some(value), Some(limit)) = (rule.value, rule.limit) else {
        return [size(rule.value, &rule.unit), size(rule.limit, &rule.unit)];
    };
    let pair = |digits| [value, limit].map(|number| digits_of(number, digits));
    let [value, limit] = (2..9).map(pair).find(|[value, limit]| value != limit).unwrap_or_else(|| pair(2));
    [value, limit].map(|number| with_unit(number, &rule.unit))
}

/// What a rule that is not kept says, in a sentence.
fn sentence(rule: &AppliedRule) -> String {
    let [value, limit] = against(rule);
    let quantity = &rule.quantity;
    let whose = rule.name.split(':').next().unwrap_or_default();
    match rule.id.as_str() {
        "sherard-dunnigan" => {
            format!("practice allows D15F {limit}, this is {value} (Sherard and Dunnigan's limit of design)")
        }
        "foster-fell-no-erosion" => {
            format!("tests found no erosion up to D15F {limit}, this is {value} (Foster and Fell)")
        }
        "foster-fell-continuing" => {
            format!("tests found continuing erosion beyond D15F {limit}, this is {value} (Foster and Fell)")
        }
        "permeability" => format!(
            "the filter may be too fine to drain the base: D15F {value}, practice asks for {limit} or \
             more; that says nothing of retention"
        ),
        _ if rule.role == RuleRole::Stability => format!(
            "the filter may lose its own fines, and with them the constrictions that were walked: \
             {quantity} is {value}, the limit {limit} ({whose})"
        ),
        _ => {
            let besides =
                if rule.role == RuleRole::Drainage { "; that says nothing of retention" } else { "" };
            format!("practice allows {quantity} up to {limit}, this is {value} ({whose}){besides}")
        }
    }
}

/// Two digits that mean something, or three from 100 on.
fn short(value: f64) -> String {
    digits_of(value, 2)
}

fn digits_of(value: f64, digits: i32) -> String {
    if value == 0.0 || !value.is_finite() {
        return value.to_string();
    }
    let decimals = (digits - 1 - value.abs().log10().floor() as i32).clamp(0, digits + 4);
    format!("{value:.*}", decimals as usize)
}

impl Outcome {
    /// The verdict in a line, with the first reason why it cannot be relied on as it stands.
    pub fn headline(&self) -> String {
        let verdict = self.verdict.words();
        let model = if self.confidence == Confidence::Within { "" } else { " in the model" };
        let Some(reason) = self.reasons.first() else { return format!("{verdict}{model}") };
        // What follows its first clause stands where all reasons are listed.
        let ends = ["; ", ". "].into_iter().filter_map(|end| reason.find(end));
        let clause = &reason[..ends.min().unwrap_or(reason.len())];
        format!("{verdict}{model}; {clause}")
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::gradation::Gradation;
    use crate::outcome::{PairOptions, PairRules};

    fn rules(filter: &[(f64, f64)], base: &[(f64, f64)]) -> Vec<AppliedRule> {
        let soil = |points| Gradation::from_points(points, None).unwrap();
        PairRules::of(&soil(base), &soil(filter)).rules
    }

    const TILL: [(f64, f64); 5] = [(0.075, 35.0), (0.425, 60.0), (2.0, 82.0), (4.75, 92.0), (19.0, 100.0)];
    const GRAVEL: [(f64, f64); 3] = [(5.0, 0.0), (6.5, 15.0), (20.0, 100.0)];
    const SAND: [(f64, f64); 2] = [(0.2, 0.0), (0.6, 100.0)];

    #[test]
    fn a_favourable_verdict_that_practice_does_not_share_is_contradicted() {
        let all = rules(&GRAVEL, &TILL);
        let (confidence, reasons) = judge(Verdict::None, &all, vec!["35 % fines".into()]);
        assert_eq!(confidence, Confidence::Contradicted);
        assert!(reasons[0].starts_with("practice allows D15F 1.1 mm, this is 6.5 mm"), "{}", reasons[0]);
        assert_eq!(reasons.last().unwrap(), "35 % fines");
        assert!(!reasons.iter().any(|reason| reason.contains("nothing of retention")), "{reasons:?}");
        // The same rules share an unfavourable one.
        assert_eq!(judge(Verdict::Continuing, &all, Vec::new()), (Confidence::Within, Vec::new()));
    }

    /// No pair of soils of which an applicable rule of practice is not kept is within the checked range.
    #[test]
    fn none_is_green_where_an_applicable_rule_fails() {
        let mut failed = 0;
        for filter in 1..40 {
            for fines in [0.0, 5.0, 20.0, 38.0, 60.0] {
                let d = 0.1 * 1.2f64.powi(filter);
                let all = rules(
                    &[(d, 0.0), (2.0 * d, 100.0)],
                    &[(0.01, 0.0), (0.074, fines), (0.3, 85.0), (0.6, 100.0)],
                );
                let fails = all
                    .iter()
                    .any(|rule| rule.role != RuleRole::Walk && rule.applies && rule.met == Some(false));
                failed += u32::from(fails);
                let (confidence, reasons) = judge(Verdict::None, &all, Vec::new());
                assert!(!fails || confidence != Confidence::Within && !reasons.is_empty());
            }
        }
        assert!((20..195).contains(&failed), "{failed}");
    }

    /// D15F 0.704 mm on a silt, for which practice allows 0.7 mm.
    #[test]
    fn a_value_just_beyond_its_limit_is_told_from_it() {
        let silt = [(0.01, 0.0), (0.05, 40.0), (0.075, 55.0), (0.3, 100.0)];
        let all = rules(&[(0.6, 0.0), (0.704, 15.0), (1.5, 100.0)], &silt);
        let (_, reasons) = judge(Verdict::None, &all, Vec::new());
        assert!(reasons[0].starts_with("practice allows D15F 0.700 mm, this is 0.704 mm"), "{reasons:?}");
    }

    #[test]
    fn a_clean_sand_within_every_rule_is_within() {
        let good = rules(&[(1.0, 0.0), (3.0, 100.0)], &SAND);
        assert_eq!(judge(Verdict::None, &good, Vec::new()), (Confidence::Within, Vec::new()));
        let (confidence, reasons) = judge(Verdict::None, &good, vec!["a guess".into()]);
        assert_eq!((confidence, reasons.len()), (Confidence::Outside, 1));
    }

    /// D15F 0.6 mm on a silt: 0.7 mm is allowed, 0.5 mm where it is dispersive.
    #[test]
    fn a_dispersive_base_that_breaks_a_rule_is_contradicted() {
        let soil = |points: &[(f64, f64)]| Gradation::from_points(points, None).unwrap();
        let filter = [("f".to_owned(), soil(&[(0.5, 0.0), (0.6, 15.0), (1.0, 70.0), (1.5, 100.0)]))];
        let base = [("b".to_owned(), soil(&[(0.01, 0.0), (0.05, 40.0), (0.075, 55.0), (0.3, 100.0)]))];
        let judged = |dispersive| {
            let options = PairOptions { dispersive, ..PairOptions::default() };
            judge(Verdict::None, &PairRules::of_envelopes(&base, &filter, options).rules, Vec::new())
        };
        assert_eq!(judged(false), (Confidence::Within, Vec::new()));
        let (confidence, reasons) = judged(true);
        assert_eq!(confidence, Confidence::Contradicted);
        assert!(reasons[0].starts_with("practice allows D15F 0.50 mm, this is 0.60 mm"), "{reasons:?}");
    }

    #[test]
    fn too_fine_and_unstable_filters_are_reasons() {
        let (confidence, reasons) = judge(Verdict::None, &rules(&SAND, &SAND), Vec::new());
        // A filter that does not drain may hold all the same, but practice would not build it.
        assert_eq!((confidence, reasons.len()), (Confidence::Contradicted, 1));
        assert!(reasons[0].contains("too fine to drain") && reasons[0].contains("nothing of retention"));
        let gap = [(1.0, 0.0), (1.2, 15.0), (8.0, 15.0), (20.0, 100.0)];
        let (confidence, reasons) = judge(Verdict::None, &rules(&gap, &SAND), Vec::new());
        // Its Cu is more than practice takes, too.
        assert_eq!(confidence, Confidence::Contradicted, "{reasons:?}");
        assert!(reasons[0].contains("lose its own fines"), "{reasons:?}");
    }

    /// D15F/D85B of 5.9: tests put the end of no erosion at 7, the network near 5.
    #[test]
    fn which_way_the_walk_errs_is_said_of_uniform_sands() {
        let all = rules(&[(2.5, 0.0), (5.0, 100.0)], &SAND);
        for verdict in [Verdict::Some, Verdict::Continuing] {
            let (confidence, reasons) = judge(verdict, &all, Vec::new());
            assert_eq!((confidence, reasons.len()), (Confidence::Within, 1), "{reasons:?}");
            assert!(reasons[0].starts_with("the walk errs on the safe side for this pair; D15F/D85B is 5.5"));
        }
        assert!(!judge(Verdict::None, &all, Vec::new()).1.iter().any(|said| said.contains("safe side")));
    }

    #[test]
    fn continuing_erosion_of_tests_speaks_against_some_erosion() {
        let all = rules(&[(8.0, 0.0), (16.0, 100.0)], &SAND);
        let (confidence, reasons) = judge(Verdict::Some, &all, Vec::new());
        assert_eq!((confidence, reasons.len()), (Confidence::Contradicted, 1));
        assert!(reasons[0].starts_with("tests found continuing erosion beyond D15F 5.1 mm"), "{reasons:?}");
    }
}
