//! The next step by practice: the D15F of a better filter, a test, or missing data.

use super::dispersion::beside_dispersive;
use super::rule_note::missing;
use crate::outcome::record::{Outcome, Verdict};
use voidwalk_core::gradation::FINES_MM;
use voidwalk_practice::Decision;
use voidwalk_practice::decision::Standing;
use voidwalk_practice::quantity::{NumberRole, SizeUnit, length, limits, significant};
use voidwalk_practice::rules::{FILTER_FINES, FILTER_GREATEST_SIZE, PERMEABILITY};
use voidwalk_practice::{AppliedRule, RuleQuantity, RuleRole, TestedClass};

/// Above this D15F (mm) a filter is a drain, bedding or rockfill, and coarse grains are no fault.
const DRAIN_D15F_MM: f64 = 5.0;

/// The next step by practice for a pair in mm, in a sentence without its end.
pub fn next(outcome: &Outcome, decision: &Decision, unit: SizeUnit) -> String {
    Pair { decision, d15f_mm: outcome.inputs.filter.d15_mm, class: outcome.model.class, unit }.step()
}

/// A pair as practice sees it.
struct Pair<'a> {
    decision: &'a Decision,
    d15f_mm: f64,
    /// The class of the model.
    class: Verdict,
    unit: SizeUnit,
}

impl Pair<'_> {
    fn step(&self) -> String {
        match self.decision.standing {
            Standing::Fails | Standing::NoMargin => self.retention(),
            // The filter as placed is too coarse already.
            Standing::WashedOut if self.decision.breaks(RuleRole::Retention) => {
                self.retention() + "; it must be internally stable"
            }
            Standing::WashedOut | Standing::Unstable => self.stability(),
            Standing::Unknown(need) => {
                format!("get {}", need.and_then(missing).unwrap_or("the limit of design"))
            }
            Standing::Open(_) => "test the sieves between".into(),
            Standing::Met | Standing::NoRules => self
                .dispersion()
                .or_else(|| self.drainage())
                .or_else(|| self.placing())
                .or_else(|| self.fines())
                .or_else(|| self.missing_drainage())
                .unwrap_or_else(|| self.of_model().into()),
        }
    }

    /// The step after the model, if the rules require nothing more.
    fn of_model(&self) -> &'static str {
        match self.class {
            Verdict::None => "nothing by these rules",
            Verdict::Some | Verdict::Continuing | Verdict::Undecided => "have this pair tested",
        }
    }

    /// A test of the base, if the filter is too coarse for a dispersive one alone.
    fn dispersion(&self) -> Option<String> {
        self.decision.beyond_dispersive?;
        Some("have the base tested for dispersion by a pinhole or crumb test".into())
    }

    /// The filter to take instead of one that may lose its finer part.
    fn stability(&self) -> String {
        let filter = match self.greatest() {
            Some((limit, false)) => self.sized("an internally stable filter", limit),
            _ => "take an internally stable filter".into(),
        };
        // A test of its stability would leave these open.
        let is_open = self.decision.breaks(RuleRole::Drainage) || self.decision.breaks(RuleRole::Placing);
        if is_open { filter } else { format!("{filter}, or have its internal stability tested") }
    }

    /// The D15F that retains the base, and the advice for an existing filter.
    fn retention(&self) -> String {
        let exists = self.existing_filter();
        match self.greatest() {
            Some((limit, true)) => format!(
                "take a finer filter; the limit lies below a D15F of {}, and is not known; {exists}",
                length(limit, self.unit).role(NumberRole::Greatest)
            ),
            None => format!("take a finer filter; {exists}"),
            Some((limit, false)) => format!("{}; {exists}", self.sized("a filter", limit)),
        }
    }

    /// Beyond the boundary of continuing erosion no test of the pair is worth waiting for.
    fn existing_filter(&self) -> &'static str {
        match self.decision.tests {
            TestedClass::Continuing => "for an existing filter, assume continuing erosion",
            _ => "for an existing filter, have this pair tested",
        }
    }

    /// A filter with a D15F of at most this (mm), and at least the D15F that drains the base.
    fn sized(&self, filter: &str, most: f64) -> String {
        let drainage = self.drainage_rule().filter(|rule| !rule.limit_at_most);
        let (drains, dry) = match self.drainage_rule().and_then(|rule| rule.limit) {
            Some(least) if least <= most => {
                (format!(" and at least {}", length(least, self.unit).role(NumberRole::Least)), None)
            }
            // A limit with an upper bound may be lower, and perhaps requires no more than is allowed.
            Some(least) if drainage.is_some() => {
                let least = length(least, self.unit).role(NumberRole::Least).to_string();
                (String::new(), Some(format!("drainage asks for at least {least}: compare permeabilities")))
            }
            Some(_) | None => (String::new(), None),
        };
        let beside = self.beside_dispersive(most).into_iter().chain(dry).collect::<Vec<_>>().join("; ");
        let beside = if beside.is_empty() { beside } else { format!(" ({beside})") };
        format!(
            "take {filter} with D15F at most {}{beside}{drains}",
            length(most, self.unit).role(NumberRole::Greatest)
        )
    }

    /// The limit of a dispersive base beside a D15F (mm) that is recommended.
    fn beside_dispersive(&self, most: f64) -> Option<String> {
        beside_dispersive(self.decision.if_dispersive?, most, self.unit)
    }

    /// The maximum D15F (mm) that every rule of retention allows, and true if the limit itself is lower and
    /// unknown.
    fn greatest(&self) -> Option<(f64, bool)> {
        self.decision.strictest().map(|(_, limit)| (limit, self.decision.is_strictest_open))
    }

    fn drainage_rule(&self) -> Option<&AppliedRule> {
        self.decision.applied(PERMEABILITY)
    }

    fn drainage(&self) -> Option<String> {
        let (of_size, of_fines): (Vec<&AppliedRule>, Vec<&AppliedRule>) =
            self.decision.broken(RuleRole::Drainage).partition(|rule| rule.quantity == RuleQuantity::D15F);
        let fines = of_fines.iter().find_map(|rule| rule.limit);
        let least = of_size.iter().find_map(|rule| rule.limit);
        let clean = fines.map_or_else(String::new, |most| format!(" and {}", few_fines(most)));
        match (least, self.greatest()) {
            (Some(least), Some((most, false))) if most >= least => {
                let range = limits(least, most, self.unit);
                let dispersive =
                    self.beside_dispersive(most).map_or_else(String::new, |limit| format!(" ({limit})"));
                Some(format!("take a coarser filter, D15F {range}{dispersive}{clean}"))
            }
            (Some(_), _) => {
                Some("compare the permeabilities of filter and base: no D15F both retains and drains".into())
            }
            (None, _) => fines.map(|most| format!("wash the filter: {}", few_fines(most))),
        }
    }

    /// Advice on a filter whose fines nobody sieved.
    fn fines(&self) -> Option<String> {
        let most = self.decision.applied(FILTER_FINES).filter(|rule| rule.met.is_none())?.limit?;
        Some(format!("have the fines of the filter tested, and wash it where needed: {}", few_fines(most)))
    }

    /// Advice on a filter that may segregate.
    fn placing(&self) -> Option<String> {
        let step = |rule: &AppliedRule| {
            if rule.id != FILTER_GREATEST_SIZE {
                return Some("narrow the filter's range of sizes, or specify how it is placed".into());
            }
            let limit = rule.limit.filter(|_| self.d15f_mm <= DRAIN_D15F_MM)?;
            Some(format!("take out the grains coarser than {} mm", significant(limit).in_digits(3)))
        };
        self.decision.broken(RuleRole::Placing).find_map(step)
    }

    /// Missing data for judging drainage.
    fn missing_drainage(&self) -> Option<String> {
        let need = self.drainage_rule().filter(|rule| rule.met.is_none())?.needs.first()?;
        missing(*need).map(|need| format!("get {need}: drainage is not known"))
    }
}

/// Fines that a filter may have once it is placed.
fn few_fines(most: f64) -> String {
    format!("at most {most} % finer than {FINES_MM} mm in place")
}
