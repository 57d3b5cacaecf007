//! Walks the replicates of a case, each with a new network.

use std::borrow::Cow;
use std::ops::RangeInclusive;
use std::time::Instant;

use bitvec::slice::BitSlice;
use bitvec::vec::BitVec;
use rayon::prelude::*;

use super::RunError;
use super::callbacks::{Callbacks, Event};
use super::checkpoints::{Checkpoints, Done, WalkId};
use super::shared_networks::{NetworkToWalk, SharedNetworks};
use crate::case::{Case, replicate_seed};
use crate::outcome::early_stop::{FEWEST_OF_RANGE, FEWEST_OWN, clear, looks};
use crate::outcome::record::{Classed, Replicate, Run, RunSummary, Statistic, Stopping, Verdict};
use crate::outcome::stopping::{Look, ReplicateValues};
use crate::outcome::verdict::{THRESHOLD, below_by_interval, classify};
use crate::outcome::{Recorded, RunId, RunMetrics};
use crate::scene::NetworkSource;
use crate::verdict::walks::{self, Walked, is_clogged};
use voidwalk_core::gradation::Gradation;
use voidwalk_core::network::{Network, NetworkError};
use voidwalk_core::store::checkpoint::Checkpoint;
use voidwalk_core::walk::{
    Clogged, Engine, RunPlan, Shortcut, SizeClasses, State, Supply, Walk, WalkControl, WalkError, from_words,
};
use voidwalk_practice::Note;

/// Callbacks, checkpoints and shared networks for walking replicates.
#[derive(Clone, Copy)]
pub(crate) struct ReplicateContext<'a> {
    /// Follow the walks and stop them.
    pub(crate) callbacks: &'a Callbacks<'a>,
    /// Save finished work for the next start; without them nothing is saved.
    pub(crate) checkpoints: Option<&'a Checkpoints>,
    /// Networks shared with other cases; without them each replicate builds its own.
    pub(crate) networks: Option<&'a SharedNetworks>,
}

impl ReplicateContext<'_> {
    pub(super) fn tell(&self, event: Event) {
        (self.callbacks.on_event)(event);
    }

    fn network(&self, case: &Case, seed: u64) -> Result<NetworkToWalk, NetworkError> {
        match self.networks {
            Some(shared) => shared.get(case, seed),
            None => case.network(seed).map(NetworkToWalk::own),
        }
    }
}

/// One replicate: its figures, and its rows of the CSV files.
pub struct ReplicateResult {
    pub replicate: Replicate,
    pub recorded: Recorded,
    /// The engine that walked the first run.
    pub(crate) engine: Engine,
    /// Shortcuts that the first run took.
    pub(crate) left_out: Vec<Shortcut>,
    /// True, by run, if less than 7.5 % of the mass eroded.
    pub(super) below: Vec<bool>,
}

impl ReplicateResult {
    /// Replicate with these runs; `first` is the plan of its first run.
    pub(super) fn new(
        seed: u64,
        runs: Vec<Run>,
        below: Vec<bool>,
        recorded: Recorded,
        first: &RunPlan,
    ) -> Self {
        let verdict = classify(below.first().copied(), below.get(1).copied());
        Self {
            replicate: Replicate { seed, verdict, runs },
            recorded,
            engine: first.engine(),
            left_out: first.left_out().to_vec(),
            below,
        }
    }
}

/// Walks every replicate of the case: the number in the scene, or until its rule stops. Errors: a walk that
/// loses particles or was stopped.
pub(super) fn replicates(case: &Case, context: &ReplicateContext) -> Result<Vec<ReplicateResult>, RunError> {
    let (runs, readings) = (case.scene.walk.runs, !case.filter.curve_ends.is_empty());
    let tell_needs = |replicates| context.tell(Event::VerdictNeeds { replicates, runs, readings });
    let (mut wanted, mut walked) = (first_replicates(case), Vec::new());
    tell_needs(wanted);
    loop {
        let more = walked.len() as u64 + 1..=wanted;
        walked.extend(some_replicates(case, 0, more, case.supply.n_base, context)?);
        let Some(Look::Until(next)) = look(case, &walked) else { return Ok(walked) };
        context.tell(Event::MoreRuns { runs: (next - wanted) * runs });
        wanted = next;
        tell_needs(wanted);
    }
}

/// Result of the scene's stopping rule, if it has one.
pub(super) fn stopping(case: &Case, walked: &[ReplicateResult]) -> Option<Stopping> {
    match look(case, walked)? {
        Look::Stop(stopping) => Some(stopping),
        Look::Until(_) => None,
    }
}

/// Evaluation of the scene's rule on the walked replicates.
fn look(case: &Case, walked: &[ReplicateResult]) -> Option<Look> {
    let rule = Some(&case.scene.stop).filter(|rule| rule.is_set())?;
    Some(rule.look_at_one_of(case.curves(), case.scene.walk.replicates, &values_by_run(walked)))
}

/// Eroded mass of each run by replicate, and true if it is below the threshold.
pub(super) fn values_by_run(walked: &[ReplicateResult]) -> Vec<ReplicateValues> {
    let runs = walked.first().map_or(0, |w| w.below.len());
    let of_run = |run: usize| {
        walked.iter().map(|w| (w.replicate.runs[run].eroded_mass_fraction, w.below[run])).collect()
    };
    (0..runs).map(of_run).collect()
}

/// Walks replicates with `n_base` particles each. Only those of part 0, the case itself, are recorded.
pub(super) fn some_replicates(
    case: &Case,
    part: u64,
    replicates: RangeInclusive<u64>,
    n_base: u64,
    context: &ReplicateContext,
) -> Result<Vec<ReplicateResult>, RunError> {
    let one = |replicate| walk_replicate(case, part, replicate, n_base, context);
    map_side_by_side(replicates.collect(), fit_side_by_side(case, n_base), one)
}

/// True if walks of the case with this many particles fit into memory side by side.
pub(super) fn fit_side_by_side(case: &Case, n_base: u64) -> bool {
    case.side_by_side(n_base, rayon::current_num_threads() as u64) > 1
}

/// Applies `one` to each item, side by side if their walks fit into memory together.
pub(super) fn map_side_by_side<T: Send, R: Send>(
    all: Vec<T>,
    fit: bool,
    one: impl Fn(T) -> Result<R, RunError> + Sync + Send,
) -> Result<Vec<R>, RunError> {
    if fit { all.into_par_iter().map(one).collect() } else { all.into_iter().map(one).collect() }
}

/// Walks one replicate with `n_base` particles, or loads it from its checkpoint.
pub(super) fn walk_replicate(
    case: &Case,
    part: u64,
    replicate: u64,
    n_base: u64,
    context: &ReplicateContext,
) -> Result<ReplicateResult, RunError> {
    go_on(context.callbacks)?;
    let seed = replicate_seed(case.scene.walk.seed, replicate);
    let id = WalkId { part, replicate, seed, n_base };
    let to_walk = context.network(case, seed)?;
    let network = &to_walk.network;
    let mut clogged = Clogged::none(network);
    let first = plan(case, network, &clogged.blocked, n_base);
    let (mut done, mut saved) = load(id, context)?;
    let mut exits = if done.complete { None } else { to_walk.exits(case).map(Cow::Borrowed) };
    let mut wanted = case.scene.record.wanted();
    // Voids are recorded for one replicate only.
    wanted.voids = wanted.voids.filter(|_| replicate == 1);
    while !done.complete {
        let (begun, run) = (Instant::now(), done.runs.len() as u64 + 1);
        let (supply, mut state) = begin(case, network, id, run, clogged, saved.take())?;
        let mut walk = Walk::with_exits(network, &supply, &state, exits.take());
        let (mut last, mut failed) = (Instant::now(), None);
        let walked = walk.run(&mut state, &mut |state| {
            if part == 0 {
                done.recorder.observe(&wanted, state);
            }
            let (increment, moving) = (state.increment, state.tally.moving);
            context.tell(Event::Increment { replicate, run, increment, moving });
            let stop = context.callbacks.is_stopped();
            let due = |checkpoints: &&Checkpoints| checkpoints.is_due(last, increment, stop);
            if let Some(checkpoints) = context.checkpoints.filter(due) {
                if let Err(error) = checkpoints.save_walk(id, network, state, &done) {
                    failed = Some(error);
                    return WalkControl::Stop;
                }
                last = Instant::now();
            }
            if stop { WalkControl::Stop } else { WalkControl::Continue }
        });
        if let Some(error) = failed {
            return Err(RunError::Save(error));
        }
        walked?;
        let (end, flow, left) = walk.end(&state)?;
        let d15f_mm = case.filter.gradation.d(15.0).unwrap_or(f64::NAN);
        let run_id = RunId { replicate, run, d15f_mm, pan_fraction: case.pan_by_mass_only() };
        let metrics = RunMetrics::new(&end, &state, flow.as_ref(), run_id, begun.elapsed().as_secs_f64());
        let recorder = std::mem::take(&mut done.recorder);
        if part == 0 {
            done.recorded.append(Recorded::new(
                &end,
                &state,
                flow.as_ref(),
                &recorder,
                metrics.layers,
                run_id,
            ));
        }
        context.tell(Event::RunDone);
        tell_walked(id, &metrics.run, metrics.below_threshold, context);
        done.below.push(metrics.below_threshold);
        done.runs.push(metrics.run);
        done.complete = run == case.scene.walk.runs;
        if let (true, Some(checkpoints)) = (done.complete, context.checkpoints) {
            checkpoints.save_finished(id, done.clone());
        }
        // The next run begins with the open constrictions of this run.
        (clogged, exits) = (state.into_clogged(), left.map(Cow::Owned));
    }
    Ok(ReplicateResult::new(seed, done.runs, done.below, done.recorded, &first))
}

/// Supply of a run, and its state at the start or in the checkpoint.
fn begin(
    case: &Case,
    network: &Network,
    WalkId { seed, n_base, .. }: WalkId,
    run: u64,
    clogged: Clogged,
    saved: Option<Checkpoint>,
) -> Result<(Supply, State), RunError> {
    let clogged = match &saved {
        // The state holds the open constrictions from here on.
        Some(saved) if run > 1 => blocked_at_start(network, saved)?.into(),
        _ => clogged,
    };
    let (plan, sampler) = (plan(case, network, &clogged.blocked, n_base), &case.supply.sampler);
    let supply = plan.supply(sampler.clone(), n_base, case.increments(), seed, run);
    let classes = case.scene.record.size_classes as usize;
    let classes = SizeClasses::logarithmic(sampler.smallest(), sampler.largest(), classes);
    let state = State::placed(&case.placement, network, &supply, classes, clogged, seed, run);
    let mut state = state.map_err(|source| RunError::Room { particles: supply.total(), source })?;
    if let Some(saved) = saved {
        if saved.label.network != network.fingerprint() {
            return Err(saved.of_another_network().into());
        }
        state.restore(network, &supply, &saved)?;
    }
    Ok((supply, state))
}

/// Finished runs of a replicate, and the checkpoint of the current run; reports a finished replicate.
fn load(id: WalkId, context: &ReplicateContext) -> Result<(Done, Option<Checkpoint>), RunError> {
    let loaded = context.checkpoints.map(|checkpoints| checkpoints.load(id));
    let Some(Some((done, saved))) = loaded.transpose()? else {
        return Ok((Done::default(), None));
    };
    if done.complete {
        done.runs.iter().for_each(|_| context.tell(Event::RunDone));
        done.runs.iter().zip(&done.below).for_each(|(run, below)| tell_walked(id, run, *below, context));
    }
    Ok((done, Some(saved)))
}

/// Fails if the caller asked to stop before a replicate has begun.
fn go_on(callbacks: &Callbacks) -> Result<(), RunError> {
    if callbacks.is_stopped() { Err(WalkError::Stopped { increment: 0 }.into()) } else { Ok(()) }
}

/// Reports the result of a run, if it is one of the case itself.
fn tell_walked(id: WalkId, run: &Run, below_threshold: bool, context: &ReplicateContext) {
    let (replicate, run, eroded_mass_fraction) = (id.replicate, run.run, run.eroded_mass_fraction);
    if id.part == 0 {
        context.tell(Event::RunWalked { replicate, run, eroded_mass_fraction, below_threshold });
    }
}

/// Plan of a run with these constrictions blocked.
pub(crate) fn plan(case: &Case, network: &Network, blocked: &BitSlice, n_base: u64) -> RunPlan {
    let (engine, share) = (case.scene.walk.engine, n_base / case.increments());
    let clogging = (case.arching(), case.scene.leaves_openings());
    RunPlan::with_clogging(engine, network, &case.supply.sampler, blocked, share, clogging)
        .sampled(case.scene.walk.sampling)
}

/// Shortcuts of the first run of the first replicate. Errors: see [`Case::network`].
pub(super) fn left_out_of_first_run(case: &Case) -> Result<Vec<Shortcut>, RunError> {
    let network = case.network(replicate_seed(case.scene.walk.seed, 1))?;
    let open: BitVec = BitVec::repeat(false, network.constrictions());
    Ok(plan(case, &network, &open, case.supply.n_base).left_out().to_vec())
}

/// Checks that every replicate that will be walked for certain has a network. A network with a distribution
/// of connectivity is searched for at random, and the search may fail for single replicates. Errors: a
/// replicate without a network; a stop.
pub(crate) fn have_networks(case: &Case, callbacks: &Callbacks) -> Result<(), RunError> {
    if !matches!(case.scene.network.source(), NetworkSource::Connected(..)) {
        return Ok(());
    }
    let one = |replicate| {
        go_on(callbacks)?;
        let network = case.network(replicate_seed(case.scene.walk.seed, replicate));
        network.map(drop).map_err(|error| RunError::Refused(format!("replicate {replicate}: {error}")))
    };
    let replicates = 1..=first_replicates(case).max(case.scene.record.sensitivity_replicates);
    map_side_by_side(replicates.collect(), fit_side_by_side(case, case.supply.n_base), one).map(drop)
}

/// Constrictions that were blocked when the saved run began: those blocked now without those that the run
/// itself has blocked.
fn blocked_at_start(network: &Network, saved: &Checkpoint) -> Result<BitVec, RunError> {
    let mut blocked = from_words(&saved.read("blocked")?, network.constrictions());
    for constriction in saved.read::<u32>("history_constriction")? {
        if (constriction as usize) < blocked.len() {
            network.set_blocked(&mut blocked, constriction as usize, false);
        }
    }
    Ok(blocked)
}

/// Notes on behaviour of the walks that the verdict does not show; the base came in this many increments
/// through this many layers, with openings or without.
pub(super) fn said_by_walks<'a>(
    verdict: Verdict,
    walked: impl IntoIterator<Item = &'a ReplicateResult, IntoIter: Clone>,
    base: &Gradation,
    increments: u64,
    (layers, openings): (u64, bool),
) -> Vec<Note> {
    let walked = walked.into_iter();
    let mut clogged: Vec<[u64; 3]> = Vec::new();
    let is_none = |k_over_k0| is_clogged(k_over_k0, openings);
    for row in walked.clone().flat_map(|w| &w.recorded.flow).filter(|row| is_none(row.k_over_k0)) {
        // The first row of its run.
        if clogged.last().is_none_or(|last| last[..2] != [row.replicate, row.run]) {
            clogged.push([row.replicate, row.run, row.increment]);
        }
    }
    let replicates = walked.map(|w| &w.replicate).collect();
    let share = 1.0 / increments as f64;
    walks::notes(verdict, &Walked { replicates, clogged, base, share, layers, openings })
}

/// Number of runs walked for a case: its own, those of the ends of its curve's range, and those of its
/// studies, as far as known before the walk.
pub(crate) fn runs_to_walk(case: &Case) -> u64 {
    let first = first_replicates(case);
    let of_ends = replicates_of_end(first) * case.filter.curve_ends.len() as u64;
    let points = (case.sensitivity_factors().len() + case.thickness_factors().len()) as u64;
    case.scene.walk.runs * (first + of_ends + points * replicates_at_least(case))
}

/// Replicates of a case, as far as known before it is walked.
pub(super) fn first_replicates(case: &Case) -> u64 {
    let (rule, replicates) = (&case.scene.stop, case.scene.walk.replicates);
    if rule.is_set() { rule.replicates_at(replicates, 1) } else { replicates }
}

/// Minimum number of replicates of an end of the curve's range, for this many of the case.
pub(super) fn replicates_of_end(of_case: u64) -> u64 {
    if of_case >= FEWEST_OF_RANGE as u64 { 1 } else { of_case }
}

/// Minimum number of replicates of each point, as far as known before the case is walked.
pub(super) fn replicates_at_least(case: &Case) -> u64 {
    let most = case.scene.record.sensitivity_replicates;
    if first_replicates(case) >= FEWEST_OWN as u64 { most.min(1) } else { most }
}

/// Assumed relative scatter of replicates before any walk: the value of the built-in scene.
const LIKELY_SCATTER: f64 = 0.05;

/// Number of replicates of a point that will probably be walked, given the eroded mass of each run in a
/// replicate of the case and in one of the point; all of them if that is unknown.
pub(super) fn likely_replicates(case: &Case, eroded: Option<(&[f64], &[f64])>) -> u64 {
    let most = case.scene.record.sensitivity_replicates;
    let Some((of_case, point)) = eroded else { return most };
    let several = |values: &[f64], replicates: u64| -> Vec<ReplicateValues> {
        let about = |&value: &f64| {
            let sign = |k: u64| if k.is_multiple_of(2) { -LIKELY_SCATTER } else { LIKELY_SCATTER };
            (0..replicates).map(|k| value * (1.0 + sign(k))).map(|v| (v, v < THRESHOLD)).collect()
        };
        values.iter().map(about).collect()
    };
    let below = |run: usize| of_case.get(run).map(|&eroded| eroded < THRESHOLD);
    let class = classify(below(0), below(1));
    let replicates = first_replicates(case);
    let of_case = several(of_case, replicates);
    let is_clear = |&look: &u64| clear(&of_case, class, &several(point, look)).is_some();
    let looks = looks(class, replicates as usize, most);
    looks.into_iter().find(is_clear).map_or(most, |look| look.min(most))
}

/// Verdict that all replicates together support, and their statistics by run.
pub(super) fn summarise(walked: &[ReplicateResult]) -> (Verdict, Vec<RunSummary>) {
    let runs = walked.first().map_or(0, |w| w.replicate.runs.len());
    let summaries: Vec<RunSummary> = (0..runs).map(|run| run_summary(walked, run)).collect();
    let below = |run: usize| {
        let summary = summaries.get(run)?;
        let below_by_replicate: Vec<bool> = walked.iter().map(|w| w.below[run]).collect();
        below_by_interval(&summary.eroded_mass_fraction, &below_by_replicate)
    };
    (classify(below(0), below(1)), summaries)
}

/// Class and statistics of the replicates, in the form that a point of a study holds.
pub(super) fn classed(walked: &[ReplicateResult]) -> Classed {
    let (verdict, summaries) = summarise(walked);
    let runs = summaries.iter().map(|run| run.eroded_mass_fraction).collect();
    Classed { replicates: walked.len() as u64, stopped_when_clear: false, verdict, runs }
}

fn run_summary(walked: &[ReplicateResult], run: usize) -> RunSummary {
    let statistic = |figure: fn(&Run) -> f64| {
        let values: Vec<f64> = walked.iter().map(|w| figure(&w.replicate.runs[run])).collect();
        Statistic::of_fraction(&values)
    };
    let largest: Vec<f64> =
        walked.iter().filter_map(|w| w.replicate.runs[run].largest_eroded_over_d15f).collect();
    RunSummary {
        run: run as u64 + 1,
        eroded_mass_fraction: statistic(|r| r.eroded_mass_fraction),
        eroded_number_fraction: statistic(|r| r.eroded_number_fraction),
        largest_eroded_over_d15f: (!largest.is_empty()).then(|| Statistic::of(&largest)),
        blocked_fraction: statistic(|r| r.blocked_fraction),
        blocked_first_three_layers_fraction: statistic(|r| r.blocked_first_three_layers_fraction),
        backbone_fraction: statistic(|r| r.backbone_fraction),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::run::case_of;

    /// Figures and rows of a replicate, without times.
    fn walked(case: &Case, networks: Option<&SharedNetworks>) -> String {
        let context = ReplicateContext { callbacks: &Callbacks::default(), checkpoints: None, networks };
        let mut walked = walk_replicate(case, 0, 1, case.supply.n_base, &context).unwrap();
        walked.replicate.runs.iter_mut().for_each(|run| run.seconds = 0.0);
        assert_eq!(walked.replicate.runs.len(), 2);
        format!("{:?} {:?}", walked.replicate, walked.recorded)
    }

    /// Gives the same bits without kept exits, with exits that the case has just computed, and with those of
    /// another case.
    #[test]
    fn a_replicate_is_the_same_whichever_case_has_left_its_network() {
        let small = ["network.nx=6", "network.ny=6", "network.nz=8"];
        for engine in ["engine=counts", "engine=expected"] {
            let case = |more: &[&str]| case_of(&[&small[..], &[engine], more].concat());
            let (before, other) = (case(&["base.cu=3", "replicates=1"]), case(&["base.n_base=30000"]));
            let (shared, seed) = (SharedNetworks::new(1 << 27), replicate_seed(other.scene.walk.seed, 1));
            let exits_of = |case: &Case| {
                let network = shared.get(case, seed).unwrap();
                network.exits(case).map(|exits| std::ptr::from_ref(exits) as usize).unwrap()
            };
            walked(&before, Some(&shared));
            let left = exits_of(&before);
            let alone = walked(&other, None);
            assert_eq!(walked(&other, Some(&shared)), alone, "{engine}: left by another");
            assert_eq!(exits_of(&other), left);
            assert_eq!(walked(&other, Some(&SharedNetworks::new(1 << 27))), alone, "{engine}: its own");
            assert_eq!(walked(&other, Some(&SharedNetworks::new(0))), alone, "{engine}: no room");
        }
    }
}
