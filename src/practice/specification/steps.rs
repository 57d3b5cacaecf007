//! The steps of a specification, with their numbers, formulas and sources.

use super::curve::ReadCurve;
use super::formula;
use super::sides::{LEAST_SHAPE, MOST_KEZDI, Side};
use crate::AppliedRule;
use crate::design::size_band::D15_OVER_D10;
use crate::design::specification::{
    BandSize, ENTERED_BY, SizeBand, SpecificationStep, StepName, StepNote, StepValue,
};
use crate::rules::{DESIGN, GREATEST_SIZE_MM, MOST_CU, RULES, WIDEST_BAND};
use voidwalk_core::gradation::FINES_MM;

/// Control points of a band: D15 and D60 (mm) of its fine and of its coarse side.
pub(super) struct Control {
    pub d15: [f64; 2],
    pub d60: [f64; 2],
}

/// Facts that the steps state.
pub(super) struct Found<'a> {
    pub read: &'a [ReadCurve],
    /// The curve that allows the minimum D15F.
    pub strictest: Option<&'a ReadCurve>,
    pub unknown: Option<&'a ReadCurve>,
    /// The curve that asks for the maximum D15F.
    pub coarsest: Option<&'a ReadCurve>,
    pub d15f_max: Option<f64>,
    pub control: Option<Control>,
    /// True if the band lies at the finer end of the allowed sizes.
    pub finer: bool,
}

impl Found<'_> {
    /// Every step, in order.
    pub fn steps(&self, band: Option<&SizeBand>) -> Vec<SpecificationStep> {
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
            self.segregation(band),
            self.sides(band),
            self.stability(band),
        ];
        let number =
            |(index, step): (usize, SpecificationStep)| SpecificationStep { step: index as u64 + 1, ..step };
        steps.into_iter().enumerate().map(number).collect()
    }

    /// A number of every curve; with several curves, each number names its own.
    fn of_each_curve(
        &self,
        name: &str,
        unit: &str,
        value: impl Fn(&ReadCurve) -> Option<f64>,
    ) -> Vec<StepValue> {
        let value_of = |curve: &ReadCurve| {
            let whose = if self.read.len() > 1 { format!(" of {}", curve.of.curve) } else { String::new() };
            named(&format!("{name}{whose}"), value(curve), unit)
        };
        self.read.iter().map(value_of).collect()
    }

    /// The name of a curve, if there are several.
    fn name(&self, curve: &ReadCurve) -> Option<String> {
        (self.read.len() > 1).then(|| curve.of.curve.clone())
    }

    fn gradation(&self) -> SpecificationStep {
        SpecificationStep {
            values: self.of_each_curve("D15B", "mm", |curve| curve.of.d15_mm),
            notes: vec![StepNote::Curves { curves: self.read.len() as u64 }],
            ..step(StepName::Plot)
        }
    }

    fn gravel(&self) -> SpecificationStep {
        let gravel = |curve: &ReadCurve| StepNote::Gravel {
            curve: self.name(curve),
            why: curve.soil.why,
            flattest: curve.flattest.map(|gap| [gap.from_mm, gap.within]),
        };
        SpecificationStep {
            values: self.of_each_curve("finer than No. 4 (4.75 mm)", "%", |curve| Some(curve.percent_no_4)),
            notes: self.read.iter().map(gravel).collect(),
            source: format!("{REGRADING}. The check for a gap is this program's own"),
            ..step(StepName::FindGravel)
        }
    }

    fn regrading(&self) -> SpecificationStep {
        let any = self.read.iter().any(|curve| curve.of.regraded_at_mm.is_some());
        let mut values = Vec::new();
        if any {
            values.extend(self.of_each_curve("regraded on", "mm", |curve| curve.of.regraded_at_mm));
        }
        values.extend(self.of_each_curve("D85B", "mm", |curve| curve.of.d85_mm));
        SpecificationStep {
            formula: "percent finer / percent finer than the size on which it is regraded".into(),
            values,
            notes: if any { Vec::new() } else { vec![StepNote::NotRegraded] },
            source: REGRADING.into(),
            ..step(StepName::Regrade)
        }
    }

    fn category(&self) -> SpecificationStep {
        let mut values =
            self.of_each_curve("fines A, finer than 0.075 mm", "%", |curve| curve.of.fines_percent);
        values.extend(self.of_each_curve("category", "", |curve| curve.of.category.map(f64::from)));
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
        let mut notes = Vec::new();
        if let (Some(curve), Some(_)) = (self.strictest, self.d15f_max) {
            notes.push(StepNote::SetBy {
                rule: Some(curve.of.d15f_max_rule.clone()),
                curve: self.name(curve),
            });
        }
        let needs = self.unknown.and_then(|curve| curve.unknown.clone());
        notes.extend(needs.map(|needs| StepNote::LimitNotKnown { needs }));
        let mut values = vec![named("maximum D15F by practice", self.d15f_max, "mm")];
        if let Some(limit) = self.limit_of_design() {
            values.insert(
                0,
                named("maximum D15F by Sherard and Dunnigan's limit of design", Some(limit), "mm"),
            );
        }
        SpecificationStep {
            formula: joined(&|curve, rule| formula::of_base(rule, curve), "; "),
            values,
            notes,
            source: joined(&|_, rule| rule.source.clone(), ". "),
            ..step(StepName::Retain)
        }
    }

    /// The limit of design, if another rule is stricter.
    fn limit_of_design(&self) -> Option<f64> {
        let curve = self.strictest.filter(|_| self.d15f_max.is_some())?;
        let design = curve.design.as_ref()?;
        let is_other = curve.retention.as_ref().is_some_and(|rule| rule.id != design.id);
        design.limit.filter(|limit| is_other && *limit > curve.greatest() * (1.0 + 1e-9))
    }

    fn drainage(&self) -> SpecificationStep {
        let rule = self.coarsest.and_then(|curve| curve.drainage.as_ref());
        let mut notes = Vec::new();
        if let Some(curve) = self.coarsest.filter(|_| self.read.len() > 1) {
            notes.push(StepNote::SetBy { rule: None, curve: self.name(curve) });
        }
        let open = rule.filter(|rule| rule.limit_at_most && rule.notes.is_empty());
        notes.extend(open.map(|_| StepNote::DrainageAtMost));
        let of_rule = rule.map(|rule| rule.notes.clone()).filter(|notes| !notes.is_empty());
        notes.extend(of_rule.map(|notes| StepNote::OfRule { notes }));
        SpecificationStep {
            formula: rule.map_or_else(String::new, |rule| rule.formula.clone()),
            values: vec![named("minimum D15F", self.coarsest.and_then(|curve| curve.of.d15f_min_mm), "mm")],
            notes,
            source: rule.map_or_else(String::new, |rule| rule.source.clone()),
            ..step(StepName::Drain)
        }
    }

    fn width(&self) -> SpecificationStep {
        let least = self.coarsest.and_then(|curve| curve.of.d15f_min_mm);
        let raised = self.control.as_ref().zip(least).is_some_and(|(control, least)| control.d15[0] > least);
        let lowered =
            self.control.as_ref().zip(self.d15f_max).is_some_and(|(control, most)| control.d15[1] < most);
        let narrow = self.control.as_ref().map(|control| control.d15[0]);
        let moved = if self.finer { "maximum is lowered" } else { "minimum is raised" };
        SpecificationStep {
            formula: format!(
                "maximum D15F / minimum D15F <= {WIDEST_BAND}; the {moved} where the ratio is larger"
            ),
            values: vec![
                named(
                    "maximum D15F / minimum D15F, as found",
                    self.d15f_max.zip(least).map(|(a, b)| a / b),
                    "",
                ),
                named("minimum D15F of the band", narrow, "mm"),
                named("maximum D15F of the band", self.control.as_ref().map(|control| control.d15[1]), "mm"),
            ],
            notes: match (raised, lowered) {
                (true, _) => vec![StepNote::Raised],
                (_, true) => vec![StepNote::Lowered],
                _ => Vec::new(),
            },
            source: source_of("filter-band"),
            ..step(StepName::Narrow)
        }
    }

    fn uniformity(&self) -> SpecificationStep {
        let d60 = |side: usize| self.control.as_ref().map(|control| control.d60[side]);
        SpecificationStep {
            formula: format!(
                "maximum D10F = maximum D15F / {D15_OVER_D10}; maximum D60F = {MOST_CU} x maximum D10F; \
                 minimum D60F = maximum D60F / {WIDEST_BAND}"
            ),
            values: vec![
                named(
                    "maximum D10F",
                    self.control.as_ref().map(|control| control.d15[1] / D15_OVER_D10),
                    "mm",
                ),
                named("maximum D60F", d60(1), "mm"),
                named("minimum D60F", d60(0), "mm"),
            ],
            source: with_own_factor(&source_of("filter-uniformity")),
            ..step(StepName::KeepUniform)
        }
    }

    fn ends(&self) -> SpecificationStep {
        SpecificationStep {
            formula: format!(
                "minimum D5F = maximum D5F / {WIDEST_BAND}, not less than {FINES_MM} mm; maximum D100F \
                 {GREATEST_SIZE_MM} mm"
            ),
            values: vec![
                named("minimum D5F allowed", Some(FINES_MM), "mm"),
                named("maximum D100F allowed", Some(GREATEST_SIZE_MM), "mm"),
            ],
            source: source_of("filter-fines"),
            ..step(StepName::LimitEnds)
        }
    }

    fn segregation(&self, band: Option<&SizeBand>) -> SpecificationStep {
        let d10 = band.map(SizeBand::least_d10_mm);
        SpecificationStep {
            formula: format!(
                "minimum D10F = the smaller of minimum D15F / {D15_OVER_D10} and D10F of the fine side"
            ),
            values: vec![named(ENTERED_BY, d10, "mm"), named("maximum D90F", None, "mm")],
            source: with_own_factor(SEGREGATION),
            ..step(StepName::KeepFromSegregating)
        }
    }

    fn sides(&self, band: Option<&SizeBand>) -> SpecificationStep {
        let sizes = band.map(|band| &band.sizes[..]).unwrap_or_default();
        let both = |size: &BandSize| {
            let one = |which: &str, value| named(&format!("{which} D{}F", size.percent), Some(value), "mm");
            [one("minimum", size.min_mm), one("maximum", size.max_mm)]
        };
        SpecificationStep {
            values: sizes.iter().flat_map(both).collect(),
            source: "a drawing of this program".into(),
            ..step(StepName::Draw)
        }
    }

    fn stability(&self, band: Option<&SizeBand>) -> SpecificationStep {
        let sides: Vec<Side> = band.map(Side::both).into_iter().flatten().collect();
        let both = |side: &Side| {
            let value =
                |quantity: &str, value| named(&format!("{quantity} of the {} side", side.name), value, "");
            let [kezdi, shape] =
                [side.kezdi.map(|index| index.value), side.kenney_lau.map(|index| index.value)];
            [value("greatest D'15/d'85", kezdi), value("least H/F", shape)]
        };
        let stability = |side: &Side| StepNote::Stability {
            side: side.name.into(),
            is_known: side.is_known(),
            not_kept: side.authorities(),
        };
        SpecificationStep {
            formula: format!(
                "D'15/d'85 <= {MOST_KEZDI} by Kézdi, H/F >= {LEAST_SHAPE} by Kenney and Lau, as of a filter"
            ),
            values: sides.iter().flat_map(both).collect(),
            notes: sides.iter().map(stability).collect(),
            source: source_of("kezdi"),
            ..step(StepName::CheckStability)
        }
    }
}

/// Source to which the manual of the Corps refers for segregation.
const SEGREGATION: &str = "FEMA (2011), cited by U.S. Army Corps of Engineers, Filter Evaluation manual \
                           (RMC-CPD-2023-04), chapter Filter Gradation";

/// Source of regrading and its sizes.
const REGRADING: &str = "U.S. Army Corps of Engineers, Filter Evaluation manual (RMC-CPD-2023-04), chapter \
                         Base Gradation, after Sherard and Dunnigan (1989)";

fn step(does: StepName) -> SpecificationStep {
    SpecificationStep {
        step: 0,
        does,
        formula: String::new(),
        values: Vec::new(),
        notes: Vec::new(),
        source: String::new(),
    }
}

fn named(name: &str, value: Option<f64>, unit: &str) -> StepValue {
    StepValue { name: name.into(), value, unit: unit.into() }
}

/// Source of a rule, with a remark that the factor between D15F and D10F is from elsewhere.
fn with_own_factor(source: &str) -> String {
    format!("{source}. The factor {D15_OVER_D10} is worked out by this program")
}

/// Source of the numbers of a rule.
fn source_of(id: &str) -> String {
    RULES.iter().find(|rule| rule.id == id).map_or_else(String::new, |rule| rule.source.into())
}
