//! The scripts of a campaign's jobs, filled into the templates of `src/app/data/slurm`.
//!
//! Paths and other words of the user are in single quotes. No script contains names of cases: it passes on
//! only the number of a task.

use std::path::{Path, PathBuf};

use super::tasks;
use crate::run::at_once::MEMORY_MARGIN;
use crate::run::cost::duration;
use voidwalk_core::text::quoted;

/// Folder of the scripts and logs, inside the campaign's.
pub const FOLDER: &str = "slurm";

/// Asked for by this factor more than estimated: time.
const TIME_MARGIN: f64 = 4.0;

/// Greatest time that is asked for (minutes): a task that is not done by then is stopped, and continues in
/// another attempt.
const LONGEST_MIN: u64 = 24 * 60;

/// Time for delays that no estimate includes: a busy file system, the start of the program (minutes).
const SLACK_MIN: u64 = 10;

/// Needs of one task of a job.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TaskNeeds {
    /// Seconds of the longest task, on its threads.
    pub seconds: f64,
    /// Memory (bytes).
    pub bytes: u64,
}

impl TaskNeeds {
    /// The larger of each of two needs.
    pub(super) fn or_more(self, other: Self) -> Self {
        Self { seconds: self.seconds.max(other.seconds), bytes: self.bytes.max(other.bytes) }
    }

    /// Minutes to ask for.
    pub fn minutes(&self) -> u64 {
        let minutes = (TIME_MARGIN * self.seconds / 60.0).ceil() as u64 + SLACK_MIN;
        (minutes.div_ceil(5) * 5).min(LONGEST_MIN)
    }

    /// Megabytes (2^20 bytes) to ask for.
    pub fn megabytes(&self) -> u64 {
        let megabytes = MEMORY_MARGIN * self.bytes as f64 / f64::from(1 << 20);
        (megabytes.ceil() as u64).div_ceil(100) * 100
    }

    fn in_words(&self) -> String {
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

/// Jobs to be submitted.
pub struct Jobs<'a> {
    /// The program.
    pub program: &'a Path,
    /// The words between it and its command.
    pub words: &'a [String],
    /// The plan.
    pub plan: &'a Path,
    /// The campaign's folder.
    pub out: &'a Path,
    /// Further words of the program's command line that walks or packs.
    pub options: Vec<String>,
    /// Options of the command that collects.
    pub collecting: Vec<String>,
    /// Processors of a task.
    pub processors: u64,
    /// Filters to pack, and the needs of the largest.
    pub packings: (usize, TaskNeeds),
    /// Names of the cases of each task.
    pub tasks: Vec<Vec<&'a str>>,
    /// Needs of the largest task.
    pub walk: TaskNeeds,
    /// Needs of collecting.
    pub collect: TaskNeeds,
}

/// Reason why there are no scripts.
#[derive(Debug, thiserror::Error)]
pub enum ScriptError {
    /// A path that no script can hold.
    #[error("{path}: a path that is to stand in a job script must be UTF-8 text without line ends")]
    Path {
        /// The path.
        path: String,
    },
}

impl Jobs<'_> {
    /// Files of the scripts, by their name inside [`FOLDER`].
    ///
    /// # Errors
    /// A path that no script can hold.
    pub fn files(&self) -> Result<Vec<(String, String)>, ScriptError> {
        let list = tasks::to_text(&self.tasks);
        // Scripts that wait in a queue name the list that they were written with.
        let list_name = format!("tasks-{:08x}.tsv", xxhash_rust::xxh3::xxh3_64(list.as_bytes()) as u32);
        let cases: usize = self.tasks.iter().map(Vec::len).sum();
        let words = |all: &[String]| all.iter().map(|word| format!(" {}", quoted(word))).collect::<String>();
        let common = [
            ("OUT", path(self.out)?),
            ("PLAN", path(self.plan)?),
            ("PROGRAM", path(self.program)? + &words(self.words)),
            ("FILE", list_name.clone()),
            ("CASES", cases.to_string()),
        ];
        let job = |template: &str, options: &[String], tasks: usize, need: &TaskNeeds| {
            let of_job = [
                ("OPTIONS", words(options)),
                ("TASKS", tasks.to_string()),
                ("PROCESSORS", self.processors.to_string()),
                ("MEGABYTES", need.megabytes().to_string()),
                ("MINUTES", need.minutes().to_string()),
                ("ESTIMATE", need.in_words()),
            ];
            fill(template, &[&common[..], &of_job[..]].concat())
        };
        let walks = format!("{cases} cases in {} tasks, then the ledger and the page", self.tasks.len());
        let (packings, pack) = &self.packings;
        let (jobs, first, after) = match packings {
            0 => (walks, "", ""),
            _ => (
                format!("{packings} packings, then {walks}"),
                "submit \"$@\" slurm/pack.sh\n",
                // After any end of the packing job: cases whose packings exist are walked.
                "--dependency=\"afterany:$number\" ",
            ),
        };
        let submit = [
            ("JOBS", jobs),
            ("PACK", first.to_owned()),
            ("AFTER_PACK", after.to_owned()),
            ("OUT", path(self.out)?),
        ];
        let mut files = vec![
            ("attempt.sh".to_owned(), include_str!("../../data/slurm/attempt.sh").to_owned()),
            (list_name, list),
            (
                "array.sh".to_owned(),
                job(include_str!("../../data/slurm/array.sh"), &self.options, self.tasks.len(), &self.walk),
            ),
            (
                "collect.sh".to_owned(),
                job(include_str!("../../data/slurm/collect.sh"), &self.collecting, 1, &self.collect),
            ),
            ("submit.sh".to_owned(), fill(include_str!("../../data/slurm/submit.sh"), &submit)),
        ];
        if *packings > 0 {
            let text = job(include_str!("../../data/slurm/pack.sh"), &self.options, *packings, pack);
            files.push(("pack.sh".to_owned(), text));
        }
        Ok(files)
    }
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

fn path(path: &Path) -> Result<String, ScriptError> {
    let absolute: PathBuf = std::path::absolute(path).unwrap_or_else(|_| path.to_owned());
    match absolute.to_str().filter(|text| !text.chars().any(char::is_control)) {
        Some(text) => Ok(quoted(text)),
        None => Err(ScriptError::Path { path: absolute.display().to_string() }),
    }
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
}
