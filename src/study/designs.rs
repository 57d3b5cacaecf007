//! Many samples: what practice specifies for each, in one table.

use std::path::PathBuf;

use super::specified::{SpecifyOptions, is_a_base};
use crate::cases::days::today;
use crate::cases::inputs::{files_of, input_files};
use crate::cases::kept;
use crate::gradation::{SoilSample, notes_in_file, samples_in};
use crate::outcome::design::Specification;
use crate::outcome::quantity::SizeUnit;
use crate::run::callbacks::Callbacks;
use crate::run::error::RunError;
use crate::run::folder::{FolderKind, claim, shown};
use crate::verdict::{DesignedSample, DesignedSamples, SpecificationOptions};
use crate::words::designed::columns;

/// One row a sample.
const TABLE: &str = "designs.csv";

/// Specifies a filter for every sample of a file or a folder (the base of the options) by practice alone, and
/// writes `designs.csv` and, last, `designs.json`.
///
/// # Errors
/// Samples that cannot be read, or one that is none, and a folder that cannot be claimed, are refused before
/// anything is written.
pub fn each(options: &SpecifyOptions, callbacks: &Callbacks) -> Result<DesignedSamples, RunError> {
    let samples = samples_in(&options.base).map_err(RunError::refused)?;
    samples.iter().try_for_each(|sample| is_a_base(&sample.path, &sample.name, &sample.curve))?;
    let SpecifyOptions { dispersive, finer, sieves, inches, cover, .. } = options;
    let specified =
        SpecificationOptions { dispersive: dispersive.then_some(true), finer: *finer, sieves: *sieves };
    let row = |sample: &SoilSample| {
        let curve = (sample.name.clone(), sample.curve.clone());
        DesignedSample::of(sample, &Specification::of(&sample.name, &[curve], specified))
    };
    let files = samples.iter().map(|sample| sample.path.as_path());
    let (notes, inputs) = (notes(&files_of(files.clone()))?, input_files(files)?);
    let samples_at = shown(&options.base);
    let curves: Vec<_> = samples.iter().map(|sample| (&sample.name, sample.curve.points())).collect();
    let work = format!("{samples_at} {dispersive} {finer} {sieves} {inches} {cover:?} {curves:?}");
    let table = DesignedSamples::new(samples_at, samples.iter().map(row).collect());
    let (dispersive, inches, cover) = (*dispersive, *inches, cover.clone().dated(today()));
    let table = DesignedSamples { dispersive, inches, cover, notes, inputs, ..table };
    let kind = FolderKind::Designs;
    let folder = claim(&options.out, kind, options.overwrite)?;
    kept::study((&folder, kind, options.overwrite), work, callbacks, |_, _: Option<()>| {
        folder.write(TABLE, &columns(SizeUnit::Mm).csv(&table.rows))?;
        Ok(table)
    })
}

/// What was assumed of the files, once each.
fn notes(files: &[PathBuf]) -> Result<Vec<String>, RunError> {
    let mut all = Vec::new();
    for file in files {
        let of_file = notes_in_file(file).map_err(RunError::refused)?;
        all.extend(of_file.into_iter().map(|note| format!("{}: {note}", shown(file))));
    }
    Ok(all)
}
