//! `voidwalk campaign --slurm`, `--collect` and `--make-packing`: a plan on a cluster.

use std::path::Path;

use super::{filters, keep, named, open, packings, summary, work_out};
use crate::campaign::cluster::scripts::{FOLDER, Jobs, Need, TASK_S, duration};
use crate::campaign::cluster::{locks, tasks};
use crate::campaign::plan::{Plan, PlannedCase};
use crate::campaign::run_cases::{Failed, PreparedCase, State};
use crate::case::{PackedFilter, PackingPlan};
use crate::cli::Exit;
use crate::cli::args::CampaignArgs;
use crate::cli::pack::read;
use crate::cli::print::{plain, to_stderr, to_stdout};
use crate::store::{make_folder, write_whole};

/// Processors of a task, where the user does not say.
const PROCESSORS: u64 = 4;

/// Share of a task's processors that walks keep busy.
const BUSY: f64 = 0.7;

/// Seconds to read a packing and measure its constrictions, and to collect a case.
const PACKING_S: f64 = 5.0;
const COLLECT_S: f64 = 0.05;

/// Bytes that collecting takes: at the least, and a case.
const COLLECT_BYTES: (u64, u64) = (100_000_000, 100_000);

/// The packings that a plan needs, each once, in the order of its cases.
fn distinct<'a>(orders: &'a [(&str, PackingPlan)]) -> Vec<&'a PackingPlan> {
    let mut all: Vec<&PackingPlan> = Vec::new();
    for (_, order) in orders {
        if !all.iter().any(|other| other.fingerprint() == order.fingerprint()) {
            all.push(order);
        }
    }
    all
}

/// Packing `number` of a plan, counted from 1.
pub fn packing<'a>(orders: &'a [(&str, PackingPlan)], number: u64) -> Result<&'a PackingPlan, Exit> {
    let all = distinct(orders);
    let found = usize::try_from(number - 1).ok().and_then(|index| all.get(index).copied());
    found.ok_or_else(|| Exit::refused(format!("there is no packing {number}: the plan needs {}", all.len())))
}

/// Writes the job scripts for the cases that are not done.
pub fn write_scripts(args: &CampaignArgs, plan: &Plan, orders: &[(&str, PackingPlan)]) -> Result<(), Exit> {
    let out = open(&args.out)?;
    let processors = args.threads.map_or(PROCESSORS, u64::from);
    let places = packings(args);
    let (mut unmade, mut largest) = (0, Need { seconds: 0.0, bytes: 0 });
    for order in distinct(orders) {
        if read(&places.join(order.folder_name()), order)?.is_none() {
            unmade += 1;
        }
        largest.seconds = largest.seconds.max(order.core_seconds());
        largest.bytes = largest.bytes.max(order.program_bytes());
    }
    let (packed, failed) = filters(orders, |order| match read(&places.join(order.folder_name()), order)? {
        Some(filter) => Ok(filter),
        None => PackedFilter::placeholder(order).map_err(Exit::refused),
    })?;
    let wanted: Vec<&PlannedCase> = plan.cases.iter().collect();
    let (mut cases, failed) = work_out(&wanted, &packed, failed, |case| {
        case.memory = args.memory.unwrap_or(u64::MAX);
        Ok(())
    });
    if !failed.is_empty() {
        return Err(Exit::refused(named(&failed)));
    }
    cases.retain(|ready| ready.line(out.path()).is_none());
    if cases.is_empty() {
        to_stdout(&format!(
            "All {} cases are done: --collect instead of --slurm writes the ledger and the page\n",
            plan.cases.len()
        ));
        return Ok(());
    }
    let seconds: Vec<f64> =
        cases.iter().map(|ready| ready.case.core_seconds() / (processors as f64 * BUSY)).collect();
    let wished = args.tasks.map_or((seconds.iter().sum::<f64>() / TASK_S).ceil() as usize, usize::from);
    let bundles = tasks::bundle(&seconds, wished);
    let measuring = if orders.is_empty() { 0.0 } else { PACKING_S };
    let need = |bundle: &Vec<usize>| Need {
        seconds: bundle.iter().map(|case| seconds[*case] + measuring).sum(),
        bytes: memory(&cases, bundle, processors, args.memory).max(largest.bytes),
    };
    let walk = bundles.iter().map(need).fold(Need { seconds: 0.0, bytes: 0 }, |most, need| Need {
        seconds: most.seconds.max(need.seconds),
        bytes: most.bytes.max(need.bytes),
    });
    let n = plan.cases.len();
    let mut options = Vec::new();
    if args.packings.is_some() {
        let absolute = std::path::absolute(&places).unwrap_or(places);
        options.extend(["--packings".to_owned(), absolute.display().to_string()]);
    }
    let collecting = options.clone();
    options.extend(["--checkpoint-every".to_owned(), args.checkpoint_every.to_string()]);
    options.extend(args.memory.iter().flat_map(|bytes| ["--memory".to_owned(), bytes.to_string()]));
    let program = std::env::current_exe().map_err(Exit::failed)?;
    let jobs = Jobs {
        program: &program,
        plan: &args.plan,
        out: out.path(),
        options,
        collecting,
        processors,
        packings: (if unmade > 0 { distinct(orders).len() } else { 0 }, largest),
        tasks: bundles.iter().map(|b| b.iter().map(|i| cases[*i].planned.name.as_str()).collect()).collect(),
        walk,
        collect: Need {
            seconds: n as f64 * (COLLECT_S + measuring),
            bytes: largest.bytes.max(COLLECT_BYTES.0 + n as u64 * COLLECT_BYTES.1),
        },
    };
    let files = jobs.files().map_err(|e| Exit::refused(plain(&e.to_string())))?;
    let folder = out.path().join(FOLDER);
    make_folder(&folder).map_err(Exit::failed)?;
    for (name, text) in &files {
        write_whole(&folder.join(name), text.as_bytes()).map_err(Exit::failed)?;
    }
    if let Some(warning) = locks::warning(out.path()) {
        to_stderr(&format!("warning: {}\n", plain(&warning)));
    }
    to_stdout(&told(&jobs, n - cases.len(), &folder));
    Ok(())
}

/// Memory of a task that walks these cases.
fn memory(cases: &[PreparedCase], bundle: &[usize], processors: u64, asked: Option<u64>) -> u64 {
    let of_bundle = || bundle.iter().map(|case| &cases[*case].case);
    let fewest = of_bundle().map(|case| case.scene.walk.replicates).min().unwrap_or(1).max(1);
    let side_by_side = processors.div_ceil(fewest).min(bundle.len() as u64);
    let largest = of_bundle().map(|case| case.peak_bytes(processors)).max().unwrap_or(0);
    let walks = largest.saturating_mul(side_by_side).min(asked.unwrap_or(u64::MAX));
    of_bundle().map(|case| case.program_bytes(walks)).max().unwrap_or(walks)
}

fn told(jobs: &Jobs, done: usize, folder: &Path) -> String {
    let cases: usize = jobs.tasks.iter().map(Vec::len).sum();
    let mut lines = Vec::new();
    if done > 0 {
        lines.push(format!("{done} cases are done already"));
    }
    if jobs.packings.0 > 0 {
        lines.push(format!(
            "{} packings first, the longest about {}",
            jobs.packings.0,
            duration(jobs.packings.1.seconds)
        ));
    }
    lines.push(format!(
        "{cases} cases in {} tasks, the longest about {}; asked for a task: processors {}, memory {} MB, time {} min",
        jobs.tasks.len(),
        duration(jobs.walk.seconds),
        jobs.processors,
        jobs.walk.megabytes(),
        jobs.walk.minutes()
    ));
    lines.push("Submit them (options of sbatch may follow, as --partition=NAME):".into());
    lines.push(format!("  sh {}", quoted_if_needed(&folder.join("submit.sh").display().to_string())));
    lines.iter().map(|line| plain(line) + "\n").collect()
}

/// A path that can be pasted into a shell.
fn quoted_if_needed(path: &str) -> String {
    match path.chars().all(|c| c.is_ascii_alphanumeric() || "/._-+=,:@".contains(c)) {
        true => path.to_owned(),
        false => format!("'{}'", path.replace('\'', "'\\''")),
    }
}

/// Writes ledger, table and page of a campaign that is whole.
pub fn collect(args: &CampaignArgs, plan: &Plan, orders: &[(&str, PackingPlan)]) -> Result<(), Exit> {
    let shown = plain(&args.out.display().to_string());
    if !args.out.join("cases").is_dir() {
        return Err(Exit::refused(format!(
            "{shown}: holds no cases of a campaign; nothing of the plan has been walked here"
        )));
    }
    let out = open(&args.out)?;
    let places = packings(args);
    let (packed, failed) = filters(orders, |order| {
        let there = read(&places.join(order.folder_name()), order)?;
        there.ok_or_else(|| Exit::failed("not begun: its filter has not been packed"))
    })?;
    let wanted: Vec<&PlannedCase> = plan.cases.iter().collect();
    let (cases, mut missing) = work_out(&wanted, &packed, failed, |_| Ok(()));
    for ready in cases.iter().filter(|ready| ready.line(out.path()).is_none()) {
        let problem = match State::of(ready, out.path()) {
            State::NotBegun => "not begun".to_owned(),
            State::Walking(holder) => format!("being walked ({holder})"),
            State::Kept => "stopped or killed; its checkpoints are kept".to_owned(),
            State::Failed(problem) => format!("could not be walked: {problem}"),
        };
        missing.push(Failed { case: ready.planned.name.clone(), problem });
    }
    if !missing.is_empty() {
        return Err(Exit::refused(format!(
            "{shown}: {} of {} cases are missing, nothing is written; submit the campaign again to go on\n{}",
            missing.len(),
            plan.cases.len(),
            named(&missing)
        )));
    }
    let lines = keep(plan, &cases, out.path())?;
    if !args.quiet {
        to_stdout(&summary(&lines, out.path()));
    }
    Ok(())
}
