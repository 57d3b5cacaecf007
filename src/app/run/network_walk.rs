//! Walks given networks without a scene, built by other programs or by hand, and their record.

use std::borrow::Cow;
use std::cmp::Ordering;
use std::sync::Arc;
use std::time::Instant;

use bitvec::slice::BitSlice;
use bitvec::vec::BitVec;
use rayon::slice::ParallelSliceMut;

use super::RunError;
use super::callbacks::{Callbacks, Event};
use super::machine::available_bytes;
use super::replicates::{ReplicateResult, map_side_by_side, said_by_walks, summarise};
use crate::case::{CaseError, PAPER_MASS_RATIO, base_record, replicate_seed};
use crate::outcome::left_out::LeftOut;
use crate::outcome::record::{GivenNetwork, NetworkWalkRecord, RunSummary, Statistic, Verdict};
use crate::outcome::{Modelled, Recorded, Recorder, RunId, RunMetrics, Wanted, leaves_out, verdict};
use crate::verdict::PlannedWalk;
use crate::words::memory::bytes;
use voidwalk_core::gradation::{Gradation, GradationError, SizeSampler, base_particles};
use voidwalk_core::network::Network;
use voidwalk_core::walk::{Engine, RunPlan, Sampling, SizeClasses, State, Walk, WalkControl};
use voidwalk_practice::rules::RuleInputs;
use voidwalk_practice::{Decision, Mistake, Note, ordered, rules};

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
            let finest_mm = f64::from(network.finest()) * network.unit_mm();
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
        let (needed, available) = (self.bytes(networks), available_bytes());
        if needed > available {
            return Err(CaseError::Memory {
                study: String::new(),
                n_base: self.n_base,
                voids: networks.iter().map(|network| network.voids() as u64).max().unwrap_or(0),
                needed: bytes(needed),
                available: bytes(available),
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
        let finest_mm = f64::from(network.finest()) * network.unit_mm();
        let coarser = 1.0 - self.base.percent_finer_by_number(finest_mm) / 100.0;
        (self.n_base as f64 * coarser) as u64
    }

    /// Plan of a run with these constrictions blocked.
    fn plan(&self, network: &Network, sampler: &SizeSampler, blocked: &BitSlice) -> RunPlan {
        RunPlan::new(self.engine, network, sampler, blocked, self.n_base / self.increments)
            .sampled(self.sampling)
    }

    /// Walks a replicate; also returns its blocked exits at the end of each run.
    fn replicate(
        &self,
        network: &Arc<Network>,
        sampler: &SizeSampler,
        replicate: u64,
        callbacks: &Callbacks,
    ) -> Result<(ReplicateResult, Vec<BitVec>), RunError> {
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
            recorded.append(Recorded::new(&end, &state, flow.as_ref(), &recorder, metrics.layers, run_id));
            below.push(metrics.below_threshold);
            runs.push(metrics.run);
            at_ends.push(state.blocked.clone());
            blocked = state.blocked;
            (callbacks.on_event)(Event::RunDone);
        }
        Ok((ReplicateResult::new(seed, runs, below, recorded, &first), at_ends))
    }
}

/// Steps of the curve of a network's diameters (percent).
const STEP: usize = 2;

impl NetworkOutcome {
    /// Record of these walks by a plan; `network` is the first of this many networks.
    pub fn record(&self, plan: &NetworkWalk, network: &Network, networks: usize) -> NetworkWalkRecord {
        let first = self.replicates.first().map(|walked| &walked.result);
        NetworkWalkRecord {
            verdict: self.verdict,
            notes: self.notes(plan, network, networks),
            seed: plan.seed,
            n_base: plan.n_base,
            n_base_eq2: plan.eq2(network, plan.mass_ratio).ok().flatten(),
            grains_per_void: plan.filter.as_ref().and_then(|filter| filter.grains_per_void),
            mass_ratio: plan.mass_ratio,
            increments: plan.increments,
            engine: first.map_or(plan.engine, |first| first.engine).name().into(),
            replicates: self.replicates.iter().map(|walked| walked.result.replicate.clone()).collect(),
            summary: self.summary.clone(),
            threshold: verdict::THRESHOLD,
            left_out: first
                .map_or(Vec::new(), |first| first.left_out.iter().copied().map(LeftOut::Walk).collect()),
            model_leaves_out: leaves_out(Modelled {
                flow: network.exit_rule().needs_flow(),
                ..Modelled::default()
            }),
            base: base_record(name_of_grading(&plan.base), &plan.base),
            d15f_mm: plan.d15f_mm(),
            network: given(network, networks),
            version: env!("CARGO_PKG_VERSION").into(),
        }
    }
}

/// Name of a base that has none.
fn name_of_grading(base: &Gradation) -> String {
    match base.cu().filter(|_| base.smallest_mm() < base.largest_mm()) {
        Some(cu) => format!("Cu {}", (cu * 1e3).round() / 1e3),
        None => "one size".into(),
    }
}

fn given(network: &Network, networks: usize) -> GivenNetwork {
    let passages = (0..network.constrictions()).filter(|&c| network.counts(c));
    let mut diameters: Vec<f32> = passages.map(|c| network.diameters()[c]).collect();
    let constrictions = diameters.len() as u64;
    diameters.retain(|&diameter| diameter > 0.0);
    diameters.par_sort_unstable_by(f32::total_cmp);
    // The minimum, the maximum, or the size at this percentile in between.
    let size = |percent: usize| {
        let at = (percent * diameters.len()).div_ceil(100).max(1) - 1;
        Some([f64::from(*diameters.get(at)?) * network.unit_mm(), percent as f64])
    };
    GivenNetwork {
        networks: networks as u64,
        exit: network.exit_rule().name().into(),
        voids: network.filter_voids() as u64,
        constrictions,
        layers: network.layers() as u64,
        diameters: (0..=100).step_by(STEP).filter_map(size).collect(),
    }
}

impl NetworkOutcome {
    /// Notes on the class; `network` is the first of this many networks.
    pub(crate) fn notes(&self, plan: &NetworkWalk, network: &Network, networks: usize) -> Vec<Note> {
        let walked = || self.replicates.iter().map(|walked| &walked.result);
        let layers = network.layers() as u64;
        let mut notes = said_by_walks(self.verdict, walked(), &plan.base, plan.increments, (layers, false));
        notes.extend(plan.notes(network, self.replicates.len() as u64));
        if networks == 1 && self.replicates.len() > 1 {
            notes.push(Note::OneNetwork {});
        }
        let rules = plan.filter.as_ref().map_or(Vec::new(), |filter| {
            let largest: Vec<f64> =
                walked().filter_map(|w| w.replicate.runs.first()?.largest_eroded_over_d15f).collect();
            rules::apply(&RuleInputs {
                filter_is_measured: filter.is_measured,
                largest_eroded_over_d15f: (!largest.is_empty()).then(|| Statistic::of(&largest).mean),
                ..RuleInputs::of_soils(&plan.base, &filter.gradation)
            })
        });
        ordered(Decision::new(&rules, None, None).notes().chain(notes))
    }
}

impl NetworkWalk {
    /// Notes on unchecked or unknown inputs, whatever the result of the walk.
    fn notes(&self, network: &Network, replicates: u64) -> Vec<Note> {
        let filter = self.filter.as_ref();
        let planned = PlannedWalk {
            base: &self.base,
            regraded_from: None,
            finest_constriction_mm: f64::from(network.finest()) * network.unit_mm(),
            filter: filter.map(|filter| &filter.gradation),
            filter_is_measured: filter.is_some_and(|filter| filter.is_measured),
            scale_free: false,
            given_voids: Some(network.filter_voids() as u64),
            lattice: network.shape(),
            layers: network.layers() as u64,
            flows: network.exit_rule().needs_flow(),
            increments: self.increments,
            replicates,
        };
        let mistake = filter.and_then(|filter| Mistake::find(&self.base, &filter.gradation, false));
        let mistake = mistake.map(|mistake| mistake.note);
        planned.notes().into_iter().chain(mistake).chain(self.amount(network)).collect()
    }

    /// Note on a number of base particles that differs from Eq. (2), or cannot be compared with it, if the
    /// class depends on it.
    fn amount(&self, network: &Network) -> Option<Note> {
        let particles = self.n_base;
        let Some(needed) = self.eq2(network, PAPER_MASS_RATIO).ok().flatten() else {
            return Some(Note::AmountUnknown { particles });
        };
        match particles.cmp(&needed) {
            Ordering::Less => Some(Note::FewParticles { particles, needed }),
            Ordering::Equal => None,
            Ordering::Greater => Some(Note::MoreParticles { particles, needed }),
        }
    }
}

#[cfg(test)]
mod tests;
