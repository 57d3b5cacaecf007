//! A pilot walk: the runs of a case on a slim lattice as deep as its own, which counts their work.
//!
//! The time of a run depends on its base: a filter that seals leaves the voids below empty, a base of one
//! size blocks the constrictions that would stop it and then walks to the end. A lattice a few voids wide
//! meets the same base per void and so does the same work per void, in a fraction of the time.

use std::ops::Range;
use std::sync::LazyLock;

use crate::case::{Case, CaseNetwork, replicate_seed};
use crate::outcome::Eroded;
use voidwalk_core::gradation::Gradation;
use voidwalk_core::network::Network;
use voidwalk_core::packing::{Settings, compress};
use voidwalk_core::store::platform::thread_seconds;
use voidwalk_core::walk::{Clogged, Passive, SizeClasses, State, Walk, WalkControl};

use super::machine::on_threads;
use super::replicates::plan;

/// Work of all runs of one replicate, for each void of its network.
#[derive(Clone, Debug, Default)]
pub(super) struct WorkByVoid {
    /// Voids that held counts, summed over the increments.
    pub occupied: f64,
    /// Voids that are looked at, in layers of which any held counts, summed likewise.
    pub looked_at: f64,
    /// Moves that were attempted by particles that are walked by themselves.
    pub moves: f64,
    /// Particles that are walked by themselves.
    pub one_by_one: f64,
    /// Eroded mass fraction of each run: a slim lattice erodes about as much.
    pub eroded: Vec<f64>,
    /// Voids that were walked.
    pub voids: f64,
    /// Processor time of their walk here (s); 0 if the system does not give it.
    pub took: f64,
}

/// Greatest width of the slim lattice: voids along x and y.
const WIDEST: u32 = 10;
/// Least width: narrower ones meet themselves.
const NARROWEST: u32 = 4;

/// Size classes of its records, which are not used.
const CLASSES: usize = 2;

/// Work of the runs of the case's first replicate, with `n_base` particles in all, on a slim lattice; `None`
/// if its own is as slim, if even the narrowest takes more than `most_s`, or if it cannot be walked. On its
/// own lattice these runs are guessed to take `whole_s`.
pub(super) fn pilot(case: &Case, n_base: u64, whole_s: f64, most_s: f64) -> Option<WorkByVoid> {
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

/// Pilot walk on a lattice this many voids wide and deep.
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
                for layer in 0..depth {
                    let held =
                        occupied(&state.passive, layer as usize * across..(layer as usize + 1) * across);
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
    Some(WorkByVoid {
        occupied: work.occupied / voids,
        looked_at: work.looked_at / voids,
        moves: work.moves / voids,
        one_by_one: work.one_by_one / voids,
        eroded: work.eroded,
        voids,
        took: thread_seconds() - begun - counting,
    })
}

/// Processor time of a small packing here, on one thread (s): the same grains and steps everywhere. Packed
/// once; 0 if the system does not give it.
pub(super) fn small_packing_seconds() -> f64 {
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

/// Number of these voids that hold counts.
fn occupied(passive: &Passive, voids: Range<usize>) -> usize {
    match passive {
        Passive::OneByOne => 0,
        Passive::Counts(counts) => counts[voids].iter().filter(|&&n| n > 0).count(),
        Passive::Expected(expected) => expected.moving[voids].iter().filter(|&&n| n > 0.0).count(),
    }
}
