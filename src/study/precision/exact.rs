//! Each engine against exact answers.
//!
//! Two chances to leave are known by a linear solve ([`Network::first_passage`]), on random networks:
//!
//! - *first particle*: a lone particle of size Dc35 on a clean lattice. It is walked alone, over and over,
//!   with the rule that stops it; and, so that each of many million particles is a first one, as particles
//!   that fit everywhere on the network in which finer exits lead into a void without exits
//!   ([`Network::as_first_particle_of`]).
//! - *clogged lattice*: particles that fit everywhere, on a lattice of which 58 % of the constrictions are
//!   blocked from the start, as a second run meets it. They end in voids without open exits, circle for ever,
//!   or leave.
//!
//! On one of these networks the particles are independent, so here, and only here, the error must be the
//! binomial one; the engine `expected` draws nothing, and its error is the rounding of its whole numbers.

use bitvec::vec::BitVec;
use rand::Rng;

use super::closed_forms;
use super::first_run::FirstRun;
use super::work::timed;
use super::{PrecisionStudy, RunError};
use crate::gradation::{Gradation, SizeSampler};
use crate::network::Network;
use crate::outcome::precision::{Exact, ExactRow, NetworkRow, Quantity, Slope, merit, spread};
use crate::stream::{Key, Purpose, unit};
use crate::walk::{Engine, Sampling};

/// Random networks: more than a hundred, as many as make a row of bits.
const NETWORKS: usize = 128;

/// Shape of each.
const SHAPE: [u32; 3] = [6, 6, 4];

/// Networks tried for each that is taken.
const TRIES: u64 = 32;

/// Chances to leave that a network must have to be taken: beyond them hardly anything varies.
const CHANCES: std::ops::Range<f64> = 0.02..0.98;

/// Share of constrictions that are blocked from the start.
const CLOGGED: f64 = 0.58;

/// Percent of the constrictions finer than the first particle.
const FIRST_AT_DC: f64 = 35.0;

/// Expected particles that leave, and that do not, from which a deviation is counted in standard errors.
const NORMAL_FROM: f64 = 50.0;

/// Processor time of a particle walked through such a network, on the lattice and on the general one, and of
/// a lone one with all that a run takes.
const PARTICLE_S: [f64; 2] = [2.5e-8, 6.0e-8];
const LONE_S: f64 = 2.0e-5;

/// A random network with its exact answer.
struct Known {
    network: Network,
    blocked: BitVec<u64>,
    diameter: f64,
    leaves: f64,
}

/// How the particles of a line are walked.
#[derive(Clone, Copy)]
enum Way {
    /// So many in one run.
    Together(Engine),
    /// One by one, each in a run of its own.
    Alone,
}

/// A line of the diagram.
struct Line<'a> {
    quantity: &'static str,
    engine: &'static str,
    known: &'a [Known],
    way: Way,
    /// The most particles.
    most: u64,
}

/// The tier.
pub(super) fn tier(study: &PrecisionStudy, budget_s: f64) -> Result<(Exact, Vec<NetworkRow>), RunError> {
    let clogged = study.known(clogged)?;
    let d = study.case.curve.dc(FIRST_AT_DC).unwrap_or(study.case.curve.largest()) / study.case.unit_mm;
    let lone = study.known(|network, _| first_particle(network, d))?;
    let made: Vec<Known> = lone.iter().map(|known| known.as_many(d)).collect();
    let mut quantities = Vec::new();
    let mut lines = Vec::new();
    let most = |part: f64, each_s: f64| tidy(budget_s * part / (NETWORKS as f64 * each_s * 1.2));
    // Counts and expectations cost the same for any number.
    let counts = 1000 * most(0.65, PARTICLE_S[0]);
    if !clogged.is_empty() {
        let words = "chance of a particle that fits everywhere to leave a 6 x 6 x 4 lattice of which 58 % of the constrictions are blocked from the start";
        quantities.push(quantity("clogged lattice", words, &clogged));
        for (engine, most) in [
            (Engine::Particles, most(0.65, PARTICLE_S[0])),
            (Engine::Counts, counts),
            (Engine::Expected, counts),
        ] {
            let way = Way::Together(engine);
            lines.push(Line {
                quantity: "clogged lattice",
                engine: engine.name(),
                known: &clogged,
                way,
                most,
            });
        }
    }
    if !lone.is_empty() {
        let words = "chance of a lone particle of size Dc35 to leave a clean 6 x 6 x 4 lattice";
        quantities.push(quantity("first particle", words, &lone));
        let alone = most(0.1, LONE_S);
        lines.push(Line {
            quantity: "first particle",
            engine: "one at a time",
            known: &lone,
            way: Way::Alone,
            most: alone,
        });
        for (engine, most) in [
            (Engine::Particles, most(0.1, PARTICLE_S[1])),
            (Engine::Counts, counts),
            (Engine::Expected, counts),
        ] {
            let way = Way::Together(engine);
            lines.push(Line { quantity: "first particle", engine: engine.name(), known: &made, way, most });
        }
    }
    let (mut rows, mut networks, mut slopes) = (Vec::new(), Vec::new(), Vec::new());
    for line in &lines {
        study.tell(&format!("exact: {}, {}, up to {:e} particles", line.quantity, line.engine, line.most));
        let first = rows.len();
        for particles in line.numbers() {
            let (row, mut each) = line.row(study, particles)?;
            rows.push(row);
            if particles == line.most {
                networks.append(&mut each);
            }
        }
        slopes.push(slope(&rows[first..]));
    }
    study.tell("exact: integers and closed forms");
    let closed = closed_forms::rows(study, budget_s * 0.15)?;
    Ok((Exact { networks: NETWORKS as u64, quantities, rows, slopes, closed }, networks))
}

/// One, two or five times a power of ten, from 1,000 to 1e8.
fn tidy(number: f64) -> u64 {
    let powers = (3..=8).rev().flat_map(|power| [5, 2, 1].map(|digit| digit * 10u64.pow(power)));
    powers.filter(|n| *n <= 100_000_000).find(|n| *n as f64 <= number).unwrap_or(1000)
}

fn quantity(name: &str, words: &str, known: &[Known]) -> Quantity {
    let mean = known.iter().map(|k| k.leaves).sum::<f64>() / known.len() as f64;
    Quantity { name: name.into(), words: words.into(), mean }
}

/// A lattice of which some constrictions are blocked; the particle is finer than every constriction.
fn clogged(network: Network, seed: u64) -> Known {
    let mut draws = Key { seed, purpose: Purpose::Percolation, run: 0, increment: 0, chunk: 0 }.generator();
    let blocked: BitVec<u64> =
        (0..network.constrictions()).map(|_| unit(draws.next_u64()) < CLOGGED).collect();
    let diameter = f64::from(network.finest_open(|_| false)) / 2.0;
    let (leaves, _) = network.first_passage(diameter as f32, |c| blocked[c]).from_start(&network);
    Known { network, blocked, diameter, leaves }
}

fn first_particle(network: Network, diameter: f64) -> Known {
    let (leaves, _) = network.first_passage(diameter as f32, |_| false).from_start(&network);
    Known { blocked: BitVec::repeat(false, network.constrictions()), network, diameter, leaves }
}

impl Known {
    /// The network on which each of many particles is a first one.
    fn as_many(&self, d: f64) -> Known {
        let network = self.network.as_first_particle_of(d as f32);
        let diameter = f64::from(network.finest_open(|_| false)) / 2.0;
        Known { network, diameter, blocked: self.blocked.clone(), leaves: self.leaves }
    }
}

impl PrecisionStudy<'_> {
    /// Random networks of the scene's curve with an answer that is neither sure nor hopeless; none where
    /// there are not enough.
    fn known(&self, of: impl Fn(Network, u64) -> Known) -> Result<Vec<Known>, RunError> {
        let mut taken = Vec::new();
        for k in 1..=TRIES * NETWORKS as u64 {
            let seed = self.seed(k);
            let case = self.case;
            let known = of(Network::cubic(SHAPE, &case.curve, case.unit_mm, seed)?, seed);
            if CHANCES.contains(&known.leaves) {
                taken.push(known);
            }
            if taken.len() == NETWORKS {
                return Ok(taken);
            }
        }
        Ok(Vec::new())
    }
}

impl Line<'_> {
    /// Powers of ten, and the most.
    fn numbers(&self) -> Vec<u64> {
        let powers = (2..).map(|power| 10u64.pow(power));
        powers.take_while(|n| 2 * n <= self.most).chain([self.most]).collect()
    }

    /// All networks with so many particles each.
    fn row(&self, study: &PrecisionStudy, particles: u64) -> Result<(ExactRow, Vec<NetworkRow>), RunError> {
        let walked = study.side_by_side(self.known.len(), |i| {
            self.found(&self.known[i], particles, study.seed(1 + i as u64) ^ particles)
        })?;
        let n = particles as f64;
        let networks: Vec<NetworkRow> = (1..)
            .zip(&walked)
            .zip(self.known)
            .map(|((network, (found, _)), known)| {
                let p = known.leaves;
                let draws = !matches!(self.way, Way::Together(Engine::Expected));
                let normal = draws && n * p.min(1.0 - p) >= NORMAL_FROM;
                let z = normal.then(|| (found - p) / (p * (1.0 - p) / n).sqrt());
                let (quantity, engine) = (self.quantity.into(), self.engine.into());
                NetworkRow { quantity, engine, particles, network, exact: p, found: *found, z }
            })
            .collect();
        let count = networks.len() as f64;
        let off: Vec<f64> = networks.iter().map(|row| row.found - row.exact).collect();
        let error = spread(&off, Some(0.0));
        let variance: f64 = self.known.iter().map(|k| k.leaves * (1.0 - k.leaves) / n).sum::<f64>() / count;
        let z: Option<Vec<f64>> = networks.iter().map(|row| row.z).collect();
        let core_seconds = walked.iter().map(|(_, seconds)| seconds).sum::<f64>() / count;
        let row = ExactRow {
            quantity: self.quantity.into(),
            engine: self.engine.into(),
            particles,
            networks: networks.len() as u64,
            error: error.sd,
            error_low: error.interval.low,
            error_high: error.interval.high,
            expected_error: variance.sqrt(),
            bias: off.iter().sum::<f64>() / count,
            largest_z: z.as_ref().map(|z| z.iter().fold(0.0, |most: f64, z| most.max(z.abs()))),
            chi_squared: z.as_ref().map(|z| z.iter().map(|z| z * z).sum()),
            core_seconds,
            merit: merit(error.sd, core_seconds),
        };
        Ok((row, networks))
    }

    /// The share that leaves, and the processor time (s).
    fn found(&self, known: &Known, particles: u64, seed: u64) -> Result<(f64, f64), RunError> {
        let sampler = SizeSampler::new(&Gradation::single(known.diameter)?, 1.0)?;
        let run = |engine, n_base| FirstRun {
            engine,
            sampler: sampler.clone(),
            tail: 0.0,
            n_base,
            increments: 1,
            sampling: Sampling::Independent,
        };
        match self.way {
            Way::Together(engine) => {
                let ended =
                    run(engine, particles).walk_from(&known.network, known.blocked.clone(), seed, 1)?;
                Ok((ended.eroded as f64 / particles as f64, ended.core_seconds))
            }
            Way::Alone => {
                let lone = run(Engine::Particles, 1);
                let all = || -> Result<u64, RunError> {
                    let mut eroded = 0;
                    for particle in 0..particles {
                        eroded += lone.walk(&known.network, seed.wrapping_add(particle << 8))?.eroded;
                    }
                    Ok(eroded)
                };
                let (eroded, seconds) = timed(all);
                Ok((eroded? as f64 / particles as f64, seconds))
            }
        }
    }
}

/// Least squares of ln(error) against ln(particles).
fn slope(rows: &[ExactRow]) -> Slope {
    let points: Vec<(f64, f64)> = rows
        .iter()
        .filter(|row| row.error > 0.0)
        .map(|row| (libm::log(row.particles as f64), libm::log(row.error)))
        .collect();
    let n = points.len() as f64;
    let (x, y) = (points.iter().map(|p| p.0).sum::<f64>() / n, points.iter().map(|p| p.1).sum::<f64>() / n);
    let xy: f64 = points.iter().map(|p| (p.0 - x) * (p.1 - y)).sum();
    let xx: f64 = points.iter().map(|p| (p.0 - x) * (p.0 - x)).sum();
    Slope {
        quantity: rows[0].quantity.clone(),
        engine: rows[0].engine.clone(),
        slope: (points.len() > 1).then(|| xy / xx),
        smallest_error: rows.iter().map(|row| row.error).fold(f64::INFINITY, f64::min),
        largest_z: rows.iter().filter_map(|row| row.largest_z).reduce(f64::max),
    }
}
