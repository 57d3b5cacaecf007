//! The table of many samples against filters.

use serde::{Deserialize, Serialize};

use super::batch::BatchRow;
use super::pair::PairOptions;
use crate::rules::NamedCurve;
use voidwalk_sheets::SoilSample;

/// A filter of a batch.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schemas", derive(schemars::JsonSchema))]
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

/// Answers of practice for every sample and filter, filter by filter.
#[derive(Clone, Debug)]
pub struct BatchTable {
    /// A row for each filter and sample.
    pub rows: Vec<BatchRow>,
    /// Filters of the batch.
    pub filters: Vec<BatchFilter>,
    /// Curve of the base as sampled, in rows of (size in mm, percent finer by mass); empty for several
    /// samples.
    pub base: Vec<[f64; 2]>,
    /// Assumptions on the files, a sentence each.
    pub notes: Vec<String>,
}

impl BatchTable {
    /// Table of these samples and of named filters, each with the curves of its envelope.
    pub fn new(
        samples: &[SoilSample],
        filters: Vec<(String, Vec<NamedCurve>)>,
        notes: Vec<String>,
        options: PairOptions,
    ) -> Self {
        let base = match samples {
            [sample] => sample.curve.rows(),
            _ => Vec::new(),
        };
        let mut table = Self { rows: Vec::new(), filters: Vec::new(), base, notes };
        for (name, curves) in filters {
            let rows = samples.iter().map(|sample| BatchRow::of(sample, (&name, &curves), options));
            let rows: Vec<BatchRow> = rows.collect();
            let d15f_mm = rows.iter().find_map(|row| row.d15f_mm);
            table.rows.extend(rows);
            let gradations = curves.iter().map(|(_, curve)| curve.rows()).collect();
            let curves = curves.into_iter().map(|(name, _)| name).collect();
            table.filters.push(BatchFilter { name, curves, d15f_mm, gradations });
        }
        table
    }
}
