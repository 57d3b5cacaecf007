//! The commands in groups, as `voidwalk help` lists them: those that most users need with some words each,
//! and the names of the others.

use std::fmt::Write;

use clap::Command;

/// The commands that are listed, by the user's data at hand.
const GROUPS: [(&str, &[&str]); 4] = [
    ("To begin", &["examples", "serve", "soil"]),
    ("Two sieve tables", &["rules", "judge", "design"]),
    ("A scene", &["init", "check", "run", "resume"]),
    ("Many cases, and results", &["campaign", "boundary", "report", "export"]),
];

/// Commands that are named alone.
const MORE: [&str; 5] = ["pack", "constrictions", "percolation", "completions", "man"];

/// The command with a help that lists its commands in groups.
pub(super) fn with_groups(command: Command) -> Command {
    let template = format!(
        "{{about-with-newline}}\n{{usage-heading}} {{usage}}\n\n{}\nOptions:\n{{options}}{{after-help}}",
        in_words(&command)
    );
    command.help_template(template)
}

fn in_words(command: &Command) -> String {
    let is_there = |name: &&&str| command.find_subcommand(name).is_some();
    let width = GROUPS.iter().flat_map(|(_, names)| names.iter()).map(|name| name.len()).max().unwrap_or(0);
    let mut text = String::new();
    // Writing to a string cannot fail.
    for (heading, names) in GROUPS {
        let _ = writeln!(text, "{heading}:");
        for name in names.iter().filter(is_there) {
            let about = command.find_subcommand(name).and_then(Command::get_about);
            let about = about.map(ToString::to_string).unwrap_or_default();
            // First part of the description; the rest is in the command's own help.
            let first = about.split(": ").next().unwrap_or_default();
            let _ = writeln!(text, "  {name:<width$}  {first}");
        }
        text.push('\n');
    }
    let more: Vec<&str> = MORE.iter().filter(is_there).copied().collect();
    let _ = writeln!(text, "More commands: {}", more.join(", "));
    let _ = writeln!(text, "voidwalk COMMAND --help explains one of them, with examples.");
    text
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::cli::examples::command;

    #[test]
    fn every_command_is_named_once_and_fourteen_are_listed_at_most() {
        let listed: Vec<&str> = GROUPS.iter().flat_map(|(_, names)| names.iter().copied()).collect();
        assert!(listed.len() <= 14, "{listed:?}");
        let mut named: Vec<&str> = listed.iter().chain(&MORE).copied().collect();
        named.sort_unstable();
        let whole = command();
        let mut known: Vec<&str> = whole.get_subcommands().map(Command::get_name).collect();
        if !cfg!(feature = "serve") {
            known.push("serve");
        }
        known.sort_unstable();
        assert_eq!(named, known);
    }

    #[test]
    fn the_help_shows_the_groups_and_its_lines_are_short() {
        let help = command().render_help().to_string();
        for (heading, names) in GROUPS {
            let rows = help.split_once(&format!("\n{heading}:\n")).unwrap().1.split("\n\n").next().unwrap();
            assert_eq!(
                rows.lines().count(),
                names.iter().filter(|n| help.contains(&format!("\n  {n} "))).count()
            );
        }
        assert!(help.contains("\nMore commands: pack") && help.contains("\nOptions:\n  -h, --help"));
        assert!(help.lines().all(|line| line.chars().count() <= 100), "{help}");
        assert!(help.contains("Exit codes:\n  0  done"), "{help}");
    }
}
