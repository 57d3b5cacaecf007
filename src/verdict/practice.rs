//! What the rules of filter practice say of a pair: findings where they speak against its class, and where
//! the filter stands by all of them.

use super::entry::Finding;
use super::finding;
use super::rule_words::{
    against, bounded, credit, first_clause, is_of_dispersive, listed, met_of, size, without_margin,
};
use super::tested::tested;
use super::washout::washout;
use crate::outcome::comparison::ComparedStanding;
use crate::outcome::design::band::retaining;
use crate::outcome::record::{AppliedRule, LimitOfDesign, Practice, RuleQuantity, RuleRole, Verdict};
use crate::outcome::rules::{DESIGN, PAPER_NO_EROSION, TESTS_CONTINUING, TESTS_NO_EROSION, authority};

/// Said where the rule of drainage has no result.
pub(super) const DRAINAGE_UNKNOWN: &str = "drainage not known";

/// The rules of a role that were made for these soils and are not kept.
pub(super) fn broken(rules: &[AppliedRule], role: RuleRole) -> Vec<&AppliedRule> {
    match role {
        RuleRole::Retention => retaining(rules).filter(|rule| rule.is_broken()).collect(),
        _ => rules.iter().filter(|rule| rule.is_broken() && rule.role == role).collect(),
    }
}

/// What rules that are not kept say of a class. What several authors say alike is one finding, and rules of
/// retention that agree with the class say nothing: the line of practice has them.
pub fn findings(verdict: Verdict, rules: &[AppliedRule]) -> Vec<Finding> {
    let of_role = |role| rules.iter().filter(move |rule| rule.role == role && rule.is_broken());
    let each = [RuleRole::Retention, RuleRole::Continuation].into_iter().flat_map(of_role);
    // One number is one finding, and of a filter that practice does not call too coarse its line has the tests.
    let counts = without_margin(rules).is_none() && !broken(rules, RuleRole::Retention).is_empty();
    let each = each.filter(|rule| rule.id != TESTS_NO_EROSION || counts);
    let mut all: Vec<Finding> = each.map(of_rule).filter(|of| of.is_against(verdict)).collect();
    let list = |rules: &[&AppliedRule], one: fn(&AppliedRule) -> String| {
        listed(&rules.iter().map(|rule| one(rule)).collect::<Vec<_>>())
    };
    let unstable = broken(rules, RuleRole::Stability);
    if !unstable.is_empty() {
        all.push(finding::loses_fines(&list(&unstable, |rule| {
            let [value, limit] = against(rule, 3);
            format!("{} ({} {}, limit {limit})", authority(rule), rule.quantity, bounded(rule, &value))
        })));
    }
    all.extend(drainage(rules));
    let placing = broken(rules, RuleRole::Placing);
    if !placing.is_empty() {
        all.push(finding::may_segregate(&list(&placing, asked)));
    }
    all.extend(stricter(verdict, rules));
    all
}

fn of_rule(rule: &AppliedRule) -> Finding {
    let [value, limit] = against(rule, 3);
    let limit = limit + if rule.limit_at_most { " at most" } else { "" };
    match (rule.id.as_str(), rule.role) {
        (DESIGN | TESTS_NO_EROSION, _) if is_of_dispersive(rule) => {
            finding::rule_of_retention(rule.quantity.name(), &limit, &value, credit(rule))
        }
        (DESIGN, _) => finding::limit_of_design(&limit, &value),
        (TESTS_NO_EROSION, _) => finding::tests_no_erosion(&limit, &value),
        (TESTS_CONTINUING, _) => finding::tests_continuing(&limit, &value),
        (_, RuleRole::Continuation) => {
            finding::rule_of_continuation(rule.quantity.name(), &limit, &value, authority(rule))
        }
        _ => finding::rule_of_retention(rule.quantity.name(), &limit, &value, authority(rule)),
    }
}

/// A quantity, and what practice asks for.
fn asked(rule: &AppliedRule) -> String {
    let [value, limit] = against(rule, 3);
    let allowed = if rule.at_least { "at least" } else { "up to" };
    format!("{} is {}, and practice asks for {allowed} {limit}", rule.quantity, bounded(rule, &value))
}

fn drainage(rules: &[AppliedRule]) -> Vec<Finding> {
    let too_fine = too_fine(rules).map(|[value, asked]| finding::too_fine_to_drain(&value, &asked));
    too_fine.into_iter().chain(too_many_fines(rules).map(|fines| finding::fines_of_filter(&fines))).collect()
}

/// Rules of drainage that are not kept: of D15F, and of anything else.
fn undrained(rules: &[AppliedRule]) -> (Vec<&AppliedRule>, Vec<&AppliedRule>) {
    let all = broken(rules, RuleRole::Drainage).into_iter();
    all.partition(|rule| rule.quantity == RuleQuantity::D15F)
}

/// D15F of a filter that is too fine to drain, and what practice asks for.
fn too_fine(rules: &[AppliedRule]) -> Option<[String; 2]> {
    let (of_size, _) = undrained(rules);
    let first = *of_size.first()?;
    let [value, limit] = against(first, 3);
    let value = bounded(first, &value);
    let least = of_size.get(1).map_or(String::new(), |least| {
        format!(", and EM 1110-2-1901 for {} at the least", against(least, 3)[1])
    });
    Some([value, format!("USBR and NRCS ask for {limit} or more{least}")])
}

/// What practice asks of the fines of a filter that has too many to drain.
fn too_many_fines(rules: &[AppliedRule]) -> Option<String> {
    let (_, of_fines) = undrained(rules);
    let all: Vec<String> = of_fines.into_iter().map(asked).collect();
    (!all.is_empty()).then(|| listed(&all))
}

/// Whether the walk is stricter than tests for this pair: they found no erosion where it has some.
fn stricter(verdict: Verdict, rules: &[AppliedRule]) -> Option<Finding> {
    let find = |id: &str| rules.iter().find(|rule| rule.id == id && rule.applies);
    let tests = find(TESTS_NO_EROSION).filter(|rule| rule.met == Some(true))?;
    let ratio = find(PAPER_NO_EROSION).filter(|rule| rule.met == Some(false))?;
    matches!(verdict, Verdict::Some | Verdict::Continuing).then(|| {
        let [value, holds] = [ratio.value, ratio.limit].map(|number| size(number, ""));
        finding::stricter_than_tests(&value, &size(tests.limit, &tests.unit), &holds)
    })
}

/// The limit of design of a pair, for programs; `None` where its rule is not among them.
pub fn record(rules: &[AppliedRule]) -> Option<Practice> {
    let rule = rules.iter().find(|rule| rule.id == DESIGN)?;
    Some(Practice {
        design: LimitOfDesign {
            rule: rule.id.clone(),
            limit_mm: rule.limit,
            limit_at_most: rule.limit_at_most,
            value_mm: rule.value,
            met: rule.met,
        },
        foster_fell: tested(rules),
    })
}

/// Where a filter stands by practice, the worst first.
#[derive(Clone, Debug, PartialEq)]
pub enum Standing {
    /// A rule of retention or of coarser filters is not kept, and no test held either.
    Fails,
    /// No test speaks against it as placed, and it breaks a limit without the finer part that it may lose.
    WashedOut,
    /// The limit of design is not kept, but such a filter is within the boundary of no erosion of tests.
    NoMargin,
    /// It keeps the limits, but may lose its own fines.
    Unstable,
    /// The limit of design has no result: what is missing.
    Unknown(String),
    /// A result hangs on sizes between two sieves that stand far apart: which.
    Open(String),
    /// The limit of design is kept.
    Met,
    /// No rule of design was applied.
    NoRules,
}

impl Standing {
    /// Whether practice is not met, and no test held such a filter.
    pub fn fails(&self) -> bool {
        matches!(self, Self::Fails | Self::WashedOut)
    }

    /// The same as a record keeps it.
    pub fn recorded(&self) -> ComparedStanding {
        match self {
            Self::Fails | Self::WashedOut => ComparedStanding::Fails,
            Self::NoMargin => ComparedStanding::NoMargin,
            Self::Unstable => ComparedStanding::Unstable,
            Self::Unknown(_) | Self::Open(_) => ComparedStanding::Unknown,
            Self::Met => ComparedStanding::Met,
            Self::NoRules => ComparedStanding::NoRules,
        }
    }
}

/// The sizes between two sieves that stand far apart, on which the limit of design or the stability of the
/// filter hangs.
fn open_sieves(rules: &[AppliedRule]) -> Option<String> {
    let counts = |rule: &&AppliedRule| {
        [DESIGN, TESTS_CONTINUING].contains(&&*rule.id) || rule.role == RuleRole::Stability
    };
    let open = rules.iter().filter(counts).filter(|rule| rule.applies && rule.met.is_none());
    open.filter_map(|rule| rule.needs.of_sieves_between()).next()
}

/// Where the filter of a pair stands.
pub fn standing(rules: &[AppliedRule]) -> Standing {
    let Some(design) = rules.iter().find(|rule| rule.id == DESIGN && rule.applies) else {
        return Standing::NoRules;
    };
    let mut retention = broken(rules, RuleRole::Retention);
    if met_of(rules, TESTS_NO_EROSION) == Some(true) {
        // Terzaghi's ratio is the limit of design of a sand.
        retention.clear();
    }
    let fails = !retention.is_empty() || !broken(rules, RuleRole::Continuation).is_empty();
    let open = open_sieves(rules);
    match design.met {
        _ if fails => Standing::Fails,
        _ if washout(rules).is_some() => Standing::WashedOut,
        Some(false) => Standing::NoMargin,
        _ if !broken(rules, RuleRole::Stability).is_empty() => Standing::Unstable,
        _ if open.is_some() => Standing::Open(open.unwrap_or_default()),
        Some(true) => Standing::Met,
        None => {
            let needs = first_clause(&design.needs.to_string());
            Standing::Unknown(needs.strip_prefix("needs ").map_or("the limit of design", |of| of).to_owned())
        }
    }
}

/// 0 no erosion, 1 some, 2 continuing; `None` where it is undecided.
pub(super) fn severity(verdict: Verdict) -> Option<u8> {
    match verdict {
        Verdict::None => Some(0),
        Verdict::Some => Some(1),
        Verdict::Continuing => Some(2),
        Verdict::Undecided => None,
    }
}
