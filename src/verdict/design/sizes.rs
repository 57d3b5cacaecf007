//! The sizes that ratios of a design stand for, in words.

use crate::outcome::design::Design;
use crate::outcome::design::band::limits;
use crate::outcome::numbers::{rounded_down, rounded_up};
use crate::outcome::record::AppliedRule;
use crate::outcome::rules::DESIGN;
use crate::verdict::rule_words::cited_rule;

/// The sizes that ratios D15F/D85B stand for.
pub(super) struct Sizes {
    inverse: bool,
    pub has_unit: bool,
    pub d85: f64,
    d15f_mm: Option<f64>,
}

impl Sizes {
    pub fn of(design: &Design) -> Self {
        let d85 = design.base.d85_mm.filter(|_| !design.inverse);
        Self {
            inverse: design.inverse,
            has_unit: if design.inverse { design.filter_d15_mm.is_some() } else { d85.is_some() },
            d85: d85.unwrap_or(1.0),
            d15f_mm: design.filter_d15_mm,
        }
    }

    /// D15F (mm) of a ratio, or D85B for the inverse.
    pub fn mm(&self, ratio: f64) -> Option<f64> {
        match (self.has_unit, self.inverse) {
            (false, _) => None,
            (true, false) => Some(ratio * self.d85),
            (true, true) => Some(self.d15f_mm? / ratio),
        }
    }

    /// What they are sizes of.
    pub fn name(&self) -> &'static str {
        if self.inverse && self.has_unit { "D85B" } else { "D15F" }
    }

    /// A ratio as a size.
    pub fn size(&self, ratio: f64) -> String {
        // The maximum D15F, or the minimum D85B.
        let within = if self.inverse { rounded_up } else { rounded_down };
        self.mm(ratio)
            .map_or_else(|| format!("{} D85B", rounded_down(ratio)), |mm| format!("{} mm", within(mm)))
    }

    pub fn words(&self, ratio: f64) -> String {
        let name = self.name();
        format!("{name} {} {}", if name == "D85B" { "down to" } else { "up to" }, self.size(ratio))
    }

    /// The limit of design, where another rule is stricter.
    pub fn other(&self, design: &Design, rule: &AppliedRule) -> String {
        let all = limits(&design.rules, design.rules_at * self.d85);
        let of_design = all.iter().find(|(of, _)| of.id == DESIGN && rule.id != DESIGN && !self.inverse);
        of_design.map_or(String::new(), |(of, limit)| {
            format!("; {} is {} mm", cited_rule(of), rounded_down(*limit))
        })
    }

    /// Why no limit of practice is known.
    pub fn without_limit(&self, assumed: Option<(&AppliedRule, f64)>) -> String {
        match assumed.filter(|_| !self.inverse && !self.has_unit) {
            Some((rule, limit)) => format!(
                "the limit of practice is not known, as sizes have no unit (for a sand without fines it is \
                 {limit:.2} D85B, {})",
                cited_rule(rule)
            ),
            None if self.has_unit => "the limit of practice is not known for this base".into(),
            None => "the limit of practice is not known, as sizes have no unit".into(),
        }
    }
}
