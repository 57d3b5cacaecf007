//! Walks given networks without a scene: built by other programs or by hand.

use std::borrow::Cow;
use std::sync::Arc;
use std::time::Instant;

use bitvec::slice::BitSlice;
use bitvec::vec::BitVec;

use super::RunError;
use super::callbacks::{Callbacks, Event};
use super::machine::Machine;
use super::replicates::{ReplicateResult, map_side_by_side, summarise};
use crate::case::{CaseError, PAPER_MASS_RATIO, in_words, replicate_seed};
use crate::outcome::record::{Replicate, RunSummary, Verdict};
use crate::outcome::verdict::classify;
use crate::outcome::{Recorded, Recorder, RunId, RunMetrics, Wanted};
use voidwalk_core::gradation::{Gradation, GradationError, SizeSampler, base_particles};
use voidwalk_core::network::Network;
use voidwalk_core::walk::{Engine, RunPlan, Sampling, SizeClasses, State, Walk, WalkControl};

/// Estimated memory of one void during a walk, with its constrictions (bytes); generous.
const BYTES_A_VOID: u64 = 600;
/// Memory of one base particle (bytes).
const BYTES_A_PARTICLE: u64 = 8;

/// Plan of walks on given networks.
#[derive(Clone, Debug)]
pub struct NetworkWalk {
    /// The base.
    pub base: Gradation,
    /// Base particles of a run.
    pub n_base: u64,
    /// Increments of equal mass in which they are inserted.
    pub increments: u64,
    /// Engine of passive particles.
    pub engine: Engine,
    /// Sampling of sizes and start nodes.
    pub sampling: Sampling,
    /// Seed; replicate `r` uses its [`replicate_seed`].
    pub seed: u64,
    /// Runs of a replicate, 1 or 2.
    pub runs: u64,
    /// Replicates, each with random numbers of its own.
    pub replicates: u64,
    /// Records to keep.
    pub wanted: Wanted,
    /// The filter, if known.
    pub filter: Option<GivenFilter>,
    /// Mass ratio of base to filter, for Eq. (2).
    pub mass_ratio: f64,
}

/// Known properties of the filter of a given network.
#[derive(Clone, Debug)]
pub struct GivenFilter {
    /// Its gradation.
    pub gradation: Gradation,
    /// True if it is a sieve curve rather than an assumed straight line.
    pub is_measured: bool,
    /// Its grains per void, without which Eq. (2) gives no number.
    pub grains_per_void: Option<f64>,
}

/// Results of the walks.
pub struct NetworkOutcome {
    /// Class that the replicates together support.
    pub verdict: Verdict,
    /// Statistics over the replicates, by run.
    pub(crate) summary: Vec<RunSummary>,
    /// Every replicate, in order.
    pub replicates: Vec<WalkedNetwork>,
}

/// Walked replicate.
pub struct WalkedNetwork {
    /// Its figures and rows.
    pub result: ReplicateResult,
    /// Blocked exits at the end of each run.
    pub blocked: Vec<BitVec>,
}

/// Walks given networks in memory, replicate `r` on entry `(r - 1) mod n` of the `n` networks, on the threads
/// of the pool that it is called in.
///
/// A network is walked to the same bits if a scene names it.
///
/// # Errors
/// Settings that are not allowed, a base whose pan fraction need not be passive, or too little memory are
/// refused before any work; then errors of a walk, or a stop.
///
/// # Example
/// ```
/// use std::sync::Arc;
/// use voidwalk_core::constrictions::find;
/// use voidwalk_app::run::{Callbacks, NetworkWalk, walk_networks};
/// use voidwalk_core::{Gradation, Network};
///
/// let curve = find("cu1.5-loose")?.curve()?.in_mm(1.0)?;
/// let network = Arc::new(Network::cubic([8, 8, 12], &curve, 1.0, 7)?);
/// let plan = NetworkWalk { replicates: 2, ..NetworkWalk::new(Gradation::single(0.2)?, 20_000) };
/// let outcome = walk_networks(&[network], &plan, &Callbacks::default())?;
/// assert_eq!(outcome.replicates.len(), 2);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn walk_networks(
    networks: &[Arc<Network>],
    plan: &NetworkWalk,
    callbacks: &Callbacks,
) -> Result<NetworkOutcome, RunError> {
    let samplers = plan.check(networks)?;
    (callbacks.on_event)(Event::WalkBegun { runs: plan.runs * plan.replicates });
    let one = |replicate: u64| {
        let index = (replicate - 1) as usize % networks.len();
        plan.replicate(&networks[index], &samplers[index], replicate, callbacks)
    };
    let replicates = 1..=plan.replicates;
    let bytes = plan.bytes(networks).saturating_mul(rayon::current_num_threads() as u64);
    let walked = map_side_by_side(replicates.collect(), bytes <= SIDE_BY_SIDE_BYTES, one)?;
    let (results, blocked): (Vec<ReplicateResult>, Vec<_>) = walked.into_iter().unzip();
    let (verdict, summary) = summarise(&results);
    let replicates =
        results.into_iter().zip(blocked).map(|(result, blocked)| WalkedNetwork { result, blocked }).collect();
    Ok(NetworkOutcome { verdict, summary, replicates })
}

/// A replicate, and its blocked exits at the end of each run.
type Walked = (ReplicateResult, Vec<BitVec>);

/// Replicates are walked side by side if they take at most this much memory together (bytes).
const SIDE_BY_SIDE_BYTES: u64 = 1 << 30;

impl NetworkWalk {
    /// Plan for `n_base` particles of this base, with a scene's default settings.
    pub fn new(base: Gradation, n_base: u64) -> Self {
        Self {
            base,
            n_base,
            increments: 100,
            engine: Engine::Auto,
            sampling: Sampling::Independent,
            seed: 1,
            runs: 2,
            replicates: 10,
            wanted: Wanted { series_every: 1, size_curves: Vec::new(), size_classes: 64, voids: None },
            filter: None,
            mass_ratio: PAPER_MASS_RATIO,
        }
    }

    /// D15F (mm) by mass, if known.
    pub(crate) fn d15f_mm(&self) -> Option<f64> {
        self.filter.as_ref()?.gradation.d(15.0)
    }

    /// Base particles that Eq. (2) gives on a network for this mass ratio, if filter and grains per void are
    /// known.
    ///
    /// # Errors
    /// Numbers that Eq. (2) does not accept.
    pub fn eq2(&self, network: &Network, mass_ratio: f64) -> Result<Option<u64>, GradationError> {
        let Some(GivenFilter { gradation, grains_per_void: Some(grains), .. }) = &self.filter else {
            return Ok(None);
        };
        let voids = network.filter_voids() as u64;
        let supply = base_particles(mass_ratio, *grains, voids, &self.base, gradation, None)?;
        Ok(Some(supply.n_base_eq2))
    }

    /// Refuses plans that cannot be walked; returns a size sampler for each network.
    fn check(&self, networks: &[Arc<Network>]) -> Result<Vec<SizeSampler>, RunError> {
        for (name, value, most) in [
            ("runs", self.runs, 2),
            ("replicates", self.replicates, 100_000),
            ("increments", self.increments, 1_000_000),
            ("n_base", self.n_base, u64::MAX),
            ("size_classes", self.wanted.size_classes as u64, 10_000),
        ] {
            if !(1..=most).contains(&value) {
                let problem = format!("{name} = {value} is not allowed; a whole number from 1 to {most}");
                return Err(RunError::Refused(problem));
            }
        }
        if networks.is_empty() {
            return Err(RunError::refused("there is no network to walk"));
        }
        let mut samplers = Vec::with_capacity(networks.len());
        for network in networks {
            self.eq2(network, self.mass_ratio).map_err(CaseError::from)?;
            let finest_mm = f64::from(network.finest_open(|_| false)) * network.unit_mm();
            if self.base.pan_fraction() > 0.0 && self.base.smallest_mm() > finest_mm {
                return Err(RunError::Refused(format!(
                    "the base's finest sieve, {} mm, is coarser than the finest constriction, {finest_mm:.4} \
                     mm: its tail of unknown size may not be passive; give d0_mm or a finer sieve",
                    self.base.smallest_mm()
                )));
            }
            let sampler = SizeSampler::new(&self.base, network.unit_mm()).map_err(CaseError::from)?;
            samplers.push(sampler);
        }
        let (needed, available) = (self.bytes(networks), Machine::here().available);
        if needed > available {
            return Err(CaseError::Memory {
                study: String::new(),
                n_base: self.n_base,
                voids: networks.iter().map(|network| network.voids() as u64).max().unwrap_or(0),
                needed: in_words(needed),
                available: in_words(available),
                disk: String::new(),
            }
            .into());
        }
        Ok(samplers)
    }

    /// Memory of one walk on the largest of these networks (bytes).
    fn bytes(&self, networks: &[Arc<Network>]) -> u64 {
        let bytes = |network: &Arc<Network>| {
            let coarse = self.coarse_particles(network);
            let passive_share = (self.n_base - coarse) / self.increments;
            let one_by_one = match self.engine.takes_each(passive_share, network.entries() as u64) {
                true => self.n_base,
                false => coarse,
            };
            let voids = (network.voids() as u64).saturating_mul(BYTES_A_VOID);
            one_by_one.saturating_mul(BYTES_A_PARTICLE).saturating_add(voids)
        };
        networks.iter().map(bytes).max().unwrap_or(0)
    }

    /// Approximate number of base particles coarser than the finest constriction, which are walked one by
    /// one.
    fn coarse_particles(&self, network: &Network) -> u64 {
        let finest_mm = f64::from(network.finest_open(|_| false)) * network.unit_mm();
        let coarser = 1.0 - self.base.percent_finer_by_number(finest_mm) / 100.0;
        (self.n_base as f64 * coarser) as u64
    }

    /// Plan of a run with these constrictions blocked.
    fn plan(&self, network: &Network, sampler: &SizeSampler, blocked: &BitSlice) -> RunPlan {
        RunPlan::new(self.engine, network, sampler, blocked, self.n_base / self.increments)
            .sampled(self.sampling)
    }

    fn replicate(
        &self,
        network: &Arc<Network>,
        sampler: &SizeSampler,
        replicate: u64,
        callbacks: &Callbacks,
    ) -> Result<Walked, RunError> {
        let seed = replicate_seed(self.seed, replicate);
        let mut blocked = BitVec::repeat(false, network.constrictions());
        let first = self.plan(network, sampler, &blocked);
        let (mut runs, mut below) = (Vec::new(), Vec::new());
        let (mut recorded, mut at_ends) = (Recorded::default(), Vec::new());
        let mut exits = None;
        for run in 1..=self.runs {
            let begun = Instant::now();
            let plan = self.plan(network, sampler, &blocked);
            let supply = plan.supply(sampler.clone(), self.n_base, self.increments, seed, run);
            let classes =
                SizeClasses::logarithmic(sampler.smallest(), sampler.largest(), self.wanted.size_classes);
            let mut state = State::new(network, &supply, classes, blocked, seed, run);
            let mut walk = Walk::with_exits(network, &supply, &state, exits.take().map(Cow::Owned));
            let mut recorder = Recorder::default();
            walk.run(&mut state, &mut |state| {
                recorder.observe(&self.wanted, state);
                let (increment, moving) = (state.increment, state.tally.moving);
                (callbacks.on_event)(Event::Increment { replicate, run, increment, moving });
                if callbacks.is_stopped() { WalkControl::Stop } else { WalkControl::Continue }
            })?;
            let (end, flow, left) = walk.end(&state)?;
            exits = left;
            let d15f_mm = self.d15f_mm().unwrap_or(f64::NAN);
            let run_id = RunId { replicate, run, d15f_mm, pan_fraction: self.base.pan_fraction() };
            let seconds = begun.elapsed().as_secs_f64();
            let mut metrics = RunMetrics::new(&end, &state, flow.as_ref(), run_id, seconds);
            if self.d15f_mm().is_none() {
                metrics.run.largest_eroded_over_d15f = None;
            }
            recorded.append(Recorded::new(&end, &state, flow.as_ref(), &recorder, run_id));
            below.push(metrics.below_threshold);
            runs.push(metrics.run);
            at_ends.push(state.blocked.clone());
            blocked = state.blocked;
            (callbacks.on_event)(Event::RunDone);
        }
        let verdict = classify(below.first().copied(), below.get(1).copied());
        let result = ReplicateResult {
            replicate: Replicate { seed, verdict, runs },
            recorded,
            engine: first.engine(),
            left_out: first.left_out().to_vec(),
            below,
        };
        Ok((result, at_ends))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::case::Case;
    use crate::run::walk_case;
    use crate::scene::Scene;
    use std::sync::atomic::AtomicBool;
    use voidwalk_core::network::{ExitRule, NetworkColumns};

    fn lattice() -> Network {
        let curve =
            voidwalk_core::constrictions::find("cu1.5-loose").unwrap().curve().unwrap().in_mm(1.0).unwrap();
        Network::cubic([6, 6, 8], &curve, 1.0, 5).unwrap()
    }

    /// Covers engines that record and engines that count, both runs, and every figure but the time.
    #[test]
    fn a_network_is_walked_as_the_scene_that_names_it_walks_it() {
        let folder = tempfile::tempdir().unwrap();
        let file = folder.path().join("net.csv");
        let mut text = Vec::new();
        lattice().write_csv(&mut text).unwrap();
        std::fs::write(&file, text).unwrap();
        for engine in ["particles", "counts", "expected"] {
            let scene = format!(
                "seed = 9\nreplicates = 3\nengine = \"{engine}\"\n[filter]\ncu = 1.5\n[network]\n\
                 file = {file:?}\n[base]\ncu = 3.0\nd85_mm = 0.25\nn_base = 30000\n\
                 [record]\nsensitivity = []\n"
            );
            let case = Case::new(Scene::parse(scene.as_bytes(), "scene", &[]).unwrap()).unwrap();
            let mut expected = walk_case(&case, &Callbacks::default()).unwrap();
            let plan = NetworkWalk {
                seed: 9,
                replicates: 3,
                engine: Engine::ALL.into_iter().find(|e| e.name() == engine).unwrap(),
                filter: Some(GivenFilter {
                    gradation: case.filter.gradation.clone(),
                    is_measured: false,
                    grains_per_void: None,
                }),
                ..NetworkWalk::new(case.base.gradation.clone(), 30_000)
            };
            let mut outcome = walk_networks(&[Arc::new(lattice())], &plan, &Callbacks::default()).unwrap();
            assert_eq!((outcome.verdict, &outcome.summary), (expected.model.class, &expected.summary));
            for (walked, expected) in outcome.replicates.iter_mut().zip(&mut expected.replicates) {
                let replicate = &mut walked.result.replicate;
                let runs = replicate.runs.iter_mut().chain(&mut expected.runs);
                runs.for_each(|run| run.seconds = 0.0);
                assert_eq!(replicate, expected);
                let at_end = walked.blocked.iter().map(|blocked| blocked.count_ones() as u64);
                assert!(at_end.eq(expected.runs.iter().map(|run| run.blocked)));
            }
        }
    }

    #[test]
    fn an_undirected_network_is_walked_both_ways() {
        // A ring of four voids, inlet at void 0 and outlet at void 2: one side lets nothing through.
        let columns = NetworkColumns {
            voids: 4,
            conns: &[[0, 1], [2, 1], [0, 3], [3, 2]],
            diameter_mm: &[1.0, 1.0, 0.4, 0.4],
            conductance: Some(&[1.0; 4]),
            inlets: &[0],
            outlets: &[2],
            rule: ExitRule::Flux,
            rho: 0.0,
            unit_mm: 1.0,
        };
        let (network, exit) = Network::from_columns(&columns).unwrap();
        let plan = NetworkWalk { replicates: 4, ..NetworkWalk::new(Gradation::single(0.5).unwrap(), 1000) };
        let outcome = walk_networks(&[Arc::new(network)], &plan, &Callbacks::default()).unwrap();
        for walked in &outcome.replicates {
            // One particle blocks the narrow side: all others take the wide side, at the end of the ring.
            let at_end: Vec<bool> = exit.iter().map(|&exit| walked.blocked[1][exit as usize]).collect();
            assert_eq!(at_end, [false, false, true, false]);
            let run = &walked.result.replicate.runs[1];
            assert_eq!((run.eroded, run.retained_in_constrictions, run.blocked), (1000, 0, 1));
        }
    }

    #[test]
    fn what_cannot_be_walked_is_refused_and_a_stop_is_heard() {
        let networks = [Arc::new(lattice())];
        let refused = |plan: NetworkWalk, message: &str| {
            let error = walk_networks(&networks, &plan, &Callbacks::default()).err().unwrap();
            assert!(
                error.exit() == crate::run::Exit::Refused && error.to_string().contains(message),
                "{error}"
            );
        };
        let plan = NetworkWalk::new(Gradation::linear_from_d0(0.1, 1.5).unwrap(), 10_000);
        refused(
            NetworkWalk { runs: 3, ..plan.clone() },
            "runs = 3 is not allowed; a whole number from 1 to 2",
        );
        refused(NetworkWalk { n_base: 0, ..plan.clone() }, "n_base = 0");
        let huge = NetworkWalk { n_base: 1 << 60, engine: Engine::Particles, ..plan.clone() };
        refused(huge, "of memory, but");
        let tail = Gradation::from_lines(&[(0.3, 20.0), (0.4, 100.0)]).unwrap();
        refused(NetworkWalk { base: tail, ..plan.clone() }, "may not be passive");
        let stop = AtomicBool::new(true);
        let callbacks = Callbacks { stop: &stop, ..Callbacks::default() };
        let error = walk_networks(&networks, &plan, &callbacks).err().unwrap();
        assert_eq!(error.exit(), crate::run::Exit::Stopped);
    }
}
