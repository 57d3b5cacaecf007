//! Rules of practice in the rows of a table.

use std::borrow::Cow;

use super::rule_result::without_margin;
use crate::AppliedRule;
use crate::rules::{DESIGN, PERMEABILITY, PERMEABILITY_LEAST, TESTS_NO_EROSION};

/// Rules in the form of a sheet's list. Of two rules of drainage with one limit, their floor, the list has
/// the first. The limit of a dispersive base, one number for design and for no erosion, appears once and
/// under its own name.
pub(super) fn listed(rules: &[AppliedRule]) -> Vec<Cow<'_, AppliedRule>> {
    let repeats = |rule: &&AppliedRule| {
        let is_listed = |other: &AppliedRule| {
            other.id == PERMEABILITY && other.limit.is_some() && other.limit == rule.limit
        };
        rule.id == PERMEABILITY_LEAST && !rule.limit_at_most && rules.iter().any(is_listed)
    };
    let is_one = without_margin(rules).is_some();
    let once = rules.iter().filter(|rule| !(repeats(rule) || is_one && rule.id == TESTS_NO_EROSION));
    once.map(|rule| match is_one && rule.id == DESIGN {
        true => Cow::Owned(of_dispersive(rule)),
        false => Cow::Borrowed(rule),
    })
    .collect()
}

/// The limit of a dispersive base under its own name.
fn of_dispersive(design: &AppliedRule) -> AppliedRule {
    let [name, source, applies_to] = [OF_DISPERSIVE, OF_DISPERSIVE_SOURCE, FOR_DISPERSIVE].map(str::to_owned);
    AppliedRule { name, authority: FELL.to_owned(), source, applies_to, ..design.clone() }
}

/// The authors of the limit of a dispersive base.
const FELL: &str = "Fell et al.";

/// Name of the limit of a dispersive base, which leaves design no margin.
const OF_DISPERSIVE: &str =
    "Fell et al.: no erosion of a highly dispersive base (taken for design, too, without a margin)";

/// Soils that the limit was made for.
const FOR_DISPERSIVE: &str = "highly dispersive bases: the lower boundary of no erosion, without a margin of \
                              safety; this program takes it for design, too";

/// Source of the limit.
const OF_DISPERSIVE_SOURCE: &str = "Fell, MacGregor, Stapledon & Bell, Geotechnical Engineering of Dams, \
                                    Table 9.2, note (b)";

#[cfg(test)]
mod tests {
    use super::*;
    use crate::PairRules;
    use voidwalk_core::Gradation;

    /// A clay has the floor of both rules of drainage; of a sand they ask for 5 and 3 times D15B.
    #[test]
    fn a_limit_of_drainage_is_listed_once() {
        let filter = Gradation::from_lines(&[(0.5, 0.0), (2.0, 100.0)]).unwrap();
        let clay = [(0.002, 51.0), (0.02, 87.0), (0.63, 100.0)];
        for (base, count) in [(&clay[..], 1), (&[(0.1, 0.0), (0.4, 100.0)], 2)] {
            let pair = PairRules::of(&Gradation::from_lines(base).unwrap(), &filter);
            let drains = |rule: &AppliedRule| rule.id.starts_with(PERMEABILITY);
            assert_eq!(listed(&pair.rules).iter().filter(|rule| drains(rule)).count(), count);
            assert_eq!(pair.rules.iter().filter(|rule| drains(rule)).count(), 2);
        }
    }

    #[test]
    fn the_limit_of_a_dispersive_base_has_its_own_authors() {
        use crate::PairOptions;
        let soil = |points: &[(f64, f64)]| vec![("s".to_owned(), Gradation::from_lines(points).unwrap())];
        let base = soil(&[(0.01, 0.0), (0.075, 60.0), (0.3, 92.0), (0.6, 100.0)]);
        let filter = soil(&[(0.3, 0.0), (2.0, 100.0)]);
        let authors = |dispersive| {
            let options = PairOptions { dispersive, ..PairOptions::default() };
            let rules = PairRules::of_envelopes(&base, &filter, options).rules;
            let rows = listed(&rules);
            let design = rows.iter().find(|rule| rule.id == DESIGN).unwrap();
            design.authorities().join(", ")
        };
        assert_eq!(authors(false), "Sherard and Dunnigan, NRCS, USBR, USACE");
        assert_eq!(authors(true), "Fell et al., NRCS, USBR, USACE");
    }
}
