//! `voidwalk precision`: error against run time.

use std::path::{Path, PathBuf};
use std::time::Instant;

use super::Exit;
use super::args::PrecisionArgs;
use super::check::scene;
use super::pack::provide;
use super::print::{plain, to_stderr, to_stdout};
use super::run::{pool, refuse_other_kinds, refused_or_failed};
use super::signals::stop_on_signals;
use crate::case::{Case, ResourceLimits};
use crate::case::{PackedFilter, PackingPlan};
use crate::outcome::precision::Precision;
use crate::report;
use crate::run::machine::Machine;
use crate::store::Folder;
use crate::study::precision::{Study, Tier, tables};

/// Measures, and writes tables, figures and the page.
pub fn precision(args: &PrecisionArgs) -> Result<(), Exit> {
    let scene = scene(&args.scene)?;
    let stop = stop_on_signals()?;
    let pool = pool(args.threads)?;
    let order = PackingPlan::of(&scene).map_err(Exit::refused)?;
    let guess = order.as_ref().map(PackedFilter::placeholder).transpose().map_err(Exit::refused)?;
    // Whatever is wrong is said before any work.
    let mut case = Case::with_packed(scene.clone(), guess).map_err(Exit::refused)?;
    let room = ResourceLimits::new(args.scene.memory, Machine::here().available, Path::new("."));
    case.place(&room, pool.current_num_threads() as u64, Path::new(".")).map_err(Exit::refused)?;
    let out = args.out.clone().unwrap_or_else(|| PathBuf::from("voidwalk-precision"));
    let folder = Folder::open(&out).map_err(refused_or_failed)?;
    refuse_other_kinds(&folder, "precision study")?;
    if folder.has("precision.json") && !args.overwrite {
        let problem = format!(
            "{}: holds a precision study already; name another folder or add --overwrite",
            out.display()
        );
        return Err(Exit::refused(plain(&problem)));
    }
    if let Some(order) = &order {
        let filter = pool.install(|| provide(order, &args.scene.packings, args.quiet, &stop))?;
        case = Case::with_packed(scene, Some(filter)).map_err(Exit::refused)?;
    }
    let tiers: Vec<Tier> =
        Tier::ALL.into_iter().filter(|tier| args.tiers.is_empty() || args.tiers.contains(tier)).collect();
    let begun = Instant::now();
    let study = Study {
        case: &case,
        tiers: &tiers,
        budget_s: args.budget.as_secs_f64(),
        threads: pool.current_num_threads(),
        tell: &|what| {
            if !args.quiet {
                to_stderr(&format!("{:6.1} s  {}\n", begun.elapsed().as_secs_f64(), plain(what)));
            }
        },
        stop: &stop,
    };
    let (precision, networks) = study.run().map_err(Exit::failed)?;
    for (name, content) in tables(&precision, &networks).map_err(Exit::failed)? {
        folder.write(name, &content).map_err(Exit::failed)?;
    }
    let json = serde_json::to_string_pretty(&precision).map_err(Exit::failed)? + "\n";
    // The page is made of it.
    folder.write("precision.json", json.as_bytes()).map_err(Exit::failed)?;
    let page = report::write_precision(folder.path()).map_err(Exit::failed)?.page;
    if args.scene.json {
        to_stdout(&json);
    } else if !args.quiet {
        to_stdout(&words(&precision, &page));
    }
    Ok(())
}

fn words(precision: &Precision, page: &Path) -> String {
    let mut text = String::new();
    for (tier, sentence) in report::precision_judgements(precision) {
        text += &format!("{tier}: {sentence}\n");
    }
    let spent: f64 = precision.spent.iter().map(|(_, seconds)| seconds).sum();
    text += &format!(
        "{:.0} s, {spent:.0} s of processor time, seed {}; {}\n",
        precision.seconds,
        precision.seed,
        plain(&page.display().to_string())
    );
    text
}
