//! Command `voidwalk campaign`: the cases of a plan, walked by any number of processes in one folder.

use super::args::CampaignArgs;
use super::print::{grains_per_void, percent, plain, shown, to_copy, to_stdout};
use super::progress::{CaseProgress, followed, unfollowed};
use super::run::{START, command_line};
use crate::cases;
use crate::cases::{CaseOptions, CasePart, CasePlan, JobOptions, WrittenJobs};
use crate::outcome::ledger;
use crate::outcome::ledger::LedgerLine;
use crate::outcome::record::Verdict;
use crate::run::RunError;
use crate::run::cost::duration;
use crate::run::machine::Allocation;
use crate::words::ledger::thickness as thickness_words;
use crate::words::left_out::left_out_line;
use std::fmt::Write;
use std::path::Path;

/// Maximum number of cases named in a summary.
const SHOWN: usize = 20;

impl CampaignArgs {
    fn options(&self) -> CaseOptions {
        CaseOptions {
            out: self.out.clone(),
            part: match (&self.case, &self.task) {
                (Some(name), _) => CasePart::Named(name.clone()),
                (None, task) => task.clone().unwrap_or_default(),
            },
            packings: self.packings.clone(),
            memory: self.memory,
            threads: self.walk.threads,
            checkpoint_interval: self.walk.checkpoint_every.unwrap_or_default(),
            command: command_line(),
        }
    }
}

/// Walks a plan's cases and collects their results, or does the requested part of this work.
pub(crate) fn campaign(args: &CampaignArgs) -> Result<(), RunError> {
    let (plan, options, quiet) = (CasePlan::read(&args.plan)?, args.options(), args.walk.quiet);
    if args.list {
        let names = cases::names(&plan, &options.part)?;
        to_stdout(&names.iter().map(|name| plain(name) + "\n").collect::<String>());
        return Ok(());
    }
    if args.slurm {
        return write_scripts(args, &plan, &options);
    }
    if let Some(number) = args.make_packing {
        return followed(quiet, |run| cases::make_packing(&plan, number, &options, run));
    }
    let (lines, problem) = if args.collect {
        (Some(cases::collect(&plan, &options, &unfollowed())?), None)
    } else {
        let progress = CaseProgress::new(quiet, Allocation::here().is_some());
        let finished = progress.followed(|callbacks| cases::run(&plan, &options, callbacks))?;
        let problem = finished.problem();
        (finished.lines, problem)
    };
    if let Some(lines) = lines.filter(|_| !quiet) {
        to_stdout(&words(&lines, &args.out));
    }
    problem.map_or(Ok(()), Err)
}

fn words(lines: &[LedgerLine], out: &Path) -> String {
    let mut text = String::new();
    for verdict in [Verdict::None, Verdict::Some, Verdict::Continuing, Verdict::Undecided] {
        let count = lines.iter().filter(|line| line.verdict == verdict).count();
        if count > 0 {
            // Writing to a string cannot fail.
            let _ = writeln!(text, "{count:>5}  {}", verdict.words());
        }
    }
    for line in lines.iter().filter(|_| lines.len() <= SHOWN) {
        let eroded: Vec<String> =
            line.runs.iter().map(|run| percent(run.eroded_mass_fraction.mean).to_string()).collect();
        let eroded = eroded.join(" then ");
        let (case, verdict) = (plain(&line.case), line.verdict.words());
        let _ = writeln!(text, "{case}: {verdict}, {eroded} of the mass eroded");
        let _ = writeln!(text, "  {}; {}", thickness(line), grains_per_void(line.grains_per_void));
    }
    if lines.len() > SHOWN {
        let same = lines.iter().all(|line| line.thickness == lines[0].thickness);
        let line =
            if same { thickness(&lines[0]) } else { "modelled filter thickness: see cases.csv".into() };
        let _ = writeln!(text, "{line}");
    }
    let _ = writeln!(text, "{}", left_out_line(&ledger::leaves_out(lines)));
    let seconds: f64 = lines.iter().map(|line| line.made.seconds).sum();
    let page = shown(&out.join("report.html"));
    let time = format!("{seconds:.1} s from start to end of each, beside other cases");
    let _ = writeln!(text, "{} cases, {time}; report: {page}", lines.len());
    text
}

fn thickness(line: &LedgerLine) -> String {
    format!("modelled filter thickness: {}", thickness_words(&line.thickness))
}

fn write_scripts(args: &CampaignArgs, plan: &CasePlan, options: &CaseOptions) -> Result<(), RunError> {
    let (program, words) = match START.get().and_then(|start| start.again.as_deref()) {
        Some([program, words @ ..]) => (program.into(), words.to_vec()),
        _ => (std::env::current_exe().map_err(RunError::failed)?, Vec::new()),
    };
    let jobs = JobOptions { program, words, plan: args.plan.clone(), tasks: args.tasks.map(usize::from) };
    let written = cases::write_job_scripts(plan, options, &jobs, &unfollowed())?;
    to_stdout(&jobs_in_words(&written));
    Ok(())
}

fn jobs_in_words(jobs: &WrittenJobs) -> String {
    if jobs.cases == 0 {
        return format!(
            "All {} cases are done: --collect instead of --slurm writes the ledger and the page\n",
            jobs.done
        );
    }
    let mut lines = Vec::new();
    if jobs.done > 0 {
        lines.push(format!("{} cases are done already", jobs.done));
    }
    let (packings, largest) = jobs.packings;
    if packings > 0 {
        let longest = duration(largest.seconds);
        lines.push(format!("{packings} packings first, the longest about {longest}"));
    }
    lines.push(format!(
        "{} cases in {} tasks, the longest about {}; requested per task: processors {}, memory {} MB, \
         time {} min",
        jobs.cases,
        jobs.tasks,
        duration(jobs.walk.seconds),
        jobs.processors,
        jobs.walk.megabytes(),
        jobs.walk.minutes()
    ));
    lines.push("Submit them (options of sbatch may follow, as --partition=NAME):".into());
    lines.push(format!("  sh {}", to_copy(&jobs.submit)));
    lines.iter().map(|line| plain(line) + "\n").collect()
}
