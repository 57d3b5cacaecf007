//! Events that the chunks hand back, and their deterministic merge.
//!
//! Counts are added and blocked constrictions joined by OR, which no order can change. Masses are added
//! within a chunk in particle order and over chunks in chunk order.

use std::cell::RefCell;

use super::arches::{self, Jam};
use super::sizes::cube;
use super::{SizeClasses, SizeCounts, State};
use crate::network::Network;

thread_local! {
    /// Buffer for the eroded particles of the chunk that a thread works on.
    static ERODED: RefCell<Vec<f32>> = const { RefCell::new(Vec::new()) };
}

/// Events of one chunk in one increment.
#[derive(Default)]
pub(super) struct Events {
    /// Particles that the chunk received.
    pub inserted: u32,
    /// Their mass.
    pub inserted_mass: f64,
    /// Completed moves.
    pub moves: u64,
    /// Diameters of the particles that left, in particle order; summed up and gone once the chunk is done.
    pub eroded: Vec<f32>,
    eroded_count: u64,
    /// Constriction and diameter of the particles that were stopped, in particle order.
    pub stopped: Vec<(u32, f32)>,
    /// Particles that jammed, in particle order; they are not among those stopped or those that still move.
    pub jams: Vec<Jam>,
    /// Void and diameter of the particles without open exit, in particle order.
    pub stranded: Vec<(u32, f32)>,
    /// Particles that wait for the flow to find another way.
    pub waiting: u64,
    /// Passive particles among those received.
    pub passive_inserted: u32,
    passive_eroded: u64,
    sizes: Option<[SizeCounts; 2]>,
    eroded_mass: f64,
    largest: f32,
}

impl Events {
    /// Forgets the last increment, but keeps the memory.
    pub fn clear(&mut self) {
        self.inserted = 0;
        self.inserted_mass = 0.0;
        self.passive_inserted = 0;
        self.moves = 0;
        self.waiting = 0;
        self.eroded_count = 0;
        self.stopped.clear();
        self.stranded.clear();
    }

    /// Takes the buffer that this thread used before, with room for `count` eroded particles.
    pub fn lend_buffer(&mut self, count: usize) {
        self.eroded = ERODED.take();
        self.eroded.clear();
        self.eroded.reserve(count);
    }

    /// Sums over the chunk, and gives the buffer back; called where the chunk was worked on.
    pub fn sum(&mut self, classes: &SizeClasses, passive_limit: f32) {
        self.eroded_count = self.eroded.len() as u64;
        self.passive_eroded = self.eroded.iter().map(|&d| u64::from(d <= passive_limit)).sum();
        self.eroded_mass = self.eroded.iter().map(|&d| cube(d)).sum();
        self.largest = self.eroded.iter().fold(0.0, |largest, &d| if d > largest { d } else { largest });
        if !self.is_quiet() {
            self.sum_sizes(classes);
        }
        ERODED.set(std::mem::take(&mut self.eroded));
    }

    fn sum_sizes(&mut self, classes: &SizeClasses) {
        let new = || [SizeCounts::new(classes), SizeCounts::new(classes)];
        let any_retained = self.retained_count() > 0;
        let [eroded, retained] = self.sizes.get_or_insert_with(new);
        if self.eroded_count > 0 {
            eroded.clear();
            self.eroded.iter().for_each(|&d| eroded.add(classes, d));
        }
        if any_retained {
            retained.clear();
            self.stopped.iter().chain(&self.stranded).for_each(|&(_, d)| retained.add(classes, d));
        }
    }

    fn is_quiet(&self) -> bool {
        self.eroded_count == 0 && self.retained_count() == 0
    }

    fn retained_count(&self) -> usize {
        self.stopped.len() + self.stranded.len()
    }
}

/// Adds the events of all chunks to the state; returns the constrictions that have just closed, or whose
/// openings have just been narrowed, ascending, each as one of its exits.
pub(super) fn merge(
    network: &Network,
    events: &mut [Events],
    upstream: &[u32],
    state: &mut State,
) -> Vec<u32> {
    let (narrowed_before, blocked_before) = (state.changes(), state.history.len());
    for events in events.iter_mut() {
        let tally = &mut state.tally;
        tally.inserted += u64::from(events.inserted);
        tally.moving += u64::from(events.inserted);
        tally.inserted_mass += events.inserted_mass;
        tally.passive_inserted += u64::from(events.passive_inserted);
        tally.particle_moves = tally.particle_moves.saturating_add(events.moves);
        if !events.is_quiet() {
            let gone = [events.eroded_count, events.stopped.len() as u64, events.stranded.len() as u64];
            tally.eroded += gone[0];
            tally.retained_in_constrictions += gone[1];
            tally.retained_in_voids += gone[2];
            tally.moving -= gone.iter().sum::<u64>();
            tally.passive_eroded += events.passive_eroded;
            tally.eroded_mass += events.eroded_mass;
            tally.largest_eroded = tally.largest_eroded.max(events.largest);
            if let Some([eroded, retained]) = &events.sizes {
                if events.eroded_count > 0 {
                    state.eroded_sizes.merge(eroded);
                }
                if events.retained_count() > 0 {
                    state.retained_sizes.merge(retained);
                }
            }
            for &(constriction, diameter) in &events.stopped {
                state.stop(network, upstream, constriction as usize, diameter);
            }
            for &(void, diameter) in &events.stranded {
                state.retained_in_voids[void as usize] += 1;
                if let Some(cubes) = state.retained_cubes.get_mut(void as usize) {
                    *cubes += cube(diameter);
                }
            }
        }
        events.clear();
    }
    arches::settle(network, events.iter_mut().map(|events| &mut events.jams), upstream, state);
    let closed = &mut state.history[blocked_before..];
    closed.sort_unstable_by_key(|blocking| blocking.constriction);
    state.tally.blocked += closed.len() as u64;
    match &mut state.openings {
        Some(openings) => openings.end_increment(state.increment, narrowed_before),
        None => closed.iter().map(|blocking| blocking.constriction).collect(),
    }
}
