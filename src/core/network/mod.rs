//! Void networks: voids joined by directed constrictions.
//!
//! A [`Network`] is any directed graph of voids. A constriction belongs to its upstream void, as one of
//! its *exits*. The exits of a void are stored together, in a fixed order. Start nodes receive base
//! particles; an exit whose target is [`END`] leaves the filter.
//!
//! The paper's network is the directed cubic lattice ([`Network::cubic`], Fig. 2): `nx x ny x nz`
//! voids, periodic in x and y, flow along +z. [`Network::connected`] changes it until its voids have a given
//! distribution of connectivity (Table 3).
//!
//! Diameters are stored in units of a reference length ([`Network::unit_mm`]), so that changing the unit
//! by a power of two leaves a walk the same to the bit.

mod arrays;
mod columns;
mod connectivity;
mod cubic;
mod exit_rule;
mod file;
mod flow;
mod graph;
mod passage;
mod possible_exits;
mod reach;
mod undirected;

pub use arrays::ArrayOptions;
pub use columns::NO_EXIT;
pub use columns::{CONDUCTANCE_EXPONENT, NetworkColumns};
pub use connectivity::Connectivity;
#[cfg(test)]
use connectivity::TABLE_3;
pub use cubic::percolation_threshold;
pub use exit_rule::ExitRule;
pub use file::NetworkError;
pub use flow::{Flow, FlowError};
pub use graph::{GraphShape, permeability_mm2};
pub use passage::Passage;
pub use undirected::{FLOW_TOLERANCE, WIDE, flow_error_pp};
pub use undirected::{Link, LinkEnd, LinkedVoids};

use exit_rule::{Undirected, hash_column};

/// Target of an exit that leaves the filter.
pub const END: u32 = u32::MAX;

/// Layer of a void that cannot be reached from a start node.
pub const NO_LAYER: u32 = u32::MAX;

/// Voids, constrictions and start nodes, as columns.
#[derive(Clone, Debug, PartialEq)]
pub struct Network {
    /// First exit of each void, with one extra entry at the end: the exits of void `v` are constrictions
    /// `exit_begin[v] .. exit_begin[v + 1]`.
    exit_begin: Vec<u32>,
    target: Vec<u32>,
    /// Diameter of each constriction in units of `unit_mm`; 0 means closed from the start.
    diameter: Vec<f32>,
    /// Voids that receive base particles; random draws depend on their order.
    start: Vec<u32>,
    /// Layer of each void, counted from 0: z on a lattice, otherwise the minimum number of moves from a
    /// start node.
    layer: Vec<u32>,
    unit_mm: f64,
    shape: Option<[u32; 3]>,
    /// Columns of an undirected network only.
    undirected: Option<Box<Undirected>>,
}

impl Network {
    /// Weight of a constriction when a particle chooses among the open exits of its void: its area, up to
    /// a common factor (the paper's Fig. 4), or the weight that its [`ExitRule`] derives from area and
    /// flow. A constriction that is closed from the start has weight 0.
    ///
    /// Engines, first passage and Eq. (1) all take it from here; the slow reference of the walk
    /// deliberately computes its own.
    #[inline]
    pub fn exit_weight(&self, constriction: usize) -> f64 {
        if let Some(undirected) = &self.undirected {
            return undirected.weight[constriction];
        }
        let diameter = f64::from(self.diameter[constriction]);
        diameter * diameter
    }

    /// Fingerprint of everything in the network that affects a walk; new columns must be added here.
    pub fn fingerprint(&self) -> u64 {
        let Self { exit_begin, target, diameter, start, layer, unit_mm, shape: _, undirected } = self;
        let mut hash = xxhash_rust::xxh3::Xxh3::new();
        for column in [exit_begin, target, start, layer] {
            hash_column(&mut hash, column, |number| number.to_le_bytes());
        }
        hash_column(&mut hash, diameter, |number| number.to_le_bytes());
        hash.update(&unit_mm.to_bits().to_le_bytes());
        if let Some(undirected) = undirected {
            undirected.hash(&mut hash);
        }
        hash.digest()
    }

    /// Number of voids.
    pub fn voids(&self) -> usize {
        self.exit_begin.len() - 1
    }

    /// Number of constrictions.
    pub fn constrictions(&self) -> usize {
        self.target.len()
    }

    /// Exits of void `void`.
    #[inline]
    pub fn exits(&self, void: u32) -> std::ops::Range<usize> {
        self.exit_begin[void as usize] as usize..self.exit_begin[void as usize + 1] as usize
    }

    /// Downstream void of each constriction, or [`END`].
    pub fn targets(&self) -> &[u32] {
        &self.target
    }

    /// Diameter of each constriction, in units of [`Network::unit_mm`].
    pub fn diameters(&self) -> &[f32] {
        &self.diameter
    }

    /// Voids that receive base particles.
    pub fn start(&self) -> &[u32] {
        &self.start
    }

    /// Layer of each void; [`NO_LAYER`] if it cannot be reached from a start node.
    pub fn layer_of(&self) -> &[u32] {
        &self.layer
    }

    /// Number of layers.
    pub fn layers(&self) -> usize {
        match self.shape {
            Some([_, _, nz]) => nz as usize,
            None => self.layer.iter().filter(|&&l| l != NO_LAYER).max().map_or(0, |&l| l as usize + 1),
        }
    }

    /// Length of one unit of diameter (mm).
    pub fn unit_mm(&self) -> f64 {
        self.unit_mm
    }

    /// Number of voids along x, y, z, if the network is the cubic lattice.
    pub fn shape(&self) -> Option<[u32; 3]> {
        self.shape
    }

    /// Upstream void of each constriction.
    pub fn upstream(&self) -> Vec<u32> {
        let mut upstream = vec![0; self.constrictions()];
        for void in 0..self.voids() as u32 {
            upstream[self.exits(void)].fill(void);
        }
        upstream
    }

    /// Finest constriction (`f32::INFINITY` without one that is open).
    pub fn finest(&self) -> f32 {
        self.finest_open(|_| false)
    }

    /// Finest open constriction (`f32::INFINITY` if all are closed). A base particle no coarser than it is
    /// *passive*: it cannot block anything.
    pub(crate) fn finest_open(&self, closed: impl Fn(usize) -> bool) -> f32 {
        const TOGETHER: usize = 64;
        let mut finest = f32::INFINITY;
        for (part, diameters) in self.diameter.chunks(TOGETHER).enumerate() {
            // The bits of positive floats are ordered like the floats; 0 becomes the largest.
            let order = |d: f32| d.to_bits().wrapping_sub(1);
            if diameters.iter().fold(u32::MAX, |least, &d| least.min(order(d))) >= order(finest) {
                continue;
            }
            for (c, &d) in (part * TOGETHER..).zip(diameters) {
                // Few are finer than all before; the others need not be tested for closure.
                if d < finest && d > 0.0 && !closed(c) {
                    finest = d;
                }
            }
        }
        finest
    }
}

/// First entry of each void with one extra entry at the end, and the place of each row among all, sorted by
/// their voids.
fn in_order_of_voids(voids: usize, rows: impl Iterator<Item = u32> + Clone) -> (Vec<u32>, Vec<u32>) {
    let mut begin = vec![0u32; voids + 1];
    rows.clone().for_each(|void| begin[void as usize + 1] += 1);
    (0..voids).for_each(|void| begin[void + 1] += begin[void]);
    let mut next = begin.clone();
    let place = |void: u32| {
        next[void as usize] += 1;
        next[void as usize] - 1
    };
    let places = rows.map(place).collect();
    (begin, places)
}
