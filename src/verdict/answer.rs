//! The confidence label of a verdict and the findings that set it, the most important first.

use std::cmp::Reverse;

use super::entry::Finding;
use super::finding::ALL;
use super::practice;
use crate::outcome::record::{AppliedRule, Confidence, FindingRecord, Verdict, Weight};

/// A class and what it is worth.
#[derive(Clone, Debug, PartialEq)]
pub struct Judgement {
    /// The class.
    pub verdict: Verdict,
    /// How far it can be relied on: the worst label that a finding against it sets.
    pub confidence: Confidence,
    /// The findings: those that speak against the class first, the weightiest of them before all.
    pub findings: Vec<FindingRecord>,
}

impl Judgement {
    /// The sentences that speak against the class, in order.
    pub fn reasons(&self) -> Vec<String> {
        self.of_kind(true).map(|finding| finding.sentence.clone()).collect()
    }

    /// The same, each with the setting that changes it.
    pub fn reasons_to_do(&self) -> Vec<String> {
        self.of_kind(true).map(FindingRecord::with_to_do).collect()
    }

    /// The sentences of all other findings, in order, each with the setting that changes it.
    pub fn notes_to_do(&self) -> Vec<String> {
        self.of_kind(false).map(FindingRecord::with_to_do).collect()
    }

    fn of_kind(&self, against: bool) -> impl Iterator<Item = &FindingRecord> {
        self.findings.iter().filter(move |finding| finding.against == against)
    }
}

/// The place of a finding among others of its label: by weight, and in the order of the table.
pub fn rank(finding: &Finding) -> (Weight, Option<usize>) {
    (finding.entry.weight, ALL.iter().position(|entry| entry.id == finding.id()))
}

/// What a class is worth, by rules of practice and by what was found.
///
/// Each finding that speaks against the class has a label that it would set alone, and the worst comes first:
/// so label and first finding agree. Only an undecided verdict begins with what leaves it open. Rules of
/// retention speak against "no erosion", the boundary of continuing erosion against "some erosion" too. A
/// filter that does not hold its own fines is not the filter that was walked, but only coarser without them:
/// that makes "continuing erosion" the surer. A rule of drainage or placing says nothing of retention, but
/// practice would not build a filter that breaks it: "no erosion" does not stand in green there. What makes a
/// verdict surer is no doubt of it ([`Finding::is_against`]).
pub fn judge(verdict: Verdict, rules: &[AppliedRule], findings: Vec<Finding>) -> Judgement {
    let mut all: Vec<Finding> = Vec::new();
    for finding in practice::findings(verdict, rules).into_iter().chain(findings) {
        if !all.contains(&finding) {
            all.push(finding);
        }
    }
    all.sort_by_cached_key(|finding| {
        let sets = finding.is_against(verdict).then_some(finding.entry.sets);
        let leaves_open = verdict == Verdict::Undecided && finding.entry.weight == Weight::Decides;
        // What evidence settles stands below what it does not.
        (Reverse(leaves_open), Reverse(sets), finding.is_settled, rank(finding))
    });
    let confidence = all.iter().filter(|of| of.is_against(verdict)).map(|of| of.entry.sets).max();
    Judgement {
        verdict,
        confidence: confidence.unwrap_or(Confidence::Within),
        findings: all.iter().map(|finding| finding.record(finding.is_against(verdict))).collect(),
    }
}

#[cfg(test)]
mod tests {
    use super::super::finding;
    use super::*;
    use crate::gradation::Gradation;
    use crate::outcome::record::Direction;
    use crate::verdict::{PairOptions, PairRules};

    fn rules(filter: &[(f64, f64)], base: &[(f64, f64)]) -> Vec<AppliedRule> {
        let soil = |points| Gradation::from_lines(points).unwrap();
        PairRules::of(&soil(base), &soil(filter)).rules
    }

    /// Findings that point every way.
    fn open() -> Finding {
        finding::cohesive_fines(35.0)
    }

    fn errs_unsafe() -> Finding {
        finding::broadly_graded(9.0)
    }

    fn is_within(answer: &Judgement, notes: &[&str]) {
        assert_eq!((answer.confidence, answer.reasons()), (Confidence::Within, Vec::new()), "{answer:?}");
        let ids: Vec<&str> = answer.findings.iter().map(|finding| finding.id.as_str()).collect();
        assert_eq!(ids, notes);
    }

    const TILL: [(f64, f64); 5] = [(0.075, 35.0), (0.425, 60.0), (2.0, 82.0), (4.75, 92.0), (19.0, 100.0)];
    const GRAVEL: [(f64, f64); 3] = [(5.0, 0.0), (6.5, 15.0), (20.0, 100.0)];
    const SAND: [(f64, f64); 2] = [(0.2, 0.0), (0.6, 100.0)];
    /// 15 % below its gap.
    const GAP: [(f64, f64); 4] = [(1.0, 0.0), (1.2, 16.0), (8.0, 16.0), (20.0, 100.0)];

    #[test]
    fn a_favourable_verdict_that_practice_does_not_share_is_contradicted() {
        let all = rules(&GRAVEL, &TILL);
        let found = judge(Verdict::None, &all, vec![open()]);
        assert_eq!(found.confidence, Confidence::Contradicted);
        assert!(
            found.reasons()[0].starts_with("The limit of design is D15F 1.12 mm, this is 6.50 mm"),
            "{found:?}"
        );
        assert_eq!(
            found.reasons().last().unwrap(),
            "The base has 35 % fines (finer than 0.075 mm), and the model ignores cohesion."
        );
        assert!(!found.reasons().iter().any(|reason| reason.contains("nothing of retention")), "{found:?}");
        // The same rules share an unfavourable one.
        is_within(&judge(Verdict::Continuing, &all, Vec::new()), &[]);
    }

    /// Which label the first reason has, by its words.
    fn label_of(reason: Option<&String>) -> Confidence {
        let says = |words: &str| reason.is_some_and(|reason| reason.contains(words));
        match reason {
            None => Confidence::Within,
            Some(_) if says("may lose its finer part") => Confidence::Unstable,
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
                        let settled = finding::pan_passive(3.0);
                        for one in [None, Some(open()), Some(errs_unsafe()), Some(settled)] {
                            let found = judge(verdict, &all, one.into_iter().collect());
                            assert_eq!(found.confidence, label_of(found.reasons().first()), "{found:?}");
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
        let reasons = judge(Verdict::None, &all, Vec::new()).reasons();
        assert!(
            reasons[0].starts_with("The limit of design is D15F 0.700 mm, this is 0.704 mm"),
            "{reasons:?}"
        );
    }

    #[test]
    fn a_clean_sand_within_every_rule_is_within() {
        let good = rules(&[(1.0, 0.0), (3.0, 100.0)], &SAND);
        is_within(&judge(Verdict::None, &good, Vec::new()), &[]);
        let found = judge(Verdict::None, &good, vec![finding::guessed_constrictions()]);
        assert_eq!((found.confidence, found.reasons().len()), (Confidence::Outside, 1));
    }

    /// What points the way of the verdict stands beside it, and costs nothing.
    #[test]
    fn a_reason_that_makes_a_verdict_surer_is_no_doubt_of_it() {
        let all = rules(&GRAVEL, &SAND);
        let unsafe_way = || vec![errs_unsafe()];
        let continuing = judge(Verdict::Continuing, &all, unsafe_way());
        is_within(&continuing, &["broadly_graded"]);
        let some = judge(Verdict::Some, &rules(&[(1.0, 0.0), (3.0, 100.0)], &SAND), unsafe_way());
        assert_eq!(some.confidence, Confidence::Outside);
        // A filter that loses its fines is only coarser.
        let unstable = judge(Verdict::Continuing, &rules(&GAP, &SAND), Vec::new());
        assert_eq!(unstable.confidence, Confidence::Within);
        assert!(
            unstable.notes_to_do().iter().any(|note| note.contains("lose its finer part")),
            "{unstable:?}"
        );
    }

    /// D15F 0.6 mm on a silt: 0.7 mm is allowed, 0.5 mm where it is dispersive.
    #[test]
    fn a_dispersive_base_that_breaks_a_rule_is_contradicted() {
        let soil = |points: &[(f64, f64)]| Gradation::from_lines(points).unwrap();
        let filter = [("f".to_owned(), soil(&[(0.5, 0.0), (0.6, 15.0), (1.0, 70.0), (1.5, 100.0)]))];
        let base = [("b".to_owned(), soil(&[(0.01, 0.0), (0.05, 40.0), (0.075, 55.0), (0.3, 100.0)]))];
        let judged = |dispersive| {
            let options = PairOptions { dispersive, ..PairOptions::default() };
            judge(Verdict::None, &PairRules::of_envelopes(&base, &filter, options).rules, Vec::new())
        };
        is_within(&judged(false), &[]);
        let found = judged(true);
        assert_eq!(found.confidence, Confidence::Contradicted);
        assert!(
            found.reasons()[0]
                .starts_with("Practice allows D15F up to 0.500 mm, this is 0.600 mm (Fell et al."),
            "{found:?}"
        );
    }

    /// Practice agrees that it holds; practice would not build it all the same.
    #[test]
    fn a_filter_that_may_not_drain_is_not_contradicted_by_practice() {
        let found = judge(Verdict::None, &rules(&SAND, &SAND), vec![finding::guessed_constrictions()]);
        assert_eq!((found.confidence, found.reasons().len()), (Confidence::MayNotDrain, 2));
        assert!(
            found.reasons()[0].contains("too fine to drain") && found.reasons()[0].contains("EM 1110-2-1901")
        );
        assert!(found.reasons()[0].ends_with("This says nothing of retention."));
        assert_eq!(judge(Verdict::Some, &rules(&SAND, &SAND), Vec::new()).confidence, Confidence::Within);
    }

    /// Four authors who say the same of it are one reason.
    #[test]
    fn a_filter_that_may_lose_its_fines_is_unstable_in_one_sentence() {
        let found = judge(Verdict::None, &rules(&GAP, &SAND), Vec::new());
        assert_eq!(found.confidence, Confidence::Unstable, "{found:?}");
        let said = |words: &str| found.reasons().iter().filter(|reason| reason.contains(words)).count();
        assert_eq!(said("lose its finer part"), 1, "{found:?}");
        for author in ["Kézdi (1979)", "Kenney and Lau (1986)", "Li and Fannin (2008)", "Burenkova (1993)"] {
            assert!(found.reasons()[0].contains(author), "{author}: {found:?}");
        }
    }

    /// D15F/D85B of 5.9: tests put the end of no erosion at 7, the network near 5.
    #[test]
    fn which_way_the_walk_errs_is_said_of_uniform_sands() {
        let all = rules(&[(2.5, 0.0), (5.0, 100.0)], &SAND);
        for verdict in [Verdict::Some, Verdict::Continuing] {
            let found = judge(verdict, &all, Vec::new());
            assert_eq!((found.confidence, found.notes_to_do().len()), (Confidence::Within, 1), "{found:?}");
            let begin = "The walk errs on the safe side for this pair. D15F/D85B is 5.5";
            assert!(found.notes_to_do()[0].starts_with(begin), "{found:?}");
        }
        let found = judge(Verdict::None, &all, Vec::new());
        assert!(!found.findings.iter().any(|of| of.sentence.contains("safe side")), "{found:?}");
    }

    #[test]
    fn continuing_erosion_of_tests_speaks_against_some_erosion() {
        let all = rules(&[(8.0, 0.0), (16.0, 100.0)], &SAND);
        let found = judge(Verdict::Some, &all, Vec::new());
        assert_eq!((found.confidence, found.reasons().len()), (Confidence::Contradicted, 1));
        let begin = "Tests found continuing erosion beyond D15F 5.11 mm";
        assert!(found.reasons()[0].starts_with(begin), "{found:?}");
    }

    #[test]
    fn what_makes_a_verdict_surer_is_no_doubt_of_it() {
        for entry in ALL.iter().filter(|entry| entry.against.is_none()) {
            let against =
                |verdict| Finding { entry, values: Vec::new(), is_settled: false }.is_against(verdict);
            let is_open = |verdict| match (entry.weight, entry.direction) {
                (Weight::Note, _) | (_, Direction::Settled) => false,
                (_, Direction::Open) => true,
                (_, Direction::Unsafe) => verdict != Verdict::Continuing,
                (_, Direction::Safe) => verdict != Verdict::None,
            };
            for verdict in Verdict::ALL {
                assert_eq!(against(verdict), is_open(verdict), "{}", entry.id);
            }
        }
    }

    /// The label is the worst all the same.
    #[test]
    fn an_undecided_verdict_of_an_unstable_filter_begins_with_what_leaves_it_open() {
        let pan = finding::pan_decides(35.0, 0.075, 0.04, "it is continuing erosion", "it is no erosion");
        let found = judge(Verdict::Undecided, &rules(&GAP, &SAND), vec![open(), pan]);
        let ids: Vec<&str> = found.findings.iter().map(|finding| finding.id.as_str()).collect();
        assert_eq!(ids[..3], ["pan_decides", "loses_fines", "cohesive_fines"]);
        assert_eq!(found.confidence, Confidence::Unstable);
    }

    /// Whatever leaves it open, and that alone says nothing of the checked range.
    #[test]
    fn an_undecided_verdict_begins_with_what_its_replicates_or_runs_leave_open() {
        let level = || finding::level_missed(99.0, "first", "7.4 %", 0.1, 1.0, "More");
        for opens in [finding::replicates_leave_open(), finding::second_run_missing(), level()] {
            let found = judge(Verdict::Undecided, &[], vec![open(), opens.clone()]);
            let ids: Vec<&str> = found.findings.iter().map(|finding| finding.id.as_str()).collect();
            assert_eq!((ids[0], ids[1]), (opens.id(), "cohesive_fines"));
            assert!(found.findings[0].against && found.confidence == Confidence::Outside, "{found:?}");
            let alone = judge(Verdict::Undecided, &[], vec![opens]);
            assert_eq!((alone.confidence, alone.reasons().len()), (Confidence::Within, 1));
        }
    }

    /// What decides an undecided class comes before what only costs the checked range, notes come last, and
    /// nothing is said twice.
    #[test]
    fn findings_stand_in_the_order_of_their_weight_whatever_the_order_in_which_they_came() {
        let pan = finding::pan_decides(35.0, 0.075, 0.04, "it is continuing erosion", "it is no erosion");
        let mut all = vec![finding::not_studied(), open(), pan, finding::pan_of_filter(2.0), open()];
        let wanted = ["pan_decides", "cohesive_fines", "not_studied", "pan_of_filter"];
        for _ in 0..all.len() {
            all.rotate_left(1);
            let answer = judge(Verdict::Undecided, &[], all.clone());
            let ids: Vec<&str> = answer.findings.iter().map(|finding| finding.id.as_str()).collect();
            assert!(ids[..2] == wanted[..2] && ids.len() == 4, "{ids:?}");
            assert!(answer.findings[0].against && answer.confidence == Confidence::Outside, "{answer:?}");
        }
    }
}
