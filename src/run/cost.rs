//! The one cost model: seconds, steps and memory of walks and packings.
//!
//! It is asked before any work, to tell a user minutes from hours and a cluster what to give, and after a
//! first run, whose counted work says what more of them will take. Its figures are those of one thread of a
//! processor of 2024 that is shared with other work; `results/check-*.md` and `results/slurm-*.md` hold
//! estimates against measured times (`scripts/check_times.py`).

use super::replicates::networks_to_walk;
use crate::case::{Case, PackingPlan};
use crate::scene::NetworkSource;

/// Seconds for one move of a particle that is walked by itself.
const MOVE_S: f64 = 2.5e-9;
/// Seconds to insert such a particle.
const INSERTION_S: f64 = 1.5e-8;
/// Seconds to part the counts of a void that holds some, in an increment, on a cubic lattice ...
const VOID_S: f64 = 1.7e-8;
/// ... and this many times longer on a network of any other kind, whose voids have any number of exits.
const OTHER_NETWORK: f64 = 3.5;
/// A void holds counts for the increments of insertion and, as the front that passes it is spread out, this
/// many times the root of the number of layers.
const SPREAD: f64 = 24.0;
/// Moves of a particle that nothing stops, by layers: on a directed lattice a third of its moves lead
/// downstream.
const MOVES_A_LAYER: f64 = 3.0;
/// Parts of the curve and of the base in which the moves of a particle are worked out.
const PARTS: usize = 64;
/// Seconds to draw a constriction of a cubic lattice, its place in the tables included.
const CONSTRICTION_S: f64 = 3.5e-8;
/// Seconds to build a network, by its voids and constrictions.
const NETWORK_S: f64 = 1e-7;
/// Seconds to write a case's files and page.
const FILES_S: f64 = 0.1;
/// Share of a case's threads that walks keep busy.
const BUSY: f64 = 0.7;
/// Seconds for one grain in one step of a compression of `GRAINS` grains; more fit the cache less well, and
/// their seconds grow with the power `GRAINS_POWER` of their number.
const GRAIN_STEP_S: f64 = 7e-8;
/// See `GRAIN_STEP_S`.
const GRAINS: f64 = 9_000.0;
/// See `GRAIN_STEP_S`.
const GRAINS_POWER: f64 = 0.2;
/// Steps that packings with friction took at Cu 1.5, and the power of Cu with which they grow (10,000 to
/// 12,800 at Cu 1.5, 19,800 at Cu 2, 21,200 to 33,100 at Cu 3, 92,500 at Cu 6;
/// `results/filters-2026-11-21.md`).
const STEPS: (f64, f64) = (10_500.0, 1.4);
/// Steps that packings without friction took at the least (38,700 to 52,500).
const DENSE_STEPS: f64 = 45_000.0;
/// Seconds to measure the constrictions around a grain, and to write it.
const MEASURED_GRAIN_S: f64 = 5e-5;
/// Seconds to compress a grain of a small packing of a precision study, with friction and without.
const SMALL_PACKING_GRAIN_S: [f64; 2] = [6.5e-4, 2.4e-3];
/// Seconds to read a packing and measure its constrictions.
pub const MEASURING_S: f64 = 5.0;
/// Seconds to collect a case into a campaign's ledger.
const COLLECTING_S: f64 = 0.05;
/// Bytes that collecting takes: at the least, and for a case.
const COLLECTING_BYTES: (u64, u64) = (100_000_000, 100_000);
/// Bytes that packing a grain takes, its constrictions included.
const GRAIN_BYTES: u64 = 20_000;
/// Bytes of the program itself and of a page that is being written.
const PROGRAM_BYTES: u64 = 100_000_000;

/// Increments after which the flow is solved again.
const SOLVED_EVERY: f64 = 10.0;

/// Solving the flow takes so long for a constriction (s): 0.185 s for 288,000 of them.
const SOLVE_S: f64 = 6.5e-7;

impl Case {
    /// Seconds that one thread of a machine of today takes for the whole case, its packing apart: a rough
    /// guess. What a rule that adds replicates may ask for besides is not foreseen.
    pub fn core_seconds(&self) -> f64 {
        self.readings().map(Case::reading_seconds).sum::<f64>() + FILES_S
    }

    /// The same for one reading of its base, its files apart.
    fn reading_seconds(&self) -> f64 {
        let [voids, constrictions, start_nodes, layers] = self.counts.map(|n| n as f64);
        let one_run = |n_base: u64| {
            let each = self.scene.walk.engine.takes_each(n_base / self.increments(), start_nodes as u64);
            let one_by_one = self.one_by_one(n_base) as f64;
            let increments = self.increments() as f64 + SPREAD * layers.sqrt();
            let slower = if self.is_cubic() { 1.0 } else { OTHER_NETWORK };
            let counted = if each { 0.0 } else { slower * voids };
            let solved = match self.scene.exit_rule().needs_flow() {
                true => (increments / SOLVED_EVERY + 2.0) * constrictions * SOLVE_S,
                false => 0.0,
            };
            solved
                + walk_seconds(0.0, increments, counted, one_by_one, one_by_one * self.moves_of_each(n_base))
        };
        let [replicates, studied] = networks_to_walk(self).map(|n| n as f64);
        let own = replicates * (1 + self.curve_ends().len()) as f64 * one_run(self.n_base);
        let of_factor = |factor: f64| one_run((self.n_base as f64 * factor) as u64);
        let others: f64 = self.sensitivity_factors().into_iter().map(of_factor).sum();
        let of_each = self.scene.record.sensitivity_replicates as f64;
        let networks = (replicates + studied) * (voids + constrictions) * NETWORK_S;
        self.scene.walk.runs as f64 * (own + of_each * others) + networks
    }

    fn is_cubic(&self) -> bool {
        matches!(self.scene.network.source(), NetworkSource::Cubic(_))
    }

    /// Moves of a particle that is walked by itself, on average: until a finer constriction stops it, with
    /// the chance that it has on the clean network, or until it leaves.
    fn moves_of_each(&self, n_base: u64) -> f64 {
        let shares = || (0..PARTS).map(|part| (part as f64 + 0.5) / PARTS as f64);
        let areas: Vec<(f64, f64)> =
            shares().map(|share| self.curve.quantile(share) / self.unit_mm).map(|d| (d, d * d)).collect();
        let all: f64 = areas.iter().map(|(_, area)| area).sum();
        let most = MOVES_A_LAYER * (self.counts[3] as f64).max(1.0);
        let moves = |d: f64| {
            let stopped =
                areas.iter().take_while(|(size, _)| *size < d).map(|(_, area)| area).sum::<f64>() / all;
            if stopped > 0.0 { (1.0 - libm::pow(1.0 - stopped, most)) / stopped } else { most }
        };
        let walked = self.sampler.part(self.first_word(n_base)..1 << 64);
        shares().filter_map(|share| walked.d_by_number(share)).map(moves).sum::<f64>() / PARTS as f64
    }

    /// Bytes that the program takes where its walks take so many.
    pub fn program_bytes(&self, walks: u64) -> u64 {
        let [voids, constrictions, ..] = self.counts;
        // A network is being built, and a page is being written.
        walks.saturating_add(PROGRAM_BYTES).saturating_add(100 * (voids + constrictions))
    }
}

/// Seconds of a walk, those of its network included: its increments, voids that hold counts, particles walked
/// by themselves, and moves of those.
fn walk_seconds(network_s: f64, increments: f64, voids: f64, one_by_one: f64, moves: f64) -> f64 {
    network_s + VOID_S * increments * voids + INSERTION_S * one_by_one + MOVE_S * moves
}

/// What a first run did, counted: the same on every machine.
#[derive(Clone, Copy, Debug)]
pub struct CountedWork {
    /// Increments.
    pub increments: u64,
    /// Moves of particles.
    pub particle_moves: u64,
    /// Base particles that were walked by themselves.
    pub one_by_one: u64,
    /// Whether that is all of them.
    pub all_one_by_one: bool,
    /// Voids of the network.
    pub voids: usize,
    /// Constrictions of the network.
    pub constrictions: usize,
}

impl CountedWork {
    /// Seconds of one thread that this work takes, the network included: the same on every machine, about
    /// right on one of 2024.
    pub fn core_seconds(&self) -> f64 {
        let each = self.one_by_one as f64;
        // Where the others are counts, the coarse ones are soon stopped.
        let (moves, voids) = match self.all_one_by_one {
            true => (self.particle_moves as f64, 0.0),
            false => (each * 4.0, self.voids as f64),
        };
        let network_s = CONSTRICTION_S * self.constrictions as f64;
        walk_seconds(network_s, self.increments as f64, voids, each, moves)
    }
}

impl PackingPlan {
    /// Seconds that one thread takes for the packing: a rough guess.
    pub fn core_seconds(&self) -> f64 {
        // Stiffer grains move in shorter steps.
        let stiffness = libm::sqrt((self.compression.stiffness_ratio / 0.1).max(0.1));
        let grains = self.compression.grains as f64;
        let step_s = GRAIN_STEP_S * libm::pow(grains / GRAINS, GRAINS_POWER);
        grains * (self.usual_steps() as f64 * stiffness * step_s + MEASURED_GRAIN_S)
    }

    /// Steps that packings of this friction and width of gradation took: that of a straight line of this Cu.
    pub fn usual_steps(&self) -> u64 {
        let cu = libm::sqrt(self.gradation.largest_mm() / self.gradation.smallest_mm());
        let (at_1_5, power) = STEPS;
        let steps = at_1_5 * libm::pow(cu / 1.5, power);
        let steps = if self.compression.friction == 0.0 { steps.max(DENSE_STEPS) } else { steps };
        100 * (steps / 100.0).round() as u64
    }

    /// The most bytes that packing it takes.
    pub fn program_bytes(&self) -> u64 {
        PROGRAM_BYTES + self.compression.grains as u64 * GRAIN_BYTES
    }
}

/// Seconds to compress a grain of a small packing (some thousands of grains) at default stiffness.
pub fn small_packing_grain_seconds(friction: f64) -> f64 {
    SMALL_PACKING_GRAIN_S[usize::from(friction == 0.0)]
}

/// Seconds that a case takes on so many threads of its own.
pub fn seconds_on(case: &Case, threads: u64) -> f64 {
    case.core_seconds() / (threads as f64 * BUSY)
}

/// Bytes that a process takes which walks these cases on so many threads, its walks no more than `allowed`.
pub fn bytes_of_cases(cases: &[&Case], threads: u64, allowed: Option<u64>) -> u64 {
    let fewest = cases.iter().map(|case| case.scene.walk.replicates).min().unwrap_or(1).max(1);
    let side_by_side = threads.div_ceil(fewest).min(cases.len() as u64);
    let largest = cases.iter().map(|case| case.peak_bytes(threads)).max().unwrap_or(0);
    let walks = largest.saturating_mul(side_by_side).min(allowed.unwrap_or(u64::MAX));
    cases.iter().map(|case| case.program_bytes(walks)).max().unwrap_or(walks)
}

/// Seconds and bytes that collecting so many cases takes, `measuring_s` for the packing of each.
pub fn collecting(cases: usize, measuring_s: f64) -> (f64, u64) {
    let bytes = COLLECTING_BYTES.0 + cases as u64 * COLLECTING_BYTES.1;
    (cases as f64 * (COLLECTING_S + measuring_s), bytes)
}

/// Seconds in words: `40 s`, `12 min`, `3.5 h`.
pub fn duration(seconds: f64) -> String {
    match seconds {
        s if s < 90.0 => format!("{:.0} s", s.ceil()),
        s if s < 5400.0 => format!("{:.0} min", s / 60.0),
        s => format!("{:.1} h", s / 3600.0),
    }
}
