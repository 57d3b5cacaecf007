//! The table of many samples against filters, from their files.

use std::collections::HashSet;
use std::path::{Path, PathBuf};

use serde::{Deserialize, Serialize};

use super::batch::BatchRow;
use super::pair::PairOptions;
use crate::gradation::{GradationError, curves_in_file, file_and_soil, notes_in_file, samples_in};

/// A filter of a batch.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "cli", derive(schemars::JsonSchema))]
pub struct BatchFilter {
    /// As it was named, and as the rows name it.
    pub name: String,
    /// What its curves are called; several are an envelope.
    pub curves: Vec<String>,
    /// D15F (mm), of its coarsest curve; `None` where the table does not reach it.
    pub d15f_mm: Option<f64>,
    /// Each curve: rows of (size in mm, percent finer by mass), sizes ascending.
    pub gradations: Vec<Vec<[f64; 2]>>,
}

/// What practice says of every sample and filter, filter by filter.
#[derive(Clone, Debug)]
pub struct BatchTable {
    /// A row for each filter and sample.
    pub rows: Vec<BatchRow>,
    /// The filters.
    pub filters: Vec<BatchFilter>,
    /// The curve of the base as sampled, rows of (size in mm, percent finer by mass); empty where there are
    /// several samples.
    pub base: Vec<[f64; 2]>,
    /// What was assumed of a file, once: the file and the sentence.
    pub notes: Vec<(PathBuf, String)>,
}

impl BatchTable {
    /// Reads the samples of a file or a folder, as [`samples_in`], and the filters; each soil of a filter's
    /// file is a curve of its envelope.
    ///
    /// ```no_run
    /// use voidwalk::verdict::{BatchTable, PairOptions};
    /// let table = BatchTable::read("site.ags".as_ref(), &["filter.csv".into()], PairOptions::default())?;
    /// println!("{} samples", table.rows.len());
    /// # Ok::<(), voidwalk::gradation::GradationError>(())
    /// ```
    ///
    /// # Errors
    /// A file that cannot be read as a table.
    pub fn read(samples: &Path, filters: &[PathBuf], options: PairOptions) -> Result<Self, GradationError> {
        let of_base = samples_in(samples)?;
        let base = match &of_base[..] {
            [sample] => sample.curve.rows(),
            _ => Vec::new(),
        };
        let mut table = Self { rows: Vec::new(), filters: Vec::new(), base, notes: Vec::new() };
        for filter in filters {
            let curves = curves_in_file(filter, None)?;
            let name = filter.display().to_string();
            let rows = of_base.iter().map(|sample| BatchRow::of(sample, (&name, &curves), options));
            let rows: Vec<BatchRow> = rows.collect();
            let d15f_mm = rows.iter().find_map(|row| row.d15f_mm);
            table.rows.extend(rows);
            let gradations = curves.iter().map(|(_, curve)| curve.rows()).collect();
            let curves = curves.into_iter().map(|(name, _)| name).collect();
            table.filters.push(BatchFilter { name, curves, d15f_mm, gradations });
        }
        let files: Vec<PathBuf> = match samples.is_dir() {
            true => of_base.iter().map(|sample| file_and_soil(&sample.path).0).collect(),
            false => vec![samples.to_owned()],
        };
        let mut read = HashSet::new();
        for file in files.iter().chain(filters).filter(|file| read.insert(*file)) {
            table.notes.extend(notes_in_file(file)?.into_iter().map(|note| (file.clone(), note)));
        }
        Ok(table)
    }

    /// Checks that it has one sample, the base from this file.
    ///
    /// # Errors
    /// It has several: in words.
    pub fn one_base(&self, base: &Path) -> Result<(), String> {
        match self.rows.len() / self.filters.len().max(1) {
            ..=1 => Ok(()),
            soils => Err(format!(
                "{} holds {soils} soils; name one of them as FILE#NAME, or add --each for all of them",
                base.display()
            )),
        }
    }
}
