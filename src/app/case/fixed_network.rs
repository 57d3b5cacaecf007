//! A network that all replicates walk: from a file, or the voids of a packing.

use std::sync::Arc;

use super::error::CaseError;
use super::files::Files;
use super::stated_filter::StatedFilter;
use super::void_graph::GraphPacking;
use crate::scene::{NetworkSource, Scene};
use voidwalk_core::constrictions::{Curve, CurveUnit};
use voidwalk_core::network::{Network, WIDE};

/// A network that all replicates walk.
#[derive(Clone)]
pub struct FixedNetwork {
    /// The network.
    pub network: Network,
    /// Its finest constriction, in units of the reference length.
    pub(super) finest: f32,
    /// The packing whose voids it is; `None` for a network from a file.
    pub packing: Option<CopiedPacking>,
}

/// A packing whose voids are a network, repeated along the flow.
#[derive(Clone)]
pub struct CopiedPacking {
    /// Copies.
    pub copies: u32,
    /// Their thickness together (mm).
    pub thickness_mm: f64,
    /// Measurements on the packing.
    pub(super) graph: Arc<GraphPacking>,
}

impl FixedNetwork {
    /// Reads the network of a scene; `None` if each replicate builds its own, or if the packing is still to
    /// be made.
    pub(super) fn read(
        scene: &Scene,
        filter: &StatedFilter,
        files: &mut Files,
    ) -> Result<Option<Self>, CaseError> {
        let unit_mm = filter.gradation.smallest_mm();
        let (network, packing) = match (&scene.network.source(), &filter.graph) {
            (NetworkSource::File(path), _) => (files.network(path, scene, unit_mm)?, None),
            (NetworkSource::Graph(_, extent), Some(graph)) => {
                let copies = graph.copies(*extent, filter.gradation.d(50.0).unwrap_or(unit_mm));
                let thickness_mm = f64::from(copies) * graph.graph.cell_mm[2];
                let network = graph.network(scene, copies, unit_mm)?;
                (network, Some(CopiedPacking { copies, thickness_mm, graph: graph.clone() }))
            }
            _ => return Ok(None),
        };
        Ok(Some(Self { finest: network.finest_open(|_| false), network, packing }))
    }

    /// Its constriction curve (mm): its open diameters by number, at most a thousand points.
    pub(super) fn curve(&self) -> Result<Curve, CaseError> {
        let unit_mm = self.network.unit_mm();
        let open = self.network.diameters().iter().filter(|&&d| d > 0.0 && d != WIDE);
        let mut sizes: Vec<f64> = open.map(|&d| f64::from(d) * unit_mm).collect();
        sizes.sort_by(f64::total_cmp);
        let Some(last) = sizes.len().checked_sub(1) else {
            return Ok(Curve::from_points(&[(100.0, unit_mm)], CurveUnit::Mm)?);
        };
        let steps = last.clamp(1, 1000);
        let point = |k: usize| (100.0 * k as f64 / steps as f64, sizes[last * k / steps]);
        Ok(Curve::from_points(&(0..=steps).map(point).collect::<Vec<_>>(), CurveUnit::Mm)?)
    }
}
