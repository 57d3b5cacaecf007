//! What a setting does to the eroded mass of the scene's first run, with the interval of the difference.

use super::changes::Change;
use super::comparison::compared;
use super::first_run::ScaledScene;
use super::study::PrecisionStudy;
use super::twin;
use super::work::affordable;
use crate::outcome::precision::BiasRow;
use crate::run::error::RunError;

/// Replicates of a row, at least and at most.
const REPLICATES: (u64, u64) = (4, 256);

/// Replicates of a row for which the lattice is made narrower.
const ENOUGH: u64 = 16;

/// Part of the budget for the twins.
const TWINS: f64 = 0.1;

/// The tier.
pub(super) fn tier(study: &PrecisionStudy, budget_s: f64) -> Result<Vec<BiasRow>, RunError> {
    let scene = ScaledScene::affordable(study, 25 * ENOUGH, budget_s * (1.0 - TWINS))?;
    study.tell(&format!("bias: on {}", scene.words()));
    let each_s = scene.cost_s()?;
    let all = Change::all(&scene);
    // Each row has the same time, the reference three times as much: all others are compared with it.
    let row_s = budget_s * (1.0 - TWINS) / (all.len() + 2) as f64;
    let mut rows = Vec::new();
    let mut reference = None;
    for change in all {
        let (factor, level, at) = change.about();
        let row_s = if change == Change::Nothing { 3.0 * row_s } else { row_s };
        let cost_s = each_s * change.cost(&scene);
        if cost_s * REPLICATES.0 as f64 > 3.0 * row_s.max(0.1 * budget_s) {
            study.tell(&format!("bias: {factor}, {level} left out: {cost_s:.0} s a replicate"));
            continue;
        }
        let count = affordable(row_s, cost_s, REPLICATES.0, REPLICATES.1);
        study.tell(&format!("bias: {factor}, {level}: {count} replicates"));
        let run = change.run(&scene);
        let found = study.replicates(count, |seed| {
            let ended = run.walk(&change.network(&scene, seed)?, seed)?;
            Ok((ended.eroded_mass_fraction, ended.core_seconds))
        })?;
        let level = match change {
            Change::Nothing => format!("{level}, {}", scene.words()),
            _ => level,
        };
        let row = compared(&found, reference.as_ref(), change.keeps_network());
        rows.push(BiasRow { factor: factor.into(), level, at, n_base: run.n_base, ..row });
        reference.get_or_insert(found);
    }
    rows.extend(twin::rows(study, budget_s * TWINS)?);
    Ok(rows)
}
