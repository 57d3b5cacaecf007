//! The answer of a design: how coarse the filter may be, which of walk and practice set it, and why.
//!
//! The limit of practice is the strictest rule of retention that was made for the base: as a rule Sherard and
//! Dunnigan's limit of design, and Foster and Fell's boundary of no erosion where that is lower, as for 35 to
//! 40 % fines. No specification allows a filter with which tests saw erosion.

use super::entry::EVIDENCE_UNSAFE;
use super::rule_words::cited_rule;
use super::words::capital;
use crate::outcome::design::band::{SetBy, limits, open_retention, retention};
use crate::outcome::design::{Design, DesignAnswer, DesignRow, Specification};
use crate::outcome::digits::percent;
use crate::outcome::numbers::{rounded_down, rounded_up};
use crate::outcome::record::{AppliedRule, RuleRole};
use crate::outcome::rules::DESIGN;

/// The finest base that practice allows with a filter, for the inverse.
#[derive(Clone, Debug, PartialEq)]
pub struct FinestBase {
    /// D15F/D85B up to which every rule of retention is known to be kept; `None` where that is so of no base
    /// that was searched.
    pub ratio: Option<f64>,
    /// The rule that a finer base breaks, or may break.
    pub rule: AppliedRule,
    /// Whether it may break it: of the limit only the most is known.
    pub is_open: bool,
}

/// A limit of D15F/D85B, and the rule that sets it.
#[derive(Clone, Copy)]
struct Limit<'a> {
    ratio: f64,
    rule: &'a AppliedRule,
    /// Whether it is only not known if practice allows more.
    may_be_more: bool,
}

/// Which of the cases holds, each with its numbers; ratios are D15F/D85B.
enum Case<'a> {
    /// Practice allows no base that was searched.
    Forbidden(&'a AppliedRule),
    /// Of the limit of practice only the most is known, for want of this; the walk may hold a ratio.
    Open(Limit<'a>, &'a AppliedRule, Option<f64>),
    /// The same of every base that was searched, for the inverse.
    OpenBase(&'a AppliedRule, Option<f64>),
    /// Neither walk nor practice knows a ratio.
    Unknown,
    /// The walk has no answer: the finest tail of the base, this share of its mass, may be anything.
    TailOpen(Limit<'a>, f64),
    /// Practice allows less than the least ratio that was walked, at which networks erode.
    BelowSearch(Limit<'a>, f64),
    /// No ratio is known that nearly all networks hold, and practice alone allows one.
    NotHeld(Limit<'a>),
    /// Practice allows no more than nearly all networks hold.
    Practice(Limit<'a>),
    /// Nearly all networks of a row hold less than practice allows.
    Walk(&'a DesignRow, f64, Limit<'a>),
    /// Nearly all networks of a row hold this, and no limit of practice is known.
    ModelAlone(&'a DesignRow, f64),
}

/// The answer of a design whose boundaries and rules are known; `finest` is what practice says for the
/// inverse, where that was searched.
pub fn design_answer(design: &Design, finest: Option<&FinestBase>) -> DesignAnswer {
    let sizes = Sizes::of(design);
    let case = Case::of(design, &sizes, finest);
    let ratio = case.ratio();
    let size = |ratio: f64| sizes.mm(ratio);
    DesignAnswer {
        d15f_max_mm: ratio.filter(|_| !design.inverse).and_then(size),
        d85b_min_mm: ratio.filter(|_| design.inverse).and_then(size),
        d15f_over_d85b: ratio,
        set_by: if case.rule().is_some() { SetBy::Practice } else { SetBy::Walk },
        rule: case.rule().map(|rule| rule.id.clone()),
        said: case.words(design, &sizes),
    }
}

impl DesignAnswer {
    /// The same, with what the specification says of a base that may be dispersive.
    pub fn if_dispersive_too(mut self, specification: Option<&Specification>) -> Self {
        if let Some(said) = specification.and_then(Specification::if_dispersive_in_words) {
            self.said += &format!(". {said}");
        }
        self
    }
}

impl Design {
    /// The answer, of files of earlier versions too.
    pub fn answer(&self) -> DesignAnswer {
        let said = || design_answer(self, None).if_dispersive_too(self.specification.as_ref());
        self.answer.clone().unwrap_or_else(said)
    }

    /// How far the answer can be relied on, in a sentence, with the weightiest reason.
    pub fn confidence_said(&self) -> String {
        let label = capital(self.confidence.words());
        match self.reasons.first() {
            Some(reason) => format!("{label}: {}.", reason.trim_end_matches('.')),
            None => format!("{label}."),
        }
    }

    /// Said of a size that the walk alone holds, where it errs on the unsafe side for soils of this kind.
    fn unsafe_alone(&self) -> &'static str {
        if self.walk_errs_unsafely() { ", and for such soils it errs on the unsafe side" } else { "" }
    }

    /// Whether the walk errs on the unsafe side for soils of this kind.
    fn walk_errs_unsafely(&self) -> bool {
        self.findings.iter().any(|of| of.finding.id == EVIDENCE_UNSAFE)
    }

    /// What the walk is worth beside a limit of practice that sets the answer, in a sentence.
    pub fn walk_beside_practice(&self) -> &'static str {
        match self.walk_errs_unsafely() {
            true => "The walk is no check of it: for such soils it errs on the unsafe side.",
            false => "The walk sets no tighter limit, and is no check of it.",
        }
    }

    fn strictest(&self, sizes: &Sizes) -> Option<(&AppliedRule, f64)> {
        retention(&self.rules, self.rules_at * sizes.d85)
    }
}

impl<'a> Case<'a> {
    fn of(design: &'a Design, sizes: &Sizes, finest: Option<&'a FinestBase>) -> Self {
        // Files of an earlier version know only whether the base that the walk holds breaks a rule.
        let broken = design.rules.iter().find(|rule| rule.role == RuleRole::Retention && rule.is_broken());
        let known = broken.filter(|_| design.inverse && sizes.has_unit && finest.is_none());
        let none = finest.filter(|of| of.ratio.is_none());
        if let Some(of) = none.filter(|of| of.is_open) {
            return Self::OpenBase(&of.rule, design.least_held().map(|(_, held)| held));
        }
        if let Some(rule) = known.or(none.map(|of| &of.rule)) {
            return Self::Forbidden(rule);
        }
        let limit = match design.inverse {
            true => finest
                .and_then(|of| Some(Limit { ratio: of.ratio?, rule: &of.rule, may_be_more: of.is_open })),
            // Sizes without a unit are taken as a sand without fines: no limit is known of the base itself.
            false if !sizes.has_unit => None,
            false => {
                let limit = |(rule, limit)| Limit { ratio: limit / sizes.d85, rule, may_be_more: false };
                design.strictest(sizes).map(limit)
            }
        };
        let open = open_retention(&design.rules).filter(|_| sizes.has_unit && !design.inverse);
        if let Some((limit, rule)) = limit.zip(open) {
            return Self::Open(limit, rule, design.least_held().map(|(_, held)| held));
        }
        let (tail, least) = (design.base.tail_mass_fraction, design.bracket[0]);
        let nothing_holds = design.boundaries.iter().all(|row| row.held().is_none());
        match (design.least_held(), limit) {
            (None, None) => Self::Unknown,
            // The walk says nothing against a base of which it does not know enough.
            (None, Some(limit)) if tail >= design.threshold && nothing_holds => Self::TailOpen(limit, tail),
            (None, Some(limit)) if limit.ratio < least => Self::BelowSearch(limit, least),
            (None, Some(limit)) => Self::NotHeld(limit),
            (Some((_, held)), Some(limit)) if limit.ratio <= held => Self::Practice(limit),
            (Some((row, held)), Some(limit)) => Self::Walk(row, held, limit),
            (Some((row, held)), None) => Self::ModelAlone(row, held),
        }
    }

    /// The ratio that is allowed; `None` where none is known.
    fn ratio(&self) -> Option<f64> {
        match self {
            Self::TailOpen(limit, _) | Self::Practice(limit) => Some(limit.ratio),
            Self::Walk(_, held, _) | Self::ModelAlone(_, held) => Some(*held),
            Self::Forbidden(_)
            | Self::Open(..)
            | Self::OpenBase(..)
            | Self::Unknown
            | Self::BelowSearch(..)
            | Self::NotHeld(_) => None,
        }
    }

    /// The rule that set the answer; `None` where the walk did.
    fn rule(&self) -> Option<&'a AppliedRule> {
        match self {
            Self::Forbidden(rule) => Some(rule),
            Self::TailOpen(limit, _) | Self::Practice(limit) => Some(limit.rule),
            _ => None,
        }
    }

    /// A sentence without its full stop.
    fn words(&self, design: &Design, sizes: &Sizes) -> String {
        match self {
            Self::Forbidden(rule) => format!(
                "No base is known that both the walk and practice allow with this filter ({})",
                cited_rule(rule)
            ),
            Self::Open(limit, rule, held) => format!(
                "The maximum D15F is not known: the limit of practice is at most {} ({}; {}){}",
                sizes.size(limit.ratio),
                cited_rule(limit.rule),
                if rule.needs.is_empty() { "it can only be less".into() } else { rule.needs.to_string() },
                of_walk_alone(design, sizes, *held)
            ),
            Self::OpenBase(rule, held) => format!(
                "The finest D85B is not known: only an upper bound of the limit of practice is known \
                 ({}{}){}",
                cited_rule(rule),
                if rule.needs.is_empty() { String::new() } else { format!("; {}", rule.needs) },
                of_walk_alone(design, sizes, *held)
            ),
            Self::Unknown => "No ratio is known that nearly all networks hold".into(),
            Self::TailOpen(limit, tail) => format!(
                "{}, by practice alone ({}{}); the walk has no answer, as {} of the base is finer than its \
                 finest sieve",
                sizes.words(limit.ratio),
                cited_rule(limit.rule),
                sizes.other(design, limit.rule),
                percent(*tail)
            ),
            Self::BelowSearch(limit, least) => format!(
                "Practice allows {} ({}); the walk was searched from a {} of {} only, where networks erode: \
                 search from a smaller D15F/D85B",
                sizes.words(limit.ratio),
                cited_rule(limit.rule),
                sizes.name(),
                sizes.size(*least)
            ),
            Self::NotHeld(limit) => format!(
                "No ratio is known that nearly all networks hold; practice alone allows {} ({})",
                sizes.words(limit.ratio),
                cited_rule(limit.rule)
            ),
            Self::Practice(limit) => format!(
                "{}, by practice ({}{}{}){}",
                sizes.words(limit.ratio),
                cited_rule(limit.rule),
                sizes.other(design, limit.rule),
                if limit.may_be_more {
                    format!(", whose limit for a finer base is not known: {}", limit.rule.needs)
                } else {
                    String::new()
                },
                match design.walk_errs_unsafely() {
                    true => ". The walk is no check of this limit: for such soils it errs on the unsafe side",
                    false => "; the walk sets no tighter limit, and is no check of it",
                }
            ),
            Self::Walk(row, held, limit) => format!(
                "{}{}, by the walk; practice allows {} ({})",
                searched(row),
                sizes.words(*held),
                sizes.words(limit.ratio),
                cited_rule(limit.rule)
            ),
            Self::ModelAlone(row, held) => format!(
                "{}{} in the model alone{}; {}",
                searched(row),
                sizes.words(*held),
                design.unsafe_alone(),
                sizes.without_limit(design.strictest(sizes))
            ),
        }
    }
}

/// What the walk holds where practice gives no answer.
fn of_walk_alone(design: &Design, sizes: &Sizes, held: Option<f64>) -> String {
    match held {
        Some(held) => format!("; the walk alone holds {}{}", sizes.words(held), design.unsafe_alone()),
        None => "; the walk has no answer either".into(),
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

    /// What they are sizes of.
    fn name(&self) -> &'static str {
        if self.inverse && self.has_unit { "D85B" } else { "D15F" }
    }

    /// A ratio as a size.
    fn size(&self, ratio: f64) -> String {
        // The maximum D15F, or the minimum D85B.
        let within = if self.inverse { rounded_up } else { rounded_down };
        self.mm(ratio)
            .map_or_else(|| format!("{} D85B", rounded_down(ratio)), |mm| format!("{} mm", within(mm)))
    }

    fn words(&self, ratio: f64) -> String {
        let name = self.name();
        format!("{name} {} {}", if name == "D85B" { "down to" } else { "up to" }, self.size(ratio))
    }

    /// The limit of design, where another rule is stricter.
    fn other(&self, design: &Design, rule: &AppliedRule) -> String {
        let all = limits(&design.rules, design.rules_at * self.d85);
        let of_design = all.iter().find(|(of, _)| of.id == DESIGN && rule.id != DESIGN && !self.inverse);
        of_design.map_or(String::new(), |(of, limit)| {
            format!("; {} is {} mm", cited_rule(of), rounded_down(*limit))
        })
    }

    /// Why no limit of practice is known.
    fn without_limit(&self, assumed: Option<(&AppliedRule, f64)>) -> String {
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

/// Whether a row holds all that was searched, before its size.
fn searched(row: &DesignRow) -> &'static str {
    match (&row.no_erosion, row.eroding_networks()) {
        (Some(_), _) => "",
        (None, 0) => "Holds as far as was searched: ",
        (None, _) => "Held by nearly all networks: ",
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::gradation::Gradation;
    use crate::outcome::design::band::Band;
    use crate::outcome::design::{Boundary, DesignFinding};
    use crate::outcome::record::Evidence;
    use crate::outcome::rules::BaseSoil;
    use crate::verdict::PairRules;

    /// A design in which the walk holds to this D15F/D85B, `None` where it holds nothing, as its file has it.
    fn design(base: &Gradation, held: Option<f64>) -> Design {
        let regraded = base.regraded();
        let d85 = regraded.gradation.d(85.0).unwrap();
        let filter = Gradation::linear_from_dx(15.0, 4.0 * d85, 1.5).unwrap();
        let no_erosion = held.and_then(|held| Boundary::of(&[Ok(held), Ok(held)], Some(d85)));
        let text = serde_json::json!({
            "version": "1", "inverse": false, "filter": "f", "filter_cu": 1.5, "filter_d15_mm": null,
            "unit": "mm",
            "base": {"name": "b", "cu": null, "d15_mm": null, "d85_mm": d85, "d95_over_d85": null},
            "threshold": 0.075, "replicates": 2, "seed": 1, "bracket": [0.5, 100.0], "step": 0.005,
            "confidence": "within checked range", "reasons": [], "rules": PairRules::of(base, &filter).rules,
            "rules_at": 4.0, "products": [], "warnings": [], "model_leaves_out": [], "settings": [],
            "seconds": 1.0,
            "boundaries": [{"density": "loose", "thickness": "60 layers", "layers": 60, "thickness_mm": null,
                "grains_per_void": 0.6, "no_erosion": no_erosion, "continuing": null, "not_monotone": 0,
                "networks": [], "band": null}],
        });
        serde_json::from_value(text).unwrap()
    }

    fn till() -> Gradation {
        let points = [(0.001, 0.0), (0.075, 35.0), (0.425, 60.0), (2.0, 82.0), (4.75, 92.0), (19.0, 100.0)];
        Gradation::from_points(&points, None).unwrap()
    }

    fn sand() -> Gradation {
        Gradation::from_points(&[(0.1, 0.0), (0.5, 100.0)], None).unwrap()
    }

    /// The till of the third trial: the walk holds it to 12.6 D85B, here 19.3 mm, and practice to 0.70 mm.
    #[test]
    fn a_till_is_limited_by_practice_and_the_walks_figure_stands_nowhere() {
        let found = design(&till(), Some(12.6));
        let answer = found.answer();
        assert!((answer.d15f_max_mm.unwrap() - 0.7).abs() < 1e-9, "{answer:?}");
        assert_eq!(
            (answer.set_by, answer.rule.as_deref()),
            (SetBy::Practice, Some("foster-fell-no-erosion"))
        );
        assert!(
            answer.said.starts_with("D15F up to 0.700 mm, by practice (Foster and Fell"),
            "{}",
            answer.said
        );
        assert!(answer.said.contains("Sherard and Dunnigan's limit of design is 1.1"), "{}", answer.said);
        assert!(
            answer.said.ends_with("the walk sets no tighter limit, and is no check of it"),
            "{}",
            answer.said
        );
        assert!(!serde_json::to_string(&answer).unwrap().contains("19."), "{answer:?}");
    }

    /// The till again: `judge` says of this group that the walk errs on the unsafe side.
    #[test]
    fn a_walk_that_errs_on_the_unsafe_side_is_said_to_be_no_check() {
        let mut found = design(&till(), Some(12.6));
        assert!(found.walk_beside_practice().starts_with("The walk sets no tighter limit"));
        let rules = found.rules.clone();
        let evidence = Evidence::of(&BaseSoil::of(&till(), false), 0.7, Some(5.3), None).unwrap();
        let finding = evidence.against_holding(&rules).unwrap().record(true);
        assert!(finding.sentence.contains(" real soils of this kind (35 to 55 % fines"), "{finding:?}");
        found.findings.push(DesignFinding { row: None, finding });
        let said = found.answer().said;
        assert!(said.starts_with("D15F up to 0.700 mm, by practice (Foster and Fell"), "{said}");
        assert!(
            said.ends_with("The walk is no check of this limit: for such soils it errs on the unsafe side")
                && !said.contains("tighter"),
            "{said}"
        );
        assert!(!found.walk_beside_practice().contains("tighter"));
        // Nor is what it holds alone, of a limit of which only the most is known or of none.
        let unsafe_alone = ", and for such soils it errs on the unsafe side";
        let mut open = found.clone();
        let retains = |rule: &&mut AppliedRule| rule.role == RuleRole::Retention && rule.applies;
        open.rules.iter_mut().find(retains).unwrap().limit_at_most = true;
        let said = open.answer().said;
        assert!(said.starts_with("The maximum D15F is not known") && said.ends_with(unsafe_alone), "{said}");
        open.rules.clear();
        let said = open.answer().said;
        assert!(
            said.contains(&format!(" in the model alone{unsafe_alone}; the limit of practice")),
            "{said}"
        );
        open.findings.clear();
        assert!(!open.answer().said.contains("unsafe"));
        // Uniform filters have no such group.
        let uniform = Evidence::of(&BaseSoil::of(&till(), false), 0.7, Some(1.5), None).unwrap();
        assert_eq!(uniform.against_holding(&rules), None);
    }

    #[test]
    fn a_walk_that_holds_less_than_practice_sets_the_answer() {
        let base = sand();
        let (d85, answer) = (base.d(85.0).unwrap(), design(&base, Some(3.0)).answer());
        assert!((answer.d15f_max_mm.unwrap() - 3.0 * d85).abs() < 1e-9);
        assert_eq!((answer.set_by, answer.rule), (SetBy::Walk, None));
        assert!(answer.said.contains("by the walk; practice allows D15F up to"), "{}", answer.said);
        let answer = design(&base, Some(7.0)).answer();
        assert!((answer.d15f_max_mm.unwrap() - 4.0 * d85).abs() < 1e-9);
        assert_eq!(answer.rule.as_deref(), Some("sherard-dunnigan"));
    }

    #[test]
    fn what_neither_or_one_of_them_knows_is_said() {
        let nothing = design(&sand(), None).answer();
        assert_eq!((nothing.d15f_max_mm, nothing.set_by), (None, SetBy::Walk));
        // What programs read: null where nothing is known.
        let json = serde_json::to_value(&nothing).unwrap();
        assert!(
            json["d15f_max_mm"].is_null() && json["rule"].is_null() && json["set_by"] == "walk",
            "{json}"
        );
        assert!(nothing.said.contains("practice alone allows D15F up to"), "{}", nothing.said);
        // The minimum D15F that was searched is above the limit of practice: 0.77 against 0.70 mm.
        let below = design(&till(), None).answer();
        assert!(below.d15f_max_mm.is_none() && below.said.starts_with("Practice allows D15F up to 0.700 mm"));
        assert!(below.said.contains("searched from a D15F of 0.765 mm only"), "{}", below.said);
        // A third of the base may be anything: the walk says nothing against it.
        let mut open = design(&till(), None);
        open.base.tail_mass_fraction = 0.38;
        let answer = open.answer();
        assert!((answer.d15f_max_mm.unwrap() - 0.7).abs() < 1e-9, "{answer:?}");
        assert!(
            answer.said.contains("by practice alone") && answer.said.contains("38.0 %"),
            "{}",
            answer.said
        );
        let mut scale_free = design(&sand(), Some(5.2));
        (scale_free.base.d85_mm, scale_free.unit) = (None, "D85B".into());
        let answer = scale_free.answer();
        assert_eq!((answer.d15f_max_mm, answer.d15f_over_d85b), (None, Some(5.2)));
        assert!(answer.said.starts_with("D15F up to 5.20 D85B in the model alone"), "{}", answer.said);
        assert!(answer.said.contains("the limit of practice is not known"), "{}", answer.said);
        let mut unknown = design(&sand(), Some(5.2));
        unknown.rules.clear();
        assert!(unknown.answer().said.ends_with("the limit of practice is not known for this base"));
    }

    /// 30 % pass the finest sieve: with as many fines the limit would be less than half of four D85B.
    #[test]
    fn a_limit_that_is_at_most_some_size_is_no_known_limit() {
        let base = Gradation::from_points(
            &[(0.25, 30.0), (0.5, 45.0), (1.0, 60.0), (2.0, 90.0), (4.0, 100.0)],
            None,
        );
        let base = base.unwrap();
        for held in [Some(3.0), None] {
            let mut open = design(&base, held);
            open.base.tail_mass_fraction = 0.3;
            let answer = open.answer();
            assert_eq!((answer.d15f_max_mm, answer.d15f_over_d85b, &answer.rule), (None, None, &None));
            assert!(
                answer.said.starts_with("The maximum D15F is not known: the limit of practice is at most 7")
            );
            assert_eq!(
                answer.said.contains("the walk alone holds D15F up to"),
                held.is_some(),
                "{}",
                answer.said
            );
            assert!(Band::new(&open.rules, 4.0, 4.0, "mm").is_none());
        }
    }

    /// A loose filter that erodes at all that was searched is not held by what a dense one holds.
    #[test]
    fn a_row_that_holds_nothing_leaves_the_walk_without_an_answer() {
        let mut two = design(&sand(), Some(3.0));
        two.boundaries.push(design(&sand(), None).boundaries.remove(0));
        let answer = two.answer();
        assert_eq!((answer.d15f_max_mm, answer.set_by), (None, SetBy::Walk));
        assert!(answer.said.contains("practice alone allows D15F up to"), "{}", answer.said);
        // Nor does an open tail leave the answer to practice, where another row says less than it allows.
        two.base.tail_mass_fraction = 0.08;
        assert_eq!(two.answer().d15f_max_mm, None);
    }

    #[test]
    fn the_inverse_stops_at_the_base_that_practice_allows() {
        let mut inverse = design(&sand(), Some(7.0));
        (inverse.inverse, inverse.filter_d15_mm, inverse.base.d85_mm) = (true, Some(2.0), None);
        let rule = inverse.rules.iter().find(|rule| rule.id == "sherard-dunnigan").unwrap().clone();
        let finest = FinestBase { ratio: Some(4.0), rule, is_open: false };
        let answer = design_answer(&inverse, Some(&finest));
        assert_eq!((answer.d85b_min_mm, answer.d15f_max_mm), (Some(0.5), None));
        assert!(answer.said.starts_with("D85B down to 0.500 mm, by practice"), "{}", answer.said);
        let none = design_answer(&inverse, Some(&FinestBase { ratio: None, ..finest.clone() }));
        assert!(none.d85b_min_mm.is_none() && none.said.starts_with("No base is known that both"));
        let open =
            |ratio| design_answer(&inverse, Some(&FinestBase { ratio, is_open: true, ..finest.clone() }));
        let unknown = open(None);
        assert_eq!((unknown.d85b_min_mm, unknown.d15f_over_d85b, &unknown.rule), (None, None, &None));
        assert!(
            unknown.said.starts_with("The finest D85B is not known: only an upper bound"),
            "{}",
            unknown.said
        );
        assert!(unknown.said.ends_with("; the walk alone holds D85B down to 0.286 mm"), "{}", unknown.said);
        assert_eq!(open(Some(4.0)).d85b_min_mm, Some(0.5));
        assert!(open(Some(4.0)).said.contains("whose limit for a finer base is not known"));
    }
}
