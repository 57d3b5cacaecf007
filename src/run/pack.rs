//! Packs a filter into a folder, in as many starts of the program as it takes.
//!
//! The folder holds, once whole: `grains.csv`, `grains.vtp`, `constrictions.csv`, `constrictions.json`,
//! `constrictions.vtp` and, written last, `packing.json`. While the grains are compressed it holds the checkpoint
//! `compression` instead ([`crate::store::checkpoint`]), from which the next start goes on with the same bits: sections
//! `state` ([`Compression::to_bytes`]) and `seconds` (one number), under the fingerprint of the order.

use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant};

use crate::case::{GRAINS, PackingPlan, RECORD};
use crate::constrictions::{Constrictions, ConstrictionsError, CurveError, inscribed};
use crate::outcome::packing::PackingRecord;
use crate::packing::{
    Cell, Compression, CompressionProgress, PackReport, Packing, PackingError, draw, random_start,
};
use crate::store::checkpoint::{CheckpointError, Identity, Label, Section, newest, save};
use crate::store::{Folder, StoreError};

/// The checkpoint of a compression that is not finished ...
const STATE: &str = "compression";
/// ... and its files.
pub const STATES: [&str; 2] = ["compression.0", "compression.1"];

/// Why a filter was not packed.
#[derive(Debug, thiserror::Error)]
pub enum PackError {
    /// The compression.
    #[error(transparent)]
    Packing(#[from] PackingError),
    /// The constrictions.
    #[error(transparent)]
    Constrictions(#[from] ConstrictionsError),
    /// The constriction curve.
    #[error(transparent)]
    Curve(#[from] CurveError),
    /// The folder.
    #[error(transparent)]
    Store(#[from] StoreError),
    /// An unfinished compression that this recipe cannot go on with.
    #[error(
        "{folder}: the unfinished compression there cannot go on: {why}; name another folder or add --overwrite"
    )]
    State {
        /// The folder.
        folder: String,
        /// What is wrong with it.
        why: String,
    },
    /// An unfinished compression that the system fails to read.
    #[error(transparent)]
    Checkpoint(CheckpointError),
    /// Figures that cannot be put into words.
    #[error("cannot write {RECORD}: {0}")]
    Format(#[from] serde_json::Error),
    /// Stopped on request; the state is kept.
    #[error("stopped after {0} steps")]
    Stopped(u64),
}

/// Watches a compression, and can stop it.
pub struct PackCallbacks<'a> {
    /// Told how far it is.
    pub tell: &'a dyn Fn(&CompressionProgress),
    /// Told of a corrupt state that was passed over for the one before it.
    pub warn: &'a dyn Fn(&CheckpointError),
    /// Set to stop.
    pub stop: &'a AtomicBool,
    /// How often the state is kept.
    pub keep_every: Duration,
}

/// Makes the packing, going on where an earlier start stopped.
///
/// # Errors
/// [`PackError`]; after [`PackError::Stopped`] the next call goes on.
pub fn make(folder: &Folder, order: &PackingPlan, watch: &PackCallbacks) -> Result<(), PackError> {
    let begun = Instant::now();
    let (compression, report, seconds_before) = compress(folder, order, watch)?;
    let packing = compression.packing();
    let found = Constrictions::measure(&packing, order.merge_overlap)?;
    let grains = packing.to_csv();
    folder.write(GRAINS, grains.as_bytes())?;
    folder.write("grains.vtp", packing.to_vtp().as_bytes())?;
    for (name, text) in found.files()? {
        folder.write(name, text.as_bytes())?;
    }
    let seconds = seconds_before + begun.elapsed().as_secs_f64();
    let record = serde_json::to_string_pretty(&record(order, &packing, &grains, &report, seconds)?)? + "\n";
    folder.write(RECORD, record.as_bytes())?;
    STATES.iter().try_for_each(|state| folder.remove(state))?;
    Ok(())
}

/// Compresses the grains; with the seconds that earlier starts spent.
fn compress(
    folder: &Folder,
    order: &PackingPlan,
    watch: &PackCallbacks,
) -> Result<(Compression, PackReport, f64), PackError> {
    let settings = &order.compression;
    let (mut compression, seconds_before, mut generation) = match kept(folder, order, watch)? {
        Some(kept) => kept,
        None => {
            let start = random_start(&draw(&order.gradation, settings.grains, settings.seed), settings)?;
            (Compression::new(&start, settings)?, 0.0, 0)
        }
    };
    let begun = Instant::now();
    let mut keep_state = |compression: &Compression| {
        generation += 1;
        let label = Label { identity: identity(order), generation, ..Label::default() };
        let (seconds, state) = ([seconds_before + begun.elapsed().as_secs_f64()], compression.to_bytes());
        let sections = [Section::new("seconds", &seconds), Section::new("state", &state)];
        save(folder.path(), STATE, &label, &sections)
    };
    loop {
        let since = Instant::now();
        let run = compression.run(|progress| {
            (watch.tell)(progress);
            !watch.stop.load(Ordering::Relaxed) && since.elapsed() < watch.keep_every
        });
        match run {
            Ok(report) => return Ok((compression, report, seconds_before)),
            Err(PackingError::Stopped(steps)) => {
                keep_state(&compression)?;
                if watch.stop.load(Ordering::Relaxed) {
                    return Err(PackError::Stopped(steps));
                }
            }
            Err(other) => return Err(other.into()),
        }
    }
}

/// The compression that was kept, the seconds spent on it and its generation.
fn kept(
    folder: &Folder,
    order: &PackingPlan,
    watch: &PackCallbacks,
) -> Result<Option<(Compression, f64, u64)>, PackError> {
    let refused = |error: CheckpointError| match error.is_unreadable() {
        true => PackError::Checkpoint(error),
        false => PackError::State { folder: folder.path().display().to_string(), why: error.to_string() },
    };
    let (saved, passed_over) = newest(folder.path(), STATE, &identity(order)).map_err(refused)?;
    passed_over.iter().for_each(watch.warn);
    let Some(saved) = saved else { return Ok(None) };
    let seconds = saved.read::<f64>("seconds").map_err(refused)?;
    let state = saved.read::<u8>("state").map_err(refused)?;
    let compression = Compression::from_bytes(&order.compression, &state);
    let compression = compression.map_err(|e| refused(saved.corrupt(e.to_string())))?;
    Ok(Some((compression, seconds.first().copied().unwrap_or(0.0), saved.label.generation)))
}

fn identity(order: &PackingPlan) -> Identity {
    Identity { scene: order.fingerprint(), seed: order.compression.seed, ..Identity::default() }
}

fn record(
    order: &PackingPlan,
    packing: &Packing,
    grains_csv: &str,
    report: &PackReport,
    seconds: f64,
) -> Result<PackingRecord, CurveError> {
    let s = &order.compression;
    let cell_mm = match packing.cell {
        Cell::Periodic([x, ..]) => x,
        Cell::Free => f64::NAN,
    };
    let mut settings = serde_json::Map::new();
    for (name, value) in [
        ("shear_modulus_gpa", s.shear_modulus_gpa),
        ("poisson_ratio", s.poisson_ratio),
        ("stiffness_ratio", s.stiffness_ratio),
        ("density_kg_m3", s.density_kg_m3),
        ("restitution", s.restitution),
        ("drag", s.drag),
        ("settling_drag", s.settling_drag),
        ("local_damping", s.local_damping),
        ("start_fraction", s.start_fraction),
        ("compression_target_fraction", s.compression_target_fraction),
        ("squeeze_rate", s.squeeze_rate),
        ("servo_rate", s.servo_rate),
        ("servo_gain", s.servo_gain),
        ("mass_exponent", s.mass_exponent),
        ("step_fraction", s.step_fraction),
        ("hold_steps", s.hold_steps as f64),
    ] {
        settings.insert(name.into(), value.into());
    }
    let guess = |density| -> Result<Vec<[f64; 2]>, CurveError> {
        Ok(inscribed(&order.gradation, density)?
            .points()
            .into_iter()
            .map(|(percent, d)| [d, percent])
            .collect())
    };
    Ok(PackingRecord {
        inscribed: [guess(1.0)?, guess(0.0)?],
        fingerprint: order.fingerprint(),
        grains_xxh3: format!("{:016x}", xxhash_rust::xxh3::xxh3_64(grains_csv.as_bytes())),
        name: order.name.clone(),
        linear: order.linear,
        cu: order.gradation.cu(),
        gradation: order.gradation.points().into_iter().map(|(d, percent)| [d, percent]).collect(),
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
        slice: slice(packing, cell_mm),
    })
}

/// The grains that the plane through the middle of the cell cuts, with those that reach over its sides on both.
fn slice(packing: &Packing, cell_mm: f64) -> Vec<[f64; 4]> {
    let mut cuts = Vec::new();
    for i in 0..packing.x.len() {
        let height = packing.z[i] - 0.5 * cell_mm;
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
