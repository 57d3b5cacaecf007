//! Packings, and the constrictions between their grains.

use numpy::IntoPyArray;
use pyo3::prelude::*;
use pyo3::types::PyDict;
use voidwalk::case::PackingPlan;
use voidwalk::cases::CaseCallbacks;
use voidwalk::constrictions::{Constrictions, ConstrictionsError, Facets, Triangulation, VoidGraph};
use voidwalk::packing::{Compression, Packing, PackingError, ReadOptions, Settings, draw, random_start};
use voidwalk::run::machine::threads as pool;
use voidwalk::run::{Event, RunError};
use voidwalk::words::{doubt, reading};

use crate::arrays::{Grains, of_packing, of_rows};
use crate::problem::refused;
use crate::soil::{Gradation, density_named};
use crate::work::at_work;

/// Steps of a compression between two checks for a stop.
const STEPS: u64 = 50;

type Arrays<'py> = (Bound<'py, PyAny>, Bound<'py, PyAny>, Option<[f64; 3]>);

/// Draws grains from a gradation and compresses them; returns the grains, and the state that was reached.
#[pyfunction]
pub fn pack<'py>(
    py: Python<'py>,
    gradation: &Gradation,
    density: &Bound<'py, PyAny>,
    grains: Option<usize>,
    seed: u64,
    threads: Option<usize>,
    progress: Option<&Bound<'py, PyAny>>,
) -> PyResult<(Arrays<'py>, Bound<'py, PyDict>)> {
    let gradation = &gradation.inner;
    let friction = match density.extract::<f64>() {
        Ok(friction) => friction,
        Err(_) => {
            let word: String = density.extract()?;
            density_named(&word)?.friction()
        }
    };
    let grains = grains.unwrap_or_else(|| PackingPlan::usual_grains(gradation));
    let settings = Settings { grains, friction, seed, ..Settings::default() };
    let (packing, report) = at_work(py, progress, |callbacks| {
        let on = |callbacks: &CaseCallbacks| {
            settings.check()?;
            let start = random_start(&draw(gradation, settings.grains, settings.seed), &settings)?;
            let mut compression = Compression::new(&start, &settings)?;
            let report = compression.run_until(
                STEPS,
                || false,
                |at| {
                    (callbacks.run.on_event)(Event::Packing(at));
                    !callbacks.run.is_stopped()
                },
            );
            Ok((compression.packing(), report?))
        };
        let packed: Result<_, PackingError> = pool(threads)?.install(|| on(callbacks));
        packed.map_err(|error| match error {
            PackingError::Stopped(_) => RunError::Stopped(String::new()),
            error => error.into(),
        })
    })?;
    let reached = PyDict::new(py);
    reached.set_item("void_ratio", report.after.void_ratio)?;
    reached.set_item("pressure_kpa", report.after.pressure_kpa)?;
    reached.set_item("coordination", report.after.coordination)?;
    reached.set_item("rattlers", report.after.rattlers)?;
    reached.set_item("friction", friction)?;
    reached.set_item("seed", seed)?;
    reached.set_item("steps", report.steps)?;
    Ok((of_packing(py, packing)?, reached))
}

/// Grains from a file of any format that is read, and how the file was understood.
#[pyfunction]
pub fn read_packing<'py>(
    py: Python<'py>,
    path: std::path::PathBuf,
    unit: Option<&str>,
    cell: Option<&str>,
) -> PyResult<(Arrays<'py>, Vec<String>)> {
    let options = ReadOptions {
        unit: unit.map(str::parse).transpose().map_err(|e: String| refused(format!("unit: {e}")))?,
        cell: cell.map(str::parse).transpose().map_err(|e: String| refused(format!("cell: {e}")))?,
    };
    let name = path.display().to_string();
    let (packing, notes) = py.detach(|| Packing::read_as(path, &options)).map_err(refused)?;
    let notes = notes.iter().map(|note| reading(note, &name)).collect();
    Ok((of_packing(py, packing)?, notes))
}

/// Voids and constrictions between grains, as a dict of arrays, and a summary as JSON.
#[pyfunction]
pub fn measure<'py>(
    py: Python<'py>,
    grains: Grains<'py>,
    merge_overlap: f64,
    on_both_hulls: bool,
    threads: Option<usize>,
) -> PyResult<(Bound<'py, PyDict>, String)> {
    let grains = grains.packing()?;
    let facets = if on_both_hulls { Facets::OnBothHulls } else { Facets::All };
    let (constrictions, graph, curve, summary) = at_work(py, None, |_| {
        pool(threads)?.install(|| {
            let t = Triangulation::new(&grains)
                .map_err(|error| RunError::refused(ConstrictionsError::from(error)))?;
            let constrictions =
                Constrictions::from_triangulation(&t, merge_overlap, facets).map_err(RunError::refused)?;
            constrictions.check().map_err(RunError::refused)?;
            // Grains without a cell, and voids that run through it, have no graph; nor do only some facets.
            let graph = VoidGraph::of(&t, merge_overlap).ok().filter(|_| facets == Facets::All);
            let curve = constrictions.curve().map_err(RunError::refused)?;
            let doubts = constrictions.doubts().iter().map(doubt).collect();
            let summary = constrictions.summary(doubts).map_err(RunError::refused)?;
            let summary = serde_json::to_string(&summary)?;
            Ok((constrictions, graph, curve, summary))
        })
    })?;
    let arrays = PyDict::new(py);
    let pairs = |a: &[u32], b: &[u32]| -> Vec<[i64; 2]> {
        a.iter().zip(b).map(|(&a, &b)| [i64::from(a), i64::from(b)]).collect()
    };
    let Constrictions { diameter_mm, centre_mm, upstream, downstream, .. } = constrictions;
    arrays.set_item("pore.coords", of_rows(py, constrictions.void_centre_mm)?)?;
    arrays.set_item("pore.diameter", constrictions.void_diameter_mm.into_pyarray(py))?;
    if let Some(graph) = graph {
        // Each constriction as a pair of cells, with the periodic cell that holds the other void.
        arrays.set_item("throat.conns", of_rows(py, pairs(&graph.from, &graph.to))?)?;
        arrays.set_item("pore.volume", graph.volume_mm3.into_pyarray(py))?;
        arrays.set_item("throat.shift", of_rows(py, graph.shift)?)?;
        arrays.set_item("throat.conductance", graph.conductance_mm3.into_pyarray(py))?;
    } else {
        arrays.set_item("throat.conns", of_rows(py, pairs(&upstream, &downstream))?)?;
    }
    arrays.set_item("throat.coords", of_rows(py, centre_mm)?)?;
    arrays.set_item("throat.diameter", diameter_mm.into_pyarray(py))?;
    let (percent, size): (Vec<f64>, Vec<f64>) =
        curve.points().into_iter().map(|point| (point.percent, point.size)).unzip();
    arrays.set_item("csd.percent_smaller", percent.into_pyarray(py))?;
    arrays.set_item("csd.diameter", size.into_pyarray(py))?;
    Ok((arrays, summary))
}
