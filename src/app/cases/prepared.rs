//! Cases of a plan, worked out: the wanted ones, the packings that they need, and their states; and the cases
//! of each task of a job array. The list of tasks has one line per case: the task's number, a tab, the case's
//! name. Names hold neither tabs nor line ends (the plan refuses them), and only the program reads them,
//! never a shell.

use std::collections::BTreeMap;
use std::collections::btree_map::Entry;
use std::io::ErrorKind;
use std::path::{Path, PathBuf};

use super::plan::{CasePlan, PlannedCase};
use crate::case::{Case, PackedFilter, PackingPlan};
use crate::outcome::ledger::LedgerLine;
use crate::run::checkpoints::Checkpoints;
use crate::run::folder::{refused, shown};
use crate::run::prepare::Draft;
use crate::run::{Exit, RunError};
use voidwalk_core::store::format::from_json;
use voidwalk_core::store::{Folder, StoreError, read_regular, read_whole};

pub(super) const LINE: &str = "case.json";

pub(crate) const CASES: &str = "cases";

/// File with the reason why a case could not be walked at the last attempt.
pub(super) const PROBLEM: &str = "problem.txt";

const LARGEST_LIST: u64 = 1 << 26;

const NAMED: usize = 30;

/// Cases of a plan that a process handles.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub enum CasePart {
    /// All of them.
    #[default]
    All,
    /// The case of this name.
    Named(String),
    /// The cases of one task: the list that `write_job_scripts` wrote, and the
    /// task's number.
    Task(PathBuf, u64),
}

impl CasePart {
    /// Parses the cases of a task as a user writes them, a file and a number: `tasks.tsv:3`.
    pub(crate) fn task(text: &str) -> Result<Self, String> {
        let parts = text.rsplit_once(':').filter(|(file, _)| !file.is_empty());
        let read = parts.and_then(|(file, number)| Some(Self::Task(file.into(), number.parse().ok()?)));
        read.ok_or_else(|| "write a file and a task's number as slurm/tasks.tsv:3".into())
    }
}

#[derive(Clone, Debug)]
pub(crate) struct FailedCase {
    pub(crate) case: String,
    pub(crate) problem: String,
}

impl FailedCase {
    pub(crate) fn new(case: &PlannedCase, problem: impl ToString) -> Self {
        Self { case: case.name.clone(), problem: problem.to_string() }
    }
}

pub(super) fn named(failed: &[FailedCase]) -> String {
    let one = |failed: &FailedCase| format!("case {}: {}", failed.case, failed.problem.replace('\n', " "));
    let mut lines: Vec<String> = failed.iter().take(NAMED).map(one).collect();
    if failed.len() > NAMED {
        lines.push(format!("and {} more", failed.len() - NAMED));
    }
    lines.join("\n")
}

/// Cases of a plan that a process has to handle.
pub(crate) fn wanted<'a>(plan: &'a CasePlan, part: &CasePart) -> Result<Vec<&'a PlannedCase>, RunError> {
    match part {
        CasePart::All => Ok(plan.cases.iter().collect()),
        CasePart::Named(name) => match plan.case(name) {
            Some(case) => Ok(vec![case]),
            None => {
                let distance = |case: &&PlannedCase| strsim::damerau_levenshtein(&case.name, name);
                let nearest = plan.cases.iter().min_by_key(distance).map_or("", |case| &case.name);
                let problem = format!("there is no case `{name}`; did you mean `{nearest}`?");
                Err(RunError::Refused(format!("{}: {problem}", plan.file)))
            }
        },
        CasePart::Task(file, number) => {
            let bytes = read_regular(file, LARGEST_LIST).map_err(|error| refused(file, error))?;
            let bytes = bytes.ok_or_else(|| refused(file, "is no list of tasks that --slurm wrote"))?;
            let text = String::from_utf8_lossy(&bytes);
            let names = names_of_task(&shown(file), &text, *number).map_err(RunError::refused)?;
            let problem = "the plan was changed; write the scripts again";
            let gone = |name: &str| refused(file, format!("{} has no case `{name}`: {problem}", plan.file));
            names.iter().map(|name| plan.case(name).ok_or_else(|| gone(name))).collect()
        }
    }
}

/// Cases found sound, before any work.
pub(super) struct Drafts<'a>(Vec<(&'a PlannedCase, Draft)>);

impl<'a> Drafts<'a> {
    /// Works every case out, with guesses for filters that are still to be packed.
    pub(crate) fn new(wanted: Vec<&'a PlannedCase>) -> Result<Self, RunError> {
        let draft = |planned: &'a PlannedCase| match Draft::new(planned.scene.clone()) {
            Ok(draft) => Ok((planned, draft)),
            Err(error) => Err(RunError::Refused(format!("case {}: {error}", planned.name))),
        };
        Ok(Self(wanted.into_iter().map(draft).collect::<Result<_, _>>()?))
    }

    /// Packings that the cases need, each shape once, in the order of the cases.
    pub(crate) fn packings(&self) -> Vec<&PackingPlan> {
        let mut all: Vec<&PackingPlan> = Vec::new();
        for plan in self.0.iter().filter_map(|(_, draft)| draft.packing.as_ref()) {
            if !all.iter().any(|other| other.has_shape_of(plan)) {
                all.push(plan);
            }
        }
        all
    }

    /// Cases with their filters, each filter provided once; and cases that cannot be walked.
    pub(crate) fn finish(
        self,
        mut filter: impl FnMut(&PackingPlan) -> Result<PackedFilter, RunError>,
        mut place: impl FnMut(&mut Case) -> Result<(), RunError>,
    ) -> Result<(Vec<PreparedCase<'a>>, Vec<FailedCase>), RunError> {
        let mut filters: BTreeMap<String, Result<PackedFilter, String>> = BTreeMap::new();
        for plan in self.0.iter().filter_map(|(_, draft)| draft.packing.as_ref()) {
            if let Entry::Vacant(entry) = filters.entry(key(plan)) {
                let made = match filter(plan) {
                    Err(error) if error.exit() == Exit::Stopped => return Err(error),
                    other => other.map_err(|error| error.to_string()),
                };
                entry.insert(made);
            }
        }
        let (mut cases, mut failed) = (Vec::new(), Vec::new());
        for (planned, draft) in self.0 {
            let filter = draft.packing.as_ref().map(|plan| filters[&key(plan)].clone()).transpose();
            let case = filter.and_then(|filter| draft.finished(filter).map_err(|e| e.to_string()));
            match case.and_then(|mut case| place(&mut case).map(|()| case).map_err(|e| e.to_string())) {
                Ok(case) => cases.push(PreparedCase { planned, fingerprint: case.fingerprint(), case }),
                Err(problem) => failed.push(FailedCase::new(planned, problem)),
            }
        }
        Ok((cases, failed))
    }
}

/// Key of a filter: its grains, and the merging overlap of voids.
fn key(plan: &PackingPlan) -> String {
    format!("{} {}", plan.fingerprint(), plan.merge_overlap)
}

pub(crate) struct PreparedCase<'a> {
    pub(crate) planned: &'a PlannedCase,
    pub(crate) case: Case,
    /// Fingerprint of everything that determines its results.
    pub(crate) fingerprint: String,
}

impl PreparedCase<'_> {
    pub(crate) fn folder(&self) -> PathBuf {
        // Ledger and table use this form on every system.
        PathBuf::from(format!("{CASES}/{}", self.planned.folder_name()))
    }

    /// Ledger line of the finished case, if exactly these results exist.
    pub(crate) fn line(&self, out: &Path) -> Option<LedgerLine> {
        self.read_line(out).ok().flatten()
    }

    /// Reads the line of the ledger; a file that exists but cannot be read is an error, not an unfinished
    /// case.
    pub(crate) fn read_line(&self, out: &Path) -> Result<Option<LedgerLine>, StoreError> {
        let path = out.join(self.folder()).join(LINE);
        let bytes = match read_whole(&path) {
            Ok(bytes) => bytes,
            Err(error) if matches!(error.kind(), ErrorKind::NotFound | ErrorKind::NotADirectory) => {
                return Ok(None);
            }
            Err(source) => return Err(StoreError::Io { path, action: "read", source }),
        };
        let line: Option<LedgerLine> = from_json(&bytes).ok();
        Ok(line.filter(|line| line.fingerprint == self.fingerprint && line.case == self.planned.name))
    }
}

/// State of an unfinished case in words, from its folder.
pub(super) fn state(case: &PreparedCase, out: &Path) -> String {
    let path = out.join(case.folder());
    let not_walked = |problem: &str| format!("could not be walked: {problem}");
    if path.symlink_metadata().is_err() {
        return "not begun".into();
    }
    match Folder::open(&path) {
        Err(StoreError::Held { holder, .. }) => format!("being walked ({holder})"),
        Err(other) => not_walked(&other.to_string()),
        Ok(folder) => match folder.read(PROBLEM) {
            Ok(Some(text)) => not_walked(String::from_utf8_lossy(&text).trim_end()),
            _ => match Checkpoints::is_in(folder.path()) {
                Ok(true) => "stopped or killed; its checkpoints are kept".into(),
                Ok(false) => "not begun".into(),
                Err(error) => not_walked(&error.to_string()),
            },
        },
    }
}

/// Maximum number of tasks in a job array: Slurm's default limit.
const MOST_TASKS: usize = 1000;

/// Bundles cases into `tasks` tasks of about equal time. Every task has a case, and its cases are in the
/// order of the plan. Cases are given by their times (s), tasks by the positions of their cases.
pub(super) fn bundle(seconds: &[f64], tasks: usize) -> Vec<Vec<usize>> {
    let tasks = tasks.clamp(1, MOST_TASKS).min(seconds.len());
    let mut longest_first: Vec<usize> = (0..seconds.len()).collect();
    longest_first.sort_by(|a, b| seconds[*b].total_cmp(&seconds[*a]));
    let mut bundles = vec![(0.0, Vec::new()); tasks];
    for case in longest_first {
        let least = |a: &&mut (f64, Vec<usize>), b: &&mut (f64, Vec<usize>)| {
            a.0.total_cmp(&b.0).then(a.1.len().cmp(&b.1.len()))
        };
        if let Some(least) = bundles.iter_mut().min_by(least) {
            least.0 += seconds[case];
            least.1.push(case);
        }
    }
    let mut all: Vec<Vec<usize>> = bundles.into_iter().map(|(_, cases)| cases).collect();
    all.iter_mut().for_each(|cases| cases.sort_unstable());
    all.sort();
    all
}

pub(super) fn task_list(tasks: &[Vec<&str>]) -> String {
    let mut text = String::new();
    for (number, names) in (1..).zip(tasks) {
        names.iter().for_each(|name| text += &format!("{number}\t{name}\n"));
    }
    text
}

/// Names of the cases of a task, from the text of a list.
fn names_of_task<'a>(file: &str, text: &'a str, number: u64) -> Result<Vec<&'a str>, String> {
    let (mut names, mut tasks) = (Vec::new(), 0);
    for (line, words) in (1..).zip(text.lines()) {
        let (task, name) = words
            .split_once('\t')
            .and_then(|(task, name)| Some((task.parse::<u64>().ok()?, name)))
            .ok_or_else(|| {
                format!("{file}, line {line}: must be a task's number, a tab and the name of a case")
            })?;
        tasks = tasks.max(task);
        if task == number {
            names.push(name);
        }
    }
    match names.is_empty() {
        true => Err(format!("{file}: there is no task {number}; it has {tasks}")),
        false => Ok(names),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_task_is_a_file_and_a_number() {
        assert_eq!(CasePart::task("a:b/tasks.tsv:12"), Ok(CasePart::Task("a:b/tasks.tsv".into(), 12)));
        for text in ["tasks.tsv", ":3", "tasks.tsv:", "tasks.tsv:-1", "tasks.tsv:x"] {
            assert!(CasePart::task(text).is_err(), "{text}");
        }
    }

    #[test]
    fn tasks_take_about_the_same_time_and_hold_every_case_once() {
        let seconds = [1.0, 9.0, 2.0, 8.0, 3.0, 7.0, 0.0];
        assert_eq!(bundle(&seconds, 3), [vec![0, 1, 6], vec![2, 3], vec![4, 5]]);
        assert_eq!(bundle(&seconds, 1), [vec![0, 1, 2, 3, 4, 5, 6]]);
        assert_eq!(bundle(&[0.0; 5], 99).len(), 5, "no task without a case");
        assert!(bundle(&[], 4).is_empty());
        let many = bundle(&vec![1.0; 2500], 2500);
        assert_eq!(many.len(), MOST_TASKS);
        let mut all: Vec<usize> = many.into_iter().flatten().collect();
        all.sort_unstable();
        assert!(all.into_iter().eq(0..2500));
    }

    #[test]
    fn a_file_of_tasks_is_read_back_whatever_the_cases_are_called() {
        let names = ["$(rm -rf ~)", "a; b", "`x` * ?", "-f", " \u{e9} "];
        let text = task_list(&[names[..2].to_vec(), names[2..].to_vec()]);
        assert_eq!(names_of_task("t", &text, 1).unwrap(), names[..2]);
        assert_eq!(names_of_task("t", &text, 2).unwrap(), names[2..]);
        assert_eq!(names_of_task("t", &text, 3).unwrap_err(), "t: there is no task 3; it has 2");
        assert!(names_of_task("t", "1 x\n", 1).unwrap_err().contains("line 1"));
    }
}
