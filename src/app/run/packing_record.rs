//! Contents of `packing.json`.

use crate::case::PackingPlan;
use crate::outcome::packing::PackingRecord;
use voidwalk_core::constrictions::{CurveError, inscribed};
use voidwalk_core::gradation::CurvePoint;
use voidwalk_core::packing::{Cell, PackReport, Packing};

/// The record of a packing whose grains were written as `grains_csv`, after this many seconds of compression.
pub(super) fn record(
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

/// The grains that the plane through the middle of the cell cuts, with those that reach over its sides on
/// both.
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
