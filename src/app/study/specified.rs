//! Specification of a filter by the rules of practice alone, for one base or for each of many samples, in a
//! folder of its own.

use std::path::PathBuf;

use serde::Serialize;

use crate::cases::inputs::{InputSoils, input_files};
use crate::cases::kept::today;
use crate::outcome::record::commit;
use crate::outcome::table::csv_of;
use crate::run::RunError;
use crate::run::callbacks::Callbacks;
use crate::run::folder::{FolderKind, begin, claim, refused, shown};
use crate::run::results::json;
use crate::words::specification::step_rows;
use crate::words::{designed, products};
use voidwalk_core::store::{Folder, StoreError};
use voidwalk_core::text::plain;
use voidwalk_practice::design::{SieveSeries, Specification};
use voidwalk_practice::quantity::SizeUnit;
use voidwalk_practice::{DesignedSample, DesignedSamples, SheetCover, SpecificationOptions};
use voidwalk_sheets::{SoilSample, envelope_in, file_and_soil, samples_in};

/// D85 (mm) above which a base is refused, because its sizes are probably in another unit.
const NO_BASE_MM: f64 = 100.0;

/// Options of a specification, and the folder of its results.
#[derive(Clone, Debug)]
pub struct SpecifyOptions {
    /// Sieve tables of the base, whose soils are the curves of an envelope; or tables, or folders of tables,
    /// of samples.
    pub bases: Vec<PathBuf>,
    /// True if the base is dispersive.
    pub dispersive: bool,
    /// True if the band is to lie at the finer end of the allowed range.
    pub finer: bool,
    /// Sieves at which the limits are stated.
    pub sieves: SieveSeries,
    /// Cover of its page, without the date.
    pub cover: SheetCover,
    /// True if its page shows inches as well as mm.
    pub inches: bool,
    /// Folder for the results.
    pub out: PathBuf,
    /// True if earlier results there are replaced.
    pub overwrite: bool,
}

impl SpecifyOptions {
    fn of_practice(&self) -> SpecificationOptions {
        let (finer, sieves) = (self.finer, self.sieves);
        SpecificationOptions { dispersive: self.dispersive.then_some(true), finer, sieves }
    }

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
/// A base that cannot be read or is not a base, or a folder that cannot be claimed, is refused before
/// anything is written.
pub fn specify(options: &SpecifyOptions, callbacks: &Callbacks) -> Result<Specification, RunError> {
    let base = InputSoils::read(&options.bases, envelope_in)?;
    no_filter_within(&base)?;
    base.soils.iter().try_for_each(is_a_base)?;
    let curves: Vec<_> = base.soils.iter().map(|soil| (soil.name.clone(), soil.curve.clone())).collect();
    let specification = Specification::of(&base.name, &curves, options.of_practice());
    let (inches, cover) = (options.inches, options.cover.clone().dated(today()));
    let inputs = input_files(&base.soils)?;
    let specification = Specification { commit: commit(), inches, cover, inputs, ..specification };
    options.write((FolderKind::Specification, &specification), callbacks, |folder| {
        let steps: Vec<_> = specification.steps.iter().flat_map(step_rows).collect();
        let products = products::columns(SizeUnit::Mm).csv(&specification.products);
        folder.write("specification.csv", &csv_of(&specification.limits))?;
        folder.write("specification_steps.csv", &csv_of(&steps))?;
        folder.write("specification_products.csv", &products)
    })?;
    Ok(specification)
}

/// Specifies a filter for every sample (the bases of the options) by practice alone, and writes
/// `designs.csv`, one row per sample, and, last, `designs.json`. Errors: samples that cannot be read, a
/// sample that is not a base, or a folder that cannot be claimed are refused before anything is written.
pub(crate) fn specify_each(
    options: &SpecifyOptions,
    callbacks: &Callbacks,
) -> Result<DesignedSamples, RunError> {
    let input = InputSoils::read(&options.bases, samples_in)?;
    input.soils.iter().try_for_each(is_a_base)?;
    let row = |sample: &SoilSample| {
        let curve = (sample.name.clone(), sample.curve.clone());
        DesignedSample::of(sample, &Specification::of(&sample.name, &[curve], options.of_practice()))
    };
    let table = DesignedSamples::new(plain(&input.name), input.soils.iter().map(row).collect());
    let table = DesignedSamples {
        commit: commit(),
        dispersive: options.dispersive,
        inches: options.inches,
        cover: options.cover.clone().dated(today()),
        notes: input.notes(&[])?,
        inputs: input_files(&input.soils)?,
        ..table
    };
    options.write((FolderKind::Designs, &table), callbacks, |folder| {
        folder.write("designs.csv", &designed::columns(SizeUnit::Mm).csv(&table.rows))
    })?;
    Ok(table)
}

/// Refuses soils if one is named base and another filter: the filter is not a curve of the base.
fn no_filter_within(base: &InputSoils) -> Result<(), RunError> {
    let called = |wanted: &str| {
        // Samples on one sheet have names like `Base/Sample 1`.
        let sheet = |name: &str| name.split('/').next().unwrap_or_default().trim().to_lowercase();
        let in_file = |soil: &SoilSample| file_and_soil(&soil.path).1.unwrap_or_else(|| soil.name.clone());
        base.soils.iter().find(|soil| sheet(&in_file(soil)) == wanted)
    };
    match (called("base"), called("filter")) {
        (Some(soil), Some(filter)) => Err(RunError::Refused(format!(
            "{}: {}: it holds a base and a filter, and all curves are taken as the base's; name one: {}",
            plain(&base.name),
            filter.name,
            shown(&soil.path)
        ))),
        _ => Ok(()),
    }
}

fn is_a_base(soil: &SoilSample) -> Result<(), RunError> {
    let checked = soil.curve.d(85.0).map_or(Ok(()), check_d85);
    checked.map_err(|stones| refused(&soil.path, format!("{}: {stones}", soil.name)))
}

#[derive(Debug, thiserror::Error)]
#[error(
    "the base's D85 is {0:.0} mm, and no filter holds such stones: are its sizes micrometres under a header \
     in mm?"
)]
pub(super) struct Stones(f64);

/// Refuses stones: most likely a size in micrometres under a header in mm.
pub(super) fn check_d85(d85_mm: f64) -> Result<(), Stones> {
    if d85_mm > NO_BASE_MM { Err(Stones(d85_mm)) } else { Ok(()) }
}
