//! Studies of several walks: boundaries, percolation; specifications; and the soils of a file.

use std::path::PathBuf;

use pyo3::prelude::*;
use voidwalk::case::CaseError;
use voidwalk::cli;
use voidwalk::practice::SheetCover;
use voidwalk::practice::design::Specification;
use voidwalk::practice::design::specification::{ProductMargin, SizeBand};
use voidwalk::practice::quantity::{SizeUnit, limits};
use voidwalk::sheets::soils_in_file;
use voidwalk::store::format;
use voidwalk::study::boundary::{self as boundaries, BoundaryOptions};
use voidwalk::study::percolation::{self as percolations, PercolationOptions, PercolationPlan};
use voidwalk::study::specified::{SpecifyOptions, specify};
use voidwalk::words::specification::{beside_limits, no_band};

use crate::notes::plain;
use crate::problem::{failed, of_run, refused};
use crate::scenes::Manner;
use crate::work::at_work;

/// The soils of a file: a JSON list.
#[pyfunction]
pub fn soils(path: PathBuf, d0_mm: Option<f64>) -> PyResult<String> {
    let soils = soils_in_file(&path, d0_mm).map_err(|error| of_run(&CaseError::from(error).into()))?;
    serde_json::to_string(&soils).map_err(failed)
}

/// Filters whose boundaries are searched: densities, true if the filter is packed, and thicknesses.
#[derive(FromPyObject)]
pub struct Search(Vec<String>, bool, Vec<String>);

/// Finds the boundaries of the model, into a folder: the JSON of `boundary.json`.
#[pyfunction]
pub fn boundary(
    py: Python<'_>,
    base: Option<PathBuf>,
    filter: Option<String>,
    search: Search,
    settings: Vec<String>,
    as_sampled: bool,
    as_given: bool,
    out: PathBuf,
    overwrite: bool,
    packings: PathBuf,
    manner: Manner,
    progress: Option<&Bound<'_, PyAny>>,
) -> PyResult<String> {
    let Search(densities, pack, thicknesses) = search;
    let thicknesses: Result<_, String> = thicknesses.iter().map(|text| text.parse()).collect();
    let options = BoundaryOptions {
        base,
        filter,
        densities,
        pack,
        thicknesses: thicknesses.map_err(refused)?,
        settings,
        as_sampled,
        as_given,
        out,
        overwrite,
        prepare: manner.prepare(packings),
    };
    let boundaries = at_work(py, progress, |callbacks| boundaries::run(&options, &callbacks.run))?;
    format::BOUNDARY.json(&boundaries).map_err(failed)
}

/// Makes the specification of a filter for a base by practice alone, into a folder: the JSON of
/// `specification.json`.
#[pyfunction]
pub fn specification(
    py: Python<'_>,
    base: PathBuf,
    dispersive: bool,
    finer: bool,
    sieves: &str,
    out: PathBuf,
    overwrite: bool,
    progress: Option<&Bound<'_, PyAny>>,
) -> PyResult<String> {
    let sieves =
        sieves.parse().map_err(|_| refused(format!("sieves = {sieves} is not allowed; us or iso")))?;
    let cover = SheetCover::default();
    let bases = vec![base];
    let options = SpecifyOptions { bases, dispersive, finer, sieves, cover, inches: false, out, overwrite };
    let specification = at_work(py, progress, |callbacks| specify(&options, &callbacks.run))?;
    format::SPECIFICATION.json(&specification).map_err(failed)
}

/// D15F of the band, the reason why there is no band, conditions on a delivery beside the limits, the source
/// of the maximum D15F, and true for each product that fits.
type Words = (Option<String>, Option<String>, Option<String>, Option<String>, Vec<Option<bool>>);

/// The words for a specification, from its record.
#[pyfunction]
pub fn specification_words(record: &str) -> PyResult<Words> {
    let unit = SizeUnit::Mm;
    let specification: Specification = serde_json::from_str(record).map_err(refused)?;
    let d15f = specification.band.as_ref().map(SizeBand::d15_mm);
    Ok((
        d15f.map(|[least, most]| plain(&format!("D15F from {}", limits(least, most, unit)))),
        specification.no_band.as_ref().map(|why| plain(&no_band(why, unit))),
        beside_limits(&specification, unit).map(|words| plain(&words)),
        specification.set_by().map(str::to_owned),
        specification.products.iter().map(ProductMargin::fits).collect(),
    ))
}

/// Finds percolation thresholds, into a folder: the JSON of `percolation.json`.
#[pyfunction]
pub fn percolation(
    py: Python<'_>,
    shapes: Vec<[u32; 3]>,
    realisations: u64,
    seed: u64,
    out: PathBuf,
    overwrite: bool,
    threads: Option<usize>,
    progress: Option<&Bound<'_, PyAny>>,
) -> PyResult<String> {
    let plan = PercolationPlan { shapes, realisations, seed };
    let options = PercolationOptions { plan, out, overwrite, threads };
    let study = at_work(py, progress, |callbacks| percolations::run(&options, &callbacks.run))?;
    format::PERCOLATION.json(&study).map_err(failed)
}

/// The JSON Schema of a form, by its name.
#[pyfunction]
pub fn schema(name: &str) -> PyResult<String> {
    let names: Vec<&str> = format::FORMATS.iter().map(|form| form.name()).collect();
    let problem = || refused(format!("name = {name} is not allowed; one of {}", names.join(", ")));
    cli::schema(name).ok_or_else(problem)
}
