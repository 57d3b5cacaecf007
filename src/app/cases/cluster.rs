//! A plan on a cluster that uses Slurm: job scripts with the estimated time and memory of the cases, and a
//! check of the file locks in the campaign's folder.
//!
//! An array of jobs packs filters, an array walks, a job collects. The scheduler only starts processes.
//! Finished cases and claims on others are in the campaign's folder, so a task that is lost, duplicated or
//! restarted changes no result. Scripts are filled-in templates of `src/app/data/slurm`: words of the user
//! are in single quotes, and cases are given by the number of a task, not by name.

use std::path::{Path, PathBuf};

use super::plan::CasePlan;
use super::prepared::{self, CasePart, Drafts, PreparedCase, named, wanted};
use super::run::CaseOptions;
use crate::case::{Case, CaseError, PackedFilter};
use crate::run::RunError;
use crate::run::cost::{self, duration};
use crate::run::folder::{FolderKind, claim};
use crate::run::machine::{CasesAtOnce, MEMORY_MARGIN};
use voidwalk_core::store::{make_folder, platform, write_whole};
use voidwalk_core::text::quoted;

const PROCESSORS: u64 = 4;

/// Target time of a task, if the user gives no number of tasks (s).
const TASK_S: f64 = 600.0;

#[derive(Clone, Debug)]
pub(crate) struct JobOptions {
    pub(crate) program: PathBuf,
    /// Words between the program and its command: `-m voidwalk` if the program is Python.
    pub(crate) words: Vec<String>,
    pub(crate) plan: PathBuf,
    /// Tasks of the array; by default as many as take about ten minutes each.
    pub(crate) tasks: Option<usize>,
}

#[derive(Clone, Debug)]
pub(crate) struct WrittenJobs {
    /// Number of cases already done; if all are, nothing is written.
    pub(crate) done: usize,
    pub(crate) cases: usize,
    pub(crate) tasks: usize,
    /// Packings that are made first, and the needs of the largest.
    pub(crate) packings: (usize, TaskNeeds),
    pub(crate) walk: TaskNeeds,
    pub(crate) processors: u64,
    pub(crate) submit: PathBuf,
    /// Mount of the campaign's folder, if known.
    pub(crate) mount: Option<Mount>,
}

/// Writes job scripts for the unfinished cases of a plan into the campaign's folder. Errors: a wrong plan or
/// case, a folder that cannot be claimed or written, a path that no script can hold.
pub(crate) fn write_job_scripts(
    plan: &CasePlan,
    options: &CaseOptions,
    jobs: &JobOptions,
) -> Result<WrittenJobs, RunError> {
    let drafts = Drafts::new(wanted(plan, &CasePart::All)?)?;
    let out = claim(&options.out, FolderKind::Campaign, false)?;
    let processors = options.threads.map_or(PROCESSORS, |threads| threads as u64);
    let packings = packings(&drafts, options)?;
    let measuring_s = if drafts.packings().is_empty() { 0.0 } else { cost::MEASURING_S };
    let cases = open_cases(drafts, options, out.path())?;
    let folder = out.path().join(FOLDER);
    let mut written = WrittenJobs {
        done: plan.cases.len() - cases.len(),
        cases: cases.len(),
        tasks: 0,
        packings,
        walk: TaskNeeds::default(),
        processors,
        submit: folder.join("submit.sh"),
        mount: None,
    };
    if cases.is_empty() {
        return Ok(written);
    }
    let seconds: Vec<f64> = cases.iter().map(|case| cost::seconds_on(&case.case, processors)).collect();
    let ten_minutes = || (seconds.iter().sum::<f64>() / TASK_S).ceil() as usize;
    let bundles = prepared::bundle(&seconds, jobs.tasks.unwrap_or_else(ten_minutes));
    for bundle in &bundles {
        let of_bundle: Vec<&Case> = bundle.iter().map(|case| &cases[*case].case).collect();
        written.walk = written.walk.or_more(TaskNeeds {
            seconds: bundle.iter().map(|case| seconds[*case] + measuring_s).sum(),
            bytes: CasesAtOnce::of_job(&of_bundle, processors).bytes.max(packings.1.bytes),
        });
    }
    let name = |case: &usize| cases[*case].planned.name.as_str();
    let tasks: Vec<Vec<&str>> = bundles.iter().map(|bundle| bundle.iter().map(name).collect()).collect();
    written.tasks = tasks.len();
    let (seconds, bytes) = cost::collecting(plan.cases.len(), measuring_s);
    let collect = TaskNeeds { seconds, bytes: packings.1.bytes.max(bytes) };
    let files = files((jobs, out.path()), &written, &command_words(options), &tasks, &collect)?;
    make_folder(&folder)?;
    for (name, text) in &files {
        write_whole(&folder.join(name), text.as_bytes())?;
    }
    let real = out.path().canonicalize().ok();
    written.mount = real.and_then(|folder| Mount::of(&folder, &platform::mounts()?));
    Ok(written)
}

/// Packings to make first (all of the plan if one is missing), and the needs of the largest.
fn packings(drafts: &Drafts, options: &CaseOptions) -> Result<(usize, TaskNeeds), RunError> {
    let all = drafts.packings();
    let (mut missing, mut needs) = (false, TaskNeeds::default());
    for packing in &all {
        missing |= options.packed(packing)?.is_none();
        needs = needs.or_more(TaskNeeds { seconds: packing.core_seconds(), bytes: packing.program_bytes() });
    }
    Ok((if missing { all.len() } else { 0 }, needs))
}

/// Unfinished cases, with guesses for filters that are still to be packed.
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

/// Additional words of the command lines that walk and that collect.
fn command_words(options: &CaseOptions) -> [Vec<String>; 2] {
    let absolute = |path: &PathBuf| std::path::absolute(path).unwrap_or_else(|_| path.clone());
    let packings = options.packings.iter();
    let collecting: Vec<String> =
        packings.flat_map(|path| ["--packings".to_owned(), absolute(path).display().to_string()]).collect();
    let mut walking = collecting.clone();
    walking.extend(["--checkpoint-every".to_owned(), options.checkpoint_interval.to_string()]);
    walking.extend(options.memory.iter().flat_map(|bytes| ["--memory".to_owned(), bytes.to_string()]));
    [walking, collecting]
}

const FOLDER: &str = "slurm";

const TIME_MARGIN: f64 = 4.0;

/// Maximum time to request (minutes): a task that takes longer is stopped, and continues in another attempt.
const LONGEST_MIN: u64 = 24 * 60;

/// Time for delays that no estimate includes: a busy file system, the start of the program (minutes).
const SLACK_MIN: u64 = 10;

#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct TaskNeeds {
    pub(crate) seconds: f64,
    pub(crate) bytes: u64,
}

impl TaskNeeds {
    fn or_more(self, other: Self) -> Self {
        Self { seconds: self.seconds.max(other.seconds), bytes: self.bytes.max(other.bytes) }
    }

    /// Time to request (minutes).
    pub(crate) fn minutes(&self) -> u64 {
        let minutes = (TIME_MARGIN * self.seconds / 60.0).ceil() as u64 + SLACK_MIN;
        (minutes.div_ceil(5) * 5).min(LONGEST_MIN)
    }

    /// Memory to request (megabytes of 2^20 bytes).
    pub(crate) fn megabytes(&self) -> u64 {
        let megabytes = MEMORY_MARGIN * self.bytes as f64 / f64::from(1 << 20);
        (megabytes.ceil() as u64).div_ceil(100) * 100
    }

    /// Comment of a job script.
    fn estimate(&self) -> String {
        format!(
            "{} of a task and {:.0} MB; {} times the time and {SLACK_MIN} minutes, and {} times the memory, \
             are asked for",
            duration(self.seconds),
            self.bytes as f64 / f64::from(1 << 20),
            TIME_MARGIN,
            MEMORY_MARGIN
        )
    }
}

/// Files of the scripts, by their names inside [`FOLDER`]; `tasks` are the names of the cases of each task.
fn files(
    (jobs, out): (&JobOptions, &Path),
    written: &WrittenJobs,
    [walking, collecting]: &[Vec<String>; 2],
    tasks: &[Vec<&str>],
    collect: &TaskNeeds,
) -> Result<Vec<(String, String)>, RunError> {
    let list = prepared::task_list(tasks);
    // Scripts that wait in a queue name the list with which they were written.
    let list_name = format!("tasks-{:08x}.tsv", xxhash_rust::xxh3::xxh3_64(list.as_bytes()) as u32);
    let (cases, all) = (written.cases, tasks.len());
    let words = |all: &[String]| all.iter().map(|word| format!(" {}", quoted(word))).collect::<String>();
    let common = [
        ("OUT", path(out)?),
        ("PLAN", path(&jobs.plan)?),
        ("PROGRAM", path(&jobs.program)? + &words(&jobs.words)),
        ("FILE", list_name.clone()),
        ("CASES", cases.to_string()),
    ];
    let job = |template: &str, options: &[String], tasks: usize, need: &TaskNeeds| {
        let of_job = [
            ("OPTIONS", words(options)),
            ("TASKS", tasks.to_string()),
            ("PROCESSORS", written.processors.to_string()),
            ("MEGABYTES", need.megabytes().to_string()),
            ("MINUTES", need.minutes().to_string()),
            ("ESTIMATE", need.estimate()),
        ];
        fill(template, &[&common[..], &of_job[..]].concat())
    };
    let walks = format!("{cases} cases in {all} tasks, then the ledger and the page");
    let (packings, pack) = &written.packings;
    let (submitted, first, after) = match packings {
        0 => (walks, "", ""),
        _ => (
            format!("{packings} packings, then {walks}"),
            "submit \"$@\" slurm/pack.sh\n",
            // However the packing job ends, cases whose packings exist are walked.
            "--dependency=\"afterany:$number\" ",
        ),
    };
    let submit = [
        ("JOBS", submitted),
        ("PACK", first.to_owned()),
        ("AFTER_PACK", after.to_owned()),
        ("OUT", path(out)?),
    ];
    let array = include_str!("../data/slurm/array.sh");
    let collection = include_str!("../data/slurm/collect.sh");
    let mut files = vec![
        ("attempt.sh".to_owned(), include_str!("../data/slurm/attempt.sh").to_owned()),
        (list_name, list),
        ("array.sh".to_owned(), job(array, walking, all, &written.walk)),
        ("collect.sh".to_owned(), job(collection, collecting, 1, collect)),
        ("submit.sh".to_owned(), fill(include_str!("../data/slurm/submit.sh"), &submit)),
    ];
    if *packings > 0 {
        let text = job(include_str!("../data/slurm/pack.sh"), walking, *packings, pack);
        files.push(("pack.sh".to_owned(), text));
    }
    Ok(files)
}

/// Replaces `@NAME@`, once: inserted text is not searched again.
fn fill(template: &str, values: &[(&str, String)]) -> String {
    let mut text = String::new();
    let mut rest = template;
    while let Some((before, after)) = rest.split_once('@') {
        text.push_str(before);
        let known = values.iter().find_map(|(name, value)| {
            after.strip_prefix(name)?.strip_prefix('@').map(|after| (value.as_str(), after))
        });
        let (value, after) = known.unwrap_or(("@", after));
        text.push_str(value);
        rest = after;
    }
    text + rest
}

fn path(path: &Path) -> Result<String, RunError> {
    let absolute = std::path::absolute(path).unwrap_or_else(|_| path.to_owned());
    match absolute.to_str().filter(|text| !text.chars().any(char::is_control)) {
        Some(text) => Ok(quoted(text)),
        None => Err(RunError::Refused(format!(
            "{}: a path in a job script must be UTF-8 text without line ends",
            absolute.display()
        ))),
    }
}

/// Mount of a file system. On most file systems that clusters share, a lock held by one node keeps the others
/// out; on some, or with some mount options, each node sees only its own locks, without any sign of it.
/// Several tasks may then walk one case, with the same results at a higher cost.
#[derive(Clone, Debug)]
pub(crate) struct Mount {
    pub(crate) point: PathBuf,
    pub(crate) kind: String,
    options: Vec<String>,
}

impl Mount {
    /// Mount that holds a path: the longest mount point above it, and the last of several equal ones.
    pub(crate) fn of(path: &Path, mounts: &str) -> Option<Self> {
        let above = mounts.lines().filter_map(Self::read).filter(|mount| path.starts_with(&mount.point));
        above.max_by_key(|mount| mount.point.components().count())
    }

    /// A line of `/proc/self/mountinfo`.
    fn read(line: &str) -> Option<Self> {
        let (left, right) = line.split_once(" - ")?;
        let left: Vec<&str> = left.split(' ').collect();
        let right: Vec<&str> = right.split(' ').collect();
        let options = [*left.get(5)?, right.get(2).copied().unwrap_or("")];
        Some(Self {
            point: PathBuf::from(unescaped(left.get(4)?)),
            kind: (*right.first()?).to_owned(),
            options: options.iter().flat_map(|list| list.split(',')).map(str::to_owned).collect(),
        })
    }

    pub(crate) fn has(&self, option: &str) -> bool {
        self.options.iter().any(|o| o == option)
    }
}

/// Decodes spaces and similar characters, which are written as three octal digits.
fn unescaped(field: &str) -> String {
    let mut parts = field.split('\\');
    let mut text = parts.next().unwrap_or_default().to_owned();
    for part in parts {
        match part.get(..3).and_then(|digits| u8::from_str_radix(digits, 8).ok()) {
            Some(byte) => text.extend([&*String::from(char::from(byte)), &part[3..]]),
            None => text.extend(["\\", part]),
        }
    }
    text
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn more_is_asked_for_than_is_estimated_and_never_for_ever() {
        let need = |seconds, bytes| TaskNeeds { seconds, bytes };
        assert_eq!(need(1.0, 100 << 20).minutes(), 15);
        assert_eq!(need(600.0, 100 << 20).minutes(), 50);
        assert_eq!(need(1e7, 0).minutes(), LONGEST_MIN);
        assert_eq!(need(0.0, 100 << 20).megabytes(), 200);
        assert_eq!(need(0.0, 1000 << 20).megabytes(), 1500);
    }

    #[test]
    fn what_is_filled_in_is_no_template() {
        let values = [("A", "@B@".to_string()), ("B", "b".to_string())];
        assert_eq!(fill("x@A@y@B@ TERM@120 @C@", &values), "x@B@yb TERM@120 @C@");
    }

    #[test]
    #[cfg(target_os = "linux")]
    fn this_machine_says_how_its_folders_are_mounted() {
        assert!(Mount::of(Path::new("/proc/self"), &platform::mounts().unwrap()).is_some());
    }
}
