//! `voidwalk examples`: files to try the program with, and commands to type.

use std::fmt::Write;
use std::path::Path;

use super::print::{to_copy, to_stdout};
use crate::run::{EXAMPLE_FILES, RunError, write_examples};

/// Commands to try with the files, from within their folder: a command line, and its effect.
const TO_TRY: [[&str; 2]; 9] = [
    ["voidwalk soil us-sieves.csv", "what is read from a sheet"],
    ["voidwalk rules base.csv filter.csv", "every rule of practice"],
    ["voidwalk rules borrow-area.ags filter-fine.csv filter.csv --each", "many samples, two filters"],
    ["voidwalk judge base.csv filter.csv --quick", "rules and walk, and a page"],
    ["voidwalk judge base.csv filter-fine.csv filter.csv --quick", "two filters, in one table"],
    ["voidwalk design base.csv", "the specification of a filter for it"],
    ["voidwalk run scene.toml --out scene", "the scene"],
    ["voidwalk campaign plan.toml", "the plan"],
    ["jupyter notebook notebook.ipynb", "with the Python packages voidwalk and matplotlib"],
];

/// Writes the examples and prints commands to try.
pub fn examples(folder: &Path) -> Result<(), RunError> {
    write_examples(folder)?;
    let mut text = String::new();
    for file in EXAMPLE_FILES {
        // Writing to a string cannot fail.
        let _ = writeln!(text, "{:<18}{}", file.name, file.what);
    }
    let _ = writeln!(text, "\nTo try:\n\n  cd {}", to_copy(folder));
    for [line, what] in TO_TRY {
        let _ = writeln!(text, "  {line:<68}  {what}");
    }
    to_stdout(&text);
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::cli::examples::command;

    #[test]
    fn what_is_to_try_is_understood_and_names_files_that_are_written() {
        for [line, _] in TO_TRY {
            let mut words = line.split_whitespace();
            if words.clone().next() == Some("voidwalk") {
                let read = command().try_get_matches_from(words.clone());
                assert!(read.is_ok(), "{line}: {}", read.unwrap_err());
            }
            let is_file = |word: &&str| word.contains('.') && !word.starts_with('-');
            for word in words.by_ref().filter(is_file) {
                assert!(EXAMPLE_FILES.iter().any(|file| file.name == word), "{line}: {word}");
            }
        }
    }
}
