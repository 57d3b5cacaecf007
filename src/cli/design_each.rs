//! `voidwalk design --each`: how coarse a filter may be for each of many samples, in one table.

use std::fmt::Write;
use std::path::Path;

use super::args::DesignArgs;
use super::batch::{aligned, in_notes};
use super::print::{counted, json, plain, shown, to_stdout};
use super::progress::followed;
use super::specification::by_option;
use crate::outcome::numbers::SizeUnit;
use crate::outcome::with_inches;
use crate::run::RunError;
use crate::store::format;
use crate::study::design::DesignOptions;
use crate::study::designs::{SampleDesignOptions, each};
use crate::verdict::left_out::left_out_in_brief;
use crate::verdict::{DESIGN_EACH_AGAIN, DesignedSample, DesignedSamples};

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
        to_stdout(&json(format::DESIGNS, &found)?);
    } else if !args.quiet {
        to_stdout(&words(&found, &out));
    }
    Ok(())
}

fn words(all: &DesignedSamples, out: &Path) -> String {
    let mut text = aligned(DesignedSample::columns(SizeUnit::of(false, all.inches)), &all.rows)
        + &in_notes(&all.notes)
        + "\n";
    for said in all.in_words(&by_option(DESIGN_EACH_AGAIN)) {
        let said = if all.inches { with_inches(&said) } else { said };
        // Writing to a string cannot fail.
        let _ = writeln!(text, "{}", plain(&said));
    }
    if !all.model_leaves_out.is_empty() {
        let _ = writeln!(text, "{}", left_out_in_brief(&all.model_leaves_out));
    }
    if let Some(walks) = &all.walks {
        let networks = counted(walks.networks, "network", "networks");
        let _ = writeln!(text, "{networks} each, seed {}", walks.seed);
    }
    let _ = writeln!(text, "table: {}", shown(&out.join("designs.csv")));
    let _ = writeln!(text, "report: {}", shown(&out.join("designs.html")));
    text
}
