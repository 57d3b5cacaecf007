//! Printing that outlives a closed pipe.

use std::io::Write;
use std::path::Path;

use serde::Serialize;

use crate::report::figures::visible;
use crate::run::RunError;

/// Prints to stdout; a reader that has left is no fault of ours.
pub fn to_stdout(text: &str) {
    let mut out = std::io::stdout().lock();
    let _ = out.write_all(text.as_bytes()).and_then(|()| out.flush());
}

/// Prints to stderr, likewise.
pub fn to_stderr(text: &str) {
    let _ = std::io::stderr().lock().write_all(text.as_bytes());
}

/// A name made safe for a terminal: characters that control it or turn the direction of writing are replaced.
pub fn plain(text: &str) -> String {
    text.chars().map(|c| if c.is_control() { '?' } else { visible(c) }).collect()
}

/// A path made safe for a terminal.
pub fn shown(path: &Path) -> String {
    plain(&path.display().to_string())
}

/// A value as indented JSON with a newline at its end.
pub fn json(value: &impl Serialize) -> Result<String, RunError> {
    Ok(serde_json::to_string_pretty(value)? + "\n")
}

/// A count with thin groups: `2 620 000`.
pub fn count(n: u64) -> String {
    let digits = n.to_string();
    let groups: Vec<&str> =
        digits.as_bytes().rchunks(3).rev().map(|g| std::str::from_utf8(g).unwrap_or_default()).collect();
    groups.join(" ")
}

/// A count and what is counted, one or many: `1 replicate`.
pub fn counted(n: u64, one: &str, many: &str) -> String {
    format!("{} {}", count(n), if n == 1 { one } else { many })
}

/// A percentage with digits that mean something.
pub fn percent(fraction: f64) -> String {
    let p = 100.0 * fraction;
    if p == 0.0 || p >= 10.0 { format!("{p:.1} %") } else { format!("{p:.2} %") }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_read_well() {
        assert_eq!(count(2_620_000), "2 620 000");
        assert_eq!(count(12), "12");
        assert_eq!(
            [percent(0.0), percent(0.0666), percent(0.4), percent(1.0)],
            ["0.0 %", "6.66 %", "40.0 %", "100.0 %"]
        );
        assert_eq!(plain("a\u{1b}[31mb"), "a?[31mb");
    }
}
