//! The specification of a filter by the rules of practice alone, in a folder of its own.

use std::path::{Path, PathBuf};

use crate::cases::days::today;
use crate::cases::inputs::input_files;
use crate::cases::kept;
use crate::gradation::{Gradation, curves_in_file};
use crate::outcome::design::{SieveSeries, Specification};
use crate::outcome::quantity::SizeUnit;
use crate::outcome::record::SheetCover;
use crate::outcome::rules::NamedCurve;
use crate::outcome::table::csv_of;
use crate::run::callbacks::Callbacks;
use crate::run::error::RunError;
use crate::run::folder::{FolderKind, claim, shown};
use crate::store::{Folder, StoreError};
use crate::verdict::SpecificationOptions;
use crate::words::products::columns;
use crate::words::specification::step_rows;

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
    let (dispersive, finer, sieves) = (options.dispersive, options.finer, options.sieves);
    let said = dispersive.then_some(true);
    let specified = SpecificationOptions { dispersive: said, finer, sieves };
    let specification = Specification::of(&options.base.display().to_string(), &bases, specified);
    let cover = options.cover.clone().dated(today());
    let inputs = input_files([options.base.as_path()])?;
    let specification = Specification { inches: options.inches, cover, inputs, ..specification };
    let kind = FolderKind::Specification;
    let folder = claim(&options.out, kind, options.overwrite)?;
    let (inches, cover) = (options.inches, &options.cover);
    let work = format!("{dispersive} {finer} {sieves} {inches} {cover:?} {bases:?}");
    kept::study((&folder, kind, options.overwrite), work, callbacks, |_, _: Option<()>| {
        write_tables(&folder, &specification)?;
        Ok(specification)
    })
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
pub(super) fn is_a_base(file: &Path, name: &str, base: &Gradation) -> Result<(), RunError> {
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
    folder.write("specification.csv", &csv_of(&specification.limits))?;
    folder.write("specification_steps.csv", &csv_of(&steps))?;
    folder.write("specification_products.csv", &columns(SizeUnit::Mm).csv(&specification.products))
}
