//! Error against run time of packings and triangulations: void ratio and constriction curve by stiffness,
//! rate, number of grains and time step.

use super::comparison::{Replicates, compared, mean};
use super::study::PrecisionStudy;
use super::work::{affordable, timed};
use crate::constrictions::{Constrictions, DEFAULT_MERGE_OVERLAP, Facets, Triangulation};
use crate::gradation::Gradation;
use crate::outcome::precision::{PackingRow, PackingTier, TriangulationRow};
use crate::outcome::record::Statistic;
use crate::packing::{Compression, Packing, PackingError, Settings, draw, random_start};
use crate::run::cost::small_packing_grain_seconds;
use crate::run::error::RunError;

/// Grains of the reference, fewest first; the most that the budget pays for, and no fewer than make the cell
/// three of the largest grain wide.
const GRAINS: [usize; 5] = [300, 500, 1000, 2000, 4000];

/// Packings of each setting, at least and at most.
const SEEDS: (u64, u64) = (2, 10);

/// Packings of each setting before more grains are taken.
const ENOUGH_SEEDS: f64 = 4.0;

/// Friction of the packings.
const FRICTIONS: [f64; 2] = [0.3, 0.0];

/// Part of the budget for packings with friction; the rest goes to those without, if that pays for them.
const WITH_FRICTION: f64 = 0.85;

/// A setting that is changed; what it is a multiple of, is in [`settings`].
const CHANGES: [(&str, f64); 10] = [
    ("reference", 1.0),
    ("stiffness", 0.1),
    ("stiffness", 3.0),
    ("stiffness", 10.0),
    ("rate", 0.5),
    ("rate", 2.0),
    ("time step", 0.5),
    ("time step", 1.2),
    ("grains", 0.5),
    ("grains", 2.0),
];

/// What the changes cost together, by the cost of the reference.
const ALL_COST: f64 = 12.5;

/// Default settings at a tenth of the stiffness, but for what is changed. The hold is a number of steps: rows
/// of another step hold for the same time.
fn settings(change: (&str, f64), friction: f64, grains: usize, seed: u64) -> Settings {
    let of = Settings { friction, grains, seed, max_steps: 400_000, ..Settings::default() };
    let (factor, at) = change;
    let hold = |steps: f64| (of.hold_steps as f64 * steps) as u64;
    match factor {
        "stiffness" => {
            Settings { stiffness_ratio: of.stiffness_ratio * at, hold_steps: hold(libm::cbrt(at)), ..of }
        }
        "rate" => Settings { squeeze_rate: of.squeeze_rate * at, servo_rate: of.servo_rate * at, ..of },
        "time step" => Settings { step_fraction: of.step_fraction * at, hold_steps: hold(1.0 / at), ..of },
        "grains" => Settings { grains: (of.grains as f64 * at) as usize, ..of },
        _ => of,
    }
}

/// One packing, measured.
struct Made {
    packing: Packing,
    void_ratio: f64,
    dc5: f64,
    dc50: f64,
    cu_csd: f64,
    settled: bool,
    core_seconds: f64,
}

/// The tier.
pub(super) fn tier(study: &PrecisionStudy, budget_s: f64) -> Result<PackingTier, RunError> {
    let gradation = &study.case.filter;
    let mut packings = Vec::new();
    let mut shapes: Vec<(&str, Packing)> = Vec::new();
    for friction in FRICTIONS {
        let grain_s = small_packing_grain_seconds(friction);
        let part = if friction > 0.0 { WITH_FRICTION } else { 1.0 - WITH_FRICTION };
        let setting_s = |grains: usize| grain_s * grains as f64 * ALL_COST;
        let wide = |grains: &&usize| width_by_largest(gradation, **grains) >= 3.0;
        let usable: Vec<usize> = GRAINS.iter().filter(wide).copied().collect();
        let pays = |grains: &&usize| setting_s(**grains) * ENOUGH_SEEDS <= part * budget_s;
        let grains = match (usable.iter().rev().find(pays), usable.first()) {
            (Some(&grains), _) => grains,
            // With friction something is always shown; without, only where it is paid for.
            (None, Some(&grains)) if friction > 0.0 => grains,
            _ => {
                study.tell(&format!("packing: friction {friction} left out: too many grains for the budget"));
                continue;
            }
        };
        let seeds = affordable(part * budget_s, setting_s(grains), SEEDS.0, SEEDS.1);
        study.tell(&format!(
            "packing: friction {friction}, {grains} grains, {} settings, {seeds} seeds",
            CHANGES.len()
        ));
        let all = study.side_by_side(CHANGES.len() * seeds as usize, |piece| {
            let (change, seed) = (CHANGES[piece / seeds as usize], 1 + piece as u64 % seeds);
            made(gradation, &settings(change, friction, grains, study.seed(seed)))
        })?;
        let of_change: Vec<&[Made]> = all.chunks(seeds as usize).collect();
        for (change, made) in CHANGES.into_iter().zip(&of_change) {
            packings.push(packing_row(friction, change, made, of_change[0]));
        }
        let name = if friction > 0.0 { "compressed, friction 0.3" } else { "compressed, friction 0" };
        for made in of_change.iter().skip(CHANGES.len() - 2).chain([&of_change[0]]) {
            shapes.push((name, made[0].packing.clone()));
        }
    }
    for grains in [1000, 4000, 16_000] {
        if width_by_largest(gradation, grains) >= 3.0 {
            let settings = Settings { grains, ..Settings::default() };
            let start = random_start(&draw(gradation, grains, study.seed(1)), &settings)?;
            shapes.push(("at random, before compression", start));
        }
    }
    let mut triangulations = study.side_by_side(shapes.len(), |i| triangulated(shapes[i].0, &shapes[i].1))?;
    triangulations.sort_by(|a, b| a.packing.cmp(&b.packing).then(a.grains.cmp(&b.grains)));
    Ok(PackingTier { packings, triangulations })
}

/// Width of the cell of this many grains, by the largest grain, at a packing fraction of 0.6.
fn width_by_largest(gradation: &Gradation, grains: usize) -> f64 {
    let grain_mm3 = 1.0 / gradation.particles_per_unit_volume();
    libm::cbrt(grains as f64 * grain_mm3 / 0.6) / gradation.largest_mm()
}

fn made(gradation: &Gradation, settings: &Settings) -> Result<Made, RunError> {
    let start = random_start(&draw(gradation, settings.grains, settings.seed), settings)?;
    let mut compression = Compression::new(&start, settings)?.of_gradation(gradation);
    let (outcome, core_seconds) = timed(|| compression.run(|_| true));
    let settled = match outcome {
        Ok(_) => true,
        Err(PackingError::Unsettled { .. }) => false,
        Err(other) => return Err(other.into()),
    };
    let packing = compression.packing();
    let curve = Constrictions::measure(&packing, DEFAULT_MERGE_OVERLAP)?.curve()?;
    let d0 = gradation.smallest_mm();
    Ok(Made {
        void_ratio: compression.void_ratio(),
        dc5: curve.quantile(0.05) / d0,
        dc50: curve.quantile(0.5) / d0,
        cu_csd: curve.cu(),
        packing,
        settled,
        core_seconds,
    })
}

fn packing_row(friction: f64, change: (&str, f64), made: &[Made], reference: &[Made]) -> PackingRow {
    let each = |of: fn(&Made) -> f64, all: &[Made]| all.iter().map(of).collect::<Vec<f64>>();
    let replicates = |all: &[Made]| Replicates {
        values: each(|m| m.void_ratio, all),
        core_seconds: each(|m| m.core_seconds, all),
    };
    let (factor, at) = change;
    // Another number of grains is another start; the same seeds start from the same grains otherwise.
    let paired = factor != "grains";
    let found = replicates(made);
    let of = compared(&found, (factor != "reference").then(|| replicates(reference)).as_ref(), paired);
    let dc50 = |all: &[Made]| mean(&each(|m| m.dc50, all));
    PackingRow {
        friction,
        factor: factor.into(),
        at,
        reference: of.reference,
        grains: made[0].packing.diameter.len() as u64,
        seeds: made.len() as u64,
        settled: made.iter().filter(|m| m.settled).count() as u64,
        void_ratio: of.value,
        void_ratio_sd: Statistic::of(&found.values).sd,
        bias: of.bias,
        bias_low: of.bias_low,
        bias_high: of.bias_high,
        dc5: mean(&each(|m| m.dc5, made)),
        dc50: dc50(made),
        dc50_bias: dc50(made) / dc50(reference) - 1.0,
        cu_csd: mean(&each(|m| m.cu_csd, made)),
        core_seconds: of.core_seconds,
    }
}

/// The quickest of three triangulations and measurements.
fn triangulated(name: &str, packing: &Packing) -> Result<TriangulationRow, RunError> {
    let (mut triangulate, mut measure) = (f64::INFINITY, f64::INFINITY);
    let mut last = None;
    for _ in 0..3 {
        let (t, seconds) = timed(|| Triangulation::new(packing));
        let t = t?;
        triangulate = triangulate.min(seconds);
        let (of, seconds) = timed(|| {
            Constrictions::from_triangulation(&t, DEFAULT_MERGE_OVERLAP, Facets::All)
                .map(|of| of.constrictions())
        });
        measure = measure.min(seconds);
        last = Some((t.tetrahedra(), of?, t.sanity_check().is_ok()));
    }
    let (tetrahedra, constrictions, identities_hold) = last.expect("three of them");
    Ok(TriangulationRow {
        packing: name.into(),
        grains: packing.diameter.len() as u64,
        tetrahedra: tetrahedra as u64,
        constrictions: constrictions as u64,
        triangulate_seconds: triangulate,
        measure_seconds: measure,
        identities_hold,
    })
}
