//! The band of a specification: from the minimum D15F that drains the base to the greatest that holds it.

use super::entry::Finding;
use super::finding;
use super::rule_words::cited;
use super::words::within;
use crate::outcome::design::band::{Band, SetBy, limits, open_retention, retention};
use crate::outcome::numbers::{rounded_down, rounded_up};
use crate::outcome::record::AppliedRule;
use crate::outcome::rules::{PERMEABILITY, RULES};

impl Band {
    /// From the rules of a filter of this D15F and the maximum D15F that holds, in the unit of the rules;
    /// `None` where the least is not known, or of the limit of practice only the most.
    pub fn new(rules: &[AppliedRule], d15f: f64, held: f64, unit: &str) -> Option<Self> {
        if open_retention(rules).is_some() {
            return None;
        }
        let limits = limits(rules, d15f);
        let (drainage, least) = *limits.iter().find(|(rule, _)| rule.id == PERMEABILITY)?;
        let strictest = retention(rules, d15f);
        // The stricter of walk and practice is the one that clashes.
        let stricter = strictest.filter(|(_, limit)| *limit < held);
        let greatest = stricter.map_or(held, |(_, limit)| limit);
        let mut band = Self {
            least,
            least_at_most: drainage.limit_at_most,
            greatest,
            set_by: if stricter.is_some() { SetBy::Practice } else { SetBy::Walk },
            practice: strictest.map(|(_, limit)| limit),
            practice_rule: strictest.map_or_else(String::new, |(rule, _)| rule.name.clone()),
            practice_rule_id: strictest.map(|(rule, _)| rule.id.clone()),
            unit: unit.into(),
            // A least that is not known leaves nothing out.
            is_empty: least > greatest && !drainage.limit_at_most,
            said: String::new(),
        };
        band.said = match band.empty() {
            Some(empty) => within(&empty.sentence()),
            None => band.sides(greatest, stricter.map(|_| band.rule())),
        };
        Some(band)
    }

    /// What practice allows beyond the walk that sets the greatest; `None` where it allows no more.
    pub fn practice_in_words(&self) -> Option<String> {
        let limit = self.practice.filter(|_| self.set_by == SetBy::Walk && !self.is_empty)?;
        Some(format!("practice allows up to {} {}", rounded_down(limit), self.unit))
    }

    /// That nothing lies between the minimum D15F that drains a base and the greatest that holds it.
    pub fn empty(&self) -> Option<Finding> {
        let size = |rounded: String| format!("{rounded} {}", self.unit);
        let (least, greatest) = (size(rounded_up(self.least)), size(rounded_down(self.greatest)));
        let set_by = match self.set_by {
            SetBy::Practice => self.rule(),
            SetBy::Walk => "the walk".into(),
        };
        self.is_empty.then(|| finding::empty_band(&least, &greatest, &set_by))
    }

    fn sides(&self, greatest: f64, practice: Option<String>) -> String {
        let set_by = practice.map_or("the walk".into(), |rule| format!("practice ({rule})"));
        let (least, greatest, unit) = (rounded_up(self.least), rounded_down(greatest), &self.unit);
        match self.least_at_most {
            true => format!(
                "D15F up to {greatest} {unit}, by {set_by}; the minimum that drains is not known, and at \
                 most {least} {unit}: D15B must be tested"
            ),
            false => format!("D15F from {least} to {greatest} {unit}, the coarse side by {set_by}"),
        }
    }

    /// The rule of practice, as a sentence cites it.
    fn rule(&self) -> String {
        let id = self.practice_rule_id.as_deref();
        let listed = RULES.iter().find(|rule| Some(rule.id) == id);
        listed.map_or_else(|| self.practice_rule.clone(), |rule| cited(rule.id, rule.authority))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::gradation::Gradation;
    use crate::verdict::PairRules;

    /// D15F of the filter that is judged.
    const D15F: f64 = 1.6;

    fn rules(base_cu: f64) -> Vec<AppliedRule> {
        let filter = Gradation::linear_from_dx(15.0, D15F, 1.5).unwrap();
        PairRules::of(&Gradation::linear_from_dx(85.0, 0.4, base_cu).unwrap(), &filter).rules
    }

    #[test]
    fn a_band_goes_from_permeability_to_the_walk_with_practice_beside() {
        let all = rules(3.0);
        let band = Band::new(&all, D15F, 1.8, "mm").unwrap();
        // D15B of a linear Cu 3 base: 0.4 x 3^(-70/50).
        let d15b = 0.4 * libm::pow(3.0, -1.4);
        assert!((band.least - 5.0 * d15b).abs() < 1e-9 && !band.is_empty, "{band:?}");
        assert!((band.practice.unwrap() - 1.6).abs() < 1e-9 && (band.greatest - 1.6).abs() < 1e-9);
        assert_eq!(
            band.said,
            "D15F from 0.430 to 1.60 mm, the coarse side by practice (Sherard and Dunnigan's limit of \
             design)"
        );
        let narrow = Band::new(&all, D15F, 1.2, "mm").unwrap();
        assert_eq!((narrow.greatest, narrow.set_by), (1.2, SetBy::Walk));
        assert_eq!(narrow.said, "D15F from 0.430 to 1.20 mm, the coarse side by the walk");
    }

    #[test]
    fn a_band_is_said_with_its_ends_rounded_inward() {
        let all = rules(3.0);
        let band = Band { least: 0.7051, ..Band::new(&all, D15F, 1.2068, "mm").unwrap() };
        let of_walk = band.sides(band.greatest, None);
        assert_eq!(of_walk, "D15F from 0.706 to 1.20 mm, the coarse side by the walk");
        let open = Band { least_at_most: true, ..band.clone() }.sides(0.8069, None);
        assert!(open.starts_with("D15F up to 0.806 mm") && open.contains("at most 0.706 mm"), "{open}");
        let empty = Band { least: 1.2061, greatest: 1.2069, is_empty: true, ..band };
        let said = empty.empty().unwrap().sentence();
        assert!(said.contains("at least 1.21 mm") && said.contains("at most 1.20 mm"), "{said}");
    }

    #[test]
    fn an_empty_band_has_the_two_numbers_that_clash() {
        let all = rules(1.2);
        let band = Band::new(&all, D15F, 1.5, "mm").unwrap();
        let least = 5.0 * 0.4 * libm::pow(1.2, -1.4);
        assert!(band.is_empty && (band.least - least).abs() < 1e-9, "{band:?}");
        assert_eq!((band.greatest, band.set_by), (1.5, SetBy::Walk));
    }

    #[test]
    fn practice_that_allows_less_than_drains_leaves_an_empty_band() {
        let all = rules(1.1);
        let band = Band::new(&all, D15F, 1.8, "mm").unwrap();
        let least = 5.0 * 0.4 * libm::pow(1.1, -1.4);
        assert!(band.practice.unwrap() < least && least < 1.8, "{band:?}");
        assert!(band.is_empty && (band.least - least).abs() < 1e-9, "{band:?}");
        assert!((band.greatest - 1.6).abs() < 1e-9 && band.set_by == SetBy::Practice, "{band:?}");
    }

    #[test]
    fn an_empty_band_names_the_two_numbers_that_clash_and_whose_the_second_is() {
        let said = |base_cu: f64, greatest: f64| {
            let band = Band::new(&rules(base_cu), D15F, greatest, "mm").unwrap();
            let least = format!("at least {} mm", rounded_up(5.0 * 0.4 * libm::pow(base_cu, -1.4)));
            let sentence = band.empty().map(|finding| finding.sentence());
            assert!(sentence.as_ref().is_none_or(|said| said.contains(&least)), "{sentence:?}");
            sentence.unwrap_or_default()
        };
        assert_eq!(said(3.0, 1.8), "");
        assert!(said(1.2, 1.5).ends_with("but the walk allows at most 1.50 mm."), "{}", said(1.2, 1.5));
        let practice = said(1.1, 1.8);
        let limit = "but Sherard and Dunnigan's limit of design allows at most 1.60 mm.";
        assert!(practice.ends_with(limit) && !practice.contains("walk"), "{practice}");
    }
}
