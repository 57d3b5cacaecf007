//! A second, slow walk, particle by particle, with what the fast one decided left open: 32 or 64 bits for
//! every diameter and weight, blocking from the next increment or at once.
//!
//! Every base particle has one random stream of its own, for where it starts, its size and every exit it
//! picks. So two twins differ only where a rounding or a blocked constriction makes them, and their
//! difference is seen without the scatter of either.

use rand::Rng;
use rand_xoshiro::Xoshiro256PlusPlus;

use super::comparison::compared;
use super::networks::given;
use super::study::{PrecisionError, Study};
use super::work::{affordable, timed};
use crate::network::{END, Network};
use crate::outcome::precision::BiasRow;
use crate::stream::{Key, Purpose, below, unit};

/// The lattice of the twins, at most.
const LARGEST: [u32; 3] = [12, 12, 20];

/// Base particles of a twin, at most.
const MOST: u64 = 60_000;

/// Replicates of a twin, at least and at most.
const REPLICATES: (u64, u64) = (4, 512);

/// Processor time of a particle of a twin.
const PARTICLE_S: f64 = 3e-6;

/// What is left open.
#[derive(Clone, Copy)]
struct Rules {
    /// Diameters of constrictions and particles rounded to 32 bits, as the walk has them.
    single: bool,
    /// A constriction is closed for the next particle, not from the next increment on.
    at_once: bool,
}

/// A base particle on its way.
struct Particle {
    draws: Xoshiro256PlusPlus,
    void: u32,
    diameter: f64,
}

/// The twins as rows of the tier of biases.
pub(super) fn rows(study: &Study, budget_s: f64) -> Result<Vec<BiasRow>, PrecisionError> {
    let Some(shape) = study.shape().map(|n| std::array::from_fn(|axis| n[axis].min(LARGEST[axis]))) else {
        return Ok(Vec::new());
    };
    let case = study.case;
    let voids: f64 = shape.iter().map(|&n| f64::from(n)).product();
    let by_voids = case.n_base as f64 * voids / case.counts[0] as f64;
    let n_base = (by_voids as u64).clamp(1, MOST);
    let kinds = [
        ("twin", "32 bits, blocked from the next increment on", Rules { single: true, at_once: false }),
        ("precision", "64-bit diameters and weights", Rules { single: false, at_once: false }),
        ("blocking", "at once", Rules { single: true, at_once: true }),
    ];
    let each_s = PARTICLE_S * n_base as f64 * kinds.len() as f64;
    let replicates = affordable(budget_s, each_s, REPLICATES.0, REPLICATES.1);
    (study.tell)(&format!(
        "bias: twins of {n_base} particles on {} x {} x {} voids, {replicates} replicates",
        shape[0], shape[1], shape[2]
    ));
    let mut rows = Vec::new();
    let mut reference = None;
    for (factor, level, rules) in kinds {
        let found = study.replicates(replicates, |seed| {
            let (eroded, core_seconds) = timed(|| eroded_mass_fraction(study, shape, n_base, rules, seed));
            Ok((eroded?, core_seconds))
        })?;
        let row = compared(&found, reference.as_ref(), true);
        rows.push(BiasRow { factor: factor.into(), level: level.into(), n_base, ..row });
        reference.get_or_insert(found);
    }
    Ok(rows)
}

/// Constriction sizes in 64 bits, from the draws that [`Network::cubic`] makes them of.
fn sizes(study: &Study, count: usize, rules: Rules, seed: u64) -> Vec<f64> {
    let case = study.case;
    let mut draws = Key { seed, purpose: Purpose::Network, run: 0, increment: 0, chunk: 0 }.generator();
    let mut one = || case.curve.quantile(unit(draws.next_u64())) / case.unit_mm;
    (0..count).map(|_| rules.rounded(one())).collect()
}

impl Rules {
    fn rounded(self, diameter: f64) -> f64 {
        if self.single { f64::from(diameter as f32) } else { diameter }
    }
}

/// One run on a clean lattice, with the scene's curve, base and injection.
fn eroded_mass_fraction(
    study: &Study,
    shape: [u32; 3],
    n_base: u64,
    rules: Rules,
    seed: u64,
) -> Result<f64, PrecisionError> {
    let case = study.case;
    let count = Network::lattice_constrictions(shape)?;
    let diameter = sizes(study, count, rules, seed);
    let network = given(shape, vec![1.0; count])?;
    let increments = case.increments();
    let mut area: Vec<f64> = diameter.iter().map(|d| d * d).collect();
    let mut moving: Vec<Particle> = Vec::new();
    let (mut inserted_mass, mut eroded_mass, mut increment) = (0.0, 0.0, 0);
    // A particle trapped in a closed loop is retained; so many increments without an end are far beyond all
    // others.
    let last = increments + 400 * u64::from(shape[2]);
    while increment < last && (increment < increments || !moving.is_empty()) {
        let share = |t: u64| (u128::from(n_base) * u128::from(t) / u128::from(increments)) as u64;
        if increment < increments {
            for rank in share(increment)..share(increment + 1) {
                let key = Key { seed, purpose: Purpose::Step, run: 1, increment: 0, chunk: rank };
                let mut draws = key.generator();
                let void = network.start()[below(draws.next_u64(), network.start().len() as u64) as usize];
                let finer = 100.0 * unit(draws.next_u64());
                let size = case.base.d_by_number(finer).unwrap_or(case.base.largest_mm()) / case.unit_mm;
                let diameter = rules.rounded(size);
                inserted_mass += diameter * diameter * diameter;
                moving.push(Particle { draws, void, diameter });
            }
        }
        increment += 1;
        let mut closing = Vec::new();
        moving.retain_mut(|particle| {
            let exits = network.exits(particle.void);
            let total: f64 = area[exits.clone()].iter().sum();
            if total == 0.0 {
                return false;
            }
            let mut left = unit(particle.draws.next_u64()) * total;
            let open = exits.filter(|&c| area[c] > 0.0);
            let mut picked = None;
            for c in open {
                picked = Some(c);
                left -= area[c];
                if left < 0.0 {
                    break;
                }
            }
            let Some(c) = picked else { return false };
            if particle.diameter > diameter[c] {
                match rules.at_once {
                    true => area[c] = 0.0,
                    false => closing.push(c),
                }
                return false;
            }
            match network.targets()[c] {
                END => {
                    eroded_mass += particle.diameter * particle.diameter * particle.diameter;
                    false
                }
                target => {
                    particle.void = target;
                    true
                }
            }
        });
        closing.into_iter().for_each(|c| area[c] = 0.0);
    }
    Ok(if inserted_mass > 0.0 { eroded_mass / inserted_mass } else { 0.0 })
}
