//! `voidwalk campaign`: the cases of a plan, by as many processes as are started on its folder.

mod cluster;
mod progress;

use std::collections::{BTreeMap, BTreeSet};
use std::fmt::Write;
use std::path::{Path, PathBuf};
use std::sync::atomic::AtomicBool;

use super::Exit;
use super::args::CampaignArgs;
use super::pack::provide;
use super::print::{percent, plain, to_stdout};
use super::run::{command_line, pool, refuse_other_kinds, refused_or_failed};
use super::signals::stop_on_signals;
use crate::campaign::cluster::tasks;
use crate::campaign::ledger;
use crate::campaign::plan::{Plan, PlannedCase};
use crate::campaign::run_cases::{CampaignCallbacks, CampaignError, Failed, PreparedCase, run_cases};
use crate::case::{Case, CaseError, ResourceLimits};
use crate::case::{PackedFilter, PackingPlan};
use crate::outcome::ledger::{Campaign, LedgerLine};
use crate::outcome::record::Verdict;
use crate::report;
use crate::run::allocation::Allocation;
use crate::run::machine::Machine;
use crate::store::{Folder, StoreError};
use progress::Progress;

/// A message names no more cases than this.
const NAMED: usize = 30;

/// Walks a plan's cases and collects what came of them.
pub fn campaign(args: &CampaignArgs) -> Result<(), Exit> {
    let plan = Plan::read(&args.plan).map_err(Exit::refused)?;
    let wanted = wanted(&plan, args)?;
    let orders = check(&wanted)?;
    if args.list {
        to_stdout(&wanted.iter().map(|case| plain(&case.name) + "\n").collect::<String>());
        return Ok(());
    }
    if args.slurm {
        return cluster::write_scripts(args, &plan, &orders);
    }
    if args.collect {
        return cluster::collect(args, &plan, &orders);
    }
    let stop = stop_on_signals()?;
    let pool = pool(args.threads)?;
    let threads = pool.current_num_threads();
    let out = open(&args.out)?;
    if let Some(number) = args.make_packing {
        let (order, packings) = (cluster::packing(&orders, number)?, packings(args));
        return pool.install(|| provide(order, &packings, args.quiet, &stop)).map(drop);
    }
    let (packed, unpacked) = pack(&orders, args, &pool, &stop)?;
    let room = ResourceLimits::new(args.memory, Machine::here().available, out.path());
    let (cases, mut failed) =
        work_out(&wanted, &packed, unpacked, |case| case.place(&room, threads as u64, out.path()));
    if cases.is_empty() && orders.is_empty() {
        return Err(Exit::refused(named(&failed)));
    }
    let allocation = Allocation::here();
    let progress = Progress::new(args.quiet, &cases, out.path(), allocation.is_some());
    let overseer = CampaignCallbacks {
        tell: &|case, news| progress.tell(case, news),
        finish: &|folder| report::write(folder).map(drop).map_err(|e| e.to_string()),
        stop: &stop,
        keep_every: args.checkpoint_every,
        job: allocation.map(|allocation| allocation.job),
        command: command_line(),
    };
    let result = run_cases(&cases, out.path(), threads, &overseer);
    progress.finish();
    let is_whole = args.case.is_none() && args.task.is_none();
    if is_whole {
        // The whole plan is collected, whichever of its cases this process was at.
        let lines = keep(&plan, &cases, out.path())?;
        if result.is_ok() && !args.quiet {
            to_stdout(&summary(&lines, out.path()));
        }
    }
    failed.extend(result.map_err(|error| match error {
        CampaignError::Stopped => Exit::stopped(format!(
            "what is done is kept; the same command goes on from {}",
            plain(&out.path().display().to_string())
        )),
        other => Exit::failed(plain(&other.to_string())),
    })?);
    if failed.is_empty() {
        return Ok(());
    }
    let of = wanted.len();
    let counted =
        format!("{} of {of} {} could not be walked", failed.len(), if of == 1 { "case" } else { "cases" });
    let others = if failed.len() < of { "; the others are done" } else { "" };
    Err(Exit::failed(format!("{counted}{others}\n{}", named(&failed))))
}

/// The campaign's folder, with whoever else works in it.
fn open(out: &Path) -> Result<Folder, Exit> {
    let folder = Folder::open_shared(out).map_err(|error| match &error {
        StoreError::Io { action: "lock the folder", .. } => Exit::refused(plain(&format!(
            "{error}: this file system has no locks, by which cases are claimed; name a folder on another one"
        ))),
        _ => refused_or_failed(error),
    })?;
    refuse_other_kinds(&folder, "campaign")?;
    Ok(folder)
}

/// Folder of the packings.
fn packings(args: &CampaignArgs) -> PathBuf {
    args.packings.clone().unwrap_or_else(|| args.out.join("packings"))
}

/// The cases that this process is to see to.
fn wanted<'a>(plan: &'a Plan, args: &CampaignArgs) -> Result<Vec<&'a PlannedCase>, Exit> {
    if let Some((file, number)) = &args.task {
        let shown = file.display().to_string();
        let text =
            std::fs::read_to_string(file).map_err(|e| Exit::refused(plain(&format!("{shown}: {e}"))))?;
        let names = tasks::read(&shown, &text, *number).map_err(|e| Exit::refused(plain(&e.to_string())))?;
        let find = |name: &&str| {
            plan.case(name).ok_or_else(|| {
                let problem = "the plan was changed; write the scripts again";
                Exit::refused(plain(&format!("{shown}: {} has no case `{name}`: {problem}", plan.file)))
            })
        };
        return names.iter().map(find).collect();
    }
    let Some(name) = args.case.as_deref() else { return Ok(plan.cases.iter().collect()) };
    match plan.case(name) {
        Some(case) => Ok(vec![case]),
        None => {
            let nearest = plan
                .cases
                .iter()
                .min_by_key(|case| strsim::damerau_levenshtein(&case.name, name))
                .map_or("", |case| &case.name);
            Err(Exit::refused(plain(&format!(
                "{}: there is no case `{name}`; did you mean `{nearest}`?",
                plan.file
            ))))
        }
    }
}

fn refuse(case: &PlannedCase, error: &CaseError) -> Exit {
    Exit::refused(plain(&format!("case {}: {error}", case.name)))
}

/// Names the cases that are not done, one a line.
fn named(failed: &[Failed]) -> String {
    let mut lines: Vec<String> = failed
        .iter()
        .take(NAMED)
        .map(|failed| plain(&format!("case {}: {}", failed.case, failed.problem)))
        .collect();
    if failed.len() > NAMED {
        lines.push(format!("and {} more", failed.len() - NAMED));
    }
    lines.join("\n")
}

/// Works out every case before any work is done, with guesses for filters that are to be packed; gives those filters.
fn check<'a>(wanted: &[&'a PlannedCase]) -> Result<Vec<(&'a str, PackingPlan)>, Exit> {
    let mut orders = Vec::new();
    for case in wanted {
        let mut placeholder = None;
        if let Some(order) = PackingPlan::of(&case.scene).map_err(|e| refuse(case, &e))? {
            placeholder = Some(PackedFilter::placeholder(&order).map_err(Exit::refused)?);
            orders.push((case.name.as_str(), order));
        }
        Case::with_packed(case.scene.clone(), placeholder).map_err(|e| refuse(case, &e))?;
    }
    Ok(orders)
}

/// The filters of cases, each worked out once; and the cases whose filter could not be had.
fn filters(
    orders: &[(&str, PackingPlan)],
    mut of: impl FnMut(&PackingPlan) -> Result<PackedFilter, Exit>,
) -> Result<(BTreeMap<String, PackedFilter>, Vec<Failed>), Exit> {
    let mut made: BTreeMap<String, Result<PackedFilter, String>> = BTreeMap::new();
    let (mut by_case, mut failed) = (BTreeMap::new(), Vec::new());
    for (case, order) in orders {
        let key = format!("{} {}", order.fingerprint(), order.merge_overlap);
        if !made.contains_key(&key) {
            let filter = match of(order) {
                Err(ending) if ending.code == 3 => return Err(ending),
                other => other.map_err(|ending| ending.message),
            };
            made.insert(key.clone(), filter);
        }
        match &made[&key] {
            Ok(filter) => drop(by_case.insert((*case).to_string(), filter.clone())),
            Err(problem) => failed.push(Failed { case: (*case).to_string(), problem: problem.clone() }),
        }
    }
    Ok((by_case, failed))
}

/// Packs every filter that is asked for.
fn pack(
    orders: &[(&str, PackingPlan)],
    args: &CampaignArgs,
    pool: &rayon::ThreadPool,
    stop: &AtomicBool,
) -> Result<(BTreeMap<String, PackedFilter>, Vec<Failed>), Exit> {
    let packings = packings(args);
    filters(orders, |order| pool.install(|| provide(order, &packings, args.quiet, stop)))
}

/// The cases with their filters, and those that cannot be walked.
fn work_out<'a>(
    wanted: &[&'a PlannedCase],
    packed: &BTreeMap<String, PackedFilter>,
    mut failed: Vec<Failed>,
    mut place: impl FnMut(&mut Case) -> Result<(), CaseError>,
) -> (Vec<PreparedCase<'a>>, Vec<Failed>) {
    let mut cases = Vec::new();
    for planned in wanted {
        if failed.iter().any(|failed| failed.case == planned.name) {
            continue;
        }
        let case = Case::with_packed(planned.scene.clone(), packed.get(&planned.name).cloned());
        match case.and_then(|mut case| place(&mut case).map(|()| case)) {
            Ok(case) => cases.push(PreparedCase::new(planned, case)),
            Err(error) => failed.push(Failed { case: planned.name.clone(), problem: error.to_string() }),
        }
    }
    (cases, failed)
}

/// Collects what is done into the campaign's folder.
fn keep(plan: &Plan, cases: &[PreparedCase], out: &Path) -> Result<Vec<LedgerLine>, Exit> {
    let lines = ledger::collect(cases, out).map_err(Exit::failed)?;
    let there: BTreeSet<&str> = lines.iter().map(|line| line.case.as_str()).collect();
    let is_missing = |case: &&PlannedCase| !there.contains(case.name.as_str());
    let about = Campaign {
        title: plan.title.clone(),
        plan: plan.file_name(),
        factors: plan.factors.clone(),
        cases: plan.cases.len() as u64,
        missing: plan.cases.iter().filter(is_missing).map(|case| case.name.clone()).collect(),
    };
    ledger::write(out, &about, &lines).map_err(Exit::failed)?;
    report::write_campaign(out).map_err(Exit::failed)?;
    Ok(lines)
}

fn summary(lines: &[LedgerLine], out: &Path) -> String {
    let mut text = String::new();
    for verdict in [Verdict::None, Verdict::Some, Verdict::Continuing, Verdict::Undecided] {
        let count = lines.iter().filter(|line| line.verdict == verdict).count();
        if count > 0 {
            // Writing to a string cannot fail.
            let _ = writeln!(text, "{count:>5}  {}", verdict.words());
        }
    }
    const SHOWN: usize = 20;
    for line in lines.iter().take(if lines.len() <= SHOWN { SHOWN } else { 0 }) {
        let eroded: Vec<String> =
            line.runs.iter().map(|run| percent(run.eroded_mass_fraction.mean)).collect();
        let _ = writeln!(
            text,
            "{}: {}, {} of the mass eroded",
            plain(&line.case),
            line.verdict.words(),
            eroded.join(" then ")
        );
    }
    let seconds: f64 = lines.iter().map(|line| line.made.seconds).sum();
    let _ = writeln!(
        text,
        "{} cases, {seconds:.1} s of walks; report: {}",
        lines.len(),
        plain(&out.join("report.html").display().to_string())
    );
    text
}
