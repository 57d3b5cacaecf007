//! Walks a scene into a folder, continues a run that was stopped, and walks a case in memory.

use std::path::{Path, PathBuf};
use std::time::{Instant, SystemTime};

use super::callbacks::{Callbacks, Event};
use super::case_walks::{CaseWalks, Studies};
use super::checkpoints::{self, CheckpointInterval, Checkpoints};
use super::folder::{
    FolderKind, Unfinished, claim, claim_first_free, clear, clear_but_scene, outlive_clear, own_packings,
    refused,
};
use super::machine::on_threads;
use super::prepare::{PrepareOptions, prepare_into};
use super::replicates::{ReplicateContext, ReplicateResult, runs_to_walk};
use super::{Exit, RunError, results};
use crate::case::Case;
use crate::outcome::Recorded;
use crate::outcome::record::Outcome;
use crate::scene::{CurveSource, Scene};
use voidwalk_core::store::Folder;
use voidwalk_core::store::format::from_json;
use voidwalk_core::text::{plain, shell_word};
use voidwalk_practice::quantity::SizeUnit;
use voidwalk_practice::{Decision, Note, ordered};
use voidwalk_sheets::file_and_soil;

/// Options of walking a scene; no option changes a result. [`resume`] has an example.
#[derive(Clone, Debug, Default)]
pub struct RunOptions {
    /// Folder for the results; by default the first free of `voidwalk-run`, `voidwalk-run-2`, ...
    pub out: Option<PathBuf>,
    /// True if the results of an earlier run in `out` are replaced.
    pub overwrite: bool,
    /// Threads, memory and the folder of packings.
    pub prepare: PrepareOptions,
    /// Interval between saves of the walks, from which a killed run can be continued; by default the interval
    /// of the continued run, else ten minutes.
    pub checkpoint_interval: Option<CheckpointInterval>,
    /// Command that started the run, for `manifest.json`.
    pub command: String,
}

/// Finished run.
pub struct FinishedRun {
    /// Its folder.
    pub folder: PathBuf,
    /// Result of the walk, as in `outcome.json`.
    pub outcome: Outcome,
    /// The decision of practice on its pair.
    pub(crate) decision: Decision,
    /// Unit of sizes in its scene (`about.units`).
    pub(crate) unit: SizeUnit,
}

/// Walks a scene and writes its folder; continues from checkpoints of a stopped run of this very scene.
///
/// # Errors
/// A wrong scene, too little memory, or a folder that cannot be claimed is refused before any work; then
/// errors of the packing, the walk or the folder. After a stop, [`resume`] continues; it has an example.
pub fn walk_scene(
    scene: Scene,
    options: &RunOptions,
    callbacks: &Callbacks,
) -> Result<FinishedRun, RunError> {
    on_threads(options.prepare.threads, || walk_here(scene, options, false, callbacks))
}

/// Continues a run that was stopped or killed, with the same bits. The scene is taken from its folder;
/// [`RunOptions::out`] and [`RunOptions::overwrite`] are ignored.
///
/// # Errors
/// A folder without a run, or with a finished one, is refused; then see [`walk_scene`].
///
/// # Example
/// A walk is stopped after its first run, and continued.
/// ```
/// use std::sync::atomic::{AtomicBool, Ordering};
/// use voidwalk_app::run::{Event, Exit};
/// use voidwalk_app::{Callbacks, RunOptions, Scene, resume, walk_scene};
///
/// let small = ["network.nx=8", "network.ny=8", "network.nz=12", "replicates=2", "record.sensitivity=[]"];
/// let folder = tempfile::tempdir()?;
/// let options = RunOptions { out: Some(folder.path().join("run")), ..RunOptions::default() };
/// let stop = AtomicBool::new(false);
/// let on_event = |event: Event| {
///     stop.fetch_or(matches!(event, Event::RunDone), Ordering::Relaxed);
/// };
/// let callbacks = Callbacks { on_event: &on_event, stop: &stop, ..Callbacks::default() };
/// let stopped = walk_scene(Scene::built_in(&small.map(String::from))?, &options, &callbacks);
/// assert_eq!(stopped.err().map(|error| error.exit()), Some(Exit::Stopped));
/// let run = resume(&folder.path().join("run"), &RunOptions::default(), &Callbacks::default())?;
/// assert_eq!(run.outcome.replicates.len(), 2);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn resume(folder: &Path, options: &RunOptions, callbacks: &Callbacks) -> Result<FinishedRun, RunError> {
    let scene = folder.join("scene.toml");
    if !scene.is_file() {
        let problem = "holds no scene.toml; name the folder of a run that was stopped, or walk a scene into \
             it: voidwalk run SCENE --out DIR";
        return Err(refused(folder, problem));
    }
    if FolderKind::Run.is_finished(folder)? {
        return Err(refused(folder, "this run is finished; voidwalk report writes its page again"));
    }
    own_packings(&options.prepare.packings)?;
    let options = RunOptions { out: Some(folder.to_owned()), overwrite: false, ..options.clone() };
    let scene = Scene::read(&scene, &[])?;
    on_threads(options.prepare.threads, || walk_here(scene, &options, true, callbacks))
}

/// Walks a case in memory and writes nothing. Uses the thread pool that it is called in, else one thread per
/// core. [`voidwalk_app`](crate) has an example.
///
/// # Errors
/// A walk that fails or was stopped.
pub fn walk_case(case: &Case, callbacks: &Callbacks) -> Result<Outcome, RunError> {
    Ok(walk_case_recorded(case, callbacks)?.0)
}

/// Walks a case, and records the rows of the CSV files of a run folder.
///
/// # Errors
/// See [`walk_case`].
pub fn walk_case_recorded(case: &Case, callbacks: &Callbacks) -> Result<(Outcome, Recorded), RunError> {
    let walk = || {
        let context = ReplicateContext { callbacks, checkpoints: None, networks: None };
        let ((outcome, _), walked) = walk_all(case, &case.notes(), &context, |_, _| Ok(()))?;
        let mut recorded = Recorded::default();
        walked.into_iter().for_each(|replicate| recorded.append(replicate.recorded));
        Ok((outcome, recorded))
    };
    match rayon::current_thread_index() {
        Some(_) => walk(),
        None => on_threads(None, walk),
    }
}

fn walk_here(
    scene: Scene,
    options: &RunOptions,
    resumed: bool,
    callbacks: &Callbacks,
) -> Result<FinishedRun, RunError> {
    let files = files_of(&scene);
    let at = options.out.as_deref().unwrap_or(Path::new("."));
    let claim = || {
        let Some(path) = &options.out else { return claim_first_free("voidwalk-run") };
        let folder = claim(path, FolderKind::Run, options.overwrite)?;
        if options.overwrite {
            outlive_clear(&folder, FolderKind::Run, &files)?;
        }
        Ok(folder)
    };
    let (case, folder) = prepare_into(scene, &options.prepare, at, claim, callbacks)?;
    let unit = case.about_page().unit;
    let notes = ordered(case.notes());
    (callbacks.on_event)(Event::Noted { notes: &notes, unit });
    let started = SystemTime::now();
    let fingerprint = case.fingerprint();
    let begun = begun(&folder, &fingerprint, options.overwrite, resumed)?;
    if begun.is_none() {
        if resumed {
            // Nothing else exists of its scene and input files.
            clear_but_scene(&folder)?;
        } else {
            outlive_clear(&folder, FolderKind::Run, &files)?;
            clear(&folder, FolderKind::Run)?;
        }
        checkpoints::discard(folder.path())?;
    } else if let Some(outcome) = without_page(&folder, &case)? {
        callbacks.results(FolderKind::Run, folder.path(), None)?;
        checkpoints::discard(folder.path())?;
        Unfinished::end(&folder)?;
        let decision = outcome.decision();
        return Ok(FinishedRun { folder: folder.path().to_owned(), outcome, decision, unit });
    }
    let told = || begun?.checkpoint_every?.parse().ok();
    let every = options.checkpoint_interval.or_else(told).unwrap_or_default();
    let mark = Unfinished::new(FolderKind::Run, fingerprint.clone());
    Unfinished { checkpoint_every: Some(every.to_string()), ..mark }.begin(&folder)?;
    results::write_scene(&folder, &case)?;
    let checkpoints = Checkpoints::new(&folder, &fingerprint, every)?;
    let context = ReplicateContext { callbacks, checkpoints: Some(&checkpoints), networks: None };
    let ((outcome, decision), _) = walk_all(&case, &notes, &context, |answer, walked| {
        let threads = rayon::current_num_threads() as u64;
        let manifest = results::manifest(&case, threads, started, options.command.clone());
        let files = results::files(&case, answer.clone(), walked, manifest)?;
        results::write(&folder, &case, &files)?;
        callbacks.results(FolderKind::Run, folder.path(), Some(files))
    })
    .map_err(|error| ended(error, &checkpoints, &folder))?;
    checkpoints.clear()?;
    Unfinished::end(&folder)?;
    Ok(FinishedRun { folder: folder.path().to_owned(), outcome, decision, unit })
}

/// Files of a scene, including the scene's own file if it has one.
fn files_of(scene: &Scene) -> Vec<PathBuf> {
    let curve = |source: &Option<CurveSource>| match source {
        Some(CurveSource::File(path)) => Some(path.clone()),
        _ => None,
    };
    let (filter, base, network) = (&scene.filter, &scene.base, &scene.network);
    let tables = [&filter.sieve, &filter.measured, &base.sieve, &network.file, &network.packing];
    let named = tables.into_iter().cloned().chain([curve(&filter.curve), curve(&base.dc_curve)]).flatten();
    // The name of a soil in a workbook is not part of the path.
    std::iter::once(scene.name.clone().into()).chain(named.map(|path| file_and_soil(&path).0)).collect()
}

/// Mark of an earlier start of this very run in its folder; `None` without such a start, or if its results
/// are to be replaced. Refuses to resume a run that is no longer the one that was begun.
fn begun(
    folder: &Folder,
    fingerprint: &str,
    overwrite: bool,
    resumed: bool,
) -> Result<Option<Unfinished>, RunError> {
    let mark = Unfinished::read(folder)?;
    // A corrupt mark gives no information.
    let is_other = |mark: &Unfinished| !mark.work.is_empty() && mark.work != fingerprint;
    if resumed && mark.as_ref().is_some_and(is_other) {
        let problem = "scene.toml or a file in inputs is not what this run was begun with, or another \
                       version of voidwalk began it; put it back, or walk the scene anew into another \
                       folder: voidwalk run SCENE --out DIR";
        return Err(refused(folder.path(), problem));
    }
    if overwrite {
        return Ok(None);
    }
    let begun = mark.filter(|mark| mark.work == fingerprint);
    match Checkpoints::scene_in(folder.path()).map_err(RunError::Checkpoint)? {
        Some(scene) if scene == fingerprint => Ok(Some(begun.unwrap_or_default())),
        // Checkpoints without a scene are left over from a run that was to be replaced; they are not
        // continued.
        Some(_) if folder.has("scene.toml") => Err(refused(
            folder.path(),
            "holds checkpoints of another scene, or of another version of voidwalk; continue with that one \
             by `voidwalk resume`, or add --overwrite",
        )),
        _ => Ok(begun),
    }
}

/// Outcome of a run that was killed when only its page was missing.
fn without_page(folder: &Folder, case: &Case) -> Result<Option<Outcome>, RunError> {
    if !folder.has("scene.toml") || !folder.has("manifest.json") {
        return Ok(None);
    }
    let outcome = folder.read(FolderKind::Run.record())?;
    let outcome: Option<Outcome> = outcome.and_then(|bytes| from_json(&bytes).ok());
    Ok(outcome.filter(|o| Studies::are_whole(case, &o.sensitivity, &o.thickness)))
}

/// Walks everything that decides the verdict of a case, then its studies; `write` gets the results of both.
fn walk_all(
    case: &Case,
    notes: &[Note],
    context: &ReplicateContext,
    write: impl Fn(&(Outcome, Decision), &[ReplicateResult]) -> Result<(), RunError>,
) -> Result<((Outcome, Decision), Vec<ReplicateResult>), RunError> {
    let begun = Instant::now();
    let callbacks = context.callbacks;
    (callbacks.on_event)(Event::WalkBegun { runs: runs_to_walk(case) });
    let walks = CaseWalks::walk(case, context)?;
    for problem in context.checkpoints.iter().flat_map(|checkpoints| checkpoints.passed_over()) {
        (callbacks.warn)(&format!("{problem}; the checkpoint before it was used"));
    }
    let answer =
        |studies: Studies| results::outcome(case, notes, &walks, studies, begun.elapsed().as_secs_f64());
    let mut first = answer(Studies::default());
    if Studies::are_none(case) {
        write(&first, &walks.replicates)?;
        return Ok((first, walks.replicates));
    }
    if let Some(checkpoints) = context.checkpoints {
        // Without checkpoints, a folder with results would count as finished before its studies.
        checkpoints.flush()?;
        first.0.studies_to_come = true;
    }
    write(&first, &walks.replicates)?;
    let (outcome, decision) = &first;
    (callbacks.on_event)(Event::VerdictStands { outcome, decision, unit: case.about_page().unit });
    let whole = answer(Studies::walk(case, &walks, context)?);
    write(&whole, &walks.replicates)?;
    Ok((whole, walks.replicates))
}

/// Saves finished work that is not on disk yet, however the walk ended, and explains how to continue.
fn ended(error: RunError, checkpoints: &Checkpoints, folder: &Folder) -> RunError {
    match (error.exit(), checkpoints.flush()) {
        (Exit::Stopped, Ok(())) => RunError::Stopped(format!(
            "progress saved; continue with `voidwalk resume {}`",
            plain(&shell_word(&folder.path().display().to_string()))
        )),
        (Exit::Stopped, Err(error)) => error.into(),
        (Exit::Refused, _) => {
            RunError::Refused(format!("{error}; --overwrite begins anew, another --out leaves it alone"))
        }
        _ => error,
    }
}
