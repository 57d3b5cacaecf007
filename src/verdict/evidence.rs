//! What the walk's boundary of no erosion is worth: for soils of this kind it was so many times that of
//! tests.
//!
//! `src/data/evidence.csv` is made by `scripts/studies/real_soils_evidence.py` from walks of 639 real soils
//! against filters of four shapes (`results/real-soils.md`). Of each group of soils and shape of filter it
//! has the distribution over soils of `r`, the walk's D15F of no erosion by the centre of the range in which
//! tests found it (the geometric mean of its ends), and half of that range as a factor.
//!
//! With the walk's boundary `B` of this pair a test is taken to have its boundary at `B s / r`, where `s` is
//! uniform over the range in its logarithm. The probability that it would show no erosion is that of
//! `B s / r >= D15F`, a mean over the quantiles of `r`. The source gives the two ends of a range; that
//! boundaries are uniform between them is taken here.
//!
//! No soil of the study was tested itself: tests' boundaries are the ranges published for its kind (Fell et
//! al., Geotechnical Engineering of Dams, Table 9.2, after Foster 1999).

use super::entry::{COHESIVE_FINES, Finding};
use super::evidence_groups::{GROUPS, Group};
use super::finding;
use super::probability::{SOURCE, SURE, beside_range, named_beside_range, probabilities};
use super::quantity::FindingValue;
use super::rule_words::met_of;
use super::tested::is_beyond_unclear;
use crate::outcome::record::{AppliedRule, Bound, Evidence, Margin, Verdict};
use crate::outcome::rules::{BaseSoil, TESTS_CONTINUING, TESTS_NO_EROSION, range_of_tests};

/// From this probability on evidence shares "no erosion", and below the other it shares erosion.
const SHARES: [f64; 2] = [0.9, 0.5];

/// Findings that the soils and filters of the study had themselves: they are in its ratio.
const STUDIED: [&str; 8] = [
    COHESIVE_FINES,
    "broadly_graded",
    "cu_unchecked",
    "cu_at_least",
    "cu_in_doubt",
    "cu_unknown",
    "library_of_any_density",
    "library_of_density",
];

/// The amount of base that was walked in the study: of more, the walk's boundary is another.
pub const MASS_RATIO: f64 = 0.05;

/// The layers of voids that were walked in the study.
pub const LAYERS: u64 = 60;

impl Evidence {
    /// The evidence for a base, and a filter of this D15 (mm) and Cu, whose walk has this margin; `None`
    /// where they are of no group.
    pub fn of(
        soil: &BaseSoil,
        d15f_mm: f64,
        filter_cu: Option<f64>,
        margin: Option<&Margin>,
    ) -> Option<Self> {
        let group = Group::of(soil, filter_cu)?;
        let sizes = soil.fines_percent.zip(soil.gradation.d(85.0));
        let range = sizes.map(|(fines, d85b)| range_of_tests(fines, d85b));
        let bounds = margin.map(|of| (of.boundary(), of.holds_to(), of.erodes_from()));
        let (factor, bound) = match bounds {
            Some((Some(boundary), ..)) => (Some(boundary), None),
            Some((None, Some(holds), None)) => (Some(holds), Some(Bound::AtLeast)),
            Some((None, _, Some(erodes))) => (Some(erodes), Some(Bound::AtMost)),
            Some((None, None, None)) | None => (None, None),
        };
        Some(Self {
            group: group.in_words(),
            soils: group.soils,
            soils_without_boundary: group.without_boundary,
            ratio_median: group.quantile(0.5),
            ratio_low: group.quantile(0.05),
            ratio_high: group.quantile(0.95),
            narrow: group.narrow,
            range_of_tests_mm: range,
            boundary_d15f_mm: factor.map(|factor| factor * d15f_mm),
            // A ratio that scatters widely says nothing of one soil.
            probability_no_erosion: factor.filter(|_| group.narrow).map(|factor| group.probability(factor)),
            probability_by_tests: range
                .map(|[low, high]| group.beyond(d15f_mm / (low * high).sqrt()).clamp(SURE, 1.0 - SURE)),
            bound,
        })
    }

    /// Whether its soils show what the walk's class is worth, and tests share that class. Of continuing
    /// erosion that is so beyond the boundary that tests saw: the ratio is of no erosion alone.
    pub fn supports(&self, verdict: Verdict, rules: &[AppliedRule]) -> bool {
        let ([high, low], Some(of_walk)) = (SHARES, self.probability_no_erosion) else { return false };
        let of_tests = self.probability_by_tests.unwrap_or(of_walk);
        let erodes = of_walk.max(of_tests) <= low && self.bound != Some(Bound::AtLeast);
        self.narrow
            && match verdict {
                Verdict::None => of_walk.min(of_tests) >= high && self.bound != Some(Bound::AtMost),
                Verdict::Some => erodes,
                Verdict::Continuing => {
                    let is_beyond = met_of(rules, TESTS_CONTINUING) == Some(false);
                    erodes && is_beyond && !is_beyond_unclear(rules)
                }
                Verdict::Undecided => false,
            }
    }

    /// The findings of a verdict: what its soils had in common with this pair does not limit a class that the
    /// evidence supports.
    pub fn weigh(&self, verdict: Verdict, rules: &[AppliedRule], found: Vec<Finding>) -> Vec<Finding> {
        let supports = self.supports(verdict, rules);
        let is_studied = |finding: &Finding| supports && STUDIED.contains(&finding.id());
        let settle = |finding: Finding| if is_studied(&finding) { finding.settled() } else { finding };
        found.into_iter().map(settle).chain([self.finding(rules)]).collect()
    }

    /// What it says beside a verdict.
    fn finding(&self, rules: &[AppliedRule]) -> Finding {
        self.finding_with(rules, beside_range)
    }

    /// What it says, with the place of D15F beside the range of tests in these words. Where the filter is
    /// finer than that range and the walk erodes, that speaks against the walk.
    fn finding_with(&self, rules: &[AppliedRule], beside: fn(f64, [f64; 2], &str) -> String) -> Finding {
        let finding = match self.errs_unsafely() {
            true => finding::evidence_unsafe,
            false if self.is_finer_than_tests(rules) => finding::evidence_safe,
            false => finding::evidence,
        };
        let [low, median, high] = [self.ratio_low, self.ratio_median, self.ratio_high];
        let d15f = d15f_of(rules);
        let [from, to] = self.range_of_tests_mm.map_or([None; 2], |range| range.map(Some));
        let beside = match d15f.zip(self.range_of_tests_mm) {
            Some((d15f, range)) => beside(d15f, range, SOURCE),
            None => {
                "It is not known where D15F lies beside the range published for soils of these fines".into()
            }
        };
        let more = self.more_in_words();
        finding(&beside, self.soils, &self.group, median, low, high, &more, d15f, from, to)
    }

    /// Whether the walk errs on the unsafe side for soils and filters of this kind.
    pub fn errs_unsafely(&self) -> bool {
        self.ratio_median > 1.0
    }

    /// What is said of a filter that is to hold such soils, where the walk errs on the unsafe side.
    pub fn against_holding(&self, rules: &[AppliedRule]) -> Option<Finding> {
        self.errs_unsafely().then(|| self.finding_with(rules, named_beside_range))
    }

    /// Whether the filter is finer than any for which tests of soils with such fines had their boundary.
    fn is_finer_than_tests(&self, rules: &[AppliedRule]) -> bool {
        let d15f = d15f_of(rules).filter(|_| met_of(rules, TESTS_NO_EROSION) == Some(true));
        d15f.zip(self.range_of_tests_mm).is_some_and(|(d15f, [low, _])| d15f <= low)
    }

    /// The probability of no erosion in a test, in words: by the published range, and by the walk; beyond the
    /// boundary that tests saw the lower of the two alone.
    pub fn probabilities(&self, is_beyond_tests: bool) -> Option<String> {
        let of_walk = (self.probability_no_erosion, self.bound);
        probabilities(of_walk, self.probability_by_tests, is_beyond_tests)
    }

    /// What else a reader must know of the ratio: clauses and sentences, the last without its end.
    fn more_in_words(&self) -> String {
        let Some(group) = GROUPS.iter().find(|group| group.in_words() == self.group) else {
            return String::new();
        };
        let ratio = |of: f64| FindingValue::Ratio(of).shown(None);
        let mut said = format!("; that range begins at {} of its centre", ratio(1.0 / group.spread));
        if self.soils_without_boundary > 0 {
            said += &format!("; {} more eroded in every filter", self.soils_without_boundary);
        }
        said += &format!(". One filter was walked, {}, with a base of 5 % of its mass", group.walked);
        if let Some(times) = group.times_four {
            let times = ratio(times);
            said += &format!(
                "; with four times as much base, uniform filters began to erode at {times} times the D15F \
                 (median)"
            );
        }
        said
    }
}

/// D15F (mm), as the rules read it.
fn d15f_of(rules: &[AppliedRule]) -> Option<f64> {
    rules.iter().find(|rule| rule.id == TESTS_NO_EROSION)?.value
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::gradation::Gradation;
    use crate::outcome::record::MarginWalk;
    use crate::verdict::PairRules;

    fn soil(points: &[(f64, f64)]) -> BaseSoil {
        BaseSoil::of(&Gradation::from_lines(points).unwrap(), false)
    }

    /// A sand without fines, D85B 0.487 mm.
    const SAND: [(f64, f64); 3] = [(0.075, 0.0), (0.3, 50.0), (0.6, 100.0)];
    /// With 45 % fines, D85B 0.244 mm and D50B 0.087 mm.
    const SILTY: [(f64, f64); 4] = [(0.01, 0.0), (0.075, 45.0), (0.3, 92.0), (0.6, 100.0)];

    fn sand() -> BaseSoil {
        soil(&SAND)
    }

    /// The rules of practice of a base and a uniform filter of this D15.
    fn rules(base: &[(f64, f64)], d15f: f64) -> Vec<AppliedRule> {
        let filter = Gradation::linear_from_dx(15.0, d15f, 1.5).unwrap();
        PairRules::of(&Gradation::from_lines(base).unwrap(), &filter).rules
    }

    fn margin(holds: f64, erodes: f64) -> Margin {
        let walk = |factor, holds| MarginWalk { factor, eroded_mass_fraction: 0.07, holds };
        Margin { walks: vec![walk(holds, true), walk(erodes, false)] }
    }

    #[test]
    fn a_client_reads_what_the_ratio_is_of_where_the_range_lies_and_no_probability() {
        let broad = [(0.001, 10.0), (0.01, 30.0), (0.075, 60.0), (0.6, 85.0), (2.0, 100.0)];
        let of = Evidence::of(&soil(&broad), 0.5, Some(1.5), None).unwrap();
        assert_eq!((of.soils, of.soils_without_boundary, of.narrow), (106, 22, false));
        let said = of.finding(&rules(&broad, 0.5)).sentence();
        for words in [
            "at 0.117 times the centre of",
            "that range begins at 0.642 of its centre; 22 more eroded in every filter. One filter was \
             walked, of Cu 1.5, with a base of 5 % of its mass; with four times as much base, uniform \
             filters began to erode at 12.1 times the D15F (median).",
            "For 106 real soils of this kind (55 to 85 % fines",
            "D15F is 0.71 of the lowest D15F with erosion in tests on soils with such fines (0.700 mm; Fell \
             et al., Geotechnical Engineering of Dams, Table 9.2). ",
            "so that no probability for a risk analysis follows.",
        ] {
            assert!(said.contains(words), "{words}: {said}");
        }
        // Two ends are no distribution: nobody can sign for a number that is read between them.
        assert!(!said.contains("by the published range") && !said.contains("robability that"), "{said}");
        let c33 = Evidence::of(&soil(&SILTY), 0.5, Some(5.3), None).unwrap();
        let said = c33.finding(&rules(&SILTY, 0.5)).sentence();
        assert!(said.starts_with("For filters like this the walk errs on the unsafe side."), "{said}");
        // What programs read: the sizes that the words compare.
        let numbers = c33.finding(&rules(&SILTY, 0.5)).record(true).numbers;
        let sizes = ["d15f_mm", "range_low_mm", "range_high_mm"].map(|of| numbers[of].as_f64().unwrap());
        assert!((sizes[0] - 0.5).abs() < 1e-9 && sizes[1..] == [0.7, 1.7], "{sizes:?}");
        assert!(c33.finding(&[]).record(true).numbers["d15f_mm"].is_null());
        // A design names the size of which it speaks.
        let limit = c33.against_holding(&rules(&SILTY, 0.7 * (1.0 - 1e-9))).unwrap().sentence();
        assert!(limit.contains(". A D15F of 0.700 mm is at the lower end of the range in which"), "{limit}");
        assert!(said.contains("One filter was walked, C33 sand with a Cu of 5.3, with"), "{said}");
        // Its 86 soils lie within a factor of 1.92, and 95 % reach beyond the range.
        let silty = [(0.03, 0.0), (0.075, 25.0), (0.3, 92.0), (0.6, 100.0)];
        let c33 = Evidence::of(&soil(&silty), 0.5, Some(5.3), None).unwrap();
        assert!(
            !c33.narrow && c33.ratio_median <= 1.0 && c33.group.starts_with("15 to 35 % fines"),
            "{c33:?}"
        );
        assert!(!c33.finding(&rules(&silty, 0.5)).sentence().contains("unsafe side"), "{c33:?}");
    }

    /// 0.7 mm is where the range begins, and Foster and Fell's boundary.
    #[test]
    fn only_a_filter_finer_than_the_whole_range_speaks_against_a_walk_that_erodes() {
        let id = |d15f: f64| {
            let of = Evidence::of(&soil(&SILTY), d15f, Some(1.5), Some(&margin(0.5, 0.52))).unwrap();
            assert!(of.probability_by_tests > Some(0.9), "{of:?}");
            let finding = of.finding(&rules(&SILTY, d15f));
            (finding.id(), finding.is_against(Verdict::Some))
        };
        let finer = Evidence::of(&soil(&SILTY), 0.5, Some(1.5), None).unwrap().finding(&rules(&SILTY, 0.5));
        assert!(finer.sentence().starts_with("D15F is 0.71 of the lowest D15F with erosion"), "{finer:?}");
        assert_eq!([id(0.69), id(0.75)], [("evidence_safe", true), ("evidence", false)]);
    }

    /// The ratio is of no erosion; that continuing erosion follows is another criterion.
    #[test]
    fn continuing_erosion_is_supported_beyond_its_own_boundary_alone() {
        // 9 D95B is 5.04 mm.
        let supports = |d15f: f64| {
            let of = Evidence::of(&sand(), d15f, Some(1.5), Some(&margin(0.3, 0.31))).unwrap();
            [Verdict::Some, Verdict::Continuing].map(|verdict| of.supports(verdict, &rules(&SAND, d15f)))
        };
        assert_eq!([supports(4.95), supports(5.2)], [[true, false], [true, true]]);
    }

    #[test]
    fn a_sand_is_of_its_group_and_at_the_walks_boundary_tests_still_hold() {
        let of = Evidence::of(&sand(), 2.0, Some(1.5), Some(&margin(0.98, 1.02))).unwrap();
        assert_eq!(of.group, "less than 15 % fines, D85B/D50B at most 4, filters of Cu 1 to 2");
        let probability = of.probability_no_erosion.unwrap();
        assert!(of.soils >= 30 && of.ratio_median < 0.7 && probability > 0.9, "{of:?}");
        // 2 mm is 4.1 D85B, and tests held to 6.8.
        assert_eq!(of.probability_by_tests, Some(0.98));
        let (all, verdicts) = (rules(&SAND, 2.0), [Verdict::None, Verdict::Some]);
        assert_eq!(verdicts.map(|verdict| of.supports(verdict, &all)), [true, false]);
        assert_eq!(verdicts.map(|verdict| of.finding(&all).is_against(verdict)), [false, true]);
        let coarse = Evidence::of(&sand(), 6.0, Some(1.5), Some(&margin(0.3, 0.31))).unwrap();
        let all = rules(&SAND, 6.0);
        assert!(coarse.supports(Verdict::Continuing, &all) && !coarse.supports(Verdict::None, &all));
        assert!(!coarse.finding(&all).is_against(Verdict::Continuing), "{coarse:?}");
        // The walk alone does not make a filter beyond the tests' range a good one.
        let beyond = Evidence::of(&sand(), 4.5, Some(1.5), Some(&margin(4.0, 4.1))).unwrap();
        let supports = beyond.supports(Verdict::None, &rules(&SAND, 4.5));
        assert!(beyond.probability_no_erosion > Some(0.9) && !supports, "{beyond:?}");
    }

    #[test]
    fn what_is_of_no_group_has_no_evidence() {
        let tail = soil(&[(0.3, 40.0), (1.0, 80.0), (2.0, 100.0)]);
        assert_eq!(Evidence::of(&tail, 2.0, Some(1.5), Some(&margin(0.98, 1.02))), None);
        // A gap at the finest sieve hides the part that practice looks at.
        let hidden = soil(&[(0.075, 30.0), (0.3, 32.0), (19.0, 100.0)]);
        assert!(hidden.hidden_below_mm.is_some());
        assert_eq!(Evidence::of(&hidden, 5.0, Some(1.5), Some(&margin(0.98, 1.02))), None);
        assert_eq!(Evidence::of(&sand(), 2.0, Some(60.0), Some(&margin(0.98, 1.02))), None);
        assert_eq!(Evidence::of(&sand(), 2.0, None, Some(&margin(0.98, 1.02))), None);
        let unknown = Evidence::of(&sand(), 2.0, Some(1.5), None).unwrap();
        let supports = unknown.supports(Verdict::None, &rules(&SAND, 2.0));
        assert!(unknown.narrow && unknown.probability_no_erosion.is_none() && !supports);
        let empty = Evidence::of(&sand(), 2.0, Some(1.5), Some(&Margin { walks: Vec::new() }));
        assert_eq!(empty.unwrap(), unknown);
    }

    #[test]
    fn a_margin_without_an_end_bounds_the_probability() {
        let mut held = margin(1.0, 2.0);
        held.walks.pop();
        let of = Evidence::of(&sand(), 2.0, Some(1.5), Some(&held)).unwrap();
        let all = rules(&SAND, 2.0);
        assert_eq!(of.bound, Some(Bound::AtLeast));
        assert!(of.supports(Verdict::None, &all) && !of.supports(Verdict::Some, &all));
        let said = of.probabilities(false).unwrap();
        assert!(said.contains("at least") || said.contains(" or more"), "{said}");
        let mut eroded = margin(0.5, 1.0);
        eroded.walks.remove(0);
        let of = Evidence::of(&sand(), 2.0, Some(1.5), Some(&eroded)).unwrap();
        assert!(of.bound == Some(Bound::AtMost) && !of.supports(Verdict::None, &all), "{of:?}");
    }

    #[test]
    fn what_the_study_had_does_not_limit_a_class_that_it_supports_and_stays_a_gap() {
        let of = Evidence::of(&sand(), 2.0, Some(1.5), Some(&margin(0.98, 1.02))).unwrap();
        let all = rules(&SAND, 2.0);
        let found = || {
            let fines = finding::cohesive_fines(14.0);
            vec![finding::library_of_any_density(3.0), finding::few_replicates(4), fines]
        };
        let against = |verdict| -> Vec<&str> {
            let weighed = of.weigh(verdict, &all, found());
            weighed.iter().filter(|of| of.is_against(verdict)).map(Finding::id).collect()
        };
        assert_eq!(against(Verdict::None), ["few_replicates"]);
        let of_some = against(Verdict::Some);
        assert_eq!(of_some, ["library_of_any_density", "few_replicates", "cohesive_fines", "evidence_safe"]);
        let said: Vec<String> =
            of.weigh(Verdict::None, &all, found()).iter().map(Finding::sentence).collect();
        assert!(
            said[2].starts_with("The published range of tests is for soils with such fines too, and this")
                && said[2].contains("the model ignores cohesion"),
            "{said:?}"
        );
        assert!(
            said[0].starts_with(
                "The soils of the study had this too, and the class rests on the published range"
            ),
            "{said:?}"
        );
    }
}
