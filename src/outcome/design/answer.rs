//! The answer of a design: the least of what walk and practice allow, and which of the two set it.
//!
//! The limit of practice is the strictest rule of retention that was made for the base: as a rule Sherard and
//! Dunnigan's limit of design, and Foster and Fell's boundary of no erosion where that is lower, as for 35 to
//! 40 % fines. No specification allows a filter with which tests saw erosion.

use super::band::{DESIGN, SetBy, limits, retention, whose};
use super::record::{Answer, Design, DesignRow};
use crate::outcome::record::{AppliedRule, RuleRole};
use crate::outcome::three;

/// The finest base that practice allows with a filter, for the inverse.
#[derive(Clone, Debug, PartialEq)]
pub struct FinestBase {
    /// D15F/D85B up to which every rule of retention is kept; `None` where one is broken at all that was
    /// searched.
    pub ratio: Option<f64>,
    /// The rule that a finer base breaks.
    pub rule: AppliedRule,
}

/// A limit of practice.
struct Limit<'a> {
    ratio: f64,
    rule: &'a AppliedRule,
}

impl Answer {
    /// Of a design whose boundaries and rules are known; `finest` is what practice says for the inverse, where
    /// that was searched.
    pub fn of(design: &Design, finest: Option<&FinestBase>) -> Self {
        let sizes = Sizes::of(design);
        let strictest = retention(&design.rules, design.rules_at * sizes.d85);
        let limit = match (design.inverse, finest) {
            (true, Some(FinestBase { ratio: Some(ratio), rule })) => Some(Limit { ratio: *ratio, rule }),
            (true, _) => None,
            // Sizes without a unit are taken as a sand without fines: no limit is known of the base itself.
            (false, _) if !sizes.has_unit => None,
            (false, _) => strictest.map(|(rule, limit)| Limit { ratio: limit / sizes.d85, rule }),
        };
        let held = design.least_held();
        // Files of an earlier version know only whether the base that the walk holds breaks a rule.
        let broken = design.rules.iter().find(|rule| rule.role == RuleRole::Retention && rule.is_broken());
        let known = broken.filter(|_| design.inverse && sizes.has_unit && finest.is_none());
        let forbidden = known.or(finest.filter(|of| of.ratio.is_none()).map(|of| &of.rule));
        let (ratio, set_by) = match (&held, &limit) {
            _ if forbidden.is_some() => (None, SetBy::Practice),
            (None, _) => (None, SetBy::Walk),
            (Some((_, held)), Some(limit)) if limit.ratio <= *held => (Some(limit.ratio), SetBy::Practice),
            (Some((_, held)), _) => (Some(*held), SetBy::Walk),
        };
        let said = match (&held, &limit, forbidden) {
            (.., Some(rule)) => {
                format!(
                    "No base is known that both walk and practice allow with this filter ({})",
                    whose(rule)
                )
            }
            (None, None, _) => "No ratio is known that nearly all networks hold".into(),
            (None, Some(limit), _) => format!(
                "No ratio is known that nearly all networks hold; practice alone allows {} ({})",
                sizes.words(limit.ratio),
                whose(limit.rule)
            ),
            (Some(_), Some(limit), _) if set_by == SetBy::Practice => {
                let other = sizes.other(design, limit.rule);
                format!(
                    "{}, by practice ({}{other}); the walk sets no tighter limit",
                    sizes.words(limit.ratio),
                    whose(limit.rule)
                )
            }
            (Some((row, held)), Some(limit), _) => format!(
                "{}{}, by the walk; practice allows {} ({})",
                searched(row),
                sizes.words(*held),
                sizes.words(limit.ratio),
                whose(limit.rule)
            ),
            (Some((row, held)), None, _) => format!(
                "{}{} in the model alone; {}",
                searched(row),
                sizes.words(*held),
                sizes.without_limit(strictest)
            ),
        };
        let size = |ratio: f64| sizes.mm(ratio);
        Self {
            d15f_max_mm: ratio.filter(|_| !design.inverse).and_then(size),
            d85b_min_mm: ratio.filter(|_| design.inverse).and_then(size),
            d15f_over_d85b: ratio,
            set_by,
            rule: match (set_by, forbidden, limit) {
                (SetBy::Practice, Some(rule), _) => Some(rule.id.clone()),
                (SetBy::Practice, None, limit) => limit.map(|limit| limit.rule.id.clone()),
                (SetBy::Walk, ..) => None,
            },
            said,
        }
    }
}

/// The sizes that ratios stand for.
struct Sizes {
    inverse: bool,
    has_unit: bool,
    d85: f64,
    d15f_mm: Option<f64>,
}

impl Sizes {
    fn of(design: &Design) -> Self {
        let d85 = design.base.d85_mm.filter(|_| !design.inverse);
        Self {
            inverse: design.inverse,
            has_unit: if design.inverse { design.filter_d15_mm.is_some() } else { d85.is_some() },
            d85: d85.unwrap_or(1.0),
            d15f_mm: design.filter_d15_mm,
        }
    }

    /// D15F (mm) of a ratio, or D85B for the inverse.
    fn mm(&self, ratio: f64) -> Option<f64> {
        match (self.has_unit, self.inverse) {
            (false, _) => None,
            (true, false) => Some(ratio * self.d85),
            (true, true) => Some(self.d15f_mm? / ratio),
        }
    }

    fn words(&self, ratio: f64) -> String {
        match (self.mm(ratio), self.inverse) {
            (Some(mm), false) => format!("D15F up to {} mm", three(mm)),
            (Some(mm), true) => format!("D85B down to {} mm", three(mm)),
            (None, _) => format!("D15F up to {ratio:.2} D85B"),
        }
    }

    /// The limit of design, where another rule is stricter.
    fn other(&self, design: &Design, rule: &AppliedRule) -> String {
        let of_design = limits(&design.rules, design.rules_at * self.d85).into_iter();
        let mut of_design = of_design.filter(|(of, _)| of.id == DESIGN && rule.id != DESIGN && !self.inverse);
        of_design
            .next()
            .map_or(String::new(), |(of, limit)| format!("; {} is {} mm", whose(of), three(limit)))
    }

    /// Why no limit of practice is known.
    fn without_limit(&self, assumed: Option<(&AppliedRule, f64)>) -> String {
        match assumed.filter(|_| !self.inverse && !self.has_unit) {
            Some((rule, limit)) => format!(
                "the limit of practice is not known, as sizes have no unit (for a sand without fines it is \
                 {limit:.2} D85B, {})",
                whose(rule)
            ),
            None if self.has_unit => "the limit of practice is not known for this base".into(),
            None => "the limit of practice is not known, as sizes have no unit".into(),
        }
    }
}

/// Whether a row holds all that was searched, before its size.
fn searched(row: &DesignRow) -> &'static str {
    match (&row.no_erosion, row.eroding_networks()) {
        (Some(_), _) => "",
        (None, 0) => "Holds as far as was searched: ",
        (None, _) => "Held by nearly all networks: ",
    }
}

impl Design {
    /// The answer, of files of earlier versions too.
    pub fn answer(&self) -> Answer {
        self.answer.clone().unwrap_or_else(|| Answer::of(self, None))
    }
}
