//! Cost model of the program: seconds, steps and memory of walks and packings.
//!
//! It is used before any work, to distinguish minutes from hours for a user and to size a cluster's jobs, and
//! after a first run, whose counted work predicts the cost of further runs. Its figures hold for one thread
//! of a processor of 2024 that is shared with other work; only functions whose names end in `_here` measure
//! the speed of the machine on which they run. `results/speed.md` compares estimates with measured times
//! (`scripts/checks/check_times.py`).

use std::ops::Range;
use std::sync::LazyLock;

use super::machine::on_threads;
use super::replicates::{first_replicates, likely_replicates, plan, replicates_of_end};
use crate::case::{Case, CaseNetwork, PackingPlan, replicate_seed};
use crate::outcome::Eroded;
use crate::scene::NetworkSource;
use voidwalk_core::constrictions::Curve;
use voidwalk_core::gradation::Gradation;
use voidwalk_core::network::Network;
use voidwalk_core::packing::{Settings, compress, is_wide};
use voidwalk_core::store::platform::{THREAD_SECONDS_STEP, thread_seconds};
use voidwalk_core::walk::{Clogged, Engine, Passive, SizeClasses, State, Walk, WalkControl};

/// Times of the parts of a walk on a cubic lattice (s).
struct Rates {
    /// One move of a particle that is walked individually.
    moved_s: f64,
    /// Inserting such a particle.
    inserted_s: f64,
    /// Splitting the counts of one void in one increment.
    void_s: f64,
    /// Testing one void of an occupied layer for counts in one increment.
    looked_at_s: f64,
}

/// Rates of a walk whose occupied voids are known.
const WALK: Rates = Rates { moved_s: 2.05e-9, inserted_s: 6.5e-8, void_s: 1.65e-8, looked_at_s: 8e-9 };
/// Factors on the time of a void's counts with engine `expected`: on a lattice by area, whose rows move
/// together, and on other networks.
const EXPECTED: [f64; 2] = [0.06, 0.55];
/// Rates of a walk if only the total number of voids is known, including empty ones.
const COUNTED: Rates = Rates { moved_s: 2.5e-9, inserted_s: 1.5e-8, void_s: 1.7e-8, looked_at_s: 0.0 };
/// Factor on the time of a void's counts on any other network, whose voids have any number of exits.
const OTHER_NETWORK: f64 = 5.5;
/// A void holds counts for the increments of insertion plus this many times the square root of the number of
/// layers, because the front that passes it spreads out.
const SPREAD: f64 = 24.0;
/// Moves per layer of a particle that nothing stops: on a directed lattice a third of its moves lead
/// downstream.
const MOVES_A_LAYER: f64 = 3.0;
/// Intervals into which curve and base are divided to compute the moves of a particle.
const PARTS: usize = 64;
/// Seconds to build a network, for each void and constriction.
const NETWORK_S: f64 = 1e-7;
/// Seconds to write a case's files and page ...
const FILES_S: f64 = 0.12;
/// ... and additional ones for the files of a packing.
const PACKED_FILES_S: f64 = 0.1;
/// Maximum time of a pilot walk of a case (s).
const PILOT_S: f64 = 0.25;
/// Fraction of a case's threads that walks keep busy.
const BUSY: f64 = 0.7;
/// Seconds for one grain in one step of a compression of `GRAINS` grains. Larger packings fit the cache less
/// well: the time grows with the power `GRAINS_POWER` of their number.
const GRAIN_STEP_S: f64 = 7.5e-8;
const GRAINS: f64 = 9_000.0;
const GRAINS_POWER: f64 = 0.3;
/// Power of Cu that scales the time of a grain and step: the wider the gradation, the more of its grains
/// touch nothing.
const WIDTH_POWER: f64 = -0.4;
/// Minimum measured time that gives a pace (s) ...
const LEAST_TIMED_S: f64 = 0.002;
/// ... and its minimum number of clock steps.
const LEAST_STEPS: f64 = 6.0;
/// Time of the small packing that measures a machine's pace, at `GRAIN_STEP_S` per grain and step (s).
const SMALL_PACKING_S: f64 = 0.105;
/// Steps of packings with friction at Cu 1.5 (11,200 to 14,100), the power of Cu with which they grow (15,300
/// to 19,400 at Cu 2, 22,400 to 33,100 at Cu 3), and their upper limit (30,500 to 43,300 from Cu 4 to Cu 6,
/// with the grains' own masses).
const STEPS: (f64, f64, f64) = (12_000.0, 1.1, 40_000.0);
/// Minimum number of steps of packings without friction (38,700 to 52,500).
const DENSE_STEPS: f64 = 45_000.0;
/// Fraction of those steps for packings whose sizes differ so much that crowded grains are moved as heavier
/// ones (Cu 6: 17,800 to 22,500 of 30,900 to 51,100; without friction 20,200 to 36,300 of 30,400 to 50,300).
const WIDE_STEPS: f64 = 0.55;
/// Factor on the steps of packings whose friction is lowered at the end, so that they settle again (from 0.7
/// to 0.3: 1.5 at Cu 1.5, 2.1 and 1.9 at Cu 6).
const GIVING_WAY: f64 = 1.8;
/// Seconds to measure the constrictions around a grain, and to write it.
const MEASURED_GRAIN_S: f64 = 5e-5;
/// Seconds to read a packing and measure its constrictions.
pub(crate) const MEASURING_S: f64 = 5.0;
/// Seconds to collect a case into a campaign's ledger.
const COLLECTING_S: f64 = 0.05;
/// Memory of collecting: the minimum, and for each case (bytes).
const COLLECTING_BYTES: (u64, u64) = (100_000_000, 100_000);
/// Memory of packing one grain, including its constrictions (bytes).
const GRAIN_BYTES: u64 = 20_000;
/// Memory of the program itself and of a page that is being written (bytes).
const PROGRAM_BYTES: u64 = 100_000_000;
/// Increments between two solutions of the flow, as long as constrictions close.
const SOLVED_EVERY: f64 = 1.5;
/// Time to solve the flow, per constriction (s): 0.185 s for 288,000 constrictions.
const SOLVE_S: f64 = 6.5e-7;

impl Case {
    /// Estimated time of the whole case on one thread of a machine of 2024, without its packing (s): rough,
    /// and the same on every machine. It leaves out replicates that a rule may add.
    pub(crate) fn core_seconds(&self) -> f64 {
        self.foreseen().seconds
    }

    /// Core seconds on this machine, from the pace of the case's pilot walks.
    pub(crate) fn core_seconds_here(&self) -> f64 {
        let Foreseen { seconds, besides, took, predicted, .. } = self.foreseen();
        (seconds - besides) * pace(took, predicted) + besides
    }

    fn foreseen(&self) -> Foreseen {
        let files = FILES_S + if self.filter.packed.is_some() { PACKED_FILES_S } else { 0.0 };
        let (factors, thicknesses) = (self.sensitivity_factors(), self.thickness_factors());
        let ends = &self.filter.curve_ends;
        let most_s = PILOT_S / (1 + factors.len() + thicknesses.len() + ends.len()) as f64;
        let of_case = self.of_replicate(self.supply.n_base, most_s);
        let of_base = |f: f64| self.of_replicate((self.supply.n_base as f64 * f) as u64, most_s);
        let of_thickness = |factor: f64| match self.network.copies() {
            None => {
                self.of_thickness(factor).ok().map(|other| other.of_replicate(other.supply.n_base, most_s))
            }
            // Base and copies grow by the same factor; no pilot walks this case.
            Some(_) => {
                let times = factor * factor.max(1.0);
                let (seconds, besides) = (times * of_case.seconds, times * of_case.besides);
                Some(Foreseen { seconds, besides, ..Foreseen::default() })
            }
        };
        let points = factors.into_iter().map(of_base);
        let points = points.chain(thicknesses.into_iter().filter_map(of_thickness));
        let studies = points.map(|point| {
            // Points without a pilot are assumed to erode as the case does.
            let of_case = of_case.eroded.as_deref();
            let eroded = of_case.map(|of_case| (of_case, point.eroded.as_deref().unwrap_or(of_case)));
            (likely_replicates(self, eroded), point)
        });
        let replicates = first_replicates(self);
        let of_end = |curve: &Curve| self.with_curve(curve.clone()).of_replicate(self.supply.n_base, most_s);
        let ends = ends.iter().map(|end| (replicates_of_end(replicates), of_end(&end.curve)));
        let begun = Foreseen { seconds: files, besides: files, ..Foreseen::default() };
        let first = begun.and(replicates as f64, &of_case);
        studies.chain(ends).fold(first, |all, (replicates, point)| all.and(replicates as f64, &point))
    }

    /// Estimate for all runs of a replicate with this many base particles, including its network: from a
    /// pilot walk, else a guess.
    fn of_replicate(&self, n_base: u64, most_s: f64) -> Foreseen {
        let runs = self.scene.walk.runs as f64;
        let (guessed, solved) = self.guessed(n_base);
        let (voids, constrictions) = (self.network.voids as f64, self.network.constrictions as f64);
        let besides = runs * solved + (voids + constrictions) * NETWORK_S;
        match pilot(self, n_base, runs * guessed, most_s) {
            Some(work) => Foreseen {
                seconds: work.of_voids(voids, self.slower()) + besides,
                besides,
                took: work.took,
                // A pilot walks on a lattice by area, whatever the case's own network is.
                predicted: work.of_voids(work.voids, self.of_engine(true)),
                eroded: Some(work.eroded),
            },
            None => Foreseen { seconds: runs * guessed + besides, besides, ..Foreseen::default() },
        }
    }

    /// Seconds of one run on a network that stays clean, and the seconds spent on solving the flow.
    fn guessed(&self, n_base: u64) -> (f64, f64) {
        let CaseNetwork { voids, constrictions, layers, .. } = self.network;
        let is_one_by_one = self.takes_each(n_base);
        let one_by_one = self.one_by_one(n_base) as f64;
        let increments = self.increments() as f64 + SPREAD * (layers as f64).sqrt();
        let occupied = if is_one_by_one { 0.0 } else { self.slower() * voids as f64 * increments };
        let solved = match self.scene.exit_rule().needs_flow() {
            true => (increments / SOLVED_EVERY + 2.0) * constrictions as f64 * SOLVE_S,
            false => 0.0,
        };
        (COUNTED.seconds(occupied, 0.0, one_by_one, one_by_one * self.moves_of_each(n_base)), solved)
    }

    /// Time of a void's counts relative to engine `counts` on a cubic lattice.
    fn slower(&self) -> f64 {
        let of_network = match self.scene.network.source() {
            NetworkSource::Cubic(_) => 1.0,
            _ => OTHER_NETWORK,
        };
        of_network * self.of_engine(self.scene.is_lattice_by_area())
    }

    /// Time of a void's counts by the case's own engine, on a lattice by area or on another network.
    fn of_engine(&self, is_lattice_by_area: bool) -> f64 {
        let [of_rows, of_voids] = EXPECTED;
        match self.scene.walk.engine {
            Engine::Expected if is_lattice_by_area => of_rows,
            Engine::Expected => of_voids,
            _ => 1.0,
        }
    }

    /// Mean number of moves of a particle that is walked individually, until it leaves or a constriction
    /// stops it, with the probability of the clean network.
    fn moves_of_each(&self, n_base: u64) -> f64 {
        let shares = || (0..PARTS).map(|part| (part as f64 + 0.5) / PARTS as f64);
        let size = |share| self.filter.curve.quantile(share) / self.filter.unit_mm;
        let areas: Vec<(f64, f64)> = shares().map(size).map(|d| (d, d * d)).collect();
        let all: f64 = areas.iter().map(|(_, area)| area).sum();
        let most = MOVES_A_LAYER * (self.network.layers as f64).max(1.0);
        let moves = |d: f64| {
            let stopped =
                areas.iter().take_while(|(size, _)| *size < d).map(|(_, area)| area).sum::<f64>() / all;
            if stopped > 0.0 { (1.0 - libm::pow(1.0 - stopped, most)) / stopped } else { most }
        };
        let walked = self.supply.sampler.part(self.first_word(n_base)..1 << 64);
        shares().filter_map(|share| walked.d_by_number(share)).map(moves).sum::<f64>() / PARTS as f64
    }

    /// Memory of the whole program if its walks take this much (bytes).
    pub(crate) fn program_bytes(&self, walks: u64) -> u64 {
        let CaseNetwork { voids, constrictions, .. } = self.network;
        // A network is being built, and a page is being written.
        walks.saturating_add(PROGRAM_BYTES).saturating_add(100 * (voids + constrictions))
    }
}

impl Rates {
    /// Time for occupied voids and tested voids, both summed over the increments, for particles walked one by
    /// one, and for their moves (s).
    fn seconds(&self, voids: f64, looked_at: f64, one_by_one: f64, moves: f64) -> f64 {
        let Self { moved_s, inserted_s, void_s, looked_at_s } = self;
        void_s * voids + looked_at_s * looked_at + inserted_s * one_by_one + moved_s * moves
    }
}

impl WorkByVoid {
    /// Time of this work on this many voids, if their counts take `slower` times as long as with engine
    /// `counts` on a lattice by area (s).
    fn of_voids(&self, voids: f64, slower: f64) -> f64 {
        let [occupied, looked_at] = [self.occupied, self.looked_at].map(|seconds| voids * seconds * slower);
        WALK.seconds(occupied, looked_at, voids * self.one_by_one, voids * self.moves)
    }
}

#[derive(Default)]
struct Foreseen {
    seconds: f64,
    /// Time outside the walks: building networks, solving the flow, writing files (s).
    besides: f64,
    /// Time of the pilot walks behind it (s): measured here, and predicted by the rates of this module.
    took: f64,
    predicted: f64,
    /// Eroded mass fraction by run, if a pilot walk gives it.
    eroded: Option<Vec<f64>>,
}

impl Foreseen {
    /// Sum of this and a multiple of `other`; its pilot walks count once.
    fn and(self, times: f64, other: &Self) -> Self {
        Self {
            seconds: self.seconds + times * other.seconds,
            besides: self.besides + times * other.besides,
            took: self.took + other.took,
            predicted: self.predicted + other.predicted,
            eroded: self.eroded,
        }
    }
}

/// Measured time over predicted time; 1 if both are too short for a clock.
fn pace(took: f64, predicted: f64) -> f64 {
    let least = LEAST_TIMED_S.max(LEAST_STEPS * THREAD_SECONDS_STEP);
    if took >= least && predicted > 0.0 { took / predicted } else { 1.0 }
}

impl PackingPlan {
    /// Estimated time of the packing on one thread of a machine of 2024 (s): rough, and the same on every
    /// machine.
    pub(crate) fn core_seconds(&self) -> f64 {
        // Stiffer grains move in shorter steps.
        let stiffness = libm::sqrt((self.compression.stiffness_ratio / 0.1).max(0.1));
        let grains = self.compression.grains as f64;
        let wider = libm::pow(self.line_cu() / 1.5, WIDTH_POWER);
        let step_s = GRAIN_STEP_S * wider * libm::pow(grains / GRAINS, GRAINS_POWER);
        grains * (self.usual_steps() as f64 * stiffness * step_s + MEASURED_GRAIN_S)
    }

    /// Core seconds on this machine, from the pace of a small packing.
    pub(crate) fn core_seconds_here(&self) -> f64 {
        self.core_seconds() * pace(small_packing_seconds(), SMALL_PACKING_S)
    }

    /// Cu of the straight line between the same largest and smallest diameters.
    fn line_cu(&self) -> f64 {
        libm::sqrt(self.gradation.largest_mm() / self.gradation.smallest_mm())
    }

    /// Typical number of steps of packings of this friction and width of gradation.
    pub(crate) fn usual_steps(&self) -> u64 {
        let cu = self.line_cu();
        let (at_1_5, power, most) = STEPS;
        let steps = (at_1_5 * libm::pow(cu / 1.5, power)).min(most);
        let steps = if self.compression.friction == 0.0 { steps.max(DENSE_STEPS) } else { steps };
        let steps = if is_wide(&self.gradation) { WIDE_STEPS * steps } else { steps };
        let gives_way = self.compression.friction > self.compression.final_friction;
        let steps = if gives_way { GIVING_WAY * steps } else { steps };
        100 * (steps / 100.0).round() as u64
    }

    /// Maximum memory of packing it (bytes).
    pub(crate) fn program_bytes(&self) -> u64 {
        PROGRAM_BYTES + self.compression.grains as u64 * GRAIN_BYTES
    }
}

/// Time of a case on this many threads of its own (s).
pub(crate) fn seconds_on(case: &Case, threads: u64) -> f64 {
    case.core_seconds() / (threads as f64 * BUSY)
}

/// Time (s) and memory (bytes) of collecting this many cases, with `measuring_s` for the packing of each.
pub(crate) fn collecting(cases: usize, measuring_s: f64) -> (f64, u64) {
    let bytes = COLLECTING_BYTES.0 + cases as u64 * COLLECTING_BYTES.1;
    (cases as f64 * (COLLECTING_S + measuring_s), bytes)
}

/// Seconds in words: `40 s`, `12 min`, `3.5 h`.
pub(crate) fn duration(seconds: f64) -> String {
    match seconds {
        s if s < 90.0 => format!("{:.0} s", s.ceil()),
        s if s < 5400.0 => format!("{:.0} min", s / 60.0),
        s => format!("{:.1} h", s / 3600.0),
    }
}

/// Work of all runs of one replicate per void of its network, counted in a pilot walk of the case's runs on a
/// slim lattice of the same depth.
///
/// The time of a run depends on its base: a filter that seals leaves the voids below empty, while a base of
/// one size first blocks the constrictions that would stop it and then passes through. A lattice a few voids
/// wide receives the same base per void and so does the same work per void, in a fraction of the time.
#[derive(Default)]
struct WorkByVoid {
    /// Voids that held counts, summed over the increments.
    occupied: f64,
    /// Voids tested in layers that hold any counts, summed over the increments.
    looked_at: f64,
    /// Attempted moves of particles that are walked one by one.
    moves: f64,
    one_by_one: f64,
    /// Eroded mass fraction of each run: a slim lattice erodes about as much.
    eroded: Vec<f64>,
    voids: f64,
    /// Processor time of the pilot walk here (s); 0 if the system does not report it.
    took: f64,
}

/// Maximum width of the slim lattice: voids along x and y.
const WIDEST: u32 = 10;
/// Minimum width: particles in narrower lattices meet themselves.
const NARROWEST: u32 = 4;
/// Size classes of its records, which are not used.
const CLASSES: usize = 2;

/// Work of the runs of the case's first replicate, with `n_base` particles in all, on a slim lattice. `None`
/// if its own is as slim, if even the narrowest takes more than `most_s`, or if it cannot be walked.
/// `whole_s` is the guessed time on the case's own lattice.
fn pilot(case: &Case, n_base: u64, whole_s: f64, most_s: f64) -> Option<WorkByVoid> {
    let CaseNetwork { voids, start_nodes, layers, .. } = case.network;
    let depth = u32::try_from(layers).ok()?;
    let seconds = |width: u32| whole_s * (f64::from(width).powi(2) * f64::from(depth) / voids as f64);
    let width = (NARROWEST..=WIDEST).rev().find(|&width| seconds(width) <= most_s)?;
    if u64::from(width).pow(2) >= start_nodes {
        return None;
    }
    alone(|| walked(case, n_base, width, depth))
}

/// Result of `work` on one thread, so that its time includes no other work.
fn alone<T: Send>(work: impl Fn() -> T + Send + Sync) -> T {
    on_threads(Some(1), || Ok(work())).unwrap_or_else(|_| work())
}

/// Pilot walk on a lattice of this width and depth (voids).
fn walked(case: &Case, n_base: u64, width: u32, depth: u32) -> Option<WorkByVoid> {
    let seed = replicate_seed(case.scene.walk.seed, 1);
    let network =
        Network::cubic([width, width, depth], &case.filter.curve, case.filter.unit_mm, seed).ok()?;
    let share = network.voids() as f64 / case.network.voids as f64;
    let n_base = ((n_base as f64 * share).round() as u64).max(1);
    let across = width as usize * width as usize;
    let mut work = WorkByVoid::default();
    let mut clogged = Clogged::none(&network);
    let (begun, mut counting) = (thread_seconds(), 0.0);
    for run in 1..=case.scene.walk.runs {
        let plan = plan(case, &network, &clogged.blocked, n_base);
        let supply = plan.supply(case.supply.sampler.clone(), n_base, case.increments(), seed, run);
        let classes =
            SizeClasses::logarithmic(case.supply.sampler.smallest(), case.supply.sampler.largest(), CLASSES);
        let mut state = State::new(&network, &supply, classes, clogged, seed, run);
        work.one_by_one += supply.total() as f64;
        Walk::new(&network, &supply, &state)
            .run(&mut state, &mut |state| {
                let begun = thread_seconds();
                work.moves += state.particles.live.iter().map(|&live| f64::from(live)).sum::<f64>();
                for layer in 0..depth as usize {
                    let held = occupied(&state.passive, layer * across..(layer + 1) * across);
                    work.occupied += held as f64;
                    work.looked_at += if held > 0 { across as f64 } else { 0.0 };
                }
                counting += thread_seconds() - begun;
                WalkControl::Continue
            })
            .ok()?;
        work.eroded.push(Eroded::of(&state, case.pan_by_mass_only()).mass_fraction);
        clogged = state.into_clogged();
    }
    let voids = network.voids() as f64;
    let sums = [&mut work.occupied, &mut work.looked_at, &mut work.moves, &mut work.one_by_one];
    sums.into_iter().for_each(|sum| *sum /= voids);
    Some(WorkByVoid { voids, took: thread_seconds() - begun - counting, ..work })
}

/// Processor time of a small packing here, on one thread (s), with the same grains and steps everywhere. It
/// is packed once; 0 if the system does not report the time.
fn small_packing_seconds() -> f64 {
    static SECONDS: LazyLock<f64> = LazyLock::new(|| {
        let Ok(gradation) = Gradation::linear_from_d0(1.0, 1.5) else { return 0.0 };
        let settings = Settings { grains: 200, stiffness_ratio: 0.01, ..Settings::default() };
        alone(|| {
            let begun = thread_seconds();
            compress(&gradation, &settings, |_| true).map_or(0.0, |_| thread_seconds() - begun)
        })
    });
    *SECONDS
}

/// Number of voids that hold counts.
fn occupied(passive: &Passive, voids: Range<usize>) -> usize {
    match passive {
        Passive::OneByOne => 0,
        Passive::Counts(counts) => counts[voids].iter().filter(|&&n| n > 0).count(),
        Passive::Expected(expected) => expected.moving[voids].iter().filter(|&&n| n > 0.0).count(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Scene;
    use crate::run::prepare::Draft;

    #[test]
    fn a_clock_that_cannot_tell_changes_nothing() {
        assert_eq!([pace(0.0, 0.1), pace(0.001, 0.0001), pace(0.5, 0.0)], [1.0; 3]);
        // On any system with a clock.
        assert_eq!(pace(0.2, 0.1), 2.0);
    }

    /// Packing of a Cu 1.5 filter with friction 0.7, with the model written out.
    #[test]
    fn a_packing_takes_what_the_model_says_and_here_as_many_times_that_as_the_machine_is_slower() {
        let text = b"[filter]\ncu = 1.5\nfriction = 0.7\n[base]\ncu = 1.5\nd85_at_dc = 5\n";
        let draft = Draft::new(Scene::parse(text, "s.toml", &[]).unwrap()).unwrap();
        let plan = draft.packing.unwrap();
        let (seconds, grains) = (plan.core_seconds(), plan.compression.grains as f64);
        let expected = grains * (12_000.0 * 1.8 * 7.5e-8 * (grains / 9_000.0).powf(0.3) + 5e-5);
        assert!((seconds / expected - 1.0).abs() < 1e-9, "{seconds} for {expected}");
        let here = seconds * pace(small_packing_seconds(), SMALL_PACKING_S);
        assert_eq!(plan.core_seconds_here(), here);
    }

    #[test]
    fn a_duration_has_the_unit_that_one_would_say() {
        let words = [0.2, 89.0, 90.0, 5399.0, 5400.0].map(duration);
        assert_eq!(words, ["1 s", "89 s", "2 min", "90 min", "1.5 h"]);
    }
}
