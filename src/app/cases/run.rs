//! Walks a plan, collects it, and makes one of its packings.

use std::collections::BTreeSet;
use std::path::{Path, PathBuf};

use rayon::prelude::*;

use super::changed;
use super::ledger;
use super::plan::{CasePlan, PlannedCase};
use super::prepared::{CASES, CasePart, CaseState, Drafts, FailedCase, PreparedCase, named, wanted};
use super::walk::{CaseCallbacks, CaseRunner, LOST};
use crate::case::{PackedFilter, PackingPlan, ResourceLimits};
use crate::outcome::ledger::LedgerLine;
use crate::run::allocation::Allocation;
use crate::run::callbacks::Callbacks;
use crate::run::checkpoints::CheckpointInterval;
use crate::run::error::RunError;
use crate::run::folder::{FolderKind, claim, shown};
use crate::run::machine::{on_threads, threads};
use crate::run::pack::provide;
use crate::run::prepare::{Draft, PrepareOptions};
use crate::run::replicates::have_networks;
use crate::run::shared_networks::SharedNetworks;

/// Options of walking a campaign; no setting changes a result.
#[derive(Clone, Debug)]
pub struct CaseOptions {
    /// Folder for the results, which several processes may share.
    pub out: PathBuf,
    /// Which cases this process sees to.
    pub part: CasePart,
    /// Folder in which the packings of filters are kept; `packings` in `out` without one.
    pub packings: Option<PathBuf>,
    /// Memory that the walks may take (bytes); 80 % of the available memory without it.
    pub memory: Option<u64>,
    /// Worker threads; by default the number that a cluster's job has, else one per core.
    pub threads: Option<usize>,
    /// Interval between saves of a case that is being walked.
    pub checkpoint_interval: CheckpointInterval,
    /// Command in a case's `manifest.json` that started it.
    pub command: String,
}

impl Default for CaseOptions {
    fn default() -> Self {
        Self {
            out: "voidwalk-campaign".into(),
            part: CasePart::All,
            packings: None,
            memory: None,
            threads: None,
            checkpoint_interval: CheckpointInterval::default(),
            command: String::new(),
        }
    }
}

impl CaseOptions {
    /// Folder of the packings; the campaign's own must not be a link to one elsewhere, which would then be
    /// written to.
    pub(super) fn packings(&self) -> Result<PathBuf, RunError> {
        if let Some(packings) = &self.packings {
            return Ok(packings.clone());
        }
        let path = self.out.join("packings");
        match path.symlink_metadata() {
            Ok(meta) if meta.is_symlink() => {
                let problem = "is a symbolic link, which is not followed; name that folder by --packings";
                Err(RunError::Refused(format!("{}: {problem}", shown(&path))))
            }
            _ => Ok(path),
        }
    }

    /// The filter of a packing that exists.
    pub(super) fn packed(&self, plan: &PackingPlan) -> Result<Option<PackedFilter>, RunError> {
        Ok(PackedFilter::find(&self.packings()?, plan)?)
    }
}

/// True if any two cases have one seed, and so may share networks.
pub(super) fn have_common_seeds(cases: &[&PlannedCase]) -> bool {
    let seeds: BTreeSet<u64> = cases.iter().map(|case| case.scene.walk.seed).collect();
    seeds.len() < cases.len()
}

/// Limits of a case within the available resources, and the room for networks that cases share.
pub(super) fn rooms(mut limits: ResourceLimits, share_networks: bool) -> (ResourceLimits, Option<u64>) {
    let shared = share_networks.then(|| SharedNetworks::bytes(limits.memory));
    limits.memory -= shared.unwrap_or(0);
    (limits, shared)
}

/// A campaign of which this process has done its part.
pub struct FinishedCases {
    /// Finished cases in the order of the plan; `None` if this process handled only a part of it.
    pub lines: Option<Vec<LedgerLine>>,
    /// Cases that could not be walked.
    pub failed: Vec<FailedCase>,
    /// Number of cases that were handled.
    pub cases: usize,
}

impl FinishedCases {
    /// Error that tells the user of cases that could not be walked.
    pub fn problem(&self) -> Option<RunError> {
        let (failed, all) = (self.failed.len(), self.cases);
        if failed == 0 {
            return None;
        }
        let counted =
            format!("{failed} of {all} {} could not be walked", if all == 1 { "case" } else { "cases" });
        let others = if failed < all { "; the others are done" } else { "" };
        Some(RunError::failed(format!("{counted}{others}\n{}", named(&self.failed))))
    }
}

/// The names of the cases that a process would walk, each found sound.
///
/// # Errors
/// There is no such part of the plan; a case that is wrong.
pub fn names(plan: &CasePlan, part: &CasePart) -> Result<Vec<String>, RunError> {
    let wanted = wanted(plan, part)?;
    let names = wanted.iter().map(|case| case.name.clone()).collect();
    Drafts::new(wanted).map(|_| names)
}

/// Walks the cases of a plan that are not done, packing their filters first, and collects the whole plan.
/// Several processes may work at once; each waits for cases that others have begun.
///
/// # Errors
/// A plan or case that is wrong and a folder that cannot be claimed are refused before any work; then errors
/// that concern all cases. Errors of single cases are in [`FinishedCases::failed`]. After a stop, the same
/// call continues.
pub fn run(
    plan: &CasePlan,
    options: &CaseOptions,
    callbacks: &CaseCallbacks,
) -> Result<FinishedCases, RunError> {
    run_around(plan, options, callbacks, |_, walk| walk())
}

/// Finds the cases sound and placed, as far as that is known before their filters are packed; claims and
/// writes nothing.
///
/// # Errors
/// The cases that are wrong, or that do not fit the memory.
pub fn check(plan: &CasePlan, options: &CaseOptions) -> Result<(), RunError> {
    let failed = unsound(plan, options)?;
    if failed.is_empty() { Ok(()) } else { Err(RunError::Refused(named(&failed))) }
}

/// The cases that are wrong in themselves, in the order of the plan; claims and writes nothing.
///
/// # Errors
/// Cases that are sound and do not fit the memory.
pub fn unsound(plan: &CasePlan, options: &CaseOptions) -> Result<Vec<FailedCase>, RunError> {
    let prepare = PrepareOptions { memory: options.memory, ..PrepareOptions::default() };
    let wanted = wanted(plan, &options.part)?;
    let (limits, _) = rooms(prepare.limits(&options.out), have_common_seeds(&wanted));
    let pool = threads(options.threads)?;
    let workers = pool.current_num_threads() as u64;
    // Problem of a case; true if it is lack of room.
    let wrong = |planned: &PlannedCase| -> Option<(bool, FailedCase)> {
        let failed = |has_no_room: bool, problem: RunError| {
            (has_no_room, FailedCase { case: planned.name.clone(), problem: problem.to_string() })
        };
        let mut case = match Draft::new(planned.scene.clone()) {
            Ok(draft) => draft.case,
            Err(problem) => return Some(failed(false, problem)),
        };
        match case.place(&limits, workers, &options.out) {
            Err(problem) => Some(failed(true, problem.into())),
            Ok(_) => Some(failed(false, have_networks(&case, &Callbacks::default()).err()?)),
        }
    };
    let all: Vec<(bool, FailedCase)> = pool.install(|| wanted.into_par_iter().filter_map(wrong).collect());
    let (no_room, wrong): (Vec<_>, Vec<_>) = all.into_iter().partition(|(has_no_room, _)| *has_no_room);
    let cases =
        |problems: Vec<(bool, FailedCase)>| problems.into_iter().map(|(_, case)| case).collect::<Vec<_>>();
    match no_room.is_empty() {
        true => Ok(cases(wrong)),
        false => Err(RunError::Refused(named(&cases(no_room)))),
    }
}

/// Looks at the cases of a plan as far as they can be worked out without packing a filter: `None` if a filter
/// is still to be packed. Claims and writes nothing.
///
/// # Errors
/// A case that is wrong.
pub(crate) fn look<R>(
    plan: &CasePlan,
    options: &CaseOptions,
    at: impl FnOnce(Option<&[PreparedCase]>) -> R,
) -> Result<R, RunError> {
    let drafts = Drafts::new(wanted(plan, &options.part)?)?;
    let there =
        |packing: &PackingPlan| options.packed(packing)?.ok_or_else(|| RunError::failed("not packed"));
    let (cases, failed) = drafts.finish(there, |_| Ok(()))?;
    Ok(at(failed.is_empty().then_some(&cases[..])))
}

/// The cases of a campaign when their filters are packed and before the first is walked: all, or why not.
pub(crate) type ReadyCases<'a, 'b> = Result<&'b [PreparedCase<'a>], RunError>;

/// Walks the cases that are ready.
pub(crate) type Walk<'a> = Box<dyn FnOnce() -> Result<FinishedCases, RunError> + 'a>;

/// Walks a campaign like [`run()`], with the caller's work around the walk of the cases once all are ready.
pub(crate) fn run_around<R>(
    plan: &CasePlan,
    options: &CaseOptions,
    callbacks: &CaseCallbacks,
    around: impl FnOnce(ReadyCases, Walk) -> Result<R, RunError>,
) -> Result<R, RunError> {
    let wanted = wanted(plan, &options.part)?;
    let (count, share_networks) = (wanted.len(), have_common_seeds(&wanted));
    let drafts = Drafts::new(wanted)?;
    let pool = threads(options.threads)?;
    let threads = pool.current_num_threads();
    let folder = claim(&options.out, FolderKind::Campaign, false)?;
    let (out, packings, needs_none) = (folder.path(), options.packings()?, drafts.packings().is_empty());
    let prepare = PrepareOptions { packings, memory: options.memory, threads: options.threads };
    let (limits, shared) = rooms(prepare.limits(out), share_networks);
    let mut has_room = true;
    let (cases, failed) = drafts.finish(
        |packing| pool.install(|| provide(packing, &prepare.packings, &callbacks.run)),
        |case| {
            let placed = case.place(&limits, threads as u64, out);
            has_room &= placed.is_ok();
            Ok(placed?)
        },
    )?;
    let ready = match (failed.is_empty(), has_room) {
        (true, _) => Ok(&cases[..]),
        (false, true) => Err(RunError::failed(named(&failed))),
        (false, false) => Err(RunError::Refused(named(&failed))),
    };
    let walk = Box::new(|| {
        if cases.is_empty() && needs_none {
            return Err(RunError::Refused(named(&failed)));
        }
        let mut failed = failed;
        if options.part == CasePart::All {
            changed::sentences(plan, &cases, out).iter().for_each(|sentence| (callbacks.run.warn)(sentence));
        }
        (callbacks.on_cases)(cases.len(), cases.iter().filter(|case| case.line(out).is_some()).count());
        let runner = CaseRunner {
            out,
            threads,
            callbacks,
            checkpoint_interval: options.checkpoint_interval,
            networks: shared.map(SharedNetworks::new),
            job: Allocation::here().map(|allocation| allocation.job),
            command: options.command.clone(),
        };
        let result = runner.run(&cases);
        if options.part != CasePart::All {
            failed.extend(result?);
            return Ok(FinishedCases { lines: None, failed, cases: count });
        }
        // The whole plan is collected, whichever of its cases this process was at, and whatever has ended it.
        let mut lines = write_ledger(plan, &cases, out, &callbacks.run)?;
        failed.extend(result?);
        // Cases that were done, by this process or before, and are not there now.
        let absent = |lines: &[LedgerLine], failed: &[FailedCase]| -> Vec<&PreparedCase> {
            let is_absent = |case: &&PreparedCase| {
                let name = &case.planned.name;
                lines.iter().all(|line| line.case != *name) && failed.iter().all(|f| f.case != *name)
            };
            cases.iter().filter(is_absent).collect()
        };
        let mut gone = absent(&lines, &failed);
        if !gone.is_empty() {
            // Another process may be replacing their files with the same ones at this moment.
            for case in gone {
                runner.is_lost(case);
            }
            lines = write_ledger(plan, &cases, out, &callbacks.run)?;
            gone = absent(&lines, &failed);
        }
        let lost =
            gone.into_iter().map(|case| FailedCase { case: case.planned.name.clone(), problem: LOST.into() });
        let lost: Vec<FailedCase> = lost.collect();
        failed.extend(lost);
        let lines = Some(lines);
        Ok(FinishedCases { lines, failed, cases: count })
    });
    around(ready, walk)
}

/// Collects finished cases into the campaign's folder.
fn write_ledger(
    plan: &CasePlan,
    cases: &[PreparedCase],
    out: &Path,
    callbacks: &Callbacks,
) -> Result<Vec<LedgerLine>, RunError> {
    let dropped = ledger::of_other_plans(plan, out);
    if !dropped.is_empty() {
        (callbacks.warn)(&format!(
            "{}: the ledger of another plan was there, or of this one before it was changed: {} of its cases \
             are not in this plan and not in the new ledger ({}{}); their folders stay",
            shown(out),
            dropped.len(),
            dropped.iter().take(3).cloned().collect::<Vec<_>>().join(", "),
            if dropped.len() > 3 { ", ..." } else { "" }
        ));
    }
    let lines = ledger::collect(plan, cases, out)?;
    callbacks.results(FolderKind::Campaign, out, None)?;
    Ok(lines)
}

/// Collects a campaign whose cases are all done.
///
/// # Errors
/// A folder without cases; cases that are missing, each with its state. Nothing is written then.
pub fn collect(
    plan: &CasePlan,
    options: &CaseOptions,
    callbacks: &Callbacks,
) -> Result<Vec<LedgerLine>, RunError> {
    let drafts = Drafts::new(wanted(plan, &CasePart::All)?)?;
    let name = shown(&options.out);
    if !options.out.join(CASES).is_dir() {
        let problem = "holds no cases of a campaign; nothing of the plan has been walked here";
        return Err(RunError::Refused(format!("{name}: {problem}")));
    }
    let folder = claim(&options.out, FolderKind::Campaign, false)?;
    let not_packed = || RunError::failed("not begun: its filter has not been packed");
    let (cases, mut missing) =
        drafts.finish(|packing| options.packed(packing)?.ok_or_else(not_packed), |_| Ok(()))?;
    for case in cases.iter().filter(|case| case.line(folder.path()).is_none()) {
        let problem = match CaseState::of(case, folder.path()) {
            CaseState::NotBegun => "not begun".to_owned(),
            CaseState::Walking(holder) => format!("being walked ({holder})"),
            CaseState::Saved => "stopped or killed; its checkpoints are kept".to_owned(),
            CaseState::Failed(problem) => format!("could not be walked: {problem}"),
        };
        missing.push(FailedCase { case: case.planned.name.clone(), problem });
    }
    if !missing.is_empty() {
        return Err(RunError::Refused(format!(
            "{name}: {} of {} cases are missing, nothing is written; submit the campaign again to continue\n\
             {}",
            missing.len(),
            plan.cases.len(),
            named(&missing)
        )));
    }
    write_ledger(plan, &cases, folder.path(), callbacks)
}

/// Makes one of the packings that a plan needs, counted from 1 in the order of its cases.
///
/// # Errors
/// There is no such packing; then see `provide`.
pub fn make_packing(
    plan: &CasePlan,
    number: u64,
    options: &CaseOptions,
    callbacks: &Callbacks,
) -> Result<(), RunError> {
    let drafts = Drafts::new(wanted(plan, &CasePart::All)?)?;
    let _folder = claim(&options.out, FolderKind::Campaign, false)?;
    let all = drafts.packings();
    let packing = usize::try_from(number).ok().and_then(|number| all.get(number.checked_sub(1)?).copied());
    let packing = packing.ok_or_else(|| {
        RunError::refused(format!("there is no packing {number}: the plan needs {}", all.len()))
    })?;
    let packings = options.packings()?;
    on_threads(options.threads, || provide(packing, &packings, callbacks)).map(drop)
}
