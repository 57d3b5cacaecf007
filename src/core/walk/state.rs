//! State of a run: columns, independent of the engine.

use super::openings::Ways;
use super::supply::passive_limit;
use super::tally::cube;
use super::{Clogged, Openings, Passive, SizeClasses, SizeCounts, Supply, Tally};
use crate::network::Network;
use crate::store::{Column, Placement};
use crate::stream::{Key, Purpose};
use bitvec::vec::BitVec;
use std::io;

/// Base particles of one chunk: 128 KiB of columns, so that a chunk stays in the second-level cache of a
/// core during its step. Part of the definition of every random stream: changing it changes results.
pub const CHUNK: usize = 1 << 14;

/// Constriction blocked by a base particle, and the increment.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Blocking {
    /// Increment in which a particle stopped; the constriction is closed from the next one on.
    pub increment: u64,
    /// Number of the constriction.
    pub constriction: u32,
}

/// Moving base particles as columns. Chunk `c` holds its `live[c]` particles, in order of insertion, in
/// entries `c * CHUNK ..` of each column. If all have one size, the diameter column holds a single chunk.
#[derive(Debug)]
pub struct Particles {
    /// Void that contains the particle.
    pub void: Column<u32>,
    /// Diameter, in units of the network's reference length.
    pub diameter: Column<f32>,
    /// Number of moving particles by chunk.
    pub live: Vec<u32>,
}

impl Particles {
    /// Void and diameter of the moving particles of one chunk.
    pub fn chunk(&self, chunk: usize) -> (&[u32], &[f32]) {
        let live = self.live[chunk] as usize;
        let sizes = if self.has_one_size() { 0 } else { chunk * CHUNK };
        (&self.void[chunk * CHUNK..][..live], &self.diameter[sizes..][..live])
    }

    /// Puts particles (rank, void, diameter) back into a chunk, each after as many of its particles as its
    /// rank; ranks ascend.
    pub(super) fn put_back(&mut self, chunk: usize, back: &[(usize, u32, f32)]) {
        let first = chunk * CHUNK;
        let mut end = first + self.live[chunk] as usize;
        self.live[chunk] += back.len() as u32;
        let one_size = self.has_one_size();
        // Starts with the last: particles after it move up by the number put back before them.
        for (before, &(rank, void, diameter)) in back.iter().enumerate().rev() {
            let at = first + rank;
            self.void.copy_within(at..end, at + before + 1);
            self.void[at + before] = void;
            if !one_size {
                self.diameter.copy_within(at..end, at + before + 1);
                self.diameter[at + before] = diameter;
            }
            end = at;
        }
    }

    /// Tells if the column of diameters holds a single chunk for all.
    pub(super) fn has_one_size(&self) -> bool {
        self.diameter.len() < self.void.len()
    }
}

/// Complete state of a run after a whole increment; enough to continue the walk.
#[derive(Debug)]
pub struct State {
    /// Seed of the replicate.
    pub(crate) seed: u64,
    /// Run, counted from 1.
    pub run: u64,
    /// Last completed increment, counted from 1; 0 before the first.
    pub increment: u64,
    /// True if the run has ended.
    pub finished: bool,
    /// Size of the finest open constriction at the start of the run, or less if particles arch. Particles
    /// up to this diameter are *passive*: no constriction can stop them in this run.
    pub(crate) passive_limit: f32,
    /// Moving base particles that are walked one by one.
    pub particles: Particles,
    /// Moving base particles that are not walked one by one.
    pub passive: Passive,
    /// Bit `c`: a base particle has blocked constriction `c` (in this run or an earlier one).
    pub blocked: BitVec,
    /// Openings left by blocked constrictions; `None` if they are closed.
    pub openings: Option<Openings>,
    /// Constrictions blocked in this run, by increment, then by constriction.
    pub history: Vec<Blocking>,
    /// Number of base particles retained in the exits of each void.
    pub retained_in_constrictions: Vec<u64>,
    /// Number of base particles retained in each void because it has no open exit.
    pub retained_in_voids: Vec<u64>,
    /// Sum of the diameters cubed of the particles retained in each void and its exits; empty if volumes
    /// of voids are unknown.
    pub retained_cubes: Vec<f64>,
    /// Sums over the run.
    pub tally: Tally,
    /// Bounds of the size classes.
    pub classes: SizeClasses,
    /// Number and mass of eroded particles by size class.
    pub eroded_sizes: SizeCounts,
    /// Number and mass of retained particles by size class.
    pub retained_sizes: SizeCounts,
}

impl State {
    /// Creates the state before the first increment of run `run`, with the constrictions of `clogged`.
    pub fn new(
        network: &Network,
        supply: &Supply,
        classes: SizeClasses,
        clogged: impl Into<Clogged>,
        seed: u64,
        run: u64,
    ) -> Self {
        let state = Self::placed(&Placement::Memory, network, supply, classes, clogged, seed, run);
        state.expect("columns in memory need no file")
    }

    /// Works like [`State::new`], with the particle columns in `placement`; results are the same to the bit.
    ///
    /// # Errors
    /// Files for the columns that cannot be created or allocated.
    pub fn placed(
        placement: &Placement,
        network: &Network,
        supply: &Supply,
        classes: SizeClasses,
        clogged: impl Into<Clogged>,
        seed: u64,
        run: u64,
    ) -> io::Result<Self> {
        let clogged = clogged.into();
        let openings = supply.leaves_openings().then(|| Openings::new(network, &clogged));
        let blocked = clogged.blocked;
        assert_eq!(blocked.len(), network.constrictions(), "one bit a constriction");
        let finest = network.finest_open(|c| blocked[c]);
        let chunks = (supply.total() as usize).div_ceil(CHUNK);
        let tally = Tally { blocked: network.blocked_count(&blocked), ..Tally::default() };
        let diameter = match supply.single_size() {
            Some(size) => {
                let mut sizes = Column::zeroed(chunks.min(1) * CHUNK, &Placement::Memory)?;
                sizes.fill(size);
                sizes
            }
            None => Column::zeroed(chunks * CHUNK, placement)?,
        };
        Ok(Self {
            seed,
            run,
            increment: 0,
            finished: false,
            passive_limit: passive_limit(supply.arching(), supply.leaves_openings(), finest),
            particles: Particles {
                void: Column::zeroed(chunks * CHUNK, placement)?,
                diameter,
                live: vec![0; chunks],
            },
            passive: supply.no_passive_yet(network.voids()),
            blocked,
            openings,
            history: Vec::new(),
            retained_in_constrictions: vec![0; network.voids()],
            retained_in_voids: vec![0; network.voids()],
            retained_cubes: vec![0.0; if network.volumes().is_empty() { 0 } else { network.voids() }],
            tally,
            eroded_sizes: SizeCounts::new(&classes),
            retained_sizes: SizeCounts::new(&classes),
            classes,
        })
    }

    /// Tells if base particles cannot use constriction `c`: it is blocked without an opening, has size 0,
    /// or is not an exit by the rule that sets directions.
    #[inline(always)]
    pub fn is_closed(&self, network: &Network, c: usize) -> bool {
        let is_shut = match &self.openings {
            None => self.blocked[c],
            Some(openings) => openings.widths[c] == 0.0,
        };
        is_shut || network.diameters()[c] == 0.0 || network.exit_weight(c) == 0.0
    }

    /// Key of the streams of this increment, for the first chunk.
    pub(super) fn key(&self, purpose: Purpose) -> Key {
        Key { seed: self.seed, purpose, run: self.run, increment: self.increment, chunk: 0 }
    }

    /// Open exits, with the widths to which their weights refer.
    pub(super) fn ways<'a>(&'a self, weighed: Option<&'a [f32]>) -> Ways<'a> {
        match &self.openings {
            None => Ways::Unblocked(&self.blocked),
            Some(openings) => Ways::Openings(&openings.widths, weighed),
        }
    }

    /// Current width of the constriction of an exit.
    #[inline]
    pub(crate) fn width(&self, network: &Network, exit: usize) -> f32 {
        self.openings.as_ref().map_or(network.diameters()[exit], |openings| openings.widths[exit])
    }

    /// Number of blockings in this run (narrowings, with openings); it never decreases.
    pub(super) fn changes(&self) -> usize {
        self.openings.as_ref().map_or(self.history.len(), |openings| openings.history.len())
    }

    /// Stops a particle of this size in an exit and blocks or narrows its constriction; `upstream` lists
    /// the void of each exit.
    pub(super) fn stop(&mut self, network: &Network, upstream: &[u32], exit: usize, diameter: f32) {
        let void = upstream[exit] as usize;
        self.retained_in_constrictions[void] += 1;
        self.retain_cubes(void, cube(diameter));
        if !self.blocked[exit] {
            self.history.push(Blocking { increment: self.increment, constriction: exit as u32 });
            network.set_blocked(&mut self.blocked, exit, true);
        }
        if let Some(openings) = &mut self.openings {
            openings.stop(network, exit, diameter);
        }
    }

    /// Adds diameters cubed of retained particles to a void, if volumes are known.
    pub(super) fn retain_cubes(&mut self, void: usize, cubes: f64) {
        if let Some(sum) = self.retained_cubes.get_mut(void) {
            *sum += cubes;
        }
    }

    /// Returns the constrictions for the next run.
    pub fn into_clogged(self) -> Clogged {
        Clogged {
            blocked: self.blocked,
            widths: self.openings.map_or(Vec::new(), |openings| openings.widths),
        }
    }
}
