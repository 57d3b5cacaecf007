//! `voidwalk rules --each`: many samples of a base against one or several filters, in one table.

use std::fmt::Write;
use std::path::{Path, PathBuf};

use super::args::RulesArgs;
use super::compare::{show, walked};
use super::print::{plain, shown, to_copy, to_stdout};
use super::run::command_line;
use super::values::{of_soils, with_options};
use crate::campaign::CampaignOptions;
use crate::outcome::comparison::Comparison;
use crate::outcome::quantity::SizeUnit;
use crate::outcome::table::{Columns, Shown};
use crate::run::{PrepareOptions, RunError, write_new};
use crate::scene::TableOptions;
use crate::study::compare::{self, ComparePlan, Compared};
use crate::study::refuse_twice;
use crate::verdict::batch::{NAMED, governing};
use crate::verdict::{BatchFilter, BatchRow, BatchTable, PairOptions};
use crate::words::batch::{columns, of_filter as filter_lines};

/// Why several filters are refused.
pub(super) const SEVERAL_FILTERS: &str =
    "several filters go with --each, which takes every soil of the base by itself";

impl RulesArgs {
    /// What the scenes of the walks are given besides the soils.
    ///
    /// # Errors
    /// A setting is given by an option of its own and by --set, too.
    fn changes(&self) -> Result<Vec<String>, RunError> {
        with_options(&self.settings, of_soils(self.dispersive, self.joint_mm))
    }
}

/// Applies every rule to each sample and each filter.
pub fn each(args: &RulesArgs, options: PairOptions) -> Result<(), RunError> {
    refuse_twice(&args.filters)?;
    let table = BatchTable::read(&args.base, &args.filters, options).map_err(RunError::refused)?;
    let rows = &table.rows;
    let walks = walks(args, rows)?;
    if let Some(path) = &args.csv {
        let csv = columns(SizeUnit::Mm).csv(rows);
        // A call that continues finds the table that it wrote.
        if std::fs::read(path).ok().as_ref() != Some(&csv) {
            write_new(path, &csv)?;
        }
    }
    let mut text = aligned(columns(SizeUnit::Mm), rows);
    let notes: Vec<String> =
        table.notes.iter().map(|(file, note)| format!("{}: {note}", shown(file))).collect();
    text += &in_notes(&notes);
    for filter in &table.filters {
        text.push('\n');
        text += &of_filter(rows, filter, false);
        text += &to_walk(rows, Path::new(&filter.name), args.walk.is_some());
    }
    if let Some(path) = &args.csv {
        text += &format!("\n{}\n", shown(path));
    }
    to_stdout(&text);
    for walk in &walks {
        to_stdout(&format!("\n{}\n", plain(&shown(&walk.filter))));
        let walked = || walked(&walk.plan, &walk.options, false, false);
        let comparison = walk.found.clone().map_or_else(walked, Ok)?;
        show(&walk.plan, &comparison, &walk.options.out);
    }
    Ok(())
}

/// What was assumed of the files, a line each.
pub(super) fn in_notes(notes: &[String]) -> String {
    let lines = notes.iter().map(|note| format!("note  {}\n", plain(note))).collect::<String>();
    if lines.is_empty() { lines } else { format!("\n{lines}") }
}

/// Samples that govern a filter, to be walked as `voidwalk compare` does.
struct PlannedWalk {
    filter: PathBuf,
    plan: ComparePlan,
    options: CampaignOptions,
    /// What is walked already.
    found: Option<Comparison>,
}

/// The walks of all filters that have samples to compare, each found sound before anything is written.
fn walks(args: &RulesArgs, rows: &[BatchRow]) -> Result<Vec<PlannedWalk>, RunError> {
    let Some(folder) = &args.walk else { return Ok(Vec::new()) };
    let tables =
        TableOptions { as_given: args.as_given, changes: args.changes()?, ..TableOptions::default() };
    let mut walks = Vec::new();
    for (at, filter) in args.filters.iter().enumerate() {
        let bases = paths(rows, filter);
        if bases.len() > 1 {
            let stem = filter.file_stem().unwrap_or_default().to_string_lossy();
            let options = CampaignOptions {
                out: folder.join(format!("{}-{stem}", at + 1)),
                packings: Some(PrepareOptions::default().packings),
                command: command_line(),
                ..CampaignOptions::default()
            };
            let plan = ComparePlan::new(&Compared::Bases { filter: filter.clone(), bases }, &tables)?;
            let found = compare::found(&plan, &options)?;
            walks.push(PlannedWalk { filter: filter.clone(), plan, options, found });
        }
    }
    Ok(walks)
}

/// The samples that govern a filter, as a command line names them.
fn paths(rows: &[BatchRow], filter: &Path) -> Vec<PathBuf> {
    let strictest = governing(rows, &filter.display().to_string(), NAMED);
    strictest.into_iter().map(|row| row.path.clone()).collect()
}

/// The rows in aligned columns.
pub(super) fn aligned<T>(columns: Columns<T>, rows: &[T]) -> String {
    let columns: Vec<_> = columns.of_page().collect();
    let mut lines = vec![columns.iter().map(|column| column.heading.clone()).collect::<Vec<_>>()];
    let cell = |shown: Shown| [&[shown.text], &shown.below[..]].concat().join("; ");
    let cells = |row: &T| columns.iter().map(|column| plain(&cell((column.cell)(row)))).collect();
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
pub(super) fn of_filter(rows: &[BatchRow], filter: &BatchFilter, inches: bool) -> String {
    let lines = filter_lines(filter, rows, SizeUnit::of(false, inches));
    lines.iter().map(|line| plain(line)).collect::<Vec<_>>().join("\n  ") + "\n"
}

/// The command that walks the samples that govern, or that nothing was walked.
fn to_walk(rows: &[BatchRow], filter: &Path, is_walked: bool) -> String {
    let paths: Vec<String> = paths(rows, filter).iter().map(to_copy).collect();
    let walk = match paths.len() {
        0 if is_walked => return "  Nothing was walked, as no sample has a limit.\n".into(),
        0 => return String::new(),
        // One sample is nothing to compare.
        1 => format!("voidwalk judge {} {}", paths[0], to_copy(filter)),
        _ if is_walked => return String::new(),
        _ => format!("voidwalk compare --filter {} {}", to_copy(filter), paths.join(" ")),
    };
    let which = if paths.len() == 1 { "the one that governs" } else { "those that govern" };
    format!("  Nothing was walked. To walk {which}: {walk}\n")
}
