//! Consequences of a changed plan for the finished cases of its folder, reported before any change.

use std::collections::BTreeSet;
use std::path::Path;

use super::plan::CasePlan;
use super::prepared::{CASES, LINE, PreparedCase};
use crate::outcome::ledger::LedgerLine;
use crate::run::folder::shown;
use voidwalk_core::store::format::from_json;
use voidwalk_core::store::{files_in, read_whole};

/// A sentence names no more cases than this.
const NAMED: usize = 3;

/// Consequences for finished cases that do not belong to the present plan, in sentences. Unreadable cases are
/// skipped: they are reported at a later step.
pub(super) fn sentences(plan: &CasePlan, cases: &[PreparedCase], out: &Path) -> Vec<String> {
    let finished = |folder: &Path| folder.join(LINE).symlink_metadata().is_ok();
    let again: Vec<&str> = cases
        .iter()
        .filter(|case| finished(&out.join(case.folder())) && case.line(out).is_none())
        .map(|case| case.planned.name.as_str())
        .collect();
    let of_plan: BTreeSet<String> = plan.cases.iter().map(|case| case.folder_name()).collect();
    let folders = files_in(&out.join(CASES)).unwrap_or_default();
    let dropped: Vec<String> = folders
        .iter()
        .filter(|folder| folder.file_name().is_some_and(|name| !of_plan.contains(&*name.to_string_lossy())))
        .filter_map(|folder| from_json::<LedgerLine>(&read_whole(&folder.join(LINE)).ok()?).ok())
        .map(|line| line.case)
        .collect();
    let dropped: Vec<&str> = dropped.iter().map(String::as_str).collect();
    let mut sentences = Vec::new();
    if !again.is_empty() {
        sentences.push(format!(
            "{}: settings or files have changed since; walked again, and their results replaced",
            counted(&again)
        ));
    }
    if !dropped.is_empty() {
        sentences.push(format!(
            "{}: not in the plan any more; left out of ledger, table and page, and kept in {}",
            counted(&dropped),
            shown(&out.join(CASES))
        ));
    }
    sentences
}

/// `2 finished cases (a, b)`.
fn counted(names: &[&str]) -> String {
    let first = names[..names.len().min(NAMED)].join("; ");
    let more =
        if names.len() > NAMED { format!("; and {} more", names.len() - NAMED) } else { String::new() };
    format!("{} finished {} ({first}{more})", names.len(), if names.len() == 1 { "case" } else { "cases" })
}
