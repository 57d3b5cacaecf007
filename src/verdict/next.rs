//! What to do next: which D15F a filter is to have, what to test, what to find out.

use super::entry::EVIDENCE_UNSAFE;
use super::practice::{Standing, broken, standing};
use super::reasons::{REASONS, Reason};
use super::rule_words::{NoMargin, against, listed, no_margin};
use crate::gradation::FINES_MM;
use crate::outcome::design::band::retention;
use crate::outcome::numbers::{in_digits, rounded_down, rounded_up};
use crate::outcome::record::{AppliedRule, Confidence, Outcome, RuleQuantity, RuleRole, Verdict};
use crate::outcome::rules::{
    DESIGN, DESIGN_FLOOR_MM, FILTER_FINES, FILTER_GREATEST_SIZE, PERMEABILITY, TESTS_CONTINUING,
    authority_in_brief,
};
use crate::outcome::undecided::UndecidedBy;

/// What tells whether a base is dispersive.
const TEST_OF_DISPERSION: &str = "have the base tested for dispersion by a pinhole or crumb test";

impl Outcome {
    /// What to do next, in a sentence without its end.
    pub fn next_in_words(&self) -> String {
        // Of a filter that is too coarse for a dispersive base alone the line of practice has the limit.
        let test = match self.beyond_if_dispersive() {
            Some(_) => format!("; {TEST_OF_DISPERSION}"),
            None => String::new(),
        };
        match standing(&self.rules) {
            Standing::Fails | Standing::NoMargin => self.of_retention(),
            // As placed it is too coarse already.
            Standing::WashedOut if !broken(&self.rules, RuleRole::Retention).is_empty() => {
                self.of_retention() + "; it must be internally stable"
            }
            Standing::WashedOut | Standing::Unstable => self.of_stability() + &test,
            Standing::Unknown(needs) => format!("get {needs}{test}"),
            Standing::Met | Standing::NoRules => match self.of_drainage() {
                Some(said) => said + &test,
                // Of "no erosion" the test comes first.
                None if self.verdict == Verdict::None => {
                    self.of_placing() + &self.of_walk() + &self.of_fines()
                }
                None => self.of_walk() + &self.of_fines() + &test,
            },
        }
    }

    /// Which filter to take in the place of one that may lose its finer part; one that may segregate besides
    /// no test of its stability saves.
    fn of_stability(&self) -> String {
        let mut whose: Vec<String> = Vec::new();
        for rule in broken(&self.rules, RuleRole::Stability) {
            let name = authority_in_brief(rule);
            if !whose.iter().any(|of| of == name) {
                whose.push(name.to_owned());
            }
        }
        let finer = match self.greatest() {
            Some((limit, false)) => {
                self.sized(limit, [self.if_dispersive_in_brief(limit)]) + " that is stable by "
            }
            _ => "take a filter that is stable by ".into(),
        };
        let stable = finer + &listed(&whose);
        let placing = broken(&self.rules, RuleRole::Placing).into_iter().map(|rule| {
            let [value, limit] = against(rule, 3);
            format!("{} {value}, limit {limit}", rule.quantity)
        });
        match placing.collect::<Vec<_>>() {
            placing if placing.is_empty() => format!("{stable}, or have its internal stability tested"),
            placing => {
                let dry = !broken(&self.rules, RuleRole::Drainage).is_empty();
                format!(
                    "{stable} and does not segregate ({}); a test of this one's internal stability would not \
                     settle its {}segregation",
                    listed(&placing),
                    if dry { "drainage or " } else { "" }
                )
            }
        }
    }

    /// Which D15F a filter is to have that retains the base, and what to do with one that exists.
    fn of_retention(&self) -> String {
        let exists = self.of_a_filter_that_exists();
        let unit = self.unit();
        match self.greatest() {
            Some((limit, true)) => format!(
                "take a finer filter; the limit lies below a D15F of {} {unit}, and is not \
                 known{}; {exists}",
                rounded_down(limit),
                self.if_dispersive_in_words(limit)
            ),
            None => format!("take a finer filter; {exists}"),
            Some((limit, false)) => format!("{}{}; {exists}", self.finer(limit), self.beside_floor(limit)),
        }
    }

    /// What to do about a filter that exists: beyond the boundary of continuing erosion no test of the pair
    /// is to be waited for.
    fn of_a_filter_that_exists(&self) -> String {
        let boundary = self.rules.iter().find(|rule| rule.id == TESTS_CONTINUING && rule.met == Some(false));
        match boundary.and_then(|rule| Some(rule.value? / rule.limit?)) {
            Some(times) => format!(
                "for a filter that exists, assume continuing erosion (its D15F is {} times that boundary)",
                in_digits(times, 2)
            ),
            None => "for a filter that exists, have this pair tested".into(),
        }
    }

    /// A filter with a D15F of at most so much, and of at least what drains the base.
    fn finer(&self, most: f64) -> String {
        // Where the limit of design alone is named behind it, this one needs no name.
        let lower = match no_margin(&self.rules) {
            Some(NoMargin::DesignIsAbove) if self.floor_beyond(most).is_none() => {
                Some("the lower of design and no erosion".to_owned())
            }
            _ => None,
        };
        self.sized(most, [lower, self.if_dispersive_beside(most)])
    }

    /// A filter with a D15F of at most so much, beside which this is said, and of at least what drains the
    /// base.
    fn sized(&self, most: f64, beside: impl IntoIterator<Item = Option<String>>) -> String {
        let unit = self.unit();
        let (drains, dry) = match self.least() {
            Some((least, _)) if least <= most => {
                (format!(" and at least {} {unit}", rounded_up(least)), None)
            }
            Some((least, Least::Needed)) => {
                let dry = format!(
                    "to drain the base it would be at least {} {unit}: compare the permeabilities of filter \
                     and base",
                    rounded_up(least)
                );
                (String::new(), Some(dry))
            }
            // What drains the base may be finer than what is enough.
            Some((_, Least::Enough)) | None => (String::new(), None),
        };
        let beside = in_brackets(beside.into_iter().chain([dry]).flatten());
        format!("take a filter with a D15F of at most {} {unit}{beside}{drains}", rounded_down(most))
    }

    /// The most of a limit that is stricter if the base is dispersive, where a test of that follows.
    fn if_dispersive_in_brief(&self, most: f64) -> Option<String> {
        let stricter = self.if_dispersive.filter(|of| of.d15f_max_mm < most)?;
        let at_most = if stricter.at_most { "at most " } else { "" };
        Some(format!("{at_most}{} mm if the base is dispersive", rounded_down(stricter.d15f_max_mm)))
    }

    /// The floor of the limit of design, where it lies beyond what tests held.
    fn beside_floor(&self, most: f64) -> String {
        let said = |floor| {
            format!(
                "; the limit of design alone is {} mm (its floor): above {} mm have the pair tested",
                rounded_down(floor),
                rounded_down(most)
            )
        };
        self.floor_beyond(most).map_or_else(String::new, |floor| said(floor) + self.two_stages(floor))
    }

    fn unit(&self) -> &'static str {
        if self.inputs.scale_free { "D0F" } else { "mm" }
    }

    /// The maximum D15F that every rule of retention allows, and whether the limit itself is lower and not
    /// known.
    fn greatest(&self) -> Option<(f64, bool)> {
        greatest(&self.rules, self.inputs.filter.d15_mm)
    }

    /// The floor of the limit of design, where the boundary that tests saw is below it, and that of
    /// continuing erosion is not. That of a dispersive base is no size to name.
    fn floor_beyond(&self, tested: f64) -> Option<f64> {
        let of = |id: &str| self.rules.iter().find(|rule| rule.id == id && rule.applies && rule.unit == "mm");
        let is_dispersive = self.findings.iter().any(|finding| finding.id == "dispersive_base");
        let floor = of(DESIGN).filter(|rule| rule.limit == Some(DESIGN_FLOOR_MM) && !rule.limit_at_most);
        let continuing = of(TESTS_CONTINUING).and_then(|rule| rule.limit);
        let is_between = tested < DESIGN_FLOOR_MM && continuing.is_none_or(|limit| limit >= DESIGN_FLOOR_MM);
        (floor.is_some() && is_between && !is_dispersive).then_some(DESIGN_FLOOR_MM)
    }

    /// What to do where the base may be dispersive, and its limit then is below the floor.
    fn two_stages(&self, floor: f64) -> &'static str {
        match self.if_dispersive {
            Some(of) if of.d15f_max_mm < floor => {
                "; have the base tested for dispersion: if it is dispersive, take a filter in two stages or \
                 have the pair tested in the laboratory"
            }
            _ => "",
        }
    }

    /// The D15F that drains the base, and whether it needs so much; `None` where neither is known.
    fn least(&self) -> Option<(f64, Least)> {
        let rule = self.rules.iter().find(|rule| rule.id == PERMEABILITY && rule.applies)?;
        let least = if rule.limit_at_most { Least::Enough } else { Least::Needed };
        rule.limit.map(|limit| (limit, least))
    }

    /// What a D15F that is recommended has to be if the base is dispersive; `None` where somebody has said
    /// whether it is.
    fn if_dispersive_beside(&self, most: f64) -> Option<String> {
        self.if_dispersive.and_then(|of| of.beside(most))
    }

    /// The same in brackets; empty without it.
    fn if_dispersive_in_words(&self, most: f64) -> String {
        in_brackets(self.if_dispersive_beside(most))
    }

    fn of_drainage(&self) -> Option<String> {
        let broken = broken(&self.rules, RuleRole::Drainage);
        let (of_size, of_fines): (Vec<&AppliedRule>, Vec<&AppliedRule>) =
            broken.into_iter().partition(|rule| rule.quantity == RuleQuantity::D15F);
        let fines = of_fines.iter().find_map(|rule| rule.limit);
        let least = of_size.iter().find_map(|rule| Some((rule.limit?, &rule.unit)));
        let clean = fines.map_or_else(String::new, |most| format!(" and {}", few_fines(most)));
        match (least, self.greatest()) {
            // Where a base erodes in the walk no coarser filter is asked for.
            (Some((least, unit)), Some((most, false))) if most >= least => (self.verdict == Verdict::None)
                .then(|| {
                    let [least, upper] = [rounded_up(least), rounded_down(most)];
                    let dispersive = self.if_dispersive_in_words(most);
                    format!("take a coarser filter, D15F {least} to {upper} {unit}{dispersive}{clean}")
                }),
            (Some(_), _) => {
                Some("compare the permeabilities of filter and base: no D15F both retains and drains".into())
            }
            (None, _) => fines.map(|most| format!("wash the filter: {}", few_fines(most))),
        }
    }

    /// What to ask of a filter whose fines nobody sieved; empty where they are known.
    fn of_fines(&self) -> String {
        let rule = self.rules.iter().find(|rule| rule.id == FILTER_FINES && rule.applies);
        let most = rule.filter(|rule| rule.met.is_none()).and_then(|rule| rule.limit);
        most.map_or_else(String::new, |most| {
            format!("; have the fines of the filter tested, and wash it where needed: {}", few_fines(most))
        })
    }

    /// What to do about a filter that may segregate, before what follows.
    fn of_placing(&self) -> String {
        let broken = broken(&self.rules, RuleRole::Placing);
        let (cobbles, wide): (Vec<&AppliedRule>, Vec<&AppliedRule>) =
            broken.into_iter().partition(|rule| rule.id == FILTER_GREATEST_SIZE);
        let cobbles = cobbles.first().and_then(|rule| rule.limit);
        let cobbles =
            cobbles.map(|limit| format!("take out the grains coarser than {} mm; ", in_digits(limit, 3)));
        let wide = if wide.is_empty() {
            ""
        } else {
            "narrow the filter's range of sizes, or specify how it is placed; "
        };
        cobbles.unwrap_or_default() + wide
    }

    fn of_walk(&self) -> String {
        match (self.undecided_by(), self.verdict, self.confidence) {
            (Some(UndecidedBy::Pan), ..) => "have the base's finest part tested with a hydrometer".into(),
            (Some(UndecidedBy::Curve), ..) => {
                "pack this filter at its density, so that its own constrictions are known".into()
            }
            (Some(UndecidedBy::SecondRun), ..) => "walk a second run".into(),
            (Some(UndecidedBy::Replicates), ..) => "walk more replicates".into(),
            (None, Verdict::None, confidence) => {
                let next = match confidence {
                    Confidence::Within => {
                        "check what the model leaves out: cracks, segregation, placing, gradients"
                    }
                    _ => &self.why_tested(),
                };
                self.of_dispersion().map_or(next.into(), |first| format!("{first}; {next}"))
            }
            (None, ..) => "have this pair tested: practice and walk differ".into(),
        }
    }

    /// Whether the next step is to have the pair tested, and says why the model is no check of it.
    pub(super) fn names_why_tested(&self) -> bool {
        let is_of_walk = matches!(standing(&self.rules), Standing::Met | Standing::NoRules)
            && self.of_drainage().is_none();
        is_of_walk && self.verdict == Verdict::None && self.undecided_by().is_none()
    }

    /// Why a pair that the walk holds is to be tested all the same: in what its soils lie outside what the
    /// model was checked against, and what else its class hangs on.
    fn why_tested(&self) -> String {
        let is_unsafe = self.against().iter().any(|finding| finding.id == EVIDENCE_UNSAFE);
        let mut reasons = self.reasons_outside();
        reasons.truncate(REASONS);
        let of = |kind: fn(&Reason) -> Option<&String>| reasons.iter().filter_map(kind).cloned();
        let soils: Vec<String> = of(Reason::soil).collect();
        let soils = (!soils.is_empty()).then(|| {
            format!("the soils lie outside what the model was checked against ({})", soils.join(", "))
        });
        let is_unsafe = is_unsafe.then(|| "the walk is no check of it".to_owned());
        let why: Vec<String> = is_unsafe.into_iter().chain(soils).chain(of(Reason::other)).collect();
        match why.is_empty() {
            true => "have this pair tested".into(),
            false => format!("have this pair tested: {}", listed(&why)),
        }
    }

    /// What to find out of a base of which nobody has said whether it is dispersive.
    fn of_dispersion(&self) -> Option<String> {
        let then = self.if_dispersive?.of_filter(&self.rules, Some(self.inputs.filter.d15_mm));
        Some(match self.beyond_if_dispersive() {
            Some(_) => TEST_OF_DISPERSION.into(),
            None => format!("{TEST_OF_DISPERSION} (if it is dispersive, {then})"),
        })
    }
}

/// What a least D15F is that drains a base.
#[derive(Clone, Copy)]
enum Least {
    /// A finer filter may not drain it.
    Needed,
    /// D15B lies in the base's finest part: a finer filter may drain it, too.
    Enough,
}

/// Clauses in brackets, behind a size; empty without any.
fn in_brackets(said: impl IntoIterator<Item = String>) -> String {
    let said: Vec<String> = said.into_iter().collect();
    if said.is_empty() { String::new() } else { format!(" ({})", said.join("; ")) }
}

/// How few fines a filter is to have once it is placed.
fn few_fines(most: f64) -> String {
    format!("at most {most} % finer than {FINES_MM} mm in place")
}

/// The maximum D15F that every rule of retention allows, and whether the limit itself is lower and not
/// known.
fn greatest(rules: &[AppliedRule], d15f: f64) -> Option<(f64, bool)> {
    let (_, limit) = retention(rules, d15f)?;
    let is_of_role = |rule: &AppliedRule| rule.role == RuleRole::Retention && rule.applies;
    Some((limit, rules.iter().any(|rule| is_of_role(rule) && rule.limit_at_most)))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::gradation::Gradation;
    use crate::outcome::rules::TESTS_NO_EROSION;
    use crate::verdict::PairRules;

    /// With 38 % fines the limit of design lies beyond the boundary that tests saw: no advice goes beyond it.
    #[test]
    fn no_advice_goes_beyond_what_tests_saw() {
        let base = [(0.01, 10.0), (0.075, 38.0), (0.425, 60.0), (2.0, 90.0), (4.75, 100.0)];
        let soil = |points: &[(f64, f64)]| Gradation::from_points(points, None).unwrap();
        let rules = PairRules::of(&soil(&base), &soil(&[(0.7, 0.0), (3.0, 100.0)])).rules;
        let limit = |id: &str| rules.iter().find(|rule| rule.id == id).and_then(|rule| rule.limit).unwrap();
        assert!(limit(DESIGN) > 1.0 && (limit(TESTS_NO_EROSION) - 0.7).abs() < 1e-9, "{rules:?}");
        let d15f = rules.iter().find(|rule| rule.id == DESIGN).and_then(|rule| rule.value).unwrap();
        assert_eq!(greatest(&rules, d15f), Some((limit(TESTS_NO_EROSION), false)));
        let practice = crate::verdict::practice_words::practice_in_words(&rules);
        assert!(practice.starts_with("not met: D15F "), "{practice}");
        assert!(
            practice.contains("is more than the 0.700 mm up to which tests saw no erosion"),
            "{practice}"
        );
    }
}
