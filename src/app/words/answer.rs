//! First lines of every face: practice, the model, and the next step.

use super::practice::{beside_dispersive, practice_line};
use super::rule::missing;
use crate::outcome::record::{Model, Outcome, RunSummary, Verdict};
use crate::outcome::verdict::{FirstLook, UndecidedBy};
use voidwalk_core::gradation::FINES_MM;
use voidwalk_practice::decision::Standing;
use voidwalk_practice::quantity::{SizeUnit, greatest_length, least_length, limits, percent, significant};
use voidwalk_practice::rules::{FILTER_FINES, FILTER_GREATEST_SIZE, PERMEABILITY};
use voidwalk_practice::{AppliedRule, Decision, Note, RuleQuantity, RuleRole, TestedClass};

/// Maximum number of notes in a brief verdict and in the answer on boundaries, which counts the others.
pub(crate) const FOREMOST: usize = 3;

/// First line of every face.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum FirstLine {
    Practice,
    Model,
    Next,
}

impl FirstLine {
    pub(crate) fn name(self) -> &'static str {
        match self {
            Self::Practice => "Practice",
            Self::Model => "Model (research)",
            Self::Next => "Next",
        }
    }
}

/// First lines of every face; without two sieve curves in mm, only the model's.
pub(crate) fn first_lines(
    outcome: &Outcome,
    decision: &Decision,
    unit: SizeUnit,
) -> Vec<(FirstLine, String)> {
    let line = (FirstLine::Model, model(&outcome.model));
    match decision.headline {
        Some(_) => vec![
            (FirstLine::Practice, practice_line(decision, unit)),
            line,
            (FirstLine::Next, next(outcome, decision, unit)),
        ],
        None => vec![line],
    }
}

/// The most important notes, at most [`FOREMOST`], and the number of the others.
pub(crate) fn foremost(outcome: &Outcome) -> (&[Note], usize) {
    let (first, rest) = outcome.notes.split_at(outcome.notes.len().min(FOREMOST));
    (first, rest.len())
}

/// Class of a walk, and mass eroded in each run.
pub(crate) fn model(model: &Model) -> String {
    let part = |percentage: f64| percent((percentage / 100.0).max(0.0));
    let run = |(run, [low, high]): (usize, &[f64; 2])| {
        let eroded = part(*low).to(part(*high));
        match run {
            0 => format!("{eroded} eroded"),
            1 => format!("second run: {eroded}"),
            _ => format!("run {}: {eroded}", run + 1),
        }
    };
    let runs: Vec<String> = model.eroded_percent.iter().enumerate().map(run).collect();
    format!("{}; {}", model.class.words(), runs.join(", "))
}

/// D15F (mm) above which a filter is a drain, bedding or rockfill, so that coarse grains are no fault.
const DRAIN_D15F_MM: f64 = 5.0;

/// Next step by practice for a pair in mm, in a sentence without its end.
pub fn next(outcome: &Outcome, decision: &Decision, unit: SizeUnit) -> String {
    Pair { decision, d15f_mm: outcome.inputs.filter.d15_mm, class: outcome.model.class, unit }.step()
}

/// A pair and the decision of practice on it.
struct Pair<'a> {
    decision: &'a Decision,
    d15f_mm: f64,
    class: Verdict,
    unit: SizeUnit,
}

impl Pair<'_> {
    fn step(&self) -> String {
        match self.decision.standing {
            Standing::Fails | Standing::NoMargin => self.retention(),
            // The filter as placed is already too coarse.
            Standing::WashedOut if self.decision.breaks(RuleRole::Retention) => {
                self.retention() + "; it must be internally stable"
            }
            Standing::WashedOut | Standing::Unstable => self.stability(),
            Standing::Unknown(need) => {
                format!("get {}", need.and_then(missing).unwrap_or("the limit of design"))
            }
            Standing::Open(_) => "test the sieves between".into(),
            Standing::Met | Standing::NoRules if self.decision.beyond_dispersive.is_some() => {
                "have the base tested for dispersion by a pinhole or crumb test".into()
            }
            Standing::Met | Standing::NoRules => {
                let by_rules = self.drainage().or_else(|| self.placing()).or_else(|| self.fines());
                by_rules.or_else(|| self.missing_drainage()).unwrap_or_else(|| match self.class {
                    Verdict::None => "nothing by these rules".into(),
                    _ => "have this pair tested".into(),
                })
            }
        }
    }

    /// Filter to use instead of one that may lose its finer part.
    fn stability(&self) -> String {
        let filter = match self.greatest() {
            Some((limit, false)) => self.sized("an internally stable filter", limit),
            _ => "take an internally stable filter".into(),
        };
        // A test of its stability would leave these open.
        let is_open = self.decision.breaks(RuleRole::Drainage) || self.decision.breaks(RuleRole::Placing);
        if is_open { filter } else { format!("{filter}, or have its internal stability tested") }
    }

    /// D15F that retains the base, and advice for an existing filter.
    fn retention(&self) -> String {
        // Beyond the boundary of continuing erosion no test of the pair is worthwhile.
        let exists = match self.decision.tests {
            TestedClass::Continuing => "for an existing filter, assume continuing erosion",
            _ => "for an existing filter, have this pair tested",
        };
        match self.greatest() {
            Some((limit, true)) => format!(
                "take a finer filter; the limit lies below a D15F of {}, and is not known; {exists}",
                greatest_length(limit, self.unit)
            ),
            None => format!("take a finer filter; {exists}"),
            Some((limit, false)) => format!("{}; {exists}", self.sized("a filter", limit)),
        }
    }

    /// Filter with a D15F of at most this (mm) and at least the D15F that drains the base.
    fn sized(&self, filter: &str, most: f64) -> String {
        let rule = self.decision.applied(PERMEABILITY);
        let (mut drains, mut dry) = (String::new(), None);
        if let Some((limit, rule)) = rule.and_then(|rule| Some((rule.limit?, rule))) {
            let least = least_length(limit, self.unit);
            if limit <= most {
                drains = format!(" and at least {least}");
            } else if !rule.limit_at_most {
                // A limit known only by an upper bound may be lower, and perhaps allowed.
                dry = Some(format!("drainage asks for at least {least}: compare permeabilities"));
            }
        }
        let beside = self.beside_dispersive(most).into_iter().chain(dry).collect::<Vec<_>>().join("; ");
        let beside = if beside.is_empty() { beside } else { format!(" ({beside})") };
        format!("take {filter} with D15F at most {}{beside}{drains}", greatest_length(most, self.unit))
    }

    /// Limit of a dispersive base beside a recommended D15F (mm).
    fn beside_dispersive(&self, most: f64) -> Option<String> {
        beside_dispersive(self.decision.if_dispersive?, most, self.unit)
    }

    /// Maximum D15F (mm) that every rule of retention allows, and true if the actual limit is lower and
    /// unknown.
    fn greatest(&self) -> Option<(f64, bool)> {
        self.decision.strictest().map(|(_, limit)| (limit, self.decision.is_strictest_open))
    }

    fn drainage(&self) -> Option<String> {
        let limit = |of_size: bool| {
            let mut broken = self.decision.broken(RuleRole::Drainage);
            broken.find_map(|rule| rule.limit.filter(|_| (rule.quantity == RuleQuantity::D15F) == of_size))
        };
        let (least, fines) = (limit(true), limit(false));
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

    /// Advice on a filter whose fines were not sieved.
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

    /// Data missing to judge drainage.
    fn missing_drainage(&self) -> Option<String> {
        let need = self.decision.applied(PERMEABILITY).filter(|rule| rule.met.is_none())?.needs.first()?;
        missing(*need).map(|need| format!("get {need}: drainage is not known"))
    }
}

/// Fines allowed in a filter after placing.
fn few_fines(most: f64) -> String {
    format!("at most {most} % finer than {FINES_MM} mm in place")
}

/// Reason why a class is undecided, in a sentence without its end.
pub(crate) fn undecided_by(cause: UndecidedBy) -> &'static str {
    match cause {
        UndecidedBy::Curve => {
            "the constriction curve is known within a range only, and its ends do not give one class"
        }
        UndecidedBy::SecondRun => {
            "some and continuing erosion differ by the second run, and only a first was asked for"
        }
        UndecidedBy::Replicates => {
            "the replicates do not separate the classes; more replicates may decide it"
        }
    }
}

pub(crate) fn capital(text: &str) -> String {
    let mut chars = text.chars();
    chars.next().map_or(String::new(), |c| c.to_uppercase().chain(chars).collect())
}

/// Meaning of a class in a sentence, for runs with these means.
pub(crate) fn meaning(verdict: Verdict, summary: &[RunSummary], threshold: f64) -> String {
    let limit = format!("{}\u{202f}%", (1e4 * threshold).round() / 1e2);
    match verdict {
        Verdict::None => format!(
            "In the model the filter holds this base: less than {limit} of its mass passes in the first run."
        ),
        Verdict::Some => format!(
            "In the model the filter seals after some erosion: {limit} or more of the base passes in the \
             first run, less in the second, on the constrictions that the first left blocked."
        ),
        Verdict::Continuing => format!(
            "In the model the filter does not hold this base: {limit} or more of its mass passes in the \
             first run and again in the second."
        ),
        Verdict::Undecided => undecided(summary, threshold, &limit),
    }
}

fn undecided(summary: &[RunSummary], threshold: f64, limit: &str) -> String {
    let straddles = |run: &&RunSummary| {
        let eroded = &run.eroded_mass_fraction;
        eroded.low.is_some_and(|low| low < threshold) && eroded.high.is_some_and(|high| threshold <= high)
    };
    let name = |run: &RunSummary| if run.run == 1 { "first run" } else { "second run" };
    let runs: Vec<&str> = summary.iter().filter(straddles).map(name).collect();
    if !runs.is_empty() {
        let plural = if runs.len() > 1 { "intervals of the " } else { "interval of the " };
        return format!("Inconclusive: the {plural}{} includes {limit}.", runs.join(" and the "));
    }
    let by = match summary {
        [first] if first.eroded_mass_fraction.mean >= threshold => undecided_by(UndecidedBy::SecondRun),
        _ => "these replicates do not separate the classes",
    };
    format!("Inconclusive: {by}.")
}

/// Look in one line, for a verdict with `wanted` replicates; `None` for one replicate, which says nothing
/// about scatter.
pub(crate) fn so_far(look: &FirstLook, wanted: u64) -> Option<String> {
    let runs = look.eroded.iter().zip(["first run", "second run"]).map(|(statistic, run)| {
        Some(format!("{run} {:.1} to {:.1} %", 100.0 * statistic.low?, 100.0 * statistic.high?))
    });
    let runs = runs.collect::<Option<Vec<String>>>()?.join(", ");
    let (replicates, class) = (look.replicates, look.class.words());
    Some(format!(
        "after {replicates} of {wanted} replicates, not yet final: {class}; {runs} of the mass eroded"
    ))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_interim_look_states_its_replicates_and_intervals() {
        use crate::outcome::verdict::SoFar;
        let mut walked = SoFar::default();
        for (replicate, eroded) in [(1, 0.31), (2, 0.33), (3, 0.32)] {
            walked.add(replicate, 1, eroded, false);
        }
        let words = walked.look(1).and_then(|look| so_far(&look, 10)).unwrap();
        assert!(words.starts_with("after 3 of 10 replicates, not yet final: undecided; first run 29.5"));
    }
}
