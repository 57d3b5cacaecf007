//! The filter as the scene and its files state it, before anything is known of its network.

use std::sync::Arc;

use super::error::CaseError;
use super::files::Files;
use super::library_filter::LibraryFilter;
use super::packed_filter::PackedFilter;
use super::void_graph::GraphPacking;
use crate::scene::{FilterGradation, LibraryDensity, NetworkSource, Scene};
use voidwalk_core::constrictions::{Curve, ShippedFilter, inscribed};
use voidwalk_core::gradation::Gradation;

/// A filter as it is stated.
pub(super) struct StatedFilter {
    /// Its gradation.
    pub gradation: Gradation,
    /// Its constriction curve, in the unit in which it is stated; `None` if the network defines it.
    pub curve: Option<Curve>,
    /// The shipped filter that the curve is, if it is one.
    pub shipped: Option<&'static ShippedFilter>,
    /// The packing that the curve was measured on, if the program made it.
    pub packed: Option<PackedFilter>,
    /// Entry of the library of packings, if the scene asks for it.
    pub library: Option<LibraryFilter>,
    /// Relative density of a curve that is guessed from the gradation.
    pub guessed_density: Option<f64>,
    /// Measurements on the packing whose voids are the network.
    pub graph: Option<Arc<GraphPacking>>,
}

impl StatedFilter {
    /// Reads the files of a filter; `packed` and `measured` are its packing and that packing's voids, if they
    /// exist already.
    pub fn read(
        scene: &Scene,
        packed: Option<PackedFilter>,
        measured: Option<Arc<GraphPacking>>,
        files: &mut Files,
    ) -> Result<Self, CaseError> {
        let packed = match (&scene.filter.measured, scene.filter.grains_per_void) {
            (Some(curve), Some(grains_per_void)) => Some(PackedFilter::kept(curve, grains_per_void)?),
            _ => packed,
        };
        let graph = match (measured, scene.network.source()) {
            (None, NetworkSource::Graph(file, _)) => {
                GraphPacking::read(scene, file.as_ref(), packed.as_ref(), files)?.map(Arc::new)
            }
            (measured, _) => measured,
        };
        let (curve, shipped) = curve(scene, packed.as_ref(), graph.as_deref(), files)?;
        let gradation = gradation(scene, shipped, graph.as_deref(), files)?;
        let library = match scene.filter.library {
            Some(density) => LibraryFilter::find(&gradation, density)?,
            None => None,
        };
        // The constrictions of a filter are guessed if no library filter is like it.
        let of_library = scene.filter.library.filter(|_| library.is_none());
        let guessed_density = scene.filter.estimate.or(of_library.map(LibraryDensity::relative));
        let curve = match (&library, guessed_density) {
            (Some(library), _) => Some(library.found.curve.clone()),
            (None, Some(density)) => Some(inscribed(&gradation, density)?),
            (None, None) => curve,
        };
        Ok(Self { gradation, curve, shipped, packed, library, guessed_density, graph })
    }
}

/// The curve that is measured or given, and the shipped filter that it is.
fn curve(
    scene: &Scene,
    packed: Option<&PackedFilter>,
    graph: Option<&GraphPacking>,
    files: &mut Files,
) -> Result<(Option<Curve>, Option<&'static ShippedFilter>), CaseError> {
    Ok(match (&scene.filter.curve, packed) {
        (_, Some(packed)) => (Some(files.packed(packed)?), None),
        (Some(source), None) => {
            let (curve, shipped) = files.curve(source, "filter.curve", "filter-curve.csv", &scene.name)?;
            (Some(curve), shipped)
        }
        (None, None) if scene.packing.is_some() => {
            return Err(CaseError::NotPacked { file: scene.name.clone() });
        }
        (None, None) => (graph.map(|graph| graph.curve.clone()), None),
    })
}

/// The gradation: of the packing or of the shipped filter if the scene does not state it.
fn gradation(
    scene: &Scene,
    shipped: Option<&ShippedFilter>,
    graph: Option<&GraphPacking>,
    files: &mut Files,
) -> Result<Gradation, CaseError> {
    match (&scene.filter.gradation(), graph) {
        (FilterGradation::Linear { cu: None, .. }, Some(graph)) if shipped.is_none() => {
            Ok(graph.gradation.clone())
        }
        (FilterGradation::Linear { d0_mm, cu }, _) => {
            let cu = cu.or(shipped.map(|s| s.cu)).ok_or_else(|| {
                scene.clash(
                    "filter.cu or filter.sieve is missing: this constriction curve does not say \
                     its filter's gradation",
                )
            })?;
            Ok(Gradation::linear_from_d0(*d0_mm, cu)?)
        }
        (FilterGradation::Sieve(path, d0_mm), _) => {
            files.sieve(path, *d0_mm, "filter.sieve", "filter-sieve.csv", &scene.name)
        }
    }
}
