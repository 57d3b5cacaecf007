//! The cases of a plan, worked out: the wanted ones, the packings that they need, and the state of each.

use std::collections::BTreeMap;
use std::collections::btree_map::Entry;
use std::io::ErrorKind;
use std::path::{Path, PathBuf};

use super::cluster::tasks;
use super::plan::{CasePlan, PlannedCase};
use crate::case::{Case, PackedFilter, PackingPlan};
use crate::outcome::ledger::LedgerLine;
use crate::run::checkpoints::Checkpoints;
use crate::run::error::{Exit, RunError};
use crate::run::folder::shown;
use crate::run::prepare::Draft;
use voidwalk_core::store::format::from_json;
use voidwalk_core::store::{Folder, StoreError, read_regular, read_whole};

/// A finished case.
pub(super) const LINE: &str = "case.json";

/// Folder of the cases, inside the campaign's.
pub(crate) const CASES: &str = "cases";

/// Reason why a case could not be walked at the last attempt.
pub(super) const PROBLEM: &str = "problem.txt";

/// Size of the largest list of tasks that is accepted (bytes).
const LARGEST_LIST: u64 = 1 << 26;

/// A message names no more cases than this.
const NAMED: usize = 30;

/// Which cases of a plan a process sees to.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub enum CasePart {
    /// All of them.
    #[default]
    All,
    /// The one of this name.
    Named(String),
    /// The cases of a task of a list that [`write_job_scripts`](super::write_job_scripts) wrote: the file,
    /// and the task's number.
    Task(PathBuf, u64),
}

impl CasePart {
    /// The cases of a task as a user writes it, a file and a number: `tasks.tsv:3`.
    ///
    /// # Errors
    /// The form that is expected.
    pub fn task(text: &str) -> Result<Self, String> {
        let parts = text.rsplit_once(':').filter(|(file, _)| !file.is_empty());
        let read = parts.and_then(|(file, number)| Some(Self::Task(file.into(), number.parse().ok()?)));
        read.ok_or_else(|| "write a file and a task's number as slurm/tasks.tsv:3".into())
    }
}

/// A case that is not done, and why.
#[derive(Clone, Debug)]
pub struct FailedCase {
    /// The case.
    pub case: String,
    /// Description of the problem.
    pub problem: String,
}

/// Names the cases that are not done, one a line.
pub(super) fn named(failed: &[FailedCase]) -> String {
    let one = |failed: &FailedCase| format!("case {}: {}", failed.case, failed.problem.replace('\n', " "));
    let mut lines: Vec<String> = failed.iter().take(NAMED).map(one).collect();
    if failed.len() > NAMED {
        lines.push(format!("and {} more", failed.len() - NAMED));
    }
    lines.join("\n")
}

/// The cases of a plan that a process has to walk.
///
/// # Errors
/// There is no such case, or no such task.
pub fn wanted<'a>(plan: &'a CasePlan, part: &CasePart) -> Result<Vec<&'a PlannedCase>, RunError> {
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
            let shown = shown(file);
            let refused = |problem: &dyn std::fmt::Display| RunError::Refused(format!("{shown}: {problem}"));
            let bytes = read_regular(file, LARGEST_LIST).map_err(|error| refused(&error))?;
            let bytes = bytes.ok_or_else(|| refused(&"is no list of tasks that --slurm wrote"))?;
            let text = String::from_utf8_lossy(&bytes);
            let names = tasks::read(&shown, &text, *number).map_err(RunError::refused)?;
            let find = |name: &&str| {
                plan.case(name).ok_or_else(|| {
                    let problem = "the plan was changed; write the scripts again";
                    RunError::Refused(format!("{shown}: {} has no case `{name}`: {problem}", plan.file))
                })
            };
            names.iter().map(find).collect()
        }
    }
}

/// Cases that have been found sound, before any work.
pub(super) struct Drafts<'a>(Vec<(&'a PlannedCase, Draft)>);

impl<'a> Drafts<'a> {
    /// Works every case out, with guesses at filters that are to be packed.
    pub fn new(wanted: Vec<&'a PlannedCase>) -> Result<Self, RunError> {
        let draft = |planned: &'a PlannedCase| match Draft::new(planned.scene.clone()) {
            Ok(draft) => Ok((planned, draft)),
            Err(error) => Err(RunError::Refused(format!("case {}: {error}", planned.name))),
        };
        Ok(Self(wanted.into_iter().map(draft).collect::<Result<_, _>>()?))
    }

    /// The packings that the cases need, each shape once, in the order of the cases.
    pub fn packings(&self) -> Vec<&PackingPlan> {
        let mut all: Vec<&PackingPlan> = Vec::new();
        for plan in self.0.iter().filter_map(|(_, draft)| draft.packing.as_ref()) {
            if !all.iter().any(|other| other.has_shape_of(plan)) {
                all.push(plan);
            }
        }
        all
    }

    /// The cases with their filters, each filter had once; and those that cannot be walked.
    ///
    /// # Errors
    /// It was stopped.
    pub fn finish(
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
                Ok(case) => cases.push(PreparedCase::new(planned, case)),
                Err(problem) => failed.push(FailedCase { case: planned.name.clone(), problem }),
            }
        }
        Ok((cases, failed))
    }
}

/// Key of a filter: its grains, and the overlap of voids.
fn key(plan: &PackingPlan) -> String {
    format!("{} {}", plan.fingerprint(), plan.merge_overlap)
}

/// A case of a plan, worked out.
pub struct PreparedCase<'a> {
    /// The case as planned.
    pub planned: &'a PlannedCase,
    /// The case with its files read.
    pub case: Case,
    /// Fingerprint of everything that its results follow from.
    pub fingerprint: String,
}

impl<'a> PreparedCase<'a> {
    /// A case with its fingerprint.
    pub fn new(planned: &'a PlannedCase, case: Case) -> Self {
        let fingerprint = case.fingerprint();
        Self { planned, case, fingerprint }
    }

    /// Folder of the results, inside the campaign's.
    pub fn folder(&self) -> PathBuf {
        // Written into ledger and table in one form on every system.
        PathBuf::from(format!("{CASES}/{}", self.planned.folder_name()))
    }

    /// The finished case, if these very results are there.
    pub fn line(&self, out: &Path) -> Option<LedgerLine> {
        self.read_line(out).ok().flatten()
    }

    /// Reads the line of the ledger; a file that exists but cannot be read is an error, not an unfinished
    /// case.
    ///
    /// # Errors
    /// Errors of the system.
    pub fn read_line(&self, out: &Path) -> Result<Option<LedgerLine>, StoreError> {
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

/// State of a case that is not done.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum CaseState {
    /// Not begun yet.
    NotBegun,
    /// A process is at it.
    Walking(String),
    /// It was stopped or killed; the next start continues from its checkpoints.
    Saved,
    /// It could not be walked.
    Failed(String),
}

impl CaseState {
    /// Looks into the case's folder.
    pub fn of(ready: &PreparedCase, out: &Path) -> Self {
        let path = out.join(ready.folder());
        if path.symlink_metadata().is_err() {
            return Self::NotBegun;
        }
        match Folder::open(&path) {
            Err(StoreError::Held { holder, .. }) => Self::Walking(holder),
            Err(other) => Self::Failed(other.to_string()),
            Ok(folder) => match folder.read(PROBLEM) {
                Ok(Some(text)) => Self::Failed(String::from_utf8_lossy(&text).trim_end().to_owned()),
                _ => match Checkpoints::is_in(folder.path()) {
                    Ok(true) => Self::Saved,
                    Ok(false) => Self::NotBegun,
                    Err(error) => Self::Failed(error.to_string()),
                },
            },
        }
    }
}

#[cfg(test)]
mod tests {
    use super::CasePart;

    #[test]
    fn a_task_is_a_file_and_a_number() {
        assert_eq!(CasePart::task("a:b/tasks.tsv:12"), Ok(CasePart::Task("a:b/tasks.tsv".into(), 12)));
        for text in ["tasks.tsv", ":3", "tasks.tsv:", "tasks.tsv:-1", "tasks.tsv:x"] {
            assert!(CasePart::task(text).is_err(), "{text}");
        }
    }
}
