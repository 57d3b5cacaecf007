//! Printing that ignores a closed pipe and remembers other failures.

use std::io::{self, ErrorKind, Write};
use std::path::Path;
use std::sync::OnceLock;

use serde::Serialize;

use crate::run::RunError;
use voidwalk_core::store::format::Format;

pub(crate) use crate::run::folder::shown;
pub(crate) use voidwalk_core::text::plain;
use voidwalk_core::text::shell_word;
use voidwalk_practice::quantity::THIN;
pub(crate) use voidwalk_practice::quantity::{percent, whole};

static LOST: OnceLock<String> = OnceLock::new();

/// Prints words to stdout; [`whole_stdout`] reports a failure.
pub(crate) fn to_stdout(text: &str) {
    as_it_is(&on_a_terminal(text));
}

/// Prints a record to stdout unchanged; failures are reported likewise.
pub(crate) fn as_it_is(text: &str) {
    by_stdout(|| io::stdout().write_all(text.as_bytes()));
}

/// Words with only such spaces as every terminal shows and every search finds.
fn on_a_terminal(text: &str) -> String {
    text.replace(THIN, " ")
}

/// Prints to stdout by a function; failures are reported likewise.
pub(crate) fn by_stdout(print: impl FnOnce() -> io::Result<()>) {
    let printed = print().and_then(|()| io::stdout().flush());
    // A reader that has left is no error of the program.
    if let Some(error) = printed.err().filter(|error| error.kind() != ErrorKind::BrokenPipe) {
        LOST.get_or_init(|| error.to_string());
    }
}

/// Fails if anything could not be written to stdout, except to a closed pipe.
pub(crate) fn whole_stdout() -> Result<(), RunError> {
    LOST.get().map_or(Ok(()), |error| Err(RunError::failed(format!("cannot write to stdout: {error}"))))
}

/// Prints to stderr, where a failure cannot be reported.
pub(crate) fn to_stderr(text: &str) {
    let _ = std::io::stderr().lock().write_all(on_a_terminal(text).as_bytes());
}

pub(crate) fn to_copy(word: impl AsRef<Path>) -> String {
    plain(&shell_word(&word.as_ref().display().to_string()))
}

pub(crate) fn lines(lines: impl IntoIterator<Item = impl AsRef<str>>) -> String {
    lines.into_iter().map(|line| plain(line.as_ref()) + "\n").collect()
}

pub(crate) fn labelled(name: &str, value: &str) -> String {
    format!("{name:<22}{}\n", plain(value))
}

/// Prints a result: its record as in its file, or its words unless it must be quiet.
pub(crate) fn answer(
    (as_json, quiet): (bool, bool),
    format: Format,
    record: &impl Serialize,
    words: impl FnOnce() -> String,
) -> Result<(), RunError> {
    if as_json {
        as_it_is(&format.json(record)?);
    } else if !quiet {
        to_stdout(&words());
    }
    Ok(())
}

/// Count with its noun in the singular or plural: `1 replicate`.
pub(crate) fn counted(n: u64, one: &str, many: &str) -> String {
    format!("{} {}", whole(n), if n == 1 { one } else { many })
}

pub(crate) fn grains_per_void(grains: Option<f64>) -> String {
    let words = |grains: f64| format!("{} grains per void", (grains * 1e4).round() / 1e4);
    grains.map_or_else(|| "grains per void not given".into(), words)
}

const WIDTH: usize = 100;

/// Text in lines that begin with this many spaces.
pub(crate) fn wrapped(text: &str, indent: usize) -> Vec<String> {
    let indent = " ".repeat(indent);
    let mut lines = vec![indent.clone()];
    for word in text.split_whitespace() {
        let last = lines.last().expect("there is a line");
        if last.chars().count() + word.chars().count() >= WIDTH && last.len() > indent.len() {
            lines.push(indent.clone());
        }
        let last = lines.last_mut().expect("there is a line");
        if last.len() > indent.len() {
            last.push(' ');
        }
        last.push_str(word);
    }
    lines
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn counts_and_names_read_well() {
        assert!(wrapped(&"word ".repeat(60), 13).iter().all(|line| line.len() < WIDTH));
        assert_eq!(counted(1, "replicate", "replicates"), "1 replicate");
        assert_eq!(counted(12_000, "replicate", "replicates"), "12\u{202f}000 replicates");
        assert_eq!(plain("a\u{1b}[31mb"), "a\u{fffd}[31mb");
    }
}
