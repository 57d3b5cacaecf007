//! `voidwalk compare`: filters on one base, bases on one filter, or scenes, side by side.

use std::fmt::Write;
use std::path::Path;

use super::args::{CompareArgs, SettingArgs, WalkArgs};
use super::case_progress::CaseProgress;
use super::exit::{JudgedAnswer, accept};
use super::print::{as_it_is, grains_per_void, json, of_base, percent, plain, shown, to_stderr, to_stdout};
use super::run::command_line;
use crate::campaign::{CampaignOptions, CasePart};
use crate::outcome::comparison::{ComparedCase, Comparison};
use crate::outcome::quantity::SizeUnit;
use crate::run::RunError;
use crate::store::format;
use crate::study::compare::{self, ComparePlan, Compared};
use crate::words::comparison::{difference, not_in_intervals};
use crate::words::left_out::left_out_line;
use crate::words::{FOREMOST, lines_of, sentence};

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
    let quiet = args.walk.quiet;
    let plan = ComparePlan::new(&args.compared(), &args.tables.options()?)?;
    let options = campaign_options(&args.out, &args.tables.set, &args.walk);
    let comparison = walked(&plan, &options, args.overwrite, quiet)?;
    if args.tables.set.json {
        as_it_is(&json(format::COMPARISON, &comparison)?);
    } else if !quiet {
        show(&plan, &comparison, &args.out);
    }
    let answer = |case: &ComparedCase| JudgedAnswer { model: case.verdict, practice: case.by_practice };
    accept(args.accept.fail_on, comparison.cases.iter().map(|case| (case.name.as_str(), answer(case))))
}

/// How cases are walked that options of the command line describe.
pub(super) fn campaign_options(out: &Path, set: &SettingArgs, walk: &WalkArgs) -> CampaignOptions {
    CampaignOptions {
        out: out.to_owned(),
        part: CasePart::All,
        packings: Some(set.packings.clone()),
        memory: set.memory,
        threads: walk.threads,
        checkpoint_interval: walk.checkpoint_every.unwrap_or_default(),
        command: command_line(),
    }
}

/// Walks the cases of a plan, and compares them.
pub(super) fn walked(
    plan: &ComparePlan,
    options: &CampaignOptions,
    overwrite: bool,
    quiet: bool,
) -> Result<Comparison, RunError> {
    if plan.seeds_differed && !quiet {
        to_stderr(&format!("the scenes' seeds differ; all are walked with seed {}\n", plan.seed));
    }
    let progress = CaseProgress::new(quiet, false);
    progress.followed(|callbacks| compare::run(plan, options, overwrite, callbacks))
}

/// Prints a comparison that lies in this folder.
pub(super) fn show(plan: &ComparePlan, comparison: &Comparison, out: &Path) {
    let constrictions = plan.constrictions_in_words().into_iter().map(|said| plain(&said) + "\n");
    to_stdout(&constrictions.collect::<String>());
    to_stdout(&words(comparison));
    to_stdout(&of_earlier_cover(plan.with_other_cover(out)));
    to_stdout(&format!("report: {}\n", shown(&out.join("compare.html"))));
}

/// That so many walks were kept with the cover of an earlier call, in a line; nothing where none was.
pub(super) fn of_earlier_cover(walks: usize) -> String {
    match walks {
        0 => String::new(),
        1 => "1 walk was kept from an earlier call; its own page has the cover of that call\n".into(),
        _ => format!(
            "{walks} walks were kept from an earlier call; their own pages have the cover of that call\n"
        ),
    }
}

fn words(comparison: &Comparison) -> String {
    let mut text = String::new();
    // Writing to a string cannot fail.
    let mut line = |said: String| {
        let _ = writeln!(text, "{}", plain(&said));
    };
    for case in &comparison.cases {
        line(format!("{}:", case.name));
        for (name, words) in lines_of(
            case.headline,
            case.practice.as_ref(),
            &case.model,
            SizeUnit::of(case.scale_free, comparison.inches),
        ) {
            line(format!("  {name}: {words}"));
        }
        line(format!(
            "  D15F/D85B {:.2}{}, {}",
            case.ratios.d15f_over_d85b,
            of_base(case.base),
            grains_per_void(case.grains_per_void)
        ));
        case.notes.iter().take(FOREMOST).for_each(|note| {
            line(format!("  - {}", sentence(note, SizeUnit::of(case.scale_free, comparison.inches))))
        });
        if case.notes.len() > FOREMOST {
            line(format!("  - and {} more on the page", case.notes.len() - FOREMOST));
        }
        for ([low, high], run) in case.curve_range.iter().zip(["first", "second"]) {
            let (low, high) = (percent(*low), percent(*high));
            line(format!("  {run} run over the range of the constriction curve: {low} to {high}"));
        }
    }
    comparison.pairs.iter().for_each(|pair| line(difference(pair)));
    if let Some(what) = not_in_intervals(comparison) {
        line(format!("Not in these intervals: {what}"));
    }
    line(left_out_line(&comparison.model_leaves_out));
    text
}
