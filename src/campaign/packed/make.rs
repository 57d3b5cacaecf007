//! Packs a filter into a folder, in as many starts of the program as it takes.
//!
//! The folder holds, once whole: `grains.csv`, `grains.vtp`, `constrictions.csv`, `constrictions.json`,
//! `constrictions.vtp` and, written last, `packing.json`. While the grains are compressed it holds `compression.state`
//! instead, from which the next start goes on with the same bits.

use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant};

use super::Order;
use crate::constrictions::{Constrictions, ConstrictionsError, CurveError, inscribed};
use crate::outcome::packing::PackingRecord;
use crate::packing::{Cell, Compression, PackReport, Packing, PackingError, Progress, draw, random_start};
use crate::store::{Folder, StoreError};

/// The state of a compression that is not finished.
pub const STATE: &str = "compression.state";
/// The packing's figures; a folder that holds it is whole.
pub const RECORD: &str = "packing.json";
/// The grains.
pub const GRAINS: &str = "grains.csv";

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
    /// Figures that cannot be put into words.
    #[error("cannot write {RECORD}: {0}")]
    Format(#[from] serde_json::Error),
    /// Stopped on request; the state is kept.
    #[error("stopped after {0} steps")]
    Stopped(u64),
}

/// Watches a compression, and can stop it.
pub struct Watch<'a> {
    /// Told how far it is.
    pub tell: &'a dyn Fn(&Progress),
    /// Set to stop.
    pub stop: &'a AtomicBool,
    /// How often the state is kept.
    pub keep_every: Duration,
}

/// Makes the packing, going on where an earlier start stopped.
///
/// # Errors
/// [`PackError`]; after [`PackError::Stopped`] the next call goes on.
pub fn make(folder: &Folder, order: &Order, watch: &Watch) -> Result<(), PackError> {
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
    folder.remove(STATE)?;
    Ok(())
}

/// Compresses the grains; with the seconds that earlier starts spent.
fn compress(
    folder: &Folder,
    order: &Order,
    watch: &Watch,
) -> Result<(Compression, PackReport, f64), PackError> {
    let settings = &order.compression;
    let (mut compression, seconds_before) = match folder.read(STATE)? {
        Some(bytes) => resume(order, &bytes)
            .map_err(|why| PackError::State { folder: folder.path().display().to_string(), why })?,
        None => {
            let start = random_start(&draw(&order.gradation, settings.grains, settings.seed), settings)?;
            (Compression::new(&start, settings)?, 0.0)
        }
    };
    let begun = Instant::now();
    let keep = |compression: &Compression| {
        let seconds = seconds_before + begun.elapsed().as_secs_f64();
        let mut bytes = head(&order.fingerprint(), seconds).to_vec();
        bytes.extend(compression.to_bytes());
        folder.write(STATE, &bytes)
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
                keep(&compression)?;
                if watch.stop.load(Ordering::Relaxed) {
                    return Err(PackError::Stopped(steps));
                }
            }
            Err(other) => return Err(other.into()),
        }
    }
}

/// What stands before the state of a compression: fingerprint of the order, seconds spent, checksum of both.
fn head(fingerprint: &str, seconds: f64) -> [u8; 32] {
    let mut head = [0; 32];
    head[..16].copy_from_slice(fingerprint.as_bytes());
    head[16..24].copy_from_slice(&seconds.to_bits().to_le_bytes());
    let sum = xxhash_rust::xxh3::xxh3_64(&head[..24]);
    head[24..].copy_from_slice(&sum.to_le_bytes());
    head
}

/// The compression that was kept, and the seconds spent on it; or what is wrong.
fn resume(order: &Order, bytes: &[u8]) -> Result<(Compression, f64), String> {
    let (start, state) = bytes.split_first_chunk::<32>().ok_or("the file ends early")?;
    let mut seconds = [0; 8];
    seconds.copy_from_slice(&start[16..24]);
    let seconds = f64::from_bits(u64::from_le_bytes(seconds));
    if xxhash_rust::xxh3::xxh3_64(&start[..24]).to_le_bytes() != start[24..] {
        return Err("the checksum of its head is wrong".into());
    }
    if start[..16] != *order.fingerprint().as_bytes() {
        return Err("it is of another gradation, or of other settings".into());
    }
    let compression = Compression::from_bytes(&order.compression, state).map_err(|e| e.to_string())?;
    Ok((compression, seconds))
}

fn record(
    order: &Order,
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
        ("brake", s.brake),
        ("local_damping", s.local_damping),
        ("start_fraction", s.start_fraction),
        ("squeeze_to", s.squeeze_to),
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
