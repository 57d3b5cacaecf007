//! Cases of each task of a job array.
//!
//! The file has one line a case: the task's number, a tab, the case's name. Names hold neither tabs nor line
//! ends (the plan refuses them) and are read by the program alone, never by a shell.

use std::fmt::Write;

/// Tasks that a job array may have: Slurm's own limit unless it is raised.
pub const MOST_TASKS: usize = 1000;

/// Why a task cannot be walked.
#[derive(Debug, thiserror::Error)]
pub enum TaskError {
    /// No task of this number.
    #[error("{file}: there is no task {number}; it has {tasks}")]
    NoTask {
        /// The file.
        file: String,
        /// The number.
        number: u64,
        /// Number of tasks.
        tasks: u64,
    },
    /// A line that was not written by this program.
    #[error("{file}, line {line}: must be a task's number, a tab and the name of a case")]
    Line {
        /// The file.
        file: String,
        /// The line.
        line: usize,
    },
}

/// Bundles cases into `tasks` tasks of about the same seconds each; every task has a case, and its cases are
/// in the order of the plan. Cases are given by their seconds, tasks by the places of their cases.
pub fn bundle(seconds: &[f64], tasks: usize) -> Vec<Vec<usize>> {
    let tasks = tasks.clamp(1, MOST_TASKS).min(seconds.len());
    let mut longest_first: Vec<usize> = (0..seconds.len()).collect();
    longest_first.sort_by(|a, b| seconds[*b].total_cmp(&seconds[*a]));
    let mut bundles = vec![(0.0, Vec::new()); tasks];
    for case in longest_first {
        let load = |bundle: &(f64, Vec<usize>)| (bundle.0, bundle.1.len());
        let less = |a: &(f64, usize), b: &(f64, usize)| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1));
        if let Some(least) = bundles.iter_mut().min_by(|a, b| less(&load(a), &load(b))) {
            least.0 += seconds[case];
            least.1.push(case);
        }
    }
    let mut all: Vec<Vec<usize>> = bundles.into_iter().map(|(_, cases)| cases).collect();
    all.iter_mut().for_each(|cases| cases.sort_unstable());
    all.sort();
    all
}

/// The file of these tasks.
pub fn to_text(tasks: &[Vec<&str>]) -> String {
    let mut text = String::new();
    for (number, names) in (1..).zip(tasks) {
        for name in names {
            // Writing to a string cannot fail.
            let _ = writeln!(text, "{number}\t{name}");
        }
    }
    text
}

/// Names of the cases of a task, from the text of a file.
///
/// # Errors
/// A line that is not of the form, a task that is not there.
pub fn read<'a>(file: &str, text: &'a str, number: u64) -> Result<Vec<&'a str>, TaskError> {
    let (mut names, mut tasks) = (Vec::new(), 0);
    for (line, words) in (1..).zip(text.lines()) {
        let (task, name) = words
            .split_once('\t')
            .and_then(|(task, name)| Some((task.parse::<u64>().ok()?, name)))
            .ok_or_else(|| TaskError::Line { file: file.to_owned(), line })?;
        tasks = tasks.max(task);
        if task == number {
            names.push(name);
        }
    }
    match names.is_empty() {
        true => Err(TaskError::NoTask { file: file.to_owned(), number, tasks }),
        false => Ok(names),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

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
        let text = to_text(&[names[..2].to_vec(), names[2..].to_vec()]);
        assert_eq!(read("t", &text, 1).unwrap(), names[..2]);
        assert_eq!(read("t", &text, 2).unwrap(), names[2..]);
        assert_eq!(read("t", &text, 3).unwrap_err().to_string(), "t: there is no task 3; it has 2");
        assert!(read("t", "1 x\n", 1).unwrap_err().to_string().contains("line 1"));
    }
}
