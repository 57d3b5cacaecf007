//! Commands to type: two examples in the help of every command, a short `-h`, the full `--help`, and the
//! first words for a user who types only `voidwalk`.

use std::sync::LazyLock;

use clap::{Arg, Command, CommandFactory};

use super::args::Arguments;
use super::exit;

/// Two examples for every command; the command is the second word of a line.
const EXAMPLES: [[&str; 2]; 38] = [
    ["voidwalk run", "the built-in scene"],
    ["voidwalk run dam.toml --set replicates=30 --out dam", "your own scene, with one setting changed"],
    ["voidwalk judge base.csv filter.csv --quick", "a first look: five replicates, loose and dense"],
    ["voidwalk judge base.csv fine.csv coarse.csv", "two filters, in one table"],
    ["voidwalk serve", "prints the address to open in the browser"],
    ["voidwalk serve --port 8080 --out site", "on a port and in a folder of your choice"],
    ["voidwalk resume voidwalk-run", "continues where the run was stopped"],
    ["voidwalk resume dam --threads 2", "on two cores, with the same bits"],
    ["voidwalk check", "memory and time of the built-in scene"],
    ["voidwalk check dam.toml --set filter.density=loose", "memory and time before a run"],
    ["voidwalk rules base.csv filter.csv", "every rule of filter practice, the base first"],
    ["voidwalk rules base.csv filter.csv --dispersive --joint-mm 2", "beside an open joint of 2 mm"],
    ["voidwalk soil site.xlsx", "every soil of a workbook, with its sizes and class"],
    ["voidwalk soil --template site.xlsx", "a workbook to fill in"],
    ["voidwalk init", "shows every setting with its meaning"],
    ["voidwalk init dam.toml", "writes them into a file to start from"],
    ["voidwalk examples try", "writes the files into the folder try, and says what to type"],
    ["voidwalk examples .", "into this folder"],
    ["voidwalk design base.csv", "the specification of a filter, step by step"],
    ["voidwalk design site.ags --each", "for every sample of a file, and which governs"],
    ["voidwalk boundary base.csv --filter 1.5", "of a filter with Cu 1.5, loose to dense"],
    ["voidwalk boundary --set base.cu=3 --density loose", "without sizes"],
    ["voidwalk campaign plan.toml --out study", "walks every case that is not done"],
    ["voidwalk campaign plan.toml --list", "names the cases and does nothing"],
    ["voidwalk pack filter.toml", "packs the filter of a scene"],
    ["voidwalk pack filter.toml --set packing.grains=20000 --out dense", "with this many grains"],
    ["voidwalk constrictions grains.csv", "grains with columns x_mm, y_mm, z_mm, diameter_mm"],
    ["voidwalk constrictions grains.txt --unit m --cell none", "of Yade: metres, no periodic cell"],
    ["voidwalk percolation", "lattices of 10 to 160 voids along a side"],
    ["voidwalk percolation --sizes 10,20,40x40x60", "two small ones, and the lattice of the paper"],
    ["voidwalk report voidwalk-run", "writes the page again"],
    ["voidwalk report voidwalk-campaign", "of a campaign, too"],
    ["voidwalk export voidwalk-run", "numpy.load(\"voidwalk-run/export/arrays.npz\") reads its tables"],
    ["voidwalk export voidwalk-constrictions", "of constrictions, a packing or a campaign, too"],
    ["voidwalk completions bash > voidwalk.bash", "then: source voidwalk.bash"],
    ["voidwalk completions powershell", "for bash, elvish, fish, powershell or zsh"],
    ["voidwalk man pages", "a page of every command, in the folder pages"],
    ["voidwalk man ~/.local/share/man/man1", "where `man voidwalk-run` finds them"],
];

pub(crate) const FIRST_WORDS: &str = "\
Will this filter hold this soil? Type first, with two sieve tables (CSV, .xlsx, .ods, AGS4), the base before
the filter:

  voidwalk judge base.csv filter.csv --quick            a first look, in seconds to minutes
  voidwalk judge base.csv filter.csv --pack             the filter's grains packed: minutes

Without tables at hand:

  voidwalk examples try    writes sheets, a scene, a plan and a notebook into the folder try
  voidwalk run             the built-in example; its page is voidwalk-run/report.html
  voidwalk serve           a page in the browser of this machine: drop two sheets there

All commands: voidwalk help. One of them, with examples: voidwalk judge --help
";

static VERSION: LazyLock<String> = LazyLock::new(|| {
    let number = env!("CARGO_PKG_VERSION");
    option_env!("VOIDWALK_COMMIT").map_or_else(|| number.into(), |commit| format!("{number} ({commit})"))
});

pub(crate) fn command() -> Command {
    let command = Arguments::command().version(VERSION.as_str()).after_help(exit::in_words());
    let template = format!(
        "{{about-with-newline}}\n{{usage-heading}} {{usage}}\n\n{}\nOptions:\n{{options}}{{after-help}}",
        groups_in_words(&command)
    );
    command.help_template(template).mut_subcommands(|sub| {
        let text = examples_in_words(sub.get_name());
        sub.after_help(text).mut_args(short_and_long)
    })
}

fn examples_of(command: &str) -> impl Iterator<Item = &'static [&'static str; 2]> {
    EXAMPLES.iter().filter(move |[line, _]| line.split(' ').nth(1) == Some(command))
}

fn examples_in_words(command: &str) -> String {
    let lines = examples_of(command).map(|[line, what]| format!("  {line}\n      {what}"));
    format!("Examples:\n{}", lines.collect::<Vec<_>>().join("\n"))
}

/// Maximum length of an argument's description in `-h` (characters), unless its first clause is longer.
const SHORT: usize = 90;

/// Shows the first clause of an argument's description in `-h`, and all of it in `--help`.
fn short_and_long(arg: Arg) -> Arg {
    let Some(whole) = arg.get_help().map(ToString::to_string) else { return arg };
    let first = [": ", "; ", ". ", " [", ", so that"].iter().filter_map(|end| whole.find(end)).min();
    match first {
        Some(end) if whole.chars().count() > SHORT => {
            let short = whole[..end].to_owned();
            arg.help(short).long_help(whole)
        }
        _ => arg,
    }
}

const GROUPS: [(&str, &[&str]); 4] = [
    ("To begin", &["examples", "serve", "soil"]),
    ("Two sieve tables", &["rules", "judge", "design"]),
    ("A scene", &["init", "check", "run", "resume"]),
    ("Many cases, and results", &["campaign", "boundary", "report", "export"]),
];

const MORE: [&str; 5] = ["pack", "constrictions", "percolation", "completions", "man"];

fn groups_in_words(command: &Command) -> String {
    let is_there = |name: &&&str| command.find_subcommand(name).is_some();
    let width = GROUPS.iter().flat_map(|(_, names)| names.iter()).map(|name| name.len()).max().unwrap_or(0);
    let mut text = String::new();
    for (heading, names) in GROUPS {
        text += &format!("{heading}:\n");
        for name in names.iter().filter(is_there) {
            let about = command.find_subcommand(name).and_then(Command::get_about);
            let about = about.map(ToString::to_string).unwrap_or_default();
            // First part of the description; the rest is in the command's own help.
            let first = about.split(": ").next().unwrap_or_default();
            text += &format!("  {name:<width$}  {first}\n");
        }
        text.push('\n');
    }
    let more: Vec<&str> = MORE.iter().filter(is_there).copied().collect();
    text += &format!("More commands: {}\n", more.join(", "));
    text + "voidwalk COMMAND --help explains one of them, with examples.\n"
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_command_has_two_examples_that_are_understood() {
        let commands = command();
        let shown: Vec<&str> = commands.get_subcommands().map(Command::get_name).collect();
        for name in &shown {
            assert_eq!(examples_of(name).count(), 2, "{name}");
            for [line, _] in examples_of(name) {
                // The line is split as a shell does.
                let line = line.split(" > ").next().unwrap_or_default();
                let words = line.split('"').enumerate().flat_map(|(at, part)| match at % 2 {
                    0 => part.split_whitespace().collect::<Vec<_>>(),
                    _ => vec![part],
                });
                let words: Vec<&str> = words.collect();
                let read = command().try_get_matches_from(&words);
                assert!(read.is_ok(), "{line}: {}", read.unwrap_err());
            }
        }
        let known = shown.len() + usize::from(!cfg!(feature = "serve"));
        assert_eq!(EXAMPLES.len(), 2 * known);
        command().debug_assert();
    }

    #[test]
    fn short_help_is_shorter_and_long_help_says_all() {
        let help = |long: bool| {
            let mut command = command();
            let run = command.find_subcommand_mut("run").unwrap();
            if long { run.render_long_help().to_string() } else { run.render_help().to_string() }
        };
        let (short, long) = (help(false), help(true));
        assert!(short.lines().count() * 3 < long.lines().count() * 2, "{short}\n{long}");
        assert!(!short.contains("mapped") && long.contains("mapped"), "{short}");
        assert!([&short, &long].iter().all(|text| text.contains("Examples:\n  voidwalk run\n")));
    }

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
            let is_there = |name: &&&str| help.contains(&format!("\n  {name} "));
            assert_eq!(rows.lines().count(), names.iter().filter(is_there).count());
        }
        assert!(help.contains("\nMore commands: pack") && help.contains("\nOptions:\n  -h, --help"));
        assert!(help.lines().all(|line| line.chars().count() <= 100), "{help}");
        assert!(help.contains("Exit codes:\n  0  done"), "{help}");
    }
}
