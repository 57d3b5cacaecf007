//! What the walk's boundary of no erosion is worth: for soils of this kind it was so many times that of tests.
//!
//! `src/data/evidence.csv` is made by `scripts/studies/real_soils_evidence.py` from walks of 639 real soils
//! (`results/real-soils.md`). Of each group of soils it has the distribution over soils of `r`, the walk's
//! D15F of no erosion by the middle of the range in which tests found it, and the half width of that range as
//! a factor. With the walk's boundary `B` of this pair a test is then taken to have its boundary at `B s/r`,
//! where `s` is uniform over the range in its logarithm, and the probability that it would show no erosion is
//! that of `B s/r >= D15F`.
//!
//! No soil of the study was tested itself: tests' boundaries are the ranges published for its kind (Fell et
//! al., Geotechnical Engineering of Dams, Table 9.2, after Foster 1999).

use std::sync::LazyLock;

use libm::{exp, log};

use super::entry::Finding;
use super::finding;
use crate::outcome::record::{Bound, Evidence, Margin, Verdict};
use crate::outcome::rules::BaseSoil;

const TABLE: &str = include_str!("../data/evidence.csv");

/// D85B by D50B after regrading up to which a base is steep: its coarse half then holds the rest back.
const STEEP: f64 = 4.0;

/// Places of the tests' range that are looked at.
const PLACES: u32 = 200;

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

/// A group of soils.
#[derive(Debug)]
struct Group {
    name: &'static str,
    /// Percent finer than 0.075 mm after regrading.
    fines: [f64; 2],
    /// Whether its bases are steep.
    steep: bool,
    soils: u64,
    /// Whether enough soils have a ratio within a factor of 2 of the median.
    checked: bool,
    /// Half of the tests' range, as a factor.
    spread: f64,
    /// Logarithms of the ratio at equal steps of probability, from one step to one less than all.
    ratios: Vec<f64>,
}

static GROUPS: LazyLock<Vec<Group>> = LazyLock::new(|| {
    let rows = TABLE.lines().filter(|line| !line.starts_with('#')).skip(1);
    rows.map(Group::read).collect()
});

impl Group {
    /// Reads a row: name, least and most fines, soils, those without a boundary, whether it is checked, half
    /// of the tests' range, and the ratio's quantiles.
    fn read(row: &'static str) -> Self {
        let cells: Vec<&str> = row.split(',').collect();
        let number = |cell: usize| -> f64 { cells[cell].parse().expect("a number") };
        Self {
            name: cells[0],
            fines: [number(1), number(2)],
            steep: cells[0].ends_with("steep"),
            soils: number(3) as u64,
            checked: cells[5] == "yes",
            spread: number(6),
            ratios: (7..cells.len()).map(|cell| log(number(cell))).collect(),
        }
    }

    /// The group of a base; `None` where its fines or its coarse half are not known.
    fn of(soil: &BaseSoil) -> Option<&'static Self> {
        let fines = soil.fines_percent?;
        let d85 = soil.gradation.d(85.0)?;
        let steep = soil.gradation.d(50.0).is_some_and(|d50| d85 <= STEEP * d50);
        GROUPS.iter().find(|group| {
            let [least, most] = group.fines;
            group.steep == steep && (least..most).contains(&fines.min(99.9))
        })
    }

    fn quantile(&self, p: f64) -> f64 {
        let at = p * (self.ratios.len() + 1) as f64 - 1.0;
        let below = (at.floor().max(0.0) as usize).min(self.ratios.len() - 2);
        exp(self.ratios[below] + (at - below as f64) * (self.ratios[below + 1] - self.ratios[below]))
    }

    /// Part of the soils whose ratio is at most this; beyond the quantiles straight on.
    fn share_up_to(&self, ratio: f64) -> f64 {
        let (of, step) = (&self.ratios, 1.0 / (self.ratios.len() + 1) as f64);
        let x = log(ratio);
        let at = of.partition_point(|value| *value < x).clamp(1, of.len() - 1);
        let width = (of[at] - of[at - 1]).max(1e-9);
        (step * (at as f64 + (x - of[at - 1]) / width)).clamp(0.0, 1.0)
    }

    /// The probability that a test would show no erosion, with the filter's D15F so many times smaller than
    /// the walk's boundary.
    fn probability(&self, boundary_by_d15f: f64) -> f64 {
        let place = |k: u32| (f64::from(k) + 0.5) / f64::from(PLACES) * 2.0 - 1.0;
        let each = (0..PLACES).map(|k| boundary_by_d15f * exp(place(k) * log(self.spread)));
        each.map(|of| self.share_up_to(of)).sum::<f64>() / f64::from(PLACES)
    }
}

impl Evidence {
    /// The evidence for a pair whose walk has this margin; `None` where the base is of no group.
    pub fn of(soil: &BaseSoil, d15f_mm: f64, margin: &Margin) -> Option<Self> {
        let group = Group::of(soil)?;
        let (factor, bound) = match (margin.boundary(), margin.holds_to(), margin.erodes_from()) {
            (Some(boundary), ..) => (boundary, None),
            (None, Some(holds), None) => (holds, Some(Bound::AtLeast)),
            (None, _, Some(erodes)) => (erodes, Some(Bound::AtMost)),
            (None, None, None) => return None,
        };
        Some(Self {
            group: group.name.into(),
            soils: group.soils,
            ratio_median: group.quantile(0.5),
            ratio_low: group.quantile(0.05),
            ratio_high: group.quantile(0.95),
            checked: group.checked,
            boundary_d15f_mm: factor * d15f_mm,
            probability_no_erosion: group.probability(factor),
            bound,
        })
    }

    /// Whether its soils show what the walk's class is worth, and it shares that class.
    pub fn supports(&self, verdict: Verdict) -> bool {
        let [high, low] = SHARES;
        self.checked
            && match verdict {
                Verdict::None => self.probability_no_erosion >= high && self.bound != Some(Bound::AtMost),
                Verdict::Some | Verdict::Continuing => {
                    self.probability_no_erosion <= low && self.bound != Some(Bound::AtLeast)
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

    /// What it says.
    fn finding(&self) -> Finding {
        let said = match self.bound {
            Some(Bound::AtLeast) => "at least ",
            Some(Bound::AtMost) => "at most ",
            None => "",
        };
        let probability = format!("{said}{:.0} %", 100.0 * self.probability_no_erosion);
        let group = self.group_in_words();
        finding::evidence(
            &probability,
            self.soils,
            &group,
            self.ratio_median,
            self.ratio_low,
            self.ratio_high,
        )
    }

    /// Its soils, in words.
    pub fn group_in_words(&self) -> String {
        let Some(group) = GROUPS.iter().find(|group| group.name == self.group) else {
            return self.group.clone();
        };
        let [least, most] = group.fines;
        let fines = match (least, most) {
            (0.0, most) => format!("less than {most} % fines"),
            (least, 100.0) => format!("{least} % fines or more"),
            (least, most) => format!("{least} to {most} % fines"),
        };
        let half = if group.steep { "at most" } else { "more than" };
        format!("{fines}, D85/D50 {half} {STEEP}")
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

    fn margin(holds: f64, erodes: f64) -> Margin {
        let walk = |factor, holds| MarginWalk { factor, eroded_mass_fraction: 0.07, holds };
        Margin { walks: vec![walk(holds, true), walk(erodes, false)] }
    }

    #[test]
    fn every_group_rises_and_its_probability_falls_with_the_filter() {
        assert!(GROUPS.len() >= 8, "{}", GROUPS.len());
        for group in GROUPS.iter() {
            assert!(group.ratios.windows(2).all(|two| two[0] <= two[1]), "{}", group.name);
            assert!((group.quantile(0.5) - exp(group.ratios[group.ratios.len() / 2])).abs() < 1e-12);
            let all: Vec<f64> = (-40..=40).map(|k| group.probability(exp(f64::from(k) / 8.0))).collect();
            assert!(all.windows(2).all(|two| two[0] <= two[1] + 1e-12), "{}", group.name);
            assert!(all[0] < 0.01 && all[80] > 0.99, "{}: {all:?}", group.name);
        }
    }

    #[test]
    fn a_sand_with_few_fines_is_of_its_group_and_a_filter_at_its_boundary_is_likely_to_hold() {
        let sand = soil(&[(0.075, 0.0), (0.3, 50.0), (0.6, 100.0)]);
        let of = Evidence::of(&sand, 2.0, &margin(0.98, 1.02)).unwrap();
        assert!((of.group.as_str(), of.bound) == ("4 steep", None) && of.soils >= 30);
        // The walk is stricter than tests: where it begins to erode, nearly all tests still hold.
        assert!(of.ratio_median < 0.7 && of.probability_no_erosion > 0.9, "{of:?}");
        assert!(of.supports(Verdict::None) && !of.supports(Verdict::Some));
        let coarse = Evidence::of(&sand, 2.0, &margin(0.3, 0.31)).unwrap();
        assert!(coarse.supports(Verdict::Continuing) && !coarse.supports(Verdict::None), "{coarse:?}");
        // Fines that are not known are of no group.
        let tail = soil(&[(0.3, 40.0), (1.0, 80.0), (2.0, 100.0)]);
        assert_eq!(Evidence::of(&tail, 2.0, &margin(0.98, 1.02)), None);
    }

    #[test]
    fn a_margin_without_an_end_bounds_the_probability() {
        let sand = soil(&[(0.075, 0.0), (0.3, 50.0), (0.6, 100.0)]);
        let mut held = margin(1.0, 2.0);
        held.walks.pop();
        let of = Evidence::of(&sand, 2.0, &held).unwrap();
        assert!(of.bound == Some(Bound::AtLeast) && !of.supports(Verdict::Some));
        assert_eq!(Evidence::of(&sand, 2.0, &Margin { walks: Vec::new() }), None);
    }
}
