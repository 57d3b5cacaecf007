//! Soils of the study of real soils in groups: where the walk began to erode for them, by tests.
//!
//! `src/data/evidence.csv` has a row for each group of soils and shape of filter.

use std::sync::LazyLock;

use libm::log;

use crate::outcome::rules::BaseSoil;

const TABLE: &str = include_str!("../data/evidence.csv");

/// D85B by D50B after regrading up to which a base is steep: its coarse half then holds the rest back.
const STEEP: f64 = 4.0;

/// A group of soils against filters of one shape.
#[derive(Debug)]
pub(super) struct Group {
    /// Percent finer than 0.075 mm after regrading.
    fines: [f64; 2],
    /// Whether its bases are steep.
    steep: bool,
    /// Cu of the filters.
    filter_cu: [f64; 2],
    /// The one filter that was walked, in words.
    pub(super) walked: String,
    /// Soils with a ratio.
    pub(super) soils: u64,
    /// Soils of which the walk erodes in every filter.
    pub(super) without_boundary: u64,
    /// Whether enough soils have a ratio within a factor of 2 of the median, which is at most 1, and few lie
    /// beyond the tests' range.
    pub(super) narrow: bool,
    /// Half of the tests' range, as a factor.
    pub(super) spread: f64,
    /// Times the D15F at which a uniform filter begins to erode with four times the base; `None` where too
    /// few soils were walked so.
    pub(super) times_four: Option<f64>,
    /// The ratio at equal steps of probability, from one step to one less than all.
    ratios: Vec<f64>,
}

pub(super) static GROUPS: LazyLock<Vec<Group>> = LazyLock::new(|| {
    let rows = TABLE.lines().filter(|line| !line.starts_with('#')).skip(1);
    rows.map(Group::read).collect()
});

impl Group {
    /// Reads a row: name, least and most fines, shape of the base, name and Cu of the filter, soils, those
    /// without a boundary, whether it is narrow, half of the tests' range, what four times the base does, and
    /// the ratio's quantiles.
    fn read(row: &'static str) -> Self {
        let cells: Vec<&str> = row.split(',').collect();
        let number = |cell: usize| -> f64 { cells[cell].parse().expect("a number") };
        Self {
            fines: [number(1), number(2)],
            steep: cells[3] == "steep",
            filter_cu: [number(5), number(6)],
            walked: match cells[4] {
                "c33" => "C33 sand with a Cu of 5.3".into(),
                name => format!("of Cu {}", name.trim_start_matches("cu")),
            },
            soils: (number(7) - number(8)) as u64,
            without_boundary: number(8) as u64,
            narrow: cells[9] == "yes",
            spread: number(10),
            times_four: cells[11].parse().ok(),
            ratios: (12..cells.len()).map(number).collect(),
        }
    }

    /// The group of a base and a filter; `None` where the base's fines or the filter's Cu are not known.
    pub(super) fn of(soil: &BaseSoil, filter_cu: Option<f64>) -> Option<&'static Self> {
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
    pub(super) fn quantile(&self, p: f64) -> f64 {
        let steps = (self.ratios.len() + 1) as f64;
        self.ratios[(p * steps).round() as usize - 1]
    }

    /// The probability that a test would show no erosion, with the walk's boundary so many times the filter's
    /// D15F.
    pub(super) fn probability(&self, boundary_by_d15f: f64) -> f64 {
        let each = self.ratios.iter().map(|ratio| self.beyond(ratio / boundary_by_d15f));
        (each.sum::<f64>() + 0.5) / (self.ratios.len() + 1) as f64
    }

    /// Part of the tests' range beyond a D15F, by the range's centre.
    pub(super) fn beyond(&self, d15f_by_centre: f64) -> f64 {
        let half = log(self.spread);
        ((half - log(d15f_by_centre)) / (2.0 * half)).clamp(0.0, 1.0)
    }
}

impl Group {
    /// Its soils and filters, in words.
    pub(super) fn in_words(&self) -> String {
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

    #[test]
    fn every_group_rises_and_its_probability_with_the_boundary() {
        assert!(GROUPS.len() >= 8, "{}", GROUPS.len());
        for group in GROUPS.iter() {
            assert!(group.ratios.len() == 19 && group.ratios.is_sorted(), "{}", group.in_words());
            assert_eq!(group.quantile(0.5), group.ratios[9]);
            let all: Vec<f64> =
                (-40..=40).map(|k| group.probability(libm::exp(f64::from(k) / 8.0))).collect();
            assert!(all.is_sorted() && all[0] == 0.025 && all[80] == 0.975, "{}: {all:?}", group.in_words());
            // No group is known that lies beyond the tests' range, or in the middle of it beyond the centre.
            let [median, high] = [0.5, 0.95].map(|p| group.quantile(p));
            assert!(!group.narrow || (median <= 1.0 && high <= group.spread), "{}", group.in_words());
            // All soils at the median, all tests at their centre.
            let one = Group { ratios: vec![0.5; 19], spread: group.spread, ..Group::read(ROW) };
            assert!((one.probability(0.5) - 0.5).abs() < 1e-12);
        }
    }

    const ROW: &str = "4,0,15,steep,cu1.5,1,2,55,0,yes,1.2,1.5,0.5,0.5";

    /// C33 sand with 15 to 35 % fines reaches beyond the range; with a tenth of the soils left out Cu 3 with
    /// 35 to 55 % fines does not stay narrow, and with less than 15 % it has fewer than 30 soils.
    #[test]
    fn a_group_is_narrow_whatever_tenth_of_its_soils_is_left_out() {
        let narrow: Vec<String> = GROUPS.iter().filter(|of| of.narrow).map(Group::in_words).collect();
        let of = |fines: &str, cu: &str| format!("{fines} fines, D85B/D50B at most 4, filters of Cu {cu}");
        let few = "less than 15 %";
        assert_eq!(
            narrow,
            [
                of("35 to 55 %", "1 to 2"),
                of("15 to 35 %", "1 to 2"),
                of(few, "1 to 2"),
                of("15 to 35 %", "2 to 4"),
                of(few, "4 to 8"),
            ]
        );
    }
}
