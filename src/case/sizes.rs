//! How large a network is: its voids, constrictions, start nodes and layers, and the connectivity of its
//! voids.

use std::collections::BTreeMap;

use crate::constrictions::Curve;
use crate::network::{Connectivity, Network, NetworkError};

/// A lattice with more voids than this is not made for its counts alone: those of a smaller one are scaled
/// up.
const MADE_FOR_COUNTS: u64 = 4_000_000;

/// Voids along each side of that smaller one, at most.
const SMALLER: u32 = 64;

/// Voids, constrictions, start nodes, layers.
pub(super) fn of_network(n: &Network) -> [u64; 4] {
    [n.filter_voids() as u64, n.passages() as u64, n.entries() as u64, n.layers() as u64]
}

/// The same for the cubic lattice, which is not made for it.
pub(super) fn of_lattice(shape: [u32; 3]) -> Result<[u64; 4], NetworkError> {
    let [nx, ny, nz] = shape.map(u64::from);
    let constrictions = Network::lattice_constrictions(shape)? as u64;
    Ok([constrictions / 3, constrictions, nx * ny, nz])
}

/// The same for a lattice with this distribution of connectivity, and that distribution as it is met; so a
/// distribution that no network has is refused before any work.
pub(super) fn of_connected(
    shape: [u32; 3],
    wanted: &Connectivity,
    curve: &Curve,
    unit_mm: f64,
    seed: u64,
) -> Result<([u64; 4], Vec<[f64; 2]>), NetworkError> {
    let [voids, _, start, layers] = of_lattice(shape)?;
    let made = if voids > MADE_FOR_COUNTS { shape.map(|n| n.min(SMALLER)) } else { shape };
    let network = Network::connected(made, curve, unit_mm, seed, wanted)?;
    let scale = voids as f64 / network.voids() as f64;
    let constrictions = (network.constrictions() as f64 * scale).round() as u64;
    Ok(([voids, constrictions, start, layers], connectivity_of(&network)))
}

/// Connectivity and percent of the voids, rising; empty where all have the same.
pub(super) fn connectivity_of(network: &Network) -> Vec<[f64; 2]> {
    let mut counts = BTreeMap::new();
    network.connectivity().iter().for_each(|&k| *counts.entry(k).or_insert(0u64) += 1);
    if counts.len() < 2 {
        return Vec::new();
    }
    let percent = |count| 100.0 * count as f64 / network.voids() as f64;
    counts.into_iter().map(|(k, count)| [f64::from(k), percent(count)]).collect()
}
