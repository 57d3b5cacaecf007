//! Columns by exit of a network whose constrictions have no direction of their own.

use super::exit_rule::ExitRule;

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
    /// Rule by which particles choose.
    pub(super) rule: ExitRule,
    /// Part of its conductance that a blocked constriction keeps.
    pub(super) rho: f64,
    /// Tolerance beyond which a walk solves the flow again: see
    /// [`Network::with_flow_tolerance`](super::Network).
    pub(super) flow_tolerance: f64,
    /// Volume by void, in units of the network's reference length cubed; empty where it is not known.
    pub(super) volume: Vec<f64>,
    /// Constrictions: each pair of twins once, without those that nothing can block.
    pub(super) passages: usize,
    /// Factor from the conductance of the whole to its permeability, in mm2.
    pub(super) permeability_mm2: Option<f64>,
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
