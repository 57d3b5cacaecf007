//! Formula by which a rule of retention limits D15F, for the fines of one base.

use super::curve::ReadCurve;
use crate::AppliedRule;
use crate::quantity::significant;
use crate::rule_result::cited_rule;
use crate::rules::{DESIGN, TESTS_NO_EROSION};
use voidwalk_core::gradation::FEW_FINES;

/// Percent of fines above which a base is of category 1.
const MANY_FINES: f64 = 85.0;

/// The formula of a rule for the fines of a base, followed by the formula with the base's numbers; the whole
/// formula of the rule if its fines or its D85 are not known.
pub(super) fn of_base(rule: &AppliedRule, curve: &ReadCurve) -> String {
    let name = cited_rule(rule);
    let name = name.strip_prefix("the ").map_or(name.clone(), |rest| format!("The {rest}"));
    let sizes = curve.of.fines_percent.zip(curve.of.d85_mm);
    let known = sizes.and_then(|(fines, d85b)| Some((item(rule, fines, curve.dispersive)?, fines, d85b)));
    let Some((Item { condition, formula, is_at_most }, fines, d85b)) = known else {
        return format!("{name}: {}", rule.formula);
    };
    let category = curve.of.category.filter(|_| rule.id == DESIGN);
    let category = category.map_or_else(String::new, |category| format!("category {category}, "));
    let dispersive = if curve.dispersive && fines >= FEW_FINES { ", dispersive" } else { "" };
    // This many digits of A are enough to find the limit by hand.
    let fines = (100.0 * fines).round() / 100.0;
    let [fines, d85b] = [format!("- {fines})"), format!("x {}", significant(d85b))];
    let worked = formula.replace("- A)", &fines).replace("D85B", &d85b);
    let unit = if worked.contains("mm") { "" } else { " mm" };
    let worked = if worked == formula { String::new() } else { format!(" = {worked}{unit}") };
    let [most, why] = if is_at_most { ["at most ", NO_TEXT] } else { [""; 2] };
    format!("{name}, {category}{condition}{dispersive}: {most}{formula}{worked}{why}")
}

/// Suffix to a formula for other soils, which a dispersive soil cannot exceed.
const NO_TEXT: &str = " (no text gives a limit for dispersive soils with such fines)";

/// Part of a rule's formula that holds for a base.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Item<'a> {
    condition: &'a str,
    formula: &'a str,
    /// True if the part is for other soils, and only an upper bound for a dispersive one.
    is_at_most: bool,
}

/// Condition and limit of a rule's formula that hold for a base with this percent of fines.
fn item(rule: &AppliedRule, fines: f64, dispersive: bool) -> Option<Item<'_>> {
    let from = match rule.id.as_str() {
        DESIGN => 40.0,
        TESTS_NO_EROSION => 35.0,
        _ => return None,
    };
    let (usual, of_dispersive) = rule.formula.split_once("; dispersive: ")?;
    // Each list begins with the most fines; the list for dispersive soils ends where no text has a limit.
    let at = match fines {
        fines if fines > MANY_FINES => 0,
        fines if fines >= from => 1,
        fines if fines >= FEW_FINES => 2,
        _ => 3,
    };
    let items = if dispersive && fines >= from { of_dispersive } else { usual };
    let (condition, formula) = items.split("; ").nth(at)?.split_once(": ")?;
    let is_at_most = dispersive && (FEW_FINES..from).contains(&fines);
    Some(Item { condition, formula, is_at_most })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::PairRules;
    use voidwalk_core::gradation::Gradation;

    /// Every item of both formulas is found in their texts, whose wording may change.
    #[test]
    fn each_rule_has_the_item_of_the_fines_of_its_base() {
        let sand = Gradation::linear_from_dx(85.0, 0.3, 3.0).unwrap();
        let rules = PairRules::of(&sand, &Gradation::linear_from_dx(15.0, 1.0, 1.5).unwrap()).rules;
        let between = "(40 - A)/25 (4 D85B - 0.7) + 0.7 mm";
        let fell = "1.6 ((35 - A)/20 (4 D85B - 0.7) + 0.7 mm)";
        let [nine, least] = ["9 D85B, not less than 0.2 mm", "6.4 D85B, not less than 0.2 mm"];
        for (id, fines, dispersive, condition, formula) in [
            (DESIGN, 90.0, false, "A > 85 %", nine),
            (DESIGN, 40.0, false, "A 40 to 85 %", "0.7 mm"),
            (DESIGN, 39.0, false, "A 15 to 40 %", between),
            (DESIGN, 14.0, false, "A < 15 %", "4 D85B"),
            (DESIGN, 90.0, true, "A > 85 %", least),
            (DESIGN, 40.0, true, "40 to 85 %", "0.5 mm"),
            (DESIGN, 39.0, true, "A 15 to 40 %", between),
            (DESIGN, 14.0, true, "A < 15 %", "4 D85B"),
            (TESTS_NO_EROSION, 90.0, false, "A > 85 %", "9 D85B"),
            (TESTS_NO_EROSION, 35.0, false, "A 35 to 85 %", "0.7 mm"),
            (TESTS_NO_EROSION, 34.0, false, "A 15 to 35 %", fell),
            (TESTS_NO_EROSION, 14.0, false, "A < 15 %", "7 D85B"),
            (TESTS_NO_EROSION, 90.0, true, "A > 85 %", "6.4 D85B"),
            (TESTS_NO_EROSION, 35.0, true, "35 to 85 %", "0.5 mm"),
            (TESTS_NO_EROSION, 34.0, true, "A 15 to 35 %", fell),
            (TESTS_NO_EROSION, 14.0, true, "A < 15 %", "7 D85B"),
        ] {
            let rule = rules.iter().find(|rule| rule.id == id).unwrap();
            let is_at_most = dispersive && (15.0..=39.0).contains(&fines) && fines != 35.0;
            let wanted = Item { condition, formula, is_at_most };
            assert_eq!(item(rule, fines, dispersive), Some(wanted), "{id} {fines} {dispersive}");
        }
    }
}
