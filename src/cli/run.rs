//! `voidwalk run` and `voidwalk report`.

use std::fmt::Write;
use std::path::Path;
use std::sync::atomic::AtomicBool;
use std::time::{Instant, SystemTime};

use super::Exit;
use super::args::{ResumeArgs, RunArgs, SceneArgs};
use super::check::scene;
use super::pack::provide;
use super::print::{count, percent, plain, to_stderr, to_stdout};
use super::progress::Progress;
use super::signals::stop_on_signals;
use crate::case::{Case, ResourceLimits};
use crate::case::{PackedFilter, PackingPlan};
use crate::outcome::record::{Outcome, RunSummary};
use crate::report;
use crate::run::allocation::Allocation;
use crate::run::checkpoints::{self, Checkpoints};
use crate::run::machine::Machine;
use crate::run::replicates::{ReplicateResult, RunError, Watch, replicates, runs_to_walk, sensitivity};
use crate::run::results;
use crate::store::{Folder, StoreError};

/// Walks a scene and writes its folder.
pub fn run(args: &RunArgs) -> Result<(), Exit> {
    let scene = scene(&args.scene)?;
    let stop = stop_on_signals()?;
    let machine = Machine::here();
    let pool = pool(args.threads)?;
    let threads = pool.current_num_threads() as u64;
    let wanted = args.out.as_deref().unwrap_or(Path::new("."));
    let room = ResourceLimits::new(args.scene.memory, machine.available, wanted);
    let order = PackingPlan::of(&scene).map_err(Exit::refused)?;
    let guess = order.as_ref().map(PackedFilter::placeholder).transpose().map_err(Exit::refused)?;
    // Whatever is wrong with the scene, the memory or the folder is said before hours of packing, not after.
    let mut case = Case::with_packed(scene.clone(), guess).map_err(Exit::refused)?;
    case.place(&room, threads, wanted).map_err(Exit::refused)?;
    let folder = open_folder(args)?;
    if let Some(order) = &order {
        let filter = pool.install(|| provide(order, &args.scene.packings, args.quiet, &stop))?;
        case = Case::with_packed(scene, Some(filter)).map_err(Exit::refused)?;
    }
    case.place(&room, threads, folder.path()).map_err(Exit::refused)?;
    for warning in case.warnings() {
        to_stderr(&format!("warning: {}\n", plain(&warning)));
    }
    let started = SystemTime::now();
    if args.overwrite {
        checkpoints::discard(folder.path()).map_err(Exit::failed)?;
    }
    let fingerprint = case.fingerprint();
    let kept = Checkpoints::scene_in(folder.path()).map_err(Exit::failed)?;
    if kept.is_some_and(|scene| scene != fingerprint) {
        return Err(Exit::refused(plain(&format!(
            "{}: holds checkpoints of another scene; `voidwalk resume` goes on with that one, --overwrite begins anew",
            folder.path().display()
        ))));
    }
    results::write_scene(&folder, &case).map_err(Exit::failed)?;
    let keeper = Checkpoints::new(&folder, &fingerprint, args.checkpoint_every);
    let keeper = keeper.map_err(Exit::failed)?;
    let manifest = || results::manifest(&case, threads, started, command_line());
    let outcome = walk(&case, &pool, args.quiet, &stop, &keeper, folder.path(), |outcome, walked| {
        results::write(&folder, &case, outcome, walked, &manifest()).map_err(Exit::failed)?;
        report::write(folder.path()).map_err(Exit::failed)?;
        Ok(())
    })?;
    keeper.clear().map_err(Exit::failed)?;
    if args.scene.json {
        to_stdout(&format!("{}\n", serde_json::to_string_pretty(&outcome).map_err(Exit::failed)?));
    } else if !args.quiet {
        to_stdout(&summary(&outcome, folder.path()));
    }
    Ok(())
}

/// Goes on with a run that was stopped or killed.
pub fn resume(args: &ResumeArgs) -> Result<(), Exit> {
    let shown = plain(&args.folder.display().to_string());
    let scene = args.folder.join("scene.toml");
    if !scene.is_file() {
        return Err(Exit::refused(format!(
            "{shown}: holds no scene.toml; name the folder of a run that was stopped"
        )));
    }
    let is_kept = Checkpoints::is_in(&args.folder).map_err(Exit::failed)?;
    if args.folder.join("manifest.json").is_file() && !is_kept {
        return Err(Exit::refused(format!(
            "{shown}: this run is finished; voidwalk report writes its page again"
        )));
    }
    run(&RunArgs {
        scene: SceneArgs {
            scene: Some(scene),
            settings: Vec::new(),
            seed: None,
            target_error: None,
            decide: None,
            packings: args.folder.join("packings"),
            memory: args.memory,
            json: args.json,
        },
        out: Some(args.folder.clone()),
        overwrite: false,
        threads: args.threads,
        checkpoint_every: args.checkpoint_every,
        quiet: args.quiet,
    })
}

/// Writes the report of a finished run folder again.
pub fn report(folder: &Path) -> Result<(), Exit> {
    type Writer = fn(&Path) -> Result<report::Written, report::ReportError>;
    let writers: [(&str, Writer); 4] = [
        ("outcome.json", report::write),
        ("packing.json", report::write_packing),
        ("campaign.json", report::write_campaign),
        ("precision.json", report::write_precision),
    ];
    let Some((marker, write)) = writers.iter().find(|(marker, _)| folder.join(marker).is_file()) else {
        let problem = format!(
            "{}: holds no outcome.json, packing.json, campaign.json or precision.json; name the folder of a finished run, packing, campaign or precision study",
            folder.display()
        );
        return Err(Exit::refused(plain(&problem)));
    };
    let folder = match *marker {
        "campaign.json" => Folder::open_shared(folder),
        _ => Folder::open(folder),
    };
    let folder = folder.map_err(refused_or_failed)?;
    let page = write(folder.path()).map_err(Exit::failed)?.page;
    to_stdout(&format!("{}\n", plain(&page.display().to_string())));
    Ok(())
}

/// Walks the replicates, keeps what came of them, then adds the sensitivity study and keeps the whole.
fn walk(
    case: &Case,
    pool: &rayon::ThreadPool,
    quiet: bool,
    stop: &AtomicBool,
    keeper: &Checkpoints,
    folder: &Path,
    keep: impl Fn(&Outcome, &[ReplicateResult]) -> Result<(), Exit>,
) -> Result<Outcome, Exit> {
    let begun = Instant::now();
    let progress = Progress::new(quiet, runs_to_walk(case));
    let watch = Watch { tell: &|event| progress.tell(event), stop, keeper: Some(keeper) };
    let shown = plain(&folder.display().to_string());
    let stopped = |error: RunError| {
        progress.finish();
        // What is done and not on the disk yet goes there, whatever ended the walk.
        let flushed = keeper.flush();
        match (error, flushed) {
            (RunError::Walk(crate::walk::WalkError::Stopped { .. }), Ok(())) => {
                Exit::stopped(format!("what is done is kept; `voidwalk resume {shown}` goes on"))
            }
            (RunError::Checkpoint(error), _) if error.is_unreadable() => {
                Exit::failed(plain(&error.to_string()))
            }
            (RunError::Checkpoint(error), _) => Exit::refused(format!(
                "{}; --overwrite begins anew, another --out leaves it alone",
                plain(&error.to_string())
            )),
            (RunError::Walk(crate::walk::WalkError::Stopped { .. }), Err(error)) => Exit::failed(error),
            (other, _) => Exit::failed(other),
        }
    };
    let walked = pool.install(|| replicates(case, &watch)).map_err(&stopped)?;
    for problem in keeper.passed_over() {
        to_stderr(&format!("warning: {}; the checkpoint before it was taken\n", plain(&problem)));
    }
    let outcome = results::outcome(case, &walked, Vec::new(), begun.elapsed().as_secs_f64());
    if !case.sensitivity_factors().is_empty() {
        // A folder with results counts as finished unless it holds checkpoints, and the study of the sensitivity is to come.
        keeper.flush().map_err(Exit::failed)?;
    }
    keep(&outcome, &walked)?;
    let sensitivity = pool.install(|| sensitivity(case, &watch)).map_err(&stopped)?;
    progress.finish();
    if sensitivity.is_empty() {
        return Ok(outcome);
    }
    let outcome = results::outcome(case, &walked, sensitivity, begun.elapsed().as_secs_f64());
    keep(&outcome, &walked)?;
    Ok(outcome)
}

/// The workers of a command: as many as are asked for, else as a cluster's job has, else one per core that it may run on.
pub(super) fn pool(threads: Option<u16>) -> Result<rayon::ThreadPool, Exit> {
    let allocated = || Allocation::here().and_then(|job| job.threads());
    let threads = threads.map(usize::from).or_else(allocated).unwrap_or(0);
    rayon::ThreadPoolBuilder::new().num_threads(threads).build().map_err(Exit::failed)
}

/// The command line in words, whatever bytes it is made of.
pub(super) fn command_line() -> String {
    let words: Vec<String> = std::env::args_os().map(|word| word.to_string_lossy().into_owned()).collect();
    words.join(" ")
}

pub(super) fn refused_or_failed(error: StoreError) -> Exit {
    if error.is_refusal() { Exit::refused(error) } else { Exit::failed(error) }
}

/// What marks the folder of each kind of work.
const KINDS: [(&str, &[&str]); 6] = [
    ("run", &["outcome.json", "series.csv", "checkpoint"]),
    ("packing", &["packing.json", "compression.0", "compression.1"]),
    ("campaign", &["campaign.json", "cases"]),
    ("percolation study", &["percolation.json"]),
    ("precision study", &["precision.json"]),
    ("set of constrictions", &["constrictions.json"]),
];

/// Refuses a folder that holds the work of another kind: nothing of it is overwritten.
pub(super) fn refuse_other_kinds(folder: &Folder, own: &str) -> Result<(), Exit> {
    for (kind, markers) in KINDS {
        // A packing holds constrictions of its own.
        let own = kind == own || (own == "packing" && kind == "set of constrictions");
        if !own && markers.iter().any(|marker| folder.has(marker)) {
            let problem = format!("{}: holds a {kind}; name another folder", folder.path().display());
            return Err(Exit::refused(plain(&problem)));
        }
    }
    Ok(())
}

/// The folder to write to: the one that is named, or the first free one.
fn open_folder(args: &RunArgs) -> Result<Folder, Exit> {
    let Some(path) = &args.out else { return first_free_folder() };
    let folder = Folder::open(path).map_err(refused_or_failed)?;
    refuse_other_kinds(&folder, "run")?;
    let is_kept = Checkpoints::is_in(folder.path()).map_err(Exit::failed)?;
    if folder.has("manifest.json") && !args.overwrite && !is_kept {
        let problem = format!(
            "{}: holds the results of an earlier run; name another folder or add --overwrite",
            path.display()
        );
        return Err(Exit::refused(plain(&problem)));
    }
    Ok(folder)
}

/// The first of `voidwalk-run`, `voidwalk-run-2`, ... that is new, or that an earlier run left without results.
fn first_free_folder() -> Result<Folder, Exit> {
    let mut n = 1;
    loop {
        let name = if n == 1 { "voidwalk-run".to_string() } else { format!("voidwalk-run-{n}") };
        match Folder::open(Path::new(&name)) {
            Ok(folder) => {
                let is_kept = Checkpoints::is_in(folder.path()).map_err(Exit::failed)?;
                if !folder.has("outcome.json") && !is_kept {
                    return Ok(folder);
                }
                n += 1;
            }
            Err(StoreError::Held { .. } | StoreError::NotOurs { .. } | StoreError::NotAFolder { .. }) => {
                n += 1;
            }
            Err(other) => return Err(refused_or_failed(other)),
        }
    }
}

/// What a user wants to know first.
fn summary(outcome: &Outcome, folder: &Path) -> String {
    let mut text = String::new();
    let inputs = &outcome.inputs;
    // Writing to a string cannot fail.
    let mut line = |s: String| {
        let _ = writeln!(text, "{s}");
    };
    line(format!("Verdict: {}", outcome.verdict.words()));
    for run in &outcome.summary {
        line(format!("  {}", run_line(run)));
    }
    if let Some(sentence) = outcome.stopping.as_ref().and_then(|stopping| stopping.sentence.as_ref()) {
        line(format!("  {sentence}"));
    }
    let trapped: u64 = outcome.replicates.iter().flat_map(|r| &r.runs).map(|r| r.trapped).sum();
    if trapped > 0 {
        line(format!("  {} particles circle for ever (trapped) and count as retained", count(trapped)));
    }
    if let (true, Some(eq2)) = (outcome.capped, outcome.n_base_eq2) {
        line(format!("  the cap bit: Eq. (2) asks for {} base particles", count(eq2)));
    }
    let unit = if inputs.scale_free { "D0F" } else { "mm" };
    if let Some(thickness) = inputs.network.thickness_mm {
        line(format!("  the network stands for {thickness:.1} {unit} of filter along the flow"));
    }
    line(format!(
        "  {} replicates of {} base particles, {} voids; D15F/D85B {:.2}, D15F/D95B {:.2}, {}",
        outcome.replicates.len(),
        count(outcome.n_base),
        count(inputs.network.voids),
        outcome.ratios.d15f_over_d85b,
        outcome.ratios.d15f_over_d95b,
        match outcome.grains_per_void {
            Some(grains) => format!("{} grains per void", (grains * 1e4).round() / 1e4),
            None => "grains per void not given".into(),
        }
    ));
    line(format!("The model leaves out: {}.", leaves_out(&outcome.model_leaves_out)));
    line(format!(
        "{:.1} s, seed {}; report: {}",
        outcome.seconds,
        outcome.seed,
        plain(&folder.join("report.html").display().to_string())
    ));
    text
}

fn run_line(run: &RunSummary) -> String {
    let eroded = &run.eroded_mass_fraction;
    let interval = match (eroded.low, eroded.high) {
        (Some(low), Some(high)) => format!(" (95 % interval {} to {})", percent(low), percent(high)),
        _ => String::new(),
    };
    let largest = match &run.largest_eroded_over_d15f {
        Some(largest) => format!("largest eroded {:.3} D15F", largest.mean),
        None => "nothing eroded".into(),
    };
    let which = if run.run == 1 { "first" } else { "second" };
    format!("{which} run: {} of the mass eroded{interval}, {largest}", percent(eroded.mean))
}

/// The first words of each thing that the model leaves out.
fn leaves_out(items: &[String]) -> String {
    let first = |item: &String| item.split(':').next().unwrap_or_default().to_string();
    items.iter().map(first).collect::<Vec<_>>().join("; ")
}
