//! `voidwalk boundary`: the boundaries of the model.

use super::args::BoundaryArgs;
use super::print::{as_it_is, counted, json, plain, shown, to_stdout};
use super::progress::followed;
use crate::outcome::boundary::{Boundaries, Boundary, BoundaryRow, Range};
use crate::run::{PrepareOptions, RunError};
use crate::study::boundary::{self, BoundaryOptions};
use crate::words::base_size;
use crate::words::boundary::{held, over_networks};
use crate::words::left_out::left_out_line;
use crate::words::{FOREMOST, row_note, sentence};
use voidwalk_core::store::format;
use voidwalk_practice::Note;
use voidwalk_practice::quantity::{NumberRole, SizeUnit, significant};

/// Finds the boundaries and writes them into a folder.
pub fn boundary(args: &BoundaryArgs) -> Result<(), RunError> {
    let options = BoundaryOptions {
        base: args.base.clone(),
        filter: args.filter.clone(),
        densities: args.densities.clone(),
        pack: args.pack,
        thicknesses: args.thicknesses.iter().flat_map(|list| list.0.clone()).collect(),
        settings: args.settings.assignments.clone(),
        as_sampled: args.as_sampled,
        as_given: args.as_given,
        out: args.out.clone(),
        overwrite: args.overwrite,
        prepare: PrepareOptions {
            packings: args.packings.clone(),
            memory: args.memory,
            threads: args.threads,
        },
    };
    let all = followed(args.quiet, |callbacks| boundary::run(&options, callbacks))?;
    if args.json {
        as_it_is(&json(format::BOUNDARY, &all)?);
    } else if !args.quiet {
        let page = shown(&args.out.join("boundary.html"));
        to_stdout(&format!("{}report: {page}\n", words(&all)));
    }
    Ok(())
}

fn words(all: &Boundaries) -> String {
    let Boundaries { base, filter, curve_name, .. } = all;
    let soils = format!("Base {}, filter {filter}, constrictions {curve_name}", base.name);
    let mut lines = vec![format!("Boundaries of the model. {soils}")];
    let unit = SizeUnit::of(false, all.inches);
    lines.push(format!("Model (research): {}", held(all, unit)));
    lines.extend(all.base.size().map(|base| format!("  {}", base_size(&base, unit))));
    lines.extend(all.boundaries.iter().flat_map(|row| of_row(row, unit)));
    lines.extend(all.notes.iter().take(FOREMOST).map(|row| format!("- {}", row_note(row, unit))));
    if all.notes.len() > FOREMOST {
        lines.push(format!("- and {} more on the page", all.notes.len() - FOREMOST));
    }
    lines.push(left_out_line(&all.model_leaves_out));
    lines.push(format!("{:.1} s, {} networks each, seed {}", all.seconds, all.replicates, all.seed));
    lines.iter().map(|line| plain(line) + "\n").collect()
}

fn of_row(row: &BoundaryRow, unit: SizeUnit) -> Vec<String> {
    let words = |notes: &[Note]| notes.iter().map(|note| sentence(note, unit)).collect::<Vec<_>>().join(" ");
    let what = ["no erosion up to", "continuing erosion from"];
    let boundaries =
        row.shown().into_iter().zip([words(&row.no_erosion_notes), words(&row.continuing_notes)]);
    let networks = row.networks.len() as u64;
    let mut lines = vec![format!("{}, {}, in the model:", row.name(), row.thickness)];
    // The boundary of no erosion is stated as a limit.
    let sizes: [fn(f64) -> String; 2] =
        [|mm| significant(mm).role(NumberRole::Greatest).number(), |mm| format!("{mm:.3}")];
    for ((what, size), (boundary, note)) in what.into_iter().zip(sizes).zip(boundaries) {
        let text = boundary.map(|boundary| ratio(&boundary, networks, size));
        lines.push(match (text, &*note) {
            (Some(text), "") => format!("  {what} {text}"),
            (Some(text), note) => format!("  {what} {text}. {note}"),
            (None, "") => format!("  {what}: no number. It lies beyond the search."),
            (None, note) => format!("  {what}: no number. {note}"),
        });
    }
    if row.not_monotone > 0 {
        lines.push(format!(
            "  not monotone on {}: the smallest ratio seen to erode counts",
            counted(row.not_monotone, "network", "networks")
        ));
    }
    lines
}

fn ratio(boundary: &Boundary, networks: u64, mm: fn(f64) -> String) -> String {
    let between = |low: Option<f64>, high: Option<f64>, words: fn(f64) -> String| {
        let end = |value: Option<f64>| value.map_or("unknown".into(), words);
        over_networks(&format!("{} to {}", end(low), end(high)), networks)
    };
    let Boundary { median, low, high, .. } = boundary;
    let of_networks = |low: Option<f64>, high: Option<f64>, words| match low.or(high) {
        Some(_) => format!(" ({})", between(low, high, words)),
        None => String::new(),
    };
    let size =
        |range: &Range| format!("D15F {} mm{}; ", mm(range.median), of_networks(range.low, range.high, mm));
    let size = boundary.d15f_mm.as_ref().map_or_else(String::new, size);
    format!("{size}D15F/D85B {median:.2}{}", of_networks(*low, *high, |ratio| format!("{ratio:.3}")))
}
