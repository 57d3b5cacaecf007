//! A curve of the base as read by the rules of retention and drainage.

use crate::base_cautions::broad_base;
use crate::design::RowNote;
use crate::design::retention::{open_retention, retention};
use crate::design::specification::SpecifiedCurve;
use crate::rule_result::{cited_rule, has_no_margin};
use crate::rules::{BaseSoil, DESIGN, NamedCurve, OpenBase, PERMEABILITY, RuleInputs, apply, sieved_limit};
use crate::{AppliedRule, IfDispersive, Note, RuleNote};
use voidwalk_core::gradation::{FINES_MM, GAP_PERCENT, GRAVEL_MM, Gap, Gradation};

/// D15F (mm) of the filter for which the rules are read: their limits do not depend on it.
const ANY_D15F: f64 = 1.0;

/// Percent of the mass between D and 4 D below which a curve counts as flat and is noted: twice the percent
/// of a gap.
const FLAT_PERCENT: f64 = 2.0 * GAP_PERCENT;

/// A curve of the base with the results of the rules.
pub(super) struct ReadCurve {
    pub of: SpecifiedCurve,
    /// Curve as sampled.
    base: Gradation,
    pub dispersive: bool,
    pub soil: BaseSoil,
    pub percent_no_4: f64,
    /// The flattest part, which may be a gap.
    pub flattest: Option<Gap>,
    pub design: Option<AppliedRule>,
    pub retention: Option<AppliedRule>,
    pub drainage: Option<AppliedRule>,
    /// The mildest minimum D15F (mm) that the sieves leave possible; 0 if no sieve bounds it.
    drains_from: f64,
    /// Reasons for an unknown maximum D15F.
    pub unknown: Option<Vec<RuleNote>>,
}

impl ReadCurve {
    pub fn of((name, base): &NamedCurve, dispersive: bool) -> Self {
        let any = Gradation::linear_from_dx(15.0, ANY_D15F, 1.5).expect("sizes of a sand");
        let rules = apply(&RuleInputs { dispersive, ..RuleInputs::of_soils(base, &any) });
        let soil = BaseSoil::of(base, false);
        let open = OpenBase::of(base, false);
        let over_sieves = sieved_limit(DESIGN, base, &open, dispersive).and_then(|limit| limit.depends_on);
        // A limit that can only be less may be the strictest.
        let unknown = open_retention(&rules).map(|rule| rule.needs.clone());
        let unknown = over_sieves.map(|note| vec![note]).or(unknown);
        let strictest = retention(&rules, ANY_D15F);
        let drainage = rules.iter().find(|rule| rule.id == PERMEABILITY);
        let drains = sieved_limit(PERMEABILITY, base, &open, dispersive);
        let between = drains.as_ref().filter(|limit| limit.depends_on.is_some());
        Self {
            base: base.clone(),
            dispersive,
            of: SpecifiedCurve {
                curve: name.clone(),
                gradation: base.rows(),
                regraded: soil.regraded_at_mm.map(|_| soil.gradation.rows()).unwrap_or_default(),
                d15_mm: base.d(15.0),
                regraded_at_mm: soil.regraded_at_mm,
                d85_mm: soil.gradation.d(85.0),
                fines_percent: soil.fines_percent,
                category: soil.category,
                d15f_max_mm: strictest.filter(|_| unknown.is_none()).map(|(_, limit)| limit),
                d15f_max_rule: strictest.map_or_else(String::new, |(rule, _)| cited_rule(rule)),
                without_margin: has_no_margin(&rules),
                d15f_min_mm: drains.as_ref().map(|limit| limit.strictest),
            },
            percent_no_4: base.percent_finer_by_mass(GRAVEL_MM),
            flattest: base.flattest(FINES_MM),
            design: rules.iter().find(|rule| rule.id == DESIGN && rule.applies).cloned(),
            retention: strictest.map(|(rule, _)| rule.clone()),
            drainage: drainage.cloned(),
            drains_from: between.map_or(0.0, |limit| limit.mildest),
            unknown,
            soil,
        }
    }

    /// Notes on the base itself.
    fn notes(&self) -> Vec<Note> {
        let unstable = self.base.known_kenney_lau().filter(|index| index.value < 1.0);
        let unstable =
            unstable.map(|shape| Note::UnstableBase { index: shape.value, finer_percent: shape.percent });
        let broad = self.of.regraded_at_mm.and_then(|_| broad_base(&self.base));
        unstable.into_iter().chain(broad).chain(self.flat()).collect()
    }

    /// A gap of the base, or a flat part that may be one; parts that practice cuts off do not count.
    fn flat(&self) -> Option<Note> {
        let cut = self.of.regraded_at_mm.unwrap_or(f64::INFINITY);
        let flat = self.flattest.filter(|flat| flat.within < FLAT_PERCENT && flat.from_mm <= cut)?;
        let (from_mm, to_mm, within_percent) = (flat.from_mm, 4.0 * flat.from_mm, flat.within);
        Some(if within_percent < GAP_PERCENT {
            Note::GapOfBase { within_percent, from_mm, to_mm }
        } else {
            Note::FlatBase { from_mm, to_mm, within_percent }
        })
    }

    pub fn greatest(&self) -> f64 {
        self.of.d15f_max_mm.unwrap_or(f64::INFINITY)
    }

    /// True if the true minimum D15F is not known, and is at most the one given.
    pub fn least_at_most(&self) -> bool {
        self.drainage.as_ref().is_some_and(|rule| rule.limit_at_most)
    }

    /// Certain lower bound of the minimum D15F.
    pub fn certain_least(&self) -> f64 {
        if self.least_at_most() { self.drains_from } else { self.least() }
    }

    pub fn least(&self) -> f64 {
        self.of.d15f_min_mm.unwrap_or(0.0)
    }
}

/// Notes on a base of these curves, with the name of the curve if there are several.
pub(super) fn notes(read: &[ReadCurve]) -> Vec<RowNote> {
    let row = |curve: &ReadCurve| (read.len() > 1).then(|| curve.of.curve.clone());
    let row_notes = |curve: &ReadCurve| {
        curve.notes().into_iter().map(|note| RowNote { row: row(curve), note }).collect::<Vec<_>>()
    };
    read.iter().flat_map(row_notes).collect()
}

/// Strictest limit of practice among these curves if the base is dispersive; `None` if all have few fines.
pub(super) fn if_dispersive(bases: &[NamedCurve]) -> Option<IfDispersive> {
    let any = Gradation::linear_from_dx(15.0, ANY_D15F, 1.5).expect("sizes of a sand");
    IfDispersive::of_bases(bases, &any)
}
