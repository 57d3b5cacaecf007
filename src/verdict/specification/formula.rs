//! The formula by which a rule of retention limits D15F, for the fines of one base.

use super::curve::ReadCurve;
use crate::gradation::FEW_FINES;
use crate::outcome::numbers::significant;
use crate::outcome::record::AppliedRule;
use crate::outcome::rules::{DESIGN, TESTS_NO_EROSION};
use crate::verdict::rule_words::cited_rule;
use crate::verdict::words::capital;

/// Percent of fines above which a base is of category 1.
const MANY_FINES: f64 = 85.0;

/// The formula of a rule for the fines of a base, and the same with the base's numbers; the whole formula of
/// the rule where its fines or its D85 are not known.
pub(super) fn of_base(rule: &AppliedRule, curve: &ReadCurve) -> String {
    let name = capital(&cited_rule(rule));
    let sizes = curve.of.fines_percent.zip(curve.of.d85_mm);
    let found = sizes.and_then(|(fines, d85b)| Some((item(rule, fines, curve.dispersive)?, fines, d85b)));
    let Some(((condition, formula), fines, d85b)) = found else {
        return format!("{name}: {}", rule.formula);
    };
    let category = curve.of.category.filter(|_| rule.id == DESIGN);
    let category = category.map_or_else(String::new, |category| format!("category {category}, "));
    let dispersive = if curve.dispersive && fines >= FEW_FINES { ", dispersive" } else { "" };
    let [fines, d85b] = [format!("- {})", significant(fines)), format!("x {}", significant(d85b))];
    let worked = formula.replace("- A)", &fines).replace("D85B", &d85b);
    let unit = if worked.contains("mm") { "" } else { " mm" };
    let worked = if worked == formula { String::new() } else { format!(" = {worked}{unit}") };
    format!("{name}, {category}{condition}{dispersive}: {formula}{worked}")
}

/// The condition and the limit of a rule's formula that hold for a base with so many percent of fines.
fn item(rule: &AppliedRule, fines: f64, dispersive: bool) -> Option<(&str, &str)> {
    let from = match rule.id.as_str() {
        DESIGN => 40.0,
        TESTS_NO_EROSION => 35.0,
        _ => return None,
    };
    let (usual, of_dispersive) = rule.formula.split_once("; dispersive: ")?;
    // Each list begins with the most fines; that of dispersive soils ends where no text has a limit.
    let at = match fines {
        fines if fines > MANY_FINES => 0,
        fines if fines >= from => 1,
        fines if fines >= FEW_FINES => 2,
        _ => 3,
    };
    let of = if dispersive && fines >= from { of_dispersive } else { usual };
    of.split("; ").nth(at)?.split_once(": ")
}
