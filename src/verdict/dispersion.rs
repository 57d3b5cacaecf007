//! What is said of a base of which nobody has said whether it is dispersive.
//!
//! A sieve table does not tell it, tests of dispersive soils had other boundaries, and practice has other
//! limits for them.

use super::entry::Finding;
use super::finding;
use super::quantity::fixed;
use super::washout::{lost_beyond, washout};
use crate::gradation::{FEW_FINES, Gradation};
use crate::outcome::apart::value_and_limit;
use crate::outcome::design::band::{open_retention, retention};
use crate::outcome::numbers::rounded_down;
use crate::outcome::record::{AppliedRule, DispersiveLack, IfDispersive};
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

/// The note on a base of which nobody has said whether it is dispersive, and on its filter of this D15F (mm);
/// `rules` are those of the pair.
pub fn finding(d15f_mm: Option<f64>, rules: &[AppliedRule], if_dispersive: IfDispersive) -> Finding {
    match if_dispersive.newly_broken_by(rules, d15f_mm) {
        Some([value, limit]) => finding::dispersive_would_not_hold(&limit, &value),
        None => finding::dispersion_not_known(&if_dispersive.limit()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::verdict::PairRules;

    fn soil(points: &[(f64, f64)]) -> Gradation {
        Gradation::from_lines(points).unwrap()
    }

    fn with_fines(fines: f64) -> [(f64, f64); 4] {
        [(0.01, 0.0), (0.075, fines), (0.3, 92.0), (0.6, 100.0)]
    }

    /// Id of the note on a base and a filter of this D15, and the limit if the base is dispersive.
    fn note(base: &[(f64, f64)], d15f: f64) -> Option<(&'static str, IfDispersive)> {
        let filter = soil(&[(0.9 * d15f, 0.0), (d15f, 15.0), (2.0 * d15f, 100.0)]);
        let pair = PairRules::of(&soil(base), &filter);
        let limit = pair.if_dispersive?;
        Some((finding(Some(d15f), &pair.rules, limit).id(), limit))
    }

    /// Practice has 0.7 mm for such soils, 0.5 mm where they are dispersive.
    #[test]
    fn a_filter_that_a_dispersive_base_would_have_finer_is_told_from_one_that_holds_it() {
        for fines in [36.0, 45.0, 80.0] {
            let base = with_fines(fines);
            for (d15f, id) in [(0.6, "dispersive_would_not_hold"), (0.45, "dispersion_not_known")] {
                let (found, limit) = note(&base, d15f).unwrap();
                assert_eq!((found, limit.is_broken_by(d15f)), (id, d15f > 0.5));
                assert!((limit.d15f_max_mm - 0.5).abs() < 1e-9, "{limit:?}");
                // With less than 40 % the limit of design of such a soil was read nowhere, and may be less.
                assert_eq!(limit.at_most, fines < 40.0);
            }
            // A filter that does not hold anyway would not hold the more.
            assert_eq!(note(&base, 0.9).unwrap().0, "dispersion_not_known");
        }
    }

    /// A clay whose table ends at No. 200 lacks its D85 alone: for such fines practice has a limit. The same
    /// whether the filter is finer than the most of it, 6.4 times 0.075 mm, or not.
    #[test]
    fn a_clay_that_no_hydrometer_tested_lacks_its_d85_and_no_source() {
        let clay = [(0.075, 97.0), (0.15, 99.0), (0.3, 100.0)];
        for d15f in [0.4, 0.8] {
            let (_, limit) = note(&clay, d15f).unwrap();
            assert_eq!(limit.lacks, Some(DispersiveLack::D85B));
        }
        assert_eq!(note(&clay, 0.4).unwrap().0, "dispersion_not_known");
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

    /// As placed a filter of 0.40 mm is within 0.500 mm, and within 0.700 mm without the part that it may
    /// lose; then it is beyond 0.500 mm.
    #[test]
    fn what_is_left_of_an_unstable_filter_is_judged_by_the_limit_of_a_dispersive_base_too() {
        let base = soil(&with_fines(45.0));
        let of_gap = |scale: f64| {
            let gap = [(0.30, 0.0), (0.36, 15.0), (2.4, 15.0), (6.0, 100.0)];
            let filter = soil(&gap.map(|(size, percent)| (scale * size, percent)));
            let pair = PairRules::of(&base, &filter);
            (pair.if_dispersive.unwrap(), pair.rules, filter.d(15.0))
        };
        let (limit, rules, d15f) = of_gap(0.2);
        assert!(!limit.is_broken_by(d15f.unwrap()) && limit.beyond_in_words(&rules, d15f).is_some());
        assert_eq!(finding(d15f, &rules, limit).id(), "dispersive_would_not_hold");
        // Beyond 0.700 mm it does not hold in any case.
        let (limit, rules, d15f) = of_gap(0.3);
        assert!(washout(&rules).is_some() && limit.beyond_in_words(&rules, d15f).is_none());
        let (limit, rules, d15f) = of_gap(0.1);
        assert!(limit.beyond_in_words(&rules, d15f).is_none());
    }

    #[test]
    fn with_fewer_fines_no_limit_is_known_and_sands_need_no_statement() {
        let (id, limit) = note(&with_fines(25.0), 0.6).unwrap();
        assert_eq!((id, limit.lacks), ("dispersion_not_known", Some(DispersiveLack::AnyLimit)));
        // Of other bases the limit is 0.902 mm: no size that a dispersive one may have.
        assert!((limit.d15f_max_mm - 0.902).abs() < 1e-3, "{limit:?}");
        assert!(note(&with_fines(10.0), 0.6).is_none());
    }
}
