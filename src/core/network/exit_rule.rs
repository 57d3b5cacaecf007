//! Rules by which a particle chooses among the open exits of its void, and the exit columns of undirected
//! networks.
//!
//! A rule for undirected networks is a variant of [`ExitRule`] with its name, need of flow and weight. Other
//! places that know rules: `linked_numbered` sets the weights of a rule without water, and `columns` takes or
//! refuses it for arrays. `weight` (`walk/openings.rs`) and `Reference::open_area` have the power of its
//! width by which an opening counts: 2 for an area, and for a flux that of a conductance, relative to the
//! last solution of the flow (`Directions::weighed`).
//!
//! Directed networks know area alone: `Network::exit_weight`, `passage` and `Reference::open_area` have its
//! formula. A further rule of theirs is a field of `Network`, and part of its fingerprint.

use crate::schema::Leaf;
use serde::{Deserialize, Serialize};

/// Rule by which a particle chooses among the open exits of its void.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum ExitRule {
    /// In proportion to area, on a network of directed constrictions (as in the paper).
    #[default]
    Area,
    /// In proportion to the outflow of water.
    Flux,
    /// In proportion to area, among the exits through which water leaves.
    AreaAlongFlow,
    /// In proportion to area, among the exits to voids further along the axis of flow. For comparison
    /// only: voids without such exits hold back particles that water would carry on.
    Height,
}

impl Leaf for ExitRule {}

impl ExitRule {
    /// All rules, in the order shown to users.
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

    /// Tells if the rule needs the flow of water.
    pub fn needs_flow(self) -> bool {
        matches!(self, Self::Flux | Self::AreaAlongFlow)
    }

    /// Weight of an exit with this area (square of its diameter) and this outward `flux` (inward if
    /// negative); fluxes up to `least` count as zero.
    pub(super) fn weight(self, area: f64, flux: f64, least: f64) -> f64 {
        // The direction of water is unpredictable, so the choice is branch-free.
        match self {
            Self::Area | Self::Height => area,
            Self::Flux if flux > least => flux,
            Self::Flux => 0.0,
            Self::AreaAlongFlow => area * f64::from(u8::from(flux > least)),
        }
    }
}

pub(super) const NO_TWIN: u32 = u32::MAX;

#[derive(Clone, Debug, PartialEq)]
pub(super) struct Undirected {
    /// Exit of the neighbouring void through the same constriction, or [`NO_TWIN`].
    pub(super) twin: Vec<u32>,
    /// Conductance times viscosity by exit, in any consistent unit.
    pub(super) conductance: Vec<f64>,
    pub(super) weight: Vec<f64>,
    pub(super) rule: ExitRule,
    pub(super) rho: f64,
    /// Tolerance beyond which a walk recomputes the flow: see
    /// [`Network::with_flow_tolerance`](crate::network::Network).
    pub(super) flow_tolerance: f64,
    /// Volume by void, in units of the network's reference length cubed; empty if unknown.
    pub(super) volume: Vec<f64>,
    /// Number of constrictions: each pair of twins counts once, unblockable ways in do not count.
    pub(super) passages: usize,
    /// Factor that converts the conductance of the network to its permeability (mm2).
    pub(super) permeability_factor: Option<f64>,
}

impl Undirected {
    /// Adds the columns that a walk uses to a hash; weights follow from the other columns.
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

/// Adds the length and the numbers of a column to a hash, as the same bytes on every machine.
pub(super) fn hash_column<T: Copy, const N: usize>(
    hash: &mut xxhash_rust::xxh3::Xxh3,
    column: &[T],
    bytes: impl Fn(T) -> [u8; N],
) {
    hash.update(&(column.len() as u64).to_le_bytes());
    column.iter().for_each(|&number| hash.update(&bytes(number)));
}
