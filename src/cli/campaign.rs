//! `voidwalk campaign`: the cases of a plan, by as many processes as are started on its folder.

use std::collections::BTreeMap;
use std::fmt::Write;
use std::io::IsTerminal;
use std::path::Path;
use std::sync::Mutex;
use std::sync::atomic::AtomicBool;
use std::time::{Duration, Instant};

use indicatif::{ProgressBar, ProgressStyle};

use super::Ending;
use super::args::CampaignArgs;
use super::pack::provide;
use super::print::{percent, plain, to_stderr, to_stdout};
use super::run::{command_line, pool, refuse_other_kinds, refused_or_failed};
use super::signals::stop_on_signals;
use crate::campaign::case::{Case, CaseError, Room};
use crate::campaign::conduct::{ConductError, Overseer, Ready, conduct};
use crate::campaign::ledger;
use crate::campaign::machine::Machine;
use crate::campaign::packed::{Order, PackedFilter};
use crate::campaign::plan::{Plan, PlannedCase};
use crate::outcome::ledger::{Campaign, LedgerLine};
use crate::outcome::record::Verdict;
use crate::report;
use crate::store::Folder;

/// Plain lines come at most this often.
const BETWEEN_LINES: Duration = Duration::from_secs(2);

/// Walks a plan's cases and collects what came of them.
pub fn campaign(args: &CampaignArgs) -> Result<(), Ending> {
    let plan = Plan::read(&args.plan).map_err(Ending::refused)?;
    let wanted = wanted(&plan, args.case.as_deref())?;
    let orders = check(&wanted)?;
    if args.list {
        to_stdout(&wanted.iter().map(|case| plain(&case.name) + "\n").collect::<String>());
        return Ok(());
    }
    let stop = stop_on_signals()?;
    let pool = pool(args.threads)?;
    let threads = pool.current_num_threads();
    let out = Folder::open_shared(&args.out).map_err(refused_or_failed)?;
    refuse_other_kinds(&out, "campaign")?;
    let packings = args.packings.clone().unwrap_or_else(|| args.out.join("packings"));
    let packed = pack(&orders, &packings, args.quiet, &pool, &stop)?;
    let ready = |case: &&'_ PlannedCase| worked_out(case, packed.get(&case.name).cloned());
    let mut cases: Vec<Ready> =
        wanted.iter().map(|case| Ok(Ready::new(case, ready(case)?))).collect::<Result<_, Ending>>()?;
    let room = Room::new(args.memory, Machine::here().available, out.path());
    for ready in &mut cases {
        let placed = ready.case.place(&room, threads as u64, out.path());
        placed.map_err(|e| refuse(ready.planned, &e))?;
    }
    let progress = Progress::new(args.quiet, &cases, out.path());
    let overseer = Overseer {
        tell: &|case, line| progress.tell(case, line),
        finish: &|folder| report::write(folder).map(drop).map_err(|e| e.to_string()),
        stop: &stop,
        keep_every: args.checkpoint_every,
        job: job(),
        command: command_line(),
    };
    let result = conduct(&cases, out.path(), threads, &overseer);
    progress.finish();
    if args.case.is_none() || result.is_err() {
        // The whole plan is collected, whichever of its cases this process was at.
        let lines = keep(&plan, &cases, out.path(), args.case.is_some())?;
        if result.is_ok() && lines.len() < cases.len() && args.case.is_none() {
            let problem = format!("{} cases are missing from the ledger", cases.len() - lines.len());
            return Err(Ending::failed(format!("{problem}: another plan is at work on this folder")));
        }
        if result.is_ok() && !args.quiet {
            to_stdout(&summary(&lines, out.path()));
        }
    }
    result.map_err(|error| match error {
        ConductError::Stopped => Ending::stopped(format!(
            "what is done is kept; the same command goes on from {}",
            plain(&out.path().display().to_string())
        )),
        other => Ending::failed(plain(&other.to_string())),
    })
}

/// The cases that this process is to see to.
fn wanted<'a>(plan: &'a Plan, name: Option<&str>) -> Result<Vec<&'a PlannedCase>, Ending> {
    let Some(name) = name else { return Ok(plan.cases.iter().collect()) };
    match plan.case(name) {
        Some(case) => Ok(vec![case]),
        None => {
            let nearest = plan
                .cases
                .iter()
                .min_by_key(|case| strsim::damerau_levenshtein(&case.name, name))
                .map_or("", |case| &case.name);
            Err(Ending::refused(plain(&format!(
                "{}: there is no case `{name}`; did you mean `{nearest}`?",
                plan.file
            ))))
        }
    }
}

fn refuse(case: &PlannedCase, error: &CaseError) -> Ending {
    Ending::refused(plain(&format!("case {}: {error}", case.name)))
}

/// Works out every case before any work is done, with guesses for filters that are to be packed; gives those filters.
fn check<'a>(wanted: &[&'a PlannedCase]) -> Result<Vec<(&'a str, Order)>, Ending> {
    let mut orders = Vec::new();
    for case in wanted {
        let mut stand_in = None;
        if let Some(recipe) = &case.scene.recipe {
            let order = Order::new(recipe).map_err(|e| refuse(case, &e))?;
            stand_in = Some(PackedFilter::stand_in(&order).map_err(Ending::refused)?);
            orders.push((case.name.as_str(), order));
        }
        worked_out(case, stand_in)?;
    }
    Ok(orders)
}

fn worked_out(case: &PlannedCase, packed: Option<PackedFilter>) -> Result<Case, Ending> {
    Case::with_packed(case.scene.clone(), packed).map_err(|e| refuse(case, &e))
}

/// Packs every filter that is asked for, each once.
fn pack(
    orders: &[(&str, Order)],
    packings: &Path,
    quiet: bool,
    pool: &rayon::ThreadPool,
    stop: &AtomicBool,
) -> Result<BTreeMap<String, PackedFilter>, Ending> {
    let mut made: BTreeMap<String, PackedFilter> = BTreeMap::new();
    let mut by_case = BTreeMap::new();
    for (case, order) in orders {
        let key = format!("{} {}", order.fingerprint(), order.merge_overlap);
        let filter = match made.get(&key) {
            Some(filter) => filter.clone(),
            None => {
                let filter = pool.install(|| provide(order, packings, quiet, stop))?;
                made.insert(key, filter.clone());
                filter
            }
        };
        by_case.insert((*case).to_string(), filter);
    }
    Ok(by_case)
}

/// Job and task, where a cluster's scheduler says so.
fn job() -> Option<String> {
    let job = std::env::var("SLURM_JOB_ID").ok()?;
    let task = std::env::var("SLURM_ARRAY_TASK_ID").map_or(String::new(), |task| format!("_{task}"));
    Some(format!("{job}{task}"))
}

/// Collects what is done into the campaign's folder.
fn keep(plan: &Plan, cases: &[Ready], out: &Path, part: bool) -> Result<Vec<LedgerLine>, Ending> {
    let (lines, missing) = ledger::collect(cases, out);
    if part {
        return Ok(lines);
    }
    let about = Campaign {
        title: plan.title.clone(),
        plan: plan.file.clone(),
        factors: plan.factors.clone(),
        cases: cases.len() as u64,
        missing,
    };
    ledger::write(out, &about, &lines).map_err(Ending::failed)?;
    report::write_campaign(out).map_err(Ending::failed)?;
    Ok(lines)
}

/// Progress over cases.
enum Progress {
    Quiet,
    Bar(ProgressBar),
    Lines { total: usize, begun: Instant, done: Mutex<(usize, usize, Instant)> },
}

impl Progress {
    fn new(quiet: bool, cases: &[Ready], out: &Path) -> Self {
        if quiet {
            return Self::Quiet;
        }
        let (total, done) = (cases.len(), cases.iter().filter(|case| case.line(out).is_some()).count());
        if done > 0 {
            to_stderr(&format!("{done} of {total} cases are done already\n"));
        }
        if std::io::stderr().is_terminal() {
            let bar = ProgressBar::new(total as u64);
            let style = "{bar:30} {pos}/{len} cases, {elapsed} gone, about {eta} to go  {msg}";
            bar.set_style(
                ProgressStyle::with_template(style).unwrap_or_else(|_| ProgressStyle::default_bar()),
            );
            bar.set_position(done as u64);
            bar.reset_eta();
            bar.enable_steady_tick(Duration::from_millis(200));
            return Self::Bar(bar);
        }
        let now = Instant::now();
        Self::Lines { total, begun: now, done: Mutex::new((done, done, now)) }
    }

    fn tell(&self, case: &str, line: Option<&LedgerLine>) {
        match (self, line) {
            (Self::Quiet, _) | (Self::Lines { .. }, None) => {}
            (Self::Bar(bar), None) => bar.set_message(plain(case)),
            (Self::Bar(bar), Some(_)) => bar.inc(1),
            (Self::Lines { total, begun, done }, Some(line)) => {
                let Ok(mut done) = done.lock() else { return };
                done.1 += 1;
                if done.1 < *total && done.2.elapsed() < BETWEEN_LINES {
                    return;
                }
                done.2 = Instant::now();
                let gone = begun.elapsed().as_secs_f64();
                let left = gone / (done.1 - done.0) as f64 * total.saturating_sub(done.1) as f64;
                to_stderr(&format!(
                    "{} of {total} cases, {gone:.0} s gone, about {left:.0} s to go; {}: {}\n",
                    done.1,
                    plain(case),
                    line.verdict.words()
                ));
            }
        }
    }

    fn finish(&self) {
        if let Self::Bar(bar) = self {
            bar.finish_and_clear();
        }
    }
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
