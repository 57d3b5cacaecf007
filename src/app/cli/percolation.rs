//! `voidwalk percolation`: the percolation threshold against the size of the lattice.

use super::args::PercolationArgs;
use super::print::{as_it_is, json, shown, to_stdout};
use super::progress::unfollowed;
use crate::outcome::percolation::PercolationStudy;
use crate::run::RunError;
use crate::study::percolation::{self, PercolationOptions, PercolationPlan};
use voidwalk_core::store::format;

/// Finds the thresholds and writes them into a folder.
pub fn percolation(args: &PercolationArgs) -> Result<(), RunError> {
    let options = PercolationOptions {
        plan: PercolationPlan {
            shapes: args.sizes.clone(),
            realisations: args.realisations,
            seed: args.seed,
        },
        out: args.out.clone(),
        overwrite: args.overwrite,
        threads: args.threads,
    };
    let study = percolation::run(&options, &unfollowed())?;
    if args.json {
        as_it_is(&json(format::PERCOLATION, &study)?);
    } else if !args.quiet {
        to_stdout(&format!("{}{}\n", words(&study), shown(&args.out.join("report.html"))));
    }
    Ok(())
}

fn words(study: &PercolationStudy) -> String {
    let mut text = String::from("      size   mean      95 % interval        sd\n");
    let digits = |value: Option<f64>| value.map_or("-".to_string(), |v| format!("{v:.5}"));
    for (size, threshold, _) in study.lattices() {
        text += &format!(
            "{size:>10}   {}   {} to {}   {}\n",
            digits(Some(threshold.mean)),
            digits(threshold.low),
            digits(threshold.high),
            digits(threshold.sd)
        );
    }
    let line = |law: &str, threshold: f64, error: String, chi_squared: f64, degrees: u64| {
        format!(
            "{law}: infinite lattice {threshold:.5} {error}, chi squared {chi_squared:.1} on {degrees} \
             degrees of freedom\n"
        )
    };
    if let Some(fit) = &study.one_length {
        let error = format!("+- {:.5}", fit.threshold_error);
        text += &line("one length ", fit.threshold, error, fit.chi_squared, fit.degrees);
    }
    if let Some(fit) = &study.many_starts {
        let error = format!("({:.5} to {:.5}, 68 %)", fit.threshold_low, fit.threshold_high);
        text += &line("many starts", fit.threshold, error, fit.chi_squared, fit.degrees);
    }
    text += &format!("known: {} for the infinite lattice; {:.1} s\n", study.infinite_lattice, study.seconds);
    text
}
