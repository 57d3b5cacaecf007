//! The steps of a specification, with their numbers, words and sources.

use super::curve::ReadCurve;
use super::formula;
use super::sides::{LEAST_SHAPE, MOST_KEZDI, Side};
use crate::gradation::{FINES_MM, GAP_PERCENT, Gap};
use crate::outcome::design::products::LEAST_CU;
use crate::outcome::design::specification::{BandSize, ENTERED_BY, SizeBand, SpecificationStep, StepValue};
use crate::outcome::numbers::significant;
use crate::outcome::record::AppliedRule;
use crate::outcome::rules::{DESIGN, GREATEST_SIZE_MM, MOST_CU, MOST_FINES_PERCENT, RULES, WIDEST_BAND};
use crate::verdict::words::capital;

/// D15/D10 of a side that is straight on the form and has a Cu of 6: 6^(5/50) = 1.196.
pub(super) const D15_OVER_D10: f64 = 1.2;

/// The control points of a band: D15 and D60 (mm) of its fine and of its coarse side.
pub(super) struct Control {
    pub d15: [f64; 2],
    pub d60: [f64; 2],
}

/// What the steps say.
pub(super) struct Found<'a> {
    /// Maximum D15F (mm) that the walk holds.
    pub walked_mm: Option<f64>,
    pub read: &'a [ReadCurve],
    /// The curve that allows the minimum D15F.
    pub strictest: Option<&'a ReadCurve>,
    pub unknown: Option<&'a ReadCurve>,
    /// The curve that asks for the maximum D15F.
    pub coarsest: Option<&'a ReadCurve>,
    pub by_practice: Option<f64>,
    pub d15f_max: Option<f64>,
    pub control: Option<Control>,
    /// Whether the band lies at the finer end of what is allowed.
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

    /// A number of every curve, which of several says whose it is.
    fn each(&self, name: &str, unit: &str, value: impl Fn(&ReadCurve) -> Option<f64>) -> Vec<StepValue> {
        let of = |curve: &ReadCurve| {
            let whose = if self.read.len() > 1 { format!(" of {}", curve.of.curve) } else { String::new() };
            named(&format!("{name}{whose}"), value(curve), unit)
        };
        self.read.iter().map(of).collect()
    }

    fn gradation(&self) -> SpecificationStep {
        let curves = self.read.len();
        SpecificationStep {
            values: self.each("D15B", "mm", |curve| curve.of.d15_mm),
            note: match curves {
                1 => "One curve.".into(),
                _ => format!(
                    "{curves} curves. Each is to be retained and drained, and the strictest limit counts."
                ),
            },
            ..step("Plot the gradation of the base")
        }
    }

    fn gravel(&self) -> SpecificationStep {
        let why = |curve: &ReadCurve| {
            let gap = gap_in_words(curve.flattest);
            match self.read.len() {
                1 => format!("{} {gap}", sentence(&curve.soil.why.words())),
                _ => format!("{}: {}. {gap}", curve.of.curve, curve.soil.why.words()),
            }
        };
        let said: Vec<String> = self.read.iter().map(why).collect();
        SpecificationStep {
            values: self.each("finer than No. 4 (4.75 mm)", "%", |curve| Some(curve.percent_no_4)),
            note: said.join(" "),
            source: format!("{REGRADING}. The check for a gap is this program's own"),
            ..step("Find out whether the base has gravel or a gap")
        }
    }

    fn regrading(&self) -> SpecificationStep {
        let any = self.read.iter().any(|curve| curve.of.regraded_at_mm.is_some());
        let mut values = Vec::new();
        if any {
            values.extend(self.each("regraded on", "mm", |curve| curve.of.regraded_at_mm));
        }
        values.extend(self.each("D85B", "mm", |curve| curve.of.d85_mm));
        SpecificationStep {
            formula: "percent finer / percent finer than the size on which it is regraded".into(),
            values,
            note: if any { String::new() } else { "Not regraded.".into() },
            source: REGRADING.into(),
            ..step("Regrade the base")
        }
    }

    fn category(&self) -> SpecificationStep {
        let mut values = self.each("fines A, finer than 0.075 mm", "%", |curve| curve.of.fines_percent);
        values.extend(self.each("category", "", |curve| curve.of.category.map(f64::from)));
        SpecificationStep {
            formula: "1: A > 85 %; 2: A 40 to 85 %; 3: A 15 to 40 %; 4: A < 15 %".into(),
            values,
            source: source_of(DESIGN),
            ..step("Place the base in a category by its fines after regrading")
        }
    }

    fn retention(&self) -> SpecificationStep {
        let what = "Find the maximum D15F that retains the base";
        // Both rules, where another is stricter than the limit of design.
        let rules = |curve: &ReadCurve| {
            let other = curve.retention.iter().filter(|rule| rule.id != DESIGN).cloned();
            curve.design.iter().cloned().chain(other).collect::<Vec<AppliedRule>>()
        };
        let curve = self.strictest.map(|curve| (curve, rules(curve)));
        let each = |said: &dyn Fn(&ReadCurve, &AppliedRule) -> String, between: &str| {
            let all = curve.iter().flat_map(|(curve, rules)| rules.iter().map(|rule| said(curve, rule)));
            all.collect::<Vec<String>>().join(between)
        };
        let mut notes: Vec<String> = Vec::new();
        if let (Some(curve), Some(_)) = (self.strictest, self.by_practice) {
            let whose = if self.read.len() > 1 { format!(", for {}", curve.of.curve) } else { String::new() };
            notes.push(format!("Set by {}{whose}.", curve.of.d15f_max_rule));
        }
        if let Some(why) = self.unknown.and_then(|curve| curve.unknown.as_ref()) {
            notes.push(sentence(why));
        }
        let mut values = vec![named("maximum D15F by practice", self.by_practice, "mm")];
        if let Some(limit) = self.limit_of_design() {
            values.insert(
                0,
                named("maximum D15F by Sherard and Dunnigan's limit of design", Some(limit), "mm"),
            );
        }
        if let Some(walked) = self.walked_mm {
            values.push(named("maximum D15F that the walk holds", Some(walked), "mm"));
            values.push(named("maximum D15F", self.d15f_max, "mm"));
            notes.push("The smaller of practice and walk counts.".into());
        }
        SpecificationStep {
            formula: each(&|curve, rule| formula::of_base(rule, curve), "; "),
            values,
            note: notes.join(" "),
            source: each(&|_, rule| rule.source.clone(), ". "),
            ..step(what)
        }
    }

    /// The limit of design, where another rule is stricter.
    fn limit_of_design(&self) -> Option<f64> {
        let curve = self.strictest.filter(|_| self.by_practice.is_some())?;
        let design = curve.design.as_ref()?;
        let is_other = curve.retention.as_ref().is_some_and(|rule| rule.id != design.id);
        design.limit.filter(|limit| is_other && *limit > curve.greatest() * (1.0 + 1e-9))
    }

    fn drainage(&self) -> SpecificationStep {
        let rule = self.coarsest.and_then(|curve| curve.drainage.as_ref());
        let mut notes = Vec::new();
        if let Some(curve) = self.coarsest.filter(|_| self.read.len() > 1) {
            notes.push(format!("Set by {}.", curve.of.curve));
        }
        let open = rule.filter(|rule| rule.limit_at_most && rule.note.is_empty());
        notes.extend(open.map(|_| {
            "D15B is finer than the finest sieve. The minimum D15F is not known, and is at most this.".into()
        }));
        notes.extend(
            rule.map(|rule| rule.note.to_string()).filter(|note| !note.is_empty()).map(|n| sentence(&n)),
        );
        SpecificationStep {
            formula: rule.map_or_else(String::new, |rule| rule.formula.clone()),
            values: vec![named("minimum D15F", self.coarsest.and_then(|curve| curve.of.d15f_min_mm), "mm")],
            note: notes.join(" "),
            source: rule.map_or_else(String::new, |rule| rule.source.clone()),
            ..step("Find the minimum D15F that drains the base")
        }
    }

    fn width(&self) -> SpecificationStep {
        let least = self.coarsest.and_then(|curve| curve.of.d15f_min_mm);
        let raised = self.control.as_ref().zip(least).is_some_and(|(of, least)| of.d15[0] > least);
        let lowered = self.control.as_ref().zip(self.d15f_max).is_some_and(|(of, most)| of.d15[1] < most);
        let narrow = self.control.as_ref().map(|of| of.d15[0]);
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
                named("maximum D15F of the band", self.control.as_ref().map(|of| of.d15[1]), "mm"),
            ],
            note: match (raised, lowered) {
                (true, _) => "The minimum D15F is raised.".into(),
                (_, true) => "The maximum D15F is lowered.".into(),
                _ => String::new(),
            },
            source: source_of("filter-band"),
            ..step("Keep the band narrow at 15 % finer")
        }
    }

    fn uniformity(&self) -> SpecificationStep {
        let d60 = |side: usize| self.control.as_ref().map(|of| of.d60[side]);
        SpecificationStep {
            formula: format!(
                "maximum D10F = maximum D15F / {D15_OVER_D10}; maximum D60F = {MOST_CU} x maximum D10F; \
                 minimum D60F = maximum D60F / {WIDEST_BAND}"
            ),
            values: vec![
                named("maximum D10F", self.control.as_ref().map(|of| of.d15[1] / D15_OVER_D10), "mm"),
                named("maximum D60F", d60(1), "mm"),
                named("minimum D60F", d60(0), "mm"),
            ],
            note: format!(
                "Cu of each delivery lies between {LEAST_CU} and {MOST_CU}. {D15_OVER_D10} is D15/D10 of a \
                 side that is straight on the form and has a Cu of {MOST_CU}."
            ),
            source: with_own_factor(&source_of("filter-uniformity")),
            ..step("Keep both sides uniform, without gaps")
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
            note: format!(
                "At most {MOST_FINES_PERCENT} % is finer than {FINES_MM} mm, and than the minimum D5F. These \
                 fines must not be plastic."
            ),
            source: source_of("filter-fines"),
            ..step("Limit the fines and the greatest size")
        }
    }

    fn segregation(&self, band: Option<&SizeBand>) -> SpecificationStep {
        let d10 = band.map(least_d10);
        SpecificationStep {
            formula: format!(
                "minimum D10F = the smaller of minimum D15F / {D15_OVER_D10} and D10F of the fine side"
            ),
            values: vec![named(ENTERED_BY, d10, "mm"), named("maximum D90F", None, "mm")],
            note:
                "Still to be set: no text with its numbers could be read. The maximum D90F follows from this \
                   minimum D10F by a table of FEMA and NRCS. Take it from there."
                    .into(),
            source: with_own_factor(SEGREGATION),
            ..step("Keep the filter from segregating")
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
            note: "The control points are joined by straight lines on the form. Above 60 % finer neither \
                 side is \
                   drawn, as no text was read for it. Below its D5 the fine side runs level to the No. 200 \
                   sieve."
                .into(),
            source: "a drawing of this program".into(),
            ..step("Draw both sides of the band")
        }
    }

    fn stability(&self, band: Option<&SizeBand>) -> SpecificationStep {
        let sides: Vec<Side> = band.map(Side::both).into_iter().flatten().collect();
        let both = |side: &Side| {
            let value = |which: &str, value| named(&format!("{which} of the {} side", side.name), value, "");
            let [kezdi, shape] = [side.kezdi.map(|of| of.value), side.kenney_lau.map(|of| of.value)];
            [value("greatest D'15/d'85", kezdi), value("least H/F", shape)]
        };
        let of = |side: &Side| match side.broken() {
            broken if !broken.is_empty() => {
                format!("The {} side is not stable {}.", side.name, broken.join(" and "))
            }
            _ if side.is_known() => format!("The {} side keeps both.", side.name),
            _ => format!("The {} side is nearly of one size.", side.name),
        };
        let below = band.map(|_| {
            "The fine side is judged from its D5 up, and both as if they went on straight above 60 % finer."
                .to_owned()
        });
        SpecificationStep {
            formula: format!(
                "D'15/d'85 <= {MOST_KEZDI} by Kézdi, H/F >= {LEAST_SHAPE} by Kenney and Lau, as of a filter"
            ),
            values: sides.iter().flat_map(both).collect(),
            note: sides.iter().map(of).chain(below).collect::<Vec<_>>().join(" "),
            source: source_of("kezdi"),
            ..step("Check both sides for internal stability")
        }
    }
}

/// The minimum D10F (mm) of a band, by which its maximum D90F is set.
pub(super) fn least_d10(band: &SizeBand) -> f64 {
    (band.d15_mm()[0] / D15_OVER_D10).min(band.least_size(10.0))
}

/// Where the manual of the Corps sends for segregation.
const SEGREGATION: &str = "FEMA (2011), cited by U.S. Army Corps of Engineers, Filter Evaluation manual \
                           (RMC-CPD-2023-04), chapter Filter Gradation";

/// Where regrading and its sizes were read.
const REGRADING: &str = "U.S. Army Corps of Engineers, Filter Evaluation manual (RMC-CPD-2023-04), chapter \
                         Base Gradation, after Sherard and Dunnigan (1989)";

fn step(does: &str) -> SpecificationStep {
    SpecificationStep {
        step: 0,
        does: does.into(),
        formula: String::new(),
        values: Vec::new(),
        note: String::new(),
        source: String::new(),
    }
}

fn named(name: &str, value: Option<f64>, unit: &str) -> StepValue {
    StepValue { name: name.into(), value, unit: unit.into() }
}

/// Whether a base is gap-graded, with the sizes between which it has least: by a number of this program, as
/// the manual leaves it to the eye.
fn gap_in_words(flattest: Option<Gap>) -> String {
    const EYE: &str = "The manual gives no number and leaves it to visual examination and judgment: look at \
                       the curve.";
    let Some(of) = flattest else { return format!("No gap by this program's own check. {EYE}") };
    let [from, to] = [of.from_mm, 4.0 * of.from_mm].map(significant);
    let found = if of.within < GAP_PERCENT { "A gap" } else { "No gap" };
    format!(
        "{found} by this program's own check: the least mass within a factor of 4 in size is {} %, from \
         {from} to {to} mm, and below {GAP_PERCENT} % counts as a gap. {EYE}",
        significant(of.within)
    )
}

/// A part of a sentence as one of its own.
fn sentence(words: &str) -> String {
    format!("{}.", capital(words.trim_end_matches('.')))
}

/// The source of a rule, and that the factor between D15F and D10F is from elsewhere.
fn with_own_factor(source: &str) -> String {
    format!("{source}. The factor {D15_OVER_D10} is worked out by this program")
}

/// Where the numbers of a rule were read.
fn source_of(id: &str) -> String {
    RULES.iter().find(|rule| rule.id == id).map_or_else(String::new, |rule| rule.source.into())
}
