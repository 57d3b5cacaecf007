//! The band of a specification: from the least D15F that drains the base to the greatest that holds it.

use serde::{Deserialize, Serialize};

use crate::outcome::record::{AppliedRule, RuleRole};

/// Between which D15F a filter both drains and holds.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Band {
    /// Least D15F, of the rule of permeability.
    pub least: f64,
    /// Greatest D15F at which the walk erodes less than 7.5 % in the first run, on all but 5 % of networks.
    pub greatest: f64,
    /// Greatest D15F that the strictest rule of retention allows, which was made for this base.
    pub practice: Option<f64>,
    /// Name of that rule.
    pub practice_rule: String,
    /// Unit: `mm`, or `D85B`.
    pub unit: String,
    /// Whether nothing lies between the least and what both the walk and practice allow.
    pub is_empty: bool,
    /// The same in a sentence.
    pub said: String,
}

/// The name of the rule of permeability.
pub const PERMEABILITY: &str = "permeability";

/// Limits of D15F that rules set for a base, in the unit of the rules: name and limit.
///
/// Only rules that were made for it; a limit of a ratio to D85B (Terzaghi) or D95B is taken times that size.
pub fn limits(rules: &[AppliedRule], d85b: f64, d95b: Option<f64>) -> Vec<(&AppliedRule, f64)> {
    let one = |rule| -> Option<(&AppliedRule, f64)> {
        let rule: &AppliedRule = rule;
        let limit = rule.limit.filter(|limit| rule.applies && *limit > 0.0 && limit.is_finite())?;
        match rule.quantity.as_str() {
            "D15F" => Some((rule, limit)),
            "D15F/D85B" => Some((rule, limit * d85b)),
            "D15F/D95B" => Some((rule, limit * d95b?)),
            _ => None,
        }
    };
    rules.iter().filter_map(one).collect()
}

impl Band {
    /// From the rules and the greatest D15F that holds, in the unit of the rules; `None` where the least is
    /// not known.
    pub fn new(rules: &[AppliedRule], d85b: f64, greatest: f64, unit: &str) -> Option<Self> {
        let limits = limits(rules, d85b, None);
        let (_, least) = *limits.iter().find(|(rule, _)| rule.id == PERMEABILITY)?;
        let retention = limits.iter().filter(|(rule, _)| rule.role == RuleRole::Retention && !rule.at_least);
        let strictest = retention.min_by(|a, b| a.1.total_cmp(&b.1));
        // The stricter of walk and practice is the one that clashes.
        let practice = strictest.filter(|(_, limit)| *limit < greatest);
        let is_empty = least > practice.map_or(greatest, |(_, limit)| *limit);
        let asked = format!("permeability asks for a D15F of at least {least:.3} {unit}");
        let said = match (is_empty, practice) {
            (true, Some((rule, limit))) => format!(
                "no filter of this shape both drains this base and keeps to practice: {asked}, but {} allows \
                 up to {limit:.3} {unit} only",
                rule.name
            ),
            (true, None) => format!(
                "no filter of this shape both drains and holds this base: {asked}, but the walk holds up to \
                 {greatest:.3} {unit} only"
            ),
            (false, _) => format!("D15F from {least:.3} to {greatest:.3} {unit}"),
        };
        Some(Self {
            least,
            greatest,
            practice: strictest.map(|(_, limit)| *limit),
            practice_rule: strictest.map_or_else(String::new, |(rule, _)| rule.name.clone()),
            unit: unit.into(),
            is_empty,
            said,
        })
    }

    /// Greatest D15F that both walk and practice allow.
    pub fn greatest_of_both(&self) -> f64 {
        self.practice.map_or(self.greatest, |practice| practice.min(self.greatest))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::gradation::Gradation;
    use crate::outcome::PairRules;

    fn rules(base_cu: f64) -> (Vec<AppliedRule>, f64) {
        let base = Gradation::linear_from_dx(85.0, 0.4, base_cu).unwrap();
        let filter = Gradation::linear_from_dx(15.0, 1.6, 1.5).unwrap();
        (PairRules::of(&filter, &base).rules, base.d(85.0).unwrap())
    }

    #[test]
    fn a_band_goes_from_permeability_to_the_walk_with_practice_beside() {
        let (all, d85b) = rules(3.0);
        let band = Band::new(&all, d85b, 1.8, "mm").unwrap();
        // D15B of a linear Cu 3 base: 0.4 x 3^(-70/50).
        let d15b = 0.4 * libm::pow(3.0, -1.4);
        assert!((band.least - 5.0 * d15b).abs() < 1e-9 && !band.is_empty, "{band:?}");
        assert!((band.practice.unwrap() - 1.6).abs() < 1e-9 && (band.greatest_of_both() - 1.6).abs() < 1e-9);
        assert!(band.said.contains("from 0.430 to 1.800 mm"), "{}", band.said);
    }

    #[test]
    fn an_empty_band_names_the_two_numbers_that_clash() {
        let (all, d85b) = rules(1.2);
        let band = Band::new(&all, d85b, 1.5, "mm").unwrap();
        let least = 5.0 * 0.4 * libm::pow(1.2, -1.4);
        assert!(band.is_empty && band.said.contains(&format!("{least:.3} mm")), "{}", band.said);
        assert!(band.said.contains("1.500 mm"), "{}", band.said);
    }

    #[test]
    fn practice_that_allows_less_than_drains_leaves_an_empty_band() {
        let (all, d85b) = rules(1.1);
        let band = Band::new(&all, d85b, 1.8, "mm").unwrap();
        let least = 5.0 * 0.4 * libm::pow(1.1, -1.4);
        assert!(band.practice.unwrap() < least && least < band.greatest, "{band:?}");
        assert!(band.is_empty && band.said.contains(&format!("{least:.3} mm")), "{}", band.said);
        assert!(band.said.contains("up to 1.600 mm only") && !band.said.contains("1.800"), "{}", band.said);
    }

    #[test]
    fn the_limit_of_a_ratio_is_one_of_a_size() {
        let (all, d85b) = rules(3.0);
        let of = |id: &str| {
            limits(&all, d85b, None).iter().find(|(rule, _)| rule.id == id).map(|(_, limit)| *limit)
        };
        assert!((of("terzaghi").unwrap() - 1.6).abs() < 1e-9);
        assert!((of("foster-fell-no-erosion").unwrap() - 2.8).abs() < 1e-9);
        assert_eq!(of("filter-uniformity"), None);
    }
}
