//! `voidwalk rules --each`: many samples of a base against one or several filters, in one table.

use std::ffi::OsString;
use std::fmt::Write;
use std::path::{Path, PathBuf};

use clap::Parser;

use super::args::{Arguments, Command, RulesArgs};
use super::compare::compare;
use super::print::{counted, plain, shown, to_stdout};
use crate::gradation::{SoilSample, curves_in_file, samples_in};
use crate::outcome::three;
use crate::run::{RunError, write_new};
use crate::verdict::batch::{columns, governing, may_govern};
use crate::verdict::{BatchRow, PairOptions};

/// Samples that govern and are named, to be walked in full.
const NAMED: usize = 3;

/// Applies every rule to each sample and each filter.
pub fn each(args: &RulesArgs, options: PairOptions) -> Result<(), RunError> {
    let samples = samples_in(&args.base).map_err(RunError::refused)?;
    let mut rows = Vec::new();
    for filter in &args.filters {
        let curves = curves_in_file(filter, None).map_err(RunError::refused)?;
        let name = filter.display().to_string();
        let of = |sample: &SoilSample| BatchRow::of((&sample.name, &sample.curve), (&name, &curves), options);
        rows.extend(samples.iter().map(of));
    }
    if let Some(path) = &args.csv {
        let csv = columns().csv(&rows);
        // A call that continues finds the table that it wrote.
        if std::fs::read(path).ok().as_ref() != Some(&csv) {
            write_new(path, &csv)?;
        }
    }
    let mut text = table(&rows);
    for filter in &args.filters {
        text.push('\n');
        text += &of_filter(&rows, filter, &samples, args.walk.is_some());
    }
    if let Some(path) = &args.csv {
        text += &format!("\n{}\n", shown(path));
    }
    to_stdout(&text);
    let Some(folder) = &args.walk else { return Ok(()) };
    for (at, filter) in args.filters.iter().enumerate() {
        let stem = filter.file_stem().unwrap_or_default().to_string_lossy();
        walk(args, filter, &paths(&rows, filter, &samples), &folder.join(format!("{}-{stem}", at + 1)))?;
    }
    Ok(())
}

/// Walks the samples that govern a filter, as `voidwalk compare` does. What is walked already stays.
fn walk(args: &RulesArgs, filter: &Path, samples: &[PathBuf], out: &Path) -> Result<(), RunError> {
    to_stdout(&format!("\n{}\n", plain(&shown(filter))));
    if samples.len() < 2 {
        to_stdout("  fewer than two samples have a limit: nothing to compare\n");
        return Ok(());
    }
    let mut words: Vec<OsString> =
        ["voidwalk", "compare", "--overwrite", "--filter"].map(OsString::from).into();
    words.extend([filter.into(), "--out".into(), out.into()]);
    let set = args.settings.iter().flat_map(|setting| ["--set".into(), OsString::from(setting)]);
    words.extend(set);
    if args.dispersive {
        words.push("--dispersive".into());
    }
    if let Some(mm) = args.joint_mm {
        words.extend(["--joint-mm".into(), OsString::from(mm.to_string())]);
    }
    if args.as_given {
        words.push("--as-given".into());
    }
    words.push("--".into());
    words.extend(samples.iter().map(OsString::from));
    match Arguments::try_parse_from(words).map(|read| read.command) {
        Ok(Command::Compare(read)) => compare(&read),
        Ok(_) => unreachable!("compare was asked for"),
        Err(error) => Err(RunError::Refused(error.to_string())),
    }
}

/// The samples that govern a filter, as a command line names them.
fn paths(rows: &[BatchRow], filter: &Path, samples: &[SoilSample]) -> Vec<PathBuf> {
    let strictest = governing(rows, &filter.display().to_string(), NAMED);
    let path = |row: &BatchRow| samples.iter().find(|of| of.name == row.sample).map(|of| of.path.clone());
    strictest.into_iter().filter_map(path).collect()
}

/// The rows in aligned columns.
fn table(rows: &[BatchRow]) -> String {
    let columns: Vec<_> = columns().of_page().collect();
    let mut lines = vec![columns.iter().map(|column| column.heading.clone()).collect::<Vec<_>>()];
    let cells = |row: &BatchRow| columns.iter().map(|column| plain(&(column.cell)(row).text)).collect();
    lines.extend(rows.iter().map(cells));
    let width = |at: usize| lines.iter().map(|line| line[at].chars().count()).max().unwrap_or(0);
    let widths: Vec<usize> = (0..columns.len()).map(width).collect();
    let mut text = String::new();
    for line in &lines {
        let cell = |(at, cell): (usize, &String)| match columns[at].is_number {
            true => format!("{cell:>0$}", widths[at]),
            false => format!("{cell:<0$}", widths[at]),
        };
        let line: Vec<String> = line.iter().enumerate().map(cell).collect();
        // Writing to a string cannot fail.
        let _ = writeln!(text, "{}", line.join("  ").trim_end());
    }
    text
}

/// How many samples a filter retains, and which govern.
fn of_filter(rows: &[BatchRow], filter: &Path, samples: &[SoilSample], is_walked: bool) -> String {
    let name = filter.display().to_string();
    let count = |met: Option<bool>| rows.iter().filter(|row| row.filter == name && row.met == met).count();
    let [met, not_met, none] = [Some(true), Some(false), None].map(count);
    let mut text = format!(
        "{}: of {} {met} met, {not_met} not met, {none} without a result\n",
        plain(&name),
        counted(samples.len() as u64, "sample", "samples")
    );
    let strictest = governing(rows, &name, NAMED);
    if let [first, others @ ..] = &strictest[..] {
        let limit = |row: &BatchRow| {
            let at_most = if row.limit_at_most { " at most" } else { "" };
            format!("{}: D15F up to {} mm{at_most}", plain(&row.sample), three(row.limit_mm.unwrap_or(0.0)))
        };
        let _ = writeln!(text, "  governing sample {} ({})", limit(first), first.rule);
        for row in others {
            let _ = writeln!(text, "  then {} ({})", limit(row), row.rule);
        }
    }
    let open = may_govern(rows, &name);
    if !open.is_empty() {
        let names: Vec<String> = open.iter().map(|row| plain(&row.sample)).collect();
        let _ = writeln!(text, "  may govern, as its limit is not known: {}", names.join(", "));
    }
    if is_walked {
        return text;
    }
    let paths: Vec<String> = paths(rows, filter, samples).iter().map(|path| quoted(path)).collect();
    let walk = match paths.len() {
        0 => return text,
        1 => format!("voidwalk judge {} {}", paths[0], quoted(filter)),
        _ => format!("voidwalk compare --filter {} {}", quoted(filter), paths.join(" ")),
    };
    let _ = writeln!(text, "  Nothing was walked. To walk those that govern: {walk}");
    text
}

/// A path as a shell takes it.
fn quoted(path: &Path) -> String {
    let text = plain(&shown(path));
    if text.chars().all(|c| c.is_ascii_alphanumeric() || "./_-".contains(c)) {
        text
    } else {
        format!("\"{text}\"")
    }
}
