//! `voidwalk rules --each`: many samples of a base against one or several filters, in one table.

use std::collections::HashSet;
use std::ffi::OsString;
use std::fmt::Write;
use std::path::{Path, PathBuf};

use clap::Parser;

use super::args::{Arguments, Command, CompareArgs, RulesArgs};
use super::compare::{found, planned, show, walked};
use super::print::{counted, plain, shown, to_stdout};
use crate::campaign::cluster::scripts::quoted_if_needed;
use crate::gradation::{curves_in_file, file_and_soil, notes_in_file, samples_in};
use crate::outcome::comparison::Comparison;
use crate::outcome::three;
use crate::run::{RunError, write_new};
use crate::study::compare::ComparePlan;
use crate::verdict::batch::{columns, governing, may_govern, more_with_that_limit};
use crate::verdict::{BatchRow, PairOptions};

/// Samples that govern and are named, to be walked in full.
const NAMED: usize = 3;

/// Applies every rule to each sample and each filter.
pub fn each(args: &RulesArgs, options: PairOptions) -> Result<(), RunError> {
    let samples = samples_in(&args.base).map_err(RunError::refused)?;
    let (mut rows, mut envelopes) = (Vec::new(), Vec::new());
    for filter in &args.filters {
        let curves = curves_in_file(filter, None).map_err(RunError::refused)?;
        let name = filter.display().to_string();
        rows.extend(samples.iter().map(|sample| BatchRow::of(sample, (&name, &curves), options)));
        envelopes.push(curves.into_iter().map(|(name, _)| name).collect::<Vec<_>>());
    }
    let files: Vec<PathBuf> = match args.base.is_dir() {
        true => samples.iter().map(|sample| file_and_soil(&sample.path).0).collect(),
        false => vec![args.base.clone()],
    };
    let notes = notes(files.iter().chain(&args.filters))?;
    let walks = walks(args, &rows)?;
    if let Some(path) = &args.csv {
        let csv = columns().csv(&rows);
        // A call that continues finds the table that it wrote.
        if std::fs::read(path).ok().as_ref() != Some(&csv) {
            write_new(path, &csv)?;
        }
    }
    let mut text = table(&rows);
    if !notes.is_empty() {
        text.push('\n');
        text.extend(notes.iter().map(|note| plain(note) + "\n"));
    }
    for (filter, curves) in args.filters.iter().zip(&envelopes) {
        text.push('\n');
        text += &of_filter(&rows, filter, curves, args.walk.is_some());
    }
    if let Some(path) = &args.csv {
        text += &format!("\n{}\n", shown(path));
    }
    to_stdout(&text);
    for walk in &walks {
        to_stdout(&format!("\n{}\n", plain(&shown(&walk.filter))));
        match &walk.found {
            Some(found) => show(&walk.args, &walk.plan, found)?,
            None => walked(&walk.args, &walk.plan)?,
        }
    }
    Ok(())
}

/// What was assumed of each file, once.
fn notes<'a>(files: impl Iterator<Item = &'a PathBuf>) -> Result<Vec<String>, RunError> {
    let (mut read, mut notes) = (HashSet::new(), Vec::new());
    for file in files.filter(|file| read.insert(*file)) {
        let of_file = notes_in_file(file).map_err(RunError::refused)?;
        notes.extend(of_file.into_iter().map(|note| format!("note  {}: {note}", shown(file))));
    }
    Ok(notes)
}

/// Samples that govern a filter, to be walked as `voidwalk compare` does.
struct PlannedWalk {
    filter: PathBuf,
    args: CompareArgs,
    plan: ComparePlan,
    /// What is walked already.
    found: Option<Comparison>,
}

/// The walks of all filters that have samples to compare, each found sound before anything is written.
fn walks(args: &RulesArgs, rows: &[BatchRow]) -> Result<Vec<PlannedWalk>, RunError> {
    let Some(folder) = &args.walk else { return Ok(Vec::new()) };
    let mut walks = Vec::new();
    for (at, filter) in args.filters.iter().enumerate() {
        let samples = paths(rows, filter);
        if samples.len() > 1 {
            let stem = filter.file_stem().unwrap_or_default().to_string_lossy();
            let args = compare_args(args, filter, &samples, &folder.join(format!("{}-{stem}", at + 1)))?;
            let plan = planned(&args)?;
            let found = found(&args, &plan)?;
            walks.push(PlannedWalk { filter: filter.clone(), args, plan, found });
        }
    }
    Ok(walks)
}

/// The samples that govern a filter, as `voidwalk compare` is asked for them.
fn compare_args(
    args: &RulesArgs,
    filter: &Path,
    samples: &[PathBuf],
    out: &Path,
) -> Result<CompareArgs, RunError> {
    let mut words: Vec<OsString> = ["voidwalk", "compare", "--filter"].map(OsString::from).into();
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
        Ok(Command::Compare(read)) => Ok(read),
        Ok(_) => unreachable!("compare was asked for"),
        Err(error) => Err(RunError::Refused(error.to_string())),
    }
}

/// The samples that govern a filter, as a command line names them.
fn paths(rows: &[BatchRow], filter: &Path) -> Vec<PathBuf> {
    let strictest = governing(rows, &filter.display().to_string(), NAMED);
    strictest.into_iter().map(|row| row.path.clone()).collect()
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

/// How many samples a filter retains, and which govern. Of an envelope the curves are named.
fn of_filter(rows: &[BatchRow], filter: &Path, curves: &[String], is_walked: bool) -> String {
    let name = filter.display().to_string();
    let samples = rows.iter().filter(|row| row.filter == name).count();
    let count = |met: Option<bool>| rows.iter().filter(|row| row.filter == name && row.met == met).count();
    let [met, not_met, none] = [Some(true), Some(false), None].map(count);
    let mut text = format!(
        "{}: of {} {met} met, {not_met} not met, {none} without a result\n",
        plain(&name),
        counted(samples as u64, "sample", "samples")
    );
    if curves.len() > 1 {
        let _ = writeln!(
            text,
            "  an envelope of {} curves ({}): retention by the coarsest, drainage by the finest",
            curves.len(),
            plain(&curves.join(", "))
        );
    }
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
        let more = more_with_that_limit(rows, &name, &strictest);
        if more > 0 {
            let _ = writeln!(text, "  and {more} more with the same limit");
        }
    }
    let open = may_govern(rows, &name);
    if !open.is_empty() {
        let names: Vec<String> = open.iter().map(|row| plain(&row.sample)).collect();
        let _ = writeln!(text, "  may govern, as its limit is not known: {}", names.join(", "));
    }
    let quoted = |path: &Path| plain(&quoted_if_needed(path));
    let paths: Vec<String> = paths(rows, filter).iter().map(|path| quoted(path)).collect();
    let walk = match paths.len() {
        0 if is_walked => return text + "  Nothing was walked, as no sample has a limit.\n",
        0 => return text,
        // One sample is nothing to compare.
        1 => format!("voidwalk judge {} {}", paths[0], quoted(filter)),
        _ if is_walked => return text,
        _ => format!("voidwalk compare --filter {} {}", quoted(filter), paths.join(" ")),
    };
    let which = if paths.len() == 1 { "the one that governs" } else { "those that govern" };
    let _ = writeln!(text, "  Nothing was walked. To walk {which}: {walk}");
    text
}
