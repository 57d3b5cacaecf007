//! What the walk's boundary of no erosion is worth: for soils of this kind it was so many times that of
//! tests.
//!
//! `src/data/evidence.csv` is made by `scripts/studies/real_soils_evidence.py` from walks of 639 real soils
//! against filters of four shapes (`results/real-soils.md`). Of each group of soils and shape of filter it
//! has the distribution over soils of `r`, the walk's D15F of no erosion by the centre of the range in which
//! tests found it, and half of that range as a factor.
//!
//! With the walk's boundary `B` of this pair a test is taken to have its boundary at `B s / r`, where `s` is
//! uniform over the range in its logarithm. The probability that it would show no erosion is that of
//! `B s / r >= D15F`, a mean over the quantiles of `r`.
//!
//! No soil of the study was tested itself: tests' boundaries are the ranges published for its kind (Fell et
//! al., Geotechnical Engineering of Dams, Table 9.2, after Foster 1999).

use std::sync::LazyLock;

use libm::log;

use super::entry::Finding;
use super::finding;
use crate::outcome::record::{Bound, Evidence, Margin, Verdict};
use crate::outcome::rules::{BaseSoil, range_of_tests};

const TABLE: &str = include_str!("../data/evidence.csv");

/// D85B by D50B after regrading up to which a base is steep: its coarse half then holds the rest back.
const STEEP: f64 = 4.0;

/// From this probability on evidence shares "no erosion", and below the other it shares erosion.
const SHARES: [f64; 2] = [0.9, 0.5];

/// Findings that the soils and filters of the study had themselves: they are in its ratio.
const STUDIED: [&str; 7] = [
    "cohesive_fines",
    "broadly_graded",
    "cu_unchecked",
    "cu_in_doubt",
    "cu_unknown",
    "library_of_any_density",
    "library_of_density",
];

/// The amount of base that was walked in the study: of more, the walk's boundary is another.
pub const MASS_RATIO: f64 = 0.05;

/// The layers of voids that were walked in the study.
pub const LAYERS: u64 = 60;

/// A probability is never nearer to 0 or 1 than this.
const SURE: f64 = 0.02;

/// How near the walk's probability comes to 0 or 1: half a step of its 20 quantiles.
const WALK_SURE: f64 = 0.025;

/// A probability of no erosion in percent: at its caps it may be any less or more.
pub fn probability_in_words(probability: f64, bound: Option<Bound>) -> String {
    let shown = format!("{:.0} %", 100.0 * probability);
    let (is_most, is_least) = (probability >= 1.0 - WALK_SURE, probability <= WALK_SURE);
    match bound {
        Some(Bound::AtMost) if !is_least => format!("at most {shown}"),
        Some(Bound::AtLeast) if !is_most => format!("at least {shown}"),
        _ if is_most => format!("{shown} or more"),
        _ if is_least => format!("{shown} or less"),
        _ => shown,
    }
}

/// A group of soils against filters of one shape.
#[derive(Debug)]
struct Group {
    /// Percent finer than 0.075 mm after regrading.
    fines: [f64; 2],
    /// Whether its bases are steep.
    steep: bool,
    /// Cu of the filters.
    filter_cu: [f64; 2],
    soils: u64,
    /// Whether enough soils have a ratio within a factor of 2 of the median, which is at most 1.
    narrow: bool,
    /// Half of the tests' range, as a factor.
    spread: f64,
    /// The ratio at equal steps of probability, from one step to one less than all.
    ratios: Vec<f64>,
}

static GROUPS: LazyLock<Vec<Group>> = LazyLock::new(|| {
    let rows = TABLE.lines().filter(|line| !line.starts_with('#')).skip(1);
    rows.map(Group::read).collect()
});

impl Group {
    /// Reads a row: name, least and most fines, shape of the base, name and Cu of the filter, soils, those
    /// without a boundary, whether it is narrow, half of the tests' range, and the ratio's quantiles.
    fn read(row: &'static str) -> Self {
        let cells: Vec<&str> = row.split(',').collect();
        let number = |cell: usize| -> f64 { cells[cell].parse().expect("a number") };
        Self {
            fines: [number(1), number(2)],
            steep: cells[3] == "steep",
            filter_cu: [number(5), number(6)],
            soils: number(7) as u64,
            narrow: cells[9] == "yes",
            spread: number(10),
            ratios: (11..cells.len()).map(number).collect(),
        }
    }

    /// The group of a base and a filter; `None` where the base's fines or the filter's Cu are not known.
    fn of(soil: &BaseSoil, filter_cu: Option<f64>) -> Option<&'static Self> {
        if soil.hidden_below_mm.is_some() {
            return None;
        }
        let (fines, d85, cu) = (soil.fines_percent?, soil.gradation.d(85.0)?, filter_cu?);
        let steep = soil.gradation.d(50.0).is_some_and(|d50| d85 <= STEEP * d50);
        let within = |[least, most]: [f64; 2], value: f64| least <= value && value < most;
        GROUPS.iter().find(|group| {
            // The finest of them have more than 85 %, others so much or more.
            let has_fines = match group.fines {
                [85.0, _] => fines > 85.0,
                [least, 85.0] => least <= fines && fines <= 85.0,
                of => within(of, fines),
            };
            has_fines && group.steep == steep && within(group.filter_cu, cu)
        })
    }

    /// The ratio below which this part of the soils lies, for whole steps of probability.
    fn quantile(&self, p: f64) -> f64 {
        let steps = (self.ratios.len() + 1) as f64;
        self.ratios[(p * steps).round() as usize - 1]
    }

    /// The probability that a test would show no erosion, with the walk's boundary so many times the filter's
    /// D15F.
    fn probability(&self, boundary_by_d15f: f64) -> f64 {
        let each = self.ratios.iter().map(|ratio| self.beyond(ratio / boundary_by_d15f));
        (each.sum::<f64>() + 0.5) / (self.ratios.len() + 1) as f64
    }

    /// Part of the tests' range beyond a D15F, by the range's centre.
    fn beyond(&self, d15f_by_centre: f64) -> f64 {
        let half = log(self.spread);
        ((half - log(d15f_by_centre)) / (2.0 * half)).clamp(0.0, 1.0)
    }
}

/// The centre of the range in which tests of such a base had their boundary of no erosion, as D15F (mm).
fn centre_of_tests(soil: &BaseSoil) -> Option<f64> {
    let [low, high] = range_of_tests(soil.fines_percent?, soil.gradation.d(85.0)?);
    Some((low * high).sqrt())
}

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
            ratio_median: group.quantile(0.5),
            ratio_low: group.quantile(0.05),
            ratio_high: group.quantile(0.95),
            narrow: group.narrow,
            boundary_d15f_mm: factor.map(|factor| factor * d15f_mm),
            // A ratio that scatters widely says nothing of one soil.
            probability_no_erosion: factor.filter(|_| group.narrow).map(|factor| group.probability(factor)),
            probability_by_tests: centre_of_tests(soil)
                .map(|of| group.beyond(d15f_mm / of).clamp(SURE, 1.0 - SURE)),
            bound,
        })
    }

    /// Whether its soils show what the walk's class is worth, and tests share that class.
    pub fn supports(&self, verdict: Verdict) -> bool {
        let ([high, low], Some(of_walk)) = (SHARES, self.probability_no_erosion) else { return false };
        let of_tests = self.probability_by_tests.unwrap_or(of_walk);
        self.narrow
            && match verdict {
                Verdict::None => of_walk.min(of_tests) >= high && self.bound != Some(Bound::AtMost),
                Verdict::Some | Verdict::Continuing => {
                    of_walk.max(of_tests) <= low && self.bound != Some(Bound::AtLeast)
                }
                Verdict::Undecided => false,
            }
    }

    /// The findings of a verdict: what its soils had in common with this pair is no doubt where the evidence
    /// supports the class.
    pub fn weigh(&self, verdict: Verdict, found: Vec<Finding>) -> Vec<Finding> {
        let supports = self.supports(verdict);
        let is_studied = |finding: &Finding| supports && STUDIED.contains(&finding.id());
        let settle = |finding: Finding| if is_studied(&finding) { finding.settled() } else { finding };
        found.into_iter().map(settle).chain([self.finding()]).collect()
    }

    /// What it says. Where tests hold and the walk erodes, that speaks against the walk.
    fn finding(&self) -> Finding {
        let of_walk = match self.probability_no_erosion {
            Some(of) => format!("is {}", probability_in_words(of, self.bound)),
            None if self.ratio_median > 1.0 => "is not known by the walk".into(),
            None => "is not known by the walk, whose ratio to tests scatters or rests on few soils".into(),
        };
        let of_tests = self.probability_by_tests.map(|of| probability_in_words(of, None));
        let of_tests = of_tests
            .map_or(String::new(), |of| format!("; by the published range of such tests alone it is {of}"));
        let [low, median, high] = [self.ratio_low, self.ratio_median, self.ratio_high];
        let probability = format!("{of_walk}{of_tests}");
        let tests_hold = self.probability_by_tests.is_some_and(|of| of >= SHARES[0]);
        let finding = match (median > 1.0, tests_hold) {
            (true, _) => finding::evidence_unsafe,
            (false, true) => finding::evidence_safe,
            (false, false) => finding::evidence,
        };
        finding(&probability, self.soils, &self.group, median, low, high)
    }
}

impl Group {
    /// Its soils and filters, in words.
    fn in_words(&self) -> String {
        let [least, most] = self.fines;
        let fines = match (least, most) {
            (0.0, most) => format!("less than {most} % fines"),
            (least, 100.0) => format!("more than {least} % fines"),
            (least, most) => format!("{least} to {most} % fines"),
        };
        let half = if self.steep { "at most" } else { "more than" };
        let [narrow, broad] = self.filter_cu;
        format!("{fines}, D85B/D50B {half} {STEEP}, filters of Cu {narrow} to {broad}")
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::gradation::Gradation;
    use crate::outcome::record::MarginWalk;

    fn soil(points: &[(f64, f64)]) -> BaseSoil {
        BaseSoil::of(&Gradation::from_points(points, None).unwrap(), false)
    }

    /// A sand without fines, D85B 0.487 mm.
    fn sand() -> BaseSoil {
        soil(&[(0.075, 0.0), (0.3, 50.0), (0.6, 100.0)])
    }

    fn margin(holds: f64, erodes: f64) -> Margin {
        let walk = |factor, holds| MarginWalk { factor, eroded_mass_fraction: 0.07, holds };
        Margin { walks: vec![walk(holds, true), walk(erodes, false)] }
    }

    #[test]
    fn every_group_rises_and_its_probability_with_the_boundary() {
        assert!(GROUPS.len() >= 8, "{}", GROUPS.len());
        for group in GROUPS.iter() {
            assert!(group.ratios.len() == 19 && group.ratios.is_sorted(), "{}", group.in_words());
            assert_eq!(group.quantile(0.5), group.ratios[9]);
            let all: Vec<f64> =
                (-40..=40).map(|k| group.probability(libm::exp(f64::from(k) / 8.0))).collect();
            assert!(all.is_sorted() && all[0] == 0.025 && all[80] == 0.975, "{}: {all:?}", group.in_words());
            // All soils at the median, all tests at their centre.
            let one = Group { ratios: vec![0.5; 19], spread: group.spread, ..Group::read(ROW) };
            assert!((one.probability(0.5) - 0.5).abs() < 1e-12);
        }
    }

    const ROW: &str = "4,0,15,steep,cu1.5,1,2,55,0,yes,1.2,0.5,0.5";

    #[test]
    fn a_sand_is_of_its_group_and_at_the_walks_boundary_tests_still_hold() {
        let of = Evidence::of(&sand(), 2.0, Some(1.5), Some(&margin(0.98, 1.02))).unwrap();
        assert_eq!(of.group, "less than 15 % fines, D85B/D50B at most 4, filters of Cu 1 to 2");
        let probability = of.probability_no_erosion.unwrap();
        assert!(of.soils >= 30 && of.ratio_median < 0.7 && probability > 0.9, "{of:?}");
        // 2 mm is 4.1 D85B, and tests held to 6.8.
        assert_eq!(of.probability_by_tests, Some(0.98));
        assert!(of.supports(Verdict::None) && !of.supports(Verdict::Some));
        assert!(of.finding().is_against(Verdict::Some) && !of.finding().is_against(Verdict::None));
        let coarse = Evidence::of(&sand(), 6.0, Some(1.5), Some(&margin(0.3, 0.31))).unwrap();
        assert!(coarse.supports(Verdict::Continuing) && !coarse.supports(Verdict::None), "{coarse:?}");
        assert!(!coarse.finding().is_against(Verdict::Continuing));
        // The walk alone does not make a filter beyond the tests' range a good one.
        let beyond = Evidence::of(&sand(), 4.5, Some(1.5), Some(&margin(4.0, 4.1))).unwrap();
        assert!(beyond.probability_no_erosion > Some(0.9) && !beyond.supports(Verdict::None), "{beyond:?}");
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
        assert!(
            unknown.narrow && unknown.probability_no_erosion.is_none() && !unknown.supports(Verdict::None)
        );
        let empty = Evidence::of(&sand(), 2.0, Some(1.5), Some(&Margin { walks: Vec::new() }));
        assert_eq!(empty.unwrap(), unknown);
    }

    #[test]
    fn a_margin_without_an_end_bounds_the_probability() {
        let mut held = margin(1.0, 2.0);
        held.walks.pop();
        let of = Evidence::of(&sand(), 2.0, Some(1.5), Some(&held)).unwrap();
        assert!(
            of.bound == Some(Bound::AtLeast) && of.supports(Verdict::None) && !of.supports(Verdict::Some)
        );
        let said = of.finding().sentence();
        assert!(said.contains("at least") || said.contains(" or more"), "{said}");
        let mut eroded = margin(0.5, 1.0);
        eroded.walks.remove(0);
        let of = Evidence::of(&sand(), 2.0, Some(1.5), Some(&eroded)).unwrap();
        assert!(of.bound == Some(Bound::AtMost) && !of.supports(Verdict::None), "{of:?}");
    }

    #[test]
    fn a_probability_at_its_cap_is_no_value() {
        let said = probability_in_words;
        assert_eq!(
            [0.98, 0.975, 0.02, 0.025].map(|of| said(of, None)),
            ["98 % or more", "98 % or more", "2 % or less", "2 % or less"]
        );
        assert_eq!(said(0.27, None), "27 %");
        assert_eq!(said(0.93, Some(Bound::AtLeast)), "at least 93 %");
        assert_eq!(said(0.975, Some(Bound::AtLeast)), "98 % or more");
        assert_eq!(said(0.975, Some(Bound::AtMost)), "at most 98 %");
        assert_eq!(said(0.02, Some(Bound::AtMost)), "2 % or less");
    }

    #[test]
    fn what_the_study_had_is_no_doubt_where_it_supports_the_class() {
        let of = Evidence::of(&sand(), 2.0, Some(1.5), Some(&margin(0.98, 1.02))).unwrap();
        let found = || vec![finding::library_of_any_density(3.0), finding::few_replicates(4)];
        let against = |verdict| -> Vec<&str> {
            let weighed = of.weigh(verdict, found());
            weighed.iter().filter(|of| of.is_against(verdict)).map(Finding::id).collect()
        };
        assert_eq!(against(Verdict::None), ["few_replicates"]);
        let of_some = against(Verdict::Some);
        assert_eq!(of_some, ["library_of_any_density", "few_replicates", "evidence_safe"]);
    }
}
