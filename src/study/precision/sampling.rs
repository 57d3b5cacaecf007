//! The scatter of the scene's eroded mass over replicates: what another second buys.
//!
//! Two kinds of replicate: *new networks* (what a verdict is about), and *one network* walked anew (what a
//! way of drawing base particles can change; the rest is the scatter between networks, which no way of
//! drawing lowers).

use super::changes::Change;
use super::comparison::{Replicates, mean, paired_difference};
use super::first_run::{FirstRun, ScaledScene, nominal};
use super::study::{PrecisionError, Study};
use super::work::affordable;
use crate::outcome::precision::{SamplingLine, SamplingRow, SamplingTier, merit, sd_estimate};
use crate::walk::{Engine, Sampling};

/// A way of drawing and moving base particles; under all of them the eroded mass has one expectation. The
/// first that is walked is what the others are compared with.
struct Variant {
    name: &'static str,
    engine: Engine,
    /// How its start nodes and sizes are drawn.
    base: Sampling,
    /// Its networks, where they are new.
    networks: Change,
}

const fn of(name: &'static str, engine: Engine, base: Sampling) -> Variant {
    Variant { name, engine, base, networks: Change::Nothing }
}

const VARIANTS: [Variant; 7] = [
    of("counts", Engine::Counts, Sampling::Independent),
    of("particles", Engine::Particles, Sampling::Independent),
    of("expected", Engine::Expected, Sampling::Independent),
    of("counts, stratified base", Engine::Counts, Sampling::Stratified),
    of("expected, stratified base", Engine::Expected, Sampling::Stratified),
    Variant {
        networks: Change::Stratified,
        ..of("counts, stratified constrictions", Engine::Counts, Sampling::Independent)
    },
    Variant {
        networks: Change::Stratified,
        ..of("expected, both stratified", Engine::Expected, Sampling::Stratified)
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

/// The tier.
pub(super) fn tier(study: &Study, budget_s: f64) -> Result<SamplingTier, PrecisionError> {
    let scene = ScaledScene::affordable(study, ENOUGH * (KINDS.len() * VARIANTS.len()) as u64, budget_s)?;
    (study.tell)(&format!("sampling: on {}", scene.words()));
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
            (study.tell)(&format!("sampling: {} left out: {costs:.0} s a replicate", variant.name));
            continue;
        }
        let pilot = run.walk(&network, study.seed(1))?;
        variants.push((variant, run, nominal(&pilot, &network), pilot.particle_moves));
    }
    let all: f64 = variants.iter().map(|(_, _, cost, _)| cost).sum();
    let replicates = affordable(budget_s, all * KINDS.len() as f64, REPLICATES.0, REPLICATES.1);
    (study.tell)(&format!("sampling: {replicates} replicates of {} lines", variants.len() * KINDS.len()));
    let mut sampling = SamplingTier { on: scene.words(), rows: Vec::new(), lines: Vec::new() };
    for (kind, networks) in KINDS.into_iter().enumerate() {
        let mut first = None;
        // On one given network there is nothing to stratify.
        let of_kind = |v: &&(&Variant, FirstRun, f64, u64)| kind == 0 || v.0.networks == Change::Nothing;
        for (variant, run, ..) in variants.iter().filter(of_kind) {
            let found = study.replicates(replicates, |seed| {
                let of_network = if kind == 0 { seed } else { study.seed(1) };
                let network = variant.networks.network(&scene, of_network)?;
                let ended = run.walk(&network, seed)?;
                Ok((ended.eroded_mass_fraction, ended.core_seconds))
            })?;
            sampling.lines.push(line(variant.name, networks, &found, first.as_ref(), n_base));
            sampling.rows.extend(rows(variant.name, networks, &found));
            first.get_or_insert(found);
        }
    }
    Ok(sampling)
}

/// All replicates of a variant, compared with those of the first one.
fn line(
    variant: &str,
    networks: &str,
    found: &Replicates,
    first: Option<&Replicates>,
    n_base: u64,
) -> SamplingLine {
    let of = sd_estimate(&found.values, None);
    let (mean_eroded, core_seconds) = (mean(&found.values), mean(&found.core_seconds));
    let replicates = found.values.len();
    let difference = first.map(|first| paired_difference(found, first));
    SamplingLine {
        variant: variant.into(),
        networks: networks.into(),
        replicates: replicates as u64,
        mean: mean_eroded,
        difference: difference.map_or(0.0, |d| d.mean),
        difference_error: difference.map(|d| d.sd.unwrap_or(0.0) / (replicates as f64).sqrt()),
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
fn rows(variant: &str, networks: &str, found: &Replicates) -> Vec<SamplingRow> {
    let sizes =
        (0..).map(|power| 1u64 << power).take_while(|size| found.values.len() as u64 / size >= GROUPS);
    let row = |group: u64| {
        let means: Vec<f64> = found.values.chunks_exact(group as usize).map(mean).collect();
        let seconds = found.core_seconds.chunks_exact(group as usize).map(|group| group.iter().sum());
        let of = sd_estimate(&means, None);
        SamplingRow {
            variant: variant.into(),
            networks: networks.into(),
            group,
            groups: means.len() as u64,
            error: of.sd,
            error_low: of.interval.low,
            error_high: of.interval.high,
            core_seconds: mean(&seconds.collect::<Vec<f64>>()),
        }
    };
    sizes.map(row).collect()
}
