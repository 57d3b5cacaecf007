//! Writes the job scripts of a plan, asking for as much time and memory as its cases are estimated to take.

use std::path::{Path, PathBuf};

use super::locks;
use super::scripts::{FOLDER, Jobs, TaskNeeds};
use super::tasks;
use crate::case::{Case, CaseError, PackedFilter};
use crate::cases::plan::CasePlan;
use crate::cases::prepared::{CasePart, Drafts, PreparedCase, named, wanted};
use crate::cases::run::CaseOptions;
use crate::run::at_once::CasesAtOnce;
use crate::run::callbacks::Callbacks;
use crate::run::cost;
use crate::run::error::RunError;
use crate::run::folder::{FolderKind, claim};
use voidwalk_core::store::{make_folder, write_whole};

/// Default number of processors of a task.
const PROCESSORS: u64 = 4;

/// Target time of a task, if the user gives no number of tasks (s).
const TASK_S: f64 = 600.0;

/// Options of the job scripts.
#[derive(Clone, Debug)]
pub struct JobOptions {
    /// The program.
    pub program: PathBuf,
    /// The words between it and its command: `-m voidwalk` if the program is Python.
    pub words: Vec<String>,
    /// The plan's file.
    pub plan: PathBuf,
    /// Tasks of the array; by default enough that one takes about ten minutes.
    pub tasks: Option<usize>,
}

/// The scripts that were written.
#[derive(Clone, Debug)]
pub struct WrittenJobs {
    /// Cases of the plan that are done already; nothing is written if all are.
    pub done: usize,
    /// Cases that the array walks.
    pub cases: usize,
    /// Tasks of the array.
    pub tasks: usize,
    /// Packings that are made first, and the needs of the largest.
    pub packings: (usize, TaskNeeds),
    /// Needs of the largest task.
    pub walk: TaskNeeds,
    /// Processors of a task.
    pub processors: u64,
    /// The script that submits the jobs.
    pub submit: PathBuf,
}

/// Writes job scripts for the cases of a plan that are not done into the campaign's folder.
///
/// # Errors
/// A plan or case that is wrong, a folder that cannot be claimed or written, a path that no script can hold.
pub fn write_job_scripts(
    plan: &CasePlan,
    options: &CaseOptions,
    jobs: &JobOptions,
    callbacks: &Callbacks,
) -> Result<WrittenJobs, RunError> {
    let drafts = Drafts::new(wanted(plan, &CasePart::All)?)?;
    let out = claim(&options.out, FolderKind::Campaign, false)?;
    let processors = options.threads.map_or(PROCESSORS, |threads| threads as u64);
    let (packings, packing_needs) = packings(&drafts, options)?;
    let measuring_s = if drafts.packings().is_empty() { 0.0 } else { cost::MEASURING_S };
    let cases = open_cases(drafts, options, out.path())?;
    let folder = out.path().join(FOLDER);
    let done = plan.cases.len() - cases.len();
    let nothing = TaskNeeds { seconds: 0.0, bytes: 0 };
    let mut written = WrittenJobs {
        done,
        cases: cases.len(),
        tasks: 0,
        packings: (packings, packing_needs),
        walk: nothing,
        processors,
        submit: folder.join("submit.sh"),
    };
    if cases.is_empty() {
        return Ok(written);
    }
    let seconds: Vec<f64> = cases.iter().map(|case| cost::seconds_on(&case.case, processors)).collect();
    let ten_minutes = || (seconds.iter().sum::<f64>() / TASK_S).ceil() as usize;
    let bundles = tasks::bundle(&seconds, jobs.tasks.unwrap_or_else(ten_minutes));
    for bundle in &bundles {
        let of_bundle: Vec<&Case> = bundle.iter().map(|case| &cases[*case].case).collect();
        written.walk = written.walk.or_more(TaskNeeds {
            seconds: bundle.iter().map(|case| seconds[*case] + measuring_s).sum(),
            bytes: CasesAtOnce::of_job(&of_bundle, processors).bytes.max(packing_needs.bytes),
        });
    }
    let collecting = cost::collecting(plan.cases.len(), measuring_s);
    let (walk_words, collect_words) = command_words(options);
    let scripts = Jobs {
        program: &jobs.program,
        words: &jobs.words,
        plan: &jobs.plan,
        out: out.path(),
        options: walk_words,
        collecting: collect_words,
        processors,
        packings: written.packings,
        tasks: bundles.iter().map(|b| b.iter().map(|i| cases[*i].planned.name.as_str()).collect()).collect(),
        walk: written.walk,
        collect: TaskNeeds { seconds: collecting.0, bytes: packing_needs.bytes.max(collecting.1) },
    };
    let files = scripts.files().map_err(RunError::refused)?;
    make_folder(&folder)?;
    for (name, text) in &files {
        write_whole(&folder.join(name), text.as_bytes())?;
    }
    if let Some(warning) = locks::warning(out.path()) {
        (callbacks.warn)(&warning);
    }
    written.tasks = bundles.len();
    Ok(written)
}

/// The packings to be made first, all of the plan if one is missing, and the needs of the largest.
fn packings(drafts: &Drafts, options: &CaseOptions) -> Result<(usize, TaskNeeds), RunError> {
    let all = drafts.packings();
    let (mut missing, mut needs) = (false, TaskNeeds { seconds: 0.0, bytes: 0 });
    for packing in &all {
        missing |= options.packed(packing)?.is_none();
        needs = needs.or_more(TaskNeeds { seconds: packing.core_seconds(), bytes: packing.program_bytes() });
    }
    Ok((if missing { all.len() } else { 0 }, needs))
}

/// The cases that are not done, with guesses at filters that are still to be packed.
fn open_cases<'a>(
    drafts: Drafts<'a>,
    options: &CaseOptions,
    out: &Path,
) -> Result<Vec<PreparedCase<'a>>, RunError> {
    let (mut cases, failed) = drafts.finish(
        |packing| match options.packed(packing)? {
            Some(filter) => Ok(filter),
            None => Ok(PackedFilter::placeholder(packing).map_err(CaseError::from)?),
        },
        |case| {
            case.memory = options.memory.unwrap_or(u64::MAX);
            Ok(())
        },
    )?;
    if !failed.is_empty() {
        return Err(RunError::Refused(named(&failed)));
    }
    cases.retain(|case| case.line(out).is_none());
    Ok(cases)
}

/// Further words of the program's command lines that walk and that collect.
fn command_words(options: &CaseOptions) -> (Vec<String>, Vec<String>) {
    let mut words = Vec::new();
    if let Some(packings) = &options.packings {
        let absolute = std::path::absolute(packings).unwrap_or_else(|_| packings.clone());
        words.extend(["--packings".to_owned(), absolute.display().to_string()]);
    }
    let collecting = words.clone();
    words.extend(["--checkpoint-every".to_owned(), options.checkpoint_interval.to_string()]);
    words.extend(options.memory.iter().flat_map(|bytes| ["--memory".to_owned(), bytes.to_string()]));
    (words, collecting)
}
