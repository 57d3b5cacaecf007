//! `voidwalk design --each`: how coarse a filter may be for each of many samples, in one table.

use std::fmt::Write;
use std::path::Path;

use super::args::DesignArgs;
use super::batch::{aligned, in_notes};
use super::print::{as_it_is, counted, json, plain, shown, to_stdout};
use super::progress::followed;
use super::specification::by_option;
use crate::outcome::quantity::SizeUnit;
use crate::run::RunError;
use crate::store::format;
use crate::study::design::DesignOptions;
use crate::study::designs::{SampleDesignOptions, each};
use crate::verdict::DesignedSamples;
use crate::words::designed::{columns, lines};
use crate::words::left_out::left_out_line;
use crate::words::specification::DESIGN_EACH_AGAIN;

/// The folder of the results, where nobody names one.
const FOLDER: &str = "voidwalk-designs";

/// Designs for every sample and writes the table into a folder.
pub(super) fn design_each(args: &DesignArgs, samples: &Path, design: DesignOptions) -> Result<(), RunError> {
    let out = args.out.clone().unwrap_or_else(|| FOLDER.into());
    let options = SampleDesignOptions {
        samples: samples.to_owned(),
        by_practice_alone: args.steps,
        design: DesignOptions { base: None, out: out.clone(), ..design },
    };
    let found = followed(args.quiet, |callbacks| each(&options, callbacks))?;
    if args.json {
        as_it_is(&json(format::DESIGNS, &found)?);
    } else if !args.quiet {
        to_stdout(&words(&found, &out));
    }
    Ok(())
}

fn words(all: &DesignedSamples, out: &Path) -> String {
    let unit = SizeUnit::of(false, all.inches);
    let mut text = aligned(columns(unit), &all.rows) + &in_notes(&all.notes) + "\n";
    for line in lines(all, &by_option(DESIGN_EACH_AGAIN), unit) {
        // Writing to a string cannot fail.
        let _ = writeln!(text, "{}", plain(&line));
    }
    if !all.model_leaves_out.is_empty() {
        let _ = writeln!(text, "{}", left_out_line(&all.model_leaves_out));
    }
    if let Some(walks) = &all.walks {
        let networks = counted(walks.networks, "network", "networks");
        let _ = writeln!(text, "{networks} each, seed {}", walks.seed);
    }
    let _ = writeln!(text, "table: {}", shown(&out.join("designs.csv")));
    let _ = writeln!(text, "report: {}", shown(&out.join("designs.html")));
    text
}
