//! The voids of a packing as a case's network: measurements on the grains, and number of copies.

use std::path::PathBuf;

use super::error::CaseError;
use super::files::{Files, KEPT_GRAINS};
use super::packed_filter::PackedFilter;
use crate::scene::{Extent, Scene, USUAL_LAYERS};
use voidwalk_core::constrictions::{Curve, VoidGraph};
use voidwalk_core::gradation::Gradation;
use voidwalk_core::network::{GraphShape, Network};
use voidwalk_core::packing::Packing;

/// Points of the gradation that is read off the grains.
const GRADATION_POINTS: usize = 200;

/// Measurements on the grains of a graph's packing.
pub(super) struct GraphPacking {
    /// Its voids.
    pub graph: VoidGraph,
    /// Its constriction curve (mm).
    pub curve: Curve,
    /// Its gradation.
    pub gradation: Gradation,
}

impl GraphPacking {
    /// Reads the file that the scene names, or measures the filter's own packing; `None` if that is still to
    /// be made.
    pub fn read(
        scene: &Scene,
        file: Option<&PathBuf>,
        packed: Option<&PackedFilter>,
        files: &mut Files,
    ) -> Result<Option<Self>, CaseError> {
        let merge_overlap = scene.packing.as_ref().map(|packing| packing.filter.merge_overlap);
        let merge_overlap = merge_overlap.unwrap_or(voidwalk_core::constrictions::DEFAULT_MERGE_OVERLAP);
        let (name, packing) = match (file, packed) {
            (Some(path), _) => files.packing(path, KEPT_GRAINS, scene)?,
            (None, Some(PackedFilter { grains: Some(grains), .. })) => {
                files.packed_grains(grains, KEPT_GRAINS)?
            }
            (None, _) => return Ok(None),
        };
        let refused = |problem: String| CaseError::from(scene.clash(format!("{name}: {problem}")));
        let (constrictions, graph) =
            VoidGraph::measure(&packing, merge_overlap).map_err(|e| refused(e.to_string()))?;
        if file.is_some() {
            constrictions.doubts().into_iter().for_each(|doubt| files.note(doubt));
        }
        let gradation = of_grains(&packing)?;
        Ok(Some(Self { graph, curve: constrictions.curve()?, gradation }))
    }

    /// Copies of the packing that a scene asks for.
    pub fn copies(&self, extent: Extent, d50f_mm: f64) -> u32 {
        let cell = self.graph.cell_mm[2];
        let thickness = match extent {
            Extent::Copies(copies) => return copies,
            other => other.thickness_mm(d50f_mm).unwrap_or(USUAL_LAYERS as f64 * self.graph.spacing_mm()),
        };
        // A cell that fits but for rounding is enough.
        libm::ceil(thickness / cell - 1e-9).clamp(1.0, 1e6) as u32
    }

    /// The network of this many copies for a scene, with lengths in units of `unit_mm`.
    pub fn network(&self, scene: &Scene, copies: u32, unit_mm: f64) -> Result<Network, CaseError> {
        let shape =
            GraphShape { copies, rule: scene.exit_rule(), rho: scene.exits.rho.unwrap_or(0.0), unit_mm };
        Ok(Network::of_graph(&self.graph, shape)?)
    }

    /// Filter grains per void by which Eq. (2) gives the base its share of the mass of these very grains.
    pub fn grains_per_void(&self, filter: &Gradation) -> f64 {
        let solid = std::f64::consts::FRAC_PI_6 * self.graph.cubes_mm3;
        solid * filter.particles_per_unit_volume() / self.graph.voids() as f64
    }
}

/// The gradation by mass of grains.
fn of_grains(packing: &Packing) -> Result<Gradation, CaseError> {
    let mut sizes = packing.diameter.clone();
    sizes.sort_by(f64::total_cmp);
    let (smallest, largest) = (sizes[0], sizes[sizes.len() - 1]);
    if smallest == largest {
        return Ok(Gradation::single(smallest)?);
    }
    let cube = |d: f64| d * d * d;
    let all: f64 = sizes.iter().map(|&d| cube(d)).sum();
    let (mut finer, mut points) = (0.0, vec![(smallest, 0.0)]);
    for &size in &sizes {
        finer += cube(size);
        let percent = 100.0 * finer / all;
        let (last_size, last_percent) = points[points.len() - 1];
        if size > last_size && percent >= last_percent + 100.0 / GRADATION_POINTS as f64 {
            points.push((size, percent.min(100.0)));
        }
    }
    match points.last_mut() {
        Some(last) if last.0 == largest => last.1 = 100.0,
        _ => points.push((largest, 100.0)),
    }
    Ok(Gradation::from_points(&points, None)?)
}
