//! The confidence label of a verdict and what sets it: rules of practice that speak against it, and where the
//! model was not checked.

use super::doubt::Doubt;
use super::record::{AppliedRule, Confidence, Outcome, RuleRole, Verdict};
use super::rule_words::{besides, said_of, said_of_all};

/// How far a verdict can be relied on.
#[derive(Clone, Debug, PartialEq)]
pub struct Judgement {
    /// The label: that of the first reason.
    pub confidence: Confidence,
    /// Why no further: sentences, the weightiest first; none where the verdict is within the checked range.
    pub reasons: Vec<String>,
    /// What else is to be known of the pair. None of it speaks against the verdict.
    pub notes: Vec<String>,
}

/// How far a verdict can be relied on, and why no further.
///
/// Every reason has the label that it would set alone, and the worst comes first: so label and first reason
/// agree. Rules speak against verdicts by their role ([`RuleRole::speaks_against`]): rules of retention
/// against "no erosion", the boundary of continuing erosion against "some erosion" too. A filter that does
/// not hold its own fines is not the filter that was walked, but only coarser without them: that makes
/// "continuing erosion" the surer. A rule of drainage or placing says nothing of retention, but practice
/// would not build a filter that breaks it: "no erosion" does not stand in green there. A doubt counts where
/// it could turn the verdict ([`Doubt::is_against`]).
pub fn judge(verdict: Verdict, rules: &[AppliedRule], doubts: Vec<Doubt>) -> Judgement {
    let broken = |role: RuleRole| -> Vec<&AppliedRule> {
        rules.iter().filter(|rule| rule.is_broken() && rule.role == role).collect()
    };
    let against = |role: RuleRole| match (role, verdict) {
        (RuleRole::Retention, Verdict::None) => Some(Confidence::Contradicted),
        (RuleRole::Continuation, Verdict::None | Verdict::Some) => Some(Confidence::Contradicted),
        (RuleRole::Stability, Verdict::Continuing) => None,
        (RuleRole::Stability, _) => Some(Confidence::Unstable),
        (RuleRole::Drainage, Verdict::None) => Some(Confidence::MayNotDrain),
        (RuleRole::Placing, Verdict::None) => Some(Confidence::MaySegregate),
        _ => None,
    };
    let mut reasons: Vec<(Confidence, String)> = Vec::new();
    let mut notes: Vec<String> = Vec::new();
    for role in [RuleRole::Retention, RuleRole::Continuation] {
        let label = against(role);
        reasons.extend(broken(role).into_iter().filter_map(|rule| Some((label?, said_of(rule)))));
    }
    notes.extend(stricter(verdict, rules));
    for role in [RuleRole::Stability, RuleRole::Drainage, RuleRole::Placing] {
        let Some(said) = said_of_all(role, &broken(role)) else { continue };
        match against(role) {
            Some(label) => reasons.push((label, said)),
            None => notes.push(said),
        }
    }
    for doubt in doubts {
        match doubt.is_against(verdict) {
            true => reasons.push((Confidence::Outside, doubt.said)),
            false => notes.push(doubt.said),
        }
    }
    reasons.sort_by_key(|(label, _)| std::cmp::Reverse(*label));
    let confidence = reasons.first().map_or(Confidence::Within, |(label, _)| *label);
    Judgement { confidence, reasons: reasons.into_iter().map(|(_, said)| said).collect(), notes }
}

/// Whether the walk is stricter than tests for this pair: they found no erosion where it has some.
fn stricter(verdict: Verdict, rules: &[AppliedRule]) -> Option<String> {
    let find = |id: &str| rules.iter().find(|rule| rule.id == id && rule.applies);
    let tests = find("foster-fell-no-erosion").filter(|rule| rule.met == Some(true))?;
    let ratio = find("paper-no-erosion").filter(|rule| rule.met == Some(false))?;
    matches!(verdict, Verdict::Some | Verdict::Continuing).then(|| besides(tests, ratio))
}

impl Outcome {
    /// The reasons that the headline leaves out.
    pub fn reasons_below(&self) -> &[String] {
        let is_said = self.verdict != Verdict::Continuing
            && !(self.verdict == Verdict::None && self.confidence == Confidence::Unstable);
        &self.reasons[usize::from(is_said && !self.reasons.is_empty())..]
    }

    /// The verdict in a line, with the first reason why it cannot be relied on as it stands.
    pub fn headline(&self) -> String {
        let verdict = self.verdict.words();
        match (self.verdict, self.confidence, self.reasons.first()) {
            (_, Confidence::Within, _) | (_, _, None) => verdict.to_owned(),
            // No reason of an unfavourable verdict makes the filter a better one; they follow below it.
            (Verdict::Continuing, ..) => format!("{verdict} in the model"),
            (Verdict::None, Confidence::Unstable, _) => {
                format!("{verdict} only while the filter keeps its own fines, which it may lose")
            }
            (.., Some(reason)) => {
                // What follows its first clause stands where all reasons are listed.
                let ends = ["; ", ". "].into_iter().filter_map(|end| reason.find(end));
                let clause = &reason[..ends.min().unwrap_or(reason.len())];
                format!("{verdict} in the model; {clause}")
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::doubt::Way;
    use super::*;
    use crate::gradation::Gradation;
    use crate::outcome::{PairOptions, PairRules};

    fn rules(filter: &[(f64, f64)], base: &[(f64, f64)]) -> Vec<AppliedRule> {
        let soil = |points| Gradation::from_points(points, None).unwrap();
        PairRules::of(&soil(base), &soil(filter)).rules
    }

    fn doubt(said: &str, way: Way) -> Doubt {
        Doubt { said: said.into(), way }
    }

    fn within(notes: &[&str]) -> Judgement {
        let notes = notes.iter().map(ToString::to_string).collect();
        Judgement { confidence: Confidence::Within, reasons: Vec::new(), notes }
    }

    const TILL: [(f64, f64); 5] = [(0.075, 35.0), (0.425, 60.0), (2.0, 82.0), (4.75, 92.0), (19.0, 100.0)];
    const GRAVEL: [(f64, f64); 3] = [(5.0, 0.0), (6.5, 15.0), (20.0, 100.0)];
    const SAND: [(f64, f64); 2] = [(0.2, 0.0), (0.6, 100.0)];
    /// 15 % below its gap.
    const GAP: [(f64, f64); 4] = [(1.0, 0.0), (1.2, 15.0), (8.0, 15.0), (20.0, 100.0)];

    #[test]
    fn a_favourable_verdict_that_practice_does_not_share_is_contradicted() {
        let all = rules(&GRAVEL, &TILL);
        let found = judge(Verdict::None, &all, vec![doubt("35 % fines", Way::Open)]);
        assert_eq!(found.confidence, Confidence::Contradicted);
        assert!(found.reasons[0].starts_with("practice allows D15F 1.1 mm, this is 6.5 mm"), "{found:?}");
        assert_eq!(found.reasons.last().unwrap(), "35 % fines");
        assert!(!found.reasons.iter().any(|reason| reason.contains("nothing of retention")), "{found:?}");
        // The same rules share an unfavourable one.
        assert_eq!(judge(Verdict::Continuing, &all, Vec::new()), within(&[]));
    }

    /// Which label the first reason has, by its words.
    fn label_of(reason: Option<&String>) -> Confidence {
        let says = |words: &str| reason.is_some_and(|reason| reason.contains(words));
        match reason {
            None => Confidence::Within,
            Some(_) if says("may lose its own fines") => Confidence::Unstable,
            Some(_) if says("drain") => Confidence::MayNotDrain,
            Some(_) if says("may segregate") => Confidence::MaySegregate,
            Some(_) if says("D15F") => Confidence::Contradicted,
            Some(_) => Confidence::Outside,
        }
    }

    /// Over filters from too fine to far too coarse, stable and not, and bases of every category: the first
    /// reason sets the label, only what is within the checked range has none, and no pair of which a rule of
    /// practice is not kept is within.
    #[test]
    fn the_first_reason_sets_the_label_and_none_is_green_where_a_rule_fails() {
        let mut seen = std::collections::BTreeMap::new();
        for filter in 1..40 {
            for fines in [0.0, 5.0, 20.0, 38.0, 60.0] {
                let d = 0.1 * 1.2f64.powi(filter);
                let shapes: [&[(f64, f64)]; 3] = [
                    &[(d, 0.0), (2.0 * d, 100.0)],
                    &[(d, 0.0), (1.2 * d, 15.0), (8.0 * d, 15.0), (20.0 * d, 100.0)],
                    &[(d, 0.0), (60.0 * d, 100.0)],
                ];
                for shape in shapes {
                    let all = rules(shape, &[(0.01, 0.0), (0.074, fines), (0.3, 85.0), (0.6, 100.0)]);
                    for verdict in Verdict::ALL {
                        for way in [None, Some(Way::Open), Some(Way::Unsafe), Some(Way::Settled)] {
                            let doubts = way.map(|way| doubt("a guess", way)).into_iter().collect();
                            let found = judge(verdict, &all, doubts);
                            assert_eq!(found.confidence, label_of(found.reasons.first()), "{found:?}");
                            *seen.entry(found.confidence).or_insert(0) += 1;
                            let fails = all.iter().any(AppliedRule::is_broken);
                            let is_green = verdict == Verdict::None && found.confidence == Confidence::Within;
                            assert!(!fails || !is_green);
                        }
                    }
                }
            }
        }
        assert_eq!(seen.len(), 6, "every label is met: {seen:?}");
    }

    /// D15F 0.704 mm on a silt, for which practice allows 0.7 mm.
    #[test]
    fn a_value_just_beyond_its_limit_is_told_from_it() {
        let silt = [(0.01, 0.0), (0.05, 40.0), (0.075, 55.0), (0.3, 100.0)];
        let all = rules(&[(0.6, 0.0), (0.704, 15.0), (1.5, 100.0)], &silt);
        let reasons = judge(Verdict::None, &all, Vec::new()).reasons;
        assert!(reasons[0].starts_with("practice allows D15F 0.700 mm, this is 0.704 mm"), "{reasons:?}");
    }

    #[test]
    fn a_clean_sand_within_every_rule_is_within() {
        let good = rules(&[(1.0, 0.0), (3.0, 100.0)], &SAND);
        assert_eq!(judge(Verdict::None, &good, Vec::new()), within(&[]));
        let found = judge(Verdict::None, &good, vec![doubt("a guess", Way::Open)]);
        assert_eq!((found.confidence, found.reasons.len()), (Confidence::Outside, 1));
    }

    /// What points the way of the verdict stands beside it, and costs nothing.
    #[test]
    fn a_reason_that_makes_a_verdict_surer_is_no_doubt_of_it() {
        let all = rules(&GRAVEL, &SAND);
        let unsafe_way = || vec![doubt("the model errs on the unsafe side", Way::Unsafe)];
        let continuing = judge(Verdict::Continuing, &all, unsafe_way());
        assert_eq!(continuing, within(&["the model errs on the unsafe side"]));
        let some = judge(Verdict::Some, &rules(&[(1.0, 0.0), (3.0, 100.0)], &SAND), unsafe_way());
        assert_eq!(some.confidence, Confidence::Outside);
        // A filter that loses its fines is only coarser.
        let unstable = judge(Verdict::Continuing, &rules(&GAP, &SAND), Vec::new());
        assert_eq!(unstable.confidence, Confidence::Within);
        assert!(unstable.notes.iter().any(|note| note.contains("lose its own fines")), "{unstable:?}");
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
        assert_eq!(judged(false), within(&[]));
        let found = judged(true);
        assert_eq!(found.confidence, Confidence::Contradicted);
        assert!(found.reasons[0].starts_with("practice allows D15F 0.50 mm, this is 0.60 mm"), "{found:?}");
    }

    /// Practice agrees that it holds; practice would not build it all the same.
    #[test]
    fn a_filter_that_may_not_drain_is_not_contradicted_by_practice() {
        let found = judge(Verdict::None, &rules(&SAND, &SAND), vec![doubt("a guess", Way::Open)]);
        assert_eq!((found.confidence, found.reasons.len()), (Confidence::MayNotDrain, 2));
        assert!(
            found.reasons[0].contains("too fine to drain") && found.reasons[0].contains("EM 1110-2-1901")
        );
        assert!(found.reasons[0].ends_with("that says nothing of retention"));
        assert_eq!(judge(Verdict::Some, &rules(&SAND, &SAND), Vec::new()).confidence, Confidence::Within);
    }

    /// Four authors who say the same of it are one reason.
    #[test]
    fn a_filter_that_may_lose_its_fines_is_unstable_in_one_sentence() {
        let found = judge(Verdict::None, &rules(&GAP, &SAND), Vec::new());
        assert_eq!(found.confidence, Confidence::Unstable, "{found:?}");
        let said = |words: &str| found.reasons.iter().filter(|reason| reason.contains(words)).count();
        assert_eq!(said("lose its own fines"), 1, "{found:?}");
        for author in ["Kézdi (1979)", "Kenney and Lau (1986)", "Li and Fannin (2008)", "Burenkova (1993)"] {
            assert!(found.reasons[0].contains(author), "{author}: {found:?}");
        }
    }

    /// D15F/D85B of 5.9: tests put the end of no erosion at 7, the network near 5.
    #[test]
    fn which_way_the_walk_errs_is_said_of_uniform_sands() {
        let all = rules(&[(2.5, 0.0), (5.0, 100.0)], &SAND);
        for verdict in [Verdict::Some, Verdict::Continuing] {
            let found = judge(verdict, &all, Vec::new());
            assert_eq!((found.confidence, found.notes.len()), (Confidence::Within, 1), "{found:?}");
            let begin = "the walk errs on the safe side for this pair; D15F/D85B is 5.5";
            assert!(found.notes[0].starts_with(begin), "{found:?}");
        }
        let found = judge(Verdict::None, &all, Vec::new());
        let all = found.reasons.iter().chain(&found.notes);
        assert!(!all.clone().any(|said| said.contains("safe side")), "{found:?}");
    }

    #[test]
    fn continuing_erosion_of_tests_speaks_against_some_erosion() {
        let all = rules(&[(8.0, 0.0), (16.0, 100.0)], &SAND);
        let found = judge(Verdict::Some, &all, Vec::new());
        assert_eq!((found.confidence, found.reasons.len()), (Confidence::Contradicted, 1));
        let begin = "tests found continuing erosion beyond D15F 5.1 mm";
        assert!(found.reasons[0].starts_with(begin), "{found:?}");
    }
}
