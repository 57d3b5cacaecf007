//! The networks of a study: the scene's own, and lattices on which answers are known.
//!
//! Networks of the scene are made by [`Case`](crate::case::Case) alone, so whatever a scene says of its
//! network holds here too. The others are plain cubic lattices on purpose: their answers are worked out for
//! those.

use super::study::{PrecisionError, Study};
use crate::case::replicate_seed;
use crate::network::Network;

impl Study<'_> {
    /// Seed of replicate `k`, counted from 1: of its network, and of its walk.
    pub(super) fn seed(&self, k: u64) -> u64 {
        replicate_seed(self.case.scene.walk.seed, k)
    }

    /// The scene's voids along x, y, z, where its network is a lattice.
    pub(super) fn shape(&self) -> Option<[u32; 3]> {
        self.case.scene.network.source().shape()
    }

    /// The scene's network of this seed, with `shape` voids where it is a lattice.
    pub(super) fn network(&self, shape: Option<[u32; 3]>, seed: u64) -> Result<Network, PrecisionError> {
        Ok(self.case.network_of_shape(shape.unwrap_or_default(), seed)?)
    }

    /// A plain cubic lattice with the scene's constriction curve.
    pub(super) fn lattice(&self, shape: [u32; 3], seed: u64) -> Result<Network, PrecisionError> {
        Ok(Network::cubic(shape, &self.case.curve, self.case.unit_mm, seed)?)
    }

    /// [`Study::lattice`] with its constriction sizes stratified.
    pub(super) fn stratified(&self, shape: [u32; 3], seed: u64) -> Result<Network, PrecisionError> {
        Ok(Network::cubic_stratified(shape, &self.case.curve, self.case.unit_mm, seed)?)
    }
}

/// A cubic lattice with these constriction diameters, in the order of [`Network::cubic_from_diameters`]; the
/// unit is theirs.
pub(super) fn given(shape: [u32; 3], diameters: Vec<f32>) -> Result<Network, PrecisionError> {
    Ok(Network::cubic_from_diameters(shape, diameters, 1.0)?)
}
