//! What a larger problem costs: base particles, voids, threads.

use std::time::Instant;

use super::first_run::{FirstRun, nominal};
use super::study::{PrecisionStudy, stopped};
use super::work::all_threads;
use crate::network::Network;
use crate::outcome::precision::ScalingRow;
use crate::run::error::RunError;
use crate::walk::{Engine, threads};

const ENGINES: [Engine; 3] = [Engine::Particles, Engine::Counts, Engine::Expected];

/// Sides of the cubes.
const SIDES: [u32; 6] = [10, 14, 20, 28, 40, 56];

/// Base particles at most.
const MOST: u64 = 1_000_000_000_000;

/// The tier.
pub(super) fn tier(study: &PrecisionStudy, budget_s: f64) -> Result<Vec<ScalingRow>, RunError> {
    let scene = FirstRun::of(study);
    let network = study.network(study.shape(), study.seed(1))?;
    let mut rows = Vec::new();
    for engine in ENGINES {
        // Ten times as many, until the next one would cost more than its part.
        let (mut n, mut left_s) = (10_000, 0.2 * budget_s);
        while n <= MOST {
            let run = FirstRun { engine, n_base: n, ..scene.clone() };
            let (row, cost_s) = one(study, "base particles", &run, &network, 1)?;
            rows.push(row);
            left_s -= cost_s;
            if 10.0 * cost_s > left_s && (engine == Engine::Particles || cost_s > left_s) {
                break;
            }
            n *= 10;
        }
    }
    let per_void = scene.n_base as f64 / study.case.counts[0] as f64;
    if study.shape().is_some() {
        for engine in [Engine::Particles, Engine::Counts] {
            let mut left_s = 0.1 * budget_s;
            for side in SIDES {
                let network = study.network(Some([side; 3]), study.seed(1))?;
                let n_base = (per_void * network.voids() as f64).round().max(1.0) as u64;
                let run = FirstRun { engine, n_base, ..scene.clone() };
                let (row, cost_s) = one(study, "voids", &run, &network, 1)?;
                rows.push(row);
                left_s -= cost_s;
                // The next has almost three times as many voids, and as many more layers.
                if 4.0 * cost_s > left_s {
                    break;
                }
            }
        }
    }
    let cores = std::thread::available_parallelism().map_or(1, usize::from);
    for engine in [Engine::Particles, Engine::Counts] {
        let run = FirstRun { engine, n_base: scene.n_base.min(5_000_000), ..scene.clone() };
        for count in (0..).map(|power| 1 << power).take_while(|&count| count <= cores.min(64)) {
            rows.push(one(study, "threads", &run, &network, count)?.0);
        }
    }
    Ok(rows)
}

/// A run on so many threads, and its counted cost (s).
fn one(
    study: &PrecisionStudy,
    against: &str,
    run: &FirstRun,
    network: &Network,
    count: usize,
) -> Result<(ScalingRow, f64), RunError> {
    study.tell(&format!(
        "scaling: {}, {:e} base particles, {} voids, {count} threads",
        run.engine.name(),
        run.n_base,
        network.voids()
    ));
    if study.callbacks.is_stopped() {
        return Err(stopped());
    }
    let pool = threads(count, false)?;
    let (begun, before) = (Instant::now(), all_threads());
    let ended = pool.install(|| run.walk(network, study.seed(1)))?;
    let row = ScalingRow {
        against: against.into(),
        engine: run.engine.name().into(),
        n_base: run.n_base,
        voids: network.voids() as u64,
        threads: count as u64,
        wall_seconds: begun.elapsed().as_secs_f64(),
        core_seconds: all_threads() - before,
        increments: ended.increments,
        particle_moves: ended.particle_moves,
        eroded_mass_fraction: ended.eroded_mass_fraction,
    };
    let cost_s = nominal(&ended, network);
    Ok((row, cost_s))
}
