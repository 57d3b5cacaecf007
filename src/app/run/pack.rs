//! Packs a filter into a folder; the work may be stopped and continued any number of times.
//!
//! A finished folder holds `grains.csv`, `grains.vtp`, `constrictions.csv`, `constrictions.json`,
//! `constrictions.vtp` and, written last, `packing.json`. While the grains are being compressed it holds the
//! checkpoint `compression` instead ([`voidwalk_core::store::checkpoint`]), from which the next start
//! continues with the same bits: sections `state` ([`Compression::to_bytes`]) and `seconds` (one number),
//! under the fingerprint of the plan.

use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

use super::RunError;
use super::callbacks::{Callbacks, Event};
use super::cost::duration;
use super::folder::{FolderKind, MARK, STATES, Unfinished, begin, claim, clear, shown};
use super::machine::on_threads;
use super::results::json;
use crate::case::{CaseError, GRAINS, PackedFilter, PackingPlan, RECORD};
use crate::outcome::packing::PackingRecord;
use crate::scene::PackingSpec;
use crate::words;
use voidwalk_core::constrictions::{
    Constrictions, CurveError, Facets, Summary, Triangulation, VoidGraph, inscribed,
};
use voidwalk_core::gradation::CurvePoint;
use voidwalk_core::network::permeability_mm2;
use voidwalk_core::packing::{
    Cell, Compression, PackReport, Packing, PackingError, ReadOptions, draw, tall_start,
};
use voidwalk_core::store::checkpoint::{CheckpointError, Identity, Label, Section, newest, save};
use voidwalk_core::store::format::{self, from_json};
use voidwalk_core::store::{Folder, StoreError};

/// Checkpoint of an unfinished compression; its files are [`STATES`].
const STATE: &str = "compression";
/// Interval between saves of a compression that a scene needs.
const SAVE_EVERY: Duration = Duration::from_secs(60);
/// Usual folder of packings.
pub(super) const PACKINGS: &str = "voidwalk-packings";
/// Interval between checks for a packing that another process is making.
const LOOK: Duration = Duration::from_millis(500);

/// Options of packing a filter; only `overwrite` changes the resulting files.
#[derive(Clone, Debug)]
pub(crate) struct PackOptions {
    /// Folder for the packing; by default a folder of its own in `voidwalk-packings`.
    pub(crate) out: Option<PathBuf>,
    /// True if an existing packing is made again.
    pub(crate) overwrite: bool,
    /// Worker threads; by default the number that a cluster's job has, else one per core.
    pub(crate) threads: Option<usize>,
    /// Interval between saves of the compression.
    pub(crate) checkpoint_interval: Duration,
}

/// Finished packing.
pub(crate) struct FinishedPacking {
    pub(crate) folder: PathBuf,
    /// Text of `packing.json`, unchanged.
    pub(crate) json: String,
    pub(crate) record: PackingRecord,
    /// Results needed for a walk.
    pub(crate) filter: PackedFilter,
}

/// Packs a filter into a folder, continuing a packing there that was stopped. Errors: a filter that cannot be
/// packed or a folder that cannot be claimed is refused before any work. After a stop the next call
/// continues.
pub(crate) fn pack(
    spec: &PackingSpec,
    options: &PackOptions,
    callbacks: &Callbacks,
) -> Result<FinishedPacking, RunError> {
    let plan = PackingPlan::new(spec).map_err(with_time)?;
    let out = options.out.clone().unwrap_or_else(|| Path::new(PACKINGS).join(plan.folder_name()));
    let folder = claim(&out, FolderKind::Packing, options.overwrite)?;
    let begun = Unfinished::read(&folder)?.is_some_and(|begun| begun.work == plan.fingerprint());
    let saved = STATES.iter().any(|state| folder.has(state));
    if options.overwrite || !(begun || saved) {
        clear(&folder, FolderKind::Packing)?;
    }
    on_threads(options.threads, || make(&folder, &plan, options.checkpoint_interval, callbacks))?;
    let json = folder.read(RECORD)?.unwrap_or_default();
    let record = from_json(&json)?;
    let filter = PackedFilter::read(&out, &plan)?.ok_or_else(|| gone(&out))?;
    Ok(FinishedPacking { folder: out, json: String::from_utf8_lossy(&json).into_owned(), record, filter })
}

/// Adds to the refusal of a plan with too few grains the time that enough grains would take.
pub(super) fn with_time(error: CaseError) -> RunError {
    let CaseError::NarrowCell { would_do, .. } = &error else { return error.into() };
    let time = duration(would_do.core_seconds_here());
    RunError::Refused(format!(
        "{error}, in about {time} of one core or more; or packing.coarsest = 90, say, packs the finer 90 % \
         of the mass alone; or filter.library, in place of the density, takes the constrictions from \
         packings of filters like it"
    ))
}

/// Provides the packing of a scene's filter: an existing one of the filter itself or of the same shape in
/// another size, else a new one, which is kept. Waits for a packing that another process is making.
pub(crate) fn provide(
    plan: &PackingPlan,
    packings: &Path,
    callbacks: &Callbacks,
) -> Result<PackedFilter, RunError> {
    let path = packings.join(plan.folder_name());
    let has_page = || path.join(MARK).symlink_metadata().is_err();
    if let Some(filter) = PackedFilter::read(&path, plan)?.filter(|_| has_page()) {
        return Ok(filter);
    }
    if let Some(filter) = PackedFilter::of_same_shape(packings, plan)? {
        return Ok(filter);
    }
    let folder = wait_for(&path, callbacks)?;
    if !folder.has(RECORD) || folder.has(MARK) {
        make(&folder, plan, SAVE_EVERY, callbacks)?;
    }
    PackedFilter::read(&path, plan)?.ok_or_else(|| gone(&path))
}

fn gone(folder: &Path) -> RunError {
    RunError::failed(format!("{}: the packing is gone", shown(folder)))
}

/// Claims the folder of a packing as soon as no other process uses it.
fn wait_for(path: &Path, callbacks: &Callbacks) -> Result<Folder, RunError> {
    let mut told = false;
    loop {
        let holder = match Folder::open(path) {
            Err(StoreError::Held { holder, .. }) => holder,
            other => return other.map_err(RunError::Claim),
        };
        if callbacks.is_stopped() {
            let problem = "while another process made the packing; continue with the same command";
            return Err(RunError::Stopped(problem.into()));
        }
        if !told {
            (callbacks.on_event)(Event::PackingElsewhere { folder: path, holder: &holder });
            told = true;
        }
        std::thread::sleep(LOOK);
    }
}

/// Makes the packing in a claimed folder, continuing an earlier start.
fn make(
    folder: &Folder,
    plan: &PackingPlan,
    save_every: Duration,
    callbacks: &Callbacks,
) -> Result<(), RunError> {
    // The process may have been killed when only the page was missing.
    if matches!(PackedFilter::read(folder.path(), plan), Ok(Some(_))) {
        return finish(folder, callbacks);
    }
    Unfinished::new(FolderKind::Packing, plan.fingerprint()).begin(folder)?;
    let begun = Instant::now();
    (callbacks.on_event)(Event::PackingBegun(plan));
    let compressed = compress(folder, plan, save_every, callbacks);
    (callbacks.on_event)(Event::PackingEnded);
    let (compression, report, seconds_before) = compressed?;
    let packing = compression.packing();
    let constrictions = Constrictions::measure(&packing, plan.merge_overlap)?;
    let grains = packing.to_csv();
    folder.write(GRAINS, grains.as_bytes())?;
    folder.write("grains.vtp", packing.to_vtp().as_bytes())?;
    let doubts = constrictions.doubts().iter().map(words::doubt).collect();
    for (name, text) in constrictions.files(&constrictions.summary(doubts)?)? {
        folder.write(name, text.as_bytes())?;
    }
    let seconds = seconds_before + begun.elapsed().as_secs_f64();
    let record = record(plan, &packing, &grains, &report, seconds)?;
    folder.write(RECORD, &json(format::PACKING, &record)?)?;
    finish(folder, callbacks)
}

/// Finishes a packing whose record is written; the checkpoint is removed only now.
fn finish(folder: &Folder, callbacks: &Callbacks) -> Result<(), RunError> {
    STATES.iter().try_for_each(|state| folder.remove(state))?;
    callbacks.finish(FolderKind::Packing, folder)
}

/// Compresses the grains; also returns the seconds of earlier starts.
fn compress(
    folder: &Folder,
    plan: &PackingPlan,
    save_every: Duration,
    callbacks: &Callbacks,
) -> Result<(Compression, PackReport, f64), RunError> {
    let settings = &plan.compression;
    let (mut compression, seconds_before, mut generation) = match saved(folder, plan, callbacks)? {
        Some(saved) => saved,
        None => {
            let sizes = draw(&plan.gradation, settings.grains, settings.seed);
            let start = tall_start(&sizes, plan.aspect, settings)?;
            (Compression::new(&start, settings)?.of_gradation(&plan.gradation), 0.0, 0)
        }
    };
    let begun = Instant::now();
    let mut save_state = |compression: &Compression| {
        generation += 1;
        let label = Label { identity: identity(plan), generation, ..Label::default() };
        let (seconds, state) = ([seconds_before + begun.elapsed().as_secs_f64()], compression.to_bytes());
        let sections = [Section::new("seconds", &seconds), Section::new("state", &state)];
        save(folder.path(), STATE, &label, &sections)
    };
    loop {
        let since = Instant::now();
        let run = compression.run_until(
            1000,
            || callbacks.is_stopped(),
            |progress| {
                (callbacks.on_event)(Event::Packing(progress));
                since.elapsed() < save_every
            },
        );
        match run {
            Ok(report) => return Ok((compression, report, seconds_before)),
            Err(PackingError::Stopped(steps)) => {
                save_state(&compression)?;
                if callbacks.is_stopped() {
                    let saved = shown(folder.path());
                    return Err(RunError::Stopped(format!(
                        "after {steps} steps of the packing; progress saved in {saved}; continue with the \
                         same command"
                    )));
                }
            }
            Err(other) => return Err(other.into()),
        }
    }
}

/// Saved compression, the seconds spent on it and its generation.
fn saved(
    folder: &Folder,
    plan: &PackingPlan,
    callbacks: &Callbacks,
) -> Result<Option<(Compression, f64, u64)>, RunError> {
    let refused = |error: CheckpointError| match error.is_unreadable() {
        true => RunError::Checkpoint(error),
        false => RunError::Refused(format!(
            "{}: the unfinished compression there cannot be continued: {error}; name another folder or add \
             --overwrite",
            shown(folder.path())
        )),
    };
    let (saved, passed_over) = newest(folder.path(), STATE, &identity(plan)).map_err(refused)?;
    for error in passed_over {
        (callbacks.warn)(&format!("{error}; the checkpoint before it was used"));
    }
    let Some(saved) = saved else { return Ok(None) };
    let seconds = saved.read::<f64>("seconds").map_err(refused)?;
    let state = saved.read::<u8>("state").map_err(refused)?;
    let compression = Compression::from_bytes(&plan.compression, &state);
    let compression = compression.map_err(|e| refused(saved.corrupt(e.to_string())))?;
    Ok(Some((compression, seconds.first().copied().unwrap_or(0.0), saved.label.generation)))
}

/// Identity of its checkpoints.
fn identity(plan: &PackingPlan) -> Identity {
    Identity { scene: plan.fingerprint(), seed: plan.compression.seed, ..Identity::default() }
}

/// Record of a packing whose grains were written as `grains_csv`, after this many seconds of compression.
fn record(
    plan: &PackingPlan,
    packing: &Packing,
    grains_csv: &str,
    report: &PackReport,
    seconds: f64,
) -> Result<PackingRecord, CurveError> {
    let s = &plan.compression;
    let [cell_mm, height_mm] = match packing.cell {
        Cell::Periodic([x, _, z]) => [x, z],
        Cell::Free => [f64::NAN; 2],
    };
    let mut settings = match serde_json::to_value(s) {
        Ok(serde_json::Value::Object(settings)) => settings,
        _ => unreachable!("a section of settings is a map"),
    };
    for said_apart in ["seed", "final_friction", "pressure_kpa"] {
        settings.remove(said_apart);
    }
    let guess = |density| -> Result<Vec<[f64; 2]>, CurveError> {
        Ok(inscribed(&plan.gradation, density)?.points().into_iter().map(CurvePoint::row).collect())
    };
    Ok(PackingRecord {
        inscribed: [guess(1.0)?, guess(0.0)?],
        fingerprint: plan.fingerprint(),
        grains_xxh3: format!("{:016x}", xxhash_rust::xxh3::xxh3_64(grains_csv.as_bytes())),
        name: plan.name.clone(),
        linear: plan.linear,
        cu: plan.gradation.cu(),
        part: plan.part,
        same_shape: None,
        gradation: plan.gradation.points().into_iter().map(CurvePoint::row).collect(),
        grains: packing.x.len() as u64,
        seed: s.seed,
        friction: s.friction,
        final_friction: s.final_friction,
        pressure_kpa: s.pressure_kpa,
        settings,
        before: report.before,
        after: report.after,
        steps: report.steps,
        simulated_s: report.simulated_s,
        seconds,
        cell_mm,
        height_mm: (plan.aspect != 1.0).then_some(height_mm),
        slice: slice(packing, cell_mm, height_mm),
    })
}

/// Grains cut by the plane through the middle of the cell; those that cross its sides appear on both sides.
fn slice(packing: &Packing, cell_mm: f64, height_mm: f64) -> Vec<[f64; 4]> {
    let mut cuts = Vec::new();
    for i in 0..packing.x.len() {
        let height = packing.z[i] - 0.5 * height_mm;
        let radius = 0.5 * packing.diameter[i];
        let cut = radius * radius - height * height;
        if cut <= 0.0 {
            continue;
        }
        let cut = cut.sqrt();
        for dx in [-cell_mm, 0.0, cell_mm] {
            for dy in [-cell_mm, 0.0, cell_mm] {
                let (x, y) = (packing.x[i] + dx, packing.y[i] + dy);
                let inside = |v: f64| v + cut > 0.0 && v - cut < cell_mm;
                if inside(x) && inside(y) {
                    cuts.push([x, y, 2.0 * cut, packing.diameter[i]]);
                }
            }
        }
    }
    cuts
}

/// Options of measuring constrictions.
#[derive(Clone, Debug)]
pub(crate) struct ConstrictionsOptions {
    /// Overlap from which two inscribed spheres count as one void.
    pub(crate) merge_overlap: f64,
    /// Facets between voids that count as constrictions of the curve.
    pub(crate) facets: Facets,
    /// Options that complete the file of grains.
    pub(crate) read: ReadOptions,
    /// Folder for the results.
    pub(crate) out: PathBuf,
    /// True if earlier results there are replaced.
    pub(crate) overwrite: bool,
}

/// Measures the constrictions of the grains in a file and writes `grains.vtp`, `constrictions.csv`,
/// `constrictions.vtp`, for grains in a periodic cell `graph.csv` and, last, `constrictions.json`; returns
/// the contents of that file. Errors: grains that are refused or do not fit their cell; a folder that cannot
/// be claimed or written.
pub(crate) fn measure_constrictions(
    packing: &Path,
    options: &ConstrictionsOptions,
    callbacks: &Callbacks,
) -> Result<Summary, RunError> {
    on_threads(None, || options.measure(packing, callbacks))
}

impl ConstrictionsOptions {
    fn measure(&self, packing: &Path, callbacks: &Callbacks) -> Result<Summary, RunError> {
        let file = shown(packing);
        let name = packing.display().to_string();
        let (packing, notes) = Packing::read_as(packing, &self.read)?;
        let refused = |error: &dyn std::error::Error| RunError::Refused(format!("{file}: {error}"));
        let t = Triangulation::new(&packing).map_err(|error| refused(&error))?;
        let constrictions = Constrictions::from_triangulation(&t, self.merge_overlap, self.facets)
            .map_err(|error| refused(&error))?;
        constrictions.check().map_err(|error| refused(&error))?;
        // Grains without a cell, or with voids that run through it, have no graph.
        let graph = VoidGraph::of(&t, self.merge_overlap).ok();
        // In grains without a cell, constrictions near the outside do not count for the curve.
        let whole =
            |summary: &Summary| summary.grains_per_void.is_finite() && summary.mean_connectivity.is_finite();
        let doubts = constrictions.doubts().iter().map(words::doubt).collect();
        let mut summary = constrictions.summary(doubts).ok().filter(whole).ok_or_else(|| {
            RunError::Refused(format!(
                "{file}: {} grains are too few: no constriction lies between two voids inside the packing. \
                 At least 5 grains that do not lie in one plane are needed for one, some thousands for a \
                 curve",
                packing.diameter.len()
            ))
        })?;
        notes.iter().for_each(|note| (callbacks.warn)(&format!("{file}: {}", words::reading(note, &name))));
        if let Some(graph) = &graph {
            let square = graph.d32_mm * graph.d32_mm;
            let k = permeability_mm2(graph, 2).map_err(|error| refused(&error))?;
            summary.k_over_d32_squared = Some(k / square);
            summary.kozeny_carman_over_d32_squared = Some(graph.kozeny_carman_mm2() / square);
        }
        let folder = claim(&self.out, FolderKind::Constrictions, self.overwrite)?;
        begin(&folder, FolderKind::Constrictions)?;
        folder.write("grains.vtp", packing.to_vtp().as_bytes())?;
        if let Some(graph) = &graph {
            folder.write("graph.csv", graph.to_csv().as_bytes())?;
        }
        for (name, text) in constrictions.files(&summary)? {
            folder.write(name, text.as_bytes())?;
        }
        Unfinished::end(&folder)?;
        Ok(summary)
    }
}
