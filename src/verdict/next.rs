//! What to do next: which D15F a filter is to have, what to test, what to find out.

use super::practice::{Standing, broken, standing};
use super::rule_words::first_clause;
use crate::gradation::FINES_MM;
use crate::outcome::design::band::{open_retention, retention};
use crate::outcome::numbers::{in_digits, rounded_down, rounded_up};
use crate::outcome::record::{AppliedRule, Outcome, RuleQuantity, RuleRole};
use crate::outcome::rules::{FILTER_FINES, FILTER_GREATEST_SIZE, PERMEABILITY, TESTS_CONTINUING};

/// What tells whether a base is dispersive.
const TEST_OF_DISPERSION: &str = "have the base tested for dispersion by a pinhole or crumb test";

/// Above this D15F (mm) a filter is a drain, bedding or rockfill, and coarse grains are no fault of it.
const DRAIN_D15F_MM: f64 = 5.0;

impl Outcome {
    /// What to do next by practice, in a sentence without its end.
    pub fn next_in_words(&self) -> String {
        // Of a filter that is too coarse for a dispersive base alone the line of practice has the limit.
        let test = self.beyond_if_dispersive().map(|_| TEST_OF_DISPERSION.to_owned());
        match standing(&self.rules) {
            Standing::Fails | Standing::NoMargin => self.of_retention(),
            // As placed it is too coarse already.
            Standing::WashedOut if !broken(&self.rules, RuleRole::Retention).is_empty() => {
                self.of_retention() + "; it must be internally stable"
            }
            Standing::WashedOut | Standing::Unstable => self.of_stability(),
            Standing::Unknown(needs) => format!("get {needs}"),
            Standing::Open(_) => "test the sieves between".into(),
            Standing::Met | Standing::NoRules => test
                .or_else(|| self.of_drainage())
                .or_else(|| self.of_placing())
                .or_else(|| self.of_fines())
                .or_else(|| self.of_missing_drainage())
                .unwrap_or_else(|| "nothing by these rules".into()),
        }
    }

    /// Which filter to take in the place of one that may lose its finer part.
    fn of_stability(&self) -> String {
        let filter = match self.greatest() {
            Some((limit, false)) => {
                self.sized(limit, [self.if_dispersive_in_brief(limit)]) + " that is internally stable"
            }
            _ => "take a filter that is internally stable".into(),
        };
        format!("{filter}, or have its internal stability tested")
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
            Some((limit, false)) => {
                format!("{}; {exists}", self.sized(limit, [self.if_dispersive_beside(limit)]))
            }
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

    fn unit(&self) -> &'static str {
        if self.inputs.scale_free { "D0F" } else { "mm" }
    }

    /// The maximum D15F that every rule of retention allows, and whether the limit itself is lower and not
    /// known.
    fn greatest(&self) -> Option<(f64, bool)> {
        greatest(&self.rules, self.inputs.filter.d15_mm)
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
            (Some((least, unit)), Some((most, false))) if most >= least => {
                let [least, upper] = [rounded_up(least), rounded_down(most)];
                let dispersive = self.if_dispersive_in_words(most);
                Some(format!("take a coarser filter, D15F {least} to {upper} {unit}{dispersive}{clean}"))
            }
            (Some(_), _) => {
                Some("compare the permeabilities of filter and base: no D15F both retains and drains".into())
            }
            (None, _) => fines.map(|most| format!("wash the filter: {}", few_fines(most))),
        }
    }

    /// What to ask of a filter whose fines nobody sieved.
    fn of_fines(&self) -> Option<String> {
        let rule =
            self.rules.iter().find(|rule| rule.id == FILTER_FINES && rule.applies && rule.met.is_none());
        let most = rule?.limit?;
        Some(format!("have the fines of the filter tested, and wash it where needed: {}", few_fines(most)))
    }

    /// What to do about a filter that may segregate.
    fn of_placing(&self) -> Option<String> {
        let is_drain = !self.inputs.scale_free && self.inputs.filter.d15_mm > DRAIN_D15F_MM;
        let to_do = |rule: &AppliedRule| match rule.id == FILTER_GREATEST_SIZE {
            true if is_drain => None,
            true => Some(format!("take out the grains coarser than {} mm", in_digits(rule.limit?, 3))),
            false => Some("narrow the filter's range of sizes, or specify how it is placed".into()),
        };
        broken(&self.rules, RuleRole::Placing).into_iter().find_map(to_do)
    }

    /// What is missing to judge drainage.
    fn of_missing_drainage(&self) -> Option<String> {
        let rule = self.rules.iter().find(|rule| rule.id == PERMEABILITY && rule.applies);
        let needs = first_clause(&rule.filter(|rule| rule.met.is_none())?.needs.to_string());
        needs.strip_prefix("needs ").map(|needs| format!("get {needs}: drainage is not known"))
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
    Some((limit, open_retention(rules).is_some()))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::gradation::Gradation;
    use crate::outcome::rules::{DESIGN, TESTS_NO_EROSION};
    use crate::verdict::PairRules;

    /// With 38 % fines the limit of design lies beyond the boundary of no erosion of tests.
    #[test]
    fn a_filter_is_asked_for_by_the_limit_of_design() {
        let base = [(0.01, 10.0), (0.075, 38.0), (0.425, 60.0), (2.0, 90.0), (4.75, 100.0)];
        let soil = |points: &[(f64, f64)]| Gradation::from_lines(points).unwrap();
        let rules = PairRules::of(&soil(&base), &soil(&[(0.7, 0.0), (3.0, 100.0)])).rules;
        let limit = |id: &str| rules.iter().find(|rule| rule.id == id).and_then(|rule| rule.limit).unwrap();
        assert!(limit(DESIGN) > 1.0 && (limit(TESTS_NO_EROSION) - 0.7).abs() < 1e-9, "{rules:?}");
        let d15f = rules.iter().find(|rule| rule.id == DESIGN).and_then(|rule| rule.value).unwrap();
        assert_eq!(greatest(&rules, d15f), Some((limit(DESIGN), false)));
    }
}
