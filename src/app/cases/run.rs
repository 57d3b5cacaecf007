//! Walks a plan, collects it, and makes one of its packings.

use std::collections::BTreeSet;
use std::path::{Path, PathBuf};

use rayon::prelude::*;

use super::plan::{CasePlan, PlannedCase};
use super::prepared::{CASES, CasePart, Drafts, FailedCase, LINE, PreparedCase, named, state, wanted};
use super::walk::{CaseCallbacks, CaseRunner, LOST};
use crate::case::{PackedFilter, PackingPlan, ResourceLimits};
use crate::outcome::ledger::{Campaign, LedgerLine};
use crate::run::RunError;
use crate::run::callbacks::Callbacks;
use crate::run::checkpoints::CheckpointInterval;
use crate::run::folder::{FolderKind, claim, refused, shown};
use crate::run::machine::{Allocation, on_threads, threads};
use crate::run::pack::provide;
use crate::run::prepare::{Draft, PrepareOptions};
use crate::run::replicates::have_networks;
use crate::run::results::json;
use crate::run::shared_networks::SharedNetworks;
use crate::words::ledger::columns;
use voidwalk_core::store::format::{self, from_json, visible_json};
use voidwalk_core::store::{Folder, files_in, read_whole, write_whole};

/// Options of walking a campaign; no option changes a result.
#[derive(Clone, Debug)]
pub struct CaseOptions {
    /// Folder for the results, which several processes may share.
    pub out: PathBuf,
    /// Cases that this process handles.
    pub part: CasePart,
    /// Folder of packed filters; by default `packings` in `out`.
    pub packings: Option<PathBuf>,
    /// Memory that the walks may take (bytes); by default 80 % of the available memory.
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
    pub(crate) fn of(out: PathBuf, prepare: PrepareOptions, command: String) -> Self {
        let PrepareOptions { packings, memory, threads } = prepare;
        Self { out, packings: Some(packings), memory, threads, command, ..Self::default() }
    }

    /// Folder of the packings. The campaign's own must not be a link to another place, which would then be
    /// written to.
    pub(super) fn packings(&self) -> Result<PathBuf, RunError> {
        if let Some(packings) = &self.packings {
            return Ok(packings.clone());
        }
        let path = self.out.join("packings");
        match path.symlink_metadata() {
            Ok(meta) if meta.is_symlink() => {
                let problem = "is a symbolic link, which is not followed; name that folder by --packings";
                Err(refused(&path, problem))
            }
            _ => Ok(path),
        }
    }

    pub(super) fn packed(&self, plan: &PackingPlan) -> Result<Option<PackedFilter>, RunError> {
        Ok(PackedFilter::find(&self.packings()?, plan)?)
    }

    /// Resource limits of one of these cases, and the room for networks, if cases share a seed.
    pub(super) fn rooms(&self, out: &Path, cases: &[&PlannedCase]) -> (ResourceLimits, Option<u64>) {
        let prepare = PrepareOptions { memory: self.memory, ..PrepareOptions::default() };
        let mut limits = prepare.limits(out);
        let seeds: BTreeSet<u64> = cases.iter().map(|case| case.scene.walk.seed).collect();
        let shared = (seeds.len() < cases.len()).then(|| SharedNetworks::bytes(limits.memory));
        limits.memory -= shared.unwrap_or(0);
        (limits, shared)
    }
}

/// Campaign after this process has done its part.
pub struct FinishedCases {
    /// Finished cases in the order of the plan; `None` if this process handled only part of the plan.
    pub(crate) lines: Option<Vec<LedgerLine>>,
    pub(crate) failed: Vec<FailedCase>,
    pub(crate) cases: usize,
}

impl FinishedCases {
    /// Error that names the cases that could not be walked.
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

/// Names of the cases that a process would walk, each found sound. Errors: the plan has no such part; a case
/// is wrong.
pub(crate) fn names(plan: &CasePlan, part: &CasePart) -> Result<Vec<String>, RunError> {
    let wanted = wanted(plan, part)?;
    Drafts::new(wanted.clone()).map(|_| wanted.iter().map(|case| case.name.clone()).collect())
}

/// Walks the unfinished cases of a plan, packing their filters first, and collects the whole plan. Several
/// processes may work at once; each waits for cases that others have begun.
///
/// # Errors
/// A wrong plan or case, or a folder that cannot be claimed, is refused before any work; then errors that
/// concern all cases. Errors of single cases are in `FinishedCases::failed`. After a stop, the same call
/// continues.
pub fn run(
    plan: &CasePlan,
    options: &CaseOptions,
    callbacks: &CaseCallbacks,
) -> Result<FinishedCases, RunError> {
    ReadyCampaign::new(plan, options, callbacks)?.walk()
}

/// Cases that are wrong in themselves, in the order of the plan; claims and writes nothing. Errors: sound
/// cases that do not fit into memory.
pub(crate) fn unsound(plan: &CasePlan, options: &CaseOptions) -> Result<Vec<FailedCase>, RunError> {
    let wanted = wanted(plan, &options.part)?;
    let (limits, _) = options.rooms(&options.out, &wanted);
    let pool = threads(options.threads)?;
    let workers = pool.current_num_threads() as u64;
    // Problem of a case; true if it is too little memory.
    let wrong = |planned: &PlannedCase| -> Option<(bool, FailedCase)> {
        let placed = Draft::new(planned.scene.clone()).map(|draft| draft.case).map(|mut case| {
            let placed = case.place(&limits, workers, &options.out);
            (case, placed)
        });
        let (has_no_room, problem) = match placed {
            Err(problem) => (false, problem),
            Ok((_, Err(problem))) => (true, problem.into()),
            Ok((case, Ok(_))) => (false, have_networks(&case, &Callbacks::default()).err()?),
        };
        Some((has_no_room, FailedCase::new(planned, problem)))
    };
    let all: Vec<(bool, FailedCase)> = pool.install(|| wanted.into_par_iter().filter_map(wrong).collect());
    let (no_room, wrong): (Vec<_>, Vec<_>) = all.into_iter().partition(|(has_no_room, _)| *has_no_room);
    let cases = |all: Vec<(bool, FailedCase)>| all.into_iter().map(|(_, case)| case).collect::<Vec<_>>();
    if no_room.is_empty() { Ok(cases(wrong)) } else { Err(RunError::Refused(named(&cases(no_room)))) }
}

/// Cases of a plan, if they can be worked out without packing a filter. Claims and writes nothing. Errors: a
/// case that is wrong.
pub(crate) fn without_packing<'a>(
    plan: &'a CasePlan,
    options: &CaseOptions,
) -> Result<Option<Vec<PreparedCase<'a>>>, RunError> {
    let drafts = Drafts::new(wanted(plan, &options.part)?)?;
    let there =
        |packing: &PackingPlan| options.packed(packing)?.ok_or_else(|| RunError::failed("not packed"));
    let (cases, failed) = drafts.finish(there, |_| Ok(()))?;
    Ok(failed.is_empty().then_some(cases))
}

/// Campaign in its claimed folder, after its filters are packed and before the first walk.
pub(crate) struct ReadyCampaign<'a> {
    plan: &'a CasePlan,
    options: &'a CaseOptions,
    callbacks: &'a CaseCallbacks<'a>,
    folder: Folder,
    threads: usize,
    /// Room for networks (bytes), if cases with one seed may share them.
    shared: Option<u64>,
    cases: Vec<PreparedCase<'a>>,
    failed: Vec<FailedCase>,
    /// True if no case failed for want of memory.
    has_room: bool,
    needs_packings: bool,
}

impl<'a> ReadyCampaign<'a> {
    /// Claims the folder and packs the filters. Errors: as in [`run()`].
    pub(crate) fn new(
        plan: &'a CasePlan,
        options: &'a CaseOptions,
        callbacks: &'a CaseCallbacks<'a>,
    ) -> Result<Self, RunError> {
        let wanted = wanted(plan, &options.part)?;
        let drafts = Drafts::new(wanted.clone())?;
        let pool = threads(options.threads)?;
        let threads = pool.current_num_threads();
        let folder = claim(&options.out, FolderKind::Campaign, false)?;
        let (packings, needs_packings) = (options.packings()?, !drafts.packings().is_empty());
        let (limits, shared) = options.rooms(folder.path(), &wanted);
        let mut has_room = true;
        let (cases, failed) = drafts.finish(
            |packing| pool.install(|| provide(packing, &packings, &callbacks.run)),
            |case| {
                let placed = case.place(&limits, threads as u64, folder.path());
                has_room &= placed.is_ok();
                Ok(placed?)
            },
        )?;
        Ok(Self {
            plan,
            options,
            callbacks,
            folder,
            threads,
            shared,
            cases,
            failed,
            has_room,
            needs_packings,
        })
    }

    /// All of its cases. Errors: some cannot be walked.
    pub(crate) fn cases(&self) -> Result<&[PreparedCase<'a>], RunError> {
        match (self.failed.is_empty(), self.has_room) {
            (true, _) => Ok(&self.cases),
            (false, true) => Err(RunError::failed(named(&self.failed))),
            (false, false) => Err(RunError::Refused(named(&self.failed))),
        }
    }

    /// Walks its unfinished cases and collects the plan. Errors: as in [`run()`].
    pub(crate) fn walk(&self) -> Result<FinishedCases, RunError> {
        let Self { plan, options, callbacks, cases, .. } = self;
        let out = self.folder.path();
        if cases.is_empty() && !self.needs_packings {
            return Err(RunError::Refused(named(&self.failed)));
        }
        let is_whole = options.part == CasePart::All;
        if is_whole {
            warn_of_changes(plan, cases, out, callbacks.run.warn);
        }
        (callbacks.on_cases)(cases.len(), cases.iter().filter(|case| case.line(out).is_some()).count());
        let runner = CaseRunner {
            out,
            threads: self.threads,
            callbacks,
            checkpoint_interval: options.checkpoint_interval,
            networks: self.shared.map(SharedNetworks::new),
            job: Allocation::here().map(|allocation| allocation.job),
            command: options.command.clone(),
        };
        let result = runner.run(cases);
        let (mut failed, handled) = (self.failed.clone(), cases.len() + self.failed.len());
        if !is_whole {
            failed.extend(result?);
            return Ok(FinishedCases { lines: None, failed, cases: handled });
        }
        // The whole plan is collected, whichever cases this process walked, and however it ended.
        let mut lines = write_ledger(plan, cases, out, &callbacks.run)?;
        failed.extend(result?);
        // Cases that were finished, by this process or earlier, and have disappeared.
        let absent = |lines: &[LedgerLine]| -> Vec<&PreparedCase> {
            let is_absent = |case: &&PreparedCase| {
                let name = &case.planned.name;
                lines.iter().all(|line| line.case != *name) && failed.iter().all(|f| f.case != *name)
            };
            cases.iter().filter(is_absent).collect()
        };
        let mut gone = absent(&lines);
        if !gone.is_empty() {
            // Another process may just be replacing their files with identical ones.
            for case in gone {
                runner.is_lost(case);
            }
            lines = write_ledger(plan, cases, out, &callbacks.run)?;
            gone = absent(&lines);
        }
        let lost: Vec<FailedCase> =
            gone.into_iter().map(|case| FailedCase::new(case.planned, LOST)).collect();
        failed.extend(lost);
        Ok(FinishedCases { lines: Some(lines), failed, cases: handled })
    }
}

/// Collects the finished cases of a plan, in its order, into `ledger.jsonl` (one JSON line for each case),
/// `campaign.json` and `cases.csv` in the campaign's folder. A finished case that cannot be read is an error:
/// a ledger without it would be wrong.
fn write_ledger(
    plan: &CasePlan,
    cases: &[PreparedCase],
    out: &Path,
    callbacks: &Callbacks,
) -> Result<Vec<LedgerLine>, RunError> {
    let before = read_whole(&out.join("ledger.jsonl")).unwrap_or_default();
    let before = serde_json::Deserializer::from_slice(&before).into_iter::<LedgerLine>();
    let before = before.map_while(Result::ok).map(|line| line.case);
    let dropped: Vec<String> = before.filter(|name| plan.case(name).is_none()).collect();
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
    let lines: Vec<LedgerLine> =
        cases.iter().filter_map(|case| case.read_line(out).transpose()).collect::<Result<_, _>>()?;
    let there: BTreeSet<&str> = lines.iter().map(|line| line.case.as_str()).collect();
    let is_missing = |case: &&PlannedCase| !there.contains(case.name.as_str());
    let about = Campaign {
        title: plan.title.clone(),
        plan: plan.file_name(),
        factors: plan.factors.clone(),
        cases: plan.cases.len() as u64,
        missing: plan.cases.iter().filter(is_missing).map(|case| case.name.clone()).collect(),
    };
    let mut ledger = String::new();
    for line in &lines {
        let line = serde_json::to_string(line)
            .map_err(|e| RunError::Format { file: "ledger.jsonl", source: e.into() })?;
        ledger.extend([visible_json(line), "\n".into()]);
    }
    write_whole(&out.join("ledger.jsonl"), ledger.as_bytes())?;
    write_whole(&out.join("campaign.json"), &json(format::CAMPAIGN, &about)?)?;
    write_whole(&out.join("cases.csv"), &columns(&about.factors).csv(&lines))?;
    callbacks.results(FolderKind::Campaign, out, None)?;
    Ok(lines)
}

/// Collects a campaign whose cases are all done. Errors: a folder without cases; missing cases, each with its
/// state. Nothing is written then.
pub(crate) fn collect(
    plan: &CasePlan,
    options: &CaseOptions,
    callbacks: &Callbacks,
) -> Result<Vec<LedgerLine>, RunError> {
    let drafts = Drafts::new(wanted(plan, &CasePart::All)?)?;
    if !options.out.join(CASES).is_dir() {
        let problem = "holds no cases of a campaign; nothing of the plan has been walked here";
        return Err(refused(&options.out, problem));
    }
    let folder = claim(&options.out, FolderKind::Campaign, false)?;
    let not_packed = || RunError::failed("not begun: its filter has not been packed");
    let (cases, mut missing) =
        drafts.finish(|packing| options.packed(packing)?.ok_or_else(not_packed), |_| Ok(()))?;
    for case in cases.iter().filter(|case| case.line(folder.path()).is_none()) {
        missing.push(FailedCase::new(case.planned, state(case, folder.path())));
    }
    if !missing.is_empty() {
        let (of_plan, instead) = (plan.cases.len(), "submit the campaign again to continue");
        let counted =
            format!("{} of {of_plan} cases are missing, nothing is written; {instead}", missing.len());
        return Err(refused(&options.out, format!("{counted}\n{}", named(&missing))));
    }
    write_ledger(plan, &cases, folder.path(), callbacks)
}

/// Makes one of the packings that a plan needs; they are counted from 1 in the order of its cases. Errors:
/// there is no such packing; then as in `provide`.
pub(crate) fn make_packing(
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

/// Warns of finished cases that do not belong to the present plan. Unreadable cases are skipped: they are
/// reported later.
fn warn_of_changes(plan: &CasePlan, cases: &[PreparedCase], out: &Path, warn: &dyn Fn(&str)) {
    let finished = |folder: &Path| folder.join(LINE).symlink_metadata().is_ok();
    let again: Vec<&str> = cases
        .iter()
        .filter(|case| finished(&out.join(case.folder())) && case.line(out).is_none())
        .map(|case| case.planned.name.as_str())
        .collect();
    let of_plan: BTreeSet<String> = plan.cases.iter().map(|case| case.folder_name()).collect();
    let folders = files_in(&out.join(CASES)).unwrap_or_default();
    let dropped: Vec<LedgerLine> = folders
        .iter()
        .filter(|folder| folder.file_name().is_some_and(|name| !of_plan.contains(&*name.to_string_lossy())))
        .filter_map(|folder| from_json(&read_whole(&folder.join(LINE)).ok()?).ok())
        .collect();
    let dropped: Vec<&str> = dropped.iter().map(|line| line.case.as_str()).collect();
    // `2 finished cases (a; b)`, with at most three names.
    let counted = |names: &[&str]| {
        let all = names.len();
        let more = if all > 3 { format!("; and {} more", all - 3) } else { String::new() };
        let first = names[..all.min(3)].join("; ");
        format!("{all} finished {} ({first}{more})", if all == 1 { "case" } else { "cases" })
    };
    if !again.is_empty() {
        warn(&format!(
            "{}: settings or files have changed since; walked again, and their results replaced",
            counted(&again)
        ));
    }
    if !dropped.is_empty() {
        warn(&format!(
            "{}: not in the plan any more; left out of ledger, table and page, and kept in {}",
            counted(&dropped),
            shown(&out.join(CASES))
        ));
    }
}
