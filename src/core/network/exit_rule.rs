//! Rules by which a particle chooses among the open exits of its void, and the columns by exit that they need
//! where constrictions have no direction of their own.

use crate::schema::Leaf;
use serde::{Deserialize, Serialize};

/// Rule by which a particle chooses among the open exits of its void.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum ExitRule {
    /// In proportion to area, on a network whose constrictions have a direction of their own (the paper's).
    #[default]
    Area,
    /// In proportion to the flow of water, which leads down the pressure.
    Flux,
    /// In proportion to area, among the exits that water leaves by.
    AreaAlongFlow,
    /// In proportion to area, among the exits that lead to a void further along the axis of flow: for
    /// comparison, since voids without one hold back particles that water would carry on.
    Height,
}

impl Leaf for ExitRule {}

impl ExitRule {
    /// Every rule, in the order in which a user is told of them.
    pub const ALL: [Self; 4] = [Self::Area, Self::Flux, Self::AreaAlongFlow, Self::Height];

    /// Name of the rule in a scene.
    pub fn name(self) -> &'static str {
        match self {
            Self::Area => "area",
            Self::Flux => "flux",
            Self::AreaAlongFlow => "area-along-flow",
            Self::Height => "height",
        }
    }

    /// Tells if the rule needs to know where water flows.
    pub fn needs_flow(self) -> bool {
        matches!(self, Self::Flux | Self::AreaAlongFlow)
    }

    /// Weight of an exit of this area (the square of its diameter), with `flux` out through it, or in if
    /// negative; fluxes up to `least` count as zero.
    pub(super) fn weight(self, area: f64, flux: f64, least: f64) -> f64 {
        // The direction of water cannot be foreseen: chosen without a branch.
        match self {
            Self::Area | Self::Height => area,
            Self::Flux if flux > least => flux,
            Self::Flux => 0.0,
            Self::AreaAlongFlow => area * f64::from(u8::from(flux > least)),
        }
    }
}

/// Marks an exit without a twin.
pub(super) const NO_TWIN: u32 = u32::MAX;

/// Columns by exit of a network whose constrictions have no direction of their own.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Undirected {
    /// Exit of the other void that is the same constriction, or [`NO_TWIN`].
    pub(super) twin: Vec<u32>,
    /// Conductance times viscosity, in any one unit, by exit.
    pub(super) conductance: Vec<f64>,
    /// Present weight in the choice, by exit.
    pub(super) weight: Vec<f64>,
    pub(super) rule: ExitRule,
    pub(super) rho: f64,
    /// Tolerance beyond which a walk solves the flow again: see
    /// [`Network::with_flow_tolerance`](crate::network::Network).
    pub(super) flow_tolerance: f64,
    /// Volume by void, in units of the network's reference length cubed; empty where it is not known.
    pub(super) volume: Vec<f64>,
    /// Constrictions: each pair of twins once, without those that nothing can block.
    pub(super) passages: usize,
    /// Factor from the conductance of the whole to its permeability, in mm2.
    pub(super) permeability_factor: Option<f64>,
}

impl Undirected {
    /// Adds the columns that a walk takes to a hash; the weights follow from the rest.
    pub(super) fn hash(&self, hash: &mut xxhash_rust::xxh3::Xxh3) {
        let Self { twin, conductance, rule, rho, flow_tolerance, volume, .. } = self;
        hash_column(hash, twin, |number| number.to_le_bytes());
        hash_column(hash, conductance, |number| number.to_le_bytes());
        hash.update(rule.name().as_bytes());
        hash.update(&rho.to_bits().to_le_bytes());
        hash.update(&flow_tolerance.to_bits().to_le_bytes());
        hash_column(hash, volume, |number| number.to_le_bytes());
    }
}

/// Adds a column to a hash: its length, and its numbers as the same bytes on every machine.
pub(super) fn hash_column<T: Copy, const N: usize>(
    hash: &mut xxhash_rust::xxh3::Xxh3,
    column: &[T],
    bytes: impl Fn(T) -> [u8; N],
) {
    hash.update(&(column.len() as u64).to_le_bytes());
    column.iter().for_each(|&number| hash.update(&bytes(number)));
}
