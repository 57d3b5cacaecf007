//! `voidwalk percolation`: the percolation threshold against the size of the lattice.

use std::path::PathBuf;

use super::Exit;
use super::args::PercolationArgs;
use super::print::{plain, to_stdout};
use super::run::refused_or_failed;
use crate::outcome::percolation::PercolationStudy;
use crate::report;
use crate::store::Folder;
use crate::study::percolation::PercolationPlan;

/// Finds the thresholds and writes them into a folder.
pub fn percolation(args: &PercolationArgs) -> Result<(), Exit> {
    let plan =
        PercolationPlan::new(args.sizes.clone(), args.realisations, args.seed).map_err(Exit::refused)?;
    let out = args.out.clone().unwrap_or_else(|| PathBuf::from("voidwalk-percolation"));
    let folder = Folder::open(&out).map_err(refused_or_failed)?;
    if folder.has("percolation.json") && !args.overwrite {
        let problem = format!(
            "{}: holds a percolation study already; name another folder or add --overwrite",
            out.display()
        );
        return Err(Exit::refused(plain(&problem)));
    }
    let threads = args.threads.map_or(0, usize::from);
    let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().map_err(Exit::failed)?;
    let run = pool.install(|| plan.run()).map_err(Exit::failed)?;
    let json = serde_json::to_string_pretty(&run.study).map_err(Exit::failed)? + "\n";
    folder.write("percolation.csv", run.csv().as_bytes()).map_err(Exit::failed)?;
    let page = report::write_percolation(folder.path(), &run.study).map_err(Exit::failed)?.page;
    // Last, so that a folder with it is whole.
    folder.write("percolation.json", json.as_bytes()).map_err(Exit::failed)?;
    if args.json {
        to_stdout(&json);
    } else {
        to_stdout(&format!("{}{}\n", words(&run.study), plain(&page.display().to_string())));
    }
    Ok(())
}

fn words(study: &PercolationStudy) -> String {
    let mut text = String::from("  size   mean      95 % interval        sd\n");
    let digits = |value: Option<f64>| value.map_or("-".to_string(), |v| format!("{v:.5}"));
    for size in &study.sizes {
        let threshold = &size.threshold;
        text += &format!(
            "{:>6}   {}   {} to {}   {}\n",
            size.size,
            digits(Some(threshold.mean)),
            digits(threshold.low),
            digits(threshold.high),
            digits(threshold.sd)
        );
    }
    let line = |law: &str, threshold: f64, error: String, chi_squared: f64, degrees: u64| {
        format!(
            "{law}: infinite lattice {threshold:.5} {error}, chi squared {chi_squared:.1} on {degrees} degrees of freedom\n"
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
