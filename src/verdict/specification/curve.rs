//! A curve of the base as the rules of retention and drainage read it.

use crate::gradation::{FINES_MM, GRAVEL_MM, Gap, Gradation};
use crate::outcome::design::band::{open_retention, retention};
use crate::outcome::design::specification::SpecifiedCurve;
use crate::outcome::record::{AppliedRule, IfDispersive};
use crate::outcome::rules::{BaseSoil, DESIGN, NamedCurve, PERMEABILITY, RuleInputs, apply};
use crate::verdict::practice::cited_rule;

/// D15F (mm) of the filter at which the rules are read: their limits do not depend on it.
const ANY_D15F: f64 = 1.0;

/// A curve of the base as the rules read it.
pub(super) struct ReadCurve {
    pub of: SpecifiedCurve,
    pub soil: BaseSoil,
    pub percent_no_4: f64,
    /// Where it is flattest, which may be a gap.
    pub flattest: Option<Gap>,
    pub design: Option<AppliedRule>,
    pub retention: Option<AppliedRule>,
    pub drainage: Option<AppliedRule>,
    /// Why its maximum D15F is not known.
    pub unknown: Option<String>,
}

impl ReadCurve {
    pub fn of((name, base): &NamedCurve, dispersive: bool) -> Self {
        let any = Gradation::linear_from_dx(15.0, ANY_D15F, 1.5).expect("sizes of a sand");
        let rules = apply(&RuleInputs { dispersive, ..RuleInputs::of_soils(base, &any) });
        let soil = BaseSoil::of(base, false);
        // A limit that can only be less may be the strictest.
        let unknown = open_retention(&rules).map(|rule| rule.needs.to_string());
        let unknown =
            unknown.map(|why| if why.is_empty() { "the limit can only be less".into() } else { why });
        let strictest = retention(&rules, ANY_D15F);
        let drainage = rules.iter().find(|rule| rule.id == PERMEABILITY);
        Self {
            of: SpecifiedCurve {
                curve: name.clone(),
                gradation: rows(base),
                regraded: soil.regraded_at_mm.map(|_| rows(&soil.gradation)).unwrap_or_default(),
                d15_mm: base.d(15.0),
                regraded_at_mm: soil.regraded_at_mm,
                d85_mm: soil.gradation.d(85.0),
                fines_percent: soil.fines_percent,
                category: soil.category,
                d15f_max_mm: strictest.filter(|_| unknown.is_none()).map(|(_, limit)| limit),
                d15f_max_rule: strictest.map_or_else(String::new, |(rule, _)| cited_rule(rule)),
                d15f_min_mm: drainage.and_then(|rule| rule.limit),
            },
            percent_no_4: base.percent_finer_by_mass(GRAVEL_MM),
            flattest: base.flattest(FINES_MM),
            design: rules.iter().find(|rule| rule.id == DESIGN && rule.applies).cloned(),
            retention: strictest.map(|(rule, _)| rule.clone()),
            drainage: drainage.cloned(),
            unknown,
            soil,
        }
    }

    pub fn greatest(&self) -> f64 {
        self.of.d15f_max_mm.unwrap_or(f64::INFINITY)
    }

    /// Whether the true minimum D15F is not known, and is at most the one that is given.
    pub fn least_at_most(&self) -> bool {
        self.drainage.as_ref().is_some_and(|rule| rule.limit_at_most)
    }

    pub fn least(&self) -> f64 {
        self.of.d15f_min_mm.unwrap_or(0.0)
    }
}

fn rows(curve: &Gradation) -> Vec<[f64; 2]> {
    curve.points().into_iter().map(|(size, percent)| [size, percent]).collect()
}

/// What practice allows if a base of these curves is dispersive: the strictest of them; `None` where all have
/// few fines.
pub(super) fn if_dispersive(bases: &[NamedCurve]) -> Option<IfDispersive> {
    let any = Gradation::linear_from_dx(15.0, ANY_D15F, 1.5).expect("sizes of a sand");
    let of = |(_, base): &NamedCurve| {
        let rules = apply(&RuleInputs { dispersive: true, ..RuleInputs::of_soils(base, &any) });
        IfDispersive::of(BaseSoil::of(base, false).fines_percent, &rules, ANY_D15F)
    };
    let all: Vec<IfDispersive> = bases.iter().filter_map(of).collect();
    let least = all.iter().min_by(|a, b| a.d15f_max_mm.total_cmp(&b.d15f_max_mm))?;
    Some(IfDispersive { at_most: all.iter().any(|of| of.at_most), ..*least })
}
