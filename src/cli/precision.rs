//! `voidwalk precision`: error against run time.

use super::args::PrecisionArgs;
use super::print::{as_it_is, json, shown, to_stdout};
use super::progress::followed;
use crate::outcome::precision::Precision;
use crate::report::precision_judgements;
use crate::run::RunError;
use crate::store::format;
use crate::study::precision::{self, PrecisionOptions};

/// Measures, and writes tables, figures and the page.
pub fn precision(args: &PrecisionArgs) -> Result<(), RunError> {
    let scene = args.scene.scene()?;
    let options = PrecisionOptions {
        out: args.out.clone(),
        overwrite: args.overwrite,
        tiers: args.tiers.clone(),
        budget: args.budget,
        prepare: args.scene.set.prepare(args.threads),
    };
    let precision = followed(args.quiet, |callbacks| precision::run(scene, &options, callbacks))?;
    if args.scene.set.json {
        as_it_is(&json(format::PRECISION, &precision)?);
    } else if !args.quiet {
        let page = shown(&args.out.join("precision.html"));
        to_stdout(&format!("{}{page}\n", words(&precision)));
    }
    Ok(())
}

fn words(precision: &Precision) -> String {
    let judged = precision_judgements(precision).into_iter();
    let text: String = judged.map(|(tier, sentence)| format!("{tier}: {sentence}\n")).collect();
    let spent: f64 = precision.spent.iter().map(|(_, seconds)| seconds).sum();
    let (seconds, seed) = (precision.seconds, precision.seed);
    format!("{text}{seconds:.0} s, {spent:.0} s of processor time, seed {seed}; ")
}
