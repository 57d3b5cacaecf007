//! `voidwalk check` on the plan of a campaign: a forecast of its cases.

use std::fmt::Write;
use std::path::Path;

use super::args::SettingArgs;
use super::print::{as_it_is, counted, json, plain, to_copy, to_stdout, whole};
use crate::case::in_words;
use crate::cases::{self, CaseOptions, CasePlan, PlanCheck};
use crate::run::cost::duration;
use crate::run::{PrepareOptions, RunError};
use voidwalk_core::store::format;

/// No more cases are listed.
const LISTED: usize = 20;

/// Prints a forecast of the cases of a plan, and the mistakes in each.
///
/// # Errors
/// A plan that cannot be read, settings beside it, and its cases that are wrong.
pub(super) fn check_plan(path: &Path, set: &SettingArgs) -> Result<(), RunError> {
    if !set.settings.assignments.is_empty() {
        return Err(RunError::refused(
            "settings go with a scene: a plan has those of all its cases under [set]",
        ));
    }
    let plan = CasePlan::read(path)?;
    // If no folder of packings is named, a campaign keeps them in its own.
    let is_named = set.packings != PrepareOptions::default().packings;
    let packings = is_named.then(|| set.packings.clone());
    let options = CaseOptions { packings, memory: set.memory, ..CaseOptions::default() };
    let check = cases::check_plan(&plan, &options)?;
    if set.json {
        as_it_is(&json(format::PLAN_CHECK, &check)?);
    } else {
        to_stdout(&words(&check));
    }
    check.refusal().map_or(Ok(()), Err)
}

fn words(check: &PlanCheck) -> String {
    let mut text = String::new();
    // Writing to a string cannot fail.
    let mut line = |name: &str, value: String| {
        let _ = writeln!(text, "{name:<22}{}", plain(&value));
    };
    let title = if check.title.is_empty() { String::new() } else { format!(": {}", check.title) };
    line("plan", format!("{}{title}", check.plan));
    let factors = match check.factors.is_empty() {
        true => String::new(),
        false => format!(", factors {}", check.factors.join(", ")),
    };
    line("cases", format!("{}{factors}", check.cases.len()));
    for case in check.cases.iter().take(LISTED) {
        let forecast = match case.problem.is_empty() {
            true => format!(
                "{} base particles a run, {} runs, {}, about {}",
                whole(case.n_base),
                whole(case.runs_to_walk),
                in_words(case.bytes),
                duration(case.core_seconds)
            ),
            false => format!("cannot be walked: {}", case.problem.replace('\n', " ")),
        };
        line(&format!("  {}", case.case), format!(" {forecast}"));
    }
    if check.cases.len() > LISTED {
        line("", format!("and {} more: --json has all", check.cases.len() - LISTED));
    }
    let runs = check.cases.iter().map(|case| case.runs_to_walk).sum();
    line("to walk", format!("{} runs", whole(runs)));
    line(
        "memory",
        format!(
            "{} for the largest case, {} for as many cases as are walked at once ({}), of {}",
            in_words(check.bytes),
            in_words(check.bytes_at_once),
            check.cases_at_once,
            in_words(check.bytes_allowed)
        ),
    );
    if check.packings > 0 {
        let made = check.packings - check.packings_to_make;
        let packings = counted(check.packings, "packing", "packings");
        line("packings", format!("{packings} of filters, {made} made already"));
        line(
            "time to pack",
            format!("about {} of one core, a rough guess", duration(check.packing_core_seconds)),
        );
    }
    line(
        "time to walk",
        format!("about {} of one core for all, a rough guess", duration(check.core_seconds)),
    );
    let wrong = check.cases.iter().filter(|case| !case.problem.is_empty()).count();
    if wrong == 0 {
        line("next", format!("voidwalk campaign {}", to_copy(&check.plan)));
    }
    text
}
