//! `voidwalk judge` of several filters, or with --each of many samples: walked, in one table.

use std::fmt::Write;
use std::path::Path;

use super::args::{JudgeArgs, SettingArgs, WalkArgs};
use super::batch::{aligned, in_notes, of_filter};
use super::case_progress::CaseProgress;
use super::exit::{JudgedAnswer, accept_walked};
use super::print::{as_it_is, json, plain, shown, to_stdout};
use super::run::command_line;
use crate::cases::{BatchPlan, BatchWalks, batch};
use crate::cases::{CaseOptions, CasePart};
use crate::run::RunError;
use crate::verdict::{WalkedBatch, WalkedRow};
use crate::words::batch::{answer, walked_columns, walks};
use crate::words::left_out::left_out_line;
use voidwalk_core::store::format;
use voidwalk_practice::BatchRow;
use voidwalk_practice::quantity::SizeUnit;

/// Folder of a batch for which no other is named.
const OUT: &str = "voidwalk-batch";

/// Judges every sample and every filter.
pub fn judge_each(args: &JudgeArgs) -> Result<(), RunError> {
    let (tables, results) = (&args.tables, &args.results);
    #[cfg(feature = "xlsx")]
    if results.xlsx {
        return Err(RunError::refused("--xlsx goes with one filter"));
    }
    let quiet = results.walk.quiet;
    let out = results.out.as_deref().unwrap_or(Path::new(OUT));
    let options = campaign_options(out, &tables.set, &results.walk);
    let walks = match (args.each, args.governing, tables.quick) {
        (false, ..) => BatchWalks::OneBase,
        (true, true, _) => BatchWalks::GoverningAlone,
        (true, false, true) => BatchWalks::FirstLook,
        (true, false, false) => BatchWalks::GoverningInFull,
    };
    let plan = BatchPlan::new(&args.base, &args.filters, &tables.options(), walks, &options)?;
    let earlier = if results.overwrite { None } else { batch::found(&plan, &options)? };
    let batch = match earlier {
        Some(earlier) => earlier,
        None => {
            let progress = CaseProgress::new(quiet, false);
            progress.followed(|callbacks| batch::run(&plan, &options, results.overwrite, callbacks))?
        }
    };
    if tables.set.json {
        as_it_is(&json(format::BATCH, &batch)?);
    } else if !quiet {
        to_stdout(&words(&batch, &plan.constrictions_in_words(), out));
        to_stdout(&of_earlier_cover(plan.with_other_cover(out)));
    }
    let names: Vec<String> = batch.rows.iter().map(name).collect();
    // The class of a pair that could not be walked is unknown; others were left out on purpose.
    let is_asked = |row: &WalkedRow| !args.governing || row.governs.is_some() || row.rules.is_refused;
    let asked = batch.rows.iter().zip(&names).filter(|(row, _)| row.walk.is_some() || is_asked(row));
    let pairs = asked.map(|(row, name)| {
        let answer =
            row.walk.as_ref().map(|walk| JudgedAnswer { model: walk.verdict, practice: walk.by_practice });
        (name.as_str(), answer.ok_or(row.not_walked.as_str()))
    });
    accept_walked(results.accept.fail_on, pairs)
}

/// Options of walking cases from the options of the command line.
fn campaign_options(out: &Path, set: &SettingArgs, walk: &WalkArgs) -> CaseOptions {
    CaseOptions {
        out: out.to_owned(),
        part: CasePart::All,
        packings: Some(set.packings.clone()),
        memory: set.memory,
        threads: walk.threads,
        checkpoint_interval: walk.checkpoint_every.unwrap_or_default(),
        command: command_line(),
    }
}

/// Number of walks that were kept with the cover of an earlier call, in a line; empty if it is 0.
fn of_earlier_cover(walks: usize) -> String {
    match walks {
        0 => String::new(),
        1 => "1 walk was kept from an earlier call; its own page has the cover of that call\n".into(),
        _ => format!(
            "{walks} walks were kept from an earlier call; their own pages have the cover of that call\n"
        ),
    }
}

fn name(row: &WalkedRow) -> String {
    format!("{} in {}", row.rules.sample, row.rules.filter)
}

fn words(batch: &WalkedBatch, constrictions: &str, out: &Path) -> String {
    let unit = SizeUnit::of(false, batch.inches);
    let mut text = aligned(walked_columns(unit), &batch.rows) + &in_notes(&batch.notes);
    if batch.has_one_base() {
        text.push('\n');
        for row in &batch.rows {
            let _ = writeln!(text, "{}", plain(&format!("{}: {}", row.rules.filter, answer(row))));
        }
    }
    let rules: Vec<BatchRow> = batch.rows.iter().map(|row| row.rules.clone()).collect();
    for filter in &batch.filters {
        // Writing to a string cannot fail.
        let _ = write!(text, "\n{}", of_filter(&rules, filter, batch.inches));
        for line in walks(batch, &filter.name, unit) {
            let _ = writeln!(text, "  {}", plain(&line));
        }
        for row in batch.governing(&filter.name).iter().filter(|_| !batch.has_one_base()) {
            let line = format!("{}: {}", row.rules.sample, answer(row));
            let _ = writeln!(text, "  {}", plain(&line));
        }
    }
    if batch.rows.iter().any(|row| row.rules.is_refused) {
        let _ = writeln!(text, "\n--as-given walks pairs that look exchanged");
    }
    let _ = writeln!(text, "\n{}", plain(constrictions));
    let _ = writeln!(text, "{}", left_out_line(&batch.model_leaves_out));
    let _ = writeln!(text, "table: {}", shown(&out.join("batch.csv")));
    let _ = writeln!(text, "report: {}", shown(&out.join("batch.html")));
    text
}
