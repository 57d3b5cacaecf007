//! `voidwalk compare`: filters on one base, bases on one filter, or scenes, side by side.

use std::fmt::Write;

use super::args::CompareArgs;
use super::case_progress::CaseProgress;
use super::exit::accept;
use super::print::{grains_per_void, json, of_base, percent, plain, shown, to_stderr, to_stdout};
use super::progress::followed;
use super::run::command_line;
use crate::campaign::{CampaignCallbacks, CampaignOptions, CasePart};
use crate::outcome::comparison::Comparison;
use crate::run::RunError;
use crate::store::format;
use crate::study::compare::{self, ComparePlan, Compared};
use crate::verdict::FOREMOST;
use crate::verdict::left_out::left_out_in_brief;

impl CompareArgs {
    fn compared(&self) -> Compared {
        let files = self.files.clone();
        match (&self.base, &self.filter) {
            (Some(base), _) => Compared::Filters { base: base.clone(), filters: files },
            (None, Some(filter)) => Compared::Bases { filter: filter.clone(), bases: files },
            (None, None) => Compared::Scenes(files),
        }
    }
}

/// Walks the cases, and compares them.
pub fn compare(args: &CompareArgs) -> Result<(), RunError> {
    walked(args, &planned(args)?)
}

/// What is compared.
///
/// # Errors
/// A case that is wrong.
pub(super) fn planned(args: &CompareArgs) -> Result<ComparePlan, RunError> {
    ComparePlan::new(&args.compared(), &args.tables.options()?)
}

/// The comparison that the folder holds already, as [`compare::found`] says.
///
/// # Errors
/// The same.
pub(super) fn found(args: &CompareArgs, plan: &ComparePlan) -> Result<Option<Comparison>, RunError> {
    compare::found(plan, &options(args))
}

fn options(args: &CompareArgs) -> CampaignOptions {
    CampaignOptions {
        out: args.out.clone(),
        part: CasePart::All,
        packings: Some(args.tables.set.packings.clone()),
        memory: args.tables.set.memory,
        threads: args.walk.threads,
        checkpoint_interval: args.walk.checkpoint_every.unwrap_or_default(),
        command: command_line(),
    }
}

/// Walks the cases of a plan, and compares them.
pub(super) fn walked(args: &CompareArgs, plan: &ComparePlan) -> Result<(), RunError> {
    let quiet = args.walk.quiet;
    if plan.seeds_differed && !quiet {
        to_stderr(&format!("the scenes' seeds differ; all are walked with seed {}\n", plan.seed));
    }
    let options = options(args);
    let progress = CaseProgress::new(quiet, false);
    let comparison = followed(quiet, |run| {
        let callbacks = CampaignCallbacks {
            run: *run,
            on_cases: &|total, done| progress.begin(total, done),
            on_case: &|case, event| progress.tell(case, event),
        };
        let done = compare::run(plan, &options, args.overwrite, &callbacks);
        progress.end();
        done
    })?;
    show(args, plan, &comparison)
}

/// Prints a comparison, and says whether it is accepted.
pub(super) fn show(args: &CompareArgs, plan: &ComparePlan, comparison: &Comparison) -> Result<(), RunError> {
    if args.tables.set.json {
        to_stdout(&json(format::COMPARISON, comparison)?);
    } else if !args.walk.quiet {
        let constrictions = plan.constrictions_in_words().into_iter().map(|said| plain(&said) + "\n");
        to_stdout(&constrictions.collect::<String>());
        to_stdout(&words(comparison));
        to_stdout(&format!("report: {}\n", shown(&args.out.join("compare.html"))));
    }
    let cases = comparison.cases.iter().map(|case| (case.name.as_str(), case.verdict, case.confidence));
    accept(args.accept.fail_on, cases)
}

fn words(comparison: &Comparison) -> String {
    let mut text = String::new();
    // Writing to a string cannot fail.
    let mut line = |said: String| {
        let _ = writeln!(text, "{}", plain(&said));
    };
    for case in &comparison.cases {
        line(format!("{}: {}", case.name, case.headline));
        line(format!("  Practice: {}", case.practice));
        line(format!("  Walk: {}", case.walk));
        line(format!("  Next: {}", case.next));
        if !case.by_authority.is_empty() {
            line(format!("  {}", case.by_authority));
        }
        line(format!(
            "  D15F/D85B {:.2}{}, {}",
            case.ratios.d15f_over_d85b,
            of_base(case.base),
            grains_per_void(case.grains_per_void)
        ));
        let found = || case.reasons.iter().chain(&case.beside);
        found().take(FOREMOST).for_each(|said| line(format!("  - {said}")));
        if found().count() > FOREMOST {
            line(format!("  - and {} more on the page", found().count() - FOREMOST));
        }
        for ([low, high], run) in case.curve_range.iter().zip(["first", "second"]) {
            let (low, high) = (percent(*low), percent(*high));
            line(format!("  {run} run over the range of the constriction curve: {low} to {high}"));
        }
    }
    comparison.pairs.iter().for_each(|pair| line(pair.sentence()));
    if let Some(what) = comparison.not_in_intervals() {
        line(format!("Not in these intervals: {what}"));
    }
    line(left_out_in_brief(&comparison.model_leaves_out));
    text
}
