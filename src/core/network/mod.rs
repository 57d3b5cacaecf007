//! Void networks: voids joined by directed constrictions.
//!
//! A [`Network`] is any directed graph of voids. A constriction belongs to its upstream void, as an *exit* of
//! it; exits of one void are neighbours, in a fixed order. Start nodes receive base particles; an exit whose
//! target is [`END`] leaves the filter.
//!
//! The paper's network is the directed cubic lattice ([`Network::cubic`], Fig. 2): `nx x ny x nz`
//! voids, periodic in x and y, flow along +z. [`Network::connected`] changes it until its voids have a given
//! distribution of connectivity (Table 3).
//!
//! Diameters are held in units of a reference length ([`Network::unit_mm`]), so that a change of
//! units by a power of two changes no bit of a walk.

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
pub use columns::{CONDUCTANCE_EXPONENT, NO_EXIT, NetworkColumns};
pub use connectivity::{Connectivity, TABLE_3};
pub use cubic::percolation_threshold;
pub use exit_rule::ExitRule;
pub use file::NetworkError;
pub use flow::{Flow, FlowError, Permeability};
pub use graph::{GraphShape, permeability_mm2};
pub use passage::{FirstPassage, Passage};
pub use possible_exits::TOLERANCE_PERCENT;
pub use reach::Reachability;
pub use undirected::{FLOW_TOLERANCE, Link, LinkEnd, LinkedVoids, WIDE, flow_error_pp};

use exit_rule::{Undirected, hash_column};

/// Target of an exit that leaves the filter.
pub const END: u32 = u32::MAX;

/// Layer of a void that no start node leads to.
pub const NO_LAYER: u32 = u32::MAX;

/// Voids, constrictions and start nodes, as columns.
#[derive(Clone, Debug, PartialEq)]
pub struct Network {
    /// First exit of each void, and one more entry: exits of void `v` are constrictions
    /// `exit_begin[v] .. exit_begin[v + 1]`.
    exit_begin: Vec<u32>,
    target: Vec<u32>,
    /// Diameter of each constriction in units of `unit_mm`; 0 is closed from the start.
    diameter: Vec<f32>,
    /// Voids that receive base particles, in the order in which they are drawn.
    start: Vec<u32>,
    /// Layer of each void, counted from 0: z on a lattice, else the fewest moves from a start node.
    layer: Vec<u32>,
    unit_mm: f64,
    shape: Option<[u32; 3]>,
    /// Columns that exist only if constrictions have no direction of their own.
    undirected: Option<Box<Undirected>>,
}

impl Network {
    /// Weight of a constriction in the choice among the open exits of its void: its area, but for a factor
    /// that all have (the paper's Fig. 4), or the weight that its [`ExitRule`] makes of area and flow. One
    /// that is closed from the start weighs nothing.
    ///
    /// Engines, first passage and Eq. (1) all take it from here; the slow reference of the walk works it out
    /// by itself, on purpose.
    #[inline]
    pub fn exit_weight(&self, constriction: usize) -> f64 {
        if let Some(undirected) = &self.undirected {
            return undirected.weight[constriction];
        }
        let diameter = f64::from(self.diameter[constriction]);
        diameter * diameter
    }

    /// Fingerprint of everything that a walk takes from the network; a new column must be declared here.
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

    /// Constrictions through which void `void` can be left.
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

    /// Layer of each void; [`NO_LAYER`] where no start node leads to it.
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

    /// Voids along x, y, z where the network is the cubic lattice.
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

    /// The finest constriction that `closed` leaves open (`f32::INFINITY` if all are closed): a base particle
    /// no coarser than it is *passive*, it can block nothing.
    pub fn finest_open(&self, closed: impl Fn(usize) -> bool) -> f32 {
        const TOGETHER: usize = 64;
        let mut finest = f32::INFINITY;
        for (part, diameters) in self.diameter.chunks(TOGETHER).enumerate() {
            // Bits of positive numbers rise with them; those of 0 become the largest.
            let order = |d: f32| d.to_bits().wrapping_sub(1);
            if diameters.iter().fold(u32::MAX, |least, &d| least.min(order(d))) >= order(finest) {
                continue;
            }
            for (c, &d) in (part * TOGETHER..).zip(diameters) {
                // Few are finer than all before: for the others it does not matter if they are closed.
                if d < finest && d > 0.0 && !closed(c) {
                    finest = d;
                }
            }
        }
        finest
    }
}
