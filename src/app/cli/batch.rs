//! `voidwalk rules` of several filters, or with --each of many samples of a base: in one table.

use std::fmt::Write;
use std::path::{Path, PathBuf};

use super::args::RulesArgs;
use super::print::{plain, shown, to_copy, to_stdout};
use crate::cases::pairs_of;
use crate::outcome::table::{ColumnKind, Columns};
use crate::run::{RunError, write_new};
use crate::words::batch::{columns, of_filter as filter_lines};
use voidwalk_practice::batch::{NAMED, governing};
use voidwalk_practice::quantity::SizeUnit;
use voidwalk_practice::{BatchFilter, BatchRow, PairOptions};

/// Applies every rule to each sample and each filter.
pub fn each(args: &RulesArgs, options: PairOptions) -> Result<(), RunError> {
    if args.json {
        return Err(RunError::refused("--json goes with one filter, without --each"));
    }
    let table = pairs_of(&args.base, &args.filters, options, args.each)?;
    let rows = &table.rows;
    if let Some(path) = &args.csv {
        let csv = columns(SizeUnit::Mm).csv(rows);
        // A call that continues finds the table that it wrote.
        if std::fs::read(path).ok().as_ref() != Some(&csv) {
            write_new(path, &csv)?;
        }
    }
    let mut text = aligned(columns(SizeUnit::Mm), rows);
    text += &in_notes(&table.notes);
    for filter in &table.filters {
        text.push('\n');
        text += &of_filter(rows, filter, false);
        text += &to_walk(&args.base, options, rows, Path::new(&filter.name));
    }
    if let Some(path) = &args.csv {
        text += &format!("\n{}\n", shown(path));
    }
    to_stdout(&text);
    Ok(())
}

/// Assumptions about the files, a line each.
pub(super) fn in_notes(notes: &[String]) -> String {
    let lines = notes.iter().map(|note| format!("note  {}\n", plain(note))).collect::<String>();
    if lines.is_empty() { lines } else { format!("\n{lines}") }
}

/// The samples that govern a filter, as a command line names them.
fn paths(rows: &[BatchRow], filter: &Path) -> Vec<PathBuf> {
    let strictest = governing(rows, &filter.display().to_string(), NAMED);
    strictest.into_iter().map(|row| row.path.clone()).collect()
}

/// The rows in aligned columns.
pub(super) fn aligned<T>(columns: Columns<T>, rows: &[T]) -> String {
    let columns: Vec<_> = columns.of_page().collect();
    let mut lines = vec![columns.iter().map(|column| column.heading.text.clone()).collect::<Vec<_>>()];
    let cells = |row: &T| columns.iter().map(|column| plain(&(column.cell)(row).line())).collect();
    lines.extend(rows.iter().map(cells));
    let width = |at: usize| lines.iter().map(|line| line[at].chars().count()).max().unwrap_or(0);
    let widths: Vec<usize> = (0..columns.len()).map(width).collect();
    let mut text = String::new();
    for line in &lines {
        let cell = |(at, cell): (usize, &String)| match columns[at].kind {
            ColumnKind::Number => format!("{cell:>0$}", widths[at]),
            _ => format!("{cell:<0$}", widths[at]),
        };
        let line: Vec<String> = line.iter().enumerate().map(cell).collect();
        // Writing to a string cannot fail.
        let _ = writeln!(text, "{}", line.join("  ").trim_end());
    }
    text
}

/// Number of samples that a filter retains, and the governing ones.
pub(super) fn of_filter(rows: &[BatchRow], filter: &BatchFilter, inches: bool) -> String {
    let lines = filter_lines(filter, rows, SizeUnit::of(false, inches));
    lines.iter().map(|line| plain(line)).collect::<Vec<_>>().join("\n  ") + "\n"
}

/// The command that walks the samples that govern.
fn to_walk(samples: &Path, options: PairOptions, rows: &[BatchRow], filter: &Path) -> String {
    let paths: Vec<String> = paths(rows, filter).iter().map(to_copy).collect();
    let (which, walk) = match paths.len() {
        0 => return String::new(),
        1 => ("the one that governs", format!("{} {}", paths[0], to_copy(filter))),
        _ => {
            let samples = to_copy(samples);
            ("those that govern", format!("{samples} {} --each --governing", to_copy(filter)))
        }
    };
    let dispersive = if options.dispersive { " --dispersive" } else { "" };
    let as_given = if options.as_given { " --as-given" } else { "" };
    let joint = options.joint_mm.map_or_else(String::new, |mm| format!(" --joint-mm {mm}"));
    format!("  Nothing was walked. To walk {which}: voidwalk judge {walk}{dispersive}{joint}{as_given}\n")
}
