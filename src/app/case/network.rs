//! Network of a case: its size, and the network itself if all replicates walk the same one.

use super::error::CaseError;
use super::filter::{CaseFilter, CopiedPacking, FixedNetwork};
use super::packed_filter::GUESSED_GRAINS_PER_VOID;
use crate::scene::{Extent, NetworkSource, Scene, USUAL_LAYERS};
use rand::Rng;
use std::collections::BTreeMap;
use voidwalk_core::gradation::Gradation;
use voidwalk_core::network::{Connectivity, Network, NetworkError};
use voidwalk_core::stream::{Key, Purpose};

/// Number of voids above which a lattice is not built only to be counted: counts of a smaller one are
/// scaled up.
const MADE_FOR_COUNTS: u64 = 4_000_000;
/// Maximum number of voids along each side of the smaller lattice.
const SMALLER: u32 = 64;

/// Seed of replicate `replicate`, counted from 1; depends only on the user's seed and the replicate.
pub fn replicate_seed(seed: u64, replicate: u64) -> u64 {
    Key { seed, purpose: Purpose::Replicate, run: 0, increment: 0, chunk: replicate }.generator().next_u64()
}

/// Size of a network.
#[derive(Clone)]
pub(crate) struct CaseNetwork {
    pub(crate) voids: u64,
    /// Number of constrictions in the first replicate.
    pub(crate) constrictions: u64,
    pub(crate) start_nodes: u64,
    pub(crate) layers: u64,
    /// Connectivity and percent of the voids, if they differ.
    pub(crate) connectivity: Vec<[f64; 2]>,
    /// Network itself, if all replicates walk the same one.
    pub(crate) fixed: Option<FixedNetwork>,
}

impl CaseNetwork {
    /// Size of the network of a scene with this filter.
    pub(super) fn new(
        scene: &Scene,
        filter: &CaseFilter,
        fixed: Option<FixedNetwork>,
    ) -> Result<Self, CaseError> {
        if let Some(fixed) = fixed {
            let network = &fixed.network;
            // Exits that are passed both ways have no connectivity in the sense of the paper.
            let passes_both_ways = fixed.packing.is_some() || network.reservoir().is_some();
            return Ok(Self {
                voids: network.filter_voids() as u64,
                constrictions: network.passages() as u64,
                start_nodes: network.entries() as u64,
                layers: network.layers() as u64,
                connectivity: if passes_both_ways { Vec::new() } else { connectivity(network) },
                fixed: Some(fixed),
            });
        }
        Ok(match &scene.network.source() {
            NetworkSource::Connected(shape, wanted) => {
                Self::of_connected(*shape, wanted, filter, replicate_seed(scene.walk.seed, 1))?
            }
            source => {
                let shape = source.shape().unwrap_or_else(|| placeholder_shape(scene, &filter.gradation));
                Self::of_lattice(shape)?
            }
        })
    }

    /// Size of the cubic lattice, without building it.
    pub(super) fn of_lattice(shape: [u32; 3]) -> Result<Self, NetworkError> {
        let [nx, ny, layers] = shape.map(u64::from);
        let constrictions = Network::lattice_constrictions(shape)? as u64;
        let (voids, start_nodes) = (constrictions / 3, nx * ny);
        Ok(Self { voids, constrictions, start_nodes, layers, connectivity: Vec::new(), fixed: None })
    }

    /// Size of a lattice with this distribution of connectivity, and the distribution reached. An
    /// impossible distribution is thus refused before any work.
    fn of_connected(
        shape: [u32; 3],
        wanted: &Connectivity,
        filter: &CaseFilter,
        seed: u64,
    ) -> Result<Self, NetworkError> {
        let lattice = Self::of_lattice(shape)?;
        let made = if lattice.voids > MADE_FOR_COUNTS { shape.map(|n| n.min(SMALLER)) } else { shape };
        let network = Network::connected(made, &filter.curve, filter.unit_mm, seed, wanted)?;
        let scale = lattice.voids as f64 / network.voids() as f64;
        let constrictions = (network.constrictions() as f64 * scale).round() as u64;
        Ok(Self { constrictions, connectivity: connectivity(&network), ..lattice })
    }

    /// Packing whose voids form it.
    pub(super) fn packing(&self) -> Option<&CopiedPacking> {
        self.fixed.as_ref()?.packing.as_ref()
    }

    /// Number of copies of the packing whose voids form it.
    pub(crate) fn copies(&self) -> Option<u32> {
        self.packing().map(|packing| packing.copies)
    }
}

/// Connectivity and percent of the voids, ascending; empty if all voids agree.
fn connectivity(network: &Network) -> Vec<[f64; 2]> {
    let mut counts = BTreeMap::new();
    network.connectivity().iter().for_each(|&k| *counts.entry(k).or_insert(0u64) += 1);
    if counts.len() < 2 {
        return Vec::new();
    }
    let percent = |count| 100.0 * count as f64 / network.voids() as f64;
    counts.into_iter().map(|(k, count)| [f64::from(k), percent(count)]).collect()
}

/// Lattice about as large as the graph of a packing that does not exist yet.
pub(super) fn placeholder_shape(scene: &Scene, filter: &Gradation) -> [u32; 3] {
    let grains = scene.packing.as_ref().and_then(|packing| packing.filter.grains).unwrap_or(9_000);
    let across = libm::cbrt(grains as f64 / GUESSED_GRAINS_PER_VOID).ceil().clamp(1.0, 1000.0) as u32;
    let along = match scene.network.extent() {
        Extent::Copies(copies) => copies.saturating_mul(across).min(1_000_000),
        extent => {
            let layer = filter.d_by_number(50.0).unwrap_or(filter.smallest_mm());
            let thickness = extent.thickness_mm(filter.d(50.0).unwrap_or(layer));
            thickness.map_or(USUAL_LAYERS as u32, |mm| (mm / layer).ceil().clamp(1.0, 1e6) as u32)
        }
    };
    [across, across, along]
}
