//! Steps of a specification, with their numbers, formulas and sources.

use crate::design::RowNote;
use crate::design::size_band::{D15_OVER_D10, LEAST_SHAPE, MOST_KEZDI, Side};
use crate::design::specification::{
    BandSize, ENTERED_BY, SizeBand, SpecificationStep, SpecifiedCurve, StepName, StepNote, StepValue,
};
use crate::quantity::significant;
use crate::retention::{open_retention, retention};
use crate::rule_result::{cited_rule, has_no_margin};
use crate::rules::{
    BaseSoil, DESIGN, GREATEST_SIZE_MM, MOST_CU, NamedCurve, OpenBase, PERMEABILITY, RULES, RuleInputs,
    TESTS_NO_EROSION, WIDEST_BAND, apply, broad_base, sieved_limit,
};
use crate::{AppliedRule, Note, RuleNote};
use voidwalk_core::gradation::{FEW_FINES, FINES_MM, GAP_PERCENT, GRAVEL_MM, Gap, Gradation};

/// Control points of a band: D15 and D60 (mm) of its fine and its coarse side.
#[derive(Clone, Copy)]
pub(super) struct Control {
    pub(super) d15: [f64; 2],
    pub(super) d60: [f64; 2],
}

/// Facts that the steps state.
pub(super) struct Findings<'a> {
    pub(super) read: &'a [ReadCurve],
    /// Curve that sets the maximum D15F.
    pub(super) strictest: Option<&'a ReadCurve>,
    pub(super) unknown: Option<&'a ReadCurve>,
    /// Curve that sets the minimum D15F.
    pub(super) coarsest: Option<&'a ReadCurve>,
    pub(super) d15f_max: Option<f64>,
    pub(super) control: Option<Control>,
    pub(super) band: Option<&'a SizeBand>,
    /// True if the band lies at the finer end of the allowed sizes.
    pub(super) finer: bool,
}

impl Findings<'_> {
    pub(super) fn steps(&self) -> Vec<SpecificationStep> {
        let steps = [
            self.gradation(),
            self.gravel(),
            self.regrading(),
            self.category(),
            self.retention(),
            self.drainage(),
            self.width(),
            self.uniformity(),
            self.ends(),
            self.segregation(),
            self.sides(),
            self.stability(),
        ];
        (1..).zip(steps).map(|(number, step)| SpecificationStep { step: number, ..step }).collect()
    }

    /// One number for each curve, named after the curve if there are several.
    fn of_each_curve(
        &self,
        name: &str,
        unit: &str,
        value: impl Fn(&ReadCurve) -> Option<f64>,
    ) -> Vec<StepValue> {
        let named_after = |curve: &ReadCurve| match self.name(curve) {
            Some(curve) => format!("{name} of {curve}"),
            None => name.to_owned(),
        };
        self.read.iter().map(|curve| named(&named_after(curve), value(curve), unit)).collect()
    }

    /// Name of a curve, if there are several.
    fn name(&self, curve: &ReadCurve) -> Option<String> {
        (self.read.len() > 1).then(|| curve.record.curve.clone())
    }

    fn gradation(&self) -> SpecificationStep {
        let values = self.of_each_curve("D15B", "mm", |curve| curve.record.d15_mm);
        SpecificationStep {
            values,
            notes: vec![StepNote::Curves { curves: self.read.len() as u64 }],
            ..step(StepName::Plot)
        }
    }

    fn gravel(&self) -> SpecificationStep {
        let values = self.of_each_curve("finer than No. 4 (4.75 mm)", "%", |curve| {
            Some(curve.base.percent_finer_by_mass(GRAVEL_MM))
        });
        let gravel = |curve: &ReadCurve| StepNote::Gravel {
            curve: self.name(curve),
            why: curve.soil.why,
            flattest: curve.flattest.map(|gap| [gap.from_mm, gap.within]),
        };
        let notes = self.read.iter().map(gravel).collect();
        let source = format!("{REGRADING}. The check for a gap is this program's own");
        SpecificationStep { values, notes, source, ..step(StepName::FindGravel) }
    }

    fn regrading(&self) -> SpecificationStep {
        let any = self.read.iter().any(|curve| curve.record.regraded_at_mm.is_some());
        let mut values = self.of_each_curve("regraded on", "mm", |curve| curve.record.regraded_at_mm);
        values.retain(|_| any);
        values.extend(self.of_each_curve("D85B", "mm", |curve| curve.record.d85_mm));
        let notes = if any { Vec::new() } else { vec![StepNote::NotRegraded] };
        SpecificationStep {
            formula: "percent finer / percent finer than the size on which it is regraded".into(),
            values,
            notes,
            source: REGRADING.into(),
            ..step(StepName::Regrade)
        }
    }

    fn category(&self) -> SpecificationStep {
        let mut values =
            self.of_each_curve("fines A, finer than 0.075 mm", "%", |curve| curve.record.fines_percent);
        values.extend(self.of_each_curve("category", "", |curve| curve.record.category.map(f64::from)));
        SpecificationStep {
            formula: "1: A > 85 %; 2: A 40 to 85 %; 3: A 15 to 40 %; 4: A < 15 %".into(),
            values,
            source: source_of(DESIGN),
            ..step(StepName::Place)
        }
    }

    fn retention(&self) -> SpecificationStep {
        // Both rules, if another is stricter than the limit of design.
        let rules = |curve: &ReadCurve| {
            let other = curve.retention.iter().filter(|rule| rule.id != DESIGN).cloned();
            curve.design.iter().cloned().chain(other).collect::<Vec<AppliedRule>>()
        };
        let curve = self.strictest.map(|curve| (curve, rules(curve)));
        let joined = |text: &dyn Fn(&ReadCurve, &AppliedRule) -> String, between: &str| {
            let all = curve.iter().flat_map(|(curve, rules)| rules.iter().map(|rule| text(curve, rule)));
            all.collect::<Vec<String>>().join(between)
        };
        let set_by = |curve: &ReadCurve| StepNote::SetBy {
            rule: Some(curve.record.d15f_max_rule.clone()),
            curve: self.name(curve),
        };
        let set_by = self.strictest.filter(|_| self.d15f_max.is_some()).map(set_by);
        let needs = self.unknown.and_then(|curve| curve.unknown.clone());
        let not_known = needs.map(|needs| StepNote::LimitNotKnown { needs });
        let of_design = |limit| mm("maximum D15F by Sherard and Dunnigan's limit of design", Some(limit));
        let by_practice = mm("maximum D15F by practice", self.d15f_max);
        SpecificationStep {
            formula: joined(&|curve, rule| formula_of_base(rule, curve), "; "),
            values: self.limit_of_design().map(of_design).into_iter().chain([by_practice]).collect(),
            notes: set_by.into_iter().chain(not_known).collect(),
            source: joined(&|_, rule| rule.source.clone(), ". "),
            ..step(StepName::Retain)
        }
    }

    /// Limit of design, if another rule is stricter.
    fn limit_of_design(&self) -> Option<f64> {
        let curve = self.strictest.filter(|_| self.d15f_max.is_some())?;
        let design = curve.design.as_ref()?;
        let is_other = curve.retention.as_ref().is_some_and(|rule| rule.id != design.id);
        design.limit.filter(|limit| is_other && *limit > curve.greatest() * (1.0 + 1e-9))
    }

    fn drainage(&self) -> SpecificationStep {
        let rule = self.coarsest.and_then(|curve| curve.drainage.as_ref());
        let mut notes = Vec::new();
        if let Some(curve) = self.coarsest.and_then(|curve| self.name(curve)) {
            notes.push(StepNote::SetBy { rule: None, curve: Some(curve) });
        }
        match rule.map(|rule| &rule.notes) {
            Some(of_rule) if !of_rule.is_empty() => notes.push(StepNote::OfRule { notes: of_rule.clone() }),
            _ if rule.is_some_and(|rule| rule.limit_at_most) => notes.push(StepNote::DrainageAtMost),
            _ => {}
        }
        SpecificationStep {
            formula: rule.map_or_else(String::new, |rule| rule.formula.clone()),
            values: vec![mm("minimum D15F", self.d15f_min())],
            notes,
            source: rule.map_or_else(String::new, |rule| rule.source.clone()),
            ..step(StepName::Drain)
        }
    }

    fn d15f_min(&self) -> Option<f64> {
        self.coarsest.and_then(|curve| curve.record.d15f_min_mm)
    }

    fn width(&self) -> SpecificationStep {
        let least = self.d15f_min();
        let [narrow, wide] = [0, 1].map(|side| self.control.map(|control| control.d15[side]));
        let raised = narrow.zip(least).is_some_and(|(narrow, least)| narrow > least);
        let lowered = wide.zip(self.d15f_max).is_some_and(|(wide, most)| wide < most);
        let moved = if self.finer { "maximum is lowered" } else { "minimum is raised" };
        let ratio = self.d15f_max.zip(least).map(|(a, b)| a / b);
        let values = vec![
            named("maximum D15F / minimum D15F, as found", ratio, ""),
            mm("minimum D15F of the band", narrow),
            mm("maximum D15F of the band", wide),
        ];
        let notes = match (raised, lowered) {
            (true, _) => vec![StepNote::Raised],
            (_, true) => vec![StepNote::Lowered],
            _ => Vec::new(),
        };
        let formula =
            format!("maximum D15F / minimum D15F <= {WIDEST_BAND}; the {moved} where the ratio is larger");
        SpecificationStep {
            formula,
            values,
            notes,
            source: source_of("filter-band"),
            ..step(StepName::Narrow)
        }
    }

    fn uniformity(&self) -> SpecificationStep {
        let d60 = |side: usize| self.control.map(|control| control.d60[side]);
        let d10_max = self.control.map(|control| control.d15[1] / D15_OVER_D10);
        let values =
            vec![mm("maximum D10F", d10_max), mm("maximum D60F", d60(1)), mm("minimum D60F", d60(0))];
        let formula = format!(
            "maximum D10F = maximum D15F / {D15_OVER_D10}; maximum D60F = {MOST_CU} x maximum D10F; minimum \
             D60F = maximum D60F / {WIDEST_BAND}"
        );
        let source = format!("{}. {}", source_of("filter-uniformity"), own_factor());
        SpecificationStep { formula, values, source, ..step(StepName::KeepUniform) }
    }

    fn ends(&self) -> SpecificationStep {
        let formula = format!(
            "minimum D5F = maximum D5F / {WIDEST_BAND}, not less than {FINES_MM} mm; maximum D100F \
             {GREATEST_SIZE_MM} mm"
        );
        let values = vec![
            mm("minimum D5F allowed", Some(FINES_MM)),
            mm("maximum D100F allowed", Some(GREATEST_SIZE_MM)),
        ];
        SpecificationStep { formula, values, source: source_of("filter-fines"), ..step(StepName::LimitEnds) }
    }

    fn segregation(&self) -> SpecificationStep {
        let formula =
            format!("minimum D10F = the smaller of minimum D15F / {D15_OVER_D10} and D10F of the fine side");
        let values = vec![mm(ENTERED_BY, self.band.map(SizeBand::least_d10_mm)), mm("maximum D90F", None)];
        let source = format!("{SEGREGATION}. {}", own_factor());
        SpecificationStep { formula, values, source, ..step(StepName::KeepFromSegregating) }
    }

    fn sides(&self) -> SpecificationStep {
        let both = |size: &BandSize| {
            let one = |which: &str, value| mm(&format!("{which} D{}F", size.percent), Some(value));
            [one("minimum", size.min_mm), one("maximum", size.max_mm)]
        };
        let values = self.band.iter().flat_map(|band| &band.sizes).flat_map(both).collect();
        SpecificationStep { values, source: "a drawing of this program".into(), ..step(StepName::Draw) }
    }

    fn stability(&self) -> SpecificationStep {
        let sides: Vec<Side> = self.band.map(Side::both).into_iter().flatten().collect();
        let both = |side: &Side| {
            let value =
                |quantity: &str, value| named(&format!("{quantity} of the {} side", side.name), value, "");
            let kezdi = side.kezdi.map(|index| index.value);
            let shape = side.kenney_lau.map(|index| index.value);
            [value("greatest D'15/d'85", kezdi), value("least H/F", shape)]
        };
        let stability = |side: &Side| StepNote::Stability {
            side: side.name.into(),
            is_known: side.is_known(),
            not_kept: side.authorities(),
        };
        let formula = format!(
            "D'15/d'85 <= {MOST_KEZDI} by Kézdi, H/F >= {LEAST_SHAPE} by Kenney and Lau, as of a filter"
        );
        SpecificationStep {
            formula,
            values: sides.iter().flat_map(both).collect(),
            notes: sides.iter().map(stability).collect(),
            source: source_of("kezdi"),
            ..step(StepName::CheckStability)
        }
    }
}

/// Source on segregation to which the manual of the Corps refers.
const SEGREGATION: &str = "FEMA (2011), cited by U.S. Army Corps of Engineers, Filter Evaluation manual \
                           (RMC-CPD-2023-04), chapter Filter Gradation";

/// Source of regrading and its sizes.
const REGRADING: &str = "U.S. Army Corps of Engineers, Filter Evaluation manual (RMC-CPD-2023-04), chapter \
                         Base Gradation, after Sherard and Dunnigan (1989)";

/// Step without content; [`Findings::steps`] numbers it.
fn step(does: StepName) -> SpecificationStep {
    let (formula, source) = (String::new(), String::new());
    SpecificationStep { step: 0, does, formula, values: Vec::new(), notes: Vec::new(), source }
}

fn named(name: &str, value: Option<f64>, unit: &str) -> StepValue {
    StepValue { name: name.into(), value, unit: unit.into() }
}

fn mm(name: &str, value: Option<f64>) -> StepValue {
    named(name, value, "mm")
}

/// Source of the factor between D15F and D10F.
fn own_factor() -> String {
    format!("The factor {D15_OVER_D10} is worked out by this program")
}

/// Source of the numbers of a rule.
fn source_of(id: &str) -> String {
    RULES.iter().find(|rule| rule.id == id).map_or("", |rule| rule.source).into()
}

/// Arbitrary D15F (mm) of the filter for which the rules are read: their limits do not depend on it.
const ANY_D15F: f64 = 1.0;

pub(super) fn any_filter() -> Gradation {
    Gradation::linear_from_dx(15.0, ANY_D15F, 1.5).expect("sizes of a sand")
}

/// Percent by mass between D and 4 D below which a curve is noted as flat: twice the percent of a gap.
const FLAT_PERCENT: f64 = 2.0 * GAP_PERCENT;

/// Curve of the base with the results of the rules.
pub(super) struct ReadCurve {
    pub(super) record: SpecifiedCurve,
    /// Curve as sampled.
    base: Gradation,
    dispersive: bool,
    soil: BaseSoil,
    /// Flattest part, which may be a gap.
    flattest: Option<Gap>,
    design: Option<AppliedRule>,
    retention: Option<AppliedRule>,
    drainage: Option<AppliedRule>,
    /// Lower bound of the minimum D15F (mm) by the sieves; 0 if no sieve bounds it.
    drains_from: f64,
    /// Reasons for an unknown maximum D15F.
    pub(super) unknown: Option<Vec<RuleNote>>,
}

impl ReadCurve {
    pub(super) fn of((name, base): &NamedCurve, dispersive: bool) -> Self {
        let rules = apply(&RuleInputs { dispersive, ..RuleInputs::of_soils(base, &any_filter()) });
        let soil = BaseSoil::of(base, false);
        let open = OpenBase::of(base, false);
        let over_sieves = sieved_limit(DESIGN, base, &open, dispersive).and_then(|limit| limit.depends_on);
        // A limit that is only an upper bound may be the strictest.
        let unknown = open_retention(&rules).map(|rule| rule.needs.clone());
        let unknown = over_sieves.map(|note| vec![note]).or(unknown);
        let strictest = retention(&rules, ANY_D15F);
        let drainage = rules.iter().find(|rule| rule.id == PERMEABILITY);
        let drains = sieved_limit(PERMEABILITY, base, &open, dispersive);
        let between = drains.as_ref().filter(|limit| limit.depends_on.is_some());
        Self {
            base: base.clone(),
            dispersive,
            record: SpecifiedCurve {
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
            flattest: base.flattest(FINES_MM),
            design: rules.iter().find(|rule| rule.id == DESIGN && rule.applies).cloned(),
            retention: strictest.map(|(rule, _)| rule.clone()),
            drainage: drainage.cloned(),
            drains_from: between.map_or(0.0, |limit| limit.mildest),
            unknown,
            soil,
        }
    }

    fn notes(&self) -> Vec<Note> {
        let unstable = self.base.known_kenney_lau().filter(|index| index.value < 1.0);
        let unstable =
            unstable.map(|shape| Note::UnstableBase { index: shape.value, finer_percent: shape.percent });
        let broad = self.record.regraded_at_mm.and_then(|_| broad_base(&self.base));
        unstable.into_iter().chain(broad).chain(self.flat()).collect()
    }

    /// Gap of the base, or a flat part that may be one; parts that practice cuts off do not count.
    fn flat(&self) -> Option<Note> {
        let cut = self.record.regraded_at_mm.unwrap_or(f64::INFINITY);
        let flat = self.flattest.filter(|flat| flat.within < FLAT_PERCENT && flat.from_mm <= cut)?;
        let (from_mm, to_mm, within_percent) = (flat.from_mm, 4.0 * flat.from_mm, flat.within);
        Some(if within_percent < GAP_PERCENT {
            Note::GapOfBase { within_percent, from_mm, to_mm }
        } else {
            Note::FlatBase { from_mm, to_mm, within_percent }
        })
    }

    pub(super) fn greatest(&self) -> f64 {
        self.record.d15f_max_mm.unwrap_or(f64::INFINITY)
    }

    /// True if the minimum D15F is not known exactly and is at most the one given.
    pub(super) fn least_at_most(&self) -> bool {
        self.drainage.as_ref().is_some_and(|rule| rule.limit_at_most)
    }

    pub(super) fn certain_least(&self) -> f64 {
        if self.least_at_most() { self.drains_from } else { self.least() }
    }

    pub(super) fn least(&self) -> f64 {
        self.record.d15f_min_mm.unwrap_or(0.0)
    }
}

/// Notes on a base with these curves, named after the curve if there are several.
pub(super) fn notes(read: &[ReadCurve]) -> Vec<RowNote> {
    let row = |curve: &ReadCurve| (read.len() > 1).then(|| curve.record.curve.clone());
    let row_notes = |curve: &ReadCurve| {
        curve.notes().into_iter().map(|note| RowNote { row: row(curve), note }).collect::<Vec<_>>()
    };
    read.iter().flat_map(row_notes).collect()
}

/// Percent of fines above which a base is in category 1.
const MANY_FINES: f64 = 85.0;

/// Formula of a rule for the fines of a base, followed by the formula with the base's numbers; the whole
/// formula of the rule if fines or D85 are not known.
fn formula_of_base(rule: &AppliedRule, curve: &ReadCurve) -> String {
    let name = cited_rule(rule);
    let name = name.strip_prefix("the ").map_or(name.clone(), |rest| format!("The {rest}"));
    let sizes = curve.record.fines_percent.zip(curve.record.d85_mm);
    let known = sizes.and_then(|(fines, d85b)| Some((item(rule, fines, curve.dispersive)?, fines, d85b)));
    let Some((Item { condition, formula, is_at_most }, fines, d85b)) = known else {
        return format!("{name}: {}", rule.formula);
    };
    let category = curve.record.category.filter(|_| rule.id == DESIGN);
    let category = category.map_or_else(String::new, |category| format!("category {category}, "));
    let dispersive = if curve.dispersive && fines >= FEW_FINES { ", dispersive" } else { "" };
    // A to this many digits is enough to find the limit by hand.
    let fines = (100.0 * fines).round() / 100.0;
    let [fines, d85b] = [format!("- {fines})"), format!("x {}", significant(d85b))];
    let worked = formula.replace("- A)", &fines).replace("D85B", &d85b);
    let unit = if worked.contains("mm") { "" } else { " mm" };
    let worked = if worked == formula { String::new() } else { format!(" = {worked}{unit}") };
    let [most, why] = if is_at_most { ["at most ", NO_TEXT] } else { [""; 2] };
    format!("{name}, {category}{condition}{dispersive}: {most}{formula}{worked}{why}")
}

/// Suffix to a formula for other soils, which is an upper bound for a dispersive soil.
const NO_TEXT: &str = " (no text gives a limit for dispersive soils with such fines)";

/// Part of a rule's formula that applies to a base.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Item<'a> {
    condition: &'a str,
    formula: &'a str,
    /// True if the part is for other soils and only an upper bound for a dispersive one.
    is_at_most: bool,
}

/// Condition and limit in a rule's formula for a base with this percent of fines.
fn item(rule: &AppliedRule, fines: f64, dispersive: bool) -> Option<Item<'_>> {
    let from = match rule.id.as_str() {
        DESIGN => 40.0,
        TESTS_NO_EROSION => 35.0,
        _ => return None,
    };
    let (usual, of_dispersive) = rule.formula.split_once("; dispersive: ")?;
    // Each list begins with the highest fines; the list for dispersive soils ends where no text has a limit.
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

    /// Every item of both formulas must be found in their texts, whose wording may change.
    #[test]
    fn each_rule_has_the_item_of_the_fines_of_its_base() {
        let sand = Gradation::linear_from_dx(85.0, 0.3, 3.0).unwrap();
        let rules = PairRules::of(&sand, &Gradation::linear_from_dx(15.0, 1.0, 1.5).unwrap()).rules;
        let between = "(40 - A)/25 (4 D85B - 0.7) + 0.7 mm";
        let fell = "1.6 ((35 - A)/20 (4 D85B - 0.7) + 0.7 mm)";
        let [nine, least] = ["9 D85B, not less than 0.2 mm", "6.4 D85B, not less than 0.2 mm"];
        let below_40 = ("A 15 to 40 %", between);
        let below_35 = ("A 15 to 35 %", fell);
        for (id, fines, usual, of_dispersive) in [
            (DESIGN, 90.0, ("A > 85 %", nine), ("A > 85 %", least)),
            (DESIGN, 40.0, ("A 40 to 85 %", "0.7 mm"), ("40 to 85 %", "0.5 mm")),
            (DESIGN, 39.0, below_40, below_40),
            (DESIGN, 14.0, ("A < 15 %", "4 D85B"), ("A < 15 %", "4 D85B")),
            (TESTS_NO_EROSION, 90.0, ("A > 85 %", "9 D85B"), ("A > 85 %", "6.4 D85B")),
            (TESTS_NO_EROSION, 35.0, ("A 35 to 85 %", "0.7 mm"), ("35 to 85 %", "0.5 mm")),
            (TESTS_NO_EROSION, 34.0, below_35, below_35),
            (TESTS_NO_EROSION, 14.0, ("A < 15 %", "7 D85B"), ("A < 15 %", "7 D85B")),
        ] {
            let rule = rules.iter().find(|rule| rule.id == id).unwrap();
            for (dispersive, (condition, formula)) in [(false, usual), (true, of_dispersive)] {
                let is_at_most = dispersive && [39.0, 34.0].contains(&fines);
                let wanted = Item { condition, formula, is_at_most };
                assert_eq!(item(rule, fines, dispersive), Some(wanted), "{id} {fines} {dispersive}");
            }
        }
    }
}
