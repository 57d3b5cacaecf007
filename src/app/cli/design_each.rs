//! `voidwalk design --each`: how coarse a filter may be for each of many samples by practice, in one table.

use std::fmt::Write;
use std::path::Path;

use super::args::DesignArgs;
use super::batch::{aligned, in_notes};
use super::print::{as_it_is, json, plain, shown, to_stdout};
use super::progress::followed;
use crate::run::RunError;
use crate::study::specified::{SpecifyOptions, specify_each};
use crate::words::designed::{columns, lines};
use crate::words::specification::DESIGN_EACH_AGAIN;
use voidwalk_core::store::format;
use voidwalk_practice::DesignedSamples;
use voidwalk_practice::quantity::SizeUnit;

/// Specifies a filter for every sample and writes the table into a folder.
pub(super) fn design_each(args: &DesignArgs, options: &SpecifyOptions) -> Result<(), RunError> {
    let all = followed(args.quiet, |callbacks| specify_each(options, callbacks))?;
    if args.json {
        as_it_is(&json(format::DESIGNS, &all)?);
    } else if !args.quiet {
        to_stdout(&words(&all, &options.out));
    }
    Ok(())
}

/// Advice for a base that is found to be dispersive, with the option to add.
pub(super) fn by_option(again: &str) -> String {
    format!("{again} (--dispersive)")
}

fn words(all: &DesignedSamples, out: &Path) -> String {
    let unit = SizeUnit::of(false, all.inches);
    let mut text = aligned(columns(unit), &all.rows) + &in_notes(&all.notes) + "\n";
    for line in lines(all, &by_option(DESIGN_EACH_AGAIN), unit) {
        // Writing to a string cannot fail.
        let _ = writeln!(text, "{}", plain(&line));
    }
    let _ = writeln!(text, "table: {}", shown(&out.join("designs.csv")));
    let _ = writeln!(text, "report: {}", shown(&out.join("designs.html")));
    text
}
