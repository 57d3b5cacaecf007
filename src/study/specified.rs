//! The specification of a filter by the rules of practice alone, for one base or for each of many samples, in
//! a folder of its own.

use std::path::{Path, PathBuf};

use serde::Serialize;

use crate::cases::days::today;
use crate::cases::inputs::{InputSamples, input_files};
use crate::gradation::{Gradation, SoilSample, curves_in_file};
use crate::outcome::design::{SieveSeries, Specification};
use crate::outcome::quantity::SizeUnit;
use crate::outcome::record::SheetCover;
use crate::outcome::rules::NamedCurve;
use crate::outcome::table::csv_of;
use crate::run::callbacks::Callbacks;
use crate::run::error::RunError;
use crate::run::folder::{FolderKind, begin, claim, shown};
use crate::run::results::json;
use crate::store::{Folder, StoreError};
use crate::verdict::{DesignedSample, DesignedSamples, SpecificationOptions};
use crate::words::specification::step_rows;
use crate::words::{designed, products};

/// A base coarser than this (D85, mm) is none: its sizes are in another unit.
pub(super) const NO_BASE_MM: f64 = 100.0;

/// What a specification is asked for, and where it goes.
#[derive(Clone, Debug)]
pub struct SpecifyOptions {
    /// Sieve table of the base; several soils in it are the curves of an envelope.
    pub base: PathBuf,
    /// Whether the base is dispersive.
    pub dispersive: bool,
    /// Whether the band is to lie at the finer end of what is allowed.
    pub finer: bool,
    /// The sieves at which the limits are stated.
    pub sieves: SieveSeries,
    /// What its page says of itself, besides the day.
    pub cover: SheetCover,
    /// Whether its page shows inches beside mm.
    pub inches: bool,
    /// Folder for the results.
    pub out: PathBuf,
    /// Whether earlier results there are replaced.
    pub overwrite: bool,
}

impl SpecifyOptions {
    fn of_practice(&self) -> SpecificationOptions {
        let (finer, sieves) = (self.finer, self.sieves);
        SpecificationOptions { dispersive: self.dispersive.then_some(true), finer, sieves }
    }

    /// Writes tables, record and page into the folder.
    fn write(
        &self,
        (kind, record): (FolderKind, &impl Serialize),
        callbacks: &Callbacks,
        tables: impl FnOnce(&Folder) -> Result<(), StoreError>,
    ) -> Result<(), RunError> {
        let folder = claim(&self.out, kind, self.overwrite)?;
        begin(&folder, kind)?;
        tables(&folder)?;
        folder.write(kind.record(), &json(kind.format(), record)?)?;
        callbacks.finish(kind, &folder)
    }
}

/// Makes the specification of a filter for a base, step by step, and writes its tables and, last,
/// `specification.json`.
///
/// # Errors
/// A base that cannot be read or is none, and a folder that cannot be claimed, are refused before anything
/// is written.
pub fn specify(options: &SpecifyOptions, callbacks: &Callbacks) -> Result<Specification, RunError> {
    let bases = curves_in_file(&options.base, None).map_err(RunError::refused)?;
    no_filter_within(&options.base, &bases)?;
    bases.iter().try_for_each(|(name, base)| is_a_base(&options.base, name, base))?;
    let specification = Specification::of(&options.base.display().to_string(), &bases, options.of_practice());
    let cover = options.cover.clone().dated(today());
    let inputs = input_files([options.base.as_path()])?;
    let specification = Specification { inches: options.inches, cover, inputs, ..specification };
    options.write((FolderKind::Specification, &specification), callbacks, |folder| {
        write_tables(folder, &specification)
    })?;
    Ok(specification)
}

/// Specifies a filter for every sample of a file or a folder (the base of the options) by practice alone, and
/// writes `designs.csv`, a row a sample, and, last, `designs.json`.
///
/// # Errors
/// Samples that cannot be read, or one that is none, and a folder that cannot be claimed, are refused before
/// anything is written.
pub fn specify_each(options: &SpecifyOptions, callbacks: &Callbacks) -> Result<DesignedSamples, RunError> {
    let input = InputSamples::read(&options.base)?;
    let samples = &input.samples;
    samples.iter().try_for_each(|sample| is_a_base(&sample.path, &sample.name, &sample.curve))?;
    let row = |sample: &SoilSample| {
        let curve = (sample.name.clone(), sample.curve.clone());
        DesignedSample::of(sample, &Specification::of(&sample.name, &[curve], options.of_practice()))
    };
    let (notes, inputs) =
        (input.notes(&[])?, input_files(samples.iter().map(|sample| sample.path.as_path()))?);
    let table = DesignedSamples::new(shown(&options.base), samples.iter().map(row).collect());
    let (dispersive, inches, cover) =
        (options.dispersive, options.inches, options.cover.clone().dated(today()));
    let table = DesignedSamples { dispersive, inches, cover, notes, inputs, ..table };
    options.write((FolderKind::Designs, &table), callbacks, |folder| {
        folder.write("designs.csv", &designed::columns(SizeUnit::Mm).csv(&table.rows))
    })?;
    Ok(table)
}

/// Refuses a file with both a base and a filter: the filter is no curve of the base.
fn no_filter_within(file: &Path, curves: &[NamedCurve]) -> Result<(), RunError> {
    let of = |wanted: &str| {
        // Of several samples on a sheet each is named `Base/Sample 1`.
        let sheet = |name: &str| name.split('/').next().unwrap_or_default().trim().to_lowercase();
        curves.iter().map(|(name, _)| name).find(|name| sheet(name) == wanted)
    };
    match (of("base"), of("filter")) {
        (Some(base), Some(filter)) => Err(RunError::Refused(format!(
            "{file}: {filter}: it holds a base and a filter, and all curves are taken as of the base; name \
             one: {file}#{base}",
            file = shown(file)
        ))),
        _ => Ok(()),
    }
}

/// Refuses stones: a size in micrometres under a header in mm, most likely.
fn is_a_base(file: &Path, name: &str, base: &Gradation) -> Result<(), RunError> {
    match base.d(85.0).filter(|d85| *d85 > NO_BASE_MM) {
        Some(d85) => Err(RunError::Refused(format!("{}: {name}: {}", shown(file), no_base(d85)))),
        None => Ok(()),
    }
}

/// What is wrong with so coarse a base.
pub(super) fn no_base(d85: f64) -> String {
    format!(
        "the base's D85 is {d85:.0} mm, and no filter holds such stones: are its sizes micrometres under a \
         header in mm?"
    )
}

/// Writes limits, steps and products as CSV.
///
/// # Errors
/// What the system says.
fn write_tables(folder: &Folder, specification: &Specification) -> Result<(), StoreError> {
    let steps: Vec<_> = specification.steps.iter().flat_map(step_rows).collect();
    let products = products::columns(SizeUnit::Mm).csv(&specification.products);
    folder.write("specification.csv", &csv_of(&specification.limits))?;
    folder.write("specification_steps.csv", &csv_of(&steps))?;
    folder.write("specification_products.csv", &products)
}
