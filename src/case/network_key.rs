//! What makes a case's networks.

use super::Case;
use crate::scene::NetworkSource;

/// Bytes of a network: for a void, and for a constriction (its target and diameter).
const BYTES: [u64; 2] = [8, 8];

impl Case {
    /// A number that two cases share only where [`Case::network`] builds the same network of this seed;
    /// `None` where a case has one network, which is there already.
    pub fn network_key(&self, seed: u64) -> Option<u128> {
        let source = self.scene.network.source();
        if self.fixed_network.is_some() || matches!(source, NetworkSource::File(_)) {
            return None;
        }
        let curve: Vec<(u64, u64)> =
            self.curve.points().iter().map(|(size, share)| (size.to_bits(), share.to_bits())).collect();
        let (unit, rule) = (self.unit_mm.to_bits(), self.scene.exit_rule());
        let made_of = format!("{seed} {source:?} {unit} {rule:?} {:?} {curve:?}", self.scene.exits);
        Some(xxhash_rust::xxh3::xxh3_128(made_of.as_bytes()))
    }

    /// About the bytes of one of its networks.
    pub fn network_bytes(&self) -> u64 {
        let [voids, constrictions, ..] = self.counts;
        voids.saturating_mul(BYTES[0]).saturating_add(constrictions.saturating_mul(BYTES[1]))
    }
}
