//! What is said of a base of which nobody has said whether it is dispersive.
//!
//! A sieve table does not tell it, tests of dispersive soils had other boundaries, and practice has other
//! limits for them. Only a class that trusts the filter needs the statement.

use super::entry::Finding;
use super::finding;
use super::quantity::fixed;
use super::washout::{lost_beyond, washout};
use crate::gradation::{FEW_FINES, Gradation};
use crate::outcome::apart::value_and_limit;
use crate::outcome::design::band::{open_retention, retention};
use crate::outcome::numbers::rounded_down;
use crate::outcome::record::{AppliedRule, DispersiveLack, IfDispersive, Verdict};
use crate::outcome::rules::{NamedCurve, RuleInputs, apply};

/// What to do where the limit of a pair is not known.
const TEST_PAIR: &str = "have the pair tested";

/// The same where a filter is specified for a base.
const TEST_WITH_FILTER: &str = "have the base tested with the filter";

impl IfDispersive {
    /// Of a pair whose base is taken as dispersive. `None` where it has few fines, or they are not known.
    pub fn of(if_dispersive: &RuleInputs) -> Option<Self> {
        if if_dispersive.base_soil.fines_percent? < FEW_FINES {
            return None;
        }
        let rules = apply(if_dispersive);
        let (strictest, d15f_max_mm) = retention(&rules, if_dispersive.filter.d(15.0).unwrap_or(1.0))?;
        // A rule that is broken in any case no longer says what it lacks.
        let lack = match if_dispersive.size_of_base(85.0).is_known {
            true if strictest.limit_at_most => DispersiveLack::AnyLimit,
            true => DispersiveLack::LimitOfDesign,
            false => DispersiveLack::D85B,
        };
        let lacks = open_retention(&rules).map(|_| lack);
        Some(Self { d15f_max_mm, at_most: lacks.is_some(), lacks })
    }

    /// The strictest of the curves of a base with one filter.
    pub(super) fn of_bases(bases: &[NamedCurve], filter: &Gradation) -> Option<Self> {
        let of = |(_, base): &NamedCurve| {
            Self::of(&RuleInputs { dispersive: true, ..RuleInputs::of_soils(base, filter) })
        };
        Self::strictest(&bases.iter().filter_map(of).collect::<Vec<_>>())
    }

    /// The strictest of several curves of one base; `None` without one.
    pub fn strictest(all: &[Self]) -> Option<Self> {
        let least = all.iter().min_by(|a, b| a.d15f_max_mm.total_cmp(&b.d15f_max_mm))?;
        let at_most = all.iter().any(|of| of.at_most);
        // Where the strictest is known, the limit is no less than another curve leaves open.
        let of_another = || match all.iter().find_map(|of| of.lacks)? {
            DispersiveLack::AnyLimit => Some(DispersiveLack::LimitOfDesign),
            lack => Some(lack),
        };
        Some(Self { at_most, lacks: least.lacks.or_else(of_another), ..*least })
    }

    /// What stands behind a D15F (mm) that is recommended; `None` where it holds for a dispersive base too.
    pub fn beside(&self, d15f_mm: f64) -> Option<String> {
        const IF: &str = "if the base is dispersive, which is not stated";
        match self.at_most {
            true => Some(format!("{IF}: {}", self.limit_and(TEST_PAIR))),
            false if self.d15f_max_mm < d15f_mm => {
                Some(format!("{} mm {IF}", rounded_down(self.d15f_max_mm)))
            }
            false => None,
        }
    }

    /// The limit of D15F, with what is not known of it. A limit that no source gives is never said to be that
    /// of other bases.
    fn limit(&self) -> String {
        let most = rounded_down(self.d15f_max_mm);
        match self.lacks.filter(|_| self.at_most) {
            Some(DispersiveLack::AnyLimit) => {
                format!("less than {most} mm, by how much no source that was read says")
            }
            Some(DispersiveLack::D85B) => format!("at most {most} mm, as D85B is not known"),
            Some(DispersiveLack::LimitOfDesign) | None => format!("at most {most} mm"),
        }
    }

    /// The same with what to do where it is not known: this test, unless another tells it.
    fn limit_and(&self, test: &'static str) -> String {
        match (self.test(test), self.lacks) {
            (None, _) => self.limit(),
            (Some(test), Some(DispersiveLack::LimitOfDesign) | None) => {
                format!("{}, and {test}", self.limit())
            }
            (Some(test), _) => format!("{}; {test}", self.limit()),
        }
    }

    /// What tells a limit that is not known: this test, where no text has the limit.
    fn test(&self, test: &'static str) -> Option<&'static str> {
        self.at_most.then_some(match self.lacks {
            Some(DispersiveLack::D85B) => "have the base tested with a hydrometer",
            Some(DispersiveLack::LimitOfDesign | DispersiveLack::AnyLimit) | None => test,
        })
    }

    /// The limit in words, of a pair.
    pub fn words(&self) -> String {
        format!("D15F {}", self.limit_and(TEST_PAIR))
    }

    /// The same of a base for which a filter is specified.
    pub fn words_of_base(&self) -> String {
        format!("D15F {}", self.limit_and(TEST_WITH_FILTER))
    }

    /// The limit of a base for which a filter is specified, as a clause of its own; and the test that would
    /// tell one that is not known.
    pub fn limit_of_base(&self) -> (String, Option<&'static str>) {
        (format!("D15F is to be {}", self.limit()), self.test(TEST_WITH_FILTER))
    }

    /// Both as one clause: "D15F is to be at most 0.500 mm".
    pub fn clause_of_base(&self) -> String {
        format!("D15F is to be {}", self.limit_and(TEST_WITH_FILTER))
    }

    /// What practice says then of a filter of this D15F (mm), where that is known, and of these rules.
    pub fn of_filter(&self, rules: &[AppliedRule], d15f_mm: Option<f64>) -> String {
        let allows = format!("practice allows a D15F of at most {} mm", rounded_down(self.d15f_max_mm));
        match (d15f_mm.map(|d15f| self.is_broken_by(d15f)), self.at_most) {
            (Some(true), _) => format!("{allows}, which is not met"),
            (_, true) => format!("D15F is to be {}", self.limit_and(TEST_PAIR)),
            (Some(false), false) => {
                let lost = lost_beyond(rules, self.d15f_max_mm).map_or_else(String::new, |left| {
                    format!(" as placed, but not without the filter's finest {} %", fixed(left.percent, 1))
                });
                format!("{allows}, which is met{lost}")
            }
            (None, false) => allows,
        }
    }

    /// The D15F of a filter beside the limit that it breaks then, as placed or without the finer part that it
    /// may lose, where it keeps `rules` as they are: what does not hold anyway would not hold the more.
    fn newly_broken_by(&self, rules: &[AppliedRule], d15f_mm: Option<f64>) -> Option<[String; 2]> {
        let is_kept = |d15f: f64| retention(rules, d15f).is_none_or(|(_, limit)| d15f <= limit);
        if !d15f_mm.is_none_or(is_kept) {
            return None;
        }
        let shown = |d15f| value_and_limit(d15f, self.d15f_max_mm, false, 3).map(|size| format!("{size} mm"));
        if let Some(d15f) = d15f_mm.filter(|d15f| self.is_broken_by(*d15f)) {
            return Some(shown(d15f));
        }
        let left = lost_beyond(rules, self.d15f_max_mm).filter(|_| washout(rules).is_none())?;
        let [value, limit] = shown(left.d15f);
        Some([format!("{value} (without the filter's finest {} %)", fixed(left.percent, 1)), limit])
    }

    /// The same in words, as a part of the line of practice.
    pub fn beyond_in_words(&self, rules: &[AppliedRule], d15f_mm: Option<f64>) -> Option<String> {
        let [value, limit] = self.newly_broken_by(rules, d15f_mm)?;
        let at_most = if self.at_most { "at most " } else { "" };
        Some(format!("if the base is dispersive, the limit is {at_most}{limit}, and {value} is beyond it"))
    }

    /// Whether a filter of this D15F (mm) is known to be too coarse for it.
    pub fn is_broken_by(&self, d15f_mm: f64) -> bool {
        d15f_mm > self.d15f_max_mm * (1.0 + 1e-9)
    }
}

/// What is said beside a verdict of a base of which nobody has said whether it is dispersive, and of its
/// filter of this D15F (mm); `rules` are those of the pair. `None` where the walk erodes.
pub fn finding(
    verdict: Verdict,
    d15f_mm: Option<f64>,
    rules: &[AppliedRule],
    if_dispersive: IfDispersive,
) -> Option<Finding> {
    if matches!(verdict, Verdict::Some | Verdict::Continuing) {
        return None;
    }
    Some(match if_dispersive.newly_broken_by(rules, d15f_mm) {
        Some([value, limit]) => finding::dispersive_would_not_hold(&limit, &value),
        None => {
            let limit = format!("{} mm", rounded_down(if_dispersive.d15f_max_mm));
            finding::dispersion_not_known(&if_dispersive.of_filter(rules, d15f_mm), &limit)
        }
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::gradation::Gradation;
    use crate::outcome::record::Confidence;
    use crate::verdict::{PairRules, judge};

    /// Id, sentence and label of a verdict on a soil with so many percent of fines and a filter of this D15.
    fn said(verdict: Verdict, fines: f64, d15f: f64) -> (Option<(&'static str, String)>, Confidence) {
        said_of(&[(0.01, 0.0), (0.075, fines), (0.3, 92.0), (0.6, 100.0)], verdict, d15f)
    }

    /// The same of a base of these points.
    fn said_of(
        base: &[(f64, f64)],
        verdict: Verdict,
        d15f: f64,
    ) -> (Option<(&'static str, String)>, Confidence) {
        let soil = |points: &[(f64, f64)]| Gradation::from_lines(points).unwrap();
        let base = soil(base);
        let filter = soil(&[(0.9 * d15f, 0.0), (d15f, 15.0), (2.0 * d15f, 100.0)]);
        let pair = PairRules::of(&base, &filter);
        let inputs = RuleInputs { dispersive: true, ..RuleInputs::of_soils(&base, &filter) };
        let if_dispersive = IfDispersive::of(&inputs);
        let found = if_dispersive.and_then(|of| finding(verdict, Some(d15f), &pair.rules, of));
        let label = judge(verdict, &pair.rules, found.clone().into_iter().collect()).confidence;
        (found.map(|found| (found.id(), found.sentence())), label)
    }

    /// Practice has 0.7 mm for such soils, 0.5 mm where they are dispersive.
    #[test]
    fn no_erosion_is_within_only_where_a_dispersive_base_would_be_held_too() {
        for fines in [36.0, 45.0, 80.0] {
            let (found, label) = said(Verdict::None, fines, 0.6);
            let (id, sentence) = found.unwrap();
            assert_eq!((id, label), ("dispersive_would_not_hold", Confidence::Outside));
            assert!(
                sentence.contains("allows a D15F of at most 0.500 mm, and this is 0.600 mm"),
                "{sentence}"
            );
            let (found, label) = said(Verdict::None, fines, 0.45);
            let (id, sentence) = found.unwrap();
            assert_eq!((id, label), ("dispersion_not_known", Confidence::Within));
            // With less than 40 % the limit of design of such a soil was read nowhere, and may be less.
            let then = match fines < 40.0 {
                true => "If it is, D15F is to be at most 0.500 mm, and have the pair tested. ",
                false => "allows a D15F of at most 0.500 mm, which is met",
            };
            assert!(sentence.contains(then), "{sentence}");
        }
    }

    /// What page 1 says next and what the finding says is one decision.
    #[test]
    fn the_finding_and_the_next_step_say_the_same() {
        for (d15f_max_mm, at_most) in [(0.5, false), (0.5, true)] {
            let of = IfDispersive { d15f_max_mm, at_most, lacks: None };
            for d15f in [Some(0.4), Some(0.5), None] {
                let found = finding(Verdict::None, d15f, &[], of).unwrap();
                let said = found.sentence();
                assert_eq!(found.record(false).numbers["limit"], "0.500 mm");
                assert!(said.contains(&format!("If it is, {}. ", of.of_filter(&[], d15f))), "{said}");
            }
            let found = finding(Verdict::None, Some(0.6), &[], of).unwrap();
            assert_eq!(found.id(), "dispersive_would_not_hold");
            assert!(of.of_filter(&[], Some(0.6)).ends_with("0.500 mm, which is not met"));
        }
        let open = IfDispersive { d15f_max_mm: 0.5, at_most: true, lacks: None };
        assert_eq!(
            open.beside(0.4).unwrap(),
            "if the base is dispersive, which is not stated: at most 0.500 mm, and have the pair tested"
        );
    }

    /// A clay whose table ends at No. 200 lacks its D85 alone: for such fines practice has a limit. The same
    /// whether the filter is finer than the most of it, 6.4 times 0.075 mm, or not.
    #[test]
    fn a_clay_that_no_hydrometer_tested_lacks_its_d85_and_no_source() {
        let clay = [(0.075, 97.0), (0.15, 99.0), (0.3, 100.0)];
        let (id, sentence) = said_of(&clay, Verdict::None, 0.4).0.unwrap();
        assert_eq!(id, "dispersion_not_known");
        let lacks = "If it is, D15F is to be at most 0.480 mm, as D85B is not known; have the base tested \
                     with a hydrometer. ";
        assert!(sentence.contains(lacks), "{sentence}");
        let soil = |points: &[(f64, f64)]| Gradation::from_lines(points).unwrap();
        let (base, filter) = (soil(&clay), soil(&[(0.5, 0.0), (0.8, 15.0), (2.0, 100.0)]));
        let beyond =
            IfDispersive::of(&RuleInputs { dispersive: true, ..RuleInputs::of_soils(&base, &filter) });
        assert_eq!(beyond.unwrap().lacks, Some(DispersiveLack::D85B));
        // With a curve that lacks a limit of design and a finer one that lacks nothing.
        let of =
            |d15f_max_mm, lacks: Option<_>| IfDispersive { d15f_max_mm, at_most: lacks.is_some(), lacks };
        let open = of(0.9, Some(DispersiveLack::LimitOfDesign));
        let both = IfDispersive::strictest(&[of(0.5, None), open]).unwrap();
        assert_eq!(both, of(0.5, open.lacks));
        // The limit that is known is not to be taken as lower.
        let any = of(0.9, Some(DispersiveLack::AnyLimit));
        assert_eq!(IfDispersive::strictest(&[any, of(0.5, None)]).unwrap(), both);
        assert_eq!(IfDispersive::strictest(&[any, of(1.0, open.lacks)]).unwrap(), any);
    }

    /// Of a filter that practice allows, and that a dispersive base would have finer.
    #[test]
    fn a_limit_that_is_broken_if_the_base_is_dispersive_is_named_with_the_size_beyond_it() {
        let base = Gradation::from_points(&[(0.01, 0.0), (0.075, 45.0), (0.3, 92.0), (0.6, 100.0)], None);
        let base = base.unwrap();
        let said = |d15f: f64| {
            let points = [(0.9 * d15f, 0.0), (d15f, 15.0), (2.0 * d15f, 100.0)];
            let filter = Gradation::from_lines(&points).unwrap();
            let inputs = RuleInputs { dispersive: true, ..RuleInputs::of_soils(&base, &filter) };
            let of = IfDispersive::of(&inputs).unwrap();
            of.beyond_in_words(&PairRules::of(&base, &filter).rules, Some(d15f))
        };
        let beyond = "if the base is dispersive, the limit is 0.500 mm, and 0.610 mm is beyond it";
        assert_eq!(said(0.61).unwrap(), beyond);
        // Within it, and too coarse in any case.
        assert_eq!([said(0.45), said(0.8)], [None, None]);
    }

    /// As placed a filter of 0.40 mm is within 0.500 mm, and within 0.700 mm without the part that it may
    /// lose; then it is beyond 0.500 mm.
    #[test]
    fn what_is_left_of_an_unstable_filter_is_judged_by_the_limit_of_a_dispersive_base_too() {
        let base = Gradation::from_points(&[(0.01, 0.0), (0.075, 45.0), (0.3, 92.0), (0.6, 100.0)], None);
        let base = base.unwrap();
        let of_gap = |scale: f64| {
            let gap = [(0.30, 0.0), (0.36, 15.0), (2.4, 15.0), (6.0, 100.0)];
            let filter = gap.map(|(size, percent)| (scale * size, percent));
            let filter = Gradation::from_lines(&filter).unwrap();
            let pair = PairRules::of(&base, &filter);
            (pair.if_dispersive.unwrap(), pair.rules, filter.d(15.0))
        };
        let (of, rules, d15f) = of_gap(0.2);
        let said = of.beyond_in_words(&rules, d15f).unwrap();
        assert!(
            said.starts_with("if the base is dispersive, the limit is 0.500 mm, and 0.5")
                && said.ends_with(" mm (without the filter's finest 17.6 %) is beyond it"),
            "{said}"
        );
        let found = finding(Verdict::None, d15f, &rules, of).unwrap();
        assert_eq!(found.id(), "dispersive_would_not_hold");
        // Beyond 0.700 mm it does not hold in any case.
        let (of, rules, d15f) = of_gap(0.3);
        assert!(washout(&rules).is_some() && of.beyond_in_words(&rules, d15f).is_none());
        assert!(of.of_filter(&rules, d15f).contains("met as placed, but not without"));
        let (of, rules, d15f) = of_gap(0.1);
        assert!(of.beyond_in_words(&rules, d15f).is_none());
        assert!(of.of_filter(&rules, d15f).ends_with("which is met"));
    }

    #[test]
    fn with_fewer_fines_no_limit_is_known_and_sands_and_erosion_need_no_statement() {
        let (found, label) = said(Verdict::None, 25.0, 0.6);
        let (id, sentence) = found.unwrap();
        assert_eq!((id, label), ("dispersion_not_known", Confidence::Within));
        // Of other bases the limit is 0.902 mm: no size that a dispersive one may have.
        let less = "If it is, D15F is to be less than 0.902 mm, by how much no source that was read says; \
                    have the pair tested. ";
        assert!(sentence.contains(less), "{sentence}");
        assert_eq!(said(Verdict::None, 10.0, 0.6).0, None);
        for erodes in [Verdict::Some, Verdict::Continuing] {
            assert_eq!(said(erodes, 45.0, 0.6).0, None);
        }
        assert_eq!(said(Verdict::Undecided, 45.0, 0.6).0.unwrap().0, "dispersive_would_not_hold");
        // What does not hold anyway would not hold the more.
        let (found, label) = said(Verdict::None, 45.0, 0.9);
        assert_eq!((found.unwrap().0, label), ("dispersion_not_known", Confidence::Contradicted));
    }
}
