//! Measures the constrictions of a packing from elsewhere and writes them into a folder.

use std::path::{Path, PathBuf};

use super::callbacks::Callbacks;
use super::error::RunError;
use super::folder::{FolderKind, begin, claim, shown};
use super::machine::on_threads;
use super::unfinished;
use voidwalk_core::constrictions::{
    Constrictions, DEFAULT_MERGE_OVERLAP, Facets, Summary, Triangulation, VoidGraph,
};
use voidwalk_core::network::permeability_mm2;
use voidwalk_core::packing::{Packing, ReadOptions};

/// Options of measuring constrictions.
#[derive(Clone, Debug)]
pub struct ConstrictionsOptions {
    /// Overlap of two inscribed spheres from which their tetrahedra are one void.
    pub merge_overlap: f64,
    /// Which facets between voids are constrictions of the curve.
    pub facets: Facets,
    /// Options that complete the file of grains.
    pub read: ReadOptions,
    /// Folder for the results.
    pub out: PathBuf,
    /// True if earlier results there are replaced.
    pub overwrite: bool,
}

impl Default for ConstrictionsOptions {
    fn default() -> Self {
        Self {
            merge_overlap: DEFAULT_MERGE_OVERLAP,
            facets: Facets::All,
            read: ReadOptions::default(),
            out: "voidwalk-constrictions".into(),
            overwrite: false,
        }
    }
}

/// Measures the constrictions of the grains in a file and writes `grains.vtp`, `constrictions.csv`,
/// `constrictions.vtp`, for grains in a periodic cell `graph.csv` and, last, `constrictions.json`; returns
/// the contents of that file.
///
/// # Errors
/// Grains that are refused, or do not fit their cell; a folder that cannot be claimed or written.
pub fn measure_constrictions(
    packing: &Path,
    options: &ConstrictionsOptions,
    callbacks: &Callbacks,
) -> Result<Summary, RunError> {
    on_threads(None, || measure_here(packing, options, callbacks))
}

fn measure_here(
    packing: &Path,
    options: &ConstrictionsOptions,
    callbacks: &Callbacks,
) -> Result<Summary, RunError> {
    let file = shown(packing);
    let (packing, notes) = Packing::read_as(packing, &options.read)?;
    let refused = |error: String| RunError::Refused(format!("{file}: {error}"));
    let t = Triangulation::new(&packing).map_err(|error| refused(error.to_string()))?;
    let constrictions = Constrictions::from_triangulation(&t, options.merge_overlap, options.facets)
        .map_err(|error| refused(error.to_string()))?;
    constrictions.check().map_err(|error| refused(error.to_string()))?;
    // Grains without a cell, and voids that run through it, have no graph.
    let graph = VoidGraph::of(&t, options.merge_overlap).ok();
    // Constrictions near the outside of grains without a cell do not count for the curve.
    let whole =
        |summary: &Summary| summary.grains_per_void.is_finite() && summary.mean_connectivity.is_finite();
    let mut summary = constrictions.summary().ok().filter(whole).ok_or_else(|| {
        RunError::Refused(format!(
            "{file}: {} grains are too few: no constriction lies between two voids inside the packing. At \
             least 5 grains that do not lie in one plane are needed for one, some thousands for a curve",
            packing.diameter.len()
        ))
    })?;
    notes.iter().for_each(|note| (callbacks.warn)(&format!("{file}: {note}")));
    if let Some(graph) = &graph {
        let square = graph.d32_mm * graph.d32_mm;
        let k = permeability_mm2(graph, 2).map_err(|error| RunError::refused(format!("{file}: {error}")))?;
        summary.k_over_d32_squared = Some(k / square);
        summary.kozeny_carman_over_d32_squared = Some(graph.kozeny_carman_mm2() / square);
    }
    let folder = claim(&options.out, FolderKind::Constrictions, options.overwrite)?;
    begin(&folder, FolderKind::Constrictions)?;
    folder.write("grains.vtp", packing.to_vtp().as_bytes())?;
    if let Some(graph) = &graph {
        folder.write("graph.csv", graph.to_csv().as_bytes())?;
    }
    for (name, text) in constrictions.files(&summary)? {
        folder.write(name, text.as_bytes())?;
    }
    unfinished::end(&folder)?;
    Ok(summary)
}
