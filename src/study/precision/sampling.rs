//! The scatter of the scene's eroded mass over replicates: what another second buys.
//!
//! Two kinds of replicate: *new networks* (what a verdict is about), and *one network* walked anew (what a
//! way of drawing base particles can change; what is left beside it is the scatter between networks, the
//! floor of all that draws better).

use super::changes::Change;
use super::first_run::{FirstRun, Scene, nominal};
use super::work::affordable;
use super::{PrecisionStudy, RunError};
use crate::outcome::precision::{Sampling, SamplingLine, SamplingRow, merit, spread};
use crate::outcome::record::Statistic;
use crate::walk::{Engine, Sampling as Drawn};

/// A way of drawing and moving base particles, all of one law. The first that is walked is what the others
/// are held against.
struct Variant {
    name: &'static str,
    engine: Engine,
    /// How its start nodes and sizes are drawn.
    base: Drawn,
    /// Its networks, where they are new.
    networks: Change,
}

const fn of(name: &'static str, engine: Engine, base: Drawn) -> Variant {
    Variant { name, engine, base, networks: Change::Nothing }
}

const VARIANTS: [Variant; 7] = [
    of("counts", Engine::Counts, Drawn::Independent),
    of("particles", Engine::Particles, Drawn::Independent),
    of("expected", Engine::Expected, Drawn::Independent),
    of("counts, stratified base", Engine::Counts, Drawn::Stratified),
    of("expected, stratified base", Engine::Expected, Drawn::Stratified),
    Variant {
        networks: Change::Stratified,
        ..of("counts, stratified constrictions", Engine::Counts, Drawn::Independent)
    },
    Variant {
        networks: Change::Stratified,
        ..of("expected, both stratified", Engine::Expected, Drawn::Stratified)
    },
];

/// A kind of replicate.
const KINDS: [&str; 2] = ["new networks", "one network"];

/// Replicates of every line, at least and at most.
const REPLICATES: (u64, u64) = (8, 1024);

/// Replicates of a line for which the lattice is made narrower.
const ENOUGH: u64 = 40;

/// Groups of replicates of which a standard deviation is taken, at least.
const GROUPS: u64 = 4;

/// One replicate of one variant.
struct One {
    eroded: f64,
    core_seconds: f64,
}

/// The tier.
pub(super) fn tier(study: &PrecisionStudy, budget_s: f64) -> Result<Sampling, RunError> {
    let scene = Scene::affordable(study, ENOUGH * (KINDS.len() * VARIANTS.len()) as u64, budget_s)?;
    study.tell(&format!("sampling: on {}", scene.words()));
    let network = scene.network(study.seed(1))?;
    let n_base = scene.run().n_base;
    let mut variants = Vec::new();
    let lattice = Change::all(&scene).contains(&Change::Stratified);
    for variant in VARIANTS.iter().filter(|v| lattice || v.networks == Change::Nothing) {
        let run = FirstRun { engine: variant.engine, sampling: variant.base, ..scene.run() };
        // By the moves of the counts it is known what the particles would cost, before they are walked.
        let costs = match (variant.engine, variants.first()) {
            (Engine::Particles, Some((_, _, _, moves))) => 3e-9 * *moves as f64 + 1.5e-8 * n_base as f64,
            _ => 0.0,
        };
        if costs * (2 * REPLICATES.0) as f64 > 0.7 * budget_s {
            study.tell(&format!("sampling: {} left out: {costs:.0} s a replicate", variant.name));
            continue;
        }
        let pilot = run.walk(&network, study.seed(1))?;
        variants.push((variant, run, nominal(&pilot, &network), pilot.particle_moves));
    }
    let all: f64 = variants.iter().map(|(_, _, cost, _)| cost).sum();
    let replicates = affordable(budget_s, all * KINDS.len() as f64, REPLICATES.0, REPLICATES.1);
    study.tell(&format!("sampling: {replicates} replicates of {} lines", variants.len() * KINDS.len()));
    let mut sampling = Sampling { on: scene.words(), rows: Vec::new(), lines: Vec::new() };
    for (kind, networks) in KINDS.into_iter().enumerate() {
        let mut first: Option<Vec<One>> = None;
        // On one given network there is nothing to stratify.
        let of_kind = |v: &&(&Variant, FirstRun, f64, u64)| kind == 0 || v.0.networks == Change::Nothing;
        for (variant, run, ..) in variants.iter().filter(of_kind) {
            let walked = study.side_by_side(replicates as usize, |i| {
                let seed = study.seed(1 + i as u64);
                let of_network = if kind == 0 { seed } else { study.seed(1) };
                let network = variant.networks.network(&scene, of_network)?;
                let ended = run.walk(&network, seed)?;
                Ok(One { eroded: ended.eroded_mass_fraction, core_seconds: ended.core_seconds })
            })?;
            sampling.lines.push(line(variant.name, networks, &walked, first.as_deref(), n_base));
            sampling.rows.extend(rows(variant.name, networks, &walked));
            first.get_or_insert(walked);
        }
    }
    Ok(sampling)
}

fn mean(values: impl ExactSizeIterator<Item = f64>) -> f64 {
    let n = values.len() as f64;
    values.sum::<f64>() / n
}

fn line(variant: &str, networks: &str, walked: &[One], first: Option<&[One]>, n_base: u64) -> SamplingLine {
    let eroded: Vec<f64> = walked.iter().map(|one| one.eroded).collect();
    let of = spread(&eroded, None);
    let mean_eroded = mean(eroded.iter().copied());
    let core_seconds = mean(walked.iter().map(|one| one.core_seconds));
    let difference = first.map(|first| {
        let each: Vec<f64> = walked.iter().zip(first).map(|(a, b)| a.eroded - b.eroded).collect();
        let of = Statistic::of(&each);
        (of.mean, of.sd.unwrap_or(0.0) / (each.len() as f64).sqrt())
    });
    SamplingLine {
        variant: variant.into(),
        networks: networks.into(),
        replicates: walked.len() as u64,
        mean: mean_eroded,
        difference: difference.map_or(0.0, |d| d.0),
        difference_error: difference.map(|d| d.1),
        sd: of.sd,
        sd_low: of.interval.low,
        sd_high: of.interval.high,
        binomial: (mean_eroded * (1.0 - mean_eroded) / n_base as f64).max(0.0).sqrt(),
        core_seconds,
        merit: merit(of.sd, core_seconds),
        merit_low: merit(of.interval.high, core_seconds),
        merit_high: merit(of.interval.low, core_seconds),
    }
}

/// Standard deviations of the means of groups of 1, 2, 4, ... replicates.
fn rows(variant: &str, networks: &str, walked: &[One]) -> Vec<SamplingRow> {
    let sizes = (0..).map(|power| 1u64 << power).take_while(|size| walked.len() as u64 / size >= GROUPS);
    let row = |group: u64| {
        let groups = || walked.chunks_exact(group as usize);
        let means: Vec<f64> = groups().map(|g| mean(g.iter().map(|one| one.eroded))).collect();
        let of = spread(&means, None);
        SamplingRow {
            variant: variant.into(),
            networks: networks.into(),
            group,
            groups: means.len() as u64,
            error: of.sd,
            error_low: of.interval.low,
            error_high: of.interval.high,
            core_seconds: mean(groups().map(|g| g.iter().map(|one| one.core_seconds).sum())),
        }
    };
    sizes.map(row).collect()
}
