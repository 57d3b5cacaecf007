//! Each engine against exact answers.
//!
//! Two probabilities to leave are known by a linear solve ([`Network::first_passage`]), on random networks:
//!
//! - *first particle*: a single particle of size Dc35 on a clean lattice. It is walked alone, over and over,
//!   with the rule that stops it; and, so that each of many million particles is a first one, as particles
//!   that fit everywhere on the network in which finer exits lead into a void without exits
//!   ([`Network::as_first_particle_of`]).
//! - *clogged lattice*: particles that fit everywhere, on a lattice of which 58 % of the constrictions are
//!   blocked from the start, as a second run meets it. They end in voids without open exits, are trapped in
//!   closed loops, or leave.
//!
//! On one of these networks the particles are independent, so here, and only here, the error must be the
//! binomial one; the engine `expected` draws nothing, and its error is the rounding of its whole numbers.

use bitvec::vec::BitVec;
use rand::Rng;

use super::closed_forms;
use super::comparison::mean;
use super::first_run::{FirstRun, clean};
use super::study::PrecisionStudy;
use super::work::summed;
use crate::network::{Network, NetworkError};
use crate::outcome::log_log_slope;
use crate::outcome::precision::{
    ExactRow, ExactTier, MeasuredQuantity, NetworkRow, Slope, merit, sd_estimate,
};
use crate::run::error::RunError;
use crate::stream::{Key, Purpose, unit};
use crate::walk::Engine;

/// Random networks: more than a hundred, as many as make a row of bits.
const NETWORKS: usize = 128;

/// Shape of each.
const SHAPE: [u32; 3] = [6, 6, 4];

/// Networks tried for each that is taken.
const TRIES: u64 = 32;

/// Probabilities to leave that a network must have to be taken: beyond them hardly anything varies.
const PROBABILITIES: std::ops::Range<f64> = 0.02..0.98;

/// Share of constrictions that are blocked from the start.
const CLOGGED: f64 = 0.58;

/// Percent of the constrictions finer than the first particle.
const FIRST_AT_DC: f64 = 35.0;

/// Expected particles that leave, and that do not, from which a deviation is counted in standard errors.
const NORMAL_FROM: f64 = 50.0;

/// Processor time of a particle walked through such a network, on the lattice and on the general one, and of
/// a single one with all that a run takes.
const PARTICLE_S: [f64; 2] = [2.5e-8, 6.0e-8];
const SINGLE_S: f64 = 2.0e-5;

/// A random network with its exact answer.
struct Known {
    network: Network,
    blocked: BitVec,
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

impl Way {
    fn name(self) -> &'static str {
        match self {
            Way::Together(engine) => engine.name(),
            Way::Alone => "one at a time",
        }
    }
}

/// A line of the diagram.
struct Line<'a> {
    quantity: &'static str,
    known: &'a [Known],
    way: Way,
    /// The most particles.
    most: u64,
}

/// The tier.
pub(super) fn tier(study: &PrecisionStudy, budget_s: f64) -> Result<(ExactTier, Vec<NetworkRow>), RunError> {
    let clogged = study.known(clogged)?;
    let d = study.case.curve.dc(FIRST_AT_DC).unwrap_or(study.case.curve.largest()) / study.case.unit_mm;
    let single = study.known(|network, _| first_particle(network, d))?;
    let many: Vec<Known> = single.iter().map(|known| known.as_many(d)).collect();
    let most = |part: f64, each_s: f64| tidy(budget_s * part / (NETWORKS as f64 * each_s * 1.2));
    let particles = most(0.65, PARTICLE_S[0]);
    // Counts and expectations cost the same for any number.
    let counts = 1000 * particles;
    let (mut quantities, mut lines) = (Vec::new(), Vec::new());
    let engines = |quantity, known, particles| {
        let all = [(Engine::Particles, particles), (Engine::Counts, counts), (Engine::Expected, counts)];
        all.map(|(engine, most)| Line { quantity, known, way: Way::Together(engine), most })
    };
    if !clogged.is_empty() {
        let what = "probability that a particle smaller than every constriction leaves a 6 x 6 x 4 lattice \
                    with 58 % of its constrictions blocked from the start";
        quantities.push(quantity("clogged lattice", what, &clogged));
        lines.extend(engines("clogged lattice", &clogged, particles));
    }
    if !single.is_empty() {
        let what = "probability that a single particle of size Dc35 leaves a clean 6 x 6 x 4 lattice";
        quantities.push(quantity("first particle", what, &single));
        let most_alone = most(0.1, SINGLE_S);
        lines.push(Line { quantity: "first particle", known: &single, way: Way::Alone, most: most_alone });
        lines.extend(engines("first particle", &many, most(0.1, PARTICLE_S[1])));
    }
    let (mut rows, mut networks, mut slopes) = (Vec::new(), Vec::new(), Vec::new());
    for line in &lines {
        let Line { quantity, way, most, .. } = line;
        study.tell(&format!("exact: {quantity}, {}, up to {most:e} particles", way.name()));
        let first = rows.len();
        for particles in line.numbers() {
            let (row, mut each) = line.row(study, particles)?;
            rows.push(row);
            if particles == *most {
                networks.append(&mut each);
            }
        }
        slopes.push(slope(&rows[first..]));
    }
    study.tell("exact: integers and closed forms");
    let closed = closed_forms::rows(study, budget_s * 0.15)?;
    Ok((ExactTier { networks: NETWORKS as u64, quantities, rows, slopes, closed }, networks))
}

/// One, two or five times a power of ten, from 1,000 to 1e8.
fn tidy(number: f64) -> u64 {
    let powers = (3..=8).rev().flat_map(|power| [5, 2, 1].map(|digit| digit * 10u64.pow(power)));
    powers.filter(|n| *n <= 100_000_000).find(|n| *n as f64 <= number).unwrap_or(1000)
}

fn quantity(name: &str, words: &str, known: &[Known]) -> MeasuredQuantity {
    let leaves: Vec<f64> = known.iter().map(|k| k.leaves).collect();
    MeasuredQuantity { name: name.into(), words: words.into(), mean: mean(&leaves) }
}

/// A lattice of which some constrictions are blocked; the particle is finer than every constriction.
fn clogged(network: Network, seed: u64) -> Result<Known, NetworkError> {
    let mut draws = Key { seed, purpose: Purpose::Percolation, run: 0, increment: 0, chunk: 0 }.generator();
    let blocked: BitVec = (0..network.constrictions()).map(|_| unit(draws.next_u64()) < CLOGGED).collect();
    let diameter = f64::from(network.finest_open(|_| false)) / 2.0;
    let (leaves, _) = network.first_passage(diameter as f32, |c| blocked[c])?.from_start(&network);
    Ok(Known { network, blocked, diameter, leaves })
}

fn first_particle(network: Network, diameter: f64) -> Result<Known, NetworkError> {
    let (leaves, _) = network.first_passage(diameter as f32, |_| false)?.from_start(&network);
    Ok(Known { blocked: clean(&network), network, diameter, leaves })
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
    fn known(
        &self,
        of: impl Fn(Network, u64) -> Result<Known, NetworkError>,
    ) -> Result<Vec<Known>, RunError> {
        let mut taken = Vec::new();
        for k in 1..=TRIES * NETWORKS as u64 {
            let seed = self.seed(k);
            let known = of(self.lattice(SHAPE, seed)?, seed).map_err(|error| {
                RunError::failed(format!(
                    "exact: {error}; such a curve has no exact answers to compare with: leave this tier out \
                     (--tier sampling bias decision scaling packing)"
                ))
            })?;
            if PROBABILITIES.contains(&known.leaves) {
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
        let (found, seconds): (Vec<f64>, Vec<f64>) = walked.into_iter().unzip();
        let (quantity, engine) = (self.quantity.to_string(), self.way.name().to_string());
        let n = particles as f64;
        let draws = !matches!(self.way, Way::Together(Engine::Expected));
        let network = |((network, &found), known): ((u64, &f64), &Known)| {
            let p = known.leaves;
            let normal = draws && n * p.min(1.0 - p) >= NORMAL_FROM;
            let z = normal.then(|| (found - p) / (p * (1.0 - p) / n).sqrt());
            let (quantity, engine) = (quantity.clone(), engine.clone());
            NetworkRow { quantity, engine, particles, network, exact: p, found, z }
        };
        let networks: Vec<NetworkRow> = (1..).zip(&found).zip(self.known).map(network).collect();
        let off: Vec<f64> = networks.iter().map(|row| row.found - row.exact).collect();
        let variances: Vec<f64> = self.known.iter().map(|k| k.leaves * (1.0 - k.leaves) / n).collect();
        let z: Option<Vec<f64>> = networks.iter().map(|row| row.z).collect();
        let (error, core_seconds) = (sd_estimate(&off, Some(0.0)), mean(&seconds));
        let row = ExactRow {
            quantity,
            engine,
            particles,
            networks: networks.len() as u64,
            error: error.sd,
            error_low: error.interval.low,
            error_high: error.interval.high,
            expected_error: mean(&variances).sqrt(),
            bias: mean(&off),
            largest_z: z.as_ref().map(|z| z.iter().fold(0.0, |most: f64, z| most.max(z.abs()))),
            chi_squared: z.as_ref().map(|z| z.iter().map(|z| z * z).sum()),
            core_seconds,
            merit: merit(error.sd, core_seconds),
        };
        Ok((row, networks))
    }

    /// The share that leaves, and the processor time (s).
    fn found(&self, known: &Known, particles: u64, seed: u64) -> Result<(f64, f64), RunError> {
        let run = |engine, n_base| FirstRun::of_one_size(known.diameter, n_base, 1, engine);
        let (eroded, seconds) = match self.way {
            Way::Together(engine) => {
                let run = run(engine, particles)?;
                let ended = run.walk_from(&known.network, known.blocked.clone(), seed, 1)?;
                (ended.eroded, ended.core_seconds)
            }
            Way::Alone => {
                let single = run(Engine::Particles, 1)?;
                let one = |k: u64| Ok(single.walk(&known.network, seed.wrapping_add(k << 8))?.eroded);
                summed(0..particles, one)?
            }
        };
        Ok((eroded as f64 / particles as f64, seconds))
    }
}

/// How the error of a line falls with the number of particles.
fn slope(rows: &[ExactRow]) -> Slope {
    let errors = rows.iter().filter(|row| row.error > 0.0);
    let points: Vec<(f64, f64)> = errors.map(|row| (row.particles as f64, row.error)).collect();
    Slope {
        quantity: rows[0].quantity.clone(),
        engine: rows[0].engine.clone(),
        slope: (points.len() > 1).then(|| log_log_slope(&points)),
        smallest_error: rows.iter().map(|row| row.error).fold(f64::INFINITY, f64::min),
        largest_z: rows.iter().filter_map(|row| row.largest_z).reduce(f64::max),
    }
}
