//! What a setting does to the eroded mass of the scene's first run, with the interval of the difference.

use super::changes::Change;
use super::first_run::Scene;
use super::twin;
use super::work::affordable;
use super::{PrecisionStudy, RunError};
use crate::outcome::precision::BiasRow;
use crate::outcome::record::Statistic;
use crate::outcome::student;

/// Replicates of a row, at least and at most.
const REPLICATES: (u64, u64) = (4, 256);

/// Replicates of a row for which the lattice is made narrower.
const ENOUGH: u64 = 16;

/// Part of the budget for the twins.
const TWINS: f64 = 0.1;

/// Eroded mass fractions of the replicates of a row, in order, and their mean processor time (s).
pub(super) struct Walked {
    pub eroded: Vec<f64>,
    pub core_seconds: f64,
}

/// The tier.
pub(super) fn tier(study: &PrecisionStudy, budget_s: f64) -> Result<Vec<BiasRow>, RunError> {
    let scene = Scene::affordable(study, 25 * ENOUGH, budget_s * (1.0 - TWINS))?;
    study.tell(&format!("bias: on {}", scene.words()));
    let each_s = scene.cost_s()?;
    let all = Change::all(&scene);
    // Each row has the same time, the reference three times as much: all others lean on it.
    let row_s = budget_s * (1.0 - TWINS) / (all.len() + 2) as f64;
    let mut rows = Vec::new();
    let mut reference = None;
    for change in all {
        let row_s = if change == Change::Nothing { 3.0 * row_s } else { row_s };
        let cost_s = each_s * change.cost(&scene);
        if cost_s * REPLICATES.0 as f64 > 3.0 * row_s.max(0.1 * budget_s) {
            study.tell(&format!(
                "bias: {}, {} left out: {cost_s:.0} s a replicate",
                change.factor(),
                change.level()
            ));
            continue;
        }
        let count = affordable(row_s, cost_s, REPLICATES.0, REPLICATES.1);
        study.tell(&format!("bias: {}, {}: {count} replicates", change.factor(), change.level()));
        let run = change.run(&scene);
        let walked = study.side_by_side(count as usize, |i| {
            let seed = study.seed(1 + i as u64);
            let ended = run.walk(&change.network(&scene, seed)?, seed)?;
            Ok((ended.eroded_mass_fraction, ended.core_seconds))
        })?;
        let walked = Walked {
            core_seconds: walked.iter().map(|(_, seconds)| seconds).sum::<f64>() / count as f64,
            eroded: walked.into_iter().map(|(eroded, _)| eroded).collect(),
        };
        let paired = change.keeps_network();
        let level = match change {
            Change::Nothing => format!("{}, {}", change.level(), scene.words()),
            _ => change.level(),
        };
        rows.push(row(change.factor(), level, change.at(), run.n_base, &walked, reference.as_ref(), paired));
        reference.get_or_insert(walked);
    }
    rows.extend(twin::rows(study, budget_s * TWINS)?);
    Ok(rows)
}

/// A row, held against the reference: replicate by replicate where they are `paired`.
pub(super) fn row(
    factor: &str,
    level: String,
    at: f64,
    n_base: u64,
    walked: &Walked,
    reference: Option<&Walked>,
    paired: bool,
) -> BiasRow {
    let value = Statistic::of(&walked.eroded);
    let bias = reference.map(|reference| match paired {
        true => {
            let each: Vec<f64> = walked.eroded.iter().zip(&reference.eroded).map(|(a, b)| a - b).collect();
            let of = Statistic::of(&each);
            (of.mean, of.low, of.high)
        }
        false => welch(&walked.eroded, &reference.eroded),
    });
    BiasRow {
        factor: factor.into(),
        level,
        at,
        reference: reference.is_none(),
        n_base,
        replicates: walked.eroded.len() as u64,
        value: value.mean,
        bias: bias.map_or(0.0, |b| b.0),
        bias_low: bias.and_then(|b| b.1),
        bias_high: bias.and_then(|b| b.2),
        paired: paired && reference.is_some(),
        core_seconds: walked.core_seconds,
    }
}

/// Difference of two means of independent values, and its 95 % interval (Welch).
fn welch(a: &[f64], b: &[f64]) -> (f64, Option<f64>, Option<f64>) {
    let (of_a, of_b) = (Statistic::of(a), Statistic::of(b));
    let (na, nb) = (a.len() as f64, b.len() as f64);
    let (va, vb) = (of_a.sd.map_or(0.0, |s| s * s / na), of_b.sd.map_or(0.0, |s| s * s / nb));
    let difference = of_a.mean - of_b.mean;
    let degrees = (va + vb) * (va + vb) / (va * va / (na - 1.0) + vb * vb / (nb - 1.0));
    if !degrees.is_finite() {
        return (difference, None, None);
    }
    let half = student::two_sided((degrees as u64).max(1), 0.05) * (va + vb).sqrt();
    (difference, Some(difference - half), Some(difference + half))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// By hand: means 2 and 6, variances of the means 1/3 and 4/3; 2.94 degrees of freedom, taken as 2.
    #[test]
    fn welch_by_hand() {
        let (difference, low, high) = welch(&[1.0, 2.0, 3.0], &[4.0, 6.0, 8.0]);
        let half = 4.302_653 * (5.0f64 / 3.0).sqrt();
        assert_eq!(difference, -4.0);
        assert!((low.unwrap() + 4.0 + half).abs() < 1e-6 && (high.unwrap() + 4.0 - half).abs() < 1e-6);
        assert_eq!(welch(&[1.0, 1.0], &[1.0, 1.0]), (0.0, None, None));
    }

    #[test]
    fn pairs_take_the_scatter_of_the_networks_out() {
        let of = |eroded: &[f64]| Walked { eroded: eroded.to_vec(), core_seconds: 1.0 };
        let (a, b) = (of(&[0.2, 0.5, 0.9]), of(&[0.1, 0.4, 0.8]));
        let paired = row("f", "l".into(), 1.0, 1, &a, Some(&b), true);
        assert!((paired.bias - 0.1).abs() < 1e-12 && (paired.bias_high.unwrap() - 0.1).abs() < 1e-9);
        assert!(row("f", "l".into(), 1.0, 1, &a, Some(&b), false).bias_high.unwrap() > 0.5);
    }
}
