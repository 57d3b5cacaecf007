//! Key of everything that decides a case's networks.

use super::{Case, CaseNetwork};
use crate::scene::NetworkSource;
use voidwalk_core::walk::Engine;

/// Bytes of a network: for a void, and for a constriction (its target and diameter).
const BYTES: [u64; 2] = [8, 8];

/// Bytes of the exits with which its first runs begin: words and exits; shares, and the void that a
/// constriction leaves.
const EXIT_BYTES: [u64; 2] = [16, 16];

impl Case {
    /// A number that two cases share only if [`Case::network`] builds the same network for this seed; `None`
    /// if a case has one network, which exists already.
    pub fn network_key(&self, seed: u64) -> Option<u128> {
        let source = self.scene.network.source();
        if self.network.fixed.is_some() || matches!(source, NetworkSource::File(_)) {
            return None;
        }
        let curve: Vec<(u64, u64)> =
            self.filter.curve.points().iter().map(|p| (p.percent.to_bits(), p.size.to_bits())).collect();
        let (unit, rule) = (self.filter.unit_mm.to_bits(), self.scene.exit_rule());
        let made_of = format!("{seed} {source:?} {unit} {rule:?} {:?} {curve:?}", self.scene.exits);
        Some(xxhash_rust::xxh3::xxh3_128(made_of.as_bytes()))
    }

    /// About the bytes of one of its networks, and of the exits that first runs on it may begin with, be they
    /// of this case or of another with the network.
    pub fn shared_network_bytes(&self) -> [u64; 2] {
        let CaseNetwork { voids, constrictions, .. } = self.network;
        let bytes = |[of_void, of_constriction]: [u64; 2]| {
            voids.saturating_mul(of_void).saturating_add(constrictions.saturating_mul(of_constriction))
        };
        let exits = if self.scene.is_lattice_by_area() { EXIT_BYTES } else { [0; 2] };
        [bytes(BYTES), bytes(exits)]
    }

    /// True if its first runs begin with exits that depend on the network alone, and passive particles take
    /// them.
    pub fn begins_with_plain_exits(&self) -> bool {
        let scene = &self.scene;
        let has_counts = matches!(scene.walk.engine, Engine::Counts | Engine::Expected);
        has_counts && scene.is_lattice_by_area() && scene.law().is_none() && !scene.leaves_openings()
    }
}
